#include "promise.h"

#include "batten/curve_file.h"

#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

// Formats that GDAL reads. The first byte of the input chooses the ending of a file, which has the other bytes.

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/// Read by LeakSanitizer: GDAL leaks objects of C++ where a file ends early; no memory of batten comes from there.
const char *__lsan_default_suppressions(void); // NOLINT(bugprone-reserved-identifier)
const char *__lsan_default_suppressions(void)  // NOLINT(bugprone-reserved-identifier)
{
    return "leak:operator new";
}

enum
{
    FEW_POINTS = 50,
    PATH_SIZE = 64
};

static const struct
{
    char first;
    const char *ending;
    bat_curve_format format;
} KINDS[] = {{'g', "gpkg", BAT_CURVE_FORMAT_AUTO},   {'z', "shp.zip", BAT_CURVE_FORMAT_AUTO},
             {'f', "fgb", BAT_CURVE_FORMAT_AUTO},    {'k', "kml", BAT_CURVE_FORMAT_AUTO},
             {'d', "dxf", BAT_CURVE_FORMAT_AUTO},    {'m', "gml", BAT_CURVE_FORMAT_GDAL},
             {'c', "csv.gz", BAT_CURVE_FORMAT_AUTO}, {'j', "geojson.gz", BAT_CURVE_FORMAT_AUTO}};

/// A folder of this process.
static char folder[PATH_SIZE];

static void path_of(const char *name, const char *ending, char path[2 * PATH_SIZE])
{
    (void)snprintf(path, 2 * PATH_SIZE, "%s/%s.%s", folder, name, ending);
}

static void remove_folder(void)
{
    (void)rmdir(folder);
}

/// Remove all files but those of one name. The count of what was removed.
static size_t remove_others(const char *name)
{
    DIR *files = opendir(folder);
    PROMISE(files != NULL);
    size_t count = 0;
    for (struct dirent *file; (file = readdir(files)) != NULL;)
    {
        char path[2 * PATH_SIZE + sizeof file->d_name];
        if (strcmp(file->d_name, ".") == 0 || strcmp(file->d_name, "..") == 0 ||
            (name != NULL && strcmp(file->d_name, name) == 0))
            continue;
        (void)snprintf(path, sizeof path, "%s/%s", folder, file->d_name);
        PROMISE(unlink(path) == 0);
        count++;
    }
    (void)closedir(files);
    return count;
}

static size_t count_points(const bat_curve_set *set)
{
    size_t count = 0;
    for (size_t i = 0; i < set->count; i++)
        count += set->curves[i].count;
    return count;
}

/// What was read can be written as GeoJSON and in its own format, or the failure has a status.
static void write_again(const bat_curve_set *set, const char *ending)
{
    bat_curve_write_options writing = bat_curve_write_defaults();
    writing.threads = 1;
    bat_error error = {0};
    char path[2 * PATH_SIZE];
    path_of("out", ending, path);
    bat_status status = bat_curve_write(path, set, &writing, &error);
    PROMISE(status == BAT_OK || (status == error.status && error.text[0] != '\0'));
    PROMISE((access(path, F_OK) == 0) == (status == BAT_OK));
    writing.format = BAT_CURVE_FORMAT_GEOJSON;
    char *text = NULL;
    size_t size = 0;
    status = bat_curve_write_memory(set, &writing, &text, &size, &error);
    PROMISE(status == BAT_OK || status == BAT_UNSUPPORTED);
    if (status != BAT_OK)
        return;
    bat_curve_set back = {0};
    bat_curve_read_options reading = bat_curve_read_defaults();
    reading.threads = 1;
    reading.format = BAT_CURVE_FORMAT_GEOJSON;
    status = bat_curve_read_memory(text, size, &reading, &back, &error);
    PROMISE(status == error.status || status == BAT_OK);
    bat_curve_set_free(&back);
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    size_t kind = 0;
    while (size > 0 && kind < sizeof KINDS / sizeof *KINDS && data[0] != (uint8_t)KINDS[kind].first)
        kind++;
    if (size == 0 || kind == sizeof KINDS / sizeof *KINDS)
        return -1;
    if (folder[0] == '\0')
    {
        (void)strcpy(folder, "/tmp/fuzz-gis-XXXXXX");
        PROMISE(mkdtemp(folder) != NULL && atexit(remove_folder) == 0);
    }
    char path[2 * PATH_SIZE];
    path_of("in", KINDS[kind].ending, path);
    FILE *file = fopen(path, "wb");
    PROMISE(file != NULL && fwrite(data + 1, 1, size - 1, file) == size - 1 && fclose(file) == 0);
    for (int few = 0; few < 2; few++)
    {
        bat_curve_read_options reading = bat_curve_read_defaults();
        reading.threads = 1;
        reading.format = KINDS[kind].format;
        reading.limits.points = few ? FEW_POINTS : 0;
        bat_curve_set set = {0};
        bat_error error = {0};
        bat_status status = bat_curve_read(path, &reading, &set, &error);
        PROMISE(status == error.status && (status == BAT_OK) == (set.count > 0));
        PROMISE(remove_others(strrchr(path, '/') + 1) == 0);
        PROMISE(status != BAT_OK || !few || count_points(&set) <= FEW_POINTS);
        if (status == BAT_OK && !few)
            write_again(&set, KINDS[kind].ending);
        bat_curve_set_free(&set);
        (void)remove_others(strrchr(path, '/') + 1);
    }
    (void)remove_others(NULL);
    return 0;
}
