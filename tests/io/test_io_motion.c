// Keyframes in files: named columns of rotations, poses and tensors, trajectories, and the curves made from them.

#include "choice_helpers.h"
#include "test_io_helpers.h"

#include "batten/motion.h"
#include "batten/space.h"

#include <stdio.h>

static const bat_curve_format CSV = BAT_CURVE_FORMAT_CSV, TUM = BAT_CURVE_FORMAT_TUM;

/// The angle between two rotations.
static double turn(const double *p, const double *q)
{
    bat_space rotation = bat_rotation();
    return rotation.distance(&rotation, p, q);
}

/// All representations of the rotation by 2 pi / 3 about (1, 1, 1), which maps x to y, y to z and z to x; columns in any
/// order.
static void rotations_have_three_forms(void **state)
{
    (void)state;
    const char *texts[] = {
        "qz,time,qw,qx,qy\n0.5,3,0.5,0.5,0.5\n",
        "QW,QX,QY,QZ,T\n0.5,0.5,0.5,0.5,3\n",
        "t,m11,m12,m13,m21,m22,m23,m31,m32,m33\n3,0,0,1,1,0,0,0,1,0\n",
        "rx,ry,rz,timestamp\n1.2091995761561452,1.2091995761561452,1.2091995761561452,3\n",
        "\"time\",\"qw\",\"qx\",\"qy\",\"qz\"\n3,0.50002,0.49998,0.50001,0.49999\n",
    };
    const double expected[4] = {0.5, 0.5, 0.5, 0.5};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    {
        bat_curve_set set = must_read(texts[i], CSV, "rotation");
        assert_string_equal(set.space->name, "rotation");
        assert_true(turn(set.curves[0].points, expected) < (i == 4 ? 1e-4 : 1e-15));
        assert_null(set.space->fault(set.space, set.curves[0].points));
        assert_int_equal(set.curves[0].channel_count, 1);
        assert_true(set.curves[0].channels[0] == 3);
        assert_true(bat_motion_has_times(&set));
        assert_false(bat_motion_has_velocities(&set));
        bat_curve_set_free(&set);
    }
    bat_curve_set set = must_read("0.5,0.5,0.5,0.5\n", CSV, "rotation");
    assert_memory_equal(set.curves[0].points, expected, sizeof expected);
    bat_curve_set_free(&set);
}

