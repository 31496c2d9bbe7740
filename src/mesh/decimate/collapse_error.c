#include "mesh/decimate/collapse_error.h"

#include "linalg/vector.h"

#include <string.h>

/// @file
/// The quadric error of a vertex position p is the sum of area-weighted squared distances from planes, p^T A p + 2 b^T p + c
/// (Garland and Heckbert, 1997). The new vertex minimizes the sum of both ends' errors.

/// Relative to the trace of A, added to its diagonal. Directions with smaller eigenvalues leave the vertex near the
/// midpoint.
static const double DAMPING = 1e-6;
/// The weight of an edge's squared length. It orders edges by length where all errors vanish.
static const double LENGTH_SHARE = 1e-8;
/// Relative to weight times squared length: smaller differences of errors are rounding errors.
static const double ROUNDING = 1e-14;
/// The largest distance of the new vertex from the midpoint, relative to the edge's length.
static const double MAX_OFFSET = 2;
/// The quality of a face below which its normal is meaningless.
static const double DEGENERATE = 1e-7;
/// sqrt(12). The quality of a triangle is sqrt(12) times twice its area over its squared edge lengths; it is 1 for
/// equilateral triangles.
static const double QUALITY_FACTOR = 3.46410161513775458705;

void error_vertices_set(const collapse_mesh *mesh, double curve_weight, error_vertex *vertices)
{
    for (size_t v = 0; v < mesh->vertex_count; v++)
        vertices[v].planes = (quadric){0};
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *corner = mesh->corner + 3 * f;
        double normal[3];
        vector3_triangle(vertices[corner[0]].position, vertices[corner[1]].position, vertices[corner[2]].position, normal);
        double twice_area = vector3_length(normal);
        if (!vector3_normalize(normal))
            continue;
        for (uint32_t c = 0; c < 3; c++)
        {
            uint32_t ends[2] = {corner[c], corner[(c + 1) % 3]};
            quadric_add_plane(&vertices[corner[c]].planes, normal, twice_area / 2);
            if (collapse_edge_is_curve(mesh, mesh->edge[3 * f + c]))
            {
                double along[3], upright[3];
                vector3_subtract(vertices[ends[1]].position, vertices[ends[0]].position, along);
                vector3_cross(along, normal, upright);
                bool there = vector3_normalize(upright);
                for (int end = 0; end < 2 && there; end++)
                    quadric_add_plane(&vertices[ends[end]].planes, upright,
                                      (collapse_edge_is_rim(mesh, mesh->edge[3 * f + c]) ? curve_weight : 1) *
                                          vector3_dot(along, along));
            }
        }
    }
}

/// The sum of the quadrics of both ends, about the midpoint, and half the edge vector.
static quadric planes_of_edge(const error_vertex *a, const error_vertex *b, double *half)
{
    double back[3];
    for (int c = 0; c < 3; c++)
    {
        half[c] = (b->position[c] - a->position[c]) / 2;
        back[c] = -half[c];
    }
    quadric of_a = quadric_moved(&a->planes, half), of_b = quadric_moved(&b->planes, back);
    return quadric_sum(&of_a, &of_b);
}

error_placement error_place(const collapse_mesh *mesh, const error_vertex *vertices, const attributes *fields, uint32_t edge,
                            uint32_t kept)
{
    uint32_t h = mesh->half_edge[edge], i = mesh->corner[h], j = mesh->corner[bat_mesh_next(h)];
    const error_vertex *a = &vertices[i], *b = &vertices[j];
    double half[3], offset[3] = {0};
    quadric planes = planes_of_edge(a, b, half);
    double square = 4 * vector3_dot(half, half), weight = quadric_weight(&planes), penalty = LENGTH_SHARE * weight * square;
    quadric of_values;
    double of_weights;
    if (attributes_error(fields, mesh, edge, half, kept, &of_values, &of_weights))
        planes = quadric_sum(&planes, &of_values);
    error_placement placed;
    const double back[3] = {-half[0], -half[1], -half[2]};
    if (kept != BAT_MESH_NONE)
    {
        placed.error = fmax(quadric_error(&planes, kept == i ? back : half), 0) + penalty;
        memcpy(placed.position, vertices[kept].position, sizeof placed.position);
        return placed;
    }
    double at_a = quadric_error(&planes, back), at_b = quadric_error(&planes, half), at_middle = planes.constant;
    double smallest = fmin(at_middle, fmin(at_a, at_b)), rounding = ROUNDING * weight * square;
    bool solved = quadric_minimize(&planes, DAMPING * weight, offset) &&
                  vector3_dot(offset, offset) <= MAX_OFFSET * MAX_OFFSET * square;
    double best = solved ? quadric_error(&planes, offset) : INFINITY;
    if (best < smallest - rounding)
        for (int c = 0; c < 3; c++)
            placed.position[c] = a->position[c] + half[c] + offset[c];
    else if (at_middle <= smallest + rounding)
        for (int c = 0; c < 3; c++)
            placed.position[c] = a->position[c] + half[c];
    else
        memcpy(placed.position, at_a <= at_b ? a->position : b->position, sizeof placed.position);
    placed.error = fmax(fmin(best, smallest), 0) + penalty;
    return placed;
}

