#include "draw/curve/scene.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "curve/map/arc_refine.h"
#include "curve/polygon.h"

/// @file
/// Choice of the projection by the smallest cap around the curves, and of the window of a local map.

/// The largest radii of caps that are drawn as a local map.
#define POLYGON_CAP 80.0
#define LINE_CAP 30.0
/// The margin around the curves, relative to the larger side, and the range of a window's aspect ratio, height over width.
#define MARGIN 0.04
#define FLATTEST 0.5
#define TALLEST 1.7
/// The smallest side of a window, in radians: 6 cm on the Earth.
#define MIN_SIDE 1e-8

/// The centre of nearly the smallest ball around the points: Badoiu and Clarkson, "Smaller core-sets for balls" (2003). It
/// takes at most about 20000 points.
static void ball_centre(const bat_curve *const *curves, size_t count, double *centre)
{
    const size_t enough = 20000;
    const int rounds = 300;
    size_t total = 0;
    for (size_t k = 0; k < count; k++)
        total += curves[k]->count;
    size_t stride = 1 + total / enough;
    memcpy(centre, curves[0]->points, 3 * sizeof(double));
    for (int round = 1; round <= rounds; round++)
    {
        const double *farthest = centre;
        double distance = 0.0;
        for (size_t k = 0; k < count; k++)
            for (size_t i = 0; i < curves[k]->count; i += stride)
            {
                const double *p = curves[k]->points + 3 * i;
                double square = chord_square(p, centre);
                if (square > distance)
                {
                    distance = square;
                    farthest = p;
                }
            }
        double target[3];
        memcpy(target, farthest, sizeof target);
        for (int k = 0; k < 3; k++)
            centre[k] += (target[k] - centre[k]) / (round + 1.0);
    }
}

/// A cap that contains all curves: nearly the smallest one, if that is less than a hemisphere.
/// @param centre receives a point of unit length
/// @param radius receives an angle
static void map_cap(const bat_curve *const *curves, size_t count, double *centre, double *radius)
{
    ball_centre(curves, count, centre);
    if (vector3_dot(centre, centre) < 1e-6) // the curves are all around the sphere
    {
        *radius = ANGLE_PI;
        memcpy(centre, curves[0]->points, 3 * sizeof(double));
        return;
    }
    (void)vector3_normalize(centre);
    double farthest = 0.0;
    for (size_t k = 0; k < count; k++)
        for (size_t i = 0; i < curves[k]->count; i++)
            farthest = fmax(farthest, chord_square(curves[k]->points + 3 * i, centre));
    *radius = 2.0 * asin(fmin(1.0, 0.5 * sqrt(farthest)));
}

/// Calls `take` with the points of all edges, in steps of at most 0.02 radians.
static void visit_edges(const bat_curve *const *curves, size_t count, void (*take)(void *context, const double *point),
                        void *context)
{
    const double step = 0.02;
    for (size_t k = 0; k < count; k++)
    {
        const bat_curve *curve = curves[k];
        take(context, curve->points);
        for (size_t i = 1; i < curve->count + (curve->closed ? 1 : 0); i++)
        {
            const double *p = curve->points + 3 * (i - 1);
            const double *q = curve->points + 3 * (i < curve->count ? i : 0);
            double angle = vector3_dot(p, q) < 1.0 - 0.5 * step * step ? chord_angle(p, q) : 0.0;
            double steps = ceil(angle / step);
            for (double s = 1.0; s < steps; s += 1.0)
            {
                double point[3];
                double share = s / steps;
                for (int c = 0; c < 3; c++)
                    point[c] = (sin((1.0 - share) * angle) * p[c] + sin(share * angle) * q[c]) / sin(angle);
                take(context, point);
            }
            take(context, q);
        }
    }
}

typedef struct window
{
    draw_view view;
    double low[2], high[2];
} window;

static void include_point(void *context, const double *point)
{
    window *seen = context;
    double place[2];
    view_project(&seen->view, point, &place[0], &place[1]);
    box_include(2, place, seen->low, seen->high);
}

static window window_about(const bat_curve *const *curves, size_t count, double longitude, double latitude)
{
    window seen = {.view = {.kind = VIEW_LOCAL, .space = VIEW_SPHERE, .point_dim = 3}};
    box_clear(2, seen.low, seen.high);
    view_set_globe(&seen.view, longitude, latitude);
    visit_edges(curves, count, include_point, &seen);
    return seen;
}

