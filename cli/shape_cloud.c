#include "shape_cloud.h"

#include "arguments.h"
#include "report.h"

#include "batten/batten.h"

#include <stdio.h>
#include <string.h>

static const struct
{
    const char *name, *summary;
} KINDS[] = {
    {"hull", "a cloud: a ship's side with knuckle and bulb, boundary first"},
    {"blade", "a cloud: a turbine blade round its leading edge, boundary first"},
    {"scan", "a cloud: a relief with noise, uneven density and a gap, in no order, as a hand-held scanner gives it"},
};

bool shape_cloud_row(size_t index, const char **name, const char **summary)
{
    if (index >= sizeof KINDS / sizeof KINDS[0])
        return false;
    *name = KINDS[index].name;
    *summary = KINDS[index].summary;
    return true;
}

bool shape_cloud_is_kind(const char *name)
{
    const char *kind, *summary;
    for (size_t i = 0; shape_cloud_row(i, &kind, &summary); i++)
        if (strcmp(kind, name) == 0)
            return true;
    return false;
}

static int write_files(const shape_cloud_job *job, const bat_cloud *cloud)
{
    bat_error error;
    bat_surface_panel panel = {.title = job->kind, .cloud = cloud};
    if (job->picture != NULL && bat_surface_picture_write(job->picture, &panel, 1, NULL, &error) != BAT_OK)
        return report_failure(job->picture, &error);
    if (job->output != NULL && bat_cloud_write(job->output, cloud, &error) != BAT_OK)
        return report_failure(job->output, &error);
    return EXIT_DONE;
}

static int report(const shape_cloud_job *job, const bat_cloud *cloud)
{
    if (job->json)
        return report_json(json_pack("{s:s, s:I, s:I, s:I}", "shape", job->kind, "seed", (json_int_t)job->seed, "points",
                                     (json_int_t)cloud->count, "boundary", (json_int_t)cloud->boundary_count));
    if (job->quiet)
        return EXIT_DONE;
    (void)printf("%s: %zu points", job->kind, cloud->count);
    if (cloud->boundary_count > 0)
        (void)printf(", the first %zu of them its boundary", cloud->boundary_count);
    (void)printf("\n");
    return EXIT_DONE;
}

int shape_cloud_make(const shape_cloud_job *job)
{
    bat_cloud cloud;
    bat_error error;
    if (bat_cloud_shape(job->kind, job->points, job->seed, &cloud, NULL, &error) != BAT_OK)
        return report_failure(NULL, &error);
    int code = write_files(job, &cloud);
    if (code == EXIT_DONE)
        code = report(job, &cloud);
    bat_cloud_free(&cloud);
    return code;
}
