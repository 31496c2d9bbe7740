#include "motion/spline_system.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/dense.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Spaces of a user: the derivatives of exp_m and parallel transport of every interval as matrices, by calls of many rows.
/// The system of the velocities then needs no function of the space.

enum
{
    N = CHART_DIM,
    PAIRS = N * (N + 1) / 2,
    /// Intervals at once, and the rows of one: two ends, lines through the logarithm, places on each.
    BLOCK = 32,
    ROWS = 2 * PAIRS * SPLINE_PLACES
};

/// The matrices of one end, from the derivatives on its lines, which are longer by `scale`.
static bool fill_end(size_t n, double scale, double (*first)[N], double (*second)[N], double *push)
{
    double *pull = push + n * n, (*bend)[n][n] = (double(*)[n][n])(push + 2 * n * n);
    for (size_t c = 0; c < n; c++)
        for (size_t i = 0; i < n; i++)
        {
            push[c * n + i] = first[i][c] / scale;
            bend[i][i][c] = second[i][c] / (scale * scale);
        }
    for (size_t i = 0, line = n; i < n; i++)
        for (size_t j = i + 1; j < n; j++, line++)
            for (size_t c = 0; c < n; c++)
                bend[i][j][c] = bend[j][i][c] = (second[line][c] / (scale * scale) - bend[i][i][c] - bend[j][j][c]) / 2;
    double destroyed[N * N];
    memcpy(destroyed, push, n * n * sizeof *destroyed);
    for (size_t i = 0; i < n * n; i++)
        pull[i] = i % (n + 1) == 0;
    return decompose_solve(n, n, destroyed, pull, NULL) == BAT_OK;
}

/// Line k through a logarithm: along an axis, or along two.
static void line_of(size_t n, size_t k, double *line)
{
    memset(line, 0, n * sizeof *line);
    for (size_t i = 0, pair = n; i < n; i++)
        for (size_t j = i + 1; j <= n; j++)
            if (j < n ? pair++ == k : i == k)
                line[i] = line[j < n ? j : i] = 1;
}

/// The derivatives of exp_m at both logarithms of some intervals.
static bat_status differentiate(const spline_system *system, size_t from, size_t count, double *work, bat_error *error)
{
    const bat_space *space = &system->factor->space;
    size_t n = space->tangent_dim, dim = space->point_dim, lines = n * (n + 1) / 2, each = lines * SPLINE_PLACES, made = 0;
    double *bases = work, *vectors = bases + BLOCK * ROWS * dim, *near = vectors + BLOCK * ROWS * n;
    double line[N], first[PAIRS][N], second[PAIRS][N], scales[BLOCK][2];
    for (size_t i = 0; i < count; i++)
        for (size_t end = 0; end < 2; end++)
        {
            const double *log = system->logs + (2 * (from + i) + end) * n;
            double length = 0;
            for (size_t c = 0; c < n; c++)
                length += log[c] * log[c];
            scales[i][end] = length > 0 ? 2 * sqrt(length) : 1;
            for (size_t k = 0; k < lines; k++)
            {
                line_of(n, k, line);
                for (size_t place = 0; place < SPLINE_PLACES; place++, made++)
                {
                    memcpy(bases + made * dim, system->middles + (from + i) * dim, dim * sizeof *bases);
                    for (size_t c = 0; c < n; c++)
                        vectors[made * n + c] = log[c] + spline_place_of(place) * scales[i][end] * line[c];
                }
            }
        }
    bat_status status = bat_space_exps(space, bases, vectors, made, near, error);
    for (size_t row = 0; row < made; row++)
    {
        size_t i = from + row / each / 2, end = row / each % 2, key = end == 0 || i + 1 < system->count ? i + end : 0;
        memcpy(bases + row * dim, system->points + key * dim, dim * sizeof *bases);
    }
    if (status == BAT_OK)
        status = bat_space_logs(space, bases, near, made, vectors, error);
    for (size_t i = 0; i < 2 * count && status == BAT_OK; i++)
    {
        for (size_t k = 0; k < lines; k++)
            spline_differences(n, vectors + (i * each + k * SPLINE_PLACES) * n, first[k], second[k]);
        if (!fill_end(n, scales[i / 2][i % 2], first, second, spline_chart(system, from + i / 2, i % 2)))
            status = BAT_INVALID_POINT;
    }
    return status;
}

