// Every public call that takes options: null gives the same as the defaults, and each field out of range is refused with
// BAT_INVALID_ARGUMENT, a text that names the field, and untouched results.

#include "check.h"
#include "mesh/decimate/map.h"
#include "polygon_makers.h"

#include "batten/batten.h"
#include "batten/research/chart_picture.h"
#include "batten/research/curve_analysis.h"
#include "batten/research/curve_study.h"
#include "batten/research/map_shapes.h"
#include "batten/research/mask_sweep.h"
#include "batten/research/surface_shapes.h"

#include <stdio.h>
#include <unistd.h>

enum
{
    MAX_CALLS = 6,
    MAX_FIELDS = 24,
    LARGEST_OPTIONS = 4096
};

/// What a call gave: a sum over its results that tells other bytes apart; 0 on failure.
typedef uint64_t digest;

static digest digest_of(const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    digest sum = 0xcbf29ce484222325U; // FNV-1a
    for (size_t i = 0; i < size; i++)
        sum = (sum ^ at[i]) * 0x100000001b3U;
    return sum;
}

/// Results before a call; a failing call must leave them so.
static void mark(void *result, size_t size)
{
    memset(result, 0xa5, size);
}

static void check_marked(const void *result, size_t size)
{
    const unsigned char *at = result;
    for (size_t i = 0; i < size; i++)
        assert_int_equal(at[i], 0xa5);
}

/// A file that a call writes, as a digest; it is removed.
static digest digest_of_file(const char *path)
{
    static unsigned char bytes[1 << 20];
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    (void)fclose(file);
    assert_int_equal(remove(path), 0);
    return digest_of(bytes, size);
}

/// A call of a family with options, which may be null. It checks that a failure leaves the results as they were.
typedef bat_status option_call(const void *options, digest *result, bat_error *error);

// What calls work on

static const double LINE[] = {0, 0, 1, 0.5, 2, 0, 3, 1, 4, 0};

static bat_curve plane_curve(bat_space *space)
{
    *space = bat_euclidean(2);
    return (bat_curve){.space = space, .points = (double *)(uintptr_t)LINE, .count = 5};
}

static const char *output(const char *ending)
{
    static char path[64];
    (void)snprintf(path, sizeof path, "test_options_%ld%s", (long)getpid(), ending);
    return path;
}

/// A file that must not be there after a failing call.
static bat_status finish_file(const char *path, bat_status status, digest *result)
{
    if (status == BAT_OK)
        *result = digest_of_file(path);
    else
        assert_int_not_equal(access(path, F_OK), 0);
    return status;
}

// Curves

static bat_status call_curve_refine(const void *options, digest *result, bat_error *error)
{
    bat_space space;
    bat_curve coarse = plane_curve(&space), fine;
    mark(&fine, sizeof fine);
    bat_status status = bat_curve_refine(&coarse, options, &fine, error);
    if (status != BAT_OK)
    {
        check_marked(&fine, sizeof fine);
        return status;
    }
    *result = digest_of(fine.points, fine.count * 2 * sizeof(double));
    bat_curve_free(&fine);
    return BAT_OK;
}

static bat_status call_curves_refine(const void *options, digest *result, bat_error *error)
{
    bat_space space;
    bat_curve coarse[2] = {plane_curve(&space), plane_curve(&space)}, fine[2];
    bat_status status = bat_curves_refine(coarse, 2, options, fine, error);
    for (int i = 0; i < 2; i++)
    {
        *result += digest_of(fine[i].points, fine[i].count * 2 * sizeof(double));
        assert_true(status == BAT_OK || fine[i].count == 0);
        bat_curve_free(&fine[i]);
    }
    return status;
}

static bat_status call_map_refine(const void *options, digest *result, bat_error *error)
{
    bat_space space;
    bat_curve *curves = calloc(1, sizeof *curves);
    curves[0] = plane_curve(&space);
    double *points = malloc(sizeof LINE);
    memcpy(points, LINE, sizeof LINE);
    curves[0].points = points;
    bat_curve_set coarse, fine;
    assert_int_equal(bat_curve_set_take(curves, 1, &coarse, NULL), BAT_OK);
    mark(&fine, sizeof fine);
    bat_status status = bat_curve_map_refine(&coarse, options, &fine, error);
    bat_curve_set_free(&coarse);
    if (status != BAT_OK)
    {
        check_marked(&fine, sizeof fine);
        return status;
    }
    *result = digest_of(fine.curves[0].points, fine.curves[0].count * 2 * sizeof(double));
    bat_curve_set_free(&fine);
    return BAT_OK;
}

static bat_status call_refined_count(const void *options, digest *result, bat_error *error)
{
    bat_space space;
    bat_curve coarse = plane_curve(&space);
    size_t count;
    mark(&count, sizeof count);
    bat_status status = bat_curve_refined_count(&coarse, options, &count, error);
    if (status != BAT_OK)
        check_marked(&count, sizeof count);
    else
        *result = count;
    return status;
}

static bat_status call_refine_file(const void *options, digest *result, bat_error *error)
{
    char input[64];
    (void)snprintf(input, sizeof input, "%s", output("_in.csv"));
    FILE *file = fopen(input, "w");
    assert_non_null(file);
    assert_true(fputs("x,y\n0,0\n1,0.5\n2,0\n", file) >= 0);
    assert_int_equal(fclose(file), 0);
    bat_status status = bat_curve_refine_file(input, output(".csv"), options, NULL, error);
    assert_int_equal(remove(input), 0);
    return finish_file(output(".csv"), status, result);
}

static bat_status call_refine_into(const void *options, digest *result, bat_error *error)
{
    bat_space space;
    bat_curve coarse = plane_curve(&space);
    double points[2 * 129];
    mark(points, sizeof points);
    bat_status status = bat_curve_refine_into(&coarse, options, points, NULL, 129, error);
    if (status != BAT_OK)
        check_marked(points, sizeof points);
    else
        *result = digest_of(points, sizeof points);
    return status;
}

static bat_status call_curve_compare(const void *options, digest *result, bat_error *error)
{
    bat_space space;
    bat_curve curve = plane_curve(&space), other = curve;
    other.count = 4;
    bat_curve_distance distance;
    mark(&distance, sizeof distance);
    bat_status status = bat_curve_compare(&curve, &other, options, &distance, error);
    if (status != BAT_OK)
        check_marked(&distance, sizeof distance);
    else
        *result = digest_of(&distance, sizeof distance);
    return status;
}

static bat_status call_curves_compare(const void *options, digest *result, bat_error *error)
{
    bat_space space;
    bat_curve curve = plane_curve(&space), other = curve;
    other.count = 4;
    bat_curve_distance distance;
    bat_status status = bat_curves_compare(&curve, &other, 1, options, &distance, error);
    *result = status == BAT_OK ? digest_of(&distance, sizeof distance) : 0;
    return status;
}

