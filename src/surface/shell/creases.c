/// @file
/// Creases of the points of a shell. The mesh that connects points is round where they have a sharp edge. Each point gets
/// the normal of the flattest neighbourhood that it lies in, and each vertex the plane of the side that it belongs to. An
/// edge between vertices of two sides is cut where both planes meet; the cuts are joined by creases. This is the insertion
/// of points of features by Kobbelt, Botsch, Schwanecke and Seidel, "Feature sensitive surface extraction from volume data"
/// (2001), with sides that come from the points.

#include "surface/shell/shell.h"

#include "base/disjoint_sets.h"
#include "base/error.h"
#include "linalg/vector.h"

#include <string.h>

#define PLANE_POINTS 12 ///< of a plane, without noise
#define MOST_POINTS 60
#define SIDE_POINTS 24 ///< around a vertex
#define MAX_SIDES 4
#define LEAST_OF_SIDE 4   ///< points
#define LEAST_OF_ALL 2    ///< points of a side that has no vertices
#define NEAREST_OF_SIDE 5 ///< that tell where its plane is
#define MIN_CHAIN 12      ///< triangles that a crease crosses
#define ROUNDS 12
#define RELAXATIONS 10
#define RINGS 3 ///< of vertices beside cuts that move to the planes

/// Growth of the planes' neighbourhoods with the square of the noise in spacings.
static const double NOISE_POINTS = 300;
/// Cosine of the angle from the mean normal of a side to its points'.
static const double SIDE_COSINE = 0.8660254037844386;
/// Sine of the angle between the plane of a side and the way to its points.
static const double MAX_RISE = 0.5;
/// Largest way of a vertex or cut, in spacings.
static const double MAX_WAY = 3;
/// Share of the way to the middle of the neighbours.
static const double RELAXATION = 0.7;
/// Angle between the normals of triangles from which they fold, without and with a crease between them.
static const double MAX_FOLD[2] = {1.7, 2.5};
/// Radius in spacings around a fold that has no creases.
static const double BLOCKED = 2;

static const uint32_t NONE = UINT32_MAX;

/// The plane of a neighbourhood.
typedef struct flat_plane
{
    double centre[3], normal[3], variance;
} flat_plane;

/// The plane normal . x = offset.
typedef struct side_plane
{
    double normal[3], offset;
} side_plane;

typedef struct crease_search
{
    const shell_cloud *cloud;
    double angle;
    const bat_mesh *mesh;
    bat_mesh made; ///< with creases
    bat_mesh_connectivity links;
    flat_plane *planes;       ///< of the points
    double *normals;          ///< count x 3: of the flattest neighbourhoods, outwards
    side_plane *sides;        ///< of the vertices
    double *cuts;             ///< edge_count x 3
    uint32_t *numbers;        ///< edge_count: the vertex at the cut; NONE: no cut
    uint32_t *sets, *lengths; ///< edge_count: of chains of cuts, and their lengths
    uint8_t *rings;           ///< vertex_count: number of the ring around cut edges; 0: none
    bool *blocked;            ///< vertex_count: creases fold there
    neighbour_list near;
    memory_pool pool;
} crease_search;

/// The points' normals.
static bat_status find_normals(crease_search *work, const double *outwards, bat_error *error)
{
    const shell_cloud *cloud = work->cloud;
    double ratio = cloud->noise / cloud->spacing;
    size_t wanted = (size_t)fmin(PLANE_POINTS + NOISE_POINTS * ratio * ratio, MOST_POINTS);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
    {
        status = neighbours_nearest(cloud->tree, cloud->points + 3 * i, wanted, &work->near, error);
        if (status != BAT_OK)
            break;
        local_plane plane = local_plane_fit(cloud->points, &work->near);
        memcpy(work->planes[i].centre, plane.centre, sizeof plane.centre);
        memcpy(work->planes[i].normal, plane.axes[2], sizeof plane.centre);
        work->planes[i].variance = plane.variance[2];
    }
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
    {
        const double *point = cloud->points + 3 * i;
        double least = INFINITY, *normal = work->normals + 3 * i;
        status = neighbours_nearest(cloud->tree, point, wanted, &work->near, error);
        for (size_t k = 0; k < work->near.count && status == BAT_OK; k++)
        {
            const flat_plane *plane = &work->planes[work->near.entries[k].item];
            double way[3];
            vector3_subtract(point, plane->centre, way);
            double height = vector3_dot(way, plane->normal), value = plane->variance + height * height;
            if (value >= least)
                continue;
            least = value;
            memcpy(normal, plane->normal, sizeof plane->normal);
        }
        if (vector3_dot(normal, outwards + 3 * i) < 0)
            vector_scale(3, -1, normal);
    }
    return status;
}

