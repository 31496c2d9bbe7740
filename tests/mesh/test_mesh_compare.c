// Distances between surfaces: closed forms, symmetries, invariances, one-sided distances, and refusals.
#include "check.h"

#include "batten/mesh_measure.h"

static const double PI = 3.14159265358979323846;

static bat_mesh empty_mesh(size_t vertices, size_t faces)
{
    bat_mesh mesh = {.positions = calloc(3 * vertices, sizeof(double)),
                     .faces = calloc(3 * faces, sizeof(uint32_t)),
                     .vertex_count = vertices,
                     .face_count = faces};
    assert_non_null(mesh.positions);
    assert_non_null(mesh.faces);
    return mesh;
}

/// A grid of columns x rows squares, divided into triangles, over [0, width] x [0, depth] at height z.
static bat_mesh plane(uint32_t columns, uint32_t rows, double width, double depth, double z)
{
    bat_mesh mesh = empty_mesh((size_t)(columns + 1) * (rows + 1), (size_t)2 * columns * rows);
    for (uint32_t i = 0; i <= columns; i++)
        for (uint32_t j = 0; j <= rows; j++)
        {
            double *at = mesh.positions + (size_t)3 * (i * (rows + 1) + j);
            at[0] = width * i / columns;
            at[1] = depth * j / rows;
            at[2] = z;
        }
    uint32_t *face = mesh.faces;
    for (uint32_t i = 0; i < columns; i++)
        for (uint32_t j = 0; j < rows; j++, face += 6)
        {
            uint32_t a = i * (rows + 1) + j, b = a + rows + 1;
            const uint32_t corners[6] = {a, b, b + 1, a, b + 1, a + 1};
            memcpy(face, corners, sizeof corners);
        }
    return mesh;
}

/// A sphere of rings and sectors.
static bat_mesh sphere(uint32_t rings, uint32_t sectors, double radius)
{
    bat_mesh mesh = empty_mesh(2 + (size_t)(rings - 1) * sectors, (size_t)2 * (rings - 1) * sectors);
    mesh.positions[2] = radius;
    mesh.positions[5] = -radius;
    uint32_t *face = mesh.faces;
    for (uint32_t r = 1; r < rings; r++)
        for (uint32_t s = 0; s < sectors; s++)
        {
            double polar = PI * r / rings, turn = 2 * PI * s / sectors;
            uint32_t a = 2 + (r - 1) * sectors + s, b = 2 + (r - 1) * sectors + (s + 1) % sectors;
            double *at = mesh.positions + 3 * (size_t)a;
            at[0] = radius * sin(polar) * cos(turn);
            at[1] = radius * sin(polar) * sin(turn);
            at[2] = radius * cos(polar);
            bool last = r + 1 == rings;
            // The last ring has one face below; the top face takes the place of the other.
            const uint32_t below[3] = {a, last ? 1 : a + sectors, b};
            const uint32_t second[3] = {b, a + sectors, b + sectors}, top[3] = {0, 2 + s, 2 + (s + 1) % sectors};
            memcpy(face, below, sizeof below);
            memcpy(face + 3, last ? top : second, sizeof top);
            face += 6;
        }
    return mesh;
}

static bat_mesh_distance compare(const bat_mesh *first, const bat_mesh *second, const bat_mesh_compare_options *options)
{
    bat_mesh_distance distance;
    bat_error error = {.text = ""};
    bat_status status = bat_mesh_compare(first, second, options, &distance, &error);
    if (status != BAT_OK)
        fail_msg("%s", error.text);
    assert_true(distance.hausdorff == fmax(distance.hausdorff_from_first, distance.hausdorff_from_second));
    assert_true(distance.mean_max == fmax(distance.mean_from_first, distance.mean_from_second));
    check_relative(distance.mean, (distance.mean_from_first + distance.mean_from_second) / 2, 1e-15);
    assert_true(distance.rms_from_first >= distance.mean_from_first * (1 - 1e-12));
    assert_true(distance.hausdorff_from_first >= distance.rms_from_first * (1 - 1e-12));
    assert_true(distance.hausdorff_bound >= distance.hausdorff);
    return distance;
}

