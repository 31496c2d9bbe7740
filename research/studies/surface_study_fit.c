#include "batten/research/surface_study.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/surface_picture.h"

#include <stdio.h>
#include <stdlib.h>

enum
{
    TITLE_SIZE = 160
};

void bat_surface_trial_free(bat_surface_trial *trial)
{
    bat_surface_result_free(&trial->result);
    *trial = (bat_surface_trial){0};
}

bat_status bat_surface_study_fit(const bat_cloud *cloud, const bat_surface_method *method,
                                 const bat_surface_fit_options *fit, bat_surface_trial *trial, bat_error *error)
{
    bat_surface_options options = bat_surface_defaults();
    options.fit = *fit;
    options.parameters = method->parameters;
    options.published = method->published;
    options.model = method->model;
    options.no_repair = !method->unfolded;
    bat_surface_trial made = {0};
    bat_cloud copy;
    bat_status status = bat_cloud_copy(cloud, &copy, error);
    if (status != BAT_OK)
        return status;
    status = bat_surface_reconstruct(&copy, &options, &made.result, error);
    if (status == BAT_NO_CONVERGENCE && options.published)
    {
        options.published = false;
        made.own = true;
        status = bat_surface_reconstruct(&copy, &options, &made.result, error);
    }
    bat_cloud_free(&copy);
    if (status == BAT_OK)
        *trial = made;
    return status;
}

bat_status bat_surface_study_draw(const char *path, const bat_cloud *cloud, const bat_surface_method *methods,
                                  const bat_surface_trial *trials, size_t count, bat_error *error)
{
    bat_surface_picture_row *rows = memory_array(count, sizeof *rows);
    char(*titles)[TITLE_SIZE] = memory_array(count, sizeof *titles);
    if (rows == NULL || titles == NULL)
    {
        free(rows);
        free(titles);
        return error_memory(error, count * sizeof *titles);
    }
    for (size_t i = 0; i < count; i++)
    {
        const bat_surface_result *result = &trials[i].result;
        (void)snprintf(titles[i], TITLE_SIZE, "%s parameters", methods[i].name);
        rows[i] = (bat_surface_picture_row){.title = titles[i],
                                            .cloud = cloud,
                                            .surface = &result->surface,
                                            .distances = result->report.distances,
                                            .parameters = result->parameters};
    }
    bat_status status = bat_surface_picture_write(path, rows, count, NULL, error);
    free(rows);
    free(titles);
    return status;
}
