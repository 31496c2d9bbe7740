/// @file
/// The connection of the points of a shell: the zero level of a smooth signed distance (Calakli and Taubin, "SSD: smooth
/// signed distance surface reconstruction", 2011). With the area a_i and the normal n_i of point x_i, f minimizes
///
///     sum a_i (f(x_i)^2 + |grad f(x_i) - n_i|^2) + lambda sum |second differences of f|^2
///
/// over functions that are trilinear in the cells of a cubic grid; lengths are in cells. The first grid is coarse and full.
/// Each further one has half the cells' size and only the cells near points and near the zero level, with the values of the
/// last grid on its border. The zero level is cut out of six tetrahedra in each cell, which leaves no ambiguous case.

#include "surface/shell/shell.h"

#include "base/array_grow.h"
#include "base/progress.h"
#include "linalg/vector.h"
#include "mesh/hash_table.h"

#include <string.h>

#define FIRST_CELLS 12 ///< least number of cells of the first grid along the longest side
#define FULL_CELLS 64  ///< most cells of a full grid
#define MAX_CELLS 400  ///< of the last grid
#define MARGIN 3       ///< cells of the first grid around the points
#define NEIGHBOURS 9   ///< stored for each node
#define ITERATIONS 300
#define OUTSIDE_ROUNDS 3

/// Weights of smoothness without noise, and with noise of the size of a cell.
static const double SMOOTHNESS[2] = {0.3, 1.5};
static const double ACCURACY = 1e-4;
/// Bounds of the area of a point, in cells.
static const double MIN_AREA = 0.02, MAX_AREA = 8;
/// Cuts keep this share of an edge from its ends, so that triangles have no tiny angles.
static const double MIN_CUT = 0.15;

static const uint32_t NONE = UINT32_MAX;

/// A grid. Coordinates of nodes are whole numbers from 0.
typedef struct level_grid
{
    double cell, origin[3];
    uint64_t size[3]; ///< nodes
    key_map nodes;    ///< numbers of the nodes
    uint64_t *keys;   ///< count
    double *values;   ///< count: f in cells
    bool *fixed;      ///< count
    uint32_t *around; ///< count x NEIGHBOURS: -x +x -y +y -z +z, then +x+y +x+z +y+z
    size_t count, key_capacity;
    uint64_t *cells; ///< keys of their first nodes
    size_t cell_count, cell_capacity;
    memory_pool pool;
} level_grid;

/// A point in a grid.
typedef struct level_point
{
    uint32_t nodes[8];
    double at[3]; ///< in its cell
} level_point;

typedef struct connection
{
    const double *points;
    size_t count;
    const nearest_tree *tree;
    oriented_planes *planes;
    double *areas; ///< count
    level_grid grid;
    level_point *places;      ///< count
    double noise, smoothness; ///< lambda
    shell_outside outside;
    memory_pool pool;
} connection;

static void grid_free(level_grid *grid)
{
    key_map_free(&grid->nodes);
    free(grid->keys);
    free(grid->cells);
    memory_pool_free(&grid->pool);
    *grid = (level_grid){0};
}

static uint64_t key_at(const level_grid *grid, const uint64_t at[3])
{
    return (at[2] * grid->size[1] + at[1]) * grid->size[0] + at[0];
}

static void place_of(const level_grid *grid, uint64_t key, uint64_t at[3])
{
    at[0] = key % grid->size[0];
    at[1] = key / grid->size[0] % grid->size[1];
    at[2] = key / grid->size[0] / grid->size[1];
}

/// The number of a node, which is made where it is new; NONE when out of memory.
static uint32_t add_node(level_grid *grid, uint64_t key)
{
    uint32_t *number = key_map_at(&grid->nodes, key);
    if (number == NULL || (*number == NONE && !ARRAY_GROW(grid->keys, grid->key_capacity, grid->count + 1)))
        return NONE;
    if (*number == NONE)
    {
        *number = (uint32_t)grid->count;
        grid->keys[grid->count++] = key;
    }
    return *number;
}

