#include "test_io_helpers.h"

static const bat_curve_format CSV = BAT_CURVE_FORMAT_CSV;

static void rows_become_points(void **state)
{
    (void)state;
    const char *texts[] = {"1,2\n3,4\n5,6\n",
                           "1;2\r\n3;4\r\n5;6\r\n",
                           "1\t2\n3\t4\n5\t6",
                           "  1   2 \n3 4\n5   6",
                           "\xEF\xBB\xBF# a comment\n\n\nx,y\n# another\n1, 2\n3 ,4\n5,6\n\n\n",
                           "\"x\";\"y\"\n1.0;+2\n3e0;.4e1\n5.;6\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    {
        bat_curve_set set = must_read(texts[i], BAT_CURVE_FORMAT_AUTO, NULL);
        assert_int_equal(set.count, 1);
        assert_string_equal(set.space->name, "plane");
        assert_ptr_equal(set.curves[0].space, set.space);
        assert_int_equal(set.curves[0].count, 3);
        assert_false(set.curves[0].closed);
        for (size_t k = 0; k < 6; k++)
            assert_true(set.curves[0].points[k] == (double)(k + 1));
        bat_curve_set_free(&set);
    }
}

static void columns_tell_the_space(void **state)
{
    (void)state;
    bat_curve_set set = must_read("1,2,3,4\n5,6,7,8\n", CSV, NULL);
    assert_string_equal(set.space->name, "euclidean");
    assert_int_equal(set.space->point_dim, 4);
    bat_curve_set_free(&set);
    set = must_read("1,0,0\n0,1,0\n", CSV, "sphere");
    assert_string_equal(set.space->name, "sphere");
    assert_int_equal(set.space->dimension, 2);
    bat_curve_set_free(&set);
    set = must_read("0.5,0.25,7\n0,0,8\n", CSV, "disk");
    assert_string_equal(set.space->name, "disk");
    assert_int_equal(set.curves[0].channel_count, 1);
    assert_true(set.curves[0].channels[1] == 8);
    bat_curve_set_free(&set);
    set = must_read("# space: sphere\n1,0,0\n0,1,0\n", CSV, NULL);
    assert_string_equal(set.space->name, "sphere");
    bat_curve_set_free(&set);
}

static void longitude_and_latitude_become_unit_vectors(void **state)
{
    (void)state;
    bat_curve_set set = must_read("Latitude,Altitude,Lon,speed\n0,100,90,3\n90,200,0,4\n", CSV, NULL);
    const bat_curve *curve = &set.curves[0];
    const double points[] = {0, 1, 0, 0, 0, 1};
    const double channels[] = {100, 3, 200, 4};
    assert_string_equal(set.space->name, "sphere");
    assert_memory_equal(curve->points, points, sizeof points);
    assert_int_equal(curve->channel_count, 2);
    assert_memory_equal(curve->channels, channels, sizeof channels);
    char *text = must_write(&set, CSV);
    assert_string_equal(text, "Latitude,Altitude,Lon,speed\n0,100,90,3\n90,200,0,4\n");
    free(text);
    char *json = must_write(&set, BAT_CURVE_FORMAT_GEOJSON);
    assert_non_null(strstr(json, "[[90,0,100],[90,90,200]]"));
    free(json);
    bat_curve_set_free(&set);
}

static void blank_lines_part_curves_and_comments_close_them(void **state)
{
    (void)state;
    const char *text = "# closed\n0,0\n1,0\n0,1\n\n2,2\n3,3\n\n# open\n# closed\n0,0\n4,0\n0,4\n0,0\n";
    bat_curve_set set = must_read(text, CSV, NULL);
    assert_int_equal(set.count, 3);
    assert_true(set.curves[0].closed);
    assert_false(set.curves[1].closed);
    assert_true(set.curves[2].closed);
    assert_int_equal(set.curves[2].count, 3);
    assert_int_equal(bat_curve_set_line(&set, 0, 0), 2);
    assert_int_equal(bat_curve_set_line(&set, 1, 1), 7);
    assert_int_equal(bat_curve_set_line(&set, 2, 2), 13);
    assert_int_equal(bat_curve_set_line(&set, 2, 3), 0);
    assert_int_equal(bat_curve_set_line(&set, 3, 0), 0);
    bat_curve_set_free(&set);
}

