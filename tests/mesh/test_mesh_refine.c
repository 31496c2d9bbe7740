// Refinement of meshes: numbering, connectivity and invariances of every scheme.
#include "check.h"
#include "mesh_helpers.h"

#include "batten/mesh_refine.h"
#include "mesh/refine/level.h"

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

/// The connectivity by arithmetic is the one that a search finds.
static void check_split_links(const bat_mesh *mesh, int threads)
{
    bat_mesh_connectivity links, split, found;
    assert_int_equal(bat_mesh_connect(mesh, &links, NULL), BAT_OK);
    assert_int_equal(split_links(NULL, &links, threads, &split, NULL), BAT_OK);
    bat_mesh fine = {.vertex_count = split.vertex_count, .face_count = split.face_count};
    fine.faces = calloc(fine.face_count, 3 * sizeof *fine.faces);
    assert_non_null(fine.faces);
    split_faces(NULL, mesh->faces, &links, threads, fine.faces);
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
        bat_mesh fine = refine(&meshes[i], BAT_MESH_SCHEME_MIDPOINT, 1);
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

static const bat_mesh_scheme SCHEMES[] = {BAT_MESH_SCHEME_MIDPOINT, BAT_MESH_SCHEME_LOOP, BAT_MESH_SCHEME_BUTTERFLY,
                                          BAT_MESH_SCHEME_SQRT3};
enum
{
    SCHEME_COUNT = sizeof SCHEMES / sizeof SCHEMES[0]
};

/// Two calls with one level are one call with two levels.
static void test_levels_add_up(void **state)
{
    (void)state;
    bat_mesh irregular = mesh_irregular(9, 7, 5), grid = mesh_grid(5, 4), joined = mesh_join(&irregular, &grid);
    mesh_shake(&joined, 0.1, 3);
    // Square-root-three subdivision alternates at boundaries.
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        bool in_turns = SCHEMES[s] == BAT_MESH_SCHEME_SQRT3;
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

static bat_mesh refine_with(const bat_mesh *coarse, const bat_mesh_refine_options *options)
{
    bat_mesh fine;
    bat_error error = {0};
    bat_status status = bat_mesh_refine(coarse, options, &fine, NULL, &error);
    if (status != BAT_OK)
        print_error("%s\n", error.text);
    check_status(status, BAT_OK);
    return fine;
}

/// x -> A x + t with some A.
static void transform(bat_mesh *mesh)
{
    for (size_t v = 0; v < mesh->vertex_count; v++)
    {
        double *p = mesh->positions + 3 * v, x = p[0], y = p[1], z = p[2];
        p[0] = 2 * x - 0.5 * y + 0.25 * z + 3;
        p[1] = 0.5 * x + y - z - 1;
        p[2] = x + 0.75 * y + 1.5 * z + 0.5;
    }
}

/// Rules with weights of sum 1 commute with affine maps, so planes remain planes.
static void test_affine_maps(void **state)
{
    (void)state;
    bat_mesh irregular = mesh_irregular(9, 7, 5), grid = mesh_grid(6, 5), fan = mesh_fan(9, true), half = mesh_fan(5, false);
    bat_mesh both = mesh_join(&irregular, &grid), fans = mesh_join(&fan, &half);
    mesh_shake(&both, 0.1, 8);
    mesh_shake(&fans, 0.1, 9);
    bat_mesh *meshes[] = {&both, &fans};
    for (size_t m = 0; m < 2; m++)
        for (size_t s = 0; s < SCHEME_COUNT; s++)
        {
            bat_mesh fine = refine(meshes[m], SCHEMES[s], 3), moved;
            check_status(bat_mesh_copy(meshes[m], &moved, NULL), BAT_OK);
            transform(&moved);
            transform(&fine);
            bat_mesh fine_of_moved = refine(&moved, SCHEMES[s], 3);
            check_same_mesh(&fine_of_moved, &fine, 2e-13);
            bat_mesh_free(&fine);
            bat_mesh_free(&moved);
            bat_mesh_free(&fine_of_moved);
        }
    bat_mesh_free(&irregular);
    bat_mesh_free(&grid);
    bat_mesh_free(&fan);
    bat_mesh_free(&half);
    bat_mesh_free(&both);
    bat_mesh_free(&fans);
}

static void test_planes_stay(void **state)
{
    (void)state;
    bat_mesh grid = mesh_grid(6, 5);
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        bat_mesh fine = refine(&grid, SCHEMES[s], 3);
        for (size_t v = 0; v < fine.vertex_count; v++)
            assert_true(fine.positions[3 * v + 2] == 0);
        bat_mesh_free(&fine);
    }
    bat_mesh_free(&grid);
}

/// Vertices - edges + faces, from the faces alone.
static long euler_characteristic(const bat_mesh *mesh)
{
    bat_mesh_connectivity links;
    check_status(bat_mesh_connect(mesh, &links, NULL), BAT_OK);
    long result = (long)links.vertex_count - (long)links.edge_count + (long)links.face_count;
    bat_mesh_connectivity_free(&links);
    return result;
}

static void test_topology_stays(void **state)
{
    (void)state;
    bat_mesh meshes[] = {mesh_octahedron(), mesh_torus(5, 4), mesh_grid(3, 2), mesh_fan(3, true)};
    const long expected[] = {2, 0, 1, 1};
    for (size_t i = 0; i < sizeof meshes / sizeof meshes[0]; i++)
    {
        for (size_t s = 0; s < SCHEME_COUNT; s++)
        {
            bat_mesh fine = refine(&meshes[i], SCHEMES[s], 3);
            size_t factor = SCHEMES[s] == BAT_MESH_SCHEME_SQRT3 ? 27 : 64;
            assert_int_equal(fine.face_count, factor * meshes[i].face_count);
            assert_int_equal(euler_characteristic(&fine), expected[i]);
            check_status(bat_mesh_check(&fine, NULL), BAT_OK);
            bat_mesh_free(&fine);
        }
        bat_mesh_free(&meshes[i]);
    }
}

static bool interpolates(bat_mesh_scheme scheme)
{
    return scheme == BAT_MESH_SCHEME_MIDPOINT || scheme == BAT_MESH_SCHEME_BUTTERFLY;
}

static void test_vertices_stay(void **state)
{
    (void)state;
    bat_mesh mesh = mesh_irregular(9, 7, 5);
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        bat_mesh fine = refine(&mesh, SCHEMES[s], 2);
        bool same = memcmp(fine.positions, mesh.positions, 3 * mesh.vertex_count * sizeof *mesh.positions) == 0;
        assert_int_equal(same, interpolates(SCHEMES[s]));
        bat_mesh_free(&fine);
    }
    bat_mesh_free(&mesh);
}

