// glTF: transforms, modes, joined vertices, sparse and quantized values, strides, buffers in files, materials, round trips,
// wrong endings, and files with faults.
#include "folder_helpers.h"
#include "mesh_file_helpers.h"

#include "batten/mesh.h"

#include <sys/stat.h>

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

/// The positions of a file's vertices, in the order of its corners.
static void assert_points(const char *text, const double *expected)
{
    bat_mesh mesh = must_read(text, BAT_MESH_FORMAT_GLTF);
    assert_int_equal(mesh.vertex_count, 4);
    assert_int_equal(mesh.face_count, 2);
    for (size_t i = 0; i < 12; i++)
        assert_true(mesh.positions[i] == expected[i]);
    bat_mesh_free(&mesh);
}

static const double UNIT_POINTS[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};

// Vertices 1 and 3 replaced by (5, 0, 0) and (6, 7, 8): two bytes, two of padding, six floats.
#define SPARSE_BYTES(indices) "data:;base64," indices "AAAAAoEAAAAAAAAAAAAAAwEAAAOBAAAAAQQ=="
#define SPARSE_FILE(uri, accessor, indices, count)                                                                          \
    HEAD "\"buffers\":[{\"byteLength\":48,\"uri\":\"" POINTS "\"},{\"byteLength\":28,\"uri\":\"" uri "\"}],"                \
         "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":1,\"byteLength\":2},"                               \
         "{\"buffer\":1,\"byteOffset\":4,\"byteLength\":24}]," ACCESSOR(                                                    \
             accessor ",\"count\":4,\"sparse\":{\"count\":" count ",\"indices\":{" indices                                  \
                      "\"componentType\":5121},\"values\":{\"bufferView\":2}}") MESH("5")
#define SPARSE_GOOD "\"bufferView\":1,"

/// Sparse values replace those of the buffer view, or zeros where there is none.
static void test_sparse(void **state)
{
    (void)state;
    static const double replaced[] = {0, 0, 0, 5, 0, 0, 0, 1, 0, 6, 7, 8};
    assert_points(SPARSE_FILE(SPARSE_BYTES("AQM"), ",\"bufferView\":0", SPARSE_GOOD, "2"), replaced);
    // Vertices 0 and 2 are both zero without a view: they are one, and one triangle is left.
    bat_mesh mesh = must_read(SPARSE_FILE(SPARSE_BYTES("AQM"), "", SPARSE_GOOD, "2"), BAT_MESH_FORMAT_GLTF);
    static const double zero_based[] = {0, 0, 0, 5, 0, 0, 6, 7, 8};
    assert_int_equal(mesh.vertex_count, 3);
    assert_int_equal(mesh.face_count, 1);
    assert_memory_equal(mesh.positions, zero_based, sizeof zero_based);
    bat_mesh_free(&mesh);
    bad(SPARSE_FILE(SPARSE_BYTES("AwE"), ",\"bufferView\":0", SPARSE_GOOD, "2"), BAT_BAD_FILE, "out of order");
    bad(SPARSE_FILE(SPARSE_BYTES("AQE"), ",\"bufferView\":0", SPARSE_GOOD, "2"), BAT_BAD_FILE, "out of order");
    bad(SPARSE_FILE(SPARSE_BYTES("AQQ"), ",\"bufferView\":0", SPARSE_GOOD, "2"), BAT_BAD_FILE, "out of range");
    bad(SPARSE_FILE(SPARSE_BYTES("AQM"), ",\"bufferView\":0", SPARSE_GOOD, "0"), BAT_BAD_FILE, "'count' of 0");
    bad(SPARSE_FILE(SPARSE_BYTES("AQM"), ",\"bufferView\":0", SPARSE_GOOD, "5"), BAT_BAD_FILE, "'count' of 5");
    bad(SPARSE_FILE(SPARSE_BYTES("AQM"), ",\"bufferView\":0", SPARSE_GOOD, "3"), BAT_BAD_FILE, "not within");
    bad(SPARSE_FILE(SPARSE_BYTES("AQM"), ",\"bufferView\":0", "", "2"), BAT_BAD_FILE, "lacks a 'bufferView'");
}

// The four points, each after four bytes of 255; the last one ends the buffer.
#define STRIDED                                                                                                             \
    "data:application/octet-stream;base64,"                                                                                 \
    "/////wAAAAAAAAAAAAAAAP////8AAIA/AAAAAAAAAAD/////AAAAAAAAgD8AAAAA/////wAAgD8AAIA/AAAAAA=="
