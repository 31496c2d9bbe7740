// Shapes of our own making: one closed (or open) manifold piece each, of good triangles, the same every time.
#include "check.h"

#include "base/hash.h"
#include "batten/mesh_file.h"
#include "batten/research/mesh_shapes.h"
#include "batten/research/mesh_train.h"
#include "learn/safetensors.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WANTED ((size_t)2000)

static double square_edge(const bat_mesh *mesh, uint32_t a, uint32_t b)
{
    double sum = 0;
    for (size_t c = 0; c < 3; c++)
    {
        double away = mesh->positions[3 * (size_t)a + c] - mesh->positions[3 * (size_t)b + c];
        sum += away * away;
    }
    return sum;
}

static void face_normal(const bat_mesh *mesh, size_t face, double normal[3])
{
    const uint32_t *corner = mesh->faces + 3 * face;
    const double *a = mesh->positions + 3 * (size_t)corner[0], *b = mesh->positions + 3 * (size_t)corner[1];
    const double *c = mesh->positions + 3 * (size_t)corner[2];
    for (int i = 0; i < 3; i++)
    {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
    }
}

/// 1 for an equilateral triangle, 0 for one without area: 4 sqrt(3) area over the sum of the squared edges.
static double quality(const bat_mesh *mesh, size_t face)
{
    double normal[3];
    face_normal(mesh, face, normal);
    const uint32_t *corner = mesh->faces + 3 * face;
    double squares = square_edge(mesh, corner[0], corner[1]) + square_edge(mesh, corner[1], corner[2]) +
                     square_edge(mesh, corner[2], corner[0]);
    return 2 * sqrt(3) * sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]) / squares;
}

static double volume(const bat_mesh *mesh)
{
    double sum = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        double normal[3];
        face_normal(mesh, f, normal);
        const double *a = mesh->positions + 3 * (size_t)mesh->faces[3 * f];
        sum += (a[0] * normal[0] + a[1] * normal[1] + a[2] * normal[2]) / 6;
    }
    return sum;
}

static size_t count_pieces(const bat_mesh *mesh)
{
    uint32_t *parent = malloc(mesh->vertex_count * sizeof *parent);
    assert_non_null(parent);
    size_t pieces = mesh->vertex_count;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        parent[v] = (uint32_t)v;
    for (size_t h = 0; h < 3 * mesh->face_count; h++)
    {
        uint32_t a = mesh->faces[h], b = mesh->faces[bat_mesh_next((uint32_t)h)];
        while (parent[a] != a)
            a = parent[a] = parent[parent[a]];
        while (parent[b] != b)
            b = parent[b] = parent[parent[b]];
        pieces -= a != b;
        parent[a] = b;
    }
    free(parent);
    return pieces;
}

static void check_box(const bat_mesh *mesh)
{
    double low[3] = {1, 1, 1}, high[3] = {-1, -1, -1}, longest = 0;
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
    {
        low[i % 3] = fmin(low[i % 3], mesh->positions[i]);
        high[i % 3] = fmax(high[i % 3], mesh->positions[i]);
    }
    for (int c = 0; c < 3; c++)
    {
        assert_true(fabs(low[c] + high[c]) < 1e-12);
        longest = fmax(longest, high[c] - low[c]);
    }
    assert_true(fabs(longest - 1) < 1e-12);
}

/// Every kind, several seeds: what the header promises.
static void test_every_kind(void **state)
{
    (void)state;
    for (size_t k = 0; k < bat_mesh_shape_count(); k++)
    {
        const bat_mesh_shape_kind *kind = bat_mesh_shape_at(k);
        bool cage = strcmp(kind->name, "cage") == 0;
        for (uint64_t seed = 1; seed <= 2; seed++)
        {
            bat_mesh mesh;
            bat_mesh_connectivity joined;
            bat_error error;
            assert_int_equal(bat_mesh_shape(kind->name, WANTED, seed, &mesh, &error), BAT_OK);
            assert_int_equal(bat_mesh_check(&mesh, NULL), BAT_OK);
            assert_int_equal(bat_mesh_connect(&mesh, &joined, &error), BAT_OK);
            assert_int_equal(count_pieces(&mesh), 1);
            check_box(&mesh);
            assert_int_equal(kind->closed, joined.boundary_edge_count == 0);
            if (kind->closed)
                assert_true(volume(&mesh) > 0);
            if (!cage)
                assert_true(fabs((double)mesh.vertex_count / WANTED - 1) < 0.1);
            size_t poor = 0;
            double mean = 0;
            for (size_t f = 0; f < mesh.face_count; f++)
            {
                poor += quality(&mesh, f) < 0.1;
                mean += quality(&mesh, f) / (double)mesh.face_count;
            }
            assert_true(poor * 500 <= mesh.face_count);
            assert_true(mean > (cage ? 0.7 : 0.8));
            bat_mesh_connectivity_free(&joined);
            bat_mesh_free(&mesh);
        }
    }
}