/// Add margins, and widen the window to an aspect ratio within the limits.
static void finish_window(map_choice *choice, const window *seen)
{
    double side[2];
    vector_subtract(2, seen->high, seen->low, side);
    double room = fmax(2.0 * MARGIN * fmax(side[0], side[1]), MIN_SIDE);
    double width = side[0] + room, height = side[1] + room;
    width = fmax(width, height / TALLEST);
    height = fmax(height, width * FLATTEST);
    double half[2] = {0.5 * width, 0.5 * height};
    for (int k = 0; k < 2; k++)
    {
        choice->low[k] = 0.5 * (seen->low[k] + seen->high[k]) - half[k];
        choice->high[k] = 0.5 * (seen->low[k] + seen->high[k]) + half[k];
    }
}

/// Choose the centre and the window of a local map. Where a pole is well within the curves, it is the centre.
static void choose_window(map_choice *choice, const bat_curve *const *curves, size_t count, const double *centre,
                          double radius, bool prescribed)
{
    if (!prescribed)
    {
        choice->longitude = atan2(centre[1], centre[0]);
        choice->latitude = atan2(centre[2], hypot(centre[0], centre[1]));
        double to_pole = 0.5 * ANGLE_PI - fabs(choice->latitude);
        bool polar = radius > 8.0 * ANGLE_DEGREE && to_pole < 0.35 * radius;
        if (polar)
        {
            choice->longitude = 0.0;
            choice->latitude = copysign(0.5 * ANGLE_PI, choice->latitude);
        }
        for (int round = 0; round < 3 && !polar; round++)
        {
            window seen = window_about(curves, count, choice->longitude, choice->latitude);
            double point[3];
            view_local_point(&seen.view, 0.5 * (seen.low[0] + seen.high[0]), 0.5 * (seen.low[1] + seen.high[1]), point);
            choice->longitude = atan2(point[1], point[0]);
            choice->latitude = atan2(point[2], hypot(point[0], point[1]));
        }
    }
    window seen = window_about(curves, count, choice->longitude, choice->latitude);
    finish_window(choice, &seen);
}

#define SECTORS 180 ///< wider than the steps of visit_edges() where these are not near a pole

static void include_sector(void *context, const double *point)
{
    bool *covered = context;
    double sector = floor((atan2(point[1], point[0]) + ANGLE_PI) * SECTORS / (2.0 * ANGLE_PI));
    covered[(int)fmin(fmax(sector, 0.0), SECTORS - 1.0)] = true;
}

/// The middle meridian of a map: Greenwich, unless that would cut the curves and another cut of 30 degrees would not.
static double choose_meridian(const bat_curve *const *curves, size_t count)
{
    const double wide = 30.0 * ANGLE_DEGREE;
    const double sector = 2.0 * ANGLE_PI / SECTORS;
    bool covered[SECTORS] = {false};
    visit_edges(curves, count, include_sector, covered);
    if (!covered[0] || !covered[SECTORS - 1])
        return 0.0;
    int longest = 0, end = 0, run = 0;
    for (int i = 0; i < SECTORS; i++)
    {
        run = covered[i] ? 0 : run + 1;
        if (run > longest)
        {
            longest = run;
            end = i + 1;
        }
    }
    // The middle of the gap is at -pi + (end - longest / 2) sectors; the map's middle is half a turn from it.
    return longest * sector >= wide ? remainder((end - 0.5 * longest) * sector, 2.0 * ANGLE_PI) : 0.0;
}

map_choice map_choose(const bat_curve *const *curves, size_t count, bool polygons, const bat_curve_picture_options *options)
{
    map_choice choice = {.projection = options->projection,
                         .longitude = options->longitude,
                         .latitude = options->latitude,
                         .meridian = options->longitude};
    bool prescribed = !isnan(options->longitude) && !isnan(options->latitude);
    double centre[3] = {1.0, 0.0, 0.0};
    double radius = 0.0;
    if (choice.projection == BAT_CURVE_PROJECTION_AUTO || choice.projection == BAT_CURVE_PROJECTION_LOCAL)
        map_cap(curves, count, centre, &radius);
    if (choice.projection == BAT_CURVE_PROJECTION_AUTO)
    {
        bool local = radius < (polygons ? POLYGON_CAP : LINE_CAP) * ANGLE_DEGREE;
        choice.projection = local      ? BAT_CURVE_PROJECTION_LOCAL
                            : polygons ? BAT_CURVE_PROJECTION_MAP
                                       : BAT_CURVE_PROJECTION_GLOBE;
    }
    if (choice.projection == BAT_CURVE_PROJECTION_LOCAL)
    {
        choose_window(&choice, curves, count, centre, radius, prescribed);
        return choice;
    }
    if (!prescribed && choice.projection != BAT_CURVE_PROJECTION_MAP)
        view_automatic(curves, count, &choice.longitude, &choice.latitude);
    if (isnan(choice.meridian))
        choice.meridian = choose_meridian(curves, count);
    return choice;
}

