#include "motion/spline_system.h"

#include "base/error.h"
#include "linalg/vector.h"

#include <string.h>

// The unknowns are the velocities v_k at the keys. Where the space is flat, accelerations are continuous when
//   2 v_{k-1} / h_{k-1} + 4 (1 / h_{k-1} + 1 / h_k) v_k + 2 v_{k+1} / h_k = 6 (d_{k-1} / h_{k-1} + d_k / h_k),
// d being mean velocities between keys. Elsewhere the jump of the acceleration, computed exactly, is the residual, and the
// flat system, its vectors brought from key to key by parallel transport, corrects the velocities until it vanishes.

enum
{
    DIM = BAT_SPACE_MAX_DIM,
    MAX_STEPS = 1000,
    /// Steps that put the slopes right once the velocities are.
    FINISH_STEPS = 20,
    /// The fewest keys that tell where a motion is rough; and its ends, in R^n.
    TELLING = 8
};

/// Neighbouring keys closer than this share of the longest step are at rest.
static const double REST = 1e-9;
/// Corrections below this share of the largest velocity are no longer made,
static const double SETTLED = 1e-13;
/// and below this one they are errors of differences, or rounding, when they cease to fall.
static const double ACCURATE = 1e-9;
/// Corrections are halved whenever they grow, down to this share: neighbours far apart need small steps.
static const double MIN_SHARE = 1.0 / 128;

/// The acceleration's roughness up to which not-a-knot ends are the best, and then natural ones (docs/motion.md).
static const double SLOW = 0.3;
static const double FAST = 0.85;

/// The ratio to the intervals beside it from which on an interval is a gap. Velocities at its ends tell the motion in it for
/// this many radians, at their rate of change beside it over this share of its time: for more where keys on both sides last
/// so long, as in a recording with a hole. At an open end one side alone tells, and the share told counts by its cube.
static const double LONGER = 2.5, LONGER_AT_END = 1.5, LONGER_AMONG_FEW = 2, TOLD = 1.4, TOLD_BY_RECORDING = 2.5, WIDE = 0.6;
/// This many times that ratio, for smoothed keys: they follow a natural spline, which only a hole interrupts.
static const double OF_SMOOTHED = 10;

/// Accelerations at both ends of an interval that are more than this many times those around, and the roughness around, from
/// which its weight falls; and the weight below which it counts as held, and is not used.
static const double FAR = 2, ROUGH = 0.6, HELD = 0.25, MIN_WEIGHT = 1e-9;

typedef enum end_row
{
    ROW_NOT_A_KNOT,
    ROW_PARABOLA,
    ROW_NATURAL,
    ROW_MEAN ///< the mean velocity of the interval
} end_row;

bat_status spline_system_allocate(spline_system *system, bat_error *error)
{
    size_t n = system->factor->space.tangent_dim, numbers = 2 * n * sizeof(double);
    memory_pool *pool = &system->pool;
    bool turns = system->factor->kind == FACTOR_ROTATION;
    system->velocities = memory_pool_zeros(pool, system->count, n * sizeof(double));
    system->middles = memory_pool_array(pool, system->intervals, system->factor->space.point_dim * sizeof(double));
    system->logs = memory_pool_array(pool, system->intervals, numbers);
    system->slopes = memory_pool_array(pool, system->intervals, numbers);
    system->accelerations = memory_pool_array(pool, system->intervals, numbers);
    system->turnings = turns ? memory_pool_array(pool, system->intervals, 2 * sizeof *system->turnings) : NULL;
    system->residuals = memory_pool_array(pool, system->count, n * sizeof(double));
    system->rows = memory_pool_array(pool, system->count, 3 * sizeof(double));
    system->weights = memory_pool_array(pool, system->intervals, sizeof(double));
    system->calm = memory_pool_zeros(pool, system->intervals, sizeof(double));
    system->fixed = memory_pool_zeros(pool, system->count, sizeof *system->fixed);
    bat_status status = memory_pool_check(pool, error);
    for (size_t i = 0; i < system->intervals && status == BAT_OK; i++)
        system->weights[i] = 1;
    return status;
}

static size_t size_of(const spline_system *system)
{
    return system->factor->space.tangent_dim;
}

static const double *point_of(const spline_system *system, size_t key)
{
    return system->points + key * system->factor->space.point_dim;
}

static const double *middle_of(const spline_system *system, size_t interval)
{
    return system->middles + interval * system->factor->space.point_dim;
}

static size_t key_after(const spline_system *system, size_t interval)
{
    return interval + 1 == system->count ? 0 : interval + 1;
}

/// The vector of one end of an interval: 0 for its beginning, 1 for its end.
static double *at_end(const spline_system *system, double *vectors, size_t interval, size_t end)
{
    return vectors + (2 * interval + end) * size_of(system);
}

static double *of_key(const spline_system *system, double *vectors, size_t key)
{
    return vectors + key * size_of(system);
}

static double norm_at(const spline_system *system, size_t key, const double *vector)
{
    const bat_space *space = &system->factor->space;
    return sqrt(fmax(space->inner(space, point_of(system, key), vector, vector), 0));
}

