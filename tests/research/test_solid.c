// Meshes of solids: exact where surfaces are flat, of second order where they are round, edges where surfaces meet.
#include "check.h"

#include "mesh/hash_table.h"
#include "research/shapes/edit_mesh.h"
#include "research/shapes/solid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static double ball_value(const void *radius, const double p[3])
{
    return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - *(const double *)radius;
}

static double bar_value(const void *radius, const double p[3])
{
    return hypot(p[0], p[1]) - *(const double *)radius;
}

/// Between two planes across the axis whose number comes first.
static double slab_value(const void *axis_and_half, const double p[3])
{
    const double *slab = axis_and_half;
    return fabs(p[(int)slab[0]]) - slab[1];
}

static double floor_value(const void *height, const double p[3])
{
    return *(const double *)height - p[2];
}

static void set_box(solid *s, double half)
{
    for (int c = 0; c < 3; c++)
    {
        s->low[c] = -half;
        s->high[c] = half;
    }
}

static double volume(const bat_mesh *mesh, double *area)
{
    double sum = 0;
    *area = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *corner = mesh->faces + 3 * f;
        const double *a = mesh->positions + 3 * (size_t)corner[0], *b = mesh->positions + 3 * (size_t)corner[1];
        const double *c = mesh->positions + 3 * (size_t)corner[2];
        double square = 0;
        for (int i = 0; i < 3; i++)
        {
            int j = (i + 1) % 3, k = (i + 2) % 3;
            double normal = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
            sum += a[i] * normal / 6;
            square += normal * normal;
        }
        *area += sqrt(square) / 2;
    }
    return sum;
}

static long euler(const bat_mesh *mesh, size_t *boundary)
{
    bat_mesh_connectivity joined;
    assert_int_equal(bat_mesh_connect(mesh, &joined, NULL), BAT_OK);
    long value = (long)mesh->vertex_count - (long)joined.edge_count + (long)mesh->face_count;
    *boundary = joined.boundary_edge_count;
    bat_mesh_connectivity_free(&joined);
    return value;
}

/// A ball's vertices lie on it; its volume is too small by an amount that falls with the square of the edge.
static void test_ball(void **state)
{
    (void)state;
    double radius = 0.8, missing[2];
    for (int finer = 0; finer < 2; finer++)
    {
        solid s = {0};
        solid_push(&s, ball_value, &radius);
        set_box(&s, radius);
        bat_mesh mesh;
        size_t boundary;
        assert_int_equal(solid_mesh(&s, finer ? 4000 : 1000, &mesh, NULL), BAT_OK);
        for (size_t v = 0; v < mesh.vertex_count; v++)
            assert_true(fabs(ball_value(&radius, mesh.positions + 3 * v)) < 1e-8);
        double area, inside = volume(&mesh, &area);
        missing[finer] = 4 * PI * pow(radius, 3) / 3 - inside;
        assert_int_equal(euler(&mesh, &boundary), 2);
        assert_int_equal(boundary, 0);
        bat_mesh_free(&mesh);
    }
    assert_true(missing[1] > 0);
    assert_true(fabs(missing[0] / missing[1] - 4) < 0.5);
}

/// A brick's edges and corners are in the mesh: volume and area are exact.
static void test_brick(void **state)
{
    (void)state;
    const double slabs[3][2] = {{0, 0.5}, {1, 0.3}, {2, 0.7}};
    solid s = {0};
    for (int c = 0; c < 3; c++)
    {
        solid_push(&s, slab_value, slabs[c]);
        if (c > 0)
            solid_and(&s);
    }
    set_box(&s, 0.7);
    bat_mesh mesh;
    assert_int_equal(solid_mesh(&s, 1500, &mesh, NULL), BAT_OK);
    double area, inside = volume(&mesh, &area);
    assert_true(fabs(inside - 1.0 * 0.6 * 1.4) < 1e-8);
    assert_true(fabs(area - 2 * (0.6 + 1.4 + 0.84)) < 1e-8);
    size_t corners = 0;
    for (size_t v = 0; v < mesh.vertex_count; v++)
    {
        const double *p = mesh.positions + 3 * v;
        corners += fabs(fabs(p[0]) - 0.5) < 1e-9 && fabs(fabs(p[1]) - 0.3) < 1e-9 && fabs(fabs(p[2]) - 0.7) < 1e-9;
    }
    assert_int_equal(corners, 8);
    bat_mesh_free(&mesh);
}

/// A bored bar has one hole; what is both on the bore and on the end lies on both exactly.
static void test_tube(void **state)
{
    (void)state;
    const double outer = 0.6, inner = 0.3, ends[2] = {2, 0.4};
    solid s = {0};
    solid_push(&s, bar_value, &outer);
    solid_push(&s, slab_value, ends);
    solid_and(&s);
    solid_push(&s, bar_value, &inner);
    solid_subtract(&s);
    set_box(&s, 0.6);
    bat_mesh mesh;
    size_t boundary, rim = 0;
    assert_int_equal(solid_mesh(&s, 2000, &mesh, NULL), BAT_OK);
    assert_int_equal(euler(&mesh, &boundary), 0);
    for (size_t v = 0; v < mesh.vertex_count; v++)
    {
        const double *p = mesh.positions + 3 * v;
        double across[3] = {fabs(bar_value(&outer, p)), fabs(bar_value(&inner, p)), fabs(slab_value(ends, p))};
        assert_true(fmin(fmin(across[0], across[1]), across[2]) < 1e-8);
        rim += across[1] < 1e-8 && across[2] < 1e-8;
    }
    assert_true(rim >= 30);
    bat_mesh_free(&mesh);
}

