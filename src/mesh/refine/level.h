#pragma once

#include "linalg/vector.h"
#include "mesh/sides.h"

/// @file
/// One level of refinement as the rules of the schemes use it, and loops over its elements on several threads.

/// What is sharp on a level. Made by sharp_list_make().
typedef struct sharp_list
{
    uint32_t *half_edges; ///< the owning half-edges of sharp edges, in their order
    size_t half_edge_count;
    uint32_t *vertices; ///< vertices that are sharp or have a sharp edge, each once
    size_t vertex_count;
    unsigned char *marked; ///< for each vertex of the level: 1 if it is among them
} sharp_list;

/// A mesh during refinement.
typedef struct mesh_level mesh_level;

struct mesh_level
{
    const uint32_t *faces; ///< the vertices at the corners
    mesh_sides sides;
    const bat_mesh_connectivity *links;
    const double *edge_sharpness;   ///< one number for each edge; null: no edge is sharp
    const double *child_sharpness;  ///< where creases follow Chaikin: of both halves of each edge, that at the owner's begin
                                    ///< first; null: one less than the edge's
    const double *vertex_sharpness; ///< one number for each coarse vertex; null: no vertex is sharp
    const sharp_list *sharp;        ///< what is sharp; null: not known, or nothing
    const uint32_t *irregular;      ///< for each coarse vertex: 0 where it is regular, else its number of faces
    size_t coarse_count;      ///< the number of coarse vertices, which keep their indices; all later vertices are regular
    const mesh_level *parent; ///< the level whose faces were split into these, with faces and links only; or null
};

/// Whether a vertex is known to be sharp, so that sharpness_visit() computes it after the smooth ones.
static inline bool mesh_is_sharp(const mesh_level *level, size_t vertex)
{
    return level->sharp != NULL && level->sharp->marked[vertex] != 0;
}

/// Values at the vertices, positions or channels, that a rule carries to the next level.
typedef struct mesh_rows
{
    const mesh_level *level;
    const double *from; ///< vertex_count x dim
    double *to;         ///< vertices of the next level x dim
    size_t dim;
} mesh_rows;

/// A refinement rule: computes `to` from `from`.
typedef void mesh_rule(const mesh_rows *rows, int threads);

mesh_rule midpoint_rule, loop_rule, butterfly_rule, catmull_clark_rule;

/// The weight of neighbour j of an irregular interior vertex of valence n, for the new vertex on the edge to neighbour 0:
/// (1/4 + cos(2 pi j / n) + cos(4 pi j / n) / 2) / n for n > 4. The vertex itself has the weight 3/4.
double butterfly_weight(unsigned valence, unsigned j);

/// The work on the elements begin, …, end - 1.
typedef void mesh_range(const void *job, size_t begin, size_t end);

/// Distribute the elements 0, …, count - 1 over threads, in contiguous ranges.
void mesh_share(mesh_range *range, const void *job, size_t count, int threads);

/// As bat_mesh_next_around(), for faces of any number of corners.
static inline uint32_t sides_next_around(const mesh_level *level, uint32_t half_edge)
{
    return level->links->twin[sides_previous(&level->sides, half_edge)];
}

/// The number of faces at a vertex that has some.
static inline unsigned mesh_valence(const mesh_level *level, uint32_t vertex)
{
    uint32_t first = level->links->first[vertex], h = first;
    unsigned valence = 0;
    do
    {
        valence++;
        h = sides_next_around(level, h);
    } while (h != BAT_MESH_NONE && h != first);
    return valence;
}

/// The half-edge from a vertex to its neighbour; there is one, because the neighbour is not the last one of a boundary.
static inline uint32_t mesh_half_edge_to(const mesh_level *level, uint32_t vertex, uint32_t other)
{
    uint32_t h = level->links->first[vertex];
    while (level->faces[sides_next(&level->sides, h)] != other)
        h = sides_next_around(level, h);
    return h;
}

/// Call the inline function of a row, with the last argument `dim`, so that it is compiled for three columns as well.
#define BY_DIM(rows, row, ...) ((rows)->dim == 3 ? row(rows, __VA_ARGS__, 3) : row(rows, __VA_ARGS__, (rows)->dim))

/// Four rows of values.
typedef struct four_rows
{
    const double *a, *b, *c, *d;
} four_rows;

