#include "mesh/refine/brake.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/mesh_refine.h"

#include <float.h>
#include <string.h>

/// Vertices within this share of the diagonal are on a plane: coordinates of six digits, and of single precision.
#define FLATNESS 2e-6
/// Neighbours across a smooth edge are facets of one surface where neither is more than this times as high as the other.
#define COMPARABLE 4.0
/// The reach over h tan(angle / 2). The sagitta of a sphere through equilateral triangles of height h is half of that: the
/// value of solids. A decimated mesh has angles far below those of its shape: smaller values harm it.
static const double SLACK = 4, SLACK_OF_SOLIDS = 0.5;

/// A face is thin where it is lower than this share of an edge. Cages and decimated meshes have few such faces.
#define THIN 0.2

#define CORNER_OF_SOLID 3 ///< the edges between planes that meet at a typical corner

/// Sharp edges of a solid have greater angles than one of these. Few edges have less, but more than a part of it.
static const double SHARP_FROM[] = {1, 1.5, 2, 2.5}, FAR_BELOW = 0.4, FEW = 0.01; // in units of BRAKE_SHARP
#define SHARP_LIMITS (sizeof SHARP_FROM / sizeof *SHARP_FROM)

/// The mean quality of a remesher's faces is from EVEN_FROM to EVEN_TO or more, of decimated ones seldom above EVEN_FROM.
/// There the butterfly has EVEN_SHARE. Charts that were decimated one by one have this share of boundary edges.
static const double EVEN_FROM = 0.8, EVEN_TO = 0.85, EVEN_SHARE = 0.5, CHARTS_FROM = 0.1;

/// The kinds of connected coplanar faces.
typedef enum flat_kind
{
    NOT_FLAT,
    FLAT_OF_SOLID, ///< faces that a cage could have as well
    FLAT           ///< with thin faces, or beside much lower ones
} flat_kind;

/// The shape of a coarse mesh.
typedef struct mesh_shape
{
    const mesh_level *level;
    const double *positions;
    double tolerance;       ///< of coplanar vertices
    double (*normal)[3];    ///< faces: unit, or 0
    double *height;         ///< faces: over the longest edge
    double *angle;          ///< edges: between the normals of both faces; 0 where they are coplanar and at boundaries
    uint32_t *region;       ///< faces: the number of their set of coplanar faces
    uint32_t *stack;        ///< workspace, one for each face
    unsigned char *flat;    ///< regions: a flat_kind
    unsigned char *on_flat; ///< vertices: the greatest flat_kind of the faces around
    uint32_t *bends;        ///< vertices: edges of an angle above 0
    double quality;         ///< sum over faces of 4 sqrt(3) area over the squared sides, 1 for equal sides
    bool creased;           ///< edges of more than 75 degrees between even faces are creases
    size_t pieces;          ///< connected ones
    uint32_t *solid;        ///< faces: 1 on a connected piece that is a solid, else 0
    memory_pool pool;       ///< of all arrays
} mesh_shape;

static const double *place(const mesh_shape *shape, uint32_t vertex)
{
    return shape->positions + 3 * (size_t)vertex;
}

/// The height of a half-edge's face over it; 0 for an edge of no length.
static double height_over(const mesh_shape *shape, uint32_t half_edge)
{
    const uint32_t *faces = shape->level->faces;
    double along[3], aside[3], product[3];
    vector3_subtract(place(shape, mesh_end(faces, half_edge)), place(shape, faces[half_edge]), along);
    vector3_subtract(place(shape, mesh_opposite(faces, half_edge)), place(shape, faces[half_edge]), aside);
    vector3_cross(along, aside, product);
    double length = vector3_length(along);
    return length > 0 ? vector3_length(product) / length : 0;
}