void error_merge(error_vertex *vertices, uint32_t i, uint32_t j, const double *position)
{
    double from_i[3], from_j[3];
    vector3_subtract(position, vertices[i].position, from_i);
    vector3_subtract(position, vertices[j].position, from_j);
    quadric of_i = quadric_moved(&vertices[i].planes, from_i), of_j = quadric_moved(&vertices[j].planes, from_j);
    vertices[i].planes = quadric_sum(&of_i, &of_j);
    memcpy(vertices[i].position, position, sizeof vertices[i].position);
}

/// The normal of a face, with twice its area as length, and the sum of its squared edge lengths.
typedef struct face_shape
{
    double normal[3], square; ///< `square` is the squared length of the normal
    double edges;
} face_shape;

static face_shape shape_of(const double *a, const double *b, const double *c)
{
    double ab[3], ac[3], bc[3];
    face_shape shape;
    vector3_subtract(b, a, ab);
    vector3_subtract(c, a, ac);
    vector3_subtract(c, b, bc);
    vector3_cross(ab, ac, shape.normal);
    shape.square = vector3_dot(shape.normal, shape.normal);
    shape.edges = vector3_dot(ab, ab) + vector3_dot(ac, ac) + vector3_dot(bc, bc);
    return shape;
}

/// Whether the quality of a face is at least `smallest`.
static bool has_quality(const face_shape *shape, double smallest)
{
    double bound = smallest * shape->edges / QUALITY_FACTOR;
    return shape->square >= bound * bound;
}

static bool has_normal(const face_shape *shape)
{
    double bound = DEGENERATE * shape->edges / QUALITY_FACTOR;
    return shape->square > bound * bound;
}

/// The lowest quality of the ring's faces before the collapse, including the vanishing ones.
static double worst_quality(const error_vertex *vertices, const collapse_ring *ring)
{
    double worst = 1;
    for (uint32_t k = 0; k < ring->count + ring->vanishing; k++)
    {
        const double *point[3];
        for (uint32_t c = 0; c < 3; c++)
            point[c] = vertices[collapse_ring_vertex(ring, k, c)].position;
        face_shape shape = shape_of(point[0], point[1], point[2]);
        worst = fmin(worst, QUALITY_FACTOR * sqrt(shape.square) / shape.edges);
    }
    return worst;
}

bool error_faces_stay_valid(const error_vertex *vertices, const collapse_ring *ring, const double *position,
                            double min_normal, double min_quality)
{
    double smallest = min_quality;
    bool relaxed = false;
    for (uint32_t k = 0; k < ring->count; k++)
    {
        const double *apex = vertices[k >= ring->j_begin && k < ring->j_end ? ring->j : ring->i].position;
        const double *from = vertices[ring->vertex[k]].position, *to = vertices[ring->vertex[k + 1]].position;
        face_shape before = shape_of(apex, from, to), after = shape_of(position, from, to);
        if (has_normal(&before) &&
            !(vector3_dot(before.normal, after.normal) > min_normal * sqrt(before.square * after.square)))
            return false;
        if (has_quality(&after, smallest))
            continue;
        if (!relaxed)
            smallest = fmin(smallest, worst_quality(vertices, ring));
        relaxed = true;
        if (!has_quality(&after, smallest))
            return false;
    }
    return true;
}

