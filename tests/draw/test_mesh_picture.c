// Shaded meshes: visibility, size, light, colours, and refusals.
#include "picture_helpers.h"
#include "pixel_helpers.h"

#include "batten/mesh_picture.h"
#include "batten/research/mesh_shapes.h"
#include "draw/common/legend.h"
#include "draw/mesh/shade.h"

/// A ball of a radius; release it with bat_mesh_free().
static bat_mesh make_ball(double radius)
{
    bat_mesh ball;
    assert_int_equal(bat_mesh_shape("stone", 800, 1, &ball, NULL), BAT_OK);
    for (size_t v = 0; v < ball.vertex_count; v++)
    {
        double *p = ball.positions + 3 * v, length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (int c = 0; c < 3; c++)
            p[c] *= radius / length;
    }
    return ball;
}

/// Every format, with all that can be drawn.
static void writes_all_formats(void **state)
{
    (void)state;
    bat_mesh ball = make_ball(1), sheet;
    assert_int_equal(bat_mesh_shape("relief", 400, 2, &sheet, NULL), BAT_OK);
    double *values = malloc(sheet.vertex_count * sizeof *values);
    assert_non_null(values);
    for (size_t v = 0; v < sheet.vertex_count; v++)
        values[v] = v == 7 ? NAN : sheet.positions[3 * v + 1];
    bat_mesh_picture_panel panels[] = {{.mesh = &ball, .title = "ball <&>", .wires = true, .flat = true},
                                       {.mesh = &sheet, .values = values, .wires = true}};
    for (int i = 0; i < 3; i++)
    {
        char name[32], path[128];
        bat_mesh_picture_options options = bat_mesh_picture_defaults();
        options.width = 320;
        options.height = 240;
        options.title = "Title \xc3\xa9";
        options.value_label = "height";
        options.own_frames = i == 1;
        options.up = (bat_mesh_up)i;
        (void)snprintf(name, sizeof name, "mesh.%s", endings[i]);
        path_of(path, name);
        assert_int_equal(bat_mesh_picture_write(path, panels, 2, &options, NULL), BAT_OK);
        check_picture(path, 320, 240);
        assert_int_equal(unlink(path), 0);
    }
    free(values);
    bat_mesh_free(&ball);
    bat_mesh_free(&sheet);
}

/// Neither threads nor earlier pictures change a file.
static void same_bytes_for_any_threads(void **state)
{
    (void)state;
    bat_mesh mesh;
    assert_int_equal(bat_mesh_shape("creature", 2000, 3, &mesh, NULL), BAT_OK);
    bat_mesh_picture_panel panels[2] = {{.mesh = &mesh, .wires = true}, {.mesh = &mesh}};
    for (int format = 0; format < 3; format++)
    {
        char *bytes[3];
        size_t sizes[3];
        for (int i = 0; i < 3; i++)
        {
            char name[32], path[128];
            bat_mesh_picture_options options = bat_mesh_picture_defaults();
            options.threads = 2 * i + 1;
            (void)snprintf(name, sizeof name, "threads.%s", endings[format]);
            path_of(path, name);
            assert_int_equal(bat_mesh_picture_write(path, panels, 2, &options, NULL), BAT_OK);
            bytes[i] = slurp(path, &sizes[i]);
            assert_int_equal(unlink(path), 0);
            assert_int_equal(sizes[i], sizes[0]);
            assert_memory_equal(bytes[i], bytes[0], sizes[0]);
        }
        for (int i = 0; i < 3; i++)
            free(bytes[i]);
    }
    bat_mesh_free(&mesh);
}

