/// @file
/// Families of closed curves on the sphere, before the random rotation.

#include "research/data/fillet.h"
#include "research/data/tension_family.h"
#include "research/data/wave.h"

static const double PI = WAVE_PI;

/// Lissajous curves. Published: (cos a t, cos(b t + pi / 4), sin a t sin b t), projected to the sphere. The others have
/// other phases and scaled coordinates; curves close to the origin are drawn again.
static void lissajous(bat_random *random, size_t count, double *points)
{
    const double nearest = 0.15;
    double minimum;
    do
    {
        bool published = draw_coin(random);
        int a = draw_whole(random, 2, 4), b = draw_whole(random, 3, 5);
        double phase = published ? PI / 4 : draw_angle(random), factors[3] = {1, 1, 1};
        for (int axis = 0; axis < 3 && !published; axis++)
            factors[axis] = draw_between(random, 0.6, 1.4);
        double cosine = cos(phase), sine = sin(phase);
        wave u = wave_make(a, 0, count), v = wave_make(b, 0, count);
        minimum = INFINITY;
        for (size_t i = 0; i < count; i++, wave_step(&u), wave_step(&v))
        {
            double x = factors[0] * u.cosine, y = factors[1] * (v.cosine * cosine - v.sine * sine);
            double z = factors[2] * u.sine * v.sine, length = sqrt(x * x + y * y + z * z);
            minimum = fmin(minimum, length);
            points[3 * i] = x / length;
            points[3 * i + 1] = y / length;
            points[3 * i + 2] = z / length;
        }
    } while (!(minimum > nearest));
}

/// Colatitude and longitude are trigonometric sums. The published distribution clips the colatitude at 0.1; the others have
/// bounded amplitudes.
static void polar_fourier(bat_random *random, size_t count, double *points)
{
    const double pole_distance = 0.1;
    bool published = draw_coin(random);
    int terms = draw_whole(random, 2, published ? 3 : 4);
    harmonics theta = harmonics_draw_phased(random, terms, 1.5), lambda = harmonics_draw_phased(random, terms, 1);
    if (!published)
        harmonics_limit(&theta, PI / 2 - 2 * pole_distance);
    wave t = wave_make(1, 0, count);
    for (size_t i = 0; i < count; i++, wave_step(&t))
    {
        double latitude = -harmonics_at(&theta, t.cosine, t.sine), longitude = harmonics_at(&lambda, t.cosine, t.sine);
        latitude = fmin(fmax(latitude, pole_distance - PI / 2), PI / 2 - pole_distance);
        double radius = cos(latitude);
        points[3 * i] = radius * cos(longitude);
        points[3 * i + 1] = radius * sin(longitude);
        points[3 * i + 2] = sin(latitude);
    }
}

static void perturbed_great_circle(bat_random *random, size_t count, double *points)
{
    bool published = draw_coin(random);
    double amplitude = draw_between(random, 0, published ? 0.3 : 0.4);
    int frequency = draw_whole(random, 2, published ? 4 : 5);
    wave t = wave_make(1, 0, count), height = wave_make(frequency, draw_angle(random), count);
    for (size_t i = 0; i < count; i++, wave_step(&t), wave_step(&height))
    {
        double z = amplitude * height.sine, scale = 1 / sqrt(1 + z * z);
        points[3 * i] = scale * t.cosine;
        points[3 * i + 1] = scale * t.sine;
        points[3 * i + 2] = scale * z;
    }
}

/// The intersection of an elliptic cylinder with the sphere; the semi-axes are sines of angles. Half of the curves are
/// circles.
static void spherical_ellipse(bat_random *random, size_t count, double *points)
{
    double first = draw_between(random, 0.15, 1.5);
    double second = draw_coin(random) ? first : fmax(0.15, first * draw_between(random, 0.4, 1));
    double a = sin(first), b = sin(second);
    wave t = wave_make(1, 0, count);
    for (size_t i = 0; i < count; i++, wave_step(&t))
    {
        double x = a * t.cosine, y = b * t.sine;
        points[3 * i] = x;
        points[3 * i + 1] = y;
        points[3 * i + 2] = sqrt(1 - x * x - y * y);
    }
}