static void a_comment_names_the_space(void **state)
{
    (void)state;
    const char *texts[] = {"# space: disk\n0.5,0\n0,0.5\n", "#SPACE:disk\n0.5,0\n0,0.5\n", "# space disk\n0.5,0\n0,0.5\n",
                           "# Space\tdisk \r\n0.5,0\n0,0.5\n", "# space: disk\n0.5,0\n\n# space: disk\n0,0.5\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    {
        bat_curve_set set = must_read(texts[i], CSV, NULL);
        assert_string_equal(set.space->name, "disk");
        bat_curve_set_free(&set);
    }
    const char *remarks[] = {"# space station\n1,2\n", "# spaces: disk\n1,2\n", "# space disk is what this is not\n1,2\n"};
    for (size_t i = 0; i < sizeof remarks / sizeof *remarks; i++)
    {
        bat_curve_set set = must_read(remarks[i], CSV, NULL);
        assert_string_equal(set.space->name, "plane");
        bat_curve_set_free(&set);
    }
    assert_bad("0.5,0\n# space: disk\n0,0.5\n", CSV, NULL, 2, "must be named before the first row");
    assert_bad("0.5,0\n\n# space disk\n0,0.5\n", CSV, NULL, 3, "must be named before the first row");
    assert_bad("# space:\n0,0.5\n", CSV, NULL, 1, "no space ''");
}

/// Line ends, byte order marks and blank lines do not change the line of an error.
static void lines_are_counted_alike(void **state)
{
    (void)state;
    assert_bad("\xEF\xBB\xBF# c\r\n\r\nx,y\r\n1,2\r\n3,z\r\n", CSV, NULL, 5, "column 2: 'z'");
    assert_bad("\xEF\xBB\xBF\xEF\xBB\xBFx,y\n1,2\n \t\n\n3,z", CSV, NULL, 5, "column 2: 'z'");
    assert_bad("1,2\r3,4\r", CSV, NULL, 1, "column 2: '2?3'");
}

static void an_option_opens_or_closes_all(void **state)
{
    (void)state;
    const char *text = "# closed\n0,0\n1,0\n0,1\n\n2,2\n3,3\n4,0\n";
    for (int closed = 0; closed <= 1; closed++)
    {
        bat_curve_read_options options = bat_curve_read_defaults();
        options.closed = closed;
        bat_curve_set set = {0};
        assert_int_equal(bat_curve_read_memory(text, strlen(text), &options, &set, NULL), BAT_OK);
        assert_int_equal(set.curves[0].closed, closed);
        assert_int_equal(set.curves[1].closed, closed);
        bat_curve_set_free(&set);
    }
}

static void points_off_their_space_are_refused_or_moved(void **state)
{
    (void)state;
    const char *text = "x,y,z\n1,0,0\n0,2,0\n";
    assert_bad(text, CSV, "sphere", 3, "the point is");
    bat_curve_read_options options = bat_curve_read_defaults();
    options.space = "sphere";
    options.project = true;
    bat_curve_set set = {0};
    assert_int_equal(bat_curve_read_memory(text, strlen(text), &options, &set, NULL), BAT_OK);
    assert_true(set.curves[0].points[4] == 1.0);
    bat_curve_set_free(&set);
    const char *origin = "1,0,0\n0,0,0\n";
    bat_error error;
    assert_int_equal(bat_curve_read_memory(origin, strlen(origin), &options, &set, &error), BAT_BAD_FILE);
    assert_int_equal(error.line, 2);
    assert_int_equal(error.index, 1);
    assert_bad("0,0\n1,0\n", CSV, "disk", 2, "the point is");
}

