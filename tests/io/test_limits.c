// Limits for files of strangers: what compression and copies may make of a file, and how long it may be.

#include "batten/cloud_file.h"
#include "batten/curve_file.h"
#include "batten/mesh_file.h"
#include "check.h"
#include "folder_helpers.h"

/// Three instances of a triangle.
static const char TRIANGLES[] =
    "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,"
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],"
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
    "\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]}],\"meshes\":[{\"primitives\":[{\"attributes\":{"
    "\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"translation\":[0,0,1]},{\"mesh\":0,\"translation\":[0,0,2]}"
    "],\"scenes\":[{\"nodes\":[0,1,2]}],\"scene\":0}";

static void instances_are_counted(void **state)
{
    (void)state;
    bat_mesh_read_options options = bat_mesh_read_defaults();
    bat_mesh mesh;
    bat_error error;
    options.limits.points = 8;
    check_status(bat_mesh_read_memory(TRIANGLES, sizeof TRIANGLES - 1, &options, &mesh, &error), BAT_TOO_LARGE);
    assert_string_equal(error.remedy, "limits.points");
    options.limits.points = 9;
    check_status(bat_mesh_read_memory(TRIANGLES, sizeof TRIANGLES - 1, &options, &mesh, &error), BAT_OK);
    assert_int_equal(mesh.face_count, 3);
    bat_mesh_free(&mesh);
}

/// 2,000 instances of 999 vertices are more than the default allows for so short a file.
static void instances_have_a_default(void **state)
{
    (void)state;
    enum
    {
        INSTANCES = 2000,
        VERTICES = 1000,
        BASE64 = VERTICES * 3 * 4 / 3 * 4, ///< letters that stand for zeros
        SIZE = 60000
    };
    char *text = malloc(SIZE);
    int size = snprintf(text, SIZE,
                        "{\"asset\":{\"version\":\"2.0\"},\"bufferViews\":[{\"buffer\":0,\"byteLength\":12000}],"
                        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":999,\"type\":\"VEC3\"}],"
                        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
                        "\"buffers\":[{\"byteLength\":12000,\"uri\":\"data:application/octet-stream;base64,");
    memset(text + size, 'A', BASE64);
    size += BASE64;
    size += snprintf(text + size, SIZE - (size_t)size, "\"}],\"nodes\":[");
    for (int i = 0; i < INSTANCES; i++)
        size += snprintf(text + size, SIZE - (size_t)size, "%s{\"mesh\":0}", i > 0 ? "," : "");
    size += snprintf(text + size, SIZE - (size_t)size, "],\"scenes\":[{\"nodes\":[");
    for (int i = 0; i < INSTANCES; i++)
        size += snprintf(text + size, SIZE - (size_t)size, "%s%d", i > 0 ? "," : "", i);
    size += snprintf(text + size, SIZE - (size_t)size, "]}]}");
    bat_mesh mesh;
    check_status(bat_mesh_read_memory(text, (size_t)size, NULL, &mesh, NULL), BAT_TOO_LARGE);
    free(text);
}

/// A header of 100 million points before a few compressed bytes.
static void compressed_points_are_counted(void **state)
{
    (void)state;
    bat_cloud cloud;
    bat_error error;
    put("claim.pcd", "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 100000000\nHEIGHT 1\n"
                     "POINTS 100000000\nDATA binary_compressed\nabcdefghijkl");
    check_status(bat_cloud_read("claim.pcd", NULL, &cloud, &error), BAT_TOO_LARGE);
    assert_string_equal(error.remedy, "limits.points");
}

static void long_files_are_refused(void **state)
{
    (void)state;
    static const char TEXT[] = "0,0\n1,0\n1,1\n";
    bat_curve_read_options options = bat_curve_read_defaults();
    bat_curve_set set;
    put("in.csv", TEXT);
    options.limits.bytes = sizeof TEXT - 2;
    check_status(bat_curve_read("in.csv", &options, &set, NULL), BAT_TOO_LARGE);
    check_status(bat_curve_read_memory(TEXT, sizeof TEXT - 1, &options, &set, NULL), BAT_TOO_LARGE);
    options.limits.bytes = sizeof TEXT - 1;
    check_status(bat_curve_read("in.csv", &options, &set, NULL), BAT_OK);
    bat_curve_set_free(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(instances_are_counted),
        cmocka_unit_test(instances_have_a_default),
        cmocka_unit_test_setup_teardown(compressed_points_are_counted, enter_folder, leave_folder),
        cmocka_unit_test_setup_teardown(long_files_are_refused, enter_folder, leave_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
