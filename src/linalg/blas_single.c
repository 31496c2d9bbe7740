#include "linalg/blas_single.h"

#if BATTEN_HAS_BLAS

#include "base/error.h"

#include <cblas.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

// The setting belongs to the process, so the count of who relies on it does too.
static pthread_mutex_t single_lock = PTHREAD_MUTEX_INITIALIZER;
static int single_users;
static int threads_before;

void blas_single_begin(void)
{
    (void)pthread_mutex_lock(&single_lock);
    if (single_users++ == 0)
    {
        threads_before = openblas_get_num_threads();
        openblas_set_num_threads(1);
    }
    (void)pthread_mutex_unlock(&single_lock);
}

void blas_single_end(void)
{
    (void)pthread_mutex_lock(&single_lock);
    if (--single_users == 0)
        openblas_set_num_threads(threads_before);
    (void)pthread_mutex_unlock(&single_lock);
}

bat_status blas_reserve(bat_error *error)
{
    enum
    {
        NEEDED = 136, ///< MiB, for one thread
        SIDE = 160    ///< smaller products take no memory
    };
    static atomic_bool reserved;
    if (atomic_load(&reserved))
        return BAT_OK;
    void *volatile room = malloc((size_t)NEEDED << 20);
    double *matrix = calloc((size_t)SIDE * SIDE, 2 * sizeof *matrix);
    bat_status status = room != NULL && matrix != NULL ? BAT_OK : error_memory(error, (size_t)NEEDED << 20);
    free(room);
    if (status == BAT_OK)
    {
        blas_single_begin();
        cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, SIDE, SIDE, SIDE, 1, matrix, SIDE, matrix, SIDE, 0,
                    matrix + (size_t)SIDE * SIDE, SIDE);
        blas_single_end();
        atomic_store(&reserved, true);
    }
    free(matrix);
    return status;
}

#else

// Our own products run on the thread that asks for them.
void blas_single_begin(void)
{
}

void blas_single_end(void)
{
}

bat_status blas_reserve(bat_error *error BAT_UNUSED)
{
    return BAT_OK;
}

#endif
