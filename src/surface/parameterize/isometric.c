/// @file
/// Triangles of clouds and meshes, and where their minimization begins; see weights.h.

#include "surface/parameterize/weights.h"

#include "base/error.h"
#include "mesh/hash_table.h"
#include "surface/cloud/delaunay.h"

#include <math.h>
#include <string.h>

enum
{
    /// Larger clouds are represented by a part of their points; the others get averages.
    MAX_CORNERS = 8000,
    /// Larger meshes are triangulated anew, as clouds are.
    MAX_MESH = 20000
};

/// Energy from which a triangulation is taken as spoilt by rounding.
static const double MAX_START = 1e7;
static const double MIDDLE[2] = {0.5, 0.5};

/// Stands for the index of a point that is not in the whole cloud.
static const uint32_t NEW_POINT = UINT32_MAX;

typedef struct isometric_problem
{
    bat_cloud part;    ///< the corners of triangles, with the triangles
    uint32_t *members; ///< part.count: their indices in the whole cloud
    dirichlet_map map;
} isometric_problem;

static void problem_free(isometric_problem *problem)
{
    bat_cloud_free(&problem->part);
    free(problem->members);
    dirichlet_free(&problem->map);
    *problem = (isometric_problem){0};
}

/// Which points are corners of triangles: all, or an even choice of a large cloud. Corners of the square always are.
static void choose_points(const bat_cloud *cloud, const double *parameters, bool *used)
{
    double share = fmin((double)MAX_CORNERS / (double)cloud->count, 1), along = sqrt(share);
    for (size_t i = 0; i < cloud->count; i++)
    {
        bool boundary = i < cloud->boundary_count;
        double rate = boundary ? along : share;
        const double *u = parameters + 2 * i;
        bool corner = boundary && (u[0] == 0 || u[0] == 1) && (u[1] == 0 || u[1] == 1);
        used[i] = corner || floor((double)(i + 1) * rate) > floor((double)i * rate);
    }
}

/// Triangulate the chosen points. `used` keeps the corners of triangles only.
/// @param points receives the chosen points' indices, at most cloud->count
static bat_status triangulate(const bat_cloud *cloud, const double *parameters, bool *used, uint32_t *points,
                              simplices *found, bat_error *error)
{
    size_t count = 0;
    double(*planar)[2] = memory_array(cloud->count, sizeof *planar);
    if (planar == NULL)
        return error_memory(error, cloud->count * sizeof *planar);
    for (size_t i = 0; i < cloud->count; i++)
        if (used[i])
        {
            points[count] = (uint32_t)i;
            memcpy(planar[count++], parameters + 2 * i, sizeof *planar);
        }
    bat_status status = planar_delaunay((const double(*)[2])planar, count, found, error);
    memset(used, 0, cloud->count * sizeof *used);
    for (size_t k = 0; k < 3 * found->count; k++)
    {
        found->corners[k] = points[found->corners[k]];
        used[found->corners[k]] = true;
    }
    free(planar);
    return status;
}

/// Gather the corners of triangles as a cloud. `numbers` receives their indices in it.
static bat_status gather_part(const bat_cloud *cloud, const bool *used, const simplices *found, uint32_t *numbers,
                              isometric_problem *problem, bat_error *error)
{
    bat_cloud *part = &problem->part;
    for (size_t i = 0; i < cloud->count; i++)
        if (used[i])
        {
            numbers[i] = (uint32_t)part->count++;
            part->boundary_count += i < cloud->boundary_count;
        }
    problem->members = memory_array(part->count, sizeof *problem->members);
    part->points = memory_array(part->count, 3 * sizeof *part->points);
    part->triangles = memory_array(found->count, 3 * sizeof *part->triangles);
    part->triangle_count = found->count;
    if (problem->members == NULL || part->points == NULL || part->triangles == NULL)
        return error_memory(error, found->count * 3 * sizeof *part->points);
    for (size_t i = 0; i < cloud->count; i++)
        if (used[i])
        {
            problem->members[numbers[i]] = (uint32_t)i;
            memcpy(part->points + 3 * (size_t)numbers[i], cloud->points + 3 * i, 3 * sizeof *part->points);
        }
    for (size_t k = 0; k < 3 * found->count; k++)
        part->triangles[k] = numbers[found->corners[k]];
    return BAT_OK;
}