/// The result does not depend on the number of threads, to the last bit.
static void test_threads(void **state)
{
    (void)state;
    bat_mesh closed = mesh_irregular(60, 40, 5), grid = mesh_grid(40, 30), mesh = mesh_join(&closed, &grid);
    mesh_shake(&mesh, 0.1, 4);
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        bat_mesh_refine_options options = bat_mesh_refine_defaults();
        options.scheme = SCHEMES[s];
        options.levels = 3;
        options.limit = SCHEMES[s] == BAT_MESH_SCHEME_LOOP;
        options.threads = 1;
        bat_mesh one = refine_with(&mesh, &options);
        for (int threads = 2; threads <= 5; threads += 3)
        {
            options.threads = threads;
            bat_mesh many = refine_with(&mesh, &options);
            assert_memory_equal(one.positions, many.positions, 3 * one.vertex_count * sizeof *one.positions);
            assert_memory_equal(one.faces, many.faces, 3 * one.face_count * sizeof *one.faces);
            bat_mesh_free(&many);
        }
        bat_mesh_free(&one);
    }
    bat_mesh_free(&closed);
    bat_mesh_free(&grid);
    bat_mesh_free(&mesh);
}

/// Renumbering of vertices and faces, and rotation of faces' corners, do not change positions.
static void test_renumbering(void **state)
{
    (void)state;
    bat_mesh closed = mesh_irregular(9, 7, 5), grid = mesh_grid(6, 5), mesh = mesh_join(&closed, &grid);
    mesh_shake(&mesh, 0.1, 4);
    size_t vertices = mesh.vertex_count, faces = mesh.face_count;
    bat_mesh other = mesh_with_room(vertices, faces);
    // Steps that are coprime to the counts reach all elements.
    size_t step = 17, face_step = 29;
    assert_true(vertices % 17 != 0 && faces % 29 != 0);
    for (size_t v = 0; v < vertices; v++)
        memcpy(other.positions + 3 * (v * step % vertices), mesh.positions + 3 * v, 3 * sizeof *mesh.positions);
    for (size_t f = 0; f < faces; f++)
        for (size_t c = 0; c < 3; c++)
            other.faces[3 * (f * face_step % faces) + (c + f) % 3] = (uint32_t)(mesh.faces[3 * f + c] * step % vertices);
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        bat_mesh one = refine(&mesh, SCHEMES[s], 1), two = refine(&other, SCHEMES[s], 1);
        for (size_t f = 0; f < faces && SCHEMES[s] != BAT_MESH_SCHEME_SQRT3; f++)
            for (size_t c = 0; c < 3; c++)
            {
                // The faces at a corner contain the vertex and the new vertices of its two edges.
                size_t g = f * face_step % faces, d = (c + f) % 3;
                const uint32_t *a = one.faces + 3 * (4 * f + c), *b = two.faces + 3 * (4 * g + d);
                for (size_t i = 0; i < 9; i++)
                    check_near(one.positions[3 * (size_t)a[i / 3] + i % 3], two.positions[3 * (size_t)b[i / 3] + i % 3],
                               1e-14);
            }
        bat_mesh_free(&one);
        bat_mesh_free(&two);
    }
    bat_mesh_free(&closed);
    bat_mesh_free(&grid);
    bat_mesh_free(&mesh);
    bat_mesh_free(&other);
}

