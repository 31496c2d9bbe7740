/// @file
/// Judgement of a surface by its cloud; see verdict.h. The surface is sampled on a grid in each cell. A sample y has the
/// area |S_u x S_v| of its part of the cell, the distance d from the nearest point, and the cosine of the angle between its
/// normal and that of this point's tangent plane.

#include "surface/verdict.h"

#include "base/choice.h"
#include "base/progress.h"
#include "base/threads.h"
#include "batten/mesh_measure.h"
#include "linalg/vector.h"
#include "surface/parameterize/weights.h"
#include "surface/trim/trimming.h"

#include <stdio.h>
#include <string.h>

enum
{
    MIN_SIDE = 2, ///< samples of a cell in each direction
    MAX_SIDE = 64,
    MAX_SAMPLES = 400000,
    BLOCK_POINTS = 65536, ///< measured between two questions whether to go on
    SPACING_POINTS = 12,
    /// With fewer points than so many neighbourhoods together, tangent planes say too little: distances alone are judged.
    MIN_PLANE_POINTS = 4 * SPACING_POINTS
};

// Limits outside of which a surface is wrong, chosen on generated shapes and half of the crops (docs/results/surfaces.md).
static const double MAX_CROSS = 0.05;          ///< share of area across the tangent planes
static const double MAX_FAR = 0.03;            ///< share of area far from the points
static const double MAX_AREA[2] = {0.85, 1.3}; ///< ratio of the areas
static const double MAX_MISSED = 0.02;         ///< distance of points, as a share of the size,
static const double MAX_TAIL = 0.05;           ///< of one point in 200,
static const double MISSED_SPACINGS = 0.5;     ///< and in spacings, whichever is more
static const double MAX_FARTHEST = 0.05;       ///< distance of the surface, as a share of the size,
static const double FARTHEST_SPACINGS = 2;     ///< and in spacings, there or of all, whichever is most
static const double FARTHEST_TRIMMED = 4;      ///< the same of a trimmed surface, whose curves span gaps and corners

// Distances in spacings and standard deviations of the noise that are not far.
static const double FAR_SPACINGS = 3;
static const double FAR_NOISE = 4;
/// Of deep shapes: the largest noise, in spacings, and distance of 99 % of the surface from triangles, in their size.
static const double DEEP_NOISE = 0.2;
static const double DEEP_STRAY = 0.03;
static const double CROSS_COSINE = 0.5;
/// Distance from tangent planes that is doubtful, in sizes, spacings and standard deviations.
static const double OFF_PLANES[3] = {0.0195, 0.45, 4};
/// Of the outline: the distance of neighbours that 95 % have at most, in sizes and spacings; and the share of its length
/// along which the spacing is more than so many sizes and median spacings.
static const double OUTLINE_GAP[2] = {0.12, 3}, RIM_SHARE = 0.1, RIM_SPACING[2] = {0.02, 1.5};
/// Of gaps: a place is empty where its distance from the points is more than so many times that of 90 % of the surface, in
/// local spacings. Doubtful is so much empty area within so many spacings. Chosen on crops of the seeds 1 to 9 of the study.
static const double EMPTY = 1.75, GAP_AREA = 5, GAP_REACH = 3;
/// Sides of stars longer than this many spacings span gaps.
static const double MAX_SPOKE = 3.5;
static const double GOLDEN = 0.6180339887498949;

void cloud_geometry_free(cloud_geometry *geometry)
{
    spatial_order_free(&geometry->order);
    oriented_planes_free(&geometry->oriented);
    free(geometry->spacing);
    *geometry = (cloud_geometry){0};
}

/// The part of the triangle of the origin, a and b that is nearest to the origin: the mixed area of Meyer, Desbrun,
/// Schroeder and Barr, "Discrete differential-geometry operators" (2003). The parts of the corners of a triangle sum up to
/// it. In a star whose neighbours lie on one circle with the origin, as in grids, they do not depend on the diagonals.
static double mixed_area(const double a[2], const double b[2])
{
    double area = fmax(a[0] * b[1] - a[1] * b[0], 0) / 2;
    double aa = a[0] * a[0] + a[1] * a[1], bb = b[0] * b[0] + b[1] * b[1], ab = a[0] * b[0] + a[1] * b[1];
    if (!(area > 0) || ab <= 0)
        return area / 2;
    if (aa <= ab || bb <= ab)
        return area / 4;
    // The cotangents at b and at a are (bb - ab) and (aa - ab) over twice the area.
    return (aa * (bb - ab) + bb * (aa - ab)) / (16 * area);
}