static void measure_face(mesh_shape *shape, uint32_t f)
{
    const uint32_t *corner = shape->level->faces + 3 * (size_t)f;
    vector3_triangle(place(shape, corner[0]), place(shape, corner[1]), place(shape, corner[2]), shape->normal[f]);
    double twice = vector3_length(shape->normal[f]), sum = 0; // twice the area; of inverse squared heights
    (void)vector3_normalize(shape->normal[f]);
    shape->height[f] = INFINITY;
    for (uint32_t h = 3 * f; h < 3 * f + 3; h++)
    {
        double height = height_over(shape, h);
        shape->height[f] = fmin(shape->height[f], height);
        sum += 1 / (height * height);
    }
    shape->quality += shape->height[f] > 0 ? 2 * sqrt(3) / (twice * sum) : 0;
}

/// Whether an inner edge's faces are in a plane: the lower one's vertex is on the other's. Very low faces have no direction.
static bool is_coplanar(const mesh_shape *shape, uint32_t half_edge)
{
    uint32_t twin = shape->level->links->twin[half_edge], f = half_edge / 3, g = twin / 3;
    bool first = shape->height[f] >= shape->height[g];
    const double *normal = shape->normal[first ? f : g];
    double aside[3];
    vector3_subtract(place(shape, mesh_opposite(shape->level->faces, first ? twin : half_edge)),
                     place(shape, shape->level->faces[half_edge]), aside);
    return fabs(vector3_dot(normal, aside)) <= shape->tolerance &&
           (vector3_dot(shape->normal[f], shape->normal[g]) > 0 ||
            fmin(shape->height[f], shape->height[g]) <= shape->tolerance);
}

static void measure_edges(mesh_shape *shape)
{
    const bat_mesh_connectivity *links = shape->level->links;
    for (uint32_t h = 0; h < 3 * links->face_count; h++)
    {
        uint32_t twin = links->twin[h];
        if (!mesh_owns(links->twin, h))
            continue;
        bool bent = twin != BAT_MESH_NONE && !is_coplanar(shape, h);
        shape->angle[links->edge[h]] = bent ? vector3_angle(shape->normal[h / 3], shape->normal[twin / 3]) : 0;
        shape->bends[shape->level->faces[h]] += bent;
        shape->bends[mesh_end(shape->level->faces, h)] += bent;
    }
}

/// Number the faces that are connected with a face by edges of at most an angle.
/// @param numbers of the faces; BAT_MESH_NONE: none yet
/// @return how many there are: the first numbers of `stack`
static size_t flood(mesh_shape *shape, uint32_t face, double max_angle, uint32_t number, uint32_t *numbers)
{
    const bat_mesh_connectivity *links = shape->level->links;
    size_t count = 1;
    shape->stack[0] = face;
    numbers[face] = number;
    for (size_t i = 0; i < count; i++)
        for (uint32_t h = 3 * shape->stack[i]; h < 3 * shape->stack[i] + 3; h++)
        {
            uint32_t twin = links->twin[h];
            if (twin == BAT_MESH_NONE || numbers[twin / 3] != BAT_MESH_NONE || shape->angle[links->edge[h]] > max_angle)
                continue;
            numbers[twin / 3] = number;
            shape->stack[count++] = twin / 3;
        }
    return count;
}

/// The kind of a set of connected coplanar faces. One triangle is not a flat face. Two are a facet of a smooth surface
/// beside neighbours of comparable height: across smooth edges or, where four facets or more meet at each corner as in a
/// grid, across all.
static flat_kind kind_of(const mesh_shape *shape, const uint32_t *faces, size_t count)
{
    const bat_mesh_connectivity *links = shape->level->links;
    const uint32_t *corners = shape->level->faces;
    bool smooth = false, uneven = false, thin = false, grid = count == 2;
    for (size_t c = 0; c < 3 * count && grid; c++)
        grid = shape->bends[corners[3 * faces[c / 3] + c % 3]] > CORNER_OF_SOLID;
    for (size_t c = 0; c < 3 * count; c++)
    {
        uint32_t h = 3 * faces[c / 3] + (uint32_t)(c % 3), twin = links->twin[h];
        double length = vector3_distance(place(shape, corners[h]), place(shape, mesh_end(corners, h)));
        thin = thin || shape->height[h / 3] < THIN * length;
        if (twin == BAT_MESH_NONE || shape->region[twin / 3] == shape->region[h / 3] ||
            (!grid && shape->angle[links->edge[h]] > BRAKE_SHARP))
            continue;
        double here = height_over(shape, h), there = height_over(shape, twin);
        uneven = uneven || fmax(here, there) > COMPARABLE * fmin(here, there);
        smooth = true;
    }
    if (count < 2 || (count == 2 && smooth && !uneven))
        return NOT_FLAT;
    return thin || uneven ? FLAT : FLAT_OF_SOLID;
}

