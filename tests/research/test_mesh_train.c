// Short trainings of the network for meshes: neither threads nor stops change a byte, the loss falls, every published
// ablation trains, and what makes no sense is refused. Built in single and double precision.

#include "mesh_flap_helpers.h"

#include "batten/research/mesh_train.h"
#include "research/train/mesh_network_tape.h"

#include <unistd.h>

static const char *const FILES[] = {"model.safetensors", "checkpoint.safetensors", "log.csv", "log.png"};

static char root[40];
/// Folders in it.
static char a[60], b[60], c[60];
static bat_mesh shapes[2];

static int set_up(void **state)
{
    (void)state;
    (void)snprintf(root, sizeof root, "/tmp/batten-mesh-XXXXXX");
    if (mkdtemp(root) == NULL)
        return -1;
    (void)snprintf(a, sizeof a, "%s/a", root);
    (void)snprintf(b, sizeof b, "%s/b", root);
    (void)snprintf(c, sizeof c, "%s/c", root);
    shapes[0] = ball(3);
    shapes[1] = ball(2);
    for (size_t v = 0; v < shapes[0].vertex_count; v++)
        shapes[0].positions[3 * v] *= 1.5;
    return 0;
}

static void remove_files(const char *folder)
{
    char path[200];
    for (size_t i = 0; i < sizeof FILES / sizeof *FILES; i++)
    {
        (void)snprintf(path, sizeof path, "%s/%s", folder, FILES[i]);
        (void)unlink(path);
    }
    (void)rmdir(folder);
}

static int tear_down(void **state)
{
    (void)state;
    remove_files(a);
    remove_files(b);
    remove_files(c);
    bat_mesh_free(&shapes[0]);
    bat_mesh_free(&shapes[1]);
    return rmdir(root);
}

static bool same_file(const char *folder, const char *other, const char *name)
{
    enum
    {
        MOST = 1 << 20
    };
    char *bytes[2];
    size_t size[2];
    for (int i = 0; i < 2; i++)
    {
        char path[200];
        (void)snprintf(path, sizeof path, "%s/%s", i == 0 ? folder : other, name);
        FILE *stream = fopen(path, "rb");
        assert_non_null(stream);
        bytes[i] = test_memory(MOST, 1);
        size[i] = fread(bytes[i], 1, MOST, stream);
        (void)fclose(stream);
        assert_true(size[i] > 0);
    }
    bool same = size[0] == size[1] && memcmp(bytes[0], bytes[1], size[0]) == 0;
    free(bytes[0]);
    free(bytes[1]);
    return same;
}

static bat_mesh_train_options short_options(const char *folder)
{
    bat_mesh_train_options options = bat_mesh_train_defaults();
    options.epochs = 3;
    options.pairs = 3;
    options.fresh = 1;
    options.least_vertices = 12;
    options.most_vertices = 20;
    options.folder = folder;
    options.threads = 1;
    return options;
}

static void train(const bat_mesh_train_options *options, bat_mesh_train_report *report)
{
    bat_error error;
    if (bat_mesh_train(shapes, 2, options, report, &error) != BAT_OK)
        fail_msg("%s", error.text);
}

static bool stop_in_the_second_epoch(void *context, double fraction)
{
    (void)context;
    return fraction < 0.5;
}

static void neither_threads_nor_stops_change_a_byte(void **state)
{
    (void)state;
    bat_mesh_train_report whole, resumed;
    bat_mesh_train_options options = short_options(a);
    options.batch = 2;
    train(&options, &whole);
    assert_int_equal(whole.epochs, 3);
    options.folder = b;
    options.threads = 3;
    train(&options, &resumed);
    assert_true(same_file(a, b, "model.safetensors"));
    options.folder = c;
    options.resume = true; // from nothing at first
    options.progress.report = stop_in_the_second_epoch;
    check_status(bat_mesh_train(shapes, 2, &options, &resumed, NULL), BAT_CANCELLED);
    options.progress.report = NULL;
    train(&options, &resumed);
    assert_true(same_file(a, c, "model.safetensors"));
    assert_true(same_file(a, c, "checkpoint.safetensors"));
    assert_memory_equal(resumed.errors, whole.errors, sizeof whole.errors);
    // Another training's checkpoint.
    options.pairs = 4;
    check_status(bat_mesh_train(shapes, 2, &options, &resumed, NULL), BAT_INVALID_ARGUMENT);
    options = short_options(c);
    options.batch = 2;
    options.resume = true;
    check_status(bat_mesh_train(shapes, 1, &options, &resumed, NULL), BAT_INVALID_ARGUMENT);
}

static void every_form_learns(void **state)
{
    (void)state;
    for (int form = 0; form < 7; form++)
    {
        bat_mesh_train_report early, late;
        bat_mesh_train_options options = short_options(NULL);
        options.fresh = 0;
        options.fixed_frames = form == 1;
        options.no_differences = form == 2;
        options.last_level = form == 3;
        options.chamfer = form == 4;
        options.learn_loop = form == 5;
        options.relative = form == 6;
        options.epochs = 1;
        train(&options, &early);
        options.epochs = 25;
        train(&options, &late);
        assert_int_equal(late.epochs, 25);
        assert_true(isfinite(late.loss) && late.loss > 0);
        assert_true(late.errors[2] < 0.7 * early.errors[2]);
    }
}

/// What the arrays' shapes do not tell stands in the file's note, that of checkpoints too.
static void models_say_of_what_form_they_are(void **state)
{
    (void)state;
    for (int form = 0; form < 4; form++)
    {
        bat_mesh_train_options options = short_options(a);
        safetensors content;
        char path[100];
        options.epochs = 1;
        options.fixed_frames = form % 2 == 1;
        options.relative = form / 2 == 1;
        train(&options, NULL);
        (void)snprintf(path, sizeof path, "%s/%s", a, FILES[form / 2]);
        check_status(safetensors_read(path, &content, NULL), BAT_OK);
        const char *recipe = safetensors_find_note(&content, "recipe");
        assert_non_null(recipe);
        assert_int_equal(strstr(recipe, MESH_NETWORK_FIXED) != NULL, options.fixed_frames);
        assert_int_equal(strstr(recipe, MESH_NETWORK_RELATIVE) != NULL, options.relative);
        safetensors_free(&content);
    }
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    for (int i = 0; i < 7; i++)
    {
        bat_mesh_train_options options = short_options(NULL);
        if (i == 0)
            options.epochs = 0;
        if (i == 1)
            options.pairs = 0;
        if (i == 2)
            options.pairs = SIZE_MAX;
        if (i == 3)
            options.batch = 7;
        if (i == 4)
            options.most_vertices = 11;
        if (i == 5)
            options.rate = NAN;
        bat_error error;
        check_status(bat_mesh_train(shapes, i == 6 ? 0 : 2, &options, NULL, &error), BAT_INVALID_ARGUMENT);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(neither_threads_nor_stops_change_a_byte),
        cmocka_unit_test(every_form_learns),
        cmocka_unit_test(models_say_of_what_form_they_are),
        cmocka_unit_test(nonsense_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