/// The subsatellite point on a circular orbit: `u` is the angle from the ascending node, `turn` the rotation of the planet
/// in one revolution (eq. 24 of the paper with any parameters).
static void ground_point(double inclination, double turn, double u, double *point)
{
    double latitude = asin(sin(inclination) * sin(u));
    double longitude = atan2(cos(inclination) * sin(u), cos(u)) - turn * u / (2 * PI);
    point[0] = cos(latitude) * cos(longitude);
    point[1] = cos(latitude) * sin(longitude);
    point[2] = sin(latitude);
}

/// One revolution, closed by the great-circle arc from its end to its start, nearly equally spaced.
static void ground_track(bat_random *random, size_t count, double *points)
{
    const double day = 1436;
    double inclination = draw_between(random, 20, 85) * (PI / 180), turn = 2 * PI * draw_between(random, 85, 700) / day;
    double start = draw_angle(random), first[3], last[3];
    ground_point(inclination, turn, start, first);
    ground_point(inclination, turn, start + 2 * PI, last);
    double gap = acos(first[0] * last[0] + first[1] * last[1] + first[2] * last[2]);
    size_t arc = (size_t)((double)count * gap / (gap + 2 * PI)), orbit = count - arc;
    for (size_t i = 0; i < orbit; i++)
        ground_point(inclination, turn, start + 2 * PI * (double)i / (double)orbit, points + 3 * i);
    for (size_t i = 0; i < arc; i++)
    {
        double share = (double)i / (double)arc;
        double p = sin((1 - share) * gap) / sin(gap), q = sin(share * gap) / sin(gap);
        for (size_t axis = 0; axis < 3; axis++)
            points[3 * (orbit + i) + axis] = p * last[axis] + q * first[axis];
    }
}

/// The path of a point of a cone that rolls on another cone with the same apex: R_z(t) R_x(tilt) R_z(k t) q, with q at
/// `colatitude` from the axis.
typedef struct cone_roll
{
    int frequency;
    double tilt, colatitude;
} cone_roll;

/// Half of the curves circle a pole with epicycles, like a plane trochoid. The others resemble the seam of a tennis ball,
/// which has frequency -2 and colatitude pi / 2.
static cone_roll roll_draw(bat_random *random)
{
    double tilt = draw_between(random, 0.4, 1.3);
    if (draw_coin(random))
        return (cone_roll){-2, tilt, draw_between(random, 0.7, PI / 2)};
    trochoid shape = trochoid_draw(random);
    return (cone_roll){shape.frequency - 1, tilt, asin(shape.share * sin(tilt))};
}

static void rolling_cone(bat_random *random, size_t count, double *points)
{
    cone_roll roll = roll_draw(random);
    double radius = sin(roll.colatitude), z = cos(roll.colatitude), cosine = cos(roll.tilt), sine = sin(roll.tilt);
    wave once = wave_make(1, 0, count), more = wave_make(roll.frequency, 0, count);
    for (size_t i = 0; i < count; i++, wave_step(&once), wave_step(&more))
    {
        double x = radius * more.cosine, y = radius * more.sine, tilted = cosine * y - sine * z;
        points[3 * i] = once.cosine * x - once.sine * tilted;
        points[3 * i + 1] = once.sine * x + once.cosine * tilted;
        points[3 * i + 2] = sine * y + cosine * z;
    }
}

static void filleted_polygon(bat_random *random, size_t count, double *points)
{
    double size = draw_between(random, 0.4, 1.2);
    fillet_polygon polygon = fillet_draw(random, 0.4 * size, size);
    fillet_points(BAT_TENSION_SPACE_SPHERE, &polygon, count, points);
}

tension_family_list sphere_families(bool unseen)
{
    static const tension_family trained[] = {
        {"lissajous", lissajous},
        {"polar-fourier", polar_fourier},
        {"perturbed-great-circle", perturbed_great_circle},
        {"spherical-ellipse", spherical_ellipse},
    };
    static const tension_family others[] = {
        {"ground-track", ground_track},
        {"trochoid", rolling_cone},
        {"filleted-polygon", filleted_polygon},
    };
    return unseen ? (tension_family_list){others, sizeof others / sizeof *others}
                  : (tension_family_list){trained, sizeof trained / sizeof *trained};
}
