// Boundaries, creases, corners, and limits of Loop's scheme.
#include "check.h"
#include "mesh_helpers.h"

#include "batten/mesh_refine.h"
#include "mesh/refine/scheme.h"

static bat_mesh refine_with(const bat_mesh *coarse, const bat_mesh_refine_options *options)
{
    bat_mesh fine;
    bat_error error = {0};
    bat_status status = bat_mesh_refine(coarse, options, &fine, NULL, &error);
    if (status != BAT_OK)
        print_error("%s\n", error.text);
    check_status(status, BAT_OK);
    return fine;
}

static bat_mesh refine(const bat_mesh *coarse, bat_mesh_scheme scheme, size_t levels, bool limit)
{
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = scheme;
    options.levels = levels;
    options.limit = limit;
    return refine_with(coarse, &options);
}

static double difference(const double *p, const double *q)
{
    return fmax(fabs(p[0] - q[0]), fmax(fabs(p[1] - q[1]), fabs(p[2] - q[2])));
}

/// A closed polygon.
typedef struct polygon
{
    double *points;
    size_t count;
} polygon;

static const double *point_of(const polygon *curve, size_t i)
{
    return curve->points + 3 * (i % curve->count);
}

/// The boundary from vertex `begin` on, with the mesh on the left.
static polygon boundary_of(const bat_mesh *mesh, uint32_t begin)
{
    bat_mesh_connectivity links;
    check_status(bat_mesh_connect(mesh, &links, NULL), BAT_OK);
    polygon made = {.points = mesh_room(links.boundary_edge_count, 3 * sizeof *made.points)};
    uint32_t v = begin;
    do
    {
        assert_int_equal(links.twin[links.first[v]], BAT_MESH_NONE);
        memcpy(made.points + 3 * made.count++, mesh->positions + 3 * (size_t)v, 3 * sizeof *made.points);
        v = mesh->faces[bat_mesh_next(links.first[v])];
    } while (v != begin);
    assert_int_equal(made.count, links.boundary_edge_count);
    bat_mesh_connectivity_free(&links);
    return made;
}

/// One level of a curve scheme on a closed polygon. Each old point gives `arity` new ones; number r is the sum of mask[r][j]
/// times point j - 2.
static void refine_polygon(polygon *curve, size_t arity, const double mask[3][5])
{
    size_t count = curve->count;
    double *fine = mesh_room(arity * count, 3 * sizeof *fine);
    for (size_t k = 0; k < arity * count; k++)
        for (size_t j = 0; j < 5; j++)
            for (size_t i = 0; i < 3; i++)
                fine[3 * k + i] += mask[k % arity][j] * point_of(curve, k / arity + count + j - 2)[i];
    free(curve->points);
    curve->points = fine;
    curve->count = arity * count;
}

static const double CUBIC[3][5] = {{0, 1.0 / 8, 3.0 / 4, 1.0 / 8, 0}, {0, 0, 1.0 / 2, 1.0 / 2, 0}};
static const double FOUR_POINT[3][5] = {{0, 0, 1, 0, 0}, {0, -1.0 / 16, 9.0 / 16, 9.0 / 16, -1.0 / 16}};
static const double HALVES[3][5] = {{0, 0, 1, 0, 0}, {0, 0, 1.0 / 2, 1.0 / 2, 0}};
/// The ternary cubic B-spline's.
static const double THIRDS[3][5] = {
    {0, 4.0 / 27, 19.0 / 27, 4.0 / 27, 0}, {0, 1.0 / 27, 16.0 / 27, 10.0 / 27, 0}, {0, 0, 10.0 / 27, 16.0 / 27, 1.0 / 27}};

static void check_boundary(bat_mesh_scheme scheme, size_t levels, size_t arity, const double mask[3][5], size_t curve_levels)
{
    bat_mesh grid = mesh_grid(6, 4);
    mesh_shake(&grid, 0.3, 2);
    polygon curve = boundary_of(&grid, 0);
    for (size_t level = 0; level < curve_levels; level++)
        refine_polygon(&curve, arity, mask);
    bat_mesh fine = refine(&grid, scheme, levels, false);
    polygon boundary = boundary_of(&fine, 0);
    assert_int_equal(boundary.count, curve.count);
    for (size_t i = 0; i < curve.count; i++)
        assert_true(difference(point_of(&boundary, i), point_of(&curve, i)) < 1e-14 * 10);
    free(curve.points);
    free(boundary.points);
    bat_mesh_free(&grid);
    bat_mesh_free(&fine);
}

