#include "draw/mesh/shade.h"

#include "base/error.h"
#include "base/threads.h"
#include "linalg/vector.h"

#include <string.h>

/// @file
/// Shading with two lights, a highlight (Blinn, "Models of light reflection for computer synthesized pictures", 1977) and
/// screen-space ambient occlusion (Mittring, "Finding next gen: CryEngine 2", 2007).

/// The visible surface at the pixels of a picture. Depths are in pixels towards the eye, or -HUGE_VALF for no surface. Unit
/// normals have x to the right, y upwards, z to the eye.
typedef struct occlusion_picture
{
    size_t columns, rows;
    const float *depths;
    const float (*normals)[3];
    double reach; ///< in pixels; farther surfaces do not occlude
} occlusion_picture;

/// The sampling pattern changes within tiles of TILE x TILE pixels; a mean over a tile smooths the result.
#define TILE 4
#define TAPS 16

/// The offsets of samples around a pixel, for each pixel of a tile, relative to the reach.
typedef struct tap_list
{
    float offsets[TILE * TILE][TAPS][2];
} tap_list;

static void spread_taps(tap_list *taps)
{
    const double golden = 2.39996322972865332;
    for (int cell = 0; cell < TILE * TILE; cell++)
        for (int tap = 0; tap < TAPS; tap++)
        {
            // A spiral, rotated for every pixel so that neighbours differ.
            double share = sqrt((tap + 0.35 + 0.3 * (cell % 3)) / TAPS);
            double angle = golden * tap + ANGLE_TURN * (cell * 7 % (TILE * TILE)) / (TILE * TILE);
            taps->offsets[cell][tap][0] = (float)(share * cos(angle));
            taps->offsets[cell][tap][1] = (float)(share * sin(angle));
        }
}

/// The occlusion by one sample above the surface's tangent plane. It increases with the elevation and is 0 beyond the reach.
static double shadow_of(const occlusion_picture *picture, size_t here, size_t there, double across, double down)
{
    double depth = picture->depths[there];
    if (depth == -HUGE_VAL)
        return 0;
    const float *normal = picture->normals[here];
    double rise = depth - (double)picture->depths[here];
    double length = sqrt(across * across + down * down + rise * rise) + 1e-9;
    double height = (normal[0] * across - normal[1] * down + normal[2] * rise) / length;
    double nearness = length / picture->reach;
    return nearness >= 1.6 ? 0 : fmax(height - 0.08, 0) * fmin(1, (1.6 - nearness) / 0.6);
}

static double light_at(const occlusion_picture *picture, const tap_list *taps, size_t column, size_t row)
{
    size_t here = row * picture->columns + column;
    double shadow = 0;
    for (int tap = 0; tap < TAPS; tap++)
    {
        const float *offset = taps->offsets[row % TILE * TILE + column % TILE][tap];
        double x = rint((double)column + offset[0] * picture->reach), y = rint((double)row + offset[1] * picture->reach);
        if (x < 0 || y < 0 || x >= (double)picture->columns || y >= (double)picture->rows)
            continue;
        size_t there = (size_t)y * picture->columns + (size_t)x;
        if (there != here)
            shadow += shadow_of(picture, here, there, x - (double)column, y - (double)row);
    }
    return fmax(0, 1 - 2.0 * shadow / TAPS);
}

/// The mean over a tile of the pixels with similar depth.
static float smooth_at(const occlusion_picture *picture, const float *rough, size_t column, size_t row)
{
    size_t here = row * picture->columns + column;
    double sum = 0, weight = 0;
    for (size_t y = row < 2 ? 0 : row - 2; y < row + 2 && y < picture->rows; y++)
        for (size_t x = column < 2 ? 0 : column - 2; x < column + 2 && x < picture->columns; x++)
        {
            size_t there = y * picture->columns + x;
            if (fabsf(picture->depths[there] - picture->depths[here]) > 0.35 * picture->reach)
                continue;
            sum += rough[there];
            weight += 1;
        }
    return weight > 0 ? (float)(sum / weight) : rough[here];
}

