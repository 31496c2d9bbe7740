#include "io/common/number_text.h"
#include "io/surface/surface_formats.h"
#include "io/surface/surface_rows.h"
#include "io/surface/surface_tessellate.h"

/// Statements of a keyword and numbers.
typedef struct obj_rows
{
    const char *keyword; ///< with the blank behind it
    const double *numbers;
    size_t width;
} obj_rows;

static void append_row(const void *context, size_t row, text_buffer *text)
{
    const obj_rows *rows = context;
    text_append_string(text, rows->keyword);
    rows_append_numbers(text, rows->numbers + row * rows->width, rows->width);
}

static void append_triangle(const void *context, size_t row, text_buffer *text)
{
    const surface_tessellation *tessellation = context;
    char *out = text_reserve(text, 9 * (NUMBER_TEXT_SIZE + 1) + 2);
    if (out == NULL)
        return;
    *out++ = 'f';
    for (size_t h = 3 * row; h < 3 * row + 3; h++)
        for (int use = 0; use < 3; use++)
        {
            *out++ = use == 0 ? ' ' : '/';
            out = number_write_fixed(out, (int64_t)tessellation->triangles[h] + 1, 0);
        }
    *out++ = '\n';
    text_advance(text, out);
}

bat_status surface_obj_write(const bat_spline_surface *surface, const bat_surface_write_options *options, text_sink *sink,
                             bat_error *error)
{
    surface_tessellation tessellation;
    bat_status status = surface_tessellate(surface, options->samples, &tessellation, error);
    if (status != BAT_OK)
        return status;
    const obj_rows rows[] = {
        {"v ", tessellation.positions, 3}, {"vt ", tessellation.parameters, 2}, {"vn ", tessellation.normals, 3}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows && status == BAT_OK; i++)
        status = rows_write(sink, tessellation.vertex_count, append_row, &rows[i], error);
    if (status == BAT_OK)
        status = rows_write(sink, tessellation.triangle_count, append_triangle, &tessellation, error);
    tessellation_free(&tessellation);
    return status;
}