/// A ball open below: one boundary, on the circle.
static void test_open(void **state)
{
    (void)state;
    const double radius = 0.5, height = -0.3;
    solid s = {0};
    solid_push(&s, ball_value, &radius);
    solid_push_open(&s, floor_value, &height);
    solid_and(&s);
    set_box(&s, 0.5);
    bat_mesh mesh;
    bat_mesh_connectivity joined;
    assert_int_equal(solid_mesh(&s, 1500, &mesh, NULL), BAT_OK);
    assert_true(fabs((double)mesh.vertex_count / 1500 - 1) < 0.1);
    assert_int_equal(bat_mesh_connect(&mesh, &joined, NULL), BAT_OK);
    assert_int_equal((long)mesh.vertex_count - (long)joined.edge_count + (long)mesh.face_count, 1);
    assert_true(joined.boundary_edge_count > 20);
    for (uint32_t h = 0; h < 3 * mesh.face_count; h++)
        if (joined.twin[h] == BAT_MESH_NONE)
        {
            const double *p = mesh.positions + 3 * (size_t)mesh.faces[h];
            assert_true(fabs(p[2] - height) < 1e-8 && fabs(hypot(p[0], p[1]) - 0.4) < 1e-8);
        }
    bat_mesh_connectivity_free(&joined);
    bat_mesh_free(&mesh);
}

static void test_nothing_is_refused(void **state)
{
    (void)state;
    const double radius = -0.5;
    solid s = {0};
    solid_push(&s, ball_value, &radius);
    set_box(&s, 1);
    bat_mesh mesh = {.vertex_count = 5};
    assert_int_equal(solid_mesh(&s, 1000, &mesh, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(mesh.vertex_count, 5);
}

/// Every half-edge has the twin it should have and every vertex a half-edge of its own.
static void check_edit(const edit_mesh *edit)
{
    size_t dead = 0;
    for (uint32_t f = 0; f < edit->face_count; f++)
    {
        if (edit->faces[f][0] == BAT_MESH_NONE)
        {
            dead++;
            continue;
        }
        for (uint32_t h = 3 * f; h < 3 * f + 3; h++)
        {
            assert_int_equal(edit->twin[edit->twin[h]], h);
            assert_int_equal(edit_from(edit, edit->twin[h]), edit_to(edit, h));
            assert_int_equal(edit_to(edit, edit->twin[h]), edit_from(edit, h));
            assert_true(edit->first[edit_from(edit, h)] != BAT_MESH_NONE);
        }
    }
    assert_int_equal(dead, edit->dead_faces);
    for (uint32_t v = 0; v < edit->vertex_count; v++)
        if (edit->first[v] != BAT_MESH_NONE)
            assert_int_equal(edit_from(edit, edit->first[v]), v);
}

/// Splits, flips and collapses at random keep a closed surface of the same Euler characteristic.
static void test_edits(void **state)
{
    (void)state;
    const double radius = 0.8;
    solid s = {0};
    solid_push(&s, ball_value, &radius);
    set_box(&s, radius);
    bat_mesh mesh;
    uint16_t *marks;
    edit_mesh edit;
    assert_int_equal(solid_cut(&s, 0.3, 2, &mesh, &marks, NULL), BAT_OK);
    assert_int_equal(edit_mesh_begin(&mesh, marks, &edit, NULL), BAT_OK);
    bat_random random = bat_random_seed(3);
    size_t flips = 0, collapses = 0;
    for (int i = 0; i < 3000; i++)
    {
        uint32_t h = (uint32_t)(bat_random_bits(&random) % (3 * edit.face_count));
        if (edit.faces[h / 3][0] == BAT_MESH_NONE)
            continue;
        switch (bat_random_bits(&random) % 3)
        {
        case 0:
            assert_true(edit_split(&edit, h));
            break;
        case 1:
            flips += edit_flip(&edit, h);
            break;
        default:
            collapses += edit_collapse(&edit, h, edit.positions[edit_to(&edit, h)], 10);
            break;
        }
        if (i % 50 == 0)
            check_edit(&edit);
    }
    assert_true(flips > 100 && collapses > 100);
    assert_int_equal(edit_mesh_compact(&edit, NULL), BAT_OK);
    check_edit(&edit);
    assert_int_equal(edit.dead_faces, 0);
    assert_int_equal(2 * edit.vertex_count - edit.face_count, 4);
    edit_mesh_free(&edit);
    bat_mesh_free(&mesh);
    free(marks);
}

static void test_key_map(void **state)
{
    (void)state;
    key_map map = {0};
    assert_int_equal(key_map_find(&map, 4), UINT32_MAX);
    for (uint32_t i = 0; i < 10000; i++)
    {
        uint32_t *value = key_map_at(&map, key_of_pair(7 * i, i));
        assert_non_null(value);
        assert_int_equal(*value, UINT32_MAX);
        *value = i;
    }
    for (uint32_t i = 0; i < 10000; i++)
    {
        assert_int_equal(key_map_find(&map, key_of_pair(i, 7 * i)), i);
        assert_int_equal(key_map_find(&map, key_of_pair(i, 7 * i + 1)), UINT32_MAX);
    }
    key_map_free(&map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ball),
        cmocka_unit_test(test_brick),
        cmocka_unit_test(test_tube),
        cmocka_unit_test(test_open),
        cmocka_unit_test(test_edits),
        cmocka_unit_test(test_key_map),
        cmocka_unit_test(test_nothing_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
