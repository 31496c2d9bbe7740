#include "base/atomic_file.h"
#include "base/choice.h"
#include "base/option.h"
#include "io/common/zip.h"
#include "io/mesh/formats.h"
#include "linalg/vector.h"

#include <unistd.h>

/// @file
/// Reading and writing of meshes in any format, from files and from memory.

/// A format: its reader, its writer, and whether a text begins as it does. What has no mark is OBJ.
typedef struct mesh_format
{
    bat_choice choice;
    mesh_reader *read;
    mesh_writer *write;
    mesh_recognizer *resembles;
    unsigned holds; ///< what a file of the format can hold
} mesh_format;

/// What a format can hold beside positions and faces.
enum
{
    HOLDS_TEXTURE = 1,
    HOLDS_VERTEX_TEXTURE = 2, ///< one texture coordinate for each vertex
    HOLDS_COLOURS = 4,
    HOLDS_CHANNELS = 8,
    HOLDS_CREASES = 16,
    HOLDS_LABELS = 32,
    HOLDS_SMOOTHING = 64,
    HOLDS_MATERIALS = 128, ///< material_json
    HOLDS_NORMALS = 256,
    HOLDS_POLYGONS = 512
};

static const mesh_format FORMATS[] = {
    {.choice = CHOICE_OF_USE(UNLISTED, "auto", "by the file's ending", BAT_MESH_FORMAT_AUTO)},
    {CHOICE_FORMAT("obj", "meshes: with texture coordinates, creases and corners", ".obj", BAT_MESH_FORMAT_OBJ),
     mesh_obj_read, mesh_obj_write, NULL,
     HOLDS_TEXTURE | HOLDS_COLOURS | HOLDS_CREASES | HOLDS_LABELS | HOLDS_SMOOTHING | HOLDS_NORMALS | HOLDS_POLYGONS},
    {CHOICE_FORMAT("ply", "meshes: binary or text, with values at the vertices", ".ply", BAT_MESH_FORMAT_PLY), mesh_ply_read,
     mesh_ply_write, mesh_ply_resembles,
     HOLDS_TEXTURE | HOLDS_COLOURS | HOLDS_CHANNELS | HOLDS_LABELS | HOLDS_SMOOTHING | HOLDS_NORMALS | HOLDS_POLYGONS},
    {CHOICE_FORMAT("off", "meshes: text, with colours", ".off", BAT_MESH_FORMAT_OFF), mesh_off_read, mesh_off_write,
     mesh_off_resembles, HOLDS_VERTEX_TEXTURE | HOLDS_COLOURS | HOLDS_POLYGONS},
    {CHOICE_FORMAT("stl", "meshes: separate triangles in single precision", ".stl", BAT_MESH_FORMAT_STL), mesh_stl_read,
     mesh_stl_write, mesh_stl_resembles, 0},
    {CHOICE_FORMAT("gltf", "meshes: glTF 2.0 as JSON, with materials", ".gltf", BAT_MESH_FORMAT_GLTF), mesh_gltf_read,
     mesh_gltf_write, mesh_gltf_resembles,
     HOLDS_TEXTURE | HOLDS_COLOURS | HOLDS_LABELS | HOLDS_SMOOTHING | HOLDS_MATERIALS | HOLDS_NORMALS},
    {CHOICE_FORMAT("glb", "meshes: glTF 2.0 as a binary file, with materials", ".glb", BAT_MESH_FORMAT_GLB), mesh_gltf_read,
     mesh_glb_write, mesh_glb_resembles,
     HOLDS_TEXTURE | HOLDS_COLOURS | HOLDS_LABELS | HOLDS_SMOOTHING | HOLDS_MATERIALS | HOLDS_NORMALS},
#ifdef BATTEN_HAS_3MF
    {CHOICE_FORMAT("3mf", "meshes: 3MF for 3D printing, with objects and base materials", ".3mf", BAT_MESH_FORMAT_3MF),
     mesh_3mf_read, mesh_3mf_write, zip_resembles, HOLDS_LABELS | HOLDS_MATERIALS},
#endif
};

const bat_family bat_mesh_format_family = FAMILY("mesh format", FORMATS);

static const bat_choice ENCODINGS[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "binary", BAT_MESH_ENCODING_AUTO),
    CHOICE("binary", "little-endian", BAT_MESH_ENCODING_BINARY),
    CHOICE("big-endian", "the greater bytes first; PLY only", BAT_MESH_ENCODING_BIG_ENDIAN),
    CHOICE("text", "decimal numbers", BAT_MESH_ENCODING_TEXT),
};
const bat_family bat_mesh_encoding_family = FAMILY("encoding", ENCODINGS);