/// The largest height error of new vertices on interior edges of a regular grid, far from the boundary, for polynomial
/// heights.
static double worst_height(bat_mesh_scheme scheme, double (*height)(double x, double y))
{
    bat_mesh grid = mesh_grid(13, 13);
    for (size_t v = 0; v < grid.vertex_count; v++)
        grid.positions[3 * v + 2] = height(grid.positions[3 * v], grid.positions[3 * v + 1]);
    bat_mesh fine = refine(&grid, scheme, 1);
    double worst = 0;
    for (size_t v = 0; v < fine.vertex_count; v++)
    {
        const double *p = fine.positions + 3 * v;
        double row = p[1] / sqrt(0.75), column = p[0] - 0.5 * row;
        if (row > 3 && row < 9 && column > 3 && column < 9)
            worst = fmax(worst, fabs(p[2] - height(p[0], p[1])));
    }
    bat_mesh_free(&grid);
    bat_mesh_free(&fine);
    return worst;
}

static double linear(double x, double y)
{
    return 1 + 2 * x - 3 * y;
}

static double saddle(double x, double y)
{
    return x * x - y * y + x * y;
}

static double bowl(double x, double y)
{
    return x * x + y * y;
}

static double cubic(double x, double y)
{
    return x * x * x - 2 * x * x * y + y * y * y + x * y;
}

static double quartic(double x, double y)
{
    return x * x * x * x + y * y * x;
}

static void test_polynomials(void **state)
{
    (void)state;
    assert_true(worst_height(BAT_MESH_SCHEME_MIDPOINT, linear) < 1e-12);
    assert_true(worst_height(BAT_MESH_SCHEME_LOOP, linear) < 1e-12);
    assert_true(worst_height(BAT_MESH_SCHEME_BUTTERFLY, linear) < 1e-12);
    assert_true(worst_height(BAT_MESH_SCHEME_SQRT3, linear) < 1e-12);
    assert_true(worst_height(BAT_MESH_SCHEME_BUTTERFLY, bowl) < 1e-11);
    assert_true(worst_height(BAT_MESH_SCHEME_BUTTERFLY, cubic) < 1e-9);
    assert_true(worst_height(BAT_MESH_SCHEME_BUTTERFLY, quartic) > 1e-3);
    // Harmonic heights have no mean curvature, which Loop's scheme reduces; paraboloids are shifted.
    assert_true(worst_height(BAT_MESH_SCHEME_LOOP, saddle) < 1e-11);
    assert_true(worst_height(BAT_MESH_SCHEME_LOOP, bowl) > 1e-3);
}

