#include "test_io_helpers.h"

#include "curve/curve_attributes.h"

#include <stdio.h>

/// @file
/// GPX: all of a file comes back, and new points get values between.

#define ROOT "<gpx version=\"1.1\" creator=\"x\" xmlns=\"http://www.topografix.com/GPX/1/1\" xmlns:t=\"urn:t\">"
#define TRACK(points) ROOT "<trk><trkseg>" points "</trkseg></trk></gpx>"

static const char FILE_OF_ALL[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" ROOT "\n  <metadata><name>Run &amp; rest</name></metadata>\n"
    "  <!-- a comment -->\n  <wpt lat=\"52.5\" lon=\"13.25\"><ele>34</ele><name>Start</name></wpt>\n"
    "  <rte><name>plan</name><rtept lat=\"10\" lon=\"20\"><name>1</name></rtept><rtept lat=\"11\" lon=\"20\"><name>2</name>"
    "</rtept></rte>\n  <trk>\n    <name>home</name>\n    <trkseg>\n"
    "      <trkpt lat=\"0\" lon=\"10\"><ele>30.5</ele><time>2024-05-06T07:08:09Z</time><fix>3d</fix><extensions><power>200"
    "</power><t:x><t:hr>120</t:hr><t:cad>80</t:cad></t:x></extensions></trkpt>\n"
    "      <trkpt lat=\"0\" "
    "lon=\"11\"><ele>31</ele><time>2024-05-06T07:08:19Z</time><extensions><power>210</power><t:x><t:hr>"
    "126</t:hr></t:x></extensions></trkpt>\n"
    "      <trkpt lat=\"0\" lon=\"11\"><ele>31</ele><time>2024-05-06T07:10:19Z</time></trkpt>\n"
    "      <trkpt lat=\"0\" lon=\"12\"><ele>32</ele><time>2024-05-06T07:10:20.5Z</time></trkpt>\n"
    "    </trkseg>\n  </trk>\n</gpx>\n";

/// Read, refine by one level of a linear scheme, and write.
static char *refined(const char *text, bat_curve_format format)
{
    bat_curve_set set = must_read(text, BAT_CURVE_FORMAT_GPX, NULL), fine;
    bat_curve_refine_options options = bat_curve_refine_defaults();
    bat_curve *curves = calloc(set.count, sizeof *curves);
    assert_non_null(curves);
    options.levels = 1;
    assert_int_equal(bat_curve_scheme_by_name("log-exp-4", &options.scheme, NULL), BAT_OK);
    assert_int_equal(bat_curves_refine(set.curves, set.count, &options, curves, NULL), BAT_OK);
    assert_int_equal(bat_curve_set_like(&set, curves, &fine, NULL), BAT_OK);
    char *written = must_write(&fine, format);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&set);
    return written;
}

static void assert_has(const char *text, const char *words)
{
    if (strstr(text, words) == NULL)
        fail_msg("no '%s' in %s", words, text);
}

static void a_file_comes_back_as_it_was(void **state)
{
    (void)state;
    assert_rewritten(FILE_OF_ALL, BAT_CURVE_FORMAT_GPX, NULL, FILE_OF_ALL);
    static const char prefixed[] =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?><g:gpx version=\"1.0\" xmlns:g=\"u\"><g:rte>"
        "<g:rtept lat=\"1\" lon=\"2\"/><g:rtept lat=\"2\" lon=\"2\"><g:name><![CDATA[<b>]]></g:name>"
        "</g:rtept></g:rte></g:gpx>";
    assert_rewritten(prefixed, BAT_CURVE_FORMAT_GPX, NULL, prefixed);
    static const char zeros[] =
        TRACK("<trkpt lat=\"0\" lon=\"0\"><ele>0</ele></trkpt><trkpt lat=\"1\" lon=\"0\"><ele>0</ele>"
              "</trkpt>");
    assert_rewritten(zeros, BAT_CURVE_FORMAT_GPX, NULL, zeros);
    assert_rewritten("<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><gpx><rte><name>Stra\xDF"
                     "e</name><rtept lat='1' lon='2'/><rtept lat='2' lon='2'></rtept></rte></gpx>",
                     BAT_CURVE_FORMAT_GPX, NULL,
                     "<?xml version=\"1.0\" encoding=\"UTF-8\"?><gpx><rte><name>Stra\xC3\x9F"
                     "e</name><rtept lat=\"1\" lon=\"2\"/><rtept lat=\"2\" lon=\"2\"/></rte></gpx>");
}

