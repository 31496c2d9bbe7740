#include "surface/parameterize/parameters_report.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Parameters that agree when rounded to multiples of its inverse coincide.
static const double COINCIDENCE = 1e12;

bat_status parameter_faults_make(size_t count, parameter_faults *faults, bat_error *error)
{
    *faults = (parameter_faults){.folded = memory_array(count, sizeof(bool)),
                                 .outside = memory_array(count, sizeof(bool)),
                                 .coincident = memory_array(count, sizeof(bool))};
    if (faults->folded != NULL && faults->outside != NULL && faults->coincident != NULL)
        return BAT_OK;
    parameter_faults_free(faults);
    return error_memory(error, 3 * count);
}

void parameter_faults_free(parameter_faults *faults)
{
    free(faults->folded);
    free(faults->outside);
    free(faults->coincident);
    *faults = (parameter_faults){0};
}

bat_status parameters_check_cloud(const bat_cloud *cloud, bat_error *error)
{
    bat_status status = bat_cloud_check(cloud, error);
    if (status == BAT_OK && cloud->boundary_count == 0)
        status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the boundary of the cloud is not known");
    return status;
}

static size_t find_outside(const double *parameters, size_t count, bool *outside)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
    {
        double u = parameters[2 * i], v = parameters[2 * i + 1];
        outside[i] = !(u >= 0 && u <= 1 && v >= 0 && v <= 1);
        found += outside[i];
    }
    return found;
}

/// A point's parameters, rounded.
typedef struct rounded_parameters
{
    double at[2];
    size_t point;
} rounded_parameters;

static int compare_rounded(const void *a, const void *b)
{
    const rounded_parameters *first = a, *second = b;
    for (size_t c = 0; c < 2; c++)
        if (first->at[c] != second->at[c])
            return first->at[c] < second->at[c] ? -1 : 1;
    return (first->point > second->point) - (first->point < second->point);
}

/// Points that are not numbers, and the boundary, are not looked at; an interior point may coincide with the boundary.
static bat_status find_coincident(const bat_cloud *cloud, const double *parameters, bool *coincident, size_t *found,
                                  bat_error *error)
{
    rounded_parameters *sorted = memory_array(cloud->count, sizeof *sorted);
    if (sorted == NULL)
        return error_memory(error, cloud->count * sizeof *sorted);
    size_t count = 0;
    *found = 0;
    memset(coincident, 0, cloud->count * sizeof *coincident);
    for (size_t i = 0; i < cloud->count; i++)
        if (isfinite(parameters[2 * i]) && isfinite(parameters[2 * i + 1]))
            sorted[count++] = (rounded_parameters){
                .at = {rint(parameters[2 * i] * COINCIDENCE), rint(parameters[2 * i + 1] * COINCIDENCE)}, .point = i};
    qsort(sorted, count, sizeof *sorted, compare_rounded);
    for (size_t k = 1; k < count; k++)
        if (sorted[k].at[0] == sorted[k - 1].at[0] && sorted[k].at[1] == sorted[k - 1].at[1])
            coincident[sorted[k].point] = coincident[sorted[k - 1].point] = true;
    for (size_t i = 0; i < cloud->count; i++)
    {
        coincident[i] = coincident[i] && i >= cloud->boundary_count;
        *found += coincident[i];
    }
    free(sorted);
    return BAT_OK;
}

static int compare_numbers(const void *a, const void *b)
{
    double first = *(const double *)a, second = *(const double *)b;
    return (first > second) - (first < second);
}

/// The median; sorts. 1 for none.
static double median(double *values, size_t count)
{
    if (count == 0)
        return 1;
    for (size_t i = 0; i < count; i++)
        values[i] = isnan(values[i]) ? INFINITY : values[i];
    qsort(values, count, sizeof *values, compare_numbers);
    return count % 2 == 1 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}

bat_status parameter_faults_find(const fold_finder *finder, const double *parameters, parameter_faults *faults,
                                 bat_cloud_parameters_report *report, bat_error *error)
{
    const bat_cloud *cloud = &finder->order.cloud;
    size_t interior = cloud->count - cloud->boundary_count;
    double *stretches = memory_array(interior, sizeof *stretches);
    bat_cloud_parameters_report found = {.first = BAT_NO_INDEX};
    bat_status status = stretches != NULL ? fold_finder_run(finder, parameters, faults->folded, stretches, error)
                                          : error_memory(error, interior * sizeof *stretches);
    if (status == BAT_OK)
        status = find_coincident(cloud, parameters, faults->coincident, &found.coincident, error);
    for (size_t i = cloud->boundary_count; i < cloud->count && status == BAT_OK; i++)
        if (faults->folded[i])
        {
            found.folded++;
            found.first = found.first < finder->order.places[i] ? found.first : finder->order.places[i];
        }
    if (status == BAT_OK)
    {
        found.outside = find_outside(parameters, cloud->count, faults->outside);
        found.stretch = median(stretches, interior);
        *report = found;
    }
    free(stretches);
    return status;
}

bat_status bat_cloud_parameters_check(const bat_cloud *cloud, const double *parameters, bat_cloud_parameters_report *report,
                                      bat_error *error)
{
    fold_finder finder = {0};
    parameter_faults faults = {0};
    double *ordered = memory_array(cloud->count, 2 * sizeof *ordered);
    bat_status status =
        ordered != NULL ? parameters_check_cloud(cloud, error) : error_memory(error, cloud->count * 2 * sizeof *ordered);
    if (status == BAT_OK)
        status = fold_finder_make(cloud, &finder, error);
    if (status == BAT_OK)
        status = parameter_faults_make(cloud->count, &faults, error);
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
        memcpy(ordered + 2 * i, parameters + 2 * (size_t)finder.order.places[i], 2 * sizeof *ordered);
    if (status == BAT_OK)
        status = parameter_faults_find(&finder, ordered, &faults, report, error);
    fold_finder_free(&finder);
    parameter_faults_free(&faults);
    free(ordered);
    return status;
}
