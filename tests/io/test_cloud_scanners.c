// Clouds in the files of scanners: PCD and LAS.
#include "cloud_helpers.h"

#include <unistd.h>

/// Bytes of a file.
typedef struct bytes
{
    unsigned char data[4096];
    size_t size;
} bytes;

static void put(bytes *file, const void *data, size_t size)
{
    assert_true(file->size + size <= sizeof file->data);
    memcpy(file->data + file->size, data, size);
    file->size += size;
}

static void put_text(bytes *file, const char *text)
{
    put(file, text, strlen(text));
}

/// Write a number of `size` bytes in little-endian order at a place.
static void set_whole(bytes *file, size_t at, size_t size, uint64_t value)
{
    for (size_t k = 0; k < size; k++)
        file->data[at + k] = (unsigned char)(value >> 8 * k);
}

static void put_whole(bytes *file, size_t size, uint64_t value)
{
    file->size += size;
    set_whole(file, file->size - size, size, value);
}

static void put_float(bytes *file, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_whole(file, sizeof bits, bits);
}

static void set_double(bytes *file, size_t at, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    set_whole(file, at, sizeof bits, bits);
}

static bat_status read_with(const bytes *file, const char *ending, const bat_cloud_read_options *options, bat_cloud *cloud,
                            bat_error *error)
{
    char path[128];
    (void)snprintf(path, sizeof path, "/tmp/batten-scanner-%ld%s", (long)getpid(), ending);
    FILE *stream = fopen(path, "wb");
    assert_non_null(stream);
    assert_int_equal(fwrite(file->data, 1, file->size, stream), file->size);
    assert_int_equal(fclose(stream), 0);
    bat_status status = bat_cloud_read(path, options, cloud, error);
    (void)remove(path);
    return status;
}

static bat_status read_bytes(const bytes *file, const char *ending, bat_cloud *cloud, bat_error *error)
{
    return read_with(file, ending, NULL, cloud, error);
}

static void assert_read(const bytes *file, const char *ending, size_t count, const double *points)
{
    bat_cloud cloud = {0};
    bat_error error = {0};
    if (read_bytes(file, ending, &cloud, &error) != BAT_OK)
        fail_msg("%s", error.text);
    assert_int_equal(cloud.count, count);
    assert_memory_equal(cloud.points, points, 3 * count * sizeof *points);
    bat_cloud_free(&cloud);
}

static void assert_refused(const bytes *file, const char *ending, bat_status expected, const char *words)
{
    bat_cloud cloud = {0};
    bat_error error = {0};
    assert_int_equal(read_bytes(file, ending, &cloud, &error), expected);
    if (strstr(error.text, words) == NULL)
        fail_msg("\"%s\" instead of \"%s\"", error.text, words);
    assert_null(cloud.points);
}

static void put_pcd_header(bytes *file, const char *fields, size_t count, const char *data)
{
    char text[512];
    (void)snprintf(text, sizeof text,
                   "# .PCD v.7 - Point Cloud Data file format\nVERSION .7\n%sWIDTH %zu\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
                   "POINTS %zu\nDATA %s\n",
                   fields, count, count, data);
    put_text(file, text);
}

#define XYZ "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
#define MIXED "FIELDS normal z rgb x y\nSIZE 4 8 4 4 4\nTYPE F F U F F\nCOUNT 3 1 1 1 1\n"

static const double FOUR[] = {0.5, -1, 7, 2000, 3, 7, -0.25, (float)1e-3, 7, 4, 5, 7};

static void pcd_as_text(void **state)
{
    (void)state;
    bytes file = {0};
    put_pcd_header(&file, "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n", 3, "ascii");
    put_text(&file, "0.5 -1 2 4278190080\nnan nan nan 0\n1 2 3 0\n");
    static const double points[] = {0.5, -1, 2, 1, 2, 3};
    assert_read(&file, ".pcd", 2, points);
    assert_read(&file, ".", 2, points); // by the content
    put_text(&file, "9 9 9 9\n");       // more than POINTS is ignored
    assert_read(&file, ".pcd", 2, points);
}

static void pcd_as_records(void **state)
{
    (void)state;
    bytes file = {0};
    put_pcd_header(&file, MIXED, 2, "binary");
    for (int i = 0; i < 2; i++)
    {
        for (int k = 0; k < 3; k++)
            put_float(&file, 9);
        set_double(&file, file.size, 0.1 + i);
        file.size += 8;
        put_whole(&file, 4, 0xFFFFFF);
        put_float(&file, (float)i);
        put_float(&file, -2.5F);
    }
    static const double points[] = {0, -2.5, 0.1, 1, -2.5, 1.1};
    assert_read(&file, ".pcd", 2, points);
    file.size--;
    assert_refused(&file, ".pcd", BAT_BAD_FILE, "ends after 1 of 2");
}