/// The offset of corner c of a cell in keys.
static uint64_t corner_step(const level_grid *grid, int c)
{
    return (c & 1 ? 1 : 0) + (c & 2 ? grid->size[0] : 0) + (c & 4 ? grid->size[0] * grid->size[1] : 0);
}

static bool add_cell(level_grid *grid, uint64_t key)
{
    if (!ARRAY_GROW(grid->cells, grid->cell_capacity, grid->cell_count + 1))
        return false;
    grid->cells[grid->cell_count++] = key;
    for (int c = 0; c < 8; c++)
        if (add_node(grid, key + corner_step(grid, c)) == NONE)
            return false;
    return true;
}

static uint32_t node_beside(const level_grid *grid, const uint64_t at[3], const int step[3])
{
    uint64_t to[3];
    for (int d = 0; d < 3; d++)
    {
        if ((step[d] < 0 && at[d] == 0) || (step[d] > 0 && at[d] + 1 >= grid->size[d]))
            return NONE;
        to[d] = at[d] + (uint64_t)(int64_t)step[d];
    }
    return key_map_find(&grid->nodes, key_at(grid, to));
}

/// Link the nodes, and fix those without all neighbours on the axes; of a full grid none.
static bat_status link_nodes(level_grid *grid, bool full, bat_error *error)
{
    static const int STEPS[NEIGHBOURS][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1},
                                             {0, 0, 1},  {1, 1, 0}, {1, 0, 1},  {0, 1, 1}};
    grid->values = memory_pool_zeros(&grid->pool, grid->count, sizeof *grid->values);
    grid->fixed = memory_pool_zeros(&grid->pool, grid->count, sizeof *grid->fixed);
    grid->around = memory_pool_array(&grid->pool, grid->count, NEIGHBOURS * sizeof *grid->around);
    bat_status status = memory_pool_check(&grid->pool, error);
    for (size_t n = 0; n < grid->count && status == BAT_OK; n++)
    {
        uint64_t at[3];
        place_of(grid, grid->keys[n], at);
        for (size_t k = 0; k < NEIGHBOURS; k++)
        {
            uint32_t beside = node_beside(grid, at, STEPS[k]);
            grid->around[NEIGHBOURS * n + k] = beside;
            grid->fixed[n] = grid->fixed[n] || (!full && k < 6 && beside == NONE);
        }
    }
    return status;
}

/// The cell of a place, and the place in it.
static uint64_t cell_of(const level_grid *grid, const double *point, double at[3])
{
    uint64_t cell[3];
    for (int d = 0; d < 3; d++)
    {
        double place = (point[d] - grid->origin[d]) / grid->cell;
        cell[d] = (uint64_t)place;
        at[d] = place - (double)cell[d];
    }
    return key_at(grid, cell);
}

static void find_places(connection *work)
{
    const level_grid *grid = &work->grid;
    for (size_t i = 0; i < work->count; i++)
    {
        uint64_t cell = cell_of(grid, work->points + 3 * i, work->places[i].at);
        for (int c = 0; c < 8; c++)
            work->places[i].nodes[c] = key_map_find(&grid->nodes, cell + corner_step(grid, c));
    }
}

/// The value and the gradient at a place of a cell as weights of its corners.
static void corner_weights(const double at[3], double weights[4][8])
{
    for (int c = 0; c < 8; c++)
    {
        double share[3], slope[3];
        for (int d = 0; d < 3; d++)
        {
            bool upper = c >> d & 1;
            share[d] = upper ? at[d] : 1 - at[d];
            slope[d] = upper ? 1 : -1;
        }
        weights[0][c] = share[0] * share[1] * share[2];
        weights[1][c] = slope[0] * share[1] * share[2];
        weights[2][c] = share[0] * slope[1] * share[2];
        weights[3][c] = share[0] * share[1] * slope[2];
    }
}

