#include "surface/network/surface_chart.h"

#include "base/error.h"
#include "base/memory.h"
#include "surface/network/surface_extension.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    ORDERS = CHART_DEGREE + 1,
    GATE = 2 * CHART_TERMS
};

/// What the gate's number is before a network says anything: it lets most of a step pass.
static const double GATE_AT_REST = 2;

/// A patch farther from the cloud than this, in the unit box and beside the noise, says that the chart is folded.
static const double FOLDED = 0.05;

/// The patch through the whole cloud at its first parameters, and what follows from it.
static bat_status describe(const bat_cloud *cloud, const double *boundary, double noise, surface_chart *chart,
                           bat_error *error)
{
    size_t bound = cloud->boundary_count;
    double *all = memory_array(cloud->count, 2 * sizeof *all);
    if (all == NULL)
        return error_memory(error, cloud->count * 2 * sizeof *all);
    memcpy(all, boundary, 2 * bound * sizeof *all);
    memcpy(all + 2 * bound, chart->parameters, 2 * chart->count * sizeof *all);
    surface_descriptor patch;
    bat_status status = surface_descriptor_make(cloud->points, all, cloud->count, noise, &patch, error);
    free(all);
    if (status != BAT_OK)
        return status;
    chart->sees = surface_descriptor_see(&patch, chart->seen);
    chart->folded = patch.residual * patch.residual > FOLDED * FOLDED + 3 * noise * noise;
    for (size_t i = 0; i < chart->count; i++)
        surface_descriptor_step(&patch, cloud->points + 3 * (bound + i), chart->parameters + 2 * i, chart->steps + 2 * i);
    return BAT_OK;
}

bat_status surface_chart_make(const bat_cloud *cloud, const double *boundary, double *memory, surface_chart *chart,
                              bat_error *error)
{
    surface_chart made = {.count = cloud->count - cloud->boundary_count};
    made.parameters = memory;
    made.steps = memory + 2 * made.count;
    surface_extension extension;
    bat_status status = surface_extension_make(cloud, boundary, &extension, error);
    if (status != BAT_OK)
        return status;
    surface_extension_at(&extension, cloud->points + 3 * cloud->boundary_count, made.count, made.parameters);
    status = describe(cloud, boundary, extension.noise, &made, error);
    surface_extension_free(&extension);
    if (status == BAT_OK)
        *chart = made;
    return status;
}

static double gate(const double *moves)
{
    return 1 / (1 + exp(-moves[GATE] - GATE_AT_REST));
}

static double bubble(const double parameter[2])
{
    return 16 * parameter[0] * (1 - parameter[0]) * parameter[1] * (1 - parameter[1]);
}

void surface_chart_move(const surface_chart *chart, const double *moves, double *interior)
{
    double share = gate(moves);
    for (size_t i = 0; i < chart->count; i++)
    {
        const double *at = chart->parameters + 2 * i;
        double u[ORDERS], v[ORDERS], field[2] = {0}, height = bubble(at);
        surface_legendre(at[0], CHART_DEGREE, u);
        surface_legendre(at[1], CHART_DEGREE, v);
        for (size_t k = 0; k < CHART_TERMS; k++)
        {
            double term = u[k / ORDERS] * v[k % ORDERS];
            field[0] += term * moves[2 * k];
            field[1] += term * moves[2 * k + 1];
        }
        for (size_t d = 0; d < 2; d++)
            interior[2 * i + d] = fmin(fmax(at[d] + share * chart->steps[2 * i + d] + height * field[d], 0), 1);
    }
}

void surface_chart_move_back(const surface_chart *chart, const double *moves, const double *by_interior, double *by_moves)
{
    double share = gate(moves), by_share = 0;
    for (size_t i = 0; i < chart->count; i++)
    {
        const double *at = chart->parameters + 2 * i, *by = by_interior + 2 * i;
        double u[ORDERS], v[ORDERS], height = bubble(at);
        surface_legendre(at[0], CHART_DEGREE, u);
        surface_legendre(at[1], CHART_DEGREE, v);
        for (size_t k = 0; k < CHART_TERMS; k++)
        {
            double term = height * u[k / ORDERS] * v[k % ORDERS];
            by_moves[2 * k] += term * by[0];
            by_moves[2 * k + 1] += term * by[1];
        }
        by_share += by[0] * chart->steps[2 * i] + by[1] * chart->steps[2 * i + 1];
    }
    by_moves[GATE] += by_share * share * (1 - share);
}
