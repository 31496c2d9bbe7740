#pragma once

#include "base/memory.h"
#include "batten/surface_fit.h"
#include "linalg/vector.h"
#include "surface/spline/hierarchical_space.h"

/// @file
/// The points of a fit, ordered for fast passes. Rows follow a Morton curve of the initial parameters, so that the points of
/// a cell are close in memory. A second order lists the rows by the cells of the current space.

// Processes that make a fit together, as the library batten-research lets them (research/surface/together.c). A team is
// null for a process alone: then nothing is exchanged.

struct bat_group;
struct fit_loop;
struct fit_marking;
struct fit_points;
struct gather_context;

/// A solver that all processes run, as bat_surface_fit_backend; all null: the library's, on the first process.
typedef struct fit_team_solver
{
    void *context;
    bat_status (*factor)(void *context, size_t size, const int *first, const int *row, const double *values, bool *regular,
                         bat_error *error);
    bat_status (*solve)(void *context, size_t columns, const double *right, double *solution, bat_error *error);
    bat_status (*attend)(void *context, bat_error *error);
    bat_status (*release)(void *context, bat_error *error);
} fit_team_solver;

typedef struct fit_team fit_team;
struct fit_team
{
    const struct bat_group *group;
    size_t rank, count;

    // Calls of the group; every process receives the results.

    bat_status (*broadcast)(const struct bat_group *group, size_t root, void *bytes, size_t size, bat_error *error);
    bat_status (*agree)(const struct bat_group *group, bat_status status, bat_error *error);
    bat_status (*agree_with_first)(const struct bat_group *group, bat_status status, bat_error *error);
    bat_status (*gather)(const struct bat_group *group, const void *bytes, size_t size, size_t **sizes, char **all,
                         bat_error *error);
    bat_status (*sum_counts)(const struct bat_group *group, uint64_t *numbers, size_t count, bat_error *error);
    bat_status (*sum_before)(const struct bat_group *group, uint64_t number, uint64_t *sum, bat_error *error);
    bat_status (*largest)(const struct bat_group *group, double *numbers, size_t count, bat_error *error);

    // Steps of a fit.

    fit_team_solver solver;
    /// Compute what this process sends of the sums of cells, for fit_cell_work::collect.
    bat_status (*begin_cells)(struct gather_context *gather, size_t scratch, int threads, bat_error *error);
    bat_status (*collect_cells)(const void *gather, size_t begin, size_t end, const size_t *place, double *numbers,
                                bat_error *error);
    /// The scores of all cells.
    bat_status (*score_cells)(const bat_hierarchical_space *space, const struct fit_points *points,
                              const struct fit_marking *marking, double *scores, bat_error *error);
    /// Keep the state between two rounds, and take up that of an earlier call.
    bat_status (*save)(const fit_team *team, const struct fit_loop *loop, bat_error *error);
    bat_status (*load)(const fit_team *team, struct fit_loop *loop, bat_error *error);
    const void *backend; ///< of `save` and `load`
};

static inline size_t team_rank(const fit_team *team)
{
    return team != NULL ? team->rank : 0;
}

static inline size_t team_count(const fit_team *team)
{
    return team != NULL ? team->count : 1;
}

static inline bool team_is_first(const fit_team *team)
{
    return team_rank(team) == 0;
}

/// Send bytes of the first process to all others.
static inline bat_status team_broadcast(const fit_team *team, void *bytes, size_t size, bat_error *error)
{
    return team != NULL ? team->broadcast(team->group, 0, bytes, size, error) : BAT_OK;
}

/// The first failure, by rank, of all processes.
static inline bat_status team_agree(const fit_team *team, bat_status status, bat_error *error)
{
    return team != NULL ? team->agree(team->group, status, error) : status;
}

static inline bat_status team_agree_with_first(const fit_team *team, bat_status status, bat_error *error)
{
    return team != NULL ? team->agree_with_first(team->group, status, error) : status;
}

static inline bat_status team_sum_counts(const fit_team *team, uint64_t *numbers, size_t count, bat_error *error)
{
    return team != NULL ? team->sum_counts(team->group, numbers, count, error) : BAT_OK;
}

/// The sum over lower ranks.
static inline bat_status team_sum_before(const fit_team *team, uint64_t number, uint64_t *sum, bat_error *error)
{
    *sum = 0;
    return team != NULL ? team->sum_before(team->group, number, sum, error) : BAT_OK;
}

static inline bat_status team_largest(const fit_team *team, double *numbers, size_t count, bat_error *error)
{
    return team != NULL ? team->largest(team->group, numbers, count, error) : BAT_OK;
}