/// Add half the gradient of the energy at x to `sum`; without `targets` that of its quadratic part.
static void add_gradient(const connection *work, const double *x, bool targets, double *sum)
{
    const level_grid *grid = &work->grid;
    for (size_t i = 0; i < work->count; i++)
    {
        const level_point *place = &work->places[i];
        const double *normal = work->planes->planes[i].axes[2];
        double weights[4][8];
        corner_weights(place->at, weights);
        for (int k = 0; k < 4; k++)
        {
            double value = targets && k > 0 ? -normal[k - 1] : 0;
            for (int c = 0; c < 8; c++)
                value += weights[k][c] * x[place->nodes[c]];
            for (int c = 0; c < 8; c++)
                sum[place->nodes[c]] += work->areas[i] * value * weights[k][c];
        }
    }
    for (size_t n = 0; n < grid->count; n++)
    {
        const uint32_t *around = grid->around + NEIGHBOURS * n;
        for (int d = 0; d < 3; d++)
        {
            uint32_t a = around[2 * d], b = around[2 * d + 1];
            if (a == NONE || b == NONE)
                continue;
            double bend = work->smoothness * (x[a] - 2 * x[n] + x[b]);
            sum[a] += bend;
            sum[n] -= 2 * bend;
            sum[b] += bend;
        }
        for (int k = 0; k < 3; k++)
        {
            uint32_t a = around[k == 2 ? 3 : 1], b = around[k == 0 ? 3 : 5], c = around[6 + k];
            if (a == NONE || b == NONE || c == NONE)
                continue;
            double twist = 2 * work->smoothness * (x[n] - x[a] - x[b] + x[c]);
            sum[n] += twist;
            sum[a] -= twist;
            sum[b] -= twist;
            sum[c] += twist;
        }
    }
}

/// Minimize the energy over the values of nodes that are not fixed, by conjugate gradients.
static bat_status minimize(connection *work, bat_error *error)
{
    level_grid *grid = &work->grid;
    size_t count = grid->count;
    double *residual = memory_pool_zeros(&grid->pool, count, sizeof *residual);
    double *direction = memory_pool_zeros(&grid->pool, count, sizeof *direction);
    double *product = memory_pool_array(&grid->pool, count, sizeof *product);
    bat_status status = memory_pool_check(&grid->pool, error);
    if (status != BAT_OK)
        return status;
    add_gradient(work, grid->values, true, residual);
    double square = 0, first = 0;
    for (size_t n = 0; n < count; n++)
    {
        direction[n] = residual[n] = grid->fixed[n] ? 0 : -residual[n];
        square += residual[n] * residual[n];
    }
    first = square;
    for (int k = 0; k < ITERATIONS && square > ACCURACY * ACCURACY * first && square > 0; k++)
    {
        memset(product, 0, count * sizeof *product);
        add_gradient(work, direction, false, product);
        double curvature = 0, next = 0;
        for (size_t n = 0; n < count; n++)
            curvature += grid->fixed[n] ? 0 : direction[n] * product[n];
        if (!(curvature > 0))
            break;
        double step = square / curvature;
        for (size_t n = 0; n < count; n++)
        {
            if (grid->fixed[n])
                continue;
            grid->values[n] += step * direction[n];
            residual[n] -= step * product[n];
            next += residual[n] * residual[n];
        }
        for (size_t n = 0; n < count; n++)
            direction[n] = grid->fixed[n] ? 0 : residual[n] + next / square * direction[n];
        square = next;
    }
    return BAT_OK;
}

// Grids

