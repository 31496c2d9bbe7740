#include "io/mesh/builder.h"
#include "mesh/sides.h"

#include <math.h>

/// @file
/// Wavefront OBJ: vertices, texture coordinates, faces and colours, with the crease and corner tags of OpenSubdiv.

// Names in OBJ: the rest of the line, without blanks at both ends; a '#' after a blank begins a comment.

#define OBJ_UNUSED_WORDS 6

/// What these statements told so far. All zero: nothing.
typedef struct obj_labels
{
    label_name names[MESH_LABEL_NAMES]; ///< of the faces that follow
    bool changed;                       ///< since the last face
    text_buffer files;                  ///< of `mtllib`
    size_t normals;                     ///< `vn` statements
    label_name unused[OBJ_UNUSED_WORDS];
    size_t unused_count; ///< of different words of statements that are left out; the first ones are in `unused`
} obj_labels;

/// The statements, in the order of mesh_label_name().
static const char *const WORDS[MESH_LABEL_NAMES] = {"o", "g", "usemtl", "s"};

static const int SMOOTHING = 3;

static label_name rest_of_line(word_scan *scan)
{
    scan_skip_blanks(scan);
    const char *begin = scan->at, *end = begin;
    for (; scan->at < scan->end && *scan->at != '\n'; scan->at++)
    {
        if (*scan->at == '#' && end < scan->at)
            break;
        if (!text_is_blank(*scan->at))
            end = scan->at + 1;
    }
    size_t size = (size_t)(end - begin);
    return (label_name){size > 0 && *begin != '#' ? begin : NULL, size > 0 && *begin != '#' ? size : 0};
}

/// Remember the word of a statement that is left out.
static void add_unused(obj_labels *labels, label_name word)
{
    size_t kept = labels->unused_count < OBJ_UNUSED_WORDS ? labels->unused_count : OBJ_UNUSED_WORDS;
    for (size_t i = 0; i < kept; i++)
        if (label_names_equal(labels->unused[i], word))
            return;
    if (kept < OBJ_UNUSED_WORDS)
        labels->unused[kept] = word;
    labels->unused_count = kept + 1;
}

/// Read a statement with a word that is none of vertices and faces.
static void obj_labels_read(obj_labels *labels, word_scan *scan)
{
    label_name word = {scan->at, (size_t)(scan_word_end(scan) - scan->at)};
    scan->at += word.size;
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
    {
        if (!label_name_is(word, WORDS[k]))
            continue;
        label_name name = rest_of_line(scan);
        if (k == SMOOTHING && (label_name_is(name, "off") || label_name_is(name, "0")))
            name = (label_name){0};
        labels->names[k] = name;
        labels->changed = true;
        return;
    }
    if (label_name_is(word, "mtllib"))
    {
        label_name files = rest_of_line(scan);
        if (labels->files.size > 0)
            text_append(&labels->files, " ", 1);
        text_append(&labels->files, files.begin, files.size);
    }
    else if (label_name_is(word, "vn"))
        labels->normals++;
    else if (word.size > 0)
        add_unused(labels, word);
}

/// Give the builder the files of materials, and note what is left out.
static bat_status obj_labels_finish(obj_labels *labels, mesh_builder *builder, bat_mesh_notes *notes, bat_error *error)
{
    bat_status status = BAT_OK;
    if (labels->files.size > 0)
        builder->mesh.material_files = label_name_copy((label_name){labels->files.data, labels->files.size});
    if (labels->files.failed || (labels->files.size > 0 && builder->mesh.material_files == NULL))
        return error_memory(error, labels->files.size);
    if (labels->normals > 0)
        status = mesh_note(notes, error, MESH_NORMALS_LEFT_OUT, labels->normals);
    if (labels->unused_count == 0 || status != BAT_OK)
        return status;
    char list[OBJ_UNUSED_WORDS * EXCERPT_SIZE + 8] = "";
    size_t used = 0;
    for (size_t i = 0; i < labels->unused_count && i < OBJ_UNUSED_WORDS; i++)
    {
        char word[EXCERPT_SIZE];
        const label_name *name = &labels->unused[i];
        (void)text_excerpt(word, name->begin, name->begin + name->size);
        used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", i > 0 ? ", " : "", word);
    }
    return mesh_note(notes, error, "statements that a mesh does not hold are left out: %s%s", list,
                     labels->unused_count > OBJ_UNUSED_WORDS ? ", ..." : "");
}