static void new_points_get_values_between(void **state)
{
    (void)state;
    char *text = refined(FILE_OF_ALL, BAT_CURVE_FORMAT_GPX);
    assert_has(text, "<trkpt lat=\"0\" lon=\"10.5\"><ele>30.72</ele><time>2024-05-06T07:08:14Z</time><extensions><power>205"
                     "</power><t:x><t:hr>123</t:hr></t:x></extensions></trkpt>");
    assert_has(text, "<rtept lat=\"10.5\" lon=\"20\"/>"); // a name is no number, also where it looks like one
    // The pause stays, and times go on from its end.
    assert_has(text, "07:10:19Z</time></trkpt>\n      <trkpt lat=\"0\" lon=\"11.5\"><ele>31.47</ele>"
                     "<time>2024-05-06T07:10:19.75Z</time></trkpt>");
    static const char *const kept[] = {"<metadata><name>Run &amp; rest</name></metadata>\n  <!-- a comment -->",
                                       "<wpt lat=\"52.5\" lon=\"13.25\"><ele>34</ele><name>Start</name></wpt>",
                                       "<fix>3d</fix><extensions><power>200</power><t:x><t:hr>120</t:hr><t:cad>80</t:cad>"};
    for (size_t i = 0; i < sizeof kept / sizeof *kept; i++)
        assert_has(text, kept[i]);
    free(text);
    // Angles go around: none is between 350 and 10 degrees.
    text = refined(TRACK("<trkpt lat=\"0\" lon=\"0\"><extensions><hr>1</hr><cog>350</cog></extensions></trkpt>"
                         "<trkpt lat=\"0\" lon=\"1\"><extensions><hr>3</hr><cog>10</cog></extensions></trkpt>"),
                   BAT_CURVE_FORMAT_GPX);
    assert_has(text, "lon=\"0.5\"><extensions><hr>2</hr></extensions>");
    free(text);
}

static void single_points_stay_in_the_file(void **state)
{
    (void)state;
    static const char pauses[] =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>" ROOT "<trk>\n <trkseg>\n  <trkpt lat=\"7\" lon=\"8.0\" t:a='1'><time>"
        "2024-05-06T07:08:09Z</time></trkpt>\n  <trkpt lat=\"7\" lon=\"8\"/>\n </trkseg>\n <trkseg>\n  <trkpt lat=\"0\" "
        "lon=\"0\"/>\n  <trkpt lat=\"1\" lon=\"0\"/>\n </trkseg>\n <trkseg><trkpt lat=\"3\" "
        "lon=\"4\"/></trkseg></trk></gpx>";
    bat_curve_set set = must_read(pauses, BAT_CURVE_FORMAT_GPX, NULL);
    assert_int_equal(set.count, 1);
    char *text = must_write(&set, BAT_CURVE_FORMAT_GPX);
    assert_has(text, "<trkpt lat=\"7\" lon=\"8.0\" t:a='1'><time>2024-05-06T07:08:09Z</time></trkpt>\n  <trkpt lat=\"7\"");
    assert_has(text, "<trkseg><trkpt lat=\"3\" lon=\"4\"></trkpt></trkseg></trk></gpx>");
    free(text);
    bat_curve_set_free(&set);
}

/// Bounds after a point are no bounds of the file.
static void bounds_among_points_stay(void **state)
{
    (void)state;
    static const char text[] =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>" ROOT "<rte><rtept lat=\"0\" lon=\"0\"/>"
        "<bounds minlat=\"0\" minlon=\"0\" maxlat=\"1\" maxlon=\"1\"/><rtept lat=\"2\" lon=\"0\"/></rte></gpx>";
    bat_curve_set set = must_read(text, BAT_CURVE_FORMAT_GPX, NULL), again;
    char *written = must_write(&set, BAT_CURVE_FORMAT_GPX);
    assert_true(strncmp(written, text, strlen("<?xml version=\"1.0\" encoding=\"UTF-8\"?>" ROOT)) == 0);
    again = must_read(written, BAT_CURVE_FORMAT_GPX, NULL);
    assert_int_equal(again.curves[0].count, 2);
    bat_curve_set_free(&again);
    free(written);
    bat_curve_set_free(&set);
}

