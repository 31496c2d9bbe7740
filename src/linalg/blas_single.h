#pragma once

#include "batten/base.h"

/// @file
/// The one setting of OpenBLAS that matters when several threads ask for products at once, or when results must not depend
/// on the number of threads.

/// Let every product run on the thread that asks for it, until blas_single_end(). OpenBLAS keeps its number of threads for
/// the whole process: the first to begin remembers it, the last to end restores it. May be called from any thread.
///
/// Loads OpenBLAS first, and does nothing where that fails. Beside blas_load() and blas_reserve(), this pair is the
/// library's only state of the process, and it lasts no longer than a call. Each begin has one end on every way out,
/// failures and cancelling included: nothing returns between the two. A program that sets the number of threads itself
/// meanwhile, from another thread, loses its setting at the end.
void blas_single_begin(void);
void blas_single_end(void);

/// Make OpenBLAS take its memory for products, once for the process. Where it cannot, it would try for ever: that is found
/// out first. From here on the process keeps that memory.
/// @return BAT_OK, BAT_NO_MEMORY, or the failure of blas_load()
bat_status blas_reserve(bat_error *error);
