#include "test_io_helpers.h"

#include <jansson.h>
#include <stdio.h>

static const bat_curve_format GEOJSON = BAT_CURVE_FORMAT_GEOJSON;
static const double PI = 3.14159265358979323846;

#define LINE(coordinates) "{\"type\":\"LineString\",\"coordinates\":" coordinates "}"
#define LINES(coordinates) "{\"type\":\"MultiLineString\",\"coordinates\":" coordinates "}"
#define POLYGON(coordinates) "{\"type\":\"Polygon\",\"coordinates\":" coordinates "}"
#define POLYGONS(coordinates) "{\"type\":\"MultiPolygon\",\"coordinates\":" coordinates "}"

static void assert_cut(const char *text, const char *expected)
{
    char line[1024];
    (void)snprintf(line, sizeof line, "%s\n", expected);
    assert_rewritten(text, GEOJSON, NULL, line);
}

/// `expected` with a latitude in degrees, of ten decimals, for each %s.
static void assert_cut_at(const char *text, const char *expected, double latitude)
{
    char number[32], filled[1024];
    (void)snprintf(number, sizeof number, "%.10f", latitude);
    while (number[strlen(number) - 1] == '0')
        number[strlen(number) - 1] = '\0';
    size_t used = 0;
    for (const char *at = expected; *at != '\0'; at++)
    {
        if (*at == '@')
            used += (size_t)snprintf(filled + used, sizeof filled - used, "%s", number);
        else
            filled[used++] = *at;
    }
    filled[used] = '\0';
    assert_cut(text, filled);
}

static void a_line_is_cut_where_it_crosses(void **state)
{
    (void)state;
    assert_cut(LINE("[[170,0],[-170,0]]"), LINES("[[[170,0],[180,0]],[[-180,0],[-170,0]]]"));
    assert_cut(LINE("[[-170,0],[170,0]]"), LINES("[[[-170,0],[-180,0]],[[180,0],[170,0]]]"));
    assert_cut(LINE("[[10,0],[-10,0]]"), LINE("[[10,0],[-10,0]]"));
    assert_cut(LINE("[[170,0],[-170,0],[170,0]]"),
               LINES("[[[170,0],[180,0]],[[-180,0],[-170,0],[-180,0]],[[180,0],[170,0]]]"));
    assert_cut(LINES("[[[0,0],[1,1]],[[170,0],[-170,0]]]"), LINES("[[[0,0],[1,1]],[[170,0],[180,0]],[[-180,0],[-170,0]]]"));
}

static void the_crossing_is_on_the_great_circle(void **state)
{
    (void)state;
    // The arc between two points of latitude f and longitude difference 2 d is highest in the middle: tan(top) = tan(f) /
    // cos(d).
    double top = atan(tan(45 * PI / 180) / cos(0.4 * PI / 180)) * 180 / PI;
    assert_cut_at(LINE("[[179.6,45],[-179.6,45]]"), LINES("[[[179.6,45],[180,@]],[[-180,@],[-179.6,45]]]"), top);
    // Longer than a degree, it stays on its parallel.
    assert_cut(LINE("[[170,45],[-170,45]]"), LINES("[[[170,45],[180,45]],[[-180,45],[-170,45]]]"));
    // From the equator, the arc's latitude at longitude x from its node is atan(tan(i) sin(x)).
    double inclination = atan(tan(30 * PI / 180) / sin(50 * PI / 180));
    double latitude = atan(tan(inclination) * sin(20 * PI / 180)) * 180 / PI;
    assert_cut_at(LINE("[[160,0],[-150,30]]"), LINES("[[[160,0],[180,@]],[[-180,@],[-150,30]]]"), latitude);
}

static void the_altitude_goes_by_the_share_of_the_arc(void **state)
{
    (void)state;
    assert_cut(LINE("[[170,0,0],[-170,0,100]]"), LINES("[[[170,0,0],[180,0,50]],[[-180,0,50],[-170,0,100]]]"));
    bat_curve_set set = must_read(LINE("[[170,0,0],[-160,0,90]]"), GEOJSON, NULL);
    char *text = must_write(&set, GEOJSON);
    json_t *root = json_loads(text, 0, NULL);
    const json_t *cut = json_array_get(json_array_get(json_array_get(json_object_get(root, "coordinates"), 0), 1), 2);
    assert_true(fabs(json_number_value(cut) - 30) < 1e-12);
    json_decref(root);
    free(text);
    bat_curve_set_free(&set);
}

