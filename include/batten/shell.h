#ifndef BATTEN_SHELL_H
#define BATTEN_SHELL_H

#include "batten/surface.h"

BAT_C_BEGIN

/// @file
/// Shells: smooth surfaces of any shape, closed or open, of bicubic patches; and the way to them from points or a mesh.
/// docs/surfaces.md describes the steps, docs/algorithms/shells.md the formulas and their sources.

/// A surface of four-sided faces. Each face is a grid of spans x spans bicubic patches. Faces share their sides. Normals
/// agree along sides, up to a few degrees around the vertices where other than four patches meet. Release it with
/// bat_shell_free().
typedef struct bat_shell
{
    bat_mesh cage;     ///< the control points: quads, of face after face, rows of v; creases that stay sharp
    size_t face_count; ///< faces
    size_t spans;      ///< patches of a face in each direction
    double *patches;   ///< face_count x spans x spans x 16 x 3: Bézier points of each patch, u fastest. Owned
    bool closed;       ///< it has no boundary
} bat_shell;

/// Free what a shell owns and make it empty.
BAT_API void bat_shell_free(bat_shell *shell);

/// Point and normal of a shell.
/// @param face   below face_count
/// @param u      0 to 1, as v
/// @param normal receives a unit vector, outwards of a closed shell; zero where the patch is degenerate; may be null
/// @return BAT_OK; BAT_INVALID_ARGUMENT for a place that does not exist
BAT_API bat_status bat_shell_evaluate(const bat_shell *shell, size_t face, double u, double v, double point[3],
                                      double normal[3], bat_error *error);

/// Sample each patch on a grid of quads; neighbouring patches share their vertices.
/// @param samples of a patch and direction, 1 to 256
/// @param mesh    receives polygons; release it with bat_mesh_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_TOO_LARGE or BAT_NO_MEMORY
BAT_API bat_status bat_shell_tessellate(const bat_shell *shell, size_t samples, bat_mesh *mesh, bat_error *error);

/// Options of a reconstruction. Begin with bat_shell_reconstruct_defaults().
typedef struct bat_shell_reconstruct_options
{
    double
        tolerance; ///< more faces until all points are nearer than this; 0: until held-out points are no nearer; default 0
    size_t faces;  ///< about this number of faces; 0: found; default 0
    size_t spans;  ///< patches of a face in each direction, 2 to 16; default 2
    double crease; ///< edges of a mesh or of points beyond this angle stay sharp, in radians; 0: none; default 0.7
    double fill_holes; ///< of points: close holes up to this diameter too; default 0: those of a few spacings
    bool force;        ///< give also a shell that is judged to be wrong; default false
    int threads;       ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
} bat_shell_reconstruct_options;

/// The default options.
BAT_API bat_shell_reconstruct_options bat_shell_reconstruct_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_shell_reconstruct_fields;

/// Whether a shell is to follow a patch that failed. So it is where the failure names a shell as its remedy, and nothing is
/// asked for that only patches have.
/// @param patch    the options of the patch
/// @param outlined whether a boundary or corners were asked for
/// @param failure  of the patch, or of reading its cloud
/// @param options  receives what both share: tolerance, fill_holes, force, threads, progress
BAT_API bool bat_shell_follows(const bat_surface_reconstruct_options *patch, bool outlined, const bat_error *failure,
                               bat_shell_reconstruct_options *options);

/// What was measured. Distances are from the shell.
typedef struct bat_shell_report
{
    size_t points;   ///< that were fitted: of a mesh, its vertices and samples of its faces
    double spacing;  ///< median distance of neighbouring points
    double noise;    ///< standard deviation of a coordinate, from the residuals of the fit
    double rms;      ///< of the points' distances
    double largest;  ///< of these distances
    double held_out; ///< root mean square distance of points that a fit with as many faces left out; NaN for none
    double reach;    ///< of 99 % of the shell: distance from the nearest point
    double growth;   ///< of noisy points: how many more are twice as far from one; about 4 on a surface, 8 in space; else 0
    double volume;   ///< of a closed shell
    double mesh_volume;    ///< of the triangles that connect the points
    double normal_jump[3]; ///< angle between normals across sides of patches: median, 99 %, largest; creases aside; radians
    size_t pieces;         ///< connected parts
    size_t holes;          ///< boundary loops
    size_t filled;         ///< holes of the points that were closed
    size_t dropped_pieces; ///< parts of few points that were left out
    size_t cut_handles;    ///< tunnels and bridges of the connecting triangles that points contradict, and that were closed
    size_t missed;         ///< points farther away than 1.5 spacings and four standard deviations of the noise
    size_t crossings;      ///< patches that cross others
    size_t turned;         ///< places whose normal is against that of the connected points
} bat_shell_report;

/// Fit a shell to points, or to the surface of a mesh: connect the points, lay out faces, fit, judge.
///
/// The result does not depend on the order of the points, nor on the number of threads.
///
/// @param points  count x 3, finite and distinct; null for a mesh
/// @param mesh    triangles, manifold; null for points
/// @param options null for the defaults
/// @param shell   untouched on failure
/// @param report  may be null
/// @return BAT_OK; BAT_INVALID_ARGUMENT (an option, fewer than 300 points); BAT_INVALID_POINT; BAT_NO_CONVERGENCE where the
///         points have no surface or the shell is wrong, with a text of what and where; the failures of
///         bat_mesh_decimate(); BAT_CANCELLED; BAT_NO_MEMORY
BAT_API bat_status bat_shell_reconstruct(const double *points, size_t count, const bat_mesh *mesh,
                                         const bat_shell_reconstruct_options *options, bat_shell *shell,
                                         bat_shell_report *report, bat_error *error);

/// The same, which keeps what it has found in a file: the mesh that connects the points, then the layout. One that was
/// stopped goes on from there, to the same shell. When there is a shell, the file is removed.
/// @param steps a path; null: none
/// @return as bat_shell_reconstruct(); also BAT_FILE_ACCESS and BAT_BAD_FILE; BAT_INVALID_ARGUMENT where the file is of
///         other points or other options, threads and force aside
BAT_API bat_status bat_shell_reconstruct_in_steps(const double *points, size_t count, const bat_mesh *mesh,
                                                  const bat_shell_reconstruct_options *options, const char *steps,
                                                  bat_shell *shell, bat_shell_report *report, bat_error *error);

BAT_C_END

#endif
