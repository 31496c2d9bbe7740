#include "base/atomic_file.h"

#include "base/choice.h"
#include "base/option.h"
#include "batten/mesh_file.h"
#include "io/surface/cloud_formats.h"
#include "io/surface/formats.h"
#include "surface/spline/tensor_surface.h"

/// @file
/// Reading and writing of spline surfaces in any format.

typedef struct surface_format
{
    bat_choice choice;
    surface_writer *write;
} surface_format;

static const surface_format FORMATS[] = {
    {.choice = CHOICE_OF_USE(UNLISTED, "auto", "by the file's ending", BAT_SURFACE_FORMAT_AUTO)},
    {.choice = CHOICE_FORMAT("xml", "surfaces: G+Smo's (truncated) hierarchical and tensor-product B-splines", ".xml",
                             BAT_SURFACE_FORMAT_XML),
     .write = surface_xml_write},
    {.choice = CHOICE_FILE(false, true, "step", "surfaces: one shell of B-spline patches for CAD", ".step .stp",
                           BAT_SURFACE_FORMAT_STEP),
     .write = surface_step_write},
    {.choice = CHOICE_FILE(false, true, "vtk", "surfaces: a grid in each cell, and the data points with their errors",
                           ".vtk", BAT_SURFACE_FORMAT_VTK),
     .write = surface_vtk_write},
    {.choice = CHOICE_FILE(false, true, "obj", "surfaces: triangles", ".obj", BAT_SURFACE_FORMAT_OBJ),
     .write = surface_obj_write},
    {.choice =
         CHOICE_FORMAT("json", "surfaces: degrees, boxes, functions and control points", ".json", BAT_SURFACE_FORMAT_JSON),
     .write = surface_json_write},
    {.choice = CHOICE_FILE(false, true, "iges", "surfaces: one B-spline surface (128) or trimmed surface (144) for CAD",
                           ".iges .igs", BAT_SURFACE_FORMAT_IGES),
     .write = surface_iges_write},
};
const bat_family bat_surface_format_family = FAMILY("surface format", FORMATS);

static const bat_choice UNITS[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "millimetres", BAT_SURFACE_UNIT_AUTO),
    CHOICE("mm", "millimetres", BAT_SURFACE_UNIT_MILLIMETRE),
    CHOICE("m", "metres", BAT_SURFACE_UNIT_METRE),
    CHOICE("inch", "inches", BAT_SURFACE_UNIT_INCH),
};
const bat_family bat_surface_unit_family = FAMILY("unit", UNITS);

bat_surface_write_options bat_surface_write_defaults(void)
{
    return (bat_surface_write_options){.format = BAT_SURFACE_FORMAT_AUTO};
}

static const int MAX_SAMPLES = 1024;
static const option_field FIELDS[] = {
    OPTION_FAMILY(bat_surface_write_options, format, bat_surface_format_family),
    OPTION_FAMILY(bat_surface_write_options, unit, bat_surface_unit_family),
    OPTION_FIELD(bat_surface_write_options, samples, OPTION_SIZE, 0, MAX_SAMPLES),
};

static bat_status surface_write_options_check(const void *opaque, bat_error *error)
{
    const bat_surface_write_options *options = opaque;
    if (options->point_count > 0 && options->points == NULL)
        return error_option(error, "points", "is null, but must hold the point_count data points");
    for (size_t i = 0; i < options->point_count; i++)
    {
        const double *point = options->points + 3 * i;
        if (!isfinite(point[0]) || !isfinite(point[1]) || !isfinite(point[2]) ||
            (options->errors != NULL && !isfinite(options->errors[i])))
            return error_set(error, BAT_INVALID_POINT, i, 0, "data point %zu is not finite", i);
    }
    return BAT_OK;
}

const bat_options_table bat_surface_write_fields =
    OPTIONS_TABLE(bat_surface_write_options, FIELDS, surface_write_options_check);

bat_status surface_check(const bat_spline_surface *surface, bat_surface_format format,
                         const bat_surface_write_options *options, bat_error *error)
{
    bat_status status = bat_options_check(&bat_surface_write_fields, options, error);
    if (status != BAT_OK)
        return status;
    if (format == BAT_SURFACE_FORMAT_AUTO)
        return choice_unnamed_output(&bat_surface_format_family, error);
    if (surface->space == NULL || surface->control == NULL || surface->dimension == 0)
        return ERROR_ARGUMENT(error, "the surface is empty");
    if (surface->dimension != 3 && format != BAT_SURFACE_FORMAT_XML && format != BAT_SURFACE_FORMAT_JSON)
        return ERROR_UNSUPPORTED(error, 0, "a surface of dimension %zu can be written as XML and JSON only",
                                 surface->dimension);
    status = spline_trim_check(&surface->trim, error);
    if (status != BAT_OK)
        return status;
    size_t functions = bat_hierarchical_space_functions(surface->space);
    for (size_t i = 0; i < functions * surface->dimension; i++)
        if (!isfinite(surface->control[i]))
            return error_set(error, BAT_INVALID_POINT, i / surface->dimension, 0, "control point %zu is not finite",
                             i / surface->dimension);
    return BAT_OK;
}