static void vertices_on_the_meridian_take_a_side(void **state)
{
    (void)state;
    assert_cut(LINE("[[170,0],[-180,0],[175,5]]"), LINE("[[170,0],[180,0],[175,5]]"));
    assert_cut(LINE("[[170,0],[180,0],[-170,0]]"), LINES("[[[170,0],[180,0]],[[-180,0],[-170,0]]]"));
    assert_cut(LINE("[[170,0],[-180,0],[-170,0]]"), LINES("[[[170,0],[180,0]],[[-180,0],[-170,0]]]"));
    assert_cut(LINE("[[180,0],[-170,0]]"), LINE("[[-180,0],[-170,0]]"));
    assert_cut(LINE("[[-170,0],[180,0]]"), LINE("[[-170,0],[-180,0]]"));
    assert_cut(LINE("[[-180,0],[-180,10]]"), LINE("[[180,0],[180,10]]"));
    assert_cut(LINE("[[170,0],[180,0],[-180,10],[-170,10]]"), LINES("[[[170,0],[180,0],[180,10]],[[-180,10],[-170,10]]]"));
    assert_cut(LINE("[[179.99999999999,0],[-170,0]]"), LINE("[[-180,0],[-170,0]]"));
}

static void a_pole_takes_the_longitude_before_it(void **state)
{
    (void)state;
    assert_cut(LINE("[[50,80],[7,90],[60,85]]"), LINE("[[50,80],[50,90],[60,90],[60,85]]"));
    assert_cut(LINE("[[7,-90],[60,-85]]"), LINE("[[60,-90],[60,-85]]"));
}

static void a_closed_line_around_the_axis_stays_one_piece(void **state)
{
    (void)state;
    assert_cut(LINE("[[0,80],[120,80],[-120,80],[0,80]]"), LINE("[[-180,80],[-120,80],[0,80],[120,80],[180,80]]"));
}

static void a_closed_line_across_is_two_pieces(void **state)
{
    (void)state;
    assert_cut(LINE("[[170,0],[-170,0],[180,10],[170,0]]"),
               LINES("[[[-180,0],[-170,0],[-180,10]],[[180,10],[170,0],[180,0]]]"));
}

static void a_polygon_across_falls_into_parts(void **state)
{
    (void)state;
    assert_cut(POLYGON("[[[170,-10],[-170,-10],[-170,10],[170,10],[170,-10]]]"),
               POLYGONS("[[[[-180,-10],[-170,-10],[-170,10],[-180,10],[-180,-10]]],"
                        "[[[170,-10],[180,-10],[180,10],[170,10],[170,-10]]]]"));
    // Two extensions across the antimeridian at the equator: three parts.
    bat_curve_set set =
        must_read(POLYGON("[[[160,-30],[-170,-20],[170,-10],[170,10],[-170,20],[160,30],[160,-30]]]"), GEOJSON, NULL);
    char *text = must_write(&set, GEOJSON);
    bat_curve_set parts = must_read(text, GEOJSON, "plane");
    assert_int_equal(parts.count, 3);
    free(text);
    bat_curve_set_free(&set);
    bat_curve_set_free(&parts);
}

static void a_polygon_that_touches_stays_whole(void **state)
{
    (void)state;
    assert_cut(POLYGON("[[[170,0],[-180,0],[-180,10],[170,10],[170,0]]]"),
               POLYGON("[[[170,0],[180,0],[180,10],[170,10],[170,0]]]"));
}

