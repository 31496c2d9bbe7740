#include "decimate_helpers.h"
#include "polygon_makers.h"

#include "batten/mesh_measure.h"
#include "batten/mesh_refine.h"
#include "mesh/decimate/collapse.h"
#include "mesh/decimate/collapse_error.h"

static bat_mesh decimate(const bat_mesh *fine, const bat_mesh_decimate_options *options, bool mapped)
{
    bat_mesh coarse;
    bat_mesh_map *map = NULL;
    bat_error error = {0};
    if (bat_mesh_decimate(fine, options, &coarse, mapped ? &map : NULL, &error) != BAT_OK)
        fail_msg("%s", error.text);
    assert_int_equal(map != NULL, mapped);
    bat_mesh_map_free(map);
    return coarse;
}

enum
{
    METHODS = BAT_MESH_DECIMATE_METHOD_FAST + 1
};

static bat_mesh_decimate_options options_to(size_t vertices, size_t candidates)
{
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    options.vertices = vertices;
    options.candidates = candidates;
    return options;
}

/// Every option keeps the topology and reaches the number of vertices.
static void check_topology(bat_mesh *fine, size_t vertices)
{
    shape_topology before = shape_topology_of(fine);
    for (int way = 0; way < 4 * METHODS; way++)
    {
        bat_mesh_decimate_options options = options_to(vertices, way % 4 < 2 ? 0 : 30);
        options.method = (bat_mesh_decimate_method)(way / 4);
        bat_mesh coarse = decimate(fine, &options, way % 2 == 1);
        shape_topology after = shape_topology_of(&coarse);
        assert_int_equal(after.euler, before.euler);
        assert_int_equal(after.loops, before.loops);
        assert_int_equal(coarse.vertex_count, vertices);
        assert_int_equal(bat_mesh_check(&coarse, NULL), BAT_OK);
        bat_mesh_free(&coarse);
    }
    bat_mesh_free(fine);
}

static void test_topology_stays(void **state)
{
    (void)state;
    bat_mesh sphere = shape_sphere(12, 0, 1), rough = shape_sphere(12, 0.05, 2), torus = shape_torus(40, 16, 0.4);
    bat_mesh sheet = shape_sheet(24, 0.2, false), holed = shape_sheet(24, 0.2, true);
    check_topology(&sphere, 60);
    check_topology(&rough, 60);
    check_topology(&torus, 60);
    check_topology(&sheet, 40);
    check_topology(&holed, 60);
}

/// Two components in one mesh both remain; vertices without a face vanish.
static void test_pieces_stay(void **state)
{
    (void)state;
    bat_mesh small = shape_sphere(3, 0, 1), large = shape_torus(40, 16, 0.4);
    bat_mesh both = shape_room(small.vertex_count + large.vertex_count + 2, small.face_count + large.face_count);
    memset(both.positions, 0, both.vertex_count * 3 * sizeof(double));
    memcpy(both.positions + 3, small.positions, small.vertex_count * 3 * sizeof(double));
    memcpy(both.positions + 3 * (small.vertex_count + 2), large.positions, large.vertex_count * 3 * sizeof(double));
    for (size_t i = 0; i < 3 * both.face_count; i++)
        both.faces[i] = i < 3 * small.face_count ? small.faces[i] + 1
                                                 : large.faces[i - 3 * small.face_count] + (uint32_t)small.vertex_count + 2;
    bat_mesh_decimate_options options = options_to(0, 0);
    options.min_normal = -1;
    options.min_quality = 0;
    bat_mesh coarse = decimate(&both, &options, false);
    assert_int_equal(shape_topology_of(&coarse).euler, 2);
    // A sphere needs 4 vertices, a torus 7 (Möbius, Császár).
    assert_true(coarse.vertex_count >= 11);
    bat_mesh_free(&coarse);
    bat_mesh_free(&small);
    bat_mesh_free(&large);
    bat_mesh_free(&both);
}

static void test_planes_decimate_exactly(void **state)
{
    (void)state;
    for (int way = 0; way < 2 * METHODS; way++)
    {
        bat_mesh sheet = shape_sheet(20, 0, false);
        bat_mesh_decimate_options options = options_to(20, 0);
        options.method = (bat_mesh_decimate_method)(way / 2);
        bat_mesh coarse = decimate(&sheet, &options, way % 2 == 1);
        assert_int_equal(coarse.vertex_count, 20);
        for (size_t v = 0; v < coarse.vertex_count; v++)
            check_near(0.8 * coarse.positions[3 * v] - 0.6 * coarse.positions[3 * v + 2], 0, 1e-14);
        // Faces keep their orientation, so equal areas mean the same square.
        check_near(shape_area(&coarse), 1, 1e-12);
        bat_mesh_free(&coarse);
        bat_mesh_free(&sheet);
    }
}

