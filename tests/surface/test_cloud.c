// Clouds: what is a cloud, clouds of meshes, corners, parameters of the boundary.
#include "cloud_helpers.h"

static bat_cloud square_loop(size_t side)
{
    bat_cloud cloud = {0};
    double u, v;
    for (size_t i = 0; i < 4 * side; i++)
    {
        around_square((double)i / (double)(4 * side), &u, &v);
        add_point(&cloud, u, v, 0);
    }
    cloud.boundary_count = 4 * side;
    return cloud;
}

static void assert_refused(const bat_cloud *cloud, bat_status expected, size_t index, const char *words)
{
    bat_error error = {0};
    check_status(bat_cloud_check(cloud, &error), expected);
    check_status(bat_cloud_check(cloud, NULL), expected);
    assert_int_equal(error.index, index);
    if (strstr(error.text, words) == NULL)
        fail_msg("\"%s\" does not say \"%s\"", error.text, words);
}

static void test_what_is_a_cloud(void **state)
{
    (void)state;
    bat_cloud cloud = square_loop(2), empty = {0};
    check_status(bat_cloud_check(&cloud, NULL), BAT_OK);
    assert_refused(&empty, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, "no points");
    cloud.boundary_count = 3;
    assert_refused(&cloud, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, "four corners");
    cloud.boundary_count = 9;
    assert_refused(&cloud, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, "only 8");
    cloud.boundary_count = 8;
    cloud.has_corners = true;
    const size_t corners[4] = {0, 2, 4, 6}, wrong[4] = {0, 2, 2, 6}, far_off[4] = {0, 2, 4, 8};
    memcpy(cloud.corners, corners, sizeof corners);
    check_status(bat_cloud_check(&cloud, NULL), BAT_OK);
    memcpy(cloud.corners, wrong, sizeof wrong);
    assert_refused(&cloud, BAT_INVALID_ARGUMENT, 2, "corner 2");
    memcpy(cloud.corners, far_off, sizeof far_off);
    assert_refused(&cloud, BAT_INVALID_ARGUMENT, 3, "corner 3");
    cloud.has_corners = false;
    cloud.triangles = malloc(3 * sizeof *cloud.triangles);
    cloud.triangle_count = 1;
    cloud.triangles[0] = cloud.triangles[1] = 0;
    cloud.triangles[2] = 8;
    assert_refused(&cloud, BAT_INVALID_ARGUMENT, 0, "triangle 0");
    cloud.triangles[2] = 7;
    cloud.points[3 * 5 + 1] = NAN;
    assert_refused(&cloud, BAT_INVALID_POINT, 5, "point 5 is not finite");
    memcpy(cloud.points + 15, cloud.points + 6, 3 * sizeof(double));
    assert_refused(&cloud, BAT_INVALID_POINT, 5, "point 5 repeats point 2");
    // Points are named by their place in the input; -0 is 0.
    cloud.order = malloc(8 * sizeof *cloud.order);
    for (size_t i = 0; i < 8; i++)
        cloud.order[i] = 100 - i;
    assert_refused(&cloud, BAT_INVALID_POINT, 98, "point 98 repeats point 95");
    bat_cloud_free(&cloud);
    add_point(&cloud, 0, 0, 0);
    add_point(&cloud, -0.0, 0, -0.0);
    assert_refused(&cloud, BAT_INVALID_POINT, 1, "repeats");
    bat_cloud_free(&cloud);
    assert_null(cloud.points);
}

