/// @file
/// Boundary parameters: the boundary loop is mapped to the boundary of the unit square.
///
/// Four points of the loop, given or detected, are mapped to the corners; each side between them is mapped by chord length,
/// centripetally (Lee, 1989) or uniformly. Detected corners maximize
///     sum over corners of sharpness - EVENNESS * sum over sides of (side / length - 1/4)^2.
/// The sharpness is the turning angle of the loop towards the patch, in the tangent plane, between a chord behind and a
/// chord ahead of the corner. The chords span a fixed share of the loop, so that a jagged loop has no spurious corners. The
/// turning angle of a circle is subtracted, so that a smooth loop is split evenly.

#include "base/bisect.h"
#include "base/choice.h"
#include "base/error.h"
#include "linalg/vector.h"
#include "surface/cloud/local_plane.h"

#include <string.h>

/// A closed polygon, parameterized by arc length.
typedef struct cloud_loop
{
    const double *points; ///< count x 3, the caller's; squares of their differences must fit a double
    size_t count;
    double *arc; ///< count + 1: arc length from point 0 to each point, and the total length
} cloud_loop;

static inline double cloud_loop_length(const cloud_loop *loop)
{
    return loop->arc[loop->count];
}

/// @param arc count + 1; receives the arc lengths
static cloud_loop cloud_loop_make(const double *points, size_t count, double *arc)
{
    arc[0] = 0;
    for (size_t i = 0; i < count; i++)
        arc[i + 1] = arc[i] + vector3_distance(points + 3 * ((i + 1) % count), points + 3 * i);
    return (cloud_loop){points, count, arc};
}

/// The point at an arc length from point 0, taken modulo the total length.
static void cloud_loop_at(const cloud_loop *loop, double length, double place[3])
{
    double complete = cloud_loop_length(loop);
    length -= complete * floor(length / complete);
    // arc[low] <= length < arc[low + 1], up to rounding at the end.
    size_t low = bisect_reals(loop->arc, 0, loop->count, length);
    const double *from = loop->points + 3 * low, *to = loop->points + 3 * ((low + 1) % loop->count);
    double side = loop->arc[low + 1] - loop->arc[low], share = side > 0 ? (length - loop->arc[low]) / side : 0;
    for (int k = 0; k < 3; k++)
        place[k] = from[k] + share * (to[k] - from[k]);
}

enum
{
    CORNERS = 4,
    WINDOWS = 3,
    /// Maximum number of candidates: the sharpest point in each of this many equal parts of the loop.
    MAX_CANDIDATES = 100,
    /// Maximum number of points of the cloud used for tangent planes.
    MAX_SAMPLES = 8192,
    MIN_NEIGHBOURS = 12
};

/// Lengths of the chords, as shares of the loop.
static const double WINDOW_SHARES[WINDOWS] = {1.0 / 40, 3.0 / 80, 1.0 / 20};
/// Minimum share of a side in the loop.
#define MIN_SIDE (1.0 / 40)
static const double EVENNESS = 4.0;
/// From this sharpness on, the turning angle is extrapolated to chords of length 0, up to a right angle: sides may curve.
static const double CURVED_SHARPNESS = 0.3;
/// Turning angles below this multiple of a circle's count as smooth; those above MAX_TURN count as MAX_TURN.
static const double SMOOTH_TURN = 2.0;
static const double MAX_TURN = 2.0943951023931953; // 2 pi / 3
/// Weight of the turning angle in space, which decides ties.
static const double TURN_IN_SPACE = 0.1;

typedef struct corner_search
{
    memory_pool pool;
    cloud_loop loop;
    double *points;    ///< points of the cloud, scaled to unit size
    double *samples;   ///< a subset of them
    nearest_tree tree; ///< of the samples
    neighbour_list near;
    double *sharpness; ///< sharpness of every point of the loop
} corner_search;