/// The vertex on an edge from `a` to `b`: `side` times the rows beside it, `c` and `d`, and the rest of the ends.
static inline void blend_row(four_rows of, double side, double *restrict to, size_t dim)
{
    double end = 0.5 - side;
    for (size_t i = 0; i < dim; i++)
        to[i] = end * (of.a[i] + of.b[i]) + side * (of.c[i] + of.d[i]);
}

/// The midpoint of an edge.
static inline void middle_row(const double *a, const double *b, double *restrict to, size_t dim)
{
    for (size_t i = 0; i < dim; i++)
        to[i] = 0.5 * (a[i] + b[i]);
}

/// The vertex `own` on a boundary edge from `a` to `b` of the level before, and the new ones on its halves.
static inline void boundary_rows(const double *a, const double *own, const double *b, double *restrict to,
                                 double *restrict first, double *restrict second, size_t dim)
{
    for (size_t i = 0; i < dim; i++)
    {
        first[i] = 0.5 * (a[i] + own[i]);
        second[i] = 0.5 * (own[i] + b[i]);
        to[i] = 3.0 / 4 * own[i] + 1.0 / 8 * (a[i] + b[i]);
    }
}

/// The last vertex of a half-edge.
static inline uint32_t mesh_end(const uint32_t *faces, uint32_t half_edge)
{
    return faces[bat_mesh_next(half_edge)];
}

/// The vertex opposite a half-edge in its face.
static inline uint32_t mesh_opposite(const uint32_t *faces, uint32_t half_edge)
{
    return faces[bat_mesh_previous(half_edge)];
}

/// Whether a half-edge is the smaller one of its edge and so determines the edge's number; true at a boundary.
static inline bool mesh_owns(const uint32_t *twin, uint32_t half_edge)
{
    return twin[half_edge] > half_edge;
}

/// Whether a half-edge is on the boundary. For the first half-edge of a vertex: whether the vertex is on the boundary.
static inline bool mesh_at_boundary(const bat_mesh_connectivity *links, uint32_t half_edge)
{
    return links->twin[half_edge] == BAT_MESH_NONE;
}

// Faces split in four, in the numbering of batten/mesh_refine.h. The next level's connectivity follows by arithmetic alone.
//
// Half-edge h = 3 f + c is split into a near half, which begins where h begins, and a far half. Child face 4 f + c holds
// the near half of h, an inner edge, and the far half of the previous half-edge. Child face 4 f + 3 holds the other sides
// of the inner edges.

// Faces of any number of corners split into quads, one for each corner. The next connectivity follows by arithmetic.
//
// Corner h becomes quad h: that corner, the vertex on the edge from it, the vertex of the face, and the vertex on the edge
// towards it. New vertices of edges follow the old vertices, those of faces follow these. So half-edge h is split into 4 h
// and 4 next(h) + 3; 4 h + 1 and 4 next(h) + 2 are the two sides of the inner edge between them.

/// Write the 4 x face_count child faces of `faces` or, of polygons, one quad for each corner.
/// @param polygons null: triangles that become triangles
/// @param faces    the vertices at the corners, or the texture coordinates with their own links
void split_faces(const mesh_sides *polygons, const uint32_t *faces, const bat_mesh_connectivity *links, int threads,
                 uint32_t *fine);

/// Compute the split mesh's connectivity, equal to that of sides_connect(), with `first` where `links` has it.
/// @return BAT_OK or BAT_NO_MEMORY; `fine` is untouched on failure
bat_status split_links(const mesh_sides *polygons, const bat_mesh_connectivity *links, int threads,
                       bat_mesh_connectivity *fine, bat_error *error);

/// Triangles and their connectivity.
typedef struct split_mesh
{
    uint32_t *faces;
    bat_mesh_connectivity links;
} split_mesh;

/// Both of a split; release it with split_mesh_free().
/// @param fine all zero, or a split that this one replaces, such as that of these faces
/// @return BAT_OK, BAT_TOO_LARGE or BAT_NO_MEMORY; `fine` is untouched on failure
bat_status split_mesh_make(const uint32_t *faces, const bat_mesh_connectivity *links, int threads, split_mesh *fine,
                           bat_error *error);
void split_mesh_free(split_mesh *mesh);

/// The near half of a half-edge.
static inline uint32_t split_near(uint32_t half_edge)
{
    return half_edge / 3 * 12 + half_edge % 3 * 3;
}

static inline uint32_t split_far(uint32_t half_edge)
{
    return half_edge / 3 * 12 + bat_mesh_next(half_edge) % 3 * 3 + 2;
}