/// A sphere appears as a disk from everywhere, half as large beside one of twice the size unless each has its own frame. The
/// light comes from the upper left.
static void balls_are_disks(void **state)
{
    (void)state;
    bat_mesh large = make_ball(1), small = make_ball(0.5);
    bat_mesh_picture_panel panels[] = {{.mesh = &large}, {.mesh = &small}};
    for (int own = 0; own < 2; own++)
    {
        char path[128];
        bat_mesh_picture_options options = bat_mesh_picture_defaults();
        options.own_frames = own == 1;
        options.longitude = 1.1;
        options.latitude = 0.4;
        path_of(path, "balls.png");
        assert_int_equal(bat_mesh_picture_write(path, panels, 2, &options, NULL), BAT_OK);
        pixels picture = open_png(path);
        drawn_area left = find_inked_area(&picture, 0, picture.width / 2),
                   right = find_inked_area(&picture, picture.width / 2, picture.width);
        check_near((double)(left.right - left.left) / (left.bottom - left.top), 1, 0.02);
        check_near((double)left.count / ((left.right - left.left) * (left.bottom - left.top)), PI / 4, 0.02);
        check_near((double)left.count / (double)right.count, own == 1 ? 1 : 4, 0.15);
        int x = (left.left + left.right) / 2, y = (left.top + left.bottom) / 2, away = (left.right - left.left) / 4;
        assert_true(lightness(pixel_at(&picture, x - away, y - away)) >
                    lightness(pixel_at(&picture, x + away, y + away)) + 0.1);
        cairo_surface_destroy(picture.surface);
        assert_int_equal(unlink(path), 0);
    }
    bat_mesh_free(&large);
    bat_mesh_free(&small);
}

/// A square with values 0 at its left edge and 1 at its right edge is lighter on the left.
static void values_are_colours(void **state)
{
    (void)state;
    double positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, values[] = {0, 1, 1, 0};
    uint32_t faces[] = {0, 1, 2, 0, 2, 3};
    bat_mesh square = {.positions = positions, .vertex_count = 4, .faces = faces, .face_count = 2};
    bat_mesh_picture_panel panel = {.mesh = &square, .values = values};
    bat_mesh_picture_options options = bat_mesh_picture_defaults();
    options.longitude = options.latitude = 0;
    char path[128];
    path_of(path, "square.png");
    assert_int_equal(bat_mesh_picture_write(path, &panel, 1, &options, NULL), BAT_OK);
    pixels picture = open_png(path);
    drawn_area whole = find_inked_area(&picture, 0, picture.width);
    int middle = whole.top + (whole.right - whole.left) / 2, wide = whole.right - whole.left;
    double last = 2;
    for (int step = 1; step < 10; step++)
    {
        double next = lightness(pixel_at(&picture, whole.left + step * wide / 10, middle));
        assert_true(next < last);
        last = next;
    }
    cairo_surface_destroy(picture.surface);
    assert_int_equal(unlink(path), 0);
}

/// Two triangles of a square cover all its samples. The nearer of two squares is visible; of two equal ones the first.
static void rasters_cover_and_hide(void **state)
{
    (void)state;
    double positions[] = {0, 0, 0, 8, 0, 0, 8, 8, 0, 0, 8, 0, 2, 2, 1, 6, 2, 1, 6, 6, 1, 2, 6, 1};
    uint32_t faces[] = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7, 4, 5, 6};
    bat_mesh mesh = {.positions = positions, .vertex_count = 8, .faces = faces, .face_count = 5};
    mesh_view view = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    mesh_placing placing = {.view = &view, .scale = 1, .origin = {1, 9}};
    mesh_raster raster;
    assert_int_equal(mesh_raster_make(&mesh, &placing, 10, 10, 1, &raster, NULL), BAT_OK);
    for (size_t y = 0; y < 10; y++)
        for (size_t x = 0; x < 10; x++)
        {
            uint32_t face = raster.faces[10 * y + x];
            bool outer = x >= 1 && x < 9 && y >= 1 && y < 9, inner = x >= 3 && x < 7 && y >= 3 && y < 7;
            assert_int_equal(face != RASTER_NO_FACE, outer);
            if (outer)
                assert_int_equal(face / 2, inner ? 1 : 0);
            if (outer)
            {
                double share[3];
                mesh_raster_locate(&raster, faces + 3 * (size_t)face, (double)x + 0.5, (double)y + 0.5, share);
                check_near(share[0] + share[1] + share[2], 1, 1e-12);
                assert_true(share[0] > -1e-9 && share[1] > -1e-9 && share[2] > -1e-9);
            }
        }
    // A diagonal of the outer square runs beneath the inner one.
    unsigned char marks[100] = {0};
    mesh_raster_line(&raster, 0, 2, 0.5, 1, marks);
    for (size_t y = 0; y < 10; y++)
        for (size_t x = 0; x < 10; x++)
        {
            bool on = x + y == 9 && x >= 1 && x < 9, below = x >= 3 && x < 7;
            assert_int_equal(marks[10 * y + x], on && !below);
        }
    memory_pool_free(&raster.pool);
}

