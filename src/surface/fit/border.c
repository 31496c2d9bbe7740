/// @file
/// Border curves of a fit; see loop.h.

#include "surface/fit/loop.h"

#include "base/error.h"

#include <string.h>

enum
{
    MIN_SIDE_POINTS = 6,   ///< fewest boundary points of a side
    SAMPLES_PER_POINT = 2, ///< samples of a side for each of its points
    POINTS_PER_SPAN = 2,   ///< of a border curve
    CURVE_DEGREE = 3,      ///< of a border curve
    CURVE_CORRECTIONS = 2, ///< rounds that move points along their curve
    CORNERS = 4
};

// Weights of edge samples, of those of rough loops, and of those before the first correction, relative to a point.
static const double SAMPLE_WEIGHT = 1;
static const double ROUGH_WEIGHT = 0.25;
static const double GUIDE_WEIGHT = 0.1;
// Mean distance of the edge of randomly scattered points from the curve, in units of the loop's roughness.
static const double OFFSET = 1.35;
// Loops with less roughness, in distances between their points, run along the edge.
static const double ROUGH = 0.08;
// Below this ratio of roughness to noise the two cannot be told apart.
static const double NOISE_RATIO = 0.75;

void fit_border_free(fit_border *border)
{
    for (int s = 0; s < FIT_BORDER_SIDES; s++)
        bat_spline_surface_free(&border->sides[s].curve);
    memory_pool_free(&border->pool);
    *border = (fit_border){0};
}

/// The parameter that varies along a side, and the value of the other one.
static size_t along_of(int side)
{
    return (size_t)side % 2;
}

static double level_of(int side)
{
    return side == 1 || side == 2 ? 1 : 0;
}

static bool is_on_side(const double *at, int side)
{
    return at[1 - along_of(side)] == level_of(side);
}

static void set_parameter(int side, double t, double *at)
{
    at[along_of(side)] = t;
    at[1 - along_of(side)] = level_of(side);
}

static bat_status gather_side(const bat_surface_fit_data *data, int number, fit_border *border, bat_error *error)
{
    size_t dimension = data->dimension;
    fit_border_side *side = &border->sides[number];
    side->points = memory_pool_array(&border->pool, data->boundary_count, dimension * sizeof *side->points);
    side->at = memory_pool_array(&border->pool, data->boundary_count, 2 * sizeof *side->at);
    bat_status status = memory_pool_check(&border->pool, error);
    for (size_t i = 0; i < data->boundary_count && status == BAT_OK; i++)
        if (is_on_side(data->parameters + 2 * i, number))
        {
            memcpy(side->points + side->count * dimension, data->points + i * dimension, dimension * sizeof(double));
            side->at[2 * side->count] = data->parameters[2 * i + along_of(number)];
            side->at[2 * side->count++ + 1] = 0;
        }
    return status;
}

/// Fit a curve to the points of a side, and move their parameters along it. The curve is a surface that is linear across;
/// with every point on both of its long sides it is constant across.
static bat_status fit_side(size_t dimension, const bat_surface_fit_options *options, fit_border_side *side, bat_error *error)
{
    size_t count = side->count;
    memory_pool pool = {0};
    double *points = memory_pool_array(&pool, count, 2 * dimension * sizeof *points);
    double *at = memory_pool_array(&pool, count, 4 * sizeof *at);
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
    {
        memcpy(points, side->points, count * dimension * sizeof *points);
        memcpy(points + count * dimension, side->points, count * dimension * sizeof *points);
        memcpy(at, side->at, 2 * count * sizeof *at);
        memcpy(at + 2 * count, side->at, 2 * count * sizeof *at);
        for (size_t i = 0; i < count; i++)
            at[2 * (count + i) + 1] = 1;
        bat_surface_fit_data data = {.points = points,
                                     .parameters = at,
                                     .count = 2 * count,
                                     .dimension = dimension,
                                     .boundary_count = 2 * count,
                                     .slides = true};
        bat_surface_fit_options curve = bat_surface_fit_defaults();
        curve.space.degree[0] = CURVE_DEGREE;
        curve.space.degree[1] = 1;
        curve.space.spans[0] = (count + POINTS_PER_SPAN - 1) / POINTS_PER_SPAN;
        curve.hold_out = 0;
        curve.iterations = 0;
        curve.final_corrections = CURVE_CORRECTIONS;
        curve.restarts = false;
        curve.robust = options->robust;
        curve.threads = options->threads;
        status = bat_surface_fit(&data, &curve, &side->curve, NULL, error);
        memcpy(side->at, at, 2 * count * sizeof *at);
    }
    memory_pool_free(&pool);
    return status;
}