static bat_status make_part(const bat_cloud *cloud, const double *parameters, bool *used, isometric_problem *problem,
                            bat_error *error)
{
    simplices found = {0};
    uint32_t *points = memory_array(cloud->count, sizeof *points);
    if (points == NULL)
        return error_memory(error, cloud->count * sizeof *points);
    choose_points(cloud, parameters, used);
    bat_status status = triangulate(cloud, parameters, used, points, &found, error);
    if (status == BAT_OK)
        status = gather_part(cloud, used, &found, points, problem, error);
    simplices_free(&found);
    free(points);
    return status;
}

/// The triangles of a mesh whose chords are halved.
typedef struct chord_split
{
    const bat_cloud *cloud;
    key_map middles; ///< of the edges that join boundary points through the interior: the new points
    key_map edges;   ///< how many triangles an edge between boundary points has
    size_t added;    ///< number of new points
    bool flips;      ///< the triangles turn against the parameters
} chord_split;

static bool is_chord(const chord_split *split, uint32_t a, uint32_t b)
{
    size_t boundary = split->cloud->boundary_count;
    return a < boundary && b < boundary && key_map_find(&split->edges, key_of_pair(a, b)) > 1;
}

/// Number the middles of chords after the points of the cloud. False when out of memory.
static bool find_chords(chord_split *split)
{
    const bat_cloud *cloud = split->cloud;
    for (size_t h = 0; h < 3 * cloud->triangle_count; h++)
    {
        uint32_t a = cloud->triangles[h], b = cloud->triangles[h / 3 * 3 + (h + 1) % 3];
        if (a >= cloud->boundary_count || b >= cloud->boundary_count)
            continue;
        uint32_t *uses = key_map_at(&split->edges, key_of_pair(a, b));
        if (uses == NULL)
            return false;
        *uses = *uses == UINT32_MAX ? 1 : *uses + 1;
    }
    for (size_t h = 0; h < 3 * cloud->triangle_count; h++)
    {
        uint32_t a = cloud->triangles[h], b = cloud->triangles[h / 3 * 3 + (h + 1) % 3];
        if (!is_chord(split, a, b))
            continue;
        uint32_t *middle = key_map_at(&split->middles, key_of_pair(a, b));
        if (middle == NULL)
            return false;
        if (*middle == UINT32_MAX)
            *middle = (uint32_t)(cloud->count + split->added++);
    }
    return true;
}

static void add_triangle(const chord_split *split, uint32_t a, uint32_t b, uint32_t c, bat_cloud *part)
{
    const uint32_t corners[3] = {a, split->flips ? c : b, split->flips ? b : c};
    memcpy(part->triangles + 3 * part->triangle_count++, corners, sizeof corners);
}

/// Cut a triangle at the middles of its chords.
static void cut_triangle(const chord_split *split, const uint32_t corners[3], bat_cloud *part)
{
    uint32_t middles[3];
    size_t cuts = 0, last = 0, whole = 0;
    for (size_t k = 0; k < 3; k++)
    {
        uint32_t a = corners[k], b = corners[(k + 1) % 3];
        middles[k] = is_chord(split, a, b) ? key_map_find(&split->middles, key_of_pair(a, b)) : UINT32_MAX;
        cuts += middles[k] != UINT32_MAX;
        *(middles[k] != UINT32_MAX ? &last : &whole) = k;
    }
    // Corners from the cut, or from after the whole side, on.
    size_t first = cuts == 2 ? (whole + 1) % 3 : last;
    uint32_t a = corners[first], b = corners[(first + 1) % 3], c = corners[(first + 2) % 3];
    uint32_t m = middles[first], n = middles[(first + 1) % 3], o = middles[(first + 2) % 3];
    if (cuts == 0)
        add_triangle(split, corners[0], corners[1], corners[2], part);
    else if (cuts == 1)
    {
        add_triangle(split, a, m, c, part);
        add_triangle(split, m, b, c, part);
    }
    else
    {
        add_triangle(split, m, b, n, part);
        add_triangle(split, n, c, cuts == 3 ? o : a, part);
        add_triangle(split, cuts == 3 ? o : n, a, m, part);
        if (cuts == 3)
            add_triangle(split, m, n, o, part);
    }
}