/// Check that OBJ can hold the names of a mesh.
/// @return BAT_OK or BAT_UNSUPPORTED
static bat_status obj_labels_check(const bat_mesh *mesh, bat_error *error)
{
    char excerpt[EXCERPT_SIZE];
    for (size_t i = 0; i < mesh->label_count; i++)
        for (int k = 0; k < MESH_LABEL_NAMES; k++)
        {
            const char *name = mesh_label_text(&mesh->labels[i], k);
            if (name != NULL && strpbrk(name, "\n\r") != NULL)
                return ERROR_UNSUPPORTED(error, 0, "OBJ cannot hold the name '%s' with a line break",
                                         text_excerpt(excerpt, name, name + strlen(name)));
        }
    return BAT_OK;
}

/// Append the statements in which the label of a face differs from that of the face before it.
static void obj_labels_write(const bat_mesh *mesh, size_t face, text_buffer *text)
{
    static const bat_mesh_label none = {0};
    const uint32_t *labels = mesh->face_labels;
    if (labels == NULL || (face > 0 && labels[face] == labels[face - 1]))
        return;
    const bat_mesh_label *now = &mesh->labels[labels[face]], *before = face > 0 ? &mesh->labels[labels[face - 1]] : &none;
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
    {
        const char *name = mesh_label_text(now, k);
        if (mesh_text_equals(name, mesh_label_text(before, k)))
            continue;
        text_append_string(text, WORDS[k]);
        text_append(text, " ", name != NULL || k == SMOOTHING);
        text_append_string(text, name != NULL ? name : k == SMOOTHING ? "off" : "");
        text_append(text, "\n", 1);
    }
}

typedef struct obj_reader
{
    mesh_builder builder;
    word_scan scan;
    obj_labels labels;
    size_t colours; ///< the number of colour values of every vertex
    bool lenient;   ///< numbers need not be finite
} obj_reader;

/// BAT_BAD_FILE at the current line, for the vertex or face of this index.
static bat_status fault(const obj_reader *reader, size_t index, const char *text, bat_error *error)
{
    return error_set(error, BAT_BAD_FILE, index, reader->scan.line, "%s", text);
}

/// Read all numbers of the line, at least `min_count` and at most `max_count`. Where `lenient`, they need not be finite.
static bat_status read_numbers(obj_reader *reader, size_t index, size_t min_count, size_t max_count, double *numbers,
                               size_t *count, const char *what, bat_error *error)
{
    for (*count = 0; !scan_line_done(&reader->scan); ++*count)
    {
        if (*count == max_count)
            return fault(reader, index, what, error);
        if (!scan_number(&reader->scan, &numbers[*count]) &&
            !(reader->lenient && scan_not_finite(&reader->scan, &numbers[*count])))
            return scan_number_fault(&reader->scan, index, what, error);
    }
    return *count < min_count ? fault(reader, index, what, error) : BAT_OK;
}

#define MAX_NUMBERS 7 ///< of a statement

/// Read `v x y z` or `v x y z w`, or with a colour `v x y z r g b` or, as MeshLab writes it, `v x y z r g b a`.
static bat_status read_vertex(obj_reader *reader, bat_error *error)
{
    static const char expected[] = "a vertex has 3 coordinates, optionally with a weight or with a colour of 3 or 4 numbers";
    mesh_builder *builder = &reader->builder;
    size_t count, index = builder->mesh.vertex_count;
    double numbers[MAX_NUMBERS];
    bat_status status = read_numbers(reader, index, 3, MAX_NUMBERS, numbers, &count, expected, error);
    if (status != BAT_OK)
        return status;
    if (count == 5)
        return fault(reader, index, expected, error);
    size_t colours = count > 5 ? count - 3 : 0;
    if (index == 0 && colours > 0)
    {
        reader->colours = colours;
        if (!channels_set_names(&builder->mesh, mesh_colour_names, colours))
            return mesh_builder_no_memory(&reader->builder, error);
    }
    if (colours != reader->colours)
        return fault(reader, index, "the vertex has another number of colour values than those before it", error);
    double *position = mesh_builder_vertex(builder);
    if (position == NULL)
        return mesh_builder_no_memory(&reader->builder, error);
    memcpy(position, numbers, 3 * sizeof *position);
    if (colours == 0)
        return BAT_OK;
    double *channels = mesh_builder_channels(builder);
    if (channels == NULL)
        return mesh_builder_no_memory(&reader->builder, error);
    memcpy(channels, numbers + 3, colours * sizeof *channels);
    return BAT_OK;
}

