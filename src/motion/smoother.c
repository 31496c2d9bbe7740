#include "motion/smoother.h"

#include "base/error.h"
#include "linalg/vector.h"

#include <math.h>
#include <string.h>

/// @file
/// Reinsch's smoothing spline (Smoothing by spline functions, Numerische Mathematik 10, 1967), with geodesic residuals and
/// with vectors in a frame that is parallel along the keys: in it all components have one pentadiagonal system of numbers.
/// docs/algorithms/motion-splines.md derives it.

enum
{
    MAX_STEPS = 60
};

double smoother_squares(const smoother *s, double cut)
{
    double sum = 0;
    for (size_t i = 0; i < s->count; i++)
        sum += fmin(s->weights[i] * vector_square(s->last - s->first, s->residuals + i * s->n + s->first), cut);
    return sum;
}

/// The components of a vector at a key.
static void to_frame(const smoother *s, size_t key, const double *vector, double *components)
{
    for (size_t k = 0; k < s->n; k++)
    {
        double sum = 0;
        for (size_t i = 0; s->frames != NULL && i < s->n; i++)
            sum += s->frames[(key * s->n + k) * s->n + i] * vector[i];
        components[k] = s->frames != NULL ? sum : vector[k];
    }
}

static void from_frame(const smoother *s, size_t key, const double *components, double *vector)
{
    for (size_t i = 0; i < s->n; i++)
    {
        double sum = 0;
        for (size_t k = 0; s->frames != NULL && k < s->n; k++)
            sum += s->frames[(key * s->n + k) * s->n + i] * components[k];
        vector[i] = s->frames != NULL ? sum : components[i];
    }
}

/// Frames, residuals and mean velocities of the motion.
static bat_status measure(smoother *s, bat_error *error)
{
    const bat_space *space = &s->f->space;
    double vector[BAT_SPACE_MAX_DIM];
    for (size_t k = 0; s->frames != NULL && k < s->n * s->n; k++)
        s->frames[k] = k % (s->n + 1) == 0 ? 1 : 0;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < s->count && status == BAT_OK; i++)
    {
        const double *p = s->points + i * s->dim, *q = p + s->dim;
        status = space->log(space, p, s->given + i * s->dim, vector);
        to_frame(s, i, vector, s->residuals + i * s->n);
        if (status != BAT_OK)
            return error_set(error, status, i, 0, "smoothing fails at point %zu, half a turn away from the motion", i);
        if (i + 1 == s->count)
            break;
        status = space->log(space, p, q, vector);
        to_frame(s, i, vector, s->chords + i * s->n);
        for (size_t k = 0; k < s->n; k++)
            s->chords[i * s->n + k] /= s->lengths[i];
        for (size_t k = 0; s->frames != NULL && k < s->n && status == BAT_OK; k++)
            status =
                space->transport(space, p, q, s->frames + (i * s->n + k) * s->n, s->frames + ((i + 1) * s->n + k) * s->n);
        if (status != BAT_OK)
            return error_set(error, status, i + 1, 0, "smoothing fails at point %zu: neighbours are half a turn apart",
                             i + 1);
    }
    return status;
}

/// The second difference Q^T at inner key j as numbers for the keys j - 1, j and j + 1.
static void difference(const smoother *s, size_t j, double q[3])
{
    q[0] = 1 / s->lengths[j - 1];
    q[2] = 1 / s->lengths[j];
    q[1] = -q[0] - q[2];
}

