// PLY: headers, types, byte orders, skipped elements, and errors.
#include "mesh_file_helpers.h"

static const bat_mesh_format PLY = BAT_MESH_FORMAT_PLY;
static const char *const ORDERS[] = {"ascii", "binary_little_endian", "binary_big_endian"};

#define ASCII "ply\nformat ascii 1.0\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define FACES "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
#define TRIANGLE "0 0 0\n1 0 0\n0 1 0\n"

/// A file under construction.
typedef struct bytes
{
    char data[4096];
    size_t size;
    bool big_endian;
} bytes;

static void put_text(bytes *file, const char *text)
{
    memcpy(file->data + file->size, text, strlen(text));
    file->size += strlen(text);
}

static void put_bits(bytes *file, uint64_t bits, int size)
{
    for (int i = 0; i < size; i++)
        file->data[file->size++] = (char)(bits >> 8 * (file->big_endian ? size - 1 - i : i));
}

/// A number of a type by its name.
static void put_number(bytes *file, const char *type, double value)
{
    float single = (float)value;
    uint32_t single_bits;
    uint64_t double_bits;
    memcpy(&single_bits, &single, sizeof single);
    memcpy(&double_bits, &value, sizeof value);
    if (strstr(type, "float64") != NULL || strcmp(type, "double") == 0)
        put_bits(file, double_bits, 8);
    else if (strstr(type, "float") != NULL)
        put_bits(file, single_bits, 4);
    else
        put_bits(file, (uint64_t)(int64_t)value,
                 strstr(type, "char") != NULL || strstr(type, "int8") != NULL     ? 1
                 : strstr(type, "short") != NULL || strstr(type, "int16") != NULL ? 2
                                                                                  : 4);
}

static bat_mesh read_bytes(const bytes *file)
{
    bat_mesh_read_options options = bat_mesh_read_defaults();
    return must_read_bytes(file->data, file->size, &options);
}

/// Every type, as a coordinate, as a channel, as an index and as a length, in every encoding.
static void test_every_type(void **state)
{
    (void)state;
    static const struct
    {
        const char *name, *other;
        double least, most;
    } types[] = {{"char", "int8", -128, 127},
                 {"uchar", "uint8", 0, 255},
                 {"short", "int16", -32768, 32767},
                 {"ushort", "uint16", 0, 65535},
                 {"int", "int32", -2147483648.0, 2147483647},
                 {"uint", "uint32", 0, 4294967295},
                 {"float", "float32", -1.5f, 0x1p100f},
                 {"double", "float64", -0.1, 1e300}};
    for (size_t t = 0; t < sizeof types / sizeof *types; t++)
        for (size_t order = 0; order < 6; order++)
        {
            const char *type = order < 3 ? types[t].name : types[t].other, *whole = t < 6 ? type : "uint16";
            bytes file = {.big_endian = order % 3 == 2};
            char header[512];
            (void)snprintf(header, sizeof header,
                           "ply\nformat %s 1.0\ncomment by hand # end_header\nelement vertex 3\nproperty %s x\nproperty %s "
                           "y\nproperty float z\nproperty %s weight\nelement face 1\nproperty list %s %s "
                           "vertex_index\nend_header\n",
                           ORDERS[order % 3], type, type, type, whole, whole);
            put_text(&file, header);
            const double rows[3][4] = {{types[t].least, types[t].most, .5, 1}, {1, 2, 3, types[t].most}, {0, 1, 0, 0}};
            for (size_t v = 0; v < 3 && order % 3 > 0; v++)
                for (size_t k = 0; k < 4; k++)
                    put_number(&file, k == 2 ? "float" : type, rows[v][k]);
            for (double i = 3; i >= 0 && order % 3 > 0; i--)
                put_number(&file, whole, i < 3 ? 2 - i : 3);
            for (size_t v = 0; v < 3 && order % 3 == 0; v++)
            {
                char row[256];
                (void)snprintf(row, sizeof row, "%.17g %.17g %.17g %.17g\n", rows[v][0], rows[v][1], rows[v][2], rows[v][3]);
                put_text(&file, row);
            }
            if (order % 3 == 0)
                put_text(&file, "3 0 1 2\n");
            bat_mesh mesh = read_bytes(&file);
            for (size_t v = 0; v < 3; v++)
            {
                assert_memory_equal(mesh.positions + 3 * v, rows[v], 3 * sizeof(double));
                assert_true(mesh.channels[v] == rows[v][3]);
            }
            assert_string_equal(mesh.channel_names[0], "weight");
            const uint32_t corners[] = {0, 1, 2};
            assert_memory_equal(mesh.faces, corners, sizeof corners);
            bat_mesh_free(&mesh);
        }
}

