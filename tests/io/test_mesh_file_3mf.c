// 3MF: objects, components, transforms, units, materials, round trips, and packages with faults (BAT_MESH_FORMAT_3MF).
#include "mesh_file_helpers.h"

#include "io/common/zip.h"

static const bat_mesh_format FORMAT = BAT_MESH_FORMAT_3MF;

#define MODEL(attributes, resources, build)                                                                                 \
    "<model xmlns='http://schemas.microsoft.com/3dmanufacturing/core/2015/02' xmlns:m='urn:m' " attributes                  \
    ">\n<resources>\n" resources "\n</resources>\n<build>" build "</build></model>"
#define TRIANGLE(rest)                                                                                                      \
    "<mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/><vertex x='0' y='1' z='0'/></vertices>"          \
    "<triangles><triangle v1='0' v2='1' v3='2' " rest "/></triangles></mesh>"
#define OBJECT(id, attributes, content) "<object id='" id "' " attributes ">" content "</object>\n"
#define COMPONENT(id) OBJECT(id, "", "<components><component objectid='1'/></components>")

/// A package with a model.
static text_buffer package(const char *relations, const char *model)
{
    text_buffer bytes = {0}, part = {0};
    text_sink sink = {.buffer = &bytes};
    zip_writer writer = {.sink = &sink};
    const char *const parts[][2] = {{"_rels/.rels", relations}, {"3D/a.model", model}};
    for (size_t i = 0; i < 2; i++)
        if (parts[i][1] != NULL)
        {
            text_append_string(&part, parts[i][1]);
            assert_int_equal(zip_add(&writer, parts[i][0], &part, NULL), BAT_OK);
            text_free(&part);
        }
    assert_int_equal(zip_end(&writer, BAT_OK, NULL), BAT_OK);
    return bytes;
}

static const char RELATIONS[] =
    "<Relationships xmlns='http://schemas.openxmlformats.org/package/2006/relationships'><Relationship Id='a' "
    "Target='/3D/A.model' Type='http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel'/></Relationships>";

static bat_mesh read_model(const char *model, bat_mesh_notes *notes)
{
    text_buffer bytes = package(RELATIONS, model);
    bat_mesh_read_options options = bat_mesh_read_defaults(); // by the content
    options.notes = notes;
    bat_mesh mesh = must_read_bytes(bytes.data, bytes.size, &options);
    text_free(&bytes);
    return mesh;
}

static void refuse(const char *model, bat_status status, size_t line, const char *words)
{
    text_buffer bytes = package(RELATIONS, model);
    bat_mesh_read_options options = reading_as(FORMAT);
    assert_refused(bytes.data, bytes.size, &options, status, line, words);
    text_free(&bytes);
}

