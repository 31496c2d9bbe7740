/// @file
/// Trimming curves through the loops of an outline: corners, and cubic splines of least squares between them.
///
/// The roughness of a loop is the median over its corners of the root mean square residual of a parabola that is fitted to
/// the nearest corners along the loop. A corner of the curve is where straight lines through the points before and after
/// turn by more than MIN_TURNS, and wider ones by little more. It is put where these lines meet. The points between two
/// corners, or all points of a loop without corners, are fitted by a cubic spline with as few spans as bring the residuals
/// down to the roughness.

#include "surface/spline/tensor_surface.h"
#include "surface/trim/trimming.h"

#include "base/error.h"
#include "linalg/dense.h"
#include "linalg/vector.h"

#include <string.h>

enum
{
    ARM = 4, ///< neighbours on each side for the roughness
    MIN_LOOP = 8,
    MAX_SPANS = 256,
    CIRCLE_ROUNDS = 40,
    SPANS = 32, ///< of a circle
    DEGREE = 3,
    SHAPE = 13 ///< numbers of a round edge: of the radius, its factors of 1, and of sine and cosine of up to six angles
};

/// Largest distance of the true edge from a loop, in its roughness: jittered grids leave less area free than random points.
static const double MAX_OFFSET = 1.75;
/// Mean distance of the edge from the sides of a loop through points at random places, in spacings, and what the squared
/// noise in spacings takes off: points of the edge lie on both sides of it.
static const double EDGE = 0.45, EDGE_NOISE = 1.3;
/// Loops with less roughness, in spacings, pass through points of the edge.
static const double ROUGH = 0.08;
/// Roughness beyond this, in spacings, is the shape of a narrow loop.
static const double MAX_ROUGH = 0.3;
/// Least part of the squared roughness that is not the noise's where points are at random places.
static const double RANDOM_PART = 0.25;
/// Smallest turns of corners, of exact and of rough loops.
static const double MIN_TURNS[2] = {0.6, 0.9};
/// Share of the turn over twice the window that is in the window.
static const double TURN_SHARE = 0.65;
/// Lengths on each side of a corner, in spacings, of exact and of rough loops.
static const double WINDOWS[2] = {3, 6};
/// A corner is at most so many spacings away from its point, over the sine of half its angle.
static const double MAX_REACH = 2;
/// Where the sides are nearly opposite, the sine is that of this sum of 1 and their cosine.
static const double MIN_OPENING = 0.7;
/// Tolerances of the fit, in spacings and in units of the roughness.
static const double EXACT = 2e-3;
static const double FAIR = 1.25;
/// Weights of second differences of control points, of exact and of rough loops, relative to the points of a span. They make
/// the system regular and prevent oscillations where points are sparse.
static const double REGULAR[2] = {1e-6, 1e-3};
/// Tolerances of lines and circles in units of the scatter of points, of exact and of rough loops.
static const double SCATTER[2] = {1.25, 1.5};
/// Largest correlation of neighbours' distances from them, in standard deviations.
static const double PATTERN = 3;
/// Largest mean square of distances from the circle of a rough loop, in squared spacings,
static const double MAX_SQUARE = 0.2;
/// and largest gain in the logarithm of the likelihood by other round shapes, whose mean is 6 for circles.
static const double MAX_GAIN = 14;
/// A few points beside an exact edge, up to ROUGH from it, do not count.
static const double MOST = 0.75;
/// Least points of a span, of exact and of rough loops.
static const double SPAN_POINTS[2] = {2, 8};

typedef struct fair_loop
{
    memory_pool pool;
    size_t count;
    double (*points)[2];
    double sides[2];     ///< of the rectangle
    double spacing;      ///< median of its points
    double roughness;    ///< without the part of the noise
    double scatter;      ///< with it: the tolerance of lines and circles
    bool exact;          ///< its points are on the edge
    double offset;       ///< of the edge; above 0 where the loop is smoothed
    double window;       ///< length on each side of a corner
    bool has_corners;    ///< whether corners can be found
    double *at;          ///< count + 1: length of the loop up to a point
    bool *corner;        ///< count
    double (*places)[2]; ///< count: of corners, on the curve
    double *turns;       ///< count
    bool *straight;      ///< count: the side after a corner is a line
    bool lines;          ///< lines and circles are tried
    bool circle;         ///< it became one that all points make likely
    int way;             ///< in which it is fitted
    const double *cloud; ///< cloud_count x 2: parameters of all points
    size_t cloud_count;
    double noise, gap; ///< gap: mean spacing without the neighbours across the loop
} fair_loop;

/// Ways to fit loops: the next one where curves cross.
enum
{
    CURVES,
    POLYGONS,  ///< of the points, shifted, and circles
    UNSHIFTED, ///< polygons of the points, and circles
    POINTS,    ///< polygons of the points
    WAYS
};

/// The index at a distance along the loop, which is cyclic.
static size_t index_at(const fair_loop *loop, size_t index, ptrdiff_t step)
{
    ptrdiff_t count = (ptrdiff_t)loop->count, at = ((ptrdiff_t)index + step) % count;
    return (size_t)(at < 0 ? at + count : at);
}

static const double *point_at(const fair_loop *loop, size_t index, ptrdiff_t step)
{
    return loop->points[index_at(loop, index, step)];
}

#define NEIGHBOURS (2 * ARM + 1)

