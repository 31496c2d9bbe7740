// Maps: shared borders stay shared, nothing crosses that did not, and areas can be kept.

#include "refine_helpers.h"

#include "batten/curve_map.h"
#include "curve/map/arc_refine.h"
#include "curve/topology/edge_tree.h"
#include "space/degrees.h"

enum
{
    CELLS = 4,        ///< of a map in each direction
    BORDER_EDGES = 4, ///< of a border between two corners of cells
    RING = 4 * BORDER_EDGES,
    SLIVER = 6, ///< points of a lake along a border
    MAP_CURVES = 2 * CELLS * CELLS + 1,
};

/// Put a point of the square [0, 1]^2 into a space. On the sphere the square lies over the antimeridian.
static void place(const bat_space *space, double x, double y, double *point)
{
    if (space->point_dim == 3)
    {
        double longitude = 170 + 20 * x;
        degrees_to_point(longitude > 180 ? longitude - 360 : longitude, 40 + 20 * y, point);
        return;
    }
    point[0] = x - 0.5;
    point[1] = y - 0.5;
}

/// A number from -1 to 1 that depends on four whole numbers alone, so that both sides of a border agree.
static double noise(size_t a, size_t b, size_t c, size_t d)
{
    bat_random random = bat_random_seed(((a * 1009 + b) * 1009 + c) * 1009 + d);
    return 2 * bat_random_uniform(&random) - 1;
}

static void corner_of(size_t i, size_t j, double *p)
{
    bool inner_x = i > 0 && i<CELLS, inner_y = j> 0 && j < CELLS;
    p[0] = ((double)i + (inner_x ? 0.1 * noise(i, j, 1, 0) : 0)) / CELLS;
    p[1] = ((double)j + (inner_y ? 0.1 * noise(i, j, 2, 0) : 0)) / CELLS;
}

/// Point k of the border from corner (i, j) to the right or upwards. With a roughness below 1 borders have no point in
/// common but their ends.
static void border_point(size_t i, size_t j, bool up, size_t k, double roughness, double *p)
{
    double a[2], b[2], s = (double)k / BORDER_EDGES;
    corner_of(i, j, a);
    corner_of(i + !up, j + up, b);
    double height = 0.9 * roughness * fmin(s, 1 - s) * noise(i, j, 3 + up, k);
    p[0] = a[0] + s * (b[0] - a[0]) - height * (b[1] - a[1]);
    p[1] = a[1] + s * (b[1] - a[1]) + height * (b[0] - a[0]);
}

/// A narrow lake along the lower border of a country, so near to it that refined curves cross.
static bat_curve make_lake(const bat_space *space, size_t i, size_t j, double roughness)
{
    static const double NEAR = 0.02, FAR = 0.06;
    bat_curve lake = {.space = space, .count = SLIVER, .closed = true};
    lake.points = malloc(SLIVER * space->point_dim * sizeof(double));
    double middle[2] = {((double)i + 0.5) / CELLS, ((double)j + 0.5) / CELLS};
    for (size_t k = 0; k < SLIVER; k++)
    {
        double p[2], share = k < SLIVER / 2 ? NEAR : FAR;
        border_point(i, j, false, k < SLIVER / 2 ? 1 + k : SLIVER - k, roughness, p);
        place(space, p[0] + share * (middle[0] - p[0]), p[1] + share * (middle[1] - p[1]),
              lake.points + k * space->point_dim);
    }
    return lake;
}

/// A map of CELLS x CELLS countries, a lake in each, and a line that ends on a border. Every second ring begins elsewhere
/// and runs the other way.
static bat_curve_set make_map(const bat_space *space, double roughness)
{
    bat_curve *curves = calloc(MAP_CURVES, sizeof *curves);
    for (size_t c = 0; c < CELLS * CELLS; c++)
    {
        size_t i = c % CELLS, j = c / CELLS, dim = space->point_dim;
        curves[c] =
            (bat_curve){.space = space, .count = RING, .closed = true, .points = malloc(RING * dim * sizeof(double))};
        for (size_t k = 0; k < RING; k++)
        {
            size_t side = k / BORDER_EDGES, along = k % BORDER_EDGES, to = (k + 5 * c) % RING;
            double p[2];
            size_t back = BORDER_EDGES - along;
            if (side == 0)
                border_point(i, j, false, along, roughness, p);
            else if (side == 1)
                border_point(i + 1, j, true, along, roughness, p);
            else if (side == 2)
                border_point(i, j + 1, false, back, roughness, p);
            else
                border_point(i, j, true, back, roughness, p);
            to = c % 2 == 1 ? RING - 1 - to : to;
            place(space, p[0], p[1], curves[c].points + to * dim);
        }
    }
    for (size_t c = 0; c < CELLS * CELLS; c++)
        curves[CELLS * CELLS + c] = make_lake(space, c % CELLS, c / CELLS, roughness);
    bat_curve *line = &curves[MAP_CURVES - 1];
    *line = (bat_curve){.space = space, .count = 3, .points = malloc(3 * space->point_dim * sizeof(double))};
    double end[2];
    border_point(1, 1, true, 2, roughness, end);
    place(space, 0.31, 0.36, line->points);
    place(space, 0.34, 0.4, line->points + space->point_dim);
    place(space, end[0], end[1], line->points + 2 * space->point_dim);
    bat_curve_set set;
    assert_int_equal(bat_curve_set_take(curves, MAP_CURVES, &set, NULL), BAT_OK);
    return set;
}

