// Pictures of fitted surfaces: views, positions, colours, and refusals.
#include "picture_helpers.h"
#include "pixel_helpers.h"
#include "surface/spline/hierarchical_space.h"

#include "batten/mesh_measure.h"
#include "batten/research/surface_shapes.h"
#include "batten/surface_picture.h"
#include "draw/common/legend.h"
#include "draw/surface/scene.h"
#include "linalg/vector.h"

/// A space of a bidegree (1, 1) over `spans` x `spans` cells, and the surface (u, v, 0). Release it with
/// bat_spline_surface_free().
static bat_spline_surface make_flat(size_t spans)
{
    bat_hierarchical_options options = bat_hierarchical_defaults();
    bat_spline_surface flat = {.dimension = 3};
    for (int c = 0; c < 2; c++)
    {
        options.degree[c] = 1;
        options.spans[c] = spans;
    }
    assert_int_equal(bat_hierarchical_space_make(&options, &flat.space, NULL), BAT_OK);
    size_t count = bat_hierarchical_space_functions(flat.space);
    flat.control = calloc(count, 3 * sizeof(double));
    assert_non_null(flat.control);
    for (size_t i = 0; i < count; i++)
    {
        bat_spline_function function = hierarchical_space_function(flat.space, i);
        flat.control[3 * i] = (double)function.i / (double)spans;
        flat.control[3 * i + 1] = (double)function.j / (double)spans;
    }
    return flat;
}

/// The parts of a row for a Bézier cloud on a flat surface.
typedef struct sample_row
{
    bat_cloud cloud;
    double *parameters, *distances;
    bat_spline_surface surface;
    bat_surface_picture_row panel;
} sample_row;

static sample_row make_row(size_t interior)
{
    sample_row row = {.surface = make_flat(4)};
    bat_cloud_bezier_options options = bat_cloud_bezier_defaults();
    options.interior = interior;
    options.turned = false;
    bat_random random = bat_random_seed(6);
    assert_int_equal(bat_cloud_bezier(&options, &random, &row.cloud, &row.parameters, NULL), BAT_OK);
    row.distances = malloc(row.cloud.count * sizeof(double));
    assert_non_null(row.distances);
    for (size_t i = 0; i < row.cloud.count; i++)
        row.distances[i] = fabs(row.cloud.points[3 * i + 2]);
    row.panel =
        (bat_surface_picture_row){.title = "A row <&> \xc3\xa9", .distances = row.distances, .parameters = row.parameters};
    return row;
}

static void free_row(sample_row *row)
{
    bat_cloud_free(&row->cloud);
    bat_spline_surface_free(&row->surface);
    free(row->parameters);
    free(row->distances);
}

/// Every format, panels left out in the second row, and the same bytes again.
static void writes_all_formats(void **state)
{
    (void)state;
    sample_row row = make_row(300);
    bat_surface_picture_row rows[2] = {row.panel, {.cloud = &row.cloud}};
    rows[0].cloud = &row.cloud;
    rows[0].surface = &row.surface;
    bat_surface_picture_options options = {.width = 120};
    for (int i = 0; i < 3; i++)
    {
        char name[32], path[128], *bytes[2];
        size_t sizes[2];
        (void)snprintf(name, sizeof name, "surface.%s", endings[i]);
        path_of(path, name);
        for (int again = 0; again < 2; again++)
        {
            assert_int_equal(bat_surface_picture_write(path, rows, 2, &options, NULL), BAT_OK);
            bytes[again] = slurp(path, &sizes[again]);
            assert_int_equal(unlink(path), 0);
        }
        assert_int_equal(sizes[0], sizes[1]);
        assert_memory_equal(bytes[0], bytes[1], sizes[0]);
        assert_true(contains(bytes[0], 64, i == 0 ? "<?xml" : i == 1 ? "PNG" : "%PDF"));
        free(bytes[0]);
        free(bytes[1]);
    }
    free_row(&row);
}

/// The page is as wide as its panels: margins of 14 points, gaps of 16, two pixels in a point.
static void panels_are_left_out(void **state)
{
    (void)state;
    sample_row row = make_row(100);
    for (int panels = 1; panels <= 4; panels++)
    {
        char path[128];
        bat_surface_picture_row shown = {.cloud = &row.cloud};
        shown.parameters = panels >= 2 ? row.parameters : NULL;
        shown.distances = panels >= 3 ? row.distances : NULL;
        shown.surface = panels >= 4 ? &row.surface : NULL;
        path_of(path, "left-out.png");
        assert_int_equal(bat_surface_picture_write(path, &shown, 1, NULL, NULL), BAT_OK);
        pixels picture = open_png(path);
        assert_int_equal(picture.width, 2 * (2 * 14 + 210 * panels + 16 * (panels - 1)));
        cairo_surface_destroy(picture.surface);
        assert_int_equal(unlink(path), 0);
    }
    free_row(&row);
}