static void writing_keeps_every_double(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(5);
    enum
    {
        COUNT = 70000 // more than two blocks
    };
    double *points = malloc(3 * COUNT * sizeof *points);
    bat_space space = bat_sphere(2);
    for (size_t i = 0; i < COUNT; i++)
        space.random_point(&space, &random, points + 3 * i);
    bat_curve curve = {.space = &space, .points = points, .count = COUNT, .closed = true};
    bat_curve_set set, back = {0};
    assert_int_equal(bat_curve_set_single(&curve, &set, NULL), BAT_OK);
    assert_null(curve.points);
    char *texts[2];
    size_t size;
    for (int threads = 1; threads <= 2; threads++)
    {
        bat_curve_write_options options = {.format = CSV, .precision = 10, .threads = threads};
        assert_int_equal(bat_curve_write_memory(&set, &options, &texts[threads - 1], &size, NULL), BAT_OK);
    }
    assert_string_equal(texts[0], texts[1]);
    assert_int_equal(read_string(texts[0], CSV, NULL, &back, NULL), BAT_OK);
    assert_string_equal(back.space->name, "sphere");
    assert_true(back.curves[0].closed);
    assert_int_equal(back.curves[0].count, COUNT);
    assert_memory_equal(back.curves[0].points, points, 3 * COUNT * sizeof *points);
    free(texts[0]);
    free(texts[1]);
    bat_curve_set_free(&set);
    bat_curve_set_free(&back);
}

static void the_layout_survives(void **state)
{
    (void)state;
    assert_rewritten("a\tb\n1\t2\n1\t3\n\n# closed\n3\t4\n5\t6\n7\t8\n", CSV, NULL,
                     "a,b\n1,2\n1,3\n\n# closed\n3,4\n5,6\n7,8\n");
    assert_rewritten("lon,lat\n1,2\n3,4\n", CSV, "plane", "# space: plane\nlon,lat\n1,2\n3,4\n");
    assert_rewritten("0.5,0.5\n", CSV, "disk", "# space: disk\n0.5,0.5\n");
    assert_rewritten("0.1,0.5,9\n0,0,1e-300\n", CSV, "plane", "# space: plane\n0.1,0.5,9\n0,0,1e-300\n");
    assert_rewritten("lon,lat\n200,-12.5\n", CSV, NULL, "lon,lat\n-160,-12.5\n");
}

/// Blocks and groups with too few points among others are dropped and counted, unless that is refused.
static void short_curves_are_dropped_and_counted(void **state)
{
    (void)state;
    static const char text[] = "s,x,y,name\nb,5,5,p\na,1,2,q\na,3,4,r\nc,7,7,t\nc,7,7,t\nd,8,8,u\nd,9,8,u\n";
    assert_rewritten("1,2\n\n3,4\n5,6\n\n7,8\n7,8\n", CSV, "plane", "3,4\n5,6\n");
    assert_rewritten("1,2\n3,4\n\n# closed\n3,4\n5,6\n", CSV, "plane", "1,2\n3,4\n");
    bat_curve_read_options options = bat_curve_read_defaults();
    options.format = CSV;
    options.space = "plane";
    options.group = "s";
    bat_curve_set set = {0};
    assert_int_equal(bat_curve_read_memory(text, sizeof text - 1, &options, &set, NULL), BAT_OK);
    assert_int_equal(set.count, 2);
    assert_int_equal(bat_curve_set_line(&set, 1, 0), 7);
    char *written = must_write(&set, CSV);
    assert_non_null(strstr(written, "\na,1,2,q\na,3,4,r\n\nd,8,8,u\nd,9,8,u\n"));
    free(written);
    const char *note = NULL;
    for (size_t i = 0; (note = bat_curve_set_note(&set, i)) != NULL && strstr(note, "left out") == NULL;)
        i++;
    assert_string_equal(note, "left out 2 curves with too few different points, the first ends on line 2");
    bat_curve_set_free(&set);
    options.strict = true;
    static const char strict[] = "s,x,y\nb,5,5\na,1,2\na,3,4\n";
    assert_int_equal(bat_curve_read_memory(strict, sizeof strict - 1, &options, &set, NULL), BAT_OK);
    assert_int_equal(set.count, 2); // refinement refuses the first
    bat_curve_set_free(&set);
}