bat_status spline_transport(const spline_system *system, size_t interval, spline_place from, spline_place to,
                            const double *vector, double *transported)
{
    const bat_space *space = &system->factor->space;
    const double *logs = system->logs + 2 * interval * size_of(system);
    const double *places[] = {point_of(system, interval), point_of(system, key_after(system, interval)),
                              middle_of(system, interval)};
    double half[3] = {0};
    if (system->factor->kind == FACTOR_FLAT)
    {
        memcpy(transported, vector, size_of(system) * sizeof *vector);
        return BAT_OK;
    }
    for (size_t c = 0; c < 3 && system->factor->kind == FACTOR_ROTATION; c++) // turns by half of the way, back
        half[c] = ((from != AT_MIDDLE ? logs[3 * from + c] : 0) - (to != AT_MIDDLE ? logs[3 * to + c] : 0)) / 2;
    if (system->factor->kind == FACTOR_ROTATION)
    {
        spline_rotate(half, vector, transported);
        return BAT_OK;
    }
    return spline_chart_transport(system, interval, from, to, vector, transported)
               ? BAT_OK
               : space->transport(space, places[from], places[to], vector, transported);
}

static bat_status fail(const spline_system *system, bat_status status, size_t key, bat_error *error)
{
    return error_set(error, status, key, 0, "there is no motion in the space %s next to point %zu (%s)",
                     system->factor->space.name, key, bat_status_name(status));
}

/// Find the middles and the logarithms of all intervals.
static bat_status measure(spline_system *system, bat_error *error)
{
    const bat_space *space = &system->factor->space;
    for (size_t i = 0; i < system->intervals; i++)
    {
        double *log_p = at_end(system, system->logs, i, 0), *log_q = at_end(system, system->logs, i, 1);
        bat_status status = spline_middle(system->factor, point_of(system, i), point_of(system, key_after(system, i)),
                                          system->ways != NULL ? system->ways + i * size_of(system) : NULL,
                                          system->middles + i * space->point_dim, log_p, log_q);
        if (status == BAT_CUT_LOCUS)
            return error_set(error, status, key_after(system, i), 0, "points %zu and %zu have no unique shortest geodesic",
                             i, key_after(system, i));
        if (status != BAT_OK)
            return fail(system, status, i, error);
        for (size_t end = 0; end < 2 && system->turnings != NULL; end++)
            system->turnings[2 * i + end] = spline_turning_of(vector_square(3, end == 0 ? log_p : log_q));
        // First slopes: those of the geodesic.
        for (size_t end = 0; end < 2; end++)
            for (size_t c = 0; c < size_of(system); c++)
                at_end(system, system->slopes, i, end)[c] = log_q[c] - log_p[c];
    }
    bool charted = system->factor->kind == FACTOR_ANY && size_of(system) <= CHART_DIM;
    return charted ? spline_charts_make(system, error) : BAT_OK;
}

static const spline_turning *turning_of(const spline_system *system, size_t interval, size_t end)
{
    return system->turnings != NULL ? &system->turnings[2 * interval + end] : NULL;
}

static const double *chart_of(const spline_system *system, size_t interval, size_t end)
{
    return system->charts != NULL ? spline_chart(system, interval, end) : NULL;
}

/// Slopes of an interval from the velocities at its ends.
static bat_status pull_slopes(spline_system *system, size_t i)
{
    size_t n = size_of(system);
    for (size_t end = 0; end < 2; end++)
    {
        size_t key = end == 0 ? i : key_after(system, i);
        double wanted[DIM];
        const double *velocity = of_key(system, system->velocities, key);
        for (size_t c = 0; c < size_of(system); c++)
            wanted[c] = system->lengths[i] * velocity[c];
        const double *chart = chart_of(system, i, end);
        double *slope = at_end(system, system->slopes, i, end);
        for (size_t c = 0; chart != NULL && c < n; c++)
            slope[c] = vector_dot(n, chart + n * n + c * n, wanted);
        if (chart != NULL)
            continue;
        bat_status status = spline_pull(system->factor, middle_of(system, i), at_end(system, system->logs, i, end),
                                        point_of(system, key), wanted, turning_of(system, i, end), slope);
        if (status != BAT_OK)
            return status;
    }
    return BAT_OK;
}

/// The second derivatives of the cubic at both ends, and the third.
static void bend(const spline_system *system, size_t i, double *second_0, double *second_1, double *third)
{
    const double *b = at_end(system, system->logs, i, 0), *a = at_end(system, system->logs, i, 1);
    const double *u0 = at_end(system, system->slopes, i, 0), *u1 = at_end(system, system->slopes, i, 1);
    for (size_t c = 0; c < size_of(system); c++)
    {
        double chord = a[c] - b[c];
        second_0[c] = 6 * chord - 4 * u0[c] - 2 * u1[c];
        second_1[c] = -6 * chord + 2 * u0[c] + 4 * u1[c];
        third[c] = 6 * (u0[c] + u1[c] - 2 * chord);
    }
}

/// Accelerations at both ends of an interval, by time.
static bat_status accelerate(spline_system *system, size_t i)
{
    size_t n = size_of(system);
    double second[2][DIM], third[DIM], scale = 1 / (system->lengths[i] * system->lengths[i]);
    bend(system, i, second[0], second[1], third);
    for (size_t end = 0; end < 2; end++)
    {
        double *acceleration = at_end(system, system->accelerations, i, end);
        const double *q = point_of(system, end == 0 ? i : key_after(system, i));
        const double *first = at_end(system, system->slopes, i, end);
        tangent_jet jet = {at_end(system, system->logs, i, end), first, second[end], third};
        const double *chart = chart_of(system, i, end);
        if (chart != NULL && n == 3) // without loops
            spline_chart_bend(3, chart, first, second[end], acceleration);
        else if (chart != NULL)
            spline_chart_bend(n, chart, first, second[end], acceleration);
        bat_status status = chart != NULL ? BAT_OK
                                          : spline_acceleration(system->factor, middle_of(system, i), &jet, q,
                                                                turning_of(system, i, end), acceleration);
        if (status != BAT_OK)
            return status;
        vector_scale(size_of(system), scale, acceleration);
    }
    return BAT_OK;
}

