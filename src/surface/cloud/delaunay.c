/// @file
/// Delaunay triangulations; see delaunay.h.

#include "surface/cloud/delaunay.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector.h"

#include <libqhull_r/libqhull_r.h>
#include <stdio.h>
#include <string.h>

void simplices_free(simplices *made)
{
    free(made->corners);
    *made = (simplices){0};
}

/// Copy the facets of the lower hull. Null when out of memory, or where a facet is no simplex.
static uint32_t *gather(qhT *qh, size_t dimension, size_t points, size_t *count)
{
    facetT *facet;
    size_t facets = 0, made = 0;
    FORALLfacets facets += !facet->upperdelaunay;
    uint32_t *corners = memory_array(facets, (dimension + 1) * sizeof *corners);
    if (corners == NULL)
        return NULL;
    FORALLfacets
    {
        vertexT *vertex, **vertexp;
        size_t found = 0;
        if (facet->upperdelaunay)
            continue;
        FOREACHvertex_(facet->vertices)
        {
            int point = qh_pointid(qh, vertex->point);
            if (found <= dimension && point >= 0 && (size_t)point < points)
                corners[(dimension + 1) * made + found++] = (uint32_t)point;
        }
        made += found == dimension + 1;
    }
    *count = made;
    return corners;
}

/// Triangulate points.
/// @param points  count x dimension
/// @param made    receives the simplices; none where Qhull finds none
static bat_status triangulate(const double *points, size_t dimension, size_t count, simplices *made, bat_error *error)
{
    char unread[256];
    coordT *copy = memory_array(count, dimension * sizeof *copy);
    FILE *messages = fmemopen(unread, sizeof unread, "w");
    qhT *qh = malloc(sizeof *qh);
    *made = (simplices){0};
    if (copy == NULL || messages == NULL || qh == NULL)
    {
        free(copy);
        free(qh);
        if (messages != NULL)
            (void)fclose(messages);
        return error_memory(error, count * dimension * sizeof *copy);
    }
    memcpy(copy, points, count * dimension * sizeof *copy);
    qh_zero(qh, messages);
    char options[] = "qhull d Qt Qbb Qc";
    // Qhull fails for too few points, and for those of a lower dimension.
    bool is_made = qh_new_qhull(qh, (int)dimension, (int)count, copy, False, options, NULL, messages) == 0;
    if (is_made)
        made->corners = gather(qh, dimension, count, &made->count);
    int left = 0, total = 0;
    qh_freeqhull(qh, !qh_ALL);
    qh_memfreeshort(qh, &left, &total);
    (void)fclose(messages);
    free(copy);
    free(qh);
    return !is_made || made->corners != NULL ? BAT_OK : error_memory(error, count * sizeof *copy);
}

bat_status planar_delaunay(const double (*planar)[2], size_t count, simplices *triangles, bat_error *error)
{
    *triangles = (simplices){0};
    if (count < 4)
        return BAT_OK;
    bat_status status = triangulate(&planar[0][0], 2, count, triangles, error);
    size_t found = triangles->count;
    triangles->count = 0;
    // Turn the triangles counter-clockwise, and leave out degenerate ones.
    for (size_t t = 0; t < found; t++)
    {
        uint32_t corners[3];
        memcpy(corners, triangles->corners + 3 * t, sizeof corners);
        double area = vector2_turn(planar[corners[0]], planar[corners[1]], planar[corners[2]]);
        if (area == 0)
            continue;
        if (area < 0)
            SWAP(corners[1], corners[2]);
        memcpy(triangles->corners + 3 * triangles->count++, corners, sizeof corners);
    }
    return status;
}

bat_status spatial_delaunay(const double *points, size_t count, simplices *tetrahedra, bat_error *error)
{
    *tetrahedra = (simplices){0};
    return count < 5 ? BAT_OK : triangulate(points, 3, count, tetrahedra, error);
}
