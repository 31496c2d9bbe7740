#include "curve/smooth_fit.h"

#include "base/error.h"
#include "base/golden.h"
#include "base/memory.h"
#include "linalg/vector.h"

#include <string.h>

enum
{
    OPEN_BAND = 2,
    /// Of a closed polyline whose points are numbered from one point on in both directions in turn.
    CLOSED_BAND = 4,
    ROBUST_ROUNDS = 3,
    GOLDEN_STEPS = 12,
    REACH = 3,     ///< of cross-validation, in powers of 10
    MAX_WIDTH = 50 ///< of averages, in points
};

/// Powers of 10 between which the weight is sought, with the mean step as the unit of the parameter.
static const double FIRST_POWER = -6, LAST_POWER = 14;
/// There is noise where the deviance without it is greater by this: 95 % at a parameter's bound (Self and Liang 1987).
static const double SIGNIFICANT = 2.71;
/// Studentized residuals beyond this are outliers: of normal noise in the plane, one in 460. At most this share of the
/// points is taken as outliers. They are judged by a spline with this share of the weight, which follows bends.
static const double OUTLYING = 3.5, MOST_OUTLIERS = 0.1, CLOSER = 0.1;
/// The range of the slack of an outlier, and the least weight of the spline that judges.
static const double MAX_SLACK = 1e4, LEAST_WEIGHT = 1e-2;
/// Widths of averages of speeds and of accelerations, in units of the spline's width, the fourth root of its weight.
static const double SPEED_WIDTH = 3, BEND_WIDTH = 2;
/// The least speed and the least square of an acceleration, as shares of the mean.
static const double MIN_SPEED = 0.05, MIN_BEND = 0.03;

static size_t edges_of(const smooth_fit *f)
{
    return f->closed ? f->count : f->count - 1;
}

static size_t band_of(const smooth_fit *f)
{
    return f->closed ? CLOSED_BAND : OPEN_BAND;
}

static size_t unknowns_of(const smooth_fit *f)
{
    return f->closed ? f->count : f->count - 2;
}

/// The unknown that is the acceleration at a point; BAT_NO_INDEX at open ends.
static size_t unknown_of(const smooth_fit *f, size_t point)
{
    if (!f->closed)
        return point > 0 && point + 1 < f->count ? point - 1 : BAT_NO_INDEX;
    return point <= (f->count - 1) / 2 ? 2 * point : 2 * (f->count - point) - 1;
}

/// The points before, at and after a point; those past open ends have no unknown.
static void neighbours(const smooth_fit *f, size_t point, size_t unknowns[3])
{
    bool first = point == 0, last = point + 1 == f->count;
    unknowns[0] = first && !f->closed ? BAT_NO_INDEX : unknown_of(f, first ? f->count - 1 : point - 1);
    unknowns[1] = unknown_of(f, point);
    unknowns[2] = last && !f->closed ? BAT_NO_INDEX : unknown_of(f, last ? 0 : point + 1);
}

/// The column of Q^T of a point: what it counts in the second differences before, at and after it.
static void differences(const smooth_fit *f, size_t point, double q[3])
{
    q[0] = f->closed || point > 0 ? 1 / f->steps[point == 0 ? f->count - 1 : point - 1] : 0;
    q[2] = f->closed || point + 1 < f->count ? 1 / f->steps[point] : 0;
    q[1] = -q[0] - q[2];
}

/// An element of a symmetric matrix by its band.
static double *element(const smooth_fit *f, double *bands, size_t a, size_t b)
{
    return a < b ? bands + a * (band_of(f) + 1) + (b - a) : bands + b * (band_of(f) + 1) + (a - b);
}

