// The shipped rule's weights in files and in the library: round trips, what is wrong with a file, and that the library holds
// the bytes of weights/.

#include "learned_helpers.h"

#include "batten/curve_scheme.h"
#include "batten/research/networks.h"
#include "learn/weights.h"
#include "research/learn/parameters.h"
#include "research/networks/weights.h"

#include <unistd.h>

static char path[] = "/tmp/test_fairing_model_XXXXXX";

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

enum
{
    COUNT = 9,
    LEVELS = 3
};

/// Two schemes make the same curves, to the last bit, in every space.
static void assert_same_scheme(const bat_curve_scheme *scheme_a, const bat_curve_scheme *scheme_b)
{
    bat_random random = bat_random_seed(1);
    for (int s = 0; s < 3; s++)
        for (int closed = 0; closed < 2; closed++)
        {
            double points[MAX_COORDINATES];
            bat_space space = space_of(SURFACES[s]);
            (void)make_polygon(SURFACES[s], UNEVEN, COUNT, &random, points);
            bat_curve coarse = {.space = &space, .points = points, .count = COUNT, .closed = closed == 1};
            bat_curve_refine_options how = bat_curve_refine_defaults();
            how.levels = LEVELS;
            how.scheme = *scheme_a;
            bat_curve a = refined(&coarse, &how);
            how.scheme = *scheme_b;
            bat_curve b = refined(&coarse, &how);
            assert_memory_equal(a.points, b.points, a.count * space.point_dim * sizeof(double));
            bat_curve_free(&a);
            bat_curve_free(&b);
        }
}

static bat_curve_model *read_model(const char *from)
{
    bat_curve_model *model = NULL;
    bat_error error;
    if (bat_curve_model_read(from, &model, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return model;
}

/// A file's bytes.
static unsigned char *read_bytes(const char *from, size_t *size)
{
    FILE *stream = fopen(from, "rb");
    assert_non_null(stream);
    assert_int_equal(fseek(stream, 0, SEEK_END), 0);
    *size = (size_t)ftell(stream);
    rewind(stream);
    unsigned char *bytes = malloc(*size);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, stream), *size);
    (void)fclose(stream);
    return bytes;
}

// What the library holds

static void the_library_holds_the_models_numbers(void **state)
{
    (void)state;
    learn_parameters parameters = {0};
    safetensors content;
    check_status(safetensors_read(WEIGHTS_FOLDER "/batten.safetensors", &content, NULL), BAT_OK);
    check_status(learned_network_make(&parameters, NULL), BAT_OK);
    check_status(learn_parameters_extract(&parameters, &content, "", parameters.values, NULL), BAT_OK);
    assert_int_equal(content.array_count, LEARNED_PARAMETERS);
    assert_memory_equal(parameters.values, weights_learned.arrays[0].values, parameters.total * sizeof(real));
    assert_int_equal((uintptr_t)weights_learned.arrays[0].values % 64, 0);
    learn_parameters_free(&parameters);
    safetensors_free(&content);
}

/// The same arrays and notes, in the same order.
static void check_same_content(const char *file, const safetensors *weights)
{
    safetensors content;
    check_status(safetensors_read(file, &content, NULL), BAT_OK);
    assert_int_equal(content.array_count, weights->array_count);
    for (size_t i = 0; i < content.array_count; i++)
    {
        const safetensors_array *a = &content.arrays[i], *b = &weights->arrays[i];
        assert_string_equal(a->name, b->name);
        assert_int_equal(a->type, b->type);
        assert_int_equal(a->rank, b->rank);
        assert_memory_equal(a->shape, b->shape, a->rank * sizeof *a->shape);
        assert_int_equal(a->count, b->count);
        assert_memory_equal(a->values, b->values, a->count * safetensors_element_size(a->type));
    }
    assert_int_equal(content.note_count, weights->note_count);
    for (size_t i = 0; i < content.note_count; i++)
        assert_string_equal(safetensors_find_note(weights, content.notes[i].key), content.notes[i].value);
    safetensors_free(&content);
}

static void the_library_holds_the_content_of_the_files(void **state)
{
    (void)state;
    check_same_content(WEIGHTS_FOLDER "/batten.safetensors", &weights_learned);
    check_same_content(WEIGHTS_FOLDER "/tension-published.safetensors", &weights_published);
    check_same_content(WEIGHTS_FOLDER "/mesh.safetensors", &weights_mesh);
    check_same_content(WEIGHTS_FOLDER "/surface.safetensors", &weights_surface);
}

static void shipped_models_are_those_of_the_files(void **state)
{
    (void)state;
    bat_curve_model *file = read_model(WEIGHTS_FOLDER "/batten.safetensors");
    assert_true(bat_curve_model_has_fairness(file));
    for (double fairness = 0; fairness <= 1; fairness += 0.25)
    {
        bat_curve_scheme own = bat_curve_scheme_learned(fairness), read = bat_curve_scheme_of_model(file);
        assert_true(read.fairness == 0.25);
        read.fairness = fairness;
        assert_same_scheme(&own, &read);
    }
    bat_curve_model *builtin = NULL;
    check_status(bat_curve_model_read(NULL, &builtin, NULL), BAT_OK);
    assert_true(bat_curve_model_has_fairness(builtin));
    bat_curve_scheme of_builtin = bat_curve_scheme_of_model(builtin), of_file = bat_curve_scheme_of_model(file);
    assert_same_scheme(&of_builtin, &of_file);
    bat_curve_model_free(builtin);
    bat_curve_model_free(file);

    bat_curve_model *published = NULL;
    check_status(bat_curve_model_read_published(WEIGHTS_FOLDER "/tension-published.safetensors", &file, NULL), BAT_OK);
    check_status(bat_curve_model_read_published(NULL, &published, NULL), BAT_OK);
    assert_false(bat_curve_model_has_fairness(published));
    assert_false(bat_curve_model_has_fairness(file));
    bat_curve_scheme own = bat_curve_scheme_of_model(published), read = bat_curve_scheme_of_model(file);
    assert_same_scheme(&own, &read);
    // A fairness means nothing to it.
    own.fairness = 0;
    assert_same_scheme(&own, &read);
    bat_curve_model_free(published);
    bat_curve_model_free(file);
}

