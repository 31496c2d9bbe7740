#ifndef CURVE_SCHEME_ROW_H
#define CURVE_SCHEME_ROW_H

#include "curve/plan.h"

/// @file
/// The rows of bat_curve_scheme_family. A new spline is a file with its function, and a row in scheme_name.c.

/// The settings that a scheme's name may carry.
typedef struct scheme_settings
{
    double w, r, s, mu, order, fairness;
    bool adaptive, turns;
    bat_curve_angle_sign sign;
    bat_curve_base base;
    bat_curve_parameters parameters;
} scheme_settings;

/// Make the refined curve of a spline.
/// @param channels room for the plan's rows of channels; null: they are not computed
/// @return as bat_curve_refine()
typedef bat_status spline_refine(const bat_curve *coarse, const refine_plan *plan, double *points, double *channels,
                                 bat_error *error);

/// A name: what it takes, and how the settings become a scheme.
typedef struct scheme_row
{
    bat_choice choice;
    scheme_settings defaults;
    /// Check what the ranges of the scheme's fields do not tell; null for nothing.
    bat_status (*check)(const scheme_settings *settings, bat_error *error);
    bat_curve_scheme (*make)(const scheme_settings *settings); ///< null for splines and the mask
    spline_refine *refine;                                     ///< of splines; null for other schemes
} scheme_row;

spline_refine spline_catmull_rom, spline_cubic, spline_quintic;

#endif