static bat_curve_map_refine_options map_options(const char *name, size_t levels, bat_curve_map_refine_report *report)
{
    bat_curve_map_refine_options result = bat_curve_map_refine_defaults();
    result.refine = options(name, levels);
    result.topology = BAT_CURVE_MAP_TOPOLOGY_ALWAYS;
    result.report = report;
    return result;
}

static bat_curve_set refined_map(const bat_curve_set *coarse, const bat_curve_map_refine_options *how)
{
    bat_curve_set fine;
    bat_error error;
    if (bat_curve_map_refine(coarse, how, &fine, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return fine;
}

/// An edge in the plane of the test.
typedef struct flat_edge
{
    double a[2], b[2];
    size_t curve;
} flat_edge;

/// The coordinates of a point as a file with ten decimals holds them; longitudes from 0 to 360 degrees.
static void flatten(const bat_space *space, const double *point, double *flat)
{
    if (space->point_dim == 3)
    {
        degree_units units = degrees_of_point(point, degree_units_per_radian(10));
        flat[0] = (double)(units.longitude < 0 ? units.longitude + 3600000000000 : units.longitude);
        flat[1] = (double)units.latitude;
        return;
    }
    flat[0] = point[0];
    flat[1] = point[1];
}

static flat_edge *edges_of(const bat_curve_set *set, size_t *count)
{
    size_t points = 0;
    for (size_t c = 0; c < set->count; c++)
        points += set->curves[c].count;
    flat_edge *edges = calloc(points, sizeof *edges);
    *count = 0;
    for (size_t c = 0; c < set->count; c++)
    {
        const bat_curve *curve = &set->curves[c];
        for (size_t i = 0; i < curve->count - !curve->closed; i++)
        {
            flat_edge *edge = &edges[(*count)++];
            edge->curve = c;
            flatten(set->space, curve->points + i * set->space->point_dim, edge->a);
            flatten(set->space, curve->points + (i + 1) % curve->count * set->space->point_dim, edge->b);
        }
    }
    return edges;
}

static bool same(const double *p, const double *q)
{
    return p[0] == q[0] && p[1] == q[1];
}

/// The pairs of edges that meet, but for common ends and for edges that are the same.
static size_t count_crossings(const bat_curve_set *set)
{
    size_t count, found = 0;
    surface_kind kind = strcmp(set->space->name, "disk") == 0 ? SURFACE_DISK : SURFACE_PLANE;
    flat_edge *e = edges_of(set, &count);
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count; j++)
        {
            bool ends[4] = {same(e[i].a, e[j].a), same(e[i].a, e[j].b), same(e[i].b, e[j].a), same(e[i].b, e[j].b)};
            int shared = ends[0] + ends[1] + ends[2] + ends[3];
            if (shared >= 2)
                continue;
            const double *tip = ends[0] || ends[1] ? e[i].b : e[i].a, *node = ends[0] || ends[1] ? e[i].a : e[i].b;
            const double *other = ends[0] || ends[2] ? e[j].b : e[j].a;
            found += shared == 1 ? predicate_folds_back(kind, tip, node, other)
                                 : predicate_edges_meet(kind, e[i].a, e[i].b, e[j].a, e[j].b);
        }
    free(e);
    return found;
}

/// The edges that two rings share, in opposite directions or in the same.
static size_t count_shared(const bat_curve_set *set)
{
    size_t count, found = 0;
    flat_edge *e = edges_of(set, &count);
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count; j++)
            found += e[i].curve != e[j].curve &&
                     ((same(e[i].a, e[j].b) && same(e[i].b, e[j].a)) || (same(e[i].a, e[j].a) && same(e[i].b, e[j].b)));
    free(e);
    return found;
}

static const size_t INNER_BORDERS = 2 * CELLS * (CELLS - 1);