/// Normals are continuous at blunt edges and not at sharp ones; edges of one face are boundaries.
static void surfaces_know_their_edges(void **state)
{
    (void)state;
    // A strip of three squares: bent by 20 degrees, then by 90.
    double c = cos(PI / 9), s = sin(PI / 9);
    double positions[] = {-1, 0, 0, -1, 1, 0, 0, 0, 0, 0, 1, 0, c, 0, s, c, 1, s, c - s, 0, s + c, c - s, 1, s + c};
    uint32_t faces[] = {0, 2, 1, 2, 3, 1, 2, 4, 3, 4, 5, 3, 4, 6, 5, 6, 7, 5};
    bat_mesh strip = {.positions = positions, .vertex_count = 8, .faces = faces, .face_count = 6};
    mesh_surface surface;
    assert_int_equal(mesh_surface_make(&strip, NULL, false, 1, &surface, NULL), BAT_OK);
    // Corner 0 of face 1 and corner 0 of face 2 are vertex 2: the same normal. Corner 1 of face 2 and corner 0 of face 4 are
    // vertex 4.
    const float *blunt = surface.normals[3 * 1 + 0], *other = surface.normals[3 * 2 + 0];
    for (int i = 0; i < 3; i++)
        check_near((double)blunt[i], (double)other[i], 1e-6);
    // Two faces are flat there and one is bent; all have equal areas.
    check_near((double)blunt[0], -sin(atan2(s, 2 + c)), 1e-6);
    const float *flat = surface.normals[3 * 2 + 1], *upright = surface.normals[3 * 4 + 0];
    check_near((double)(flat[0] * upright[0] + flat[1] * upright[1] + flat[2] * upright[2]), 0, 1e-6);
    assert_int_equal(surface.marks[0], 1 | 4);
    assert_int_equal(surface.marks[1], 2);
    assert_int_equal(surface.marks[5], 1 | 2);
    memory_pool_free(&surface.pool);
    // The same as quads, each cut along its corners 1 and 2.
    uint32_t offsets[] = {0, 4, 8, 12}, corners[] = {0, 2, 3, 1, 2, 4, 5, 3, 4, 6, 7, 5};
    bat_mesh quads = {.positions = positions, .vertex_count = 8, .offsets = offsets, .faces = corners, .face_count = 3};
    assert_int_equal(mesh_surface_make(&strip, &quads, true, 1, &surface, NULL), BAT_OK);
    for (size_t f = 0; f < 6; f++)
        for (size_t k = 0; k < 3; k++)
            assert_int_equal(mesh_edge_within_polygon(&surface, f, k), k == (f % 2 == 0 ? 1 : 2));
    assert_true(mesh_edge_at_boundary(&surface, 0, 0) && !mesh_edge_at_boundary(&surface, 0, 1));
    memory_pool_free(&surface.pool);
}