/// Points around a vertex that lie near one plane.
typedef struct crease_side
{
    side_plane plane;
    const double *nearest;  ///< the point nearest to the vertex
    double sum[3], mean[3]; ///< of the normals, and of the nearest points
    size_t count;
} crease_side;

static double height_above(const side_plane *plane, const double place[3])
{
    return vector3_dot(plane->normal, place) - plane->offset;
}

/// Whether a point belongs to a side: its normal and its direction from the side's first point are alike.
static bool is_of_side(const crease_side *side, const double *point, const double *normal, double noise)
{
    double way[3];
    vector3_subtract(point, side->nearest, way);
    return vector3_dot(side->sum, normal) > SIDE_COSINE * vector3_length(side->sum) &&
           fabs(vector3_dot(way, side->sum)) < (MAX_RISE * vector3_length(way) + 2 * noise) * vector3_length(side->sum);
}

/// Whether two sides meet in a valley, or else at a ridge.
static bool is_valley(const crease_side *a, const crease_side *b)
{
    return height_above(&a->plane, b->mean) + height_above(&b->plane, a->mean) > 0;
}

/// The one of two sides that a place belongs to: the higher plane at a ridge, the lower one in a valley.
static const crease_side *side_at(const crease_side *a, const crease_side *b, const double place[3])
{
    return is_valley(a, b) == (height_above(&b->plane, place) < height_above(&a->plane, place)) ? b : a;
}

static int compare_sides(const void *a, const void *b)
{
    const crease_side *p = a, *q = b;
    return (p->count < q->count) - (p->count > q->count);
}

/// Gather the sides around a place, those of most points first.
/// @return their number
static size_t gather_sides(const crease_search *work, crease_side sides[MAX_SIDES])
{
    const shell_cloud *cloud = work->cloud;
    size_t count = 0, kept = 0;
    for (size_t k = 0; k < work->near.count; k++)
    {
        const double *point = cloud->points + 3 * (size_t)work->near.entries[k].item,
                     *normal = work->normals + 3 * (size_t)work->near.entries[k].item;
        size_t s = 0;
        while (s < count && !is_of_side(&sides[s], point, normal, cloud->noise))
            s++;
        if (s == MAX_SIDES)
            continue;
        if (s == count)
            sides[count++] = (crease_side){.nearest = point};
        vector_add(3, 1, normal, sides[s].sum);
        if (sides[s].count++ < NEAREST_OF_SIDE)
            vector_add(3, 1, point, sides[s].mean);
    }
    for (size_t s = 0; s < count; s++)
    {
        crease_side *side = &sides[s];
        if (side->count < LEAST_OF_ALL)
            continue;
        memcpy(side->plane.normal, side->sum, sizeof side->sum);
        (void)vector3_normalize(side->plane.normal);
        vector_scale(3, 1 / fmin((double)side->count, NEAREST_OF_SIDE), side->mean);
        side->plane.offset = vector3_dot(side->mean, side->plane.normal);
        sides[kept++] = *side;
    }
    qsort(sides, kept, sizeof *sides, compare_sides);
    return kept;
}

/// The one of up to three sides that a place belongs to. A solid of three is (a and b) or c, or (a or b) and c, where the
/// pair that meets in another way than the others is first.
static const crease_side *side_of_three(const crease_side *sides, size_t count, const double place[3])
{
    size_t first = 0;
    if (count < 3)
        return count < 2 ? sides : side_at(&sides[0], &sides[1], place);
    for (size_t k = 1; k < 3; k++)
    {
        const crease_side *a = &sides[k], *b = &sides[(k + 1) % 3], *c = &sides[(k + 2) % 3];
        if (is_valley(a, b) != is_valley(b, c) && is_valley(a, b) != is_valley(c, a))
            first = k;
    }
    return side_at(side_at(&sides[first], &sides[(first + 1) % 3], place), &sides[(first + 2) % 3], place);
}

