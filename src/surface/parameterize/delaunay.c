/// @file
/// Delaunay triangulations; see delaunay.h.

#include "surface/parameterize/delaunay.h"

#include "base/error.h"
#include "base/memory.h"

#include <libqhull_r/libqhull_r.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void planar_triangles_free(planar_triangles *triangles)
{
    free(triangles->corners);
    *triangles = (planar_triangles){0};
}

/// Twice the signed area.
static double doubled_area(const double (*planar)[2], const uint32_t corners[3])
{
    const double *a = planar[corners[0]], *b = planar[corners[1]], *c = planar[corners[2]];
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static void add_facet(qhT *qh, const double (*planar)[2], size_t count, facetT *facet, planar_triangles *triangles)
{
    vertexT *vertex, **vertexp;
    uint32_t corners[3] = {0};
    size_t found = 0;
    FOREACHvertex_(facet->vertices)
    {
        int point = qh_pointid(qh, vertex->point);
        if (found == 3 || point < 0 || (size_t)point >= count)
            return;
        corners[found++] = (uint32_t)point;
    }
    double area = found == 3 ? doubled_area(planar, corners) : 0;
    if (area == 0)
        return;
    if (area < 0)
    {
        uint32_t swap = corners[1];
        corners[1] = corners[2];
        corners[2] = swap;
    }
    memcpy(triangles->corners + 3 * triangles->count++, corners, sizeof corners);
}

/// Copy the facets of the lower hull. False when out of memory.
static bool gather(qhT *qh, const double (*planar)[2], size_t count, planar_triangles *triangles)
{
    facetT *facet;
    size_t facets = 0;
    FORALLfacets facets += !facet->upperdelaunay;
    triangles->corners = memory_array(facets, 3 * sizeof *triangles->corners);
    if (triangles->corners == NULL)
        return false;
    FORALLfacets if (!facet->upperdelaunay) add_facet(qh, planar, count, facet, triangles);
    return true;
}

bat_status planar_delaunay(const double (*planar)[2], size_t count, planar_triangles *triangles, bat_error *error)
{
    *triangles = (planar_triangles){0};
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
    // Qhull fails for too few or collinear points.
    bool made =
        qh_new_qhull(qh, 2, (int)count, points, False, options, NULL, messages) != 0 || gather(qh, planar, count, triangles);
    int left = 0, total = 0;
    qh_freeqhull(qh, !qh_ALL);
    qh_memfreeshort(qh, &left, &total);
    (void)fclose(messages);
    free(points);
    free(qh);
    return made ? BAT_OK : error_memory(error, count * sizeof *points);
}
