#include "draw/curve/view.h"
#include "draw/motion/film.h"

#include <stdio.h>

/// @file
/// A strip of poses: a block in the orientation of the body at equal times.

enum
{
    /// Poses of a strip where the options leave it open.
    POSES = 9,
    ROW_POSES = 12 ///< at most in a row
};

/// Half the sides of the block in x, y and z; axes end at 1.
static const double BLOCK[3] = {0.62, 0.40, 0.14};
/// The half width of a cell.
#define CELL_EXTENT 1.12
#define LABEL_SPACE 13.0
#define ROW_GAP 6.0
/// The direction of the light, in those of the page and to the eye.
static const double LIGHT[3] = {-0.35, 0.75, 0.56};

static size_t poses_of(const film *shown)
{
    return shown->poses > 0 ? shown->poses : POSES;
}

static size_t columns_of(const film *shown)
{
    size_t poses = poses_of(shown), rows = (poses + ROW_POSES - 1) / ROW_POSES;
    return (poses + rows - 1) / rows;
}

static size_t rows_of(const film *shown)
{
    return (poses_of(shown) + columns_of(shown) - 1) / columns_of(shown);
}

double strip_height(const film *shown, double width)
{
    double cell = width / (double)columns_of(shown);
    return (double)(rows_of(shown) * shown->count) * (fmin(cell, 110.0) + LABEL_SPACE + ROW_GAP) - ROW_GAP;
}

/// An orientation on the page: the columns are the body's axes to the right, upwards and to the eye.
typedef struct pose_view
{
    double axes[3][3];
    double x, y, scale;
} pose_view;

/// The eye is where that of curves in R^3 is: x to the right and towards it, y to the right and away, z upwards.
static void look_at(const double *quaternion, pose_view *pose)
{
    draw_view view = {.kind = VIEW_FLAT, .space = VIEW_SOLID};
    double matrix[9];
    view_set_solid(&view);
    bat_rotation_to_matrix(quaternion, matrix);
    for (int a = 0; a < 3; a++)
        view_rotate(&view, (double[3]){matrix[a], matrix[3 + a], matrix[6 + a]}, pose->axes[a]);
}

static void move_on(cairo_t *cairo, const pose_view *pose, const double body[3], bool begin)
{
    double x = pose->x, y = pose->y;
    for (int a = 0; a < 3; a++)
    {
        x += pose->scale * body[a] * pose->axes[a][0];
        y -= pose->scale * body[a] * pose->axes[a][1];
    }
    (begin ? cairo_move_to : cairo_line_to)(cairo, x, y);
}

static void draw_axis(cairo_t *cairo, const pose_view *pose, int axis, double from)
{
    double begin[3] = {0}, end[3] = {0};
    begin[axis] = from;
    end[axis] = 1;
    move_on(cairo, pose, begin, true);
    move_on(cairo, pose, end, false);
    style_use_line(cairo, (line_style){film_axis_colour((size_t)axis), 1.6, 0, 0});
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
    cairo_stroke(cairo);
}

/// A face of the block, lighter where it looks to the light. That of x is tinted: the nose.
static void draw_face(cairo_t *cairo, const pose_view *pose, int axis, double side)
{
    static const int corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    const double *normal = pose->axes[axis];
    double light = side * (normal[0] * LIGHT[0] + normal[1] * LIGHT[1] + normal[2] * LIGHT[2]);
    draw_colour base = axis == 0 && side > 0 ? film_axis_colour(0) : COLOUR_CONTROL;
    draw_colour lit = style_mix(COLOUR_BACKGROUND, base, 0.38 + 0.32 * fmax(light, -0.5));
    for (int k = 0; k < 4; k++)
    {
        double p[3];
        p[axis] = side * BLOCK[axis];
        p[b] = corners[k][0] * BLOCK[b];
        p[c] = corners[k][1] * BLOCK[c];
        move_on(cairo, pose, p, k == 0);
    }
    cairo_close_path(cairo);
    style_use_colour(cairo, lit);
    cairo_fill_preserve(cairo);
    style_use_line(cairo, (line_style){COLOUR_BORDER, 0.5, 0, 0});
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_stroke(cairo);
}

/// Axes that point away from the eye are behind the block, the others before it. The block is convex.
static void draw_pose(cairo_t *cairo, const pose_view *pose)
{
    for (int a = 0; a < 3; a++)
        if (pose->axes[a][2] < 0)
            draw_axis(cairo, pose, a, BLOCK[a]);
    for (int a = 0; a < 3; a++)
        draw_face(cairo, pose, a, pose->axes[a][2] > 0 ? 1 : -1);
    for (int a = 0; a < 3; a++)
        if (pose->axes[a][2] >= 0)
            draw_axis(cairo, pose, a, BLOCK[a]);
}

bat_status strip_draw(const film *shown, cairo_t *cairo, const double box[4], bat_error *error)
{
    size_t poses = poses_of(shown), columns = columns_of(shown), rows = rows_of(shown);
    double cell = box[2] / (double)columns, pitch = (box[3] + ROW_GAP) / (double)(rows * shown->count);
    double height = fmax(pitch - ROW_GAP - LABEL_SPACE, 1);
    for (size_t k = 0; k < shown->count; k++)
    {
        const film_track *track = &shown->tracks[k];
        double begin = track->times[0], end = track->times[track->count - 1];
        double step = poses > 1 ? (end - begin) / (double)(poses - 1) : 0;
        int decimals = step > 0 ? (int)fmin(fmax(2 - floor(log10(step)), 0), 9) : 3; // tell poses apart
        for (size_t i = 0; i < poses; i++)
        {
            char text[64];
            double quaternion[4], time = i + 1 < poses ? begin + step * (double)i : poses > 1 ? end : begin;
            bat_status status = film_at(shown, track, time, quaternion, error);
            if (status != BAT_OK)
                return status;
            size_t row = k * rows + i / columns;
            double top = box[1] + (double)row * pitch;
            pose_view pose = {.x = box[0] + ((double)(i % columns) + 0.5) * cell,
                              .y = top + 0.5 * height,
                              .scale = 0.5 * fmin(cell, height) / CELL_EXTENT};
            look_at(quaternion, &pose);
            draw_pose(cairo, &pose);
            bool plain = fabs(time) < 1e6 && step > 1e-7;
            (void)snprintf(text, sizeof text, plain ? "%.*f" : "%.*g", plain ? decimals : 6, time + 0.0);
            style_use_colour(cairo, COLOUR_MUTED);
            text_draw_fitted(cairo, text, TEXT_TICK, false, pose.x, top + height + LABEL_SPACE - 3, cell);
        }
    }
    return BAT_OK;
}
