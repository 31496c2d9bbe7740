// A process made by fork() after calls with several threads: its own calls end, on one thread, with the same bytes.

#include "base/threads.h"
#include "batten/curve.h"
#include "batten/mesh_measure.h"
#include "batten/mesh_refine.h"
#include "batten/space.h"
#include "check.h"
#include "linalg/blas.h"
#include "mesh_makers.h"

#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum
{
    SIDE = 300,   ///< of the matrices
    GIVEN = 2000, ///< points of a curve
    SECONDS = 60, ///< that a process may take
    THREADS = 4
};

/// What the calls of a process give.
typedef struct results
{
    bat_curve curve;
    bat_mesh mesh;
    bat_mesh_distance distance;
    double product[SIDE * SIDE];
    int team; ///< threads of a region that asks for two
} results;

static bat_status multiply(double *product)
{
#if BATTEN_HAS_BLAS
    bat_status status = blas_load(NULL);
    if (status != BAT_OK)
        return status;
    static double a[SIDE * SIDE];
    for (size_t i = 0; i < SIDE * SIDE; i++)
        a[i] = sin((double)i);
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, SIDE, SIDE, SIDE, 1, a, SIDE, a, SIDE, 0, product, SIDE);
#else
    (void)product;
#endif
    return BAT_OK;
}

static bool compute(results *made)
{
    bat_space space;
    double points[2 * GIVEN];
    for (size_t i = 0; i < GIVEN; i++)
    {
        points[2 * i] = (double)i;
        points[2 * i + 1] = sin(0.7 * (double)i);
    }
    bat_curve_refine_options curve = bat_curve_refine_defaults();
    bat_mesh_refine_options mesh = bat_mesh_refine_defaults();
    bat_mesh_compare_options compare = bat_mesh_compare_defaults();
    curve.threads = mesh.threads = compare.threads = THREADS;
    mesh.levels = 2;
    bat_mesh torus = mesh_torus(24, 16);
    bool done = bat_space_by_name("plane", 0, &space, NULL) == BAT_OK;
    const bat_curve given = {.space = &space, .points = points, .count = GIVEN};
    done = done && bat_curve_refine(&given, &curve, &made->curve, NULL) == BAT_OK;
    done = done && bat_mesh_refine(&torus, &mesh, &made->mesh, NULL, NULL) == BAT_OK;
    done = done && bat_mesh_compare(&torus, &made->mesh, &compare, &made->distance, NULL) == BAT_OK;
    bat_mesh_free(&torus);
    done = done && multiply(made->product) == BAT_OK;
    int team = 0;
#pragma omp parallel num_threads(threads_for(2, 2)) reduction(+ : team)
    team++;
    made->team = team;
    return done;
}

static bool agree(const results *a, const results *b)
{
    size_t points = 2 * a->curve.count * sizeof(double), positions = 3 * a->mesh.vertex_count * sizeof(double);
    return a->curve.count == b->curve.count && memcmp(a->curve.points, b->curve.points, points) == 0 &&
           a->mesh.vertex_count == b->mesh.vertex_count && memcmp(a->mesh.positions, b->mesh.positions, positions) == 0 &&
           memcmp(&a->distance, &b->distance, sizeof a->distance) == 0;
}

static void free_results(results *made)
{
    bat_curve_free(&made->curve);
    bat_mesh_free(&made->mesh);
}

/// Whether a process ends by itself with exit code 0; it is killed when its time is over.
static bool ends_well(pid_t process)
{
    int status;
    for (int i = 0; i < 100 * SECONDS; i++)
    {
        if (waitpid(process, &status, WNOHANG) == process)
            return WIFEXITED(status) && WEXITSTATUS(status) == 0;
        (void)nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    (void)kill(process, SIGKILL);
    (void)waitpid(process, &status, 0);
    return false;
}

/// Compute in a process made by fork(), and in one that it makes; `depth` counts them.
static bool child_agrees(const results *expected, int depth)
{
    pid_t process = fork();
    if (process == 0)
    {
        static results again;
        bool same = compute(&again) && agree(expected, &again) && again.team == 1;
        _exit(same && (depth == 1 || child_agrees(expected, depth - 1)) ? 0 : 1);
    }
    return process > 0 && ends_well(process);
}

static void calls_end_after_a_fork(void **state)
{
    (void)state;
    static results before, after;
    assert_true(compute(&before));
    assert_true(child_agrees(&before, 2));
    // The parent has its threads as before.
    assert_true(compute(&after));
    assert_true(agree(&before, &after));
    assert_int_equal(after.team, before.team);
    free_results(&before);
    free_results(&after);
}

/// A process made before any call has its threads: `team` is not 1 there where OpenMP gives two.
static void a_child_of_a_fresh_process_has_threads(void **state)
{
    (void)state;
    pid_t process = fork();
    if (process == 0)
        _exit(threads_for(2, 2) == 2 || threads_for(0, 2) == 1 ? 0 : 1);
    assert_true(process > 0 && ends_well(process));
}

/// The first product of all, in a process made after calls with several threads.
static void a_child_loads_blas(void **state)
{
    (void)state;
    static double product[SIDE * SIDE];
    int team = 0;
#pragma omp parallel num_threads(THREADS) reduction(+ : team)
    team++;
    pid_t process = fork();
    if (process == 0)
        _exit(multiply(product) == BAT_OK ? 0 : 1);
    assert_true(team > 0 && process > 0 && ends_well(process));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_child_of_a_fresh_process_has_threads),
        cmocka_unit_test(a_child_loads_blas),
        cmocka_unit_test(calls_end_after_a_fork),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
