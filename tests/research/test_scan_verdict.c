// The study of verdicts on surfaces of scans, on a folder with one mesh that this test writes.

#include "folder_helpers.h"
#include "mesh_flap_helpers.h"

#include "batten/mesh_file.h"
#include "batten/research/surface_study.h"

static bool stop_at_once(void *context, double fraction)
{
    (void)context;
    (void)fraction;
    return false;
}

static void right_surfaces_are_accepted(void **state)
{
    (void)state;
    bat_scan_verdict_options options = bat_scan_verdict_defaults();
    bat_scan_verdict_row *rows = NULL;
    size_t count = 0, crops = 0;
    bat_mesh fine = ball(5);
    check_status(bat_mesh_write("ball.off", &fine, NULL, NULL), BAT_OK);
    bat_mesh_free(&fine);
    options.crops = 1;
    check_status(bat_scan_verdict(".", &options, &rows, &count, NULL), BAT_OK);
    for (size_t i = 0; i < count; i++)
    {
        const bat_scan_verdict_row *row = &rows[i];
        crops += strcmp(row->shape, "ball.off") == 0;
        if (row->failure[0] != '\0' || !row->is_right || !row->is_accepted)
            fail_msg("%s: %s, missed %g, strays %g, area %g", row->shape, row->failure, row->distance_from_surface,
                     row->distance_from_points, row->area);
        assert_int_equal(row->fault, BAT_SURFACE_FAULT_NONE);
        assert_true(row->points >= 600 && row->noise <= 0.005);
    }
    assert_int_equal(crops, 1);
    free(rows);
    options.progress.report = stop_at_once;
    check_status(bat_scan_verdict(".", &options, &rows, &count, NULL), BAT_CANCELLED);
    assert_int_equal(remove("ball.off"), 0);
}

static void folders_without_meshes_are_refused(void **state)
{
    (void)state;
    bat_scan_verdict_row *rows = NULL;
    size_t count;
    bat_error error;
    check_status(bat_scan_verdict("no/such", NULL, &rows, &count, &error), BAT_FILE_ACCESS);
    assert_non_null(strstr(error.text, "no/such"));
    check_status(bat_scan_verdict(".", NULL, &rows, &count, &error), BAT_FILE_ACCESS);
    assert_non_null(strstr(error.text, "there are no meshes"));
    bat_scan_verdict_options options = bat_scan_verdict_defaults();
    options.crops = 0;
    check_status(bat_scan_verdict(".", &options, &rows, &count, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "crops"));
    assert_null(rows);
}

/// Without a folder, bodies with rims are made.
static void bodies_need_no_folder(void **state)
{
    (void)state;
    bat_scan_solids_options options = bat_scan_solids_defaults();
    bat_scan_solids_row *rows = NULL;
    size_t count = 0;
    options.progress = (bat_progress){stop_at_once, NULL};
    check_status(bat_scan_solids(NULL, &options, &rows, &count, NULL), BAT_CANCELLED);
    assert_null(rows);
}

static void shells_of_a_ball_are_right(void **state)
{
    (void)state;
    bat_scan_solids_options options = bat_scan_solids_defaults();
    bat_scan_solids_row *rows = NULL;
    bat_error error;
    size_t count = 0;
    check_status(bat_scan_solids(".", NULL, &rows, &count, &error), BAT_FILE_ACCESS);
    options.points = 10;
    check_status(bat_scan_solids(".", &options, &rows, &count, &error), BAT_INVALID_ARGUMENT);
    options.points = 2000;
    bat_mesh fine = ball(5);
    check_status(bat_mesh_write("ball.off", &fine, NULL, NULL), BAT_OK);
    bat_mesh_free(&fine);
    check_status(bat_scan_solids(".", &options, &rows, &count, NULL), BAT_OK);
    assert_int_equal(count, 3);
    for (size_t i = 0; i < count; i++)
    {
        if (!rows[i].is_right || rows[i].failure[0] != '\0')
            fail_msg("noise %g: %s, largest %g", rows[i].noise, rows[i].failure, rows[i].largest);
        assert_true(rows[i].rms < 0.001 + 0.4 * rows[i].noise);
        assert_true(rows[i].largest >= rows[i].rms && fabs(rows[i].volume) < 0.005);
    }
    assert_true(rows[1].scanner != rows[2].scanner || rows[0].scanner != rows[1].scanner);
    free(rows);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(right_surfaces_are_accepted, enter_folder, leave_folder),
        cmocka_unit_test(bodies_need_no_folder),
        cmocka_unit_test_setup_teardown(shells_of_a_ball_are_right, enter_folder, leave_folder),
        cmocka_unit_test_setup_teardown(folders_without_meshes_are_refused, enter_folder, leave_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
