// Repair and welding: dropped, turned, cut and copied data, and results that have connectivity.
#include "check.h"

#include "batten/mesh.h"

/// A mesh with distinct positions over its own arrays.
static bat_mesh mesh_of(const uint32_t *faces, size_t face_count, size_t vertex_count)
{
    bat_mesh mesh = {.positions = malloc(vertex_count * 3 * sizeof(double)),
                     .faces = malloc(face_count * 3 * sizeof(uint32_t)),
                     .vertex_count = vertex_count,
                     .face_count = face_count};
    for (size_t i = 0; i < 3 * vertex_count; i++)
        mesh.positions[i] = sin((double)(i * i));
    memcpy(mesh.faces, faces, face_count * 3 * sizeof *faces);
    return mesh;
}

static bool same_report(const bat_mesh_repair_report *a, const bat_mesh_repair_report *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

/// Repair a mesh. The result has connectivity, and a second repair changes nothing.
static bat_mesh must_repair(const bat_mesh *mesh, bat_mesh_repair_report *report, size_t *boundary)
{
    bat_mesh repaired, again;
    bat_mesh_connectivity connectivity;
    bat_mesh_repair_report nothing = {0}, second;
    bat_error error = {0};
    if (bat_mesh_repair(mesh, report, &repaired, &error) != BAT_OK ||
        bat_mesh_connect(&repaired, &connectivity, &error) != BAT_OK || bat_mesh_check(&repaired, &error) != BAT_OK)
        fail_msg("%s", error.text);
    if (boundary != NULL)
        *boundary = connectivity.boundary_edge_count;
    bat_mesh_connectivity_free(&connectivity);
    assert_int_equal(bat_mesh_repair(&repaired, &second, &again, &error), BAT_OK);
    assert_true(same_report(&second, &nothing));
    assert_int_equal(again.vertex_count, repaired.vertex_count);
    assert_memory_equal(again.faces, repaired.faces, repaired.face_count * 3 * sizeof(uint32_t));
    bat_mesh_free(&again);
    return repaired;
}

static void check_report(const bat_mesh_repair_report *report, bat_mesh_repair_report expected)
{
    const size_t *a = (const size_t *)report, *b = (const size_t *)&expected;
    for (size_t i = 0; i < sizeof expected / sizeof *a; i++)
        if (a[i] != b[i])
            fail_msg("count %zu of the report is %zu instead of %zu", i, a[i], b[i]);
}

static void test_good_meshes_stay(void **state)
{
    (void)state;
    const uint32_t faces[] = {0, 1, 2, 0, 2, 3, 0, 3, 1, 3, 2, 1};
    bat_mesh mesh = mesh_of(faces, 4, 4);
    bat_mesh_repair_report report;
    bat_mesh repaired = must_repair(&mesh, &report, NULL);
    check_report(&report, (bat_mesh_repair_report){0});
    assert_memory_equal(repaired.faces, mesh.faces, sizeof faces);
    assert_memory_equal(repaired.positions, mesh.positions, 12 * sizeof(double));
    bat_mesh_free(&mesh);
    bat_mesh_free(&repaired);
}

static void test_faces_that_are_dropped(void **state)
{
    (void)state;
    const uint32_t faces[] = {7, 7, 0, 0, 1, 2, 1, 2, 0, 2, 1, 3, 2, 0, 1, 4, 5, 4, 3, 2, 1, 9, 9, 9};
    bat_mesh mesh = mesh_of(faces, 8, 10);
    bat_mesh_repair_report report;
    bat_mesh repaired = must_repair(&mesh, &report, NULL);
    check_report(&report, (bat_mesh_repair_report){.degenerate_faces = 3, .duplicate_faces = 3, .unused_vertices = 6});
    const uint32_t left[] = {0, 1, 2, 2, 1, 3};
    assert_int_equal(repaired.face_count, 2);
    assert_memory_equal(repaired.faces, left, sizeof left);
    bat_mesh_free(&mesh);
    bat_mesh_free(&repaired);
}

static void test_faces_are_turned(void **state)
{
    (void)state;
    // An octahedron and, separate from it, a strip of two faces.
    const uint32_t faces[] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5, 6, 7, 8, 7, 8, 9};
    for (unsigned turned = 0; turned < 256; turned++)
    {
        bat_mesh mesh = mesh_of(faces, 10, 10);
        size_t count = 0;
        for (size_t f = 0; f < 8; f++)
            if ((turned >> f & 1) != 0)
            {
                uint32_t *corner = mesh.faces + 3 * f, kept = corner[0];
                corner[0] = corner[1];
                corner[1] = kept;
                count++;
            }
        bat_mesh_repair_report report;
        size_t boundary;
        bat_mesh repaired = must_repair(&mesh, &report, &boundary);
        check_report(&report, (bat_mesh_repair_report){.flipped_faces = 1 + (count < 8 - count ? count : 8 - count)});
        assert_int_equal(boundary, 4);
        const uint32_t strip[] = {6, 7, 8, 7, 9, 8}; // of two groups of equal size, the first face's remains
        assert_memory_equal(repaired.faces + 24, strip, sizeof strip);
        bat_mesh_free(&mesh);
        bat_mesh_free(&repaired);
    }
}

