/// @file
/// Symmetric Dirichlet energy by reweighted least squares; see isometric.h.
///
/// In a round, each triangle with derivative J = U diag(s_1, s_2) V^T has the proxy energy
///     |W (J' - R)|^2,   R = U V^T,   W = U diag(w_1, w_2) U^T,   w_i^2 = (s_i - s_i^-3) / (s_i - 1),
/// whose gradient at J is that of the symmetric Dirichlet energy. The minimizer of the sum is a direction of descent. The
/// step along it ends before the first triangle degenerates.

#include "surface/parameterize/isometric.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/progress.h"
#include "linalg/multifrontal.h"
#include "linalg/vector3.h"
#include "mesh/key_map.h"
#include "surface/cloud/delaunay.h"
#include "surface/parameterize/stretch.h"
#include "surface/parameterize/weights.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MAX_ROUNDS = 40,
    MAX_HALVINGS = 24,
    /// Larger clouds are represented by a part of their points; the others get averages.
    MAX_CORNERS = 8000,
    /// Larger meshes are triangulated anew, as clouds are.
    MAX_MESH = 20000,
    CORNER_UNKNOWNS = 6, ///< unknowns of a triangle
    TRIANGLE_ENTRIES = CORNER_UNKNOWNS * (CORNER_UNKNOWNS + 1) / 2
};

/// Rounds end when the energy decreases by less than this share.
static const double MIN_DECREASE = 2e-3;
/// Smallest ratio of a triangle's height to its longest side. Flatter triangles are measured with this height.
static const double MIN_HEIGHT = 0.05;
/// Share of the step to the first degenerate triangle.
static const double STEP_SHARE = 0.8;
/// Share of the derivative that a step must realize (Armijo, 1966).
static const double ARMIJO = 1e-4;
/// Weight of the proximal term, relative to the mean diagonal entry.
static const double PROXIMAL = 1e-6;
/// Energy from which a triangulation is taken as spoilt by rounding.
static const double MAX_START = 1e7;
/// Limit of the weights of the proxy.
static const double MAX_WEIGHT = 1e8;
/// The middle of the square.
static const double MIDDLE[2] = {0.5, 0.5};

/// Stands for a coordinate that does not move.
static const int FIXED = -1;
/// Stands for the index of a point that is not in the whole cloud.
static const uint32_t NEW_POINT = UINT32_MAX;

/// A triangle: gradients of the hat functions of its corners in its plane, and its area. The sum over corners of
/// parameter_k gradient_k^T is the derivative of the map to the parameters.
typedef struct rest_triangle
{
    uint32_t corners[3];
    double gradient[3][2];
    double area;
    int entries[TRIANGLE_ENTRIES]; ///< of its unknowns' pairs (a, b), b <= a, in the matrix; FIXED for none
} rest_triangle;

typedef struct isometric_problem
{
    bat_cloud part;    ///< the corners of triangles, with the triangles
    uint32_t *members; ///< part.count: their indices in the whole cloud
    rest_triangle *triangles;
    size_t triangle_count;
    size_t point_count;
    int *unknown; ///< point_count x 2: unknowns of the coordinates, FIXED for coordinates that stay
    size_t unknowns;
    int *first; ///< unknowns + 1, of the pattern
    int *row;
    multifrontal *solver;
    double *values;    ///< of the matrix
    double *direction; ///< unknowns
    double *parameters, *next;
} isometric_problem;

static void problem_free(isometric_problem *problem)
{
    bat_cloud_free(&problem->part);
    free(problem->members);
    free(problem->triangles);
    free(problem->unknown);
    free(problem->first);
    free(problem->row);
    free(problem->values);
    free(problem->direction);
    free(problem->parameters);
    free(problem->next);
    multifrontal_free(problem->solver);
}

/// Measure a triangle in space.
static void rest_triangle_make(const double *a, const double *b, const double *c, rest_triangle *made)
{
    double along[3], other[3], across[3];
    vector3_subtract(b, a, along);
    vector3_subtract(c, a, other);
    vector3_cross(along, other, across);
    double length = sqrt(vector3_dot(along, along)), far = sqrt(vector3_dot(other, other));
    double longest = fmax(fmax(length, far), vector3_distance(b, c));
    double doubled = fmax(sqrt(vector3_dot(across, across)), MIN_HEIGHT * longest * longest);
    // Corners (0, 0), (length, 0), (x, y).
    double base = fmax(length, MIN_HEIGHT * longest), x = vector3_dot(along, other) / base, y = doubled / base;
    const double planar[3][2] = {{0, 0}, {base, 0}, {x, y}};
    for (int k = 0; k < 3; k++)
    {
        const double *p = planar[(k + 1) % 3], *q = planar[(k + 2) % 3];
        made->gradient[k][0] = (p[1] - q[1]) / doubled;
        made->gradient[k][1] = (q[0] - p[0]) / doubled;
    }
    made->area = doubled / 2;
}