/// Gather a mesh. Edges between points of one side of the square get middles: they would be flat with what they cut off.
static bat_status gather_mesh(const bat_cloud *cloud, const double *parameters, bool *used, isometric_problem *problem,
                              bat_error *error)
{
    bat_cloud *part = &problem->part;
    chord_split split = {.cloud = cloud};
    double turn = boundary_area(cloud, parameters);
    for (size_t h = 0; h < 3 * cloud->triangle_count; h++)
    {
        uint32_t a = cloud->triangles[h], b = cloud->triangles[h / 3 * 3 + (h + 1) % 3];
        if (a < cloud->boundary_count && b == (a + 1) % cloud->boundary_count)
            split.flips = turn < 0;
        if (b < cloud->boundary_count && a == (b + 1) % cloud->boundary_count)
            split.flips = turn > 0;
    }
    bool complete = find_chords(&split);
    size_t count = cloud->count + split.added;
    problem->members = memory_array(count, sizeof *problem->members);
    part->points = memory_array(count, 3 * sizeof *part->points);
    part->triangles = memory_array(cloud->triangle_count + 2 * split.added, 3 * sizeof *part->triangles);
    if (!complete || problem->members == NULL || part->points == NULL || part->triangles == NULL)
    {
        key_map_free(&split.middles);
        key_map_free(&split.edges);
        return error_memory(error, cloud->triangle_count * 3 * sizeof *part->points);
    }
    part->count = count;
    part->boundary_count = cloud->boundary_count;
    memcpy(part->points, cloud->points, 3 * cloud->count * sizeof *part->points);
    for (size_t i = 0; i < count; i++)
        problem->members[i] = i < cloud->count ? (uint32_t)i : NEW_POINT;
    for (size_t t = 0; t < cloud->triangle_count; t++)
    {
        const uint32_t *corners = cloud->triangles + 3 * t;
        for (size_t k = 0; k < 3; k++)
        {
            uint32_t a = corners[k], b = corners[(k + 1) % 3];
            used[a] = true;
            if (!is_chord(&split, a, b))
                continue;
            double *middle = part->points + 3 * (size_t)key_map_find(&split.middles, key_of_pair(a, b));
            for (size_t d = 0; d < 3; d++)
                middle[d] = (cloud->points[3 * (size_t)a + d] + cloud->points[3 * (size_t)b + d]) / 2;
        }
        cut_triangle(&split, corners, part);
    }
    key_map_free(&split.middles);
    key_map_free(&split.edges);
    return BAT_OK;
}

static double energy_of(const isometric_problem *problem)
{
    return dirichlet_energy(&problem->map, problem->map.parameters);
}

/// Keep the next parameters where they have less energy.
/// @return whether their energy is finite
static bool keep_better(dirichlet_map *map)
{
    double next = dirichlet_energy(map, map->next);
    if (next < dirichlet_energy(map, map->parameters))
        memcpy(map->parameters, map->next, 2 * map->point_count * sizeof *map->next);
    return isfinite(next);
}

/// Even out the parameters by averages over the triangles, which turn no triangle over (Floater, 2003), with weights divided
/// by the stretch. Rounding may prevent this where points crowd: uniform weights crowd less, and else the given
/// parameters stay.
static bat_status even_out(isometric_problem *problem, bat_progress progress, bat_error *error)
{
    sparse_rows rows = {0};
    bat_error failure;
    dirichlet_map *map = &problem->map;
    memcpy(map->next, map->parameters, 2 * map->point_count * sizeof *map->next);
    bat_status status = weights_of_triangles(&problem->part, &rows, &failure);
    if (status == BAT_OK)
        status = averages_solve(&problem->part, &rows, NULL, map->next, &failure);
    if (status == BAT_OK && !keep_better(map))
    {
        for (size_t row = 0; row < rows.row_count; row++)
            for (size_t e = rows.starts[row]; e < rows.starts[row + 1]; e++)
                rows.values[e] = 1 / (double)(rows.starts[row + 1] - rows.starts[row]); // Tutte, 1963
        status = averages_solve(&problem->part, &rows, NULL, map->next, &failure);
        if (status == BAT_OK)
            (void)keep_better(map);
    }
    if (status == BAT_OK)
        status = stretch_minimize(&problem->part, &rows, progress, map->next, &failure);
    sparse_rows_free(&rows);
    if (status == BAT_NO_MEMORY)
        return error_set(error, status, BAT_NO_INDEX, 0, "%s", failure.text);
    if (status == BAT_OK)
        (void)keep_better(map);
    return BAT_OK;
}