/// Fix nodes outside a closed surface at their distance from the points: f is positive there.
/// @param border take the nodes that are fixed, rather than those where f is negative
/// @param count  receives how many they are
static bat_status fix_outside(connection *work, bool border, size_t *count, bat_error *error)
{
    level_grid *grid = &work->grid;
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    *count = 0;
    for (size_t n = 0; n < grid->count && status == BAT_OK; n++)
    {
        uint64_t at[3];
        double place[3];
        place_of(grid, grid->keys[n], at);
        for (int d = 0; d < 3; d++)
            place[d] = grid->origin[d] + grid->cell * (double)at[d];
        if (border ? !grid->fixed[n] : grid->values[n] >= 0 || !shell_is_outside(&work->outside, place))
            continue;
        status = neighbours_nearest(work->tree, place, 1, &near, error);
        if (status != BAT_OK)
            break;
        grid->values[n] = sqrt(near.entries[0].squared) / grid->cell;
        grid->fixed[n] = true;
        ++*count;
    }
    neighbour_list_free(&near);
    return status;
}

/// Minimize the energy, again where f is negative outside a closed surface.
static bat_status minimize_inside(connection *work, bat_error *error)
{
    size_t wrong = 1;
    bat_status status = minimize(work, error);
    for (int k = 0; k < OUTSIDE_ROUNDS && status == BAT_OK && work->outside.closed && wrong > 0; k++)
    {
        status = fix_outside(work, false, &wrong, error);
        if (status == BAT_OK && wrong > 0)
            status = minimize(work, error);
    }
    return status;
}

static bat_status first_grid(connection *work, double cell, bat_error *error)
{
    level_grid *grid = &work->grid;
    const double *low = nearest_bounds(work->tree), *high = low + 3;
    grid->cell = cell;
    uint64_t at[3];
    for (int d = 0; d < 3; d++)
    {
        grid->origin[d] = low[d] - MARGIN * cell;
        grid->size[d] = (uint64_t)((high[d] - low[d]) / cell) + 2 * MARGIN + 2;
    }
    bool complete = true;
    for (at[2] = 0; at[2] + 1 < grid->size[2]; at[2]++)
        for (at[1] = 0; at[1] + 1 < grid->size[1]; at[1]++)
            for (at[0] = 0; at[0] + 1 < grid->size[0] && complete; at[0]++)
                complete = add_cell(grid, key_at(grid, at));
    bat_status status =
        complete ? link_nodes(grid, !work->outside.closed, error) : error_memory(error, grid->count * sizeof *grid->keys);
    size_t count;
    return status == BAT_OK && work->outside.closed ? fix_outside(work, true, &count, error) : status;
}

/// Mark the cell and those around it.
static bool mark_around(const level_grid *grid, uint64_t key, key_map *marks)
{
    uint64_t at[3];
    place_of(grid, key, at);
    for (int k = 0; k < 27; k++)
    {
        int64_t to[3] = {(int64_t)at[0] + k % 3 - 1, (int64_t)at[1] + k / 3 % 3 - 1, (int64_t)at[2] + k / 9 - 1};
        bool inside = true;
        for (int d = 0; d < 3; d++)
            inside = inside && to[d] >= 0 && to[d] + 1 < (int64_t)grid->size[d];
        const uint64_t place[3] = {(uint64_t)to[0], (uint64_t)to[1], (uint64_t)to[2]};
        uint32_t *mark = inside ? key_map_at(marks, key_at(grid, place)) : NULL;
        if (inside && mark == NULL)
            return false;
        if (inside)
            *mark = 0;
    }
    return true;
}

/// The corners of a cell; false where one is missing.
static bool corners_of(const level_grid *grid, uint64_t key, uint32_t corners[8])
{
    bool complete = true;
    for (int c = 0; c < 8; c++)
    {
        corners[c] = key_map_find(&grid->nodes, key + corner_step(grid, c));
        complete = complete && corners[c] != NONE;
    }
    return complete;
}

static bool is_cut(const level_grid *grid, const uint32_t corners[8])
{
    bool below = false, above = false;
    for (int c = 0; c < 8; c++)
    {
        below = below || grid->values[corners[c]] < 0;
        above = above || grid->values[corners[c]] >= 0;
    }
    return below && above;
}