// Files

/// The arrays of a network in a file, changed by the caller.
typedef struct model_file
{
    learn_parameters parameters;
    safetensors_array arrays[LEARNED_PARAMETERS];
    char names[LEARNED_PARAMETERS][2 * LEARN_NAME_SIZE];
} model_file;

static model_file *make_file(const char *prefix)
{
    model_file *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->parameters = random_weights(7);
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

static void files_make_round_trips(void **state)
{
    (void)state;
    // A model, and a checkpoint with and without best weights.
    static const char *const prefixes[] = {"", "best.", "weight."};
    for (size_t i = 0; i < 3; i++)
    {
        model_file *f = make_file(prefixes[i]);
        write_file(f, LEARNED_PARAMETERS);
        bat_curve_model *model = read_model(path);
        assert_true(bat_curve_model_has_fairness(model));
        bat_curve_angle_rule rule = learned_rule(f->parameters.values);
        rule.angles = bat_curve_scheme_learned(0).rule->angles; // with the loss of rough lines
        bat_curve_scheme read = bat_curve_scheme_of_model(model), written = bat_curve_scheme_angle_rule(&rule);
        written.fairness = 0.25;
        assert_same_scheme(&read, &written);
        bat_curve_model_free(model);
        free_file(f);
    }
}

/// Reading must fail with one line that names the part, and leave the model alone.
static void check_refused(const char *part)
{
    bat_curve_model *model = NULL;
    bat_error error = {0};
    check_status(bat_curve_model_read(path, &model, &error), BAT_BAD_FILE);
    assert_null(model);
    if (strstr(error.text, part) == NULL || strchr(error.text, '\n') != NULL || *error.text == '\0')
        fail_msg("'%s' does not name '%s'", error.text, part);
}

static void bad_arrays_are_named(void **state)
{
    (void)state;
    model_file *f = make_file("");
    const size_t second = 1, last = LEARNED_PARAMETERS - 1;
    write_file(f, last);
    check_refused("output.kept");
    const char *name = f->arrays[second].name;
    assert_string_equal(name, "layer.0.second");
    f->arrays[second].name = "layer.0.seconds";
    write_file(f, LEARNED_PARAMETERS);
    check_refused("layer.0.second");
    f->arrays[second].name = name;
    f->arrays[second].shape[0] *= 2;
    f->arrays[second].shape[1] /= 2;
    write_file(f, LEARNED_PARAMETERS);
    check_refused("layer.0.second");
    f->arrays[second].shape[0] /= 2;
    f->arrays[second].shape[1] *= 2;
    f->arrays[second].type = SAFETENSORS_I32;
    write_file(f, LEARNED_PARAMETERS);
    check_refused("layer.0.second");
    f->arrays[second].type = SAFETENSORS_F32;
    const real bad[] = {(real)NAN, (real)INFINITY, -(real)INFINITY};
    for (size_t i = 0; i < 3; i++)
    {
        f->parameters.values[f->parameters.total - 3] = bad[i];
        write_file(f, LEARNED_PARAMETERS);
        check_refused("output.kept");
    }
    // Research takes a file without the first array for one of the published network.
    f->parameters.values[f->parameters.total - 3] = 0;
    f->arrays[0].name = "layer.0.keeps";
    write_file(f, LEARNED_PARAMETERS);
    check_refused("layer.0.kept");
    bat_curve_model *model = NULL;
    bat_error error = {0};
    check_status(bat_curve_model_read_published(path, &model, &error), BAT_BAD_FILE);
    assert_non_null(strstr(error.text, "geom_embed.weight"));
    free_file(f);
}

static void cut_files_are_refused(void **state)
{
    (void)state;
    model_file *f = make_file("");
    write_file(f, LEARNED_PARAMETERS);
    size_t size;
    unsigned char *bytes = read_bytes(path, &size);
    free(bytes);
    assert_int_equal(truncate(path, (off_t)size - 1), 0);
    check_refused("");
    for (off_t left = 90000; left > 0; left = left * 2 / 5)
    {
        assert_int_equal(truncate(path, left), 0);
        check_refused("");
    }
    assert_int_equal(truncate(path, 0), 0);
    check_refused("");
    write_file(f, 0);
    check_refused("");
    free_file(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_library_holds_the_models_numbers),
        cmocka_unit_test(the_library_holds_the_content_of_the_files),
        cmocka_unit_test(shipped_models_are_those_of_the_files),
        cmocka_unit_test(files_make_round_trips),
        cmocka_unit_test(bad_arrays_are_named),
        cmocka_unit_test(cut_files_are_refused),
    };
    return cmocka_run_group_tests(tests, make_path, remove_path);
}
