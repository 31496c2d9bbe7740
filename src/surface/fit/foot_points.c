/// @file
/// Distances and foot points; see points.h.
///
/// For f(u) = 1/2 |S(u) - x|^2 with d = S(u) - x, Newton's method uses
///     f_i = d . S_i,   f_ij = S_i . S_j + d . S_ij   (full);   S_i . S_j alone is the Gauss-Newton matrix (gauss).
/// Hoschek, "Intrinsic parametrization for approximation" (1988), introduced the correction of parameters in this way.

#include "base/counting_sort.h"
#include "search/nearest.h"
#include "surface/fit/points.h"

#include "base/error.h"
#include "base/threads.h"

bat_status fit_nets_make(const bat_hierarchical_space *space, const double *control, size_t dimension, int threads,
                         fit_nets *nets, bat_error *error)
{
    size_t cells = bat_hierarchical_space_cells(space), stride = hierarchical_locals(space) * dimension, numbers;
    *nets = (fit_nets){.space = space, .dimension = dimension, .stride = stride};
    if (size_multiply_overflows(cells, stride, &numbers))
        return error_memory(error, SIZE_MAX);
    if (array_make(&nets->control, numbers, sizeof *nets->control, error) != BAT_OK)
        return BAT_NO_MEMORY;
    // An estimate that assumes as many coarser functions as local ones on every cell.
    double operations = (double)cells * (double)(hierarchical_locals(space) * stride);
#pragma omp parallel for schedule(static) num_threads(threads_worth(threads, cells, operations))
    for (size_t c = 0; c < cells; c++)
        hierarchical_local_control(space, &space->cells[c], control, dimension, nets->control + c * stride);
    return BAT_OK;
}

void fit_nets_free(fit_nets *nets)
{
    free(nets->control);
    *nets = (fit_nets){0};
}

/// What is done at a point; returns what is counted of it.
typedef size_t foot_visit(const fit_nets *nets, fit_points *points, size_t row, const void *context, double *scratch);

/// Visit the points that are here, on several threads, and count. Each needs derivatives up to an order.
static bat_status visit_points(const fit_nets *nets, fit_points *points, foot_visit *visit, const void *context,
                               int derivatives, int threads, uint64_t *total, bat_error *error)
{
    size_t scratch_size = fit_nets_scratch(nets) + 6 * nets->dimension, count = 0;
    double operations = (double)points->count * fit_nets_operations(nets, derivatives);
    bool ok = true;
#pragma omp parallel num_threads(threads_worth(threads, points->count, operations)) reduction(&& : ok) reduction(+ : count)
    {
        double *scratch = memory_array(scratch_size, sizeof *scratch);
        ok = scratch != NULL;
#pragma omp for schedule(dynamic, 256)
        for (size_t row = 0; row < points->count; row++)
            if (scratch != NULL)
                count += visit(nets, points, row, context, scratch);
        free(scratch);
    }
    *total = count;
    return ok ? BAT_OK : error_memory(error, scratch_size * sizeof(double));
}

static size_t measure_point(const fit_nets *nets, fit_points *points, size_t row, const void *context BAT_UNUSED,
                            double *scratch)
{
    double *value = scratch + fit_nets_scratch(nets);
    fit_nets_evaluate(nets, points->cell[row], points->parameter + 2 * row, 0, scratch, value);
    points->distance[row] = vector_distance(nets->dimension, points->position + row * nets->dimension, value);
    return 1;
}

bat_status fit_nets_measure(const fit_nets *nets, fit_points *points, int threads, bat_error *error)
{
    uint64_t measured;
    return visit_points(nets, points, measure_point, NULL, 0, threads, &measured, error);
}

enum
{
    MAX_STEPS = 50,
    MAX_HALVINGS = 10,
    MAX_WRONG_FEET = 64 ///< maximum number of points that restart in one call
};

