#include "surface/virtual_points.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector2.h"

#include <math.h>
#include <stdlib.h>

void virtual_points_free(virtual_points *guides)
{
    free(guides->places);
    free(guides->parameters);
    *guides = (virtual_points){0};
}

/// The first node of a side that is not before a parameter.
static size_t node_from(double parameter, size_t side)
{
    double node = ceil(parameter * (double)side - 0.5);
    return node > 0 ? (size_t)fmin(node, (double)side) : 0;
}

/// Add a place with the shares of three corners.
static void add_place(const double *const place[3], const double *const at[3], const double share[3], virtual_points *guides)
{
    for (size_t d = 0; d < 3; d++)
        guides->places[3 * guides->count + d] = share[0] * place[0][d] + share[1] * place[1][d] + share[2] * place[2][d];
    for (size_t d = 0; d < 2; d++)
        guides->parameters[2 * guides->count + d] =
            fmin(fmax(share[0] * at[0][d] + share[1] * at[1][d] + share[2] * at[2][d], 0), 1);
    guides->count++;
}

/// Add the centre of a triangle, and its nodes that no other triangle has.
static void add_triangle(const bat_cloud *cloud, const double *parameters, const uint32_t *corners, size_t side, bool *taken,
                         virtual_points *guides)
{
    const double *at[3], *place[3];
    for (size_t k = 0; k < 3; k++)
    {
        at[k] = parameters + 2 * (size_t)corners[k];
        place[k] = cloud->points + 3 * (size_t)corners[k];
    }
    static const double CENTRE[3] = {1.0 / 3, 1.0 / 3, 1.0 / 3};
    double area = vector2_turn(at[0], at[1], at[2]), low[2], high[2];
    add_place(place, at, CENTRE, guides);
    if (area == 0)
        return;
    for (size_t d = 0; d < 2; d++)
    {
        low[d] = fmin(at[0][d], fmin(at[1][d], at[2][d]));
        high[d] = fmax(at[0][d], fmax(at[1][d], at[2][d]));
    }
    for (size_t j = node_from(low[1], side); j < side && ((double)j + 0.5) / (double)side <= high[1]; j++)
        for (size_t i = node_from(low[0], side); i < side && ((double)i + 0.5) / (double)side <= high[0]; i++)
        {
            double node[2] = {((double)i + 0.5) / (double)side, ((double)j + 0.5) / (double)side};
            double share[3] = {vector2_turn(node, at[1], at[2]) / area, vector2_turn(at[0], node, at[2]) / area, 0};
            share[2] = 1 - share[0] - share[1];
            if (taken[j * side + i] || share[0] < 0 || share[1] < 0 || share[2] < 0)
                continue;
            taken[j * side + i] = true;
            add_place(place, at, share, guides);
        }
}

bat_status virtual_points_make(const bat_cloud *cloud, const double *parameters, virtual_points *guides, bat_error *error)
{
    size_t side = (size_t)ceil(sqrt((double)cloud->count)), nodes = side * side;
    size_t most = nodes + cloud->triangle_count;
    *guides = (virtual_points){.places = memory_array(most, 3 * sizeof *guides->places),
                               .parameters = memory_array(most, 2 * sizeof *guides->parameters)};
    bool *taken = calloc(nodes + 1, sizeof *taken);
    bool made = guides->places != NULL && guides->parameters != NULL && taken != NULL;
    for (size_t t = 0; t < cloud->triangle_count && made; t++)
        add_triangle(cloud, parameters, cloud->triangles + 3 * t, side, taken, guides);
    free(taken);
    if (made)
        return BAT_OK;
    virtual_points_free(guides);
    return error_memory(error, most * 5 * sizeof *guides->places);
}