static void check_rotation(const mesh_view *view)
{
    double product[3];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            check_near(vector3_dot(view->rotation[a], view->rotation[b]), a == b, 1e-12);
    vector3_cross(view->rotation[0], view->rotation[1], product);
    check_near(vector3_dot(product, view->rotation[2]), 1, 1e-12);
}

static const double OPEN[3] = {0, 0, 0};

/// The patch (x, y, bulge (1 - x^2) (1 - y^2)) over [-1, 1]^2, boundary first; `order` -1 runs clockwise.
static void fill_patch(double bulge, int order, double points[3 * 65])
{
    static const int CORNERS[4][2] = {{-4, -4}, {4, -4}, {4, 4}, {-4, 4}};
    double *point = points;
    for (int side = 0; side < 4; side++)
        for (int step = 0; step < 8; step++, point += 3)
        {
            const int *from = CORNERS[side], *to = CORNERS[(side + 1) % 4];
            double x = (from[0] + (to[0] - from[0]) * step / 8.0) / 4, y = (from[1] + (to[1] - from[1]) * step / 8.0) / 4;
            point[0] = order > 0 ? x : y;
            point[1] = order > 0 ? y : x;
            point[2] = 0;
        }
    for (int i = 0; i < 33; i++, point += 3)
    {
        double x = (i % 6 - 2.5) / 3, y = (i / 6 - 2.5) / 3;
        point[0] = x;
        point[1] = y;
        point[2] = bulge * (1 - x * x) * (1 - y * y);
    }
}

/// The eye is on the side where the patch bulges, for both orientations of its boundary. A flat patch is seen from the side
/// where the boundary is counter-clockwise. The eye is above and beside the normal.
static void patches_are_seen_from_outside(void **state)
{
    (void)state;
    double points[3 * 65];
    for (int order = -1; order <= 1; order += 2)
        for (int bulge = -1; bulge <= 1; bulge++)
        {
            fill_patch(0.3 * bulge, order, points);
            patch_points patch = {points, 65, 32};
            mesh_view view = surface_view_of(&patch, OPEN, OPEN);
            check_rotation(&view);
            double side = bulge != 0 ? bulge : order;
            assert_true(view.rotation[2][2] * side > 0.9 && view.rotation[2][2] * side < 0.95);
            assert_true(view.rotation[2][1] > 0.1 && view.rotation[1][1] > 0.9);
            // The view does not depend on position and size, nor the direction of the eye on both.
            for (size_t i = 0; i < 3 * 65; i++)
                points[i] = 1e3 * points[i] + (i % 3 == 0 ? 500 : -70);
            mesh_view moved = surface_view_of(&patch, OPEN, OPEN);
            for (int e = 0; e < 9; e++)
                check_near(moved.rotation[e / 3][e % 3], view.rotation[e / 3][e % 3], 1e-9);
        }
}

/// Given directions are kept; patches without extent, or with `up` along the view, still have a view.
static void given_directions_are_kept(void **state)
{
    (void)state;
    double points[3 * 65];
    fill_patch(0.2, 1, points);
    patch_points patch = {points, 65, 32};
    const double direction[3] = {3, 0, 4}, up[3] = {0, -2, 0};
    mesh_view view = surface_view_of(&patch, direction, up);
    check_rotation(&view);
    for (int c = 0; c < 3; c++)
        check_near(view.rotation[2][c], direction[c] / 5, 1e-15);
    check_near(view.rotation[1][1], -1, 1e-15);
    view = surface_view_of(&patch, direction, direction);
    check_rotation(&view);
    memset(points, 0, sizeof points);
    view = surface_view_of(&patch, OPEN, OPEN);
    check_rotation(&view);
    for (int i = 0; i < 65; i++)
        points[3 * i] = i;
    view = surface_view_of(&patch, OPEN, OPEN);
    check_rotation(&view);
}

/// A half-open tube is seen across its broad side; a deep cup with a nose is seen from the nose's side.
static void closed_and_deep_patches_are_seen_from_the_side(void **state)
{
    (void)state;
    bat_cloud blade;
    assert_int_equal(bat_cloud_shape("blade", 2000, 1, &blade, NULL, NULL), BAT_OK);
    patch_points patch = {blade.points, blade.count, blade.boundary_count};
    mesh_view view = surface_view_of(&patch, OPEN, OPEN);
    mesh_frame frame = mesh_frame_of(blade.points, NULL, blade.count, &view);
    check_rotation(&view);
    // It is upright and shows its chord, not its thickness.
    assert_true(view.rotation[1][2] > 0.95);
    assert_true(frame.high[0] - frame.low[0] > 0.3);
    bat_cloud_free(&blade);
    double cup[3 * 300];
    for (int i = 0; i < 300; i++)
    {
        double turn = 2 * PI * (i % 20) / 20, height = fmin(i / 20 / 2.0, 3.5);
        cup[3 * i] = 1.4 * cos(turn) + 0.8 * (height > 1);
        cup[3 * i + 1] = 1.4 * sin(turn);
        cup[3 * i + 2] = height;
    }
    patch = (patch_points){cup, 300, 20};
    view = surface_view_of(&patch, OPEN, OPEN);
    assert_true(view.rotation[2][0] > 0.85 && view.rotation[1][2] > 0.9);
}