/// Measure the loop, and take every stride-th point of the cloud.
static bat_status search_begin(const bat_cloud *cloud, corner_search *search, bat_error *error)
{
    size_t count = cloud->count, stride = count / MAX_SAMPLES + 1, samples = (count + stride - 1) / stride;
    unit_frame frame = unit_frame_of(cloud->points, count);
    double *arc = memory_pool_array(&search->pool, cloud->boundary_count + 1, sizeof *arc);
    search->points = memory_pool_array(&search->pool, count, 3 * sizeof *search->points);
    search->samples = memory_pool_array(&search->pool, samples, 3 * sizeof *search->samples);
    search->sharpness = memory_pool_array(&search->pool, cloud->boundary_count, sizeof *search->sharpness);
    bat_status status = memory_pool_check(&search->pool, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < count; i++)
        unit_frame_place(&frame, cloud->points + 3 * i, search->points + 3 * i);
    search->loop = cloud_loop_make(search->points, cloud->boundary_count, arc);
    if (!(cloud_loop_length(&search->loop) > 0))
        return ERROR_ARGUMENT(error, "the boundary has no length");
    for (size_t i = 0; i < samples; i++)
        memcpy(search->samples + 3 * i, search->points + 3 * i * stride, 3 * sizeof *search->samples);
    return neighbours_build(search->samples, samples, &search->tree, error);
}

/// Project a vector to the plane with a unit normal.
static void flatten(double vector[3], const double normal[3])
{
    vector_add(3, -vector3_dot(vector, normal), normal, vector);
}

/// The loop's turning angle at a point, between chords of a length: in space, and in the tangent plane, positive inwards.
static void turns_at(const corner_search *search, size_t at, double chord, const local_plane *plane, double *in_space,
                     double *in_plane)
{
    const double *here = search->points + 3 * at;
    double before[3], after[3], behind[3], ahead[3], bend[3], inward[3];
    cloud_loop_at(&search->loop, search->loop.arc[at] - chord, before);
    cloud_loop_at(&search->loop, search->loop.arc[at] + chord, after);
    vector3_subtract(here, before, behind);
    vector3_subtract(after, here, ahead);
    *in_space = vector3_angle(behind, ahead);
    flatten(behind, plane->axes[2]);
    flatten(ahead, plane->axes[2]);
    vector3_subtract(ahead, behind, bend);
    vector3_subtract(plane->centre, here, inward);
    double angle = vector3_angle(behind, ahead);
    *in_plane = vector3_dot(bend, inward) >= 0 ? angle : -angle;
}

static bat_status measure_at(corner_search *search, size_t at, bat_error *error)
{
    double length = cloud_loop_length(&search->loop), space_sum = 0, circle_sum = 0, in_plane[WINDOWS], plane_sum = 0;
    const double *here = search->points + 3 * at;
    bat_status status = neighbours_within(&search->tree, here, WINDOW_SHARES[WINDOWS - 1] * length, &search->near, error);
    if (status == BAT_OK && search->near.count < MIN_NEIGHBOURS)
        status = neighbours_nearest(&search->tree, here, MIN_NEIGHBOURS, &search->near, error);
    if (status != BAT_OK)
        return status;
    local_plane plane = local_plane_fit(search->samples, &search->near);
    for (int w = 0; w < WINDOWS; w++)
    {
        double in_space;
        turns_at(search, at, WINDOW_SHARES[w] * length, &plane, &in_space, &in_plane[w]);
        space_sum += in_space / WINDOWS;
        plane_sum += in_plane[w] / WINDOWS;
        circle_sum += 2 * ANGLE_PI * WINDOW_SHARES[w] / WINDOWS;
    }
    double sharp = fmin(plane_sum, MAX_TURN) - SMOOTH_TURN * circle_sum;
    // The line of least squares through the turning angles, at chords of length 0; WINDOW_SHARES has equal steps.
    double slope = 0.5 * (in_plane[WINDOWS - 1] - in_plane[0]) / (WINDOW_SHARES[1] - WINDOW_SHARES[0]);
    if (sharp >= CURVED_SHARPNESS)
        sharp = fmax(sharp, fmin(plane_sum - slope * WINDOW_SHARES[1], 0.5 * ANGLE_PI) - SMOOTH_TURN * circle_sum);
    search->sharpness[at] = fmax(sharp, 0) + TURN_IN_SPACE * space_sum;
    return BAT_OK;
}