/// Parallel planes: every distance is the gap, up to rounding.
static void test_parallel_planes(void **state)
{
    (void)state;
    bat_mesh a = plane(7, 5, 2, 1, 0), b = plane(3, 8, 2, 1, 0.25);
    bat_mesh_distance distance = compare(&a, &b, NULL);
    check_near(distance.hausdorff_from_first, 0.25, 1e-15);
    check_near(distance.hausdorff_from_second, 0.25, 1e-15);
    check_near(distance.hausdorff_bound, 0.25, 0.25 * 1.001e-4);
    check_near(distance.mean_from_first, 0.25, 1e-12);
    check_near(distance.mean_from_second, 0.25, 1e-12);
    check_near(distance.rms_from_first, 0.25, 1e-12);
    check_near(distance.diagonal, sqrt(5), 1e-15);
    bat_mesh_free(&a);
    bat_mesh_free(&b);
}

/// A square within a square of twice its width. In one direction distances are 0; in the other they have closed forms.
static void test_one_sided(void **state)
{
    (void)state;
    bat_mesh small = plane(4, 4, 1, 1, 0), large = plane(6, 5, 2, 1, 0);
    bat_mesh_distance distance = compare(&small, &large, NULL);
    check_near(distance.hausdorff_from_first, 0, 1e-15);
    check_near(distance.mean_from_first, 0, 1e-15);
    check_near(distance.hausdorff_from_second, 1, 1e-15);
    check_relative(distance.mean_from_second, 0.25, 1e-4);
    check_relative(distance.rms_from_second, sqrt(1.0 / 6), 1e-4);
    check_near(distance.farthest_from_second[0], 2, 1e-15);
    bat_mesh_distance turned = compare(&large, &small, NULL);
    check_near(turned.hausdorff_from_first, 1, 1e-15);
    check_near(turned.hausdorff_from_second, 0, 1e-15);
    bat_mesh_free(&small);
    bat_mesh_free(&large);
}

/// A roof over a square, with a ridge of height 1 over the middle line. From the square, the maximum is the distance of the
/// ridge's foot from the slopes, (1/2) / sqrt(1 + 1/4), inside of faces. From the roof, it is the height.
static void test_inside_of_faces(void **state)
{
    (void)state;
    bat_mesh flat = plane(1, 1, 1, 1, 0), roof = plane(2, 1, 1, 1, 0);
    roof.positions[3 * 2 + 2] = roof.positions[3 * 3 + 2] = 1;
    bat_mesh_distance distance = compare(&flat, &roof, NULL);
    check_relative(distance.hausdorff_from_first, 0.5 / sqrt(1.25), 1e-4);
    assert_true(distance.hausdorff_from_first <= 0.5 / sqrt(1.25) * (1 + 1e-14));
    check_near(distance.hausdorff_from_second, 1, 1e-15);
    check_relative(distance.mean_from_second, 0.5, 1e-4);
    // x / sqrt(1.25) on 0 … 1/2: the height of a right triangle.
    check_relative(distance.mean_from_first, 0.25 / sqrt(1.25), 1e-4);
    assert_true(distance.hausdorff_bound >= 1);
    bat_mesh_free(&flat);
    bat_mesh_free(&roof);
}

