/// @file
/// Penalized least squares on the grid of a shell; see shell.h and surface/fit/system.h for the equations.
///
/// The penalty is a thin plate's by differences: the sum over spokes of (a - v + (b - v) / cos(pi / n))^2, where b is the
/// middle of the two points opposite to a in the ring of an odd valence n, or the point opposite to it; and the sum over
/// quads of (q_0 - q_1 + q_2 - q_3)^2. Each term is divided by the mean squared length of the edges around, so that parts
/// of different size are bent alike.

#include "surface/shell/shell.h"

#include "base/counting_sort.h"
#include "base/progress.h"
#include "base/threads.h"
#include "linalg/multifrontal.h"
#include "linalg/vector.h"
#include "mesh/sides.h"
#include "surface/fit/system.h"

/// Ratio of the variance to assume to that of residuals: corrections leave noise in one of three coordinates.
static const double SPREAD = 3;

/// Least squared size of edges, in a frame in which coordinates are up to 1.
static const double MIN_SIZE = 1e-10;

/// Angle between normals from which the smoothing around grows (5 degrees), its growth, and its largest factor.
static const double MAX_JUMP = 0.087266462599716474, STIFFEN = 4, MAX_STIFF = 64;

#define STEPS 4       ///< of a correction
#define TRIALS 12     ///< smoothing weights of a round
#define MAX_LOCAL 512 ///< control points of a patch

static const mesh_sides QUADS = {.quads = true};

/// The equations of a grid.
typedef struct fit_work
{
    shell_fit *fit;
    size_t *local_first; ///< quad_count + 1
    uint32_t *local;     ///< control points of each quad's patch
    uint32_t *slot;      ///< vertex_count: scratch
    size_t *point_first; ///< quad_count + 1
    uint32_t *order;     ///< count: points by quad
    fit_system system;
    fit_solver *solver;
    memory_pool pool;
} fit_work;

// The pattern

/// List the control points of a quad's patch. Returns their number.
static size_t list_local(const fit_work *work, uint32_t quad, uint32_t *list)
{
    const sparse_rows *rows = &work->fit->grid->rows;
    size_t places[16], count = 0;
    shell_grid_patch(work->fit->grid, quad, places);
    for (size_t k = 0; k < 16; k++)
        for (size_t at = rows->starts[places[k]]; at < rows->starts[places[k] + 1]; at++)
            if (work->slot[rows->columns[at]] == UINT32_MAX && count < MAX_LOCAL)
            {
                work->slot[rows->columns[at]] = (uint32_t)count;
                list[count++] = rows->columns[at];
            }
    for (size_t k = 0; k < count; k++)
        work->slot[list[k]] = UINT32_MAX;
    return count;
}

static bat_status list_locals(fit_work *work, bat_error *error)
{
    const shell_grid *grid = work->fit->grid;
    uint32_t list[MAX_LOCAL];
    size_t total = 0;
    work->local_first = memory_pool_array(&work->pool, grid->quad_count + 1, sizeof *work->local_first);
    work->slot = memory_pool_array(&work->pool, grid->vertex_count, sizeof *work->slot);
    bat_status status = memory_pool_check(&work->pool, error);
    if (status != BAT_OK)
        return status;
    memset(work->slot, 0xff, grid->vertex_count * sizeof *work->slot);
    for (uint32_t q = 0; q < grid->quad_count; q++)
    {
        work->local_first[q] = total;
        total += list_local(work, q, list);
    }
    work->local_first[grid->quad_count] = total;
    work->local = memory_pool_array(&work->pool, total, sizeof *work->local);
    status = memory_pool_check(&work->pool, error);
    for (uint32_t q = 0; q < grid->quad_count && status == BAT_OK; q++)
        (void)list_local(work, q, work->local + work->local_first[q]);
    return status;
}

/// The quads whose patches depend on each control point.
static bat_status list_users(fit_work *work, size_t **first, uint32_t **users, bat_error *error)
{
    const shell_grid *grid = work->fit->grid;
    size_t count = grid->vertex_count, total = work->local_first[grid->quad_count];
    size_t *starts = memory_pool_zeros(&work->pool, count + 2, sizeof *starts);
    uint32_t *list = memory_pool_array(&work->pool, total, sizeof *list);
    bat_status status = memory_pool_check(&work->pool, error);
    if (status != BAT_OK)
        return status;
    for (size_t k = 0; k < total; k++)
        starts[work->local[k] + 2]++;
    for (size_t v = 0; v < count; v++)
        starts[v + 2] += starts[v + 1];
    for (uint32_t q = 0; q < grid->quad_count; q++)
        for (size_t k = work->local_first[q]; k < work->local_first[q + 1]; k++)
            list[starts[work->local[k] + 1]++] = q;
    *first = starts;
    *users = list;
    return BAT_OK;
}

