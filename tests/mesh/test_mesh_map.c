#include "decimate_helpers.h"

#include "batten/mesh_file.h"
#include "mesh/decimate/map.h"

#include <stdio.h>
#include <unistd.h>

/// A mesh, its decimation and the map between them.
typedef struct mesh_pair
{
    bat_mesh fine, coarse;
    bat_mesh_map *map;
} mesh_pair;

static mesh_pair pair_of(bat_mesh fine, size_t vertices, size_t candidates)
{
    mesh_pair made = {.fine = fine};
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    bat_error error = {0};
    options.vertices = vertices;
    options.candidates = candidates;
    if (bat_mesh_decimate(&fine, &options, &made.coarse, &made.map, &error) != BAT_OK)
        fail_msg("%s", error.text);
    assert_int_equal(made.coarse.vertex_count, vertices);
    return made;
}

static void pair_free(mesh_pair *pair)
{
    bat_mesh_free(&pair->fine);
    bat_mesh_free(&pair->coarse);
    bat_mesh_map_free(pair->map);
}

enum
{
    PAIRS = 6
};

static mesh_pair pair_number(size_t number)
{
    switch (number)
    {
    case 0:
        return pair_of(shape_sphere(12, 0, 1), 60, 0);
    case 1:
        return pair_of(shape_sphere(12, 0.05, 2), 60, 100);
    case 2:
        return pair_of(shape_torus(40, 16, 0.4), 70, 10);
    case 3:
        return pair_of(shape_sheet(24, 0.2, false), 40, 0);
    case 4:
        return pair_of(shape_sheet(24, 0.2, true), 60, 10);
    default:
        return pair_of(shape_cube(10), 50, 100);
    }
}

/// All flattened faces of a collapse have positive areas, with the same sum before and after. With the same outer polygon
/// both are bijections.
static void test_overlays_cover(void **state)
{
    (void)state;
    for (size_t number = 0; number < PAIRS; number++)
    {
        mesh_pair pair = pair_number(number);
        const bat_mesh_map *map = pair.map;
        assert_true(map->collapse_count > 300);
        for (size_t c = 0; c < map->collapse_count; c++)
        {
            const map_collapse *collapse = &map->collapses[c];
            double areas[2] = {0};
            for (uint32_t k = 0; k < (uint32_t)collapse->count + collapse->vanishing; k++)
                for (int after = 0; after < (k < collapse->count ? 2 : 1); after++)
                {
                    const double *corners[3];
                    map_corners(map, collapse, k, after != 0, corners);
                    double area = vector2_turn(corners[0], corners[1], corners[2]);
                    assert_true(area > 0);
                    areas[after] += area;
                }
            check_relative(areas[1], areas[0], 1e-12);
        }
        assert_int_equal(map_inspect(map, NULL), BAT_OK);
        pair_free(&pair);
    }
}

/// Points in faces, on edges and at corners of a mesh.
static bat_mesh_point *scatter(const bat_mesh *mesh, size_t count, uint64_t seed)
{
    bat_mesh_point *points = malloc(count * sizeof *points);
    bat_random random = bat_random_seed(seed);
    assert_non_null(points);
    for (size_t i = 0; i < count; i++)
    {
        double *b = points[i].barycentric;
        size_t turn = (size_t)(bat_random_bits(&random) % 3);
        double u = i % 5 == 0 ? 0 : bat_random_uniform(&random), v = i % 10 == 0 ? 0 : bat_random_uniform(&random);
        points[i].face = (uint32_t)(bat_random_bits(&random) % mesh->face_count);
        b[turn] = u * v;
        b[(turn + 1) % 3] = u * (1 - v);
        b[(turn + 2) % 3] = 1 - u;
        double sum = b[0] + b[1] + b[2];
        for (int c = 0; c < 3; c++)
            b[c] /= sum;
    }
    return points;
}