static void test_boundaries_are_curves(void **state)
{
    (void)state;
    check_boundary(BAT_MESH_SCHEME_LOOP, 3, 2, CUBIC, 3);
    check_boundary(BAT_MESH_SCHEME_BUTTERFLY, 3, 2, FOUR_POINT, 3);
    check_boundary(BAT_MESH_SCHEME_MIDPOINT, 3, 2, HALVES, 3);
    check_boundary(BAT_MESH_SCHEME_SQRT3, 4, 3, THIRDS, 2);
    check_boundary(BAT_MESH_SCHEME_SQRT3, 3, 3, THIRDS, 1);
}

enum
{
    AROUND = 9,
    ACROSS = 7
};

/// A perturbed torus with a crease once around it.
static bat_mesh creased_torus(double sharpness)
{
    bat_mesh mesh = mesh_torus(AROUND, ACROSS);
    mesh_shake(&mesh, 0.2, 6);
    if (sharpness > 0)
    {
        mesh.crease_count = AROUND;
        mesh.creases = mesh_room(AROUND, sizeof *mesh.creases);
    }
    for (uint32_t i = 0; i < mesh.crease_count; i++)
        mesh.creases[i] = (bat_mesh_crease){(i + 1) % AROUND * ACROSS, i * ACROSS, sharpness};
    return mesh;
}

/// A crease is the cubic B-spline of its own vertices and remains a crease.
static void test_creases_are_curves(void **state)
{
    (void)state;
    bat_mesh mesh = creased_torus(BAT_MESH_SHARP);
    polygon curve = {.points = mesh_room(AROUND, 3 * sizeof *curve.points), .count = AROUND};
    for (size_t i = 0; i < AROUND; i++)
        memcpy(curve.points + 3 * i, mesh.positions + 3 * i * ACROSS, 3 * sizeof *curve.points);
    bat_mesh fine = refine(&mesh, BAT_MESH_SCHEME_LOOP, 3, false);
    for (int level = 0; level < 3; level++)
        refine_polygon(&curve, 2, CUBIC);
    assert_int_equal(fine.crease_count, 8 * AROUND);
    for (size_t c = 0; c < fine.crease_count; c++)
    {
        double nearest[2] = {INFINITY, INFINITY};
        assert_true(fine.creases[c].sharpness == BAT_MESH_SHARP);
        for (size_t i = 0; i < curve.count; i++)
        {
            const double *p = point_of(&curve, i);
            nearest[0] = fmin(nearest[0], difference(p, fine.positions + 3 * (size_t)fine.creases[c].a));
            nearest[1] = fmin(nearest[1], difference(p, fine.positions + 3 * (size_t)fine.creases[c].b));
        }
        assert_true(nearest[0] < 1e-14 * 10 && nearest[1] < 1e-14 * 10);
    }
    free(curve.points);
    bat_mesh_free(&mesh);
    bat_mesh_free(&fine);
}

static void check_same_positions(const bat_mesh *a, const bat_mesh *b, double tolerance)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    for (size_t v = 0; v < a->vertex_count; v++)
        assert_true(difference(a->positions + 3 * v, b->positions + 3 * v) <= tolerance);
}

/// A sharpness of n acts like an infinite one for n levels and decreases by 1 on each.
static void test_sharpness_wears_off(void **state)
{
    (void)state;
    bat_mesh ever = creased_torus(BAT_MESH_SHARP), two = creased_torus(2);
    bat_mesh fine_ever = refine(&ever, BAT_MESH_SCHEME_LOOP, 2, false),
             fine_two = refine(&two, BAT_MESH_SCHEME_LOOP, 2, false);
    check_same_positions(&fine_ever, &fine_two, 0);
    assert_int_equal(fine_two.crease_count, 0);
    bat_mesh one = refine(&two, BAT_MESH_SCHEME_LOOP, 1, false);
    assert_int_equal(one.crease_count, 2 * AROUND);
    assert_true(one.creases[0].sharpness == 1);
    bat_mesh_free(&fine_ever);
    bat_mesh_free(&fine_two);
    fine_ever = refine(&ever, BAT_MESH_SCHEME_LOOP, 3, false);
    fine_two = refine(&two, BAT_MESH_SCHEME_LOOP, 3, false);
    assert_true(memcmp(fine_ever.positions, fine_two.positions, 3 * fine_two.vertex_count * sizeof *fine_two.positions) !=
                0);
    bat_mesh_free(&ever);
    bat_mesh_free(&two);
    bat_mesh_free(&one);
    bat_mesh_free(&fine_ever);
    bat_mesh_free(&fine_two);
}