/// Compute the ambient light at each pixel, 0 to 1: the unoccluded fraction of the hemisphere above the tangent plane.
/// @param light receives columns x rows values
static bat_status ambient_occlusion(const occlusion_picture *picture, int threads, float *light, bat_error *error)
{
    tap_list taps;
    spread_taps(&taps);
    size_t columns = picture->columns, rows = picture->rows;
    float *rough = memory_array(columns * rows, sizeof *rough);
    if (rough == NULL)
        return error_memory(error, columns * rows * sizeof *rough);
    int count = threads_for(threads, rows / 16 + 1);
#pragma omp parallel for num_threads(count) schedule(static)
    for (size_t row = 0; row < rows; row++)
        for (size_t column = 0; column < columns; column++)
        {
            bool visible = picture->depths[row * columns + column] != -HUGE_VALF;
            rough[row * columns + column] = visible ? (float)light_at(picture, &taps, column, row) : 1;
        }
#pragma omp parallel for num_threads(count) schedule(static)
    for (size_t row = 0; row < rows; row++)
        for (size_t column = 0; column < columns; column++)
        {
            bool visible = picture->depths[row * columns + column] != -HUGE_VALF;
            light[row * columns + column] = visible ? smooth_at(picture, rough, column, row) : 1;
        }
    free(rough);
    return BAT_OK;
}

/// Colours in sRGB; shading uses linear light.
static const draw_colour CLAY = {0.90, 0.845, 0.775};
static const draw_colour INSIDE = {0.55, 0.61, 0.68};
static const draw_colour NO_VALUE = {0.75, 0.75, 0.75};
static const draw_colour WIRE = {0.13, 0.15, 0.19};
static const draw_colour BOUNDARY = {0.02, 0.33, 0.62};

#define WIRE_OPACITY 0.8
#define OUTLINE_OPACITY 0.75

#define LINE_OUTLINE 1
#define LINE_BOUNDARY 2
/// The width of boundaries, relative to wires.
#define BOUNDARY_WIDENING 2.6
/// The reach of ambient occlusion, relative to the larger side of the picture.
#define OCCLUSION_REACH 0.055

/// Wires fade on faces that are smaller than this, in pixels, because they would cover everything.
#define WIRE_FADES_FROM 9.0
#define WIRE_GONE_AT 1.5

typedef struct shading
{
    const shade_task *task;
    mesh_raster raster;
    mesh_surface surface;
    float *light;                                       ///< for each pixel: its ambient light
    unsigned char *lines;                               ///< for each sample: LINE_BOUNDARY, LINE_OUTLINE or 0; or null
    draw_colour clay, inside, no_value, wire, boundary; ///< in linear light
} shading;

static draw_colour linear_colour(draw_colour encoded)
{
    return (draw_colour){colour_decode(encoded.red), colour_decode(encoded.green), colour_decode(encoded.blue)};
}

/// The visible point of a sample.
typedef struct visible_point
{
    uint32_t face;
    double share[3];  ///< barycentric coordinates
    double normal[3]; ///< right, up and towards the eye; the side that faces the eye
    bool behind;      ///< the back of the face is visible
} visible_point;