/// The area of a point: its parts of its triangles in a Delaunay triangulation of its tangent plane.
static double star_area(const weight_scratch *scratch, size_t count, double spacing)
{
    size_t ring[STAR_MAX_RING];
    bool closed;
    size_t corners = star_find((const double(*)[2])scratch->planar, count, scratch->inverse, ring, &closed);
    double sum = 0;
    for (size_t k = 0; k + (closed ? 0 : 1) < corners; k++)
    {
        const double *a = scratch->planar[ring[k]], *b = scratch->planar[ring[(k + 1) % corners]];
        double longest = fmax(fmax(hypot(a[0], a[1]), hypot(b[0], b[1])), hypot(a[0] - b[0], a[1] - b[1]));
        if (longest < MAX_SPOKE * spacing)
            sum += mixed_area(a, b);
    }
    return sum;
}

/// Spacing and area of a point. False when out of memory.
static bool measure_point(cloud_geometry *geometry, size_t point, weight_scratch *scratch, double *area)
{
    const double *points = geometry->order.cloud.points, *here = points + 3 * point;
    const local_plane *plane = &geometry->oriented.planes[point];
    size_t reach = geometry->oriented.reach[point];
    if (neighbours_nearest(&geometry->order.tree, here, reach > SPACING_POINTS ? reach : SPACING_POINTS, &scratch->near,
                           NULL) != BAT_OK ||
        weight_scratch_reserve(scratch, scratch->near.count, NULL) != BAT_OK)
        return false;
    size_t count = 0;
    double farthest = 0;
    for (size_t k = 0; k < scratch->near.count; k++)
    {
        uint32_t item = scratch->near.entries[k].item;
        if (item == point)
            continue;
        local_plane_project(plane, here, points + 3 * (size_t)item, scratch->planar[count]);
        farthest = fmax(farthest, hypot(scratch->planar[count][0], scratch->planar[count][1]));
        count++;
    }
    geometry->spacing[point] = count > 0 ? farthest * sqrt(ANGLE_PI / (double)count) : 0;
    *area = star_area(scratch, count, geometry->spacing[point]);
    return true;
}

static bool measure_block(cloud_geometry *geometry, size_t begin, size_t end, int threads, double *areas)
{
    bool complete = true;
#pragma omp parallel num_threads(threads_for(threads, (end - begin) / 256 + 1)) reduction(&& : complete)
    {
        weight_scratch scratch = {0};
#pragma omp for schedule(dynamic, 256)
        for (size_t i = begin; i < end; i++)
            complete = complete && measure_point(geometry, i, &scratch, &areas[i]);
        weight_scratch_free(&scratch);
    }
    return complete;
}

static bat_status measure_points(cloud_geometry *geometry, int threads, bat_progress progress, bat_error *error)
{
    size_t count = geometry->order.cloud.count;
    geometry->spacing = memory_array(count, sizeof *geometry->spacing);
    double *areas = memory_array(count, sizeof *areas);
    bool complete = geometry->spacing != NULL && areas != NULL, goes_on = true;
    // Blocks: the caller is asked between them whether to go on.
    for (size_t begin = 0; begin < count && complete && goes_on; begin += BLOCK_POINTS)
    {
        goes_on = progress_goes_on(progress, (double)begin / (double)count);
        complete =
            measure_block(geometry, begin, count - begin < BLOCK_POINTS ? count : begin + BLOCK_POINTS, threads, areas);
    }
    for (size_t i = 0; complete && goes_on && i < count; i++)
        geometry->area += areas[i];
    if (complete && goes_on)
    {
        memcpy(areas, geometry->spacing, count * sizeof *areas);
        geometry->middle_spacing = sort_median(areas, count);
    }
    free(areas);
    if (!goes_on)
        return error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped");
    return complete ? BAT_OK : error_memory(error, count * 2 * sizeof(double));
}

