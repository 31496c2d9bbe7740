#ifndef BATTEN_RESEARCH_SURFACE_STUDY_H
#define BATTEN_RESEARCH_SURFACE_STUDY_H

#include "batten/research/surface_shapes.h"
#include "batten/shell.h"
#include "batten/surface.h"

BAT_C_BEGIN

/// @file
/// The experiments of Giannelli, Imperatore, Mantzaflaris and Scholz, "BIDGCN" (2023), section 6, with random clouds or any
/// scans. docs/results/surfaces.md has results.

/// A method of parameterization.
typedef struct bat_surface_method
{
    const char *name; ///< not copied
    bat_surface_parameters parameters;
    bool published;                 ///< use the published neighbourhoods of classical methods
    const bat_surface_model *model; ///< model of learned methods; null: the built-in one
    bool unfolded;                  ///< repair folds before adaptive fits, unlike the paper
} bat_surface_method;

/// Options of the studies. Begin with bat_surface_study_defaults().
typedef struct bat_surface_study_options
{
    size_t clouds; ///< number of clouds of each case, at least 1; default 100
    uint64_t seed; ///< of the clouds; default 1
    int threads;   ///< 0: as many as OpenMP gives; only times depend on it
    bat_progress progress;
} bat_surface_study_options;

BAT_API bat_surface_study_options bat_surface_study_defaults(void);

/// A case: the kind of random clouds.
typedef struct bat_surface_case
{
    size_t points; ///< number of interior points; the boundary is as dense
    double noise;  ///< standard deviation of each coordinate
    int degree;    ///< of surface and fit, in both parameters
} bat_surface_case;

/// The scores of a method. Errors are mean squared residuals, over points and coordinates, of the least-squares Bézier patch
/// for the method's parameters, in the unit box of the cloud.
typedef struct bat_surface_score
{
    size_t succeeded; ///< number of clouds for which the method succeeded; means are over these
    double mse;
    double excess;  ///< mse minus the mse for the true parameters; NaN for scans
    double seconds; ///< CPU time of parameters and patch for one cloud
} bat_surface_score;

/// Evaluate methods on random Bézier clouds with true boundary parameters (figures 4 to 9). Cases with equal degree and
/// number of points differ only in noise.
/// @param scores receives `count` scores
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_CANCELLED; what bat_cloud_bezier() and bat_surface_model_read() return
BAT_API bat_status bat_surface_study_clouds(const bat_surface_case *what, const bat_surface_method *methods, size_t count,
                                            const bat_surface_study_options *options, bat_surface_score *scores,
                                            bat_error *error);

/// Evaluate methods on a scan by one Bézier patch, with chord-length parameters on the boundary (figure 12). `succeeded` is
/// 0 or 1.
/// @param cloud with known boundary; corners are detected if unknown
BAT_API bat_status bat_surface_study_scan(const bat_cloud *cloud, int degree, const bat_surface_method *methods,
                                          size_t count, bat_surface_score *scores, bat_error *error);

/// An adaptive fit of a study.
typedef struct bat_surface_trial
{
    bool own; ///< the published neighbourhoods failed and were replaced by adaptive ones
    bat_surface_result result;
} bat_surface_trial;

BAT_API void bat_surface_trial_free(bat_surface_trial *trial);

/// Fit a scan adaptively with the parameters of a method (figures 14 to 16).
/// @param fit   degrees and number of functions
/// @param trial release it with bat_surface_trial_free()
/// @return as bat_surface_reconstruct()
BAT_API bat_status bat_surface_study_fit(const bat_cloud *cloud, const bat_surface_method *method,
                                         const bat_surface_fit_options *fit, bat_surface_trial *trial, bat_error *error);

/// Draw adaptive fits of a cloud below each other, with a common colour scale.
/// @param path .png, .svg or .pdf
BAT_API bat_status bat_surface_study_draw(const char *path, const bat_cloud *cloud, const bat_surface_method *methods,
                                          const bat_surface_trial *trials, size_t count, bat_error *error);

/// Options of bat_scan_verdict(). Begin with bat_scan_verdict_defaults().
typedef struct bat_scan_verdict_options
{
    size_t crops;  ///< crops of each mesh, 1 to 1000; default 3
    uint64_t seed; ///< of places, sizes and noise; default 1
    bool scanner;  ///< as many random places, whose density is the cosine of a view, with noise along it; default false
    int threads;   ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
} bat_scan_verdict_options;

