#include "curve/smooth.h"

#include "base/error.h"
#include "curve/corner.h"
#include "curve/polygon.h"
#include "curve/smooth_fit.h"
#include "curve/topology/draw_back.h"
#include "space/builtin.h"

#include <string.h>

static const int REACH = 8; ///< so many points beside a marked edge come back with it, by shares that fall evenly

/// Below this share a point goes back to where it was given.
static const double LEAST_SHARE = 1.0 / 16;

bat_status smooth_back_make(const bat_curve *given, smooth_back *back, bat_error *error)
{
    size_t n = given->count, row = given->space->point_dim * sizeof(double);
    *back = (smooth_back){.given = {.space = given->space, .count = n, .closed = given->closed}};
    back->given.points = memory_pool_array(&back->pool, n, row);
    back->smoothed = memory_pool_array(&back->pool, n, row);
    back->shares = memory_pool_array(&back->pool, n, sizeof(double));
    back->factors = memory_pool_array(&back->pool, n, sizeof(double));
    bat_status status = memory_pool_check(&back->pool, error);
    if (status == BAT_OK)
        memcpy(back->given.points, given->points, n * row);
    return status;
}

void smooth_back_free(smooth_back *back)
{
    memory_pool_free(&back->pool);
    *back = (smooth_back){0};
}

void smooth_back_begin(smooth_back *back, const double *points)
{
    memcpy(back->smoothed, points, back->given.count * back->given.space->point_dim * sizeof(double));
    for (size_t i = 0; i < back->given.count; i++)
        back->shares[i] = back->factors[i] = 1;
}

void smooth_back_mark(smooth_back *back, size_t edge)
{
    ptrdiff_t n = (ptrdiff_t)back->given.count;
    for (ptrdiff_t k = -REACH; k <= REACH + 1; k++)
    {
        ptrdiff_t i = (ptrdiff_t)edge + k, away = k > 0 ? k - 1 : -k;
        if (!back->given.closed && (i < 0 || i >= n))
            continue;
        double *factor = &back->factors[(i % n + n) % n];
        *factor = fmin(*factor, 0.5 + 0.5 * (double)away / (REACH + 1));
    }
    back->marked = true;
}

bat_status smooth_back_move(smooth_back *back, double *points, bool *moved)
{
    const bat_space *space = back->given.space;
    size_t dim = space->point_dim;
    for (size_t i = 0; i < back->given.count && back->marked; i++)
    {
        double share = back->shares[i] * back->factors[i], middle[BAT_SPACE_MAX_DIM];
        const double *from = back->given.points + i * dim, *to = back->smoothed + i * dim;
        back->factors[i] = 1;
        if (share == back->shares[i])
            continue;
        share = share < LEAST_SHARE ? 0 : share;
        back->shares[i] = share;
        bool stays = share == 0 || memcmp(from, to, dim * sizeof *to) == 0;
        bat_status status = stays ? BAT_OK : bat_space_geodesic(space, from, to, share, middle);
        if (status != BAT_OK)
            return status;
        memcpy(points + i * dim, stays ? from : middle, dim * sizeof *points);
        *moved = true;
    }
    back->marked = false;
    return BAT_OK;
}

enum
{
    /// The fewest points of a piece whose noise is told from its bends, of a border of pixels, and of one that can be
    /// smoothed, open and closed.
    MIN_ESTIMATED = 20,
    MIN_STAIR = 8,
    MIN_OPEN = 3,
    MIN_CLOSED = 5,
    MAX_PASSES = 30,
};

/// Moves below this share of the mean edge end the iteration in curved spaces.
static const double SETTLED = 1e-11;
/// A ring keeps waves of this share of its length, so that it does not shrink.
static const double RING_SHARE = 1.0 / 3;
/// From a scale of so many lengths of an open piece on, it is straight but for rounding.
static const double STRAIGHT = 1e3;
/// The least parameter interval in units of the mean one.
static const double MIN_STEP = 1e-3;
/// Borders of pixels: the scale in cells; the share of a cell by which vertices move to the middles of their edges, at most;
/// the share of the edges that are one cell long, at least; how near to multiples of a cell the lengths are.
static const double STAIR_SCALE = 8, STAIR_MOVE = 0.4, STAIR_SHARE = 0.25, STAIR_ROUNDING = 1e-3;

