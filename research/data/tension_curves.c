/// @file
/// The curve families of Ugail and Howard (2026), section 6.1, reproduced from the random streams of the published program:
/// ellipses, superellipses and Fourier curves in the plane; Lissajous curves, polar Fourier curves and perturbed great
/// circles on the sphere; Fourier curves, circles and offset ellipses in the disk.

#include "research/data/tension_curves.h"

#include <math.h>

static const double PI = 3.14159265358979323846;
/// Minimum colatitude of polar Fourier curves.
static const double POLE_DISTANCE = 0.1;

/// Offsets of the seeds of the curves' own streams from TENSION_SEED.
enum
{
    PLANE_LOW_STRIDE = 7,   ///< times the curve's number, Fourier curves with 3 terms
    PLANE_HIGH_STRIDE = 13, ///< times the curve's number, Fourier curves with 4 terms
    SPHERE_SEEDS = 1000,    ///< plus the curve's number
    DISK_SEEDS = 2000       ///< plus the curve's number
};

enum
{
    POINTS = BAT_TENSION_TRUTH_POINTS
};

static double parameter(size_t i)
{
    return (double)i * (2 * PI / POINTS);
}

/// A uniform number between low and low + width.
static double draw_between(mersenne *stream, double low, double width)
{
    return low + width * mersenne_uniform(stream);
}

/// A uniform integer from first to first + count - 1.
static unsigned draw_whole(mersenne *stream, unsigned first, unsigned count)
{
    return first + mersenne_below(stream, count);
}

static mersenne own_stream(size_t offset)
{
    return mersenne_seed((uint32_t)(TENSION_SEED + offset));
}

/// Translate points of the plane to mean 0, and scale them to a maximum norm of 1.
static void centre_and_scale(double *points)
{
    double sum_x = 0, sum_y = 0, radius = 0;
    for (size_t i = 0; i < POINTS; i++)
    {
        sum_x += points[2 * i];
        sum_y += points[2 * i + 1];
    }
    for (size_t i = 0; i < POINTS; i++)
    {
        double x = points[2 * i] -= sum_x / POINTS;
        double y = points[2 * i + 1] -= sum_y / POINTS;
        radius = fmax(radius, sqrt(x * x + y * y));
    }
    for (size_t i = 0; i < 2 * POINTS; i++)
        points[i] /= radius;
}

static void scale_to_sphere(double *points)
{
    for (size_t i = 0; i < POINTS; i++)
    {
        double *p = points + 3 * i;
        double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (size_t axis = 0; axis < 3; axis++)
            p[axis] /= length;
    }
}

static void ellipse(double x, double y, double a, double b, double *points)
{
    for (size_t i = 0; i < POINTS; i++)
    {
        double t = parameter(i);
        points[2 * i] = x + a * cos(t);
        points[2 * i + 1] = y + b * sin(t);
    }
}

static void superellipse(double exponent, double *points)
{
    for (size_t i = 0; i < POINTS; i++)
    {
        double t = parameter(i), x = cos(t), y = sin(t);
        points[2 * i] = copysign(pow(fabs(x), 2 / exponent), x);
        points[2 * i + 1] = copysign(pow(fabs(y), 2 / exponent), y);
    }
    centre_and_scale(points);
}

/// Coordinates sum of a cos(k t) + b sin(k t), k = 1 … terms, with a, b normal of standard deviation k^(-3/2).
static void fourier(mersenne stream, unsigned terms, double *points)
{
    for (size_t i = 0; i < 2 * POINTS; i++)
        points[i] = 0;
    for (unsigned k = 1; k <= terms; k++)
    {
        double coefficients[4];
        for (size_t i = 0; i < 4; i++)
            coefficients[i] = mersenne_normal(&stream) / pow(k, 1.5);
        for (size_t i = 0; i < POINTS; i++)
        {
            double c = cos(k * parameter(i)), s = sin(k * parameter(i));
            points[2 * i] += coefficients[0] * c + coefficients[1] * s;
            points[2 * i + 1] += coefficients[2] * c + coefficients[3] * s;
        }
    }
    centre_and_scale(points);
}

static void plane_curve(size_t number, mersenne *stream, double *points)
{
    double a = draw_between(stream, 0.6, 1.4); // drawn for every curve, but used only by ellipses
    double b = draw_between(stream, 0.6, 1.4);
    switch (number % 4)
    {
    case 0:
        ellipse(0, 0, a, b, points);
        centre_and_scale(points);
        break;
    case 1:
        fourier(own_stream(PLANE_LOW_STRIDE * number), 3, points);
        break;
    case 2:
        fourier(own_stream(PLANE_HIGH_STRIDE * number), 4, points);
        break;
    default:
        superellipse(draw_between(stream, 2, 4), points);
    }
}

static void lissajous(unsigned a, unsigned b, double *points)
{
    for (size_t i = 0; i < POINTS; i++)
    {
        double t = parameter(i), *p = points + 3 * i;
        p[0] = cos(a * t);
        p[1] = cos(b * t + PI / 4);
        p[2] = sin(a * t) * sin(b * t);
    }
    scale_to_sphere(points);
}

/// Add terms c_k cos(k t + phase_k) to coordinate `axis`, with c_k normal of standard deviation k^(-decay).
static void add_waves(mersenne *stream, unsigned terms, double decay, size_t axis, double *points)
{
    for (unsigned k = 1; k <= terms; k++)
    {
        double amplitude = mersenne_normal(stream) / pow(k, decay);
        double phase = 2 * PI * mersenne_uniform(stream);
        for (size_t i = 0; i < POINTS; i++)
            points[3 * i + axis] += amplitude * cos(k * parameter(i) + phase);
    }
}

