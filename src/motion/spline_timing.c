#include "motion/spline_system.h"

#include "base/bisect.h"
#include "base/error.h"

#include <math.h>
#include <string.h>

// With the old time s as a function of the new one, y = (ds/dt)^2 is piecewise linear in s, and u = dy/ds / 2 is the second
// derivative of s. The speed is |v| sqrt(y), the acceleration a y + v u. In a cell of length h from y = p to y = q, at its
// share r, the acceleration is (a (1 - r) - w) p + (a r + w) q, w = v / (2 h): its length is limited on a convex set of
// pairs (p, q) with (0, 0).

enum
{
    /// Places of a cell where limits are demanded, and places between them where they are measured.
    PLACES = 5,
    ALL_PLACES = 2 * PLACES - 1,
    /// Cells of a motion, roughly, and of an interval.
    CELLS = 16384,
    MIN_CELLS = 4,
    MAX_CELLS = 1024,
    BISECTIONS = 44,
    /// Passes over a closed motion until its end meets its beginning.
    TURNS = 12,
    /// Rounds that tighten the limits of cells that exceed them between places.
    ROUNDS = 5
};

/// Excesses below this one need no round, and no cell is tightened by more.
static const double CLOSE = 1e-7, MIN_SCALE = 0.05;
/// Squared speeds below this share of the greatest are rests.
static const double REST = 1e-18;

typedef struct timing_work
{
    const timing_path *path;
    const timing_limits *limits;
    memory_pool pool;
    size_t cells, count; ///< of an interval, and of the motion
    timing_rates *rates; ///< count x PLACES x TIMING_PARTS
    double *scales;      ///< count: what limits of accelerations, and squared ones of speeds, are multiplied by
    double *caps;        ///< count + 1: the greatest y by speeds
    double *reach;       ///< count + 1: the greatest y from which the end can be reached
    double *y;           ///< count + 1
    double rest[TIMING_PARTS];
} timing_work;

static double length_of(const timing_work *work, size_t cell)
{
    size_t i = cell / work->cells;
    return (work->path->times[i + 1] - work->path->times[i]) / (double)work->cells;
}

static timing_rates *rates_of(const timing_work *work, size_t cell, size_t place)
{
    return work->rates + (cell * PLACES + place) * TIMING_PARTS;
}

static bat_status measure(timing_work *work, bat_error *error)
{
    for (size_t cell = 0; cell < work->count; cell++)
        for (size_t k = 0; k < PLACES; k++)
        {
            timing_rates *rates = rates_of(work, cell, k);
            double share = ((double)(cell % work->cells) + (double)k / (PLACES - 1)) / (double)work->cells;
            bat_status status = work->path->rates(work->path->context, cell / work->cells, share, rates);
            if (status != BAT_OK)
                return error_set(error, status, cell / work->cells, 0, "the motion leaves its space after point %zu",
                                 cell / work->cells);
            for (size_t part = 0; part < TIMING_PARTS; part++)
                work->rest[part] = fmax(work->rest[part], REST * rates[part].vv);
        }
    return BAT_OK;
}

/// Whether no part with a limit moves in a cell.
static bool is_free(const timing_work *work, size_t cell)
{
    for (size_t k = 0; k < PLACES; k++)
        for (size_t part = 0; part < TIMING_PARTS; part++)
        {
            bool limited = work->limits->speed[part] > 0 || work->limits->acceleration[part] > 0;
            if (limited && rates_of(work, cell, k)[part].vv > work->rest[part])
                return false;
        }
    return true;
}

/// The greatest y of a node by the speeds in a cell: at its end, and, where that is near 0, by half of the others.
static double cap_of(const timing_work *work, size_t cell, size_t end)
{
    double cap = is_free(work, cell) ? 1 : INFINITY;
    for (size_t part = 0; part < TIMING_PARTS; part++)
    {
        double limit = work->limits->speed[part], at = rates_of(work, cell, end)[part].vv;
        for (size_t k = 0; k < PLACES; k++)
            at = fmax(at, rates_of(work, cell, k)[part].vv / 4);
        if (limit > 0 && at > 0)
            cap = fmin(cap, work->scales[cell] * limit * limit / at);
    }
    return cap;
}

