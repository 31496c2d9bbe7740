// Spline surfaces as triangles in OBJ and as cells in VTK: no cracks, on the surface, counted right.

#include "surface_helpers.h"

#include "batten/mesh.h"
#include "batten/mesh_file.h"
#include "linalg/vector.h"

static const surface_kind kinds[] = {
    {{2, 2}, {1, 1}, true, 0, 3, 6},
    {{3, 1}, {2, 3}, true, 0, 3, 7},
    {{2, 3}, {3, 2}, true, 2, 3, 5},
    {{2, 2}, {3, 3}, true, 0, 3, 0},
};
enum
{
    KINDS = sizeof kinds / sizeof *kinds
};

static bat_mesh read_mesh(const char *text)
{
    bat_mesh_read_options options = bat_mesh_read_defaults();
    options.format = BAT_MESH_FORMAT_OBJ;
    bat_mesh mesh = {0};
    bat_error error = {0};
    if (bat_mesh_read_memory(text, strlen(text), &options, &mesh, &error) != BAT_OK)
        fail_msg("line %zu: %s", error.line, error.text);
    return mesh;
}

/// A manifold of the disk's kind: one boundary loop, Euler characteristic 1.
static void assert_disk(const bat_mesh *mesh)
{
    bat_mesh_connectivity connectivity;
    bat_error error = {0};
    if (bat_mesh_connect(mesh, &connectivity, &error) != BAT_OK)
        fail_msg("%s", error.text);
    assert_int_equal(mesh->vertex_count + mesh->face_count - connectivity.edge_count, 1);
    uint32_t start = 0;
    while (connectivity.twin[start] != BAT_MESH_NONE)
        start++;
    size_t length = 0;
    uint32_t half_edge = start;
    do
    {
        // The boundary goes on with the half-edge that begins at the end of this one.
        half_edge = connectivity.first[mesh->faces[bat_mesh_next(half_edge)]];
        assert_int_equal(connectivity.twin[half_edge], BAT_MESH_NONE);
        length++;
    } while (half_edge != start && length <= connectivity.boundary_edge_count);
    assert_int_equal(length, connectivity.boundary_edge_count);
    bat_mesh_connectivity_free(&connectivity);
}

/// In the square of parameters the triangles are all turned the right way and cover an area of one.
static void assert_cover(const bat_mesh *mesh)
{
    double area = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *face = mesh->texture_faces + 3 * f;
        const double *a = mesh->texture + 2 * (size_t)face[0], *b = mesh->texture + 2 * (size_t)face[1],
                     *c = mesh->texture + 2 * (size_t)face[2];
        double twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        assert_true(twice > 0);
        area += twice / 2;
    }
    check_near(area, 1, 1e-13);
}

static void test_obj(void **state)
{
    (void)state;
    for (size_t k = 0; k < KINDS; k++)
        for (size_t samples = 0; samples < 5; samples++)
            for (uint64_t seed = 0; seed < 4; seed++)
            {
                bat_spline_surface surface = random_sheet(&kinds[k], seed);
                const bat_surface_write_options options = {.samples = samples};
                char *text = must_write(&surface, BAT_SURFACE_FORMAT_OBJ, &options);
                bat_mesh mesh = read_mesh(text);
                assert_disk(&mesh);
                assert_cover(&mesh);
                assert_int_equal(mesh.texture_count, mesh.vertex_count);
                double *positions = malloc(3 * mesh.vertex_count * sizeof *positions);
                check_status(bat_spline_surface_evaluate(&surface, mesh.texture, mesh.vertex_count, 0, positions, NULL),
                             BAT_OK);
                assert_memory_equal(positions, mesh.positions, 3 * mesh.vertex_count * sizeof *positions);
                free(positions);
                free(text);
                bat_mesh_free(&mesh);
                bat_spline_surface_free(&surface);
            }
}

/// Normals have length 1 and are normal to both tangents.
static void test_normals(void **state)
{
    (void)state;
    bat_spline_surface surface = random_sheet(&kinds[1], 5);
    char *text = must_write(&surface, BAT_SURFACE_FORMAT_OBJ, NULL);
    const char *normal = strstr(text, "vn "), *parameter = strstr(text, "vt ");
    size_t count = 0;
    for (; strncmp(normal, "vn ", 3) == 0; normal = strchr(normal, '\n') + 1, parameter = strchr(parameter, '\n') + 1)
    {
        double n[3], at[2], values[9];
        assert_int_equal(sscanf(normal, "vn %lf %lf %lf", &n[0], &n[1], &n[2]), 3);
        assert_int_equal(sscanf(parameter, "vt %lf %lf", &at[0], &at[1]), 2);
        check_status(bat_spline_surface_evaluate(&surface, at, 1, 1, values, NULL), BAT_OK);
        check_near(vector3_dot(n, n), 1, 1e-14);
        check_near(vector3_dot(n, values + 3), 0, 1e-13);
        check_near(vector3_dot(n, values + 6), 0, 1e-13);
        assert_true(n[2] > 0);
        count++;
    }
    assert_true(count > 20);
    free(text);
    bat_spline_surface_free(&surface);
}