/// Residual of the parabola through the points within ARM steps, in the axes of its chord, or of the circle near them (Kasa
/// 1976), whichever is less: the arc of a small hole is no parabola.
static double residual_at(const fair_loop *loop, size_t index)
{
    const double *from = point_at(loop, index, -ARM), *to = point_at(loop, index, ARM), *origin = loop->points[index];
    double length = hypot(to[0] - from[0], to[1] - from[1]), least = INFINITY;
    if (!(length > 0))
        return 0;
    const double axis[2] = {(to[0] - from[0]) / length, (to[1] - from[1]) / length};
    for (int circle = 0; circle < 2; circle++)
    {
        double powers[NEIGHBOURS][3], heights[NEIGHBOURS], sum = 0, slope = 1;
        for (int k = 0; k < NEIGHBOURS; k++)
        {
            const double *point = point_at(loop, index, k - ARM);
            double x = (point[0] - origin[0]) / length, y = (point[1] - origin[1]) / length;
            double t = axis[0] * x + axis[1] * y, height = axis[0] * y - axis[1] * x;
            heights[k] = circle ? t * t + height * height : height;
            powers[k][0] = 1;
            powers[k][1] = t;
            powers[k][2] = circle ? height : t * t;
        }
        // Points that have no parabola keep their sum of squares.
        bool solved = decompose_least_squares(NEIGHBOURS, 3, powers[0], heights, NULL) == BAT_OK;
        if (circle && !solved)
            break;
        for (int k = 3; k < NEIGHBOURS; k++)
            sum += heights[k] * heights[k];
        if (circle) // from squares of distances to distances
            slope = sqrt(4 * heights[0] + heights[1] * heights[1] + heights[2] * heights[2]);
        least = fmin(least, length * sqrt(sum / (NEIGHBOURS - 3)) / slope);
    }
    return least;
}

/// @param missing the area outside of the loop, if its points are at random places
static void measure_loop(fair_loop *loop, const outline_loops *loops, const uint32_t *corners, const double *spacing,
                         double noise, double missing)
{
    double *values = loop->turns; // not yet in use
    for (size_t i = 0; i < loop->count; i++)
        values[i] = spacing[corners[i]];
    loop->spacing = sort_median(values, loop->count);
    for (size_t i = 0; i < loop->count; i++)
        values[i] = loop->count > 2 * ARM ? residual_at(loop, i) : 0;
    double rough = fmin(sort_median(values, loop->count), MAX_ROUGH * loop->spacing);
    loop->roughness = sqrt(fmax(rough * rough - noise * noise, loops->random ? RANDOM_PART * rough * rough : 0));
    loop->at[0] = 0;
    for (size_t i = 0; i < loop->count; i++)
    {
        const double *a = loop->points[i], *b = point_at(loop, i, 1);
        loop->at[i + 1] = loop->at[i] + hypot(b[0] - a[0], b[1] - a[1]);
    }
    double length = loop->at[loop->count];
    bool fair = loops->edges == BAT_SURFACE_EDGES_FAIR;
    loop->exact = !(loop->roughness > ROUGH * loop->spacing);
    loop->offset = loop->exact ? fair * DBL_MIN : fmax(fmin(missing / length, MAX_OFFSET * loop->roughness), DBL_MIN);
    loop->roughness = fmax(loop->roughness, fair * ROUGH * loop->spacing);
    loop->scatter = SCATTER[loop->offset > 0] * fmax(rough, fair * ROUGH * loop->spacing) + EXACT * loop->spacing;
    loop->window = WINDOWS[!loop->exact] * loop->spacing;
    // Windows of short loops are too small to tell the corners of a rough one from its roughness.
    loop->has_corners = loop->count >= MIN_LOOP && (loop->exact || loop->window < length / 10);
    loop->window = fmin(loop->window, length / 16);
}

/// The number of steps from a point that stay within a length of the loop, at least 1 and at most a quarter of the loop.
static ptrdiff_t steps_within(const fair_loop *loop, size_t index, int direction, double length)
{
    ptrdiff_t count = (ptrdiff_t)loop->count, steps = 0;
    double walked = 0;
    while (steps < 1 || (walked < length && 4 * steps < count))
    {
        size_t edge = index_at(loop, index, direction * steps - (direction < 0));
        walked += loop->at[edge + 1] - loop->at[edge];
        steps++;
    }
    return steps > 1 && walked > length ? steps - 1 : steps;
}

