// Images of materials that are read, and colours of vertices beside baked ones.
#include "check.h"

#include "batten/mesh_picture.h"

#include <stdlib.h>
#include <string.h>

#define PNG "data:image/png;base64,"

static void check_pixels(const char *uri, const unsigned char *wanted, size_t count)
{
    bat_mesh_image image;
    bat_error error;
    if (bat_mesh_image_read(uri, NULL, &image, &error) != BAT_OK)
        fail_msg("%s", error.text);
    assert_int_equal(image.width * image.height, count);
    assert_memory_equal(image.pixels, wanted, 3 * count);
    free(image.pixels);
}

/// PNG with three channels, and with a palette, needs no GDAL.
static void test_png(void **state)
{
    (void)state;
    static const unsigned char pixels[] = {255, 0, 0, 0, 200, 10};
    check_pixels(PNG "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAAD0lEQVR42mP4z8DAcIILAAebAdJGrFHbAAAAAElFTkSuQmCC",
                 pixels, 2);
    check_pixels(PNG "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABAQMAAADO7O3JAAAABlBMVEUAyAr/"
                     "AACtJ85cAAAACklEQVR42mNoAAAAggCB2kUIOwAAAABJRU5ErkJggg==",
                 pixels, 2);
}

/// Of a transparent pixel GDAL tells the colour.
static void test_transparent(void **state)
{
    (void)state;
    static const unsigned char pixels[] = {255, 0, 0, 0, 200 * BATTEN_HAS_GDAL, 10 * BATTEN_HAS_GDAL};
    check_pixels(PNG "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAEUlEQVR42mP4z8Dwn+EEFwMAD2gC0Rn+4aoAAAAASUVORK5CYII=",
                 pixels, 2);
}

#define JPEG                                                                                                                \
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAMCAgMCAgMDAwMEAwMEBQgFBQQEBQoHBwYIDAoMDAsKCwsNDhIQDQ4RDgsLEBYQERMUFRUVDA8XGBYU"      \
    "GBIUFRT/2wBDAQMEBAUEBQkFBQkUDQsNFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBT/wAARCAAIAAgD"      \
    "ASIAAhEBAxEB/8QAFQABAQAAAAAAAAAAAAAAAAAAAAT/xAAUEAEAAAAAAAAAAAAAAAAAAAAA/8QAFQEBAQAAAAAAAAAAAAAAAAAABwj/xAAUEQEA"      \
    "AAAAAAAAAAAAAAAAAAAA/9oADAMBAAIRAxEAPwCQAHqQf//Z"

/// JPEG is decoded by GDAL, else refused with what helps.
static void test_jpeg(void **state)
{
    (void)state;
    bat_mesh_image image;
    bat_error error;
    bat_status status = bat_mesh_image_read("data:image/jpeg;base64," JPEG, NULL, &image, &error);
    assert_int_equal(status, BATTEN_HAS_GDAL ? BAT_OK : BAT_UNSUPPORTED);
    if (status == BAT_OK)
    {
        assert_int_equal(image.width, 8);
        assert_true(abs(image.pixels[3] - 200) < 4 && abs(image.pixels[4] - 100) < 4 && abs(image.pixels[5] - 50) < 4);
        free(image.pixels);
    }
    else
        assert_non_null(strstr(error.text, "GDAL"));
}

/// What is no image, and files out of the folder, are refused in one line.
static void test_refused(void **state)
{
    (void)state;
    bat_mesh_image image;
    bat_error error;
    assert_true(bat_mesh_image_read(PNG "AAAA", NULL, &image, &error) != BAT_OK);
    assert_non_null(strstr(error.text, "; save it as PNG"));
    assert_int_equal(bat_mesh_image_read(PNG "?", NULL, &image, NULL), BAT_BAD_FILE);
    assert_int_equal(bat_mesh_image_read(PNG "iVBORw0KGgoAAAANSUhEUgABhqAAAYagCAIAAAAAAA==", NULL, &image, &error),
                     BAT_TOO_LARGE); // 100,000 squared
    assert_int_equal(bat_mesh_image_read("../image.png", "mesh.obj", &image, NULL), BAT_BAD_FILE);
    assert_int_equal(bat_mesh_image_read("image.png", NULL, &image, NULL), BAT_BAD_FILE);
    assert_int_equal(bat_mesh_image_read("no/such.png", "mesh.obj", &image, &error), BAT_FILE_ACCESS);
    assert_non_null(strstr(error.text, "its file 'no/such.png'"));
}

/// Baked colours take the place of the vertices' colours; other values stay.
static void test_attach(void **state)
{
    (void)state;
    static const char *const names[] = {"blue", "height", "red", "alpha", "green"};
    bat_mesh mesh = {.vertex_count = 3, .face_count = 1, .channel_count = 5};
    unsigned char pixel[3] = {1, 2, 3};
    const bat_mesh_baked baked = {.colour = {pixel, 1, 1}};
    mesh.positions = calloc(9, sizeof *mesh.positions);
    mesh.faces = calloc(3, sizeof *mesh.faces);
    mesh.channels = calloc(15, sizeof *mesh.channels);
    mesh.channel_names = calloc(5, sizeof *mesh.channel_names);
    for (size_t i = 0; i < 5; i++)
        mesh.channel_names[i] = strdup(names[i]);
    for (size_t i = 0; i < 15; i++)
        mesh.channels[i] = (double)i;
    assert_int_equal(bat_mesh_baked_attach(&baked, &mesh, NULL), BAT_OK);
    assert_int_equal(mesh.channel_count, 1);
    assert_string_equal(mesh.channel_names[0], "height");
    for (size_t v = 0; v < 3; v++)
        assert_true(mesh.channels[v] == (double)(5 * v + 1));
    assert_non_null(strstr(mesh.material_json, "baseColorTexture"));
    bat_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_png),     cmocka_unit_test(test_transparent), cmocka_unit_test(test_jpeg),
        cmocka_unit_test(test_refused), cmocka_unit_test(test_attach),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
