// Paths on the page: simplified within a bound, cut at the outline of the globe and at the edge of the map, drawn along
// geodesics; views, combs and coverage masks.

#include "picture_helpers.h"

#include "draw/curve/scene.h"
#include "draw/curve/view.h"

/// The segments of a path.
typedef struct recording
{
    double (*points)[2];
    bool *moves;
    size_t count;
    size_t capacity;
} recording;

static void record(void *context, double x, double y, bool move)
{
    recording *log = context;
    if (log->count == log->capacity)
    {
        log->capacity = 2 * log->capacity + 64;
        log->points = realloc(log->points, log->capacity * sizeof *log->points);
        log->moves = realloc(log->moves, log->capacity * sizeof *log->moves);
        assert_true(log->points != NULL && log->moves != NULL);
    }
    log->points[log->count][0] = x;
    log->points[log->count][1] = y;
    log->moves[log->count++] = move;
}

static void forget(recording *log)
{
    free(log->points);
    free(log->moves);
    *log = (recording){0};
}

static path_simplifier recorder(recording *log, double tolerance)
{
    return simplifier_begin((path_sink){record, log}, tolerance);
}

static double distance_to_segment(const double *p, const double *a, const double *b)
{
    double dx = b[0] - a[0];
    double dy = b[1] - a[1];
    double square = dx * dx + dy * dy;
    double share = square > 0.0 ? ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square : 0.0;
    share = fmin(fmax(share, 0.0), 1.0);
    return hypot(p[0] - a[0] - share * dx, p[1] - a[1] - share * dy);
}

/// Simplify a path of `count` points and check each point against its segment of the result.
/// @return the number of remaining points
static size_t check_simplified(double (*path)[2], size_t count, double tolerance)
{
    recording log = {0};
    path_simplifier simplifier = recorder(&log, tolerance);
    simplifier_move(&simplifier, path[0][0], path[0][1]);
    for (size_t i = 1; i < count; i++)
    {
        simplifier_line(&simplifier, path[i][0], path[i][1]);
    }
    simplifier_flush(&simplifier);
    assert_true(log.moves[0]);
    assert_memory_equal(log.points[0], path[0], sizeof path[0]);
    assert_memory_equal(log.points[log.count - 1], path[count - 1], sizeof path[0]);
    size_t piece = 0; // the points before path[i] belong to earlier segments or to this one
    for (size_t i = 0; i < count; i++)
    {
        while (piece + 2 < log.count && memcmp(log.points[piece + 1], path[i], sizeof path[i]) == 0)
        {
            piece++;
        }
        double here = distance_to_segment(path[i], log.points[piece], log.points[piece + 1]);
        assert_true(here <= tolerance);
    }
    size_t kept = log.count;
    forget(&log);
    return kept;
}

/// Smooth, rough, straight and reversing paths: no dropped point is farther from its segment than the tolerance.
static void simplifier_keeps_its_bound(void **state)
{
    (void)state;
    enum
    {
        COUNT = 20000
    };
    static double path[COUNT][2];
    bat_random random = bat_random_seed(5);
    for (int kind = 0; kind < 6; kind++)
    {
        double x = 0.0;
        double y = 0.0;
        double heading = 0.0;
        for (int i = 0; i < COUNT; i++)
        {
            double t = (double)i / COUNT;
            heading += kind == 1 ? 0.05 * bat_random_normal(&random) : 0.0;
            double step = kind == 3 ? 0.02 * bat_random_normal(&random) : 0.01;
            x = kind == 0 ? 200.0 * cos(2.0 * PI * t) : kind == 4 ? 40.0 * sin(30.0 * t) : x + step * cos(heading);
            y = kind == 0 ? 200.0 * sin(2.0 * PI * t) : kind == 4 ? 40.0 * sin(30.0 * t) : y + step * sin(heading);
            x += kind == 2 ? 0.3 * bat_random_normal(&random) : 0.0;
            y += kind == 5 ? 0.02 * bat_random_normal(&random) : 0.0;
            path[i][0] = x;
            path[i][1] = y;
        }
        const double tolerances[] = {0.02, 0.1, 1.0};
        for (int k = 0; k < 3; k++)
        {
            check_simplified(path, COUNT, tolerances[k]);
        }
    }
}