/// Take tangent planes and areas from the triangles of a mesh: where sheets are near each other, neighbours in space are not
/// neighbours in the surface. Normals are means over neighbours, so that noise does not tilt them.
static bat_status measure_triangles(cloud_geometry *geometry, bat_error *error)
{
    static const int ROUNDS = 2;
    const bat_cloud *cloud = &geometry->order.cloud;
    double *normals = memory_array(cloud->count, 6 * sizeof *normals);
    if (normals == NULL)
        return error_memory(error, cloud->count * 6 * sizeof *normals);
    double *next = normals + 3 * cloud->count;
    memset(normals, 0, 6 * cloud->count * sizeof *normals);
    for (int round = 0; round < ROUNDS; round++)
    {
        for (size_t t = 0; t < cloud->triangle_count; t++)
        {
            const uint32_t *corners = cloud->triangles + 3 * t;
            double normal[3] = {0};
            if (round == 0)
                vector3_face(cloud->points, corners, normal);
            for (size_t k = 0; k < 9 && round > 0; k++)
                normal[k % 3] += normals[3 * (size_t)corners[k / 3] + k % 3];
            for (size_t k = 0; k < 9; k++)
                next[3 * (size_t)corners[k / 3] + k % 3] += normal[k % 3];
        }
        memcpy(normals, next, 3 * cloud->count * sizeof *normals);
        memset(next, 0, 3 * cloud->count * sizeof *next);
    }
    for (size_t i = 0; i < cloud->count; i++)
    {
        double length = sqrt(vector3_dot(normals + 3 * i, normals + 3 * i));
        for (size_t k = 0; k < 3 && length > 0; k++)
            normals[3 * i + k] /= length;
        if (length > 0)
            memcpy(geometry->oriented.planes[i].axes[2], normals + 3 * i, 3 * sizeof *normals);
    }
    geometry->area = 0;
    for (size_t t = 0; t < cloud->triangle_count; t++)
    {
        double normal[3];
        vector3_face(cloud->points, cloud->triangles + 3 * t, normal);
        for (size_t k = 0; k < 3; k++)
            geometry->area += fabs(vector3_dot(normal, normals + 3 * (size_t)cloud->triangles[3 * t + k])) / 6;
    }
    free(normals);
    return BAT_OK;
}

bat_status cloud_geometry_make(const bat_cloud *cloud, int threads, bat_progress progress, cloud_geometry *geometry,
                               bat_error *error)
{
    *geometry = (cloud_geometry){.frame = unit_frame_of(cloud->points, cloud->count)};
    bat_status status = spatial_order_make(cloud, &geometry->order, error);
    if (status == BAT_OK)
        status = oriented_planes_make(&geometry->order.cloud, &geometry->order.tree, &geometry->oriented, error);
    if (status == BAT_OK)
        status = measure_points(geometry, threads, progress, error);
    if (status == BAT_OK && cloud->triangle_count > 0)
        status = measure_triangles(geometry, error);
    if (status == BAT_OK)
        status = noise_estimate(geometry->order.cloud.points, &geometry->order.tree, &geometry->noise, error);
    double low[3], high[3];
    if (status == BAT_OK)
        box_of_points(3, geometry->order.cloud.points, cloud->count, low, high);
    for (int k = 0; status == BAT_OK && k < 3; k++)
        geometry->size = fmax(geometry->size, high[k] - low[k]);
    return status;
}

typedef struct surface_samples
{
    memory_pool pool;
    double *parameters; ///< count x 2
    double *shares;     ///< count: areas in the square
    double *values;     ///< count x 9: place, S_u, S_v
    double *distances;  ///< count: from the nearest points
    double *cosines;    ///< count
    double *heights;    ///< count: from the tangent planes of the nearest points
    uint32_t *nearest;  ///< count
    size_t count;
} surface_samples;

static bat_status samples_reserve(surface_samples *samples, size_t count, bat_error *error)
{
    memory_pool *pool = &samples->pool;
    samples->parameters = memory_pool_array(pool, count, 2 * sizeof(double));
    samples->shares = memory_pool_array(pool, count, sizeof(double));
    samples->values = memory_pool_array(pool, count, 9 * sizeof(double));
    samples->distances = memory_pool_array(pool, count, sizeof(double));
    samples->cosines = memory_pool_array(pool, count, sizeof(double));
    samples->heights = memory_pool_array(pool, count, sizeof(double));
    samples->nearest = memory_pool_array(pool, count, sizeof(uint32_t));
    return memory_pool_check(pool, error);
}

/// Samples in each direction of a cell, so that there are some for each point.
static size_t side_of(const bat_hierarchical_space *space, size_t points)
{
    size_t cells = bat_hierarchical_space_cells(space);
    double side = ceil(sqrt(2 * (double)points / (double)cells));
    size_t wanted = side > MAX_SIDE ? MAX_SIDE : side < MIN_SIDE + 1 ? MIN_SIDE + 1 : (size_t)side;
    while (wanted > MIN_SIDE && cells * wanted * wanted > MAX_SAMPLES)
        wanted--;
    return wanted;
}

