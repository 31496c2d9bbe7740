// Learned refinement against a plain network in double, in the paper's own example, under isometries, for weights that want
// harm, over threads; and what is wrong with a model's file.

#include "geometry_helpers.h"
#include "reference_network.h"
#include "refine_helpers.h"
#include "research/learn/parameters.h"
#include "research/networks/tension_inference.h"
#include "research/train/geometry_feature.h"
#include "research/train/geometry_insert.h"

#include "batten/curve_scheme.h"
#include "batten/research/networks.h"

#include <unistd.h>

#define ORACLE SHARED_DATA "/oracle/tension/"

static char path[] = "/tmp/test_tension_model_XXXXXX";

static int make_path(void **state)
{
    (void)state;
    int file = mkstemp(path);
    return file < 0 ? -1 : close(file);
}

static int remove_path(void **state)
{
    (void)state;
    return unlink(path);
}

/// A model by way of a file.
static bat_curve_model *model_of(const learn_parameters *parameters)
{
    bat_curve_model *model = NULL;
    bat_error error;
    check_status(learn_parameters_write(parameters, path, NULL, 0, &error), BAT_OK);
    if (bat_curve_model_read_published(path, &model, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return model;
}

static bat_curve_model *random_model(uint64_t seed)
{
    learn_parameters parameters = {0};
    check_status(tension_network_make(&parameters, NULL), BAT_OK);
    tension_network_start(&parameters, seed);
    bat_curve_model *model = model_of(&parameters);
    learn_parameters_free(&parameters);
    return model;
}

static bat_curve_refine_options learned(const bat_curve_model *model, size_t levels)
{
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.scheme = bat_curve_scheme_of_model(model);
    how.levels = levels;
    how.simple = BAT_CURVE_SIMPLE_NEVER; // random weights make curves that cross themselves
    return how;
}

/// The oracle's weights as a model; skips the test where they are absent.
static bat_curve_model *oracle_model(safetensors *content)
{
    bat_curve_model *model = NULL;
    if (access(ORACLE "network.safetensors", R_OK) != 0)
    {
        print_message("no %s: skipped\n", ORACLE "network.safetensors");
        skip();
    }
    check_status(safetensors_read(ORACLE "network.safetensors", content, NULL), BAT_OK);
    check_status(bat_curve_model_read_published(ORACLE "network.safetensors", &model, NULL), BAT_OK);
    return model;
}

/// One level by the plain network, features and insertion by the geometry that training differentiates.
static void reference_level(const network *net, const geometry_polygon *polygon, double *fine)
{
    static network_pass pass;
    double angles[MAX_COUNT], lengths[MAX_COUNT], insertion[MAX_COUNT];
    double features[MAX_COUNT * GEOMETRY_PUBLISHED_FEATURES];
    geometry_profile profile = {angles, lengths};
    geometry_measure(polygon, profile);
    geometry_published_features(polygon, profile, features, GEOMETRY_PUBLISHED_FEATURES);
    network_forward(net, polygon->count, features, &pass, insertion);
    geometry_insert(polygon, insertion, fine);
}

static void a_level_is_that_of_the_plain_network(void **state)
{
    (void)state;
    safetensors content;
    bat_curve_model *model = oracle_model(&content);
    network net = load_network(&content);
    bat_random random = bat_random_seed(1);
    double points[MAX_COORDINATES], expected[2 * MAX_COORDINATES];
    for (int s = 0; s < 3; s++)
        for (size_t count = 3; count <= REFERENCE_ROWS; count += count < 15 ? 1 : 7)
        {
            geometry_polygon polygon = make_polygon(SURFACES[s], count % 2 ? EVEN : UNEVEN, count, &random, points);
            polygon.closed = true;
            reference_level(&net, &polygon, expected);
            bat_space space = space_of(SURFACES[s]);
            bat_curve coarse = {.space = &space, .points = points, .count = count, .closed = true};
            bat_curve_refine_options how = learned(model, 1);
            bat_curve fine = refined(&coarse, &how);
            for (size_t i = 0; i < 2 * count * space.point_dim; i++)
                check_near(fine.points[i], expected[i], 1e-5);
            bat_curve_free(&fine);
        }
    free_network(&net);
    safetensors_free(&content);
    bat_curve_model_free(model);
}

/// From the first level of the paper's training step to its last.
static void the_published_levels_are_met(void **state)
{
    (void)state;
    static const struct
    {
        const char *name;
        geometry_surface surface;
    } cases[] = {{"euclidean", GEOMETRY_PLANE}, {"spherical", GEOMETRY_SPHERE}, {"hyperbolic", GEOMETRY_DISK}};
    safetensors content, step;
    bat_curve_model *model = oracle_model(&content);
    check_status(safetensors_read(ORACLE "training-step.safetensors", &step, NULL), BAT_OK);
    for (int s = 0; s < 3; s++)
    {
        char name[64];
        double points[3 * 24], expected[3 * 96];
        bat_space space = space_of(cases[s].surface);
        snprintf(name, sizeof name, "%s.level1", cases[s].name);
        check_status(safetensors_doubles(&step, name, 24 * space.point_dim, points, NULL), BAT_OK);
        snprintf(name, sizeof name, "%s.level3", cases[s].name);
        check_status(safetensors_doubles(&step, name, 96 * space.point_dim, expected, NULL), BAT_OK);
        check_status(bat_space_project(&space, points, 24, points, NULL), BAT_OK);
        bat_curve coarse = {.space = &space, .points = points, .count = 24, .closed = true};
        bat_curve_refine_options how = learned(model, 2);
        bat_curve fine = refined(&coarse, &how);
        for (size_t i = 0; i < 96 * space.point_dim; i++)
            check_near(fine.points[i], expected[i], 1e-5);
        bat_curve_free(&fine);
    }
    safetensors_free(&step);
    safetensors_free(&content);
    bat_curve_model_free(model);
}

/// The networks of table 3 without a learned embedding, which tell spaces apart otherwise, against the network on a tape.
static void plain_networks_are_told_by_their_inputs(void **state)
{
    (void)state;
    enum
    {
        ROWS = 21
    };
    static const size_t inputs[] = {TENSION_FEATURES, TENSION_FEATURES + TENSION_SPACES};
    bat_random random = bat_random_seed(2);
    learn_tape tape = learn_tape_make();
    for (int k = 0; k < 2; k++)
        for (size_t space = 0; space < TENSION_SPACES; space++)
        {
            learn_parameters parameters = {0};
            tension_inference packed;
            static real features[2 * ROWS * TENSION_FEATURES];
            _Alignas(64) static real scratch[TENSION_INFERENCE_SCRATCH];
            double angles[ROWS];
            check_status(tension_network_make_plain(&parameters, inputs[k], NULL), BAT_OK);
            tension_network_start(&parameters, space);
            check_status(tension_inference_make(&parameters, &packed, NULL), BAT_OK);
            learn_tape_begin(&tape, &parameters, NULL);
            learn_array *x = learn_array_make(&tape, ROWS, inputs[k], false);
            for (size_t i = 0; i < learn_size(x); i++)
            {
                size_t column = i % inputs[k];
                x->value[i] = column < TENSION_FEATURES ? (real)bat_random_normal(&random)
                                                        : (real)(column == TENSION_FEATURES + space);
                if (column < TENSION_FEATURES)
                    features[i / inputs[k] * TENSION_FEATURES + column] = x->value[i];
            }
            const learn_array *expected = tension_network_angles(&tape, x, NULL);
            tension_inference_angles(&packed, space, ROWS, features, angles, scratch);
            for (size_t r = 0; r < ROWS; r++)
                check_near(angles[r], (double)expected->value[r], 1e-5);
            bat_curve_model_free(model_of(&parameters));
            tension_inference_free(&packed);
            learn_parameters_free(&parameters);
        }
    learn_tape_free(&tape);
}

static void isometries_and_scaling_commute_with_refinement(void **state)
{
    (void)state;
    bat_curve_model *model = random_model(3);
    bat_random random = bat_random_seed(3);
    double points[MAX_COORDINATES], moved[MAX_COORDINATES], expected[8 * MAX_COORDINATES];
    for (int s = 0; s < 3; s++)
        for (int closed = 0; closed < 2; closed++)
        {
            enum
            {
                COUNT = 30
            };
            bat_space space = space_of(SURFACES[s]);
            (void)make_polygon(SURFACES[s], EVEN, COUNT, &random, points);
            geometry_isometry isometry = geometry_isometry_random(SURFACES[s], 0.8, &random);
            double scale = SURFACES[s] == GEOMETRY_PLANE ? 1e150 : 1;
            geometry_isometry_apply(&isometry, points, COUNT, moved);
            for (size_t i = 0; i < COUNT * space.point_dim; i++)
                moved[i] *= scale;
            bat_curve coarse = {.space = &space, .points = points, .count = COUNT, .closed = closed == 1}, other = coarse;
            other.points = moved;
            bat_curve_refine_options how = learned(model, 2);
            bat_curve fine = refined(&coarse, &how), fine_moved = refined(&other, &how);
            geometry_isometry_apply(&isometry, fine.points, fine.count, expected);
            for (size_t i = 0; i < fine.count * space.point_dim; i++)
                check_near(fine_moved.points[i] / scale, expected[i], 1e-5);
            bat_curve_free(&fine);
            bat_curve_free(&fine_moved);
        }
    bat_curve_model_free(model);
}

/// Theorem 1: whatever the weights, new vertices are there and lie within the angle of their edge. Weights of 1e30 and more
/// overflow on the way through the network.
static void no_weights_make_an_invalid_vertex(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(4);
    double points[MAX_COORDINATES];
    learn_parameters parameters = {0};
    check_status(tension_network_make(&parameters, NULL), BAT_OK);
    for (double size = 1e-30; size < 1e38; size *= 1e4)
    {
        for (size_t k = 0; k < parameters.total; k++)
            parameters.values[k] = (real)(size * (2 * bat_random_uniform(&random) - 1));
        bat_curve_model *model = model_of(&parameters);
        for (int s = 0; s < 3; s++)
            for (int kind = 0; kind < KINDS; kind++)
            {
                bat_space space = space_of(SURFACES[s]);
                geometry_polygon polygon = make_polygon(SURFACES[s], (polygon_kind)kind, 14, &random, points);
                bat_curve coarse = {.space = &space, .points = points, .count = 14, .closed = polygon.closed};
                bat_curve_refine_options how = learned(model, 1);
                bat_curve fine = refined(&coarse, &how);
                check_status(bat_space_check(&space, fine.points, fine.count, NULL), BAT_OK);
                for (size_t j = 0; 2 * j + 2 < fine.count; j++)
                {
                    const double *p = fine.points + 2 * j * space.point_dim, *apex = p + space.point_dim;
                    double half = space.distance(&space, p, apex), edge = space.distance(&space, p, apex + space.point_dim);
                    double angle = fabs(space.exterior_angle(&space, p, apex, apex + space.point_dim));
                    // Twice the insertion angle in the plane, less on the sphere, more in the disk.
                    if (SURFACES[s] != GEOMETRY_DISK)
                        assert_true(angle <= 2 * BAT_CURVE_ANGLE_LIMIT + 1e-9);
                    if (SURFACES[s] == GEOMETRY_PLANE)
                        assert_true(half <= 0.5 / cos(BAT_CURVE_ANGLE_LIMIT) * edge * (1 + 1e-9));
                }
                bat_curve_free(&fine);
            }
        bat_curve_model_free(model);
    }
    learn_parameters_free(&parameters);
}

/// Thousands of vertices, so that there are several chunks and runs of edges, and several curves at once.
static void threads_make_no_difference(void **state)
{
    (void)state;
    bat_curve_model *model = random_model(5);
    bat_random random = bat_random_seed(5);
    bat_space sphere = bat_sphere(2);
    double points[MAX_COORDINATES];
    (void)make_polygon(GEOMETRY_SPHERE, EVEN, 101, &random, points);
    bat_curve coarse = {.space = &sphere, .points = points, .count = 101, .closed = true};
    bat_curve_refine_options how = learned(model, 6);
    how.threads = 1;
    bat_curve one = refined(&coarse, &how);
    how.threads = 3;
    bat_curve three = refined(&coarse, &how);
    assert_memory_equal(one.points, three.points, 3 * one.count * sizeof(double));
    bat_curve many[16], fine[16];
    for (int i = 0; i < 16; i++)
        many[i] = coarse;
    bat_curve_free(&one);
    how.levels = 2;
    one = refined(&coarse, &how);
    how.threads = 2;
    check_status(bat_curves_refine(many, 16, &how, fine, NULL), BAT_OK);
    for (int i = 0; i < 16; i++)
    {
        assert_memory_equal(one.points, fine[i].points, 3 * one.count * sizeof(double));
        bat_curve_free(&fine[i]);
    }
    bat_curve_free(&one);
    bat_curve_free(&three);
    bat_curve_model_free(model);
}

static void other_spaces_are_refused(void **state)
{
    (void)state;
    bat_curve_model *model = random_model(6);
    bat_space space = bat_euclidean(3), own = bat_disk();
    own.distance = space.distance; // no longer the library's disk
    double points[9] = {0, 0, 0.5, 0, 0, 0.5, 0.1, 0.2, 0.3};
    bat_curve coarse = {.space = &space, .points = points, .count = 3}, fine;
    bat_curve_refine_options how = learned(model, 1);
    bat_error error;
    check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_UNSUPPORTED);
    own.apex = NULL;
    coarse.space = &own;
    check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_UNSUPPORTED);
    bat_curve_model_free(model);
}

