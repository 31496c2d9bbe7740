// Values, labels, atlases and images that go from a mesh to its decimation, and chains of meshes.
#include "decimate_helpers.h"

#include "batten/mesh_file.h"
#include "batten/mesh_transfer.h"
#include "linalg/vector.h"

/// A mesh with a channel, its decimation and the map between them.
typedef struct mesh_pair
{
    bat_mesh fine, coarse;
    bat_mesh_map *map;
} mesh_pair;

static mesh_pair pair_of(bat_mesh fine, size_t vertices)
{
    static const char *const names[] = {"red", "green", "blue"};
    mesh_pair made = {.fine = fine};
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    bat_error error = {0};
    made.fine.channels = malloc(fine.vertex_count * 3 * sizeof(double));
    made.fine.channel_names = malloc(3 * sizeof(char *));
    made.fine.channel_count = 3;
    for (size_t k = 0; k < 3; k++)
        made.fine.channel_names[k] = strdup(names[k]);
    for (size_t i = 0; i < 3 * fine.vertex_count; i++)
        made.fine.channels[i] = i % 3 == 0 ? 0.25 : 0.5 + 0.25 * fine.positions[i];
    options.vertices = vertices;
    if (bat_mesh_decimate(&made.fine, &options, &made.coarse, &made.map, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return made;
}

static void pair_free(mesh_pair *pair)
{
    bat_mesh_free(&pair->fine);
    bat_mesh_free(&pair->coarse);
    bat_mesh_map_free(pair->map);
}

/// Constant values stay, linear ones return up to the shape's error, and none leaves its range.
static void test_values(void **state)
{
    (void)state;
    mesh_pair pair = pair_of(shape_sphere(20, 0, 1), 80);
    double *normals, worst = 0;
    assert_int_equal(bat_mesh_transfer(pair.map, &pair.fine, &pair.coarse, &normals, NULL), BAT_OK);
    assert_int_equal(pair.coarse.channel_count, 3);
    for (size_t v = 0; v < pair.coarse.vertex_count; v++)
    {
        const double *at = pair.coarse.positions + 3 * v, *values = pair.coarse.channels + 3 * v;
        double length = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]), along = 0;
        assert_true(fabs(values[0] - 0.25) < 1e-9);
        for (size_t k = 1; k < 3; k++)
        {
            worst = fmax(worst, fabs(values[k] - (0.5 + 0.25 * at[k])));
            assert_true(values[k] >= 0.25 && values[k] <= 0.75);
        }
        for (size_t k = 0; k < 3; k++)
            along += normals[3 * v + k] * at[k] / length;
        assert_true(along > 0.98);
    }
    assert_true(worst < 0.03);
    free(normals);
    pair_free(&pair);
}

/// Give the faces of a mesh two labels, by the sign of x.
static void label_halves(bat_mesh *mesh)
{
    mesh->labels = calloc(2, sizeof *mesh->labels);
    mesh->label_count = 2;
    mesh->labels[1].material = strdup("right");
    mesh->face_labels = malloc(mesh->face_count * sizeof *mesh->face_labels);
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        double x = 0;
        for (size_t c = 0; c < 3; c++)
            x += mesh->positions[3 * mesh->faces[3 * f + c]];
        mesh->face_labels[f] = x > 0;
    }
}

/// Labels that were lost come back by area.
static void test_labels(void **state)
{
    (void)state;
    bat_mesh fine = shape_sphere(20, 0, 1);
    label_halves(&fine);
    mesh_pair pair = pair_of(fine, 80);
    bat_mesh expected;
    assert_int_equal(bat_mesh_copy(&pair.coarse, &expected, NULL), BAT_OK);
    memset(pair.coarse.face_labels, 0, pair.coarse.face_count * sizeof *pair.coarse.face_labels);
    assert_int_equal(bat_mesh_transfer(pair.map, &pair.fine, &pair.coarse, NULL, NULL), BAT_OK);
    assert_memory_equal(pair.coarse.face_labels, expected.face_labels, expected.face_count * sizeof *expected.face_labels);
    bat_mesh_free(&expected);
    pair_free(&pair);
}