/// Two solids that touch along an edge become two closed solids.
static void test_solids_at_one_edge(void **state)
{
    (void)state;
    const uint32_t faces[] = {0, 1, 2, 0, 2, 3, 0, 3, 1, 3, 2, 1, 0, 1, 4, 0, 4, 5, 0, 5, 1, 5, 4, 1};
    bat_mesh mesh = mesh_of(faces, 8, 6);
    bat_mesh_repair_report report;
    size_t boundary;
    bat_mesh repaired = must_repair(&mesh, &report, &boundary);
    check_report(&report, (bat_mesh_repair_report){.nonmanifold_edges = 1, .split_vertices = 2, .added_vertices = 2});
    assert_int_equal(boundary, 0);
    const uint32_t second[] = {6, 7, 4, 6, 4, 5, 6, 5, 7, 5, 4, 7};
    assert_memory_equal(repaired.faces, faces, 12 * sizeof *faces);
    assert_memory_equal(repaired.faces + 12, second, sizeof second);
    assert_memory_equal(repaired.positions + 18, mesh.positions, 6 * sizeof(double));
    bat_mesh_free(&mesh);
    bat_mesh_free(&repaired);
}

static void test_pages_of_a_book(void **state)
{
    (void)state;
    const uint32_t faces[] = {0, 1, 2, 1, 0, 3, 0, 1, 4};
    bat_mesh mesh = mesh_of(faces, 3, 5);
    bat_mesh_repair_report report;
    size_t boundary;
    bat_mesh repaired = must_repair(&mesh, &report, &boundary);
    check_report(&report, (bat_mesh_repair_report){.nonmanifold_edges = 1, .split_vertices = 2, .added_vertices = 4});
    assert_int_equal(boundary, 9);
    bat_mesh_free(&mesh);
    bat_mesh_free(&repaired);
}

static void test_hourglass(void **state)
{
    (void)state;
    const uint32_t faces[] = {1, 2, 0, 0, 3, 4, 2, 5, 0};
    bat_mesh mesh = mesh_of(faces, 3, 6);
    bat_mesh_repair_report report;
    bat_mesh repaired = must_repair(&mesh, &report, NULL);
    check_report(&report, (bat_mesh_repair_report){.split_vertices = 1, .added_vertices = 1});
    const uint32_t split[] = {1, 2, 0, 6, 3, 4, 2, 5, 0};
    assert_memory_equal(repaired.faces, split, sizeof split);
    bat_mesh_free(&mesh);
    bat_mesh_free(&repaired);
}