/// Factor R + weight Q^T W^-1 Q, with R weighted by the activity, as L D L^T: bands have D, and L one and two below the
/// diagonal.
static void factor_system(smoother *s, double weight)
{
    for (size_t j = 1; j + 1 < s->count; j++)
    {
        double q[3], next[3] = {0}, second[3] = {0}, row[3];
        const double *w = s->weights + j;
        difference(s, j, q);
        if (j + 2 < s->count)
            difference(s, j + 1, next);
        if (j + 3 < s->count)
            difference(s, j + 2, second);
        row[0] = (s->lengths[j - 1] * s->activity[j - 1] + s->lengths[j] * s->activity[j]) / 3 +
                 weight * (q[0] * q[0] / w[-1] + q[1] * q[1] / w[0] + q[2] * q[2] / w[1]);
        row[1] = j + 2 < s->count
                     ? s->lengths[j] * s->activity[j] / 6 + weight * (q[1] * next[0] / w[0] + q[2] * next[1] / w[1])
                     : 0;
        row[2] = weight * q[2] * second[0] / w[1];
        double *band = s->bands + 3 * j;
        if (j > 1)
        {
            row[0] -= band[-3] * band[-2] * band[-2];
            row[1] -= band[-3] * band[-2] * band[-1];
        }
        if (j > 2)
            row[0] -= band[-6] * band[-4] * band[-4];
        band[0] = row[0];
        band[1] = row[1] / row[0];
        band[2] = row[2] / row[0];
    }
}

/// Solve for the accelerations, from the second differences of the measurements.
static void solve(smoother *s)
{
    size_t n = s->n, last = s->count - 2;
    for (size_t j = 1; j <= last; j++)
    {
        double q[3];
        difference(s, j, q);
        for (size_t k = s->first; k < s->last; k++)
        {
            const double *r = s->residuals + j * n + k, *c = s->chords + j * n + k;
            double bend = c[0] - c[-(ptrdiff_t)n] + q[0] * r[-(ptrdiff_t)n] + q[1] * r[0] + q[2] * r[n];
            if (j > 1)
                bend -= s->bands[3 * (j - 1) + 1] * s->bends[(j - 1) * n + k];
            if (j > 2)
                bend -= s->bands[3 * (j - 2) + 2] * s->bends[(j - 2) * n + k];
            s->bends[j * n + k] = bend;
        }
    }
    for (size_t j = last; j >= 1; j--)
        for (size_t k = s->first; k < s->last; k++)
        {
            const double *band = s->bands + 3 * j;
            double bend = s->bends[j * n + k] / band[0];
            if (j + 1 <= last)
                bend -= band[1] * s->bends[(j + 1) * n + k];
            if (j + 2 <= last)
                bend -= band[2] * s->bends[(j + 2) * n + k];
            s->bends[j * n + k] = bend;
        }
}

/// Move the points by r - weight W^-1 Q a. `*largest` receives the longest step.
static bat_status move(smoother *s, double weight, double *largest)
{
    const bat_space *space = &s->f->space;
    size_t n = s->n;
    bat_status status = BAT_OK;
    *largest = 0;
    for (size_t i = 0; i < s->count && status == BAT_OK; i++)
    {
        double step[BAT_SPACE_MAX_DIM] = {0}, vector[BAT_SPACE_MAX_DIM], moved[BAT_SPACE_MAX_DIM];
        const double *bend = s->bends + i * n;
        for (size_t k = s->first; k < s->last; k++)
        {
            double turned = 0;
            if (i + 1 < s->count)
                turned += (bend[n + k] - bend[k]) / s->lengths[i];
            if (i > 0)
                turned -= (bend[k] - bend[(ptrdiff_t)k - (ptrdiff_t)n]) / s->lengths[i - 1];
            step[k] = s->residuals[i * n + k] - weight * turned / s->weights[i];
        }
        *largest = fmax(*largest, sqrt(vector_square(n, step)));
        from_frame(s, i, step, vector);
        status = space->exp(space, s->points + i * s->dim, vector, moved);
        memcpy(s->points + i * s->dim, moved, s->dim * sizeof *moved);
    }
    return status;
}

bat_status smoother_fit(smoother *s, double weight, double accuracy, bat_error *error)
{
    bat_status status = measure(s, error);
    double largest = INFINITY;
    factor_system(s, weight);
    for (int step = 0; step < MAX_STEPS && status == BAT_OK && largest > accuracy * s->scale; step++)
    {
        solve(s);
        status = move(s, weight, &largest);
        status = status == BAT_OK ? measure(s, error)
                                  : error_set(error, status, BAT_NO_INDEX, 0, "smoothing fails; sigma is too large");
        if (s->f->kind == FACTOR_FLAT)
            break;
    }
    return status;
}