/// A chord of sagitta s on a circle of radius r spans sqrt(8 s / r), so a circle needs about 2 pi sqrt(r / (8 s)) chords.
static void simplifier_thins_circles(void **state)
{
    (void)state;
    enum
    {
        COUNT = 200000
    };
    static double path[COUNT][2];
    const double radius = 300.0;
    const double tolerance = 0.1;
    for (int i = 0; i < COUNT; i++)
    {
        path[i][0] = radius * cos(2.0 * PI * i / COUNT);
        path[i][1] = radius * sin(2.0 * PI * i / COUNT);
    }
    size_t kept = check_simplified(path, COUNT, tolerance);
    double least = 2.0 * PI * sqrt(radius / (8.0 * tolerance));
    assert_true((double)kept < 2.0 * least + 2.0);
}

static draw_view unit_view(view_kind kind, const bat_space *space)
{
    return (draw_view){
        .kind = kind, .space = view_space_of(space), .point_dim = space->point_dim, .scale = 1.0, .tolerance = 1e-4};
}

/// The coordinates (u, v) of a unit view from those on the page.
static void to_unit_view(recording *log)
{
    for (size_t i = 0; i < log->count; i++)
    {
        log->points[i][1] = -log->points[i][1];
    }
}

/// A triangle whose edges cross the outline: the path on each side begins and ends on the outline and lies on the edges'
/// great circles.
static void globe_is_cut_at_the_outline(void **state)
{
    (void)state;
    const double corners[] = {1.0, 0.0, 0.0, -0.6, 0.8, 0.0, -0.48, -0.36, 0.8};
    draw_view view = unit_view(VIEW_GLOBE, &sphere);
    view_set_globe(&view, 0.3, 0.2);
    for (int side = VIEW_FRONT; side <= VIEW_BACK; side++)
    {
        recording log = {0};
        path_simplifier path = recorder(&log, 0.0);
        view_trace(&view, corners, 3, true, (view_side)side, &path);
        to_unit_view(&log);
        size_t cuts = 0;
        for (size_t i = 0; i < log.count; i++)
        {
            double u = log.points[i][0];
            double v = log.points[i][1];
            double rest = 1.0 - u * u - v * v;
            assert_true(rest > -1e-9);
            bool first = log.moves[i] && i > 0;
            bool last = i + 1 == log.count || log.moves[i + 1];
            bool corner = side == VIEW_FRONT && (i == 0 || i + 1 == log.count);
            if ((first || last || log.moves[i]) && !corner)
            {
                assert_true(fabs(hypot(u, v) - 1.0) < 1e-9);
                cuts++;
            }
            double depth = (side == VIEW_FRONT ? 1.0 : -1.0) * sqrt(fmax(rest, 0.0));
            double least = INFINITY;
            for (int k = 0; k < 3; k++)
            {
                double p[3];
                double q[3];
                view_rotate(&view, corners + (size_t)(3 * k), p);
                view_rotate(&view, corners + (size_t)(3 * ((k + 1) % 3)), q);
                double normal[3] = {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
                least = fmin(least, fabs(normal[0] * u + normal[1] * v + normal[2] * depth));
            }
            assert_true(least < (fabs(rest) < 1e-9 ? 1e-9 : 1e-7));
        }
        assert_int_equal(cuts, 2);
        forget(&log);
    }
}

/// The halves of a tilted great circle are two half ellipses between points of the outline.
static void globe_halves_a_great_circle(void **state)
{
    (void)state;
    bat_curve circle = make_curve(&sphere, 360, true);
    for (size_t i = 0; i < circle.count; i++)
    {
        set_direction(circle.points + 3 * i, 2.0 * PI * ((double)i + 0.37) / 360.0, 0.0);
    }
    draw_view view = unit_view(VIEW_GLOBE, &sphere);
    view_set_globe(&view, 1.0, 0.5);
    for (int side = VIEW_FRONT; side <= VIEW_BACK; side++)
    {
        recording log = {0};
        path_simplifier path = recorder(&log, 0.0);
        view_trace(&view, circle.points, circle.count, true, (view_side)side, &path);
        to_unit_view(&log);
        double limit = 0.0;
        for (size_t i = 0; i < log.count; i++)
        {
            double u = log.points[i][0];
            double v = log.points[i][1];
            assert_true(side == VIEW_FRONT ? v < 1e-9 : v > -1e-9);
            assert_true(fabs(u * u + pow(v / sin(0.5), 2.0) - 1.0) < 1e-9);
            limit = fmax(limit, fabs(u));
        }
        assert_true(limit > 1.0 - 1e-9);
        forget(&log);
    }
    free(circle.points);
}

/// Invert the Equal Earth projection by bisection.
static void from_equal_earth(const double *place, double *longitude, double *latitude)
{
    double low = -0.5 * PI;
    double high = 0.5 * PI;
    double unit = 1.0;
    for (int i = 0; i < 60; i++)
    {
        double v;
        *latitude = 0.5 * (low + high);
        view_equal_earth(1.0, *latitude, &unit, &v);
        low = v < place[1] ? *latitude : low;
        high = v < place[1] ? high : *latitude;
    }
    *longitude = place[0] / unit;
}

/// An arc across the antimeridian is cut where its great circle crosses it.
static void map_is_cut_at_the_antimeridian(void **state)
{
    (void)state;
    double arc[6];
    set_direction(arc, 170.0 * PI / 180.0, 0.2);
    set_direction(arc + 3, -150.0 * PI / 180.0, 0.9);
    double normal[3] = {arc[1] * arc[5] - arc[2] * arc[4], arc[2] * arc[3] - arc[0] * arc[5],
                        arc[0] * arc[4] - arc[1] * arc[3]};
    double crossing = atan(normal[0] / normal[2]); // n . (-cos b, 0, sin b) = 0
    draw_view view = unit_view(VIEW_MAP, &sphere);
    view_set_map(&view, 0.0);
    recording log = {0};
    path_simplifier path = recorder(&log, 0.0);
    view_trace(&view, arc, 2, false, VIEW_FRONT, &path);
    to_unit_view(&log);
    size_t cuts = 0;
    for (size_t i = 1; i < log.count; i++)
    {
        if (log.moves[i])
        {
            cuts++;
            double u;
            double v;
            view_equal_earth(PI, crossing, &u, &v);
            assert_true(fabs(log.points[i - 1][0] - u) < 1e-12 && log.points[i][0] == -log.points[i - 1][0]);
            assert_true(fabs(log.points[i - 1][1] - v) < 1e-12);
            assert_true(log.points[i][1] == log.points[i - 1][1]);
        }
        else
        {
            assert_true(fabs(log.points[i][0] - log.points[i - 1][0]) < 0.2);
        }
        double longitude;
        double latitude;
        double point[3];
        from_equal_earth(log.points[i], &longitude, &latitude);
        set_direction(point, longitude, latitude);
        assert_true(fabs(normal[0] * point[0] + normal[1] * point[1] + normal[2] * point[2]) < 1e-10);
    }
    assert_int_equal(cuts, 1);
    forget(&log);
}

/// No line of a map crosses it from side to side, also for points on the antimeridian.
static void map_has_no_streaks(void **state)
{
    (void)state;
    draw_view view = unit_view(VIEW_MAP, &sphere);
    view_set_map(&view, 0.0);
    bat_random random = bat_random_seed(9);
    for (int trial = 0; trial < 200; trial++)
    {
        double points[15];
        for (int i = 0; i < 5; i++)
        {
            double longitude = i == 2 ? PI : PI * (2.0 * bat_random_uniform(&random) - 1.0);
            set_direction(points + (size_t)(3 * i), longitude, 1.4 * (2.0 * bat_random_uniform(&random) - 1.0));
        }
        points[7] = trial % 2 == 0 ? 0.0 : -0.0;
        recording log = {0};
        path_simplifier path = recorder(&log, 0.0);
        view_trace(&view, points, 5, true, VIEW_FRONT, &path);
        for (size_t i = 1; i < log.count; i++)
        {
            double place[2] = {log.points[i][0], -log.points[i][1]};
            double longitude;
            double latitude;
            from_equal_earth(place, &longitude, &latitude);
            assert_true(fabs(longitude) <= PI + 1e-12);
            assert_true(log.moves[i] || fabs(log.points[i][0] - log.points[i - 1][0]) < 0.5 * EQUAL_EARTH_HALF_WIDTH);
            assert_true(!log.moves[i] || fabs(fabs(longitude) - PI) < 1e-10);
        }
        forget(&log);
    }
}

/// Poincaré's distance.
static double disk_distance(const double *p, const double *q)
{
    double square = pow(p[0] - q[0], 2.0) + pow(p[1] - q[1], 2.0);
    double room = (1.0 - p[0] * p[0] - p[1] * p[1]) * (1.0 - q[0] * q[0] - q[1] * q[1]);
    return 2.0 * asinh(sqrt(square / room));
}

/// Distances between consecutive points of a geodesic add up to its length.
static void disk_edges_are_geodesics(void **state)
{
    (void)state;
    draw_view view = unit_view(VIEW_POINCARE, &disk);
    bat_random random = bat_random_seed(3);
    for (int trial = 0; trial < 300; trial++)
    {
        double ends[4];
        for (int i = 0; i < 2; i++)
        {
            double radius = tanh(2.0 * bat_random_uniform(&random));
            double angle = trial % 10 == 0 ? 0.7 + PI * i : 2.0 * PI * bat_random_uniform(&random);
            ends[2 * i] = radius * cos(angle);
            ends[2 * i + 1] = radius * sin(angle);
        }
        recording log = {0};
        path_simplifier path = recorder(&log, 0.0);
        view_trace(&view, ends, 2, false, VIEW_FRONT, &path);
        to_unit_view(&log);
        double whole = disk_distance(ends, ends + 2);
        for (size_t i = 0; i < log.count; i++)
        {
            double detour = disk_distance(ends, log.points[i]) + disk_distance(log.points[i], ends + 2) - whole;
            assert_true(detour < 1e-9 * (1.0 + whole));
        }
        for (size_t i = 1; i + 1 < log.count; i++)
        {
            double middle[2] = {0.5 * (log.points[i][0] + log.points[i - 1][0]),
                                0.5 * (log.points[i][1] + log.points[i - 1][1])};
            double radius = hypot(middle[0], middle[1]);
            assert_true(radius < 1.0);
        }
        forget(&log);
    }
}

static void automatic_view_finds_the_middle(void **state)
{
    (void)state;
    const double longitudes[] = {0.0, 2.0, -3.0};
    const double latitudes[] = {0.0, 0.9, -1.2};
    for (int i = 0; i < 3; i++)
    {
        bat_curve circle = make_curve(&sphere, 500, true);
        draw_view view = unit_view(VIEW_GLOBE, &sphere);
        view_set_globe(&view, longitudes[i], latitudes[i]);
        for (size_t k = 0; k < circle.count; k++)
        {
            double angle = 2.0 * PI * (double)k / (double)circle.count;
            double local[3] = {sin(0.7) * cos(angle), sin(0.7) * sin(angle), cos(0.7)};
            for (int c = 0; c < 3; c++)
            {
                circle.points[3 * k + (size_t)c] =
                    view.rotation[0][c] * local[0] + view.rotation[1][c] * local[1] + view.rotation[2][c] * local[2];
            }
        }
        const bat_curve *curves[] = {&circle};
        double longitude;
        double latitude;
        view_automatic(curves, 1, &longitude, &latitude);
        assert_true(fabs(remainder(longitude - longitudes[i], 2.0 * PI)) < 1e-9);
        assert_true(fabs(latitude - latitudes[i]) < 1e-9);
        free(circle.points);
    }
}

/// A great circle has no mean direction. It is seen from 25 degrees above its plane, from the north.
static void automatic_view_of_a_great_circle_is_oblique(void **state)
{
    (void)state;
    const double inclination = 0.9;
    bat_curve circle = make_curve(&sphere, 400, true);
    for (size_t i = 0; i < circle.count; i++)
    {
        double t = 2.0 * PI * (double)i / (double)circle.count;
        double *p = circle.points + 3 * i;
        p[0] = cos(t);
        p[1] = sin(t) * cos(inclination);
        p[2] = sin(t) * sin(inclination);
    }
    const bat_curve *curves[] = {&circle};
    double longitude;
    double latitude;
    view_automatic(curves, 1, &longitude, &latitude);
    double eye[3];
    set_direction(eye, longitude, latitude);
    double height = -sin(inclination) * eye[1] + cos(inclination) * eye[2];
    assert_true(fabs(height - sin(25.0 * PI / 180.0)) < 1e-6);
    free(circle.points);
}

/// The regular n-gon of radius r has the curvature (2 pi / n) / edge. Its limit is 1/r in the plane, cot r on the sphere and
/// coth r in the hyperbolic plane; segments point away from the centre.
static void comb_measures_circles(void **state)
{
    (void)state;
    const bat_space *spaces[] = {&plane, &solid, &sphere, &disk};
    const double radius = 0.8;
    const double expected[] = {1.0 / radius, 1.0 / radius, 1.0 / tan(radius), 1.0 / tanh(radius)};
    for (size_t s = 0; s < 4; s++)
    {
        bat_curve circle = make_curve(spaces[s], 2000, true);
        for (size_t i = 0; i < circle.count; i++)
        {
            double angle = 2.0 * PI * (double)i / (double)circle.count;
            double *p = circle.points + i * spaces[s]->point_dim;
            double reach = s < 2 ? radius : s == 2 ? sin(radius) : tanh(0.5 * radius);
            p[0] = reach * cos(angle);
            p[1] = reach * sin(angle);
            if (s == 2)
            {
                p[2] = cos(radius);
            }
        }
        comb segments;
        assert_int_equal(comb_make(&circle, &segments, NULL), BAT_OK);
        assert_int_equal(segments.count, circle.count);
        for (size_t i = 0; i < segments.count; i++)
        {
            size_t n = segments.point_dim;
            double size = 0.0;
            for (size_t k = 0; k < n; k++)
            {
                size += segments.vectors[i * n + k] * segments.vectors[i * n + k];
            }
            assert_true(fabs(sqrt(size) - expected[s]) < 1e-5);
            double tip[3];
            comb_tip(&segments, i, 0.1, tip);
            double reach = radius + 0.1 * expected[s];
            double paper = s < 2 ? reach : s == 2 ? sin(reach) : tanh(0.5 * reach);
            assert_true(fabs(hypot(tip[0], tip[1]) - paper) < 1e-6);
        }
        double scale;
        assert_int_equal(comb_natural_scale(&segments, 0.5, 1.0, &scale, NULL), BAT_OK);
        assert_true(fabs(scale - 0.5 / expected[s]) < 1e-5);
        memory_pool_free(&segments.pool);
        free(circle.points);
    }
}

static void comb_of_a_line_is_flat(void **state)
{
    (void)state;
    bat_curve line = make_curve(&plane, 20000, false);
    for (size_t i = 0; i < line.count; i++)
    {
        line.points[2 * i] = (double)i;
    }
    comb segments;
    assert_int_equal(comb_make(&line, &segments, NULL), BAT_OK);
    assert_true(segments.count <= COMB_MAX_POINTS && segments.count > COMB_MAX_POINTS / 2);
    double scale;
    assert_int_equal(comb_natural_scale(&segments, 1.0, 2.0, &scale, NULL), BAT_OK);
    assert_true(isinf(scale));
    memory_pool_free(&segments.pool);
    free(line.points);
}

/// The coverage mask of noise is its band, for any number of points; every point of the line is covered.
static void rough_curves_have_coverage_masks(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(7);
    bat_curve noise = make_curve(&plane, 300000, true);
    for (size_t i = 0; i < noise.count; i++)
    {
        double angle = 2.0 * PI * (double)i / (double)noise.count;
        double radius = 1.0 + 0.05 * bat_random_uniform(&random);
        noise.points[2 * i] = radius * cos(angle);
        noise.points[2 * i + 1] = radius * sin(angle);
    }
    char path[128];
    path_of(path, "rough.svg");
    bat_curve_picture_layer layer = {.curve = &noise, .role = BAT_CURVE_LAYER_ROLE_CURVE};
    assert_int_equal(bat_curve_picture_write(path, &(bat_curve_picture_panel){&layer, 1, NULL}, 1, NULL, NULL), BAT_OK);
    size_t size;
    free(slurp(path, &size));
    assert_true(size < 2000000);
    assert_int_equal(unlink(path), 0);
    free(noise.points);

    coverage_map map;
    assert_int_equal(coverage_begin(-3.0, -2.0, 3.0, 2.0, &map, NULL), BAT_OK);
    path_sink sink = coverage_sink(&map);
    const double ends[4] = {-3.0, 2.0, 2.9, -1.7};
    sink.add(sink.context, ends[0], ends[1], true);
    sink.add(sink.context, ends[2], ends[3], false);
    size_t marks = 0;
    for (size_t row = 0; row < map.rows; row++)
    {
        for (size_t column = 0; column < map.columns; column++)
        {
            double middle[2] = {-3.0 + ((double)column + 0.5) * COVERAGE_CELL, -2.0 + ((double)row + 0.5) * COVERAGE_CELL};
            double away = distance_to_segment(middle, ends, ends + 2);
            bool marked = (map.words[row * map.stride + column / 64] >> column % 64 & 1u) != 0;
            assert_true(marked ? away <= 0.2 : away >= 0.25 * COVERAGE_CELL);
            marks += marked ? 1 : 0;
        }
    }
    assert_true((double)marks > hypot(5.9, 3.7) / COVERAGE_CELL / sqrt(2.0));
    coverage_free(&map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(simplifier_keeps_its_bound),
        cmocka_unit_test(simplifier_thins_circles),
        cmocka_unit_test(globe_is_cut_at_the_outline),
        cmocka_unit_test(globe_halves_a_great_circle),
        cmocka_unit_test(map_is_cut_at_the_antimeridian),
        cmocka_unit_test(map_has_no_streaks),
        cmocka_unit_test(disk_edges_are_geodesics),
        cmocka_unit_test(automatic_view_finds_the_middle),
        cmocka_unit_test(automatic_view_of_a_great_circle_is_oblique),
        cmocka_unit_test(comb_measures_circles),
        cmocka_unit_test(comb_of_a_line_is_flat),
        cmocka_unit_test(rough_curves_have_coverage_masks),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