/// The map's derivative: rows are coordinates of parameters.
static void derivative_of(const rest_triangle *triangle, const double *parameters, double derivative[4])
{
    memset(derivative, 0, 4 * sizeof *derivative);
    for (int k = 0; k < 3; k++)
    {
        const double *u = parameters + 2 * (size_t)triangle->corners[k];
        for (int e = 0; e < 4; e++)
            derivative[e] += u[e / 2] * triangle->gradient[k][e % 2];
    }
}

/// |J|^2 (1 + 1 / det^2); infinite where det <= 0.
static double energy_of(const isometric_problem *problem, const double *parameters)
{
    double sum = 0;
    for (size_t t = 0; t < problem->triangle_count; t++)
    {
        double j[4];
        derivative_of(&problem->triangles[t], parameters, j);
        double square = j[0] * j[0] + j[1] * j[1] + j[2] * j[2] + j[3] * j[3], det = j[0] * j[3] - j[1] * j[2];
        if (!(det > 0))
            return INFINITY;
        sum += problem->triangles[t].area * square * (1 + 1 / (det * det));
    }
    return sum;
}

/// J = U diag(s) V^T for a positive determinant; W^2 = U diag(w^2) U^T and R = U V^T.
static void proxy_of(const double j[4], double weight[4], double rotation[4])
{
    // Blinn, "Consider the lowly 2 x 2 matrix" (1996).
    double e = (j[0] + j[3]) / 2, f = (j[0] - j[3]) / 2, g = (j[2] + j[1]) / 2, h = (j[2] - j[1]) / 2;
    double q = hypot(e, h), r = hypot(f, g), s[2] = {q + r, fmax(q - r, 1e-300)};
    double beta = (atan2(h, e) + atan2(g, f)) / 2, turn = atan2(h, e), c = cos(beta), d = sin(beta), w[2];
    for (int k = 0; k < 2; k++)
    {
        // (s - s^-3) / (s - 1) = (s + 1) (s^2 + 1) / s^3
        w[k] = fmin((s[k] + 1) * (s[k] * s[k] + 1) / (s[k] * s[k] * s[k]), MAX_WEIGHT);
    }
    weight[0] = w[0] * c * c + w[1] * d * d;
    weight[1] = weight[2] = (w[0] - w[1]) * c * d;
    weight[3] = w[0] * d * d + w[1] * c * c;
    rotation[0] = rotation[3] = cos(turn);
    rotation[1] = -sin(turn);
    rotation[2] = sin(turn);
}

// Pattern

static int compare_ints(const void *a, const void *b)
{
    int p = *(const int *)a, q = *(const int *)b;
    return (p > q) - (p < q);
}

/// The unknowns of a triangle: coordinate a % 2 of corner a / 2.
static int unknown_of(const isometric_problem *problem, const rest_triangle *triangle, int a)
{
    return problem->unknown[2 * (size_t)triangle->corners[a / 2] + (size_t)(a % 2)];
}

/// The lower triangle of the pattern by columns. False when out of memory.
static bool make_pattern(isometric_problem *problem)
{
    size_t columns = problem->unknowns;
    int *fill = calloc(columns + 1, sizeof *fill);
    problem->first = calloc(columns + 1, sizeof *problem->first);
    problem->row = memory_array(problem->triangle_count, TRIANGLE_ENTRIES * sizeof *problem->row);
    if (fill == NULL || problem->first == NULL || problem->row == NULL)
    {
        free(fill);
        return false;
    }
    for (int pass = 0; pass < 2; pass++)
    {
        for (size_t t = 0; t < problem->triangle_count; t++)
            for (int a = 0; a < CORNER_UNKNOWNS; a++)
                for (int b = 0; b <= a; b++)
                {
                    int p = unknown_of(problem, &problem->triangles[t], a),
                        q = unknown_of(problem, &problem->triangles[t], b);
                    if (p == FIXED || q == FIXED)
                        continue;
                    int low = p < q ? p : q, high = p < q ? q : p;
                    if (pass == 0)
                        fill[low]++;
                    else
                        problem->row[fill[low]++] = high;
                }
        int sum = 0;
        for (size_t c = 0; c < columns && pass == 0; c++)
        {
            int entries = fill[c];
            fill[c] = sum;
            sum += entries;
        }
    }
    // Sort each column and drop repetitions.
    int made = 0, begin = 0;
    for (size_t c = 0; c < columns; c++)
    {
        int end = fill[c];
        qsort(problem->row + begin, (size_t)(end - begin), sizeof *problem->row, compare_ints);
        problem->first[c] = made;
        for (int k = begin; k < end; k++)
            if (k == begin || problem->row[k] != problem->row[k - 1])
                problem->row[made++] = problem->row[k];
        begin = end;
    }
    problem->first[columns] = made;
    free(fill);
    return true;
}

