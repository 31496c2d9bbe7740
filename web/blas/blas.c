#include "cblas.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

// Products. Blocks of both matrices are copied into panels, so that the innermost loop reads contiguous numbers. It keeps
// a tile of the result in vectors: Goto and van de Geijn, "Anatomy of high-performance matrix multiplication" (2008).

enum
{
    TILE_ROWS = 4,
    BLOCK_ROWS = 64,     ///< of the left matrix, in the first cache
    BLOCK_DEPTH = 192,   ///< products that are summed at once
    BLOCK_COLUMNS = 256, ///< of the right matrix
    VECTOR = 16,         ///< bytes
    SMALL = 16           ///< triangles up to this size are solved by plain loops
};

typedef double doubles __attribute__((vector_size(VECTOR)));
typedef float floats __attribute__((vector_size(VECTOR)));

/// A matrix as it lies in memory: the steps from row to row and from column to column.
typedef struct steps
{
    size_t row, column;
} steps;

// The types are parameters, which parentheses cannot enclose.
// NOLINTBEGIN(bugprone-macro-parentheses)
#define DEFINE_PRODUCT(number, vector, name)                                                                                \
    enum                                                                                                                    \
    {                                                                                                                       \
        name##_LANES = VECTOR / sizeof(number),                                                                             \
        name##_TILE = 2 * name##_LANES                                                                                      \
    };                                                                                                                      \
    static number name##_left[BLOCK_ROWS * BLOCK_DEPTH] __attribute__((aligned(VECTOR)));                                   \
    static number name##_right[BLOCK_COLUMNS * BLOCK_DEPTH] __attribute__((aligned(VECTOR)));                               \
                                                                                                                            \
    /* Copy a block into panels of `width` rows, filled up with zeros. */                                                   \
    static void name##_pack(const number *from, size_t row, size_t column, size_t rows, size_t depth, size_t width,         \
                            number factor, number *to)                                                                      \
    {                                                                                                                       \
        for (size_t i = 0; i < rows; i += width)                                                                            \
        {                                                                                                                   \
            size_t count = rows - i < width ? rows - i : width;                                                             \
            for (size_t l = 0; l < depth; l++, to += width)                                                                 \
            {                                                                                                               \
                const number *at = from + i * row + l * column;                                                             \
                for (size_t r = 0; r < count; r++)                                                                          \
                    to[r] = factor * at[r * row];                                                                           \
                for (size_t r = count; r < width; r++)                                                                      \
                    to[r] = 0;                                                                                              \
            }                                                                                                               \
        }                                                                                                                   \
    }                                                                                                                       \
                                                                                                                            \
    /* Add the product of two panels to a tile of c. */                                                                     \
    static void name##_tile(size_t depth, const number *left, const number *right, size_t rows, size_t columns, number *c,  \
                            size_t stride)                                                                                  \
    {                                                                                                                       \
        vector sum[TILE_ROWS][2] = {0};                                                                                     \
        for (size_t l = 0; l < depth; l++, left += TILE_ROWS, right += name##_TILE)                                         \
        {                                                                                                                   \
            vector b[2];                                                                                                    \
            memcpy(b, right, sizeof b);                                                                                     \
            for (int r = 0; r < TILE_ROWS; r++)                                                                             \
            {                                                                                                               \
                sum[r][0] += left[r] * b[0];                                                                                \
                sum[r][1] += left[r] * b[1];                                                                                \
            }                                                                                                               \
        }                                                                                                                   \
        for (size_t r = 0; r < rows; r++)                                                                                   \
        {                                                                                                                   \
            number out[name##_TILE];                                                                                        \
            memcpy(out, sum[r], sizeof out);                                                                                \
            for (size_t j = 0; j < columns; j++)                                                                            \
                c[r * stride + j] += out[j];                                                                                \
        }                                                                                                                   \
    }                                                                                                                       \
                                                                                                                            \
    /* c = alpha a b + beta c, c by rows. */                                                                                \
    static void name##_product(size_t m, size_t n, size_t k, number alpha, const number *a, steps of_a, const number *b,    \
                               steps of_b, number beta, number *c, size_t stride)                                           \
    {                                                                                                                       \
        for (size_t i = 0; i < m && beta != 1; i++)                                                                         \
            for (size_t j = 0; j < n; j++)                                                                                  \
                c[i * stride + j] = beta == 0 ? 0 : beta * c[i * stride + j];                                               \
        for (size_t j = 0; j < n && alpha != 0; j += BLOCK_COLUMNS)                                                         \
            for (size_t l = 0; l < k; l += BLOCK_DEPTH)                                                                     \
            {                                                                                                               \
                size_t columns = n - j < BLOCK_COLUMNS ? n - j : BLOCK_COLUMNS;                                             \
                size_t depth = k - l < BLOCK_DEPTH ? k - l : BLOCK_DEPTH;                                                   \
                name##_pack(b + l * of_b.row + j * of_b.column, of_b.column, of_b.row, columns, depth, name##_TILE, 1,      \
                            name##_right);                                                                                  \
                for (size_t i = 0; i < m; i += BLOCK_ROWS)                                                                  \
                {                                                                                                           \
                    size_t rows = m - i < BLOCK_ROWS ? m - i : BLOCK_ROWS;                                                  \
                    name##_pack(a + i * of_a.row + l * of_a.column, of_a.row, of_a.column, rows, depth, TILE_ROWS, alpha,   \
                                name##_left);                                                                               \
                    for (size_t y = 0; y < columns; y += name##_TILE)                                                       \
                        for (size_t x = 0; x < rows; x += TILE_ROWS)                                                        \
                            name##_tile(depth, name##_left + x * depth, name##_right + y * depth,                           \
                                        rows - x < TILE_ROWS ? rows - x : TILE_ROWS,                                        \
                                        columns - y < name##_TILE ? columns - y : name##_TILE,                              \
                                        c + (i + x) * stride + j + y, stride);                                              \
                }                                                                                                           \
            }                                                                                                               \
    }                                                                                                                       \
                                                                                                                            \
    void cblas_##name##gemm(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans_a, CBLAS_TRANSPOSE trans_b, int m, int n, int k,     \
                            number alpha, const number *a, int stride_a, const number *b, int stride_b, number beta,        \
                            number *c, int stride_c)                                                                        \
    {                                                                                                                       \
        if (layout == CblasColMajor)                                                                                        \
        {                                                                                                                   \
            /* c^T = op(b)^T op(a)^T by rows. */                                                                            \
            name##_product((size_t)n, (size_t)m, (size_t)k, alpha, b, steps_of(trans_b, stride_b), a,                       \
                           steps_of(trans_a, stride_a), beta, c, (size_t)stride_c);                                         \
            return;                                                                                                         \
        }                                                                                                                   \
        name##_product((size_t)m, (size_t)n, (size_t)k, alpha, a, steps_of(trans_a, stride_a), b,                           \
                       steps_of(trans_b, stride_b), beta, c, (size_t)stride_c);                                             \
    }                                                                                                                       \
                                                                                                                            \
    void cblas_##name##gemv(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans, int m, int n, number alpha, const number *a,        \
                            int stride, const number *x, int x_increment, number beta, number *y, int y_increment)          \
    {                                                                                                                       \
        assert(layout == CblasRowMajor && x_increment == 1 && y_increment == 1);                                            \
        (void)layout;                                                                                                       \
        (void)x_increment;                                                                                                  \
        (void)y_increment;                                                                                                  \
        for (int i = 0; i < (trans == CblasNoTrans ? m : n); i++)                                                           \
            y[i] = beta == 0 ? 0 : beta * y[i];                                                                             \
        for (size_t i = 0; i < (size_t)m; i++)                                                                              \
        {                                                                                                                   \
            const number *row = a + i * (size_t)stride;                                                                     \
            number sum = 0, factor = alpha * (trans == CblasNoTrans ? 1 : x[i]);                                            \
            for (int j = 0; j < n; j++)                                                                                     \
                if (trans == CblasNoTrans)                                                                                  \
                    sum += row[j] * x[j];                                                                                   \
                else                                                                                                        \
                    y[j] += factor * row[j];                                                                                \
            if (trans == CblasNoTrans)                                                                                      \
                y[i] += factor * sum;                                                                                       \
        }                                                                                                                   \
    }
