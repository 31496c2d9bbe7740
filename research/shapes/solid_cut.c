/// @file
/// Boundary of a solid from a lattice of tetrahedra that is cut along every surface in turn; see solid_cut() in solid.h. An
/// octree search restricts the lattice to cells near the boundary.

#include "base/error.h"
#include "base/memory.h"
#include "mesh/hash_table.h"
#include "research/shapes/solid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Bits of each cell coordinate.
#define CELL_BITS 12
#define MAX_CELLS_ACROSS ((uint32_t)1 << CELL_BITS)

/// Minimum distance of a cut from the ends of an edge, as a fraction of the edge; avoids slivers.
#define MIN_SHARE 0.12

/// Tetrahedra, with the values of all surfaces at their points.
typedef struct tetrahedra
{
    const solid *shape;
    double origin[3], cell, steepest;
    double *points; ///< point_count x 3
    double *values; ///< point_count x surface_count; exactly 0 at points of a cut
    size_t point_count, point_capacity, value_capacity;
    uint32_t (*corners)[4]; ///< corners, in positive orientation
    size_t count, capacity;
    key_map at; ///< index of lattice points, then of cuts
} tetrahedra;

static void tetrahedra_free(tetrahedra *t)
{
    free(t->points);
    free(t->values);
    free(t->corners);
    key_map_free(&t->at);
}

/// Ensure capacity for one more element. Returns the array, possibly moved; null when out of memory, with the array
/// unchanged.
static void *reserve(void *array, size_t count, size_t *capacity, size_t size)
{
    if (count < *capacity)
        return array;
    size_t larger = *capacity == 0 ? 4096 : 2 * *capacity;
    void *grown = larger > SIZE_MAX / size ? NULL : realloc(array, larger * size);
    *capacity = grown != NULL ? larger : *capacity;
    return grown;
}

static bool add_point(tetrahedra *t, const double *point, uint32_t *index)
{
    double *points = reserve(t->points, t->point_count, &t->point_capacity, 3 * sizeof *points);
    if (points == NULL)
        return false;
    t->points = points;
    double *values = reserve(t->values, t->point_count, &t->value_capacity, t->shape->surface_count * sizeof *values);
    if (values == NULL)
        return false;
    t->values = values;
    memcpy(points + 3 * t->point_count, point, 3 * sizeof *points);
    *index = (uint32_t)t->point_count++;
    return true;
}

static bool add_tetrahedron(tetrahedra *t, const uint32_t corners[4])
{
    uint32_t(*all)[4] = reserve(t->corners, t->count, &t->capacity, sizeof *all);
    if (all == NULL)
        return false;
    t->corners = all;
    memcpy(all[t->count++], corners, sizeof *all);
    return true;
}

/// Cells of the lattice.
typedef struct cell_list
{
    uint32_t (*cells)[3];
    size_t count, capacity;
} cell_list;

static bool add_cell(cell_list *list, const uint32_t cell[3])
{
    uint32_t(*cells)[3] = reserve(list->cells, list->count, &list->capacity, sizeof *cells);
    if (cells == NULL)
        return false;
    list->cells = cells;
    memcpy(cells[list->count++], cell, sizeof *cells);
    return true;
}

/// Gather the cells in a cube of `size` cells that may be near the boundary. Tetrahedra that meet the boundary extend at
/// most one cell from the centres of their two cells, so that none of them is lost.
static bool gather_cells(const tetrahedra *t, const uint32_t corner[3], uint32_t size, cell_list *near)
{
    double middle[3];
    for (int c = 0; c < 3; c++)
        middle[c] = t->origin[c] + t->cell * (corner[c] + 0.5 * size);
    double radius = t->cell * (0.5 * sqrt(3) * size + 0.15);
    if (fabs(solid_value(t->shape, middle)) > t->steepest * radius)
        return true;
    if (size == 1)
        return add_cell(near, corner);
    for (uint32_t child = 0; child < 8; child++)
    {
        uint32_t half = size / 2;
        uint32_t at[3] = {corner[0] + (child & 1) * half, corner[1] + (child >> 1 & 1) * half,
                          corner[2] + (child >> 2) * half};
        if (!gather_cells(t, at, half, near))
            return false;
    }
    return true;
}

static uint64_t cell_key(const uint32_t cell[3])
{
    return ((uint64_t)cell[0] << 2 * CELL_BITS | (uint64_t)cell[1] << CELL_BITS | cell[2]) << 1;
}