static void check_map(const bat_space *space, const char *name, double roughness, bat_curve_map_refine_report *sum)
{
    bat_curve_map_refine_report report;
    bat_curve_set coarse = make_map(space, roughness);
    assert_int_equal(count_crossings(&coarse), 0);
    for (size_t levels = 1; levels <= 3; levels++)
    {
        bat_curve_map_refine_options how = map_options(name, levels, &report);
        bat_curve_set fine = refined_map(&coarse, &how);
        assert_int_equal(count_shared(&fine), INNER_BORDERS * BORDER_EDGES << levels);
        assert_int_equal(count_crossings(&fine), 0);
        assert_int_equal(report.given_crossing, 0);
        // The line ends on an inner border, which is one arc more, beside the line.
        assert_int_equal(report.shared, INNER_BORDERS + 1);
        sum->crossings += report.crossings;
        for (size_t c = 0; c < coarse.count; c++)
            for (size_t i = 0; i < coarse.curves[c].count; i++)
                assert_memory_equal(fine.curves[c].points + (i << levels) * space->point_dim,
                                    coarse.curves[c].points + i * space->point_dim, space->point_dim * sizeof(double));
        bat_curve_set_free(&fine);
    }
    bat_curve_set_free(&coarse);
}

static void test_borders_stay_shared_and_nothing_crosses(void **state)
{
    (void)state;
    bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    bat_curve_map_refine_report sum = {0};
    for (size_t s = 0; s < 3; s++)
        for (double roughness = 0.3; roughness < 1; roughness += 0.4)
        {
            check_map(&spaces[s], "learned", roughness, &sum);
            check_map(&spaces[s], "log-exp-4", roughness, &sum);
            check_map(&spaces[s], "catmull-rom", roughness, &sum);
        }
    assert_true(sum.crossings > 20);
}

// Borders are smoothed once each, nodes stay, and what would meet comes back.
static void test_smoothing_keeps_the_map(void **state)
{
    (void)state;
    bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    for (size_t s = 0; s < 3; s++)
        for (double scale = 0.02; scale < 1; scale *= 3)
        {
            bat_curve_map_refine_report report;
            bool keeps_area = s < 2 && scale < 0.1;
            bat_curve_set coarse = make_map(&spaces[s], keeps_area ? 0.3 : 0.7);
            bat_curve_map_refine_options how = map_options("learned", 2, &report);
            how.refine.smooth = scale;
            how.keep_area = keeps_area;
            bat_curve_set fine = refined_map(&coarse, &how);
            assert_int_equal(count_shared(&fine), INNER_BORDERS * BORDER_EDGES << 2);
            assert_int_equal(count_crossings(&fine), 0);
            assert_true(report.curves.largest_move > report.curves.mean_move && report.curves.mean_move > 0);
            assert_true(!how.keep_area || (report.largest_area_error > 0 && report.largest_area_error < 1e-6));
            size_t row = spaces[s].point_dim * sizeof(double); // corner (0, 0) of the first country is a node
            assert_memory_equal(fine.curves[0].points + (BORDER_EDGES << 2) * spaces[s].point_dim,
                                coarse.curves[0].points + BORDER_EDGES * spaces[s].point_dim, row);
            bat_curve_set_free(&coarse);
            bat_curve_set_free(&fine);
        }
}

/// Whether a point lies in a ring.
static bool is_inside(const bat_curve *ring, double x, double y)
{
    bool inside = false;
    for (size_t i = 0; i < ring->count; i++)
    {
        const double *p = ring->points + 2 * i, *q = ring->points + 2 * ((i + 1) % ring->count);
        inside ^= (p[1] > y) != (q[1] > y) && x < p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]);
    }
    return inside;
}

// A narrow bay with an island: smoothing that fills the bay would put the island ashore.
static void test_smoothing_does_not_pass_over_islands(void **state)
{
    (void)state;
    enum
    {
        SIDE = 24
    };
    bat_space plane = bat_euclidean(2);
    double shore[2 * 4 * SIDE], island[] = {11.9, 22.4, 12.1, 22.4, 12, 22.6};
    for (size_t i = 0; i < SIDE; i++)
    {
        double t = (double)i, bay = i >= SIDE / 2 - 1 && i <= SIDE / 2 + 1 ? 3 : 0;
        const double sides[4][2] = {{t, 0}, {SIDE, t}, {SIDE - t, SIDE - bay}, {0, SIDE - t}};
        for (size_t k = 0; k < 4; k++)
            memcpy(shore + 2 * (k * SIDE + i), sides[k], sizeof sides[k]);
    }
    bat_curve curves[] = {{.space = &plane, .points = shore, .count = 4 * SIDE, .closed = true},
                          {.space = &plane, .points = island, .count = 3, .closed = true}};
    bat_curve_set coarse = {.space = &plane, .curves = curves, .count = 2};
    for (double scale = 5; scale < 50; scale *= 2)
    {
        bat_curve_map_refine_options how = map_options("learned", 2, NULL);
        how.refine.smooth = scale;
        bat_curve_set fine = refined_map(&coarse, &how);
        assert_int_equal(count_crossings(&fine), 0);
        assert_false(is_inside(&fine.curves[0], 12, 22.5));
        bat_curve_set_free(&fine);
    }
}