/// The plane of the side that a vertex belongs to.
static bat_status find_side(crease_search *work, uint32_t vertex, bat_error *error)
{
    const double *place = work->mesh->positions + 3 * (size_t)vertex;
    crease_side sides[MAX_SIDES];
    bat_status status = neighbours_nearest(work->cloud->tree, place, SIDE_POINTS, &work->near, error);
    size_t count = status == BAT_OK ? gather_sides(work, sides) : 0;
    // Sides of few points tell where others end, but have no vertices.
    while (count > 0)
    {
        crease_side *chosen = &sides[side_of_three(sides, count < 3 ? count : 3, place) - sides];
        work->sides[vertex] = chosen->plane;
        if (chosen->count >= LEAST_OF_SIDE)
            break;
        count--;
        memmove(chosen, chosen + 1, (size_t)(sides + count - chosen) * sizeof *chosen);
    }
    return status;
}

/// The place on two planes that is nearest to another place.
static void meet_two(const side_plane *a, const side_plane *b, const double place[3], double met[3])
{
    double cosine = vector3_dot(a->normal, b->normal), p = -height_above(a, place), q = -height_above(b, place),
           scale = 1 / (1 - cosine * cosine);
    memcpy(met, place, 3 * sizeof *met);
    vector_add(3, (p - cosine * q) * scale, a->normal, met);
    vector_add(3, (q - cosine * p) * scale, b->normal, met);
}

/// Cut the edges between two sides.
static void cut_edges(crease_search *work)
{
    const bat_mesh *mesh = work->mesh;
    double longest = MAX_WAY * work->cloud->spacing;
    memset(work->numbers, 0xff, work->links.edge_count * sizeof *work->numbers);
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
    {
        uint32_t a = mesh->faces[h], b = mesh->faces[bat_mesh_next(h)], edge = work->links.edge[h];
        const side_plane *p = &work->sides[a], *q = &work->sides[b];
        if (work->links.twin[h] == NONE || work->links.twin[h] < h || work->blocked[a] || work->blocked[b] ||
            vector3_angle(p->normal, q->normal) < work->angle)
            continue;
        double middle[3], *cut = work->cuts + 3 * (size_t)edge;
        for (size_t c = 0; c < 3; c++)
            middle[c] = (mesh->positions[3 * (size_t)a + c] + mesh->positions[3 * (size_t)b + c]) / 2;
        meet_two(p, q, middle, cut);
        if (vector3_distance(middle, cut) < longest)
            work->numbers[edge] = 0;
    }
}

/// The number of cut edges of a face.
static int count_cuts(const crease_search *work, size_t face)
{
    int count = 0;
    for (size_t k = 0; k < 3; k++)
        count += work->numbers[work->links.edge[3 * face + k]] != NONE;
    return count;
}

/// Leave out short chains of cuts, and number the others.
/// @param added receives the number of faces that become more
static void number_cuts(crease_search *work, size_t *vertices, size_t *added)
{
    const uint32_t *edge = work->links.edge;
    uint32_t *sets = work->sets, *lengths = work->lengths;
    memset(lengths, 0, work->links.edge_count * sizeof *lengths);
    *added = 0;
    sets_begin(sets, work->links.edge_count);
    for (size_t f = 0; f < work->mesh->face_count; f++)
        for (size_t k = 0; k < 3 && count_cuts(work, f) >= 2; k++)
            if (work->numbers[edge[3 * f + k]] != NONE && work->numbers[edge[3 * f + (k + 1) % 3]] != NONE)
                (void)sets_join(sets, edge[3 * f + k], edge[3 * f + (k + 1) % 3]);
    for (size_t f = 0; f < work->mesh->face_count; f++)
        for (size_t k = 0; k < 3; k++)
            lengths[sets_root(sets, edge[3 * f + k])] += count_cuts(work, f) >= 2;
    *vertices = work->mesh->vertex_count;
    for (uint32_t e = 0; e < work->links.edge_count; e++)
        if (work->numbers[e] != NONE)
            work->numbers[e] = lengths[sets_root(sets, e)] >= MIN_CHAIN ? (uint32_t)(*vertices)++ : NONE;
    for (size_t f = 0; f < work->mesh->face_count; f++)
    {
        int count = count_cuts(work, f);
        *added += count == 3 ? 5 : (size_t)count;
        *vertices += count == 3;
    }
}

