#ifndef MESH_DECIMATE_ATTRIBUTES_H
#define MESH_DECIMATE_ATTRIBUTES_H

#include "mesh/decimate/collapse.h"
#include "mesh/decimate/quadric.h"

/// @file
/// Texture coordinates and channels during decimation: Hoppe, "New quadric metric for simplifying meshes with appearance
/// attributes" (1999).
///
/// On a face with the gradient g of a value, the value s at a vertex p has the error (g . (p - v) + t - s)^2, with t the
/// value at the face's corner v. An owner has the weighted sums of all given faces that became it: of the weights, of g and
/// of the offsets g . (p - v) + t - s. A vertex has those of g g^T, of offsets times g and of squared offsets as a quadric.
/// With them the best value of a merged owner, and its error, follow for any position.

struct error_vertex;

/// Values at owners, multiplied by scales that turn them into lengths: the texture's owners are the sectors of a vertex
/// between seams; those of channels are the vertices.
typedef struct attribute_field
{
    uint32_t *owner; ///< for each half-edge: the owner at its begin; null: the vertex
    double *values;  ///< owner_count x width
    double *sums;    ///< owner_count x (1 + 4 width): the weight; for each value the sums of gradients and of offsets
    double *scales;  ///< width powers of two
    size_t width, owner_count;
} attribute_field;

typedef struct attributes
{
    attribute_field texture, channels; ///< of width 0 where the mesh has none
    quadric *errors;                   ///< for each vertex, about it; null where the mesh has no values
} attributes;

/// Set the values of a mesh.
/// @param weight a multiple of the scales
/// @return BAT_OK or BAT_NO_MEMORY
bat_status attributes_make(const bat_mesh *mesh, const collapse_mesh *topology, double weight, attributes *made,
                           bat_error *error);
void attributes_free(attributes *all);

/// The error of the values of an edge's new vertex, about the edge's middle: of the best ones, or of those at `kept`.
/// `weight` receives the sum of the weights. False without values.
bool attributes_error(const attributes *all, const collapse_mesh *mesh, uint32_t edge, const double *half, uint32_t kept,
                      quadric *sum, double *weight);
/// Whether no face of a ring turns over in the texture when its edge collapses to a position.
bool attributes_stay_valid(const attributes *all, const collapse_mesh *mesh, const struct error_vertex *vertices,
                           const collapse_ring *ring, const double *position, uint32_t kept);
/// Merge the owners of an edge. It goes before error_merge() and collapse_apply().
void attributes_merge(attributes *all, const collapse_mesh *mesh, const collapse_ring *ring, const double *position,
                      uint32_t kept, const struct error_vertex *vertices);
/// Set texture and channels of the result. The stamp of a vertex is its number there.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status attributes_finish(const attributes *all, const bat_mesh *fine, const collapse_mesh *mesh, bat_mesh *coarse,
                             bat_error *error);

#endif
