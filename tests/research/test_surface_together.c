// A fit by several processes, which are threads here: the same bits as by one, also from a state that was saved.

#include "group_helpers.h"
#include "surface_fit_helpers.h"

#include <pthread.h>

enum
{
    THREADS = 5
};

/// What the threads exchange.
typedef struct exchange
{
    pthread_barrier_t barrier;
    // The state after some round.
    int saves; ///< that are still kept
    char *head;
    size_t head_size;
    double *columns[4];
} exchange;

/// One process.
typedef struct process
{
    exchange *shared;
    group_links links;
    bat_group group;
    bat_surface_fit_backend backend;
    bat_surface_fit_data data;
    uint32_t *numbers;
    size_t first; ///< of its rows
    const bat_surface_fit_options *options;
    bat_spline_surface surface;
    bat_surface_fit_report report;
    bat_status status;
    bat_error error;
    pthread_t thread;
} process;

static void wait_for_all(process *own)
{
    (void)pthread_barrier_wait(&own->shared->barrier);
}

static bat_status save(void *context, const void *head, size_t size, const bat_surface_fit_column *columns, size_t count,
                       bat_error *error)
{
    (void)error;
    process *own = context;
    exchange *shared = own->shared;
    wait_for_all(own);
    if (shared->saves > 0)
    {
        for (size_t k = 0; k < count; k++)
            memcpy(shared->columns[k] + own->first * columns[k].width, columns[k].values,
                   own->data.count * columns[k].width * sizeof(double));
        if (own->group.rank == 0)
        {
            free(shared->head);
            shared->head = malloc(size);
            shared->head_size = size;
            memcpy(shared->head, head, size);
        }
    }
    wait_for_all(own);
    if (own->group.rank == 0)
        shared->saves--;
    wait_for_all(own);
    return BAT_OK;
}

static bat_status load(void *context, void **head, size_t *size, const bat_surface_fit_column *columns, size_t count,
                       bat_error *error)
{
    (void)error;
    process *own = context;
    *head = NULL;
    if (own->shared->head == NULL)
        return BAT_OK;
    *head = malloc(own->shared->head_size);
    *size = own->shared->head_size;
    memcpy(*head, own->shared->head, *size);
    for (size_t k = 0; k < count; k++)
        memcpy(columns[k].values, own->shared->columns[k] + own->first * columns[k].width,
               own->data.count * columns[k].width * sizeof(double));
    return BAT_OK;
}

static void *run(void *context)
{
    process *own = context;
    own->status = bat_surface_fit_together(&own->group, &own->backend, &own->data, own->numbers, own->options, &own->surface,
                                           &own->report, &own->error);
    return NULL;
}

/// A point with its place on the curve.
typedef struct placed
{
    uint32_t place, number;
} placed;

static int compare_placed(const void *a, const void *b)
{
    const placed *x = a, *y = b;
    if (x->place != y->place)
        return x->place < y->place ? -1 : 1;
    return (x->number > y->number) - (x->number < y->number);
}

