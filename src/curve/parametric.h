#pragma once

#include "batten/curve.h"

/// @file
/// What the schemes with parameters of the points share: BAT_CURVE_SCHEME_KIND_FOUR_POINT and the splines.

/// Points with their channels beside them: a row is a point and `channel_count` numbers, a point of `space`.
typedef struct row_space
{
    bat_space space; ///< the curve's, Euclidean, or a product
    bat_space factors[2];
    bat_product_factors product;
} row_space;

/// Make the space of rows. `rows` must stay where it is, as `space` may point into it.
/// @return BAT_OK, or BAT_TOO_LARGE for more than BAT_SPACE_MAX_DIM numbers
bat_status row_space_make(const bat_space *points, size_t channel_count, row_space *rows, bat_error *error);
/// Write points and channels, the latter possibly null, to rows of `point_dim + channel_count` numbers.
void rows_join(const bat_curve *curve, size_t channel_count, double *rows);
/// The reverse, of `count` rows.
void rows_split(const double *rows, size_t count, size_t point_dim, size_t channel_count, double *points, double *channels);

/// The increment of the parameter over an edge: its length, in any unit, to the power alpha.
double parametric_increment(bat_curve_parameters parameters, double length);

/// polygon_extend() of an open polygon of rows by the cubic through the last four points at their parameters; of shorter
/// polygons, the polynomial through all. The parameters beyond the end are the mirror images of those before it.
bat_status parametric_extend(const bat_space *rows, const bat_space *points, bat_curve_parameters parameters, double *buffer,
                             size_t count, size_t before, size_t after, bat_error *error);