static void find_flat_faces(mesh_shape *shape)
{
    const bat_mesh_connectivity *links = shape->level->links;
    uint32_t region = 0;
    memset(shape->region, 0xff, links->face_count * sizeof *shape->region);
    for (uint32_t f = 0; f < links->face_count; f++)
    {
        if (shape->region[f] != BAT_MESH_NONE)
            continue;
        size_t count = flood(shape, f, 0, region, shape->region);
        flat_kind kind = kind_of(shape, shape->stack, count);
        shape->flat[region++] = (unsigned char)kind;
        for (size_t i = 0; i < 3 * count; i++)
        {
            unsigned char *on = &shape->on_flat[shape->level->faces[3 * shape->stack[i / 3] + i % 3]];
            *on = *on > kind ? *on : (unsigned char)kind;
        }
    }
}

/// Whether a connected piece is a solid. It has sharp edges, and half of the vertices or more are on flat faces, with at
/// most three of them: a vertex of a cage that was drawn in quads has four. Or hardly an angle is between sharp and smooth,
/// and a quarter of the edges are smooth.
static bool is_solid(const mesh_shape *shape, const uint32_t *faces, size_t count)
{
    const bat_mesh_connectivity *links = shape->level->links;
    double vertices = 0, flat = 0, edges = 0, sharp[SHARP_LIMITS] = {0}, between[SHARP_LIMITS] = {0};
    for (size_t i = 0; i < 3 * count; i++)
    {
        uint32_t h = 3 * faces[i / 3] + (uint32_t)(i % 3), v = shape->level->faces[h];
        bool first = links->first[v] == h, owned = mesh_owns(links->twin, h);
        double angle = shape->angle[links->edge[h]] / BRAKE_SHARP;
        vertices += first;
        flat += first && shape->on_flat[v] && shape->bends[v] <= CORNER_OF_SOLID;
        edges += owned;
        for (size_t k = 0; k < SHARP_LIMITS; k++)
        {
            sharp[k] += owned && angle > SHARP_FROM[k];
            between[k] += owned && angle <= SHARP_FROM[k] && angle > FAR_BELOW * SHARP_FROM[k];
        }
    }
    bool solid = sharp[0] > 0 && 2 * flat >= vertices;
    for (size_t k = 0; k < SHARP_LIMITS && !solid; k++)
        solid = sharp[k] > 0 && between[k] <= FEW * sharp[k] && sharp[k] + between[k] <= 0.75 * edges;
    return solid;
}

static void find_solids(mesh_shape *shape)
{
    const bat_mesh_connectivity *links = shape->level->links;
    memset(shape->solid, 0xff, links->face_count * sizeof *shape->solid);
    for (uint32_t f = 0; f < links->face_count; f++)
    {
        if (shape->solid[f] != BAT_MESH_NONE)
            continue;
        size_t count = flood(shape, f, INFINITY, 0, shape->solid);
        bool solid = is_solid(shape, shape->stack, count);
        shape->pieces++;
        for (size_t i = 0; i < count; i++)
            shape->solid[shape->stack[i]] = solid;
    }
}

