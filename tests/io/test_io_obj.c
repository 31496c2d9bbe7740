#include "test_io_helpers.h"

static const bat_curve_format OBJ = BAT_CURVE_FORMAT_OBJ;

static void line_elements_become_curves(void **state)
{
    (void)state;
    const char *text =
        "# a drawing\nmtllib a.mtl\no one\nv 0 0 0\nv 1 0 0 # corner\nv 1 1 0\nvn 0 0 1\nl 1 2 3\nl 1 2/5 3 1\r\n"
        "v 5 5 0\nl -1 -4\nf 1 2 3\n";
    bat_curve_set set = must_read(text, BAT_CURVE_FORMAT_AUTO, NULL);
    assert_string_equal(set.space->name, "plane");
    assert_int_equal(set.count, 3);
    assert_int_equal(set.curves[0].count, 3);
    assert_false(set.curves[0].closed);
    assert_int_equal(set.curves[1].count, 3);
    assert_true(set.curves[1].closed);
    const double last[] = {5, 5, 0, 0};
    assert_memory_equal(set.curves[2].points, last, sizeof last);
    assert_int_equal(bat_curve_set_line(&set, 0, 1), 5);
    assert_int_equal(bat_curve_set_line(&set, 2, 0), 10);
    bat_curve_set_free(&set);
}

static void the_third_coordinate_tells_the_space(void **state)
{
    (void)state;
    const char *solid = "v 1 0 0\nv 0 1 0\nv 0 0 1\nl 1 2 3\n";
    bat_curve_set set = must_read(solid, OBJ, NULL);
    assert_string_equal(set.space->name, "euclidean");
    assert_int_equal(set.space->point_dim, 3);
    bat_curve_set_free(&set);
    set = must_read(solid, OBJ, "sphere");
    assert_string_equal(set.space->name, "sphere");
    bat_curve_set_free(&set);
    set = must_read("v 1 0\nv 0 1\nl 1 2\n", OBJ, NULL);
    assert_string_equal(set.space->name, "plane");
    bat_curve_set_free(&set);
    set = must_read("v .5 0 0 1\nv 0 .5 0 1\nl 1 2\n", OBJ, "disk");
    assert_string_equal(set.space->name, "disk");
    bat_curve_set_free(&set);
    assert_bad(solid, OBJ, "plane", 3, "no third coordinate");
    assert_bad("v 1 0 0\nv 0 1 0\nv 0 0 2\nl 1 2 3\n", OBJ, "sphere", 3, "the point is");
}

static void curves_are_written_as_elements(void **state)
{
    (void)state;
    assert_rewritten("v 0 0\nv 1 0\nv 0 1\nl 1 2 3 1\nl 3 1\n", OBJ, NULL,
                     "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 1 0\nv 0 0 0\nl 1 2 3 1\nl 4 5\n");
    assert_rewritten("v 0.1 0 1e-7\nv 1 0 -3\nl 1 2\n", OBJ, NULL, "v 0.1 0 1e-07\nv 1 0 -3\nl 1 2\n");
}

static void long_curves_survive(void **state)
{
    (void)state;
    enum
    {
        COUNT = 100000
    };
    bat_random random = bat_random_seed(9);
    bat_space space = bat_euclidean(3);
    double *points = malloc(3 * COUNT * sizeof *points);
    for (size_t i = 0; i < 3 * COUNT; i++)
        points[i] = bat_random_normal(&random);
    bat_curve curve = {.space = &space, .points = points, .count = COUNT, .closed = true};
    bat_curve_set set, back = {0};
    assert_int_equal(bat_curve_set_single(&curve, &set, NULL), BAT_OK);
    char *text = must_write(&set, OBJ);
    assert_int_equal(read_string(text, OBJ, NULL, &back, NULL), BAT_OK);
    assert_int_equal(back.count, 1);
    assert_true(back.curves[0].closed);
    assert_int_equal(back.curves[0].count, COUNT);
    assert_memory_equal(back.curves[0].points, points, 3 * COUNT * sizeof *points);
    free(text);
    bat_curve_set_free(&set);
    bat_curve_set_free(&back);
}

static void an_option_opens_or_closes(void **state)
{
    (void)state;
    const char *text = "v 0 0\nv 1 0\nv 0 1\nl 1 2 3 1\nl 1 2 3\n";
    bat_curve_read_options options = bat_curve_read_defaults();
    options.format = OBJ;
    const size_t counts[2][2] = {{4, 3}, {3, 3}};
    for (int closed = 0; closed <= 1; closed++)
    {
        options.closed = closed;
        bat_curve_set set = {0};
        assert_int_equal(bat_curve_read_memory(text, strlen(text), &options, &set, NULL), BAT_OK);
        for (size_t i = 0; i < 2; i++)
        {
            assert_int_equal(set.curves[i].closed, closed);
            assert_int_equal(set.curves[i].count, counts[closed][i]);
        }
        bat_curve_set_free(&set);
    }
}

static void bad_files_name_their_line(void **state)
{
    (void)state;
    assert_bad("", OBJ, NULL, 0, "no line elements");
    assert_bad("v 0 0 0\nf 1 1 1\n", OBJ, NULL, 2, "no line elements");
    assert_bad("v 0\nl 1 2\n", OBJ, NULL, 1, "needs 2 or 3 numbers");
    assert_bad("v 0 0 x\n", OBJ, NULL, 1, "'x' is not a number");
    assert_bad("v 0 0 nan\n", OBJ, NULL, 1, "'nan' is not a number");
    assert_bad("v 0 0 1e999\n", OBJ, NULL, 1, "'1e999' is too large");
    assert_bad("v 0 0 0 0 0 0 0 0\n", OBJ, NULL, 1, "at most 7 numbers");
    assert_bad("v 0 0\nv 1 1\nl 1 3\n", OBJ, NULL, 3, "no vertex 3, the file has 2");
    assert_bad("v 0 0\nv 1 1\nl 1 -3\n", OBJ, NULL, 3, "'-3' is not the index");
    assert_bad("v 0 0\nv 1 1\nl 0 1\n", OBJ, NULL, 3, "'0' is not the index");
    assert_bad("v 0 0\nv 1 1\nl 1 2.5\n", OBJ, NULL, 3, "'2.5' is not the index");
    assert_bad("v 0 0\nv 1 1\nl 1 99999999999999999999999\n", OBJ, NULL, 3, "is not the index");
    assert_bad("v 0 0\nl 1\n", OBJ, NULL, 2, "at least 2 vertices");
    assert_bad("v 0 0\nl\n", OBJ, NULL, 2, "at least 2 vertices");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(line_elements_become_curves),    cmocka_unit_test(the_third_coordinate_tells_the_space),
        cmocka_unit_test(curves_are_written_as_elements), cmocka_unit_test(long_curves_survive),
        cmocka_unit_test(an_option_opens_or_closes),      cmocka_unit_test(bad_files_name_their_line)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