bat_status surface_write_text(const bat_spline_surface *surface, bat_surface_format format,
                              const bat_surface_write_options *options, text_sink *sink, bat_error *error)
{
    const surface_format *row =
        (const surface_format *)(const void *)choice_of_value(&bat_surface_format_family, (int)format);
    return row != NULL && row->write != NULL ? row->write(surface, options, sink, error) : BAT_INVALID_ARGUMENT;
}

bat_status bat_surface_write(const char *path, const bat_spline_surface *surface, const bat_surface_write_options *options,
                             bat_error *error)
{
    const bat_surface_primitive none = {.kind = BAT_SURFACE_PRIMITIVE_NONE};
    return bat_surface_write_shape(path, surface, &none, options, NULL, NULL, error);
}

bat_status bat_surface_write_shape(const char *path, const bat_spline_surface *surface, const bat_surface_primitive *shape,
                                   const bat_surface_write_options *options, size_t edges[3], double *area, bat_error *error)
{
    size_t counts[3] = {0};
    double measured = NAN;
    const bat_surface_write_options defaults = bat_surface_write_defaults();
    if (options == NULL)
        options = &defaults;
    bat_surface_format format = options->format;
    const bat_choice *row = NULL;
    atomic_file file;
    bat_status status = BAT_OK;
    if (format == BAT_SURFACE_FORMAT_AUTO)
        status = bat_choice_of_path(&bat_surface_format_family, path, true, &row, error);
    if (row != NULL)
        format = (bat_surface_format)row->value;
    if (status == BAT_OK)
        status = surface_check(surface, format, options, error);
    if (status == BAT_OK)
        status = atomic_file_begin(path, &file, error);
    if (status != BAT_OK)
        return status;
    text_sink sink = {.stream = file.stream};
    if (shape->kind == BAT_SURFACE_PRIMITIVE_NONE || format != BAT_SURFACE_FORMAT_STEP)
        status = surface_write_text(surface, format, options, &sink, error);
    else
        status = surface_shape_write(surface, shape, options, &sink, counts, &measured, error);
    if (edges != NULL)
        memcpy(edges, counts, sizeof counts);
    if (area != NULL)
        *area = measured;
    return atomic_file_end(&file, status, error);
}

// Shells: STEP as patches, mesh formats as samples of the patches.

#define SHELL_SAMPLES 4 ///< of a patch

bat_status bat_shell_write(const char *path, const bat_shell *shell, const bat_surface_write_options *options,
                           bat_error *error)
{
    const bat_surface_write_options defaults = bat_surface_write_defaults();
    options = options != NULL ? options : &defaults;
    const bat_choice *row = NULL;
    bat_status status = bat_options_check(&bat_surface_write_fields, options, error);
    if (status != BAT_OK)
        return status;
    if (options->format == BAT_SURFACE_FORMAT_AUTO)
        (void)bat_choice_of_path(&bat_surface_format_family, path, true, &row, NULL);
    int format = row != NULL ? row->value : (int)options->format;
    if (format == BAT_SURFACE_FORMAT_STEP)
    {
        atomic_file file;
        status = atomic_file_begin(path, &file, error);
        if (status != BAT_OK)
            return status;
        text_sink sink = {.stream = file.stream};
        return atomic_file_end(&file, shell_step_write(shell, options, &sink, error), error);
    }
    if (format != BAT_SURFACE_FORMAT_AUTO && format != BAT_SURFACE_FORMAT_OBJ)
        return ERROR_UNSUPPORTED(error, 0,
                                 "a shell of any shape can be written as STEP, or as a mesh: OBJ, PLY, STL, OFF, glTF");
    bat_mesh mesh;
    status = bat_shell_tessellate(shell, options->samples > 0 ? options->samples : SHELL_SAMPLES, &mesh, error);
    if (status != BAT_OK)
        return status;
    status = bat_mesh_write(path, &mesh, NULL, error);
    bat_mesh_free(&mesh);
    return status;
}

bat_status surface_read_text(const file_text *text, bat_spline_surface *surface, bat_error *error)
{
    static const char step[] = "ISO-10303-21";
    size_t blanks = strspn(text->data, " \t\r\n");
    if (text->data[blanks] == '<')
        return surface_xml_read(text, surface, error);
    if (text->data[blanks] == '{')
        return surface_json_read(text, surface, error);
    if (strncmp(text->data + blanks, step, sizeof step - 1) == 0)
        return ERROR_UNSUPPORTED(error, 0, "STEP is only supported for writing surfaces");
    return ERROR_FILE(error, 1, "this is neither XML of G+Smo nor JSON");
}

