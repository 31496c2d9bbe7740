#include "mesh/decimate/collapse.h"

#include <math.h>
#include <string.h>

/// @file
/// A heap with four children for each node, with the place of every edge, or an unordered array for random choices.

#define CHILDREN 4

bat_status edge_queue_make(size_t edges, size_t candidates, uint64_t seed, memory_pool *pool, edge_queue *queue,
                           bat_error *error)
{
    *queue = (edge_queue){.items = memory_pool_array(pool, edges, sizeof *queue->items),
                          .place = memory_pool_array(pool, edges, sizeof *queue->place),
                          .candidates = candidates < edges ? candidates : 0,
                          .random = bat_random_seed(seed)};
    if (queue->place != NULL)
        memset(queue->place, 0xff, edges * sizeof *queue->place);
    return memory_pool_check(pool, error);
}

static bool comes_before(const edge_queue_item *a, const edge_queue_item *b)
{
    return a->error < b->error || (a->error == b->error && a->edge < b->edge);
}

static void set_item(edge_queue *queue, size_t place, edge_queue_item item)
{
    queue->items[place] = item;
    queue->place[item.edge] = (uint32_t)place;
}

static void move_up(edge_queue *queue, size_t place, edge_queue_item item)
{
    while (place > 0)
    {
        size_t parent = (place - 1) / CHILDREN;
        if (!comes_before(&item, &queue->items[parent]))
            break;
        set_item(queue, place, queue->items[parent]);
        place = parent;
    }
    set_item(queue, place, item);
}

static void move_down(edge_queue *queue, size_t place, edge_queue_item item)
{
    for (size_t child = CHILDREN * place + 1; child < queue->count; child = CHILDREN * place + 1)
    {
        size_t end = child + CHILDREN < queue->count ? child + CHILDREN : queue->count;
        size_t smallest = child;
        for (size_t other = child + 1; other < end; other++)
            if (comes_before(&queue->items[other], &queue->items[smallest]))
                smallest = other;
        if (!comes_before(&queue->items[smallest], &item))
            break;
        set_item(queue, place, queue->items[smallest]);
        place = smallest;
    }
    set_item(queue, place, item);
}

/// Store an item at the place of another one, and restore the heap.
static void replace_item(edge_queue *queue, size_t place, edge_queue_item item)
{
    if (queue->candidates > 0)
        set_item(queue, place, item);
    else if (place > 0 && comes_before(&item, &queue->items[(place - 1) / CHILDREN]))
        move_up(queue, place, item);
    else
        move_down(queue, place, item);
}

void edge_queue_fill(edge_queue *queue, const double *errors, size_t edges)
{
    for (size_t e = 0; e < edges; e++)
        if (isfinite(errors[e]))
            set_item(queue, queue->count++, (edge_queue_item){errors[e], (uint32_t)e});
    for (size_t place = queue->count / CHILDREN + 1; place-- > 0 && queue->candidates == 0;)
        if (place < queue->count)
            move_down(queue, place, queue->items[place]);
}

void edge_queue_put(edge_queue *queue, uint32_t edge, double error)
{
    size_t place = queue->place[edge];
    if (place == EDGE_QUEUE_ABSENT)
        place = queue->count++;
    replace_item(queue, place, (edge_queue_item){error, edge});
}

void edge_queue_remove(edge_queue *queue, uint32_t edge)
{
    size_t place = queue->place[edge];
    if (place == EDGE_QUEUE_ABSENT)
        return;
    queue->place[edge] = EDGE_QUEUE_ABSENT;
    edge_queue_item last = queue->items[--queue->count];
    if (place < queue->count)
        replace_item(queue, place, last);
}

/// A random integer below `bound` <= 2^32, with a bias below bound / 2^32.
static size_t random_below(bat_random *random, size_t bound)
{
    return (size_t)(((bat_random_bits(random) >> 32) * bound) >> 32);
}

uint32_t edge_queue_take(edge_queue *queue)
{
    if (queue->count == 0)
        return EDGE_QUEUE_ABSENT;
    size_t smallest = queue->candidates > 0 ? random_below(&queue->random, queue->count) : 0;
    for (size_t i = 1; i < queue->candidates; i++)
    {
        size_t other = random_below(&queue->random, queue->count);
        if (comes_before(&queue->items[other], &queue->items[smallest]))
            smallest = other;
    }
    uint32_t edge = queue->items[smallest].edge;
    edge_queue_remove(queue, edge);
    return edge;
}