/// The diagonals along which quads are cut are not drawn, and a bent quad has one normal.
static void polygons_have_their_edges_alone(void **state)
{
    (void)state;
    double positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0.3, 0, 1, 0};
    uint32_t faces[] = {0, 1, 2, 3}, offsets[] = {0, 4};
    bat_mesh quad = {.positions = positions, .vertex_count = 4, .offsets = offsets, .faces = faces, .face_count = 1};
    bat_mesh cut;
    assert_int_equal(bat_mesh_triangulate(&quad, &cut, NULL), BAT_OK);
    bat_mesh_picture_panel panels[] = {{.mesh = &cut, .wires = true, .flat = true},
                                       {.mesh = &quad, .wires = true, .flat = true}};
    bat_mesh_picture_options options = bat_mesh_picture_defaults();
    options.longitude = options.latitude = 0;
    options.ambient_occlusion = options.boundaries = false;
    char path[128];
    double spread[2];
    for (int i = 0; i < 2; i++)
    {
        path_of(path, "quad.png");
        assert_int_equal(bat_mesh_picture_write(path, &panels[i], 1, &options, NULL), BAT_OK);
        pixels picture = open_png(path);
        drawn_area whole = find_inked_area(&picture, 0, picture.width);
        double low = 1, high = 0;
        // Along both diagonals, away from the border.
        for (int step = 10; step <= 90; step++)
            for (int other = 0; other < 2; other++)
            {
                int x = whole.left + step * (whole.right - whole.left) / 100, down = other ? 100 - step : step;
                double light = lightness(pixel_at(&picture, x, whole.top + down * (whole.right - whole.left) / 100));
                low = fmin(low, light);
                high = fmax(high, light);
            }
        spread[i] = high - low;
        cairo_surface_destroy(picture.surface);
        assert_int_equal(unlink(path), 0);
    }
    assert_true(spread[0] > 0.05);
    assert_true(spread[1] < 0.005);
    bat_mesh_free(&cut);
}

/// The lightness in Oklab decreases uniformly along the scale.
static void scale_is_even(void **state)
{
    (void)state;
    double last = 0, step = 0;
    for (int i = 0; i <= 20; i++)
    {
        draw_colour colour = colour_scale_at(i / 20.0);
        double l = cbrt(0.4122214708 * colour.red + 0.5363325363 * colour.green + 0.0514459929 * colour.blue);
        double m = cbrt(0.2119034982 * colour.red + 0.6806995451 * colour.green + 0.1073969566 * colour.blue);
        double n = cbrt(0.0883024619 * colour.red + 0.2817188376 * colour.green + 0.6299787005 * colour.blue);
        double light = 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * n;
        if (i == 1)
            step = last - light;
        if (i > 0)
            check_near(last - light, step, 0.15 * step);
        last = light;
        check_near(colour_decode(colour_encode(colour.green)), colour.green, 1e-6);
    }
}

static void check_refused(const bat_mesh_picture_panel *panel, const bat_mesh_picture_options *options, const char *name,
                          bat_status status)
{
    char path[128];
    bat_error error = {0};
    path_of(path, name);
    assert_int_equal(bat_mesh_picture_write(path, panel, 1, options, &error), status);
    assert_int_equal(error.status, status);
    assert_true(strlen(error.text) > 0);
    assert_int_equal(folder_entries(), 0);
}

static void bad_input_is_refused(void **state)
{
    (void)state;
    bat_mesh ball = make_ball(1), none = {0};
    bat_mesh_picture_panel panel = {.mesh = &ball}, empty = {.mesh = &none}, missing = {0};
    check_refused(&panel, NULL, "a.jpeg", BAT_INVALID_ARGUMENT);
    check_refused(&empty, NULL, "a.png", BAT_INVALID_ARGUMENT);
    check_refused(&missing, NULL, "a.png", BAT_INVALID_ARGUMENT);
    uint32_t corners[] = {0, 1, 2, 1}, offsets[] = {0, 4};
    bat_mesh other = {.positions = ball.positions,
                      .vertex_count = ball.vertex_count,
                      .offsets = offsets,
                      .faces = corners,
                      .face_count = 1};
    bat_mesh_picture_panel twice = {.mesh = &other};
    check_refused(&twice, NULL, "a.png", BAT_INVALID_POINT);
    bat_mesh_picture_panel garbled = {.mesh = &ball, .title = "\xff"};
    check_refused(&garbled, NULL, "a.png", BAT_INVALID_ARGUMENT);
    bat_mesh_picture_options good = bat_mesh_picture_defaults(), bad[7];
    for (int i = 0; i < 7; i++)
        bad[i] = good;
    bad[0].width = -1;
    bad[1].pixels_per_point = 21;
    bad[2].latitude = 2;
    bad[3].value_low = bad[3].value_high = 1;
    bad[4].title = "\n";
    bad[5].longitude = INFINITY;
    bad[6].width = 20;
    for (int i = 0; i < 7; i++)
        check_refused(&panel, &bad[i], "a.png", BAT_INVALID_ARGUMENT);
    good.width = 9000;
    good.pixels_per_point = 3;
    check_refused(&panel, &good, "a.svg", BAT_TOO_LARGE);
    double *values = calloc(ball.vertex_count, sizeof *values);
    assert_non_null(values);
    values[5] = INFINITY;
    bat_mesh_picture_panel endless = {.mesh = &ball, .values = values};
    check_refused(&endless, NULL, "a.png", BAT_INVALID_POINT);
    ball.positions[4] = NAN;
    check_refused(&panel, NULL, "a.png", BAT_INVALID_POINT);
    free(values);
    bat_mesh_free(&ball);
}

