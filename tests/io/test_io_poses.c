// Trajectories by their content: TUM, EuRoC, KITTI, and tables of poses with names in use.

#include "test_io_helpers.h"

#include "batten/motion.h"
#include "batten/space.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static const bat_curve_format AUTO = BAT_CURVE_FORMAT_AUTO;

/// The poses (1, 2, 3) without a turn, and with a quarter turn about z.
static void assert_poses(const bat_curve_set *set, double first, double second)
{
    const double half = sqrt(0.5), expected[2][7] = {{1, 2, 3, 1, 0, 0, 0}, {1, 2, 3, half, 0, 0, half}};
    assert_string_equal(set->space->name, "rigid");
    assert_int_equal(set->curves[0].count, 2);
    for (size_t i = 0; i < 2; i++)
        for (size_t j = 0; j < 7; j++)
            assert_true(fabs(set->curves[0].points[7 * i + j] - expected[i][j]) < 1e-6);
    assert_true(bat_motion_has_times(set));
    double origin = (double)bat_curve_set_time_origin(set);
    assert_true(origin + set->curves[0].channels[0] == first);
    assert_true(origin + set->curves[0].channels[1] == second);
}

static void poses_are_recognized(void **state)
{
    (void)state;
    static const struct
    {
        const char *text, *note;
        double first, second;
    } cases[] = {
        {"# any\n10 1 2 3 0 0 0 1\n10.5 1 2 3 0 0 0.7071068 0.7071068\n", "TUM", 10, 10.5},
        {"#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], b_x []\n"
         "1403715524907143168,1,2,3,1,0,0,0,9\n1403715524912143104,1,2,3,0.7071068,0,0,0.7071068,9\n",
         "EuRoC", 1403715524.907143168, 1403715524.912143104},
        {"1403715524907143168,1,2,3,1,0,0,0\n1403715524912143104,1,2,3,0.7071068,0,0,0.7071068\n", "EuRoC",
         1403715524.907143168, 1403715524.912143104},
        {"1 0 0 1 0 1 0 2 0 0 1 3\n0 -1 0 1 1 0 0 2 0 0 1 3\n", "KITTI", 0, 1},
        {"header.stamp.sec,header.stamp.nanosec,pose.position.x,pose.position.y,pose.position.z,pose.orientation.x,"
         "pose.orientation.y,pose.orientation.z,pose.orientation.w\n"
         "10,5,1,2,3,0,0,0,1\n10,500000005,1,2,3,0,0,0.7071068,0.7071068\n",
         "seconds and nanoseconds", 10.000000005, 10.500000005},
        {"t [ms];x [m];y [m];z [m];roll [deg];pitch [deg];yaw [deg]\n0;1;2;3;0;0;0\n1500;1;2;3;0;0;90\n", "zyx", 0, 1.5},
        {"time,x,y,z,roll_rad,pitch_rad,yaw_rad\n0,1,2,3,0,0,0\n2,1,2,3,0,0,1.5707963267948966\n", "radians", 0, 2},
        {"timestamp,x,y,z,qw,qx,qy,qz\n1400000000000,1,2,3,1,0,0,0\n1400000000500,1,2,3,0.7071068,0,0,0.7071068\n",
         "milliseconds", 1400000000, 1400000000.5},
        {"time,x,y,z,qw,qx,qy,qz\n1970-01-01T00:00:00Z,1,2,3,1,0,0,0\n1970-01-01T00:00:02.5Z,1,2,3,0.7071068,0,0,0."
         "7071068\n",
         "quaternions", 0, 2.5},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_curve_set set = must_read(cases[i].text, AUTO, NULL);
        assert_poses(&set, cases[i].first, cases[i].second);
        bool told = false;
        const char *note;
        for (size_t j = 0; (note = bat_curve_set_note(&set, j)) != NULL; j++)
            told = told || strstr(note, cases[i].note) != NULL;
        assert_true(told);
        bat_curve_set_free(&set);
    }
}

