#include "research/studies/harm.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/mesh_decimate.h"
#include "batten/mesh_measure.h"
#include "batten/mesh_refine.h"
#include "batten/research/mesh_shapes.h"
#include "batten/shell.h"
#include "batten/surface.h"
#include "research/studies/mesh_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Harm to meshes and clouds. Solids of flat faces are their own truth: half a per cent of the diagonal counts as the
/// rival's error. Coarse meshes of bodies are compared with the bodies, beside the best of three classical results. Clouds
/// lie on functions over regions of the plane; the rival fits a plane to the nearest points of each place. Closed clouds lie
/// on bodies; there the noise is the rival.

enum
{
    MAX_CORNERS = 80,
    BODY = 6000,  ///< vertices of a true body
    COARSE = 400, ///< of a coarse one
    PLACES = 300, ///< where a function is compared
    NEAREST = 12, ///< points of a plane
    MAX_CLOUD = 3000,
    GRID = 120,   ///< cells of a fitted surface, in each direction
    CLOSED = 8000 ///< points of a closed cloud
};

static const double PI = 3.14159265358979323846;

// Meshes

/// A prism over a polygon, a star or a gear, its caps cut into triangles.
static bat_status make_prism(bat_random *random, bat_mesh *solid, double *roundness, bat_error *error)
{
    size_t corners = 2 * (3 + bat_random_bits(random) % (MAX_CORNERS / 2 - 2)), at = 0;
    size_t kind = bat_random_bits(random) % 3;
    double inner = kind == 0 ? 1 : harm_between(random, 0.3, 0.9), height = exp(harm_between(random, -3, 5));
    bat_mesh prism = {.vertex_count = 2 * corners,
                      .face_count = corners + 2,
                      .positions = memory_array(6 * corners, sizeof(double)),
                      .faces = memory_array(6 * corners, sizeof(uint32_t)),
                      .offsets = memory_array(corners + 3, sizeof(uint32_t))};
    bat_status status = BAT_OK;
    if (prism.positions == NULL || prism.faces == NULL || prism.offsets == NULL)
        status = error_memory(error, 6 * corners * sizeof(double));
    for (size_t i = 0; i < corners && status == BAT_OK; i++)
    {
        double angle = 2 * PI * (double)i / (double)corners;
        double radius = (kind == 1 ? i % 2 : i / 2 % 2) == 0 ? 1 : inner;
        for (size_t top = 0; top < 2; top++)
        {
            double *p = prism.positions + 3 * (top * corners + i);
            p[0] = radius * cos(angle);
            p[1] = radius * sin(angle);
            p[2] = top == 0 ? 0 : height;
        }
        size_t next = (i + 1) % corners;
        const uint32_t side[] = {(uint32_t)i, (uint32_t)next, (uint32_t)(corners + next), (uint32_t)(corners + i)};
        prism.offsets[i] = (uint32_t)at;
        memcpy(prism.faces + at, side, sizeof side);
        at += 4;
    }
    for (size_t top = 0; top < 2 && status == BAT_OK; top++)
    {
        prism.offsets[corners + top] = (uint32_t)at;
        for (size_t i = 0; i < corners; i++)
            prism.faces[at++] = (uint32_t)(top == 0 ? corners - 1 - i : corners + i);
    }
    if (status == BAT_OK)
    {
        prism.offsets[corners + 2] = (uint32_t)at;
        status = bat_mesh_triangulate(&prism, solid, error);
    }
    *roundness = kind == 0 && corners >= 12 ? 1 - cos(PI / (double)corners) : 0; // such a prism may become round
    bat_mesh_free(&prism);
    return status;
}

static bat_status refine(const bat_mesh *coarse, bat_mesh_scheme scheme, bat_mesh *fine, bat_error *error)
{
    bat_mesh_refine_options options = bat_mesh_refine_defaults();
    options.scheme = scheme;
    options.threads = 1;
    return bat_mesh_refine(coarse, &options, fine, NULL, error);
}

