#include "verb.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#if defined(_OPENMP) && defined(__linux__)
#include <sys/auxv.h>
#include <sys/stat.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif

static void print_overview(FILE *to)
{
    (void)fputs("batten turns coarse geometry into fair geometry.\n\nusage: batten VERB [arguments]\n\n", to);
    for (const verb *const *each = VERBS; *each != NULL; each++)
        (void)fprintf(to, "  %-14s %s\n", (*each)->name, (*each)->summary);
    (void)fputs("\n`batten help VERB` explains a verb; `batten --version` prints the version.\n", to);
}

/// Run the verb that argv[0] names.
static int run_verb(int argc, char **argv)
{
    if (strcmp(argv[0], "train") == 0)
        return train_in_group(argc, argv, NULL, 0);
    for (const verb *const *each = VERBS; *each != NULL; each++)
        if (strcmp(argv[0], (*each)->name) == 0)
            return verb_run(*each, argc, argv);
    report_text(stderr, "batten: there is no verb '%s'; `batten --help` names them\n", argv[0]);
    return EXIT_BAD_USAGE;
}

/// `batten help`, `batten help VERB`, `batten help VERB all`
static int help(int argc, char **argv)
{
    if (argc < 3)
    {
        print_overview(stdout);
        return EXIT_DONE;
    }
    bool all = argc > 3 && strcmp(argv[argc - 1], "all") == 0, two = argc > 3 + all;
    char option[] = "--help", *words[5] = {argv[2]};
    int count = 1;
    if (two)
        words[count++] = argv[3];
    words[count++] = option;
    if (all)
        words[count++] = argv[argc - 1];
    return run_verb(count, words);
}

static int run(int argc, char **argv)
{
    if (argc < 2)
    {
        print_overview(stderr);
        return EXIT_BAD_USAGE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0)
        return help(argc, argv);
    if (strcmp(argv[1], "--version") == 0)
    {
        (void)printf("batten %s\n", bat_version());
        return EXIT_DONE;
    }
    return run_verb(argc - 1, argv + 1);
}

/// Return large arrays to the system when they are freed. By default glibc stops doing so once it has freed one.
static void return_large_arrays(void)
{
#ifdef __GLIBC__
    enum
    {
        LARGE = 1 << 20,      ///< bytes of an array with pages of its own
        KEPT_FREE = 32 << 20, ///< bytes at the end of the heap
    };
    (void)mallopt(M_MMAP_THRESHOLD, LARGE);
    (void)mallopt(M_TRIM_THRESHOLD, KEPT_FREE);
#endif
}

#if defined(_OPENMP) && defined(__linux__)
/// Whether /proc/self/exe is this program. It is the loader where a user starts that (`ld.so batten ...`), which the kernel
/// then gives no loader of its own, and the emulator under QEMU, which is another file than the one that it executes.
static bool can_begin_anew(void)
{
    const char *started = (const char *)getauxval(AT_EXECFN);
    struct stat program, process;
    return started != NULL && getauxval(AT_BASE) != 0 && stat(started, &program) == 0 &&
           stat("/proc/self/exe", &process) == 0 && program.st_dev == process.st_dev && program.st_ino == process.st_ino;
}

/// Let threads that wait for others spin for some microseconds only, unless the environment says how they wait. The default
/// of OpenMP's runtimes, 10 to 200 ms, costs several times the work where other programs have the processors. The runtimes
/// read this once, before main(), so that the program begins anew.
static void wait_briefly(char **argv)
{
    static const char *const NAMES[] = {"OMP_WAIT_POLICY", "GOMP_SPINCOUNT", "KMP_BLOCKTIME"};
    for (size_t k = 0; k < sizeof NAMES / sizeof *NAMES; k++)
        if (getenv(NAMES[k]) != NULL)
            return;
    if (can_begin_anew() && setenv("GOMP_SPINCOUNT", "1000", 0) == 0 && setenv("KMP_BLOCKTIME", "0", 0) == 0)
        (void)execv("/proc/self/exe", argv);
}
#endif

int main(int argc, char **argv)
{
#if defined(_OPENMP) && defined(__linux__)
    if (argc > 2)
        wait_briefly(argv);
#endif
    return_large_arrays();
    interrupt_catch();
    int code = report_end(run(argc, argv));
    // The ends of libraries wait for their threads, which may try for ever to get memory.
    if (interrupt_memory_is_limited() && fflush(NULL) == 0)
        _exit(code);
    return code;
}
