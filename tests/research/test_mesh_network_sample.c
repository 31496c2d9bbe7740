// The network for meshes on a tape: the published weights against what the published program makes of three meshes, and all
// derivatives against central differences. Built in single and double precision.

#include "mesh_flap_helpers.h"

#include "learn/blas.h"
#include "research/train/mesh_network_tape.h"

static const bool DOUBLE = sizeof(real) == sizeof(double);

enum
{
    LEVELS = 2
};

// The published network

static learn_array *positions_of(learn_tape *tape, const bat_mesh *mesh)
{
    learn_array *positions = learn_array_make(tape, mesh->vertex_count, 3, false);
    for (size_t i = 0; i < learn_size(positions); i++)
        positions->value[i] = (real)mesh->positions[i];
    return positions;
}

static void check_level(const learn_array *state, const safetensors *expected, const char *name, double tolerance)
{
    const safetensors_array *array = safetensors_find(expected, name);
    assert_non_null(array);
    assert_int_equal(state->rows, array->shape[0]);
    double *theirs = test_memory(array->count, sizeof *theirs), *ours = test_memory(array->count, sizeof *ours);
    uint32_t *match = test_memory(state->rows, sizeof *match);
    check_status(safetensors_doubles(expected, name, array->count, theirs, NULL), BAT_OK);
    for (size_t i = 0; i < array->count; i++)
        ours[i] = (double)state->value[i / 3 * state->columns + i % 3];
    match_vertices(ours, theirs, state->rows, tolerance, match);
    free(theirs);
    free(ours);
    free(match);
}

static void check_published(const learn_parameters *parameters, const char *path)
{
    safetensors expected;
    if (!read_shared(path, &expected))
        return;
    bat_mesh mesh = mesh_in(&expected, "vertices.0.input", "faces.0");
    mesh_levels levels = levels_of(&mesh, LEVELS);
    learn_tape tape = learn_tape_make();
    learn_array *states[LEVELS + 1];
    learn_tape_begin(&tape, parameters, NULL);
    mesh_network_refine(&tape, (mesh_network_form){0}, &levels, positions_of(&tape, &mesh), states);
    check_status(learn_tape_status(&tape, NULL), BAT_OK);
    check_level(states[0], &expected, "vertices.0", 1e-5);
    check_level(states[1], &expected, "vertices.1", 1e-5);
    check_level(states[2], &expected, "vertices.2", 1e-5);
    learn_tape_free(&tape);
    mesh_levels_free(&levels);
    bat_mesh_free(&mesh);
    safetensors_free(&expected);
}

static void published_weights_give_published_meshes(void **state)
{
    (void)state;
    safetensors weights;
    if (!read_shared(NEURAL_MESH "elephant.safetensors", &weights))
        return;
    learn_parameters parameters = {0};
    check_status(mesh_network_make((mesh_network_form){0}, &parameters, NULL), BAT_OK);
    check_status(learn_parameters_extract(&parameters, &weights, "", parameters.values, NULL), BAT_OK);
    check_published(&parameters, NEURAL_MESH "spot.safetensors");
    check_published(&parameters, NEURAL_MESH "bunny.safetensors");
    check_published(&parameters, NEURAL_MESH "horse.safetensors");
    learn_parameters_free(&parameters);
    safetensors_free(&weights);
}

// Derivatives

/// A sum that no symmetry makes vanish, of all numbers of an array.
static learn_array *judge(learn_tape *tape, learn_array *x, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    learn_array *weights = learn_array_make(tape, x->rows, x->columns, false);
    for (size_t i = 0; i < learn_size(weights); i++)
        weights->value[i] = (real)bat_random_normal(&random);
    return learn_sum(tape, learn_multiply(tape, x, weights));
}

typedef struct experiment
{
    mesh_levels levels;
    learn_parameters parameters; ///< the network's, and the positions behind
    mesh_network_form form;
    flap_frame_options view;
} experiment;

typedef learn_array *measure(learn_tape *tape, const experiment *e);