/// Loop's regular rule is that of the box spline, which takes quadratics to quadratics: a bowl is lifted everywhere alike.
static void test_loop_lifts_a_bowl(void **state)
{
    (void)state;
    bat_mesh grid = mesh_grid(13, 13);
    for (size_t v = 0; v < grid.vertex_count; v++)
        grid.positions[3 * v + 2] = bowl(grid.positions[3 * v], grid.positions[3 * v + 1]);
    bat_mesh fine = refine(&grid, BAT_MESH_SCHEME_LOOP, 1);
    double lift = NAN;
    for (size_t v = 0; v < fine.vertex_count; v++)
    {
        const double *p = fine.positions + 3 * v;
        double row = p[1] / sqrt(0.75), column = p[0] - 0.5 * row;
        if (row < 3 || row > 9 || column < 3 || column > 9)
            continue;
        if (isnan(lift))
            lift = p[2] - bowl(p[0], p[1]);
        check_near(p[2] - bowl(p[0], p[1]), lift, 1e-11);
    }
    // Six neighbours at distance 1 of weight 1/16 each.
    check_near(lift, 6.0 / 16, 1e-11);
    bat_mesh_free(&grid);
    bat_mesh_free(&fine);
}

/// Vertices without a face stay.
static void test_isolated_vertices(void **state)
{
    (void)state;
    bat_mesh mesh = mesh_with_room(5, 4), tetrahedron = mesh_tetrahedron();
    memcpy(mesh.faces, tetrahedron.faces, 12 * sizeof *mesh.faces);
    memcpy(mesh.positions, tetrahedron.positions, 12 * sizeof *mesh.positions);
    mesh_set_vertex(&mesh, 4, 7, 8, 9);
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        bat_mesh fine = refine(&mesh, SCHEMES[s], 2);
        assert_true(fine.positions[12] == 7 && fine.positions[13] == 8 && fine.positions[14] == 9);
        bat_mesh_free(&fine);
    }
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_LOOP;
    options.limit = true;
    bat_mesh fine = refine_with(&mesh, &options);
    assert_true(fine.positions[12] == 7 && fine.positions[13] == 8 && fine.positions[14] == 9);
    double normals[15];
    check_status(bat_mesh_limit_normals(&mesh, 1, normals, NULL), BAT_OK);
    assert_true(normals[12] == 0 && normals[13] == 0 && normals[14] == 0);
    bat_mesh_free(&fine);
    bat_mesh_free(&mesh);
    bat_mesh_free(&tetrahedron);
}

/// Channels go as positions do.
static void test_channels(void **state)
{
    (void)state;
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        bat_mesh closed = mesh_irregular(9, 7, 5), grid = mesh_grid(6, 5), mesh = mesh_join(&closed, &grid);
        mesh_shake(&mesh, 0.1, 4);
        mesh.channel_count = 4;
        mesh.channels = (double *)mesh_room(mesh.vertex_count, 4 * sizeof *mesh.channels);
        mesh.channel_names = (char **)mesh_room(4, sizeof *mesh.channel_names);
        for (size_t i = 0; i < 4; i++)
        {
            mesh.channel_names[i] = (char *)mesh_room(2, 1);
            mesh.channel_names[i][0] = "abcd"[i];
        }
        for (size_t v = 0; v < mesh.vertex_count; v++)
        {
            memcpy(mesh.channels + 4 * v, mesh.positions + 3 * v, 3 * sizeof *mesh.channels);
            mesh.channels[4 * v + 3] = 1;
        }
        bat_mesh fine = refine(&mesh, SCHEMES[s], 3);
        assert_int_equal(fine.channel_count, 4);
        assert_string_equal(fine.channel_names[3], "d");
        for (size_t v = 0; v < fine.vertex_count; v++)
        {
            for (size_t i = 0; i < 3; i++)
                check_near(fine.channels[4 * v + i], fine.positions[3 * v + i], 1e-14);
            check_near(fine.channels[4 * v + 3], 1, 1e-14);
        }
        bat_mesh_free(&fine);
        bat_mesh_free(&mesh);
        bat_mesh_free(&closed);
        bat_mesh_free(&grid);
    }
}

/// Colours stay from 0 to 1 in every scheme; values beyond are not held there.
static void test_colours_stay_in_range(void **state)
{
    (void)state;
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        bat_mesh mesh = mesh_octahedron();
        bool beyond = false;
        mesh.channel_count = 2;
        mesh.channels = (double *)mesh_room(mesh.vertex_count, 2 * sizeof *mesh.channels);
        mesh.channel_names = (char **)mesh_room(2, sizeof *mesh.channel_names);
        for (size_t i = 0; i < 2; i++)
            mesh.channel_names[i] = (char *)mesh_room(2, 1);
        for (size_t v = 0; v < mesh.vertex_count; v++)
        {
            mesh.channels[2 * v] = v != 4;
            mesh.channels[2 * v + 1] = 10 * (v != 4);
        }
        bat_mesh fine = refine(&mesh, SCHEMES[s], 2);
        for (size_t v = 0; v < fine.vertex_count; v++)
        {
            assert_true(fine.channels[2 * v] >= 0 && fine.channels[2 * v] <= 1);
            beyond = beyond || fine.channels[2 * v + 1] > 10 + 1e-9;
        }
        assert_int_equal(beyond, SCHEMES[s] == BAT_MESH_SCHEME_BUTTERFLY);
        bat_mesh_free(&fine);
        bat_mesh_free(&mesh);
    }
}

