#ifndef BATTEN_MESH_REFINE_H
#define BATTEN_MESH_REFINE_H

#include "batten/mesh.h"

BAT_C_BEGIN

/// @file
/// Finer meshes from coarse ones by subdivision.
///
/// All schemes but square-root-three split every face in four: a level keeps the vertices, at the same indices, and appends one
/// new vertex for every edge, in the order of bat_mesh_connectivity::edge. Face f becomes the faces 4 f + c at its corners c,
/// each beginning with that corner, and 4 f + 3 in its middle, whose corner c is the new vertex of the edge from corner c.

/// The schemes.
typedef enum bat_mesh_scheme
{
    BAT_MESH_MIDPOINT,  ///< new vertices halve the edges; the surface stays as it is
    BAT_MESH_LOOP,      ///< Loop (1987), with Hoppe's creases and corners (1994) and semi-sharp ones (DeRose et al., 1998)
    BAT_MESH_BUTTERFLY, ///< modified butterfly (Zorin, Schröder and Sweldens, 1996), through all vertices
    BAT_MESH_SQRT3,     ///< Kobbelt (2000): a vertex in every face, edges turned; a level triples the faces
    BAT_MESH_LEARNED    ///< by `rule`
} bat_mesh_scheme;

typedef struct bat_mesh_rule bat_mesh_rule;

/// A rule for refinement that lives outside of the classical schemes, such as a network.
struct bat_mesh_rule
{
    size_t levels;       ///< that the rule is made for, at least 1; further ones are left to a classical scheme
    const void *context; ///< the rule's own
    /// Refine a checked mesh by `levels` levels, in the numbering above.
    /// @param fine     the mesh that refinement gives, with its faces, room for its positions, and on entry nothing else: the
    ///                 rule fills in the positions
    /// @param fallback receives the number of places where the rule had to fall back to a classical one
    /// @return BAT_OK, BAT_NO_MEMORY, BAT_CANCELLED
    bat_status (*refine)(const bat_mesh_rule *rule, const bat_mesh *coarse, const bat_mesh_connectivity *connectivity,
                         size_t levels, int threads, bat_mesh *fine, size_t *fallback, bat_error *error);
};

/// How to refine. Begin with bat_mesh_refine_defaults().
typedef struct bat_mesh_refine_options
{
    bat_mesh_scheme scheme;    ///< default BAT_MESH_LOOP
    const bat_mesh_rule *rule; ///< of BAT_MESH_LEARNED; default null
    bat_mesh_scheme then;      ///< the scheme of the levels beyond the rule's; default BAT_MESH_LOOP
    size_t levels;             ///< default 2
    bool limit;                ///< Loop: move the vertices onto the limit surface at the end; default false
    double crease_angle; ///< radians: edges whose faces' normals differ by more are creases for ever; 0: none; default 0
    int threads;         ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
} bat_mesh_refine_options;

/// The options' default values.
BAT_API bat_mesh_refine_options bat_mesh_refine_defaults(void);

BAT_C_END

#endif
