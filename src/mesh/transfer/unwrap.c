#include "base/counting_sort.h"
#include "base/error.h"
#include "base/option.h"
#include "batten/mesh_transfer.h"
#include "linalg/vector.h"
#include "mesh/check.h"

/// @file
/// An atlas: charts that are projected onto planes, and their packing by outlines.
///
/// Faces join a chart in the order in which they are reached. One that would cover texels of the chart already covered
/// starts another chart, so the faces of a chart do not overlap.

enum
{
    MAX_TRIES = 60, ///< of scales
    TURNS = 16      ///< directions of a chart that are tried, over a quarter turn
};

/// A chart: a run of `order`, and its frame.
typedef struct chart
{
    uint32_t begin, end;
    double axes[2][3];
    double low[2], high[2];
    uint32_t x, y, width, height; ///< in texels, with padding
} chart;

typedef struct atlas
{
    bat_mesh_unwrap_options options;
    const bat_mesh *mesh;
    bat_mesh_connectivity links;
    double *normals;    ///< face_count x 3: unit, or 0
    double *areas;      ///< face_count
    uint32_t *order;    ///< the faces, chart by chart
    uint32_t *chart_of; ///< for each face, or BAT_MESH_NONE
    uint32_t *rank;     ///< the faces by decreasing area
    chart *charts;
    size_t count;
    unsigned char *cells; ///< occupied texels while a chart grows
    size_t cell_side;
} atlas;

bat_mesh_unwrap_options bat_mesh_unwrap_defaults(void)
{
    return (bat_mesh_unwrap_options){.size = 1024, .padding = 4, .max_angle = 0.8};
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_mesh_unwrap_options, size, OPTION_SIZE, 16, 16384),
    OPTION_FIELD(bat_mesh_unwrap_options, padding, OPTION_SIZE, 1, 64),
    OPTION_FIELD(bat_mesh_unwrap_options, max_angle, OPTION_NUMBER, 0.1, 1.5),
};

const bat_options_table bat_mesh_unwrap_fields = OPTIONS_TABLE(bat_mesh_unwrap_options, FIELDS, NULL);

static const double *corner_of(const atlas *all, uint32_t face, size_t c)
{
    return all->mesh->positions + 3 * (size_t)all->mesh->faces[3 * (size_t)face + c];
}

static void measure_faces(atlas *all)
{
    for (uint32_t f = 0; f < all->mesh->face_count; f++)
    {
        double *normal = all->normals + 3 * (size_t)f;
        vector3_triangle(corner_of(all, f, 0), corner_of(all, f, 1), corner_of(all, f, 2), normal);
        all->areas[f] = vector3_length(normal) / 2;
        (void)vector3_normalize(normal);
        all->rank[f] = f;
    }
}

/// The plane perpendicular to a normal.
static void make_axes(const double normal[3], double axes[2][3])
{
    size_t least = fabs(normal[0]) <= fabs(normal[1]) && fabs(normal[0]) <= fabs(normal[2]) ? 0
                   : fabs(normal[1]) <= fabs(normal[2])                                     ? 1
                                                                                            : 2;
    double unit[3] = {least == 0, least == 1, least == 2};
    vector3_cross(unit, normal, axes[0]);
    if (!vector3_normalize(axes[0]))
        axes[0][0] = 1;
    vector3_cross(normal, axes[0], axes[1]);
}

static void project(const atlas *all, const chart *of, uint32_t face, double flat[3][2])
{
    for (size_t c = 0; c < 3; c++)
        for (size_t k = 0; k < 2; k++)
            flat[c][k] = vector3_dot(corner_of(all, face, c), of->axes[k]);
}

/// Set the box of the faces of a chart in its axes.
static void find_box(const atlas *all, chart *of)
{
    double flat[3][2];
    box_clear(2, of->low, of->high);
    for (uint32_t i = of->begin; i < of->end; i++)
    {
        project(all, of, all->order[i], flat);
        for (size_t c = 0; c < 3; c++)
            box_include(2, flat[c], of->low, of->high);
    }
}