/// Concentric spheres: every distance differs from that of the radii by at most the deviation of the facets.
static void test_spheres(void **state)
{
    (void)state;
    bat_mesh inner = sphere(60, 120, 1), outer = sphere(70, 130, 1.5);
    double cut = 1 - cos(PI / 60) * cos(PI / 120), cut_outer = 1.5 * (1 - cos(PI / 70) * cos(PI / 130));
    bat_mesh_distance distance = compare(&inner, &outer, NULL);
    assert_true(distance.hausdorff_from_first <= 0.5 + cut && distance.hausdorff_from_first >= 0.5 - cut_outer);
    assert_true(distance.hausdorff_from_second <= 0.5 + cut && distance.hausdorff_from_second >= 0.5 - cut_outer);
    check_near(distance.mean_from_first, 0.5, cut + cut_outer);
    check_near(distance.mean_from_second, 0.5, cut + cut_outer);
    bat_mesh_distance back = compare(&outer, &inner, NULL);
    assert_true(back.hausdorff_from_first == distance.hausdorff_from_second &&
                back.hausdorff_from_second == distance.hausdorff_from_first);
    assert_true(back.mean_from_first == distance.mean_from_second && back.rms_from_second == distance.rms_from_first);
    bat_mesh_free(&inner);
    bat_mesh_free(&outer);
}

/// A mesh and itself: 0 up to rounding. The same surface with other faces: 0, proven far below the width of a face.
static void test_same_surface(void **state)
{
    (void)state;
    bat_mesh ball = sphere(40, 50, 1);
    bat_mesh_distance distance = compare(&ball, &ball, NULL);
    check_near(distance.hausdorff, 0, 1e-15);
    check_near(distance.hausdorff_bound, 0, 1e-15);
    bat_mesh_free(&ball);
    bat_mesh coarse = plane(3, 3, 1, 1, 0.5), fine = plane(39, 42, 1, 1, 0.5);
    distance = compare(&coarse, &fine, NULL);
    check_near(distance.hausdorff, 0, 1e-15);
    check_near(distance.hausdorff_bound, 0, 1e-5);
    bat_mesh_free(&coarse);
    bat_mesh_free(&fine);
}

/// The upper bound holds and is sharp: no random point of the surface is farther.
static void test_bound(void **state)
{
    (void)state;
    bat_mesh a = sphere(9, 11, 1), b = sphere(30, 40, 1.1);
    for (size_t i = 0; i < b.vertex_count; i++)
        b.positions[3 * i] *= 1 + 0.3 * sin(7 * b.positions[3 * i + 1]);
    bat_mesh_compare_options options = bat_mesh_compare_defaults();
    bat_mesh_distance exact = compare(&a, &b, &options);
    check_relative(exact.hausdorff_bound, exact.hausdorff, 1.001e-4);
    options.samples = 3000000;
    options.tolerance = 0;
    bat_mesh_distance dense = compare(&a, &b, &options);
    assert_true(dense.hausdorff_from_first <= exact.hausdorff_from_first * (1 + 1e-4));
    assert_true(dense.hausdorff_from_second <= exact.hausdorff_from_second * (1 + 1e-4));
    assert_true(dense.hausdorff >= exact.hausdorff * (1 - 1e-2));
    check_relative(exact.mean_from_first, dense.mean_from_first, 5e-4);
    check_relative(exact.mean_from_second, dense.mean_from_second, 5e-4);
    options.samples = 10;
    bat_mesh_distance sparse = compare(&a, &b, &options);
    assert_true(sparse.hausdorff <= exact.hausdorff_bound && sparse.hausdorff_bound >= exact.hausdorff);
    bat_mesh_free(&a);
    bat_mesh_free(&b);
}

/// The metrics over vertices follow from bat_mesh_vertex_distances().
static void test_vertices(void **state)
{
    (void)state;
    bat_mesh a = sphere(12, 16, 1), b = sphere(7, 9, 0.8);
    bat_mesh_compare_options options = bat_mesh_compare_defaults();
    options.vertices = true;
    bat_mesh_distance distance = compare(&a, &b, &options);
    double *each = calloc(a.vertex_count, sizeof *each), sum = 0, squares = 0, greatest = 0;
    assert_non_null(each);
    check_status(bat_mesh_vertex_distances(&a, &b, 0, each, NULL), BAT_OK);
    for (size_t v = 0; v < a.vertex_count; v++)
    {
        sum += each[v];
        squares += each[v] * each[v];
        greatest = fmax(greatest, each[v]);
    }
    check_relative(distance.mean_from_first, sum / (double)a.vertex_count, 1e-14);
    check_relative(distance.rms_from_first, sqrt(squares / (double)a.vertex_count), 1e-14);
    check_relative(distance.hausdorff_from_first, greatest, 1e-15);
    assert_true(isinf(distance.hausdorff_bound));
    free(each);
    bat_mesh_free(&a);
    bat_mesh_free(&b);
}

