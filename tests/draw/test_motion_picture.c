// Pictures of motions: every space, units and marks, degenerate motions, and refusals.
#include "picture_helpers.h"
#include "pixel_helpers.h"

#include "batten/curve_picture.h"
#include "draw/motion/film.h"

#include <string.h>
#include <sys/stat.h>

enum
{
    KEYS = 8
};

static bat_space rigid_space(void)
{
    bat_space space;
    assert_int_equal(bat_rigid(1, &space, NULL), BAT_OK);
    return space;
}

/// Keyframes of a motion at times 0, 1, …, scaled; released with bat_curve_set_free().
static bat_curve_set make_keys(const bat_space *space, size_t count, double scale)
{
    bat_curve *curve = calloc(1, sizeof *curve);
    bat_curve_set set;
    assert_non_null(curve);
    *curve = make_curve(space, count, false);
    bat_random random = bat_random_seed(7);
    for (size_t i = 0; i < count; i++)
        space->random_point(space, &random, curve->points + i * space->point_dim);
    bool scaled = strcmp(space->name, "euclidean") == 0 || strcmp(space->name, "rigid") == 0;
    for (size_t i = 0; i < count && scaled; i++)
        for (size_t c = 0; c < (space->point_dim == 7 ? 3 : space->point_dim); c++)
            curve->points[i * space->point_dim + c] = scale * sin((double)i * (1 + (double)c));
    assert_int_equal(bat_curve_set_take(curve, 1, &set, NULL), BAT_OK);
    return set;
}

static bat_motion_curves_options in_time(void)
{
    bat_motion_curves_options options = bat_motion_curves_defaults();
    options.method = BAT_MOTION_METHOD_SPLINE;
    return options;
}

static bat_status draw(const bat_curve_set *set, const char *name, const bat_motion_picture_options *options,
                       bat_error *error)
{
    char path[80];
    bat_motion_curves_options motion = in_time();
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    bat_status status = bat_motion_picture_write(path, set, &motion, options, error);
    struct stat found;
    assert_true((status == BAT_OK) == (stat(path, &found) == 0));
    (void)remove(path);
    return status;
}

static void every_space_is_drawn(void **state)
{
    (void)state;
    bat_space tensors = bat_positive_definite(2), rotations = bat_rotation(), rigid = rigid_space(), line = bat_euclidean(1);
    bat_space hyperbolic = bat_hyperbolic(2), large = bat_euclidean(12);
    const bat_space *spaces[] = {&plane,     &solid, &five,       &sphere, &disk, &tensors,
                                 &rotations, &rigid, &hyperbolic, &line,   &large};
    for (size_t s = 0; s < sizeof spaces / sizeof *spaces; s++)
    {
        bat_curve_set set = make_keys(spaces[s], KEYS, 1);
        for (size_t e = 0; e < 3; e++)
        {
            bat_error error = {0};
            char name[16];
            (void)snprintf(name, sizeof name, "m.%s", endings[e]);
            if (draw(&set, name, NULL, &error) != BAT_OK)
                fail_msg("%s: %s", spaces[s]->name, error.text);
        }
        bat_curve_set_free(&set);
    }
}

/// Two keys, equal keys, and sizes from 1e-100 to 1e100 are drawn.
static void degenerate_motions_are_drawn(void **state)
{
    (void)state;
    bat_space rigid = rigid_space();
    const bat_space *spaces[] = {&plane, &solid, &rigid, &five};
    const double scales[] = {0, 1e-100, 1e-12, 1e12, 1e100};
    for (size_t s = 0; s < 4; s++)
        for (size_t k = 0; k < sizeof scales / sizeof *scales; k++)
            for (size_t count = 2; count < 4; count++)
            {
                bat_error error = {0};
                bat_curve_set set = make_keys(spaces[s], count, scales[k]);
                if (draw(&set, "m.svg", NULL, &error) != BAT_OK)
                    fail_msg("%s, %g: %s", spaces[s]->name, scales[k], error.text);
                bat_curve_set_free(&set);
            }
}

static void huge_motions_are_refused(void **state)
{
    (void)state;
    bat_error error;
    bat_curve_set set = make_keys(&solid, KEYS, 1e160);
    assert_int_equal(draw(&set, "m.svg", NULL, &error), BAT_INVALID_POINT);
    assert_non_null(strstr(error.text, "1e150"));
    bat_curve_set_free(&set);
}

