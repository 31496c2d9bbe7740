// Polygon meshes: checks, Catmull and Clark's scheme, boundary rules, adaptive refinement.
#include "check.h"
#include "error_helpers.h"
#include "mesh_helpers.h"
#include "polygon_makers.h"

#include "batten/mesh_measure.h"
#include "batten/mesh_refine.h"

static bat_mesh_refine_options catmull_clark(size_t levels)
{
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_CATMULL_CLARK;
    options.levels = levels;
    return options;
}

static bat_mesh refine(const bat_mesh *coarse, const bat_mesh_refine_options *options)
{
    bat_mesh fine;
    bat_error error = {0};
    bat_status status = bat_mesh_refine(coarse, options, &fine, NULL, &error);
    if (status != BAT_OK)
        print_error("%s\n", error.text);
    check_status(status, BAT_OK);
    return fine;
}

static bat_mesh mixed(void)
{
    bat_mesh triangles = mesh_irregular(8, 6, 3);
    bat_mesh mesh = polygon_mixed(&triangles, 0.8, 5);
    bat_mesh_free(&triangles);
    return mesh;
}

/// A grid with quads and triangles and a boundary.
static bat_mesh mixed_grid(double shake)
{
    bat_mesh triangles = mesh_grid(6, 5);
    mesh_shake(&triangles, shake, 4);
    bat_mesh mesh = polygon_mixed(&triangles, 0.7, 2);
    bat_mesh_free(&triangles);
    return mesh;
}

