/// @file
/// Patches whose normals agree; see shell.h.
///
/// With the derivatives D and D' of two patches across a side, each divided by its part at right angles to the side, and
/// the mean normal n, normals agree where n . (D + D') = 0. Place after place, Bézier points move along normals by the least
/// squares of moves, in widths of their patches, that solve this equation (Kaczmarz, 1937). Points at a crease, a boundary,
/// or a patch without a jump around stay.

#include "surface/shell/shell.h"

#include "linalg/vector.h"

#include <string.h>

#define PLACES 7 ///< of a side
#define TERMS 16 ///< points that the normals at a place depend on
#define ROUNDS 64

/// Angles between normals: that count as a jump; that are folds, around which patches stay.
static const double MIN_JUMP = 1e-4, MAX_JUMP = 0.5;
/// Share of a move that is made; the largest move of a point in all, in widths.
static const double SHARE = 0.15, MAX_MOVE = 0.1;
/// Least part of a derivative at right angles to the side.
static const double MIN_ACROSS = 0.05;

typedef struct agree_work
{
    const shell_grid *grid;
    bool *near;      ///< quad_count: a patch beside a jump, or one that touches such a patch
    size_t *rows;    ///< quad_count x 16
    double *points;  ///< row_count x 3
    double *widths;  ///< row_count: of the narrowest patch around; 0 where the point stays
    double *normals; ///< row_count x 3: unit vectors
    double *moves;   ///< row_count: so far, in widths
    memory_pool pool;
} agree_work;

/// The row of point i, 0 to 3, along a half-edge, in its patch; depth 0 is on the side.
static size_t row_at(const agree_work *work, uint32_t half_edge, size_t i, size_t depth)
{
    static const int PLACE[4] = {0, 3, 15, 12}, ALONG[4] = {1, 4, -1, -4};
    uint32_t c = half_edge % 4;
    return work
        ->rows[16 * (size_t)(half_edge / 4) + (size_t)(PLACE[c] + (int)i * ALONG[c] - (int)depth * ALONG[(c + 3) % 4])];
}

static bool is_smooth(const shell_grid *grid, uint32_t half_edge)
{
    return grid->links.twin[half_edge] != BAT_MESH_NONE && !grid->sharp[half_edge];
}

/// @param marks vertex_count zeros
static void find_near(const agree_work *work, const double *bezier, uint8_t *marks)
{
    const shell_grid *grid = work->grid;
    for (uint32_t h = 0; h < 4 * grid->quad_count; h++)
    {
        double most = 0;
        for (int k = 0; k < PLACES && is_smooth(grid, h); k++)
            most = fmax(most, shell_jump(grid, bezier, h, (k + 0.5) / PLACES));
        for (uint32_t c = 0; c < 4 && most > MIN_JUMP; c++)
            marks[grid->quads[h / 4 * 4 + c]] |= most > MAX_JUMP ? 2 : 1;
    }
    for (size_t q = 0; q < grid->quad_count; q++)
    {
        const uint32_t *quad = grid->quads + 4 * q;
        work->near[q] = (marks[quad[0]] | marks[quad[1]] | marks[quad[2]] | marks[quad[3]]) == 1;
    }
}

/// Find the normals and widths of all points that may move.
static void find_directions(const agree_work *work, const double *bezier)
{
    const shell_grid *grid = work->grid;
    for (size_t r = 0; r < grid->rows.row_count; r++)
        work->widths[r] = INFINITY;
    for (size_t k = 0; k < 16 * grid->quad_count; k++)
    {
        size_t r = work->rows[k];
        double along[2][3], normal[3];
        memcpy(work->points + 3 * r, bezier + 3 * k, 3 * sizeof *bezier);
        shell_patch_evaluate(bezier + 48 * (k / 16), (double)(k % 4) / 3, (double)(k / 4 % 4) / 3, normal, along);
        vector3_cross(along[0], along[1], normal);
        for (size_t c = 0; c < 3; c++)
            work->normals[3 * r + c] += normal[c];
        double width = work->near[k / 16] ? fmin(vector3_length(along[0]), vector3_length(along[1])) : 0;
        work->widths[r] = fmin(work->widths[r], width);
    }
    for (uint32_t h = 0; h < 4 * grid->quad_count; h++)
        for (size_t k = 0; k < 8; k++)
            if (is_smooth(grid, h) ? !work->near[grid->links.twin[h] / 4] : k < 4)
                work->widths[row_at(work, h, k % 4, k / 4)] = 0;
    for (size_t r = 0; r < grid->rows.row_count; r++)
        (void)vector3_normalize(work->normals + 3 * r);
}

