#include "test_io_helpers.h"

#include "io/curve/stitch.h"

#include "space/degrees.h"

#include <stdio.h>
#include <unistd.h>

/// What the GeoJSON writer cuts at the antimeridian, the reader joins again.

static const bat_curve_format GEOJSON = BAT_CURVE_FORMAT_GEOJSON, CSV = BAT_CURVE_FORMAT_CSV;

#define LINE(coordinates) "{\"type\":\"LineString\",\"coordinates\":" coordinates "}"
#define LINES(coordinates) "{\"type\":\"MultiLineString\",\"coordinates\":" coordinates "}"
#define POLYGON(coordinates) "{\"type\":\"Polygon\",\"coordinates\":" coordinates "}"
#define POLYGONS(coordinates) "{\"type\":\"MultiPolygon\",\"coordinates\":" coordinates "}"
#define FEATURE(id, geometry) "{\"type\":\"Feature\",\"id\":" id ",\"properties\":{},\"geometry\":" geometry "}"
#define COLLECTION(features) "{\"type\":\"FeatureCollection\",\"features\":[" features "]}"

/// Reading gives the curves of a CSV text.
static void assert_curves(const char *text, const char *csv)
{
    bat_curve_set set = must_read(text, GEOJSON, NULL);
    char *written = must_write(&set, CSV);
    assert_string_equal(written, csv);
    free(written);
    bat_curve_set_free(&set);
}

static void assert_note(const char *text, const char *words)
{
    bat_curve_set set = must_read(text, GEOJSON, NULL);
    const char *note;
    bool found = false;
    for (size_t i = 0; (note = bat_curve_set_note(&set, i)) != NULL && !found; i++)
        found = strstr(note, words) != NULL;
    if (!found)
        fail_msg("no note has '%s', the first is '%s'", words, bat_curve_set_note(&set, 0));
    bat_curve_set_free(&set);
}

static void polygons_that_share_the_antimeridian_are_joined(void **state)
{
    (void)state;
    // Neither great circle nor parallel: the corners on the antimeridian are given points.
    assert_curves(POLYGONS("[[[[170,10],[180,11],[180,21],[170,20],[170,10]]],"
                           "[[[-180,11],[-170,10],[-170,20],[-180,21],[-180,11]]]]"),
                  "lon,lat\n# closed\n170,10\n180,11\n-170,10\n-170,20\n180,21\n170,20\n");
    // The equator is a great circle.
    assert_curves(POLYGONS("[[[[170,0],[180,0],[180,21],[170,20],[170,0]]],"
                           "[[[-180,0],[-170,0],[-170,20],[-180,21],[-180,0]]]]"),
                  "lon,lat\n# closed\n170,0\n-170,0\n-170,20\n180,21\n170,20\n");
    // The parts have different directions.
    assert_curves(POLYGONS("[[[[170,0],[180,0],[180,21],[170,20],[170,0]]],"
                           "[[[-180,0],[-180,21],[-170,20],[-170,0],[-180,0]]]]"),
                  "lon,lat\n# closed\n170,0\n-170,0\n-170,20\n180,21\n170,20\n");
    assert_note(POLYGONS("[[[[170,0],[180,0],[180,21],[170,20],[170,0]]],"
                         "[[[-180,0],[-170,0],[-170,20],[-180,21],[-180,0]]]]"),
                "joined 2 polygons cut at the antimeridian into 1");
    // Cut at the meridian of Greenwich, in longitudes up to 360 degrees; along parallels.
    assert_curves(POLYGONS("[[[[0,50],[5,50],[5,55],[0,55],[0,50]]],[[[350,50],[360,50],[360,55],[350,55],[350,50]]]]"),
                  "lon,lat\n# closed\n-10,50\n5,50\n5,55\n-10,55\n");
    // The latitudes of the two sides differ in the last digits of a double.
    assert_curves(POLYGONS("[[[[170,0],[180,0],[180,21.00000000000014],[170,20],[170,0]]],"
                           "[[[-180,0],[-170,0],[-170,20],[-180,21],[-180,0]]]]"),
                  "lon,lat\n# closed\n170,0\n-170,0\n-170,20\n180,21\n170,20\n");
}

