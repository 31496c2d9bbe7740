#include "base/choice.h"
#include "base/option.h"
#include "io/mesh/formats.h"
#include "io/surface/cloud_formats.h"

/// @file
/// Clouds in any format: points, an optional file with the boundary, or the vertices of a mesh.

/// The line of statement "v" number `point`, counted from 0.
static size_t obj_line_of_point(const file_text *text, size_t point)
{
    return scan_line_of(text, scan_word, "v", point);
}

/// A format: its reader, either of points or of a mesh that may have faces.
typedef struct cloud_format
{
    bat_choice choice;
    cloud_reader *read;
    mesh_reader *read_mesh;
    size_t (*line_of_point)(const file_text *text, size_t point); ///< null for formats without lines
} cloud_format;

static const cloud_format FORMATS[] = {
    {.choice = CHOICE_OF_USE(UNLISTED, "auto", "by the file's ending", BAT_CLOUD_FORMAT_AUTO)},
    {.choice = CHOICE_FORMAT("xyz", "clouds: three numbers a line, and what follows; CloudCompare's ASCII, PTS",
                             ".xyz .txt .asc .pts", BAT_CLOUD_FORMAT_XYZ),
     .read = cloud_rows_read,
     .line_of_point = cloud_rows_line_of_point},
    {.choice = CHOICE_FORMAT("csv", "clouds: x, y, z by their names, or the first three columns", ".csv .tsv",
                             BAT_CLOUD_FORMAT_CSV),
     .read = cloud_rows_read,
     .line_of_point = cloud_rows_line_of_point},
    {.choice = CHOICE_FORMAT("ply", "clouds: vertices; with faces a mesh", ".ply", BAT_CLOUD_FORMAT_PLY),
     .read_mesh = mesh_ply_read_points},
    {.choice = CHOICE_FORMAT("obj", "clouds: vertices; with faces a mesh", ".obj", BAT_CLOUD_FORMAT_OBJ),
     .read_mesh = mesh_obj_read_points,
     .line_of_point = obj_line_of_point},
    {.choice = CHOICE_FILE(true, false, "pcd", "clouds: points of the Point Cloud Library; text, binary or compressed",
                           ".pcd", BAT_CLOUD_FORMAT_PCD),
     .read = cloud_pcd_read},
    {.choice = CHOICE_FILE(true, false, "las", "clouds: points of laser scans, versions 1.0 to 1.4, not compressed",
                           ".las .laz", BAT_CLOUD_FORMAT_LAS),
     .read = cloud_las_read},
    {.choice = CHOICE_FILE(true, false, "ptx", "clouds: scans with transformations, as text", ".ptx", BAT_CLOUD_FORMAT_PTX),
     .read = cloud_ptx_read},
    {.choice = CHOICE_FILE(true, false, "stl", "meshes of one patch, or closed ones", ".stl", BAT_CLOUD_FORMAT_STL),
     .read_mesh = mesh_stl_read},
    {.choice = CHOICE_FILE(true, false, "off", "meshes of one patch, or closed ones", ".off", BAT_CLOUD_FORMAT_OFF),
     .read_mesh = mesh_off_read},
    {.choice = CHOICE_FILE(true, false, "glb", "meshes of one patch, or closed ones: glTF 2.0", ".glb .gltf",
                           BAT_CLOUD_FORMAT_GLB),
     .read_mesh = mesh_gltf_read},
};
const bat_family bat_cloud_format_family = FAMILY("cloud format", FORMATS);

/// The row of a format other than BAT_CLOUD_FORMAT_AUTO.
static const cloud_format *row_of(bat_cloud_format format)
{
    return (const cloud_format *)(const void *)choice_of_value(&bat_cloud_format_family, (int)format);
}

/// The format of a text. OBJ lines begin with a word; CSV has names, or separators other than blanks.
bat_cloud_format cloud_format_of_text(const file_text *text)
{
    static const char *const obj_words[] = {"v", "vn", "vt", "o", "g", "f", "s", "mtllib", "usemtl"};
    if (mesh_ply_resembles(text))
        return BAT_CLOUD_FORMAT_PLY;
    if (cloud_las_resembles(text))
        return BAT_CLOUD_FORMAT_LAS;
    if (cloud_pcd_resembles(text))
        return BAT_CLOUD_FORMAT_PCD;
    if (mesh_stl_resembles(text))
        return BAT_CLOUD_FORMAT_STL;
    if (mesh_off_resembles(text))
        return BAT_CLOUD_FORMAT_OFF;
    if (mesh_glb_resembles(text))
        return BAT_CLOUD_FORMAT_GLB;
    if (cloud_ptx_resembles(text))
        return BAT_CLOUD_FORMAT_PTX;
    word_scan scan = word_scan_start(text->data, text->size);
    if (!scan_next_content(&scan))
        return BAT_CLOUD_FORMAT_XYZ;
    for (size_t i = 0; i < sizeof obj_words / sizeof *obj_words; i++)
    {
        word_scan word = scan;
        if (scan_word(&word, obj_words[i]))
            return BAT_CLOUD_FORMAT_OBJ;
    }
    double number;
    for (int k = 0; k < 3; k++)
        if (!scan_number(&scan, &number))
            return BAT_CLOUD_FORMAT_CSV;
    return BAT_CLOUD_FORMAT_XYZ;
}

