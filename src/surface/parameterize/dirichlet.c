/// @file
/// Symmetric Dirichlet energy by reweighted least squares: scalable locally injective mappings (Rabinovich, Poranne, Panozzo
/// and Sorkine-Hornung, 2017); see weights.h.
///
/// In a round, each triangle with derivative J = U diag(s_1, s_2) V^T has the proxy energy
///     |W (J' - R)|^2,   R = U V^T,   W = U diag(w_1, w_2) U^T,   w_i^2 = (s_i - s_i^-3) / (s_i - 1),
/// whose gradient at J is that of the symmetric Dirichlet energy. The minimizer of the sum is a direction of descent. The
/// step along it ends before the first triangle degenerates.
///
/// Where points crowd by many orders of magnitude, these rounds stop early. Then other triangles are taken first, between
/// those in space and their parameters (Liu, Ye, Ni and Fu, "Progressive parameterizations", 2018). There the power t of
/// U diag(s)^t V^T is the same for all triangles; here each has its own. Areas remain those in space, so that crowded parts
/// are as heavy as others and spread.

#include "surface/parameterize/weights.h"

#include "base/progress.h"
#include "linalg/vector.h"

#include <string.h>

enum
{
    MAX_ROUNDS = 40,
    MAX_NEAR_ROUNDS = 200,
    MAX_HALVINGS = 24,
    POWER_STEPS = 20 ///< bisections for a power
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
/// Energy from which triangles are brought near.
static const double MAX_ENERGY = 30;
/// Largest energy density of a triangle that is brought near; 4 is that of an isometric map.
static const double MAX_DENSITY = 8;
/// Rounds with such triangles end when the energy decreases by less than this share.
static const double MIN_NEAR_DECREASE = 1e-4;
/// Limit of the weights of the proxy.
static const double MAX_WEIGHT = 1e8;
/// Stands for a coordinate that does not move.
static const int FIXED = -1;

void dirichlet_free(dirichlet_map *map)
{
    memory_pool_free(&map->pool);
    multifrontal_free(map->solver);
    *map = (dirichlet_map){0};
}

static void measure_triangle(const double *a, const double *b, const double *c, dirichlet_triangle *made)
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

bat_status dirichlet_measure(const double *points, const uint32_t *triangles, size_t triangle_count, dirichlet_map *map,
                             bat_error *error)
{
    map->triangle_count = triangle_count;
    map->triangles = memory_pool_array(&map->pool, triangle_count, sizeof *map->triangles);
    if (map->triangles == NULL)
        return memory_pool_check(&map->pool, error);
    double total = 0;
    for (size_t t = 0; t < triangle_count; t++)
    {
        const uint32_t *corners = triangles + 3 * t;
        memcpy(map->triangles[t].corners, corners, sizeof map->triangles[t].corners);
        measure_triangle(points + 3 * (size_t)corners[0], points + 3 * (size_t)corners[1], points + 3 * (size_t)corners[2],
                         &map->triangles[t]);
        total += map->triangles[t].area;
    }
    double scale = sqrt(total);
    for (size_t t = 0; t < triangle_count; t++)
    {
        map->triangles[t].area /= total;
        for (size_t k = 0; k < 6; k++)
            map->triangles[t].gradient[k / 2][k % 2] *= scale;
    }
    return BAT_OK;
}

/// The map's derivative: rows are coordinates of parameters.
static void derivative_of(const dirichlet_triangle *triangle, const double *parameters, double derivative[4])
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
double dirichlet_energy(const dirichlet_map *map, const double *parameters)
{
    double sum = 0;
    for (size_t t = 0; t < map->triangle_count; t++)
    {
        double j[4];
        derivative_of(&map->triangles[t], parameters, j);
        double square = j[0] * j[0] + j[1] * j[1] + j[2] * j[2] + j[3] * j[3], det = j[0] * j[3] - j[1] * j[2];
        if (!(det > 0))
            return INFINITY;
        sum += map->triangles[t].area * square * (1 + 1 / (det * det));
    }
    return sum;
}

/// J = U diag(s) V^T for a positive determinant: Blinn, "Consider the lowly 2 x 2 matrix" (1996).
/// @param moduli their sum and their difference are the singular values
/// @param angles their half sum is the angle of U; half of the second minus the first is that of V
static void split_derivative(const double j[4], double moduli[2], double angles[2])
{
    double e = (j[0] + j[3]) / 2, f = (j[0] - j[3]) / 2, g = (j[2] + j[1]) / 2, h = (j[2] - j[1]) / 2;
    moduli[0] = hypot(e, h);
    moduli[1] = hypot(f, g);
    angles[0] = atan2(h, e);
    angles[1] = atan2(g, f);
}

/// W^2 = U diag(w^2) U^T and R = U V^T.
static void proxy_of(const double j[4], double weight[4], double rotation[4])
{
    double moduli[2], angles[2], w[2];
    split_derivative(j, moduli, angles);
    double s[2] = {moduli[0] + moduli[1], fmax(moduli[0] - moduli[1], 1e-300)};
    double beta = (angles[0] + angles[1]) / 2, turn = angles[0], c = cos(beta), d = sin(beta);
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

/// The unknowns of a triangle: coordinate a % 2 of corner a / 2.
static int unknown_of(const dirichlet_map *map, const dirichlet_triangle *triangle, int a)
{
    return map->unknown[2 * (size_t)triangle->corners[a / 2] + (size_t)(a % 2)];
}

/// The lower triangle of the pattern by columns.
static bat_status make_pattern(dirichlet_map *map, bat_error *error)
{
    size_t columns = map->unknowns;
    int *fill = memory_pool_zeros(&map->pool, columns + 1, sizeof *fill);
    map->first = memory_pool_zeros(&map->pool, columns + 1, sizeof *map->first);
    map->row = memory_pool_array(&map->pool, map->triangle_count, DIRICHLET_ENTRIES * sizeof *map->row);
    bat_status status = memory_pool_check(&map->pool, error);
    if (status != BAT_OK)
        return status;
    for (int pass = 0; pass < 2; pass++)
    {
        for (size_t t = 0; t < map->triangle_count; t++)
            for (int a = 0; a < DIRICHLET_UNKNOWNS; a++)
                for (int b = 0; b <= a; b++)
                {
                    int p = unknown_of(map, &map->triangles[t], a), q = unknown_of(map, &map->triangles[t], b);
                    if (p == FIXED || q == FIXED)
                        continue;
                    int low = p < q ? p : q, high = p < q ? q : p;
                    if (pass == 0)
                        fill[low]++;
                    else
                        map->row[fill[low]++] = high;
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
        qsort(map->row + begin, (size_t)(end - begin), sizeof *map->row, ascending_int);
        map->first[c] = made;
        for (int k = begin; k < end; k++)
            if (k == begin || map->row[k] != map->row[k - 1])
                map->row[made++] = map->row[k];
        begin = end;
    }
    map->first[columns] = made;
    return BAT_OK;
}

static void set_entries(dirichlet_map *map)
{
    for (size_t t = 0; t < map->triangle_count; t++)
    {
        dirichlet_triangle *triangle = &map->triangles[t];
        int *entry = triangle->entries;
        for (int a = 0; a < DIRICHLET_UNKNOWNS; a++)
            for (int b = 0; b <= a; b++)
            {
                int p = unknown_of(map, triangle, a), q = unknown_of(map, triangle, b);
                bool stays = p == FIXED || q == FIXED;
                *entry++ = stays ? FIXED : (int)symmetric_pattern_find(map->first, map->row, (size_t)p, (size_t)q);
            }
    }
}

/// Number the coordinates that move: a boundary point has none at a corner of the square, and one along a side.
static void number_unknowns(dirichlet_map *map)
{
    for (size_t i = 0; i < map->point_count; i++)
    {
        const double *u = map->parameters + 2 * i;
        bool on[2] = {u[0] == 0 || u[0] == 1, u[1] == 0 || u[1] == 1};
        for (size_t d = 0; d < 2; d++)
        {
            bool boundary = i < map->boundary_count, stays = boundary && (on[d] || !on[1 - d]);
            map->unknown[2 * i + d] = stays ? FIXED : (int)map->unknowns++;
        }
    }
}

bat_status dirichlet_prepare(dirichlet_map *map, bat_error *error)
{
    map->unknown = memory_pool_array(&map->pool, map->point_count, 2 * sizeof *map->unknown);
    if (map->unknown == NULL)
        return memory_pool_check(&map->pool, error);
    number_unknowns(map);
    if (map->unknowns == 0)
        return BAT_OK;
    bat_status status = make_pattern(map, error);
    if (status != BAT_OK)
        return status;
    set_entries(map);
    map->values = memory_pool_array(&map->pool, (size_t)map->first[map->unknowns], sizeof *map->values);
    map->direction = memory_pool_array(&map->pool, map->unknowns, sizeof *map->direction);
    status = memory_pool_check(&map->pool, error);
    if (status != BAT_OK)
        return status;
    const symmetric_pattern pattern = {map->unknowns, map->first, map->row};
    return multifrontal_make(&pattern, true, &map->solver, error);
}

// Rounds

/// Assemble the proxy's matrix and minus its gradient.
static void assemble(dirichlet_map *map)
{
    memset(map->values, 0, (size_t)map->first[map->unknowns] * sizeof *map->values);
    memset(map->direction, 0, map->unknowns * sizeof *map->direction);
    for (size_t t = 0; t < map->triangle_count; t++)
    {
        const dirichlet_triangle *triangle = &map->triangles[t];
        double j[4], weight[4], rotation[4], pull[4];
        derivative_of(triangle, map->parameters, j);
        proxy_of(j, weight, rotation);
        for (int e = 0; e < 4; e++)
            pull[e] = weight[e / 2 * 2] * (rotation[e % 2] - j[e % 2]) +
                      weight[e / 2 * 2 + 1] * (rotation[2 + e % 2] - j[2 + e % 2]);
        const int *entry = triangle->entries;
        for (int a = 0; a < DIRICHLET_UNKNOWNS; a++)
        {
            const double *at = triangle->gradient[a / 2];
            int p = unknown_of(map, triangle, a);
            if (p != FIXED)
                map->direction[p] += triangle->area * (pull[a % 2 * 2] * at[0] + pull[a % 2 * 2 + 1] * at[1]);
            for (int b = 0; b <= a; b++, entry++)
            {
                const double *other = triangle->gradient[b / 2];
                if (*entry != FIXED)
                    map->values[*entry] +=
                        triangle->area * weight[a % 2 * 2 + b % 2] * (at[0] * other[0] + at[1] * other[1]);
            }
        }
    }
    double mean = 0;
    for (size_t c = 0; c < map->unknowns; c++)
        mean += map->values[map->first[c]] / (double)map->unknowns;
    for (size_t c = 0; c < map->unknowns; c++)
        map->values[map->first[c]] += PROXIMAL * mean;
}

static double direction_at(const dirichlet_map *map, uint32_t point, size_t d)
{
    int unknown = map->unknown[2 * (size_t)point + d];
    return unknown == FIXED ? 0 : map->direction[unknown];
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
static double longest_step(const dirichlet_map *map)
{
    double least = INFINITY;
    for (size_t t = 0; t < map->triangle_count; t++)
    {
        const uint32_t *corners = map->triangles[t].corners;
        double p[2][2], v[2][2];
        for (size_t k = 0; k < 2; k++)
            for (size_t d = 0; d < 2; d++)
            {
                p[k][d] = map->parameters[2 * (size_t)corners[k + 1] + d] - map->parameters[2 * (size_t)corners[0] + d];
                v[k][d] = direction_at(map, corners[k + 1], d) - direction_at(map, corners[0], d);
            }
        double a = p[0][0] * p[1][1] - p[0][1] * p[1][0], c = v[0][0] * v[1][1] - v[0][1] * v[1][0];
        double b = p[0][0] * v[1][1] + v[0][0] * p[1][1] - p[0][1] * v[1][0] - v[0][1] * p[1][0];
        least = fmin(least, first_root(a, b, c));
    }
    return least;
}

/// Move along the direction; the energy after the step, or that of before where no step decreases it.
static double take_step(dirichlet_map *map, double energy, double slope)
{
    double step = fmin(1, STEP_SHARE * longest_step(map));
    for (int k = 0; k < MAX_HALVINGS; k++, step /= 2)
    {
        memcpy(map->next, map->parameters, 2 * map->point_count * sizeof *map->next);
        for (size_t n = 0; n < 2 * map->point_count; n++)
            if (map->unknown[n] != FIXED)
                map->next[n] = fmin(fmax(map->next[n] + step * map->direction[map->unknown[n]], 0), 1);
        double reached = dirichlet_energy(map, map->next);
        if (!(reached <= energy - ARMIJO * step * slope))
            continue;
        SWAP(map->parameters, map->next);
        return reached;
    }
    return energy;
}

/// One round: a step that decreases the energy, where there is one.
/// @param gradient room for the unknowns
/// @param reached  receives the energy after it
static bat_status run_round(dirichlet_map *map, double *gradient, double energy, double *reached, bat_error *error)
{
    double pivot;
    *reached = energy;
    assemble(map);
    bat_status status = multifrontal_factor(map->solver, map->values, NULL, &pivot, error);
    if (status != BAT_OK || !(pivot > 0))
        return status;
    memcpy(gradient, map->direction, map->unknowns * sizeof *gradient);
    status = multifrontal_solve(map->solver, 1, map->direction, error);
    double slope = 2 * vector_dot(map->unknowns, gradient, map->direction);
    if (status == BAT_OK)
        *reached = take_step(map, energy, slope);
    return status;
}

/// Rounds from the triangles in space.
static bat_status run_rounds(dirichlet_map *map, bat_progress progress, double *gradient, bat_error *error)
{
    double energy = dirichlet_energy(map, map->parameters);
    for (int round = 0; round < MAX_ROUNDS && isfinite(energy); round++)
    {
        double reached;
        bat_status status = progress_check(progress, (double)round / MAX_ROUNDS, error);
        if (status == BAT_OK)
            status = run_round(map, gradient, energy, &reached, error);
        if (status != BAT_OK || reached > (1 - MIN_DECREASE) * energy)
            return status;
        energy = reached;
    }
    return BAT_OK;
}

// Rounds from triangles that are near to their parameters

/// The singular values of a derivative with a positive determinant, and the angle of the rotation V in J = U diag(s) V^T.
static double singular_values(const double j[4], double s[2])
{
    double moduli[2], angles[2];
    split_derivative(j, moduli, angles);
    s[0] = moduli[0] + moduli[1];
    // The difference of both moduli loses all digits where the second value is small.
    s[1] = (j[0] * j[3] - j[1] * j[2]) / s[0];
    return (angles[1] - angles[0]) / 2;
}

/// The energy of a triangle of unit area with a power of the singular values.
static double density_of(const double s[2], double power)
{
    double a = pow(s[0], 2 * power), b = pow(s[1], 2 * power);
    return a + 1 / a + b + 1 / b;
}

/// The largest power up to 1 whose density is bounded.
static double bounded_power(const double s[2])
{
    double low = 0, high = 1;
    if (density_of(s, 1) <= MAX_DENSITY)
        return 1;
    for (int step = 0; step < POWER_STEPS; step++)
    {
        double middle = (low + high) / 2;
        *(density_of(s, middle) <= MAX_DENSITY ? &low : &high) = middle;
    }
    return low;
}

/// Replace triangles by ones between those in space and in parameters, derivatives U diag(s)^t V^T, of bounded density.
/// @param rest triangle_count, in space
/// @return whether some are others than in space
static bool bring_near(dirichlet_map *map, const dirichlet_triangle *rest)
{
    bool replaced = false;
    for (size_t t = 0; t < map->triangle_count; t++)
    {
        dirichlet_triangle *triangle = &map->triangles[t];
        double j[4], s[2];
        derivative_of(&rest[t], map->parameters, j);
        double angle = singular_values(j, s), power = bounded_power(s);
        replaced = replaced || power < 1;
        double a = pow(s[0], power - 1), b = pow(s[1], power - 1), c = cos(angle), d = sin(angle);
        double uu = a * c * c + b * d * d, uv = (a - b) * c * d, vv = a * d * d + b * c * c;
        for (int k = 0; k < 3; k++)
        {
            const double *gradient = rest[t].gradient[k];
            triangle->gradient[k][0] = uu * gradient[0] + uv * gradient[1];
            triangle->gradient[k][1] = uv * gradient[0] + vv * gradient[1];
        }
    }
    return replaced;
}

/// Rounds that bring the triangles near before each, until they are those in space or nothing is gained.
static bat_status run_near_rounds(dirichlet_map *map, bat_progress progress, double *gradient, bat_error *error)
{
    size_t bytes = map->triangle_count * sizeof *map->triangles;
    dirichlet_triangle *rest = memory_array(map->triangle_count, sizeof *rest);
    if (rest == NULL)
        return error_memory(error, bytes);
    memcpy(rest, map->triangles, bytes);
    bat_status status = BAT_OK;
    bool gains = true;
    for (int round = 0; round < MAX_NEAR_ROUNDS && status == BAT_OK && gains && bring_near(map, rest); round++)
    {
        double energy = dirichlet_energy(map, map->parameters), reached = energy;
        status = progress_check(progress, (double)round / MAX_NEAR_ROUNDS, error);
        if (status == BAT_OK)
            status = run_round(map, gradient, energy, &reached, error);
        gains = status == BAT_OK && reached < (1 - MIN_NEAR_DECREASE) * energy;
    }
    memcpy(map->triangles, rest, bytes);
    free(rest);
    return status;
}

bat_status dirichlet_minimize(dirichlet_map *map, bat_progress progress, bat_error *error)
{
    double *gradient = memory_array(map->unknowns, sizeof *gradient);
    if (gradient == NULL)
        return error_memory(error, map->unknowns * sizeof *gradient);
    bat_status status = run_rounds(map, progress, gradient, error);
    double energy = dirichlet_energy(map, map->parameters);
    if (status == BAT_OK && energy > MAX_ENERGY && isfinite(energy))
    {
        status = run_near_rounds(map, progress, gradient, error);
        if (status == BAT_OK)
            status = run_rounds(map, progress, gradient, error);
    }
    free(gradient);
    return status;
}