/// Set the values of a finer grid from the cells that it divides.
static void prolong(const level_grid *coarse, level_grid *fine)
{
    for (size_t n = 0; n < fine->count; n++)
    {
        uint64_t at[3], low[3];
        double sum = 0, total = 0;
        place_of(fine, fine->keys[n], at);
        for (int c = 0; c < 8; c++)
        {
            double weight = 1;
            for (int d = 0; d < 3; d++)
            {
                low[d] = at[d] / 2 + (at[d] % 2 == 1 && (c >> d & 1));
                weight *= at[d] % 2 == 1 ? 0.5 : (c >> d & 1 ? 0 : 1);
            }
            uint32_t node = weight > 0 ? key_map_find(&coarse->nodes, key_at(coarse, low)) : NONE;
            if (node != NONE)
            {
                sum += weight * 2 * coarse->values[node];
                total += weight;
            }
        }
        fine->values[n] = total > 0 ? sum / total : 0;
    }
}

/// Replace the grid by one of half the cells' size.
static bat_status halve(connection *work, bat_error *error)
{
    level_grid *coarse = &work->grid, fine = {.cell = coarse->cell / 2};
    key_map marks = {0};
    bool complete = true;
    double ignored[3];
    for (int d = 0; d < 3; d++)
    {
        fine.origin[d] = coarse->origin[d];
        fine.size[d] = 2 * coarse->size[d] - 1;
    }
    bool full = fmax(fmax((double)fine.size[0], (double)fine.size[1]), (double)fine.size[2]) <= FULL_CELLS + 4 * MARGIN;
    for (size_t i = 0; i < work->count && complete && !full; i++)
        complete = mark_around(coarse, cell_of(coarse, work->points + 3 * i, ignored), &marks);
    for (size_t k = 0; k < coarse->cell_count && complete && !full; k++)
    {
        uint32_t corners[8];
        if (corners_of(coarse, coarse->cells[k], corners) && is_cut(coarse, corners))
            complete = mark_around(coarse, coarse->cells[k], &marks);
    }
    for (size_t k = 0; k < coarse->cell_count && complete; k++)
    {
        uint64_t at[3];
        if (!full && key_map_find(&marks, coarse->cells[k]) == NONE)
            continue;
        place_of(coarse, coarse->cells[k], at);
        for (int c = 0; c < 8 && complete; c++)
        {
            const uint64_t to[3] = {2 * at[0] + (c & 1), 2 * at[1] + (c >> 1 & 1), 2 * at[2] + (c >> 2 & 1)};
            complete = add_cell(&fine, key_at(&fine, to));
        }
    }
    key_map_free(&marks);
    bat_status status = complete ? link_nodes(&fine, full && !work->outside.closed, error)
                                 : error_memory(error, fine.count * sizeof *fine.keys);
    if (status == BAT_OK)
    {
        prolong(coarse, &fine);
        grid_free(coarse);
        work->grid = fine;
    }
    else
        grid_free(&fine);
    return status;
}

// The zero level

typedef struct contour
{
    const level_grid *grid;
    key_map cuts; ///< vertices on edges between nodes
    bat_mesh mesh;
    size_t position_capacity, face_capacity, index_count;
} contour;

/// The vertex on the edge between two nodes; NONE when out of memory.
static uint32_t cut_edge(contour *work, uint32_t a, uint32_t b)
{
    uint32_t *vertex = key_map_at(&work->cuts, key_of_pair(a, b));
    if (vertex == NULL || *vertex != NONE)
        return vertex == NULL ? NONE : *vertex;
    bat_mesh *mesh = &work->mesh;
    if (!ARRAY_GROW(mesh->positions, work->position_capacity, 3 * (mesh->vertex_count + 1)))
        return NONE;
    const level_grid *grid = work->grid;
    double share = grid->values[a] / (grid->values[a] - grid->values[b]);
    uint64_t p[3], q[3];
    place_of(grid, grid->keys[a], p);
    place_of(grid, grid->keys[b], q);
    share = fmin(fmax(share, MIN_CUT), 1 - MIN_CUT);
    for (int d = 0; d < 3; d++)
        mesh->positions[3 * mesh->vertex_count + (size_t)d] =
            grid->origin[d] + grid->cell * ((double)p[d] + share * ((double)q[d] - (double)p[d]));
    return *vertex = (uint32_t)mesh->vertex_count++;
}

