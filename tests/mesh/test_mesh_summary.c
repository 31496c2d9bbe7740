// Metrics of a mesh: closed forms for cubes, tori and grids, and non-manifold meshes.
#include "check.h"

#include "batten/mesh_measure.h"

static const double PI = 3.14159265358979323846;

static bat_mesh_summary summarize(const bat_mesh *mesh)
{
    bat_mesh_summary summary;
    bat_error error = {.text = ""};
    if (bat_mesh_summarize(mesh, &summary, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return summary;
}

static void test_cube(void **state)
{
    (void)state;
    double positions[24];
    for (int v = 0; v < 8; v++)
        for (int k = 0; k < 3; k++)
            positions[3 * v + k] = 5 + 2 * ((v >> k) & 1);
    uint32_t faces[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                          2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    bat_mesh mesh = {.positions = positions, .faces = faces, .vertex_count = 8, .face_count = 12};
    bat_mesh_summary summary = summarize(&mesh);
    assert_int_equal(summary.vertices, 8);
    assert_int_equal(summary.edges, 18);
    assert_int_equal(summary.components, 1);
    assert_int_equal(summary.euler, 2);
    assert_int_equal(summary.genus, 0);
    assert_true(summary.manifold && summary.oriented && summary.closed);
    check_relative(summary.area, 24.0, 1e-15);
    check_relative(summary.volume, 8.0, 1e-15);
    check_relative(summary.diagonal, 2 * sqrt(3), 1e-15);
    check_near(summary.low[1], 5, 0);
    check_near(summary.high[2], 7, 0);
    check_relative(summary.min_edge, 2.0, 1e-15);
    check_relative(summary.max_edge, sqrt(8), 1e-15);
    check_relative(summary.mean_edge, (12 * 2 + 6 * sqrt(8)) / 18, 1e-15);
    check_relative(summary.min_quality, sqrt(3) / 2, 1e-15);
    check_relative(summary.mean_quality, sqrt(3) / 2, 1e-15);
    check_relative(summary.min_angle, PI / 4, 1e-15);
    check_relative(summary.max_angle, PI / 2, 1e-15);
    assert_int_equal(summary.min_valence, 3);
    assert_int_equal(summary.max_valence, 5);
    // With reversed faces.
    for (int f = 0; f < 12; f++)
    {
        uint32_t kept = faces[3 * f];
        faces[3 * f] = faces[3 * f + 1];
        faces[3 * f + 1] = kept;
    }
    check_relative(summarize(&mesh).volume, -8.0, 1e-15);
    // One face reversed.
    uint32_t kept = faces[0];
    faces[0] = faces[1];
    faces[1] = kept;
    summary = summarize(&mesh);
    assert_int_equal(summary.reversed_edges, 3);
    assert_true(summary.manifold && !summary.oriented && summary.closed);
    assert_true(isnan(summary.volume));
    assert_int_equal(summary.genus, -1);
}

/// A torus of n x m vertices, or a tube or a sheet where a direction is open.
static bat_mesh quilt(uint32_t n, uint32_t m, bool closed_n, bool closed_m)
{
    uint32_t across = closed_n ? n : n - 1, along = closed_m ? m : m - 1;
    bat_mesh mesh = {.positions = calloc((size_t)n * m, 3 * sizeof(double)),
                     .faces = calloc((size_t)across * along, 6 * sizeof(uint32_t)),
                     .vertex_count = (size_t)n * m,
                     .face_count = (size_t)2 * across * along};
    assert_non_null(mesh.positions);
    assert_non_null(mesh.faces);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < m; j++)
        {
            double a = 2 * PI * i / n, b = 2 * PI * j / m, *at = mesh.positions + 3 * ((size_t)i * m + j);
            at[0] = (2 + cos(b)) * cos(a);
            at[1] = (2 + cos(b)) * sin(a);
            at[2] = sin(b);
        }
    uint32_t *face = mesh.faces;
    for (uint32_t i = 0; i < across; i++)
        for (uint32_t j = 0; j < along; j++, face += 6)
        {
            uint32_t next_i = (i + 1) % n, next_j = (j + 1) % m;
            const uint32_t corners[6] = {i * m + j, next_i * m + j,      next_i * m + next_j,
                                         i * m + j, next_i * m + next_j, i * m + next_j};
            memcpy(face, corners, sizeof corners);
        }
    return mesh;
}

static void check_quilt(bool closed_n, bool closed_m, int64_t euler, size_t loops)
{
    bat_mesh mesh = quilt(30, 20, closed_n, closed_m);
    bat_mesh_summary summary = summarize(&mesh);
    assert_int_equal(summary.euler, euler);
    assert_int_equal(summary.boundary_loops, loops);
    assert_int_equal(summary.components, 1);
    assert_true(summary.manifold && summary.oriented);
    assert_true(summary.closed == (loops == 0));
    assert_int_equal(summary.genus, loops == 0 ? 1 : -1);
    bat_mesh_connectivity connectivity;
    check_status(bat_mesh_connect(&mesh, &connectivity, NULL), BAT_OK);
    assert_int_equal(summary.edges, connectivity.edge_count);
    assert_int_equal(summary.boundary_edges, connectivity.boundary_edge_count);
    bat_mesh_connectivity_free(&connectivity);
    bat_mesh_free(&mesh);
}

static void test_quilts(void **state)
{
    (void)state;
    check_quilt(true, true, 0, 0);
    check_quilt(true, false, 0, 2);
    check_quilt(false, true, 0, 2);
    check_quilt(false, false, 1, 1);
}

/// Area and volume of a fine torus converge to 4 pi^2 R r and 2 pi^2 R r^2 with second order.
static void test_torus_converges(void **state)
{
    (void)state;
    double errors[2][2];
    for (int level = 0; level < 2; level++)
    {
        bat_mesh mesh = quilt(100u << level, 50u << level, true, true);
        bat_mesh_summary summary = summarize(&mesh);
        errors[0][level] = fabs(summary.area - 8 * PI * PI);
        errors[1][level] = fabs(summary.volume - 4 * PI * PI);
        assert_int_equal(summary.min_valence, 6);
        assert_int_equal(summary.max_valence, 6);
        bat_mesh_free(&mesh);
    }
    check_near(errors[0][0] / errors[0][1], 4, 0.05);
    check_near(errors[1][0] / errors[1][1], 4, 0.05);
}

/// Each removed face of a torus adds a loop and decreases the Euler characteristic.
static void test_holes(void **state)
{
    (void)state;
    enum
    {
        APART = 150
    };
    bat_mesh mesh = quilt(20, 20, true, true);
    for (size_t holes = 1; holes <= 5; holes++)
    {
        size_t at = APART * (holes - 1);
        mesh.face_count--;
        memmove(mesh.faces + 3 * at, mesh.faces + 3 * (at + 1), 3 * (mesh.face_count - at) * sizeof *mesh.faces);
        bat_mesh_summary summary = summarize(&mesh);
        assert_int_equal(summary.boundary_loops, holes);
        assert_int_equal(summary.boundary_edges, 3 * holes);
        assert_int_equal(summary.euler, -(int64_t)holes);
    }
    bat_mesh_free(&mesh);
}

/// Non-manifold edges and vertices are counted, not refused.
static void test_no_manifolds(void **state)
{
    (void)state;
    double positions[3 * 9] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 2, 1, 1, 1, 2, 1, 7, 7, 7, 8, 8, 8};
    // Three faces at the edge 0 1, the last two of them in the same direction; vertices 7 and 8 without a face.
    uint32_t book[9] = {0, 1, 2, 1, 0, 3, 1, 0, 4};
    bat_mesh mesh = {.positions = positions, .faces = book, .vertex_count = 9, .face_count = 3};
    bat_mesh_summary summary = summarize(&mesh);
    assert_int_equal(summary.nonmanifold_edges, 1);
    assert_int_equal(summary.edges, 7);
    assert_int_equal(summary.isolated_vertices, 4);
    assert_int_equal(summary.pinched_vertices, 0);
    assert_false(summary.manifold || summary.oriented || summary.closed);
    check_near(summary.high[0], 1, 0);
    // Two triangles that share a vertex: one component, two loops.
    uint32_t hourglass[6] = {0, 1, 2, 0, 3, 4};
    mesh.faces = hourglass;
    mesh.face_count = 2;
    summary = summarize(&mesh);
    assert_int_equal(summary.pinched_vertices, 1);
    assert_int_equal(summary.components, 1);
    assert_int_equal(summary.boundary_loops, 2);
    assert_int_equal(summary.max_valence, 4);
    assert_false(summary.manifold);
    // Separate triangles: two components.
    uint32_t apart[6] = {0, 1, 2, 3, 5, 6};
    mesh.faces = apart;
    summary = summarize(&mesh);
    assert_int_equal(summary.components, 2);
    assert_int_equal(summary.boundary_loops, 2);
    assert_int_equal(summary.isolated_vertices, 3);
    assert_int_equal(summary.euler, 2);
}

/// A Möbius strip has one boundary loop and no orientation.
static void test_moebius(void **state)
{
    (void)state;
    enum
    {
        COUNT = 10
    };
    double positions[6 * COUNT];
    uint32_t faces[6 * COUNT];
    for (uint32_t i = 0; i < COUNT; i++)
    {
        uint32_t a = 2 * i, b = 2 * i + 1, c = i + 1 < COUNT ? a + 2 : 1, d = i + 1 < COUNT ? a + 3 : 0;
        const uint32_t corners[6] = {a, b, c, b, d, c};
        memcpy(faces + (size_t)6 * i, corners, sizeof corners);
        for (int side = 0; side < 2; side++)
        {
            double turn = 2 * PI * i / COUNT, width = (side == 0 ? 0.3 : -0.3);
            double *at = positions + 6 * i + 3 * side;
            at[0] = (1 + width * cos(turn / 2)) * cos(turn);
            at[1] = (1 + width * cos(turn / 2)) * sin(turn);
            at[2] = width * sin(turn / 2);
        }
    }
    bat_mesh mesh = {.positions = positions, .faces = faces, .vertex_count = 2 * COUNT, .face_count = 2 * COUNT};
    bat_mesh_summary summary = summarize(&mesh);
    assert_int_equal(summary.boundary_loops, 1);
    assert_int_equal(summary.euler, 0);
    assert_true(summary.manifold);
    assert_false(summary.oriented);
    assert_int_equal(summary.reversed_edges, 1);
}

static void test_degenerate_faces(void **state)
{
    (void)state;
    double positions[] = {0, 0, 0, 1, 0, 0, 0.5, 0, 0, 1, 1e-7, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0};
    uint32_t faces[] = {0, 1, 2, 0, 1, 3, 4, 5, 6};
    bat_mesh mesh = {.positions = positions, .faces = faces, .vertex_count = 7, .face_count = 3};
    bat_mesh_summary summary = summarize(&mesh);
    assert_int_equal(summary.degenerate_faces, 2);
    check_near(summary.min_quality, 0, 0);
    assert_int_equal(summary.min_quality_face, 0);
    check_near(summary.min_angle, 0, 0);
    check_near(summary.max_angle, PI, 0);
    check_relative(summary.area, 5e-8, 1e-12);
    check_near(summary.min_edge, 0, 0);
}

/// Lengths, areas and volumes scale correctly where their squares overflow or underflow.
static void test_magnitudes(void **state)
{
    (void)state;
    bat_mesh mesh = quilt(9, 8, true, true);
    bat_mesh_summary plain = summarize(&mesh);
    for (size_t i = 0; i < 3 * mesh.vertex_count; i++)
        mesh.positions[i] = ldexp(mesh.positions[i], 400);
    bat_mesh_summary large = summarize(&mesh);
    assert_true(large.area == ldexp(plain.area, 800));
    assert_true(isinf(large.volume));
    assert_true(large.mean_edge == ldexp(plain.mean_edge, 400));
    assert_true(large.min_quality == plain.min_quality && large.min_angle == plain.min_angle);
    bat_mesh_free(&mesh);
}

/// Every byte of the two structs belongs to one row, but for padding after a flag.
static void test_tables(void **state)
{
    (void)state;
    static const size_t SIZES[] = {sizeof(double),  sizeof(double),  sizeof(double[3]), sizeof(size_t),
                                   sizeof(int64_t), sizeof(int64_t), sizeof(bool)};
    const size_t structs[] = {sizeof(bat_mesh_summary), sizeof(bat_mesh_distance)};
    for (size_t meshes = 1; meshes <= 2; meshes++)
    {
        unsigned char taken[sizeof(bat_mesh_summary)] = {0};
        size_t bytes = 0;
        bat_measure row;
        for (size_t i = 0; bat_mesh_measures(meshes, i, &row); i++)
        {
            assert_true(row.name[0] != '\0' && row.title[0] != '\0');
            for (size_t k = 0; k < SIZES[row.form]; k++, bytes++)
                assert_int_equal(taken[row.offset + k]++, 0);
        }
        assert_in_range(bytes, structs[meshes - 1] - sizeof(double) + 1, structs[meshes - 1]);
    }
    bat_measure none;
    assert_false(bat_mesh_measures(0, 0, &none) || bat_mesh_measures(3, 0, &none));
}

static void test_refusals(void **state)
{
    (void)state;
    bat_mesh none = {0};
    bat_mesh_summary summary = {.edges = 17};
    check_status(bat_mesh_summarize(&none, &summary, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(summary.edges, 17);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cube),
        cmocka_unit_test(test_quilts),
        cmocka_unit_test(test_torus_converges),
        cmocka_unit_test(test_holes),
        cmocka_unit_test(test_no_manifolds),
        cmocka_unit_test(test_moebius),
        cmocka_unit_test(test_degenerate_faces),
        cmocka_unit_test(test_magnitudes),
        cmocka_unit_test(test_tables),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
