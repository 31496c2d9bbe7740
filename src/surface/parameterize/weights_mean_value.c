/// @file
/// Mean-value weights (Floater, "Mean value coordinates", 2003):
///     w_ik = (tan(a / 2) + tan(b / 2)) / |x_i - x_k|,   normalized to sum_k w_ik = 1,
/// where a and b are the angles at x_i on both sides of edge ik.

#include "linalg/vector.h"
#include "surface/parameterize/weights.h"

#include "base/error.h"

#include <string.h>

/// The contribution of a triangle to the weights of corner `at`: tan(angle / 2) / length for both adjacent edges.
static void triangle_weights(const double *points, uint32_t at, uint32_t second, uint32_t third, double added[2])
{
    double a[3], b[3], product[3];
    vector3_subtract(points + 3 * (size_t)second, points + 3 * (size_t)at, a);
    vector3_subtract(points + 3 * (size_t)third, points + 3 * (size_t)at, b);
    vector3_cross(a, b, product);
    double length_a = sqrt(vector3_dot(a, a)), length_b = sqrt(vector3_dot(b, b));
    double half_tangent = tan(0.5 * atan2(sqrt(vector3_dot(product, product)), vector3_dot(a, b)));
    added[0] = half_tangent / length_a;
    added[1] = half_tangent / length_b;
}

/// Add to the entry of a column in a row that ends at *end; append the entry if there is none.
static void add_entry(sparse_rows *rows, size_t start, size_t *end, uint32_t column, double value)
{
    size_t e = start;
    while (e < *end && rows->columns[e] != column)
        e++;
    if (e == *end)
    {
        rows->columns[(*end)++] = column;
        rows->values[e] = 0;
    }
    rows->values[e] += value;
}

/// Compact the rows, and scale each to sum 1.
static bat_status finish_rows(const bat_cloud *cloud, const size_t *ends, sparse_rows *rows, bat_error *error)
{
    size_t at = 0;
    for (size_t row = 0; row < rows->row_count; row++)
    {
        size_t start = rows->starts[row];
        double sum = 0;
        for (size_t e = start; e < ends[row]; e++)
            sum += rows->values[e];
        if (!(sum > 0 && isfinite(sum)))
        {
            size_t place = cloud_input_index(cloud, cloud->boundary_count + row);
            return error_set(error, BAT_NO_CONVERGENCE, place, 0, "all triangles of point %zu are degenerate", place);
        }
        rows->starts[row] = at;
        for (size_t e = start; e < ends[row]; e++)
        {
            // Only degenerate triangles have weight 0.
            if (rows->values[e] == 0)
                continue;
            rows->columns[at] = rows->columns[e];
            rows->values[at++] = rows->values[e] / sum;
        }
    }
    rows->starts[rows->row_count] = at;
    return BAT_OK;
}

static void add_triangles(const bat_cloud *cloud, size_t *ends, sparse_rows *rows)
{
    for (size_t t = 0; t < cloud->triangle_count; t++)
        for (size_t c = 0; c < 3; c++)
        {
            const uint32_t *triangle = cloud->triangles + 3 * t;
            uint32_t at = triangle[c], second = triangle[(c + 1) % 3], third = triangle[(c + 2) % 3];
            if (at < cloud->boundary_count)
                continue;
            size_t row = at - cloud->boundary_count;
            double added[2];
            triangle_weights(cloud->points, at, second, third, added);
            add_entry(rows, rows->starts[row], &ends[row], second, added[0]);
            add_entry(rows, rows->starts[row], &ends[row], third, added[1]);
        }
}

/// Reserve two entries for each triangle of a point.
static bat_status make_room(const bat_cloud *cloud, sparse_rows *rows, bat_error *error)
{
    size_t count = cloud->count - cloud->boundary_count, entries = 0;
    for (size_t k = 0; k < 3 * cloud->triangle_count; k++)
        entries += cloud->triangles[k] >= cloud->boundary_count ? 2 : 0;
    bat_status status = sparse_rows_make(count, cloud->count, entries, rows, error);
    if (status != BAT_OK)
        return status;
    memset(rows->starts, 0, (count + 1) * sizeof *rows->starts);
    for (size_t k = 0; k < 3 * cloud->triangle_count; k++)
        if (cloud->triangles[k] >= cloud->boundary_count)
            rows->starts[cloud->triangles[k] - cloud->boundary_count + 1] += 2;
    for (size_t row = 0; row < count; row++)
        rows->starts[row + 1] += rows->starts[row];
    return BAT_OK;
}

bat_status weights_of_triangles(const bat_cloud *cloud, sparse_rows *rows, bat_error *error)
{
    size_t count = cloud->count - cloud->boundary_count;
    size_t *ends = memory_array(count, sizeof *ends);
    if (ends == NULL)
        return error_memory(error, count * sizeof *ends);
    bat_status status = make_room(cloud, rows, error);
    if (status == BAT_OK)
    {
        memcpy(ends, rows->starts, count * sizeof *ends);
        add_triangles(cloud, ends, rows);
        status = finish_rows(cloud, ends, rows, error);
        if (status != BAT_OK)
            sparse_rows_free(rows);
    }
    free(ends);
    return status;
}
