#include "motion/spline_system.h"

#include "base/error.h"
#include "linalg/dense.h"
#include "linalg/vector.h"

#include <string.h>

/// @file
/// Spaces of a user: the derivatives of exp_m and parallel transport of every interval as matrices, by calls of many rows.
/// The system of the velocities then needs no function of the space.

enum
{
    N = CHART_DIM,
    PAIRS = N * (N + 1) / 2,
    BLOCK = 32 // intervals at once
};

/// The rows of a block: lines through a logarithm, places on each.
static size_t rows_of(size_t n)
{
    return BLOCK * n * (n + 1) / 2 * SPLINE_PLACES;
}

/// How nearly derivatives at both ends agree, relative to the interval, where reflection at the middle is an isometry.
static const double MIRRORED = 1e-10;

/// The inverse of the differential at an end.
static bool invert(size_t n, double *push)
{
    double destroyed[N * N], *pull = push + n * n;
    memcpy(destroyed, push, n * n * sizeof *destroyed);
    for (size_t i = 0; i < n * n; i++)
        pull[i] = i % (n + 1) == 0;
    return decompose_solve(n, n, destroyed, pull, NULL) == BAT_OK;
}

/// The matrices of one end, from the derivatives on its lines, which are longer by `scale`.
static bool fill_end(size_t n, double scale, double (*first)[N], double (*second)[N], double *push)
{
    double *bend = push + 2 * n * n, square = scale * scale;
    for (size_t i = 0, line = n; i < n; i++)
        for (size_t j = i; j < n; j++, bend += n)
        {
            for (size_t c = 0; c < n; c++)
            {
                push[c * n + i] = first[i][c] / scale;
                bend[c] = (i == j ? second[i][c] : second[line][c] - second[i][c] - second[j][c]) / square;
            }
            line += j > i;
        }
    return invert(n, push);
}

/// The matrices of the beginning, from those of the end: what exp_m takes from -v is the reflection of what it takes from v,
/// and the reflection's differential is parallel transport, turned back.
static bool mirror_end(const spline_system *system, size_t interval)
{
    size_t n = system->factor->space.tangent_dim, pairs = n * (n + 1) / 2;
    double *push = spline_chart(system, interval, 0), *back = spline_chart(system, interval, 2) + n * n;
    const double *other = spline_chart(system, interval, 1);
    for (size_t c = 0; c < n; c++)
    {
        memset(push + c * n, 0, n * sizeof *push);
        for (size_t i = 0; i < n * n; i++)
            push[c * n + i % n] += back[c * n + i / n] * other[i];
        for (size_t pair = 2 * n; pair < 2 * n + pairs; pair++)
            push[pair * n + c] = -vector_dot(n, back + c * n, other + pair * n);
    }
    return invert(n, push);
}

/// Whether the matrices of an end give the derivatives on a line, which is longer by `scale`.
static bool agrees(size_t n, double scale, const double *line, const double *first, const double *second, const double *push)
{
    static const double zeros[N];
    double bent[N], limit = MIRRORED * scale;
    bool near = true;
    spline_chart_bend(n, push, line, zeros, bent);
    for (size_t c = 0; c < n; c++)
        near = near && fabs(scale * vector_dot(n, push + c * n, line) - first[c]) <= limit &&
               fabs(scale * scale * bent[c] - second[c]) <= limit;
    return near;
}

/// Line k through a logarithm: along an axis, or along two, or at last a line along no plane of these.
static void line_of(size_t n, size_t k, double *line)
{
    for (size_t i = 0, pair = n; i < n; i++)
        for (size_t j = i + 1; j <= n; j++)
            if (j < n ? pair++ == k : i == k)
                line[i] = line[j < n ? j : i] = 1;
    for (size_t i = 0; i < n && k == n * (n + 1) / 2; i++)
        line[i] = 1 / (double)(i + 1);
}