static void test_meanings_of_properties(void **state)
{
    (void)state;
    bat_mesh mesh = must_read(ASCII "obj_info x\nelement vertex 3\n" XYZ
                                    "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty "
                                    "ushort green\nproperty float blue\nproperty list uchar int near\nproperty double "
                                    "quality\nproperty float u\nproperty float v\n" FACES
                                    "0 0 0 0 0 1 255 65535 1 0 .25 .5 .75\n1 0 0 0 0 1 51 0 .5 2 1 2 4 0 "
                                    "1\n0 1 0 0 0 1 0 13107 0 1 7 9 1 1\n3 0 1 2\n",
                              BAT_MESH_FORMAT_AUTO);
    static const char *const names[] = {"red", "green", "blue", "quality"};
    const double channels[] = {1, 1, 1, .25, .2, 0, .5, 4, 0, .2, 0, 9};
    const double texture[] = {.5, .75, 0, 1, 1, 1};
    assert_int_equal(mesh.channel_count, 4);
    for (size_t i = 0; i < 4; i++)
        assert_string_equal(mesh.channel_names[i], names[i]);
    assert_memory_equal(mesh.channels, channels, sizeof channels);
    assert_int_equal(mesh.texture_count, 3);
    assert_memory_equal(mesh.texture, texture, sizeof texture);
    assert_memory_equal(mesh.texture_faces, mesh.faces, 3 * sizeof(uint32_t));
    bat_mesh_free(&mesh);
    mesh = must_read(ASCII "element vertex 3\n" XYZ "property float u\n" FACES "0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2\n", PLY);
    assert_int_equal(mesh.texture_count, 0);
    assert_string_equal(mesh.channel_names[0], "u");
    bat_mesh_free(&mesh);
}

static void test_texture_at_corners(void **state)
{
    (void)state;
    static const char header[] =
        "ply\nformat %s 1.0\nelement face 3\nproperty list uchar float texcoord\nproperty int texnumber\nproperty list int "
        "ushort vertex_indices\nelement vertex 4\n" XYZ "property float s\nproperty float t\nend_header\n";
    for (size_t order = 0; order < 3; order++)
    {
        bytes file = {.big_endian = order == 2};
        char filled[512];
        (void)snprintf(filled, sizeof filled, header, ORDERS[order]);
        put_text(&file, filled);
        static const double rows[3][12] = {
            {6, 0, 0, 1, 0, 0, 1, 7, 3, 0, 1, 2}, {6, 1, 0, 1, 1, .5, 1, 7, 3, 1, 3, 2}, {0, 7, 3, 0, 2, 3}};
        static const size_t lengths[] = {12, 12, 6};
        for (size_t f = 0; f < 3; f++)
            for (size_t i = 0; i < lengths[f]; i++)
            {
                size_t texture = lengths[f] - 5;
                char word[32];
                (void)snprintf(word, sizeof word, "%g%s", rows[f][i], i + 1 < lengths[f] ? " " : "\n");
                if (order == 0)
                    put_text(&file, word);
                else
                    put_number(&file,
                               i == 0            ? "uchar"
                               : i < texture     ? "float"
                               : i < texture + 2 ? "int"
                                                 : "ushort",
                               rows[f][i]);
            }
        for (size_t v = 0; v < 4; v++)
            for (size_t k = 0; k < 5; k++)
                if (order == 0)
                    put_text(&file, k < 4 ? "9 " : "9\n");
                else
                    put_number(&file, "float", 9);
        bat_mesh mesh = read_bytes(&file);
        // Vertex 1 has one texture coordinate in both faces, vertex 2 has two; the last face has none, so (0, 0).
        const uint32_t places[] = {0, 1, 2, 1, 3, 4, 5, 5, 5};
        const double texture[] = {0, 0, 1, 0, 0, 1, 1, 1, .5, 1, 0, 0};
        assert_int_equal(mesh.texture_count, 6);
        assert_memory_equal(mesh.texture_faces, places, sizeof places);
        assert_memory_equal(mesh.texture, texture, sizeof texture);
        assert_int_equal(mesh.channel_count, 2);
        bat_mesh_free(&mesh);
    }
}

