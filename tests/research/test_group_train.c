// Trainings divided among processes: the number of processes and threads changes no byte of weights, checkpoints and
// reports; stops, deaths and failures of a process reach all others. Built in single and double precision.

#include "group_helpers.h"
#include "mesh_flap_helpers.h"
#include "regression_helpers.h"
#include "train_helpers.h"

#include "batten/research/curve_train.h"
#include "batten/research/mesh_train.h"
#include "batten/research/surface_train.h"
#include "research/train/curve_train.h"

// The exchanges

typedef struct exchange
{
    size_t count, size;
} exchange;

/// Item i consists of bytes i + 1.
static bat_status collect(const bat_group *group, void *context, bat_error *error)
{
    const exchange *e = context;
    group_items own = group_items_of(group, e->count);
    unsigned char *items = calloc(e->count * e->size + 1, 1);
    for (size_t i = own.begin; i < own.end; i++)
        memset(items + i * e->size, (int)i + 1, e->size);
    bat_status status = group_collect(group, items, e->size, e->count, BAT_OK, error);
    for (size_t i = 0; i < e->count * e->size; i++)
        if (items[i] != i / e->size + 1)
            status = BAT_BAD_FILE;
    size_t root = 1 % group_count(group);
    if (group_rank(group) == root)
        memset(items, 7, e->count * e->size);
    if (status == BAT_OK)
        status = group_broadcast(group, root, items, e->count * e->size, error);
    for (size_t i = 0; i < e->count * e->size; i++)
        if (items[i] != 7)
            status = BAT_BAD_FILE;
    free(items);
    return status;
}