/// The place where the planes of a face's corners meet, or the middle of its cuts where that is far.
static void meet_three(const crease_search *work, size_t face, double met[3])
{
    const side_plane *planes[3];
    double middle[3] = {0}, rights[3], products[3][3];
    for (size_t k = 0; k < 3; k++)
    {
        planes[k] = &work->sides[work->mesh->faces[3 * face + k]];
        vector_add(3, 1.0 / 3, work->cuts + 3 * (size_t)work->links.edge[3 * face + k], middle);
    }
    for (size_t k = 0; k < 3; k++)
    {
        rights[k] = -height_above(planes[k], middle);
        vector3_cross(planes[(k + 1) % 3]->normal, planes[(k + 2) % 3]->normal, products[k]);
    }
    double determinant = vector3_dot(planes[0]->normal, products[0]);
    memcpy(met, middle, sizeof middle);
    for (size_t k = 0; k < 3; k++)
        vector_add(3, rights[k] / determinant, products[k], met);
    if (!(vector3_distance(met, middle) < MAX_WAY * work->cloud->spacing))
        memcpy(met, middle, sizeof middle);
}

/// Divide a face along its creases.
/// @param made receives its parts
/// @return their number
static size_t divide(crease_search *work, size_t face, uint32_t (*made)[3])
{
    bat_mesh *mesh = &work->made;
    const uint32_t *corners = work->mesh->faces + 3 * face;
    uint32_t cut[3];
    int count = count_cuts(work, face);
    size_t first = 0;
    // With one cut, it is on the side from the first corner; with two, none is there.
    for (size_t k = 0; k < 3; k++)
        if ((work->numbers[work->links.edge[3 * face + k]] == NONE) == (count == 2))
            first = k;
    for (size_t k = 0; k < 3; k++)
        cut[k] = work->numbers[work->links.edge[3 * face + (first + k) % 3]];
    const uint32_t a = corners[first], b = corners[(first + 1) % 3], c = corners[(first + 2) % 3];
    bat_mesh_crease *crease = mesh->creases + mesh->crease_count;
    switch (count)
    {
    case 0:
        memcpy(made, (uint32_t[1][3]){{a, b, c}}, sizeof *made);
        return 1;
    case 1:
        memcpy(made, (uint32_t[2][3]){{a, cut[0], c}, {cut[0], b, c}}, 2 * sizeof *made);
        return 2;
    case 2:
    {
        const double *at = mesh->positions;
        bool other = chord_square(at + 3 * (size_t)a, at + 3 * (size_t)cut[1]) >
                     chord_square(at + 3 * (size_t)b, at + 3 * (size_t)cut[2]);
        memcpy(made, (uint32_t[3][3]){{c, cut[2], cut[1]}, {a, b, other ? cut[2] : cut[1]}, {cut[1], cut[2], other ? b : a}},
               3 * sizeof *made);
        *crease = (bat_mesh_crease){cut[1], cut[2], BAT_MESH_SHARP};
        mesh->crease_count++;
        return 3;
    }
    default:
    {
        uint32_t middle = (uint32_t)mesh->vertex_count++;
        meet_three(work, face, mesh->positions + 3 * (size_t)middle);
        for (size_t k = 0; k < 3; k++)
        {
            uint32_t corner = corners[(first + k) % 3], last = cut[(k + 2) % 3];
            memcpy(made + 2 * k, (uint32_t[2][3]){{corner, cut[k], middle}, {corner, middle, last}}, 2 * sizeof *made);
            crease[k] = (bat_mesh_crease){cut[k], middle, BAT_MESH_SHARP};
        }
        mesh->crease_count += 3;
        return 6;
    }
    }
}

