// A space of one's own: an ellipsoid, whose geodesics have no closed form. The exponential integrates their equation, the
// logarithm shoots, and every scheme for any space works on it. Here it is the Earth (WGS 84), with a distance known to the
// millimetre and a flight through five airports.
//
//     cc ellipsoid.c $(pkg-config --cflags --libs batten) -lm && ./a.out

#include <batten/batten.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
static const double EQUATORIAL_RADIUS = 6378137; // metres; lengths below are in this unit
static const double FLATTENING = 1 / 298.257223563;

// The surface h_0 x^2 + h_1 y^2 + h_2 z^2 = 1; `parameters` of the space points to h. Tangent vectors are vectors of R^3
// orthogonal to the gradient (h_0 x, h_1 y, h_2 z).

static double dot(const double *u, const double *v)
{
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

static double weighted(const double *h, const double *u, const double *v)
{
    return h[0] * u[0] * v[0] + h[1] * u[1] * v[1] + h[2] * u[2] * v[2];
}

static const char *fault(const bat_space *space, const double *point)
{
    double value = weighted(space->parameters, point, point);
    return fabs(value - 1) <= 1e-9 ? NULL : "not on the ellipsoid";
}

// The nearest point is y_i / (1 + lambda h_i) for the root lambda of a convex, falling function; Newton's method comes from
// its left.
static bat_status project(const bat_space *space, const double *coordinates, double *point)
{
    const double *h = space->parameters;
    double y[3], lambda = -INFINITY;
    for (int i = 0; i < 3; i++)
    {
        y[i] = coordinates[i];
        if (y[i] != 0)
            lambda = fmax(lambda, (sqrt(h[i]) * fabs(y[i]) - 1) / h[i]);
    }
    if (!isfinite(lambda))
        return BAT_INVALID_POINT;
    for (int step = 0; step < 50; step++)
    {
        double value = -1, slope = 0;
        for (int i = 0; i < 3; i++)
        {
            double share = 1 / (1 + lambda * h[i]), term = h[i] * y[i] * y[i] * share * share;
            value += term;
            slope -= 2 * term * h[i] * share;
        }
        lambda -= value / slope;
    }
    for (int i = 0; i < 3; i++)
        point[i] = y[i] / (1 + lambda * h[i]);
    return fault(space, point) == NULL ? BAT_OK : BAT_INVALID_POINT;
}

enum
{
    POSITION = 0,
    VELOCITY = 3,
    CARRIED = 6, // a vector in parallel transport
    STATE = 9
};

// x'' = -(<x', H x'> / |g|^2) g with the gradient g = H x, and for a vector in transport u' = -(<u, H x'> / |g|^2) g.
static void rate_of_change(const double *h, const double *state, double *rate)
{
    const double *x = state + POSITION, *v = state + VELOCITY, *u = state + CARRIED;
    double gradient[3] = {h[0] * x[0], h[1] * x[1], h[2] * x[2]};
    double inverse = 1 / dot(gradient, gradient), bend = weighted(h, v, v) * inverse, lag = weighted(h, u, v) * inverse;
    for (int i = 0; i < 3; i++)
    {
        rate[POSITION + i] = v[i];
        rate[VELOCITY + i] = -bend * gradient[i];
        rate[CARRIED + i] = -lag * gradient[i];
    }
}

// Follow the geodesic for unit time by the classical Runge-Kutta method.
static void follow(const double *h, double *state)
{
    int steps = 8 + (int)(160 * sqrt(dot(state + VELOCITY, state + VELOCITY)));
    double dt = 1.0 / steps;
    for (int step = 0; step < steps; step++)
    {
        static const double NODE[4] = {0, 0.5, 0.5, 1}, WEIGHT[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
        double rate[STATE] = {0}, sum[STATE] = {0}, at[STATE];
        for (int stage = 0; stage < 4; stage++)
        {
            for (int i = 0; i < STATE; i++)
                at[i] = state[i] + NODE[stage] * dt * rate[i];
            rate_of_change(h, at, rate);
            for (int i = 0; i < STATE; i++)
                sum[i] += WEIGHT[stage] * rate[i];
        }
        for (int i = 0; i < STATE; i++)
            state[i] += dt * sum[i];
    }
}

static bat_status exponential(const bat_space *space, const double *p, const double *tangent, double *q)
{
    double state[STATE] = {p[0], p[1], p[2], tangent[0], tangent[1], tangent[2]};
    if (!(dot(tangent, tangent) < 1e6))
        return BAT_INVALID_POINT;
    follow(space->parameters, state);
    return project(space, state + POSITION, q);
}

// Two unit tangent vectors at right angles.
static void tangent_frame(const double *h, const double *p, double frame[2][3])
{
    double g[3] = {h[0] * p[0], h[1] * p[1], h[2] * p[2]};
    int least = fabs(g[0]) < fabs(g[1]) ? 0 : 1;
    least = fabs(g[2]) < fabs(g[least]) ? 2 : least;
    double axis[3] = {least == 0, least == 1, least == 2}, share = g[least] / dot(g, g);
    for (int i = 0; i < 3; i++)
        frame[0][i] = axis[i] - share * g[i];
    double length = sqrt(dot(frame[0], frame[0])), norm = sqrt(dot(g, g));
    for (int i = 0; i < 3; i++)
        frame[0][i] /= length;
    for (int i = 0; i < 3; i++)
        frame[1][i] = (g[(i + 1) % 3] * frame[0][(i + 2) % 3] - g[(i + 2) % 3] * frame[0][(i + 1) % 3]) / norm;
}

// Where the velocity c_0 e_0 + c_1 e_1 leads, relative to q, in a frame at q.
static void miss(const double *h, const double *p, const double *q, double e[2][3], double at_q[2][3], const double *c,
                 double *result)
{
    double state[STATE] = {p[0], p[1], p[2]};
    for (int i = 0; i < 3; i++)
        state[VELOCITY + i] = c[0] * e[0][i] + c[1] * e[1][i];
    follow(h, state);
    for (int i = 0; i < 3; i++)
        state[i] -= q[i];
    result[0] = dot(at_q[0], state);
    result[1] = dot(at_q[1], state);
}

// Newton's method on the two coordinates of the velocity, its derivative by differences.
static bat_status logarithm(const bat_space *space, const double *p, const double *q, double *tangent)
{
    const double *h = space->parameters;
    double e[2][3], at_q[2][3], chord[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    tangent_frame(h, p, e);
    tangent_frame(h, q, at_q);
    double c[2] = {dot(e[0], chord), dot(e[1], chord)}, error = INFINITY;
    double size = sqrt(dot(chord, chord)), nudge = 1e-6 * size;
    for (int step = 0; step < 20 && size > 0 && error > 1e-12 * size; step++)
    {
        double off[2], first[2], second[2], ahead[2] = {c[0] + nudge, c[1]}, aside[2] = {c[0], c[1] + nudge};
        miss(h, p, q, e, at_q, c, off);
        miss(h, p, q, e, at_q, ahead, first);
        miss(h, p, q, e, at_q, aside, second);
        double j[4] = {(first[0] - off[0]) / nudge, (second[0] - off[0]) / nudge, (first[1] - off[1]) / nudge,
                       (second[1] - off[1]) / nudge};
        double determinant = j[0] * j[3] - j[1] * j[2];
        c[0] -= (j[3] * off[0] - j[1] * off[1]) / determinant;
        c[1] -= (j[0] * off[1] - j[2] * off[0]) / determinant;
        error = hypot(off[0], off[1]);
    }
    // Within the injectivity radius a geodesic is the shortest; no claim is made beyond.
    if ((size > 0 && !(error <= 1e-10 * size)) || !(hypot(c[0], c[1]) < space->injectivity))
        return BAT_CUT_LOCUS;
    for (int i = 0; i < 3; i++)
        tangent[i] = c[0] * e[0][i] + c[1] * e[1][i];
    return BAT_OK;
}

static double distance(const bat_space *space, const double *p, const double *q)
{
    double tangent[3];
    return logarithm(space, p, q, tangent) == BAT_OK ? sqrt(dot(tangent, tangent)) : NAN;
}

static bat_status transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                            double *transported)
{
    double state[STATE] = {p[0], p[1], p[2]};
    bat_status status = logarithm(space, p, q, state + VELOCITY);
    if (status != BAT_OK)
        return status;
    memcpy(state + CARRIED, tangent, 3 * sizeof *tangent);
    follow(space->parameters, state);
    memcpy(transported, state + CARRIED, 3 * sizeof *transported);
    return BAT_OK;
}

static double inner(const bat_space *space, const double *p, const double *u, const double *v)
{
    (void)space;
    (void)p;
    return dot(u, v);
}

// Normal vectors, brought onto the surface.
static void random_point(const bat_space *space, bat_random *random, double *point)
{
    do
    {
        for (int i = 0; i < 3; i++)
            point[i] = bat_random_normal(random);
    } while (project(space, point, point) != BAT_OK);
}

static bat_space ellipsoid(const double h[3])
{
    // Curvature is largest where the longest axis ends: (a / (b c))^2.
    double longest = 1 / sqrt(fmin(h[0], fmin(h[1], h[2]))), volume = 1 / sqrt(h[0] * h[1] * h[2]);
    return (bat_space){
        .name = "ellipsoid",
        .dimension = 2,
        .point_dim = 3,
        .tangent_dim = 3,
        .injectivity = PI * volume / (longest * longest),
        .parameters = h,
        .fault = fault,
        .project = project,
        .distance = distance,
        .log = logarithm,
        .exp = exponential,
        .transport = transport,
        .inner = inner,
        .random_point = random_point,
    };
}

// Geodetic latitude and longitude in degrees.
static void place(double latitude, double longitude, double *point)
{
    double phi = latitude * PI / 180, lambda = longitude * PI / 180, e2 = FLATTENING * (2 - FLATTENING);
    double normal = 1 / sqrt(1 - e2 * sin(phi) * sin(phi));
    point[0] = normal * cos(phi) * cos(lambda);
    point[1] = normal * cos(phi) * sin(lambda);
    point[2] = normal * (1 - e2) * sin(phi);
}

static const double AIRPORTS[][2] = {{40.6, -73.8}, {51.6, -0.5}, {55.6, 37.3}, {28.6, 77.1}, {1.4, 104.0}};

enum
{
    COUNT = sizeof AIRPORTS / sizeof *AIRPORTS,
    LEVELS = 4
};

static double length_in_metres(const bat_curve *curve)
{
    double sum = 0;
    for (size_t i = 0; i + 1 < curve->count; i++)
        sum += distance(curve->space, curve->points + 3 * i, curve->points + 3 * i + 3);
    return EQUATORIAL_RADIUS * sum;
}

int main(void)
{
    const double polar = 1 - FLATTENING, h[3] = {1, 1, 1 / (polar * polar)};
    const bat_space earth = ellipsoid(h);
    double points[3 * COUNT];
    for (int i = 0; i < COUNT; i++)
        place(AIRPORTS[i][0], AIRPORTS[i][1], points + 3 * i);

    // From New York to London, against the distance published for these coordinates (Karney, GeographicLib).
    const double published = 5551759.400;
    double found = EQUATORIAL_RADIUS * distance(&earth, points, points + 3);
    printf("New York to London %.3f m, published %.3f m\n", found, published);

    // A vector keeps its length and its angle with the way.
    double way[3], arrival[3], moved[3];
    const bat_curve route = {.space = &earth, .points = points, .count = COUNT};
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.levels = LEVELS;
    bat_curve fine = {0};
    bat_error error = {0};
    if (bat_curve_scheme_by_name("log-exp-4", &options.scheme, &error) != BAT_OK ||
        bat_curve_refine(&route, &options, &fine, &error) != BAT_OK)
    {
        fprintf(stderr, "ellipsoid: %s\n", error.text);
        return EXIT_FAILURE;
    }
    bool good = fabs(found - published) < 0.001 && bat_curve_check(&fine, NULL) == BAT_OK;
    good = good && earth.log(&earth, points, points + 3, way) == BAT_OK &&
           earth.log(&earth, points + 3, points, arrival) == BAT_OK &&
           earth.transport(&earth, points, points + 3, way, moved) == BAT_OK;
    for (int i = 0; good && i < 3; i++)
        good = fabs(moved[i] + arrival[i]) < 1e-9;

    double straight = length_in_metres(&route), curved = length_in_metres(&fine);
    printf("%zu airports, %.1f km by geodesics\n%zu points,  %.1f km along a smooth curve through them\n", route.count,
           straight / 1000, fine.count, curved / 1000);
    good = good && curved > straight && curved < 1.05 * straight;
    bat_curve_free(&fine);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