// Maximum step length in either direction, in cells.
static const double MAX_STEP = 1;
// A matrix is treated as singular when its determinant is below this fraction of the product of its diagonal.
static const double MIN_DETERMINANT = 1e-10;

// A foot counts as possibly wrong when its distance exceeds this multiple of the mean distance.
static const double WRONG_FOOT_RATIO = 10;

fit_correction fit_correction_full(void)
{
    return (fit_correction){.steps = MAX_STEPS, .tolerance = 4 * DBL_EPSILON};
}

/// A parameter, and the derivatives of half the squared distance there.
typedef struct foot_point
{
    double at[2];
    size_t cell;
    double square;      ///< squared distance to the point
    double gradient[2]; ///< gradient of half the squared distance
    double full[3];     ///< its second derivatives uu, uv, vv
    double gauss[3];    ///< the Gauss-Newton approximation of these
} foot_point;

static void foot_measure(const fit_nets *nets, const double *position, double *scratch, foot_point *foot)
{
    size_t dimension = nets->dimension;
    double *value = scratch + fit_nets_scratch(nets);
    fit_nets_evaluate(nets, foot->cell, foot->at, 2, scratch, value);
    const double *du = value + dimension, *dv = du + dimension, *duu = dv + dimension, *duv = duu + dimension,
                 *dvv = duv + dimension;
    double square = 0, gradient[2] = {0, 0}, second[3] = {0, 0, 0}, gauss[3] = {0, 0, 0};
    for (size_t k = 0; k < dimension; k++)
    {
        double difference = value[k] - position[k];
        square += difference * difference;
        gradient[0] += difference * du[k];
        gradient[1] += difference * dv[k];
        second[0] += difference * duu[k];
        second[1] += difference * duv[k];
        second[2] += difference * dvv[k];
        gauss[0] += du[k] * du[k];
        gauss[1] += du[k] * dv[k];
        gauss[2] += dv[k] * dv[k];
    }
    foot->square = square;
    memcpy(foot->gradient, gradient, sizeof gradient);
    memcpy(foot->gauss, gauss, sizeof gauss);
    for (int k = 0; k < 3; k++)
        foot->full[k] = gauss[k] + second[k];
}

/// The admissible box of a parameter.
typedef struct foot_limits
{
    double low[2], high[2];
} foot_limits;

static const foot_limits UNIT_SQUARE = {{0, 0}, {1, 1}};

/// Whether a parameter may move against the gradient: its range is not empty, and it does not press against an active bound.
static bool may_move(const foot_point *foot, const foot_limits *limits, int direction)
{
    double low = limits->low[direction], high = limits->high[direction];
    bool pressed = (foot->at[direction] <= low && foot->gradient[direction] > 0) ||
                   (foot->at[direction] >= high && foot->gradient[direction] < 0);
    return high > low && !pressed;
}

static bool solve_both(const double *matrix, const double *gradient, double *step)
{
    double determinant = matrix[0] * matrix[2] - matrix[1] * matrix[1];
    if (!(matrix[0] > 0 && matrix[2] > 0 && determinant > MIN_DETERMINANT * matrix[0] * matrix[2]))
        return false;
    step[0] = (matrix[1] * gradient[1] - matrix[2] * gradient[0]) / determinant;
    step[1] = (matrix[1] * gradient[0] - matrix[0] * gradient[1]) / determinant;
    return true;
}

static void choose_step(const foot_point *foot, const foot_limits *limits, double *step)
{
    bool moves[2] = {may_move(foot, limits, 0), may_move(foot, limits, 1)};
    if (moves[0] && moves[1] &&
        (solve_both(foot->full, foot->gradient, step) || solve_both(foot->gauss, foot->gradient, step)))
        return;
    // In one direction: a Newton step where the squared distance is convex, else a Gauss-Newton step.
    for (int k = 0; k < 2; k++)
    {
        double curvature = foot->full[2 * k] > 0 ? foot->full[2 * k] : foot->gauss[2 * k];
        step[k] = moves[k] && curvature > 0 ? -foot->gradient[k] / curvature : 0;
    }
}