static void only_what_is_covered_twice_is_removed(void **state)
{
    (void)state;
    static const char single[] = POLYGON("[[[170,0],[180,0],[180,20],[170,20],[170,0]]]");
    assert_curves(single, "lon,lat\n# closed\n170,0\n180,0\n180,20\n170,20\n");
    // The neighbour covers a part of the border.
    static const char partly[] = POLYGONS("[[[[170,0],[180,0],[180,20],[170,20],[170,0]]],"
                                          "[[[-180,5],[-170,5],[-170,10],[-180,10],[-180,5]]]]");
    assert_curves(partly, "lon,lat\n# closed\n170,0\n180,0\n180,5\n-170,5\n-170,10\n180,10\n180,20\n170,20\n");
    // The real border goes with the interior on its side.
    assert_rewritten(partly, GEOJSON, NULL,
                     POLYGONS("[[[[-180,5],[-170,5],[-170,10],[-180,10],[-180,5]]],"
                              "[[[170,0],[180,0],[180,5],[180,10],[180,20],[170,20],[170,0]]]]") "\n");
    // A ring that touches the antimeridian from inside, beside its crossing, has two parts on that side.
    static const char touching[] = POLYGON("[[[170,30],[170,0],[-170,0],[-175,10],[180,15],[-175,20],[-170,30],[170,30]]]");
    assert_curves(touching, "lon,lat\n# closed\n170,30\n170,0\n-170,0\n-175,10\n180,15\n-175,20\n-170,30\n");
    bat_curve_set parts = must_read(touching, GEOJSON, NULL);
    char *cut = must_write(&parts, GEOJSON);
    bat_curve_set_free(&parts);
    parts = must_read(cut, GEOJSON, "plane");
    assert_int_equal(parts.count, 3);
    bat_curve_set_free(&parts);
    assert_curves(cut, "lon,lat\n# closed\n170,30\n170,0\n-170,0\n-175,10\n180,15\n-175,20\n-170,30\n");
    free(cut);
    // Two features are neighbours, not parts.
    bat_curve_set set = must_read(
        COLLECTION(FEATURE("1", "{\"type\":\"Polygon\",\"coordinates\":[[[170,0],[180,0],[180,20],[170,0]]]}") "," FEATURE(
            "2", "{\"type\":\"Polygon\",\"coordinates\":[[[-180,0],[-170,0],[-180,20],[-180,0]]]}")),
        GEOJSON, NULL);
    assert_int_equal(set.count, 2);
    assert_null(bat_curve_set_note(&set, 0));
    bat_curve_set_free(&set);
}

static void closures_over_a_pole_are_removed(void **state)
{
    (void)state;
    static const char *const south[] = {
        POLYGON("[[[-180,-80],[-90,-78],[0,-80],[90,-81],[180,-80],[180,-90],[-180,-90],[-180,-80]]]"),
        POLYGON("[[[-180,-80],[-90,-78],[0,-80],[90,-81],[180,-80],[180,-90],[90,-90],[0,-90],[-180,-90],[-180,-80]]]"),
        POLYGON("[[[-180,-80],[-180,-90],[180,-90],[180,-80],[90,-81],[0,-80],[-90,-78],[-180,-80]]]"),
        POLYGON("[[[0,-80],[90,-81],[180,-80],[180,-85],[0,-90],[-180,-83],[-180,-80],[-90,-78],[0,-80]]]"),
    };
    static const char *const rings[] = {
        "lon,lat\n# closed\n180,-80\n-90,-78\n0,-80\n90,-81\n", "lon,lat\n# closed\n180,-80\n-90,-78\n0,-80\n90,-81\n",
        "lon,lat\n# closed\n180,-80\n90,-81\n0,-80\n-90,-78\n", "lon,lat\n# closed\n0,-80\n90,-81\n180,-80\n-90,-78\n"};
    for (size_t i = 0; i < sizeof south / sizeof *south; i++)
    {
        assert_curves(south[i], rings[i]);
        assert_note(south[i], "removed the closure of 1 polygon over a pole");
    }
}

