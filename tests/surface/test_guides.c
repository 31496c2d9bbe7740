// Guides of a surface: places on triangles, and what they change in a fit.

#include "surface_fit_helpers.h"

#include "surface/candidate.h"

/// A bent sheet.
static void sheet(double u, double v, double *point)
{
    point[0] = u;
    point[1] = v;
    point[2] = 0.3 * (u * u - v);
}

static void guides_lie_on_triangles(void **state)
{
    (void)state;
    // Two triangles whose parameters are half as large, and turned.
    double points[] = {0, 0, 1, 1, 0, 2, 1, 1, 3, 0, 1, 5}, parameters[] = {0, 0, 0, 0.5, 0.5, 0.5, 0.5, 0};
    uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    bat_cloud cloud = {.points = points, .count = 4, .triangles = triangles, .triangle_count = 2};
    virtual_points guides;
    assert_int_equal(virtual_points_make(&cloud, parameters, &guides, NULL), BAT_OK);
    // Two centres, and the node (1/4, 1/4) of a grid of 2 x 2: the others lie outside.
    assert_int_equal(guides.count, 3);
    size_t nodes = 0;
    for (size_t i = 0; i < guides.count; i++)
    {
        const double *place = guides.places + 3 * i, *at = guides.parameters + 2 * i;
        // x = 2 v, y = 2 u, and z is linear on each triangle.
        check_near(place[0], 2 * at[1], 1e-15);
        check_near(place[1], 2 * at[0], 1e-15);
        double z = place[0] >= place[1] ? 1 + place[0] + place[1] : 1 + 4 * place[1] - 2 * place[0];
        check_near(place[2], z, 1e-15);
        nodes += at[0] == 0.25 && at[1] == 0.25;
    }
    assert_int_equal(nodes, 1);
    virtual_points_free(&guides);
}

/// The largest distance in the middle of the square between a surface and the sheet.
static double distance_in_middle(const bat_spline_surface *surface)
{
    double largest = 0;
    for (size_t i = 0; i <= 10; i++)
        for (size_t j = 0; j <= 10; j++)
        {
            double at[2] = {0.4 + 0.02 * (double)i, 0.4 + 0.02 * (double)j}, place[3], truth[3];
            assert_int_equal(bat_spline_surface_evaluate(surface, at, 1, 0, place, NULL), BAT_OK);
            sheet(at[0], at[1], truth);
            largest = fmax(largest, sqrt((place[0] - truth[0]) * (place[0] - truth[0]) +
                                         (place[1] - truth[1]) * (place[1] - truth[1]) +
                                         (place[2] - truth[2]) * (place[2] - truth[2])));
        }
    return largest;
}

/// Points of the sheet except around the middle, where a bump of other points draws the surface away.
static void guides_hold_a_surface_without_points(void **state)
{
    (void)state;
    surface_sample sample = sample_make(sheet, 2000, 80, 0, 5);
    size_t kept = 80;
    for (size_t i = 80; i < sample.data.count; i++)
    {
        const double *at = sample.data.parameters + 2 * i;
        if (at[0] > 0.25 && at[0] < 0.75 && at[1] > 0.25 && at[1] < 0.75)
            continue;
        memmove(sample.points + 3 * kept, sample.points + 3 * i, 3 * sizeof *sample.points);
        memmove(sample.data.parameters + 2 * kept, at, 2 * sizeof *at);
        // Steep edges of the hole.
        double *point = sample.points + 3 * kept, *now = sample.data.parameters + 2 * kept;
        point[2] += 0.2 * exp(-40 * fabs(fmax(fabs(now[0] - 0.5), fabs(now[1] - 0.5)) - 0.25));
        kept++;
    }
    sample.data.count = kept;
    double places[3 * 400], at[2 * 400], far[2];
    for (size_t i = 0; i < 400; i++)
    {
        at[2 * i] = 0.27 + 0.46 * ((double)(i % 20) + 0.5) / 20;
        at[2 * i + 1] = 0.27 + 0.46 * ((double)(i / 20) + 0.5) / 20;
        sheet(at[2 * i], at[2 * i + 1], places + 3 * i);
    }
    bat_surface_fit_options options = bat_surface_fit_defaults();
    options.functions = 400;
    options.corrections = 0;
    options.final_corrections = 0;
    for (int k = 0; k < 2; k++)
    {
        bat_spline_surface surface;
        bat_surface_fit_report report;
        if (k == 1)
        {
            sample.data.guides = places;
            sample.data.guide_parameters = at;
            sample.data.guide_count = 400;
        }
        assert_int_equal(bat_surface_fit(&sample.data, &options, &surface, &report, NULL), BAT_OK);
        // Guides are not counted.
        assert_true(report.rounds[report.count - 1].worst < kept);
        far[k] = distance_in_middle(&surface);
        bat_spline_surface_free(&surface);
        bat_surface_fit_report_free(&report);
    }
    assert_true(far[0] > 0.05);
    assert_true(far[1] < 0.1 * far[0]);
    bat_error error = {0};
    at[7] = 1.5;
    assert_int_equal(bat_surface_fit(&sample.data, &options, &(bat_spline_surface){0}, NULL, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 3);
    at[7] = 0.5;
    places[31] = NAN;
    assert_int_equal(bat_surface_fit(&sample.data, &options, &(bat_spline_surface){0}, NULL, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 10);
    sample_free(&sample);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(guides_lie_on_triangles),
                                       cmocka_unit_test(guides_hold_a_surface_without_points)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
