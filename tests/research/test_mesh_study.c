// The studies of learned subdivision on small shapes: scores are those that the parts give by themselves, trainings are kept
// and taken up again, pictures are drawn, and what makes no sense is refused.

#include "mesh_flap_helpers.h"

#include "batten/mesh_file.h"
#include "batten/mesh_measure.h"
#include "batten/research/mesh_study.h"

#include <sys/stat.h>
#include <unistd.h>

enum
{
    METHODS = 3
};

static const bat_mesh_method SCHEMES[METHODS] = {{"loop", BAT_MESH_SCHEME_LOOP, NULL},
                                                 {"butterfly", BAT_MESH_SCHEME_BUTTERFLY, NULL},
                                                 {"midpoint", BAT_MESH_SCHEME_MIDPOINT, NULL}};

static char root[40];
static bat_mesh shape;

static int set_up(void **state)
{
    (void)state;
    (void)snprintf(root, sizeof root, "/tmp/batten-study-XXXXXX");
    shape = ball(4);
    for (size_t v = 0; v < shape.vertex_count; v++)
        shape.positions[3 * v] *= 1.5;
    return mkdtemp(root) == NULL ? -1 : 0;
}

static int tear_down(void **state)
{
    static const char *const FOLDERS[] = {"full",    "fixed-frames", "no-differences", "last-level",
                                          "chamfer", "learn-loop",   "smooth",         "sharp"};
    static const char *const FILES[] = {"model.safetensors", "checkpoint.safetensors", "log.csv", "log.png"};
    char path[200];
    (void)state;
    for (size_t i = 0; i < sizeof FOLDERS / sizeof *FOLDERS; i++)
    {
        for (size_t k = 0; k < sizeof FILES / sizeof *FILES; k++)
        {
            (void)snprintf(path, sizeof path, "%s/%s/%s", root, FOLDERS[i], FILES[k]);
            (void)unlink(path);
        }
        (void)snprintf(path, sizeof path, "%s/%s", root, FOLDERS[i]);
        (void)rmdir(path);
    }
    bat_mesh_free(&shape);
    return rmdir(root);
}

static bat_mesh_study_options small_study(void)
{
    bat_mesh_study_options options = bat_mesh_study_defaults();
    options.vertices = 60;
    options.samples = 5000;
    options.epochs = 1;
    options.pairs = 2;
    options.folder = root;
    return options;
}

/// A file in the folder of the test.
static const char *file(const char *name)
{
    static char path[100];
    (void)snprintf(path, sizeof path, "%s/%s", root, name);
    return path;
}

static void check_and_drop(const char *path)
{
    struct stat about;
    check_status(stat(path, &about) == 0 && about.st_size > 1000 ? BAT_OK : BAT_BAD_FILE, BAT_OK);
    (void)unlink(path);
}

/// Loop's scheme shrinks an ellipsoid, the butterfly interpolates it; midpoint subdivision leaves the decimated surface as
/// it is.
static void scores_are_distances_from_the_original(void **state)
{
    (void)state;
    bat_mesh coarse, fine[METHODS];
    bat_mesh_score scores[METHODS], again[METHODS];
    bat_mesh_study_options options = small_study();
    check_status(bat_mesh_study_shape(&shape, SCHEMES, METHODS, &options, &coarse, fine, scores, NULL), BAT_OK);
    assert_int_equal(coarse.vertex_count, 60);
    for (size_t i = 0; i < METHODS; i++)
    {
        assert_int_equal(fine[i].face_count, 16 * coarse.face_count);
        assert_true(scores[i].mean > 0 && scores[i].mean < scores[i].hausdorff);
        assert_int_equal(scores[i].fallback, 0);
        check_near(scores[i].diagonal, sqrt(9 + 4 + 4), 0.02);
    }
    assert_true(scores[1].mean < 0.5 * scores[0].mean);
    bat_mesh_distance distance;
    bat_mesh_compare_options compare = bat_mesh_compare_defaults();
    compare.samples = options.samples;
    check_status(bat_mesh_compare(&coarse, &shape, &compare, &distance, NULL), BAT_OK);
    check_near(scores[2].hausdorff, distance.hausdorff, 1e-3 * distance.hausdorff);
    check_near(scores[2].mean, distance.mean, 0.05 * distance.mean);
    check_status(bat_mesh_study_draw(file("study.png"), "title", &shape, &coarse, SCHEMES, fine, scores, METHODS, 1, NULL),
                 BAT_OK);
    check_and_drop(file("study.png"));
    bat_mesh_free(&coarse);
    for (size_t i = 0; i < METHODS; i++)
        bat_mesh_free(&fine[i]);
    options.threads = 1;
    check_status(bat_mesh_study_shape(&shape, SCHEMES, METHODS, &options, &coarse, NULL, again, NULL), BAT_OK);
    assert_memory_equal(again, scores, sizeof scores);
    bat_mesh_free(&coarse);
}

static bool stop_at_once(void *context, double fraction)
{
    (void)fraction;
    ++*(size_t *)context;
    return false;
}

