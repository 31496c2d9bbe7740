#include "research/data/coarse_mesh.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/mesh_decimate.h"
#include "linalg/vector.h"
#include "research/shapes/edit_mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Quadrics: x^T A x + 2 b.x + c, of squared distances from planes

typedef struct quadric
{
    double a[6], b[3], c;
} quadric;

static void quadric_add_plane(quadric *q, double weight, const double normal[3], const double point[3])
{
    double offset = -vector3_dot(normal, point);
    static const int first[6] = {0, 0, 0, 1, 1, 2}, second[6] = {0, 1, 2, 1, 2, 2};
    for (int i = 0; i < 6; i++)
        q->a[i] += weight * normal[first[i]] * normal[second[i]];
    for (int i = 0; i < 3; i++)
        q->b[i] += weight * offset * normal[i];
    q->c += weight * offset * offset;
}

static void quadric_add(quadric *q, const quadric *other)
{
    for (int i = 0; i < 6; i++)
        q->a[i] += other->a[i];
    for (int i = 0; i < 3; i++)
        q->b[i] += other->b[i];
    q->c += other->c;
}

static double quadric_at(const quadric *q, const double x[3])
{
    const double *a = q->a;
    return a[0] * x[0] * x[0] + a[3] * x[1] * x[1] + a[5] * x[2] * x[2] +
           2 * (a[1] * x[0] * x[1] + a[2] * x[0] * x[2] + a[4] * x[1] * x[2]) + 2 * vector3_dot(q->b, x) + q->c;
}

// Greedy collapses

/// A collapse of a into b.
typedef struct candidate
{
    double cost;
    uint32_t a, b;
    uint32_t version[2];
    double point[3];
} candidate;

typedef struct collapser
{
    edit_mesh edit;
    coarse_kind kind;
    quadric *quadrics; ///< of each vertex; COARSE_KEPT only
    uint32_t *version; ///< of each vertex
    candidate *heap;
    size_t count, room;
    double noise; ///< costs are multiplied by up to e^noise
    bat_random *random;
    bool failed;
} collapser;

static void heap_push(collapser *c, candidate one)
{
    if (c->count == c->room)
    {
        size_t room = 2 * c->room + 1024;
        candidate *grown = realloc(c->heap, room * sizeof *grown);
        c->failed = c->failed || grown == NULL;
        if (grown == NULL)
            return;
        c->heap = grown;
        c->room = room;
    }
    size_t i = c->count++;
    for (; i > 0 && c->heap[(i - 1) / 2].cost > one.cost; i = (i - 1) / 2)
        c->heap[i] = c->heap[(i - 1) / 2];
    c->heap[i] = one;
}

static candidate heap_pop(collapser *c)
{
    candidate top = c->heap[0], last = c->heap[--c->count];
    size_t i = 0;
    for (size_t child = 1; child < c->count; child = 2 * i + 1)
    {
        if (child + 1 < c->count && c->heap[child + 1].cost < c->heap[child].cost)
            child++;
        if (c->heap[child].cost >= last.cost)
            break;
        c->heap[i] = c->heap[child];
        i = child;
    }
    c->heap[i] = last;
    return top;
}

/// Solve the 4 x 4 system m x = r; false where it is singular.
static bool solve4(double m[4][5])
{
    for (int k = 0; k < 4; k++)
    {
        int pivot = k;
        for (int i = k + 1; i < 4; i++)
            pivot = fabs(m[i][k]) > fabs(m[pivot][k]) ? i : pivot;
        if (fabs(m[pivot][k]) < 1e-300)
            return false;
        for (int j = 0; j < 5; j++)
        {
            double swap = m[k][j];
            m[k][j] = m[pivot][j];
            m[pivot][j] = swap;
        }
        for (int i = 0; i < 4; i++)
        {
            double factor = i != k ? m[i][k] / m[k][k] : 0;
            for (int j = k; j < 5 && factor != 0; j++)
                m[i][j] -= factor * m[k][j];
        }
    }
    for (int k = 0; k < 4; k++)
        m[k][4] /= m[k][k];
    return true;
}