/// The row of a format other than BAT_MESH_FORMAT_AUTO.
static const mesh_format *row_of(bat_mesh_format format)
{
    return (const mesh_format *)(const void *)choice_of_value(&bat_mesh_format_family, (int)format);
}

/// The format of the options, else of a file's ending; BAT_MESH_FORMAT_AUTO for a name without one.
static bat_status format_for_path(const char *path, bool writes, bat_mesh_format wanted, bat_mesh_format *format,
                                  bat_error *error)
{
    const bat_choice *row = NULL;
    bat_status status = BAT_OK;
    if (wanted == BAT_MESH_FORMAT_AUTO)
        status = bat_choice_of_path(&bat_mesh_format_family, path, writes, &row, error);
    *format = row != NULL ? (bat_mesh_format)row->value : wanted;
    return status;
}

bat_mesh_read_options bat_mesh_read_defaults(void)
{
    return (bat_mesh_read_options){.format = BAT_MESH_FORMAT_AUTO, .weld = -1};
}

bat_mesh_write_options bat_mesh_write_defaults(void)
{
    return (bat_mesh_write_options){.format = BAT_MESH_FORMAT_AUTO, .encoding = BAT_MESH_ENCODING_BINARY};
}

static const option_field READ_FIELDS[] = {
    OPTION_FAMILY(bat_mesh_read_options, format, bat_mesh_format_family),
    OPTION_FIELD(bat_mesh_read_options, fill_holes, OPTION_SIZE, 0, BAT_MESH_MAX_HOLE),
    OPTION_FIELD(bat_mesh_read_options, weld, OPTION_NUMBER, -1, INFINITY),
};

const bat_options_table bat_mesh_read_fields = OPTIONS_TABLE(bat_mesh_read_options, READ_FIELDS, NULL);

static const option_field WRITE_FIELDS[] = {
    OPTION_FAMILY(bat_mesh_write_options, format, bat_mesh_format_family),
    OPTION_FAMILY(bat_mesh_write_options, encoding, bat_mesh_encoding_family),
    OPTION_THREADS(bat_mesh_write_options),
    OPTION_FAMILY(bat_mesh_write_options, normals, bat_mesh_normals_family),
};

const bat_options_table bat_mesh_write_fields = OPTIONS_TABLE(bat_mesh_write_options, WRITE_FIELDS, NULL);

/// The format whose signature a text has; BAT_MESH_FORMAT_AUTO for none. OBJ has no signature.
static bat_mesh_format format_of_text(const file_text *text)
{
    for (size_t i = 0; i < sizeof FORMATS / sizeof *FORMATS; i++)
        if (FORMATS[i].resembles != NULL && FORMATS[i].resembles(text))
            return (bat_mesh_format)FORMATS[i].choice.value;
    return BAT_MESH_FORMAT_AUTO;
}

/// Whether the first element of an OBJ text is a face.
static bool begins_with_face(const file_text *text)
{
    text_line line = text_line_start(text);
    while (text_line_next(text, &line))
        if (line.end - line.begin > 1 && (line.begin[1] == ' ' || line.begin[1] == '\t') &&
            (*line.begin == 'f' || *line.begin == 'l'))
            return *line.begin == 'f';
    return false;
}

bat_status bat_mesh_format_of_file(const char *path, bat_mesh_format *format, bat_error *error)
{
    const bat_choice *row;
    struct stat about;
    file_text text;
    (void)bat_choice_of_path(&bat_mesh_format_family, path, false, &row, NULL);
    *format = row != NULL ? (bat_mesh_format)row->value : BAT_MESH_FORMAT_AUTO;
    if (*format != BAT_MESH_FORMAT_AUTO && *format != BAT_MESH_FORMAT_OBJ)
        return BAT_OK;
    *format = BAT_MESH_FORMAT_AUTO;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode))
        return BAT_OK;
    bat_status status = file_text_read(path, NULL, &text, error);
    if (status != BAT_OK)
        return status == BAT_FILE_ACCESS ? BAT_OK : status;
    *format = format_of_text(&text);
    if (*format == BAT_MESH_FORMAT_AUTO && begins_with_face(&text))
        *format = BAT_MESH_FORMAT_OBJ;
    file_text_free(&text);
    return BAT_OK;
}

