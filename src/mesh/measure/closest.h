#ifndef MESH_MEASURE_CLOSEST_H
#define MESH_MEASURE_CLOSEST_H

#include "batten/mesh.h"

/// @file
/// The point of a mesh closest to a query, exactly: a tree of bounding boxes over its triangles.
///
/// Triangles lie in packets of eight, boxes in nodes of eight, coordinate by coordinate, so that a query handles eight at a
/// time by vector code. The tree is complete: node n of a level holds the boxes of the nodes (or packets) 8 n … 8 n + 7 of
/// the level below, so nothing points anywhere. Triangles may be degenerate: to a segment, to a point.

enum
{
    CLOSEST_WIDTH = 8,
    CLOSEST_MAX_LEVELS = 12
};

/// Eight triangles with what a distance needs, each turned so that its longest edge runs from corner 0 to corner 1.
typedef struct closest_packet
{
    double corner[3][CLOSEST_WIDTH]; ///< corner 0
    double along[3][CLOSEST_WIDTH];  ///< from corner 0 to corner 1
    double aside[3][CLOSEST_WIDTH];  ///< from corner 0 to corner 2
    double height[3][CLOSEST_WIDTH]; ///< what is perpendicular to `along` in the triangle; its product with `aside` is 1
    double skew[CLOSEST_WIDTH];      ///< the foot of corner 2 on `along`, 0 … 1
    double per_along[CLOSEST_WIDTH], per_aside[CLOSEST_WIDTH], per_across[CLOSEST_WIDTH]; ///< 1 / squared length; or 0
} closest_packet;

/// Eight boxes; missing ones are at infinity.
typedef struct closest_node
{
    double low[3][CLOSEST_WIDTH], high[3][CLOSEST_WIDTH];
} closest_node;

/// The tree. Queries do not change it and may run in parallel. Release it with closest_free().
typedef struct closest_tree
{
    closest_packet *packets;
    closest_node *nodes;              ///< level after level, the root last
    size_t begin[CLOSEST_MAX_LEVELS]; ///< where a level's nodes begin; level 0 are the packets
    int root_level;
    uint32_t *faces;       ///< the face at each place (8 times its packet plus its lane); the last face fills up the end
    unsigned char *turns;  ///< the face's corner that is corner 0 of the triangle at a place
    size_t face_count;     ///< places from here on repeat the last face
    double scale, unscale; ///< the tree holds coordinates times `scale`, a power of two, so that squares stay in range
} closest_tree;

/// The closest point of a mesh.
typedef struct closest_hit
{
    uint32_t face;
    double barycentric[3]; ///< of the face's corners, 0 to 1, of sum 1
    double point[3];
    double distance;
} closest_hit;

/// Build the tree in O(n log n).
/// @param mesh    checked; at least one face
/// @param largest the largest absolute coordinate of the mesh and of the queries to come. Distances below 1e-150 of it are
///                taken for 0
/// @return BAT_OK or BAT_NO_MEMORY; `tree` is untouched on failure
bat_status closest_build(const bat_mesh *mesh, double largest, closest_tree *tree, bat_error *error);
void closest_free(closest_tree *tree);

/// The distance of a point from the mesh.
/// @param place on entry a place of the tree, best one near the answer, such as an earlier answer nearby, else 0; receives
/// the
///              place of the closest triangle
double closest_find(const closest_tree *tree, const double point[3], uint32_t *place);
/// The distance of a point from the triangle at a place.
double closest_to_place(const closest_tree *tree, const double point[3], uint32_t place);
/// The closest point of the triangle at a place.
closest_hit closest_point_at(const closest_tree *tree, const double point[3], uint32_t place);

/// The largest absolute value, or `min` when that is larger.
double closest_largest(const double *values, size_t count, double min);
/// The power of two that brings `largest` to about 1/2 … 1.
double closest_scale(double largest);

#endif