/// A disk covers pi r^2 pixels for all positions of its centre. The centre has the colour, and nothing is drawn outside the
/// image.
static void dots_are_disks(void **state)
{
    (void)state;
    static const draw_colour RED = {1, 0, 0};
    enum
    {
        SIDE = 24
    };
    for (int step = 0; step < 5; step++)
    {
        unsigned char bytes[4 * SIDE * SIDE] = {0};
        dot_image image = {bytes, 4 * SIDE, SIDE, SIDE};
        double covered = 0, radius = 4.3;
        dot_draw(&image, 12 + 0.2 * step, 11.7, radius, RED);
        for (size_t i = 0; i < SIDE * SIDE; i++)
        {
            uint32_t pixel;
            memcpy(&pixel, bytes + 4 * i, sizeof pixel);
            // Premultiplied red: alpha and red agree.
            assert_int_equal(pixel >> 24, pixel >> 16 & 255);
            assert_int_equal(pixel & 0xffff, 0);
            covered += (double)(pixel >> 24) / 255;
        }
        check_relative(covered, PI * radius * radius, 0.02);
        dot_draw(&image, -2, 30, 5, RED);
        dot_draw(&image, 1e9, -1e9, 5, RED);
    }
}

/// A page of 200 x 200 points with one pixel each.
static cairo_t *open_paper(void)
{
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 200, 200);
    cairo_t *cairo = cairo_create(surface);
    cairo_surface_destroy(surface);
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_paint(cairo);
    return cairo;
}

static const double PAPER[4] = {0, 0, 200, 200};

/// The mean position of pixels whose blue exceeds their red by far, or the reverse.
static size_t find_colour(cairo_t *cairo, bool blue, double middle[2])
{
    pixels picture = pixels_of(cairo_get_target(cairo));
    size_t count = 0;
    double sum[2] = {0};
    for (int y = 0; y < picture.height; y++)
        for (int x = 0; x < picture.width; x++)
        {
            uint32_t pixel = pixel_at(&picture, x, y);
            int excess = (int)(pixel & 255) - (int)(pixel >> 16 & 255);
            if ((blue ? excess : -excess) < 60)
                continue;
            count++;
            sum[0] += x + 0.5;
            sum[1] += y + 0.5;
        }
    for (int c = 0; c < 2 && count > 0; c++)
        middle[c] = sum[c] / (double)count;
    return count;
}

/// Parameters are at their positions: u to the right, v upwards, to scale.
static void parameters_are_in_the_plane(void **state)
{
    (void)state;
    double points[3] = {0}, places[3][2], parameters[3][2] = {{0.25, 0.25}, {0.75, 0.25}, {0.25, 0.75}};
    bat_cloud cloud = {.points = points, .count = 1};
    for (int i = 0; i < 3; i++)
    {
        cairo_t *cairo = open_paper();
        bat_surface_picture_row panel = {.cloud = &cloud, .parameters = parameters[i]};
        surface_row row = {.panel = &panel};
        assert_int_equal(surface_plane_draw(&row, cairo, PAPER, 1, NULL), BAT_OK);
        assert_true(find_colour(cairo, true, places[i]) > 0);
        cairo_destroy(cairo);
    }
    double right = places[1][0] - places[0][0], up = places[0][1] - places[2][1];
    check_near(right, up, 0.5);
    assert_true(right > 70 && right < 100);
    check_near(places[1][1], places[0][1], 0.2);
    check_near(places[2][0], places[0][0], 0.2);
}

/// The number of dark lines across a row of pixels at a fraction of the square's height.
static int count_lines(cairo_t *cairo, double share)
{
    pixels picture = pixels_of(cairo_get_target(cairo));
    // The frame's left side is the longest dark column.
    int top = 0, bottom = 0, crossings = 0;
    for (int x = 0; x < picture.width && bottom - top < 100; x++)
        for (int y = 0, begin = 0; y < picture.height; y++)
        {
            if (lightness(pixel_at(&picture, x, y)) > 0.8)
                begin = y + 1;
            else if (y - begin > bottom - top)
            {
                top = begin;
                bottom = y;
            }
        }
    int row = (int)lround(bottom - share * (bottom - top));
    bool before = false;
    for (int x = 0; x < picture.width; x++)
    {
        bool line = lightness(pixel_at(&picture, x, row)) < 0.9;
        crossings += line && !before;
        before = line;
    }
    return crossings;
}