/// The index of an entry of the pattern.
static int find_entry(const isometric_problem *problem, int p, int q)
{
    int column = p < q ? p : q, wanted = p < q ? q : p;
    int low = problem->first[column], high = problem->first[column + 1];
    while (high - low > 1)
    {
        int middle = low + (high - low) / 2;
        if (problem->row[middle] <= wanted)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static void set_entries(isometric_problem *problem)
{
    for (size_t t = 0; t < problem->triangle_count; t++)
    {
        rest_triangle *triangle = &problem->triangles[t];
        int *entry = triangle->entries;
        for (int a = 0; a < CORNER_UNKNOWNS; a++)
            for (int b = 0; b <= a; b++)
            {
                int p = unknown_of(problem, triangle, a), q = unknown_of(problem, triangle, b);
                *entry++ = p == FIXED || q == FIXED ? FIXED : find_entry(problem, p, q);
            }
    }
}

/// Number the coordinates that move: a boundary point has none at a corner of the square, and one along a side.
static void number_unknowns(isometric_problem *problem)
{
    for (size_t i = 0; i < problem->point_count; i++)
    {
        const double *u = problem->parameters + 2 * i;
        bool on[2] = {u[0] == 0 || u[0] == 1, u[1] == 0 || u[1] == 1};
        for (size_t d = 0; d < 2; d++)
        {
            bool boundary = i < problem->part.boundary_count, stays = boundary && (on[d] || !on[1 - d]);
            problem->unknown[2 * i + d] = stays ? FIXED : (int)problem->unknowns++;
        }
    }
}

// Rounds

/// Assemble the proxy's matrix and minus its gradient.
static void assemble(isometric_problem *problem)
{
    memset(problem->values, 0, (size_t)problem->first[problem->unknowns] * sizeof *problem->values);
    memset(problem->direction, 0, problem->unknowns * sizeof *problem->direction);
    for (size_t t = 0; t < problem->triangle_count; t++)
    {
        const rest_triangle *triangle = &problem->triangles[t];
        double j[4], weight[4], rotation[4], pull[4];
        derivative_of(triangle, problem->parameters, j);
        proxy_of(j, weight, rotation);
        for (int e = 0; e < 4; e++)
            pull[e] = weight[e / 2 * 2] * (rotation[e % 2] - j[e % 2]) +
                      weight[e / 2 * 2 + 1] * (rotation[2 + e % 2] - j[2 + e % 2]);
        const int *entry = triangle->entries;
        for (int a = 0; a < CORNER_UNKNOWNS; a++)
        {
            const double *at = triangle->gradient[a / 2];
            int p = unknown_of(problem, triangle, a);
            if (p != FIXED)
                problem->direction[p] += triangle->area * (pull[a % 2 * 2] * at[0] + pull[a % 2 * 2 + 1] * at[1]);
            for (int b = 0; b <= a; b++, entry++)
            {
                const double *other = triangle->gradient[b / 2];
                if (*entry != FIXED)
                    problem->values[*entry] +=
                        triangle->area * weight[a % 2 * 2 + b % 2] * (at[0] * other[0] + at[1] * other[1]);
            }
        }
    }
    double mean = 0;
    for (size_t c = 0; c < problem->unknowns; c++)
        mean += problem->values[problem->first[c]] / (double)problem->unknowns;
    for (size_t c = 0; c < problem->unknowns; c++)
        problem->values[problem->first[c]] += PROXIMAL * mean;
}

static double direction_at(const isometric_problem *problem, uint32_t point, size_t d)
{
    int unknown = problem->unknown[2 * (size_t)point + d];
    return unknown == FIXED ? 0 : problem->direction[unknown];
}

/// The smallest positive root of a + b t + c t^2 with a > 0; infinite for none.
static double first_root(double a, double b, double c)
{
    if (fabs(c) < 1e-300)
        return b < 0 ? -a / b : INFINITY;
    double inside = b * b - 4 * a * c;
    if (inside < 0)
        return INFINITY;
    double q = -(b + copysign(sqrt(inside), b)) / 2, roots[2] = {q / c, q != 0 ? a / q : INFINITY}, least = INFINITY;
    for (int k = 0; k < 2; k++)
        if (roots[k] > 0 && roots[k] < least)
            least = roots[k];
    return least;
}

/// The step at which the first triangle degenerates.
static double longest_step(const isometric_problem *problem)
{
    double least = INFINITY;
    for (size_t t = 0; t < problem->triangle_count; t++)
    {
        const uint32_t *corners = problem->triangles[t].corners;
        double p[2][2], v[2][2];
        for (size_t k = 0; k < 2; k++)
            for (size_t d = 0; d < 2; d++)
            {
                p[k][d] =
                    problem->parameters[2 * (size_t)corners[k + 1] + d] - problem->parameters[2 * (size_t)corners[0] + d];
                v[k][d] = direction_at(problem, corners[k + 1], d) - direction_at(problem, corners[0], d);
            }
        double a = p[0][0] * p[1][1] - p[0][1] * p[1][0], c = v[0][0] * v[1][1] - v[0][1] * v[1][0];
        double b = p[0][0] * v[1][1] + v[0][0] * p[1][1] - p[0][1] * v[1][0] - v[0][1] * p[1][0];
        least = fmin(least, first_root(a, b, c));
    }
    return least;
}

/// Move along the direction; the energy after the step, or that of before where no step decreases it.
static double take_step(isometric_problem *problem, double energy, double slope)
{
    double step = fmin(1, STEP_SHARE * longest_step(problem));
    for (int k = 0; k < MAX_HALVINGS; k++, step /= 2)
    {
        memcpy(problem->next, problem->parameters, 2 * problem->point_count * sizeof *problem->next);
        for (size_t n = 0; n < 2 * problem->point_count; n++)
            if (problem->unknown[n] != FIXED)
                problem->next[n] = fmin(fmax(problem->next[n] + step * problem->direction[problem->unknown[n]], 0), 1);
        double reached = energy_of(problem, problem->next);
        if (!(reached <= energy - ARMIJO * step * slope))
            continue;
        double *swap = problem->parameters;
        problem->parameters = problem->next;
        problem->next = swap;
        return reached;
    }
    return energy;
}

static bat_status run_rounds(isometric_problem *problem, bat_progress progress, bat_error *error)
{
    double energy = energy_of(problem, problem->parameters), pivot;
    bat_status status = BAT_OK;
    double *gradient = memory_array(problem->unknowns, sizeof *gradient);
    if (gradient == NULL)
        return error_memory(error, problem->unknowns * sizeof *gradient);
    for (int round = 0; round < MAX_ROUNDS && status == BAT_OK && isfinite(energy); round++)
    {
        if (!progress_goes_on(progress, (double)round / MAX_ROUNDS))
        {
            status = error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped");
            break;
        }
        assemble(problem);
        status = multifrontal_factor(problem->solver, problem->values, NULL, &pivot, error);
        if (status != BAT_OK || !(pivot > 0))
            break;
        memcpy(gradient, problem->direction, problem->unknowns * sizeof *gradient);
        status = multifrontal_solve(problem->solver, 1, problem->direction, error);
        double slope = 0;
        for (size_t c = 0; c < problem->unknowns; c++)
            slope += 2 * gradient[c] * problem->direction[c];
        double reached = status == BAT_OK ? take_step(problem, energy, slope) : energy;
        if (reached > (1 - MIN_DECREASE) * energy)
            break;
        energy = reached;
    }
    free(gradient);
    return status;
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
                              planar_triangles *found, bat_error *error)
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
static bat_status gather_part(const bat_cloud *cloud, const bool *used, const planar_triangles *found, uint32_t *numbers,
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
    planar_triangles found = {0};
    uint32_t *points = memory_array(cloud->count, sizeof *points);
    if (points == NULL)
        return error_memory(error, cloud->count * sizeof *points);
    choose_points(cloud, parameters, used);
    bat_status status = triangulate(cloud, parameters, used, points, &found, error);
    if (status == BAT_OK)
        status = gather_part(cloud, used, &found, points, problem, error);
    planar_triangles_free(&found);
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
    if (a >= boundary || b >= boundary)
        return false;
    return key_map_find(&split->edges, key_of_pair(a, b)) > 1;
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

/// Gather a mesh. An edge between two points of one side of the square would be flat there with all that it cuts off, so
/// that such edges get middles.
static bat_status gather_mesh(const bat_cloud *cloud, const double *parameters, bool *used, isometric_problem *problem,
                              bat_error *error)
{
    bat_cloud *part = &problem->part;
    chord_split split = {.cloud = cloud};
    double turn = 0;
    for (size_t i = 0; i < cloud->boundary_count; i++)
    {
        const double *a = parameters + 2 * i, *b = parameters + 2 * ((i + 1) % cloud->boundary_count);
        turn += a[0] * b[1] - a[1] * b[0];
    }
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

/// Measure the triangles, scaled to the area of the square.
static bat_status measure_triangles(isometric_problem *problem, bat_error *error)
{
    const bat_cloud *part = &problem->part;
    problem->triangle_count = part->triangle_count;
    problem->triangles = memory_array(part->triangle_count, sizeof *problem->triangles);
    if (problem->triangles == NULL)
        return error_memory(error, part->triangle_count * sizeof *problem->triangles);
    double total = 0;
    for (size_t t = 0; t < part->triangle_count; t++)
    {
        const uint32_t *corners = part->triangles + 3 * t;
        memcpy(problem->triangles[t].corners, corners, sizeof problem->triangles[t].corners);
        rest_triangle_make(part->points + 3 * (size_t)corners[0], part->points + 3 * (size_t)corners[1],
                           part->points + 3 * (size_t)corners[2], &problem->triangles[t]);
        total += problem->triangles[t].area;
    }
    double scale = sqrt(total);
    for (size_t t = 0; t < part->triangle_count; t++)
    {
        problem->triangles[t].area /= total;
        for (size_t k = 0; k < 6; k++)
            problem->triangles[t].gradient[k / 2][k % 2] *= scale;
    }
    return BAT_OK;
}

/// Keep the next parameters where they have less energy.
static void keep_better(isometric_problem *problem)
{
    if (energy_of(problem, problem->next) < energy_of(problem, problem->parameters))
        memcpy(problem->parameters, problem->next, 2 * problem->point_count * sizeof *problem->next);
}

/// Even out the parameters by averages over the triangles, which turn no triangle over (Floater, 2003), with weights divided
/// by the stretch (stretch.h). Rounding may prevent this where points crowd; then the given parameters stay.
static bat_status even_out(isometric_problem *problem, average_solver solver, bat_error *error)
{
    sparse_rows rows = {0};
    bat_error failure;
    memcpy(problem->next, problem->parameters, 2 * problem->point_count * sizeof *problem->next);
    bat_status status = weights_of_triangles(&problem->part, &rows, &failure);
    if (status == BAT_OK)
        status = averages_solve(&problem->part, &rows, NULL, solver, problem->next, &failure);
    if (status == BAT_OK)
        keep_better(problem);
    if (status == BAT_OK)
        status = stretch_minimize(&problem->part, &rows, solver, problem->next, &failure);
    sparse_rows_free(&rows);
    if (status == BAT_NO_MEMORY)
        return error_set(error, status, BAT_NO_INDEX, 0, "%s", failure.text);
    if (status == BAT_OK)
        keep_better(problem);
    return BAT_OK;
}

/// Make the matrix and its solver.
static bat_status make_solver(isometric_problem *problem, bat_error *error)
{
    number_unknowns(problem);
    if (problem->unknowns == 0)
        return BAT_OK;
    if (!make_pattern(problem))
        return error_memory(error, problem->triangle_count * sizeof *problem->triangles);
    set_entries(problem);
    problem->values = memory_array((size_t)problem->first[problem->unknowns], sizeof *problem->values);
    problem->direction = memory_array(problem->unknowns, sizeof *problem->direction);
    if (problem->values == NULL || problem->direction == NULL)
        return error_memory(error, problem->unknowns * sizeof *problem->values);
    const symmetric_pattern pattern = {problem->unknowns, problem->first, problem->row};
    return multifrontal_make(&pattern, true, &problem->solver, error);
}

/// @param of_mesh the triangles are those of the cloud; else of a triangulation of the parameters
static bat_status problem_make(const bat_cloud *cloud, const double *parameters, bool of_mesh, average_solver solver,
                               bool *used, isometric_problem *problem, bat_error *error)
{
    memset(used, 0, cloud->count * sizeof *used);
    bat_status status =
        of_mesh ? gather_mesh(cloud, parameters, used, problem, error) : make_part(cloud, parameters, used, problem, error);
    size_t count = problem->part.count;
    if (status != BAT_OK || count == 0)
        return status;
    problem->point_count = count;
    problem->unknown = memory_array(count, 2 * sizeof(int));
    problem->parameters = memory_array(count, 2 * sizeof(double));
    problem->next = memory_array(count, 2 * sizeof(double));
    if (problem->unknown == NULL || problem->parameters == NULL || problem->next == NULL)
        return error_memory(error, count * 2 * sizeof(double));
    for (size_t i = 0; i < count; i++)
        memcpy(problem->parameters + 2 * i,
               problem->members[i] == NEW_POINT ? MIDDLE : parameters + 2 * (size_t)problem->members[i],
               2 * sizeof *parameters);
    status = measure_triangles(problem, error);
    if (status == BAT_OK)
        status = even_out(problem, solver, error);
    return status == BAT_OK ? make_solver(problem, error) : status;
}

/// Move the boundary points that are no corners of triangles: between the nearest ones along the loop that are, in
/// proportion to their former parameters.
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
static bat_status store(const bat_cloud *cloud, const sparse_rows *rows, average_solver solver, bool *used,
                        const isometric_problem *problem, double *parameters, bat_error *error)
{
    size_t others = 0;
    double *before = memory_array(cloud->boundary_count, 2 * sizeof *before);
    if (before == NULL)
        return error_memory(error, cloud->boundary_count * 2 * sizeof *before);
    memcpy(before, parameters, 2 * cloud->boundary_count * sizeof *before);
    for (size_t i = 0; i < problem->point_count; i++)
        if (problem->members[i] != NEW_POINT)
            memcpy(parameters + 2 * (size_t)problem->members[i], problem->parameters + 2 * i, 2 * sizeof *parameters);
    move_boundary(cloud, used, before, parameters);
    free(before);
    for (size_t i = 0; i < cloud->count; i++)
    {
        used[i] = i >= cloud->boundary_count && !used[i];
        others += used[i];
    }
    return others > 0 ? averages_solve(cloud, rows, used, solver, parameters, error) : BAT_OK;
}

/// Whether points crowd so that rounding spoils their triangles.
static bool is_crowded(const isometric_problem *problem)
{
    return problem->triangle_count == 0 || !(energy_of(problem, problem->parameters) < MAX_START);
}

bat_status isometric_minimize(const bat_cloud *cloud, sparse_rows *rows, average_solver solver, double *parameters,
                              bat_error *error)
{
    isometric_problem problem = {0};
    bool *used = memory_array(cloud->count, sizeof *used);
    if (used == NULL)
        return error_memory(error, cloud->count);
    bool of_mesh = cloud->triangle_count > 0 && cloud->count <= MAX_MESH;
    bat_status status = BAT_OK;
    if (of_mesh)
        // Where points crowd, an iteration turns triangles over.
        status = problem_make(cloud, parameters, true, (average_solver){.direct = true, .progress = solver.progress}, used,
                              &problem, error);
    if (status == BAT_OK && of_mesh && !isfinite(energy_of(&problem, problem.parameters)))
    {
        problem_free(&problem);
        problem = (isometric_problem){0};
        of_mesh = false;
    }
    if (status == BAT_OK && !of_mesh)
        status = problem_make(cloud, parameters, false, solver, used, &problem, error);
    if (status == BAT_OK && !of_mesh && is_crowded(&problem))
    {
        problem_free(&problem);
        problem = (isometric_problem){0};
        status = stretch_minimize(cloud, rows, solver, parameters, error);
        if (status == BAT_OK)
            status = problem_make(cloud, parameters, false, solver, used, &problem, error);
    }
    if (status == BAT_OK && problem.solver != NULL)
        status = run_rounds(&problem, solver.progress, error);
    if (status == BAT_OK && problem.solver != NULL)
        status = store(cloud, rows, solver, used, &problem, parameters, error);
    problem_free(&problem);
    free(used);
    return status;
}
