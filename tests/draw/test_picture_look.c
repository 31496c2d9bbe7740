// Layout of pictures: nothing outside, nothing missing, no superfluous space.

#include "picture_helpers.h"

#include "draw/common/style.h"
#include "draw/curve/scene.h"

/// The box of a panel, and the tolerance for lines and letters.
static const double box[4] = {100.0, 50.0, 300.0, 200.0};
static const double slack = 4.0;

/// The bounding box (x, y, width, height) of one panel drawn into `box`.
static void coverage_extent(const bat_curve_picture_panel *panel, const bat_curve_picture_options *options, double extent[4])
{
    scene made;
    assert_int_equal(scene_make(panel, 1, options, &made, NULL), BAT_OK);
    cairo_surface_t *paper = cairo_recording_surface_create(CAIRO_CONTENT_COLOR_ALPHA, NULL);
    cairo_t *cairo = cairo_create(paper);
    assert_int_equal(panel_draw(cairo, &made.panels[0], options, box, NULL), BAT_OK);
    assert_int_equal(cairo_status(cairo), CAIRO_STATUS_SUCCESS);
    cairo_recording_surface_ink_extents(paper, &extent[0], &extent[1], &extent[2], &extent[3]);
    cairo_destroy(cairo);
    cairo_surface_destroy(paper);
    scene_free(&made);
}

static void check_inside(const double extent[4], double allowed)
{
    assert_true(extent[2] > 0.0 && extent[3] > 0.0);
    assert_true(extent[0] >= box[0] - allowed && extent[1] >= box[1] - allowed);
    assert_true(extent[0] + extent[2] <= box[0] + box[2] + allowed);
    assert_true(extent[1] + extent[3] <= box[1] + box[3] + allowed);
}

/// Scale and translate a curve of a flat space.
static void transform(bat_curve *curve, const double *stretch, const double *shift)
{
    size_t n = curve->space->point_dim;
    for (size_t i = 0; i < curve->count * n; i++)
    {
        curve->points[i] = curve->points[i] * stretch[i % n] + shift[i % n];
    }
}

static void nothing_leaves_its_box(void **state)
{
    (void)state;
    const bat_space *spaces[] = {&plane, &solid, &sphere, &disk};
    const double stretches[][3] = {{1, 1, 1},   {1e9, 1e9, 1e9}, {1e-6, 1e-6, 1e-6},
                                   {1e3, 1, 1}, {1, 1e3, 1},     {1e-2, 1e-2, 1}};
    const double shifts[][3] = {{0, 0, 0}, {1e6, 4.5e6, -1e6}, {-1e6, 0, 1e5}};
    for (int variant = 0; variant < 4 * 6 * 3 * 4; variant++)
    {
        const bat_space *space = spaces[variant % 4];
        bool flat = variant % 4 < 2;
        bat_curve curve = make_sample(space, 60);
        transform(&curve, stretches[flat ? variant / 4 % 6 : 0], shifts[flat ? variant / 24 % 3 : 0]);
        bat_curve_picture_layer layers[] = {{.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CONTROL},
                                            {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CURVE}};
        bat_curve_picture_panel panel = {layers, 2, NULL};
        bat_curve_picture_options options = bat_curve_picture_defaults();
        options.axes = options.grid = variant / 72 % 2 == 0;
        options.comb = variant / 144 == 0;
        options.projection = (bat_curve_projection)(variant / 4 % 5);
        double extent[4];
        coverage_extent(&panel, &options, extent);
        check_inside(extent, slack);
        free(curve.points);
    }
}

/// The box in R^3 is that of the coordinates, with or without combs, and has margins.
static void frames_hold_the_box_of_solid_curves(void **state)
{
    (void)state;
    bat_curve curve = make_sample(&solid, 60);
    bat_curve_picture_layer layer = {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CURVE};
    bat_curve_picture_panel panel = {&layer, 1, NULL};
    bat_curve_picture_options options = bat_curve_picture_defaults();
    options.axes = options.comb = true;
    scene made;
    assert_int_equal(scene_make(&panel, 1, &options, &made, NULL), BAT_OK);
    const scene_frame *frame = &made.panels[0].frame;
    double low = INFINITY;
    double high = -INFINITY;
    for (size_t i = 0; i < curve.count; i++)
    {
        low = fmin(low, curve.points[3 * i]);
        high = fmax(high, curve.points[3 * i]);
    }
    assert_true(frame->box_low[0] == low && frame->box_high[0] == high);
    draw_view view = {.kind = VIEW_FLAT, .space = VIEW_SOLID, .point_dim = 3};
    view_set_solid(&view);
    for (unsigned corner = 0; corner < 8; corner++)
    {
        double point[3];
        double u;
        double v;
        scene_corner(frame, corner, point);
        view_project(&view, point, &u, &v);
        assert_true(u >= frame->low[0] && u <= frame->high[0] && v >= frame->low[1] && v <= frame->high[1]);
    }
    scene_free(&made);
    free(curve.points);
}