/// Fill the rows of a column, or count them where `rows` is null.
static size_t fill_column(const fit_work *work, const size_t *first, const uint32_t *users, uint32_t column, int *rows)
{
    size_t count = 1;
    if (rows != NULL)
        rows[0] = (int)column;
    for (size_t u = first[column]; u < first[column + 1]; u++)
        for (size_t k = work->local_first[users[u]]; k < work->local_first[users[u] + 1]; k++)
        {
            uint32_t row = work->local[k];
            if (row <= column || work->slot[row] == column)
                continue;
            work->slot[row] = column;
            if (rows != NULL)
                rows[count] = (int)row;
            count++;
        }
    if (rows != NULL)
        qsort(rows, count, sizeof *rows, ascending_int);
    return count;
}

static bat_status make_pattern(fit_work *work, bat_error *error)
{
    fit_pattern *pattern = &work->system.pattern;
    size_t count = work->fit->grid->vertex_count, *first;
    uint32_t *users;
    bat_status status = list_users(work, &first, &users, error);
    if (status != BAT_OK)
        return status;
    pattern->functions = count;
    pattern->first = memory_pool_zeros(&work->system.pool, count + 1, sizeof *pattern->first);
    if (pattern->first == NULL)
        return memory_pool_check(&work->system.pool, error);
    for (uint32_t v = 0; v < count; v++)
        pattern->first[v + 1] = (int)fill_column(work, first, users, v, NULL);
    status = fit_system_reserve(&work->system, error);
    if (status != BAT_OK)
        return status;
    memset(work->slot, 0xff, count * sizeof *work->slot);
    for (uint32_t v = 0; v < count; v++)
        (void)fill_column(work, first, users, v, pattern->row + pattern->first[v]);
    memset(work->slot, 0xff, count * sizeof *work->slot);
    return BAT_OK;
}

/// Add to an entry of the pattern.
static void add_entry(const fit_pattern *pattern, double *values, uint32_t i, uint32_t j, double value)
{
    values[symmetric_pattern_find(pattern->first, pattern->row, i, j)] += value;
}

// The penalty

/// A difference of control points.
typedef struct difference
{
    uint32_t vertices[8];
    double weights[8];
    size_t count;
} difference;

static void add_square(fit_work *work, const difference *row, double weight)
{
    for (size_t a = 0; a < row->count; a++)
        for (size_t b = 0; b <= a; b++)
            add_entry(&work->system.pattern, work->system.plate, row->vertices[a], row->vertices[b],
                      weight * row->weights[a] * row->weights[b]);
}

static void add_term(difference *row, uint32_t vertex, double weight)
{
    row->vertices[row->count] = vertex;
    row->weights[row->count++] = weight;
}

/// The neighbours of a vertex, counter-clockwise, on a boundary from one side to the other. Returns their number.
static size_t neighbours_of(const shell_grid *grid, uint32_t vertex, uint32_t *list, bool *closed)
{
    uint32_t first = grid->links.first[vertex], h = first;
    size_t count = 0;
    do
    {
        list[count++] = grid->quads[sides_next(&QUADS, h)];
        uint32_t back = sides_previous(&QUADS, h);
        h = grid->links.twin[back];
        if (h == BAT_MESH_NONE)
            list[count++] = grid->quads[back];
    } while (h != BAT_MESH_NONE && h != first);
    *closed = h == first;
    return count;
}

/// The mean squared length of the edges around a vertex.
static double squared_size(const shell_fit *fit, uint32_t vertex, const uint32_t *list, size_t count)
{
    double sum = 0, arm[3];
    for (size_t k = 0; k < count; k++)
    {
        vector3_subtract(fit->start + 3 * (size_t)list[k], fit->start + 3 * (size_t)vertex, arm);
        sum += vector3_dot(arm, arm);
    }
    return sum / (double)count;
}