/// A closure that ends short of the antimeridian is taken off, too, whichever side is short.
static void closures_that_end_short_are_removed(void **state)
{
    (void)state;
    static const double gaps[] = {1e-9, 1.5e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 0.00010291105414, 1e-3, 1e-2};
    for (size_t i = 0; i < sizeof gaps / sizeof *gaps; i++)
        for (int side = 0; side < 4; side++)
        {
            char text[400];
            double east = side == 1 ? 180 : 180 - gaps[i], west = side == 0 ? -180 : gaps[i] - 180,
                   middle = side == 3 ? 75 : 70;
            (void)snprintf(
                text, sizeof text,
                POLYGON("[[[%.14f,70],[-120,75],[-60,70],[0,72],[60,70],[120,75],[%.14f,70],[%.14f,%g],[%.14f,90],"
                        "[%.14f,90],[%.14f,70]]]"),
                west, east, east, middle, east, west, west);
            bat_curve_set set = must_read(text, GEOJSON, NULL);
            assert_int_equal(set.count, 1);
            assert_int_equal(set.curves[0].count, 6);
            bat_curve_set_free(&set);
            assert_note(text, "removed the closure of 1 polygon over a pole");
        }
    // A wide gap is a part of the shape, and so is a narrow wedge.
    static const char *const others[] = {
        POLYGON("[[[-180,70],[-60,70],[60,70],[179,70],[179,90],[-180,90],[-180,70]]]"),
        POLYGON("[[[179.999,70],[-179.999,70],[-179.999,90],[179.999,90],[179.999,70]]]"),
    };
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
    {
        bat_curve_set set = must_read(others[i], GEOJSON, NULL);
        assert_null(bat_curve_set_note(&set, 0));
        bat_curve_set_free(&set);
    }
}

static void the_pole_of_the_file_stays_inside(void **state)
{
    (void)state;
    // The larger side: the whole map but a cap in the south, and with a hole.
    static const char ocean[] = POLYGON("[[[0,-70],[-90,-75],[-180,-70],[-180,90],[180,90],[180,-70],[90,-72],[0,-70]],"
                                        "[[0,0],[0,30],[30,30],[30,0],[0,0]]]");
    assert_curves(ocean, "lon,lat\n# closed\n0,-70\n-90,-75\n180,-70\n90,-72\n\n# closed\n0,0\n0,30\n30,30\n30,0\n");
    assert_rewritten(ocean, GEOJSON, NULL,
                     POLYGON("[[[0,-70],[-90,-75],[-180,-70],[-180,90],[180,90],[180,-70],[90,-72],[0,-70]],"
                             "[[0,0],[0,30],[30,30],[30,0],[0,0]]]") "\n");
    // Without the closure the smaller side counts.
    assert_rewritten(POLYGON("[[[0,-70],[-90,-75],[180,-70],[90,-72],[0,-70]]]"), GEOJSON, NULL,
                     POLYGON("[[[0,-70],[-90,-75],[-180,-70],[-180,-90],[180,-90],[180,-70],[90,-72],[0,-70]]]") "\n");
}

static void a_belt_has_two_rings(void **state)
{
    (void)state;
    assert_curves(POLYGON("[[[-180,-10],[-60,-10],[60,-10],[180,-10],[180,30],[60,30],[-60,30],[-180,30],[-180,-10]]]"),
                  "lon,lat\n# closed\n180,-10\n-60,-10\n60,-10\n\n# closed\n180,30\n60,30\n-60,30\n");
}

static void the_whole_map_passes_unchanged(void **state)
{
    (void)state;
    static const char world[] = FEATURE("5", POLYGON("[[[-180,-90],[180,-90],[180,90],[-180,90],[-180,-90]]]"));
    static const char line[] = FEATURE("6", LINE("[[0,0],[1,1]]"));
    char text[512];
    (void)snprintf(text, sizeof text, "{\"type\":\"FeatureCollection\",\"features\":[\n%s,\n%s\n]}\n", world, line);
    assert_rewritten(text, GEOJSON, NULL, text);
    assert_note(text, "left 1 geometry without a usable outline unchanged, the first in feature 0 (id 5)");
}

static void lines_are_joined(void **state)
{
    (void)state;
    static const char line[] = "lon,lat\n170,10\n180,11\n-170,12\n180,13\n175,13\n";
    assert_curves(LINES("[[[170,10],[180,11]],[[-180,11],[-170,12],[-180,13]],[[180,13],[175,13]]]"), line);
    // Out of order.
    assert_curves(LINES("[[[170,10],[180,11]],[[180,13],[175,13]],[[-180,11],[-170,12],[-180,13]]]"), line);
    // Ends on the same side, and different latitudes, do not meet.
    assert_curves(LINES("[[[170,10],[180,11]],[[180,11],[170,12]]]"), "lon,lat\n170,10\n180,11\n\n180,11\n170,12\n");
    assert_curves(LINES("[[[170,10],[180,11]],[[-180,11.1],[-170,12]]]"), "lon,lat\n170,10\n180,11\n\n180,11.1\n-170,12\n");
    // Pieces in a circle are a closed curve.
    assert_curves(LINES("[[[-180,11],[-170,10],[-170,20],[-180,21]],[[180,21],[170,20],[170,10],[180,11]]]"),
                  "lon,lat\n# closed\n180,11\n-170,10\n-170,20\n180,21\n170,20\n170,10\n");
    assert_note(LINES("[[[170,10],[180,11]],[[-180,11],[-170,12]]]"), "joined 2 lines cut at the antimeridian into 1");
}