/// A Möbius strip of 2 n triangles is cut across once and becomes an open strip.
static void test_moebius_strip(void **state)
{
    (void)state;
    enum
    {
        LENGTH = 9
    };
    uint32_t faces[6 * LENGTH];
    for (uint32_t i = 0; i < LENGTH; i++)
    {
        uint32_t a = 2 * i, b = 2 * i + 1, c = i + 1 < LENGTH ? a + 2 : 1, d = i + 1 < LENGTH ? b + 2 : 0;
        const uint32_t quad[] = {a, c, b, b, c, d};
        memcpy(faces + 6 * (size_t)i, quad, sizeof quad);
    }
    bat_mesh mesh = mesh_of(faces, 2 * LENGTH, 2 * LENGTH);
    bat_mesh_connectivity connectivity;
    assert_int_equal(bat_mesh_connect(&mesh, &connectivity, NULL), BAT_NOT_MANIFOLD);
    bat_mesh_repair_report report;
    size_t boundary;
    bat_mesh repaired = must_repair(&mesh, &report, &boundary);
    assert_int_equal(report.unorientable_edges, 1);
    assert_int_equal(report.added_vertices, 2);
    assert_int_equal(boundary, 2 * LENGTH + 2);
    bat_mesh_free(&mesh);
    bat_mesh_free(&repaired);
}

/// The positions of a face, from its smallest corner, towards its smaller neighbour.
static void face_key(const bat_mesh *mesh, size_t face, double key[9])
{
    const double *p[3];
    for (size_t c = 0; c < 3; c++)
        p[c] = mesh->positions + 3 * (size_t)mesh->faces[3 * face + c];
    size_t least = p[1][0] < p[0][0] ? 1 : 0;
    least = p[2][0] < p[least][0] ? 2 : least;
    size_t next = (least + 1) % 3, last = (least + 2) % 3;
    bool turned = p[last][0] < p[next][0];
    memcpy(key, p[least], 3 * sizeof *key);
    memcpy(key + 3, p[turned ? last : next], 3 * sizeof *key);
    memcpy(key + 6, p[turned ? next : last], 3 * sizeof *key);
}

/// Random triangles between few vertices, which violate every condition many times.
static void test_random_soups(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 400; seed++)
    {
        bat_random random = bat_random_seed(seed);
        size_t vertices = 4 + bat_random_bits(&random) % 30, count = 1 + bat_random_bits(&random) % 120;
        uint32_t *faces = malloc(3 * count * sizeof *faces);
        for (size_t i = 0; i < 3 * count; i++)
            faces[i] = (uint32_t)(bat_random_bits(&random) % vertices);
        const uint32_t sound[] = {0, 1, 2};
        memcpy(faces, sound, sizeof sound);
        bat_mesh mesh = mesh_of(faces, count, vertices);
        bat_mesh_repair_report report;
        bat_mesh repaired = must_repair(&mesh, &report, NULL);
        assert_int_equal(repaired.face_count + report.degenerate_faces + report.duplicate_faces, count);
        assert_int_equal(repaired.vertex_count, vertices - report.unused_vertices + report.added_vertices);
        // The remaining faces are those of the input, in their order.
        size_t at = 0;
        for (size_t f = 0; f < repaired.face_count; f++, at++)
        {
            double wanted[9], found[9];
            face_key(&repaired, f, wanted);
            for (face_key(&mesh, at, found); memcmp(wanted, found, sizeof found) != 0; face_key(&mesh, at, found))
            {
                at++;
                assert_true(at < count);
            }
        }
        free(faces);
        bat_mesh_free(&mesh);
        bat_mesh_free(&repaired);
    }
}

static const char *const NAMES[] = {"heat", "dust"};

