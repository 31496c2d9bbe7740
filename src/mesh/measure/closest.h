#pragma once

#include "batten/mesh.h"

/// @file
/// Exact closest points of a mesh, by a tree of bounding boxes over its triangles.
///
/// Packets of eight triangles and nodes of eight boxes are stored coordinate by coordinate for vector code. The tree is
/// complete: node n of a level holds the boxes of the nodes or packets 8 n, …, 8 n + 7 of the level below, so no pointers
/// are stored. Triangles may degenerate to segments or points.

enum
{
    CLOSEST_WIDTH = 8,
    CLOSEST_MAX_LEVELS = 12
};

/// Eight triangles with precomputed vectors. Each is rotated so that its longest edge runs from corner 0 to corner 1.
typedef struct closest_packet
{
    double corner[3][CLOSEST_WIDTH]; ///< position of corner 0
    double along[3][CLOSEST_WIDTH];  ///< corner 1 - corner 0
    double aside[3][CLOSEST_WIDTH];  ///< corner 2 - corner 0
    double height[3]
                 [CLOSEST_WIDTH]; ///< the direction perpendicular to `along`, scaled so that its product with `aside` is 1
    double skew[CLOSEST_WIDTH];   ///< coefficient of `along` in the projection of `aside`, 0 … 1
    double per_along[CLOSEST_WIDTH], per_aside[CLOSEST_WIDTH],
        per_across[CLOSEST_WIDTH]; ///< 1 / squared length of the three edges, or 0
} closest_packet;

/// Eight boxes; unused ones are empty, at infinity.
typedef struct closest_node
{
    double low[3][CLOSEST_WIDTH], high[3][CLOSEST_WIDTH];
} closest_node;

/// The tree. Queries do not change it and may run in parallel. Release it with closest_free().
typedef struct closest_tree
{
    closest_packet *packets;
    closest_node *nodes;              ///< level by level, the root last
    size_t begin[CLOSEST_MAX_LEVELS]; ///< the first node of each level; level 0 are the packets
    int root_level;
    uint32_t *faces;       ///< for each place, 8 x packet + lane: its face; the last places repeat the last face
    unsigned char *turns;  ///< for each place: the face's corner that is corner 0 of the triangle
    size_t face_count;     ///< the number of faces; later places repeat the last one
    double scale, unscale; ///< factors to and from the tree's coordinates; `scale` is a power of two that avoids overflow
} closest_tree;

/// A closest point.
typedef struct closest_hit
{
    uint32_t face;
    double barycentric[3]; ///< coordinates in the face, 0 to 1, with sum 1
    double point[3];
    double distance;
} closest_hit;

/// Build the tree in O(n log n).
/// @param mesh    checked, with at least one face
/// @param largest the largest absolute coordinate of the mesh and of all queries. Distances below 1e-150 times it count as 0
/// @return BAT_OK or BAT_NO_MEMORY; `tree` is untouched on failure
bat_status closest_build(const bat_mesh *mesh, double largest, closest_tree *tree, bat_error *error);
void closest_free(closest_tree *tree);

/// The distance between a point and the mesh.
/// @param place a place near the answer, as of the previous query, or 0; receives that of the closest triangle
double closest_find(const closest_tree *tree, const double point[3], uint32_t *place);
/// The distance between a point and the triangle at a place.
double closest_to_place(const closest_tree *tree, const double point[3], uint32_t place);
/// The closest point of the triangle at a place.
closest_hit closest_point_at(const closest_tree *tree, const double point[3], uint32_t place);

/// Whether a triangle crosses a ray from a point, between 0 and `length` times its direction.
bool closest_blocked(const closest_tree *tree, const double origin[3], const double direction[3], double length);

/// The largest absolute value, but at least `min`.
double closest_largest(const double *values, size_t count, double min);
/// The power of two that scales `largest` to 1/2 … 1.
double closest_scale(double largest);
