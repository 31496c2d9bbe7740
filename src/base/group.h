#ifndef BASE_GROUP_H
#define BASE_GROUP_H

#include "batten/base.h"

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

/// Items begin … end - 1 of a list.
typedef struct group_items
{
    size_t begin, end;
} group_items;

/// The items of this process among `count`: the ranks have consecutive items, and numbers that differ by at most 1.
group_items group_items_of(const bat_group *group, size_t count);

/// Send bytes of one process to all others.
bat_status group_broadcast(const bat_group *group, size_t root, void *bytes, size_t size, bat_error *error);

/// Collect the items that the processes made: each has those of its share, and receives all others. The first failure as by
/// bat_group_agree().
/// @param items  count x size bytes
/// @param status,error of this process; where it failed its items are not used
bat_status group_collect(const bat_group *group, void *items, size_t size, size_t count, bat_status status,
                         bat_error *error);

#endif