/// The third derivative of an interval's cubic by time, transported to one of its ends.
static bat_status jerk_at(const spline_system *system, size_t i, spline_place end, double *jerk)
{
    double second[2][DIM], third[DIM], h = system->lengths[i];
    bend(system, i, second[0], second[1], third);
    for (size_t c = 0; c < size_of(system); c++)
        third[c] /= h * h * h;
    return spline_transport(system, i, AT_MIDDLE, end, third, jerk);
}

static bool is_closed(const spline_system *system)
{
    return system->intervals == system->count;
}

bat_status spline_chord(const spline_system *system, size_t interval, spline_place end, double *chord)
{
    const bat_space *space = &system->factor->space;
    size_t n = size_of(system), from = end == AT_BEGIN ? interval : key_after(system, interval);
    size_t to = end == AT_BEGIN ? key_after(system, interval) : interval;
    const double *logs = system->logs + 2 * interval * n;
    bool turns = system->factor->kind == FACTOR_ROTATION; // the same at both ends
    bat_status status = turns ? BAT_OK : space->log(space, point_of(system, from), point_of(system, to), chord);
    for (size_t c = 0; c < n; c++)
        chord[c] = turns ? logs[n + c] - logs[c] : end == AT_BEGIN ? chord[c] : -chord[c];
    return status;
}

/// Mean velocities before and after a key, at the key; zeros where there is no interval.
static bat_status chords_of(const spline_system *system, size_t key, double *before, double *after, bool *has_before,
                            bool *has_after)
{
    size_t interval = spline_interval_beside(system, key, -1);
    *has_before = key > 0 || is_closed(system);
    *has_after = key < system->intervals;
    bat_status status = *has_before ? spline_chord(system, interval, AT_END, before) : BAT_OK;
    if (status == BAT_OK && *has_after)
        status = spline_chord(system, key, AT_BEGIN, after);
    for (size_t c = 0; c < size_of(system); c++)
    {
        before[c] /= *has_before ? system->lengths[interval] : 1;
        after[c] /= *has_after ? system->lengths[key] : 1;
    }
    return status;
}

/// Accelerations at the keys by second differences, as residuals, and their lengths in the rows: infinite at open ends.
static bat_status find_bends(spline_system *system, size_t *failed)
{
    double before[DIM] = {0}, after[DIM] = {0};
    for (*failed = 0; *failed < system->count; ++*failed)
    {
        bool left, right;
        bat_status status = chords_of(system, *failed, before, after, &left, &right);
        if (status != BAT_OK)
            return status;
        size_t k = *failed, next = right ? k : 0;
        double total = (system->lengths[spline_interval_beside(system, k, -1)] + system->lengths[next]) / 2;
        for (size_t c = 0; c < size_of(system); c++)
            of_key(system, system->residuals, k)[c] = left && right ? (after[c] - before[c]) / total : 0;
        system->rows[3 * k] = left && right ? norm_at(system, k, of_key(system, system->residuals, k)) : INFINITY;
    }
    return BAT_OK;
}

/// The squared change of the acceleration from key to key over twice its square: near 0 for samples of a smooth motion, near
/// 1 where accelerations are independent. They are second differences, of find_bends(). Adds to the rows of each key both
/// squares, of the way to it from the key before.
static bat_status measure_roughness(spline_system *system, size_t *failed)
{
    size_t n = size_of(system);
    double last[DIM], change = 0, squared = 0;
    for (size_t k = 0; k < system->count; k++)
    {
        size_t before = spline_interval_beside(system, k, -1);
        const double *acceleration = of_key(system, system->residuals, k);
        double *row = system->rows + 3 * k;
        row[1] = row[2] = 0;
        *failed = k;
        if (!isfinite(row[0]) || !isfinite(system->rows[3 * before]) || system->fixed[k] == KEY_GIVEN ||
            system->fixed[before] == KEY_GIVEN)
            continue;
        bat_status status =
            spline_transport(system, before, AT_BEGIN, AT_END, of_key(system, system->residuals, before), last);
        if (status != BAT_OK)
            return status;
        row[2] = pow(row[0], 2) + pow(norm_at(system, k, last), 2);
        vector_add(n, -1, acceleration, last);
        row[1] = pow(norm_at(system, k, last), 2);
        change += row[1];
        squared += row[2];
    }
    system->roughness = squared > 0 ? change / squared : 0;
    return BAT_OK;
}

/// Whether an interval is far longer than those beside it.
static bool is_gap(const spline_system *system, size_t i)
{
    bool closed = is_closed(system), left = i > 0 || closed, right = i + 1 < system->intervals || closed;
    double before = left ? system->lengths[spline_interval_beside(system, i, -1)] : 0;
    double after = right ? system->lengths[spline_interval_beside(system, i, 1)] : 0;
    double longer = left && right ? LONGER : system->count < TELLING ? LONGER_AMONG_FEW : LONGER_AT_END;
    longer *= system->smoothed ? OF_SMOOTHED : 1;
    return system->intervals > 1 && system->lengths[i] > longer * fmax(before, after);
}

/// The key or interval that is `steps` after another one, of `count`. False beyond an open end.
static bool place_at(const spline_system *system, size_t from, ptrdiff_t steps, size_t count, size_t *place)
{
    ptrdiff_t all = (ptrdiff_t)count, at = (ptrdiff_t)from + steps;
    at = is_closed(system) ? (at + all) % all : at;
    *place = (size_t)at;
    return at >= 0 && at < all;
}

