#include "research/analysis/eigen.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/blas.h"
#include "linalg/dense.h"
#include "linalg/vector.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Eigenvalues: Hessenberg form by Householder reflections, then Francis's implicit double-shift iteration to the real Schur
// form a = Q T Q^T, whose T has blocks of side 1 and, for complex pairs, 2 (Golub and Van Loan 2013,
// algorithms 5.1.1, 7.4.2, 7.5.1).

enum
{
    MAX_ITERATIONS = 100, ///< for one eigenvalue; four are usual
    EXCEPTIONAL = 10      ///< every so many iterations, other shifts break a cycle
};

/// A matrix T on its way to Schur form, and the product Q of all transformations; null where it is not wanted.
typedef struct schur
{
    size_t n;
    double *t, *q;
    double largest; ///< modulus of an entry of the matrix
} schur;

static bat_status no_convergence(bat_error *error)
{
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "a dense eigenvalue problem did not converge");
}

static double largest_modulus(size_t count, const double *numbers)
{
    double largest = 0;
    for (size_t i = 0; i < count; i++)
        largest = fmax(largest, fabs(numbers[i]));
    return largest;
}

/// The first `rows` rows of the columns `at` and on times a reflector.
static void reflect_columns(size_t n, double *a, size_t at, size_t m, const double *v, double beta, size_t rows)
{
    for (size_t i = 0; i < rows; i++)
    {
        double sum = 0, *row = a + i * n + at;
        for (size_t j = 0; j < m; j++)
            sum += row[j] * v[j];
        for (size_t j = 0; j < m; j++)
            row[j] -= beta * sum * v[j];
    }
}

/// T becomes H T H and Q becomes Q H. Columns before `from`, and rows from `rows` on, are zero where H acts.
static void reflect(const schur *s, size_t at, size_t m, const double *v, double beta, size_t from, size_t rows)
{
    dense_reflect_rows(s->n, s->t, at, m, v, beta, from);
    reflect_columns(s->n, s->t, at, m, v, beta, rows);
    if (s->q != NULL)
        reflect_columns(s->n, s->q, at, m, v, beta, s->n);
}

static void make_hessenberg(const schur *s, double *scratch)
{
    const size_t n = s->n;
    for (size_t k = 0; k + 2 < n; k++)
    {
        for (size_t i = k + 1; i < n; i++)
            scratch[i - k - 1] = s->t[i * n + k];
        double beta = dense_reflector(n - k - 1, scratch);
        reflect(s, k + 1, n - k - 1, scratch, beta, k, n);
        for (size_t i = k + 2; i < n; i++)
            s->t[i * n + k] = 0;
    }
}

/// One step of Francis on the block of rows low to high, three at least.
static void francis_step(const schur *s, size_t low, size_t high, bool exceptional)
{
    const size_t n = s->n;
    double *t = s->t;
    const double *last = t + (high - 1) * n + high - 1;
    double trace = last[0] + last[n + 1], determinant = last[0] * last[n + 1] - last[1] * last[n];
    if (exceptional)
    {
        double size = fabs(last[n]) + fabs(t[(high - 1) * n + high - 2]);
        trace = 1.5 * size;
        determinant = size * size;
    }
    const double *first = t + low * n + low;
    double v[3] = {first[0] * first[0] + first[1] * first[n] - trace * first[0] + determinant,
                   first[n] * (first[0] + first[n + 1] - trace), first[n] * first[2 * n + 1]};
    for (size_t k = low; k < high; k++)
    {
        size_t m = k + 1 < high ? 3 : 2;
        double beta = dense_reflector(m, v);
        reflect(s, k, m, v, beta, k > low ? k - 1 : low, k + 4 < high + 1 ? k + 4 : high + 1);
        for (size_t i = 0; i < 3; i++)
            v[i] = k + 1 + i <= high ? t[(k + 1 + i) * n + k] : 0;
        for (size_t i = 1; k > low && i < m; i++)
            t[(k + i) * n + k - 1] = 0;
    }
}

