#include "linalg/blas_single.h"

#include "base/error.h"
#include "linalg/blas.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef BATTEN_BLAS_LIBRARY
#include "base/load_functions.h"

struct blas_functions blas;

static pthread_once_t once = PTHREAD_ONCE_INIT;
static char load_fault[BAT_ERROR_TEXT_SIZE / 2]; ///< why it cannot be loaded; "" where it is

static void load(void)
{
    static const char *const names[] = {
#define BLAS_NAME(name) #name,
        BLAS_FUNCTIONS(BLAS_NAME)
#undef BLAS_NAME
    };
    if (!load_functions(BATTEN_BLAS_LIBRARY, names, sizeof names / sizeof *names, &blas))
        (void)snprintf(load_fault, sizeof load_fault, "%s", dlerror());
}

bat_status blas_load(bat_error *error)
{
    (void)pthread_once(&once, load);
    if (load_fault[0] == '\0')
        return BAT_OK;
    return ERROR_UNSUPPORTED(error, 0, "this needs OpenBLAS, which cannot be loaded: %s", load_fault);
}
#endif

// The setting belongs to the process, so the count of who relies on it does too.
static pthread_mutex_t single_lock = PTHREAD_MUTEX_INITIALIZER;
static int single_users;
static int threads_before;

void blas_single_begin(void)
{
    bool loaded = blas_load(NULL) == BAT_OK;
    (void)pthread_mutex_lock(&single_lock);
    if (single_users++ == 0 && loaded)
    {
        threads_before = openblas_get_num_threads();
        openblas_set_num_threads(1);
    }
    (void)pthread_mutex_unlock(&single_lock);
}

void blas_single_end(void)
{
    (void)pthread_mutex_lock(&single_lock);
    if (--single_users == 0 && blas_load(NULL) == BAT_OK)
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
        status = blas_load(error);
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