static void check_round_trip(const mesh_pair *pair, bool from_coarse)
{
    enum
    {
        COUNT = 3000
    };
    const bat_mesh *mesh = from_coarse ? &pair->coarse : &pair->fine;
    bat_mesh_point *points = scatter(mesh, COUNT, 11), *carried = malloc(COUNT * sizeof *carried);
    assert_non_null(carried);
    memcpy(carried, points, COUNT * sizeof *carried);
    assert_int_equal((from_coarse ? bat_mesh_map_to_fine : bat_mesh_map_to_coarse)(pair->map, carried, COUNT, NULL), BAT_OK);
    assert_int_equal((from_coarse ? bat_mesh_map_to_coarse : bat_mesh_map_to_fine)(pair->map, carried, COUNT, NULL), BAT_OK);
    for (size_t i = 0; i < COUNT; i++)
    {
        double there[3], back[3];
        shape_point(mesh, &points[i], there);
        shape_point(mesh, &carried[i], back);
        check_near(shape_distance(there, back), 0, 1e-9);
    }
    free(points);
    free(carried);
}

static void test_round_trips(void **state)
{
    (void)state;
    for (size_t number = 0; number < PAIRS; number++)
    {
        mesh_pair pair = pair_number(number);
        check_round_trip(&pair, true);
        check_round_trip(&pair, false);
        pair_free(&pair);
    }
}

/// Map points on all boundary edges of one mesh to the other. They must lie on boundary edges.
static void check_boundary(const mesh_pair *pair, bool to_fine)
{
    const bat_mesh *from = to_fine ? &pair->coarse : &pair->fine, *to = to_fine ? &pair->fine : &pair->coarse;
    bat_mesh_connectivity here, there;
    assert_int_equal(bat_mesh_connect(from, &here, NULL), BAT_OK);
    assert_int_equal(bat_mesh_connect(to, &there, NULL), BAT_OK);
    assert_true(here.boundary_edge_count > 0);
    for (uint32_t h = 0; h < 3 * from->face_count; h++)
        for (int i = 0; i <= 10 && here.twin[h] == BAT_MESH_NONE; i++)
        {
            bat_mesh_point point = {h / 3, {0}};
            point.barycentric[h % 3] = 1 - i / 10.0;
            point.barycentric[bat_mesh_next(h) % 3] = i / 10.0;
            assert_int_equal((to_fine ? bat_mesh_map_to_fine : bat_mesh_map_to_coarse)(pair->map, &point, 1, NULL), BAT_OK);
            double nearest = 1;
            for (uint32_t c = 0; c < 3; c++)
                if (there.twin[3 * point.face + c] == BAT_MESH_NONE)
                    nearest = fmin(nearest, point.barycentric[(c + 2) % 3]);
            // A corner may belong to a face that touches the boundary only there.
            for (uint32_t c = 0; c < 3; c++)
                if (there.twin[there.first[to->faces[3 * point.face + c]]] == BAT_MESH_NONE)
                    nearest = fmin(nearest, 1 - point.barycentric[c]);
            check_near(nearest, 0, 1e-12);
        }
    bat_mesh_connectivity_free(&here);
    bat_mesh_connectivity_free(&there);
}

static void test_boundaries_stay(void **state)
{
    (void)state;
    for (size_t number = 3; number <= 4; number++)
    {
        mesh_pair pair = pair_number(number);
        check_boundary(&pair, true);
        check_boundary(&pair, false);
        pair_free(&pair);
    }
}

/// The signed solid angle of a triangle from the origin (van Oosterom and Strackee, 1983).
static double solid_angle(const double *a, const double *b, const double *c)
{
    double triple = 0, la = 0, lb = 0, lc = 0, ab = 0, bc = 0, ca = 0;
    for (size_t k = 0; k < 3; k++)
    {
        size_t l = (k + 1) % 3, m = (k + 2) % 3;
        triple += a[k] * (b[l] * c[m] - b[m] * c[l]);
        la += a[k] * a[k];
        lb += b[k] * b[k];
        lc += c[k] * c[k];
        ab += a[k] * b[k];
        bc += b[k] * c[k];
        ca += c[k] * a[k];
    }
    la = sqrt(la);
    lb = sqrt(lb);
    lc = sqrt(lc);
    return 2 * atan2(triple, la * lb * lc + ab * lc + bc * la + ca * lb);
}

