// Labels of faces through refinement, decimation and repair; limit normals; the limit of memory.
#include "check.h"
#include "decimate_helpers.h"
#include "error_helpers.h"
#include "mesh_makers.h"

#include "batten/mesh_decimate.h"
#include "batten/mesh_refine.h"

/// A torus of two materials: faces in the half x < 0, and the others.
static bat_mesh labelled_torus(void)
{
    bat_mesh mesh = mesh_torus(24, 12);
    mesh.labels = calloc(2, sizeof *mesh.labels);
    mesh.labels[0].material = strdup("red");
    mesh.labels[1].material = strdup("blue");
    mesh.label_count = 2;
    mesh.material_files = strdup("a.mtl");
    mesh.face_labels = malloc(mesh.face_count * sizeof *mesh.face_labels);
    for (size_t f = 0; f < mesh.face_count; f++)
    {
        const uint32_t *corner = mesh.faces + 3 * f;
        double x = 0;
        for (int c = 0; c < 3; c++)
            x += mesh.positions[3 * (size_t)corner[c]];
        mesh.face_labels[f] = x < 0;
    }
    return mesh;
}

static double middle_x(const bat_mesh *mesh, size_t face)
{
    double x = 0;
    for (size_t c = 0; c < 3; c++)
        x += mesh->positions[3 * (size_t)mesh->faces[3 * face + c]] / 3;
    return x;
}

/// Away from the border of the materials, a face's label follows from its place.
static void check_labels(const bat_mesh *mesh, double margin)
{
    assert_int_equal(mesh->label_count, 2);
    assert_string_equal(mesh->labels[1].material, "blue");
    assert_string_equal(mesh->material_files, "a.mtl");
    for (size_t f = 0; f < mesh->face_count; f++)
        if (fabs(middle_x(mesh, f)) > margin)
            assert_int_equal(mesh->face_labels[f], middle_x(mesh, f) < 0);
}

static void test_refinement_keeps_labels(void **state)
{
    (void)state;
    static const bat_mesh_scheme schemes[] = {BAT_MESH_SCHEME_MIDPOINT, BAT_MESH_SCHEME_LOOP, BAT_MESH_SCHEME_BUTTERFLY,
                                              BAT_MESH_SCHEME_SQRT3};
    bat_mesh mesh = labelled_torus(), fine;
    for (size_t i = 0; i < 4; i++)
        for (size_t levels = 0; levels < 4; levels++)
        {
            bat_mesh_refine_options options = bat_mesh_refine_defaults();
            options.scheme = schemes[i];
            options.levels = levels;
            assert_int_equal(bat_mesh_refine(&mesh, &options, &fine, NULL, NULL), BAT_OK);
            check_labels(&fine, 0.5);
            bat_mesh_free(&fine);
        }
    bat_mesh_free(&mesh);
}

static void test_decimation_and_repair_keep_labels(void **state)
{
    (void)state;
    bat_mesh mesh = labelled_torus(), made;
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    options.vertices = 100;
    assert_int_equal(bat_mesh_decimate(&mesh, &options, &made, NULL, NULL), BAT_OK);
    check_labels(&made, 1);
    bat_mesh_free(&made);
    assert_int_equal(bat_mesh_repair(&mesh, NULL, &made, NULL), BAT_OK);
    check_labels(&made, 0.5);
    bat_mesh_free(&made);
    mesh.face_labels[3] = 2;
    assert_int_equal(bat_mesh_check(&mesh, NULL), BAT_INVALID_POINT);
    bat_mesh_free(&mesh);
}