/// The matrix R + weight Q^T W^-1 Q.
static void assemble(const smooth_fit *f, double weight)
{
    size_t unknowns[3];
    memset(f->bands, 0, unknowns_of(f) * (band_of(f) + 1) * sizeof(double));
    for (size_t i = 0; i < f->count; i++)
    {
        double q[3];
        differences(f, i, q);
        neighbours(f, i, unknowns);
        for (int a = 0; a < 3; a++)
            for (int b = 0; b <= a; b++)
                if (unknowns[a] != BAT_NO_INDEX && unknowns[b] != BAT_NO_INDEX)
                    *element(f, f->bands, unknowns[a], unknowns[b]) += weight * f->slacks[i] * q[a] * q[b];
    }
    for (size_t e = 0; e < edges_of(f); e++)
    {
        size_t ends[2] = {unknown_of(f, e), unknown_of(f, e + 1 == f->count ? 0 : e + 1)};
        double part = f->steps[e] * f->variances[e] / 6;
        for (int k = 0; k < 2; k++)
            if (ends[k] != BAT_NO_INDEX)
                *element(f, f->bands, ends[k], ends[k]) += 2 * part;
        if (ends[0] != BAT_NO_INDEX && ends[1] != BAT_NO_INDEX)
            *element(f, f->bands, ends[0], ends[1]) += part;
    }
}

double smooth_fit_factor(const smooth_fit *f, double weight)
{
    assemble(f, weight);
    size_t n = unknowns_of(f), band = band_of(f);
    double determinant = 0;
    for (size_t j = 0; j < n; j++)
    {
        double *column = f->bands + j * (band + 1);
        size_t length = n - 1 - j < band ? n - 1 - j : band;
        determinant += log(column[0]);
        for (size_t a = 1; a <= length; a++)
            for (size_t b = a; b <= length; b++)
                f->bands[(j + a) * (band + 1) + (b - a)] -= column[a] * column[b] / column[0];
        for (size_t a = 1; a <= length; a++)
            column[a] /= column[0];
    }
    return determinant;
}

/// The second differences of the measurements at a point that has an unknown.
static void second_difference(const smooth_fit *f, size_t point, double *z)
{
    size_t before = point == 0 ? f->count - 1 : point - 1, after = point + 1 == f->count ? 0 : point + 1;
    double h = f->steps[before], k = f->steps[point];
    for (size_t c = 0; c < f->dim; c++)
    {
        const double *r = f->residuals + c;
        z[c] = (f->ahead[point * f->dim + c] + r[after * f->dim] - r[point * f->dim]) / k +
               (f->behind[point * f->dim + c] + r[before * f->dim] - r[point * f->dim]) / h;
    }
}

double smooth_fit_bend(const smooth_fit *f)
{
    size_t n = unknowns_of(f), band = band_of(f), dim = f->dim;
    double sum = 0, *x = f->bends; // by unknowns
    memset(x, 0, f->count * dim * sizeof *x);
    for (size_t i = 0; i < f->count; i++)
        if (unknown_of(f, i) != BAT_NO_INDEX)
            second_difference(f, i, x + unknown_of(f, i) * dim);
    for (size_t j = 0; j < n; j++)
    {
        const double *column = f->bands + j * (band + 1);
        sum += vector_square(dim, x + j * dim) / column[0];
        for (size_t a = 1; a <= band && j + a < n; a++)
            for (size_t c = 0; c < dim; c++)
                x[(j + a) * dim + c] -= column[a] * x[j * dim + c];
    }
    for (size_t j = n; j-- > 0;)
        for (size_t c = 0; c < dim; c++)
        {
            const double *column = f->bands + j * (band + 1);
            double value = x[j * dim + c] / column[0];
            for (size_t a = 1; a <= band && j + a < n; a++)
                value -= column[a] * x[(j + a) * dim + c];
            x[j * dim + c] = value;
        }
    return sum;
}

/// The acceleration at a point, null at open ends.
static const double *bend_at(const smooth_fit *f, size_t point)
{
    size_t unknown = unknown_of(f, point);
    return unknown == BAT_NO_INDEX ? NULL : f->bends + unknown * f->dim;
}

/// The restricted likelihood of a weight, minus twice its logarithm and up to a constant: the second differences are normal
/// with a covariance proportional to the matrix. `f->noise` receives the standard deviation.
static double deviance(smooth_fit *f, double weight)
{
    double determinant = smooth_fit_factor(f, weight), sum = smooth_fit_bend(f),
           numbers = (double)((f->count - (f->closed ? 1 : 2)) * f->dim);
    f->noise = sqrt(weight * sum / numbers);
    return sum > 0 ? numbers * log(sum) + (double)f->dim * determinant : -INFINITY;
}