static void items_reach_every_process(void **state)
{
    (void)state;
    exchange sizes[] = {{0, 8}, {1, 1}, {3, 8}, {5, 30000}, {7, GROUP_RUN}, {2, 3 * GROUP_RUN + 5}};
    for (size_t ranks = 1; ranks <= 5; ranks++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
            group_succeeds(ranks, collect, &sizes[i]);
}

static bat_status fail_in_two(const bat_group *group, void *context, bat_error *error)
{
    (void)context;
    bat_status status = BAT_OK;
    if (group_rank(group) == 1 || group_rank(group) == 3)
    {
        status = group_rank(group) == 1 ? BAT_BAD_FILE : BAT_NO_MEMORY;
        *error = (bat_error){.status = status};
        (void)snprintf(error->text, sizeof error->text, "rank %zu fails", group_rank(group));
    }
    return bat_group_agree(group, status, error);
}

static void the_first_failure_reaches_every_process(void **state)
{
    (void)state;
    const group_results *results = group_run(4, fail_in_two, NULL);
    for (size_t rank = 0; rank < 4; rank++)
    {
        assert_int_equal(results->status[rank], BAT_BAD_FILE);
        assert_string_equal(results->error[rank].text, "rank 1 fails");
    }
}

// The loop

typedef struct loop
{
    const char *checkpoint;
    real *weights;  ///< shared: of rank 0
    size_t stop_at; ///< the step at which the last rank is asked to stop; 0: none
    size_t dies_at; ///< the step at which rank 1 dies; 0: none
    size_t slots;   ///< of the options
    int threads;    ///< of each process
    bool fails, resumes, differs;
} loop;

static size_t dying; ///< steps left

static bool die_or_go_on(void *context, double fraction)
{
    (void)context;
    (void)fraction;
    if (--dying == 0)
        _exit(0);
    return true;
}

static bat_status train_loop(const bat_group *group, void *context, bat_error *error)
{
    const loop *l = context;
    regression r;
    regression_begin(&r);
    size_t rank = group_rank(group), count = group_count(group);
    learn_job job = regression_job(&r);
    learn_options options = regression_options(&r);
    options.group = group;
    options.threads = l->threads;
    options.slots = l->slots;
    options.checkpoint = rank == 0 ? l->checkpoint : "/nowhere/at/all";
    options.resume = l->resumes;
    r.stop_at = rank + 1 == count ? l->stop_at : 0;
    r.fails = l->fails;
    dying = l->dies_at;
    if (rank == 1 && l->dies_at > 0)
        options.progress = (bat_progress){die_or_go_on, NULL};
    if (rank == 1 && l->differs)
        r.base.parameters.values[3] += (real)0.125;
    bat_status status = learn_train(&job, &options, NULL, error);
    if (rank == 0)
        memcpy(l->weights, r.base.parameters.values, r.base.parameters.total * sizeof(real));
    learn_parameters_free(&r.base.parameters);
    return status;
}

enum
{
    WEIGHTS = 3 * HIDDEN + 1
};

static void ranks_and_threads_change_no_byte(void **state)
{
    (void)state;
    real *weights = group_memory(WEIGHTS * sizeof *weights), first[WEIGHTS];
    static const size_t SLOTS[] = {0, 1, 4};
    for (size_t s = 0; s < sizeof SLOTS / sizeof *SLOTS; s++)
        for (size_t ranks = 1; ranks <= 8; ranks++)
            for (int threads = 1; threads <= 2; threads++)
            {
                loop l = {.weights = weights, .threads = threads, .slots = SLOTS[s]};
                memset(weights, 0, sizeof first);
                group_succeeds(ranks, train_loop, &l);
                if (ranks == 1 && threads == 1)
                    memcpy(first, weights, sizeof first);
                assert_memory_equal(weights, first, sizeof first);
            }
    (void)munmap(weights, WEIGHTS * sizeof *weights);
}

static void stops_and_deaths_lose_nothing(void **state)
{
    const train_folders *folders = *state;
    char path[200];
    real *weights = group_memory(WEIGHTS * sizeof *weights), whole[WEIGHTS];
    loop l = {.weights = weights, .threads = 1};
    group_succeeds(1, train_loop, &l);
    memcpy(whole, weights, sizeof whole);
    for (size_t step = 1; step < EPOCHS * STEPS; step += 5)
    {
        l = (loop){.weights = weights, .threads = 1, .checkpoint = path_in(folders->root, "c", path), .stop_at = step};
        const group_results *results = group_run(3, train_loop, &l);
        for (size_t rank = 0; rank < 3; rank++)
            assert_int_equal(results->status[rank], BAT_CANCELLED);
        l.resumes = true;
        l.stop_at = 0;
        l.dies_at = step;
        results = group_run(2, train_loop, &l);
        assert_true(results->status[0] == BAT_FILE_ACCESS || results->status[0] == BAT_OK);
        l.dies_at = 0;
        group_succeeds(4, train_loop, &l);
        assert_memory_equal(weights, whole, sizeof whole);
        (void)unlink(path);
    }
    (void)munmap(weights, WEIGHTS * sizeof *weights);
}

static void failures_reach_every_process(void **state)
{
    (void)state;
    real *weights = group_memory(WEIGHTS * sizeof *weights);
    loop l = {.weights = weights, .threads = 1, .fails = true};
    const group_results *results = group_run(3, train_loop, &l);
    for (size_t rank = 0; rank < 3; rank++)
        assert_int_equal(results->status[rank], BAT_INVALID_POINT);
    // A process with other weights.
    l = (loop){.weights = weights, .threads = 1, .differs = true};
    results = group_run(3, train_loop, &l);
    for (size_t rank = 0; rank < 3; rank++)
    {
        assert_int_equal(results->status[rank], BAT_UNSUPPORTED);
        assert_true(strstr(results->error[rank].text, "rank 1 has other weights than rank 0") == results->error[rank].text);
    }
    (void)munmap(weights, WEIGHTS * sizeof *weights);
}

// Every training

typedef enum kind
{
    CURVE_PUBLISHED,
    CURVE_BATTEN,
    MESH,
    SURFACE_PUBLISHED,
    SURFACE_BATTEN,
    KINDS
} kind;

typedef struct small
{
    kind kind;
    const char *folder;
    int threads;
    bool stops, resumes;
    bat_train_report *report; ///< shared: of rank 0
    bat_mesh shapes[2];
    bat_tension_data data;
} small;

static bool stop_after_a_third(void *context, double fraction)
{
    (void)context;
    return fraction < 0.3;
}

static bat_status train_curve(const small *s, const bat_train_options *run, bat_train_report *report, bat_error *error)
{
    bool batten = s->kind == CURVE_BATTEN;
    bat_curve_train_options options = bat_curve_train_defaults(batten ? BAT_RECIPE_BATTEN : BAT_RECIPE_PUBLISHED);
    bat_curve_train_report made = {0};
    options.run = *run;
    const curve_train_size size = {.data = batten ? NULL : &s->data, .steps = 2, .validation_curves = 3};
    bat_status status = curve_train_sized(&options, &size, &made, error);
    *report = made.run;
    return status;
}

static bat_status train_mesh(const small *s, const bat_train_options *run, bat_train_report *report, bat_error *error)
{
    bat_mesh_train_options options = bat_mesh_train_defaults(BAT_RECIPE_PUBLISHED);
    bat_mesh_train_report made = {0};
    options.run = *run;
    options.pairs = 5;
    options.resampled = 3;
    options.batch = 4;
    options.min_vertices = 12;
    options.max_vertices = 20;
    bat_status status = bat_mesh_train(s->shapes, 2, &options, &made, error);
    *report = made.run;
    return status;
}

static bat_status train_surface(const small *s, const bat_train_options *run, bat_train_report *report, bat_error *error)
{
    bat_surface_train_options options =
        bat_surface_train_defaults(s->kind == SURFACE_BATTEN ? BAT_RECIPE_BATTEN : BAT_RECIPE_PUBLISHED);
    bat_surface_train_report made = {0};
    options.run = *run;
    options.steps = 2;
    options.batch = 9;
    options.min_points = 20;
    options.max_points = 40;
    bat_status status = bat_surface_train(&options, &made, error);
    *report = made.run;
    return status;
}

static bat_status train_small(const bat_group *group, void *context, bat_error *error)
{
    const small *s = context;
    bat_train_report report = {0};
    bat_train_options run = {.seed = 1, .epochs = 2, .threads = s->threads, .resume = s->resumes, .group = group};
    run.folder = group_rank(group) == 0 ? s->folder : "/nowhere/at/all";
    if (s->stops)
        run.progress.report = stop_after_a_third;
    bat_status status = s->kind <= CURVE_BATTEN ? train_curve(s, &run, &report, error)
                        : s->kind == MESH       ? train_mesh(s, &run, &report, error)
                                                : train_surface(s, &run, &report, error);
    if (group_rank(group) == 0)
        *s->report = report;
    return status;
}

static void every_training_gives_the_same_bytes(void **state)
{
    const train_folders *folders = *state;
    bat_train_report alone = {0};
    small s = {.report = group_memory(sizeof *s.report)};
    s.shapes[0] = ball(3);
    s.shapes[1] = ball(2);
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        check_status(
            bat_tension_set_make((bat_tension_space)space, BAT_TENSION_SET_KIND_RESAMPLED, 5, 7, &s.data.train[space], NULL),
            BAT_OK);
        check_status(bat_tension_set_make((bat_tension_space)space, BAT_TENSION_SET_KIND_RESAMPLED, 2, 8,
                                          &s.data.validation[space], NULL),
                     BAT_OK);
    }
    for (s.kind = 0; s.kind < KINDS; s.kind++)
        for (size_t ranks = 1; ranks <= 4; ranks++)
        {
            s.threads = ranks == 2 ? 2 : 1;
            s.folder = ranks == 1 ? folders->a : folders->b;
            s.stops = s.resumes = false;
            group_succeeds(ranks, train_small, &s);
            if (ranks == 1)
            {
                alone = *s.report;
                continue;
            }
            assert_memory_equal(s.report, &alone, sizeof alone);
            assert_true(same_file(folders->a, folders->b, "model.safetensors"));
            assert_true(same_file(folders->a, folders->b, "checkpoint.safetensors"));
            remove_files(folders->b);
            if (ranks == 3)
                continue;
            // Stopped, and resumed by another number of processes.
            s.folder = folders->c;
            s.stops = true;
            assert_int_equal(group_run(ranks, train_small, &s)->status[0], BAT_CANCELLED);
            s.stops = false;
            s.resumes = true;
            group_succeeds(ranks - 1, train_small, &s);
            assert_true(same_file(folders->a, folders->c, "model.safetensors"));
            assert_true(same_file(folders->a, folders->c, "checkpoint.safetensors"));
            remove_files(folders->c);
        }
    bat_tension_data_free(&s.data);
    bat_mesh_free(&s.shapes[0]);
    bat_mesh_free(&s.shapes[1]);
    (void)munmap(s.report, sizeof *s.report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(items_reach_every_process),
        cmocka_unit_test(the_first_failure_reaches_every_process),
        cmocka_unit_test(ranks_and_threads_change_no_byte),
        cmocka_unit_test_setup_teardown(stops_and_deaths_lose_nothing, make_folders, remove_folders),
        cmocka_unit_test(failures_reach_every_process),
        cmocka_unit_test_setup_teardown(every_training_gives_the_same_bytes, make_folders, remove_folders),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