/// A column called corner is neither a coordinate nor a channel. It survives at its place, first, last or between.
static void a_column_of_corners_survives(void **state)
{
    (void)state;
    const char *const texts[] = {"x,y,corner\n# closed\n0,0,1\n1,0,0\n1,1,1\n", "corner,x,y\n0,0,0\n1,1,0\n0,1,1\n",
                                 "x,corner,y,z,depth\n0,1,0,0,5\n1,0,0,1,6\n\n1,1,1,2,7\n1,1,1,3,8\n",
                                 "alt,corner,lon,lat\n5,1,10,20\n6,0,11,21\n",
                                 "# space: rotation\ncorner,qw,qx,qy,qz\n1,1,0,0,0\n0,0,1,0,0\n"};
    const char *const spaces[] = {"plane", "plane", "euclidean", "sphere", "rotation"};
    const size_t channels[] = {0, 0, 1, 1, 0};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    {
        bat_curve_set set = must_read(texts[i], BAT_CURVE_FORMAT_CSV, NULL);
        assert_string_equal(set.space->name, spaces[i]);
        assert_int_equal(set.curves[0].channel_count, channels[i]);
        assert_non_null(set.curves[set.count - 1].corners);
        char *text = must_write(&set, BAT_CURVE_FORMAT_CSV);
        bat_curve_set again = must_read(text, BAT_CURVE_FORMAT_CSV, NULL);
        if (i != 0 && strcmp(text, texts[i]) != 0)
            fail_msg("'%s' came back as '%s'", texts[i], text);
        for (size_t c = 0; c < set.count; c++)
            assert_memory_equal(set.curves[c].corners, again.curves[c].corners, set.curves[c].count);
        free(text);
        bat_curve_set_free(&again);
        bat_curve_set_free(&set);
    }
    bat_curve_set set = must_read("x,y,\"Corner\"\n# closed\n0,0,0\n1,0,0\n1,1,1\n0,0,1\n", BAT_CURVE_FORMAT_CSV, NULL);
    assert_int_equal(set.curves[0].count, 3);
    assert_memory_equal(set.curves[0].corners, "\1\0\1", 3); // the repeated first row says so, too
    bat_curve_set_free(&set);
    set = must_read("0,0,1\n1,0,0\n", BAT_CURVE_FORMAT_CSV, NULL);
    assert_null(set.curves[0].corners);
    bat_curve_set_free(&set);
    assert_bad("x,y,corner\n0,0,1\n1,0,2\n", BAT_CURVE_FORMAT_CSV, NULL, 3, "column 3: '2' is not 0 or 1");
    assert_bad("x,corner,y\n0,,1\n", BAT_CURVE_FORMAT_CSV, NULL, 2, "column 2: '' is empty");
    assert_bad("corner,x,y\n0,1,a\n", BAT_CURVE_FORMAT_CSV, NULL, 2, "column 3: 'a'");
    assert_bad("x,y,corner\n0,0\n", BAT_CURVE_FORMAT_CSV, NULL, 2, "2 columns where the first row has 3");
    assert_bad("corner\n0\n", BAT_CURVE_FORMAT_CSV, NULL, 1, "no columns beside");
}

