#include "real_curves_data.h"

#include "base/error.h"
#include "batten/curve_file.h"
#include "research/studies/folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    PATH_SIZE = 4096
};

static const char TRUTH[] = "-truth.csv", ENDING[] = ".csv";

static bool ends_with(const char *name, const char *ending)
{
    size_t length = strlen(name), end = strlen(ending);
    return length > end && strcmp(name + length - end, ending) == 0;
}

static bool is_curves(const char *name)
{
    return ends_with(name, ENDING);
}

static bat_status read_set(const char *folder, const char *name, bat_curve_set *set, bat_error *error)
{
    char path[PATH_SIZE];
    int length = snprintf(path, sizeof path, "%s/%s", folder, name);
    if (length < 0 || (size_t)length >= sizeof path)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the folder's name is too long");
    bat_curve_read_options options = bat_curve_read_defaults();
    options.space = "plane";
    return error_prefix(error, bat_curve_read(path, &options, set, error), "%s: ", path);
}

static bat_status copy_name(const char *file, const char *text, size_t length, char *name, bat_error *error)
{
    if (length >= BAT_REAL_CURVES_NAME)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "%s: a name of more than %d characters", file,
                         BAT_REAL_CURVES_NAME - 1);
    memcpy(name, text, length);
    name[length] = '\0';
    return BAT_OK;
}

/// Whether control points belong to the true curves.
static bat_status check_pair(const char *file, const bat_curve_set *truth, const bat_curve_set *control, bat_error *error)
{
    if (truth->count != control->count)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "%s: %zu curves, but %zu true ones", file, control->count,
                         truth->count);
    for (size_t i = 0; i < truth->count; i++)
    {
        if (truth->curves[i].closed != control->curves[i].closed)
            return error_set(error, BAT_BAD_FILE, i, 0, "%s: curve %zu is %s, but the true one is not", file, i,
                             control->curves[i].closed ? "closed" : "open");
        bat_error own;
        if (bat_curve_check(&control->curves[i], &own) != BAT_OK)
            return error_set(error, BAT_BAD_FILE, i, 0, "%s: curve %zu: %.180s", file, i, own.text);
        if (truth->curves[i].count < 2)
            return error_set(error, BAT_BAD_FILE, i, 0, "%s: true curve %zu has one point", file, i);
    }
    return BAT_OK;
}

/// The family of a file: the one with the longest name that begins the file's; null for none.
static real_family *family_of(const real_folder *folder, const char *file)
{
    real_family *found = NULL;
    for (size_t i = 0; i < folder->count; i++)
    {
        real_family *family = &folder->families[i];
        size_t length = strlen(family->name);
        bool begins = strncmp(file, family->name, length) == 0 && file[length] == '-';
        if (begins && (found == NULL || length > strlen(found->name)))
            found = family;
    }
    return found;
}

static bat_status add_truth(const char *path, const char *file, real_folder *folder, bat_error *error)
{
    real_family family = {.samplings = NULL};
    bat_status status = copy_name(file, file, strlen(file) - strlen(TRUTH), family.name, error);
    if (status == BAT_OK)
        status = read_set(path, file, &family.truth, error);
    if (status == BAT_OK)
        folder->families[folder->count++] = family;
    return status;
}

static bat_status add_sampling(const char *path, const char *file, real_folder *folder, size_t most, bat_error *error)
{
    real_family *family = family_of(folder, file);
    if (family == NULL)
        return BAT_OK;
    if (family->samplings == NULL)
        family->samplings = calloc(most, sizeof *family->samplings);
    if (family->samplings == NULL)
        return error_memory(error, most * sizeof *family->samplings);
    real_sampling *sampling = &family->samplings[family->count];
    size_t begin = strlen(family->name) + 1;
    bat_status status = copy_name(file, file + begin, strlen(file) - begin - strlen(ENDING), sampling->name, error);
    if (status == BAT_OK)
        status = read_set(path, file, &sampling->control, error);
    if (status != BAT_OK)
        return status;
    family->count++;
    return check_pair(file, &family->truth, &sampling->control, error);
}

bat_status real_folder_read(const char *path, real_folder *folder, bat_error *error)
{
    folder_list list = {.names = NULL};
    real_folder result = {.families = NULL};
    size_t samplings = 0;
    bat_status status = folder_read(path, is_curves, &list, error);
    if (status == BAT_OK && list.count > 0)
    {
        result.families = calloc(list.count, sizeof *result.families);
        status = result.families != NULL ? BAT_OK : error_memory(error, list.count * sizeof *result.families);
    }
    for (int truths = 1; truths >= 0; truths--)
        for (size_t i = 0; i < list.count && status == BAT_OK; i++)
            if (ends_with(list.names[i], TRUTH) == (truths == 1))
                status = truths == 1 ? add_truth(path, list.names[i], &result, error)
                                     : add_sampling(path, list.names[i], &result, list.count, error);
    for (size_t i = 0; i < result.count; i++)
        samplings += result.families[i].count;
    if (status == BAT_OK && samplings == 0)
        status = error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0,
                           "%s: there are no files FAMILY-truth.csv and FAMILY-SAMPLING.csv", path);
    folder_list_free(&list);
    if (status == BAT_OK)
        *folder = result;
    else
        real_folder_free(&result);
    return status;
}

void real_folder_free(real_folder *folder)
{
    for (size_t i = 0; i < folder->count; i++)
    {
        real_family *family = &folder->families[i];
        for (size_t k = 0; k < family->count; k++)
            bat_curve_set_free(&family->samplings[k].control);
        free(family->samplings);
        bat_curve_set_free(&family->truth);
    }
    free(folder->families);
    *folder = (real_folder){.families = NULL};
}

void real_curve_on_sphere(const bat_curve *curve, const bat_curve *frame, double *points)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < 2 * frame->count; i++)
    {
        low[i % 2] = fmin(low[i % 2], frame->points[i]);
        high[i % 2] = fmax(high[i % 2], frame->points[i]);
    }
    double centre[2] = {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])};
    double scale = BAT_REAL_CURVES_CAP / hypot(0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]));
    for (size_t i = 0; i < curve->count; i++)
    {
        double x = scale * (curve->points[2 * i] - centre[0]), y = scale * (curve->points[2 * i + 1] - centre[1]);
        double angle = hypot(x, y), ratio = angle > 0 ? sin(angle) / angle : 1;
        const double p[3] = {ratio * x, ratio * y, cos(angle)};
        memcpy(points + 3 * i, p, sizeof p);
    }
}