// Linear constraints on the new vertex, from volume preservation to the optimization of the shape (1998, section 4). All
// positions are relative to the middle of the edge.

/// The squared cosine and sine of 1 degree, the angle above which constraints are independent (1998, section 4.1).
static const double SQUARED_COSINE = 0.99969541350954785, SQUARED_SINE = 0.00030458649045213;
/// Gradients shorter than this share of the matrix are rounding errors.
static const double GRADIENT_ROUNDING = 1e-10;
/// The weights of the volume and of the boundary (1999, section 3).
static const double VOLUME_WEIGHT = 0.5, BOUNDARY_WEIGHT = 0.5;
/// The largest distance of the new vertex from the middle, relative to the edge's length.
static const double MAX_MOVE = 4;

/// A position nearer to an end than this share of the edge's length is that end.
static const double SAME = 1e-9;

/// Up to three independent equations row . d = right.
typedef struct constraints
{
    double row[3][3], right[3];
    int count;
} constraints;

/// Three edges along a boundary or crease: those before, at and after the edge.
typedef struct curve_chain
{
    double point[4][3]; ///< relative to the middle
    int edges;
} curve_chain;

/// Add a face to the sums of one of its vertices, or take it away.
static void add_face(quadric *sums, const double *normal, double sign)
{
    quadric_add_plane(sums, normal, sign);
    sums->x += sign * normal[0];
    sums->y += sign * normal[1];
    sums->z += sign * normal[2];
}

void memoryless_vertex_set(const collapse_mesh *mesh, error_vertex *vertices, uint32_t vertex)
{
    error_vertex *sums = &vertices[vertex];
    quadric planes = {0};
    uint32_t first = mesh->first[vertex], h = first;
    if (first == BAT_MESH_NONE)
    {
        sums->planes = planes;
        return;
    }
    double from[3], to[3], normal[3];
    vector3_subtract(vertices[mesh->corner[bat_mesh_next(h)]].position, sums->position, from);
    do
    {
        uint32_t previous = bat_mesh_previous(h);
        vector3_subtract(vertices[mesh->corner[previous]].position, sums->position, to);
        vector3_cross(from, to, normal);
        add_face(&planes, normal, 1);
        memcpy(from, to, sizeof from);
        h = mesh->twin[previous];
    } while (h != BAT_MESH_NONE && h != first);
    sums->planes = planes;
}

void memoryless_merge(error_vertex *vertices, const collapse_ring *ring, const double *position)
{
    quadric sums = {0};
    for (uint32_t k = 0; k < ring->count + ring->vanishing; k++)
    {
        double normal[3];
        error_vertex *b = &vertices[collapse_ring_vertex(ring, k, 1)], *c = &vertices[collapse_ring_vertex(ring, k, 2)];
        vector3_triangle(vertices[collapse_ring_vertex(ring, k, 0)].position, b->position, c->position, normal);
        add_face(&b->planes, normal, -1);
        add_face(&c->planes, normal, -1);
        if (k >= ring->count)
            continue;
        vector3_triangle(position, b->position, c->position, normal);
        add_face(&b->planes, normal, 1);
        add_face(&c->planes, normal, 1);
        add_face(&sums, normal, 1);
    }
    vertices[ring->i].planes = sums;
    memcpy(vertices[ring->i].position, position, sizeof vertices->position);
}

/// Add an equation if it is independent of the others (1998, section 4.1).
static void add_constraint(constraints *all, const double *row, double right, double smallest)
{
    double square = vector3_dot(row, row);
    if (!(square > smallest * smallest))
        return;
    double normal[3] = {0}, along;
    if (all->count > 2)
        return;
    if (all->count == 1)
    {
        along = vector3_dot(all->row[0], row);
        if (along * along > square * SQUARED_COSINE)
            return;
    }
    if (all->count == 2)
    {
        vector3_cross(all->row[0], all->row[1], normal);
        along = vector3_dot(normal, row);
        if (along * along <= vector3_dot(normal, normal) * square * SQUARED_SINE)
            return;
    }
    double scale = 1 / sqrt(square);
    for (int c = 0; c < 3; c++)
        all->row[all->count][c] = scale * row[c];
    all->right[all->count++] = scale * right;
}