/// Strict reading refuses what is left out else: repeated times and columns that are no part of a motion.
static void strict_reading_leaves_nothing_out(void **state)
{
    (void)state;
    static const char *const texts[] = {"6 1 2 3 0 0 0 1\n6 1 2 3 0 0 0 1\n7 1 2 3 0 0 0 1\n",
                                        "stamp,x,y,z,qw,qx,qy,qz,mood\n1,1,2,3,1,0,0,0,4\n2,1,2,3,1,0,0,0,5\n",
                                        "time,x,y,mood\n1,1,2,3\n2,1,3,4\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        for (int strict = 0; strict < 2; strict++)
        {
            bat_curve_read_options options = bat_curve_read_defaults();
            bat_curve_set set = {0}, fine = {0};
            bat_error error;
            options.motion = true;
            options.strict = strict == 1;
            bat_status status = bat_curve_read_memory(texts[i], strlen(texts[i]), &options, &set, &error);
            if (status == BAT_OK)
                status = bat_motion_curves(&set, NULL, &fine, &error);
            assert_true((status == BAT_OK) == !strict);
            bat_curve_set_free(&set);
            bat_curve_set_free(&fine);
        }
}

/// A repeated stamp, a stamp out of order or a bad quaternion does not make a trajectory points of R^8.
static void an_odd_row_leaves_a_trajectory(void **state)
{
    (void)state;
    static const char header[] = "# timestamp tx ty tz qx qy qz qw\n", first[] = "5.5 0 0 0 0 0 0 1\n6 1 0 0 0 0 0 1\n";
    char text[200];
    for (int named = 0; named < 2; named++)
    {
        const char *names = named ? header : "";
        size_t line = named ? 4 : 3;
        (void)snprintf(text, sizeof text, "%s%s6 1.2 0 0 0 0 0 1\n7 2 0 1 0 0 0 1\n", names, first);
        bat_curve_set set = must_read(text, AUTO, NULL);
        assert_string_equal(set.space->name, "rigid");
        assert_int_equal(set.curves[0].count, 3);
        assert_non_null(strstr(bat_curve_set_note(&set, 0), "the time of the row before"));
        bat_curve_set_free(&set);
        (void)snprintf(text, sizeof text, "%s%s5.7 2 0 1 0 0 0 1\n", names, first);
        assert_bad(text, AUTO, NULL, line, "does not come after");
        (void)snprintf(text, sizeof text, "%s%s7 2 0 1 0 0 0 0\n", names, first);
        assert_bad(text, AUTO, NULL, line, "the quaternion is zero");
        // Without names, rows of which none is a pose stay numbers.
        (void)snprintf(text, sizeof text, "%s1 0 0 0 0 0 0 2\n2 1 0 0 0 0 0 2\n", names);
        if (named)
            assert_bad(text, AUTO, NULL, 2, "unit length");
        else
        {
            set = must_read(text, AUTO, NULL);
            assert_string_equal(set.space->name, "euclidean");
            bat_curve_set_free(&set);
        }
    }
}

static void turns_follow_the_order(void **state)
{
    (void)state;
    // By scipy's Rotation.from_euler('ZYX', [30, 20, 10]) and ('XYZ', [10, 20, 30]), in degrees.
    static const double expected[2][4] = {{0.95154852, 0.03813458, 0.18930786, 0.23929834},
                                          {0.94371436, 0.12767944, 0.14487813, 0.26853582}};
    static const char *const orders[] = {"zyx,degrees", "xyz,degrees"};
    static const char text[] = "time,roll,pitch,yaw\n0,10,20,30\n";
    for (int i = 0; i < 2; i++)
    {
        bat_curve_read_options options = bat_curve_read_defaults();
        bat_curve_set set = {0};
        bat_error error;
        options.euler = orders[i];
        assert_int_equal(bat_curve_read_memory(text, strlen(text), &options, &set, &error), BAT_OK);
        for (int j = 0; j < 4; j++)
            assert_true(fabs(set.curves[0].points[j] - expected[i][j]) < 1e-8);
        bat_curve_set_free(&set);
        options.euler = "zyz";
        assert_int_equal(bat_curve_read_memory(text, strlen(text), &options, &set, &error), BAT_INVALID_ARGUMENT);
    }
}

static void doubtful_poses_are_refused(void **state)
{
    (void)state;
    assert_bad("time,roll,pitch,yaw\n0,10,20,30\n", AUTO, NULL, 1, "; euler names it");
    assert_bad("time,roll_deg,pitch_deg,yaw_rad\n0,10,20,30\n", AUTO, NULL, 1, "different units");
    assert_bad("0,1,2,3,1,0,0,0\n1,1,2,3,1,0,0,0\n", AUTO, NULL, 0, "; read.format tum");
    assert_bad("1 0 0 1 0 1 0 2 0 0 1 3\n\n1 0 0 1 0 1 0 2 0 0 1.1 3\n", AUTO, NULL, 3, "no rotation");
    assert_bad("1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 1 0 1 0 2\n", AUTO, NULL, 2, "12 numbers");
    assert_bad("sec,nsec,x,y,z,qw,qx,qy,qz\n1,1000000000,1,2,3,1,0,0,0\n", AUTO, NULL, 2, "out of range");
    assert_bad("sec,x,y,z,qw,qx,qy,qz\n1,1,2,3,1,0,0,0\n", AUTO, NULL, 1, "only one column");
    assert_bad("stamp,pos_x,x,y,z,qw,qx,qy,qz\n1,0,1,2,3,1,0,0,0\n", AUTO, NULL, 1, "another one");
    assert_bad("stamp,x,y,z,qw,qx,qy,qz\n1,1,2,3,1,0,0,0\n2,1,two,3,1,0,0,0\n", AUTO, NULL, 3, "'two'");
    assert_bad("stamp,x,y,z,qw,qx,qy,qz\n1,1,2,3,1,0,0,0\n2,1,2,3,1,1,0,0\n", AUTO, NULL, 3, "unit length");
}

static void other_tables_stay_as_they_are(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "1 2 3 4 5 6 7 8\n2 3 4 5 6 7 8 9\n", // no quaternion
        "3 1 2 3 0 0 0 1\n1 1 2 3 0 0 0 1\n", // times that do not increase
        "lon,lat,roll,pitch,yaw\n1,2,3,4,5\n2,3,4,5,6\n",
        "x,y,yaw\n1,2,3\n2,3,4\n",
    };
    static const char *const spaces[] = {"euclidean", "euclidean", "sphere", "plane"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    {
        bat_curve_set set = must_read(texts[i], AUTO, NULL);
        assert_string_equal(set.space->name, spaces[i]);
        bat_curve_set_free(&set);
    }
    bat_curve_set set = must_read("10 1 2 3 0 0 0 1\n11 1 2 3 0 0 0 1\n", BAT_CURVE_FORMAT_CSV, NULL);
    assert_string_equal(set.space->name, "euclidean");
    bat_curve_set_free(&set);
}

/// Stamps of nanoseconds, and dates, come back digit by digit, also between formats.
static void stamps_keep_their_digits(void **state)
{
    (void)state;
    static const char euroc[] = "1403715524907143168,1,2,3,1,0,0,0\n1403715524912143105,1,2,3,1,0,0,0\n"
                                "1403799999500000000,1,2,3,1,0,0,0\n";
    static const char *const seconds[] = {"1403715524.907143168", "1403715524.912143105", "1403799999.500000000"};
    static const char *const stamps[] = {"1403715524907143168", "1403715524912143105", "1403799999500000000"};
    bat_curve_set set = must_read(euroc, AUTO, NULL);
    assert_true(bat_curve_set_time_origin(&set) == 1403715524);
    assert_true(set.curves[0].channels[0] == 0.907143168);
    char *text = must_write(&set, BAT_CURVE_FORMAT_TUM);
    bat_curve_set again = must_read(text, BAT_CURVE_FORMAT_TUM, NULL);
    char *back = must_write(&again, BAT_CURVE_FORMAT_EUROC), *table = must_write(&again, BAT_CURVE_FORMAT_CSV);
    for (size_t i = 0; i < 3; i++)
    {
        assert_non_null(strstr(text, seconds[i]));
        assert_non_null(strstr(back, stamps[i]));
        assert_non_null(strstr(table, seconds[i]));
    }
    free(text);
    free(back);
    free(table);
    bat_curve_set_free(&set);
    bat_curve_set_free(&again);
}

/// Seconds since 1970 come back digit by digit, whether the format is named or recognized.
static void seconds_keep_their_digits(void **state)
{
    (void)state;
    static const char text[] = "1311868171.131477 0 0 0 0 0 0 1\n1311868172.331406 1 0 0 0 0 0 1\n";
    static const bat_curve_format formats[] = {BAT_CURVE_FORMAT_TUM, BAT_CURVE_FORMAT_AUTO};
    for (size_t i = 0; i < 2; i++)
    {
        bat_curve_set set = must_read(text, formats[i], NULL);
        assert_true(bat_curve_set_time_origin(&set) == 1311868171);
        char *trajectory = must_write(&set, BAT_CURVE_FORMAT_TUM), *table = must_write(&set, BAT_CURVE_FORMAT_CSV);
        assert_non_null(strstr(trajectory, "\n1311868171.131477000 0 "));
        assert_non_null(strstr(trajectory, "\n1311868172.331406000 1 "));
        assert_non_null(strstr(table, "\n1311868171.131477000,"));
        free(trajectory);
        free(table);
        bat_curve_set_free(&set);
    }
    // With an exponent, as numpy writes it, in tables that are translated and in trajectories.
    static const char *const exponents[] = {
        "1.311868171131477118e+09 0 0 0 0 0 0 1\n1.311868172331406116e+09 1 0 0 0 0 0 1\n",
        "time,x,y,z,qw,qx,qy,qz\n1.311868171131477118e+09,0,0,0,1,0,0,0\n1.311868172331406116e+09,1,0,0,1,0,0,0\n",
    };
    for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++)
    {
        bat_curve_set set = must_read(exponents[i], AUTO, NULL);
        double origin = (double)bat_curve_set_time_origin(&set), *channels = set.curves[0].channels;
        assert_true(fabs(origin + channels[0] - 1311868171.131477) < 1e-6);
        assert_true(fabs(origin + channels[1] - 1311868172.331406) < 1e-6);
        bat_curve_set_free(&set);
    }
}