static void holes_go_with_their_part(void **state)
{
    (void)state;
    bat_curve_set set = must_read(POLYGON("[[[160,-20],[-160,-20],[-160,20],[160,20],[160,-20]],"
                                          "[[165,0],[165,5],[170,5],[165,0]],"
                                          "[[-165,0],[-170,5],[-165,5],[-165,0]]]"),
                                  GEOJSON, NULL);
    char *text = must_write(&set, GEOJSON);
    json_t *root = json_loads(text, 0, NULL);
    const json_t *parts = json_object_get(root, "coordinates");
    assert_int_equal(json_array_size(parts), 2);
    for (size_t i = 0; i < 2; i++)
    {
        const json_t *part = json_array_get(parts, i);
        assert_int_equal(json_array_size(part), 2);
        double outer = json_number_value(json_array_get(json_array_get(json_array_get(part, 0), 1), 0));
        double hole = json_number_value(json_array_get(json_array_get(json_array_get(part, 1), 1), 0));
        assert_true(outer * hole > 0);
    }
    json_decref(root);
    free(text);
    bat_curve_set_free(&set);
}

static void a_ring_around_a_pole_is_closed_over_it(void **state)
{
    (void)state;
    assert_cut(POLYGON("[[[0,80],[120,80],[-120,80],[0,80]]]"),
               POLYGON("[[[0,80],[120,80],[180,80],[180,90],[-180,90],[-180,80],[-120,80],[0,80]]]"));
    assert_cut(POLYGON("[[[0,80],[-120,80],[120,80],[0,80]]]"),
               POLYGON("[[[0,80],[-120,80],[-180,80],[-180,90],[180,90],[180,80],[120,80],[0,80]]]"));
    assert_cut(POLYGON("[[[0,-80],[-120,-80],[120,-80],[0,-80]]]"),
               POLYGON("[[[0,-80],[-120,-80],[-180,-80],[-180,-90],[180,-90],[180,-80],[120,-80],[0,-80]]]"));
    assert_cut(POLYGON("[[[0,0],[120,0],[-120,0],[0,0]]]"),
               POLYGON("[[[0,0],[120,0],[180,0],[180,90],[-180,90],[-180,0],[-120,0],[0,0]]]"));
}

static void vertices_along_the_antimeridian_have_one_sign(void **state)
{
    (void)state;
    assert_cut(POLYGON("[[[170,0],[180,1],[-180,5],[180,8],[170,9],[170,0]]]"),
               POLYGON("[[[170,0],[180,1],[180,5],[180,8],[170,9],[170,0]]]"));
}

static void a_sector_turns_at_the_pole(void **state)
{
    (void)state;
    static const char *const SECTORS[] = {
        POLYGON("[[[-74,-60],[-53,-61],[-53,-90],[-74,-90],[-74,-60]]]"),
        POLYGON("[[[10,60],[10,90],[-20,90],[-20,61],[10,60]]]"),
        POLYGON("[[[-180,70],[-60,70],[60,72],[170,70],[170,90],[-180,90],[-180,70]]]"),
        POLYGON("[[[-170,-70],[-170,-90],[175,-90],[175,-70],[60,-72],[-60,-71],[-170,-70]]]"),
        POLYGONS("[[[[-180,-65],[-160,-61],[-160,-90],[-180,-90],[-180,-65]]],[[[160,-60],[180,-65],[180,-90],[160,-90],"
                 "[160,-60]]]]"),
    };
    for (size_t i = 0; i < sizeof SECTORS / sizeof *SECTORS; i++)
        assert_cut(SECTORS[i], SECTORS[i]);
}

static void two_rings_around_the_axis_bound_a_belt(void **state)
{
    (void)state;
    assert_cut(POLYGON("[[[0,0],[90,0],[180,0],[-90,0],[0,0]],[[0,60],[-90,60],[180,60],[90,60],[0,60]]]"),
               POLYGON("[[[0,0],[90,0],[180,0],[180,60],[90,60],[0,60],[-90,60],[-180,60],[-180,0],[-90,0],[0,0]]]"));
}

/// A star-shaped region: the points whose distance from a centre is below a radius that depends on the direction.
typedef struct star
{
    double axes[3][3]; ///< centre and two directions
    double size;       ///< of the mean radius
    double waves[3];
    double hole; ///< the hole's radius, relative to the region's
} star;

