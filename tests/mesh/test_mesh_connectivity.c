// Half-edges: neighbours around faces, vertices and boundaries, and refusals.
#include "check.h"

#include "batten/mesh.h"

#include <stdlib.h>
#include <string.h>

/// A mesh over borrowed arrays; do not free it.
static bat_mesh mesh_of(uint32_t *faces, size_t face_count, size_t vertex_count)
{
    static double positions[3 * 64];
    assert_true(vertex_count <= 64);
    return (bat_mesh){.positions = positions, .vertex_count = vertex_count, .faces = faces, .face_count = face_count};
}

static void check_consistent(const bat_mesh *mesh, const bat_mesh_connectivity *made)
{
    size_t boundary = 0;
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
    {
        uint32_t twin = made->twin[h];
        boundary += twin == BAT_MESH_NONE;
        assert_true(made->edge[h] < made->edge_count);
        assert_int_equal(bat_mesh_previous(bat_mesh_next(h)), h);
        if (twin == BAT_MESH_NONE)
        {
            assert_int_equal(made->first[mesh->faces[h]], h);
            continue;
        }
        assert_int_equal(made->twin[twin], h);
        assert_int_equal(made->edge[twin], made->edge[h]);
        assert_int_equal(mesh->faces[twin], mesh->faces[bat_mesh_next(h)]);
        assert_int_equal(mesh->faces[bat_mesh_next(twin)], mesh->faces[h]);
    }
    assert_int_equal(boundary, made->boundary_edge_count);
    assert_int_equal(2 * made->edge_count, 3 * mesh->face_count + boundary);
}

static void test_tetrahedron(void **state)
{
    (void)state;
    uint32_t faces[] = {0, 1, 2, 0, 2, 3, 0, 3, 1, 3, 2, 1};
    bat_mesh mesh = mesh_of(faces, 4, 5);
    bat_mesh_connectivity made;
    assert_int_equal(bat_mesh_connect(&mesh, &made, NULL), BAT_OK);
    check_consistent(&mesh, &made);
    assert_int_equal(made.edge_count, 6);
    assert_int_equal(made.boundary_edge_count, 0);
    assert_int_equal(made.first[4], BAT_MESH_NONE);
    // Around vertex 0, counter-clockwise: towards 1, 2, 3.
    uint32_t h = made.first[0];
    for (uint32_t i = 0; i < 3; i++)
    {
        assert_int_equal(faces[bat_mesh_next(h)], i + 1);
        assert_int_equal(bat_mesh_previous_around(&made, bat_mesh_next_around(&made, h)), h);
        h = bat_mesh_next_around(&made, h);
    }
    assert_int_equal(h, made.first[0]);
    bat_mesh_connectivity_free(&made);
}

static void test_boundary_fan_begins_at_the_boundary(void **state)
{
    (void)state;
    // Four faces around vertex 0, not closed, the last one first.
    uint32_t faces[] = {4, 5, 0, 2, 3, 0, 0, 1, 2, 3, 4, 0};
    bat_mesh mesh = mesh_of(faces, 4, 6);
    bat_mesh_connectivity made;
    assert_int_equal(bat_mesh_connect(&mesh, &made, NULL), BAT_OK);
    check_consistent(&mesh, &made);
    assert_int_equal(made.boundary_edge_count, 6);
    uint32_t h = made.first[0];
    for (uint32_t i = 1; i <= 4; i++, h = bat_mesh_next_around(&made, h))
    {
        assert_int_not_equal(h, BAT_MESH_NONE);
        assert_int_equal(faces[bat_mesh_next(h)], i);
    }
    assert_int_equal(h, BAT_MESH_NONE);
    assert_int_equal(bat_mesh_previous_around(&made, made.first[0]), BAT_MESH_NONE);
    bat_mesh_connectivity_free(&made);
}

