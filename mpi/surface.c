#include "verbs.h"

#include "counts.h"
#include "ranks.h"

#include <stdio.h>

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the surface to OUT"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten-mpi surface IN -o OUT [options]",
    .summary = "Fit an adaptive spline surface to the points of a file, divided among the ranks.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = 1,
    .reads_files = true,
};

int verb_surface(int argc, char **argv)
{
    arguments given;
    int code;
    bat_error error = {.status = BAT_UNSUPPORTED, .text = "this verb is not there yet"};
    if (!ranks_read_arguments(&SPEC, argc, argv, &given, &code))
        return code;
    counts_summary summary = counts_collect();
    if (ranks_rank() == 0)
        counts_print(&summary, stdout);
    ranks_need(given.positional[0], BAT_UNSUPPORTED, &error);
    return EXIT_BAD_INPUT;
}
