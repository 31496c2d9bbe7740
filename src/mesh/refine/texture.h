#ifndef MESH_REFINE_TEXTURE_H
#define MESH_REFINE_TEXTURE_H

#include "mesh/refine/sharpness.h"

/// @file
/// Texture coordinates under smooth rules: face-varying data of OpenSubdiv 3.5.
///
/// A seam is an inner edge whose faces disagree about a texture coordinate at one of its ends. A vertex without seams has
/// the scheme's rule. At other vertices every coordinate has the rule of a corner (it stays) or of a crease along its
/// outermost edges, by bat_mesh_linear and by the sharp edges between its faces.

/// Texture coordinates to refine.
typedef struct texture_rows
{
    const mesh_level *level;            ///< the mesh
    const bat_mesh_connectivity *seams; ///< the texture's links: seams are its boundary edges; no `first`
    const uint32_t *corners;            ///< the texture coordinates at the corners of faces
    const double *from;                 ///< x 2
    double *to;                         ///< of the next level x 2
    bat_mesh_linear linear;             ///< but AUTO and ALL
    smooth_mask *smooth;                ///< the scheme's
    bool quads;                         ///< Catmull and Clark's scheme, else Loop's
    /// For each coarse texture coordinate: whether its sharpness depends on that of the vertex's other one; null for the
    /// rules without such. Each level updates it.
    unsigned char *dependent;
    size_t dependent_count; ///< the number of coarse texture coordinates
    bool first_level;       ///< `dependent` is not set yet
} texture_rows;

/// Compute the texture coordinates of the next level: those there are, then one for each of the texture's edges and, with
/// `quads`, for each face.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status texture_rule(const texture_rows *rows, bat_error *error);

/// Give vertices that share a texture coordinate one each, which smooth rules need. `mesh` may have lists of any polygons.
/// @param corner_count  of the corners of faces
/// @param texture       receives the coordinates, those of `mesh` first; release it with free()
/// @param texture_faces receives the coordinates at the corners; release it with free()
/// @return BAT_OK or BAT_NO_MEMORY; results are untouched on failure
bat_status texture_separate(const bat_mesh *mesh, size_t corner_count, double **texture, size_t *texture_count,
                            uint32_t **texture_faces, bat_error *error);

#endif