/// Shorten a step to at most MAX_STEP cells, within which the quadratic model is reliable.
/// @return its length in cells
static double limit_step(const fit_nets *nets, const foot_point *foot, double *step)
{
    uint32_t level = nets->space->cells[foot->cell].level;
    double length = 0;
    for (int k = 0; k < 2; k++)
        length = fmax(length, fabs(step[k]) * (double)hierarchical_spans(nets->space, level, k));
    if (length <= MAX_STEP)
        return length;
    vector_scale(2, MAX_STEP / length, step);
    return MAX_STEP;
}

/// Line search: halve the step until the distance decreases. False when it never does.
static bool line_search(const fit_nets *nets, const double *position, const foot_limits *limits, const double *step,
                        double *scratch, foot_point *now)
{
    foot_point next;
    double share = 1;
    for (int k = 0; k < MAX_HALVINGS; k++, share *= 0.5)
    {
        for (int d = 0; d < 2; d++)
            next.at[d] = fmin(fmax(now->at[d] + share * step[d], limits->low[d]), limits->high[d]);
        if (next.at[0] == now->at[0] && next.at[1] == now->at[1])
            return false;
        next.cell = bat_hierarchical_space_locate(nets->space, next.at[0], next.at[1]);
        foot_measure(nets, position, scratch, &next);
        if (next.square < now->square)
        {
            *now = next;
            return true;
        }
    }
    return false;
}

/// Run Newton's method from a parameter at which foot_measure() was called.
static void descend(const fit_nets *nets, const double *position, const foot_limits *limits, fit_correction correction,
                    double *scratch, foot_point *now)
{
    for (int k = 0; k < correction.steps; k++)
    {
        double step[2];
        choose_step(now, limits, step);
        double length = limit_step(nets, now, step);
        if (length <= correction.tolerance || !line_search(nets, position, limits, step, scratch, now))
            return;
    }
}

/// Store a foot in row `row`. Returns whether the parameter changed.
static bool store_foot(fit_points *points, size_t row, const foot_point *found)
{
    double *at = points->parameter + 2 * row;
    bool moved = found->at[0] != at[0] || found->at[1] != at[1];
    memcpy(at, found->at, sizeof found->at);
    points->cell[row] = (uint32_t)found->cell;
    points->distance[row] = sqrt(found->square);
    return moved;
}

/// The box of a parameter: the square, or one place, or half way to the corners of its side for one that slides.
static foot_limits limits_of(const fit_points *points, size_t row)
{
    const double *at = points->parameter + 2 * row;
    fit_freedom freedom = (fit_freedom)points->freedom[row];
    if (freedom == FIT_FREE)
        return UNIT_SQUARE;
    foot_limits limits = {{at[0], at[1]}, {at[0], at[1]}};
    if (freedom != FIT_FIXED)
    {
        int along = freedom == FIT_ALONG_U ? 0 : 1;
        limits.low[along] = 0.5 * at[along];
        limits.high[along] = 0.5 * (1 + at[along]);
    }
    return limits;
}

/// Whether a point is so near that its foot is of the same place: at most `reach` times the cell's shorter side.
static bool is_near(const fit_nets *nets, const foot_point *foot, double reach)
{
    uint32_t level = nets->space->cells[foot->cell].level;
    double side = INFINITY;
    for (int k = 0; k < 2; k++)
        side = fmin(side, sqrt(foot->gauss[2 * k]) / (double)hierarchical_spans(nets->space, level, k));
    return foot->square <= reach * reach * side * side;
}

