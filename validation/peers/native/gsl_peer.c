/* The GNU Scientific Library's explicit Runge-Kutta methods on the hand-written equation of motion. */
#include "measure.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_version.h>

/* Initial step [s]. */
#define FIRST 1e-3

static int right_hand_side(double t, const double y[], double rate[], void *unused)
{
    (void)t, (void)unused;
    rates(y, rate);
    return GSL_SUCCESS;
}

static double run(void *driver)
{
    double t = 0.0, y[2] = {START[0], START[1]};
    gsl_odeiv2_driver_reset_hstart(driver, FIRST);
    return gsl_odeiv2_driver_apply(driver, &t, SPAN, y) == GSL_SUCCESS ? y[0] : NAN;
}

static void point(int method, double rtol, double atol)
{
    static const char *const names[] = {"rk8pd", "rkck", "rkf45"};
    const gsl_odeiv2_step_type *const types[] = {gsl_odeiv2_step_rk8pd, gsl_odeiv2_step_rkck, gsl_odeiv2_step_rkf45};
    const double began = now();
    gsl_odeiv2_system system = {right_hand_side, NULL, 2, NULL};
    prepare();
    gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_y_new(&system, types[method], FIRST, atol, rtol);
    measure(run, driver, "GSL", names[method], rtol, atol, now() - began);
    gsl_odeiv2_driver_free(driver);
}

int main(void)
{
    gsl_set_error_handler_off();
    fprintf(stderr, "GSL %s\n", gsl_version);
    puts(HEADER);
    for (int method = 0; method < 3; ++method)
        sweep(28, point, method);
    return 0;
}
