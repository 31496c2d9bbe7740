// The learned mesh network on a tape: its derivatives against central differences, and the loss of a sample. Built in single
// and double precision.

#include "mesh_flap_helpers.h"
#include "mesh_makers.h"

#include "learn/blas.h"
#include "research/train/mesh_task.h"

static const bool DOUBLE = sizeof(real) == sizeof(double);

/// A level that is refined, and a random linear function of the result.
typedef struct probe
{
    bat_mesh mesh;
    mesh_levels levels;
    mesh_learned_rows rows;
    learn_parameters parameters;
    real *weights;
    size_t count; ///< of coordinates of the result
} probe;

static probe make_probe(bool random)
{
    probe p = {.mesh = mesh_irregular(8, 5, 2)};
    bat_random stream = bat_random_seed(3);
    p.mesh.face_count--;
    p.levels = levels_of(&p.mesh, 1);
    check_status(mesh_learned_rows_make(&p.levels.level[0], &p.rows, NULL), BAT_OK);
    check_status(mesh_learned_make(&p.parameters, NULL), BAT_OK);
    if (random)
    {
        mesh_learned_start(&p.parameters, 1);
        for (size_t i = 0; i < p.parameters.total; i++)
            p.parameters.values[i] += (real)(0.03 * bat_random_normal(&stream));
    }
    p.count = 3 * p.levels.vertex_count;
    p.weights = test_memory(p.count, sizeof *p.weights);
    for (size_t i = 0; i < p.count; i++)
        p.weights[i] = (real)bat_random_normal(&stream);
    return p;
}

static void free_probe(probe *p)
{
    bat_mesh_free(&p->mesh);
    mesh_levels_free(&p->levels);
    mesh_learned_rows_free(&p->rows);
    learn_parameters_free(&p->parameters);
    free(p->weights);
}

/// The function. Gradients by weights and by positions are received where they are not null. With `far` moves are much
/// shorter than their bound.
static double evaluate(const probe *p, const double *positions, bool far, real *gradient, real *by_position)
{
    learn_tape tape = learn_tape_make();
    learned_geometry geometry;
    size_t vertices = p->mesh.vertex_count;
    check_status(learned_geometry_make(&p->levels.level[0], positions, &geometry, NULL), BAT_OK);
    for (size_t v = 0; v < vertices && far; v++)
        geometry.size[v] = 1e9;
    learn_tape_begin(&tape, &p->parameters, gradient);
    learn_array *from = learn_array_make(&tape, vertices, 3, true), *state = NULL, *context = NULL;
    for (size_t i = 0; i < 3 * vertices; i++)
        from->value[i] = (real)positions[i];
    learn_array *to = mesh_learned_level(&tape, 0, &p->levels.level[0], &p->rows, &geometry, 0, from, 0.3, &state, &context);
    learn_array *sum = learn_sum(&tape, learn_multiply(&tape, to, learn_constant(&tape, to->rows, 3, p->weights)));
    check_status(learn_tape_status(&tape, NULL), BAT_OK);
    double value = (double)*sum->value;
    if (gradient != NULL)
        learn_tape_backward(&tape, sum, 1);
    if (by_position != NULL)
        memcpy(by_position, learn_gradient(from), 3 * vertices * sizeof *by_position);
    learned_geometry_free(&geometry);
    learn_tape_free(&tape);
    return value;
}

static void derivatives_by_weights_are_right(void **state)
{
    (void)state;
    if (!DOUBLE)
        return;
    probe p = make_probe(true);
    const double step = 1e-6;
    real *gradient = test_memory(p.parameters.total, sizeof *gradient);
    (void)evaluate(&p, p.mesh.positions, false, gradient, NULL);
    size_t checked = 0;
    for (size_t i = 0; i < p.parameters.total; i += 7)
    {
        real *weight = &p.parameters.values[i], kept = *weight;
        if (gradient[i] == 0)
            continue;
        *weight = kept + (real)step;
        double up = evaluate(&p, p.mesh.positions, false, NULL, NULL);
        *weight = kept - (real)step;
        double down = evaluate(&p, p.mesh.positions, false, NULL, NULL);
        *weight = kept;
        check_near((up - down) / (2 * step), (double)gradient[i], 1e-6 * (1 + fabs((double)gradient[i])));
        checked++;
    }
    assert_true(checked > 1000);
    free(gradient);
    free_probe(&p);
}

/// With constant coefficients of the candidates that are no projections, and no bound, a level is linear in the positions.
static void derivatives_by_positions_are_right(void **state)
{
    (void)state;
    probe p = make_probe(false);
    const size_t own[] = {LEARNED_VERTEX_LAST_BIAS, LEARNED_EDGE_LAST_BIAS}, counts[] = {LEARNED_VERTEX_CANDIDATES, 4};
    for (size_t k = 0; k < 2; k++)
        for (size_t i = 0; i < counts[k]; i += k == 0 ? 2 : 1)
            learn_parameter_values(&p.parameters, own[k])[i] = (real)(0.3 + 0.1 * (double)i);
    learn_parameter_values(&p.parameters, LEARNED_RING_LAST_BIAS)[0] = (real)0.4;
    learn_parameter_values(&p.parameters, LEARNED_RING_LAST_BIAS)[1] = (real)-0.7;
    size_t numbers = 3 * p.mesh.vertex_count;
    real *gradient = test_memory(p.parameters.total, sizeof *gradient),
         *by_position = test_memory(numbers, sizeof *by_position);
    double *positions = test_memory(numbers, sizeof *positions);
    memcpy(positions, p.mesh.positions, numbers * sizeof *positions);
    double before = evaluate(&p, positions, true, gradient, by_position);
    const double step = 0.5;
    for (size_t i = 0; i < numbers; i += DOUBLE ? 1 : 17)
    {
        positions[i] += step;
        double after = evaluate(&p, positions, true, NULL, NULL);
        positions[i] -= step;
        check_near((after - before) / step, (double)by_position[i], DOUBLE ? 1e-10 : 2e-3);
    }
    free(gradient);
    free(by_position);
    free(positions);
    free_probe(&p);
}