/// Release the pool of the result, also on failure.
/// @param found solids are found
static bat_status shape_make(const bat_mesh *mesh, const mesh_level *level, bool found, mesh_shape *shape, bat_error *error)
{
    size_t faces = level->links->face_count, edges = level->links->edge_count, vertices = level->links->vertex_count;
    double low[3], high[3];
    box_of_points(3, mesh->positions, mesh->vertex_count, low, high);
    *shape = (mesh_shape){.level = level, .positions = mesh->positions, .tolerance = FLATNESS * vector3_distance(low, high)};
    memory_pool *pool = &shape->pool;
    shape->normal = memory_pool_array(pool, faces, sizeof *shape->normal);
    shape->height = memory_pool_array(pool, faces, sizeof *shape->height);
    shape->angle = memory_pool_array(pool, edges, sizeof *shape->angle);
    shape->region = memory_pool_array(pool, faces, sizeof *shape->region);
    shape->stack = memory_pool_array(pool, faces, sizeof *shape->stack);
    shape->flat = memory_pool_array(pool, faces, sizeof *shape->flat);
    shape->on_flat = memory_pool_zeros(pool, vertices, sizeof *shape->on_flat);
    shape->bends = memory_pool_zeros(pool, vertices, sizeof *shape->bends);
    shape->solid = memory_pool_zeros(pool, faces, sizeof *shape->solid);
    bat_status status = memory_pool_check(pool, error);
    if (status != BAT_OK)
        return status;
    for (uint32_t f = 0; f < faces; f++)
        measure_face(shape, f);
    measure_edges(shape);
    find_flat_faces(shape);
    if (found)
        find_solids(shape);
    return BAT_OK;
}

// Reaches

static double *edge_reach(const mesh_brake *brake)
{
    return brake->reach + brake->links->vertex_count;
}

static double *face_reach(const mesh_brake *brake)
{
    return edge_reach(brake) + brake->links->edge_count;
}

/// The reach of a face: its height, or that of a lower neighbour, times `slack` and the tangent of half the angle between
/// them, but at most the height; the greatest over its edges.
static double reach_of_face(const mesh_shape *shape, uint32_t face, double slack)
{
    const bat_mesh_connectivity *links = shape->level->links;
    double reach = 0;
    for (uint32_t h = 3 * face; h < 3 * face + 3; h++)
    {
        if (links->twin[h] == BAT_MESH_NONE)
            continue;
        double slope = fmin(1, slack * tan(0.5 * fmin(3, shape->angle[links->edge[h]])));
        reach = fmax(reach, fmin(shape->height[face], shape->height[links->twin[h] / 3]) * slope);
    }
    return reach;
}

/// Set the reach of faces, and that of edges and vertices to the greatest of the faces around.
static void reach_by_angles(const mesh_shape *shape, mesh_brake *brake)
{
    const bat_mesh_connectivity *links = brake->links;
    size_t count = links->vertex_count + links->edge_count;
    memset(brake->reach, 0, count * sizeof *brake->reach);
    for (uint32_t f = 0; f < links->face_count; f++)
        face_reach(brake)[f] = reach_of_face(shape, f, shape->solid[f] ? SLACK_OF_SOLIDS : SLACK);
    for (uint32_t h = 0; h < 3 * links->face_count; h++)
    {
        double reach = face_reach(brake)[h / 3], *vertex = &brake->reach[shape->level->faces[h]];
        double *edge = &edge_reach(brake)[links->edge[h]];
        *vertex = fmax(*vertex, reach);
        *edge = fmax(*edge, reach);
    }
}

/// Hold what is between vertices that stay: edges and faces.
static void hold_between(mesh_brake *brake, const uint32_t *faces)
{
    const bat_mesh_connectivity *links = brake->links;
    for (uint32_t h = 0; h < 3 * links->face_count; h++)
    {
        const double *a = &brake->reach[faces[h]], *b = &brake->reach[mesh_end(faces, h)];
        if (*a == 0 && *b == 0 && links->twin[h] != BAT_MESH_NONE)
            edge_reach(brake)[links->edge[h]] = 0;
        if (*a == 0 && *b == 0 && brake->reach[mesh_opposite(faces, h)] == 0)
            face_reach(brake)[h / 3] = 0;
    }
}