static bat_status place_samples(fit_border *border, bat_error *error)
{
    size_t dimension = border->dimension, total = CORNERS;
    for (int s = 0; s < FIT_BORDER_SIDES; s++)
    {
        border->sides[s].first = total - CORNERS;
        border->sides[s].samples = SAMPLES_PER_POINT * border->sides[s].count - 1;
        total += border->sides[s].samples;
    }
    double *place = memory_pool_array(&border->pool, dimension, sizeof *place);
    border->points = memory_pool_zeros(&border->pool, total, dimension * sizeof *border->points);
    border->at = memory_pool_array(&border->pool, total, 2 * sizeof *border->at);
    border->foot = memory_pool_zeros(&border->pool, total, 2 * sizeof *border->foot);
    border->target = memory_pool_zeros(&border->pool, total, dimension * sizeof *border->target);
    bat_status status = memory_pool_check(&border->pool, error);
    border->samples = total;
    size_t corners = total - CORNERS;
    for (int s = 0; s < FIT_BORDER_SIDES && status == BAT_OK; s++)
    {
        fit_border_side *side = &border->sides[s];
        for (size_t k = 0; k < side->samples; k++)
        {
            double t = (double)(k + 1) / (double)(side->samples + 1);
            set_parameter(s, t, border->at + 2 * (side->first + k));
            border->foot[2 * (side->first + k)] = t;
        }
        status = bat_spline_surface_evaluate(&side->curve, border->foot + 2 * side->first, side->samples, 0,
                                             border->points + side->first * dimension, error);
        double ends[2][2] = {{0, 0}, {1, 0}};
        for (int e = 0; e < 2 && status == BAT_OK; e++)
        {
            // The corners are numbered by u + 2 v. Each is the mean of the ends of two curves.
            double corner[2];
            set_parameter(s, e, corner);
            size_t number = corners + (size_t)(corner[0] + 2 * corner[1]);
            status = bat_spline_surface_evaluate(&side->curve, ends[e], 1, 0, place, error);
            for (size_t d = 0; d < dimension && status == BAT_OK; d++)
                border->points[number * dimension + d] += 0.5 * place[d];
            memcpy(border->at + 2 * number, corner, sizeof corner);
        }
    }
    return status;
}

bat_status fit_border_make(const bat_surface_fit_data *data, const bat_surface_fit_options *options, fit_border *border,
                           bat_error *error)
{
    *border = (fit_border){.dimension = data->dimension, .boundary_count = data->boundary_count};
    border->side = memory_pool_array(&border->pool, data->boundary_count, sizeof *border->side);
    bat_status status = memory_pool_check(&border->pool, error);
    bool enough = true;
    for (size_t i = 0; i < data->boundary_count && status == BAT_OK; i++)
        for (int s = FIT_BORDER_SIDES - 1; s >= 0; s--)
            if (is_on_side(data->parameters + 2 * i, s))
                border->side[i] = (uint8_t)s;
    for (int s = 0; s < FIT_BORDER_SIDES && status == BAT_OK; s++)
    {
        status = gather_side(data, s, border, error);
        enough = enough && border->sides[s].count >= MIN_SIDE_POINTS;
    }
    for (int s = 0; s < FIT_BORDER_SIDES && status == BAT_OK && enough; s++)
        status = fit_side(data->dimension, options, &border->sides[s], error);
    if (status == BAT_OK && enough)
        status = place_samples(border, error);
    if (status != BAT_OK || !enough)
        fit_border_free(border);
    return status;
}

/// Rows of numbers from `own` on are samples, those from `guides` on guides.
static void set_samples(fit_points *points, size_t own, size_t guides)
{
    points->own = points->total = own;
    points->guides = guides;
    for (size_t row = 0; row < points->count; row++)
        if (points->number[row] >= guides)
            points->weight[row] = GUIDE_WEIGHT;
        else if (points->number[row] >= own)
        {
            points->freedom[row] = FIT_FIXED;
            points->weight[row] = ROUGH_WEIGHT;
        }
}

static double *append(double *to, const double *rows, size_t count, size_t width)
{
    if (count > 0)
        memcpy(to, rows, count * width * sizeof *to);
    return to + count * width;
}

bat_status fit_border_points(const fit_border *border, const fit_team *team, const bat_surface_fit_data *data,
                             const uint32_t *numbers, bool centred, fit_points *points, bat_error *error)
{
    size_t samples = border->samples, guides = numbers == NULL ? data->guide_count : 0, dimension = data->dimension;
    bat_surface_fit_data joined = *data;
    memory_pool pool = {0};
    bat_status status = BAT_OK;
    if (numbers == NULL && samples + guides > 0)
    {
        joined.count += samples + guides;
        double *all = memory_pool_array(&pool, joined.count, dimension * sizeof *all);
        joined.points = all;
        joined.parameters = memory_pool_array(&pool, joined.count, 2 * sizeof *joined.parameters);
        status = memory_pool_check(&pool, error);
        if (status == BAT_OK)
        {
            double *end = append(all, data->points, data->count, dimension);
            (void)append(append(end, border->points, samples, dimension), data->guides, guides, dimension);
            end = append(joined.parameters, data->parameters, data->count, 2);
            (void)append(append(end, border->at, samples, 2), data->guide_parameters, guides, 2);
        }
    }
    // Border curves make boundary points as free as others.
    if (samples > 0)
        joined.boundary_count = 0;
    if (status == BAT_OK)
        status = fit_points_make(team, &joined, numbers, centred, points, error);
    memory_pool_free(&pool);
    size_t own = numbers == NULL ? data->count : points->total - samples;
    if (status == BAT_OK && samples + guides > 0)
        set_samples(points, own, own + samples);
    return status;
}

