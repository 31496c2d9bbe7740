#ifndef BATTEN_RESEARCH_DISTRIBUTED_H
#define BATTEN_RESEARCH_DISTRIBUTED_H

#include "batten/surface.h"

BAT_C_BEGIN

/// @file
/// Fits that several processes make together, as the program batten-mpi does.

/// The processes that make one call together, and how they exchange messages. All of them make the same calls in the same
/// order, and must be of the same build, on machines of the same kind. The program batten-mpi has such a group over MPI. A
/// call that takes a group takes null for a process alone. A failure of a function ends the call of the process that sees
/// it.
typedef struct bat_group
{
    size_t rank;   ///< of this process, 0 to count - 1
    size_t count;  ///< processes, at least 1
    void *context; ///< handed to the functions
    /// Send bytes to another process. Returns when `bytes` may be changed; it may wait until the other receives them.
    bat_status (*send)(void *context, size_t to, const void *bytes, size_t size, bat_error *error);
    /// Wait for the bytes of one send() of another process, which come in the order of its calls. `size` is that of the
    /// send.
    bat_status (*receive)(void *context, size_t from, void *bytes, size_t size, bat_error *error);

    // What an engine may do faster than by messages. Null: it is made of send() and receive().

    /// Rank 0 receives the bytes of all ranks, in their order.
    /// @param sizes [count], receives the number of bytes of each; rank 0 alone
    /// @param all   receives an array from malloc(); rank 0 alone
    bat_status (*gather)(void *context, const void *bytes, size_t size, size_t *sizes, void **all, bat_error *error);
    /// All ranks receive the bytes of one.
    bat_status (*broadcast)(void *context, size_t root, void *bytes, size_t size, bat_error *error);
} bat_group;

/// The first failure, by rank, of what each process did: every process receives it, with its text.
/// @param group  null for a process alone
/// @param status of this process
/// @param error  of this process, then the one agreed on
/// @return BAT_OK where all processes succeeded
BAT_API bat_status bat_group_agree(const bat_group *group, bat_status status, bat_error *error);

// Fits that several processes make together.

/// Points of one block, along the curve of bat_surface_fit_order(). Sums over points are sums of blocks, in their order.
#define BAT_SURFACE_FIT_BLOCK 768

/// The place of a parameter on the Morton curve: the bits of u and v in turn (Morton, 1966).
/// @param parameter u and v in [0, 1]
BAT_API uint32_t bat_surface_fit_order(const double parameter[2]);

/// Columns of numbers of the points of this process.
typedef struct bat_surface_fit_column
{
    double *values; ///< count x width
    size_t width;
} bat_surface_fit_column;

/// What the processes of a fit use beside messages: a solver that all of them run, and a store of the state between rounds.
typedef struct bat_surface_fit_backend
{
    void *context; ///< handed to the functions

    // A solver of symmetric positive definite systems that all ranks run. All null: that of the library, on rank 0.

    /// Rank 0: factor the matrix whose lower triangle is in compressed columns, rows ascending.
    /// @param regular receives false for a matrix that is singular in double precision
    bat_status (*factor)(void *context, size_t size, const int *first, const int *row, const double *values, bool *regular,
                         bat_error *error);
    /// Rank 0: solve by the last factorization.
    /// @param right    size x columns
    /// @param solution receives as many; not `right`
    bat_status (*solve)(void *context, size_t columns, const double *right, double *solution, bat_error *error);
    /// Other ranks: take part in what rank 0 calls, until that calls `release`.
    bat_status (*attend)(void *context, bat_error *error);
    /// Rank 0: the systems of this round are solved.
    bat_status (*release)(void *context, bat_error *error);

    // The state of the fit between two rounds; null where it is not kept.

    /// Keep the state.
    /// @param head the same bytes on all ranks
    bat_status (*save)(void *context, const void *head, size_t size, const bat_surface_fit_column *columns,
                       size_t column_count, bat_error *error);
    /// Fetch the last state that was saved.
    /// @param head    receives an array from malloc(), on all ranks; null for none
    /// @param columns receive the values
    bat_status (*load)(void *context, void **head, size_t *size, const bat_surface_fit_column *columns, size_t column_count,
                       bat_error *error);
} bat_surface_fit_backend;

/// Make the border curves of a fit by several processes. Each process makes the same.
/// @param data   the boundary points of the whole fit, in order, with their parameters: `boundary_count` of them
/// @param border receives the curves, without samples where a side has fewer than six points; release it with
///               bat_surface_border_free(), also after the fit
/// @return the failures of bat_surface_fit(); `border` is untouched on failure
BAT_API bat_status bat_surface_border_make(const bat_surface_fit_data *data, const bat_surface_fit_options *options,
                                           bat_surface_border **border, bat_error *error);
/// Free border curves; null is allowed.
BAT_API void bat_surface_border_free(bat_surface_border *border);
/// Places of the curves and their parameters, which hold the border of the surface. They are among the points of
/// bat_surface_fit_together(); their numbers follow those of the points of the cloud.
/// @param points     receives an array of count x dimension
/// @param parameters receives one of count x 2
/// @return their number
BAT_API size_t bat_surface_border_samples(const bat_surface_border *border, const double **points,
                                          const double **parameters);

/// bat_surface_fit() by several processes: each has a part of the points. With the library's solver the surface is that of
/// bat_surface_fit() to the last bit, for any number of processes.
/// @param group   null for a process alone
/// @param backend null for the solver of the library, without a store
/// @param data    the points of this process, along the curve: ascending by bat_surface_fit_order(), equal ones by
///                number, and after those of lower ranks. All ranks but the last with points have whole blocks; a rank may
///                have none. `boundary_count` is that of all points: those of lower numbers
/// @param numbers count: the place of each point among all points, from 0; counts all points, each once
/// @param options the same in all processes, but for `progress`: that of rank 0 may stop the fit
/// @param report  distances are those of this process, also of samples of border curves; all else is of all points of the
///                cloud, `worst` a number
/// @return as bat_surface_fit(), and the failures of the functions of the group and of the backend
BAT_API bat_status bat_surface_fit_together(const bat_group *group, const bat_surface_fit_backend *backend,
                                            bat_surface_fit_data *data, const uint32_t *numbers,
                                            const bat_surface_fit_options *options, bat_spline_surface *surface,
                                            bat_surface_fit_report *report, bat_error *error);

BAT_C_END

#endif
