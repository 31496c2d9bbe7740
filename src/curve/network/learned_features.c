#include "curve/network/learned_turns.h"

/// A polygon that turns by less than this is straight.
static const double STRAIGHT = 1e-6;
/// Added to 2 sin(|d| / 2) of a vertex, so that a straight one has a logarithm.
static const double FLAT = 1e-3;
/// Products of neighbouring angles below it hardly count as turns.
static const double FAINT = 1e-2;
/// Share of the turns around an edge below which its own are rounding.
static const double ROUNDING = 1e-6;
/// Smaller angles are rounding: half a degree.
static const double MIN_ANGLE = 0.008726646259971648;
/// Bounds of what tells a rough line that was simplified, and the most that an angle loses there: the share of neighbours
/// that turn the same way, the deviation of the logarithms of lengths, how far the least deviation lies below the mean.
static const double ROUGH[2] = {0.6, 0.8}, UNEVEN[2] = {0.06, 0.25}, SIMPLIFIED[2] = {1.1, 1.7}, LOSS = 0.6;
/// What makes an edge of a simplified line straight: how much longer than the mean it is, as a logarithm, and that it would
/// bend by so many least deviations.
static const double LONGER = 0.22, FARTHER = 1.5, LOW = 0.9;
/// Angles that differ by less are equal but for rounding.
static const double SAME = 1e-6;
/// Vertices with smaller angles count as nearly straight.
static const double NEARLY_STRAIGHT = 0.1;

enum
{
    R = LEARNED_REACH,
    W = LEARNED_RANGE,
    MIDDLE = LEARNED_MIDDLE,
    FEWEST = 6,         ///< deviations that tell how a line was sampled
    FEWEST_OF_RING = 13 ///< vertices of a ring that do
};

learned_turns learned_turns_of(const double *angles, const double *lengths)
{
    learned_turns t = {.strength_squared = STRAIGHT * STRAIGHT};
    double squares = STRAIGHT * STRAIGHT;
    for (int i = 1 - R; i <= R; i++)
    {
        squares += angles[i] * angles[i] / (2 * R);
        double turn = edge_turn(angles[i], lengths[i - 1], lengths[i], lengths[0]);
        t.turn[i + R - 1] = turn;
        t.strength_squared += turn * turn / (2 * R);
    }
    for (int i = R - MIDDLE; i < R + MIDDLE; i++)
        t.mean += t.turn[i] / (2 * MIDDLE);
    for (int i = R - MIDDLE; i < R + MIDDLE; i++)
        t.variance += (t.turn[i] - t.mean) * (t.turn[i] - t.mean) / (2 * MIDDLE);
    t.strength = sqrt(t.strength_squared);
    t.scale = sqrt(t.variance + t.strength_squared * t.strength_squared) / (1 + t.strength);
    t.bend = sqrt(squares);
    // Within a long straight run all four turns are rounding, and only those beyond tell that it is none of a curve.
    double least = edge_least_turn(t.turn + R - 2) / (ROUNDING * t.strength);
    t.factor = edge_straight_factor(t.turn + R - 2) * fmin(least, 1);
    return t;
}

void learned_logs_of(const double *angles, const double *lengths, size_t count, bool statistics, learned_logs *logs)
{
    for (int i = 1 - W; i < W + (int)count; i++, logs++)
    {
        double ratio = fmin(fmax(lengths[i] / lengths[i - 1], 1e-100), 1e100); // their products are finite
        *logs = (learned_logs){.ratio = log(ratio)};
        if (!statistics)
            continue;
        logs->span = log(1 + 1 / ratio);
        logs->turn = log(2 * sin(0.5 * fabs(angles[i])) + FLAT);
    }
}

/// The logarithms of the lengths of the edges -reach … reach in units of edge 0's; sizes[0] is that of edge 0.
static void find_sizes(const learned_logs *logs, int reach, double *sizes)
{
    sizes[0] = 0;
    for (int i = 1; i <= reach; i++)
    {
        sizes[i] = sizes[i - 1] + logs[i].ratio;
        sizes[-i] = sizes[1 - i] - logs[1 - i].ratio;
    }
}

