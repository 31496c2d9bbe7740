#include "picture_helpers.h"

#include "draw/common/sheet.h"
#include "draw/common/style.h"

/// Every space, every format, every option that draws something.
static void writes_all_spaces_in_all_formats(void **state)
{
    (void)state;
    const bat_space *spaces[] = {&plane, &solid, &five, &sphere, &disk};
    for (size_t s = 0; s < 5; s++)
    {
        bat_curve curve = make_sample(spaces[s], 64);
        bat_curve coarse = make_sample(spaces[s], 8);
        bat_curve_picture_layer layers[] = {
            {.curve = &coarse, .role = BAT_CURVE_LAYER_ROLE_CONTROL, .label = "control polygon"},
            {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_TRUTH, .label = "truth"},
            {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CURVE, .label = "curve"}};
        bat_curve_picture_panel panels[] = {{layers, 3, "left <&>"}, {layers, 3, NULL}};
        bat_curve_picture_options options = bat_curve_picture_defaults();
        options.width = 320;
        options.height = 240;
        options.title = "Title \xc3\xa9";
        options.comb = options.axes = true;
        for (int variant = 0; variant < 9; variant++)
        {
            char name[32];
            char path[128];
            options.projection = (bat_curve_projection)(variant / 3);
            (void)snprintf(name, sizeof name, "picture.%s", endings[variant % 3]);
            path_of(path, name);
            assert_int_equal(bat_curve_picture_write(path, panels, 2, &options, NULL), BAT_OK);
            check_picture(path, 320, 240);
            assert_int_equal(unlink(path), 0);
        }
        free(curve.points);
        free(coarse.points);
    }
}

static void endings_ignore_case(void **state)
{
    (void)state;
    canvas_format format;
    assert_int_equal(canvas_format_of("a/b.SVG", &format, NULL), BAT_OK);
    assert_int_equal(format, CANVAS_SVG);
    assert_int_equal(canvas_format_of("b.x.pNg", &format, NULL), BAT_OK);
    assert_int_equal(format, CANVAS_PNG);
    assert_int_equal(canvas_format_of("B.PDF", &format, NULL), BAT_OK);
    assert_int_equal(format, CANVAS_PDF);
    const char *wrong[] = {"", "svg", ".svg", "a.svg/b", "a.jpeg", "a.", "a/.png", "a.svg "};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
    {
        assert_int_equal(canvas_format_of(wrong[i], &format, NULL), BAT_INVALID_ARGUMENT);
    }
}

static void same_input_gives_same_bytes(void **state)
{
    (void)state;
    bat_curve curve = make_sample(&sphere, 50);
    bat_curve_picture_layer layer = {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CURVE, .label = "curve"};
    bat_curve_picture_panel panel = {&layer, 1, "panel"};
    for (int i = 0; i < 3; i++)
    {
        char first[128];
        char second[128];
        char name[16];
        (void)snprintf(name, sizeof name, "a.%s", endings[i]);
        path_of(first, name);
        name[0] = 'b';
        path_of(second, name);
        assert_int_equal(bat_curve_picture_write(first, &panel, 1, NULL, NULL), BAT_OK);
        assert_int_equal(bat_curve_picture_write(second, &panel, 1, NULL, NULL), BAT_OK);
        size_t sizes[2];
        char *bytes[2] = {slurp(first, &sizes[0]), slurp(second, &sizes[1])};
        assert_int_equal(sizes[0], sizes[1]);
        assert_memory_equal(bytes[0], bytes[1], sizes[0]);
        free(bytes[0]);
        free(bytes[1]);
        assert_int_equal(unlink(first), 0);
        assert_int_equal(unlink(second), 0);
    }
    free(curve.points);
}

