// Pictures of rotations, rigid motions, tensors and the hyperboloid: their proxies, and refusals.

#include "picture_helpers.h"

#include "batten/space.h"
#include "draw/curve/scene.h"

enum
{
    SPACES = 5,
    COUNT = 9
};

static bat_space spaces[SPACES];

static int set_up_spaces(void **state)
{
    spaces[0] = bat_rotation();
    spaces[1] = bat_positive_definite(2);
    spaces[2] = bat_positive_definite(3);
    spaces[3] = bat_hyperbolic(2);
    return bat_rigid(0.5, &spaces[4], NULL) == BAT_OK ? set_up(state) : -1;
}

/// The points of an ellipse in the tangent space of a point, `height` times as high as wide.
static bat_curve make_ellipse(const bat_space *space, size_t count, bool closed, double height)
{
    bat_curve curve = make_curve(space, count, closed);
    bat_random random = bat_random_seed(5);
    double centre[BAT_SPACE_MAX_DIM], tangent[BAT_SPACE_MAX_DIM] = {0};
    space->random_point(space, &random, centre);
    for (size_t i = 0; i < count; i++)
    {
        double angle = 2 * PI * (double)i / (double)count;
        tangent[0] = 0.7 * cos(angle);
        tangent[1] = 0.7 * height * sin(angle);
        assert_int_equal(space->exp(space, centre, tangent, curve.points + i * space->point_dim), BAT_OK);
    }
    return curve;
}

static bat_status write_three(const char *path, const bat_curve *coarse, const bat_curve *truth, const bat_curve *fine,
                              const bat_curve_picture_options *options, bat_error *error)
{
    bat_curve_picture_layer layers[] = {{.curve = coarse, .role = BAT_CURVE_LAYER_ROLE_CONTROL, .label = "given"},
                                        {.curve = truth, .role = BAT_CURVE_LAYER_ROLE_TRUTH, .label = "truth"},
                                        {.curve = fine, .role = BAT_CURVE_LAYER_ROLE_CURVE, .label = "curve"}};
    bat_curve_picture_panel panels[] = {{layers, 3, "all"}, {layers, 1, NULL}};
    return bat_curve_picture_write(path, panels, 2, options, error);
}

static void every_space_is_drawn_in_every_format(void **state)
{
    (void)state;
    for (size_t s = 0; s < SPACES; s++)
    {
        bat_curve coarse = make_ellipse(&spaces[s], COUNT, true, 0.5), fine = make_ellipse(&spaces[s], 100, true, 0.5);
        bat_curve_picture_options options = bat_curve_picture_defaults();
        options.width = 320;
        options.height = 240;
        options.comb = options.axes = true; // neither has an effect here
        for (int variant = 0; variant < 12; variant++)
        {
            char name[32], path[128];
            options.control_polygon = variant / 3 % 2 == 0;
            options.control_points = variant / 6 == 0;
            (void)snprintf(name, sizeof name, "picture.%s", endings[variant % 3]);
            path_of(path, name);
            assert_int_equal(write_three(path, &coarse, &fine, &fine, &options, NULL), BAT_OK);
            check_picture(path, 320, 240);
            assert_int_equal(unlink(path), 0);
        }
        free(coarse.points);
        free(fine.points);
    }
}

/// The bytes of a picture of one curve.
static char *picture_of(const bat_curve *curve, bat_curve_layer_role role, size_t *size)
{
    char path[128];
    path_of(path, "one.svg");
    bat_curve_picture_layer layer = {.curve = curve, .role = role};
    assert_int_equal(bat_curve_picture_write(path, &(bat_curve_picture_panel){&layer, 1, NULL}, 1, NULL, NULL), BAT_OK);
    char *bytes = slurp(path, size);
    assert_int_equal(unlink(path), 0);
    return bytes;
}

/// The same curve gives the same bytes; another curve or role gives other bytes.
static void pictures_differ_where_curves_do(void **state)
{
    (void)state;
    for (size_t s = 0; s < SPACES; s++)
    {
        bat_curve flat = make_ellipse(&spaces[s], COUNT, true, 0.2), round = make_ellipse(&spaces[s], COUNT, true, 1);
        const bat_curve *curves[4] = {&flat, &flat, &round, &flat};
        char *bytes[4];
        size_t sizes[4];
        for (size_t i = 0; i < 4; i++)
        {
            bytes[i] = picture_of(curves[i], i == 3 ? BAT_CURVE_LAYER_ROLE_CONTROL : BAT_CURVE_LAYER_ROLE_CURVE, &sizes[i]);
        }
        assert_true(sizes[0] > 1000);
        assert_string_equal(bytes[0], bytes[1]);
        assert_string_not_equal(bytes[0], bytes[2]);
        assert_string_not_equal(bytes[0], bytes[3]);
        for (size_t i = 0; i < 4; i++)
        {
            free(bytes[i]);
        }
        free(flat.points);
        free(round.points);
    }
}