void smooth_fit_invert(const smooth_fit *f)
{
    size_t n = unknowns_of(f), band = band_of(f);
    for (size_t j = n; j-- > 0;)
    {
        const double *column = f->bands + j * (band + 1);
        for (size_t a = band + 1; a-- > 0;)
        {
            double value = a == 0 ? 1 / column[0] : 0;
            for (size_t b = 1; b <= band && j + b < n && j + a < n; b++)
                value -= column[b] * *element(f, f->inverse, j + b, j + a);
            f->inverse[j * (band + 1) + a] = value;
        }
    }
}

double smooth_fit_variance(const smooth_fit *f, size_t point, double weight)
{
    double q[3], sum = 0;
    size_t unknowns[3];
    differences(f, point, q);
    neighbours(f, point, unknowns);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            if (unknowns[a] != BAT_NO_INDEX && unknowns[b] != BAT_NO_INDEX)
                sum += q[a] * q[b] * *element(f, f->inverse, unknowns[a], unknowns[b]);
    return weight * f->slacks[point] * f->slacks[point] * sum;
}

void smooth_fit_bend_back(const smooth_fit *f, size_t point, double weight, double *move)
{
    double q[3];
    differences(f, point, q);
    const double *bends[3] = {point > 0 || f->closed ? bend_at(f, point == 0 ? f->count - 1 : point - 1) : NULL,
                              bend_at(f, point),
                              point + 1 < f->count || f->closed ? bend_at(f, point + 1 == f->count ? 0 : point + 1) : NULL};
    for (size_t c = 0; c < f->dim; c++)
    {
        move[c] = 0;
        for (int a = 0; a < 3; a++)
            move[c] -= bends[a] != NULL ? weight * f->slacks[point] * q[a] * bends[a][c] : 0;
    }
}

/// Generalized cross-validation (Craven and Wahba 1979): log of squared residuals over the squared sum of variances.
static double cross_validation(smooth_fit *f, double weight)
{
    double squares = 0, freedom = 0, move[BAT_SPACE_MAX_DIM];
    (void)deviance(f, weight);
    smooth_fit_invert(f);
    for (size_t i = 0; i < f->count; i++)
    {
        if (f->slacks[i] == 0)
            continue;
        smooth_fit_bend_back(f, i, weight, move);
        squares += vector_square(f->dim, move) / f->slacks[i];
        freedom += smooth_fit_variance(f, i, weight) / f->slacks[i];
    }
    return log(squares) - 2 * log(freedom);
}

/// Find the weight of least value of a criterion between two powers of 10: whole steps, then golden sections.
static double minimize(smooth_fit *f, double (*value_of)(smooth_fit *f, double weight), double first, double last)
{
    double least = INFINITY, at = first;
    for (double power = first; power <= last; power++)
    {
        double value = value_of(f, pow(10, power));
        at = value < least ? power : at;
        least = fmin(value, least);
    }
    golden_search search = golden_begin(fmax(at - 1, first), fmin(at + 1, last));
    for (int step = 0; step < GOLDEN_STEPS + 1; step++)
        golden_tell(&search, value_of(f, pow(10, search.at)));
    f->weight = pow(10, (search.low + search.high) / 2);
    return value_of(f, f->weight);
}

/// Find the weight with the largest restricted likelihood; 0 where the least one is as likely. Returns the deviance.
static double find_weight(smooth_fit *f)
{
    double first = deviance(f, pow(10, FIRST_POWER)), least = minimize(f, deviance, FIRST_POWER, LAST_POWER);
    if (!(least + SIGNIFICANT < first))
        f->weight = 0;
    return least;
}

/// Give outliers more slack, by their residuals from a spline that follows the measurements closely. Returns their number.
static size_t find_outliers(smooth_fit *f)
{
    size_t outliers = 0;
    double weight = fmax(CLOSER * f->weight, LEAST_WEIGHT), move[BAT_SPACE_MAX_DIM];
    double *sizes = f->buffer, *sorted = f->buffer + f->count;
    for (int round = 0; round < ROBUST_ROUNDS; round++)
    {
        size_t counted = 0;
        (void)deviance(f, weight);
        smooth_fit_invert(f);
        for (size_t i = 0; i < f->count; i++)
        {
            smooth_fit_bend_back(f, i, weight, move);
            double variance = smooth_fit_variance(f, i, weight);
            sizes[i] = variance > 0 ? sqrt(vector_square(f->dim, move) / variance) : 0;
            if (f->slacks[i] > 0)
                sorted[counted++] = sizes[i];
        }
        qsort(sorted, counted, sizeof *sorted, ascending);
        // The median of the length of a standard normal vector, after Wilson and Hilferty.
        double dim = (double)f->dim, median = sqrt(dim * pow(1 - 2 / (9 * dim), 3));
        double scale = sorted[counted / 2] / median;
        double limit = fmax(OUTLYING * scale, sorted[(size_t)((1 - MOST_OUTLIERS) * (double)(counted - 1))]);
        outliers = 0;
        for (size_t i = 0; i < f->count; i++)
            if (f->slacks[i] > 0)
            {
                f->slacks[i] = sizes[i] > limit ? fmin(pow(sizes[i] / limit, 4), MAX_SLACK) : 1;
                outliers += sizes[i] > limit;
            }
    }
    return outliers;
}

