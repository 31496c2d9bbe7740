/// @file
/// Sampling of a hierarchical surface on one lattice. Quads beside finer cells become fans around their centres, so that the
/// triangles have no cracks.
///
/// A trimmed surface is a Delaunay triangulation of the grid's vertices inside and of points of the curves. A curve is
/// divided until no point lies in the circle over a part of it; the parts are then edges (Ruppert, 1995).

#include "io/surface/step.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "linalg/vector.h"
#include "mesh/hash_table.h"
#include "surface/cloud/delaunay.h"
#include "surface/trim/trimming.h"

#include <assert.h>

/// The samples of all cells are on one lattice over the square, with `samples` steps across a cell of the finest level. A
/// cell that is k levels coarser uses every 2^k-th point.
typedef struct lattice
{
    const bat_hierarchical_space *space;
    bat_hierarchical_options options;
    size_t samples[2];
    size_t finest; ///< the finest level
    key_map vertices;
    uint32_t *places; ///< vertex_count x 2: lattice coordinates
    size_t capacity;
    uint32_t *centres; ///< for each quad with more than four border points: its central vertex; else NO_VERTEX
} lattice;

#define NO_VERTEX UINT32_MAX

static const double max_vertices = UINT32_MAX;

static uint64_t place_key(uint32_t u, uint32_t v)
{
    return (uint64_t)u << 32 | v;
}

/// The vertex at lattice coordinates, which is added if it is new; NO_VERTEX when out of memory.
static uint32_t vertex_at(lattice *grid, surface_tessellation *made, uint32_t u, uint32_t v)
{
    uint32_t *vertex = key_map_at(&grid->vertices, place_key(u, v));
    if (vertex == NULL || *vertex != NO_VERTEX)
        return vertex == NULL ? NO_VERTEX : *vertex;
    if (!ARRAY_GROW(grid->places, grid->capacity, 2 * (size_t)made->vertex_count + 2))
        return NO_VERTEX;
    *vertex = (uint32_t)made->vertex_count;
    grid->places[2 * made->vertex_count] = u;
    grid->places[2 * made->vertex_count + 1] = v;
    made->vertex_count++;
    return *vertex;
}

static bat_status begin_lattice(const bat_spline_surface *surface, size_t samples, lattice *grid, surface_tessellation *made,
                                bat_error *error)
{
    *grid = (lattice){.space = surface->space, .options = bat_hierarchical_space_options(surface->space)};
    grid->finest = bat_hierarchical_space_levels(surface->space) - 1;
    double quads = (double)bat_hierarchical_space_cells(surface->space), points = quads;
    for (int d = 0; d < 2; d++)
    {
        grid->samples[d] = samples > 0 ? samples : (size_t)grid->options.degree[d] + 1;
        quads *= (double)grid->samples[d];
        points *= (double)grid->samples[d] + 1;
        if (ldexp((double)grid->options.spans[d] * (double)grid->samples[d], (int)grid->finest) >= max_vertices)
            return ERROR_TOO_LARGE(error, "the finest samples are 2^32 or more along a side");
    }
    if (points + quads >= max_vertices)
        return ERROR_TOO_LARGE(error, "a tessellation of %.0f points is too large", points);
    made->quad_count = (size_t)quads;
    made->quads = memory_pool_array(&made->pool, made->quad_count, 4 * sizeof *made->quads);
    made->levels = memory_pool_array(&made->pool, made->quad_count, sizeof *made->levels);
    grid->centres = memory_pool_array(&made->pool, made->quad_count, sizeof *grid->centres);
    return memory_pool_check(&made->pool, error);
}

