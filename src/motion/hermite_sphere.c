#include "motion/hermite_average.h"

#include "base/lanes.h"
#include "space/builtin.h"

enum
{
    /// The number of pairs averaged at a time.
    BLOCK = 64,
    /// Coordinates of the largest sphere, that of unit quaternions.
    MAX_DIM = 4
};

/// The maximum squared argument that the polynomials of lanes.h are used for.
static const double SQUARED_PI = 9.8696044010893586188;
/// Edges shorter than this are left to the general code: their squares lose digits to underflow.
static const double MIN_SQUARED_CHORD = 1e-200;
/// Arcs whose points are nearly antipodal are left to it too: their midpoints multiply rounding by up to 10 below this.
static const double MIN_SQUARED_SUM = 1e-2;
/// Where antipodes are one point, so are arcs of nearly a quarter: the cosine's sign decides which arc is the shortest.
static const double MIN_COSINE = 1e-12;

/// The kind of unit sphere. It is a compile-time constant in each caller, so that loops over coordinates are unrolled.
typedef struct sphere_kind
{
    int dim;         ///< of the space around the sphere
    bool projective; ///< antipodes are the same point
} sphere_kind;

static const sphere_kind ROUND = {3, false};
static const sphere_kind QUATERNIONS = {4, true};

/// Pairs of neighbours, coordinate by coordinate: rows i and i + 1 of the first two arrays make row i of the last two.
typedef struct sphere_block
{
    double point[MAX_DIM][BLOCK + 1], direction[MAX_DIM][BLOCK + 1];
    double new_point[MAX_DIM][BLOCK], new_direction[MAX_DIM][BLOCK];
    double is_easy[BLOCK]; ///< 0 where the general code must compute the pair
} sphere_block;

/// Functions that must be inlined for the loops over pairs to become vector code.
#define LANE static inline __attribute__((always_inline))

LANE double dot(sphere_kind s, const double *u, const double *v)
{
    double sum = u[0] * v[0];
    for (int c = 1; c < s.dim; c++)
        sum += u[c] * v[c];
    return sum;
}

LANE double squared_length(sphere_kind s, const double *u)
{
    return dot(s, u, u);
}

/// u + factor v
LANE void add(sphere_kind s, const double *u, const double *v, double factor, double *sum)
{
    for (int c = 0; c < s.dim; c++)
        sum[c] = u[c] + factor * v[c];
}

/// The sign that brings q to the side of p where antipodes are the same point.
LANE double side(sphere_kind s, const double *p, const double *q)
{
    return s.projective && dot(s, p, q) < 0 ? -1 : 1;
}

/// The midpoint of the shortest arc between two points: their sum, brought to unit length. Returns whether it is accurate.
LANE bool midpoint(sphere_kind s, const double *p, const double *q, double *middle)
{
    double cosine = s.projective ? dot(s, p, q) : 1;
    add(s, p, q, cosine < 0 ? -1 : 1, middle);
    double squared = squared_length(s, middle), inverse = 1 / sqrt(squared);
    for (int c = 0; c < s.dim; c++)
        middle[c] *= inverse;
    return (squared > MIN_SQUARED_SUM) & (cosine * cosine > MIN_COSINE * MIN_COSINE);
}

/// The squares of twice the sine and twice the cosine of half the angle between two unit vectors.
LANE void half_angle(sphere_kind s, const double *u, const double *v, double *squared_sine, double *squared_cosine)
{
    double difference[MAX_DIM] = {0}, sum[MAX_DIM] = {0};
    add(s, u, v, -1, difference);
    add(s, u, v, 1, sum);
    *squared_sine = squared_length(s, difference);
    *squared_cosine = squared_length(s, sum);
}

