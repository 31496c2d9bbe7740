/// @file
/// Orientation of tangent planes of the points of a shell; see shell.h.
///
/// Where a flood from far away, between balls around the points, leaves an inside, the surface is closed, and each normal
/// leads to the nearer outside. On an open surface all normals are turned so that one sees farther along them.

#include "surface/shell/shell.h"

#include "linalg/vector.h"

#define OUTSIDE_CELLS 200 ///< most cells along the longest side of the grid that finds the outside
#define OUTSIDE_MARGIN 8
#define OUTSIDE_REACH 32 ///< steps
#define SIGHTS 32        ///< directions
#define VOTERS 10        ///< nearest points that a point listens to
#define VOTE_ROUNDS 20

/// Marks of cells: near points, and reached from the border. Others are neither.
#define WALL 1
#define OUTSIDE 2

/// Share of points between the outside and an inside of a closed surface. Closed ones had 0.7 to 1, open ones 0.01.
static const double MIN_INNER = 0.35;
/// Difference of the shares of directions from which one normal is turned.
static const double MIN_SIGHT = 0.25;
/// Least sine between a line of sight and the surface.
static const double MIN_SLOPE = 0.3;
/// Share of its own vote that a point keeps, and what is added to squared distances, in variances of the noise.
static const double OWN_VOTE = 0.2, NOISE_SHARE = 16;
/// Radius of the wall around a point, in its spacings and in cells, and the length of a step through it in cells.
static const double WALL_SPACINGS = 2.5, MIN_WALL = 2.5, MAX_WALL = 8, OUTSIDE_STEP = 0.5;

static size_t mark_index(const shell_outside *grid, const double *point)
{
    size_t at[3];
    for (int d = 0; d < 3; d++)
    {
        double place = (point[d] - grid->origin[d]) / grid->cell;
        at[d] = place < 0 ? 0 : place >= (double)grid->size[d] ? grid->size[d] - 1 : (size_t)place;
    }
    return (at[2] * grid->size[1] + at[1]) * grid->size[0] + at[0];
}

bool shell_is_outside(const shell_outside *outside, const double *place)
{
    return outside->marks[mark_index(outside, place)] == OUTSIDE;
}

/// Mark the cells within a radius of a point, in cells.
static void mark_ball(const shell_outside *grid, const double *point, double radius)
{
    int reach = (int)radius;
    for (int z = -reach; z <= reach; z++)
        for (int y = -reach; y <= reach; y++)
            for (int x = -reach; x <= reach; x++)
                if (x * x + y * y + z * z <= radius * radius)
                {
                    const double at[3] = {point[0] + x * grid->cell, point[1] + y * grid->cell, point[2] + z * grid->cell};
                    grid->marks[mark_index(grid, at)] = WALL;
                }
}

static void flood(const shell_outside *grid, uint32_t *queue)
{
    const size_t *size = grid->size, layer = size[0] * size[1];
    size_t begin = 0, end = 1;
    queue[0] = 0;
    grid->marks[0] = OUTSIDE;
    while (begin < end)
    {
        size_t cell = queue[begin++], at[3] = {cell % size[0], cell / size[0] % size[1], cell / layer};
        const size_t step[3] = {1, size[0], layer};
        for (int d = 0; d < 3; d++)
            for (int side = 0; side < 2; side++)
            {
                if (side == 0 ? at[d] == 0 : at[d] + 1 == size[d])
                    continue;
                size_t next = side == 0 ? cell - step[d] : cell + step[d];
                if (grid->marks[next] != 0)
                    continue;
                grid->marks[next] = OUTSIDE;
                queue[end++] = (uint32_t)next;
            }
    }
}

/// What a walk from a point along a direction meets first beyond the wall.
typedef struct outside_walk
{
    int steps;   ///< to the outside; OUTSIDE_REACH where it is farther
    bool inside; ///< it meets a cell that is neither wall nor outside first
} outside_walk;

static outside_walk walk_outside(const shell_outside *grid, const double *point, const double *direction, double sign)
{
    outside_walk walk = {OUTSIDE_REACH, false};
    for (int k = 1; k < OUTSIDE_REACH && walk.steps == OUTSIDE_REACH; k++)
    {
        double at[3];
        for (int d = 0; d < 3; d++)
            at[d] = point[d] + sign * k * OUTSIDE_STEP * grid->cell * direction[d];
        uint8_t mark = grid->marks[mark_index(grid, at)];
        walk.inside = walk.inside || mark == 0;
        if (mark == OUTSIDE)
            walk.steps = k;
    }
    return walk;
}