// NOLINTEND(bugprone-macro-parentheses)

static steps steps_of(CBLAS_TRANSPOSE trans, int stride)
{
    return trans == CblasNoTrans ? (steps){(size_t)stride, 1} : (steps){1, (size_t)stride};
}

DEFINE_PRODUCT(float, floats, s)
DEFINE_PRODUCT(double, doubles, d)

void cblas_daxpy(int n, double alpha, const double *x, int x_increment, double *y, int y_increment)
{
    assert(x_increment == 1 && y_increment == 1);
    (void)x_increment;
    (void)y_increment;
    for (int i = 0; i < n; i++)
        y[i] += alpha * x[i];
}

double cblas_dnrm2(int n, const double *x, int increment)
{
    assert(increment == 1);
    (void)increment;
    double largest = 0, sum = 0;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, fabs(x[i]));
    for (int i = 0; i < n && largest > 0; i++)
        sum += x[i] / largest * (x[i] / largest);
    return largest * sqrt(sum);
}

void cblas_dscal(int n, double alpha, double *x, int increment)
{
    assert(increment == 1);
    (void)increment;
    for (int i = 0; i < n; i++)
        x[i] *= alpha;
}

void cblas_dsyrk(CBLAS_LAYOUT layout, CBLAS_UPLO part, CBLAS_TRANSPOSE trans, int n, int k, double alpha, const double *a,
                 int stride_a, double beta, double *c, int stride_c)
{
    assert(layout == CblasRowMajor && part == CblasUpper);
    (void)layout;
    (void)part;
    steps left = steps_of(trans, stride_a);
    for (size_t i = 0; i < (size_t)n; i++)
    {
        // A row from the diagonal on.
        const double *from = a + i * left.row;
        d_product(1, (size_t)n - i, (size_t)k, alpha, from, left, from, (steps){left.column, left.row}, beta,
                  c + i * (size_t)stride_c + i, (size_t)stride_c);
    }
}

