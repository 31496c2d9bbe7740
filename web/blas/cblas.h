#ifndef WEB_BLAS_CBLAS_H
#define WEB_BLAS_CBLAS_H

/// @file
/// The routines of BLAS that the library calls, in WebAssembly: OpenBLAS has no kernels for its vectors. Names and arguments
/// are those of CBLAS. Vectors are contiguous: every increment is 1.

typedef enum CBLAS_LAYOUT
{
    CblasRowMajor = 101,
    CblasColMajor = 102
} CBLAS_LAYOUT;

typedef enum CBLAS_TRANSPOSE
{
    CblasNoTrans = 111,
    CblasTrans = 112
} CBLAS_TRANSPOSE;

typedef enum CBLAS_UPLO
{
    CblasUpper = 121,
    CblasLower = 122
} CBLAS_UPLO;

typedef enum CBLAS_DIAG
{
    CblasNonUnit = 131
} CBLAS_DIAG;

typedef enum CBLAS_SIDE
{
    CblasLeft = 141,
    CblasRight = 142
} CBLAS_SIDE;

/// c = alpha op(a) op(b) + beta c, where op(a) is m x k, op(b) is k x n and c is m x n.
void cblas_sgemm(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans_a, CBLAS_TRANSPOSE trans_b, int m, int n, int k, float alpha,
                 const float *a, int stride_a, const float *b, int stride_b, float beta, float *c, int stride_c);
void cblas_dgemm(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans_a, CBLAS_TRANSPOSE trans_b, int m, int n, int k, double alpha,
                 const double *a, int stride_a, const double *b, int stride_b, double beta, double *c, int stride_c);
/// y = alpha op(a) x + beta y, where a is m x n, by rows.
void cblas_sgemv(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans, int m, int n, float alpha, const float *a, int stride,
                 const float *x, int x_increment, float beta, float *y, int y_increment);
void cblas_dgemv(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans, int m, int n, double alpha, const double *a, int stride,
                 const double *x, int x_increment, double beta, double *y, int y_increment);
/// y = alpha x + y
void cblas_daxpy(int n, double alpha, const double *x, int x_increment, double *y, int y_increment);
/// The Euclidean norm, without overflow.
double cblas_dnrm2(int n, const double *x, int increment);
/// x = alpha x
void cblas_dscal(int n, double alpha, double *x, int increment);
/// c = alpha op(a) op(a)^T + beta c: the upper triangle of c, which is n x n, by rows; op(a) is n x k.
void cblas_dsyrk(CBLAS_LAYOUT layout, CBLAS_UPLO part, CBLAS_TRANSPOSE trans, int n, int k, double alpha, const double *a,
                 int stride_a, double beta, double *c, int stride_c);
/// Solve op(a) x = b (left) or x op(a) = b (right, transposed alone): a is a lower triangle, all by columns, and x replaces
/// b, which is m x n. `alpha` is 1.
void cblas_dtrsm(CBLAS_LAYOUT layout, CBLAS_SIDE side, CBLAS_UPLO part, CBLAS_TRANSPOSE trans, CBLAS_DIAG diagonal, int m,
                 int n, double alpha, const double *a, int stride_a, double *b, int stride_b);

/// There is one thread.
int openblas_get_num_threads(void);
void openblas_set_num_threads(int count);

#endif
