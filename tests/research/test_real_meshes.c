// The study of coarse meshes that other programs made, on a small folder of files that this test writes.

#include "folder_helpers.h"
#include "mesh_flap_helpers.h"

#include "batten/mesh_file.h"
#include "batten/research/mesh_study.h"

#include <sys/stat.h>

enum
{
    METHODS = 6
};

/// A fine ball, and a coarse one whose vertices lie on it. In the folder coarse-by beside its shape.
static void write_meshes(void)
{
    bat_mesh fine = ball(5), coarse = ball(2);
    assert_int_equal(mkdir("coarse-by", 0777), 0);
    check_status(bat_mesh_write("a-ball.off", &fine, NULL, NULL), BAT_OK);
    check_status(bat_mesh_write("coarse-by/a-ball-66-sampled.off", &coarse, NULL, NULL), BAT_OK);
    bat_mesh_free(&fine);
    bat_mesh_free(&coarse);
}

static void remove_meshes(void)
{
    assert_int_equal(remove("coarse-by/a-ball-66-sampled.off"), 0);
    assert_int_equal(rmdir("coarse-by"), 0);
}

static bool stop_at_once(void *context, double fraction)
{
    (void)context;
    (void)fraction;
    return false;
}

static void rows_are_in_order_and_right(void **state)
{
    (void)state;
    static const char *const NAMES[METHODS] = {"flat",    "butterfly",           "loop",
                                               "learned", "learned, fairness 0", "learned, fairness 1"};
    bat_real_meshes_options options = bat_real_meshes_defaults();
    bat_real_meshes_row *rows = NULL;
    size_t count = 0;
    options.samples = 4000;
    write_meshes();
    check_status(bat_real_meshes(".", &options, &rows, &count, NULL), BAT_OK);
    assert_int_equal(count, METHODS);
    double best = fmin(fmin(rows[0].mean, rows[1].mean), rows[2].mean);
    for (size_t i = 0; i < METHODS; i++)
    {
        const bat_real_meshes_row *row = &rows[i];
        assert_string_equal(row->method, NAMES[i]);
        assert_string_equal(row->shape, "a-ball");
        assert_string_equal(row->way, "sampled");
        assert_int_equal(row->vertices, 66);
        assert_true(row->mean > 0 && row->hausdorff >= row->mean);
        check_near(row->relative, row->mean / best, 1e-12);
        assert_true(row->angle > 0 && row->true_angle > 0);
    }
    // A polyhedron in the ball: 66 vertices take 8 % of the volume; Loop's scheme takes more, the butterfly less.
    check_near(rows[0].volume, -0.08, 0.03);
    assert_true(rows[2].volume < rows[0].volume && fabs(rows[1].volume) < 0.02);
    // On the ball itself all angles are small; the flat mesh has those of the coarse one.
    assert_true(rows[0].angle > 1.5 * rows[0].true_angle);
    free(rows);
    options.progress.report = stop_at_once;
    check_status(bat_real_meshes(".", &options, &rows, &count, NULL), BAT_CANCELLED);
    remove_meshes();
}

static void folders_without_meshes_are_refused(void **state)
{
    (void)state;
    bat_real_meshes_row *rows = NULL;
    size_t count;
    bat_error error;
    check_status(bat_real_meshes("no/such", NULL, &rows, &count, &error), BAT_FILE_ACCESS);
    assert_non_null(strstr(error.text, "no/such/coarse-by"));
    write_meshes();
    assert_int_equal(remove("a-ball.off"), 0);
    check_status(bat_real_meshes(".", NULL, &rows, &count, &error), BAT_FILE_ACCESS);
    assert_non_null(strstr(error.text, "there is no a-ball.obj"));
    assert_int_equal(rename("coarse-by/a-ball-66-sampled.off", "coarse-by/a.off"), 0);
    check_status(bat_real_meshes(".", NULL, &rows, &count, &error), BAT_BAD_FILE);
    assert_non_null(strstr(error.text, "SHAPE-VERTICES-WAY.off"));
    assert_int_equal(remove("coarse-by/a.off"), 0);
    check_status(bat_real_meshes(".", NULL, &rows, &count, &error), BAT_FILE_ACCESS);
    assert_int_equal(rmdir("coarse-by"), 0);
    bat_real_meshes_options options = bat_real_meshes_defaults();
    options.levels = 0;
    check_status(bat_real_meshes(".", &options, &rows, &count, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "levels"));
    assert_null(rows);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(rows_are_in_order_and_right, enter_folder, leave_folder),
        cmocka_unit_test_setup_teardown(folders_without_meshes_are_refused, enter_folder, leave_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
