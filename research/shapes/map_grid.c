#include "research/shapes/map_grid.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

enum
{
    CORNERS = 12, ///< of an icosahedron
    FACES = 20,
    KEY_BITS = 16 ///< of a corner and its weight
};

/// A vertex of a subdivided face: its corners with their weights packed into a number, the same for all faces that share it.
typedef struct grid_key
{
    uint64_t key;
    size_t slot; ///< of the vertex among those of all faces
} grid_key;

double map_longitude_step(double degrees)
{
    while (degrees > 180)
        degrees -= 360;
    while (degrees < -180)
        degrees += 360;
    return degrees;
}

static double determinant(const double *a, const double *b, const double *c)
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static void normalize(double point[3])
{
    double length = sqrt(point[0] * point[0] + point[1] * point[1] + point[2] * point[2]);
    for (int k = 0; k < 3; k++)
        point[k] /= length;
}

/// An icosahedron with edges of length 2, and its faces counter-clockwise.
static void make_icosahedron(double corners[CORNERS][3], size_t faces[FACES][3])
{
    const double golden = (1 + sqrt(5.0)) / 2;
    for (size_t i = 0; i < CORNERS; i++)
    {
        size_t axis = i / 4;
        corners[i][axis] = 0;
        corners[i][(axis + 1) % 3] = (i & 1) != 0 ? 1 : -1;
        corners[i][(axis + 2) % 3] = (i & 2) != 0 ? golden : -golden;
    }
    bool joined[CORNERS][CORNERS];
    for (size_t i = 0; i < CORNERS; i++)
        for (size_t j = 0; j < CORNERS; j++)
        {
            double square = 0;
            for (int k = 0; k < 3; k++)
                square += (corners[i][k] - corners[j][k]) * (corners[i][k] - corners[j][k]);
            joined[i][j] = square > 3.5 && square < 4.5;
        }
    size_t count = 0;
    for (size_t a = 0; a < CORNERS; a++)
        for (size_t b = a + 1; b < CORNERS; b++)
            for (size_t c = b + 1; c < CORNERS; c++)
            {
                if (!joined[a][b] || !joined[b][c] || !joined[a][c] || count == FACES)
                    continue;
                bool turned = determinant(corners[a], corners[b], corners[c]) < 0;
                faces[count][0] = a;
                faces[count][1] = turned ? c : b;
                faces[count][2] = turned ? b : c;
                count++;
            }
}

/// The key of the vertex with the given weights of a face's corners.
static uint64_t key_of(const size_t face[3], const size_t weights[3])
{
    uint64_t parts[3], key = 0;
    size_t count = 0;
    for (size_t k = 0; k < 3; k++)
        if (weights[k] > 0)
            parts[count++] = (uint64_t)face[k] << 12 | weights[k];
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count; j++)
            if (parts[j] < parts[i])
            {
                uint64_t kept = parts[i];
                parts[i] = parts[j];
                parts[j] = kept;
            }
    for (size_t i = 0; i < count; i++)
        key = key << KEY_BITS | parts[i];
    return key;
}

static void point_of_key(double corners[CORNERS][3], uint64_t key, double point[3])
{
    memset(point, 0, 3 * sizeof *point);
    for (; key != 0; key >>= KEY_BITS)
    {
        size_t corner = (key >> 12) & 15;
        double weight = (double)(key & 0xfff);
        for (int k = 0; k < 3; k++)
            point[k] += weight * corners[corner][k];
    }
    normalize(point);
}

static int compare_keys(const void *a, const void *b)
{
    const grid_key *p = a, *q = b;
    return (p->key > q->key) - (p->key < q->key);
}

/// The place of row i, column j among the vertices of a face.
static size_t place_of(size_t row, size_t column)
{
    return row * (row + 1) / 2 + column;
}

/// The cells of the vertices of all faces: `vertex` receives FACES x per_face indices.
static bool make_vertices(size_t frequency, size_t per_face, size_t faces[FACES][3], double corners[CORNERS][3],
                          uint32_t *vertex, map_grid *grid)
{
    grid_key *keys = memory_array(FACES * per_face, sizeof *keys);
    if (keys == NULL)
        return false;
    for (size_t f = 0; f < FACES; f++)
        for (size_t row = 0; row <= frequency; row++)
            for (size_t column = 0; column <= row; column++)
            {
                size_t slot = f * per_face + place_of(row, column);
                const size_t weights[3] = {frequency - row, row - column, column};
                keys[slot] = (grid_key){key_of(faces[f], weights), slot};
            }
    qsort(keys, FACES * per_face, sizeof *keys, compare_keys);
    size_t count = 0;
    for (size_t i = 0; i < FACES * per_face; i++)
    {
        if (i == 0 || keys[i].key != keys[i - 1].key)
            point_of_key(corners, keys[i].key, grid->cells[count++].point);
        vertex[keys[i].slot] = (uint32_t)(count - 1);
    }
    free(keys);
    return count == grid->cell_count;
}

