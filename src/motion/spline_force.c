#include "motion/spline_system.h"

#include "base/memory.h"
#include "linalg/dense.h"
#include "linalg/vector.h"

#include <math.h>
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
    SEARCH_STEPS = 30
};

/// Ratios of the keys' noise to that of the path in a mean step, squared; the bias of the prior relative to the force,
/// the share of the energy of the keys' accelerations from which on forces do not tell the motion; and that of the distances
/// of keys from what others predict.
static const double LOW_RATIO = 1e-8, HIGH_RATIO = 1e4, PRIOR = 0.05, CONTRADICTS = 0.5, PREDICTS = 0.18;

typedef struct force_work
{
    memory_pool pool;
    const gyro_fusion *fused;
    const bat_motion_gyro *gyro;
    const double *keys, *times; ///< count x 3, count
    size_t count;
    double known, prior, step; ///< the noise of a component of keys, or 0; of the bias; the mean time between keys
    double *columns;           ///< count x ALL: at the keys, then their second differences
    double *solved;            ///< count x ALL
    double *bands;             ///< count x 3
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
        double *column = work->columns + ALL * key;
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

/// Second differences of the columns, at the places of the keys before the middle one.
static void take_differences(force_work *work)
{
    for (size_t j = 0; j + 2 < work->count; j++)
        for (size_t c = 0; c < ALL; c++)
        {
            double *column = work->columns + ALL * j + c;
            column[0] = (column[2 * ALL] - column[ALL]) / (work->times[j + 2] - work->times[j + 1]) -
                        (column[ALL] - column[0]) / (work->times[j + 1] - work->times[j]);
        }
}

/// Factor S + lambda Q^T Q as L D L^T, and solve for all columns. Returns the logarithm of the determinant.
static double solve_columns(force_work *work, double lambda)
{
    size_t rows = work->count - 2;
    double logs = 0, q[3][3] = {{0}};
    memcpy(work->solved, work->columns, rows * ALL * sizeof(double));
    for (size_t j = 0; j < rows; j++)
    {
        const double *t = work->times + j;
        double *band = work->bands + 3 * j, *x = work->solved + ALL * j;
        for (size_t k = 0; k < 3 && j + k < rows; k++)
        {
            q[k][0] = 1 / (t[k + 1] - t[k]);
            q[k][2] = 1 / (t[k + 2] - t[k + 1]);
            q[k][1] = -q[k][0] - q[k][2];
        }
        band[0] = (t[2] - t[0]) / 3 + lambda * vector_square(3, q[0]);
        band[1] = j + 1 < rows ? (t[2] - t[1]) / 6 + lambda * (q[0][1] * q[1][0] + q[0][2] * q[1][1]) : 0;
        band[2] = j + 2 < rows ? lambda * q[0][2] * q[2][0] : 0;
        for (size_t k = 1; k <= 2 && k <= j; k++)
        {
            const double *before = band - 3 * k; // factors of D and of L
            band[0] -= before[0] * before[k] * before[k];
            band[1] -= k == 1 ? before[0] * before[1] * before[2] : 0;
            for (size_t c = 0; c < ALL; c++)
                x[c] -= before[k] * x[c - k * ALL];
        }
        logs += log(band[0]);
        band[1] /= band[0];
        band[2] /= band[0];
    }
    for (size_t j = rows; j-- > 0;)
        for (size_t c = 0; c < ALL; c++)
        {
            double *x = work->solved + ALL * j + c;
            const double *band = work->bands + 3 * j;
            x[0] = x[0] / band[0] - (j + 1 < rows ? band[1] * x[ALL] : 0) - (j + 2 < rows ? band[2] * x[2 * ALL] : 0);
        }
    return 3 * logs;
}

/// Find b and g for a lambda; returns minus twice the logarithm of the likelihood, up to a constant.
static double estimate(force_work *work, double lambda)
{
    double logs = solve_columns(work, lambda), products[COLUMNS][COLUMNS] = {{0}}, normal[UNKNOWNS * UNKNOWNS];
    double degrees = 3 * ((double)work->count - 2), known = work->known * work->known;
    for (size_t j = 0; j + 2 < work->count; j++)
        for (size_t r = 0; r < 3; r++)
            for (size_t a = 0; a < COLUMNS; a++)
                for (size_t b = 0; b < COLUMNS; b++)
                    products[a][b] += work->columns[ALL * j + COLUMNS * r + a] * work->solved[ALL * j + COLUMNS * r + b];
    work->alone = products[KEYS_ALONE][KEYS_ALONE];
    double noise = known > 0 ? known / lambda : fmin(products[0][0], work->alone) / degrees;
    for (int round = 0; round < 3; round++)
    {
        memset(work->spread, 0, sizeof work->spread);
        for (size_t a = 0; a < UNKNOWNS; a++)
        {
            memcpy(normal + UNKNOWNS * a, products[a + 1] + 1, UNKNOWNS * sizeof *normal);
            normal[(UNKNOWNS + 1) * a] += a < 3 ? noise / (work->prior * work->prior) : 0;
            work->spread[(UNKNOWNS + 1) * a] = 1;
        }
        if (decompose_solve(UNKNOWNS, UNKNOWNS, normal, work->spread, NULL) != BAT_OK)
            return INFINITY;
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
    return known > 0 ? work->energy / noise + degrees * log(noise) + logs : degrees * log(fmax(work->energy, 1e-300)) + logs;
}

/// Whether keys without noise lie nearer to the spline through the others with the forces: of smooth motions with dense keys
/// that spline alone is better than the noise of forces. Between keys it is better still than it is at a key left out.
static bool predict_keys(const force_work *work)
{
    double squares[2] = {0};
    for (size_t i = 2; i + 2 < work->count; i++)
        for (size_t r = 0; r < 3; r++)
        {
            const double *t = work->times + i;
            double z[2][3], scale = pow((t[1] - t[-1]) / 2, 3);
            for (size_t k = 0; k < 3; k++)
            {
                const double *x = work->solved + ALL * (i + k - 2) + COLUMNS * r;
                z[0][k] = x[0] - vector_dot(UNKNOWNS, work->found, x + 1);
                z[1][k] = x[KEYS_ALONE];
            }
            for (size_t k = 0; k < 2; k++) // a key less what the others predict is about this
                squares[k] += pow(scale * ((z[k][2] - z[k][1]) / (t[1] - t[0]) - (z[k][1] - z[k][0]) / (t[0] - t[-1])), 2);
        }
    return squares[0] < PREDICTS * PREDICTS * squares[1];
}

/// The lambda of the greatest likelihood, by golden sections; none for keys without noise.
static void find_lambda(force_work *work, bool noisy)
{
    static const double GOLDEN = 0.6180339887498949;
    double a = log(LOW_RATIO * pow(work->step, 3)), b = log(HIGH_RATIO * pow(work->step, 3));
    for (int step = 0; step < SEARCH_STEPS && noisy; step++)
    {
        double x = b - GOLDEN * (b - a), y = a + GOLDEN * (b - a);
        bool lower = estimate(work, exp(x)) <= estimate(work, exp(y));
        *(lower ? &b : &a) = lower ? y : x;
    }
    (void)estimate(work, noisy ? exp((a + b) / 2) : 0);
}

bat_status force_path(const gyro_fusion *fused, const bat_motion_gyro *gyro, const double *times, const double *keys,
                      size_t count, double sigma, double *path, bat_motion_force_report *report, bat_error *error)
{
    force_work work = {.fused = fused, .gyro = gyro, .keys = keys, .times = times, .count = count};
    double squares = 0;
    for (size_t i = 0; i < gyro->count; i++)
        squares += vector_square(3, gyro->forces + 3 * i) / (double)gyro->count;
    work.prior = fmax(PRIOR * sqrt(squares), 1e-300);
    work.known = sigma > 0 ? sigma / sqrt(3) : 0;
    work.step = (times[count - 1] - times[0]) / (double)(count - 1);
    work.columns = memory_pool_array(&work.pool, count, ALL * sizeof(double));
    work.solved = memory_pool_array(&work.pool, count, ALL * sizeof(double));
    work.bands = memory_pool_array(&work.pool, count, 3 * sizeof(double));
    bat_status status = memory_pool_check(&work.pool, error);
    if (status == BAT_OK)
    {
        integrate(&work, path);
        take_differences(&work);
        find_lambda(&work, sigma != 0);
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
            integrate(&work, path);
        else
            memset(path, 0, fused->count * 6 * sizeof *path);
    }
    memory_pool_free(&work.pool);
    return status;
}
