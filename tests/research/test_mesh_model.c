// Learned refinement of meshes: published weights against the published program's meshes, and properties for any weights.

#include "mesh_flap_helpers.h"

#include "batten/mesh_decimate.h"
#include "batten/mesh_measure.h"
#include "batten/mesh_refine.h"
#include "batten/research/mesh_shapes.h"
#include "batten/research/networks.h"
#include "research/learn/parameters.h"
#include "research/train/mesh_network_tape.h"

#include <unistd.h>

static bat_mesh refined(const bat_mesh_model *model, const bat_mesh *coarse, size_t levels, int threads, size_t *fallback)
{
    bat_mesh fine;
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_LEARNED;
    options.rule = bat_mesh_model_rule(model);
    options.levels = levels;
    options.threads = threads;
    check_status(bat_mesh_refine(coarse, &options, &fine, fallback, NULL), BAT_OK);
    return fine;
}

static void check_published(const bat_mesh_model *model, const char *path)
{
    safetensors expected;
    if (!read_shared(path, &expected))
        return;
    bat_mesh coarse = mesh_in(&expected, "vertices.0.input", "faces.0");
    for (size_t level = 1; level <= 2; level++)
    {
        bat_mesh theirs = mesh_in(&expected, level == 1 ? "vertices.1" : "vertices.2", level == 1 ? "faces.1" : "faces.2");
        for (int threads = 1; threads <= 3; threads += 2)
        {
            size_t fallback = 1;
            bat_mesh ours = refined(model, &coarse, level, threads, &fallback);
            assert_int_equal(fallback, 0);
            check_same_mesh(&ours, &theirs, 1e-5);
            bat_mesh_free(&ours);
        }
        bat_mesh_free(&theirs);
    }
    bat_mesh_free(&coarse);
    safetensors_free(&expected);
}

static void published_weights_give_published_meshes(void **state)
{
    (void)state;
    bat_mesh_model *model = NULL;
    if (bat_mesh_model_read_published(NEURAL_MESH "elephant.safetensors", &model, NULL) != BAT_OK)
    {
        print_message("skipped: there are no published weights\n");
        return;
    }
    check_published(model, NEURAL_MESH "spot.safetensors");
    check_published(model, NEURAL_MESH "bunny.safetensors");
    check_published(model, NEURAL_MESH "horse.safetensors");
    bat_mesh_model_free(model);
}

// Any weights

/// A model with random weights times `factor`, written to a file and read back.
static bat_mesh_model *random_model(mesh_network_form form, uint64_t seed, double factor)
{
    char path[] = "/tmp/test_mesh_model_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(close(file), 0);
    learn_parameters parameters = {0};
    char recipe[64];
    (void)snprintf(recipe, sizeof recipe, "a test%s%s", form.fixed_frames ? MESH_NETWORK_FIXED : "",
                   form.relative ? MESH_NETWORK_RELATIVE : "");
    const safetensors_note note = {"recipe", recipe};
    check_status(mesh_network_make(form, &parameters, NULL), BAT_OK);
    mesh_network_start(&parameters, seed);
    for (size_t i = 0; i < parameters.total; i++)
        parameters.values[i] = (real)(factor * (double)parameters.values[i]);
    check_status(learn_parameters_write(&parameters, path, &note, 1, NULL), BAT_OK);
    bat_mesh_model *model = NULL;
    check_status(bat_mesh_model_read_published(path, &model, NULL), BAT_OK);
    assert_int_equal(unlink(path), 0);
    learn_parameters_free(&parameters);
    return model;
}