// A hash table of the edges of a panel, and greedy colouring of the features that share edges.

/// Two features that share an edge, a < b, as indices into the sorted features.
typedef struct feature_pair
{
    size_t a, b;
} feature_pair;

typedef struct network_builder
{
    memory_pool pool; ///< of `table` and `features`
    const bat_curve_picture_panel *panel;
    size_t point_dim;
    edge_place *table; ///< `curve` is a layer, BAT_NO_INDEX in an empty place
    size_t mask;
    size_t *features; ///< sorted, each once
    size_t feature_count;
    feature_pair *pairs;
    size_t pair_count, pair_capacity;
} network_builder;

/// The ends of an edge, the lower one first.
static void edge_ends(const network_builder *builder, edge_place place, const double **p, const double **q)
{
    const bat_curve *curve = builder->panel->layers[place.curve].curve;
    *p = curve->points + place.edge * builder->point_dim;
    *q = curve->points + (place.edge + 1 < curve->count ? place.edge + 1 : 0) * builder->point_dim;
    size_t k = 0;
    while (k < builder->point_dim && (*p)[k] == (*q)[k])
        k++;
    if (k < builder->point_dim && (*p)[k] > (*q)[k])
        SWAP(*p, *q);
}

/// Whether layers are drawn in one style.
static bool same_kind(const bat_curve_picture_layer *a, const bat_curve_picture_layer *b)
{
    return a->role == b->role && (a->polygon > 0) == (b->polygon > 0) && (a->polygon > 0 || a->colour == b->colour);
}

/// The place of an edge in the table: that of an equal edge, or the empty one that it takes.
static edge_place *find_edge(const network_builder *builder, edge_place edge)
{
    const bat_curve_picture_layer *layer = &builder->panel->layers[edge.curve];
    const double *p, *q;
    edge_ends(builder, edge, &p, &q);
    size_t hash = hash_mix(doubles_hash(p, builder->point_dim), doubles_hash(q, builder->point_dim));
    size_t at = hash_mix(hash, (uint64_t)layer->role) & builder->mask;
    for (; builder->table[at].curve != BAT_NO_INDEX; at = (at + 1) & builder->mask)
    {
        const double *other_p, *other_q;
        edge_ends(builder, builder->table[at], &other_p, &other_q);
        if (same_kind(layer, &builder->panel->layers[builder->table[at].curve]) &&
            points_equal(p, other_p, builder->point_dim) && points_equal(q, other_q, builder->point_dim))
            break;
    }
    return &builder->table[at];
}

static int compare_sizes(const void *a, const void *b)
{
    return ORDER_OF(*(const size_t *)a, *(const size_t *)b);
}

DEFINE_ORDER(compare_pairs, feature_pair, b, a)

static size_t feature_index(const network_builder *builder, size_t layer)
{
    const size_t *found = bsearch(&builder->panel->layers[layer].feature, builder->features, builder->feature_count,
                                  sizeof *builder->features, compare_sizes);
    return (size_t)(found - builder->features);
}

static bool add_pair(network_builder *builder, size_t layer, size_t other)
{
    size_t a = feature_index(builder, layer), b = feature_index(builder, other);
    feature_pair pair = {a < b ? a : b, a < b ? b : a};
    bool known = builder->pair_count > 0 && compare_pairs(&builder->pairs[builder->pair_count - 1], &pair) == 0;
    return a == b || known || ARRAY_ADD(builder->pairs, builder->pair_capacity, builder->pair_count, pair);
}

