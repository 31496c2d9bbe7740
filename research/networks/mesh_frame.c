#include "research/networks/mesh_frame.h"
#include "research/learn/functions.h"

/// @file
/// The derivative of a unit vector u = v / |v| is (I - u u^T) / |v|. All loops run over half-flaps and are vectorized.

/// A face has a normal when the squared sine of its angle is above MIN_AREA. Two unit normals have a mean when the square of
/// their sum is above MIN_NORMAL.
static const real MIN_AREA = (real)1e-10;
static const real MIN_NORMAL = (real)1e-6;

typedef struct vector
{
    real x, y, z;
} vector;

static inline vector at(const real *numbers, size_t count, size_t i)
{
    return (vector){numbers[i], numbers[count + i], numbers[2 * count + i]};
}

static inline void put(real *numbers, size_t count, size_t i, vector v)
{
    numbers[i] = v.x;
    numbers[count + i] = v.y;
    numbers[2 * count + i] = v.z;
}

static inline void add_to(real *numbers, size_t count, size_t i, vector v)
{
    numbers[i] += v.x;
    numbers[count + i] += v.y;
    numbers[2 * count + i] += v.z;
}

static inline vector add(vector a, vector b)
{
    return (vector){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline vector subtract(vector a, vector b)
{
    return (vector){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline vector scale(real s, vector a)
{
    return (vector){s * a.x, s * a.y, s * a.z};
}

static inline real dot(vector a, vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline vector cross(vector a, vector b)
{
    return (vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The gradient with respect to v of a unit vector u = rate v.
static inline vector unit_back(vector u, real rate, vector gradient)
{
    return scale(rate, subtract(gradient, scale(dot(u, gradient), u)));
}

/// 1 / sqrt(squares), or 0 where `squares` is not above `min`.
static inline real inverse_root(real squares, real min)
{
    bool enough = squares > min;
    real root = real_sqrt(enough ? squares : 1);
    return enough ? 1 / root : 0;
}

/// The frame of a half-flap with its intermediate results.
typedef struct steps
{
    vector j, k, l;                             ///< edges
    vector left, right;                         ///< unit normals of both faces
    vector x, y, z;                             ///< the frame
    real j_rate, left_rate, right_rate, z_rate; ///< the factor from a vector to its unit vector
} steps;

static inline steps compute_frame(const real *edges, size_t count, size_t i)
{
    steps s = {.j = at(edges, count, i), .k = at(edges + 3 * count, count, i), .l = at(edges + 6 * count, count, i)};
    real jj = dot(s.j, s.j);
    vector left = cross(s.j, s.k), right = cross(s.l, s.j);
    s.j_rate = inverse_root(jj, 0);
    s.left_rate = inverse_root(dot(left, left), MIN_AREA * jj * dot(s.k, s.k));
    s.right_rate = inverse_root(dot(right, right), MIN_AREA * jj * dot(s.l, s.l));
    s.left = scale(s.left_rate, left);
    s.right = scale(s.right_rate, right);
    vector both = add(s.left, s.right);
    s.z_rate = inverse_root(dot(both, both), MIN_NORMAL);
    s.z = scale(s.z_rate, both);
    s.j_rate = s.z_rate > 0 ? s.j_rate : 0;
    s.x = scale(s.j_rate, s.j);
    s.y = cross(s.z, s.x);
    return s;
}

/// The root mean square of the five edge lengths.
static inline real length_of(vector j, vector k, vector l)
{
    vector jk = subtract(k, j), jl = subtract(l, j);
    real squares = (dot(j, j) + dot(k, k) + dot(l, l) + dot(jk, jk) + dot(jl, jl)) / 5;
    return squares > 0 ? real_sqrt(squares) : 1;
}

LANES_CLONES
static void frames(size_t count, const real *restrict edges, real *restrict frame)
{
#pragma omp simd
    for (size_t i = 0; i < count; i++)
    {
        steps s = compute_frame(edges, count, i);
        put(frame, count, i, s.x);
        put(frame + 3 * count, count, i, s.y);
        put(frame + 6 * count, count, i, s.z);
    }
}

LANES_CLONES
static void frames_back(size_t count, const real *restrict edges, const real *restrict gradient,
                        real *restrict edge_gradient)
{
#pragma omp simd
    for (size_t i = 0; i < count; i++)
    {
        steps s = compute_frame(edges, count, i);
        vector dx = at(gradient, count, i), dy = at(gradient + 3 * count, count, i), dz = at(gradient + 6 * count, count, i);
        dz = add(dz, cross(s.x, dy));
        dx = add(dx, cross(dy, s.z));
        vector both = unit_back(s.z, s.z_rate, dz);
        vector left = unit_back(s.left, s.left_rate, both), right = unit_back(s.right, s.right_rate, both);
        vector j = unit_back(s.x, s.j_rate, dx);
        j = add(j, add(cross(s.k, left), cross(right, s.l)));
        add_to(edge_gradient, count, i, j);
        add_to(edge_gradient + 3 * count, count, i, cross(left, s.j));
        add_to(edge_gradient + 6 * count, count, i, cross(s.j, right));
    }
}

LANES_CLONES
static void lengths(size_t count, const real *restrict edges, real *restrict unit)
{
#pragma omp simd
    for (size_t i = 0; i < count; i++)
        unit[i] = length_of(at(edges, count, i), at(edges + 3 * count, count, i), at(edges + 6 * count, count, i));
}

LANES_CLONES
static void lengths_back(size_t count, const real *restrict edges, const real *restrict gradient,
                         real *restrict edge_gradient)
{
#pragma omp simd
    for (size_t i = 0; i < count; i++)
    {
        vector j = at(edges, count, i), k = at(edges + 3 * count, count, i), l = at(edges + 6 * count, count, i);
        real slope = gradient[i] / (5 * length_of(j, k, l));
        add_to(edge_gradient, count, i, scale(slope, subtract(subtract(scale(3, j), k), l)));
        add_to(edge_gradient + 3 * count, count, i, scale(slope, subtract(scale(2, k), j)));
        add_to(edge_gradient + 6 * count, count, i, scale(slope, subtract(scale(2, l), j)));
    }
}

void flap_frames(flap_frame_options options, size_t count, const real *edges, real *frame)
{
    for (size_t a = 0; a < 9 && options.fixed; a++)
        for (size_t i = 0; i < count; i++)
            frame[a * count + i] = a % 4 == 0 ? 1 : 0;
    if (!options.fixed)
        frames(count, edges, frame);
    if (options.relative)
        lengths(count, edges, frame + FLAP_UNIT * count);
    else
        for (size_t i = 0; i < count; i++)
            frame[FLAP_UNIT * count + i] = 1;
}

void flap_frames_back(flap_frame_options options, size_t count, const real *edges, const real *frame_gradient,
                      real *edge_gradient)
{
    if (!options.fixed)
        frames_back(count, edges, frame_gradient, edge_gradient);
    if (options.relative)
        lengths_back(count, edges, frame_gradient + FLAP_UNIT * count, edge_gradient);
}

LANES_CLONES
static void turn(size_t count, const real *restrict frame, const real *restrict vectors, real *restrict result)
{
#pragma omp simd
    for (size_t i = 0; i < count; i++)
    {
        vector v = scale(1 / frame[FLAP_UNIT * count + i], at(vectors, count, i));
        vector in_frame = {dot(at(frame, count, i), v), dot(at(frame + 3 * count, count, i), v),
                           dot(at(frame + 6 * count, count, i), v)};
        put(result, count, i, in_frame);
    }
}

LANES_CLONES
static void turn_back(size_t count, const real *restrict frame, const real *restrict vectors, real *restrict frame_gradient,
                      real *restrict gradient)
{
#pragma omp simd
    for (size_t i = 0; i < count; i++)
    {
        vector x = at(frame, count, i), y = at(frame + 3 * count, count, i), z = at(frame + 6 * count, count, i);
        real rate = 1 / frame[FLAP_UNIT * count + i];
        vector v = scale(rate, at(vectors, count, i)), g = at(gradient, count, i);
        add_to(frame_gradient, count, i, scale(g.x, v));
        add_to(frame_gradient + 3 * count, count, i, scale(g.y, v));
        add_to(frame_gradient + 6 * count, count, i, scale(g.z, v));
        vector back = add(add(scale(g.x, x), scale(g.y, y)), scale(g.z, z));
        frame_gradient[FLAP_UNIT * count + i] -= rate * dot(back, v);
        put(gradient, count, i, scale(rate, back));
    }
}

void flap_turn(size_t count, const real *frame, const real *vectors, real *result)
{
    turn(count, frame, vectors, result);
}

void flap_turn_back(size_t count, const real *frame, const real *vectors, real *frame_gradient, real *gradient)
{
    turn_back(count, frame, vectors, frame_gradient, gradient);
}