bool smooth_wanted(const bat_curve_refine_options *options)
{
    return options != NULL && options->smooth != 0; // NaN: by the noise
}

/// A curve between two corners or ends, or a whole ring, and its spline.
typedef struct smooth_piece
{
    const bat_space *space;
    size_t count, dim, tangent; ///< points; numbers of a point and of a tangent vector
    bool closed;
    double *given, *points; ///< the measurements, which own the memory, and the present points
    double *frames;         ///< count x dimension x tangent: orthonormal vectors, parallel along the points; null in R^n
    double *moves;          ///< count x dimension
    smooth_fit fit;
} smooth_piece;

static const double *point_of(const smooth_piece *p, size_t i)
{
    return p->points + i % p->count * p->dim;
}

static double *frame_of(const smooth_piece *p, size_t point, size_t k)
{
    return p->frames + (point * p->space->dimension + k) * p->tangent;
}

static size_t edges_of(const smooth_piece *p)
{
    return polygon_edges(p->count, p->closed);
}

/// A tangent vector by coordinate `k`: a unit vector, or in a space whose vectors have more numbers than its dimension the
/// way to the projection of a moved point. False where there is none.
static bool candidate(const smooth_piece *p, size_t k, double *vector)
{
    double moved[BAT_SPACE_MAX_DIM];
    memset(vector, 0, p->tangent * sizeof *vector);
    if (p->tangent == p->space->dimension)
    {
        vector[k] = 1;
        return true;
    }
    memcpy(moved, p->points, p->dim * sizeof *moved);
    moved[k] += 1;
    return p->space->project(p->space, moved, moved) == BAT_OK &&
           p->space->log(p->space, p->points, moved, vector) == BAT_OK;
}

/// An orthonormal basis at the first point, by Gram and Schmidt.
static bat_status make_basis(const smooth_piece *p, bat_error *error)
{
    static const double INDEPENDENT = 0.05;
    const bat_space *space = p->space;
    size_t found = 0, numbers = p->tangent == space->dimension ? p->tangent : p->dim;
    for (size_t k = 0; k < numbers && found < space->dimension; k++)
    {
        double *vector = frame_of(p, 0, found);
        if (!candidate(p, k, vector))
            continue;
        double before = sqrt(space->inner(space, p->points, vector, vector));
        for (size_t b = 0; b < found; b++)
        {
            double share = space->inner(space, p->points, vector, frame_of(p, 0, b));
            vector_add(p->tangent, -share, frame_of(p, 0, b), vector);
        }
        double length = sqrt(space->inner(space, p->points, vector, vector));
        if (!(length > INDEPENDENT * fmax(before, INDEPENDENT)))
            continue;
        for (size_t c = 0; c < p->tangent; c++)
            vector[c] /= length;
        found++;
    }
    return found == space->dimension
               ? BAT_OK
               : ERROR_UNSUPPORTED(error, 0, "smoothing finds no basis of the space '%s'", space->name);
}

/// The numbers of a tangent vector in the frame of its point.
static void to_frame(const smooth_piece *p, size_t point, const double *vector, double *numbers)
{
    if (p->frames == NULL)
        memcpy(numbers, vector, p->tangent * sizeof *numbers);
    for (size_t k = 0; p->frames != NULL && k < p->space->dimension; k++)
        numbers[k] = p->space->inner(p->space, point_of(p, point), vector, frame_of(p, point, k));
}

/// Turn the frames of a ring of a surface evenly, so that the last goes over to the first.
static bat_status close_frames(const smooth_piece *p, double *vector)
{
    size_t last = p->count - 1;
    double numbers[2] = {0};
    bat_status status = p->space->transport(p->space, point_of(p, last), p->points, frame_of(p, last, 0), vector);
    if (status != BAT_OK)
        return status;
    to_frame(p, 0, vector, numbers);
    double whole = atan2(numbers[1], numbers[0]);
    for (size_t i = 0; i < p->count; i++)
    {
        double angle = -whole * (double)i / (double)p->count, c = cos(angle), s = sin(angle);
        double *a = frame_of(p, i, 0), *b = frame_of(p, i, 1);
        for (size_t k = 0; k < p->tangent; k++)
        {
            double first = a[k];
            a[k] = c * first + s * b[k];
            b[k] = c * b[k] - s * first;
        }
    }
    return BAT_OK;
}