/// The sum of all derivatives by positions is the function's weight, for any network: results move with the mesh.
static void derivatives_know_translations(void **state)
{
    (void)state;
    probe p = make_probe(true);
    size_t vertices = p.mesh.vertex_count;
    real *gradient = test_memory(p.parameters.total, sizeof *gradient),
         *by_position = test_memory(3 * vertices, sizeof *by_position);
    (void)evaluate(&p, p.mesh.positions, false, gradient, by_position);
    for (size_t c = 0; c < 3; c++)
    {
        double sum = 0, expected = 0;
        for (size_t v = 0; v < vertices; v++)
            sum += (double)by_position[3 * v + c];
        for (size_t i = c; i < p.count; i += 3)
            expected += (double)p.weights[i];
        check_near(sum, expected, DOUBLE ? 1e-11 : 1e-3);
    }
    free(gradient);
    free(by_position);
    free_probe(&p);
}

/// The loss of every kind of coarse mesh is finite, a few steps along its gradient make it smaller, and the measures belong
/// to the mesh.
static void samples_can_be_learned(void **state)
{
    (void)state;
    static const mesh_task_weights WEIGHTS = {
        .hinge = 1, .margin = 0.1, .rms = 0.3, .peak = 0.1, .rough = {0.05, 5}, .volume = {4, 20}};
    bat_mesh shape = ball(4);
    for (size_t v = 0; v < shape.vertex_count; v++)
        shape.positions[3 * v] *= 1.5;
    mesh_target target;
    learn_parameters parameters = {0};
    learn_tape tape = learn_tape_make();
    check_status(mesh_target_make(&shape, 1, &target, NULL), BAT_OK);
    assert_null(shape.positions);
    assert_true(target.closed);
    check_near(target.volume, 1.5 * 4.18879, 0.05);
    check_status(mesh_learned_make(&parameters, NULL), BAT_OK);
    real *gradient = test_memory(parameters.total, sizeof *gradient);
    for (int kind = 0; kind < COARSE_KINDS; kind++)
    {
        bat_random random = bat_random_seed(4);
        mesh_task task;
        check_status(mesh_task_make(&target, (coarse_kind)kind, 60, &random, &task, NULL), BAT_OK);
        assert_in_range(task.coarse.vertex_count, 50, 75);
        assert_int_equal(task.fine.face_count, 16 * task.coarse.face_count);
        // Vertices that lie on the shape: of the fine mesh, or projected.
        double farthest = 0;
        for (size_t v = 0; v < task.coarse.vertex_count; v++)
        {
            uint32_t place = 0;
            farthest = fmax(farthest, closest_find(&target.tree, task.coarse.positions + 3 * v, &place));
        }
        assert_int_equal(farthest < 1e-9, kind == COARSE_KEPT || kind == COARSE_REMESHED);
        mesh_learned_start(&parameters, 1);
        double first = 0, last = 0;
        for (int round = 0; round < 20; round++)
        {
            mesh_fit fit;
            bat_random samples = bat_random_seed(5);
            memset(gradient, 0, parameters.total * sizeof *gradient);
            learn_tape_begin(&tape, &parameters, gradient);
            learn_array *loss = mesh_task_loss(&tape, &task, 0.25, &WEIGHTS, 300, &samples, &fit);
            check_status(learn_tape_status(&tape, NULL), BAT_OK);
            learn_tape_backward(&tape, loss, 1);
            last = (double)*loss->value;
            first = round == 0 ? last : first;
            assert_true(isfinite(last) && fit.mean > 0 && fit.rms >= fit.mean && fit.peak >= fit.rms);
            double squares = 0;
            for (size_t i = 0; i < parameters.total; i++)
                squares += (double)gradient[i] * (double)gradient[i];
            assert_true(squares > 0);
            for (size_t i = 0; i < parameters.total; i++)
                parameters.values[i] -= (real)(0.03 / sqrt(squares)) * gradient[i];
        }
        assert_true(last < first - 0.02);
        mesh_task_free(&task);
    }
    free(gradient);
    learn_tape_free(&tape);
    learn_parameters_free(&parameters);
    mesh_target_free(&target);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivatives_by_weights_are_right),
        cmocka_unit_test(derivatives_by_positions_are_right),
        cmocka_unit_test(derivatives_know_translations),
        cmocka_unit_test(samples_can_be_learned),
    };
    blas_single_begin();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    blas_single_end();
    return failed;
}