#define STRIDED_FILE(view, accessor)                                                                                        \
    HEAD "\"buffers\":[{\"byteLength\":64,\"uri\":\"" STRIDED "\"}]," VIEW(view)                                            \
        ACCESSOR(",\"bufferView\":0,\"count\":4" accessor) MESH("5")

/// Rows begin at multiples of the stride from the offsets of the view and of the accessor; the last one may be short.
static void test_strides(void **state)
{
    (void)state;
    assert_points(STRIDED_FILE(",\"byteLength\":64,\"byteStride\":16", ",\"byteOffset\":4"), UNIT_POINTS);
    assert_points(STRIDED_FILE(",\"byteOffset\":4,\"byteLength\":60,\"byteStride\":16", ""), UNIT_POINTS);
    bad(STRIDED_FILE(",\"byteLength\":64,\"byteStride\":16", ",\"byteOffset\":5"), BAT_BAD_FILE, "not within");
    bad(STRIDED_FILE(",\"byteOffset\":4,\"byteLength\":59,\"byteStride\":16", ""), BAT_BAD_FILE, "not within");
    bad(STRIDED_FILE(",\"byteLength\":64,\"byteStride\":256", ""), BAT_BAD_FILE, "'byteStride' of 256");
}

#define QUANTIZED_FILE(extension, size, bytes, stride, type)                                                                \
    "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"" extension "\"],\"extensionsRequired\":[\"" extension          \
    "\"],\"buffers\":[{\"byteLength\":" size ",\"uri\":\"data:;base64," bytes                                               \
    "\"},{\"byteLength\":16,\"uri\":\"data:;base64,AAAAAP8AAAAA/wAA//8AAA==\"}],\"bufferViews\":[{\"buffer\":0,"            \
    "\"byteLength\":" size ",\"byteStride\":" stride "},{\"buffer\":1,\"byteLength\":16,\"byteStride\":4}],"                \
    "\"accessors\":[{\"type\":\"VEC3\",\"bufferView\":0,\"count\":4," type "},{\"type\":\"VEC2\",\"componentType\":5121,"   \
    "\"normalized\":true,\"bufferView\":1,\"count\":4}],\"nodes\":[{\"mesh\":0,\"scale\":[2,2,2]}],\"meshes\":[{"           \
    "\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"mode\":5}]}]}"
#define WORDS "AAAAAAAAAAD/fwAAAAAAAAAA/38AAAAA/3//fwAAAAA="

/// KHR_mesh_quantization: integers, normalized or not, under the scale of their node. A byte of -128 is -1.
static void test_quantization(void **state)
{
    (void)state;
    static const double fractions[] = {0, 0, 0, 2, 0, 0, 0, 2, 0, 2, 2, 0};
    static const double whole[] = {0, 0, 0, 65534, 0, 0, 0, 65534, 0, 65534, 65534, 0};
    static const double bytes[] = {-2, -2, -2, 2, -2, -2, -2, 2, -2, 2, 2, -2};
    const char *normalized =
        QUANTIZED_FILE("KHR_mesh_quantization", "32", WORDS, "8", "\"componentType\":5122,\"normalized\":true");
    assert_points(normalized, fractions);
    assert_points(QUANTIZED_FILE("KHR_mesh_quantization", "32", WORDS, "8", "\"componentType\":5122"), whole);
    assert_points(QUANTIZED_FILE("KHR_mesh_quantization", "16", "gICAAH+AgACAf4AAf3+AAA==", "4",
                                 "\"componentType\":5120,\"normalized\":true"),
                  bytes);
    bat_mesh mesh = must_read(normalized, BAT_MESH_FORMAT_GLTF);
    static const double places[] = {0, 1, 1, 1, 0, 0, 1, 0}; // v is reversed
    for (size_t c = 0; c < 6; c++)
        assert_memory_equal(mesh.texture + 2 * (size_t)mesh.texture_faces[c], places + 2 * (size_t)mesh.faces[c],
                            2 * sizeof(double));
    bat_mesh_free(&mesh);
    bad(QUANTIZED_FILE("KHR_mesh_quantization", "32", WORDS, "8", "\"componentType\":5125,\"normalized\":true"),
        BAT_BAD_FILE, "cannot be normalized");
    bad(QUANTIZED_FILE("KHR_mesh_quantization", "32", WORDS, "8", "\"componentType\":5124"), BAT_BAD_FILE,
        "no 'componentType'");
    bad(QUANTIZED_FILE("VENDOR_mesh_quantization", "32", WORDS, "8", "\"componentType\":5122"), BAT_UNSUPPORTED,
        "'VENDOR_mesh_quantization', which is not read");
}

