#include "mesh/refine/scheme.h"

#include "mesh/refine/loop.h"

static const mesh_scheme SCHEMES[] = {
    {.choice = {.name = "learned",
                .summary = "by the network that comes with batten, or by a model; the default; docs/mesh-network.md",
                .value = BAT_MESH_SCHEME_LEARNED},
     .rule = midpoint_rule,
     .learned = true},
    {.choice = {.name = "loop",
                .summary = "Loop's scheme, smooth, with creases and corners; docs/meshes.md",
                .value = BAT_MESH_SCHEME_LOOP},
     .rule = loop_rule,
     .limit = loop_limit,
     .continues = true,
     .creases = true},
    {.choice = {.name = "butterfly",
                .summary = "the modified butterfly, through all vertices",
                .value = BAT_MESH_SCHEME_BUTTERFLY},
     .rule = butterfly_rule,
     .continues = true},
    {.choice = {.name = "midpoint", .summary = "four faces from one, the same surface", .value = BAT_MESH_SCHEME_MIDPOINT},
     .rule = midpoint_rule,
     .continues = true},
    {.choice = {.name = "sqrt3",
                .summary = "Kobbelt's square-root-three, three faces from one",
                .value = BAT_MESH_SCHEME_SQRT3},
     .turns = true},
};
static const choice_table TABLE = CHOICE_TABLE("mesh scheme", SCHEMES);

const mesh_scheme *mesh_scheme_of(bat_mesh_scheme scheme)
{
    return (const mesh_scheme *)(const void *)choice_of_value(&TABLE, (int)scheme);
}

bool bat_mesh_scheme_list(size_t index, bat_choice *choice)
{
    return choice_list(&TABLE, index, choice);
}

const char *bat_mesh_scheme_name(bat_mesh_scheme scheme)
{
    return choice_name(&TABLE, (int)scheme);
}

bat_status bat_mesh_scheme_by_name(const char *name, bat_mesh_scheme *scheme, bat_error *error)
{
    int value;
    bat_status status = choice_by_name(&TABLE, name, &value, error);
    if (status == BAT_OK)
        *scheme = (bat_mesh_scheme)value;
    return status;
}
