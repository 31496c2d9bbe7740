/// @file
/// Shapes as triangulated grids: tubes along torus knots, reliefs, shells.

#include "research/shapes/mesh_shape.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector.h"

#include <math.h>
#include <string.h>

/// A grid of `rows` x `columns` points, optionally periodic in each direction.
typedef struct sheet
{
    uint32_t rows, columns;
    bool rows_close, columns_close;
} sheet;

static uint32_t corner(const sheet *grid, uint32_t row, uint32_t column)
{
    return row % grid->rows * grid->columns + column % grid->columns;
}

static bat_status sheet_begin(const sheet *grid, bat_mesh *mesh, bat_error *error)
{
    size_t vertices = (size_t)grid->rows * grid->columns;
    size_t cells = (size_t)(grid->rows - !grid->rows_close) * (grid->columns - !grid->columns_close);
    *mesh = (bat_mesh){.positions = memory_array(vertices, 3 * sizeof(double)),
                       .faces = memory_array(2 * cells, 3 * sizeof(uint32_t)),
                       .vertex_count = vertices,
                       .face_count = 2 * cells};
    if (mesh->positions == NULL || mesh->faces == NULL)
    {
        bat_mesh_free(mesh);
        return error_memory(error, vertices * 3 * sizeof(double));
    }
    return BAT_OK;
}

static double square_distance(const bat_mesh *mesh, uint32_t a, uint32_t b)
{
    double sum = 0;
    for (size_t c = 0; c < 3; c++)
    {
        double away = mesh->positions[3 * (size_t)a + c] - mesh->positions[3 * (size_t)b + c];
        sum += away * away;
    }
    return sum;
}

/// Fill in the faces: every cell is split along its shorter diagonal.
static void sheet_end(const sheet *grid, bat_mesh *mesh)
{
    uint32_t *face = mesh->faces;
    for (uint32_t row = 0; row + !grid->rows_close < grid->rows; row++)
        for (uint32_t column = 0; column + !grid->columns_close < grid->columns; column++)
        {
            uint32_t a = corner(grid, row, column), b = corner(grid, row, column + 1);
            uint32_t c = corner(grid, row + 1, column + 1), d = corner(grid, row + 1, column);
            bool rising = square_distance(mesh, a, c) <= square_distance(mesh, b, d);
            uint32_t both[6] = {a, b, rising ? c : d, rising ? a : b, c, d};
            memcpy(face, both, sizeof both);
            face += 6;
        }
}

static double length_of(const double *v)
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/// The torus knot that winds p times around the axis and q times around the tube of radius `ring`.
typedef struct torus_knot
{
    int p, q;
    double ring; ///< radius, of a torus whose middle has radius 1
} torus_knot;

/// A point of the knot at t in [0, 1], with a frame: outward normal of the torus, and direction across the knot.
static void knot_frame(const torus_knot *knot, double t, double at[3], double out[3], double across[3])
{
    double a = 2 * WAVE_PI * knot->p * t, b = 2 * WAVE_PI * knot->q * t, far = 1 + knot->ring * cos(b), along[3];
    at[0] = far * cos(a);
    at[1] = far * sin(a);
    at[2] = knot->ring * sin(b);
    double fall = -knot->ring * knot->q * sin(b);
    along[0] = fall * cos(a) - far * knot->p * sin(a);
    along[1] = fall * sin(a) + far * knot->p * cos(a);
    along[2] = knot->ring * knot->q * cos(b);
    double normal[3] = {cos(b) * cos(a), cos(b) * sin(a), sin(b)}, size = length_of(along);
    for (int c = 0; c < 3; c++)
        along[c] /= size;
    vector3_cross(along, normal, across);
    size = length_of(across);
    for (int c = 0; c < 3; c++)
        across[c] /= size;
    vector3_cross(across, along, out);
}

bat_status generate_knot(size_t vertices, bat_random *random, bat_mesh *mesh, bat_error *error)
{
    static const torus_knot KNOTS[] = {{2, 3, 0.45}, {3, 2, 0.4}, {2, 5, 0.45}, {1, 3, 0.45}, {1, 0, 0.2}, {1, 2, 0.4}};
    torus_knot knot = KNOTS[draw_whole(random, 0, 5)];
    double thick = (knot.p == 1 ? 0.22 : 0.17) * draw_between(random, 0.75, 1), flat = draw_between(random, 0.6, 1);
    harmonics along = harmonics_draw(random, draw_whole(random, 1, 6), 0.5),
              round = harmonics_draw(random, draw_whole(random, 1, 5), 1);
    harmonics_limit(&along, 0.3);
    harmonics_limit(&round, draw_between(random, 0, 0.35));
    int twists = draw_whole(random, 0, 4);
    double length = 2 * WAVE_PI * hypot(knot.p, knot.q * knot.ring), girth = 2 * WAVE_PI * thick * 0.9;
    sheet grid = {.rows_close = true, .columns_close = true};
    grid.columns = (uint32_t)fmax(6, rint(sqrt((double)vertices * girth / length)));
    grid.rows = (uint32_t)fmax(12, (double)vertices / grid.columns);
    bat_status status = sheet_begin(&grid, mesh, error);
    for (uint32_t row = 0; row < grid.rows && status == BAT_OK; row++)
        for (uint32_t column = 0; column < grid.columns; column++)
        {
            double t = (double)row / grid.rows, at[3], out[3], across[3];
            knot_frame(&knot, t, at, out, across);
            // Every second row is shifted by half a column if the number of rows is even, which gives nearly equilateral
            // triangles.
            double turn = 2 * WAVE_PI * (column + (grid.rows % 2 == 0 ? 0.5 * (row % 2) : 0)) / grid.columns;
            double place = 2 * WAVE_PI * t, section = turn + twists * place;
            double radius = thick * (1 + harmonics_at(&along, cos(place), sin(place))) *
                            (1 + harmonics_at(&round, cos(section), sin(section)));
            double *point = mesh->positions + 3 * ((size_t)row * grid.columns + column);
            for (int c = 0; c < 3; c++)
                point[c] = at[c] + radius * (flat * cos(turn) * out[c] + sin(turn) * across[c]);
        }
    if (status == BAT_OK)
        sheet_end(&grid, mesh);
    return status;
}

