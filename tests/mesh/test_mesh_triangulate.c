// Triangulated polygons: areas add up, no triangle is inverted, and orientation is preserved.
#include "check.h"

#include "batten/mesh.h"
#include "mesh/check.h"

enum
{
    MOST = 512
};

/// A polygon in the plane z = 0.
typedef struct drawing
{
    double positions[3 * MOST];
    uint32_t corners[MOST];
    uint32_t triangles[3 * MOST];
    size_t count;
} drawing;

static void draw(drawing *polygon, const double *points, size_t count)
{
    polygon->count = count;
    for (size_t i = 0; i < count; i++)
    {
        polygon->corners[i] = (uint32_t)(count - 1 - i); // vertices in another order than corners
        double *position = polygon->positions + 3 * (count - 1 - i);
        position[0] = points[2 * i];
        position[1] = points[2 * i + 1];
        position[2] = 0;
    }
}

/// Twice the signed area of three corners.
static double area_of(const drawing *polygon, size_t i, size_t j, size_t k)
{
    const double *a = polygon->positions + 3 * (size_t)polygon->corners[i];
    const double *b = polygon->positions + 3 * (size_t)polygon->corners[j];
    const double *c = polygon->positions + 3 * (size_t)polygon->corners[k];
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Cut a polygon of `count` corners into triangles of corners.
static bat_status cut(const double *positions, const uint32_t *corners, size_t count, uint32_t *triangles)
{
    const uint32_t begins[] = {0, (uint32_t)count};
    bat_mesh mesh = {.positions = (double *)(uintptr_t)positions,
                     .faces = malloc(count * sizeof *mesh.faces),
                     .offsets = malloc(sizeof begins),
                     .vertex_count = count,
                     .face_count = 1};
    memcpy(mesh.faces, corners, count * sizeof *corners);
    memcpy(mesh.offsets, begins, sizeof begins);
    uint32_t *offsets = NULL, *corner_of = malloc(count * sizeof *corner_of);
    for (uint32_t c = 0; c < count; c++)
        corner_of[corners[c]] = c;
    bat_status status = mesh_cut_polygons(&mesh, &offsets, NULL);
    for (size_t i = 0; status == BAT_OK && i < 3 * mesh.face_count; i++)
        triangles[i] = corner_of[mesh.faces[i]];
    mesh.positions = NULL;
    bat_mesh_free(&mesh);
    free(offsets);
    free(corner_of);
    return status;
}

/// Triangulate a polygon. No triangle is inverted, and the areas add up to the polygon's. Since absolute areas add up too,
/// the triangles do not overlap.
static void check_cut(drawing *polygon, double tolerance)
{
    assert_int_equal(cut(polygon->positions, polygon->corners, polygon->count, polygon->triangles), BAT_OK);
    double outline = 0, sum = 0;
    for (size_t i = 0; i + 2 < polygon->count; i++)
        outline += area_of(polygon, 0, i + 1, i + 2);
    double sign = outline < 0 ? -1 : 1;
    for (size_t t = 0; t + 2 < polygon->count; t++)
    {
        const uint32_t *corner = polygon->triangles + 3 * t;
        assert_true(corner[0] < polygon->count && corner[1] < polygon->count && corner[2] < polygon->count);
        double area = area_of(polygon, corner[0], corner[1], corner[2]) * sign;
        assert_true(area >= -tolerance);
        sum += area;
    }
    check_near(sum, fabs(outline), tolerance);
}

static void test_quads_take_the_better_diagonal(void **state)
{
    (void)state;
    static const struct
    {
        double points[4][2];
        uint32_t diagonal; ///< the smaller of its two corners
    } cases[] = {{{{0, 0}, {3, 1}, {6, 0}, {3, -1}}, 1},
                 {{{3, 1}, {6, 0}, {3, -1}, {0, 0}}, 0},
                 {{{0, 0}, {2, 0}, {.5, .5}, {0, 2}}, 0},
                 {{{2, 0}, {.5, .5}, {0, 2}, {0, 0}}, 1},
                 {{{0, 0}, {0, 2}, {.5, .5}, {2, 0}}, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        drawing polygon;
        draw(&polygon, cases[i].points[0], 4);
        check_cut(&polygon, 1e-12);
        for (size_t t = 0; t < 2; t++)
        {
            bool one = false, other = false;
            for (size_t c = 0; c < 3; c++)
            {
                one = one || polygon.triangles[3 * t + c] == cases[i].diagonal;
                other = other || polygon.triangles[3 * t + c] == cases[i].diagonal + 2;
            }
            assert_true(one && other);
        }
    }
}

static void test_convex_polygons_become_fans(void **state)
{
    (void)state;
    double points[40][2];
    for (size_t i = 0; i < 40; i++)
    {
        points[i][0] = cos(6.283185307179586 * (double)i / 40);
        points[i][1] = -sin(6.283185307179586 * (double)i / 40);
    }
    drawing polygon;
    draw(&polygon, points[0], 40);
    check_cut(&polygon, 1e-12);
    for (uint32_t t = 0; t < 38; t++)
    {
        const uint32_t fan[] = {0, t + 1, t + 2};
        assert_memory_equal(polygon.triangles + 3 * (size_t)t, fan, sizeof fan);
    }
}

/// Star-shaped polygons of any roughness, in both orientations.
static void test_concave_polygons(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(5);
    for (size_t count = 5; count < MOST; count += 7)
    {
        double points[MOST][2], turn = count % 2 == 0 ? 6.283185307179586 : -6.283185307179586;
        for (size_t i = 0; i < count; i++)
        {
            double radius = .2 + bat_random_uniform(&random);
            points[i][0] = radius * cos(turn * (double)i / (double)count);
            points[i][1] = radius * sin(turn * (double)i / (double)count);
        }
        drawing polygon;
        draw(&polygon, points[0], count);
        check_cut(&polygon, 1e-12);
    }
}

static void test_difficult_outlines(void **state)
{
    (void)state;
    // Straight corners; a comb; a square with a square hole, joined by a bridge.
    static const double straight[][2] = {{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
    static const double comb[][2] = {{0, 0}, {7, 0}, {7, 5}, {6, 5}, {6, 1}, {5, 1}, {5, 5}, {4, 5},
                                     {4, 1}, {3, 1}, {3, 5}, {2, 5}, {2, 1}, {1, 1}, {1, 5}, {0, 5}};
    static const double hole[][2] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}};
    drawing polygon;
    draw(&polygon, straight[0], 8);
    check_cut(&polygon, 1e-12);
    draw(&polygon, comb[0], 16);
    check_cut(&polygon, 1e-12);
    draw(&polygon, hole[0], 10);
    check_cut(&polygon, 1e-12);
}

/// The triangulation does not depend on the position, the size and the plane of the polygon.
static void test_any_scale_and_plane(void **state)
{
    (void)state;
    static const double arrow[][2] = {{0, 0}, {4, 1}, {0, 2}, {1, 1.25}, {1, .75}};
    static const double scales[] = {1e-300, 1e-10, 1, 1e150, 1e307};
    drawing polygon;
    draw(&polygon, arrow[0], 5);
    check_cut(&polygon, 1e-12);
    for (size_t i = 0; i < 5; i++)
    {
        drawing moved = polygon;
        uint32_t triangles[9];
        for (size_t v = 0; v < 5; v++)
        {
            const double *p = polygon.positions + 3 * v;
            moved.positions[3 * v] = scales[i] * p[1];
            moved.positions[3 * v + 1] = scales[i] * (p[1] / 2 + 1);
            moved.positions[3 * v + 2] = -scales[i] * p[0];
        }
        assert_int_equal(cut(moved.positions, moved.corners, 5, triangles), BAT_OK);
        assert_memory_equal(triangles, polygon.triangles, sizeof triangles);
    }
}

/// Self-intersecting and flat outlines also give count - 2 triangles with valid corners.
static void test_crossed_and_flat_outlines(void **state)
{
    (void)state;
    static const double bow[][2] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}}, line[][2] = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {1, 0}};
    static const double star[][2] = {{0, 1}, {.6, -.8}, {-.95, .3}, {.95, .3}, {-.6, -.8}};
    static const double point[][2] = {{1, 1}, {1, 1}, {1, 1}, {1, 1}, {1, 1}, {1, 1}};
    const double *const outlines[] = {bow[0], line[0], star[0], point[0]};
    const size_t counts[] = {4, 5, 5, 6};
    for (size_t i = 0; i < 4; i++)
    {
        drawing polygon;
        bool seen[6] = {false};
        draw(&polygon, outlines[i], counts[i]);
        assert_int_equal(cut(polygon.positions, polygon.corners, counts[i], polygon.triangles), BAT_OK);
        for (size_t k = 0; k < 3 * (counts[i] - 2); k++)
            seen[polygon.triangles[k]] = true;
        for (size_t k = 0; k < counts[i]; k++)
            assert_true(seen[k]);
    }
}

static void test_too_many_ears(void **state)
{
    (void)state;
    size_t count = 10001;
    double *positions = calloc(count, 3 * sizeof *positions);
    uint32_t *corners = malloc(count * sizeof *corners), *triangles = malloc(3 * count * sizeof *triangles);
    for (size_t i = 0; i < count; i++)
    {
        double radius = i % 2 == 0 ? 1 : .5, angle = 6.283185307179586 * (double)i / (double)count;
        corners[i] = (uint32_t)i;
        positions[3 * i] = radius * cos(angle);
        positions[3 * i + 1] = radius * sin(angle);
    }
    assert_int_equal(cut(positions, corners, count, triangles), BAT_TOO_LARGE);
    free(positions);
    free(corners);
    free(triangles);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_quads_take_the_better_diagonal),
                                       cmocka_unit_test(test_convex_polygons_become_fans),
                                       cmocka_unit_test(test_concave_polygons),
                                       cmocka_unit_test(test_difficult_outlines),
                                       cmocka_unit_test(test_any_scale_and_plane),
                                       cmocka_unit_test(test_crossed_and_flat_outlines),
                                       cmocka_unit_test(test_too_many_ears)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