static void one_key_is_refused(void **state)
{
    (void)state;
    bat_error error;
    bat_curve_set set = make_keys(&plane, 1, 1);
    assert_int_equal(draw(&set, "m.svg", NULL, &error), BAT_INVALID_ARGUMENT);
    bat_curve_set_free(&set);
}

static void options_are_checked(void **state)
{
    (void)state;
    bat_error error;
    bat_curve_set set = make_keys(&plane, KEYS, 1);
    bat_motion_picture_options options = bat_motion_picture_defaults();
    options.width = 50;
    assert_int_equal(draw(&set, "m.svg", &options, &error), BAT_INVALID_ARGUMENT);
    options = bat_motion_picture_defaults();
    options.length_unit = "\x01";
    assert_int_equal(draw(&set, "m.svg", &options, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(draw(&set, "m.bmp", NULL, &error), BAT_INVALID_ARGUMENT);
    bat_motion_curves_options motion = bat_motion_curves_defaults();
    motion.method = BAT_MOTION_METHOD_HERMITE;
    assert_int_equal(bat_motion_picture_write("/nowhere/m.svg", &set, &motion, NULL, &error), BAT_UNSUPPORTED);
    bat_curve_set_free(&set);
}

/// The speed of a motion along a line, sampled, is that of the line.
static void speeds_are_right(void **state)
{
    (void)state;
    bat_space rigid = rigid_space();
    bat_curve_set set = make_keys(&rigid, 5, 0);
    bat_motion_picture_options options = bat_motion_picture_defaults();
    bat_motion_curves_options motion = in_time();
    for (size_t i = 0; i < 5; i++)
    {
        double *pose = set.curves[0].points + 7 * i, angle = 0.2 * (double)i;
        pose[0] = 3 * (double)i;
        pose[1] = 4 * (double)i;
        pose[2] = 0;
        memcpy(pose + 3, (double[4]){cos(angle / 2), 0, 0, sin(angle / 2)}, 4 * sizeof *pose);
    }
    film shown;
    assert_int_equal(film_make(&set, NULL, &motion, &options, &shown, NULL), BAT_OK);
    assert_true(shown.body && shown.kind == FILM_PATH);
    for (size_t i = 0; i < shown.tracks[0].count; i++)
    {
        check_near(shown.tracks[0].speeds[i], 5, 1e-12);
        check_near(shown.tracks[0].turns[i], 0.2 * 180 / PI, 1e-10);
    }
    film_free(&shown);
    bat_curve_set_free(&set);
}

/// Of keyframes on a line, the one that lies apart is beyond the threshold, and no other.
static void outliers_are_marked(void **state)
{
    (void)state;
    enum
    {
        COUNT = 40,
        APART = 17
    };
    const bat_motion_outliers rules[] = {BAT_MOTION_OUTLIERS_NONE, BAT_MOTION_OUTLIERS_HUBER, BAT_MOTION_OUTLIERS_TUKEY};
    for (size_t r = 0; r < sizeof rules / sizeof *rules; r++)
    {
        bat_curve_set set = make_keys(&plane, COUNT, 1);
        for (size_t i = 0; i < COUNT; i++)
        {
            double *point = set.curves[0].points + 2 * i, wave = i % 2 == 0 ? 0.01 : -0.01;
            point[0] = 0.5 * (double)i;
            point[1] = i == APART ? 1 : wave;
        }
        bat_motion_picture_options options = bat_motion_picture_defaults();
        bat_motion_curves_options motion = in_time();
        motion.spline.sigma = 0.02;
        motion.spline.outliers = rules[r];
        film shown;
        assert_int_equal(film_make(&set, NULL, &motion, &options, &shown, NULL), BAT_OK);
        bool marked = rules[r] != BAT_MOTION_OUTLIERS_NONE;
        assert_int_equal(shown.any_outlier, marked);
        for (size_t i = 0; i < COUNT && marked; i++)
            assert_int_equal(shown.tracks[0].deviations[i] > shown.outlying, i == APART);
        film_free(&shown);
        bat_curve_set_free(&set);
    }
}

/// A path that is flat across y is seen from minus y, and the directions of every view are orthonormal and right-handed.
static void views_are_rotations(void **state)
{
    (void)state;
    for (int flat = 0; flat < 3; flat++)
    {
        bat_curve_set set = make_keys(&solid, KEYS, 1);
        for (size_t i = 0; i < KEYS; i++)
            set.curves[0].points[3 * i + (size_t)flat] *= 0.01;
        bat_motion_picture_options options = bat_motion_picture_defaults();
        bat_motion_curves_options motion = in_time();
        film shown;
        path_view view;
        assert_int_equal(film_make(&set, NULL, &motion, &options, &shown, NULL), BAT_OK);
        path_view_make(&shown, &view);
        assert_int_equal(view.up, flat);
        const double(*r)[3] = (const double(*)[3])view.rows;
        for (int i = 0; i < 3; i++)
        {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            for (int c = 0; c < 3; c++)
            {
                int d = (c + 1) % 3, e = (c + 2) % 3;
                check_near(r[j][d] * r[k][e] - r[j][e] * r[k][d], r[i][c], 1e-14);
            }
        }
        assert_true(flat == 1 ? r[1][1] < 0 : r[1][flat] > 0);
        film_free(&shown);
        bat_curve_set_free(&set);
    }
}

/// A spline that exists gives the bytes of the picture that makes it.
static void splines_are_drawn(void **state)
{
    (void)state;
    bat_space rigid = rigid_space();
    const bat_space *spaces[] = {&solid, &rigid, &sphere, &five};
    for (size_t s = 0; s < 4; s++)
    {
        bat_curve_set set = make_keys(spaces[s], KEYS, 1);
        bat_motion_curves_options motion = in_time();
        bat_motion_spline *spline;
        bat_error error;
        char paths[2][80], *texts[2];
        size_t sizes[2];
        for (size_t i = 0; i < 2; i++)
            (void)snprintf(paths[i], sizeof paths[i], "%s/spline%zu.svg", folder, i);
        assert_int_equal(bat_motion_curve_spline(&set, 0, &motion, &spline, NULL), BAT_OK);
        assert_int_equal(bat_motion_picture_write(paths[0], &set, &motion, NULL, NULL), BAT_OK);
        assert_int_equal(bat_motion_splines_picture_write(paths[1], &set, &spline, BAT_MOTION_OUTLIERS_TUKEY, NULL, NULL),
                         BAT_OK);
        for (size_t i = 0; i < 2; i++)
            texts[i] = slurp(paths[i], &sizes[i]);
        assert_true(sizes[0] == sizes[1] && memcmp(texts[0], texts[1], sizes[0]) == 0);
        // A gyroscope adds keys, but none may be missing.
        bat_motion_spline *shorter;
        set.curves[0].count--;
        assert_int_equal(bat_motion_curve_spline(&set, 0, &motion, &shorter, NULL), BAT_OK);
        set.curves[0].count++;
        assert_int_equal(bat_motion_splines_picture_write(paths[0], &set, &shorter, BAT_MOTION_OUTLIERS_NONE, NULL, &error),
                         BAT_INVALID_ARGUMENT);
        assert_non_null(strstr(error.text, "8 points"));
        bat_motion_spline_free(shorter);
        set.space->point_dim++;
        assert_int_equal(bat_motion_splines_picture_write(paths[0], &set, &spline, BAT_MOTION_OUTLIERS_NONE, NULL, &error),
                         BAT_INVALID_ARGUMENT);
        set.space->point_dim--;
        assert_int_equal(bat_motion_splines_picture_write(paths[0], &set, NULL, BAT_MOTION_OUTLIERS_NONE, NULL, &error),
                         BAT_INVALID_ARGUMENT);
        for (size_t i = 0; i < 2; i++)
        {
            free(texts[i]);
            (void)remove(paths[i]);
        }
        bat_motion_spline_free(spline);
        bat_curve_set_free(&set);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_space_is_drawn),     cmocka_unit_test(degenerate_motions_are_drawn),
        cmocka_unit_test(huge_motions_are_refused), cmocka_unit_test(one_key_is_refused),
        cmocka_unit_test(options_are_checked),      cmocka_unit_test(speeds_are_right),
        cmocka_unit_test(outliers_are_marked),      cmocka_unit_test(views_are_rotations),
        cmocka_unit_test(splines_are_drawn),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
