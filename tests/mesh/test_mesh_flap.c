// Half-flaps of closed and open meshes and of their refinements, against their definition.

#include "mesh_flap_helpers.h"

static bool has_face(const bat_mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    for (size_t f = 0; f < mesh->face_count; f++)
        for (size_t k = 0; k < 3; k++)
            if (mesh->faces[3 * f + k] == a && mesh->faces[3 * f + (k + 1) % 3] == b &&
                mesh->faces[3 * f + (k + 2) % 3] == c)
                return true;
    return false;
}

static void check_flaps(const bat_mesh *mesh, const mesh_flaps *flaps)
{
    size_t sides = 0;
    assert_int_equal(flaps->count, 2 * flaps->edge_count);
    assert_int_equal(flaps->first[0], 0);
    assert_int_equal(flaps->first[flaps->vertex_count], flaps->count);
    for (uint32_t f = 0; f < flaps->count; f++)
    {
        const mesh_flap *flap = &flaps->flap[f];
        const uint32_t *c = flap->corner, *pair = flaps->of_edge[flap->edge];
        assert_true(flaps->first[c[0]] <= f && f < flaps->first[c[0] + 1]);
        assert_int_equal(has_face(mesh, c[0], c[1], c[2]), flap->missing != MESH_FLAP_NO_LEFT);
        assert_int_equal(has_face(mesh, c[1], c[0], c[3]), flap->missing != MESH_FLAP_NO_RIGHT);
        assert_true(flap->missing == MESH_FLAP_WHOLE || c[2] == c[3]);
        assert_true((pair[0] == f) != (pair[1] == f));
        const mesh_flap *other = &flaps->flap[pair[0] == f ? pair[1] : pair[0]];
        assert_true(other->corner[0] == c[1] && other->corner[1] == c[0]);
        sides += flap->missing != MESH_FLAP_NO_LEFT;
    }
    assert_int_equal(sides, 3 * mesh->face_count);
}

/// The half-flaps around a vertex are counter-clockwise: the left corner of each is the end of the next.
static void check_order(const mesh_flaps *flaps)
{
    for (size_t v = 0; v < flaps->vertex_count; v++)
        for (uint32_t f = flaps->first[v]; f + 1 < flaps->first[v + 1]; f++)
            assert_int_equal(flaps->flap[f].corner[2], flaps->flap[f + 1].corner[1]);
}

/// The half-flaps of a level are those of the refined faces.
static void check_levels(const bat_mesh *mesh)
{
    enum
    {
        LEVELS = 3
    };
    mesh_levels levels = levels_of(mesh, LEVELS);
    for (size_t count = 0; count < LEVELS; count++)
    {
        bat_mesh fine = split(mesh, count);
        mesh_levels own = levels_of(&fine, 1);
        check_flaps(&fine, &levels.level[count]);
        check_order(&levels.level[count]);
        assert_int_equal(own.level[0].count, levels.level[count].count);
        assert_memory_equal(own.level[0].flap, levels.level[count].flap, own.level[0].count * sizeof(mesh_flap));
        mesh_levels_free(&own);
        bat_mesh_free(&fine);
    }
    bat_mesh fine = split(mesh, LEVELS);
    assert_int_equal(levels.vertex_count, fine.vertex_count);
    bat_mesh_free(&fine);
    mesh_levels_free(&levels);
}

static void half_flaps_are_what_lies_beside_directed_edges(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(1);
    for (size_t missing = 0; missing < 5; missing++)
    {
        bat_mesh mesh = octahedron(missing, 0, &random);
        check_levels(&mesh);
        bat_mesh_free(&mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(half_flaps_are_what_lies_beside_directed_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