static star random_star(bat_random *random)
{
    star shape;
    bat_space space = bat_sphere(2);
    double *centre = shape.axes[0], *u = shape.axes[1], *v = shape.axes[2], other[3];
    space.random_point(&space, random, centre);
    space.random_point(&space, random, other);
    double dot = centre[0] * other[0] + centre[1] * other[1] + centre[2] * other[2];
    for (int k = 0; k < 3; k++)
        other[k] -= dot * centre[k];
    (void)space.project(&space, other, u);
    for (int k = 0; k < 3; k++)
        v[k] = centre[(k + 1) % 3] * u[(k + 2) % 3] - centre[(k + 2) % 3] * u[(k + 1) % 3];
    shape.size = 0.1 + 0.7 * bat_random_uniform(random);
    for (int k = 0; k < 3; k++)
        shape.waves[k] = 0.15 * (2 * bat_random_uniform(random) - 1);
    shape.hole = 0.2 + 0.6 * bat_random_uniform(random);
    return shape;
}

static double star_radius(const star *shape, double angle)
{
    double factor = 1;
    for (int k = 0; k < 3; k++)
        factor += shape->waves[k] * cos((k + 2) * angle);
    return shape->size * factor;
}

static char *star_ring(const star *shape, double scale, bool backward, char *out)
{
    enum
    {
        COUNT = 360
    };
    out += sprintf(out, "[");
    for (int i = 0; i <= COUNT; i++)
    {
        double angle = 2 * PI * (backward ? COUNT - i % COUNT : i % COUNT) / COUNT;
        double radius = scale * star_radius(shape, angle), p[3];
        for (int k = 0; k < 3; k++)
            p[k] = cos(radius) * shape->axes[0][k] +
                   sin(radius) * (cos(angle) * shape->axes[1][k] + sin(angle) * shape->axes[2][k]);
        out += sprintf(out, "%s[%.14f,%.14f]", i > 0 ? "," : "", atan2(p[1], p[0]) * 180 / PI,
                       atan2(p[2], hypot(p[0], p[1])) * 180 / PI);
    }
    return out + sprintf(out, "]");
}

/// 1 inside, 0 outside, -1 too near to the border.
static int star_holds(const star *shape, const double *point)
{
    double c[3] = {0};
    for (int axis = 0; axis < 3; axis++)
        for (int k = 0; k < 3; k++)
            c[axis] += shape->axes[axis][k] * point[k];
    double distance = atan2(hypot(c[1], c[2]), c[0]), radius = star_radius(shape, atan2(c[2], c[1]));
    if (fabs(distance - radius) < 0.01 || fabs(distance - shape->hole * radius) < 0.01)
        return -1;
    return distance < radius && distance > shape->hole * radius;
}

static bool ring_holds(const json_t *ring, double x, double y)
{
    bool inside = false;
    size_t count = json_array_size(ring);
    for (size_t i = 1; i < count; i++)
    {
        const json_t *a = json_array_get(ring, i - 1), *b = json_array_get(ring, i);
        double xa = json_number_value(json_array_get(a, 0)), ya = json_number_value(json_array_get(a, 1));
        double xb = json_number_value(json_array_get(b, 0)), yb = json_number_value(json_array_get(b, 1));
        assert_true(fabs(xa) <= 180 && fabs(ya) <= 90);
        if ((ya > y) != (yb > y) && x < xa + (y - ya) / (yb - ya) * (xb - xa))
            inside = !inside;
    }
    return inside;
}

/// Whether a point of the map is in a polygon and in none of its holes.
static bool polygons_hold(const json_t *polygons, double x, double y)
{
    for (size_t i = 0; i < json_array_size(polygons); i++)
    {
        const json_t *polygon = json_array_get(polygons, i);
        bool inside = ring_holds(json_array_get(polygon, 0), x, y);
        for (size_t k = 1; k < json_array_size(polygon); k++)
            inside = inside && !ring_holds(json_array_get(polygon, k), x, y);
        if (inside)
            return true;
    }
    return false;
}

