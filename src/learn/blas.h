#ifndef LEARN_BLAS_H
#define LEARN_BLAS_H

#include "learn/real.h"

#include <cblas.h>

/// @file
/// Matrix products in the number type of networks, and the one setting of OpenBLAS that matters when several threads ask for
/// products at once.

#if defined(LEARN_DOUBLE)
#define REAL_GEMM cblas_dgemm
#define REAL_GEMV cblas_dgemv
#define REAL_GER cblas_dger
#else
#define REAL_GEMM cblas_sgemm
#define REAL_GEMV cblas_sgemv
#define REAL_GER cblas_sger
#endif

/// Let every product run on the thread that asks for it, until blas_single_end(). OpenBLAS keeps its number of threads for the
/// whole process: the first to begin remembers it, the last to end restores it. May be called from any thread.
void blas_single_begin(void);
void blas_single_end(void);

#endif
