#include "test_io_helpers.h"

#include "curve/curve_attributes.h"

#include <jansson.h>
#include <stdio.h>

/// @file
/// TopoJSON: arcs become curves, and curves become arcs that stand once.

#define TOPOLOGY(geometries, arcs)                                                                                          \
    "{\"type\":\"Topology\",\"objects\":{\"a\":{\"type\":\"GeometryCollection\",\"geometries\":[" geometries                \
    "]}},\"arcs\":[" arcs "]}"

/// Two polygons with a border in common.
static const char TWO[] =
    TOPOLOGY("{\"type\":\"Polygon\",\"id\":\"A\",\"properties\":{\"n\":1.5},\"arcs\":[[0,1]]},"
             "{\"type\":\"Polygon\",\"id\":7,\"arcs\":[[2,-1]]},{\"type\":\"Point\",\"coordinates\":[1,2]},"
             "{\"type\":null}",
             "[[5,0],[6,5],[5,9]],[[5,9],[0,9],[0,0],[5,0]],[[5,0],[11,1],[11,9],[5,9]]");

static const char TWO_AS_GEOJSON[] =
    "{\"type\":\"FeatureCollection\",\"name\":\"a\",\"features\":[\n"
    "{\"type\":\"Feature\",\"id\":\"A\",\"properties\":{\"n\":1.5},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
    "[[[5,0],[6,5],[5,9],[0,9],[0,0],[5,0]]]}},\n"
    "{\"type\":\"Feature\",\"id\":7,\"properties\":{},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
    "[[[5,0],[11,1],[11,9],[5,9],[6,5],[5,0]]]}},\n"
    "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Point\",\"coordinates\":[1,2]}},\n"
    "{\"type\":\"Feature\",\"properties\":{},\"geometry\":null}\n]}\n";

static json_t *parse(const char *text)
{
    json_t *tree = json_loads(text, 0, NULL);
    assert_non_null(tree);
    return tree;
}

static void arcs_become_rings(void **state)
{
    (void)state;
    bat_curve_set set = must_read(TWO, BAT_CURVE_FORMAT_AUTO, NULL);
    assert_int_equal(set.attributes->format, BAT_CURVE_FORMAT_TOPOJSON);
    assert_string_equal(set.space->name, "sphere");
    assert_null(bat_curve_set_note(&set, 0));
    char *text = must_write(&set, BAT_CURVE_FORMAT_GEOJSON);
    json_t *made = parse(text), *expected = parse(TWO_AS_GEOJSON);
    assert_true(json_equal(made, expected));
    json_decref(made);
    json_decref(expected);
    free(text);
    bat_curve_set_free(&set);
}

static void quantized_arcs_are_sums(void **state)
{
    (void)state;
    bat_curve_set set = must_read("{\"type\":\"Topology\",\"transform\":{\"scale\":[0.5,0.25],\"translate\":[100,1000]},"
                                  "\"objects\":{\"a\":{\"type\":\"MultiLineString\",\"arcs\":[[0],[-1]]}},"
                                  "\"arcs\":[[[2,4],[1,0],[0,-4]]]}",
                                  BAT_CURVE_FORMAT_TOPOJSON, NULL);
    static const double expected[2][6] = {{101, 1001, 101.5, 1001, 101.5, 1000}, {101.5, 1000, 101.5, 1001, 101, 1001}};
    assert_string_equal(set.space->name, "plane");
    assert_int_equal(set.count, 2);
    for (size_t i = 0; i < 2; i++)
        assert_memory_equal(set.curves[i].points, expected[i], sizeof expected[i]);
    bat_curve_set_free(&set);
}

