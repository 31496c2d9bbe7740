// From clouds to surfaces in one call.

#include "patch_clouds.h"

#include "cloud_helpers.h"

#include "batten/batten.h"
#include "batten/research/research.h"

static bat_surface_reconstruct_options options_for(bat_surface_parameters parameters, size_t functions)
{
    bat_surface_reconstruct_options options = bat_surface_reconstruct_defaults();
    options.parameters = parameters;
    options.fit.functions = functions;
    options.fit.threads = 1;
    return options;
}

static bat_surface_result must_reconstruct(bat_cloud *cloud, const bat_surface_reconstruct_options *options)
{
    bat_surface_result result = {0};
    bat_error error = {0};
    if (bat_surface_reconstruct(cloud, options, &result, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return result;
}

static const bat_surface_fit_round *last_round(const bat_surface_result *result)
{
    return &result->report.rounds[result->report.count - 1];
}

static void names_and_defaults(void **state)
{
    (void)state;
    assert_string_equal(bat_choice_name(&bat_surface_parameters_family, BAT_SURFACE_PARAMETERS_AUTO), "auto");
    assert_string_equal(bat_choice_name(&bat_surface_parameters_family, BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING),
                        "shape-preserving");
    assert_string_equal(bat_choice_name(&bat_surface_parameters_family, BAT_SURFACE_PARAMETERS_GIVEN), "given");
    assert_string_equal(bat_choice_name(&bat_surface_parameters_family, BAT_SURFACE_PARAMETERS_COUNT), "unknown");
    assert_int_equal(bat_surface_reconstruct_defaults().parameters, BAT_SURFACE_PARAMETERS_AUTO);
    assert_int_equal(bat_surface_reconstruct_defaults().sides, BAT_CLOUD_SIDES_AUTO);
    // Reports find the row of a fault or a doubt by its value.
    for (int i = BAT_SURFACE_FAULT_NONE; i <= BAT_SURFACE_FAULT_AREA; i++)
        assert_int_equal(bat_choices(&bat_surface_fault_family, (size_t)i)->value, i);
    for (int i = BAT_SURFACE_DOUBT_NONE; i <= BAT_SURFACE_DOUBT_FEW; i++)
        assert_int_equal(bat_choices(&bat_surface_doubt_family, (size_t)i)->value, i);
}

/// A Bézier surface with its true parameters lies in the coarsest space.
static void bezier_surfaces_come_back(void **state)
{
    (void)state;
    for (int degree = 2; degree <= 4; degree++)
    {
        bat_random random = bat_random_seed((uint64_t)degree);
        bat_cloud_bezier_options make = bat_cloud_bezier_defaults();
        make.degree = degree;
        make.interior = 300;
        bat_cloud cloud;
        double *truth;
        check_status(bat_cloud_bezier(&make, &random, &cloud, &truth, NULL), BAT_OK);
        bat_surface_reconstruct_options options =
            options_for(BAT_SURFACE_PARAMETERS_GIVEN, (size_t)((degree + 1) * (degree + 1)));
        options.given = truth;
        options.fit.space.degree[0] = options.fit.space.degree[1] = degree;
        options.fit.smoothing = BAT_SURFACE_SMOOTHING_GIVEN;
        bat_surface_result result = must_reconstruct(&cloud, &options);
        check_near(last_round(&result)->largest, 0, 1e-10);
        assert_int_equal(result.folds.folded, 0);
        assert_int_equal(result.chosen, BAT_SURFACE_PARAMETERS_GIVEN);
        bat_surface_result_free(&result);
        bat_cloud_free(&cloud);
        free(truth);
    }
}

/// Given parameters are taken where nothing is known of the boundary, and may lie inside the square.
static void given_parameters_need_no_boundary(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_waves, 10, 400, 0, 3);
    for (size_t k = 0; k < 2 * made.cloud.count; k++)
        made.parameters[k] = 0.1 + 0.8 * made.parameters[k];
    bat_surface_reconstruct_options options = options_for(BAT_SURFACE_PARAMETERS_GIVEN, 100);
    options.given = made.parameters;
    for (int known = 0; known < 2; known++)
    {
        made.cloud.boundary_count = known == 1 ? made.cloud.boundary_count : 0;
        made.cloud.has_corners = known == 1;
        bat_surface_result result = must_reconstruct(&made.cloud, &options);
        assert_false(result.boundary_found);
        assert_true(last_round(&result)->rms < 0.01);
        bat_surface_result_free(&result);
        made.cloud.boundary_count = 36;
    }
    patch_free(&made);
}

static void auto_takes_the_best_by_measure(void **state)
{
    (void)state;
    for (int mesh = 0; mesh < 2; mesh++)
    {
        patch made = mesh == 1 ? patch_mesh(patch_waves, 20, 0.3, 5) : patch_scatter(patch_waves, 20, 500, 0.002, 5);
        bat_surface_reconstruct_options options = options_for(BAT_SURFACE_PARAMETERS_AUTO, 60);
        bat_surface_result result = must_reconstruct(&made.cloud, &options);
        assert_int_equal(result.candidate_count, mesh == 1 ? (size_t)5 : 4);
        assert_int_equal(result.trial_points, made.cloud.count);
        assert_int_not_equal(result.chosen, BAT_SURFACE_PARAMETERS_AUTO);
        for (size_t i = 0; i < result.candidate_count; i++)
        {
            const bat_surface_candidate *candidate = &result.candidates[i];
            bool fitted = isfinite(candidate->mean_squared);
            assert_true((candidate->failure.status == BAT_OK) == fitted);
            assert_true(candidate->excluded || !(candidate->mean_squared < last_round(&result)->mean_squared));
            if (candidate->parameters == result.chosen)
                check_near(candidate->mean_squared, last_round(&result)->mean_squared, 0);
        }
        bat_surface_result_free(&result);
        patch_free(&made);
    }
}

/// A deep cup over a narrow rim: averages crowd its points into the middle of the square, and a surface through them strays
/// where there are none. Whatever is taken stays near the points.
static void patch_cup(double u, double v, double place[3])
{
    double x = 2 * u - 1, y = 2 * v - 1, reach = fmax(fabs(x), fabs(y)), turn = atan2(y, x);
    double rise = 2.9 * (1 - reach), radius = sin(0.25 + rise);
    place[0] = radius * cos(turn);
    place[1] = radius * sin(turn);
    place[2] = -cos(0.25 + rise);
}

static void what_strays_is_out(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_cup, 16, 3000, 0, 3);
    bat_surface_reconstruct_options options = options_for(BAT_SURFACE_PARAMETERS_AUTO, 600);
    bat_surface_result result = must_reconstruct(&made.cloud, &options);
    double least = INFINITY, taken = INFINITY;
    for (size_t i = 0; i < result.candidate_count; i++)
    {
        const bat_surface_candidate *candidate = &result.candidates[i];
        if (candidate->failure.status == BAT_OK)
            least = fmin(least, candidate->hausdorff);
        if (candidate->parameters == result.chosen)
            taken = candidate->hausdorff;
    }
    assert_true(least > 0 && taken <= 2 * least);
    for (size_t i = 0; i < result.candidate_count; i++)
        if (result.candidates[i].failure.status == BAT_OK)
            assert_int_equal(result.candidates[i].excluded, result.candidates[i].hausdorff > 2 * least);
    bat_surface_result_free(&result);
    patch_free(&made);
}