bat_status bat_surface_read(const char *path, bat_spline_surface *surface, bat_error *error)
{
    file_text text;
    bat_status status = file_text_read(path, NULL, &text, error);
    if (status != BAT_OK)
        return status;
    status = surface_read_text(&text, surface, error);
    file_text_free(&text);
    return status;
}

// Files of parameters (u, v), one row for each point of the cloud's input.

/// The number of points in the input, as far as the cloud has it: points dropped after the last one do not count.
static size_t input_count(const bat_cloud *cloud)
{
    size_t count = cloud->order == NULL ? cloud->count : 0;
    for (size_t i = 0; i < cloud->count && cloud->order != NULL; i++)
        count = cloud->order[i] >= count ? cloud->order[i] + 1 : count;
    return count;
}

static size_t place_of(const bat_cloud *cloud, size_t point)
{
    return cloud->order == NULL ? point : cloud->order[point];
}

bat_status bat_cloud_parameters_write(const char *path, const bat_cloud *cloud, const double *parameters, bat_error *error)
{
    size_t count = input_count(cloud);
    double *rows = memory_array(count, 2 * sizeof *rows);
    if (rows == NULL)
        return error_memory(error, count * 2 * sizeof *rows);
    for (size_t k = 0; k < 2 * count; k++)
        rows[k] = NAN;
    for (size_t i = 0; i < cloud->count; i++)
        memcpy(rows + 2 * place_of(cloud, i), parameters + 2 * i, 2 * sizeof *rows);
    text_buffer text = {0};
    for (size_t i = 0; i < count; i++)
        text_append_numbers(&text, "", rows + 2 * i, 2); // "nan nan" for a point without
    free(rows);
    bat_status status = text.failed ? error_memory(error, text.size) : atomic_file_write(path, text.data, text.size, error);
    text_free(&text);
    return status;
}

/// Rows "u v" in the order of a file; NaN for a dropped point.
typedef struct row_listing
{
    double *rows;
    size_t count, capacity;
} row_listing;

static bat_status read_row(word_scan *scan, size_t index, double *row, bat_error *error)
{
    static const char *const NAMES[] = {"u", "v"};
    for (size_t k = 0; k < 2; k++)
    {
        if (scan_line_done(scan))
            return error_set(error, BAT_BAD_FILE, index, scan->line, "row %zu has no %s", index, NAMES[k]);
        if (scan_word(scan, "nan"))
            row[k] = NAN;
        else if (!scan_number(scan, &row[k]))
            return scan_number_fault(scan, index, NAMES[k], error);
        else if (row[k] < 0 || row[k] > 1)
            return error_set(error, BAT_BAD_FILE, index, scan->line, "%s of row %zu is %g, not from 0 to 1", NAMES[k], index,
                             row[k]);
    }
    if (!scan_line_done(scan))
        return error_set(error, BAT_BAD_FILE, index, scan->line, "row %zu has more than u and v", index);
    return BAT_OK;
}

static bat_status read_rows(const file_text *text, row_listing *listing, bat_error *error)
{
    word_scan scan = word_scan_start(text->data, text->size);
    while (scan_next_content(&scan))
    {
        if (!ARRAY_GROW(listing->rows, listing->capacity, 2 * (listing->count + 1)))
            return error_memory(error, listing->capacity * sizeof(double));
        bat_status status = read_row(&scan, listing->count, listing->rows + 2 * listing->count, error);
        if (status != BAT_OK)
            return status;
        listing->count++;
    }
    return BAT_OK;
}

static bat_status spread_rows(const row_listing *listing, const bat_cloud *cloud, double *parameters, bat_error *error)
{
    if (listing->rows == NULL || listing->count != input_count(cloud))
        return ERROR_FILE(error, 0, "%zu rows of parameters for %zu points", listing->count, input_count(cloud));
    for (size_t i = 0; i < cloud->count; i++)
    {
        const double *row = listing->rows + 2 * place_of(cloud, i);
        if (isnan(row[0]) || isnan(row[1]))
            return error_set(error, BAT_BAD_FILE, place_of(cloud, i), 0, "row %zu has no parameters", place_of(cloud, i));
        memcpy(parameters + 2 * i, row, 2 * sizeof *row);
    }
    return BAT_OK;
}

bat_status bat_cloud_parameters_read(const char *path, const bat_cloud *cloud, double **parameters, bat_error *error)
{
    file_text text;
    bat_status status = file_text_read(path, NULL, &text, error);
    if (status != BAT_OK)
        return status;
    row_listing listing = {0};
    double *read;
    status = array_make(&read, cloud->count, 2 * sizeof *read, error);
    if (status == BAT_OK)
        status = read_rows(&text, &listing, error);
    if (status == BAT_OK)
        status = spread_rows(&listing, cloud, read, error);
    if (status == BAT_OK)
        *parameters = read;
    else
        free(read);
    free(listing.rows);
    file_text_free(&text);
    return status;
}