static void test_sharp_edges_stay(void **state)
{
    (void)state;
    for (int way = 0; way < 2 * METHODS; way++)
    {
        bat_mesh cube = shape_cube(10);
        check_near(shape_volume(&cube), 1, 1e-12);
        bat_mesh_decimate_options options = options_to(30, 0);
        options.method = (bat_mesh_decimate_method)(way / 2);
        bat_mesh coarse = decimate(&cube, &options, way % 2 == 1);
        assert_int_equal(coarse.vertex_count, 30);
        check_near(shape_volume(&coarse), 1, 1e-12);
        check_near(shape_area(&coarse), 6, 1e-12);
        size_t corners = 0;
        for (size_t v = 0; v < coarse.vertex_count; v++)
        {
            bool corner = true;
            for (int c = 0; c < 3; c++)
                corner &= coarse.positions[3 * v + (size_t)c] == 0 || coarse.positions[3 * v + (size_t)c] == 1;
            corners += corner;
        }
        assert_int_equal(corners, 8);
        bat_mesh_free(&coarse);
        bat_mesh_free(&cube);
    }
}

/// The error of quadrics on a sphere is proportional to the area of the faces: half the vertices, twice the lost volume.
static void test_error_follows_size(void **state)
{
    (void)state;
    bat_mesh sphere = shape_sphere(24, 0, 1);
    double lost[2];
    for (size_t i = 0; i < 2; i++)
    {
        bat_mesh_decimate_options options = options_to(400 / (i + 1), 0);
        options.method = BAT_MESH_DECIMATE_METHOD_QUADRIC;
        bat_mesh coarse = decimate(&sphere, &options, false);
        lost[i] = fabs(shape_volume(&sphere) - shape_volume(&coarse));
        for (size_t v = 0; v < coarse.vertex_count; v++)
            check_near(shape_distance(coarse.positions + 3 * v, (const double[3]){0}), 1, 0.02);
        bat_mesh_free(&coarse);
    }
    // Let equilateral faces of area A = 4 pi / 796 and edge L have their corners on the sphere. Their mean distance from it
    // is L^2 / 8 = A / (2 sqrt(3)); minimizing the error does better.
    assert_true(lost[0] < 4 * 3.14159265358979 * (4 * 3.14159265358979 / 796) / (2 * sqrt(3)));
    check_near(lost[1] / lost[0], 2, 0.4);
    bat_mesh_free(&sphere);
}

/// Memoryless decimation preserves the volume, and is nearer to the surface than that by quadrics. Fast decimation is nearly
/// as near.
static void test_volume_stays(void **state)
{
    (void)state;
    bat_mesh sphere = shape_sphere(24, 0, 1);
    double distances[METHODS];
    for (int method = 0; method < METHODS; method++)
    {
        bat_mesh_distance distance;
        bat_mesh_decimate_options options = options_to(200, 0);
        options.method = (bat_mesh_decimate_method)method;
        bat_mesh coarse = decimate(&sphere, &options, false);
        assert_int_equal(bat_mesh_compare(&coarse, &sphere, NULL, &distance, NULL), BAT_OK);
        distances[method] = distance.mean;
        if (options.method == BAT_MESH_DECIMATE_METHOD_MEMORYLESS)
            check_relative(shape_volume(&coarse), shape_volume(&sphere), 1e-10);
        bat_mesh_free(&coarse);
    }
    assert_true(distances[BAT_MESH_DECIMATE_METHOD_MEMORYLESS] < 0.9 * distances[BAT_MESH_DECIMATE_METHOD_QUADRIC]);
    assert_true(distances[BAT_MESH_DECIMATE_METHOD_FAST] < 1.15 * distances[BAT_MESH_DECIMATE_METHOD_MEMORYLESS]);
    bat_mesh_free(&sphere);
}

/// Targets by faces and by a ratio are reached; a target above the mesh's own number and two targets are refused.
static void test_targets(void **state)
{
    (void)state;
    bat_mesh sphere = shape_sphere(12, 0.05, 1), sheet = shape_sheet(24, 0.2, false), coarse;
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    options.faces = 100;
    coarse = decimate(&sphere, &options, false);
    assert_int_equal(coarse.face_count, 100);
    bat_mesh_free(&coarse);
    coarse = decimate(&sheet, &options, true);
    assert_true(coarse.face_count == 100 || coarse.face_count == 99);
    bat_mesh_free(&coarse);
    options.faces = 0;
    options.ratio = 0.1;
    coarse = decimate(&sphere, &options, false);
    assert_true(coarse.face_count <= sphere.face_count / 10 && coarse.face_count + 2 > sphere.face_count / 10);
    bat_mesh_free(&coarse);
    bat_error error = {0};
    options.faces = 100;
    assert_int_equal(bat_mesh_decimate(&sphere, &options, &coarse, NULL, &error), BAT_INVALID_ARGUMENT);
    options = bat_mesh_decimate_defaults();
    options.faces = sphere.face_count + 1;
    assert_int_equal(bat_mesh_decimate(&sphere, &options, &coarse, NULL, &error), BAT_INVALID_ARGUMENT);
    options = options_to(sphere.vertex_count + 1, 0);
    assert_int_equal(bat_mesh_decimate(&sphere, &options, &coarse, NULL, &error), BAT_INVALID_ARGUMENT);
    bat_mesh_free(&sphere);
    bat_mesh_free(&sheet);
}