static void add_ring(fit_work *work, uint32_t vertex)
{
    const shell_fit *fit = work->fit;
    const shell_grid *grid = fit->grid;
    uint32_t list[130];
    bool closed;
    size_t n = neighbours_of(grid, vertex, list, &closed);
    double size = fmax(squared_size(fit, vertex, list, n), MIN_SIZE) / fit->stiff[vertex];
    for (size_t k = 0; k < n && closed && grid->kinds[vertex] == SHELL_SMOOTH; k++)
    {
        double across = n % 2 == 0 ? 1 : 1 / cos(ANGLE_PI / (double)n);
        difference row = {.count = 0};
        add_term(&row, vertex, -1 - across);
        add_term(&row, list[k], 1);
        add_term(&row, list[(k + n / 2) % n], n % 2 == 0 ? across : across / 2);
        if (n % 2 == 1)
            add_term(&row, list[(k + n / 2 + 1) % n], across / 2);
        add_square(work, &row, 2 / ((double)n * size));
    }
    if (grid->kinds[vertex] != SHELL_CREASE)
        return;
    difference row = {.count = 0};
    add_term(&row, vertex, -2);
    uint32_t first = grid->links.first[vertex], h = first;
    for (size_t k = 0; k < n && row.count < 3; k++)
    {
        bool last = !closed && k + 1 == n;
        if (last || grid->sharp[h] || grid->links.twin[h] == BAT_MESH_NONE)
            add_term(&row, list[k], 1);
        if (!last && k + 1 < n)
            h = grid->links.twin[sides_previous(&QUADS, h)] == BAT_MESH_NONE ? h
                                                                             : grid->links.twin[sides_previous(&QUADS, h)];
    }
    add_square(work, &row, 1 / size);
}

static void fill_plate(fit_work *work)
{
    const shell_fit *fit = work->fit;
    const shell_grid *grid = fit->grid;
    memset(work->system.plate, 0, (size_t)work->system.pattern.first[grid->vertex_count] * sizeof *work->system.plate);
    for (uint32_t v = 0; v < grid->vertex_count; v++)
        add_ring(work, v);
    for (uint32_t q = 0; q < grid->quad_count; q++)
    {
        difference row = {.count = 0};
        for (uint32_t c = 0; c < 4; c++)
            add_term(&row, grid->quads[4 * (size_t)q + c], c % 2 == 0 ? 1 : -1);
        const uint32_t *quad = grid->quads + 4 * (size_t)q;
        const uint32_t around[2] = {quad[1], quad[3]};
        add_square(work, &row, 2 * fit->stiff[quad[0]] / fmax(squared_size(fit, quad[0], around, 2), MIN_SIZE));
    }
}

// The points

static size_t face_of(const void *context, uint32_t point)
{
    return ((const shell_fit *)context)->places[point].face;
}

/// Where the noise of a curved surface has its mean: noise that is the same in all directions moves the mean of the points
/// by -H times its variance along the normal, with the mean curvature H. The move is taken off, up to half a standard
/// deviation.
static void take_off_bias(const shell_fit *fit, uint32_t i, double point[3])
{
    const shell_place *place = &fit->places[i];
    const double *bezier = fit->bezier + 48 * (size_t)place->face;
    double at[2][4], slope[2][4], bend[2][4], d[5][3] = {{0}}, normal[3];
    shell_bernstein(place->u, at[0], slope[0]);
    shell_bernstein(place->v, at[1], slope[1]);
    for (int k = 0; k < 2; k++)
    {
        double t = k == 0 ? place->u : place->v;
        bend[k][0] = 6 * (1 - t);
        bend[k][1] = 6 * (3 * t - 2);
        bend[k][2] = 6 * (1 - 3 * t);
        bend[k][3] = 6 * t;
    }
    for (size_t k = 0; k < 16; k++)
        for (size_t c = 0; c < 3; c++)
        {
            size_t a = k % 4, b = k / 4;
            d[0][c] += slope[0][a] * at[1][b] * bezier[3 * k + c];
            d[1][c] += at[0][a] * slope[1][b] * bezier[3 * k + c];
            d[2][c] += bend[0][a] * at[1][b] * bezier[3 * k + c];
            d[3][c] += slope[0][a] * slope[1][b] * bezier[3 * k + c];
            d[4][c] += at[0][a] * bend[1][b] * bezier[3 * k + c];
        }
    vector3_cross(d[0], d[1], normal);
    double area = vector3_length(normal), e = vector3_dot(d[0], d[0]), f = vector3_dot(d[0], d[1]),
           g = vector3_dot(d[1], d[1]);
    if (!(area > 0))
        return;
    double curvature = (vector3_dot(d[2], normal) * g - 2 * vector3_dot(d[3], normal) * f + vector3_dot(d[4], normal) * e) /
                       (2 * area * area * area);
    double limit = sqrt(fit->unbias) / 2, move = fmin(fmax(curvature * fit->unbias, -limit), limit);
    for (size_t c = 0; c < 3; c++)
        point[c] += move * normal[c] / area;
}