/// All of the network, at all levels, with the positions as a parameter.
static learn_array *measure_network(learn_tape *tape, const experiment *e)
{
    learn_array *states[LEVELS + 1], *sum = NULL;
    learn_array *positions = learn_parameter_array(tape, MESH_PARAMETERS);
    mesh_network_refine(tape, e->form, &e->levels, positions, states);
    for (size_t i = 0; i <= LEVELS; i++)
    {
        learn_array *own = judge(tape, states[i], i);
        sum = i == 0 ? own : learn_add(tape, sum, own);
    }
    return sum;
}

/// What is seen, and displacements that do not depend on it: derivatives through frames and lengths alone.
static learn_array *measure_sight(learn_tape *tape, const experiment *e)
{
    const mesh_flaps *flaps = &e->levels.level[0];
    bat_random random = bat_random_seed(9);
    learn_array *state = tape_flap_differences(tape, flaps, learn_parameter_array(tape, MESH_PARAMETERS));
    tape_flap_local local = tape_flap_localize(tape, flaps, e->view, state, 1);
    learn_array *output = learn_array_make(tape, flaps->count, 6, true);
    for (size_t i = 0; i < learn_size(output); i++)
        output->value[i] = (real)bat_random_normal(&random);
    learn_array *inserted = tape_flap_insert(tape, &local, output, state);
    return learn_add(tape, judge(tape, local.coordinates, 1), judge(tape, inserted, 2));
}

static double value_of(learn_tape *tape, const experiment *e, measure *made, real *gradient)
{
    learn_tape_begin(tape, &e->parameters, gradient);
    learn_array *sum = made(tape, e);
    if (gradient != NULL)
        learn_tape_backward(tape, sum, 1);
    check_status(learn_tape_status(tape, NULL), BAT_OK);
    return (double)*sum->value;
}

/// Differences of fourth order at every `stride`-th parameter and at all positions.
static void check_derivatives(const experiment *e, measure *made, size_t stride)
{
    const learn_parameters *p = &e->parameters;
    learn_tape tape = learn_tape_make();
    real *gradient = test_memory(p->total, sizeof *gradient);
    (void)value_of(&tape, e, made, gradient);
    size_t positions = p->list[MESH_PARAMETERS].offset;
    const double step = 1e-5;
    for (size_t i = 0; i < p->total && DOUBLE; i = i >= positions ? i + 1 : i + stride < positions ? i + stride : positions)
    {
        real kept = p->values[i];
        double sums[4];
        for (int k = 0; k < 4; k++)
        {
            static const double at[4] = {-2, -1, 1, 2};
            p->values[i] = (real)((double)kept + at[k] * step);
            sums[k] = value_of(&tape, e, made, NULL);
        }
        p->values[i] = kept;
        double slope = (8 * (sums[2] - sums[1]) - (sums[3] - sums[0])) / (12 * step);
        check_near((double)gradient[i], slope, 2e-7 * (1 + fabs(slope)));
    }
    for (size_t i = 0; i < p->total; i++)
        assert_true(isfinite(gradient[i]));
    free(gradient);
    learn_tape_free(&tape);
}

static experiment make_experiment(size_t missing, mesh_network_form form, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    bat_mesh mesh = octahedron(missing, 0.3, &random);
    experiment e = {.levels = levels_of(&mesh, LEVELS), .form = form};
    learn_parameters network = {0};
    check_status(mesh_network_make(form, &network, NULL), BAT_OK);
    mesh_network_start(&network, seed);
    for (size_t i = 0; i < network.count; i++)
        (void)learn_parameters_add(&e.parameters, network.list[i].rank == 2 ? network.list[i].rows : 0,
                                   network.list[i].columns, network.list[i].name);
    (void)learn_parameters_add(&e.parameters, mesh.vertex_count, 3, "positions");
    check_status(learn_parameters_allocate(&e.parameters, NULL), BAT_OK);
    memcpy(e.parameters.values, network.values, network.total * sizeof(real));
    for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
        learn_parameter_values(&e.parameters, MESH_PARAMETERS)[i] = (real)mesh.positions[i];
    learn_parameters_free(&network);
    bat_mesh_free(&mesh);
    return e;
}

static void experiment_free(experiment *e)
{
    mesh_levels_free(&e->levels);
    learn_parameters_free(&e->parameters);
}

