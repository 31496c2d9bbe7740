#include "draw/curve/scene.h"

/// @file
/// The tiling {5, 4} of the hyperbolic plane: regular right-angled pentagons, four at each vertex (Coxeter, 1957).
///
/// Its edges lie on complete geodesics, the images of one pentagon's sides under reflections in these sides. A geodesic is
/// given by its unit normal n = (x, y, t) in Minkowski space, x x' + y y' - t t' = 1 with t > 0. In the disk it is an arc
/// with centre (x, y) / t and radius 1 / t.

#define SIDES 5
#define MAX_GEODESICS 2048
#define SMALLEST_RADIUS 0.045

typedef struct geodesic
{
    double x, y, t;
} geodesic;

typedef struct tiling
{
    geodesic geodesics[MAX_GEODESICS];
    int count;
} tiling;

/// The reflection g - 2 <g, m> m of a geodesic g in the geodesic m, with t > 0.
static geodesic reflect(geodesic g, geodesic mirror)
{
    double twice = 2.0 * (g.x * mirror.x + g.y * mirror.y - g.t * mirror.t);
    geodesic image = {g.x - twice * mirror.x, g.y - twice * mirror.y, g.t - twice * mirror.t};
    double sign = image.t < 0.0 ? -1.0 : 1.0;
    return (geodesic){sign * image.x, sign * image.y, sign * image.t};
}

static bool is_new(const tiling *made, geodesic g)
{
    for (int i = 0; i < made->count; i++)
    {
        const geodesic *known = &made->geodesics[i];
        if (fabs(known->x - g.x) + fabs(known->y - g.y) + fabs(known->t - g.t) < 1e-6 * (1.0 + g.t))
            return false;
    }
    return true;
}

/// Find all geodesics of the tiling whose arcs have at least the smallest radius, from the centre outwards.
static void make_tiling(tiling *made)
{
    double middle = acosh(cos(ANGLE_TURN / 8.0) /
                          sin(ANGLE_TURN / (2.0 * SIDES))); // the distance from the pentagon's centre to its sides
    made->count = SIDES;
    for (int i = 0; i < SIDES; i++)
    {
        double angle = ANGLE_TURN * (0.25 + (double)i / SIDES);
        made->geodesics[i] = (geodesic){cosh(middle) * cos(angle), cosh(middle) * sin(angle), sinh(middle)};
    }
    for (int i = 0; i < made->count; i++)
        for (int side = 0; side < SIDES && made->count < MAX_GEODESICS; side++)
        {
            geodesic image = reflect(made->geodesics[i], made->geodesics[side]);
            if (image.t * SMALLEST_RADIUS <= 1.0 && is_new(made, image))
                made->geodesics[made->count++] = image;
        }
}

/// Append the arc inside the disk to the path. Seen from its centre (x, y) / t, its ends are at angles of tangent t.
static void add_arc(cairo_t *cairo, const draw_view *view, geodesic g)
{
    double facing = atan2(g.y, -g.x); // towards the origin, on the page, where y points down
    double half = atan(g.t);
    double radius = view->scale / g.t;
    cairo_new_sub_path(cairo);
    cairo_arc(cairo, view_x(view, g.x / g.t), view_y(view, g.y / g.t), radius, facing - half, facing + half);
}

void grid_disk(cairo_t *cairo, const draw_view *view, bool lines)
{
    cairo_arc(cairo, view->origin_x, view->origin_y, view->scale, 0.0, ANGLE_TURN);
    cairo_set_source_rgb(cairo, 0.982, 0.986, 0.991);
    cairo_fill(cairo);
    if (!lines)
        return;
    tiling made;
    make_tiling(&made);
    for (int i = 0; i < made.count; i++)
        add_arc(cairo, view, made.geodesics[i]);
    style_use_line(cairo, (line_style){COLOUR_GRID, LINE_GRID, 0.0, 0.0});
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_BUTT);
    cairo_stroke(cairo);
}

void grid_disk_circle(cairo_t *cairo, const draw_view *view)
{
    cairo_arc(cairo, view->origin_x, view->origin_y, view->scale, 0.0, ANGLE_TURN);
    style_stroke(cairo, (line_style){COLOUR_FRAME, 1.2 * LINE_FRAME, 0.0, 0.0});
}