/// The derivatives of exp_m at the logarithm of one end of some intervals: the matrices from all lines, or, where
/// `mirrored` is given, whether those that are there give the derivatives on another line.
static bat_status differentiate(const spline_system *system, size_t from, size_t count, size_t end, bool *mirrored,
                                double *work, bat_error *error)
{
    const bat_space *space = &system->factor->space;
    size_t n = space->tangent_dim, dim = space->point_dim, pairs = n * (n + 1) / 2, made = 0;
    size_t begin = mirrored != NULL ? pairs : 0, lines = mirrored != NULL ? 1 : pairs, each = lines * SPLINE_PLACES;
    double *bases = work, *vectors = bases + rows_of(n) * dim, *near = vectors + rows_of(n) * n;
    double all[PAIRS + 1][N] = {{0}}, first[PAIRS][N], second[PAIRS][N], scales[BLOCK];
    for (size_t k = begin; k < begin + lines; k++)
        line_of(n, k, all[k]);
    for (size_t i = from; i < from + count; i++)
    {
        const double *log = system->logs + (2 * i + end) * n;
        double length = sqrt(vector_square(n, log)), scale = scales[i - from] = length > 0 ? 2 * length : 1;
        for (size_t row = 0; row < each; row++, made++)
        {
            const double *line = all[begin + row / SPLINE_PLACES];
            double step = spline_place_of(row % SPLINE_PLACES) * scale;
            memcpy(bases + made * dim, system->middles + i * dim, dim * sizeof *bases);
            for (size_t c = 0; c < n; c++)
                vectors[made * n + c] = log[c] + step * line[c];
        }
    }
    bat_status status = bat_space_exps(space, bases, vectors, made, near, error);
    for (size_t row = 0; row < made; row++)
    {
        size_t key = from + row / each + end;
        memcpy(bases + row * dim, system->points + (key < system->count ? key : 0) * dim, dim * sizeof *bases);
    }
    if (status == BAT_OK)
        status = bat_space_logs(space, bases, near, made, vectors, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        double *push = spline_chart(system, from + i, end);
        for (size_t k = 0; k < lines; k++)
            spline_differences(n, vectors + (i * each + k * SPLINE_PLACES) * n, first[k], second[k]);
        if (mirrored != NULL)
            *mirrored = *mirrored && agrees(n, scales[i], all[begin], first[0], second[0], push);
        else if (!fill_end(n, scales[i], first, second, push))
            status = BAT_INVALID_POINT;
    }
    return status;
}

/// The matrices of transport: columns are transported vectors of the axes.
static bat_status transport(const spline_system *system, size_t from, size_t count, double *work, bat_error *error)
{
    const bat_space *space = &system->factor->space;
    size_t n = space->tangent_dim, dim = space->point_dim, made = 0;
    double *bases = work, *goals = bases + rows_of(n) * dim, *vectors = goals + rows_of(n) * dim;
    double *moved = vectors + 2 * BLOCK * n * n;
    for (size_t i = from; i < from + count; i++)
        for (size_t way = 0; way < 2; way++)
            for (size_t axis = 0; axis < n; axis++, made++)
            {
                const double *keys[] = {system->points + i * dim,
                                        system->points + (i + 1 < system->count ? i + 1 : 0) * dim};
                memcpy(bases + made * dim, keys[way], dim * sizeof *bases);
                memcpy(goals + made * dim, keys[1 - way], dim * sizeof *goals);
                memset(vectors + made * n, 0, n * sizeof *vectors);
                vectors[made * n + axis] = 1;
            }
    bat_status status = bat_space_transports(space, bases, goals, vectors, made, moved, error);
    for (size_t row = 0; row < made && status == BAT_OK; row++)
        for (size_t c = 0; c < n; c++)
            spline_chart(system, from + row / n / 2, 2)[(row / n % 2 * n + c) * n + row % n] = moved[row * n + c];
    return status;
}

/// The matrices of some intervals. In a symmetric space those of one end tell those of the other.
static bat_status make_block(const spline_system *system, size_t from, size_t count, double *work, bat_error *error)
{
    bool mirrored = true;
    bat_status status = transport(system, from, count, work, error);
    if (status == BAT_OK)
        status = differentiate(system, from, count, 1, NULL, work, error);
    for (size_t i = from; i < from + count && status == BAT_OK && mirrored; i++)
        mirrored = mirror_end(system, i);
    if (status == BAT_OK && mirrored)
        status = differentiate(system, from, count, 0, &mirrored, work, error);
    return status != BAT_OK || mirrored ? status : differentiate(system, from, count, 0, NULL, work, error);
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
    double *work = memory_array(rows_of(n), (2 * space->point_dim + n) * sizeof *work);
    system->charts = memory_pool_array(&system->pool, system->intervals, spline_chart_size(n) * sizeof *work);
    bat_status status = work != NULL && system->charts != NULL ? BAT_OK : error_memory(error, rows_of(n) * sizeof *work);
    for (size_t i = 0; i < system->intervals && status == BAT_OK; i += BLOCK)
    {
        size_t count = system->intervals - i < BLOCK ? system->intervals - i : BLOCK;
        bat_error fault;
        status = make_block(system, i, count, work, &fault);
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
    if (system->charts == NULL || from == AT_MIDDLE || to == AT_MIDDLE)
        return false;
    const double *matrix = spline_chart(system, interval, 2) + (from == AT_BEGIN ? 0 : n * n);
    for (size_t c = 0; c < n; c++)
        transported[c] = vector_dot(n, matrix + c * n, vector);
    return true;
}