/// Add the squares of the velocity and of the acceleration on one side of a gap, over about as long a time as the gap takes:
/// those of short steps are noise. Beyond another gap nothing counts. Whether the time is long enough for a recording.
static bool add_pace(const spline_system *system, size_t gap, int side, double pace[2])
{
    const bat_space *space = &system->factor->space;
    const double *h = system->lengths;
    size_t n = size_of(system), near = side < 0 ? gap : key_after(system, gap), middle = 0, far = 0, j;
    double span = 0, half = 0, towards[DIM], away[DIM];
    ptrdiff_t steps = 0, inner = 1;
    for (; (size_t)steps + 3 < system->count && span < WIDE * h[gap]; steps++)
    {
        bool inside = place_at(system, gap, side * (steps + 1), system->intervals, &j);
        if (!inside || (steps > 1 && h[j] > fmax(h[gap], span) / LONGER))
            break;
        span += h[j];
    }
    for (; inner < steps && half < span / 2; inner++)
    {
        (void)place_at(system, gap, side * inner, system->intervals, &j);
        half += h[j];
    }
    if (steps < 2 || !place_at(system, near, side * (inner - 1), system->count, &middle) ||
        !place_at(system, near, side * steps, system->count, &far) ||
        space->log(space, point_of(system, middle), point_of(system, near), towards) != BAT_OK ||
        space->log(space, point_of(system, middle), point_of(system, far), away) != BAT_OK)
        return false;
    for (size_t c = 0; c < n; c++)
    {
        towards[c] /= half;
        away[c] = 2 * (towards[c] + away[c] / (span - half)) / span;
    }
    pace[0] += pow(norm_at(system, middle, towards), 2);
    pace[1] += pow(norm_at(system, middle, away), 2);
    return span >= WIDE * h[gap];
}

/// Find the weights of intervals, by the rows of measure_roughness(): as those of Salkauskas (C1 splines for interpolation
/// of rapidly varying data, 1984), but 1 where the motion is smooth. In a jump it accelerates, and then the opposite way, by
/// far more than around. And find the shares of gaps, by velocities and accelerations beside them.
static void weigh(spline_system *system)
{
    const double *h = system->lengths, *rows = system->rows;
    for (size_t i = 0; i < system->intervals && system->count >= TELLING; i++)
    {
        double beside = INFINITY, around[2] = {0}, rough[2] = {0};
        size_t j, next = key_after(system, i);
        for (ptrdiff_t d = -2; d <= 3; d++)
        {
            bool inside = place_at(system, i, d, system->count, &j);
            for (size_t c = 0; c < 2 && d > -2 && inside; c++)
                rough[c] += rows[3 * j + 1 + c];
            if (d != 0 && d != 1 && inside && isfinite(rows[3 * j]))
                around[d > 0] = fmax(around[d > 0], rows[3 * j]);
            if (d * d == 1 && place_at(system, i, d, system->intervals, &j))
                beside = fmin(beside, h[j]);
        }
        double opposite = sqrt(fmax((rows[3 * next + 1] - rows[3 * next + 2]) / 2, 0));
        double own = fmin(opposite, fmin(rows[3 * i], rows[3 * next])), least = FAR * (around[0] + around[1]) / 2;
        double weight = own > least && rough[0] > ROUGH * rough[1] ? least / own : 1;
        system->held += weight < HELD && system->fixed[i] != KEY_GIVEN;
        weight = weight < HELD ? 0 : weight;
        system->weights[i] = fmax(weight * pow(fmin(h[i] / beside, 1), 1 - weight), MIN_WEIGHT);
        double pace[2] = {0};
        bool gap = is_gap(system, i), recorded = gap, open = false;
        for (int side = -1; side <= 1 && gap; side += 2)
        {
            recorded = add_pace(system, i, side, pace) && recorded;
            open = open || !place_at(system, i, side, system->intervals, &j);
        }
        double told = (recorded ? TOLD_BY_RECORDING : TOLD) * sqrt(pace[0] / pace[1]) / h[i];
        if (pace[0] > 0)
            system->calm[i] = recorded ? 1 - told : fmax(1 - (open ? pow(told, 3) : told), 0);
    }
}

/// The row of an open end that is not fixed. Next to a rest, or among three keys, there is no knot to leave out.
static end_row row_of_end(const spline_system *system, bat_motion_ends ends, bool first)
{
    if (ends == BAT_MOTION_ENDS_NATURAL)
        return ROW_NATURAL;
    bool flat = system->factor->kind == FACTOR_FLAT;
    if (ends == BAT_MOTION_ENDS_AUTO && system->roughness > FAST && (!flat || system->count >= TELLING))
        return ROW_MEAN;
    if (ends == BAT_MOTION_ENDS_AUTO && system->roughness > SLOW && !flat)
        return ROW_NATURAL;
    size_t next = first ? 1 : system->count - 2, last = first ? system->count - 1 : 0;
    bool alone = system->fixed[next] || system->count < 3 || (system->count == 3 && !system->fixed[last]);
    alone = alone || system->weights[first ? 0 : next] < 1 || system->weights[first ? 1 : next - 1] < 1;
    return alone ? ROW_PARABOLA : ROW_NOT_A_KNOT;
}

