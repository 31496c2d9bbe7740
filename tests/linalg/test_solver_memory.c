// Sparse solvers where one allocation fails, each in turn: the failure is told, and nothing crashes or leaks. The linker
// leads the library's allocations here, SuiteSparse has a hook for its own.

#include "surface_fit_helpers.h"

#include "linalg/sparse.h"
#include "surface/fit/system.h"

#include <SuiteSparse_config.h>

static const size_t NEVER = SIZE_MAX;

/// Allocations to come before the one that fails; NEVER after it.
static size_t allocations_left = SIZE_MAX;

static bool fails_now(void)
{
    if (allocations_left == NEVER)
        return false;
    return allocations_left-- == 0;
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);

void *__wrap_malloc(size_t size)
{
    return fails_now() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return fails_now() ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *memory, size_t size)
{
    return fails_now() ? NULL : __real_realloc(memory, size);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return fails_now() ? NULL : __real_aligned_alloc(alignment, size);
}

static void lead_suitesparse_here(void)
{
#if SUITESPARSE_MAIN_VERSION < 7
    SuiteSparse_config.malloc_func = __wrap_malloc;
    SuiteSparse_config.calloc_func = __wrap_calloc;
    SuiteSparse_config.realloc_func = __wrap_realloc;
#else
    SuiteSparse_config_malloc_func_set(__wrap_malloc);
    SuiteSparse_config_calloc_func_set(__wrap_calloc);
    SuiteSparse_config_realloc_func_set(__wrap_realloc);
#endif
}

/// Do a job again and again, a later allocation failing each time, until it has no more of them.
static void fail_each(bat_status (*job)(const void *context, bat_error *error), const void *context, size_t least)
{
    size_t failing = 0;
    for (bool failed = true; failed; failing++)
    {
        bat_error error = {0};
        allocations_left = failing;
        bat_status status = job(context, &error);
        failed = allocations_left == NEVER;
        allocations_left = NEVER;
        // An allocation may be one that the job can do without.
        if (status != BAT_OK)
        {
            check_status(status, BAT_NO_MEMORY);
            assert_true(failed);
            assert_non_null(strstr(error.text, "memory"));
        }
    }
    assert_true(failing > least);
}

/// A grid whose neighbours meet.
typedef struct fit_job
{
    fit_pattern pattern;
    double *values;
} fit_job;

static bat_status factor_and_solve(const void *context, bat_error *error)
{
    const fit_job *job = context;
    size_t numbers = 3 * job->pattern.functions;
    double pivot = 0, *x = calloc(numbers, sizeof *x);
    fit_solver *solver = NULL;
    if (x == NULL)
    {
        (void)snprintf(error->text, sizeof error->text, "out of memory in the test");
        return BAT_NO_MEMORY;
    }
    for (size_t k = 0; k < numbers; k++)
        x[k] = 1;
    bat_status status = fit_solver_make(&job->pattern, &solver, error);
    // Twice, as the search for a weight does.
    for (int round = 0; round < 2 && status == BAT_OK; round++)
    {
        status = fit_solver_factor(solver, job->values, &pivot, error);
        if (status == BAT_OK)
            status = fit_solver_solve(solver, 3, x, x, error);
    }
    assert_true(status != BAT_OK || pivot > 0);
    fit_solver_free(solver);
    free(x);
    return status;
}

static void fit_solvers_survive(void **state)
{
    (void)state;
    enum
    {
        SIDE = 20,
        COUNT = SIDE * SIDE
    };
    int first[COUNT + 1], row[3 * COUNT], at = 0;
    double values[3 * COUNT];
    for (int j = 0; j < COUNT; j++)
    {
        first[j] = at;
        row[at] = j;
        values[at++] = 4.1;
        if (j % SIDE + 1 < SIDE)
        {
            row[at] = j + 1;
            values[at++] = -1;
        }
        if (j + SIDE < COUNT)
        {
            row[at] = j + SIDE;
            values[at++] = -1;
        }
    }
    first[COUNT] = at;
    fit_job job = {{COUNT, first, row}, values};
    fail_each(factor_and_solve, &job, 20);
}

typedef bat_status average_solver(const sparse_rows *weights, const double *constant, double *x, bat_error *error);

typedef struct average_job
{
    sparse_rows weights;
    average_solver *solve;
} average_job;

static bat_status solve_averages(const void *context, bat_error *error)
{
    const average_job *job = context;
    static double constant[600], x[600];
    constant[0] = 0.5;
    bat_status status = job->solve(&job->weights, constant, x, error);
    if (status == BAT_OK)
        check_near(x[0], 300.0 / 301, 1e-10);
    return status;
}

/// A chain from 1 to 0.
static void average_solvers_survive(void **state)
{
    (void)state;
    average_job job = {.solve = average_solve};
    check_status(sparse_rows_make(300, 300, 598, &job.weights, NULL), BAT_OK);
    size_t at = 0;
    for (uint32_t i = 0; i < 300; i++)
    {
        job.weights.starts[i] = at;
        for (uint32_t k = i > 0 ? i - 1 : 1; k <= i + 1 && k < 300; k += 2)
        {
            job.weights.columns[at] = k;
            job.weights.values[at++] = 0.5;
        }
    }
    assert_int_equal(at, 598);
    fail_each(solve_averages, &job, 20);
    sparse_rows_free(&job.weights);
}

static bat_status fit_surface(const void *context, bat_error *error)
{
    const surface_sample *sample = context;
    bat_surface_fit_data data = sample->data;
    bat_surface_fit_options options = bat_surface_fit_defaults();
    options.functions = 40;
    options.threads = 1;
    bat_spline_surface surface = {0};
    bat_status status = bat_surface_fit(&data, &options, &surface, NULL, error);
    if (status == BAT_OK)
        bat_spline_surface_free(&surface);
    return status;
}

static void surface_fits_survive(void **state)
{
    (void)state;
    surface_sample sample = sample_make(shape_hills, 100, 0, 0, 4);
    fail_each(fit_surface, &sample, 100);
    sample_free(&sample);
}

int main(void)
{
    lead_suitesparse_here();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fit_solvers_survive),
        cmocka_unit_test(average_solvers_survive),
        cmocka_unit_test(surface_fits_survive),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