/// The middle bands of the inverse of L D L^T, from the last row up (Hutchinson and de Hoog, Smoothing noisy data with
/// spline functions, 1985).
static void invert_bands(smoother *s)
{
    size_t last = s->count - 2;
    for (size_t j = last; j >= 1; j--)
    {
        const double *band = s->bands + 3 * j, *next = s->inverse + 3 * (j + 1), *second = next + 3;
        double *row = s->inverse + 3 * j;
        double one = j + 1 <= last ? band[1] : 0, two = j + 2 <= last ? band[2] : 0;
        row[1] = j + 1 <= last ? -one * next[0] - (two != 0 ? two * next[1] : 0) : 0;
        row[2] = j + 2 <= last ? -one * next[1] - two * second[0] : 0;
        row[0] = 1 / band[0] - one * row[1] - two * row[2];
    }
}

double smoother_influence(smoother *s, double weight)
{
    size_t last = s->count - 2;
    double sum = 0;
    invert_bands(s);
    for (size_t i = 0; i < s->count; i++)
    {
        // The key's numbers in the three second differences that it is part of.
        double q[3], c[3] = {0};
        for (size_t k = 0; k < 3; k++)
            if (i + k >= 2 && i + k - 1 <= last)
            {
                difference(s, i + k - 1, q);
                c[k] = q[2 - k];
            }
        double form = 0;
        for (size_t k = 0; k < 3; k++)
            for (size_t l = k; l < 3 && c[k] != 0; l++)
                form += (l > k ? 2 : 1) * c[k] * c[l] * (c[l] != 0 ? s->inverse[3 * (i + k - 1) + (l - k)] : 0);
        s->influence[i] = 1 - weight / s->weights[i] * form;
        sum += s->influence[i];
    }
    return sum;
}

bat_status smoother_begin(smoother *s, const spline_factor *f, size_t count, const double *lengths, const double *given,
                          bat_error *error)
{
    size_t dim = f->space.point_dim, n = f->space.tangent_dim;
    *s = (smoother){.f = f, .count = count, .dim = dim, .n = n, .last = n, .given = given};
    s->points = memory_pool_array(&s->pool, count, dim * sizeof(double));
    s->lengths = memory_pool_array(&s->pool, count, sizeof(double));
    s->activity = memory_pool_array(&s->pool, count, sizeof(double));
    s->frames = f->kind == FACTOR_ROTATION ? memory_pool_array(&s->pool, count, n * n * sizeof(double)) : NULL;
    s->residuals = memory_pool_zeros(&s->pool, count, n * sizeof(double));
    s->chords = memory_pool_array(&s->pool, count, n * sizeof(double));
    s->weights = memory_pool_array(&s->pool, count, sizeof(double));
    s->bends = memory_pool_zeros(&s->pool, count, n * sizeof(double));
    s->bands = memory_pool_array(&s->pool, count, 3 * sizeof(double));
    s->inverse = memory_pool_array(&s->pool, count + 2, 3 * sizeof(double));
    s->influence = memory_pool_array(&s->pool, count, sizeof(double));
    bat_status status = memory_pool_check(&s->pool, error);
    if (status != BAT_OK)
        return status;
    double total = 0, way = 0;
    for (size_t i = 0; i + 1 < count; i++)
    {
        total += lengths[i];
        way += f->space.distance(&f->space, given + i * dim, given + (i + 1) * dim);
    }
    s->scale = way > 0 ? 0.01 * way / (double)count : 1;
    for (size_t i = 0; i < count; i++)
    {
        s->lengths[i] = i + 1 < count ? lengths[i] / total * (double)(count - 1) : 0;
        s->activity[i] = s->weights[i] = 1;
    }
    memcpy(s->points, given, count * dim * sizeof *given);
    return BAT_OK;
}