/// A star-shaped polygon around a centre: equal steps of the bearing, random distances.
typedef struct ring_text
{
    double longitudes[64], latitudes[64];
    size_t count;
} ring_text;

static ring_text random_ring(bat_random *random, double longitude, double latitude, double radius, bool clockwise)
{
    static const double PI = 3.14159265358979323846;
    ring_text ring = {.count = 5 + (size_t)(40 * bat_random_uniform(random))};
    double a = longitude * PI / 180, b = latitude * PI / 180, first = bat_random_uniform(random);
    const double centre[3] = {cos(b) * cos(a), cos(b) * sin(a), sin(b)}, east[3] = {-sin(a), cos(a), 0};
    const double north[3] = {-sin(b) * cos(a), -sin(b) * sin(a), cos(b)};
    for (size_t i = 0; i < ring.count; i++)
    {
        double bearing = 2 * PI * (first + (double)i / (double)ring.count) * (clockwise ? -1 : 1), p[3];
        double r = radius * (0.6 + 0.4 * bat_random_uniform(random));
        for (int k = 0; k < 3; k++)
            p[k] = cos(r) * centre[k] + sin(r) * (cos(bearing) * east[k] + sin(bearing) * north[k]);
        ring.longitudes[i] = atan2(p[1], p[0]) * 180 / PI;
        ring.latitudes[i] = atan2(p[2], hypot(p[0], p[1])) * 180 / PI;
    }
    return ring;
}

static char *put_ring(char *out, const ring_text *ring)
{
    out += sprintf(out, "[");
    for (size_t i = 0; i <= ring->count; i++)
        out += sprintf(out, "%s[%.10f,%.10f]", i > 0 ? "," : "", ring->longitudes[i % ring->count],
                       ring->latitudes[i % ring->count]);
    return out + sprintf(out, "]");
}

/// Whether two rings have the same points, from some start on. Sets the start.
static bool same_ring(const bat_curve *a, const bat_curve *b, size_t *start)
{
    for (*start = 0; a->count == b->count && *start < b->count; (*start)++)
    {
        size_t same = 0;
        for (size_t i = 0; i < a->count; i++)
        {
            const double *p = a->points + 3 * i, *q = b->points + 3 * ((i + *start) % b->count);
            same += fabs(p[0] - q[0]) + fabs(p[1] - q[1]) + fabs(p[2] - q[2]) < 1e-11;
        }
        if (same == a->count)
            return true;
    }
    return false;
}

/// Every ring of a set is a ring of the other. An outer ring begins where it began.
static void assert_same_rings(const bat_curve_set *a, const bat_curve_set *b, const char *text)
{
    if (a->count != b->count)
        fail_msg("%zu rings became %zu: %.200s", a->count, b->count, text);
    for (size_t i = 0; i < a->count; i++)
    {
        size_t start = 0, k = 0;
        while (k < b->count && !same_ring(&a->curves[i], &b->curves[k], &start))
            k++;
        if (k == b->count)
            fail_msg("ring %zu is lost: %.200s", i, text);
        if (i == 0 && (k != 0 || start != 0))
            fail_msg("the outer ring is ring %zu from point %zu on: %.200s", k, start, text);
    }
}

/// A polygon with up to three holes, near the antimeridian or a pole.
static void check_round_trip(bat_random *random)
{
    static char text[1 << 16];
    bool polar = bat_random_uniform(random) < 0.5;
    double longitude = polar ? 360 * bat_random_uniform(random) - 180 : 176 + 8 * bat_random_uniform(random);
    double latitude = polar ? 84 + 5 * bat_random_uniform(random) : 140 * bat_random_uniform(random) - 70;
    latitude *= bat_random_uniform(random) < 0.5 ? -1 : 1;
    double radius = 0.08 + 0.4 * bat_random_uniform(random);
    size_t holes = (size_t)(4 * bat_random_uniform(random));
    const ring_text outer = random_ring(random, longitude, latitude, radius, false);
    char *out = put_ring(text + sprintf(text, "{\"type\":\"Polygon\",\"coordinates\":["), &outer);
    const ring_text places = random_ring(random, longitude, latitude, 0.4 * radius, true);
    for (size_t i = 0; i < holes; i++)
    {
        size_t place = i * places.count / holes;
        const ring_text hole = random_ring(random, places.longitudes[place], places.latitudes[place], 0.12 * radius, true);
        out = put_ring(out + sprintf(out, ","), &hole);
    }
    (void)sprintf(out, "]}");
    bat_curve_set set = must_read(text, GEOJSON, NULL);
    char *written = must_write(&set, GEOJSON);
    bat_curve_set back = must_read(written, GEOJSON, NULL);
    assert_same_rings(&set, &back, written);
    char *again = must_write(&back, GEOJSON);
    bat_curve_set third = must_read(again, GEOJSON, NULL);
    assert_same_rings(&back, &third, again);
    free(again);
    free(written);
    bat_curve_set_free(&set);
    bat_curve_set_free(&back);
    bat_curve_set_free(&third);
}