/// A file and its content: points, or a mesh with faces.
typedef struct cloud_source
{
    const file_text *text;
    bat_cloud_format format;
    point_listing listing;
    bat_mesh mesh;
} cloud_source;

static void source_free(cloud_source *source)
{
    free(source->listing.points);
    bat_mesh_free(&source->mesh);
}

/// The line of a point; 0 in binary files.
static size_t line_of_point(const cloud_source *source, size_t point)
{
    const cloud_format *row = row_of(source->format);
    return row->line_of_point != NULL ? row->line_of_point(source->text, point) : 0;
}

static bat_status source_read(cloud_source *source, const bat_cloud_read_options *how, bat_error *error)
{
    static const char e57[] = "ASTM-E57";
    point_listing *listing = &source->listing;
    bat_mesh *mesh = &source->mesh;
    const cloud_format *row = row_of(source->format);
    if (source->text->size >= sizeof e57 - 1 && memcmp(source->text->data, e57, sizeof e57 - 1) == 0)
        return ERROR_UNSUPPORTED(
            error, 0,
            "E57 is not supported: Debian has no library for it; batten.read_points in Python reads it, CloudCompare "
            "writes formats that are");
    if (how->classes != NULL && source->format != BAT_CLOUD_FORMAT_LAS)
        return ERROR_ARGUMENT(error, "only points of LAS files have classes");
    if (row->read != NULL)
        return row->read(source->text, how, listing, error);
    bat_mesh_read_options options = bat_mesh_read_defaults();
    options.triangulate = options.strict = true;
    options.notes = how->notes;
    bat_status status = row->read_mesh(source->text, &options, mesh, error);
    if (status != BAT_OK || mesh->face_count > 0)
        return status;
    *listing = (point_listing){mesh->positions, mesh->vertex_count, 3 * mesh->vertex_count};
    mesh->positions = NULL;
    bat_mesh_free(mesh);
    return BAT_OK;
}

/// Report a failure in the boundary's file. The line of the error would be one of the other file, so the text names it.
static bat_status name_boundary_file(bat_status status, const bat_error *found, bat_error *error)
{
    if (found->line > 0)
        return error_set(error, status, found->index, 0, "line %zu of the boundary's file: %s", found->line, found->text);
    return error_set(error, status, found->index, 0, "the boundary's file: %s", found->text);
}

static bat_status repeats(const cloud_source *source, size_t first, size_t second, bat_error *error)
{
    size_t line = line_of_point(source, second);
    if (line == 0)
        return error_set(error, BAT_INVALID_POINT, second, 0, "point %zu repeats point %zu", second, first);
    return error_set(error, BAT_INVALID_POINT, second, line, "the point repeats that of line %zu",
                     line_of_point(source, first));
}

/// Append the points of a file to a cloud with enough memory. Duplicates are counted or refused, of earlier files left out.
static bat_status append_distinct(const cloud_source *source, size_t first_place, bool strict, point_table *table,
                                  bat_cloud *cloud, bat_error *error)
{
    size_t before = cloud->count;
    for (size_t i = 0; i < source->listing.count; i++)
    {
        double *place = cloud->points + 3 * cloud->count;
        memcpy(place, source->listing.points + 3 * i, 3 * sizeof *place);
        uint32_t other = point_table_find(table, place);
        if (other != BAT_MESH_NONE && other >= before && strict)
            return repeats(source, cloud->order[other] - first_place, i, error);
        cloud->duplicates += other != BAT_MESH_NONE && other >= before;
        if (other != BAT_MESH_NONE)
            continue;
        if (!point_table_add(table, (uint32_t)cloud->count))
            return error_memory(error, table->slot_count * sizeof *table->slots);
        cloud->order[cloud->count++] = first_place + i;
    }
    return BAT_OK;
}