static long euler(const bat_mesh *mesh)
{
    bat_mesh_connectivity joined;
    assert_int_equal(bat_mesh_connect(mesh, &joined, NULL), BAT_OK);
    long value = (long)mesh->vertex_count - (long)joined.edge_count + (long)mesh->face_count;
    bat_mesh_connectivity_free(&joined);
    return value;
}

/// What can be said beforehand of holes.
static void test_topology(void **state)
{
    (void)state;
    static const struct
    {
        const char *name;
        long euler;
    } KNOWN[] = {{"stone", 2}, {"gem", 2}, {"cage", 2}, {"knot", 0}, {"relief", 1}, {"shell", 1}};
    for (size_t i = 0; i < sizeof KNOWN / sizeof KNOWN[0]; i++)
        for (uint64_t seed = 5; seed <= 6; seed++)
        {
            bat_mesh mesh;
            assert_int_equal(bat_mesh_shape(KNOWN[i].name, WANTED / 2, seed, &mesh, NULL), BAT_OK);
            assert_int_equal(euler(&mesh), KNOWN[i].euler);
            bat_mesh_free(&mesh);
        }
}

static bool same_bytes(const bat_mesh *a, const bat_mesh *b)
{
    return a->vertex_count == b->vertex_count && a->face_count == b->face_count &&
           memcmp(a->positions, b->positions, a->vertex_count * 3 * sizeof(double)) == 0 &&
           memcmp(a->faces, b->faces, a->face_count * 3 * sizeof(uint32_t)) == 0;
}

static void test_same_every_time(void **state)
{
    (void)state;
    for (size_t k = 0; k < bat_mesh_shape_count(); k++)
    {
        bat_mesh first, again, other;
        const char *name = bat_mesh_shape_at(k)->name;
        assert_int_equal(bat_mesh_shape(name, 800, 11, &first, NULL), BAT_OK);
        assert_int_equal(bat_mesh_shape(name, 800, 11, &again, NULL), BAT_OK);
        assert_int_equal(bat_mesh_shape(name, 800, 12, &other, NULL), BAT_OK);
        assert_true(same_bytes(&first, &again));
        assert_false(same_bytes(&first, &other));
        bat_mesh_free(&first);
        bat_mesh_free(&again);
        bat_mesh_free(&other);
    }
}

static bool stop_at_once(void *context, double fraction)
{
    (void)context;
    (void)fraction;
    return false;
}

/// The shapes of the shipped weights, by the hash in the weights' file, which has two meshes before them.
static uint64_t hash_shapes(const bat_mesh *shapes, size_t count)
{
    uint64_t hash = HASH_BEGIN;
    for (size_t s = 0; s < count; s++)
    {
        hash = hash_bytes(hash, shapes[s].positions, shapes[s].vertex_count * 3 * sizeof *shapes[s].positions);
        hash = hash_bytes(hash, shapes[s].faces, shapes[s].face_count * 3 * sizeof *shapes[s].faces);
    }
    return hash;
}

/// Shapes of the second training beside the generated ones of the recipe.
static const struct
{
    const char *name;
    uint64_t seed;
} MORE[] = {{"block", 3},    {"bracket", 6}, {"bust", 4},    {"cactus", 3},   {"cam", 3},      {"casting", 6},
            {"casting", 7},  {"coral", 2},   {"coral", 3},   {"creature", 5}, {"creature", 6}, {"creature", 7},
            {"creature", 8}, {"figure", 3},  {"figure", 4},  {"gear", 3},     {"gem", 3},      {"knot", 3},
            {"lathe", 5},    {"mask", 3},    {"pretzel", 2}, {"relief", 2},   {"shell", 2},    {"stone", 4}};
