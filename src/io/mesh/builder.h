#pragma once

#include "io/mesh/formats.h"

/// @file
/// Construction of a mesh from the faces of a file.

/// A mesh during reading. Faces are polygons and may refer to later vertices. All zero: empty.
typedef struct mesh_builder
{
    bat_mesh mesh; ///< without labels; texture_faces has BAT_MESH_NONE at corners without texture, or is null while all are
    size_t position_capacity, texture_capacity, channel_capacity;
    size_t corner_count, corner_capacity, texture_corner_capacity, offset_capacity, face_label_capacity;
    size_t crease_capacity, mark_capacity;
    label_table labels;
    uint32_t label;       ///< of further faces
    bool labelled;        ///< whether faces have labels
    bool faceless;        ///< a mesh without faces is allowed
    point_table points;   ///< of the vertices that mesh_builder_merge() added
    double *texture_keys; ///< for each texture coordinate of mesh_builder_merge_texture(): its vertex and the coordinate
    size_t texture_key_capacity;
    point_table texture_table;
} mesh_builder;

void mesh_builder_free(mesh_builder *builder);

/// Add a vertex, a texture coordinate or the last vertex's row of channels, to be set. Null when out of memory.
double *mesh_builder_vertex(mesh_builder *builder);
double *mesh_builder_texture(mesh_builder *builder);
double *mesh_builder_channels(mesh_builder *builder);

/// The vertex at a position, which is added where there is none. BAT_MESH_NONE when out of memory or of indices.
uint32_t mesh_builder_merge(mesh_builder *builder, const double position[3]);
/// The same of a texture coordinate of a vertex; no texture coordinate may be added otherwise.
uint32_t mesh_builder_merge_texture(mesh_builder *builder, uint32_t vertex, double u, double v);

/// Reserve memory for vertices and triangles. False when out of memory.
bool mesh_builder_reserve(mesh_builder *builder, size_t vertices, size_t triangles);

/// Add a corner to the current face; `texture` may be BAT_MESH_NONE. False when out of memory.
bool mesh_builder_corner(mesh_builder *builder, uint32_t vertex, uint32_t texture);
/// Complete the current face of `size` corners. False when out of memory.
bool mesh_builder_end_face(mesh_builder *builder, uint32_t size);

/// Add a crease or a sharp vertex; the vertices must exist. False when out of memory.
bool mesh_builder_crease(mesh_builder *builder, bat_mesh_crease crease);
bool mesh_builder_mark(mesh_builder *builder, bat_mesh_corner mark);

/// Set the label of the faces that follow. Faces without one have no names. False when out of memory.
bool mesh_builder_label(mesh_builder *builder, const label_name names[MESH_LABEL_NAMES]);

/// BAT_NO_MEMORY, by the size of the vertices.
bat_status mesh_builder_no_memory(const mesh_builder *builder, bat_error *error);

/// Check the faces, triangulate polygons unless options->polygons keeps them, and return the mesh. If only some faces have
/// texture coordinates, the others get (0, 0). The builder is empty afterwards, also on failure.
///
/// @return BAT_OK; BAT_BAD_FILE with the index of the invalid face, if any; BAT_TOO_LARGE; BAT_NO_MEMORY
bat_status mesh_builder_finish(mesh_builder *builder, const bat_mesh_read_options *options, bat_mesh *mesh,
                               bat_error *error);