typedef struct candidate_set
{
    size_t points[MAX_CANDIDATES];
    double shares[MAX_CANDIDATES]; ///< arc length before each, as a share of the loop
    double sharpness[MAX_CANDIDATES];
    size_t count;
} candidate_set;

/// Select the sharpest point of each of MAX_CANDIDATES parts, equal in length or in number of points.
static void choose_candidates(const corner_search *search, bool by_length, candidate_set *set)
{
    const cloud_loop *loop = &search->loop;
    size_t last_part = SIZE_MAX;
    set->count = 0;
    for (size_t i = 0; i < loop->count; i++)
    {
        double share = by_length ? loop->arc[i] / cloud_loop_length(loop) : (double)i / (double)loop->count;
        size_t part = loop->count <= MAX_CANDIDATES ? i : (size_t)(share * MAX_CANDIDATES);
        part = part < MAX_CANDIDATES ? part : MAX_CANDIDATES - 1;
        if (part != last_part)
            set->points[set->count++] = i;
        else if (search->sharpness[i] > search->sharpness[set->points[set->count - 1]])
            set->points[set->count - 1] = i;
        last_part = part;
    }
    for (size_t c = 0; c < set->count; c++)
    {
        set->shares[c] = loop->arc[set->points[c]] / cloud_loop_length(loop);
        set->sharpness[c] = search->sharpness[set->points[c]];
    }
}

static double side_cost(double share, double min_side)
{
    double off = share - 1.0 / CORNERS;
    return share < min_side ? INFINITY : EVENNESS * off * off;
}

/// The best choice so far, and the tables of dynamic programming.
typedef struct corner_choice
{
    double best;
    size_t corners[CORNERS];               ///< candidates
    double value[CORNERS][MAX_CANDIDATES]; ///< best sum for k + 1 corners, the last one at a candidate
    size_t from[CORNERS][MAX_CANDIDATES];  ///< the candidate before it
} corner_choice;

/// Find the best corner k - 1 for corner k at candidate c.
static void choose_before(const candidate_set *set, int k, size_t c, size_t first, double min_side, corner_choice *choice)
{
    double best = -INFINITY;
    size_t from = first;
    for (size_t b = first; b < c; b++)
    {
        double value = choice->value[k - 1][b] - side_cost(set->shares[c] - set->shares[b], min_side);
        if (value > best)
        {
            best = value;
            from = b;
        }
    }
    choice->value[k][c] = best + set->sharpness[c];
    choice->from[k][c] = from;
}

/// Optimize all choices whose first corner is a given candidate, by dynamic programming over the corners.
static void choose_from(const candidate_set *set, size_t first, double min_side, corner_choice *choice)
{
    for (size_t c = first; c < set->count; c++)
        choice->value[0][c] = c == first ? set->sharpness[c] : -INFINITY;
    for (int k = 1; k < CORNERS; k++)
        for (size_t c = first; c < set->count; c++)
            choose_before(set, k, c, first, min_side, choice);
    for (size_t c = first; c < set->count; c++)
    {
        double last_side = 1 - set->shares[c] + set->shares[first];
        double value = choice->value[CORNERS - 1][c] - side_cost(last_side, min_side);
        if (!(value > choice->best))
            continue;
        choice->best = value;
        size_t at = c;
        for (int k = CORNERS - 1; k > 0; k--)
        {
            choice->corners[k] = at;
            at = choice->from[k][at];
        }
        choice->corners[0] = at;
    }
}