/// A cone of one bilinear piece: at its tip the tangents say nothing, the triangles do.
static void test_tip(void **state)
{
    (void)state;
    bat_spline_surface surface = random_sheet(&(surface_kind){{1, 1}, {1, 1}, true, 0, 3, 0}, 5);
    static const double control[] = {0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0};
    memcpy(surface.control, control, sizeof control);
    char *text = must_write(&surface, BAT_SURFACE_FORMAT_OBJ, NULL);
    const char *normal = strstr(text, "vn ");
    for (; strncmp(normal, "vn ", 3) == 0; normal = strchr(normal, '\n') + 1)
    {
        double n[3];
        assert_int_equal(sscanf(normal, "vn %lf %lf %lf", &n[0], &n[1], &n[2]), 3);
        check_near(n[0], 0, 1e-15);
        check_near(n[1], 0, 1e-15);
        check_near(n[2], -1, 1e-15);
    }
    free(text);
    bat_spline_surface_free(&surface);
}

/// Go behind a heading, whose numbers are two, or one.
static const char *after_heading(const char *text, const char *format, size_t *a, size_t *b)
{
    const char *keyword_end = strchr(format, ' ');
    char keyword[32] = "\n";
    memcpy(keyword + 1, format, (size_t)(keyword_end - format) + 1);
    const char *at = strstr(text, keyword);
    assert_non_null(at);
    assert_true(sscanf(at + 1, format, a, b) >= 1);
    return strchr(at + 1, '\n') + 1;
}

static size_t rows_before(const char *text, const char *heading)
{
    const char *end = strstr(text, heading);
    size_t rows = 0;
    for (; end == NULL ? *text != '\0' : text < end; text++)
        rows += *text == '\n';
    return rows;
}

static void test_vtk(void **state)
{
    (void)state;
    enum
    {
        POINTS = 7
    };
    bat_spline_surface surface = random_sheet(&kinds[0], 2);
    double points[3 * POINTS], errors[POINTS];
    for (int i = 0; i < 3 * POINTS; i++)
        points[i] = i / 8.;
    for (int i = 0; i < POINTS; i++)
        errors[i] = i / 16.;
    const bat_surface_write_options options = {.samples = 2, .points = points, .errors = errors, .point_count = POINTS};
    char *text = must_write(&surface, BAT_SURFACE_FORMAT_VTK, &options);
    size_t cells = bat_hierarchical_space_cells(surface.space), all, numbers, quads;
    const char *at = after_heading(text, "POINTS %zu double", &all, &numbers);
    assert_int_equal(rows_before(at, "VERTICES"), all);
    at = after_heading(at, "VERTICES %zu %zu", &quads, &numbers);
    assert_int_equal(quads, POINTS);
    assert_int_equal(rows_before(at, "POLYGONS"), POINTS);
    at = after_heading(at, "POLYGONS %zu %zu", &quads, &numbers);
    assert_int_equal(quads, 4 * cells);
    assert_int_equal(numbers, 20 * cells);
    assert_int_equal(rows_before(at, "CELL_DATA"), quads);
    at = after_heading(at, "CELL_DATA %zu", &numbers, &numbers);
    assert_int_equal(numbers, quads + POINTS);
    at = strstr(at, "default\n") + strlen("default\n");
    for (size_t i = 0; i < quads + POINTS; i++, at = strchr(at, '\n') + 1)
    {
        long expected = i < POINTS ? -1 : (long)bat_hierarchical_space_cell(surface.space, (i - POINTS) / 4).level;
        assert_int_equal(strtol(at, NULL, 10), expected);
    }
    assert_int_equal(sscanf(at, "POINT_DATA %zu", &numbers), 1);
    assert_int_equal(numbers, all);
    at = strstr(at, "default\n") + strlen("default\n");
    assert_int_equal(rows_before(at, "none"), all);
    for (size_t i = 0; i < all; i++, at = strchr(at, '\n') + 1)
        check_near(strtod(at, NULL), i < all - POINTS ? 0 : errors[i - (all - POINTS)], 0);
    free(text);
    text = must_write(&surface, BAT_SURFACE_FORMAT_VTK, NULL);
    assert_null(strstr(text, "VERTICES"));
    assert_null(strstr(text, "POINT_DATA"));
    free(text);
    bat_spline_surface_free(&surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_obj),
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_tip),
        cmocka_unit_test(test_vtk),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