/// Combine the points of the boundary's file, if any, and of the main file.
static bat_status join(const cloud_source *boundary, const cloud_source *source, bool strict, bat_cloud *cloud,
                       bat_error *error)
{
    size_t total = boundary->listing.count + source->listing.count;
    if (total == 0)
        return ERROR_FILE(error, 0, "there are no points");
    if (total >= BAT_MESH_NONE)
        return ERROR_TOO_LARGE(error, "there are %zu points, more than %u", total, BAT_MESH_NONE - 1);
    cloud->points = memory_array(total, 3 * sizeof *cloud->points);
    cloud->order = memory_array(total, sizeof *cloud->order);
    point_table table = {.points = cloud->points};
    bat_status status = BAT_OK;
    if (cloud->points == NULL || cloud->order == NULL || !point_table_reserve(&table, total))
        status = error_memory(error, total * 3 * sizeof *cloud->points);
    bat_error found;
    if (status == BAT_OK && boundary->text != NULL)
    {
        status = append_distinct(boundary, 0, strict, &table, cloud, &found);
        cloud->boundary_count = cloud->count;
        if (status != BAT_OK)
            status = name_boundary_file(status, &found, error);
    }
    if (status == BAT_OK)
        status = append_distinct(source, boundary->listing.count, strict, &table, cloud, error);
    point_table_free(&table);
    return status;
}

static bat_status check_boundary_count(size_t boundary_count, size_t count, bat_status status, size_t line, bat_error *error)
{
    static const int MIN_BOUNDARY = 4;
    if (boundary_count > count)
        return error_set(error, status, BAT_NO_INDEX, line, "a boundary of %zu points, but there are only %zu",
                         boundary_count, count);
    if (boundary_count > 0 && boundary_count < MIN_BOUNDARY)
        return error_set(error, status, BAT_NO_INDEX, line, "a boundary of %zu points does not have four corners",
                         boundary_count);
    return BAT_OK;
}

/// Apply the boundary and the corners given by the options or by the file's comments.
static bat_status apply_remarks(const cloud_source *source, const bat_cloud_read_options *options, bat_cloud *cloud,
                                bat_error *error)
{
    cloud_remarks remarks = cloud_remarks_read(source->text);
    bool by_option = options->boundary > 0;
    size_t boundary_count = by_option ? options->boundary : remarks.boundary;
    bat_status status =
        check_boundary_count(boundary_count, source->listing.count, by_option ? BAT_INVALID_ARGUMENT : BAT_BAD_FILE,
                             by_option ? 0 : remarks.boundary_line, error);
    if (status != BAT_OK)
        return status;
    size_t distinct = 0;
    while (distinct < cloud->count && cloud->order[distinct] < boundary_count)
        distinct++;
    cloud->boundary_count = distinct;
    bool rising = remarks.has_corners && remarks.corners[3] < boundary_count;
    for (int k = 1; k < 4; k++)
        rising = rising && remarks.corners[k - 1] < remarks.corners[k];
    cloud->has_corners = rising && cloud->boundary_count == remarks.boundary;
    if (cloud->has_corners)
        memcpy(cloud->corners, remarks.corners, sizeof cloud->corners);
    return BAT_OK;
}

static bat_status cloud_of_points(const cloud_source *boundary, const cloud_source *source,
                                  const bat_cloud_read_options *options, bat_cloud *cloud, bat_error *error)
{
    bat_cloud made = {0};
    bat_status status = join(boundary, source, options->strict, &made, error);
    if (status == BAT_OK && boundary->text == NULL)
        status = apply_remarks(source, options, &made, error);
    if (status == BAT_OK)
        status = bat_cloud_check(&made, error);
    if (status != BAT_OK)
    {
        bat_cloud_free(&made);
        return status;
    }
    if (made.count == boundary->listing.count + source->listing.count)
    {
        free(made.order);
        made.order = NULL;
    }
    *cloud = made;
    return BAT_OK;
}

/// Whether the cloud of a mesh begins with its boundary loop in the order of the file.
static bool keeps_boundary(const bat_cloud *cloud)
{
    for (size_t i = 0; i < cloud->boundary_count; i++)
        if (cloud->order[i] != i)
            return false;
    return true;
}

static bat_status cloud_of_mesh(const cloud_source *source, const bat_cloud_read_options *options, bat_cloud *cloud,
                                bat_error *error)
{
    bat_mesh welded = {0};
    cloud_remarks remarks = cloud_remarks_read(source->text);
    if (options->boundary > 0)
        return ERROR_ARGUMENT(error, "the file is a mesh, which has its own boundary");
    bat_status status = options->strict ? BAT_OK : bat_mesh_weld(&source->mesh, 0, NULL, &welded, error);
    size_t repeated = status != BAT_OK || options->strict ? 0 : source->mesh.vertex_count - welded.vertex_count;
    if (status == BAT_OK)
        status = bat_cloud_from_mesh(repeated > 0 ? &welded : &source->mesh, cloud, error);
    if (status == BAT_OK)
        cloud->duplicates = repeated;
    bat_mesh_free(&welded);
    if (status != BAT_OK || !remarks.has_corners || remarks.boundary != cloud->boundary_count || !keeps_boundary(cloud))
        return status;
    bat_cloud marked = *cloud;
    marked.has_corners = true;
    memcpy(marked.corners, remarks.corners, sizeof marked.corners);
    if (bat_cloud_check(&marked, NULL) == BAT_OK)
        *cloud = marked;
    return BAT_OK;
}

