/// @file
/// Detection of the boundary loop of a cloud (bat_cloud_find_boundary): the longest closed polygon of the alpha-shape
/// boundary (alpha_boundary.c) that is not a gap between points. In noisy clouds, where points overlap, the loop is searched
/// in a random subset whose spacing exceeds the noise, with its points moved to local quadratic fits. In scan lines it is
/// searched in an even sample.

#include "surface/cloud/boundary.h"
#include "base/error.h"
#include "base/threads.h"
#include "surface/cloud/part.h"

#include <string.h>

static const int MIN_BOUNDARY = 4;
/// A polygon is a boundary if its extent exceeds MIN_EXTENT mean edge lengths, or it has LARGE_SHARE of all points.
static const double MIN_EXTENT = 2.5;
static const double LARGE_SHARE = 1.0 / 3;
/// A second polygon of at least this share of the longest one's length is another boundary; a shorter one is a gap.
static const double OTHER_BOUNDARY = 0.25;
/// Factors of the disc's radius that are tried after 1.
static const double OTHER_SCALES[] = {1.3, 1.7, 2.2};
/// The factor that is tried where there are several polygons: a smaller disc enters narrow gaps.
static const double SMALL_SCALE = 0.8;
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

/// The points in which a loop is searched, and why there is none.
typedef struct loop_search
{
    double noise, spacing; ///< of the cloud
    double unit;           ///< length of a unit of the points in that of the cloud
    double scale;          ///< factor of the radius of the first disc
    bat_progress progress;
    bool several;      ///< the failure was that there are several loops
    bool seems_closed; ///< the failure was that there is no edge
} loop_search;

// Fewest points at the edge of an open patch, in roots of the number of points (a disc has 3.5), and as a share of the
// points: gaps between random points have so many.
static const double EDGE_ROOTS = 1;
static const double EDGE_SHARE = 0.02;

/// The failure where no polygon is wide.
static bat_status fail_without_loop(const alpha_boundary_cloud *cloud, loop_search *search, bat_error *error)
{
    double count = (double)cloud->tree->count, edge = (double)cloud->outer_count;
    bat_status status = diagnose_volume(cloud->points, cloud->tree, error);
    if (status != BAT_OK)
        return status;
    search->seems_closed = edge < fmax(EDGE_ROOTS * sqrt(count), EDGE_SHARE * count);
    if (search->seems_closed)
        return error_remedy(error,
                            no_loop(error, edge == 0 ? "every point is surrounded by neighbours: the surface is closed"
                                                     : "there are only small gaps between points: the surface seems closed"),
                            "shell", "fits closed surfaces");
    return error_remedy(
        error, no_loop(error, "there are points at an edge, but no polygon closes around the others; leave out outliers"),
        "boundary", "gives the loop");
}

/// Select the longest polygon; fail if another one may be a boundary too.
static bat_status choose(const alpha_boundary_cloud *cloud, const alpha_boundary_cycles *cycles, loop_search *search,
                         alpha_boundary_cycle **chosen, bat_error *error)
{
    size_t count = cloud->tree->count;
    alpha_boundary_cycle *longest = NULL;
    search->several = search->seems_closed = false;
    for (size_t i = 0; i < cycles->count; i++)
        if (is_wide(&cycles->cycles[i], count) && (longest == NULL || cycles->cycles[i].length > longest->length))
            longest = &cycles->cycles[i];
    if (longest == NULL)
        return fail_without_loop(cloud, search, error);
    if (longest->count < MIN_BOUNDARY)
        return no_loop(error, "it has only three points");
    for (size_t i = 0; i < cycles->count; i++)
    {
        const alpha_boundary_cycle *other = &cycles->cycles[i];
        if (other == longest || !is_wide(other, count) || other->length < OTHER_BOUNDARY * longest->length ||
            runs_along(cloud->points, other, longest))
            continue;
        search->several = true;
        (void)error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                        "the cloud has several boundary loops, one of %zu points and another of %zu; a patch has one, the "
                        "boundary that is given",
                        longest->count, other->count);
        return error_remedy(error, BAT_NO_CONVERGENCE, "trim", "cuts the holes out");
    }
    *chosen = longest;
    return BAT_OK;
}

