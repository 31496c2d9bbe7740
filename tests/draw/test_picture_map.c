// Maps: projections and their choice, scale bars and graticules, polygons filled, borders drawn once.

#include "picture_helpers.h"

#include "draw/common/style.h"
#include "draw/curve/scene.h"
#include "draw/curve/view.h"

#include "batten/space.h"

static const double DEGREE = 3.14159265358979323846 / 180.0;

/// The determinant of a projection's derivative at a place over that of the sphere, by central differences.
static double area_factor(void (*project)(double, double, double *, double *), double longitude, double latitude)
{
    const double step = 1e-4;
    double places[4][2];
    project(longitude + step, latitude, &places[0][0], &places[0][1]);
    project(longitude - step, latitude, &places[1][0], &places[1][1]);
    project(longitude, latitude + step, &places[2][0], &places[2][1]);
    project(longitude, latitude - step, &places[3][0], &places[3][1]);
    double a = (places[0][0] - places[1][0]) / (2.0 * step);
    double b = (places[0][1] - places[1][1]) / (2.0 * step);
    double c = (places[2][0] - places[3][0]) / (2.0 * step);
    double d = (places[2][1] - places[3][1]) / (2.0 * step);
    return (a * d - b * c) / cos(latitude);
}

static void local_about_oslo(double longitude, double latitude, double *u, double *v)
{
    draw_view view = {.kind = VIEW_LOCAL, .space = VIEW_SPHERE, .point_dim = 3};
    double point[3];
    view_set_globe(&view, 10.75 * DEGREE, 59.9 * DEGREE);
    set_direction(point, longitude, latitude);
    view_project(&view, point, u, v);
}

/// Both projections keep areas everywhere. Equal Earth has the extent that its paper gives, 2.05458 times as wide as high.
static void projections_keep_areas(void **state)
{
    (void)state;
    for (int longitude = -170; longitude <= 170; longitude += 20)
    {
        for (int latitude = -85; latitude <= 85; latitude += 10)
        {
            check_near(area_factor(view_equal_earth, longitude * DEGREE, latitude * DEGREE), 1.0, 1e-5);
            check_near(area_factor(local_about_oslo, longitude * DEGREE, latitude * DEGREE), 1.0, 1e-5);
        }
    }
    double u;
    double v;
    view_equal_earth(PI, 0.0, &u, &v);
    assert_true(u == EQUAL_EARTH_HALF_WIDTH && v == 0.0);
    view_equal_earth(0.0, 0.5 * PI, &u, &v);
    check_near(v, EQUAL_EARTH_HALF_HEIGHT, 1e-15);
    check_near(EQUAL_EARTH_HALF_WIDTH / EQUAL_EARTH_HALF_HEIGHT, 2.05458, 1e-5);
}

/// From the centre of a local view, north is upwards, distances are 2 sin(angle / 2) and short ones true, of 10 m to 1e-8.
static void local_view_is_true_at_its_centre(void **state)
{
    (void)state;
    double u;
    double v;
    local_about_oslo(10.75 * DEGREE, 89.9 * DEGREE, &u, &v);
    check_near(u, 0.0, 1e-15);
    check_near(v, 2.0 * sin(15.0 * DEGREE), 1e-14);
    double small = 10.0 / BAT_EARTH_RADIUS;
    local_about_oslo(10.75 * DEGREE, 59.9 * DEGREE + small, &u, &v);
    assert_true(fabs(v / small - 1.0) < 1e-8);
    view_equal_area((double[3]){0.0, 0.0, -1.0}, &u, &v);
    assert_true(u == 2.0 && v == 0.0);
    double angle = PI - 1e-7;
    view_equal_area((double[3]){0.0, sin(angle), cos(angle)}, &u, &v);
    check_near(v, 2.0, 1e-13);
}