/// Reading must fail with this status and one line that names the array.
static void check_refused(bat_status expected, const char *part)
{
    bat_curve_model *model = NULL;
    bat_error error = {0};
    check_status(bat_curve_model_read_published(path, &model, &error), expected);
    assert_null(model);
    if (strstr(error.text, part) == NULL || strchr(error.text, '\n') != NULL)
        fail_msg("'%s' does not name '%s'", error.text, part);
}

/// The arrays of a network in a file, those of `prefix`, changed by the caller.
typedef struct model_file
{
    learn_parameters parameters;
    safetensors_array arrays[TENSION_PARAMETERS];
    char names[TENSION_PARAMETERS][2 * LEARN_NAME_SIZE];
} model_file;

static model_file *make_file(const char *prefix)
{
    model_file *f = calloc(1, sizeof *f);
    assert_non_null(f);
    check_status(tension_network_make(&f->parameters, NULL), BAT_OK);
    tension_network_start(&f->parameters, 7);
    learn_parameters_describe(&f->parameters, f->parameters.values, prefix, f->arrays, f->names);
    return f;
}

static void write_file(const model_file *f, size_t count)
{
    safetensors content = {.arrays = f->arrays, .array_count = count};
    check_status(safetensors_write(path, &content, NULL), BAT_OK);
}