/// Read `vt u [v [w]]`; w is ignored.
static bat_status read_texture(obj_reader *reader, bat_error *error)
{
    size_t count, index = reader->builder.mesh.texture_count;
    double numbers[3] = {0};
    bat_status status = read_numbers(reader, index, 1, 3, numbers, &count, "a texture coordinate has 1 to 3 numbers", error);
    if (status != BAT_OK)
        return status;
    double *texture = mesh_builder_texture(&reader->builder);
    if (texture == NULL)
        return mesh_builder_no_memory(&reader->builder, error);
    memcpy(texture, numbers, 2 * sizeof *texture);
    return BAT_OK;
}

/// Read an index. It counts from 1 or, when negative, backwards from the last of `count`. Returns null, or an error text.
static const char *read_index(word_scan *scan, size_t count, uint32_t *index)
{
    bool negative = scan->at < scan->end && *scan->at == '-';
    uint64_t value;
    scan->at += negative;
    if (!scan_digits_below(scan, BAT_MESH_NONE, &value))
        return "is not v, v/vt, v//vn or v/vt/vn";
    if (value == 0)
        return "has an index of 0, but indices count from 1";
    if (negative && value > count)
        return "reaches back beyond the first";
    *index = (uint32_t)(negative ? count - value : value - 1);
    return NULL;
}

static bool skip_slash(word_scan *scan)
{
    bool slash = scan->at < scan->end && *scan->at == '/';
    scan->at += slash;
    return slash;
}

/// Read `v`, `v/vt`, `v//vn` or `v/vt/vn`; normals are ignored, and slashes may end a corner. Returns null, or an error
/// text.
static const char *read_corner(obj_reader *reader, uint32_t *vertex, uint32_t *texture)
{
    word_scan *scan = &reader->scan;
    uint32_t normal;
    *texture = BAT_MESH_NONE;
    const char *wrong = read_index(scan, reader->builder.mesh.vertex_count, vertex);
    if (wrong == NULL && skip_slash(scan) && !scan_word_ends(scan, scan->at))
    {
        bool skips = skip_slash(scan);
        if (!skips)
            wrong = read_index(scan, reader->builder.mesh.texture_count, texture);
        if (wrong == NULL && (skips || skip_slash(scan)) && !scan_word_ends(scan, scan->at))
            wrong = read_index(scan, BAT_MESH_NONE, &normal);
    }
    if (wrong == NULL && !scan_word_ends(scan, scan->at))
        wrong = "is not v, v/vt, v//vn or v/vt/vn";
    return wrong;
}

static bat_status read_face(obj_reader *reader, bat_error *error)
{
    mesh_builder *builder = &reader->builder;
    size_t size = 0, index = builder->mesh.face_count;
    bool textured = false;
    if (reader->labels.changed && !mesh_builder_label(builder, reader->labels.names))
        return mesh_builder_no_memory(&reader->builder, error);
    reader->labels.changed = false;
    for (; !scan_line_done(&reader->scan); size++)
    {
        uint32_t vertex, texture;
        const char *begin = reader->scan.at, *wrong = read_corner(reader, &vertex, &texture);
        if (wrong == NULL && size > 0 && textured != (texture != BAT_MESH_NONE))
            wrong = "and the corner before it: only one of them has a texture coordinate";
        if (wrong != NULL)
        {
            reader->scan.at = begin;
            return scan_word_fault(&reader->scan, index, wrong, error);
        }
        textured = texture != BAT_MESH_NONE;
        if (!mesh_builder_corner(builder, vertex, texture))
            return mesh_builder_no_memory(&reader->builder, error);
    }
    if (size < 3)
        return fault(reader, index, "a face needs at least 3 corners", error);
    if (size >= BAT_MESH_NONE)
        return error_set(error, BAT_TOO_LARGE, index, reader->scan.line, "the face has too many corners");
    return mesh_builder_end_face(builder, (uint32_t)size) ? BAT_OK : mesh_builder_no_memory(&reader->builder, error);
}