static void a_loop_is_closed_where_times_allow(void **state)
{
    (void)state;
#define CORNERS "<trkpt lat=\"0\" lon=\"0\"/><trkpt lat=\"0\" lon=\"1\"/><trkpt lat=\"1\" lon=\"1\"/>"
    bat_curve_set set =
        must_read(TRACK(CORNERS "<trkpt lat=\"0\" lon=\"0\"><name>end</name></trkpt>"), BAT_CURVE_FORMAT_GPX, NULL);
    assert_true(set.curves[0].closed);
    assert_int_equal(set.curves[0].count, 3);
    char *text = must_write(&set, BAT_CURVE_FORMAT_GPX);
    assert_has(text, CORNERS "<trkpt lat=\"0\" lon=\"0\"><name>end</name></trkpt></trkseg>");
    free(text);
    bat_curve_set_free(&set);
    set = must_read(TRACK(CORNERS "<trkpt lat=\"0\" lon=\"0\"><time>2024-05-06T07:08:09Z</time></trkpt>"),
                    BAT_CURVE_FORMAT_GPX, NULL);
    assert_false(set.curves[0].closed);
    bat_curve_set_free(&set);
}

static void bounds_grow_with_the_curves(void **state)
{
    (void)state;
    char *text = refined(ROOT "<metadata><bounds minlat=\"-1\" minlon=\"0\" maxlat=\"1\" maxlon=\"1\"/></metadata><rte>"
                              "<rtept lat=\"0\" lon=\"0\"/><rtept lat=\"1\" lon=\"0\"/><rtept lat=\"1\" lon=\"1\"/><rtept "
                              "lat=\"0\" lon=\"1\"/></rte></gpx>",
                         BAT_CURVE_FORMAT_GPX);
    double top;
    const char *at = strstr(text, "maxlat=\"");
    assert_non_null(at);
    assert_int_equal(sscanf(at, "maxlat=\"%lf", &top), 1);
    assert_true(top > 1.05 && top < 1.3);
    assert_has(text, "<bounds minlon=\"-0.06");
    free(text);
}

static void other_formats_keep_times(void **state)
{
    (void)state;
    char *text = refined(FILE_OF_ALL, BAT_CURVE_FORMAT_CSV);
    assert_has(text, "lon,lat,ele,time,name,fix,power,hr,cad\n");
    assert_has(text, "\n10.5,0,30.75,2024-05-06T07:08:14Z,,3d,205,123,\n");
    free(text);
    text = refined(FILE_OF_ALL, BAT_CURVE_FORMAT_GEOJSON);
    assert_has(text, "[[10,0,30.5],[10.5,0,30.71875]");
    assert_has(text, "\"coordinateProperties\":{\"times\":[\"2024-05-06T07:08:09Z\",\"2024-05-06T07:08:14Z\",");
    assert_has(text, "\"fix\":[\"3d\",null,null,null,null]");
    assert_has(text, "\"hr\":[120,123,126,null,null]");
    assert_has(text, "\"properties\":{\"name\":\"Start\"}");
    free(text);
    // At the antimeridian, where a line is cut.
    text = refined(TRACK("<trkpt lat=\"0\" lon=\"179\"><time>2020-01-01T00:00:00Z</time></trkpt>"
                         "<trkpt lat=\"0\" lon=\"-178\"><time>2020-01-01T00:00:30Z</time></trkpt>"),
                   BAT_CURVE_FORMAT_GEOJSON);
    assert_has(text, "\"coordinates\":[[[179,0],[180,0]],[[-180,0],[-179.5,0],[-178,0]]]");
    assert_has(text, "\"times\":[[\"2020-01-01T00:00:00Z\",\"2020-01-01T00:00:10Z\"],[\"2020-01-01T00:00:10Z\","
                     "\"2020-01-01T00:00:15Z\",\"2020-01-01T00:00:30Z\"]]");
    free(text);
}