/// The options' default values.
BAT_API bat_scan_verdict_options bat_scan_verdict_defaults(void);

enum
{
    BAT_SCAN_VERDICT_NAME = 64 ///< the size of names
};

/// A cloud, the verdict on its surface, and what the truth says. Lengths are shares of the size.
typedef struct bat_scan_verdict_row
{
    char shape[BAT_SCAN_VERDICT_NAME]; ///< the mesh's file, or the formula
    size_t points;
    double noise;                      ///< standard deviation of a coordinate
    char failure[BAT_ERROR_TEXT_SIZE]; ///< why there is no surface; empty where there is one
    bat_surface_fault fault;
    bat_surface_doubt doubt;
    bool is_accepted, is_right;
    double distance_from_surface; ///< distance from the surface of 99 % of the truth's vertices
    double distance_from_points;  ///< distance from the truth of 99 % of the surface's samples
    double area;                  ///< of the surface over that of the truth
} bat_scan_verdict_row;

/// Judge surfaces of discs that are cut from meshes, and of deep shapes of formulas, with noise of 0 to 0.005 of the size.
/// A surface is right if `distance_from_surface` is at most 0.02 and `distance_from_points` at most 0.03, both beside twice
/// the noise, and `area` between 0.8 and 1.25.
/// @param folder with meshes in OBJ, OFF or PLY; those that are no triangle meshes, or too small, are left out
/// @param rows   receives the rows, in the order of the files' names; release it with free()
/// @return BAT_OK; BAT_FILE_ACCESS (a folder that cannot be read, or without meshes); BAT_INVALID_ARGUMENT; BAT_CANCELLED;
///         BAT_NO_MEMORY; results are untouched on failure
BAT_API bat_status bat_scan_verdict(const char *folder, const bat_scan_verdict_options *options, bat_scan_verdict_row **rows,
                                    size_t *count, bat_error *error);

/// Options of bat_scan_solids(). Begin with bat_scan_solids_defaults().
typedef struct bat_scan_solids_options
{
    size_t points; ///< of each cloud, 1000 to 10 million; default 20000
    uint64_t seed; ///< of places and noise; default 1
    int threads;   ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
} bat_scan_solids_options;

/// The options' default values.
BAT_API bat_scan_solids_options bat_scan_solids_defaults(void);

/// A cloud of a mesh, and its shell against the mesh. Lengths are shares of the mesh's diagonal.
typedef struct bat_scan_solids_row
{
    char shape[BAT_SCAN_VERDICT_NAME]; ///< the mesh's file
    double noise;                      ///< standard deviation of a coordinate
    bool scanner;                      ///< sampled as from four views, by the cosine of the nearest; else evenly
    char failure[BAT_ERROR_TEXT_SIZE]; ///< why there is no shell; empty where there is one
    bool is_right;                     ///< as bat_scan_solids() has it
    int64_t euler;                     ///< Euler's number of the shell minus that of the mesh: -2 for each handle too many
    double rms, largest;               ///< distances between shell and mesh, the greater of both ways
    double volume;           ///< relative error, of open meshes that of the area; NaN for shells that are open wrongly
    bat_shell_report report; ///< of the shell, in the mesh's unit
    size_t faces;            ///< of the shell
} bat_scan_solids_row;

/// Sample each mesh of a folder without noise and with noise of 0.001 and 0.005 of its diagonal, and fit shells. Every third
/// cloud is as from a scanner. A shell is right if it is closed where the mesh is, has its Euler's number and, to 2 %, its
/// volume. It may be farther from it by 0.02 and four standard deviations of the noise at most.
///
/// Without a folder, bodies with rims are sampled (pipe, elbow, bowl, band, cone, pipe that is cut obliquely), each with
/// 2000 points, too. Their areas must be right to 3 %, and two spacings count instead of 0.02 where they are more.
/// @param folder with meshes in OBJ, OFF or PLY; those of several pieces, or that begin with "coarse-", are left out; or
/// null
/// @param rows   receives the rows, in the order of the files' names; release it with free()
/// @return as bat_scan_verdict(); BAT_UNSUPPORTED where no mesh is of one piece; the failures of bat_mesh_study_read()
BAT_API bat_status bat_scan_solids(const char *folder, const bat_scan_solids_options *options, bat_scan_solids_row **rows,
                                   size_t *count, bat_error *error);

BAT_C_END

#endif