static void fill_caps(timing_work *work)
{
    size_t last = work->count;
    for (size_t i = 0; i <= last; i++)
    {
        size_t before = i > 0 ? i - 1 : last - 1, after = i < last ? i : 0;
        bool open = !work->path->closed;
        double left = i == 0 && open ? INFINITY : cap_of(work, before, PLACES - 1);
        double right = i == last && open ? INFINITY : cap_of(work, after, 0);
        work->caps[i] = fmin(left, right);
    }
    for (size_t end = 0; end < 2 && !work->path->closed; end++)
        for (size_t part = 0; part < TIMING_PARTS; part++)
        {
            double vv = rates_of(work, end == 0 ? 0 : last - 1, end == 0 ? 0 : PLACES - 1)[part].vv;
            if (work->limits->acceleration[part] > 0 && vv > work->rest[part])
                work->caps[end == 0 ? 0 : last] = 0;
        }
}

/// The range of y at the end of a cell that the limits of accelerations allow, for a y at its beginning. Empty: low > high.
static void range_of(const timing_work *work, size_t cell, double p, double *low, double *high)
{
    double h = length_of(work, cell);
    *low = 0;
    *high = INFINITY;
    for (size_t part = 0; part < TIMING_PARTS; part++)
    {
        double limit = work->limits->acceleration[part] * work->scales[cell];
        for (size_t k = 0; k < PLACES && limit > 0; k++)
        {
            const timing_rates *at = &rates_of(work, cell, k)[part];
            double r = (double)k / (PLACES - 1), ww = at->vv / (4 * h * h), wa = at->va / (2 * h), aa = at->aa;
            // |m p + n q|^2 <= limit^2 with m = (1 - r) a - w, n = r a + w, and |m x n| = |a x w|.
            double nn = r * r * aa + 2 * r * wa + ww, mn = r * (1 - r) * aa + (1 - 2 * r) * wa - ww;
            double root = nn * limit * limit - fmax(aa * ww - wa * wa, 0) * p * p;
            double mm = (1 - r) * (1 - r) * aa - 2 * (1 - r) * wa + ww;
            if (!(nn > 0))
            {
                *high = mm * p * p <= limit * limit ? *high : -INFINITY;
                continue;
            }
            if (root < 0)
                *high = -INFINITY;
            root = sqrt(fmax(root, 0));
            *low = fmax(*low, (-mn * p - root) / nn);
            *high = fmin(*high, (-mn * p + root) / nn);
        }
    }
}

/// The greatest y at the beginning of a cell from which one of at most `end` can follow.
static double reach_back(const timing_work *work, size_t cell, double end)
{
    double low, high, good = 0, bad = work->caps[cell];
    range_of(work, cell, bad, &low, &high);
    if (isfinite(bad) && low <= fmin(high, end))
        return bad;
    // An upper bound where speeds give none.
    for (bad = fmin(bad, 1); !isfinite(work->caps[cell]); bad *= 4)
    {
        range_of(work, cell, bad, &low, &high);
        if (!(low <= fmin(high, end)) || !(bad < 1e300))
            break;
    }
    bad = isfinite(work->caps[cell]) ? work->caps[cell] : bad;
    for (int step = 0; step < BISECTIONS; step++)
    {
        double middle = good + (bad - good) / 2;
        range_of(work, cell, middle, &low, &high);
        *(low <= fmin(high, end) ? &good : &bad) = middle;
    }
    return good;
}