/// Split all faces in four at the midpoints of their edges; positions are not set.
static bat_mesh split(const bat_mesh *mesh)
{
    bat_mesh_connectivity connectivity;
    assert_int_equal(bat_mesh_connect(mesh, &connectivity, NULL), BAT_OK);
    bat_mesh fine = shape_room(mesh->vertex_count + connectivity.edge_count, 4 * mesh->face_count);
    for (size_t f = 0; f < mesh->face_count; f++)
        for (size_t c = 0; c < 3; c++)
        {
            uint32_t *corner = fine.faces + 3 * (4 * f + c);
            corner[0] = mesh->faces[3 * f + c];
            corner[1] = fine.faces[3 * (4 * f + 3) + c] = (uint32_t)mesh->vertex_count + connectivity.edge[3 * f + c];
            corner[2] = (uint32_t)mesh->vertex_count + connectivity.edge[3 * f + (c + 2) % 3];
        }
    bat_mesh_connectivity_free(&connectivity);
    return fine;
}

/// The images on the fine mesh of the vertices of the subdivided coarse one.
static void find_images(const mesh_pair *pair, size_t levels, double *positions)
{
    bat_mesh_point *points;
    size_t count;
    assert_int_equal(bat_mesh_midpoints(&pair->coarse, levels, &points, &count, NULL), BAT_OK);
    assert_int_equal(bat_mesh_map_to_fine(pair->map, points, count, NULL), BAT_OK);
    for (size_t v = 0; v < count; v++)
        shape_point(&pair->fine, &points[v], positions + 3 * v);
    free(points);
}

/// The images of a sphere's vertices, subdivided twice, cover the sphere once: no face is inverted, and the solid angles add
/// up to 4 pi.
static void test_images_cover_the_sphere(void **state)
{
    (void)state;
    for (size_t candidates = 0; candidates <= 100; candidates += 50)
    {
        mesh_pair pair = pair_of(shape_sphere(16, 0, 1), 150, candidates);
        bat_mesh once = split(&pair.coarse), twice = split(&once);
        find_images(&pair, 2, twice.positions);
        double sum = 0;
        for (size_t f = 0; f < twice.face_count; f++)
        {
            double angle = solid_angle(shape_corner(&twice, f, 0), shape_corner(&twice, f, 1), shape_corner(&twice, f, 2));
            assert_true(angle > 0);
            sum += angle;
        }
        check_near(sum, 4 * 3.14159265358979323846, 1e-9);
        bat_mesh_free(&once);
        bat_mesh_free(&twice);
        pair_free(&pair);
    }
}

/// Midpoints are in the order of the edges, at the mean of their ends.
static void test_midpoints(void **state)
{
    (void)state;
    bat_mesh torus = shape_torus(7, 5, 0.4), mesh = split(&torus), finer;
    bat_mesh_point *points;
    size_t count;
    memcpy(mesh.positions, torus.positions, 3 * torus.vertex_count * sizeof(double));
    for (size_t levels = 1; levels <= 3; levels++)
    {
        const bat_mesh *before = levels == 1 ? &torus : &finer;
        bat_mesh_connectivity connectivity;
        assert_int_equal(bat_mesh_connect(before, &connectivity, NULL), BAT_OK);
        bat_mesh after = split(before);
        memcpy(after.positions, before->positions, 3 * before->vertex_count * sizeof(double));
        for (uint32_t h = 0; h < 3 * before->face_count; h++)
            for (size_t k = 0; k < 3; k++)
                after.positions[3 * (before->vertex_count + connectivity.edge[h]) + k] =
                    (shape_corner(before, h / 3, h % 3)[k] + shape_corner(before, h / 3, (h + 1) % 3)[k]) / 2;
        assert_int_equal(bat_mesh_midpoints(&torus, levels, &points, &count, NULL), BAT_OK);
        assert_int_equal(count, after.vertex_count);
        for (size_t v = 0; v < count; v++)
        {
            double position[3];
            shape_point(&torus, &points[v], position);
            check_near(shape_distance(position, after.positions + 3 * v), 0, 1e-14);
        }
        free(points);
        bat_mesh_connectivity_free(&connectivity);
        if (levels > 1)
            bat_mesh_free(&finer);
        finer = after;
    }
    bat_mesh_free(&finer);
    bat_mesh_free(&mesh);
    bat_mesh_free(&torus);
}