/// Sums over the points of a quad, for its Bézier points.
typedef struct quad_sums
{
    double gram[16][16], right[16][3 + FIT_PROBES];
} quad_sums;

static void sum_points(fit_work *work, uint32_t quad, quad_sums *sums)
{
    const shell_fit *fit = work->fit;
    memset(sums, 0, sizeof *sums);
    for (size_t k = work->point_first[quad]; k < work->point_first[quad + 1]; k++)
    {
        uint32_t i = work->order[k];
        if (fit->held != NULL && fit->held[i])
            continue;
        double at[2][4], values[16], right[3 + FIT_PROBES];
        shell_bernstein(fit->places[i].u, at[0], NULL);
        shell_bernstein(fit->places[i].v, at[1], NULL);
        for (size_t a = 0; a < 16; a++)
            values[a] = at[0][a % 4] * at[1][a / 4];
        memcpy(right, fit->points + 3 * (size_t)i, 3 * sizeof *right);
        if (fit->unbias > 0 && fit->trace > 0)
            take_off_bias(fit, i, right);
        for (size_t p = 0; p < FIT_PROBES; p++)
            right[3 + p] = fit_random_sign(i, p);
        work->system.square += vector3_dot(right, right);
        work->system.counted++;
        for (size_t a = 0; a < 16; a++)
        {
            for (size_t b = 0; b <= a; b++)
                sums->gram[a][b] += values[a] * values[b];
            for (size_t c = 0; c < 3 + FIT_PROBES; c++)
                sums->right[a][c] += values[a] * right[c];
        }
    }
    for (size_t a = 0; a < 16; a++)
        for (size_t b = a + 1; b < 16; b++)
            sums->gram[a][b] = sums->gram[b][a];
}

/// Add the sums of a quad to the equations of its control points.
static void add_quad(fit_work *work, uint32_t quad, const quad_sums *sums)
{
    const sparse_rows *rows = &work->fit->grid->rows;
    const uint32_t *local = work->local + work->local_first[quad];
    size_t count = work->local_first[quad + 1] - work->local_first[quad], places[16];
    double product[16][MAX_LOCAL];
    shell_grid_patch(work->fit->grid, quad, places);
    for (size_t k = 0; k < count; k++)
        work->slot[local[k]] = (uint32_t)k;
    for (size_t a = 0; a < 16; a++)
        memset(product[a], 0, count * sizeof *product[a]);
    for (size_t b = 0; b < 16; b++)
        for (size_t at = rows->starts[places[b]]; at < rows->starts[places[b] + 1]; at++)
            for (size_t a = 0; a < 16; a++)
                product[a][work->slot[rows->columns[at]]] += sums->gram[a][b] * rows->values[at];
    for (size_t a = 0; a < 16; a++)
        for (size_t at = rows->starts[places[a]]; at < rows->starts[places[a] + 1]; at++)
        {
            uint32_t row = rows->columns[at];
            double weight = rows->values[at];
            for (size_t c = 0; c < 3 + FIT_PROBES; c++)
                work->system.right[row * work->system.columns + c] += weight * sums->right[a][c];
            for (size_t k = 0; k < count; k++)
                if (local[k] <= row)
                    add_entry(&work->system.pattern, work->system.gram, row, local[k], weight * product[a][k]);
        }
    for (size_t k = 0; k < count; k++)
        work->slot[local[k]] = UINT32_MAX;
}

