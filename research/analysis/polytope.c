#include "research/analysis/joint_radius.h"

#include "base/error.h"
#include "linalg/blas.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// A vertex enters the basis when it improves the objective by more than this share.
#define PRICE_TOLERANCE 1e-13
/// Entries of the entering column below this share of its largest are no pivots.
#define PIVOT_TOLERANCE 1e-10
/// A residual so many times larger than a fresh basis would leave calls for a fresh basis.
#define DRIFT_LIMIT 100.0

/// Room within `scratch`, each of `dimension` numbers, then `capacity` prices.
typedef struct simplex
{
    double *coefficient; ///< of the basis vertices: x = sum coefficient_i v_i
    double *sign;        ///< of each coefficient, kept where it is zero
    double *dual;        ///< the linear form that is 1 at every sign_i v_i
    double *column;      ///< the entering vertex in terms of the basis
    double *price;       ///< the dual at every vertex
} simplex;

static simplex simplex_of(const polytope *p)
{
    const size_t n = p->dimension;
    return (simplex){.coefficient = p->scratch,
                     .sign = p->scratch + n,
                     .dual = p->scratch + 2 * n,
                     .column = p->scratch + 3 * n,
                     .price = p->scratch + 4 * n};
}

/// Return to the basis of the multiples of the unit vectors.
static void reset_basis(polytope *p)
{
    const size_t n = p->dimension;
    memset(p->inverse, 0, n * n * sizeof *p->inverse);
    for (size_t i = 0; i < n; i++)
    {
        p->basis[i] = i;
        p->inverse[i * n + i] = 1.0 / p->vertices[i * n + i];
    }
}

static void polytope_free(polytope *p)
{
    memory_pool_free(&p->pool);
    *p = (polytope){0};
}

/// The hull of +-radius e_j, with room for `capacity` vertices in all.
static bat_status polytope_make(size_t dimension, size_t capacity, double radius, polytope *result, bat_error *error)
{
    const size_t n = dimension;
    if (capacity < n)
        capacity = n;
    *result = (polytope){.dimension = n, .count = n, .capacity = capacity};
    result->vertices = memory_pool_array(&result->pool, capacity * n, sizeof *result->vertices);
    result->basis = memory_pool_array(&result->pool, n, sizeof *result->basis);
    result->inverse = memory_pool_array(&result->pool, n * n, sizeof *result->inverse);
    result->scratch = memory_pool_array(&result->pool, 4 * n + capacity, sizeof *result->scratch);
    bat_status status = memory_pool_check(&result->pool, error);
    if (status != BAT_OK)
    {
        polytope_free(result);
        return status;
    }
    memset(result->vertices, 0, n * n * sizeof *result->vertices);
    for (size_t i = 0; i < n; i++)
        result->vertices[i * n + i] = radius;
    reset_basis(result);
    return BAT_OK;
}

/// Add a vertex; false when there is no more room.
static bool polytope_add(polytope *p, const double *vertex)
{
    if (p->count == p->capacity)
        return false;
    memcpy(p->vertices + p->count * p->dimension, vertex, p->dimension * sizeof *vertex);
    ++p->count;
    return true;
}

/// The vertex whose price has the largest modulus, for the present signs.
static size_t price_vertices(const polytope *p, const simplex *s)
{
    const int n = (int)p->dimension;
    cblas_dgemv(CblasRowMajor, CblasTrans, n, n, 1.0, p->inverse, n, s->sign, 1, 0.0, s->dual, 1);
    cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)p->count, n, 1.0, p->vertices, n, s->dual, 1, 0.0, s->price, 1);
    size_t best = 0;
    for (size_t v = 1; v < p->count; v++)
        if (fabs(s->price[v]) > fabs(s->price[best]))
            best = v;
    return best;
}

/// Which basis vertex leaves when vertex `entering` comes in. The objective is convex and piecewise linear along the way;
/// the walk passes the coefficients that change sign until its slope turns.
/// @return the position in the basis, or `dimension` when no pivot is safe
static size_t choose_leaving(const polytope *p, const simplex *s, size_t entering)
{
    const size_t n = p->dimension;
    const double direction = copysign(1.0, s->price[entering]);
    cblas_dgemv(CblasRowMajor, CblasNoTrans, (int)n, (int)n, direction, p->inverse, (int)n, p->vertices + entering * n, 1,
                0.0, s->column, 1);
    double smallest_pivot = 0.0;
    for (size_t i = 0; i < n; i++)
        smallest_pivot = fmax(smallest_pivot, PIVOT_TOLERANCE * fabs(s->column[i]));

    double slope = 1.0 - fabs(s->price[entering]);
    while (slope < 0.0)
    {
        size_t next = n;
        double nearest = HUGE_VAL;
        for (size_t i = 0; i < n; i++)
        {
            const double speed = s->sign[i] * s->column[i];
            if (speed <= smallest_pivot)
                continue;
            const double distance = fmax(0.0, s->sign[i] * s->coefficient[i]) / speed;
            if (distance < nearest)
            {
                nearest = distance;
                next = i;
            }
        }
        if (next == n)
            return n;
        slope += 2.0 * fabs(s->column[next]);
        if (slope >= 0.0)
            return next;
        s->sign[next] = -s->sign[next];
    }
    return n;
}

