/// @file
/// The table of cloud shapes, and bat_cloud_shape().

#include "research/shapes/surface_shape.h"

#include "base/error.h"
#include "base/hash.h"
#include "batten/research/surface_shapes.h"
#include "research/shapes/cloud_sampling.h"

#include <string.h>

#define MIN_POINTS ((size_t)200)
#define MAX_POINTS ((size_t)100000000)

static void shape_hull_at(const surface_shape *shape, const double parameter[2], double point[3])
{
    hull_at(&shape->form.hull, parameter, point);
}

static void shape_blade_at(const surface_shape *shape, const double parameter[2], double point[3])
{
    blade_at(&shape->form.blade, parameter, point);
}

static void shape_relief_at(const surface_shape *shape, const double parameter[2], double point[3])
{
    relief_at(&shape->form.relief, parameter, point);
}

static void make_hull(bat_random *random, surface_shape *shape)
{
    shape->at = shape_hull_at;
    hull_draw(random, &shape->form.hull);
}

static void make_blade(bat_random *random, surface_shape *shape)
{
    shape->at = shape_blade_at;
    blade_draw(random, &shape->form.blade);
}

static void make_relief(bat_random *random, surface_shape *shape)
{
    shape->at = shape_relief_at;
    relief_draw(random, &shape->form.relief);
}

/// A method to sample a surface.
typedef bat_status surface_sampling(const surface_shape *shape, size_t points, bat_random *random, sampled_cloud *sampled,
                                    bat_error *error);

typedef struct cloud_kind
{
    void (*make)(bat_random *random, surface_shape *shape);
    surface_sampling *sample;
} cloud_kind;

static const char *const NAMES[] = {"hull", "blade", "scan", NULL};
static const cloud_kind KINDS[] = {
    {make_hull, cloud_sample_evenly}, {make_blade, cloud_sample_evenly}, {make_relief, cloud_sample_scan}};

const char *const *bat_cloud_shape_names(void)
{
    return NAMES;
}

/// Null for an unknown name.
static const cloud_kind *find_kind(const char *name)
{
    for (size_t i = 0; name != NULL && NAMES[i] != NULL; i++)
        if (strcmp(NAMES[i], name) == 0)
            return &KINDS[i];
    return NULL;
}

bool surface_shape_make(const char *name, uint64_t seed, surface_shape *shape, bat_random *random)
{
    const cloud_kind *kind = find_kind(name);
    if (kind == NULL)
        return false;
    // Different kinds have different streams for the same seed.
    *random = bat_random_seed(hash_bytes(HASH_BEGIN, name, strlen(name)) + seed * 0x9e3779b97f4a7c15u);
    kind->make(random, shape);
    return true;
}

bat_status bat_cloud_shape(const char *name, size_t points, uint64_t seed, bat_cloud *cloud, double **parameters,
                           bat_error *error)
{
    surface_shape shape;
    bat_random random;
    sampled_cloud sampled;
    if (!surface_shape_make(name, seed, &shape, &random))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "unknown cloud shape '%s'",
                         name != NULL ? name : "nothing");
    if (points < MIN_POINTS || points > MAX_POINTS)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "the number of points must be between %zu and %zu, not %zu", MIN_POINTS, MAX_POINTS, points);
    bat_status status = find_kind(name)->sample(&shape, points, &random, &sampled, error);
    if (status == BAT_OK)
        sampled_cloud_move(&sampled, cloud, parameters);
    return status;
}
