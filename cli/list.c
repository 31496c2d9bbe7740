#include "report.h"
#include "reproduce/reproduce.h"
#include "verb.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>
#include <string.h>

/// A table that `index` walks from 0 on; false past its last row.
typedef bool (*choice_list)(size_t index, bat_choice *choice);

static bool mesh_shape_row(size_t index, bat_choice *choice)
{
    const bat_mesh_shape_kind *kind = bat_mesh_shape_at(index);
    *choice = (bat_choice){0};
    if (kind == NULL)
        return false;
    choice->name = kind->name;
    choice->summary = kind->summary;
    return true;
}

static bool cloud_shape_row(size_t index, bat_choice *choice)
{
    static const bat_choice SHAPES[] = {
        {.name = "hull",
         .summary = "a cloud of points: a ship's side from bow to stern and from keel to deck, with bulb and knuckle"},
        {.name = "blade", .summary = "a cloud of points: a turbine blade, twisted and tapered, round its leading edge"},
        {.name = "scan",
         .summary = "a cloud of points: a mask as a scanner sees it, with noise, uneven lines and a gap, in no order"},
    };
    if (index >= sizeof SHAPES / sizeof *SHAPES)
        return false;
    *choice = SHAPES[index];
    return true;
}

static bool map_shape_row(size_t index, bat_choice *choice)
{
    *choice =
        (bat_choice){.name = "map", .summary = "a map of invented countries with lakes, islands and enclaves, as GeoJSON"};
    return index == 0;
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
    MAX_LISTS = 4
};

/// What can be listed: families of the library, then tables of the program.
typedef struct listing
{
    const char *what;
    const bat_family *families[MAX_LISTS];
    choice_list lists[MAX_LISTS];
} listing;

static const listing LISTINGS[] = {
    {"schemes", {&bat_curve_scheme_family, &bat_motion_scheme_family, &bat_mesh_scheme_family}, {NULL}},
    {"spaces", {&bat_space_family}, {NULL}},
    {"formats",
     {&bat_curve_format_family, &bat_mesh_format_family, &bat_cloud_format_family, &bat_surface_format_family},
     {NULL}},
    {"models", {&bat_curve_model_family}, {published_model_row}},
    {"parameterizations", {&bat_surface_parameters_family}, {NULL}},
    {"shapes", {NULL}, {mesh_shape_row, cloud_shape_row, map_shape_row}},
    {"results", {NULL}, {result_row}},
};

static const char *ability_of(const bat_choice *choice)
{
    return choice->reads && choice->writes ? "read and written" : choice->reads ? "read" : "written";
}

static void print_row(const bat_choice *choice)
{
    (void)printf("%-18s %s\n", choice->name, choice->summary);
    if (choice->settings != NULL)
        (void)printf("%-18s settings: %s\n", "", choice->settings);
    if (choice->endings != NULL)
        (void)printf("%-18s %s; %s\n", "", choice->endings, ability_of(choice));
}

static json_t *row_json(const bat_choice *choice)
{
    json_t *object = json_pack("{s:s, s:s}", "name", choice->name, "summary", choice->summary);
    if (choice->settings != NULL)
        (void)json_object_set_new(object, "settings", json_string(choice->settings));
    if (choice->endings == NULL)
        return object;
    (void)json_object_set_new(object, "endings", json_string(choice->endings));
    (void)json_object_set_new(object, "reads", json_boolean(choice->reads));
    (void)json_object_set_new(object, "writes", json_boolean(choice->writes));
    return object;
}

static void add_row(const bat_choice *choice, json_t *array)
{
    if (array != NULL)
        (void)json_array_append_new(array, row_json(choice));
    else
        print_row(choice);
}

static int print_listing(const listing *all, bool as_json)
{
    json_t *array = as_json ? json_array() : NULL;
    const bat_choice *row;
    bat_choice choice;
    char summary[160];
    for (size_t l = 0; l < MAX_LISTS && all->families[l] != NULL; l++)
        for (size_t i = 0; (row = bat_choices(all->families[l], i)) != NULL; i++)
        {
            choice = *row;
            bool mesh = all->families[l] == &bat_mesh_scheme_family; // whose names are also names of curve schemes
            (void)snprintf(summary, sizeof summary, "meshes: %s", choice.summary);
            choice.summary = mesh ? summary : choice.summary;
            add_row(&choice, array);
        }
    for (size_t l = 0; l < MAX_LISTS && all->lists[l] != NULL; l++)
        for (size_t i = 0; all->lists[l](i, &choice); i++)
            add_row(&choice, array);
    return as_json ? report_json(json_pack("{s:o}", all->what, array)) : EXIT_DONE;
}

static int make(void *of)
{
    const verb_call *call = of;
    for (size_t i = 0; i < sizeof LISTINGS / sizeof *LISTINGS; i++)
        if (strcmp(call->input, LISTINGS[i].what) == 0)
            return print_listing(&LISTINGS[i], call->json);
    return usage_error(call->given, "there is no list of '%s'", call->input);
}

const verb VERB_LIST = {
    .name = "list",
    .arguments = "schemes|spaces|formats|models|parameterizations|shapes|results [--json]",
    .summary = "list schemes, spaces, shapes and published results",
    .about = "The names that the other verbs take.",
    .example = "batten list schemes",
    .options = (const option_table[]){{JSON_OPTION, 0}, {NULL, 0}},
    .min_positional = 1,
    .max_positional = 1,
    .words = "schemes spaces formats models parameterizations shapes results",
    .job_size = sizeof(verb_call),
    .make = make,
};
