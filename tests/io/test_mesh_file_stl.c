// STL: triangles joined at equal coordinates, in text and binary form.
#include "mesh_file_helpers.h"

#include "batten/mesh.h"

static const bat_mesh_format STL = BAT_MESH_FORMAT_STL;

#define FACET(a, b, c) "facet normal 0 0 nan\nouter loop\nvertex " a "\nvertex " b "\nvertex " c "\nendloop\nendfacet\n"
#define TWO FACET("0 0 0", "1 0 0", "0 1 0") FACET("0 1 -0", "1 0 0", "1 1 1e-3")

static void check_two(const bat_mesh *mesh)
{
    const uint32_t faces[] = {0, 1, 2, 2, 1, 3};
    assert_int_equal(mesh->vertex_count, 4);
    assert_int_equal(mesh->face_count, 2);
    assert_memory_equal(mesh->faces, faces, sizeof faces);
    assert_true(mesh->positions[11] == 1e-3);
}

static void test_text(void **state)
{
    (void)state;
    static const char *const texts[] = {"solid\n" TWO "endsolid\n", "SOLID two words # 1\r\n" TWO "EndSolid two words",
                                        "\n solid a\n" TWO "endsolid a\n\n",
                                        "solid a\n" FACET("0 0 0", "1 0 0", "0 1 0") "endsolid a\nsolid b\n" FACET(
                                            "0 1 0", "1 0 0", "1 1 .001") "endsolid b\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    {
        bat_mesh mesh = must_read(texts[i], i % 2 == 0 ? STL : BAT_MESH_FORMAT_AUTO);
        check_two(&mesh);
        bat_mesh_free(&mesh);
    }
}

static void test_bad_text(void **state)
{
    (void)state;
    assert_bad("solid\nendsolid\n", STL, 0, "there are no faces");
    assert_bad("solid\n", STL, 2, "the file ends where 'endsolid' is expected");
    assert_bad("solid\nfacet\n", STL, 3, "the file ends where 'outer' is expected");
    assert_bad("solid\nface normal\n", STL, 2, "'face' was found where 'endsolid'");
    assert_bad("solid\nfacet\nloop\n", STL, 3, "'loop' was found where 'outer loop'");
    assert_bad("solid\nfacet\nouter\n", STL, 3, "'' was found where 'outer loop'");
    assert_bad("solid\nfacet\nouter loop\nvertex 1 2\n", STL, 4, "a vertex has 3 coordinates");
    assert_bad("solid\nfacet\nouter loop\nvertex 1 2 3 4\n", STL, 4, "a vertex has 3 coordinates");
    assert_bad("solid\nfacet\nouter loop\nvertex 1 2 x\n", STL, 4, "'x' is not a number");
    assert_bad("solid\nfacet\nouter loop\nvertex 1 2 nan\n", STL, 4, "a corner of triangle 0 is not finite");
    assert_bad("solid\nfacet\nouter loop\nvertex 1 2 3\nvertex 1 2 3\nendloop\n", STL, 6,
               "'endloop' was found where 'vertex'");
    assert_bad("solid\nfacet\nouter loop\nvertex 1 2 3\nvertex 1 2 3\nvertex 1 2 3\nvertex 1 2 3\n", STL, 7,
               "'vertex' was found where 'endloop'");
    assert_bad("solid\n" TWO "endsolid\nfacet\n", STL, 17, "'facet' was found where 'solid'");
    assert_bad("solid\n" TWO FACET("0 0 0", "0 0 0", "1 1 1") "endsolid\n", STL, 16, "face 2 has vertex 0");
    static const char whole[] = "solid\n" TWO "endsolid\n";
    assert_truncations_fail(whole, sizeof whole - 1, 1, STL);
}

