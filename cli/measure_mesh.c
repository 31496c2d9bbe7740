#include "measure.h"

#include "report.h"

#include "batten/batten.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool measure_means_meshes(const arguments *given, bat_error *failure)
{
    bat_mesh_format format;
    const bat_choice *row;
    const char *from = argument(given, "from");
    if (argument_flag(given, "mesh"))
        return true;
    if (from != NULL && bat_choice_find(&bat_mesh_format_family, from, &row, NULL) == BAT_OK &&
        bat_choice_find(&bat_curve_format_family, from, &row, NULL) != BAT_OK)
        return true;
    for (size_t i = 0; i < given->positional_count; i++)
    {
        const char *path = given->positional[i];
        const bat_choice *mesh, *curves;
        (void)bat_choice_of_path(&bat_mesh_format_family, path, false, &mesh, NULL);
        (void)bat_choice_of_path(&bat_curve_format_family, path, false, &curves, NULL);
        if (mesh == NULL && curves != NULL)
            return false;
        if (bat_mesh_format_of_file(path, &format, failure) != BAT_OK)
            return false;
        if (format != BAT_MESH_FORMAT_AUTO)
            return true;
    }
    return false;
}

static json_t *row_json(const bat_measure *at, const char *base)
{
    const void *value = base + at->offset;
    switch (at->form)
    {
    case BAT_MEASURE_COUNT:
        return json_integer((json_int_t) * (const size_t *)value);
    case BAT_MEASURE_SIGNED:
        return json_integer((json_int_t) * (const int64_t *)value);
    case BAT_MEASURE_GENUS:
        return *(const int64_t *)value < 0 ? json_null() : json_integer((json_int_t) * (const int64_t *)value);
    case BAT_MEASURE_FLAG:
        return json_boolean(*(const bool *)value);
    case BAT_MEASURE_POINT:
    {
        const double *point = value;
        return json_pack("[o, o, o]", report_number(point[0]), report_number(point[1]), report_number(point[2]));
    }
    case BAT_MEASURE_LENGTH:
    case BAT_MEASURE_NUMBER:
        break;
    }
    return report_number(*(const double *)value);
}

static void print_row(const bat_measure *at, const char *base, double diagonal)
{
    const void *value = base + at->offset;
    const double *numbers = value;
    (void)printf("%-38s ", at->title);
    switch (at->form)
    {
    case BAT_MEASURE_COUNT:
        (void)printf("%14zu\n", *(const size_t *)value);
        break;
    case BAT_MEASURE_SIGNED:
        (void)printf("%14lld\n", (long long)*(const int64_t *)value);
        break;
    case BAT_MEASURE_GENUS:
        if (*(const int64_t *)value < 0)
            (void)printf("%14s\n", "none");
        else
            (void)printf("%14lld\n", (long long)*(const int64_t *)value);
        break;
    case BAT_MEASURE_FLAG:
        (void)printf("%14s\n", *(const bool *)value ? "yes" : "no");
        break;
    case BAT_MEASURE_POINT:
        (void)printf("%14.8g %14.8g %14.8g\n", numbers[0], numbers[1], numbers[2]);
        break;
    case BAT_MEASURE_NUMBER:
        if (isnan(*numbers))
            (void)printf("%14s\n", "none");
        else
            (void)printf("%14.8g\n", *numbers);
        break;
    case BAT_MEASURE_LENGTH:
        (void)printf("%14.8g %14.8g\n", *numbers, *numbers / diagonal);
        break;
    }
}

/// Report the measures of one mesh or of two.
static int report_measures(size_t meshes, const void *base, double diagonal, bool as_json)
{
    bat_measure measure;
    json_t *object = as_json ? json_object() : NULL;
    for (size_t i = 0; bat_mesh_measures(meshes, i, &measure); i++)
        if (!as_json)
            print_row(&measure, base, diagonal);
        else if (object != NULL && json_object_set_new(object, measure.name, row_json(&measure, base)) != 0)
        {
            json_decref(object);
            object = NULL;
        }
    return as_json ? report_json(object) : EXIT_DONE;
}

/// What stands behind a path's last slash; null for no path.
static const char *file_name(const char *path)
{
    const char *slash = path == NULL ? NULL : strrchr(path, '/');
    return slash == NULL ? path : slash + 1;
}