/// The way that auto chooses gives what it gives alone.
static void auto_is_its_choice(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_waves, 16, 400, 0.01, 8);
    bat_surface_reconstruct_options options = options_for(BAT_SURFACE_PARAMETERS_AUTO, 50);
    bat_surface_result all = must_reconstruct(&made.cloud, &options);
    options.parameters = all.chosen;
    bat_surface_result one = must_reconstruct(&made.cloud, &options);
    assert_int_equal(one.candidate_count, 1);
    assert_memory_equal(all.parameters, one.parameters, 2 * made.cloud.count * sizeof(double));
    bat_surface_result_free(&all);
    bat_surface_result_free(&one);
    patch_free(&made);
}

static void unknown_boundaries_are_found(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_waves, 24, 500, 0, 4);
    shuffle_cloud(&made.cloud, 4);
    made.cloud.boundary_count = 0;
    made.cloud.has_corners = false;
    bat_surface_reconstruct_options options = options_for(BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING, 100);
    bat_surface_result result = must_reconstruct(&made.cloud, &options);
    assert_true(result.boundary_found && result.corners_found);
    assert_true(made.cloud.boundary_count >= 60);
    assert_true(last_round(&result)->rms < 0.01);
    for (size_t i = 0; i < 2 * made.cloud.count; i++)
        assert_true(result.parameters[i] >= 0 && result.parameters[i] <= 1);
    bat_surface_result_free(&result);
    patch_free(&made);
}