/// Add the quads of a cell; `quad` is the number of the first. False when out of memory.
static bool sample_cell(lattice *grid, const bat_spline_box *cell, surface_tessellation *made, size_t quad)
{
    static const uint32_t corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    uint32_t step = (uint32_t)1 << (grid->finest - cell->level);
    for (size_t j = 0; j < grid->samples[1]; j++)
        for (size_t i = 0; i < grid->samples[0]; i++, quad++)
        {
            made->levels[quad] = cell->level;
            for (size_t c = 0; c < 4; c++)
            {
                uint32_t u = (uint32_t)(cell->low[0] * grid->samples[0] + i + corners[c][0]) * step;
                uint32_t v = (uint32_t)(cell->low[1] * grid->samples[1] + j + corners[c][1]) * step;
                uint32_t vertex = vertex_at(grid, made, u, v);
                if (vertex == NO_VERTEX)
                    return false;
                made->quads[4 * quad + c] = vertex;
            }
        }
    return true;
}

/// Write the triangles of a centre and a straight piece of a border, divided at all vertices on it: a finer neighbour has
/// one in the middle. Returns their number.
/// @param out null to count them
static size_t fan_piece(const lattice *grid, uint32_t centre, uint32_t from, uint32_t to, uint32_t *out)
{
    assert(grid->places != NULL);
    const uint32_t *a = grid->places + 2 * (size_t)from, *b = grid->places + 2 * (size_t)to;
    uint64_t u = (uint64_t)a[0] + b[0], v = (uint64_t)a[1] + b[1];
    uint32_t middle =
        ((u | v) & 1) != 0 ? NO_VERTEX : key_map_find(&grid->vertices, place_key((uint32_t)(u / 2), (uint32_t)(v / 2)));
    if (middle == NO_VERTEX)
    {
        if (out != NULL)
            memcpy(out, (const uint32_t[]){centre, from, to}, 3 * sizeof *out);
        return 1;
    }
    size_t count = fan_piece(grid, centre, from, middle, out);
    return count + fan_piece(grid, centre, middle, to, out == NULL ? NULL : out + 3 * count);
}

static size_t fan_quad(const lattice *grid, uint32_t centre, const uint32_t *quad, uint32_t *out)
{
    size_t count = 0;
    for (int side = 0; side < 4; side++)
        count += fan_piece(grid, centre, quad[side], quad[(side + 1) % 4], out == NULL ? NULL : out + 3 * count);
    return count;
}

/// Add a central vertex to every quad with more than four border points, and count the triangles.
static bat_status add_centres(lattice *grid, surface_tessellation *made, bat_error *error)
{
    for (size_t q = 0; q < made->quad_count; q++)
    {
        const uint32_t *quad = made->quads + 4 * q;
        size_t pieces = fan_quad(grid, NO_VERTEX, quad, NULL);
        grid->centres[q] = NO_VERTEX;
        made->triangle_count += pieces > 4 ? pieces : 2;
        if (pieces == 4)
            continue;
        const uint32_t *low = grid->places + 2 * (size_t)quad[0], *high = grid->places + 2 * (size_t)quad[2];
        uint32_t u = low[0] + (high[0] - low[0]) / 2, v = low[1] + (high[1] - low[1]) / 2;
        grid->centres[q] = vertex_at(grid, made, u, v);
        if (grid->centres[q] == NO_VERTEX)
            return error_memory(error, made->vertex_count * 2 * sizeof *grid->places);
    }
    return BAT_OK;
}

static bat_status find_vertices(lattice *grid, surface_tessellation *made, bat_error *error)
{
    size_t cells = bat_hierarchical_space_cells(grid->space), quads = grid->samples[0] * grid->samples[1];
    for (size_t c = 0; c < cells; c++)
    {
        bat_spline_box cell = bat_hierarchical_space_cell(grid->space, c);
        if (!sample_cell(grid, &cell, made, c * quads))
            return error_memory(error, made->vertex_count * 2 * sizeof *grid->places);
    }
    made->grid_count = made->vertex_count;
    return add_centres(grid, made, error);
}

/// Set `normal` to the direction of S_u x S_v, or to zero.
static void set_normal(const double tangents[6], double normal[3])
{
    vector3_cross(tangents, tangents + 3, normal);
    double length = sqrt(vector3_dot(normal, normal));
    for (int c = 0; c < 3; c++)
        normal[c] = length > 0 && isfinite(length) ? normal[c] / length : 0;
}

