#include "curve/topology/draw_back.h"

#include "base/error.h"
#include "base/memory.h"
#include "curve/topology/edge_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t cell_along(const anchor_grid *grid, double value, int axis)
{
    size_t cells = axis == 0 ? grid->columns : grid->rows;
    double place = (value - grid->low[axis]) / grid->cell[axis];
    return !(place > 0) ? 0 : place >= (double)cells ? cells - 1 : (size_t)place;
}

static size_t cell_of(const anchor_grid *grid, const double *point)
{
    return cell_along(grid, point[1], 1) * grid->columns + cell_along(grid, point[0], 0);
}

/// About one anchor a cell.
static void lay_out(const double *points, anchor_grid *grid)
{
    double high[2] = {-INFINITY, -INFINITY};
    grid->low[0] = grid->low[1] = INFINITY;
    for (size_t i = 0; i < grid->count; i++)
        for (size_t k = 0; k < 2; k++)
        {
            grid->low[k] = fmin(grid->low[k], points[2 * i + k]);
            high[k] = fmax(high[k], points[2 * i + k]);
        }
    grid->columns = grid->rows = 1 + (size_t)sqrt((double)grid->count);
    for (size_t k = 0; k < 2; k++)
    {
        double size = (high[k] - grid->low[k]) / (double)grid->columns;
        grid->cell[k] = size > 0 ? size : 1;
    }
}

bat_status anchor_grid_make(const double *points, const size_t *components, size_t count, anchor_grid *grid,
                            bat_error *error)
{
    *grid = (anchor_grid){.count = count};
    if (count == 0)
        return BAT_OK;
    lay_out(points, grid);
    size_t cells = grid->columns * grid->rows;
    grid->points = memory_array(count, 2 * sizeof(double));
    grid->components = memory_array(count, sizeof(size_t));
    grid->begins = calloc(cells + 1, sizeof(size_t));
    size_t *next = memory_array(cells, sizeof *next);
    if (grid->points == NULL || grid->components == NULL || grid->begins == NULL || next == NULL)
    {
        free(next);
        anchor_grid_free(grid);
        return error_memory(error, (count + cells) * sizeof(size_t));
    }
    for (size_t i = 0; i < count; i++)
        grid->begins[cell_of(grid, points + 2 * i) + 1]++;
    for (size_t i = 0; i < cells; i++)
    {
        next[i] = grid->begins[i];
        grid->begins[i + 1] += grid->begins[i];
    }
    for (size_t i = 0; i < count; i++)
    {
        size_t place = next[cell_of(grid, points + 2 * i)]++;
        memcpy(grid->points + 2 * place, points + 2 * i, 2 * sizeof(double));
        grid->components[place] = components[i];
    }
    free(next);
    return BAT_OK;
}

void anchor_grid_free(anchor_grid *grid)
{
    free(grid->points);
    free(grid->components);
    free(grid->begins);
    *grid = (anchor_grid){0};
}

static bool is_inside(const double *polygon, size_t count, const double *point)
{
    bool inside = false;
    for (size_t i = 0, j = count - 1; i < count; j = i++)
    {
        const double *a = polygon + 2 * j, *b = polygon + 2 * i;
        if ((a[1] > point[1]) == (b[1] > point[1]))
            continue;
        int side = predicate_orientation(SURFACE_PLANE, a, b, point);
        inside ^= b[1] > a[1] ? side > 0 : side < 0;
    }
    return inside;
}

bool anchor_grid_inside(const anchor_grid *grid, const double *polygon, size_t count, size_t component)
{
    if (grid->count == 0)
        return false;
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 2; k++)
        {
            double value = polygon[2 * i + k];
            low[k] = value < low[k] ? value : low[k];
            high[k] = value > high[k] ? value : high[k];
        }
    size_t last_column = cell_along(grid, high[0], 0), last_row = cell_along(grid, high[1], 1);
    for (size_t row = cell_along(grid, low[1], 1); row <= last_row; row++)
        for (size_t column = cell_along(grid, low[0], 0); column <= last_column; column++)
        {
            size_t cell = row * grid->columns + column;
            for (size_t i = grid->begins[cell]; i < grid->begins[cell + 1]; i++)
            {
                const double *point = grid->points + 2 * i;
                bool near = point[0] >= low[0] && point[0] <= high[0] && point[1] >= low[1] && point[1] <= high[1];
                if (near && grid->components[i] != component && is_inside(polygon, count, point))
                    return true;
            }
        }
    return false;
}
