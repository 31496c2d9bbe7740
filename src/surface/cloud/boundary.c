/// @file
/// Detection of the boundary loop of a cloud (bat_cloud_find_boundary): the longest closed polygon of the alpha-shape
/// boundary (alpha_boundary.h) that is not a gap between points. In noisy clouds, where points overlap, the loop is searched
/// in a random subset whose spacing exceeds the noise.

#include "base/error.h"
#include "base/memory.h"
#include "batten/cloud.h"
#include "linalg/vector3.h"
#include "surface/cloud/alpha_boundary.h"
#include "surface/cloud/canonical_order.h"
#include "surface/cloud/noise.h"
#include "surface/cloud/spatial_order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MIN_BOUNDARY = 4
};
/// A polygon is a boundary, rather than a gap, if its extent exceeds MIN_EXTENT mean edge lengths. It is also one if it has
/// at least LARGE_SHARE of all points.
static const double MIN_EXTENT = 2.5;
static const double LARGE_SHARE = 1.0 / 3;
/// A second polygon of at least this share of the longest one's length is another boundary; a shorter one is a gap.
static const double OTHER_BOUNDARY = 0.25;
/// Factors of the disc's radius that are tried after 1.
static const double OTHER_SCALES[] = {1.3, 1.7, 2.2};
/// Two polygons are the same boundary if at least this share of the points of one is close to the other.
static const double SAME_LINE = 0.5;

static bool is_wide(const alpha_boundary_cycle *line, size_t count)
{
    return line->extent * (double)line->count >= MIN_EXTENT * line->length ||
           (double)line->count >= LARGE_SHARE * (double)count;
}

/// Whether a polygon runs mostly along another one: within two of its mean edge lengths.
static bool runs_along(const double *points, const alpha_boundary_cycle *line, const alpha_boundary_cycle *other)
{
    size_t near = 0;
    double step = 2 * line->length / (double)line->count;
    for (size_t i = 0; i < line->count; i++)
        for (size_t k = 0; k < other->count; k++)
        {
            double arm[3];
            vector3_subtract(points + 3 * (size_t)line->points[i], points + 3 * (size_t)other->points[k], arm);
            if (vector3_dot(arm, arm) > step * step)
                continue;
            near++;
            break;
        }
    return (double)near >= SAME_LINE * (double)line->count;
}

static bat_status no_loop(bat_error *error, const char *text)
{
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "no boundary loop was found: %s", text);
}

/// Select the longest polygon; fail if another one may be a boundary too.
static bat_status choose(const double *points, size_t count, const alpha_boundary_cycles *cycles,
                         alpha_boundary_cycle **chosen, bat_error *error)
{
    alpha_boundary_cycle *longest = NULL;
    for (size_t i = 0; i < cycles->count; i++)
        if (is_wide(&cycles->cycles[i], count) && (longest == NULL || cycles->cycles[i].length > longest->length))
            longest = &cycles->cycles[i];
    if (longest == NULL)
        return no_loop(error, cycles->count == 0 ? "every point is surrounded by neighbours"
                                                 : "there are only small gaps between points; the surface seems closed");
    if (longest->count < MIN_BOUNDARY)
        return no_loop(error, "it has only three points");
    for (size_t i = 0; i < cycles->count; i++)
    {
        const alpha_boundary_cycle *other = &cycles->cycles[i];
        if (other == longest || !is_wide(other, count) || other->length < OTHER_BOUNDARY * longest->length ||
            runs_along(points, other, longest))
            continue;
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "the cloud has several boundary loops, one of %zu points and another of %zu; a patch has one",
                         longest->count, other->count);
    }
    *chosen = longest;
    return BAT_OK;
}

/// Find the loop with a disc of a radius. Release `loop` also on failure.
static bat_status find_loop_by(const double *points, const neighbour_tree *tree, double scale, alpha_boundary_cycle *loop,
                               bat_error *error)
{
    alpha_boundary_cycles cycles = {0};
    alpha_boundary_cycle *chosen = NULL;
    bat_status status = alpha_boundary_cycles_find(points, tree, scale, &cycles, error);
    if (status == BAT_OK)
        status = choose(points, tree->count, &cycles, &chosen, error);
    if (status == BAT_OK)
    {
        *loop = *chosen;
        chosen->points = NULL;
    }
    alpha_boundary_cycles_free(&cycles);
    return status;
}

/// Find the loop. A disc that rolls along a boundary may find no way on where tangent planes are uncertain; then others are
/// tried. The failure of the first is reported. Release `loop` also on failure.
static bat_status find_loop(const double *points, size_t count, alpha_boundary_cycle *loop, bat_error *error)
{
    neighbour_tree tree = {0};
    bat_status status = neighbour_tree_build(points, count, &tree, error);
    if (status != BAT_OK)
        return status;
    status = find_loop_by(points, &tree, 1, loop, error);
    for (size_t k = 0; k < sizeof OTHER_SCALES / sizeof *OTHER_SCALES && status == BAT_NO_CONVERGENCE; k++)
        status = find_loop_by(points, &tree, OTHER_SCALES[k], loop, NULL);
    neighbour_tree_free(&tree);
    return status;
}

