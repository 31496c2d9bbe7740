#pragma once

#include "learn/real.h"
#include "linalg/blas.h"
#include "linalg/blas_single.h"

/// @file
/// Matrix products in the number type of networks.

#if defined(LEARN_DOUBLE)
#define REAL_GEMM cblas_dgemm
#define REAL_GEMV cblas_dgemv
#else
#define REAL_GEMM cblas_sgemm
#define REAL_GEMV cblas_sgemv
#endif