/// Find the loop with a disc of a radius. Release `loop` also on failure.
static bat_status find_loop_by(const alpha_boundary_cloud *cloud, double scale, loop_search *search,
                               alpha_boundary_cycle *loop, bat_error *error)
{
    alpha_boundary_cycles cycles = {0};
    alpha_boundary_cycle *chosen = NULL;
    bat_status status = alpha_boundary_cycles_find(cloud, scale, &cycles, error);
    if (status == BAT_OK)
        status = choose(cloud, &cycles, search, &chosen, error);
    if (status == BAT_OK && chosen != NULL)
    {
        *loop = *chosen;
        chosen->points = NULL;
    }
    for (size_t i = 0; i < cycles.count; i++)
        free(cycles.cycles[i].points);
    free(cycles.cycles);
    return status;
}

/// Find the loop with planes of at least some points, and discs of several radii. The first failure is reported.
static bat_status find_loop_with(const double *points, const nearest_tree *tree, size_t plane_points, loop_search *search,
                                 alpha_boundary_cycle *loop, bat_error *error)
{
    alpha_boundary_cloud cloud;
    bat_status status = alpha_boundary_cloud_make(points, tree, plane_points, search->progress, &cloud, error);
    if (status == BAT_OK)
        status = find_loop_by(&cloud, search->scale, search, loop, error);
    loop_search again = *search;
    if (status == BAT_NO_CONVERGENCE && search->several && search->scale > SMALL_SCALE)
        status = find_loop_by(&cloud, SMALL_SCALE, &again, loop, NULL);
    for (size_t k = 0; k < sizeof OTHER_SCALES / sizeof *OTHER_SCALES && status == BAT_NO_CONVERGENCE; k++)
        status = find_loop_by(&cloud, OTHER_SCALES[k], &again, loop, NULL);
    free(cloud.planes);
    free(cloud.outer);
    return status;
}

/// Find the loop. A disc that rolls along a boundary may find no way on where tangent planes are uncertain; then other discs
/// and planes are tried. The failure of the first is reported. Release `loop` also on failure.
static bat_status find_loop(const double *points, const nearest_tree *tree, loop_search *search, alpha_boundary_cycle *loop,
                            bat_error *error)
{
    bat_status status = find_loop_with(points, tree, ALPHA_BOUNDARY_PLANE, search, loop, error);
    loop_search again = *search;
    if (status == BAT_NO_CONVERGENCE && !search->seems_closed)
        status = find_loop_with(points, tree, ALPHA_BOUNDARY_SMALL_PLANE, &again, loop, NULL);
    return status;
}

enum
{
    MAX_SAMPLES = 256,
    SPACING_POINTS = 36,
    SMOOTH_MIN = 24,
    SMOOTH_MAX = 400
};
/// Noise, in spacings, up to which points are searched as they are.
static const double MAX_CLEAN = 0.4;
/// Radius of the neighbourhoods that smooth, in standard deviations of the noise.
static const double SMOOTH_REACH = 8;

static bat_status measure_cloud(const double *points, const nearest_tree *tree, loop_search *search, bat_error *error)
{
    double spacings[MAX_SAMPLES];
    size_t stride = tree->count / MAX_SAMPLES + 1, taken = 0;
    neighbour_list near = {0};
    bat_status status = noise_estimate(points, tree, &search->noise, error);
    for (size_t i = 0; i < tree->count && status == BAT_OK; i += stride)
    {
        status = neighbours_nearest(tree, points + 3 * i, SPACING_POINTS, &near, error);
        if (status == BAT_OK)
            spacings[taken++] = sqrt(near.entries[near.count - 1].squared * ANGLE_PI / (double)near.count);
    }
    neighbour_list_free(&near);
    search->spacing = taken > 0 ? sort_median(spacings, taken) : 0;
    return status;
}

