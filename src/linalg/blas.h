#pragma once

/// @file
/// The routines of BLAS that the library calls, with the signatures of CBLAS: those of OpenBLAS where the library was built
/// with it, else plain loops of our own (blas_own.c) for row-major matrices.

#if BATTEN_HAS_BLAS
#include <cblas.h>
#else

typedef enum CBLAS_LAYOUT
{
    CblasRowMajor = 101
} CBLAS_LAYOUT;

typedef enum CBLAS_TRANSPOSE
{
    CblasNoTrans = 111,
    CblasTrans = 112
} CBLAS_TRANSPOSE;

#define cblas_sgemm own_sgemm
#define cblas_dgemm own_dgemm
#define cblas_sgemv own_sgemv
#define cblas_dgemv own_dgemv
#define cblas_daxpy own_daxpy
#define cblas_dnrm2 own_dnrm2
#define cblas_dscal own_dscal

/// c = alpha op(a) op(b) + beta c, where op(a) is m x k, op(b) is k x n and c is m x n.
void own_sgemm(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans_a, CBLAS_TRANSPOSE trans_b, int m, int n, int k, float alpha,
               const float *a, int stride_a, const float *b, int stride_b, float beta, float *c, int stride_c);
void own_dgemm(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans_a, CBLAS_TRANSPOSE trans_b, int m, int n, int k, double alpha,
               const double *a, int stride_a, const double *b, int stride_b, double beta, double *c, int stride_c);
/// y = alpha op(a) x + beta y, where a is m x n. Vectors are contiguous: their increments are 1.
void own_sgemv(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans, int m, int n, float alpha, const float *a, int stride,
               const float *x, int x_increment, float beta, float *y, int y_increment);
void own_dgemv(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans, int m, int n, double alpha, const double *a, int stride,
               const double *x, int x_increment, double beta, double *y, int y_increment);
/// y = alpha x + y
void own_daxpy(int n, double alpha, const double *x, int x_increment, double *y, int y_increment);
/// The Euclidean norm, without overflow.
double own_dnrm2(int n, const double *x, int increment);
/// x = alpha x
void own_dscal(int n, double alpha, double *x, int increment);

#endif