/// All sides of cells are drawn: a row crosses one line more than it has cells.
static void cells_are_drawn(void **state)
{
    (void)state;
    bat_spline_surface flat = make_flat(4);
    bat_surface_picture_row panel = {.surface = &flat};
    surface_row row = {.panel = &panel};
    for (uint32_t level = 0; level < 3; level++)
    {
        cairo_t *cairo = open_paper();
        assert_int_equal(surface_plane_draw(&row, cairo, PAPER, 1, NULL), BAT_OK);
        // Cells of the lowest row, then of the highest, which is not refined.
        assert_int_equal(count_lines(cairo, 0.05), 5 + (level > 0) + 2 * (level > 1));
        assert_int_equal(count_lines(cairo, 0.9), 5);
        cairo_destroy(cairo);
        bat_spline_box box = {level, {0, 0}, {1 + level, 1}};
        assert_int_equal(bat_hierarchical_space_refine(flat.space, &box, 1, NULL), BAT_OK);
    }
    bat_spline_surface_free(&flat);
}

/// A row whose flat surface is seen from directly above.
static surface_row row_from_above(const bat_surface_picture_row *panel)
{
    size_t loop_count;
    double *parameters = NULL;
    surface_row row = {.panel = panel, .view = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, .frame = {{0, 0}, {1, 1}}};
    if (panel->surface != NULL)
        assert_int_equal(surface_patch_make(panel->surface, &row.patch, &parameters, &loop_count, NULL), BAT_OK);
    free(parameters);
    return row;
}

/// A dot has the colour of its distance on the scale.
static void errors_are_colours(void **state)
{
    (void)state;
    double points[3] = {0.5, 0.5, 0};
    bat_cloud cloud = {.points = points, .count = 1};
    for (int step = 0; step <= 4; step++)
    {
        double distance = 0.25 * step;
        bat_surface_picture_row panel = {.cloud = &cloud};
        surface_row row = row_from_above(&panel);
        row.distances = &distance;
        cairo_t *cairo = open_paper();
        assert_int_equal(
            surface_view_draw(&row, SURFACE_PANEL_ERRORS, &(surface_colours){.highest = 1}, cairo, PAPER, 4, NULL), BAT_OK);
        pixels picture = pixels_of(cairo_get_target(cairo));
        uint32_t pixel = pixel_at(&picture, 100, 100);
        draw_colour colour = colour_scale_at(distance);
        check_near((double)(pixel >> 16 & 255), 255 * colour_encode(colour.red), 1.5);
        check_near((double)(pixel >> 8 & 255), 255 * colour_encode(colour.green), 1.5);
        check_near((double)(pixel & 255), 255 * colour_encode(colour.blue), 1.5);
        cairo_destroy(cairo);
    }
}

/// Points behind the surface are hidden, except those no farther behind it than their own distance allows.
static void surfaces_hide_points(void **state)
{
    (void)state;
    bat_spline_surface flat = make_flat(2);
    const double heights[3] = {0.4, -0.4, -0.4}, distances[3] = {0.01, 0.01, 0.5};
    for (int i = 0; i < 3; i++)
    {
        double points[3] = {0.5, 0.5, heights[i]};
        bat_cloud cloud = {.points = points, .count = 1};
        bat_surface_picture_row panel = {.cloud = &cloud, .surface = &flat};
        surface_row row = row_from_above(&panel);
        row.distances = &distances[i];
        cairo_t *cairo = open_paper();
        assert_int_equal(
            surface_view_draw(&row, SURFACE_PANEL_ERRORS, &(surface_colours){.highest = 0.01}, cairo, PAPER, 1, NULL),
            BAT_OK);
        pixels picture = pixels_of(cairo_get_target(cairo));
        assert_int_equal(lightness(pixel_at(&picture, 100, 100)) < 0.4, i != 1);
        cairo_destroy(cairo);
        bat_mesh_free(&row.patch);
    }
    bat_spline_surface_free(&flat);
}

/// Triangles lie on the surface and face the eye, or outwards where the surface is closed.
static void patches_are_the_surface(void **state)
{
    (void)state;
    bat_spline_surface flat = make_flat(3);
    bat_mesh patch;
    size_t loop_count;
    double *parameters;
    assert_int_equal(surface_patch_make(&flat, &patch, &parameters, &loop_count, NULL), BAT_OK);
    free(parameters);
    bat_mesh_summary summary;
    assert_int_equal(bat_mesh_check(&patch, NULL), BAT_OK);
    assert_int_equal(bat_mesh_summarize(&patch, &summary, NULL), BAT_OK);
    check_near(summary.area, 1, 1e-12);
    assert_int_equal(summary.boundary_edges, loop_count);
    for (size_t i = 0; i < loop_count; i++)
    {
        const double *at = patch.positions + 3 * i, *next = patch.positions + 3 * ((i + 1) % loop_count);
        // Counter-clockwise round the middle.
        assert_true((at[0] - 0.5) * (next[1] - 0.5) - (at[1] - 0.5) * (next[0] - 0.5) > 0);
    }
    for (int side = -1; side <= 1; side += 2)
    {
        surface_patch_turn(&patch, (const double[3]){0.3, 0, side});
        const uint32_t *face = patch.faces;
        double first[3], second[3], normal[3];
        vector3_subtract(patch.positions + 3 * (size_t)face[1], patch.positions + 3 * (size_t)face[0], first);
        vector3_subtract(patch.positions + 3 * (size_t)face[2], patch.positions + 3 * (size_t)face[0], second);
        vector3_cross(first, second, normal);
        assert_true(normal[2] * side > 0);
    }
    // A box that ends between two columns of vertices keeps half of the patch; a box beside it keeps nothing.
    surface_patch_cut(&patch, (const double[3]){-1, -1, -1}, (const double[3]){0.5 + 1e-9, 1, 1});
    assert_int_equal(bat_mesh_summarize(&patch, &summary, NULL), BAT_OK);
    check_near(summary.area, 0.5, 1e-12);
    surface_patch_cut(&patch, (const double[3]){2, 2, 2}, (const double[3]){3, 3, 3});
    assert_int_equal(patch.face_count, 0);
    bat_mesh_free(&patch);
    bat_spline_surface_free(&flat);
}