static bat_status set_parameters(const lattice *grid, surface_tessellation *made, bat_error *error)
{
    made->parameters = memory_pool_array(&made->pool, made->vertex_count, 2 * sizeof(double));
    if (made->parameters == NULL)
        return memory_pool_check(&made->pool, error);
    assert(grid->places != NULL || made->vertex_count == 0);
    for (size_t i = 0; i < 2 * made->vertex_count; i++)
    {
        int d = (int)(i % 2);
        made->parameters[i] =
            grid->places[i] / ldexp((double)(grid->options.spans[d] * grid->samples[d]), (int)grid->finest);
    }
    return BAT_OK;
}

#define NUMBERS 9 ///< a position and two tangents

static bat_status evaluate(const bat_spline_surface *surface, surface_tessellation *made, bat_error *error)
{
    size_t count = made->vertex_count;
    memory_pool scratch = {0};
    made->positions = memory_pool_array(&made->pool, count, 3 * sizeof(double));
    made->normals = memory_pool_array(&made->pool, count, 3 * sizeof(double));
    double *values = memory_pool_array(&scratch, count, NUMBERS * sizeof *values);
    bat_status status = memory_pool_check(&made->pool, error);
    if (status == BAT_OK)
        status = memory_pool_check(&scratch, error);
    if (status == BAT_OK)
        status = bat_spline_surface_evaluate(surface, made->parameters, count, 1, values, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        for (size_t c = 0; c < 3; c++)
            made->positions[3 * i + c] = values[NUMBERS * i + c];
        set_normal(values + NUMBERS * i + 3, made->normals + 3 * i);
    }
    memory_pool_free(&scratch);
    return status;
}

/// Cut a quad without a centre along its shorter diagonal. Returns the number of triangles.
static size_t cut_quad(const double *positions, const uint32_t *quad, uint32_t *out)
{
    const double *corners[4];
    for (int c = 0; c < 4; c++)
        corners[c] = positions + 3 * (size_t)quad[c];
    int first = vector3_distance(corners[1], corners[3]) < vector3_distance(corners[0], corners[2]) ? 1 : 0;
    for (int k = 0; k < 6; k++)
        out[k] = quad[(first + (k % 3 == 0 ? 0 : k / 3 + k % 3)) % 4];
    return 2;
}

static bat_status triangulate(const lattice *grid, surface_tessellation *made, bat_error *error)
{
    uint32_t *out = made->triangles = memory_pool_array(&made->pool, made->triangle_count, 3 * sizeof *made->triangles);
    if (out == NULL)
        return memory_pool_check(&made->pool, error);
    for (size_t q = 0; q < made->quad_count; q++)
    {
        const uint32_t *quad = made->quads + 4 * q;
        out += 3 * (grid->centres[q] == NO_VERTEX ? cut_quad(made->positions, quad, out)
                                                  : fan_quad(grid, grid->centres[q], quad, out));
    }
    return BAT_OK;
}

/// Replace zero normals, which occur where a side is collapsed to a point, by those at points slightly nearer to the centre
/// of the square. Where these vanish as well, use (0, 0, 1).
static bat_status repair_normals(const bat_spline_surface *surface, surface_tessellation *made, bat_error *error)
{
    static const double step = 0x1p-20;
    for (size_t i = 0; i < made->vertex_count; i++)
    {
        const double *at = made->parameters + 2 * i,
                     inside[2] = {at[0] + step * (0.5 - at[0]), at[1] + step * (0.5 - at[1])};
        double *normal = made->normals + 3 * i, values[9];
        if (vector_largest(3, normal) > 0)
            continue;
        bat_status status = bat_spline_surface_evaluate(surface, inside, 1, 1, values, error);
        if (status != BAT_OK)
            return status;
        set_normal(values + 3, normal);
        normal[2] = vector_largest(3, normal) > 0 ? normal[2] : 1;
    }
    return BAT_OK;
}

void tessellation_free(surface_tessellation *tessellation)
{
    memory_pool_free(&tessellation->pool);
    *tessellation = (surface_tessellation){0};
}

// Trimmed surfaces