static void test_bad_meshes(void **state)
{
    (void)state;
    bat_mesh cube = polygon_cube(), empty = {0}, copy;
    bat_error error;
    check_status(bat_mesh_check(&empty, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_mesh_check(&cube, &error), BAT_OK);
    check_status(bat_mesh_copy(&cube, &copy, &error), BAT_OK);
    copy.faces[2] = copy.faces[0];
    check_status(bat_mesh_check(&copy, &error), BAT_INVALID_POINT);
    assert_string_equal(error.text, "face 0 has vertex 0 twice");
    copy.faces[2] = 8;
    check_status(bat_mesh_check(&copy, &error), BAT_INVALID_POINT);
    copy.faces[2] = cube.faces[2];
    copy.offsets[1] = 2;
    check_status(bat_mesh_check(&copy, &error), BAT_INVALID_POINT);
    assert_string_equal(error.text, "face 0 has 2 corners, fewer than 3");
    copy.offsets[1] = 9;
    check_status(bat_mesh_check(&copy, &error), BAT_INVALID_ARGUMENT);
    bat_mesh_free(&copy);
    bat_mesh_free(&cube);
    bat_mesh_free(&empty);
}

static void test_triangulated(void **state)
{
    (void)state;
    bat_mesh cube = polygon_cube(), triangles, back;
    bat_mesh_summary summary;
    bat_error error;
    check_status(bat_mesh_summarize(&cube, &summary, &error), BAT_UNSUPPORTED);
    check_status(bat_mesh_repair(&cube, NULL, &back, &error), BAT_UNSUPPORTED);
    check_status(bat_mesh_triangulate(&cube, &triangles, NULL), BAT_OK);
    assert_int_equal(triangles.face_count, 12);
    check_status(bat_mesh_summarize(&triangles, &summary, NULL), BAT_OK);
    check_near(summary.volume, 8, 1e-12);
    check_status(bat_mesh_triangulate(&triangles, &back, NULL), BAT_OK);
    assert_null(back.offsets);
    assert_memory_equal(back.faces, triangles.faces, 36 * sizeof *back.faces);
    bat_mesh_free(&triangles);
    bat_mesh_free(&back);
    bat_mesh_free(&cube);
}

/// The first level of a cube by hand: means of faces, of edges, and vertices at 5/9.
static void test_cube(void **state)
{
    (void)state;
    bat_mesh cube = polygon_cube();
    bat_mesh_refine_options options = catmull_clark(1);
    bat_mesh fine = refine(&cube, &options);
    assert_int_equal(fine.vertex_count, 26);
    assert_int_equal(fine.face_count, 24);
    for (size_t i = 0; i < 3; i++)
        check_near(fine.positions[i], -5.0 / 9, 1e-15);
    for (size_t v = 8; v < 26; v++)
    {
        const double *p = fine.positions + 3 * v;
        double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        check_near(length, v < 20 ? 0.75 * sqrt(2) : 1, 1e-15);
    }
    bat_mesh_free(&fine);
    bat_mesh_free(&cube);
}

/// Two calls of one level give the faces of one call of two levels, and planes stay planes.
static void test_levels_and_planes(void **state)
{
    (void)state;
    bat_mesh grid = mixed_grid(0);
    bat_mesh_refine_options one = catmull_clark(1), two = catmull_clark(2);
    bat_mesh first = refine(&grid, &one), second = refine(&first, &one), both = refine(&grid, &two);
    assert_int_equal(both.face_count, second.face_count);
    assert_memory_equal(both.faces, second.faces, both.offsets[both.face_count] * sizeof *both.faces);
    for (size_t i = 0; i < 3 * both.vertex_count; i++)
    {
        check_near(both.positions[i], second.positions[i], 1e-14);
        assert_true(i % 3 != 2 || both.positions[i] == 0);
    }
    bat_mesh_free(&first);
    bat_mesh_free(&second);
    bat_mesh_free(&both);
    bat_mesh_free(&grid);
}

/// The limit of a refined mesh is the limit of the mesh, with creases and darts, and threads do not matter.
static void test_limits(void **state)
{
    (void)state;
    bat_mesh mesh = mixed();
    bat_mesh_refine_options options = catmull_clark(1);
    bat_mesh quads = refine(&mesh, &options);
    quads.creases = mesh_room(3, sizeof *quads.creases);
    for (size_t i = 0; i < 3; i++) // of one face: a crease with two ends
        quads.creases[i] = (bat_mesh_crease){quads.faces[i], quads.faces[i + 1], BAT_MESH_SHARP};
    quads.crease_count = 2;
    options.levels = 0;
    options.limit = true;
    bat_mesh limit = refine(&quads, &options);
    options.levels = 2;
    options.threads = 1;
    bat_mesh later = refine(&quads, &options);
    options.threads = 3;
    bat_mesh again = refine(&quads, &options);
    for (size_t i = 0; i < 3 * limit.vertex_count; i++)
        check_near(limit.positions[i], later.positions[i], 1e-13);
    assert_memory_equal(later.positions, again.positions, 3 * later.vertex_count * sizeof *later.positions);
    bat_mesh_free(&limit);
    bat_mesh_free(&later);
    bat_mesh_free(&again);
    bat_mesh_free(&quads);
    bat_mesh_free(&mesh);
}

/// The angle between the normal at a dart and that of the refined mesh there, which becomes 0.
static double angle_at_dart(const bat_mesh *mesh, uint32_t dart, size_t levels)
{
    bat_mesh_refine_options options = catmull_clark(levels);
    bat_mesh fine = refine(mesh, &options);
    double *coarse_normals = mesh_room(mesh->vertex_count, 3 * sizeof *coarse_normals);
    check_status(bat_mesh_limit_normals(mesh, 1, coarse_normals, NULL), BAT_OK);
    bat_mesh_connectivity links;
    check_status(bat_mesh_connect(&fine, &links, NULL), BAT_OK);
    const double *normal = coarse_normals + 3 * (size_t)dart, *own = fine.positions + 3 * (size_t)dart;
    double worst = 0;
    uint32_t first = links.first[dart], h = first;
    do
    {
        uint32_t next = h % 4 == 3 ? h - 3 : h + 1;
        const double *end = fine.positions + 3 * (size_t)fine.faces[next];
        double along = 0, length = 0;
        for (int i = 0; i < 3; i++)
        {
            along += normal[i] * (end[i] - own[i]);
            length += (end[i] - own[i]) * (end[i] - own[i]);
        }
        worst = fmax(worst, fabs(along) / sqrt(length));
        h = links.twin[h % 4 == 0 ? h + 3 : h - 1];
    } while (h != first);
    free(coarse_normals);
    bat_mesh_connectivity_free(&links);
    bat_mesh_free(&fine);
    return worst;
}

static void test_normals_at_darts(void **state)
{
    (void)state;
    bat_mesh mesh = mixed();
    bat_mesh_refine_options options = catmull_clark(1);
    bat_mesh quads = refine(&mesh, &options);
    quads.creases = mesh_room(1, sizeof *quads.creases);
    quads.creases[0] = (bat_mesh_crease){quads.faces[0], quads.faces[1], BAT_MESH_SHARP};
    quads.crease_count = 1;
    double near = angle_at_dart(&quads, quads.faces[0], 7), far = angle_at_dart(&quads, quads.faces[0], 4);
    assert_true(near < 0.02);
    assert_true(near < 0.6 * far);
    bat_mesh_free(&quads);
    bat_mesh_free(&mesh);
}

static void test_rules(void **state)
{
    (void)state;
    bat_mesh grid = polygon_grid(4, 4), fine;
    bat_mesh_refine_options options = catmull_clark(2);
    bat_error error;
    options.rules.boundary = BAT_MESH_BOUNDARY_CORNERS;
    fine = refine(&grid, &options);
    assert_true(fine.positions[0] == 0 && fine.positions[1] == 0);
    assert_int_equal(fine.rules.boundary, BAT_MESH_BOUNDARY_CORNERS);
    bat_mesh_free(&fine);
    options.rules.boundary = BAT_MESH_BOUNDARY_NONE;
    fine = refine(&grid, &options);
    assert_int_equal(fine.face_count, 16); // of the only face inside
    assert_int_equal(fine.vertex_count, 25);
    bat_mesh_free(&fine);
    bat_mesh_free(&grid);
    grid = polygon_grid(3, 3);
    check_status(bat_mesh_refine(&grid, &options, &fine, NULL, &error), BAT_UNSUPPORTED);
    options.scheme = BAT_MESH_SCHEME_LOOP;
    check_status(bat_mesh_refine(&grid, &options, &fine, NULL, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error_words(&error), "; scheme catmull-clark"));
    bat_mesh_free(&grid);
    bat_mesh triangles = mesh_grid(3, 3), made;
    options.scheme = BAT_MESH_SCHEME_BUTTERFLY;
    check_status(bat_mesh_refine(&triangles, &options, &made, NULL, &error), BAT_UNSUPPORTED);
    bat_mesh_free(&triangles);
}

static uint32_t begin_of(const bat_mesh *mesh, size_t face)
{
    return mesh->offsets != NULL ? mesh->offsets[face] : (uint32_t)(3 * face);
}

/// Triangles and quads, adaptively: no cracks, near the limit surface, with short edges.
static void check_adaptive(const bat_mesh *mesh, bat_mesh_scheme scheme, double tolerance, double max_edge)
{
    bat_mesh_refine_options options = catmull_clark(4);
    options.scheme = scheme;
    options.limit = true;
    bat_mesh limit = refine(mesh, &options);
    options.tolerance = tolerance;
    options.max_edge = max_edge;
    bat_mesh fine = refine(mesh, &options);
    bat_mesh_connectivity links, coarse_links;
    check_status(bat_mesh_connect(&fine, &links, NULL), BAT_OK);
    check_status(bat_mesh_connect(mesh, &coarse_links, NULL), BAT_OK);
    assert_int_equal(fine.vertex_count + fine.face_count - links.edge_count,
                     mesh->vertex_count + mesh->face_count - coarse_links.edge_count);
    assert_int_equal(links.boundary_edge_count > 0, coarse_links.boundary_edge_count > 0);
    for (size_t v = 0; v < fine.vertex_count; v++)
        assert_int_not_equal(links.first[v], BAT_MESH_NONE);
    for (size_t f = 0; f < fine.face_count && max_edge > 0; f++)
        for (uint32_t c = begin_of(&fine, f); c < begin_of(&fine, f + 1); c++)
        {
            uint32_t next = c + 1 < begin_of(&fine, f + 1) ? c + 1 : begin_of(&fine, f);
            const double *p = fine.positions + 3 * (size_t)fine.faces[c], *q = fine.positions + 3 * (size_t)fine.faces[next];
            assert_true(sqrt(pow(p[0] - q[0], 2) + pow(p[1] - q[1], 2) + pow(p[2] - q[2], 2)) <= max_edge);
        }
    if (tolerance > 0)
    {
        bat_mesh near, truth;
        bat_mesh_distance distance;
        check_status(bat_mesh_triangulate(&fine, &near, NULL), BAT_OK);
        check_status(bat_mesh_triangulate(&limit, &truth, NULL), BAT_OK);
        check_status(bat_mesh_compare(&near, &truth, NULL, &distance, NULL), BAT_OK);
        assert_true(distance.hausdorff <= tolerance);
        bat_mesh_free(&near);
        bat_mesh_free(&truth);
    }
    bat_mesh_connectivity_free(&links);
    bat_mesh_connectivity_free(&coarse_links);
    bat_mesh_free(&fine);
    bat_mesh_free(&limit);
}

static void test_adaptive(void **state)
{
    (void)state;
    bat_mesh triangles = mesh_irregular(8, 6, 1), sheet = mesh_grid(6, 5);
    mesh_shake(&sheet, 0.3, 4);
    bat_mesh meshes[] = {polygon_mixed(&triangles, 0, 1), polygon_mixed(&sheet, 0, 1), mixed(), mixed_grid(0.3),
                         polygon_cube()};
    const bat_mesh_crease creases[] = {{0, 1, BAT_MESH_SHARP}, {1, 3, 2.5}};
    meshes[4].creases = mesh_room(2, sizeof *creases);
    memcpy(meshes[4].creases, creases, sizeof creases);
    meshes[4].crease_count = 2;
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++)
    {
        bat_mesh_scheme scheme = i < 2 ? BAT_MESH_SCHEME_LOOP : BAT_MESH_SCHEME_CATMULL_CLARK;
        check_adaptive(&meshes[i], scheme, 0.1, 0);
        check_adaptive(&meshes[i], scheme, 0, 0.3);
        bat_mesh_free(&meshes[i]);
    }
    bat_mesh_free(&triangles);
    bat_mesh_free(&sheet);
}