/// Small cells have as many vertices as large ones: a deep part of a surface may be in few of them.
static void small_cells_are_drawn(void **state)
{
    (void)state;
    enum
    {
        LEVELS = 9
    };
    bat_spline_surface flat = make_flat(1);
    for (uint32_t level = 0; level < LEVELS; level++)
    {
        uint32_t middle = level > 0 ? ((uint32_t)1 << level) / 2 : 0;
        const bat_spline_box box = {.level = level, .low = {middle, middle}, .high = {middle + 1, middle + 1}};
        assert_int_equal(bat_hierarchical_space_refine(flat.space, &box, 1, NULL), BAT_OK);
    }
    size_t count = bat_hierarchical_space_functions(flat.space), within = 0;
    free(flat.control);
    flat.control = calloc(count, 3 * sizeof(double));
    assert_non_null(flat.control);
    for (size_t i = 0; i < count; i++)
    {
        bat_spline_function function = hierarchical_space_function(flat.space, i);
        flat.control[3 * i] = ldexp((double)function.i, -(int)function.level);
        flat.control[3 * i + 1] = ldexp((double)function.j, -(int)function.level);
    }
    bat_mesh patch;
    size_t loop_count;
    double *parameters;
    assert_int_equal(surface_patch_make(&flat, &patch, &parameters, &loop_count, NULL), BAT_OK);
    free(parameters);
    bat_mesh_summary summary;
    assert_int_equal(bat_mesh_summarize(&patch, &summary, NULL), BAT_OK);
    check_near(summary.area, 1, 1e-12);
    assert_int_equal(summary.boundary_edges, loop_count);
    double end = 0.5 + ldexp(1, -LEVELS) + 1e-12;
    for (size_t v = 0; v < patch.vertex_count; v++)
    {
        const double *at = patch.positions + 3 * v;
        within += at[0] >= 0.5 && at[0] <= end && at[1] >= 0.5 && at[1] <= end;
    }
    assert_int_equal(within, 16);
    bat_mesh_free(&patch);
    bat_spline_surface_free(&flat);
}

/// A surface far from all points leaves its panel empty.
static void surfaces_beyond_the_points_are_cut(void **state)
{
    (void)state;
    sample_row sample = make_row(50);
    char path[128];
    path_of(path, "stray.png");
    for (size_t i = 0; i < sample.cloud.count; i++)
        sample.cloud.points[3 * i] += 100;
    bat_surface_picture_row panel = {.cloud = &sample.cloud, .surface = &sample.surface, .distances = sample.distances};
    assert_int_equal(bat_surface_picture_write(path, &panel, 1, NULL, NULL), BAT_OK);
    assert_int_equal(unlink(path), 0);
    free_row(&sample);
}

/// Bands count outwards from the middle one, and have a colour and a label each.
static void distances_are_in_bands(void **state)
{
    (void)state;
    const double limits[2] = {0.1, 0.2}, distances[5] = {0.3, 0.15, -0.1, -0.2, -1};
    const char *const labels[5] = {"beyond +0.2: 25.00 %", "+0.1 to +0.2: 25.00 %",
                                   "within \xc2\xb1"
                                   "0.1: 25.00 %",
                                   "\xe2\x88\x92"
                                   "0.1 to \xe2\x88\x92"
                                   "0.2: 25.00 %",
                                   "beyond \xe2\x88\x92"
                                   "0.2: 25.00 %"};
    const bat_surface_inspection inspection = {.bands = limits, .band_count = 2};
    char label[64];
    for (size_t k = 0; k < 5; k++)
    {
        assert_int_equal(surface_band_of(&inspection, distances[k]), k);
        surface_band_label(&inspection, k, 0.25, label, sizeof label);
        assert_string_equal(label, labels[k]);
        for (size_t other = 0; other < k; other++)
        {
            draw_colour a = surface_band_colour(&inspection, k), b = surface_band_colour(&inspection, other);
            assert_true(fabs(a.red - b.red) + fabs(a.green - b.green) + fabs(a.blue - b.blue) > 0.2);
        }
    }
}

