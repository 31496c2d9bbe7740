// glTF: transforms, modes, joined vertices, sparse values, materials, round trips, and files with faults.
#include "mesh_file_helpers.h"

#include "batten/mesh.h"

// Three floats each: (0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0) in little-endian base64.
#define POINTS "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPwAAgD8AAAAA"
#define HEAD "{\"asset\":{\"version\":\"2.0\"},"
#define BUFFER(uri) "\"buffers\":[{\"byteLength\":48,\"uri\":\"" uri "\"}],"
#define VIEW(rest) "\"bufferViews\":[{\"buffer\":0" rest "}],"
#define ACCESSOR(rest) "\"accessors\":[{\"type\":\"VEC3\",\"componentType\":5126" rest "}],"
#define MESH(mode) "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":" mode "}]}]}"
#define GOOD_VIEW VIEW(",\"byteLength\":48")
#define GOOD_ACCESSOR ACCESSOR(",\"bufferView\":0,\"count\":4")
#define NODES(nodes)                                                                                                        \
    HEAD BUFFER(POINTS)                                                                                                     \
    GOOD_VIEW GOOD_ACCESSOR "\"nodes\":[" nodes "]," MESH("5")

static void test_modes(void **state)
{
    (void)state;
    bat_mesh strip = must_read(HEAD BUFFER(POINTS) GOOD_VIEW GOOD_ACCESSOR MESH("5"), BAT_MESH_FORMAT_GLTF);
    static const uint32_t as_strip[] = {0, 1, 2, 1, 3, 2}, as_fan[] = {0, 1, 2, 0, 2, 3};
    assert_int_equal(strip.face_count, 2);
    assert_memory_equal(strip.faces, as_strip, sizeof as_strip);
    bat_mesh_free(&strip);
    bat_mesh fan = must_read(HEAD BUFFER(POINTS) GOOD_VIEW GOOD_ACCESSOR MESH("6"), BAT_MESH_FORMAT_GLTF);
    assert_memory_equal(fan.faces, as_fan, sizeof as_fan);
    bat_mesh_free(&fan);
}

/// A child of a scaled and moved node; a mirrored node turns its faces over.
static void test_transforms(void **state)
{
    (void)state;
    bat_mesh mesh = must_read(NODES("{\"children\":[1],\"scale\":[2,2,2],\"translation\":[0,0,1]},"
                                    "{\"mesh\":0,\"rotation\":[0,0,1,0],\"translation\":[1,0,0]}"),
                              BAT_MESH_FORMAT_GLTF);
    static const double expected[] = {2, 0, 1, 0, 0, 1, 2, -2, 1, 0, -2, 1};
    for (size_t i = 0; i < 12; i++)
        assert_true(fabs(mesh.positions[i] - expected[i]) < 1e-15);
    bat_mesh_free(&mesh);
    mesh = must_read(NODES("{\"mesh\":0,\"scale\":[1,1,-1]}"), BAT_MESH_FORMAT_GLTF);
    static const uint32_t turned[] = {0, 1, 2};
    assert_memory_equal(mesh.positions + 3, ((double[]){1, 0, 0}), 3 * sizeof(double));
    assert_memory_not_equal(mesh.positions, ((double[]){0, 0, 0}), 3 * sizeof(double)); // corner 2 of the file comes first
    assert_memory_equal(mesh.faces, turned, sizeof turned);
    bat_mesh_free(&mesh);
}

static bat_mesh labelled_mesh(void)
{
    static const char text[] =
        "mtllib a.mtl\no house\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt .5 .5\n"
        "g wall\nusemtl brick\nf 1/1 2/2 3/3\ng roof\nusemtl tile\nf 2/4 4/2 3/3\n";
    return must_read(text, BAT_MESH_FORMAT_OBJ);
}

