/* The clock, the sweep of tolerances, and a line of the table: `src/measure.rs` in C. */
#ifndef MEASURE_H
#define MEASURE_H

#include "four_bar.h"
#include <stdio.h>
#include <time.h>

/* Evaluations of the right-hand side so far. */
static long evaluations;

/* Time [s]. */
static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The rates of theta2 and omega, in the form that each solver calls. */
static inline void rates(const double y[2], double rate[2])
{
    rate[0] = y[1];
    rate[1] = acceleration(y[0], y[1]);
    evaluations += 1;
}

/* Time the fastest of many runs, for 50 ms and at least five, or until one takes that long itself; print its line.
   `run` gives theta2 at the end, or NaN if the solver gives up: then there is no line. */
static void measure(double (*run)(void *), void *solver, const char *tool, const char *method, double rtol, double atol,
                    double setup)
{
    const double began = now();
    double best = INFINITY, theta2 = NAN;
    long calls = 0;
    for (int count = 1;; ++count) {
        const long before = evaluations;
        const double start = now();
        theta2 = run(solver);
        const double end = now();
        calls = evaluations - before;
        best = fmin(best, end - start);
        if (isnan(theta2)) {
            fprintf(stderr, "%s %s rtol %.1e atol %.1e: the solver gives up\n", tool, method, rtol, atol);
            return;
        }
        if (end - began > 0.05 && (count >= 5 || best > 0.05))
            break;
    }
    printf("S1,%s,%s,rtol %.1e atol %.1e,%.6e,%.6e,%.6e,%ld\n", tool, method, rtol, atol, fabs(theta2 - THETA2), best, setup,
           calls);
    fflush(stdout);
}

/* First line of the table, then every pair of tolerances down to 10^(-last/2). */
#define HEADER "scene,tool,method,setting,error_rad,run_s,setup_s,evaluations"
static void sweep(int last, void (*point)(int method, double rtol, double atol), int method)
{
    for (int half = 4; half <= last; ++half) {
        const double rtol = pow(10.0, -half / 2.0);
        point(method, rtol, rtol);
        point(method, rtol, rtol / 100);
    }
}

#endif