/// The two passes: what can reach the end, and the greatest of that which can be reached from the beginning.
static void pass(timing_work *work)
{
    size_t last = work->count;
    work->reach[last] = work->caps[last];
    for (int turn = 0; turn < (work->path->closed ? TURNS : 1); turn++)
    {
        for (size_t cell = last; cell-- > 0;)
            work->reach[cell] = reach_back(work, cell, work->reach[cell + 1]);
        if (!work->path->closed || work->reach[last] <= work->reach[0])
            break;
        work->reach[last] = work->reach[0];
    }
    work->y[0] = work->reach[0];
    for (int turn = 0; turn < (work->path->closed ? TURNS : 1); turn++)
    {
        for (size_t cell = 0; cell < last; cell++)
        {
            double low, high;
            range_of(work, cell, work->y[cell], &low, &high);
            work->y[cell + 1] = fmax(fmin(high, work->reach[cell + 1]), 0);
        }
        if (!work->path->closed || work->y[last] >= work->y[0])
            break;
        work->y[0] = work->y[last];
    }
}

/// How many times a cell's speeds exceed their limits, or the roots of its accelerations: by parabolas through the values at
/// its places and between them.
static bat_status excess_of(const timing_work *work, size_t cell, double *excess)
{
    double h = length_of(work, cell), p = work->y[cell], q = work->y[cell + 1], u = (q - p) / (2 * h);
    timing_rates rates[TIMING_PARTS];
    double values[2 * TIMING_PARTS][ALL_PLACES];
    *excess = 0;
    for (size_t k = 0; k < ALL_PLACES; k++)
    {
        double r = (double)k / (ALL_PLACES - 1), y = p + r * (q - p);
        memcpy(rates, rates_of(work, cell, k / 2), sizeof rates);
        double share = ((double)(cell % work->cells) + r) / (double)work->cells;
        bat_status status = k % 2 == 1 ? work->path->rates(work->path->context, cell / work->cells, share, rates) : BAT_OK;
        if (status != BAT_OK)
            return status;
        for (size_t part = 0; part < TIMING_PARTS; part++)
        {
            double speed = work->limits->speed[part], limit = work->limits->acceleration[part];
            double squared = y * y * rates[part].aa + 2 * y * u * rates[part].va + u * u * rates[part].vv;
            values[2 * part][k] = speed > 0 ? sqrt(y * rates[part].vv) / speed : 0;
            values[2 * part + 1][k] = limit > 0 ? sqrt(sqrt(fmax(squared, 0)) / limit) : 0;
        }
    }
    for (size_t v = 0; v < 2 * TIMING_PARTS; v++)
        for (size_t k = 0; k < ALL_PLACES; k++)
        {
            const double *at = &values[v][k];
            *excess = fmax(*excess, *at);
            if (k == 0 || k + 1 == ALL_PLACES || at[0] < at[-1] || at[0] < at[1])
                continue;
            double slope = (at[1] - at[-1]) / 2, bend = 2 * at[0] - at[1] - at[-1];
            *excess = fmax(*excess, at[0] + (bend > 0 ? slope * slope / (2 * bend) : 0));
        }
    return BAT_OK;
}

/// Solve, and tighten cells that exceed the limits. `*stretch` receives what is left.
static bat_status solve(timing_work *work, double *stretch)
{
    for (int round = 0; round < ROUNDS; round++)
    {
        *stretch = 1;
        fill_caps(work);
        pass(work);
        for (size_t cell = 0; cell < work->count; cell++)
        {
            double excess;
            bat_status status = excess_of(work, cell, &excess);
            if (status != BAT_OK)
                return status;
            *stretch = fmax(*stretch, excess);
            if (excess > 1 + CLOSE / 2)
                work->scales[cell] = fmax(work->scales[cell] / (excess * excess), MIN_SCALE);
        }
        if (*stretch <= 1 + CLOSE)
            break;
    }
    return BAT_OK;
}

