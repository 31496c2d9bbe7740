#include "reproduce.h"

#include "arguments.h"
#include "report.h"

#include <math.h>
#include <stdio.h>

int reproduce_model(const reproduce_job *job, bat_curve_model **model)
{
    bat_error error;
    bat_status status =
        job->model != NULL ? bat_curve_model_read(job->model, model, &error) : bat_curve_model_published(model, &error);
    return status == BAT_OK ? EXIT_DONE : report_failure(job->model, &error);
}

void reproduce_print_figure(double ours, double published, int width)
{
    (void)printf(" %*.5g", width, ours);
    if (isfinite(published))
        (void)printf(" (%5.3f)", ours / published);
    else
        (void)printf(" %7s", "");
}

void reproduce_set_number(json_t *object, const char *key, double value)
{
    if (isfinite(value))
        (void)json_object_set_new(object, key, report_number(value));
}

int reproduce_path(const char *folder, const char *file, char path[REPRODUCE_PATH_SIZE])
{
    int length = snprintf(path, REPRODUCE_PATH_SIZE, "%s/%s", folder, file);
    if (length < 0 || length >= REPRODUCE_PATH_SIZE)
        return report_failure(NULL, &(bat_error){.text = "the folder's name is too long"});
    return EXIT_DONE;
}

int reproduce_picture_add(const reproduce_job *job, const char *name, reproduce_picture *picture)
{
    bat_error error;
    int code = reproduce_path(job->folder, name, picture->path);
    if (code == EXIT_DONE && bat_outputs_add(job->files, picture->path, &picture->write_to, &error) != BAT_OK)
        code = report_failure(picture->path, &error);
    return code;
}