static bat_status compare(const bat_mesh *first, const bat_mesh *second, bat_mesh_distance *distance, bat_error *error)
{
    bat_mesh_compare_options options = bat_mesh_compare_defaults();
    options.samples = 20000;
    options.threads = 1;
    options.tolerance = 0.01;
    return bat_mesh_compare(first, second, &options, distance, error);
}

static bat_status run_prism(bat_random *random, int variant, double *ratio, bat_error *error)
{
    static const double RIVAL = 0.005; // of the diagonal
    bat_mesh solid = {0}, fine = {0};
    bat_mesh_distance distance;
    double roundness;
    (void)variant;
    bat_status status = make_prism(random, &solid, &roundness, error);
    if (status == BAT_OK)
        status = refine(&solid, BAT_MESH_SCHEME_AUTO, &fine, error);
    if (status == BAT_OK)
        status = compare(&fine, &solid, &distance, error);
    if (status == BAT_OK)
        *ratio = distance.hausdorff / (RIVAL * distance.diagonal + roundness);
    bat_mesh_free(&solid);
    bat_mesh_free(&fine);
    return status;
}

/// A random body without a boundary.
static bat_status make_body(bat_random *random, bat_mesh *body, bat_error *error)
{
    const bat_mesh_shape_kind *kind;
    do
        kind = bat_mesh_shape_at(bat_random_bits(random) % bat_mesh_shape_count());
    while (!kind->closed || strcmp(kind->name, "cage") == 0);
    return bat_mesh_shape(kind->name, BODY, bat_random_bits(random) >> 32, body, error);
}

static bat_status coarsen(const bat_mesh *body, bat_mesh_decimate_method method, size_t vertices, bat_mesh *coarse,
                          bat_error *error)
{
    bat_mesh_decimate_options options = bat_mesh_decimate_defaults();
    options.method = method;
    options.vertices = vertices;
    return bat_mesh_decimate(body, &options, coarse, NULL, error);
}

/// The distance from a body of what a scheme makes of a coarse mesh.
static bat_status refined_error(const bat_mesh *coarse, const bat_mesh *body, bat_mesh_scheme scheme,
                                bat_mesh_distance *distance, bat_error *error)
{
    bat_mesh fine = {0};
    bat_status status = refine(coarse, scheme, &fine, error);
    if (status == BAT_OK)
        status = compare(&fine, body, distance, error);
    bat_mesh_free(&fine);
    return status;
}

/// A mean distance that counts as an error, of the diagonal. Parts with flat faces have less.
static const double MIN_ERROR = 1e-4;

static bat_status run_body(bat_random *random, int variant, double *ratio, bat_error *error)
{
    static const bat_mesh_scheme RIVALS[] = {BAT_MESH_SCHEME_MIDPOINT, BAT_MESH_SCHEME_LOOP, BAT_MESH_SCHEME_BUTTERFLY};
    bat_mesh body = {0}, coarse = {0};
    bat_mesh_distance ours = {0}, other;
    double best = INFINITY;
    (void)variant;
    bat_status status = make_body(random, &body, error);
    if (status == BAT_OK)
        status = coarsen(&body, BAT_MESH_DECIMATE_METHOD_QUADRIC, COARSE, &coarse, error);
    if (status == BAT_OK)
        status = refined_error(&coarse, &body, BAT_MESH_SCHEME_AUTO, &ours, error);
    for (size_t i = 0; i < sizeof RIVALS / sizeof *RIVALS && status == BAT_OK; i++)
    {
        status = refined_error(&coarse, &body, RIVALS[i], &other, error);
        best = fmin(best, other.mean);
    }
    *ratio = ours.mean / fmax(best, MIN_ERROR * ours.diagonal);
    bat_mesh_free(&body);
    bat_mesh_free(&coarse);
    return status;
}