/// A grid whose texture is cut along its middle column: each half has coordinates of its own there.
static bat_mesh seamed_grid(void)
{
    enum
    {
        COLUMNS = 5,
        ROWS = 4,
        SEAM = 2
    };
    bat_mesh mesh = mesh_grid(COLUMNS, ROWS);
    mesh.texture_count = mesh.vertex_count + ROWS;
    mesh.texture = (double *)mesh_room(mesh.texture_count, 2 * sizeof *mesh.texture);
    mesh.texture_faces = (uint32_t *)mesh_room(mesh.face_count, 3 * sizeof *mesh.texture_faces);
    for (size_t v = 0; v < mesh.vertex_count; v++)
        memcpy(mesh.texture + 2 * v, mesh.positions + 3 * v, 2 * sizeof *mesh.texture);
    for (size_t row = 0; row < ROWS; row++)
    {
        double *t = mesh.texture + 2 * (mesh.vertex_count + row);
        memcpy(t, mesh.positions + 3 * (row * COLUMNS + SEAM), 2 * sizeof *t);
        t[0] += 100;
    }
    for (size_t v = 0; v < mesh.vertex_count; v++)
        mesh.texture[2 * v] += v % COLUMNS > SEAM ? 100 : 0;
    for (size_t i = 0; i < 3 * mesh.face_count; i++)
    {
        uint32_t v = mesh.faces[i];
        size_t quad = i / 6 % (COLUMNS - 1);
        bool right = quad >= SEAM;
        mesh.texture_faces[i] = right && v % COLUMNS == SEAM ? (uint32_t)mesh.vertex_count + v / COLUMNS : v;
    }
    return mesh;
}

/// Texture coordinates stay linear on each side of a seam and follow faces.
static void test_texture(void **state)
{
    (void)state;
    bat_mesh mesh = seamed_grid();
    bat_mesh fine = refine(&mesh, BAT_MESH_SCHEME_MIDPOINT, 3), loop = refine(&mesh, BAT_MESH_SCHEME_LOOP, 3);
    assert_int_equal(fine.texture_count, fine.vertex_count + 3 * 8 + 1);
    size_t right = 0;
    for (size_t i = 0; i < 3 * fine.face_count; i++)
    {
        const double *p = fine.positions + 3 * (size_t)fine.faces[i];
        const double *t = fine.texture + 2 * (size_t)fine.texture_faces[i];
        bool is_right = t[0] > 50;
        check_near(t[0] - (is_right ? 100 : 0), p[0], 1e-13);
        check_near(t[1], p[1], 1e-13);
        right += is_right;
    }
    assert_int_equal(2 * right, 3 * fine.face_count);
    assert_memory_equal(fine.texture, loop.texture, 2 * fine.texture_count * sizeof *fine.texture);
    assert_memory_equal(fine.texture_faces, loop.texture_faces, 3 * fine.face_count * sizeof *fine.texture_faces);
    bat_mesh_free(&mesh);
    bat_mesh_free(&fine);
    bat_mesh_free(&loop);
}

static void check_refused(const bat_mesh *mesh, const bat_mesh_refine_options *options, bat_status expected)
{
    bat_mesh fine = {.vertex_count = 77};
    size_t fallback = 88;
    bat_error error = {0};
    check_status(bat_mesh_refine(mesh, options, &fine, &fallback, &error), expected);
    check_status(error.status, expected);
    assert_true(error.text[0] != '\0');
    assert_int_equal(fine.vertex_count, 77);
    assert_int_equal(fallback, 88);
}

static bool stop_at_once(void *context, double fraction)
{
    (void)context;
    (void)fraction;
    return false;
}