/// Compare with the tape, for closed and open meshes at every level: the tape's state at level l is the inference by l
/// levels.
static void check_against_tape(mesh_network_form form)
{
    bat_random random = bat_random_seed(4);
    learn_parameters parameters = {0};
    learn_tape tape = learn_tape_make();
    check_status(mesh_network_make(form, &parameters, NULL), BAT_OK);
    mesh_network_start(&parameters, 4);
    bat_mesh_model *model = random_model(form, 4, 1);
    for (size_t missing = 0; missing < 5; missing++)
    {
        enum
        {
            LEVELS = 2
        };
        bat_mesh coarse = octahedron(missing, 0.2, &random);
        mesh_levels levels = levels_of(&coarse, LEVELS);
        learn_array *states[LEVELS + 1];
        double low[3] = {INFINITY, INFINITY, INFINITY}, size = 0;
        for (size_t i = 0; i < 18; i++)
            low[i % 3] = fmin(low[i % 3], coarse.positions[i]);
        for (size_t i = 0; i < 18; i++)
            size = fmax(size, coarse.positions[i] - low[i % 3]);
        learn_tape_begin(&tape, &parameters, NULL);
        learn_array *positions = learn_array_make(&tape, 6, 3, false);
        for (size_t i = 0; i < 18; i++)
            positions->value[i] = (real)((coarse.positions[i] - low[i % 3]) / size);
        mesh_network_refine(&tape, form, &levels, positions, states);
        for (size_t level = 1; level <= LEVELS; level++)
        {
            size_t fallback;
            bat_mesh fine = refined(model, &coarse, level, 2, &fallback);
            assert_int_equal(fine.vertex_count, states[level]->rows);
            for (size_t i = 0; i < 3 * fine.vertex_count; i++)
                check_near(fine.positions[i],
                           low[i % 3] + size * (double)states[level]->value[i / 3 * states[level]->columns + i % 3], 2e-5);
            bat_mesh_free(&fine);
        }
        mesh_levels_free(&levels);
        bat_mesh_free(&coarse);
    }
    bat_mesh_model_free(model);
    learn_parameters_free(&parameters);
    learn_tape_free(&tape);
}

static void inference_is_the_network_on_the_tape(void **state)
{
    (void)state;
    check_against_tape((mesh_network_form){0});
    check_against_tape((mesh_network_form){.fixed_frames = true});
    check_against_tape((mesh_network_form){.no_differences = true});
    check_against_tape((mesh_network_form){.relative = true});
}

/// A mesh of many blocks of vertices and edges.
static bat_mesh many_faces(bat_random *random)
{
    bat_mesh base = octahedron(3, 0.2, random), mesh = split(&base, 4);
    for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
        mesh.positions[i] += 0.02 * bat_random_normal(random);
    bat_mesh_free(&base);
    return mesh;
}

static void threads_do_not_change_a_byte(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(5);
    bat_mesh_model *model = random_model((mesh_network_form){0}, 5, 1);
    bat_mesh coarse = many_faces(&random);
    size_t fallback;
    bat_mesh one = refined(model, &coarse, 2, 1, &fallback);
    for (int threads = 2; threads < 6; threads++)
    {
        bat_mesh many = refined(model, &coarse, 2, threads, &fallback);
        assert_memory_equal(one.positions, many.positions, 3 * one.vertex_count * sizeof(double));
        bat_mesh_free(&many);
    }
    bat_mesh_free(&one);
    bat_mesh_free(&coarse);
    bat_mesh_model_free(model);
}

/// Similarity transformations commute with refinement up to rounding, because the unit box is the same.
static void results_move_with_the_mesh(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(6);
    bat_mesh_model *model = random_model((mesh_network_form){0}, 6, 1);
    bat_mesh coarse = octahedron(1, 0.2, &random), moved = octahedron(1, 0, &random);
    const double shift[3] = {30, -20, 7}, factor = 500;
    for (size_t i = 0; i < 18; i++)
        moved.positions[i] = shift[i % 3] + factor * coarse.positions[i];
    size_t fallback;
    bat_mesh fine = refined(model, &coarse, 2, 1, &fallback), far = refined(model, &moved, 2, 1, &fallback);
    for (size_t i = 0; i < 3 * fine.vertex_count; i++)
        check_near(far.positions[i], shift[i % 3] + factor * fine.positions[i], 1e-4 * factor);
    bat_mesh_free(&fine);
    bat_mesh_free(&far);
    bat_mesh_free(&coarse);
    bat_mesh_free(&moved);
    bat_mesh_model_free(model);
}