// Each crossing is mended where it begins, so that refinement through a file makes no difference.
static void test_two_and_two_levels_are_four(void **state)
{
    (void)state;
    static const char *const NAMES[] = {"four-point", "log-exp-4", "angle-6", "learned"};
    bat_space plane = bat_euclidean(2), sphere = bat_sphere(2);
    bat_curve_set maps[] = {make_map(&plane, 0.9), make_map(&sphere, 0.9)};
    for (size_t n = 0; n < 8; n++)
    {
        if (n == 4)
            continue; // the sphere has no linear schemes
        const bat_curve_set coarse = maps[n / 4];
        bat_curve_map_refine_report report;
        bat_curve_map_refine_options two = map_options(NAMES[n % 4], 2, &report),
                                     four = map_options(NAMES[n % 4], 4, &report);
        bat_curve_set half = refined_map(&coarse, &two);
        two.refine.first_level = 2;
        bat_curve_set twice = refined_map(&half, &two), once = refined_map(&coarse, &four);
        size_t shorter = 0;
        assert_true(report.crossings > 0);
        for (size_t c = 0; c < coarse.count; c++)
        {
            // Points that were drawn back to the start of their edge are dropped before further levels.
            bool dropped = once.curves[c].count != twice.curves[c].count;
            shorter += dropped;
            for (size_t i = 0; !dropped && i < coarse.space->point_dim * once.curves[c].count; i++)
                assert_true(fabs(once.curves[c].points[i] - twice.curves[c].points[i]) <= 1e-12); // 6e-11 degrees
        }
        assert_true(n < 4 ? shorter == 0 : 4 * shorter <= coarse.count);
        bat_curve_set_free(&half);
        bat_curve_set_free(&once);
        bat_curve_set_free(&twice);
    }
    bat_curve_set_free(&maps[0]);
    bat_curve_set_free(&maps[1]);
}

static void test_order_direction_and_threads_do_not_matter(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    bat_curve_set coarse = make_map(&sphere, 0.9), turned = make_map(&sphere, 0.9);
    for (size_t c = 0; c < MAP_CURVES / 2; c++)
    {
        bat_curve swap = turned.curves[c];
        turned.curves[c] = turned.curves[MAP_CURVES - 1 - c];
        turned.curves[MAP_CURVES - 1 - c] = swap;
    }
    for (size_t c = 0; c < MAP_CURVES; c++)
        for (size_t i = 0; i < turned.curves[c].count / 2; i++)
            for (size_t k = 0; k < 3; k++)
            {
                double *p = &turned.curves[c].points[3 * i + k],
                       *q = &turned.curves[c].points[3 * (turned.curves[c].count - 1 - i) + k], kept = *p;
                *p = *q;
                *q = kept;
            }
    // Below fairness 1 rough lines lose a share that magnifies rounding, and edges that meet are drawn back in steps.
    bat_curve_map_refine_options how = map_options("learned:fairness=1", 3, NULL);
    how.refine.threads = 1;
    bat_curve_set one = refined_map(&coarse, &how), other = refined_map(&turned, &how);
    how.refine.threads = 3;
    bat_curve_set three = refined_map(&coarse, &how);
    for (size_t c = 0; c < MAP_CURVES; c++)
    {
        const bat_curve *a = &one.curves[c], *b = &other.curves[MAP_CURVES - 1 - c];
        assert_int_equal(a->count, b->count);
        assert_memory_equal(a->points, three.curves[c].points, 3 * a->count * sizeof(double));
        for (size_t i = 0; i < a->count; i++)
        {
            // A ring begins with its last given point when it runs the other way.
            size_t j = a->closed ? (2 * a->count - 8 - i) % a->count : a->count - 1 - i;
            for (size_t k = 0; k < 3; k++)
                check_near(a->points[3 * i + k], b->points[3 * j + k], 1e-6);
        }
    }
    bat_curve_set_free(&coarse);
    bat_curve_set_free(&turned);
    bat_curve_set_free(&one);
    bat_curve_set_free(&other);
    bat_curve_set_free(&three);
}

static void test_separate_is_curves_refine(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    bat_curve_set coarse = make_map(&plane, 0.3);
    bat_curve fine[MAP_CURVES];
    bat_curve_map_refine_report report;
    bat_curve_map_refine_options how = map_options("learned", 3, &report);
    how.topology = BAT_CURVE_MAP_TOPOLOGY_SEPARATE;
    bat_curve_set separate = refined_map(&coarse, &how);
    assert_false(report.map);
    assert_int_equal(report.curves.checked, MAP_CURVES - 1);
    // A set without features is no map by default.
    how.topology = BAT_CURVE_MAP_TOPOLOGY_FEATURES;
    bat_curve_set features = refined_map(&coarse, &how);
    assert_false(report.map);
    assert_int_equal(bat_curves_refine(coarse.curves, MAP_CURVES, &how.refine, fine, NULL), BAT_OK);
    for (size_t c = 0; c < MAP_CURVES; c++)
    {
        assert_memory_equal(fine[c].points, separate.curves[c].points, 2 * fine[c].count * sizeof(double));
        assert_memory_equal(fine[c].points, features.curves[c].points, 2 * fine[c].count * sizeof(double));
        bat_curve_free(&fine[c]);
    }
    bat_curve_set_free(&features);
    bat_curve_set_free(&separate);
    bat_curve_set_free(&coarse);
}

