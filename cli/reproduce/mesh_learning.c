#include "reproduce.h"

#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>
#include <stdlib.h>

static bat_mesh_study_options options_of(const reproduce_job *job)
{
    bat_mesh_study_options options = bat_mesh_study_defaults();
    options.seed = job->seed;
    options.folder = job->folder;
    if (job->epochs > 0)
        options.epochs = job->epochs;
    if (job->pairs > 0)
        options.pairs = job->pairs;
    return options;
}

/// Read the given shapes; release them with free_shapes(). Returns the exit code.
static int read_shapes(const reproduce_job *job, bat_mesh **shapes)
{
    *shapes = calloc(job->shape_count + 1, sizeof **shapes);
    if (*shapes == NULL)
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    int code = EXIT_DONE;
    for (size_t i = 0; i < job->shape_count && code == EXIT_DONE; i++)
        code = reproduce_read_shape(job->shapes[i], &(*shapes)[i]);
    return code;
}

static void free_shapes(const reproduce_job *job, bat_mesh *shapes)
{
    for (size_t i = 0; i < job->shape_count && shapes != NULL; i++)
        bat_mesh_free(&shapes[i]);
    free(shapes);
}

static json_t *numbers_json(const double *numbers, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count && array != NULL; i++)
        (void)json_array_append_new(array, report_number(numbers[i]));
    return array;
}

// Ablation of the network

static json_t *score_json(const bat_mesh_score *score)
{
    return json_pack("{s:o, s:o, s:o}", "hausdorff", report_number(score->hausdorff), "mean_distance",
                     report_number(score->mean), "diagonal", report_number(score->diagonal));
}

static int print_ablations_json(const reproduce_job *job, const bat_mesh_study_options *options,
                                const bat_mesh_ablation_row *rows)
{
    json_t *array = json_array();
    for (size_t i = 0; i < BAT_MESH_VARIANT_COUNT; i++)
        (void)json_array_append_new(array,
                                    json_pack("{s:s, s:I, s:o, s:o, s:o, s:o}", "variant", rows[i].variant, "best_epoch",
                                              (json_int_t)rows[i].report.run.best_epoch, "kept_errors",
                                              numbers_json(rows[i].report.errors, BAT_MESH_TRAIN_LEVELS + 1), "test_errors",
                                              numbers_json(rows[i].errors, BAT_MESH_TRAIN_LEVELS), "straight",
                                              score_json(&rows[i].straight), "turned", score_json(&rows[i].turned)));
    return report_json(json_pack("{s:I, s:I, s:I, s:s, s:o}", "seed", (json_int_t)job->seed, "epochs",
                                 (json_int_t)options->epochs, "pairs", (json_int_t)options->pairs, "folder", job->folder,
                                 "rows", array));
}

static void print_score(const bat_mesh_score *score)
{
    (void)printf(" %8.4f %8.4f", 100 * score->mean / score->diagonal, 100 * score->hausdorff / score->diagonal);
}

static int print_ablations(const reproduce_job *job, const bat_mesh_study_options *options,
                           const bat_mesh_ablation_row *rows)
{
    (void)printf(
        "Networks without one part each: %llu epochs on %zu meshes of each shape, seed %llu, stored in %s.\n"
        "Validation: root mean square errors at levels 0, 1, 2 on decimations of the training shapes, of the longest side 1 "
        "(chamfer: of that\ndistance). Test: mean distance of a vertex from its target at levels 1, 2, on decimations of "
        "the test shape; then mean surface and\nHausdorff distance of that shape, decimated to %zu vertices, and of the "
        "same turned by a radian: all in %% of the diagonal.\n\n%-15s %9s %9s %9s  %8s %8s  %8s %8s  %8s %8s\n",
        (unsigned long long)options->epochs, options->pairs, (unsigned long long)job->seed, job->folder, options->vertices,
        "variant", "valid. 0", "valid. 1", "valid. 2", "test 1", "test 2", "mean", "H", "turned", "H");
    for (size_t i = 0; i < BAT_MESH_VARIANT_COUNT; i++)
    {
        const bat_mesh_ablation_row *row = &rows[i];
        (void)printf("%-15s %9.6f %9.6f %9.6f  %8.4f %8.4f ", row->variant, row->report.errors[0], row->report.errors[1],
                     row->report.errors[2], 100 * row->errors[0], 100 * row->errors[1]);
        print_score(&row->straight);
        (void)printf(" ");
        print_score(&row->turned);
        (void)printf("\n");
    }
    (void)printf(
        "\nThe paper: without frames a slight turn makes the network useless (figure 21): compare turned with mean. Losses "
        "on "
        "all levels help the\nlevels in between (appendix H): test 1 of last-level. learn-loop: its errors are from Loop's "
        "refinement (appendix G: visually\nindistinguishable).\n");
    return EXIT_DONE;
}