/// A mesh whose channels and texture are its own coordinates gets the map's images.
static void test_transfer(void **state)
{
    (void)state;
    bat_mesh sheet = shape_sheet(20, 0.2, false);
    sheet.channel_count = 3;
    sheet.channels = malloc(3 * sheet.vertex_count * sizeof(double));
    sheet.channel_names = calloc(3, sizeof *sheet.channel_names);
    sheet.texture_count = sheet.vertex_count;
    sheet.texture = malloc(2 * sheet.vertex_count * sizeof(double));
    sheet.texture_faces = malloc(3 * sheet.face_count * sizeof(uint32_t));
    memcpy(sheet.channels, sheet.positions, 3 * sheet.vertex_count * sizeof(double));
    memcpy(sheet.texture_faces, sheet.faces, 3 * sheet.face_count * sizeof(uint32_t));
    for (size_t i = 0; i < 3; i++)
    {
        sheet.channel_names[i] = calloc(2, 1);
        sheet.channel_names[i][0] = (char)('x' + i);
    }
    for (size_t i = 0; i < 2 * sheet.vertex_count; i++)
        sheet.texture[i] = sheet.positions[i / 2 * 3 + i % 2];
    mesh_pair pair = pair_of(sheet, 60, 0);
    bat_mesh refined = split(&pair.coarse);
    size_t count = refined.vertex_count;
    find_images(&pair, 1, refined.positions);
    for (int again = 0; again < 2; again++)
        assert_int_equal(bat_mesh_map_transfer(pair.map, &pair.fine, &pair.coarse, 1, &refined, NULL), BAT_OK);
    assert_int_equal(refined.channel_count, 3);
    assert_int_equal(refined.texture_count, count);
    assert_string_equal(refined.channel_names[2], "z");
    assert_int_equal(bat_mesh_check(&refined, NULL), BAT_OK);
    for (size_t v = 0; v < count; v++)
    {
        check_near(shape_distance(refined.channels + 3 * v, refined.positions + 3 * v), 0, 1e-15);
    }
    for (size_t i = 0; i < 3 * refined.face_count; i++)
        for (size_t k = 0; k < 2; k++)
            check_near(refined.texture[2 * refined.texture_faces[i] + k],
                       refined.positions[3 * (size_t)refined.faces[i] + k], 1e-15);
    bat_error error;
    assert_int_equal(bat_mesh_map_transfer(pair.map, &pair.fine, &pair.coarse, 2, &refined, &error), BAT_INVALID_ARGUMENT);
    bat_mesh_free(&refined);
    pair_free(&pair);
}