/// Add the equations that minimize d^T A d + 2 b^T d within the constraints that are there (1998, section 4.2).
static void add_minimum(constraints *all, const quadric *q)
{
    const double gradient[3] = {q->x, q->y, q->z};
    double smallest = GRADIENT_ROUNDING * quadric_weight(q), direction[2][3] = {{0}}, row[3];
    if (!(smallest > 0))
        return;
    if (all->count == 0)
    {
        const double rows[3][3] = {{q->xx, q->xy, q->xz}, {q->xy, q->yy, q->yz}, {q->xz, q->yz, q->zz}};
        for (int c = 0; c < 3; c++)
            add_constraint(all, rows[c], -gradient[c], smallest);
        return;
    }
    int directions = 3 - all->count;
    if (directions == 2)
    {
        const double *a = all->row[0];
        int least = fabs(a[0]) < fabs(a[1]) ? 0 : 1;
        least = fabs(a[2]) < fabs(a[least]) ? 2 : least;
        double axis[3] = {0};
        axis[least] = 1;
        vector3_cross(a, axis, direction[0]);
        vector3_cross(a, direction[0], direction[1]);
    }
    else if (directions == 1)
        vector3_cross(all->row[0], all->row[1], direction[0]);
    for (int k = 0; k < directions; k++)
    {
        quadric_multiply(q, direction[k], row);
        add_constraint(all, row, -vector3_dot(direction[k], gradient), smallest);
    }
}

/// Solve three equations by Cramer's rule.
static void solve(const constraints *all, double *d)
{
    double product[3][3];
    for (int k = 0; k < 3; k++)
        vector3_cross(all->row[(k + 1) % 3], all->row[(k + 2) % 3], product[k]);
    double determinant = vector3_dot(all->row[0], product[0]);
    for (int c = 0; c < 3; c++)
        d[c] = (all->right[0] * product[0][c] + all->right[1] * product[1][c] + all->right[2] * product[2][c]) / determinant;
}

/// |along|^2 I - along along^T, the matrix of the squared length of along x d (1998, section 4.3), and along x normal.
static void add_edge_area(quadric *sum, const double *along, const double *normal, double weight)
{
    double square = vector3_dot(along, along), gradient[3];
    vector3_cross(along, normal, gradient);
    sum->xx += weight * (square - along[0] * along[0]);
    sum->yy += weight * (square - along[1] * along[1]);
    sum->zz += weight * (square - along[2] * along[2]);
    sum->xy -= weight * along[0] * along[1];
    sum->xz -= weight * along[0] * along[2];
    sum->yz -= weight * along[1] * along[2];
    sum->x += weight * gradient[0];
    sum->y += weight * gradient[1];
    sum->z += weight * gradient[2];
}

/// The vertex next to `vertex` on its curve, on the other side than `other`; BAT_MESH_NONE at the end of a curve.
static uint32_t next_on_curve(const collapse_mesh *mesh, uint32_t vertex, uint32_t other)
{
    uint32_t first = mesh->first[vertex], h = first, found = BAT_MESH_NONE;
    do
    {
        uint32_t previous = bat_mesh_previous(h);
        const uint32_t edge[2] = {h, previous}, end[2] = {mesh->corner[bat_mesh_next(h)], mesh->corner[previous]};
        for (int k = 0; k < 2; k++)
            if (end[k] != other && end[k] != found && collapse_edge_is_curve(mesh, mesh->edge[edge[k]]))
            {
                if (found != BAT_MESH_NONE)
                    return BAT_MESH_NONE;
                found = end[k];
            }
        h = mesh->twin[previous];
    } while (h != BAT_MESH_NONE && h != first);
    return found;
}

/// The curve's edges around an edge of it.
static curve_chain chain_of(const collapse_mesh *mesh, const error_vertex *vertices, uint32_t edge, const double *middle)
{
    curve_chain chain;
    uint32_t h = mesh->half_edge[edge], i = mesh->corner[h], j = mesh->corner[bat_mesh_next(h)];
    const uint32_t vertex[4] = {next_on_curve(mesh, i, j), i, j, next_on_curve(mesh, j, i)};
    int count = 0;
    for (int k = 0; k < 4; k++)
        if (vertex[k] != BAT_MESH_NONE)
            vector3_subtract(vertices[vertex[k]].position, middle, chain.point[count++]);
    chain.edges = count - 1;
    return chain;
}