/// A component of a component, in inches: transforms apply from the inside out.
static void test_components(void **state)
{
    (void)state;
    bat_mesh_notes notes = {0};
    bat_mesh mesh = read_model(
        MODEL("unit='inch'",
              OBJECT("1", "name='tri'", TRIANGLE(""))
                  OBJECT("2", "", "<components><component objectid='1' transform='2 0 0 0 2 0 0 0 2 0 0 1'/></components>")
                      OBJECT("9", "", TRIANGLE("")),
              "<item objectid='2' transform='0 1 0 -1 0 0 0 0 1 5 0 0'/><item objectid='1' transform='1 0 0 0 1 0 0 0 -1 0 "
              "0 0'/>"),
        &notes);
    static const double inches[] = {5, 0, 1, 5, 2, 1, 3, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const uint32_t faces[] = {0, 1, 2, 5, 4, 3}; // a mirror turns faces over
    assert_int_equal(mesh.vertex_count, 6);
    for (size_t i = 0; i < 18; i++)
        check_near(mesh.positions[i], 25.4 * inches[i], 1e-14);
    assert_memory_equal(mesh.faces, faces, sizeof faces);
    assert_string_equal(mesh.labels[mesh.face_labels[1]].object, "tri");
    assert_int_equal(notes.count, 2);
    assert_non_null(strstr(notes.texts[0], "the unit of the file is the inch"));
    assert_non_null(strstr(notes.texts[1], "1 objects that the build does not place"));
    bat_mesh_notes_free(&notes);
    bat_mesh_free(&mesh);
}

/// Materials become those of glTF; equal names get numbers; their colours come back to the byte.
static void test_materials(void **state)
{
    (void)state;
    static const char group[] = "<basematerials id='7'><base name='a' displaycolor='#0080ffC0'/>"
                                "<base name='a' displaycolor='#123456'/></basematerials><m:colors id='8'/>";
    char model[4000];
    (void)snprintf(model, sizeof model,
                   MODEL("",
                         "%s" OBJECT("1", "pid='7' pindex='1'", TRIANGLE("")) OBJECT("2", "", TRIANGLE("pid='7' p1='0'"))
                             OBJECT("3", "", TRIANGLE("pid='8' p1='0'")),
                         "<item objectid='1'/><item objectid='2'/><item objectid='3'/>"),
                   group);
    bat_mesh_notes notes = {0};
    bat_mesh mesh = read_model(model, &notes);
    assert_string_equal(mesh.labels[mesh.face_labels[0]].material, "a_1");
    assert_string_equal(mesh.labels[mesh.face_labels[1]].material, "a");
    assert_null(mesh.labels[mesh.face_labels[2]].material);
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.texts[0], "the properties of 1 faces are left out"));
    size_t size;
    char *bytes = must_write(&mesh, FORMAT, BAT_MESH_ENCODING_BINARY, &size);
    bat_mesh_read_options options = reading_as(FORMAT);
    bat_mesh back = must_read_bytes(bytes, size, &options);
    assert_non_null(strstr(mesh.material_json, "baseColorFactor"));
    bat_mesh again = through_file(&back, FORMAT, BAT_MESH_ENCODING_BINARY);
    assert_string_equal(again.material_json, back.material_json);
    assert_string_equal(back.labels[back.face_labels[0]].material, "a_1");
    free(bytes);
    bat_mesh_notes_free(&notes);
    bat_mesh_free(&mesh);
    bat_mesh_free(&back);
    bat_mesh_free(&again);
}

/// Coordinates keep their digits; objects come back where they share no vertices.
static void test_round_trip(void **state)
{
    (void)state;
    bat_mesh mesh = random_mesh(3, 50, 90, NULL);
    bat_mesh back = through_file(&mesh, FORMAT, BAT_MESH_ENCODING_BINARY);
    assert_same_shape(&mesh, &back);
    bat_mesh_free(&mesh);
    bat_mesh_free(&back);
    mesh = must_read("v 9 9 9\no b & <\"c\"\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 2 0 0\nv 0 3 0\nf 2 3 4\no d\nf 5 6 7\n",
                     BAT_MESH_FORMAT_OBJ);
    back = through_file(&mesh, FORMAT, BAT_MESH_ENCODING_BINARY);
    assert_int_equal(back.vertex_count, 7);
    assert_string_equal(back.labels[back.face_labels[0]].object, "b & <\"c\"");
    assert_string_equal(back.labels[back.face_labels[1]].object, "d");
    bat_mesh_free(&back);
    mesh.faces[3] = mesh.faces[0];
    back = through_file(&mesh, FORMAT, BAT_MESH_ENCODING_BINARY);
    assert_null(back.face_labels);
    assert_same_shape(&mesh, &back);
    bat_mesh_free(&mesh);
    bat_mesh_free(&back);
}