/// Not a byte depends on the number of threads.
static void threads_do_not_matter(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_waves, 20, 800, 0.005, 9);
    bat_surface_reconstruct_options options = options_for(BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING, 150);
    bat_surface_result one = must_reconstruct(&made.cloud, &options);
    options.fit.threads = 3;
    bat_surface_result three = must_reconstruct(&made.cloud, &options);
    size_t functions = bat_hierarchical_space_functions(one.surface.space);
    assert_int_equal(functions, bat_hierarchical_space_functions(three.surface.space));
    assert_memory_equal(one.surface.control, three.surface.control, 3 * functions * sizeof(double));
    assert_memory_equal(one.parameters, three.parameters, 2 * made.cloud.count * sizeof(double));
    bat_surface_result_free(&one);
    bat_surface_result_free(&three);
    patch_free(&made);
}

/// A cloud too large for whole trials is tried in part, and fitted whole.
static void large_clouds_are_tried_in_part(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_waves, 150, 22000, 0, 2);
    bat_surface_reconstruct_options options = options_for(BAT_SURFACE_PARAMETERS_AUTO, 200);
    bat_surface_result result = must_reconstruct(&made.cloud, &options);
    assert_true(result.trial_points < made.cloud.count);
    assert_true(last_round(&result)->functions <= 200);
    assert_true(last_round(&result)->rms < 0.01);
    bat_surface_result_free(&result);
    patch_free(&made);
}

/// A sheet bent to an S: two half tubes.
static void patch_bent(double u, double v, double place[3])
{
    double t = 2 * (2 * u - 1), side = t < 0 ? -1 : 1;
    place[0] = side * 0.25 * (1 - cos(1.5 * t));
    place[1] = side * 0.25 * sin(1.5 * fabs(t)) + 0.05 * u;
    place[2] = v;
}

/// Neither the order of the points nor a reflection changes a surface beyond rounding.
static void the_order_of_points_does_not_matter(void **state)
{
    (void)state;
    double first = 0, area = 0;
    for (uint64_t seed = 0; seed < 5; seed++)
    {
        patch made = patch_scatter(patch_bent, 24, 900, 0.001, 12);
        for (size_t i = 0; i < made.cloud.count && seed == 4; i++)
            made.cloud.points[3 * i] = -made.cloud.points[3 * i];
        shuffle_cloud(&made.cloud, 20 + seed);
        bat_surface_reconstruct_options options = options_for(BAT_SURFACE_PARAMETERS_AUTO, 0);
        bat_surface_result result = must_reconstruct(&made.cloud, &options);
        double rms = last_round(&result)->rms;
        first = seed == 0 ? rms : first;
        area = seed == 0 ? result.verdict.area : area;
        if (seed < 4)
        {
            check_relative(rms, first, 1e-9);
            check_relative(result.verdict.area, area, 1e-9);
        }
        assert_true(rms < 2 * first && result.verdict.fault == BAT_SURFACE_FAULT_NONE);
        bat_surface_result_free(&result);
        patch_free(&made);
    }
}