/// A disc that is another object, group or material keeps its area when a flat sheet is decimated.
static void test_decimation_keeps_borders(void **state)
{
    (void)state;
    static const struct
    {
        const char *object, *group, *material, *smoothing;
        bool border;
    } kinds[] = {{.object = "a", .border = true},
                 {.group = "a", .border = true},
                 {.material = "a", .border = true},
                 {.smoothing = "a", .border = false}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
    {
        bat_mesh sheet = shape_sheet(40, 0, false), coarse;
        sheet.labels = calloc(3, sizeof *sheet.labels);
        sheet.label_count = 3;
        sheet.labels[1] = (bat_mesh_label){.object = kinds[k].object != NULL ? strdup("a") : NULL,
                                           .group = kinds[k].group != NULL ? strdup("a") : NULL,
                                           .material = kinds[k].material != NULL ? strdup("a") : NULL,
                                           .smoothing = kinds[k].smoothing != NULL ? strdup("a") : NULL};
        sheet.face_labels = calloc(sheet.face_count, sizeof *sheet.face_labels);
        double inside = 0, middle[3];
        for (size_t f = 0; f < sheet.face_count; f++)
        {
            for (size_t c = 0; c < 3; c++)
                middle[c] =
                    (shape_corner(&sheet, f, 0)[c] + shape_corner(&sheet, f, 1)[c] + shape_corner(&sheet, f, 2)[c]) / 3;
            if (hypot(middle[0] - 0.5, middle[1] - 0.5) < 0.3)
                sheet.face_labels[f] = 1;
            else
                sheet.face_labels[f] = middle[0] < 0.5 ? 0 : 2; // labels 0 and 2 have equal names: no border
        }
        for (int coarsened = 0; coarsened < 2; coarsened++)
        {
            const bat_mesh *mesh = &sheet;
            bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
            options.vertices = 60;
            if (coarsened)
            {
                assert_int_equal(bat_mesh_decimate(&sheet, &options, &coarse, NULL, NULL), BAT_OK);
                mesh = &coarse;
            }
            double area = 0, vector[3];
            for (size_t f = 0; f < mesh->face_count; f++)
                if (mesh->face_labels[f] == 1)
                {
                    shape_vector(mesh, f, vector);
                    area += sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]) / 2;
                }
            if (!coarsened)
                inside = area;
            else if (kinds[k].border)
                check_near(area, inside, 0.002 * inside);
            else
                assert_true(fabs(area - inside) > 0.01 * inside);
        }
        bat_mesh_free(&coarse);
        bat_mesh_free(&sheet);
    }
}

static void test_limit_normals(void **state)
{
    (void)state;
    bat_mesh mesh = labelled_torus(), fine, limit;
    double *normals = NULL;
    bat_error error;
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_LOOP;
    options.levels = 1;
    assert_int_equal(bat_mesh_refine(&mesh, &options, &fine, NULL, &error), BAT_OK);
    double *expected = malloc(3 * fine.vertex_count * sizeof *expected);
    assert_int_equal(bat_mesh_limit_normals(&fine, 1, expected, &error), BAT_OK);
    options.limit_normals = &normals;
    assert_int_equal(bat_mesh_refine(&mesh, &options, &limit, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_null(normals);
    options.limit = true;
    assert_int_equal(bat_mesh_refine(&mesh, &options, &limit, NULL, &error), BAT_OK);
    assert_memory_equal(normals, expected, 3 * fine.vertex_count * sizeof *expected);
    free(expected);
    free(normals);
    bat_mesh_free(&limit);
    bat_mesh_free(&fine);
    bat_mesh_free(&mesh);
}

static void test_memory_is_limited(void **state)
{
    (void)state;
    bat_mesh mesh = mesh_octahedron(), fine = {.vertex_count = 17};
    bat_error error;
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_LOOP;
    options.levels = 9;
    options.max_memory = 1000000;
    assert_int_equal(bat_mesh_refine(&mesh, &options, &fine, NULL, &error), BAT_TOO_LARGE);
    assert_non_null(strstr(error_words(&error), " allowed; levels 5 fits"));
    assert_int_equal(fine.vertex_count, 17);
    options.levels = 5;
    assert_int_equal(bat_mesh_refine(&mesh, &options, &fine, NULL, &error), BAT_OK);
    bat_mesh_free(&fine);
    bat_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refinement_keeps_labels),  cmocka_unit_test(test_decimation_and_repair_keep_labels),
        cmocka_unit_test(test_decimation_keeps_borders), cmocka_unit_test(test_limit_normals),
        cmocka_unit_test(test_memory_is_limited),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