/// Find the weight and the outliers. They count less only where that makes the measurements likelier, by more than the
/// choice of a point can. Returns the deviance.
static double find_robust_weight(smooth_fit *f)
{
    double value = find_weight(f), weight = f->weight;
    if (weight == 0)
        return value;
    size_t outliers = find_outliers(f);
    double robust = find_weight(f);
    if (outliers == 0 || (f->weight > 0 && robust + 2 * (double)outliers * log((double)f->count) < value))
        return robust;
    for (size_t i = 0; i < f->count; i++)
        f->slacks[i] = fmin(f->slacks[i], 1);
    f->weight = weight;
    return deviance(f, weight);
}

/// Average values along the edges, with normal weights. `averages` must not be `values`.
static void average(const smooth_fit *f, const double *values, double width, double *averages)
{
    ptrdiff_t n = (ptrdiff_t)edges_of(f);
    width = fmin(fmax(width, 1), MAX_WIDTH);
    ptrdiff_t reach = (ptrdiff_t)(3 * width) + 1;
    for (ptrdiff_t i = 0; i < n; i++)
    {
        double sum = values[i], all = 1;
        for (ptrdiff_t k = 1; k <= reach; k++)
        {
            double share = exp(-0.5 * (double)(k * k) / (width * width));
            bool in[2] = {f->closed || i - k >= 0, f->closed || i + k < n};
            sum += share * ((in[0] ? values[((i - k) % n + n) % n] : 0) + (in[1] ? values[(i + k) % n] : 0));
            all += share * (in[0] + in[1]);
        }
        averages[i] = sum / all;
    }
}

/// Divide by the mean, and raise what is less than `least` to it. With `adds`, add it to all.
static void normalize(double *values, size_t count, double least, bool adds)
{
    double mean = 0;
    for (size_t i = 0; i < count; i++)
        mean += values[i] / (double)count;
    for (size_t i = 0; i < count; i++)
        values[i] = mean > 0 ? (adds ? values[i] / mean + least : fmax(values[i] / mean, least)) : 1;
}

/// Take lengths along the spline for parameters, averaged, in place of equal ones: speeds of a track vary.
static void follow_speeds(smooth_fit *f)
{
    size_t n = edges_of(f), dim = f->dim;
    double move[BAT_SPACE_MAX_DIM], next[BAT_SPACE_MAX_DIM], width = SPEED_WIDTH * pow(f->weight, 0.25);
    for (size_t e = 0; e < n; e++)
    {
        smooth_fit_bend_back(f, e, f->weight, move);
        smooth_fit_bend_back(f, e + 1 == f->count ? 0 : e + 1, f->weight, next);
        for (size_t c = 0; c < dim; c++)
            move[c] = f->ahead[e * dim + c] + next[c] - move[c];
        f->buffer[e] = sqrt(vector_square(dim, move));
    }
    average(f, f->buffer, width, f->steps);
    normalize(f->steps, n, MIN_SPEED, false);
    normalize(f->steps, n, 0, false);
}

/// Take a power of the bends, with geometric mean 1, for the variances of the acceleration.
static void take_variances(smooth_fit *f, const double *bends, double power)
{
    size_t n = edges_of(f);
    double mean = 0;
    for (size_t e = 0; e < n; e++)
        mean += log(bends[e]) / (double)n;
    for (size_t e = 0; e < n; e++)
        f->variances[e] = exp(power * (log(bends[e]) - mean));
}

