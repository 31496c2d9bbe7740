#include "curve/angle_block.h"
#include "curve/edge_turns.h"
#include "curve/kernel.h"

/// Adaptive tension (Ugail and Howard, section 7.1): slope and clip range of the tension.
static const double ADAPTIVE_SLOPE = -0.5;
static const double ADAPTIVE_LOW = -0.5, ADAPTIVE_HIGH = 0.1;

/// Eq. (9), limited to the admissible interval.
static inline double slope_of(const double *angle, double tension, double sign)
{
    return angle_slope(sign * 0.125 * (tension * (angle[0] + angle[3]) + (1 - tension) * (angle[1] + angle[2])));
}

LANES_CLONES
/// The turns along edge j of the four vertices around it, multiplied by their factor.
static inline void turns_of(const double *angle, const double *length, double turn[EDGE_VERTICES])
{
    double factor = edge_turns_of(angle, length, turn);
    for (int i = 0; i < EDGE_VERTICES; i++)
        turn[i] *= factor;
}

LANES_CLONES
static void turn_slopes(angle_block *block, size_t edges, double tension, double sign)
{
    for (size_t j = 0; j < edges; j++)
    {
        double turn[EDGE_VERTICES];
        turns_of(block->angle + j, block->length + j, turn);
        block->slope[j] = slope_of(turn, tension, sign);
    }
}

/// Section 7.1 with absolute angles, so that the rule does not change when the curve is mirrored or reversed.
static inline double adaptive_slope(const double *angle, double tension, double sign, double mean)
{
    double local = 0.25 * (fabs(angle[0]) + fabs(angle[1]) + fabs(angle[2]) + fabs(angle[3]));
    double mu = tension + ADAPTIVE_SLOPE * (local - mean);
    mu = mu < ADAPTIVE_LOW ? ADAPTIVE_LOW : mu;
    mu = mu > ADAPTIVE_HIGH ? ADAPTIVE_HIGH : mu;
    return slope_of(angle, mu, sign);
}

LANES_CLONES
static void adaptive_slopes(angle_block *block, size_t edges, double tension, double sign, double mean, bool turns)
{
    for (size_t j = 0; j < edges; j++)
    {
        double turn[EDGE_VERTICES];
        turns_of(block->angle + j, block->length + j, turn);
        block->slope[j] = adaptive_slope(turns ? turn : block->angle + j, tension, sign, mean);
    }
}

typedef struct angle_data
{
    const bat_curve_scheme *scheme;
    const angle_surface *surface; ///< the vector code of the space; null for a user's space
    double scale;                 ///< kernel_scale() of the polygon
    double mean;                  ///< of the adaptive scheme: the polygon's mean absolute exterior angle
} angle_data;
_Static_assert(sizeof(angle_data) <= KERNEL_DATA, "a kernel has room for its data");

static bat_status run_blocks(const refine_kernel *kernel, const double *points, size_t pairs, double *fine,
                             void *scratch BAT_UNUSED, size_t *fault)
{
    const angle_data *data = kernel_data_of(kernel);
    const angle_surface *where = data->surface;
    const bat_curve_scheme *scheme = data->scheme;
    size_t dim = kernel->dim;
    double sign = scheme->sign == BAT_CURVE_ANGLE_SIGN_OUTWARD ? -1 : 1;
    angle_block block;
    for (size_t done = 0; done < pairs; done += ANGLE_BLOCK_EDGES)
    {
        size_t edges = pairs - done < ANGLE_BLOCK_EDGES ? pairs - done : ANGLE_BLOCK_EDGES;
        const double *here = points + done * dim;
        angle_block_load(&block, 0, here - 2 * dim, dim, edges + 5);
        where->angles(&block, edges + 3, data->scale);
        if (scheme->turns)
            where->lengths(&block, edges + 4, data->scale);
        if (scheme->adaptive)
            adaptive_slopes(&block, edges, scheme->tension, sign, data->mean, scheme->turns);
        else if (scheme->turns)
            turn_slopes(&block, edges, scheme->tension, sign);
        else
            for (size_t j = 0; j < edges; j++)
                block.slope[j] = slope_of(block.angle + j, scheme->tension, sign);
        where->insert(&block, edges);
        for (size_t j = 0; j < edges; j++)
            if (!(block.margin[j] > 0))
            {
                *fault = done + j;
                return where->missing;
            }
        angle_block_store(&block, here, dim, edges, fine + 2 * done * dim);
    }
    return BAT_OK;
}