static bat_status run_decimate(bat_random *random, int variant, double *ratio, bat_error *error)
{
    bat_mesh body = {0}, coarse[2] = {{0}, {0}};
    bat_mesh_distance distance[2];
    (void)variant;
    bat_status status = make_body(random, &body, error);
    const bat_mesh_decimate_method methods[2] = {bat_mesh_decimate_defaults().method, BAT_MESH_DECIMATE_METHOD_QUADRIC};
    size_t vertices = COARSE / 2 + bat_random_bits(random) % COARSE;
    for (size_t i = 0; i < 2 && status == BAT_OK; i++)
    {
        status = coarsen(&body, methods[i], vertices, &coarse[i], error);
        if (status == BAT_OK)
            status = compare(&coarse[i], &body, &distance[i], error);
    }
    if (status == BAT_OK)
        *ratio = distance[0].mean / fmax(distance[1].mean, MIN_ERROR * distance[1].diagonal);
    bat_mesh_free(&body);
    bat_mesh_free(&coarse[0]);
    bat_mesh_free(&coarse[1]);
    return status;
}

// Clouds over the plane

static bool in_square(double x, double y)
{
    return x >= 0 && x <= 1 && y >= 0 && y <= 1;
}

static bool in_disc(double x, double y)
{
    return hypot(x - 0.5, y - 0.5) < 0.5;
}

static bool in_corner(double x, double y)
{
    return in_square(x, y) && (x < 0.45 || y < 0.4);
}

static bool in_slotted(double x, double y)
{
    return in_square(x, y) && !(fabs(x - 0.5) < 0.35 && fabs(y - 0.5) < 0.06);
}

static bool (*const REGIONS[])(double x, double y) = {in_square, in_disc, in_corner, in_slotted};

/// A function of a few waves.
typedef struct wavy_field
{
    double height[4], direction[4], rate[4], phase[4];
} wavy_field;

static double field_at(const wavy_field *field, double x, double y)
{
    double z = 0;
    for (size_t k = 0; k < 4; k++)
        z += field->height[k] *
             sin(field->rate[k] * (x * cos(field->direction[k]) + y * sin(field->direction[k])) + field->phase[k]);
    return z;
}

/// The height at a place of the plane through its nearest points, by least squares.
static double plane_at(const double *points, size_t count, double x, double y)
{
    size_t nearest[NEAREST], found = 0;
    double square[NEAREST], a[3][4] = {{0}};
    for (size_t i = 0; i < count; i++)
    {
        double d = pow(points[3 * i] - x, 2) + pow(points[3 * i + 1] - y, 2);
        if (found == NEAREST && d >= square[found - 1])
            continue;
        size_t k = found < NEAREST ? found++ : found - 1;
        for (; k > 0 && square[k - 1] > d; k--)
        {
            square[k] = square[k - 1];
            nearest[k] = nearest[k - 1];
        }
        square[k] = d;
        nearest[k] = i;
    }
    for (size_t i = 0; i < found; i++)
    {
        const double *p = points + 3 * nearest[i], row[4] = {1, p[0] - x, p[1] - y, p[2]};
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 0; c < 4; c++)
                a[r][c] += row[r] * row[c];
    }
    for (size_t k = 0; k < 3; k++)
        for (size_t r = 0; r < 3; r++)
            for (size_t c = 4; r != k && c-- > k;)
                a[r][c] -= a[r][k] / a[k][k] * a[k][c];
    return a[0][3] / a[0][0];
}

/// Triangles of a surface over its whole rectangle.
static bat_status mesh_of(const bat_spline_surface *surface, bat_mesh *mesh, bat_error *error)
{
    size_t row = GRID + 1;
    double *places = memory_array(2 * row * row, sizeof *places);
    bat_status status = mesh_of_grid(GRID, mesh, error);
    if (status == BAT_OK && places == NULL)
        status = error_memory(error, 2 * row * row * sizeof *places);
    for (size_t i = 0; i < row * row && status == BAT_OK; i++)
    {
        places[2 * i] = (double)(i / row) / GRID;
        places[2 * i + 1] = (double)(i % row) / GRID;
    }
    if (status == BAT_OK)
        status = bat_spline_surface_evaluate(surface, places, row * row, 0, mesh->positions, error);
    free(places);
    return status;
}