/// A height field with hills, a terrace and a fold.
typedef struct landscape
{
    noise_sum hills, ridges;
    double terrace, steepness, fold, fold_at, fold_reach;
} landscape;

static double landscape_height(const landscape *land, double x, double y)
{
    double point[3] = {x, y, 0.37};
    double height = noise_sum_at(&land->hills, point) + noise_sum_at(&land->ridges, point);
    height += land->terrace * tanh(land->steepness * (height - 0.02));
    // A fold along a line of vertices that decays towards its ends.
    return height - land->fold * fabs(y - land->fold_at) * exp(-x * x / (land->fold_reach * land->fold_reach)) *
                        exp(-4 * (y - land->fold_at) * (y - land->fold_at));
}

bat_status generate_relief(size_t vertices, bat_random *random, bat_mesh *mesh, bat_error *error)
{
    double wide = draw_between(random, 0.6, 1.2);
    sheet grid = {.columns = (uint32_t)fmax(3, sqrt((double)vertices * 0.866 / wide))};
    grid.rows = (uint32_t)fmax(3, (double)vertices / grid.columns);
    double step = 2.0 / (grid.columns - 1);
    landscape land = {.hills = {bat_random_bits(random), draw_between(random, 0.8, 2), draw_between(random, 0.1, 0.35),
                                draw_between(random, 0.3, 0.5), draw_whole(random, 1, 4), 0},
                      .ridges = {bat_random_bits(random), draw_between(random, 0.8, 2), draw_between(random, 0, 0.12), 0.45,
                                 draw_whole(random, 1, 3), draw_between(random, 0.02, 0.1)},
                      .terrace = draw_coin(random) ? draw_between(random, 0.05, 0.15) : 0,
                      .steepness = draw_between(random, 4, 15),
                      .fold = draw_coin(random) ? draw_between(random, 0.3, 1) : 0,
                      .fold_reach = draw_between(random, 0.3, 1)};
    double down = step * sqrt(3) / 2, low = -0.5 * down * (grid.rows - 1);
    land.fold_at = low + down * floor(grid.rows * draw_between(random, 0.3, 0.7));
    bat_status status = sheet_begin(&grid, mesh, error);
    for (uint32_t row = 0; row < grid.rows && status == BAT_OK; row++)
        for (uint32_t column = 0; column < grid.columns; column++)
        {
            double *point = mesh->positions + 3 * ((size_t)row * grid.columns + column);
            // Every second row is shifted by half a step, except at its ends.
            bool end = column == 0 || column == grid.columns - 1;
            point[0] = -1 + step * (column + (end ? 0.25 : 0.5 * (row % 2)));
            point[1] = low + down * row;
            point[2] = landscape_height(&land, point[0], point[1]);
        }
    if (status == BAT_OK)
        sheet_end(&grid, mesh);
    return status;
}

/// A scallop shell: a fan of ribs, sharp at the rim and vanishing towards the hinge.
bat_status generate_shell(size_t vertices, bat_random *random, bat_mesh *mesh, bat_error *error)
{
    int ribs = draw_whole(random, 6, 14);
    double deep = draw_between(random, 0.25, 0.6), rib = draw_between(random, 0.25, 0.6),
           opening = draw_between(random, 1.6, 2.6);
    double sharpness = draw_between(random, 0.5, 1), growth = draw_between(random, 1, 2), inner = 0.25;
    noise_sum rough = {bat_random_bits(random), 3, draw_between(random, 0, 0.02), 0.5, 2, 0};
    // Cells are square in the middle of the fan.
    uint32_t per_rib = (uint32_t)fmax(4, 2 * rint(sqrt((double)vertices * opening * 0.65 / 0.75) / (2 * ribs)));
    sheet grid = {.columns = (uint32_t)ribs * per_rib + 1};
    grid.rows = (uint32_t)fmax(3, (double)vertices / grid.columns);
    bat_status status = sheet_begin(&grid, mesh, error);
    for (uint32_t row = 0; row < grid.rows && status == BAT_OK; row++)
        for (uint32_t column = 0; column < grid.columns; column++)
        {
            double out = (double)row / (grid.rows - 1), radius = inner * pow(1 / inner, out);
            double angle = opening * ((double)column / (grid.columns - 1) - 0.5);
            double within = 2.0 * (column % per_rib) / per_rib - 1, tent = 1 - fabs(within),
                   hump = cos(0.5 * WAVE_PI * within);
            double share = sharpness * pow(out, growth),
                   height = rib / ribs * radius * (share * tent + (1 - share) * hump * hump);
            double *point = mesh->positions + 3 * ((size_t)row * grid.columns + column);
            point[0] = radius * cos(angle);
            point[1] = -radius * sin(angle);
            point[2] = height * 2 + deep * (1 - pow(radius, 2)) * cos(0.9 * angle);
            point[2] += noise_sum_at(&rough, point);
        }
    if (status == BAT_OK)
        sheet_end(&grid, mesh);
    return status;
}
