#include "research/shapes/map_land.h"

#include "base/array_grow.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

enum
{
    WAVES = 96 ///< of the field whose high values are land
};

/// A plane wave in space, taken on the sphere.
typedef struct land_wave
{
    double vector[3], phase, amplitude;
} land_wave;

/// The numbers of what a map has, beside its base countries and the one over the pole.
typedef struct land_plan
{
    size_t base;              ///< countries that grow from seeds
    size_t enclave_cells;     ///< enclaves that fill a cell
    size_t enclave_spots;     ///< smaller ones
    size_t island_countries;  ///< countries of small islands far from land
    size_t lake_cells, lakes; ///< lakes that fill a cell, and smaller ones
} land_plan;

/// What the stages share.
typedef struct land_maker
{
    const map_grid *grid;
    map_land *land;
    bat_random *random;
    land_plan plan;
    double *values;  ///< for each cell: the field, later the distance to the seed of its owner
    uint32_t *order; ///< the cells in random order
} land_maker;

size_t map_land_frequency(size_t countries)
{
    static const double CELLS = 20;
    enum
    {
        LEAST = 16 ///< finer than the strips of sea and land around the poles
    };
    size_t frequency = (size_t)ceil(sqrt(CELLS * (double)countries / 10));
    return frequency < LEAST ? LEAST : frequency;
}

static size_t at_least(size_t number, size_t least)
{
    return number < least ? least : number;
}

static land_plan make_plan(size_t countries, size_t *splits)
{
    *splits = at_least(countries / 16, 2);
    land_plan plan = {.enclave_cells = at_least(countries / 50, 2),
                      .enclave_spots = at_least(countries / 100, 1),
                      .island_countries = at_least(countries / 40, 1),
                      .lake_cells = at_least(countries / 25, 2),
                      .lakes = at_least(countries / 16, 2)};
    plan.base = countries - 1 - plan.enclave_cells - plan.enclave_spots - plan.island_countries - *splits;
    return plan;
}

static uint32_t add_feature(map_land *land, map_kind kind)
{
    void *kinds = land->kinds;
    bool grown = array_grow(&kinds, &land->feature_capacity, land->feature_count + 1, sizeof *land->kinds);
    land->kinds = kinds;
    land->failed = land->failed || !grown;
    if (!grown)
        return 0;
    land->kinds[land->feature_count] = kind;
    return (uint32_t)land->feature_count++;
}

static size_t random_below(bat_random *random, size_t limit)
{
    return (size_t)(bat_random_uniform(random) * (double)limit);
}