static bat_status make_frames(const smooth_piece *p, bat_error *error)
{
    const bat_space *space = p->space;
    double vector[BAT_SPACE_MAX_DIM];
    bat_status status = p->frames != NULL ? make_basis(p, error) : BAT_OK;
    if (status != BAT_OK || p->frames == NULL)
        return status;
    for (size_t i = 0; i + 1 < p->count && status == BAT_OK; i++)
        for (size_t k = 0; k < space->dimension && status == BAT_OK; k++)
            status = space->transport(space, point_of(p, i), point_of(p, i + 1), frame_of(p, i, k), frame_of(p, i + 1, k));
    if (status == BAT_OK && p->closed)
        status = close_frames(p, vector);
    return status == BAT_OK ? BAT_OK
                            : error_set(error, status, BAT_NO_INDEX, 0, "smoothing fails: neighbours are too far apart");
}

/// Develop the points and the measurements into R^n.
static bat_status develop(smooth_piece *p, bat_error *error)
{
    const bat_space *space = p->space;
    double vector[BAT_SPACE_MAX_DIM];
    bat_status status = make_frames(p, error);
    for (size_t i = 0; i < p->count && status == BAT_OK; i++)
    {
        size_t row = i * space->dimension;
        status = space->log(space, point_of(p, i), p->given + i * p->dim, vector);
        to_frame(p, i, vector, p->fit.residuals + row);
        if (status == BAT_OK && (p->closed || i + 1 < p->count))
        {
            status = space->log(space, point_of(p, i), point_of(p, i + 1), vector);
            to_frame(p, i, vector, p->fit.ahead + row);
        }
        if (status == BAT_OK && (p->closed || i > 0))
        {
            status = space->log(space, point_of(p, i), point_of(p, i + p->count - 1), vector);
            to_frame(p, i, vector, p->fit.behind + row);
        }
        if (status != BAT_OK)
            return error_set(error, status, i, 0, "smoothing fails at point %zu: it is too far from its neighbours", i);
    }
    return status;
}

/// Move the points along their moves. `*largest` receives the longest.
static bat_status move(const smooth_piece *p, double *largest, bat_error *error)
{
    const bat_space *space = p->space;
    *largest = 0;
    for (size_t i = 0; i < p->count; i++)
    {
        double vector[BAT_SPACE_MAX_DIM], moved[BAT_SPACE_MAX_DIM], square = 0;
        memset(vector, 0, p->tangent * sizeof *vector);
        for (size_t k = 0; k < space->dimension; k++)
        {
            double share = p->moves[i * space->dimension + k];
            square += share * share;
            if (p->frames == NULL)
                vector[k] = share;
            for (size_t c = 0; p->frames != NULL && c < p->tangent; c++)
                vector[c] += share * frame_of(p, i, k)[c];
        }
        if (!(square > 0))
            continue;
        bat_status status = space->exp(space, point_of(p, i), vector, moved);
        if (status != BAT_OK)
            return error_set(error, status, i, 0, "smoothing takes point %zu out of the space", i);
        memcpy(p->points + i * p->dim, moved, p->dim * sizeof *moved);
        *largest = fmax(*largest, sqrt(square));
    }
    return BAT_OK;
}

/// The weight by a length: waves of that length keep half of their height. Points count by the lengths beside them.
static void weigh_by_scale(smooth_piece *p, double scale)
{
    smooth_fit *fit = &p->fit;
    size_t edges = edges_of(p);
    double whole = 0;
    for (size_t e = 0; e < edges; e++)
    {
        fit->steps[e] = p->space->distance(p->space, point_of(p, e), point_of(p, e + 1));
        whole += fit->steps[e];
    }
    double mean = whole / (double)edges;
    for (size_t e = 0; e < edges; e++)
        fit->steps[e] = fmax(fit->steps[e] / mean, MIN_STEP);
    for (size_t i = 0; i < p->count; i++)
        if (fit->slacks[i] > 0)
            fit->slacks[i] = 2 / (fit->steps[i == 0 ? p->count - 1 : i - 1] + fit->steps[i]);
    double length = fmin(scale, (p->closed ? RING_SHARE : STRAIGHT) * whole);
    fit->weight = pow(length / (ANGLE_TURN * mean), 4);
}

