// The decompositions by which matrices are analysed: what they give is put together again.

#include "check.h"

#include "linalg/dense.h"
#include "research/analysis/eigen.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum
{
    MAX_SIDE = 24,
    MAX_NUMBERS = MAX_SIDE * MAX_SIDE
};

/// How far a product may be off, relative to the largest entry and the side.
static const double ACCURACY = 1e-13;

/// Matrices of each kind that analyses of masks meet: without structure, with zero rows, nilpotent, with repeated
/// eigenvalues.
typedef enum matrix_kind
{
    RANDOM,
    SINGULAR,
    ROTATION, ///< all eigenvalues are complex but for one of an odd side
    SYMMETRIC,
    SCALED_IDENTITY,
    KINDS
} matrix_kind;

static void make_matrix(matrix_kind kind, size_t n, bat_random *random, double *a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
        {
            double number = bat_random_normal(random);
            a[i * n + j] = kind == SINGULAR && i % 2 == 1 ? 0 : number;
            if (kind == SYMMETRIC && j < i)
                a[i * n + j] = a[j * n + i];
            if (kind == ROTATION)
                a[i * n + j] = (j == (i + 1) % n) ? (i + 1 < n ? 1 : -1) : 0;
            if (kind == SCALED_IDENTITY)
                a[i * n + j] = i == j ? -3 : 0;
        }
}

static double largest_entry(size_t count, const double *a)
{
    double largest = 0;
    for (size_t i = 0; i < count; i++)
        largest = fmax(largest, fabs(a[i]));
    return largest;
}

/// a (x + i y) = (real + i imaginary) (x + i y), where x and y are columns of packed eigenvectors.
static void check_vector(size_t n, const double *a, double real, double imaginary, const double *right, size_t column)
{
    double tolerance = ACCURACY * (double)n * largest_entry(n * n, a), length = 0;
    for (size_t i = 0; i < n; i++)
    {
        double x = right[i * n + column], y = imaginary > 0 ? right[i * n + column + 1] : 0, image_x = 0, image_y = 0;
        for (size_t j = 0; j < n; j++)
        {
            image_x += a[i * n + j] * right[j * n + column];
            image_y += imaginary > 0 ? a[i * n + j] * right[j * n + column + 1] : 0;
        }
        assert_true(fabs(image_x - (real * x - imaginary * y)) <= tolerance);
        assert_true(fabs(image_y - (real * y + imaginary * x)) <= tolerance);
        length += x * x + y * y;
    }
    assert_true(fabs(length - 1) < 1e-12);
}

static void eigenvectors_stay_on_their_lines(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(1);
    double a[MAX_NUMBERS], copy[MAX_NUMBERS], right[MAX_NUMBERS], real[MAX_SIDE], imaginary[MAX_SIDE], cosine[MAX_SIDE];
    for (size_t n = 1; n <= MAX_SIDE; n++)
        for (matrix_kind kind = RANDOM; kind < KINDS; kind++)
        {
            make_matrix(kind, n, &random, a);
            memcpy(copy, a, n * n * sizeof *a);
            check_status(decompose_eigenvectors(n, copy, real, imaginary, right, cosine, NULL), BAT_OK);
            double trace = 0;
            for (size_t i = 0; i < n; i++)
            {
                trace += a[i * (n + 1)] - real[i];
                assert_true(kind == SINGULAR || (cosine[i] > 0 && cosine[i] < 1 + 1e-9));
                if (kind == SYMMETRIC || kind == SCALED_IDENTITY)
                    assert_true(fabs(cosine[i] - 1) < 1e-9);
                check_vector(n, a, real[i], fmax(imaginary[i], 0), right, i);
                if (imaginary[i] == 0)
                    continue;
                assert_true(imaginary[i] > 0 && imaginary[i + 1] == -imaginary[i] && real[i + 1] == real[i]);
                assert_true(cosine[i + 1] == cosine[i]);
                trace += a[(i + 1) * (n + 1)] - real[i + 1];
                i++;
            }
            assert_true(fabs(trace) <= ACCURACY * (double)(n * n) * largest_entry(n * n, a));
        }
}

