/// @file
/// Classical parameterizations of clouds (bat_cloud_parameterize): u_i = sum_k w_ik u_k for interior points, u fixed on the
/// boundary. The methods differ in the weights w_ik (weights.h). The option `published` selects the neighbourhoods and the
/// direct solver of the literature, which may fail. By default, neighbourhoods adapt to the points, and the system is solved
/// iteratively.

#include "batten/cloud_parameterize.h"

#include "surface/cloud/neighbours.h"
#include "surface/parameterize/weights.h"

#include "base/choice.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Numerator of the radius 3 / sqrt(n), eq. (7) of Giannelli et al. (2023).
static const double RADIUS_FACTOR = 3;

static const bat_choice METHODS[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "shape-preserving", BAT_CLOUD_PARAMETERIZATION_AUTO),
    CHOICE("shape-preserving",
           "Floater's weights on the Delaunay neighbours in local planes; docs/algorithms/parameterization.md",
           BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING),
    CHOICE("inverse-distance", "weights by the inverse distance of neighbours", BAT_CLOUD_PARAMETERIZATION_INVERSE_DISTANCE),
    CHOICE("uniform", "all neighbours weigh the same", BAT_CLOUD_PARAMETERIZATION_UNIFORM),
    CHOICE("mean-value", "Floater's mean values, for clouds that are meshes", BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE),
    CHOICE("stretch-minimizing", "shape-preserving, evened out: for deep shapes",
           BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING),
    CHOICE("isometric", "least distortion of triangles, along the boundary too: for the deepest shapes",
           BAT_CLOUD_PARAMETERIZATION_ISOMETRIC),
};
const bat_family bat_cloud_parameterization_family = FAMILY("parameterization", METHODS);

bat_cloud_parameterize_options bat_cloud_parameterize_defaults(void)
{
    return (bat_cloud_parameterize_options){.method = BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING};
}

static bat_status cloud_parameterize_options_check(const void *opaque, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FAMILY(bat_cloud_parameterize_options, method, bat_cloud_parameterization_family),
        OPTION_FIELD(bat_cloud_parameterize_options, radius, OPTION_NUMBER, 0, INFINITY),
        OPTION_THREADS(bat_cloud_parameterize_options),
    };
    return OPTIONS_CHECK(opaque, FIELDS, error);
}

const bat_options_table bat_cloud_parameterize_fields = {"bat_cloud_parameterize_options", cloud_parameterize_options_check};

static bat_status check_cloud(const bat_cloud *cloud, const double *boundary, const bat_cloud_parameterize_options *options,
                              bat_error *error)
{
    bat_status status = bat_cloud_check(cloud, error);
    if (status != BAT_OK)
        return status;
    if (cloud->boundary_count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the boundary of the cloud is unknown");
    if (options->method == BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE && cloud->triangle_count == 0)
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "mean values need the triangles of a mesh");
    for (size_t i = 0; i < 2 * cloud->boundary_count; i++)
        if (!isfinite(boundary[i]))
            return error_set(error, BAT_INVALID_ARGUMENT, i / 2, 0, "the parameters of boundary point %zu are not finite",
                             i / 2);
    return BAT_OK;
}

/// Published variant: neighbours in a ball of fixed radius, which may fail, and a direct solver.
static bat_status parameterize_published(const bat_cloud *cloud, const double *boundary,
                                         const bat_cloud_parameterize_options *options, double *parameters, bat_error *error)
{
    double radius = options->radius > 0 ? options->radius : RADIUS_FACTOR / sqrt((double)cloud->count);
    neighbour_tree tree;
    bat_status status = neighbour_tree_build(cloud->points, cloud->count, &tree, error);
    if (status != BAT_OK)
        return status;
    weight_source source = {
        .cloud = cloud, .tree = &tree, .method = options->method, .radius = radius * weights_longest_side(cloud)};
    sparse_rows rows = {0};
    bool star = options->method == BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING;
    status = weights_build(&source, star ? weights_of_triangulated_ball : weights_of_ball, options->threads, &rows, error);
    size_t unjoined = BAT_NO_INDEX;
    if (status == BAT_OK)
        status = weights_find_unjoined(cloud, &rows, &unjoined, error);
    if (status == BAT_OK && unjoined != BAT_NO_INDEX)
    {
        size_t place = cloud_input_index(cloud, unjoined);
        status = error_set(error, BAT_NO_CONVERGENCE, place, 0, "no chain of neighbours connects point %zu to the boundary",
                           place);
    }
    if (status == BAT_OK)
    {
        memcpy(parameters, boundary, 2 * cloud->boundary_count * sizeof *parameters);
        status = averages_solve(cloud, &rows, NULL, (average_solver){.direct = true}, parameters, error);
    }
    sparse_rows_free(&rows);
    neighbour_tree_free(&tree);
    return status;
}

static bat_status parameterize_adaptive(const bat_cloud *cloud, const double *boundary,
                                        const bat_cloud_parameterize_options *options, double *parameters, bat_error *error)
{
    average_solver solver = {.threads = options->threads, .progress = options->progress};
    spatial_order order = {0};
    sparse_rows rows = {0};
    double *ordered = memory_array(cloud->count, 2 * sizeof *ordered);
    bat_status status =
        ordered != NULL ? spatial_order_make(cloud, &order, error) : error_memory(error, cloud->count * 2 * sizeof *ordered);
    if (status == BAT_OK)
        status = weights_make(&order.cloud, &order.tree, options, &rows, error);
    if (status == BAT_OK)
    {
        memcpy(ordered, boundary, 2 * cloud->boundary_count * sizeof *ordered);
        status = averages_solve(&order.cloud, &rows, NULL, solver, ordered, error);
    }
    if (status == BAT_OK && options->method == BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING)
        status = stretch_minimize(&order.cloud, &rows, solver, ordered, error);
    if (status == BAT_OK && options->method == BAT_CLOUD_PARAMETERIZATION_ISOMETRIC)
        status = isometric_minimize(&order.cloud, &rows, solver, ordered, error);
    for (size_t i = 0; status == BAT_OK && i < cloud->count; i++)
        memcpy(parameters + 2 * order.places[i], ordered + 2 * i, 2 * sizeof *parameters);
    sparse_rows_free(&rows);
    spatial_order_free(&order);
    free(ordered);
    return status;
}

bat_status bat_cloud_parameterize(const bat_cloud *cloud, const double *boundary,
                                  const bat_cloud_parameterize_options *options, double *parameters, bat_error *error)
{
    bat_cloud_parameterize_options chosen = options != NULL ? *options : bat_cloud_parameterize_defaults();
    bat_status status = bat_options_check(&bat_cloud_parameterize_fields, options, error);
    options = &chosen;
    if (chosen.method == BAT_CLOUD_PARAMETERIZATION_AUTO)
        chosen.method = BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING;
    if (status == BAT_OK)
        status = check_cloud(cloud, boundary, options, error);
    if (status != BAT_OK)
        return status;
    if (options->published && options->method < BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE)
        return parameterize_published(cloud, boundary, options, parameters, error);
    return parameterize_adaptive(cloud, boundary, options, parameters, error);
}