/// The matrices of transport: columns are transported vectors of the axes.
static bat_status transport(const spline_system *system, size_t from, size_t count, double *work, bat_error *error)
{
    const bat_space *space = &system->factor->space;
    size_t n = space->tangent_dim, dim = space->point_dim, made = 0;
    double *bases = work, *goals = bases + BLOCK * ROWS * dim, *vectors = goals + BLOCK * ROWS * dim;
    double *moved = vectors + BLOCK * ROWS * n;
    static const spline_place WAYS[CHART_WAYS][2] = {
        {AT_BEGIN, AT_END}, {AT_END, AT_BEGIN}, {AT_MIDDLE, AT_BEGIN}, {AT_MIDDLE, AT_END}};
    for (size_t i = from; i < from + count; i++)
        for (size_t way = 0; way < CHART_WAYS; way++)
            for (size_t axis = 0; axis < n; axis++, made++)
            {
                size_t next = i + 1 < system->count ? i + 1 : 0;
                const double *places[] = {system->points + i * dim, system->points + next * dim, system->middles + i * dim};
                memcpy(bases + made * dim, places[WAYS[way][0]], dim * sizeof *bases);
                memcpy(goals + made * dim, places[WAYS[way][1]], dim * sizeof *goals);
                memset(vectors + made * n, 0, n * sizeof *vectors);
                vectors[made * n + axis] = 1;
            }
    bat_status status = bat_space_transports(space, bases, goals, vectors, made, moved, error);
    for (size_t row = 0; row < made && status == BAT_OK; row++)
        for (size_t c = 0; c < n; c++)
            spline_chart(system, from + row / n / CHART_WAYS, 2)[(row / n % CHART_WAYS * n + c) * n + row % n] =
                moved[row * n + c];
    return status;
}

/// Whether all axes are tangent vectors: not of spaces whose tangent vectors lie across those of a space around.
static bool has_axes(const spline_system *system)
{
    static const double NEAR = 1e-9;
    const bat_space *space = &system->factor->space;
    double axis[N] = {0}, log[N], point[BAT_SPACE_MAX_DIM];
    bool whole = true;
    for (size_t i = 0; i < space->tangent_dim && whole; i++)
    {
        axis[i] = spline_place_of(0);
        whole = space->exp(space, system->middles, axis, point) == BAT_OK && space->fault(space, point) == NULL &&
                space->log(space, system->middles, point, log) == BAT_OK;
        for (size_t c = 0; c < space->tangent_dim && whole; c++)
            whole = fabs(log[c] - axis[c]) < NEAR;
        axis[i] = 0;
    }
    return whole;
}

bat_status spline_charts_make(spline_system *system, bat_error *error)
{
    const bat_space *space = &system->factor->space;
    size_t n = space->tangent_dim;
    if (!has_axes(system))
        return BAT_OK;
    double *work = memory_array(BLOCK * ROWS, 2 * (space->point_dim + space->tangent_dim) * sizeof *work);
    system->charts = memory_pool_array(&system->pool, system->intervals, (2 * n + 8) * n * n * sizeof *work);
    bat_status status = work != NULL && system->charts != NULL ? BAT_OK : error_memory(error, BLOCK * sizeof *work);
    for (size_t i = 0; i < system->intervals && status == BAT_OK; i += BLOCK)
    {
        size_t count = system->intervals - i < BLOCK ? system->intervals - i : BLOCK;
        bat_error fault;
        status = differentiate(system, i, count, work, &fault);
        if (status == BAT_OK)
            status = transport(system, i, count, work, &fault);
        if (status != BAT_OK)
            status = error_set(error, status, i, 0, "there is no motion in the space %s next to points %zu to %zu (%s)",
                               space->name, i, i + count, bat_status_name(status));
    }
    free(work);
    return status;
}

bool spline_chart_transport(const spline_system *system, size_t interval, spline_place from, spline_place to,
                            const double *vector, double *transported)
{
    size_t n = system->factor->space.tangent_dim;
    if (system->charts == NULL)
        return false;
    size_t way = from == AT_MIDDLE ? (to == AT_BEGIN ? 2 : 3) : from == AT_BEGIN ? 0 : 1;
    const double *matrix = spline_chart(system, interval, 2) + way * n * n;
    for (size_t c = 0; c < n; c++)
    {
        transported[c] = 0;
        for (size_t i = 0; i < n; i++)
            transported[c] += matrix[c * n + i] * vector[i];
    }
    return true;
}