/// The lattice point at the lower corner or at the centre of a cell.
static bool lattice_point(tetrahedra *t, const uint32_t cell[3], bool middle, uint32_t *index)
{
    uint32_t *known = key_map_at(&t->at, cell_key(cell) | middle);
    if (known == NULL)
        return false;
    if (*known == UINT32_MAX)
    {
        double point[3];
        for (int c = 0; c < 3; c++)
            point[c] = t->origin[c] + t->cell * (cell[c] + (middle ? 0.5 : 0));
        if (!add_point(t, point, known))
            return false;
        const solid *shape = t->shape;
        double *values = t->values + *known * shape->surface_count;
        for (size_t s = 0; s < shape->surface_count; s++)
        {
            values[s] = shape->surfaces[s].value(shape->surfaces[s].context, point);
            if (fabs(values[s]) < 1e-9 * t->cell)
                values[s] = 1e-9 * t->cell;
        }
    }
    *index = *known;
    return true;
}

/// Add the four tetrahedra around the face between two neighbouring cells: each has both centres and an edge of the face.
static bool add_face(tetrahedra *t, const uint32_t cell[3], const uint32_t next[3], int axis)
{
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    uint32_t a, b, around[4];
    if (!lattice_point(t, cell, true, &a) || !lattice_point(t, next, true, &b))
        return false;
    for (int i = 0; i < 4; i++)
    {
        uint32_t corner[3] = {next[0], next[1], next[2]};
        corner[u] += i == 1 || i == 2;
        corner[v] += i == 2 || i == 3;
        if (!lattice_point(t, corner, false, &around[i]))
            return false;
    }
    for (int i = 0; i < 4; i++)
        if (!add_tetrahedron(t, (uint32_t[4]){a, b, around[i], around[(i + 1) % 4]}))
            return false;
    return true;
}

/// Index the cells by their keys.
static bool index_cells(const cell_list *list, key_map *cell_index)
{
    for (size_t i = 0; i < list->count; i++)
    {
        uint32_t *known = key_map_at(cell_index, cell_key(list->cells[i]));
        if (known == NULL)
            return false;
        *known = (uint32_t)i;
    }
    return true;
}

/// Add the tetrahedra of all pairs of neighbouring cells.
static bool add_faces(tetrahedra *t, const cell_list *list, const key_map *cell_index)
{
    for (size_t i = 0; i < list->count; i++)
        for (int axis = 0; axis < 3; axis++)
        {
            const uint32_t *cell = list->cells[i];
            uint32_t next[3] = {cell[0], cell[1], cell[2]};
            next[axis]++;
            if (key_map_find(cell_index, cell_key(next)) != UINT32_MAX && !add_face(t, cell, next, axis))
                return false;
        }
    return true;
}

static bool fill_lattice(tetrahedra *t, uint32_t across)
{
    cell_list near = {0};
    key_map cell_index = {0};
    bool done = gather_cells(t, (uint32_t[3]){0, 0, 0}, across, &near) && index_cells(&near, &cell_index) &&
                add_faces(t, &near, &cell_index);
    free(near.cells);
    key_map_free(&cell_index);
    return done;
}

/// The point at which a surface crosses an edge.
static bool cut_edge(tetrahedra *t, size_t surface, uint32_t a, uint32_t b, uint32_t *index)
{
    if (a > b)
    {
        uint32_t swap = a;
        a = b;
        b = swap;
    }
    uint32_t *known = key_map_at(&t->at, key_of_pair(a, b));
    if (known == NULL)
        return false;
    if (*known == UINT32_MAX)
    {
        size_t surfaces = t->shape->surface_count;
        double from = t->values[a * surfaces + surface], to = t->values[b * surfaces + surface];
        double share = fmin(fmax(from / (from - to), MIN_SHARE), 1 - MIN_SHARE);
        double point[3];
        for (int c = 0; c < 3; c++)
            point[c] = (1 - share) * t->points[3 * (size_t)a + (size_t)c] + share * t->points[3 * (size_t)b + (size_t)c];
        if (!add_point(t, point, known))
            return false;
        const double *at_a = t->values + a * surfaces, *at_b = t->values + b * surfaces;
        double *values = t->values + *known * surfaces;
        for (size_t s = 0; s < surfaces; s++)
        {
            values[s] = (1 - share) * at_a[s] + share * at_b[s];
            bool both_on = at_a[s] == 0 && at_b[s] == 0;
            if (values[s] == 0 && !both_on)
                values[s] = 1e-9 * t->cell;
        }
        values[surface] = 0;
    }
    *index = *known;
    return true;
}