// Borders of pixels

/// The coordinates in which pixels are squares: those of the plane, or longitude and latitude.
static void grid_place(const smooth_piece *p, size_t i, double place[2])
{
    const double *point = p->given + i % p->count * p->dim;
    bool globe = p->dim == 3;
    place[0] = globe ? atan2(point[1], point[0]) : point[0];
    place[1] = globe ? atan2(point[2], hypot(point[0], point[1])) : point[1];
}

/// Whether the edges run along two axes in multiples of a cell. `*cell` receives its size as a distance.
static bool is_stair(const smooth_piece *p, double *cell)
{
    double cells[2] = {INFINITY, INFINITY}, here[2], next[2];
    size_t edges = edges_of(p), single = 0;
    *cell = INFINITY;
    for (int pass = 0; pass < 2; pass++)
        for (size_t e = 0; e < edges; e++)
        {
            grid_place(p, e, here);
            grid_place(p, e + 1, next);
            double lengths[2] = {fabs(next[0] - here[0]), fabs(next[1] - here[1])};
            int axis = lengths[1] > lengths[0];
            if (!(lengths[1 - axis] <= STAIR_ROUNDING * lengths[axis]))
                return false;
            if (pass == 0)
            {
                cells[axis] = fmin(cells[axis], lengths[axis]);
                *cell = fmin(*cell, p->space->distance(p->space, point_of(p, e), point_of(p, e + 1)));
                continue;
            }
            double multiple = lengths[axis] / cells[axis];
            if (fabs(multiple - rint(multiple)) > STAIR_ROUNDING * multiple)
                return false;
            single += rint(multiple) == 1;
        }
    return isfinite(cells[0]) && isfinite(cells[1]) && (double)single >= STAIR_SHARE * (double)edges;
}

/// Whether the run from a vertex to its neighbour on `side`, 1 or -1, ends with a step back: the border is farthest out.
static bool is_summit(const smooth_piece *p, size_t i, ptrdiff_t side)
{
    double places[4][2], product = 0;
    for (ptrdiff_t k = 0; k < 4; k++)
        grid_place(p, (size_t)((ptrdiff_t)(i + 2 * p->count) + side * (k - 1)), places[k]);
    for (int c = 0; c < 2; c++)
        product += (places[1][c] - places[0][c]) * (places[3][c] - places[2][c]);
    return product < 0;
}

/// Move the vertices of a stair towards the middles of their shorter edges, where the borders cross, up to half a cell.
static bat_status climb(smooth_piece *p, double cell, bat_error *error)
{
    const bat_space *space = p->space;
    for (size_t i = 0; i < p->count; i++)
    {
        if (p->fit.slacks[i] == 0)
            continue;
        const double *here = p->given + i * p->dim;
        const double *sides[2] = {p->given + (i + p->count - 1) % p->count * p->dim, p->given + (i + 1) % p->count * p->dim};
        double lengths[2] = {space->distance(space, here, sides[0]), space->distance(space, here, sides[1])};
        int shorter = lengths[1] < lengths[0];
        double nearer = lengths[shorter], way = fmin(STAIR_MOVE * cell, nearer / 2);
        bool both = lengths[1 - shorter] < 1.5 * nearer;
        if (both || is_summit(p, i, shorter == 0 ? 1 : -1))
            way /= 2;
        double middle[BAT_SPACE_MAX_DIM], *target = p->points + i * p->dim;
        bat_status status = bat_space_geodesic(space, here, sides[shorter], way / nearer, middle);
        if (status == BAT_OK && both)
            status = bat_space_geodesic(space, middle, sides[1 - shorter], way / lengths[1 - shorter], target);
        else
            memcpy(target, middle, p->dim * sizeof *target);
        if (status != BAT_OK)
            return error_set(error, status, i, 0, "smoothing fails at point %zu", i);
    }
    memcpy(p->given, p->points, p->count * p->dim * sizeof(double));
    return BAT_OK;
}