/// A circle on the sphere.
static bat_curve make_circle(const double *centre, double radius, size_t count, bool clockwise)
{
    draw_view view = {.kind = VIEW_GLOBE};
    bat_curve circle = make_curve(&sphere, count, true);
    view_set_globe(&view, atan2(centre[1], centre[0]), atan2(centre[2], hypot(centre[0], centre[1])));
    for (size_t i = 0; i < count; i++)
    {
        double turn = (clockwise ? -2.0 : 2.0) * PI * (double)i / (double)count;
        double rotated[3] = {sin(radius) * cos(turn), sin(radius) * sin(turn), cos(radius)};
        for (int k = 0; k < 3; k++)
        {
            circle.points[3 * i + (size_t)k] =
                view.rotation[0][k] * rotated[0] + view.rotation[1][k] * rotated[1] + view.rotation[2][k] * rotated[2];
        }
    }
    return circle;
}

static bat_curve_projection taken_for(const bat_curve *curve, size_t polygon, const bat_curve_picture_options *options)
{
    bat_curve_picture_layer layer = {.curve = curve, .polygon = polygon};
    bat_curve_picture_panel panel = {.layers = &layer, .layer_count = 1};
    bat_curve_projection taken = BAT_CURVE_PROJECTION_BOTH;
    assert_int_equal(bat_curve_picture_projection(&panel, 1, options, &taken, NULL), BAT_OK);
    return taken;
}

static void projection_fits_the_extent(void **state)
{
    (void)state;
    const struct
    {
        double radius; ///< in degrees
        bat_curve_projection line, polygon;
    } cases[] = {{1e-5, BAT_CURVE_PROJECTION_LOCAL, BAT_CURVE_PROJECTION_LOCAL},
                 {29.0, BAT_CURVE_PROJECTION_LOCAL, BAT_CURVE_PROJECTION_LOCAL},
                 {32.0, BAT_CURVE_PROJECTION_GLOBE, BAT_CURVE_PROJECTION_LOCAL},
                 {79.0, BAT_CURVE_PROJECTION_GLOBE, BAT_CURVE_PROJECTION_LOCAL},
                 {82.0, BAT_CURVE_PROJECTION_GLOBE, BAT_CURVE_PROJECTION_MAP},
                 {90.0, BAT_CURVE_PROJECTION_GLOBE, BAT_CURVE_PROJECTION_MAP}};
    const double centres[][3] = {{1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, -1.0}, {0.6, -0.48, 0.64}};
    for (size_t i = 0; i < 6; i++)
    {
        for (size_t k = 0; k < 4; k++)
        {
            bat_curve circle = make_circle(centres[k], cases[i].radius * DEGREE, 60, false);
            assert_int_equal(taken_for(&circle, 0, NULL), cases[i].line);
            assert_int_equal(taken_for(&circle, 1, NULL), cases[i].polygon);
            free(circle.points);
        }
    }
    bat_curve_picture_options options = bat_curve_picture_defaults();
    bat_curve circle = make_circle(centres[0], 0.1, 60, false);
    options.projection = BAT_CURVE_PROJECTION_GLOBE;
    assert_int_equal(taken_for(&circle, 1, &options), BAT_CURVE_PROJECTION_GLOBE);
    free(circle.points);
    bat_curve flat = make_sample(&plane, 20);
    assert_int_equal(taken_for(&flat, 1, NULL), BAT_CURVE_PROJECTION_AUTO);
    free(flat.points);
    bat_curve_projection taken;
    assert_int_equal(bat_curve_picture_projection(NULL, 0, NULL, &taken, NULL), BAT_INVALID_ARGUMENT);
}

/// The window of a local map holds the curve, with a margin of 4 % of its larger side, also across the antimeridian and over
/// a pole.
static void window_holds_the_curve(void **state)
{
    (void)state;
    const double centres[][3] = {{-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.6, -0.48, 0.64}};
    const double radii[] = {1e-6, 1e-3, 0.1, 1.0};
    for (size_t i = 0; i < 12; i++)
    {
        double radius = radii[i % 4];
        bat_curve circle = make_circle(centres[i / 4], radius, 200, false);
        const bat_curve *curves[] = {&circle};
        bat_curve_picture_options options = bat_curve_picture_defaults();
        map_choice choice = map_choose(curves, 1, true, &options);
        assert_int_equal(choice.projection, BAT_CURVE_PROJECTION_LOCAL);
        double across = 4.0 * sin(0.5 * radius);
        for (int k = 0; k < 2; k++)
        {
            double middle = 0.5 * (choice.low[k] + choice.high[k]);
            assert_true(fabs((choice.high[k] - choice.low[k]) / (1.08 * across) - 1.0) < 2e-3);
            assert_true(fabs(middle) < 0.01 * across);
        }
        free(circle.points);
    }
}