/// Dates are times where they are wanted, and are written as they were.
static void dates_are_times(void **state)
{
    (void)state;
    static const char text[] = "time,x,y\n2024-05-01T10:00:00.125+02:00,8,47\n2024-05-01T10:00:10.5+02:00,9,48\n";
    bat_curve_read_options options = bat_curve_read_defaults();
    bat_curve_set set;
    assert_int_equal(bat_curve_read_memory(text, sizeof text - 1, &options, &set, NULL), BAT_OK);
    assert_false(bat_motion_has_times(&set));
    bat_curve_set_free(&set);
    options.motion = true;
    assert_int_equal(bat_curve_read_memory(text, sizeof text - 1, &options, &set, NULL), BAT_OK);
    assert_true(bat_motion_has_times(&set));
    assert_true(set.curves[0].channels[0] == 0.125);
    assert_true(set.curves[0].channels[1] == 10.5);
    char *written = must_write(&set, BAT_CURVE_FORMAT_CSV);
    assert_non_null(strstr(written, "\n2024-05-01T10:00:00.125+02:00,8,47\n"));
    assert_non_null(strstr(written, "\n2024-05-01T10:00:10.500+02:00,9,48\n"));
    free(written);
    bat_curve_set_free(&set);
}

/// A file of times has seconds, nanoseconds and dates, all less the origin.
static void times_count_from_an_origin(void **state)
{
    (void)state;
    char path[] = "/tmp/batten-times-XXXXXX";
    int file = mkstemp(path);
    static const char text[] = "1403715524.907143168\n1403715524907143169\n2014-06-25T16:58:44.9071432Z\n1403715526\n";
    double *times;
    size_t count;
    assert_true(file >= 0 && write(file, text, sizeof text - 1) == (ssize_t)(sizeof text - 1));
    (void)close(file);
    bat_curve_set set = must_read("1403715524.907143168 0 0 0 0 0 0 1\n1403715525 1 0 0 0 0 0 1\n", AUTO, NULL);
    assert_int_equal(bat_motion_times_read(path, &set, &times, &count, NULL), BAT_OK);
    bat_curve_set_free(&set);
    assert_int_equal(count, 4);
    assert_true(times[0] == 0.907143168 && times[1] == 0.907143169 && times[2] == 0.9071432 && times[3] == 2);
    free(times);
    (void)remove(path);
}

