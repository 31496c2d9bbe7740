// How many threads share work: never more than pieces, none for what is short unless they are asked for, and one where that
// is asked for.

#include "base/threads.h"
#include "check.h"
#include "linalg/blas.h"
#include "linalg/blas_single.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static void threads_are_no_more_than_pieces(void **state)
{
    (void)state;
    assert_int_equal(threads_for(3, 0), 1);
    assert_int_equal(threads_for(3, 1), 1);
    assert_true(threads_for(3, 2) <= 2);
    assert_true(threads_for(0, 2) <= 2);
    assert_true(threads_for(-1, 1000) >= 1);
}

static void short_work_is_not_shared(void **state)
{
    (void)state;
    assert_int_equal(threads_worth(0, 1000000, 0), 1);
    assert_int_equal(threads_worth(0, 1000000, 1.9 * THREADS_WORTH), 1);
    assert_true(threads_worth(0, 1000000, 2 * THREADS_WORTH) <= 2);
    assert_int_equal(threads_worth(0, 1, 1e300), 1);
    assert_int_equal(threads_worth(0, 1000, 1e300), threads_for(0, 1000));
}

static void who_wants_threads_gets_them(void **state)
{
    (void)state;
    for (int wanted = 1; wanted < 5; wanted++)
        assert_int_equal(threads_worth(wanted, 1000, 0), threads_for(wanted, 1000));
}

/// OpenMP would end the process, with a line of its own.
static void without_memory_for_stacks_there_is_one_thread(void **state)
{
    (void)state;
    if (getenv("BATTEN_SANITIZED") != NULL) // sanitizers map terabytes
        skip();
    pid_t child = fork();
    if (child == 0)
    {
        struct rlimit space;
        bool known = getrlimit(RLIMIT_AS, &space) == 0;
        space.rlim_cur = 1 << 20;
        _exit(!known || setrlimit(RLIMIT_AS, &space) != 0 || threads_for(3, 1000) != 1);
    }
    int status = 0;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

static void threads_load_blas_at_once(void **state)
{
    (void)state;
    int failures = 0;
#pragma omp parallel num_threads(4) reduction(+ : failures)
    failures += blas_load(NULL) != BAT_OK || openblas_get_num_threads() < 1;
    assert_int_equal(failures, 0);
}

/// However uses nest or overlap: one thread during, and afterwards the number of before.
static void blas_has_its_threads_back(void **state)
{
    (void)state;
    int before = openblas_get_num_threads();
    blas_single_begin();
    assert_int_equal(openblas_get_num_threads(), 1);
    blas_single_begin();
    blas_single_end();
    assert_int_equal(openblas_get_num_threads(), 1);
    blas_single_end();
    assert_int_equal(openblas_get_num_threads(), before);
    openblas_set_num_threads(2);
    int wanted = openblas_get_num_threads(), others = 0;
#pragma omp parallel for num_threads(2) reduction(+ : others)
    for (int i = 0; i < 1000; i++)
    {
        blas_single_begin();
        others += openblas_get_num_threads() != 1;
        blas_single_end();
    }
    assert_int_equal(others, 0);
    assert_int_equal(openblas_get_num_threads(), wanted);
    openblas_set_num_threads(before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_are_no_more_than_pieces), cmocka_unit_test(short_work_is_not_shared),
        cmocka_unit_test(who_wants_threads_gets_them),     cmocka_unit_test(without_memory_for_stacks_there_is_one_thread),
        cmocka_unit_test(threads_load_blas_at_once),       cmocka_unit_test(blas_has_its_threads_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
