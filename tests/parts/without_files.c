// A build without files: what is built in works, and what reads files says that it cannot.

#include "check.h"

#include <batten/batten.h>

#if BAT_HAS_FILES
#error "this test is for builds without files"
#endif

static void models_are_not_read(void **state)
{
    (void)state;
    bat_curve_model *curve = NULL;
    bat_mesh_model *mesh = NULL;
    bat_error error = {0};
    check_status(bat_curve_model_read("weights.safetensors", &curve, &error), BAT_UNSUPPORTED);
    assert_string_equal(error.text, "this build of the library reads no files");
    check_status(bat_mesh_model_read("weights.safetensors", &mesh, &error), BAT_UNSUPPORTED);
    assert_true(curve == NULL && mesh == NULL);
}

static void built_in_models_refine(void **state)
{
    (void)state;
    bat_curve_model *curve = NULL;
    bat_mesh_model *builtin = NULL;
    check_status(bat_curve_model_read(NULL, &curve, NULL), BAT_OK);
    check_status(bat_mesh_model_read(NULL, &builtin, NULL), BAT_OK);

    const bat_space plane = bat_euclidean(2);
    double corners[] = {0, 0, 16, 0, 16, 16, 0, 16};
    const bat_curve square = {.space = &plane, .points = corners, .count = 4, .closed = true};
    const bat_curve_scheme schemes[] = {bat_curve_scheme_learned(0.5), bat_curve_scheme_of_model(curve)};
    for (size_t i = 0; i < 2; i++)
    {
        bat_curve_refine_options options = bat_curve_refine_defaults();
        options.scheme = schemes[i];
        options.levels = 3;
        bat_curve fine = {0};
        check_status(bat_curve_refine(&square, &options, &fine, NULL), BAT_OK);
        assert_int_equal(fine.count, 32);
        bat_curve_free(&fine);
    }
    bat_curve_model_free(curve);
    bat_mesh_model_free(builtin);
}

/// Curves that come from no file make a set, and a set makes motions.
static void sets_make_motions(void **state)
{
    (void)state;
    const bat_space plane = bat_euclidean(2);
    double *points = malloc(8 * sizeof *points);
    assert_non_null(points);
    for (size_t i = 0; i < 8; i++)
        points[i] = (double)(i * i);
    bat_curve curve = {.space = &plane, .points = points, .count = 4};
    bat_curve_set set, fine;
    check_status(bat_curve_set_single(&curve, &set, NULL), BAT_OK);
    assert_false(bat_motion_has_times(&set));
    bat_motion_curves_options options = bat_motion_curves_defaults();
    options.rate = 4;
    check_status(bat_motion_curves(&set, &options, &fine, NULL), BAT_OK);
    assert_int_equal(fine.count, 1);
    assert_int_equal(fine.curves[0].count, 13);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(models_are_not_read),
        cmocka_unit_test(built_in_models_refine),
        cmocka_unit_test(sets_make_motions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