/// The line of least squares through consecutive points: their mean and the direction in which they follow each other.
static void fit_line(const fair_loop *loop, size_t index, ptrdiff_t first, ptrdiff_t last, double mean[2], double axis[2])
{
    double xx = 0, xy = 0, yy = 0, count = (double)(last - first + 1);
    mean[0] = mean[1] = 0;
    for (ptrdiff_t k = first; k <= last; k++)
        for (int d = 0; d < 2; d++)
            mean[d] += point_at(loop, index, k)[d] / count;
    for (ptrdiff_t k = first; k <= last; k++)
    {
        const double *point = point_at(loop, index, k);
        double x = point[0] - mean[0], y = point[1] - mean[1];
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    double angle = atan2(2 * xy, xx - yy) / 2;
    const double *from = point_at(loop, index, first), *to = point_at(loop, index, last);
    axis[0] = cos(angle);
    axis[1] = sin(angle);
    if (axis[0] * (to[0] - from[0]) + axis[1] * (to[1] - from[1]) < 0)
        vector_scale(2, -1, axis);
}

/// The angle by which a loop turns at a point, from windows of a length on both sides.
static double turn_at(const fair_loop *loop, size_t index, double window)
{
    double mean[2], before[2], after[2];
    fit_line(loop, index, -steps_within(loop, index, -1, window), 0, mean, before);
    fit_line(loop, index, 0, steps_within(loop, index, 1, window), mean, after);
    return atan2(before[0] * after[1] - before[1] * after[0], before[0] * after[0] + before[1] * after[1]);
}

/// Where the lines before and after a corner meet, shifted to the edge; the point itself where that is far away.
static void meet_lines(fair_loop *loop, size_t index, double p[2], const double a[2], double q[2], const double b[2])
{
    const double *point = loop->points[index];
    // The inside is to the left.
    const double shift[2][2] = {{a[1] * loop->offset, -a[0] * loop->offset}, {b[1] * loop->offset, -b[0] * loop->offset}};
    for (int d = 0; d < 2; d++)
    {
        p[d] += shift[0][d];
        q[d] += shift[1][d];
        loop->places[index][d] = point[d] + (shift[0][d] + shift[1][d]) / 2;
    }
    double cross = a[0] * b[1] - a[1] * b[0], along = a[0] * b[0] + a[1] * b[1];
    if (fabs(cross) < 0.3)
        return;
    double t = ((q[0] - p[0]) * b[1] - (q[1] - p[1]) * b[0]) / cross;
    // The angle between the sides is pi less the turn.
    double half_sine = sqrt(fmax(1 + along, MIN_OPENING) / 2);
    const double meet[2] = {p[0] + t * a[0], p[1] + t * a[1]};
    if (hypot(meet[0] - point[0], meet[1] - point[1]) <= MAX_REACH * loop->spacing / half_sine)
        memcpy(loop->places[index], meet, sizeof meet);
}

static void place_corner(fair_loop *loop, size_t index)
{
    ptrdiff_t before = steps_within(loop, index, -1, loop->window) + 1;
    ptrdiff_t after = steps_within(loop, index, 1, loop->window) + 1;
    double p[2], a[2], q[2], b[2];
    memcpy(loop->places[index], loop->points[index], sizeof *loop->places);
    if (loop->offset == 0)
        return; // A loop of exact points has a point at the corner. In rough loops the nearest points belong to no side.
    fit_line(loop, index, -before, -1, p, a);
    fit_line(loop, index, 1, after, q, b);
    meet_lines(loop, index, p, a, q, b);
}

/// Whether distances are within the tolerance, and not alike for neighbours.
/// @param sums of squares, of products of neighbours, and the number of distances within twice the tolerance
static bool scatters(const fair_loop *loop, const double sums[3], double count)
{
    double exact = EXACT * loop->spacing, tolerance = loop->scatter;
    if (loop->offset == 0 && sums[2] >= MOST * count)
        tolerance = fmax(tolerance, ROUGH * loop->spacing);
    return sums[0] <= count * exact * exact ||
           (sums[0] <= count * tolerance * tolerance && sums[1] <= PATTERN / sqrt(count) * sums[0]);
}

static void add_distance(const fair_loop *loop, double distance, double *before, double sums[3])
{
    sums[0] += distance * distance;
    sums[1] += distance * *before;
    sums[2] += fabs(distance) <= 2 * loop->scatter;
    *before = distance;
}

/// Fit a line to points between two corners.
static bool fit_side(const fair_loop *loop, size_t index, ptrdiff_t first, ptrdiff_t last, double mean[2], double axis[2])
{
    double sums[3] = {0}, before = 0;
    if (last - first < ARM)
        return false;
    fit_line(loop, index, first, last, mean, axis);
    for (ptrdiff_t k = first; k <= last; k++)
    {
        const double *point = point_at(loop, index, k);
        add_distance(loop, axis[0] * (point[1] - mean[1]) - axis[1] * (point[0] - mean[0]), &before, sums);
    }
    return scatters(loop, sums, (double)(last - first + 1));
}

/// Find the straight sides, and put corners on them.
static void find_sides(fair_loop *loop)
{
    ptrdiff_t gap = loop->offset > 0 ? 2 : 1; // as in place_corner()
    memset(loop->straight, 0, loop->count * sizeof *loop->straight);
    if (!loop->lines)
        return;
    bool sharp = loop->offset == 0 && loop->scatter < ROUGH / 4 * loop->spacing;
    for (size_t i = 0; i < loop->count; i++)
    {
        ptrdiff_t before = 1, after = 1;
        double p[2], a[2], q[2], b[2], *place = loop->places[i];
        if (!loop->corner[i])
            continue;
        while (!loop->corner[index_at(loop, i, -before)])
            before++;
        while (!loop->corner[index_at(loop, i, after)])
            after++;
        loop->straight[i] = fit_side(loop, i, gap, after - gap, q, b);
        bool behind = fit_side(loop, i, gap - before, -gap, p, a);
        if (loop->straight[i] && behind && !sharp)
            meet_lines(loop, i, p, a, q, b);
        const double *at = behind ? p : q, *axis = behind ? a : b;
        if (behind == loop->straight[i] || sharp)
            continue;
        double off = axis[0] * (place[1] - at[1]) - axis[1] * (place[0] - at[0]) + loop->offset;
        place[0] += axis[1] * off;
        place[1] -= axis[0] * off;
    }
}

/// Whether a corner has no rival of a larger turn within its window.
static bool is_sharpest(const fair_loop *loop, size_t index)
{
    double turn = loop->turns[index];
    for (ptrdiff_t k = -steps_within(loop, index, -1, loop->window); k <= steps_within(loop, index, 1, loop->window); k++)
    {
        double rival = loop->turns[index_at(loop, index, k)];
        if (rival * turn > 0 && (fabs(rival) > fabs(turn) || (fabs(rival) == fabs(turn) && k < 0)))
            return false;
    }
    return true;
}

static void find_corners(fair_loop *loop)
{
    memset(loop->corner, 0, loop->count * sizeof *loop->corner);
    if (!loop->has_corners)
        return;
    for (size_t i = 0; i < loop->count; i++)
    {
        double turn = turn_at(loop, i, loop->window);
        bool sharp =
            fabs(turn) >= MIN_TURNS[!loop->exact] && fabs(turn) >= TURN_SHARE * fabs(turn_at(loop, i, 2 * loop->window));
        loop->turns[i] = sharp ? turn : 0;
    }
    for (size_t i = 0; i < loop->count; i++)
        loop->corner[i] = loop->turns[i] != 0 && is_sharpest(loop, i);
    for (size_t i = 0; i < loop->count; i++)
        if (loop->corner[i])
            place_corner(loop, i);
    find_sides(loop);
}

// Curves

/// The points of a piece with their parameters in [0, 1].
typedef struct fair_piece
{
    double (*points)[2];
    double *at;
    size_t count;
    bool closed; ///< a loop without corners: the last point is the first one
    bool rough;
} fair_piece;

/// A control point as a combination of unknowns.
typedef struct control_rule
{
    size_t unknown[2]; ///< SIZE_MAX for none
    double weight[2];
    const double *fixed; ///< null for none
} control_rule;

/// Ends are fixed. In a closed piece, unknowns 0 and 1 are the common end and the step to the next control point.
static control_rule rule_of(const fair_piece *piece, size_t functions, size_t index)
{
    bool end = index == 0 || index == functions - 1, beside = index == 1 || index == functions - 2;
    if (piece->closed)
        return (control_rule){{end || beside ? 0 : index, beside ? 1 : SIZE_MAX}, {1, index == 1 ? 1 : -1}, NULL};
    const double *fixed = !end ? NULL : piece->points[index == 0 ? 0 : piece->count - 1];
    return (control_rule){{end ? SIZE_MAX : index - 1, SIZE_MAX}, {1, 0}, fixed};
}

/// Add the square of sum_k factors[k] c_(first + k) - target to the normal equations.
static void add_equation(const fair_piece *piece, size_t functions, size_t unknowns, size_t first, size_t count,
                         const double *factors, const double target[2], double weight, double *matrix, double *right)
{
    double left[2] = {target[0], target[1]}, row[2 * (DEGREE + 1)];
    size_t column[2 * (DEGREE + 1)], made = 0;
    for (size_t k = 0; k < count; k++)
    {
        control_rule rule = rule_of(piece, functions, first + k);
        for (int d = 0; d < 2 && rule.fixed != NULL; d++)
            left[d] -= factors[k] * rule.fixed[d];
        for (int e = 0; e < 2; e++)
            if (rule.unknown[e] != SIZE_MAX)
            {
                column[made] = rule.unknown[e];
                row[made++] = factors[k] * rule.weight[e];
            }
    }
    for (size_t a = 0; a < made; a++)
    {
        for (size_t d = 0; d < 2; d++)
            right[2 * column[a] + d] += weight * row[a] * left[d];
        for (size_t b = 0; b < made; b++)
            matrix[column[a] * unknowns + column[b]] += weight * row[a] * row[b];
    }
}

/// Begin a curve without control points, instead of an earlier one.
static bat_status begin_curve(int degree, size_t spans, bat_spline_curve *curve, bat_error *error)
{
    size_t functions = spans + (size_t)degree;
    spline_curve_free(curve);
    bat_status status = knot_vector_uniform(degree, spans, &curve->knots, error);
    curve->dimension = 2;
    curve->control = memory_array(functions, 2 * sizeof *curve->control);
    return status == BAT_OK && curve->control == NULL ? error_memory(error, functions * 2 * sizeof(double)) : status;
}

/// Fit a curve with a number of spans. `residuals` receives root mean square and largest residual.
static bat_status fit_spans(const fair_piece *piece, size_t spans, bat_spline_curve *curve, double residuals[2],
                            bat_error *error)
{
    size_t functions = spans + DEGREE, unknowns = functions - 2;
    bat_status status = begin_curve(DEGREE, spans, curve, error);
    memory_pool pool = {0};
    double *matrix = memory_pool_zeros(&pool, unknowns * unknowns, sizeof *matrix);
    double *right = memory_pool_zeros(&pool, 2 * unknowns, sizeof *right);
    static const double differences[] = {1, -2, 1}, none[2] = {0, 0};
    if (status == BAT_OK)
        status = memory_pool_check(&pool, error);
    for (size_t i = 0; i < piece->count && status == BAT_OK; i++)
    {
        double basis[DEGREE + 1];
        size_t span = knot_vector_span(&curve->knots, piece->at[i]);
        knot_vector_basis(&curve->knots, span, piece->at[i], 0, basis);
        add_equation(piece, functions, unknowns, span - DEGREE, DEGREE + 1, basis, piece->points[i], 1, matrix, right);
    }
    for (size_t i = 0; i + 2 < functions && status == BAT_OK; i++)
        add_equation(piece, functions, unknowns, i, 3, differences, none,
                     REGULAR[piece->rough] * (double)piece->count / (double)spans, matrix, right);
    if (status == BAT_OK)
        status = decompose_solve(unknowns, 2, matrix, right, error);
    for (size_t i = 0; i < functions && status == BAT_OK; i++)
    {
        control_rule rule = rule_of(piece, functions, i);
        for (size_t d = 0; d < 2; d++)
        {
            double value = rule.fixed != NULL ? rule.fixed[d] : 0;
            for (int e = 0; e < 2; e++)
                value += rule.unknown[e] != SIZE_MAX ? rule.weight[e] * right[2 * rule.unknown[e] + d] : 0;
            curve->control[2 * i + d] = value;
        }
    }
    memory_pool_free(&pool);
    residuals[0] = residuals[1] = 0;
    for (size_t i = 0; i < piece->count && status == BAT_OK; i++)
    {
        double place[2];
        spline_curve_place(curve, piece->at[i], place);
        double apart = hypot(place[0] - piece->points[i][0], place[1] - piece->points[i][1]);
        residuals[0] += apart * apart / (double)piece->count;
        residuals[1] = fmax(residuals[1], apart);
    }
    residuals[0] = sqrt(residuals[0]);
    return status;
}

/// The polygon of a piece's points.
static bat_status fit_polygon(const fair_piece *piece, bat_spline_curve *curve, bat_error *error)
{
    bat_status status = begin_curve(1, piece->count - 1, curve, error);
    if (status == BAT_OK)
        memcpy(curve->control, piece->points, piece->count * sizeof *piece->points);
    return status;
}

/// Set the parameters in proportion to the lengths of chords.
static void set_parameters(fair_piece *piece)
{
    piece->at[0] = 0;
    for (size_t i = 1; i < piece->count; i++)
        piece->at[i] = piece->at[i - 1] +
                       hypot(piece->points[i][0] - piece->points[i - 1][0], piece->points[i][1] - piece->points[i - 1][1]);
    double length = piece->at[piece->count - 1];
    for (size_t i = 1; i < piece->count; i++)
        piece->at[i] = length > 0 ? fmin(piece->at[i] / length, 1) : (double)i / (double)(piece->count - 1);
}

/// Whether all control points are in the rectangle.
static bool is_within(const fair_loop *loop, const bat_spline_curve *curve)
{
    for (size_t k = 0; k < 2 * knot_vector_functions(&curve->knots); k++)
        if (curve->control[k] < 0 || curve->control[k] > loop->sides[k % 2])
            return false;
    return true;
}

/// Climb to the most likely round edge of points at random places on its side 1, the outer one, or -1: it maximizes
///     side pi r_0^2 / gap^2 + sum_i log Phi(side (d_i - r(angle_i)) / noise),
/// with distances d from its centre, from a wider normal noise to the given one. Returns the maximum, or NaN.
/// @param shape factors of the radius; those of sine and cosine of the angle itself are the centre's second and first
///              coordinates. The first `number` are found.
static double climb(const fair_loop *loop, const double (*near)[2], size_t count, double side, double noise, size_t number,
                    double shape[SHAPE])
{
    double density = side * ANGLE_PI / (loop->gap * loop->gap), sum = NAN;
    for (int round = 0; round < CIRCLE_ROUNDS; round++)
    {
        double matrix[SHAPE * SHAPE] = {0}, step[SHAPE] = {2 * density * shape[0]}, row[SHAPE];
        double width = fmax(noise, ldexp(loop->gap / 6, -round / 4));
        sum = density * shape[0] * shape[0];
        for (size_t i = 0; i < count; i++)
        {
            const double from[2] = {near[i][0] - shape[2], near[i][1] - shape[1]};
            double angle = atan2(from[1], from[0]), u = hypot(from[0], from[1]) - shape[0];
            for (size_t k = 0; k < number; k++)
            {
                double turns = floor((double)(k + 1) / 2), wave = k % 2 == 1 ? sin(turns * angle) : cos(turns * angle);
                row[k] = -side * wave / width;
                u -= k > 2 ? wave * shape[k] : 0;
            }
            u *= side / width;
            if (u > 8)
                continue;
            double ratio = u < -30 ? -u : sqrt(2 / ANGLE_PI) * exp(-u * u / 2) / erfc(-u * sqrt(0.5)); // Phi' / Phi
            sum -= u * u / 2 + log(sqrt(ANGLE_TURN) * ratio);
            for (size_t a = 0; a < number; a++)
            {
                step[a] += ratio * row[a];
                for (size_t b = 0; b < number; b++)
                    matrix[a * number + b] += ratio * (ratio + u) * row[a] * row[b];
            }
        }
        if (decompose_solve(number, 1, matrix, step, NULL) != BAT_OK)
            return NAN;
        double length = sqrt(vector_square(number, step));
        for (size_t k = 0; k < number; k++)
            shape[k] += step[k] * fmin(1, loop->gap / (4 * length));
    }
    return sum;
}

/// Move a circle to the edge of points at random places near it: to the most likely circle less its bias, which is 1.8 times
/// the mean distance of the nearest point, by simulation, and less with noise. False where the edge is no circle.
static bool find_edge(const fair_loop *loop, double side, double circle[3])
{
    double(*near)[2] = memory_array(loop->cloud_count, sizeof *near), shape[SHAPE] = {circle[2], circle[1], circle[0]};
    double least = loop->gap * loop->gap / (ANGLE_TURN * circle[2]), noise = hypot(loop->noise, least);
    size_t count = 0;
    for (size_t i = 0; i < loop->cloud_count && near != NULL; i++)
    {
        const double place[2] = {loop->cloud[2 * i] * loop->sides[0], loop->cloud[2 * i + 1] * loop->sides[1]};
        double off = side * (hypot(place[0] - circle[0], place[1] - circle[1]) - circle[2]);
        if (off > -2 * loop->gap && off < 1.5 * loop->gap)
            memcpy(near[count++], place, sizeof place);
    }
    double sum = climb(loop, (const double(*)[2])near, count, side, noise, 3, shape);
    const double likely[3] = {shape[2], shape[1], shape[0] - side * least * (1.1 + 0.7 * least / noise)};
    double gain = climb(loop, (const double(*)[2])near, count, side, noise, SHAPE, shape) - sum;
    bool is_round = gain <= MAX_GAIN && vector3_distance(likely, circle) < loop->gap;
    memcpy(circle, likely, sizeof likely);
    free(near);
    return is_round;
}

/// Fit a circle to the points of a loop, as cubics between the corners of a regular polygon.
static bool fit_circle(fair_loop *loop, const fair_piece *piece, bat_spline_curve *curve)
{
    double circle[3] = {0}, count = (double)piece->count - 1, turn = 0;
    for (size_t i = 0; i + 1 < piece->count; i++)
        for (int d = 0; d < 2; d++)
            circle[d] += piece->points[i][d] / count;
    for (int round = 0; round <= CIRCLE_ROUNDS; round++)
    {
        double step[3] = {0}, sums[3] = {0}, before = 0;
        for (size_t i = 0; i + 1 < piece->count; i++)
        {
            const double from[2] = {piece->points[i][0] - circle[0], piece->points[i][1] - circle[1]};
            double distance = hypot(from[0], from[1]), off = distance - circle[2];
            for (int d = 0; d < 2; d++)
                step[d] += 2 * off * from[d] / (distance * count);
            step[2] += off / count;
            add_distance(loop, off, &before, sums);
            turn += vector2_turn(circle, piece->points[i], piece->points[i + 1]);
        }
        for (int d = 0; d < 3 && round < CIRCLE_ROUNDS; d++)
            circle[d] += step[d];
        bool near = !loop->exact ? sums[0] <= MAX_SQUARE * count * loop->gap * loop->gap : scatters(loop, sums, count);
        if (round == CIRCLE_ROUNDS && (count < MIN_LOOP || !near))
            return false;
    }
    if (!loop->exact && !find_edge(loop, -copysign(1, turn), circle))
        return false;
    *curve = (bat_spline_curve){.dimension = 2, .control = memory_array(2 * SPANS + 2, 2 * sizeof(double))};
    curve->knots = (bat_knot_vector){memory_array(2 * SPANS + 6, sizeof(double)), 2 * SPANS + 6, DEGREE};
    if (curve->control == NULL || curve->knots.knots == NULL)
        return false;
    for (size_t i = 0; i < curve->knots.count; i++)
        curve->knots.knots[i] = fmin(fmax(floor((double)i / 2) - 1, 0) / SPANS, 1);
    for (size_t i = 0; i < 2 * SPANS + 2; i++)
    {
        // Ends, and two control points inside of each span.
        bool end = i == 0 || i == 2 * SPANS + 1;
        double step = copysign(ANGLE_TURN, turn) / SPANS, angle = end ? 0 : step * floor((double)i / 2);
        double reach = (end ? 0 : i % 2 == 1 ? 4. / 3 : -4. / 3) * tan(step / 4);
        curve->control[2 * i] = circle[0] + circle[2] * (cos(angle) - reach * sin(angle));
        curve->control[2 * i + 1] = circle[1] + circle[2] * (sin(angle) + reach * cos(angle));
    }
    loop->circle = loop->offset > 0 && is_within(loop, curve);
    return is_within(loop, curve);
}

/// Fit the curve with the fewest spans within the tolerance; the polygon of exact points where there is none.
static bat_status fit_piece(const fair_loop *loop, fair_piece *piece, bat_spline_curve *curve, bat_error *error)
{
    double tolerance = loop->offset > 0 ? FAIR * loop->roughness : fmax(EXACT * loop->spacing, FAIR * loop->roughness);
    size_t first = piece->closed ? 4 : 1;
    set_parameters(piece);
    if (piece->count == 2 && !piece->closed)
        return fit_polygon(piece, curve, error);
    for (size_t spans = first;; spans *= 2)
    {
        double residuals[2] = {0, 0};
        bat_status status = fit_spans(piece, spans, curve, residuals, error);
        bool within = status == BAT_OK && is_within(loop, curve);
        // Few points far from their curve are no roughness.
        bool rough = piece->rough && within && residuals[0] <= 2 * tolerance;
        size_t most = (size_t)fmin((double)piece->count / SPAN_POINTS[rough], MAX_SPANS);
        if (status != BAT_OK || (within && (residuals[0] <= tolerance || (2 * spans > most && loop->offset > 0))))
            return status;
        if (2 * spans > most)
            return within && residuals[1] <= loop->spacing / 4 ? BAT_OK : fit_polygon(piece, curve, error);
    }
}

/// Append a point of the loop, shifted to the edge across the direction of its neighbours up to the next corners.
static void add_shifted(const fair_loop *loop, size_t index, ptrdiff_t room_before, ptrdiff_t room_after, fair_piece *piece)
{
    ptrdiff_t before = steps_within(loop, index, -1, loop->window), after = steps_within(loop, index, 1, loop->window);
    double mean[2], axis[2];
    const double *point = loop->points[index];
    before = room_before < before ? room_before : before;
    after = room_after < after ? room_after : after;
    if (before + after == 0)
        before = after = 1; // a single point between two corners
    fit_line(loop, index, -before, after, mean, axis);
    piece->points[piece->count][0] = point[0] + axis[1] * loop->offset;
    piece->points[piece->count++][1] = point[1] - axis[0] * loop->offset;
}

/// Gather the points from a corner to the next one, of a line only the corners, or all points of a loop without corners.
static void gather_piece(const fair_loop *loop, size_t begin, size_t steps, fair_piece *piece)
{
    piece->count = 0;
    if (piece->closed)
    {
        for (size_t k = 0; k < loop->count; k++)
            add_shifted(loop, k, (ptrdiff_t)loop->count, (ptrdiff_t)loop->count, piece);
        memcpy(piece->points[piece->count++], piece->points[0], sizeof *piece->points);
        return;
    }
    memcpy(piece->points[piece->count++], loop->places[begin], sizeof *piece->points);
    for (size_t k = 1; k < steps && !loop->straight[begin]; k++)
        add_shifted(loop, (begin + k) % loop->count, (ptrdiff_t)k - 1, (ptrdiff_t)(steps - k) - 1, piece);
    memcpy(piece->points[piece->count++], loop->places[(begin + steps) % loop->count], sizeof *piece->points);
}

/// Leave out points that the shift has moved past their corners: those that do not advance towards the end.
static void drop_overrun(fair_piece *piece)
{
    if (piece->closed || piece->count < 4)
        return;
    for (int end = 0; end < 2; end++)
    {
        const double *corner = piece->points[end == 0 ? 0 : piece->count - 1];
        size_t inner = end == 0 ? 2 : piece->count - 3, outer = end == 0 ? 1 : piece->count - 2;
        double x = piece->points[inner][0] - piece->points[outer][0], y = piece->points[inner][1] - piece->points[outer][1];
        double along = x * (piece->points[outer][0] - corner[0]) + y * (piece->points[outer][1] - corner[1]);
        if (along > 0 || piece->count < 4)
            continue;
        memmove(piece->points + outer, piece->points + outer + 1, (piece->count - outer - 1) * sizeof *piece->points);
        piece->count--;
    }
}

/// Fit curves between corners, or the polygon of the points.
static bat_status fit_loop(fair_loop *loop, bat_spline_trim *trim, bat_error *error)
{
    size_t first = 0, pieces = trim->loops[trim->loop_count];
    find_corners(loop);
    while (first < loop->count && !loop->corner[first])
        first++;
    fair_piece piece = {.points = memory_array(loop->count + 2, sizeof *piece.points),
                        .at = memory_array(loop->count + 2, sizeof *piece.at),
                        .closed = true,
                        .rough = loop->offset > 0};
    bat_status status =
        piece.points == NULL || piece.at == NULL ? error_memory(error, loop->count * 3 * sizeof(double)) : BAT_OK;
    bool whole = first == loop->count, round = status == BAT_OK && loop->lines && (whole || loop->offset > 0);
    if (round)
        gather_piece(loop, 0, 0, &piece);
    round = round && fit_circle(loop, &piece, &trim->pieces[pieces]);
    pieces += round;
    size_t begin = whole ? 0 : first, left = round ? 0 : loop->count;
    piece.closed = whole;
    loop->offset *= loop->way < UNSHIFTED;
    while (status == BAT_OK && left > 0)
    {
        size_t steps = 1;
        while (steps < left && (piece.closed || !loop->corner[(begin + steps) % loop->count]))
            steps++;
        gather_piece(loop, begin, steps, &piece);
        drop_overrun(&piece);
        bat_spline_curve *curve = &trim->pieces[pieces++];
        status = loop->way > CURVES ? fit_polygon(&piece, curve, error) : fit_piece(loop, &piece, curve, error);
        begin = (begin + steps) % loop->count;
        left -= steps;
    }
    free(piece.points);
    free(piece.at);
    trim->loops[trim->loop_count + 1] = pieces;
    trim->loop_count++;
    return status;
}

/// The area that the curves of the last loop surround; negative for a hole.
static double curve_area(const bat_spline_trim *trim)
{
    static const size_t STEPS = 8; ///< of each span
    double sum = 0, origin[2], from[2], to[2];
    size_t begin = trim->loops[trim->loop_count - 1], end = trim->loops[trim->loop_count];
    spline_curve_place(&trim->pieces[begin], 0, origin);
    for (size_t i = begin; i < end; i++)
    {
        const bat_spline_curve *piece = &trim->pieces[i];
        size_t steps = STEPS * (knot_vector_functions(&piece->knots) - (size_t)piece->knots.degree);
        spline_curve_place(piece, 0, from);
        for (size_t k = 1; k <= steps; k++)
        {
            spline_curve_place(piece, (double)k / (double)steps, to);
            sum += vector2_turn(origin, from, to) / 2;
            memcpy(from, to, sizeof from);
        }
    }
    return sum;
}

/// Remove the curves of the last loop.
static void drop_loop(bat_spline_trim *trim)
{
    trim->loop_count--;
    for (size_t i = trim->loops[trim->loop_count]; i < trim->loops[trim->loop_count + 1]; i++)
        spline_curve_free(&trim->pieces[i]);
}

/// Fit curves that surround the area of the points and of the offset: corners and smoothing change it. Lines and circles
/// that surround another area are not kept.
static bat_status fit_area(fair_loop *loop, bat_spline_trim *trim, bat_error *error)
{
    static const int ROUNDS = 3;
    // Of areas; polygons through exact points of circles are smaller by 6.6 / count^2.
    double change = 1e-3 + (loop->offset > 0 ? 0 : 8 / ((double)loop->count * (double)loop->count));
    double length = loop->at[loop->count], offset = loop->offset, area = offset * length, most = 2 * loop->spacing;
    for (size_t i = 1; i + 1 < loop->count; i++)
        area += vector2_turn(loop->points[0], loop->points[i], loop->points[i + 1]) / 2;
    for (int lines = 1;; lines--)
    {
        loop->lines = lines > 0;
        loop->offset = offset;
        bat_status status = fit_loop(loop, trim, error);
        for (int round = 0; round < ROUNDS && status == BAT_OK && loop->offset > 0 && !loop->circle; round++)
        {
            loop->offset = fmin(fmax(loop->offset + (area - curve_area(trim)) / length, DBL_MIN), most);
            drop_loop(trim);
            status = fit_loop(loop, trim, error);
        }
        if (status != BAT_OK || lines == 0 || loop->circle || fabs(curve_area(trim) - area) <= change * fabs(area))
            return status;
        drop_loop(trim);
    }
}

/// Whether the polygons of curves cross themselves or each other.
static bat_status find_crossing(const bat_spline_trim *trim, bool *crosses, bat_error *error)
{
    trim_region region;
    bat_status status = trim_region_make(trim, &region, error);
    *crosses = false;
    for (size_t row = 0; row < TRIM_ROWS && status == BAT_OK && !*crosses; row++)
        for (size_t i = region.row_edges[row]; i < region.row_edges[row + 1] && !*crosses; i++)
            for (size_t k = region.row_edges[row]; k < i && !*crosses; k++)
            {
                uint32_t e = region.edges[i], f = region.edges[k];
                const double *a = region.points[e], *b = region.points[trim_region_next(&region, e)];
                const double *c = region.points[f], *d = region.points[trim_region_next(&region, f)];
                *crosses =
                    vector2_turn(a, b, c) * vector2_turn(a, b, d) < 0 && vector2_turn(c, d, a) * vector2_turn(c, d, b) < 0;
            }
    if (status == BAT_OK)
        trim_region_free(&region);
    return status;
}

/// Scale the curves to the square. Control points stay in it.
static void scale_curves(const double sides[2], bat_spline_trim *trim)
{
    for (size_t p = 0; p < trim->loops[trim->loop_count]; p++)
    {
        bat_spline_curve *piece = &trim->pieces[p];
        for (size_t k = 0; k < 2 * knot_vector_functions(&piece->knots); k++)
            piece->control[k] = fmin(fmax(piece->control[k] / sides[k % 2], 0), 1);
    }
}

static bat_status loop_make(const outline_loops *loops, size_t number, const double sides[2], const double *parameters,
                            size_t points, const double *spacing, double noise, fair_loop *loop, bat_error *error)
{
    const uint32_t *corners = loops->corners + loops->first[number];
    const double *gaps = loops->spacing + loops->first[number];
    size_t count = loops->first[number + 1] - loops->first[number];
    *loop = (fair_loop){
        .count = count, .sides = {sides[0], sides[1]}, .cloud = parameters, .cloud_count = points, .noise = noise};
    loop->points = memory_pool_array(&loop->pool, count, sizeof *loop->points);
    loop->at = memory_pool_array(&loop->pool, count + 1, sizeof *loop->at);
    loop->corner = memory_pool_array(&loop->pool, count, sizeof *loop->corner);
    loop->places = memory_pool_array(&loop->pool, count, sizeof *loop->places);
    loop->turns = memory_pool_array(&loop->pool, count, sizeof *loop->turns);
    loop->straight = memory_pool_array(&loop->pool, count, sizeof *loop->straight);
    bat_status status = memory_pool_check(&loop->pool, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < count; i++)
        for (size_t d = 0; d < 2; d++)
            loop->points[i][d] = parameters[2 * (size_t)corners[i] + d] * sides[d];
    double missing = 0;
    for (size_t i = 0; i < count; i++)
    {
        double gap = (gaps[i] + gaps[(i + 1) % count]) / 2, ratio = noise / gap, *next = loop->points[(i + 1) % count];
        missing += fmax(EDGE - EDGE_NOISE * ratio * ratio, 0) * gap * vector_distance(2, loop->points[i], next);
        loop->gap += gap / (double)count;
    }
    measure_loop(loop, loops, corners, spacing, noise, missing);
    return BAT_OK;
}

static bat_status fit_loops(const outline_loops *loops, const double sides[2], const double *parameters, size_t points,
                            const double *spacing, double noise, int way, bat_spline_trim *trim, bat_error *error)
{
    size_t corners = loops->first[loops->count];
    *trim = (bat_spline_trim){.pieces = calloc(corners, sizeof *trim->pieces),
                              .loops = calloc(loops->count + 1, sizeof *trim->loops)};
    bat_status status =
        trim->pieces == NULL || trim->loops == NULL ? error_memory(error, corners * sizeof *trim->pieces) : BAT_OK;
    for (size_t l = 0; l < loops->count && status == BAT_OK; l++)
    {
        fair_loop loop;
        status = loop_make(loops, l, sides, parameters, points, spacing, noise, &loop, error);
        loop.way = way;
        loop.lines = way < POINTS;
        loop.has_corners = loop.has_corners && way == CURVES;
        if (status == BAT_OK)
            status = way > CURVES ? fit_loop(&loop, trim, error) : fit_area(&loop, trim, error);
        memory_pool_free(&loop.pool);
    }
    if (status == BAT_OK)
        scale_curves(sides, trim);
    else
        spline_trim_free(trim);
    return status;
}

bat_status fair_loops_make(const outline_loops *loops, const double sides[2], const double *parameters, size_t points,
                           const double *spacing, double noise, bat_spline_trim *trim, bat_error *error)
{
    bool crosses = true;
    bat_status status = BAT_OK;
    *trim = (bat_spline_trim){0};
    for (int way = loops->edges == BAT_SURFACE_EDGES_EXACT ? POINTS : CURVES; way < WAYS && status == BAT_OK && crosses;
         way++)
    {
        spline_trim_free(trim);
        status = fit_loops(loops, sides, parameters, points, spacing, noise, way, trim, error);
        if (status == BAT_OK)
            status = find_crossing(trim, &crosses, error);
    }
    if (status != BAT_OK)
        spline_trim_free(trim);
    return status;
}