/// A surface that is far from its points' shape is refused, unless it is forced.
static void wrong_surfaces_are_refused(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_waves, 16, 600, 0, 4);
    bat_surface_reconstruct_options options = options_for(BAT_SURFACE_PARAMETERS_GIVEN, 150);
    bat_random random = bat_random_seed(5);
    for (size_t k = 2 * made.cloud.boundary_count; k < 2 * made.cloud.count; k++)
        made.parameters[k] = bat_random_uniform(&random);
    options.given = made.parameters;
    options.fit.corrections = 0;
    bat_surface_result result = {0};
    bat_error error = {0};
    check_status(bat_surface_reconstruct(&made.cloud, &options, &result, &error), BAT_NO_CONVERGENCE);
    assert_non_null(strstr(error.text, "the surface is wrong: "));
    assert_string_equal(error.remedy, "trim");
    assert_null(result.surface.space);
    options.force = true;
    bat_surface_result forced = must_reconstruct(&made.cloud, &options);
    assert_int_not_equal(forced.verdict.fault, BAT_SURFACE_FAULT_NONE);
    bat_surface_result_free(&forced);
    patch_free(&made);
}

/// A Moebius band: one loop, but no surface patch.
static void one_sided_surfaces_are_told(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(3);
    bat_cloud cloud = {.points = malloc(2000 * 3 * sizeof *cloud.points), .count = 2000};
    for (size_t i = 0; i < cloud.count; i++)
    {
        double t = 2 * 3.14159265358979 * bat_random_uniform(&random), w = 0.5 * (bat_random_uniform(&random) - 0.5);
        cloud.points[3 * i] = (1 + w * cos(t / 2)) * cos(t);
        cloud.points[3 * i + 1] = (1 + w * cos(t / 2)) * sin(t);
        cloud.points[3 * i + 2] = w * sin(t / 2);
    }
    bat_surface_result result = {0};
    bat_error error = {0};
    check_status(bat_surface_reconstruct(&cloud, NULL, &result, &error), BAT_NO_CONVERGENCE);
    assert_non_null(strstr(error.text, "one-sided"));
    bat_cloud_free(&cloud);
}

/// Lines 20 times as far apart as the points on them.
static void scan_lines_are_fitted(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_waves, 4, 24000, 0, 4);
    for (size_t i = 0; i < made.cloud.count; i++)
        patch_waves((double)(i % 35) / 34, (double)(i / 35) / (double)((made.cloud.count - 1) / 35),
                    made.cloud.points + 3 * i);
    made.cloud.boundary_count = 0;
    made.cloud.has_corners = false;
    bat_surface_reconstruct_options options = bat_surface_reconstruct_defaults();
    bat_surface_result result = must_reconstruct(&made.cloud, &options);
    assert_int_equal(result.verdict.fault, BAT_SURFACE_FAULT_NONE);
    assert_true(result.trial_points < made.cloud.count / 4);
    assert_true(last_round(&result)->rms < 0.005);
    bat_surface_result_free(&result);
    patch_free(&made);
}

static bool stop_when(void *context, double fraction)
{
    return fraction < *(const double *)context;
}

/// Every stage can be stopped.
static void stages_are_cancelled(void **state)
{
    (void)state;
    for (double limit = 0; limit < 0.5; limit += 0.07)
    {
        patch made = patch_scatter(patch_waves, 30, 1500, 0, 2);
        made.cloud.boundary_count = 0;
        made.cloud.has_corners = false;
        bat_surface_reconstruct_options options = bat_surface_reconstruct_defaults();
        options.fit.progress = (bat_progress){stop_when, &limit};
        bat_surface_result result = {0};
        check_status(bat_surface_reconstruct(&made.cloud, &options, &result, NULL), BAT_CANCELLED);
        assert_null(result.surface.space);
        patch_free(&made);
    }
}

/// The estimate of the noise is within a tenth of the truth.
static void noise_is_estimated(void **state)
{
    (void)state;
    for (double noise = 1e-4; noise < 0.02; noise *= 10)
    {
        double found;
        patch made = patch_scatter(patch_waves, 30, 3000, noise, 14);
        check_status(bat_cloud_noise(&made.cloud, &found, NULL), BAT_OK);
        assert_true(found > 0.8 * noise && found < 1.3 * noise + 1e-4);
        patch_free(&made);
    }
}