/// Square-root-three turns edges over: it leaves out what lies along them.
static void test_turned_edges_lose_texture_and_creases(void **state)
{
    (void)state;
    bat_mesh mesh = mesh_octahedron(), plain = mesh, fine, expected;
    bat_mesh_crease crease = {mesh.faces[0], mesh.faces[1], 2};
    bat_mesh_corner corner = {0, 1};
    double texture[] = {0, 0};
    uint32_t *texture_faces = calloc(3 * mesh.face_count, sizeof *texture_faces);
    mesh.creases = &crease;
    mesh.corners = &corner;
    mesh.crease_count = mesh.corner_count = mesh.texture_count = 1;
    mesh.texture = texture;
    mesh.texture_faces = texture_faces;
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_SQRT3;
    for (options.levels = 0; options.levels <= 2; options.levels += 2)
    {
        assert_int_equal(bat_mesh_refine(&mesh, &options, &fine, NULL, NULL), BAT_OK);
        assert_int_equal(bat_mesh_refine(&plain, &options, &expected, NULL, NULL), BAT_OK);
        assert_null(fine.texture_faces);
        assert_int_equal(fine.crease_count + fine.corner_count + fine.texture_count, 0);
        assert_int_equal(fine.vertex_count, expected.vertex_count);
        assert_memory_equal(fine.positions, expected.positions, 3 * fine.vertex_count * sizeof *fine.positions);
        bat_mesh_free(&fine);
        bat_mesh_free(&expected);
    }
    free(texture_faces);
    bat_mesh_free(&plain);
}

static void test_refusals(void **state)
{
    (void)state;
    bat_mesh mesh = mesh_octahedron();
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.levels = 15;
    check_refused(&mesh, &options, BAT_TOO_LARGE);
    options.levels = 33;
    check_refused(&mesh, &options, BAT_INVALID_ARGUMENT);
    options.levels = 32;
    options.scheme = BAT_MESH_SCHEME_SQRT3;
    check_refused(&mesh, &options, BAT_TOO_LARGE);
    options = bat_mesh_refine_defaults();
    options.crease_angle = NAN;
    check_refused(&mesh, &options, BAT_INVALID_ARGUMENT);
    options.crease_angle = 1;
    options.scheme = BAT_MESH_SCHEME_BUTTERFLY;
    check_refused(&mesh, &options, BAT_UNSUPPORTED);
    options = bat_mesh_refine_defaults();
    options.then = BAT_MESH_SCHEME_SQRT3;
    check_refused(&mesh, &options, BAT_INVALID_ARGUMENT);
    options = bat_mesh_refine_defaults();
    options.scheme = (bat_mesh_scheme)17;
    check_refused(&mesh, &options, BAT_INVALID_ARGUMENT);
    options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_SQRT3;
    options.limit = true;
    check_refused(&mesh, &options, BAT_UNSUPPORTED);
    options = bat_mesh_refine_defaults();
    options.progress.report = stop_at_once;
    check_refused(&mesh, &options, BAT_CANCELLED);
    // Octahedron: 0 and 1 lie opposite each other.
    bat_mesh_crease crease = {0, 1, 2};
    mesh.creases = &crease;
    mesh.crease_count = 1;
    options = bat_mesh_refine_defaults();
    check_refused(&mesh, &options, BAT_INVALID_ARGUMENT);
    mesh.creases = NULL;
    mesh.crease_count = 0;
    // Found by fuzzing: sums of such coordinates overflow to NaN.
    double kept = mesh.positions[0];
    mesh.positions[0] = 1.4e308;
    check_refused(&mesh, &options, BAT_INVALID_POINT);
    mesh.positions[0] = kept;
    mesh.faces[0] = mesh.faces[1];
    check_refused(&mesh, &options, BAT_INVALID_POINT);
    bat_mesh_free(&mesh);
}

static void test_no_levels(void **state)
{
    (void)state;
    bat_mesh mesh = seamed_grid();
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        if (SCHEMES[s] == BAT_MESH_SCHEME_SQRT3)
            continue;
        bat_mesh same = refine(&mesh, SCHEMES[s], 0);
        check_same_mesh(&same, &mesh, 0);
        assert_memory_equal(same.texture_faces, mesh.texture_faces, 3 * mesh.face_count * sizeof *mesh.texture_faces);
        bat_mesh_free(&same);
    }
    bat_mesh_free(&mesh);
}

