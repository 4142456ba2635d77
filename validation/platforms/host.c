/* A host in C: runs an FMU of FMI 2.0 for co-simulation and prints the bits of its outputs, to compare platforms.
 *
 * host LIBRARY GUID RESOURCES STEP COUNT REFERENCE...
 *
 * RESOURCES is the resource location as a host passes it, `-` for NULL. Prints a line for each communication point with the
 * outputs of these value references as 16 hexadecimal digits each. The second half of the run is repeated from a state saved
 * in the middle and restored in another instance. Errors: the outputs of both are not bit-identical, a legal call returns an
 * error, or an illegal call returns fmi2OK.
 */
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <windows.h>
#else
#include <dlfcn.h>
#endif

typedef void *Component;
typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, int);
    void *environment;
} Callbacks;

enum { FMI_OK = 0, FMI_WARNING = 1, FMI_ERROR = 3 };

/* Whether an error is expected, so that its message is not printed. */
static int quiet;

static const char *(*get_version)(void);
static Component (*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int);
static void (*free_instance)(Component);
static int (*setup)(Component, int, double, double, int, double);
static int (*enter)(Component), (*leave)(Component), (*terminate)(Component);
static int (*get_real)(Component, const unsigned *, size_t, double *);
static int (*do_step)(Component, double, double, int);
static int (*get_state)(Component, void **), (*set_state)(Component, void *), (*free_state)(Component, void **);

static void fail(const char *what, const char *more) {
    fprintf(stderr, "%s%s\n", what, more);
    exit(1);
}

static void expect(int as_expected, const char *call) {
    if (!as_expected) fail("unexpected status of ", call);
}

static void message(void *environment, const char *name, int status, const char *category, const char *format, ...) {
    (void)environment, (void)name, (void)category;
    if (status < FMI_ERROR || quiet) return;
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

static const Callbacks callbacks = {message, calloc, free, NULL, NULL};

static Component start(const char *guid, const char *resources) {
    Component c = instantiate("platform", 1, guid, resources, &callbacks, 0, 0);
    if (!c) fail("not instantiated with the resource location ", resources ? resources : "NULL");
    expect(setup(c, 0, 0.0, 0.0, 0, 0.0) == FMI_OK, "fmi2SetupExperiment");
    expect(enter(c) <= FMI_WARNING, "fmi2EnterInitializationMode");
    expect(leave(c) <= FMI_WARNING, "fmi2ExitInitializationMode");
    return c;
}

static void outputs(Component c, const unsigned *references, size_t count, uint64_t *bits) {
    double *values = malloc(count * sizeof *values);
    expect(get_real(c, references, count, values) <= FMI_WARNING, "fmi2GetReal");
    memcpy(bits, values, count * sizeof *values);
    free(values);
}

static int run(int count, char **words) {
    if (count < 7) fail("host LIBRARY GUID RESOURCES STEP COUNT REFERENCE...", "");
    const char *guid = words[2], *resources = strcmp(words[3], "-") ? words[3] : NULL;
    double step = strtod(words[4], NULL);
    int steps = atoi(words[5]);
    size_t size = (size_t)count - 6;
    unsigned *references = malloc(size * sizeof *references);
    for (size_t i = 0; i < size; i++) references[i] = (unsigned)strtoul(words[6 + i], NULL, 10);
    uint64_t *rows = malloc((size_t)(steps + 1) * size * sizeof *rows), *again = malloc(size * sizeof *again);

    if (strcmp(get_version(), "2.0")) fail("another version of FMI: ", get_version());
    quiet = 1;
    if (instantiate("wrong", 1, "{of another}", resources, &callbacks, 0, 0)) fail("a wrong GUID was accepted", "");
    quiet = 0;
    free_instance(NULL);
    Component first = start(guid, resources), second = start(guid, resources);
    void *state = NULL;
    for (int i = 0; i <= steps; i++) {
        if (i == steps / 2) {
            quiet = 1;
            expect(do_step(first, i * step, NAN, 1) == FMI_ERROR, "fmi2DoStep by NaN");
            quiet = 0;
            expect(get_state(first, &state) == FMI_OK, "fmi2GetFMUstate");
        }
        outputs(first, references, size, rows + (size_t)i * size);
        if (i < steps) expect(do_step(first, i * step, step, 1) <= FMI_WARNING, "fmi2DoStep");
    }
    expect(set_state(second, state) == FMI_OK, "fmi2SetFMUstate");
    for (int i = steps / 2; i <= steps; i++) {
        outputs(second, references, size, again);
        if (memcmp(again, rows + (size_t)i * size, size * sizeof *again)) fail("a restored state goes on with other bits", "");
        if (i < steps) expect(do_step(second, i * step, step, 1) <= FMI_WARNING, "fmi2DoStep");
    }
    expect(free_state(first, &state) == FMI_OK && !state, "fmi2FreeFMUstate");
    expect(terminate(first) == FMI_OK, "fmi2Terminate");
    free_instance(first);
    free_instance(second);
    for (int i = 0; i <= steps; i++) {
        for (size_t k = 0; k < size; k++) printf("%016" PRIx64 "%c", rows[(size_t)i * size + k], k + 1 < size ? ' ' : '\n');
    }
    return 0;
}

#ifdef _WIN32
static void *symbol(HMODULE library, const char *name) {
    void *found = (void *)GetProcAddress(library, name);
#else
static void *symbol(void *library, const char *name) {
    void *found = dlsym(library, name);
#endif
    if (!found) fail("not exported: ", name);
    return found;
}

#define FIND(variable, name) *(void **)&variable = symbol(library, name)
#define FIND_ALL                                                                                                       \
    FIND(get_version, "fmi2GetVersion"), FIND(instantiate, "fmi2Instantiate"), FIND(setup, "fmi2SetupExperiment"),     \
        FIND(enter, "fmi2EnterInitializationMode"), FIND(leave, "fmi2ExitInitializationMode"),                         \
        FIND(terminate, "fmi2Terminate"), FIND(free_instance, "fmi2FreeInstance"), FIND(get_real, "fmi2GetReal"),      \
        FIND(do_step, "fmi2DoStep"), FIND(get_state, "fmi2GetFMUstate"), FIND(set_state, "fmi2SetFMUstate"),           \
        FIND(free_state, "fmi2FreeFMUstate")

#ifdef _WIN32
int wmain(int count, wchar_t **wide) {
    HMODULE library = count > 1 ? LoadLibraryW(wide[1]) : NULL;
    if (!library) fail("the library cannot be loaded", "");
    FIND_ALL;
    char **words = calloc((size_t)count + 1, sizeof *words);
    for (int i = 0; i < count; i++) {
        int length = WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, NULL, 0, NULL, NULL);
        words[i] = malloc((size_t)length);
        WideCharToMultiByte(CP_UTF8, 0, wide[i], -1, words[i], length, NULL, NULL);
    }
    return run(count, words);
}
#else
int main(int count, char **words) {
    void *library = count > 1 ? dlopen(words[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    if (!library) fail("the library cannot be loaded: ", dlerror());
    FIND_ALL;
    return run(count, words);
}
#endif