static void trajectories_come_back(void **state)
{
    (void)state;
    static const bat_curve_format formats[] = {BAT_CURVE_FORMAT_EUROC, BAT_CURVE_FORMAT_KITTI, BAT_CURVE_FORMAT_TUM};
    bat_curve_set set = must_read("0 1 2 3 0 0 0 1\n1 1 2 3 0 0 0.7071068 0.7071068\n", AUTO, NULL);
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
    {
        char *text = must_write(&set, formats[i]);
        bat_curve_set again = must_read(text, i == 0 ? formats[i] : AUTO, NULL);
        assert_poses(&again, 0, 1);
        bat_curve_set_free(&again);
        free(text);
    }
    bat_curve_set_free(&set);
}

static bat_curve_set must_read_motion(const char *text, bat_time_unit unit)
{
    bat_curve_read_options options = bat_curve_read_defaults();
    bat_curve_set set = {0};
    options.motion = true;
    options.time_unit = unit;
    assert_int_equal(bat_curve_read_memory(text, strlen(text), &options, &set, NULL), BAT_OK);
    return set;
}

/// Motions by levels 0 are the files that were read, with their stamps, names and spaces.
static void files_of_motions_come_back(void **state)
{
    (void)state;
    static const struct
    {
        const char *text, *space;
        double span; ///< in seconds
    } cases[] = {
        {"time,x,y\n1403715524907143168,0,0\n1403715525007143169,1,0\n", "plane", 0.100000001},
        {"time_ns,x,y\n5,0,0\n2000000005,1,0\n", "plane", 2},
        {"t [ms],x,y\n1400000000000,0,0\n1400000000000.5,1,0\n", "plane", 0.0005},
        {"timestamp [us],x [mm],y [mm]\n1000000,0,0\n1010000,1,0\n", "plane", 0.01},
        {"time,x\n0,0\n1,1\n", "euclidean", 1},
        {"time,yaw\n0,350\n1,10\n", "euclidean", 1},
        {"time,j1,j2,j3,j4,j5,j6,j7\n0,1,2,3,4,5,6,7\n1,1,2,3,4,5,6,8\n", "euclidean", 1},
        {"time,rx,ry,rz\n0,0,0,0\n1,0,0,1\n", "rotation", 1},
        {"time,xx,xy,yy\n0,1,0,1\n1,2,0.5,1\n", "spd", 1},
        {"1403715273262142976 0 0 0 0 0 0 1\n1403715273312142848 1 0 0 0 0 0 1\n", "rigid", 0.049999872},
        {"1311868171.131477 0 0 0 0 0 0 1\n1311868172.331406 1 0 0 0 0 0 1\n", "rigid", 1.199929},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_motion_curves_options options = bat_motion_curves_defaults();
        bat_curve_set set = must_read_motion(cases[i].text, BAT_TIME_UNIT_AUTO), same;
        options.scheme.levels = 0;
        assert_string_equal(set.space->name, cases[i].space);
        assert_int_equal(bat_motion_curves(&set, &options, &same, NULL), BAT_OK);
        const bat_curve *curve = &same.curves[0];
        assert_true(fabs(curve->channels[1] - curve->channels[0] - cases[i].span) < 1e-15);
        char *text = must_write(&same, strcmp(cases[i].space, "rigid") == 0 ? BAT_CURVE_FORMAT_TUM : BAT_CURVE_FORMAT_CSV);
        for (const char *line = cases[i].text; *line != '\0';)
        {
            // Seconds get nine decimals.
            size_t length = strcspn(line, "\n"), point = strcspn(line, "."), shown = point < length ? point : length;
            char wanted[200] = "";
            assert_true(shown < sizeof wanted - 1);
            memcpy(wanted, line, shown);
            assert_non_null(strstr(text, wanted));
            line += length + 1;
        }
        free(text);
        bat_curve_set_free(&set);
        bat_curve_set_free(&same);
    }
}

