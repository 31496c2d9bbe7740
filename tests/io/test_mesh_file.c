// Mesh files of any format: formats by name, ending and content, options, atomic output, locales, and real meshes.
#include "choice_helpers.h"
#include "mesh_file_helpers.h"

#include "batten/mesh.h"

#include <dirent.h>
#include <locale.h>
#include <sys/stat.h>
#include <unistd.h>

#define TRIANGLE "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"

static void test_formats_by_name_and_ending(void **state)
{
    (void)state;
    static const char *const names[] = {"auto", "obj", "ply", "off", "stl", "gltf", "glb"};
    bat_error error = {0};
    for (int i = 0; i < 7; i++)
    {
        char path[32];
        assert_int_equal(choice_value(&bat_mesh_format_family, names[i]), i);
        (void)snprintf(path, sizeof path, "a.ply/b.%s", names[i]);
        assert_int_equal(choice_value_of_path(&bat_mesh_format_family, path), i);
    }
    const bat_choice *format = NULL;
    assert_int_equal(bat_choice_find(&bat_mesh_format_family, "fbx", &format, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "there are auto, obj, ply, off, stl, gltf, glb"));
    assert_null(format);
    assert_int_equal(choice_value_of_path(&bat_mesh_format_family, "A.StL"), BAT_MESH_FORMAT_STL);
    assert_int_equal(choice_value_of_path(&bat_mesh_format_family, "obj"), BAT_MESH_FORMAT_AUTO);
    assert_int_equal(choice_value_of_path(&bat_mesh_format_family, "-"), BAT_MESH_FORMAT_AUTO);
}

static bat_mesh_format format_of_file(const char *path)
{
    bat_mesh_format format;
    assert_int_equal(bat_mesh_format_of_file(path, &format, NULL), BAT_OK);
    return format;
}

/// Of the content alone where the name has no ending; an OBJ file of lines is none of a mesh.
static void test_files_are_recognized(void **state)
{
    (void)state;
    char folder[] = "/tmp/batten-test-XXXXXX", path[64];
    assert_non_null(mkdtemp(folder));
    (void)snprintf(path, sizeof path, "%s/mesh", folder);
    bat_mesh mesh = must_read(TRIANGLE, BAT_MESH_FORMAT_OBJ);
    const bat_choice *row;
    for (size_t i = 0; (row = bat_choices(&bat_mesh_format_family, i)) != NULL; i++)
    {
        bat_mesh_write_options options = bat_mesh_write_defaults();
        options.format = (bat_mesh_format)row->value;
        if (row->value == BAT_MESH_FORMAT_AUTO)
            continue;
        assert_int_equal(bat_mesh_write(path, &mesh, &options, NULL), BAT_OK);
        assert_int_equal(format_of_file(path), row->value);
    }
    static const char *const others[] = {
        "v 0 0 0\nv 1 0 0\nl 1 2\n", "{\"type\":\"LineString\",\"coordinates\":[[0,0],[1,\"asset\"]]}", "0,0\n1,0\n", ""};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
    {
        FILE *file = fopen(path, "w");
        (void)fputs(others[i], file);
        (void)fclose(file);
        assert_int_equal(format_of_file(path), BAT_MESH_FORMAT_AUTO);
    }
    assert_int_equal(format_of_file(folder), BAT_MESH_FORMAT_AUTO);
    assert_int_equal(remove(path), 0);
    assert_int_equal(format_of_file(path), BAT_MESH_FORMAT_AUTO);
    assert_int_equal(remove(folder), 0);
    bat_mesh_free(&mesh);
}

