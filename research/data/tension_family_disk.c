/// @file
/// Families of closed curves in the Poincaré disk.

#include "research/data/fillet.h"
#include "research/data/tension_family.h"
#include "research/data/wave.h"

/// Curves stay within this hyperbolic radius of the origin: Euclidean 0.947.
static const double MAX_RADIUS = 3.6;

/// Rotate about the origin by a uniform angle.
static void turn(bat_random *random, size_t count, double *points)
{
    double angle = draw_angle(random), cosine = cos(angle), sine = sin(angle);
    for (size_t i = 0; i < count; i++)
    {
        double x = points[2 * i], y = points[2 * i + 1];
        points[2 * i] = cosine * x - sine * y;
        points[2 * i + 1] = sine * x + cosine * y;
    }
}

/// Apply a hyperbolic translation, z -> (z + p) / (1 + conj(p) z), of length at most 1.2 and within MAX_RADIUS.
static void translate(bat_random *random, size_t count, double *points)
{
    double squared = 0;
    for (size_t i = 0; i < count; i++)
        squared = fmax(squared, points[2 * i] * points[2 * i] + points[2 * i + 1] * points[2 * i + 1]);
    double room = MAX_RADIUS - 2 * atanh(sqrt(squared));
    double length = tanh(0.5 * fmin(room, 1.2) * bat_random_uniform(random)), direction = draw_angle(random);
    double p = length * cos(direction), q = length * sin(direction);
    for (size_t i = 0; i < count; i++)
    {
        double x = points[2 * i], y = points[2 * i + 1];
        double real = 1 + p * x + q * y, imaginary = p * y - q * x, scale = 1 / (real * real + imaginary * imaginary);
        points[2 * i] = scale * ((x + p) * real + (y + q) * imaginary);
        points[2 * i + 1] = scale * ((y + q) * real - (x + p) * imaginary);
    }
}

/// Apply a random isometry; a rotation for curves of the published distribution.
static void move(bat_random *random, bool published, size_t count, double *points)
{
    turn(random, count, points);
    if (!published)
        translate(random, count, points);
}

static void fourier(bat_random *random, size_t count, double *points)
{
    bool published = draw_coin(random);
    int terms = draw_whole(random, 2, published ? 4 : 5);
    double decay = published ? 1.5 : draw_between(random, 1.4, 2.2);
    double radius = published ? draw_between(random, 0.50, 0.62) : draw_between(random, 0.3, 0.8);
    fourier_curve(random, terms, decay, radius, count, points);
    move(random, published, count, points);
}

/// Circles; translations move their hyperbolic centres away from the origin.
static void circle(bat_random *random, size_t count, double *points)
{
    bool published = draw_coin(random);
    double radius = published ? draw_between(random, 0.3, 0.7) : draw_between(random, 0.15, 0.8);
    ellipse_curve(0, 0, radius, radius, 0, count, points);
    move(random, published, count, points);
}

static void offset_ellipse(bat_random *random, size_t count, double *points)
{
    bool published = draw_coin(random);
    double a = draw_between(random, published ? 0.35 : 0.2, 0.65), b = draw_between(random, published ? 0.25 : 0.15, 0.5);
    double x = draw_between(random, 0, 0.15), y = draw_between(random, 0, 0.15);
    ellipse_curve(x, y, a, b, 0, count, points);
    move(random, published, count, points);
}

/// The point at hyperbolic distance `length` = |(x, y)| from the origin in the direction (x, y).
static void store_polar(double x, double y, double length, double *point)
{
    double scale = length > 0 ? tanh(length / 2) / length : 0.5;
    point[0] = scale * x;
    point[1] = scale * y;
}

static void blob(bat_random *random, size_t count, double *points)
{
    double size = draw_between(random, 0.4, 1.6);
    harmonics lobes = draw_lobes(random);
    wave t = wave_make(1, 0, count);
    for (size_t i = 0; i < count; i++, wave_step(&t))
    {
        double radius = size * (1 + harmonics_at(&lobes, t.cosine, t.sine));
        store_polar(radius * t.cosine, radius * t.sine, radius, points + 2 * i);
    }
    move(random, draw_coin(random), count, points);
}

/// The trochoid exp(it) + d exp(ikt) in polar coordinates of the hyperbolic plane.
static void polar_trochoid(bat_random *random, size_t count, double *points)
{
    trochoid shape = trochoid_draw(random);
    double size = draw_between(random, 0.5, 1.6) / (1 + shape.share);
    wave once = wave_make(1, 0, count), more = wave_make(shape.frequency, 0, count);
    for (size_t i = 0; i < count; i++, wave_step(&once), wave_step(&more))
    {
        double x = size * (once.cosine + shape.share * more.cosine), y = size * (once.sine + shape.share * more.sine);
        store_polar(x, y, sqrt(x * x + y * y), points + 2 * i);
    }
    move(random, draw_coin(random), count, points);
}

static void filleted_polygon(bat_random *random, size_t count, double *points)
{
    double size = draw_between(random, 0.6, 2.4);
    fillet_polygon polygon = fillet_draw(random, 0.4 * size, size);
    fillet_points(BAT_TENSION_SPACE_DISK, &polygon, count, points);
    move(random, draw_coin(random), count, points);
}

tension_family_list disk_families(bool unseen)
{
    static const tension_family trained[] = {
        {"fourier", fourier},
        {"circle", circle},
        {"offset-ellipse", offset_ellipse},
        {"blob", blob},
    };
    static const tension_family others[] = {
        {"trochoid", polar_trochoid},
        {"filleted-polygon", filleted_polygon},
    };
    return unseen ? (tension_family_list){others, sizeof others / sizeof *others}
                  : (tension_family_list){trained, sizeof trained / sizeof *trained};
}
