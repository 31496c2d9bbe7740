#pragma once

#include "batten/space.h"

/// @file
/// The smoothing spline of a polyline of R^n: Reinsch, Smoothing by spline functions, Numerische Mathematik 10 (1967). Its
/// parameter follows by restricted likelihood. docs/algorithms/smoothing.md has the formulas.

/// A polyline, developed into R^n, and its smoothing spline. The spline minimizes
/// sum |move|^2 / slack + weight * integral |acceleration|^2 / variance over the parameter.
typedef struct smooth_fit
{
    size_t count, dim; ///< points and numbers of each
    bool closed;
    double *ahead, *behind; ///< count x dim: vectors to the next and to the previous point; not used past open ends
    double *residuals;      ///< count x dim: vectors from the points to the measurements
    double *steps;          ///< count: the length of the parameter interval after each point, with mean 1
    double *variances;      ///< count: of the acceleration in this interval, relative to its mean
    double *slacks;         ///< count: variances of the measurements, relative to the noise; 0: the point is fixed
    double weight;          ///< of the penalty
    double noise;           ///< the standard deviation of a number of a point, from the restricted likelihood
    double *bends;          ///< count x dim: the accelerations
    double *bands;          ///< unknowns x (band + 1): the factor L D L^T, with the column below each diagonal element
    double *inverse;        ///< the same band of the inverse
    double *buffer;         ///< 2 x count
} smooth_fit;

/// Allocate for `count` points: `slacks`, `variances` and `steps` are 1, but of open ends fixed, and `residuals` 0.
/// @param count at least 3, or 5 when closed
/// @param fit   release it with smooth_fit_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status smooth_fit_make(size_t count, size_t dim, bool closed, smooth_fit *fit, bat_error *error);
void smooth_fit_free(smooth_fit *fit);

/// Choose parameters, variances, slacks of outliers, and the weight, which becomes 0 where there is no noise.
void smooth_fit_choose(smooth_fit *fit);

/// Factor the system R + weight Q^T W^-1 Q of a weight; returns the logarithm of its determinant.
double smooth_fit_factor(const smooth_fit *fit, double weight);
/// Solve it for the accelerations. Returns the sum of z A^-1 z, z being the second differences, Q^T of what is measured.
double smooth_fit_bend(const smooth_fit *fit);
/// The band of the inverse, from the factor (Hutchinson and de Hoog, Smoothing noisy data with spline functions, 1985).
void smooth_fit_invert(const smooth_fit *fit);
/// The variance of a point's residual in units of that of the noise, by the inverse.
double smooth_fit_variance(const smooth_fit *fit, size_t point, double weight);
/// The move of a point towards the spline, without that to its measurement.
void smooth_fit_bend_back(const smooth_fit *fit, size_t point, double weight, double *move);

/// Compute the accelerations for the weight, and each point's move towards the spline.
/// @param moves receives count x dim numbers
void smooth_fit_moves(smooth_fit *fit, double *moves);