static bool is_told(const bat_curve_set *set, const char *text)
{
    const char *note;
    for (size_t i = 0; (note = bat_curve_set_note(set, i)) != NULL; i++)
        if (strstr(note, text) != NULL)
            return true;
    return false;
}

/// Images of COLMAP are poses of the camera in the world, in the order of their names, and go through TUM and back.
static void images_of_colmap_are_cameras(void **state)
{
    (void)state;
    static const char text[] =
        "# Image list with two lines of data per image:\n#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, ...\n"
        "2 0.5 0.5 0.5 0.5 1 2 3 1 frame_0010.jpg\n1 2 3\n"
        "1 0 1 0 0 0 0 1 1 frame_0004.jpg\n\n";
    bat_curve_set set = must_read_motion(text, BAT_TIME_UNIT_AUTO);
    assert_string_equal(set.space->name, "rigid");
    assert_true(is_told(&set, "number in its image's name"));
    // x' = R x + t turns the axes round: c = -R^T t.
    const double wanted[2][8] = {{4, 0, 0, 1, 0, -1, 0, 0}, {10, -2, -3, -1, 0.5, -0.5, -0.5, -0.5}};
    char *written = must_write(&set, BAT_CURVE_FORMAT_TUM);
    bat_curve_set again = must_read_motion(written, BAT_TIME_UNIT_AUTO);
    for (size_t i = 0; i < 2; i++)
    {
        const double *p = set.curves[0].points + 7 * i, *q = again.curves[0].points + 7 * i;
        double sign = p[3] * wanted[i][4] + p[4] * wanted[i][5] + p[5] * wanted[i][6] + p[6] * wanted[i][7] < 0 ? -1 : 1;
        assert_true(set.curves[0].channels[i] == wanted[i][0] && again.curves[0].channels[i] == wanted[i][0]);
        for (size_t c = 0; c < 7; c++)
            assert_true(fabs(p[c] - (c < 3 ? 1 : sign) * wanted[i][1 + c]) < 1e-12 && p[c] == q[c]);
    }
    free(written);
    bat_curve_set_free(&set);
    bat_curve_set_free(&again);
    // A quaternion of zeros is no rotation.
    static const char zeros[] = "# Image list with two lines of data per image:\n1 0 0 0 0 0 0 1 1 a.jpg\n\n";
    bat_curve_read_options options = bat_curve_read_defaults();
    bat_error error;
    options.motion = true;
    assert_int_equal(bat_curve_read_memory(zeros, strlen(zeros), &options, &set, &error), BAT_BAD_FILE);
    assert_int_equal(error.line, 2);
    assert_non_null(strstr(error.text, "the quaternion is 0"));
}