/// Let the variance of the acceleration follow the spline's squared accelerations, to a power that the restricted likelihood
/// chooses: a track bends more in one place than in another.
static void follow_bends(smooth_fit *f, double flat_deviance)
{
    static const double POWERS[] = {0.5, 1, 1.5};
    size_t n = edges_of(f);
    double *bends = f->buffer + f->count, best = flat_deviance, chosen = 0, weight = f->weight;
    for (size_t e = 0; e < n; e++)
    {
        const double *a = bend_at(f, e), *b = bend_at(f, e + 1 == f->count ? 0 : e + 1);
        f->buffer[e] = (a != NULL ? vector_square(f->dim, a) : 0) + (b != NULL ? vector_square(f->dim, b) : 0);
    }
    average(f, f->buffer, BEND_WIDTH * pow(weight, 0.25), bends);
    normalize(bends, n, MIN_BEND, true);
    for (size_t k = 0; k < sizeof POWERS / sizeof *POWERS; k++)
    {
        take_variances(f, bends, POWERS[k]);
        double value = find_weight(f);
        if (f->weight > 0 && value < best)
        {
            best = value;
            chosen = POWERS[k];
            weight = f->weight;
        }
    }
    take_variances(f, bends, chosen);
    f->weight = weight;
    (void)deviance(f, f->weight);
}

/// Whether there is noise with the lengths of the edges for parameters. Equal parameters take uneven points for noisy ones.
static bool has_noise(smooth_fit *f)
{
    size_t n = edges_of(f);
    for (size_t e = 0; e < n; e++)
        f->steps[e] = sqrt(vector_square(f->dim, f->ahead + e * f->dim));
    normalize(f->steps, n, MIN_SPEED, false);
    (void)find_weight(f);
    for (size_t e = 0; e < n; e++)
        f->steps[e] = 1;
    return f->weight > 0;
}

void smooth_fit_choose(smooth_fit *f)
{
    if (has_noise(f))
        (void)find_robust_weight(f);
    if (f->weight == 0)
        return;
    follow_speeds(f);
    for (size_t i = 0; i < f->count; i++)
        f->slacks[i] = fmin(f->slacks[i], 1);
    double value = find_robust_weight(f);
    if (f->weight == 0)
        return;
    follow_bends(f, value);
    // The geometric mean of the weights by restricted likelihood and by cross-validation. The first smooths a curve too much
    // that is rougher in places than its model, the second too little where noise is correlated.
    double likely = f->weight, noise = f->noise, power = log10(likely);
    (void)minimize(f, cross_validation, power - REACH, power + REACH);
    f->weight = sqrt(f->weight * likely);
    f->noise = noise;
}

void smooth_fit_moves(smooth_fit *f, double *moves)
{
    double noise = f->noise;
    (void)deviance(f, f->weight);
    f->noise = noise;
    for (size_t i = 0; i < f->count; i++)
    {
        smooth_fit_bend_back(f, i, f->weight, moves + i * f->dim);
        vector_add(f->dim, 1, f->residuals + i * f->dim, moves + i * f->dim);
    }
}

bat_status smooth_fit_make(size_t count, size_t dim, bool closed, smooth_fit *fit, bat_error *error)
{
    *fit = (smooth_fit){.count = count, .dim = dim, .closed = closed};
    size_t band = band_of(fit) + 1, numbers = 4 * dim + 5 + 2 * band, rows = count * dim;
    double *next = fit->ahead = memory_array(count, numbers * sizeof(double));
    if (next == NULL)
        return error_memory(error, count * numbers * sizeof(double));
    fit->behind = next += rows;
    fit->residuals = next += rows;
    fit->bends = next += rows;
    fit->steps = next += rows;
    fit->variances = next += count;
    fit->slacks = next += count;
    fit->buffer = next += count;
    fit->bands = next += 2 * count;
    fit->inverse = next + count * band;
    memset(fit->residuals, 0, rows * sizeof(double));
    for (size_t i = 0; i < count; i++)
    {
        fit->steps[i] = fit->variances[i] = 1;
        fit->slacks[i] = closed || (i > 0 && i + 1 < count);
    }
    return BAT_OK;
}

void smooth_fit_free(smooth_fit *fit)
{
    free(fit->ahead);
    *fit = (smooth_fit){0};
}
