/// @file
/// The grid of control points of a shell, and its patches; see shell.h.
///
/// Where a vertex has four quads around it, a patch is the bicubic B-spline of the 4 x 4 control points around its quad, as
/// in Catmull and Clark's surfaces (1978). At any other vertex of valence n its points are, with the ring of neighbours a_i,
/// opposite corners d_i, midpoints m_i and centres c_i (Loop, Schaefer, Ni and Castaño, "Approximating subdivision surfaces
/// with Gregory patches", 2009):
///
///     corner     p = ((n - 3) v + 4 / n sum (m_i + c_i)) / (n + 5),
///     edge       e_i = p + 2/3 lambda q_i,  q_i the tangent of the limit surface along edge i,
///     interior   (n v + 2 a_i + 2 a_i+1 + d_i) / (n + 5), changed least so that, with the next point b_i on the edge,
///                f_i + f_i-1 = 2 e_i + 4/3 cos(2 pi / n) (b_i - e_i).
///
/// The last condition is the second of four that make normals agree along the edge; the first holds by the choice of e_i.

#include "surface/shell/shell.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "linalg/vector.h"
#include "mesh/sides.h"

#define MAX_RING 64 ///< the largest valence
#define MAX_SAMPLES 256

static const mesh_sides QUADS = {.quads = true};

// Topology

size_t shell_quads_points(const shell_quads *quads, size_t parts)
{
    return quads->vertex_count + quads->links->edge_count * (parts - 1) + quads->count * (parts - 1) * (parts - 1);
}

uint32_t shell_quads_point(const shell_quads *quads, size_t parts, uint32_t quad, size_t i, size_t j)
{
    const bat_mesh_connectivity *links = quads->links;
    size_t inner = parts - 1;
    bool at_u = i == 0 || i == parts, at_v = j == 0 || j == parts;
    if (at_u && at_v)
        return quads->corners[4 * (size_t)quad + (j == 0 ? (i == 0 ? 0 : 1) : (i == 0 ? 3 : 2))];
    if (!at_u && !at_v)
        return (uint32_t)(quads->vertex_count + links->edge_count * inner + ((size_t)quad * inner + j - 1) * inner + i - 1);
    uint32_t side = at_v ? (j == 0 ? 0 : 2) : (i == 0 ? 3 : 1), half_edge = 4 * quad + side;
    size_t along = side == 0 ? i : side == 1 ? j : side == 2 ? parts - i : parts - j;
    uint32_t twin = links->twin[half_edge];
    if (twin != BAT_MESH_NONE && twin < half_edge)
        along = parts - along;
    return (uint32_t)(quads->vertex_count + links->edge[half_edge] * inner + along - 1);
}

static void make_quads(const shell_layout *layout, const shell_quads *coarse, shell_grid *grid)
{
    size_t spans = grid->spans;
    uint32_t *quad = grid->quads;
    bool *sharp = grid->sharp;
    for (uint32_t f = 0; f < layout->face_count; f++)
        for (size_t j = 0; j < spans; j++)
            for (size_t i = 0; i < spans; i++, quad += 4, sharp += 4)
            {
                const bool *sides = layout->sharp + 4 * (size_t)f;
                quad[0] = shell_quads_point(coarse, spans, f, i, j);
                quad[1] = shell_quads_point(coarse, spans, f, i + 1, j);
                quad[2] = shell_quads_point(coarse, spans, f, i + 1, j + 1);
                quad[3] = shell_quads_point(coarse, spans, f, i, j + 1);
                sharp[0] = j == 0 && sides[0];
                sharp[1] = i + 1 == spans && sides[1];
                sharp[2] = j + 1 == spans && sides[2];
                sharp[3] = i == 0 && sides[3];
            }
}

/// The quads around a vertex, counter-clockwise.
typedef struct shell_ring
{
    bool closed; ///< the vertex is not on the boundary
    size_t count;
    uint32_t spokes[MAX_RING]; ///< the half-edges from the vertex
} shell_ring;