/// The flat system's rows: {lower, diagonal, upper}. Corrections fall as well without the corners of closed motions.
static void fill_rows(spline_system *system, bat_motion_ends ends)
{
    const double *h = system->lengths;
    for (size_t k = 0; k < system->count; k++)
    {
        double *row = system->rows + 3 * k;
        bool first = k == 0, last = k + 1 == system->count, open = !is_closed(system);
        row[0] = row[1] = row[2] = 0;
        if (system->fixed[k])
            row[1] = 1;
        else if (open && (first || last))
        {
            size_t edge = first ? 0 : k - 1, beyond = first ? 1 : k - 2;
            end_row kind = row_of_end(system, ends, first);
            bool knot = kind == ROW_NOT_A_KNOT, natural = kind == ROW_NATURAL;
            row[1] = knot ? 1 / h[edge] : natural ? 4 : 1;
            row[first ? 2 : 0] = knot ? 1 / h[edge] + 1 / h[beyond] : natural ? 2 : kind == ROW_PARABOLA;
        }
        else
        {
            size_t beside = spline_interval_beside(system, k, -1);
            double before = system->weights[beside] / h[beside], after = system->weights[k] / h[k];
            row[0] = first ? 0 : 2 * before;
            row[1] = 4 * (before + after);
            row[2] = last ? 0 : 2 * after;
        }
    }
}

/// The residual of an end's row. That of not-a-knot is the jump of the jerk at the next key, less that of the acceleration
/// times 3 / h, so that only two velocities are in it.
static bat_status end_residual(spline_system *system, bat_motion_ends ends, bool first, double *residual)
{
    const double *h = system->lengths;
    size_t n = size_of(system), key = first ? 0 : system->count - 1;
    spline_place here = first ? AT_BEGIN : AT_END, there = first ? AT_END : AT_BEGIN; // of the first interval or the last
    size_t edge = first ? 0 : key - 1, beyond = first ? 1 : key - 2;
    double jerk[DIM], other[DIM], sum[DIM] = {0}, sign = first ? 1 : -1;
    end_row kind = row_of_end(system, ends, first);
    if (kind == ROW_NATURAL)
    {
        const double *acceleration = at_end(system, system->accelerations, edge, first ? 0 : 1);
        for (size_t c = 0; c < n; c++)
            residual[c] = sign * h[edge] * acceleration[c];
        return BAT_OK;
    }
    if (kind == ROW_MEAN)
    {
        bat_status status = spline_chord(system, edge, here, residual);
        for (size_t c = 0; c < n; c++)
            residual[c] = residual[c] / h[edge] - of_key(system, system->velocities, key)[c];
        return status;
    }
    if (kind == ROW_PARABOLA)
    {
        bat_status status = jerk_at(system, edge, here, jerk);
        for (size_t c = 0; c < n; c++)
            residual[c] = -jerk[c] * h[edge] * h[edge] / 6;
        return status;
    }
    bat_status status = jerk_at(system, edge, there, jerk);
    if (status == BAT_OK)
        status = jerk_at(system, beyond, here, other);
    if (status != BAT_OK)
        return status;
    const double *inner = at_end(system, system->accelerations, edge, first ? 1 : 0);
    const double *outer = at_end(system, system->accelerations, beyond, first ? 0 : 1);
    double scale = 1 / (6 * (1 / h[edge] + 1 / h[beyond]));
    for (size_t c = 0; c < n; c++)
        sum[c] = scale * ((other[c] - jerk[c]) + sign * 3 / h[beyond] * (outer[c] - inner[c]));
    return spline_transport(system, edge, there, here, sum, residual);
}

static bat_status fill_residuals(spline_system *system, bat_motion_ends ends, size_t *failed)
{
    size_t n = size_of(system);
    for (size_t i = 0; i < system->intervals; i++)
    {
        *failed = i;
        bat_status status = pull_slopes(system, i);
        if (status == BAT_OK)
            status = accelerate(system, i);
        if (status != BAT_OK)
            return status;
    }
    for (size_t k = 0; k < system->count; k++)
    {
        double *residual = of_key(system, system->residuals, k);
        bool end = !is_closed(system) && (k == 0 || k + 1 == system->count);
        bat_status status = BAT_OK;
        *failed = k;
        if (system->fixed[k])
            memset(residual, 0, n * sizeof *residual);
        else if (end)
            status = end_residual(system, ends, k == 0, residual);
        else
        {
            size_t beside = spline_interval_beside(system, k, -1);
            const double *before = at_end(system, system->accelerations, beside, 1);
            const double *after = at_end(system, system->accelerations, k, 0);
            for (size_t c = 0; c < n; c++)
                residual[c] = system->weights[k] * after[c] - system->weights[beside] * before[c];
        }
        if (status != BAT_OK)
            return status;
    }
    return BAT_OK;
}

/// Gauss's elimination. Residuals become corrections.
static bat_status correct(spline_system *system, double *diagonal, size_t *failed)
{
    size_t n = size_of(system);
    double moved[DIM];
    for (size_t k = 0; k < system->count; k++)
    {
        const double *row = system->rows + 3 * k;
        diagonal[k] = row[1];
        if (k == 0 || row[0] == 0)
            continue;
        double factor = row[0] / diagonal[k - 1];
        double *residual = of_key(system, system->residuals, k);
        *failed = k;
        bat_status status =
            spline_transport(system, k - 1, AT_BEGIN, AT_END, of_key(system, system->residuals, k - 1), moved);
        if (status != BAT_OK)
            return status;
        diagonal[k] -= factor * row[-1];
        vector_add(n, -factor, moved, residual);
    }
    for (size_t k = system->count; k-- > 0;)
    {
        const double *row = system->rows + 3 * k;
        double *residual = of_key(system, system->residuals, k);
        if (k + 1 < system->count && row[2] != 0)
        {
            *failed = k;
            bat_status status =
                spline_transport(system, k, AT_END, AT_BEGIN, of_key(system, system->residuals, k + 1), moved);
            if (status != BAT_OK)
                return status;
            vector_add(n, -row[2], moved, residual);
        }
        for (size_t c = 0; c < n; c++)
            residual[c] /= diagonal[k];
    }
    return BAT_OK;
}