static void bad_files_name_their_line(void **state)
{
    (void)state;
    assert_bad("", CSV, NULL, 0, "no points");
    assert_bad("# nothing\n\n", CSV, NULL, 2, "no points");
    assert_bad("x,y\n", CSV, NULL, 1, "no points");
    assert_bad("1,2\n3\n", CSV, NULL, 2, "1 columns where the first row has 2");
    assert_bad("1,2\n3,4,5\n", CSV, NULL, 2, "3 columns where the first row has 2");
    assert_bad("x,y\n1,2,3\n", CSV, NULL, 2, "3 columns");
    assert_bad("1,2\n3,x\n", CSV, NULL, 2, "column 2: 'x' is not a number");
    assert_bad("1,nan\n", CSV, NULL, 1, "'nan' is not a number");
    assert_bad("inf,inf\n", CSV, NULL, 1, "'inf' is not a number");
    assert_bad("1,0x10\n", CSV, NULL, 1, "'0x10' is not a number");
    assert_bad("1,2\n\n1,1e400\n", CSV, NULL, 3, "'1e400' is too large");
    assert_bad("1,2\n3,\n", CSV, NULL, 2, "column 2: '' is empty");
    assert_bad("1,2\n3 4\n", CSV, NULL, 2, "1 columns");
    assert_bad("x,\n1,2\n", CSV, NULL, 1, "column 2 of the header has no name");
    assert_bad("1,2\n3,4\x01\x7f\n", CSV, NULL, 2, "'4?\?' is not a number");
    assert_bad("\n\xEF\xBB\xBFx,y\n1,2\n", CSV, NULL, 2, "byte order mark");
    assert_bad("# space: torus\n1,2\n", CSV, NULL, 1, "no space 'torus'");
    assert_bad("1,2\n3,4\n", CSV, "sphere", 1, "needs 3 or more columns");
    assert_bad("1\n2\n", CSV, "plane", 1, "needs 2 columns");
    assert_bad("lon,lat\n1e300,0\n", CSV, NULL, 2, "longitude outside");
    assert_bad("lon,lat\n0,90.5\n", CSV, NULL, 2, "latitude outside");
    assert_bad("lon,lat\n0,0\n-360.1,0\n", CSV, NULL, 3, "longitude outside");
    assert_bad("1,2\n3,4\n1.5,2,5\n", CSV, NULL, 3, "3 columns");
    bat_curve_set set = {0};
    bat_error error;
    assert_int_equal(bat_curve_read_memory("1,2\n3,4\0,5\n", 12, NULL, &set, &error), BAT_BAD_FILE);
    assert_int_equal(error.line, 2);
    assert_int_equal(read_string("1,2\n", CSV, "torus", &set, &error), BAT_INVALID_ARGUMENT);
}

static void too_many_columns_are_refused(void **state)
{
    (void)state;
    char text[2 * (BAT_SPACE_MAX_DIM + 1) + 1];
    for (size_t i = 0; i <= BAT_SPACE_MAX_DIM; i++)
        memcpy(text + 2 * i, "1,", 3);
    text[2 * BAT_SPACE_MAX_DIM + 1] = '\0';
    assert_bad(text, CSV, NULL, 1, "more than 1024 columns");
    text[2 * BAT_SPACE_MAX_DIM - 1] = '\0';
    bat_curve_set set = must_read(text, CSV, NULL);
    assert_int_equal(set.space->point_dim, BAT_SPACE_MAX_DIM);
    bat_curve_set_free(&set);
}

/// Four coordinates by their places beside a text are refused without a space; so what is written names it.
static void guessed_coordinates_keep_their_space(void **state)
{
    (void)state;
    bat_curve_set set = must_read("# space: euclidean\na,0,1,2,3\nb,4,5,6,8\n", CSV, NULL), back;
    char *text = NULL;
    size_t size;
    assert_int_equal(set.curves[0].space->point_dim, 4);
    assert_int_equal(bat_curve_write_memory(&set, NULL, &text, &size, NULL), BAT_OK);
    back = must_read(text, CSV, NULL);
    assert_int_equal(back.curves[0].space->point_dim, 4);
    assert_memory_equal(back.curves[0].points, set.curves[0].points, 8 * sizeof(double));
    free(text);
    bat_curve_set_free(&back);
    bat_curve_set_free(&set);
}