/// Read the counts of a tag, `integers/floats/strings`. False when they are invalid.
static bool read_counts(word_scan *scan, uint64_t counts[3])
{
    static const uint64_t max_count = UINT32_MAX;
    scan_skip_blanks(scan);
    return scan_digits_below(scan, max_count, &counts[0]) && skip_slash(scan) &&
           scan_digits_below(scan, max_count, &counts[1]) && skip_slash(scan) &&
           scan_digits_below(scan, max_count, &counts[2]) && scan_word_ends(scan, scan->at);
}

/// Read a vertex of a tag. It counts from 0 and must be defined above.
static bat_status read_vertex_number(obj_reader *reader, word_scan *scan, uint32_t *vertex, bat_error *error)
{
    uint64_t value;
    if (!scan_count(scan, reader->builder.mesh.vertex_count, &value))
        return scan_word_fault(scan, BAT_NO_INDEX, "is not the number, from 0, of a vertex above", error);
    *vertex = (uint32_t)value;
    return BAT_OK;
}

/// Read the creases or corners of a tag with valid counts.
static bat_status read_marks(obj_reader *reader, bool crease, const uint64_t counts[3], bat_error *error)
{
    mesh_builder *builder = &reader->builder;
    word_scan values = reader->scan; // the values of sharpness follow all vertices
    uint64_t step = crease ? 2 : 1;
    uint32_t vertices[2] = {0};
    double sharpness = 0.0;
    bat_status status = BAT_OK;
    for (uint64_t i = 0; i < counts[0] && status == BAT_OK; i++)
        status = read_vertex_number(reader, &values, vertices, error);
    for (uint64_t i = 0; i < counts[0] / step && status == BAT_OK; i++)
    {
        for (uint64_t k = 0; k < step && status == BAT_OK; k++)
            status = read_vertex_number(reader, &reader->scan, &vertices[k], error);
        word_scan value = values;
        if (i < counts[1] && (!scan_number(&values, &sharpness) || sharpness < 0))
            return scan_word_fault(&value, BAT_NO_INDEX, "is not a sharpness of 0 or more", error);
        if (crease && vertices[0] == vertices[1])
            return fault(reader, BAT_NO_INDEX, "a crease joins a vertex with itself", error);
        bool added = crease ? mesh_builder_crease(builder, (bat_mesh_crease){vertices[0], vertices[1], sharpness})
                            : mesh_builder_mark(builder, (bat_mesh_corner){vertices[0], sharpness});
        if (!added)
            return mesh_builder_no_memory(&reader->builder, error);
    }
    reader->scan = values;
    return status;
}

/// What the numbers of the tags `interpolateboundary` and `facevaryinginterpolateboundary` mean.
static const bat_mesh_boundary BOUNDARY_TAGS[] = {BAT_MESH_BOUNDARY_NONE, BAT_MESH_BOUNDARY_CORNERS,
                                                  BAT_MESH_BOUNDARY_EDGES};
static const bat_mesh_linear LINEAR_TAGS[] = {BAT_MESH_LINEAR_NONE,          BAT_MESH_LINEAR_CORNERS,
                                              BAT_MESH_LINEAR_CORNERS_PLUS1, BAT_MESH_LINEAR_CORNERS_PLUS2,
                                              BAT_MESH_LINEAR_BOUNDARIES,    BAT_MESH_LINEAR_ALL};