/// Bisect a tetrahedron at the first crossed edge, in the order of edge keys, and its parts recursively. Two tetrahedra
/// therefore divide a common triangle in the same way.
static bool cut_tetrahedron(tetrahedra *t, size_t surface, const uint32_t corners[4], size_t place)
{
    size_t surfaces = t->shape->surface_count;
    uint64_t first = KEY_MAP_NO_KEY;
    int from = 0, to = 0;
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++)
        {
            double product = t->values[corners[i] * surfaces + surface] * t->values[corners[j] * surfaces + surface];
            uint64_t key = key_of_pair(corners[i], corners[j]);
            if (product < 0 && key < first)
            {
                first = key;
                from = i;
                to = j;
            }
        }
    if (first == KEY_MAP_NO_KEY)
    {
        if (place == SIZE_MAX)
            return add_tetrahedron(t, corners);
        memcpy(t->corners[place], corners, sizeof *t->corners);
        return true;
    }
    uint32_t middle;
    if (!cut_edge(t, surface, corners[from], corners[to], &middle))
        return false;
    uint32_t half[4] = {corners[0], corners[1], corners[2], corners[3]};
    half[to] = middle;
    if (!cut_tetrahedron(t, surface, half, place))
        return false;
    half[to] = corners[to];
    half[from] = middle;
    return cut_tetrahedron(t, surface, half, SIZE_MAX);
}

static bool cut_all(tetrahedra *t)
{
    for (size_t surface = 0; surface < t->shape->surface_count; surface++)
    {
        key_map_free(&t->at);
        size_t count = t->count;
        for (size_t i = 0; i < count; i++)
        {
            uint32_t corners[4];
            memcpy(corners, t->corners[i], sizeof corners);
            if (!cut_tetrahedron(t, surface, corners, i))
                return false;
        }
    }
    return true;
}

/// Bit mask of the surfaces whose inside contains a tetrahedron.
static uint64_t sides_of(const tetrahedra *t, const uint32_t corners[4])
{
    size_t surfaces = t->shape->surface_count;
    uint64_t sides = 0;
    for (size_t s = 0; s < surfaces; s++)
    {
        double farthest = 0;
        for (int i = 0; i < 4; i++)
        {
            double value = t->values[corners[i] * surfaces + s];
            farthest = fabs(value) > fabs(farthest) ? value : farthest;
        }
        sides |= (uint64_t)(farthest < 0) << s;
    }
    return sides;
}

/// The surface that separates an inner tetrahedron from the outside at one of its triangles, or surface_count.
static size_t bounding_surface(const tetrahedra *t, uint64_t sides, const uint32_t triangle[3])
{
    size_t surfaces = t->shape->surface_count;
    for (size_t s = 0; s < surfaces; s++)
    {
        bool on = true;
        for (int i = 0; i < 3; i++)
            on = on && t->values[triangle[i] * surfaces + s] == 0;
        if (on && !solid_is_inside(t->shape, sides ^ (uint64_t)1 << s))
            return s;
    }
    return surfaces;
}

/// Triangles of the boundary, and the surface of each.
typedef struct shell
{
    uint32_t (*faces)[3];
    uint16_t *surfaces;
    size_t count, capacity, surface_capacity;
} shell;

static bool add_triangle(shell *boundary, const uint32_t triangle[3], size_t surface)
{
    uint32_t(*faces)[3] = reserve(boundary->faces, boundary->count, &boundary->capacity, sizeof *faces);
    if (faces == NULL)
        return false;
    boundary->faces = faces;
    uint16_t *surfaces = reserve(boundary->surfaces, boundary->count, &boundary->surface_capacity, sizeof *surfaces);
    if (surfaces == NULL)
        return false;
    boundary->surfaces = surfaces;
    memcpy(faces[boundary->count], triangle, sizeof *faces);
    surfaces[boundary->count++] = (uint16_t)surface;
    return true;
}