/// Move points to local quadratic fits of `wanted` neighbours, along the normals of their tangent planes.
static bat_status smooth_points(const double *points, const nearest_tree *tree, size_t wanted, double *smooth,
                                bat_error *error)
{
    bool complete = true;
#pragma omp parallel num_threads(threads_for(0, tree->count / 64 + 1)) reduction(&& : complete)
    {
        neighbour_list near = {0};
#pragma omp for schedule(static)
        for (size_t i = 0; i < tree->count; i++)
        {
            const double *here = points + 3 * i;
            memcpy(smooth + 3 * i, here, 3 * sizeof *smooth);
            if (neighbours_nearest(tree, here, wanted, &near, NULL) != BAT_OK)
            {
                complete = false;
                continue;
            }
            local_plane plane = local_plane_fit(points, &near);
            if (!(plane.variance[1] > 0))
                continue;
            local_quadratic quadratic = local_quadratic_fit(points, &near, &plane);
            double height = local_quadratic_height(&quadratic, here);
            vector_add(3, -height, plane.axes[2], smooth + 3 * i);
        }
        neighbour_list_free(&near);
    }
    return complete ? BAT_OK : error_memory(error, wanted * sizeof(neighbour));
}

/// Find the loop in points that are smoothed first. `density` is the ratio of the spacing to that of the cloud.
static bat_status find_smooth_loop(const double *points, const nearest_tree *tree, double density, loop_search *search,
                                   alpha_boundary_cycle *loop, bat_error *error)
{
    double reach = SMOOTH_REACH * search->noise / (density * search->spacing),
           share = fmin(ANGLE_PI * reach * reach, SMOOTH_MAX);
    size_t wanted = share < SMOOTH_MIN ? SMOOTH_MIN : (size_t)share, count = tree->count;
    double *smooth = memory_array(count, 3 * sizeof *smooth);
    nearest_tree moved = {0};
    bat_status status = smooth == NULL
                            ? error_memory(error, count * 3 * sizeof *smooth)
                            : smooth_points(points, tree, wanted < count / 4 ? wanted : count / 4 + 1, smooth, error);
    if (status == BAT_OK)
        status = neighbours_build(smooth, count, &moved, error);
    if (status == BAT_OK)
        status = find_loop(smooth, &moved, search, loop, error);
    nearest_free(&moved);
    free(smooth);
    return status;
}

/// Some of the points, in which a loop is searched.
typedef struct point_subset
{
    memory_pool pool;
    bool *kept;     ///< of all points
    size_t *chosen; ///< count: the points that are kept, ascending
    double *points; ///< count x 3
    size_t count;
    nearest_tree tree;
} point_subset;

/// Make room for marks in `kept`.
static bat_status subset_begin(size_t all, point_subset *subset, bat_error *error)
{
    subset->kept = memory_pool_zeros(&subset->pool, all, sizeof *subset->kept);
    subset->chosen = memory_pool_array(&subset->pool, all, sizeof *subset->chosen);
    return memory_pool_check(&subset->pool, error);
}

/// Copy the points that are kept, and make their tree.
static bat_status subset_take(const double *points, size_t all, point_subset *subset, bat_error *error)
{
    for (size_t i = 0; i < all; i++)
        if (subset->kept[i])
            subset->chosen[subset->count++] = i;
    subset->points = memory_pool_array(&subset->pool, subset->count, 3 * sizeof *subset->points);
    bat_status status = memory_pool_check(&subset->pool, error);
    for (size_t i = 0; i < subset->count && status == BAT_OK; i++)
        memcpy(subset->points + 3 * i, points + 3 * subset->chosen[i], 3 * sizeof *points);
    return status == BAT_OK ? neighbours_build(subset->points, subset->count, &subset->tree, error) : status;
}

/// Free a subset. Points of a loop that was found in it get their indices among all points.
static void subset_end(point_subset *subset, bat_status status, alpha_boundary_cycle *loop)
{
    for (size_t i = 0; i < loop->count && status == BAT_OK; i++)
        loop->points[i] = (uint32_t)subset->chosen[loop->points[i]];
    nearest_free(&subset->tree);
    memory_pool_free(&subset->pool);
}

/// Keep `wanted` of `count` points at random, with a fixed seed (selection sampling; Knuth, 1969).
static void draw_sample(size_t count, size_t wanted, bool *kept)
{
    bat_random random = bat_random_seed(count);
    size_t made = 0;
    for (size_t i = 0; i < count && made < wanted; i++)
    {
        kept[i] = bat_random_uniform(&random) * (double)(count - i) < (double)(wanted - made);
        made += kept[i];
    }
}

