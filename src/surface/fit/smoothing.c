/// @file
/// Choice of the smoothing weight lambda; see system.h. With K = G + 2 lambda M, define
///
///     c = K^-1 b,   J = c^T M c,   R = x^T W x - b^T c - 2 lambda J,   dR/dlambda = 8 lambda (M c)^T K^-1 (M c),
///     T = trace of the influence matrix  ~  mean over z of z^T W^1/2 A y,   y = K^-1 A^T W^1/2 z,
///     dT/dlambda ~ -2 y^T M y.
///
/// R is the sum of squared residuals of N points. T is estimated with random signs z (Hutchinson, 1990). The criteria are
///
///     restricted likelihood   2 lambda J / s^2 = T - 3  for each coordinate,  s^2 = q (R + 2 lambda J) / (N - 3),
///     cross-validation        minimize R / (1 - T / N)^2,
///     the same, given noise   2 lambda J / noise^2 = T - 3,
///
/// of Wahba (1985) and Craven and Wahba (1979, generalized cross-validation). J and s^2 are sums over d coordinates.
/// Residuals hold the noise of all of them, q = 1, or after parameter correction of d - 2 of them, q = sqrt(d / (d - 2)). 3
/// is the dimension of the null space of M, which contains 1, u and v. The slope of each criterion changes sign at the best
/// weight, so that log10 lambda is bracketed and found by regula falsi.

#include "surface/fit/system.h"

#include "base/error.h"

#include <float.h>
#include <string.h>

// Smallest admissible ratio of a Cholesky pivot to its diagonal entry. Below it only the first digits are correct.
static const double MIN_PIVOT = 1e-13;
// Bounds of the search, as multiples of the weight at which G and 2 lambda M have the same trace.
static const double MIN_SHARE = 1e-13;
static const double MAX_SHARE = 1e6;
// Factor by which lambda grows until the matrix is regular.
static const double REPAIR_FACTOR = 10;
// Relative rounding error of R, with respect to x^T W x.
static const double RESIDUAL_NOISE = 1e-15;
// First steps of the search in log10 lambda: from the weight of an earlier fit, and from no estimate. The second is also the
// longest step, because a score may level out at a distant second place. The search ends when log10 lambda is known to
// RESOLUTION.
static const double NEAR_STEP = 0.5;
static const double FAR_STEP = 2;
static const double RESOLUTION = 0.1;
// Dimension of the null space of the thin-plate energy.
static const double PLANE_FUNCTIONS = 3;

typedef struct weight_trial
{
    double log_lambda; ///< log10 lambda
    double score;      ///< to be minimized
    double slope;      ///< negative if the weight is too small, positive if it is too large
    double trace;      ///< T
    bool regular;      ///< the matrix is regular in double precision
} weight_trial;

typedef struct weight_workspace
{
    memory_pool pool;
    const fit_system *system;
    fit_solver *solver;
    double *values;        ///< entries of K
    double *solution;      ///< functions x columns
    double *plate_product; ///< functions x columns: M times the solution
    double *answer;        ///< functions x dimension
    double *product;       ///< functions x dimension
} weight_workspace;

static bat_status workspace_make(const fit_system *system, fit_solver *solver, weight_workspace *workspace, bat_error *error)
{
    size_t entries = (size_t)system->pattern.first[system->functions], functions = system->functions;
    memory_pool *pool = &workspace->pool;
    *workspace = (weight_workspace){.system = system, .solver = solver};
    workspace->values = memory_pool_array(pool, entries, sizeof(double));
    workspace->solution = memory_pool_array(pool, functions * system->columns, sizeof(double));
    workspace->plate_product = memory_pool_array(pool, functions * system->columns, sizeof(double));
    workspace->answer = memory_pool_array(pool, functions * system->dimension, sizeof(double));
    workspace->product = memory_pool_array(pool, functions * system->dimension, sizeof(double));
    return memory_pool_check(pool, error);
}

static bat_status factor(const weight_workspace *workspace, double lambda, double *pivot, bat_error *error)
{
    const fit_system *system = workspace->system;
    size_t entries = (size_t)system->pattern.first[system->functions];
    for (size_t k = 0; k < entries; k++)
        workspace->values[k] = system->gram[k] + 2 * lambda * system->plate[k];
    return fit_solver_factor(workspace->solver, workspace->values, pivot, error);
}

/// The weight at which G and 2 lambda M have the same trace.
static double balanced_weight(const fit_system *system)
{
    double gram = 0, plate = 0;
    for (size_t f = 0; f < system->functions; f++)
    {
        gram += system->gram[system->pattern.first[f]];
        plate += system->plate[system->pattern.first[f]];
    }
    return gram > 0 && plate > 0 ? gram / (2 * plate) : 1;
}

static bat_status singular(const fit_system *system, bat_error *error)
{
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                     "the points do not determine %zu functions, even with smoothing", system->functions);
}

static bat_status excessive(double lambda, double max, bat_error *error)
{
    return ERROR_ARGUMENT(
        error, "the weight of smoothing %g is out of range: with these points it has its full effect at %.1g", lambda, max);
}