/// The measured distance keeps the bound, with fewer vertices for a greater bound, for any number of threads.
static void test_bounded_distance(void **state)
{
    (void)state;
    static const double BOUNDS[] = {0.1, 0.01};
    bat_mesh sheet = shape_sheet(20, 0.2, true);
    size_t before[2] = {0}; // of each method
    for (size_t i = 0; i < 2; i++)
        for (int method = 0; method < 2; method++)
        {
            double proven = -1;
            bat_mesh_distance distance;
            bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
            options.method = (bat_mesh_decimate_method)method;
            options.tolerance = BOUNDS[i];
            options.distance = &proven;
            options.threads = 1;
            bat_mesh coarse = decimate(&sheet, &options, method == 1);
            assert_int_equal(bat_mesh_compare(&coarse, &sheet, NULL, &distance, NULL), BAT_OK);
            assert_true(proven <= BOUNDS[i]);
            assert_true(distance.hausdorff <= proven);
            assert_true(coarse.vertex_count < sheet.vertex_count / 2);
            assert_true(coarse.vertex_count > before[method]);
            before[method] = coarse.vertex_count;
            bat_mesh_free(&coarse);
        }
    bat_mesh_free(&sheet);
}

/// The fraction of the last report; stops after the first half of the first run, while distances are measured.
static bool stop_in_measurement(void *context, double fraction)
{
    double *last = context;
    assert_true(fraction >= *last && fraction <= 1);
    *last = fraction;
    return fraction <= 0.25;
}

/// Flat faces between sharp edges: a bound far below the size of the faces is proven, and they collapse. The caller can stop
/// the measurement.
static void test_bounded_flat_faces(void **state)
{
    (void)state;
    bat_mesh box = polygon_cube();
    bat_mesh cube, fine, coarse;
    bat_mesh_refine_options refining = bat_mesh_refine_defaults();
    refining.scheme = BAT_MESH_SCHEME_MIDPOINT;
    refining.levels = 5;
    assert_int_equal(bat_mesh_triangulate(&box, &cube, NULL), BAT_OK);
    assert_int_equal(bat_mesh_refine(&cube, &refining, &fine, NULL, NULL), BAT_OK);
    for (size_t i = 0; i < 3 * fine.vertex_count; i++)
        fine.positions[i] += 2e-5 * sin((double)(7 * i));
    double proven = -1, last = 0;
    bat_error error = {0};
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    options.tolerance = 3e-4;
    options.distance = &proven;
    coarse = decimate(&fine, &options, false);
    assert_true(proven > 0 && proven <= options.tolerance);
    assert_true(coarse.face_count < fine.face_count / 10);
    bat_mesh_free(&coarse);
    options.progress = (bat_progress){stop_in_measurement, &last};
    assert_int_equal(bat_mesh_decimate(&fine, &options, &coarse, NULL, &error), BAT_CANCELLED);
    assert_non_null(strstr(error.text, "while its distance was measured"));
    assert_true(last > 0.25);
    bat_mesh_free(&fine);
    bat_mesh_free(&cube);
    bat_mesh_free(&box);
}

/// A torus with its angles as texture, which jumps along two circles, and with its height as a channel.
static bat_mesh textured_torus(size_t n, size_t m)
{
    bat_mesh torus = shape_torus(n, m, 0.4);
    torus.texture_count = (n + 1) * (m + 1);
    torus.texture = malloc(2 * torus.texture_count * sizeof(double));
    torus.texture_faces = malloc(3 * torus.face_count * sizeof(uint32_t));
    torus.channels = malloc(torus.vertex_count * sizeof(double));
    torus.channel_names = calloc(1, sizeof *torus.channel_names);
    torus.channel_names[0] = calloc(2, 1);
    torus.channel_names[0][0] = 'h';
    torus.channel_count = 1;
    for (size_t v = 0; v < torus.vertex_count; v++)
        torus.channels[v] = 100 + 7 * torus.positions[3 * v + 2];
    for (size_t i = 0; i <= n; i++)
        for (size_t j = 0; j <= m; j++)
        {
            torus.texture[2 * (i * (m + 1) + j)] = (double)i / (double)n;
            torus.texture[2 * (i * (m + 1) + j) + 1] = (double)j / (double)m;
        }
    for (size_t h = 0; h < 3 * torus.face_count; h++)
    {
        // The first corner of a cell tells on which side of a seam it lies.
        size_t corner = torus.faces[h], cell = torus.faces[h / 6 * 6], i = corner / m, j = corner % m;
        i = i == 0 && cell / m == n - 1 ? n : i;
        j = j == 0 && cell % m == m - 1 ? m : j;
        torus.texture_faces[h] = (uint32_t)(i * (m + 1) + j);
    }
    return torus;
}