static void check_refused(uint32_t *faces, size_t count, bat_status expected, size_t index, const char *words)
{
    bat_mesh mesh = mesh_of(faces, count, 8);
    bat_mesh_connectivity made = {.edge_count = 17};
    bat_error error = {0};
    assert_int_equal(bat_mesh_connect(&mesh, &made, &error), expected);
    assert_int_equal(error.index, index);
    if (strstr(error.text, words) == NULL)
        fail_msg("\"%s\" does not say \"%s\"", error.text, words);
    assert_int_equal(made.edge_count, 17);
    assert_int_equal(bat_mesh_connect(&mesh, &made, NULL), expected);
}

static void test_refusals(void **state)
{
    (void)state;
    uint32_t third[] = {0, 1, 2, 1, 0, 3, 0, 1, 4};
    check_refused(third, 3, BAT_NOT_MANIFOLD, 2, "face 2 is the third at the edge of vertices 0 and 1");
    uint32_t against[] = {0, 1, 2, 0, 1, 3};
    check_refused(against, 2, BAT_NOT_MANIFOLD, 1, "faces 0 and 1 run along the edge of vertices 0 and 1");
    uint32_t hourglass[] = {1, 2, 0, 0, 3, 4};
    check_refused(hourglass, 2, BAT_NOT_MANIFOLD, 1, "vertex 0 joins several fans");
    uint32_t beyond[] = {0, 1, 2, 0, 8, 1};
    check_refused(beyond, 2, BAT_INVALID_POINT, 1, "face 1 names a vertex beyond");
    uint32_t twice[] = {0, 1, 2, 3, 4, 3};
    check_refused(twice, 2, BAT_INVALID_POINT, 1, "face 1 has vertex 3 twice");
}

/// A wheel of a hundred thousand faces around one vertex: chains must not grow with its valence.
static void test_hub(void **state)
{
    (void)state;
    enum
    {
        SPOKES = 100000
    };
    uint32_t *faces = malloc(sizeof *faces * 3 * SPOKES);
    double *positions = calloc(3 * (SPOKES + 1), sizeof *positions);
    assert_non_null(faces);
    assert_non_null(positions);
    for (uint32_t i = 0; i < SPOKES; i++)
    {
        faces[3 * i] = 0;
        faces[3 * i + 1] = 1 + i;
        faces[3 * i + 2] = 1 + (i + 1) % SPOKES;
    }
    bat_mesh mesh = {.positions = positions, .vertex_count = SPOKES + 1, .faces = faces, .face_count = SPOKES};
    bat_mesh_connectivity made;
    assert_int_equal(bat_mesh_connect(&mesh, &made, NULL), BAT_OK);
    check_consistent(&mesh, &made);
    assert_int_equal(made.boundary_edge_count, SPOKES);
    bat_mesh_connectivity_free(&made);
    free(faces);
    free(positions);
}

static void test_check(void **state)
{
    (void)state;
    uint32_t faces[] = {0, 1, 2};
    bat_mesh mesh = mesh_of(faces, 1, 3);
    bat_error error;
    assert_int_equal(bat_mesh_check(&mesh, &error), BAT_OK);
    bat_mesh_crease crease = {0, 5, 1};
    mesh.creases = &crease;
    mesh.crease_count = 1;
    assert_int_equal(bat_mesh_check(&mesh, &error), BAT_INVALID_ARGUMENT);
    mesh.crease_count = 0;
    double broken[9] = {0, 0, 0, 0, 0.0 / 0.0};
    mesh.positions = broken;
    assert_int_equal(bat_mesh_check(&mesh, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    mesh.face_count = 0;
    assert_int_equal(bat_mesh_check(&mesh, &error), BAT_INVALID_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tetrahedron), cmocka_unit_test(test_boundary_fan_begins_at_the_boundary),
        cmocka_unit_test(test_refusals),    cmocka_unit_test(test_hub),
        cmocka_unit_test(test_check),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