/// Read a rule of refinement, whose name is at the scan: `1/0/0` and a number follow, or `0/0/1` and a word.
static bat_status read_rule(obj_reader *reader, bat_error *error)
{
    word_scan *scan = &reader->scan;
    bat_mesh_rules *rules = &reader->builder.mesh.rules;
    uint64_t number, counts[3];
    bool boundary = scan_word(scan, "interpolateboundary");
    bool linear = !boundary && scan_word(scan, "facevaryinginterpolateboundary");
    if (boundary || linear || scan_word(scan, "facevaryingpropagatecorners"))
    {
        size_t count = boundary ? sizeof BOUNDARY_TAGS / sizeof *BOUNDARY_TAGS
                       : linear ? sizeof LINEAR_TAGS / sizeof *LINEAR_TAGS
                                : 2;
        if (!read_counts(scan, counts) || counts[0] != 1 || counts[1] + counts[2] != 0)
            return fault(reader, BAT_NO_INDEX, "a rule is followed by 1/0/0 and a whole number", error);
        if (!scan_count(scan, count, &number))
            return scan_word_fault(scan, BAT_NO_INDEX, "is not a known number of this rule", error);
        if (boundary)
            rules->boundary = BOUNDARY_TAGS[number];
        else if (linear || number == 1)
            rules->linear = linear ? LINEAR_TAGS[number] : BAT_MESH_LINEAR_CORNERS_PLUS2;
        return BAT_OK;
    }
    if (scan_word(scan, "creasemethod"))
    {
        bool good = read_counts(scan, counts) && counts[0] + counts[1] == 0 && counts[2] == 1;
        bool chaikin = good && scan_word(scan, "chaikin");
        if (!good || (!chaikin && !scan_word(scan, "normal")))
            return fault(reader, BAT_NO_INDEX, "'creasemethod' is followed by 0/0/1 and 'normal' or 'chaikin'", error);
        rules->creasing = chaikin ? BAT_MESH_CREASING_CHAIKIN : BAT_MESH_CREASING_UNIFORM;
        return BAT_OK;
    }
    return scan_word_fault(scan, BAT_NO_INDEX, "is a tag of subdivision that is not supported", error);
}

/// Read OpenSubdiv's tags `t crease 2/1/0 a b sharpness` and `t corner 1/1/0 v sharpness`, with vertices from 0, and the
/// rules of refinement. A tag of creases or corners may hold several, with one value of sharpness for all or for each.
static bat_status read_tag(obj_reader *reader, bat_error *error)
{
    uint64_t counts[3];
    bool crease = scan_word(&reader->scan, "crease");
    uint64_t step = crease ? 2 : 1;
    bat_status status = BAT_OK;
    if (!crease && !scan_word(&reader->scan, "corner"))
        status = read_rule(reader, error);
    else if (!read_counts(&reader->scan, counts) || counts[0] == 0 || counts[0] % step != 0 ||
             (counts[1] != 1 && counts[1] != counts[0] / step) || counts[2] != 0)
        return fault(reader, BAT_NO_INDEX,
                     crease ? "a crease is 'crease 2/1/0', two vertices and a sharpness"
                            : "a corner is 'corner 1/1/0', a vertex and a sharpness",
                     error);
    else
        status = read_marks(reader, crease, counts, error);
    if (status == BAT_OK && !scan_line_done(&reader->scan))
        status = scan_word_fault(&reader->scan, BAT_NO_INDEX, "exceeds the counts of the tag", error);
    return status;
}

static bat_status read_statement(obj_reader *reader, bat_error *error)
{
    word_scan *scan = &reader->scan;
    if (scan_line_done(scan))
        return BAT_OK;
    if (scan_word(scan, "v"))
        return read_vertex(reader, error);
    if (scan_word(scan, "f"))
        return read_face(reader, error);
    if (scan_word(scan, "t"))
        return read_tag(reader, error);
    if (scan_word(scan, "vt"))
        return read_texture(reader, error);
    obj_labels_read(&reader->labels, scan);
    return BAT_OK;
}

/// The size of a break of the line within a statement: a backslash at the end of a line that is no comment. 0 for none.
static size_t continuation_at(const char *at, const char *end, const char *line)
{
    size_t size = *at != '\\' || end - at < 2                      ? 0
                  : at[1] == '\n'                                  ? 2
                  : end - at > 2 && at[1] == '\r' && at[2] == '\n' ? 3
                                                                   : 0;
    while (line < at && (*line == ' ' || *line == '\t'))
        line++;
    return *line == '#' ? 0 : size;
}

