// OBJ: reading, writing, and errors with their lines.
#include "folder_helpers.h"
#include "mesh_file_helpers.h"

#include <sys/stat.h>

static const bat_mesh_format OBJ = BAT_MESH_FORMAT_OBJ;

#define TRIANGLE "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
static const char *const COLOURS[] = {"red", "green", "blue", "alpha"};

static void test_every_form_of_a_face(void **state)
{
    (void)state;
    static const char *const forms[] = {"f 1 2 3\n", "f 1/1 2/2 3/3\n", "f 1//1 2//2 3//3\n", "f 1/1/1 2/2/2 3/3/3\n",
                                        "f -3/-3/-3 -2/-2/1 -1/-1/2 # all of them\r\n"};
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
    {
        char text[256];
        (void)snprintf(
            text, sizeof text,
            "# a\nmtllib a.mtl\no one\ng g\n%svt .5 .25\nvt 1 0 9\nvt 1\nvn 0 0 1\nvn x\nvp 1\ns 1\nusemtl m\nl 1 "
            "2\np 1\n%s",
            TRIANGLE, forms[i]);
        bat_mesh mesh = must_read(text, i % 2 == 0 ? OBJ : BAT_MESH_FORMAT_AUTO);
        const uint32_t corners[] = {0, 1, 2};
        const double texture[] = {.5, .25, 1, 0, 1, 0};
        assert_int_equal(mesh.vertex_count, 3);
        assert_int_equal(mesh.face_count, 1);
        assert_memory_equal(mesh.faces, corners, sizeof corners);
        bool textured = strstr(forms[i], "1/1") != NULL || strstr(forms[i], "-3/-3") != NULL;
        assert_int_equal(mesh.texture_count, textured ? 3 : 0);
        assert_int_equal(mesh.texture == NULL, !textured);
        if (textured)
        {
            assert_memory_equal(mesh.texture, texture, sizeof texture);
            assert_memory_equal(mesh.texture_faces, corners, sizeof corners);
        }
        bat_mesh_free(&mesh);
    }
}

static void test_faces_may_come_before_their_vertices(void **state)
{
    (void)state;
    bat_mesh mesh = must_read("\xEF\xBB\xBF"
                              "f 3 1 2\n" TRIANGLE,
                              OBJ);
    assert_int_equal(mesh.faces[0], 2);
    bat_mesh_free(&mesh);
    assert_bad("# one\nf 1 2 3\nf 3 1 2\nf 1 2 4\n" TRIANGLE, OBJ, 4, "face 2 names vertex 3");
    assert_bad("f 1/1 2/2 3/3\nvt 0 0\nvt 1 0\n" TRIANGLE, OBJ, 1, "texture coordinate 2");
}

static void test_weights_and_colours(void **state)
{
    (void)state;
    bat_mesh mesh = must_read("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0\nf 1 2 3", OBJ);
    assert_int_equal(mesh.channel_count, 0);
    assert_true(mesh.positions[3] == 1);
    bat_mesh_free(&mesh);
    mesh = must_read("v 0 0 0 .1 .2 .3\nv 1 0 0 0 0 0\nv 0 1 0 1 1 1\nf 1 2 3", OBJ);
    assert_int_equal(mesh.channel_count, 3);
    assert_string_equal(mesh.channel_names[2], "blue");
    assert_true(mesh.channels[1] == .2 && mesh.channels[8] == 1);
    assert_text(&mesh, OBJ, "v 0 0 0 0.1 0.2 0.3\nv 1 0 0 0 0 0\nv 0 1 0 1 1 1\nf 1 2 3\n");
    bat_mesh_free(&mesh);
    assert_bad("v 0 0 0 .1 .2 .3\nv 1 0 0\n", OBJ, 2, "another number of colour values");
    assert_bad("v 0 0 0\nv 1 0 0 1 1 1\n", OBJ, 2, "another number of colour values");
    assert_bad("v 0 0 0 1 1 1\nv 1 0 0 1 1 1 1\n", OBJ, 2, "another number of colour values");
}