/// Vertices without a face are not part of the surface.
static void test_isolated_vertices(void **state)
{
    (void)state;
    bat_mesh a = plane(2, 2, 1, 1, 0), b = plane(3, 1, 1, 1, 0.5);
    bat_mesh_distance plain = compare(&a, &b, NULL);
    b.positions = realloc(b.positions, 3 * (b.vertex_count + 1) * sizeof(double));
    assert_non_null(b.positions);
    for (size_t k = 0; k < 3; k++)
        b.positions[3 * b.vertex_count + k] = 0.75;
    b.vertex_count++;
    bat_mesh_distance distance = compare(&a, &b, NULL);
    assert_memory_equal(&plain, &distance, sizeof plain);
    bat_mesh_free(&a);
    bat_mesh_free(&b);
}

/// Rotate by `angle` about an axis and translate.
static void move(bat_mesh *mesh, double angle, const double shift[3])
{
    double c = cos(angle), s = sin(angle);
    for (size_t v = 0; v < mesh->vertex_count; v++)
    {
        double *p = mesh->positions + 3 * v, x = p[0], y = p[1], z = p[2];
        double turned[3] = {c * x - s * y, s * x + c * y, z};
        double again[3] = {turned[0], c * turned[1] - s * turned[2], s * turned[1] + c * turned[2]};
        for (int k = 0; k < 3; k++)
            p[k] = again[k] + shift[k];
    }
}

static void test_rigid_motion(void **state)
{
    (void)state;
    bat_mesh a = sphere(8, 9, 1), b = sphere(13, 14, 1.2);
    b.positions[2] = 2.5;
    bat_mesh_distance before = compare(&a, &b, NULL);
    const double shift[3] = {3, -2, 0.5};
    move(&a, 0.7, shift);
    move(&b, 0.7, shift);
    bat_mesh_distance after = compare(&a, &b, NULL);
    check_relative(after.hausdorff_from_first, before.hausdorff_from_first, 1.001e-4);
    check_relative(after.hausdorff_from_second, before.hausdorff_from_second, 1.001e-4);
    check_relative(after.mean_from_first, before.mean_from_first, 1e-3);
    check_relative(after.rms_from_second, before.rms_from_second, 1e-3);
    bat_mesh_compare_options options = bat_mesh_compare_defaults();
    options.vertices = true;
    after = compare(&a, &b, &options);
    move(&a, 0, (const double[3]){-3, 2, -0.5});
    move(&b, 0, (const double[3]){-3, 2, -0.5});
    before = compare(&a, &b, &options);
    check_relative(after.mean_from_first, before.mean_from_first, 1e-13);
    check_relative(after.hausdorff, before.hausdorff, 1e-13);
    bat_mesh_free(&a);
    bat_mesh_free(&b);
}

/// Scaling by powers of two scales every metric exactly, even where squares overflow or underflow.
static void test_magnitudes(void **state)
{
    (void)state;
    static const int EXPONENTS[] = {-900, 1000};
    bat_mesh a = sphere(8, 9, 1), b = sphere(10, 12, 1.3);
    bat_mesh_distance plain = compare(&a, &b, NULL);
    for (size_t e = 0; e < 2; e++)
    {
        for (size_t i = 0; i < 3 * a.vertex_count; i++)
            a.positions[i] = ldexp(a.positions[i], EXPONENTS[e]);
        for (size_t i = 0; i < 3 * b.vertex_count; i++)
            b.positions[i] = ldexp(b.positions[i], EXPONENTS[e]);
        bat_mesh_distance large = compare(&a, &b, NULL);
        assert_true(large.hausdorff == ldexp(plain.hausdorff, EXPONENTS[e]));
        assert_true(large.mean == ldexp(plain.mean, EXPONENTS[e]));
        assert_true(large.rms_from_second == ldexp(plain.rms_from_second, EXPONENTS[e]));
        assert_true(large.diagonal == ldexp(plain.diagonal, EXPONENTS[e]));
        for (size_t i = 0; i < 3 * a.vertex_count; i++)
            a.positions[i] = ldexp(a.positions[i], -EXPONENTS[e]);
        for (size_t i = 0; i < 3 * b.vertex_count; i++)
            b.positions[i] = ldexp(b.positions[i], -EXPONENTS[e]);
    }
    bat_mesh_free(&a);
    bat_mesh_free(&b);
}