/// Greenwich is in the middle of a map, unless curves lie across its edge and elsewhere is room.
static void map_is_cut_where_nothing_lies(void **state)
{
    (void)state;
    bat_curve_picture_options options = bat_curve_picture_defaults();
    options.projection = BAT_CURVE_PROJECTION_MAP;
    bat_curve pacific = make_curve(&sphere, 3, false);
    const double longitudes[3] = {100.0, 180.0, -100.0};
    for (size_t i = 0; i < 3; i++)
    {
        set_direction(pacific.points + 3 * i, longitudes[i] * DEGREE, 0.0);
    }
    const bat_curve *curves[] = {&pacific};
    map_choice choice = map_choose(curves, 1, false, &options);
    check_near(fabs(choice.meridian), PI, 1.5 * DEGREE);
    pacific.count = 2;
    set_direction(pacific.points + 3, 170.0 * DEGREE, 0.0);
    choice = map_choose(curves, 1, false, &options);
    assert_true(choice.meridian == 0.0);
    options.longitude = 1.0;
    choice = map_choose(curves, 1, false, &options);
    assert_true(choice.meridian == 1.0);
    free(pacific.points);
}

static void scale_bars_are_round(void **state)
{
    (void)state;
    assert_true(grid_scale_length(2.0) == 0.5);
    assert_true(grid_scale_length(10.0) == 2.0);
    assert_true(grid_scale_length(2000.0) == 500.0);
    for (double width = 1e-2; width < 2e7; width *= 1.37)
    {
        double length = grid_scale_length(width);
        double lead = length / pow(10.0, floor(log10(length) + 1e-9));
        assert_true(length <= 0.25 * width && length > 0.0999 * width);
        assert_true(fabs(lead - 1.0) < 1e-9 || fabs(lead - 2.0) < 1e-9 || fabs(lead - 5.0) < 1e-9);
    }
}

/// A scale bar on the page is as long as it says: the horizontal extent of the drawn line.
static void scale_bar_has_its_length(void **state)
{
    (void)state;
    cairo_surface_t *paper = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 500, 40);
    cairo_t *cairo = cairo_create(paper);
    cairo_set_source_rgb(cairo, 1.0, 1.0, 1.0);
    cairo_paint(cairo);
    grid_scale_bar(cairo, 20.0, 20.5, 400.0, 3.2e6, "m"); // 500 km are 62.5 points
    cairo_surface_flush(paper);
    const unsigned char *row = cairo_image_surface_get_data(paper) + 20 * cairo_image_surface_get_stride(paper);
    int end = 20;
    while (row[4 * end] < 200)
    {
        end++;
    }
    assert_true(row[4 * 18] == 255 && end >= 82 && end <= 84);
    cairo_destroy(cairo);
    cairo_surface_destroy(paper);
}

static void graticules_are_round(void **state)
{
    (void)state;
    assert_true(grid_step(90.0 * 3600.0) == 30.0 * 3600.0);
    assert_true(grid_step(5.0 * 3600.0) == 3600.0);
    assert_true(grid_step(2.0 * 3600.0) == 30.0 * 60.0);
    assert_true(grid_step(65.0) == 20.0);
    check_near(grid_step(0.35), 0.1, 1e-15);
    char label[48];
    grid_angle_label(-12.0 * 3600.0, 3600.0, "N", "S", label, sizeof label);
    assert_string_equal(label, "12\u00b0S");
    grid_angle_label(64.5 * 3600.0, 1800.0, "N", "S", label, sizeof label);
    assert_string_equal(label, "64\u00b030\u2032N");
    grid_angle_label(7.0 * 3600.0 + 27.0 * 60.0 + 0.3, 0.1, "E", "W", label, sizeof label);
    assert_string_equal(label, "7\u00b027\u203200.3\u2033E");
    grid_angle_label(46.0 * 3600.0 - 20.0, 20.0, "N", "S", label, sizeof label);
    assert_string_equal(label, "45\u00b059\u203240\u2033N");
    grid_angle_label(-180.0 * 3600.0, 3600.0, "E", "W", label, sizeof label);
    assert_string_equal(label, "180\u00b0");
}