static void test_options_are_checked(void **state)
{
    (void)state;
    bat_mesh mesh = must_read(TRIANGLE, BAT_MESH_FORMAT_OBJ);
    bat_mesh_read_options reading = bat_mesh_read_defaults();
    reading.format = (bat_mesh_format)9;
    size_t formats = 0;
    while (bat_choices(&bat_mesh_format_family, formats) != NULL)
        formats++;
    char words[80];
    (void)snprintf(words, sizeof words, "format is 9, but must be from 0 to %zu", formats);
    assert_refused(TRIANGLE, strlen(TRIANGLE), &reading, BAT_INVALID_ARGUMENT, 0, words);
    bat_mesh back = {0};
    assert_int_equal(bat_mesh_read("/dev/null", &reading, &back, NULL), BAT_INVALID_ARGUMENT);
    assert_unwritable(&mesh, BAT_MESH_FORMAT_AUTO, BAT_MESH_ENCODING_TEXT, BAT_INVALID_ARGUMENT, "cannot tell what format");
    assert_unwritable(&mesh, (bat_mesh_format)-1, BAT_MESH_ENCODING_TEXT, BAT_INVALID_ARGUMENT, "format is -1, but must be");
    assert_unwritable(&mesh, BAT_MESH_FORMAT_STL, (bat_mesh_encoding)4, BAT_INVALID_ARGUMENT, "encoding is 4, but must be");
    assert_unwritable(&mesh, BAT_MESH_FORMAT_STL, BAT_MESH_ENCODING_BIG_ENDIAN, BAT_INVALID_ARGUMENT, "only PLY");
    bat_mesh_write_options writing = bat_mesh_write_defaults();
    writing.threads = -1;
    bat_error error;
    assert_int_equal(bat_mesh_write("/nowhere/a.obj", &mesh, &writing, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "threads"));
    assert_int_equal(bat_mesh_write("/nowhere/a.obj", &mesh, NULL, &error), BAT_FILE_ACCESS);
    mesh.positions[4] = NAN;
    assert_unwritable(&mesh, BAT_MESH_FORMAT_OBJ, BAT_MESH_ENCODING_TEXT, BAT_INVALID_POINT, "vertex 1 is not finite");
    mesh.face_count = 0;
    assert_unwritable(&mesh, BAT_MESH_FORMAT_OBJ, BAT_MESH_ENCODING_TEXT, BAT_INVALID_ARGUMENT, "no faces");
    bat_mesh_free(&mesh);
}