/// A set of rings in the plane, given by their points one after the other.
static bat_curve_set rings_of(const bat_space *plane, const double *points, const size_t *counts, size_t count)
{
    bat_curve *curves = calloc(count, sizeof *curves);
    for (size_t c = 0; c < count; c++)
    {
        curves[c] = (bat_curve){.space = plane, .count = counts[c], .closed = true};
        curves[c].points = malloc(2 * counts[c] * sizeof(double));
        memcpy(curves[c].points, points, 2 * counts[c] * sizeof(double));
        points += 2 * counts[c];
    }
    bat_curve_set set;
    assert_int_equal(bat_curve_set_take(curves, count, &set, NULL), BAT_OK);
    return set;
}

// A tall country beside two low ones, whose common corner lies on its border but is none of its points.
static void test_point_on_a_border_becomes_its_vertex(void **state)
{
    (void)state;
    static const double POINTS[] = {0, 0, 1,     0.1,   1.05,  1.95,  0, 2, 1, 0.1, 2,    0,
                                    2, 1, 1.025, 1.025, 1.025, 1.025, 2, 1, 2, 2,   1.05, 1.95};
    static const size_t COUNTS[] = {4, 4, 4};
    bat_space plane = bat_euclidean(2);
    bat_curve_set coarse = rings_of(&plane, POINTS, COUNTS, 3);
    bat_curve_map_refine_report report;
    bat_curve_map_refine_options how = map_options("four-point", 3, &report);
    bat_curve_set fine = refined_map(&coarse, &how);
    assert_int_equal(report.snapped, 1);
    assert_int_equal(report.shared, 3);
    assert_int_equal(fine.curves[0].count, 5 * 8);
    assert_int_equal(count_shared(&fine), 3 * 8);
    assert_int_equal(count_crossings(&fine), 0);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&coarse);
}

// A ring leads there and back along a line, with other points: a short spike is dropped and told, a long one stays.
static void test_spikes_are_dropped_where_they_are_short(void **state)
{
    (void)state;
    static const double TIPS[] = {3.5, 2.4}, BACKS[] = {2.5, 2.2};
    static const size_t DROPPED[] = {0, 4}, EDGES[] = {9, 5};
    bat_space plane = bat_euclidean(2);
    for (size_t i = 0; i < 2; i++)
    {
        const double points[] = {0, 0, 2, 0, 2, 2, 1, 2, 1, TIPS[i], 1, BACKS[i], 1, 2, 0, 2};
        static const size_t COUNT[] = {8};
        bat_curve_set coarse = rings_of(&plane, points, COUNT, 1);
        bat_curve_map_refine_report report;
        bat_curve_map_refine_options how = map_options("four-point", 1, &report);
        bat_curve_set fine = refined_map(&coarse, &how);
        assert_int_equal(report.spikes, DROPPED[i]);
        assert_int_equal(fine.curves[0].count, 2 * EDGES[i]);
        bat_curve_set_free(&fine);
        bat_curve_set_free(&coarse);
    }
}

static void test_near_points_are_joined(void **state)
{
    (void)state;
    static const double POINTS[] = {0, 0, 1, 0.1, 1.1, 1, 0, 1, 1.0001, 0.1, 2, 0, 2, 1, 1.1001, 1.0002, 1.1, 0.9999};
    static const size_t COUNTS[] = {4, 5};
    bat_space plane = bat_euclidean(2);
    bat_curve_set coarse = rings_of(&plane, POINTS, COUNTS, 2);
    bat_curve_map_refine_report report;
    bat_curve_map_refine_options how = map_options("four-point", 2, &report);
    bat_curve_set fine = refined_map(&coarse, &how);
    assert_int_equal(report.shared, 0);
    assert_int_equal(report.snapped, 0);
    bat_curve_set_free(&fine);
    how.snap_tolerance = 0.001;
    fine = refined_map(&coarse, &how);
    assert_int_equal(report.shared, 1);
    assert_int_equal(report.snapped, 3);
    assert_true(fabs(report.largest_snap - hypot(1e-4, 2e-4)) < 1e-12);
    assert_int_equal(fine.curves[1].count, 4 * 4);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&coarse);
}

static double area_of(const bat_curve *curve)
{
    double sum = 0;
    for (size_t i = 0, j = curve->count - 1; i < curve->count; j = i++)
        sum += (curve->points[2 * j] * curve->points[2 * i + 1] - curve->points[2 * i] * curve->points[2 * j + 1]) / 2;
    return sum;
}