enum
{
    MAX_ROUNDS = 8, ///< divisions; at acute corners they would not end
    MAX_PARTS = 256 ///< of an edge of a polygon; more where points are near
};

/// Points of one curve after the other, in the plane of parameters times mean lengths of tangents.
typedef struct cut_points
{
    double (*places)[3]; ///< the third coordinate is zero, for the tree
    uint32_t *next;
    size_t count, place_capacity, next_capacity;
    double scale[2];
} cut_points;

static bool add_point(cut_points *cut, double x, double y, uint32_t next)
{
    if (!ARRAY_GROW(cut->places, cut->place_capacity, cut->count + 1) ||
        !ARRAY_GROW(cut->next, cut->next_capacity, cut->count + 1))
        return false;
    const double place[3] = {x, y, 0};
    memcpy(cut->places[cut->count], place, sizeof place);
    cut->next[cut->count++] = next;
    return true;
}

/// The width of a quad at a parameter.
static double step_at(const bat_spline_surface *surface, size_t samples, const cut_points *cut, double u, double v)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(surface->space);
    bat_spline_box cell = bat_hierarchical_space_cell(surface->space, bat_hierarchical_space_locate(surface->space, u, v));
    double least = INFINITY;
    for (int d = 0; d < 2; d++)
    {
        size_t steps = samples > 0 ? samples : (size_t)options.degree[d] + 1;
        least = fmin(least, ldexp(cut->scale[d] / ((double)options.spans[d] * (double)steps), -(int)cell.level));
    }
    return least;
}