/// Cut a star with a hole, and compare the map with the sphere at random points.
static void check_star(bat_random *random, bool same_direction)
{
    star shape = random_star(random);
    char *text = malloc(1 << 16);
    char *out = text + sprintf(text, "{\"type\":\"Polygon\",\"coordinates\":[");
    out = star_ring(&shape, 1, false, out);
    *out++ = ',';
    out = star_ring(&shape, shape.hole, !same_direction, out);
    (void)sprintf(out, "]}");
    bat_curve_set set = must_read(text, GEOJSON, NULL);
    char *written = must_write(&set, GEOJSON);
    json_t *root = json_loads(written, 0, NULL);
    json_t *polygons = json_incref(json_object_get(root, "coordinates"));
    if (strcmp(json_string_value(json_object_get(root, "type")), "Polygon") == 0)
    {
        json_t *single = json_array();
        (void)json_array_append_new(single, polygons);
        polygons = single;
    }
    bat_space space = bat_sphere(2);
    for (int i = 0; i < 200; i++)
    {
        double p[3];
        space.random_point(&space, random, p);
        int expected = star_holds(&shape, p);
        double x = atan2(p[1], p[0]) * 180 / PI, y = atan2(p[2], hypot(p[0], p[1])) * 180 / PI;
        if (expected >= 0 && fabs(y) < 89 && polygons_hold(polygons, x, y) != expected)
            fail_msg("at %g %g the map says %d: %.300s", x, y, !expected, written);
    }
    json_decref(polygons);
    json_decref(root);
    free(written);
    free(text);
    bat_curve_set_free(&set);
}

static void the_map_of_a_region_agrees_with_the_globe(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(2024);
    for (int i = 0; i < 400; i++)
        check_star(&random, i % 4 == 0);
}

static void pieces_keep_the_vertices_and_span_half_a_turn_at_most(void **state)
{
    (void)state;
    enum
    {
        COUNT = 500
    };
    bat_random random = bat_random_seed(77);
    bat_space space = bat_sphere(2);
    for (int closed = 0; closed <= 1; closed++)
    {
        bat_curve curve = {
            .space = &space, .points = malloc(3 * COUNT * sizeof(double)), .count = COUNT, .closed = closed == 1};
        for (size_t i = 0; i < COUNT; i++)
            space.random_point(&space, &random, curve.points + 3 * i);
        bat_curve_set set;
        assert_int_equal(bat_curve_set_single(&curve, &set, NULL), BAT_OK);
        char *text = must_write(&set, GEOJSON);
        bat_curve_set pieces = must_read(text, GEOJSON, "plane");
        size_t vertices = 0;
        for (size_t i = 0; i < pieces.count; i++)
        {
            const bat_curve *piece = &pieces.curves[i];
            for (size_t k = 0; k < piece->count; k++)
            {
                const double *p = piece->points + 2 * k;
                bool cut = fabs(p[0]) == 180;
                vertices += !cut;
                assert_true(!cut || k == 0 || k == piece->count - 1);
                assert_true(k == 0 || fabs(p[0] - p[-2]) <= 180);
            }
        }
        assert_int_equal(vertices, COUNT);
        free(text);
        bat_curve_set_free(&set);
        bat_curve_set_free(&pieces);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_line_is_cut_where_it_crosses),
                                       cmocka_unit_test(the_crossing_is_on_the_great_circle),
                                       cmocka_unit_test(the_altitude_goes_by_the_share_of_the_arc),
                                       cmocka_unit_test(vertices_on_the_meridian_take_a_side),
                                       cmocka_unit_test(a_pole_takes_the_longitude_before_it),
                                       cmocka_unit_test(a_closed_line_around_the_axis_stays_one_piece),
                                       cmocka_unit_test(a_closed_line_across_is_two_pieces),
                                       cmocka_unit_test(a_polygon_across_falls_into_parts),
                                       cmocka_unit_test(a_polygon_that_touches_stays_whole),
                                       cmocka_unit_test(holes_go_with_their_part),
                                       cmocka_unit_test(a_ring_around_a_pole_is_closed_over_it),
                                       cmocka_unit_test(vertices_along_the_antimeridian_have_one_sign),
                                       cmocka_unit_test(a_sector_turns_at_the_pole),
                                       cmocka_unit_test(two_rings_around_the_axis_bound_a_belt),
                                       cmocka_unit_test(the_map_of_a_region_agrees_with_the_globe),
                                       cmocka_unit_test(pieces_keep_the_vertices_and_span_half_a_turn_at_most)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
