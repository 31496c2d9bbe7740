#include "draw/surface/scene.h"

#include "draw/common/sheet.h"

/// @file
/// Panels of a cloud, a shaded surface, and a surface with errors at its points.

/// The assumed fraction of its frame that a cloud fills.
#define FILLED_SHARE 0.65
/// The size of dots for errors, relative to the cloud's, and the width of their light edge in points.
#define ERROR_GROWTH 1.25
#define ERROR_EDGE 0.4
/// A dot is behind another dot in its cell when it is much farther from the eye: by a fraction of the picture, plus what a
/// steep surface descends within a cell. The side of a cell is a multiple of the dots' diameter. The dot fades over another
/// fraction.
#define CELL_DIAMETERS 2.2
#define BEHIND_FROM 0.025
#define BEHIND_FADE 0.065
#define STEEPEST 1.5
#define BEHIND_STRENGTH 0.3
/// A dot is hidden when the surface is nearer to the eye by more than this share of the frame plus the dot's distance.
#define HIDDEN_SHARE 0.02
#define BOUNDARY_LINE 0.34

static const draw_colour COLOUR_NEAR = {0.05, 0.17, 0.35};
static const draw_colour COLOUR_FAR = {0.70, 0.79, 0.88};

typedef struct panel_image
{
    const surface_row *row;
    size_t columns, rows;
    double per_point;
    mesh_placing placing;
    const surface_colours *colours;
    bool grey; ///< the surface
} panel_image;

/// The radius of dots that cover the whole frame.
static double frame_radius(const panel_image *task, size_t count)
{
    const mesh_frame *frame = &task->row->frame;
    double scale = task->placing.scale;
    double area = scale * scale * (frame->high[0] - frame->low[0]) * (frame->high[1] - frame->low[1]);
    return dot_radius(FILLED_SHARE * area, count, task->per_point);
}