/// Make a block of side 2 with real eigenvalues triangular.
static void split_real_pair(const schur *s, size_t at)
{
    const size_t n = s->n;
    double *block = s->t + at * n + at;
    double half = (block[0] - block[n + 1]) / 2, square = half * half + block[1] * block[n];
    if (square < 0)
        return;
    // The eigenvector (x, y) of the eigenvalue that is farther from the second entry of the diagonal.
    double x = half + copysign(sqrt(square), half), y = block[n], length = hypot(x, y);
    x /= length;
    y /= length;
    for (size_t j = at; j < n; j++)
    {
        double *upper = s->t + at * n + j, first = upper[0], second = upper[n];
        upper[0] = x * first + y * second;
        upper[n] = x * second - y * first;
    }
    double *columns[] = {s->t, s->q};
    for (size_t c = 0; c < 2 && columns[c] != NULL; c++)
        for (size_t i = 0; i < (c == 0 ? at + 2 : n); i++)
        {
            double *row = columns[c] + i * n + at, first = row[0], second = row[1];
            row[0] = x * first + y * second;
            row[1] = x * second - y * first;
        }
    block[n] = 0;
}

/// The first row of the last block that does not fall apart; entries below the diagonal that are negligible become zero.
static size_t block_begin(const schur *s, size_t high)
{
    size_t low = high;
    for (; low > 0; low--)
    {
        double *entry = s->t + low * s->n + low;
        double size = fabs(entry[0]) + fabs(entry[-(ptrdiff_t)s->n - 1]);
        // Rounding has moved every entry by this much, whatever the entries beside it are.
        if (fabs(entry[-1]) <= DBL_EPSILON * fmax(size, DBL_EPSILON * s->largest))
        {
            entry[-1] = 0;
            break;
        }
    }
    return low;
}

/// From a matrix in t to its Schur form.
static bat_status make_schur(const schur *s, double *scratch, bat_error *error)
{
    if (!vector_is_finite(s->n * s->n, s->t))
        return no_convergence(error);
    for (size_t i = 0; s->q != NULL && i < s->n * s->n; i++)
        s->q[i] = i % (s->n + 1) == 0;
    make_hessenberg(s, scratch);
    size_t end = s->n; // rows from here on are finished
    for (int iteration = 1; end > 0; iteration++)
    {
        size_t low = block_begin(s, end - 1);
        if (end - low > 2)
        {
            if (iteration > MAX_ITERATIONS)
                return no_convergence(error);
            francis_step(s, low, end - 1, iteration % EXCEPTIONAL == 0);
            continue;
        }
        if (end - low == 2)
            split_real_pair(s, low);
        end = low;
        iteration = 0;
    }
    return BAT_OK;
}

static bool is_pair(const schur *s, size_t at)
{
    return at + 1 < s->n && s->t[(at + 1) * s->n + at] != 0;
}

static void read_eigenvalues(const schur *s, double *real, double *imaginary)
{
    for (size_t i = 0; i < s->n; i++)
    {
        const double *block = s->t + i * (s->n + 1);
        real[i] = block[0];
        imaginary[i] = 0;
        if (!is_pair(s, i))
            continue;
        double half = (block[0] - block[s->n + 1]) / 2;
        real[i] = real[i + 1] = (block[0] + block[s->n + 1]) / 2;
        imaginary[i] = sqrt(-(half * half + block[1] * block[s->n]));
        imaginary[i + 1] = -imaginary[i];
        i++;
    }
}

bat_status decompose_eigenvalues(size_t n, double *a, double *real, double *imaginary, bat_error *error)
{
    const schur s = {n, a, NULL, largest_modulus(n * n, a)};
    bat_status status = make_schur(&s, real, error);
    if (status == BAT_OK)
        read_eigenvalues(&s, real, imaginary);
    return status;
}

// Eigenvectors

/// A divisor that is not smaller than rounding, as T is known only up to that.
static double complex away_from_zero(double complex divisor, double rounding)
{
    return cabs(divisor) < rounding ? rounding : divisor;
}

/// Solve (T - value I) x = 0 for the rows above `row`, from the last to the first; entries of x from `row` on are given.
static void substitute_back(const schur *s, double complex value, size_t row, size_t end, double rounding, double complex *x)
{
    const size_t n = s->n;
    while (row > 0)
    {
        size_t side = row > 1 && is_pair(s, row - 2) ? 2 : 1;
        row -= side;
        double complex right[2] = {0, 0};
        for (size_t i = 0; i < side; i++)
            for (size_t j = row + side; j < end; j++)
                right[i] -= s->t[(row + i) * n + j] * x[j];
        const double *block = s->t + row * (n + 1);
        double complex first = block[0] - value;
        if (side == 1)
            x[row] = right[0] / away_from_zero(first, rounding);
        else
        {
            double complex second = block[n + 1] - value;
            double complex divisor = away_from_zero(first * second - block[1] * block[n], rounding * rounding);
            x[row] = (right[0] * second - block[1] * right[1]) / divisor;
            x[row + 1] = (first * right[1] - block[n] * right[0]) / divisor;
        }
        // Defective eigenvalues make entries grow without bound.
        double largest = 0;
        for (size_t j = row; j < end; j++)
            largest = fmax(largest, cabs(x[j]));
        for (size_t j = row; largest > 1e100 && j < end; j++)
            x[j] /= largest;
    }
}

