#include "batten/space.h"

#include "base/error.h"

#include <math.h>
#include <string.h>

static const bat_product_factors *factors_of(const bat_space *space)
{
    return space->parameters;
}

static double weight_of(const bat_product_factors *factors, size_t i)
{
    return factors->weights == NULL ? 1 : factors->weights[i];
}

static const char *fault(const bat_space *space, const double *point)
{
    const bat_product_factors *factors = factors_of(space);
    for (size_t i = 0; i < factors->count; i++)
    {
        const bat_space *factor = &factors->spaces[i];
        const char *what = factor->fault(factor, point);
        if (what != NULL)
            return what;
        point += factor->point_dim;
    }
    return NULL;
}

static bat_status project(const bat_space *space, const double *coordinates, double *point)
{
    const bat_product_factors *factors = factors_of(space);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < factors->count && status == BAT_OK; i++)
    {
        const bat_space *factor = &factors->spaces[i];
        status = factor->project(factor, coordinates, point);
        coordinates += factor->point_dim;
        point += factor->point_dim;
    }
    return status;
}

static double distance(const bat_space *space, const double *p, const double *q)
{
    const bat_product_factors *factors = factors_of(space);
    double sum = 0;
    for (size_t i = 0; i < factors->count; i++)
    {
        const bat_space *factor = &factors->spaces[i];
        sum = hypot(sum, weight_of(factors, i) * factor->distance(factor, p, q));
        p += factor->point_dim;
        q += factor->point_dim;
    }
    return sum;
}

static bat_status logarithm(const bat_space *space, const double *p, const double *q, double *tangent)
{
    const bat_product_factors *factors = factors_of(space);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < factors->count && status == BAT_OK; i++)
    {
        const bat_space *factor = &factors->spaces[i];
        status = factor->log(factor, p, q, tangent);
        p += factor->point_dim;
        q += factor->point_dim;
        tangent += factor->tangent_dim;
    }
    return status;
}

static bat_status exponential(const bat_space *space, const double *p, const double *tangent, double *q)
{
    const bat_product_factors *factors = factors_of(space);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < factors->count && status == BAT_OK; i++)
    {
        const bat_space *factor = &factors->spaces[i];
        status = factor->exp(factor, p, tangent, q);
        p += factor->point_dim;
        q += factor->point_dim;
        tangent += factor->tangent_dim;
    }
    return status;
}

static bat_status transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                            double *transported)
{
    const bat_product_factors *factors = factors_of(space);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < factors->count && status == BAT_OK; i++)
    {
        const bat_space *factor = &factors->spaces[i];
        status = factor->transport(factor, p, q, tangent, transported);
        p += factor->point_dim;
        q += factor->point_dim;
        tangent += factor->tangent_dim;
        transported += factor->tangent_dim;
    }
    return status;
}

static double inner(const bat_space *space, const double *p, const double *u, const double *v)
{
    const bat_product_factors *factors = factors_of(space);
    double sum = 0;
    for (size_t i = 0; i < factors->count; i++)
    {
        const bat_space *factor = &factors->spaces[i];
        double weight = weight_of(factors, i);
        sum += weight * weight * factor->inner(factor, p, u, v);
        p += factor->point_dim;
        u += factor->tangent_dim;
        v += factor->tangent_dim;
    }
    return sum;
}

static void random_point(const bat_space *space, bat_random *random, double *point)
{
    const bat_product_factors *factors = factors_of(space);
    for (size_t i = 0; i < factors->count; i++)
    {
        const bat_space *factor = &factors->spaces[i];
        factor->random_point(factor, random, point);
        point += factor->point_dim;
    }
}

static bat_status geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    const bat_product_factors *factors = factors_of(space);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < factors->count && status == BAT_OK; i++)
    {
        const bat_space *factor = &factors->spaces[i];
        status = bat_space_geodesic(factor, p, q, t, point);
        p += factor->point_dim;
        q += factor->point_dim;
        point += factor->point_dim;
    }
    return status;
}

bat_status bat_product(const bat_product_factors *factors, bat_space *product, bat_error *error)
{
    if (factors->count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a product needs at least one factor");
    bat_space whole = {
        .name = "product",
        .injectivity = INFINITY,
        .parameters = factors,
        .fault = fault,
        .project = project,
        .distance = distance,
        .log = logarithm,
        .exp = exponential,
        .transport = transport,
        .inner = inner,
        .random_point = random_point,
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