/// Add a share of the corrections. Returns the largest and its key, and the largest velocity.
static double apply(spline_system *system, double share, size_t *largest_key, double *largest_velocity)
{
    double largest = 0;
    *largest_velocity = 0;
    *largest_key = 0;
    for (size_t k = 0; k < system->count; k++)
    {
        double *velocity = of_key(system, system->velocities, k);
        const double *correction = of_key(system, system->residuals, k);
        double change = norm_at(system, k, correction);
        if (!isfinite(change))
            return NAN;
        if (change > largest)
        {
            largest = change;
            *largest_key = k;
        }
        vector_add(size_of(system), share, correction, velocity);
        *largest_velocity = fmax(*largest_velocity, norm_at(system, k, velocity));
    }
    return largest;
}

static bat_status iterate(spline_system *system, bat_motion_ends ends, double *diagonal, bat_error *error)
{
    double before = INFINITY, share = 1;
    size_t key = 0;
    for (int step = 0; step < MAX_STEPS; step++)
    {
        double speed;
        bat_status status = fill_residuals(system, ends, &key);
        if (status == BAT_OK)
            status = correct(system, diagonal, &key);
        if (status != BAT_OK)
            return fail(system, status, key, error);
        double change = apply(system, share, &key, &speed);
        if (!isfinite(change))
            break;
        // The next correction is about change * change / before.
        bool settles = share == 1 && isfinite(before) && change <= before && change * (change / before) <= SETTLED * speed;
        bool linear = system->factor->kind == FACTOR_FLAT && !is_closed(system);
        if (change <= SETTLED * speed || settles || linear || (change <= ACCURATE * speed && change >= 0.5 * before))
            return BAT_OK;
        if (change > before)
            share = fmax(0.5 * share, MIN_SHARE);
        before = change;
    }
    (void)error_set(
        error, BAT_NO_CONVERGENCE, key, 0,
        "no velocities near point %zu make the acceleration continuous: points turn too far from one to the next", key);
    return error_remedy(error, BAT_NO_CONVERGENCE, "shape", "limited does without");
}

/// Move v to the nearest vector that leads back along none of two directions. Directions of length 0 are none.
static void into_cone(const bat_space *space, const double *point, const double *a, const double *b, double *v)
{
    size_t n = space->tangent_dim;
    const double *chords[2] = {a, b};
    double moved[DIM], squared[2], along[2];
    for (int i = 0; i < 2; i++)
    {
        squared[i] = space->inner(space, point, chords[i], chords[i]);
        along[i] = space->inner(space, point, v, chords[i]);
    }
    if (along[0] >= 0 && along[1] >= 0)
        return;
    for (int i = 0; i < 2; i++)
    {
        if (along[i] >= 0)
            continue;
        for (size_t c = 0; c < n; c++)
            moved[c] = v[c] - along[i] / squared[i] * chords[i][c];
        if (space->inner(space, point, moved, chords[1 - i]) >= 0)
        {
            memcpy(v, moved, n * sizeof *v);
            return;
        }
    }
    // Orthogonal to both.
    double mixed = space->inner(space, point, a, b), determinant = squared[0] * squared[1] - mixed * mixed;
    if (!(determinant > 1e-12 * squared[0] * squared[1]))
    {
        int longer = squared[0] >= squared[1] ? 0 : 1;
        vector_add(n, -along[longer] / squared[longer], chords[longer], v);
        return;
    }
    double of_a = (along[0] * squared[1] - along[1] * mixed) / determinant;
    double of_b = (along[1] * squared[0] - along[0] * mixed) / determinant;
    for (size_t c = 0; c < n; c++)
        v[c] -= of_a * a[c] + of_b * b[c];
}

/// The slopes at the keys of parabolas through three keys, where the global system has no solution: limits begin with them.
static bat_status estimate(spline_system *system, bat_error *error)
{
    double before[DIM] = {0}, after[DIM] = {0};
    for (size_t k = 0; k < system->count; k++)
    {
        bool has_before, has_after;
        bat_status status = chords_of(system, k, before, after, &has_before, &has_after);
        if (status != BAT_OK)
            return fail(system, status, k, error);
        double h = has_before ? system->lengths[k > 0 ? k - 1 : system->intervals - 1] : 1;
        double share = !has_before ? 1 : !has_after ? 0 : h / (h + system->lengths[k]);
        double *velocity = of_key(system, system->velocities, k);
        for (size_t c = 0; c < size_of(system) && !system->fixed[k]; c++)
            velocity[c] = (has_before ? (1 - share) * before[c] : 0) + (has_after ? share * after[c] : 0);
    }
    return BAT_OK;
}

/// Whether an interval begins or ends at rest, or is a gap: velocities from short steps must not lead far over a long one.
/// A jump limits nothing.
static bool meets_rest(const spline_system *system, size_t i)
{
    bool rests = system->fixed[i] == KEY_RESTS || system->fixed[key_after(system, i)] == KEY_RESTS;
    return system->weights[i] >= HELD && (rests || (is_gap(system, i) && system->calm[i] >= 0));
}