static void pivot(polytope *p, const simplex *s, size_t entering, size_t leaving)
{
    const size_t n = p->dimension;
    double *row = p->inverse + leaving * n;
    cblas_dscal((int)n, copysign(1.0, s->price[entering]) / s->column[leaving], row, 1);
    for (size_t i = 0; i < n; i++)
        if (i != leaving)
            cblas_daxpy((int)n, -copysign(1.0, s->price[entering]) * s->column[i], row, 1, p->inverse + i * n, 1);
    p->basis[leaving] = entering;
}

/// Coefficients of x in the basis, their signs, and the sum of their moduli.
static double represent(const polytope *p, const double *x, const simplex *s)
{
    const int n = (int)p->dimension;
    cblas_dgemv(CblasRowMajor, CblasNoTrans, n, n, 1.0, p->inverse, n, x, 1, 0.0, s->coefficient, 1);
    double sum = 0.0;
    for (size_t i = 0; i < p->dimension; i++)
    {
        s->sign[i] = s->coefficient[i] < 0.0 ? -1.0 : 1.0;
        sum += fabs(s->coefficient[i]);
    }
    return sum;
}

static double minimize(polytope *p, const double *x, const simplex *s, double enough)
{
    const size_t n = p->dimension;
    const size_t limit = 20 + 8 * n;
    double sum = represent(p, x, s);
    for (size_t step = 0; step < limit && sum > enough; step++)
    {
        const size_t entering = price_vertices(p, s);
        if (fabs(s->price[entering]) <= 1.0 + PRICE_TOLERANCE)
            break;
        const size_t leaving = choose_leaving(p, s, entering);
        if (leaving == n)
            break;
        pivot(p, s, entering, leaving);
        sum = represent(p, x, s);
    }
    return sum;
}

/// The mismatch between x and its representation, and what rounding may hide of it, measured in the norm: each entry is a
/// multiple of a unit vector, whose norm is at most 1 / radius.
typedef struct mismatch
{
    double residual;
    double rounding;
} mismatch;

static mismatch representation_mismatch(const polytope *p, const double *x, const double *uncertainty, const simplex *s)
{
    const size_t n = p->dimension;
    const double share = (double)(n + 4) * DBL_EPSILON;
    mismatch norm = {0.0, 0.0};
    for (size_t j = 0; j < n; j++)
    {
        double residual = x[j];
        double size = fabs(x[j]);
        for (size_t i = 0; i < n; i++)
        {
            const double term = s->coefficient[i] * p->vertices[p->basis[i] * n + j];
            residual -= term;
            size += fabs(term);
        }
        const double radius = p->vertices[j * n + j];
        norm.residual += fabs(residual) / radius;
        norm.rounding += (share * size + uncertainty[j]) / radius;
    }
    return norm;
}

/// An upper bound of the norm of every vector within `uncertainty` (entry by entry) of `x`, valid whatever rounding did, and
/// equal to the norm of `x` but for rounding, unless the norm is at most `enough`: then the bound is at most `enough` too,
/// but for rounding, and the search ends early.
///
/// norm(x) = min { sum |c_i| : x = sum c_i v_i }, by the primal simplex method with long steps.
static double polytope_norm(polytope *p, const double *x, const double *uncertainty, double enough)
{
    const simplex s = simplex_of(p);
    double sum = minimize(p, x, &s, enough);
    mismatch m = representation_mismatch(p, x, uncertainty, &s);
    if (!(m.residual <= DRIFT_LIMIT * m.rounding))
    {
        reset_basis(p);
        sum = minimize(p, x, &s, enough);
        m = representation_mismatch(p, x, uncertainty, &s);
    }
    return (sum + m.residual + m.rounding) * (1.0 + (double)(p->dimension + 4) * DBL_EPSILON);
}

// Growth