static double distance(const double *a, const double *b)
{
    double square = 0;
    for (int k = 0; k < 3; k++)
        square += (a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(square);
}

/// A random field on the sphere with mean 0 and variance 1, whose amplitudes fall with the wave number.
static void make_waves(bat_random *random, land_wave waves[WAVES])
{
    static const double LONGEST = 3, SHORTEST = 30, DECAY = 1;
    double variance = 0;
    for (size_t i = 0; i < WAVES; i++)
    {
        double number = LONGEST * pow(SHORTEST / LONGEST, (double)i / (WAVES - 1));
        double z = 2 * bat_random_uniform(random) - 1, turn = 2 * PI * bat_random_uniform(random);
        double across = sqrt(1 - z * z);
        waves[i] = (land_wave){{number * across * cos(turn), number * across * sin(turn), number * z},
                               2 * PI * bat_random_uniform(random),
                               pow(number, -DECAY)};
        variance += waves[i].amplitude * waves[i].amplitude / 2;
    }
    for (size_t i = 0; i < WAVES; i++)
        waves[i].amplitude /= sqrt(variance);
}

static double field_at(const land_wave waves[WAVES], const double *point)
{
    double sum = 0;
    for (size_t i = 0; i < WAVES; i++)
    {
        const double *v = waves[i].vector;
        sum += waves[i].amplitude * cos(v[0] * point[0] + v[1] * point[1] + v[2] * point[2] + waves[i].phase);
    }
    return sum;
}

static int compare_numbers(const void *a, const void *b)
{
    const double *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

/// Latitudes that do not follow the field alone: a continent around the south pole, sea around it and at the north pole.
static bool is_land(double latitude, double value, double level)
{
    static const double CAP = -75, COAST = -63, STRAIT = -57, NORTH = 78;
    if (latitude < CAP)
        return true;
    if (latitude < COAST)
        return value + 4.5 * (COAST - latitude) / (COAST - CAP) - 2 > level;
    return latitude > STRAIT && latitude < NORTH && value > level;
}

/// Mark land with feature 0, and give the sea to no one.
static bool raise_land(land_maker *maker)
{
    static const double LAND = 0.31;
    size_t count = maker->grid->cell_count;
    land_wave waves[WAVES];
    double *sorted = memory_array(count, sizeof *sorted);
    if (sorted == NULL)
        return false;
    make_waves(maker->random, waves);
    for (size_t i = 0; i < count; i++)
        sorted[i] = maker->values[i] = field_at(waves, maker->grid->cells[i].point);
    qsort(sorted, count, sizeof *sorted, compare_numbers);
    double level = sorted[(size_t)((1 - LAND) * (double)count)];
    for (size_t i = 0; i < count; i++)
        maker->land->plots[i] =
            (map_plot){.owner = is_land(maker->grid->cells[i].latitude, maker->values[i], level) ? 0 : MAP_SEA};
    free(sorted);
    return true;
}

static void shuffle(land_maker *maker)
{
    size_t count = maker->grid->cell_count;
    for (size_t i = 0; i < count; i++)
        maker->order[i] = (uint32_t)i;
    for (size_t i = count; i > 1; i--)
    {
        size_t other = random_below(maker->random, i);
        uint32_t kept = maker->order[i - 1];
        maker->order[i - 1] = maker->order[other];
        maker->order[other] = kept;
    }
}

/// Whether a cell belongs to the continent around the south pole.
static bool is_polar(const map_cell *cell)
{
    static const double BOUND = -60;
    return cell->latitude < BOUND;
}

/// Whether a cell is land that is open to countries.
static bool is_free(const land_maker *maker, size_t cell)
{
    return maker->land->plots[cell].owner != MAP_SEA && !is_polar(&maker->grid->cells[cell]);
}

/// The distance from a cell to the nearest of some cells; 4 without any.
static double nearest_distance(const map_grid *grid, size_t cell, const uint32_t *others, size_t count)
{
    double nearest = 4;
    for (size_t i = 0; i < count; i++)
        nearest = fmin(nearest, distance(grid->cells[cell].point, grid->cells[others[i]].point));
    return nearest;
}

/// Choose a land cell for each base country: of the next few in random order the farthest from the cells chosen before.
/// Returns their number, which is less where there is less land.
static size_t choose_seeds(const land_maker *maker, size_t count, uint32_t *seeds)
{
    enum
    {
        TRIES = 3
    };
    size_t chosen = 0, total = maker->grid->cell_count, passed = 0;
    for (size_t at = 0; chosen < count && passed < total;)
    {
        double farthest = 0;
        for (size_t tries = 0; tries < TRIES && passed < total; passed++, at = (at + 1) % total)
        {
            uint32_t cell = maker->order[at];
            double nearest = is_free(maker, cell) ? nearest_distance(maker->grid, cell, seeds, chosen) : 0;
            if (nearest > farthest)
            {
                seeds[chosen] = cell;
                farthest = nearest;
            }
            tries += nearest > 0;
        }
        if (farthest > 0)
        {
            chosen++;
            passed = 0;
        }
    }
    return chosen;
}

/// The cost of growing from one cell to its neighbour, the same in both directions.
static double step_cost(const map_grid *grid, size_t a, size_t b, const double *costs)
{
    return distance(grid->cells[a].point, grid->cells[b].point) * (costs[a] + costs[b]);
}

/// Give every land cell to the seed with the cheapest way over land, and islands to the nearest seed.
static void grow_countries(land_maker *maker, const uint32_t *seeds, size_t seed_count, const double *costs)
{
    const map_grid *grid = maker->grid;
    map_plot *plots = maker->land->plots;
    for (size_t i = 0; i < grid->cell_count; i++)
        maker->values[i] = INFINITY;
    for (size_t i = 0; i < seed_count; i++)
    {
        plots[seeds[i]].owner = add_feature(maker->land, MAP_COUNTRY);
        maker->values[seeds[i]] = 0.4 * bat_random_uniform(maker->random) * sqrt(4 * PI / (double)grid->cell_count);
    }
    for (bool changed = true; changed;)
    {
        changed = false;
        for (size_t i = 0; i < grid->cell_count; i++)
            for (size_t k = 0; is_free(maker, i) && k < grid->cells[i].degree; k++)
            {
                uint32_t from = grid->cells[i].neighbours[k];
                double cost = maker->values[from] + step_cost(grid, i, from, costs);
                if (is_free(maker, from) && cost < maker->values[i])
                {
                    maker->values[i] = cost;
                    plots[i].owner = plots[from].owner;
                    changed = true;
                }
            }
    }
    for (size_t i = 0; i < grid->cell_count; i++)
    {
        double nearest = INFINITY; // of an island without a seed
        for (size_t s = 0; is_free(maker, i) && maker->values[i] == INFINITY && s < seed_count; s++)
            if (distance(grid->cells[i].point, grid->cells[seeds[s]].point) < nearest)
            {
                nearest = distance(grid->cells[i].point, grid->cells[seeds[s]].point);
                plots[i].owner = plots[seeds[s]].owner;
            }
    }
}

static bool make_countries(land_maker *maker)
{
    size_t count = maker->grid->cell_count;
    uint32_t *seeds = memory_array(maker->plan.base, sizeof *seeds);
    double *costs = memory_array(count, sizeof *costs);
    if (seeds != NULL && costs != NULL)
    {
        shuffle(maker);
        for (size_t i = 0; i < count; i++)
            costs[i] = 0.3 + bat_random_uniform(maker->random);
        size_t chosen = choose_seeds(maker, maker->plan.base, seeds);
        grow_countries(maker, seeds, chosen, costs);
    }
    bool made = seeds != NULL && costs != NULL;
    free(seeds);
    free(costs);
    return made;
}

/// Whether a cell and all its neighbours belong to countries and have no spots; `one`: they belong to one country.
static bool is_inland(const land_maker *maker, size_t cell, bool one)
{
    const map_land *land = maker->land;
    const map_cell *at = &maker->grid->cells[cell];
    uint32_t owner = land->plots[cell].owner;
    if (!is_free(maker, cell) || land->kinds[owner] != MAP_COUNTRY || land->plots[cell].spot != MAP_SPOT_NONE)
        return false;
    for (size_t k = 0; k < at->degree; k++)
    {
        const map_plot *plot = &land->plots[at->neighbours[k]];
        if (!is_free(maker, at->neighbours[k]) || land->kinds[plot->owner] != MAP_COUNTRY || plot->spot != MAP_SPOT_NONE ||
            (one && plot->owner != owner))
            return false;
    }
    return true;
}

static size_t count_cells(const land_maker *maker, uint32_t owner)
{
    size_t count = 0;
    for (size_t i = 0; i < maker->grid->cell_count; i++)
        count += maker->land->plots[i].owner == owner;
    return count;
}

/// Turn whole cells into lakes or enclaves. Returns the number.
static size_t make_cells(land_maker *maker, size_t wanted, map_kind kind)
{
    enum
    {
        LEFT = 3 ///< cells that a country keeps
    };
    size_t made = 0;
    for (size_t i = 0; i < maker->grid->cell_count && made < wanted; i++)
    {
        uint32_t cell = maker->order[i];
        map_plot *plot = &maker->land->plots[cell];
        if (!is_inland(maker, cell, kind == MAP_ENCLAVE) || count_cells(maker, plot->owner) <= LEFT)
            continue;
        uint32_t host = plot->owner;
        plot->owner = add_feature(maker->land, kind);
        // Every other lake of this size has an island.
        if (kind == MAP_LAKE && made % 2 == 0)
        {
            plot->spot = MAP_SPOT_PATCH;
            plot->spot_owner = host;
        }
        made++;
    }
    return made;
}

/// Put lakes or enclaves into cells. Every third lake has an island.
static size_t make_spots(land_maker *maker, size_t wanted, map_kind kind)
{
    size_t made = 0;
    for (size_t i = 0; i < maker->grid->cell_count && made < wanted; i++)
    {
        size_t cell = maker->order[maker->grid->cell_count - 1 - i];
        map_plot *plot = &maker->land->plots[cell];
        if (!is_free(maker, cell) || maker->land->kinds[plot->owner] != MAP_COUNTRY || plot->spot != MAP_SPOT_NONE)
            continue;
        plot->spot = kind == MAP_LAKE && made % 3 == 0 ? MAP_SPOT_RING : MAP_SPOT_PATCH;
        plot->spot_owner = add_feature(maker->land, kind);
        made++;
    }
    return made;
}

/// The owner of a cell's first neighbour on land, or MAP_SEA.
static uint32_t neighbour_owner(const land_maker *maker, size_t cell)
{
    const map_cell *at = &maker->grid->cells[cell];
    for (size_t k = 0; k < at->degree; k++)
    {
        uint32_t owner = maker->land->plots[at->neighbours[k]].owner;
        if (owner != MAP_SEA && maker->land->kinds[owner] == MAP_COUNTRY)
            return owner;
    }
    return MAP_SEA;
}

/// Small islands off the coasts.
static void make_islands(land_maker *maker)
{
    static const double SHARE = 0.05;
    for (size_t i = 0; i < maker->grid->cell_count; i++)
    {
        map_plot *plot = &maker->land->plots[i];
        if (plot->owner != MAP_SEA || bat_random_uniform(maker->random) >= SHARE)
            continue;
        uint32_t owner = neighbour_owner(maker, i);
        if (owner == MAP_SEA)
            continue;
        plot->spot = MAP_SPOT_PATCH;
        plot->spot_owner = owner;
    }
}

/// Countries of a few islands in neighbouring cells, off the continents where there is room.
static void make_island_countries(land_maker *maker)
{
    static const double NORTHMOST = 66;
    size_t made = 0;
    for (size_t pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < maker->grid->cell_count && made < maker->plan.island_countries; i++)
        {
            uint32_t cell = maker->order[i];
            const map_cell *at = &maker->grid->cells[cell];
            map_plot *plot = &maker->land->plots[cell];
            bool remote = neighbour_owner(maker, cell) == MAP_SEA;
            if (plot->owner != MAP_SEA || plot->spot != MAP_SPOT_NONE || is_polar(at) || at->latitude > NORTHMOST ||
                (pass == 0 && !remote))
                continue;
            uint32_t country = add_feature(maker->land, MAP_COUNTRY);
            plot->spot = MAP_SPOT_PATCH;
            plot->spot_owner = country;
            for (size_t k = 0; k < at->degree; k += 1 + k % 2)
            {
                map_plot *other = &maker->land->plots[at->neighbours[k]];
                if (other->owner == MAP_SEA && other->spot == MAP_SPOT_NONE)
                {
                    other->spot = MAP_SPOT_PATCH;
                    other->spot_owner = country;
                }
            }
            made++;
        }
}

bool map_land_make(const map_grid *grid, size_t countries, bat_random *random, map_land *land)
{
    *land = (map_land){0};
    land_maker maker = {.grid = grid, .land = land, .random = random};
    maker.plan = make_plan(countries, &land->split_count);
    land->plots = memory_array(grid->cell_count, sizeof *land->plots);
    maker.values = memory_array(grid->cell_count, sizeof *maker.values);
    maker.order = memory_array(grid->cell_count, sizeof *maker.order);
    (void)add_feature(land, MAP_COUNTRY);
    bool made = land->plots != NULL && maker.values != NULL && maker.order != NULL && raise_land(&maker) &&
                make_countries(&maker) && !land->failed;
    if (made)
    {
        land->split_count += maker.plan.enclave_cells - make_cells(&maker, maker.plan.enclave_cells, MAP_ENCLAVE);
        (void)make_cells(&maker, maker.plan.lake_cells, MAP_LAKE);
        land->split_count += maker.plan.enclave_spots - make_spots(&maker, maker.plan.enclave_spots, MAP_ENCLAVE);
        (void)make_spots(&maker, maker.plan.lakes, MAP_LAKE);
        make_island_countries(&maker);
        make_islands(&maker);
        size_t lakes = 0;
        for (size_t i = 0; i < land->feature_count; i++)
            lakes += land->kinds[i] == MAP_LAKE;
        land->split_count = countries - (land->feature_count - lakes);
    }
    made = made && !land->failed;
    free(maker.values);
    free(maker.order);
    if (!made)
        map_land_free(land);
    return made;
}

/// The number of countries that lie across the antimeridian after a turn; `seen` has a number for each feature.
static size_t count_across(const map_grid *grid, const map_land *land, double degrees, size_t mark, size_t *seen)
{
    size_t count = 0;
    for (size_t i = 0; i < grid->cell_count; i++)
    {
        const map_cell *cell = &grid->cells[i];
        uint32_t owner = land->plots[i].owner;
        double from = map_longitude_step(cell->longitude + degrees);
        for (size_t k = 0; owner != MAP_SEA && owner != 0 && k < cell->degree; k++)
        {
            uint32_t other = cell->neighbours[k];
            double to = map_longitude_step(grid->cells[other].longitude + degrees);
            if (land->plots[other].owner != owner || fabs(from - to) <= 180 || seen[owner] == mark)
                continue;
            seen[owner] = mark;
            count += land->kinds[owner] == MAP_COUNTRY;
        }
    }
    return count;
}

bool map_land_turn(const map_grid *grid, const map_land *land, double *turn)
{
    enum
    {
        TURNS = 120,
        WANTED = 5
    };
    size_t least = SIZE_MAX, *seen = calloc(land->feature_count, sizeof *seen);
    *turn = 0;
    for (size_t i = 0; seen != NULL && i < TURNS; i++)
    {
        double degrees = 360.0 * (double)i / TURNS;
        size_t count = count_across(grid, land, degrees, i + 1, seen);
        size_t away = count > WANTED ? count - WANTED : WANTED - count;
        if (away < least)
        {
            least = away;
            *turn = degrees;
        }
    }
    free(seen);
    return seen != NULL;
}

void map_land_free(map_land *land)
{
    free(land->plots);
    free(land->kinds);
    *land = (map_land){0};
}