static bat_status choose(corner_search *search, size_t corners[CORNERS], bat_error *error)
{
    // Fallbacks for very uneven points, of which no four are far apart.
    static const struct
    {
        bool by_length;
        double min_side;
    } tries[] = {{true, MIN_SIDE}, {true, 0}, {false, 0}};
    corner_choice *choice = memory_pool_array(&search->pool, 1, sizeof *choice);
    candidate_set *set = memory_pool_array(&search->pool, 1, sizeof *set);
    if (choice == NULL || set == NULL)
        return memory_pool_check(&search->pool, error);
    choice->best = -INFINITY;
    for (size_t i = 0; i < sizeof tries / sizeof *tries && choice->best == -INFINITY; i++)
    {
        choose_candidates(search, tries[i].by_length, set);
        for (size_t first = 0; first < set->count; first++)
            choose_from(set, first, tries[i].min_side, choice);
    }
    for (int k = 0; k < CORNERS; k++)
        corners[k] = set->points[choice->corners[k]];
    return BAT_OK;
}

/// Find four corners of a cloud's boundary, which must be known: see bat_cloud_find_corners().
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY
static bat_status cloud_loop_corners(const bat_cloud *cloud, size_t corners[4], bat_error *error)
{
    if (cloud->boundary_count < CORNERS)
        return ERROR_ARGUMENT(error, "the cloud has no boundary to find corners on");
    corner_search search = {0};
    bat_status status = search_begin(cloud, &search, error);
    for (size_t i = 0; i < cloud->boundary_count && status == BAT_OK; i++)
        status = measure_at(&search, i, error);
    if (status == BAT_OK)
        status = choose(&search, corners, error);
    memory_pool_free(&search.pool);
    nearest_free(&search.tree);
    neighbour_list_free(&search.near);
    return status;
}

bat_status bat_cloud_find_corners(bat_cloud *cloud, bat_error *error)
{
    bat_status status = cloud_loop_corners(cloud, cloud->corners, error);
    if (status == BAT_OK)
        cloud->has_corners = true;
    return status;
}

/// The index in the loop of a point of the input.
static size_t find_place(const bat_cloud *cloud, size_t point)
{
    for (size_t i = 0; i < cloud->boundary_count; i++)
        if (cloud_input_index(cloud, i) == point)
            return i;
    return BAT_NO_INDEX;
}

/// A change of the loop's order: `first` becomes index 0, and the direction may be reversed.
typedef struct loop_rotation
{
    size_t first, count;
    bool reversed;
} loop_rotation;

static size_t rotated_place(const loop_rotation *turn, size_t place)
{
    return turn->reversed ? (turn->first + turn->count - place) % turn->count
                          : (place + turn->count - turn->first) % turn->count;
}

/// Whether the corners are in order after a rotation of the loop; `rotated` receives their new indices.
static bool corners_rise(const loop_rotation *turn, const size_t places[4], size_t rotated[4])
{
    for (int k = 0; k < 4; k++)
        rotated[k] = rotated_place(turn, places[k]);
    return rotated[0] < rotated[1] && rotated[1] < rotated[2] && rotated[2] < rotated[3];
}

static bat_status rotate_loop(bat_cloud *cloud, const loop_rotation *turn, bat_error *error)
{
    size_t *order = memory_array(cloud->count, sizeof *order);
    if (order == NULL)
        return error_memory(error, cloud->count * sizeof *order);
    for (size_t i = 0; i < cloud->count; i++)
        order[i < turn->count ? rotated_place(turn, i) : i] = i;
    bat_status status = cloud_permute(cloud, order, error);
    for (size_t t = 0; t < cloud->triangle_count && turn->reversed && status == BAT_OK; t++)
    {
        uint32_t *triangle = cloud->triangles + 3 * t, corner = triangle[1];
        triangle[1] = triangle[2];
        triangle[2] = corner;
    }
    free(order);
    return status;
}