/// Enter all edges. False when out of memory.
static bool enter_edges(network_builder *builder, map_network *network)
{
    for (size_t layer = 0; layer < builder->panel->layer_count; layer++)
    {
        const bat_curve_picture_layer *own = &builder->panel->layers[layer];
        for (size_t edge = 0; edge < polygon_edges(own->curve->count, own->curve->closed); edge++)
        {
            edge_place *place = find_edge(builder, (edge_place){layer, edge});
            bool taken = place->curve != BAT_NO_INDEX;
            network->drawn[network->starts[layer] + edge] = taken ? 0 : 1;
            if (taken && own->polygon > 0 && !add_pair(builder, layer, place->curve))
                return false;
            if (!taken)
                *place = (edge_place){layer, edge};
        }
    }
    return true;
}

/// Give each feature the colour that the fewest features have, among those that its earlier neighbours lack.
static void colour_features(network_builder *builder, int *chosen)
{
    size_t used[MAP_COLOURS] = {0};
    size_t at = 0;
    if (builder->pair_count > 0)
        qsort(builder->pairs, builder->pair_count, sizeof *builder->pairs, compare_pairs);
    for (size_t i = 0; i < builder->feature_count; i++)
    {
        size_t beside[MAP_COLOURS] = {0};
        for (; at < builder->pair_count && builder->pairs[at].b == i; at++)
            beside[chosen[builder->pairs[at].a]]++;
        int best = 0;
        for (int c = 1; c < MAP_COLOURS; c++)
            if (beside[c] < beside[best] || (beside[c] == beside[best] && used[c] < used[best]))
                best = c;
        chosen[i] = best;
        used[best]++;
    }
}

/// Count the edges and collect the features.
static size_t collect(network_builder *builder, map_network *network)
{
    size_t edges = 0;
    const bat_curve_picture_panel *panel = builder->panel;
    for (size_t i = 0; i < panel->layer_count; i++)
    {
        network->starts[i] = edges;
        edges += polygon_edges(panel->layers[i].curve->count, panel->layers[i].curve->closed);
        if (panel->layers[i].polygon > 0)
            builder->features[builder->feature_count++] = panel->layers[i].feature;
    }
    network->starts[panel->layer_count] = edges;
    qsort(builder->features, builder->feature_count, sizeof *builder->features, compare_sizes);
    size_t kept = 0;
    for (size_t i = 0; i < builder->feature_count; i++)
        if (kept == 0 || builder->features[kept - 1] != builder->features[i])
            builder->features[kept++] = builder->features[i];
    builder->feature_count = kept;
    return edges;
}

static bool make_table(network_builder *builder, map_network *network, size_t edges)
{
    size_t size = 16;
    while (size < 2 * edges)
        size *= 2;
    builder->mask = size - 1;
    builder->table = memory_pool_array(&builder->pool, size, sizeof *builder->table);
    network->drawn = memory_pool_array(&network->pool, edges + 1, 1);
    if (builder->table == NULL || network->drawn == NULL)
        return false;
    for (size_t i = 0; i < size; i++)
        builder->table[i].curve = BAT_NO_INDEX;
    return true;
}

bat_status map_network_make(const bat_curve_picture_panel *panel, map_network *network, bat_error *error)
{
    network_builder builder = {.panel = panel, .point_dim = panel->layers[0].curve->space->point_dim};
    bool polygons = false;
    for (size_t i = 0; i < panel->layer_count; i++)
        polygons = polygons || panel->layers[i].polygon > 0;
    *network = (map_network){0};
    if (!polygons)
        return BAT_OK;
    size_t edges = 0;
    network->starts = memory_pool_array(&network->pool, panel->layer_count + 1, sizeof *network->starts);
    network->colours = memory_pool_zeros(&network->pool, panel->layer_count, sizeof *network->colours);
    builder.features = memory_pool_array(&builder.pool, panel->layer_count, sizeof *builder.features);
    int *chosen = memory_pool_array(&builder.pool, panel->layer_count, sizeof *chosen);
    bool made = network->pool.missing == 0 && builder.pool.missing == 0;
    if (made)
        edges = collect(&builder, network);
    made = made && make_table(&builder, network, edges) && enter_edges(&builder, network);
    if (made)
    {
        colour_features(&builder, chosen);
        for (size_t i = 0; i < panel->layer_count; i++)
            if (panel->layers[i].polygon > 0)
                network->colours[i] = chosen[feature_index(&builder, i)];
    }
    free(builder.pairs);
    memory_pool_free(&builder.pool);
    return made ? BAT_OK : error_memory(error, edges * sizeof *builder.table);
}