/// A cube whose faces 0 and 1 are labelled "red", the others "blue".
static bat_mesh labelled_cube(void)
{
    bat_mesh cube = polygon_cube();
    cube.labels = mesh_room(2, sizeof *cube.labels);
    cube.labels[0].material = mesh_room(8, 1);
    cube.labels[1].material = mesh_room(8, 1);
    strcpy(cube.labels[0].material, "red");
    strcpy(cube.labels[1].material, "blue");
    cube.label_count = 2;
    cube.face_labels = mesh_room(cube.face_count, sizeof *cube.face_labels);
    for (size_t f = 2; f < cube.face_count; f++)
        cube.face_labels[f] = 1;
    return cube;
}

/// The number of faces with the first label. All faces of it are nearer to the planes z = -1 and z = 1 than to others.
static size_t count_red(const bat_mesh_label *labels, const uint32_t *face_labels, size_t count)
{
    size_t red = 0;
    assert_non_null(face_labels);
    assert_string_equal(labels[0].material, "red");
    assert_string_equal(labels[1].material, "blue");
    for (size_t f = 0; f < count; f++)
        red += face_labels[f] == 0;
    return red;
}

/// Labels go from polygons to quads, to triangles, and to the faces of adaptive refinement.
static void test_labels(void **state)
{
    (void)state;
    bat_mesh cube = labelled_cube(), wrong, fine;
    bat_mesh triangles;
    for (size_t levels = 0; levels < 4; levels++)
    {
        bat_mesh_refine_options options = catmull_clark(levels);
        fine = refine(&cube, &options);
        assert_int_equal(3 * count_red(fine.labels, fine.face_labels, fine.face_count), fine.face_count);
        for (size_t f = 0; f < fine.face_count; f++)
        {
            double middle[3] = {0};
            for (uint32_t c = fine.offsets[f]; c < fine.offsets[f + 1]; c++)
                for (int i = 0; i < 3; i++)
                    middle[i] += fine.positions[3 * (size_t)fine.faces[c] + (size_t)i];
            bool upright = fabs(middle[2]) > fabs(middle[0]) + 1e-9 && fabs(middle[2]) > fabs(middle[1]) + 1e-9;
            assert_int_equal(fine.face_labels[f], !upright);
        }
        bat_mesh_free(&fine);
    }
    check_status(bat_mesh_triangulate(&cube, &triangles, NULL), BAT_OK);
    assert_int_equal(count_red(triangles.labels, triangles.face_labels, triangles.face_count), 4);
    assert_int_equal(triangles.face_labels[3], 0);
    bat_mesh_free(&triangles);
    bat_mesh_refine_options options = catmull_clark(0);
    options.max_edge = 0.4;
    fine = refine(&cube, &options);
    size_t red = count_red(fine.labels, fine.face_labels, fine.face_count);
    assert_true(red > 8);
    assert_int_equal(3 * red, fine.face_count); // the cube's faces are alike
    bat_mesh_free(&fine);
    check_status(bat_mesh_copy(&cube, &wrong, NULL), BAT_OK);
    wrong.face_labels[5] = 2;
    check_status(bat_mesh_check(&wrong, NULL), BAT_INVALID_POINT);
    bat_mesh_free(&wrong);
    bat_mesh_free(&cube);
}

