#include "io/mesh/obj_labels.h"

#include "base/error.h"
#include "io/mesh/notes.h"

#include <stdio.h>
#include <string.h>

/// @file
/// Reading and writing of names in OBJ. A name is the rest of its line, without blanks at both ends; a comment begins with a
/// '#' after a blank.

/// The statements, in the order of mesh_label_name().
static const char *const WORDS[MESH_LABEL_NAMES] = {"o", "g", "usemtl", "s"};

enum
{
    SMOOTHING = 3
};

void obj_labels_free(obj_labels *labels)
{
    text_free(&labels->files);
    *labels = (obj_labels){0};
}

/// The rest of the line.
static label_name rest_of_line(word_scan *scan)
{
    scan_skip_blanks(scan);
    const char *begin = scan->at, *end = begin;
    for (; scan->at < scan->end && *scan->at != '\n'; scan->at++)
    {
        bool blank = *scan->at == ' ' || *scan->at == '\t' || *scan->at == '\r';
        if (*scan->at == '#' && end < scan->at)
            break;
        if (!blank)
            end = scan->at + 1;
    }
    size_t size = (size_t)(end - begin);
    return (label_name){size > 0 && *begin != '#' ? begin : NULL, size > 0 && *begin != '#' ? size : 0};
}

static bool name_is(label_name name, const char *word)
{
    return name.begin != NULL && name.size == strlen(word) && memcmp(name.begin, word, name.size) == 0;
}

/// Remember the word of a statement that is left out.
static void add_unused(obj_labels *labels, label_name word)
{
    size_t kept = labels->unused_count < OBJ_UNUSED_WORDS ? labels->unused_count : OBJ_UNUSED_WORDS;
    for (size_t i = 0; i < kept; i++)
        if (labels->unused[i].size == word.size && memcmp(labels->unused[i].begin, word.begin, word.size) == 0)
            return;
    if (kept < OBJ_UNUSED_WORDS)
        labels->unused[kept] = word;
    labels->unused_count = kept + 1;
}

void obj_labels_read(obj_labels *labels, word_scan *scan)
{
    label_name word = {scan->at, (size_t)(scan_word_end(scan) - scan->at)};
    scan->at += word.size;
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
    {
        if (!name_is(word, WORDS[k]))
            continue;
        label_name name = rest_of_line(scan);
        if (k == SMOOTHING && (name_is(name, "off") || name_is(name, "0")))
            name = (label_name){0};
        labels->names[k] = name;
        labels->changed = true;
        return;
    }
    if (name_is(word, "mtllib"))
    {
        label_name files = rest_of_line(scan);
        if (labels->files.size > 0)
            text_append(&labels->files, " ", 1);
        text_append(&labels->files, files.begin, files.size);
    }
    else if (name_is(word, "vn"))
        labels->normals++;
    else if (word.size > 0)
        add_unused(labels, word);
}

bool obj_labels_apply(obj_labels *labels, mesh_builder *builder)
{
    bool applied = !labels->changed || mesh_builder_label(builder, labels->names);
    labels->changed = false;
    return applied;
}

bat_status obj_labels_finish(obj_labels *labels, mesh_builder *builder, bat_mesh_notes *notes, bat_error *error)
{
    bat_status status = BAT_OK;
    if (labels->files.size > 0)
        builder->mesh.material_files = label_name_copy((label_name){labels->files.data, labels->files.size});
    if (labels->files.failed || (labels->files.size > 0 && builder->mesh.material_files == NULL))
        return error_memory(error, labels->files.size);
    if (labels->normals > 0)
        status =
            mesh_note(notes, error, "%zu normals are left out: they follow from the mesh, and writers can make new ones",
                      labels->normals);
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

bat_status obj_labels_check(const bat_mesh *mesh, bat_error *error)
{
    char excerpt[EXCERPT_SIZE];
    for (size_t i = 0; i < mesh->label_count; i++)
        for (int k = 0; k < MESH_LABEL_NAMES; k++)
        {
            const char *name = mesh_label_text(&mesh->labels[i], k);
            if (name != NULL && strpbrk(name, "\n\r") != NULL)
                return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "OBJ cannot hold the name '%s' with a line break",
                                 text_excerpt(excerpt, name, name + strlen(name)));
        }
    return BAT_OK;
}

void obj_labels_write_files(const bat_mesh *mesh, text_buffer *text)
{
    if (mesh->material_files == NULL)
        return;
    text_append_string(text, "mtllib ");
    text_append_string(text, mesh->material_files);
    text_append(text, "\n", 1);
}

static bool same_text(const char *a, const char *b)
{
    return a == b || (a != NULL && b != NULL && strcmp(a, b) == 0);
}

void obj_labels_write(const bat_mesh *mesh, size_t face, text_buffer *text)
{
    static const bat_mesh_label none = {0};
    const uint32_t *labels = mesh->face_labels;
    if (labels == NULL || (face > 0 && labels[face] == labels[face - 1]))
        return;
    const bat_mesh_label *now = &mesh->labels[labels[face]], *before = face > 0 ? &mesh->labels[labels[face - 1]] : &none;
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
    {
        const char *name = mesh_label_text(now, k);
        if (same_text(name, mesh_label_text(before, k)))
            continue;
        text_append_string(text, WORDS[k]);
        text_append(text, " ", name != NULL || k == SMOOTHING);
        text_append_string(text, name != NULL ? name : k == SMOOTHING ? "off" : "");
        text_append(text, "\n", 1);
    }
}
