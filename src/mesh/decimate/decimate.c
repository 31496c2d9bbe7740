#include "batten/mesh_decimate.h"
#include "batten/mesh_measure.h"

#include "base/choice.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "base/progress.h"
#include "mesh/check.h"
#include "mesh/decimate/decimation.h"

#include <math.h>
#include <stdlib.h>

/// @file
/// Options and targets of decimation, and the measured bound on the distance.

enum
{
    /// Runs with ever smaller tolerances until the measured distance keeps the bound.
    MAX_RUNS = 8,
    /// The most samples of a measurement for each given face, beside the default ones, and the factor between attempts.
    MAX_SAMPLES_PER_FACE = 200,
    SAMPLE_FACTOR = 4
};

/// The greatest such ratio where the bound is not exceeded but not proven either.
static const double UNPROVEN = 2;
/// The relative accuracy of the measured distance.
static const double ACCURACY = 0.01;

/// The factor between a tolerance and the next one, beside the ratio by which the result exceeded the bound.
static const double SHRINK = 0.98;

static const bat_choice METHODS[] = {
    {.name = "auto", .summary = "memoryless", .value = BAT_MESH_DECIMATE_METHOD_AUTO, .use = BAT_CHOICE_USE_UNNAMED},
    {.name = "quadric",
     .value = BAT_MESH_DECIMATE_METHOD_QUADRIC,
     .summary = "squared distances from the planes of the given faces (Garland and Heckbert)"},
    {.name = "memoryless",
     .value = BAT_MESH_DECIMATE_METHOD_MEMORYLESS,
     .summary = "squared volumes to the present faces, at preserved volume (Lindstrom and Turk)"},
    {.name = "fast",
     .value = BAT_MESH_DECIMATE_METHOD_FAST,
     .summary = "quadric errors in sweeps to three times the target, then memoryless errors"},
};
const bat_family bat_mesh_decimate_method_family = FAMILY("decimation method", METHODS);

bat_mesh_decimate_options bat_mesh_decimate_defaults(void)
{
    return (bat_mesh_decimate_options){.method = BAT_MESH_DECIMATE_METHOD_MEMORYLESS,
                                       .seed = 1,
                                       .min_normal = 0.2,
                                       .min_quality = 0.1,
                                       .boundary_weight = 1000,
                                       .attributes = 0.5};
}

static bat_status mesh_decimate_options_check(const void *opaque, bat_error *error)
{
    const bat_mesh_decimate_options *options = opaque;
    static const option_field FIELDS[] = {
        OPTION_FIELD(bat_mesh_decimate_options, ratio, OPTION_NUMBER, 0, 1),
        OPTION_FIELD(bat_mesh_decimate_options, tolerance, OPTION_NUMBER, 0, INFINITY),
        OPTION_FAMILY(bat_mesh_decimate_options, method, bat_mesh_decimate_method_family),
        OPTION_FIELD(bat_mesh_decimate_options, min_normal, OPTION_NUMBER, -1, 1),
        OPTION_FIELD(bat_mesh_decimate_options, min_quality, OPTION_NUMBER, 0, 1),
        OPTION_FIELD(bat_mesh_decimate_options, boundary_weight, OPTION_NUMBER, 0, INFINITY),
        OPTION_FIELD(bat_mesh_decimate_options, attributes, OPTION_NUMBER, 0, INFINITY),
        OPTION_THREADS(bat_mesh_decimate_options),
    };
    bat_status status = OPTIONS_CHECK(options, FIELDS, error);
    int targets = (options->vertices > 0) + (options->faces > 0) + (options->ratio > 0) + (options->tolerance > 0);
    if (status == BAT_OK && targets > 1)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "vertices, faces, ratio and error exclude each other, but %d of them are set", targets);
    return status;
}

const bat_options_table bat_mesh_decimate_fields = {"bat_mesh_decimate_options", mesh_decimate_options_check};

/// The numbers of vertices and faces to stop at.
static bat_status find_target(const bat_mesh *fine, const bat_mesh_decimate_options *options, decimation_target *target,
                              bat_error *error)
{
    if (options->vertices > fine->vertex_count)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "the mesh has %zu vertices, fewer than the %zu wanted", fine->vertex_count, options->vertices);
    if (options->faces > fine->face_count)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the mesh has %zu faces, fewer than the %zu wanted",
                         fine->face_count, options->faces);
    *target = (decimation_target){options->vertices, options->faces};
    if (options->ratio > 0)
        target->faces = (size_t)fmax(1, options->ratio * (double)fine->face_count);
    return BAT_OK;
}

/// The bound on the distance as a length.
static double bound_of(const bat_mesh *fine, const bat_mesh_decimate_options *options)
{
    if (!options->relative_tolerance)
        return options->tolerance;
    double square = 0;
    for (size_t c = 0; c < 3; c++)
    {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < 3 * fine->face_count; i++)
        {
            double coordinate = fine->positions[3 * (size_t)fine->faces[i] + c];
            low = fmin(low, coordinate);
            high = fmax(high, coordinate);
        }
        square += (high - low) * (high - low);
    }
    return options->tolerance * sqrt(square);
}

/// Release a result.
static void drop(bat_mesh *coarse, bat_mesh_map **map)
{
    bat_mesh_free(coarse);
    if (map == NULL)
        return;
    bat_mesh_map_free(*map);
    *map = NULL;
}

