/// @file
/// The table of mesh shapes, and bat_mesh_shape(): draw the parameters, mesh the solid, normalize.

#include "research/shapes/mesh_shape.h"

#include "base/error.h"
#include "base/hash.h"
#include "batten/research/mesh_shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MIN_VERTICES ((size_t)200)
#define MAX_VERTICES ((size_t)1000000)

/// A kind of shape with its generator: of a solid, or of a mesh.
typedef struct shape_maker
{
    bat_mesh_shape_kind kind;
    primitive_generator *draw;
    mesh_generator *generate;
} shape_maker;

static const shape_maker MAKERS[] = {
    {{"creature", "an animal on four legs, with ears, a tail, sometimes horns", true}, primitive_creature, NULL},
    {{"figure", "a being on two legs, arms in some pose", true}, primitive_figure, NULL},
    {{"bust", "a head on neck and shoulders", true}, primitive_bust, NULL},
    {{"mask", "the front of a head, open behind", false}, primitive_mask, NULL},
    {{"cactus", "a ridged column with arms", true}, primitive_cactus, NULL},
    {{"coral", "branches that fork", true}, primitive_coral, NULL},
    {{"pretzel", "one to four rings grown together", true}, primitive_pretzel, NULL},
    {{"stone", "a lump with dents and folds", true}, primitive_stone, NULL},
    {{"bracket", "plates, a boss and holes, with sharp edges", true}, primitive_bracket, NULL},
    {{"gear", "a wheel with straight or slanting teeth", true}, primitive_gear, NULL},
    {{"lathe", "a turned part with flanges", true}, primitive_lathe, NULL},
    {{"casting", "a smooth lever with bores and faces cut flat", true}, primitive_casting, NULL},
    {{"gem", "a ball cut by planes", true}, primitive_gem, NULL},
    {{"cam", "a wavy bar, twisted or domed, with a shaft", true}, primitive_cam, NULL},
    {{"block", "a block whose edges fade from nearly sharp to round", true}, primitive_groove, NULL},
    {{"knot", "a tube of varying section along a torus knot", true}, NULL, generate_knot},
    {{"relief", "hills, ridges and folds over a rectangle", false}, NULL, generate_relief},
    {{"shell", "a fan of ribs, sharp at the rim", false}, NULL, generate_shell},
    {{"cage", "a coarse elephant, to be refined", true}, NULL, generate_cage},
};

enum
{
    MAKER_COUNT = sizeof MAKERS / sizeof MAKERS[0]
};

size_t bat_mesh_shape_count(void)
{
    return MAKER_COUNT;
}

const bat_mesh_shape_kind *bat_mesh_shape_at(size_t index)
{
    return index < MAKER_COUNT ? &MAKERS[index].kind : NULL;
}

static const shape_maker *find_maker(const char *name)
{
    for (size_t i = 0; i < MAKER_COUNT; i++)
        if (strcmp(MAKERS[i].kind.name, name) == 0)
            return &MAKERS[i];
    return NULL;
}

/// The random stream of a kind and a seed. Different kinds have different streams for the same seed.
static bat_random stream_of(const char *name, uint64_t seed)
{
    return bat_random_seed(hash_bytes(HASH_BEGIN, name, strlen(name)) + seed * 0x9e3779b97f4a7c15u);
}

/// Translate the centre of the bounding box to the origin, scale its longest side to 1, and rotate the z axis to the y axis.
static void normalize(bat_mesh *mesh)
{
    for (size_t v = 0; v < mesh->vertex_count; v++)
    {
        double *point = mesh->positions + 3 * v, left = point[1];
        point[1] = point[2];
        point[2] = -left;
    }
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, longest = 0;
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
    {
        low[i % 3] = fmin(low[i % 3], mesh->positions[i]);
        high[i % 3] = fmax(high[i % 3], mesh->positions[i]);
    }
    for (int c = 0; c < 3; c++)
        longest = fmax(longest, high[c] - low[c]);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        mesh->positions[i] = (mesh->positions[i] - (low[i % 3] + high[i % 3]) / 2) / longest;
}

static bat_status primitive_mesh(primitive_generator *draw, size_t vertices, bat_random *random, bat_mesh *mesh,
                                 bat_error *error)
{
    mesh_primitive *primitive = calloc(1, sizeof *primitive);
    if (primitive == NULL)
        return error_memory(error, sizeof *primitive);
    draw(random, primitive);
    bat_status status = solid_mesh(&primitive->shape, vertices, mesh, error);
    free(primitive);
    return status;
}

bat_status bat_mesh_shape(const char *name, size_t vertices, uint64_t seed, bat_mesh *mesh, bat_error *error)
{
    const shape_maker *maker = find_maker(name);
    if (maker == NULL)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "unknown shape '%s'", name);
    if (vertices < MIN_VERTICES || vertices > MAX_VERTICES)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "the number of vertices must be between %zu and %zu, not %zu", MIN_VERTICES, MAX_VERTICES,
                         vertices);
    bat_random random = stream_of(name, seed);
    bat_mesh made = {0};
    bat_status status = maker->draw != NULL ? primitive_mesh(maker->draw, vertices, &random, &made, error)
                                            : maker->generate(vertices, &random, &made, error);
    if (status != BAT_OK)
        return status;
    normalize(&made);
    *mesh = made;
    return BAT_OK;
}