/// False where a ring has too many quads.
static bool ring_at(const shell_grid *grid, uint32_t vertex, shell_ring *ring)
{
    uint32_t first = grid->links.first[vertex], h = first;
    ring->count = 0;
    do
    {
        if (ring->count == MAX_RING)
            return false;
        ring->spokes[ring->count++] = h;
        h = grid->links.twin[sides_previous(&QUADS, h)];
    } while (h != BAT_MESH_NONE && h != first);
    ring->closed = h == first;
    return true;
}

static bool is_sharp(const shell_grid *grid, uint32_t half_edge)
{
    return grid->sharp[half_edge] || grid->links.twin[half_edge] == BAT_MESH_NONE;
}

static bat_status find_kinds(const shell_layout *layout, shell_grid *grid, bat_error *error)
{
    shell_ring ring;
    for (uint32_t v = 0; v < grid->vertex_count; v++)
    {
        if (!ring_at(grid, v, &ring))
            return error_set(error, BAT_UNSUPPORTED, v, 0, "more than %d faces meet at vertex %u", MAX_RING, (unsigned)v);
        size_t count = !ring.closed;
        for (size_t k = 0; k < ring.count; k++)
            count += is_sharp(grid, ring.spokes[k]);
        bool corner = v < layout->vertex_count && layout->corner[v];
        grid->kinds[v] = count > 2 || (corner && count > 0) ? SHELL_CORNER : count == 2 ? SHELL_CREASE : SHELL_SMOOTH;
    }
    return BAT_OK;
}

// Rows

/// A row in the making: a number for each control point, and the list of those that are not 0.
typedef struct row_builder
{
    const shell_grid *grid;
    double *weights;
    uint32_t *columns;
    size_t count;
    sparse_rows *rows;
    size_t column_capacity, value_capacity, row;
    bool failed;
} row_builder;

static void add_vertex(row_builder *builder, uint32_t vertex, double weight)
{
    if (builder->weights[vertex] == 0)
        builder->columns[builder->count++] = vertex;
    // A sum of exactly 0 would list the vertex twice.
    builder->weights[vertex] += weight;
    if (builder->weights[vertex] == 0)
        builder->weights[vertex] = 1e-300;
}

static void end_row(row_builder *builder)
{
    sparse_rows *rows = builder->rows;
    size_t at = rows->starts[builder->row], end = at + builder->count;
    qsort(builder->columns, builder->count, sizeof *builder->columns, ascending_index);
    builder->failed = builder->failed || !ARRAY_GROW(rows->columns, builder->column_capacity, end) ||
                      !ARRAY_GROW(rows->values, builder->value_capacity, end);
    for (size_t k = 0; k < builder->count; k++)
    {
        uint32_t column = builder->columns[k];
        if (!builder->failed)
        {
            rows->columns[at + k] = column;
            rows->values[at + k] = builder->weights[column];
        }
        builder->weights[column] = 0;
    }
    rows->starts[++builder->row] = builder->failed ? at : end;
    builder->count = 0;
}

static uint32_t head_of(const shell_grid *grid, uint32_t half_edge)
{
    return grid->quads[sides_next(&QUADS, half_edge)];
}

/// The corner opposite to the begin of a half-edge in its quad.
static uint32_t opposite_of(const shell_grid *grid, uint32_t half_edge)
{
    return grid->quads[half_edge ^ 2U];
}

static uint32_t left_of(const shell_grid *grid, uint32_t half_edge)
{
    return grid->quads[sides_previous(&QUADS, half_edge)];
}

/// The limit of a vertex.
static void add_corner(row_builder *builder, uint32_t vertex, double weight)
{
    const shell_grid *grid = builder->grid;
    shell_ring ring;
    (void)ring_at(grid, vertex, &ring);
    if (grid->kinds[vertex] == SHELL_CORNER)
    {
        add_vertex(builder, vertex, weight);
        return;
    }
    if (grid->kinds[vertex] == SHELL_CREASE)
    {
        add_vertex(builder, vertex, weight * 2 / 3);
        for (size_t k = 0; k < ring.count; k++)
            if (is_sharp(grid, ring.spokes[k]))
                add_vertex(builder, head_of(grid, ring.spokes[k]), weight / 6);
        if (!ring.closed)
            add_vertex(builder, left_of(grid, ring.spokes[ring.count - 1]), weight / 6);
        return;
    }
    double n = (double)ring.count, scale = weight / (n * (n + 5));
    add_vertex(builder, vertex, n * n * scale);
    for (size_t k = 0; k < ring.count; k++)
    {
        add_vertex(builder, head_of(grid, ring.spokes[k]), 4 * scale);
        add_vertex(builder, opposite_of(grid, ring.spokes[k]), scale);
    }
}