/// Copy the mesh with cuts and creases.
static bat_status divide_faces(crease_search *work, size_t vertices, size_t added, bat_error *error)
{
    bat_mesh *mesh = &work->made;
    bat_status status = bat_mesh_copy(work->mesh, mesh, error);
    if (status != BAT_OK)
        return status;
    size_t count = mesh->face_count, made = 0;
    memset(work->rings, 0, mesh->vertex_count);
    uint32_t(*faces)[3] = memory_array(count + added, sizeof *faces);
    double *positions = realloc(mesh->positions, vertices * 3 * sizeof *positions);
    mesh->positions = positions != NULL ? positions : mesh->positions;
    mesh->creases = memory_array(added, sizeof *mesh->creases);
    if (faces == NULL || positions == NULL || mesh->creases == NULL)
    {
        free(faces);
        return error_memory(error, vertices * 3 * sizeof *positions);
    }
    for (size_t h = 0; h < 3 * count; h++)
    {
        uint32_t number = work->numbers[work->links.edge[h]];
        if (number == NONE)
            continue;
        memcpy(positions + 3 * (size_t)number, work->cuts + 3 * (size_t)work->links.edge[h], 3 * sizeof *positions);
        mesh->vertex_count = number >= mesh->vertex_count ? number + 1 : mesh->vertex_count;
        work->rings[mesh->faces[h]] = 1;
    }
    for (uint8_t ring = 1; ring <= RINGS; ring++)
        for (uint32_t h = 0; h < 3 * count; h++)
            if (work->rings[mesh->faces[h]] == ring && work->rings[mesh->faces[bat_mesh_next(h)]] == 0)
                work->rings[mesh->faces[bat_mesh_next(h)]] = ring + 1;
    for (size_t v = 0; v < work->mesh->vertex_count; v++)
    {
        double height = height_above(&work->sides[v], positions + 3 * v);
        if (work->rings[v] > 0 && fabs(height) < MAX_WAY * work->cloud->spacing)
            vector_add(3, -height, work->sides[v].normal, positions + 3 * v);
    }
    for (size_t f = 0; f < count; f++)
        made += divide(work, f, faces + made);
    free(mesh->faces);
    mesh->faces = (uint32_t *)faces;
    mesh->face_count = made;
    return BAT_OK;
}

/// The neighbours of a vertex along creases: two of them, and how many there are.
typedef struct crease_ends
{
    uint32_t vertices[2], count;
} crease_ends;

static void find_ends(const bat_mesh *mesh, crease_ends *ends)
{
    for (size_t k = 0; k < 2 * mesh->crease_count; k++)
    {
        const bat_mesh_crease *crease = &mesh->creases[k / 2];
        crease_ends *at = &ends[k % 2 == 0 ? crease->a : crease->b];
        at->vertices[at->count++ % 2] = k % 2 == 0 ? crease->b : crease->a;
    }
}

/// Even out the triangles beside creases: vertices of sides move in their planes, those of creases along these.
static void even_out(crease_search *work, const bat_mesh_connectivity *links, const crease_ends *ends)
{
    const bat_mesh *made = &work->made;
    for (size_t k = 0; k < RELAXATIONS * made->vertex_count; k++)
    {
        size_t v = k % made->vertex_count;
        uint32_t first = links->first[v], h = first;
        double *place = made->positions + 3 * v, middle[3] = {0}, count = 0;
        if (ends[v].count == 2)
            for (; count < 2; count++)
                vector_add(3, 1, made->positions + 3 * (size_t)ends[v].vertices[(int)count], middle);
        else if (ends[v].count == 0 && v < work->mesh->vertex_count && work->rings[v] > 0)
            do
            {
                vector_add(3, 1, made->positions + 3 * (size_t)made->faces[bat_mesh_next(h)], middle);
                count++;
                h = bat_mesh_next_around(links, h);
            } while (h != first && h != NONE);
        if (count == 0 || h == NONE)
            continue;
        for (size_t c = 0; c < 3; c++)
            place[c] += RELAXATION * (middle[c] / count - place[c]);
        if (ends[v].count == 0)
            vector_add(3, -height_above(&work->sides[v], place), work->sides[v].normal, place);
    }
}

/// Whether an edge of the copy lies on a fold. On a crease, two sides may have a large angle.
static bool is_folded(const bat_mesh *made, uint32_t h, uint32_t twin, const crease_ends *ends)
{
    double a[3], b[3];
    const crease_ends *at = &ends[made->faces[h]];
    uint32_t other = made->faces[bat_mesh_next(h)];
    bool sharp = at->count > 2 || (at->count > 0 && at->vertices[0] == other) || (at->count > 1 && at->vertices[1] == other);
    vector3_face(made->positions, made->faces + h / 3 * 3, a);
    vector3_face(made->positions, made->faces + twin / 3 * 3, b);
    return !(vector3_angle(a, b) < MAX_FOLD[sharp]);
}