/// Joints of BVH are curves of poses in the frames of their parents; faults name the line.
static void joints_of_bvh_are_poses(void **state)
{
    (void)state;
    static const char head[] = "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation "
                               "Xrotation Yrotation\nJOINT Knee {\nOFFSET 0 -5 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n"
                               "End Site\n{\nOFFSET 0 -4 0\n}\n}\n}\nMOTION\nFrames: 2\nFrame Time: 0.5\n";
    char text[800];
    (void)snprintf(text, sizeof text, "%s1 2 3 90 0 0 0 0 0\n4 5 6 90 90 0 0 0 180\n", head);
    bat_curve_set set = must_read_motion(text, BAT_TIME_UNIT_AUTO);
    assert_int_equal(set.count, 2);
    const double *hips = set.curves[0].points, *knee = set.curves[1].points, r = sqrt(0.5);
    const double wanted[2][14] = {{1, 2, 3, r, 0, 0, r, 4, 5, 6, 0.5, 0.5, 0.5, 0.5},
                                  {0, -5, 0, 1, 0, 0, 0, 0, -5, 0, 0, 0, 1, 0}};
    for (size_t c = 0; c < 14; c++)
    {
        assert_true(fabs(hips[c] - wanted[0][c]) < 1e-15);
        assert_true(fabs(knee[c] - wanted[1][c]) < 1e-15);
    }
    assert_true(set.curves[1].channels[1] == 0.5);
    bat_curve_set_free(&set);
    const struct
    {
        const char *rows, *words;
        size_t line;
    } bad[] = {{"1 2 3 90 0 0 0 0 0\n4 5 6 90 x 0 0 0 180\n", "a number for each channel", 19},
               {"1 2 3\n", "fewer numbers", 17},
               {"1 2 3 90 0 0 0 0 0\n4 5 6 90 90 0 0 0 180\n7 8 9 0 0 0 0 0 0\n", "go on after the number", 20}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    {
        bat_curve_read_options options = bat_curve_read_defaults();
        bat_error error;
        options.motion = true;
        (void)snprintf(text, sizeof text, "%s%s", head, bad[i].rows);
        assert_int_equal(bat_curve_read_memory(text, strlen(text), &options, &set, &error), BAT_BAD_FILE);
        assert_non_null(strstr(error.text, bad[i].words));
        assert_int_equal(error.line, bad[i].line);
    }
    bat_curve_read_options named = bat_curve_read_defaults();
    named.format = BAT_CURVE_FORMAT_BVH;
    assert_int_equal(bat_curve_read_memory("r 0 0", 5, &named, &set, NULL), BAT_BAD_FILE);
}

static void the_unit_of_times_can_be_named(void **state)
{
    (void)state;
    bat_curve_set set = must_read_motion("time_ns,x\n1000,0\n3000,1\n", BAT_TIME_UNIT_MILLISECONDS);
    assert_true(set.curves[0].channels[0] == 1 && set.curves[0].channels[1] == 3);
    bat_curve_set_free(&set);
    // A log of PX4 has microseconds.
    set = must_read_motion("timestamp,q[0],q[1],q[2],q[3],n\n1000000,1,0,0,0,7\n1500000,0,1,0,0,7\n", BAT_TIME_UNIT_AUTO);
    assert_string_equal(set.space->name, "rotation");
    assert_true(set.curves[0].channels[0] == 1 && set.curves[0].channels[1] == 1.5);
    bat_curve_set_free(&set);
}

/// What is no part of a motion is left out and told: columns, and rows that repeat a time.
static void other_columns_are_left_out(void **state)
{
    (void)state;
    static const char text[] = "name,time,x,effort,y,vx\na,0,1,9,2,0\nb,1,2,9,3,0\nc,1,5,9,5,0\nd,2,3,9,4,0\n";
    bat_curve_set set = must_read_motion(text, BAT_TIME_UNIT_AUTO);
    assert_string_equal(set.space->name, "plane");
    assert_int_equal(set.curves[0].count, 3);
    assert_int_equal(set.curves[0].channel_count, 1);
    assert_true(set.curves[0].points[2] == 2 && set.curves[0].points[3] == 3 && set.curves[0].points[5] == 4);
    assert_true(is_told(&set, "left out 3 columns that are no part of a motion"));
    assert_true(is_told(&set, "left out 1 row that has the time of the row before, the first on line 4"));
    char *written = must_write(&set, BAT_CURVE_FORMAT_CSV);
    assert_string_equal(written, "time,x,y\n0,1,2\n1,2,3\n2,3,4\n");
    free(written);
    bat_curve_set_free(&set);
}

/// A last point that repeats the first ends the period, and the motion is as smooth there as elsewhere.
static void a_repeated_point_ends_the_period(void **state)
{
    (void)state;
    bat_motion_curves_options options = bat_motion_curves_defaults();
    bat_curve_set set = must_read_motion("# closed\ntime,x,y\n0,1,0\n1,0,1\n2,-1,0\n3,0,-1\n4,1,0\n", BAT_TIME_UNIT_AUTO);
    bat_curve_set fine;
    options.scheme.levels = 1;
    assert_int_equal(bat_motion_curves(&set, &options, &fine, NULL), BAT_OK);
    assert_int_equal(fine.curves[0].count, 8);
    for (size_t i = 1; i < 8; i += 2)
        for (size_t j = 0; j < 2; j++)
            assert_true(fabs(fabs(fine.curves[0].points[2 * i + j]) - 0.6875) < 1e-12);
    bat_curve_set_free(&fine);
    options.period = 3.5;
    bat_error error;
    assert_int_equal(bat_motion_curves(&set, &options, &fine, &error), BAT_OK);
    bat_curve_set_free(&fine);
    options.period = 3;
    assert_int_equal(bat_motion_curves(&set, &options, &fine, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "period"));
    // Where the period ends later, the last key is one as all others.
    options.period = 5;
    options.scheme.levels = 0;
    assert_int_equal(bat_motion_curves(&set, &options, &fine, &error), BAT_OK);
    assert_int_equal(fine.curves[0].count, 5);
    assert_true(fine.curves[0].points[8] == 1 && fine.curves[0].channels[4] == 4);
    bat_curve_set_free(&fine);
    set.curves[0].closed = false;
    assert_int_equal(bat_motion_curves(&set, &options, &fine, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "closed motions"));
    bat_curve_set_free(&set);
}

/// Angles go the shorter way, and stay in the range of the given ones.
static void angles_go_the_shorter_way(void **state)
{
    (void)state;
    static const struct
    {
        const char *text;
        double between;
    } cases[] = {{"time,yaw\n0,350\n1,10\n", 0}, {"time,yaw\n0,-170\n1,160\n", 175}, {"time,yaw\n0,20\n1,60\n", 40}};
    bat_motion_curves_options options = bat_motion_curves_defaults();
    options.scheme.levels = 1;
    options.wrap = 360;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_curve_set set = must_read_motion(cases[i].text, BAT_TIME_UNIT_AUTO), fine;
        assert_int_equal(bat_motion_curves(&set, &options, &fine, NULL), BAT_OK);
        assert_true(fabs(fine.curves[0].points[1] - cases[i].between) < 1e-9);
        assert_true(fabs(fine.curves[0].points[2] - set.curves[0].points[1]) < 1e-9);
        bat_curve_set_free(&set);
        bat_curve_set_free(&fine);
    }
}

