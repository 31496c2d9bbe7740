#include "io/mesh/formats.h"
#include "io/surface/formats.h"
#include "io/surface/step.h"

/// @file
/// Tessellated surfaces as OBJ triangles and as VTK polygons with data points. Rows are formatted on all threads.

bat_status surface_obj_write(const bat_spline_surface *surface, const bat_surface_write_options *options, text_sink *sink,
                             bat_error *error)
{
    surface_tessellation tessellation;
    bat_status status = surface_tessellate(surface, options->samples, &tessellation, error);
    if (status != BAT_OK)
        return status;
    const bat_mesh mesh = {.positions = tessellation.positions,
                           .vertex_count = tessellation.vertex_count,
                           .faces = tessellation.triangles,
                           .face_count = tessellation.triangle_count,
                           .texture = tessellation.parameters,
                           .texture_count = tessellation.vertex_count,
                           .texture_faces = tessellation.triangles};
    const bat_mesh_write_options how = {.vertex_normals = tessellation.normals};
    status = mesh_obj_write(&mesh, &how, sink, error);
    tessellation_free(&tessellation);
    return status;
}

/// The data of a VTK file. Data points come after the surface's vertices, but before its quads.
typedef struct vtk_content
{
    const surface_tessellation *surface;
    const bat_surface_write_options *options;
} vtk_content;

static void append_point(const void *context, size_t row, text_buffer *text)
{
    const vtk_content *content = context;
    size_t vertices = content->surface->grid_count;
    text_append_numbers(
        text, "", row < vertices ? content->surface->positions + 3 * row : content->options->points + 3 * (row - vertices),
        3);
}

static void append_counted(text_buffer *text, const uint64_t *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        text_append_count(text, (size_t)numbers[i], i + 1 < count ? " " : "\n");
}

static void append_data_vertex(const void *context, size_t row, text_buffer *text)
{
    const vtk_content *content = context;
    const uint64_t cell[] = {1, content->surface->grid_count + row};
    append_counted(text, cell, 2);
}

/// The number of polygons: quads, or the triangles of a trimmed surface.
static size_t polygon_count(const vtk_content *content)
{
    return content->surface->quad_count > 0 ? content->surface->quad_count : content->surface->triangle_count;
}

static void append_polygon(const void *context, size_t row, text_buffer *text)
{
    const vtk_content *content = context;
    const uint32_t *triangle = content->surface->triangles + 3 * row;
    if (content->surface->quad_count == 0)
    {
        append_counted(text, (const uint64_t[]){3, triangle[0], triangle[1], triangle[2]}, 4);
        return;
    }
    const uint32_t *quad = content->surface->quads + 4 * row;
    const uint64_t cell[] = {4, quad[0], quad[1], quad[2], quad[3]};
    append_counted(text, cell, 5);
}

/// Append the level of a polygon's cell, or -1 for a data point.
static void append_level(const void *context, size_t row, text_buffer *text)
{
    const vtk_content *content = context;
    size_t points = content->options->point_count;
    const uint64_t level = row < points ? 0 : content->surface->levels[row - points];
    if (row < points)
        text_append_string(text, "-1\n");
    else
        append_counted(text, &level, 1);
}

/// Append the error of a data point, or 0 for a vertex of the surface.
static void append_error(const void *context, size_t row, text_buffer *text)
{
    const vtk_content *content = context;
    size_t vertices = content->surface->grid_count;
    static const double none = 0;
    text_append_numbers(text, "", row < vertices ? &none : content->options->errors + (row - vertices), 1);
}

static bat_status write_geometry(const vtk_content *content, text_sink *sink, bat_error *error)
{
    size_t points = content->options->point_count, polygons = polygon_count(content);
    size_t corners = content->surface->quad_count > 0 ? 4 : 3;
    size_t all = content->surface->grid_count + points;
    bat_status status = sink_format(
        sink, error, "# vtk DataFile Version 3.0\nbatten surface\nASCII\nDATASET POLYDATA\nPOINTS %zu double\n", all);
    if (status == BAT_OK)
        status = text_lines_write(sink, all, 0, append_point, content, error);
    if (status == BAT_OK && points > 0)
        status = sink_format(sink, error, "VERTICES %zu %zu\n", points, 2 * points);
    if (status == BAT_OK)
        status = text_lines_write(sink, points, 0, append_data_vertex, content, error);
    if (status == BAT_OK)
        status = sink_format(sink, error, "POLYGONS %zu %zu\n", polygons, (corners + 1) * polygons);
    if (status == BAT_OK)
        status = text_lines_write(sink, polygons, 0, append_polygon, content, error);
    return status;
}

static bat_status write_fields(const vtk_content *content, text_sink *sink, bat_error *error)
{
    size_t points = content->options->point_count, cells = points + polygon_count(content);
    size_t all = content->surface->grid_count + points;
    bat_status status = sink_format(sink, error, "CELL_DATA %zu\nSCALARS level int 1\nLOOKUP_TABLE default\n", cells);
    if (status == BAT_OK)
        status = text_lines_write(sink, cells, 0, append_level, content, error);
    if (status != BAT_OK || points == 0 || content->options->errors == NULL)
        return status;
    status = sink_format(sink, error, "POINT_DATA %zu\nSCALARS error double 1\nLOOKUP_TABLE default\n", all);
    return status == BAT_OK ? text_lines_write(sink, all, 0, append_error, content, error) : status;
}

bat_status surface_vtk_write(const bat_spline_surface *surface, const bat_surface_write_options *options, text_sink *sink,
                             bat_error *error)
{
    surface_tessellation tessellation;
    bat_status status = surface_tessellate(surface, options->samples, &tessellation, error);
    if (status != BAT_OK)
        return status;
    const vtk_content content = {&tessellation, options};
    status = write_geometry(&content, sink, error);
    if (status == BAT_OK)
        status = write_fields(&content, sink, error);
    tessellation_free(&tessellation);
    return status;
}