static bat_status call_curve_fairness(const void *options, digest *result, bat_error *error)
{
    bat_space space;
    bat_curve curve = plane_curve(&space);
    bat_curve_fairness_values fairness;
    mark(&fairness, sizeof fairness);
    bat_status status = bat_curve_fairness(&curve, options, &fairness, error);
    if (status != BAT_OK)
        check_marked(&fairness, sizeof fairness);
    else
        *result = digest_of(&fairness, sizeof fairness);
    return status;
}

static bat_status call_curves_fairness(const void *options, digest *result, bat_error *error)
{
    bat_space space;
    bat_curve curve = plane_curve(&space);
    bat_curve_fairness_values fairness;
    bat_status status = bat_curves_fairness(&curve, 1, options, &fairness, error);
    *result = status == BAT_OK ? digest_of(&fairness, sizeof fairness) : 0;
    return status;
}

static bat_status call_curves_are_simple(const void *options, digest *result, bat_error *error)
{
    bat_space space;
    bat_curve curve = plane_curve(&space);
    bool simple = false;
    bat_status status = bat_curves_are_simple(&curve, 1, options, &simple, error);
    *result = status == BAT_OK ? digest_of(&simple, sizeof simple) : 0;
    return status;
}

static bat_status call_chord_distance(const void *options, digest *result, bat_error *error)
{
    bat_space space;
    bat_curve curve = plane_curve(&space);
    double distances[2];
    mark(distances, sizeof distances);
    bat_mask_stencil stencil = {.weights = {0.25, 0.5, 0.25}, .count = 3, .first = -1};
    bat_status status = bat_curve_chord_distance(&curve, &curve, options, &distances[0], error);
    bat_status second = bat_curve_limit_distance(&curve, &stencil, options, &distances[1], error);
    assert_int_equal(status, second);
    if (status != BAT_OK)
        check_marked(distances, sizeof distances);
    else
        *result = digest_of(distances, sizeof distances);
    return status;
}

static bat_status call_mask_analyze(const void *options, digest *result, bat_error *error)
{
    bat_mask mask = bat_mask_four_point(BAT_MASK_FOUR_POINT_WEIGHT);
    bat_analysis analysis;
    mark(&analysis, sizeof analysis);
    bat_status status = bat_mask_analyze(&mask, options, &analysis, error);
    if (status != BAT_OK)
    {
        check_marked(&analysis, sizeof analysis);
        return status;
    }
    const double radii[2] = {analysis.radius_lower, analysis.radius_upper};
    *result = digest_of(radii, sizeof radii);
    bat_analysis_free(&analysis);
    return BAT_OK;
}

static bat_mask four_point_member(void *context, double weight)
{
    (void)context;
    return bat_mask_four_point(0.05 + 0.02 * weight);
}

static bat_status call_mask_sweep(const void *options, digest *result, bat_error *error)
{
    bat_mask_interval *intervals;
    size_t count;
    mark(&intervals, sizeof intervals);
    bat_status status = bat_mask_sweep(four_point_member, NULL, options, &intervals, &count, error);
    if (status != BAT_OK)
    {
        check_marked(&intervals, sizeof intervals);
        return status;
    }
    for (size_t i = 0; i < count; i++)
        *result += digest_of(&intervals[i].end, sizeof intervals[i].end) * (1 + (digest)intervals[i].verdict);
    free(intervals);
    return BAT_OK;
}

static const char CSV[] = "0,0\n1,0.5\n2,0\n3,1\n";

static bat_status call_curve_read(const void *options, digest *result, bat_error *error)
{
    bat_curve_set set;
    mark(&set, sizeof set);
    bat_status status = bat_curve_read_memory(CSV, sizeof CSV - 1, options, &set, error);
    if (status != BAT_OK)
    {
        check_marked(&set, sizeof set);
        assert_int_equal(bat_curve_read("no such file", options, &set, error), status);
        return status;
    }
    *result = digest_of(set.curves[0].points, set.curves[0].count * 2 * sizeof(double));
    bat_curve_set_free(&set);
    return BAT_OK;
}

static bat_status call_curve_write(const void *options, digest *result, bat_error *error)
{
    bat_curve_set set;
    check_status(bat_curve_read_memory(CSV, sizeof CSV - 1, NULL, &set, NULL), BAT_OK);
    char *text;
    size_t size;
    mark(&text, sizeof text);
    bat_status status = bat_curve_write_memory(&set, options, &text, &size, error);
    if (status != BAT_OK)
        check_marked(&text, sizeof text);
    else
    {
        *result = digest_of(text, size);
        free(text);
    }
    const char *path = output(".csv");
    bat_status second = finish_file(path, bat_curve_write(path, &set, options, error), result);
    assert_int_equal(status, second);
    bat_curve_set_free(&set);
    return status;
}

static bat_status call_curve_picture(const void *options, digest *result, bat_error *error)
{
    bat_space space;
    bat_curve curve = plane_curve(&space);
    bat_curve_picture_layer layer = {.curve = &curve};
    bat_curve_picture_panel panel = {.layers = &layer, .layer_count = 1};
    const char *path = output(".svg");
    return finish_file(path, bat_curve_picture_write(path, &panel, 1, options, error), result);
}

static bat_status call_chart(const void *options, digest *result, bat_error *error)
{
    bat_chart_series series = {.x = LINE, .y = LINE, .count = 4};
    bat_chart chart = bat_chart_defaults();
    chart.series = &series;
    chart.series_count = 1;
    const char *path = output(".svg");
    return finish_file(path, bat_chart_write(path, &chart, 1, options, error), result);
}

// Motions

static bat_status call_hermite_refine(const void *options, digest *result, bat_error *error)
{
    bat_space space = bat_euclidean(2);
    double points[] = {0, 0, 1, 1, 2, 0}, tangents[] = {1, 0, 1, 0, 1, 0};
    bat_hermite_curve coarse = {.space = &space, .points = points, .tangents = tangents, .count = 3}, fine;
    mark(&fine, sizeof fine);
    bat_status status = bat_hermite_refine(&coarse, options, &fine, error);
    if (status != BAT_OK)
    {
        check_marked(&fine, sizeof fine);
        return status;
    }
    *result = digest_of(fine.points, fine.count * 2 * sizeof(double));
    bat_hermite_free(&fine);
    return BAT_OK;
}