/// The eigenvector of length 1 of the eigenvalue at a block: x is scratch, `vector` receives it.
static void find_vector(const schur *s, size_t at, double complex value, double rounding, double complex *x,
                        double complex *vector)
{
    const size_t n = s->n, end = at + (is_pair(s, at) ? 2 : 1);
    x[at] = 1;
    if (end == at + 2)
    {
        x[at] = s->t[at * n + at + 1];
        x[at + 1] = value - s->t[at * n + at];
    }
    substitute_back(s, value, at, end, rounding, x);
    double length = 0;
    for (size_t i = 0; i < n; i++)
    {
        vector[i] = 0;
        for (size_t j = 0; j < end; j++)
            vector[i] += s->q[i * n + j] * x[j];
        length = hypot(length, cabs(vector[i]));
    }
    for (size_t i = 0; i < n; i++)
        vector[i] /= length;
}

/// The inverse of a matrix by elimination with row exchanges; `a` is destroyed. That of a singular one has huge entries.
static void invert(size_t n, double *a, double *inverse)
{
    for (size_t i = 0; i < n * n; i++)
        inverse[i] = i % (n + 1) == 0;
    for (size_t k = 0; k < n; k++)
    {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++)
            if (fabs(a[i * n + k]) > fabs(a[pivot * n + k]))
                pivot = i;
        for (size_t j = 0; j < n; j++)
        {
            double upper = a[k * n + j], lower = inverse[k * n + j];
            a[k * n + j] = a[pivot * n + j];
            a[pivot * n + j] = upper;
            inverse[k * n + j] = inverse[pivot * n + j];
            inverse[pivot * n + j] = lower;
        }
        double divisor = a[k * n + k] != 0 ? a[k * n + k] : DBL_EPSILON * DBL_EPSILON;
        for (size_t i = 0; i < n; i++)
        {
            double factor = i != k ? a[i * n + k] / divisor : 0;
            for (size_t j = 0; j < n; j++)
            {
                a[i * n + j] -= factor * a[k * n + j];
                inverse[i * n + j] -= factor * inverse[k * n + j];
            }
        }
        for (size_t j = 0; j < n; j++)
        {
            a[k * n + j] /= divisor;
            inverse[k * n + j] /= divisor;
        }
    }
}

/// With right eigenvectors of length 1 as columns of X, row i of the inverse of X is a left eigenvector, and the cosine
/// between the two is 1 over its length. For a pair the columns are real and imaginary part.
static void find_cosines(size_t n, const double *imaginary, const double *inverse, double *cosine)
{
    for (size_t i = 0; i < n; i++)
    {
        double square = 0;
        size_t side = imaginary[i] > 0 && i + 1 < n ? 2 : 1;
        for (size_t j = 0; j < side * n; j++)
            square += inverse[i * n + j] * inverse[i * n + j];
        cosine[i] = (double)side / sqrt(square);
        if (side == 2)
            cosine[i + 1] = cosine[i];
        i += side - 1;
    }
}

static void find_vectors(const schur *s, const double *real, const double *imaginary, double complex *scratch, double *right)
{
    const size_t n = s->n;
    const double rounding = fmax(DBL_EPSILON * s->largest, DBL_MIN / DBL_EPSILON);
    double complex *vector = scratch + n;
    for (size_t k = 0; k < n; k++)
    {
        const bool pair = imaginary[k] > 0;
        find_vector(s, k, real[k] + imaginary[k] * I, rounding, scratch, vector);
        for (size_t i = 0; i < n; i++)
        {
            right[i * n + k] = creal(vector[i]);
            if (pair)
                right[i * n + k + 1] = cimag(vector[i]);
        }
        k += pair;
    }
}

bat_status decompose_eigenvectors(size_t n, double *a, double *real, double *imaginary, double *right, double *cosine,
                                  bat_error *error)
{
    double *q = memory_array(2 * n * n, sizeof *q);
    double complex *scratch = memory_array(2 * n, sizeof *scratch);
    bat_status status = BAT_OK;
    if (q == NULL || scratch == NULL)
        status = error_memory(error, 2 * n * (n + 2) * sizeof *q);
    const schur s = {n, a, q, largest_modulus(n * n, a)};
    if (status == BAT_OK)
        status = make_schur(&s, real, error);
    if (status == BAT_OK)
    {
        read_eigenvalues(&s, real, imaginary);
        find_vectors(&s, real, imaginary, scratch, right);
        memcpy(a, right, n * n * sizeof *a);
        invert(n, a, q + n * n);
        find_cosines(n, imaginary, q + n * n, cosine);
    }
    free(scratch);
    free(q);
    return status;
}