/// Choose the format of a text: that of the options, else by its signature, else by the file's ending, else OBJ.
static bat_status choose_format(const file_text *text, bat_mesh_format wanted, bat_mesh_format *format,
                                bat_mesh_notes *notes, bat_error *error)
{
    bat_mesh_format ending = *format, found = BAT_MESH_FORMAT_AUTO;
    *format = wanted != BAT_MESH_FORMAT_AUTO ? wanted : ending;
    if (wanted != BAT_MESH_FORMAT_AUTO ||
        (ending != BAT_MESH_FORMAT_AUTO && row_of(ending)->resembles != NULL && row_of(ending)->resembles(text)))
        return BAT_OK;
    found = format_of_text(text);
    if (ending == BAT_MESH_FORMAT_AUTO)
        *format = found != BAT_MESH_FORMAT_AUTO ? found : BAT_MESH_FORMAT_OBJ;
    if (ending == BAT_MESH_FORMAT_AUTO || found == BAT_MESH_FORMAT_AUTO || row_of(found)->read == row_of(ending)->read)
        return BAT_OK;
    *format = found;
    return mesh_note(notes, error, "the content is %s, not %s as the ending says; the named format %s would be insisted on",
                     row_of(found)->choice.name, row_of(ending)->choice.name, row_of(ending)->choice.name);
}

/// The distance by which to weld a mesh that was read; 0 for none.
static double weld_distance(const bat_mesh *mesh, bat_mesh_format format, bool repair, double wanted)
{
    static const double share = 1e-7; // of the diagonal: single precision
    bool soup = format != BAT_MESH_FORMAT_3MF && mesh->vertex_count == 3 * mesh->face_count && mesh->channel_count == 0;
    if (wanted >= 0 || (format != BAT_MESH_FORMAT_STL && !soup && !repair))
        return fmax(0, wanted);
    double low[3], high[3];
    box_of_points(3, mesh->positions, mesh->vertex_count, low, high);
    return share * vector3_distance(low, high);
}

/// Weld a mesh that was read. One whose triangles lose a corner stays, unless a repair follows or the distance was given.
static bat_status weld(bat_mesh_format format, const bat_mesh_read_options *options, bat_mesh *mesh, bat_mesh_notes *notes,
                       bat_error *error)
{
    double distance = mesh->offsets == NULL ? weld_distance(mesh, format, options->repair, options->weld) : 0;
    size_t merged;
    bat_mesh welded;
    if (!(distance > 0) || !isfinite(distance))
        return BAT_OK;
    bat_status status = bat_mesh_weld(mesh, distance, &merged, &welded, error);
    if (status != BAT_OK)
        return status;
    bool whole = options->weld >= 0 || options->repair || bat_mesh_check(&welded, NULL) == BAT_OK;
    bat_mesh_free(whole ? mesh : &welded);
    if (!whole)
        return BAT_OK;
    *mesh = welded;
    return merged > 0 ? mesh_note(notes, error, "%zu vertices were joined with others within %.3g; weld 0 keeps them apart",
                                  merged, distance)
                      : BAT_OK;
}

/// Note each kind of repair.
static bat_status note_repairs(const bat_mesh_repair_report *report, bat_mesh_notes *notes, bat_error *error)
{
    const struct
    {
        size_t count;
        const char *what;
    } parts[] = {{report->degenerate_faces, "faces with a vertex twice were dropped"},
                 {report->duplicate_faces, "repeated faces were dropped"},
                 {report->flipped_faces, "faces were turned over"},
                 {report->nonmanifold_edges, "edges of more than two faces were cut"},
                 {report->unorientable_edges, "edges whose faces cannot be oriented alike were cut"},
                 {report->split_vertices, "vertices of several fans were split"},
                 {report->unused_vertices, "vertices without a face were dropped"},
                 {report->filled_holes, "holes were filled"}};
    bat_status status = BAT_OK;
    for (size_t i = 0; i < sizeof parts / sizeof *parts && status == BAT_OK; i++)
        if (parts[i].count > 0)
            status = mesh_note(notes, error, "repaired: %zu %s", parts[i].count, parts[i].what);
    return status;
}