/// x within (-3, 3).
static double bounded(double x)
{
    return x / sqrt(1 + x * x / 9);
}

/// Moments and extremes of a number of values.
typedef struct moments
{
    double count, sum, squares, least, greatest;
} moments;

static moments moments_make(void)
{
    return (moments){.least = INFINITY, .greatest = -INFINITY};
}

static void moments_add(moments *m, double value)
{
    m->count++;
    m->sum += value;
    m->squares += value * value;
    m->least = value < m->least ? value : m->least;
    m->greatest = value > m->greatest ? value : m->greatest;
}

static double mean_of(const moments *m)
{
    return m->sum / m->count;
}

static double variance_of(const moments *m)
{
    double mean = mean_of(m);
    return fmax(m->squares / m->count - mean * mean, 0);
}

/// The standard deviation x as x / (1 + x).
static double bounded_deviation(const moments *m)
{
    double deviation = sqrt(variance_of(m));
    return deviation / (1 + deviation);
}

/// The correlation of two sets of values, between -1 and 1, near 0 where one hardly varies.
static double correlation(const moments *a, const moments *b, double products)
{
    double covariance = products / a->count - mean_of(a) * mean_of(b);
    return covariance / sqrt((variance_of(a) + FAINT) * (variance_of(b) + FAINT));
}

/// The statistics of LEARNED_STATISTICS.
/// @param lengths those of find_sizes()
static void find_statistics(const double *angles, const learned_logs *logs, const double *lengths, double *statistics)
{
    moments deviations = moments_make(), areas = moments_make(), sizes = moments_make(), turns = moments_make(),
            spans = moments_make();
    double before = lengths[W], same = 0, straight = 0, alike = 0, with_span = 0;
    for (int i = -W; i <= W; i++)
    {
        moments_add(&sizes, lengths[i]);
        alike += lengths[i] * before; // as many products as values
        before = lengths[i];
    }
    for (int i = 1 - W; i <= W; i++)
    {
        double size = fabs(angles[i]), span = lengths[i] + logs[i].span;
        double area = lengths[i - 1] + lengths[i] + logs[i].turn;
        moments_add(&deviations, area - span);
        moments_add(&areas, area);
        moments_add(&turns, size);
        moments_add(&spans, span);
        with_span += size * span;
        straight += NEARLY_STRAIGHT * NEARLY_STRAIGHT / (NEARLY_STRAIGHT * NEARLY_STRAIGHT + size * size);
    }
    for (int i = 1 - W; i < W; i++)
    {
        double product = angles[i] * angles[i + 1];
        same += product / (fabs(product) + FAINT);
    }
    const double found[LEARNED_STATISTICS] = {
        bounded(mean_of(&deviations)),
        bounded_deviation(&deviations),
        bounded_deviation(&areas),
        bounded_deviation(&sizes),
        same / (2 * W - 1),
        mean_of(&turns),
        sqrt(variance_of(&turns)),
        straight / (2 * W),
        bounded(mean_of(&deviations) - deviations.least),
        bounded(deviations.greatest - mean_of(&deviations)),
        bounded(mean_of(&areas) - areas.least),
        bounded(sizes.greatest - mean_of(&sizes)),
        correlation(&sizes, &sizes, alike),
        correlation(&turns, &spans, with_span),
    };
    memcpy(statistics, found, sizeof found);
}

/// 0 up to `low`, 1 from `high` on.
static double ramp(double x, double low, double high)
{
    return fmin(fmax((x - low) / (high - low), 0), 1);
}

/// Whether the angles repeat after so few vertices that they do not tell how a line was sampled: those of a small ring.
static bool repeat_soon(const double *angles)
{
    for (int period = 1; period < FEWEST_OF_RING; period++)
    {
        int i = 1 - W;
        while (i + period <= W && fabs(angles[i] - angles[i + period]) <= SAME)
            i++;
        if (i + period > W)
            return true;
    }
    return false;
}