/// Meshes that other functions refuse are drawn: an edge of three faces, a face without area, an isolated point.
static void odd_meshes_are_drawn(void **state)
{
    (void)state;
    double positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 5, 5, 5, 0.5, 0, 0};
    uint32_t faces[] = {0, 1, 2, 1, 0, 3, 0, 1, 4, 0, 6, 1};
    bat_mesh fan = {.positions = positions, .vertex_count = 7, .faces = faces, .face_count = 4};
    bat_mesh_picture_panel panels[] = {{.mesh = &fan, .wires = true}, {.mesh = &fan}};
    uint32_t flat_faces[] = {0, 6, 1};
    bat_mesh flat = {.positions = positions, .vertex_count = 7, .faces = flat_faces, .face_count = 1};
    panels[1].mesh = &flat;
    bat_mesh_picture_options options = bat_mesh_picture_defaults();
    options.own_frames = true;
    char path[128];
    path_of(path, "odd.png");
    assert_int_equal(bat_mesh_picture_write(path, panels, 2, &options, NULL), BAT_OK);
    assert_int_equal(unlink(path), 0);
}

/// Baked images keep the names, factors and textures of materials; with an atlas the textures of their own go.
static void baked_images_join_materials(void **state)
{
    (void)state;
    unsigned char blue[3] = {128, 128, 255};
    for (size_t charts = 0; charts < 2; charts++)
    {
        bat_mesh ball = make_ball(1);
        bat_mesh_baked baked = {.normal = {blue, 1, 1}, .charts = charts};
        ball.material_json = strdup("{\"materials\":[{\"name\":\"brick\",\"doubleSided\":true,\"pbrMetallicRoughness\":"
                                    "{\"roughnessFactor\":0.5,\"baseColorTexture\":{\"index\":0}}}],"
                                    "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"a.png\"}]}");
        ball.face_labels = calloc(ball.face_count, sizeof *ball.face_labels);
        ball.labels = calloc(2, sizeof *ball.labels);
        ball.labels[0].material = strdup("brick");
        ball.label_count = 2;
        assert_int_equal(bat_mesh_baked_attach(&baked, &ball, NULL), BAT_OK);
        assert_string_equal(ball.labels[0].material, "brick");
        assert_string_equal(ball.labels[1].material, "baked");
        const char *text = ball.material_json;
        assert_non_null(strstr(text, "\"name\":\"brick\",\"doubleSided\":true"));
        assert_non_null(strstr(text, "\"roughnessFactor\":0.5"));
        assert_non_null(strstr(text, "\"name\":\"baked\""));
        assert_int_equal(strstr(text, "a.png") != NULL, charts == 0);
        assert_int_equal(strstr(text, "\"baseColorTexture\":{\"index\":0}") != NULL, charts == 0);
        assert_non_null(strstr(text, charts == 0 ? "\"normalTexture\":{\"index\":1}" : "\"normalTexture\":{\"index\":0}"));
        bat_mesh_free(&ball);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(writes_all_formats),
        cmocka_unit_test(same_bytes_for_any_threads),
        cmocka_unit_test(balls_are_disks),
        cmocka_unit_test(values_are_colours),
        cmocka_unit_test(rasters_cover_and_hide),
        cmocka_unit_test(surfaces_know_their_edges),
        cmocka_unit_test(polygons_have_their_edges_alone),
        cmocka_unit_test(scale_is_even),
        cmocka_unit_test(bad_input_is_refused),
        cmocka_unit_test(odd_meshes_are_drawn),
        cmocka_unit_test(baked_images_join_materials),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