/// A curve through a pole follows the upper edge of the map and crosses its sides, and ends at the frame.
static void map_lines_end_at_the_frame(void **state)
{
    (void)state;
    bat_curve curve = make_curve(&sphere, 5, false);
    const double degree = PI / 180.0;
    const double places[5][2] = {{20.0, 60.0}, {20.0, 90.0}, {-100.0, 50.0}, {150.0, 10.0}, {-170.0, -30.0}};
    for (size_t i = 0; i < 5; i++)
    {
        set_direction(curve.points + 3 * i, places[i][0] * degree, places[i][1] * degree);
    }
    bat_curve_picture_layer layer = {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CURVE};
    bat_curve_picture_panel panel = {&layer, 1, NULL};
    bat_curve_picture_options options = bat_curve_picture_defaults();
    options.projection = BAT_CURVE_PROJECTION_MAP;
    options.grid = false;
    double with[4];
    double without[4];
    coverage_extent(&panel, &options, with);
    layer.role = BAT_CURVE_LAYER_ROLE_CONTROL;
    options.control_polygon = options.control_points = false;
    coverage_extent(&panel, &options, without);
    for (int k = 0; k < 4; k++)
    {
        check_near(with[k], without[k], 0.02);
    }
    free(curve.points);
}

/// The number of occurrences of a text in a picture of one panel.
static size_t occurrences(const bat_curve_picture_panel *panel, const bat_curve_picture_options *options, const char *text)
{
    char path[128];
    path_of(path, "counted.svg");
    assert_int_equal(bat_curve_picture_write(path, panel, 1, options, NULL), BAT_OK);
    size_t size;
    char *bytes = slurp(path, &size);
    size_t count = 0;
    for (const char *found = strstr(bytes, text); found != NULL; found = strstr(found + 1, text))
    {
        count++;
    }
    free(bytes);
    assert_int_equal(unlink(path), 0);
    return count;
}

/// The segments of a hairpin's comb start at one point on the page, but their ends differ.
static void hairpins_have_combs(void **state)
{
    (void)state;
    const size_t count = 60;
    bat_curve curve = make_curve(&plane, count, false);
    for (size_t i = 0; i < count; i++)
    {
        double angle = PI * ((double)i / (double)(count - 1) - 0.5);
        curve.points[2 * i] = i == 0 || i == count - 1 ? -1.0 : 1e-3 * cos(angle);
        curve.points[2 * i + 1] = 1e-3 * sin(angle);
    }
    bat_curve_picture_layer layer = {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CURVE};
    bat_curve_picture_panel panel = {&layer, 1, NULL};
    bat_curve_picture_options options = bat_curve_picture_defaults();
    size_t without = occurrences(&panel, &options, "<path");
    options.comb = true;
    assert_true(occurrences(&panel, &options, "<path") > without + 10);
    free(curve.points);
}

/// A picture of tall panels omits the empty space at their sides, unless its width is prescribed.
static void tall_pictures_are_narrow(void **state)
{
    (void)state;
    bat_curve round = make_sample(&plane, 60);
    bat_curve tall = make_sample(&plane, 60);
    transform(&tall, (double[2]){1.0, 20.0}, (double[2]){0.0, 0.0});
    bat_curve_picture_layer layers[] = {{.curve = &round, .role = BAT_CURVE_LAYER_ROLE_CURVE},
                                        {.curve = &tall, .role = BAT_CURVE_LAYER_ROLE_CURVE}};
    bat_curve_picture_panel panels[] = {{&layers[0], 1, NULL}, {&layers[1], 1, NULL}};
    bat_curve_picture_options options = bat_curve_picture_defaults();
    assert_int_equal(occurrences(&panels[0], &options, "width=\"400pt\""), 1);
    assert_int_equal(occurrences(&panels[1], &options, "width=\"220pt\""), 1);
    options.width = 300.0;
    assert_int_equal(occurrences(&panels[1], &options, "width=\"300pt\""), 1);
    free(round.points);
    free(tall.points);
}

/// Five panels in a row by default, two on a page column, or the requested number.
static void columns_suit_the_width(void **state)
{
    (void)state;
    bat_curve_picture_options options = bat_curve_picture_defaults();
    assert_int_equal(scene_columns(&options, 4, 100.0), 4);
    assert_int_equal(scene_columns(&options, 12, 100.0), 4);
    options.width = 252.0;
    assert_int_equal(scene_columns(&options, 4, 100.0), 2);
    assert_int_equal(scene_columns(&options, 1, 100.0), 1);
    options.width = 20.0;
    assert_int_equal(scene_columns(&options, 4, 100.0), 1);
    options.columns = 3;
    assert_int_equal(scene_columns(&options, 4, 100.0), 3);
    assert_int_equal(scene_columns(&options, 2, 100.0), 2);
}

static void rounds_of_colours_differ_by_dashes(void **state)
{
    (void)state;
    line_style first = style_curve(3);
    line_style second = style_curve(3 + BAT_CURVE_PICTURE_COLOURS);
    line_style third = style_curve(3 + 2 * BAT_CURVE_PICTURE_COLOURS);
    assert_true(first.dash == 0.0 && second.dash > 0.0 && third.dash > 0.0 && second.dash != third.dash);
    assert_true(first.colour.red == third.colour.red && first.colour.green == third.colour.green);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_leaves_its_box),
        cmocka_unit_test(frames_hold_the_box_of_solid_curves),
        cmocka_unit_test(map_lines_end_at_the_frame),
        cmocka_unit_test(hairpins_have_combs),
        cmocka_unit_test(tall_pictures_are_narrow),
        cmocka_unit_test(columns_suit_the_width),
        cmocka_unit_test(rounds_of_colours_differ_by_dashes),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