/// Let the velocities at both ends of a gap go over to its mean velocity, the more the less they tell of the motion in it.
static bat_status calm_gaps(spline_system *system)
{
    double chord[DIM];
    for (size_t i = 0; i < system->intervals; i++)
        for (size_t end = 0; end < 2 && system->calm[i] > 0; end++)
        {
            size_t key = end == 0 ? i : key_after(system, i);
            double *velocity = of_key(system, system->velocities, key);
            bat_status status = spline_chord(system, i, end == 0 ? AT_BEGIN : AT_END, chord);
            if (status != BAT_OK)
                return status;
            for (size_t c = 0; c < size_of(system) && system->fixed[key] == KEY_FREE; c++)
                velocity[c] += system->calm[i] * (chord[c] / system->lengths[i] - velocity[c]);
        }
    return BAT_OK;
}

/// Limit velocities as Fritsch and Carlson do, in all intervals or in those next to rests; velocities that are given stay.
/// The factor of a key is the lesser of its intervals', so that reversing time changes nothing.
static bat_status limit(spline_system *system, bool all, bat_error *error)
{
    const bat_space *space = &system->factor->space;
    size_t n = size_of(system), last = system->intervals - 1;
    double before[DIM] = {0}, after[DIM] = {0}, *excess = system->residuals; // of interval i at i * n
    for (size_t k = 0; k < system->count; k++)
    {
        bool has_before, has_after;
        double *velocity = of_key(system, system->velocities, k);
        bool left = (k > 0 || is_closed(system)) && (all || meets_rest(system, k > 0 ? k - 1 : last));
        bool right = k < system->intervals && (all || meets_rest(system, k));
        if (system->fixed[k] != KEY_FREE || (!left && !right))
            continue;
        bat_status status = chords_of(system, k, before, after, &has_before, &has_after);
        if (status != BAT_OK)
            return fail(system, status, k, error);
        into_cone(space, point_of(system, k), left ? before : after, right ? after : before, velocity);
    }
    // Fritsch and Carlson's condition, by lengths: the circle of radius 3 about 0, in units of the mean speed.
    for (size_t i = 0; i < system->intervals; i++)
    {
        double *v = system->velocities, most = 3 * spline_speed(system, i);
        size_t next = key_after(system, i);
        double speed = hypot(norm_at(system, i, of_key(system, v, i)), norm_at(system, next, of_key(system, v, next)));
        excess[i * n] = (all || meets_rest(system, i)) && !(speed <= most) ? speed / most : 1;
    }
    for (size_t k = 0; k < system->count; k++)
    {
        double *velocity = of_key(system, system->velocities, k);
        double left = k > 0 ? excess[(k - 1) * n] : is_closed(system) ? excess[last * n] : 1;
        double right = k < system->intervals ? excess[k * n] : 1, most = fmax(left, right);
        if (system->fixed[k] != KEY_FREE || !(most > 1))
            continue;
        for (size_t c = 0; c < n; c++)
            velocity[c] = isfinite(most) ? velocity[c] / most : 0;
    }
    return BAT_OK;
}

/// Keys at both ends of an interval without a way rest.
static void find_rests(spline_system *system)
{
    double longest = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < system->intervals; i++)
        {
            double length = spline_speed(system, i) * system->lengths[i];
            longest = fmax(longest, length);
            for (size_t end = 0; pass == 1 && length <= REST * longest && end < 2; end++)
            {
                unsigned char *state = &system->fixed[end == 0 ? i : key_after(system, i)];
                *state = *state == KEY_FREE ? KEY_RESTS : *state;
            }
        }
}

static bat_status solve(spline_system *system, bat_motion_ends ends, bat_motion_shape shape, const double *begin_velocity,
                        const double *end_velocity, bat_error *error)
{
    size_t n = size_of(system), last = system->count - 1;
    if (shape != BAT_MOTION_SHAPE_SMOOTH)
        find_rests(system);
    if (!is_closed(system) && ends == BAT_MOTION_ENDS_CLAMPED)
    {
        system->fixed[0] = system->fixed[last] = KEY_GIVEN;
        if (begin_velocity != NULL)
            memcpy(system->velocities, begin_velocity, n * sizeof *begin_velocity);
        if (end_velocity != NULL)
            memcpy(of_key(system, system->velocities, last), end_velocity, n * sizeof *end_velocity);
    }
    bat_status status = BAT_OK;
    if (shape <= BAT_MOTION_SHAPE_RESTING && system->count > 2)
        status = spline_system_hold(system, &system->held);
    if (status != BAT_OK)
        return fail(system, status, 0, error);
    double *diagonal = memory_array(system->count, sizeof *diagonal);
    if (diagonal == NULL)
        return error_memory(error, system->count * sizeof *diagonal);
    if (system->count == 2)
    {
        // Both ends ask for the same: the geodesic, or a parabola from the end that is fixed.
        bool both = !system->fixed[0] && !system->fixed[1];
        for (size_t end = 0; end < 2 && both && status == BAT_OK; end++)
            status = spline_chord(system, 0, end == 0 ? AT_BEGIN : AT_END, of_key(system, system->velocities, end));
        for (size_t c = 0; c < 2 * n && both; c++)
            system->velocities[c] /= system->lengths[0];
        if (both)
            system->fixed[0] = system->fixed[1] = KEY_GIVEN;
    }
    size_t key = 0;
    if (status == BAT_OK)
        status = find_bends(system, &key);
    if (status == BAT_OK)
        status = measure_roughness(system, &key);
    if (status != BAT_OK)
        (void)fail(system, status, key, error);
    else if (shape <= BAT_MOTION_SHAPE_RESTING)
        weigh(system);
    fill_rows(system, ends);
    if (status == BAT_OK)
        status = iterate(system, ends, diagonal, error);
    if (status == BAT_NO_CONVERGENCE && shape == BAT_MOTION_SHAPE_LIMITED)
        status = estimate(system, error);
    bool limited = shape == BAT_MOTION_SHAPE_LIMITED, rests = false;
    for (size_t k = 0; k < system->count && shape <= BAT_MOTION_SHAPE_RESTING; k++)
        rests = rests || (k < system->intervals && meets_rest(system, k));
    if (status == BAT_OK && (limited || rests))
        status = limit(system, limited, error);
    if (status == BAT_OK && rests)
        status = calm_gaps(system);
    free(diagonal);
    return status;
}