/// The columns lie on the sphere, belong to the matrix, and follow the geodesic between the given rotations.
static void rotations_become_their_columns(void **state)
{
    (void)state;
    const double angle = 1.2;
    double quaternions[8] = {1, 0, 0, 0, cos(angle / 2), 0, 0, sin(angle / 2)};
    bat_curve turn = {.space = &spaces[0], .points = quaternions, .count = 2};
    bat_curve_picture_layer layers[] = {{.curve = &turn, .role = BAT_CURVE_LAYER_ROLE_CURVE},
                                        {.curve = &turn, .role = BAT_CURVE_LAYER_ROLE_CONTROL}};
    bat_curve_picture_panel panel = {layers, 2, NULL};
    bat_curve_picture_options options = bat_curve_picture_defaults();
    proxy made;
    assert_int_equal(proxy_make(&panel, &options, &made, NULL), BAT_OK);
    assert_int_equal(made.count, 8); // three columns twice, and two frames
    const bat_curve *x = &made.curves[0], *z = &made.curves[2];
    assert_true(x->count > 20);
    for (size_t i = 0; i < x->count; i++)
    {
        double share = (double)i / (double)(x->count - 1);
        check_near(x->points[3 * i], cos(share * angle), 1e-14);
        check_near(x->points[3 * i + 1], sin(share * angle), 1e-14);
        check_near(z->points[3 * i + 2], 1, 1e-14);
    }
    const double *frame = made.curves[7].points;
    check_near(frame[0], cos(angle), 1e-14);
    check_near(frame[3], -sin(angle), 1e-14);
    check_near(frame[8], 1, 1e-14);
    assert_true(made.curves[7].closed);
    proxy_free(&made);
    proxy_free(&made);
}

/// Points of the hyperboloid keep their distance in the disk.
static void the_hyperboloid_becomes_the_disk(void **state)
{
    (void)state;
    bat_curve curve = make_ellipse(&spaces[3], COUNT, false, 0.5);
    bat_curve_picture_layer layer = {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CURVE};
    bat_curve_picture_options options = bat_curve_picture_defaults();
    proxy made;
    assert_int_equal(proxy_make(&(bat_curve_picture_panel){&layer, 1, NULL}, &options, &made, NULL), BAT_OK);
    for (size_t i = 0; i + 1 < COUNT; i++)
    {
        double there = spaces[3].distance(&spaces[3], curve.points + 3 * i, curve.points + 3 * (i + 1));
        check_near(disk.distance(&disk, made.curves[0].points + 2 * i, made.curves[0].points + 2 * (i + 1)), there, 1e-12);
    }
    proxy_free(&made);
    free(curve.points);
}

/// The axes of a rigid motion's frames have equal lengths and start on the path.
static void motions_become_frames_on_their_path(void **state)
{
    (void)state;
    double poses[14] = {0, 0, 0, 1, 0, 0, 0, 3, 4, 0, 0, 1, 0, 0};
    bat_curve curve = {.space = &spaces[4], .points = poses, .count = 2};
    bat_curve_picture_layer layer = {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CONTROL};
    bat_curve_picture_options options = bat_curve_picture_defaults();
    proxy made;
    assert_int_equal(proxy_make(&(bat_curve_picture_panel){&layer, 1, NULL}, &options, &made, NULL), BAT_OK);
    assert_int_equal(made.count, 7);
    double length = made.curves[1].points[3];
    assert_true(length > 0.1 && length < 1);
    const double turned[3] = {1, -1, -1}; // half a turn about x
    for (size_t axis = 0; axis < 3; axis++)
    {
        const double *ends = made.curves[4 + axis].points;
        check_near(ends[0], 3, 0);
        check_near(ends[1], 4, 0);
        check_near(ends[3 + axis] - ends[axis], turned[axis] * length, 1e-14);
    }
    proxy_free(&made);
}

/// The unit of a row is the root of the largest eigenvalue, for any scale of the numbers.
static void rows_fit_the_largest_tensor(void **state)
{
    (void)state;
    const double units[] = {1, 1e-60, 1e60};
    for (size_t i = 0; i < 3; i++)
    {
        double unit = units[i];
        double tensors[9] = {4 * unit, 0, unit, 5 * unit, 4 * unit, 5 * unit, unit, 0, unit};
        bat_curve curve = {.space = &spaces[1], .points = tensors, .count = 3};
        bat_curve_picture_layer layers[] = {{.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CONTROL},
                                            {.curve = &curve, .role = BAT_CURVE_LAYER_ROLE_CURVE}};
        scene_frame frame = {0};
        assert_int_equal(tensor_row_include(&frame, &(bat_curve_picture_panel){layers, 2, NULL}, NULL), BAT_OK);
        check_near(frame.tensor_unit / sqrt(unit), 3, 1e-12); // 5 + 4
        assert_int_equal(frame.tensor_columns, 3);
        assert_true(frame.high[0] > 4 && frame.low[1] < -3);
        size_t size;
        free(picture_of(&curve, BAT_CURVE_LAYER_ROLE_CURVE, &size));
        assert_true(size > 1000);
    }
}