static double texture_area(const bat_mesh *mesh, size_t face)
{
    const uint32_t *at = mesh->texture_faces + 3 * face;
    const double *a = mesh->texture + 2 * (size_t)at[0], *b = mesh->texture + 2 * (size_t)at[1],
                 *c = mesh->texture + 2 * (size_t)at[2];
    return ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
}

/// No face of the texture turns over, its area stays, seams stay seams, and channels follow the surface.
static void test_attributes(void **state)
{
    (void)state;
    bat_mesh torus = textured_torus(60, 30);
    for (int way = 0; way < 2 * METHODS; way++)
    {
        bat_mesh_decimate_options options = options_to(300, 0);
        options.method = (bat_mesh_decimate_method)(way / 2);
        bat_mesh coarse = decimate(&torus, &options, way % 2 == 1);
        assert_int_equal(coarse.vertex_count, 300);
        assert_int_equal(bat_mesh_check(&coarse, NULL), BAT_OK);
        assert_true(coarse.texture_count > coarse.vertex_count);
        double area = 0;
        for (size_t f = 0; f < coarse.face_count; f++)
        {
            assert_true(texture_area(&coarse, f) > 0);
            area += texture_area(&coarse, f);
        }
        check_near(area, 1, 0.03);
        assert_string_equal(coarse.channel_names[0], "h");
        for (size_t v = 0; v < coarse.vertex_count; v++)
            check_near(coarse.channels[v], 100 + 7 * coarse.positions[3 * v + 2], 0.2);
        bat_mesh_free(&coarse);
        options.attributes = 0;
        coarse = decimate(&torus, &options, false);
        assert_null(coarse.texture);
        assert_int_equal(coarse.channel_count, 0);
        bat_mesh_free(&coarse);
    }
    // Without a collapse, all values return exactly.
    bat_mesh_decimate_options options = options_to(torus.vertex_count, 0);
    bat_mesh same = decimate(&torus, &options, false);
    for (size_t h = 0; h < 3 * torus.face_count; h++)
        for (size_t k = 0; k < 2; k++)
            check_near(same.texture[2 * same.texture_faces[h] + k], torus.texture[2 * torus.texture_faces[h] + k], 0);
    for (size_t v = 0; v < torus.vertex_count; v++)
        check_near(same.channels[v], torus.channels[v], 0);
    bat_mesh_free(&same);
    bat_mesh_free(&torus);
}

/// Values from 0 to 1 stay there, however rough they are.
static void test_values_stay_in_range(void **state)
{
    (void)state;
    bat_mesh torus = textured_torus(40, 20);
    for (size_t v = 0; v < torus.vertex_count; v++)
        torus.channels[v] = (double)(v * v % 7 < 3);
    for (int way = 0; way < METHODS; way++)
    {
        bat_mesh_decimate_options options = options_to(100, 0);
        options.method = (bat_mesh_decimate_method)way;
        bat_mesh coarse = decimate(&torus, &options, false);
        for (size_t v = 0; v < coarse.vertex_count; v++)
            assert_true(coarse.channels[v] >= 0 && coarse.channels[v] <= 1);
        bat_mesh_free(&coarse);
    }
    bat_mesh_free(&torus);
}

static void assert_same(const bat_mesh *a, const bat_mesh *b, bool same)
{
    bool equal = a->vertex_count == b->vertex_count && a->face_count == b->face_count &&
                 memcmp(a->positions, b->positions, a->vertex_count * 3 * sizeof(double)) == 0 &&
                 memcmp(a->faces, b->faces, a->face_count * 3 * sizeof(uint32_t)) == 0;
    assert_int_equal(equal, same);
}

static void test_seeds(void **state)
{
    (void)state;
    bat_mesh rough = shape_sphere(10, 0.05, 3);
    bat_mesh_decimate_options options = options_to(80, 100);
    bat_mesh one = decimate(&rough, &options, true), again = decimate(&rough, &options, true);
    options.seed = 2;
    bat_mesh other = decimate(&rough, &options, true);
    assert_same(&one, &again, true);
    assert_same(&one, &other, false);
    bat_mesh_free(&one);
    bat_mesh_free(&again);
    // More candidates than edges are all edges.
    options.candidates = SIZE_MAX;
    one = decimate(&rough, &options, true);
    options.candidates = 0;
    again = decimate(&rough, &options, true);
    assert_same(&one, &again, true);
    bat_mesh_free(&one);
    bat_mesh_free(&again);
    bat_mesh_free(&other);
    bat_mesh_free(&rough);
}

