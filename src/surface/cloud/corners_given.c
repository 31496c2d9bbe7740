#include "batten/cloud.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/// Where the loop has a point of the input.
static size_t find_place(const bat_cloud *cloud, size_t point)
{
    for (size_t i = 0; i < cloud->boundary_count; i++)
        if ((cloud->order == NULL ? i : cloud->order[i]) == point)
            return i;
    return BAT_NO_INDEX;
}

/// How places of the loop move: one becomes the first, and the way round may turn over.
typedef struct loop_turn
{
    size_t first, count;
    bool reversed;
} loop_turn;

static size_t turned_place(const loop_turn *turn, size_t place)
{
    return turn->reversed ? (turn->first + turn->count - place) % turn->count
                          : (place + turn->count - turn->first) % turn->count;
}

/// Whether the other corners follow the first one around the loop; `turned` receives their places then.
static bool corners_rise(const loop_turn *turn, const size_t places[4], size_t turned[4])
{
    for (int k = 0; k < 4; k++)
        turned[k] = turned_place(turn, places[k]);
    return turned[0] < turned[1] && turned[1] < turned[2] && turned[2] < turned[3];
}

static void turn_triangles(bat_cloud *cloud, const loop_turn *turn)
{
    for (size_t i = 0; i < 3 * cloud->triangle_count; i++)
        if (cloud->triangles[i] < turn->count)
            cloud->triangles[i] = (uint32_t)turned_place(turn, cloud->triangles[i]);
    for (size_t t = 0; t < cloud->triangle_count && turn->reversed; t++)
    {
        uint32_t *triangle = cloud->triangles + 3 * t, corner = triangle[1];
        triangle[1] = triangle[2];
        triangle[2] = corner;
    }
}

static bat_status turn_loop(bat_cloud *cloud, const loop_turn *turn, bat_error *error)
{
    size_t count = turn->count;
    double *points = memory_array(count, 3 * sizeof *points);
    size_t *order = memory_array(cloud->count, sizeof *order);
    if (points == NULL || order == NULL)
    {
        free(points);
        free(order);
        return error_memory(error, cloud->count * 3 * sizeof *points);
    }
    for (size_t i = 0; i < cloud->count; i++)
        order[i < count ? turned_place(turn, i) : i] = cloud->order == NULL ? i : cloud->order[i];
    for (size_t i = 0; i < count; i++)
        memcpy(points + 3 * turned_place(turn, i), cloud->points + 3 * i, 3 * sizeof *points);
    memcpy(cloud->points, points, 3 * count * sizeof *points);
    turn_triangles(cloud, turn);
    free(cloud->order);
    free(points);
    cloud->order = order;
    return BAT_OK;
}

bat_status bat_cloud_set_corners(bat_cloud *cloud, const size_t corners[4], bat_error *error)
{
    size_t places[4], turned[4];
    if (cloud->boundary_count < 4)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the cloud has no boundary");
    for (int k = 0; k < 4; k++)
    {
        places[k] = find_place(cloud, corners[k]);
        if (places[k] == BAT_NO_INDEX)
            return error_set(error, BAT_INVALID_ARGUMENT, corners[k], 0, "corner %zu is no point of the boundary",
                             corners[k]);
    }
    loop_turn turn = {places[0], cloud->boundary_count, false};
    if (!corners_rise(&turn, places, turned))
        turn.reversed = true;
    if (!corners_rise(&turn, places, turned))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "corners %zu, %zu, %zu, %zu do not follow each other around the boundary", corners[0], corners[1],
                         corners[2], corners[3]);
    bat_status status = turn_loop(cloud, &turn, error);
    if (status != BAT_OK)
        return status;
    memcpy(cloud->corners, turned, sizeof turned);
    cloud->has_corners = true;
    return BAT_OK;
}