static void what_a_format_cannot_hold_is_told(void **state)
{
    (void)state;
    static const struct
    {
        bat_curve_format format;
        const char *words;
    } cases[] = {{BAT_CURVE_FORMAT_CSV, "waypoints"}, {BAT_CURVE_FORMAT_GEOJSON, "repeat"}, {BAT_CURVE_FORMAT_GPX, NULL}};
    bat_curve_set set = must_read(FILE_OF_ALL, BAT_CURVE_FORMAT_GPX, NULL);
    assert_has(bat_curve_set_note(&set, 0), "1 point repeats the one before it, the first on line 12");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_curve_write_options options = bat_curve_write_defaults();
        bat_curve_write_report report;
        char *text;
        size_t size;
        options.format = cases[i].format;
        options.report = &report;
        assert_int_equal(bat_curve_write_memory(&set, &options, &text, &size, NULL), BAT_OK);
        assert_true((report.lost == NULL) == (cases[i].words == NULL));
        if (report.lost != NULL)
            assert_has(report.lost, cases[i].words);
        free(text);
    }
    bat_curve_set_free(&set);
}

static void other_formats_become_gpx(void **state)
{
    (void)state;
    bat_curve_set set =
        must_read("{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{\"name\":"
                  "\"a<b\",\"lanes 2\":2},\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[1,2,3],[4,5,6]]"
                  "}},{\"type\":\"Feature\",\"properties\":{\"sym\":\"Flag\"},\"geometry\":{\"type\":\"Point\","
                  "\"coordinates\":[7,8]}}]}",
                  BAT_CURVE_FORMAT_GEOJSON, NULL);
    char *text = must_write(&set, BAT_CURVE_FORMAT_GPX);
    bat_curve_set_free(&set);
    assert_has(text, "<wpt lat=\"8\" lon=\"7\"><sym>Flag</sym></wpt>\n<trk><name>a&lt;b</name><extensions><ogr:lanes_2>2<");
    assert_has(text, "<trkpt lat=\"2\" lon=\"1\"><ele>3</ele></trkpt>");
    set = must_read(text, BAT_CURVE_FORMAT_GPX, NULL); // it is GPX itself
    bat_curve_set_free(&set);
    free(text);
    set = must_read("lon,lat,ele,time,hr\n1,2,3,2024-05-06T07:08:09Z,120\n4,5,6,2024-05-06T07:08:10Z,\n",
                    BAT_CURVE_FORMAT_CSV, NULL);
    text = must_write(&set, BAT_CURVE_FORMAT_GPX);
    bat_curve_set_free(&set);
    assert_has(text,
               "<trkpt lat=\"2\" lon=\"1\"><ele>3</ele><time>2024-05-06T07:08:09Z</time><extensions><ogr:hr>120</ogr:hr>"
               "</extensions></trkpt>");
    free(text);
    static const char polygon[] = "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[1,0],[1,1],[0,0]]]}";
    bat_curve_write_options options = bat_curve_write_defaults();
    bat_error error;
    size_t size;
    options.format = BAT_CURVE_FORMAT_GPX;
    set = must_read(polygon, BAT_CURVE_FORMAT_GEOJSON, NULL);
    assert_int_equal(bat_curve_write_memory(&set, &options, &text, &size, &error), BAT_UNSUPPORTED);
    assert_has(error.text, "no polygons");
    bat_curve_set_free(&set);
    set = must_read("0,0\n1,1\n", BAT_CURVE_FORMAT_CSV, NULL);
    assert_int_equal(bat_curve_write_memory(&set, &options, &text, &size, &error), BAT_UNSUPPORTED);
    assert_has(error.text, "plane");
    bat_curve_set_free(&set);
}

