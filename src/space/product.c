#include "base/error.h"
#include "space/builtin.h"

static const bat_product_factors *factors_of(const bat_space *space)
{
    return space->parameters;
}

static double weight_of(const bat_product_factors *factors, size_t i)
{
    return factors->weights == NULL ? 1 : factors->weights[i];
}

/// A factor, and where its numbers begin in a point and in a tangent vector.
typedef struct part
{
    const bat_space *space;
    size_t index, point, tangent;
} part;

static part first_part(const bat_space *space)
{
    return (part){.space = factors_of(space)->spaces};
}

/// Whether there is such a part; none is wanted after a failure.
static bool is_part(const bat_space *space, const part *at, bat_status status)
{
    return at->index < factors_of(space)->count && status == BAT_OK;
}

static void go_on(part *at)
{
    at->index++;
    at->point += at->space->point_dim;
    at->tangent += at->space->tangent_dim;
    at->space++;
}

static const char *fault(const bat_space *space, const double *point)
{
    const char *what = NULL;
    for (part at = first_part(space); is_part(space, &at, BAT_OK) && what == NULL; go_on(&at))
        what = at.space->fault(at.space, point + at.point);
    return what;
}

static bat_status project(const bat_space *space, const double *coordinates, double *point)
{
    bat_status status = BAT_OK;
    for (part at = first_part(space); is_part(space, &at, status); go_on(&at))
        status = at.space->project(at.space, coordinates + at.point, point + at.point);
    return status;
}

static double distance(const bat_space *space, const double *p, const double *q)
{
    double sum = 0;
    for (part at = first_part(space); is_part(space, &at, BAT_OK); go_on(&at))
        sum = hypot(sum, weight_of(factors_of(space), at.index) * at.space->distance(at.space, p + at.point, q + at.point));
    return sum;
}

static bat_status logarithm(const bat_space *space, const double *p, const double *q, double *tangent)
{
    bat_status status = BAT_OK;
    for (part at = first_part(space); is_part(space, &at, status); go_on(&at))
        status = at.space->log(at.space, p + at.point, q + at.point, tangent + at.tangent);
    return status;
}

static bat_status exponential(const bat_space *space, const double *p, const double *tangent, double *q)
{
    bat_status status = BAT_OK;
    for (part at = first_part(space); is_part(space, &at, status); go_on(&at))
        status = at.space->exp(at.space, p + at.point, tangent + at.tangent, q + at.point);
    return status;
}

static bat_status transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                            double *transported)
{
    bat_status status = BAT_OK;
    for (part at = first_part(space); is_part(space, &at, status); go_on(&at))
        status = at.space->transport(at.space, p + at.point, q + at.point, tangent + at.tangent, transported + at.tangent);
    return status;
}

static double inner(const bat_space *space, const double *p, const double *u, const double *v)
{
    double sum = 0;
    for (part at = first_part(space); is_part(space, &at, BAT_OK); go_on(&at))
    {
        double weight = weight_of(factors_of(space), at.index);
        sum += weight * weight * at.space->inner(at.space, p + at.point, u + at.tangent, v + at.tangent);
    }
    return sum;
}

static void random_point(const bat_space *space, bat_random *random, double *point)
{
    for (part at = first_part(space); is_part(space, &at, BAT_OK); go_on(&at))
        at.space->random_point(at.space, random, point + at.point);
}

static bat_status geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    bat_status status = BAT_OK;
    for (part at = first_part(space); is_part(space, &at, status); go_on(&at))
        status = bat_space_geodesic(at.space, p + at.point, q + at.point, t, point + at.point);
    return status;
}

bat_status bat_product(const bat_product_factors *factors, bat_space *product, bat_error *error)
{
    if (factors->count == 0)
        return ERROR_ARGUMENT(error, "a product needs at least one factor");
    bat_space whole = {
        .name = "product",
        .injectivity = INFINITY,
        .parameters = factors,
        .fault = fault,
        .project = project,
        SPACE_FUNCTIONS,
        .inner = inner,
        .geodesic = geodesic,
    };
    for (size_t i = 0; i < factors->count; i++)
    {
        const bat_space *factor = &factors->spaces[i];
        double weight = weight_of(factors, i);
        if (!(weight > 0 && isfinite(weight)))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "the weight of factor %zu is not a positive number", i);
        if (factor->point_dim > BAT_SPACE_MAX_DIM - whole.point_dim ||
            factor->tangent_dim > BAT_SPACE_MAX_DIM - whole.tangent_dim)
            return error_set(error, BAT_TOO_LARGE, i, 0, "with factor %zu a point has more than %d coordinates", i,
                             BAT_SPACE_MAX_DIM);
        whole.dimension += factor->dimension;
        whole.point_dim += factor->point_dim;
        whole.tangent_dim += factor->tangent_dim;
        whole.injectivity = fmin(whole.injectivity, weight * factor->injectivity);
    }
    *product = whole;
    return BAT_OK;
}
