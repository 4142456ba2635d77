/* A library between an importer and an FMU: it records every call of the importer and forwards it.
 *
 * It replaces binaries/linux64/<modelIdentifier>.so; the FMU's own library is in the same folder as "original.so".
 * The environment variable FMU_TRACE is the path of the file to which it appends one line per call:
 *     <function> <arguments> -> <status>
 * Types are those of fmi2TypesPlatform.h and fmi2FunctionTypes.h (FMI 2.0.5). */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <libgen.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef void *C;
typedef unsigned int Vr;
typedef double Real;
typedef int Int;
typedef const char *Str;

static void *function(const char *name) {
    static void *library;
    if (!library) {
        Dl_info info;
        char path[4096];
        dladdr((void *)function, &info);
        snprintf(path, sizeof path, "%s", info.dli_fname);
        char *folder = dirname(path);
        char original[4200];
        snprintf(original, sizeof original, "%s/original.so", folder);
        library = dlopen(original, RTLD_NOW | RTLD_LOCAL);
        if (!library) {
            fprintf(stderr, "spy: %s\n", dlerror());
            abort();
        }
    }
    void *address = dlsym(library, name);
    if (!address) {
        fprintf(stderr, "spy: %s\n", dlerror());
        abort();
    }
    return address;
}

static FILE *trace(void) {
    static FILE *file;
    if (!file) {
        const char *name = getenv("FMU_TRACE");
        file = name ? fopen(name, "a") : stderr;
        if (!file) file = stderr;
        setvbuf(file, NULL, _IOLBF, 0);
    }
    return file;
}

static const char *text(Str s) { return s ? s : "NULL"; }
static const char *yes(const void *p) { return p ? "yes" : "NULL"; }

static void references(const Vr *vr, size_t n) {
    for (size_t i = 0; vr && i < n; i++) fprintf(trace(), " %u", vr[i]);
}