static void what_is_cut_comes_back_point_for_point(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(14);
    for (int i = 0; i < 500; i++)
        check_round_trip(&random);
}

static void a_line_comes_back_point_for_point(void **state)
{
    (void)state;
    enum
    {
        COUNT = 300
    };
    bat_random random = bat_random_seed(5);
    bat_space space = bat_sphere(2);
    for (int closed = 0; closed <= 1; closed++)
    {
        bat_curve curve = {
            .space = &space, .points = malloc(3 * COUNT * sizeof(double)), .count = COUNT, .closed = closed == 1};
        for (size_t i = 0; i < COUNT; i++)
            degrees_to_point(7.3 * (double)i + 20 * bat_random_uniform(&random), 120 * bat_random_uniform(&random) - 60,
                             curve.points + 3 * i);
        bat_curve_set set;
        assert_int_equal(bat_curve_set_single(&curve, &set, NULL), BAT_OK);
        char *text = must_write(&set, GEOJSON);
        assert_non_null(strstr(text, "180"));
        bat_curve_set back = must_read(text, GEOJSON, NULL);
        size_t start;
        assert_int_equal(back.count, 1);
        assert_int_equal(back.curves[0].closed, closed);
        assert_true(same_ring(&set.curves[0], &back.curves[0], &start));
        assert_true(closed == 1 || start == 0);
        free(text);
        bat_curve_set_free(&set);
        bat_curve_set_free(&back);
    }
}

static void lines_of_one_point_are_dropped_and_counted(void **state)
{
    (void)state;
    static const char text[] =
        COLLECTION(FEATURE("1", "{\"type\":\"MultiLineString\",\"coordinates\":[[[7,7]],[[0,0],[1,1]]]}"));
    assert_curves(text, "lon,lat\n0,0\n1,1\n");
    assert_note(text, "dropped 1 line or ring with too few different points, the first in feature 0 (id 1), line 0");
    bat_curve_read_options options = bat_curve_read_defaults();
    options.format = GEOJSON;
    options.strict = true;
    bat_curve_set set = {0};
    bat_error error = {0};
    assert_int_equal(bat_curve_read_memory(text, sizeof text - 1, &options, &set, &error), BAT_BAD_FILE);
    assert_non_null(strstr(error.text, "line 0: a line needs at least 2 positions"));
}

#define TRIANGLE "[[0,0],[1,0],[1,1],[0,0]]"

static void empty_parts_are_dropped_and_counted(void **state)
{
    (void)state;
    static const struct
    {
        const char *coordinates, *note, *fault;
    } CASES[] = {
        {"[[],[" TRIANGLE "]]", "dropped 1 line", "polygon 0: the coordinates must be"},
        {"[[" TRIANGLE "],[]]", "dropped 1 line", "polygon 1: the coordinates must be"},
        {"[[" TRIANGLE ",[]],[[]]]", "dropped 2 lines", "polygon 0, ring 1: a ring needs at least 4 positions"},
        {"[[[],[[2,2],[3,2],[3,3],[2,2]]],[" TRIANGLE "]]", "dropped 1 line", "polygon 0, ring 0: a ring needs"},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++)
    {
        char text[300];
        int size = snprintf(text, sizeof text, COLLECTION(FEATURE("1", "{\"type\":\"MultiPolygon\",\"coordinates\":%s}")),
                            CASES[i].coordinates);
        assert_curves(text, "lon,lat\n# closed\n0,0\n1,0\n1,1\n");
        assert_note(text, CASES[i].note);
        bat_curve_read_options options = bat_curve_read_defaults();
        options.format = GEOJSON;
        options.strict = true;
        bat_curve_set set = {0};
        bat_error error = {0};
        assert_int_equal(bat_curve_read_memory(text, (size_t)size, &options, &set, &error), BAT_BAD_FILE);
        assert_non_null(strstr(error.text, CASES[i].fault));
    }
    assert_curves(COLLECTION(FEATURE("1", "{\"type\":\"MultiLineString\",\"coordinates\":[[],[[0,0],[1,1]]]}")),
                  "lon,lat\n0,0\n1,1\n");
    assert_note(COLLECTION(FEATURE("1", POLYGONS("[[[]]]")) "," FEATURE("2", POLYGONS("[[" TRIANGLE "]]"))),
                "left 1 geometry without a usable outline unchanged");
}