/// Points of a thin coil: neighbourhoods that are large enough for the noise have points from all sides of it.
static void noise_of_thin_parts_is_estimated(void **state)
{
    (void)state;
    enum
    {
        AROUND = 20,
        COUNT = 240 * AROUND
    };
    const double pi = 3.14159265358979323846, radius = 0.05, coil = 0.2, noise = 0.006;
    double *points = malloc(3 * COUNT * sizeof *points), found;
    bat_random random = bat_random_seed(4);
    for (size_t i = 0; i < COUNT; i++)
    {
        double around = 2 * pi * (double)i / AROUND, along = 6 * pi * (double)i / COUNT;
        points[3 * i] = (coil + radius * cos(around)) * cos(along) + noise * bat_random_normal(&random);
        points[3 * i + 1] = (coil + radius * cos(around)) * sin(along) + noise * bat_random_normal(&random);
        points[3 * i + 2] = radius * sin(around) + 0.04 * along + noise * bat_random_normal(&random);
    }
    bat_cloud cloud = {.points = points, .count = COUNT};
    check_status(bat_cloud_noise(&cloud, &found, NULL), BAT_OK);
    assert_true(found > noise / 2 && found < 2 * noise);
    free(points);
}

/// Where points are sparse, the surface may be far from them: a grid that is ten times as dense in its middle as at its
/// edge.
static void sparse_points_are_no_fault(void **state)
{
    (void)state;
    enum
    {
        SIDE = 30
    };
    bat_cloud cloud = {0};
    double parameters[2 * SIDE * SIDE];
    for (size_t i = 0; i < SIDE * SIDE; i++)
    {
        double *at = parameters + 2 * i, place[3];
        const double across[2] = {2 * (double)(i % SIDE) / (SIDE - 1) - 1, 2 * (double)(i / SIDE) / (SIDE - 1) - 1};
        for (size_t d = 0; d < 2; d++)
            at[d] = 0.5 + 0.5 * across[d] * fabs(across[d]) * fabs(across[d]);
        patch_waves(at[0], at[1], place);
        add_point(&cloud, place[0], place[1], place[2]);
    }
    bat_surface_reconstruct_options options = options_for(BAT_SURFACE_PARAMETERS_GIVEN, 200);
    options.given = parameters;
    bat_surface_result result = must_reconstruct(&cloud, &options);
    assert_true(result.verdict.farthest > 0.06 && result.verdict.spacing < 0.03);
    assert_int_equal(result.verdict.fault, BAT_SURFACE_FAULT_NONE);
    bat_surface_result_free(&result);
    bat_cloud_free(&cloud);
}

/// A tolerance below the noise ends with a small surface and says so.
static void a_tolerance_below_the_noise_is_told(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_waves, 20, 1500, 0.01, 15);
    bat_surface_reconstruct_options options = options_for(BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING, 0);
    options.fit.tolerance = 0.002;
    bat_surface_result result = must_reconstruct(&made.cloud, &options);
    assert_true(result.below_noise && !result.report.reached);
    assert_true(last_round(&result)->functions < made.cloud.count / 4);
    assert_true(result.noise > 0.008 && result.noise < 0.013);
    bat_surface_result_free(&result);
    // The tail of the noise stays outside; larger tolerances need fewer functions.
    static const double tolerances[] = {0.022, 0.035, 0.1};
    size_t functions = SIZE_MAX;
    for (size_t k = 0; k < sizeof tolerances / sizeof *tolerances; k++)
    {
        options.fit.tolerance = tolerances[k];
        result = must_reconstruct(&made.cloud, &options);
        assert_true(!result.below_noise && result.report.reached);
        assert_true(last_round(&result)->within > 0.93 && last_round(&result)->functions <= functions);
        functions = last_round(&result)->functions;
        bat_surface_result_free(&result);
    }
    patch_free(&made);
}