/// The charts of an atlas lie in the unit square, keep orientation, and no point lies in two faces.
static void test_atlas(void **state)
{
    (void)state;
    bat_mesh meshes[] = {shape_torus(40, 16, 0.4), shape_cube(6), shape_sheet(24, 0.2, false)};
    for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++)
    {
        bat_mesh *mesh = &meshes[i];
        bat_mesh_unwrap_options options = bat_mesh_unwrap_defaults();
        size_t charts;
        options.size = 256;
        assert_int_equal(bat_mesh_unwrap(mesh, &options, &charts, NULL), BAT_OK);
        assert_int_equal(bat_mesh_check(mesh, NULL), BAT_OK);
        assert_true(charts >= (i == 1 ? 6 : 1) && charts < mesh->face_count / 4);
        unsigned char *owners = calloc(256, 256);
        double covered = 0;
        for (size_t f = 0; f < mesh->face_count; f++)
        {
            const double *p[3];
            for (size_t c = 0; c < 3; c++)
            {
                p[c] = mesh->texture + 2 * mesh->texture_faces[3 * f + c];
                assert_true(p[c][0] > 0 && p[c][0] < 1 && p[c][1] > 0 && p[c][1] < 1);
            }
            double area = vector2_turn(p[0], p[1], p[2]);
            assert_true(area > 0);
            covered += area / 2;
            for (size_t t = 0; t < (size_t)256 * 256; t++)
            {
                const double at[2] = {((double)(t % 256) + 0.5) / 256, ((double)(t / 256) + 0.5) / 256};
                if (vector2_turn(p[0], p[1], at) > 0 && vector2_turn(p[1], p[2], at) > 0 && vector2_turn(p[2], p[0], at) > 0)
                    assert_int_equal(owners[t]++, 0);
            }
        }
        assert_true(covered > 0.3);
        free(owners);
        bat_mesh_free(mesh);
    }
}

/// On a flat mesh tangents follow the texture, and its mirror image turns the sign of the bitangent.
static void test_tangents(void **state)
{
    (void)state;
    bat_mesh mesh = shape_sheet(4, 0, false);
    double *normals = malloc(mesh.vertex_count * 3 * sizeof *normals), *tangents;
    mesh.texture = calloc(mesh.vertex_count, 2 * sizeof *mesh.texture);
    mesh.texture_faces = malloc(mesh.face_count * 3 * sizeof *mesh.texture_faces);
    memcpy(mesh.texture_faces, mesh.faces, mesh.face_count * 3 * sizeof *mesh.faces);
    mesh.texture_count = mesh.vertex_count;
    assert_int_equal(bat_mesh_vertex_normals(&mesh, BAT_MESH_NORMALS_AREA, normals, NULL), BAT_OK);
    for (int sign = -1; sign <= 1; sign += 2)
    {
        for (size_t v = 0; v < mesh.vertex_count; v++)
        {
            mesh.texture[2 * v] = sign * mesh.positions[3 * v];
            mesh.texture[2 * v + 1] = mesh.positions[3 * v + 1];
        }
        assert_int_equal(bat_mesh_tangents(&mesh, normals, &tangents, NULL), BAT_OK);
        for (size_t h = 0; h < 3 * mesh.face_count; h++)
        {
            // the sheet is tilted: x runs along (0.6, 0, 0.8)
            assert_true(fabs(tangents[4 * h] - 0.6 * sign) < 1e-12 && fabs(tangents[4 * h + 2] - 0.8 * sign) < 1e-12);
            assert_true(tangents[4 * h + 3] == sign);
        }
        free(tangents);
    }
    free(normals);
    bat_mesh_free(&mesh);
}

/// A baked map says the fine mesh's normals, colours are those of the map, and a convex shape has no occlusion.
static void test_images(void **state)
{
    (void)state;
    mesh_pair pair = pair_of(shape_sphere(20, 0, 1), 60);
    bat_mesh_bake_options options = bat_mesh_bake_defaults();
    bat_mesh_baked baked[2];
    options.unwrap.size = 128;
    options.colour = options.occlusion = true;
    for (int i = 0; i < 2; i++)
    {
        options.threads = 1 + 2 * i;
        assert_int_equal(bat_mesh_bake(pair.map, &pair.fine, &pair.coarse, &options, &baked[i], NULL), BAT_OK);
        assert_int_equal(baked[i].charts > 0, i == 0); // the second run finds the atlas of the first
        assert_true(baked[i].max_turn < 0.03 && baked[i].texels > 128 * 128 / 4);
        assert_memory_equal(baked[i].normal.pixels, baked[0].normal.pixels, 3 * 128 * 128);
    }
    size_t occluded = 0, reddish = 0;
    for (size_t i = 0; i < (size_t)128 * 128; i++)
    {
        const unsigned char *colour = baked[0].colour.pixels + 3 * i;
        occluded += baked[0].occlusion.pixels[3 * i] < 250;
        reddish += colour[0] == 64;
        assert_true(colour[0] == 64 || colour[0] == 128);
        assert_true(colour[1] >= 63 && colour[1] <= 192);
    }
    assert_int_equal(occluded, 0);
    assert_true(reddish >= baked[0].texels);
    options.unwrap.size = 16;
    options.unwrap.padding = 64;
    bat_mesh_free(&pair.coarse);
    assert_int_equal(bat_mesh_bake(pair.map, &pair.fine, &pair.fine, &options, &baked[1], NULL), BAT_INVALID_ARGUMENT);
    bat_mesh_baked_free(&baked[0]);
    bat_mesh_baked_free(&baked[1]);
    pair_free(&pair);
}