/// A sharpness between 0 and 1 blends the smooth and the sharp rule linearly.
static void test_fractions_blend(void **state)
{
    (void)state;
    bat_mesh none = creased_torus(0), quarter = creased_torus(0.25), ever = creased_torus(BAT_MESH_SHARP);
    bat_mesh smooth = refine(&none, BAT_MESH_SCHEME_LOOP, 1, false), sharp = refine(&ever, BAT_MESH_SCHEME_LOOP, 1, false);
    bat_mesh between = refine(&quarter, BAT_MESH_SCHEME_LOOP, 1, false);
    double most = 0;
    for (size_t i = 0; i < 3 * smooth.vertex_count; i++)
    {
        check_near(between.positions[i], 0.75 * smooth.positions[i] + 0.25 * sharp.positions[i], 1e-14 * 10);
        most = fmax(most, fabs(smooth.positions[i] - sharp.positions[i]));
    }
    assert_true(most > 0.01);
    bat_mesh *all[] = {&none, &quarter, &ever, &smooth, &sharp, &between};
    for (size_t i = 0; i < 6; i++)
        bat_mesh_free(all[i]);
}

static void test_corners_stay(void **state)
{
    (void)state;
    bat_mesh mesh = creased_torus(0);
    mesh.corners = mesh_room(2, sizeof *mesh.corners);
    mesh.corner_count = 2;
    mesh.corners[0] = (bat_mesh_corner){5, BAT_MESH_SHARP};
    mesh.corners[1] = (bat_mesh_corner){12, 2};
    bat_mesh fine = refine(&mesh, BAT_MESH_SCHEME_LOOP, 3, true), two = refine(&mesh, BAT_MESH_SCHEME_LOOP, 2, false);
    assert_true(difference(fine.positions + 15, mesh.positions + 15) == 0);
    assert_true(difference(fine.positions + 36, mesh.positions + 36) > 0.01);
    assert_true(difference(two.positions + 36, mesh.positions + 36) == 0);
    assert_int_equal(fine.corner_count, 1);
    assert_int_equal(fine.corners[0].vertex, 5);
    bat_mesh_free(&mesh);
    bat_mesh_free(&fine);
    bat_mesh_free(&two);
}

/// The normals of adjacent faces of an octahedron differ by acos(1/3), 1.23 radians.
static void test_crease_angle(void **state)
{
    (void)state;
    bat_mesh mesh = mesh_octahedron();
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_LOOP;
    options.crease_angle = 1.2;
    bat_mesh sharp = refine_with(&mesh, &options), halved = refine(&mesh, BAT_MESH_SCHEME_MIDPOINT, 2, false);
    check_same_positions(&sharp, &halved, 1e-15);
    assert_int_equal(sharp.crease_count, 4 * 12);
    options.crease_angle = 1.3;
    bat_mesh smooth = refine_with(&mesh, &options), plain = refine(&mesh, BAT_MESH_SCHEME_LOOP, 2, false);
    check_same_positions(&smooth, &plain, 0);
    assert_int_equal(smooth.crease_count, 0);
    bat_mesh *all[] = {&mesh, &sharp, &halved, &smooth, &plain};
    for (size_t i = 0; i < 5; i++)
        bat_mesh_free(all[i]);
}

/// A mesh with irregular vertices, boundaries, corners, and creases that end inside, meet each other and meet the boundary.
static bat_mesh sharp_mesh(void)
{
    bat_mesh closed = mesh_irregular(12, 9, 5), grid = mesh_grid(8, 7), mesh = mesh_join(&closed, &grid);
    mesh_shake(&mesh, 0.15, 4);
    bat_mesh_connectivity links;
    check_status(bat_mesh_connect(&mesh, &links, NULL), BAT_OK);
    bat_random random = bat_random_seed(11);
    mesh.creases = mesh_room(links.edge_count, sizeof *mesh.creases);
    for (uint32_t h = 0; h < 3 * mesh.face_count; h++)
        if (links.twin[h] > h && links.twin[h] != BAT_MESH_NONE && bat_random_uniform(&random) < 0.2)
            mesh.creases[mesh.crease_count++] =
                (bat_mesh_crease){mesh.faces[h], mesh.faces[bat_mesh_next(h)], BAT_MESH_SHARP};
    mesh.corners = mesh_room(1, sizeof *mesh.corners);
    mesh.corners[mesh.corner_count++] = (bat_mesh_corner){3, BAT_MESH_SHARP};
    bat_mesh_connectivity_free(&links);
    bat_mesh_free(&closed);
    bat_mesh_free(&grid);
    return mesh;
}

/// A refined mesh has the limit of the mesh.
static void test_limit_is_fixed(void **state)
{
    (void)state;
    bat_mesh mesh = sharp_mesh(), now = refine(&mesh, BAT_MESH_SCHEME_LOOP, 0, true),
             later = refine(&mesh, BAT_MESH_SCHEME_LOOP, 3, true);
    for (size_t v = 0; v < mesh.vertex_count; v++)
        assert_true(difference(now.positions + 3 * v, later.positions + 3 * v) < 1e-13 * 3);
    // Vertices converge to the limit.
    bat_mesh far = refine(&mesh, BAT_MESH_SCHEME_LOOP, 6, false);
    for (size_t v = 0; v < mesh.vertex_count; v++)
        assert_true(difference(now.positions + 3 * v, far.positions + 3 * v) < 0.03);
    bat_mesh *all[] = {&mesh, &now, &later, &far};
    for (size_t i = 0; i < 4; i++)
        bat_mesh_free(all[i]);
}

