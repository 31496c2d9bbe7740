// What the fuzzers of fuzz/ found in calls that compute: each input small, with the result that it must have. Reads and
// writes out of bounds show under `make sanitize` alone.

#include "batten/batten.h"
#include "check.h"

#include <stdlib.h>

static bat_curve_refine_options options_of(const char *scheme)
{
    bat_curve_refine_options options = bat_curve_refine_defaults();
    check_status(bat_curve_scheme_by_name(scheme, &options.scheme, NULL), BAT_OK);
    return options;
}

/// A scheme that needs a mean angle read the point before the first where no level was wanted.
static void no_level_is_measured_without_levels(void **state)
{
    (void)state;
    bat_space space = bat_euclidean(2);
    double points[] = {0, 0, 1, 0, 1, 1, 0, 1};
    const bat_curve ring = {.space = &space, .points = points, .count = 4, .closed = true};
    bat_curve_refine_options options = options_of("angle-6:adaptive=1");
    options.levels = 0;
    bat_curve fine;
    check_status(bat_curve_refine(&ring, &options, &fine, NULL), BAT_OK);
    assert_int_equal(fine.count, 4);
    assert_memory_equal(fine.points, points, sizeof points);
    bat_curve_free(&fine);
}

/// A tolerance that no level meets was tested to the most levels, 2^40 points, whatever `max_points` allowed.
static void a_tolerance_out_of_reach_ends_at_the_allowed_points(void **state)
{
    (void)state;
    bat_space space = bat_euclidean(2);
    double points[] = {0, 0, 1, 0, 1, 2, -3, 1};
    const bat_curve line = {.space = &space, .points = points, .count = 4};
    bat_curve_refine_options options = options_of("four-point");
    options.tolerance = 1e-300;
    options.max_levels = 40;
    options.max_points = 4000;
    bat_curve fine;
    bat_error error;
    check_status(bat_curve_refine(&line, &options, &fine, &error), BAT_TOO_LARGE);
    assert_non_null(strstr(error.text, "more than 4000 points"));
}

/// A ring of a map with two points of one place in a file got a level where none was wanted, from memory behind its points.
static void repeated_places_of_a_map_get_no_level_that_is_not_wanted(void **state)
{
    (void)state;
    static const double RING[] = {1.25e-14,
                                  -1,
                                  2.5e-15,
                                  -0.68813948289354288,
                                  -0.21259593780450919,
                                  -0.6937341128357668,
                                  -1.5956362296965495e-293,
                                  -1,
                                  -2.490749236599492e-293};
    bat_space space = bat_sphere(2);
    bat_curve *curves = calloc(1, sizeof *curves);
    curves[0] = (bat_curve){.space = &space, .points = malloc(sizeof RING), .count = 3, .closed = true};
    memcpy(curves[0].points, RING, sizeof RING);
    bat_curve_set set, fine;
    check_status(bat_curve_set_take(curves, 1, &set, NULL), BAT_OK);
    bat_curve_map_refine_options options = bat_curve_map_refine_defaults();
    options.topology = BAT_CURVE_MAP_TOPOLOGY_ALWAYS;
    options.refine.relative_tolerance = 0;
    options.refine.levels = 0;
    check_status(bat_curve_map_refine(&set, &options, &fine, NULL), BAT_OK);
    check_status(bat_space_check(&space, fine.curves[0].points, fine.curves[0].count, NULL), BAT_OK);
    assert_int_equal(fine.curves[0].count, 3);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&set);
}

/// A mesh without channels, refined up to a tolerance, took the address of its channels.
static void meshes_without_channels_are_refined_up_to_a_tolerance(void **state)
{
    (void)state;
    double positions[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 4};
    uint32_t faces[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
    const bat_mesh coarse = {.positions = positions, .faces = faces, .vertex_count = 4, .face_count = 4};
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_LOOP;
    options.tolerance = 0.05;
    bat_mesh fine;
    check_status(bat_mesh_refine(&coarse, &options, &fine, NULL, NULL), BAT_OK);
    assert_true(fine.face_count > 4 && fine.channels == NULL);
    bat_mesh_free(&fine);
}

/// Tangents and points beyond the range of doubles came out as NaN.
static void motions_beyond_the_range_of_doubles_are_refused(void **state)
{
    (void)state;
    bat_space space = bat_euclidean(2);
    double points[] = {-32, -32, 1e300, 7}, tangents[4], times[] = {0, 1e-300}, point[2];
    bat_hermite_curve keys = {.space = &space, .points = points, .tangents = tangents, .times = times, .count = 2};
    check_status(bat_hermite_estimate_tangents(&keys, 2, NULL), BAT_INVALID_POINT);

    memset(tangents, 0, sizeof tangents);
    times[1] = 2.9e306;
    bat_motion_spline *spline = NULL;
    check_status(bat_motion_spline_make(&keys, NULL, &spline, NULL), BAT_INVALID_ARGUMENT);

    times[1] = 1;
    points[2] = 1e100;
    bat_motion_spline_options options = bat_motion_spline_defaults();
    options.extrapolate = true;
    keys.tangents = NULL;
    check_status(bat_motion_spline_make(&keys, &options, &spline, NULL), BAT_OK);
    check_status(bat_motion_spline_at(spline, 1, point, NULL, NULL, NULL), BAT_OK);
    check_status(bat_motion_spline_at(spline, 1e250, point, NULL, NULL, NULL), BAT_INVALID_POINT);
    bat_motion_spline_free(spline);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_level_is_measured_without_levels),
        cmocka_unit_test(a_tolerance_out_of_reach_ends_at_the_allowed_points),
        cmocka_unit_test(repeated_places_of_a_map_get_no_level_that_is_not_wanted),
        cmocka_unit_test(meshes_without_channels_are_refined_up_to_a_tolerance),
        cmocka_unit_test(motions_beyond_the_range_of_doubles_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