/// Fit by threads and compare with the surface and the report of one.
/// @param shared its state is loaded and saved
static void compare(const surface_sample *sample, const bat_surface_fit_options *options, size_t ranks, exchange *shared,
                    const bat_spline_surface *surface, const bat_surface_fit_report *report)
{
    size_t own_count = sample->data.count, count = own_count;
    bat_surface_border *curves[THREADS] = {0};
    const double *places = NULL, *at = NULL;
    for (size_t rank = 0; rank < ranks && sample->data.border; rank++)
    {
        check_status(bat_surface_border_make(&sample->data, options, &curves[rank], NULL), BAT_OK);
        count = own_count + bat_surface_border_samples(curves[rank], &places, &at);
        assert_true(count > own_count);
    }
    size_t blocks = (count + BAT_SURFACE_FIT_BLOCK - 1) / BAT_SURFACE_FIT_BLOCK;
    placed *order = calloc(count, sizeof *order);
    double *points = calloc(3 * count, sizeof *points), *parameters = calloc(2 * count, sizeof *parameters);
    uint32_t *numbers = calloc(count, sizeof *numbers);
    process each[THREADS] = {0};
    for (size_t i = 0; i < count; i++)
        order[i] = (placed){
            bat_surface_fit_order(i < own_count ? sample->data.parameters + 2 * i : at + 2 * (i - own_count)), (uint32_t)i};
    qsort(order, count, sizeof *order, compare_placed);
    for (size_t row = 0; row < count; row++)
    {
        size_t i = numbers[row] = order[row].number;
        bool is_sample = i >= own_count;
        memcpy(points + 3 * row, is_sample ? places + 3 * (i - own_count) : sample->points + 3 * i, 3 * sizeof *points);
        memcpy(parameters + 2 * row, is_sample ? at + 2 * (i - own_count) : sample->data.parameters + 2 * i,
               2 * sizeof *parameters);
    }
    group_links links = {0};
    group_join(ranks, links.ends);
    assert_int_equal(pthread_barrier_init(&shared->barrier, NULL, (unsigned)ranks), 0);
    for (size_t rank = 0; rank < ranks; rank++)
    {
        size_t begin = blocks * rank / ranks * BAT_SURFACE_FIT_BLOCK;
        size_t end = blocks * (rank + 1) / ranks * BAT_SURFACE_FIT_BLOCK;
        begin = begin < count ? begin : count;
        end = end < count ? end : count;
        process *own = &each[rank];
        *own = (process){.shared = shared, .first = begin, .numbers = numbers + begin, .options = options};
        own->data = sample->data;
        own->data.points = points + 3 * begin;
        own->data.parameters = parameters + 2 * begin;
        own->data.count = end - begin;
        own->data.curves = curves[rank];
        own->links = links;
        own->links.rank = rank;
        own->group =
            (bat_group){.rank = rank, .count = ranks, .context = &own->links, .send = group_send, .receive = group_receive};
        own->backend = (bat_surface_fit_backend){.context = own, .save = save, .load = load};
        assert_int_equal(pthread_create(&own->thread, NULL, run, own), 0);
    }
    size_t functions = bat_hierarchical_space_functions(surface->space);
    for (size_t rank = 0; rank < ranks; rank++)
    {
        process *own = &each[rank];
        assert_int_equal(pthread_join(own->thread, NULL), 0);
        if (own->status != BAT_OK)
            fail_msg("%s", own->error.text);
        assert_int_equal(bat_hierarchical_space_functions(own->surface.space), functions);
        assert_memory_equal(own->surface.control, surface->control, 3 * functions * sizeof(double));
        assert_int_equal(own->report.count, report->count);
        assert_int_equal(own->report.outliers, report->outliers);
        assert_int_equal(own->report.moved, report->moved);
        assert_int_equal(own->report.held_out_count, report->held_out_count);
        assert_memory_equal(&own->report.held_out_rms, &report->held_out_rms, sizeof(double));
        for (size_t k = 0; k < report->count; k++)
        {
            own->report.rounds[k].seconds = report->rounds[k].seconds;
            assert_memory_equal(&own->report.rounds[k], &report->rounds[k], sizeof *report->rounds);
        }
        for (size_t i = 0; i < own->data.count; i++)
            if (own->numbers[i] < own_count)
                check_near(own->report.distances[i], report->distances[own->numbers[i]], 0);
        bat_surface_border_free(curves[rank]);
        bat_spline_surface_free(&own->surface);
        bat_surface_fit_report_free(&own->report);
    }
    group_part(ranks, links.ends);
    (void)pthread_barrier_destroy(&shared->barrier);
    free(order);
    free(points);
    free(parameters);
    free(numbers);
}

static const bat_surface_fit_options *options_of(int kind)
{
    static bat_surface_fit_options options;
    options = bat_surface_fit_defaults();
    options.threads = 1;
    if (kind == 1)
        options.functions = 300;
    // Kind 4 has the default options.
    if (kind == 2)
    {
        options.tolerance = 2e-3;
        options.robust = true;
        options.final_corrections = 2;
        options.space.degree[0] = 3;
        options.corrections = 2;
    }
    if (kind == 3)
    {
        options.functions = 200;
        options.hold_out = 0;
        options.smoothing = BAT_SURFACE_SMOOTHING_CROSS_VALIDATION;
    }
    return &options;
}

