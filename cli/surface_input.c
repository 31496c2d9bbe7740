#include "surface_input.h"

#include "report.h"

#include <limits.h>
#include <stdlib.h>

/// A whole number of 0 or more; false where the text is anything else.
static bool is_count(const char *text, const char **end, size_t *count)
{
    char *stop;
    if (*text < '0' || *text > '9')
        return false;
    unsigned long long value = strtoull(text, &stop, 10);
    *end = stop;
    *count = (size_t)value;
    return value < LONG_MAX;
}

/// "A,B,C,D"
static bool read_corners(const char *text, size_t corners[4])
{
    for (int k = 0; k < 4; k++)
    {
        if (!is_count(text, &text, &corners[k]) || *text != (k < 3 ? ',' : '\0'))
            return false;
        text++;
    }
    return true;
}

static void read_boundary(const char *text, bat_cloud_read_options *read)
{
    const char *end;
    size_t count;
    if (is_count(text, &end, &count) && *end == '\0')
        read->boundary = count;
    else
        read->boundary_path = text;
}

bool surface_input_arguments(const arguments *given, surface_input *input)
{
    bat_error error;
    const char *from = argument(given, "from"), *boundary = argument(given, "boundary"),
               *corners = argument(given, "corners");
    *input = (surface_input){.path = given->positional[0], .has_corners = corners != NULL};
    input->read.drop_duplicates = argument_flag(given, "drop-duplicates");
    if (from != NULL && bat_cloud_format_by_name(from, &input->read.format, &error) != BAT_OK)
    {
        (void)usage_error(given, "%s", error.text);
        return false;
    }
    if (corners != NULL && !read_corners(corners, input->corners))
    {
        (void)usage_error(given, "--corners takes four numbers of points like 0,33,66,99, not '%s'", corners);
        return false;
    }
    if (boundary != NULL)
        read_boundary(boundary, &input->read);
    if (boundary != NULL && input->read.boundary_path == NULL && input->read.boundary < 4)
    {
        (void)usage_error(given, "--boundary takes a file, or a number of points from 4, not '%s'", boundary);
        return false;
    }
    return true;
}

int surface_input_read(const surface_input *input, bat_cloud *cloud)
{
    bat_error error;
    bat_status status = bat_cloud_read(input->path, &input->read, cloud, &error);
    if (status != BAT_OK)
        return report_failure(input->path, &error);
    if (input->has_corners && cloud->boundary_count == 0)
        status = bat_cloud_find_boundary(cloud, &error);
    if (input->has_corners && status == BAT_OK)
        status = bat_cloud_set_corners(cloud, input->corners, &error);
    if (status == BAT_OK)
        return EXIT_DONE;
    bat_cloud_free(cloud);
    return report_failure(input->path, &error);
}

bool surface_input_is_surface(const char *path)
{
    bat_surface_format format = bat_surface_format_of_path(path);
    return format == BAT_SURFACE_FORMAT_XML || format == BAT_SURFACE_FORMAT_JSON || format == BAT_SURFACE_FORMAT_STEP;
}
