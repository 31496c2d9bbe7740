#ifndef IO_MESH_OBJ_LABELS_H
#define IO_MESH_OBJ_LABELS_H

#include "base/text_buffer.h"
#include "io/common/file_text.h"
#include "io/mesh/builder.h"

/// @file
/// Statements of OBJ that name faces or concern what a mesh does not hold: `o`, `g`, `usemtl`, `s`, `mtllib` and others.

enum
{
    OBJ_UNUSED_WORDS = 6
};

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

void obj_labels_free(obj_labels *labels);

/// Read a statement with a word that is none of vertices and faces.
void obj_labels_read(obj_labels *labels, word_scan *scan);

/// Give the builder the label of the next face. False when out of memory.
bool obj_labels_apply(obj_labels *labels, mesh_builder *builder);

/// Give the builder the files of materials, and note what is left out.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status obj_labels_finish(obj_labels *labels, mesh_builder *builder, bat_mesh_notes *notes, bat_error *error);

/// Check that OBJ can hold the names of a mesh.
/// @return BAT_OK or BAT_UNSUPPORTED
bat_status obj_labels_check(const bat_mesh *mesh, bat_error *error);
/// Append the statement `mtllib`, if the mesh names files of materials.
void obj_labels_write_files(const bat_mesh *mesh, text_buffer *text);
/// Append the statements in which the label of a face differs from that of the face before it.
void obj_labels_write(const bat_mesh *mesh, size_t face, text_buffer *text);

#endif
