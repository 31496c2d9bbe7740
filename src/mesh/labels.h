#pragma once

#include "batten/mesh.h"

#include <string.h>

/// @file
/// The labels of faces and the materials of a mesh: bat_mesh::face_labels to bat_mesh::material_json; and its channels.

/// Free the labels and materials of a mesh; the mesh then has none.
void mesh_labels_free(bat_mesh *mesh);

/// Set the labels and materials of a mesh to none without freeing them, where they belong to another mesh.
void mesh_labels_forget(bat_mesh *mesh);

/// Copy the labels and materials of a mesh to one that has none. Face f of `to` is a part of face sources[f], or of face
/// f / each where `sources` is null.
/// @return BAT_OK or BAT_NO_MEMORY; what was copied before a failure belongs to `to`
bat_status mesh_labels_carry(const bat_mesh *from, const uint32_t *sources, size_t each, bat_mesh *to, bat_error *error);

/// The number of names in a label, and the name of this number, from 0 on: object, group, material, smoothing.
#define MESH_LABEL_NAMES 4
char **mesh_label_name(bat_mesh_label *label, int index);
const char *mesh_label_text(const bat_mesh_label *label, int index);

/// Whether two texts, which may be null, are equal.
static inline bool mesh_text_equals(const char *a, const char *b)
{
    return a == NULL || b == NULL ? a == b : strcmp(a, b) == 0;
}

/// Give a mesh that has no channels copies of their names. False when out of memory.
bool channels_set_names(bat_mesh *mesh, const char *const *names, size_t count);
/// Give a mesh the names of another one's channels.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status channels_name(const bat_mesh *from, bat_mesh *to, bat_error *error);
/// Move the values of those channels to 0 … 1 whose values on another mesh are all there, as those of colours.
void channels_bound(const bat_mesh *from, bat_mesh *to);
/// Give a mesh the names of another one's channels, and room for their values at `vertices` vertices.
/// @param to receives channels, which it must not have yet; bat_mesh_free() releases what was made, also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status channels_make(const bat_mesh *from, size_t vertices, bat_mesh *to, bat_error *error);

/// The names of colour channels, whose values are 0 to 1. Formats with integer colours scale them.
#define MESH_COLOURS 4 ///< the last one is optional
extern const char *const mesh_colour_names[MESH_COLOURS];

/// The positions of the colours among a mesh's channels. Returns their number: 0, 3 or 4.
size_t mesh_colours(const bat_mesh *mesh, size_t places[MESH_COLOURS]);