static void edges_of_more_than_half_a_turn_are_told(void **state)
{
    (void)state;
    assert_note(COLLECTION(FEATURE("1", POLYGON("[" TRIANGLE "]")) "," FEATURE(
                    "2", POLYGON("[[[-100,30],[100,30],[100,50],[-100,50],[-100,30]]]"))),
                "2 edges span more than 180 degrees of longitude and go the short way, across the antimeridian, the first "
                "in feature 1 (id 2), ring 0, position 1");
    // Crossings near the antimeridian, and that of Greenwich in longitudes up to 360 degrees, are what they look like.
    bat_curve_set set =
        must_read(LINES("[[[175,0],[-175,1],[179,2],[-172,3]],[[10,0],[350,1]],[[-90,0],[90,1]]]"), GEOJSON, NULL);
    for (size_t i = 0; bat_curve_set_note(&set, i) != NULL; i++)
        assert_null(strstr(bat_curve_set_note(&set, i), "span"));
    bat_curve_set_free(&set);
}

static void repeated_points_are_dropped_and_counted(void **state)
{
    (void)state;
    static const char text[] = COLLECTION(
        FEATURE("\"ATA\"", POLYGONS("[[[[0,0],[1,0],[1,0],[1,1],[0,0],[0,0]],[[0.5,0.2],[0.5,0.2],[0.5,0.2],[0.5,0.2]]],"
                                    "[[[5,5],[6,6],[5,5],[5,5]]]]")));
    assert_curves(text, "lon,lat\n# closed\n0,0\n1,0\n1,1\n");
    assert_note(text, "dropped 6 repeated points, the first in feature 0 (id 'ATA'), polygon 0, ring 0, position 2");
    assert_note(text,
                "dropped 2 lines or rings with too few different points, the first in feature 0 (id 'ATA'), polygon 0, "
                "ring 1");
    bat_curve_read_options options = bat_curve_read_defaults();
    options.format = GEOJSON;
    options.strict = true;
    bat_curve_set set = {0};
    bat_error error = {0};
    assert_int_equal(bat_curve_read_memory(text, sizeof text - 1, &options, &set, &error), BAT_BAD_FILE);
    assert_non_null(strstr(error.text, "feature 0 (id 'ATA'), polygon 0, ring 0, position 2: the position repeats"));
    options.format = CSV;
    static const char rows[] = "# closed\n0,0\n1,0\n1,0\n1,1\n";
    assert_int_equal(bat_curve_read_memory(rows, sizeof rows - 1, &options, &set, &error), BAT_BAD_FILE);
    assert_non_null(strstr(error.text, "curve 0, point 2"));
    assert_int_equal(error.line, 4);
    options.strict = false;
    assert_int_equal(bat_curve_read_memory(rows, sizeof rows - 1, &options, &set, &error), BAT_OK);
    assert_int_equal(set.curves[0].count, 3);
    assert_int_equal(bat_curve_set_line(&set, 0, 2), 5);
    assert_string_equal(bat_curve_set_note(&set, 0), "dropped 1 repeated point, the first on line 4");
    bat_curve_set_free(&set);
    // A motion that rests keeps its points.
    static const char times[] = "time,x,y\n0,0,0\n1,0,0\n2,1,0\n";
    assert_int_equal(bat_curve_read_memory(times, sizeof times - 1, &options, &set, &error), BAT_OK);
    assert_int_equal(set.curves[0].count, 3);
    bat_curve_set_free(&set);
    options.format = BAT_CURVE_FORMAT_OBJ;
    static const char vertices[] = "v 0 0\nv 1 0\nv 1 0\nv 1 1\nv 0 0\nl 1 2 3 4 5 1\n";
    assert_int_equal(bat_curve_read_memory(vertices, sizeof vertices - 1, &options, &set, &error), BAT_OK);
    assert_int_equal(set.curves[0].count, 3);
    assert_string_equal(bat_curve_set_note(&set, 0), "dropped 2 repeated points, the first on line 3");
    bat_curve_set_free(&set);
}