/// The normal of the limit surface is that of the tangent plane which edges of finer and finer levels approach.
static double largest_slope(const bat_mesh *mesh, const double *normals, size_t levels)
{
    bat_mesh_refine_options options = catmull_clark(levels);
    options.limit = true;
    bat_mesh fine = refine(mesh, &options);
    double largest = 0;
    for (uint32_t c = 0; c < fine.offsets[fine.face_count]; c++)
    {
        uint32_t vertex = fine.faces[c], other = fine.faces[c % 4 == 3 ? c - 3 : c + 1];
        if (vertex >= mesh->vertex_count)
            continue;
        const double *p = fine.positions + 3 * (size_t)vertex, *q = fine.positions + 3 * (size_t)other;
        const double *normal = normals + 3 * (size_t)vertex;
        double along = 0, length = 0;
        for (int i = 0; i < 3; i++)
        {
            along += normal[i] * (q[i] - p[i]);
            length += (q[i] - p[i]) * (q[i] - p[i]);
        }
        largest = fmax(largest, fabs(along) / sqrt(length));
    }
    bat_mesh_free(&fine);
    return largest;
}

static void test_limit_normals(void **state)
{
    (void)state;
    bat_mesh triangles = mesh_irregular(8, 6, 3);
    bat_mesh mesh = mixed(), open = mixed_grid(0.3), flat = mixed_grid(0), cube = polygon_cube();
    bat_mesh tame = polygon_mixed(&triangles, 0.4, 6);
    bat_mesh_refine_options options = catmull_clark(1);
    bat_mesh *meshes[] = {&mesh, &open, &flat, &cube, &tame};
    for (size_t m = 0; m < sizeof meshes / sizeof *meshes; m++)
    {
        bat_mesh quads = refine(meshes[m], &options);
        double *normals = mesh_room(quads.vertex_count, 3 * sizeof *normals), *same = NULL;
        check_status(bat_mesh_limit_normals(&quads, 2, normals, NULL), BAT_OK);
        for (size_t v = 0; v < quads.vertex_count; v++)
        {
            const double *n = normals + 3 * v, *p = quads.positions + 3 * v;
            check_near(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-14);
            if (meshes[m] == &flat)
                check_near(n[2], 1, 1e-14);
            // Vertices of the cube, and the middles of its edges and faces, are fixed by rotations.
            if (meshes[m] == &cube)
                check_near(n[0] * p[0] + n[1] * p[1] + n[2] * p[2], sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]), 1e-14);
        }
        // The first mesh has a vertex of two faces, where there is no tangent plane.
        double coarse = m > 0 ? largest_slope(&quads, normals, 3) : 0, fine = m > 0 ? largest_slope(&quads, normals, 6) : 0;
        assert_true(fine < 0.7 * coarse + 1e-12); // 0.87 a level with ten faces at a vertex
        bat_mesh_refine_options limit = options;
        limit.limit = true;
        limit.limit_normals = &same;
        bat_mesh moved = refine(meshes[m], &limit);
        assert_memory_equal(normals, same, 3 * quads.vertex_count * sizeof *normals);
        free(normals);
        free(same);
        bat_mesh_free(&moved);
        bat_mesh_free(&quads);
    }
    double *normals = mesh_room(mesh.vertex_count, 3 * sizeof *normals);
    check_status(bat_mesh_limit_normals(&mesh, 1, normals, NULL), BAT_UNSUPPORTED); // it has triangles
    free(normals);
    bat_mesh_free(&triangles);
    for (size_t m = 0; m < sizeof meshes / sizeof *meshes; m++)
        bat_mesh_free(meshes[m]);
}

