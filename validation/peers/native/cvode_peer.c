/* SUNDIALS' CVODE on the hand-written equation of motion: the Adams method with fixed-point iterations, and BDF with
   Newton's iterations, whose Jacobian CVODE computes by differences. */
#include "measure.h"
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <sundials/sundials_version.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

typedef struct {
    void *memory;
    N_Vector y;
} Solver;

static int right_hand_side(realtype t, N_Vector y, N_Vector rate, void *unused)
{
    (void)t, (void)unused;
    rates(N_VGetArrayPointer(y), N_VGetArrayPointer(rate));
    return 0;
}

static void start(N_Vector y)
{
    N_VGetArrayPointer(y)[0] = START[0];
    N_VGetArrayPointer(y)[1] = START[1];
}

/* End the program if CVODE rejects a setting. */
static void must(int flag, const char *what)
{
    if (flag < 0) {
        fprintf(stderr, "CVODE refuses %s: %d\n", what, flag);
        exit(1);
    }
}

static double run(void *solver)
{
    Solver *const s = solver;
    realtype t = 0.0;
    start(s->y);
    must(CVodeReInit(s->memory, 0.0, s->y), "the start");
    must(CVodeSetStopTime(s->memory, SPAN), "the end");
    return CVode(s->memory, SPAN, s->y, &t, CV_NORMAL) >= 0 ? N_VGetArrayPointer(s->y)[0] : NAN;
}

static void point(int method, double rtol, double atol)
{
    const double began = now();
    SUNContext context;
    must(SUNContext_Create(NULL, &context), "a context");
    prepare();
    Solver solver = {CVodeCreate(method, context), N_VNew_Serial(2, context)};
    start(solver.y);
    must(CVodeInit(solver.memory, right_hand_side, 0.0, solver.y), "the equation");
    must(CVodeSStolerances(solver.memory, rtol, atol), "the tolerances");
    must(CVodeSetMaxNumSteps(solver.memory, 1000000), "the number of steps");
    must(CVodeSetErrFile(solver.memory, NULL), "silence");
    SUNMatrix matrix = NULL;
    SUNLinearSolver linear = NULL;
    SUNNonlinearSolver fixed_point = NULL;
    if (method == CV_BDF) {
        matrix = SUNDenseMatrix(2, 2, context);
        linear = SUNLinSol_Dense(solver.y, matrix, context);
        must(CVodeSetLinearSolver(solver.memory, linear, matrix), "the linear solver");
    } else {
        fixed_point = SUNNonlinSol_FixedPoint(solver.y, 0, context);
        must(CVodeSetNonlinearSolver(solver.memory, fixed_point), "the fixed-point solver");
    }
    measure(run, &solver, "CVODE", method == CV_BDF ? "BDF" : "Adams", rtol, atol, now() - began);
    if (linear != NULL) {
        SUNLinSolFree(linear);
        SUNMatDestroy(matrix);
    }
    if (fixed_point != NULL)
        SUNNonlinSolFree(fixed_point);
    N_VDestroy(solver.y);
    CVodeFree(&solver.memory);
    SUNContext_Free(&context);
}

int main(void)
{
    char version[64];
    must(SUNDIALSGetVersion(version, sizeof version), "its version");
    fprintf(stderr, "SUNDIALS %s\n", version);
    puts(HEADER);
    sweep(28, point, CV_ADAMS);
    sweep(28, point, CV_BDF);
    return 0;
}