enum
{
    SIDE = 600
};

static double angle_to(const double *p, const double *q)
{
    return acos(fmax(-1.0, fmin(1.0, p[0] * q[0] + p[1] * q[1] + p[2] * q[2])));
}

/// Fill a polygon with black and compare the pixels of random places with what lies in it: a cap, without a smaller one.
static void check_fill(draw_view *view, const double *centre, const double radii[2], bool clockwise, bat_random *random)
{
    cairo_surface_t *paper = cairo_image_surface_create(CAIRO_FORMAT_A8, SIDE, SIDE);
    cairo_t *cairo = cairo_create(paper);
    bat_curve outer = make_circle(centre, radii[0], 90, clockwise);
    bat_curve hole = make_circle(centre, radii[1], 50, random->state[0] % 2 == 0);
    const bat_curve *rings[] = {&outer, &hole};
    view->scale = SIDE / 5.6;
    view->origin_x = view->origin_y = 0.5 * SIDE;
    view->tolerance = 0.1;
    cairo_set_fill_rule(cairo, CAIRO_FILL_RULE_EVEN_ODD);
    (void)view_trace_polygon(view, rings, 2, cairo);
    cairo_fill(cairo);
    cairo_surface_flush(paper);
    const unsigned char *pixels = cairo_image_surface_get_data(paper);
    int stride = cairo_image_surface_get_stride(paper);
    for (int i = 0; i < 400; i++)
    {
        double point[3];
        double x;
        double y;
        set_direction(point, PI * (2.0 * bat_random_uniform(random) - 1.0), asin(2.0 * bat_random_uniform(random) - 1.0));
        double angle = angle_to(point, centre);
        bool front = view_place(view, point, &x, &y);
        // A pixel is longer away from the centre: by 1 / cos(angle) on the globe, by 1 / cos(angle / 2) in a local view.
        double radius = view->kind == VIEW_GLOBE ? 1.0 : view->kind == VIEW_LOCAL ? 2.0 : INFINITY;
        double away = hypot(x - view->origin_x, y - view->origin_y) / (view->scale * radius);
        double allowed = 0.06 / sqrt(fmax(1e-9, 1.0 - away * away));
        bool near = fabs(angle - radii[0]) < allowed || fabs(angle - radii[1]) < allowed;
        bool edge = away > 0.99;
        double from_poles = fabs(point[2]);
        if (near || !front || edge || (view->kind == VIEW_MAP && from_poles > 0.995))
            continue;
        bool inside = angle < radii[0] && angle > radii[1];
        unsigned char shade = pixels[(int)y * stride + (int)x];
        if ((shade > 128) != inside)
            fail_msg("view %d: a point %g from the centre of a ring from %g to %g is %s", (int)view->kind, angle, radii[1],
                     radii[0], inside ? "empty" : "filled");
    }
    cairo_destroy(cairo);
    cairo_surface_destroy(paper);
    free(outer.points);
    free(hole.points);
}

/// Rings with holes are filled right wherever they lie: over poles, across the edge of a map, behind the globe, around the
/// antipode of a local view, in both orientations.
static void polygons_are_filled_everywhere(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(14);
    const view_kind kinds[] = {VIEW_GLOBE, VIEW_LOCAL, VIEW_MAP};
    for (int trial = 0; trial < 240; trial++)
    {
        draw_view view = {.kind = kinds[trial % 3], .space = VIEW_SPHERE, .point_dim = 3};
        double longitude = trial < 60 ? 0.0 : PI * (2.0 * bat_random_uniform(&random) - 1.0);
        if (view.kind == VIEW_MAP)
            view_set_map(&view, longitude);
        else
            view_set_globe(&view, longitude, trial < 60 ? 0.0 : asin(2.0 * bat_random_uniform(&random) - 1.0));
        double centre[3];
        set_direction(centre, PI * (2.0 * bat_random_uniform(&random) - 1.0), asin(2.0 * bat_random_uniform(&random) - 1.0));
        if (trial % 5 == 0) // the poles themselves
            set_direction(centre, 0.3, trial % 2 == 0 ? 0.5 * PI : -0.5 * PI);
        double radius = 0.2 + 1.2 * bat_random_uniform(&random);
        check_fill(&view, centre, (double[2]){radius, radius * (0.1 + 0.7 * bat_random_uniform(&random))}, trial % 4 < 2,
                   &random);
    }
}

