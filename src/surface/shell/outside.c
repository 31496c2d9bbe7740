/// @file
/// Orientation of tangent planes by the outside of the points of a shell; see shell.h.

#include "surface/shell/shell.h"

#define OUTSIDE_CELLS 200 ///< most cells along the longest side of the grid that finds the outside
#define OUTSIDE_MARGIN 8
#define OUTSIDE_REACH 32 ///< steps
#define WALL 1
#define OUTSIDE 2

/// Share of points from which the outside orients all.
static const double MIN_DECIDED = 0.8;
/// Radius of the wall around a point, in its spacings and in cells, and the length of a step through it in cells.
static const double WALL_SPACINGS = 2.5, MIN_WALL = 2.5, MAX_WALL = 8, OUTSIDE_STEP = 0.5;

/// A grid of cells: 0 unknown, WALL near points, OUTSIDE reached from the border.
typedef struct outside_grid
{
    double cell, origin[3];
    size_t size[3];
    uint8_t *marks;
    uint32_t *queue;
} outside_grid;

static size_t mark_index(const outside_grid *grid, const double *point)
{
    size_t at[3];
    for (int d = 0; d < 3; d++)
    {
        double place = (point[d] - grid->origin[d]) / grid->cell;
        at[d] = place < 0 ? 0 : place >= (double)grid->size[d] ? grid->size[d] - 1 : (size_t)place;
    }
    return (at[2] * grid->size[1] + at[1]) * grid->size[0] + at[0];
}

/// Mark the cells within a radius of a point, in cells.
static void mark_ball(const outside_grid *grid, const double *point, double radius)
{
    int reach = (int)radius;
    for (int z = -reach; z <= reach; z++)
        for (int y = -reach; y <= reach; y++)
            for (int x = -reach; x <= reach; x++)
                if (x * x + y * y + z * z <= radius * radius)
                {
                    const double at[3] = {point[0] + x * grid->cell, point[1] + y * grid->cell, point[2] + z * grid->cell};
                    grid->marks[mark_index(grid, at)] = WALL;
                }
}

static void flood(const outside_grid *grid)
{
    const size_t *size = grid->size, layer = size[0] * size[1];
    size_t begin = 0, end = 1;
    grid->queue[0] = 0;
    grid->marks[0] = OUTSIDE;
    while (begin < end)
    {
        size_t cell = grid->queue[begin++], at[3] = {cell % size[0], cell / size[0] % size[1], cell / layer};
        const size_t step[3] = {1, size[0], layer};
        for (int d = 0; d < 3; d++)
            for (int side = 0; side < 2; side++)
            {
                if (side == 0 ? at[d] == 0 : at[d] + 1 == size[d])
                    continue;
                size_t next = side == 0 ? cell - step[d] : cell + step[d];
                if (grid->marks[next] != 0)
                    continue;
                grid->marks[next] = OUTSIDE;
                grid->queue[end++] = (uint32_t)next;
            }
    }
}

/// The number of cells from a point to the outside along a direction; OUTSIDE_REACH where it is farther.
static int cells_to_outside(const outside_grid *grid, const double *point, const double *direction, double sign)
{
    for (int k = 1; k < OUTSIDE_REACH; k++)
    {
        double at[3];
        for (int d = 0; d < 3; d++)
            at[d] = point[d] + sign * k * OUTSIDE_STEP * grid->cell * direction[d];
        if (grid->marks[mark_index(grid, at)] == OUTSIDE)
            return k;
    }
    return OUTSIDE_REACH;
}

bat_status shell_orient(const shell_cloud *cloud, oriented_planes *planes, bool *outward, bat_error *error)
{
    const double *low = cloud->tree->boxes[1].low, *high = cloud->tree->boxes[1].high;
    double extent = fmax(fmax(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    outside_grid grid = {.cell = fmax(cloud->spacing, extent / OUTSIDE_CELLS)};
    size_t cells = 1, decided = 0;
    for (int d = 0; d < 3; d++)
    {
        grid.origin[d] = low[d] - OUTSIDE_MARGIN * grid.cell;
        grid.size[d] = (size_t)((high[d] - low[d]) / grid.cell) + 2 * OUTSIDE_MARGIN + 1;
        cells *= grid.size[d];
    }
    memory_pool pool = {0};
    grid.marks = memory_pool_zeros(&pool, cells, sizeof *grid.marks);
    grid.queue = memory_pool_array(&pool, cells, sizeof *grid.queue);
    int8_t *votes = memory_pool_zeros(&pool, cloud->count, sizeof *votes);
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
    {
        for (size_t i = 0; i < cloud->count; i++)
            mark_ball(&grid, cloud->points + 3 * i,
                      fmin(fmax(WALL_SPACINGS * sqrt(cloud->areas[i]) / grid.cell, MIN_WALL), MAX_WALL));
        flood(&grid);
        for (size_t i = 0; i < cloud->count; i++)
        {
            const double *point = cloud->points + 3 * i, *normal = planes->planes[i].axes[2];
            int ahead = cells_to_outside(&grid, point, normal, 1), behind = cells_to_outside(&grid, point, normal, -1);
            votes[i] = (int8_t)((ahead < behind) - (behind < ahead));
            decided += votes[i] != 0;
        }
    }
    *outward = (double)decided > MIN_DECIDED * (double)cloud->count;
    for (size_t i = 0; i < cloud->count && status == BAT_OK && *outward; i++)
        for (int d = 0; d < 3 && votes[i] < 0; d++)
            planes->planes[i].axes[2][d] *= -1;
    memory_pool_free(&pool);
    return status;
}