/// alpha of eq. (3.6) for two points with directions, and whether it is accurate. The geodesic's directions at its ends are
/// the parts of the chord orthogonal to them; the chord to the antipode has the same parts, and loses less where it is
/// shorter.
LANE double reach(sphere_kind s, const double *p, const double *v, const double *q, const double *w, bool *is_easy)
{
    const double min_cosine = -0.99875026039496624656; // cos(BAT_HERMITE_ANGLE_LIMIT / 2)
    double difference[MAX_DIM] = {0}, sum[MAX_DIM] = {0}, at_p[MAX_DIM] = {0}, at_q[MAX_DIM] = {0};
    add(s, q, p, -1, difference);
    add(s, q, p, 1, sum);
    double squared_difference = squared_length(s, difference), squared_sum = squared_length(s, sum);
    double root_difference = sqrt(squared_difference), root_sum = sqrt(squared_sum);
    double twice_sine = root_difference * root_sum; // of the edge's length
    bool near = squared_difference < squared_sum;
    double inverse = 2 / (twice_sine > 0 ? twice_sine : 1);
    double along = 0.5 * (near ? squared_difference : squared_sum);
    for (int c = 0; c < s.dim; c++)
    {
        double chord = near ? difference[c] : sum[c];
        at_p[c] = inverse * (chord + (near ? along : -along) * p[c]);
        at_q[c] = inverse * ((near ? chord : -chord) + (near ? -along : along) * q[c]);
    }
    double sine[2], cosine[2];
    half_angle(s, v, at_p, &sine[0], &cosine[0]);
    half_angle(s, w, at_q, &sine[1], &cosine[1]);
    double half_turn_cosine = 0.25 * (sqrt(cosine[0] * cosine[1]) - sqrt(sine[0] * sine[1]));
    double length = 2 * lane_atan2(root_difference, root_sum);
    double result = 2 * length / (3 * (1 + half_turn_cosine));
    *is_easy = (squared_difference > MIN_SQUARED_CHORD) & (squared_sum > SPHERE_ANTIPODAL_SQUARED_LENGTH) &
               (half_turn_cosine >= min_cosine) & (result * result < SQUARED_PI);
    return result;
}

/// The average at 1/2 of one pair. Returns whether it is accurate.
LANE bool average(sphere_kind s, const double *p, const double *v, const double *q, const double *w, double *point,
                  double *direction)
{
    bool is_easy;
    double inner[2][MAX_DIM] = {{0}}, first[3][MAX_DIM] = {{0}}, second[2][MAX_DIM] = {{0}}, sum[MAX_DIM] = {0},
           difference[MAX_DIM] = {0};
    double alpha = reach(s, p, v, q, w, &is_easy);
    is_easy &= !s.projective | (dot(s, p, q) > MIN_COSINE);
    double cosine = lane_cos_root(alpha * alpha), sine = alpha * lane_sinc_root(alpha * alpha);
    for (int c = 0; c < s.dim; c++)
    {
        inner[0][c] = cosine * p[c] + sine * v[c];
        inner[1][c] = cosine * q[c] - sine * w[c];
    }
    is_easy &= midpoint(s, p, inner[0], first[0]);
    is_easy &= midpoint(s, inner[0], inner[1], first[1]);
    is_easy &= midpoint(s, inner[1], q, first[2]);
    is_easy &= midpoint(s, first[0], first[1], second[0]);
    is_easy &= midpoint(s, first[1], first[2], second[1]);
    double last_cosine = s.projective ? dot(s, second[0], second[1]) : 1, sign = last_cosine < 0 ? -1 : 1;
    for (int c = 0; c < s.dim; c++)
    {
        sum[c] = sign * second[1][c] + second[0][c];
        difference[c] = sign * second[1][c] - second[0][c];
    }
    double squared_sum = squared_length(s, sum), squared_difference = squared_length(s, difference);
    // Rounding of the two lengths leaves the difference not quite orthogonal to the sum.
    add(s, difference, sum, -dot(s, difference, sum) / squared_sum, difference);
    double inverse_sum = 1 / sqrt(squared_sum), inverse_difference = 1 / sqrt(squared_length(s, difference));
    for (int c = 0; c < s.dim; c++)
    {
        point[c] = sum[c] * inverse_sum;
        direction[c] = difference[c] * inverse_difference;
    }
    return is_easy & (squared_sum > MIN_SQUARED_SUM) & (last_cosine * last_cosine > MIN_COSINE * MIN_COSINE) &
           (squared_difference > MIN_SQUARED_CHORD);
}

LANE void average_pairs(sphere_kind s, sphere_block *block, size_t count)
{
    for (size_t i = 0; i < count; i++)
    {
        double p[MAX_DIM] = {0}, v[MAX_DIM] = {0}, q[MAX_DIM] = {0}, w[MAX_DIM] = {0}, point[MAX_DIM] = {0},
               direction[MAX_DIM] = {0};
        for (int c = 0; c < s.dim; c++)
        {
            p[c] = block->point[c][i];
            v[c] = block->direction[c][i];
            q[c] = block->point[c][i + 1];
            w[c] = block->direction[c][i + 1];
        }
        double sign = side(s, p, q);
        for (int c = 0; c < s.dim && s.projective; c++)
        {
            q[c] *= sign;
            w[c] *= sign;
        }
        block->is_easy[i] = average(s, p, v, q, w, point, direction) ? 1 : 0;
        for (int c = 0; c < s.dim; c++)
        {
            block->new_point[c][i] = point[c];
            block->new_direction[c][i] = direction[c];
        }
    }
}

