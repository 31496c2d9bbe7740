// What a user says of a cloud: its corners, its parameters.

#include "choice_helpers.h"
#include "patch_clouds.h"

#include "batten/batten.h"

#include <unistd.h>

static size_t place_of(const bat_cloud *cloud, size_t point)
{
    return cloud->order == NULL ? point : cloud->order[point];
}

/// The loop begins at the first corner, the others follow, and every point stays itself.
static void corners_turn_the_loop(void **state)
{
    (void)state;
    static const size_t CORNERS[][4] = {{0, 9, 18, 27}, {18, 27, 0, 9}, {27, 18, 9, 0}, {5, 30, 20, 10}, {9, 0, 35, 34}};
    for (size_t which = 0; which < sizeof CORNERS / sizeof CORNERS[0]; which++)
    {
        patch made = patch_mesh(patch_waves, 10, 0.2, 1);
        bat_cloud turned;
        check_status(bat_cloud_copy(&made.cloud, &turned, NULL), BAT_OK);
        check_status(bat_cloud_set_corners(&turned, CORNERS[which], NULL), BAT_OK);
        check_status(bat_cloud_check(&turned, NULL), BAT_OK);
        assert_true(turned.has_corners && turned.corners[0] == 0);
        for (int k = 0; k < 4; k++)
            assert_int_equal(place_of(&turned, turned.corners[k]), CORNERS[which][k]);
        for (size_t i = 0; i < turned.count; i++)
            assert_memory_equal(turned.points + 3 * i, made.cloud.points + 3 * place_of(&turned, i), 3 * sizeof(double));
        for (size_t i = 1; i < turned.boundary_count; i++)
        {
            size_t step = (place_of(&turned, i) + 36 - place_of(&turned, i - 1)) % 36;
            assert_true(step == 1 || step == 35);
        }
        // The loop and the triangles turn over together: parameters stay without a fold.
        double boundary[2 * 36], parameters[200];
        bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
        options.method = BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE;
        bat_cloud_parameters_report report;
        check_status(bat_cloud_boundary_parameters(&turned, BAT_CLOUD_SIDES_CHORD_LENGTH, boundary, NULL), BAT_OK);
        check_status(bat_cloud_parameterize(&turned, boundary, &options, parameters, NULL), BAT_OK);
        check_status(bat_cloud_parameters_check(&turned, parameters, &report, NULL), BAT_OK);
        assert_int_equal(report.folded, 0);
        bat_cloud_free(&turned);
        patch_free(&made);
    }
}

static void wrong_corners_are_refused(void **state)
{
    (void)state;
    static const size_t WRONG[][4] = {{0, 18, 9, 27}, {0, 9, 18, 40}, {0, 9, 9, 27}};
    patch made = patch_scatter(patch_waves, 10, 50, 0, 1);
    for (size_t which = 0; which < sizeof WRONG / sizeof WRONG[0]; which++)
    {
        check_status(bat_cloud_set_corners(&made.cloud, WRONG[which], NULL), BAT_INVALID_ARGUMENT);
        assert_null(made.cloud.order);
        assert_int_equal(made.cloud.corners[1], 9);
    }
    made.cloud.boundary_count = 0;
    made.cloud.has_corners = false;
    check_status(bat_cloud_set_corners(&made.cloud, WRONG[0], NULL), BAT_INVALID_ARGUMENT);
    patch_free(&made);
}

/// A file of its own, removed in the end.
static void with_file(const char *text, void (*use)(const char *path, void *context), void *context)
{
    char path[] = "cloud-given-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), (ssize_t)strlen(text));
    assert_int_equal(close(file), 0);
    use(path, context);
    assert_int_equal(unlink(path), 0);
}

static void write_and_read(const char *path, void *context)
{
    const patch *made = context;
    double *read;
    check_status(bat_cloud_parameters_write(path, &made->cloud, made->parameters, NULL), BAT_OK);
    check_status(bat_cloud_parameters_read(path, &made->cloud, &read, NULL), BAT_OK);
    assert_memory_equal(read, made->parameters, 2 * made->cloud.count * sizeof(double));
    free(read);
}

static void parameters_come_back(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_waves, 10, 50, 0, 7);
    with_file("", write_and_read, &made);
    // In another order, with points of the input left out.
    made.cloud.order = malloc(made.cloud.count * sizeof *made.cloud.order);
    for (size_t i = 0; i < made.cloud.count; i++)
        made.cloud.order[i] = 3 * (made.cloud.count - 1 - i) + 1;
    with_file("", write_and_read, &made);
    patch_free(&made);
}

/// What a bad file is refused for.
typedef struct refusal
{
    size_t line;
    const char *text;
} refusal;

static void refuse(const char *path, void *context)
{
    const refusal *expected = context;
    double points[6] = {0, 0, 0, 1, 1, 1}, *read;
    bat_cloud cloud = {.points = points, .count = 2};
    bat_error error;
    check_status(bat_cloud_parameters_read(path, &cloud, &read, &error), BAT_BAD_FILE);
    assert_int_equal(error.line, expected->line);
    if (strstr(error.text, expected->text) == NULL)
        fail_msg("'%s' does not say '%s'", error.text, expected->text);
}

static void bad_parameters_are_refused(void **state)
{
    (void)state;
    static const struct
    {
        const char *file;
        refusal refusal;
    } BAD[] = {
        {"0 0\n0.5\n", {2, "no v"}},           {"0 0\n0 1.5\n", {2, "from 0 to 1"}},
        {"0 0\n0 -0.1\n", {2, "from 0 to 1"}}, {"0 0\n\n0 x\n", {3, "x"}},
        {"0 0 1\n0 0\n", {1, "more than"}},    {"0 0\n", {0, "1 rows"}},
        {"0 0\n0 1\n1 1\n", {0, "3 rows"}},    {"", {0, "0 rows"}},
        {"0 0\nnan nan\n", {0, "row 1"}},      {"# none\n0 0\n1 inf\n", {3, "inf"}},
    };
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++)
    {
        refusal expected = BAD[i].refusal;
        with_file(BAD[i].file, refuse, &expected);
    }
}

static void formats_have_names(void **state)
{
    (void)state;
    const bat_choice *choice;
    assert_int_equal(choice_value(&bat_cloud_format_family, "ply"), BAT_CLOUD_FORMAT_PLY);
    check_status(bat_choice_find(&bat_cloud_format_family, "dae", &choice, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(choice_value(&bat_surface_format_family, "step"), BAT_SURFACE_FORMAT_STEP);
    check_status(bat_choice_find(&bat_surface_format_family, "brep", &choice, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_choice_of_path(&bat_surface_format_family, "a.b/c.STP", true, &choice, NULL), BAT_OK);
    assert_int_equal(choice->value, BAT_SURFACE_FORMAT_STEP);
    check_status(bat_choice_of_path(&bat_surface_format_family, "step", true, &choice, NULL), BAT_OK);
    assert_null(choice);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_turn_the_loop), cmocka_unit_test(wrong_corners_are_refused),
        cmocka_unit_test(parameters_come_back),  cmocka_unit_test(bad_parameters_are_refused),
        cmocka_unit_test(formats_have_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
