#ifndef IO_MESH_PLY_LABELS_H
#define IO_MESH_PLY_LABELS_H

#include "base/text_buffer.h"
#include "io/mesh/builder.h"

/// @file
/// Labels in PLY: the face property `label`, a number from 0, and for each label a header line such as
///
///     comment label {"object":"house","material":"brick"}

/// The name of the property.
#define PLY_LABEL "label"

/// Read the labels and the files of materials from the comments of a header.
/// @param numbers receives for each comment the number of its label in the builder; release them with free()
/// @return BAT_OK, BAT_BAD_FILE or BAT_NO_MEMORY
bat_status ply_labels_read(const char *header, size_t size, mesh_builder *builder, uint32_t **numbers, size_t *count,
                           bat_error *error);

/// Append the comments of a mesh.
void ply_labels_write(const bat_mesh *mesh, text_buffer *text);

#endif