/// Whether a mesh of triangles is no manifold of triangles with three different vertices.
static bool is_broken(const bat_mesh *mesh)
{
    bat_mesh_connectivity links;
    bat_status status = mesh->offsets == NULL ? bat_mesh_connect(mesh, &links, NULL) : BAT_UNSUPPORTED;
    if (status == BAT_OK)
        bat_mesh_connectivity_free(&links);
    return status == BAT_NOT_MANIFOLD || status == BAT_INVALID_POINT;
}

/// Repair a mesh that was read, and fill its holes.
static bat_status repair(const bat_mesh_read_options *options, bat_mesh *mesh, bat_mesh_repair_report *report,
                         bat_mesh_notes *notes, bat_error *error)
{
    bat_mesh made;
    if (!options->repair && (options->strict || options->keep_degenerate || !is_broken(mesh)))
        return BAT_OK;
    bat_status status = bat_mesh_repair(mesh, report, &made, error);
    if (status != BAT_OK)
        return status;
    bat_mesh_free(mesh);
    *mesh = made;
    if (options->fill_holes > 0)
        status = bat_mesh_fill_holes(mesh, options->fill_holes, &report->filled_holes, &made, error);
    if (status == BAT_OK && options->fill_holes > 0)
    {
        bat_mesh_free(mesh);
        *mesh = made;
    }
    return status == BAT_OK ? note_repairs(report, notes, error) : status;
}

/// Read a mesh whose file's ending stands for `format`, weld it, and repair it where that is asked for or harmless.
static bat_status read_text(const file_text *text, bat_mesh_format format, const bat_mesh_read_options *given,
                            bat_mesh *mesh, bat_error *error)
{
    bat_mesh_read_options options = *given, lenient;
    bat_mesh_repair_report report = {0};
    bat_mesh_notes notes = {0};
    bat_mesh read = {0};
    options.repair = given->repair || given->fill_holes > 0;
    lenient = options;
    lenient.keep_degenerate = options.keep_degenerate || options.repair || !options.strict;
    lenient.notes = options.notes != NULL ? &notes : NULL;
    bat_status status = choose_format(text, options.format, &format, lenient.notes, error);
    if (status == BAT_OK)
        status = row_of(format)->read(text, &lenient, &read, error);
    if (status == BAT_OK)
        status = weld(format, &options, &read, lenient.notes, error);
    if (status == BAT_OK)
        status = repair(&options, &read, &report, lenient.notes, error);
    if (status == BAT_OK)
        status = mesh_notes_move(&notes, options.notes, error);
    bat_mesh_notes_free(&notes);
    if (status != BAT_OK)
    {
        bat_mesh_free(&read);
        return status;
    }
    *mesh = read;
    if (options.repairs != NULL)
        *options.repairs = report;
    return BAT_OK;
}

/// Read a file, or `size` bytes where the path is null.
static bat_status read_mesh(const char *path, const void *bytes, size_t size, const bat_mesh_read_options *options,
                            bat_mesh *mesh, bat_error *error)
{
    bat_mesh_read_options defaults = bat_mesh_read_defaults();
    options = options != NULL ? options : &defaults;
    file_text text;
    bat_mesh_format format = BAT_MESH_FORMAT_AUTO;
    bat_status status = bat_options_check(&bat_mesh_read_fields, options, error);
    if (status == BAT_OK && path != NULL)
        status = format_for_path(path, false, options->format, &format, error);
    if (status == BAT_OK)
        status = path != NULL ? file_text_read(path, &options->limits, &text, error)
                              : file_text_copy(bytes, size, &options->limits, &text, error);
    if (status != BAT_OK)
        return status;
    status = read_text(&text, format, options, mesh, error);
    file_text_free(&text);
    return status;
}

bat_status bat_mesh_read(const char *path, const bat_mesh_read_options *options, bat_mesh *mesh, bat_error *error)
{
    return read_mesh(path, NULL, 0, options, mesh, error);
}

bat_status bat_mesh_read_memory(const void *bytes, size_t size, const bat_mesh_read_options *options, bat_mesh *mesh,
                                bat_error *error)
{
    return read_mesh(NULL, bytes, size, options, mesh, error);
}