/// A heading that turns once in a period goes on in its sense, and its velocity has a mean of a round.
static void headings_may_turn_in_a_period(void **state)
{
    (void)state;
    bat_motion_report report;
    bat_motion_curves_options options = bat_motion_curves_defaults();
    options.scheme.levels = 2;
    options.wrap = 360;
    options.report = &report;
    bat_curve_set set = must_read_motion("# closed\ntime,yaw\n0,10\n1,100\n2,190\n3,280\n", BAT_TIME_UNIT_AUTO), fine;
    assert_int_equal(bat_motion_curves(&set, &options, &fine, NULL), BAT_OK);
    assert_int_equal(fine.curves[0].count, 16);
    for (size_t i = 0; i < 16; i++)
        assert_true(fabs(fine.curves[0].points[i] - fmod(10 + 22.5 * (double)i, 360)) < 1e-9);
    assert_true(fabs(report.peaks[0][0] - 90) < 1e-9);
    bat_motion_spline *spline;
    assert_int_equal(bat_motion_curve_spline(&set, 0, &options, &spline, NULL), BAT_INVALID_ARGUMENT);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&set);
}

/// Positions in logs of PX4 have microseconds, and velocities a second.
static void positions_of_px4_have_microseconds(void **state)
{
    (void)state;
    bat_curve_set set = must_read_motion("timestamp,ref_timestamp,x,y,z,vx,vy,vz,heading\n123456789,0,0,0,0,1,0,0,0\n"
                                         "123556789,0,0.1,0,0,1,0,0,0\n123756789,0,0.3,0,0,1,0,0,0\n",
                                         BAT_TIME_UNIT_AUTO),
                  fine;
    bat_motion_curves_options options = bat_motion_curves_defaults();
    options.scheme.levels = 1;
    assert_int_equal(bat_motion_curves(&set, &options, &fine, NULL), BAT_OK);
    for (size_t i = 0; i < 5; i++)
        assert_true(fabs(fine.curves[0].points[3 * i] - (i < 2 ? 0.05 * (double)i : 0.1 * (double)(i - 1))) < 1e-9);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&set);
}

/// Rows of KITTI may be whole matrices, whose last row is 0 0 0 1.
static void whole_matrices_are_poses(void **state)
{
    (void)state;
    static const char *const texts[] = {"1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1\n0 -1 0 1 1 0 0 2 0 0 1 4 0 0 0 1\n",
                                        "1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 2\n0 -1 0 1 1 0 0 2 0 0 1 4 0 0 0 1\n"};
    bat_curve_read_options options = bat_curve_read_defaults();
    options.format = BAT_CURVE_FORMAT_KITTI;
    options.motion = true;
    for (size_t i = 0; i < 2; i++)
    {
        bat_curve_set set = {0};
        bat_error error;
        bat_status status = bat_curve_read_memory(texts[i], strlen(texts[i]), &options, &set, &error);
        assert_int_equal(status, i == 0 ? BAT_OK : BAT_BAD_FILE);
        assert_true(i == 0 ? set.curves[0].points[7 + 2] == 4 : error.line == 1);
        bat_curve_set_free(&set);
    }
}