/// Without a scheme, polygons are refined by Catmull and Clark's scheme, and faces that are all triangles as triangles.
/// Catmull and Clark's scheme takes triangles with and without offsets alike.
static void test_scheme_of_polygons(void **state)
{
    (void)state;
    bat_mesh triangles = mesh_irregular(8, 6, 3), plain;
    bat_mesh cube = polygon_cube(), few = polygon_mixed(&triangles, 0.3, 5), none = polygon_mixed(&triangles, 0, 5);
    bat_mesh fine;
    bat_error error;
    assert_int_equal(bat_mesh_scheme_for(&cube), BAT_MESH_SCHEME_CATMULL_CLARK);
    check_status(bat_mesh_refine(&cube, NULL, &fine, NULL, NULL), BAT_OK);
    assert_int_equal(fine.face_count, 96);
    bat_mesh_free(&fine);
    assert_int_equal(bat_mesh_scheme_for(&few), bat_mesh_scheme_for(&triangles));
    check_status(bat_mesh_refine(&few, NULL, &fine, NULL, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error_words(&error), "; scheme catmull-clark"));
    check_status(bat_mesh_refine(&none, NULL, &fine, NULL, NULL), BAT_OK);
    bat_mesh same = triangles; // with the corners in the order of `none`
    same.faces = none.faces;
    check_status(bat_mesh_refine(&same, NULL, &plain, NULL, NULL), BAT_OK);
    assert_int_equal(fine.face_count, plain.face_count);
    assert_memory_equal(fine.positions, plain.positions, 3 * plain.vertex_count * sizeof *plain.positions);
    bat_mesh_free(&plain);
    bat_mesh_free(&fine);
    const bat_mesh_refine_options options = catmull_clark(2);
    fine = refine(&none, &options);
    plain = refine(&same, &options);
    assert_int_equal(fine.face_count, plain.face_count);
    assert_memory_equal(fine.faces, plain.faces, 4 * plain.face_count * sizeof *plain.faces);
    assert_memory_equal(fine.positions, plain.positions, 3 * plain.vertex_count * sizeof *plain.positions);
    bat_mesh_free(&plain);
    bat_mesh_free(&fine);
    bat_mesh_free(&none);
    bat_mesh_free(&few);
    bat_mesh_free(&cube);
    bat_mesh_free(&triangles);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bad_meshes),
                                       cmocka_unit_test(test_triangulated),
                                       cmocka_unit_test(test_cube),
                                       cmocka_unit_test(test_levels_and_planes),
                                       cmocka_unit_test(test_limits),
                                       cmocka_unit_test(test_normals_at_darts),
                                       cmocka_unit_test(test_rules),
                                       cmocka_unit_test(test_adaptive),
                                       cmocka_unit_test(test_labels),
                                       cmocka_unit_test(test_limit_normals),
                                       cmocka_unit_test(test_scheme_of_polygons)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
