// The loss of a training pair on a tape, against sums written out and central differences. Built in single and double
// precision.

#include "mesh_flap_helpers.h"

#include "learn/blas.h"
#include "research/train/mesh_sample.h"

static const bool DOUBLE = sizeof(real) == sizeof(double);

enum
{
    POINTS = 7,
    COLUMNS = 5,
    TARGETS = 11,
    LEVELS = 2
};

static double squared_distance(const real *point, const double *target)
{
    double sum = 0;
    for (size_t a = 0; a < 3; a++)
        sum += ((double)point[a] - target[a]) * ((double)point[a] - target[a]);
    return sum;
}

static double expected_chamfer(const real *points, const double *targets)
{
    double there = 0, back = 0;
    for (size_t i = 0; i < POINTS; i++)
    {
        double least = INFINITY;
        for (size_t k = 0; k < TARGETS; k++)
            least = fmin(least, squared_distance(points + COLUMNS * i, targets + 3 * k));
        there += least / POINTS;
    }
    for (size_t k = 0; k < TARGETS; k++)
    {
        double least = INFINITY;
        for (size_t i = 0; i < POINTS; i++)
            least = fmin(least, squared_distance(points + COLUMNS * i, targets + 3 * k));
        back += least / TARGETS;
    }
    return (there + back) / 6;
}

static void chamfer_is_what_it_says(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(1);
    learn_tape tape = learn_tape_make();
    learn_parameters parameters = {0};
    double targets[3 * TARGETS];
    real gradient[POINTS * COLUMNS] = {0};
    (void)learn_parameters_add(&parameters, POINTS, COLUMNS, "points");
    check_status(learn_parameters_allocate(&parameters, NULL), BAT_OK);
    for (size_t i = 0; i < POINTS * COLUMNS; i++)
        parameters.values[i] = (real)bat_random_normal(&random);
    for (size_t i = 0; i < 3 * TARGETS; i++)
        targets[i] = bat_random_normal(&random);
    learn_tape_begin(&tape, &parameters, gradient);
    learn_array *loss = mesh_sample_chamfer(&tape, learn_parameter_array(&tape, 0), targets, TARGETS);
    learn_tape_backward(&tape, loss, 1);
    check_status(learn_tape_status(&tape, NULL), BAT_OK);
    check_near((double)*loss->value, expected_chamfer(parameters.values, targets), DOUBLE ? 1e-13 : 1e-6);
    const double step = 1e-4;
    for (size_t i = 0; i < POINTS * COLUMNS && DOUBLE; i++)
    {
        real kept = parameters.values[i];
        parameters.values[i] = (real)((double)kept + step);
        double above = expected_chamfer(parameters.values, targets);
        parameters.values[i] = (real)((double)kept - step);
        double below = expected_chamfer(parameters.values, targets);
        parameters.values[i] = kept;
        check_near((double)gradient[i], (above - below) / (2 * step), 1e-10);
    }
    learn_tape_free(&tape);
    learn_parameters_free(&parameters);
}

static double expected_off_surface(const real *points, const double *targets, const double *normals, double slack)
{
    double sum = 0;
    for (size_t i = 0; i < POINTS; i++)
    {
        double off = 0, all = squared_distance(points + COLUMNS * i, targets + 3 * i);
        for (size_t a = 0; a < 3; a++)
            off += ((double)points[COLUMNS * i + a] - targets[3 * i + a]) * normals[3 * i + a];
        sum += sqrt(off * off + (all - off * off) / 10 + slack * slack) - slack;
    }
    return sum / POINTS;
}

