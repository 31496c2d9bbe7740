#ifndef IO_SURFACE_SHELL_H
#define IO_SURFACE_SHELL_H

#include "batten/base.h"

/// @file
/// The topology of rectangles that tile a square: vertices, edges between neighbouring vertices, and the loop of edges
/// around each face.

/// A rectangle on a lattice.
typedef struct shell_face
{
    uint64_t low[2], high[2];
} shell_face;

/// A straight edge between two neighbouring vertices on a line.
typedef struct shell_edge
{
    uint32_t from, to;  ///< vertices, in the direction of increasing u or v
    uint32_t direction; ///< 0: along u; 1: along v
    uint32_t faces[2];  ///< the second is SHELL_NONE on the border of the square
    uint32_t sides[2];  ///< the side of each face: 0 v = low, 1 u = high, 2 v = high, 3 u = low
} shell_edge;

#define SHELL_NONE UINT32_MAX

/// An edge in the loop of a face.
typedef struct shell_use
{
    uint32_t edge;
    bool backward; ///< against its direction
} shell_use;

/// The topology; release it with shell_free().
typedef struct surface_shell
{
    size_t vertex_count;
    uint64_t *vertices; ///< vertex_count x 2: all corners of faces, each once, sorted by v and then u
    size_t edge_count;
    shell_edge *edges;
    size_t face_count;
    size_t *loops;   ///< face_count + 1: the start of each face's loop
    shell_use *uses; ///< counter-clockwise from the lower left corner
} surface_shell;

/// Compute the topology.
/// @return BAT_OK; BAT_TOO_LARGE beyond 2^29 faces; BAT_NO_MEMORY
bat_status shell_make(const shell_face *faces, size_t count, surface_shell *shell, bat_error *error);
void shell_free(surface_shell *shell);

#endif