/// Concurrent decimations are independent.
static void test_threads(void **state)
{
    (void)state;
    enum
    {
        COUNT = 6
    };
    bat_mesh rough = shape_sphere(10, 0.05, 3), alone[COUNT], together[COUNT];
    for (int i = 0; i < COUNT; i++)
    {
        bat_mesh_decimate_options options = options_to(80, 100);
        options.seed = (uint64_t)i;
        alone[i] = decimate(&rough, &options, true);
    }
#pragma omp parallel for schedule(dynamic) num_threads(3)
    for (int i = 0; i < COUNT; i++)
    {
        bat_mesh_decimate_options options = options_to(80, 100);
        options.seed = (uint64_t)i;
        together[i] = decimate(&rough, &options, true);
    }
    for (int i = 0; i < COUNT; i++)
    {
        assert_same(&alone[i], &together[i], true);
        bat_mesh_free(&alone[i]);
        bat_mesh_free(&together[i]);
    }
    bat_mesh_free(&rough);
}

/// Coincident vertices and faces without area: only the number of vertices changes.
static void test_degenerate_faces(void **state)
{
    (void)state;
    bat_mesh snapped = shape_sphere(16, 0, 1), flat = shape_torus(30, 12, 0.4), point = shape_torus(30, 12, 0.4);
    for (size_t i = 0; i < 3 * snapped.vertex_count; i++)
        snapped.positions[i] = round(5 * snapped.positions[i]) / 5;
    for (size_t v = 0; v < flat.vertex_count; v++)
        flat.positions[3 * v + 2] = 0;
    memset(point.positions, 0, 3 * point.vertex_count * sizeof(double));
    check_topology(&snapped, 60);
    check_topology(&flat, 60);
    check_topology(&point, 60);
}

/// Vertices of a thousand faces, whose rings are too large at first.
static void test_hubs(void **state)
{
    (void)state;
    enum
    {
        SPOKES = 1000
    };
    bat_mesh bipyramid = shape_room(SPOKES + 2, 2 * SPOKES);
    for (uint32_t i = 0; i < SPOKES; i++)
    {
        double angle = 6.28318530717958647692 * i / SPOKES;
        const double at[3] = {cos(angle), sin(angle), 0};
        const uint32_t faces[6] = {i, (i + 1) % SPOKES, SPOKES, (i + 1) % SPOKES, i, SPOKES + 1};
        memcpy(bipyramid.positions + 3 * (size_t)i, at, sizeof at);
        memcpy(bipyramid.faces + 6 * (size_t)i, faces, sizeof faces);
    }
    const double tips[6] = {0, 0, 1, 0, 0, -1};
    memcpy(bipyramid.positions + (size_t)3 * SPOKES, tips, sizeof tips);
    check_topology(&bipyramid, 20);
}

/// Scaling by powers of two only scales the result, exactly.
static void test_scales(void **state)
{
    (void)state;
    bat_mesh rough = shape_sphere(10, 0.05, 3), scaled;
    assert_int_equal(bat_mesh_copy(&rough, &scaled, NULL), BAT_OK);
    for (size_t i = 0; i < 3 * scaled.vertex_count; i++)
        scaled.positions[i] *= 0x1p30;
    bat_mesh_decimate_options options = options_to(80, 0);
    bat_mesh one = decimate(&rough, &options, true), other = decimate(&scaled, &options, true);
    for (size_t i = 0; i < 3 * other.vertex_count; i++)
        other.positions[i] *= 0x1p-30;
    assert_same(&one, &other, true);
    bat_mesh_free(&one);
    bat_mesh_free(&other);
    bat_mesh_free(&scaled);
    bat_mesh_free(&rough);
}

/// Faces of random decimations keep the bounds; the faces of the sphere are well above them.
static void test_bounds_hold(void **state)
{
    (void)state;
    bat_mesh sphere = shape_sphere(12, 0, 1);
    for (uint64_t seed = 1; seed <= 5; seed++)
    {
        bat_mesh_decimate_options options = options_to(50, 10);
        options.seed = seed;
        options.min_quality = 0.4;
        bat_mesh coarse = decimate(&sphere, &options, true);
        for (size_t f = 0; f < coarse.face_count; f++)
        {
            double vector[3], squares = 0, area = 0;
            shape_vector(&coarse, f, vector);
            for (size_t c = 0; c < 3; c++)
            {
                double edge = shape_distance(shape_corner(&coarse, f, c), shape_corner(&coarse, f, (c + 1) % 3));
                squares += edge * edge;
                area += vector[c] * vector[c];
            }
            assert_true(sqrt(12) * sqrt(area) / squares >= 0.4 - 1e-12);
        }
        bat_mesh_free(&coarse);
    }
    bat_mesh_free(&sphere);
}