static void what_lies_off_the_surface_counts(void **state)
{
    (void)state;
    const double slack = 0.3, step = 1e-4;
    bat_random random = bat_random_seed(2);
    learn_tape tape = learn_tape_make();
    learn_parameters parameters = {0};
    double targets[3 * POINTS], normals[3 * POINTS];
    real gradient[POINTS * COLUMNS] = {0};
    (void)learn_parameters_add(&parameters, POINTS, COLUMNS, "points");
    check_status(learn_parameters_allocate(&parameters, NULL), BAT_OK);
    for (size_t i = 0; i < POINTS * COLUMNS; i++)
        parameters.values[i] = (real)bat_random_normal(&random);
    for (size_t i = 0; i < POINTS; i++)
    {
        double length = 0;
        for (size_t a = 0; a < 3; a++)
        {
            targets[3 * i + a] = bat_random_normal(&random);
            normals[3 * i + a] = bat_random_normal(&random);
            length += normals[3 * i + a] * normals[3 * i + a];
        }
        for (size_t a = 0; a < 3; a++)
            normals[3 * i + a] /= sqrt(length);
    }
    learn_tape_begin(&tape, &parameters, gradient);
    learn_array *loss = mesh_sample_off_surface(&tape, learn_parameter_array(&tape, 0), targets, normals, slack);
    learn_tape_backward(&tape, loss, 1);
    check_status(learn_tape_status(&tape, NULL), BAT_OK);
    check_near((double)*loss->value, expected_off_surface(parameters.values, targets, normals, slack),
               DOUBLE ? 1e-13 : 1e-6);
    for (size_t i = 0; i < POINTS * COLUMNS && DOUBLE; i++)
    {
        real kept = parameters.values[i];
        parameters.values[i] = (real)((double)kept + step);
        double above = expected_off_surface(parameters.values, targets, normals, slack);
        parameters.values[i] = (real)((double)kept - step);
        double below = expected_off_surface(parameters.values, targets, normals, slack);
        parameters.values[i] = kept;
        check_near((double)gradient[i], (above - below) / (2 * step), 1e-8);
    }
    learn_tape_free(&tape);
    learn_parameters_free(&parameters);
}

/// With all weights zero new vertices halve the edges and nothing else moves: the loss is the mean square of what is left.
static void the_loss_adds_up_over_levels(void **state)
{
    (void)state;
    bat_mesh shape = ball(3);
    mesh_pair_plan plan = {.levels = LEVELS, .min_vertices = 20, .max_vertices = 20, .min_normal = 0.2, .min_quality = 0.2};
    mesh_pair pair;
    check_status(mesh_pair_make(&shape, &plan, 3, &pair, NULL), BAT_OK);
    learn_parameters parameters = {0};
    check_status(mesh_network_make((mesh_network_form){0}, &parameters, NULL), BAT_OK);
    learn_tape tape = learn_tape_make();
    double low[3] = {INFINITY, INFINITY, INFINITY}, size = 0, total = 0, last = 0;
    for (size_t i = 0; i < 3 * pair.coarse.vertex_count; i++)
        low[i % 3] = fmin(low[i % 3], pair.coarse.positions[i]);
    for (size_t i = 0; i < 3 * pair.coarse.vertex_count; i++)
        size = fmax(size, pair.coarse.positions[i] - low[i % 3]);
    for (size_t level = 0; level <= LEVELS; level++)
    {
        bat_mesh fine = split(&pair.coarse, level);
        double sum = 0;
        for (size_t i = 0; i < 3 * fine.vertex_count; i++)
            sum += pow((fine.positions[i] - pair.target[level][i]) / size, 2);
        last = sum / (double)(3 * fine.vertex_count);
        total += last;
        bat_mesh_free(&fine);
    }
    for (int only_last = 0; only_last < 2; only_last++)
    {
        double errors[LEVELS + 1];
        learn_tape_begin(&tape, &parameters, NULL);
        const learn_array *loss = mesh_sample_loss(&tape, (mesh_network_form){0},
                                                   (mesh_sample_loss_form){.last_level = only_last == 1}, &pair, errors);
        check_status(learn_tape_status(&tape, NULL), BAT_OK);
        check_relative((double)*loss->value, only_last == 1 ? last : total, DOUBLE ? 1e-12 : 1e-5);
        check_relative(errors[LEVELS], last, DOUBLE ? 1e-12 : 1e-5);
    }
    learn_tape_free(&tape);
    learn_parameters_free(&parameters);
    mesh_pair_free(&pair);
    bat_mesh_free(&shape);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chamfer_is_what_it_says),
        cmocka_unit_test(what_lies_off_the_surface_counts),
        cmocka_unit_test(the_loss_adds_up_over_levels),
    };
    blas_single_begin();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    blas_single_end();
    return failed;
}