/// Compressed data: literal bytes, and one copy that overlaps itself.
static void pcd_compressed(void **state)
{
    (void)state;
    bytes plain = {0}, packed = {0}, file = {0};
    for (size_t d = 0; d < 2; d++)
        for (size_t i = 0; i < 4; i++)
            put_float(&plain, (float)FOUR[3 * i + d]);
    put_whole(&packed, 1, 31);
    put(&packed, plain.data, 32);
    put_whole(&packed, 1, 3);
    put_float(&packed, 7);
    put_whole(&packed, 1, 7 << 5); // 12 bytes from 4 bytes before
    put_whole(&packed, 1, 12 - 2 - 7);
    put_whole(&packed, 1, 3);
    put_pcd_header(&file, XYZ, 4, "binary_compressed");
    size_t sizes = file.size;
    put_whole(&file, 4, packed.size);
    put_whole(&file, 4, 48);
    put(&file, packed.data, packed.size);
    assert_read(&file, ".pcd", 4, FOUR);
    bytes broken = file;
    set_whole(&broken, broken.size - 1, 1, 200); // from before the beginning
    assert_refused(&broken, ".pcd", BAT_BAD_FILE, "damaged");
    broken = file;
    set_whole(&broken, sizes + 4, 4, 52);
    assert_refused(&broken, ".pcd", BAT_BAD_FILE, "not that of 4 points");
    broken = file;
    set_whole(&broken, sizes, 4, packed.size - 1);
    assert_refused(&broken, ".pcd", BAT_BAD_FILE, "damaged");
}