/// A torus with its angles as texture coordinates has seams. After decimation and transfer no face's texture is larger than
/// the face. Without decimation, the texture returns exactly.
static void test_seams(void **state)
{
    (void)state;
    enum
    {
        N = 48,
        M = 20
    };
    for (int decimated = 0; decimated < 2; decimated++)
    {
        bat_mesh torus = shape_torus(N, M, 0.4);
        torus.texture_count = (N + 1) * (M + 1);
        torus.texture = malloc(2 * torus.texture_count * sizeof(double));
        torus.texture_faces = malloc(3 * torus.face_count * sizeof(uint32_t));
        for (size_t i = 0; i <= N; i++)
            for (size_t j = 0; j <= M; j++)
            {
                torus.texture[2 * (i * (M + 1) + j)] = (double)i / N;
                torus.texture[2 * (i * (M + 1) + j) + 1] = (double)j / M;
            }
        for (size_t f = 0; f < torus.face_count; f++)
            for (size_t c = 0; c < 3; c++)
            {
                size_t i = f / 2 / M, j = f / 2 % M, v = torus.faces[3 * f + c], vi = v / M, vj = v % M;
                vi += vi < i ? N : 0;
                vj += vj < j ? M : 0;
                torus.texture_faces[3 * f + c] = (uint32_t)(vi * (M + 1) + vj);
            }
        mesh_pair pair = pair_of(torus, decimated ? 200 : N * M, 0);
        assert_int_equal(bat_mesh_map_transfer(pair.map, &pair.fine, &pair.coarse, 0, &pair.coarse, NULL), BAT_OK);
        assert_int_equal(bat_mesh_check(&pair.coarse, NULL), BAT_OK);
        double widest = 0;
        for (size_t f = 0; f < pair.coarse.face_count; f++)
            for (size_t c = 0; c < 3; c++)
            {
                const double *a = pair.coarse.texture + 2 * (size_t)pair.coarse.texture_faces[3 * f + c],
                             *b = pair.coarse.texture + 2 * (size_t)pair.coarse.texture_faces[3 * f + (c + 1) % 3],
                             *from = pair.fine.texture + 2 * (size_t)pair.fine.texture_faces[3 * f + c];
                double length = shape_distance(shape_corner(&pair.coarse, f, c), shape_corner(&pair.coarse, f, (c + 1) % 3));
                widest = fmax(widest, hypot(a[0] - b[0], a[1] - b[1]) / length);
                if (!decimated)
                    assert_memory_equal(a, from, 2 * sizeof(double));
            }
        // Lengths in the texture are at most lengths on the torus over 2 pi 0.4.
        assert_true(widest < 1.5 / (2 * 3.14159 * 0.4));
        pair_free(&pair);
    }
}

/// With nothing to collapse the map is the identity.
static void test_identity(void **state)
{
    (void)state;
    bat_mesh torus = shape_torus(9, 7, 0.4);
    size_t vertices = torus.vertex_count;
    mesh_pair pair = pair_of(torus, vertices, 0);
    bat_mesh_point *points = scatter(&pair.fine, 200, 3), *carried = scatter(&pair.fine, 200, 3);
    assert_int_equal(bat_mesh_map_to_coarse(pair.map, carried, 200, NULL), BAT_OK);
    assert_int_equal(bat_mesh_map_to_fine(pair.map, carried, 200, NULL), BAT_OK);
    for (size_t i = 0; i < 200; i++)
    {
        assert_int_equal(points[i].face, carried[i].face);
        assert_memory_equal(points[i].barycentric, carried[i].barycentric, sizeof points[i].barycentric);
    }
    free(points);
    free(carried);
    pair_free(&pair);
}