/// Channels, texture, creases and corners on two solids that touch along the edge 0-1, with one face turned over.
static bat_mesh dressed_mesh(void)
{
    const uint32_t faces[] = {0, 1, 2, 0, 3, 2, 0, 3, 1, 3, 2, 1, 0, 1, 4, 0, 4, 5, 0, 5, 1, 5, 4, 1, 6, 6, 1};
    bat_mesh mesh = mesh_of(faces, 9, 7);
    mesh.channel_count = 2;
    mesh.channel_names = malloc(2 * sizeof *mesh.channel_names);
    mesh.channels = malloc(14 * sizeof *mesh.channels);
    for (size_t i = 0; i < 2; i++)
        mesh.channel_names[i] = strdup(NAMES[i]);
    for (size_t i = 0; i < 14; i++)
        mesh.channels[i] = (double)i;
    mesh.texture_count = 27;
    mesh.texture = malloc(54 * sizeof *mesh.texture);
    mesh.texture_faces = malloc(27 * sizeof *mesh.texture_faces);
    for (uint32_t i = 0; i < 27; i++)
    {
        mesh.texture_faces[i] = i;
        mesh.texture[2 * (size_t)i] = mesh.faces[i]; // identifies the vertex at the corner
        mesh.texture[2 * (size_t)i + 1] = i;
    }
    const bat_mesh_crease creases[] = {{1, 0, 2}, {2, 3, 1}, {3, 2, 4}, {2, 4, 9}, {6, 1, 5}};
    const bat_mesh_corner corners[] = {{0, 1}, {6, 2}, {3, 4}, {0, 3}};
    mesh.crease_count = 5;
    mesh.corner_count = 4;
    mesh.creases = malloc(sizeof creases);
    mesh.corners = malloc(sizeof corners);
    memcpy(mesh.creases, creases, sizeof creases);
    memcpy(mesh.corners, corners, sizeof corners);
    return mesh;
}

static void test_what_is_carried_along(void **state)
{
    (void)state;
    bat_mesh mesh = dressed_mesh();
    bat_mesh_repair_report report;
    bat_mesh repaired = must_repair(&mesh, &report, NULL);
    check_report(&report, (bat_mesh_repair_report){.degenerate_faces = 1,
                                                   .flipped_faces = 1,
                                                   .nonmanifold_edges = 1,
                                                   .split_vertices = 2,
                                                   .added_vertices = 2,
                                                   .unused_vertices = 1});
    const double channels[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2, 3};
    assert_memory_equal(repaired.channels, channels, sizeof channels);
    assert_string_equal(repaired.channel_names[1], NAMES[1]);
    assert_int_equal(repaired.texture_count, 27);
    for (size_t i = 0; i < 3 * repaired.face_count; i++)
    {
        const double *texture = repaired.texture + 2 * (size_t)repaired.texture_faces[i];
        assert_int_equal((size_t)texture[1] / 3, i / 3);
        assert_memory_equal(repaired.positions + 3 * (size_t)repaired.faces[i], mesh.positions + 3 * (size_t)texture[0],
                            3 * sizeof(double));
    }
    // The crease 0-1 is on both solids, the sharper one of 2-3 remains, 2-4 is not an edge, 6 has no face.
    const bat_mesh_crease creases[] = {{0, 1, 2}, {2, 3, 4}, {6, 7, 2}};
    const bat_mesh_corner corners[] = {{0, 3}, {3, 4}, {6, 3}};
    assert_int_equal(repaired.crease_count, 3);
    assert_int_equal(repaired.corner_count, 3);
    for (size_t i = 0; i < 3; i++)
    {
        assert_true(repaired.creases[i].a == creases[i].a && repaired.creases[i].b == creases[i].b &&
                    repaired.creases[i].sharpness == creases[i].sharpness);
        assert_true(repaired.corners[i].vertex == corners[i].vertex &&
                    repaired.corners[i].sharpness == corners[i].sharpness);
    }
    bat_mesh_free(&mesh);
    bat_mesh_free(&repaired);
}

