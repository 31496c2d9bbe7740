// The judge of refined maps, with refined maps that are wrong.

#include "test_io_helpers.h"

#include "batten/curve_file.h"

#define MAP(first, second)                                                                                                  \
    "{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":"         \
    "\"Polygon\",\"coordinates\":[[" first "]]}},{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":"           \
    "\"Polygon\",\"coordinates\":[[" second "]]}}]}"

static const char GIVEN[] = MAP("[0,0],[10,0],[10,10],[0,10],[0,0]", "[10,0],[20,0],[20,10],[10,10],[10,0]");

/// Write `fine` as what became of `given`. Returns the message of a refusal, null for none; release it with free().
static char *verdict(const char *given, const char *fine, const char *space)
{
    bat_curve_set before = must_read(given, BAT_CURVE_FORMAT_GEOJSON, space);
    bat_curve_set after = must_read(fine, BAT_CURVE_FORMAT_GEOJSON, space);
    bat_curve_write_options options = bat_curve_write_defaults();
    options.format = BAT_CURVE_FORMAT_GEOJSON;
    options.given = &before;
    char *text = NULL;
    size_t size;
    bat_error error = {.text = ""};
    bat_status status = bat_curve_write_memory(&after, &options, &text, &size, &error);
    assert_true(status == BAT_OK || status == BAT_UNSUPPORTED);
    free(text);
    bat_curve_set_free(&before);
    bat_curve_set_free(&after);
    return status == BAT_OK ? NULL : strdup(error.text);
}

static void expect(const char *given, const char *fine, const char *space, const char *part)
{
    char *text = verdict(given, fine, space);
    if (part == NULL && text != NULL)
        fail_msg("refused: %s", text);
    if (part != NULL)
        assert_non_null(text);
    if (part != NULL && strstr(text, part) == NULL)
        fail_msg("'%s' is not in: %s", part, text);
    free(text);
}

static void a_right_map_passes(void **state)
{
    (void)state;
    expect(GIVEN, GIVEN, NULL, NULL);
    expect(GIVEN, MAP("[0,0],[5,-1],[10,0],[11,5],[10,10],[0,10],[0,0]", "[10,0],[20,0],[20,10],[10,10],[11,5],[10,0]"),
           NULL, NULL);
}

static void a_polygon_that_crosses_itself_is_refused(void **state)
{
    (void)state;
    const char *fine = MAP("[0,0],[10,0],[10,10],[7,12],[3,-2],[0,10],[0,0]", "[10,0],[20,0],[20,10],[10,10],[10,0]");
    expect(GIVEN, fine, NULL, "crosses itself");
    // One that did so before may go on.
    expect(MAP("[0,0],[10,0],[0,10],[10,10],[0,0]", "[10,0],[20,0],[20,10],[10,10],[10,0]"),
           MAP("[0,0],[10,0],[0,10],[10,10],[0,0]", "[10,0],[20,0],[20,10],[10,10],[10,0]"), NULL, NULL);
}

// A vertex of the given ring comes within rounding of another edge, which has that vertex afterwards.
static void a_ring_may_touch_itself_where_it_nearly_did(void **state)
{
    (void)state;
    const char *given = MAP("[0,0],[9,3],[4,8],[3,1.0000000000000002],[0,8],[0,0]", "[10,0],[20,0],[20,10],[10,10],[10,0]");
    const char *fine = MAP("[0,0],[3,1.0000000000000002],[9,3],[4,8],[3,1.0000000000000002],[0,8],[0,0]",
                           "[10,0],[20,0],[20,10],[10,10],[10,0]");
    expect(given, fine, "plane", NULL);
    expect(MAP("[0,0],[9,3],[4,8],[3,1.00001],[0,8],[0,0]", "[10,0],[20,0],[20,10],[10,10],[10,0]"), fine, "plane",
           "crosses itself");
}

static void a_border_that_is_left_is_refused(void **state)
{
    (void)state;
    expect(GIVEN, MAP("[0,0],[10,0],[9,5],[10,10],[0,10],[0,0]", "[10,0],[20,0],[20,10],[10,10],[11,5],[10,0]"), NULL,
           "curve 1 would leave a border");
    expect(GIVEN, MAP("[0,0],[10,0],[9,5],[10,10],[0,10],[0,0]", "[10,0],[20,0],[20,10],[10,10],[10,0]"), NULL,
           "curve 1 would leave a border");
}

// A spike at the ring's first vertex: its way back is not the way around the ring.
static void a_dropped_spike_leaves_no_border(void **state)
{
    (void)state;
    const char *given = MAP("[10,0],[10,10],[10,0],[10,10],[0,10],[0,0],[10,0]", "[10,0],[20,0],[20,10],[10,10],[10,0]");
    expect(given, MAP("[10,0],[11,5],[10,10],[0,10],[0,0],[10,0]", "[10,0],[20,0],[20,10],[10,10],[11,5],[10,0]"), NULL,
           NULL);
}

// The seam and the poles: the written parts have the area of the given ones.
static void cut_polygons_pass(void **state)
{
    (void)state;
    static const char *const MAPS[] = {
        MAP("[170,10],[-170,10],[-170,20],[170,20],[170,10]", "[10,0],[20,0],[20,10],[10,10],[10,0]"),
        MAP("[-180,70],[-60,70],[60,72],[170,70],[170,90],[-180,90],[-180,70]", "[10,0],[20,0],[20,10],[10,10],[10,0]"),
        MAP("[0,80],[120,80],[-120,80],[0,80]", "[-74,-60],[-53,-61],[-53,-90],[-74,-90],[-74,-60]"),
    };
    for (size_t i = 0; i < sizeof MAPS / sizeof *MAPS; i++)
        expect(MAPS[i], MAPS[i], NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_right_map_passes),
        cmocka_unit_test(a_polygon_that_crosses_itself_is_refused),
        cmocka_unit_test(a_ring_may_touch_itself_where_it_nearly_did),
        cmocka_unit_test(a_border_that_is_left_is_refused),
        cmocka_unit_test(a_dropped_spike_leaves_no_border),
        cmocka_unit_test(cut_polygons_pass),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