static void free_file(model_file *f)
{
    learn_parameters_free(&f->parameters);
    free(f);
}

static void bad_arrays_are_named(void **state)
{
    (void)state;
    model_file *f = make_file("");
    write_file(f, TENSION_PARAMETERS - 1);
    check_refused(BAT_BAD_FILE, "head.2.bias");
    safetensors_array *wrong = &f->arrays[TENSION_AT_BLOCKS];
    wrong->shape[0] /= 2;
    wrong->shape[1] *= 2;
    write_file(f, TENSION_PARAMETERS);
    check_refused(BAT_BAD_FILE, "trunk.0.net.0.weight");
    wrong->shape[0] *= 2;
    wrong->shape[1] /= 2;
    wrong->type = SAFETENSORS_I32;
    write_file(f, TENSION_PARAMETERS);
    check_refused(BAT_BAD_FILE, "trunk.0.net.0.weight");
    wrong->type = SAFETENSORS_F32;
    f->parameters.values[f->parameters.total - 3] = NAN;
    write_file(f, TENSION_PARAMETERS);
    check_refused(BAT_BAD_FILE, "head.2.weight");
    f->parameters.values[f->parameters.total - 3] = INFINITY;
    write_file(f, TENSION_PARAMETERS);
    check_refused(BAT_BAD_FILE, "head.2.weight");
    f->arrays[TENSION_AT_INPUT_LINEAR].name = "input_proj";
    write_file(f, TENSION_PARAMETERS);
    check_refused(BAT_BAD_FILE, "input_proj.0.weight");
    free_file(f);
}