static void make_triangles(size_t frequency, size_t per_face, const uint32_t *vertex, map_grid *grid)
{
    size_t count = 0;
    for (size_t f = 0; f < FACES; f++)
        for (size_t row = 0; row < frequency; row++)
            for (size_t column = 0; column <= row; column++)
            {
                const uint32_t *at = vertex + f * per_face;
                uint32_t top = at[place_of(row, column)], left = at[place_of(row + 1, column)];
                uint32_t right = at[place_of(row + 1, column + 1)];
                uint32_t *triangle = grid->triangles[count++];
                triangle[0] = top;
                triangle[1] = left;
                triangle[2] = right;
                if (column == row)
                    continue;
                triangle = grid->triangles[count++];
                triangle[0] = top;
                triangle[1] = right;
                triangle[2] = at[place_of(row, column + 1)];
            }
}

/// Find the neighbours of each cell in their order. Every triangle tells two consecutive neighbours of each of its corners.
static void join_cells(map_grid *grid)
{
    for (size_t t = 0; t < grid->triangle_count; t++)
        for (size_t c = 0; c < 3; c++)
        {
            map_cell *cell = &grid->cells[grid->triangles[t][c]];
            cell->neighbours[cell->degree] = grid->triangles[t][(c + 1) % 3];
            cell->triangles[cell->degree++] = (uint32_t)t;
        }
    for (size_t i = 0; i < grid->cell_count; i++)
    {
        map_cell *cell = &grid->cells[i];
        for (size_t k = 0; k + 1 < cell->degree; k++)
        {
            const uint32_t *triangle = grid->triangles[cell->triangles[k]];
            size_t corner = triangle[0] == i ? 0 : triangle[1] == i ? 1 : 2;
            uint32_t next = triangle[(corner + 2) % 3];
            for (size_t j = k + 1; j < cell->degree; j++)
                if (cell->neighbours[j] == next)
                {
                    uint32_t other = cell->triangles[j];
                    cell->neighbours[j] = cell->neighbours[k + 1];
                    cell->triangles[j] = cell->triangles[k + 1];
                    cell->neighbours[k + 1] = next;
                    cell->triangles[k + 1] = other;
                }
        }
    }
}

/// Move each site within a ball of `radius`, small enough that no triangle turns over.
static void scatter_cells(map_grid *grid, double radius, bat_random *random)
{
    for (size_t i = 0; i < grid->cell_count; i++)
    {
        map_cell *cell = &grid->cells[i];
        double move[3], square;
        do
        {
            square = 0;
            for (int k = 0; k < 3; k++)
            {
                move[k] = 2 * bat_random_uniform(random) - 1;
                square += move[k] * move[k];
            }
        } while (square > 1);
        for (int k = 0; k < 3; k++)
            cell->point[k] += radius * move[k];
        normalize(cell->point);
        cell->longitude = atan2(cell->point[1], cell->point[0]) * 180 / PI;
        cell->latitude = atan2(cell->point[2], hypot(cell->point[0], cell->point[1])) * 180 / PI;
    }
}

bool map_grid_make(size_t frequency, bat_random *random, map_grid *grid)
{
    static const double SCATTER = 0.24; // of the mean distance of neighbours
    double corners[CORNERS][3];
    size_t faces[FACES][3], per_face = (frequency + 1) * (frequency + 2) / 2;
    make_icosahedron(corners, faces);
    *grid = (map_grid){.cell_count = 10 * frequency * frequency + 2, .triangle_count = FACES * frequency * frequency};
    grid->cells = calloc(grid->cell_count, sizeof *grid->cells);
    grid->triangles = memory_array(grid->triangle_count, sizeof *grid->triangles);
    uint32_t *vertex = memory_array(FACES * per_face, sizeof *vertex);
    bool made = grid->cells != NULL && grid->triangles != NULL && vertex != NULL &&
                make_vertices(frequency, per_face, faces, corners, vertex, grid);
    if (made)
    {
        make_triangles(frequency, per_face, vertex, grid);
        join_cells(grid);
        double spacing = sqrt(8 * PI / (sqrt(3.0) * (double)grid->cell_count));
        scatter_cells(grid, SCATTER * spacing, random);
    }
    else
        map_grid_free(grid);
    free(vertex);
    return made;
}

void map_grid_turn(map_grid *grid, double degrees)
{
    double c = cos(degrees * PI / 180), s = sin(degrees * PI / 180);
    for (size_t i = 0; i < grid->cell_count; i++)
    {
        map_cell *cell = &grid->cells[i];
        double x = cell->point[0], y = cell->point[1];
        cell->point[0] = c * x - s * y;
        cell->point[1] = s * x + c * y;
        cell->longitude = map_longitude_step(cell->longitude + degrees);
    }
}

void map_grid_free(map_grid *grid)
{
    free(grid->cells);
    free(grid->triangles);
    *grid = (map_grid){0};
}
