#pragma once

#include "base/choice.h"
#include "batten/mesh_refine.h"
#include "mesh/refine/sharpness.h"

/// @file
/// The table of mesh schemes. A new scheme that splits every face in four is a row here, a bat_mesh_scheme, and a file with
/// its rule.

typedef struct mesh_scheme
{
    bat_choice choice;
    mesh_rule *rule;     ///< makes the rows of the next level; a learned scheme's is for channels alone
    mesh_rule *limit;    ///< moves the rows of a level to the limit; null where vertices lie there already
    bool learned;        ///< positions come from bat_mesh_refine_options::rule
    bool turns;          ///< edges are turned (square-root-three): `rule` is null, a level makes three faces of one
    bool continues;      ///< may follow the levels of a learned scheme
    bool creases;        ///< knows creases, corners, and the rules of bat_mesh_rules
    bool polygons;       ///< takes any polygons and makes quads
    smooth_mask *smooth; ///< the mask of a smooth vertex, where `creases`
} mesh_scheme;

/// The row of a scheme that exists.
const mesh_scheme *mesh_scheme_of(bat_mesh_scheme scheme);

// Limits and weights of Loop's scheme.

/// Compute the limit positions of a level's vertices on Loop's surface; `to` has as many rows as `from`.
void loop_limit(const mesh_rows *rows, int threads);

/// The weights of Loop's rule for a smooth vertex.
vertex_mask loop_smooth_mask(unsigned valence);

// Limits and weights of Catmull and Clark's scheme.

/// The weights of a smooth vertex of valence n: (n - 2) / n of it, and 1 / n^2 of each neighbour and each face's middle.
vertex_mask catmull_clark_smooth_mask(unsigned valence);

/// Compute midpoints of edges and means of faces' corners; vertices stay.
void catmull_clark_linear_rule(const mesh_rows *rows, int threads);

/// Compute the limit positions of a level's vertices; `to` has as many rows as `from`.
void catmull_clark_limit(const mesh_rows *rows, int threads);

// Square-root-three subdivision: Kobbelt, "sqrt(3)-subdivision" (2000). Each level puts a vertex into every face and flips
// the old edges, so that they join the new vertices on both sides. Boundary edges remain on even levels; on odd levels they
// are trisected together with their faces.
//
// Half-edge h becomes face h, from the same vertex. New vertices are numbered by face; a trisected edge gives two.

/// Make the next level's vertices, faces and channels.
/// @param cut whether boundary edges are trisected; only after a level without it; then each face has at most one such edge
/// @return BAT_OK or BAT_NO_MEMORY; `fine` can be freed on failure
bat_status sqrt3_refine(const bat_mesh *mesh, const bat_mesh_connectivity *links, bool cut, int threads, bat_mesh *fine,
                        bat_error *error);