/// A noise that is told contradicts its estimate beyond three times, either way.
static void a_noise_that_contradicts_is_told(void **state)
{
    (void)state;
    bat_surface_fit_options fit = bat_surface_fit_defaults();
    fit.noise = 1;
    assert_false(bat_surface_noise_contradicts(&fit, 0.001));
    fit.smoothing = BAT_SURFACE_SMOOTHING_NOISE;
    assert_true(bat_surface_noise_contradicts(&fit, 0.3) && bat_surface_noise_contradicts(&fit, 3.1));
    assert_false(bat_surface_noise_contradicts(&fit, 0.34) || bat_surface_noise_contradicts(&fit, 2.9));
}

/// A right surface is doubted where the points are sparse along its outline, not where they are even.
static void sparse_outlines_are_doubted(void **state)
{
    (void)state;
    for (int sparse = 0; sparse < 2; sparse++)
    {
        bat_random random = bat_random_seed(8);
        bat_cloud cloud = {0};
        while (cloud.count < 2500)
        {
            double u = bat_random_uniform(&random), v = bat_random_uniform(&random), place[3];
            if (sparse && fmax(fabs(u - 0.5), fabs(v - 0.5)) > 0.36 && bat_random_uniform(&random) > 0.2)
                continue;
            patch_waves(u, v, place);
            add_point(&cloud, place[0], place[1], place[2]);
        }
        bat_surface_result result = must_reconstruct(&cloud, NULL);
        assert_int_equal(result.verdict.doubt, sparse ? BAT_SURFACE_DOUBT_RIM : BAT_SURFACE_DOUBT_NONE);
        assert_true(!sparse || result.verdict.doubt_size > 0.03);
        bat_surface_result_free(&result);
        bat_cloud_free(&cloud);
    }
}

/// Few points fit a surface whatever it is between them.
static void few_points_are_doubted(void **state)
{
    (void)state;
    for (size_t side = 7; side <= 8; side++)
    {
        bat_cloud cloud = {0};
        for (size_t i = 0; i < side * side; i++)
        {
            double place[3];
            patch_waves((double)(i % side) / (double)side, (double)(i / side) / (double)side, place);
            add_point(&cloud, place[0], place[1], 0.1 * place[2]);
        }
        bat_surface_result result = must_reconstruct(&cloud, NULL);
        assert_int_equal(result.verdict.fault, BAT_SURFACE_FAULT_NONE);
        assert_int_equal(result.verdict.doubt, side == 7 ? BAT_SURFACE_DOUBT_FEW : BAT_SURFACE_DOUBT_NONE);
        bat_surface_result_free(&result);
        bat_cloud_free(&cloud);
    }
}

/// A surface that covers a slot or a notch is doubted: a trimmed surface of the same points has a hole, or is smaller.
static void covered_gaps_are_doubted(void **state)
{
    (void)state;
    const bat_surface_doubt expected[] = {BAT_SURFACE_DOUBT_NONE, BAT_SURFACE_DOUBT_GAP, BAT_SURFACE_DOUBT_GAP,
                                          BAT_SURFACE_DOUBT_AREA};
    for (int kind = 0; kind < 4; kind++)
    {
        bat_random random = bat_random_seed(9);
        bat_cloud cloud = {0};
        while (cloud.count < 2000)
        {
            double u = bat_random_uniform(&random), v = bat_random_uniform(&random), place[3];
            bool slot = kind == 1 && fabs(u - 0.5) < 0.2 && fabs(v - 0.5) < 0.04;
            bool notch = kind >= 2 && fabs(u - 0.5) < (kind == 2 ? 0.04 : 0.027) && v > (kind == 2 ? 0.4 : 0.1);
            patch_waves(u, v, place);
            if (!slot && !notch)
                add_point(&cloud, place[0], place[1], place[2]);
        }
        bat_surface_result result = must_reconstruct(&cloud, NULL);
        assert_int_equal(result.verdict.fault, BAT_SURFACE_FAULT_NONE);
        assert_int_equal(result.verdict.doubt, expected[kind]);
        assert_int_equal(result.gap_count, kind == 1);
        bat_surface_result_free(&result);
        bat_cloud_free(&cloud);
    }
}