static void gather(fit_work *work)
{
    fit_system *system = &work->system;
    memset(system->gram, 0, (size_t)system->pattern.first[system->functions] * sizeof *system->gram);
    memset(system->right, 0, system->functions * system->columns * sizeof *system->right);
    system->square = 0;
    system->counted = 0;
    for (uint32_t q = 0; q < work->fit->grid->quad_count; q++)
    {
        quad_sums sums;
        if (work->point_first[q] == work->point_first[q + 1])
            continue;
        sum_points(work, q, &sums);
        add_quad(work, q, &sums);
    }
}

void shell_fit_correct(const shell_fit *fit)
{
#pragma omp parallel for schedule(static) num_threads(threads_worth(fit->threads, fit->count, 2000.0 * (double)fit->count))
    for (size_t i = 0; i < fit->moving; i++)
        fit->squared[i] = shell_place_correct(fit->grid, fit->bezier, fit->points + 3 * i, STEPS, &fit->places[i]);
}

static bat_status work_make(fit_work *work, bat_error *error)
{
    const shell_fit *fit = work->fit;
    fit_system *system = &work->system;
    system->functions = fit->grid->vertex_count;
    system->dimension = 3;
    system->columns = 3 + FIT_PROBES;
    system->threads = fit->threads;
    bat_status status = list_locals(work, error);
    if (status == BAT_OK)
        status = make_pattern(work, error);
    work->point_first = memory_pool_array(&work->pool, fit->grid->quad_count + 1, sizeof *work->point_first);
    work->order = memory_pool_array(&work->pool, fit->count, sizeof *work->order);
    if (status == BAT_OK)
        status = memory_pool_check(&work->pool, error);
    return status == BAT_OK ? fit_solver_make(&system->pattern, &work->solver, error) : status;
}

/// Raise the smoothing around the sides across which normals jump.
static void stiffen(const shell_fit *fit)
{
    const shell_grid *grid = fit->grid;
    for (uint32_t h = 0; h < 4 * grid->quad_count; h++)
    {
        uint32_t twin = grid->links.twin[h];
        if (twin == BAT_MESH_NONE || twin < h || grid->sharp[h] ||
            fmax(shell_jump(grid, fit->bezier, h, 0.3), shell_jump(grid, fit->bezier, h, 0.7)) < MAX_JUMP)
            continue;
        // A vertex of several such sides gets one factor: the sign marks it.
        for (uint32_t c = 0; c < 8; c++)
        {
            double *factor = &fit->stiff[grid->quads[(c < 4 ? h : twin) / 4 * 4 + c % 4]];
            *factor = -fabs(*factor);
        }
    }
    for (size_t v = 0; v < grid->vertex_count; v++)
        if (fit->stiff[v] < 0)
            fit->stiff[v] = fmin(-STIFFEN * fit->stiff[v], MAX_STIFF);
}

static bat_status run_round(fit_work *work, bool corrected, bat_error *error)
{
    shell_fit *fit = work->fit;
    counting_sort(NULL, fit->count, face_of, fit, fit->grid->quad_count, work->point_first, work->order);
    fill_plate(work);
    gather(work);
    const fit_weight_search search = {.smoothing = BAT_SURFACE_SMOOTHING_LIKELIHOOD,
                                      .spread = corrected ? SPREAD * fit->stiffness : 1,
                                      .lambda = fit->lambda,
                                      .trials = TRIALS};
    bat_status status =
        fit->count > fit->moving
            ? fit_weight_solve(&work->system, work->solver, &fit->lambda, fit->control, error)
            : fit_weight_find(&work->system, work->solver, &search, &fit->lambda, &fit->trace, fit->control, error);
    if (status == BAT_OK)
        status = shell_grid_bezier(fit->grid, fit->control, fit->bezier, error);
    if (status == BAT_OK)
        shell_fit_correct(fit);
    if (status == BAT_OK && (fit->held == NULL || fit->count > fit->moving) && fit->unbias > 0)
        stiffen(fit);
    return status;
}

bat_status shell_fit_run(shell_fit *fit, int rounds, bat_error *error)
{
    fit_work work = {.fit = fit};
    bat_status status = work_make(&work, error);
    for (int k = 0; k < rounds && status == BAT_OK; k++)
        status = progress_goes_on(fit->progress, (double)k / rounds)
                     ? run_round(&work, fit->trace > 0, error)
                     : error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "the fit was stopped");
    fit_solver_free(work.solver);
    fit_system_free(&work.system);
    memory_pool_free(&work.pool);
    return status;
}