// Triangles, by columns: halves of the triangle, with a product between. n is its size.

/// x a^T = b, where x replaces b, which has m rows.
static void solve_right(size_t m, size_t n, const double *a, size_t stride_a, double *b, size_t stride_b)
{
    if (n > SMALL)
    {
        size_t half = n / 2, rest = n - half;
        solve_right(m, half, a, stride_a, b, stride_b);
        // By columns b is its own transpose by rows: rows of b^T are columns of b.
        d_product(rest, m, half, -1, a + half, (steps){1, stride_a}, b, (steps){stride_b, 1}, 1, b + half * stride_b,
                  stride_b);
        solve_right(m, rest, a + half * stride_a + half, stride_a, b + half * stride_b, stride_b);
        return;
    }
    for (size_t j = 0; j < n; j++)
    {
        double *column = b + j * stride_b, pivot = 1 / a[j * stride_a + j];
        for (size_t l = 0; l < j; l++)
        {
            const double *before = b + l * stride_b;
            double factor = a[l * stride_a + j];
            for (size_t i = 0; i < m; i++)
                column[i] -= factor * before[i];
        }
        for (size_t i = 0; i < m; i++)
            column[i] *= pivot;
    }
}

/// a x = b, where x replaces b, which has `columns` columns.
static void solve_left(size_t n, size_t columns, const double *a, size_t stride_a, double *b, size_t stride_b)
{
    if (n > SMALL)
    {
        size_t half = n / 2, rest = n - half;
        solve_left(half, columns, a, stride_a, b, stride_b);
        d_product(columns, rest, half, -1, b, (steps){stride_b, 1}, a + half, (steps){stride_a, 1}, 1, b + half, stride_b);
        solve_left(rest, columns, a + half * stride_a + half, stride_a, b + half, stride_b);
        return;
    }
    for (size_t c = 0; c < columns; c++)
        for (size_t j = 0; j < n; j++)
        {
            double *x = b + c * stride_b, value = x[j] / a[j * stride_a + j];
            x[j] = value;
            for (size_t i = j + 1; i < n; i++)
                x[i] -= value * a[j * stride_a + i];
        }
}

/// a^T x = b
static void solve_left_transposed(size_t n, size_t columns, const double *a, size_t stride_a, double *b, size_t stride_b)
{
    if (n > SMALL)
    {
        size_t half = n / 2, rest = n - half;
        solve_left_transposed(rest, columns, a + half * stride_a + half, stride_a, b + half, stride_b);
        d_product(columns, half, rest, -1, b + half, (steps){stride_b, 1}, a + half, (steps){1, stride_a}, 1, b, stride_b);
        solve_left_transposed(half, columns, a, stride_a, b, stride_b);
        return;
    }
    for (size_t c = 0; c < columns; c++)
        for (size_t j = n; j-- > 0;)
        {
            double *x = b + c * stride_b, sum = x[j];
            for (size_t i = j + 1; i < n; i++)
                sum -= a[j * stride_a + i] * x[i];
            x[j] = sum / a[j * stride_a + j];
        }
}

void cblas_dtrsm(CBLAS_LAYOUT layout, CBLAS_SIDE side, CBLAS_UPLO part, CBLAS_TRANSPOSE trans, CBLAS_DIAG diagonal, int m,
                 int n, double alpha, const double *a, int stride_a, double *b, int stride_b)
{
    assert(layout == CblasColMajor && part == CblasLower && diagonal == CblasNonUnit && alpha == 1);
    assert(side == CblasLeft || trans == CblasTrans);
    (void)layout;
    (void)part;
    (void)diagonal;
    (void)alpha;
    if (side == CblasRight)
        solve_right((size_t)m, (size_t)n, a, (size_t)stride_a, b, (size_t)stride_b);
    else if (trans == CblasNoTrans)
        solve_left((size_t)m, (size_t)n, a, (size_t)stride_a, b, (size_t)stride_b);
    else
        solve_left_transposed((size_t)m, (size_t)n, a, (size_t)stride_a, b, (size_t)stride_b);
}

int openblas_get_num_threads(void)
{
    return 1;
}

void openblas_set_num_threads(int count)
{
    (void)count;
}