/// The number that stands for the valence at the begin of a half-edge: that of a smooth vertex, or twice the number of
/// quads between the creases on both sides.
static double valence_at(const shell_grid *grid, uint32_t half_edge)
{
    uint32_t vertex = grid->quads[half_edge];
    shell_ring ring;
    (void)ring_at(grid, vertex, &ring);
    if (grid->kinds[vertex] == SHELL_SMOOTH)
        return (double)ring.count;
    size_t count = 1;
    for (uint32_t h = half_edge; !is_sharp(grid, h); count++)
        h = sides_next(&QUADS, grid->links.twin[h]);
    for (uint32_t h = half_edge;; count++)
    {
        uint32_t back = sides_previous(&QUADS, h);
        if (is_sharp(grid, back))
            break;
        h = grid->links.twin[back];
    }
    return count == 1 ? 4 : 2 * (double)count;
}

/// The average that makes the interior point beside the begin of a half-edge, before any change.
static void add_average(row_builder *builder, uint32_t half_edge, double weight)
{
    const shell_grid *grid = builder->grid;
    double n = valence_at(grid, half_edge), scale = weight / (n + 5);
    add_vertex(builder, grid->quads[half_edge], n * scale);
    add_vertex(builder, head_of(grid, half_edge), 2 * scale);
    add_vertex(builder, left_of(grid, half_edge), 2 * scale);
    add_vertex(builder, opposite_of(grid, half_edge), scale);
}

/// Whether the begin of a half-edge is smooth and has another valence than 4.
static bool is_extraordinary(const shell_grid *grid, uint32_t half_edge, shell_ring *ring, size_t *place)
{
    uint32_t vertex = grid->quads[half_edge];
    if (grid->kinds[vertex] != SHELL_SMOOTH || !ring_at(grid, vertex, ring) || ring->count == 4)
        return false;
    for (*place = 0; *place + 1 < ring->count && ring->spokes[*place] != half_edge;)
        ++*place;
    return true;
}

/// 2/3 lambda q_i, with the scale at which it is that of a B-spline for valence 4.
static void add_tangent(row_builder *builder, const shell_ring *ring, size_t place, double weight)
{
    const shell_grid *grid = builder->grid;
    double n = (double)ring->count, turn = cos(ANGLE_PI / n), sigma = 1 / sqrt(4 + turn * turn);
    double full = cos(2 * ANGLE_PI / n), lambda = (5 + full + turn * sqrt(18 + 2 * full)) / 16;
    uint32_t vertex = grid->quads[ring->spokes[0]];
    for (size_t k = 0; k < ring->count; k++)
    {
        uint32_t h = ring->spokes[(place + k) % ring->count];
        double angle = 2 * ANGLE_PI * (double)k / n, scale = weight * 4 * lambda / (3 * n);
        double middle = scale * (1 - sigma * turn) * cos(angle) / 2,
               centre = scale * 2 * sigma * cos(angle + ANGLE_PI / n) / 4;
        add_vertex(builder, vertex, middle + centre);
        add_vertex(builder, head_of(grid, h), middle + centre);
        add_vertex(builder, left_of(grid, h), centre);
        add_vertex(builder, opposite_of(grid, h), centre);
    }
}

/// The point after the begin of a half-edge.
static void add_edge(row_builder *builder, uint32_t half_edge, double weight)
{
    const shell_grid *grid = builder->grid;
    shell_ring ring;
    size_t place;
    if (is_extraordinary(grid, half_edge, &ring, &place))
    {
        add_corner(builder, grid->quads[half_edge], weight);
        add_tangent(builder, &ring, place, weight);
    }
    else if (is_sharp(grid, half_edge))
    {
        add_vertex(builder, grid->quads[half_edge], weight * 2 / 3);
        add_vertex(builder, head_of(grid, half_edge), weight / 3);
    }
    else
    {
        add_average(builder, half_edge, weight / 2);
        add_average(builder, sides_next(&QUADS, grid->links.twin[half_edge]), weight / 2);
    }
}