/// Join lines that a backslash continues. The breaks follow at the end of the joined line, so that later lines keep their
/// numbers. `*joined` stays null where there are none.
static bat_status join_lines(const file_text *text, char **joined, bat_error *error)
{
    const char *end = text->data + text->size, *line = text->data;
    if (memchr(text->data, '\\', text->size) == NULL)
        return BAT_OK;
    char *out = malloc(text->size + 1);
    if (out == NULL)
        return error_memory(error, text->size);
    *joined = out;
    size_t breaks = 0;
    for (const char *at = text->data; at < end;)
    {
        size_t size = continuation_at(at, end, line);
        bool ends = *at == '\n';
        breaks += size > 0;
        *out++ = size > 0 ? ' ' : *at;
        at += size > 0 ? size : 1;
        for (; ends && breaks > 0; breaks--)
            *out++ = '\n';
        line = ends ? at : line;
    }
    *out = '\0';
    return BAT_OK;
}

static bat_status read_joined(const file_text *text, const bat_mesh_read_options *options, bool faceless, bat_mesh *mesh,
                              bat_error *error)
{
    obj_reader reader = {.builder.faceless = faceless,
                         .scan = word_scan_start(text->data, text->size),
                         .lenient = options->repair || !options->strict};
    bat_status status;
    do
        status = read_statement(&reader, error);
    while (status == BAT_OK && scan_next_line(&reader.scan));
    if (status == BAT_OK)
        status = obj_labels_finish(&reader.labels, &reader.builder, options->notes, error);
    text_free(&reader.labels.files);
    if (status != BAT_OK)
    {
        mesh_builder_free(&reader.builder);
        return status;
    }
    status = mesh_builder_finish(&reader.builder, options, mesh, error);
    if (status != BAT_OK && error != NULL && error->index != BAT_NO_INDEX)
        error->line = scan_line_of(text, scan_word, "f", error->index);
    return status;
}

static bat_status read_obj(const file_text *given, const bat_mesh_read_options *options, bool faceless, bat_mesh *mesh,
                           bat_error *error)
{
    char *joined = NULL;
    bat_status joining = join_lines(given, &joined, error);
    if (joining != BAT_OK)
        return joining;
    file_text text = *given;
    if (joined != NULL)
        text = (file_text){joined, strlen(joined), given->points, given->path};
    bat_status status = read_joined(&text, options, faceless, mesh, error);
    free(joined);
    return status;
}

bat_status mesh_obj_read(const file_text *text, const bat_mesh_read_options *options, bat_mesh *mesh, bat_error *error)
{
    return read_obj(text, options, false, mesh, error);
}

bat_status mesh_obj_read_points(const file_text *text, const bat_mesh_read_options *options, bat_mesh *mesh,
                                bat_error *error)
{
    return read_obj(text, options, true, mesh, error);
}

/// The sharpness in a finite form.
static double finite_sharpness(double sharpness)
{
    return isfinite(sharpness) ? sharpness : BAT_MESH_SHARP;
}

/// What is written.
typedef struct obj_plan
{
    const bat_mesh *mesh;
    size_t places[MESH_COLOURS]; ///< the positions of the colours among the channels
    size_t colours;
    const double *normals; ///< null: none
} obj_plan;

static void format_vertex(const void *context, size_t v, text_buffer *text)
{
    const obj_plan *plan = context;
    const bat_mesh *mesh = plan->mesh;
    double numbers[3 + MESH_COLOURS];
    memcpy(numbers, mesh->positions + 3 * v, 3 * sizeof *numbers);
    for (size_t i = 0; i < plan->colours; i++)
        numbers[3 + i] = mesh->channels[v * mesh->channel_count + plan->places[i]];
    text_append_numbers(text, "v ", numbers, 3 + plan->colours);
}

static void format_texture(const void *context, size_t i, text_buffer *text)
{
    const obj_plan *plan = context;
    text_append_numbers(text, "vt ", plan->mesh->texture + 2 * i, 2);
}

static void format_normal(const void *context, size_t v, text_buffer *text)
{
    const obj_plan *plan = context;
    text_append_numbers(text, "vn ", plan->normals + 3 * v, 3);
}

/// Write a slash and an index, which counts from 1.
static char *write_index(char *out, uint32_t index)
{
    *out++ = '/';
    return number_write_fixed(out, (int64_t)index + 1, 0);
}