bat_status cloud_text_read(const file_text *text, bat_cloud_format format, const file_text *boundary_text,
                           bat_cloud_format boundary_format, const bat_cloud_read_options *options, bat_cloud *cloud,
                           bat_error *error)
{
    cloud_source source = {.text = text, .format = format}, boundary = {.text = boundary_text, .format = boundary_format};
    bat_error found = {.index = BAT_NO_INDEX};
    bat_status status = source_read(&source, options, error);
    if (status == BAT_OK && boundary_text != NULL)
    {
        status = source_read(&boundary, &(bat_cloud_read_options){0}, &found);
        if (status == BAT_OK && boundary.mesh.face_count + source.mesh.face_count > 0)
            status = ERROR_UNSUPPORTED(&found, 0, "a mesh has its own boundary");
        if (status == BAT_OK && boundary.listing.count < 4)
            status = ERROR_FILE(&found, 0, "%zu points are not a boundary", boundary.listing.count);
        if (status != BAT_OK)
            status = name_boundary_file(status, &found, error);
    }
    if (status == BAT_OK)
        status = source.mesh.face_count > 0 ? cloud_of_mesh(&source, options, cloud, error)
                                            : cloud_of_points(&boundary, &source, options, cloud, error);
    source_free(&source);
    source_free(&boundary);
    return status;
}

static bat_status read_file(const char *path, const bat_limits *limits, bat_cloud_format *format, file_text *text,
                            bat_error *error)
{
    const bat_choice *row = NULL;
    bat_status status = BAT_OK;
    if (*format == BAT_CLOUD_FORMAT_AUTO)
        status = bat_choice_of_path(&bat_cloud_format_family, path, false, &row, error);
    if (row != NULL)
        *format = (bat_cloud_format)row->value;
    if (status == BAT_OK)
        status = file_text_read(path, limits, text, error);
    if (status == BAT_OK && *format == BAT_CLOUD_FORMAT_AUTO)
        *format = cloud_format_of_text(text);
    return status;
}

bat_cloud_read_options bat_cloud_read_defaults(void)
{
    return (bat_cloud_read_options){.format = BAT_CLOUD_FORMAT_AUTO};
}

static const option_field FIELDS[] = {
    OPTION_FAMILY(bat_cloud_read_options, format, bat_cloud_format_family),
};

static bat_status cloud_read_options_check(const void *opaque, bat_error *error)
{
    const bat_cloud_read_options *options = opaque;
    bool wanted[LAS_CLASSES];
    if (options->classes != NULL && !las_classes_read(options->classes, wanted))
        return error_option(error, "classes", "is '%s', but must be classes of LAS between commas, as in 2,8",
                            options->classes);
    if (options->boundary > 0 && options->boundary_path != NULL)
        return error_option(error, "boundary",
                            "is %zu, but must be 0 beside a boundary_path: it is the first points or a file",
                            options->boundary);
    return BAT_OK;
}

const bat_options_table bat_cloud_read_fields = OPTIONS_TABLE(bat_cloud_read_options, FIELDS, cloud_read_options_check);

bat_status bat_cloud_read(const char *path, const bat_cloud_read_options *options, bat_cloud *cloud, bat_error *error)
{
    const bat_cloud_read_options defaults = bat_cloud_read_defaults();
    options = options != NULL ? options : &defaults;
    bat_status status = bat_options_check(&bat_cloud_read_fields, options, error);
    if (status != BAT_OK)
        return status;
    file_text text = {0}, boundary_text = {0};
    bat_cloud made = {0};
    bat_cloud_format format = options->format, boundary_format = BAT_CLOUD_FORMAT_AUTO;
    bat_error found = {.index = BAT_NO_INDEX};
    status = read_file(path, &options->limits, &format, &text, error);
    if (status == BAT_OK && options->boundary_path != NULL)
    {
        status = read_file(options->boundary_path, &options->limits, &boundary_format, &boundary_text, &found);
        if (status != BAT_OK)
            status = name_boundary_file(status, &found, error);
    }
    if (status == BAT_OK)
        status = cloud_text_read(&text, format, options->boundary_path != NULL ? &boundary_text : NULL, boundary_format,
                                 options, &made, error);
    file_text_free(&text);
    file_text_free(&boundary_text);
    if (status == BAT_OK && options->corners != NULL && made.boundary_count == 0)
        status = bat_cloud_find_boundary(&made, error);
    if (status == BAT_OK && options->corners != NULL)
        status = bat_cloud_set_corners(&made, options->corners, error);
    if (status == BAT_OK)
        *cloud = made;
    else
        bat_cloud_free(&made);
    return status;
}