static bat_status check_write(bat_mesh_format format, const bat_mesh_write_options *options, bat_error *error)
{
    bat_status status = bat_options_check(&bat_mesh_write_fields, options, error);
    if (status != BAT_OK)
        return status;
    if (format == BAT_MESH_FORMAT_AUTO)
        return choice_unnamed_output(&bat_mesh_format_family, error);
    if (options->encoding == BAT_MESH_ENCODING_BIG_ENDIAN && format != BAT_MESH_FORMAT_PLY)
        return ERROR_ARGUMENT(error, "only PLY supports the big-endian encoding");
    if (options->lod_count > 0 && format != BAT_MESH_FORMAT_GLTF && format != BAT_MESH_FORMAT_GLB)
        return ERROR_ARGUMENT(error, "only glTF holds levels of detail");
    for (size_t i = 0; i < options->lod_count && status == BAT_OK; i++)
        status = options->lods[i].offsets == NULL ? bat_mesh_check(&options->lods[i], error)
                                                  : error_option(error, "lods", "must be triangles");
    return status;
}

/// Note what a mesh has and a format cannot hold.
static bat_status note_losses(const bat_mesh *mesh, const mesh_format *row, const bat_mesh_write_options *options,
                              bat_mesh_notes *notes, bat_error *error)
{
    size_t places[MESH_COLOURS], colours = mesh_colours(mesh, places);
    bool smoothing = false, names = false;
    for (size_t i = 0; i < mesh->label_count && mesh->face_labels != NULL; i++)
    {
        const bat_mesh_label *label = &mesh->labels[i];
        smoothing = smoothing || label->smoothing != NULL;
        names = names || label->object != NULL || label->group != NULL || label->material != NULL;
    }
    const struct
    {
        bool there;
        unsigned holds;
        const char *what;
    } parts[] = {
        {mesh->texture_faces != NULL, HOLDS_TEXTURE | (mesh_texture_by_vertex(mesh) ? (unsigned)HOLDS_VERTEX_TEXTURE : 0),
         "texture coordinates"},
        {colours > 0, HOLDS_COLOURS, "colours"},
        {mesh->channel_count > colours, HOLDS_CHANNELS, "numbers at the vertices other than colours"},
        {mesh->crease_count > 0 || mesh->corner_count > 0, HOLDS_CREASES, "creases and corners"},
        {names, HOLDS_LABELS, "names of objects, groups and materials"},
        {smoothing, HOLDS_SMOOTHING, "smoothing groups"},
        {mesh->material_files != NULL, HOLDS_LABELS, "files of materials"},
        {mesh->material_json != NULL, HOLDS_MATERIALS, "the properties of materials"},
        {options->normals != BAT_MESH_NORMALS_NONE || options->vertex_normals != NULL, HOLDS_NORMALS, "vertex normals"},
    };
    bat_status status = BAT_OK;
    for (size_t i = 0; i < sizeof parts / sizeof *parts && status == BAT_OK; i++)
        if (parts[i].there && (parts[i].holds & row->holds) == 0)
            status = mesh_note(notes, error, "the output lacks %s: %s does not hold them", parts[i].what, row->choice.name);
    return status;
}

/// The normals to write, in a new array.
static bat_status make_normals(const bat_mesh *mesh, const bat_mesh_write_options *options, double **normals,
                               bat_error *error)
{
    if (array_make(normals, mesh->vertex_count, 3 * sizeof **normals, error) != BAT_OK)
        return BAT_NO_MEMORY;
    bat_mesh_normals weights = options->normals != BAT_MESH_NORMALS_NONE ? options->normals : BAT_MESH_NORMALS_ANGLE;
    bat_status status = bat_mesh_vertex_normals(mesh, weights, *normals, error);
    for (size_t v = 0; v < mesh->vertex_count && options->vertex_normals != NULL && status == BAT_OK; v++)
    {
        const double *given = options->vertex_normals + 3 * v;
        if (!isfinite(given[0]) || !isfinite(given[1]) || !isfinite(given[2]))
            status = error_set(error, BAT_INVALID_POINT, v, 0, "the normal of vertex %zu is not finite", v);
        if (given[0] != 0 || given[1] != 0 || given[2] != 0)
            memcpy(*normals + 3 * v, given, 3 * sizeof *given);
    }
    return status;
}