/// Place the vertex of an edge so that the volume stays and the squared volumes between the old faces and the new vertex are
/// least. Returns that least value.
static double place_memoryless(const edit_mesh *edit, uint32_t h, double point[3])
{
    /// Weight of the distance from the middle, which decides where the surface is flat.
    static const double MIDDLE = 1e-6;
    quadric sum = {.c = 0};
    double normals[3] = {0}, volume = 0, squares = 0, middle[3];
    const double *ends[2] = {edit->positions[edit_from(edit, h)], edit->positions[edit_to(edit, h)]};
    for (int i = 0; i < 3; i++)
        middle[i] = 0.5 * (ends[0][i] + ends[1][i]);
    for (int end = 0; end < 2; end++)
    {
        uint32_t start = end == 0 ? h : edit->twin[h], g = start;
        do
        {
            // The faces of the edge itself are counted once, at its begin.
            bool both = g == start || g == bat_mesh_next(edit->twin[start]);
            if (!(end == 1 && both))
            {
                double normal[3], from[3];
                edit_normal(edit, g / 3, normal);
                // Relative to the middle, so that nothing cancels.
                vector3_subtract(edit->positions[edit_from(edit, g)], middle, from);
                quadric_add_plane(&sum, 1, normal, from);
                for (int i = 0; i < 3; i++)
                    normals[i] += normal[i];
                volume += vector3_dot(normal, from);
                squares += vector3_dot(normal, normal);
            }
            g = edit_turn(edit, g);
        } while (g != start);
    }
    double add = MIDDLE * squares;
    double m[4][5] = {{sum.a[0] + add, sum.a[1], sum.a[2], normals[0], -sum.b[0]},
                      {sum.a[1], sum.a[3] + add, sum.a[4], normals[1], -sum.b[1]},
                      {sum.a[2], sum.a[4], sum.a[5] + add, normals[2], -sum.b[2]},
                      {normals[0], normals[1], normals[2], 0, volume}};
    double x[3] = {0};
    if (solve4(m))
        for (int i = 0; i < 3; i++)
            x[i] = m[i][4];
    double length = vector3_distance(ends[0], ends[1]);
    if (!(vector3_dot(x, x) <= 4 * length * length))
        memset(x, 0, sizeof x);
    for (int i = 0; i < 3; i++)
        point[i] = middle[i] + x[i];
    return fabs(quadric_at(&sum, x)) + 1e-9 * squares * length * length;
}

/// Push the collapse of an edge.
static void consider(collapser *c, uint32_t h)
{
    edit_mesh *edit = &c->edit;
    uint32_t a = edit_from(edit, h), b = edit_to(edit, h);
    candidate one = {.a = a, .b = b, .version = {c->version[a], c->version[b]}};
    const double *p = edit->positions[a], *q = edit->positions[b];
    if (c->kind == COARSE_KEPT)
    {
        quadric sum = c->quadrics[a];
        quadric_add(&sum, &c->quadrics[b]);
        double at_a = fabs(quadric_at(&sum, p)), at_b = fabs(quadric_at(&sum, q));
        one.cost = fmin(at_a, at_b);
        memcpy(one.point, at_a < at_b ? p : q, sizeof one.point);
    }
    else if (c->kind == COARSE_MEMORYLESS)
        one.cost = place_memoryless(edit, h, one.point);
    else
    {
        one.cost = vector3_distance(p, q);
        for (int i = 0; i < 3; i++)
            one.point[i] = 0.5 * (p[i] + q[i]);
    }
    one.cost = (one.cost + 1e-18) * exp(c->noise * bat_random_uniform(c->random));
    heap_push(c, one);
}

/// Push the collapses of the edges around a vertex whose costs changed.
static void consider_around(collapser *c, uint32_t vertex)
{
    c->version[vertex]++;
    uint32_t first = c->edit.first[vertex], h = first;
    do
    {
        consider(c, h);
        h = edit_turn(&c->edit, h);
    } while (h != first);
}

/// The half-edge of a candidate that is still current, or BAT_MESH_NONE.
static uint32_t find_edge(const collapser *c, const candidate *one)
{
    const edit_mesh *edit = &c->edit;
    if (edit->first[one->a] == BAT_MESH_NONE || edit->first[one->b] == BAT_MESH_NONE ||
        c->version[one->a] != one->version[0] || c->version[one->b] != one->version[1])
        return BAT_MESH_NONE;
    uint32_t first = edit->first[one->a], h = first;
    do
    {
        if (edit_to(edit, h) == one->b)
            return h;
        h = edit_turn(edit, h);
    } while (h != first);
    return BAT_MESH_NONE;
}

static void begin_quadrics(collapser *c)
{
    for (size_t f = 0; f < c->edit.face_count; f++)
    {
        double normal[3];
        edit_normal(&c->edit, f, normal);
        double twice = sqrt(vector3_dot(normal, normal));
        if (!(twice > 0))
            continue;
        for (int i = 0; i < 3; i++)
            normal[i] /= twice;
        for (int i = 0; i < 3; i++)
            quadric_add_plane(&c->quadrics[c->edit.faces[f][i]], 0.5 * twice, normal,
                              c->edit.positions[c->edit.faces[f][0]]);
    }
}

