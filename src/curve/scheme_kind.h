#pragma once

#include "base/choice.h"
#include "curve/plan.h"
#include "curve/polygon.h"

/// @file
/// The kinds of schemes: one table of what the drivers of refinement need to know. What differs from kind to kind is a
/// column of the table; no other file compares kinds.

typedef struct scheme_kind
{
    bat_choice choice;    ///< bat_choice::value is the kind
    bool linear;          ///< a mask on coordinates: points may be moved to their limit, and ends be free
    bool by_mask;         ///< the mask tells whether the given points stay; else they do
    bool beside_channels; ///< channels are refined beside the points, by kernel_four_point()

    /// Check the fields that the kind uses; null for none.
    bat_status (*check)(const bat_curve_scheme *scheme, bat_error *error);
    /// Whether a checked scheme has a meaning in a space; null: in every space.
    bat_status (*suits)(const bat_curve_scheme *scheme, const bat_space *space, bat_error *error);
    /// The step of a level; null where the curve is not made by levels but by the row's scheme_row::form.
    refine_kernel (*kernel)(const bat_space *space, const bat_curve_scheme *scheme);
} scheme_kind;

/// The kind of a scheme whose kind is in range.
const scheme_kind *scheme_kind_of(const bat_curve_scheme *scheme);
/// The kernel of a scheme in a space that it is made for: for a spline its layout alone.
refine_kernel scheme_kernel(const bat_space *space, const bat_curve_scheme *scheme);

/// Whether a checked scheme keeps the given points.
bool scheme_keeps_points(const bat_curve_scheme *scheme);
/// How an open polygon goes on beyond its ends by BAT_CURVE_END_RULE_EXTRAPOLATE.
polygon_end scheme_end(const bat_curve_scheme *scheme);
/// The scheme of the channels.
bat_curve_scheme scheme_of_channels(const bat_curve_scheme *scheme);

/// Whether a scheme makes level after level.
static inline bool scheme_goes_by_levels(const bat_curve_scheme *scheme)
{
    return scheme_kind_of(scheme)->kernel != NULL;
}

/// The scheme that a scheme stands for in a space: BAT_CURVE_SCHEME_KIND_GEODESIC for masks that have it outside of R^n.
bat_curve_scheme scheme_in_space(const bat_curve_scheme *scheme, const bat_space *space);
/// The number of first levels that the scheme's rule decides; 0 where it decides all levels, or there is no rule.
size_t scheme_decided_levels(const bat_curve_scheme *scheme);
/// Whether each level must be there as a whole before the next begins.
bool scheme_needs_whole_polygons(const bat_curve_scheme *scheme);

// The rows of bat_curve_scheme_family. A new spline is a form, and a row in scheme.c.

/// The settings that a scheme's name may carry.
typedef struct scheme_settings
{
    double w, r, s, mu, order, fairness;
    bool adaptive, turns;
    bat_curve_angle_sign sign;
    bat_curve_base base;
    bat_curve_parameters parameters;
} scheme_settings;

/// What differs from spline to spline.
typedef struct spline_form spline_form;
extern const spline_form spline_catmull_rom, spline_cubic, spline_quintic;

/// Make the refined curve of a spline.
/// @param channels room for the plan's rows of channels; null: they are not computed
/// @return as bat_curve_refine()
bat_status spline_refine(const spline_form *form, const bat_curve *coarse, const refine_plan *plan, double *points,
                         double *channels, bat_error *error);

/// A name: what it takes, and the scheme that its settings make.
typedef struct scheme_row
{
    bat_choice choice;
    scheme_settings defaults;
    /// Check what the ranges of the scheme's fields do not tell; null for nothing.
    bat_status (*check)(const scheme_settings *settings, bat_error *error);
    bat_curve_scheme_kind kind; ///< BAT_CURVE_SCHEME_KIND_AUTO: the learned scheme, or any mask
    bat_mask (*mask)(double w); ///< null: by `order`, else by `r` and `s`
    const spline_form *form;    ///< of splines; null for other schemes
} scheme_row;
