#include "io/mesh/ply_labels.h"

#include "base/error.h"
#include "base/json_scan.h"
#include "io/common/file_text.h"
#include "io/common/json.h"

#include <string.h>

/// @file
/// Names of faces in the comments of a PLY header. The names are JSON, since they may hold any character.

static const char *const KEYS[MESH_LABEL_NAMES] = {"object", "group", "material", "smoothing"};
static const char FILES_KEY[] = "material_files";

/// Read the string of a member, which may be missing. False for another value.
static bool read_name(const json_t *object, const char *key, label_name *name)
{
    const json_t *value = json_object_get(object, key);
    *name = (label_name){json_string_value(value), json_string_length(value)};
    return value == NULL || json_is_string(value);
}

/// Add the label of a parsed comment.
static bat_status add_label(const json_t *object, size_t line, mesh_builder *builder, uint32_t *number, bat_error *error)
{
    label_name names[MESH_LABEL_NAMES];
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
        if (!read_name(object, KEYS[k], &names[k]))
            return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line, "'%s' of a label is no text", KEYS[k]);
    *number = label_table_add(&builder->labels, names);
    return *number != BAT_MESH_NONE ? BAT_OK : error_memory(error, sizeof *builder->labels.labels);
}

static bat_status set_files(const json_t *object, size_t line, mesh_builder *builder, bat_error *error)
{
    label_name files;
    if (!read_name(object, FILES_KEY, &files))
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line, "'%s' is no text", FILES_KEY);
    if (files.begin == NULL)
        return BAT_OK;
    free(builder->mesh.material_files);
    builder->mesh.material_files = label_name_copy(files);
    return builder->mesh.material_files != NULL ? BAT_OK : error_memory(error, files.size);
}

/// Read the JSON after `comment label` to the end of its line.
static bat_status read_comment(word_scan *scan, mesh_builder *builder, uint32_t **numbers, size_t *count, size_t *capacity,
                               bat_error *error)
{
    const char *newline = memchr(scan->at, '\n', (size_t)(scan->end - scan->at));
    json_t *object;
    bat_status status =
        json_parse(scan->at, (size_t)((newline != NULL ? newline : scan->end) - scan->at), 0, scan->line, &object, error);
    if (status != BAT_OK)
        return status;
    if (!json_is_object(object))
        status = error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, scan->line, "a label is no JSON object");
    else if (json_object_get(object, FILES_KEY) != NULL)
        status = set_files(object, scan->line, builder, error);
    else if (!ARRAY_GROW(*numbers, *capacity, *count + 1))
        status = error_memory(error, *count * sizeof **numbers);
    else
    {
        status = add_label(object, scan->line, builder, *numbers + *count, error);
        *count += status == BAT_OK;
    }
    json_decref(object);
    return status;
}

bat_status ply_labels_read(const char *header, size_t size, mesh_builder *builder, uint32_t **numbers, size_t *count,
                           bat_error *error)
{
    word_scan scan = word_scan_start(header, size);
    size_t capacity = 0, found = 0;
    uint32_t *made = NULL;
    bat_status status = BAT_OK;
    do
        if (scan_word(&scan, "comment") && scan_word(&scan, PLY_LABEL) && !scan_line_done(&scan) && *scan.at == '{')
            status = read_comment(&scan, builder, &made, &found, &capacity, error);
    while (status == BAT_OK && scan_next_line(&scan));
    if (status != BAT_OK)
    {
        free(made);
        return status;
    }
    *numbers = made;
    *count = found;
    return BAT_OK;
}

static void append_member(text_buffer *text, const char **separator, const char *key, const char *value)
{
    text_append_string(text, *separator);
    json_text_string(text, key, strlen(key));
    text_append(text, ":", 1);
    json_text_string(text, value, strlen(value));
    *separator = ",";
}

void ply_labels_write(const bat_mesh *mesh, text_buffer *text)
{
    const char *separator = "comment " PLY_LABEL " {";
    if (mesh->material_files != NULL)
    {
        append_member(text, &separator, FILES_KEY, mesh->material_files);
        text_append_string(text, "}\n");
    }
    for (size_t i = 0; mesh->face_labels != NULL && i < mesh->label_count; i++)
    {
        separator = "";
        text_append_string(text, "comment " PLY_LABEL " {");
        for (int k = 0; k < MESH_LABEL_NAMES; k++)
            if (mesh_label_text(&mesh->labels[i], k) != NULL)
                append_member(text, &separator, KEYS[k], mesh_label_text(&mesh->labels[i], k));
        text_append_string(text, "}\n");
    }
}