/// The sum of squared areas between the chain's edges and a point, by twice the sum's matrix about the middle, and the
/// preservation of their sum. `constant` receives its value at the middle.
static quadric chain_areas(const curve_chain *chain, constraints *all)
{
    quadric sum = {0}, whole = {0};
    double total[3] = {0}, total_normal[3] = {0}, along[3], normal[3];
    for (int k = 0; k < chain->edges; k++)
    {
        vector3_subtract(chain->point[k + 1], chain->point[k], along);
        vector3_cross(chain->point[k + 1], chain->point[k], normal);
        add_edge_area(&sum, along, normal, 1);
        sum.constant += vector3_dot(normal, normal);
        for (int c = 0; c < 3; c++)
        {
            total[c] += along[c];
            total_normal[c] += normal[c];
        }
    }
    add_edge_area(&whole, total, total_normal, 1);
    add_minimum(all, &whole);
    return sum;
}

/// The sums of both ends, with the faces that they share counted once; of the normals in `whole`.
static quadric faces_of_edge(const collapse_mesh *mesh, const error_vertex *vertices, uint32_t edge, const double *half,
                             double *whole)
{
    uint32_t h = mesh->half_edge[edge];
    const error_vertex *a = &vertices[mesh->corner[h]], *b = &vertices[mesh->corner[bat_mesh_next(h)]];
    double of_a[3], of_b[3], along[3], aside[3], normal[3];
    quadric_multiply(&a->planes, half, of_a);
    quadric_multiply(&b->planes, half, of_b);
    quadric sum = quadric_sum(&a->planes, &b->planes);
    sum.x = of_a[0] - of_b[0];
    sum.y = of_a[1] - of_b[1];
    sum.z = of_a[2] - of_b[2];
    sum.constant = vector3_dot(half, of_a) + vector3_dot(half, of_b);
    const double normals[3] = {a->planes.x + b->planes.x, a->planes.y + b->planes.y, a->planes.z + b->planes.z};
    memcpy(whole, normals, sizeof normals);
    vector3_subtract(b->position, a->position, along);
    for (uint32_t side = h; side != BAT_MESH_NONE; side = side == h ? mesh->twin[h] : BAT_MESH_NONE)
    {
        vector3_subtract(vertices[mesh->corner[bat_mesh_previous(side)]].position, a->position, aside);
        vector3_cross(along, aside, normal);
        quadric_add_plane(&sum, normal, -1);
        vector_add(3, side == h ? -1 : 1, normal, whole);
    }
    return sum;
}

/// The minimum in the plane normal . d = right, without square roots. False where it is ill determined.
static bool minimize_in_plane(const quadric *q, const double *normal, double right, double *d)
{
    const double square = vector3_dot(normal, normal), gradient[3] = {q->x, q->y, q->z};
    double u[3], v[3], qu[3], qv[3];
    const double axis[3] = {fabs(normal[0]) < fabs(normal[1]), !(fabs(normal[0]) < fabs(normal[1])), 0};
    vector3_cross(normal, axis, u);
    vector3_cross(normal, u, v);
    quadric_multiply(q, u, qu);
    quadric_multiply(q, v, qv);
    double uu = vector3_dot(u, qu), uv = vector3_dot(u, qv), vv = vector3_dot(v, qv), determinant = uu * vv - uv * uv,
           trace = uu + vv / square;
    if (!(determinant > SQUARED_SINE * square * trace * trace && trace > GRADIENT_ROUNDING * quadric_weight(q) * square))
        return false;
    double level = right / square, of_u = vector3_dot(u, gradient) + level * vector3_dot(normal, qu),
           of_v = vector3_dot(v, gradient) + level * vector3_dot(normal, qv);
    double s = (uv * of_v - vv * of_u) / determinant, t = (uv * of_u - uu * of_v) / determinant;
    for (int c = 0; c < 3; c++)
        d[c] = level * normal[c] + s * u[c] + t * v[c];
    return true;
}

