#pragma once

/// @file
/// The routines of BLAS that the library calls, with the signatures of CBLAS: those of OpenBLAS where the library was built
/// with it. Without it there are no surfaces and no training; a loop of our own (blas_own.c) serves what is left.

#if BATTEN_HAS_BLAS
#include <cblas.h>
#else

typedef enum CBLAS_LAYOUT
{
    CblasRowMajor = 101
} CBLAS_LAYOUT;

typedef enum CBLAS_TRANSPOSE
{
    CblasNoTrans = 111
} CBLAS_TRANSPOSE;

#define cblas_dgemm own_dgemm

/// c = alpha a b + beta c, where a is m x k, b is k x n and c is m x n.
void own_dgemm(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans_a, CBLAS_TRANSPOSE trans_b, int m, int n, int k, double alpha,
               const double *a, int stride_a, const double *b, int stride_b, double beta, double *c, int stride_c);

#endif