/// Mark the wall around the points, and the outside.
static bat_status outside_make(const shell_cloud *cloud, shell_outside *grid, memory_pool *pool, bat_error *error)
{
    const double *low = nearest_bounds(cloud->tree), *high = low + 3;
    double extent = fmax(fmax(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
    size_t cells = 1;
    grid->cell = fmax(cloud->spacing, extent / OUTSIDE_CELLS);
    for (int d = 0; d < 3; d++)
    {
        grid->origin[d] = low[d] - OUTSIDE_MARGIN * grid->cell;
        grid->size[d] = (size_t)((high[d] - low[d]) / grid->cell) + 2 * OUTSIDE_MARGIN + 1;
        cells *= grid->size[d];
    }
    grid->marks = memory_pool_zeros(pool, cells, sizeof *grid->marks);
    uint32_t *queue = memory_pool_array(pool, cells, sizeof *queue);
    bat_status status = memory_pool_check(pool, error);
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
        mark_ball(grid, cloud->points + 3 * i,
                  fmin(fmax(WALL_SPACINGS * sqrt(cloud->areas[i]) / grid->cell, MIN_WALL), MAX_WALL));
    if (status == BAT_OK)
        flood(grid, queue);
    return status;
}

/// The share of directions in which one sees far from a point, in the half-space of a normal, less that in the other one.
static double sight_of(const shell_outside *grid, const double *point, const double normal[3])
{
    double sum = 0;
    for (int k = 0; k < SIGHTS; k++)
    {
        // Directions of Fibonacci's lattice on the sphere.
        double z = 1 - (2 * k + 1.0) / SIGHTS, radius = sqrt(1 - z * z), turn = 2.399963229728653 * k;
        const double direction[3] = {radius * cos(turn), radius * sin(turn), z};
        double slope = vector3_dot(direction, normal);
        bool free = true;
        if (fabs(slope) < MIN_SLOPE)
            continue;
        for (double step = 2 * MIN_WALL / fabs(slope); free; step++)
        {
            double at[3];
            bool inside = true;
            for (int d = 0; d < 3; d++)
            {
                at[d] = point[d] + step * grid->cell * direction[d];
                inside = inside && at[d] > grid->origin[d] && at[d] < grid->origin[d] + grid->cell * (double)grid->size[d];
            }
            if (!inside)
                break;
            free = grid->marks[mark_index(grid, at)] != WALL;
        }
        sum += free ? (slope > 0 ? 1 : -1) : 0;
    }
    return 2 * sum / SIGHTS;
}

/// Let votes follow neighbours. On an arc, one normal is the other, mirrored at the plane between the points (König and
/// Gumhold, "Consistent propagation of normal orientations", 2009); so it is on facing sheets of thin parts and gaps.
static bat_status share_votes(const shell_cloud *cloud, const oriented_planes *planes, memory_pool *pool, float *votes,
                              bat_error *error)
{
    neighbour_list near = {0};
    float *own = memory_pool_array(pool, cloud->count, sizeof *own);
    float *weights = memory_pool_zeros(pool, cloud->count, VOTERS * sizeof *weights);
    uint32_t *voters = memory_pool_zeros(pool, cloud->count, VOTERS * sizeof *voters);
    bat_status status = memory_pool_check(pool, error);
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
    {
        const double *normal = planes->planes[i].axes[2];
        double sum = 0, products[VOTERS] = {0}, arm[3];
        own[i] = votes[i];
        status = neighbours_nearest(cloud->tree, cloud->points + 3 * i, VOTERS + 1, &near, error);
        for (size_t k = 0; k < near.count && k < VOTERS && status == BAT_OK; k++)
        {
            uint32_t other = voters[VOTERS * i + k] = near.entries[near.count - 1 - k].item;
            const double *second = planes->planes[other].axes[2];
            vector3_subtract(cloud->points + 3 * (size_t)other, cloud->points + 3 * i, arm);
            double square = vector3_dot(arm, arm) + NOISE_SHARE * cloud->noise * cloud->noise;
            products[k] =
                pow(vector3_dot(normal, second) - 2 * vector3_dot(normal, arm) * vector3_dot(second, arm) / square, 3);
            sum += fabs(products[k]);
        }
        for (size_t k = 0; k < VOTERS && sum > 0; k++)
            weights[VOTERS * i + k] = (float)(products[k] / sum);
    }
    neighbour_list_free(&near);
    for (size_t k = 0; k < VOTE_ROUNDS * cloud->count && status == BAT_OK; k++)
    {
        size_t i = k % cloud->count;
        float sum = 0;
        for (size_t m = VOTERS * i; m < VOTERS * (i + 1); m++)
            sum += weights[m] * votes[voters[m]];
        votes[i] = (float)OWN_VOTE * own[i] + (float)(1 - OWN_VOTE) * sum;
    }
    return status;
}

bat_status shell_orient(const shell_cloud *cloud, oriented_planes *planes, memory_pool *pool, shell_outside *outside,
                        bat_error *error)
{
    size_t inner = 0;
    double sum = 0;
    float *votes = memory_pool_zeros(pool, cloud->count, sizeof *votes);
    bat_status status = outside_make(cloud, outside, pool, error);
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
    {
        const double *point = cloud->points + 3 * i, *normal = planes->planes[i].axes[2];
        outside_walk ahead = walk_outside(outside, point, normal, 1), behind = walk_outside(outside, point, normal, -1);
        votes[i] = (float)(behind.steps - ahead.steps) / OUTSIDE_REACH;
        inner += votes[i] != 0 && (votes[i] > 0 ? behind : ahead).inside;
    }
    outside->closed = (double)inner > MIN_INNER * (double)cloud->count;
    for (size_t i = 0; i < cloud->count && status == BAT_OK && !outside->closed; i++)
        votes[i] = (float)sight_of(outside, cloud->points + 3 * i, planes->planes[i].axes[2]);
    if (status == BAT_OK && outside->closed)
        status = share_votes(cloud, planes, pool, votes, error);
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
        sum += votes[i];
    // Normals of open surfaces are turned alone only where they are not all alike.
    double least = outside->closed ? 0 : planes->conflicts > 0 ? MIN_SIGHT : INFINITY;
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
        for (int d = 0; d < 3 && (fabsf(votes[i]) > least ? votes[i] < 0 : sum < 0); d++)
            planes->planes[i].axes[2][d] *= -1;
    return status;
}
