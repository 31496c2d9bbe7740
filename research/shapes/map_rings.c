#include "research/shapes/map_rings.h"

#include "base/array_grow.h"

#include <math.h>
#include <string.h>

#define NO_VERTEX UINT32_MAX

/// A place in the plane of longitude and latitude, in degrees.
typedef struct map_place
{
    double x, y;
} map_place;

/// A convex quadrilateral; a line goes from `from` to `to`.
typedef struct map_quad
{
    map_place from, left, to, right;
} map_quad;

/// An edge of a ring between two centroids.
typedef struct ring_edge
{
    uint32_t cell, side; ///< the border that it follows
    uint32_t to;         ///< the triangle at its end
    bool used;
} ring_edge;

typedef struct ring_maker
{
    const map_grid *grid;
    const map_land *land;
    size_t detail;
    uint64_t seed;
    map_rings *map;
    uint32_t *corners; ///< for each triangle: the vertex at its centroid, or NO_VERTEX
    uint32_t *borders; ///< for each cell and side: the first vertex within the border, or NO_VERTEX
    ring_edge *edges;  ///< of one feature
    size_t *edge_from; ///< for each triangle: the edge of the feature that begins there
} ring_maker;

int64_t map_step(int64_t units)
{
    const int64_t half = (int64_t)180 * MAP_UNITS;
    while (units > half)
        units -= 2 * half;
    while (units <= -half)
        units += 2 * half;
    return units;
}

uint32_t map_vertex_add(map_rings *map, double longitude, double latitude)
{
    void *vertices = map->vertices;
    bool grown = map->vertex_count < NO_VERTEX - 1 &&
                 array_grow(&vertices, &map->vertex_capacity, map->vertex_count + 1, sizeof *map->vertices);
    map->vertices = vertices;
    map->failed = map->failed || !grown;
    if (!grown)
        return 0;
    map->vertices[map->vertex_count] = (map_vertex){map_step(llrint(longitude * MAP_UNITS)), llrint(latitude * MAP_UNITS)};
    return (uint32_t)map->vertex_count++;
}

void map_ring_add(map_rings *map, map_ring *ring, uint32_t vertex)
{
    void *vertices = ring->vertices;
    bool grown = array_grow(&vertices, &ring->capacity, ring->count + 1, sizeof *ring->vertices);
    ring->vertices = vertices;
    map->failed = map->failed || !grown;
    if (grown)
        ring->vertices[ring->count++] = vertex;
}

void map_hole_add(map_rings *map, map_polygon *polygon, map_ring *ring)
{
    void *rings = polygon->rings;
    bool grown = array_grow(&rings, &polygon->capacity, polygon->count + 1, sizeof *polygon->rings);
    polygon->rings = rings;
    map->failed = map->failed || !grown;
    if (grown)
        polygon->rings[polygon->count++] = *ring;
    else
        free(ring->vertices);
    *ring = (map_ring){0};
}

map_polygon *map_polygon_add(map_rings *map, map_area *area, map_ring *ring)
{
    void *polygons = area->polygons;
    bool grown = array_grow(&polygons, &area->capacity, area->count + 1, sizeof *area->polygons);
    area->polygons = polygons;
    map->failed = map->failed || !grown;
    if (!grown)
    {
        free(ring->vertices);
        *ring = (map_ring){0};
        return NULL;
    }
    map_polygon *polygon = &area->polygons[area->count++];
    *polygon = (map_polygon){0};
    map_hole_add(map, polygon, ring);
    if (polygon->count > 0)
        return polygon;
    area->count--;
    return NULL;
}

map_area *map_area_add(map_rings *map, map_kind kind)
{
    void *areas = map->areas;
    bool grown = array_grow(&areas, &map->area_capacity, map->area_count + 1, sizeof *map->areas);
    map->areas = areas;
    map->failed = map->failed || !grown;
    if (!grown)
        return NULL;
    map->areas[map->area_count] = (map_area){.kind = kind};
    return &map->areas[map->area_count++];
}