/// Names, materials, texture seams and colours come back; vertices are joined again.
static void test_round_trip(void **state)
{
    (void)state;
    for (bat_mesh_format format = BAT_MESH_FORMAT_GLTF; format <= BAT_MESH_FORMAT_GLB; format++)
    {
        bat_mesh mesh = labelled_mesh();
        bat_mesh back = through_file(&mesh, format, BAT_MESH_ENCODING_BINARY);
        assert_same_shape(&mesh, &back);
        assert_same_texture(&mesh, &back);
        assert_int_equal(back.label_count, 2);
        assert_string_equal(back.labels[back.face_labels[1]].object, "house");
        assert_string_equal(back.labels[back.face_labels[1]].group, "roof");
        assert_string_equal(back.labels[back.face_labels[1]].material, "tile");
        assert_string_equal(back.labels[back.face_labels[0]].material, "brick");
        assert_string_equal(back.material_files, "a.mtl");
        assert_non_null(back.material_json);
        bat_mesh_free(&back);
        bat_mesh_free(&mesh);
    }
}

/// A mesh far from the origin keeps its digits by a translation.
static void test_far_positions(void **state)
{
    (void)state;
    bat_mesh mesh = must_read("v 500000.25 5e6 0\nv 500001.25 5e6 0\nv 500000.25 5000001 0\nf 1 2 3\n", BAT_MESH_FORMAT_OBJ);
    bat_mesh back = through_file(&mesh, BAT_MESH_FORMAT_GLB, BAT_MESH_ENCODING_BINARY);
    assert_same_shape(&mesh, &back);
    bat_mesh_free(&back);
    bat_mesh_free(&mesh);
}

static void bad(const char *text, bat_status expected, const char *words)
{
    bat_mesh_read_options options = reading_as(BAT_MESH_FORMAT_GLTF);
    assert_refused(text, strlen(text), &options, expected, 0, words);
}

static void test_faults(void **state)
{
    (void)state;
    bad(HEAD BUFFER(POINTS) VIEW(",\"byteLength\":49") GOOD_ACCESSOR MESH("5"), BAT_BAD_FILE, "not within buffer 0");
    bad(HEAD BUFFER(POINTS) VIEW(",\"byteOffset\":9007199254740992,\"byteLength\":48") GOOD_ACCESSOR MESH("5"), BAT_BAD_FILE,
        "not within buffer 0");
    bad(HEAD BUFFER("data:;base64,AAAA") GOOD_VIEW GOOD_ACCESSOR MESH("5"), BAT_BAD_FILE, "3 bytes instead of 48");
    bad(HEAD BUFFER("data:;base64,A*AA") GOOD_VIEW GOOD_ACCESSOR MESH("5"), BAT_BAD_FILE, "invalid base64");
    bad(HEAD BUFFER("../x.bin") GOOD_VIEW GOOD_ACCESSOR MESH("5"), BAT_BAD_FILE, "without a folder");
    bad(HEAD BUFFER(POINTS) GOOD_VIEW ACCESSOR(",\"bufferView\":0,\"count\":5") MESH("5"), BAT_BAD_FILE, "5 elements");
    bad(HEAD BUFFER(POINTS) GOOD_VIEW ACCESSOR(",\"bufferView\":0,\"count\":-1") MESH("5"), BAT_BAD_FILE, "whole number");
    bad(HEAD BUFFER(POINTS) GOOD_VIEW ACCESSOR(",\"bufferView\":0,\"count\":9007199254740991") MESH("5"), BAT_BAD_FILE,
        "not within");
    bad(HEAD BUFFER(POINTS) VIEW(",\"byteLength\":48,\"byteStride\":8") GOOD_ACCESSOR MESH("5"), BAT_BAD_FILE, "byteStride");
    bad(HEAD BUFFER(POINTS) GOOD_VIEW ACCESSOR(",\"count\":4") MESH("5"), BAT_BAD_FILE, "no 'bufferView'");
    bad(HEAD BUFFER(POINTS) GOOD_VIEW GOOD_ACCESSOR MESH("4"), BAT_BAD_FILE, "form no triangles");
    bad(HEAD BUFFER(POINTS) GOOD_VIEW GOOD_ACCESSOR MESH("1"), BAT_UNSUPPORTED, "points or lines");
    bad(HEAD BUFFER("data:;base64,AADAfwAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPwAAgD8AAAAA")
            GOOD_VIEW GOOD_ACCESSOR MESH("5"),
        BAT_BAD_FILE, "not finite");
    bad(NODES("{\"children\":[1]},{\"children\":[0],\"mesh\":0}"), BAT_BAD_FILE, "no meshes");
    bad(NODES("{\"children\":[0],\"mesh\":0}"), BAT_BAD_FILE, "no meshes");
    bad(NODES("{\"children\":[1]},{\"children\":[1],\"mesh\":0}"), BAT_BAD_FILE, "its own descendant");
    bad(NODES("{\"children\":[7]}"), BAT_BAD_FILE, "names a node");
    bad(NODES("{\"mesh\":0,\"rotation\":[0,0,0,0]}"), BAT_BAD_FILE, "length 0");
    bad(NODES("{\"mesh\":0,\"scale\":[1,1]}"), BAT_BAD_FILE, "no list of 3 numbers");
    bad("{\"asset\":{\"version\":\"1.0\"}}", BAT_UNSUPPORTED, "version '1.0'");
    bad("{\"type\":\"Feature\"}", BAT_BAD_FILE, "no glTF");
    bad(HEAD "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}", BAT_UNSUPPORTED, "KHR_draco_mesh_compression");
}