/// For several numbers of processes, and kinds of fits.
static void several_processes_give_the_same_bits(void **state)
{
    (void)state;
    for (int kind = 0; kind < 5; kind++)
    {
        const bat_surface_fit_options *options = options_of(kind);
        surface_sample sample = sample_make(shape_hills, 5000, kind < 2 ? 0 : 80, kind == 1 ? 0.01 : 1e-3, 12);
        sample.data.border = kind >= 2;
        if (kind == 2)
            for (size_t i = 100; i < 5000; i += 97)
                sample.points[3 * i + 2] += 0.3;
        double *parameters = calloc(2 * sample.data.count, sizeof *parameters);
        memcpy(parameters, sample.data.parameters, 2 * sample.data.count * sizeof *parameters);
        bat_spline_surface surface;
        bat_surface_fit_report report;
        check_status(bat_surface_fit(&sample.data, options, &surface, &report, NULL), BAT_OK);
        memcpy(sample.data.parameters, parameters, 2 * sample.data.count * sizeof *parameters);
        for (size_t ranks = 1; ranks <= THREADS; ranks += ranks)
        {
            exchange shared = {0};
            compare(&sample, options, ranks, &shared, &surface, &report);
        }
        bat_spline_surface_free(&surface);
        bat_surface_fit_report_free(&report);
        free(parameters);
        sample_free(&sample);
    }
}

static surface_sample scattered(size_t count)
{
    return sample_make(shape_hills, count, 0, 0.01, 5);
}

/// Processes that begin with a state that others saved, also others in number, end with the same bits.
static void a_saved_state_is_taken_up(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++)
        for (int saves = 1; saves <= 4; saves += 3)
        {
            const bat_surface_fit_options *options = options_of(kind);
            surface_sample sample = kind == 2 ? sample_make(shape_hills, 5000, 80, 0.01, 5) : scattered(5000);
            sample.data.border = kind == 2;
            double *parameters = calloc(2 * sample.data.count, sizeof *parameters);
            memcpy(parameters, sample.data.parameters, 2 * sample.data.count * sizeof *parameters);
            bat_spline_surface surface;
            bat_surface_fit_report report;
            check_status(bat_surface_fit(&sample.data, options, &surface, &report, NULL), BAT_OK);
            memcpy(sample.data.parameters, parameters, 2 * sample.data.count * sizeof *parameters);
            exchange shared = {.saves = saves};
            for (int k = 0; k < 4; k++)
                shared.columns[k] = calloc(2 * sample.data.count + 1000, sizeof(double));
            compare(&sample, options, 3, &shared, &surface, &report);
            assert_non_null(shared.head);
            shared.saves = 0;
            compare(&sample, options, 2, &shared, &surface, &report);
            for (int k = 0; k < 4; k++)
                free(shared.columns[k]);
            free(shared.head);
            bat_spline_surface_free(&surface);
            bat_surface_fit_report_free(&report);
            free(parameters);
            sample_free(&sample);
        }
}

/// Points out of order, and blocks in parts, are refused by all.
static void wrong_parts_are_refused(void **state)
{
    (void)state;
    surface_sample sample = scattered(2000);
    uint32_t *numbers = calloc(2000, sizeof *numbers);
    for (uint32_t i = 0; i < 2000; i++)
        numbers[i] = i;
    bat_spline_surface surface;
    bat_error error;
    check_status(bat_surface_fit_together(NULL, NULL, &sample.data, numbers, NULL, &surface, NULL, &error),
                 BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "order"));
    free(numbers);
    sample_free(&sample);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(several_processes_give_the_same_bits),
        cmocka_unit_test(a_saved_state_is_taken_up),
        cmocka_unit_test(wrong_parts_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