/// The part of the progress that one of several attempts gets: half of what remains.
static progress_part part_of_attempt(progress_part whole, int attempt)
{
    double begin = 1 - ldexp(1, -attempt);
    return (progress_part){whole.whole, whole.begin + begin * whole.length, (1 - begin) / 2 * whole.length};
}

/// Measure a result. Samples are added as long as the greatest distance found keeps the bound and the proven one does not.
/// The proof need not be sharper than the bound.
static bat_status measure(const bat_mesh *fine, const bat_mesh *coarse, const bat_mesh_decimate_options *options,
                          double bound, progress_part progress, bat_mesh_distance *distance, bat_error *error)
{
    bat_mesh_compare_options how = bat_mesh_compare_defaults();
    bat_status status = BAT_OK;
    how.threads = options->threads;
    how.tolerance = ACCURACY;
    size_t most = how.samples + MAX_SAMPLES_PER_FACE * fine->face_count;
    bool again = true;
    for (int attempt = 0; again && status == BAT_OK; attempt++, how.samples *= SAMPLE_FACTOR)
    {
        progress_part part = part_of_attempt(progress, attempt);
        how.progress = progress_of_part(&part);
        status = bat_mesh_compare(coarse, fine, &how, distance, error);
        again = distance->hausdorff <= bound && distance->hausdorff_bound > bound && SAMPLE_FACTOR * how.samples <= most;
        if (again && distance->hausdorff > 0)
            how.tolerance = fmax(ACCURACY, (1 - ACCURACY) * (bound / distance->hausdorff - 1));
    }
    if (status == BAT_CANCELLED)
        return error_set(error, status, BAT_NO_INDEX, 0, "decimation was stopped while its distance was measured");
    return status;
}

/// Decimate with one tolerance and measure the result. The first half of the progress belongs to collapses.
static bat_status run_once(const bat_mesh *fine, const bat_mesh_connectivity *topology,
                           const bat_mesh_decimate_options *options, double allowed, double bound, progress_part progress,
                           bat_mesh *coarse, bat_mesh_map **map, bat_mesh_distance *distance, bat_error *error)
{
    static const decimation_target END = {0, 0};
    bat_mesh_decimate_options how = *options;
    tolerance checks;
    bat_status status = tolerance_make(fine, topology, allowed, &checks, error);
    if (status != BAT_OK)
        return status;
    progress_part first = part_of_attempt(progress, 0), second = part_of_attempt(progress, 1);
    second.length *= 2;
    how.progress = progress_of_part(&first);
    status = decimation_run(fine, &how, &END, &checks, coarse, map, error);
    tolerance_free(&checks);
    if (status != BAT_OK)
        return status;
    status = measure(fine, coarse, options, bound, second, distance, error);
    if (status != BAT_OK)
        drop(coarse, map);
    return status;
}

/// Run with smaller and smaller tolerances until the measured distance keeps the bound. If none does, nothing collapses.
static bat_status run_within(const bat_mesh *fine, const bat_mesh_decimate_options *options, bat_mesh *coarse,
                             bat_mesh_map **map, bat_error *error)
{
    const decimation_target whole = {fine->vertex_count, fine->face_count};
    const progress_part progress = {options->progress, 0, 1};
    double bound = bound_of(fine, options), allowed = bound;
    bat_mesh_connectivity topology;
    bat_mesh_distance distance = {0};
    bat_status status = bat_mesh_connect(fine, &topology, error);
    if (status != BAT_OK)
        return status;
    bool kept = false;
    for (int run = 0; run < MAX_RUNS && status == BAT_OK && !kept; run++)
    {
        status = run_once(fine, &topology, options, allowed, bound, part_of_attempt(progress, run), coarse, map, &distance,
                          error);
        kept = status == BAT_OK && distance.hausdorff_bound <= bound;
        if (status != BAT_OK || kept)
            break;
        drop(coarse, map);
        double exceeded = distance.hausdorff > bound ? distance.hausdorff : fmin(distance.hausdorff_bound, UNPROVEN * bound);
        allowed *= bound / exceeded * SHRINK;
    }
    bat_mesh_connectivity_free(&topology);
    if (status == BAT_OK && !kept)
    {
        distance.hausdorff_bound = 0;
        status = decimation_run(fine, options, &whole, NULL, coarse, map, error);
    }
    if (status == BAT_OK && options->distance != NULL)
        *options->distance = distance.hausdorff_bound;
    return status;
}

bat_status bat_mesh_decimate(const bat_mesh *fine, const bat_mesh_decimate_options *options, bat_mesh *coarse,
                             bat_mesh_map **map, bat_error *error)
{
    const bat_mesh_decimate_options defaults = bat_mesh_decimate_defaults();
    decimation_target target;
    options = options != NULL ? options : &defaults;
    bat_status status = bat_options_check(&bat_mesh_decimate_fields, options, error);
    if (status == BAT_OK)
        status = mesh_check_triangles(fine, error);
    if (status == BAT_OK)
        status = find_target(fine, options, &target, error);
    if (status != BAT_OK)
        return status;
    bat_mesh made = {0};
    bat_mesh_map *made_map = NULL, **to = map != NULL ? &made_map : NULL;
    status = options->tolerance > 0 ? run_within(fine, options, &made, to, error)
                                    : decimation_run(fine, options, &target, NULL, &made, to, error);
    if (status != BAT_OK)
        return status;
    *coarse = made;
    if (map != NULL)
        *map = made_map;
    return BAT_OK;
}
