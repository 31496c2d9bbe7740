#include "research/shapes/cloud_write.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "batten/research/surface_shapes.h"
#include "io/common/number_text.h"

#include <string.h>

/// @file
/// Files of clouds. All formats are lines of text: comments or a header, a line for each point, and a line for each
/// triangle in formats that have triangles.

typedef struct row_style
{
    const char *remark;   ///< the start of a comment
    const char *point;    ///< the start of a point
    char separator;       ///< between numbers
    const char *triangle; ///< the start of a triangle; null where the format has none
    uint32_t first_index; ///< of points, in triangles
} row_style;

static const row_style STYLES[] = {[BAT_CLOUD_FORMAT_XYZ] = {"# ", "", ' ', NULL, 0},
                                   [BAT_CLOUD_FORMAT_CSV] = {"# ", "", ',', NULL, 0},
                                   [BAT_CLOUD_FORMAT_PLY] = {"comment ", "", ' ', "3 ", 0},
                                   [BAT_CLOUD_FORMAT_OBJ] = {"# ", "v ", ' ', "f ", 1}};

typedef struct cloud_writer
{
    const bat_cloud *cloud;
    const row_style *style;
    bool triangles; ///< write triangles in place of points
} cloud_writer;

static void append_row(const void *context, size_t row, text_buffer *text)
{
    const cloud_writer *writer = context;
    const row_style *style = writer->style;
    text_append_string(text, writer->triangles ? style->triangle : style->point);
    for (size_t k = 0; k < 3; k++)
    {
        const char after[2] = {k < 2 ? style->separator : '\n'};
        if (writer->triangles)
            text_append_count(text, (size_t)writer->cloud->triangles[3 * row + k] + style->first_index, after);
        else
            text_append_number(text, writer->cloud->points[3 * row + k], *after);
    }
}

/// Append the comments that cloud_remarks_read() reads.
static void append_remarks(const bat_cloud *cloud, const row_style *style, text_buffer *text)
{
    if (cloud->boundary_count == 0)
        return;
    text_append_string(text, style->remark);
    text_append_count(text, cloud->boundary_count, " boundary points first, in order around the loop, then ");
    text_append_count(text, cloud->count - cloud->boundary_count, " interior points\n");
    if (!cloud->has_corners)
        return;
    text_append_string(text, style->remark);
    text_append_string(text, "corners");
    for (int k = 0; k < 4; k++)
    {
        text_append_string(text, " ");
        text_append_count(text, cloud->corners[k], "");
    }
    text_append_string(text, "\n");
}

static bat_status write_head(const bat_cloud *cloud, bat_cloud_format format, text_sink *sink, bat_error *error)
{
    text_buffer text = {0};
    if (format == BAT_CLOUD_FORMAT_PLY)
        text_append_string(&text, "ply\nformat ascii 1.0\n");
    append_remarks(cloud, &STYLES[format], &text);
    if (format == BAT_CLOUD_FORMAT_CSV)
        text_append_string(&text, "x,y,z\n");
    if (format == BAT_CLOUD_FORMAT_PLY)
    {
        text_append_string(&text, "element vertex ");
        text_append_count(&text, cloud->count, "\nproperty double x\nproperty double y\nproperty double z\n");
        if (cloud->triangle_count > 0)
        {
            text_append_string(&text, "element face ");
            text_append_count(&text, cloud->triangle_count, "\nproperty list uchar uint vertex_indices\n");
        }
        text_append_string(&text, "end_header\n");
    }
    bat_status status = sink_write(sink, &text, error);
    text_free(&text);
    return status;
}

bat_status cloud_write(const bat_cloud *cloud, bat_cloud_format format, text_sink *sink, bat_error *error)
{
    const row_style *style = &STYLES[format];
    bat_status status = write_head(cloud, format, sink, error);
    if (status == BAT_OK)
        status = text_lines_write(sink, cloud->count, 0, append_row, &(cloud_writer){cloud, style, false}, error);
    if (status == BAT_OK && style->triangle != NULL)
        status = text_lines_write(sink, cloud->triangle_count, 0, append_row, &(cloud_writer){cloud, style, true}, error);
    return status;
}

bat_status bat_cloud_write(const char *path, const bat_cloud *cloud, bat_error *error)
{
    const bat_choice *row;
    atomic_file file;
    bat_status status = bat_choice_of_path(&bat_cloud_format_family, path, true, &row, error);
    if (status == BAT_OK && row == NULL && strcmp(path, "-") != 0)
        status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                           "cannot tell what format to write; the endings are .xyz, .txt, .asc, .csv, .tsv, .ply, .obj");
    bat_cloud_format format = row != NULL ? (bat_cloud_format)row->value : BAT_CLOUD_FORMAT_XYZ;
    if (status == BAT_OK)
        status = bat_cloud_check(cloud, error);
    if (status == BAT_OK)
        status = atomic_file_begin(path, &file, error);
    if (status != BAT_OK)
        return status;
    text_sink sink = {.stream = file.stream};
    status = cloud_write(cloud, format, &sink, error);
    return atomic_file_end(&file, status, error);
}