static void test_points_are_checked(void **state)
{
    (void)state;
    mesh_pair pair = pair_number(0);
    bat_error error;
    bat_mesh_point points[2] = {{0, {1, 0, 0}}, {(uint32_t)pair.coarse.face_count, {1, 0, 0}}};
    assert_int_equal(bat_mesh_map_to_fine(pair.map, points, 2, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    points[1] = (bat_mesh_point){0, {0.5, 0.6, -0.1}};
    assert_int_equal(bat_mesh_map_to_fine(pair.map, points, 2, &error), BAT_INVALID_POINT);
    points[1] = (bat_mesh_point){0, {0.5, 0.6, NAN}};
    assert_int_equal(bat_mesh_map_to_coarse(pair.map, points, 2, &error), BAT_INVALID_POINT);
    assert_true(points[0].face == 0 && points[0].barycentric[0] == 1);
    pair_free(&pair);
}

// Files

static void temporary_path(char *path, size_t size)
{
    (void)snprintf(path, size, "/tmp/batten-map-XXXXXX");
    int file = mkstemp(path);
    assert_true(file >= 0);
    (void)close(file);
}

static void test_files(void **state)
{
    (void)state;
    char path[64];
    temporary_path(path, sizeof path);
    for (size_t number = 0; number < PAIRS; number += 2)
    {
        mesh_pair pair = pair_number(number);
        bat_mesh_map *read = NULL;
        bat_error error = {0};
        assert_int_equal(bat_mesh_map_write(path, pair.map, NULL), BAT_OK);
        if (bat_mesh_map_read(path, &pair.fine, &pair.coarse, &read, &error) != BAT_OK)
            fail_msg("%s", error.text);
        assert_int_equal(read->collapse_count, pair.map->collapse_count);
        assert_int_equal(read->coarse_faces, pair.coarse.face_count);
        bat_mesh_point *points = scatter(&pair.coarse, 500, 5), *others = scatter(&pair.coarse, 500, 5);
        assert_int_equal(bat_mesh_map_to_fine(pair.map, points, 500, NULL), BAT_OK);
        assert_int_equal(bat_mesh_map_to_fine(read, others, 500, NULL), BAT_OK);
        for (size_t i = 0; i < 500; i++)
        {
            assert_int_equal(points[i].face, others[i].face);
            assert_memory_equal(points[i].barycentric, others[i].barycentric, sizeof points[i].barycentric);
        }
        assert_int_equal(bat_mesh_map_to_coarse(read, others, 500, NULL), BAT_OK);
        bat_mesh_map_free(read);
        read = NULL;
        assert_int_equal(bat_mesh_map_read(path, &pair.coarse, NULL, &read, &error), BAT_INVALID_ARGUMENT);
        assert_null(read);
        free(points);
        free(others);
        pair_free(&pair);
    }
    (void)unlink(path);
}

/// A damaged file is refused, or its map can carry points.
static void test_spoiled_files(void **state)
{
    (void)state;
    char path[64];
    temporary_path(path, sizeof path);
    mesh_pair pair = pair_of(shape_sphere(4, 0.05, 1), 30, 0);
    assert_int_equal(bat_mesh_map_write(path, pair.map, NULL), BAT_OK);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    static unsigned char bytes[1 << 20], spoiled[1 << 20];
    size_t size = fread(bytes, 1, sizeof bytes, file), refused = 0;
    (void)fclose(file);
    assert_true(size > 1000 && size < sizeof bytes);
    bat_random random = bat_random_seed(9);
    for (int i = 0; i < 400; i++)
    {
        memcpy(spoiled, bytes, size);
        size_t left = i % 10 == 0 ? (size_t)(bat_random_bits(&random) % size) : size;
        for (int k = 0; k <= i % 3; k++)
            spoiled[bat_random_bits(&random) % size] ^= (unsigned char)(1 + bat_random_bits(&random) % 255);
        file = fopen(path, "wb");
        assert_non_null(file);
        assert_int_equal(fwrite(spoiled, 1, left, file), left);
        (void)fclose(file);
        bat_mesh_map *read = NULL;
        bat_error error = {0};
        if (bat_mesh_map_read(path, NULL, NULL, &read, &error) != BAT_OK)
        {
            refused++;
            assert_true(error.text[0] != 0);
            continue;
        }
        bat_mesh_point *points = scatter(&pair.coarse, 200, 5);
        assert_int_equal(bat_mesh_map_to_fine(read, points, 200, NULL), BAT_OK);
        assert_int_equal(bat_mesh_map_to_coarse(read, points, 200, NULL), BAT_OK);
        free(points);
        bat_mesh_map_free(read);
    }
    assert_true(refused > 40);
    (void)unlink(path);
    pair_free(&pair);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_overlays_cover),
        cmocka_unit_test(test_round_trips),
        cmocka_unit_test(test_boundaries_stay),
        cmocka_unit_test(test_images_cover_the_sphere),
        cmocka_unit_test(test_midpoints),
        cmocka_unit_test(test_transfer),
        cmocka_unit_test(test_seams),
        cmocka_unit_test(test_identity),
        cmocka_unit_test(test_points_are_checked),
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_spoiled_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