/// Write a checked mesh to a sink, and cut polygons into triangles where the format or the normals need them.
static bat_status write_checked(const bat_mesh *mesh, bat_mesh_format format, const bat_mesh_write_options *options,
                                text_sink *sink, bat_error *error)
{
    const mesh_format *row = row_of(format);
    bool with_normals =
        (options->normals != BAT_MESH_NORMALS_NONE || options->vertex_normals != NULL) && (row->holds & HOLDS_NORMALS) != 0;
    bool polygons = (row->holds & HOLDS_POLYGONS) != 0, cut = mesh->offsets != NULL && (with_normals || !polygons);
    bat_mesh_write_options complete = *options;
    bat_mesh_notes notes = {0};
    bat_mesh made = {0};
    double *normals = NULL;
    complete.notes = options->notes != NULL ? &notes : NULL;
    bat_status status = cut ? bat_mesh_triangulate(mesh, &made, error) : BAT_OK;
    const bat_mesh *triangles = cut ? &made : mesh, *written = polygons ? mesh : triangles;
    if (status == BAT_OK)
        status = note_losses(mesh, row, options, complete.notes, error);
    if (status == BAT_OK && written->face_count > mesh->face_count)
        status = mesh_note(complete.notes, error, "the output has triangles: %s does not hold polygons", row->choice.name);
    if (status == BAT_OK && with_normals)
        status = make_normals(triangles, options, &normals, error);
    complete.vertex_normals = normals;
    if (status == BAT_OK)
        status = row->write(written, &complete, sink, error);
    if (status == BAT_OK)
        status = mesh_notes_move(&notes, options->notes, error);
    bat_mesh_notes_free(&notes);
    bat_mesh_free(&made);
    free(normals);
    return status;
}

/// Whether a file is named so by a file at `path`: in its folder, unless the name is absolute. True when out of memory.
static bool is_beside(const char *path, const char *name, size_t size)
{
    const char *slash = strrchr(path, '/');
    text_buffer whole = {0};
    if (slash != NULL && *name != '/')
        text_append(&whole, path, (size_t)(slash + 1 - path));
    text_append(&whole, name, size);
    text_append(&whole, "", 1);
    bool found = whole.failed || access(whole.data, F_OK) == 0;
    text_free(&whole);
    return found;
}

/// Note the first file of materials that an OBJ file names and that is missing beside it. A name may contain blanks.
static bat_status note_materials(const char *path, const char *names, bat_mesh_notes *notes, bat_error *error)
{
    static const char blanks[] = " \t";
    if (notes == NULL || strcmp(path, "-") == 0 || is_beside(path, names, strlen(names)))
        return BAT_OK;
    for (const char *name = names + strspn(names, blanks); *name != '\0'; name += strspn(name, blanks))
    {
        size_t size = strcspn(name, blanks);
        char excerpt[EXCERPT_SIZE];
        if (!is_beside(path, name, size))
            return mesh_note(notes, error, "the output names the materials '%s', a file that is not in its folder: copy it",
                             text_excerpt(excerpt, name, name + size));
        name += size;
    }
    return BAT_OK;
}

bat_status bat_mesh_write(const char *path, const bat_mesh *mesh, const bat_mesh_write_options *options, bat_error *error)
{
    bat_mesh_write_options defaults = bat_mesh_write_defaults();
    bat_mesh_format format;
    atomic_file file;
    options = options != NULL ? options : &defaults;
    bat_status status = bat_mesh_check(mesh, error);
    if (status == BAT_OK)
        status = format_for_path(path, true, options->format, &format, error);
    if (status == BAT_OK)
        status = check_write(format, options, error);
    if (status == BAT_OK)
        status = atomic_file_begin(path, &file, error);
    if (status != BAT_OK)
        return status;
    text_sink sink = {.stream = file.stream};
    status = write_checked(mesh, format, options, &sink, error);
    if (status == BAT_OK && format == BAT_MESH_FORMAT_OBJ && mesh->material_files != NULL)
        status = note_materials(path, mesh->material_files, options->notes, error);
    return atomic_file_end(&file, status, error);
}

bat_status bat_mesh_write_memory(const bat_mesh *mesh, const bat_mesh_write_options *options, char **bytes, size_t *size,
                                 bat_error *error)
{
    bat_mesh_write_options defaults = bat_mesh_write_defaults();
    options = options != NULL ? options : &defaults;
    bat_status status = bat_mesh_check(mesh, error);
    if (status == BAT_OK)
        status = check_write(options->format, options, error);
    if (status != BAT_OK)
        return status;
    text_buffer buffer = {0};
    text_sink sink = {.buffer = &buffer};
    status = write_checked(mesh, options->format, options, &sink, error);
    text_append(&buffer, "", 1);
    if (status == BAT_OK && buffer.failed)
        status = error_memory(error, buffer.size);
    if (status != BAT_OK)
    {
        text_free(&buffer);
        return status;
    }
    *bytes = buffer.data;
    *size = buffer.size - 1;
    return BAT_OK;
}