/// @param of_mesh the triangles are those of the cloud; else of a triangulation of the parameters
static bat_status problem_make(const bat_cloud *cloud, const double *parameters, bool of_mesh, bat_progress progress,
                               bool *used, isometric_problem *problem, bat_error *error)
{
    memset(used, 0, cloud->count * sizeof *used);
    bat_status status =
        of_mesh ? gather_mesh(cloud, parameters, used, problem, error) : make_part(cloud, parameters, used, problem, error);
    size_t count = problem->part.count;
    if (status != BAT_OK || count == 0)
        return status;
    dirichlet_map *map = &problem->map;
    map->point_count = count;
    map->boundary_count = problem->part.boundary_count;
    map->parameters = memory_pool_array(&map->pool, count, 2 * sizeof(double));
    map->next = memory_pool_array(&map->pool, count, 2 * sizeof(double));
    status = memory_pool_check(&map->pool, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < count; i++)
        memcpy(map->parameters + 2 * i,
               problem->members[i] == NEW_POINT ? MIDDLE : parameters + 2 * (size_t)problem->members[i],
               2 * sizeof *parameters);
    status = dirichlet_measure(problem->part.points, problem->part.triangles, problem->part.triangle_count, map, error);
    if (status == BAT_OK)
        status = even_out(problem, progress, error);
    return status == BAT_OK ? dirichlet_prepare(map, error) : status;
}

/// Move boundary points that are no corners of triangles between the nearest that are, in their former proportion.
static void move_boundary(const bat_cloud *cloud, const bool *used, const double *before, double *after)
{
    size_t count = cloud->boundary_count;
    for (size_t i = 0; i < count; i++)
    {
        if (used[i])
            continue;
        size_t low = i, high = i;
        for (size_t k = 0; k < count && !used[low]; k++)
            low = (low + count - 1) % count;
        for (size_t k = 0; k < count && !used[high]; k++)
            high = (high + 1) % count;
        if (!used[low] || !used[high])
            continue;
        for (size_t d = 0; d < 2; d++)
        {
            double from = before[2 * low + d], to = before[2 * high + d];
            double share = to != from ? (before[2 * i + d] - from) / (to - from) : 0;
            after[2 * i + d] = to != from ? after[2 * low + d] + share * (after[2 * high + d] - after[2 * low + d]) : from;
        }
    }
}

/// Copy the parameters of the corners of triangles, and average the others.
static bat_status store(const bat_cloud *cloud, const sparse_rows *rows, bool *used, const isometric_problem *problem,
                        double *parameters, bat_error *error)
{
    size_t others = 0;
    double *before = memory_array(cloud->boundary_count, 2 * sizeof *before);
    if (before == NULL)
        return error_memory(error, cloud->boundary_count * 2 * sizeof *before);
    memcpy(before, parameters, 2 * cloud->boundary_count * sizeof *before);
    for (size_t i = 0; i < problem->map.point_count; i++)
        if (problem->members[i] != NEW_POINT)
            memcpy(parameters + 2 * (size_t)problem->members[i], problem->map.parameters + 2 * i, 2 * sizeof *parameters);
    move_boundary(cloud, used, before, parameters);
    free(before);
    for (size_t i = 0; i < cloud->count; i++)
    {
        used[i] = i >= cloud->boundary_count && !used[i];
        others += used[i];
    }
    return others > 0 ? averages_solve(cloud, rows, used, parameters, error) : BAT_OK;
}

bat_status isometric_minimize(const bat_cloud *cloud, sparse_rows *rows, bat_progress progress, double *parameters,
                              bat_error *error)
{
    isometric_problem problem = {0};
    bool *used;
    bool of_mesh = cloud->triangle_count > 0 && cloud->count <= MAX_MESH;
    bat_status status = array_make(&used, cloud->count, sizeof *used, error);
    if (status == BAT_OK && of_mesh)
        // Where points crowd, an iteration turns triangles over.
        status = problem_make(cloud, parameters, true, progress, used, &problem, error);
    if (status == BAT_OK && of_mesh && !isfinite(energy_of(&problem)))
    {
        problem_free(&problem);
        of_mesh = false;
    }
    if (status == BAT_OK && !of_mesh)
        status = problem_make(cloud, parameters, false, progress, used, &problem, error);
    if (status == BAT_OK && !of_mesh && (problem.map.triangle_count == 0 || !(energy_of(&problem) < MAX_START)))
    {
        problem_free(&problem);
        status = stretch_minimize(cloud, rows, progress, parameters, error);
        if (status == BAT_OK)
            status = problem_make(cloud, parameters, false, progress, used, &problem, error);
    }
    if (status == BAT_OK && problem.map.solver != NULL)
        status = dirichlet_minimize(&problem.map, progress, error);
    if (status == BAT_OK && problem.map.solver != NULL)
        status = store(cloud, rows, used, &problem, parameters, error);
    problem_free(&problem);
    free(used);
    return status;
}