/// Factor K; increase lambda until K is regular.
static bat_status factor_repaired(const weight_workspace *workspace, double *lambda, bat_error *error)
{
    double unit = balanced_weight(workspace->system), pivot, tried = *lambda;
    // Beyond this weight K is 2 lambda M to rounding.
    if (tried > unit / DBL_EPSILON)
        return excessive(tried, MAX_SHARE * unit, error);
    for (;;)
    {
        bat_status status = factor(workspace, tried, &pivot, error);
        if (status != BAT_OK)
            return status;
        if (pivot >= MIN_PIVOT)
            break;
        if (*lambda > MAX_SHARE * unit)
            return excessive(*lambda, MAX_SHARE * unit, error);
        if (tried > MAX_SHARE * unit)
            return singular(workspace->system, error);
        tried = fmax(tried * REPAIR_FACTOR, MIN_SHARE * unit);
    }
    *lambda = tried;
    return BAT_OK;
}

/// Copy the first columns, those of the coordinates.
static void copy_coordinates(const fit_system *system, const double *columns, double *coordinates)
{
    for (size_t f = 0; f < system->functions; f++)
        memcpy(coordinates + f * system->dimension, columns + f * system->columns, system->dimension * sizeof *coordinates);
}

bat_status fit_weight_solve(const fit_system *system, fit_solver *solver, double *lambda, double *control, bat_error *error)
{
    weight_workspace workspace;
    bat_status status = workspace_make(system, solver, &workspace, error);
    if (status == BAT_OK)
        status = factor_repaired(&workspace, lambda, error);
    if (status == BAT_OK)
    {
        copy_coordinates(system, system->right, workspace.answer);
        status = fit_solver_solve(solver, system->dimension, workspace.answer, control, error);
    }
    memory_pool_free(&workspace.pool);
    return status;
}

/// Inner products of two sets of columns, summed over the coordinates, and averaged over the probes.
typedef struct column_sums
{
    double coordinates, probes;
} column_sums;

static column_sums multiply_columns(const fit_system *system, const double *a, const double *b)
{
    column_sums sums = {0, 0};
    for (size_t f = 0; f < system->functions; f++)
        for (size_t k = 0; k < system->columns; k++)
        {
            double product = a[f * system->columns + k] * b[f * system->columns + k];
            if (k < system->dimension)
                sums.coordinates += product;
            else
                sums.probes += product / FIT_PROBES;
        }
    return sums;
}

/// R, T and J of a weight, with their derivatives; see the head of the file.
typedef struct weight_effect
{
    double residual, residual_slope;
    double trace, trace_slope;
    double energy;
} weight_effect;

/// dR/dlambda.
static bat_status find_residual_slope(weight_workspace *workspace, double lambda, double *slope, bat_error *error)
{
    const fit_system *system = workspace->system;
    copy_coordinates(system, workspace->plate_product, workspace->answer);
    bat_status status = fit_solver_solve(workspace->solver, system->dimension, workspace->answer, workspace->product, error);
    *slope = 0;
    for (size_t k = 0; k < system->functions * system->dimension && status == BAT_OK; k++)
        *slope += 8 * lambda * workspace->answer[k] * workspace->product[k];
    return status;
}

static bat_status measure_effect(weight_workspace *workspace, double lambda, bool sloped, weight_effect *effect,
                                 bat_error *error)
{
    const fit_system *system = workspace->system;
    bat_status status = fit_solver_solve(workspace->solver, system->columns, system->right, workspace->solution, error);
    if (status != BAT_OK)
        return status;
    fit_system_multiply(system, system->plate, system->columns, workspace->solution, workspace->plate_product);
    column_sums inner = multiply_columns(system, system->right, workspace->solution);
    column_sums energy = multiply_columns(system, workspace->solution, workspace->plate_product);
    double residual = system->square - inner.coordinates - 2 * lambda * energy.coordinates;
    *effect = (weight_effect){.residual = fmax(fmax(residual, RESIDUAL_NOISE * system->square), DBL_MIN),
                              .trace = inner.probes,
                              .trace_slope = -2 * energy.probes,
                              .energy = energy.coordinates};
    return sloped ? find_residual_slope(workspace, lambda, &effect->residual_slope, error) : BAT_OK;
}