bat_status spline_system_solve(spline_system *system, bat_motion_ends ends, bat_motion_shape shape,
                               const double *begin_velocity, const double *end_velocity, bat_error *error)
{
    size_t given = 0;
    bat_status status = measure(system, error);
    while (given < system->count && system->fixed[given] == KEY_GIVEN)
        given++;
    if (status == BAT_OK && given < system->count)
        status = solve(system, ends, shape, begin_velocity, end_velocity, error);
    // Slopes from velocities, to the last digit.
    int steps = system->factor->kind == FACTOR_ANY && system->charts == NULL ? FINISH_STEPS : 1;
    for (size_t i = 0; i < system->intervals && status == BAT_OK; i++)
        for (int step = 0; step < steps && status == BAT_OK; step++)
        {
            status = pull_slopes(system, i);
            if (status != BAT_OK)
                return fail(system, status, i, error);
        }
    return status;
}

/// What the second derivative by the share, at an end of an interval of R^n, changes from the cubic to the quintic through
/// three keys with velocities. A shorter interval beside it tells less: it makes more of the noise of velocities.
static void change_of_bend(const spline_system *system, size_t i, size_t end, double *change)
{
    size_t n = size_of(system), other = 0, keys[3] = {0};
    memset(change, 0, n * sizeof *change);
    if (!place_at(system, i, end == 0 ? -1 : 1, system->intervals, &other))
        return;
    keys[end == 0 ? 0 : 1] = i;
    keys[end == 0 ? 1 : 0] = key_after(system, i);
    keys[2] = end == 0 ? other : key_after(system, other);
    double b = system->lengths[i], a = system->lengths[other], sign = end == 0 ? 1 : -1, bent = 0;
    for (size_t c = 0; c < n; c++)
    {
        const double *logs[] = {at_end(system, system->logs, i, 0) + c, at_end(system, system->logs, other, 0) + c};
        double u[3], d = sign * (logs[0][n] - logs[0][0]) / b, e = sign * (logs[1][n] - logs[1][0]) / a;
        for (size_t k = 0; k < 3; k++)
            u[k] = sign * of_key(system, system->velocities, keys[k])[c];
        // Divided differences of order 3, 4 and 5.
        double after = (u[0] + u[1] - 2 * d) / (b * b), before = (u[0] + u[2] - 2 * e) / (a * a);
        double mixed = ((d - u[0]) / b - (u[0] - e) / a) / (a + b);
        change[c] = 2 * pow(b, 4) * ((after - mixed) / (a + b) + a * (after - 2 * mixed + before) / pow(a + b, 2));
        bent += pow(3 * d - 2 * u[0] - u[1], 2);
    }
    for (size_t c = 0; c < n; c++) // an interval that does not bend may rest
        change[c] *= bent > 0 ? fmin(1, a / b) : 0;
}

/// Make the cubic of an interval a quintic, as far as its ends agree on how the bend changes: noise of the velocities
/// changes it in opposite ways.
static void raise_degree(const spline_system *system, size_t interval, double *record)
{
    size_t n = size_of(system);
    double changes[2][DIM];
    for (size_t end = 0; end < 2; end++)
        change_of_bend(system, interval, end, changes[end]);
    double squares = vector_square(n, changes[0]) + vector_square(n, changes[1]);
    double agreed = squares > 0 ? fmax(2 * vector_dot(n, changes[0], changes[1]) / squares, 0) : 0;
    for (size_t c = 0; c < n; c++)
    {
        double p = agreed * changes[0][c] / 2, q = agreed * changes[1][c] / 2; // of s^2 (1 - s)^3 and of s^3 (1 - s)^2
        record[2 * n + c] += p;
        record[3 * n + c] += q - 3 * p;
        record[4 * n + c] = 3 * p - 2 * q;
        record[5 * n + c] = q - p;
    }
}

void spline_system_record(const spline_system *system, size_t interval, double *record)
{
    size_t n = size_of(system), dim = system->factor->space.point_dim;
    if (system->factor->kind != FACTOR_FLAT)
    {
        memcpy(record, middle_of(system, interval), dim * sizeof *record);
        record += dim;
    }
    const double *b = at_end(system, system->logs, interval, 0), *a = at_end(system, system->logs, interval, 1);
    const double *u0 = at_end(system, system->slopes, interval, 0), *u1 = at_end(system, system->slopes, interval, 1);
    const double *constant = system->factor->kind == FACTOR_FLAT ? point_of(system, interval) : b;
    for (size_t c = 0; c < n; c++)
    {
        double chord = a[c] - b[c];
        record[c] = constant[c];
        record[n + c] = u0[c];
        record[2 * n + c] = 3 * chord - 2 * u0[c] - u1[c];
        record[3 * n + c] = u0[c] + u1[c] - 2 * chord;
    }
    if (system->factor->quintic)
        raise_degree(system, interval, record);
}