static bat_status find_loop_of_sample(const double *points, const nearest_tree *tree, size_t wanted, loop_search *search,
                                      alpha_boundary_cycle *loop, bat_error *error)
{
    size_t count = tree->count;
    double density = sqrt((double)count / (double)wanted);
    bool noisy = search->noise > MAX_CLEAN * density * search->spacing;
    if (wanted == count)
        return noisy ? find_smooth_loop(points, tree, density, search, loop, error)
                     : find_loop(points, tree, search, loop, error);
    point_subset sample = {0};
    bat_status status = subset_begin(count, &sample, error);
    if (status == BAT_OK)
    {
        draw_sample(count, wanted, sample.kept);
        status = subset_take(points, count, &sample, error);
    }
    if (status == BAT_OK)
        status = noisy ? find_smooth_loop(sample.points, &sample.tree, density, search, loop, error)
                       : find_loop(sample.points, &sample.tree, search, loop, error);
    subset_end(&sample, status, loop);
    return status;
}

/// Find the loop in a possibly noisy cloud. Noise destroys the order around the loop where it exceeds the spacing. The first
/// subset is chosen so that the noise is at most the spacing; further ones have half as many points each.
static bat_status find_loop_in_noise(const double *points, const nearest_tree *tree, loop_search *search,
                                     alpha_boundary_cycle *loop, bat_error *error)
{
    enum
    {
        FEW_POINTS = 200,
        MANY_POINTS = 60000 // of noisy clouds: more only take time
    };
    static const double max_thickness = 0.9;
    size_t count = tree->count;
    double thickness = search->noise / search->spacing, share = thickness > 0 ? fmin(max_thickness / thickness, 1) : 1;
    size_t minimum = count < FEW_POINTS ? count : FEW_POINTS, wanted = (size_t)(share * share * (double)count);
    wanted = wanted < minimum ? minimum : wanted > MANY_POINTS && thickness > MAX_CLEAN ? MANY_POINTS : wanted;
    bat_status status = find_loop_of_sample(points, tree, wanted, search, loop, error);
    loop_search again = *search;
    bool is_open = !search->several && !search->seems_closed;
    while (status == BAT_NO_CONVERGENCE && (is_open || thickness > MAX_CLEAN) && wanted / 2 >= minimum)
    {
        wanted /= 2;
        // The error text of the first attempt is reported.
        status = find_loop_of_sample(points, tree, wanted, &again, loop, NULL);
    }
    return status;
}

/// Clouds with more points are searched for pieces and outliers only where no loop is found.
static const int MANY_TO_SPLIT = 200000;
/// Outliers are left out first where they are more than this share of the points; fewer do no harm.
static const double MAX_OUTLIERS = 0.02;

/// Find the loop in the points that belong to the one piece, where others are many or `all` is set. BAT_NO_CONVERGENCE, with
/// no text, where there is nothing to leave out.
static bat_status find_loop_of_piece(const double *points, const nearest_tree *tree, bool all, loop_search *search,
                                     alpha_boundary_cycle *loop, bat_error *error)
{
    size_t count = tree->count, left = 0;
    point_subset piece = {0};
    bat_status status = subset_begin(count, &piece, error);
    if (status == BAT_OK)
        status = diagnose_pieces(points, tree, piece.kept, &left, error);
    alpha_boundary_cycle any = {0}; // Without an edge anywhere, all pieces are closed.
    if (status == BAT_NO_CONVERGENCE && find_loop_in_noise(points, tree, search, &any, NULL) == status &&
        search->seems_closed)
        (void)error_remedy(error, status, "shell", "fits closed pieces");
    free(any.points);
    bool enough = (double)left > (all ? 0 : MAX_OUTLIERS * (double)count) && count - left >= MIN_BOUNDARY;
    if (status == BAT_OK && enough)
        status = subset_take(points, count, &piece, error);
    if (status == BAT_OK)
        status = enough ? find_loop_in_noise(piece.points, &piece.tree, search, loop, error) : BAT_NO_CONVERGENCE;
    subset_end(&piece, status, loop);
    return status;
}