/// Find the visible point of sample (x, y).
static visible_point visible_at(const shading *s, size_t x, size_t y)
{
    visible_point visible = {.face = s->raster.faces[y * s->raster.columns + x]};
    const uint32_t *corners = s->task->mesh->faces + 3 * (size_t)visible.face;
    mesh_raster_locate(&s->raster, corners, (double)x + 0.5, (double)y + 0.5, visible.share);
    const double *a = s->raster.places + 3 * (size_t)corners[0], *b = s->raster.places + 3 * (size_t)corners[1];
    const double *c = s->raster.places + 3 * (size_t)corners[2];
    // y points downwards, so counter-clockwise faces appear clockwise here.
    visible.behind = vector2_turn(a, b, c) > 0;
    double mean[3] = {0, 0, 0};
    for (size_t corner = 0; corner < 3; corner++)
    {
        // Faces seen edge-on have coordinates of any size.
        visible.share[corner] = fmin(fmax(visible.share[corner], 0), 1);
        const float *normal = s->surface.normals[3 * (size_t)visible.face + corner];
        for (int i = 0; i < 3; i++)
            mean[i] += visible.share[corner] * normal[i];
    }
    mesh_view_turn(s->task->placing.view, mean, visible.normal);
    for (int i = 0; i < 3; i++)
        visible.normal[i] = visible.behind ? -visible.normal[i] : visible.normal[i];
    visible.normal[2] = fmax(visible.normal[2], 0);
    (void)vector3_normalize(visible.normal);
    return visible;
}

/// A smooth step from 0 at `low` to 1 at `high`.
static double ramp(double low, double high, double x)
{
    double t = fmin(fmax((x - low) / (high - low), 0), 1);
    return t * t * (3 - 2 * t);
}

static draw_colour base_colour(const shading *s, const visible_point *visible)
{
    const shade_task *task = s->task;
    if (task->grey)
        return s->no_value;
    if (task->values == NULL)
        return visible->behind ? s->inside : s->clay;
    const uint32_t *corners = task->mesh->faces + 3 * (size_t)visible->face;
    double value = 0;
    for (int c = 0; c < 3; c++)
        value += visible->share[c] * task->values[task->by_corner ? 3 * (size_t)visible->face + (size_t)c : corners[c]];
    if (isnan(value))
        return s->no_value;
    double share = (value - task->value_low) / (task->value_high - task->value_low);
    return task->scale != NULL ? task->scale(share) : colour_scale_at(share);
}

/// The light at a point: a key light from above the viewer's left shoulder, a soft one from the right, ambient x `open`.
static double illuminate(const double normal[3], double open)
{
    double key = fmax((-0.467 * normal[0] + 0.571 * normal[1] + 0.675 * normal[2] + 0.12) / 1.12, 0);
    double fill = fmax(0.80 * normal[0] + 0.12 * normal[1] + 0.588 * normal[2], 0);
    double sky = 0.5 + 0.5 * normal[1];
    return open * (0.12 + 0.17 * sky) + (0.3 + 0.7 * open) * (0.86 * key + 0.12 * fill);
}

/// The highlight of a glossy surface (Blinn, 1977).
static double shine(const double normal[3])
{
    // half-way between the key light and the eye
    double half = fmax(-0.255 * normal[0] + 0.312 * normal[1] + 0.915 * normal[2], 0), power = half;
    for (int i = 0; i < 5; i++)
        power *= power;
    return 0.07 * power;
}

/// The fraction of a sample that its face's edges cover.
static double cover_edges(const shading *s, const visible_point *visible, double width)
{
    const uint32_t *corners = s->task->mesh->faces + 3 * (size_t)visible->face;
    double nearest = HUGE_VAL;
    const double *at[3];
    for (int c = 0; c < 3; c++)
        at[c] = s->raster.places + 3 * (size_t)corners[c];
    double area = fabs((at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) - (at[1][1] - at[0][1]) * (at[2][0] - at[0][0]));
    for (int c = 0; c < 3; c++)
    {
        int next = (c + 1) % 3, opposite = (c + 2) % 3;
        if (mesh_edge_within_polygon(&s->surface, visible->face, (size_t)c))
            continue;
        double length = hypot(at[next][0] - at[c][0], at[next][1] - at[c][1]);
        nearest = fmin(nearest, visible->share[opposite] * area / fmax(length, 1e-9));
    }
    double half = 0.5 * width * SHADE_SAMPLES;
    return 1 - ramp(half - 0.6, half + 0.6, nearest);
}

