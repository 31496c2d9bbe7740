#ifndef SURFACE_FIT_LOOP_H
#define SURFACE_FIT_LOOP_H

#include "batten/surface_fit.h"

#include "surface/fit/border.h"
#include "surface/fit/fit_solve.h"
#include "surface/fit/foot_points.h"
#include "surface/fit/system.h"

/// @file
/// What the adaptive loop (adaptive.c) works on.

/// The round with the least expected distance of new points.
typedef struct fit_best
{
    bat_hierarchical_space *space; ///< null for none
    double *parameter;             ///< points.count x 2, before the corrections of later rounds
    double expected;               ///< root of the expected squared distance
    double held_rms, held_largest; ///< distances of held-out points
    size_t round;
    double lambda;
} fit_best;

/// State of the adaptive loop.
typedef struct fit_loop
{
    const bat_surface_fit_options *options;
    const bat_group *group; ///< null for one process
    bat_surface_fit_backend backend;
    fit_points points;
    fit_border border; ///< empty without
    bat_hierarchical_space *space;
    fit_system system;
    fit_solver *solver;
    double *control; ///< functions x dimension
    fit_nets nets;
    double lambda; ///< smoothing weight of the last fit; 0 before the first
    double trace;  ///< of the influence matrix, at the last search for a weight
    size_t budget; ///< maximum number of functions; 0: none
    double size;   ///< the largest absolute coordinate of a point
    bool full;     ///< no further refinement fits the budget
    size_t outliers;
    size_t held_count;
    bool *held;    ///< points.count: rows that are held out; null without
    bool corrects; ///< parameters have been corrected, which leaves residuals across the surface only
    bool stalled;
    double held_rms, held_largest; ///< distances of the held-out points at the last measurement
    double expected;               ///< root of the expected squared distance of new points, at the last measurement
    fit_best best;
    bat_surface_fit_round *rounds; ///< iterations + 1
    size_t count;
    double begin, reported; ///< start time in seconds, and the progress last reported
} fit_loop;

#endif