static void test_areas_are_kept(void **state)
{
    (void)state;
    static const char *const NAMES[] = {"log-exp-4", "learned"};
    bat_space plane = bat_euclidean(2), sphere = bat_sphere(2);
    for (size_t n = 0; n < 2; n++)
    {
        bat_curve_set coarse = make_map(&plane, 0.5);
        bat_curve_map_refine_report report;
        bat_curve_map_refine_options how = map_options(NAMES[n], 3, &report);
        bat_curve_set free = refined_map(&coarse, &how);
        how.keep_area = true;
        bat_curve_set fine = refined_map(&coarse, &how);
        double worst = 0, before = 0;
        for (size_t c = 0; c + 1 < MAP_CURVES; c++)
        {
            double target = area_of(&coarse.curves[c]);
            worst = fmax(worst, fabs(area_of(&fine.curves[c]) / target - 1));
            before = fmax(before, fabs(area_of(&free.curves[c]) / target - 1));
        }
        assert_true(before > 0.01);
        assert_true(worst < 1e-6);
        assert_true(fabs(worst - report.largest_area_error) < 1e-9);
        assert_int_equal(count_crossings(&fine), 0);
        assert_int_equal(count_shared(&fine), INNER_BORDERS * BORDER_EDGES * 8);
        bat_curve_set_free(&free);
        bat_curve_set_free(&fine);
        bat_curve_set_free(&coarse);

        coarse = make_map(&sphere, 0.3);
        fine = refined_map(&coarse, &how);
        assert_true(report.largest_area_error < 1e-6);
        assert_int_equal(count_crossings(&fine), 0);
        bat_curve_set_free(&fine);
        bat_curve_set_free(&coarse);
    }
}

// A thin ring of a real map, whose area could only be kept by crossings: edges of it become straight. Given edges that cross
// do not hinder the rest.
static void test_areas_of_thin_rings_are_kept(void **state)
{
    (void)state;
    static const double POINTS[] = {224,  8369, 336,  8450, 378,  8460, 342,  8448, 271,  8378, 150,  8278, 218, 8345, // one
                                    1000, 0,    1100, 10,   1200, -10,  1210, 100,  1100, 120,  1110, -20};
    static const size_t COUNTS[] = {7, 6};
    bat_space plane = bat_euclidean(2);
    bat_curve_set coarse = rings_of(&plane, POINTS, COUNTS, 2);
    bat_curve_map_refine_report report;
    bat_curve_map_refine_options how = map_options("learned", 3, &report);
    how.keep_area = true;
    bat_curve_set fine = refined_map(&coarse, &how);
    for (size_t c = 0; c < 2; c++)
        assert_true(fabs(area_of(&fine.curves[c]) / area_of(&coarse.curves[c]) - 1) < 1e-6);
    assert_true(report.drawn_back > 0 && report.given_crossing > 0);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&coarse);
}

// A channel that is the first coordinate stays so, whatever direction the arcs have.
static void test_channels_follow_the_points(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    bat_curve_set coarse = make_map(&plane, 0.3);
    for (size_t c = 0; c < MAP_CURVES; c++)
    {
        bat_curve *curve = &coarse.curves[c];
        curve->channel_count = 1;
        curve->channels = malloc(curve->count * sizeof(double));
        for (size_t i = 0; i < curve->count; i++)
            curve->channels[i] = curve->points[2 * i];
    }
    bat_curve_map_refine_options how = map_options("four-point", 3, NULL);
    how.refine.simple = BAT_CURVE_SIMPLE_NEVER;
    bat_curve_set fine = refined_map(&coarse, &how);
    for (size_t c = 0; c < MAP_CURVES; c++)
        for (size_t i = 0; i < fine.curves[c].count; i++)
            assert_true(fabs(fine.curves[c].channels[i] - fine.curves[c].points[2 * i]) < 1e-14);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&coarse);
}

// Corners are nodes, and edges between them stay straight.
static void test_corners_are_nodes(void **state)
{
    (void)state;
    static const double POINTS[] = {0, 0, 1, 0, 1, 1, 0, 1, 1, 0, 2, 0, 2, 1, 1, 1};
    static const size_t COUNTS[] = {4, 4};
    bat_space plane = bat_euclidean(2);
    bat_curve_set coarse = rings_of(&plane, POINTS, COUNTS, 2);
    bat_curve_map_refine_report report;
    bat_curve_map_refine_options how = map_options("learned", 3, &report);
    how.refine.corner_angle = 1;
    bat_curve_set fine = refined_map(&coarse, &how);
    assert_int_equal(report.curves.corners, 8);
    assert_int_equal(report.nodes, 6);
    assert_int_equal(report.arcs, 7);
    for (size_t c = 0; c < 2; c++)
    {
        assert_int_equal(fine.curves[c].count, 32);
        for (size_t i = 0; i < 32; i++)
        {
            const double *p = fine.curves[c].points + 2 * i;
            assert_int_equal(fine.curves[c].corners[i], i % 8 == 0);
            assert_true(p[0] == 0 || p[0] == 1 || p[0] == 2 || p[1] == 0 || p[1] == 1);
        }
    }
    bat_curve_set_free(&fine);
    bat_curve_set_free(&coarse);
}