/// A crease across a flat sheet remains a straight line between the boundaries; a corner does not move.
static void test_creases_and_corners_stay(void **state)
{
    (void)state;
    enum
    {
        N = 16
    };
    bat_mesh sheet = shape_sheet(N, 0, false);
    sheet.creases = calloc(N, sizeof *sheet.creases);
    sheet.corners = calloc(1, sizeof *sheet.corners);
    assert_non_null(sheet.creases);
    assert_non_null(sheet.corners);
    sheet.crease_count = N;
    sheet.corner_count = 1;
    for (uint32_t j = 0; j < N; j++)
        sheet.creases[j] = (bat_mesh_crease){5 * (N + 1) + j, 5 * (N + 1) + j + 1, 2.5};
    sheet.corners[0] = (bat_mesh_corner){9 * (N + 1) + 7, 3};
    for (int mapped = 0; mapped < 2; mapped++)
    {
        bat_mesh_decimate_options options = options_to(25, 0);
        bat_mesh coarse = decimate(&sheet, &options, mapped == 1);
        assert_int_equal(coarse.vertex_count, 25);
        double length = 0;
        for (size_t i = 0; i < coarse.crease_count; i++)
        {
            const double *a = coarse.positions + 3 * (size_t)coarse.creases[i].a,
                         *b = coarse.positions + 3 * (size_t)coarse.creases[i].b;
            check_near(a[0], 0.6 * 5 / N, 1e-12);
            check_near(coarse.creases[i].sharpness, 2.5, 0);
            length += shape_distance(a, b);
        }
        assert_true(coarse.crease_count < N);
        check_near(length, 1, 1e-12);
        assert_int_equal(coarse.corner_count, 1);
        const double *corner = coarse.positions + 3 * (size_t)coarse.corners[0].vertex;
        assert_true(shape_distance(corner, sheet.positions + 3 * (size_t)sheet.corners[0].vertex) == 0);
        check_near(coarse.corners[0].sharpness, 3, 0);
        bat_mesh_free(&coarse);
    }
    bat_mesh_free(&sheet);
}

/// Whether the edge between two vertices may be collapsed.
static bool may_collapse(const uint32_t *faces, size_t count, size_t vertices, uint32_t a, uint32_t b)
{
    double positions[30];
    uint32_t copy[60];
    for (size_t i = 0; i < 3 * vertices; i++)
        positions[i] = (double)(i * i % 7);
    memcpy(copy, faces, 3 * count * sizeof *copy);
    bat_mesh mesh = {.positions = positions, .vertex_count = vertices, .faces = copy, .face_count = count};
    collapse_mesh topology;
    collapse_ring ring;
    assert_int_equal(collapse_mesh_make(&mesh, false, &topology, NULL), BAT_OK);
    uint32_t h = 0;
    while (!(copy[h] == a && copy[bat_mesh_next(h)] == b) && !(copy[h] == b && copy[bat_mesh_next(h)] == a))
        h++;
    bool may = collapse_ring_find(&topology, topology.edge[h], &ring);
    collapse_mesh_free(&topology);
    return may;
}

static void test_link_condition(void **state)
{
    (void)state;
    const uint32_t tetrahedron[] = {0, 1, 2, 0, 2, 3, 0, 3, 1, 3, 2, 1};
    assert_false(may_collapse(tetrahedron, 4, 4, 0, 1));
    // Two tetrahedra on one another: the edges of their common triangle have a third common neighbour.
    const uint32_t bipyramid[] = {0, 1, 3, 1, 2, 3, 2, 0, 3, 1, 0, 4, 2, 1, 4, 0, 2, 4};
    assert_false(may_collapse(bipyramid, 6, 5, 0, 1));
    assert_true(may_collapse(bipyramid, 6, 5, 0, 3));
    // A square: its diagonal joins two boundary vertices; its sides may be collapsed.
    const uint32_t square[] = {0, 1, 2, 0, 2, 3};
    assert_false(may_collapse(square, 2, 4, 0, 2));
    assert_true(may_collapse(square, 2, 4, 0, 1));
    const uint32_t triangle[] = {0, 1, 2};
    assert_false(may_collapse(triangle, 1, 3, 0, 1));
    // A tetrahedron with one side open: its hole must not close.
    const uint32_t open[] = {0, 1, 2, 0, 2, 3, 0, 3, 1};
    assert_false(may_collapse(open, 3, 4, 1, 2));
    assert_true(may_collapse(open, 3, 4, 0, 2));
    // An annulus of six faces between triangles 0 1 2 and 3 4 5: no boundary edge may be collapsed.
    const uint32_t annulus[] = {0, 1, 3, 1, 4, 3, 1, 2, 4, 2, 5, 4, 2, 0, 5, 0, 3, 5};
    assert_false(may_collapse(annulus, 6, 6, 0, 1));
    assert_false(may_collapse(annulus, 6, 6, 1, 3));
}

/// Updated memoryless sums are those of the present faces.
static void check_sums(const collapse_mesh *mesh, error_vertex *vertices)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
    {
        const error_vertex updated = vertices[v];
        if (mesh->first[v] == BAT_MESH_NONE)
            continue;
        memoryless_vertex_set(mesh, vertices, v);
        const double *a = &updated.planes.xx, *b = &vertices[v].planes.xx;
        for (size_t k = 0; k < sizeof(quadric) / sizeof *a; k++)
            check_near(a[k], b[k], 1e-12);
    }
}

