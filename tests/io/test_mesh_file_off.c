// OFF: header words, comments, colours and texture coordinates, and errors with their lines.
#include "mesh_file_helpers.h"

static const bat_mesh_format OFF = BAT_MESH_FORMAT_OFF;
static const char *const COLOURS[] = {"red", "green", "blue", "alpha"};

#define TRIANGLE "0 0 0\n1 0 0\n0 1 0\n"

static void test_headers_and_comments(void **state)
{
    (void)state;
    static const char *const texts[] = {"OFF\n3 1 0\n" TRIANGLE "3 0 1 2\n", "OFF 3 1 3\n" TRIANGLE "3 0 1 2",
                                        "OFF 3 1\n" TRIANGLE "3 0 1 2 0.5 0.5 0.5 1\n",
                                        "# before\r\n\r\nOFF # here\r\n# and here\r\n3 1 0 # there\r\n\r\n0 0 0\r\n# "
                                        "between\r\n1 0 0\r\n0 1 0 # end\r\n3 0 1 "
                                        "2 # face\r\n# after\r\n",
                                        "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2 7\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    {
        bat_mesh mesh = must_read(texts[i], i % 2 == 0 ? OFF : BAT_MESH_FORMAT_AUTO);
        assert_text(&mesh, OFF, "OFF\n3 1 0\n" TRIANGLE "3 0 1 2\n");
        bat_mesh_free(&mesh);
    }
}

static void test_colours(void **state)
{
    (void)state;
    bat_mesh mesh = must_read("COFF\n3 1 0\n0 0 0 255 51 0 255\n1 0 0 0 0 0 255\n0 1 0 1 1 1 255\n3 0 1 2\n", OFF);
    assert_int_equal(mesh.channel_count, 4);
    assert_true(mesh.channels[0] == 1 && mesh.channels[1] == .2 && mesh.channels[8] == 1 / 255.0);
    bat_mesh_free(&mesh);
    mesh =
        must_read("STCNOFF\n3 1 0\n0 0 0 0 0 1 .5 0 1 .1 .2\n1 0 0 0 0 1 0 0 0 1 0\n0 1 0 0 0 1 1 1 1 0 1\n3 0 1 2\n", OFF);
    assert_int_equal(mesh.channel_count, 3);
    assert_int_equal(mesh.texture_count, 3);
    assert_text(&mesh, OFF, "STCOFF\n3 1 0\n0 0 0 0.5 0 1 0.1 0.2\n1 0 0 0 0 0 1 0\n0 1 0 1 1 1 0 1\n3 0 1 2\n");
    mesh.channels[4] = 1.5;
    assert_unwritable(&mesh, OFF, BAT_MESH_ENCODING_TEXT, BAT_UNSUPPORTED, "the colour 1.5 of vertex 1");
    bat_mesh_free(&mesh);
}

static void test_polygons(void **state)
{
    (void)state;
    static const char text[] = "OFF\n4 2 0\n" TRIANGLE "1 1 0\n3 0 1 2\n\n# quad\n4 0 1 3 2\n";
    assert_bad(text, OFF, 10, "face 1 has 4 corners; triangulate cuts it");
    bat_mesh mesh = must_cut(text, OFF);
    assert_int_equal(mesh.face_count, 3);
    bat_mesh_free(&mesh);
    assert_bad("OFF\n3 1 0\n" TRIANGLE "\n3 0 1 1\n", OFF, 7, "face 0 has vertex 1, counted from 0, twice");
}

static void test_faces_of_several_lines(void **state)
{
    (void)state;
    bat_mesh mesh = must_read("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0\n1 # one\n2\n3 2 1 0 255 0 0\n", OFF);
    const uint32_t corners[] = {0, 1, 2, 2, 1, 0};
    assert_int_equal(mesh.face_count, 2);
    assert_memory_equal(mesh.faces, corners, sizeof corners);
    bat_mesh_free(&mesh);
}

