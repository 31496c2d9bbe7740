#include "cloud/averages.h"

#include "linalg/average_system.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Splits rows into the weights of interior points and what the boundary adds.
static bat_status split_rows(const bat_cloud *cloud, const sparse_rows *rows, const double *boundary, sparse_rows *weights,
                             double *constant, bat_error *error)
{
    size_t count = rows->row_count;
    bat_status status = sparse_rows_make(count, count, rows->starts[count], weights, error);
    if (status != BAT_OK)
        return status;
    size_t at = 0;
    memset(constant, 0, 2 * count * sizeof *constant);
    for (size_t i = 0; i < count; i++)
    {
        weights->starts[i] = at;
        for (size_t e = rows->starts[i]; e < rows->starts[i + 1]; e++)
        {
            size_t column = rows->columns[e];
            if (column >= cloud->boundary_count)
            {
                weights->columns[at] = (uint32_t)(column - cloud->boundary_count);
                weights->values[at++] = rows->values[e];
                continue;
            }
            for (size_t c = 0; c < 2; c++)
                constant[2 * i + c] += rows->values[e] * boundary[2 * column + c];
        }
    }
    weights->starts[count] = at;
    return BAT_OK;
}

/// Averages lie within the box of what they are averages of, but for rounding.
static void keep_in_box(const bat_cloud *cloud, const double *boundary, double *parameters)
{
    for (size_t c = 0; c < 2; c++)
    {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < cloud->boundary_count; i++)
        {
            low = fmin(low, boundary[2 * i + c]);
            high = fmax(high, boundary[2 * i + c]);
        }
        for (size_t i = cloud->boundary_count; i < cloud->count; i++)
            parameters[2 * i + c] = fmin(fmax(parameters[2 * i + c], low), high);
    }
}

bat_status averages_solve(const bat_cloud *cloud, const sparse_rows *rows, const double *boundary, bool direct,
                          double *parameters, bat_error *error)
{
    sparse_rows weights = {0};
    double *constant = memory_array(rows->row_count, 2 * sizeof *constant);
    bat_status status = constant != NULL ? split_rows(cloud, rows, boundary, &weights, constant, error)
                                         : error_memory(error, rows->row_count * 2 * sizeof *constant);
    double *interior = parameters + 2 * cloud->boundary_count;
    if (status == BAT_OK)
        status = direct ? average_solve_direct(&weights, constant, interior, error)
                        : average_solve_iterative(&weights, constant, interior, error);
    if (status == BAT_OK)
    {
        memcpy(parameters, boundary, 2 * cloud->boundary_count * sizeof *parameters);
        keep_in_box(cloud, boundary, parameters);
    }
    sparse_rows_free(&weights);
    free(constant);
    return status;
}
