// Closest points of a mesh against brute force in extended precision, with good and degenerate triangles.
#include "check.h"

#include "batten/mesh_measure.h"
#include "mesh/measure/closest.h"

#include <float.h>

#if defined(__SIZEOF_FLOAT128__)
typedef __float128 real;
#else
typedef long double real;
#endif

static double root(real x)
{
    return (double)sqrtl((long double)x);
}

/// Squared distance of a point from the segment a b.
static real segment_squared(const real p[3], const real a[3], const real b[3])
{
    real along = 0, length = 0, squared = 0;
    for (int k = 0; k < 3; k++)
    {
        along += (p[k] - a[k]) * (b[k] - a[k]);
        length += (b[k] - a[k]) * (b[k] - a[k]);
    }
    real t = length > 0 ? along / length : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int k = 0; k < 3; k++)
    {
        real d = p[k] - a[k] - t * (b[k] - a[k]);
        squared += d * d;
    }
    return squared;
}

static real triple(const real a[3], const real b[3], const real c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// The distance of a point from a triangle by another method: from the plane where the projection is inside all three edges,
/// else from the edges.
static double distance_to_face(const bat_mesh *mesh, size_t face, const double point[3])
{
    real p[3], v[3][3], u[3], w[3], n[3];
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            v[c][k] = mesh->positions[3 * mesh->faces[3 * face + (size_t)c] + (size_t)k];
    for (int k = 0; k < 3; k++)
    {
        p[k] = point[k];
        u[k] = v[1][k] - v[0][k];
        w[k] = v[2][k] - v[0][k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
    real nn = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    bool over = nn > 0;
    for (int c = 0; c < 3; c++)
    {
        real edge[3], to[3];
        for (int k = 0; k < 3; k++)
        {
            edge[k] = v[(c + 1) % 3][k] - v[c][k];
            to[k] = p[k] - v[c][k];
        }
        over = over && triple(n, edge, to) >= 0;
    }
    if (over)
    {
        real height = 0;
        for (int k = 0; k < 3; k++)
            height += n[k] * (p[k] - v[0][k]);
        return root(height * height / nn);
    }
    double least = root(segment_squared(p, v[0], v[1]));
    least = fmin(least, root(segment_squared(p, v[1], v[2])));
    return fmin(least, root(segment_squared(p, v[2], v[0])));
}

static double distance_by_force(const bat_mesh *mesh, const double point[3])
{
    double least = INFINITY;
    for (size_t f = 0; f < mesh->face_count; f++)
        least = fmin(least, distance_to_face(mesh, f, point));
    return least;
}

/// Random triangles of size 1 and smaller.
typedef enum soup_kind
{
    SOUP_PLAIN,
    SOUP_SLIVERS,  ///< heights from 1 down to 1e-17
    SOUP_SEGMENTS, ///< three corners exactly on a line
    SOUP_POINTS,   ///< three corners at one point
    SOUP_FLAT,     ///< all in one plane
    SOUP_KINDS
} soup_kind;

static void put_vertex(bat_random *random, soup_kind kind, double *corners, int c)
{
    double *a = corners, *b = corners + 3, *at = corners + 3 * c;
    double t = bat_random_uniform(random), height = pow(10, -17 * bat_random_uniform(random));
    for (int k = 0; k < 3; k++)
    {
        double near = c == 0 ? 4 * bat_random_uniform(random) - 2 : a[k] + bat_random_uniform(random) - 0.5;
        at[k] = near;
        if (c == 2 && kind == SOUP_SLIVERS)
            at[k] = a[k] + t * (b[k] - a[k]) + height * (bat_random_uniform(random) - 0.5);
        if (kind == SOUP_SEGMENTS && c > 0)
            at[k] = a[k] + (k == 1 ? (double)c * 0.25 : 0);
        if (kind == SOUP_POINTS && c > 0)
            at[k] = a[k];
        if (kind == SOUP_FLAT && k == 2)
            at[k] = 0.25;
    }
}

static bat_mesh soup(soup_kind kind, size_t faces, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    bat_mesh mesh = {.positions = malloc(faces * 9 * sizeof(double)),
                     .faces = malloc(faces * 3 * sizeof(uint32_t)),
                     .vertex_count = 3 * faces,
                     .face_count = faces};
    assert_non_null(mesh.positions);
    assert_non_null(mesh.faces);
    for (size_t i = 0; i < 3 * faces; i++)
    {
        mesh.faces[i] = (uint32_t)i;
        put_vertex(&random, kind, mesh.positions + 9 * (i / 3), (int)(i % 3));
    }
    return mesh;
}

/// Check that the face, the barycentric coordinates, the point and the distance of a hit agree.
static void check_hit(const bat_mesh *mesh, const double point[3], const bat_mesh_closest_point *hit, double expected)
{
    double sum = 0, squared = 0;
    assert_true(hit->at.face < mesh->face_count);
    for (int c = 0; c < 3; c++)
    {
        assert_true(hit->at.barycentric[c] >= 0 && hit->at.barycentric[c] <= 1);
        sum += hit->at.barycentric[c];
    }
    check_near(sum, 1, 4 * DBL_EPSILON);
    for (int k = 0; k < 3; k++)
    {
        double on = 0;
        for (int c = 0; c < 3; c++)
            on += hit->at.barycentric[c] * mesh->positions[3 * mesh->faces[3 * hit->at.face + (size_t)c] + (size_t)k];
        check_near(hit->position[k], on, 4e-15);
        squared += (hit->position[k] - point[k]) * (hit->position[k] - point[k]);
    }
    check_near(hit->distance, sqrt(squared), 1e-14);
    check_near(hit->distance, expected, 1e-14);
}

/// Queries near, far, at vertices, on edges and in faces.
static void make_query(const bat_mesh *mesh, bat_random *random, int i, double point[3])
{
    size_t face = (size_t)(bat_random_uniform(random) * (double)mesh->face_count);
    const double *a = mesh->positions + 9 * face;
    double u = bat_random_uniform(random), v = (1 - u) * bat_random_uniform(random);
    for (int k = 0; k < 3; k++)
    {
        double anywhere = 6 * bat_random_uniform(random) - 3;
        double candidates[4] = {anywhere, a[k], a[k] + u * (a[3 + k] - a[k]),
                                a[k] + u * (a[3 + k] - a[k]) + v * (a[6 + k] - a[k])};
        point[k] = candidates[i % 4];
    }
}

static void test_brute_force(void **state)
{
    (void)state;
    enum
    {
        QUERIES = 400
    };
    static const size_t COUNTS[] = {1, 2, 7, 8, 9, 63, 64, 65, 300};
    for (int kind = 0; kind < SOUP_KINDS; kind++)
        for (size_t n = 0; n < sizeof COUNTS / sizeof COUNTS[0]; n++)
        {
            bat_mesh mesh = soup((soup_kind)kind, COUNTS[n], 11 + n);
            bat_random random = bat_random_seed(5);
            double points[3 * QUERIES];
            bat_mesh_closest_point hits[QUERIES];
            for (int i = 0; i < QUERIES; i++)
                make_query(&mesh, &random, i, points + 3 * i);
            check_status(bat_mesh_closest(&mesh, points, QUERIES, 0, hits, NULL), BAT_OK);
            for (int i = 0; i < QUERIES; i++)
                check_hit(&mesh, points + 3 * i, &hits[i], distance_by_force(&mesh, points + 3 * i));
            bat_mesh_free(&mesh);
        }
}

/// The distance does not depend on the starting place, and the tree contains every face.
static void test_any_start(void **state)
{
    (void)state;
    bat_mesh mesh = soup(SOUP_SLIVERS, 1000, 3);
    closest_tree tree;
    check_status(closest_build(&mesh, 4, &tree, NULL), BAT_OK);
    bool seen[1000] = {false};
    for (size_t i = 0; i < tree.face_count; i++)
    {
        assert_false(seen[tree.faces[i]]);
        seen[tree.faces[i]] = true;
    }
    bat_random random = bat_random_seed(9);
    for (int i = 0; i < 200; i++)
    {
        double point[3];
        make_query(&mesh, &random, i, point);
        uint32_t place = 0, elsewhere = (uint32_t)(bat_random_bits(&random) % 1000);
        double distance = closest_find(&tree, point, &place);
        assert_true(closest_find(&tree, point, &elsewhere) == distance);
        assert_true(closest_to_place(&tree, point, place) == distance);
        check_near(closest_point_at(&tree, point, place).distance, distance, 1e-15);
        check_near(distance_to_face(&mesh, tree.faces[place], point), distance, 1e-14);
    }
    closest_free(&tree);
    bat_mesh_free(&mesh);
}

/// Scaling by powers of two scales results exactly, from tiny to huge.
static void test_magnitudes(void **state)
{
    (void)state;
    static const int EXPONENTS[] = {-1000, -300, 300, 1000};
    bat_mesh mesh = soup(SOUP_PLAIN, 100, 21);
    double points[3 * 50], scaled[3 * 50];
    bat_random random = bat_random_seed(2);
    for (int i = 0; i < 50; i++)
        make_query(&mesh, &random, i, points + 3 * i);
    bat_mesh_closest_point plain[50], hits[50];
    check_status(bat_mesh_closest(&mesh, points, 50, 1, plain, NULL), BAT_OK);
    for (size_t e = 0; e < 4; e++)
    {
        bat_mesh large;
        check_status(bat_mesh_copy(&mesh, &large, NULL), BAT_OK);
        for (size_t i = 0; i < 9 * 100; i++)
            large.positions[i] = ldexp(mesh.positions[i], EXPONENTS[e]);
        for (int i = 0; i < 3 * 50; i++)
            scaled[i] = ldexp(points[i], EXPONENTS[e]);
        check_status(bat_mesh_closest(&large, scaled, 50, 1, hits, NULL), BAT_OK);
        for (int i = 0; i < 50; i++)
            assert_true(hits[i].distance == ldexp(plain[i].distance, EXPONENTS[e]));
        bat_mesh_free(&large);
    }
    bat_mesh_free(&mesh);
}

/// Construction with all centres at one point, or all on a line.
static void test_piles(void **state)
{
    (void)state;
    enum
    {
        PILE = 20000
    };
    bat_mesh mesh = soup(SOUP_PLAIN, PILE, 8);
    for (int kind = 0; kind < 2; kind++)
    {
        for (size_t i = 0; i < 9 * PILE; i++)
            mesh.positions[i] = mesh.positions[i % 9] + (kind == 1 && i % 3 == 1 ? (double)(i / 9) : 0);
        const double *expected = mesh.positions + 9 * (PILE / 2);
        bat_mesh_closest_point hit;
        check_status(bat_mesh_closest(&mesh, expected, 1, 0, &hit, NULL), BAT_OK);
        assert_true(hit.distance == 0);
    }
    bat_mesh_free(&mesh);
}

static void test_threads(void **state)
{
    (void)state;
    enum
    {
        QUERIES = 5000
    };
    bat_mesh mesh = soup(SOUP_FLAT, 20000, 31);
    double *points = malloc(sizeof *points * 3 * QUERIES);
    bat_mesh_closest_point *one = calloc(QUERIES, sizeof *one), *three = calloc(QUERIES, sizeof *three);
    assert_true(points != NULL && one != NULL && three != NULL);
    bat_random random = bat_random_seed(4);
    for (int i = 0; i < QUERIES; i++)
        make_query(&mesh, &random, i, points + 3 * i);
    check_status(bat_mesh_closest(&mesh, points, QUERIES, 1, one, NULL), BAT_OK);
    check_status(bat_mesh_closest(&mesh, points, QUERIES, 3, three, NULL), BAT_OK);
    for (int i = 0; i < QUERIES; i++)
    {
        assert_int_equal(one[i].at.face, three[i].at.face);
        assert_memory_equal(one[i].at.barycentric, three[i].at.barycentric, sizeof one[i].at.barycentric);
        assert_true(one[i].distance == three[i].distance);
    }
    free(points);
    free(one);
    free(three);
    bat_mesh_free(&mesh);
}

static void test_refusals(void **state)
{
    (void)state;
    bat_mesh mesh = soup(SOUP_PLAIN, 3, 1), none = {0};
    double points[6] = {0, 0, 0, 0, NAN, 0};
    bat_mesh_closest_point hits[2] = {{.distance = 17}, {.distance = 17}};
    bat_error error;
    check_status(bat_mesh_closest(&none, points, 1, 0, hits, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_mesh_closest(&mesh, points, 2, 0, hits, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    points[4] = -1e308;
    check_status(bat_mesh_closest(&mesh, points, 2, 0, hits, &error), BAT_INVALID_POINT);
    check_near(hits[0].distance, 17, 0);
    check_status(bat_mesh_closest(&mesh, points, 0, 0, hits, &error), BAT_OK);
    mesh.faces[4] = 9;
    check_status(bat_mesh_closest(&mesh, points, 1, 0, hits, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    bat_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_brute_force), cmocka_unit_test(test_any_start), cmocka_unit_test(test_magnitudes),
        cmocka_unit_test(test_piles),       cmocka_unit_test(test_threads),   cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