enum
{
    MORE_SHAPES = sizeof MORE / sizeof *MORE,
    ALL_SHAPES = MORE_SHAPES + BAT_MESH_TRAINING_SHAPES
};

static void test_shipped_recipe(void **state)
{
    (void)state;
    if (getenv("BATTEN_LONG_TESTS") == NULL) // half a minute of what the tests above do
        skip();
    bat_mesh all[ALL_SHAPES] = {{0}}, *made = all + MORE_SHAPES, same;
    bat_mesh_train_options o = bat_mesh_train_defaults(BAT_RECIPE_BATTEN);
    safetensors content;
    char expected[256];
    assert_int_equal(bat_mesh_training_shapes(made, 0, (bat_progress){0}, NULL), BAT_OK);
    assert_int_equal(bat_mesh_shape("creature", 10000, 1, &same, NULL), BAT_OK);
    assert_true(same_bytes(&made[0], &same));
    bat_mesh_free(&same);
    assert_int_equal(safetensors_read(WEIGHTS_FOLDER "/mesh.safetensors", &content, NULL), BAT_OK);
    const char *recipe = safetensors_find_note(&content, "recipe");
    assert_non_null(recipe);
    for (size_t i = 0; i < MORE_SHAPES; i++)
        assert_int_equal(bat_mesh_shape(MORE[i].name, 10000, MORE[i].seed, &all[i], NULL), BAT_OK);
    (void)snprintf(
        expected, sizeof expected,
        "mesh batten, 16 epochs, 8 coarse meshes of each of %d shapes (%016llx), %zu resampled, batch %zu, %zu to "
        "%zu vertices, rate 0.00015 with cosine decay, begun with weights bcbcb753f6ba2ceb",
        ALL_SHAPES, (unsigned long long)hash_shapes(all, ALL_SHAPES), o.resampled, o.batch, o.min_vertices, o.max_vertices);
    assert_string_equal(recipe, expected);
    safetensors_free(&content);
    for (size_t i = 0; i < ALL_SHAPES; i++)
        bat_mesh_free(&all[i]);
    assert_int_equal(bat_mesh_training_shapes(made, 1, (bat_progress){stop_at_once, NULL}, NULL), BAT_CANCELLED);
    for (size_t i = 0; i < BAT_MESH_TRAINING_SHAPES; i++)
        assert_null(made[i].positions);
}

/// The cage is coarse and the same on both sides.
static void test_cage(void **state)
{
    (void)state;
    bat_mesh mesh;
    assert_int_equal(bat_mesh_shape("cage", 1000, 1, &mesh, NULL), BAT_OK);
    assert_true(mesh.vertex_count >= 100 && mesh.vertex_count <= 300);
    for (size_t v = 0; v < mesh.vertex_count; v++)
    {
        const double *point = mesh.positions + 3 * v;
        double nearest = HUGE_VAL;
        for (size_t w = 0; w < mesh.vertex_count; w++)
        {
            const double *image = mesh.positions + 3 * w;
            nearest = fmin(nearest, hypot(hypot(point[0] - image[0], point[1] - image[1]), point[2] + image[2]));
        }
        assert_true(nearest < 1e-12);
    }
    bat_mesh_free(&mesh);
}

static void test_refusals(void **state)
{
    (void)state;
    bat_mesh mesh = {.vertex_count = 77};
    bat_error error;
    assert_int_equal(bat_mesh_shape("unicorn", 1000, 1, &mesh, &error), BAT_INVALID_ARGUMENT);
    assert_string_equal(error.text, "unknown shape 'unicorn'");
    assert_int_equal(bat_mesh_shape("stone", 199, 1, &mesh, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_mesh_shape("stone", 1000001, 1, &mesh, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(mesh.vertex_count, 77);
    assert_null(bat_mesh_shape_at(bat_mesh_shape_count()));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_kind), cmocka_unit_test(test_topology), cmocka_unit_test(test_same_every_time),
        cmocka_unit_test(test_cage),       cmocka_unit_test(test_refusals), cmocka_unit_test(test_shipped_recipe),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