// Stops give edges levels of their own; both sides of a border agree.
static void test_stops_work_on_maps(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    bat_curve_set coarse = make_map(&sphere, 0.9);
    bat_curve_map_refine_report report;
    bat_curve_map_refine_options how = map_options("learned", 5, &report);
    how.refine.max_edge = 0.005;
    bat_curve_set fine = refined_map(&coarse, &how);
    assert_true(report.curves.max_levels > report.curves.min_levels);
    assert_int_equal(count_crossings(&fine), 0);
    assert_true(count_shared(&fine) > 4 * INNER_BORDERS * BORDER_EDGES);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&coarse);
}

// A coast with a deep bay, and an island in it that the bulge of the opposite shore would swallow whole.
static void test_islands_stay_where_they_are(void **state)
{
    (void)state;
    static const double POINTS[] = {0, 0, 1, 0, 2, 0, 2, 1, 1, 1, 0, 1, 0.5, 1.02, 0.52, 1.02, 0.51, 1.03};
    static const size_t COUNTS[] = {6, 3};
    static const char *const NAMES[] = {"four-point", "catmull-rom", "angle-4"};
    bat_space plane = bat_euclidean(2);
    bat_curve_set coarse = rings_of(&plane, POINTS, COUNTS, 2);
    for (size_t n = 0; n < 3; n++)
    {
        bat_curve_map_refine_report report;
        bat_curve_map_refine_options how = map_options(NAMES[n], 4, &report);
        bat_curve_set fine = refined_map(&coarse, &how);
        const bat_curve *coast = &fine.curves[0];
        double area = area_of(coast);
        // The island is outside: the angles at which the coast is seen from it add up to 0.
        double sum = 0;
        for (size_t i = 0; i < coast->count; i++)
        {
            const double *p = coast->points + 2 * i, *q = coast->points + 2 * ((i + 1) % coast->count);
            double a[2] = {p[0] - 0.5, p[1] - 1.02}, b[2] = {q[0] - 0.5, q[1] - 1.02};
            sum += atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
        }
        assert_true(area > 2 && fabs(sum) < 1e-9);
        assert_true(report.drawn_back > 0);
        assert_int_equal(count_crossings(&fine), 0);
        bat_curve_set_free(&fine);
    }
    bat_curve_set_free(&coarse);
}

/// The distance of a point of the plane from a curve.
static double distance_from(const bat_curve *curve, const double *point)
{
    double least = INFINITY;
    for (size_t i = 0; i + !curve->closed < curve->count; i++)
    {
        const double *p = curve->points + 2 * i, *q = curve->points + 2 * ((i + 1) % curve->count);
        double along[2] = {q[0] - p[0], q[1] - p[1]}, way[2] = {point[0] - p[0], point[1] - p[1]};
        double share = (along[0] * way[0] + along[1] * way[1]) / (along[0] * along[0] + along[1] * along[1]);
        share = fmin(fmax(share, 0), 1);
        least = fmin(least, hypot(way[0] - share * along[0], way[1] - share * along[1]));
    }
    return least;
}

static void test_simplified_maps_stay_maps(void **state)
{
    (void)state;
    static const double TOLERANCES[] = {0.001, 0.01, 0.03, 0.3};
    bat_space plane = bat_euclidean(2), sphere = bat_sphere(2);
    for (size_t n = 0; n < 8; n++)
    {
        bat_curve_map_refine_report report;
        bat_curve_set coarse = make_map(n < 4 ? &plane : &sphere, 0.9), again;
        bat_curve_map_refine_options how = map_options("learned", 0, &report);
        how.simplify = TOLERANCES[n % 4];
        assert_int_equal(count_crossings(&coarse), 0);
        bat_curve_set simple = refined_map(&coarse, &how);
        assert_int_equal(count_crossings(&simple), 0);
        assert_true(report.dropped > 0);
        for (size_t c = 0; c < coarse.count; c++)
        {
            assert_true(simple.curves[c].count >= (coarse.curves[c].closed ? 3 : 2));
            for (size_t i = 0; i < coarse.curves[c].count && n < 4; i++)
                assert_true(distance_from(&simple.curves[c], coarse.curves[c].points + 2 * i) <= how.simplify * (1 + 1e-9));
        }
        // What is simple stays as it is.
        again = refined_map(&simple, &how);
        assert_int_equal(report.dropped, 0);
        bat_curve_set_free(&again);
        bat_curve_set_free(&simple);
        bat_curve_set_free(&coarse);
    }
}