static bat_status run_field(bat_random *random, int variant, double *ratio, bat_error *error)
{
    static const double NOISES[] = {0, 0.001, 0.004}, LEAST = 2e-5, AREA = 0.02, STEP = 1e-5;
    wavy_field field;
    double sigma = NOISES[bat_random_bits(random) % 3], planes = 0, ours = 0, area = 0, truth[3 * PLACES];
    bat_mesh_closest_point closest[PLACES];
    size_t count = bat_random_bits(random) % 2 == 0 ? MAX_CLOUD / 2 : MAX_CLOUD;
    bat_cloud cloud = {.points = memory_array(3 * count, sizeof(double)), .count = count};
    double *points = memory_array(3 * count, sizeof *points);
    bat_surface_result result = {.chosen = BAT_SURFACE_PARAMETERS_AUTO};
    bat_surface_reconstruct_options options = bat_surface_reconstruct_defaults();
    bat_mesh mesh = {0};
    bat_status status = cloud.points != NULL && points != NULL ? BAT_OK : error_memory(error, 3 * count * sizeof(double));
    for (size_t k = 0; k < 4; k++)
    {
        field.rate[k] = harm_between(random, 1, 9);
        field.height[k] = 0.12 * bat_random_normal(random) / field.rate[k];
        field.direction[k] = harm_between(random, 0, PI);
        field.phase[k] = harm_between(random, 0, 2 * PI);
    }
    for (size_t i = 0; i < count && status == BAT_OK;)
    {
        double x = bat_random_uniform(random), y = bat_random_uniform(random);
        if (!REGIONS[variant](x, y))
            continue;
        const double p[3] = {x, y, field_at(&field, x, y)};
        for (size_t c = 0; c < 3; c++)
            points[3 * i + c] = p[c] + sigma * bat_random_normal(random);
        i++;
    }
    if (status == BAT_OK)
        memcpy(cloud.points, points, 3 * count * sizeof *points);
    options.trim = true;
    options.fit.threads = 1;
    if (status == BAT_OK)
        status = bat_surface_reconstruct(&cloud, &options, &result, error);
    if (status == BAT_OK)
        status = mesh_of(&result.surface, &mesh, error);
    for (size_t i = 0; i < PLACES && status == BAT_OK;)
    {
        double x = harm_between(random, 0.05, 0.95), y = harm_between(random, 0.05, 0.95), z = field_at(&field, x, y);
        if (!REGIONS[variant](x, y))
            continue;
        double dx = (field_at(&field, x + STEP, y) - z) / STEP, dy = (field_at(&field, x, y + STEP) - z) / STEP;
        const double p[3] = {x, y, z};
        memcpy(truth + 3 * i++, p, sizeof p);
        planes += pow(plane_at(points, count, x, y) - z, 2) / (1 + dx * dx + dy * dy);
    }
    if (status == BAT_OK)
        status = bat_mesh_closest(&mesh, truth, PLACES, 1, closest, error);
    for (size_t i = 0; i < PLACES && status == BAT_OK; i++)
        ours += closest[i].distance * closest[i].distance;
    for (size_t i = 0; i < GRID * GRID; i++)
    {
        double x = ((double)(i / GRID) + 0.5) / GRID, y = ((double)(i % GRID) + 0.5) / GRID, z = field_at(&field, x, y);
        double dx = (field_at(&field, x + STEP, y) - z) / STEP, dy = (field_at(&field, x, y + STEP) - z) / STEP;
        area += REGIONS[variant](x, y) ? sqrt(1 + dx * dx + dy * dy) / (GRID * GRID) : 0;
    }
    if (status == BAT_OK)
        *ratio = fmax(sqrt(ours / PLACES) / fmax(sqrt(planes / PLACES), LEAST), fabs(result.verdict.area / area - 1) / AREA);
    bat_mesh_free(&mesh);
    bat_surface_result_free(&result);
    bat_cloud_free(&cloud);
    free(points);
    return status;
}