/// Closed over the south pole along the antimeridian, as plate carrée files have it, and open there: the same region.
static void polygons_closed_over_a_pole_are_filled(void **state)
{
    (void)state;
    bat_curve cap = make_curve(&sphere, 39, true);
    for (size_t i = 0; i < 37; i++)
    {
        set_direction(cap.points + 3 * i, (180.0 - 10.0 * (double)i) * DEGREE, -70.0 * DEGREE);
    }
    set_direction(cap.points + 3 * (size_t)37, -180.0 * DEGREE, -90.0 * DEGREE);
    set_direction(cap.points + 3 * (size_t)38, 180.0 * DEGREE, -80.0 * DEGREE);
    const bat_curve *rings[] = {&cap};
    const view_kind kinds[] = {VIEW_LOCAL, VIEW_MAP};
    for (int k = 0; k < 2; k++)
    {
        draw_view view = {.kind = kinds[k],
                          .space = VIEW_SPHERE,
                          .point_dim = 3,
                          .scale = SIDE / 5.6,
                          .origin_x = 0.5 * SIDE,
                          .origin_y = 0.5 * SIDE,
                          .tolerance = 0.1};
        if (kinds[k] == VIEW_MAP)
            view_set_map(&view, 0.4);
        else
            view_set_globe(&view, 0.4, -0.5);
        cairo_surface_t *paper = cairo_image_surface_create(CAIRO_FORMAT_A8, SIDE, SIDE);
        cairo_t *cairo = cairo_create(paper);
        cairo_set_fill_rule(cairo, CAIRO_FILL_RULE_EVEN_ODD);
        (void)view_trace_polygon(&view, rings, 1, cairo);
        cairo_fill(cairo);
        cairo_surface_flush(paper);
        const unsigned char *pixels = cairo_image_surface_get_data(paper);
        for (int i = -17; i < 18; i++)
        {
            double point[3];
            double x;
            double y;
            for (int latitude = -85; latitude <= 85; latitude += 10)
            {
                set_direction(point, (10.0 * i + 3.0) * DEGREE, latitude * DEGREE);
                view_place(&view, point, &x, &y);
                bool filled = pixels[(int)y * cairo_image_surface_get_stride(paper) + (int)x] > 128;
                assert_int_equal(filled, latitude < -70);
            }
        }
        cairo_destroy(cairo);
        cairo_surface_destroy(paper);
    }
    free(cap.points);
}

/// A square of 4 `steps` edges with its lower left corner at whole degrees.
static bat_curve make_square(int longitude, int latitude, int steps)
{
    bat_curve square = make_curve(&sphere, (size_t)(4 * steps), true);
    for (int i = 0; i < 4 * steps; i++)
    {
        int along = i % steps;
        int side = i / steps;
        int x = side == 0 ? along : side == 1 ? steps : side == 2 ? steps - along : 0;
        int y = side == 0 ? 0 : side == 1 ? along : side == 2 ? steps : steps - along;
        set_direction(square.points + (size_t)(3 * i), (longitude + x) * DEGREE, (latitude + y) * DEGREE);
    }
    return square;
}

/// Nine squares in a block: shared edges are drawn once, neighbours have different colours, squares of one feature the same.
static void borders_are_drawn_once(void **state)
{
    (void)state;
    enum
    {
        STEPS = 8
    };
    bat_curve squares[9];
    bat_curve_picture_layer layers[9];
    for (int i = 0; i < 9; i++)
    {
        squares[i] = make_square(i % 3 * STEPS, i / 3 * STEPS, STEPS);
        layers[i] = (bat_curve_picture_layer){
            .curve = &squares[i], .polygon = (size_t)i + 1, .feature = i == 8 ? 0 : (size_t)(100 * i)};
    }
    bat_curve_picture_panel panel = {.layers = layers, .layer_count = 9};
    map_network network;
    assert_int_equal(map_network_make(&panel, &network, NULL), BAT_OK);
    size_t drawn = 0;
    for (size_t i = 0; i < network.starts[9]; i++)
    {
        drawn += network.drawn[i];
    }
    assert_int_equal(network.starts[9], 9 * 4 * STEPS);
    assert_int_equal(drawn, 24 * STEPS);
    for (int i = 0; i < 9; i++)
    {
        assert_true(i % 3 == 2 || network.colours[i] != network.colours[i + 1]);
        assert_true(i >= 6 || network.colours[i] != network.colours[i + 3]);
    }
    assert_int_equal(network.colours[8], network.colours[0]);
    memory_pool_free(&network.pool);
    for (int i = 0; i < 9; i++)
    {
        layers[i].polygon = 0;
        free(squares[i].points);
    }
}