static void eigenvalues_are_those_of_the_vectors(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(2);
    double a[MAX_NUMBERS], copy[MAX_NUMBERS], right[MAX_NUMBERS], cosine[MAX_SIDE];
    double real[2][MAX_SIDE], imaginary[2][MAX_SIDE];
    for (size_t n = 1; n <= MAX_SIDE; n++)
    {
        make_matrix(RANDOM, n, &random, a);
        memcpy(copy, a, n * n * sizeof *a);
        check_status(decompose_eigenvectors(n, copy, real[0], imaginary[0], right, cosine, NULL), BAT_OK);
        memcpy(copy, a, n * n * sizeof *a);
        check_status(decompose_eigenvalues(n, copy, real[1], imaginary[1], NULL), BAT_OK);
        for (size_t i = 0; i < n; i++)
        {
            double nearest = INFINITY;
            for (size_t j = 0; j < n; j++)
                nearest = fmin(nearest, hypot(real[0][i] - real[1][j], imaginary[0][i] - imaginary[1][j]));
            assert_true(nearest <= 1e-12 / cosine[i]);
        }
    }
}

/// A Jordan block has one eigenvector, orthogonal to the left one; a nilpotent matrix has no other eigenvalue than 0.
static void defective_matrices_are_told(void **state)
{
    (void)state;
    double a[16] = {0}, real[4], imaginary[4], right[16], cosine[4];
    for (size_t i = 0; i < 3; i++)
        a[i * 4 + i + 1] = 1;
    check_status(decompose_eigenvectors(4, a, real, imaginary, right, cosine, NULL), BAT_OK);
    for (size_t i = 0; i < 4; i++)
    {
        assert_true(hypot(real[i], imaginary[i]) < 1e-3);
        assert_true(!(cosine[i] > 1e-6));
    }
    // Nilpotent too, but in no order that shows it.
    double shift[9] = {1, 1, 1, -1, -1, -1, 1, 1, 0};
    check_status(decompose_eigenvalues(3, shift, real, imaginary, NULL), BAT_OK);
    double product = 1;
    for (size_t i = 0; i < 3; i++)
        product *= hypot(real[i], imaginary[i]);
    assert_true(product < 1e-12);
    double bad[4] = {1, NAN, 0, 1};
    check_status(decompose_eigenvalues(2, bad, real, imaginary, NULL), BAT_NO_CONVERGENCE);
}

/// The columns of a V are orthogonal and as long as the singular values.
static void singular_vectors_have_orthogonal_images(void **state)
{
    (void)state;
    static double a[2 * MAX_NUMBERS], copy[2 * MAX_NUMBERS], adjoint[2 * MAX_NUMBERS], images[2 * MAX_NUMBERS];
    double values[MAX_SIDE];
    bat_random random = bat_random_seed(3);
    for (size_t n = 1; n <= MAX_SIDE; n++)
    {
        for (size_t i = 0; i < 2 * n * n; i++)
            a[i] = i / (2 * n) % 3 == 2 ? 0 : bat_random_normal(&random); // every third row is zero
        memcpy(copy, a, 2 * n * n * sizeof *a);
        check_status(decompose_singular(n, copy, values, adjoint, NULL), BAT_OK);
        // images[i, k] = sum_j a[i, j] conj(adjoint[k, j])
        for (size_t i = 0; i < n; i++)
            for (size_t k = 0; k < n; k++)
            {
                double *image = images + 2 * (i * n + k);
                image[0] = image[1] = 0;
                for (size_t j = 0; j < n; j++)
                {
                    const double *x = a + 2 * (i * n + j), *v = adjoint + 2 * (k * n + j);
                    image[0] += x[0] * v[0] + x[1] * v[1];
                    image[1] += x[1] * v[0] - x[0] * v[1];
                }
            }
        for (size_t k = 0; k < n; k++)
            for (size_t l = 0; l < n; l++)
            {
                double real = 0, imaginary = 0;
                for (size_t i = 0; i < n; i++)
                {
                    const double *x = images + 2 * (i * n + k), *y = images + 2 * (i * n + l);
                    real += x[0] * y[0] + x[1] * y[1];
                    imaginary += x[0] * y[1] - x[1] * y[0];
                }
                double expected = k == l ? values[k] * values[k] : 0;
                assert_true(hypot(real - expected, imaginary) <= 1e-12 * (double)n * (1 + values[0] * values[0]));
                assert_true(l == 0 || values[l] <= values[l - 1]);
            }
    }
}

