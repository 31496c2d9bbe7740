// Refinement of meshes: numbering, neighbours, and what every scheme keeps.
#include "check.h"
#include "mesh_helpers.h"

#include "batten/mesh_refine.h"
#include "mesh/split.h"

static bat_mesh refine(const bat_mesh *coarse, bat_mesh_scheme scheme, size_t levels)
{
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = scheme;
    options.levels = levels;
    bat_mesh fine;
    bat_error error = {0};
    bat_status status = bat_mesh_refine(coarse, &options, &fine, NULL, &error);
    if (status != BAT_OK)
        print_error("%s\n", error.text);
    check_status(status, BAT_OK);
    return fine;
}

static void check_same_links(const bat_mesh_connectivity *a, const bat_mesh_connectivity *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->face_count, b->face_count);
    assert_int_equal(a->edge_count, b->edge_count);
    assert_int_equal(a->boundary_edge_count, b->boundary_edge_count);
    assert_memory_equal(a->twin, b->twin, 3 * a->face_count * sizeof *a->twin);
    assert_memory_equal(a->edge, b->edge, 3 * a->face_count * sizeof *a->edge);
    assert_memory_equal(a->first, b->first, a->vertex_count * sizeof *a->first);
}

/// The neighbours that arithmetic gives are those that a search finds.
static void check_split_links(const bat_mesh *mesh, int threads)
{
    bat_mesh_connectivity links, split, found;
    assert_int_equal(bat_mesh_connect(mesh, &links, NULL), BAT_OK);
    assert_int_equal(split_links(&links, threads, &split, NULL), BAT_OK);
    bat_mesh fine = {.vertex_count = split.vertex_count, .face_count = split.face_count};
    fine.faces = calloc(fine.face_count, 3 * sizeof *fine.faces);
    assert_non_null(fine.faces);
    split_faces(mesh->faces, &links, threads, fine.faces);
    assert_int_equal(bat_mesh_connect(&fine, &found, NULL), BAT_OK);
    check_same_links(&split, &found);
    bat_mesh_connectivity_free(&links);
    bat_mesh_connectivity_free(&split);
    bat_mesh_connectivity_free(&found);
    free(fine.faces);
}

static void test_split_links(void **state)
{
    (void)state;
    bat_mesh meshes[] = {mesh_tetrahedron(), mesh_octahedron(), mesh_icosahedron(),       mesh_grid(5, 4),
                         mesh_torus(8, 5),   mesh_fan(7, true), mesh_irregular(40, 30, 1)};
    for (size_t i = 0; i < sizeof meshes / sizeof meshes[0]; i++)
    {
        check_split_links(&meshes[i], 1);
        check_split_links(&meshes[i], 3);
        bat_mesh fine = refine(&meshes[i], BAT_MESH_MIDPOINT, 1);
        check_split_links(&fine, 2);
        bat_mesh_free(&fine);
        bat_mesh_free(&meshes[i]);
    }
}

/// Black faces, then white ones, which own no edge.
static void test_split_links_of_faces_without_edges(void **state)
{
    (void)state;
    bat_mesh mesh = mesh_torus(60, 50);
    uint32_t *sorted = calloc(mesh.face_count, 3 * sizeof *sorted);
    assert_non_null(sorted);
    for (size_t f = 0; f < mesh.face_count; f++)
    {
        size_t to = f / 2 + (f % 2) * (mesh.face_count / 2);
        memcpy(sorted + 3 * to, mesh.faces + 3 * f, 3 * sizeof *sorted);
    }
    free(mesh.faces);
    mesh.faces = sorted;
    check_split_links(&mesh, 1);
    check_split_links(&mesh, 4);
    bat_mesh_free(&mesh);
}

static void check_same_mesh(const bat_mesh *a, const bat_mesh *b, double tolerance)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->face_count, b->face_count);
    assert_memory_equal(a->faces, b->faces, 3 * a->face_count * sizeof *a->faces);
    for (size_t i = 0; i < 3 * a->vertex_count; i++)
        check_near(a->positions[i], b->positions[i], tolerance);
}

static const bat_mesh_scheme SCHEMES[] = {BAT_MESH_MIDPOINT, BAT_MESH_LOOP, BAT_MESH_BUTTERFLY, BAT_MESH_SQRT3};
enum
{
    SCHEME_COUNT = sizeof SCHEMES / sizeof SCHEMES[0]
};

/// A level after another is two levels.
static void test_levels_add_up(void **state)
{
    (void)state;
    bat_mesh irregular = mesh_irregular(9, 7, 5), grid = mesh_grid(5, 4), joined = mesh_join(&irregular, &grid);
    mesh_shake(&joined, 0.1, 3);
    // Square-root-three subdivision treats boundaries in turns.
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        bool in_turns = SCHEMES[s] == BAT_MESH_SQRT3;
        bat_mesh one = refine(&joined, SCHEMES[s], in_turns ? 2 : 1), two = refine(&one, SCHEMES[s], 2);
        bat_mesh both = refine(&joined, SCHEMES[s], in_turns ? 4 : 3);
        check_same_mesh(&two, &both, 1e-13);
        bat_mesh_free(&one);
        bat_mesh_free(&two);
        bat_mesh_free(&both);
    }
    bat_mesh_free(&irregular);
    bat_mesh_free(&grid);
    bat_mesh_free(&joined);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_split_links),
        cmocka_unit_test(test_split_links_of_faces_without_edges),
        cmocka_unit_test(test_levels_add_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