static void paint_face(const void *context, const bat_mesh_point *point, unsigned char colour[3])
{
    colour[0] = (unsigned char)(point->face % 251);
    colour[1] = *(const unsigned char *)context;
    colour[2] = (unsigned char)(255 * point->barycentric[0]);
}

/// Colours come from a painter, at points all over the fine mesh, also where it has no colours of its own.
static void test_painter(void **state)
{
    (void)state;
    static const unsigned char mark = 77;
    mesh_pair pair = pair_of(shape_sphere(20, 0, 1), 60);
    const bat_mesh_painter painter = {paint_face, &mark};
    bat_mesh_bake_options options = bat_mesh_bake_defaults();
    bat_mesh_baked baked;
    bat_error error;
    options.unwrap.size = 128;
    options.unwrap.padding = 1;
    options.normal = false;
    options.colour = true;
    free(pair.fine.channel_names[0]);
    pair.fine.channel_names[0] = strdup("weight");
    assert_int_equal(bat_mesh_bake(pair.map, &pair.fine, &pair.coarse, &options, &baked, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_mesh_bake_painted(pair.map, &pair.fine, &pair.coarse, &options, &painter, &baked, &error), BAT_OK);
    size_t marked = 0, faces = 0;
    bool seen[251] = {0};
    for (size_t i = 0; i < (size_t)128 * 128; i++)
    {
        const unsigned char *colour = baked.colour.pixels + 3 * i;
        marked += colour[1] == mark;
        faces += colour[1] == mark && !seen[colour[0]];
        seen[colour[0]] = seen[colour[0]] || colour[1] == mark;
    }
    assert_true(marked >= baked.texels && faces == 251);
    bat_mesh_baked_free(&baked);
    pair_free(&pair);
}

/// Levels of detail have their numbers of faces and lie within one file, whose reader takes the first.
static void test_levels(void **state)
{
    (void)state;
    static const double shares[] = {1, 0.5, 0.1}, wrong[] = {0.5, 0.5};
    bat_mesh fine = shape_torus(40, 16, 0.4), levels[3] = {{0}}, read;
    double distances[3];
    bat_error error;
    assert_int_equal(bat_mesh_lods(&fine, wrong, 2, NULL, levels, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 1);
    assert_int_equal(bat_mesh_lods(&fine, shares, 3, NULL, levels, distances, NULL), BAT_OK);
    assert_int_equal(levels[0].face_count, 1280);
    assert_int_equal(levels[1].face_count, 640);
    assert_int_equal(levels[2].face_count, 128);
    assert_true(distances[0] == 0 && distances[1] > 0 && distances[2] > distances[1]);
    bat_mesh_write_options options = bat_mesh_write_defaults();
    char *bytes;
    size_t size;
    options.format = BAT_MESH_FORMAT_GLTF;
    options.lods = levels + 1;
    options.lod_distances = distances + 1;
    options.lod_count = 2;
    assert_int_equal(bat_mesh_write_memory(&levels[0], &options, &bytes, &size, NULL), BAT_OK);
    assert_non_null(strstr(bytes, "\"MSFT_lod\":{\"ids\":[1,2]}"));
    assert_int_equal(bat_mesh_read_memory(bytes, size, NULL, &read, NULL), BAT_OK);
    assert_int_equal(read.face_count, 1280);
    free(bytes);
    options.format = BAT_MESH_FORMAT_PLY;
    assert_int_equal(bat_mesh_write_memory(&levels[0], &options, &bytes, &size, NULL), BAT_INVALID_ARGUMENT);
    bat_mesh_free(&read);
    bat_mesh_free(&fine);
    for (size_t i = 0; i < 3; i++)
        bat_mesh_free(&levels[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values),   cmocka_unit_test(test_labels), cmocka_unit_test(test_atlas),
        cmocka_unit_test(test_tangents), cmocka_unit_test(test_images), cmocka_unit_test(test_painter),
        cmocka_unit_test(test_levels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