/// After random collapses the faces and twins of every ring are a manifold, equal to one connected from scratch, and the
/// memoryless sums are those of the faces.
static void test_random_collapses_keep_the_structure(void **state)
{
    (void)state;
    bat_mesh shapes[] = {shape_torus(14, 9, 0.4), shape_sheet(12, 0.1, true), shape_sphere(5, 0, 1)};
    bat_random random = bat_random_seed(7);
    for (size_t s = 0; s < 3; s++)
    {
        collapse_mesh topology;
        collapse_ring ring;
        assert_int_equal(collapse_mesh_make(&shapes[s], false, &topology, NULL), BAT_OK);
        long euler = shape_topology_of(&shapes[s]).euler;
        error_vertex *vertices = calloc(topology.vertex_count, sizeof *vertices);
        assert_non_null(vertices);
        for (size_t v = 0; v < topology.vertex_count; v++)
            memcpy(vertices[v].position, shapes[s].positions + 3 * v, sizeof vertices[v].position);
        for (uint32_t v = 0; v < topology.vertex_count; v++)
            memoryless_vertex_set(&topology, vertices, v);
        for (int i = 0; i < 3000; i++)
        {
            uint32_t edge = (uint32_t)(bat_random_bits(&random) % topology.edge_count), gone[3], count;
            if (topology.half_edge[edge] == BAT_MESH_NONE || !collapse_ring_find(&topology, edge, &ring))
                continue;
            size_t faces = topology.faces_left;
            double position[3];
            for (int c = 0; c < 3; c++)
                position[c] = bat_random_uniform(&random) - 0.5;
            memoryless_merge(vertices, &ring, position);
            collapse_apply(&topology, &ring, gone, &count);
            assert_int_equal(count, 1 + ring.vanishing);
            assert_int_equal(topology.faces_left, faces - ring.vanishing);
            bat_mesh left = shape_room(topology.vertex_count, topology.faces_left);
            left.face_count = 0;
            memset(left.positions, 0, 3 * left.vertex_count * sizeof(double));
            for (size_t f = 0; f < topology.face_count; f++)
                if (topology.corner[3 * f] != BAT_MESH_NONE)
                    memcpy(left.faces + 3 * left.face_count++, topology.corner + 3 * f, 3 * sizeof(uint32_t));
            assert_int_equal(left.face_count, topology.faces_left);
            assert_int_equal(shape_topology_of(&left).euler, euler);
            bat_mesh_free(&left);
        }
        assert_true(topology.vertices_left < shapes[s].vertex_count / 2);
        check_sums(&topology, vertices);
        free(vertices);
        collapse_mesh_free(&topology);
        bat_mesh_free(&shapes[s]);
    }
}

static void test_queue(void **state)
{
    (void)state;
    enum
    {
        EDGES = 200
    };
    edge_queue queue;
    memory_pool pool = {0};
    double errors[EDGES];
    assert_int_equal(edge_queue_make(EDGES, 0, 1, &pool, &queue, NULL), BAT_OK);
    for (int i = 0; i < EDGES; i++)
        errors[i] = INFINITY;
    bat_random random = bat_random_seed(1);
    for (int i = 0; i < 5000; i++)
    {
        uint32_t edge = (uint32_t)(bat_random_bits(&random) % EDGES);
        unsigned action = (unsigned)(bat_random_bits(&random) % 4);
        if (action < 2)
            edge_queue_put(&queue, edge, errors[edge] = (double)(bat_random_bits(&random) % 50));
        else if (action == 2)
        {
            edge_queue_remove(&queue, edge);
            errors[edge] = INFINITY;
        }
        else
        {
            uint32_t least = EDGE_QUEUE_ABSENT;
            for (uint32_t e = 0; e < EDGES; e++)
                if (isfinite(errors[e]) && (least == EDGE_QUEUE_ABSENT || errors[e] < errors[least]))
                    least = e;
            assert_int_equal(edge_queue_take(&queue), least);
            if (least != EDGE_QUEUE_ABSENT)
                errors[least] = INFINITY;
        }
    }
    memory_pool_free(&pool);
}

/// Three planes meet in the point of minimal error; the error is the sum of squared distances, about any centre.
static void test_quadrics(void **state)
{
    (void)state;
    const double normals[3][3] = {{1, 0, 0}, {0.6, 0.8, 0}, {0, 0.28, 0.96}}, meet[3] = {0.5, -2, 3};
    quadric sum = {0};
    for (int i = 0; i < 3; i++)
        quadric_add_plane(&sum, normals[i], 1 + i);
    // The planes pass through the centre; about the centre + meet it is at -meet.
    quadric moved = quadric_moved(&sum, (const double[3]){-meet[0], -meet[1], -meet[2]});
    double least[3], at[3] = {1, 1, 1}, expected = 0;
    assert_true(quadric_minimize(&moved, 0, least));
    for (int i = 0; i < 3; i++)
    {
        check_near(least[i], meet[i], 1e-12);
        double distance = 0;
        for (int c = 0; c < 3; c++)
            distance += normals[i][c] * (at[c] - meet[c]);
        expected += (1 + i) * distance * distance;
    }
    check_near(quadric_error(&moved, least), 0, 1e-12);
    check_near(quadric_error(&moved, at), expected, 1e-12);
    check_near(quadric_weight(&moved), 6, 1e-14);
}