/* Forward a call: declared types, argument names, format and values of the recorded line. */
#define PASS(name, declared, passed, ...)                         \
    int name declared {                                           \
        fprintf(trace(), #name " " __VA_ARGS__);                  \
        int status = ((int(*) declared)function(#name))passed;    \
        fprintf(trace(), " -> %d\n", status);                     \
        return status;                                            \
    }

#define GET(name, T)                                                            \
    int name(C c, const Vr *vr, size_t n, T *value) {                           \
        fprintf(trace(), #name " n=%zu:", n);                                   \
        references(vr, n);                                                      \
        int status = ((int (*)(C, const Vr *, size_t, T *))function(#name))(c, vr, n, value); \
        fprintf(trace(), " -> %d\n", status);                                   \
        return status;                                                          \
    }

#define SET(name, T, format)                                                    \
    int name(C c, const Vr *vr, size_t n, const T *value) {                     \
        fprintf(trace(), #name " n=%zu:", n);                                   \
        for (size_t i = 0; i < n; i++) fprintf(trace(), " %u=" format, vr[i], value[i]); \
        int status = ((int (*)(C, const Vr *, size_t, const T *))function(#name))(c, vr, n, value); \
        fprintf(trace(), " -> %d\n", status);                                   \
        return status;                                                          \
    }

typedef struct {
    void *logger, *allocate, *release, *finished, *environment;
} Callbacks;

Str fmi2GetTypesPlatform(void) {
    fprintf(trace(), "fmi2GetTypesPlatform\n");
    return ((Str(*)(void))function("fmi2GetTypesPlatform"))();
}

Str fmi2GetVersion(void) {
    fprintf(trace(), "fmi2GetVersion\n");
    return ((Str(*)(void))function("fmi2GetVersion"))();
}

C fmi2Instantiate(Str name, int type, Str guid, Str location, const Callbacks *f, Int visible, Int logging) {
    fprintf(trace(), "fmi2Instantiate instanceName=%s fmuType=%d fmuResourceLocation=%s visible=%d loggingOn=%d", text(name),
            type, text(location), visible, logging);
    if (f)
        fprintf(trace(), " logger=%s allocateMemory=%s freeMemory=%s stepFinished=%s componentEnvironment=%s",
                yes(f->logger), yes(f->allocate), yes(f->release), yes(f->finished), yes(f->environment));
    C c = ((C(*)(Str, int, Str, Str, const Callbacks *, Int, Int))function("fmi2Instantiate"))(name, type, guid, location, f,
                                                                                             visible, logging);
    fprintf(trace(), " -> %s\n", c ? "instance" : "NULL");
    return c;
}

void fmi2FreeInstance(C c) {
    fprintf(trace(), "fmi2FreeInstance\n");
    ((void (*)(C))function("fmi2FreeInstance"))(c);
}

int fmi2SetDebugLogging(C c, Int on, size_t n, const Str *categories) {
    fprintf(trace(), "fmi2SetDebugLogging on=%d n=%zu:", on, n);
    for (size_t i = 0; categories && i < n; i++) fprintf(trace(), " %s", text(categories[i]));
    int status = ((int (*)(C, Int, size_t, const Str *))function("fmi2SetDebugLogging"))(c, on, n, categories);
    fprintf(trace(), " -> %d\n", status);
    return status;
}

PASS(fmi2SetupExperiment, (C c, Int e_on, Real e, Real start, Int stop_on, Real stop), (c, e_on, e, start, stop_on, stop),
     "toleranceDefined=%d tolerance=%g startTime=%g stopTimeDefined=%d stopTime=%g", e_on, e, start, stop_on, stop)
PASS(fmi2EnterInitializationMode, (C c), (c), "")
PASS(fmi2ExitInitializationMode, (C c), (c), "")
PASS(fmi2Terminate, (C c), (c), "")
PASS(fmi2Reset, (C c), (c), "")
GET(fmi2GetReal, Real)
GET(fmi2GetInteger, Int)
GET(fmi2GetBoolean, Int)
GET(fmi2GetString, Str)
SET(fmi2SetReal, Real, "%.17g")
SET(fmi2SetInteger, Int, "%d")
SET(fmi2SetBoolean, Int, "%d")
SET(fmi2SetString, Str, "%s")
PASS(fmi2GetFMUstate, (C c, void **s), (c, s), "")
PASS(fmi2SetFMUstate, (C c, void *s), (c, s), "")
PASS(fmi2FreeFMUstate, (C c, void **s), (c, s), "")
PASS(fmi2SerializedFMUstateSize, (C c, void *s, size_t *n), (c, s, n), "")
PASS(fmi2SerializeFMUstate, (C c, void *s, char *b, size_t n), (c, s, b, n), "n=%zu", n)
PASS(fmi2DeSerializeFMUstate, (C c, const char *b, size_t n, void **s), (c, b, n, s), "n=%zu", n)
PASS(fmi2GetDirectionalDerivative, (C c, const Vr *z, size_t nz, const Vr *v, size_t nv, const Real *dv, Real *dz),
     (c, z, nz, v, nv, dv, dz), "nUnknown=%zu nKnown=%zu", nz, nv)
PASS(fmi2SetRealInputDerivatives, (C c, const Vr *vr, size_t n, const Int *order, const Real *value),
     (c, vr, n, order, value), "n=%zu", n)
PASS(fmi2GetRealOutputDerivatives, (C c, const Vr *vr, size_t n, const Int *order, Real *value), (c, vr, n, order, value),
     "n=%zu", n)
PASS(fmi2DoStep, (C c, Real t, Real h, Int keep), (c, t, h, keep),
     "currentCommunicationPoint=%.17g communicationStepSize=%.17g noSetFMUStatePriorToCurrentPoint=%d", t, h, keep)
PASS(fmi2CancelStep, (C c), (c), "")
PASS(fmi2GetStatus, (C c, int kind, int *value), (c, kind, value), "kind=%d", kind)
PASS(fmi2GetRealStatus, (C c, int kind, Real *value), (c, kind, value), "kind=%d", kind)
PASS(fmi2GetIntegerStatus, (C c, int kind, Int *value), (c, kind, value), "kind=%d", kind)
PASS(fmi2GetBooleanStatus, (C c, int kind, Int *value), (c, kind, value), "kind=%d", kind)
PASS(fmi2GetStringStatus, (C c, int kind, Str *value), (c, kind, value), "kind=%d", kind)
PASS(fmi2EnterEventMode, (C c), (c), "")
PASS(fmi2NewDiscreteStates, (C c, void *info), (c, info), "")
PASS(fmi2EnterContinuousTimeMode, (C c), (c), "")
PASS(fmi2CompletedIntegratorStep, (C c, Int keep, Int *event, Int *end), (c, keep, event, end), "")
PASS(fmi2SetTime, (C c, Real t), (c, t), "")
PASS(fmi2SetContinuousStates, (C c, const Real *x, size_t n), (c, x, n), "")
PASS(fmi2GetDerivatives, (C c, Real *x, size_t n), (c, x, n), "")
PASS(fmi2GetEventIndicators, (C c, Real *x, size_t n), (c, x, n), "")
PASS(fmi2GetContinuousStates, (C c, Real *x, size_t n), (c, x, n), "")
PASS(fmi2GetNominalsOfContinuousStates, (C c, Real *x, size_t n), (c, x, n), "")