/// The pseudo-inverse of x_i + x_i-1 = r_i: x_i = sum_k g_k r_i-k.
static double inverse_of_sums(size_t count, size_t k)
{
    double sum = 0, n = (double)count;
    for (size_t j = 0; j < count; j++)
    {
        // 1 / (1 + w^-j) = (1 + i tan(pi j / n)) / 2
        if (2 * j == count)
            continue;
        double angle = 2 * ANGLE_PI * (double)j * (double)k / n;
        sum += (cos(angle) - sin(angle) * tan(ANGLE_PI * (double)j / n)) / 2;
    }
    return sum / n;
}

/// The interior point beside the begin of a half-edge.
static void add_interior(row_builder *builder, uint32_t half_edge)
{
    shell_ring ring;
    size_t place;
    add_average(builder, half_edge, 1);
    if (!is_extraordinary(builder->grid, half_edge, &ring, &place))
        return;
    size_t n = ring.count;
    double slope = 4 * cos(2 * ANGLE_PI / (double)n) / 3;
    for (size_t k = 0; k < n; k++)
    {
        size_t at = (place + n - k) % n;
        uint32_t spoke = ring.spokes[at];
        double share = inverse_of_sums(n, k);
        add_edge(builder, spoke, share * (2 - slope));
        add_edge(builder, builder->grid->links.twin[spoke], share * slope);
        add_average(builder, spoke, -share);
        add_average(builder, ring.spokes[(at + n - 1) % n], -share);
    }
}

static bat_status make_rows(shell_grid *grid, bat_error *error)
{
    size_t corners = 4 * grid->quad_count, count = grid->vertex_count + 3 * corners;
    memory_pool pool = {0};
    row_builder builder = {.grid = grid,
                           .weights = memory_pool_zeros(&pool, grid->vertex_count, sizeof *builder.weights),
                           .columns = memory_pool_array(&pool, grid->vertex_count, sizeof *builder.columns),
                           .rows = &grid->rows};
    grid->rows = (sparse_rows){.row_count = count, .column_count = grid->vertex_count};
    grid->rows.starts = calloc(count + 1, sizeof *grid->rows.starts);
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK && grid->rows.starts == NULL)
        status = error_memory(error, (count + 1) * sizeof *grid->rows.starts);
    for (size_t row = 0; status == BAT_OK && row < count; row++)
    {
        size_t h = row - grid->vertex_count, kind = row < grid->vertex_count ? 0 : 1 + h / corners;
        if (kind == 0)
            add_corner(&builder, (uint32_t)row, 1);
        else if (kind == 1)
            add_edge(&builder, (uint32_t)h, 1);
        else if (kind == 2)
            add_interior(&builder, (uint32_t)(h - corners));
        else if (grid->links.twin[h - 2 * corners] == BAT_MESH_NONE)
        {
            add_vertex(&builder, head_of(grid, (uint32_t)(h - 2 * corners)), 2.0 / 3);
            add_vertex(&builder, grid->quads[h - 2 * corners], 1.0 / 3);
        }
        end_row(&builder);
    }
    if (builder.failed)
        status = error_memory(error, builder.value_capacity * sizeof *grid->rows.values);
    memory_pool_free(&pool);
    return status;
}