// Singular values by Hestenes's one-sided Jacobi method: rotations of its columns make them orthogonal, a V = U
// diag(values). The matrices are small, and small singular values come out to full relative accuracy. LAPACK's zgesvd() is
// not used: under OpenBLAS 0.3.21 its zgemv kernel for Cooperlake reads beyond the matrix. Columns are contiguous here.

static const int MAX_SWEEPS = 60;

/// Rotate two columns of two matrices so that those of `a` become orthogonal; false where they are, or one is too short.
static bool rotate_pair(size_t n, double rounding, double complex *a, double complex *v, size_t p, size_t q)
{
    double p_square = 0, q_square = 0;
    double complex product = 0;
    for (size_t i = 0; i < n; i++)
    {
        double complex x = a[p * n + i], y = a[q * n + i];
        p_square += creal(x) * creal(x) + cimag(x) * cimag(x);
        q_square += creal(y) * creal(y) + cimag(y) * cimag(y);
        product += conj(x) * y;
    }
    double size = cabs(product);
    if (!(size > (double)n * DBL_EPSILON * sqrt(p_square * q_square)) || sqrt(fmin(p_square, q_square)) <= rounding)
        return false;
    double ratio = (q_square - p_square) / (2 * size);
    double tangent = copysign(1, ratio) / (fabs(ratio) + hypot(1, ratio)), cosine = 1 / hypot(1, tangent);
    double complex phase = conj(product) / size;
    double complex *matrices[] = {a, v};
    for (size_t m = 0; m < 2; m++)
        for (size_t i = 0; i < n; i++)
        {
            double complex x = matrices[m][p * n + i], y = matrices[m][q * n + i] * phase;
            matrices[m][p * n + i] = cosine * (x - tangent * y);
            matrices[m][q * n + i] = cosine * (tangent * x + y);
        }
    return true;
}

/// The columns' lengths in descending order, and with each the column of V.
static void read_singular(size_t n, const double complex *a, const double complex *v, double *values, double *adjoint)
{
    for (size_t k = 0; k < n; k++)
    {
        double length = 0;
        for (size_t i = 0; i < n; i++)
            length = hypot(length, cabs(a[k * n + i]));
        size_t place = k;
        for (; place > 0 && values[place - 1] < length; place--)
        {
            values[place] = values[place - 1];
            memcpy(adjoint + 2 * n * place, adjoint + 2 * n * (place - 1), 2 * n * sizeof *adjoint);
        }
        values[place] = length;
        for (size_t i = 0; i < n; i++)
        {
            adjoint[2 * (n * place + i)] = creal(v[k * n + i]);
            adjoint[2 * (n * place + i) + 1] = -cimag(v[k * n + i]);
        }
    }
}

bat_status decompose_singular(size_t n, double *a, double *values, double *adjoint, bat_error *error)
{
    double complex *columns = memory_array(2 * n * n, sizeof *columns), *v = columns + n * n;
    if (columns == NULL)
        return error_memory(error, 2 * n * n * sizeof *columns);
    for (size_t i = 0; i < n * n; i++)
    {
        columns[i % n * n + i / n] = a[2 * i] + a[2 * i + 1] * I;
        v[i] = i % (n + 1) == 0;
    }
    double largest = 0;
    for (size_t i = 0; i < 2 * n * n; i++)
        largest = fmax(largest, fabs(a[i]));
    const double rounding = DBL_EPSILON * largest;
    bool turned = true;
    int sweep = 0;
    for (; turned && sweep < MAX_SWEEPS; sweep++)
    {
        turned = false;
        for (size_t p = 0; p + 1 < n; p++)
            for (size_t q = p + 1; q < n; q++)
                turned = rotate_pair(n, rounding, columns, v, p, q) || turned;
    }
    read_singular(n, columns, v, values, adjoint);
    free(columns);
    bool finite = isfinite(largest);
    for (size_t k = 0; k < n; k++)
        finite = finite && isfinite(values[k]);
    return !turned && finite
               ? BAT_OK
               : error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the singular values of a matrix did not converge");
}