static void nonsense_and_stops_leave_nothing(void **state)
{
    (void)state;
    bat_mesh coarse, fine[METHODS];
    bat_mesh_score scores[METHODS];
    bat_mesh_ablation_row rows[BAT_MESH_VARIANT_COUNT];
    bat_mesh_style style;
    size_t asked = 0;
    bat_mesh_study_options options = small_study();
    check_status(bat_mesh_study_shape(&shape, SCHEMES, 0, &options, &coarse, fine, scores, NULL), BAT_INVALID_ARGUMENT);
    options.vertices = 3;
    check_status(bat_mesh_study_shape(&shape, SCHEMES, METHODS, &options, &coarse, fine, scores, NULL),
                 BAT_INVALID_ARGUMENT);
    options = small_study();
    options.folder = NULL;
    check_status(bat_mesh_ablate(&shape, 1, &shape, &options, rows, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_mesh_ablate(&shape, 1, &shape, NULL, rows, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_mesh_style_make(&shape, &shape, &shape, &options, &style, NULL), BAT_INVALID_ARGUMENT);
    options = small_study();
    options.epochs = 0;
    check_status(bat_mesh_ablate(&shape, 1, &shape, &options, rows, NULL), BAT_INVALID_ARGUMENT);
    options = small_study();
    options.progress = (bat_progress){stop_at_once, &asked};
    check_status(bat_mesh_study_shape(&shape, SCHEMES, METHODS, &options, &coarse, fine, scores, NULL), BAT_CANCELLED);
    assert_null(coarse.positions);
    check_status(bat_mesh_ablate(&shape, 1, &shape, &options, rows, NULL), BAT_CANCELLED);
    check_status(bat_mesh_style_make(&shape, &shape, &shape, &options, &style, NULL), BAT_CANCELLED);
    assert_null(style.smooth.positions);
    assert_true(asked >= 3);
}

/// What is no manifold is repaired and said to be; what is stays as it is.
static void shapes_are_repaired_where_needed(void **state)
{
    (void)state;
    bat_mesh mesh;
    bool repaired;
    bat_mesh_repair_report report;
    FILE *stream = fopen(file("fins.obj"), "w");
    assert_non_null(stream);
    (void)fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n", stream);
    (void)fclose(stream);
    check_status(bat_mesh_study_read(file("fins.obj"), &mesh, &repaired, &report, NULL), BAT_OK);
    assert_true(repaired);
    assert_int_equal(report.nonmanifold_edges, 1);
    bat_mesh_connectivity links = connected(&mesh);
    bat_mesh_connectivity_free(&links);
    bat_mesh_free(&mesh);
    (void)unlink(file("fins.obj"));
    check_status(bat_mesh_write(file("ball.obj"), &shape, NULL, NULL), BAT_OK);
    check_status(bat_mesh_study_read(file("ball.obj"), &mesh, &repaired, &report, NULL), BAT_OK);
    assert_false(repaired);
    assert_int_equal(mesh.vertex_count, shape.vertex_count);
    bat_mesh_free(&mesh);
    (void)unlink(file("ball.obj"));
}

/// Six variants of one epoch. Frames that turn along leave the full network's distances nearly alone (not quite: it sees the
/// mesh in its box, which does not turn along), and a second call finds the trainings done.
static void every_variant_is_measured(void **state)
{
    (void)state;
    static const char *const NAMES[] = {"full", "fixed-frames", "no-differences", "last-level", "chamfer", "learn-loop"};
    bat_mesh_ablation_row rows[BAT_MESH_VARIANT_COUNT], again[BAT_MESH_VARIANT_COUNT];
    bat_mesh_study_options options = small_study();
    bat_error error;
    if (bat_mesh_ablate(&shape, 1, &shape, &options, rows, &error) != BAT_OK)
        fail_msg("%s", error.text);
    for (size_t i = 0; i < BAT_MESH_VARIANT_COUNT; i++)
    {
        assert_string_equal(rows[i].variant, NAMES[i]);
        assert_int_equal(rows[i].report.run.epochs, i == BAT_MESH_VARIANT_LEARN_LOOP ? 8 : 1);
        for (size_t level = 0; level < BAT_MESH_TRAIN_LEVELS; level++)
            assert_true(rows[i].errors[level] > 0 && rows[i].errors[level] < 0.5);
        assert_true(rows[i].straight.mean > 0 && rows[i].turned.mean > 0);
        assert_true(rows[i].straight.diagonal == rows[i].turned.diagonal);
    }
    // The untrained networks differ in what they see.
    assert_true(rows[BAT_MESH_VARIANT_FULL].straight.mean != rows[BAT_MESH_VARIANT_FIXED_FRAMES].straight.mean);
    assert_true(rows[BAT_MESH_VARIANT_FULL].errors[1] != rows[BAT_MESH_VARIANT_LEARN_LOOP].errors[1]);
    check_status(bat_mesh_ablate(&shape, 1, &shape, &options, again, &error), BAT_OK);
    for (size_t i = 0; i < BAT_MESH_VARIANT_COUNT; i++)
        assert_true(again[i].straight.mean == rows[i].straight.mean);
}

static void style_subdivides_one_cage_twice(void **state)
{
    (void)state;
    bat_mesh_style style;
    bat_mesh_study_options options = small_study();
    bat_mesh block = ball(1);
    bat_error error;
    if (bat_mesh_style_make(&shape, NULL, &block, &options, &style, &error) != BAT_OK)
        fail_msg("%s", error.text);
    assert_int_equal(style.cage.vertex_count, block.vertex_count);
    assert_int_equal(style.by_smooth.face_count, 16 * block.face_count);
    assert_int_equal(style.by_sharp.face_count, 16 * block.face_count);
    assert_true(style.sharp.vertex_count > 1000);
    for (int i = 0; i < 2; i++)
        assert_true(style.sharp_edges[i] >= 0 && style.sharp_edges[i] <= 1);
    check_status(bat_mesh_style_draw(file("style.png"), &style, 1, NULL), BAT_OK);
    check_and_drop(file("style.png"));
    bat_mesh_style_free(&style);
    bat_mesh_free(&block);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scores_are_distances_from_the_original), cmocka_unit_test(nonsense_and_stops_leave_nothing),
        cmocka_unit_test(shapes_are_repaired_where_needed),       cmocka_unit_test(every_variant_is_measured),
        cmocka_unit_test(style_subdivides_one_cage_twice),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