/// The free points with the largest distances, if above WRONG_FOOT_RATIO times the mean, in descending order.
/// @return their number, at most MAX_WRONG_FEET
static size_t find_wrong_feet(const fit_points *points, double mean, scored *outlying)
{
    size_t count = 0;
    for (size_t row = 0; row < points->count; row++)
        if (points->freedom[row] == FIT_FREE && points->distance[row] > WRONG_FOOT_RATIO * mean)
        {
            if (count == 2 * MAX_WRONG_FEET)
            {
                qsort(outlying, count, sizeof *outlying, larger_first);
                count = MAX_WRONG_FEET;
            }
            outlying[count++] = (scored){points->distance[row], row};
        }
    qsort(outlying, count, sizeof *outlying, larger_first);
    return count < MAX_WRONG_FEET ? count : MAX_WRONG_FEET;
}

/// The points that restart, the same in all processes. Rows count the points of all of them.
typedef struct wrong_feet
{
    memory_pool pool;
    size_t count;
    scored outlying[2 * MAX_WRONG_FEET];
    size_t width;   ///< numbers of a point: coordinates, then the parameter
    double *points; ///< MAX_WRONG_FEET x width
    double *starts; ///< MAX_WRONG_FEET x 2: parameters to start from
} wrong_feet;

/// Keep the worst points of all processes.
static bat_status merge_wrong_feet(const fit_points *points, wrong_feet *wrong, bat_error *error)
{
    const fit_team *team = points->team;
    size_t *sizes, bytes = 0;
    char *all;
    bat_status status = team_gather(team, wrong->outlying, wrong->count * sizeof(scored), &sizes, &all, error);
    if (status == BAT_OK && team_is_first(team))
    {
        for (size_t rank = 0; rank < team_count(team); rank++)
            bytes += sizes[rank];
        scored *found = (scored *)(void *)all;
        wrong->count = bytes / sizeof *found;
        qsort(found, wrong->count, sizeof *found, larger_first);
        wrong->count = wrong->count < MAX_WRONG_FEET ? wrong->count : MAX_WRONG_FEET;
        memcpy(wrong->outlying, found, wrong->count * sizeof *found);
    }
    free(sizes);
    free(all);
    if (status == BAT_OK)
        status = team_broadcast(team, &wrong->count, sizeof wrong->count, error);
    return status == BAT_OK ? team_broadcast(team, wrong->outlying, wrong->count * sizeof(scored), error) : status;
}

/// Whether a row of all points is here; `row` becomes its place.
static bool is_here(const fit_points *points, size_t *row)
{
    bool here = *row >= points->before && *row - points->before < points->count;
    *row -= here ? points->before : 0;
    return here;
}

/// Tell all processes the points that restart. One process has each; the others add zeros.
static bat_status share_wrong_feet(const fit_points *points, wrong_feet *wrong, bat_error *error)
{
    size_t numbers = MAX_WRONG_FEET * wrong->width;
    double *own = calloc(numbers, sizeof *own);
    if (own == NULL)
        return error_memory(error, numbers * sizeof *own);
    for (size_t k = 0; k < wrong->count; k++)
    {
        size_t row = wrong->outlying[k].index;
        if (!is_here(points, &row))
            continue;
        memcpy(own + k * wrong->width, points->position + row * points->dimension, points->dimension * sizeof *own);
        memcpy(own + k * wrong->width + points->dimension, points->parameter + 2 * row, 2 * sizeof *own);
    }
    bat_status status = fit_sum_rows(points->team, own, 1, numbers, wrong->points, error);
    free(own);
    return status;
}

/// A point near one that restarts.
typedef struct near_point
{
    double square;
    size_t row; ///< among all points
    double at[2];
} near_point;

/// The nearest point in space that is here and whose own distance is at most the mean.
static near_point nearest_with_foot(const fit_points *points, const double *position, size_t row, double mean)
{
    size_t dimension = points->dimension;
    near_point nearest = {.square = INFINITY, .row = SIZE_MAX};
    for (size_t other = 0; other < points->count; other++)
    {
        double square = point_squared(points->position + other * dimension, position, dimension, 1);
        if (square < nearest.square && points->before + other != row && points->distance[other] <= mean)
            nearest = (near_point){
                square, points->before + other, {points->parameter[2 * other], points->parameter[2 * other + 1]}};
    }
    return nearest;
}