static void a_border_stands_once(void **state)
{
    (void)state;
    bat_curve_set set = must_read(TWO_AS_GEOJSON, BAT_CURVE_FORMAT_GEOJSON, NULL);
    char *text = must_write(&set, BAT_CURVE_FORMAT_TOPOJSON);
    json_t *tree = parse(text), *expected = parse(TWO);
    assert_true(json_equal(json_object_get(tree, "arcs"), json_object_get(expected, "arcs")));
    bat_curve_set_free(&set);
    set = must_read(text, BAT_CURVE_FORMAT_TOPOJSON, NULL);
    char *back = must_write(&set, BAT_CURVE_FORMAT_GEOJSON), *again = must_write(&set, BAT_CURVE_FORMAT_TOPOJSON);
    json_t *made = parse(back), *given = parse(TWO_AS_GEOJSON);
    assert_true(json_equal(made, given));
    assert_string_equal(again, text);
    json_decref(tree);
    json_decref(expected);
    json_decref(made);
    json_decref(given);
    free(text);
    free(back);
    free(again);
    bat_curve_set_free(&set);
}

/// Lines that part, an island that fills a hole from another first point, and lines in both directions.
static void every_shape_comes_back(void **state)
{
    (void)state;
    static const char areas[] = "{\"type\":\"FeatureCollection\",\"features\":["
                                "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
                                "[[[0,0],[9,0],[9,9],[0,9],"
                                "[0,0]],[[2,2],[2,4],[4,4],[4,2],[2,2]]]}},"
                                "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Polygon\",\"coordinates\":"
                                "[[[4,4],[2,4],[2,2],[4,2],"
                                "[4,4]]]}},"
                                "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"LineString\","
                                "\"coordinates\":[[9,9],[9,0],[20,0]]}}]}";
    static const char lines[] = "{\"type\":\"FeatureCollection\",\"features\":["
                                "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"MultiLineString\","
                                "\"coordinates\":[[[0,0,1],[1,1,2],"
                                "[2,0,3]],[[2,0,3],[1,1,2],[1,5,4]]]}},"
                                "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"LineString\","
                                "\"coordinates\":[[2,0],[1,1],[0,0]]}}]}";
    bat_curve_set set;
    const char *const texts[] = {areas, lines, NULL};
    for (size_t i = 0; texts[i] != NULL; i++)
    {
        set = must_read(texts[i], BAT_CURVE_FORMAT_GEOJSON, NULL);
        char *topology = must_write(&set, BAT_CURVE_FORMAT_TOPOJSON), *given = must_write(&set, BAT_CURVE_FORMAT_GEOJSON);
        bat_curve_set_free(&set);
        set = must_read(topology, BAT_CURVE_FORMAT_TOPOJSON, NULL);
        char *back = must_write(&set, BAT_CURVE_FORMAT_GEOJSON);
        json_t *a = parse(given), *b = parse(back);
        assert_true(json_equal(json_object_get(a, "features"), json_object_get(b, "features")));
        json_decref(a);
        json_decref(b);
        free(topology);
        free(given);
        free(back);
        bat_curve_set_free(&set);
    }
}

/// A ring without arcs stays one: what is written can be read.
static void empty_rings_come_back(void **state)
{
    (void)state;
    static const char given[] = TOPOLOGY("{\"type\":\"Polygon\",\"arcs\":[[],[0]]},{\"type\":\"Polygon\",\"arcs\":[[1]]}",
                                         "[[5,0],[6,5],[5,9],[5,0]],[[15,0],[16,5],[15,9],[15,0]]");
    bat_curve_set set = must_read(given, BAT_CURVE_FORMAT_AUTO, NULL);
    char *text = must_write(&set, BAT_CURVE_FORMAT_TOPOJSON);
    bat_curve_set back = must_read(text, BAT_CURVE_FORMAT_AUTO, NULL);
    assert_non_null(strstr(text, "\"arcs\":[[],["));
    assert_int_equal(back.count, set.count);
    free(text);
    bat_curve_set_free(&set);
    bat_curve_set_free(&back);
}

