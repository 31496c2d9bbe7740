#include "io/surface/tessellate.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector3.h"
#include "mesh/key_map.h"

#include <math.h>
#include <stdlib.h>

/// @file
/// Sampling of a hierarchical surface on one lattice. Quads beside finer cells become fans around their centres, so that the
/// triangles have no cracks.

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

/// Reserve memory for `count` vertices.
static bool reserve_places(lattice *grid, size_t count)
{
    if (count <= grid->capacity)
        return true;
    size_t wanted = count > 2 * grid->capacity ? count : 2 * grid->capacity, bytes;
    if (size_multiply_overflows(wanted, 2 * sizeof *grid->places, &bytes))
        return false;
    uint32_t *places = realloc(grid->places, bytes);
    if (places == NULL)
        return false;
    grid->places = places;
    grid->capacity = wanted;
    return true;
}

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
    if (!reserve_places(grid, made->vertex_count + 1))
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
            return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the finest samples are 2^32 or more along a side");
    }
    if (points + quads >= max_vertices)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "a tessellation of %.0f points is too large", points);
    made->quad_count = (size_t)quads;
    made->quads = memory_array(made->quad_count, 4 * sizeof *made->quads);
    made->levels = memory_array(made->quad_count, sizeof *made->levels);
    grid->centres = memory_array(made->quad_count, sizeof *grid->centres);
    if (made->quads == NULL || made->levels == NULL || grid->centres == NULL || !reserve_places(grid, made->quad_count))
        return error_memory(error, made->quad_count * 4 * sizeof *made->quads);
    return BAT_OK;
}