/// Find the parameters to start from: those of the nearest points of all processes, or their own.
static bat_status find_starts(const fit_points *points, wrong_feet *wrong, double mean, int threads, bat_error *error)
{
    near_point nearest[MAX_WRONG_FEET];
    size_t *sizes, ranks = team_count(points->team);
    char *all;
    double operations = (double)wrong->count * (double)points->count * 2 * (double)points->dimension;
#pragma omp parallel for schedule(dynamic) num_threads(threads_worth(threads, wrong->count, operations))
    for (size_t k = 0; k < wrong->count; k++)
        nearest[k] = nearest_with_foot(points, wrong->points + k * wrong->width, wrong->outlying[k].index, mean);
    bat_status status = team_gather(points->team, nearest, wrong->count * sizeof *nearest, &sizes, &all, error);
    const near_point *found = (const near_point *)(void *)all;
    for (size_t k = 0; status == BAT_OK && found != NULL && k < wrong->count; k++)
    {
        near_point best = {.square = INFINITY, .row = SIZE_MAX};
        memcpy(best.at, wrong->points + k * wrong->width + points->dimension, sizeof best.at);
        for (size_t rank = 0; rank < ranks; rank++)
            if (found[rank * wrong->count + k].square < best.square)
                best = found[rank * wrong->count + k];
        memcpy(wrong->starts + 2 * k, best.at, sizeof best.at);
    }
    free(sizes);
    free(all);
    return status == BAT_OK ? team_broadcast(points->team, wrong->starts, 2 * wrong->count * sizeof *wrong->starts, error)
                            : status;
}

/// Search from the new starts for the feet of the points that are here.
static bat_status restart_feet(const fit_nets *nets, fit_points *points, const wrong_feet *wrong, fit_correction correction,
                               uint64_t *moved, bat_error *error)
{
    size_t scratch_size = fit_nets_scratch(nets) + 6 * nets->dimension;
    double *scratch = memory_array(scratch_size, sizeof *scratch);
    if (scratch == NULL)
        return error_memory(error, scratch_size * sizeof *scratch);
    for (size_t k = 0; k < wrong->count; k++)
    {
        size_t row = wrong->outlying[k].index;
        if (!is_here(points, &row))
            continue;
        const double *at = wrong->starts + 2 * k, *position = points->position + row * points->dimension;
        foot_point now = {.at = {at[0], at[1]}, .cell = bat_hierarchical_space_locate(nets->space, at[0], at[1])};
        foot_measure(nets, position, scratch, &now);
        descend(nets, position, &UNIT_SQUARE, correction, scratch, &now);
        if (sqrt(now.square) < wrong->outlying[k].score)
            *moved += store_foot(points, row, &now);
    }
    free(scratch);
    return BAT_OK;
}

static void distance_terms(const void *context, size_t row, double *sums)
{
    const fit_points *points = context;
    sums[0] += points->number[row] < points->own ? points->distance[row] : 0;
}