bat_status shell_grid_make(const shell_layout *layout, size_t spans, shell_grid *grid, bat_error *error)
{
    shell_grid made = {.spans = spans, .face_count = layout->face_count, .quad_count = layout->face_count * spans * spans};
    bat_mesh_connectivity links = {0};
    bat_status status = sides_connect(&QUADS, layout->quads, layout->face_count, layout->vertex_count, &links, error);
    if (status != BAT_OK)
        return status;
    const shell_quads coarse = {layout->quads, layout->vertex_count, layout->face_count, &links};
    made.vertex_count = shell_quads_points(&coarse, spans);
    made.quads = memory_pool_array(&made.pool, made.quad_count, 4 * sizeof *made.quads);
    made.sharp = memory_pool_zeros(&made.pool, made.quad_count, 4 * sizeof *made.sharp);
    made.kinds = memory_pool_zeros(&made.pool, made.vertex_count, sizeof *made.kinds);
    status = memory_pool_check(&made.pool, error);
    if (status == BAT_OK)
    {
        make_quads(layout, &coarse, &made);
        status = sides_connect(&QUADS, made.quads, made.quad_count, made.vertex_count, &made.links, error);
    }
    bat_mesh_connectivity_free(&links);
    if (status == BAT_OK)
        status = find_kinds(layout, &made, error);
    if (status == BAT_OK)
        status = make_rows(&made, error);
    if (status == BAT_OK)
        *grid = made;
    else
        shell_grid_free(&made);
    return status;
}

void shell_grid_free(shell_grid *grid)
{
    bat_mesh_connectivity_free(&grid->links);
    sparse_rows_free(&grid->rows);
    memory_pool_free(&grid->pool);
    *grid = (shell_grid){0};
}

// Patches

void shell_grid_patch(const shell_grid *grid, uint32_t quad, size_t rows[16])
{
    // The place of corner c, and the steps along the side that begins there and the one that ends there.
    static const int PLACE[4] = {0, 3, 15, 12}, ALONG[4] = {1, 4, -1, -4};
    size_t corners = 4 * grid->quad_count, edges = grid->vertex_count;
    for (uint32_t c = 0; c < 4; c++)
    {
        uint32_t h = 4 * quad + c, back = sides_previous(&QUADS, h), twin = grid->links.twin[back];
        int before = -ALONG[(c + 3) % 4];
        rows[PLACE[c]] = grid->quads[h];
        rows[PLACE[c] + ALONG[c]] = edges + h;
        rows[PLACE[c] + before] = twin != BAT_MESH_NONE ? edges + twin : edges + 2 * corners + back;
        rows[PLACE[c] + ALONG[c] + before] = edges + corners + h;
    }
}

bat_status shell_grid_bezier(const shell_grid *grid, const double *control, double *bezier, bat_error *error)
{
    const sparse_rows *rows = &grid->rows;
    double *points = memory_array(rows->row_count, 3 * sizeof *points);
    if (points == NULL)
        return error_memory(error, rows->row_count * 3 * sizeof *points);
    for (size_t row = 0; row < rows->row_count; row++)
    {
        double sum[3] = {0};
        for (size_t k = rows->starts[row]; k < rows->starts[row + 1]; k++)
            for (int c = 0; c < 3; c++)
                sum[c] += rows->values[k] * control[3 * (size_t)rows->columns[k] + (size_t)c];
        memcpy(points + 3 * row, sum, sizeof sum);
    }
    for (uint32_t quad = 0; quad < grid->quad_count; quad++)
    {
        size_t places[16];
        shell_grid_patch(grid, quad, places);
        for (size_t k = 0; k < 16; k++)
            memcpy(bezier + 3 * (16 * (size_t)quad + k), points + 3 * places[k], 3 * sizeof *bezier);
    }
    free(points);
    return BAT_OK;
}

void shell_bernstein(double t, double values[4], double *slopes)
{
    double s = 1 - t;
    values[0] = s * s * s;
    values[1] = 3 * s * s * t;
    values[2] = 3 * s * t * t;
    values[3] = t * t * t;
    if (slopes == NULL)
        return;
    slopes[0] = -3 * s * s;
    slopes[1] = 3 * s * (s - 2 * t);
    slopes[2] = 3 * t * (2 * s - t);
    slopes[3] = 3 * t * t;
}

