// Shells: closed and open surfaces of any shape from points and meshes.

#include "check.h"

#include "batten/batten.h"
#include "linalg/vector.h"
#include "surface/shell/shell.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double PI = 3.14159265358979323846;

typedef struct scatter
{
    double *points;
    size_t count;
} scatter;

static scatter scatter_make(size_t count)
{
    scatter made = {calloc(3 * count, sizeof(double)), count};
    assert_non_null(made.points);
    return made;
}

/// Evenly spread points of a unit sphere, or random ones up to a height; `noise` is added to each coordinate.
static scatter sphere(size_t count, double top, double noise)
{
    scatter made = scatter_make(count);
    bat_random random = bat_random_seed(7);
    for (size_t i = 0; i < count; i++)
    {
        bool even = top == 1;
        double share = even ? ((double)i + 0.5) / (double)count : bat_random_uniform(&random);
        double z = -1 + share * (1 + top),
               turn = even ? 2.399963229728653 * (double)i : 2 * PI * bat_random_uniform(&random);
        double place[3] = {sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
        for (size_t c = 0; c < 3; c++)
            made.points[3 * i + c] = place[c] + noise * bat_random_normal(&random);
    }
    return made;
}

/// Random points of a torus with the radii 1 and 0.4.
static scatter torus(size_t count)
{
    scatter made = scatter_make(count);
    bat_random random = bat_random_seed(3);
    for (size_t i = 0; i < count;)
    {
        double a = 2 * PI * bat_random_uniform(&random), b = 2 * PI * bat_random_uniform(&random);
        if (bat_random_uniform(&random) * 1.4 > 1 + 0.4 * cos(b))
            continue;
        made.points[3 * i] = (1 + 0.4 * cos(b)) * cos(a);
        made.points[3 * i + 1] = (1 + 0.4 * cos(b)) * sin(a);
        made.points[3 * i++ + 2] = 0.4 * sin(b);
    }
    return made;
}

static bat_mesh_summary summary_of(const bat_shell *shell, size_t samples)
{
    bat_mesh sampled, triangles;
    bat_mesh_summary summary;
    check_status(bat_shell_tessellate(shell, samples, &sampled, NULL), BAT_OK);
    check_status(bat_mesh_triangulate(&sampled, &triangles, NULL), BAT_OK);
    check_status(bat_mesh_summarize(&triangles, &summary, NULL), BAT_OK);
    bat_mesh_free(&sampled);
    bat_mesh_free(&triangles);
    return summary;
}

/// Euler's number of a shell.
static int64_t euler_of(const bat_shell *shell)
{
    return summary_of(shell, 2).euler;
}

static void a_sphere_is_closed_and_round(void **state)
{
    (void)state;
    scatter made = sphere(3000, 1, 0);
    bat_shell shell;
    bat_shell_report report;
    check_status(bat_shell_reconstruct(made.points, made.count, NULL, NULL, &shell, &report, NULL), BAT_OK);
    assert_true(shell.closed);
    assert_int_equal(report.pieces, 1);
    assert_int_equal(report.holes, 0);
    assert_int_equal(euler_of(&shell), 2);
    check_near(report.volume, 4 * PI / 3, 2e-3);
    assert_true(report.largest < 3e-3);
    for (size_t f = 0; f < shell.face_count; f++)
    {
        double point[3], normal[3];
        check_status(bat_shell_evaluate(&shell, f, 0.3, 0.8, point, normal, NULL), BAT_OK);
        check_near(point[0] * point[0] + point[1] * point[1] + point[2] * point[2], 1, 2e-2);
        assert_true(point[0] * normal[0] + point[1] * normal[1] + point[2] * normal[2] > 0.9);
    }
    double point[3];
    check_status(bat_shell_evaluate(&shell, shell.face_count, 0.5, 0.5, point, NULL, NULL), BAT_INVALID_ARGUMENT);
    bat_shell_free(&shell);
    free(made.points);
}

/// Noise that is the same in all directions moves the mean of points outwards; the shell stays where the surface is.
static void noise_does_not_swell(void **state)
{
    (void)state;
    scatter made = sphere(6000, 1, 0.03);
    bat_shell shell;
    bat_shell_report report;
    bat_error error = {0};
    if (bat_shell_reconstruct(made.points, made.count, NULL, NULL, &shell, &report, &error) != BAT_OK)
        fail_msg("%s", error.text);
    check_near(report.noise, 0.03, 0.002);
    // The mean square of the points' radii alone would give 0.4 % more.
    check_near(report.volume, 4 * PI / 3, 0.003 * 4 * PI / 3);
    bat_shell_free(&shell);
    free(made.points);
}

static void a_shell_follows_a_patch_that_failed(void **state)
{
    (void)state;
    bat_error failure = {.remedy = "shell"};
    bat_surface_reconstruct_options patch = bat_surface_reconstruct_defaults();
    bat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();
    options.faces = 70;
    patch.fit.tolerance = 0.5;
    patch.force = true;
    assert_true(bat_shell_follows(&patch, false, &failure, &options));
    check_near(options.tolerance, 0.5, 0);
    assert_true(options.force);
    assert_int_equal(options.faces, 70);
    assert_false(bat_shell_follows(&patch, true, &failure, &options));
    patch.trim = true;
    assert_false(bat_shell_follows(&patch, false, &failure, &options));
    patch.trim = false;
    failure = (bat_error){.remedy = "boundary"};
    assert_false(bat_shell_follows(&patch, false, &failure, &options));
}

static void a_torus_keeps_its_hole(void **state)
{
    (void)state;
    scatter made = torus(5000);
    bat_shell shell;
    bat_shell_report report;
    check_status(bat_shell_reconstruct(made.points, made.count, NULL, NULL, &shell, &report, NULL), BAT_OK);
    assert_true(shell.closed);
    assert_int_equal(euler_of(&shell), 0);
    // 99 % of the angles between normals: 0.6 degrees without moves of Bézier points.
    assert_true(report.normal_jump[1] < 0.005);
    check_near(report.volume, 2 * PI * PI * 0.16, 2e-3);
    bat_shell_free(&shell);
    free(made.points);
}

/// Random points of a box fold a fit with many control points at its edges. These become creases.
static void a_box_has_sharp_edges(void **state)
{
    (void)state;
    static const double SIZE[3] = {1, 0.6, 0.4}, SPACING = 0.05;
    scatter made = scatter_make(4000);
    bat_random random = bat_random_seed(5);
    for (size_t i = 0; i < made.count; i++)
    {
        double at = 1.24 * bat_random_uniform(&random);
        size_t axis = at < 0.24 ? 0 : at < 0.64 ? 1 : 2;
        for (size_t c = 0; c < 3; c++)
            made.points[3 * i + c] = SIZE[c] * (2 * bat_random_uniform(&random) - 1);
        made.points[3 * i + axis] = bat_random_uniform(&random) < 0.5 ? -SIZE[axis] : SIZE[axis];
    }
    bat_shell shell;
    bat_shell_report report;
    check_status(bat_shell_reconstruct(made.points, made.count, NULL, NULL, &shell, &report, NULL), BAT_OK);
    assert_true(shell.closed);
    assert_int_equal(report.turned, 0);
    assert_int_equal(report.crossings, 0);
    check_near(report.volume, 1.92, 5e-4);
    // Control points of creases lie on the edges to one spacing: two coordinates are those of the box. Each of the twelve
    // edges has some.
    unsigned edges = 0;
    assert_true(report.rms < 1e-3);
    assert_true(shell.cage.crease_count > 50);
    for (size_t k = 0; k < shell.cage.crease_count; k++)
    {
        const double *at = shell.cage.positions + 3 * (size_t)shell.cage.creases[k].a;
        unsigned beside = 0, along = 0, sides = 0;
        for (unsigned c = 0; c < 3; c++)
            if (fabs(fabs(at[c]) - SIZE[c]) < SPACING)
            {
                beside++;
                sides = 2 * sides + (at[c] > 0);
            }
            else
                along = c;
        assert_true(beside >= 2);
        if (beside == 2)
            edges |= 1U << (4 * along + sides);
    }
    assert_int_equal(edges, 0xfff);
    bat_shell_free(&shell);
    // Creases need no more faces than were asked for, and half as many again; a box has 24 at least.
    bat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();
    options.force = true;
    for (options.faces = 8; options.faces <= 80; options.faces *= 10)
    {
        check_status(bat_shell_reconstruct(made.points, made.count, NULL, &options, &shell, NULL, NULL), BAT_OK);
        assert_true(shell.cage.crease_count > 0);
        assert_in_range(shell.face_count, 16, options.faces == 8 ? 24 : 120);
        bat_shell_free(&shell);
    }
    free(made.points);
}

/// Ripples around a pole get more faces than the smooth rest: with even ones, held-out points were .00084 away.
static void ripples_get_more_faces(void **state)
{
    (void)state;
    scatter made = sphere(6000, 1, 0);
    for (size_t i = 0; i < made.count; i++)
    {
        double angle = acos(made.points[3 * i + 2]);
        for (size_t c = 0; c < 3; c++)
            made.points[3 * i + c] *= 1 + 0.03 * cos(20 * angle) * exp(-4 * angle * angle);
    }
    bat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();
    bat_shell shell;
    bat_shell_report report;
    options.faces = 200;
    options.force = true;
    check_status(bat_shell_reconstruct(made.points, made.count, NULL, &options, &shell, &report, NULL), BAT_OK);
    assert_in_range(shell.face_count, 180, 260);
    assert_true(report.held_out < 7e-4);
    bat_shell_free(&shell);
    free(made.points);
}

static void an_open_cup_stays_open(void **state)
{
    (void)state;
    scatter made = sphere(4800, 0.6, 0);
    bat_shell shell;
    bat_shell_report report;
    bat_error error = {0};
    bat_status status = bat_shell_reconstruct(made.points, made.count, NULL, NULL, &shell, &report, &error);
    if (status != BAT_OK)
        print_message("%s\n", error.text);
    check_status(status, BAT_OK);
    assert_false(shell.closed);
    assert_int_equal(report.holes, 1);
    assert_int_equal(euler_of(&shell), 1);
    // More directions lead away from its outer side.
    for (size_t f = 0; f < shell.face_count; f++)
    {
        double point[3], normal[3];
        check_status(bat_shell_evaluate(&shell, f, 0.5, 0.5, point, normal, NULL), BAT_OK);
        assert_true(point[0] * normal[0] + point[1] * normal[1] + point[2] * normal[2] > 0);
    }
    bat_shell_free(&shell);
    free(made.points);
}

/// A plate of n x n cells of size 1 and the height 0.8, with a square hole of some cells in its middle.
static bat_mesh plate_with_hole(uint32_t n, uint32_t width)
{
    uint32_t row = n + 1, low = (n - width) / 2, high = low + width;
    bat_mesh plate = {.positions = calloc((size_t)2 * row * row * 3, sizeof(double)),
                      .faces = calloc((size_t)4 * n * n * 3 + (size_t)8 * (n + width) * 3, sizeof(uint32_t)),
                      .vertex_count = (size_t)2 * row * row};
    assert_non_null(plate.positions);
    assert_non_null(plate.faces);
    for (uint32_t v = 0; v < 2 * row * row; v++)
    {
        plate.positions[3 * v] = v % row;
        plate.positions[3 * v + 1] = v / row % row;
        plate.positions[3 * v + 2] = v < row * row ? 0 : 0.8;
    }
    uint32_t *face = plate.faces;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
        {
            bool hole = i >= low && i < high && j >= low && j < high;
            const uint32_t at[4] = {j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i};
            const int steps[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
            for (uint32_t c = 0; c < 4 && !hole; c++)
            {
                uint32_t x = i + (uint32_t)steps[c][0], y = j + (uint32_t)steps[c][1], a = at[c], b = at[(c + 1) % 4];
                bool outside = x >= n || y >= n || (x >= low && x < high && y >= low && y < high);
                const uint32_t wall[6] = {a, b, b + row * row, a, b + row * row, a + row * row};
                if (outside)
                    memcpy(face, wall, sizeof wall);
                face += outside ? 6 : 0;
            }
            const uint32_t sides[12] = {at[0],
                                        at[2],
                                        at[1],
                                        at[0],
                                        at[3],
                                        at[2],
                                        at[0] + row * row,
                                        at[1] + row * row,
                                        at[2] + row * row,
                                        at[0] + row * row,
                                        at[2] + row * row,
                                        at[3] + row * row};
            if (!hole)
                memcpy(face, sides, sizeof sides);
            face += hole ? 0 : 12;
        }
    plate.face_count = (size_t)(face - plate.faces) / 3;
    return plate;
}

/// A hole of a plate is closed where there are points in its place, and stays where there are none.
/// Points of a sphere and of two thin ellipsoids beside each other, with their outward normals.
static scatter thin_gap(double *normals)
{
    enum
    {
        BALL = 3000,
        THIN = 1000
    };
    scatter made = scatter_make(BALL + 2 * THIN);
    for (size_t i = 0; i < made.count; i++)
    {
        bool ball = i < BALL;
        size_t count = ball ? BALL : THIN, k = ball ? i : (i - BALL) % THIN;
        double z = -1 + (2 * (double)k + 1) / (double)count, turn = 2.399963229728653 * (double)k, width = ball ? 0.4 : 0.09,
               height = ball ? 0.4 : 0.5, ring = sqrt(1 - z * z);
        double *at = made.points + 3 * i, *normal = normals + 3 * i;
        normal[0] = ring * cos(turn) / width;
        normal[1] = ring * sin(turn) / width;
        normal[2] = z / height;
        at[0] = width * ring * cos(turn) + (ball ? 0 : i < BALL + THIN ? -0.13 : 0.13);
        at[1] = width * ring * sin(turn);
        at[2] = height * z + (ball ? 1.2 : 0);
    }
    return made;
}

static void normals_lead_into_narrow_gaps(void **state)
{
    (void)state;
    double *normals = calloc(15000, sizeof *normals), *areas = calloc(5000, sizeof *areas);
    scatter points = thin_gap(normals);
    const bat_cloud cloud = {.points = points.points, .count = points.count};
    nearest_tree tree = {0};
    oriented_planes planes = {0};
    neighbour_list near = {0};
    memory_pool pool = {0};
    shell_outside outside = {0};
    size_t wrong = 0;
    check_status(neighbours_build(points.points, points.count, &tree, NULL), BAT_OK);
    check_status(oriented_planes_make(&cloud, &tree, &planes, NULL), BAT_OK);
    for (size_t i = 0; i < points.count; i++)
    {
        check_status(neighbours_nearest(&tree, points.points + 3 * i, SHELL_SPACING_POINTS, &near, NULL), BAT_OK);
        areas[i] = shell_spacing(&near) * shell_spacing(&near);
    }
    const shell_cloud all = {points.points, points.count, &tree, sqrt(areas[1500]), 0, 1, 0, areas};
    check_status(shell_orient(&all, &planes, &pool, &outside, NULL), BAT_OK);
    for (size_t i = 0; i < points.count; i++)
        wrong += vector3_dot(normals + 3 * i, planes.planes[i].axes[2]) < 0;
    assert_true(outside.closed);
    assert_in_range(wrong, 0, 60);
    const double far[3] = {2, 0, 1}, middle[3] = {0, 0, 1.2};
    assert_true(shell_is_outside(&outside, far));
    assert_false(shell_is_outside(&outside, middle));
    assert_false(shell_is_outside(&outside, points.points));
    memory_pool_free(&pool);
    neighbour_list_free(&near);
    oriented_planes_free(&planes);
    nearest_free(&tree);
    free(points.points);
    free(normals);
    free(areas);
}

/// A sphere in a sphere: a second solid where its normals lead outwards, and a hollow where they lead inwards.
static void hollows_are_refused(void **state)
{
    (void)state;
    for (int hollow = 0; hollow < 2; hollow++)
    {
        scatter outer = sphere(2000, 1, 0), made = sphere(4000, 1, 0);
        bat_mesh ball, both = {0};
        bat_shell_report report = {0};
        nearest_tree trees[2];
        shell_cloud balls[2] = {{.points = outer.points, .count = outer.count, .tree = &trees[0], .share = 1},
                                {.points = made.points, .count = made.count, .tree = &trees[1]}};
        // Fewer points of the inner sphere, which is the smaller piece.
        for (size_t k = 0; k < 3 * made.count; k++)
            made.points[k] *= k < 300 || k % 6 < 3 ? 1 : 0.5;
        for (int k = 0; k < 2; k++)
            check_status(neighbours_build(balls[k].points, balls[k].count, &trees[k], NULL), BAT_OK);
        check_status(shell_connect(&balls[0], (bat_progress){0}, &ball, NULL, NULL), BAT_OK);
        balls[1].cell = balls[0].cell;
        size_t vertices = ball.vertex_count, faces = ball.face_count;
        both.vertex_count = 2 * vertices;
        both.face_count = 2 * faces;
        both.positions = calloc(6 * vertices, sizeof *both.positions);
        both.faces = calloc(6 * faces, sizeof *both.faces);
        for (size_t k = 0; k < 3 * vertices; k++)
            both.positions[3 * vertices + k] = (both.positions[k] = ball.positions[k]) / 2;
        for (size_t k = 0; k < 3 * faces; k++)
        {
            both.faces[k] = ball.faces[k];
            both.faces[3 * faces + k] = ball.faces[hollow ? 3 * faces - 1 - k : k] + (uint32_t)vertices;
        }
        check_status(shell_open_holes(&balls[1], 0, &both, &report, NULL), hollow ? BAT_NO_CONVERGENCE : BAT_OK);
        assert_int_equal(report.dropped_pieces, 0);
        bat_mesh_free(&ball);
        bat_mesh_free(&both);
        nearest_free(&trees[0]);
        nearest_free(&trees[1]);
        free(made.points);
        free(outer.points);
    }
}

static void false_handles_are_cut(void **state)
{
    (void)state;
    for (int is_false = 0; is_false < 2; is_false++)
    {
        uint32_t n = 13;
        bat_mesh plate = plate_with_hole(n, is_false ? 1 : 5);
        bat_mesh_summary summary;
        bat_shell_report report = {0};
        nearest_tree tree;
        scatter made = scatter_make((size_t)8 * n * n);
        shell_cloud cloud = {.points = made.points, .tree = &tree, .cell = 0.5};
        for (size_t k = 0; k < made.count; k++)
        {
            size_t i = k / 2 % (2 * n), j = k / 2 / (2 * n);
            double *point = made.points + 3 * cloud.count, x = 0.5 * (double)i + 0.25, y = 0.5 * (double)j + 0.25;
            if (!is_false && fabs(x - 6.5) < 2.5 && fabs(y - 6.5) < 2.5)
                continue;
            point[0] = x;
            point[1] = y;
            point[2] = k % 2 == 0 ? 0 : 0.8;
            cloud.count++;
        }
        check_status(neighbours_build(cloud.points, cloud.count, &tree, NULL), BAT_OK);
        check_status(bat_mesh_summarize(&plate, &summary, NULL), BAT_OK);
        assert_int_equal(summary.genus, 1);
        check_status(shell_cut_handles(&cloud, &plate, &report, NULL), BAT_OK);
        assert_int_equal(report.cut_handles, is_false);
        // The corners inside of the hole have no faces.
        check_status(bat_mesh_summarize(&plate, &summary, NULL), BAT_OK);
        assert_int_equal(summary.genus, 1 - is_false);
        assert_true(summary.closed && summary.manifold && summary.oriented);
        bat_mesh_free(&plate);
        nearest_free(&tree);
        free(made.points);
    }
}

/// Pipes of random points end, on average, where their points end.
static void pipes_end_beside_their_points(void **state)
{
    (void)state;
    for (size_t k = 0; k < 2; k++)
    {
        const double noise = k == 0 ? 0 : 0.01;
        scatter made = scatter_make(1500);
        bat_random random = bat_random_seed(17);
        for (size_t i = 0; i < made.count; i++)
        {
            double turn = 2 * PI * bat_random_uniform(&random), height = 3 * bat_random_uniform(&random);
            const double place[3] = {cos(turn), sin(turn), height};
            for (size_t c = 0; c < 3; c++)
                made.points[3 * i + c] = place[c] + noise * bat_random_normal(&random);
        }
        bat_shell shell;
        bat_shell_report report;
        bat_mesh sampled;
        check_status(bat_shell_reconstruct(made.points, made.count, NULL, NULL, &shell, &report, NULL), BAT_OK);
        assert_false(shell.closed);
        assert_int_equal(report.holes, 2);
        assert_int_equal(report.filled, 0);
        check_near(summary_of(&shell, 4).area, 6 * PI, 0.02 * 6 * PI);
        check_status(bat_shell_tessellate(&shell, 4, &sampled, NULL), BAT_OK);
        for (size_t v = 0; v < sampled.vertex_count; v++)
            check_near(hypot(sampled.positions[3 * v], sampled.positions[3 * v + 1]), 1, 0.03);
        bat_mesh_free(&sampled);
        bat_shell_free(&shell);
        free(made.points);
    }
}

/// Where patches are too large for bumps, distances of neighbours from them are alike: that is no second sheet.
static void coarse_patches_are_no_second_sheet(void **state)
{
    (void)state;
    scatter made = sphere(8000, 1, 0);
    for (size_t i = 0; i < made.count; i++)
    {
        double *point = made.points + 3 * i, bump = 1 + 0.03 * sin(6 * point[0]) * sin(6 * point[1]) * sin(6 * point[2]);
        for (size_t c = 0; c < 3; c++)
            point[c] *= bump;
    }
    bat_shell shell;
    bat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();
    options.faces = 60;
    check_status(bat_shell_reconstruct(made.points, made.count, NULL, &options, &shell, NULL, NULL), BAT_OK);
    bat_shell_free(&shell);
    free(made.points);
}

/// Points on both sides of a sphere, half a spacing apart, are refused; those of noise as large are not.
static void sheets_nearer_than_points_are_refused(void **state)
{
    (void)state;
    for (int noisy = 0; noisy < 2; noisy++)
    {
        scatter made = sphere(4000, 1, noisy ? 0.014 : 0);
        bat_shell shell = {0};
        bat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();
        bat_error error;
        options.faces = 150;
        for (size_t k = 0; k < 3 * made.count && !noisy; k++)
            made.points[k] *= made.points[k / 3 * 3 + 2] < 0.5 ? 1 : k / 3 % 2 == 0 ? 1.014 : 0.986;
        bat_status status = bat_shell_reconstruct(made.points, made.count, NULL, &options, &shell, NULL, &error);
        check_status(status, noisy ? BAT_OK : BAT_NO_CONVERGENCE);
        assert_true(noisy || strstr(error.text, "two sheets") != NULL);
        bat_shell_free(&shell);
        free(made.points);
    }
}

/// A sphere does not cross itself; drawn together at its equator to a figure of eight, it does.
static void crossings_are_counted(void **state)
{
    (void)state;
    scatter made = sphere(2000, 1, 0);
    bat_shell shell;
    bat_shell_report report;
    size_t crossings;
    check_status(bat_shell_reconstruct(made.points, made.count, NULL, NULL, &shell, &report, NULL), BAT_OK);
    assert_int_equal(report.crossings, 0);
    assert_int_equal(report.missed, 0);
    for (size_t k = 0; k < shell.cage.face_count * 16; k++)
        shell.patches[3 * k + 1] *= shell.patches[3 * k + 2];
    check_status(shell_count_crossings(&shell, &crossings, NULL), BAT_OK);
    assert_true(crossings > 4 && crossings < shell.cage.face_count / 2);
    bat_shell_free(&shell);
    free(made.points);
}

/// Neither the order of the points nor the number of threads changes a bit.
static void order_and_threads_change_nothing(void **state)
{
    (void)state;
    scatter made = torus(2000);
    bat_shell shells[3];
    for (int k = 0; k < 3; k++)
    {
        bat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();
        options.threads = k == 1 ? 3 : 1;
        options.faces = 150;
        for (size_t i = 0; k == 2 && i < made.count / 2; i++)
            for (size_t c = 0; c < 3; c++)
            {
                double *a = &made.points[3 * i + c], *b = &made.points[3 * (made.count - 1 - i) + c], kept = *a;
                *a = *b;
                *b = kept;
            }
        check_status(bat_shell_reconstruct(made.points, made.count, NULL, &options, &shells[k], NULL, NULL), BAT_OK);
        assert_int_equal(shells[k].face_count, shells[0].face_count);
        assert_memory_equal(shells[k].patches, shells[0].patches,
                            shells[0].cage.face_count * 48 * sizeof *shells[0].patches);
    }
    for (int k = 0; k < 3; k++)
        bat_shell_free(&shells[k]);
    free(made.points);
}

static bool goes_on_below(void *context, double fraction)
{
    return fraction < *(double *)context;
}

/// A shell that is stopped goes on from its last step, to the same patches. Steps of other points, or damaged ones, are
/// refused.
static void a_stopped_shell_goes_on(void **state)
{
    (void)state;
    static const double STOPS[] = {0.32, 0.72};
    char path[] = "/tmp/batten-steps-XXXXXX";
    scatter made = torus(2000);
    bat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();
    bat_shell whole, shell;
    check_status(bat_shell_reconstruct(made.points, made.count, NULL, &options, &whole, NULL, NULL), BAT_OK);
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    close(descriptor);
    check_status(bat_shell_reconstruct_in_steps(made.points, made.count, NULL, &options, path, &shell, NULL, NULL),
                 BAT_BAD_FILE);
    for (size_t k = 0; k < 2; k++)
    {
        double stop = STOPS[k];
        bat_error error = {0};
        (void)remove(path);
        options.progress = (bat_progress){goes_on_below, &stop};
        check_status(bat_shell_reconstruct_in_steps(made.points, made.count, NULL, &options, path, &shell, NULL, NULL),
                     BAT_CANCELLED);
        // What is kept is not done again: the first report comes after it.
        stop = k == 0 ? 0.3 : 0.7;
        check_status(bat_shell_reconstruct_in_steps(made.points, made.count, NULL, &options, path, &shell, NULL, NULL),
                     BAT_CANCELLED);
        options.progress = (bat_progress){0};
        options.faces = 300;
        check_status(bat_shell_reconstruct_in_steps(made.points, made.count, NULL, &options, path, &shell, NULL, &error),
                     BAT_INVALID_ARGUMENT);
        assert_non_null(strstr(error.text, "other points or other options"));
        options.faces = 0;
        check_status(bat_shell_reconstruct_in_steps(made.points, made.count, NULL, &options, path, &shell, NULL, NULL),
                     BAT_OK);
        assert_int_equal(shell.cage.face_count, whole.cage.face_count);
        assert_memory_equal(shell.patches, whole.patches, whole.cage.face_count * 48 * sizeof *whole.patches);
        assert_int_not_equal(access(path, F_OK), 0);
        bat_shell_free(&shell);
    }
    bat_shell_free(&whole);
    free(made.points);
}

/// Turned and scaled points give the turned and scaled shell: layouts do not depend on rounding.
static void shells_turn_and_scale_with_points(void **state)
{
    (void)state;
    static const double AXES[3][3] = {{0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}};
    scatter made = torus(2000), turned = torus(2000);
    bat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();
    bat_shell shells[2];
    options.faces = 150;
    for (size_t k = 0; k < 3 * made.count; k++)
        turned.points[k] = 3.7 * vector3_dot(AXES[k % 3], made.points + k / 3 * 3) + 100;
    check_status(bat_shell_reconstruct(made.points, made.count, NULL, &options, &shells[0], NULL, NULL), BAT_OK);
    check_status(bat_shell_reconstruct(turned.points, turned.count, NULL, &options, &shells[1], NULL, NULL), BAT_OK);
    assert_int_equal(shells[1].cage.face_count, shells[0].cage.face_count);
    for (size_t k = 0; k < 48 * shells[0].cage.face_count; k++)
        check_near(shells[1].patches[k], 3.7 * vector3_dot(AXES[k % 3], shells[0].patches + k / 3 * 3) + 100, 1e-7);
    for (int k = 0; k < 2; k++)
        bat_shell_free(&shells[k]);
    free(made.points);
    free(turned.points);
}

/// A cube of triangles keeps its edges sharp.
static void a_cube_keeps_its_edges(void **state)
{
    (void)state;
    double corners[8][3];
    uint32_t faces[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                             {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    for (int v = 0; v < 8; v++)
        for (int c = 0; c < 3; c++)
            corners[v][c] = v >> c & 1;
    const bat_mesh cube = {.positions = corners[0], .faces = faces[0], .vertex_count = 8, .face_count = 12};
    bat_shell shell;
    bat_shell_report report;
    check_status(bat_shell_reconstruct(NULL, 0, &cube, NULL, &shell, &report, NULL), BAT_OK);
    assert_true(shell.closed && shell.cage.crease_count > 0);
    check_near(report.volume, 1, 1e-3);
    assert_true(report.largest < 5e-3);
    bat_shell_free(&shell);
    bat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();
    bat_error error = {0};
    options.fill_holes = 1;
    check_status(bat_shell_reconstruct(NULL, 0, &cube, &options, &shell, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "of points"));
}

/// A cube in a cube is a void of its solid where its normals lead inwards, and a solid of its own where they lead outwards.
static void a_hollow_is_a_void(void **state)
{
    (void)state;
    static const uint32_t sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    double corners[16][3], patches[12][4][4][3];
    uint32_t faces[12][4];
    uint32_t offsets[13];
    for (int v = 0; v < 16; v++)
        for (int c = 0; c < 3; c++)
            corners[v][c] = v < 8 ? v >> c & 1 : 0.25 + 0.5 * (v >> c & 1);
    for (uint32_t f = 0; f <= 12; f++)
        offsets[f] = 4 * f;
    for (int hollow = 0; hollow < 2; hollow++)
    {
        for (size_t f = 0; f < 12; f++)
            for (size_t k = 0; k < 4; k++)
                faces[f][k] = f < 6 ? sides[f][k] : 8 + sides[f - 6][hollow ? 3 - k : k];
        for (size_t k = 0; k < 12 * 48; k++)
        {
            size_t f = k / 48, j = k / 12 % 4, i = k / 3 % 4, c = k % 3;
            double u = (double)i / 3, v = (double)j / 3;
            patches[f][j][i][c] = (1 - v) * ((1 - u) * corners[faces[f][0]][c] + u * corners[faces[f][1]][c]) +
                                  v * ((1 - u) * corners[faces[f][3]][c] + u * corners[faces[f][2]][c]);
        }
        const bat_shell shell = {
            .cage = {.positions = corners[0], .faces = faces[0], .offsets = offsets, .vertex_count = 16, .face_count = 12},
            .patches = patches[0][0][0],
            .face_count = 12,
            .spans = 1,
            .closed = true};
        char line[512];
        int voids = 0, solids = 0, shells = 0;
        check_status(bat_shell_write("hollow.step", &shell, NULL, NULL), BAT_OK);
        FILE *file = fopen("hollow.step", "r");
        assert_non_null(file);
        while (fgets(line, sizeof line, file) != NULL)
        {
            voids += strstr(line, "=BREP_WITH_VOIDS('',#") != NULL;
            solids += strstr(line, "=MANIFOLD_SOLID_BREP(") != NULL;
            shells += strstr(line, "=ORIENTED_CLOSED_SHELL('',*,#") != NULL;
        }
        assert_int_equal(fclose(file), 0);
        assert_int_equal(voids, hollow);
        assert_int_equal(shells, hollow);
        assert_int_equal(solids, hollow ? 0 : 2);
    }
}

/// The rows of a grid are averages: a shell moves with its control points.
static void rows_are_averages(void **state)
{
    (void)state;
    bat_mesh ball = {0};
    shell_layout layout;
    shell_grid grid;
    scatter made = torus(2000);
    nearest_tree tree;
    check_status(neighbours_build(made.points, made.count, &tree, NULL), BAT_OK);
    shell_cloud cloud = {.points = made.points, .count = made.count, .tree = &tree, .share = 1};
    check_status(shell_connect(&cloud, (bat_progress){0}, &ball, NULL, NULL), BAT_OK);
    nearest_free(&tree);
    check_status(shell_layout_make(&ball, 60, false, 0, &layout, NULL), BAT_OK);
    check_status(shell_grid_make(&layout, 3, &grid, NULL), BAT_OK);
    for (size_t row = 0; row < grid.rows.row_count; row++)
    {
        double sum = 0;
        for (size_t k = grid.rows.starts[row]; k < grid.rows.starts[row + 1]; k++)
            sum += grid.rows.values[k];
        if (grid.rows.starts[row] < grid.rows.starts[row + 1])
            check_near(sum, 1, 1e-12);
    }
    shell_grid_free(&grid);
    shell_layout_free(&layout);
    bat_mesh_free(&ball);
    free(made.points);
}

static void what_is_no_surface_is_refused(void **state)
{
    (void)state;
    scatter made = scatter_make(3000);
    bat_random random = bat_random_seed(5);
    bat_shell shell;
    bat_error error;
    for (size_t i = 0; i < 3 * made.count; i++)
        made.points[i] = bat_random_uniform(&random);
    check_status(bat_shell_reconstruct(made.points, made.count, NULL, NULL, &shell, NULL, &error), BAT_NO_CONVERGENCE);
    check_status(bat_shell_reconstruct(made.points, 20, NULL, NULL, &shell, NULL, &error), BAT_INVALID_ARGUMENT);
    made.points[4] = NAN;
    check_status(bat_shell_reconstruct(made.points, made.count, NULL, NULL, &shell, NULL, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    free(made.points);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_is_closed_and_round),
        cmocka_unit_test(noise_does_not_swell),
        cmocka_unit_test(a_shell_follows_a_patch_that_failed),
        cmocka_unit_test(a_torus_keeps_its_hole),
        cmocka_unit_test(a_box_has_sharp_edges),
        cmocka_unit_test(ripples_get_more_faces),
        cmocka_unit_test(an_open_cup_stays_open),
        cmocka_unit_test(pipes_end_beside_their_points),
        cmocka_unit_test(coarse_patches_are_no_second_sheet),
        cmocka_unit_test(normals_lead_into_narrow_gaps),
        cmocka_unit_test(hollows_are_refused),
        cmocka_unit_test(false_handles_are_cut),
        cmocka_unit_test(crossings_are_counted),
        cmocka_unit_test(order_and_threads_change_nothing),
        cmocka_unit_test(a_stopped_shell_goes_on),
        cmocka_unit_test(shells_turn_and_scale_with_points),
        cmocka_unit_test(sheets_nearer_than_points_are_refused),
        cmocka_unit_test(a_cube_keeps_its_edges),
        cmocka_unit_test(a_hollow_is_a_void),
        cmocka_unit_test(rows_are_averages),
        cmocka_unit_test(what_is_no_surface_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