static void test_files(void **state)
{
    (void)state;
    static const char *const endings[] = {"obj", "PLY", "off", "stl", ""};
    char folder[] = "/tmp/batten-test-XXXXXX", path[64];
    assert_non_null(mkdtemp(folder));
    bat_mesh mesh = must_read(TRIANGLE, BAT_MESH_FORMAT_OBJ), bad = {0};
    bat_error error;
    for (size_t i = 0; i < 5; i++)
    {
        bat_mesh_write_options writing = bat_mesh_write_defaults();
        writing.format = i == 4 ? BAT_MESH_FORMAT_PLY : BAT_MESH_FORMAT_AUTO;
        (void)snprintf(path, sizeof path, "%s/mesh.%s", folder, endings[i]);
        bat_mesh back = {0};
        assert_int_equal(bat_mesh_write(path, &mesh, i == 4 ? &writing : NULL, &error), BAT_OK);
        assert_int_equal(bat_mesh_read(path, NULL, &back, &error), BAT_OK);
        assert_same_shape(&mesh, &back);
        bat_mesh_free(&back);
        // A failure does not change the file.
        assert_int_equal(bat_mesh_write(path, &bad, i == 4 ? &writing : NULL, &error), BAT_INVALID_ARGUMENT);
        assert_int_equal(bat_mesh_read(path, NULL, &back, &error), BAT_OK);
        bat_mesh_free(&back);
        assert_int_equal(remove(path), 0);
    }
    assert_int_equal(bat_mesh_write(path, &mesh, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_mesh_read(path, NULL, &bad, &error), BAT_FILE_ACCESS);
    assert_null(bad.positions);
    (void)snprintf(path, sizeof path, "%s/mesh.stl", folder);
    mesh.positions[0] = 1e300;
    assert_int_equal(bat_mesh_write(path, &mesh, NULL, &error), BAT_UNSUPPORTED);
    assert_int_equal(access(path, F_OK), -1);
    assert_int_equal(remove(folder), 0);
    bat_mesh_free(&mesh);
}

/// In locales with another decimal separator.
static void test_locales(void **state)
{
    (void)state;
    static const char *const locales[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8", "ru_RU.UTF-8"};
    int found = 0;
    for (size_t i = 0; i < sizeof locales / sizeof *locales; i++)
    {
        if (setlocale(LC_ALL, locales[i]) == NULL)
            continue;
        found++;
        bat_mesh mesh = random_mesh(i, 20, 20, NULL);
        for (int format = BAT_MESH_FORMAT_OBJ; format <= BAT_MESH_FORMAT_STL; format++)
        {
            bat_mesh back = through_file(&mesh, (bat_mesh_format)format, BAT_MESH_ENCODING_TEXT);
            assert_int_equal(back.vertex_count, mesh.vertex_count);
            if (format != BAT_MESH_FORMAT_STL)
                assert_same_shape(&mesh, &back);
            bat_mesh_free(&back);
        }
        bat_mesh_free(&mesh);
        assert_bad("v 0 0 0,5\n", BAT_MESH_FORMAT_OBJ, 1, "'0,5' is not a number");
    }
    (void)setlocale(LC_ALL, "C");
    if (found == 0)
    {
        print_message("skipped: the system has no locale with a decimal comma\n");
        skip();
    }
}

#define MESHES SHARED_DATA "/data/meshes"

/// A real mesh is preserved by every format.
static void check_real(const char *path)
{
    bat_mesh_read_options options = bat_mesh_read_defaults();
    options.triangulate = true;
    bat_mesh mesh = {0}, repaired;
    bat_error error = {0};
    if (bat_mesh_read(path, &options, &mesh, &error) != BAT_OK)
        fail_msg("%s:%zu: %s", path, error.line, error.text);
    for (int format = BAT_MESH_FORMAT_OBJ; format <= BAT_MESH_FORMAT_STL; format++)
        for (int encoding = BAT_MESH_ENCODING_BINARY; encoding <= BAT_MESH_ENCODING_TEXT; encoding += 2)
        {
            bat_mesh back = through_file(&mesh, (bat_mesh_format)format, (bat_mesh_encoding)encoding);
            assert_int_equal(back.face_count, mesh.face_count);
            if (format != BAT_MESH_FORMAT_STL)
                assert_same_shape(&mesh, &back);
            if (format == BAT_MESH_FORMAT_OBJ || format == BAT_MESH_FORMAT_PLY)
                assert_same_texture(&mesh, &back);
            bat_mesh_free(&back);
        }
    assert_int_equal(bat_mesh_repair(&mesh, NULL, &repaired, &error), BAT_OK);
    bat_mesh_connectivity connectivity;
    if (bat_mesh_connect(&repaired, &connectivity, &error) != BAT_OK)
        fail_msg("%s: %s", path, error.text);
    bat_mesh_connectivity_free(&connectivity);
    bat_mesh_free(&repaired);
    bat_mesh_free(&mesh);
}

static void test_real_meshes(void **state)
{
    (void)state;
    DIR *folder = opendir(MESHES);
    if (folder == NULL)
    {
        print_message("skipped: there is no " MESHES "\n");
        skip();
    }
    int count = 0;
    for (struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder))
    {
        char path[512];
        (void)snprintf(path, sizeof path, "%s/%s", MESHES, entry->d_name);
        if (choice_value_of_path(&bat_mesh_format_family, path) == BAT_MESH_FORMAT_AUTO)
            continue;
        check_real(path);
        count++;
    }
    (void)closedir(folder);
    assert_true(count > 0);
}

/// Three faces at an edge, one of them twice, and a face with a vertex twice.
static void test_reading_can_repair(void **state)
{
    (void)state;
    static const char FINS[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 3\nf 2 1 4\nf 1 2 5\nf 1 2 5\nf 1 1 2\n";
    bat_mesh_read_options options = bat_mesh_read_defaults();
    bat_mesh_repair_report report = {.flipped_faces = 7};
    bat_mesh mesh, kept, repaired;
    bat_mesh_connectivity links;
    options.format = BAT_MESH_FORMAT_OBJ;
    options.repair = true;
    options.repairs = &report;
    assert_int_equal(bat_mesh_read_memory(FINS, sizeof FINS - 1, &options, &mesh, NULL), BAT_OK);
    assert_int_equal(bat_mesh_connect(&mesh, &links, NULL), BAT_OK);
    bat_mesh_connectivity_free(&links);
    assert_int_equal(report.degenerate_faces, 1);
    assert_int_equal(report.duplicate_faces, 1);
    size_t places = bat_mesh_repair_places(&report);
    assert_true(places >= 3);
    options.repair = false;
    options.keep_degenerate = true;
    assert_int_equal(bat_mesh_read_memory(FINS, sizeof FINS - 1, &options, &kept, NULL), BAT_OK);
    assert_int_equal(bat_mesh_repair_places(&report), 0);
    assert_int_equal(bat_mesh_repair(&kept, &report, &repaired, NULL), BAT_OK);
    assert_int_equal(bat_mesh_repair_places(&report), places);
    assert_int_equal(repaired.face_count, mesh.face_count);
    assert_memory_equal(repaired.faces, mesh.faces, 3 * mesh.face_count * sizeof *mesh.faces);
    bat_mesh_free(&mesh);
    bat_mesh_free(&kept);
    bat_mesh_free(&repaired);
}

static bat_mesh_read_options noting(bat_mesh_notes *notes)
{
    bat_mesh_read_options options = bat_mesh_read_defaults();
    options.format = BAT_MESH_FORMAT_OBJ;
    options.notes = notes;
    return options;
}

/// What is harmless is repaired with a note for each kind; strict reading refuses it.
static void test_harmless_repairs(void **state)
{
    (void)state;
    static const struct
    {
        const char *text, *note;
        size_t faces;
    } cases[] = {
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n", "repaired: 1 faces were turned over", 2},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 3\n", "repaired: 1 faces with a vertex twice", 1},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n", "polygons were cut into 2 triangles", 2},
        {"v 0 0 0 1 1 1\nv 1 0 0 1 nan 1\nv 0 1 0 1 1 -inf\nf 1 2 3\n", "2 values that are not finite", 1},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 1 0\nf 1 2 3\n", "1 vertices that are not finite were dropped, with 0 faces", 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_mesh_notes notes = {0};
        bat_mesh_read_options options = noting(&notes);
        bat_mesh mesh;
        bat_mesh_connectivity links;
        size_t size = strlen(cases[i].text);
        assert_int_equal(bat_mesh_read_memory(cases[i].text, size, &options, &mesh, NULL), BAT_OK);
        assert_int_equal(mesh.face_count, cases[i].faces);
        assert_int_equal(bat_mesh_connect(&mesh, &links, NULL), BAT_OK);
        assert_int_equal(notes.count, 1);
        if (strstr(notes.texts[0], cases[i].note) == NULL)
            fail_msg("%s", notes.texts[0]);
        bat_mesh_notes_free(&notes);
        bat_mesh_connectivity_free(&links);
        bat_mesh_free(&mesh);
        options.strict = true;
        bat_status status = bat_mesh_read_memory(cases[i].text, size, &options, &mesh, NULL);
        if (status == BAT_OK) // reading is no judge of manifolds
        {
            assert_int_equal(bat_mesh_connect(&mesh, &links, NULL), BAT_NOT_MANIFOLD);
            bat_mesh_free(&mesh);
        }
        bat_mesh_notes_free(&notes);
    }
}

/// Vertices of faces that are not finite go with a repair alone. Vertices and creases behind them are renumbered.
static void test_positions_that_are_not_finite(void **state)
{
    (void)state;
    static const char TEXT[] = "v nan 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 2 3 4\nt crease 2/1/0 1 2 3\n";
    bat_mesh_read_options options = noting(NULL);
    bat_mesh mesh;
    bat_error error;
    assert_int_equal(bat_mesh_read_memory(TEXT, sizeof TEXT - 1, &options, &mesh, &error), BAT_BAD_FILE);
    assert_non_null(strstr(error_words(&error), "vertex 0, counted from 0, is not finite; repair drops it"));
    options.repair = true;
    assert_int_equal(bat_mesh_read_memory(TEXT, sizeof TEXT - 1, &options, &mesh, &error), BAT_OK);
    const uint32_t corners[] = {0, 1, 2};
    assert_int_equal(mesh.vertex_count, 3);
    assert_int_equal(mesh.face_count, 1);
    assert_memory_equal(mesh.faces, corners, sizeof corners);
    assert_int_equal(mesh.crease_count, 1);
    assert_int_equal(mesh.creases[0].a + mesh.creases[0].b, 1);
    bat_mesh_free(&mesh);
}

// A prism over a pentagon and a roof: faces of three, four and five corners, two groups, and texture coordinates.
#define PRISM                                                                                                               \
    "v 0 0 0\nv 2 0 0\nv 3 1 0\nv 1 2 0\nv -1 1 0\nv 0 0 1\nv 2 0 1\nv 3 1 1\nv 1 2 1\nv -1 1 1\nv 1 1 2\n"                 \
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\ng wall\nf 5 4 3 2 1\nf 1/1 2/2 7/3 6/4\nf 2/1 3/2 8/3 7/4\nf 3/1 4/2 9/3 8/4\n"        \
    "f 4/1 5/2 10/3 9/4\nf 5/1 1/2 6/3 10/4\ng roof\nf 6 7 11\nf 7 8 11\nf 8 9 11\nf 9 10 11\nf 10 6 11\n"

static bat_mesh read_polygons(const char *bytes, size_t size, bat_mesh_format format)
{
    bat_mesh_read_options options = bat_mesh_read_defaults();
    bat_mesh mesh;
    bat_error error = {0};
    options.format = format;
    options.polygons = true;
    if (bat_mesh_read_memory(bytes, size, &options, &mesh, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return mesh;
}

/// OBJ, PLY and OFF keep polygons, STL and glTF get triangles, of which a note tells.
static void test_polygons(void **state)
{
    (void)state;
    static const char prism[] = PRISM;
    bat_mesh mesh = read_polygons(prism, sizeof prism - 1, BAT_MESH_FORMAT_OBJ);
    bat_mesh_write_options options = bat_mesh_write_defaults();
    for (bat_mesh_format format = BAT_MESH_FORMAT_OBJ; format <= BAT_MESH_FORMAT_GLB; format++)
        for (int normals = 0; normals < 2; normals++)
        {
            bool keeps = format == BAT_MESH_FORMAT_OBJ || format == BAT_MESH_FORMAT_PLY || format == BAT_MESH_FORMAT_OFF;
            bat_mesh_notes notes = {0};
            char *bytes;
            size_t size;
            options.format = format;
            options.notes = &notes;
            options.normals = normals == 1 ? BAT_MESH_NORMALS_ANGLE : BAT_MESH_NORMALS_NONE;
            assert_int_equal(bat_mesh_write_memory(&mesh, &options, &bytes, &size, NULL), BAT_OK);
            bool told = false;
            for (size_t i = 0; i < notes.count; i++)
                told = told || strstr(notes.texts[i], "does not hold polygons") != NULL;
            assert_int_equal(told, !keeps);
            bat_mesh_notes_free(&notes);
            bat_mesh back = read_polygons(bytes, size, format);
            assert_int_equal(back.vertex_count, mesh.vertex_count);
            assert_int_equal(back.face_count, keeps ? 11 : 18);
            assert_int_equal(back.offsets != NULL, keeps);
            if (keeps)
                assert_memory_equal(back.offsets, mesh.offsets, 12 * sizeof *mesh.offsets);
            if (keeps)
                assert_memory_equal(back.faces, mesh.faces, 40 * sizeof *mesh.faces);
            if (format != BAT_MESH_FORMAT_OFF && format != BAT_MESH_FORMAT_STL)
            {
                assert_int_equal(back.label_count, 2);
                assert_string_equal(back.labels[back.face_labels[0]].group, "wall");
                assert_string_equal(back.labels[back.face_labels[back.face_count - 1]].group, "roof");
                assert_non_null(back.texture_faces);
            }
            bat_mesh_free(&back);
            free(bytes);
        }
    bat_mesh_free(&mesh);
}

/// Polygons with faults are refused, and so is a repair of them.
static void test_bad_polygons(void **state)
{
    (void)state;
    static const struct
    {
        const char *text, *says;
        bool repair;
    } cases[] = {{"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "corners", false},
                 {"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 2\n", "twice", false},
                 {"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n", "; triangulate cuts", true}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_mesh_read_options options = bat_mesh_read_defaults();
        bat_mesh mesh = {0};
        bat_error error = {0};
        options.format = BAT_MESH_FORMAT_OBJ;
        options.polygons = options.strict = true;
        options.repair = cases[i].repair;
        assert_int_not_equal(bat_mesh_read_memory(cases[i].text, strlen(cases[i].text), &options, &mesh, &error), BAT_OK);
        if (strstr(error_words(&error), cases[i].says) == NULL)
            fail_msg("%s", error_words(&error));
        assert_null(mesh.faces);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_formats_by_name_and_ending),
                                       cmocka_unit_test(test_files_are_recognized),
                                       cmocka_unit_test(test_options_are_checked),
                                       cmocka_unit_test(test_reading_can_repair),
                                       cmocka_unit_test(test_files),
                                       cmocka_unit_test(test_locales),
                                       cmocka_unit_test(test_real_meshes),
                                       cmocka_unit_test(test_polygons),
                                       cmocka_unit_test(test_harmless_repairs),
                                       cmocka_unit_test(test_positions_that_are_not_finite),
                                       cmocka_unit_test(test_bad_polygons)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