static void test_other_elements_are_passed_over(void **state)
{
    (void)state;
    for (size_t order = 0; order < 3; order++)
    {
        bytes file = {.big_endian = order == 2};
        char header[512];
        (void)snprintf(
            header, sizeof header,
            "ply\r\nformat %s 1.0\r\nelement camera 2\r\nproperty float f\r\nproperty list uint8 double "
            "l\r\nelement nothing 1000000\r\nelement vertex 3\r\n" XYZ
            "element edge 1\nproperty int vertex1\nproperty int vertex2\nelement face 1\nproperty list uchar uchar "
            "vertex_indices\nproperty uchar flags\nelement last 1\nproperty short s\nend_header\n",
            ORDERS[order]);
        put_text(&file, header);
        if (order == 0)
            put_text(&file, "1.5 2 3 4\n-1 0\n" TRIANGLE "\n0 1\n3 0 1 2 8\n-5\n\n");
        static const double camera[] = {1.5, 2, 3, 4, -1, 0}, rest[] = {0, 1, 3, 0, 1, 2, 8, -5};
        static const char *const camera_types[] = {"float", "uchar", "double", "double", "float", "uchar"};
        for (size_t i = 0; i < 6 && order > 0; i++)
            put_number(&file, camera_types[i], camera[i]);
        static const double triangle[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        for (size_t i = 0; i < 9 && order > 0; i++)
            put_number(&file, "float", triangle[i]);
        for (size_t i = 0; i < 8 && order > 0; i++)
            put_number(&file, i < 2 ? "int" : i < 7 ? "uchar" : "short", rest[i]);
        bat_mesh mesh = read_bytes(&file);
        assert_memory_equal(mesh.positions, triangle, sizeof triangle);
        bat_mesh_free(&mesh);
        if (order > 0)
            assert_truncations_fail(file.data, file.size, 0, PLY);
        else
            assert_truncations_fail(file.data, file.size, 4, PLY);
    }
}

static void test_polygons(void **state)
{
    (void)state;
    static const char text[] =
        ASCII "element vertex 4\n" XYZ "element face 2\nproperty list uchar int vertex_indices\nend_header\n" TRIANGLE
              "1 1 0\n3 0 1 2\n\n4 0 1 3 2\n";
    assert_bad(text, PLY, 16, "face 1 has 4 corners; triangulate cuts it");
    bat_mesh mesh = must_cut(text, PLY);
    assert_int_equal(mesh.face_count, 3);
    bat_mesh_free(&mesh);
}

static void test_bad_headers(void **state)
{
    (void)state;
    static const char vertex[] = "element vertex 3\n" XYZ;
    assert_bad("", PLY, 1, "does not begin with a line 'ply'");
    assert_bad("plyx\n", PLY, 1, "does not begin with a line 'ply'");
    assert_bad("ply\n", PLY, 2, "the file ends in its header");
    assert_bad("ply\ncomment x\n", PLY, 3, "the file ends in its header");
    assert_bad("ply\nelement vertex 3\n", PLY, 2, "'element' was found where 'format'");
    assert_bad("ply\nformat binary 1.0\n", PLY, 2, "'binary' is not ascii");
    assert_bad("ply\nformat ascii 2.0\n", PLY, 2, "'2.0' is not version 1.0");
    assert_bad(ASCII "element\n", PLY, 3, "'' was found where the element's name");
    assert_bad(ASCII "element vertex\n", PLY, 3, "'' is not the number of elements");
    assert_bad(ASCII "element vertex -3\n", PLY, 3, "'-3' is not the number of elements");
    assert_bad(ASCII "element vertex 99999999999999999999\n", PLY, 3, "is not the number of elements");
    assert_bad(ASCII "element vertex 3 4\n", PLY, 3, "'4' is superfluous");
    assert_bad(ASCII "property int x\n", PLY, 3, "belongs to no element");
    assert_bad(ASCII "element vertex 3\nproperty long x\n", PLY, 4, "'long' is not a type");
    assert_bad(ASCII "element vertex 3\nproperty float\n", PLY, 4, "'' was found where the property's name");
    assert_bad(ASCII "element vertex 3\nproperty list float int a\n", PLY, 4, "length must be a whole number");
    assert_bad(ASCII "element vertex 3\nproperty int x\nproperty float x\n", PLY, 5, "the property's name is used already");
    assert_bad(ASCII "element vertex 3\nelement vertex 3\n", PLY, 4, "the element's name is used already");
    assert_bad(ASCII "elements\n", PLY, 3, "'elements' is not comment");
    assert_bad(ASCII "end_header\n", PLY, 0, "no element 'vertex'");
    char text[512];
    (void)snprintf(text, sizeof text, ASCII "%send_header\n", vertex);
    assert_bad(text, PLY, 0, "no element 'face'");
    (void)snprintf(text, sizeof text, ASCII "%selement face 1\nproperty int vertex_indices\nend_header\n", vertex);
    assert_bad(text, PLY, 0, "faces have no list");
    (void)snprintf(text, sizeof text, ASCII "%selement face 1\nproperty list uchar float vertex_indices\nend_header\n",
                   vertex);
    assert_bad(text, PLY, 0, "indices of vertices must be whole");
    assert_bad(ASCII "element vertex 3\nproperty float x\nproperty float y\nproperty list uchar float z\n" FACES, PLY, 0,
               "no property 'z'");
    assert_bad(ASCII "element vertex 3\nproperty float y\n" FACES, PLY, 0, "no property 'x'");
    assert_bad(ASCII "element vertex 3\n" XYZ "element face 0\nproperty list uchar int vertex_index\nend_header\n" TRIANGLE,
               PLY, 0, "there are no faces");
}

static void test_bad_data(void **state)
{
    (void)state;
#define HEADER ASCII "element vertex 3\n" XYZ FACES // 9 lines
    assert_bad(HEADER "0 0 0\n1 0 0\n0 1 zero\n3 0 1 2\n", PLY, 12, "'zero' cannot be the 'z' of vertex 2");
    assert_bad(HEADER "0 0 0\n1 0 0\n0 1 nan\n3 0 1 2\n", PLY, 12, "'nan' cannot be the 'z' of vertex 2");
    assert_bad(HEADER "0 0 0\n1 0\n0 1 0\n3 0 1 2\n", PLY, 11, "vertex 1 ends before its 'z'");
    assert_bad(HEADER "0 0 0\n1 0 0 1\n0 1 0\n3 0 1 2\n", PLY, 11, "'1' is superfluous");
    assert_bad(HEADER "0 0 0\n1 0 0\n0 1 0\n3 0 1\n", PLY, 13, "face 0 ends before its 'vertex_indices'");
    assert_bad(HEADER "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", PLY, 13, "face 0 names vertex 3, but there are 3");
    assert_bad(HEADER "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", PLY, 13, "face 0 names vertex -1");
    assert_bad(HEADER "0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n", PLY, 13, "'1.5' cannot be the 'vertex_indices' of face 0");
    assert_bad(HEADER "0 0 0\n1 0 0\n0 1 0\n256 0 1 2\n", PLY, 13, "'256' cannot be the 'vertex_indices' of face 0");
    assert_bad(HEADER "0 0 0\n1 0 0\n0 1 0\n2 0 1\n", PLY, 13, "face 0 has 2 corners");
    assert_bad(HEADER "0 0 0\n1 0 0\n0 1 0\n\n3 0 1 1\n", PLY, 14, "face 0 has vertex 1, counted from 0, twice");
    assert_bad(HEADER "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n", PLY, 14, "there is data after the last element");
    assert_bad(HEADER "0 0 0\n1 0 0\n0 1 0\n", PLY, 13, "the file ends at face 0 of 1");
    assert_bad(ASCII "element vertex 4000000000\n" XYZ FACES TRIANGLE "3 0 1 2\n", PLY, 0, "too short for its 4000000000");
    bat_mesh_read_options options = reading_as(PLY);
    static const char many[] = ASCII "element vertex 5000000000\n" XYZ FACES;
    assert_refused(many, sizeof many - 1, &options, BAT_TOO_LARGE, 0, "more than");
    static const char list[] = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" XYZ
                               "element face 1\nproperty list int int vertex_index\nend_header\n"
                               "\0\0\0\0\0\0\0\0\0\0\0\0\xff\xff\xff\x7f\0\0\0\0";
    assert_refused(list, sizeof list - 1, &options, BAT_BAD_FILE, 0, "face 0 ends before its 'vertex_index'");
    char negative[sizeof list];
    memcpy(negative, list, sizeof list);
    negative[sizeof list - 6] = '\xff';
    assert_refused(negative, sizeof negative - 1, &options, BAT_BAD_FILE, 0, "'vertex_index' of face 0");
    static const char infinite[] = "ply\nformat binary_big_endian 1.0\nelement vertex 1\n" XYZ
                                   "element face 0\nproperty list int int vertex_index\nend_header\n"
                                   "\0\0\0\0\x7f\x80\0\0\0\0\0\0";
    assert_refused(infinite, sizeof infinite - 1, &options, BAT_BAD_FILE, 0, "'y' of vertex 0 is not finite");
    static const char uneven[] = ASCII "element vertex 3\n" XYZ "element face 1\nproperty list uchar int vertex_index\n"
                                       "property list uchar float texcoord\nend_header\n" TRIANGLE "3 0 1 2 4 0 0 0 0\n";
    assert_refused(uneven, sizeof uneven - 1, &options, BAT_BAD_FILE, 14, "face 0 has 3 corners, but 4 texture numbers");
}

static void test_round_trip(void **state)
{
    (void)state;
    static const char *const names[] = {"red", "curvature", "u", "temperature"};
    for (uint64_t seed = 1; seed <= 30; seed++)
    {
        const mesh_extras extras = {.texture = seed % 3 == 0   ? SIZE_MAX
                                               : seed % 3 == 1 ? 50
                                                               : 0,
                                    .channels = names,
                                    .channel_count = seed % 5};
        bat_mesh mesh = random_mesh(seed, seed == 30 ? 30000 : 10 + seed, seed == 30 ? 60000 : 40, &extras);
        for (size_t v = 0; v < mesh.vertex_count && seed % 5 > 0 && seed % 2 > 0; v++)
            mesh.channels[v * mesh.channel_count] = (double)(v % 256) / 255; // bytes hold these exactly
        for (int encoding = BAT_MESH_ENCODING_BINARY; encoding <= BAT_MESH_ENCODING_TEXT; encoding++)
        {
            bat_mesh back = through_file(&mesh, PLY, (bat_mesh_encoding)encoding);
            assert_same_shape(&mesh, &back);
            assert_same_channels(&mesh, &back);
            assert_same_texture(&mesh, &back);
            bat_mesh_free(&back);
        }
        bat_mesh_free(&mesh);
    }
}

static void test_colours_become_bytes(void **state)
{
    (void)state;
    bat_mesh mesh = must_read("v 0 0 0 1 0 .2\nv 1 0 0 0 0.1 1\nv 0 1 0 0 1 0\nf 1 2 3\n", BAT_MESH_FORMAT_OBJ);
    assert_text(&mesh, PLY,
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double "
                "z\nproperty uchar red\nproperty double green\nproperty uchar blue\nelement face 1\nproperty "
                "list uchar int vertex_indices\nend_header\n0 0 0 255 0 51\n1 0 0 0 0.1 255\n0 1 0 0 1 0\n3 0 1 "
                "2\n");
    bat_mesh_free(&mesh);
}

static void test_names_that_ply_cannot_hold(void **state)
{
    (void)state;
    static const struct
    {
        const char *names[2];
        size_t texture;
        bool fine;
    } cases[] = {{{"a b", "c"}, 0, false},     {{"a", "x"}, 0, false},        {{"a", "nz"}, 0, false},
                 {{"a", "a"}, 0, false},       {{"", "a"}, 0, false},         {{"a#", "b"}, 0, false},
                 {{"s", "t"}, 0, false},       {{"u", "v"}, 0, false},        {{"u", "t"}, 0, true},
                 {{"u", "v"}, SIZE_MAX, true}, {{"u", "v"}, 20, true},        {{"s", "t"}, 20, true},
                 {{"s", "a"}, 0, true},        {{"s", "a"}, SIZE_MAX, false}, {{"\xc3\xa9", "a"}, 0, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        const mesh_extras extras = {.texture = cases[i].texture, .channels = cases[i].names, .channel_count = 2};
        bat_mesh mesh = random_mesh(i, 12, 12, &extras);
        if (cases[i].fine)
        {
            bat_mesh back = through_file(&mesh, PLY, BAT_MESH_ENCODING_BINARY);
            assert_same_channels(&mesh, &back);
            assert_same_texture(&mesh, &back);
            bat_mesh_free(&back);
        }
        else
            assert_unwritable(&mesh, PLY, BAT_MESH_ENCODING_BINARY, BAT_UNSUPPORTED, "PLY ");
        bat_mesh_free(&mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_type),
                                       cmocka_unit_test(test_meanings_of_properties),
                                       cmocka_unit_test(test_texture_at_corners),
                                       cmocka_unit_test(test_other_elements_are_passed_over),
                                       cmocka_unit_test(test_polygons),
                                       cmocka_unit_test(test_bad_headers),
                                       cmocka_unit_test(test_bad_data),
                                       cmocka_unit_test(test_round_trip),
                                       cmocka_unit_test(test_colours_become_bytes),
                                       cmocka_unit_test(test_names_that_ply_cannot_hold)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
