#include "test_io_helpers.h"

#include <jansson.h>
#include <stdio.h>

static const bat_curve_format GEOJSON = BAT_CURVE_FORMAT_GEOJSON;

#define LINE(coordinates) "{\"type\":\"LineString\",\"coordinates\":" coordinates "}"
#define POLYGON(coordinates) "{\"type\":\"Polygon\",\"coordinates\":" coordinates "}"
#define FEATURE(geometry) "{\"type\":\"Feature\",\"properties\":{},\"geometry\":" geometry "}"
#define COLLECTION(features) "{\"type\":\"FeatureCollection\",\"features\":[\n" features "\n]}\n"

/// Remove bounding boxes, which writers drop for features with curves and keep for others.
static void drop_boxes(json_t *root)
{
    (void)json_object_del(root, "bbox");
    (void)json_object_del(json_array_get(json_object_get(root, "features"), 0), "bbox");
}

static void all_but_the_curves_survives(void **state)
{
    (void)state;
    const char *path = TEST_DATA "/io/places.geojson";
    bat_curve_set set = {0};
    bat_error error;
    if (bat_curve_read(path, NULL, &set, &error) != BAT_OK)
        fail_msg("%s", error.text);
    assert_int_equal(set.count, 7);
    assert_string_equal(set.space->name, "sphere");
    char *text = must_write(&set, BAT_CURVE_FORMAT_AUTO);
    json_t *before = json_load_file(path, 0, NULL), *after = json_loads(text, 0, NULL);
    drop_boxes(before);
    char *sorted[2] = {json_dumps(before, JSON_SORT_KEYS | JSON_REAL_PRECISION(12)),
                       json_dumps(after, JSON_SORT_KEYS | JSON_REAL_PRECISION(12))};
    assert_string_equal(sorted[0], sorted[1]);
    assert_non_null(strstr(text, "\"depth\":0.1,\"count\":3,\"real\":2.0,"));
    assert_true(strstr(text, "\"name\":\"places\"") < strstr(text, "\"features\""));
    assert_true(strstr(text, "\"after\"") > strstr(text, "\"features\""));
    free(sorted[0]);
    free(sorted[1]);
    json_decref(before);
    json_decref(after);
    free(text);
    bat_curve_set_free(&set);
}

/// A line, a polygon with a hole beside a line, and two polygons of one feature.
static void rings_know_their_polygons(void **state)
{
    (void)state;
#define TWO_RINGS POLYGON("[[[0,0],[9,0],[9,9],[0,0]],[[5,1],[8,1],[8,4],[5,1]]]")
#define MIXED "{\"type\":\"GeometryCollection\",\"geometries\":[" TWO_RINGS "," LINE("[[2,0],[3,0]]") "]}"
#define TWO_PARTS "[[[[0,0],[1,0],[1,1],[0,0]]],[[[4,0],[5,0],[5,1],[4,0]]]]"
#define PARTS "{\"type\":\"MultiPolygon\",\"coordinates\":" TWO_PARTS "}"
    const char *text = COLLECTION(FEATURE(LINE("[[0,0],[1,0]]")) "," FEATURE(MIXED) "," FEATURE(PARTS));
    bat_curve_set set = {0};
    bat_error error;
    if (bat_curve_read_memory(text, strlen(text), NULL, &set, &error) != BAT_OK)
        fail_msg("%s", error.text);
    const size_t line = BAT_NO_INDEX;
    const size_t polygons[] = {line, 0, 0, line, 1, 2}, features[] = {line, 1, 1, line, 2, 2};
    assert_int_equal(set.count, 6);
    for (size_t i = 0; i < 7; i++)
    {
        size_t polygon = BAT_NO_INDEX, feature = BAT_NO_INDEX;
        bool rings = bat_curve_set_polygon(&set, i, &polygon, &feature);
        assert_int_equal(rings, i < 6 && polygons[i] != line);
        assert_int_equal(polygon, i < 6 ? polygons[i] : line);
        assert_int_equal(feature, i < 6 ? features[i] : line);
    }
    bat_curve_set_free(&set);
    const char *closed = "lon,lat\n0,0\n1,0\n1,1\n0,0\n", *flat = "x,y\n0,0\n1,0\n1,1\n0,0\n";
    size_t polygon, feature;
    assert_int_equal(bat_curve_read_memory(closed, strlen(closed), NULL, &set, NULL), BAT_OK);
    assert_true(bat_curve_set_polygon(&set, 0, &polygon, &feature) == set.curves[0].closed);
    bat_curve_set_free(&set);
    assert_int_equal(bat_curve_read_memory(flat, strlen(flat), NULL, &set, NULL), BAT_OK);
    assert_false(bat_curve_set_polygon(&set, 0, &polygon, &feature));
    bat_curve_set_free(&set);
}

