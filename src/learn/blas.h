#ifndef LEARN_BLAS_H
#define LEARN_BLAS_H

#include "learn/real.h"
#include "linalg/blas_single.h"

#include <cblas.h>

/// @file
/// Matrix products in the number type of networks.

#if defined(LEARN_DOUBLE)
#define REAL_GEMM cblas_dgemm
#define REAL_GEMV cblas_dgemv
#define REAL_GER cblas_dger
#else
#define REAL_GEMM cblas_sgemm
#define REAL_GEMV cblas_sgemv
#define REAL_GER cblas_sger
#endif

#endif
