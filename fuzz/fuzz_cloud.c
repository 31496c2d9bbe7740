#include "promise.h"

#include "io/surface/cloud_formats.h"
#include "research/shapes/cloud_write.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum
{
    /// Larger clouds are not searched, because that takes too long.
    MAX_SEARCHED = 300
};

/// A cloud that was read can be written in every format and read again unchanged.
static void write_and_read(const bat_cloud *cloud)
{
    for (int format = BAT_CLOUD_FORMAT_XYZ; format <= BAT_CLOUD_FORMAT_OBJ; format++)
    {
        const bat_cloud_read_options options = {0};
        text_buffer buffer = {0};
        text_sink sink = {.buffer = &buffer};
        bat_cloud back = {0};
        PROMISE(cloud_write(cloud, (bat_cloud_format)format, &sink, NULL) == BAT_OK);
        const file_text text = {.data = buffer.data, .size = buffer.size};
        PROMISE(cloud_text_read(&text, (bat_cloud_format)format, NULL, BAT_CLOUD_FORMAT_XYZ, &options, &back, NULL) ==
                BAT_OK);
        PROMISE(back.count == cloud->count && back.boundary_count == cloud->boundary_count);
        PROMISE(back.has_corners == cloud->has_corners);
        for (size_t i = 0; i < 3 * cloud->count; i++)
            PROMISE(back.points[i] == cloud->points[i]);
        bat_cloud_free(&back);
        text_free(&buffer);
    }
}

/// For any points a boundary is found or refused, and corners are found on it.
static void search(bat_cloud *cloud)
{
    bat_error error = {0};
    if (cloud->count > MAX_SEARCHED)
        return;
    bat_status status = bat_cloud_find_boundary(cloud, &error);
    PROMISE(status == error.status && (status == BAT_OK || status == BAT_NO_CONVERGENCE));
    if (cloud->boundary_count == 0)
        return;
    status = bat_cloud_find_corners(cloud, NULL);
    PROMISE(status == BAT_OK || status == BAT_INVALID_ARGUMENT);
    PROMISE(bat_cloud_check(cloud, NULL) == BAT_OK);
    double *parameters = malloc(2 * cloud->boundary_count * sizeof *parameters);
    PROMISE(status != BAT_OK ||
            bat_cloud_boundary_parameters(cloud, BAT_CLOUD_SIDES_CHORD_LENGTH, parameters, NULL) == BAT_OK);
    for (size_t i = 0; status == BAT_OK && i < 2 * cloud->boundary_count; i++)
        PROMISE(parameters[i] >= 0 && parameters[i] <= 1);
    free(parameters);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    file_text text;
    bat_error refused = {0};
    if (file_text_copy((const char *)data, size, NULL, &text, &refused) != BAT_OK)
    {
        PROMISE(refused.status == BAT_BAD_FILE); // text in UTF-16
        return 0;
    }
    (void)cloud_format_of_text(&text);
    for (int format = BAT_CLOUD_FORMAT_XYZ; format <= BAT_CLOUD_FORMAT_GLB; format++)
        for (int choice = 0; choice < 3; choice++)
        {
            const bat_cloud_read_options options = {.strict = choice == 0};
            const file_text *boundary = choice > 1 ? &text : NULL;
            bat_cloud cloud = {0};
            bat_error error = {0};
            bat_status status = cloud_text_read(&text, (bat_cloud_format)format, boundary, (bat_cloud_format)format,
                                                &options, &cloud, &error);
            PROMISE(status == error.status);
            if (status != BAT_OK)
                continue;
            PROMISE(bat_cloud_check(&cloud, NULL) == BAT_OK);
            if (choice < 2)
                write_and_read(&cloud);
            if (choice == 1)
                search(&cloud);
            bat_cloud_free(&cloud);
        }
    file_text_free(&text);
    return 0;
}
