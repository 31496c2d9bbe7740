#include "motion/spline_system.h"

#include "base/error.h"
#include "base/golden.h"
#include "curve/smooth_fit.h"
#include "linalg/dense.h"
#include "linalg/vector.h"

#include <string.h>

// With the rotations R of the body, a bias b and gravity g, specific forces f tell the acceleration R (f - b) + g.
// Integrated twice, without b and g, they are a path; keys less this path are linear in b and g, but for a start and a
// velocity, the integral of the forces' noise, and their own noise. The integral of white noise twice is the prior of a
// cubic smoothing spline (Wahba, Improper priors, spline smoothing and the problem of guarding against model errors in
// regression, 1978): its second differences Q^T y have the covariance q (S + lambda Q^T Q), S being the Gram matrix of hat
// functions. Generalized least squares give b and g, the likelihood gives lambda, and the spline of keys less the whole path
// is what remains.

enum
{
    /// Columns of a component: keys less the path, those of b and g, and the keys alone.
    UNKNOWNS = 6,
    COLUMNS = UNKNOWNS + 2,
    KEYS_ALONE = UNKNOWNS + 1,
    ALL = 3 * COLUMNS,
    SEARCH_STEPS = 30, // of golden sections
    PLACES = 56        // of lambda: its greatest likelihood, and all of its range
};

/// Ratios of the keys' noise to that of the path in a mean step, squared; the bias of the prior relative to the force,
/// the share of the energy of the keys' accelerations from which on forces do not tell the motion; and that of the distances
/// of keys from what others predict.
static const double LOW_RATIO = 1e-8, HIGH_RATIO = 1e4, PRIOR = 0.05, CONTRADICTS = 0.5, PREDICTS = 0.18;
/// The standard deviation of the logarithm of the forces' noise beside what is expected.
static const double SURE = 1.5;

typedef struct force_work
{
    smooth_fit fit; ///< its residuals are the columns at the keys, in units of the mean time between keys
    const gyro_fusion *fused;
    const bat_motion_gyro *gyro;
    const double *keys, *times; ///< count x 3, count
    size_t count;
    double known, prior, step; ///< the noise of a component of keys, or 0; of the bias; the mean time between keys
    double expected;           ///< noise, in the sense of `noise`, by that of the forces and of the rotations
    double found[UNKNOWNS], spread[UNKNOWNS * UNKNOWNS], energy, alone, noise;
} force_work;

/// Integrate the forces: the path with what was found at the fused times, as places and velocities, and columns at the keys.
static void integrate(force_work *work, double *path)
{
    double place[12] = {0}, speed[12] = {0}, rates[12], last[12], force[3], matrix[9];
    size_t near = 0, key = 0;
    for (size_t i = 0; i < work->fused->count; i++)
    {
        double t = work->fused->times[i] - work->fused->times[0],
               h = i > 0 ? t + work->fused->times[0] - work->fused->times[i - 1] : 0;
        gyro_row_at(work->gyro, work->gyro->forces, work->fused->times[i], &near, force);
        bat_rotation_to_matrix(work->fused->rotations + 4 * i, matrix);
        for (size_t r = 0; r < 3; r++)
        {
            rates[4 * r] = vector_dot(3, matrix + 3 * r, force);
            for (size_t c = 0; c < 3; c++)
                rates[4 * r + 1 + c] = -matrix[3 * r + c];
        }
        for (size_t c = 0; c < 12; c++)
        {
            last[c] = i > 0 ? last[c] : rates[c];
            place[c] += h * speed[c] + h * h / 6 * (2 * last[c] + rates[c]);
            speed[c] += h / 2 * (last[c] + rates[c]);
        }
        memcpy(last, rates, sizeof last);
        for (size_t r = 0; r < 3; r++)
        {
            const double *b = work->found, g = work->found[3 + r];
            path[6 * i + r] = place[4 * r] + vector_dot(3, b, place + 4 * r + 1) + g * t * t / 2;
            path[6 * i + 3 + r] = speed[4 * r] + vector_dot(3, b, speed + 4 * r + 1) + g * t;
        }
        if (work->fused->times[i] != work->times[key])
            continue;
        double *column = work->fit.residuals + ALL * key;
        memset(column, 0, ALL * sizeof *column);
        for (size_t r = 0; r < 3; r++)
        {
            column[COLUMNS * r] = work->keys[3 * key + r] - place[4 * r];
            memcpy(column + COLUMNS * r + 1, place + 4 * r + 1, 3 * sizeof *column);
            column[COLUMNS * r + 4 + r] = t * t / 2;
            column[COLUMNS * r + KEYS_ALONE] = work->keys[3 * key + r];
        }
        if (++key == work->count)
            return;
    }
}