/// Set the samples of all cells. Coarse cells, which are larger, get as many more as they are larger, up to MAX_SIDE.
static bat_status set_samples(const bat_spline_surface *surface, size_t points, surface_samples *samples, bat_error *error)
{
    const bat_hierarchical_space *space = surface->space;
    bat_hierarchical_options options = bat_hierarchical_space_options(space);
    size_t cells = bat_hierarchical_space_cells(space), side = side_of(space, points);
    size_t *sides = memory_pool_array(&samples->pool, cells, sizeof *sides);
    if (sides == NULL)
        return memory_pool_check(&samples->pool, error);
    double mean = sqrt(1 / (double)cells);
    for (size_t c = 0; c < cells; c++)
    {
        bat_spline_box cell = bat_hierarchical_space_cell(space, c);
        double width = ldexp(1 / sqrt((double)options.spans[0] * (double)options.spans[1]), -(int)cell.level);
        double wanted = ceil((double)side * fmax(width / mean, 1));
        sides[c] = cells > MAX_SAMPLES / (MAX_SIDE * MAX_SIDE) ? side : wanted > MAX_SIDE ? MAX_SIDE : (size_t)wanted;
        samples->count += sides[c] * sides[c];
    }
    size_t made = 0;
    bat_status status = samples_reserve(samples, samples->count, error);
    for (size_t c = 0; status == BAT_OK && c < cells; c++)
    {
        bat_spline_box cell = bat_hierarchical_space_cell(space, c);
        double step[2];
        for (size_t d = 0; d < 2; d++)
            step[d] = ldexp(1 / (double)options.spans[d], -(int)cell.level);
        for (size_t k = 0; k < sides[c] * sides[c]; k++, made++)
        {
            size_t column = k % sides[c], row = k / sides[c];
            // Shifted rows and columns: edges along them would meet all samples of one, or none.
            const double at[2] = {((double)column + fmod(GOLDEN * (double)row, 1)) / (double)sides[c],
                                  ((double)row + fmod(GOLDEN * (double)column, 1)) / (double)sides[c]};
            for (size_t d = 0; d < 2; d++)
                samples->parameters[2 * made + d] = fmin((cell.low[d] + at[d]) * step[d], 1);
            samples->shares[made] = step[0] * step[1] / (double)(sides[c] * sides[c]);
        }
    }
    return status;
}

/// Distance and cosine of a sample; its share becomes its area.
static bat_status measure_sample(const cloud_geometry *geometry, neighbour_list *near, size_t s, surface_samples *samples)
{
    const double *value = samples->values + 9 * s;
    double place[3], normal[3];
    unit_frame_place(&geometry->frame, value, place);
    vector3_cross(value + 3, value + 6, normal);
    double length = sqrt(vector3_dot(normal, normal));
    bat_status status = neighbours_nearest(&geometry->order.tree, place, 1, near, NULL);
    if (status != BAT_OK)
        return status;
    samples->nearest[s] = near->entries[0].item;
    samples->distances[s] = sqrt(near->entries[0].squared);
    samples->shares[s] *= length;
    const double *axis = geometry->oriented.planes[samples->nearest[s]].axes[2];
    samples->cosines[s] = length > 0 ? vector3_dot(normal, axis) / length : 0;
    vector3_subtract(place, geometry->order.cloud.points + 3 * (size_t)samples->nearest[s], place);
    samples->heights[s] = fabs(vector3_dot(place, axis));
    return BAT_OK;
}

static bat_status measure_samples(const cloud_geometry *geometry, int threads, surface_samples *samples, bat_error *error)
{
    bool complete = true;
#pragma omp parallel num_threads(threads_for(threads, samples->count / 1024 + 1)) reduction(&& : complete)
    {
        neighbour_list near = {0};
#pragma omp for schedule(static)
        for (size_t s = 0; s < samples->count; s++)
            complete = complete && measure_sample(geometry, &near, s, samples) == BAT_OK;
        neighbour_list_free(&near);
    }
    return complete ? BAT_OK : error_memory(error, sizeof(neighbour));
}

typedef struct weighted_distance
{
    double distance, area; ///< ascending() compares the first
} weighted_distance;

/// The distance within which a share of the area is.
static bat_status quantile_of(const surface_samples *samples, const double *distances, double share, double area,
                              double *quantile, bat_error *error)
{
    weighted_distance *sorted = memory_array(samples->count, sizeof *sorted);
    if (sorted == NULL)
        return error_memory(error, samples->count * sizeof *sorted);
    for (size_t s = 0; s < samples->count; s++)
        sorted[s] = (weighted_distance){distances[s], samples->shares[s]};
    qsort(sorted, samples->count, sizeof *sorted, ascending);
    double sum = 0;
    size_t at = 0;
    while (at + 1 < samples->count && (sum += sorted[at].area) < share * area)
        at++;
    *quantile = sorted[at].distance;
    free(sorted);
    return BAT_OK;
}