static void test_threads(void **state)
{
    (void)state;
    bat_mesh a = sphere(50, 60, 1), b = sphere(90, 120, 1.1);
    bat_mesh_compare_options options = bat_mesh_compare_defaults();
    options.threads = 1;
    bat_mesh_distance one = compare(&a, &b, &options);
    options.threads = 3;
    bat_mesh_distance three = compare(&a, &b, &options);
    assert_memory_equal(&one, &three, sizeof one);
    bat_mesh_free(&a);
    bat_mesh_free(&b);
}

static void check_refused(const bat_mesh *a, const bat_mesh *b, const bat_mesh_compare_options *options, bat_status expected,
                          const char *words)
{
    bat_mesh_distance distance = {.mean = 17};
    bat_error error = {.text = ""};
    check_status(bat_mesh_compare(a, b, options, &distance, &error), expected);
    if (strstr(error.text, words) == NULL)
        fail_msg("\"%s\" does not say \"%s\"", error.text, words);
    check_near(distance.mean, 17, 0);
    check_status(bat_mesh_compare(a, b, options, &distance, NULL), expected);
}

static bool stop(void *context, double fraction)
{
    (void)context;
    return fraction < 0.5;
}

static void test_refusals(void **state)
{
    (void)state;
    bat_mesh good = plane(9, 9, 1, 1, 0), flat = plane(2, 2, 0, 0, 0), none = {0}, far = plane(1, 1, 1e308, 1, 0);
    bat_mesh_compare_options options = bat_mesh_compare_defaults();
    check_refused(&good, &none, NULL, BAT_INVALID_ARGUMENT, "the second mesh: the mesh has no faces");
    check_refused(&flat, &good, NULL, BAT_INVALID_ARGUMENT, "the first mesh has no area");
    check_refused(&good, &far, NULL, BAT_INVALID_POINT, "the second mesh: vertex 2 is too far from the origin");
    options.samples = 0;
    check_refused(&good, &good, &options, BAT_INVALID_ARGUMENT, "sample");
    options = bat_mesh_compare_defaults();
    options.tolerance = NAN;
    check_refused(&good, &good, &options, BAT_INVALID_ARGUMENT, "tolerance");
    options = bat_mesh_compare_defaults();
    options.progress.report = stop;
    check_refused(&good, &good, &options, BAT_CANCELLED, "stopped");
    options = bat_mesh_compare_defaults();
    options.vertices = true;
    bat_mesh_distance distance = compare(&flat, &good, &options);
    check_near(distance.hausdorff_from_first, 0, 0);
    check_near(distance.hausdorff_from_second, sqrt(2), 1e-15);
    bat_mesh_free(&good);
    bat_mesh_free(&flat);
    bat_mesh_free(&far);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parallel_planes), cmocka_unit_test(test_one_sided),
        cmocka_unit_test(test_inside_of_faces), cmocka_unit_test(test_spheres),
        cmocka_unit_test(test_same_surface),    cmocka_unit_test(test_bound),
        cmocka_unit_test(test_vertices),        cmocka_unit_test(test_isolated_vertices),
        cmocka_unit_test(test_rigid_motion),    cmocka_unit_test(test_magnitudes),
        cmocka_unit_test(test_threads),         cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
