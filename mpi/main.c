#include "verbs.h"

#include "counts.h"
#include "ranks.h"
#include "report.h"
#include "solver.h"

#include "batten/base.h"

#if defined(__GLIBC__)
#include <malloc.h>
#include <signal.h>
#endif
#include <mpi.h>
#include <stdio.h>
#include <string.h>

static const struct
{
    const char *name;
    int (*run)(int argc, char **argv);
    const char *summary;
} VERBS[] = {
    {"surface", verb_surface, "fit a spline surface to scattered points, to CAD files"},
    {"train", verb_train_together, "train a learned rule; as `batten train`"},
};
enum
{
    VERB_COUNT = sizeof VERBS / sizeof VERBS[0]
};

static void print_overview(FILE *to)
{
    (void)fputs("batten-mpi divides one piece of work among processes: mpirun -n 8 batten-mpi VERB [arguments]\n\n", to);
    for (int i = 0; i < VERB_COUNT; i++)
        (void)fprintf(to, "  %-10s %s\n", VERBS[i].name, VERBS[i].summary);
    (void)fputs("\n`batten-mpi VERB --help` explains a verb; `batten-mpi --version` prints the version.\n", to);
}

static int run(int argc, char **argv, bool speaks)
{
    bool helps = argc > 1 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0);
    if (argc < 2 || helps)
    {
        if (speaks)
            print_overview(helps ? stdout : stderr);
        return helps ? EXIT_DONE : EXIT_BAD_USAGE;
    }
    if (strcmp(argv[1], "--version") == 0)
    {
        if (speaks)
            (void)printf("batten-mpi %s\n", bat_version());
        return EXIT_DONE;
    }
    for (int i = 0; i < VERB_COUNT; i++)
        if (strcmp(argv[1], VERBS[i].name) == 0)
            return VERBS[i].run(argc - 1, argv + 1);
    if (speaks)
        report_text(stderr, "batten: there is no verb '%s'; `batten-mpi --help` names them\n", argv[1]);
    return EXIT_BAD_USAGE;
}

/// Give the memory of large arrays back to the system when they are freed. By default glibc keeps arrays of up to 32 MiB in
/// its heap once one of that size was freed; what is freed below a later array then stays with the process.
static void keep_memory_small(void)
{
#if defined(__GLIBC__)
    enum
    {
        LARGE_ARRAY = 1 << 19,
        FREE_AT_END = 1 << 20
    };
    (void)mallopt(M_MMAP_THRESHOLD, LARGE_ARRAY);
    (void)mallopt(M_TRIM_THRESHOLD, FREE_AT_END);
#endif
}

int main(int argc, char **argv)
{
    keep_memory_small();
    // Threads of OpenMP work beside the one that calls MPI.
    int provided;
    if (MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided) != MPI_SUCCESS)
        return EXIT_BAD_INPUT;
    bool speaks = ranks_rank() == 0;
    // Only rank 0 prints results.
    int code = speaks || freopen("/dev/null", "w", stdout) != NULL ? run(argc, argv, speaks) : EXIT_BAD_INPUT;
    if (fflush(stdout) != 0 && code == EXIT_DONE)
        code = EXIT_BAD_INPUT;
    // mpirun ends the other ranks by a signal where one has failed: that is no message of its own.
    (void)signal(SIGTERM, SIG_DFL);
    petsc_end();
    (void)MPI_Finalize();
    return code;
}