static void motions_are_manifolds_in_time(void **state)
{
    (void)state;
    static const struct
    {
        const char *text, *space;
        bool suits;
    } cases[] = {{"time,qw,qx,qy,qz\n0,1,0,0,0\n", NULL, true},
                 {"qw,qx,qy,qz\n1,0,0,0\n", NULL, false},
                 {"xx,xy,yy,vxx,vxy,vyy\n2,1,2,0,0,0\n", "spd", true},
                 {"time,x,y\n0,1,2\n", "plane", false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_curve_set set = must_read(cases[i].text, CSV, cases[i].space);
        assert_int_equal(bat_motion_suits(&set), cases[i].suits);
        bat_curve_set_free(&set);
    }
}

static void the_weight_of_translations_is_read(void **state)
{
    (void)state;
    static const char text[] = "time,tx,ty,tz,qx,qy,qz,qw\n0,1,2,3,0,0,0,1\n1,2,2,3,0,0,0,1\n";
    bat_curve_read_options options = bat_curve_read_defaults();
    bat_curve_set set;
    options.format = CSV;
    options.translation_weight = 3;
    assert_int_equal(bat_curve_read_memory(text, sizeof text - 1, &options, &set, NULL), BAT_OK);
    assert_true(set.space->distance(set.space, set.curves[0].points, set.curves[0].points + 7) == 3);
    bat_curve_set_free(&set);
    options.translation_weight = -1;
    assert_int_equal(bat_curve_read_memory(text, sizeof text - 1, &options, &set, NULL), BAT_INVALID_ARGUMENT);
}

static void names_alone_imply_rotations_and_poses(void **state)
{
    (void)state;
    bat_curve_set set = must_read("time,qw,qx,qy,qz\n0,1,0,0,0\n", CSV, NULL);
    assert_string_equal(set.space->name, "rotation");
    bat_curve_set_free(&set);
    set = must_read("time,tx,ty,tz,qx,qy,qz,qw\n0,1,2,3,0,0,0,1\n", CSV, NULL);
    assert_string_equal(set.space->name, "rigid");
    bat_curve_set_free(&set);
    set = must_read("a,b,c,d\n0,1,2,3\n", CSV, NULL);
    assert_string_equal(set.space->name, "euclidean");
    bat_curve_set_free(&set);
    set = must_read("t,x,y\n7,1,2\n", CSV, NULL);
    assert_string_equal(set.space->name, "plane");
    assert_true(set.curves[0].points[1] == 2 && set.curves[0].channels[0] == 7);
    bat_curve_set_free(&set);
    set = must_read("# space: spd\nxx,xy,yy\n2,1,2\n", CSV, NULL);
    assert_string_equal(set.space->name, "spd");
    assert_int_equal(set.space->point_dim, 3);
    bat_curve_set_free(&set);
}

static void written_columns_are_those_that_were_read(void **state)
{
    (void)state;
    const char *texts[] = {
        "# space: rotation\nqz,time,qw,qx,qy\n0.5,3,0.5,0.5,0.5\n",
        "# space: rotation\nt,m11,m12,m13,m21,m22,m23,m31,m32,m33\n3,0,0,1,1,0,0,0,1,0\n",
        "# space: rotation\nrx,ry,rz,wx,wy,wz\n0.5,0,0,1,2,3\n",
        "# space: rigid\ntx,ty,tz,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n1,2,3,1,0,0,0,4,5,6,7,8,9\n",
        "# space: spd\ntime,xx,xy,xz,yy,yz,zz,vxx,vxy,vxz,vyy,vyz,vzz\n0,2,1,0,2,0,2,1,2,3,4,5,6\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        assert_rewritten(texts[i], CSV, NULL, texts[i]);
    assert_rewritten("# a comment\n\n0 1 2 3 0 0 0 1\n\n1.5\t1 2  3 0.5 0.5 0.5 0.5\n", TUM, NULL,
                     "# timestamp tx ty tz qx qy qz qw\n0 1 2 3 0 0 0 1\n1.5 1 2 3 0.5 0.5 0.5 0.5\n");
}

static void trajectories_have_the_scalar_last(void **state)
{
    (void)state;
    const double expected[7] = {1, 2, 3, 0.8, 0.6, 0, 0};
    bat_curve_set set = must_read("5 1 2 3 0.6 0 0 0.8\n", TUM, NULL);
    assert_memory_equal(set.curves[0].points, expected, sizeof expected);
    assert_true(set.curves[0].channels[0] == 5);
    bat_curve_set_free(&set);
    set = must_read("5 1 2 3 0.6 0 0 0.8\n", CSV, "rigid");
    assert_memory_equal(set.curves[0].points, expected, sizeof expected);
    bat_curve_set_free(&set);
    set = must_read("1 2 3 0.8 0.6 0 0\n", CSV, "rigid");
    assert_memory_equal(set.curves[0].points, expected, sizeof expected);
    assert_int_equal(set.curves[0].channel_count, 0);
    bat_curve_set_free(&set);
    assert_int_equal(choice_value_of_path(&bat_curve_format_family, "a/b.TUM"), BAT_CURVE_FORMAT_TUM);
}

static void bad_columns_name_the_line(void **state)
{
    (void)state;
    const struct
    {
        const char *text, *space;
        size_t line;
        const char *words;
    } cases[] = {
        {"# c\ntime,qw,qx,qy\n0,1,0,0\n", "rotation", 2, "needs a column 'qz'"},
        {"qw,qx,qy,qz,note\n1,0,0,0,1\n", "rotation", 1, "'note' has no meaning"},
        {"qw,qx,qy,qz,qw\n1,0,0,0,1\n", "rotation", 1, "'qw' is there twice"},
        {"qw,qx,qy,qz,rx,ry,rz\n1,0,0,0,0,0,0\n", "rotation", 1, "'rx' has no meaning"},
        {"qw,qx,qy,qz,wx\n1,0,0,0,1\n", "rotation", 1, "needs a column 'wy'"},
        {"1,0,0\n", "rotation", 1, "3 columns"},
        {"qw,qx,qy,qz\n1,0,0,0\n0,0,0,0\n", "rotation", 3, "zero"},
        {"qw,qx,qy,qz\n1,0,0,0\n1,0,0,0.1\n", "rotation", 3, "unit length"},
        {"m11,m12,m13,m21,m22,m23,m31,m32,m33\n1,0,0,0,1,0,0,0,1.0001\n", "rotation", 2, "not a rotation"},
        {"m11,m12,m13,m21,m22,m23,m31,m32,m33\n1,0,0,0,1,0,0,0,-1\n", "rotation", 2, "not a rotation"},
        {"rx,ry,rz\n1e300,0,0\n", "rotation", 2, "too long"},
        {"xx,xy,yy\n1,0,1\n1,1,1\n", "spd", 3, "positive definite"},
        {"1,2,3,4\n", "spd", 1, "4 columns"},
        {"0 1 2 3 0 0 0 0\n", "rigid", 1, "zero"},
        {"time,qw,qx,qy,qz\n0,1,0,0,0\n\n# next\n0,1,0,0,0\n1,0.8,0.6,0,0\n1,0.6,0.8,0,0\n", "rotation", 7,
         "the time 1 does not come after 1"},
        {"y,T,x\n0,3,0\n0,4,1\n0,2,2\n", NULL, 4, "the time 2 does not come after 4"},
        {"time,lat,lon\n0,0,0\n0,0,1\n", NULL, 3, "the time 0 does not come after 0"},
        {"x,y,timestamp\n0,0,0\n0.1,0,1\n0.1,0.1,1\n", "disk", 4, "the time 1 does not come after 1"},
        {"# closed\nx,y,time\n0,0,0\n1,0,1\n1,1,1\n0,1,2\n", NULL, 5, "the time 1 does not come after 1"},
        {"# closed\nx,y,time\n0,0,1\n1,0,0\n1,1,2\n0,1,3\n", NULL, 4, "the time 0 does not come after 1"},
        {"x,y,time\n0,0,0\n1,0,2\n1,1,4\n0,1,1\n# closed\n1,2,3\n", NULL, 7, "the time 3 does not come after 1"},
        {"qw,qx,qy\n1,0,0\n", NULL, 1, "a quaternion needs a column 'qz'"},
        {"time,x,y,z,QX,QY,QZ\n0,0,0,0,0,0,0\n", NULL, 1, "a quaternion needs a column 'qw'"},
        {"tx,ty,tz,m11,m12,m13,m21,m22,m23,m31,m33\n0,0,0,1,0,0,0,1,0,0,1\n", NULL, 1,
         "a rotation matrix needs a column 'm32'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_bad(cases[i].text, CSV, cases[i].space, cases[i].line, cases[i].words);
    // Who says that the columns are coordinates is believed; times begin anew with every curve, and a column of points is
    // none.
    static const char *const good[] = {"qw,qx,qy\n3,4,5\n6,7,8\n", "x,y,t\n0,0,5\n\n1,1,2\n", "t,value\n1,0\n0,1\n",
                                       // Times fall from the last point of a closed curve to the first.
                                       "x,y,t\n0,0,5\n1,0,6\n1,1,8\n0,1,7\n# closed\n-1,0,5.5\n"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
    {
        bat_curve_set set = must_read(good[i], BAT_CURVE_FORMAT_AUTO, i % 2 == 1 ? "plane" : "euclidean");
        bat_curve_set_free(&set);
    }
    assert_bad("# c\n0 1 2 3 0 0 0 1\n0 1 2 3 0 0 1\n", TUM, NULL, 3, "7 columns where a trajectory has 8");
    assert_bad("", TUM, NULL, 0, "no points");
}

static void rounded_rotations_are_taken_and_projection_takes_more(void **state)
{
    (void)state;
    bat_curve_read_options options = bat_curve_read_defaults();
    options.space = "rotation";
    options.project = true;
    bat_curve_set set = {0};
    const char text[] = "qw,qx,qy,qz\n2,0,0,0\n";
    assert_int_equal(bat_curve_read_memory(text, strlen(text), &options, &set, NULL), BAT_OK);
    assert_true(set.curves[0].points[0] == 1);
    bat_curve_set_free(&set);
    set = must_read("m11,m12,m13,m21,m22,m23,m31,m32,m33\n0.8000004,-0.6,0,0.6,0.8,0,0,0,1\n", CSV, "rotation");
    assert_null(set.space->fault(set.space, set.curves[0].points));
    bat_curve_set_free(&set);
}

/// q and -q are one rotation: the reader makes a sequence of them continuous, and drops a closed curve's repeated start.
static void signs_do_not_jump(void **state)
{
    (void)state;
    bat_curve_set set = must_read("# closed\nqw,qx,qy,qz\n1,0,0,0\n-0.8,-0.6,0,0\n0.6,0.8,0,0\n-1,0,0,0\n", CSV, "rotation");
    const double expected[] = {1, 0, 0, 0, 0.8, 0.6, 0, 0, 0.6, 0.8, 0, 0};
    assert_int_equal(set.curves[0].count, 3);
    assert_memory_equal(set.curves[0].points, expected, sizeof expected);
    bat_curve_set_free(&set);
}

static bat_curve_set must_smooth(const bat_curve_set *set, const bat_motion_curves_options *options)
{
    bat_curve_set fine = {0};
    bat_error error = {0};
    if (bat_motion_curves(set, options, &fine, &error) != BAT_OK)
        fail_msg("line %zu: %s", error.line, error.text);
    return fine;
}

/// Keyframes of every kind, unevenly timed; all times are multiples of 1/8.
static const struct
{
    const char *text, *space;
} KEYFRAMES[] = {
    {"time,qw,qx,qy,qz\n0,1,0,0,0\n1,0.8,0.6,0,0\n1.5,-0.48,-0.64,-0.6,0\n4,0.5,0.5,0.5,0.5\n", "rotation"},
    {"t,rx,ry,rz,wx,wy,wz\n-1,0.1,0.2,0.3,1,0,0\n0.25,0.5,-0.4,0.3,0,1,0\n3,1,1,0.5,0,0,1\n", "rotation"},
    {"t,m11,m12,m13,m21,m22,m23,m31,m32,m33\n0,1,0,0,0,1,0,0,0,1\n0.5,0.8,-0.6,0,0.6,0.8,0,0,0,1\n"
     "2,0.8,-0.6,0,0,0,-1,0.6,0.8,0\n",
     "rotation"},
    {"time,tx,ty,tz,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n2,5,1,0,0,0,0.6,0.8\n3,9,9,9,0.5,0.5,0.5,0.5\n", "rigid"},
    {"time,xx,xy,xz,yy,yz,zz,vxx,vxy,vxz,vyy,vyz,vzz\n0,2,1,0,2,0,2,1,0,0,0,0,0\n1,3,1,1,2,0,2,0,1,0,0,0,0\n"
     "3,2,0,0,5,1,1,0,0,0,0,0,1\n",
     "spd"},
    {"time,xx,xy,yy\n0,2,1,2\n1,3,1,2\n1.125,2,0,5\n", "spd"},
    {"time,x,y,vx,vy\n0,0,0,1,0\n1,0.5,0.5,0,1\n2,0,0.75,-1,0\n", "disk"},
    {"time,x,y,z,vx,vy,vz\n0,1,0,0,0,1,0\n1,0,1,0,0,0,1\n2,0,0,1,1,0,0\n", "sphere"},
    {"time,lat,lon\n0,0,0\n1,10,20\n5,30,20\n", "sphere"},
    {"time,x,y\n0,0,0\n1,10,20\n5,30,20\n", "plane"},
};

/// Text to curve to text to curve: at the keyframes' times the curve is the keyframe, to 1e-12 in every column.
static void keyframes_come_back(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof KEYFRAMES / sizeof *KEYFRAMES; k++)
        for (int given = 0; given < 2; given++)
        {
            bat_curve_set set = must_read(KEYFRAMES[k].text, CSV, KEYFRAMES[k].space);
            bat_motion_curves_options options = bat_motion_curves_defaults();
            options.rate = 8;
            options.velocities = given == 1 && strcmp(KEYFRAMES[k].text + 5, "lat") != 0 && k != 8;
            bat_curve_set fine = must_smooth(&set, &options);
            char *text = must_write(&fine, CSV);
            bat_curve_set back = must_read(text, CSV, NULL);
            const bat_curve *keys = &set.curves[0], *smooth = &back.curves[0];
            assert_string_equal(back.space->name, KEYFRAMES[k].space);
            assert_true(bat_motion_has_times(&back));
            assert_true(bat_motion_has_velocities(&back) == (options.velocities || bat_motion_has_velocities(&set)));
            size_t time = strncmp(KEYFRAMES[k].text, "rx", 2) == 0 ? 3 : 0, dim = set.space->point_dim;
            size_t found = 0;
            for (size_t i = 0; i < smooth->count; i++)
                for (size_t j = 0; j < keys->count; j++)
                    if (smooth->channels[i * smooth->channel_count + time] == keys->channels[j * keys->channel_count + time])
                    {
                        double tolerance = k == 8 ? 1e-10 : 1e-12; // degrees have ten decimals
                        for (size_t c = 0; c < dim; c++)
                            assert_true(fabs(smooth->points[i * dim + c] - keys->points[j * dim + c]) < tolerance);
                        for (size_t c = 0; c < keys->channel_count && !options.velocities; c++)
                            assert_true(fabs(smooth->channels[i * smooth->channel_count + c] -
                                             keys->channels[j * keys->channel_count + c]) < 1e-11);
                        found++;
                    }
            assert_int_equal(found, keys->count);
            free(text);
            bat_curve_set_free(&back);
            bat_curve_set_free(&fine);
            bat_curve_set_free(&set);
        }
}

/// Neighbours on a smooth curve of quaternions are close, and times increase from first to last.
static void smooth_curves_are_continuous(void **state)
{
    (void)state;
    const char *schemes[] = {"hermite", "hermite:order=2", "hermite:order=3"};
    bat_curve_set set = must_read("time,qw,qx,qy,qz\n0,1,0,0,0\n1,-0.8,-0.6,0,0\n2,0.48,0.64,0.6,0\n3,-0.5,-0.5,-0.5,-0.5\n"
                                  "4,0.1,0.7,-0.1,0.7\n5,-0.6,0,0,0.8\n",
                                  CSV, "rotation");
    for (size_t k = 0; k <= sizeof schemes / sizeof *schemes; k++)
    {
        bat_motion_curves_options options = bat_motion_curves_defaults();
        options.scheme.levels = 6;
        if (k > 0)
            assert_int_equal(bat_motion_scheme_by_name(schemes[k - 1], &options, NULL), BAT_OK);
        else
            options.rate = 64;
        bat_curve_set fine = must_smooth(&set, &options);
        const bat_curve *curve = &fine.curves[0];
        for (size_t i = 1; i < curve->count; i++)
        {
            double apart = 0;
            for (size_t c = 0; c < 4; c++)
                apart += fabs(curve->points[4 * i + c] - curve->points[4 * i - 4 + c]);
            assert_true(apart < 0.1);
            assert_true(curve->channels[i] > curve->channels[i - 1]);
        }
        assert_true(curve->channels[0] == 0 && curve->channels[curve->count - 1] == 5);
        bat_curve_set_free(&fine);
    }
    bat_curve_set_free(&set);
}

/// A uniform rotation remains one, in points and velocities, for all times and schemes: angular velocity 1/2 about z.
static void steady_turns_have_their_velocity(void **state)
{
    (void)state;
    char text[400] = "time,rx,ry,rz\n";
    for (int i = 0; i < 5; i++)
        (void)snprintf(text + strlen(text), sizeof text - strlen(text), "%d,0,0,%g\n", i, 0.5 * i);
    bat_curve_set set = must_read(text, CSV, "rotation");
    const char *schemes[] = {"hermite", "hermite:order=3"};
    for (size_t k = 0; k < 3; k++)
    {
        bat_motion_curves_options options = bat_motion_curves_defaults();
        options.velocities = true;
        options.scheme.levels = 3;
        if (k < 2)
            assert_int_equal(bat_motion_scheme_by_name(schemes[k], &options, NULL), BAT_OK);
        else
            options.rate = 7;
        bat_curve_set fine = must_smooth(&set, &options);
        const bat_curve *curve = &fine.curves[0];
        for (size_t i = 0; i < curve->count; i++)
        {
            const double *row = curve->channels + 4 * i;
            double vector[3];
            bat_rotation_to_vector(curve->points + 4 * i, vector);
            assert_true(fabs(vector[2] - 0.5 * row[0]) < 1e-9);
            assert_true(fabs(row[1]) < 1e-9 && fabs(row[2]) < 1e-9 && fabs(row[3] - 0.5) < 1e-8);
        }
        bat_curve_set_free(&fine);
    }
    bat_curve_set_free(&set);
}

/// Steps of 100 degrees are followed, at the ends and by both orders.
static void large_steps_are_followed(void **state)
{
    (void)state;
    const double speed = 100 * 0.017453292519943295;
    char text[600] = "time,qw,qx,qy,qz\n";
    for (int i = 0; i < 6; i++)
        (void)snprintf(text + strlen(text), sizeof text - strlen(text), "%d,%.17g,0,0,%.17g\n", i, cos(speed * i / 2),
                       sin(speed * i / 2));
    bat_curve_set set = must_read(text, CSV, "rotation");
    for (size_t order = 2; order <= 4; order += 2)
    {
        bat_motion_curves_options options = bat_motion_curves_defaults();
        options.rate = 3;
        options.tangent_order = order;
        options.velocities = true;
        bat_curve_set fine = must_smooth(&set, &options);
        for (size_t i = 0; i < fine.curves[0].count; i++)
            assert_true(fabs(fine.curves[0].channels[4 * i + 3] - speed) < 1e-9);
        bat_curve_set_free(&fine);
    }
    bat_curve_set_free(&set);
}

static void assert_refused(const char *text, const char *space, const bat_motion_curves_options *options, bat_status status,
                           size_t line, const char *words)
{
    bat_curve_set set = must_read(text, BAT_CURVE_FORMAT_AUTO, space), fine = {0};
    bat_error error = {0};
    assert_int_equal(bat_motion_curves(&set, options, &fine, &error), status);
    assert_int_equal(error.line, line);
    if (strstr(error.text, words) == NULL)
        fail_msg("'%s' lacks '%s'", error.text, words);
    assert_null(fine.curves);
    assert_int_equal(bat_motion_curves(&set, options, &fine, NULL), status);
    bat_curve_set_free(&set);
}

/// Times, points and velocities as they are in the columns; what is not there is estimated.
static void a_curve_has_its_data(void **state)
{
    (void)state;
    const char *timed = "# closed\nvy,x,time,y,vx\n0.5,1,10,2,3\n-1,4,12,5,6\n0,7,13,9,8\n";
    bat_curve_set set = must_read(timed, CSV, "plane");
    bat_motion_curves_options options = bat_motion_curves_defaults();
    bat_hermite_curve keys;
    options.rate = 5;
    assert_int_equal(bat_motion_data(&set, 0, &options, &keys, NULL), BAT_OK);
    const double points[] = {1, 2, 4, 5, 7, 9}, velocities[] = {3, 0.5, 6, -1, 8, 0}, times[] = {10, 12, 13};
    assert_true(keys.space == set.space && keys.count == 3 && keys.closed && keys.closing_time == 1.5);
    assert_memory_equal(keys.points, points, sizeof points);
    assert_memory_equal(keys.tangents, velocities, sizeof velocities);
    assert_memory_equal(keys.times, times, sizeof times);
    bat_hermite_free(&keys);
    // Hermite schemes take directions, splines velocities.
    bat_motion_curves_options refined = bat_motion_curves_defaults();
    refined.method = BAT_MOTION_METHOD_HERMITE;
    assert_int_equal(bat_motion_data(&set, 0, NULL, &keys, NULL), BAT_OK);
    assert_memory_equal(keys.tangents, velocities, sizeof velocities);
    bat_hermite_free(&keys);
    assert_int_equal(bat_motion_data(&set, 0, &refined, &keys, NULL), BAT_OK);
    for (size_t i = 0; i < 3; i++)
    {
        const double *given = velocities + 2 * i, *made = keys.tangents + 2 * i;
        assert_true(fabs(hypot(made[0], made[1]) - 1) < 1e-15);
        assert_true(fabs(made[0] * given[1] - made[1] * given[0]) < 1e-14 && made[0] * given[0] > 0);
    }
    bat_hermite_free(&keys);
    bat_curve_set_free(&set);
    // Of a parabola, order 2 finds the derivatives at the times, whatever their spacing.
    set = must_read("t,x,y\n0,0,0\n1,1,1\n3,3,9\n", CSV, "plane");
    assert_int_equal(bat_motion_data(&set, 0, &options, &keys, NULL), BAT_OK);
    for (size_t i = 0; i < 3; i++)
        assert_true(fabs(keys.tangents[2 * i] - 1) < 1e-14 && fabs(keys.tangents[2 * i + 1] - 2 * keys.times[i]) < 1e-13);
    bat_hermite_free(&keys);
    bat_curve_set_free(&set);
}

/// Files cannot hold them, but a set of curves can.
static void times_must_increase(void **state)
{
    (void)state;
    bat_curve_set set =
                      must_read("time,qw,qx,qy,qz\n0,1,0,0,0\n1,0.8,0.6,0,0\n2,0.6,0.8,0,0\n", BAT_CURVE_FORMAT_AUTO, NULL),
                  fine = {0};
    bat_motion_curves_options sampled = bat_motion_curves_defaults();
    bat_error error;
    sampled.rate = 4;
    set.curves[0].channels[2] = 1;
    assert_int_equal(bat_motion_curves(&set, &sampled, &fine, &error), BAT_INVALID_POINT);
    assert_int_equal(error.line, 4);
    assert_non_null(strstr(error.text, "the time 1 does not come after 1"));
    assert_null(fine.curves);
    bat_curve_set_free(&set);
}

static void bad_keyframes_name_their_lines(void **state)
{
    (void)state;
    bat_motion_curves_options sampled = bat_motion_curves_defaults(), refined = sampled;
    sampled.rate = 4;
    refined.method = BAT_MOTION_METHOD_HERMITE;
    const char header[] = "time,qw,qx,qy,qz\n";
    char text[200];
#define ROWS(rows) (snprintf(text, sizeof text, "%s%s", header, rows), text)
    assert_refused(ROWS("0,1,0,0,0\n"), "rotation", &sampled, BAT_INVALID_ARGUMENT, 0, "needs at least 2 points");
    assert_refused(ROWS("0,1,0,0,0\n# half a turn\n1,0,1,0,0\n"), "rotation", &sampled, BAT_CUT_LOCUS, 4, "lines 2 and 4");
    assert_refused(ROWS("0,1,0,0,0\n1,-1,0,0,0\n"), "rotation", &refined, BAT_INVALID_POINT, 3, "lines 2 and 3");
    assert_refused("x,y,time,height\n0,0,0,5\n1,1,1,6\n", "plane", &sampled, BAT_UNSUPPORTED, 0, "other columns");
    assert_refused("qw,qx,qy,qz,wx,wy,wz\n1,0,0,0,1,0,0\n0.8,0.6,0,0,0,0,0\n", "rotation", NULL, BAT_INVALID_POINT, 3,
                   "no direction");
#undef ROWS
}

/// A set with times is sampled in time: at parts of its intervals, at a rate, or at given times; all are one motion.
static void timed_keyframes_become_a_motion_in_time(void **state)
{
    (void)state;
    bat_curve_set set = must_read("0 0 0 0 0 0 0 1\n1 1 2 3 0 0 0.6 0.8\n4 4 2 3 0 0.6 0 0.8\n6 5 5 5 0 0 0 1\n", TUM, NULL);
    bat_motion_curves_options options = bat_motion_curves_defaults();
    assert_int_equal(bat_motion_method_for(&set, NULL), BAT_MOTION_METHOD_SPLINE);
    options.scheme.levels = 2;
    bat_curve_set parts = must_smooth(&set, &options);
    const double times[] = {0, 0.25, 0.5, 0.75, 1, 1.75, 2.5, 3.25, 4, 4.5, 5, 5.5, 6};
    assert_int_equal(parts.curves[0].count, 13);
    for (size_t i = 0; i < 13; i++)
        assert_true(parts.curves[0].channels[i] == times[i]);
    options.times = times;
    options.time_count = 13;
    bat_curve_set given = must_smooth(&set, &options);
    assert_memory_equal(given.curves[0].points, parts.curves[0].points, 13 * 7 * sizeof(double));
    bat_error error;
    const double outside[] = {1, 7.5}, falling[] = {1, 0.5};
    bat_curve_set none;
    options.time_count = 2;
    options.times = outside;
    assert_int_equal(bat_motion_curves(&set, &options, &none, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "time 7.5 is not within those of the motion, 0 to 6"));
    options.times = falling;
    assert_int_equal(bat_motion_curves(&set, &options, &none, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "0.5, does not come after 1"));
    options.times = NULL;
    options.time_count = 0;
    options.rate = 1e12;
    assert_int_equal(bat_motion_curves(&set, &options, &none, &error), BAT_TOO_LARGE);
    assert_non_null(strstr(error.text, "6000000000001 points"));
    bat_curve_set_free(&given);
    bat_curve_set_free(&parts);
    bat_curve_set_free(&set);
}

/// Messages and files have as many digits of times as identify them.
static void times_keep_their_digits(void **state)
{
    (void)state;
    bat_curve_set set = must_read("1305031098.6659 0 0 0 0 0 0 1\n1305031098.6758 1 2 3 0 0 0.6 0.8\n", TUM, NULL);
    bat_motion_curves_options options = bat_motion_curves_defaults();
    bat_error error;
    bat_curve_set none;
    const double before = 0.6;
    assert_int_equal(bat_curve_set_time_origin(&set), 1305031098);
    options.times = &before;
    options.time_count = 1;
    assert_int_equal(bat_motion_curves(&set, &options, &none, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "time 0.6 is not within"));
    assert_non_null(strstr(error.text, "0.6659 to 0.6758"));
    bat_curve_set_free(&set);
}

/// A rate reaches the last keyframe also where times since 1970 are rounded to a quarter of a microsecond.
static void rates_reach_the_last_keyframe(void **state)
{
    (void)state;
    char text[200];
    double points[3];
    bat_motion_curves_options options = bat_motion_curves_defaults();
    options.rate = 10;
    for (int i = 0; i < 100; i++)
    {
        int length = 0;
        for (int k = 0; k < 3; k++)
            length += snprintf(text + length, sizeof text - (size_t)length, "%d.%04d %d 0 0 0 0 0 1\n", 1305031102 + 7 * i,
                               97 * i % 7000 + 1000 * k, k);
        bat_curve_set set = must_read(text, TUM, NULL), made = must_smooth(&set, &options);
        assert_int_equal(made.curves[0].count, 3);
        assert_true(fabs(made.curves[0].points[14] - 2) < 1e-12);
        for (int k = 0; k < 3; k++) // the same times without an origin
            points[k] = set.curves[0].channels[k] + (double)bat_curve_set_time_origin(&set);
        memcpy(set.curves[0].channels, points, sizeof points);
        bat_curve_set_free(&made);
        made = must_smooth(&set, &options);
        assert_int_equal(made.curves[0].count, 3);
        bat_curve_set_free(&made);
        bat_curve_set_free(&set);
    }
}

static void files_of_times_are_read(void **state)
{
    (void)state;
    const struct
    {
        const char *text;
        size_t line;
        const char *words;
    } bad[] = {{"0\n1\n0.5\n", 3, "the time 0.5 does not come after 1"},
               {"# t\n\n0 1\n", 3, "a line has one number"},
               {"time\n0\ntime\n", 3, "not a time"},
               {"# none\n", 0, "no times"},
               {"nan\n", 1, "not a time"}};
    const char *path = "times-of-a-test.txt";
    double *times;
    size_t count;
    bat_error error;
    for (size_t i = 0; i <= sizeof bad / sizeof *bad; i++)
    {
        bool good = i == sizeof bad / sizeof *bad;
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        (void)fputs(good ? "time\r\n-1\n\n# c\n 0.5 \n1e3" : bad[i].text, file);
        assert_int_equal(fclose(file), 0);
        error = (bat_error){.line = 0};
        bat_status status = bat_motion_times_read(path, NULL, &times, &count, &error);
        assert_int_equal(status, good ? BAT_OK : BAT_BAD_FILE);
        if (good)
            continue;
        assert_int_equal(error.line, bad[i].line);
        assert_non_null(strstr(error.text, bad[i].words));
    }
    assert_int_equal(count, 3);
    assert_true(times[0] == -1 && times[1] == 0.5 && times[2] == 1000);
    free(times);
    // Rates of EuRoC: nanoseconds, names in a comment, and accelerations that do not matter.
    double *rates;
    for (int bad_row = 0; bad_row < 2; bad_row++)
    {
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        (void)fputs("#timestamp [ns],w_RS_S_x [rad s^-1],y,z,a\n1403636579758555392,1,2,3,9\n", file);
        (void)fputs(bad_row ? "1403636579763555392,4,5\n" : "1403636579763555392,4,-5,6e-1,9\n", file);
        assert_int_equal(fclose(file), 0);
        bat_status status = bat_motion_rates_read(path, NULL, &times, &rates, &count, &error);
        assert_int_equal(status, bad_row ? BAT_BAD_FILE : BAT_OK);
        if (bad_row)
            assert_int_equal(error.line, 3);
    }
    assert_int_equal(count, 2);
    assert_true(fabs(times[1] - times[0] - 0.005) < 1e-6);
    assert_true(rates[0] == 1 && rates[4] == -5 && rates[5] == 0.6);
    free(times);
    free(rates);
    // Accelerations beside them, where three columns more are numbers.
    static const struct
    {
        const char *header, *row;
        bool told;
    } headers[] = {{"#timestamp [ns],w_RS_S_x,w_RS_S_y,w_RS_S_z,a_RS_S_x [m s^-2],a_RS_S_y,a_RS_S_z\n", "4,5,6", true},
                   {"time,wx,wy,wz,ax,ay,az,temperature\n", "4,5,6,warm", true},
                   {"", "4,5,6", true},
                   {"time,wx,wy,wz,place,x,y\n", "here,5,6", false},
                   {"", "4,5", false}};
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++)
    {
        bat_motion_gyro gyro;
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        (void)fprintf(file, "%s1,1,2,3,%s\n2,1,2,3,7,8,9,0\n", headers[i].header, headers[i].row);
        assert_int_equal(fclose(file), 0);
        assert_int_equal(bat_motion_gyro_read(path, NULL, &gyro, NULL), BAT_OK);
        assert_int_equal(gyro.count, 2);
        assert_true(gyro.rates[5] == 3 && (gyro.forces != NULL) == headers[i].told);
        assert_true(!headers[i].told || (gyro.forces[0] == 4 && gyro.forces[5] == 9));
        bat_motion_gyro_free(&gyro);
    }
    (void)remove(path);
}

/// Failures tell the times of the file, or the origin that they count from.
static void failures_tell_the_times_of_files(void **state)
{
    (void)state;
    static const char late[] =
        "1311868171.131477 0 0 0 0 0 0 1\n1311868173.5 2 0 1 0 0 0 1\n1311868172.331406 1 0 0 0 0 0 1\n";
    assert_bad(late, TUM, NULL, 3, "1311868172.331406000 does not come after 1311868173.500000000");
    char text[600] = "";
    for (size_t i = 0; i < 8; i++)
        (void)snprintf(text + strlen(text), sizeof text - strlen(text), "131186817%zu 0 0 0 0 0 0 1\n", i);
    bat_curve_set set = must_read(text, TUM, NULL), fine;
    const double times[] = {1, 2, 3}, rates[9] = {0};
    const bat_motion_gyro gyro = {.times = times, .rates = rates, .count = 3};
    bat_motion_curves_options options = bat_motion_curves_defaults();
    bat_error error;
    options.spline.gyro = &gyro;
    assert_int_equal(bat_motion_curves(&set, &options, &fine, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "1 to 3, do not cover the keys, 0 to 7 (times from 1311868170 on)"));
    bat_curve_set_free(&set);
}

/// The header of a table of rates tells its columns and their units; a repeated time is left out, and noted.
static void names_tell_rates(void **state)
{
    (void)state;
    static const struct
    {
        const char *text;
        double forces; ///< the first; 0: there are none
        size_t line;   ///< of a failure
        const char *words;
    } cases[] = {
        {"time,ax,ay,az,gx,gy,gz\n1,4,5,6,1,2,3\n2,7,8,9,4,5,6\n", 4, 0, NULL},
        {"gx [deg/s];gy [deg/s];gz [deg/s];t [ms];ax [g];ay [g];az [g]\n"
         "57.29577951308232;114.59155902616465;171.88733853924697;1000;1;0;0\n4;5;6;2000;0;0;0\n",
         9.80665, 0, NULL},
        {"#time,gx [deg/s],gy [deg/s],gz [deg/s]\n1,57.29577951308232,114.59155902616465,171.88733853924697\n2,4,5,6\n", 0,
         0, NULL},
        {"time,wx,wy,wz\n1,1,2,3\n1,7,7,7\n2,4,5,6\n2,7,7,7\n", 0, 0,
         "2 rows of rates with the time of the row before left "
         "out, the first on line 3"},
        {"time,gx,gy,gz,temperature\n1,1,2,3,36\n2,4,5,6,36\n", 0, 0, NULL},
        {"header.stamp.secs,header.stamp.nsecs,orientation.x,angular_velocity.x,angular_velocity.y,angular_velocity.z,"
         "linear_acceleration.x,linear_acceleration.y,linear_acceleration.z\n1,0,0,1,2,3,4,5,6\n2,0,0,4,5,6,7,8,9\n",
         4, 0, NULL},
        {"time,a1,a2,a3,g1,g2,g3\n1,4,5,6,1,2,3\n", 0, 1, "gx, gy, gz, and accelerations ax, ay, az or none: time,a1,a2"},
        {"time,gx [rpm],gy [rpm],gz [rpm]\n1,1,2,3\n", 0, 1, "rad/s or deg/s"},
        {"time,gx,gy,gz\n1,1,2,3\n2,1,2\n", 0, 3, "3 columns, but the header has 4"},
    };
    const char *path = "rates-of-a-test.csv";
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_motion_gyro gyro;
        bat_error error;
        bat_curve_set set = must_read("0 1 2 3 0 0 0 1\n1 1 2 3 0 0 0 1\n", TUM, NULL);
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        (void)fputs(cases[i].text, file);
        assert_int_equal(fclose(file), 0);
        bat_status status = bat_motion_gyro_read(path, &set, &gyro, &error);
        assert_int_equal(status, cases[i].line > 0 ? BAT_BAD_FILE : BAT_OK);
        if (cases[i].line > 0)
        {
            assert_int_equal(error.line, cases[i].line);
            assert_non_null(strstr(error.text, cases[i].words));
            bat_curve_set_free(&set);
            continue;
        }
        assert_int_equal(gyro.count, 2);
        assert_true(gyro.times[0] == 1 && gyro.times[1] == 2);
        for (size_t c = 0; c < 3; c++)
            assert_true(fabs(gyro.rates[c] - (double)(c + 1)) < 1e-14);
        assert_true((gyro.forces != NULL) == (cases[i].forces > 0));
        assert_true(gyro.forces == NULL || gyro.forces[0] == cases[i].forces);
        bool told = cases[i].words == NULL;
        const char *note;
        for (size_t j = 0; (note = bat_curve_set_note(&set, j)) != NULL; j++)
            told = told || strcmp(note, cases[i].words) == 0;
        assert_true(told);
        bat_motion_gyro_free(&gyro);
        bat_curve_set_free(&set);
    }
    (void)remove(path);
}

/// A motion with times may rest.
static void motions_may_rest(void **state)
{
    (void)state;
    bat_motion_curves_options options = bat_motion_curves_defaults();
    options.rate = 4;
    bat_curve_set set = must_read("0 1 2 3 0 0 0 1\n1 1 2 3 0 0 0 1\n2 4 2 3 0 0 0.6 0.8\n", TUM, NULL);
    bat_curve_set fine = must_smooth(&set, &options);
    assert_int_equal(fine.curves[0].count, 9);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&set);
}

/// Quaternions, matrices and rotation vectors of the same keyframes give the same motion.
static void forms_agree(void **state)
{
    (void)state;
    const char *texts[] = {
        "time,qw,qx,qy,qz\n0,1,0,0,0\n1,0.8,0.6,0,0\n3,0.5,0.5,0.5,0.5\n",
        "m11,m12,m13,m21,m22,m23,m31,m32,m33,time\n1,0,0,0,1,0,0,0,1,0\n1,0,0,0,0.28,-0.96,0,0.96,0.28,1\n"
        "0,0,1,1,0,0,0,1,0,3\n",
    };
    bat_curve_set fine[2];
    for (size_t i = 0; i < 2; i++)
    {
        bat_motion_curves_options options = bat_motion_curves_defaults();
        options.rate = 5;
        bat_curve_set set = must_read(texts[i], CSV, "rotation");
        fine[i] = must_smooth(&set, &options);
        bat_curve_set_free(&set);
    }
    assert_int_equal(fine[0].curves[0].count, 16);
    for (size_t i = 0; i < 16; i++)
        assert_true(turn(fine[0].curves[0].points + 4 * i, fine[1].curves[0].points + 4 * i) < 1e-14);
    bat_curve_set_free(&fine[0]);
    bat_curve_set_free(&fine[1]);
}

/// Velocities in files are dA/dt and dz/dt: they agree with differences of the sampled curve's columns.
static void velocities_are_derivatives_of_the_columns(void **state)
{
    (void)state;
    const struct
    {
        const char *text, *space;
        size_t dim;
    } cases[] = {{"time,xx,xy,yy\n0,2,1,2\n1,3,1,2\n2,2,0,5\n", "spd", 3},
                 {"time,x,y\n0,0.1,0.2\n1,0.5,0.5\n2,0,0.75\n", "disk", 2},
                 {"time,x,y,z\n0,1,0,0\n1,0,1,0\n2,0,0,1\n", "sphere", 3}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    {
        bat_motion_curves_options options = bat_motion_curves_defaults();
        options.rate = 1000;
        options.velocities = true;
        bat_curve_set set = must_read(cases[k].text, CSV, cases[k].space), fine = must_smooth(&set, &options);
        const bat_curve *curve = &fine.curves[0];
        size_t dim = cases[k].dim;
        assert_int_equal(curve->channel_count, 1 + dim);
        for (size_t i = 1; i + 1 < curve->count; i++)
            for (size_t c = 0; c < dim && i % 1000 != 0; c++)
            {
                double slope = 500 * (curve->points[(i + 1) * dim + c] - curve->points[(i - 1) * dim + c]);
                assert_true(fabs(slope - curve->channels[i * (1 + dim) + 1 + c]) < 1e-3);
            }
        bat_curve_set_free(&fine);
        bat_curve_set_free(&set);
    }
}

static void names_of_schemes(void **state)
{
    (void)state;
    const char *bad[] = {"hermite:order=0", "hermite:order=2.5",   "hermite:order=11", "hermite:rate=3", "hermite:order",
                         "hermite-merrien", "hermite:base=vertex", "hermit",           "hermite-",       "hermite:order=3,"};
    bat_motion_curves_options options = bat_motion_curves_defaults();
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(bat_motion_scheme_by_name(bad[i], &options, NULL), BAT_INVALID_ARGUMENT);
    const bat_choice *choice;
    size_t count = 0;
    for (; (choice = bat_choices(&bat_motion_scheme_family, count)) != NULL; count++)
        assert_int_equal(bat_motion_scheme_by_name(choice->name, &options, NULL), BAT_OK);
    assert_int_equal(count, 2);
    assert_int_equal(bat_motion_scheme_by_name("hermite:order=7", &options, NULL), BAT_OK);
    assert_int_equal(options.scheme.order, 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rotations_have_three_forms),
        cmocka_unit_test(names_alone_imply_rotations_and_poses),
        cmocka_unit_test(written_columns_are_those_that_were_read),
        cmocka_unit_test(trajectories_have_the_scalar_last),
        cmocka_unit_test(bad_columns_name_the_line),
        cmocka_unit_test(rounded_rotations_are_taken_and_projection_takes_more),
        cmocka_unit_test(signs_do_not_jump),
        cmocka_unit_test(keyframes_come_back),
        cmocka_unit_test(smooth_curves_are_continuous),
        cmocka_unit_test(steady_turns_have_their_velocity),
        cmocka_unit_test(large_steps_are_followed),
        cmocka_unit_test(a_curve_has_its_data),
        cmocka_unit_test(times_must_increase),
        cmocka_unit_test(bad_keyframes_name_their_lines),
        cmocka_unit_test(timed_keyframes_become_a_motion_in_time),
        cmocka_unit_test(times_keep_their_digits),
        cmocka_unit_test(rates_reach_the_last_keyframe),
        cmocka_unit_test(files_of_times_are_read),
        cmocka_unit_test(names_tell_rates),
        cmocka_unit_test(failures_tell_the_times_of_files),
        cmocka_unit_test(motions_may_rest),
        cmocka_unit_test(forms_agree),
        cmocka_unit_test(motions_are_manifolds_in_time),
        cmocka_unit_test(the_weight_of_translations_is_read),
        cmocka_unit_test(velocities_are_derivatives_of_the_columns),
        cmocka_unit_test(names_of_schemes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
