#include "draw/surface/surface_dots.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Dots cover about this share of where they lie, within these radii in points.
#define COVERAGE 0.42
#define LEAST_RADIUS 0.34
#define MOST_RADIUS 1.7

double dot_radius(double area, size_t count, double per_point)
{
    double radius = sqrt(COVERAGE * area / (3.14159265358979323846 * (double)(count > 0 ? count : 1)));
    return fmin(fmax(radius, LEAST_RADIUS * per_point), MOST_RADIUS * per_point);
}

static int compare_dots(const void *a, const void *b)
{
    const image_dot *x = a, *y = b;
    if (x->rank != y->rank)
        return x->rank < y->rank ? -1 : 1;
    return (x->index > y->index) - (x->index < y->index);
}

void dots_sort(image_dot *dots, size_t count)
{
    qsort(dots, count, sizeof *dots, compare_dots);
}

/// Lay a colour over a premultiplied pixel.
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