static void test_truncated(void **state)
{
    (void)state;
    bat_mesh mesh = labelled_mesh();
    size_t size;
    char *bytes = must_write(&mesh, BAT_MESH_FORMAT_GLB, BAT_MESH_ENCODING_BINARY, &size);
    assert_truncations_fail(bytes, size, 0, BAT_MESH_FORMAT_GLB);
    free(bytes);
    bat_mesh_free(&mesh);
}

/// Notes tell what is lost, and the content decides where the ending is wrong.
static void test_notes(void **state)
{
    (void)state;
    bat_mesh mesh = labelled_mesh();
    bat_mesh_notes notes = {0};
    bat_mesh_write_options writing = writing_as(BAT_MESH_FORMAT_STL, BAT_MESH_ENCODING_BINARY);
    writing.notes = &notes;
    char *bytes;
    size_t size;
    assert_int_equal(bat_mesh_write_memory(&mesh, &writing, &bytes, &size, NULL), BAT_OK);
    assert_int_equal(notes.count, 3);
    assert_non_null(strstr(notes.texts[1], "groups and materials"));
    free(bytes);
    bat_mesh_notes_free(&notes);
    bat_mesh_free(&mesh);
}

/// Normals of a corner of a cube by angle do not depend on the diagonals.
static void test_normals(void **state)
{
    (void)state;
    bat_mesh mesh =
        must_read("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 0\nf 1 5 2\nf 1 3 5\nf 1 4 3\nf 1 2 4\n", BAT_MESH_FORMAT_OBJ);
    double normals[15];
    bat_error error;
    assert_int_equal(bat_mesh_vertex_normals(&mesh, BAT_MESH_NORMALS_ANGLE, normals, &error), BAT_OK);
    for (int k = 0; k < 3; k++)
        assert_true(fabs(normals[k] + 1 / sqrt(3)) < 1e-15);
    assert_int_equal(bat_mesh_vertex_normals(&mesh, BAT_MESH_NORMALS_NONE, normals, &error), BAT_INVALID_ARGUMENT);
    bat_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_modes),         cmocka_unit_test(test_transforms), cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_far_positions), cmocka_unit_test(test_faults),     cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_notes),         cmocka_unit_test(test_normals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