/// The distances that 99 % and 99.5 % of the points are within.
static bat_status missed_of(const double *distances, size_t count, double *missed, double *tail, bat_error *error)
{
    double *sorted = memory_array(count, sizeof *sorted);
    if (sorted == NULL)
        return error_memory(error, count * sizeof *sorted);
    memcpy(sorted, distances, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, ascending);
    *missed = sorted[(size_t)(0.99 * (double)(count - 1))];
    *tail = sorted[(size_t)(0.995 * (double)(count - 1))];
    free(sorted);
    return BAT_OK;
}

/// The distance that noise accounts for. Around thin parts, the residuals of local fits are no noise.
static double noise_reach(const cloud_geometry *geometry)
{
    return FAR_NOISE * (geometry->is_deep ? fmin(geometry->noise, DEEP_NOISE * geometry->middle_spacing) : geometry->noise);
}

/// Sum the areas; `verdict` is still in units of the scaled cloud, `area` in those of the given one.
/// @param farthest distance of the surface from the points that passes, in spacings
/// @param strays   receives whether a place is farther
static void sum_samples(const cloud_geometry *geometry, const surface_samples *samples, double farthest,
                        bat_surface_verdict *verdict, bool *strays)
{
    double front = 0, back = 0, far = 0, worst = 0, noise = noise_reach(geometry);
    *strays = false;
    for (size_t s = 0; s < samples->count; s++)
    {
        double area = samples->shares[s], distance = samples->distances[s];
        verdict->area += area;
        front += samples->cosines[s] >= CROSS_COSINE ? area : 0;
        back += samples->cosines[s] <= -CROSS_COSINE ? area : 0;
        double spacing = geometry->spacing[samples->nearest[s]];
        far += distance > FAR_SPACINGS * spacing + noise_reach(geometry) ? area : 0;
        // A negation is true for what is not a number.
        *strays =
            *strays ||
            !(distance <= fmax(MAX_FARTHEST * geometry->size, farthest * fmax(spacing, geometry->middle_spacing)) + noise);
        if (distance > worst)
        {
            worst = distance;
            memcpy(verdict->place, samples->values + 9 * s, sizeof verdict->place);
        }
    }
    verdict->farthest = worst;
    verdict->far_share = verdict->area > 0 ? far / verdict->area : 1;
    verdict->cross_share = verdict->area > 0 ? 1 - fmax(front, back) / verdict->area : 1;
}

/// The distance from the triangles of a deep shape that 99 % of the surface is within; 0 for others.
static bat_status triangle_strays(const cloud_geometry *geometry, double area, int threads, surface_samples *samples,
                                  double *strays, bat_error *error)
{
    const bat_cloud *cloud = &geometry->order.cloud;
    *strays = 0;
    if (!geometry->is_deep || cloud->triangle_count == 0 || samples->count == 0)
        return BAT_OK;
    const bat_mesh mesh = {.positions = cloud->points,
                           .faces = cloud->triangles,
                           .vertex_count = cloud->count,
                           .face_count = cloud->triangle_count};
    // The heights are no longer needed.
    double *places = memory_pool_array(&samples->pool, samples->count, 3 * sizeof *places);
    bat_mesh_closest_point *closest = memory_pool_array(&samples->pool, samples->count, sizeof *closest);
    bat_status status = memory_pool_check(&samples->pool, error);
    for (size_t s = 0; s < samples->count && status == BAT_OK; s++)
        unit_frame_place(&geometry->frame, samples->values + 9 * s, places + 3 * s);
    if (status == BAT_OK)
        status = bat_mesh_closest(&mesh, places, samples->count, threads, closest, error);
    for (size_t s = 0; s < samples->count && status == BAT_OK; s++)
        samples->heights[s] = closest[s].distance;
    return status == BAT_OK ? quantile_of(samples, samples->heights, 0.99, area, strays, error) : status;
}