void shell_patch_derivatives(const double *bezier, double u, double v, size_t count, double *at)
{
    static const size_t ORDERS[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
    double values[2][3][4];
    for (int d = 0; d < 2; d++)
    {
        double t = d == 0 ? u : v, seconds[4] = {6 - 6 * t, 18 * t - 12, 6 - 18 * t, 6 * t};
        shell_bernstein(t, values[d][0], values[d][1]);
        memcpy(values[d][2], seconds, sizeof seconds);
    }
    memset(at, 0, 3 * count * sizeof *at);
    for (size_t k = 0; k < count; k++)
        for (size_t i = 0; i < 16; i++)
            vector_add(3, values[0][ORDERS[k][0]][i % 4] * values[1][ORDERS[k][1]][i / 4], bezier + 3 * i, at + 3 * k);
}

void shell_patch_evaluate(const double *bezier, double u, double v, double point[3], double along[2][3])
{
    double at[9];
    shell_patch_derivatives(bezier, u, v, along != NULL ? 3 : 1, at);
    memcpy(point, at, 3 * sizeof *at);
    if (along != NULL)
        memcpy(along, at + 3, 6 * sizeof *at);
}

/// Move a place on a side of a quad to the quad beyond, if there is one.
static void cross_side(const shell_grid *grid, uint32_t side, shell_place *place)
{
    double along = side % 2 == 0 ? place->u : place->v, back = side < 2 ? 1 - along : along;
    uint32_t twin = grid->links.twin[4 * place->face + side];
    if (twin == BAT_MESH_NONE)
        return;
    place->face = twin / 4;
    place->u = twin % 4 == 0 ? back : twin % 4 == 1 ? 1 : twin % 4 == 2 ? 1 - back : 0;
    place->v = twin % 4 == 0 ? 0 : twin % 4 == 1 ? back : twin % 4 == 2 ? 1 : 1 - back;
}

/// A step that keeps to the unit square. A step out of it ends on the side that it meets first.
/// @param side receives that side; 4: none
static void bounded_step(shell_place *place, const double step[2], uint32_t *side)
{
    double share = 1, at[2] = {place->u, place->v};
    *side = 4;
    for (uint32_t d = 0; d < 2; d++)
    {
        double to = at[d] + step[d], limit = to < 0 ? 0 : 1;
        if (to >= 0 && to <= 1)
            continue;
        double reach = (limit - at[d]) / step[d];
        if (reach < share)
        {
            share = reach;
            *side = d == 0 ? (to < 0 ? 3 : 1) : (to < 0 ? 0 : 2);
        }
    }
    place->u = fmin(fmax(at[0] + share * step[0], 0), 1);
    place->v = fmin(fmax(at[1] + share * step[1], 0), 1);
    if (*side == 1 || *side == 3)
        place->u = *side == 1;
    else if (*side < 4)
        place->v = *side == 2;
}

double shell_place_correct(const shell_grid *grid, const double *bezier, const double point[3], int steps,
                           shell_place *place)
{
    shell_place best = *place;
    double least = INFINITY;
    for (int k = 0;; k++)
    {
        double at[3], along[2][3], arm[3], step[2];
        shell_patch_evaluate(bezier + 48 * (size_t)place->face, place->u, place->v, at, along);
        vector3_subtract(point, at, arm);
        double squared = vector3_dot(arm, arm);
        if (squared < least)
        {
            least = squared;
            best = *place;
        }
        double uu = vector3_dot(along[0], along[0]), vv = vector3_dot(along[1], along[1]),
               uv = vector3_dot(along[0], along[1]), bu = vector3_dot(arm, along[0]), bv = vector3_dot(arm, along[1]);
        double determinant = uu * vv - uv * uv;
        if (k == steps || !(determinant > 1e-12 * uu * vv))
            break;
        step[0] = (vv * bu - uv * bv) / determinant;
        step[1] = (uu * bv - uv * bu) / determinant;
        // Along a side that the step would leave again, the foot on the side is wanted.
        if ((place->u == 0 && step[0] < 0 && grid->links.twin[4 * place->face + 3] == BAT_MESH_NONE) ||
            (place->u == 1 && step[0] > 0 && grid->links.twin[4 * place->face + 1] == BAT_MESH_NONE))
        {
            step[0] = 0;
            step[1] = bv / vv;
        }
        if ((place->v == 0 && step[1] < 0 && grid->links.twin[4 * place->face] == BAT_MESH_NONE) ||
            (place->v == 1 && step[1] > 0 && grid->links.twin[4 * place->face + 2] == BAT_MESH_NONE))
        {
            step[1] = 0;
            step[0] = (place->u == 0 && bu < 0) || (place->u == 1 && bu > 0) ? 0 : bu / uu;
        }
        uint32_t side;
        bounded_step(place, step, &side);
        if (side < 4)
            cross_side(grid, side, place);
        else if (step[0] * step[0] + step[1] * step[1] < 1e-16)
            break;
    }
    *place = best;
    return least;
}

// Shells as data

void bat_shell_free(bat_shell *shell)
{
    bat_mesh_free(&shell->cage);
    free(shell->patches);
    *shell = (bat_shell){0};
}

bat_status bat_shell_evaluate(const bat_shell *shell, size_t face, double u, double v, double point[3], double normal[3],
                              bat_error *error)
{
    if (face >= shell->face_count)
        return error_set(error, BAT_INVALID_ARGUMENT, face, 0, "face %zu does not exist: there are %zu", face,
                         shell->face_count);
    if (!(u >= 0 && u <= 1 && v >= 0 && v <= 1))
        return ERROR_ARGUMENT(error, "parameters (%g, %g) are not in [0, 1]", u, v);
    double places[2] = {u * (double)shell->spans, v * (double)shell->spans}, along[2][3];
    size_t at[2];
    for (int d = 0; d < 2; d++)
    {
        at[d] = (size_t)places[d] < shell->spans ? (size_t)places[d] : shell->spans - 1;
        places[d] -= (double)at[d];
    }
    size_t patch = (face * shell->spans + at[1]) * shell->spans + at[0];
    shell_patch_evaluate(shell->patches + 48 * patch, places[0], places[1], point, along);
    if (normal != NULL)
    {
        vector3_cross(along[0], along[1], normal);
        (void)vector3_normalize(normal);
    }
    return BAT_OK;
}

bat_status bat_shell_tessellate(const bat_shell *shell, size_t samples, bat_mesh *mesh, bat_error *error)
{
    const bat_mesh *cage = &shell->cage;
    bat_mesh_connectivity links;
    if (samples < 1 || samples > MAX_SAMPLES)
        return error_option(error, "samples", "is %zu, but must be 1 to %d", samples, MAX_SAMPLES);
    bat_status status = sides_connect(&QUADS, cage->faces, cage->face_count, cage->vertex_count, &links, error);
    if (status != BAT_OK)
        return status;
    const shell_quads quads = {cage->faces, cage->vertex_count, cage->face_count, &links};
    bat_mesh made = {.vertex_count = shell_quads_points(&quads, samples),
                     .face_count = cage->face_count * samples * samples};
    if (made.vertex_count >= UINT32_MAX || made.face_count > BAT_MESH_MAX_FACES)
    {
        bat_mesh_connectivity_free(&links);
        return ERROR_TOO_LARGE(error, "%zu faces are too many", made.face_count);
    }
    made.positions = malloc(made.vertex_count * 3 * sizeof *made.positions);
    made.faces = malloc(made.face_count * 4 * sizeof *made.faces);
    made.offsets = sides_offsets(made.face_count, 4);
    if (made.positions == NULL || made.faces == NULL || made.offsets == NULL)
        status = error_memory(error, made.face_count * 4 * sizeof *made.faces);
    uint32_t *face = made.faces;
    for (uint32_t q = 0; q < cage->face_count && status == BAT_OK; q++)
        for (size_t j = 0; j <= samples; j++)
            for (size_t i = 0; i <= samples; i++)
            {
                uint32_t vertex = shell_quads_point(&quads, samples, q, i, j);
                shell_patch_evaluate(shell->patches + 48 * (size_t)q, (double)i / (double)samples,
                                     (double)j / (double)samples, made.positions + 3 * (size_t)vertex, NULL);
                if (i == samples || j == samples)
                    continue;
                *face++ = vertex;
                *face++ = shell_quads_point(&quads, samples, q, i + 1, j);
                *face++ = shell_quads_point(&quads, samples, q, i + 1, j + 1);
                *face++ = shell_quads_point(&quads, samples, q, i, j + 1);
            }
    bat_mesh_connectivity_free(&links);
    if (status == BAT_OK)
        *mesh = made;
    else
        bat_mesh_free(&made);
    return status;
}