/// Hold flat faces, of a solid boundaries and sharp edges, and creases between even faces.
static void hold_flat_and_sharp(const mesh_shape *shape, mesh_brake *brake)
{
    const bat_mesh_connectivity *links = brake->links;
    const uint32_t *faces = shape->level->faces;
    for (uint32_t h = 0; h < 3 * links->face_count; h++)
    {
        bool boundary = links->twin[h] == BAT_MESH_NONE;
        double angle = shape->angle[links->edge[h]] / BRAKE_SHARP;
        bool solid = shape->solid[h / 3], crease = shape->creased && angle > SHARP_FROM[SHARP_LIMITS - 1];
        bool sharp = crease || (solid && (boundary || angle > SHARP_FROM[0]));
        if (shape->flat[shape->region[h / 3]] >= (solid ? FLAT_OF_SOLID : FLAT))
            face_reach(brake)[h / 3] = edge_reach(brake)[links->edge[h]] = brake->reach[faces[h]] = 0;
        if (sharp)
            edge_reach(brake)[links->edge[h]] = brake->reach[faces[h]] = brake->reach[mesh_end(faces, h)] = 0;
    }
}

/// Hold the vertices of solids whose neighbours are held: apexes.
static void hold_apexes(const mesh_shape *shape, mesh_brake *brake)
{
    const bat_mesh_connectivity *links = brake->links;
    const uint32_t *faces = shape->level->faces;
    uint32_t *moves = shape->bends; // of neighbours, as seen from each face
    memset(moves, 0, links->vertex_count * sizeof *moves);
    for (uint32_t h = 0; h < 3 * links->face_count; h++)
        moves[faces[h]] += brake->reach[mesh_end(faces, h)] > 0 || brake->reach[mesh_opposite(faces, h)] > 0;
    for (uint32_t h = 0; h < 3 * links->face_count; h++)
        if (shape->solid[h / 3] && moves[faces[h]] == 0)
            brake->reach[faces[h]] = 0;
}

/// Free boundaries, which depend on their own vertices alone, and named creases and corners, which follow Loop's rules, but
/// beside flat faces with thin triangles.
static void free_named(const mesh_shape *shape, mesh_brake *brake)
{
    const bat_mesh_connectivity *links = brake->links;
    const mesh_level *level = shape->level;
    for (uint32_t h = 0; h < 3 * links->face_count; h++)
    {
        bool boundary = links->twin[h] == BAT_MESH_NONE && !shape->solid[h / 3];
        bool named = level->edge_sharpness != NULL && level->edge_sharpness[links->edge[h]] > 0;
        const uint32_t ends[] = {level->faces[h], mesh_end(level->faces, h)};
        bool flat = shape->on_flat[ends[0]] == FLAT && shape->on_flat[ends[1]] == FLAT;
        if (boundary || (named && !flat))
            edge_reach(brake)[links->edge[h]] = brake->reach[ends[0]] = brake->reach[ends[1]] =
                boundary ? INFINITY : DBL_MAX;
    }
}