/// Move points so that normals agree at a place of a side. Normals that are opposite have no mean, and stay.
static void agree_at(const agree_work *work, uint32_t half_edge, double t)
{
    uint32_t sides[2] = {half_edge, work->grid->links.twin[half_edge]};
    double value[2][4], normals[2][3], mean[3], across[2], inward[2][3] = {{0}};
    size_t rows[TERMS];
    for (size_t s = 0; s < 2; s++)
    {
        double slope[4], along[3] = {0};
        shell_bernstein(s == 0 ? t : 1 - t, value[s], slope);
        for (size_t i = 0; i < 4; i++)
        {
            const size_t *row = rows + 8 * s + i;
            rows[8 * s + i] = row_at(work, sides[s], i, 0);
            rows[8 * s + 4 + i] = row_at(work, sides[s], i, 1);
            for (size_t c = 0; c < 3; c++)
            {
                double edge = work->points[3 * row[0] + c];
                along[c] += slope[i] * edge;
                inward[s][c] += 3 * value[s][i] * (work->points[3 * row[4] + c] - edge);
            }
        }
        vector3_cross(along, inward[s], normals[s]);
        across[s] =
            fmax(vector3_length(normals[s]) / fmax(vector3_length(along), 1e-300), MIN_ACROSS * vector3_length(inward[s]));
        if (!vector3_normalize(normals[s]))
            return;
    }
    if (vector3_dot(normals[0], normals[1]) < 0)
        return;
    for (size_t c = 0; c < 3; c++)
        mean[c] = normals[0][c] + normals[1][c];
    (void)vector3_normalize(mean);
    double miss = vector3_dot(mean, inward[0]) / across[0] + vector3_dot(mean, inward[1]) / across[1], weights[TERMS],
           square = 0;
    for (size_t k = 0; k < TERMS; k++)
    {
        double weight = (k / 4 % 2 == 0 ? -3 : 3) * value[k / 8][k % 4] / across[k / 8];
        weights[k] = weight * vector3_dot(mean, work->normals + 3 * rows[k]) * work->widths[rows[k]];
        square += weights[k] * weights[k];
    }
    for (size_t k = 0; k < TERMS && square > 0; k++)
    {
        double *total = &work->moves[rows[k]], before = *total;
        *total = fmin(fmax(before - SHARE * miss * weights[k] / square, -MAX_MOVE), MAX_MOVE);
        for (size_t c = 0; c < 3; c++)
            work->points[3 * rows[k] + c] += (*total - before) * work->widths[rows[k]] * work->normals[3 * rows[k] + c];
    }
}

/// Whether points beside a half-edge may move. Of a side, one half-edge is taken.
static bool is_movable(const agree_work *work, uint32_t half_edge)
{
    uint32_t twin = work->grid->links.twin[half_edge];
    return is_smooth(work->grid, half_edge) && twin > half_edge && work->near[half_edge / 4] && work->near[twin / 4];
}

bat_status shell_agree(const shell_grid *grid, double *bezier, bat_error *error)
{
    size_t count = grid->rows.row_count;
    agree_work work = {.grid = grid};
    work.near = memory_pool_zeros(&work.pool, grid->quad_count, sizeof *work.near);
    work.rows = memory_pool_array(&work.pool, grid->quad_count, 16 * sizeof *work.rows);
    work.points = memory_pool_array(&work.pool, count, 3 * sizeof *work.points);
    work.widths = memory_pool_array(&work.pool, count, sizeof *work.widths);
    work.normals = memory_pool_zeros(&work.pool, count, 3 * sizeof *work.normals);
    work.moves = memory_pool_zeros(&work.pool, count, sizeof *work.moves);
    uint8_t *marks = memory_pool_zeros(&work.pool, grid->vertex_count, sizeof *marks);
    bat_status status = memory_pool_check(&work.pool, error);
    if (status == BAT_OK)
    {
        for (uint32_t q = 0; q < grid->quad_count; q++)
            shell_grid_patch(grid, q, work.rows + 16 * (size_t)q);
        find_near(&work, bezier, marks);
        find_directions(&work, bezier);
        for (int round = 0; round < ROUNDS; round++)
            for (uint32_t h = 0; h < 4 * grid->quad_count; h++)
                for (int k = 0; k < PLACES && is_movable(&work, h); k++)
                    agree_at(&work, h, (double)k / (PLACES - 1));
        for (size_t k = 0; k < 16 * grid->quad_count; k++)
            memcpy(bezier + 3 * k, work.points + 3 * work.rows[k], 3 * sizeof *bezier);
    }
    memory_pool_free(&work.pool);
    return status;
}
