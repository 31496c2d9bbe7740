#ifndef RESEARCH_SURFACE_GROUP_H
#define RESEARCH_SURFACE_GROUP_H

#include "batten/research/distributed.h"

/// @file
/// Work that the processes of a group share. A null group is a process alone: then nothing is exchanged.
///
/// Messages go from rank to rank, 0 to the last, in pieces of at most GROUP_RUN bytes: while a rank passes one on, the
/// rank before it prepares the next.

enum
{
    GROUP_RUN = 1 << 16
};

static inline size_t group_rank(const bat_group *group)
{
    return group != NULL ? group->rank : 0;
}

static inline size_t group_count(const bat_group *group)
{
    return group != NULL ? group->count : 1;
}

static inline bool group_is_first(const bat_group *group)
{
    return group_rank(group) == 0;
}

/// Send bytes of one process to all others.
bat_status group_broadcast(const bat_group *group, size_t root, void *bytes, size_t size, bat_error *error);

/// Every rank receives a status of rank 0, with its text.
bat_status group_agree_with_first(const bat_group *group, bat_status status, bat_error *error);

/// Rank 0 receives what all ranks have, in their order. A process alone receives a copy.
/// @param sizes,all need free(), also after a failure
bat_status group_gather(const bat_group *group, const void *bytes, size_t size, size_t **sizes, char **all,
                        bat_error *error);

/// Sums over ranks of each number; every rank receives them.
bat_status group_sum_counts(const bat_group *group, uint64_t *numbers, size_t count, bat_error *error);
/// The sum over lower ranks.
bat_status group_sum_before(const bat_group *group, uint64_t number, uint64_t *sum, bat_error *error);
/// The largest over ranks of each number; every rank receives them.
bat_status group_largest(const bat_group *group, double *numbers, size_t count, bat_error *error);

#endif