// Closed clouds

static bat_status run_closed(bat_random *random, int variant, double *ratio, bat_error *error)
{
    static const double NOISES[] = {0, 0.001, 0.005}, LEAST = 5e-4, VOLUME = 0.01; // of the diagonal, and of the volume
    static const size_t SAMPLES = 3;
    bat_mesh body = {0}, quads = {0}, mesh = {0};
    bat_mesh_summary summary;
    bat_shell shell = {0};
    bat_shell_report report;
    bat_shell_reconstruct_options options = bat_shell_reconstruct_defaults();
    double *points = memory_array((size_t)3 * CLOSED, sizeof *points), *distances = NULL, sum = 0;
    bat_status status = points != NULL ? make_body(random, &body, error) : error_memory(error, 3 * CLOSED * sizeof *points);
    if (status == BAT_OK)
        status = bat_mesh_summarize(&body, &summary, error);
    double size = status == BAT_OK ? summary.diagonal : 0, sigma = NOISES[variant] * size;
    options.threads = 1;
    if (status == BAT_OK)
        status = mesh_points_draw(&body, NULL, NULL, sigma, CLOSED, random, points, error);
    if (status == BAT_OK)
        status = bat_shell_reconstruct(points, CLOSED, NULL, &options, &shell, &report, error);
    if (status == BAT_OK)
        status = bat_shell_tessellate(&shell, SAMPLES, &quads, error);
    if (status == BAT_OK)
        status = bat_mesh_triangulate(&quads, &mesh, error);
    distances = memory_array(body.vertex_count + 1, sizeof *distances);
    if (status == BAT_OK && distances == NULL)
        status = error_memory(error, body.vertex_count * sizeof *distances);
    if (status == BAT_OK)
        status = bat_mesh_vertex_distances(&body, &mesh, 1, distances, error);
    for (size_t i = 0; i < body.vertex_count && status == BAT_OK; i++)
        sum += distances[i] * distances[i];
    if (status == BAT_OK)
        *ratio = fmax(sqrt(sum / (double)body.vertex_count) / fmax(sigma, LEAST * size),
                      fabs(report.volume / summary.volume - 1) / VOLUME);
    free(points);
    free(distances);
    bat_mesh_free(&body);
    bat_mesh_free(&quads);
    bat_mesh_free(&mesh);
    bat_shell_free(&shell);
    return status;
}

#define FLAT "half a per cent of the diagonal"
#define CLASSICAL "the best of midpoint, Loop and butterfly"
#define PLANE "a plane through 12 points; 2 % of the area"
#define NOISE "the noise, or .05 % of the diagonal; 1 % of the volume"

const harm_kind HARM_SURFACES[] = {
    {"meshes", "prisms over polygons, stars and gears", FLAT, run_prism, 0},
    {"meshes", "bodies of 400 vertices", CLASSICAL, run_body, 0},
    {"decimation", "bodies", "quadric errors", run_decimate, 0},
    {"clouds", "over a square", PLANE, run_field, 0},
    {"clouds", "over a disc", PLANE, run_field, 1},
    {"clouds", "over a square without a corner", PLANE, run_field, 2},
    {"clouds", "over a square with a slot", PLANE, run_field, 3},
    {"closed clouds", "bodies without noise", NOISE, run_closed, 0},
    {"closed clouds", "bodies, noise .1 %", NOISE, run_closed, 1},
    {"closed clouds", "bodies, noise .5 %", NOISE, run_closed, 2},
};
const size_t HARM_SURFACE_COUNT = sizeof HARM_SURFACES / sizeof *HARM_SURFACES;