static void test_copies_own_what_they_have(void **state)
{
    (void)state;
    bat_cloud cloud = square_loop(3), copy, copy_of_none, none = {0};
    cloud.order = calloc(cloud.count, sizeof *cloud.order);
    cloud.triangles = calloc(3, sizeof *cloud.triangles);
    cloud.triangle_count = 1;
    check_status(bat_cloud_copy(&cloud, &copy, NULL), BAT_OK);
    assert_memory_equal(copy.points, cloud.points, 3 * cloud.count * sizeof(double));
    assert_true(copy.points != cloud.points && copy.order != cloud.order && copy.triangles != cloud.triangles);
    assert_int_equal(copy.boundary_count, 12);
    bat_cloud_free(&cloud);
    bat_cloud_free(&copy);
    check_status(bat_cloud_copy(&none, &copy_of_none, NULL), BAT_OK);
    assert_null(copy_of_none.points);
}

/// A grid of (columns + 1) x (rows + 1) vertices in the plane, or with the last column joined to the first.
static bat_mesh grid_mesh(uint32_t columns, uint32_t rows, bool round)
{
    uint32_t wide = round ? columns : columns + 1;
    bat_mesh mesh = {.vertex_count = (size_t)wide * (rows + 1), .face_count = 2 * (size_t)columns * rows};
    mesh.positions = malloc(mesh.vertex_count * 3 * sizeof *mesh.positions);
    mesh.faces = malloc(mesh.face_count * 3 * sizeof *mesh.faces);
    uint32_t *face = mesh.faces;
    for (uint32_t i = 0; i < mesh.vertex_count; i++)
    {
        double *p = mesh.positions + 3 * (size_t)i, t = 6.283185307179586 * (i % wide) / columns;
        p[0] = round ? cos(t) : i % wide;
        p[1] = round ? sin(t) : i / wide;
        p[2] = round ? i / wide : 0;
    }
    for (uint32_t r = 0; r < rows; r++)
        for (uint32_t c = 0; c < columns; c++)
        {
            uint32_t a = r * wide + c, b = r * wide + (c + 1) % wide;
            const uint32_t corners[6] = {a, b, b + wide, a, b + wide, a + wide};
            memcpy(face, corners, sizeof corners);
            face += 6;
        }
    return mesh;
}

static void test_clouds_of_meshes(void **state)
{
    (void)state;
    bat_mesh mesh = grid_mesh(5, 3, false);
    mesh.positions = realloc(mesh.positions, (mesh.vertex_count + 1) * 3 * sizeof *mesh.positions);
    memset(mesh.positions + 3 * mesh.vertex_count++, 0, 3 * sizeof *mesh.positions); // without a face, and a duplicate
    bat_cloud cloud;
    check_status(bat_cloud_from_mesh(&mesh, &cloud, NULL), BAT_OK);
    check_status(bat_cloud_check(&cloud, NULL), BAT_OK);
    assert_int_equal(cloud.count, 24);
    assert_int_equal(cloud.boundary_count, 16);
    assert_int_equal(cloud.triangle_count, 30);
    assert_false(cloud.has_corners);
    // Counter-clockwise from vertex 0: twice the area inside is that of the rectangle.
    double area = 0;
    for (size_t i = 0; i < 16; i++)
    {
        const double *p = cloud.points + 3 * i, *q = cloud.points + 3 * ((i + 1) % 16);
        check_near(distance_of(p, q), 1, 0);
        area += p[0] * q[1] - p[1] * q[0];
    }
    assert_true(area == 30);
    assert_int_equal(cloud.order[0], 0);
    assert_int_equal(cloud.order[1], 1);
    for (size_t i = 0; i < cloud.count; i++)
        assert_memory_equal(cloud.points + 3 * i, mesh.positions + 3 * cloud.order[i], 3 * sizeof(double));
    for (size_t i = 0; i < 90; i++)
        assert_int_equal(cloud.order[cloud.triangles[i]], mesh.faces[i]);
    bat_cloud_free(&cloud);
    bat_mesh_free(&mesh);
}

static void assert_no_patch(bat_mesh *mesh, bat_status expected, const char *words)
{
    bat_cloud cloud = {.count = 17};
    bat_error error = {0};
    check_status(bat_cloud_from_mesh(mesh, &cloud, &error), expected);
    if (strstr(error.text, words) == NULL)
        fail_msg("\"%s\" does not say \"%s\"", error.text, words);
    assert_int_equal(cloud.count, 17);
    bat_mesh_free(mesh);
}