/// Colatitude and longitude are trigonometric sums; the curve does not wind around the axis.
static void polar_fourier(mersenne stream, unsigned terms, double *points)
{
    enum
    {
        COLATITUDE,
        LONGITUDE
    };
    for (size_t i = 0; i < POINTS; i++)
    {
        points[3 * i + COLATITUDE] = PI / 2;
        points[3 * i + LONGITUDE] = 0;
    }
    add_waves(&stream, terms, 1.5, COLATITUDE, points);
    add_waves(&stream, terms, 1.0, LONGITUDE, points);
    for (size_t i = 0; i < POINTS; i++)
    {
        double *p = points + 3 * i;
        double colatitude = fmin(fmax(p[COLATITUDE], POLE_DISTANCE), PI - POLE_DISTANCE), longitude = p[LONGITUDE];
        p[0] = sin(colatitude) * cos(longitude);
        p[1] = sin(colatitude) * sin(longitude);
        p[2] = cos(colatitude);
    }
}

static void perturbed_great_circle(mersenne stream, double *points)
{
    double amplitude = 0.3 * mersenne_uniform(&stream);
    unsigned frequency = draw_whole(&stream, 2, 3);
    double phase = 2 * PI * mersenne_uniform(&stream);
    for (size_t i = 0; i < POINTS; i++)
    {
        double t = parameter(i), *p = points + 3 * i;
        p[0] = cos(t);
        p[1] = sin(t);
        p[2] = amplitude * sin(frequency * t + phase);
    }
    scale_to_sphere(points);
}

static void sphere_curve(size_t number, mersenne *stream, double *points)
{
    switch (number % 3)
    {
    case 0:
    {
        unsigned a = draw_whole(stream, 2, 3), b = draw_whole(stream, 3, 3);
        lissajous(a, b, points);
        break;
    }
    case 1:
        polar_fourier(own_stream(SPHERE_SEEDS + number), draw_whole(stream, 2, 2), points);
        break;
    default:
        perturbed_great_circle(own_stream(SPHERE_SEEDS + number), points);
    }
}

/// The paper clips to radius 0.97, which these parameters never reach.
static void offset_ellipse(mersenne stream, double *points)
{
    double a = draw_between(&stream, 0.35, 0.3), b = draw_between(&stream, 0.25, 0.25);
    double x = 0.15 * mersenne_uniform(&stream), y = 0.15 * mersenne_uniform(&stream);
    ellipse(x, y, a, b, points);
}

static void disk_curve(size_t number, mersenne *stream, double *points)
{
    switch (number % 3)
    {
    case 0:
    {
        unsigned terms = draw_whole(stream, 2, 3);
        double radius = draw_between(stream, 0.50, 0.12);
        fourier(own_stream(DISK_SEEDS + number), terms, points);
        for (size_t i = 0; i < 2 * POINTS; i++)
            points[i] *= radius;
        break;
    }
    case 1:
    {
        double radius = draw_between(stream, 0.30, 0.40);
        ellipse(0, 0, radius, radius, points);
        break;
    }
    default:
        offset_ellipse(own_stream(DISK_SEEDS + number), points);
    }
}

void tension_curve(bat_tension_space space, size_t number, mersenne *stream, double *points)
{
    if (space == BAT_TENSION_SPACE_PLANE)
        plane_curve(number, stream, points);
    else if (space == BAT_TENSION_SPACE_SPHERE)
        sphere_curve(number, stream, points);
    else
        disk_curve(number, stream, points);
}

// Curves with symmetric quarters have vertices at 1/4, 1/2 and 3/4 of their length, up to rounding. In the published arrays,
// the control point there is this vertex or the next one, depending on rounding on the machine that generated them. The
// table records the choice. It was found by comparison with the published arrays and cannot be derived.

enum
{
    QUARTER = BAT_TENSION_CONTROL_POINTS / 4
};

/// One digit for each curve of a space, 100 in a line: the sum of 1, 2 and 4 if the control points at 1/4, 1/2 and 3/4 are
/// the next vertex.
static const char NEXT[BAT_TENSION_SPACE_COUNT][BAT_TENSION_CURVES + 1] = {
    [BAT_TENSION_SPACE_PLANE] =
        "0000700010077000100770000000000730004003200470007000000770003007700770000000700700006000000760076007"
        "0001700010070000000770003000700010007000000760070003100030007007000000070000400770006007700030072007"
        "1007200000073000600700007000000740003007500070067007700000002007700740005007700700077000700700077007"
        "7000000070077000000070077000000770000001700770070000600070070007300770006007000730070000100040000007",
    [BAT_TENSION_SPACE_SPHERE] =
        "0020007000016000020000020006007006047007020070070020007060020007020000000070000006070036077050020070"
        "0760600700200700000370700700000000000200700700200000000000400200000760000700700470000200060500000500"
        "1000007002702000000000007702000004007001000000000607007000003007000007007000000002700002000007003000"
        "6040000036076020000030027006030070000000000020036020030006060007000000000027040000026026070070020070",
    [BAT_TENSION_SPACE_DISK] =
        "0470070600010730000070760030010700070000070000730400000770730070000700000700000030770740170010710770"
        "7700400507707400607406707000507700707007307700707707000700700700407707000700007007307000000204700007"
        "0077002070073030011000004077003001071007000076000000000070000010007077010070073040077072004076001001"
        "0010770760670400730770770010000760730030700010710730040730700010070700700470010030070000000700700030",
};

bool tension_tie_takes_next(bat_tension_space space, size_t number, size_t control)
{
    if (control == 0 || control % QUARTER != 0)
        return false;
    unsigned digit = (unsigned)(NEXT[space][number] - '0');
    return (digit >> (control / QUARTER - 1) & 1) != 0;
}