static void test_what_cannot_be_repaired(void **state)
{
    (void)state;
    const uint32_t flat[] = {0, 0, 1, 2, 1, 2}, beyond[] = {0, 1, 2, 0, 1, 3};
    bat_mesh mesh = mesh_of(flat, 2, 3), repaired = {.face_count = 17};
    bat_mesh_repair_report report = {.flipped_faces = 17};
    bat_error error = {0};
    assert_int_equal(bat_mesh_repair(&mesh, &report, &repaired, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "every face has the same vertex twice"));
    mesh.face_count = 0;
    assert_int_equal(bat_mesh_repair(&mesh, &report, &repaired, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_mesh_weld(&mesh, 0, NULL, &repaired, &error), BAT_INVALID_ARGUMENT);
    bat_mesh_free(&mesh);
    mesh = mesh_of(beyond, 2, 3);
    assert_int_equal(bat_mesh_repair(&mesh, &report, &repaired, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    assert_int_equal(bat_mesh_weld(&mesh, 0, NULL, &repaired, &error), BAT_INVALID_POINT);
    mesh.face_count = 1;
    mesh.positions[5] = INFINITY;
    assert_int_equal(bat_mesh_repair(&mesh, &report, &repaired, NULL), BAT_INVALID_POINT);
    mesh.positions[5] = 0;
    const double distances[] = {-1, NAN, INFINITY};
    for (size_t i = 0; i < 3; i++)
        assert_int_equal(bat_mesh_weld(&mesh, distances[i], NULL, &repaired, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(repaired.face_count, 17);
    assert_int_equal(report.flipped_faces, 17);
    bat_mesh_free(&mesh);
}

/// Every vertex is merged with the one that a search among all earlier vertices gives.
static void check_weld(const bat_mesh *mesh, double distance)
{
    uint32_t *target = malloc(mesh->vertex_count * sizeof *target), *kept = malloc(mesh->vertex_count * sizeof *kept);
    size_t count = 0, merged;
    for (size_t v = 0; v < mesh->vertex_count; v++)
    {
        size_t i = 0;
        for (; i < count; i++)
        {
            const double *a = mesh->positions + 3 * v, *b = mesh->positions + 3 * (size_t)kept[i];
            if (hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]) <= distance)
                break;
        }
        target[v] = (uint32_t)i;
        if (i == count)
            kept[count++] = (uint32_t)v;
    }
    bat_mesh welded;
    assert_int_equal(bat_mesh_weld(mesh, distance, &merged, &welded, NULL), BAT_OK);
    assert_int_equal(welded.vertex_count, count);
    assert_int_equal(merged, mesh->vertex_count - count);
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        assert_int_equal(welded.faces[i], target[mesh->faces[i]]);
    for (size_t i = 0; i < count; i++)
        assert_memory_equal(welded.positions + 3 * i, mesh->positions + 3 * (size_t)kept[i], 3 * sizeof(double));
    bat_mesh_free(&welded);
    free(target);
    free(kept);
}

static void test_welding_as_by_hand(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(3);
    const uint32_t faces[] = {0, 1, 2, 5, 700, 3};
    for (int round = 0; round < 6; round++)
    {
        bat_mesh mesh = mesh_of(faces, 2, 900);
        for (size_t i = 0; i < 2700; i++)
            mesh.positions[i] = round < 3 ? bat_random_normal(&random) : floor(4 * bat_random_normal(&random)) / 4;
        mesh.positions[0] = -0.0;
        check_weld(&mesh, 0);
        check_weld(&mesh, 1e-300);
        check_weld(&mesh, .05);
        check_weld(&mesh, .25);
        check_weld(&mesh, 2);
        check_weld(&mesh, 1e300);
        bat_mesh_free(&mesh);
    }
}

/// Separated triangles are joined again, with all their data.
static void test_a_soup_becomes_a_solid(void **state)
{
    (void)state;
    const uint32_t faces[] = {0, 1, 2, 0, 2, 3, 0, 3, 1, 3, 2, 1};
    uint32_t torn[12];
    bat_mesh solid = mesh_of(faces, 4, 4), welded;
    for (uint32_t i = 0; i < 12; i++)
        torn[i] = i;
    bat_mesh soup = mesh_of(torn, 4, 12);
    soup.channels = malloc(12 * sizeof *soup.channels);
    soup.channel_names = malloc(sizeof *soup.channel_names);
    soup.channel_names[0] = strdup("from");
    soup.channel_count = 1;
    soup.creases = malloc(2 * sizeof *soup.creases);
    soup.corners = malloc(sizeof *soup.corners);
    soup.creases[0] = (bat_mesh_crease){9, 10, 3};
    soup.creases[1] = (bat_mesh_crease){0, 3, 3}; // becomes a point
    soup.corners[0] = (bat_mesh_corner){11, 2};
    soup.crease_count = 2;
    soup.corner_count = 1;
    for (size_t i = 0; i < 12; i++)
    {
        memcpy(soup.positions + 3 * i, solid.positions + 3 * (size_t)faces[i], 3 * sizeof(double));
        soup.channels[i] = (double)i;
    }
    size_t merged;
    assert_int_equal(bat_mesh_weld(&soup, 0, &merged, &welded, NULL), BAT_OK);
    assert_int_equal(merged, 8);
    assert_memory_equal(welded.faces, faces, sizeof faces);
    assert_memory_equal(welded.positions, solid.positions, 12 * sizeof(double));
    const double channels[] = {0, 1, 2, 5};
    assert_memory_equal(welded.channels, channels, sizeof channels);
    assert_int_equal(welded.crease_count, 1);
    assert_int_equal(welded.creases[0].a, 3);
    assert_int_equal(welded.creases[0].b, 2);
    assert_int_equal(welded.corners[0].vertex, 1);
    bat_mesh_repair_report report;
    size_t boundary;
    bat_mesh repaired = must_repair(&welded, &report, &boundary);
    assert_int_equal(boundary, 0);
    bat_mesh_free(&repaired);
    bat_mesh_free(&welded);
    bat_mesh_free(&solid);
    bat_mesh_free(&soup);
}

/// The flat grid of n x n squares without the squares from `low` to below `high` in both directions.
static bat_mesh make_frame(size_t n, size_t low, size_t high)
{
    size_t side = n + 1, count = 0;
    bat_mesh mesh = {.positions = calloc(side * side, 3 * sizeof(double)),
                     .faces = malloc(n * n * 6 * sizeof(uint32_t)),
                     .vertex_count = side * side};
    for (size_t v = 0; v < side * side; v++)
    {
        mesh.positions[3 * v] = (double)(v % side);
        mesh.positions[3 * v + 1] = (double)(v / side);
    }
    for (size_t i = 0; i < n * n; i++)
    {
        size_t x = i % n, y = i / n;
        if (x >= low && x < high && y >= low && y < high)
            continue;
        uint32_t a = (uint32_t)(y * side + x), b = a + 1, c = a + (uint32_t)side, d = c + 1;
        const uint32_t made[6] = {a, b, d, a, d, c};
        memcpy(mesh.faces + 6 * count++, made, sizeof made);
    }
    mesh.face_count = 2 * count;
    return mesh;
}

/// A flat hole is covered once: the area is that of the square, and all faces look up. Longer loops stay open.
static void test_holes(void **state)
{
    (void)state;
    bat_mesh frame = make_frame(8, 2, 6), closed;
    bat_mesh_connectivity links;
    size_t filled = 7;
    assert_int_equal(bat_mesh_fill_holes(&frame, 15, &filled, &closed, NULL), BAT_OK);
    assert_int_equal(filled, 0);
    assert_int_equal(closed.face_count, frame.face_count);
    bat_mesh_free(&closed);
    assert_int_equal(bat_mesh_fill_holes(&frame, 16, &filled, &closed, NULL), BAT_OK);
    assert_int_equal(filled, 1);
    assert_int_equal(closed.face_count, frame.face_count + 14);
    assert_int_equal(bat_mesh_connect(&closed, &links, NULL), BAT_OK);
    assert_int_equal(links.boundary_edge_count, 32);
    bat_mesh_connectivity_free(&links);
    double area = 0;
    for (size_t f = 0; f < closed.face_count; f++)
    {
        const double *a = closed.positions + 3 * closed.faces[3 * f], *b = closed.positions + 3 * closed.faces[3 * f + 1],
                     *c = closed.positions + 3 * closed.faces[3 * f + 2];
        double twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        assert_true(twice >= 0);
        area += twice / 2;
    }
    assert_true(fabs(area - 64) < 1e-12);
    bat_mesh_free(&closed);
    assert_int_equal(bat_mesh_fill_holes(&frame, BAT_MESH_MAX_HOLE + 1, NULL, &closed, NULL), BAT_INVALID_ARGUMENT);
    bat_mesh_free(&frame);
}

/// Holes that touch at a vertex, in a chain and around one vertex, are filled each for itself; the vertices that the
/// repair split become one again.
static void test_touching_holes(void **state)
{
    (void)state;
    enum
    {
        SIDE = 6,
        GONE = 9
    };
    static const size_t gone[] = {2 * (SIDE + 1),         2 * (SIDE + 1) + 1, 2 * (2 * SIDE + 2),
                                  2 * (2 * SIDE + 2) + 1, 2 * (3 * SIDE + 1), 2 * (3 * SIDE + 1) + 1,
                                  2 * (4 * SIDE + 4),     2 * (4 * SIDE + 3), 2 * (3 * SIDE + 3)};
    bat_mesh whole = make_frame(SIDE, SIDE, SIDE), closed;
    bat_mesh_repair_report report;
    bat_mesh_connectivity links;
    size_t boundary, filled, kept = 0;
    for (size_t f = 0; f < whole.face_count; f++)
    {
        bool stays = true;
        for (size_t i = 0; i < GONE; i++)
            stays = stays && gone[i] != f;
        if (stays)
            memmove(whole.faces + 3 * kept++, whole.faces + 3 * f, 3 * sizeof *whole.faces);
    }
    whole.face_count = kept;
    bat_mesh split = must_repair(&whole, &report, &boundary);
    assert_int_equal(report.split_vertices, 4);
    assert_int_equal(report.added_vertices, 5);
    assert_int_equal(bat_mesh_fill_holes(&split, 3, &filled, &closed, NULL), BAT_OK);
    assert_int_equal(filled, 3);
    bat_mesh_free(&closed);
    assert_int_equal(bat_mesh_fill_holes(&split, 4, &filled, &closed, NULL), BAT_OK);
    assert_int_equal(filled, 6);
    assert_int_equal(closed.face_count, 2 * SIDE * SIDE);
    assert_int_equal(closed.vertex_count, (SIDE + 1) * (SIDE + 1));
    assert_int_equal(bat_mesh_connect(&closed, &links, NULL), BAT_OK);
    assert_int_equal(links.boundary_edge_count, 4 * SIDE);
    bat_mesh_connectivity_free(&links);
    bat_mesh_free(&closed);
    bat_mesh_free(&split);
    bat_mesh_free(&whole);
}

/// A tetrahedron without two faces: the one way to close its hole repeats no edge. Of the other diagonal there is one.
static void test_hole_with_an_edge_across(void **state)
{
    (void)state;
    const uint32_t faces[] = {0, 1, 2, 0, 2, 3};
    bat_mesh mesh = mesh_of(faces, 2, 4), closed;
    bat_mesh_connectivity links;
    size_t filled;
    assert_int_equal(bat_mesh_fill_holes(&mesh, 4, &filled, &closed, NULL), BAT_OK);
    assert_int_equal(filled, 1);
    assert_int_equal(bat_mesh_connect(&closed, &links, NULL), BAT_OK);
    assert_int_equal(links.boundary_edge_count, 0);
    assert_int_equal(links.edge_count, 6);
    bat_mesh_connectivity_free(&links);
    bat_mesh_free(&mesh);
    bat_mesh_free(&closed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_good_meshes_stay),
                                       cmocka_unit_test(test_faces_that_are_dropped),
                                       cmocka_unit_test(test_faces_are_turned),
                                       cmocka_unit_test(test_solids_at_one_edge),
                                       cmocka_unit_test(test_pages_of_a_book),
                                       cmocka_unit_test(test_hourglass),
                                       cmocka_unit_test(test_moebius_strip),
                                       cmocka_unit_test(test_random_soups),
                                       cmocka_unit_test(test_what_is_carried_along),
                                       cmocka_unit_test(test_what_cannot_be_repaired),
                                       cmocka_unit_test(test_welding_as_by_hand),
                                       cmocka_unit_test(test_a_soup_becomes_a_solid),
                                       cmocka_unit_test(test_holes),
                                       cmocka_unit_test(test_touching_holes),
                                       cmocka_unit_test(test_hole_with_an_edge_across)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