static bat_status call_motion_picture(const void *options, digest *result, bat_error *error)
{
    bat_curve_set keys;
    bat_motion_curves_options motion = bat_motion_curves_defaults();
    motion.method = BAT_MOTION_METHOD_SPLINE;
    check_status(bat_curve_read_memory(CSV, sizeof CSV - 1, NULL, &keys, NULL), BAT_OK);
    const char *path = output(".svg");
    bat_status status = finish_file(path, bat_motion_picture_write(path, &keys, &motion, options, error), result);
    bat_curve_set_free(&keys);
    return status;
}

static bat_status call_motion_curves(const void *options, digest *result, bat_error *error)
{
    bat_curve_set keys, fine;
    bat_hermite_curve data;
    check_status(bat_curve_read_memory(CSV, sizeof CSV - 1, NULL, &keys, NULL), BAT_OK);
    mark(&fine, sizeof fine);
    mark(&data, sizeof data);
    bat_status status = bat_motion_curves(&keys, options, &fine, error);
    bat_status second = bat_motion_data(&keys, 0, options, &data, error);
    assert_int_equal(status, second);
    if (status != BAT_OK)
    {
        check_marked(&fine, sizeof fine);
        check_marked(&data, sizeof data);
    }
    else
    {
        *result = digest_of(fine.curves[0].points, fine.curves[0].count * 2 * sizeof(double)) +
                  digest_of(data.tangents, data.count * 2 * sizeof(double));
        bat_curve_set_free(&fine);
        bat_hermite_free(&data);
    }
    bat_curve_set_free(&keys);
    return status;
}

// Meshes

static digest digest_of_mesh(bat_mesh *mesh)
{
    digest sum = digest_of(mesh->positions, 3 * mesh->vertex_count * sizeof(double)) +
                 digest_of(mesh->faces, 3 * mesh->face_count * sizeof(uint32_t));
    bat_mesh_free(mesh);
    return sum;
}

static bat_status call_mesh_refine(const void *options, digest *result, bat_error *error)
{
    bat_mesh coarse = mesh_icosahedron(), fine;
    size_t fallback;
    mark(&fine, sizeof fine);
    mark(&fallback, sizeof fallback);
    bat_status status = bat_mesh_refine(&coarse, options, &fine, &fallback, error);
    bat_mesh_free(&coarse);
    if (status == BAT_OK)
        *result = digest_of_mesh(&fine) + fallback;
    else
    {
        check_marked(&fine, sizeof fine);
        check_marked(&fallback, sizeof fallback);
    }
    return status;
}

static digest digest_of_polygons(bat_mesh *mesh)
{
    digest sum = digest_of(mesh->positions, 3 * mesh->vertex_count * sizeof(double)) +
                 digest_of(mesh->faces, mesh->offsets[mesh->face_count] * sizeof(uint32_t));
    bat_mesh_free(mesh);
    return sum;
}

static bat_status call_polygon_mesh_refine(const void *options, digest *result, bat_error *error)
{
    bat_mesh coarse = polygon_cube(), fine;
    size_t fallback;
    mark(&fine, sizeof fine);
    mark(&fallback, sizeof fallback);
    bat_status status = bat_mesh_refine(&coarse, options, &fine, &fallback, error);
    bat_mesh_free(&coarse);
    if (status == BAT_OK)
        *result = digest_of_polygons(&fine) + fallback;
    else
    {
        check_marked(&fine, sizeof fine);
        check_marked(&fallback, sizeof fallback);
    }
    return status;
}

static bat_status call_mesh_decimate(const void *options, digest *result, bat_error *error)
{
    bat_mesh fine = mesh_torus(12, 8), coarse;
    bat_mesh_map *map;
    mark(&coarse, sizeof coarse);
    mark(&map, sizeof map);
    bat_status status = bat_mesh_decimate(&fine, options, &coarse, &map, error);
    bat_mesh_free(&fine);
    if (status == BAT_OK)
    {
        *result = digest_of_mesh(&coarse) + map->collapse_count;
        bat_mesh_map_free(map);
        return status;
    }
    check_marked(&coarse, sizeof coarse);
    check_marked(&map, sizeof map);
    return status;
}

static bat_status call_mesh_unwrap(const void *options, digest *result, bat_error *error)
{
    bat_mesh mesh = mesh_torus(12, 8);
    size_t charts;
    mark(&charts, sizeof charts);
    bat_status status = bat_mesh_unwrap(&mesh, options, &charts, error);
    if (status == BAT_OK)
        *result = digest_of(mesh.texture, mesh.texture_count * 2 * sizeof *mesh.texture) + charts;
    else
    {
        check_marked(&charts, sizeof charts);
        assert_null(mesh.texture);
    }
    bat_mesh_free(&mesh);
    return status;
}

static bat_status call_mesh_bake(const void *options, digest *result, bat_error *error)
{
    bat_mesh fine = mesh_torus(12, 8), coarse;
    bat_mesh_map *map;
    bat_mesh_baked baked;
    assert_int_equal(bat_mesh_decimate(&fine, NULL, &coarse, &map, NULL), BAT_OK);
    mark(&baked, sizeof baked);
    bat_status status = bat_mesh_bake(map, &fine, &coarse, options, &baked, error);
    if (status == BAT_OK)
    {
        *result = digest_of(baked.normal.pixels, 3 * baked.normal.width * baked.normal.height);
        bat_mesh_baked_free(&baked);
    }
    else
        check_marked(&baked, sizeof baked);
    bat_mesh_free(&fine);
    bat_mesh_free(&coarse);
    bat_mesh_map_free(map);
    return status;
}

static bat_status call_mesh_compare(const void *options, digest *result, bat_error *error)
{
    bat_mesh first = mesh_icosahedron(), second = mesh_octahedron();
    bat_mesh_distance distance;
    mark(&distance, sizeof distance);
    bat_status status = bat_mesh_compare(&first, &second, options, &distance, error);
    bat_mesh_free(&first);
    bat_mesh_free(&second);
    if (status == BAT_OK)
        *result = digest_of(&distance, sizeof distance);
    else
        check_marked(&distance, sizeof distance);
    return status;
}