/// Tensors that are nearly singular are told.
static void flat_tensors_are_told(void **state)
{
    (void)state;
    bat_curve_set set = must_read_motion("time,xx,xy,yy\n0,1,0,1\n1,1,0,1e-14\n2,2,1,2\n", BAT_TIME_UNIT_AUTO);
    assert_true(is_told(&set, "1 tensor is nearly singular, the first at point 1"));
    bat_curve_set_free(&set);
    set = must_read_motion("time,xx,xy,xz,yy,yz,zz\n0,1,0,0,1,0,1\n1,2,1,0,2,0,1e-3\n", BAT_TIME_UNIT_AUTO);
    assert_false(is_told(&set, "nearly singular"));
    bat_curve_set_free(&set);
}

/// A number may have a velocity, beside it in the file or asked for.
static void numbers_have_velocities(void **state)
{
    (void)state;
    bat_motion_curves_options options = bat_motion_curves_defaults();
    options.scheme.levels = 1;
    options.velocities = true;
    bat_curve_set set = must_read_motion("time,x,vx\n0,0,1\n1,1,1\n2,0,-3\n3,0,1\n", BAT_TIME_UNIT_AUTO), fine;
    assert_int_equal(set.space->point_dim, 1);
    assert_int_equal(bat_motion_curves(&set, &options, &fine, NULL), BAT_OK);
    assert_true(fine.curves[0].channel_count == 2 && fabs(fine.curves[0].channels[2 * 4 + 1] + 3) < 1e-12);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&set);
}

/// Poses may have velocities of the translation alone, which then hold, and the rotation is that without any.
static void one_part_may_have_velocities(void **state)
{
    (void)state;
    bat_motion_report report;
    bat_motion_curves_options options = bat_motion_curves_defaults();
    options.scheme.levels = 1;
    options.velocities = true;
    options.report = &report;
    bat_curve_set fine[2];
    static const char *const texts[] = {
        "time,x,y,z,qw,qx,qy,qz,vx,vy,vz\n0,0,0,0,1,0,0,0,1,0,0\n1,1,0,0,1,0.1,0,0,1,4,0\n2,2,1,0,1,0,0.3,0,1,0,0\n",
        "time,x,y,z,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,1,0,0,1,0.1,0,0\n2,2,1,0,1,0,0.3,0\n"};
    for (size_t i = 0; i < 2; i++)
    {
        bat_curve_read_options read = bat_curve_read_defaults();
        bat_curve_set set;
        read.motion = read.project = true;
        assert_int_equal(bat_curve_read_memory(texts[i], strlen(texts[i]), &read, &set, NULL), BAT_OK);
        assert_int_equal(bat_motion_curves(&set, &options, &fine[i], NULL), BAT_OK);
        assert_true(i == 0 ? report.conflict > 0.5 && report.conflict < 2 : report.conflict == 0);
        bat_curve_set_free(&set);
    }
    const bat_curve *given = &fine[0].curves[0], *found = &fine[1].curves[0];
    assert_int_equal(given->channel_count, 7);
    assert_true(given->channels[2 * 7 + 2] == 4);
    assert_true(fabs(given->points[7 + 1] - -0.5) < 1e-15); // the cubic of Hermite between the first two keys
    for (size_t i = 0; i < 5; i++)
        for (size_t j = 3; j < 7; j++)
            assert_true(given->points[7 * i + j] == found->points[7 * i + j]);
    bat_curve_set_free(&fine[0]);
    bat_curve_set_free(&fine[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(poses_are_recognized),
        cmocka_unit_test(an_odd_row_leaves_a_trajectory),
        cmocka_unit_test(strict_reading_leaves_nothing_out),
        cmocka_unit_test(turns_follow_the_order),
        cmocka_unit_test(doubtful_poses_are_refused),
        cmocka_unit_test(other_tables_stay_as_they_are),
        cmocka_unit_test(trajectories_come_back),
        cmocka_unit_test(stamps_keep_their_digits),
        cmocka_unit_test(seconds_keep_their_digits),
        cmocka_unit_test(dates_are_times),
        cmocka_unit_test(times_count_from_an_origin),
        cmocka_unit_test(files_of_motions_come_back),
        cmocka_unit_test(images_of_colmap_are_cameras),
        cmocka_unit_test(joints_of_bvh_are_poses),
        cmocka_unit_test(the_unit_of_times_can_be_named),
        cmocka_unit_test(other_columns_are_left_out),
        cmocka_unit_test(a_repeated_point_ends_the_period),
        cmocka_unit_test(one_part_may_have_velocities),
        cmocka_unit_test(angles_go_the_shorter_way),
        cmocka_unit_test(headings_may_turn_in_a_period),
        cmocka_unit_test(numbers_have_velocities),
        cmocka_unit_test(flat_tensors_are_told),
        cmocka_unit_test(whole_matrices_are_poses),
        cmocka_unit_test(positions_of_px4_have_microseconds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