static void a_curve_is_described_by_its_feature(void **state)
{
    (void)state;
    bat_curve_set set = must_read(COLLECTION(FEATURE("3", LINE("[[0,0],[1,0]]")) "," FEATURE(
                                      "\"ATA\"", POLYGONS("[[[[5,5],[6,6],[5,6],[5,5]]],[[[0,0],[9,0],[9,9],[0,0]],"
                                                          "[[7,1],[8,1],[8,2],[7,1]]]]"))),
                                  GEOJSON, NULL);
    char text[160];
    bat_curve_set_place(&set, 3, 1, text, sizeof text);
    assert_string_equal(text, "feature 1 (id 'ATA'), polygon 1, ring 1, near 8, 1");
    bat_curve_set_place(&set, 0, BAT_NO_INDEX, text, sizeof text);
    assert_string_equal(text, "feature 0 (id 3), line 0");
    bat_curve_set_place(&set, 3, 1, text, 10);
    assert_int_equal(strlen(text), 9);
    bat_curve_set_free(&set);
    set = must_read("0,0\n1,1\n\n2,2\n3,3\n", CSV, NULL);
    bat_curve_set_place(&set, 1, 0, text, sizeof text);
    assert_string_equal(text, "curve 1");
    bat_curve_set_free(&set);
}

#define CRS(name) "\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"" name "\"}}"
#define WITH_CRS(name) "{" CRS(name) ",\"type\":\"LineString\",\"coordinates\":[[40,50],[41,51]]}\n"

