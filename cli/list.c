#include "verbs.h"

#include "arguments.h"
#include "report.h"
#include "reproduce.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>
#include <string.h>

static const option_spec OPTIONS[] = {
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten list schemes|spaces|models|shapes|parameterizations|results [--json]",
    .summary = "The names that the other verbs take.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = 1,
};

static const struct
{
    const char *name, *summary;
} SPACES[] = {
    {"plane", "R^2"},
    {"euclidean", "R^n, n from the file"},
    {"sphere", "unit vectors, or longitude and latitude in degrees; S^2, or S^n from the file"},
    {"disk", "the hyperbolic plane as the Poincaré disk, points of length below 1"},
    {"rotation", "rotations of R^3: quaternions, matrices or rotation vectors by the names of the columns; else w, x, y, z"},
    {"rigid", "poses: translation and rotation, or timestamp tx ty tz qx qy qz qw as in the TUM format"},
    {"spd", "symmetric positive-definite matrices (tensors), the upper triangle row by row: xx, xy, xz, yy, yz, zz"},
    {"hyperbolic", "the hyperboloid in R^(n+1), n from the file: x0, then x"},
};

static const struct
{
    const char *name, *summary;
} MODELS[] = {
    {"learned", "the curve scheme that comes with the library, 100,160 weights; weights/batten.md"},
    {"learned-published",
     "the network of Ugail and Howard (2026), 140,505 weights, to compare with; weights/tension-published.md"},
};

static const struct
{
    const char *name, *summary;
} MESH_SCHEMES[] = {
    {"loop", "meshes: Loop's scheme, smooth, with creases and corners; docs/meshes.md"},
    {"butterfly", "meshes: the modified butterfly, through all vertices"},
    {"midpoint", "meshes: every face in four, the surface as it was"},
    {"sqrt3", "meshes: Kobbelt's square-root-three, three faces from one"},
    {"learned", "meshes: by the network that comes with batten, the default, or by --model FILE; docs/mesh-network.md"},
};

static const struct
{
    const char *name, *summary;
} CLOUD_SHAPES[] = {
    {"hull", "a cloud of points: a ship's side from bow to stern and from keel to deck, with bulb and knuckle"},
    {"blade", "a cloud of points: a turbine blade, twisted and tapered, round its leading edge"},
    {"scan", "a cloud of points: a mask as a scanner sees it, with noise, uneven lines and a gap, in no order"},
};

/// One row of a list: its name, settings (may be null) and summary.
typedef bool (*row_function)(size_t index, const char **name, const char **settings, const char **summary);

static bool space_row(size_t index, const char **name, const char **settings, const char **summary)
{
    if (index >= sizeof SPACES / sizeof SPACES[0])
        return false;
    *name = SPACES[index].name;
    *settings = NULL;
    *summary = SPACES[index].summary;
    return true;
}

static bool mesh_scheme_row(size_t index, const char **name, const char **settings, const char **summary)
{
    if (index >= sizeof MESH_SCHEMES / sizeof MESH_SCHEMES[0])
        return false;
    *name = MESH_SCHEMES[index].name;
    *settings = NULL;
    *summary = MESH_SCHEMES[index].summary;
    return true;
}

/// The schemes for points, those for points with tangents, those for meshes.
static bool scheme_row(size_t index, const char **name, const char **settings, const char **summary)
{
    bool (*const lists[])(size_t, const char **, const char **, const char **) = {bat_curve_scheme_list, bat_hermite_list,
                                                                                  mesh_scheme_row};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++)
    {
        size_t count = 0;
        while (lists[i](count, name, settings, summary))
            if (count++ == index)
                return true;
        index -= count;
    }
    return false;
}

static bool model_row(size_t index, const char **name, const char **settings, const char **summary)
{
    if (index >= sizeof MODELS / sizeof MODELS[0])
        return false;
    *name = MODELS[index].name;
    *settings = NULL;
    *summary = MODELS[index].summary;
    return true;
}

static bool cloud_shape_row(size_t index, const char **name, const char **settings, const char **summary)
{
    if (index >= sizeof CLOUD_SHAPES / sizeof CLOUD_SHAPES[0])
        return false;
    *name = CLOUD_SHAPES[index].name;
    *settings = NULL;
    *summary = CLOUD_SHAPES[index].summary;
    return true;
}

/// Meshes, then clouds.
static bool shape_row(size_t index, const char **name, const char **settings, const char **summary)
{
    const bat_mesh_shape_kind *kind = bat_mesh_shape_at(index);
    if (kind == NULL)
        return cloud_shape_row(index - bat_mesh_shape_count(), name, settings, summary);
    *name = kind->name;
    *settings = NULL;
    *summary = kind->summary;
    return true;
}

/// Where surfaces get their parameters from.
static const struct
{
    const char *name, *summary;
} PARAMETERIZATIONS[] = {
    {"auto", "learned, shape-preserving and stretch-minimizing ones, mean values for a mesh: those that fit best by "
             "measure; docs/surfaces.md"},
    {"learned", "the network that comes with batten, or --model FILE; docs/surface-network.md"},
    {"shape-preserving", "Floater's weights on the Delaunay neighbours in local planes; docs/parameterization.md"},
    {"inverse-distance", "weights by the inverse distance of neighbours"},
    {"uniform", "all neighbours weigh the same"},
    {"mean-value", "Floater's mean values, for clouds that are meshes"},
    {"stretch-minimizing", "shape-preserving, evened out: for deep shapes"},
};

static bool parameterization_row(size_t index, const char **name, const char **settings, const char **summary)
{
    if (index >= sizeof PARAMETERIZATIONS / sizeof PARAMETERIZATIONS[0])
        return false;
    *name = PARAMETERIZATIONS[index].name;
    *settings = NULL;
    *summary = PARAMETERIZATIONS[index].summary;
    return true;
}

static bool result_row(size_t index, const char **name, const char **settings, const char **summary)
{
    *settings = NULL;
    return reproduce_row(index, name, summary);
}

static int print_rows(const char *what, row_function row, bool as_json)
{
    json_t *array = json_array();
    const char *name, *settings, *summary;
    for (size_t i = 0; row(i, &name, &settings, &summary); i++)
    {
        if (as_json)
        {
            json_t *object = json_pack("{s:s, s:s}", "name", name, "summary", summary);
            if (settings != NULL)
                (void)json_object_set_new(object, "settings", json_string(settings));
            (void)json_array_append_new(array, object);
        }
        else
        {
            (void)printf("%-18s %s\n", name, summary);
            if (settings != NULL && settings[0] != '\0')
                (void)printf("%-18s settings: %s\n", "", settings);
        }
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
    bool as_json = argument_flag(&given, "json");
    if (strcmp(what, "schemes") == 0)
        return print_rows(what, scheme_row, as_json);
    if (strcmp(what, "spaces") == 0)
        return print_rows(what, space_row, as_json);
    if (strcmp(what, "models") == 0)
        return print_rows(what, model_row, as_json);
    if (strcmp(what, "shapes") == 0)
        return print_rows(what, shape_row, as_json);
    if (strcmp(what, "parameterizations") == 0)
        return print_rows(what, parameterization_row, as_json);
    if (strcmp(what, "results") == 0)
        return print_rows(what, result_row, as_json);
    return usage_error(&given, "there is no list of '%s'", what);
}