/// The number of sharp edges at each vertex; boundary vertices have two more.
static unsigned *count_sharp(const bat_mesh *mesh)
{
    unsigned *count = mesh_room(mesh->vertex_count, sizeof *count);
    bat_mesh_connectivity links;
    check_status(bat_mesh_connect(mesh, &links, NULL), BAT_OK);
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        count[mesh->creases[i].a]++;
        count[mesh->creases[i].b]++;
    }
    for (size_t i = 0; i < mesh->corner_count; i++)
        count[mesh->corners[i].vertex] += 3;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        count[v] += links.twin[links.first[v]] == BAT_MESH_NONE ? 2 : 0;
    bat_mesh_connectivity_free(&links);
    return count;
}

/// Where there is a tangent plane, refinement preserves it.
static void test_normals_are_fixed(void **state)
{
    (void)state;
    bat_mesh mesh = sharp_mesh(), fine = refine(&mesh, BAT_MESH_SCHEME_LOOP, 2, false);
    double *now = mesh_room(mesh.vertex_count, 3 * sizeof *now), *later = mesh_room(fine.vertex_count, 3 * sizeof *later);
    check_status(bat_mesh_limit_normals(&mesh, 1, now, NULL), BAT_OK);
    check_status(bat_mesh_limit_normals(&fine, 2, later, NULL), BAT_OK);
    unsigned *sharp = count_sharp(&mesh);
    size_t seen[4] = {0};
    for (size_t v = 0; v < mesh.vertex_count; v++)
    {
        double length = sqrt(now[3 * v] * now[3 * v] + now[3 * v + 1] * now[3 * v + 1] + now[3 * v + 2] * now[3 * v + 2]);
        check_near(length, 1, 1e-14);
        seen[sharp[v] < 3 ? sharp[v] : 3]++;
        if (sharp[v] == 0 || sharp[v] == 2)
            assert_true(difference(now + 3 * v, later + 3 * v) < 1e-11);
    }
    assert_true(seen[0] > 10 && seen[1] > 10 && seen[2] > 10 && seen[3] > 10);
    free(now);
    free(later);
    free(sharp);
    bat_mesh_free(&mesh);
    bat_mesh_free(&fine);
}

/// Normals of an icosahedron point away from its centre; normals of a plane point up, also on boundaries.
static void test_normals_point_outwards(void **state)
{
    (void)state;
    bat_mesh icosahedron = mesh_icosahedron(), grid = mesh_grid(6, 5);
    double normals[3 * 30];
    check_status(bat_mesh_limit_normals(&icosahedron, 1, normals, NULL), BAT_OK);
    double radius = sqrt(1 + 1.6180339887498949 * 1.6180339887498949);
    for (size_t i = 0; i < 36; i++)
        check_near(normals[i], icosahedron.positions[i] / radius, 1e-14);
    check_status(bat_mesh_limit_normals(&grid, 1, normals, NULL), BAT_OK);
    for (size_t v = 0; v < grid.vertex_count; v++)
    {
        const double up[3] = {0, 0, 1};
        assert_true(difference(normals + 3 * v, up) < 1e-14);
    }
    bat_mesh_free(&icosahedron);
    bat_mesh_free(&grid);
}

/// (40 - (3 + 2 cos(2 pi / n))^2) / 64 n
static void test_ring_weights(void **state)
{
    (void)state;
    check_near(loop_smooth_mask(3).ring, 3.0 / 16, 1e-16);
    check_near(loop_smooth_mask(4).ring, (40 - 9) / 64.0 / 4, 1e-16);
    check_near(loop_smooth_mask(6).ring, 1.0 / 16, 0);
    // The tabulated weight of a regular vertex is that of the formula.
    double root = 3 + 2 * cos(6.283185307179586 / 6);
    check_near(loop_smooth_mask(6).ring, (40 - root * root) / 64 / 6, 1e-16);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_boundaries_are_curves),  cmocka_unit_test(test_creases_are_curves),
        cmocka_unit_test(test_sharpness_wears_off),    cmocka_unit_test(test_fractions_blend),
        cmocka_unit_test(test_corners_stay),           cmocka_unit_test(test_crease_angle),
        cmocka_unit_test(test_limit_is_fixed),         cmocka_unit_test(test_normals_are_fixed),
        cmocka_unit_test(test_normals_point_outwards), cmocka_unit_test(test_ring_weights),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