/// A repair drops triangles with a corner that is not finite from text, too.
static void test_repaired_text(void **state)
{
    (void)state;
    static const char text[] = "solid\n" TWO FACET("0 0 0", "1 0 nan", "1 1 1") "endsolid\n";
    bat_mesh_read_options options = bat_mesh_read_defaults();
    bat_mesh mesh;
    options.format = STL;
    options.repair = true;
    assert_int_equal(bat_mesh_read_memory(text, sizeof text - 1, &options, &mesh, NULL), BAT_OK);
    assert_int_equal(mesh.face_count, 2);
    bat_mesh_free(&mesh);
}

/// Binary STL of a mesh, made by hand.
static char *binary_of(const float *coordinates, uint32_t triangles, const char *header, size_t *size)
{
    *size = 84 + 50 * (size_t)triangles;
    char *bytes = calloc(*size, 1);
    memcpy(bytes, header, strlen(header));
    for (int i = 0; i < 4; i++)
        bytes[80 + i] = (char)(triangles >> 8 * i);
    for (size_t t = 0; t < triangles; t++)
    {
        memset(bytes + 84 + 50 * t, 0xff, 12); // a normal that is not a number
        little_endian(bytes + 84 + 50 * t + 12, coordinates + 9 * t, 9);
        memset(bytes + 84 + 50 * t + 48, 0xab, 2);
    }
    return bytes;
}

static void test_bytes(void **state)
{
    (void)state;
    const float coordinates[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, -0.0f, 1, 0, 0, 1, 1, .5f};
    static const char *const headers[] = {"", "solid but not text", "ply"};
    bat_mesh_read_options options = reading_as(STL);
    for (size_t i = 0; i < 3; i++)
    {
        size_t size;
        char *bytes = binary_of(coordinates, 2, headers[i], &size);
        options.format = i == 1 ? BAT_MESH_FORMAT_AUTO : STL;
        bat_mesh mesh = must_read_bytes(bytes, size, &options);
        mesh.positions[11] = 1e-3;
        check_two(&mesh);
        bat_mesh_free(&mesh);
        free(bytes);
    }
    size_t size;
    char *bytes = binary_of(coordinates, 2, "", &size);
    assert_truncations_fail(bytes, size, 0, STL);
    options.format = STL;
    assert_refused(bytes, 80, &options, BAT_BAD_FILE, 0, "neither begins with 'solid' nor");
    assert_refused(bytes, size - 1, &options, BAT_BAD_FILE, 0,
                   "gives 2 triangles, but the file holds 99 bytes, enough for 1");
    bytes[83] = '\x7f';
    assert_refused(bytes, size, &options, BAT_BAD_FILE, 0, "the header gives 2130706434 triangles");
    bytes[83] = 0;
    memset(bytes + 84 + 50 + 12 + 8, 0xff, 4);
    assert_refused(bytes, size, &options, BAT_BAD_FILE, 0, "a corner of triangle 1 is not finite");
    memcpy(bytes + 84 + 50 + 12, bytes + 84 + 50 + 24, 12);
    assert_refused(bytes, size, &options, BAT_BAD_FILE, 0, "face 1 has vertex 1, counted from 0, twice");
    free(bytes);
    bytes = binary_of(coordinates, 0, "", &size);
    assert_refused(bytes, size, &options, BAT_BAD_FILE, 0, "there are no faces");
    free(bytes);
}

/// The same triangles, corner by corner.
static void check_same_corners(const bat_mesh *a, const bat_mesh *b, bool single)
{
    assert_int_equal(a->face_count, b->face_count);
    for (size_t i = 0; i < 3 * a->face_count; i++)
        for (size_t k = 0; k < 3; k++)
        {
            double x = a->positions[3 * (size_t)a->faces[i] + k], y = b->positions[3 * (size_t)b->faces[i] + k];
            assert_true(y == (single ? (double)(float)x : x));
        }
}