/// The squared distances from the vertices around an edge.
static quadric neighbours_of_edge(const collapse_mesh *mesh, const error_vertex *vertices, uint32_t edge,
                                  const double *middle)
{
    uint32_t h = mesh->half_edge[edge];
    const uint32_t ends[2] = {mesh->corner[h], mesh->corner[bat_mesh_next(h)]};
    quadric sum = {0};
    for (int end = 0; end < 2; end++)
    {
        uint32_t first = mesh->first[ends[end]], at = first;
        do
        {
            uint32_t neighbour = mesh->corner[bat_mesh_next(at)];
            if (neighbour != ends[1 - end])
            {
                double to[3];
                vector3_subtract(vertices[neighbour].position, middle, to);
                sum.xx++;
                sum.yy++;
                sum.zz++;
                sum.x -= to[0];
                sum.y -= to[1];
                sum.z -= to[2];
            }
            at = mesh->twin[bat_mesh_previous(at)];
        } while (at != BAT_MESH_NONE && at != first);
    }
    return sum;
}

/// The position middle + offset; an end of the edge where it is that but for rounding errors, so that corners stay exactly.
static void place_at(const error_vertex *a, const error_vertex *b, const double *half, const double *middle,
                     const double *offset, double *position)
{
    double from_a = 0, from_b = 0, square = SAME * SAME * vector3_dot(half, half);
    for (int c = 0; c < 3; c++)
    {
        from_a += (offset[c] + half[c]) * (offset[c] + half[c]);
        from_b += (offset[c] - half[c]) * (offset[c] - half[c]);
        position[c] = middle[c] + offset[c];
    }
    if (from_a <= square || from_b <= square)
        memcpy(position, from_a <= from_b ? a->position : b->position, sizeof a->position);
}

error_placement memoryless_place(const collapse_mesh *mesh, const error_vertex *vertices, const attributes *fields,
                                 uint32_t edge, uint32_t kept, bool quick)
{
    uint32_t h = mesh->half_edge[edge], i = mesh->corner[h];
    const error_vertex *a = &vertices[i], *b = &vertices[mesh->corner[bat_mesh_next(h)]];
    double half[3], middle[3], offset[3] = {0}, whole[3];
    for (int c = 0; c < 3; c++)
    {
        half[c] = (b->position[c] - a->position[c]) / 2;
        middle[c] = a->position[c] + half[c];
    }
    constraints all;
    all.count = 0;
    double square = 4 * vector3_dot(half, half);
    quadric error = faces_of_edge(mesh, vertices, edge, half, whole);
    double weight = quadric_weight(&error);
    if (collapse_edge_is_curve(mesh, edge))
    {
        curve_chain chain = chain_of(mesh, vertices, edge, middle);
        quadric areas = chain_areas(&chain, &all);
        double share = 9 * BOUNDARY_WEIGHT / VOLUME_WEIGHT * square;
        double *to = &error.xx, *from = &areas.xx;
        vector_add(sizeof error / sizeof *to, share, from, to);
    }
    error_placement placed;
    if (kept == BAT_MESH_NONE)
    {
        const double of_a[3] = {a->planes.x, a->planes.y, a->planes.z}, of_b[3] = {b->planes.x, b->planes.y, b->planes.z};
        double volume = vector3_dot(of_b, half) - vector3_dot(of_a, half);
        bool solved = quick && all.count == 0 && minimize_in_plane(&error, whole, volume, offset);
        if (!solved)
        {
            add_constraint(&all, whole, volume, GRADIENT_ROUNDING * sqrt(fmax(weight, 0)));
            add_minimum(&all, &error);
            quadric neighbours = all.count < 3 ? neighbours_of_edge(mesh, vertices, edge, middle) : error;
            add_minimum(&all, &neighbours);
            solved = all.count == 3;
            if (solved)
                solve(&all, offset);
        }
        if (!solved || !(vector3_dot(offset, offset) <= MAX_MOVE * MAX_MOVE * square))
            memset(offset, 0, sizeof offset);
        place_at(a, b, half, middle, offset, placed.position);
    }
    else
    {
        for (int c = 0; c < 3; c++)
            offset[c] = kept == i ? -half[c] : half[c];
        memcpy(placed.position, vertices[kept].position, sizeof placed.position);
    }
    placed.error = fmax(quadric_error(&error, offset), 0) + LENGTH_SHARE * weight * square;
    quadric of_values;
    double of_weights;
    if (attributes_error(fields, mesh, edge, half, kept, &of_values, &of_weights) && of_weights > 0)
        placed.error += fmax(quadric_error(&of_values, offset), 0) * weight / of_weights;
    return placed;
}