static bat_status collapse_all(collapser *c, size_t vertices, bat_error *error)
{
    enum
    {
        FRESH = 6
    };
    edit_mesh *edit = &c->edit;
    for (uint32_t h = 0; h < 3 * edit->face_count; h++)
        if (edit->twin[h] > h)
            consider(c, h);
    while (edit->vertex_count - edit->dead_vertices > vertices && c->count > 0 && !c->failed)
    {
        candidate one = heap_pop(c);
        uint32_t h = find_edge(c, &one);
        if (h == BAT_MESH_NONE || !edit_collapse(edit, h, one.point, INFINITY))
            continue;
        if (c->kind == COARSE_KEPT)
            quadric_add(&c->quadrics[one.b], &c->quadrics[one.a]);
        consider_around(c, one.b);
        // Without memory, the costs around the neighbours change, too. On fine meshes they change little.
        if (c->kind != COARSE_MEMORYLESS || edit->vertex_count - edit->dead_vertices > FRESH * vertices)
            continue;
        uint32_t first = edit->first[one.b], around = first;
        do
        {
            consider_around(c, edit_to(edit, around));
            around = edit_turn(edit, around);
        } while (around != first);
    }
    return c->failed ? error_memory(error, c->room * sizeof *c->heap) : BAT_OK;
}

static bat_status collapse_mesh_to(collapser *c, size_t vertices, bat_error *error)
{
    size_t count = c->edit.vertex_count;
    c->version = calloc(count, sizeof *c->version);
    c->quadrics = calloc(count, sizeof *c->quadrics);
    bat_status status =
        c->version == NULL || c->quadrics == NULL ? error_memory(error, count * sizeof *c->quadrics) : BAT_OK;
    if (status == BAT_OK && c->kind == COARSE_KEPT)
        begin_quadrics(c);
    if (status == BAT_OK)
        status = collapse_all(c, vertices, error);
    free(c->version);
    free(c->quadrics);
    free(c->heap);
    return status;
}

// Isotropic remeshing

static double edge_length(const edit_mesh *edit, uint32_t h)
{
    return vector3_distance(edit->positions[edit_from(edit, h)], edit->positions[edit_to(edit, h)]);
}

static void flip_by_valence(edit_mesh *edit)
{
    for (uint32_t h = 0; h < 3 * edit->face_count; h++)
    {
        uint32_t t = edit->twin[h];
        if (t < h)
            continue;
        uint32_t at[4] = {edit_from(edit, h), edit_from(edit, t), edit_from(edit, bat_mesh_previous(h)),
                          edit_from(edit, bat_mesh_previous(t))};
        int gain = 0;
        bool possible = true;
        for (int i = 0; i < 4; i++)
        {
            int valence = (int)edit_valence(edit, at[i]), change = i < 2 ? -1 : 1;
            gain += abs(valence - 6) - abs(valence + change - 6);
            possible = possible && valence + change > 3;
        }
        if (gain > 0 && possible)
            edit_flip(edit, h);
    }
}

/// Move every vertex along the surface toward the mean of its neighbours, then to the closest point of the shape.
static void relax(edit_mesh *edit, const closest_tree *tree)
{
    uint32_t place = 0;
    for (uint32_t v = 0; v < edit->vertex_count; v++)
    {
        double mean[3] = {0}, normal[3] = {0}, towards[3], point[3];
        size_t valence = 0;
        uint32_t first = edit->first[v], h = first;
        do
        {
            double face[3];
            edit_normal(edit, h / 3, face);
            for (int c = 0; c < 3; c++)
            {
                mean[c] += edit->positions[edit_to(edit, h)][c];
                normal[c] += face[c];
            }
            valence++;
            h = edit_turn(edit, h);
        } while (h != first);
        for (int c = 0; c < 3; c++)
            towards[c] = mean[c] / (double)valence - edit->positions[v][c];
        double square = vector3_dot(normal, normal), out = square > 0 ? vector3_dot(towards, normal) / square : 0;
        for (int c = 0; c < 3; c++)
            point[c] = edit->positions[v][c] + towards[c] - out * normal[c];
        (void)closest_find(tree, point, &place);
        closest_hit hit = closest_point_at(tree, point, place);
        edit_move(edit, v, hit.point);
    }
}