static void test_what_cannot_be_is_refused(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    bat_curve_set coarse = make_map(&plane, 0.3), fine;
    bat_error error;
    bat_curve_map_refine_report report;
    bat_curve_map_refine_options how = map_options("four-point", 2, NULL);
    how.refine.ends = BAT_CURVE_END_RULE_FREE;
    assert_int_equal(bat_curve_map_refine(&coarse, &how, &fine, &error), BAT_UNSUPPORTED);
    how = map_options("four-point", 2, NULL);
    coarse.curves[3].points[2 * 7] = NAN;
    assert_int_equal(bat_curve_map_refine(&coarse, &how, &fine, &error), BAT_INVALID_POINT);
    assert_int_equal(error.curve, 3);
    assert_int_equal(error.index, 7);
    bat_curve_set_free(&coarse);

    // Corner cutting moves a spit of land over a narrow island, and cannot be drawn back to the given points.
    static const double POINTS[] = {0, 0, 4, 0, 4, 3, 2, 0.3, 0, 3, 1.9, 0.45, 2.1, 0.45, 2, 2};
    static const size_t COUNTS[] = {5, 3};
    coarse = rings_of(&plane, POINTS, COUNTS, 2);
    assert_int_equal(count_crossings(&coarse), 0);
    how = map_options("chaikin", 3, NULL);
    assert_int_equal(bat_curve_map_refine(&coarse, &how, &fine, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error.text, "crosses"));
    how.refine.simple = BAT_CURVE_SIMPLE_NEVER;
    assert_int_equal(bat_curve_map_refine(&coarse, &how, &fine, &error), BAT_OK);
    assert_true(count_crossings(&fine) > 0);
    bat_curve_set_free(&fine);
    bat_curve_set_free(&coarse);

    // The second of two rings is a bow tie, which stays one unless that is refused.
    static const double BOW_TIE[] = {10, 0, 11, 0, 11, 1, 0, 0, 2, 2, 2, 0, 0, 2};
    coarse = rings_of(&plane, BOW_TIE, (const size_t[]){3, 4}, 2);
    how = map_options("four-point", 3, &report);
    fine = refined_map(&coarse, &how);
    assert_int_equal(report.given_crossing, 1);
    bat_curve_set_free(&fine);
    how.refine.strict = true;
    assert_int_equal(bat_curve_map_refine(&coarse, &how, &fine, &error), BAT_INVALID_POINT);
    assert_int_equal(error.curve, 1);
    assert_int_equal(error.index, 0);
    bat_curve_set_free(&coarse);
}

// A vertex lies within rounding of another edge of its ring. The ring stays as it is, or is refused.
static void test_rings_that_nearly_touch_themselves_stay(void **state)
{
    (void)state;
    static const double POINTS[] = {10,
                                    10,
                                    12,
                                    10,
                                    12,
                                    13,
                                    10,
                                    12,
                                    1.888888888888889,
                                    3.777777777777778,
                                    1.6666666666666667,
                                    3.8333333333333335,
                                    3.25,
                                    4.625,
                                    4.2,
                                    3.2,
                                    1.9230769230769231,
                                    3.7692307692307696,
                                    2,
                                    4};
    bat_space plane = bat_euclidean(2);
    bat_curve_map_refine_report report;
    bat_error error;
    bat_curve_set fine, coarse = rings_of(&plane, POINTS, (const size_t[]){4, 6}, 2);
    bat_curve_map_refine_options how = map_options("four-point", 3, &report);
    fine = refined_map(&coarse, &how);
    assert_int_equal(report.given_crossing, 1);
    assert_int_equal(report.curves.corners, 0);
    assert_int_equal(fine.curves[0].count, 4 * 8);
    assert_int_equal(fine.curves[1].count, 6);
    assert_memory_equal(fine.curves[1].points, POINTS + 8, 12 * sizeof *POINTS);
    bat_curve_set_free(&fine);
    how.refine.strict = true;
    assert_int_equal(bat_curve_map_refine(&coarse, &how, &fine, &error), BAT_INVALID_POINT);
    assert_int_equal(error.curve, 1);
    assert_string_equal(error.remedy, "simple");
    bat_curve_set_free(&coarse);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_borders_stay_shared_and_nothing_crosses),
        cmocka_unit_test(test_smoothing_keeps_the_map),
        cmocka_unit_test(test_smoothing_does_not_pass_over_islands),
        cmocka_unit_test(test_two_and_two_levels_are_four),
        cmocka_unit_test(test_order_direction_and_threads_do_not_matter),
        cmocka_unit_test(test_separate_is_curves_refine),
        cmocka_unit_test(test_point_on_a_border_becomes_its_vertex),
        cmocka_unit_test(test_spikes_are_dropped_where_they_are_short),
        cmocka_unit_test(test_near_points_are_joined),
        cmocka_unit_test(test_areas_are_kept),
        cmocka_unit_test(test_areas_of_thin_rings_are_kept),
        cmocka_unit_test(test_channels_follow_the_points),
        cmocka_unit_test(test_corners_are_nodes),
        cmocka_unit_test(test_stops_work_on_maps),
        cmocka_unit_test(test_islands_stay_where_they_are),
        cmocka_unit_test(test_simplified_maps_stay_maps),
        cmocka_unit_test(test_what_cannot_be_is_refused),
        cmocka_unit_test(test_rings_that_nearly_touch_themselves_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