/// Find the loop. Where there is none, tell why; outliers are left out.
static bat_status find_loop_or_tell(const double *points, const nearest_tree *tree, loop_search *search,
                                    alpha_boundary_cycle *loop, bat_error *error)
{
    bat_error failure = {0}, told = {0};
    bool few = tree->count <= MANY_TO_SPLIT;
    bat_status status = measure_cloud(points, tree, search, error);
    if (status == BAT_OK)
        status = diagnose_sheets(points, tree, search->noise, search->spacing, search->unit, error);
    if (status != BAT_OK)
        return status;
    if (few)
        status = find_loop_of_piece(points, tree, false, search, loop, &told);
    if (status == BAT_OK && few)
        return BAT_OK;
    if (told.status == BAT_OK)
        status = find_loop_in_noise(points, tree, search, loop, &failure);
    if (status == BAT_NO_CONVERGENCE && told.status == BAT_OK)
        status = find_loop_of_piece(points, tree, true, search, loop, &told);
    const bat_error *reason = told.status != BAT_OK ? &told : &failure;
    return status == BAT_OK ? BAT_OK : error_copy(error, reason);
}

/// Find the loop of any cloud; scan lines are sampled evenly first.
static bat_status find_any_loop(const double *points, size_t count, loop_search *search, alpha_boundary_cycle *loop,
                                bat_error *error)
{
    nearest_tree tree = {0};
    point_subset even = {0};
    double radius = 0;
    bat_status status = diagnose_line(points, count, error);
    if (status == BAT_OK)
        status = neighbours_build(points, count, &tree, error);
    if (status == BAT_OK)
        status = even_sample_radius(points, &tree, &radius, error);
    if (status == BAT_OK && isinf(radius))
        status = no_loop(error, "the points lie along a curve, or on lines too far apart; a surface needs points between");
    if (status == BAT_OK && radius > 0)
    {
        status = subset_begin(count, &even, error);
        if (status == BAT_OK)
            status = even_sample_choose(points, &tree, radius, even.kept, error);
        if (status == BAT_OK)
            status = subset_take(points, count, &even, error);
        if (status == BAT_OK)
            status = find_loop_or_tell(even.points, &even.tree, search, loop, error);
        subset_end(&even, status, loop);
    }
    else if (status == BAT_OK)
        status = find_loop_or_tell(points, &tree, search, loop, error);
    nearest_free(&tree);
    return status;
}

/// The loop, from its lowest index towards the lower neighbour, then all others: order[i] is the point at new index i.
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
    memory_pool pool = {0};
    bool *in_loop = memory_pool_array(&pool, cloud->count, sizeof *in_loop);
    size_t *order = memory_pool_array(&pool, cloud->count, sizeof *order);
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
    {
        order_points(loop, cloud->count, in_loop, order);
        status = cloud_permute(cloud, order, error);
    }
    if (status == BAT_OK)
    {
        cloud->boundary_count = loop->count;
        cloud->has_corners = false;
    }
    memory_pool_free(&pool);
    return status;
}

/// Copy the points, scaled to unit size, in an order that does not depend on that of the cloud and in which near points are
/// near: leaves of a tree that is built in the canonical order.
/// @param places receives the index in the cloud of each copied point
static bat_status sort_points(const bat_cloud *cloud, double **points, size_t **places, bat_error *error)
{
    size_t count = cloud->count;
    nearest_tree tree = {0};
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
        status = neighbours_build(*points, count, &tree, error);
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
    nearest_free(&tree);
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
    return cloud_find_boundary(cloud, 1, (bat_progress){0}, error);
}

bat_status cloud_find_boundary(bat_cloud *cloud, double scale, bat_progress progress, bat_error *error)
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
    loop_search search = {
        .scale = scale, .progress = progress, .unit = ldexp(1, 1 - unit_frame_of(cloud->points, cloud->count).exponent)};
    if (status == BAT_OK)
        status = find_any_loop(points, cloud->count, &search, &loop, error);
    for (size_t i = 0; status == BAT_OK && i < loop.count; i++)
        loop.points[i] = (uint32_t)places[loop.points[i]];
    if (status == BAT_OK && loop.count >= MIN_BOUNDARY)
        status = reorder(cloud, &loop, error);
    free(loop.points);
    free(points);
    free(places);
    return status;
}
