#pragma once

#include "base/progress.h"
#include "batten/mesh_measure.h"
#include "surface/shell/shell.h"

/// @file
/// The stages of a reconstruction: input, layouts on trial, and what a file keeps of them.

#define SHELL_MAX_FACES 2800 ///< unless a number is given
#define SHELL_ANCHORS 3      ///< of a triangle

/// Weight of normals in the error of the second layout that is tried. Those that follow residuals have more.
static const double SHELL_NORMALS = 0.3;

/// A layout with its grid and a fit.
typedef struct shell_trial
{
    shell_layout layout;
    shell_grid grid;
    shell_fit fit;
    shell_place *first; ///< places of points and anchors on the layout
    memory_pool pool;
} shell_trial;

/// A frame that turns and grows with the points: x -> axes (x in `box` - centre) / unit.
typedef struct shell_frame
{
    unit_frame box;
    local_plane plane;
    double unit;
} shell_frame;

/// A reconstruction on its way. Owned: the meshes and the pool.
typedef struct shell_work
{
    const bat_shell_reconstruct_options *options;
    const char *steps; ///< a file that keeps what was found; null: none
    shell_frame frame;
    double unit;           ///< of `frame`, in the unit of the input
    double *points;        ///< count x 3, in the frame, in an order that depends on their places there; then anchors
    const double *rounded; ///< count x 3: the same on a grid of ROUNDING, from which the mesh is made
    size_t count;
    bat_mesh mesh;                   ///< of unit size
    bat_mesh creased;                ///< the same with creases that were found; empty: none
    bat_mesh_closest_point *closest; ///< of the points and anchors on the mesh
    bat_mesh_closest_point *creased_closest;
    double *creased_points; ///< those with the anchors of the other mesh
    bool sharp;             ///< `mesh` is the one with creases
    bool *held;             ///< count
    double *squared;        ///< count: squared distances in the last fit on trial
    bool closed;            ///< the mesh of points
    bool folded;            ///< the first fit
    bool split;             ///< the shell is between two sheets of points
    double share;           ///< of the spacing or the noise in a cell that connects points
    bool has_share;         ///< cells are not larger, as for many points, so that another share would change them
    double noise, stiffness;
    double normals; ///< their weight in the error of the layout
    size_t faces;   ///< found for the layout; 0: not yet
    bat_shell_report report;
    memory_pool pool;
} shell_work;

// Input

/// Bring the points into a frame that turns with them, and sort them there.
bat_status shell_take_points(shell_work *work, const double *points, size_t count, bat_error *error);

/// Refine a mesh, mark its creases, and sample it.
bat_status shell_take_mesh(shell_work *work, const bat_mesh *mesh, bat_error *error);

/// Connect the points, unless there is a mesh, and give meshes their normals; keep that step.
bat_status shell_make_meshes(shell_work *work, bat_progress progress, bat_error *error);

/// Give back the place and the scale of the input.
void shell_restore(const shell_frame *frame, double *points, size_t count);

// Layouts on trial

/// Find the places of the points on the mesh, hold out some, and append anchors.
bat_status shell_place_on_mesh(shell_work *work, bat_error *error);

/// Make a layout, its grid, and the places of the points there; `trial` is released also on failure.
bat_status shell_trial_make(const shell_work *work, size_t faces, shell_trial *trial, bat_error *error);

/// Fit in two parts: the second takes off the bias of the noise that the first leaves.
bat_status shell_trial_fit(shell_trial *trial, int rounds, bat_error *error);

void shell_trial_free(shell_trial *trial);

/// Fit a layout to some of the points.
/// @param held    receives the root mean square distance of the others; infinity where creases need far more faces
/// @param largest receives the largest distance of all
bat_status shell_try_layout(const shell_work *work, size_t faces, double *held, double *largest, bat_error *error);

/// Find the number of faces, the smoothing, and whether normals have a part in the layout; keep that step.
bat_status shell_find_layout(shell_work *work, bat_progress progress, bat_error *error);

// Steps in a file

/// Take what a file keeps of a reconstruction of the same points with the same options; nothing where there is no file.
/// @return BAT_OK, BAT_INVALID_ARGUMENT where the file belongs to another reconstruction, BAT_BAD_FILE, ...
bat_status shell_steps_load(shell_work *work, bat_error *error);

/// Keep what has been found, where a file is to.
bat_status shell_steps_save(shell_work *work, bat_error *error);