/// The number of pixels of a PNG-like drawing of one panel that are near a colour.
static size_t count_pixels(const bat_curve_picture_panel *panel, const bat_curve_picture_options *options,
                           draw_colour colour)
{
    const double box[4] = {0.0, 0.0, SIDE, SIDE};
    scene made;
    assert_int_equal(scene_make(panel, 1, options, &made, NULL), BAT_OK);
    cairo_surface_t *paper = cairo_image_surface_create(CAIRO_FORMAT_RGB24, SIDE, SIDE);
    cairo_t *cairo = cairo_create(paper);
    cairo_set_source_rgb(cairo, 1.0, 1.0, 1.0);
    cairo_paint(cairo);
    assert_int_equal(panel_draw(cairo, &made.panels[0], options, box, NULL), BAT_OK);
    cairo_surface_flush(paper);
    const unsigned char *pixels = cairo_image_surface_get_data(paper);
    size_t count = 0;
    for (int y = 0; y < SIDE; y++)
    {
        const unsigned char *row = pixels + (ptrdiff_t)y * cairo_image_surface_get_stride(paper);
        for (int x = 0; x < SIDE; x++)
        {
            const unsigned char *pixel = row + (ptrdiff_t)4 * x; // blue, green, red
            count += fabs(pixel[2] / 255.0 - colour.red) < 0.006 && fabs(pixel[1] / 255.0 - colour.green) < 0.006 &&
                             fabs(pixel[0] / 255.0 - colour.blue) < 0.006
                         ? 1
                         : 0;
        }
    }
    cairo_destroy(cairo);
    cairo_surface_destroy(paper);
    scene_free(&made);
    return count;
}

/// On a map of the world a polygon over a pole or across the edge covers its share of the paper.
static void polygons_cover_their_share(void **state)
{
    (void)state;
    const double centres[][3] = {{0.0, 0.0, 1.0}, {0.0, 0.0, -1.0}, {-1.0, 0.0, 0.0}, {-0.6, 0.0, 0.8}};
    for (int i = 0; i < 4; i++)
    {
        bat_curve circle = make_circle(centres[i], 0.9, 200, i % 2 == 0);
        bat_curve_picture_layer layer = {.curve = &circle, .polygon = 1};
        bat_curve_picture_panel panel = {.layers = &layer, .layer_count = 1};
        bat_curve_picture_options options = bat_curve_picture_defaults();
        options.projection = BAT_CURVE_PROJECTION_MAP;
        options.longitude = 0.0;
        options.grid = false;
        double land = (double)count_pixels(&panel, &options, style_fill(0));
        double sea = (double)count_pixels(&panel, &options, COLOUR_SEA);
        double share = 0.5 * (1.0 - cos(0.9));
        if (fabs(land / (land + sea) / share - 1.0) > 0.06)
            fail_msg("polygon %d covers %g instead of %g", i, land / (land + sea), share);
        free(circle.points);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(projections_keep_areas),         cmocka_unit_test(local_view_is_true_at_its_centre),
        cmocka_unit_test(projection_fits_the_extent),     cmocka_unit_test(window_holds_the_curve),
        cmocka_unit_test(map_is_cut_where_nothing_lies),  cmocka_unit_test(scale_bars_are_round),
        cmocka_unit_test(scale_bar_has_its_length),       cmocka_unit_test(graticules_are_round),
        cmocka_unit_test(polygons_are_filled_everywhere), cmocka_unit_test(polygons_closed_over_a_pole_are_filled),
        cmocka_unit_test(borders_are_drawn_once),         cmocka_unit_test(polygons_cover_their_share),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
