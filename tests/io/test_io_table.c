#include "test_io_helpers.h"

#include "io/common/time_text.h"

#include <stdio.h>

// Tables as people have them: names, units, texts, times, gaps, groups and running numbers.

static const bat_curve_format CSV = BAT_CURVE_FORMAT_CSV;

static bat_curve_set read_with(const char *text, const char *space, const char *columns, const char *group)
{
    bat_curve_read_options options = bat_curve_read_defaults();
    options.format = CSV;
    options.space = space;
    options.columns = columns;
    options.group = group;
    bat_curve_set set = {0};
    bat_error error = {0};
    if (bat_curve_read_memory(text, strlen(text), &options, &set, &error) != BAT_OK)
        fail_msg("line %zu: %s", error.line, error.text);
    return set;
}

static void assert_note(const bat_curve_set *set, const char *words)
{
    const char *note;
    for (size_t i = 0; (note = bat_curve_set_note(set, i)) != NULL; i++)
        if (strstr(note, words) != NULL)
            return;
    fail_msg("no note with '%s'; the first is '%s'", words,
             bat_curve_set_note(set, 0) != NULL ? bat_curve_set_note(set, 0) : "");
}

/// Refine a set by a scheme and write it as CSV.
static char *refine_and_write(const bat_curve_set *set, const char *scheme, size_t levels)
{
    bat_curve_refine_options how = bat_curve_refine_defaults();
    assert_int_equal(bat_curve_scheme_by_name(scheme, &how.scheme, NULL), BAT_OK);
    how.levels = levels;
    bat_curve *curves = calloc(set->count, sizeof *curves);
    bat_curve_set fine = {0};
    bat_error error = {0};
    if (bat_curves_refine(set->curves, set->count, &how, curves, &error) != BAT_OK)
        fail_msg("%s", error.text);
    assert_int_equal(bat_curve_set_like(set, curves, &fine, NULL), BAT_OK);
    char *text = must_write(&fine, CSV);
    bat_curve_set_free(&fine);
    return text;
}