int reproduce_mesh_ablations(const reproduce_job *job)
{
    bat_mesh_study_options options = options_of(job);
    bat_mesh_ablation_row rows[BAT_MESH_VARIANT_COUNT];
    bat_mesh *shapes = NULL;
    bat_error error;
    int code = read_shapes(job, &shapes);
    if (code == EXIT_DONE)
    {
        size_t count = job->shape_count;
        options.progress = report_progress("training");
        // A single shape is also the test shape.
        bat_status status = bat_mesh_ablate(count > 0 ? shapes : NULL, count > 1 ? count - 1 : count,
                                            count > 0 ? &shapes[count - 1] : NULL, &options, rows, &error);
        report_progress_end();
        if (status != BAT_OK)
            code = report_failure(NULL, &error);
    }
    free_shapes(job, shapes);
    if (code != EXIT_DONE)
        return code;
    return job->call.json ? print_ablations_json(job, &options, rows) : print_ablations(job, &options, rows);
}

// Style

static int print_style(const reproduce_job *job, const bat_mesh_style *style, const char *picture)
{
    static const char *const NAMES[] = {"smooth", "sharp"};
    const bat_mesh *const shapes[] = {&style->smooth, &style->sharp};
    json_t *rows = json_array();
    if (!job->call.json)
        (void)printf("A cage of %zu vertices, subdivided by networks that learned from a smooth and from a sharp shape; "
                     "picture: %s\n\n%-8s %9s %14s %28s\n",
                     style->cage.vertex_count, picture, "teacher", "vertices", "validation 2", "edges above 60 degrees");
    for (size_t i = 0; i < 2; i++)
    {
        double validation = style->reports[i].errors[BAT_MESH_TRAIN_LEVELS];
        if (!job->call.json)
            (void)printf("%-8s %9zu %14.6f %26.2f %%\n", NAMES[i], shapes[i]->vertex_count, validation,
                         100 * style->sharp_edges[i]);
        (void)json_array_append_new(rows, json_pack("{s:s, s:I, s:o, s:o}", "teacher", NAMES[i], "vertices",
                                                    (json_int_t)shapes[i]->vertex_count, "validation_error",
                                                    report_number(validation), "sharp_edges",
                                                    report_number(style->sharp_edges[i])));
    }
    if (job->call.json)
        return report_json(json_pack("{s:s, s:o}", "picture", picture, "rows", rows));
    json_decref(rows);
    return EXIT_DONE;
}

int reproduce_mesh_style(const reproduce_job *job)
{
    bat_mesh_study_options options = options_of(job);
    reproduce_picture picture;
    bat_mesh_style style = {0};
    bat_mesh *shapes = NULL;
    bat_error error;
    int code = read_shapes(job, &shapes);
    if (code == EXIT_DONE)
    {
        bool given = job->shape_count > 0;
        options.progress = report_progress("training");
        bat_status status =
            bat_mesh_style_make(given ? &shapes[0] : NULL, given ? &shapes[1] : NULL, NULL, &options, &style, &error);
        report_progress_end();
        code = status == BAT_OK ? reproduce_picture_add(job, "style.png", &picture) : report_failure(NULL, &error);
        if (code == EXIT_DONE && bat_mesh_style_draw(picture.write_to, &style, 0, &error) != BAT_OK)
            code = report_failure(picture.path, &error);
        if (code == EXIT_DONE)
            code = print_style(job, &style, picture.path);
    }
    bat_mesh_style_free(&style);
    free_shapes(job, shapes);
    return code;
}
