#include "verbs.h"

#include "arguments.h"
#include "interrupt.h"
#include "report.h"
#include "terminal.h"

#include <stdio.h>
#include <string.h>

static const struct
{
    const char *name;
    int (*run)(int argc, char **argv);
    const char *summary;
} VERBS[] = {
    {"curve", verb_curve, "refine the curves of a file, to a file and a picture"},
    {"motion", verb_motion, "make a smooth motion of keyframes: points, rotations, poses or tensors in time"},
    {"decimate", verb_decimate, "make a coarse mesh of a fine one, with a map between the two"},
    {"mesh", verb_mesh, "refine a triangle mesh, to a file and a picture"},
    {"surface", verb_surface, "fit a spline surface to scattered points, to CAD files and a picture"},
    {"measure", verb_measure, "measure curves or meshes, and the distances between two"},
    {"shape", verb_shape, "make a test shape: creatures, machine parts, knots, a cage, clouds of points"},
    {"analyze", verb_analyze, "analyze the limit of a linear scheme, with proven bounds"},
    {"reproduce", verb_reproduce, "compute published tables and figures, beside the published ones"},
    {"train", verb_train, "train a learned scheme from the published recipe"},
    {"list", verb_list, "list schemes, spaces, shapes and published results"},
};
enum
{
    VERB_COUNT = sizeof VERBS / sizeof VERBS[0]
};

static void print_overview(FILE *to)
{
    (void)fputs("batten turns coarse geometry into fair geometry.\n\nusage: batten VERB [arguments]\n\n", to);
    for (int i = 0; i < VERB_COUNT; i++)
        (void)fprintf(to, "  %-10s %s\n", VERBS[i].name, VERBS[i].summary);
    (void)fputs("\n`batten help VERB` explains a verb; `batten --version` prints the version.\n", to);
}

/// The verb of that name; -1 after a message when there is none.
static int find_verb(const char *name)
{
    for (int i = 0; i < VERB_COUNT; i++)
        if (strcmp(name, VERBS[i].name) == 0)
            return i;
    terminal_print(stderr, "batten: there is no verb '%s'; `batten --help` names them\n", name);
    return -1;
}

/// `batten help`, `batten help VERB`
static int help(int argc, char **argv)
{
    if (argc < 3)
    {
        print_overview(stdout);
        return EXIT_DONE;
    }
    int verb = find_verb(argv[2]);
    char *words[] = {argv[2], "--help", NULL};
    return verb < 0 ? EXIT_BAD_USAGE : VERBS[verb].run(2, words);
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
    int verb = find_verb(argv[1]);
    return verb < 0 ? EXIT_BAD_USAGE : VERBS[verb].run(argc - 1, argv + 1);
}

int main(int argc, char **argv)
{
    interrupt_catch();
    return report_end(run(argc, argv));
}