static void check_refused(const bat_curve *curve, bat_status status, size_t index)
{
    char path[128];
    bat_error error = {0};
    path_of(path, "refused.svg");
    bat_curve_picture_layer layer = {.curve = curve, .role = BAT_CURVE_LAYER_ROLE_CURVE};
    assert_int_equal(bat_curve_picture_write(path, &(bat_curve_picture_panel){&layer, 1, NULL}, 1, NULL, &error), status);
    assert_int_equal(error.status, status);
    assert_int_equal(error.index, index);
    assert_true(strlen(error.text) > 0);
    assert_int_equal(access(path, F_OK), -1);
}

static void bad_points_are_named(void **state)
{
    (void)state;
    for (size_t s = 0; s < SPACES; s++)
    {
        const double bad[] = {NAN, INFINITY, -7};
        for (size_t b = 0; b < 3; b++)
        {
            bat_curve curve = make_ellipse(&spaces[s], COUNT, true, 0.5);
            // -7 is not a component of a unit quaternion, a diagonal entry of a positive-definite matrix, or x_0.
            curve.points[6 * spaces[s].point_dim + (s == 4 ? 3 : 0)] = bad[b];
            check_refused(&curve, BAT_INVALID_POINT, 6);
            free(curve.points);
        }
    }
    double half_turn[8] = {1, 0, 0, 0, 0, 1, 0, 0};
    check_refused(&(bat_curve){.space = &spaces[0], .points = half_turn, .count = 2}, BAT_CUT_LOCUS, 0);
    const bat_space others[] = {bat_positive_definite(4), bat_hyperbolic(3), bat_sphere(3)};
    for (size_t i = 0; i < 3; i++)
    {
        bat_curve curve = make_ellipse(&others[i], COUNT, true, 0.5);
        check_refused(&curve, BAT_UNSUPPORTED, 0);
        free(curve.points);
    }
}

/// Tensors with 2 and with 3 rows are two spaces, and so are rotations and the sphere of their proxy.
static void mixed_panels_are_refused(void **state)
{
    (void)state;
    char path[128];
    path_of(path, "refused.svg");
    bat_curve a = make_ellipse(&spaces[1], COUNT, true, 0.5), b = make_ellipse(&spaces[2], COUNT, true, 0.5);
    bat_curve c = make_ellipse(&spaces[0], COUNT, true, 0.5), d = make_sample(&sphere, COUNT);
    const bat_curve *pairs[2][2] = {{&a, &b}, {&c, &d}};
    for (size_t i = 0; i < 2; i++)
    {
        bat_curve_picture_layer layers[] = {{.curve = pairs[i][0], .role = BAT_CURVE_LAYER_ROLE_CURVE},
                                            {.curve = pairs[i][1], .role = BAT_CURVE_LAYER_ROLE_CURVE}};
        assert_int_equal(bat_curve_picture_write(path, &(bat_curve_picture_panel){layers, 2, NULL}, 1, NULL, NULL),
                         BAT_INVALID_ARGUMENT);
    }
    free(a.points);
    free(b.points);
    free(c.points);
    free(d.points);
}

/// One point, equal points, very flat tensors.
static void degenerate_curves_are_drawn(void **state)
{
    (void)state;
    size_t size;
    for (size_t s = 0; s < SPACES; s++)
    {
        bat_curve one = make_ellipse(&spaces[s], 1, true, 0.5), same = make_ellipse(&spaces[s], 2, false, 0);
        memcpy(same.points + spaces[s].point_dim, same.points, spaces[s].point_dim * sizeof(double));
        for (int role = BAT_CURVE_LAYER_ROLE_CURVE; role <= BAT_CURVE_LAYER_ROLE_TRUTH; role++)
        {
            free(picture_of(&one, (bat_curve_layer_role)role, &size));
            assert_true(size > 500);
            free(picture_of(&same, (bat_curve_layer_role)role, &size));
            assert_true(size > 500);
        }
        free(one.points);
        free(same.points);
    }
    double flat[12] = {1, 0, 0, 1e-14, 0, 1e-14, 1e-14, 0, 0, 1, 0, 1e-9};
    bat_curve needles = {.space = &spaces[2], .points = flat, .count = 2};
    char *bytes = picture_of(&needles, BAT_CURVE_LAYER_ROLE_CURVE, &size);
    check_nesting(bytes);
    assert_null(strstr(bytes, "nan"));
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_space_is_drawn_in_every_format),
        cmocka_unit_test(pictures_differ_where_curves_do),
        cmocka_unit_test(rotations_become_their_columns),
        cmocka_unit_test(the_hyperboloid_becomes_the_disk),
        cmocka_unit_test(motions_become_frames_on_their_path),
        cmocka_unit_test(rows_fit_the_largest_tensor),
        cmocka_unit_test(bad_points_are_named),
        cmocka_unit_test(mixed_panels_are_refused),
        cmocka_unit_test(degenerate_curves_are_drawn),
    };
    return cmocka_run_group_tests(tests, set_up_spaces, tear_down);
}