/// A frame of the surface at a place of its border.
typedef struct border_frame
{
    double *values;           ///< S, S_u and S_v
    const double *place;      ///< S
    double *tangent, *across; ///< unit vectors along the side, and tangent to the surface, normal to the side, outwards
} border_frame;

/// Evaluate the frame of a side at a parameter. False where the surface has no tangent plane.
/// @param values  3 x dimension
static bool frame_at(const fit_nets *nets, int side, const double *at, double *scratch, double *values, border_frame *frame)
{
    size_t dimension = nets->dimension;
    fit_nets_evaluate(nets, bat_hierarchical_space_locate(nets->space, at[0], at[1]), at, 1, scratch, values);
    double *tangent = values + (size_t)(1 + along_of(side)) * dimension;
    double *across = values + (size_t)(2 - along_of(side)) * dimension;
    double sign = level_of(side) > 0 ? 1 : -1, length = sqrt(vector_dot(dimension, tangent, tangent));
    *frame = (border_frame){values, values, tangent, across};
    if (!(length > 0))
        return false;
    for (size_t d = 0; d < dimension; d++)
        tangent[d] /= length;
    double along = vector_dot(dimension, tangent, across);
    vector_add(dimension, -along, tangent, across);
    length = sqrt(vector_dot(dimension, across, across));
    if (!(length > 0))
        return false;
    vector_scale(dimension, sign / length, across);
    return true;
}

typedef struct border_update
{
    memory_pool pool;
    fit_border *border;
    const fit_nets *nets;
    const double *centre;
    double *scratch, *values; ///< for frame_at()
    double *feet;             ///< samples x dimension: places of the surface, later their feet on the curves
    double *distances;        ///< samples
} border_update;

/// The roughness of a loop: the part of its points' residuals that is tangent to the surface and normal to the border, less
/// noise, which is measured normal to both.
static bat_status measure_offset(const border_update *update, int number, bat_error *error)
{
    fit_border_side *side = &update->border->sides[number];
    size_t dimension = update->border->dimension;
    double *places = memory_array(side->count, dimension * sizeof *places), across = 0, normal = 0, length = 0;
    if (places == NULL)
        return error_memory(error, side->count * dimension * sizeof *places);
    bat_status status = bat_spline_surface_evaluate(&side->curve, side->at, side->count, 0, places, error);
    for (size_t i = 0; i < side->count && status == BAT_OK; i++)
    {
        border_frame frame;
        double at[2], *residual = places + i * dimension;
        const double *point = side->points + i * dimension;
        set_parameter(number, side->at[2 * i], at);
        vector_subtract(dimension, point, residual, residual);
        length += i > 0 ? vector_distance(dimension, point, point - dimension) : 0;
        if (!frame_at(update->nets, number, at, update->scratch, update->values, &frame))
            continue;
        double out = vector_dot(dimension, residual, frame.across), along = vector_dot(dimension, residual, frame.tangent);
        across += out * out;
        if (dimension > 2)
            normal +=
                fmax(vector_dot(dimension, residual, residual) - out * out - along * along, 0) / (double)(dimension - 2);
    }
    free(places);
    double count = (double)side->count, noise = sqrt(normal / count), rough = sqrt(fmax(across - normal, 0) / count);
    side->offset = rough > fmax(ROUGH * length / count, NOISE_RATIO * noise) ? OFFSET * rough : 0;
    return status;
}