/// Distances are positive on the side that is seen, whichever way the surface is turned.
static void distances_have_sides(void **state)
{
    (void)state;
    bat_spline_surface flat = make_flat(2);
    double points[6] = {0.5, 0.5, 0.4, 0.5, 0.5, -0.3}, distances[2] = {0.4, 0.3}, parameters[4] = {0.5, 0.5, 0.5, 0.5};
    bat_cloud cloud = {.points = points, .count = 2};
    bat_surface_picture_row panel = {.cloud = &cloud, .surface = &flat, .parameters = parameters};
    for (int turned = 0; turned < 2; turned++)
    {
        surface_row row = {.panel = &panel, .distances = distances, .turned = turned != 0};
        assert_int_equal(surface_row_sign(&row, NULL), BAT_OK);
        assert_true(row.signed_distances[0] == (turned ? -0.4 : 0.4) && row.signed_distances[1] == (turned ? 0.3 : -0.3));
        free(row.signed_distances);
    }
    bat_spline_surface_free(&flat);
}

/// The mean curvature of a paraboloid is that of its second derivatives at the top, and bulges towards the viewer.
static void curvature_is_that_of_the_surface(void **state)
{
    (void)state;
    bat_hierarchical_options options = bat_hierarchical_defaults();
    options.degree[0] = options.degree[1] = 2;
    bat_spline_surface bowl = {.dimension = 3};
    assert_int_equal(bat_hierarchical_space_make(&options, &bowl.space, NULL), BAT_OK);
    bowl.control = calloc(9, 3 * sizeof(double));
    assert_non_null(bowl.control);
    // z = -3 (u - 1/2)^2 - (v - 1/2)^2 in Bezier form
    for (size_t k = 0; k < 9; k++)
    {
        bat_spline_function at = hierarchical_space_function(bowl.space, k);
        bowl.control[3 * k] = at.i / 2.0;
        bowl.control[3 * k + 1] = at.j / 2.0;
        bowl.control[3 * k + 2] = -3 * (at.i == 1 ? -0.25 : 0.25) - (at.j == 1 ? -0.25 : 0.25);
    }
    const double middle[2] = {0.5, 0.5};
    for (int turned = 0; turned < 2; turned++)
    {
        double end = 0, place[3] = {0.5, 0.5, 0};
        uint32_t face[3] = {0, 0, 0};
        bat_surface_picture_row panel = {.surface = &bowl};
        surface_row row = {.panel = &panel,
                           .turned = turned != 0,
                           .patch = {.positions = place, .faces = face, .vertex_count = 1, .face_count = 1}};
        assert_int_equal(surface_row_inspect(&row, false, middle, &end, NULL), BAT_OK);
        check_near(row.values[0], turned ? -4 : 4, 1e-12);
        free(row.values);
    }
    bat_spline_surface_free(&bowl);
}

/// Views and bands draw other pictures, and wrong ones are refused.
static void inspections_are_drawn(void **state)
{
    (void)state;
    sample_row sample = make_row(60);
    const double bands[5] = {0.1, 0.2, 0.15, 0.3, 0.4};
    char path[128];
    bat_error error;
    path_of(path, "inspected.png");
    bat_surface_picture_row row = sample.panel;
    row.cloud = &sample.cloud;
    row.surface = &sample.surface;
    for (int view = 0; view < 3; view++)
    {
        const bat_surface_inspection inspection = {(bat_surface_view)view, bands, 2};
        assert_int_equal(bat_surface_picture_inspect(path, &row, 1, &inspection, NULL, &error), BAT_OK);
        assert_int_equal(unlink(path), 0);
    }
    const bat_surface_inspection wrong[] = {
        {.bands = bands, .band_count = 3}, {.bands = bands + 2, .band_count = 5}, {(bat_surface_view)3, NULL, 0}};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++)
        assert_int_equal(bat_surface_picture_inspect(path, &row, 1, &wrong[k], NULL, &error), BAT_INVALID_ARGUMENT);
    row.parameters = NULL;
    const bat_surface_inspection good = {.bands = bands, .band_count = 2};
    assert_int_equal(bat_surface_picture_inspect(path, &row, 1, &good, NULL, &error), BAT_INVALID_ARGUMENT);
    free_row(&sample);
}

/// The same of a patch of a shell, z = -3 (u - 1/2)^2 - (v - 1/2)^2, at the top.
static void curvature_is_that_of_the_patch(void **state)
{
    (void)state;
    static const double SQUARE[4] = {0.25, -1.0 / 12, -1.0 / 12, 0.25};
    double patch[48];
    for (int k = 0; k < 16; k++)
    {
        patch[3 * k] = k % 4 / 3.0;
        patch[3 * k + 1] = k / 4 / 3.0; // NOLINT(bugprone-integer-division): the row
        patch[3 * k + 2] = -3 * SQUARE[k % 4] - SQUARE[k / 4];
    }
    bat_shell shell = {.face_count = 1, .spans = 1, .patches = patch};
    for (int turned = 0; turned < 2; turned++)
    {
        double end = 0;
        // With two samples, the first quad has the top at its third corner.
        surface_row row = {.shell = &shell, .samples = 2, .turned = turned != 0, .patch = {.face_count = 1}};
        assert_int_equal(surface_row_inspect(&row, false, NULL, &end, NULL), BAT_OK);
        check_near(row.values[2], turned ? -4 : 4, 1e-12);
        free(row.values);
    }
}

