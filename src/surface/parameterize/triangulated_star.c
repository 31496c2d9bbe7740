#include "surface/parameterize/triangulated_star.h"

#include "base/error.h"
#include "base/memory.h"

#include <libqhull_r/libqhull_r.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// A neighbour of the middle: its place, and the direction there.
typedef struct spoke
{
    double angle;
    size_t place;
} spoke;

static int compare_spokes(const void *a, const void *b)
{
    const spoke *first = a, *second = b;
    return (first->angle > second->angle) - (first->angle < second->angle);
}

static bool add_spoke(const double (*planar)[2], size_t middle, size_t place, spoke spokes[STAR_RING], size_t *count)
{
    for (size_t k = 0; k < *count; k++)
        if (spokes[k].place == place)
            return true;
    if (*count == STAR_RING)
        return false;
    double angle = atan2(planar[place][1] - planar[middle][1], planar[place][0] - planar[middle][0]);
    spokes[(*count)++] = (spoke){.angle = angle, .place = place};
    return true;
}

/// Gathers the corners of the triangles around the middle; returns how many there are, 0 for too many.
static size_t gather_spokes(qhT *qh, const double (*planar)[2], size_t middle, spoke spokes[STAR_RING])
{
    size_t count = 0;
    facetT *facet;
    vertexT *vertex, **vertexp;
    FORALLfacets
    {
        if (facet->upperdelaunay)
            continue;
        bool holds = false;
        FOREACHvertex_(facet->vertices) holds |= (size_t)qh_pointid(qh, vertex->point) == middle;
        FOREACHvertex_(facet->vertices)
        {
            size_t place = (size_t)qh_pointid(qh, vertex->point);
            if (holds && place != middle && !add_spoke(planar, middle, place, spokes, &count))
                return 0;
        }
    }
    return count;
}

bat_status triangulated_star_find(const double (*planar)[2], size_t count, size_t middle, size_t ring[STAR_RING],
                                  size_t *ring_count, bat_error *error)
{
    *ring_count = 0;
    if (count < 4)
        return BAT_OK;
    char unread[256];
    coordT *points = memory_array(count, 2 * sizeof *points);
    FILE *messages = fmemopen(unread, sizeof unread, "w");
    qhT *qh = malloc(sizeof *qh);
    if (points == NULL || messages == NULL || qh == NULL)
    {
        free(points);
        free(qh);
        if (messages != NULL)
            (void)fclose(messages);
        return error_memory(error, count * 2 * sizeof *points);
    }
    memcpy(points, planar, count * 2 * sizeof *points);
    qh_zero(qh, messages);
    char options[] = "qhull d Qt Qbb Qc";
    spoke spokes[STAR_RING];
    // A failure of Qhull is one of the points: too few of them, or all in line.
    if (qh_new_qhull(qh, 2, (int)count, points, False, options, NULL, messages) == 0)
    {
        size_t found = gather_spokes(qh, planar, middle, spokes);
        qsort(spokes, found, sizeof *spokes, compare_spokes);
        *ring_count = found >= 3 ? found : 0;
    }
    for (size_t k = 0; k < *ring_count; k++)
        ring[k] = spokes[k].place;
    int left = 0, total = 0;
    qh_freeqhull(qh, !qh_ALL);
    qh_memfreeshort(qh, &left, &total);
    (void)fclose(messages);
    free(points);
    free(qh);
    return BAT_OK;
}