/// The first process receives what all have, in the order of ranks. A process alone receives a copy.
/// @param sizes,all need free(), also after a failure
bat_status team_gather(const fit_team *team, const void *bytes, size_t size, size_t **sizes, char **all, bat_error *error);

// Sums and other results over the points of all processes of a fit, which are the same for any number of them: points are
// in blocks, whose sums are added in their order. Every rank receives each result.

/// The sum of rows of numbers, first those of rank 0, one row after another.
/// @param rows count x width: one for each block of points
/// @param sums receives `width`
bat_status fit_sum_rows(const fit_team *team, const double *rows, size_t count, size_t width, double *sums,
                        bat_error *error);

#define FIT_BLOCK 768 ///< points of one block, along the curve of fit_points_place()

/// The number of blocks that hold so many points.
static inline size_t fit_blocks(size_t points)
{
    return (points + FIT_BLOCK - 1) / FIT_BLOCK;
}

/// The sums over points of a few terms: block by block, then over the blocks of all ranks.
/// @param terms adds the terms of a point to `sums` [width]
/// @param width at most FIT_TERMS
#define FIT_TERMS 8
typedef void fit_terms(const void *context, size_t row, double *sums);
bat_status fit_sum_points(const fit_team *team, size_t points, fit_terms *terms, const void *context, size_t width,
                          int threads, double *sums, bat_error *error);

/// The degrees of freedom of a parameter in parameter correction.
typedef enum fit_freedom
{
    FIT_FREE,
    FIT_ALONG_U,
    FIT_ALONG_V,
    FIT_FIXED
} fit_freedom;

/// Points in Morton order; row r is the caller's point number[r]. Release it with fit_points_free().
typedef struct fit_points
{
    memory_pool pool;     ///< the arrays of `count` or `dimension`
    const fit_team *team; ///< the processes that have all points; null: all are here
    bool is_part;         ///< whether rows are in the caller's order, those of samples too
    size_t total;         ///< number of points of all processes
    size_t before;        ///< of them in lower ranks
    size_t count, dimension;
    size_t own;        ///< the caller's points; rows of larger numbers are samples of the border (loop.h), then guides
    size_t guides;     ///< the number of the first guide
    uint32_t *number;  ///< count: index of a row among the caller's points
    double *position;  ///< count x dimension: coordinates minus `centre`
    double *parameter; ///< count x 2
    double *weight;    ///< count
    double *distance;  ///< count: |S(u_i) - x_i| at the last measurement
    uint8_t *freedom;  ///< count: a fit_freedom
    double *centre;    ///< dimension: the offset subtracted from all positions
    uint32_t *order;   ///< count: rows sorted by cell
    uint32_t *cell;    ///< count: the cell of a row
    size_t *first;     ///< cells + 1: offsets of the rows of each cell in `order`
    uint64_t *spread;  ///< cells: the points of each cell in all processes; null without others
    size_t cells;
} fit_points;

/// Check counts, coordinates, parameters, and that boundary parameters lie on the boundary of the square. Of a part of the
/// points, which may be none, also that they follow the curve.
/// @param team    null for one process
/// @param numbers of a part; null where all points are here
bat_status fit_points_check(const fit_team *team, const bat_surface_fit_data *data, const uint32_t *numbers,
                            bat_error *error);

/// Copy the points in Morton order, in which a part already is.
/// @param team    null for one process
/// @param numbers of a part, [count]; null where all points are here
/// @param centred whether to subtract the mean position, which is exact for a basis that is a partition of unity
bat_status fit_points_make(const fit_team *team, const bat_surface_fit_data *data, const uint32_t *numbers, bool centred,
                           fit_points *points, bat_error *error);
void fit_points_free(fit_points *points);

/// The place of a parameter in [0, 1]^2 on the Morton curve: the bits of u and v in turn (Morton, 1966).
uint32_t fit_points_place(const double parameter[2]);

/// Find the cells of all points.
void fit_points_locate(fit_points *points, const bat_hierarchical_space *space, int threads);

/// Sort the rows by cell (counting sort). Requires fit_points_locate(). All processes take part.
bat_status fit_points_sort(fit_points *points, const bat_hierarchical_space *space, bat_error *error);

/// The points of a cell in all processes.
static inline size_t fit_points_of_cell(const fit_points *points, size_t cell)
{
    return points->spread != NULL ? (size_t)points->spread[cell] : points->first[cell + 1] - points->first[cell];
}

/// The places of a cell's rows in `order` that are of one block begin with `begin`; the place after them.
static inline size_t fit_points_block_end(const fit_points *points, size_t begin, size_t end)
{
    size_t block = points->order[begin] / FIT_BLOCK;
    while (begin < end && points->order[begin] / FIT_BLOCK == block)
        begin++;
    return begin;
}