/// Draw both meshes, coloured by how far their vertices are from the other.
static int draw_distances(measure_job *job)
{
    const bat_mesh *meshes = job->meshes;
    double diagonal = job->distance.diagonal;
    bat_error error = {.text = "out of memory"};
    bat_mesh_picture_panel panels[2];
    double *shares[2] = {NULL, NULL};
    bat_status status = BAT_OK;
    for (size_t i = 0; i < 2 && status == BAT_OK; i++)
    {
        const bat_mesh *mesh = &meshes[i];
        shares[i] = calloc(mesh->vertex_count, sizeof *shares[i]);
        status = shares[i] == NULL
                     ? BAT_NO_MEMORY
                     : bat_mesh_vertex_distances(mesh, &meshes[1 - i], job->compare.threads, shares[i], &error);
        for (size_t v = 0; v < mesh->vertex_count && status == BAT_OK; v++)
            shares[i][v] *= 100 / diagonal;
        panels[i] = (bat_mesh_picture_panel){.mesh = mesh, .values = shares[i], .title = file_name(job->paths[i])};
    }
    bat_mesh_picture_options options = bat_mesh_picture_defaults();
    options.threads = job->compare.threads;
    options.value_label = "distance, % of the diagonal";
    if (status == BAT_OK)
        status = bat_mesh_picture_write(output_path(&job->call.files, "picture"), panels, 2, &options, &error);
    free(shares[0]);
    free(shares[1]);
    return status == BAT_OK ? EXIT_DONE : report_failure(job->call.picture, &error);
}

const char *measure_file_at_fault(const char *const paths[2], const bat_error *error)
{
    return error->operand == 0 || paths[1] == NULL ? paths[0] : paths[1];
}

static int compare(measure_job *job)
{
    bat_error error;
    bat_mesh_compare_options how = job->compare;
    how.progress = report_progress("measuring distances");
    bat_status status = bat_mesh_compare(&job->meshes[0], &job->meshes[1], &how, &job->distance, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(measure_file_at_fault(job->paths, &error), &error);
    return job->call.picture != NULL ? draw_distances(job) : EXIT_DONE;
}

int measure_meshes(measure_job *job)
{
    bat_error error;
    for (size_t i = 0; i < 2 && job->paths[i] != NULL; i++)
        if (bat_mesh_read(job->paths[i], &job->read_mesh, &job->meshes[i], &error) != BAT_OK)
            return report_bad_input(job->call.given, job->paths[i], &error);
    if (job->paths[1] != NULL)
        return compare(job);
    return bat_mesh_summarize(&job->meshes[0], &job->summary, &error) == BAT_OK ? EXIT_DONE
                                                                                : report_failure(job->paths[0], &error);
}

int measure_report_meshes(const measure_job *job)
{
    if (job->paths[1] == NULL)
        return report_measures(1, &job->summary, job->summary.diagonal, job->call.json);
    if (!job->call.json)
        (void)printf("%-38s %14s %14s\n", "", "", "of B's diagonal");
    return report_measures(2, &job->distance, job->distance.diagonal, job->call.json);
}

bool measure_check_meshes(measure_job *job)
{
    static const char *const FOR_CURVES[] = {"geodesic", "to-segments", "space", "closed", "open", "project", NULL};
    static const char *const FOR_TWO[] = {"at-vertices", "samples", "accuracy", "picture", NULL};
    const arguments *given = job->call.given;
    bat_error error;
    job->compare.threads = job->call.threads;
    if (argument_first(given, FOR_CURVES) != NULL)
        (void)usage_error(given, "--%s is for curves, but %s is a mesh", argument_first(given, FOR_CURVES), job->call.input);
    else if (argument_first(given, FOR_TWO) != NULL && job->paths[1] == NULL)
        (void)usage_error(given, "--%s needs a second file to measure the distance from", argument_first(given, FOR_TWO));
    else
        return argument_choice(given, "from", &bat_mesh_format_family, &job->read_mesh.format) &&
               usage_accepts(given, bat_options_check(&bat_mesh_compare_fields, &job->compare, &error), &error);
    return false;
}