static bool stop_at_once(void *context, double fraction)
{
    assert_true(fraction >= 0 && fraction <= 1);
    ++*(int *)context;
    return false;
}

static void test_refusals(void **state)
{
    (void)state;
    bat_mesh torus = shape_torus(60, 30, 0.4), coarse = {.vertex_count = 17};
    bat_mesh_map *map = NULL;
    bat_error error = {0};
    bat_mesh_decimate_options options = options_to(10, 0);
    options.min_quality = 1.5;
    assert_int_equal(bat_mesh_decimate(&torus, &options, &coarse, &map, &error), BAT_INVALID_ARGUMENT);
    options = options_to(10, 0);
    options.min_normal = NAN;
    assert_int_equal(bat_mesh_decimate(&torus, &options, &coarse, &map, NULL), BAT_INVALID_ARGUMENT);
    options = options_to(10, 0);
    options.boundary_weight = -1;
    assert_int_equal(bat_mesh_decimate(&torus, &options, &coarse, &map, NULL), BAT_INVALID_ARGUMENT);
    int calls = 0;
    options = options_to(10, 0);
    options.progress = (bat_progress){stop_at_once, &calls};
    assert_int_equal(bat_mesh_decimate(&torus, &options, &coarse, &map, &error), BAT_CANCELLED);
    assert_int_equal(calls, 1);
    torus.creases = calloc(1, sizeof *torus.creases);
    torus.creases[0] = (bat_mesh_crease){0, 100, 1};
    torus.crease_count = 1;
    options = options_to(10, 0);
    assert_int_equal(bat_mesh_decimate(&torus, &options, &coarse, &map, &error), BAT_INVALID_ARGUMENT);
    torus.faces[0] = torus.faces[1];
    assert_int_equal(bat_mesh_decimate(&torus, &options, &coarse, &map, &error), BAT_INVALID_POINT);
    assert_int_equal(coarse.vertex_count, 17);
    assert_null(map);
    bat_mesh_free(&torus);
}

/// The even method has as many faces as the default, a smaller greatest distance and nearly the same mean.
static void test_even_distance(void **state)
{
    (void)state;
    bat_mesh fine = shape_sphere(24, 0.1, 3), made[2];
    bat_mesh_distance distance[2];
    bat_mesh_map *map;
    for (int i = 0; i < 2; i++)
    {
        bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
        options.faces = 400;
        options.method = i == 0 ? BAT_MESH_DECIMATE_METHOD_MEMORYLESS : BAT_MESH_DECIMATE_METHOD_EVEN;
        assert_int_equal(bat_mesh_decimate(&fine, &options, &made[i], i == 1 ? &map : NULL, NULL), BAT_OK);
        assert_int_equal(bat_mesh_compare(&made[i], &fine, NULL, &distance[i], NULL), BAT_OK);
    }
    assert_int_equal(made[1].face_count, made[0].face_count);
    assert_true(distance[1].hausdorff < 0.85 * distance[0].hausdorff);
    assert_true(distance[1].mean < 1.05 * distance[0].mean);
    bat_mesh_point point = {0, {1, 0, 0}};
    assert_int_equal(bat_mesh_map_to_fine(map, &point, 1, NULL), BAT_OK);
    bat_mesh_map_free(map);
    for (int i = 0; i < 2; i++)
        bat_mesh_free(&made[i]);
    bat_mesh_free(&fine);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_topology_stays),
        cmocka_unit_test(test_pieces_stay),
        cmocka_unit_test(test_planes_decimate_exactly),
        cmocka_unit_test(test_sharp_edges_stay),
        cmocka_unit_test(test_error_follows_size),
        cmocka_unit_test(test_volume_stays),
        cmocka_unit_test(test_targets),
        cmocka_unit_test(test_bounded_distance),
        cmocka_unit_test(test_bounded_flat_faces),
        cmocka_unit_test(test_attributes),
        cmocka_unit_test(test_values_stay_in_range),
        cmocka_unit_test(test_seeds),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_degenerate_faces),
        cmocka_unit_test(test_hubs),
        cmocka_unit_test(test_scales),
        cmocka_unit_test(test_bounds_hold),
        cmocka_unit_test(test_creases_and_corners_stay),
        cmocka_unit_test(test_link_condition),
        cmocka_unit_test(test_random_collapses_keep_the_structure),
        cmocka_unit_test(test_queue),
        cmocka_unit_test(test_quadrics),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_even_distance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