/// @param strays    whether a place of the surface is too far, or too much of it is far from the triangles
/// @param tail      distance that 99.5 % of the points are within
/// @param tolerance that was asked for; a distance within it is no fault, up to the limit of the tail
static bat_surface_fault fault_of(const cloud_geometry *geometry, const bat_surface_verdict *verdict, bool strays,
                                  double tail, double tolerance)
{
    double size = ldexp(geometry->size, 1 - geometry->frame.exponent);
    double ratio = verdict->area / verdict->cloud_area, noise = ldexp(noise_reach(geometry), 1 - geometry->frame.exponent);
    // A negation is true for what is not a number.
    if (strays || !(verdict->far_share <= MAX_FAR))
        return BAT_SURFACE_FAULT_LEAVES_POINTS;
    double spacings = geometry->order.cloud.count < MIN_PLANE_POINTS ? 1 : MISSED_SPACINGS;
    double missed = fmax(fmax(MAX_MISSED * size, spacings * verdict->spacing), fmin(tolerance, MAX_TAIL * size));
    if (!(verdict->distance_from_surface <= missed + noise) || !(tail <= fmax(MAX_TAIL * size, verdict->spacing) + noise))
        return BAT_SURFACE_FAULT_MISSES_POINTS;
    if (geometry->order.cloud.count < MIN_PLANE_POINTS)
        return BAT_SURFACE_FAULT_NONE;
    if (!(verdict->cross_share <= MAX_CROSS))
        return BAT_SURFACE_FAULT_FOLDS;
    return ratio >= MAX_AREA[0] && ratio <= MAX_AREA[1] ? BAT_SURFACE_FAULT_NONE : BAT_SURFACE_FAULT_AREA;
}

static void set_doubt(const cloud_geometry *geometry, bat_surface_doubt kind, double size, size_t point,
                      bat_surface_verdict *verdict)
{
    verdict->doubt = kind;
    verdict->doubt_size = size;
    for (int d = 0; d < 3; d++)
        verdict->doubt_place[d] = geometry->frame.middle[d] +
                                  ldexp(geometry->order.cloud.points[3 * point + (size_t)d], 1 - geometry->frame.exponent);
}

/// What the points leave open: data that the fit has not used in this way. Lengths are those of the scaled cloud.
static bat_status doubt(const cloud_geometry *geometry, bat_surface_verdict *verdict, bat_error *error)
{
    const bat_cloud *cloud = &geometry->order.cloud;
    size_t count = cloud->boundary_count, widest = 0, sparsest = 0;
    double *gaps = memory_array(count, sizeof *gaps), length = 0, sparse = 0;
    if (gaps == NULL)
        return error_memory(error, count * sizeof *gaps);
    for (size_t i = 0; i < count; i++)
    {
        size_t next = i + 1 < count ? i + 1 : 0;
        gaps[i] = vector3_distance(cloud->points + 3 * i, cloud->points + 3 * next);
        length += gaps[i];
        widest = gaps[i] > gaps[widest] ? i : widest;
        sparsest = geometry->spacing[i] > geometry->spacing[sparsest] ? i : sparsest;
        // A neighbourhood at the outline is half a disc.
        double spacing = (geometry->spacing[i] + geometry->spacing[next]) / sqrt(8);
        sparse += spacing > fmax(RIM_SPACING[0] * geometry->size, RIM_SPACING[1] * geometry->middle_spacing) ? gaps[i] : 0;
    }
    double largest = count > 0 ? gaps[widest] : 0;
    qsort(gaps, count, sizeof *gaps, ascending);
    double gap = count > 0 ? gaps[count * 95 / 100] : 0;
    free(gaps);
    if (sparse > RIM_SHARE * length && (cloud->triangle_count == 0 || geometry->is_deep))
        set_doubt(geometry, BAT_SURFACE_DOUBT_RIM, geometry->spacing[sparsest] / sqrt(2), sparsest, verdict);
    if (gap > fmax(OUTLINE_GAP[0] * geometry->size, OUTLINE_GAP[1] * geometry->middle_spacing))
        set_doubt(geometry, BAT_SURFACE_DOUBT_OUTLINE, largest, widest, verdict);
    // With few points, planes say too little.
    double spacings = fmax(OFF_PLANES[1] * geometry->middle_spacing, OFF_PLANES[2] * geometry->noise);
    if (cloud->count >= MIN_PLANE_POINTS && verdict->off_planes > fmax(OFF_PLANES[0] * geometry->size, spacings))
    {
        verdict->doubt = BAT_SURFACE_DOUBT_PLANES;
        verdict->doubt_size = verdict->off_planes;
        memcpy(verdict->doubt_place, verdict->place, sizeof verdict->place);
    }
    return BAT_OK;
}