static void geometries_become_curves(void **state)
{
    (void)state;
    bat_curve_set set = {0};
    assert_int_equal(bat_curve_read(TEST_DATA "/io/places.geojson", NULL, &set, NULL), BAT_OK);
    const struct
    {
        size_t count, channels, line;
        bool closed;
    } expected[] = {{3, 0, 6, false}, {3, 0, 20, true}, {3, 0, 20, true}, {2, 1, 20, false},
                    {3, 1, 20, true}, {3, 0, 20, true}, {3, 0, 20, true}};
    for (size_t i = 0; i < set.count; i++)
    {
        assert_int_equal(set.curves[i].count, expected[i].count);
        assert_int_equal(set.curves[i].channel_count, expected[i].channels);
        assert_int_equal(set.curves[i].closed, expected[i].closed);
        assert_int_equal(bat_curve_set_line(&set, i, 0), expected[i].line);
    }
    assert_true(set.curves[3].channels[1] == 200.5);
    const double *point = set.curves[0].points + 6;
    assert_true(fabs(atan2(point[1], point[0]) - acos(-1.0) / 9) < 1e-15);
    bat_curve_set_free(&set);
}

/// Members that resemble coordinates, coordinates that only the parser finds, and any order of members: all are preserved.
static void what_looks_like_coordinates_survives(void **state)
{
    (void)state;
    const char *texts[] = {
        FEATURE(LINE("[[0,0],[1,1]]")),
        "{\"type\":\"Feature\",\"coordinates\":[7],\"geometries\":[{\"coordinates\":[1,2.0]}],\"geometry\":" LINE(
            "[[0,0],[1,1]]") ",\"properties\":{\"geometry\":" LINE("[[5,5],[6,6]]") ",\"coordinates\":[0]}}",
        "{\"coordinates\":[[0,0],[1,1]],\"geometries\":[{\"type\":\"LineString\",\"coordinates\":[[3,3],[4,4]]}],"
        "\"a\":{\"coordinates\":[0]},\"type\":\"LineString\"}",
        "{\"type\":\"GeometryCollection\",\"coordinates\":[0],\"geometries\":[{\"type\":\"Point\",\"coordinates\":[1,"
        "2]},{\"type\":\"GeometryCollection\",\"geometries\":[]},{\"type\":\"LineString\",\"coordinates\":[]}," LINE(
            "[[0,0],[1,1]]") "," POLYGON("[[[0,0],[1,0],[1,1],[0,0]],[[2,0],[3,0],[3,1],[2,0]]]") "]}"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    {
        char expected[1024];
        (void)snprintf(expected, sizeof expected, "%s\n", texts[i]);
        assert_rewritten(texts[i], GEOJSON, NULL, expected);
    }
    const char *spelled[] = {"{\"type\":\"LineString\",\"coordin\\u0061tes\":[[0,0],\n[1,1]]}",
                             "{\"typ\\u0065\":\"LineString\",\"coordinates\":[[0,0],\n[1,1]]}",
                             "{\"type\":\"Line\\u0053tring\",\"coordinates\":[[0,0],\n[1,1]]}",
                             "{ \"type\" : \"LineString\" , \"coordinates\" : [ [ 0 , 0 ] ,\r\n\t[ 1e0 , 1.0 ] ] }"};
    for (size_t i = 0; i < sizeof spelled / sizeof *spelled; i++)
        assert_rewritten(spelled[i], GEOJSON, NULL, LINE("[[0,0],[1,1]]") "\n");
    // None of these may be mistaken for the index of an extracted array.
    assert_bad("{\"type\":\"GeometryCollection\",\"geometries\":[" LINE(
                   "[[0,0],[1,1]]") ",{\"type\":\"Line\\u0053tring\",\"coordinates\":[0]}]}",
               GEOJSON, NULL, 0, "geometry 1, position 0: a position must be");
    assert_bad("{\"type\":\"GeometryCollection\",\"geometries\":[" LINE("[[0,0],[1,1]]") "," LINE("[0]") "]}", GEOJSON, NULL,
               0, "geometry 1, position 0: a position must be");
}

/// Errors inside an array of numbers are syntax errors.
static void wrong_numbers_are_wrong_syntax(void **state)
{
    (void)state;
    const char *bad[] = {"[[0,0],[01,1]]", "[[0,0],[1.,1]]", "[[0,0],[.5,1]]", "[[0,0],[+1,1]]",
                         "[[0,0],[1e,1]]", "[[0,0],[-,1]]",  "[[0,0],[1,1],]", "[[0,0][1,1]]",
                         "[[0,0],[1 1]]",  "[[0,0],[1,1]",   "[[0,0],[1,,1]]", "[[0,0],[]1]"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    {
        char text[128];
        (void)snprintf(text, sizeof text, "{\"type\":\"LineString\",\n\"coordinates\":%s}", bad[i]);
        assert_bad(text, GEOJSON, NULL, 2, "");
    }
}

static void every_kind_of_root_is_read(void **state)
{
    (void)state;
    assert_rewritten(LINE("[[1,2],[3,4]]"), GEOJSON, NULL, LINE("[[1,2],[3,4]]") "\n");
    assert_rewritten(FEATURE(LINE("[[1,2],[3,4]]")), BAT_CURVE_FORMAT_AUTO, NULL, FEATURE(LINE("[[1,2],[3,4]]")) "\n");
    assert_rewritten(COLLECTION(FEATURE(LINE("[[1,2],[3,4]]"))), GEOJSON, NULL, COLLECTION(FEATURE(LINE("[[1,2],[3,4]]"))));
    // Keys with escapes, and a collection whose features are in an unusual place.
    assert_rewritten("{\"type\":\"FeatureCollection\",\"feat\\u0075res\":[" FEATURE(LINE("[[1,2],[3,4]]")) "]}", GEOJSON,
                     NULL, COLLECTION(FEATURE(LINE("[[1,2],[3,4]]"))));
    assert_rewritten("{\"features\":[{}],\"type\":\"LineString\",\"coordinates\":[[1,2],[3,4]]}", GEOJSON, NULL,
                     "{\"features\":[{}],\"type\":\"LineString\",\"coordinates\":[[1,2],[3,4]]}\n");
}

static void closed_lines_and_rings_repeat_their_first_position(void **state)
{
    (void)state;
    const char *ring = LINE("[[1,2],[3,4],[5,2],[1,2]]");
    bat_curve_set set = must_read(ring, GEOJSON, NULL);
    assert_true(set.curves[0].closed);
    assert_int_equal(set.curves[0].count, 3);
    bat_curve_set_free(&set);
    assert_rewritten(ring, GEOJSON, NULL, LINE("[[1,2],[3,4],[5,2],[1,2]]") "\n");
    set = must_read(LINE("[[1,2],[3,4],[1,2]]"), GEOJSON, NULL);
    assert_false(set.curves[0].closed);
    bat_curve_set_free(&set);
    set = must_read(LINE("[[1,2,0],[3,4,0],[5,2,0],[1,2,1]]"), GEOJSON, NULL);
    assert_false(set.curves[0].closed);
    bat_curve_set_free(&set);
}

static void an_option_opens_or_closes_lines(void **state)
{
    (void)state;
    const char *text = "{\"type\":\"MultiLineString\",\"coordinates\":[[[1,2],[3,4],[5,2],[1,2]],[[1,2],[3,4],[5,2]]]}";
    const size_t counts[2][2] = {{4, 3}, {3, 3}};
    for (int closed = 0; closed <= 1; closed++)
    {
        bat_curve_read_options options = bat_curve_read_defaults();
        options.closed = closed;
        bat_curve_set set = {0};
        assert_int_equal(bat_curve_read_memory(text, strlen(text), &options, &set, NULL), BAT_OK);
        for (size_t i = 0; i < 2; i++)
        {
            assert_int_equal(set.curves[i].closed, closed);
            assert_int_equal(set.curves[i].count, counts[closed][i]);
        }
        bat_curve_set_free(&set);
    }
}

static void plain_coordinates_are_kept_exactly(void **state)
{
    (void)state;
    const char *text = POLYGON("[[[0.1,-1e300,1e-7],[1234.5678901234567,4,0],[5,2,0],[0.1,-1e300,1e-7]]]");
    bat_curve_set set = must_read(text, GEOJSON, "plane");
    assert_string_equal(set.space->name, "plane");
    char *written = must_write(&set, GEOJSON);
    bat_curve_set back = must_read(written, GEOJSON, "plane");
    assert_memory_equal(set.curves[0].points, back.curves[0].points, 6 * sizeof(double));
    assert_memory_equal(set.curves[0].channels, back.curves[0].channels, 3 * sizeof(double));
    free(written);
    bat_curve_set_free(&set);
    bat_curve_set_free(&back);
    assert_bad(LINE("[[0,0],[1,0]]"), GEOJSON, "disk", 0, "position 1: the point is");
}

static void longitudes_beyond_the_meridian_wrap(void **state)
{
    (void)state;
    assert_rewritten(LINE("[[350,10],[359,10]]"), GEOJSON, NULL, LINE("[[-10,10],[-1,10]]") "\n");
}

static void other_formats_carry_the_curves_over(void **state)
{
    (void)state;
    bat_curve_set set = must_read(LINE("[[12.5,-45,100],[13,-44,7.25]]"), GEOJSON, NULL);
    char *csv = must_write(&set, BAT_CURVE_FORMAT_CSV);
    assert_string_equal(csv, "lon,lat,alt\n12.5,-45,100\n13,-44,7.25\n");
    bat_curve_set back = must_read(csv, BAT_CURVE_FORMAT_CSV, NULL);
    char *json = must_write(&back, GEOJSON);
    assert_string_equal(json, COLLECTION(FEATURE(LINE("[[12.5,-45,100],[13,-44,7.25]]"))));
    free(csv);
    free(json);
    bat_curve_set_free(&set);
    bat_curve_set_free(&back);
}

static void precision_is_an_option(void **state)
{
    (void)state;
    bat_curve_set set = must_read(LINE("[[12.3456789,-45.5],[-0.0004,44.99999]]"), GEOJSON, NULL);
    bat_curve_write_options options = bat_curve_write_defaults();
    options.precision = 3;
    char *text;
    size_t size;
    assert_int_equal(bat_curve_write_memory(&set, &options, &text, &size, NULL), BAT_OK);
    assert_string_equal(text, LINE("[[12.346,-45.5],[0,45]]") "\n");
    free(text);
    bat_curve_set_free(&set);
}

/// A collection of many features, enough for several batches and blocks.
static char *many_features(size_t count)
{
    char *text = malloc(count * 256 + 128);
    char *out = text + sprintf(text, "{\"type\":\"FeatureCollection\",\"features\":[");
    for (size_t i = 0; i < count; i++)
    {
        double longitude = (double)(i % 340) - 170.0;
        out += sprintf(out, "%s\n{\"type\":\"Feature\",\"id\":%zu,\"properties\":{\"a\":\"}]{[\\\"\"},\"geometry\":",
                       i > 0 ? "," : "", i);
        if (i % 3 == 0)
            out += sprintf(out, POLYGON("[[[%g,0],[%g,20],[%g,20],[%g,0]]]") "}", longitude, longitude, longitude + 20,
                           longitude);
        else
            out += sprintf(out, LINE("[[%g,0],[%g,%zu]]") "}", longitude,
                           longitude + 30 > 180 ? longitude - 330 : longitude + 30, i % 60);
    }
    (void)sprintf(out, "\n]}\n");
    return text;
}

/// Write a geometry by three decimals.
static bat_status write_coarsely(const char *geometry, bat_curve_write_report *report, char **text, bat_error *error)
{
    bat_curve_set set;
    size_t size;
    assert_int_equal(read_string(geometry, GEOJSON, NULL, &set, error), BAT_OK);
    bat_curve_write_options options = bat_curve_write_defaults();
    options.precision = 3;
    options.report = report;
    bat_status status = bat_curve_write_memory(&set, &options, text, &size, error);
    bat_curve_set_free(&set);
    return status;
}

static void rounding_leaves_no_degenerate_rings(void **state)
{
    (void)state;
    const char *rings =
        "{\"type\":\"MultiPolygon\",\"coordinates\":["
        "[[[1.0001,1],[1.0002,1],[1.0003,1.0004],[1.0001,1]],[[1.0001,1],[1.0002,1],[1.0002,1.0001],[1.0001,1]]],"
        "[[[0,0],[1.0001,0],[1.0002,0],[1,1],[0.0001,0.0001],[0,0]],"
        "[[0.5,0.3],[0.5001,0.3],[0.5001,0.3001],[0.5,0.3]],[[0.6,0.1],[0.6,0.2],[0.7,0.2],[0.6,0.1]]]]}";
    const char *rounded = "[[[[0,0],[1,0],[1,1],[0,0]],[[0.6,0.1],[0.6,0.2],[0.7,0.2],[0.6,0.1]]]]";
    bat_curve_write_report report;
    bat_error error;
    char *text;
    assert_int_equal(write_coarsely(rings, &report, &text, &error), BAT_OK);
    assert_non_null(strstr(text, rounded));
    assert_int_equal(report.left_out, 3);
    assert_int_equal(report.first_left_out, 0);
    free(text);
    const char *alone = POLYGON("[[[1.0001,1],[1.0002,1],[1.0003,1.0004],[1.0001,1]]]");
    assert_int_equal(write_coarsely(alone, &report, &text, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error.text, "no extent at 3 decimals"));
    assert_int_equal(write_coarsely(LINE("[[2,1],[2.0001,1]]"), NULL, &text, &error), BAT_UNSUPPORTED);
    assert_int_equal(write_coarsely(LINE("[[2,1],[2.0001,1],[3,1]]"), &report, &text, &error), BAT_OK);
    assert_non_null(strstr(text, "[[2,1],[3,1]]"));
    assert_int_equal(report.left_out, 0);
    assert_int_equal(report.first_left_out, BAT_NO_INDEX);
    free(text);
}

static void results_do_not_depend_on_threads(void **state)
{
    (void)state;
    char *text = many_features(9000);
    char *written[3];
    for (int threads = 1; threads <= 3; threads++)
    {
        bat_curve_read_options reading = bat_curve_read_defaults();
        reading.threads = threads;
        bat_curve_set set = {0};
        assert_int_equal(bat_curve_read_memory(text, strlen(text), &reading, &set, NULL), BAT_OK);
        assert_int_equal(set.count, 9000);
        assert_int_equal(bat_curve_set_line(&set, 8999, 0), 9001);
        bat_curve_write_options writing = bat_curve_write_defaults();
        writing.threads = threads;
        size_t size;
        assert_int_equal(bat_curve_write_memory(&set, &writing, &written[threads - 1], &size, NULL), BAT_OK);
        bat_curve_set_free(&set);
    }
    assert_string_equal(written[0], written[1]);
    assert_string_equal(written[0], written[2]);
    // Of several errors the first is reported.
    char *late = strstr(strstr(text, "\"id\":8000"), "Feature"),
         *early = strstr(strstr(text, "\"id\":2000"), "\"geometry\"");
    *late = 'f';
    early[1] = 'G';
    assert_bad(text, GEOJSON, NULL, 2002, "feature 2000 (id 2000): the feature has no geometry");
    for (int i = 0; i < 3; i++)
        free(written[i]);
    free(text);
}

static void a_refined_set_keeps_the_attributes(void **state)
{
    (void)state;
    bat_curve_set set = must_read(
        COLLECTION("{\"type\":\"Feature\",\"id\":7,\"geometry\":" LINE("[[0,0],[90,0]]") ",\"properties\":{\"a\":1}}"),
        GEOJSON, NULL);
    bat_curve *curves = malloc(sizeof *curves);
    double *points = malloc(9 * sizeof *points);
    const double values[9] = {1, 0, 0, sqrt(0.5), sqrt(0.5), 0, 0, 1, 0};
    memcpy(points, values, sizeof values);
    bat_space space = bat_sphere(2);
    curves[0] = (bat_curve){.space = &space, .points = points, .count = 3};
    bat_curve_set fine;
    assert_int_equal(bat_curve_set_like(&set, curves, &fine, NULL), BAT_OK);
    assert_ptr_equal(fine.curves[0].space, fine.space);
    assert_ptr_not_equal(fine.space, set.space);
    assert_int_equal(bat_curve_set_line(&fine, 0, 2), 2);
    bat_curve_set_free(&set);
    char *text = must_write(&fine, BAT_CURVE_FORMAT_AUTO);
    assert_string_equal(text, COLLECTION("{\"type\":\"Feature\",\"id\":7,\"geometry\":" LINE(
                                  "[[0,0],[45,0],[90,0]]") ",\"properties\":{\"a\":1}}"));
    free(text);
    bat_space plane = bat_euclidean(2);
    bat_curve wrong = {.space = &plane, .count = 1};
    bat_error error;
    bat_curve_set result;
    assert_int_equal(bat_curve_set_like(&fine, &wrong, &result, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_curve_set_take(NULL, 0, &result, &error), BAT_INVALID_ARGUMENT);
    bat_curve_set_free(&fine);
}

static void bad_syntax_names_its_line(void **state)
{
    (void)state;
    assert_bad("", GEOJSON, NULL, 1, "");
    assert_bad("[]", GEOJSON, NULL, 0, "must be an object");
    assert_bad("{\"type\":\"LineString\",\n\"coordinates\":[[0,0],[1,", GEOJSON, NULL, 2, "near end of file");
    assert_bad("{\"type\":\"LineString\",\n\"coordinates\":[[0,0],\n[NaN,1]]}", GEOJSON, NULL, 3, "invalid token");
    assert_bad("{\"type\":\"LineString\",\n\"coordinates\":[[0,0],[1e999,1]]}", GEOJSON, NULL, 0,
               "position 1: a number is too large");
    assert_bad("{\"type\":\"LineString\",\n\"coordinates\":[[0,0],[1,1]],\"a\":1e999}", GEOJSON, NULL, 2, "overflow");
    assert_bad("{\"type\":\"LineString\",\"a\":\n\"\xFF\",\"coordinates\":[[0,0],[1,1]]}", GEOJSON, NULL, 2, "");
    assert_bad(LINE("[[0,0],[1,1]]") "x", GEOJSON, NULL, 1, "end of file expected");
    assert_bad("{\"type\":\"LineString\",\"type\":\"Point\"}", GEOJSON, NULL, 1, "duplicate");
    // The line is correct in a collection, whose features are parsed separately.
    assert_bad(COLLECTION(FEATURE(LINE("[[0,0],[1,1]]")) ",\n" FEATURE(LINE("[[0,0],\n[1,,1]]"))), GEOJSON, NULL, 4, "");
    assert_bad(COLLECTION(FEATURE(LINE("[[0,0],[1,1]]")) ",\n"), GEOJSON, NULL, 4, "");
    assert_bad(COLLECTION(FEATURE(LINE("[[0,0],[1,1]]"))) "x", GEOJSON, NULL, 4, "end of file expected");
    assert_bad("{\"type\":\"FeatureCollection\",\"features\":[\n" FEATURE(LINE("[[0,0],[1,1]]")) "\n", GEOJSON, NULL, 3, "");
}

static void deep_nesting_is_refused(void **state)
{
    (void)state;
    enum
    {
        DEPTH = 100000
    };
    char *text = malloc(DEPTH + 64);
    (void)strcpy(text, "{\"type\":\"LineString\",\"coordinates\":");
    size_t length = strlen(text);
    memset(text + length, '[', DEPTH);
    text[length + DEPTH] = '\0';
    assert_bad(text, GEOJSON, NULL, 1, "depth");
    free(text);
}

static void wrong_structure_names_its_place(void **state)
{
    (void)state;
    const struct
    {
        const char *text;
        size_t line;
        const char *words;
    } cases[] = {
        {"{}", 0, "has an unknown type"},
        {"{\"type\":\"Circle\"}", 0, "has an unknown type"},
        {"{\"type\":\"FeatureCollection\"}", 0, "no array of features"},
        {COLLECTION(""), 0, "no lines or polygons"},
        {"{\"type\":\"Point\",\"coordinates\":[1,2]}", 0, "no lines or polygons"},
        {LINE("[]"), 0, "no lines or polygons"},
        {COLLECTION("{}"), 2, "feature 0: the feature must be an object of the type Feature"},
        {COLLECTION("7"), 0, "feature 0: the feature must be an object"},
        {COLLECTION(FEATURE("null") ",\n" FEATURE("[]")), 3, "feature 1: the geometry must be an object"},
        {LINE("7"), 0, "no array of coordinates"},
        {LINE("[[0,0]]"), 0, "no lines or polygons"},
        {LINE("[[0,0],[1]]"), 0, "position 1: a position must be an array of 2 or more numbers"},
        {LINE("[[0,0,1],[1,2,3,4]]"), 0, "position 1: the position has 4 numbers, the one before it 3"},
        {LINE("[[0,0],[1,\"2\"]]"), 0, "position 1: a position must be"},
        {LINE("[[0,0],7]"), 0, "position 1: a position must be"},
        {LINE("[[0,0],[1,2,3]]"), 0, "position 1: only some positions of the geometry have an altitude"},
        {COLLECTION(FEATURE(LINE("[[0,0],[0,90.5]]"))), 2, "feature 0, position 1: a latitude outside"},
        {LINE("[[0,0],[361,0]]"), 0, "position 1: a longitude outside"},
        {POLYGON("[[[0,0],[1,0],[0,0]]]"), 0, "no lines or polygons"},
        {POLYGON("[[[0,0],[1,0],[1,1],[0,0]],[[0,0],[1,0],[1,1],[0,1]]]"), 0, "ring 1: the last position of a ring must"},
        {POLYGON("[[]]"), 0, "no lines or polygons"},
        {POLYGON("[7]"), 0, "ring 0: the positions must be an array"},
        {"{\"type\":\"MultiPolygon\",\"coordinates\":[[]]}", 0, "no lines or polygons"},
        {"{\"type\":\"MultiPolygon\",\"coordinates\":[7]}", 0, "polygon 0: the coordinates must be"},
        {"{\"type\":\"MultiLineString\",\"coordinates\":[[[0,0],[1,1]],[[0,0],[0,91]]]}", 0,
         "line 1, position 1: a latitude"},
        {"{\"type\":\"GeometryCollection\"}", 0, "needs an array of geometries"},
        {"{\"type\":\"GeometryCollection\",\"geometries\":[7]}", 0, "geometry 0: the geometry must be an object"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_bad(cases[i].text, GEOJSON, NULL, cases[i].line, cases[i].words);
    bat_curve_set set = {0};
    assert_int_equal(read_string(LINE("[[0,0],[1,1]]"), GEOJSON, "torus", &set, NULL), BAT_INVALID_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(all_but_the_curves_survives),
                                       cmocka_unit_test(rings_know_their_polygons),
                                       cmocka_unit_test(geometries_become_curves),
                                       cmocka_unit_test(what_looks_like_coordinates_survives),
                                       cmocka_unit_test(wrong_numbers_are_wrong_syntax),
                                       cmocka_unit_test(every_kind_of_root_is_read),
                                       cmocka_unit_test(closed_lines_and_rings_repeat_their_first_position),
                                       cmocka_unit_test(an_option_opens_or_closes_lines),
                                       cmocka_unit_test(plain_coordinates_are_kept_exactly),
                                       cmocka_unit_test(longitudes_beyond_the_meridian_wrap),
                                       cmocka_unit_test(other_formats_carry_the_curves_over),
                                       cmocka_unit_test(precision_is_an_option),
                                       cmocka_unit_test(rounding_leaves_no_degenerate_rings),
                                       cmocka_unit_test(results_do_not_depend_on_threads),
                                       cmocka_unit_test(a_refined_set_keeps_the_attributes),
                                       cmocka_unit_test(bad_syntax_names_its_line),
                                       cmocka_unit_test(deep_nesting_is_refused),
                                       cmocka_unit_test(wrong_structure_names_its_place)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