LANES_CLONES
static void average_round(sphere_block *block, size_t count)
{
    average_pairs(ROUND, block, count);
}

LANES_CLONES
static void average_quaternions(sphere_block *block, size_t count)
{
    average_pairs(QUATERNIONS, block, count);
}

/// The product of quaternions (w, x, y, z).
LANE void product_of(const double *p, const double *q, double *product)
{
    product[0] = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3];
    product[1] = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2];
    product[2] = p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3];
    product[3] = p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1];
}

/// The direction v of a rotation is in body coordinates; on the sphere of quaternions it is q (0, v), of the same length.
LANE void load_row(sphere_kind s, sphere_block *block, const double *row, size_t i)
{
    double moved[MAX_DIM] = {0};
    if (s.projective)
    {
        double turning[4] = {0, row[4], row[5], row[6]};
        product_of(row, turning, moved);
    }
    for (int c = 0; c < s.dim; c++)
    {
        block->point[c][i] = row[c];
        block->direction[c][i] = s.projective ? moved[c] : row[s.dim + c];
    }
}

LANE void store_row(sphere_kind s, const sphere_block *block, size_t i, double *row)
{
    double point[MAX_DIM] = {0}, moved[MAX_DIM] = {0}, turning[4] = {0};
    for (int c = 0; c < s.dim; c++)
    {
        row[c] = point[c] = block->new_point[c][i];
        moved[c] = block->new_direction[c][i];
    }
    if (s.projective)
    {
        double back[4] = {point[0], -point[1], -point[2], -point[3]};
        product_of(back, moved, turning);
    }
    for (int c = 0; c < 3; c++)
        row[s.dim + c] = s.projective ? turning[c + 1] : moved[c];
}

/// Rows in increasing order, so that averages may overwrite the rows they are made of.
LANE bat_status finish_rows(sphere_kind s, const refine_kernel *kernel, const sphere_block *block, const double *rows,
                            size_t count, double *averages, size_t stride, size_t *fault)
{
    size_t time = (size_t)s.dim + 3;
    for (size_t i = 0; i < count; i++)
    {
        const double *row = rows + i * kernel->dim, *next = row + kernel->dim;
        double *average_row = averages + i * stride;
        if (block->is_easy[i] == 0)
        {
            bat_status status = hermite_average_row(kernel, row, next, average_row);
            if (status != BAT_OK)
            {
                *fault = i;
                return status;
            }
            continue;
        }
        if (kernel->dim > time)
            average_row[time] = 0.5 * (row[time] + next[time]);
        store_row(s, block, i, average_row);
    }
    return BAT_OK;
}

LANE bat_status average_rows(sphere_kind s, const refine_kernel *kernel, const double *rows, size_t count, double *averages,
                             size_t stride, size_t *fault)
{
    sphere_block block;
    for (size_t done = 0; done < count; done += BLOCK)
    {
        size_t pairs = count - done < BLOCK ? count - done : BLOCK;
        const double *from = rows + done * kernel->dim;
        for (size_t i = 0; i <= pairs; i++)
            load_row(s, &block, from + i * kernel->dim, i);
        if (s.projective)
            average_quaternions(&block, pairs);
        else
            average_round(&block, pairs);
        bat_status status = finish_rows(s, kernel, &block, from, pairs, averages + done * stride, stride, fault);
        if (status != BAT_OK)
        {
            *fault += done;
            return status;
        }
    }
    return BAT_OK;
}

bat_status hermite_average_sphere(const refine_kernel *kernel, const double *rows, size_t count, double *averages,
                                  size_t stride, size_t *fault)
{
    return average_rows(ROUND, kernel, rows, count, averages, stride, fault);
}

bat_status hermite_average_rotation(const refine_kernel *kernel, const double *rows, size_t count, double *averages,
                                    size_t stride, size_t *fault)
{
    return average_rows(QUATERNIONS, kernel, rows, count, averages, stride, fault);
}