static void bad_files_are_refused(void **state)
{
    (void)state;
    model_file *f = make_file("best.");
    write_file(f, TENSION_PARAMETERS);
    bat_curve_model *model = NULL;
    check_status(bat_curve_model_read_published(path, &model, NULL), BAT_OK);
    bat_curve_model_free(model);
    for (off_t size = 500000; size > 0; size /= 10)
    {
        assert_int_equal(truncate(path, size), 0);
        check_refused(BAT_BAD_FILE, "");
    }
    write_file(f, 0);
    check_refused(BAT_BAD_FILE, "geom_embed.weight");
    free_file(f);
    check_status(bat_curve_model_read_published("/nowhere/model", &model, NULL), BAT_FILE_ACCESS);
    bat_curve_model_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_level_is_that_of_the_plain_network),
        cmocka_unit_test(the_published_levels_are_met),
        cmocka_unit_test(plain_networks_are_told_by_their_inputs),
        cmocka_unit_test(isometries_and_scaling_commute_with_refinement),
        cmocka_unit_test(no_weights_make_an_invalid_vertex),
        cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(other_spaces_are_refused),
        cmocka_unit_test(bad_arrays_are_named),
        cmocka_unit_test(bad_files_are_refused),
    };
    return cmocka_run_group_tests(tests, make_path, remove_path);
}