/// Set the share of the butterfly scheme: all on meshes of marching cubes and on charts that were decimated one by one, less
/// between even faces; none at sharp edges but of marching cubes. Find creases: they are half of the sharp edges or more.
static bat_status find_shares(mesh_shape *shape, mesh_brake *brake, bat_error *error)
{
    const bat_mesh_connectivity *links = brake->links;
    bat_status status = lattice_find(brake->coarse, shape->tolerance / 2, &brake->marched, error);
    double even = fmin(1, (shape->quality / (double)links->face_count - EVEN_FROM) / (EVEN_TO - EVEN_FROM));
    bool charts = shape->pieces > 1 && (double)links->boundary_edge_count > CHARTS_FROM * (double)links->edge_count;
    double share = brake->marched || charts ? 1 : fmax(0, EVEN_SHARE * even), sharp = 0, sharpest = 0;
    brake->shared = share > 0;
    for (size_t v = 0; v < links->vertex_count; v++)
        brake->plain[4 * v + 3] = share;
    for (uint32_t h = 0; h < 3 * links->face_count && !brake->marched; h++)
    {
        double angle = shape->angle[links->edge[h]] / BRAKE_SHARP;
        sharpest += angle > SHARP_FROM[SHARP_LIMITS - 1];
        sharp += angle > SHARP_FROM[1];
        if (angle > SHARP_FROM[1])
            brake->plain[4 * (size_t)shape->level->faces[h] + 3] = 0;
    }
    shape->creased = even > 0 && sharpest > 0 && 2 * sharpest >= sharp;
    return status;
}

bat_status brake_make(const bat_mesh *coarse, const mesh_level *level, bool found, mesh_brake *brake, bat_error *error)
{
    const bat_mesh_connectivity *links = level->links;
    size_t vertices = links->vertex_count, count = vertices + links->edge_count + links->face_count;
    mesh_shape shape;
    *brake = (mesh_brake){.coarse = coarse,
                          .links = links,
                          .count = vertices,
                          .reach = memory_array(count, sizeof *brake->reach),
                          .plain = memory_array(vertices, 4 * sizeof *brake->plain),
                          .owner = memory_array(vertices, sizeof *brake->owner)};
    bat_status status = shape_make(coarse, level, found, &shape, error);
    if (status == BAT_OK && (brake->reach == NULL || brake->plain == NULL || brake->owner == NULL))
        status = error_memory(error, count * sizeof *brake->reach);
    for (uint32_t v = 0; v < vertices && status == BAT_OK; v++)
    {
        memcpy(brake->plain + 4 * (size_t)v, place(&shape, v), 3 * sizeof *brake->plain);
        brake->plain[4 * (size_t)v + 3] = 0;
        brake->owner[v] = v;
    }
    if (status == BAT_OK && found)
        status = find_shares(&shape, brake, error);
    if (status == BAT_OK)
    {
        reach_by_angles(&shape, brake);
        hold_flat_and_sharp(&shape, brake);
        hold_apexes(&shape, brake);
        free_named(&shape, brake);
        hold_between(brake, coarse->faces);
    }
    memory_pool_free(&shape.pool);
    if (status != BAT_OK)
        brake_free(brake);
    return status;
}

void brake_free(mesh_brake *brake)
{
    free(brake->reach);
    free(brake->plain);
    free(brake->owner);
    *brake = (mesh_brake){0};
}

// Levels

/// The owner of the vertex on the edge of a half-edge: the least that has both ends' owners.
static uint32_t owner_between(const mesh_brake *brake, uint32_t a, uint32_t b, uint32_t half_edge)
{
    uint32_t vertices = (uint32_t)brake->links->vertex_count, edges = (uint32_t)brake->links->edge_count;
    uint32_t low = a < b ? a : b, high = a < b ? b : a, face = half_edge / 3 >> 2 * brake->level;
    if (high < vertices)
        return vertices + brake->links->edge[half_edge];
    return high < vertices + edges && (low < vertices || low == high) ? high : vertices + edges + face;
}

bat_status brake_advance(mesh_brake *brake, const mesh_level *level, int threads, bat_error *error)
{
    const bat_mesh_connectivity *links = level->links;
    size_t count = links->vertex_count + links->edge_count;
    double *plain = memory_array(count, 4 * sizeof *plain);
    uint32_t *owner = memory_array(count, sizeof *owner);
    if (plain == NULL || owner == NULL)
    {
        free(plain);
        free(owner);
        return error_memory(error, count * BRAKE_VERTEX_BYTES);
    }
    const mesh_rows rows = {level, brake->plain, plain, 4};
    midpoint_rule(&rows, threads);
    memcpy(owner, brake->owner, links->vertex_count * sizeof *owner);
    for (uint32_t h = 0; h < 3 * links->face_count; h++)
        if (mesh_owns(links->twin, h))
            owner[links->vertex_count + links->edge[h]] =
                owner_between(brake, brake->owner[level->faces[h]], brake->owner[mesh_end(level->faces, h)], h);
    free(brake->plain);
    free(brake->owner);
    brake->plain = plain;
    brake->owner = owner;
    brake->count = count;
    brake->level++;
    return BAT_OK;
}