/// Visit the cells of side `cell` whose centres lie inside a triangle. With `mark`, occupies them; without, returns whether
/// one is occupied already.
static bool cover(atlas *all, double flat[3][2], const double origin[2], double cell, bool mark)
{
    double p[3][2], low[2], high[2];
    for (size_t c = 0; c < 3; c++)
        for (size_t k = 0; k < 2; k++)
            p[c][k] = (flat[c][k] - origin[k]) / cell;
    box_of_points(2, p[0], 3, low, high);
    double most = (double)all->cell_side - 1;
    for (double y = fmax(0, floor(low[1])); y <= fmin(most, high[1]); y++)
        for (double x = fmax(0, floor(low[0])); x <= fmin(most, high[0]); x++)
        {
            const double at[2] = {x + 0.5, y + 0.5};
            if (!(vector2_turn(p[0], p[1], at) > 0 && vector2_turn(p[1], p[2], at) > 0 && vector2_turn(p[2], p[0], at) > 0))
                continue;
            unsigned char *occupied = &all->cells[(size_t)y * all->cell_side + (size_t)x];
            if (!mark && *occupied != 0)
                return true;
            *occupied = mark ? 1 : *occupied;
        }
    return false;
}

/// Collect faces around a first one whose normals are near the mean normal. They are not part of the chart yet.
static void collect(atlas *all, uint32_t first, uint32_t number, chart *made)
{
    double sum[3] = {0}, limit = cos(all->options.max_angle);
    all->order[made->end++] = first;
    all->chart_of[first] = number;
    for (size_t k = 0; k < 3; k++)
        sum[k] = all->areas[first] * all->normals[3 * (size_t)first + k];
    for (uint32_t i = made->begin; i < made->end; i++)
        for (uint32_t h = 3 * all->order[i]; h < 3 * all->order[i] + 3; h++)
        {
            uint32_t twin = all->links.twin[h], face = twin / 3;
            if (twin == BAT_MESH_NONE || all->chart_of[face] != BAT_MESH_NONE)
                continue;
            const double *normal = all->normals + 3 * (size_t)face;
            if (vector3_dot(sum, normal) < limit * vector3_length(sum))
                continue;
            all->chart_of[face] = number;
            all->order[made->end++] = face;
            vector_add(3, all->areas[face], normal, sum);
        }
    (void)vector3_normalize(sum);
    make_axes(sum, made->axes);
}

/// Keep those collected faces that look towards the viewer of the plane and do not cover others; release the rest.
static void choose(atlas *all, chart *made)
{
    static const double slope = 0.15; // the least cosine between a face and the plane
    double flat[3][2], normal[3];
    uint32_t kept = made->begin;
    vector3_cross(made->axes[0], made->axes[1], normal);
    find_box(all, made);
    double side = fmax(made->high[0] - made->low[0], made->high[1] - made->low[1]),
           cell = side > 0 ? side / (double)all->cell_side : 1;
    memset(all->cells, 0, all->cell_side * all->cell_side);
    for (uint32_t i = made->begin; i < made->end; i++)
    {
        uint32_t face = all->order[i];
        project(all, made, face, flat);
        bool first = i == made->begin, empty = !(all->areas[face] > 0);
        if (!first && !empty &&
            (vector3_dot(normal, all->normals + 3 * (size_t)face) < slope || cover(all, flat, made->low, cell, false)))
        {
            all->chart_of[face] = BAT_MESH_NONE;
            continue;
        }
        (void)cover(all, flat, made->low, cell, true);
        all->order[kept++] = face;
    }
    made->end = kept;
}

/// Turn the axes so that the box of a chart is smallest, and set the box.
static void turn(const atlas *all, chart *of)
{
    static const double quarter = 1.5707963267948966;
    chart best = *of;
    double least = INFINITY;
    for (int i = 0; i < TURNS; i++)
    {
        chart tried = *of;
        double angle = quarter * i / TURNS;
        for (size_t k = 0; k < 3; k++)
        {
            tried.axes[0][k] = cos(angle) * of->axes[0][k] + sin(angle) * of->axes[1][k];
            tried.axes[1][k] = cos(angle) * of->axes[1][k] - sin(angle) * of->axes[0][k];
        }
        find_box(all, &tried);
        double area = (tried.high[0] - tried.low[0]) * (tried.high[1] - tried.low[1]);
        if (area < least)
        {
            least = area;
            best = tried;
        }
    }
    *of = best;
}

/// Sort numbers by decreasing sizes. False when out of memory.
static bool rank(const double *sizes, size_t count, uint32_t *order)
{
    scored *pairs = memory_array(count, sizeof *pairs);
    if (pairs == NULL)
        return false;
    for (size_t i = 0; i < count; i++)
        pairs[i] = (scored){sizes[i], i};
    qsort(pairs, count, sizeof *pairs, larger_first);
    for (size_t i = 0; i < count; i++)
        order[i] = (uint32_t)pairs[i].index;
    free(pairs);
    return true;
}