/// Writing a picture of a curve must fail; check the error.
static void check_refused(const bat_curve *curve, bat_status status, size_t index)
{
    char path[128];
    path_of(path, "refused.svg");
    bat_error error = {0};
    bat_curve_picture_layer layer = {.curve = curve, .role = BAT_CURVE_LAYER_ROLE_CURVE};
    bat_curve_picture_panel panel = {&layer, 1, NULL};
    assert_int_equal(bat_curve_picture_write(path, &panel, 1, NULL, &error), status);
    assert_int_equal(error.status, status);
    assert_int_equal(error.index, index);
    assert_true(strlen(error.text) > 0);
    assert_int_equal(access(path, F_OK), -1);
}

static void bad_points_are_named(void **state)
{
    (void)state;
    const bat_space *spaces[] = {&plane, &solid, &five, &sphere, &disk};
    double bad[] = {NAN, INFINITY, -INFINITY, 1e200};
    for (size_t s = 0; s < 5; s++)
    {
        for (size_t b = 0; b < 4; b++)
        {
            bat_curve curve = make_sample(spaces[s], 9);
            curve.points[7 * spaces[s]->point_dim + 1] = bad[b];
            check_refused(&curve, BAT_INVALID_POINT, 7);
            free(curve.points);
        }
    }
    bat_curve long_one = make_sample(&sphere, 9);
    long_one.points[3 * 4] *= 1.001;
    long_one.points[3 * 4 + 1] *= 1.001;
    long_one.points[3 * 4 + 2] *= 1.001;
    check_refused(&long_one, BAT_INVALID_POINT, 4);
    free(long_one.points);
    bat_curve outside = make_sample(&disk, 9);
    outside.points[2 * 3] = 0.6;
    outside.points[2 * 3 + 1] = 0.8;
    check_refused(&outside, BAT_INVALID_POINT, 3);
    free(outside.points);
    bat_curve opposite = make_sample(&sphere, 9);
    for (int k = 0; k < 3; k++)
    {
        opposite.points[k] = -opposite.points[3 * 8 + k];
    }
    check_refused(&opposite, BAT_CUT_LOCUS, 8);
    opposite.closed = false;
    char path[128];
    path_of(path, "fine.svg");
    bat_curve_picture_layer layer = {.curve = &opposite, .role = BAT_CURVE_LAYER_ROLE_CURVE};
    assert_int_equal(bat_curve_picture_write(path, &(bat_curve_picture_panel){&layer, 1, NULL}, 1, NULL, NULL), BAT_OK);
    assert_int_equal(unlink(path), 0);
    free(opposite.points);
}