double learned_braked(const double *angles, const learned_logs *logs, double wanted, double angle)
{
    moments deviations = moments_make(), areas = moments_make(), sizes = moments_make();
    double lengths[2 * W + 1], found[2 * W], same = 0, pairs = 0;
    size_t count = 0, low = 0;
    if (repeat_soon(angles))
        return angle;
    find_sizes(logs, W, lengths + W);
    for (int i = 0; i <= 2 * W; i++)
        moments_add(&sizes, lengths[i]);
    for (int i = 1 - W; i <= W; i++)
    {
        if (!(fabs(angles[i]) > MIN_ANGLE))
            continue;
        double area = lengths[W + i - 1] + lengths[W + i] + logs[i].turn;
        found[count++] = area - lengths[W + i] - logs[i].span;
        moments_add(&deviations, found[count - 1]);
        moments_add(&areas, area);
        bool paired = i < W && fabs(angles[i + 1]) > MIN_ANGLE;
        same += paired && angles[i] * angles[i + 1] > 0;
        pairs += paired;
    }
    if (count < FEWEST)
        return angle;
    for (size_t i = 0; i < count; i++)
        low += found[i] <= deviations.least + LOW;
    double below = mean_of(&deviations) - deviations.least, below_area = mean_of(&areas) - areas.least;
    bool is_long = mean_of(&sizes) < -LONGER; // in units of the edge's own length
    if (is_long && 2 * low >= count && 0.5 * fabs(tan(angle)) > FARTHER * exp(deviations.least))
        return 0;
    double rough = 1 - ramp(same / fmax(pairs, 1), ROUGH[0], ROUGH[1]);
    return angle * (1 - LOSS * wanted * rough * ramp(sqrt(variance_of(&sizes)), UNEVEN[0], UNEVEN[1]) *
                            (1 - ramp(fmin(below, below_area), SIMPLIFIED[0], SIMPLIFIED[1])));
}

double learned_angle(learned_edge edge, double correction, double gate)
{
    double angle = edge.base * (1 + tanh(gate)) + edge.scale * tanh(correction);
    return angle > edge.limit ? edge.limit : angle < -edge.limit ? -edge.limit : angle;
}

learned_edge learned_features_of(const double *angles, const double *lengths, learned_setting setting,
                                 const learned_logs *logs, double *features)
{
    const learned_turns t = learned_turns_of(angles, lengths);
    const double *right = t.turn + R, *left = t.turn + R - 1, own = lengths[0];
    const double area = fmin(own * own, DBL_MAX); // of the plane's long edges, whose curvature is 0
    double *kept = features, *second = kept + R + LEARNED_SCALARS, *first = second + R + 1, *both = first + 2 * R;
    double sizes[2 * W + 1];
    find_sizes(logs, setting.level == 0 ? W : R, sizes + W);
    for (int i = 1; i <= R; i++)
    {
        double before = bounded(sizes[W - i]), after = bounded(sizes[W + i]);
        kept[i - 1] = 0.5 * (after + before);
        second[i - 1] = 0.5 * (after - before);
    }
    kept[R] = t.strength / (1 + t.strength);
    kept[R + 1] = t.strength / (LEARNED_FINE + t.strength);
    kept[R + 2] = t.variance / t.strength_squared;
    kept[R + 3] = t.bend / (1 + t.bend);
    kept[R + 4] = setting.curvature * area / (1 + area);
    kept[R + 5] = setting.fairness;
    kept[R + 6] = setting.level;
    double *statistics = kept + R + LEARNED_PLAIN_SCALARS;
    memset(statistics, 0, LEARNED_STATISTICS * sizeof *statistics);
    if (setting.level == 0)
        find_statistics(angles, logs, sizes + W, statistics);
    second[R] = setting.parity;
    for (int i = 0; i < R; i++)
    {
        first[i] = 0.5 * (right[i] + left[-i]) / t.strength;
        both[i] = 0.5 * (right[i] - left[-i]) / t.strength;
        first[R + i] = 0.5 * LEARNED_ANGLE_UNIT * (angles[1 + i] + angles[-i]);
        both[R + i] = 0.5 * LEARNED_ANGLE_UNIT * (angles[1 + i] - angles[-i]);
    }
    return (learned_edge){t.factor * learned_six_point(t.turn + R - 2), t.factor * t.scale,
                          learned_limit(lengths, setting.parity)};
}