static bool add_triangle(contour *work, const uint32_t corners[3])
{
    if (!ARRAY_GROW(work->mesh.faces, work->face_capacity, work->index_count + 3))
        return false;
    for (int k = 0; k < 3; k++)
    {
        if (corners[k] == NONE)
            return false;
        work->mesh.faces[work->index_count++] = corners[k];
    }
    work->mesh.face_count++;
    return true;
}

/// Cut a tetrahedron of positive volume. Normals lead to positive values.
static bool cut_tetrahedron(contour *work, const uint32_t nodes[4])
{
    // The even permutation that brings the corners on the side of fewer first, for each set of corners below 0.
    static const uint8_t ORDER[16][4] = {{0, 1, 2, 3}, {0, 1, 2, 3}, {1, 2, 0, 3}, {0, 1, 2, 3}, {2, 0, 1, 3}, {0, 2, 3, 1},
                                         {1, 2, 0, 3}, {3, 0, 2, 1}, {3, 0, 2, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}, {2, 0, 1, 3},
                                         {2, 3, 0, 1}, {1, 2, 0, 3}, {0, 1, 2, 3}, {0, 1, 2, 3}};
    unsigned below = 0, count = 0;
    for (unsigned k = 0; k < 4; k++)
        if (work->grid->values[nodes[k]] < 0)
        {
            below |= 1U << k;
            count++;
        }
    const uint8_t *order = ORDER[below];
    const uint32_t n[4] = {nodes[order[0]], nodes[order[1]], nodes[order[2]], nodes[order[3]]};
    if (count == 0 || count == 4)
        return true;
    if (count != 2)
    {
        uint32_t cuts[3] = {cut_edge(work, n[0], n[1]), cut_edge(work, n[0], n[2]), cut_edge(work, n[0], n[3])};
        if (count == 3)
            SWAP(cuts[1], cuts[2]);
        return add_triangle(work, cuts);
    }
    const uint32_t cuts[4] = {cut_edge(work, n[0], n[2]), cut_edge(work, n[0], n[3]), cut_edge(work, n[1], n[3]),
                              cut_edge(work, n[1], n[2])};
    const uint32_t other[3] = {cuts[0], cuts[2], cuts[3]};
    return add_triangle(work, cuts) && add_triangle(work, other);
}