static bat_status remesh(edit_mesh *edit, const closest_tree *tree, double edge, bat_error *error)
{
    enum
    {
        ROUNDS = 6
    };
    bat_status status = BAT_OK;
    for (int round = 0; round < ROUNDS && status == BAT_OK; round++)
    {
        size_t present = 3 * edit->face_count;
        for (uint32_t h = 0; h < present && status == BAT_OK; h++)
            if (edit->twin[h] > h && edge_length(edit, h) > 4.0 / 3 * edge && !edit_split(edit, h))
                status = error_memory(error, 6 * edit->face_room * sizeof *edit->faces);
        for (uint32_t h = 0; h < 3 * edit->face_count && status == BAT_OK; h++)
        {
            if (edit->faces[h / 3][0] == BAT_MESH_NONE || edge_length(edit, h) >= 4.0 / 5 * edge)
                continue;
            double point[3];
            for (int c = 0; c < 3; c++)
                point[c] = 0.5 * (edit->positions[edit_from(edit, h)][c] + edit->positions[edit_to(edit, h)][c]);
            edit_collapse(edit, h, point, 4.0 / 3 * edge);
        }
        if (status == BAT_OK)
            status = edit_mesh_compact(edit, error);
        if (status != BAT_OK)
            break;
        flip_by_valence(edit);
        relax(edit, tree);
    }
    return status;
}

static double area_of(const bat_mesh *mesh)
{
    double area = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *corner = mesh->faces + 3 * f;
        double normal[3];
        vector3_triangle(mesh->positions + 3 * corner[0], mesh->positions + 3 * corner[1], mesh->positions + 3 * corner[2],
                         normal);
        area += 0.5 * sqrt(vector3_dot(normal, normal));
    }
    return area;
}

// All

static bat_status copy_mesh(const edit_mesh *edit, bat_mesh *mesh, bat_error *error)
{
    bat_mesh made = {.vertex_count = edit->vertex_count, .face_count = edit->face_count};
    made.positions = memory_array(made.vertex_count, 3 * sizeof *made.positions);
    made.faces = memory_array(made.face_count, 3 * sizeof *made.faces);
    if (made.positions == NULL || made.faces == NULL)
    {
        bat_mesh_free(&made);
        return error_memory(error, edit->face_count * 3 * sizeof *made.faces);
    }
    memcpy(made.positions, edit->positions, made.vertex_count * 3 * sizeof *made.positions);
    memcpy(made.faces, edit->faces, made.face_count * 3 * sizeof *made.faces);
    *mesh = made;
    return BAT_OK;
}

static bat_status decimate(const bat_mesh *shape, size_t vertices, bat_random *random, bat_mesh *coarse, bat_error *error)
{
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    options.method = BAT_MESH_DECIMATE_METHOD_QUADRIC;
    options.attributes = 0;
    options.vertices = vertices < shape->vertex_count ? vertices : shape->vertex_count;
    bool drawn = bat_random_uniform(random) < 0.3;
    options.candidates = drawn ? 20 + (size_t)(80 * bat_random_uniform(random)) : 0;
    options.seed = bat_random_bits(random);
    options.min_normal = bat_random_uniform(random) < 0.5 ? 0.2 : -0.2;
    options.min_quality = 0.2 * bat_random_uniform(random);
    return bat_mesh_decimate(shape, &options, coarse, NULL, error);
}

bat_status coarse_mesh_make(const bat_mesh *shape, const closest_tree *tree, coarse_kind kind, size_t vertices,
                            bat_random *random, bat_mesh *coarse, bat_error *error)
{
    if (kind == COARSE_QUADRIC)
        return decimate(shape, vertices, random, coarse, error);
    uint16_t *marks = calloc(shape->face_count, sizeof *marks);
    if (marks == NULL)
        return error_memory(error, shape->face_count * sizeof *marks);
    collapser c = {.kind = kind, .random = random};
    c.noise = bat_random_uniform(random) < 0.6 ? 0 : bat_random_uniform(random);
    bat_status status = edit_mesh_begin(shape, marks, &c.edit, error);
    free(marks);
    if (status != BAT_OK)
        return status;
    // A mesh of n vertices has about 3 n edges; an equilateral triangle of edge 1 has the area sqrt(3) / 4.
    if (kind == COARSE_REMESHED)
        status = remesh(&c.edit, tree, sqrt(area_of(shape) / ((double)vertices * 0.8660254037844386)), error);
    else
        status = collapse_mesh_to(&c, vertices, error);
    if (status == BAT_OK)
        status = edit_mesh_compact(&c.edit, error);
    if (status == BAT_OK)
        status = copy_mesh(&c.edit, coarse, error);
    edit_mesh_free(&c.edit);
    return status;
}