static void make_charts(atlas *all)
{
    uint32_t placed = 0;
    for (size_t i = 0; i < all->mesh->face_count; i++)
    {
        if (all->chart_of[all->rank[i]] != BAT_MESH_NONE)
            continue;
        chart *made = &all->charts[all->count];
        *made = (chart){.begin = placed, .end = placed};
        collect(all, all->rank[i], (uint32_t)all->count, made);
        choose(all, made);
        turn(all, made);
        placed = made->end;
        all->count++;
    }
}

// Packing

/// The outline of a chart: for each column its first and last texels, with padding. `low` > `high`: none.
static void outline(const atlas *all, const chart *of, double scale, uint32_t *low, uint32_t *high)
{
    size_t padding = all->options.padding;
    for (uint32_t x = 0; x < of->width; x++)
    {
        low[x] = UINT32_MAX;
        high[x] = 0;
    }
    for (uint32_t i = of->begin; i < of->end; i++)
    {
        double flat[3][2];
        project(all, of, all->order[i], flat);
        for (size_t e = 0; e < 3; e++)
        {
            // Each edge in columns; the padding widens it on all sides.
            double ax = (flat[e][0] - of->low[0]) * scale, ay = (flat[e][1] - of->low[1]) * scale,
                   bx = (flat[(e + 1) % 3][0] - of->low[0]) * scale, by = (flat[(e + 1) % 3][1] - of->low[1]) * scale;
            double from = floor(fmin(ax, bx)), to = floor(fmax(ax, bx));
            for (double column = from; column <= to; column++)
            {
                double s = bx != ax ? fmin(1, fmax(0, (column - ax) / (bx - ax))) : 0,
                       t = bx != ax ? fmin(1, fmax(0, (column + 1 - ax) / (bx - ax))) : 1;
                double bottom = floor(fmin(ay + s * (by - ay), ay + t * (by - ay))),
                       top = floor(fmax(ay + s * (by - ay), ay + t * (by - ay))) + 2 * (double)padding;
                for (size_t x = (size_t)column; x <= (size_t)column + 2 * padding && x < of->width; x++)
                {
                    low[x] = bottom < low[x] ? (uint32_t)bottom : low[x];
                    high[x] = top > high[x] ? (uint32_t)top : high[x];
                }
            }
        }
    }
}

/// Put a chart where its outline rises least above the horizon. False when it does not fit.
static bool place(const atlas *all, chart *of, const uint32_t *low, const uint32_t *high, uint32_t *horizon)
{
    size_t size = all->options.size;
    uint32_t best_y = UINT32_MAX, best_x = 0;
    for (uint32_t x = 0; x + of->width <= size; x++)
    {
        uint32_t y = 0;
        for (uint32_t c = 0; c < of->width && y < best_y; c++)
            if (low[c] <= high[c] && horizon[x + c] > low[c] && horizon[x + c] - low[c] > y)
                y = horizon[x + c] - low[c];
        if (y < best_y)
        {
            best_y = y;
            best_x = x;
        }
    }
    if (best_y == UINT32_MAX || best_y + of->height > size)
        return false;
    of->x = best_x;
    of->y = best_y;
    for (uint32_t c = 0; c < of->width; c++)
        if (low[c] <= high[c])
            horizon[best_x + c] = best_y + high[c] + 1;
    return true;
}

/// Try to pack all charts at a scale, in texels per unit of length.
static bool pack(const atlas *all, const uint32_t *order, double scale, uint32_t *workspace)
{
    size_t size = all->options.size;
    uint32_t *horizon = workspace, *low = workspace + size, *high = workspace + 2 * size;
    memset(horizon, 0, size * sizeof *horizon);
    for (size_t i = 0; i < all->count; i++)
    {
        chart *of = &all->charts[order[i]];
        double width = floor((of->high[0] - of->low[0]) * scale) + 1 + 2 * (double)all->options.padding,
               height = floor((of->high[1] - of->low[1]) * scale) + 1 + 2 * (double)all->options.padding;
        if (width > (double)size || height > (double)size)
            return false;
        of->width = (uint32_t)width;
        of->height = (uint32_t)height;
        outline(all, of, scale, low, high);
        if (!place(all, of, low, high, horizon))
            return false;
    }
    return true;
}

/// Find a scale at which all charts fit. 0: none.
static double pack_all(const atlas *all, const uint32_t *order, uint32_t *workspace)
{
    static const double shrink = 0.95;
    double area = 0, scale;
    for (size_t i = 0; i < all->count; i++)
        area += (all->charts[i].high[0] - all->charts[i].low[0]) * (all->charts[i].high[1] - all->charts[i].low[1]);
    scale = area > 0 ? (double)all->options.size / sqrt(area) : 1;
    for (int i = 0; i < MAX_TRIES; i++, scale *= shrink)
        if (pack(all, order, scale, workspace))
            return scale;
    return 0;
}