bool map_ring_holds(const map_rings *map, const map_ring *ring, map_vertex vertex)
{
    const int64_t turn = (int64_t)360 * MAP_UNITS;
    bool inside = false;
    map_vertex last = map->vertices[ring->vertices[ring->count - 1]];
    // The ring is unrolled from its last vertex; the sought vertex may be a turn away from it.
    double xj = (double)map_step(last.longitude - vertex.longitude), yj = (double)(last.latitude - vertex.latitude);
    bool sides[3] = {false, false, false};
    for (size_t i = 0; i < ring->count; i++)
    {
        map_vertex at = map->vertices[ring->vertices[i]];
        double xi = xj + (double)map_step(at.longitude - last.longitude), yi = (double)(at.latitude - vertex.latitude);
        for (int side = 0; side < 3 && (yi > 0) != (yj > 0); side++)
            if ((double)((side - 1) * turn) < xi - yi / (yj - yi) * (xj - xi))
                sides[side] = !sides[side];
        last = at;
        xj = xi;
        yj = yi;
    }
    for (int side = 0; side < 3; side++)
        inside = inside || sides[side];
    return inside;
}

/// A number from [0, 1) for a border and a place on it, whatever the order in which they are drawn.
static double number_at(uint64_t seed, uint64_t border, uint64_t place)
{
    // splitmix64, Steele, Lea and Flood, 2014
    uint64_t z = seed + border * UINT64_C(0x9e3779b97f4a7c15) + place * UINT64_C(0xd1b54a32d192ed03);
    for (int round = 0; round < 2; round++)
    {
        z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
        z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
        z ^= z >> 31;
    }
    return (double)(z >> 11) * 0x1p-53;
}