static void geojson_with_times_becomes_gpx(void **state)
{
    (void)state;
    static const char text[] = "{\"type\":\"Feature\",\"properties\":{\"a\":1,\"coordinateProperties\":{\"times\":[[\"2020-"
                               "01-01T00:00:00Z\",\"2020-01-01T"
                               "00:00:10Z\"],[null,\"x\"]],\"hr\":[[1,2],[3,null]]}},\"geometry\":{\"type\":"
                               "\"MultiLineString\",\"coordinates\":[[[0,0],"
                               "[1,1]],[[2,2],[3,3]]]}}";
    bat_curve_set set = must_read(text, BAT_CURVE_FORMAT_GEOJSON, NULL);
    char *written = must_write(&set, BAT_CURVE_FORMAT_GPX);
    assert_has(written,
               "<extensions><ogr:a>1</ogr:a></extensions>\n<trkseg>\n<trkpt lat=\"0\" lon=\"0\"><time>2020-01-01T00:00:00Z"
               "</time><extensions><ogr:hr>1</ogr:hr></extensions></trkpt>");
    assert_has(written, "<trkpt lat=\"3\" lon=\"3\"><time>x</time></trkpt>");
    free(written);
    written = must_write(&set, BAT_CURVE_FORMAT_GEOJSON);
    assert_has(written, "\"hr\":[[1,2],[3,null]]");
    free(written);
    // Values for each given point are not those of the refined curve.
    bat_curve more = {.space = set.space, .points = malloc(3 * 3 * sizeof(double)), .count = 3};
    assert_non_null(more.points);
    memcpy(more.points, set.curves[0].points, 6 * sizeof(double));
    memcpy(more.points + 6, set.curves[1].points, 3 * sizeof(double));
    bat_curve_free(&set.curves[0]);
    set.curves[0] = more;
    bat_curve_write_options options = bat_curve_write_defaults();
    bat_curve_write_report report;
    size_t size;
    options.report = &report;
    assert_int_equal(bat_curve_write_memory(&set, &options, &written, &size, NULL), BAT_OK);
    assert_has(written, "\"properties\":{\"a\":1}");
    assert_has(report.lost, "each given point");
    free(written);
    bat_curve_set_free(&set);
}

static void bad_files_are_refused(void **state)
{
    (void)state;
    static const struct
    {
        const char *text, *words;
        size_t line;
    } cases[] = {
        {"", "no element", 1},
        {"<kml/>", "no GPX", 1},
        {"<gpx>\n<trk>", "no element", 2},
        {"<gpx>\n</trk>", "mismatched", 2},
        {"<!DOCTYPE gpx [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;\">]>\n<gpx>&b;</gpx>", "document type", 1},
        {"<gpx>\n&b;</gpx>", "undefined entity", 2},
        {"<gpx><rte>\n<rtept lat=\"91\" lon=\"0\"/></rte></gpx>", "latitude", 2},
        {"<gpx><rte>\n<rtept lat=\"9\"/></rte></gpx>", "no attribute lon", 2},
        {"<gpx><wpt lat=\"9\" lon=\"1e\"/></gpx>", "is not a number", 1},
        {"<gpx></gpx>", "no lines or polygons", 0},
        {"<gpx><wpt lat=\"1\" lon=\"2\"/></gpx>", "only waypoints", 0},
        {"<gpx><trk><trkseg><trkpt lat=\"1\" lon=\"2\"/></trkseg></trk></gpx>", "no track or route has two points", 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_bad(cases[i].text, BAT_CURVE_FORMAT_GPX, NULL, cases[i].line, cases[i].words);
    char deep[4096] = "<gpx>";
    for (size_t i = 0; i < 1000; i++)
        memcpy(deep + 5 + 3 * i, "<a>", sizeof "<a>");
    assert_bad(deep, BAT_CURVE_FORMAT_GPX, NULL, 1, "nested");
    bat_curve_set set;
    bat_error error;
    assert_int_equal(read_string(FILE_OF_ALL, BAT_CURVE_FORMAT_GPX, "disk", &set, &error), BAT_UNSUPPORTED);
    bat_curve_read_options options = bat_curve_read_defaults();
    options.strict = true;
    assert_int_equal(bat_curve_read_memory(FILE_OF_ALL, strlen(FILE_OF_ALL), &options, &set, &error), BAT_BAD_FILE);
    assert_int_equal(error.line, 12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_comes_back_as_it_was),
        cmocka_unit_test(new_points_get_values_between),
        cmocka_unit_test(single_points_stay_in_the_file),
        cmocka_unit_test(bounds_among_points_stay),
        cmocka_unit_test(a_loop_is_closed_where_times_allow),
        cmocka_unit_test(bounds_grow_with_the_curves),
        cmocka_unit_test(other_formats_keep_times),
        cmocka_unit_test(what_a_format_cannot_hold_is_told),
        cmocka_unit_test(other_formats_become_gpx),
        cmocka_unit_test(geojson_with_times_becomes_gpx),
        cmocka_unit_test(bad_files_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