static void format_face(const void *context, size_t f, text_buffer *text)
{
    const obj_plan *plan = context;
    const bat_mesh *mesh = plan->mesh;
    obj_labels_write(mesh, f, text);
    size_t first = mesh_corners_until(mesh, f), last = mesh_corners_until(mesh, f + 1);
    char *out = text_reserve(text, 3 * (last - first) * NUMBER_TEXT_SIZE);
    if (out == NULL)
        return;
    *out++ = 'f';
    for (size_t h = first; h < last; h++)
    {
        *out++ = ' ';
        out = number_write_fixed(out, (int64_t)mesh->faces[h] + 1, 0);
        if (mesh->texture_faces != NULL)
            out = write_index(out, mesh->texture_faces[h]);
        else if (plan->normals != NULL)
            *out++ = '/';
        if (plan->normals != NULL)
            out = write_index(out, mesh->faces[h]);
    }
    *out++ = '\n';
    text_advance(text, out);
}

static void format_crease(const void *context, size_t i, text_buffer *text)
{
    const obj_plan *plan = context;
    const bat_mesh_crease *crease = &plan->mesh->creases[i];
    const double numbers[] = {crease->a, crease->b, finite_sharpness(crease->sharpness)};
    text_append_numbers(text, "t crease 2/1/0 ", numbers, 3);
}

static void format_corner(const void *context, size_t i, text_buffer *text)
{
    const obj_plan *plan = context;
    const double numbers[] = {plan->mesh->corners[i].vertex, finite_sharpness(plan->mesh->corners[i].sharpness)};
    text_append_numbers(text, "t corner 1/1/0 ", numbers, 2);
}

/// A tag with one small number.
static void text_append_tag(text_buffer *text, const char *tag, size_t number)
{
    const char end[] = {(char)('0' + number), '\n', '\0'};
    TEXT_APPEND(text, tag, end);
}

/// The rules of refinement as tags.
static void format_rules(const void *context, size_t row, text_buffer *text)
{
    (void)row; // the only one
    const bat_mesh *mesh = ((const obj_plan *)context)->mesh;
    for (size_t i = 0; i < sizeof BOUNDARY_TAGS / sizeof *BOUNDARY_TAGS; i++)
        if (mesh->rules.boundary == BOUNDARY_TAGS[i])
            text_append_tag(text, "t interpolateboundary 1/0/0 ", i);
    for (size_t i = 0; i < sizeof LINEAR_TAGS / sizeof *LINEAR_TAGS; i++)
        if (mesh->rules.linear == LINEAR_TAGS[i])
            text_append_tag(text, "t facevaryinginterpolateboundary 1/0/0 ", i);
    if (mesh->rules.creasing != BAT_MESH_CREASING_AUTO)
        text_append_string(text, mesh->rules.creasing == BAT_MESH_CREASING_CHAIKIN ? "t creasemethod 0/0/1 chaikin\n"
                                                                                   : "t creasemethod 0/0/1 normal\n");
}

bat_status mesh_obj_write(const bat_mesh *mesh, const bat_mesh_write_options *options, text_sink *sink, bat_error *error)
{
    obj_plan plan = {.mesh = mesh, .normals = options->vertex_normals};
    plan.colours = mesh_colours(mesh, plan.places);
    text_buffer files = {0};
    bat_status status = obj_labels_check(mesh, error);
    if (mesh->material_files != NULL)
        TEXT_APPEND(&files, "mtllib ", mesh->material_files, "\n");
    status = sink_take(sink, &files, status, error);
    const struct
    {
        size_t count;
        line_format *format;
    } parts[] = {{mesh->vertex_count, format_vertex},
                 {mesh->texture_faces != NULL ? mesh->texture_count : 0, format_texture},
                 {plan.normals != NULL ? mesh->vertex_count : 0, format_normal},
                 {mesh->face_count, format_face},
                 {mesh->crease_count, format_crease},
                 {mesh->corner_count, format_corner},
                 {1, format_rules}};
    for (size_t i = 0; i < sizeof parts / sizeof *parts && status == BAT_OK; i++)
        status = text_lines_write(sink, parts[i].count, options->threads, parts[i].format, &plan, error);
    return status;
}
