#include "verbs.h"

#include "arguments.h"
#include "report.h"
#include "reproduce/reproduce.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>
#include <string.h>

static const option_spec OPTIONS[] = {
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten list schemes|spaces|formats|models|parameterizations|shapes|results [--json]",
    .summary = "The names that the other verbs take.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = 1,
};

/// A table that `index` walks from 0 on; false past its last row.
typedef bool (*choice_list)(size_t index, bat_choice *choice);

static bool mesh_scheme_row(size_t index, bat_choice *choice)
{
    static char summary[160];
    if (!bat_mesh_scheme_list(index, choice))
        return false;
    (void)snprintf(summary, sizeof summary, "meshes: %s", choice->summary);
    choice->summary = summary;
    return true;
}

static bool mesh_shape_row(size_t index, bat_choice *choice)
{
    const bat_mesh_shape_kind *kind = bat_mesh_shape_at(index);
    *choice = (bat_choice){.settings = "", .endings = ""};
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
    choice->settings = choice->endings = "";
    return true;
}

static bool map_shape_row(size_t index, bat_choice *choice)
{
    *choice = (bat_choice){.name = "map",
                           .settings = "",
                           .summary = "a map of invented countries with lakes, islands and enclaves, as GeoJSON",
                           .endings = ""};
    return index == 0;
}

static bool result_row(size_t index, bat_choice *choice)
{
    *choice = (bat_choice){.settings = "", .endings = ""};
    return reproduce_row(index, &choice->name, &choice->summary);
}

enum
{
    MOST_LISTS = 4
};

/// What can be listed, one table after the other.
static const struct
{
    const char *what;
    choice_list lists[MOST_LISTS];
} FAMILIES[] = {
    {"schemes", {bat_curve_scheme_list, bat_motion_list, mesh_scheme_row}},
    {"spaces", {bat_space_list}},
    {"formats", {bat_curve_format_list, bat_mesh_format_list, bat_cloud_format_list, bat_surface_format_list}},
    {"models", {bat_curve_model_list}},
    {"parameterizations", {bat_surface_parameters_list}},
    {"shapes", {mesh_shape_row, cloud_shape_row, map_shape_row}},
    {"results", {result_row}},
};

static const char *ability_of(const bat_choice *choice)
{
    return choice->reads && choice->writes ? "read and written" : choice->reads ? "read" : "written";
}

static void print_row(const bat_choice *choice)
{
    (void)printf("%-18s %s\n", choice->name, choice->summary);
    if (choice->settings[0] != '\0')
        (void)printf("%-18s settings: %s\n", "", choice->settings);
    if (choice->endings[0] != '\0')
        (void)printf("%-18s %s; %s\n", "", choice->endings, ability_of(choice));
}

static json_t *row_json(const bat_choice *choice)
{
    json_t *object = json_pack("{s:s, s:s}", "name", choice->name, "summary", choice->summary);
    if (choice->settings[0] != '\0')
        (void)json_object_set_new(object, "settings", json_string(choice->settings));
    if (choice->endings[0] == '\0')
        return object;
    (void)json_object_set_new(object, "endings", json_string(choice->endings));
    (void)json_object_set_new(object, "reads", json_boolean(choice->reads));
    (void)json_object_set_new(object, "writes", json_boolean(choice->writes));
    return object;
}

static int print_lists(const char *what, const choice_list lists[MOST_LISTS], bool as_json)
{
    json_t *array = json_array();
    for (size_t l = 0; l < MOST_LISTS && lists[l] != NULL; l++)
    {
        bat_choice choice;
        for (size_t i = 0; lists[l](i, &choice); i++)
            if (as_json)
                (void)json_array_append_new(array, row_json(&choice));
            else
                print_row(&choice);
    }
    if (as_json)
        return report_json(json_pack("{s:o}", what, array));
    json_decref(array);
    return EXIT_DONE;
}

int verb_list(int argc, char **argv)
{
    arguments given;
    int code;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    const char *what = given.positional[0];
    for (size_t i = 0; i < sizeof FAMILIES / sizeof *FAMILIES; i++)
        if (strcmp(what, FAMILIES[i].what) == 0)
            return print_lists(what, FAMILIES[i].lists, argument_flag(&given, "json"));
    return usage_error(&given, "there is no list of '%s'", what);
}