/// A rule that adds the number of levels to the height of midpoints.
static bat_status lift(const bat_mesh_rule *rule, const bat_mesh *coarse, const bat_mesh_connectivity *connectivity,
                       size_t levels, const bat_mesh_refine_options *options, bat_mesh *fine, size_t *fallback,
                       bat_error *error)
{
    assert_true(options->fairness == 0.25);
    (void)error;
    assert_ptr_equal(rule->context, coarse);
    assert_int_equal(connectivity->vertex_count, coarse->vertex_count);
    assert_null(fine->texture);
    bat_mesh halved = refine(coarse, BAT_MESH_SCHEME_MIDPOINT, levels);
    assert_int_equal(halved.vertex_count, fine->vertex_count);
    assert_memory_equal(halved.faces, fine->faces, 3 * fine->face_count * sizeof *fine->faces);
    for (size_t i = 0; i < 3 * fine->vertex_count; i++)
        fine->positions[i] = halved.positions[i] + (double)levels;
    bat_mesh_free(&halved);
    *fallback = 5;
    return BAT_OK;
}

/// The rule makes its levels, the other scheme the remaining ones.
static void test_learned(void **state)
{
    (void)state;
    bat_mesh mesh = seamed_grid();
    bat_mesh_rule rule = {.levels = 2, .context = &mesh, .refine = lift};
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = BAT_MESH_SCHEME_LEARNED;
    options.then = BAT_MESH_SCHEME_MIDPOINT;
    options.rule = &rule;
    for (size_t levels = 0; levels <= 4; levels++)
    {
        options.levels = levels;
        size_t fallback = 1;
        bat_mesh fine, halved = refine(&mesh, BAT_MESH_SCHEME_MIDPOINT, levels);
        check_status(bat_mesh_refine(&mesh, &options, &fine, &fallback, NULL), BAT_OK);
        assert_int_equal(fallback, levels == 0 ? 0 : 5);
        for (size_t i = 0; i < 3 * halved.vertex_count; i++)
            halved.positions[i] += levels < 2 ? (double)levels : 2;
        check_same_mesh(&fine, &halved, 1e-13);
        assert_memory_equal(fine.texture_faces, halved.texture_faces, 3 * fine.face_count * sizeof *fine.texture_faces);
        bat_mesh_free(&fine);
        bat_mesh_free(&halved);
    }
    bat_mesh_free(&mesh);
}

static void test_boundary_stands_alone(void **state)
{
    (void)state;
    // Interior vertices do not influence the boundary.
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        bat_mesh grid = mesh_grid(6, 5), other = mesh_grid(6, 5);
        for (size_t v = 0; v < grid.vertex_count; v++)
            if (v % 6 > 0 && v % 6 < 5 && v / 6 > 0 && v / 6 < 4)
                other.positions[3 * v + 2] = 1;
        bat_mesh one = refine(&grid, SCHEMES[s], 4), two = refine(&other, SCHEMES[s], 4);
        bat_mesh_connectivity links;
        check_status(bat_mesh_connect(&one, &links, NULL), BAT_OK);
        size_t inside = 0;
        for (uint32_t v = 0; v < one.vertex_count; v++)
        {
            bool moved = memcmp(one.positions + 3 * v, two.positions + 3 * v, 3 * sizeof *one.positions) != 0;
            if (links.twin[links.first[v]] == BAT_MESH_NONE)
                assert_false(moved);
            inside += moved;
        }
        assert_true(inside > one.vertex_count / 2);
        bat_mesh_connectivity_free(&links);
        bat_mesh_free(&grid);
        bat_mesh_free(&other);
        bat_mesh_free(&one);
        bat_mesh_free(&two);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_split_links),
        cmocka_unit_test(test_split_links_of_faces_without_edges),
        cmocka_unit_test(test_levels_add_up),
        cmocka_unit_test(test_affine_maps),
        cmocka_unit_test(test_planes_stay),
        cmocka_unit_test(test_topology_stays),
        cmocka_unit_test(test_vertices_stay),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_renumbering),
        cmocka_unit_test(test_polynomials),
        cmocka_unit_test(test_loop_lifts_a_bowl),
        cmocka_unit_test(test_isolated_vertices),
        cmocka_unit_test(test_channels),
        cmocka_unit_test(test_colours_stay_in_range),
        cmocka_unit_test(test_texture),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_no_levels),
        cmocka_unit_test(test_learned),
        cmocka_unit_test(test_boundary_stands_alone),
        cmocka_unit_test(test_turned_edges_lose_texture_and_creases),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