/// Unit vectors are added at this size, so that the polytope has an interior whatever the seeds; seeds have largest entry 1.
#define UNIT_RADIUS 0x1p-8
/// An image with a norm up to this counts as inside.
#define INSIDE (1.0 + 1e-11)

bat_status polytope_growth_make(const matrix_set *set, double rate, const double *seeds, size_t seed_count, size_t capacity,
                                polytope_growth *growth, bat_error *error)
{
    const size_t n = set->dimension;
    *growth = (polytope_growth){.set = set, .rate = rate};
    if (capacity < n + seed_count)
        capacity = n + seed_count;
    const bat_status status = polytope_make(n, capacity, UNIT_RADIUS, &growth->hull, error);
    for (size_t i = 0; status == BAT_OK && i < seed_count; i++)
        polytope_add(&growth->hull, seeds + i * n);
    return status;
}

void polytope_growth_free(polytope_growth *growth)
{
    polytope_free(&growth->hull);
}

/// The image of a vertex: its norm and its number.
typedef struct image
{
    double norm;
    size_t index;
} image;

static int compare_images(const void *left, const void *right)
{
    const image *a = left;
    const image *b = right;
    if (a->norm != b->norm)
        return a->norm < b->norm ? 1 : -1;
    return a->index < b->index ? -1 : a->index > b->index;
}

/// image = matrix vertex / rate, with a bound of the rounding in every entry.
static void map_vertex(size_t n, const double *matrix, const double *vertex, double rate, double *mapped,
                       double *uncertainty)
{
    for (size_t i = 0; i < n; i++)
    {
        double sum = 0.0, size = 0.0;
        for (size_t j = 0; j < n; j++)
        {
            const double term = matrix[i * n + j] * vertex[j];
            sum += term;
            size += fabs(term);
        }
        mapped[i] = sum / rate;
        uncertainty[i] = (double)(n + 3) * DBL_EPSILON * size / rate;
    }
}

/// Map the frontier: image (v, m) is number v * count + m.
static void measure_images(polytope_growth *growth, size_t vertex_count, image *images, double *vectors)
{
    const matrix_set *set = growth->set;
    const size_t n = set->dimension;
    for (size_t index = 0; index < vertex_count * set->count; index++)
    {
        const double *vertex = growth->hull.vertices + (growth->frontier + index / set->count) * n;
        double *mapped = vectors + 2 * index * n;
        map_vertex(n, matrix_set_at(set, index % set->count), vertex, growth->rate, mapped, mapped + n);
        images[index] = (image){polytope_norm(&growth->hull, mapped, mapped + n, 1.0), index};
    }
}

/// Add the images outside, the farthest first: one may take others inside.
static void add_images(polytope_growth *growth, const image *images, size_t count, const double *vectors)
{
    const size_t n = growth->set->dimension;
    for (size_t i = 0; i < count; i++)
    {
        if (images[i].norm <= INSIDE)
        {
            growth->largest_inside = fmax(growth->largest_inside, images[i].norm);
            continue;
        }
        const double *vector = vectors + 2 * images[i].index * n;
        const double norm = polytope_norm(&growth->hull, vector, vector + n, 1.0);
        if (norm <= INSIDE)
            growth->largest_inside = fmax(growth->largest_inside, norm);
        else if (polytope_add(&growth->hull, vector))
            growth->largest_inside = fmax(growth->largest_inside, 1.0);
        else
            growth->full = true;
    }
}

bat_status polytope_growth_round(polytope_growth *growth, double *bound, bool *closed, bat_error *error)
{
    const size_t vertex_count = growth->hull.count - growth->frontier;
    const size_t count = vertex_count * growth->set->count;
    const size_t n = growth->set->dimension;
    image *images = memory_array(count, sizeof *images);
    double *vectors = memory_array(count, 2 * n * sizeof *vectors);
    if (images == NULL || vectors == NULL)
    {
        free(images);
        free(vectors);
        return error_memory(error, count * 2 * n * sizeof *vectors);
    }
    const size_t old_count = growth->hull.count;
    measure_images(growth, vertex_count, images, vectors);
    qsort(images, count, sizeof *images, compare_images);
    const double farthest = count > 0 ? images[0].norm : 0.0;
    *closed = farthest <= INSIDE;
    *bound = growth->rate * fmax(growth->largest_inside, farthest) * (1.0 + 4.0 * DBL_EPSILON);
    add_images(growth, images, count, vectors);
    growth->frontier = old_count;
    free(images);
    free(vectors);
    return BAT_OK;
}
