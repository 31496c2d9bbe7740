#include "linalg/blas_single.h"

#if BATTEN_HAS_BLAS

#include <cblas.h>
#include <pthread.h>

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

#else

// Our own products run on the thread that asks for them.
void blas_single_begin(void)
{
}

void blas_single_end(void)
{
}

#endif
