#include "verb.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>
#include <string.h>

/// Shapes beside those of meshes.
static const bat_choice SHAPES[] = {
    {.name = "hull",
     .summary = "a cloud of points: a ship's side from bow to stern and from keel to deck, with bulb and knuckle"},
    {.name = "blade", .summary = "a cloud of points: a turbine blade, twisted and tapered, round its leading edge"},
    {.name = "scan",
     .summary = "a cloud of points: a mask as a scanner sees it, with noise, uneven lines and a gap, in no order"},
    {.name = "map", .summary = "a map of invented countries with lakes, islands and enclaves, as GeoJSON"},
};

static bool shape_row(size_t index, bat_choice *choice)
{
    const bat_mesh_shape_kind *kind = bat_mesh_shape_at(index);
    size_t other = index - bat_mesh_shape_count();
    if (kind == NULL && other >= sizeof SHAPES / sizeof *SHAPES)
        return false;
    *choice = kind != NULL ? (bat_choice){.name = kind->name, .summary = kind->summary} : SHAPES[other];
    return true;
}

static bool published_model_row(size_t index, bat_choice *choice)
{
    *choice = (bat_choice){
        .name = "learned-published",
        .summary = "the network of Ugail and Howard (2026), 140,505 weights, to compare with; weights/tension-published.md"};
    return index == 0;
}

static bool result_row(size_t index, bat_choice *choice)
{
    *choice = (bat_choice){0};
    return reproduce_row(index, &choice->name, &choice->summary);
}

enum
{
    MAX_FAMILIES = 4
};

/// What can be listed: families of the library, then a table of the program.
typedef struct listing
{
    const char *what;
    const bat_family *families[MAX_FAMILIES];
    bool (*row)(size_t index, bat_choice *choice); ///< from 0 on; false past the last one. Null for no table
} listing;

static const listing LISTINGS[] = {
    {"schemes", {&bat_curve_scheme_family, &bat_motion_scheme_family, &bat_mesh_scheme_family}, NULL},
    {"spaces", {&bat_space_family}, NULL},
    {"formats",
     {&bat_curve_format_family, &bat_mesh_format_family, &bat_cloud_format_family, &bat_surface_format_family},
     NULL},
    {"models", {&bat_curve_model_family}, published_model_row},
    {"parameterizations", {&bat_surface_parameters_family}, NULL},
    {"shapes", {NULL}, shape_row},
    {"results", {NULL}, result_row},
    {NULL, {NULL}, NULL},
};

static void add_row(report_table *table, const bat_choice *choice, const char *summary)
{
    bool filed = choice->endings != NULL;
    report_row(table,
               "{name:-18} {summary}\n[settings?                   settings: {settings}\n]"
               "[endings?                   {endings}; [can_read?read[both? and ]][can_write?written]\n]",
               "name:s summary:s settings:s? endings:s? reads:o? writes:o? -can_read:b -can_write:b -both:b", choice->name,
               summary, choice->settings, choice->endings, filed ? json_boolean(choice->reads) : json_null(),
               filed ? json_boolean(choice->writes) : json_null(), (int)choice->reads,
               (int)(choice->writes || !choice->reads), (int)(choice->reads && choice->writes));
}

static int make(void *of)
{
    const verb_call *call = of;
    const listing *all = LISTINGS;
    while (all->what != NULL && strcmp(call->input, all->what) != 0)
        all++;
    if (all->what == NULL)
        return usage_error(call->given, "there is no list of '%s'", call->input);
    report_table table = report_begin(call->json);
    const bat_choice *row;
    bat_choice choice;
    char summary[160], keys[32];
    for (size_t l = 0; l < MAX_FAMILIES && all->families[l] != NULL; l++)
        for (size_t i = 0; (row = bat_choices(all->families[l], i)) != NULL; i++)
        {
            bool mesh = all->families[l] == &bat_mesh_scheme_family; // whose names are also names of curve schemes
            (void)snprintf(summary, sizeof summary, "meshes: %s", row->summary);
            add_row(&table, row, mesh ? summary : row->summary);
        }
    for (size_t i = 0; all->row != NULL && all->row(i, &choice); i++)
        add_row(&table, &choice, choice.summary);
    (void)snprintf(keys, sizeof keys, "%s:o", all->what);
    return report_print(call->json, "", keys, table.rows);
}

const verb VERB_LIST = {
    .name = "list",
    .arguments = "schemes|spaces|formats|models|parameterizations|shapes|results [--json]",
    .summary = "list schemes, spaces, shapes and published results",
    .about = "The names that the other verbs take.",
    .example = "batten list schemes",
    .options = {{JSON_OPTION, 0}},
    .positional = {1, 1},
    .words = "schemes spaces formats models parameterizations shapes results",
    .calls = {NULL, NULL, make, NULL, NULL, NULL},
};