static int compare_numbers(const void *a, const void *b)
{
    double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

/// The thickness of the cloud: a high quantile of the standard deviation across tangent planes, in spacings of the points.
static bat_status measure_thickness(const double *points, size_t count, double *thickness, bat_error *error)
{
    enum
    {
        MAX_SAMPLES = 256
    };
    static const double quantile = 0.75;
    double samples[MAX_SAMPLES];
    size_t stride = count / MAX_SAMPLES + 1, taken = 0;
    neighbour_tree tree = {0};
    alpha_boundary_search search = {.points = points, .tree = &tree};
    bat_status status = neighbour_tree_build(points, count, &tree, error);
    for (size_t i = 0; i < count && status == BAT_OK; i += stride)
    {
        alpha_boundary_point found = {0};
        status = alpha_boundary_point_find(&search, (uint32_t)i, NULL, 1, &found, error);
        samples[taken++] = sqrt(found.plane.variance[2]) / found.spacing;
    }
    qsort(samples, taken, sizeof *samples, compare_numbers);
    *thickness = samples[(size_t)(quantile * (double)(taken - 1))];
    alpha_boundary_search_free(&search);
    neighbour_tree_free(&tree);
    return status;
}

/// Draw `wanted` of `count` points at random, with a fixed seed, in ascending order (selection sampling; Knuth, 1969).
static void draw_sample(size_t count, size_t wanted, size_t *chosen)
{
    bat_random random = bat_random_seed(count);
    size_t made = 0;
    for (size_t i = 0; i < count && made < wanted; i++)
        if (bat_random_uniform(&random) * (double)(count - i) < (double)(wanted - made))
            chosen[made++] = i;
}

/// Find the loop in a random subset of `wanted` points.
static bat_status find_loop_of_sample(const double *points, size_t count, size_t wanted, alpha_boundary_cycle *loop,
                                      bat_error *error)
{
    if (wanted == count)
        return find_loop(points, count, loop, error);
    size_t *chosen = memory_array(wanted, sizeof *chosen);
    double *sample = memory_array(wanted, 3 * sizeof *sample);
    bat_status status = BAT_OK;
    if (chosen == NULL || sample == NULL)
        status = error_memory(error, wanted * 3 * sizeof *sample);
    else
    {
        draw_sample(count, wanted, chosen);
        for (size_t i = 0; i < wanted; i++)
            memcpy(sample + 3 * i, points + 3 * chosen[i], 3 * sizeof *sample);
        status = find_loop(sample, wanted, loop, error);
        for (size_t i = 0; i < loop->count; i++)
            loop->points[i] = (uint32_t)chosen[loop->points[i]];
    }
    free(chosen);
    free(sample);
    return status;
}

/// Find the loop in a possibly noisy cloud. Noise destroys the order around the loop where it exceeds the spacing. The first
/// subset is chosen so that the noise is at most the spacing; further ones have half as many points each.
static bat_status find_loop_in_noise(const double *points, size_t count, alpha_boundary_cycle *loop, bat_error *error)
{
    enum
    {
        FEW_POINTS = 200
    };
    static const double max_thickness = 0.9, noise_thickness = 0.4;
    double thickness;
    bat_status status = measure_thickness(points, count, &thickness, error);
    if (status != BAT_OK)
        return status;
    double share = fmin(max_thickness / thickness, 1);
    size_t minimum = count < FEW_POINTS ? count : FEW_POINTS, wanted = (size_t)(share * share * (double)count);
    wanted = wanted < minimum ? minimum : wanted;
    bat_error first = {0};
    status = find_loop_of_sample(points, count, wanted, loop, &first);
    while (status == BAT_NO_CONVERGENCE && thickness > noise_thickness && wanted / 2 >= minimum)
    {
        wanted /= 2;
        status = find_loop_of_sample(points, count, wanted, loop, NULL);
    }
    // The error of the first attempt is reported.
    if (status != BAT_OK && error != NULL)
        *error = first;
    return status;
}

/// The loop, from its lowest index towards the lower of the two neighbours, followed by all other points. order[i] receives
/// the point at the new index i.
static void order_points(const alpha_boundary_cycle *loop, size_t count, bool *in_loop, size_t *order)
{
    size_t first = 0, size = loop->count, made = 0;
    for (size_t i = 1; i < size; i++)
        if (loop->points[i] < loop->points[first])
            first = i;
    bool forward = loop->points[(first + 1) % size] < loop->points[(first + size - 1) % size];
    memset(in_loop, 0, count * sizeof *in_loop);
    for (size_t i = 0; i < size; i++)
    {
        uint32_t point = loop->points[(first + (forward ? i : size - i)) % size];
        order[made++] = point;
        in_loop[point] = true;
    }
    for (size_t point = 0; point < count; point++)
        if (!in_loop[point])
            order[made++] = point;
}

/// Reorder the cloud so that the loop comes first.
static bat_status reorder(bat_cloud *cloud, const alpha_boundary_cycle *loop, bat_error *error)
{
    size_t count = cloud->count;
    bool *in_loop = memory_array(count, sizeof *in_loop);
    size_t *order = memory_array(count, sizeof *order), *place = memory_array(count, sizeof *place);
    double *points = memory_array(count, 3 * sizeof *points);
    if (in_loop == NULL || order == NULL || place == NULL || points == NULL)
    {
        free(in_loop);
        free(order);
        free(place);
        free(points);
        return error_memory(error, count * 3 * sizeof *points);
    }
    order_points(loop, count, in_loop, order);
    for (size_t i = 0; i < count; i++)
    {
        memcpy(points + 3 * i, cloud->points + 3 * order[i], 3 * sizeof *points);
        place[order[i]] = i;
    }
    for (size_t i = 0; i < 3 * cloud->triangle_count; i++)
        cloud->triangles[i] = (uint32_t)place[cloud->triangles[i]];
    for (size_t i = 0; i < count && cloud->order != NULL; i++)
        order[i] = cloud->order[order[i]];
    free(in_loop);
    free(place);
    free(cloud->points);
    free(cloud->order);
    cloud->points = points;
    cloud->order = order;
    cloud->boundary_count = loop->count;
    cloud->has_corners = false;
    return BAT_OK;
}

/// Copy the points, scaled to unit size, in an order that does not depend on that of the cloud and in which near points are
/// near: leaves of a tree that is built in the canonical order.
/// @param places receives the index in the cloud of each copied point
static bat_status sort_points(const bat_cloud *cloud, double **points, size_t **places, bat_error *error)
{
    size_t count = cloud->count;
    neighbour_tree tree = {0};
    double *unit = points_to_unit_size(cloud->points, count);
    *points = memory_array(count, 3 * sizeof **points);
    *places = memory_array(count, sizeof **places);
    bat_status status = BAT_OK;
    if (unit == NULL || *points == NULL || *places == NULL)
        status = error_memory(error, count * 3 * sizeof *unit);
    if (status == BAT_OK)
        status = canonical_order_find(unit, count, *places, error);
    for (size_t i = 0; status == BAT_OK && i < count; i++)
        memcpy(*points + 3 * i, unit + 3 * (*places)[i], 3 * sizeof *unit);
    if (status == BAT_OK)
        status = neighbour_tree_build(*points, count, &tree, error);
    size_t *sorted = status == BAT_OK ? memory_array(count, sizeof *sorted) : NULL;
    if (status == BAT_OK && sorted == NULL)
        status = error_memory(error, count * sizeof *sorted);
    for (size_t i = 0; status == BAT_OK && i < count; i++)
    {
        sorted[i] = (*places)[tree.items[i]];
        memcpy(*points + 3 * i, unit + 3 * sorted[i], 3 * sizeof *unit);
    }
    if (status == BAT_OK)
        memcpy(*places, sorted, count * sizeof *sorted);
    free(sorted);
    free(unit);
    neighbour_tree_free(&tree);
    return status;
}

bat_status bat_cloud_noise(const bat_cloud *cloud, double *sigma, bat_error *error)
{
    bat_status status = bat_cloud_check(cloud, error);
    if (status != BAT_OK)
        return status;
    spatial_order order = {0};
    unit_frame frame = unit_frame_of(cloud->points, cloud->count);
    double found;
    status = spatial_order_make(cloud, &order, error);
    if (status == BAT_OK)
        status = noise_estimate(order.cloud.points, &order.tree, &found, error);
    if (status == BAT_OK)
        *sigma = ldexp(found, 1 - frame.exponent);
    spatial_order_free(&order);
    return status;
}

bat_status bat_cloud_find_boundary(bat_cloud *cloud, bat_error *error)
{
    bat_status status = bat_cloud_check(cloud, error);
    if (status != BAT_OK)
        return status;
    if (cloud->count < MIN_BOUNDARY)
        return no_loop(error, "there are fewer than four points");
    size_t *places;
    double *points;
    alpha_boundary_cycle loop = {0};
    status = sort_points(cloud, &points, &places, error);
    if (status == BAT_OK)
        status = find_loop_in_noise(points, cloud->count, &loop, error);
    for (size_t i = 0; status == BAT_OK && i < loop.count; i++)
        loop.points[i] = (uint32_t)places[loop.points[i]];
    if (status == BAT_OK)
        status = reorder(cloud, &loop, error);
    free(loop.points);
    free(points);
    free(places);
    return status;
}