static const char OBJ[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

static bat_status call_mesh_read(const void *options, digest *result, bat_error *error)
{
    bat_mesh mesh;
    mark(&mesh, sizeof mesh);
    bat_status status = bat_mesh_read_memory(OBJ, sizeof OBJ - 1, options, &mesh, error);
    if (status == BAT_OK)
        *result = digest_of_mesh(&mesh);
    else
    {
        check_marked(&mesh, sizeof mesh);
        assert_int_equal(bat_mesh_read("no such file", options, &mesh, error), status);
    }
    return status;
}

static bat_status call_mesh_write(const void *options, digest *result, bat_error *error)
{
    bat_mesh mesh = mesh_octahedron();
    const char *path = output(".ply");
    bat_status status = finish_file(path, bat_mesh_write(path, &mesh, options, error), result);
    bat_mesh_free(&mesh);
    return status;
}

static bat_status call_polygon_mesh_write(const void *options, digest *result, bat_error *error)
{
    bat_mesh mesh = polygon_cube();
    const char *path = output(".ply");
    bat_status status = finish_file(path, bat_mesh_write(path, &mesh, options, error), result);
    bat_mesh_free(&mesh);
    return status;
}

static bat_status call_mesh_picture(const void *options, digest *result, bat_error *error)
{
    bat_mesh mesh = mesh_octahedron();
    bat_mesh_picture_panel panel = {.mesh = &mesh};
    const char *path = output(".png");
    bat_status status = finish_file(path, bat_mesh_picture_write(path, &panel, 1, options, error), result);
    bat_mesh_free(&mesh);
    return status;
}

// Clouds and surfaces

/// A small cloud with its parameters.
static bat_cloud small_cloud(double **parameters)
{
    bat_cloud_bezier_options how = bat_cloud_bezier_defaults();
    bat_random random = bat_random_seed(3);
    bat_cloud cloud;
    how.interior = 60;
    check_status(bat_cloud_bezier(&how, &random, &cloud, parameters, NULL), BAT_OK);
    return cloud;
}

static bat_status call_shape_map(const void *options, digest *result, bat_error *error)
{
    bat_curve_set set;
    mark(&set, sizeof set);
    bat_status status = bat_shape_map(options, &set, error);
    if (status != BAT_OK)
    {
        check_marked(&set, sizeof set);
        return status;
    }
    for (size_t i = 0; i < set.count; i++)
        *result += digest_of(set.curves[i].points, set.curves[i].count * 3 * sizeof(double));
    bat_curve_set_free(&set);
    return BAT_OK;
}

static bat_status call_cloud_bezier(const void *options, digest *result, bat_error *error)
{
    bat_random random = bat_random_seed(3);
    bat_cloud cloud;
    mark(&cloud, sizeof cloud);
    bat_status status = bat_cloud_bezier(options, &random, &cloud, NULL, error);
    if (status != BAT_OK)
    {
        check_marked(&cloud, sizeof cloud);
        return status;
    }
    *result = digest_of(cloud.points, 3 * cloud.count * sizeof(double));
    bat_cloud_free(&cloud);
    return BAT_OK;
}

static bat_status call_cloud_parameterize(const void *options, digest *result, bat_error *error)
{
    double *truth, found[400];
    bat_cloud cloud = small_cloud(&truth);
    assert_true(2 * cloud.count <= sizeof found / sizeof *found);
    mark(found, sizeof found);
    bat_status status = bat_cloud_parameterize(&cloud, truth, options, found, error);
    if (status == BAT_OK)
        *result = digest_of(found, 2 * cloud.count * sizeof *found);
    else
        check_marked(found, sizeof found);
    free(truth);
    bat_cloud_free(&cloud);
    return status;
}

static bat_status call_cloud_read(const void *options, digest *result, bat_error *error)
{
    const char *path = output(".xyz");
    double *truth;
    bat_cloud cloud = small_cloud(&truth), read;
    free(truth);
    check_status(bat_cloud_write(path, &cloud, NULL), BAT_OK);
    bat_cloud_free(&cloud);
    mark(&read, sizeof read);
    bat_status status = bat_cloud_read(path, options, &read, error);
    (void)remove(path);
    if (status != BAT_OK)
    {
        check_marked(&read, sizeof read);
        return status;
    }
    *result = digest_of(read.points, 3 * read.count * sizeof(double));
    bat_cloud_free(&read);
    return BAT_OK;
}

static digest digest_of_surface(const bat_spline_surface *surface)
{
    return digest_of(surface->control, bat_hierarchical_space_functions(surface->space) * 3 * sizeof(double));
}

static bat_status call_space_make(const void *options, digest *result, bat_error *error)
{
    bat_hierarchical_space *space;
    mark(&space, sizeof space);
    bat_status status = bat_hierarchical_space_make(options, &space, error);
    if (status != BAT_OK)
    {
        check_marked(&space, sizeof space);
        return status;
    }
    *result = bat_hierarchical_space_functions(space);
    bat_hierarchical_space_free(space);
    return BAT_OK;
}

static bat_status call_surface_fit(const void *options, digest *result, bat_error *error)
{
    double *parameters;
    bat_cloud cloud = small_cloud(&parameters);
    bat_surface_fit_data data = {.points = cloud.points,
                                 .parameters = parameters,
                                 .count = cloud.count,
                                 .dimension = 3,
                                 .boundary_count = cloud.boundary_count};
    bat_spline_surface surface;
    mark(&surface, sizeof surface);
    bat_status status = bat_surface_fit(&data, options, &surface, NULL, error);
    if (status == BAT_OK)
    {
        *result = digest_of_surface(&surface);
        bat_spline_surface_free(&surface);
    }
    else
        check_marked(&surface, sizeof surface);
    free(parameters);
    bat_cloud_free(&cloud);
    return status;
}

static bat_status call_reconstruct(const void *options, digest *result, bat_error *error)
{
    double *parameters;
    bat_cloud cloud = small_cloud(&parameters);
    free(parameters);
    bat_surface_result made;
    mark(&made, sizeof made);
    bat_status status = bat_surface_reconstruct(&cloud, options, &made, error);
    if (status == BAT_OK)
    {
        *result = digest_of_surface(&made.surface);
        bat_surface_result_free(&made);
    }
    else
        check_marked(&made, sizeof made);
    bat_cloud_free(&cloud);
    return status;
}

static bat_status call_shell(const void *options, digest *result, bat_error *error)
{
    enum
    {
        COUNT = 400
    };
    double points[3 * COUNT];
    for (size_t i = 0; i < COUNT; i++)
    {
        double z = -1 + ((double)i + 0.5) * 2 / COUNT, turn = 2.399963229728653 * (double)i;
        points[3 * i] = sqrt(1 - z * z) * cos(turn);
        points[3 * i + 1] = sqrt(1 - z * z) * sin(turn);
        points[3 * i + 2] = z;
    }
    bat_shell made;
    mark(&made, sizeof made);
    bat_status status = bat_shell_reconstruct(points, COUNT, NULL, options, &made, NULL, error);
    if (status == BAT_OK)
    {
        *result = digest_of(made.patches, made.cage.face_count * 48 * sizeof *made.patches);
        bat_shell_free(&made);
    }
    else
        check_marked(&made, sizeof made);
    return status;
}

static double FLAT[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};

/// The unit square as a bilinear surface.
static bat_spline_surface flat_surface(void)
{
    bat_hierarchical_options bilinear = bat_hierarchical_defaults();
    bilinear.degree[0] = bilinear.degree[1] = 1;
    bat_spline_surface surface = {.control = FLAT, .dimension = 3};
    check_status(bat_hierarchical_space_make(&bilinear, &surface.space, NULL), BAT_OK);
    return surface;
}

static bat_status call_surface_write(const void *options, digest *result, bat_error *error)
{
    bat_spline_surface surface = flat_surface();
    const char *path = output(".vtk");
    bat_status status = finish_file(path, bat_surface_write(path, &surface, options, error), result);
    bat_hierarchical_space_free(surface.space);
    return status;
}

static bat_status call_surface_picture(const void *options, digest *result, bat_error *error)
{
    bat_spline_surface surface = flat_surface();
    bat_surface_picture_row row = {.surface = &surface};
    const char *path = output(".png");
    bat_status status = finish_file(path, bat_surface_picture_write(path, &row, 1, options, error), result);
    bat_hierarchical_space_free(surface.space);
    return status;
}

// The families of options

/// A value out of the range of a field.
typedef struct bad_value
{
    const char *field; ///< what the text must name
    size_t offset;
    enum
    {
        BAD_INT, ///< also enumerations
        BAD_SIZE,
        BAD_NUMBER,
        BAD_POINTER ///< not null, whatever the value is
    } kind;
    double value;
} bad_value;

/// An options struct: its defaults, its check, and the calls that take it.
typedef struct option_family
{
    const char *name;
    size_t size;
    void (*defaults)(void *options);
    bat_status (*check)(const void *options, bat_error *error);
    option_call *calls[MAX_CALLS];
    bad_value bad[MAX_FIELDS];
} option_family;

// The functions of a family, with options as void pointers.
#define FAMILY(stem, maker)                                                                                                 \
    static void stem##_fill(void *options)                                                                                  \
    {                                                                                                                       \
        *(bat_##stem##_options *)options = maker();                                                                         \
    }                                                                                                                       \
    static bat_status stem##_verify(const void *options, bat_error *error)                                                  \
    {                                                                                                                       \
        return bat_options_check(&bat_##stem##_fields, options, error);                                                     \
    }

FAMILY(curve_refine, bat_curve_refine_defaults)
FAMILY(curve_map_refine, bat_curve_map_refine_defaults)
FAMILY(curve_measure, bat_curve_measure_defaults)
FAMILY(mask_analyze, bat_mask_analyze_defaults)
FAMILY(mask_sweep, bat_mask_sweep_defaults)
FAMILY(curve_read, bat_curve_read_defaults)
FAMILY(curve_write, bat_curve_write_defaults)
FAMILY(curve_refine_file, bat_curve_refine_file_defaults)
FAMILY(curve_picture, bat_curve_picture_defaults)
FAMILY(hermite_refine, bat_hermite_refine_defaults)
FAMILY(motion_curves, bat_motion_curves_defaults)
FAMILY(motion_picture, bat_motion_picture_defaults)
FAMILY(mesh_refine, bat_mesh_refine_defaults)
FAMILY(mesh_decimate, bat_mesh_decimate_defaults)
FAMILY(mesh_unwrap, bat_mesh_unwrap_defaults)
FAMILY(mesh_bake, bat_mesh_bake_defaults)
FAMILY(mesh_compare, bat_mesh_compare_defaults)
FAMILY(mesh_read, bat_mesh_read_defaults)
FAMILY(mesh_write, bat_mesh_write_defaults)
FAMILY(mesh_picture, bat_mesh_picture_defaults)
FAMILY(cloud_bezier, bat_cloud_bezier_defaults)
FAMILY(shape_map, bat_shape_map_defaults)
FAMILY(cloud_parameterize, bat_cloud_parameterize_defaults)
FAMILY(cloud_read, bat_cloud_read_defaults)
FAMILY(hierarchical, bat_hierarchical_defaults)
FAMILY(surface_fit, bat_surface_fit_defaults)
FAMILY(surface_reconstruct, bat_surface_reconstruct_defaults)
FAMILY(shell_reconstruct, bat_shell_reconstruct_defaults)
FAMILY(surface_write, bat_surface_write_defaults)
FAMILY(surface_picture, bat_surface_picture_defaults)

#define BAD(stem, member, kind, value)                                                                                      \
    {                                                                                                                       \
#member, offsetof(bat_##stem##_options, member), kind, value                                                        \
    }
#define HEAD(stem) #stem, sizeof(bat_##stem##_options), stem##_fill, stem##_verify

static const option_family FAMILIES[] = {
    {HEAD(curve_refine),
     {call_curve_refine, call_curves_refine, call_refined_count, call_refine_into},
     {BAD(curve_refine, scheme.kind, BAD_INT, 17),
      BAD(curve_refine, scheme.kind, BAD_INT, -1),
      BAD(curve_refine, levels, BAD_SIZE, 61),
      BAD(curve_refine, ends, BAD_INT, 4),
      BAD(curve_refine, ends, BAD_INT, -1),
      BAD(curve_refine, max_points, BAD_SIZE, 0),
      BAD(curve_refine, threads, BAD_INT, -1),
      BAD(curve_refine, threads, BAD_INT, 1025),
      BAD(curve_refine, simple, BAD_INT, 4),
      BAD(curve_refine, simple, BAD_INT, -1),
      BAD(curve_refine, corner_angle, BAD_NUMBER, -0.1),
      BAD(curve_refine, corner_angle, BAD_NUMBER, 3.2),
      BAD(curve_refine, corner_angle, BAD_NUMBER, NAN),
      BAD(curve_refine, max_edge, BAD_NUMBER, -1),
      BAD(curve_refine, max_edge, BAD_NUMBER, NAN),
      BAD(curve_refine, tolerance, BAD_NUMBER, -1),
      BAD(curve_refine, tolerance, BAD_NUMBER, INFINITY),
      BAD(curve_refine, max_levels, BAD_SIZE, 41),
      BAD(curve_refine, first_level, BAD_SIZE, 61),
      BAD(curve_refine, smooth, BAD_NUMBER, -1),
      BAD(curve_refine, smooth, BAD_NUMBER, INFINITY)}},
    {HEAD(curve_map_refine),
     {call_map_refine},
     {BAD(curve_map_refine, refine.levels, BAD_SIZE, 61), BAD(curve_map_refine, topology, BAD_INT, 4),
      BAD(curve_map_refine, edges, BAD_INT, 3), BAD(curve_map_refine, join, BAD_INT, 2),
      BAD(curve_map_refine, simplify, BAD_NUMBER, -1), BAD(curve_map_refine, topology, BAD_INT, -1),
      BAD(curve_map_refine, snap_tolerance, BAD_NUMBER, -1), BAD(curve_map_refine, snap_tolerance, BAD_NUMBER, NAN),
      BAD(curve_map_refine, decimals, BAD_INT, -1), BAD(curve_map_refine, decimals, BAD_INT, 13)}},
    {HEAD(curve_measure),
     {call_curve_compare, call_curves_compare, call_curve_fairness, call_curves_fairness, call_chord_distance,
      call_curves_are_simple},
     {BAD(curve_measure, bending_offset, BAD_NUMBER, -1), BAD(curve_measure, bending_offset, BAD_NUMBER, NAN),
      BAD(curve_measure, bending_offset, BAD_NUMBER, INFINITY), BAD(curve_measure, threads, BAD_INT, -1)}},
    {HEAD(mask_analyze),
     {call_mask_analyze},
     {BAD(mask_analyze, depth, BAD_SIZE, 0), BAD(mask_analyze, depth, BAD_SIZE, 25),
      BAD(mask_analyze, tolerance, BAD_NUMBER, 0), BAD(mask_analyze, tolerance, BAD_NUMBER, NAN),
      BAD(mask_analyze, vertices, BAD_SIZE, 0), BAD(mask_analyze, vertices, BAD_SIZE, 1e6)}},
    {HEAD(mask_sweep),
     {call_mask_sweep},
     {BAD(mask_sweep, begin, BAD_NUMBER, NAN), BAD(mask_sweep, end, BAD_NUMBER, INFINITY),
      BAD(mask_sweep, end, BAD_NUMBER, -1), BAD(mask_sweep, smoothness, BAD_SIZE, 31),
      BAD(mask_sweep, tolerance, BAD_NUMBER, -1), BAD(mask_sweep, analysis.depth, BAD_SIZE, 25)}},
    {HEAD(curve_read),
     {call_curve_read},
     {BAD(curve_read, format, BAD_INT, 99), BAD(curve_read, closed, BAD_INT, 2), BAD(curve_read, closed, BAD_INT, -2),
      BAD(curve_read, threads, BAD_INT, -1)}},
    {HEAD(curve_write),
     {call_curve_write},
     {BAD(curve_write, format, BAD_INT, -1), BAD(curve_write, precision, BAD_INT, 13),
      BAD(curve_write, precision, BAD_INT, -1), BAD(curve_write, threads, BAD_INT, -1)}},
    {HEAD(curve_picture),
     {call_curve_picture, call_chart},
     {BAD(curve_picture, width, BAD_NUMBER, 19), BAD(curve_picture, width, BAD_NUMBER, NAN),
      BAD(curve_picture, height, BAD_NUMBER, 10001), BAD(curve_picture, pixels_per_point, BAD_NUMBER, 0),
      BAD(curve_picture, pixels_per_point, BAD_NUMBER, 21), BAD(curve_picture, projection, BAD_INT, 5),
      BAD(curve_picture, longitude, BAD_NUMBER, INFINITY), BAD(curve_picture, latitude, BAD_NUMBER, 2),
      BAD(curve_picture, comb_scale, BAD_NUMBER, -1)}},
    {HEAD(hermite_refine),
     {call_hermite_refine},
     {BAD(hermite_refine, order, BAD_SIZE, 0), BAD(hermite_refine, order, BAD_SIZE, 127),
      BAD(hermite_refine, levels, BAD_SIZE, 61), BAD(hermite_refine, max_points, BAD_SIZE, 0),
      BAD(hermite_refine, threads, BAD_INT, -1)}},
    {HEAD(motion_curves),
     {call_motion_curves},
     {BAD(motion_curves, method, BAD_INT, 3), BAD(motion_curves, spline.ends, BAD_INT, 4),
      BAD(motion_curves, spline.shape, BAD_INT, -1), BAD(motion_curves, spline.threads, BAD_INT, -1),
      BAD(motion_curves, rate, BAD_NUMBER, -1), BAD(motion_curves, rate, BAD_NUMBER, NAN),
      BAD(motion_curves, tangent_order, BAD_SIZE, 1), BAD(motion_curves, tangent_order, BAD_SIZE, 3),
      BAD(motion_curves, scheme.order, BAD_SIZE, 0)}},
    {HEAD(motion_picture),
     {call_motion_picture},
     {BAD(motion_picture, width, BAD_NUMBER, 99), BAD(motion_picture, height, BAD_NUMBER, NAN),
      BAD(motion_picture, pixels_per_point, BAD_NUMBER, 0), BAD(motion_picture, poses, BAD_SIZE, 1001)}},
    {HEAD(mesh_refine),
     {call_mesh_refine, call_polygon_mesh_refine},
     {BAD(mesh_refine, scheme, BAD_INT, 17), BAD(mesh_refine, scheme, BAD_INT, -1),
      BAD(mesh_refine, then, BAD_INT, BAT_MESH_SCHEME_SQRT3), BAD(mesh_refine, then, BAD_INT, 17),
      BAD(mesh_refine, fairness, BAD_NUMBER, -0.1), BAD(mesh_refine, fairness, BAD_NUMBER, 1.1),
      BAD(mesh_refine, fairness, BAD_NUMBER, NAN), BAD(mesh_refine, levels, BAD_SIZE, 33),
      BAD(mesh_refine, crease_angle, BAD_NUMBER, NAN), BAD(mesh_refine, crease_angle, BAD_NUMBER, -1),
      BAD(mesh_refine, crease_angle, BAD_NUMBER, 4), BAD(mesh_refine, threads, BAD_INT, -1),
      BAD(mesh_refine, limit_normals, BAD_POINTER, 1), // without `limit`
      BAD(mesh_refine, rules.boundary, BAD_INT, 4), BAD(mesh_refine, rules.creasing, BAD_INT, 3),
      BAD(mesh_refine, rules.linear, BAD_INT, -1), BAD(mesh_refine, tolerance, BAD_NUMBER, -1),
      BAD(mesh_refine, tolerance, BAD_NUMBER, INFINITY), BAD(mesh_refine, max_edge, BAD_NUMBER, NAN)}},
    {HEAD(mesh_decimate),
     {call_mesh_decimate},
     {BAD(mesh_decimate, min_normal, BAD_NUMBER, 1.5), BAD(mesh_decimate, min_normal, BAD_NUMBER, NAN),
      BAD(mesh_decimate, min_quality, BAD_NUMBER, -0.5), BAD(mesh_decimate, boundary_weight, BAD_NUMBER, -1),
      BAD(mesh_decimate, boundary_weight, BAD_NUMBER, INFINITY), BAD(mesh_decimate, ratio, BAD_NUMBER, 1.5),
      BAD(mesh_decimate, tolerance, BAD_NUMBER, NAN), BAD(mesh_decimate, attributes, BAD_NUMBER, -1),
      BAD(mesh_decimate, method, BAD_INT, 6), BAD(mesh_decimate, threads, BAD_INT, -1)}},
    {HEAD(mesh_unwrap),
     {call_mesh_unwrap},
     {BAD(mesh_unwrap, size, BAD_SIZE, 15), BAD(mesh_unwrap, size, BAD_SIZE, 16385), BAD(mesh_unwrap, padding, BAD_SIZE, 0),
      BAD(mesh_unwrap, max_angle, BAD_NUMBER, 1.6), BAD(mesh_unwrap, max_angle, BAD_NUMBER, NAN)}},
    {HEAD(mesh_bake),
     {call_mesh_bake},
     {BAD(mesh_bake, rays, BAD_SIZE, 0), BAD(mesh_bake, distance, BAD_NUMBER, 0), BAD(mesh_bake, distance, BAD_NUMBER, NAN),
      BAD(mesh_bake, threads, BAD_INT, -1), BAD(mesh_bake, unwrap.size, BAD_SIZE, 15)}},
    {HEAD(mesh_compare),
     {call_mesh_compare},
     {BAD(mesh_compare, samples, BAD_SIZE, 0), BAD(mesh_compare, samples, BAD_SIZE, 0x1p41),
      BAD(mesh_compare, tolerance, BAD_NUMBER, -1), BAD(mesh_compare, tolerance, BAD_NUMBER, NAN),
      BAD(mesh_compare, threads, BAD_INT, -1)}},
    {HEAD(mesh_read), {call_mesh_read}, {BAD(mesh_read, format, BAD_INT, 9)}},
    {HEAD(mesh_write),
     {call_mesh_write, call_polygon_mesh_write},
     {BAD(mesh_write, format, BAD_INT, 9), BAD(mesh_write, encoding, BAD_INT, 4), BAD(mesh_write, threads, BAD_INT, -1),
      BAD(mesh_write, normals, BAD_INT, 3), BAD(mesh_write, normals, BAD_INT, -1)}},
    {HEAD(mesh_picture),
     {call_mesh_picture},
     {BAD(mesh_picture, width, BAD_NUMBER, -1), BAD(mesh_picture, height, BAD_NUMBER, NAN),
      BAD(mesh_picture, pixels_per_point, BAD_NUMBER, 0), BAD(mesh_picture, up, BAD_INT, 4),
      BAD(mesh_picture, longitude, BAD_NUMBER, INFINITY), BAD(mesh_picture, latitude, BAD_NUMBER, 2),
      BAD(mesh_picture, value_low, BAD_NUMBER, INFINITY), BAD(mesh_picture, value_high, BAD_NUMBER, INFINITY),
      BAD(mesh_picture, threads, BAD_INT, -1)}},
    {HEAD(curve_refine_file),
     {call_refine_file},
     {BAD(curve_refine_file, read.format, BAD_INT, 99), BAD(curve_refine_file, refine.levels, BAD_SIZE, 61),
      BAD(curve_refine_file, write.precision, BAD_INT, 13)}},
    {HEAD(shape_map),
     {call_shape_map},
     {BAD(shape_map, countries, BAD_SIZE, 11), BAD(shape_map, countries, BAD_SIZE, 5001),
      BAD(shape_map, detail, BAD_SIZE, 0), BAD(shape_map, detail, BAD_SIZE, 11)}},
    {HEAD(cloud_bezier),
     {call_cloud_bezier},
     {BAD(cloud_bezier, degree, BAD_INT, 0), BAD(cloud_bezier, degree, BAD_INT, 16), BAD(cloud_bezier, side, BAD_SIZE, 1),
      BAD(cloud_bezier, noise, BAD_NUMBER, NAN)}},
    {HEAD(cloud_parameterize),
     {call_cloud_parameterize},
     {BAD(cloud_parameterize, method, BAD_INT, 9), BAD(cloud_parameterize, method, BAD_INT, -1),
      BAD(cloud_parameterize, radius, BAD_NUMBER, -1), BAD(cloud_parameterize, radius, BAD_NUMBER, NAN),
      BAD(cloud_parameterize, threads, BAD_INT, -1)}},
    {HEAD(cloud_read), {call_cloud_read}, {BAD(cloud_read, format, BAD_INT, 11)}},
    {HEAD(hierarchical),
     {call_space_make},
     {BAD(hierarchical, degree[0], BAD_INT, 0), BAD(hierarchical, degree[1], BAD_INT, 16),
      BAD(hierarchical, spans[0], BAD_SIZE, 0), BAD(hierarchical, spans[1], BAD_SIZE, 0),
      BAD(hierarchical, admissible, BAD_INT, -1), BAD(hierarchical, admissible, BAD_INT, 1)}},
    {HEAD(surface_fit),
     {call_surface_fit},
     {BAD(surface_fit, space.degree[0], BAD_INT, 16), BAD(surface_fit, tolerance, BAD_NUMBER, -1),
      BAD(surface_fit, tolerance, BAD_NUMBER, NAN), BAD(surface_fit, share, BAD_NUMBER, 0),
      BAD(surface_fit, share, BAD_NUMBER, 1.5), BAD(surface_fit, iterations, BAD_INT, -1),
      BAD(surface_fit, iterations, BAD_INT, 1001), BAD(surface_fit, neighbours, BAD_INT, 65),
      BAD(surface_fit, smoothing, BAD_INT, 5), BAD(surface_fit, weight, BAD_NUMBER, -1),
      BAD(surface_fit, noise, BAD_NUMBER, NAN), BAD(surface_fit, corrections, BAD_INT, -1),
      BAD(surface_fit, final_corrections, BAD_INT, -1), BAD(surface_fit, threads, BAD_INT, -1)}},
    {HEAD(surface_reconstruct),
     {call_reconstruct},
     {BAD(surface_reconstruct, parameters, BAD_INT, 99), BAD(surface_reconstruct, parameters, BAD_INT, -1),
      BAD(surface_reconstruct, sides, BAD_INT, 4), BAD(surface_reconstruct, fill_holes, BAD_NUMBER, -1),
      BAD(surface_reconstruct, fill_holes, BAD_NUMBER, NAN), BAD(surface_reconstruct, fill_holes, BAD_NUMBER, 1),
      BAD(surface_reconstruct, close_gaps, BAD_NUMBER, 1), BAD(surface_reconstruct, fit.share, BAD_NUMBER, 0),
      BAD(surface_reconstruct, fit.functions, BAD_SIZE, 8)}},
    {HEAD(shell_reconstruct),
     {call_shell},
     {BAD(shell_reconstruct, tolerance, BAD_NUMBER, -1), BAD(shell_reconstruct, spans, BAD_SIZE, 1),
      BAD(shell_reconstruct, crease, BAD_NUMBER, 4), BAD(shell_reconstruct, fill_holes, BAD_NUMBER, NAN),
      BAD(shell_reconstruct, faces, BAD_SIZE, 1000001), BAD(shell_reconstruct, threads, BAD_INT, -1)}},
    {HEAD(surface_write),
     {call_surface_write},
     {BAD(surface_write, format, BAD_INT, 9), BAD(surface_write, samples, BAD_SIZE, 1025),
      BAD(surface_write, unit, BAD_INT, 4), BAD(surface_write, unit, BAD_INT, -1)}},
    {HEAD(surface_picture),
     {call_surface_picture},
     {BAD(surface_picture, width, BAD_INT, 59), BAD(surface_picture, width, BAD_INT, -1),
      BAD(surface_picture, largest_error, BAD_NUMBER, -1), BAD(surface_picture, view[1], BAD_NUMBER, NAN),
      BAD(surface_picture, up[2], BAD_NUMBER, INFINITY)}},
};
enum
{
    FAMILY_COUNT = sizeof FAMILIES / sizeof *FAMILIES
};

static void null_means_the_defaults(void **state)
{
    (void)state;
    _Alignas(16) unsigned char options[LARGEST_OPTIONS];
    for (size_t f = 0; f < FAMILY_COUNT; f++)
    {
        const option_family *family = &FAMILIES[f];
        assert_true(family->size <= sizeof options);
        family->defaults(options);
        check_status(family->check(options, NULL), BAT_OK);
        check_status(family->check(NULL, NULL), BAT_OK);
        for (size_t c = 0; c < MAX_CALLS && family->calls[c] != NULL; c++)
        {
            digest with_null = 0, with_defaults = 0;
            bat_error error = {.text = ""};
            bat_status by_null = family->calls[c](NULL, &with_null, &error);
            bat_status by_defaults = family->calls[c](options, &with_defaults, &error);
            if (by_null != by_defaults || with_null != with_defaults)
                fail_msg("%s, call %zu: null is not the defaults (%d, %d): %s", family->name, c, (int)by_null,
                         (int)by_defaults, error.text);
            if (by_null != BAT_OK)
                fail_msg("%s, call %zu: %s", family->name, c, error.text);
        }
    }
}

static void spoil(unsigned char *options, const bad_value *bad)
{
    static double *pointed;
    double **pointer = &pointed;
    int whole = bad->kind == BAD_INT ? (int)bad->value : 0;
    size_t size = bad->kind == BAD_SIZE ? (size_t)bad->value : 0;
    if (bad->kind == BAD_INT)
        memcpy(options + bad->offset, &whole, sizeof whole);
    else if (bad->kind == BAD_SIZE)
        memcpy(options + bad->offset, &size, sizeof size);
    else if (bad->kind == BAD_POINTER)
        memcpy(options + bad->offset, (const void *)&pointer, sizeof pointer);
    else
        memcpy(options + bad->offset, &bad->value, sizeof bad->value);
}

/// The last part of a field's name: "depth" of "analysis.depth".
static const char *name_of(const bad_value *bad)
{
    const char *dot = strrchr(bad->field, '.');
    return dot != NULL ? dot + 1 : bad->field;
}

/// A check's text is that of every call.
static void fields_out_of_range_are_refused(void **state)
{
    (void)state;
    _Alignas(16) unsigned char options[LARGEST_OPTIONS];
    for (size_t f = 0; f < FAMILY_COUNT; f++)
        for (size_t b = 0; b < MAX_FIELDS && FAMILIES[f].bad[b].field != NULL; b++)
        {
            const option_family *family = &FAMILIES[f];
            const bad_value *bad = &family->bad[b];
            bat_error error = {.text = ""}, own = {.text = ""};
            family->defaults(options);
            spoil(options, bad);
            if (family->check(options, &own) != BAT_INVALID_ARGUMENT ||
                (strncmp(own.text, name_of(bad), strlen(name_of(bad))) != 0 &&
                 strncmp(own.text, bad->field, strlen(bad->field)) != 0))
                fail_msg("%s: %s of %g: '%s'", family->name, bad->field, bad->value, own.text);
            for (size_t c = 0; c < MAX_CALLS && family->calls[c] != NULL; c++)
            {
                digest result = 0;
                bat_status status = family->calls[c](options, &result, &error);
                if (status != BAT_INVALID_ARGUMENT || strcmp(error.text, own.text) != 0)
                    fail_msg("%s, call %zu: %s of %g is status %d, '%s'", family->name, c, bad->field, bad->value,
                             (int)status, error.text);
            }
        }
}

/// Any bound on memory is valid. A refinement that needs more is refused, and a sufficient bound changes nothing.
static void memory_is_bounded(void **state)
{
    (void)state;
    option_call *calls[2] = {call_mesh_refine, call_polygon_mesh_refine};
    for (int i = 0; i < 2; i++)
    {
        bat_mesh_refine_options options = bat_mesh_refine_defaults();
        bat_error error = {.text = ""};
        digest without = 0, with = 0;
        check_status(calls[i](&options, &without, &error), BAT_OK);
        options.max_memory = 1 << 24;
        check_status(calls[i](&options, &with, &error), BAT_OK);
        assert_true(with == without);
        options.max_memory = 1;
        check_status(calls[i](&options, &with, &error), BAT_TOO_LARGE);
        assert_non_null(strstr(error.text, " GB allowed"));
        assert_string_equal(error.remedy, "levels");
    }
}

/// At most one target of decimation may be set.
static void targets_exclude_each_other(void **state)
{
    (void)state;
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    bat_error error = {.text = ""};
    digest result = 0;
    options.vertices = 20;
    check_status(call_mesh_decimate(&options, &result, &error), BAT_OK);
    options.faces = 20;
    check_status(call_mesh_decimate(&options, &result, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "exclude each other"));
}

/// The default scheme of a space is known by its name.
static void every_space_has_a_default_scheme(void **state)
{
    (void)state;
    const struct
    {
        bat_space space;
        const char *name;
    } cases[] = {
        {bat_euclidean(2), "learned"},    {bat_sphere(2), "learned"},   {bat_disk(), "learned"},
        {bat_euclidean(3), "four-point"}, {bat_sphere(3), "log-exp-4"}, {bat_rotation(), "log-exp-4"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        const char *name;
        (void)bat_curve_scheme_for(&cases[i].space, &name);
        assert_string_equal(name, cases[i].name);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(null_means_the_defaults),
        cmocka_unit_test(fields_out_of_range_are_refused),
        cmocka_unit_test(memory_is_bounded),
        cmocka_unit_test(targets_exclude_each_other),
        cmocka_unit_test(every_space_has_a_default_scheme),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
