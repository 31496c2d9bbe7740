#pragma once

#include "surface/fit/points.h"

/// @file
/// The normal equations of a penalized least-squares fit over a space,
///     (G + 2 lambda M) c = b,   G = A^T W A,   b = A^T W x,
///     M_ij = integral over [0, 1]^2 of B_i,uu B_j,uu + B_i,uv B_j,uv + B_i,vv B_j,vv.
/// A holds the values of the functions B_j at the parameters of the points, W the weights, x the points. M is the thin-plate
/// matrix: c^T M c is the energy J of eq. (5) of Giannelli et al. (2023). G and M have the same sparsity pattern.

// Sparsity pattern of the Gram matrix of a space, and assembly of matrices with this pattern.
//
// Entry (i, j) belongs to the pattern when functions i and j both do not vanish on some cell.

/// A symmetric matrix's lower triangle in compressed columns, diagonal first.
typedef struct fit_pattern
{
    size_t functions;
    int *first; ///< functions + 1
    int *row;
} fit_pattern;

/// A cell's contribution: an active x active matrix, whose lower triangle is read, and active x columns right sides.
typedef struct fit_cell_work
{
    /// Compute the contribution of a cell to `matrix` and `right` (null without columns).
    void (*fill)(const void *context, size_t cell, double *scratch, double *matrix, double *right);
    /// In place of `fill` where several processes have the data; all of them take part. The first receives the contributions
    /// of cells begin to end - 1, each `matrix`, then `right`.
    /// @param place   offset of each cell in `numbers`
    /// @param numbers null in other processes
    bat_status (*collect)(const void *context, size_t begin, size_t end, const size_t *place, double *numbers,
                          bat_error *error);
    const void *context;
    size_t scratch;    ///< size of the workspace of `fill`, in numbers
    size_t columns;    ///< number of right-hand sides
    double operations; ///< estimated arithmetic operations of `fill` for all cells
    double *values;    ///< entries of the matrix, receives the sum over all cells
    double *right;     ///< functions x columns, receives the sum; null if not requested
} fit_cell_work;

/// Sum the contributions of all cells. Processes after the first have no pattern, and no sums. The order of summation does
/// not depend on the number of threads.
bat_status fit_pattern_sum(const fit_pattern *pattern, const bat_hierarchical_space *space, const fit_cell_work *work,
                           int threads, bat_error *error);

#define FIT_PROBES 2 ///< random right-hand sides besides the coordinates, to estimate the trace of the influence matrix

/// The matrices and right-hand sides of a fit. Release it with fit_system_free().
typedef struct fit_system
{
    memory_pool pool; ///< of all arrays
    const bat_hierarchical_space *space;
    size_t functions;
    size_t dimension; ///< of the points
    size_t columns;   ///< number of right-hand sides: dimension + FIT_PROBES
    fit_pattern pattern;
    double *gram;   ///< lower triangle of G
    double *plate;  ///< lower triangle of M
    double *right;  ///< functions x columns: b, then A^T W^1/2 z for random vectors z with entries +1 and -1
    double square;  ///< sum of w |x|^2 over the points
    size_t counted; ///< number of points with positive weight
    int threads;
} fit_system;

/// Compute pattern and thin-plate matrix of a space, which must outlive the system; of a team, on the first process.
/// @param team     null for one process
/// @param levelled whether the integral over a cell of level l counts 16^-l: the energy of a function then does not grow
///                 with its level
bat_status fit_system_make(const bat_hierarchical_space *space, const fit_team *team, size_t dimension, bool levelled,
                           int threads, fit_system *system, bat_error *error);
/// Add up the numbers of rows of the columns in pattern.first[1] and on, and make all other arrays.
bat_status fit_system_reserve(fit_system *system, bat_error *error);
void fit_system_free(fit_system *system);

/// Assemble G, b and the sums. Requires fit_points_sort(). The result is the same for any number of threads and processes.
bat_status fit_system_gather(fit_system *system, const fit_points *points, bat_error *error);

// Sums over the points of cells (gather.c), which a team of processes shares.