// Pieces

/// Smooth the points of a piece; `*noise` receives the estimate.
static bat_status fit_piece(smooth_piece *p, double scale, double *noise, bat_error *error)
{
    double cell, largest = 0, mean = 0;
    bat_status status = BAT_OK;
    bool automatic = isnan(scale), surface = space_is_plane(p->space) || space_is_sphere(p->space);
    if (automatic && surface && is_stair(p, &cell))
    {
        *noise = cell / sqrt(12);
        scale = STAIR_SCALE * cell;
        status = climb(p, cell, error);
    }
    else if (automatic && p->count < MIN_ESTIMATED)
        return BAT_OK;
    if (!isnan(scale))
        weigh_by_scale(p, scale);
    for (size_t e = 0; e < edges_of(p); e++)
        mean += p->space->distance(p->space, point_of(p, e), point_of(p, e + 1)) / (double)edges_of(p);
    for (int pass = 0; pass < MAX_PASSES && status == BAT_OK; pass++)
    {
        status = develop(p, error);
        if (status == BAT_OK && pass == 0 && isnan(scale))
        {
            smooth_fit_choose(&p->fit);
            *noise = p->fit.weight > 0 ? p->fit.noise : 0;
        }
        if (status != BAT_OK || !(p->fit.weight > 0))
            break;
        smooth_fit_moves(&p->fit, p->moves);
        status = move(p, &largest, error);
        if (p->frames == NULL || largest <= SETTLED * mean)
            break;
    }
    return status;
}

static bat_status make_piece(smooth_piece *p, bat_error *error)
{
    size_t n = p->space->dimension, frame = space_is_euclidean(p->space) ? 0 : n * p->tangent;
    bat_status status = smooth_fit_make(p->count, n, p->closed, &p->fit, error);
    if (array_make(&p->given, p->count, (2 * p->dim + n + frame) * sizeof(double), error) != BAT_OK)
        return BAT_NO_MEMORY;
    p->points = p->given + p->count * p->dim;
    p->moves = p->points + p->count * p->dim;
    p->frames = frame > 0 ? p->moves + p->count * n : NULL;
    return status;
}