static void test_round_trip(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 12; seed++)
    {
        bat_mesh mesh = random_mesh(seed, seed == 12 ? 30000 : 10 + seed, seed == 12 ? 60000 : 40, NULL);
        bat_mesh text = through_file(&mesh, STL, BAT_MESH_ENCODING_TEXT),
                 binary = through_file(&mesh, STL, BAT_MESH_ENCODING_BINARY);
        assert_int_equal(text.vertex_count, mesh.vertex_count);
        assert_int_equal(binary.vertex_count, mesh.vertex_count);
        check_same_corners(&mesh, &text, false);
        check_same_corners(&mesh, &binary, true);
        // A second write gives the same bytes: only the first one rounds.
        size_t sizes[2];
        char *once = must_write(&mesh, STL, BAT_MESH_ENCODING_BINARY, &sizes[0]);
        char *twice = must_write(&binary, STL, BAT_MESH_ENCODING_BINARY, &sizes[1]);
        assert_int_equal(sizes[0], sizes[1]);
        for (size_t f = 0; f < mesh.face_count; f++)
            assert_memory_equal(once + 84 + 50 * f + 12, twice + 84 + 50 * f + 12, 38);
        free(once);
        free(twice);
        bat_mesh_free(&mesh);
        bat_mesh_free(&text);
        bat_mesh_free(&binary);
    }
}

static void test_normals(void **state)
{
    (void)state;
    bat_mesh mesh = must_read("v 0 0 0\nv 1e300 0 0\nv 0 -1e300 0\nv 1e-300 0 0\nf 1 2 3\nf 1 2 4\n", BAT_MESH_FORMAT_OBJ);
    assert_text(&mesh, STL,
                "solid mesh\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 1e+300 0 0\nvertex 0 -1e+300 "
                "0\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1e+300 0 0\nvertex 1e-300 0 "
                "0\nendloop\nendfacet\nendsolid mesh\n");
    assert_unwritable(&mesh, STL, BAT_MESH_ENCODING_BINARY, BAT_UNSUPPORTED,
                      "cannot hold the coordinate 1e+300 of vertex 1");
    bat_mesh_free(&mesh);
}

/// Vertices that differ by rounding are joined, others and those of faces that would lose a corner are not.
static void test_weld(void **state)
{
    (void)state;
    static const char near[] =
        "solid\n" FACET("0 0 0", "1 0 0", "0 1 0") FACET("0 1 -3e-16", "1 0 1e-8", "1 1 1") "endsolid\n",
                      thin[] =
                          "solid\n" FACET("0 0 0", "1 0 0", "1 1e-9 0") FACET("1 1e-9 0", "1 0 0", "2 0 1") "endsolid\n",
                      soup[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 1 0\nv 1 0 0\nv 1 1 1\nf 1 2 3\nf 4 5 6\n";
    static const struct
    {
        const char *text;
        bat_mesh_format format;
        double weld;
        size_t vertices, notes;
    } cases[] = {{near, BAT_MESH_FORMAT_STL, -1, 4, 1},    {near, BAT_MESH_FORMAT_STL, 0, 6, 0},
                 {near, BAT_MESH_FORMAT_STL, 1e-12, 5, 1}, {thin, BAT_MESH_FORMAT_STL, -1, 4, 0},
                 {soup, BAT_MESH_FORMAT_OBJ, -1, 4, 1},    {soup, BAT_MESH_FORMAT_OBJ, 0, 6, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_mesh_notes notes = {0};
        bat_mesh_read_options options = reading_as(cases[i].format);
        options.weld = cases[i].weld;
        options.notes = &notes;
        bat_mesh mesh = must_read_bytes(cases[i].text, strlen(cases[i].text), &options);
        assert_int_equal(mesh.vertex_count, cases[i].vertices);
        assert_int_equal(notes.count, cases[i].notes);
        bat_mesh_free(&mesh);
        bat_mesh_notes_free(&notes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_weld),     cmocka_unit_test(test_text),
                                       cmocka_unit_test(test_bad_text), cmocka_unit_test(test_repaired_text),
                                       cmocka_unit_test(test_bytes),    cmocka_unit_test(test_round_trip),
                                       cmocka_unit_test(test_normals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