bat_status bat_cloud_set_corners(bat_cloud *cloud, const size_t corners[4], bat_error *error)
{
    size_t places[4], rotated[4];
    if (cloud->boundary_count < 4)
        return ERROR_ARGUMENT(error, "the cloud has no boundary");
    for (int k = 0; k < 4; k++)
    {
        places[k] = find_place(cloud, corners[k]);
        if (places[k] == BAT_NO_INDEX)
            return error_set(error, BAT_INVALID_ARGUMENT, corners[k], 0, "corner %zu is not a boundary point", corners[k]);
    }
    loop_rotation turn = {places[0], cloud->boundary_count, false};
    if (!corners_rise(&turn, places, rotated))
        turn.reversed = true;
    if (!corners_rise(&turn, places, rotated))
        return ERROR_ARGUMENT(error, "corners %zu, %zu, %zu, %zu do not follow each other around the boundary", corners[0],
                              corners[1], corners[2], corners[3]);
    bat_status status = rotate_loop(cloud, &turn, error);
    if (status != BAT_OK)
        return status;
    memcpy(cloud->corners, rotated, sizeof rotated);
    cloud->has_corners = true;
    return BAT_OK;
}

static const bat_choice SIDES[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "in proportion to distance", BAT_CLOUD_SIDES_AUTO),
    CHOICE("chord-length", "in proportion to distance", BAT_CLOUD_SIDES_CHORD_LENGTH),
    CHOICE("centripetal", "in proportion to the root of distance", BAT_CLOUD_SIDES_CENTRIPETAL),
    CHOICE("uniform", "evenly", BAT_CLOUD_SIDES_UNIFORM),
};
const bat_family bat_cloud_sides_family = FAMILY("parameterization of sides", SIDES);

/// The parameter increment between consecutive points of the loop.
static double step_between(const double *from, const double *to, bat_cloud_sides method)
{
    double length = vector3_distance(from, to);
    return method <= BAT_CLOUD_SIDES_CHORD_LENGTH ? length : method == BAT_CLOUD_SIDES_CENTRIPETAL ? sqrt(length) : 1;
}

static void fill_side(const double *points, size_t count, size_t from, size_t to, int side, bat_cloud_sides method,
                      double *parameters)
{
    static const double square[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const double *begin = square[side], *end = square[(side + 1) % 4];
    double complete = 0, reached = 0;
    for (size_t i = from; i < to; i++)
        complete += step_between(points + 3 * (i % count), points + 3 * ((i + 1) % count), method);
    for (size_t i = from; i < to; i++)
    {
        double share = complete > 0 ? reached / complete : (double)(i - from) / (double)(to - from);
        for (int k = 0; k < 2; k++)
            parameters[2 * (i % count) + (size_t)k] = begin[k] == end[k] ? begin[k] : begin[k] < end[k] ? share : 1 - share;
        reached += step_between(points + 3 * (i % count), points + 3 * ((i + 1) % count), method);
    }
}

bat_status bat_cloud_boundary_parameters(const bat_cloud *cloud, bat_cloud_sides method, double *parameters,
                                         bat_error *error)
{
    size_t corners[4], count = cloud->boundary_count;
    if ((unsigned)method > BAT_CLOUD_SIDES_UNIFORM)
        return ERROR_ARGUMENT(error, "unknown method %d for the parameters of sides", (int)method);
    if (count < 4)
        return ERROR_ARGUMENT(error, "the cloud has no boundary");
    memcpy(corners, cloud->corners, sizeof corners);
    bat_status status = cloud->has_corners ? BAT_OK : cloud_loop_corners(cloud, corners, error);
    if (status != BAT_OK)
        return status;
    double *points = points_to_unit_size(cloud->points, count);
    if (points == NULL)
        return error_memory(error, count * 3 * sizeof *points);
    for (int side = 0; side < 4; side++)
        fill_side(points, count, corners[side], side < 3 ? corners[side + 1] : corners[0] + count, side, method, parameters);
    free(points);
    return BAT_OK;
}