/// Smooth `count` points from point `first` on. `*squares` receives the noise squared times their number.
static bat_status smooth_part(const bat_curve *curve, double scale, size_t first, size_t count, bool closed, double *points,
                              double *squares, bat_error *error)
{
    const bat_space *space = curve->space;
    size_t dim = space->point_dim, row = dim * sizeof(double), least = closed ? MIN_CLOSED : MIN_OPEN;
    if (count < least || (isnan(scale) && count < MIN_STAIR))
        return BAT_OK;
    int curvature;
    if (closed && !space_is_euclidean(space) && !space_is_surface(space, &curvature))
        return ERROR_UNSUPPORTED(error, 0, "closed curves of the space '%s' cannot be smoothed", space->name);
    double noise = 0;
    smooth_piece piece = {.space = space, .count = count, .dim = dim, .tangent = space->tangent_dim, .closed = closed};
    bat_status status = make_piece(&piece, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        memcpy(piece.given + i * dim, curve->points + (first + i) % curve->count * dim, row);
    if (status == BAT_OK)
    {
        memcpy(piece.points, piece.given, count * row);
        status = fit_piece(&piece, scale, &noise, error);
    }
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        if (piece.fit.slacks[i] > 0)
            memcpy(points + (first + i) % curve->count * dim, piece.points + i * dim, row);
    *squares += noise * noise * (double)count;
    free(piece.given);
    smooth_fit_free(&piece.fit);
    return status;
}

bat_status smooth_points(const bat_curve *curve, double scale, const unsigned char *corners, double *points, double *noise,
                         bat_error *error)
{
    size_t n = curve->count, edges = polygon_edges(n, curve->closed), first = 0;
    double squares = 0;
    bat_status status = BAT_OK;
    memcpy(points, curve->points, n * curve->space->point_dim * sizeof(double));
    while (curve->closed && first < n && (corners == NULL || corners[first] == 0))
        first++;
    if (first == n)
        status = smooth_part(curve, scale, 0, n, true, points, &squares, error);
    for (size_t edge = 0; edge < edges && first < n && status == BAT_OK;)
    {
        size_t length = 1;
        while (edge + length < edges && (corners == NULL || corners[(first + edge + length) % n] == 0))
            length++;
        status = smooth_part(curve, scale, first + edge, length + 1, false, points, &squares, error);
        edge += length;
    }
    *noise = sqrt(squares / (double)n);
    return status;
}

// Curves

void smooth_report_add(bat_curve_refine_report *sum, const bat_curve_refine_report *one)
{
    double all = (double)(sum->smoothed + one->smoothed);
    if (one->smoothed == 0)
        return;
    double share = (double)one->smoothed / all;
    sum->mean_move += share * (one->mean_move - sum->mean_move);
    sum->noise = sqrt((1 - share) * sum->noise * sum->noise + share * one->noise * one->noise);
    sum->largest_move = fmax(sum->largest_move, one->largest_move);
    sum->smoothed += one->smoothed;
}

void smooth_report(const bat_curve *given, const double *points, double noise, bat_curve_refine_report *report)
{
    bat_curve_refine_report one = {.smoothed = given->count, .noise = noise};
    for (size_t i = 0; i < given->count; i++)
    {
        size_t at = i * given->space->point_dim;
        double way = given->space->distance(given->space, given->points + at, points + at);
        one.largest_move = fmax(one.largest_move, way);
        one.mean_move += way / (double)given->count;
    }
    smooth_report_add(report, &one);
}

static bool mark_pair(void *context, edge_place first, edge_place second)
{
    smooth_back_mark(context, first.edge);
    smooth_back_mark(context, second.edge);
    return true;
}

/// Draw a curve back until it is simple, where the given one is and the options ask for it.
static bat_status stay_simple(const bat_curve *given, const bat_curve_refine_options *options, bat_curve *smooth,
                              bat_error *error)
{
    bat_curve_refine_options how = *options;
    how.levels = 1;
    bool moved = false;
    smooth_back back = {.marked = false};
    if (!wants_simple(given, &how))
        return BAT_OK;
    bat_status status = curve_edges_are_apart(given, &moved, error);
    if (status == BAT_OK && moved)
        status = smooth_back_make(given, &back, error);
    if (status == BAT_OK && moved)
        smooth_back_begin(&back, smooth->points);
    while (status == BAT_OK && moved)
    {
        status = edge_pairs_find(smooth, 1, 0, EDGE_PAIRS_SAME_CURVE, 1, mark_pair, &back, error);
        moved = false;
        if (status == BAT_OK)
            status = smooth_back_move(&back, smooth->points, &moved);
    }
    smooth_back_free(&back);
    return status;
}

bat_status smooth_curve(const bat_curve *curve, const bat_curve_refine_options *options, bat_curve *smooth,
                        bat_curve_refine_report *report, bat_error *error)
{
    *smooth = (bat_curve){.space = curve->space};
    *report = (bat_curve_refine_report){0};
    bat_status status = bat_options_check(&bat_curve_refine_fields, options, error);
    if (status == BAT_OK)
        status = bat_curve_check(curve, error);
    if (status != BAT_OK)
        return status;
    size_t n = curve->count, channels = curve->channel_count, corners = 0;
    bat_curve_refine_options how = *options;
    if (how.scheme.kind == BAT_CURVE_SCHEME_KIND_AUTO)
        how.scheme = bat_curve_scheme_for(curve->space, NULL);
    bool cut = corners_wanted(curve, &how);
    bat_curve result;
    double noise;
    status = curve_room(curve, n, cut, &result, error);
    if (status == BAT_OK && channels > 0)
        memcpy(result.channels, curve->channels, n * channels * sizeof(double));
    if (status == BAT_OK && cut)
        status = corners_find(curve, &how, result.corners, &corners, error);
    if (status == BAT_OK)
        status = smooth_points(curve, options->smooth, result.corners, result.points, &noise, error);
    if (status == BAT_OK)
        status = stay_simple(curve, options, &result, error);
    if (status != BAT_OK)
    {
        bat_curve_free(&result);
        return status;
    }
    smooth_report(curve, result.points, noise, report);
    *smooth = result;
    return BAT_OK;
}