/// The opacity of a face's wires, reduced for small faces.
static double wire_opacity(const shading *s, const visible_point *visible)
{
    const uint32_t *corners = s->task->mesh->faces + 3 * (size_t)visible->face;
    double longest = 0;
    for (int c = 0; c < 3; c++)
    {
        const double *a = s->raster.places + 3 * (size_t)corners[c],
                     *b = s->raster.places + 3 * (size_t)corners[(c + 1) % 3];
        longest = fmax(longest, sqrt(pow(b[0] - a[0], 2) + pow(b[1] - a[1], 2) + pow(b[2] - a[2], 2)));
    }
    return WIRE_OPACITY * ramp(WIRE_GONE_AT, WIRE_FADES_FROM, longest / SHADE_SAMPLES);
}

static draw_colour sample_colour(const shading *s, size_t x, size_t y, double open)
{
    const shade_task *task = s->task;
    visible_point visible = visible_at(s, x, y);
    draw_colour base = base_colour(s, &visible);
    bool clay = task->values == NULL && !task->grey;
    double light = illuminate(visible.normal, open), glow = clay && !visible.behind ? shine(visible.normal) : 0;
    light = clay ? light : 0.38 + 0.66 * light;
    draw_colour colour = {base.red * light + glow, base.green * light + glow, base.blue * light + glow};
    if (task->wires)
        colour = style_mix(s->wire, colour, wire_opacity(s, &visible) * cover_edges(s, &visible, task->line));
    return colour;
}

static uint32_t to_byte(double share)
{
    return (uint32_t)(255 * fmin(fmax(share, 0), 1) + 0.5);
}

/// The mean of a pixel's samples, premultiplied by the fraction that shows the mesh.
static uint32_t shade_pixel(const shading *s, size_t column, size_t row)
{
    double open = s->light != NULL ? s->light[row * s->task->columns + column] : 1;
    draw_colour sum = {0, 0, 0};
    int covered = 0;
    for (size_t i = 0; i < SHADE_SAMPLES; i++)
        for (size_t k = 0; k < SHADE_SAMPLES; k++)
        {
            size_t x = column * SHADE_SAMPLES + k, y = row * SHADE_SAMPLES + i;
            size_t sample = y * s->raster.columns + x;
            unsigned char line = s->lines != NULL ? s->lines[sample] : 0;
            if (s->raster.faces[sample] == RASTER_NO_FACE && line != LINE_BOUNDARY)
                continue;
            draw_colour colour = line == LINE_BOUNDARY ? s->boundary : sample_colour(s, x, y, open);
            if (line == LINE_OUTLINE)
                colour = style_mix(s->wire, colour, OUTLINE_OPACITY);
            sum.red += colour.red;
            sum.green += colour.green;
            sum.blue += colour.blue;
            covered++;
        }
    if (covered == 0)
        return 0;
    double alpha = (double)covered / (SHADE_SAMPLES * SHADE_SAMPLES);
    return to_byte(alpha) << 24 | to_byte(alpha * colour_encode(sum.red / covered)) << 16 |
           to_byte(alpha * colour_encode(sum.green / covered)) << 8 | to_byte(alpha * colour_encode(sum.blue / covered));
}

/// The depths and normals at the middle samples of all pixels, for ambient occlusion.
static void sample_middles(const shading *s, float *depths, float (*normals)[3])
{
    const shade_task *task = s->task;
    for (size_t row = 0; row < task->rows; row++)
        for (size_t column = 0; column < task->columns; column++)
        {
            size_t x = column * SHADE_SAMPLES + SHADE_SAMPLES / 2, y = row * SHADE_SAMPLES + SHADE_SAMPLES / 2;
            size_t pixel = row * task->columns + column, sample = y * s->raster.columns + x;
            depths[pixel] = s->raster.depths[sample] / SHADE_SAMPLES;
            if (s->raster.faces[sample] == RASTER_NO_FACE)
                continue;
            visible_point visible = visible_at(s, x, y);
            for (int c = 0; c < 3; c++)
                normals[pixel][c] = (float)visible.normal[c];
        }
}