/// A shell through points of a sphere of radius 2 about (0, 0, 1), evenly spread. Release the points with free().
static bat_shell make_ball(size_t count, double **points)
{
    bat_shell shell;
    bat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();
    options.faces = 96;
    *points = calloc(count, 3 * sizeof **points);
    assert_non_null(*points);
    for (size_t i = 0; i < count; i++)
    {
        double z = -1 + 2 * ((double)i + 0.5) / (double)count, turn = 2.399963229728653 * (double)i;
        (*points)[3 * i] = 2 * sqrt(1 - z * z) * cos(turn);
        (*points)[3 * i + 1] = 2 * sqrt(1 - z * z) * sin(turn);
        (*points)[3 * i + 2] = 1 + 2 * z;
    }
    assert_int_equal(bat_shell_reconstruct(*points, count, NULL, &options, &shell, NULL, NULL), BAT_OK);
    return shell;
}

/// A sphere has the mean curvature 1/r outwards. Points beside it have the distance and side that they were moved by.
static void shells_are_measured(void **state)
{
    (void)state;
    double *points, end = 0, sum = 0, squares = 0, worst = 0;
    bat_shell shell = make_ball(2000, &points);
    for (size_t i = 0; i < 2000; i++)
        for (size_t c = 0; c < 3; c++)
            points[3 * i + c] += (i % 2 == 0 ? 0.025 : -0.025) * (points[3 * i + c] - (c == 2 ? 1 : 0));
    bat_cloud cloud = {.points = points, .count = 2000};
    bat_surface_picture_row panel = {.cloud = &cloud};
    surface_row row = {.panel = &panel, .shell = &shell, .view = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
    assert_int_equal(surface_shell_make(&row, NULL), BAT_OK);
    assert_int_equal(surface_row_inspect(&row, false, NULL, &end, NULL), BAT_OK);
    size_t count = 3 * row.patch.face_count;
    for (size_t k = 0; k < count; k++)
    {
        sum += row.values[k] / (double)count;
        squares += (row.values[k] - 0.5) * (row.values[k] - 0.5);
    }
    check_near(sum, 0.5, 0.01 * 0.5);
    assert_true(sqrt(squares / (double)count) < 0.15 * 0.5);
    check_near(end, 3 * 0.5, 0.02);
    assert_int_equal(surface_row_sign(&row, NULL), BAT_OK);
    for (size_t i = 0; i < cloud.count; i++)
        worst = fmax(worst, fabs(row.signed_distances[i] - (i % 2 == 0 ? 0.05 : -0.05)));
    assert_true(worst < 0.004);
    // Each side of a face is drawn once, on the shell and in steps of one sample.
    assert_int_equal(row.outline_count, 2 * 2 * shell.face_count * shell.spans * row.samples);
    // A turned shell exchanges corners of triangles, and the sides of the points.
    double before = row.values[3 * 7], first = row.signed_distances[0];
    free(row.values);
    free(row.signed_distances);
    row.turned = true;
    SWAP(row.patch.faces[3 * 7], row.patch.faces[3 * 7 + 1]);
    assert_int_equal(surface_row_inspect(&row, false, NULL, &end, NULL), BAT_OK);
    assert_int_equal(surface_row_sign(&row, NULL), BAT_OK);
    check_near(row.values[3 * 7 + 1], -before, 1e-12);
    check_near(row.signed_distances[0], -first, 1e-15);
    free(row.values);
    free(row.signed_distances);
    bat_mesh_free(&row.patch);
    memory_pool_free(&row.pool);
    bat_shell_free(&shell);
    free(points);
}

/// Views, bands and the lack of points draw other pictures, and wrong input is refused.
static void shells_are_drawn(void **state)
{
    (void)state;
    double *points;
    const double bands[2] = {0.001, 0.002};
    bat_shell shell = make_ball(1000, &points);
    bat_surface_picture_options options = {.width = 120};
    const bat_surface_inspection inspections[] = {{.view = BAT_SURFACE_VIEW_SHADED}, {.view = BAT_SURFACE_VIEW_SHADED},
                                                  {.view = BAT_SURFACE_VIEW_ZEBRA},  {.view = BAT_SURFACE_VIEW_CURVATURE},
                                                  {.bands = bands, .band_count = 2}, {.view = BAT_SURFACE_VIEW_SHADED}};
    char path[128], *bytes[6];
    size_t sizes[6];
    bat_error error;
    path_of(path, "shell.png");
    for (size_t k = 0; k < 6; k++)
    {
        assert_int_equal(
            bat_shell_picture_write(path, "A shell", &shell, points, k == 5 ? 0 : 1000, &inspections[k], &options, &error),
            BAT_OK);
        bytes[k] = slurp(path, &sizes[k]);
        assert_int_equal(unlink(path), 0);
    }
    for (size_t k = 1; k < 6; k++)
        assert_int_equal(sizes[k] == sizes[0] && memcmp(bytes[k], bytes[0], sizes[0]) == 0, k == 1);
    for (size_t k = 0; k < 6; k++)
        free(bytes[k]);

    const bat_surface_inspection wrong[] = {{(bat_surface_view)3, NULL, 0}, {.bands = bands, .band_count = 5}};
    for (size_t k = 0; k < 2; k++)
        assert_int_equal(bat_shell_picture_write(path, NULL, &shell, points, 1000, &wrong[k], NULL, &error),
                         BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_shell_picture_write("shell.txt", NULL, &shell, points, 1000, NULL, NULL, &error),
                     BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_shell_picture_write(path, "\n", &shell, NULL, 0, NULL, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_shell_picture_write(path, NULL, &shell, NULL, 1, NULL, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_shell_picture_write(path, NULL, &(bat_shell){0}, points, 1000, NULL, NULL, &error),
                     BAT_INVALID_ARGUMENT);
    points[3 * 7] = NAN;
    assert_int_equal(bat_shell_picture_write(path, NULL, &shell, points, 1000, NULL, NULL, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 7);
    shell.patches[48 + 4] = INFINITY;
    assert_int_equal(bat_shell_picture_write(path, NULL, &shell, NULL, 0, NULL, NULL, &error), BAT_INVALID_POINT);
    bat_shell_free(&shell);
    free(points);
}

static void wrong_input_is_refused(void **state)
{
    (void)state;
    sample_row sample = make_row(50);
    bat_surface_picture_options options[6] = {{.width = 10}, {.width = -1}, {.largest_error = NAN}, {.largest_error = -1}};
    options[4].view[1] = INFINITY;
    options[5].up[2] = NAN;
    char path[128];
    bat_error error;
    path_of(path, "wrong.png");
    bat_surface_picture_row good = {.cloud = &sample.cloud};
    for (int i = 0; i < 6; i++)
        assert_int_equal(bat_surface_picture_write(path, &good, 1, &options[i], &error), BAT_INVALID_ARGUMENT);
    bat_cloud empty = {0};
    bat_spline_surface curve = sample.surface;
    curve.dimension = 2;
    bat_surface_picture_row wrong[] = {{0},
                                       {.surface = &sample.surface, .distances = sample.distances},
                                       {.surface = &sample.surface, .parameters = sample.parameters},
                                       {.cloud = &empty},
                                       {.surface = &curve},
                                       {.cloud = &sample.cloud, .title = "\xff"}};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        assert_int_equal(bat_surface_picture_write(path, &wrong[i], 1, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_surface_picture_write("picture.txt", &good, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_surface_picture_write(path, &good, 0, NULL, &error), BAT_INVALID_ARGUMENT);
    double *numbers[] = {&sample.distances[7], &sample.parameters[15], &sample.cloud.points[21],
                         &sample.surface.control[22]};
    bat_surface_picture_row all = sample.panel;
    all.cloud = &sample.cloud;
    all.surface = &sample.surface;
    for (int i = 0; i < 4; i++)
    {
        double kept = *numbers[i];
        *numbers[i] = i == 1 ? 1.5 : NAN;
        assert_int_equal(bat_surface_picture_write(path, &all, 1, NULL, &error), BAT_INVALID_POINT);
        assert_int_equal(error.index, 7);
        *numbers[i] = kept;
    }
    assert_int_equal(folder_entries(), 0);
    free_row(&sample);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(writes_all_formats),
        cmocka_unit_test(panels_are_left_out),
        cmocka_unit_test(patches_are_seen_from_outside),
        cmocka_unit_test(given_directions_are_kept),
        cmocka_unit_test(closed_and_deep_patches_are_seen_from_the_side),
        cmocka_unit_test(dots_are_disks),
        cmocka_unit_test(parameters_are_in_the_plane),
        cmocka_unit_test(cells_are_drawn),
        cmocka_unit_test(errors_are_colours),
        cmocka_unit_test(surfaces_hide_points),
        cmocka_unit_test(patches_are_the_surface),
        cmocka_unit_test(small_cells_are_drawn),
        cmocka_unit_test(surfaces_beyond_the_points_are_cut),
        cmocka_unit_test(distances_are_in_bands),
        cmocka_unit_test(distances_have_sides),
        cmocka_unit_test(curvature_is_that_of_the_surface),
        cmocka_unit_test(inspections_are_drawn),
        cmocka_unit_test(curvature_is_that_of_the_patch),
        cmocka_unit_test(shells_are_measured),
        cmocka_unit_test(shells_are_drawn),
        cmocka_unit_test(wrong_input_is_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
