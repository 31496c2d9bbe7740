#include "polyline_simple.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

typedef struct box_edge
{
    double low[2], high[2];
    const double *p, *q;
    size_t edge;
} box_edge;

static int compare_edges(const void *a, const void *b)
{
    const box_edge *first = a, *second = b;
    if (first->low[0] != second->low[0])
        return first->low[0] < second->low[0] ? -1 : 1;
    return first->edge < second->edge ? -1 : first->edge > second->edge;
}

/// The sign of the area of a triangle: 1, 0 or -1.
static int turn(const double *a, const double *b, const double *c)
{
    double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    return (area > 0) - (area < 0);
}

/// Whether a point on the line of an edge lies within the edge's box.
static bool within(const box_edge *edge, const double *point)
{
    return edge->low[0] <= point[0] && point[0] <= edge->high[0] && edge->low[1] <= point[1] && point[1] <= edge->high[1];
}

static bool edges_meet(const box_edge *a, const box_edge *b)
{
    int p = turn(a->p, a->q, b->p), q = turn(a->p, a->q, b->q), r = turn(b->p, b->q, a->p), s = turn(b->p, b->q, a->q);
    if (p * q < 0 && r * s < 0)
        return true;
    return (p == 0 && within(a, b->p)) || (q == 0 && within(a, b->q)) || (r == 0 && within(b, a->p)) ||
           (s == 0 && within(b, a->q));
}

/// Whether two edges fold back over each other, the second beginning where the first ends.
static bool folds_back(const box_edge *first, const box_edge *second)
{
    const double *a = first->p, *v = second->p, *b = second->q;
    return turn(a, v, b) == 0 && (a[0] - v[0]) * (b[0] - v[0]) + (a[1] - v[1]) * (b[1] - v[1]) > 0;
}

static bool conflict(const box_edge *a, const box_edge *b, size_t edges, bool closed)
{
    const box_edge *first = a->edge < b->edge ? a : b, *second = first == a ? b : a;
    if (first->edge + 1 == second->edge)
        return folds_back(first, second);
    if (closed && first->edge == 0 && second->edge + 1 == edges)
        return folds_back(second, first);
    return a->low[1] <= b->high[1] && b->low[1] <= a->high[1] && edges_meet(a, b);
}

/// The edges of positive length, in order. Returns their number.
static size_t collect(const double *points, size_t count, bool closed, box_edge *edges)
{
    size_t made = 0;
    for (size_t i = 0; i < (closed ? count : count - 1); i++)
    {
        const double *p = points + 2 * i, *q = points + 2 * (i + 1 == count ? 0 : i + 1);
        if (p[0] == q[0] && p[1] == q[1])
            continue;
        edges[made] = (box_edge){.low = {fmin(p[0], q[0]), fmin(p[1], q[1])},
                                 .high = {fmax(p[0], q[0]), fmax(p[1], q[1])},
                                 .p = p,
                                 .q = q,
                                 .edge = made};
        made++;
    }
    return made;
}

bat_status polyline_is_simple(const double *points, size_t count, bool closed, bool *simple, bat_error *error)
{
    *simple = true;
    if (count < 2)
        return BAT_OK;
    box_edge *edges = memory_array(count, sizeof *edges);
    if (edges == NULL)
        return error_memory(error, count * sizeof *edges);
    size_t made = collect(points, count, closed, edges);
    qsort(edges, made, sizeof *edges, compare_edges);
    for (size_t i = 0; i < made && *simple; i++)
        for (size_t j = i + 1; j < made && edges[j].low[0] <= edges[i].high[0] && *simple; j++)
            *simple = !conflict(&edges[i], &edges[j], made, closed);
    free(edges);
    return BAT_OK;
}