/// What the sums are made of.
typedef struct gather_context
{
    const fit_system *system;
    const fit_points *points;
    size_t columns; ///< right-hand sides
    double *sent;   ///< contributions for the first process; null without others
    size_t *first;  ///< cells + 1: offsets of the cells in `sent`
} gather_context;

/// How the sums of a cell are made: in its active functions, or in the local ones of its level.
typedef struct cell_sums
{
    const hierarchical_cell *cell;
    size_t index;
    bool active;
    size_t side; ///< number of these functions
} cell_sums;

cell_sums gather_sums_of(const gather_context *gather, size_t index);
/// Numbers of a side x side matrix and of its right-hand sides.
size_t gather_numbers_of(const gather_context *gather, size_t side);
/// The largest number of functions in sums of cells.
size_t gather_max_side(const gather_context *gather);
/// Size of the workspace of gather_fill_block() and gather_finish_cell().
size_t gather_scratch_of(const gather_context *gather);
/// Sum over points of a cell that are of one block: places begin to end - 1 of their order.
void gather_fill_block(const gather_context *gather, const cell_sums *sums, size_t begin, size_t end, double *scratch,
                       double *numbers);
/// The contribution of a cell, in its active functions, from its sums.
void gather_finish_cell(const gather_context *gather, const cell_sums *sums, double *numbers, double *scratch,
                        double *matrix, double *right);
/// The contribution of a cell from all its points that are here.
/// @param scratch gather_scratch_of() and three times gather_numbers_of(gather_max_side()) numbers
void gather_fill_cell(const void *context, size_t index, double *scratch, double *matrix, double *right);

/// product = S x for a symmetric matrix S with the pattern of the system.
/// @param x functions x columns; `product` has the same shape
void fit_system_multiply(const fit_system *system, const double *values, size_t columns, const double *x, double *product);

// Sparse symmetric positive definite systems of one pattern.

typedef struct fit_solver fit_solver;

/// Order and analyse a pattern, which must outlive the solver.
bat_status fit_solver_make(const fit_pattern *pattern, fit_solver **solver, bat_error *error);
/// The same by the solver of a team, where it has one; the team must outlive it. The first process alone has a solver; the
/// others attend.
bat_status fit_solver_make_for(const fit_team *team, const fit_pattern *pattern, fit_solver **solver, bat_error *error);
/// Does nothing to null.
void fit_solver_free(fit_solver *solver);

/// Factor the matrix K of these values. One thread works, so that the result does not depend on their number.
/// @param pivot receives the least pivot of Cholesky's method over the diagonal entry it came from: from 1, when functions
/// have
///              nothing in common, down to about the unit roundoff for a singular matrix, and 0 where the method broke off
bat_status fit_solver_factor(fit_solver *solver, const double *values, double *pivot, bat_error *error);

/// Solve by the last factorization, whose pivot must be above 0.
/// @param right    functions x columns
/// @param solution receives as many; may be `right`
bat_status fit_solver_solve(fit_solver *solver, size_t columns, const double *right, double *solution, bat_error *error);

// Solution of the normal equations for a smoothing weight lambda, and the choice of lambda by restricted maximum
// likelihood, generalized cross-validation with unknown or given noise.

/// The criterion and the start of a search for lambda.
typedef struct fit_weight_search
{
    bat_surface_smoothing smoothing;
    double noise;  ///< root of the variance to assume, for BAT_SURFACE_SMOOTHING_NOISE
    double spread; ///< ratio of the variance to assume to that of residuals: above 1 after parameter correction
    double lambda; ///< the given weight, or the start of the search; 0: no estimate is known
    int trials;    ///< maximum number of weights to evaluate, at least 1
    bat_progress progress;
} fit_weight_search;

/// Solve (G + 2 lambda M) c = b. If the matrix is singular in double precision, lambda is increased until it is not.
/// @param lambda  receives the weight used
/// @param control functions x dimension
bat_status fit_weight_solve(const fit_system *system, fit_solver *solver, double *lambda, double *control, bat_error *error);

/// Search for the best weight and solve with it.
/// @param lambda receives the weight
/// @param trace  receives the estimated trace of the influence matrix; NaN for a given weight
bat_status fit_weight_find(const fit_system *system, fit_solver *solver, const fit_weight_search *search, double *lambda,
                           double *trace, double *control, bat_error *error);