/// Doubt a surface that closes a gap: much of it is empty around one place. Points at random, and noise, leave small places
/// empty, far from each other. The samples become the empty ones, with areas in squared spacings.
static bat_status doubt_gap(const cloud_geometry *geometry, surface_samples *samples, bat_surface_verdict *verdict,
                            bat_error *error)
{
    double *places = memory_pool_array(&samples->pool, samples->count, 3 * sizeof *places), *spacing = samples->heights;
    double limit = 0, largest = GAP_AREA;
    nearest_tree tree = {0};
    neighbour_list near = {0};
    size_t count = 0, widest = 0;
    for (size_t s = 0; s < samples->count; s++)
    {
        spacing[s] = fmax(geometry->spacing[samples->nearest[s]] / sqrt(2), geometry->middle_spacing);
        samples->distances[s] /= spacing[s];
    }
    bat_status status = places == NULL ? memory_pool_check(&samples->pool, error)
                                       : quantile_of(samples, samples->distances, 0.9, verdict->area, &limit, error);
    for (size_t s = 0; s < samples->count && status == BAT_OK; s++)
        if (samples->distances[s] > EMPTY * limit)
        {
            unit_frame_place(&geometry->frame, samples->values + 9 * s, places + 3 * count);
            samples->shares[count] = ldexp(samples->shares[s], 2 * geometry->frame.exponent - 2) / (spacing[s] * spacing[s]);
            samples->distances[count] = 2 * samples->distances[s] * spacing[s];
            samples->nearest[count] = samples->nearest[s];
            spacing[count++] = spacing[s];
        }
    if (status == BAT_OK)
        status = neighbours_build(places, count, &tree, error);
    for (size_t k = 0; k < count && status == BAT_OK; k++)
    {
        double sum = 0;
        status = neighbours_within(&tree, places + 3 * k, GAP_REACH * spacing[k], &near, error);
        for (size_t n = 0; n < near.count; n++)
            sum += samples->shares[near.entries[n].item];
        widest = sum > largest ? k : widest;
        largest = fmax(largest, sum);
    }
    if (status == BAT_OK && largest > GAP_AREA)
        set_doubt(geometry, BAT_SURFACE_DOUBT_GAP, samples->distances[widest], samples->nearest[widest], verdict);
    neighbour_list_free(&near);
    nearest_free(&tree);
    return status;
}

/// Leave out samples beyond the trimming curves, or else the parameters' bounding box, where nothing is known.
static bat_status clip_samples(const bat_spline_trim *trim, const double *parameters, size_t count, surface_samples *samples,
                               bat_error *error)
{
    trim_region region;
    bat_status status = trim_region_make(trim, &region, error);
    if (status != BAT_OK)
        return status;
    double low[2] = {1, 1}, high[2] = {0, 0}, sum = 0, area = 0;
    for (size_t i = 0; i < count; i++)
        box_include(2, parameters + 2 * i, low, high);
    for (size_t e = 0; e < region.count; e++)
        area += vector2_turn(low, region.points[e], region.points[trim_region_next(&region, e)]) / 2;
    size_t kept = 0;
    for (size_t s = 0; s < samples->count; s++)
    {
        const double *at = samples->parameters + 2 * s;
        bool beyond = at[0] < low[0] || at[0] > high[0] || at[1] < low[1] || at[1] > high[1];
        if (trim->loop_count > 0 ? !trim_region_contains(&region, at[0], at[1]) : beyond)
            continue;
        memmove(samples->parameters + 2 * kept, at, 2 * sizeof *at);
        sum += samples->shares[s];
        samples->shares[kept++] = samples->shares[s];
    }
    samples->count = kept;
    for (size_t s = 0; s < kept && area > 0; s++)
        samples->shares[s] *= area / sum; // samples meet the polygons' area by chance alone
    trim_region_free(&region);
    return BAT_OK;
}