static void derivatives_go_through_frames_and_lengths(void **state)
{
    (void)state;
    for (size_t missing = 0; missing < 4; missing++)
        for (int fixed = 0; fixed < 2; fixed++)
            for (int relative = 0; relative < 2; relative++)
            {
                experiment e = make_experiment(missing, (mesh_network_form){0}, 3 + missing);
                e.view = (flap_frame_options){.fixed = fixed == 1, .relative = relative == 1};
                check_derivatives(&e, measure_sight, SIZE_MAX / 2);
                experiment_free(&e);
            }
}

static void derivatives_go_through_all_levels(void **state)
{
    (void)state;
    static const mesh_network_form forms[] = {{0}, {.fixed_frames = true}, {.no_differences = true}, {.relative = true}};
    for (size_t missing = 0; missing < 4; missing += 3)
        for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
        {
            experiment e = make_experiment(missing, forms[i], 20 + i);
            check_derivatives(&e, measure_network, 97);
            experiment_free(&e);
        }
}

// Motions

/// A turn about an oblique axis, a shift, and a factor.
static void move_point(const double *p, double factor, double *moved)
{
    static const double turn[9] = {2.0 / 3, -1.0 / 3, 2.0 / 3, 2.0 / 3, 2.0 / 3, -1.0 / 3, -1.0 / 3, 2.0 / 3, 2.0 / 3};
    for (size_t a = 0; a < 3; a++)
        moved[a] = factor * (turn[3 * a] * p[0] + turn[3 * a + 1] * p[1] + turn[3 * a + 2] * p[2] + 0.3 + (double)a);
}

/// Moving a mesh moves what becomes of it, and leaves features alone.
static void check_motion(mesh_network_form form, size_t missing, double factor)
{
    const double tolerance = DOUBLE ? 1e-11 : 3e-4;
    experiment e = make_experiment(missing, form, 40 + missing);
    learn_tape tapes[2] = {learn_tape_make(), learn_tape_make()};
    learn_array *states[2][LEVELS + 1];
    real *positions = learn_parameter_values(&e.parameters, MESH_PARAMETERS);
    for (int i = 0; i < 2; i++)
    {
        for (size_t v = 0; v < e.levels.level[0].vertex_count && i == 1; v++)
        {
            double p[3] = {(double)positions[3 * v], (double)positions[3 * v + 1], (double)positions[3 * v + 2]}, moved[3];
            move_point(p, factor, moved);
            for (size_t a = 0; a < 3; a++)
                positions[3 * v + a] = (real)moved[a];
        }
        learn_tape_begin(&tapes[i], &e.parameters, NULL);
        mesh_network_refine(&tapes[i], form, &e.levels, learn_parameter_array(&tapes[i], MESH_PARAMETERS), states[i]);
        check_status(learn_tape_status(&tapes[i], NULL), BAT_OK);
    }
    for (size_t level = 0; level <= LEVELS; level++)
        for (size_t v = 0; v < states[0][level]->rows; v++)
        {
            const real *here = states[0][level]->value + v * MESH_WIDTH, *there = states[1][level]->value + v * MESH_WIDTH;
            double p[3] = {(double)here[0], (double)here[1], (double)here[2]}, moved[3];
            move_point(p, factor, moved);
            for (size_t c = 0; c < MESH_WIDTH; c++)
                check_near((double)there[c], c < 3 ? moved[c] : (double)here[c], tolerance * (c < 3 ? factor : 1));
        }
    learn_tape_free(&tapes[0]);
    learn_tape_free(&tapes[1]);
    experiment_free(&e);
}

static void results_move_with_the_mesh(void **state)
{
    (void)state;
    for (size_t missing = 0; missing < 5; missing += 2)
    {
        check_motion((mesh_network_form){0}, missing, 1);
        check_motion((mesh_network_form){.relative = true}, missing, 1);
        check_motion((mesh_network_form){.relative = true}, missing, 1e-3);
        check_motion((mesh_network_form){.relative = true}, missing, 1e3);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(published_weights_give_published_meshes),
        cmocka_unit_test(derivatives_go_through_frames_and_lengths),
        cmocka_unit_test(derivatives_go_through_all_levels),
        cmocka_unit_test(results_move_with_the_mesh),
    };
    blas_single_begin();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    blas_single_end();
    return failed;
}
