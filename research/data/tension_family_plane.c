/// @file
/// Families of closed curves in the plane.

#include "research/data/fillet.h"
#include "research/data/tension_family.h"
#include "research/data/wave.h"

static void ellipse(bat_random *random, size_t count, double *points)
{
    double low = draw_coin(random) ? 0.6 : 0.4;
    double a = draw_between(random, low, 2), b = draw_between(random, low, 2);
    ellipse_curve(0, 0, a, b, 0, count, points);
    centre_and_scale(count, 1, points);
}

static void fourier_low(bat_random *random, size_t count, double *points)
{
    bool published = draw_coin(random);
    int terms = published ? 3 : draw_whole(random, 2, 3);
    fourier_curve(random, terms, published ? 1.5 : draw_between(random, 1.2, 2.2), 1, count, points);
}

static void fourier_high(bat_random *random, size_t count, double *points)
{
    bool published = draw_coin(random);
    int terms = published ? 4 : draw_whole(random, 4, 5);
    fourier_curve(random, terms, published ? 1.5 : draw_between(random, 1.4, 2.2), 1, count, points);
}

/// The superellipse |x / a|^e + |y / b|^e = 1, parameterized by the polar angle before scaling: the published
/// parameterization leaves gaps at the axes.
static void superellipse(bat_random *random, size_t count, double *points)
{
    bool published = draw_coin(random);
    double exponent = published ? draw_between(random, 2, 6) : draw_between(random, 1.7, 7);
    double aspect = published ? 1 : draw_between(random, 0.4, 1);
    wave t = wave_make(1, 0, count);
    for (size_t i = 0; i < count; i++, wave_step(&t))
    {
        double x = fabs(t.cosine), y = fabs(t.sine), larger = fmax(x, y), ratio = fmin(x, y) / larger;
        double power = ratio > 0 ? exp(exponent * log(ratio)) : 0;
        double radius = exp(-log1p(power) / exponent) / larger;
        points[2 * i] = radius * t.cosine;
        points[2 * i + 1] = aspect * radius * t.sine;
    }
    centre_and_scale(count, 1, points);
}

static void blob(bat_random *random, size_t count, double *points)
{
    harmonics lobes = draw_lobes(random);
    wave t = wave_make(1, 0, count);
    for (size_t i = 0; i < count; i++, wave_step(&t))
    {
        double radius = 1 + harmonics_at(&lobes, t.cosine, t.sine);
        points[2 * i] = radius * t.cosine;
        points[2 * i + 1] = radius * t.sine;
    }
    centre_and_scale(count, 1, points);
}

/// The Cassini oval with product p^2 > 1 of the distances from (-1, 0) and (1, 0): one component, with a waist for p <
/// sqrt(2). Then scaled along the y axis.
static void cassini_oval(bat_random *random, size_t count, double *points)
{
    double product = draw_between(random, 1.03, 1.6), stretch = draw_between(random, 0.7, 1.4);
    double fourth = product * product * product * product;
    wave t = wave_make(1, 0, count);
    for (size_t i = 0; i < count; i++, wave_step(&t))
    {
        double cosine = t.cosine * t.cosine - t.sine * t.sine, sine = 2 * t.cosine * t.sine;
        double radius = sqrt(cosine + sqrt(fourth - sine * sine));
        points[2 * i] = radius * t.cosine;
        points[2 * i + 1] = stretch * radius * t.sine;
    }
    centre_and_scale(count, 1, points);
}

/// The inverse 1 / (z - c) of a trochoid z = exp(it) + d exp(ikt), with or without loops, with c outside it. Without the
/// inversion it would be a Fourier curve.
static void inverted_trochoid(bat_random *random, size_t count, double *points)
{
    trochoid shape = trochoid_draw(random);
    double away = (1 + shape.share) * draw_between(random, 1.3, 2.5), direction = draw_angle(random);
    double centre_x = away * cos(direction), centre_y = away * sin(direction);
    wave once = wave_make(1, 0, count), more = wave_make(shape.frequency, 0, count);
    for (size_t i = 0; i < count; i++, wave_step(&once), wave_step(&more))
    {
        double x = once.cosine + shape.share * more.cosine - centre_x, y = once.sine + shape.share * more.sine - centre_y;
        double squared = x * x + y * y;
        points[2 * i] = x / squared;
        points[2 * i + 1] = -y / squared;
    }
    centre_and_scale(count, 1, points);
}

static void filleted_polygon(bat_random *random, size_t count, double *points)
{
    fillet_polygon polygon = fillet_draw(random, 0.4, 1);
    fillet_points(BAT_TENSION_SPACE_PLANE, &polygon, count, points);
    centre_and_scale(count, 1, points);
}

tension_family_list plane_families(bool unseen)
{
    static const tension_family trained[] = {
        {"ellipse", ellipse}, {"fourier-low", fourier_low}, {"fourier-high", fourier_high}, {"superellipse", superellipse},
        {"blob", blob},
    };
    static const tension_family others[] = {
        {"cassini-oval", cassini_oval},
        {"inverted-trochoid", inverted_trochoid},
        {"filleted-polygon", filleted_polygon},
    };
    return unseen ? (tension_family_list){others, sizeof others / sizeof *others}
                  : (tension_family_list){trained, sizeof trained / sizeof *trained};
}
