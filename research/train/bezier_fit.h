#ifndef RESEARCH_TRAIN_BEZIER_FIT_H
#define RESEARCH_TRAIN_BEZIER_FIT_H

#include "research/shapes/surface_bezier.h"

/// @file
/// Least-squares fits of one tensor-product Bézier patch to points with parameters, and the derivative by the parameters:
/// Giannelli et al., "BIDGCN" (2023), equations (2) and (4).

/// A fit: the patch of bidegree (degree, degree) with the smallest sum of squares.
typedef struct bezier_fit
{
    bezier_surface patch; ///< its degree is given
    double *residual;     ///< count x 3, with room: the patch less the points
    double error;         ///< the mean of the residual's squares over points and coordinates
} bezier_fit;

/// Fit by a QR decomposition with pivots. Where the points do not determine the patch, the control points of
/// smallest norm are taken.
/// @param points     count x 3, at least one
/// @param parameters count x 2
/// @return BAT_OK; BAT_NO_CONVERGENCE for parameters or points that are not finite; BAT_TOO_LARGE or BAT_NO_MEMORY
bat_status bezier_fit_make(const double *points, const double *parameters, size_t count, bezier_fit *fit, bat_error *error);

/// The derivative of the error by the parameters: 2 / (3 count) residual . S_u. The derivative of the control points
/// contributes nothing, as the residual is perpendicular to the columns of the matrix.
/// @param gradient receives count x 2
void bezier_fit_gradient(const bezier_fit *fit, const double *parameters, size_t count, double *gradient);

#endif