/// What names tell: the space, the first point and what a note says. The second point is of the same kind.
static void names_tell_the_coordinates(void **state)
{
    (void)state;
    const struct
    {
        const char *text, *space, *note;
        double x, y;
        size_t channels;
    } cases[] = {
        {"id,x,y\n1,5,6\n2,7,8\n", "plane", "'id' holds running numbers", 5, 6, 0},
        {"Index;X_m;Y_m\n0;5;6\n1;7;8\n", "plane", "x = 'X_m', y = 'Y_m'", 5, 6, 0},
        {"northing [m],Easting [m],v\n6,5,1\n8,7,1\n", "plane", "x = 'Easting [m]'", 5, 6, 1},
        {"N\tE\n6\t5\n8\t7\n", "plane", "x = 'E', y = 'N'", 5, 6, 0},
        {"Pkt;Rechtswert;Hochwert\nP1;5,0;6,0\nP2;7,25;8\n", "plane", "decimal commas", 5, 6, 2},
        {"point_y POINT_X\n6 5\n8 7\n", "plane", "x = 'POINT_X'", 5, 6, 0},
        {"x,y,speed\n5,6,1\n7,8,2\n", "plane", "x = 'x', y = 'y'", 5, 6, 1},
        {"time,a,b\n1,5,6\n2,7,8\n", "plane", "x = 'a', y = 'b'", 5, 6, 1},
        {"name,a,b\nP1,5,6\nP2,7,8\n", "plane", "text in column 'name'", 5, 6, 2},
        {"P1 5 6\nP2 7 8\n", "plane", "x = 2, y = 3", 5, 6, 2},
        {"12,5;48,25\n12,75;48\n", "plane", "decimal commas", 12.5, 48.25, 0},
        {"Longitude (deg),Latitude (deg)\n90,0\n91,1\n", "sphere", "longitude = 'Longitude (deg)'", 0, 1, 0},
        {"decimalLatitude,decimalLongitude\n0,90\n1,91\n", "sphere", "latitude = 'decimalLatitude'", 0, 1, 0},
        {"\xEF\xBB\xBF\"lat_deg\",\"lon_deg\"\r\n0,90\r\n1,91\r\n", "sphere", "lon_deg", 0, 1, 0},
        {"X (\xC2\xB0),Y (\xC2\xB0)\n90,0\n91,1\n", "sphere", "longitude = 'X ", 0, 1, 0},
        {"location-lat,location-long,h\n0,90,7\n1,91,8\n", "sphere", "location-long", 0, 1, 1},
        {"lat_rad,lon [rad]\n0,1.5707963267948966\n0.1,1\n", "sphere", "in radians", 0, 1, 0},
        {",lng,lat\n7,90,0\n8,91,1\n", "sphere", "running numbers", 0, 1, 0},
        {"\"\",\"x\",\"y\"\n\"1\",5,6\n\"2\",7,8\n", "plane", "running numbers", 5, 6, 0},
        {"#,x,y\n1,5,6\n2,7,8\n", "plane", "running numbers", 5, 6, 0},
        {"osm_id,x,y\n17,5,6\n3,7,8\n", "plane", "text in column 'osm_id'", 5, 6, 2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_curve_set set = must_read(cases[i].text, CSV, NULL);
        if (strcmp(set.space->name, cases[i].space) != 0 || set.curves[0].count != 2 ||
            set.curves[0].channel_count != cases[i].channels)
            fail_msg("case %zu: %s, %zu points, %zu channels", i, set.space->name, set.curves[0].count,
                     set.curves[0].channel_count);
        assert_true(fabs(set.curves[0].points[0] - cases[i].x) < 1e-15);
        assert_true(fabs(set.curves[0].points[1] - cases[i].y) < 1e-15);
        assert_note(&set, cases[i].note);
        bat_curve_set_free(&set);
    }
    bat_curve_set set = must_read("x,y,z,depth\n1,2,3,4\n", CSV, NULL);
    assert_int_equal(set.space->point_dim, 3);
    assert_int_equal(set.curves[0].channel_count, 1);
    bat_curve_set_free(&set);
    set = must_read("lat,lon\n2,1\n", CSV, "plane");
    assert_true(set.curves[0].points[0] == 1 && set.curves[0].points[1] == 2);
    bat_curve_set_free(&set);
    set = must_read("id,x,y\n1,5,6\n", CSV, "plane");
    assert_true(set.curves[0].points[0] == 5 && set.curves[0].points[1] == 6);
    bat_curve_set_free(&set);
    set = must_read("lon,lat\n1,2\n", CSV, NULL);
    assert_null(bat_curve_set_note(&set, 0)); // no guess
    bat_curve_set_free(&set);
}

static void columns_are_chosen(void **state)
{
    (void)state;
    const char *text = "station,a,b,c,d\nS1,1,2,3,4\nS2,2,3,4,5\n";
    assert_bad(text, CSV, NULL, 1, "; columns names them");
    const struct
    {
        const char *columns, *space, *name;
        double x, y;
    } cases[] = {{"c,A", NULL, "plane", 3, 1}, {" 5 , b", NULL, "plane", 4, 2}, {"d,c,b", NULL, "euclidean", 4, 3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_curve_set set = read_with(text, cases[i].space, cases[i].columns, NULL);
        assert_string_equal(set.space->name, cases[i].name);
        assert_true(set.curves[0].points[0] == cases[i].x && set.curves[0].points[1] == cases[i].y);
        char *written = must_write(&set, CSV);
        bat_curve_set back = must_read(written, CSV, NULL);
        assert_string_equal(back.space->name, cases[i].name);
        assert_memory_equal(back.curves[0].points, set.curves[0].points, 2 * back.space->point_dim * sizeof(double));
        free(written);
        bat_curve_set_free(&back);
        bat_curve_set_free(&set);
    }
    bat_curve_set set = read_with("0,90\n1,90\n", "sphere", "2,1", NULL); // longitude, then latitude
    assert_true(set.curves[0].points[1] == 1);
    bat_curve_set_free(&set);
    set = read_with("lat,lon,h\n0,90,5\n1,90,6\n", NULL, "lat,lon", NULL); // names tell which is which
    assert_true(set.curves[0].points[1] == 1);
    bat_curve_set_free(&set);
    const struct
    {
        const char *columns, *group, *words;
        bat_curve_format format;
    } faults[] = {{"a,q", NULL, "no column 'q'", CSV},
                  {"a,9", NULL, "no column '9'", CSV},
                  {"a,A", NULL, "twice", CSV},
                  {"a", NULL, "needs 2 columns", CSV},
                  {"", NULL, "no column ''", CSV},
                  {NULL, "q", "no column 'q'", CSV},
                  {"a,b,c", NULL, "needs 2 columns", CSV},
                  {"a,b", NULL, "only CSV", BAT_CURVE_FORMAT_OBJ}};
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
    {
        bat_curve_read_options options = bat_curve_read_defaults();
        options.format = faults[i].format;
        options.columns = faults[i].columns;
        options.group = faults[i].group;
        options.space = i == 3 || i == 6 ? "plane" : NULL;
        bat_error error;
        assert_true(bat_curve_read_memory(text, strlen(text), &options, &set, &error) != BAT_OK);
        if (strstr(error.text, faults[i].words) == NULL)
            fail_msg("'%s' does not have '%s'", error.text, faults[i].words);
    }
}

static void a_column_groups_rows(void **state)
{
    (void)state;
    const char *text = "track,lon,lat,name\nB,10,50,x\nA,0,0,\"p, q\"\n\nB,11,51,y\n# closed\nA,1,1,r\nB,12,50,y\nA,2,0,r\n";
    bat_curve_set set = read_with(text, NULL, NULL, "TRACK");
    assert_int_equal(set.count, 2);
    assert_int_equal(set.curves[0].count, 3);
    assert_int_equal(set.curves[1].count, 3);
    assert_false(set.curves[0].closed);
    assert_true(set.curves[1].closed);
    assert_int_equal(bat_curve_set_line(&set, 1, 1), 7);
    char *written = must_write(&set, CSV);
    assert_string_equal(written, "track,lon,lat,name\nB,10,50,x\nB,11,51,y\nB,12,50,y\n\n# closed\nA,0,0,\"p, "
                                 "q\"\nA,1,1,r\nA,2,0,r\n");
    bat_curve_set back = read_with(written, NULL, NULL, "track"), blank = must_read(written, CSV, NULL);
    assert_int_equal(back.count, 2);
    assert_int_equal(blank.count, 2);
    free(written);
    written = refine_and_write(&set, "log-exp-4", 1);
    assert_non_null(strstr(written, "\nB,11,51,y\nB,"));
    assert_non_null(strstr(written, "# closed\nA,0,0,\"p, q\"\nA,"));
    free(written);
    bat_curve_set_free(&back);
    bat_curve_set_free(&blank);
    bat_curve_set_free(&set);
    // Many groups, in turns.
    enum
    {
        GROUPS = 500,
        ROWS = 4
    };
    char *many = malloc(GROUPS * ROWS * 40), *at = many;
    at += sprintf(at, "x,y,trip_id\n");
    for (int row = 0; row < ROWS; row++)
        for (int group = 0; group < GROUPS; group++)
            at += sprintf(at, "%d,%d,t%d\n", row, group, group * 7);
    set = read_with(many, NULL, NULL, "trip_id");
    assert_int_equal(set.count, GROUPS);
    for (size_t i = 0; i < GROUPS; i++)
        for (size_t k = 0; k < ROWS; k++)
            assert_true(set.curves[i].points[2 * k] == (double)k && set.curves[i].points[2 * k + 1] == (double)i);
    bat_curve_set_free(&set);
    free(many);
    set = must_read("trip,lon,lat\n1,0,0\n1,1,0\n1,1,1\n2,3,3\n2,4,4\n2,5,5\n", CSV, NULL);
    assert_note(&set, "could group the rows into curves");
    bat_curve_set_free(&set);
}

/// Text and times survive; new points get the text before, and times between.
static void carried_columns_go_along(void **state)
{
    (void)state;
    const struct
    {
        const char *text, *scheme, *expected;
    } cases[] = {
        {"name,time,x,y,v\na,2024-05-01T12:00:00Z,0,0,1\nb,2024-05-01T12:00:01Z,2,0,\nc,2024-05-01T12:00:04Z,4,0,3\n",
         "four-point",
         "name,time,x,y,v\na,2024-05-01T12:00:00Z,0,0,1\na,2024-05-01T12:00:00.5Z,1,0,\nb,2024-05-01T12:00:01Z,2,0,\n"
         "b,2024-05-01T12:00:02.5Z,3,0,\nc,2024-05-01T12:00:04Z,4,0,3\n"},
        {"x,y,when\n0,0,2023-12-31 23:59:58.50+0130\n4,0,2024-01-01 00:00:02.50+0130\n", "chaikin",
         "x,y,when\n0,0,2023-12-31 23:59:58.50+0130\n1,0,2023-12-31 23:59:59.50+0130\n3,0,2024-01-01 00:00:01.50+0130\n"
         "4,0,2024-01-01 00:00:02.50+0130\n"},
        {"id;x;y;n;w\n7;0;0;\"a;b\";1,5\n8;2;0;q\"r;2,5\n9;4;0;s,t;NA\n", "four-point",
         "id,x,y,n,w\n7,0,0,\"a;b\",1.5\n8,1,0,\"a;b\",2\n9,2,0,\"q\"\"r\",2.5\n10,3,0,\"q\"\"r\",\n11,4,0,\"s,t\",NA\n"},
        // Numbers of a time do not run backwards, and keep their digits.
        {"time,x,y\n0,0,0\n1.0,2,0\n2,4,0\n30,6,0\n31,8,0\n", "four-point",
         "time,x,y\n0,0,0\n0.5,1,0\n1.0,2,0\n1.5,3,0\n2,4,0\n16,5,0\n30,6,0\n30.5,7,0\n31,8,0\n"},
        {"x,y,timestamp_ns,t_ms\n0,0,1700000000123456789,5\n2,0,1700000001123456791,6\n4,0,1700000002123456793,8\n",
         "four-point",
         "x,y,timestamp_ns,t_ms\n0,0,1700000000123456789,5\n1,0,1700000000623456790,5.5\n2,0,1700000001123456791,6\n"
         "3,0,1700000001623456792,7\n4,0,1700000002123456793,8\n"},
        {"# closed\nx,y,t,name\n0,0,1700000000.000000001,a\n1,0,1700000001,b\n1,1,1700000004,c\n", "four-point",
         "x,y,t,name\n# closed\n0,0,1700000000.000000001,a\n0.4375,-0.125,1700000000.500000001,a\n1,0,1700000001,b\n"
         "1.125,0.5625,1700000002.5,b\n1,1,1700000004,c\n0.4375,0.5625,1700000002,c\n"},
        // Whole numbers that doubles cannot hold.
        {"x,y,osm\n0,0,1\n2,0,12345678901234567\n", "four-point", "x,y,osm\n0,0,1\n1,0,1\n2,0,12345678901234567\n"},
        // Angles go around.
        {"x,y,Heading,cog (deg),speed\n0,0,355,1,1\n2,0,5,2,3\n", "four-point",
         "x,y,Heading,cog (deg),speed\n0,0,355,1,1\n1,0,355,1,2\n2,0,5,2,3\n"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_curve_set set = must_read(cases[i].text, CSV, NULL);
        char *written = refine_and_write(&set, cases[i].scheme, 1);
        assert_string_equal(written, cases[i].expected);
        bat_curve_set back = must_read(written, CSV, NULL);
        char *again = must_write(&back, CSV);
        assert_string_equal(again, cases[i].expected);
        free(again);
        free(written);
        bat_curve_set_free(&back);
        bat_curve_set_free(&set);
    }
}

/// Times in numbers are one channel; those that the caller changes are written. Edges of a tolerance have them between, too.
static void times_in_numbers_are_a_channel(void **state)
{
    (void)state;
    static const char text[] = "time,x,y\n0,0,0\n1,1,0\n2,2,1\n30,3,3\n31,3,5\n32,2,6\n";
    bat_curve_set set = must_read(text, CSV, NULL), fine = {0}, back;
    assert_note(&set, "times in column 'time'");
    assert_int_equal(set.curves[0].channel_count, 1);
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.relative_tolerance = 1e-3;
    bat_curve *curve = calloc(1, sizeof *curve);
    assert_int_equal(bat_curves_refine(set.curves, 1, &how, curve, NULL), BAT_OK);
    assert_int_equal(bat_curve_set_like(&set, curve, &fine, NULL), BAT_OK);
    char *written = must_write(&fine, CSV);
    back = must_read(written, CSV, NULL); // which refuses times that fall
    assert_true(back.curves[0].count > 12);
    assert_true(back.curves[0].channels[back.curves[0].count - 1] == 32);
    free(written);
    bat_curve_set_free(&back);
    bat_curve_set_free(&fine);
    for (size_t i = 0; i < set.curves[0].count; i++)
        set.curves[0].channels[i] += 100;
    written = must_write(&set, CSV);
    assert_string_equal(written, "time,x,y\n100,0,0\n101,1,0\n102,2,1\n130,3,3\n131,3,5\n132,2,6\n");
    free(written);
    bat_curve_set_free(&set);
}

/// Each text begins a run of equal rows, in the order of the file, for all kinds of schemes, open, closed and with corners.
static void texts_stay_in_order(void **state)
{
    (void)state;
    const char *const schemes[] = {"learned", "log-exp-4",   "four-point:parameters=chordal",
                                   "cubic",   "catmull-rom", "lane-riesenfeld:order=3"};
    for (size_t i = 0; i < 4 * sizeof schemes / sizeof *schemes; i++)
    {
        bool closed = i % 2 == 0, corners = i % 4 >= 2;
        char text[2048], *at = text;
        enum
        {
            COUNT = 12
        };
        at += sprintf(at, "name,time,lon,lat%s\n%s", corners ? ",corner" : "", closed ? "# closed\n" : "");
        for (int k = 0; k < COUNT; k++)
        {
            double angle = 6.283185307179586 * k / COUNT + 0.2 * sin(k);
            at += sprintf(at, "P%c,2024-01-01T00:00:%02dZ,%.6f,%.6f%s\n", 'a' + k, k, 10 * cos(angle), 8 * sin(angle),
                          corners ? (k == 5 ? ",1" : ",0") : "");
        }
        bat_curve_set set = must_read(text, CSV, NULL);
        char *written = refine_and_write(&set, schemes[i / 4], 3);
        char before = 'a', time_before[40] = "";
        size_t rows = 0;
        for (char *line = strchr(written, 'P'); line != NULL;
             line = strstr(line + 1, "\nP") != NULL ? strstr(line + 1, "\nP") + 1 : NULL)
        {
            if (line[1] != before && line[1] != before + 1)
                fail_msg("%s: %c after %c", schemes[i / 4], line[1], before);
            before = line[1];
            char time[40];
            size_t length = strcspn(line + 3, ",");
            memcpy(time, line + 3, length);
            time[length] = '\0';
            iso_time a, b;
            assert_true(iso_time_read(time, time + length, &a));
            bool wraps = closed && before == 'a' + COUNT - 1;
            if (rows > 0 && iso_time_read(time_before, time_before + strlen(time_before), &b) && !wraps)
                assert_true(a.nanoseconds > b.nanoseconds);
            memcpy(time_before, time, sizeof time);
            rows++;
        }
        assert_int_equal(before, 'a' + COUNT - 1);
        assert_true(rows >= 80);
        free(written);
        bat_curve_set_free(&set);
    }
}

static void gaps_and_numbers_are_told_apart(void **state)
{
    (void)state;
    bat_curve_set set = must_read("lon,lat,ele\n1,2,\n2,3,5\n3,4,6\n4,5,\n", CSV, NULL);
    assert_note(&set, "'ele' has 2 empty cells, the first on line 2");
    bat_curve_set_free(&set);
    set = must_read("lon,lat,v\n1,2,3\n2,3,4\n3,4,high\n", CSV, NULL); // a column that turns out to be text
    char *written = must_write(&set, CSV);
    assert_string_equal(written, "lon,lat,v\n1,2,3\n2,3,4\n3,4,high\n");
    free(written);
    bat_curve_set_free(&set);
    set = must_read("id,x,y\n1,0,0\n2,1,0\n7,2,0\n", CSV, NULL); // no running numbers after all
    written = must_write(&set, CSV);
    assert_string_equal(written, "id,x,y\n1,0,0\n2,1,0\n7,2,0\n");
    free(written);
    bat_curve_set_free(&set);
    set = must_read("id,x,y\n1,0,0\n2,1,0\n\n1,2,0\n2,3,0\n", CSV, NULL);
    written = refine_and_write(&set, "four-point", 1);
    assert_string_equal(written, "id,x,y\n1,0,0\n2,0.5,0\n3,1,0\n\n1,2,0\n2,2.5,0\n3,3,0\n");
    free(written);
    bat_curve_set_free(&set);
    assert_bad("lon,lat,v\n1,2,3\n,3,4\n", CSV, NULL, 3, "column 1: '' is empty; columns chooses");
    assert_bad("lon,lat\n1,2\n1,NA\n", CSV, NULL, 3, "column 2: 'NA' is not a number");
    assert_bad("lon,lat\n500000,5600000\n", CSV, NULL, 2, "; space plane");
    assert_bad("lon,lat,n\n1,2,\"a\n", CSV, NULL, 2, "quote");
    assert_bad("name,time,v\na,b,1\n", CSV, NULL, 1, "; columns names them");
    set = must_read("x,y,\n1,2,\n3,4,,\n,,\n5,6,\n7,8,\n", CSV, NULL); // trailing separators, an empty row
    assert_int_equal(set.count, 2);
    bat_curve_set_free(&set);
    set = must_read("a\tx\ty\tb\n\t1\t2\t\nq\t3\t4\t\n", CSV, NULL); // empty cells at the ends of tabbed rows
    assert_true(set.curves[0].points[3] == 4);
    bat_curve_set_free(&set);
    assert_bad("time,qw,qx,qy,qz\n2024-05-01T12:00:00X,1,0,0,0\n", CSV, NULL, 2, "is not a number");
}

static void times_are_read_and_written(void **state)
{
    (void)state;
    const struct
    {
        const char *text;
        int64_t nanoseconds; ///< -1: no time
    } cases[] = {{"1970-01-01T00:00:00Z", 0},
                 {"1970-01-01T00:00:00.25", 250000000},
                 {"2024-02-29T12:34:56.789012345Z", 1709210096789012345},
                 {"2000-03-01 00:00:00+02:00", 951861600000000000},
                 {"1969-12-31T23:59Z", -60000000000},
                 {"2024-05-01T12:00-0330", 1714577400000000000},
                 {"2024-05-01", -1},
                 {"2023-02-29T00:00:00Z", -1},
                 {"2024-13-01T00:00:00Z", -1},
                 {"2024-05-01T24:00:00Z", -1},
                 {"2024-05-01T12:00:00.Z", -1},
                 {"2024-05-01T12:00:00+", -1},
                 {"2024-05-01T12:00:00Zulu", -1},
                 {"1500-05-01T12:00:00Z", -1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        iso_time time;
        char text[ISO_TIME_SIZE + 1];
        bool good = iso_time_read(cases[i].text, cases[i].text + strlen(cases[i].text), &time);
        if (good != (i < 6))
            fail_msg("%s", cases[i].text);
        if (!good)
            continue;
        assert_int_equal(time.nanoseconds, cases[i].nanoseconds);
        *iso_time_write(text, &time, time.nanoseconds) = '\0';
        assert_string_equal(text, cases[i].text);
        for (int64_t step = 1; step < 1000000000000000000; step *= 7) // every date is its own
        {
            iso_time there;
            int64_t at = time.nanoseconds / 2 + step / 1000 * 1000;
            char *end = iso_time_write(text, &time, at);
            assert_true(iso_time_read(text, end, &there));
            assert_true(llabs(there.nanoseconds - at) <= 500);
        }
    }
}

/// The words for what each format cannot hold; null for nothing.
typedef struct loss
{
    bat_curve_format format;
    const char *words;
} loss;

static void assert_losses(const char *text, bat_curve_format given, const char *space, const loss *losses, size_t count)
{
    bat_curve_set set = must_read(text, given, space);
    for (size_t i = 0; i < count; i++)
    {
        bat_curve_write_options options = bat_curve_write_defaults();
        bat_curve_write_report report;
        char *written;
        size_t size;
        options.format = losses[i].format;
        options.report = &report;
        assert_int_equal(bat_curve_write_memory(&set, &options, &written, &size, NULL), BAT_OK);
        free(written);
        if (losses[i].words == NULL)
            assert_null(report.lost);
        else
            assert_string_equal(report.lost, losses[i].words);
    }
    bat_curve_set_free(&set);
}

#define LOSSES(...) (const loss[]){__VA_ARGS__}, sizeof((const loss[]){__VA_ARGS__}) / sizeof(loss)
#define LINE "\"geometry\":{\"type\":\"LineString\",\"coordinates\":"
#define FEATURES(...) "{\"type\":\"FeatureCollection\",\"features\":[" __VA_ARGS__ "]}"
#define PLAIN "{\"type\":\"Feature\",\"properties\":{}," LINE "[[0,0],[1,1],[2,0]]}}"
#define NAMED "{\"type\":\"Feature\",\"id\":7,\"properties\":{\"name\":\"A\"}," LINE "[[0,0],[1,1],[2,0]]}}"
#define PLACE "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Point\",\"coordinates\":[5,5]}}"
#define DEEP "{\"type\":\"Feature\",\"properties\":{}," LINE "[[0,0,1,5],[1,1,2,6],[2,0,3,7]]}}"

static void what_of_features_a_format_cannot_hold_is_told(void **state)
{
    (void)state;
    static const bat_curve_format geojson = BAT_CURVE_FORMAT_GEOJSON;
    assert_losses(FEATURES(NAMED "," PLACE), geojson, NULL,
                  LOSSES({BAT_CURVE_FORMAT_CSV, "ids, properties, points and other features"},
                         {BAT_CURVE_FORMAT_OBJ, "ids, properties, points and other features"},
                         {BAT_CURVE_FORMAT_WKT, "ids, properties"}, {BAT_CURVE_FORMAT_GEOJSON, NULL},
                         {BAT_CURVE_FORMAT_GEOJSON_LINES, NULL}, {BAT_CURVE_FORMAT_TOPOJSON, NULL},
                         {BAT_CURVE_FORMAT_WKT_CSV, NULL}, {BAT_CURVE_FORMAT_GPX, NULL}));
    assert_losses(FEATURES(PLAIN "," PLACE), geojson, NULL,
                  LOSSES({BAT_CURVE_FORMAT_CSV, "points and other features"}, {BAT_CURVE_FORMAT_WKT, NULL}));
    assert_losses("{\"type\":\"GeometryCollection\",\"geometries\":[{\"type\":\"LineString\",\"coordinates\":[[0,0],[1,1]]},"
                  "{\"type\":\"Point\",\"coordinates\":[5,5]}]}",
                  geojson, NULL, LOSSES({BAT_CURVE_FORMAT_CSV, "points and other features"}, {BAT_CURVE_FORMAT_WKT, NULL}));
    assert_losses(FEATURES(PLAIN), geojson, NULL, LOSSES({BAT_CURVE_FORMAT_CSV, NULL}, {BAT_CURVE_FORMAT_OBJ, NULL}));
    assert_losses(FEATURES(DEEP), geojson, NULL,
                  LOSSES({BAT_CURVE_FORMAT_CSV, NULL}, {BAT_CURVE_FORMAT_GEOJSON, NULL}, {BAT_CURVE_FORMAT_WKT, NULL},
                         {BAT_CURVE_FORMAT_GPX, "measures"}, {BAT_CURVE_FORMAT_OBJ, "altitudes, measures"}));
}

static void what_of_a_table_a_format_cannot_hold_is_told(void **state)
{
    (void)state;
    static const char texts[] = "columns of texts", numbers[] = "times and other numbers of points";
    bat_curve_set set = must_read("x,y,name\n0,0,A\n1,1,B\n2,0,C\n", CSV, NULL);
    assert_non_null(strstr(bat_curve_set_note(&set, 0), "where it is written, new points take that of the point before"));
    bat_curve_set_free(&set);
    assert_losses("x,y,name\n0,0,A\n1,1,B\n2,0,C\n", CSV, NULL,
                  LOSSES({BAT_CURVE_FORMAT_CSV, NULL}, {BAT_CURVE_FORMAT_WKT, texts}, {BAT_CURVE_FORMAT_OBJ, texts}));
    assert_losses("lon,lat,alt,name\n0,0,1,A\n1,1,2,B\n2,0,3,C\n", CSV, NULL,
                  LOSSES({BAT_CURVE_FORMAT_CSV, NULL}, {BAT_CURVE_FORMAT_GEOJSON, texts}, {BAT_CURVE_FORMAT_GPX, NULL},
                         {BAT_CURVE_FORMAT_TOPOJSON, texts}, {BAT_CURVE_FORMAT_WKT_CSV, texts},
                         {BAT_CURVE_FORMAT_OBJ, "columns of texts, times and other numbers of points"}));
    assert_losses("lon,lat,speed\n0,0,1\n1,1,2\n2,0,3\n", CSV, NULL,
                  LOSSES({BAT_CURVE_FORMAT_CSV, NULL}, {BAT_CURVE_FORMAT_GEOJSON, numbers}, {BAT_CURVE_FORMAT_GPX, NULL}));
    assert_losses("lon,lat\n0,0\n1,1\n2,0\n", CSV, NULL,
                  LOSSES({BAT_CURVE_FORMAT_GEOJSON, NULL}, {BAT_CURVE_FORMAT_OBJ, NULL}));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(names_tell_the_coordinates),
                                       cmocka_unit_test(columns_are_chosen),
                                       cmocka_unit_test(a_column_groups_rows),
                                       cmocka_unit_test(carried_columns_go_along),
                                       cmocka_unit_test(times_in_numbers_are_a_channel),
                                       cmocka_unit_test(texts_stay_in_order),
                                       cmocka_unit_test(gaps_and_numbers_are_told_apart),
                                       cmocka_unit_test(times_are_read_and_written),
                                       cmocka_unit_test(what_of_features_a_format_cannot_hold_is_told),
                                       cmocka_unit_test(what_of_a_table_a_format_cannot_hold_is_told)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
