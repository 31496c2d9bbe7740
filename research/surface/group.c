#include "research/surface/group.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// What the processes agree on.
typedef struct outcome
{
    bat_status status;
    bat_error error;
} outcome;

bat_status group_broadcast(const bat_group *group, size_t root, void *bytes, size_t size, bat_error *error)
{
    size_t rank = group_rank(group), ranks = group_count(group);
    size_t before = (rank + ranks - 1) % ranks, next = (rank + 1) % ranks;
    bat_status status = BAT_OK;
    if (ranks > 1 && size > 0 && group->broadcast != NULL)
        return group->broadcast(group->context, root, bytes, size, error);
    for (size_t begin = 0; ranks > 1 && begin < size && status == BAT_OK; begin += GROUP_RUN)
    {
        size_t run = size - begin < GROUP_RUN ? size - begin : GROUP_RUN;
        if (rank != root)
            status = group->receive(group->context, before, (char *)bytes + begin, run, error);
        if (status == BAT_OK && next != root)
            status = group->send(group->context, next, (char *)bytes + begin, run, error);
    }
    return status;
}

bat_status bat_group_agree(const bat_group *group, bat_status status, bat_error *error)
{
    size_t rank = group_rank(group), last = group_count(group) - 1;
    outcome mine, before;
    if (last == 0)
        return status;
    memset(&mine, 0, sizeof mine);
    mine.status = status;
    if (status != BAT_OK && error != NULL)
        mine.error = *error;
    bat_status sent = BAT_OK;
    if (rank > 0)
        sent = group->receive(group->context, rank - 1, &before, sizeof before, error);
    if (rank > 0 && sent == BAT_OK && before.status != BAT_OK)
        mine = before;
    if (sent == BAT_OK && rank < last)
        sent = group->send(group->context, rank + 1, &mine, sizeof mine, error);
    if (sent == BAT_OK)
        sent = group_broadcast(group, last, &mine, sizeof mine, error);
    if (sent != BAT_OK)
        return sent;
    if (mine.status != BAT_OK && error != NULL)
        *error = mine.error;
    return mine.status;
}

bat_status group_agree_with_first(const bat_group *group, bat_status status, bat_error *error)
{
    bat_error sent = {0};
    if (group_count(group) == 1)
        return status;
    if (status != BAT_OK && error != NULL)
        sent = *error;
    sent.status = status;
    bat_status done = group_broadcast(group, 0, &sent, sizeof sent, error);
    if (done == BAT_OK && sent.status != BAT_OK && error != NULL)
        *error = sent;
    return done != BAT_OK ? done : sent.status;
}

/// group_gather() by messages: of each rank the size, then the bytes. A process alone has its own.
static bat_status gather_messages(const bat_group *group, const void *bytes, size_t size, size_t *sizes, char **all,
                                  bat_error *error)
{
    size_t total = sizes[0] = size, count = group_count(group);
    bat_status status = BAT_OK;
    if (group_rank(group) > 0)
    {
        bat_status sent = group->send(group->context, 0, &size, sizeof size, error);
        return sent == BAT_OK && size > 0 ? group->send(group->context, 0, bytes, size, error) : sent;
    }
    for (size_t rank = 1; rank < count && status == BAT_OK; total += sizes[rank++])
        status = group->receive(group->context, rank, &sizes[rank], sizeof *sizes, error);
    if (status != BAT_OK)
        return status;
    char *at = *all = memory_array(total, 1);
    if (at == NULL)
        return error_memory(error, total);
    memcpy(at, bytes, size);
    for (size_t rank = 1; rank < count && status == BAT_OK; rank++)
    {
        at += sizes[rank - 1];
        if (sizes[rank] > 0)
            status = group->receive(group->context, rank, at, sizes[rank], error);
    }
    return status;
}

bat_status group_gather(const bat_group *group, const void *bytes, size_t size, size_t **sizes, char **all, bat_error *error)
{
    size_t count = group_count(group);
    *all = NULL;
    *sizes = memory_array(count, sizeof **sizes);
    if (*sizes == NULL)
        return error_memory(error, count * sizeof **sizes);
    if (count == 1 || group->gather == NULL)
        return gather_messages(group, bytes, size, *sizes, all, error);
    void *received = NULL;
    bat_status status = group->gather(group->context, bytes, size, *sizes, &received, error);
    *all = received;
    return status;
}

/// Combine the numbers of all ranks on rank 0, and broadcast the result.
/// @param add combines a rank's numbers with those of lower ranks, in `numbers`
static bat_status reduce(const bat_group *group, void *numbers, size_t size,
                         void (*add)(void *numbers, const void *more, size_t size), bat_error *error)
{
    if (group_count(group) == 1)
        return BAT_OK;
    size_t *sizes;
    char *all;
    bat_status status = group_gather(group, numbers, size, &sizes, &all, error);
    for (size_t rank = 1; status == BAT_OK && all != NULL && rank < group->count; rank++)
        add(numbers, all + rank * size, size);
    free(sizes);
    free(all);
    return status == BAT_OK ? group_broadcast(group, 0, numbers, size, error) : status;
}

static void add_counts(void *numbers, const void *more, size_t size)
{
    uint64_t *to = numbers;
    const uint64_t *from = more;
    for (size_t k = 0; k < size / sizeof *to; k++)
        to[k] += from[k];
}

bat_status group_sum_counts(const bat_group *group, uint64_t *numbers, size_t count, bat_error *error)
{
    return reduce(group, numbers, count * sizeof *numbers, add_counts, error);
}

static void add_largest(void *numbers, const void *more, size_t size)
{
    double *to = numbers;
    const double *from = more;
    for (size_t k = 0; k < size / sizeof *to; k++)
        to[k] = fmax(to[k], from[k]);
}

bat_status group_largest(const bat_group *group, double *numbers, size_t count, bat_error *error)
{
    return reduce(group, numbers, count * sizeof *numbers, add_largest, error);
}

bat_status group_sum_before(const bat_group *group, uint64_t number, uint64_t *sum, bat_error *error)
{
    *sum = 0;
    if (group_count(group) == 1)
        return BAT_OK;
    uint64_t *each = calloc(group->count, sizeof *each);
    if (each == NULL)
        return error_memory(error, group->count * sizeof *each);
    each[group->rank] = number;
    bat_status status = group_sum_counts(group, each, group->count, error);
    for (size_t rank = 0; rank < group->rank; rank++)
        *sum += each[rank];
    free(each);
    return status;
}
