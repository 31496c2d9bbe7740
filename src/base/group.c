#include "base/group.h"

#include <string.h>

/// What the processes agree on.
typedef struct outcome
{
    bat_status status;
    bat_error error;
} outcome;

group_items group_items_of(const bat_group *group, size_t count)
{
    size_t rank = group_rank(group), ranks = group_count(group);
    size_t each = count / ranks, more = count % ranks;
    size_t begin = rank * each + (rank < more ? rank : more);
    return (group_items){begin, begin + each + (rank < more ? 1 : 0)};
}

bat_status group_broadcast(const bat_group *group, size_t root, void *bytes, size_t size, bat_error *error)
{
    size_t rank = group_rank(group), ranks = group_count(group);
    size_t before = (rank + ranks - 1) % ranks, next = (rank + 1) % ranks;
    bat_status status = BAT_OK;
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

bat_status group_collect(const bat_group *group, void *items, size_t size, size_t count, bat_status status, bat_error *error)
{
    size_t rank = group_rank(group), last = group_count(group) - 1;
    group_items share = group_items_of(group, count);
    status = bat_group_agree(group, status, error);
    if (last == 0 || status != BAT_OK)
        return status;
    if (rank > 0 && share.begin > 0)
        status = group->receive(group->context, rank - 1, items, share.begin * size, error);
    if (status == BAT_OK && rank < last && share.end > 0)
        status = group->send(group->context, rank + 1, items, share.end * size, error);
    return status == BAT_OK ? group_broadcast(group, last, items, count * size, error) : status;
}