/// The polygons of the curves, with edges no longer than the quads beside them.
static bool add_polygons(const bat_spline_surface *surface, size_t samples, const trim_region *region, cut_points *cut)
{
    bool good = true;
    for (size_t l = 0; l < region->loop_count && good; l++)
    {
        size_t first = cut->count;
        for (size_t i = region->loops[l]; i < region->loops[l + 1] && good; i++)
        {
            const double *a = region->points[i], *b = region->points[trim_region_next(region, i)];
            double length = hypot((b[0] - a[0]) * cut->scale[0], (b[1] - a[1]) * cut->scale[1]);
            double step = step_at(surface, samples, cut, (a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
            size_t parts = length > step ? (size_t)fmin(ceil(length / step), MAX_PARTS) : 1;
            for (size_t k = 0; k < parts && good; k++)
            {
                double share = (double)k / (double)parts;
                good = add_point(cut, (a[0] + share * (b[0] - a[0])) * cut->scale[0],
                                 (a[1] + share * (b[1] - a[1])) * cut->scale[1], (uint32_t)cut->count + 1);
            }
        }
        if (good && cut->count > first)
            cut->next[cut->count - 1] = (uint32_t)first;
    }
    return good;
}

/// The middle of an edge, and half of its length.
static double middle_of(const cut_points *cut, size_t edge, double middle[3])
{
    const double *a = cut->places[edge], *b = cut->places[cut->next[edge]];
    for (int d = 0; d < 3; d++)
        middle[d] = (a[d] + b[d]) / 2;
    return hypot(b[0] - a[0], b[1] - a[1]) / 2;
}

/// Divide the edges whose circles hold other points of the curves. `divided` tells whether there were any.
static bat_status divide_edges(cut_points *cut, bool *divided, bat_error *error)
{
    nearest_tree tree;
    neighbour_list near = {0};
    size_t count = cut->count;
    bat_status status = neighbours_build(*cut->places, count, &tree, error);
    if (status != BAT_OK)
        return status;
    *divided = false;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        double middle[3], half = middle_of(cut, i, middle);
        uint32_t end = cut->next[i];
        bool split = false;
        status = neighbours_within(&tree, middle, half * (1 - 1e-9), &near, error);
        for (size_t k = 0; k < near.count && status == BAT_OK; k++)
            split = split || (near.entries[k].item != i && near.entries[k].item != end);
        if (!split || status != BAT_OK)
            continue;
        *divided = true;
        cut->next[i] = (uint32_t)cut->count;
        if (!add_point(cut, middle[0], middle[1], end))
            status = error_memory(error, cut->count * sizeof *cut->places);
    }
    neighbour_list_free(&near);
    nearest_free(&tree);
    return status;
}

/// The places of grid vertices inside, but not in the circle over an edge: `places` has the curves' points before them.
static bat_status gather_places(const surface_tessellation *grid, const trim_region *region, const cut_points *cut,
                                double (*places)[2], size_t *count, bat_error *error)
{
    nearest_tree tree;
    neighbour_list near = {0};
    memory_pool pool = {0};
    double(*inner)[3] = memory_pool_array(&pool, grid->vertex_count, sizeof *inner);
    bool *left_out = memory_pool_zeros(&pool, grid->vertex_count, sizeof *left_out);
    size_t made = 0;
    bat_status status = memory_pool_check(&pool, error);
    for (size_t i = 0; i < grid->vertex_count && status == BAT_OK; i++)
    {
        const double *u = grid->parameters + 2 * i;
        if (!trim_region_contains(region, u[0], u[1]))
            continue;
        inner[made][0] = u[0] * cut->scale[0];
        inner[made][1] = u[1] * cut->scale[1];
        inner[made++][2] = 0;
    }
    if (made > 0)
        status = neighbours_build(*inner, made, &tree, error);
    for (size_t i = 0; i < cut->count && made > 0 && status == BAT_OK; i++)
    {
        double middle[3], half = middle_of(cut, i, middle);
        status = neighbours_within(&tree, middle, 1.1 * half, &near, error);
        for (size_t k = 0; k < near.count && status == BAT_OK; k++)
            left_out[near.entries[k].item] = true;
    }
    for (size_t i = 0; i < cut->count; i++)
        memcpy(places[i], cut->places[i], sizeof *places);
    *count = cut->count;
    for (size_t i = 0; i < made; i++)
        if (!left_out[i])
            memcpy(places[(*count)++], inner[i], sizeof *places);
    if (made > 0 && status != BAT_NO_MEMORY)
        nearest_free(&tree);
    neighbour_list_free(&near);
    memory_pool_free(&pool);
    return status;
}

static bat_status store(const bat_spline_surface *surface, const trim_region *region, const cut_points *cut,
                        const double (*places)[2], size_t count, surface_tessellation *made, bat_error *error)
{
    simplices found;
    bat_status status = planar_delaunay(places, count, &found, error);
    if (status != BAT_OK)
        return status;
    surface_tessellation kept = {0};
    kept.triangles = memory_pool_array(&kept.pool, found.count, 3 * sizeof *kept.triangles);
    kept.parameters = memory_pool_array(&kept.pool, count, 2 * sizeof(double));
    kept.levels = memory_pool_array(&kept.pool, found.count, sizeof *kept.levels);
    uint32_t *numbers = memory_pool_array(&kept.pool, count, sizeof *numbers);
    status = memory_pool_check(&kept.pool, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        numbers[i] = UINT32_MAX;
    for (size_t t = 0; t < found.count && status == BAT_OK; t++)
    {
        const uint32_t *corners = found.corners + 3 * t;
        double centre[2];
        for (int d = 0; d < 2; d++)
            centre[d] = (places[corners[0]][d] + places[corners[1]][d] + places[corners[2]][d]) / 3 / cut->scale[d];
        if (!trim_region_contains(region, centre[0], centre[1]))
            continue;
        for (size_t k = 0; k < 3; k++)
        {
            uint32_t *number = &numbers[corners[k]];
            if (*number == UINT32_MAX)
            {
                *number = (uint32_t)kept.vertex_count++;
                for (size_t d = 0; d < 2; d++)
                    kept.parameters[2 * (size_t)*number + d] = fmin(fmax(places[corners[k]][d] / cut->scale[d], 0), 1);
            }
            kept.triangles[3 * kept.triangle_count + k] = *number;
        }
        size_t cell = bat_hierarchical_space_locate(surface->space, centre[0], centre[1]);
        kept.levels[kept.triangle_count++] = bat_hierarchical_space_cell(surface->space, cell).level;
    }
    kept.grid_count = kept.vertex_count;
    simplices_free(&found);
    if (status == BAT_OK)
        status = evaluate(surface, &kept, error);
    if (status == BAT_OK)
        status = repair_normals(surface, &kept, error);
    if (status != BAT_OK)
    {
        tessellation_free(&kept);
        return status;
    }
    tessellation_free(made);
    *made = kept;
    return BAT_OK;
}

/// Mean lengths of tangents, as differences of the grid's vertices.
static void set_scale(const surface_tessellation *grid, double scale[2])
{
    double length[2] = {0, 0}, steps[2] = {0, 0};
    for (size_t q = 0; q < grid->quad_count; q++)
        for (size_t d = 0; d < 2; d++)
        {
            size_t a = grid->quads[4 * q], b = grid->quads[4 * q + 1 + 2 * d];
            double apart = 0;
            for (size_t c = 0; c < 3; c++)
                apart = hypot(apart, grid->positions[3 * b + c] - grid->positions[3 * a + c]);
            length[d] += apart;
            steps[d] += fabs(grid->parameters[2 * b + d] - grid->parameters[2 * a + d]);
        }
    for (int d = 0; d < 2; d++)
        scale[d] = steps[d] > 0 && length[d] > 0 && isfinite(length[d]) ? length[d] / steps[d] : 1;
    // Only their ratio matters. Where it is extreme, circles over edges hold points of many others, which divide them.
    static const double MIN_SCALE = 1e-2;
    double larger = fmax(scale[0], scale[1]);
    scale[0] = fmax(scale[0] / larger, MIN_SCALE);
    scale[1] = fmax(scale[1] / larger, MIN_SCALE);
}

/// Replace the tessellation of a surface by that of the part within its trimming curves.
/// @param samples see surface_tessellate()
static bat_status tessellation_cut(const bat_spline_surface *surface, size_t samples, surface_tessellation *made,
                                   bat_error *error)
{
    trim_region region;
    cut_points cut = {0};
    bat_status status = trim_region_make(&surface->trim, &region, error);
    if (status != BAT_OK)
        return status;
    set_scale(made, cut.scale);
    if (!add_polygons(surface, samples, &region, &cut))
        status = error_memory(error, cut.count * sizeof *cut.places);
    bool divided = true;
    for (int round = 0; round < MAX_ROUNDS && divided && status == BAT_OK; round++)
        status = divide_edges(&cut, &divided, error);
    double(*places)[2] = memory_pool_array(&made->pool, cut.count + made->vertex_count, sizeof *places);
    size_t count = 0;
    if (status == BAT_OK)
        status = memory_pool_check(&made->pool, error);
    if (status == BAT_OK)
        status = gather_places(made, &region, &cut, places, &count, error);
    if (status == BAT_OK)
        status = store(surface, &region, &cut, (const double(*)[2])places, count, made, error);
    if (status == BAT_OK && made->triangle_count == 0)
        status = ERROR_UNSUPPORTED(error, 0, "the trimming curves leave no triangle of the surface");
    free(cut.places);
    free(cut.next);
    trim_region_free(&region);
    return status;
}

bat_status surface_tessellate(const bat_spline_surface *surface, size_t samples, surface_tessellation *tessellation,
                              bat_error *error)
{
    lattice grid;
    surface_tessellation made = {0};
    bat_status status = begin_lattice(surface, samples, &grid, &made, error);
    if (status == BAT_OK)
        status = find_vertices(&grid, &made, error);
    if (status == BAT_OK)
        status = set_parameters(&grid, &made, error);
    if (status == BAT_OK)
        status = evaluate(surface, &made, error);
    if (status == BAT_OK)
        status = triangulate(&grid, &made, error);
    if (status == BAT_OK)
        status = repair_normals(surface, &made, error);
    key_map_free(&grid.vertices);
    free(grid.places);
    if (status == BAT_OK && surface->trim.loop_count > 0)
        status = tessellation_cut(surface, samples, &made, error);
    if (status == BAT_OK)
        *tessellation = made;
    else
        tessellation_free(&made);
    return status;
}