/// Degenerate faces and overflowing weights give finite positions, and are counted.
static void failures_are_counted_and_displace_nothing(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(7);
    bat_mesh_model *tame = random_model((mesh_network_form){0}, 7, 1), *wild = random_model((mesh_network_form){0}, 7, 1e15);
    bat_mesh coarse = octahedron(0, 0.1, &random);
    // All faces at vertex 4 have no area.
    memcpy(coarse.positions + 12, coarse.positions + 6, 3 * sizeof(double));
    memcpy(coarse.positions, coarse.positions + 6, 3 * sizeof(double));
    for (int i = 0; i < 2; i++)
    {
        size_t fallback = 0;
        bat_mesh fine = refined(i == 0 ? tame : wild, &coarse, 2, 1, &fallback);
        assert_true(fallback > 0);
        for (size_t k = 0; k < 3 * fine.vertex_count; k++)
            assert_true(isfinite(fine.positions[k]));
        bat_mesh_free(&fine);
    }
    bat_mesh_free(&coarse);
    bat_mesh_model_free(tame);
    bat_mesh_model_free(wild);
}

static void files_that_hold_no_model_are_refused(void **state)
{
    (void)state;
    bat_mesh_model *model = NULL;
    bat_error error;
    check_status(bat_mesh_model_read_published("/nowhere/model.safetensors", &model, &error), BAT_FILE_ACCESS);
    check_status(bat_mesh_model_read_published(WEIGHTS_FOLDER "/tension-published.safetensors", &model, &error),
                 BAT_BAD_FILE);
    assert_non_null(strstr(error.text, "net_init.layerIn.weight"));
    assert_null(model);
}

static double distance(const bat_mesh *fine, const bat_mesh *shape)
{
    bat_mesh_distance measured;
    bat_mesh_compare_options options = bat_mesh_compare_defaults();
    options.samples = 20000;
    options.tolerance = 1e-2;
    check_status(bat_mesh_compare(fine, shape, &options, &measured, NULL), BAT_OK);
    return measured.mean;
}

/// The shipped weights, on shapes outside of the training: nearer to the surface than butterfly by the required factor, and
/// nearer than the coarse faces.
static void weights_of_the_library_are_nearer_than_the_butterfly(void **state)
{
    (void)state;
    static const char *const KINDS[] = {"creature", "bust", "mask"};
    bat_mesh_model *model;
    check_status(bat_mesh_model_read_published(NULL, &model, NULL), BAT_OK);
    for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++)
    {
        bat_mesh shape, coarse, butterfly;
        check_status(bat_mesh_shape(KINDS[i], 4000, 77, &shape, NULL), BAT_OK);
        bat_mesh_decimate_options decimate = bat_mesh_decimate_defaults();
        decimate.method = BAT_MESH_DECIMATE_METHOD_QUADRIC;
        decimate.vertices = 350;
        check_status(bat_mesh_decimate(&shape, &decimate, &coarse, NULL, NULL), BAT_OK);
        size_t fallback = 1;
        bat_mesh learned = refined(model, &coarse, 2, 0, &fallback);
        bat_mesh_refine_options options = bat_mesh_refine_defaults();
        options.scheme = BAT_MESH_SCHEME_BUTTERFLY;
        check_status(bat_mesh_refine(&coarse, &options, &butterfly, NULL, NULL), BAT_OK);
        double ours = distance(&learned, &shape);
        assert_true(ours <= 0.75 * distance(&butterfly, &shape));
        assert_true(ours <= 0.9 * distance(&coarse, &shape));
        bat_mesh_free(&shape);
        bat_mesh_free(&coarse);
        bat_mesh_free(&learned);
        bat_mesh_free(&butterfly);
    }
    bat_mesh_model_free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(published_weights_give_published_meshes),
        cmocka_unit_test(inference_is_the_network_on_the_tape),
        cmocka_unit_test(threads_do_not_change_a_byte),
        cmocka_unit_test(results_move_with_the_mesh),
        cmocka_unit_test(failures_are_counted_and_displace_nothing),
        cmocka_unit_test(files_that_hold_no_model_are_refused),
        cmocka_unit_test(weights_of_the_library_are_nearer_than_the_butterfly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