/// Even out the copy, and block the vertices around its folds.
/// @param folds receives their number
static bat_status block_folds(crease_search *work, const nearest_tree *vertices, size_t *folds, bat_error *error)
{
    const bat_mesh *made = &work->made;
    crease_ends *ends = calloc(made->vertex_count, sizeof *ends);
    bat_mesh_connectivity links = {0};
    bat_status status =
        ends == NULL ? error_memory(error, made->vertex_count * sizeof *ends) : bat_mesh_connect(made, &links, error);
    if (status == BAT_OK)
    {
        find_ends(made, ends);
        even_out(work, &links, ends);
    }
    *folds = 0;
    for (uint32_t h = 0; status == BAT_OK && h < 3 * made->face_count; h++)
    {
        uint32_t v = made->faces[h], twin = links.twin[h];
        if (twin == NONE || (v < work->mesh->vertex_count && work->rings[v] == 0) || !is_folded(made, h, twin, ends))
            continue;
        status =
            neighbours_within(vertices, made->positions + 3 * (size_t)v, BLOCKED * work->cloud->spacing, &work->near, error);
        for (size_t k = 0; k < work->near.count && status == BAT_OK; k++)
        {
            *folds += !work->blocked[work->near.entries[k].item];
            work->blocked[work->near.entries[k].item] = true;
        }
    }
    bat_mesh_connectivity_free(&links);
    free(ends);
    return status;
}

/// Find creases until they leave no folds.
static bat_status find_creases(crease_search *work, const nearest_tree *vertices, bat_error *error)
{
    size_t made = 0, added = 0, folds = SIZE_MAX;
    bat_status status = BAT_OK;
    for (int round = 0; round < ROUNDS && folds > 0 && status == BAT_OK; round++)
    {
        bat_mesh_free(&work->made);
        cut_edges(work);
        number_cuts(work, &made, &added);
        if (added == 0)
            return BAT_OK;
        status = divide_faces(work, made, added, error);
        if (status == BAT_OK)
            status = block_folds(work, vertices, &folds, error);
    }
    return status;
}

bat_status shell_find_creases(const shell_cloud *cloud, const double *outwards, double angle, const bat_mesh *mesh,
                              bat_mesh *creased, bat_error *error)
{
    crease_search work = {.cloud = cloud, .angle = angle, .mesh = mesh};
    nearest_tree vertices = {0};
    bat_status status = bat_mesh_connect(mesh, &work.links, error);
    if (status != BAT_OK)
        return status;
    work.planes = memory_pool_array(&work.pool, cloud->count, sizeof *work.planes);
    work.normals = memory_pool_zeros(&work.pool, cloud->count, 3 * sizeof *work.normals);
    work.sides = memory_pool_zeros(&work.pool, mesh->vertex_count, sizeof *work.sides);
    work.sets = memory_pool_array(&work.pool, work.links.edge_count, sizeof *work.sets);
    work.lengths = memory_pool_array(&work.pool, work.links.edge_count, sizeof *work.lengths);
    work.rings = memory_pool_array(&work.pool, mesh->vertex_count, sizeof *work.rings);
    work.blocked = memory_pool_zeros(&work.pool, mesh->vertex_count, sizeof *work.blocked);
    work.cuts = memory_pool_array(&work.pool, work.links.edge_count, 3 * sizeof *work.cuts);
    work.numbers = memory_pool_array(&work.pool, work.links.edge_count, sizeof *work.numbers);
    status = memory_pool_check(&work.pool, error);
    if (status == BAT_OK)
        status = neighbours_build(mesh->positions, mesh->vertex_count, &vertices, error);
    if (status == BAT_OK)
        status = find_normals(&work, outwards, error);
    for (uint32_t v = 0; v < mesh->vertex_count && status == BAT_OK; v++)
        status = find_side(&work, v, error);
    if (status == BAT_OK)
        status = find_creases(&work, &vertices, error);
    if (status == BAT_OK && work.made.crease_count > 0)
        *creased = work.made;
    else
        bat_mesh_free(&work.made);
    nearest_free(&vertices);
    neighbour_list_free(&work.near);
    bat_mesh_connectivity_free(&work.links);
    memory_pool_free(&work.pool);
    return status;
}