static void residuals_are_orthogonal_to_columns(void **state)
{
    (void)state;
    double a[(MAX_SIDE + 1) * MAX_SIDE], copy[(MAX_SIDE + 1) * MAX_SIDE], b[MAX_SIDE + 1], x[MAX_SIDE + 1];
    bat_random random = bat_random_seed(4);
    for (size_t n = 1; n <= MAX_SIDE; n++)
    {
        for (size_t i = 0; i < (n + 1) * n; i++)
            copy[i] = a[i] = bat_random_normal(&random);
        for (size_t i = 0; i <= n; i++)
            x[i] = b[i] = bat_random_normal(&random);
        check_status(decompose_least_squares(n + 1, n, copy, x, NULL), BAT_OK);
        for (size_t i = 0; i <= n; i++)
            for (size_t j = 0; j < n; j++)
                b[i] -= a[i * n + j] * x[j];
        for (size_t j = 0; j < n; j++)
        {
            double product = 0;
            for (size_t i = 0; i <= n; i++)
                product += a[i * n + j] * b[i];
            assert_true(fabs(product) < 1e-10);
        }
    }
}

/// Systems of less than a block, of a block and of several; and a singular one.
static void systems_are_solved(void **state)
{
    (void)state;
    static const size_t sides[] = {1, 2, 47, 48, 49, 150};
    bat_random random = bat_random_seed(6);
    for (size_t s = 0; s < sizeof sides / sizeof *sides; s++)
    {
        size_t n = sides[s];
        double *a = malloc(n * n * sizeof *a), *copy = malloc(n * n * sizeof *copy), *x = malloc(2 * n * sizeof *x),
               *b = malloc(2 * n * sizeof *b);
        assert_true(a != NULL && copy != NULL && x != NULL && b != NULL);
        for (size_t i = 0; i < n * n; i++)
            copy[i] = a[i] = bat_random_normal(&random);
        for (size_t i = 0; i < 2 * n; i++)
            x[i] = b[i] = bat_random_normal(&random);
        check_status(decompose_solve(n, 2, copy, x, NULL), BAT_OK);
        for (size_t i = 0; i < 2 * n; i++)
        {
            double product = 0, size = 0;
            for (size_t k = 0; k < n; k++)
            {
                product += a[i / 2 * n + k] * x[2 * k + i % 2];
                size += fabs(a[i / 2 * n + k] * x[2 * k + i % 2]);
            }
            check_near(product, b[i], 1e-13 * (1 + size));
        }
        free(a);
        free(copy);
        free(x);
        free(b);
    }
    double singular[] = {1, 2, 2, 4}, right[] = {1, 1};
    check_status(decompose_solve(2, 1, singular, right, NULL), BAT_NO_CONVERGENCE);
}

static void symmetric_values_ascend(void **state)
{
    (void)state;
    double a[MAX_NUMBERS], vectors[MAX_NUMBERS], values[MAX_SIDE];
    bat_random random = bat_random_seed(5);
    for (size_t n = 1; n <= MAX_SIDE; n++)
    {
        make_matrix(SYMMETRIC, n, &random, a);
        memcpy(vectors, a, n * n * sizeof *a);
        check_status(decompose_symmetric(n, vectors, values, NULL), BAT_OK);
        for (size_t k = 0; k < n; k++)
        {
            check_vector(n, a, values[k], 0, vectors, k);
            assert_true(k == 0 || values[k - 1] <= values[k]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(eigenvectors_stay_on_their_lines),
        cmocka_unit_test(eigenvalues_are_those_of_the_vectors),
        cmocka_unit_test(defective_matrices_are_told),
        cmocka_unit_test(singular_vectors_have_orthogonal_images),
        cmocka_unit_test(residuals_are_orthogonal_to_columns),
        cmocka_unit_test(systems_are_solved),
        cmocka_unit_test(symmetric_values_ascend),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