static bat_status cut_out(const level_grid *grid, bat_mesh *mesh, bat_error *error)
{
    // Kuhn's six tetrahedra along the diagonal of a cell, all of positive volume.
    static const uint8_t TETRAHEDRA[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                             {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
    contour work = {.grid = grid};
    bool complete = true;
    for (size_t k = 0; k < grid->cell_count && complete; k++)
    {
        uint32_t corners[8];
        if (!corners_of(grid, grid->cells[k], corners) || !is_cut(grid, corners))
            continue;
        for (int t = 0; t < 6 && complete; t++)
        {
            const uint32_t nodes[4] = {corners[TETRAHEDRA[t][0]], corners[TETRAHEDRA[t][1]], corners[TETRAHEDRA[t][2]],
                                       corners[TETRAHEDRA[t][3]]};
            complete = cut_tetrahedron(&work, nodes);
        }
    }
    key_map_free(&work.cuts);
    if (complete && work.mesh.face_count > 0)
    {
        *mesh = work.mesh;
        return BAT_OK;
    }
    bat_mesh_free(&work.mesh);
    return complete ? error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the points have no inside and outside")
                    : error_memory(error, work.index_count * sizeof(uint32_t));
}

// The points

/// The spacing of all points, and the area of each.
static bat_status measure_points(connection *work, double *spacing, bat_error *error)
{
    neighbour_list near = {0};
    double *sorted = memory_array(work->count, sizeof *sorted);
    bat_status status = sorted == NULL ? error_memory(error, work->count * sizeof *sorted) : BAT_OK;
    for (size_t i = 0; i < work->count && status == BAT_OK; i++)
    {
        status = neighbours_nearest(work->tree, work->points + 3 * i, SHELL_SPACING_POINTS, &near, error);
        if (status != BAT_OK)
            break;
        sorted[i] = shell_spacing(&near);
        work->areas[i] = sorted[i] * sorted[i];
    }
    neighbour_list_free(&near);
    if (status == BAT_OK)
        *spacing = sort_median(sorted, work->count);
    free(sorted);
    return status;
}

static bat_status solve_levels(connection *work, double extent, double finest, bat_progress progress, bat_error *error)
{
    double cell = finest;
    size_t levels = 0;
    double *areas = work->areas;
    for (; cell * 2 * FIRST_CELLS < extent; levels++)
        cell *= 2;
    bat_status status = first_grid(work, cell, error);
    work->areas = memory_pool_array(&work->pool, work->count, sizeof *areas);
    work->places = memory_pool_array(&work->pool, work->count, sizeof *work->places);
    if (status == BAT_OK)
        status = memory_pool_check(&work->pool, error);
    for (size_t level = 0; status == BAT_OK; level++)
    {
        if (!progress_goes_on(progress, (double)level / (double)(levels + 1)))
            return error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "the connection was stopped");
        double unit = work->grid.cell * work->grid.cell;
        for (size_t i = 0; i < work->count; i++)
            work->areas[i] = fmin(fmax(areas[i] / unit, MIN_AREA), MAX_AREA);
        work->smoothness = SMOOTHNESS[0] + (SMOOTHNESS[1] - SMOOTHNESS[0]) * work->noise / work->grid.cell;
        find_places(work);
        status = minimize_inside(work, error);
        if (level == levels)
            break;
        if (status == BAT_OK)
            status = halve(work, error);
    }
    return status;
}

bat_status shell_connect(shell_cloud *cloud, bat_progress progress, bat_mesh *mesh, double *normals, bat_error *error)
{
    connection work = {.points = cloud->points, .count = cloud->count, .tree = cloud->tree};
    oriented_planes planes = {0};
    const bat_cloud all = {.points = (double *)cloud->points, .count = cloud->count};
    work.areas = memory_pool_array(&work.pool, cloud->count, sizeof *work.areas);
    bat_status status = memory_pool_check(&work.pool, error);
    if (status == BAT_OK)
        status = measure_points(&work, &cloud->spacing, error);
    if (status == BAT_OK)
        status = oriented_planes_make(&all, cloud->tree, &planes, error);
    if (status == BAT_OK)
    {
        double extent = 0;
        for (int d = 0; d < 3; d++)
            extent = fmax(extent, nearest_bounds(cloud->tree)[3 + d] - nearest_bounds(cloud->tree)[d]);
        status = noise_estimate(cloud->points, cloud->tree, &cloud->noise, error);
        work.planes = &planes;
        cloud->cell = fmax(cloud->share * fmax(cloud->spacing, cloud->noise), extent / MAX_CELLS);
        work.noise = cloud->noise;
        cloud->areas = work.areas;
        if (status == BAT_OK)
            status = shell_orient(cloud, &planes, &work.pool, &work.outside, error);
        cloud->areas = NULL;
        for (size_t i = 0; i < cloud->count && status == BAT_OK && normals != NULL; i++)
            memcpy(normals + 3 * i, planes.planes[i].axes[2], 3 * sizeof *normals);
        if (status == BAT_OK)
            status = solve_levels(&work, extent, cloud->cell, progress, error);
    }
    if (status == BAT_OK)
        status = cut_out(&work.grid, mesh, error);
    grid_free(&work.grid);
    oriented_planes_free(&planes);
    memory_pool_free(&work.pool);
    return status;
}