/// Any other oriented surface, through its own functions.
static bat_status run_any(const refine_kernel *kernel, const double *points, size_t pairs, double *fine,
                          void *scratch BAT_UNUSED, size_t *fault)
{
    const angle_data *data = kernel_data_of(kernel);
    const bat_space *space = kernel->space;
    const bat_curve_scheme *scheme = data->scheme;
    size_t dim = kernel->dim;
    double sign = scheme->sign == BAT_CURVE_ANGLE_SIGN_OUTWARD ? -1 : 1;
    bat_status status = BAT_OK;
    for (size_t j = 0; j < pairs && status == BAT_OK; j++)
    {
        const double *p = points + j * dim;
        double angle[EDGE_VERTICES], slope;
        *fault = j;
        for (size_t i = 0; i < EDGE_VERTICES; i++)
            angle[i] = space->exterior_angle(space, p + i * dim - 2 * dim, p + i * dim - dim, p + i * dim);
        if (scheme->turns)
        {
            double length[EDGE_LENGTHS], turn[EDGE_VERTICES];
            for (size_t i = 0; i < EDGE_LENGTHS; i++)
                length[i] = space->distance(space, p + i * dim - 2 * dim, p + i * dim - dim);
            turns_of(angle, length, turn);
            memcpy(angle, turn, sizeof angle);
        }
        slope = scheme->adaptive ? adaptive_slope(angle, scheme->tension, sign, data->mean)
                                 : slope_of(angle, scheme->tension, sign);
        memcpy(fine + 2 * j * dim, p, dim * sizeof *p);
        status = space->apex(space, p, p + dim, atan(slope), fine + (2 * j + 1) * dim);
    }
    return status;
}

/// The mean absolute exterior angle at the points first … end - 1, 0 when there are none.
static double mean_angle(const refine_kernel *kernel, const double *points, size_t first, size_t end)
{
    const bat_space *space = kernel->space;
    const angle_data *data = kernel_data_of(kernel);
    const angle_surface *where = data->surface;
    size_t dim = space->point_dim;
    double sum = 0;
    angle_block block;
    for (size_t done = first; done < end; done += ANGLE_BLOCK_EDGES)
    {
        size_t count = end - done < ANGLE_BLOCK_EDGES ? end - done : ANGLE_BLOCK_EDGES;
        const double *before = points + done * dim - dim;
        if (where != NULL)
        {
            angle_block_load(&block, 0, before, dim, count + 2);
            where->angles(&block, count, data->scale);
        }
        for (size_t i = 0; i < count; i++)
            sum += fabs(where != NULL ? block.angle[i]
                                      : space->exterior_angle(space, before + i * dim, before + (i + 1) * dim,
                                                              before + (i + 2) * dim));
    }
    return end > first ? sum / (double)(end - first) : 0;
}

static void measure(refine_kernel *kernel, const double *points, size_t count, bool closed)
{
    angle_data *data = kernel_data(kernel);
    data->scale = kernel_scale(points, count, kernel->dim);
    if (data->scheme->adaptive)
        data->mean = mean_angle(kernel, points, closed ? 0 : 1, closed ? count : count - 1);
}

refine_kernel kernel_angle(const bat_space *space, const bat_curve_scheme *scheme)
{
    const angle_surface *surface = angle_surface_of(space);
    refine_kernel kernel = {
        .space = space,
        .dim = space->point_dim,
        .first = -5,
        .last = 5,
        .run = surface != NULL ? run_blocks : run_any,
        .measure = measure,
    };
    angle_data *data = kernel_data(&kernel);
    *data = (angle_data){.scheme = scheme, .surface = surface};
    return kernel;
}