/// Find b and g for a lambda; returns minus twice the logarithm of the restricted likelihood and of the prior of the forces'
/// noise, up to a constant.
static double estimate(force_work *work, double lambda)
{
    const smooth_fit *fit = &work->fit;
    double cube = pow(work->step, 3), logs = 3 * smooth_fit_factor(fit, lambda / cube), products[COLUMNS][COLUMNS] = {{0}};
    double degrees = fmax(3 * ((double)work->count - 2) - UNKNOWNS, 1), known = work->known * work->known,
           normal[UNKNOWNS * UNKNOWNS];
    (void)smooth_fit_bend(fit);
    for (size_t j = 0; j + 2 < work->count; j++)
        for (size_t r = 0; r < ALL; r += COLUMNS)
            for (size_t a = 0; a < COLUMNS; a++)
            {
                const double *y = fit->residuals + ALL * (j + 1) + r + a, *z = fit->bends + ALL * j + r;
                double bend = (y[ALL] - y[0]) / fit->steps[j + 1] - (y[0] - y[-ALL]) / fit->steps[j];
                for (size_t b = 0; b < COLUMNS; b++)
                    products[a][b] += bend * z[b] / cube;
            }
    work->alone = products[KEYS_ALONE][KEYS_ALONE];
    double log_determinant = 0, noise = known > 0 ? known / lambda : fmin(products[0][0], work->alone) / degrees;
    for (int round = 0; round < 3; round++)
    {
        log_determinant = 0;
        memset(work->spread, 0, sizeof work->spread);
        for (size_t a = 0; a < UNKNOWNS; a++)
        {
            memcpy(normal + UNKNOWNS * a, products[a + 1] + 1, UNKNOWNS * sizeof *normal);
            normal[(UNKNOWNS + 1) * a] += a < 3 ? noise / (work->prior * work->prior) : 0;
            work->spread[(UNKNOWNS + 1) * a] = 1;
        }
        if (decompose_solve(UNKNOWNS, UNKNOWNS, normal, work->spread, NULL) != BAT_OK)
            return INFINITY;
        for (size_t a = 0; a < UNKNOWNS; a++) // of the triangular factor
            log_determinant += log(fabs(normal[(UNKNOWNS + 1) * a]));
        work->energy = products[0][0];
        for (size_t a = 0; a < UNKNOWNS; a++)
        {
            work->found[a] = 0;
            for (size_t b = 0; b < UNKNOWNS; b++)
                work->found[a] += work->spread[UNKNOWNS * a + b] * products[b + 1][0];
            work->energy -= work->found[a] * products[a + 1][0];
        }
        work->energy = fmax(work->energy, 0);
        work->noise = noise;
        noise = known > 0 ? noise : work->energy / degrees;
    }
    double apart = log(fmax(work->noise, 1e-300) / work->expected) / SURE;
    return log_determinant + logs + apart * apart +
           (known > 0 ? work->energy / noise + degrees * log(noise) : degrees * log(fmax(work->energy, 1e-300)));
}

/// Whether keys without noise lie nearer to the spline through the others with the forces: of smooth motions with dense keys
/// that spline alone is better than the noise of forces. Between keys it is better still than it is at a key left out.
static bool predict_keys(const force_work *work)
{
    double squares[2] = {0};
    for (size_t i = 2; i + 2 < work->count; i++)
        for (size_t r = 0; r < 3; r++)
        {
            const double *h = work->fit.steps + i;
            double z[2][3], scale = pow((h[-1] + h[0]) / 2, 3);
            for (size_t k = 0; k < 3; k++)
            {
                const double *x = work->fit.bends + ALL * (i + k - 2) + COLUMNS * r;
                z[0][k] = x[0] - vector_dot(UNKNOWNS, work->found, x + 1);
                z[1][k] = x[KEYS_ALONE];
            }
            for (size_t k = 0; k < 2; k++) // a key less what the others predict is about this
                squares[k] += pow(scale * ((z[k][2] - z[k][1]) / h[0] - (z[k][1] - z[k][0]) / h[-1]), 2);
        }
    return squares[0] < PREDICTS * PREDICTS * squares[1];
}