bat_status surface_judge(const cloud_geometry *geometry, const bat_spline_surface *surface, const double *parameters,
                         const double *distances, size_t count, const bat_surface_fit_options *options,
                         bat_surface_verdict *verdict, bat_error *error)
{
    surface_samples samples = {0};
    double tail = 0, from_triangles = 0;
    bool strays = false;
    *verdict = (bat_surface_verdict){0};
    bat_status status = set_samples(surface, count, &samples, error);
    if (status == BAT_OK)
        status = clip_samples(&surface->trim, parameters, count, &samples, error);
    if (status == BAT_OK)
        status = progress_check(options->progress, 1, error);
    if (status == BAT_OK && samples.count > 0)
        status = bat_spline_surface_evaluate(surface, samples.parameters, samples.count, 1, samples.values, error);
    if (status == BAT_OK)
        status = measure_samples(geometry, options->threads, &samples, error);
    if (status == BAT_OK)
        status = progress_check(options->progress, 1, error);
    if (status == BAT_OK)
        sum_samples(geometry, &samples, surface->trim.loop_count > 0 ? FARTHEST_TRIMMED : FARTHEST_SPACINGS, verdict,
                    &strays);
    if (status == BAT_OK && samples.count > 0)
        status = quantile_of(&samples, samples.distances, 0.99, verdict->area, &verdict->distance_from_points, error);
    if (status == BAT_OK && samples.count > 0)
        status = quantile_of(&samples, samples.heights, 0.99, verdict->area, &verdict->off_planes, error);
    if (status == BAT_OK)
        status = doubt(geometry, verdict, error);
    if (status == BAT_OK)
        status = triangle_strays(geometry, verdict->area, options->threads, &samples, &from_triangles, error);
    strays = strays || !(from_triangles <= DEEP_STRAY * geometry->size + noise_reach(geometry));
    if (status == BAT_OK)
        status = missed_of(distances, count, &verdict->distance_from_surface, &tail, error);
    int exponent = 1 - geometry->frame.exponent;
    verdict->distance_from_points = ldexp(verdict->distance_from_points, exponent);
    verdict->farthest = ldexp(verdict->farthest, exponent);
    verdict->off_planes = ldexp(verdict->off_planes, exponent);
    verdict->spacing = ldexp(geometry->middle_spacing, exponent);
    verdict->cloud_area = ldexp(geometry->area, 2 * exponent);
    verdict->fault = fault_of(geometry, verdict, strays, tail, options->tolerance);
    if (status == BAT_OK && verdict->fault == BAT_SURFACE_FAULT_NONE &&
        (geometry->order.cloud.triangle_count == 0 || geometry->is_deep))
        status = doubt_gap(geometry, &samples, verdict, error);
    verdict->doubt = verdict->fault == BAT_SURFACE_FAULT_NONE ? verdict->doubt : BAT_SURFACE_DOUBT_NONE;
    verdict->doubt_size = ldexp(verdict->doubt_size, exponent);
    memory_pool_free(&samples.pool);
    return status;
}

static const bat_choice FAULTS[] = {
    CHOICE("none", "nothing is wrong", BAT_SURFACE_FAULT_NONE),
    CHOICE("misses-points", "points are far from the surface", BAT_SURFACE_FAULT_MISSES_POINTS),
    CHOICE("leaves-points", "the surface is far from the points", BAT_SURFACE_FAULT_LEAVES_POINTS),
    CHOICE("folds", "the surface stands across the points' tangent planes", BAT_SURFACE_FAULT_FOLDS),
    CHOICE("area", "the area is not that of the points", BAT_SURFACE_FAULT_AREA),
};
const bat_family bat_surface_fault_family = FAMILY("fault of a surface", FAULTS);

static const bat_choice DOUBTS[] = {
    CHOICE("none", "nothing is in doubt", BAT_SURFACE_DOUBT_NONE),
    CHOICE("planes", "it leaves the tangent planes of the points beside it", BAT_SURFACE_DOUBT_PLANES),
    CHOICE("outline", "neighbours on its outline are far apart", BAT_SURFACE_DOUBT_OUTLINE),
    CHOICE("rim", "points are sparse at its outline, so that the shape may go on", BAT_SURFACE_DOUBT_RIM),
    CHOICE("gap", "a gap between points is closed", BAT_SURFACE_DOUBT_GAP),
    CHOICE("stray", "a point lies far off and bends it, which robust weights prevent", BAT_SURFACE_DOUBT_STRAY),
    CHOICE("area", "it is larger than a trimmed surface of the points", BAT_SURFACE_DOUBT_AREA),
    CHOICE("few", "by few points, which tell little between them", BAT_SURFACE_DOUBT_FEW),
};
const bat_family bat_surface_doubt_family = FAMILY("doubt of a surface", DOUBTS);

bat_status bat_surface_verdict_check(const bat_surface_verdict *verdict, bat_error *error)
{
    char text[200];
    if (verdict->fault == BAT_SURFACE_FAULT_NONE)
        return BAT_OK;
    if (verdict->fault == BAT_SURFACE_FAULT_MISSES_POINTS)
        (void)snprintf(text, sizeof text, "one in a hundred points is farther from it than %.3g",
                       verdict->distance_from_surface);
    else if (verdict->fault == BAT_SURFACE_FAULT_LEAVES_POINTS)
        (void)snprintf(text, sizeof text, "it is up to %.3g from the points, near %.4g %.4g %.4g, and %.2g %% of it is far",
                       verdict->farthest, verdict->place[0], verdict->place[1], verdict->place[2], 100 * verdict->far_share);
    else if (verdict->fault == BAT_SURFACE_FAULT_FOLDS)
        (void)snprintf(text, sizeof text, "%.2g %% of it stands across the points' tangent planes or is turned over",
                       100 * verdict->cross_share);
    else
        (void)snprintf(text, sizeof text, "its area is %.2f times that of the points", verdict->area / verdict->cloud_area);
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the surface is wrong: %s", text);
}