/// One point far off bends a fit by least squares, whose verdict tells it; robust weights leave it out.
static void strays_are_doubted(void **state)
{
    (void)state;
    for (int robust = 0; robust < 2; robust++)
    {
        patch made = patch_scatter(patch_waves, 4, 400, 0, 4);
        add_point(&made.cloud, 0.5, 0.5, 1);
        made.cloud.boundary_count = 0;
        made.cloud.has_corners = false;
        bat_surface_reconstruct_options options = bat_surface_reconstruct_defaults();
        options.fit.robust = robust == 1;
        bat_surface_result result = must_reconstruct(&made.cloud, &options);
        assert_int_equal(result.verdict.doubt, robust ? BAT_SURFACE_DOUBT_NONE : BAT_SURFACE_DOUBT_STRAY);
        if (robust == 0)
            assert_true(result.verdict.doubt_size > 0.8 && result.verdict.doubt_place[2] == 1);
        bat_surface_result_free(&result);
        patch_free(&made);
    }
}

static bool stop_at_once(void *context, double fraction)
{
    (void)fraction;
    ++*(int *)context;
    return false;
}

static void what_is_wrong_is_refused(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_waves, 10, 100, 0, 6);
    bat_surface_result result;
    bat_error error;
    bat_surface_reconstruct_options options = options_for(BAT_SURFACE_PARAMETERS_GIVEN, 0);
    check_status(bat_surface_reconstruct(&made.cloud, &options, &result, &error), BAT_INVALID_ARGUMENT);
    options = options_for((bat_surface_parameters)99, 0);
    check_status(bat_surface_reconstruct(&made.cloud, &options, &result, &error), BAT_INVALID_ARGUMENT);
    options = options_for(BAT_SURFACE_PARAMETERS_UNIFORM, 8);
    check_status(bat_surface_reconstruct(&made.cloud, &options, &result, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "functions is 8, but must be 0 or at least the 16"));
    options = options_for(BAT_SURFACE_PARAMETERS_MEAN_VALUE, 0);
    check_status(bat_surface_reconstruct(&made.cloud, &options, &result, &error), BAT_UNSUPPORTED);
    options = options_for(BAT_SURFACE_PARAMETERS_UNIFORM, 0);
    options.fit.tolerance = -1;
    check_status(bat_surface_reconstruct(&made.cloud, &options, &result, &error), BAT_INVALID_ARGUMENT);
    options.fit.tolerance = 0;
    int asked = 0;
    options.fit.progress = (bat_progress){stop_at_once, &asked};
    check_status(bat_surface_reconstruct(&made.cloud, &options, &result, &error), BAT_CANCELLED);
    assert_int_equal(asked, 1);
    bat_cloud three = made.cloud;
    three.count = 3;
    three.boundary_count = 0;
    three.has_corners = false;
    check_status(bat_surface_reconstruct(&three, &options, &result, &error), BAT_INVALID_ARGUMENT);
    patch_free(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_and_defaults),
        cmocka_unit_test(bezier_surfaces_come_back),
        cmocka_unit_test(given_parameters_need_no_boundary),
        cmocka_unit_test(auto_takes_the_best_by_measure),
        cmocka_unit_test(what_strays_is_out),
        cmocka_unit_test(auto_is_its_choice),
        cmocka_unit_test(unknown_boundaries_are_found),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(large_clouds_are_tried_in_part),
        cmocka_unit_test(the_order_of_points_does_not_matter),
        cmocka_unit_test(wrong_surfaces_are_refused),
        cmocka_unit_test(one_sided_surfaces_are_told),
        cmocka_unit_test(scan_lines_are_fitted),
        cmocka_unit_test(stages_are_cancelled),
        cmocka_unit_test(noise_is_estimated),
        cmocka_unit_test(noise_of_thin_parts_is_estimated),
        cmocka_unit_test(sparse_points_are_no_fault),
        cmocka_unit_test(a_tolerance_below_the_noise_is_told),
        cmocka_unit_test(a_noise_that_contradicts_is_told),
        cmocka_unit_test(sparse_outlines_are_doubted),
        cmocka_unit_test(few_points_are_doubted),
        cmocka_unit_test(covered_gaps_are_doubted),
        cmocka_unit_test(strays_are_doubted),
        cmocka_unit_test(what_is_wrong_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