/// Add the subtracted centre to all control points.
void fit_points_restore(const fit_points *points, size_t functions, double *control);

/// Copy the parameters back to the caller's order.
/// @return the number of parameters that changed
size_t fit_points_return(const fit_points *points, bat_surface_fit_data *data);

// Distances of points from a surface, and their foot points, computed cell by cell.
//
// On each cell the surface is a tensor-product B-spline surface of the cell's level. Its local control points are extracted
// once (fit_nets), which makes evaluation at many parameters cheap.

/// The local control net of every cell. Release it with fit_nets_free().
typedef struct fit_nets
{
    const bat_hierarchical_space *space;
    size_t dimension, stride; ///< numbers in the net of one cell: locals x dimension
    double *control;          ///< cells x stride
} fit_nets;

/// Extract the control nets of all cells.
/// @param control functions x dimension
bat_status fit_nets_make(const bat_hierarchical_space *space, const double *control, size_t dimension, int threads,
                         fit_nets *nets, bat_error *error);
void fit_nets_free(fit_nets *nets);

/// Size of the workspace of fit_nets_evaluate(), in numbers.
static inline size_t fit_nets_scratch(const fit_nets *nets)
{
    return 3 * ((size_t)nets->space->options.degree[1] + 1) * nets->dimension;
}

/// Estimated number of arithmetic operations of fit_nets_evaluate().
static inline double fit_nets_operations(const fit_nets *nets, int derivatives)
{
    return 100 * (derivatives + 1) + (double)(nets->stride * (size_t)(derivatives + 1));
}

/// The surface and its derivatives at a parameter of a cell, in the order of bat_spline_surface_evaluate().
static inline void fit_nets_evaluate(const fit_nets *nets, size_t cell, const double *parameter, int derivatives,
                                     double *scratch, double *values)
{
    hierarchical_local_evaluate(nets->space, &nets->space->cells[cell], nets->control + cell * nets->stride, nets->dimension,
                                parameter[0], parameter[1], derivatives, scratch, values);
}

/// Compute the distances |S(u_i) - x_i| of all points. Requires fit_points_locate().
bat_status fit_nets_measure(const fit_nets *nets, fit_points *points, int threads, bat_error *error);

/// Stopping rule of the search for foot points.
typedef struct fit_correction
{
    int steps;        ///< maximum number of Newton steps
    double tolerance; ///< the search ends when the next step is at most this long, in cells
} fit_correction;

/// The stopping rule for convergence to rounding.
fit_correction fit_correction_full(void);

/// The share of points that are so near the surface at their parameters that their feet are at the same place of it: at
/// most `reach` times the shorter side of their cell in space. Requires fit_points_locate().
bat_status fit_near_share(const fit_nets *nets, fit_points *points, double reach, int threads, double *share,
                          bat_error *error);

/// Move parameters to the foot points of their points, eq. (6) of the paper: min over u of |S(u) - x|^2.
///
/// A safeguarded Newton method. Where the Hessian is not positive definite, the Gauss-Newton matrix replaces it. Steps are
/// at most one cell long and are halved until the distance decreases, so that no distance ever increases. Parameters stay in
/// the unit square. A boundary parameter moves along its side, at most half way to the corners; a fixed one does not move.
///
/// Requires fit_points_locate(). Updates cells and distances, and invalidates the order of fit_points_sort().
/// @param moved receives the number of parameters that changed
bat_status fit_correct(const fit_nets *nets, fit_points *points, fit_correction correction, int threads, size_t *moved,
                       bat_error *error);

/// Restart the search for points whose projection converged to a wrong foot.
///
/// Newton's method finds the foot in the basin of attraction of its start. While the surface is stiff, in the first rounds
/// of a fit, this may be a wrong one. The points with the largest distances, far above the mean, restart. The start is the
/// parameter of the nearest point in space whose own distance is at most the mean. A result is kept only if the distance
/// decreases.
bat_status fit_correct_wrong_feet(const fit_nets *nets, fit_points *points, fit_correction correction, int threads,
                                  size_t *moved, bat_error *error);

/// Parameter correction: the parameter of the nearest foot of each point, eq. (6), by a safeguarded Newton method that never
/// increases a distance. Boundary parameters stay on their side and go at most half way to its corners.
/// @param moved receives the number of changed parameters; may be null
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_INVALID_POINT with the first point or parameter out of range; BAT_NO_MEMORY
bat_status spline_correct(const bat_spline_surface *surface, bat_surface_fit_data *data, size_t *moved, bat_error *error);

/// A pseudo-random sign of point and probe: one bit of the finalizer of splitmix64 (Steele, Lea and Flood, 2014).
double fit_random_sign(uint32_t number, size_t probe);