/// Half-joined pieces: `more` follows `mesh`, which owns the result.
static void append_mesh(bat_mesh *mesh, bat_mesh *more)
{
    size_t v = mesh->vertex_count, f = mesh->face_count;
    mesh->positions = realloc(mesh->positions, (v + more->vertex_count) * 3 * sizeof *mesh->positions);
    mesh->faces = realloc(mesh->faces, (f + more->face_count) * 3 * sizeof *mesh->faces);
    memcpy(mesh->positions + 3 * v, more->positions, more->vertex_count * 3 * sizeof *mesh->positions);
    for (size_t i = 0; i < 3 * more->face_count; i++)
        mesh->faces[3 * f + i] = more->faces[i] + (uint32_t)v;
    mesh->vertex_count += more->vertex_count;
    mesh->face_count += more->face_count;
    bat_mesh_free(more);
}

static bat_mesh tetrahedron(void)
{
    static const double positions[] = {0, 0, 9, 1, 0, 9, 0, 1, 9, 0, 0, 10};
    static const uint32_t faces[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    bat_mesh mesh = {
        .vertex_count = 4, .face_count = 4, .positions = malloc(sizeof positions), .faces = malloc(sizeof faces)};
    memcpy(mesh.positions, positions, sizeof positions);
    memcpy(mesh.faces, faces, sizeof faces);
    return mesh;
}

/// A torus of 7 vertices (Császár) without one of its faces.
static bat_mesh torus_with_hole(void)
{
    bat_mesh mesh = {.vertex_count = 7, .face_count = 13};
    mesh.positions = malloc(21 * sizeof *mesh.positions);
    mesh.faces = malloc(42 * sizeof *mesh.faces);
    for (uint32_t i = 0; i < 7; i++)
    {
        const uint32_t corners[6] = {i, (i + 1) % 7, (i + 3) % 7, i, (i + 3) % 7, (i + 2) % 7};
        memcpy(mesh.faces + 6 * (size_t)i, corners, sizeof corners);
        for (uint32_t k = 0; k < 3; k++)
            mesh.positions[3 * i + k] = (double)((i * i * (k + 1) + k) % 7) + 0.1 * i;
    }
    return mesh;
}

static void test_meshes_that_are_no_patch(void **state)
{
    (void)state;
    bat_mesh mesh = {0}, other = grid_mesh(6, 2, true);
    assert_no_patch(&mesh, BAT_INVALID_ARGUMENT, "no faces");
    mesh = tetrahedron();
    assert_no_patch(&mesh, BAT_UNSUPPORTED, "closed");
    assert_no_patch(&other, BAT_UNSUPPORTED, "several boundary loops");
    mesh = grid_mesh(2, 2, false);
    other = tetrahedron();
    append_mesh(&mesh, &other);
    assert_no_patch(&mesh, BAT_UNSUPPORTED, "several parts");
    mesh = torus_with_hole();
    assert_no_patch(&mesh, BAT_UNSUPPORTED, "handles");
    mesh = tetrahedron();
    mesh.face_count = 1; // one triangle, and a vertex that no face has
    assert_no_patch(&mesh, BAT_INVALID_ARGUMENT, "four corners");
    mesh = grid_mesh(2, 2, false);
    memcpy(mesh.positions, mesh.positions + 24, 3 * sizeof(double));
    assert_no_patch(&mesh, BAT_INVALID_POINT, "point 8 repeats point 0");
    mesh = grid_mesh(2, 2, false);
    mesh.faces[0] = mesh.faces[1];
    assert_no_patch(&mesh, BAT_INVALID_POINT, "twice");
}

static void assert_corners(const bat_cloud *cloud, const size_t expected[4])
{
    assert_true(cloud->has_corners);
    for (int k = 0; k < 4; k++)
        if (cloud->corners[k] != expected[k])
            fail_msg("corners %zu %zu %zu %zu instead of %zu %zu %zu %zu", cloud->corners[0], cloud->corners[1],
                     cloud->corners[2], cloud->corners[3], expected[0], expected[1], expected[2], expected[3]);
}

/// A rectangle's loop, beginning `shift` steps after a corner, and some points inside, on a sheet that may be rolled.
static bat_cloud rectangle(size_t wide, size_t high, size_t shift, bool rolled)
{
    bat_cloud cloud = {0};
    size_t around = 2 * (wide + high);
    for (size_t i = 0; i < around; i++)
    {
        size_t s = (i + shift) % around;
        double x = s < wide              ? (double)s
                   : s < wide + high     ? (double)wide
                   : s < 2 * wide + high ? (double)(2 * wide + high - s)
                                         : 0;
        double y = s < wide              ? 0
                   : s < wide + high     ? (double)(s - wide)
                   : s < 2 * wide + high ? (double)high
                                         : (double)(around - s);
        add_point(&cloud, x, y, 0);
    }
    cloud.boundary_count = around;
    for (size_t y = 1; y < high; y++)
        for (size_t x = 1; x < wide; x++)
            add_point(&cloud, (double)x, (double)y, 0);
    for (size_t i = 0; i < cloud.count && rolled; i++)
    {
        double *p = cloud.points + 3 * i, angle = 4 * p[0] / (double)wide, radius = (double)wide / 4;
        p[0] = radius * sin(angle);
        p[2] = radius * (1 - cos(angle));
    }
    return cloud;
}

static void test_sharp_corners_are_found_exactly(void **state)
{
    (void)state;
    static const size_t shapes[][2] = {{20, 20}, {40, 15}, {60, 10}, {7, 5}, {200, 150}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        for (int rolled = 0; rolled < 2; rolled++)
        {
            size_t wide = shapes[i][0], high = shapes[i][1], shift = wide / 3, around = 2 * (wide + high);
            bat_cloud cloud = rectangle(wide, high, shift, rolled);
            check_status(bat_cloud_find_corners(&cloud, NULL), BAT_OK);
            const size_t expected[4] = {wide - shift, wide + high - shift, 2 * wide + high - shift, around - shift};
            assert_corners(&cloud, expected);
            bat_cloud_free(&cloud);
        }
}

static void test_teeth_are_no_corners(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 5; seed++)
    {
        bat_random random = bat_random_seed(seed);
        bat_cloud cloud = rectangle(60, 45, 10, false);
        // Every point of the loop goes in or out by up to a step.
        for (size_t i = 0; i < cloud.boundary_count; i++)
            for (size_t k = 0; k < 2; k++)
                cloud.points[3 * i + k] += 1.6 * bat_random_uniform(&random) - 0.8;
        check_status(bat_cloud_find_corners(&cloud, NULL), BAT_OK);
        const size_t expected[4] = {50, 95, 155, 200};
        for (int k = 0; k < 4; k++)
            assert_in_range(cloud.corners[k], expected[k] - 3, expected[k] + 3);
        bat_cloud_free(&cloud);
    }
}

static void test_dents_are_no_corners(void **state)
{
    (void)state;
    // A square whose one side has a rectangular notch: its two inner corners turn away from the patch.
    bat_cloud cloud = {0};
    for (int x = 0; x <= 40; x++)
        for (int y = 0; y <= 40; y++)
            if (x > 0 && x < 40 && y > 0 && y < 40 && !(x > 14 && x < 26 && y < 7))
                add_point(&cloud, x, y, 0);
    bat_cloud loop = {0};
    static const int turns[][2] = {{0, 0}, {14, 0}, {14, 7}, {26, 7}, {26, 0}, {40, 0}, {40, 40}, {0, 40}, {0, 0}};
    for (size_t i = 0; i + 1 < sizeof turns / sizeof *turns; i++)
    {
        int dx = turns[i + 1][0] - turns[i][0], dy = turns[i + 1][1] - turns[i][1], steps = abs(dx) + abs(dy);
        for (int s = 0; s < steps; s++)
            add_point(&loop, turns[i][0] + dx / steps * s, turns[i][1] + dy / steps * s, 0);
    }
    loop.boundary_count = loop.count;
    for (size_t i = 0; i < cloud.count; i++)
        add_point(&loop, cloud.points[3 * i], cloud.points[3 * i + 1], 0);
    check_status(bat_cloud_find_corners(&loop, NULL), BAT_OK);
    const double expected[4][2] = {{0, 0}, {40, 0}, {40, 40}, {0, 40}};
    for (int k = 0; k < 4; k++)
        assert_memory_equal(loop.points + 3 * loop.corners[k], expected[k], sizeof expected[k]);
    bat_cloud_free(&cloud);
    bat_cloud_free(&loop);
}

static void test_smooth_loops_are_split_evenly(void **state)
{
    (void)state;
    for (size_t count = 40; count <= 1000; count *= 5)
    {
        bat_cloud cloud = {0};
        for (size_t i = 0; i < count; i++)
            add_point(&cloud, cos(6.283185307179586 * (double)i / (double)count),
                      sin(6.283185307179586 * (double)i / (double)count), 0);
        cloud.boundary_count = count;
        for (size_t i = 1; i < 300; i++)
            add_point(&cloud, sqrt((double)i / 330) * cos(2.4 * (double)i), sqrt((double)i / 330) * sin(2.4 * (double)i), 0);
        check_status(bat_cloud_find_corners(&cloud, NULL), BAT_OK);
        for (int k = 0; k < 4; k++)
        {
            size_t next = k < 3 ? cloud.corners[k + 1] : cloud.corners[0] + count;
            check_near((double)(next - cloud.corners[k]) / (double)count, 0.25, 0.021);
        }
        bat_cloud_free(&cloud);
    }
}

static void test_corners_of_few_and_uneven_points(void **state)
{
    (void)state;
    bat_cloud cloud = {0}, none = {0};
    for (int i = 0; i < 4; i++)
        add_point(&cloud, i == 1 || i == 2, i > 1, 0);
    cloud.boundary_count = 4;
    check_status(bat_cloud_find_corners(&cloud, NULL), BAT_OK);
    const size_t expected[4] = {0, 1, 2, 3};
    assert_corners(&cloud, expected);
    bat_cloud_free(&cloud);
    // All points but one within a thousandth of the loop.
    for (int i = 0; i < 300; i++)
        add_point(&cloud, 1e-6 * i, 1e-9 * i * i, 0);
    add_point(&cloud, 0, 1, 0);
    cloud.boundary_count = cloud.count;
    check_status(bat_cloud_find_corners(&cloud, NULL), BAT_OK);
    check_status(bat_cloud_check(&cloud, NULL), BAT_OK);
    bat_cloud_free(&cloud);
    bat_error error;
    check_status(bat_cloud_find_corners(&none, &error), BAT_INVALID_ARGUMENT);
}

static void test_corners_of_scans(void **state)
{
    (void)state;
    // What the eye says of the mask: two corners at the top of the head, one at each ear.
    static const size_t expected[4] = {22, 73, 102, 157};
    bat_cloud cloud;
    if (bat_cloud_read(SHARED_DATA "/data/clouds/nefertiti-8818.xyz", NULL, &cloud, NULL) != BAT_OK)
    {
        print_message(SHARED_DATA "/data/clouds is not here: skipped\n");
        skip();
    }
    check_status(bat_cloud_find_corners(&cloud, NULL), BAT_OK);
    for (int k = 0; k < 4; k++)
        assert_in_range(cloud.corners[k], expected[k] - 5, expected[k] + 5);
    bat_cloud_free(&cloud);
}

static void test_boundary_parameters(void **state)
{
    (void)state;
    // Sides of the square with steps that grow; begun before the first corner.
    static const double steps[] = {0, 0.01, 0.05, 0.14, 0.3, 0.55};
    bat_cloud cloud = {0};
    double u, v, parameters[48];
    for (size_t i = 0; i < 24; i++)
    {
        size_t s = (i + 22) % 24;
        around_square(((double)(s / 6) + steps[s % 6]) / 4, &u, &v);
        add_point(&cloud, 3 * u, 3 * v, 7);
    }
    cloud.boundary_count = 24;
    cloud.has_corners = true;
    for (size_t k = 0; k < 4; k++)
        cloud.corners[k] = 2 + 6 * k;
    check_status(bat_cloud_boundary_parameters(&cloud, BAT_CLOUD_SIDES_CHORD_LENGTH, parameters, NULL), BAT_OK);
    for (size_t i = 0; i < 24; i++)
        for (size_t k = 0; k < 2; k++)
            check_near(3 * parameters[2 * i + k], cloud.points[3 * i + k], 1e-14);
    check_status(bat_cloud_boundary_parameters(&cloud, BAT_CLOUD_SIDES_UNIFORM, parameters, NULL), BAT_OK);
    for (size_t i = 0; i < 24; i++)
    {
        around_square((double)((i + 22) % 24) / 24, &u, &v);
        check_near(parameters[2 * i], u, 1e-15);
        check_near(parameters[2 * i + 1], v, 1e-15);
    }
    check_status(bat_cloud_boundary_parameters(&cloud, BAT_CLOUD_SIDES_CENTRIPETAL, parameters, NULL), BAT_OK);
    double whole = 0, reached = 0;
    for (size_t i = 0; i < 6; i++)
        whole += sqrt((i < 5 ? steps[i + 1] : 1) - steps[i]);
    for (size_t i = 0; i < 6; i++)
    {
        check_near(parameters[2 * (i + 2)], reached / whole, 1e-14);
        assert_true(parameters[2 * (i + 2) + 1] == 0);
        reached += sqrt((i < 5 ? steps[i + 1] : 1) - steps[i]);
    }
    // Corners are exact, and without them they are found.
    for (size_t k = 0; k < 4; k++)
    {
        assert_true(parameters[2 * cloud.corners[k]] == (k == 1 || k == 2));
        assert_true(parameters[2 * cloud.corners[k] + 1] == (k > 1));
    }
    cloud.has_corners = false;
    double found[48];
    check_status(bat_cloud_boundary_parameters(&cloud, BAT_CLOUD_SIDES_CENTRIPETAL, found, NULL), BAT_OK);
    assert_memory_equal(found, parameters, sizeof found);
    assert_false(cloud.has_corners);
    check_status(bat_cloud_boundary_parameters(&cloud, (bat_cloud_sides)4, found, NULL), BAT_INVALID_ARGUMENT);
    cloud.boundary_count = 0;
    check_status(bat_cloud_boundary_parameters(&cloud, BAT_CLOUD_SIDES_UNIFORM, found, NULL), BAT_INVALID_ARGUMENT);
    bat_cloud_free(&cloud);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_is_a_cloud),
        cmocka_unit_test(test_copies_own_what_they_have),
        cmocka_unit_test(test_clouds_of_meshes),
        cmocka_unit_test(test_meshes_that_are_no_patch),
        cmocka_unit_test(test_sharp_corners_are_found_exactly),
        cmocka_unit_test(test_teeth_are_no_corners),
        cmocka_unit_test(test_dents_are_no_corners),
        cmocka_unit_test(test_smooth_loops_are_split_evenly),
        cmocka_unit_test(test_corners_of_few_and_uneven_points),
        cmocka_unit_test(test_corners_of_scans),
        cmocka_unit_test(test_boundary_parameters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