/// What is written says which column holds the coordinates, where a reader would refuse to guess it.
static void one_named_column_stays_named(void **state)
{
    (void)state;
    bat_curve_set set = must_read("# columns: 1\n0,a\n1,b\n3,c\n", CSV, NULL);
    char *text = must_write(&set, CSV);
    assert_string_equal(text, "# space: euclidean\n# columns: 1\n0,a\n1,b\n3,c\n");
    bat_curve_set back = must_read(text, CSV, NULL);
    assert_int_equal(back.space->point_dim, 1);
    free(text);
    bat_curve_set_free(&back);
    bat_curve_set_free(&set);
}

/// The comment counts columns, also where one of them is called like a number.
static void a_comment_counts_columns(void **state)
{
    (void)state;
    bat_curve_set set = must_read("# columns: 1,3\na,>3,c\n0,7,1\n2,8,5\n", CSV, NULL);
    const double points[] = {0, 1, 2, 5};
    assert_int_equal(set.curves[0].space->point_dim, 2);
    assert_memory_equal(set.curves[0].points, points, sizeof points);
    bat_curve_set_free(&set);
}

static void what_cannot_be_written_is_refused(void **state)
{
    (void)state;
    bat_curve_set set = must_read("1,2\n3,4\n", CSV, NULL);
    char *text = NULL;
    size_t size;
    bat_error error;
    set.curves[0].points[3] = NAN;
    bat_curve_format formats[] = {CSV, BAT_CURVE_FORMAT_OBJ, BAT_CURVE_FORMAT_GEOJSON};
    for (size_t i = 0; i < 3; i++)
    {
        bat_curve_write_options options = {.format = formats[i], .precision = 10, .crs = "EPSG:25833"};
        assert_int_equal(bat_curve_write_memory(&set, &options, &text, &size, &error), BAT_INVALID_POINT);
    }
    bat_curve_write_options options = {.format = CSV, .precision = 13};
    assert_int_equal(bat_curve_write_memory(&set, &options, &text, &size, &error), BAT_INVALID_ARGUMENT);
    bat_curve_set_free(&set);
    assert_int_equal(bat_curve_write_memory(&set, NULL, &text, &size, &error), BAT_INVALID_ARGUMENT);
    set = must_read("1,2,3,4\n1,2,3,5\n", CSV, NULL);
    for (size_t i = 1; i < 3; i++)
    {
        options = (bat_curve_write_options){.format = formats[i], .precision = 10};
        assert_int_equal(bat_curve_write_memory(&set, &options, &text, &size, &error), BAT_UNSUPPORTED);
    }
    bat_curve_set_free(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(rows_become_points),
                                       cmocka_unit_test(columns_tell_the_space),
                                       cmocka_unit_test(longitude_and_latitude_become_unit_vectors),
                                       cmocka_unit_test(blank_lines_part_curves_and_comments_close_them),
                                       cmocka_unit_test(a_comment_names_the_space),
                                       cmocka_unit_test(lines_are_counted_alike),
                                       cmocka_unit_test(an_option_opens_or_closes_all),
                                       cmocka_unit_test(points_off_their_space_are_refused_or_moved),
                                       cmocka_unit_test(writing_keeps_every_double),
                                       cmocka_unit_test(the_layout_survives),
                                       cmocka_unit_test(short_curves_are_dropped_and_counted),
                                       cmocka_unit_test(a_column_of_corners_survives),
                                       cmocka_unit_test(bad_files_name_their_line),
                                       cmocka_unit_test(too_many_columns_are_refused),
                                       cmocka_unit_test(guessed_coordinates_keep_their_space),
                                       cmocka_unit_test(one_named_column_stays_named),
                                       cmocka_unit_test(a_comment_counts_columns),
                                       cmocka_unit_test(what_cannot_be_written_is_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