static void end_lattice(lattice *grid)
{
    key_map_free(&grid->vertices);
    free(grid->places);
    free(grid->centres);
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

/// Called for each piece of a quad's border between neighbouring vertices.
typedef void border_piece(void *context, uint32_t from, uint32_t to);

/// Visit a straight piece of a border, divided at all vertices on it. A finer neighbour has a vertex in the middle of each
/// piece that it divides.
static void walk_piece(const lattice *grid, uint32_t from, uint32_t to, border_piece *visit, void *context)
{
    const uint32_t *a = grid->places + 2 * (size_t)from, *b = grid->places + 2 * (size_t)to;
    uint64_t u = (uint64_t)a[0] + b[0], v = (uint64_t)a[1] + b[1];
    uint32_t middle =
        ((u | v) & 1) != 0 ? NO_VERTEX : key_map_find(&grid->vertices, place_key((uint32_t)(u / 2), (uint32_t)(v / 2)));
    if (middle == NO_VERTEX)
    {
        visit(context, from, to);
        return;
    }
    walk_piece(grid, from, middle, visit, context);
    walk_piece(grid, middle, to, visit, context);
}

static void walk_border(const lattice *grid, const uint32_t *quad, border_piece *visit, void *context)
{
    for (int side = 0; side < 4; side++)
        walk_piece(grid, quad[side], quad[(side + 1) % 4], visit, context);
}

static void count_piece(void *context, uint32_t from, uint32_t to)
{
    (void)from, (void)to;
    size_t *count = context;
    ++*count;
}

/// Add a central vertex to every quad with more than four border points, and count the triangles.
static bat_status add_centres(lattice *grid, surface_tessellation *made, bat_error *error)
{
    for (size_t q = 0; q < made->quad_count; q++)
    {
        const uint32_t *quad = made->quads + 4 * q;
        size_t pieces = 0;
        walk_border(grid, quad, count_piece, &pieces);
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
    made->parameters = memory_array(made->vertex_count, 2 * sizeof(double));
    if (made->parameters == NULL)
        return error_memory(error, made->vertex_count * 2 * sizeof(double));
    for (size_t i = 0; i < 2 * made->vertex_count; i++)
    {
        int d = (int)(i % 2);
        made->parameters[i] =
            grid->places[i] / ldexp((double)(grid->options.spans[d] * grid->samples[d]), (int)grid->finest);
    }
    return BAT_OK;
}

static bat_status evaluate(const bat_spline_surface *surface, surface_tessellation *made, bat_error *error)
{
    enum
    {
        NUMBERS = 9 ///< a position and two tangents
    };
    size_t count = made->vertex_count;
    made->positions = memory_array(count, 3 * sizeof(double));
    made->normals = memory_array(count, 3 * sizeof(double));
    double *values = memory_array(count, NUMBERS * sizeof *values);
    if (made->positions == NULL || made->normals == NULL || values == NULL)
    {
        free(values);
        return error_memory(error, count * NUMBERS * sizeof *values);
    }
    bat_status status = bat_spline_surface_evaluate(surface, made->parameters, count, 1, values, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        for (size_t c = 0; c < 3; c++)
            made->positions[3 * i + c] = values[NUMBERS * i + c];
        set_normal(values + NUMBERS * i + 3, made->normals + 3 * i);
    }
    free(values);
    return status;
}

/// Triangles between a centre and the pieces of a border.
typedef struct fan
{
    uint32_t *next; ///< the place of the next triangle
    uint32_t centre;
} fan;

static void add_triangle(void *context, uint32_t from, uint32_t to)
{
    fan *triangles = context;
    *triangles->next++ = triangles->centre;
    *triangles->next++ = from;
    *triangles->next++ = to;
}

static double distance_squared(const double *positions, uint32_t a, uint32_t b)
{
    double difference[3];
    vector3_subtract(positions + 3 * (size_t)a, positions + 3 * (size_t)b, difference);
    return vector3_dot(difference, difference);
}

/// Cut a quad without a centre along its shorter diagonal.
static void cut_quad(const double *positions, const uint32_t *quad, fan *triangles)
{
    int first = distance_squared(positions, quad[1], quad[3]) < distance_squared(positions, quad[0], quad[2]) ? 1 : 0;
    triangles->centre = quad[first];
    add_triangle(triangles, quad[first + 1], quad[first + 2]);
    add_triangle(triangles, quad[first + 2], quad[(first + 3) % 4]);
}

static bat_status triangulate(const lattice *grid, surface_tessellation *made, bat_error *error)
{
    made->triangles = memory_array(made->triangle_count, 3 * sizeof *made->triangles);
    if (made->triangles == NULL)
        return error_memory(error, made->triangle_count * 3 * sizeof *made->triangles);
    fan triangles = {.next = made->triangles};
    for (size_t q = 0; q < made->quad_count; q++)
    {
        const uint32_t *quad = made->quads + 4 * q;
        triangles.centre = grid->centres[q];
        if (triangles.centre == NO_VERTEX)
            cut_quad(made->positions, quad, &triangles);
        else
            walk_border(grid, quad, add_triangle, &triangles);
    }
    return BAT_OK;
}

static bool is_zero(const double *vector)
{
    return vector[0] == 0 && vector[1] == 0 && vector[2] == 0;
}

/// The normal at a point slightly nearer to the centre of the square. Where it vanishes as well, use (0, 0, 1).
static bat_status normal_inside(const bat_spline_surface *surface, const double parameter[2], double normal[3],
                                bat_error *error)
{
    static const double step = 0x1p-20;
    const double inside[2] = {parameter[0] + step * (0.5 - parameter[0]), parameter[1] + step * (0.5 - parameter[1])};
    double values[9];
    bat_status status = bat_spline_surface_evaluate(surface, inside, 1, 1, values, error);
    if (status != BAT_OK)
        return status;
    set_normal(values + 3, normal);
    if (is_zero(normal))
        normal[2] = 1;
    return BAT_OK;
}

/// Replace zero normals, which occur where a side is collapsed to a point.
static bat_status repair_normals(const bat_spline_surface *surface, surface_tessellation *made, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = 0; i < made->vertex_count && status == BAT_OK; i++)
        if (is_zero(made->normals + 3 * i))
            status = normal_inside(surface, made->parameters + 2 * i, made->normals + 3 * i, error);
    return status;
}

bat_status tessellation_evaluate(const bat_spline_surface *surface, surface_tessellation *tessellation, bat_error *error)
{
    bat_status status = evaluate(surface, tessellation, error);
    return status == BAT_OK ? repair_normals(surface, tessellation, error) : status;
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
    end_lattice(&grid);
    if (status == BAT_OK && surface->trim.loop_count > 0)
        status = tessellation_cut(surface, samples, &made, error);
    if (status == BAT_OK)
        *tessellation = made;
    else
        tessellation_free(&made);
    return status;
}

void tessellation_free(surface_tessellation *tessellation)
{
    free(tessellation->parameters);
    free(tessellation->positions);
    free(tessellation->normals);
    free(tessellation->quads);
    free(tessellation->levels);
    free(tessellation->triangles);
    *tessellation = (surface_tessellation){0};
}