static void test_creases_and_corners(void **state)
{
    (void)state;
    bat_mesh mesh = must_read(
        TRIANGLE
        "f 1 2 3\nt crease 2/1/0 0 1 2.5\nt crease 4/1/0 1 2 2 0 10\nt crease 4/2/0 1 2 2 0 "
        "3 4\nt corner 1/1/0 2 7\nt corner 2/2/0 0 1 .5 0\nt interpolateboundary 1/0/0 1\nt creasemethod 0/0/1 chaikin\n"
        "t facevaryinginterpolateboundary 1/0/0 2\n",
        OBJ);
    assert_int_equal(mesh.rules.boundary, BAT_MESH_BOUNDARY_CORNERS);
    assert_int_equal(mesh.rules.creasing, BAT_MESH_CREASING_CHAIKIN);
    assert_int_equal(mesh.rules.linear, BAT_MESH_LINEAR_CORNERS_PLUS1);
    const bat_mesh_crease creases[] = {{0, 1, 2.5}, {1, 2, 10}, {2, 0, 10}, {1, 2, 3}, {2, 0, 4}};
    const bat_mesh_corner corners[] = {{2, 7}, {0, .5}, {1, 0}};
    assert_int_equal(mesh.crease_count, 5);
    assert_int_equal(mesh.corner_count, 3);
    for (size_t i = 0; i < 5; i++)
        assert_true(mesh.creases[i].a == creases[i].a && mesh.creases[i].b == creases[i].b &&
                    mesh.creases[i].sharpness == creases[i].sharpness);
    for (size_t i = 0; i < 3; i++)
        assert_true(mesh.corners[i].vertex == corners[i].vertex && mesh.corners[i].sharpness == corners[i].sharpness);
    mesh.creases[0].sharpness = INFINITY;
    mesh.crease_count = mesh.corner_count = 1;
    assert_text(&mesh, OBJ,
                TRIANGLE "f 1 2 3\nt crease 2/1/0 0 1 10\nt corner 1/1/0 2 7\n"
                         "t interpolateboundary 1/0/0 1\nt facevaryinginterpolateboundary 1/0/0 2\n"
                         "t creasemethod 0/0/1 chaikin\n");
    bat_mesh_free(&mesh);
    static const struct
    {
        const char *tag, *words;
    } bad[] = {{"crease 3/1/0 0 1 2 1", "a crease is"},
               {"crease 0/1/0 1", "a crease is"},
               {"crease 4/3/0 0 1 1 2 1 1 1", "a crease is"},
               {"crease 2/1/1 0 1 1 x", "a crease is"},
               {"crease", "a crease is"},
               {"crease 2 0 1 1", "a crease is"},
               {"crease 2/1/0 0 3 1", "'3' is not the number, from 0, of a vertex above"},
               {"crease 2/1/0 0 -1 1", "'-1' is not the number"},
               {"crease 2/1/0 0 1", "'' is not a sharpness"},
               {"crease 2/1/0 0 1 -1", "'-1' is not a sharpness"},
               {"crease 2/1/0 0 1 nan", "'nan' is not a sharpness"},
               {"crease 2/1/0 1 1 1", "joins a vertex with itself"},
               {"crease 2/1/0 0 1 1 1", "'1' exceeds the counts"},
               {"crease 4294967294/1/0 0 1 1", "'' is not the number"},
               {"corner 1/2/0 0 1 1", "a corner is"},
               {"corner 1/1/0 4 1", "'4' is not the number"},
               {"corner 1/1/0", "'' is not the number"},
               {"interpolateboundary 1/0/0 3", "'3' is not a known number of this rule"},
               {"creasemethod 0/0/1 smooth", "'creasemethod' is followed by"},
               {"hole 1/0/0 0", "'hole' is a tag of subdivision that is not supported"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    {
        char text[128];
        (void)snprintf(text, sizeof text, TRIANGLE "t %s\nf 1 2 3\n", bad[i].tag);
        assert_bad(text, OBJ, 4, bad[i].words);
    }
}

static void test_some_faces_without_texture(void **state)
{
    (void)state;
    bat_mesh mesh = must_read(TRIANGLE "vt 1 1\nf 1 2 3\nf 1/1 3/1 2/1\nf 2 3 1\n", OBJ);
    assert_int_equal(mesh.texture_count, 2);
    const uint32_t places[] = {1, 1, 1, 0, 0, 0, 1, 1, 1};
    const double texture[] = {1, 1, 0, 0};
    assert_memory_equal(mesh.texture_faces, places, sizeof places);
    assert_memory_equal(mesh.texture, texture, sizeof texture);
    bat_mesh_free(&mesh);
    assert_bad(TRIANGLE "vt 1 1\nf 1/1 2 3\n", OBJ, 5, "'2' and the corner before it: only one of them");
    assert_bad(TRIANGLE "vt 1 1\nf 1 2/1 3\n", OBJ, 5, "'2/1' and the corner before it");
}

static void test_polygons(void **state)
{
    (void)state;
    static const char quad[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
    assert_bad(quad, OBJ, 9, "face 0 has 4 corners; triangulate cuts it");
    bat_mesh mesh = must_cut(quad, OBJ);
    assert_int_equal(mesh.face_count, 2);
    assert_memory_equal(mesh.faces, mesh.texture_faces, 6 * sizeof(uint32_t));
    bat_mesh_free(&mesh);
}

static void test_vertices_twice(void **state)
{
    (void)state;
    assert_bad(TRIANGLE "f 1 2 3\n\nf 1 3 3\n", OBJ, 6, "face 1 has vertex 2, counted from 0, twice");
    bat_mesh_read_options options = reading_as(OBJ);
    options.keep_degenerate = true;
    bat_mesh mesh = {0};
    static const char text[] = TRIANGLE "f 1 2 3\nf 1 3 3\n";
    assert_int_equal(bat_mesh_read_memory(text, sizeof text - 1, &options, &mesh, NULL), BAT_OK);
    assert_int_equal(mesh.face_count, 2);
    bat_mesh_free(&mesh);
    options.triangulate = true;
    options.keep_degenerate = false;
    static const char pinched[] = TRIANGLE "f 1 2 3\nf 1 2 1 3\n";
    assert_refused(pinched, sizeof pinched - 1, &options, BAT_BAD_FILE, 5, "face 1 has vertex 0");
}

/// Lines continued by a backslash, and corners that end with slashes. Later lines keep their numbers.
static void test_continued_lines(void **state)
{
    (void)state;
    bat_mesh mesh = must_read(TRIANGLE "# no \\\nf 1// \\\r\n  2/ \\\n3//\n", OBJ);
    const uint32_t corners[] = {0, 1, 2};
    assert_int_equal(mesh.face_count, 1);
    assert_memory_equal(mesh.faces, corners, sizeof corners);
    bat_mesh_free(&mesh);
    assert_bad(TRIANGLE "f 1 \\\n2 3\nf 1 2 9\n", OBJ, 6, "face 1 names vertex 8");
}

static void test_bad_lines(void **state)
{
    (void)state;
    assert_bad("", OBJ, 0, "there are no faces");
    assert_bad(TRIANGLE, OBJ, 0, "there are no faces");
    assert_bad("hello\nworld\n", OBJ, 0, "there are no faces");
    assert_bad("v 0 0\n", OBJ, 1, "a vertex has 3 coordinates");
    assert_bad("v\n", OBJ, 1, "a vertex has 3 coordinates");
    assert_bad("v 0 0 0 0 0\n", OBJ, 1, "a vertex has 3 coordinates");
    assert_bad("v 0 0 0 0 0 0 0 0\n", OBJ, 1, "a vertex has 3 coordinates");
    assert_bad("v 0 0 0x\n", OBJ, 1, "'0x' is not a number");
    assert_bad("\n\nv 0 0 nan\n", OBJ, 3, "'nan' is not a number");
    assert_bad("v 0 inf 0\n", OBJ, 1, "'inf' is not a number");
    assert_bad("v 0 -1e999 0\n", OBJ, 1, "'-1e999' is too large");
    assert_bad("vt\n", OBJ, 1, "a texture coordinate has");
    assert_bad("vt 1 2 3 4\n", OBJ, 1, "a texture coordinate has");
    assert_bad("vt one\n", OBJ, 1, "'one' is not a number");
    assert_bad(TRIANGLE "f\n", OBJ, 4, "at least 3 corners");
    assert_bad(TRIANGLE "f 1 2 # 3\n", OBJ, 4, "at least 3 corners");
    assert_bad(TRIANGLE "f 1 2 0\n", OBJ, 4, "'0' has an index of 0");
    assert_bad(TRIANGLE "f 1 2 x\n", OBJ, 4, "'x' is not v, v/vt");
    assert_bad(TRIANGLE "f 1 2 3.0\n", OBJ, 4, "'3.0' is not v, v/vt");
    assert_bad(TRIANGLE "f 1/1/1/1 2 3\n", OBJ, 4, "'1/1/1/1' is not v, v/vt");
    assert_bad(TRIANGLE "f 1 2 --3\n", OBJ, 4, "'--3' is not v, v/vt");
    assert_bad(TRIANGLE "f 1 2 -4\n", OBJ, 4, "'-4' reaches back");
    assert_bad(TRIANGLE "f 1/-1 2/-1 3/-1\n", OBJ, 4, "'1/-1' reaches back");
    assert_bad(TRIANGLE "f 1 2 4\n", OBJ, 4, "face 0 names vertex 3, counted from 0, but there are 3");
    assert_bad(TRIANGLE "f 1 2 4294967295\n", OBJ, 4, "is not v, v/vt");
    assert_bad(TRIANGLE "f 1 2 99999999999999999999999999\n", OBJ, 4, "is not v, v/vt");
    assert_bad(TRIANGLE "f 1 2 4294967294\n", OBJ, 4, "names vertex 4294967293");
    assert_bad(TRIANGLE "f 1/1 2/1 3/1\n", OBJ, 4, "texture coordinate 0, counted from 0, but there are 0");
    bat_mesh_read_options options = reading_as(OBJ);
    assert_refused(TRIANGLE "f 1 2\0 3\n", sizeof TRIANGLE + 9, &options, BAT_BAD_FILE, 4, "is not v, v/vt");
}

static void test_round_trip(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 20; seed++)
    {
        const mesh_extras extras = {.texture = seed % 4 == 0 ? 50 : 0,
                                    .channels = COLOURS,
                                    .channel_count = seed % 5 == 0   ? 3
                                                     : seed % 5 == 1 ? 4
                                                                     : 0,
                                    .marks = seed % 2 == 0};
        bat_mesh mesh = random_mesh(seed, seed == 20 ? 40000 : 10 + seed, seed == 20 ? 70000 : 40, &extras);
        bat_mesh back = through_file(&mesh, OBJ, BAT_MESH_ENCODING_BINARY);
        assert_same_shape(&mesh, &back);
        assert_same_channels(&mesh, &back);
        assert_int_equal(mesh.texture_count, back.texture_count);
        if (mesh.texture_count > 0)
        {
            assert_memory_equal(mesh.texture, back.texture, mesh.texture_count * 2 * sizeof(double));
            assert_memory_equal(mesh.texture_faces, back.texture_faces, mesh.face_count * 3 * sizeof(uint32_t));
        }
        assert_int_equal(mesh.crease_count, back.crease_count);
        assert_int_equal(mesh.corner_count, back.corner_count);
        for (size_t i = 0; i < mesh.crease_count; i++)
            assert_true(mesh.creases[i].a == back.creases[i].a && mesh.creases[i].b == back.creases[i].b &&
                        mesh.creases[i].sharpness == back.creases[i].sharpness);
        for (size_t i = 0; i < mesh.corner_count; i++)
            assert_true(mesh.corners[i].vertex == back.corners[i].vertex &&
                        mesh.corners[i].sharpness == back.corners[i].sharpness);
        bat_mesh_free(&mesh);
        bat_mesh_free(&back);
    }
}

/// Whether writing to a path notes that a file of materials is missing.
static bool notes_missing(const bat_mesh *mesh, const char *path, const char *name)
{
    bat_mesh_notes notes = {0};
    bat_mesh_write_options options = bat_mesh_write_defaults();
    options.notes = &notes;
    check_status(bat_mesh_write(path, mesh, &options, NULL), BAT_OK);
    bool missing = notes.count > 0 && strstr(notes.texts[0], name) != NULL;
    assert_int_equal(notes.count, missing ? 1 : 0);
    bat_mesh_notes_free(&notes);
    assert_int_equal(remove(path), 0);
    return missing;
}

/// Output in a folder without the file of materials is noted; a name may contain blanks, and there may be several.
static void test_missing_materials(void **state)
{
    (void)state;
    bat_mesh mesh = must_read("mtllib a.mtl b.mtl\n" TRIANGLE "usemtl m\nf 1 2 3\n", OBJ);
    assert_int_equal(mkdir("other", 0700), 0);
    put("a.mtl", "newmtl m\n");
    assert_true(notes_missing(&mesh, "out.obj", "'b.mtl'"));
    put("b.mtl", "newmtl n\n");
    assert_false(notes_missing(&mesh, "out.obj", "mtl"));
    assert_true(notes_missing(&mesh, "other/out.obj", "'a.mtl'"));
    assert_int_equal(remove("a.mtl"), 0);
    put("a.mtl b.mtl", "newmtl m\n");
    assert_false(notes_missing(&mesh, "out.obj", "mtl"));
    bat_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_form_of_a_face),
                                       cmocka_unit_test(test_faces_may_come_before_their_vertices),
                                       cmocka_unit_test(test_weights_and_colours),
                                       cmocka_unit_test(test_creases_and_corners),
                                       cmocka_unit_test(test_some_faces_without_texture),
                                       cmocka_unit_test(test_polygons),
                                       cmocka_unit_test(test_vertices_twice),
                                       cmocka_unit_test(test_continued_lines),
                                       cmocka_unit_test(test_bad_lines),
                                       cmocka_unit_test(test_round_trip),
                                       cmocka_unit_test_setup_teardown(test_missing_materials, enter_folder, leave_folder)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