static map_place mix(map_place a, map_place b, double share)
{
    return (map_place){a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

/// Add the vertices between the ends of a line by repeated displacement of midpoints within quadrilaterals. The midpoint is
/// the bilinear image of (s, t), and the two halves stay within the images of [0, s] x [0, t] and [s, 1] x [t, 1]. These are
/// convex, and share the midpoint alone.
static void add_line(ring_maker *maker, const map_quad *quad, size_t depth, uint64_t border, uint64_t place)
{
    static const double ACROSS = 0.24, ALONG = 0.08;
    if (depth == 0)
        return;
    double across = ACROSS * (2 * number_at(maker->seed, border, 2 * place) - 1);
    double along = ALONG * (2 * number_at(maker->seed, border, 2 * place + 1) - 1);
    double s = 0.5 + across + along, t = 0.5 - across + along;
    map_place from_left = mix(quad->from, quad->left, s), right_to = mix(quad->right, quad->to, s);
    map_place from_right = mix(quad->from, quad->right, t), left_to = mix(quad->left, quad->to, t);
    map_place middle = mix(from_left, right_to, t);
    add_line(maker, &(map_quad){quad->from, from_left, middle, from_right}, depth - 1, border, 2 * place);
    (void)map_vertex_add(maker->map, middle.x, middle.y);
    add_line(maker, &(map_quad){middle, left_to, quad->to, right_to}, depth - 1, border, 2 * place + 1);
}

/// A cell's site, with its longitude next to that of another.
static map_place site_near(const map_grid *grid, size_t cell, double longitude)
{
    const map_cell *at = &grid->cells[cell];
    return (map_place){longitude + map_longitude_step(at->longitude - longitude), at->latitude};
}

static map_place vertex_near(const map_rings *map, uint32_t vertex, double longitude)
{
    if (map->failed)
        return (map_place){longitude, 0};
    map_vertex at = map->vertices[vertex];
    return (map_place){longitude + map_longitude_step((double)at.longitude / MAP_UNITS - longitude),
                       (double)at.latitude / MAP_UNITS};
}

/// The vertex at the centroid of a triangle.
static uint32_t corner_at(ring_maker *maker, uint32_t triangle)
{
    if (maker->corners[triangle] == NO_VERTEX)
    {
        const uint32_t *cells = maker->grid->triangles[triangle];
        map_place sum = {0, 0};
        for (int c = 0; c < 3; c++)
        {
            map_place site = site_near(maker->grid, cells[c], maker->grid->cells[cells[0]].longitude);
            sum.x += site.x / 3;
            sum.y += site.y / 3;
        }
        maker->corners[triangle] = map_vertex_add(maker->map, sum.x, sum.y);
    }
    return maker->corners[triangle];
}

/// The triangle at the start of a side of a cell; the one at its end is triangles[side].
static uint32_t start_of(const map_cell *cell, size_t side)
{
    return cell->triangles[(side + cell->degree - 1) % cell->degree];
}

static size_t side_of(const map_cell *cell, size_t neighbour)
{
    size_t side = 0;
    while (cell->neighbours[side] != neighbour)
        side++;
    return side;
}

static uint64_t border_number(const map_grid *grid, size_t a, size_t b)
{
    return (uint64_t)(a < b ? a : b) * grid->cell_count + (a < b ? b : a) + 1;
}

/// A point of the edge between the sites of two cells, `cell` being in the middle of the plane.
static map_place middle_of(const ring_maker *maker, size_t cell, size_t other)
{
    double share = 0.4 + 0.2 * number_at(maker->seed, border_number(maker->grid, cell, other), 0);
    double longitude = maker->grid->cells[cell].longitude;
    map_place a = site_near(maker->grid, cell, longitude), b = site_near(maker->grid, other, longitude);
    return cell < other ? mix(a, b, share) : mix(b, a, share);
}

/// The quadrilateral of half a border, from a centroid to the point between two sites, or back.
static map_quad half_quad(map_place from, map_place to, map_place corner, map_place middle, map_place left, map_place right)
{
    static const double CORNER = 0.3, SITE = 0.4;
    const map_place sides[2] = {left, right};
    map_place inner[2];
    for (int i = 0; i < 2; i++)
        inner[i] = (map_place){CORNER * corner.x + SITE * sides[i].x + (1 - CORNER - SITE) * middle.x,
                               CORNER * corner.y + SITE * sides[i].y + (1 - CORNER - SITE) * middle.y};
    return (map_quad){from, inner[0], to, inner[1]};
}

/// The number of vertices between the ends of a border.
static size_t border_size(const ring_maker *maker)
{
    return ((size_t)1 << maker->detail) - 1;
}

/// The first of the vertices within a border, in the order of the cell with the lower number.
static uint32_t border_at(ring_maker *maker, size_t cell, size_t side)
{
    const map_grid *grid = maker->grid;
    size_t other = grid->cells[cell].neighbours[side];
    if (other < cell)
    {
        side = side_of(&grid->cells[other], cell);
        size_t swapped = cell;
        cell = other;
        other = swapped;
    }
    uint32_t *first = &maker->borders[cell * MAP_MAX_DEGREE + side];
    if (*first != NO_VERTEX)
        return *first;
    const map_cell *at = &grid->cells[cell];
    double longitude = at->longitude;
    uint64_t border = border_number(grid, cell, other);
    map_place from = vertex_near(maker->map, corner_at(maker, start_of(at, side)), longitude);
    map_place to = vertex_near(maker->map, corner_at(maker, at->triangles[side]), longitude);
    map_place site = site_near(grid, cell, longitude), beyond = site_near(grid, other, longitude);
    map_place middle = middle_of(maker, cell, other);
    *first = (uint32_t)maker->map->vertex_count;
    map_quad quad = half_quad(from, middle, from, middle, site, beyond);
    add_line(maker, &quad, maker->detail - 1, border, 2);
    (void)map_vertex_add(maker->map, middle.x, middle.y);
    quad = half_quad(middle, to, to, middle, site, beyond);
    add_line(maker, &quad, maker->detail - 1, border, 3);
    return *first;
}

/// Append a border to a ring of its cell, without the end.
static void add_border(ring_maker *maker, size_t cell, size_t side, map_ring *ring)
{
    const map_cell *at = &maker->grid->cells[cell];
    uint32_t start = corner_at(maker, start_of(at, side));
    map_ring_add(maker->map, ring, start);
    size_t count = border_size(maker);
    uint32_t first = border_at(maker, cell, side);
    bool backward = at->neighbours[side] < cell;
    for (size_t i = 0; i < count; i++)
        map_ring_add(maker->map, ring, first + (uint32_t)(backward ? count - 1 - i : i));
}

/// Collect the edges of a feature. Returns their number.
static size_t collect_edges(ring_maker *maker, uint32_t owner, const uint32_t *cells, size_t cell_count)
{
    const map_land *land = maker->land;
    size_t count = 0;
    for (size_t i = 0; i < cell_count; i++)
    {
        const map_cell *cell = &maker->grid->cells[cells[i]];
        for (size_t side = 0; side < cell->degree; side++)
            if (land->plots[cell->neighbours[side]].owner != owner)
            {
                maker->edge_from[start_of(cell, side)] = count;
                maker->edges[count++] = (ring_edge){.cell = cells[i], .side = (uint32_t)side, .to = cell->triangles[side]};
            }
    }
    return count;
}

/// Twice the signed area of a ring in the plane, and the longitude that it turns by.
static double signed_area(const map_rings *map, const map_ring *ring, int64_t *turn)
{
    double area = 0, x = 0;
    *turn = 0;
    for (size_t i = 0; i < ring->count; i++)
    {
        map_vertex a = map->vertices[ring->vertices[i]], b = map->vertices[ring->vertices[(i + 1) % ring->count]];
        int64_t step = map_step(b.longitude - a.longitude);
        *turn += step;
        area += x * (double)b.latitude - (x + (double)step) * (double)a.latitude;
        x += (double)step;
    }
    return area;
}

/// Give a hole to the polygon of an area that holds it: the one around the pole where no other does.
static void place_hole(map_rings *map, map_area *area, map_ring *hole)
{
    map_polygon *holder = NULL;
    for (size_t i = 0; i < area->count; i++)
    {
        map_polygon *polygon = &area->polygons[i];
        bool held = !polygon->pole && map_ring_holds(map, &polygon->rings[0], map->vertices[hole->vertices[0]]);
        if (held || (polygon->pole && holder == NULL))
            holder = polygon;
    }
    if (holder != NULL)
        map_hole_add(map, holder, hole);
    else
        free(hole->vertices);
}

/// Trace the rings of a feature along its cells.
static void trace_feature(ring_maker *maker, uint32_t owner, const uint32_t *cells, size_t cell_count)
{
    map_rings *map = maker->map;
    map_area *area = &map->areas[owner];
    size_t count = collect_edges(maker, owner, cells, cell_count);
    map_polygon holes = {0};
    for (size_t first = 0; first < count; first++)
    {
        map_ring ring = {0};
        for (size_t edge = first; !maker->edges[edge].used; edge = maker->edge_from[maker->edges[edge].to])
        {
            maker->edges[edge].used = true;
            add_border(maker, maker->edges[edge].cell, maker->edges[edge].side, &ring);
        }
        if (ring.count == 0 || map->failed)
        {
            free(ring.vertices);
            continue;
        }
        int64_t turn;
        double size = signed_area(map, &ring, &turn);
        if (turn == 0 && size < 0)
        {
            map_hole_add(map, &holes, &ring);
            continue;
        }
        map_polygon *polygon = map_polygon_add(map, area, &ring);
        if (polygon != NULL)
            polygon->pole = turn != 0;
    }
    for (size_t i = 0; i < holes.count; i++)
        if (map->failed)
            free(holes.rings[i].vertices);
        else
            place_hole(map, area, &holes.rings[i]);
    free(holes.rings);
}

/// A ring around the site of a cell, within the part of it that borders do not reach. It is star-shaped.
static map_ring spot_ring(ring_maker *maker, size_t cell, double radius, uint64_t number)
{
    static const double LEAST = 0.7, RANGE = 0.6, ROOM = 0.15;
    map_ring ring = {0};
    const map_cell *at = &maker->grid->cells[cell];
    map_place site = {at->longitude, at->latitude};
    map_place corners[2 * MAP_MAX_DEGREE];
    size_t count = 2 * at->degree, depth = maker->detail > 2 ? maker->detail - 2 : 0;
    uint64_t border = border_number(maker->grid, cell, cell) + number * UINT64_C(0x100000000000);
    for (size_t i = 0; i < count; i++)
    {
        size_t side = i / 2;
        map_place direction = i % 2 == 0 ? vertex_near(maker->map, corner_at(maker, start_of(at, side)), at->longitude)
                                         : middle_of(maker, cell, at->neighbours[side]);
        corners[i] = mix(site, direction, radius * (LEAST + RANGE * number_at(maker->seed, border, i)));
    }
    for (size_t i = 0; i < count; i++)
    {
        map_place from = corners[i], to = corners[(i + 1) % count], middle = mix(from, to, 0.5);
        map_quad quad = {from, mix(site, middle, 1 - ROOM), to, mix(site, middle, 1 + ROOM)};
        map_ring_add(maker->map, &ring, map_vertex_add(maker->map, from.x, from.y));
        uint32_t first = (uint32_t)maker->map->vertex_count;
        add_line(maker, &quad, depth, border + i + 1, 1);
        for (size_t k = first; k < maker->map->vertex_count && !maker->map->failed; k++)
            map_ring_add(maker->map, &ring, (uint32_t)k);
    }
    return ring;
}

/// Add an area with the given ring to a feature, and a hole to the feature around it.
static void add_spot(map_rings *map, uint32_t owner, uint32_t around, map_ring *ring)
{
    map_ring hole = {0};
    for (size_t i = ring->count; around != MAP_SEA && i > 0; i--)
        map_ring_add(map, &hole, ring->vertices[i - 1]);
    (void)map_polygon_add(map, &map->areas[owner], ring);
    if (around != MAP_SEA && !map->failed)
        place_hole(map, &map->areas[around], &hole);
    else
        free(hole.vertices);
}

static void add_spots(ring_maker *maker)
{
    static const double ISLAND = 0.2, LAKE = 0.38, RANGE = 0.18, INNER = 0.3;
    for (size_t i = 0; i < maker->grid->cell_count && !maker->map->failed; i++)
    {
        const map_plot *plot = &maker->land->plots[i];
        if (plot->spot == MAP_SPOT_NONE)
            continue;
        double radius = ISLAND + RANGE * number_at(maker->seed, border_number(maker->grid, i, i), 1000);
        radius = plot->spot == MAP_SPOT_RING ? LAKE : radius;
        map_ring ring = spot_ring(maker, i, radius, 1);
        add_spot(maker->map, plot->spot_owner, plot->owner, &ring);
        if (plot->spot != MAP_SPOT_RING || maker->map->failed)
            continue;
        ring = spot_ring(maker, i, INNER * radius, 2);
        add_spot(maker->map, plot->owner, plot->spot_owner, &ring);
    }
}

/// The cells of each feature: those of feature f are cells[starts[f]], …, cells[starts[f + 1] - 1].
static void sort_cells(const map_grid *grid, const map_land *land, size_t *starts, uint32_t *cells)
{
    memset(starts, 0, (land->feature_count + 2) * sizeof *starts);
    for (size_t i = 0; i < grid->cell_count; i++)
        if (land->plots[i].owner != MAP_SEA)
            starts[land->plots[i].owner + 2]++;
    for (size_t f = 1; f < land->feature_count + 2; f++)
        starts[f] += starts[f - 1];
    for (size_t i = 0; i < grid->cell_count; i++)
        if (land->plots[i].owner != MAP_SEA)
            cells[starts[land->plots[i].owner + 1]++] = (uint32_t)i;
}

static void trace_features(ring_maker *maker, const size_t *starts, const uint32_t *cells)
{
    const map_land *land = maker->land;
    for (size_t f = 0; f < land->feature_count; f++)
        (void)map_area_add(maker->map, land->kinds[f]);
    for (size_t f = 0; f < land->feature_count && !maker->map->failed; f++)
        trace_feature(maker, (uint32_t)f, cells + starts[f], starts[f + 1] - starts[f]);
    if (!maker->map->failed)
        add_spots(maker);
}

bool map_rings_make(const map_grid *grid, const map_land *land, size_t detail, uint64_t seed, map_rings *map)
{
    *map = (map_rings){0};
    size_t sides = grid->cell_count * MAP_MAX_DEGREE;
    ring_maker maker = {.grid = grid, .land = land, .detail = detail, .seed = seed, .map = map};
    maker.corners = memory_array(grid->triangle_count, sizeof *maker.corners);
    maker.borders = memory_array(sides, sizeof *maker.borders);
    maker.edges = memory_array(sides, sizeof *maker.edges);
    maker.edge_from = memory_array(grid->triangle_count, sizeof *maker.edge_from);
    size_t *starts = memory_array(land->feature_count + 2, sizeof *starts);
    uint32_t *cells = memory_array(grid->cell_count, sizeof *cells);
    bool made = maker.corners != NULL && maker.borders != NULL && maker.edges != NULL && maker.edge_from != NULL &&
                starts != NULL && cells != NULL;
    if (made)
    {
        memset(maker.corners, 0xff, grid->triangle_count * sizeof *maker.corners);
        memset(maker.borders, 0xff, sides * sizeof *maker.borders);
        sort_cells(grid, land, starts, cells);
        trace_features(&maker, starts, cells);
        made = !map->failed;
    }
    free(maker.corners);
    free(maker.borders);
    free(maker.edges);
    free(maker.edge_from);
    free(starts);
    free(cells);
    if (!made)
        map_rings_free(map);
    return made;
}

static void polygons_free(map_polygon *polygons, size_t count)
{
    for (size_t i = 0; i < count; i++)
    {
        for (size_t k = 0; k < polygons[i].count; k++)
            free(polygons[i].rings[k].vertices);
        free(polygons[i].rings);
    }
    free(polygons);
}

void map_rings_free(map_rings *map)
{
    for (size_t i = 0; i < map->area_count; i++)
        polygons_free(map->areas[i].polygons, map->areas[i].count);
    free(map->areas);
    free(map->vertices);
    *map = (map_rings){0};
}
