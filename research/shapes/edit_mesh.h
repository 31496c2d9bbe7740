#ifndef RESEARCH_SHAPES_EDIT_MESH_H
#define RESEARCH_SHAPES_EDIT_MESH_H

#include "batten/mesh.h"

/// @file
/// A closed triangle mesh whose edges are split, turned and collapsed in place.
///
/// Half-edge 3 f + c runs from corner c of face f to the next. Faces have marks; an edge between faces of different marks is
/// a feature and stays one.

typedef struct edit_mesh
{
    double (*positions)[3];
    uint32_t *first; ///< a half-edge that begins at a vertex; BAT_MESH_NONE for a vertex that is gone
    size_t vertex_count, vertex_room;
    uint32_t (*faces)[3]; ///< corner 0 is BAT_MESH_NONE where the face is gone
    uint32_t *twin;
    uint16_t *marks;
    size_t face_count, face_room;
    size_t dead_vertices, dead_faces;
} edit_mesh;

/// From a closed mesh and the marks of its faces, which are copied.
/// @return what bat_mesh_connect() returns; BAT_NOT_MANIFOLD also for a boundary
bat_status edit_mesh_begin(const bat_mesh *mesh, const uint16_t *marks, edit_mesh *edit, bat_error *error);
void edit_mesh_free(edit_mesh *edit);
/// Close the gaps that vertices and faces left which are gone.
bat_status edit_mesh_compact(edit_mesh *edit, bat_error *error);

static inline uint32_t edit_from(const edit_mesh *edit, uint32_t half_edge)
{
    return edit->faces[half_edge / 3][half_edge % 3];
}

static inline uint32_t edit_to(const edit_mesh *edit, uint32_t half_edge)
{
    return edit_from(edit, bat_mesh_next(half_edge));
}

/// The half-edge that begins at the same vertex and follows counter-clockwise.
static inline uint32_t edit_turn(const edit_mesh *edit, uint32_t half_edge)
{
    return edit->twin[bat_mesh_previous(half_edge)];
}

static inline bool edit_is_feature(const edit_mesh *edit, uint32_t half_edge)
{
    return edit->marks[half_edge / 3] != edit->marks[edit->twin[half_edge] / 3];
}

/// The faces around a vertex.
size_t edit_valence(const edit_mesh *edit, uint32_t vertex);

enum
{
    EDIT_MAX_MARKS = 4
};

/// What meets at a vertex.
typedef struct edit_corner
{
    size_t marks[EDIT_MAX_MARKS]; ///< up to four different ones
    size_t mark_count;
    size_t feature_count; ///< of the edges: 0 on a surface, 2 along a feature, else where features end or meet
} edit_corner;

edit_corner edit_corner_of(const edit_mesh *edit, uint32_t vertex);

/// Put a vertex into the middle of an edge.
bool edit_split(edit_mesh *edit, uint32_t half_edge);
/// Turn an edge that is no feature to join the two other corners of its faces, where that gives no double edge and no face
/// that looks away from both faces before.
bool edit_flip(edit_mesh *edit, uint32_t half_edge);
/// Take the begin of an edge into its end, which moves to `point`, where the surface stays a manifold, no face turns over,
/// and no edge becomes longer than `longest`.
bool edit_collapse(edit_mesh *edit, uint32_t half_edge, const double point[3], double longest);
/// Move a vertex where no face around turns over.
bool edit_move(edit_mesh *edit, uint32_t vertex, const double point[3]);

/// The normal of a face with its length, twice the area.
void edit_normal(const edit_mesh *edit, size_t face, double normal[3]);

#endif