/// The lambda of the keys' mean noise, in its distribution by the likelihood: few keys tell it so little that the greatest
/// likelihood often has none. A flat prior of the noise; golden sections find a sharp maximum. None for keys without noise.
static double find_lambda(force_work *work, bool noisy)
{
    double cube = pow(work->step, 3), low = log(LOW_RATIO * cube), high = log(HIGH_RATIO * cube);
    double places[PLACES], deviances[PLACES], least = INFINITY, noise = 0, sum = 0;
    golden_search search = golden_begin(low, high);
    for (int step = 0; step < SEARCH_STEPS && noisy; step++)
        golden_tell(&search, estimate(work, exp(search.at)));
    for (int i = 0; i < PLACES && noisy; i++)
    {
        places[i] = i == 0 ? (search.low + search.high) / 2 : low + (high - low) * (i - 1) / (PLACES - 2);
        deviances[i] = estimate(work, exp(places[i]));
        least = fmin(least, deviances[i]);
    }
    for (int i = 0; i < PLACES && noisy; i++)
    {
        double share = isfinite(deviances[i]) ? exp((least - deviances[i]) / 2 + places[i] / 2) : 0;
        sum += share;
        noise += share * exp(places[i]);
    }
    double lambda = noisy && sum > 0 ? noise / sum : 0;
    (void)estimate(work, lambda);
    return lambda;
}

/// What the keys are away from the path, by the smoothing spline of this model, with the variance of all that is estimated.
static void settle(force_work *work, double lambda, force_rest *rest)
{
    double weight = lambda / pow(work->step, 3), move[ALL];
    smooth_fit_invert(&work->fit);
    for (size_t i = 0; i < work->count; i++)
    {
        smooth_fit_bend_back(&work->fit, i, weight, move);
        double variance = lambda * fmax(1 - smooth_fit_variance(&work->fit, i, weight), 0);
        for (size_t r = 0; r < 3; r++)
        {
            const double *column = work->fit.residuals + ALL * i + COLUMNS * r, *moved = move + COLUMNS * r;
            double left = column[0] + moved[0], drift = 0;
            for (size_t a = 0; a < UNKNOWNS; a++)
            {
                left -= work->found[a] * (column[a + 1] + moved[a + 1]);
                drift += moved[a + 1] * vector_dot(UNKNOWNS, work->spread + UNKNOWNS * a, moved + 1);
            }
            rest->keys[3 * i + r] = left;
            rest->deviations[3 * i + r] = sqrt(work->noise * (variance + drift));
            rest->wander[3 * i + r] = work->noise * pow(work->fit.steps[i] * work->step / 2, 3) / 24;
        }
    }
    rest->sigma = sqrt(3 * work->noise * lambda);
}

bat_status force_path(const gyro_fusion *fused, const bat_motion_gyro *gyro, const double *times, const double *keys,
                      size_t count, double sigma, double *path, force_rest *rest, bat_motion_force_report *report,
                      bat_error *error)
{
    force_work work = {.fused = fused, .gyro = gyro, .keys = keys, .times = times, .count = count};
    double squares = 0;
    for (size_t i = 0; i < gyro->count; i++)
        squares += vector_square(3, gyro->forces + 3 * i) / (double)gyro->count;
    work.prior = fmax(PRIOR * sqrt(squares), 1e-300);
    work.known = sigma > 0 ? sigma / sqrt(3) : 0;
    work.step = (times[count - 1] - times[0]) / (double)(count - 1);
    double *sorted = memory_array(gyro->count, sizeof *sorted);
    if (sorted == NULL)
        return error_memory(error, gyro->count * sizeof *sorted);
    // An error of the rotation turns the force, and lasts for about a step.
    double turned = squares * vector_square(fused->count, fused->deviations) / (double)fused->count;
    work.expected = fmax(pow(gyro_walk_of(gyro, gyro->forces, sorted), 2) + turned * work.step, 1e-300);
    free(sorted);
    bat_status status = smooth_fit_make(count, ALL, false, &work.fit, error);
    if (status == BAT_OK)
    {
        memset(work.fit.ahead, 0, 2 * count * ALL * sizeof(double)); // and behind
        for (size_t i = 0; i < count; i++)
        {
            work.fit.steps[i] = i + 1 < count ? (times[i + 1] - times[i]) / work.step : 1;
            work.fit.slacks[i] = 1;
        }
        integrate(&work, path);
        double lambda = find_lambda(&work, sigma != 0);
        report->explained = work.alone > 0 ? 1 - work.energy / work.alone : 0;
        report->used = report->explained > 1 - CONTRADICTS && (sigma != 0 || predict_keys(&work));
        report->noise = sqrt(work.noise);
        for (size_t c = 0; c < 3; c++)
        {
            report->bias[c] = work.found[c];
            report->bias_sigma[c] = sqrt(work.noise * work.spread[(UNKNOWNS + 1) * c]);
            report->gravity[c] = work.found[3 + c];
        }
        if (report->used)
        {
            integrate(&work, path);
            settle(&work, lambda, rest);
        }
        else
            memset(path, 0, fused->count * 6 * sizeof *path);
    }
    smooth_fit_free(&work.fit);
    return status;
}