static void empty_and_mixed_panels_are_refused(void **state)
{
    (void)state;
    char path[128];
    path_of(path, "refused.png");
    bat_curve flat = make_sample(&plane, 5);
    bat_curve round = make_sample(&sphere, 5);
    bat_curve none = {.space = &plane};
    bat_space line = bat_euclidean(1);
    bat_curve thin = make_curve(&line, 3, false);
    check_refused(&none, BAT_INVALID_ARGUMENT, 0);
    check_refused(NULL, BAT_INVALID_ARGUMENT, 0);
    check_refused(&thin, BAT_UNSUPPORTED, 0);
    bat_curve_picture_layer layers[] = {{.curve = &flat, .role = BAT_CURVE_LAYER_ROLE_CURVE},
                                        {.curve = &round, .role = BAT_CURVE_LAYER_ROLE_CURVE}};
    bat_curve_picture_panel mixed[] = {{layers, 1, NULL}, {layers, 2, NULL}};
    bat_error error;
    assert_int_equal(bat_curve_picture_write(path, mixed, 2, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 1);
    bat_curve_picture_panel empty[] = {{layers, 1, NULL}, {layers, 1, NULL}, {layers, 0, NULL}};
    assert_int_equal(bat_curve_picture_write(path, empty, 3, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 2);
    empty[2] = (bat_curve_picture_panel){NULL, 1, NULL};
    assert_int_equal(bat_curve_picture_write(path, empty, 3, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_curve_picture_write(path, NULL, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_curve_picture_write(path, mixed, 0, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_curve_picture_write(NULL, mixed, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    free(flat.points);
    free(round.points);
    free(thin.points);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    char path[128];
    path_of(path, "refused.png");
    bat_curve flat = make_sample(&plane, 5);
    bat_curve_picture_layer layer = {.curve = &flat, .role = BAT_CURVE_LAYER_ROLE_CURVE};
    bat_curve_picture_panel panel = {&layer, 1, NULL};
    bat_curve_picture_options bad[14];
    for (int i = 0; i < 14; i++)
    {
        bad[i] = bat_curve_picture_defaults();
    }
    bad[0].width = -1.0;
    bad[1].width = NAN;
    bad[2].height = 1e5;
    bad[3].height = INFINITY;
    bad[4].pixels_per_point = 0.0;
    bad[5].pixels_per_point = 1e3;
    bad[6].projection = (bat_curve_projection)7;
    bad[7].latitude = 2.0;
    bad[8].longitude = INFINITY;
    bad[9].comb_scale = -1.0;
    bad[10].comb_scale = NAN;
    bad[11].title = "\xff";
    bad[12].height = 30.0;
    bad[13].width = 30.0;
    for (int i = 0; i < 14; i++)
    {
        assert_int_equal(bat_curve_picture_write(path, &panel, 1, &bad[i], NULL), BAT_INVALID_ARGUMENT);
    }
    layer.label = "\xc0\xaf";
    assert_int_equal(bat_curve_picture_write(path, &panel, 1, NULL, NULL), BAT_INVALID_ARGUMENT);
    layer.label = NULL;
    panel.title = "two\nlines";
    assert_int_equal(bat_curve_picture_write(path, &panel, 1, NULL, NULL), BAT_INVALID_ARGUMENT);
    panel.title = NULL;
    layer.role = (bat_curve_layer_role)9;
    assert_int_equal(bat_curve_picture_write(path, &panel, 1, NULL, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(folder_entries(), 0);
    free(flat.points);
}

static void failure_leaves_files_alone(void **state)
{
    (void)state;
    char path[128];
    char missing[160];
    path_of(path, "kept.png");
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    (void)fputs("precious", file);
    (void)fclose(file);
    bat_curve curve = make_sample(&plane, 5);
    curve.points[4] = NAN;
    bat_curve_picture_layer layer = {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CURVE};
    bat_curve_picture_panel panel = {&layer, 1, NULL};
    assert_int_equal(bat_curve_picture_write(path, &panel, 1, NULL, NULL), BAT_INVALID_POINT);
    size_t size;
    char *bytes = slurp(path, &size);
    assert_string_equal(bytes, "precious");
    free(bytes);
    curve.points[4] = 0.0;
    bat_error error;
    (void)snprintf(missing, sizeof missing, "%s/none/a.png", folder);
    assert_int_equal(bat_curve_picture_write(missing, &panel, 1, NULL, &error), BAT_FILE_ACCESS);
    assert_int_equal(bat_curve_picture_write(path, &panel, 1, NULL, NULL), BAT_OK);
    assert_int_equal(folder_entries(), 1);
    bytes = slurp(path, &size);
    assert_memory_equal(bytes, "\x89PNG", 4);
    free(bytes);
    free(curve.points);
    assert_int_equal(unlink(path), 0);
}

/// Degenerate curves are drawn too: one point, coincident points, a vertical line, far from the origin.
static void degenerate_curves_are_drawn(void **state)
{
    (void)state;
    char path[128];
    path_of(path, "degenerate.svg");
    const bat_space *spaces[] = {&plane, &solid, &sphere, &disk};
    bat_curve_picture_options options = bat_curve_picture_defaults();
    options.comb = options.axes = true;
    for (size_t s = 0; s < 4; s++)
    {
        for (size_t count = 1; count <= 4; count++)
        {
            bat_curve curve = make_curve(spaces[s], count, count != 2);
            for (size_t i = 0; i < count; i++)
            {
                curve.points[i * spaces[s]->point_dim + (s == 2 ? 2 : 1)] = s == 0   ? 1e9 + (double)(i / 3)
                                                                            : s == 2 ? 1.0
                                                                                     : 0.5;
            }
            bat_curve_picture_layer layers[] = {{.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CURVE},
                                                {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CONTROL}};
            for (int projection = 0; projection < 3; projection++)
            {
                options.projection = (bat_curve_projection)projection;
                assert_int_equal(
                    bat_curve_picture_write(path, &(bat_curve_picture_panel){layers, 2, NULL}, 1, &options, NULL), BAT_OK);
                size_t size;
                char *bytes = slurp(path, &size);
                assert_null(strstr(bytes, "nan"));
                assert_null(strstr(bytes, "inf"));
                check_nesting(bytes);
                free(bytes);
            }
            free(curve.points);
        }
    }
    assert_int_equal(unlink(path), 0);
}

static void large_curves_become_small_files(void **state)
{
    (void)state;
    const bat_space *spaces[] = {&plane, &sphere, &disk};
    for (size_t s = 0; s < 3; s++)
    {
        bat_curve curve = make_sample(spaces[s], 400000);
        bat_curve_picture_layer layer = {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CURVE};
        for (int i = 0; i < 3; i++)
        {
            char name[16];
            char path[128];
            (void)snprintf(name, sizeof name, "large.%s", endings[i]);
            path_of(path, name);
            assert_int_equal(bat_curve_picture_write(path, &(bat_curve_picture_panel){&layer, 1, NULL}, 1, NULL, NULL),
                             BAT_OK);
            size_t size;
            free(slurp(path, &size));
            assert_true(size < 200000);
            assert_int_equal(unlink(path), 0);
        }
        free(curve.points);
    }
}

static void texts_must_be_utf8(void **state)
{
    (void)state;
    const char *good[] = {NULL, "", "plain", "\xc2\xb0", "\xe2\x80\x93", "\xf0\x9f\x99\x82", "\xed\x9f\xbf"};
    const char *bad[] = {"\x80", "\xc1\x81", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80",
                         "\xc2", "\xe2\x88", "a\tb",         "\x7f"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
    {
        assert_true(text_is_valid(good[i]));
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    {
        assert_false(text_is_valid(bad[i]));
    }
}

static void long_texts_are_cut_between_characters(void **state)
{
    (void)state;
    draw_canvas canvas;
    assert_int_equal(canvas_open(&canvas, CANVAS_PNG, 10.0, 10.0, 1.0, NULL), BAT_OK);
    text_use(canvas.cairo, 10.0, false);
    char text[2048] = "";
    for (int i = 0; i < 600; i++)
    {
        (void)strcat(text, "\xc3\xa9");
    }
    for (size_t capacity = 5; capacity < 1300; capacity += 97)
    {
        char cut[2048];
        text_cut(canvas.cairo, text, 1e9, cut, capacity);
        assert_true(strlen(cut) < capacity);
        assert_true(text_is_valid(cut));
        text_cut(canvas.cairo, text, 60.0, cut, sizeof cut);
        assert_true(text_is_valid(cut));
        assert_true(text_width(canvas.cairo, cut) <= 60.0);
    }
    canvas_close(&canvas);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(writes_all_spaces_in_all_formats),
        cmocka_unit_test(endings_ignore_case),
        cmocka_unit_test(same_input_gives_same_bytes),
        cmocka_unit_test(bad_points_are_named),
        cmocka_unit_test(empty_and_mixed_panels_are_refused),
        cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(failure_leaves_files_alone),
        cmocka_unit_test(degenerate_curves_are_drawn),
        cmocka_unit_test(large_curves_become_small_files),
        cmocka_unit_test(texts_must_be_utf8),
        cmocka_unit_test(long_texts_are_cut_between_characters),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