static void bad_files_are_refused(void **state)
{
    (void)state;
    static const struct
    {
        const char *text, *words;
        size_t line;
    } cases[] = {
        {"{\"type\":\"Topology\",", "", 1},
        {"{\"type\":\"Feature\"}", "no TopoJSON", 0},
        {"{\"type\":\"Topology\",\"arcs\":[]}", "no objects", 0},
        {TOPOLOGY("{\"type\":\"LineString\",\"arcs\":[0]}", ""), "geometry 0: an arc that it names", 0},
        {TOPOLOGY("{\"type\":\"LineString\",\"arcs\":[-2]}", "[[0,0],[1,1]]"), "does not exist", 0},
        {TOPOLOGY("{\"type\":\"LineString\",\"arcs\":[0]}", "[[0,0],[1]]"), "2 or more numbers", 0},
        {TOPOLOGY("{\"type\":\"LineString\",\"arcs\":[0]}", "[[0,0],[1,\"1\"]]"), "2 or more numbers", 0},
        {TOPOLOGY("{\"type\":\"Line\",\"arcs\":[0]}", "[[0,0],[1,1]]"), "unknown type", 0},
        {TOPOLOGY("{\"type\":\"Polygon\",\"arcs\":[0]}", "[[0,0],[1,1]]"), "must be arrays", 0},
        {TOPOLOGY("{\"type\":\"Polygon\",\"arcs\":[[0]]}", "[[0,0],[1,1],[1,0],[2,0]]"), "must repeat the first", 0},
        {"{\"type\":\"Topology\",\"transform\":{\"scale\":[1]},\"objects\":{\"a\":{\"type\":null}},\"arcs\":[]}",
         "transform", 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_bad(cases[i].text, BAT_CURVE_FORMAT_TOPOJSON, NULL, cases[i].line, cases[i].words);
    bat_curve_set set;
    bat_error error;
    static const char layers[] = "{\"type\":\"Topology\",\"objects\":{\"a\":{\"type\":null},\"b\":{\"type\":\"LineString\","
                                 "\"arcs\":[0]}},\"arcs\":[[[0,0],[1,1]]]}";
    assert_int_equal(read_string(layers, BAT_CURVE_FORMAT_TOPOJSON, NULL, &set, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "there are 2 objects: a, b"));
    bat_curve_read_options options = bat_curve_read_defaults();
    options.layer = "b";
    assert_int_equal(bat_curve_read_memory(layers, strlen(layers), &options, &set, &error), BAT_OK);
    bat_curve_set_free(&set);
    options.layer = "c";
    assert_int_equal(bat_curve_read_memory(layers, strlen(layers), &options, &set, &error), BAT_INVALID_ARGUMENT);
}

/// An arc that is used a million times must not become a huge text.
static void repeated_arcs_are_bounded(void **state)
{
    (void)state;
    enum
    {
        POINTS = 20000,
        USES = 20000
    };
    char *text = malloc(64 + 10 * POINTS + 2 * USES + 128), *at = text;
    assert_non_null(text);
    at += sprintf(at, "{\"type\":\"Topology\",\"objects\":{\"a\":{\"type\":\"LineString\",\"arcs\":[0");
    for (size_t i = 0; i < USES; i++)
        at += sprintf(at, ",0");
    at += sprintf(at, "]}},\"arcs\":[[[0,0]");
    for (size_t i = 0; i < POINTS; i++)
        at += sprintf(at, ",[%zu,0]", i % 2);
    (void)sprintf(at, "]]}");
    bat_curve_set set;
    assert_int_equal(read_string(text, BAT_CURVE_FORMAT_TOPOJSON, NULL, &set, NULL), BAT_TOO_LARGE);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arcs_become_rings),         cmocka_unit_test(quantized_arcs_are_sums),
        cmocka_unit_test(a_border_stands_once),      cmocka_unit_test(every_shape_comes_back),
        cmocka_unit_test(empty_rings_come_back),     cmocka_unit_test(bad_files_are_refused),
        cmocka_unit_test(repeated_arcs_are_bounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