/// Shorten the moves of the current level's vertices to their reach.
static void bound_moves(const mesh_brake *brake, double *positions)
{
    for (size_t v = 0; v < brake->count; v++)
    {
        double reach = brake->reach[brake->owner[v]], *to = positions + 3 * v, move[3];
        const double *from = brake->plain + 4 * v;
        vector3_subtract(to, from, move);
        double length = vector3_length(move);
        if (reach == 0)
            memcpy(to, from, sizeof move);
        else if (length > reach)
            for (int c = 0; c < 3; c++)
                to[c] = from[c] + reach / length * move[c];
    }
}

/// Twice the area of a face times its normal.
static void area_vector(const uint32_t *corner, const double *positions, double area[3])
{
    const double *begin = positions + 3 * (size_t)corner[0];
    vector3_triangle(begin, positions + 3 * (size_t)corner[1], positions + 3 * (size_t)corner[2], area);
}

/// Let a coarse face stay, with its vertices but those of a free boundary.
/// @return whether it moved before
static bool hold_face(mesh_brake *brake, uint32_t face)
{
    bool moved = face_reach(brake)[face] > 0;
    face_reach(brake)[face] = 0;
    for (uint32_t h = 3 * face; h < 3 * face + 3; h++)
    {
        double *vertex = &brake->reach[brake->coarse->faces[h]], *edge = &edge_reach(brake)[brake->links->edge[h]];
        moved = moved || (*vertex > 0 && *vertex < INFINITY) || (*edge > 0 && *edge < INFINITY);
        *vertex = *vertex < INFINITY ? 0 : *vertex;
        *edge = *edge < INFINITY ? 0 : *edge;
    }
    return moved;
}

size_t brake_judge(mesh_brake *brake, const uint32_t *faces, double *positions)
{
    size_t held = 0, before;
    do
    {
        before = held;
        bound_moves(brake, positions);
        for (uint32_t f = 0; f < brake->links->face_count << 2 * brake->level; f++)
        {
            double coarse[3], fine[3];
            uint32_t ancestor = f >> 2 * brake->level;
            area_vector(brake->coarse->faces + 3 * (size_t)ancestor, brake->coarse->positions, coarse);
            area_vector(faces + 3 * (size_t)f, positions, fine);
            if (!brake->marched && vector3_dot(coarse, fine) < 0 && hold_face(brake, ancestor))
                held++;
        }
        hold_between(brake, brake->coarse->faces);
    } while (held > before);
    return held;
}

// Solids

bat_status bat_mesh_is_solid(const bat_mesh *mesh, bool *solid, bat_error *error)
{
    bat_mesh_connectivity links;
    *solid = false;
    if (mesh->offsets != NULL || mesh->crease_count + mesh->corner_count > 0)
        return BAT_OK;
    bat_status status = bat_mesh_connect(mesh, &links, error);
    if (status != BAT_OK)
        return status == BAT_NO_MEMORY ? status : BAT_OK;
    const mesh_level level = {.faces = mesh->faces, .links = &links};
    mesh_shape shape;
    status = shape_make(mesh, &level, true, &shape, error);
    size_t faces = 0;
    for (size_t f = 0; status == BAT_OK && f < mesh->face_count; f++)
        faces += shape.solid[f];
    *solid = faces > 0 && 2 * faces >= mesh->face_count;
    memory_pool_free(&shape.pool);
    bat_mesh_connectivity_free(&links);
    return status;
}
