#pragma once

#include "batten/base.h"

/// @file
/// Processes that make a fit together, as the library batten-research lets them (research/surface/together.c). A team is
/// null for a process alone: then nothing is exchanged.

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