static void a_crs_chooses_the_space(void **state)
{
    (void)state;
    static const struct
    {
        const char *text, *space;
    } cases[] = {
        {WITH_CRS("urn:ogc:def:crs:EPSG::25833"), "plane"},
        {WITH_CRS("EPSG:3857"), "plane"},
        {WITH_CRS("urn:ogc:def:crs:OGC:1.3:CRS84"), "sphere"},
        {WITH_CRS("http://www.opengis.net/def/crs/EPSG/0/4326"), "sphere"},
        {WITH_CRS("urn:ogc:def:crs:EPSG::4979"), "sphere"},
        {WITH_CRS("EPSG:4258"), "sphere"},
        {WITH_CRS("local grid"), "plane"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_curve_set set = must_read(cases[i].text, GEOJSON, NULL);
        assert_string_equal(set.space->name, cases[i].space);
        bat_curve_set_free(&set);
        assert_rewritten(cases[i].text, GEOJSON, NULL, cases[i].text);
    }
    assert_note(WITH_CRS("urn:ogc:def:crs:EPSG::25833"), "plane coordinates in EPSG:25833, which the file names");
    bat_curve_set set = must_read(WITH_CRS("urn:ogc:def:crs:EPSG::25833"), GEOJSON, "sphere");
    assert_string_equal(set.space->name, "sphere");
    bat_curve_set_free(&set);
    // A plane without a name goes back to where it came from.
    assert_rewritten(LINE("[[400000,5000000],[1,2]]") "\n", GEOJSON, "plane", LINE("[[400000,5000000],[1,2]]") "\n");
}

static void plane_coordinates_need_a_crs(void **state)
{
    (void)state;
    bat_curve_set set = must_read("400000,5000000\n400001,5000001\n", CSV, NULL);
    bat_curve_write_options options = bat_curve_write_defaults();
    options.format = GEOJSON;
    bat_error error = {0};
    char *text = NULL;
    size_t size;
    assert_int_equal(bat_curve_write_memory(&set, &options, &text, &size, &error), BAT_UNSUPPORTED);
    assert_string_equal(error.remedy, "crs");
    options.crs = "EPSG:25833";
    assert_int_equal(bat_curve_write_memory(&set, &options, &text, &size, &error), BAT_OK);
    assert_string_equal(text, "{\"type\":\"FeatureCollection\"," CRS(
                                  "urn:ogc:def:crs:EPSG::25833") ",\"features\":[\n"
                                                                 "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{"
                                                                 "\"type\":\"LineString\",\"coordinates\":"
                                                                 "[[400000,5000000],[400001,5000001]]}}\n]}\n");
    free(text);
    options.crs = "";
    assert_int_equal(bat_curve_write_memory(&set, &options, &text, &size, &error), BAT_INVALID_ARGUMENT);
    bat_curve_set_free(&set);
    // A system of another plane replaces that of the file; one of a plane does not go with longitudes.
    set = must_read(WITH_CRS("EPSG:3857"), GEOJSON, NULL);
    options.crs = "EPSG:32633";
    assert_int_equal(bat_curve_write_memory(&set, &options, &text, &size, &error), BAT_OK);
    assert_string_equal(text, WITH_CRS("urn:ogc:def:crs:EPSG::32633"));
    free(text);
    bat_curve_set_free(&set);
    set = must_read(LINE("[[1,2],[3,4]]"), GEOJSON, NULL);
    assert_int_equal(bat_curve_write_memory(&set, &options, &text, &size, &error), BAT_INVALID_ARGUMENT);
    bat_curve_set_free(&set);
}

static void further_numbers_are_channels(void **state)
{
    (void)state;
    static const char text[] = LINE("[[10,0,1,100],[20,2,3,200],[30,1,5,300.5]]") "\n";
    bat_curve_set set = must_read(text, GEOJSON, NULL);
    assert_int_equal(set.curves[0].channel_count, 2);
    assert_true(set.curves[0].channels[5] == 300.5);
    bat_curve_set_free(&set);
    assert_rewritten(text, GEOJSON, NULL, text);
    // At a cut each is interpolated.
    assert_rewritten(LINE("[[170,0,1,100],[-170,0,3,200]]"), GEOJSON, NULL,
                     LINES("[[[170,0,1,100],[180,0,2,150]],[[-180,0,2,150],[-170,0,3,200]]]") "\n");
}

static void topojson_is_named(void **state)
{
    (void)state;
    bat_curve_set set;
    bat_error error;
    assert_int_equal(read_string("{\"type\":\"Topology\",\"objects\":{},\"arcs\":[]}", GEOJSON, NULL, &set, &error),
                     BAT_UNSUPPORTED);
    assert_non_null(strstr(error.remedy_effect, "topojson"));
}

static void the_countries_of_the_world_are_joined(void **state)
{
    (void)state;
    static const char path[] = SHARED_DATA "/data/maps/countries-110m.geojson";
    if (access(path, R_OK) != 0)
    {
        print_message("skipped: %s is not there\n", path);
        skip();
    }
    bat_curve_set set = {0};
    bat_error error = {0};
    if (bat_curve_read(path, NULL, &set, &error) != BAT_OK)
        fail_msg("%s", error.text);
    // Russia and Fiji lose a ring for each pair; Antarctica keeps its own.
    assert_int_equal(set.count, 286);
    assert_string_equal(bat_curve_set_note(&set, 0),
                        "joined 6 polygons cut at the antimeridian into 3, the first in feature 53");
    assert_string_equal(bat_curve_set_note(&set, 1),
                        "removed the closure of 1 polygon over a pole or around the axis, the first in feature 6");
    char *text = must_write(&set, GEOJSON);
    bat_curve_set back = must_read(text, GEOJSON, NULL);
    assert_int_equal(back.count, set.count);
    for (size_t i = 0; i < set.count; i++)
        for (size_t k = 0; set.curves[i].count == back.curves[i].count && k < 3 * set.curves[i].count; k++)
            assert_true(fabs(set.curves[i].points[k] - back.curves[i].points[k]) < 1e-11);
    free(text);
    bat_curve_set_free(&set);
    bat_curve_set_free(&back);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(polygons_that_share_the_antimeridian_are_joined),
                                       cmocka_unit_test(only_what_is_covered_twice_is_removed),
                                       cmocka_unit_test(closures_over_a_pole_are_removed),
                                       cmocka_unit_test(closures_that_end_short_are_removed),
                                       cmocka_unit_test(the_pole_of_the_file_stays_inside),
                                       cmocka_unit_test(a_belt_has_two_rings),
                                       cmocka_unit_test(the_whole_map_passes_unchanged),
                                       cmocka_unit_test(lines_are_joined),
                                       cmocka_unit_test(what_is_cut_comes_back_point_for_point),
                                       cmocka_unit_test(a_line_comes_back_point_for_point),
                                       cmocka_unit_test(lines_of_one_point_are_dropped_and_counted),
                                       cmocka_unit_test(empty_parts_are_dropped_and_counted),
                                       cmocka_unit_test(edges_of_more_than_half_a_turn_are_told),
                                       cmocka_unit_test(repeated_points_are_dropped_and_counted),
                                       cmocka_unit_test(a_curve_is_described_by_its_feature),
                                       cmocka_unit_test(a_crs_chooses_the_space),
                                       cmocka_unit_test(plane_coordinates_need_a_crs),
                                       cmocka_unit_test(further_numbers_are_channels),
                                       cmocka_unit_test(topojson_is_named),
                                       cmocka_unit_test(the_countries_of_the_world_are_joined)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