/// Times and rates from y. A cell with y = 0 at both ends would never be left: the path has no point where it must stop.
static bat_status fill(const timing_work *work, double stretch, spline_timing *timing, bat_error *error)
{
    timing->times[0] = work->path->times[0];
    double since = 0;
    for (size_t cell = 0; cell < work->count; cell++)
    {
        double h = length_of(work, cell), p = sqrt(work->y[cell]) / stretch, q = sqrt(work->y[cell + 1]) / stretch;
        size_t i = cell / work->cells;
        double length = work->path->times[i + 1] - work->path->times[i];
        since += 2 * h / (p + q);
        timing->times[cell + 1] = timing->times[0] + since;
        timing->rates[2 * cell] = p / length;
        timing->rates[2 * cell + 1] = (q - p) * (q + p) / (2 * h * length);
        if (!(timing->times[cell + 1] > timing->times[cell]) || !isfinite(since))
            return error_set(error, BAT_NO_CONVERGENCE, i, 0, "no times near point %zu hold the limits", i);
    }
    return BAT_OK;
}

bat_status spline_timing_make(const timing_path *path, const timing_limits *limits, memory_pool *pool, spline_timing *timing,
                              bat_error *error)
{
    size_t cells = CELLS / path->intervals;
    cells = cells < MIN_CELLS ? MIN_CELLS : cells > MAX_CELLS ? MAX_CELLS : cells;
    timing_work work = {.path = path, .limits = limits, .cells = cells, .count = path->intervals * cells};
    work.rates = memory_pool_array(&work.pool, work.count, PLACES * TIMING_PARTS * sizeof *work.rates);
    work.scales = memory_pool_array(&work.pool, work.count, sizeof(double));
    work.caps = memory_pool_array(&work.pool, work.count + 1, sizeof(double));
    work.reach = memory_pool_array(&work.pool, work.count + 1, sizeof(double));
    work.y = memory_pool_array(&work.pool, work.count + 1, sizeof(double));
    *timing = (spline_timing){.cells = cells,
                              .times = memory_pool_array(pool, work.count + 1, sizeof(double)),
                              .rates = memory_pool_array(pool, work.count, 2 * sizeof(double))};
    bat_status status = memory_pool_check(&work.pool, error);
    if (status == BAT_OK)
        status = memory_pool_check(pool, error);
    for (size_t cell = 0; status == BAT_OK && cell < work.count; cell++)
        work.scales[cell] = 1;
    double stretch = 1;
    if (status == BAT_OK)
        status = measure(&work, error);
    if (status == BAT_OK)
    {
        status = solve(&work, &stretch);
        status = status == BAT_OK ? fill(&work, stretch, timing, error)
                                  : error_set(error, status, BAT_NO_INDEX, 0, "the motion leaves its space");
    }
    memory_pool_free(&work.pool);
    return status;
}

double spline_timing_share(const spline_timing *timing, size_t interval, double time, double *rate, double *slope)
{
    size_t first = interval * timing->cells, low = bisect_reals(timing->times, first, first + timing->cells, time);
    double begin = (double)(low - first) / (double)timing->cells, end = (double)(low + 1 - first) / (double)timing->cells;
    double since = time - timing->times[low], speed = timing->rates[2 * low];
    *slope = timing->rates[2 * low + 1];
    *rate = fmax(speed + *slope * since, 0);
    return time >= timing->times[low + 1] ? end : fmin(begin + since * (speed + *slope * since / 2), end);
}

double spline_timing_time(const spline_timing *timing, size_t interval, double share)
{
    double place = share * (double)timing->cells;
    size_t part = share < 1 ? (size_t)place : timing->cells - 1, cell = interval * timing->cells + part;
    double way = (place - (double)part) / (double)timing->cells, speed = timing->rates[2 * cell];
    if (share >= 1)
        return timing->times[cell + 1];
    double root = sqrt(fmax(speed * speed + 2 * timing->rates[2 * cell + 1] * way, 0));
    return way > 0 ? timing->times[cell] + 2 * way / (speed + root) : timing->times[cell];
}
