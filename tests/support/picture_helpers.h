#ifndef TESTS_SUPPORT_PICTURE_HELPERS_H
#define TESTS_SUPPORT_PICTURE_HELPERS_H

// Curves in every space, a folder for pictures, and checks of picture files.

#include "check.h"

#include "batten/curve_picture.h"

#include <dirent.h>
#include <unistd.h>

/// Read by LeakSanitizer: fontconfig keeps its configuration and a few patterns until the program ends.
const char *__lsan_default_suppressions(void); // NOLINT(bugprone-reserved-identifier)
const char *__lsan_default_suppressions(void)  // NOLINT(bugprone-reserved-identifier)
{
    return "leak:libfontconfig";
}

static const double PI = 3.14159265358979323846;

static const char *const endings[] = {"svg", "png", "pdf"};

static bat_space plane;
static bat_space solid;
static bat_space five;
static bat_space sphere;
static bat_space disk;
static char folder[] = "/tmp/batten-picture-XXXXXX";

static inline int set_up(void **state)
{
    (void)state;
    plane = bat_euclidean(2);
    solid = bat_euclidean(3);
    five = bat_euclidean(5);
    sphere = bat_sphere(2);
    disk = bat_disk();
    return mkdtemp(folder) == NULL ? -1 : 0;
}

static inline int tear_down(void **state)
{
    (void)state;
    return rmdir(folder);
}

static inline bat_curve make_curve(const bat_space *space, size_t count, bool closed)
{
    bat_curve curve = {.space = space, .count = count, .closed = closed};
    curve.points = calloc(count * space->point_dim, sizeof(double));
    assert_non_null(curve.points);
    return curve;
}

static inline void set_direction(double *point, double longitude, double latitude)
{
    point[0] = cos(latitude) * cos(longitude);
    point[1] = cos(latitude) * sin(longitude);
    point[2] = sin(latitude);
}

/// A closed wavy curve with `count` points in any space.
static inline bat_curve make_sample(const bat_space *space, size_t count)
{
    bat_curve curve = make_curve(space, count, true);
    for (size_t i = 0; i < count; i++)
    {
        double angle = 2.0 * PI * (double)i / (double)count;
        double radius = 0.6 + 0.2 * cos(3.0 * angle);
        double *point = curve.points + i * space->point_dim;
        if (space == &sphere)
        {
            set_direction(point, angle, radius * sin(2.0 * angle));
            continue;
        }
        point[0] = radius * cos(angle);
        point[1] = radius * sin(angle);
        for (size_t k = 2; k < space->point_dim; k++)
        {
            point[k] = 0.1 * sin((double)k * angle);
        }
    }
    return curve;
}

static inline void path_of(char *path, const char *name)
{
    (void)snprintf(path, 128, "%s/%s", folder, name);
}

/// The bytes of a file, with a zero behind them; released with free().
static inline char *slurp(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    char *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    bytes[*size] = '\0';
    (void)fclose(file);
    return bytes;
}

static inline size_t folder_entries(void)
{
    size_t count = 0;
    DIR *open_folder = opendir(folder);
    assert_non_null(open_folder);
    for (struct dirent *entry = readdir(open_folder); entry != NULL; entry = readdir(open_folder))
    {
        count += entry->d_name[0] != '.' || strlen(entry->d_name) > 2 ? 1 : 0;
    }
    (void)closedir(open_folder);
    return count;
}

/// Whether bytes, which may include zeros, contain a text.
static inline bool contains(const char *bytes, size_t size, const char *text)
{
    size_t length = strlen(text);
    for (size_t i = 0; i + length <= size; i++)
    {
        if (memcmp(bytes + i, text, length) == 0)
        {
            return true;
        }
    }
    return false;
}

/// Check that tags are nested and that there is one root.
static inline void check_nesting(const char *text)
{
    int depth = 0;
    for (const char *tag = strchr(text, '<'); tag != NULL; tag = strchr(tag + 1, '<'))
    {
        const char *end = strchr(tag, '>');
        assert_non_null(end);
        bool opens = tag[1] != '/' && tag[1] != '?' && end[-1] != '/';
        depth += opens ? 1 : tag[1] == '/' ? -1 : 0;
        assert_true(depth >= 0);
    }
    assert_int_equal(depth, 0);
}

static inline unsigned big_endian(const char *bytes)
{
    const unsigned char *b = (const unsigned char *)bytes;
    return (unsigned)b[0] << 24 | (unsigned)b[1] << 16 | (unsigned)b[2] << 8 | (unsigned)b[3];
}

/// Check that the file at `path` is a picture of this size in points, in the format of its ending.
static inline void check_picture(const char *path, unsigned width, unsigned height)
{
    size_t size;
    char *bytes = slurp(path, &size);
    char dimensions[80];
    if (strstr(path, ".svg") != NULL)
    {
        assert_non_null(strstr(bytes, "</svg>"));
        (void)snprintf(dimensions, sizeof dimensions, "width=\"%upt\" height=\"%upt\"", width, height);
        assert_non_null(strstr(bytes, dimensions));
        check_nesting(bytes);
    }
    else if (strstr(path, ".pdf") != NULL)
    {
        assert_memory_equal(bytes, "%PDF-", 5);
        assert_memory_equal(bytes + size - 6, "%%EOF\n", 6);
        (void)snprintf(dimensions, sizeof dimensions, "%u %u ]", width, height);
        assert_true(contains(bytes, size, dimensions));
    }
    else
    {
        assert_memory_equal(bytes, "\x89PNG\r\n\x1a\n", 8);
        assert_int_equal(big_endian(bytes + 16), 2 * width);
        assert_int_equal(big_endian(bytes + 20), 2 * height);
        assert_memory_equal(bytes + size - 8, "IEND", 4);
    }
    free(bytes);
}

#endif