static bat_status update_side(const border_update *update, int number, bat_error *error)
{
    fit_border *border = update->border;
    fit_border_side *side = &border->sides[number];
    size_t dimension = border->dimension, first = side->first;
    double *feet = update->feet + first * dimension;
    border_frame frame;
    for (size_t k = 0; k < side->samples; k++)
    {
        (void)frame_at(update->nets, number, border->at + 2 * (first + k), update->scratch, update->values, &frame);
        for (size_t d = 0; d < dimension; d++)
            feet[k * dimension + d] = frame.place[d] + update->centre[d];
    }
    bat_surface_fit_data data = {.points = feet,
                                 .parameters = border->foot + 2 * first,
                                 .count = side->samples,
                                 .dimension = dimension,
                                 .boundary_count = side->samples,
                                 .slides = true};
    bat_status status = spline_correct(&side->curve, &data, NULL, error);
    if (status == BAT_OK)
        status = bat_spline_surface_evaluate(&side->curve, data.parameters, side->samples, 0, feet, error);
    for (size_t k = 0; k < side->samples && status == BAT_OK; k++)
    {
        double *target = border->target + (first + k) * dimension, out = side->offset;
        bool has_frame =
            frame_at(update->nets, number, border->at + 2 * (first + k), update->scratch, update->values, &frame);
        for (size_t d = 0; d < dimension; d++)
        {
            feet[k * dimension + d] -= update->centre[d];
            out += has_frame ? frame.across[d] * (feet[k * dimension + d] - frame.place[d]) : 0;
        }
        // The curve of a rough loop lies inside the edge, where heights are others: the points alone determine these.
        for (size_t d = 0; d < dimension; d++)
            target[d] = has_frame && side->offset > 0 ? frame.place[d] + out * frame.across[d] : feet[k * dimension + d];
        update->distances[first + k] = has_frame ? fabs(out) : 0;
    }
    return status;
}

/// The targets of the corners: their places in the tangent plane, moved outwards of both sides.
static void update_corners(const border_update *update)
{
    fit_border *border = update->border;
    size_t dimension = border->dimension;
    for (size_t c = border->samples - CORNERS; c < border->samples; c++)
    {
        const double *at = border->at + 2 * c;
        double *target = border->target + c * dimension;
        border_frame frame;
        memset(target, 0, dimension * sizeof *target);
        for (int s = 0; s < FIT_BORDER_SIDES; s++)
        {
            if (!is_on_side(at, s) || !frame_at(update->nets, s, at, update->scratch, update->values, &frame))
                continue;
            double out = border->sides[s].offset, along = 0;
            for (size_t d = 0; d < dimension; d++)
            {
                double step = border->points[c * dimension + d] - update->centre[d] - frame.place[d];
                // Both sides span the same tangent plane: each gives half of the step in it.
                out += 0.5 * frame.across[d] * step;
                along += 0.5 * frame.tangent[d] * step;
            }
            for (size_t d = 0; d < dimension; d++)
                target[d] += out * frame.across[d] + along * frame.tangent[d];
        }
        update->distances[c] = sqrt(vector_square(dimension, target));
        vector_add(dimension, 1, update->values, target);
    }
}

/// The weight of a sample after an update.
static double weight_of_sample(const fit_border *border, size_t sample)
{
    for (int s = 0; s < FIT_BORDER_SIDES; s++)
    {
        const fit_border_side *side = &border->sides[s];
        bool is_corner = sample >= border->samples - CORNERS;
        bool is_here = is_corner ? is_on_side(border->at + 2 * sample, s)
                                 : sample >= side->first && sample - side->first < side->samples;
        if (is_here && side->offset > 0)
            return ROUGH_WEIGHT;
    }
    return SAMPLE_WEIGHT;
}

void fit_border_move(const fit_border *border, fit_points *points)
{
    size_t dimension = border->dimension;
    for (size_t row = 0; row < points->count; row++)
        if (points->number[row] >= points->own && points->number[row] < points->guides)
        {
            size_t sample = points->number[row] - points->own;
            memcpy(points->position + row * dimension, border->target + sample * dimension, dimension * sizeof(double));
            points->weight[row] = weight_of_sample(border, sample);
        }
}

bat_status fit_border_update(fit_border *border, const fit_nets *nets, fit_points *points, bat_error *error)
{
    size_t dimension = border->dimension, samples = border->samples;
    border_update update = {.border = border, .nets = nets, .centre = points->centre};
    update.scratch = memory_pool_array(&update.pool, fit_nets_scratch(nets), sizeof(double));
    update.values = memory_pool_array(&update.pool, 3 * dimension, sizeof(double));
    update.feet = memory_pool_array(&update.pool, samples, dimension * sizeof(double));
    update.distances = memory_pool_array(&update.pool, samples, sizeof(double));
    bat_status status = memory_pool_check(&update.pool, error);
    for (int s = 0; s < FIT_BORDER_SIDES && status == BAT_OK; s++)
    {
        status = measure_offset(&update, s, error);
        if (status == BAT_OK)
            status = update_side(&update, s, error);
    }
    if (status == BAT_OK)
        update_corners(&update);
    border->moved = border->moved || status == BAT_OK;
    if (status == BAT_OK)
        fit_border_move(border, points);
    for (size_t row = 0; row < points->count && status == BAT_OK; row++)
        if (points->number[row] >= points->own && points->number[row] < points->guides)
            points->distance[row] = update.distances[points->number[row] - points->own];
    memory_pool_free(&update.pool);
    return status;
}