static bat_status find_occlusion(shading *s, bat_error *error)
{
    const shade_task *task = s->task;
    size_t count = task->columns * task->rows;
    memory_pool pool = {0};
    float *depths = memory_pool_array(&pool, count, sizeof *depths);
    float(*normals)[3] = memory_pool_zeros(&pool, count, sizeof *normals);
    bat_status status = array_make(&s->light, count, sizeof *s->light, error);
    if (status == BAT_OK)
        status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
    {
        sample_middles(s, depths, normals);
        occlusion_picture picture = {.columns = task->columns,
                                     .rows = task->rows,
                                     .depths = depths,
                                     .normals = (const float(*)[3])normals,
                                     .reach = fmax(OCCLUSION_REACH * fmax((double)task->columns, (double)task->rows), 2)};
        status = ambient_occlusion(&picture, task->threads, s->light, error);
    }
    memory_pool_free(&pool);
    return status;
}

/// Draw outlines, then boundaries.
static bat_status draw_lines(shading *s, bat_error *error)
{
    const shade_task *task = s->task;
    const bat_mesh *mesh = task->mesh;
    size_t count = s->raster.columns * s->raster.rows;
    double width = SHADE_SAMPLES * task->line;
    if (array_zeros(&s->lines, count, 1, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t k = 0; k < task->outline_count; k += 2)
        mesh_raster_line(&s->raster, task->outlines[k], task->outlines[k + 1], width, LINE_OUTLINE, s->lines);
    for (size_t h = 0; h < 3 * mesh->face_count && task->boundaries; h++)
        if (mesh_edge_at_boundary(&s->surface, h / 3, h % 3))
            mesh_raster_line(&s->raster, mesh->faces[h], mesh->faces[bat_mesh_next((uint32_t)h)], BOUNDARY_WIDENING * width,
                             LINE_BOUNDARY, s->lines);
    return BAT_OK;
}

bat_status mesh_shade(const shade_task *task, unsigned char *pixels, size_t stride, bat_error *error)
{
    shading s = {.task = task,
                 .clay = linear_colour(CLAY),
                 .inside = linear_colour(INSIDE),
                 .no_value = linear_colour(NO_VALUE),
                 .wire = linear_colour(WIRE),
                 .boundary = linear_colour(BOUNDARY)};
    // the same placement, with more samples than pixels
    mesh_placing placing = task->placing;
    placing.scale *= SHADE_SAMPLES;
    for (int c = 0; c < 2; c++)
        placing.origin[c] *= SHADE_SAMPLES;
    bat_status status = mesh_surface_make(task->mesh, task->polygons, task->flat, task->threads, &s.surface, error);
    if (status == BAT_OK)
        status = mesh_raster_make(task->mesh, &placing, SHADE_SAMPLES * task->columns, SHADE_SAMPLES * task->rows,
                                  task->threads, &s.raster, error);
    if (status == BAT_OK && task->occlusion)
        status = find_occlusion(&s, error);
    if (status == BAT_OK && (task->boundaries || task->outline_count > 0))
        status = draw_lines(&s, error);
    if (status == BAT_OK)
    {
        int threads = threads_for(s.task->threads, s.task->rows / 16 + 1);
#pragma omp parallel for num_threads(threads) schedule(dynamic, 16)
        for (size_t row = 0; row < s.task->rows; row++)
            for (size_t column = 0; column < s.task->columns; column++)
            {
                uint32_t pixel = shade_pixel(&s, column, row);
                memcpy(pixels + row * stride + column * sizeof pixel, &pixel, sizeof pixel);
            }
    }
    memory_pool_free(&s.surface.pool);
    memory_pool_free(&s.raster.pool);
    free(s.light);
    free(s.lines);
    return status;
}