static void bad_pcd_is_refused(void **state)
{
    (void)state;
    static const struct
    {
        const char *fields, *data, *content;
        bat_status status;
        const char *words;
    } files[] = {
        {"FIELDS x y\nSIZE 4 4\nTYPE F F\n", "ascii", "1 2\n", BAT_BAD_FILE, "x, y and z"},
        {"FIELDS x y z\nSIZE 4 4\nTYPE F F F\n", "ascii", "1 2 3\n", BAT_BAD_FILE, "one entry for each"},
        {"FIELDS x y z\nSIZE 4 4 2\nTYPE F F F\n", "ascii", "1 2 3\n", BAT_UNSUPPORTED, "4 or 8 bytes"},
        {"FIELDS x y z\nSIZE 4 4 4\nTYPE F F I\n", "ascii", "1 2 3\n", BAT_UNSUPPORTED, "4 or 8 bytes"},
        {XYZ, "ascii", "1 2 3\n", BAT_BAD_FILE, "after 1 of 2"},
        {XYZ, "ascii", "1 2 3\n1 x 3\n", BAT_BAD_FILE, "'x' is not a number"},
        {XYZ, "zipped", "", BAT_BAD_FILE, "none of ascii"},
        {XYZ, "binary", "0123456789", BAT_BAD_FILE, "after 0 of 2"},
        {XYZ, "binary_compressed", "0123", BAT_BAD_FILE, "not that of 2 points"},
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
    {
        bytes file = {0};
        put_pcd_header(&file, files[i].fields, 2, files[i].data);
        put_text(&file, files[i].content);
        assert_refused(&file, ".pcd", files[i].status, files[i].words);
    }
    bytes file = {0};
    put_text(&file, "VERSION .7\n" XYZ);
    assert_refused(&file, ".pcd", BAT_BAD_FILE, "no line DATA");
}

/// A LAS file of three points; the second is withheld.
static bytes las_file(int minor, size_t format, size_t record)
{
    bytes file = {0};
    size_t header = minor == 4 ? 375 : 227;
    put_text(&file, "LASF");
    file.size = header + 5; // as if there were variable records
    set_whole(&file, 24, 1, 1);
    set_whole(&file, 25, 1, (uint64_t)minor);
    set_whole(&file, 94, 2, header);
    set_whole(&file, 96, 4, file.size);
    set_whole(&file, 104, 1, format);
    set_whole(&file, 105, 2, record);
    set_whole(&file, minor == 4 ? 247 : 107, minor == 4 ? 8 : 4, 3);
    for (size_t d = 0; d < 3; d++)
    {
        set_double(&file, 131 + 8 * d, 0.25);
        set_double(&file, 155 + 8 * d, 100 * (double)d);
    }
    for (int i = 0; i < 3; i++)
    {
        size_t at = file.size;
        for (int d = 0; d < 3; d++)
            set_whole(&file, at + 4 * (size_t)d, 4, (uint64_t)(int64_t)(10 * i - d));
        set_whole(&file, at + 15, 1, i != 1 ? 0x03 : format < 6 ? 0x80 : 0x04);
        file.size += record;
    }
    return file;
}

static void las_of_all_formats(void **state)
{
    (void)state;
    static const size_t records[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
    static const double points[] = {0, 99.75, 199.5, 5, 104.75, 204.5};
    for (size_t format = 0; format < sizeof records / sizeof *records; format++)
    {
        bytes file = las_file(format < 6 ? 2 : 4, format, records[format] + format % 2);
        assert_read(&file, ".las", 2, points);
        assert_read(&file, ".", 2, points); // by the content
    }
}

static void las_has_classes(void **state)
{
    (void)state;
    static const uint64_t classes[] = {3, 7, 2};
    static const struct
    {
        const char *classes;
        size_t count;
        const char *note;
    } cases[] = {
        {NULL, 2, "1 points of the classes 7 and 18"}, {"2", 1, "2 points of other classes"}, {"7,3", 2, "1 points"}};
    for (size_t i = 0; i < 2 * (sizeof cases / sizeof *cases); i++)
    {
        bytes file = las_file(i % 2 == 0 ? 2 : 4, i % 2 == 0 ? 0 : 6, 30);
        for (size_t k = 0; k < 3; k++)
        {
            set_whole(&file, file.size - 30 * (3 - k) + 15, 1, i % 2 == 0 ? classes[k] : 0);
            set_whole(&file, file.size - 30 * (3 - k) + 16, 1, i % 2 == 0 ? 0 : classes[k]);
        }
        bat_mesh_notes notes = {0};
        const bat_cloud_read_options options = {.classes = cases[i / 2].classes, .notes = &notes};
        bat_cloud cloud = {0};
        check_status(read_with(&file, ".las", &options, &cloud, NULL), BAT_OK);
        assert_int_equal(cloud.count, cases[i / 2].count);
        assert_int_equal(notes.count, 1);
        assert_non_null(strstr(notes.texts[0], cases[i / 2].note));
        bat_mesh_notes_free(&notes);
        bat_cloud_free(&cloud);
        const bat_cloud_read_options none = {.classes = "40"};
        bat_error error;
        check_status(read_with(&file, ".las", &none, &cloud, &error), BAT_BAD_FILE);
        assert_non_null(strstr(error.text, "none of the 3 points"));
    }
}

static void bad_las_is_refused(void **state)
{
    (void)state;
    bytes file = las_file(2, 0, 20);
    file.size--;
    assert_refused(&file, ".las", BAT_BAD_FILE, "after 2 of 3");
    file = las_file(2, 0, 20);
    file.size = 200;
    assert_refused(&file, ".las", BAT_BAD_FILE, "header of LASF");
    file = las_file(2, 0, 19);
    assert_refused(&file, ".las", BAT_BAD_FILE, "shorter than their format");
    file = las_file(2, 0, 20);
    file.data[0] = 'l';
    assert_refused(&file, ".las", BAT_BAD_FILE, "header of LASF");
    file = las_file(2, 0x80, 20);
    assert_refused(&file, ".las", BAT_UNSUPPORTED, "LAZ");
    file = las_file(5, 0, 20);
    assert_refused(&file, ".las", BAT_UNSUPPORTED, "version 1.5");
    file = las_file(2, 11, 90);
    assert_refused(&file, ".las", BAT_UNSUPPORTED, "point format 11");
    file = las_file(2, 0, 20);
    set_double(&file, 139, 0);
    assert_refused(&file, ".las", BAT_BAD_FILE, "zero or not finite");
    file = las_file(2, 0, 20);
    set_whole(&file, 96, 4, 100000);
    assert_refused(&file, ".las", BAT_BAD_FILE, "after 0 of 3");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pcd_as_text),        cmocka_unit_test(pcd_as_records),     cmocka_unit_test(pcd_compressed),
        cmocka_unit_test(bad_pcd_is_refused), cmocka_unit_test(las_of_all_formats), cmocka_unit_test(bad_las_is_refused),
        cmocka_unit_test(las_has_classes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
