#include "mesh/refine/scheme.h"

static const mesh_scheme SCHEMES[] = {
    {.choice = CHOICE("learned", "by the network that comes with batten, or by a model; docs/algorithms/mesh-network.md",
                      BAT_MESH_SCHEME_LEARNED),
     .rule = midpoint_rule,
     .learned = true},
    {.choice = CHOICE("loop", "Loop's scheme, smooth, with creases and corners; docs/algorithms/mesh-schemes.md",
                      BAT_MESH_SCHEME_LOOP),
     .rule = loop_rule,
     .limit = loop_limit,
     .continues = true,
     .creases = true,
     .smooth = loop_smooth_mask},
    {.choice = CHOICE("catmull-clark", "Catmull and Clark's scheme, smooth, for quads and other polygons; quads come out",
                      BAT_MESH_SCHEME_CATMULL_CLARK),
     .rule = catmull_clark_rule,
     .limit = catmull_clark_limit,
     .creases = true,
     .polygons = true,
     .smooth = catmull_clark_smooth_mask},
    {.choice = CHOICE("butterfly", "the modified butterfly, through all vertices", BAT_MESH_SCHEME_BUTTERFLY),
     .rule = butterfly_rule,
     .continues = true},
    {.choice = CHOICE("midpoint", "four faces from one, the same surface", BAT_MESH_SCHEME_MIDPOINT),
     .rule = midpoint_rule,
     .continues = true},
    {.choice = CHOICE("sqrt3", "Kobbelt's square-root-three, three faces from one", BAT_MESH_SCHEME_SQRT3), .turns = true},
    {.choice =
         {.name = "auto",
          .summary =
              "the default: catmull-clark for meshes of mostly quads or other polygons, loop for meshes with creases or "
              "corners, and of fewer than 100 faces but solids and cones, else learned",
          .value = BAT_MESH_SCHEME_AUTO},
     .rule = midpoint_rule,
     .learned = true},
};
const bat_family bat_mesh_scheme_family = FAMILY("mesh scheme", SCHEMES);

const mesh_scheme *mesh_scheme_of(bat_mesh_scheme scheme)
{
    return (const mesh_scheme *)(const void *)choice_of_value(&bat_mesh_scheme_family, (int)scheme);
}

bat_mesh_scheme bat_mesh_scheme_for(const bat_mesh *mesh)
{
    bool sharp = false;
    size_t polygons = 0;
    for (size_t f = 0; mesh->offsets != NULL && f < mesh->face_count; f++)
        polygons += mesh->offsets[f + 1] - mesh->offsets[f] > 3;
    if (2 * polygons > mesh->face_count)
        return BAT_MESH_SCHEME_CATMULL_CLARK;
    for (size_t i = 0; i < mesh->crease_count; i++)
        sharp = sharp || mesh->creases[i].sharpness > 0;
    for (size_t i = 0; i < mesh->corner_count; i++)
        sharp = sharp || mesh->corners[i].sharpness > 0;
    bool cage = sharp, solid = false;
    if (!cage && mesh->face_count < BAT_MESH_CAGE_FACES)
    {
        if (bat_mesh_is_solid(mesh, &solid, NULL) != BAT_OK)
            return BAT_MESH_SCHEME_AUTO;
        cage = !solid; // and has no pole: a vertex of many faces
        for (size_t i = 0; i < 3 * mesh->face_count && mesh->offsets == NULL && cage; i++)
        {
            size_t around = 0;
            for (size_t j = 0; j < 3 * mesh->face_count; j++)
                around += mesh->faces[j] == mesh->faces[i];
            cage = around < 8 || 8 * around < mesh->face_count;
        }
    }
    return cage ? BAT_MESH_SCHEME_LOOP : BAT_MESH_SCHEME_LEARNED;
}