static void put_bytes(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void bad_file(const char *path, bat_status expected, const char *words)
{
    bat_mesh mesh;
    bat_error error = {.text = ""};
    assert_int_equal(bat_mesh_read(path, NULL, &mesh, &error), expected);
    if (strstr(error.text, words) == NULL)
        fail_msg("\"%s\" does not say \"%s\"", error.text, words);
}

#define OUTSIDE(uri)                                                                                                        \
    HEAD BUFFER(uri)                                                                                                        \
    GOOD_VIEW GOOD_ACCESSOR MESH("5")

/// Buffers in files: in the folder of the glTF file or below it, with percent escapes, and nowhere else.
static void test_external_buffers(void **state)
{
    (void)state;
    static const float numbers[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    char points[sizeof numbers];
    little_endian(points, numbers, sizeof numbers / sizeof *numbers);
    bat_mesh mesh;
    assert_int_equal(mkdir("sub", 0700), 0);
    assert_int_equal(mkdir("sub/a b", 0700), 0);
    put_bytes("sub/points.bin", points, sizeof points);
    put_bytes("sub/a b/points.bin", points, sizeof points);
    put_bytes("points.bin", points, sizeof points - 1);
    put("sub/beside.gltf", OUTSIDE("points.bin"));
    put("sub/below.gltf", OUTSIDE("a%20b/points.bin"));
    put("sub/above.gltf", OUTSIDE("../points.bin"));
    put("sub/escaped.gltf", OUTSIDE("%2e%2e/points.bin"));
    put("sub/far.gltf", OUTSIDE("https://example.org/points.bin"));
    put("sub/root.gltf", OUTSIDE("/etc/passwd"));
    put("sub/missing.gltf", OUTSIDE("other.bin"));
    put("short.gltf", OUTSIDE("points.bin"));
    for (int i = 0; i < 2; i++)
    {
        check_status(bat_mesh_read(i == 0 ? "sub/beside.gltf" : "sub/below.gltf", NULL, &mesh, NULL), BAT_OK);
        assert_memory_equal(mesh.positions, UNIT_POINTS, sizeof UNIT_POINTS);
        bat_mesh_free(&mesh);
    }
    bad_file("sub/above.gltf", BAT_BAD_FILE, "'../points.bin' is no file in the folder");
    bad_file("sub/escaped.gltf", BAT_BAD_FILE, "is no file in the folder");
    bad_file("sub/far.gltf", BAT_BAD_FILE, "is no file in the folder");
    bad_file("sub/root.gltf", BAT_BAD_FILE, "is no file in the folder");
    bad_file("sub/missing.gltf", BAT_FILE_ACCESS, "'other.bin'");
    bad_file("short.gltf", BAT_BAD_FILE, "47 bytes instead of 48");
    static const char *const made[] = {"sub/a b/points.bin",
                                       "sub/a b",
                                       "sub/points.bin",
                                       "sub/beside.gltf",
                                       "sub/below.gltf",
                                       "sub/above.gltf",
                                       "sub/escaped.gltf",
                                       "sub/far.gltf",
                                       "sub/root.gltf",
                                       "sub/missing.gltf",
                                       "sub"};
    for (size_t i = 0; i < sizeof made / sizeof *made; i++)
        assert_int_equal(remove(made[i]), 0);
}

/// A data URI may name any type, but must be in base64.
static void test_data_uris(void **state)
{
    (void)state;
    assert_points(HEAD BUFFER("data:application/gltf-buffer;base64,"
                              "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPwAAgD8AAAAA")
                      GOOD_VIEW GOOD_ACCESSOR MESH("5"),
                  UNIT_POINTS);
    bad(OUTSIDE("data:,abc"), BAT_BAD_FILE, "not in base64");
    bad(OUTSIDE("data:text/plain,abc"), BAT_BAD_FILE, "not in base64");
    bad(OUTSIDE("data:;base64"), BAT_BAD_FILE, "not in base64");
    bad(OUTSIDE("data:;base64,AAA"), BAT_BAD_FILE, "2 bytes instead of 48"); // without padding
    bad(HEAD "\"buffers\":[{\"byteLength\":48}]," GOOD_VIEW GOOD_ACCESSOR MESH("5"), BAT_BAD_FILE, "neither 'uri'");
}

/// GLB holds images in its binary chunk; glTF as data URIs. Names of files and texts that are no base64 stay.
static void test_images(void **state)
{
    (void)state;
    static const char materials[] =
        "{\"materials\":[{\"name\":\"brick\",\"normalTexture\":{\"index\":0}}],\"textures\":[{\"source\":0}],"
        "\"images\":[{\"mimeType\":\"image/png\",\"uri\":\"data:image/png;base64,aW1hZ2U=\"},"
        "{\"uri\":\"file.png\"},{\"uri\":\"data:image/png;base64,?\"}]}";
    bat_mesh mesh = labelled_mesh();
    mesh.material_json = strdup(materials);
    for (bat_mesh_format format = BAT_MESH_FORMAT_GLTF; format <= BAT_MESH_FORMAT_GLB; format++)
    {
        size_t size;
        bool binary = format == BAT_MESH_FORMAT_GLB;
        char *bytes = must_write(&mesh, format, BAT_MESH_ENCODING_BINARY, &size);
        const char *json = bytes + (binary ? 20 : 0);
        assert_int_equal(strstr(json, "base64,aW1hZ2U=") == NULL, binary);
        assert_int_equal(strstr(json, "\"mimeType\":\"image/png\",\"bufferView\":3}") != NULL, binary);
        assert_non_null(strstr(json, "\"uri\":\"file.png\""));
        assert_non_null(strstr(json, "base64,?"));
        assert_int_equal(binary && memcmp(bytes + size - 8, "image\0\0\0", 8) == 0, binary);
        free(bytes);
        bat_mesh back = through_file(&mesh, format, BAT_MESH_ENCODING_BINARY);
        assert_non_null(strstr(back.material_json, "\"uri\":\"data:image/png;base64,aW1hZ2U=\""));
        assert_null(strstr(back.material_json, "bufferView"));
        bat_mesh_free(&back);
    }
    bat_mesh_free(&mesh);
}

/// The content decides where the ending is wrong, with a note; JSON and GLB have one reader.
static void test_wrong_endings(void **state)
{
    (void)state;
    static const char json[] = HEAD BUFFER(POINTS) GOOD_VIEW GOOD_ACCESSOR MESH("5");
    bat_mesh mesh = must_read(json, BAT_MESH_FORMAT_GLTF), back;
    size_t size;
    char *bytes = must_write(&mesh, BAT_MESH_FORMAT_GLB, BAT_MESH_ENCODING_BINARY, &size);
    put_bytes("binary.obj", bytes, size);
    put_bytes("binary.gltf", bytes, size);
    put("json.glb", json);
    put("json.ply", json);
    put("obj.glb", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    static const struct
    {
        const char *path, *note;
    } cases[] = {
        {"binary.obj", "the content is glb, not obj"},
        {"binary.gltf", NULL},
        {"json.glb", NULL},
        {"json.ply", "the content is gltf, not ply"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_mesh_notes notes = {0};
        bat_mesh_read_options options = bat_mesh_read_defaults();
        options.notes = &notes;
        check_status(bat_mesh_read(cases[i].path, &options, &back, NULL), BAT_OK);
        assert_same_shape(&mesh, &back);
        bat_mesh_free(&back);
        bool noted = false;
        for (size_t k = 0; k < notes.count; k++)
            noted = noted || strstr(notes.texts[k], cases[i].note != NULL ? cases[i].note : "the content is") != NULL;
        assert_true(noted == (cases[i].note != NULL));
        bat_mesh_notes_free(&notes);
    }
    bad_file("obj.glb", BAT_BAD_FILE, "begins neither as GLB");
    free(bytes);
    bat_mesh_free(&mesh);
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
        cmocka_unit_test(test_modes),
        cmocka_unit_test(test_transforms),
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_far_positions),
        cmocka_unit_test(test_faults),
        cmocka_unit_test(test_sparse),
        cmocka_unit_test(test_strides),
        cmocka_unit_test(test_quantization),
        cmocka_unit_test_setup_teardown(test_external_buffers, enter_folder, leave_folder),
        cmocka_unit_test(test_data_uris),
        cmocka_unit_test(test_images),
        cmocka_unit_test_setup_teardown(test_wrong_endings, enter_folder, leave_folder),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_notes),
        cmocka_unit_test(test_normals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