/// Evaluate a weight by one of three criteria. The slope of a likelihood is the difference of both sides of its stationarity
/// condition.
static bat_status try_weight(weight_workspace *workspace, const fit_weight_search *search, double log_lambda,
                             weight_trial *trial, bat_error *error)
{
    double lambda = pow(10, log_lambda), pivot;
    *trial = (weight_trial){.log_lambda = log_lambda, .score = INFINITY, .slope = -INFINITY};
    bat_status status = factor(workspace, lambda, &pivot, error);
    if (status != BAT_OK || pivot < MIN_PIVOT)
        return status;
    weight_effect effect;
    status = measure_effect(workspace, lambda, search->smoothing == BAT_SURFACE_SMOOTHING_CROSS_VALIDATION, &effect, error);
    if (status != BAT_OK)
        return status;
    trial->regular = true;
    trial->trace = effect.trace;
    double counted = (double)workspace->system->counted, penalty = 2 * lambda * effect.energy;
    if (search->smoothing == BAT_SURFACE_SMOOTHING_CROSS_VALIDATION) // generalized: log of R / (1 - T / N)^2
    {
        double left = fmax(1 - effect.trace / counted, DBL_EPSILON);
        trial->score = log(effect.residual) - 2 * log(left);
        trial->slope = lambda * (effect.residual_slope / effect.residual + 2 * effect.trace_slope / (counted * left));
        return BAT_OK;
    }
    // Restricted likelihood, with -J / s^2 as the log density of a Gaussian prior on surfaces, or with a known variance.
    bool known = search->smoothing > BAT_SURFACE_SMOOTHING_LIKELIHOOD;
    double points = fmax(counted - PLANE_FUNCTIONS, 1);
    double freedom = known ? penalty / (search->noise * search->noise)
                           : points * penalty / (search->spread * (effect.residual + penalty));
    trial->slope = freedom - (effect.trace - PLANE_FUNCTIONS);
    trial->score = fabs(trial->slope);
    return BAT_OK;
}

typedef struct weight_bracket
{
    double low_limit, high_limit; ///< bounds of log10 lambda
    weight_trial low, high;       ///< the closest weights that are too small and too large
    bool has_low, has_high;
    double step;
} weight_bracket;

static void bracket_add(weight_bracket *bracket, const weight_trial *trial)
{
    if (trial->slope < 0)
    {
        bracket->low = *trial;
        bracket->has_low = true;
    }
    else
    {
        bracket->high = *trial;
        bracket->has_high = true;
    }
}

/// The next log10 lambda to evaluate; false when the search has converged or has reached its bounds.
static bool bracket_next(weight_bracket *bracket, double *log_lambda)
{
    if (bracket->has_low && bracket->has_high)
    {
        const weight_trial *low = &bracket->low, *high = &bracket->high;
        // The zero of the line through both slopes, kept within 10 to 90 per cent of the bracket.
        double share = low->regular ? low->slope / (low->slope - high->slope) : 0.5;
        *log_lambda = low->log_lambda + fmin(fmax(share, 0.1), 0.9) * (high->log_lambda - low->log_lambda);
        return high->log_lambda - low->log_lambda > RESOLUTION;
    }
    double from = bracket->has_low ? bracket->low.log_lambda : bracket->high.log_lambda;
    double to =
        bracket->has_low ? fmin(from + bracket->step, bracket->high_limit) : fmax(from - bracket->step, bracket->low_limit);
    bracket->step = fmin(2 * bracket->step, FAR_STEP);
    *log_lambda = to;
    return to != from;
}

static bat_status run_search(weight_workspace *workspace, const fit_weight_search *search, double *lambda, double *trace,
                             double *control, bat_error *error)
{
    double unit = log10(balanced_weight(workspace->system));
    weight_bracket bracket = {.low_limit = unit + log10(MIN_SHARE),
                              .high_limit = unit + log10(MAX_SHARE),
                              .step = search->lambda > 0 ? NEAR_STEP : FAR_STEP};
    double log_lambda = search->lambda > 0 ? log10(search->lambda) : unit + 0.5 * log10(MIN_SHARE);
    log_lambda = fmin(fmax(log_lambda, bracket.low_limit), bracket.high_limit);
    weight_trial best = {.score = INFINITY};
    for (int k = 0; k < search->trials || !best.regular; k++)
    {
        weight_trial trial;
        if (search->progress.report != NULL && !search->progress.report(search->progress.context, 0))
            return error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "the fit was stopped");
        bat_status status = try_weight(workspace, search, log_lambda, &trial, error);
        if (status != BAT_OK)
            return status;
        if (trial.regular && trial.score < best.score)
        {
            best = trial;
            *lambda = pow(10, log_lambda);
            *trace = trial.trace;
            copy_coordinates(workspace->system, workspace->solution, control);
        }
        bracket_add(&bracket, &trial);
        if (!bracket_next(&bracket, &log_lambda))
            break;
    }
    return best.regular ? BAT_OK : singular(workspace->system, error);
}

bat_status fit_weight_find(const fit_system *system, fit_solver *solver, const fit_weight_search *search, double *lambda,
                           double *trace, double *control, bat_error *error)
{
    if (search->smoothing == BAT_SURFACE_SMOOTHING_GIVEN)
    {
        *lambda = search->lambda;
        *trace = NAN;
        return fit_weight_solve(system, solver, lambda, control, error);
    }
    weight_workspace workspace;
    bat_status status = workspace_make(system, solver, &workspace, error);
    if (status == BAT_OK)
        status = run_search(&workspace, search, lambda, trace, control, error);
    memory_pool_free(&workspace.pool);
    return status;
}