/// Compute the positions of the cloud's points in the image, ranked by depth.
static bat_status place_dots(const panel_image *task, image_dot **dots, bat_error *error)
{
    const bat_cloud *cloud = task->row->panel->cloud;
    if (array_make(dots, cloud->count, sizeof **dots, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t i = 0; i < cloud->count; i++)
    {
        double at[3];
        mesh_place_point(&task->placing, cloud->points + 3 * i, at);
        (*dots)[i] = (image_dot){at[0], at[1], at[2], i};
    }
    return BAT_OK;
}

/// The depths of the nearest dots in square cells.
typedef struct depth_cells
{
    double side;
    size_t columns, rows;
    double *nearest;
} depth_cells;

static double *depth_at(const depth_cells *cells, const image_dot *dot)
{
    size_t column = (size_t)fmin(fmax(dot->x / cells->side, 0), (double)(cells->columns - 1));
    size_t row = (size_t)fmin(fmax(dot->y / cells->side, 0), (double)(cells->rows - 1));
    return &cells->nearest[row * cells->columns + column];
}

static bat_status find_depths(const panel_image *task, const image_dot *dots, double radius, depth_cells *cells,
                              bat_error *error)
{
    double side = CELL_DIAMETERS * 2 * radius;
    *cells = (depth_cells){.side = side,
                           .columns = (size_t)((double)task->columns / side) + 1,
                           .rows = (size_t)((double)task->rows / side) + 1};
    size_t count = cells->columns * cells->rows;
    if (array_make(&cells->nearest, count, sizeof *cells->nearest, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t i = 0; i < count; i++)
        cells->nearest[i] = -HUGE_VAL;
    for (size_t i = 0; i < task->row->panel->cloud->count; i++)
    {
        double *nearest = depth_at(cells, &dots[i]);
        *nearest = fmax(*nearest, dots[i].rank);
    }
    return BAT_OK;
}

/// Draw sorted dots: nearer ones darker, those behind others faintly.
static void draw_cloud(const panel_image *task, const image_dot *dots, const depth_cells *cells, double radius,
                       const dot_image *image)
{
    const bat_cloud *cloud = task->row->panel->cloud;
    double farthest = dots[0].rank, depth = fmax(dots[cloud->count - 1].rank - farthest, 1e-300);
    double side = fmax((double)task->columns, (double)task->rows);
    double slack = fmax(BEHIND_FROM * side, STEEPEST * cells->side);
    for (size_t k = 0; k < cloud->count; k++)
    {
        double near = (dots[k].rank - farthest) / depth;
        bool inside = dots[k].index >= cloud->boundary_count;
        double behind = *depth_at(cells, &dots[k]) - dots[k].rank;
        double faded = fmin(fmax((behind - slack) / (BEHIND_FADE * side), 0), 1);
        draw_colour colour = inside ? style_mix(COLOUR_NEAR, COLOUR_FAR, near) : COLOUR_BOUNDARY_POINT;
        colour = style_mix(colour, COLOUR_BACKGROUND, 1 - (1 - BEHIND_STRENGTH) * faded);
        dot_draw(image, dots[k].x, dots[k].y, inside ? radius : BOUNDARY_POINT_GROWTH * radius, colour);
    }
}

static bat_status paint_cloud(const void *context, unsigned char *pixels, size_t stride, bat_error *error)
{
    const panel_image *task = context;
    size_t count = task->row->panel->cloud->count;
    image_dot *dots;
    bat_status status = place_dots(task, &dots, error);
    if (status != BAT_OK)
        return status;
    dots_sort(dots, count);
    dot_image image = {pixels, stride, task->columns, task->rows};
    double radius = frame_radius(task, count);
    depth_cells cells;
    status = find_depths(task, dots, radius, &cells, error);
    if (status == BAT_OK)
        draw_cloud(task, dots, &cells, radius, &image);
    free(cells.nearest);
    free(dots);
    return status;
}

/// Stripes, each 1 wide.
static draw_colour zebra(double share)
{
    double grey = fmod(floor(share), 2) == 0 ? 0.02 : 0.9;
    return (draw_colour){grey, grey, grey};
}

static bat_status paint_patch(const void *context, unsigned char *pixels, size_t stride, bat_error *error)
{
    const panel_image *task = context;
    const bat_surface_inspection *inspection = &task->colours->inspection;
    bool striped = inspection->view == BAT_SURFACE_VIEW_ZEBRA;
    double end = striped ? 1 : task->colours->most_curved;
    shade_task shade = {.mesh = &task->row->patch,
                        .values = task->row->values,
                        .by_corner = task->row->shell != NULL,
                        .outlines = task->row->outlines,
                        .outline_count = task->grey || task->row->values != NULL ? 0 : task->row->outline_count,
                        .grey = task->grey,
                        .value_low = striped ? 0 : -end,
                        .value_high = end,
                        .scale = striped ? zebra : colour_scale_diverging,
                        .occlusion = true,
                        .boundaries = !task->grey,
                        .placing = task->placing,
                        .line = BOUNDARY_LINE * task->per_point,
                        .columns = task->columns,
                        .rows = task->rows};
    return mesh_shade(&shade, pixels, stride, error);
}

/// Whether the surface is in front of a dot.
static bool is_hidden(const panel_image *task, const mesh_raster *raster, const image_dot *dot, double distance)
{
    if (raster->faces == NULL ||
        !(dot->x >= 0 && dot->x < (double)task->columns && dot->y >= 0 && dot->y < (double)task->rows))
        return false;
    size_t sample = (size_t)dot->y * task->columns + (size_t)dot->x;
    double slack = HIDDEN_SHARE * fmax((double)task->columns, (double)task->rows) + task->placing.scale * distance;
    return (double)raster->depths[sample] > dot->rank + slack;
}

/// Draw the dots that are not hidden; the farthest from the surface come last.
static void draw_errors(const panel_image *task, const mesh_raster *raster, image_dot *dots, const dot_image *image)
{
    const double *distances = task->row->distances;
    size_t count = task->row->panel->cloud->count, seen = 0;
    double radius = ERROR_GROWTH * frame_radius(task, count);
    const bat_surface_inspection *inspection = &task->colours->inspection;
    for (size_t i = 0; i < count; i++)
        if (!is_hidden(task, raster, &dots[i], distances[i]))
        {
            dots[seen] = dots[i];
            dots[seen++].rank = distances[i];
        }
    dots_sort(dots, seen);
    for (size_t k = 0; k < seen && raster->faces == NULL; k++)
        dot_draw(image, dots[k].x, dots[k].y, radius + ERROR_EDGE * task->per_point, COLOUR_FRAME);
    for (size_t k = 0; k < seen; k++)
    {
        draw_colour light = colour_scale_at(dots[k].rank / task->colours->highest);
        draw_colour colour = {colour_encode(light.red), colour_encode(light.green), colour_encode(light.blue)};
        const double *distance = task->row->signed_distances;
        if (distance != NULL)
            colour = surface_band_colour(inspection, surface_band_of(inspection, distance[dots[k].index]));
        dot_draw(image, dots[k].x, dots[k].y, radius, colour);
    }
}

static bat_status paint_errors(const void *context, unsigned char *pixels, size_t stride, bat_error *error)
{
    const panel_image *task = context;
    dot_image image = {pixels, stride, task->columns, task->rows};
    image_dot *dots;
    mesh_raster raster = {0};
    bat_status status = place_dots(task, &dots, error);
    if (status == BAT_OK && task->grey)
        status = paint_patch(task, pixels, stride, error);
    if (status == BAT_OK && task->grey)
        status = mesh_raster_make(&task->row->patch, &task->placing, task->columns, task->rows, 0, &raster, error);
    if (status == BAT_OK)
        draw_errors(task, &raster, dots, &image);
    memory_pool_free(&raster.pool);
    free(dots);
    return status;
}

bat_status surface_view_draw(const surface_row *row, surface_panel_kind kind, const surface_colours *colours, cairo_t *cairo,
                             const double box[4], double per_point, bat_error *error)
{
    static pixel_painter *const PAINTS[] = {paint_cloud, paint_patch, paint_errors};
    pixel_box place = pixel_box_align(cairo, per_point, box);
    panel_image task = {.row = row,
                        .columns = place.columns,
                        .rows = place.rows,
                        .per_point = place.per_point,
                        .placing = mesh_frame_place(&row->frame, &row->view, place.columns, place.rows),
                        .colours = colours,
                        .grey = kind == SURFACE_PANEL_ERRORS && row->patch.face_count > 0};
    return pixel_image_draw(cairo, &place, PAINTS[kind], &task, error);
}
