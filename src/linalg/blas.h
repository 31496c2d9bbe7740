#pragma once

#include "batten/base.h"

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

#ifdef BATTEN_BLAS_LIBRARY

/// Load OpenBLAS, once for the process. This comes before every product.
/// @return BAT_OK or BAT_UNSUPPORTED (the library cannot be loaded)
bat_status blas_load(bat_error *error);

// clang-format off
#define BLAS_FUNCTIONS(X) \
    X(cblas_daxpy) X(cblas_dgemm) X(cblas_dgemv) X(cblas_dnrm2) X(cblas_dscal) X(cblas_dsyrk) X(cblas_dtrsm) \
    X(cblas_sgemm) X(cblas_sgemv) X(openblas_get_num_threads) X(openblas_set_num_threads)
// clang-format on

#define BLAS_MEMBER(name) __typeof__(name) *name; // NOLINT(bugprone-macro-parentheses): a member
/// The functions in use, valid from the first successful blas_load() on. The start of OpenBLAS takes longer than a short
/// call of the program, which needs no products.
extern struct blas_functions
{
    BLAS_FUNCTIONS(BLAS_MEMBER)
} blas;
#undef BLAS_MEMBER

#define cblas_daxpy blas.cblas_daxpy
#define cblas_dgemm blas.cblas_dgemm
#define cblas_dgemv blas.cblas_dgemv
#define cblas_dnrm2 blas.cblas_dnrm2
#define cblas_dscal blas.cblas_dscal
#define cblas_dsyrk blas.cblas_dsyrk
#define cblas_dtrsm blas.cblas_dtrsm
#define cblas_sgemm blas.cblas_sgemm
#define cblas_sgemv blas.cblas_sgemv
#define openblas_get_num_threads blas.openblas_get_num_threads
#define openblas_set_num_threads blas.openblas_set_num_threads

#else
#define blas_load(error) ((void)(error), BAT_OK)
#endif