static void test_bad_files(void **state)
{
    (void)state;
    assert_bad("", OFF, 1, "does not begin with OFF");
    assert_bad("3 1 0\n", OFF, 1, "does not begin with OFF");
    assert_bad("OFFS\n", OFF, 1, "does not begin with OFF");
    assert_bad("4OFF\n", OFF, 1, "does not begin with OFF");
    assert_bad("OFF\n\n", OFF, 3, "counts of vertices and faces are missing");
    assert_bad("OFF\nthree\n", OFF, 2, "'three' is not the number of vertices");
    assert_bad("OFF\n-3 1 0\n", OFF, 2, "'-3' is not the number of vertices");
    assert_bad("OFF\n3\n", OFF, 2, "'' is not the number of faces");
    assert_bad("OFF\n3 1.5\n", OFF, 2, "'1.5' is not the number of faces");
    assert_bad("OFF\n3 1 x\n", OFF, 2, "'x' is not the number of edges");
    assert_bad("OFF\n3 1 0 0\n", OFF, 2, "'0' follows the counts");
    assert_bad("OFF\n4294967290 1 0\n" TRIANGLE, OFF, 2, "too short for 4294967290 vertices");
    assert_bad("OFF\n3 4294967290 0\n" TRIANGLE, OFF, 2, "too short for 3 vertices and 4294967290 faces");
    assert_bad("OFF\n99999999999999999999 1 0\n", OFF, 2, "is not the number of vertices");
    assert_bad("OFF\n3 0 0\n" TRIANGLE, OFF, 0, "there are no faces");
    assert_bad("OFF\n3 1 0\n0 0\n1 0 0\n0 1 0\n3 0 1 2\n", OFF, 3, "vertex 0 has 2 numbers instead of 3");
    assert_bad("OFF\n3 1 0\n0 0 0 1\n1 0 0\n0 1 0\n3 0 1 2\n", OFF, 3, "vertex 0 has 4 numbers instead of 3");
    assert_bad("OFF\n3 1 0\n0 0 0 1 1 1 1 1 1 1 1 1 1\n1 0 0\n0 1 0\n3 0 1 2\n", OFF, 3, "more than 12");
    assert_bad("COFF\n3 1 0\n0 0 0 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1\n3 0 1 2\n", OFF, 4, "vertex 1 has 7 numbers");
    assert_bad("OFF\n3 1 0\n0 0 x\n1 0 0\n0 1 0\n3 0 1 2\n", OFF, 3, "'x' is not a number");
    assert_bad("OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n", OFF, 3, "'nan' is not a number");
    assert_bad("OFF\n3 1 0\n0 0 1e999\n1 0 0\n0 1 0\n3 0 1 2\n", OFF, 3, "'1e999' is too large");
    assert_bad("OFF\n3 1 0\n" TRIANGLE "x\n", OFF, 6, "'x' is not the number of a face's corners");
    assert_bad("OFF\n3 1 0\n" TRIANGLE "2 0 1\n", OFF, 6, "face 0 has 2 corners, fewer than 3");
    assert_bad("OFF\n3 1 0\n" TRIANGLE "4294967290 0 1\n", OFF, 6, "face 0 has 2 of its 4294967290 corners");
    assert_bad("OFF\n3 1 0\n" TRIANGLE "3 0 1 3\n", OFF, 6, "'3' is not the number, from 0, of a vertex");
    assert_bad("OFF\n3 1 0\n" TRIANGLE "3 0 1 -1\n", OFF, 6, "'-1' is not the number");
    assert_bad("OFF\n3 1 0\n" TRIANGLE "3 0 1 2 red\n", OFF, 6, "'red' is not a number");
    assert_bad("OFF\n3 1 0\n" TRIANGLE "3 0 1 2 1 1 1 1 1\n", OFF, 6, "'1' follows the face's corners and colour");
    assert_bad("OFF\n3 1 0\n" TRIANGLE "3 0 1 2\n3 0 1 2\n", OFF, 7, "'3' follows the last face");
    bat_mesh_read_options options = reading_as(OFF);
    assert_refused("OFF BINARY\n", 11, &options, BAT_UNSUPPORTED, 1, "binary OFF");
    static const char whole[] = "COFF\n3 1 0\n0 0 0 1 0 0\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n";
    assert_truncations_fail(whole, sizeof whole - 1, 2, OFF);
}

static void test_round_trip(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 16; seed++)
    {
        const mesh_extras extras = {.texture = seed % 4 == 0 ? SIZE_MAX : 0,
                                    .channels = COLOURS,
                                    .channel_count = seed % 5 == 0   ? 3
                                                     : seed % 5 == 1 ? 4
                                                                     : 0};
        bat_mesh mesh = random_mesh(seed, seed == 16 ? 30000 : 10 + seed, seed == 16 ? 60000 : 40, &extras);
        bat_mesh back = through_file(&mesh, OFF, BAT_MESH_ENCODING_TEXT);
        assert_same_shape(&mesh, &back);
        assert_same_channels(&mesh, &back);
        assert_same_texture(&mesh, &back);
        bat_mesh_free(&mesh);
        bat_mesh_free(&back);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_headers_and_comments),   cmocka_unit_test(test_colours),   cmocka_unit_test(test_polygons),
        cmocka_unit_test(test_faces_of_several_lines), cmocka_unit_test(test_bad_files), cmocka_unit_test(test_round_trip)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