static bool find_boundary(const tetrahedra *t, shell *boundary)
{
    // the triangle opposite to each corner, counter-clockwise from outside
    static const int OPPOSITE[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    for (size_t i = 0; i < t->count; i++)
    {
        const uint32_t *corners = t->corners[i];
        uint64_t sides = sides_of(t, corners);
        if (!solid_is_inside(t->shape, sides))
            continue;
        for (int k = 0; k < 4; k++)
        {
            uint32_t triangle[3] = {corners[OPPOSITE[k][0]], corners[OPPOSITE[k][1]], corners[OPPOSITE[k][2]]};
            size_t surface = bounding_surface(t, sides, triangle);
            if (surface < t->shape->surface_count && !add_triangle(boundary, triangle, surface))
                return false;
        }
    }
    return true;
}

static uint32_t root_of(uint32_t *parent, uint32_t v)
{
    while (parent[v] != v)
    {
        parent[v] = parent[parent[v]];
        v = parent[v];
    }
    return v;
}

/// Keep the component with the most faces.
static bool extract_largest(shell *boundary, size_t point_count)
{
    uint32_t *parent = memory_array(point_count, sizeof *parent), *size = calloc(point_count, sizeof *size);
    bool done = parent != NULL && size != NULL;
    if (done)
    {
        for (size_t v = 0; v < point_count; v++)
            parent[v] = (uint32_t)v;
        for (size_t f = 0; f < boundary->count; f++)
            for (int c = 0; c < 2; c++)
                parent[root_of(parent, boundary->faces[f][c])] = root_of(parent, boundary->faces[f][c + 1]);
        uint32_t largest = root_of(parent, boundary->faces[0][0]);
        for (size_t f = 0; f < boundary->count; f++)
        {
            uint32_t root = root_of(parent, boundary->faces[f][0]);
            size[root]++;
            largest = size[root] > size[largest] ? root : largest;
        }
        size_t remaining = 0;
        for (size_t f = 0; f < boundary->count; f++)
        {
            if (root_of(parent, boundary->faces[f][0]) != largest)
                continue;
            memcpy(boundary->faces[remaining], boundary->faces[f], sizeof *boundary->faces);
            boundary->surfaces[remaining++] = boundary->surfaces[f];
        }
        boundary->count = remaining;
    }
    free(parent);
    free(size);
    return done;
}

/// Number the used points in the order of use. The mesh takes the faces.
static bool make_mesh(const tetrahedra *t, shell *boundary, bat_mesh *mesh)
{
    uint32_t *number = memory_array(t->point_count, sizeof *number);
    double *positions = memory_array(t->point_count, 3 * sizeof(double));
    if (number == NULL || positions == NULL)
    {
        free(number);
        free(positions);
        return false;
    }
    memset(number, 0xff, t->point_count * sizeof *number);
    uint32_t *faces = (uint32_t *)boundary->faces;
    size_t count = 0;
    for (size_t i = 0; i < 3 * boundary->count; i++)
    {
        uint32_t point = faces[i];
        if (number[point] == UINT32_MAX)
        {
            memcpy(positions + 3 * count, t->points + 3 * point, 3 * sizeof(double));
            number[point] = (uint32_t)count++;
        }
        faces[i] = number[point];
    }
    free(number);
    *mesh = (bat_mesh){.positions = positions, .faces = faces, .vertex_count = count, .face_count = boundary->count};
    boundary->faces = NULL;
    return true;
}

/// Set the origin of the lattice; `across` receives its width in cells, a power of two.
static bool place_lattice(const solid *s, double cell, double origin[3], uint32_t *across)
{
    double widest = 0;
    for (int c = 0; c < 3; c++)
    {
        widest = fmax(widest, s->high[c] - s->low[c] + 4 * cell);
        // Avoid the round coordinates of planar surfaces.
        origin[c] = s->low[c] - (1.37 + 0.11 * c) * cell;
    }
    *across = 1;
    while (*across * cell < widest && *across < MAX_CELLS_ACROSS / 2)
        *across *= 2;
    return *across * cell >= widest;
}

bat_status solid_cut(const solid *s, double cell, double steepest, bat_mesh *mesh, uint16_t **surfaces, bat_error *error)
{
    tetrahedra t = {.shape = s, .cell = cell, .steepest = steepest};
    shell boundary = {0};
    uint32_t across;
    if (!place_lattice(s, cell, t.origin, &across))
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the requested number of vertices needs too fine a lattice");
    bat_mesh made = {0};
    bat_status status = BAT_OK;
    if (!fill_lattice(&t, across) || !cut_all(&t) || !find_boundary(&t, &boundary))
        status = error_memory(error, t.count * sizeof *t.corners);
    if (status == BAT_OK && boundary.count == 0)
        status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the shape has details finer than the lattice");
    if (status == BAT_OK && (!extract_largest(&boundary, t.point_count) || !make_mesh(&t, &boundary, &made)))
        status = error_memory(error, t.point_count * sizeof(double));
    if (status == BAT_OK)
    {
        *mesh = made;
        *surfaces = boundary.surfaces;
        boundary.surfaces = NULL;
    }
    free(boundary.faces);
    free(boundary.surfaces);
    tetrahedra_free(&t);
    return status;
}