bat_status fit_correct_wrong_feet(const fit_nets *nets, fit_points *points, fit_correction correction, int threads,
                                  size_t *moved, bat_error *error)
{
    double mean;
    uint64_t count = 0;
    bool together = team_count(points->team) > 1;
    bat_status status = fit_sum_points(points->team, points->count, distance_terms, points, 1, threads, &mean, error);
    if (status != BAT_OK)
        return status;
    mean /= (double)points->total;
    size_t width = points->dimension + 2;
    wrong_feet wrong = {.width = width};
    wrong.points = memory_pool_array(&wrong.pool, MAX_WRONG_FEET, width * sizeof(double));
    wrong.starts = memory_pool_array(&wrong.pool, MAX_WRONG_FEET, 2 * sizeof(double));
    status = memory_pool_check(&wrong.pool, error);
    if (status == BAT_OK)
        wrong.count = find_wrong_feet(points, mean, wrong.outlying);
    for (size_t k = 0; k < wrong.count; k++)
        wrong.outlying[k].index += points->before;
    if (status == BAT_OK && together)
        status = merge_wrong_feet(points, &wrong, error);
    if (status == BAT_OK)
        status = share_wrong_feet(points, &wrong, error);
    if (status == BAT_OK)
        status = find_starts(points, &wrong, mean, threads, error);
    if (status == BAT_OK)
        status = restart_feet(nets, points, &wrong, correction, &count, error);
    if (status == BAT_OK)
        status = team_sum_counts(points->team, &count, 1, error);
    *moved = (size_t)count;
    memory_pool_free(&wrong.pool);
    return status;
}

static size_t count_near(const fit_nets *nets, fit_points *points, size_t row, const void *context, double *scratch)
{
    const double *at = points->parameter + 2 * row, *reach = context;
    foot_point now = {.at = {at[0], at[1]}, .cell = points->cell[row]};
    foot_measure(nets, points->position + row * nets->dimension, scratch, &now);
    return points->number[row] < points->own && is_near(nets, &now, *reach);
}

bat_status fit_near_share(const fit_nets *nets, fit_points *points, double reach, int threads, double *share,
                          bat_error *error)
{
    uint64_t near;
    bat_status status = visit_points(nets, points, count_near, &reach, 2, threads, &near, error);
    if (status == BAT_OK)
        status = team_sum_counts(points->team, &near, 1, error);
    *share = (double)near / (double)points->total;
    return status;
}

static size_t count_corrected(const fit_nets *nets, fit_points *points, size_t row, const void *context, double *scratch)
{
    const fit_correction *correction = context;
    const double *position = points->position + row * nets->dimension, *at = points->parameter + 2 * row;
    foot_limits limits = limits_of(points, row);
    foot_point now = {.at = {at[0], at[1]}, .cell = points->cell[row]};
    foot_measure(nets, position, scratch, &now);
    descend(nets, position, &limits, *correction, scratch, &now);
    return store_foot(points, row, &now);
}

bat_status fit_correct(const fit_nets *nets, fit_points *points, fit_correction correction, int threads, size_t *moved,
                       bat_error *error)
{
    uint64_t changed;
    bat_status status = visit_points(nets, points, count_corrected, &correction, 2, threads, &changed, error);
    if (status == BAT_OK)
        status = team_sum_counts(points->team, &changed, 1, error);
    *moved = (size_t)changed;
    return status;
}

bat_status spline_correct(const bat_spline_surface *surface, bat_surface_fit_data *data, size_t *moved, bat_error *error)
{
    bat_status status = fit_points_check(NULL, data, NULL, error);
    if (status == BAT_OK && data->dimension != surface->dimension)
        status = ERROR_ARGUMENT(error, "the points have %zu coordinates, the surface has %zu", data->dimension,
                                surface->dimension);
    if (status != BAT_OK)
        return status;
    fit_points points;
    fit_nets nets = {0};
    size_t count = 0;
    status = fit_points_make(NULL, data, NULL, false, &points, error);
    if (status == BAT_OK)
        fit_points_locate(&points, surface->space, 0);
    if (status == BAT_OK)
        status = fit_nets_make(surface->space, surface->control, surface->dimension, 0, &nets, error);
    if (status == BAT_OK)
        status = fit_correct(&nets, &points, fit_correction_full(), 0, &count, error);
    if (status == BAT_OK)
        (void)fit_points_return(&points, data);
    if (status == BAT_OK && moved != NULL)
        *moved = count;
    fit_points_free(&points);
    fit_nets_free(&nets);
    return status;
}
