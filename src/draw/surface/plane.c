#include "draw/surface/scene.h"

#include "draw/common/sheet.h"

/// @file
/// The parameter plane of a fit, with dots at the parameters and the cells of the spline space.

/// The fraction of the area that dots cover, with bounds of their radii in points.
#define COVERAGE 0.42
#define MIN_RADIUS 0.34
#define MAX_RADIUS 1.7

double dot_radius(double area, size_t count, double per_point)
{
    double radius = sqrt(COVERAGE * area / (ANGLE_PI * (double)(count > 0 ? count : 1)));
    return fmin(fmax(radius, MIN_RADIUS * per_point), MAX_RADIUS * per_point);
}

DEFINE_ORDER(compare_dots, image_dot, rank, index)

void dots_sort(image_dot *dots, size_t count)
{
    qsort(dots, count, sizeof *dots, compare_dots);
}

/// Blend a colour over a premultiplied pixel.
static uint32_t blend(uint32_t under, draw_colour colour, double share)
{
    const double over[4] = {colour.blue, colour.green, colour.red, 1};
    uint32_t blended = 0;
    for (int c = 0; c < 4; c++)
    {
        double below = (double)(under >> 8 * c & 255);
        blended |= (uint32_t)lround(below + share * (255 * over[c] - below)) << 8 * c;
    }
    return blended;
}

void dot_draw(const dot_image *image, double x, double y, double radius, draw_colour colour)
{
    double reach = radius + 0.5;
    double left = fmax(floor(x - reach), 0), right = fmin(ceil(x + reach), (double)image->columns);
    double top = fmax(floor(y - reach), 0), bottom = fmin(ceil(y + reach), (double)image->rows);
    for (double row = top; row < bottom; row++)
        for (double column = left; column < right; column++)
        {
            double share = fmin(reach - hypot(column + 0.5 - x, row + 0.5 - y), 1);
            if (share <= 0)
                continue;
            unsigned char *at = image->pixels + (size_t)row * image->stride + 4 * (size_t)column;
            uint32_t pixel;
            memcpy(&pixel, at, sizeof pixel);
            pixel = blend(pixel, colour, share);
            memcpy(at, &pixel, sizeof pixel);
        }
}

/// Margins for the numbers below and to the left, and for half a dot above and to the right.
#define LABEL_ROOM 13.0
#define DOT_ROOM 3.0
#define CELL_WIDTH 0.32

static const draw_colour COLOUR_PARAMETER = {0.36, 0.60, 0.82};

/// Dots at a row's parameters, in an image with a margin around the square.
typedef struct plane_dots
{
    const surface_row *row;
    size_t columns, rows;
    double margin, side, per_point; ///< in pixels
} plane_dots;

static bat_status paint_dots(const void *context, unsigned char *pixels, size_t stride, bat_error *error BAT_UNUSED)
{
    const plane_dots *task = context;
    const bat_cloud *cloud = task->row->panel->cloud;
    dot_image image = {pixels, stride, task->columns, task->rows};
    double radius = dot_radius(0.8 * task->side * task->side, cloud->count, task->per_point);
    for (size_t k = 0; k < cloud->count; k++)
    {
        // The boundary comes first in the cloud and is drawn last.
        size_t i = (k + cloud->boundary_count) % cloud->count;
        const double *parameter = task->row->panel->parameters + 2 * i;
        double x = task->margin + task->side * parameter[0], y = task->margin + task->side * (1 - parameter[1]);
        bool inside = i >= cloud->boundary_count;
        dot_draw(&image, x, y, inside ? radius : BOUNDARY_POINT_GROWTH * radius,
                 inside ? COLOUR_PARAMETER : COLOUR_BOUNDARY_POINT);
    }
    return BAT_OK;
}

/// Draw the left and lower sides of all cells; the square's frame adds the others.
static void draw_cells(const bat_hierarchical_space *space, cairo_t *cairo, const double square[3])
{
    bat_hierarchical_options options = bat_hierarchical_space_options(space);
    for (size_t i = 0; i < bat_hierarchical_space_cells(space); i++)
    {
        bat_spline_box cell = bat_hierarchical_space_cell(space, i);
        double low[2], high[2];
        for (int c = 0; c < 2; c++)
        {
            double cells = ldexp((double)options.spans[c], (int)cell.level);
            low[c] = cell.low[c] / cells;
            high[c] = cell.high[c] / cells;
        }
        double left = square[0] + square[2] * low[0], bottom = square[1] + square[2] * (1 - low[1]);
        cairo_move_to(cairo, left, square[1] + square[2] * (1 - high[1]));
        cairo_line_to(cairo, left, bottom);
        cairo_line_to(cairo, square[0] + square[2] * high[0], bottom);
    }
    style_use_line(cairo, (line_style){.colour = COLOUR_FOREGROUND, .width = CELL_WIDTH});
    cairo_stroke(cairo);
}

static void draw_frame(cairo_t *cairo, const double square[3])
{
    double left = square[0], right = left + square[2], top = square[1], bottom = top + square[2];
    cairo_rectangle(cairo, left, top, square[2], square[2]);
    style_use_line(cairo, (line_style){.colour = COLOUR_FOREGROUND, .width = LINE_FRAME});
    cairo_stroke(cairo);
    text_use(cairo, TEXT_TICK, false);
    style_use_colour(cairo, COLOUR_MUTED);
    const char *const names[2][3] = {{"0", "u", "1"}, {"0", "v", "1"}};
    for (int i = 0; i < 3; i++)
    {
        double share = 0.5 * i;
        text_draw_middle(cairo, names[0][i], left + share * (right - left), bottom + 8.0, share);
        text_draw_middle(cairo, names[1][i], left - 5.0, bottom - 3.0 * (1 - share) - share * (square[2] - 3.0 * share),
                         1.0);
    }
}

bat_status surface_plane_draw(const surface_row *row, cairo_t *cairo, const double box[4], double per_point,
                              bat_error *error)
{
    double room = LABEL_ROOM + DOT_ROOM, side = fmax(fmin(box[2] - 2 * room, box[3] - room), 1);
    const double square[3] = {box[0] + 0.5 * (box[2] - side), box[1] + DOT_ROOM + fmax(0, 0.5 * (box[3] - room - side)),
                              side};
    bat_status status = BAT_OK;
    if (row->panel->cloud != NULL && row->panel->parameters != NULL)
    {
        const double outer[4] = {square[0] - DOT_ROOM, square[1] - DOT_ROOM, square[2] + 2 * DOT_ROOM,
                                 square[2] + 2 * DOT_ROOM};
        pixel_box place = pixel_box_align(cairo, per_point, outer);
        plane_dots task = {row, place.columns, place.rows, DOT_ROOM * per_point, square[2] * per_point, per_point};
        status = pixel_image_draw(cairo, &place, paint_dots, &task, error);
    }
    if (row->panel->surface != NULL)
        draw_cells(row->panel->surface->space, cairo, square);
    draw_frame(cairo, square);
    return status;
}