static void test_bad_models(void **state)
{
    (void)state;
#define ONE OBJECT("1", "", TRIANGLE(""))
#define ITEM "<item objectid='1'/>"
    static const struct
    {
        const char *model;
        bat_status status;
        size_t line;
        const char *words;
    } cases[] = {
        {"<a/>", BAT_BAD_FILE, 1, "the root element is no 'model' of 3MF"},
        {MODEL("", ONE, ""), BAT_BAD_FILE, 0, "the build places no object"},
        {MODEL("unit='mile'", ONE, ITEM), BAT_BAD_FILE, 1, "there is no unit 'mile'"},
        {MODEL("requiredextensions='p b'", ONE, ITEM), BAT_UNSUPPORTED, 1, "requires extensions, which are not read: 'p b'"},
        {MODEL("", ONE, "<item objectid='2'/>"), BAT_BAD_FILE, 6, "the object 2 is placed, but is not defined before"},
        {MODEL("", ONE ONE, ITEM), BAT_BAD_FILE, 4, "the resource 1 is there twice"},
        {MODEL("", COMPONENT("1"), ITEM), BAT_BAD_FILE, 3, "the object 1 is placed, but is not defined before"},
        {MODEL("", COMPONENT("2") ONE, ITEM), BAT_BAD_FILE, 3, "the object 1 is placed, but is not defined before"},
        {MODEL("", OBJECT("1", "", TRIANGLE("v1='3'")), ITEM), BAT_BAD_FILE, 3, "XML: duplicate attribute"},
        {MODEL("", OBJECT("1", "", "<mesh><triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh>"), ITEM),
         BAT_BAD_FILE, 3, "the attribute 'v1' is '0', but must be a whole number below 0"},
        {MODEL("", OBJECT("1", "", "<mesh><vertices><vertex x='0' y='1e999' z='0'/></vertices></mesh>"), ITEM), BAT_BAD_FILE,
         3, "the attribute 'y' has number 1 of 1 '1e999'"},
        {MODEL("", OBJECT("1", "", "<mesh><vertices><vertex x='0' y='0'/></vertices></mesh>"), ITEM), BAT_BAD_FILE, 3,
         "the attribute 'z' has number 1 of 1 '': missing"},
        {MODEL("", ONE, "<item objectid='1' transform='1 0 0'/>"), BAT_BAD_FILE, 6, "'transform' has number 4 of 12"},
        {MODEL("", ONE, "<item objectid='1' transform='1 0 0 0 1 0 0 0 1 0 0 0 7'/>"), BAT_BAD_FILE, 6, "more than 12"},
        {MODEL("", ONE,
               "<item objectid='1' transform='1 0 0 0 1 0 0 0 1 1e308 0 0'/>"
               "<item objectid='1' transform='1e308 0 0 0 1 0 0 0 1 1e308 0 0'/>"),
         BAT_BAD_FILE, 0, "is not finite where it is placed"},
        {MODEL("", OBJECT("1", "pid='5'", TRIANGLE("")), ITEM), BAT_BAD_FILE, 3, "the resource 5, which is not defined"},
        {MODEL("", "<basematerials id='5'/>" OBJECT("1", "pid='5'", TRIANGLE("")), ITEM), BAT_BAD_FILE, 3,
         "the material 0 of the 0 of resource 5"},
        {MODEL("", "<basematerials id='5'><base name='a' displaycolor='red'/></basematerials>", ITEM), BAT_BAD_FILE, 3,
         "the display colour 'red' of a material"},
        {"<!DOCTYPE a [<!ENTITY b 'c'>]>" MODEL("", ONE, ITEM), BAT_BAD_FILE, 1, "a document type is not allowed"},
        {"<model", BAT_BAD_FILE, 1, "XML: "},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        refuse(cases[i].model, cases[i].status, cases[i].line, cases[i].words);
}

/// Components of components: many copies of few vertices, and a deep nest.
static void test_copies(void **state)
{
    (void)state;
    text_buffer model = {0};
    text_append_string(&model, "<model xmlns='http://schemas.microsoft.com/3dmanufacturing/core/2015/02'><resources>");
    text_append_string(&model, OBJECT("1", "", TRIANGLE("")));
    for (int i = 2; i < 70; i++)
    {
        char object[200];
        (void)snprintf(
            object, sizeof object,
            "<object id='%d'><components><component objectid='%d'/><component objectid='%d'/></components></object>", i,
            i - 1, i - 1);
        text_append_string(&model, object);
        if (i == 39)
        {
            text_buffer wide = {0};
            text_append(&wide, model.data, model.size);
            text_append(&wide, "</resources><build><item objectid='39'/></build></model>", 57);
            refuse(wide.data, BAT_TOO_LARGE, 0, "more than 1000 copies");
            text_free(&wide);
        }
    }
    text_append(&model, "</resources></model>", 21);
    refuse(model.data, BAT_TOO_LARGE, 2, "nested deeper than 64");
    text_free(&model);
}

static void test_bad_packages(void **state)
{
    (void)state;
    bat_mesh_read_options options = reading_as(FORMAT);
    static const char good[] = MODEL("", OBJECT("1", "", TRIANGLE("")), ITEM);
    text_buffer bytes = package(RELATIONS, good);
    assert_truncations_fail(bytes.data, bytes.size, 0, FORMAT);
    const struct
    {
        size_t behind_end, byte;
        const char *words;
    } faults[] = {
        {22, 0, "has no end: the file is cut off"},
        {22 - 16, 0xff, "a directory that lies outside the file"},
        {22 - 10, 0xff, "a directory that lies outside the file"},
    };
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
    {
        memset(bytes.data + bytes.size - faults[i].behind_end, (int)faults[i].byte, 2);
        assert_refused(bytes.data, bytes.size, &options, BAT_BAD_FILE, 0, faults[i].words);
        text_free(&bytes);
        bytes = package(RELATIONS, good);
    }
    // The directory's entry of the second part: flags, method, checksum, stored size, size, offset.
    size_t entry = bytes.size - 22 - 46 - strlen("3D/a.model");
    const struct
    {
        size_t at;
        bat_status status;
        const char *words;
    } entries[] = {
        {8, BAT_UNSUPPORTED, "the part '3D/a.model' of the ZIP archive is encrypted"},
        {10, BAT_UNSUPPORTED, "compressed by another method than DEFLATE"},
        {16, BAT_BAD_FILE, "is damaged: its checksum differs"},
        {22, BAT_BAD_FILE, "has another name or size than in the ZIP archive's directory"},
        {24, BAT_BAD_FILE, "than its directory says"},
        {27, BAT_TOO_LARGE, "would inflate to more than 200 times its size"},
        {42, BAT_BAD_FILE, "is not where the ZIP archive's directory says"},
    };
    for (size_t i = 0; i < sizeof entries / sizeof *entries; i++)
    {
        bytes.data[entry + entries[i].at] ^= 1;
        assert_refused(bytes.data, bytes.size, &options, entries[i].status, 0, entries[i].words);
        bytes.data[entry + entries[i].at] ^= 1;
    }
    text_free(&bytes);
    const struct
    {
        const char *relations, *model, *words;
    } packages[] = {
        {NULL, good, "the package lacks the part '_rels/.rels'"},
        {"<Relationships/>", good, "the package has no 3D model"},
        {RELATIONS, NULL, "the package lacks the part '3D/A.model'"},
    };
    for (size_t i = 0; i < sizeof packages / sizeof *packages; i++)
    {
        bytes = package(packages[i].relations, packages[i].model);
        assert_refused(bytes.data, bytes.size, &options, BAT_BAD_FILE, 0, packages[i].words);
        text_free(&bytes);
    }
    assert_bad("solid", FORMAT, 0, "the file is no ZIP archive");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_components), cmocka_unit_test(test_materials), cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_bad_models), cmocka_unit_test(test_copies),    cmocka_unit_test(test_bad_packages),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