/// Set the texture coordinates: those of a chart's vertices, chart by chart.
static bool set_texture(const atlas *all, double scale, bat_mesh *made)
{
    const bat_mesh *mesh = all->mesh;
    size_t corners = 3 * mesh->face_count, padding = all->options.padding;
    uint32_t *number = memory_array(mesh->vertex_count, sizeof *number);
    made->texture = memory_array(corners, 2 * sizeof *made->texture);
    made->texture_faces = memory_array(corners, sizeof *made->texture_faces);
    bool room = number != NULL && made->texture != NULL && made->texture_faces != NULL;
    if (room)
        memset(number, 0xff, mesh->vertex_count * sizeof *number);
    for (size_t i = 0; i < all->count && room; i++)
    {
        const chart *of = &all->charts[i];
        const uint32_t origin[2] = {of->x, of->y};
        size_t first = made->texture_count;
        for (uint32_t f = of->begin; f < of->end; f++)
            for (size_t c = 0; c < 3; c++)
            {
                size_t h = 3 * (size_t)all->order[f] + c;
                uint32_t vertex = mesh->faces[h];
                if (number[vertex] == BAT_MESH_NONE || number[vertex] < first)
                {
                    number[vertex] = (uint32_t)made->texture_count++;
                    for (size_t k = 0; k < 2; k++)
                        made->texture[2 * (size_t)number[vertex] + k] =
                            ((vector3_dot(mesh->positions + 3 * (size_t)vertex, of->axes[k]) - of->low[k]) * scale +
                             origin[k] + (double)padding) /
                            (double)all->options.size;
                }
                made->texture_faces[h] = number[vertex];
            }
    }
    free(number);
    return room;
}

static bat_status unwrap(atlas *all, memory_pool *pool, bat_mesh *made, bat_error *error)
{
    size_t faces = all->mesh->face_count, size = all->options.size;
    all->cell_side = size < 512 ? size : 512;
    all->normals = memory_pool_array(pool, faces, 3 * sizeof *all->normals);
    all->areas = memory_pool_array(pool, faces, sizeof *all->areas);
    all->order = memory_pool_array(pool, faces, sizeof *all->order);
    all->chart_of = memory_pool_array(pool, faces, sizeof *all->chart_of);
    all->rank = memory_pool_array(pool, faces, sizeof *all->rank);
    all->charts = memory_pool_array(pool, faces, sizeof *all->charts);
    all->cells = memory_pool_array(pool, all->cell_side * all->cell_side, 1);
    uint32_t *workspace = memory_pool_array(pool, 3 * size, sizeof *workspace);
    bat_status status = memory_pool_check(pool, error);
    if (status != BAT_OK)
        return status;
    memset(all->chart_of, 0xff, faces * sizeof *all->chart_of);
    measure_faces(all);
    if (!rank(all->areas, faces, all->rank))
        return error_memory(error, faces * sizeof(scored));
    make_charts(all);
    double *heights = all->areas; // used as workspace here
    for (size_t i = 0; i < all->count; i++)
        heights[i] = all->charts[i].high[1] - all->charts[i].low[1];
    if (!rank(heights, all->count, all->rank))
        return error_memory(error, faces * sizeof(scored));
    double scale = pack_all(all, all->rank, workspace);
    if (scale == 0)
        return error_option(error, "size", "is too small for the %zu charts of the atlas", all->count);
    return set_texture(all, scale, made) ? BAT_OK : error_memory(error, 6 * faces * sizeof(double));
}

bat_status bat_mesh_unwrap(bat_mesh *mesh, const bat_mesh_unwrap_options *options, size_t *charts, bat_error *error)
{
    atlas all = {.options = options != NULL ? *options : bat_mesh_unwrap_defaults(), .mesh = mesh};
    memory_pool pool = {0};
    bat_mesh made = {0};
    bat_status status = bat_options_check(&bat_mesh_unwrap_fields, &all.options, error);
    if (status == BAT_OK)
        status = mesh_check_triangles(mesh, error);
    if (status == BAT_OK)
        status = bat_mesh_connect(mesh, &all.links, error);
    if (status != BAT_OK)
        return status;
    status = unwrap(&all, &pool, &made, error);
    if (status == BAT_OK)
    {
        mesh_swap_texture(mesh, &made);
        if (charts != NULL)
            *charts = all.count;
    }
    bat_mesh_free(&made);
    memory_pool_free(&pool);
    bat_mesh_connectivity_free(&all.links);
    return status;
}
