#include "reproduce.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Liu et al. (2020), Neural Subdivision.

enum
{
    NAME_SIZE = 256,
    PATH_SIZE = 4096,
    MIN_VERTICES = 1000, ///< of shapes worth decimating
    MAX_METHODS = 4,
    BUTTERFLY = 1 ///< the reference method of the ratios
};

// Table 2

/// As printed.
static const struct
{
    const char *shape;
    double figures[2][3]; ///< Hausdorff distance, mean surface distance: of Loop, modified butterfly, neural
} PUBLISHED[] = {
    {"Cat", {{2.75, 2.17, 2.08}, {0.73, 0.21, 0.17}}},      {"David", {{2.95, 2.13, 1.83}, {0.88, 0.27, 0.20}}},
    {"Dog", {{3.26, 2.32, 2.11}, {0.84, 0.31, 0.26}}},      {"Gorilla", {{4.53, 3.17, 2.56}, {1.27, 0.48, 0.36}}},
    {"Horse", {{5.87, 4.53, 4.04}, {1.51, 0.50, 0.45}}},    {"Michael", {{3.88, 2.71, 2.24}, {1.12, 0.38, 0.28}}},
    {"Victoria", {{4.25, 3.01, 2.36}, {1.12, 0.39, 0.30}}}, {"Wolf", {{2.83, 1.74, 1.63}, {0.69, 0.23, 0.21}}},
};
/// Read a shape and repair it where needed, with a message. Returns the program's exit code.
static int read_shape(const char *path, bat_mesh *mesh)
{
    bool repaired;
    bat_mesh_repair_report report;
    if (bat_mesh_study_read(path, mesh, &repaired, &report, report_error()) != BAT_OK)
        return report_failure(path, report_error());
    if (repaired)
        (void)fprintf(stderr,
                      "batten: %s: repaired: %zu faces dropped, %zu turned over, %zu edges cut, %zu vertices split\n", path,
                      report.degenerate_faces + report.duplicate_faces, report.flipped_faces,
                      report.nonmanifold_edges + report.unorientable_edges, report.split_vertices);
    return EXIT_DONE;
}

/// State of a table.
typedef struct shape_table
{
    const reproduce_job *job;
    bat_mesh_study_options options;
    bat_mesh_method methods[MAX_METHODS];
    size_t method_count;
    report_table rows, left_out;
    double ratios[2][MAX_METHODS]; ///< sums of the ratios to butterfly: Hausdorff, mean
    size_t measured;
} shape_table;

static double figure_of(const bat_mesh_score *score, size_t which)
{
    return which == 0 ? score->hausdorff : score->mean;
}

static void print_head(const shape_table *t)
{
    report_head(&t->rows,
                "Shapes decimated to about %zu vertices and subdivided twice: distances from the original in %% of its "
                "diagonal, and\nin brackets divided by those of the butterfly.\n\nshape            vertices coarse",
                t->options.vertices);
    for (size_t which = 0; which < 2; which++)
        for (size_t i = 0; i < t->method_count; i++)
        {
            char head[NAME_SIZE];
            (void)snprintf(head, sizeof head, "%s %s", which == 0 ? "H" : "mean", t->methods[i].name);
            report_head(&t->rows, " %15s", head);
        }
    report_head(&t->rows, "\n");
}

/// Report a shape: in one line, or in a row for each method.
static void report_shape(shape_table *t, const char *name, const bat_mesh *shape, const bat_mesh *coarse,
                         const bat_mesh_score *scores)
{
    for (size_t i = 0; i < t->method_count && t->rows.as_json; i++)
        report_row(&t->rows, "",
                   "shape:s scheme:s hausdorff:n mean_distance:n diagonal:n vertices:z coarse_vertices:z fallback:z", name,
                   t->methods[i].name, scores[i].hausdorff, scores[i].mean, scores[i].diagonal, shape->vertex_count,
                   coarse->vertex_count, scores[i].fallback);
    report_head(&t->rows, "%-16s %8zu %6zu", name, shape->vertex_count, coarse->vertex_count);
    for (size_t which = 0; which < 2; which++)
        for (size_t i = 0; i < t->method_count; i++)
        {
            double ratio = figure_of(&scores[i], which) / figure_of(&scores[BUTTERFLY], which);
            t->ratios[which][i] += ratio;
            report_head(&t->rows, " %8.4f (%4.2f)", 100 * figure_of(&scores[i], which) / scores[i].diagonal, ratio);
        }
    report_head(&t->rows, "\n");
    (void)fflush(stdout);
}

/// Draw a shape: coarse, butterfly and learned subdivision, original.
static int draw(const shape_table *t, const char *name, const bat_mesh *shape, const bat_mesh *coarse, const bat_mesh *fine,
                const bat_mesh_score *scores)
{
    char file[PATH_SIZE];
    output_file picture;
    if ((size_t)snprintf(file, sizeof file, "%s.png", name) >= sizeof file)
        return report_failure(NULL, &(bat_error){.text = "the shape's name is too long"});
    int code = output_add(&t->job->call, t->job->folder, file, &picture);
    if (code != EXIT_DONE)
        return code;
    bat_status status = bat_mesh_study_draw(picture.write_to, name, shape, coarse, t->methods + BUTTERFLY, fine + BUTTERFLY,
                                            scores + BUTTERFLY, t->method_count - BUTTERFLY, 0, report_error());
    return report_status(NULL, picture.path, status);
}

static int measure_shape(shape_table *t, const char *path, const char *name, const bat_mesh *shape)
{
    bat_mesh coarse, fine[MAX_METHODS];
    bat_mesh_score scores[MAX_METHODS];
    t->options.progress = report_progress(name);
    int code = report_status(
        NULL, path,
        bat_mesh_study_shape(shape, t->methods, t->method_count, &t->options, &coarse, fine, scores, report_error()));
    if (code != EXIT_DONE)
        return code;
    if (t->measured++ == 0)
        print_head(t);
    report_shape(t, name, shape, &coarse, scores);
    if (t->job->folder != NULL)
        code = draw(t, name, shape, &coarse, fine, scores);
    bat_mesh_free(&coarse);
    for (size_t i = 0; i < t->method_count; i++)
        bat_mesh_free(&fine[i]);
    return code;
}

static int read_and_measure(shape_table *t, const char *path)
{
    char name[NAME_SIZE];
    bat_mesh shape = {0};
    (void)snprintf(name, NAME_SIZE, "%s", file_name(path));
    char *dot = strrchr(name, '.');
    if (dot != NULL && dot != name)
        *dot = '\0';
    int code = read_shape(path, &shape);
    if (code == EXIT_DONE && shape.vertex_count < MIN_VERTICES)
    {
        report_text(stderr, "batten: %s: left out: %zu vertices, %d are the least\n", path, shape.vertex_count,
                    MIN_VERTICES);
        if (t->left_out.as_json && json_array_append_new(t->left_out.rows, json_string(name)) != 0)
            code = report_failure(NULL, &(bat_error){.text = "out of memory"});
    }
    else if (code == EXIT_DONE)
        code = measure_shape(t, path, name, &shape);
    bat_mesh_free(&shape);
    return code;
}

/// Print the mean ratios to butterfly, computed and published.
static void print_ratios(const shape_table *t)
{
    const size_t rows = sizeof PUBLISHED / sizeof *PUBLISHED;
    double published[2][3] = {{0}}, count = (double)rows;
    (void)printf("mean ratio to butterfly         ");
    for (size_t which = 0; which < 2; which++)
        for (size_t i = 0; i < t->method_count; i++)
            (void)printf(" %15.3f", t->ratios[which][i] / (double)t->measured);
    (void)printf("\n\nTable 2 of Liu et al. (2020), trained on one category (other shapes; its units), with the same "
                 "ratios:\n\nshape                     H loop     H butterfly        H neural       mean loop  mean "
                 "butterfly     mean neural\n");
    for (size_t s = 0; s < sizeof PUBLISHED / sizeof *PUBLISHED; s++)
    {
        (void)printf("%-16s", PUBLISHED[s].shape);
        for (size_t i = 0; i < 6; i++)
        {
            const double *figures = PUBLISHED[s].figures[i / 3];
            double ratio = figures[i % 3] / figures[BUTTERFLY];
            published[i / 3][i % 3] += ratio / count;
            (void)printf(" %8.2f (%4.2f)", figures[i % 3], ratio);
        }
        (void)printf("\n");
    }
    (void)printf("mean ratio      ");
    for (size_t i = 0; i < 6; i++)
        (void)printf(" %15.3f", published[i / 3][i % 3]);
    (void)printf("\n");
}

static int print_table(shape_table *t, const char *const *paths, size_t count)
{
    int code = EXIT_DONE;
    t->rows = report_begin(t->job->call.json);
    t->left_out = report_begin(t->job->call.json);
    for (size_t i = 0; i < count && code == EXIT_DONE; i++)
        code = read_and_measure(t, paths[i]);
    if (code == EXIT_DONE && t->measured == 0)
        code = report_failure(NULL, &(bat_error){.text = "no shape is left to measure"});
    if (code != EXIT_DONE)
        return report_drop(&t->rows, report_drop(&t->left_out, code));
    if (!t->job->call.json)
        print_ratios(t);
    return report_print(t->job->call.json, "", "rows:o left_out:o", t->rows.rows, t->left_out.rows);
}

/// Add a learned subdivision: from a file, or the built-in one for a null path.
static int add_learned(shape_table *t, const char *name, const char *path, bat_mesh_model **model)
{
    int code = report_status(NULL, path, bat_mesh_model_read_published(path, model, report_error()));
    if (code == EXIT_DONE)
        t->methods[t->method_count++] = (bat_mesh_method){name, BAT_MESH_SCHEME_LEARNED, bat_mesh_model_rule(*model)};
    return code;
}

int reproduce_mesh_table2(const reproduce_job *job)
{
    shape_table t = {.job = job,
                     .options = bat_mesh_study_defaults(),
                     .methods = {{"loop", BAT_MESH_SCHEME_LOOP, NULL}, {"butterfly", BAT_MESH_SCHEME_BUTTERFLY, NULL}},
                     .method_count = 2};
    char **listed = NULL;
    size_t count = 0;
    bat_mesh_model *learned = NULL, *given = NULL;
    if (job->vertices > 0)
        t.options.vertices = job->vertices;
    int code = add_learned(&t, "learned", NULL, &learned);
    if (code == EXIT_DONE && job->model != NULL)
        code = add_learned(&t, "given", job->model, &given);
    if (code == EXIT_DONE && job->data != NULL)
        code = report_status(NULL, NULL, bat_mesh_study_list(job->data, &listed, &count, report_error()));
    if (code == EXIT_DONE)
        code = listed != NULL ? print_table(&t, (const char *const *)listed, count)
                              : print_table(&t, job->shapes, job->shape_count);
    for (size_t i = 0; listed != NULL && i < count; i++)
        free(listed[i]);
    free(listed);
    bat_mesh_model_free(learned);
    bat_mesh_model_free(given);
    return code;
}

// Trainings

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
        code = read_shape(job->shapes[i], &(*shapes)[i]);
    return code;
}

static void free_shapes(const reproduce_job *job, bat_mesh *shapes)
{
    for (size_t i = 0; i < job->shape_count && shapes != NULL; i++)
        bat_mesh_free(&shapes[i]);
    free(shapes);
}

static void report_variant(report_table *table, const bat_mesh_ablation_row *row)
{
    const double *kept = row->report.errors;
    const bat_mesh_score *straight = &row->straight, *turned = &row->turned;
    report_row(table,
               "{variant:-15} {level0:9.6f} {level1:9.6f} {level2:9.6f}  {100 test1:8.4f} {100 test2:8.4f}  {100 mean:8.4f} "
               "{100 H:8.4f}  {100 turned_mean:8.4f} {100 turned_H:8.4f}\n",
               "variant:s best_epoch:z kept_errors:o test_errors:o -level0:n -level1:n -level2:n -test1:n -test2:n "
               "straight.hausdorff:n "
               "straight.mean_distance:n straight.diagonal:n turned.hausdorff:n turned.mean_distance:n turned.diagonal:n "
               "-mean:n -H:n -turned_mean:n -turned_H:n",
               row->variant, (size_t)row->report.run.best_epoch, report_numbers(kept, BAT_MESH_TRAIN_LEVELS + 1),
               report_numbers(row->errors, BAT_MESH_TRAIN_LEVELS), kept[0], kept[1], kept[2], row->errors[0], row->errors[1],
               straight->hausdorff, straight->mean, straight->diagonal, turned->hausdorff, turned->mean, turned->diagonal,
               straight->mean / straight->diagonal, straight->hausdorff / straight->diagonal,
               turned->mean / turned->diagonal, turned->hausdorff / turned->diagonal);
}

static int print_ablations(const reproduce_job *job, const bat_mesh_study_options *options,
                           const bat_mesh_ablation_row *rows)
{
    report_table table = report_begin(job->call.json);
    report_head(&table,
                "Networks without one part each: %llu epochs on %zu meshes of each shape, seed %llu, stored in "
                "%s.\nValidation: root mean square errors at levels 0, 1, 2 on decimations of the training shapes, of the "
                "longest side 1 (chamfer: of that\ndistance). Test: mean distance of a vertex from its target at levels 1, "
                "2, on decimations of the test shape; then mean surface and\nHausdorff distance of that shape, decimated to "
                "%zu vertices, and of the same turned by a radian: all in %% of the diagonal.\n\nvariant          valid. 0  "
                "valid. 1  valid. 2    test 1   test 2      mean        H    turned        H\n",
                (unsigned long long)options->epochs, options->pairs, (unsigned long long)job->seed, job->folder,
                options->vertices);
    for (size_t i = 0; i < BAT_MESH_VARIANT_COUNT; i++)
        report_variant(&table, &rows[i]);
    return report_print(
        job->call.json,
        "\nThe paper: without frames a slight turn makes the network useless (figure 21): compare turned with mean. Losses "
        "on all levels help the\nlevels in between (appendix H): test 1 of last-level. learn-loop: its errors are from "
        "Loop's refinement (appendix G: visually\nindistinguishable).\n",
        "seed:z epochs:z pairs:z folder:s rows:o", (size_t)job->seed, (size_t)options->epochs, options->pairs, job->folder,
        table.rows);
}

int reproduce_mesh_ablations(const reproduce_job *job)
{
    bat_mesh_study_options options = options_of(job);
    bat_mesh_ablation_row rows[BAT_MESH_VARIANT_COUNT];
    bat_mesh *shapes = NULL;
    int code = read_shapes(job, &shapes);
    if (code == EXIT_DONE)
    {
        size_t count = job->shape_count;
        options.progress = report_progress("training");
        // A single shape is also the test shape.
        bat_status status = bat_mesh_ablate(count > 0 ? shapes : NULL, count > 1 ? count - 1 : count,
                                            count > 0 ? &shapes[count - 1] : NULL, &options, rows, report_error());
        code = report_status(NULL, NULL, status);
    }
    free_shapes(job, shapes);
    return code == EXIT_DONE ? print_ablations(job, &options, rows) : code;
}

static int print_style(const reproduce_job *job, const bat_mesh_style *style, const char *picture)
{
    static const char *const NAMES[] = {"smooth", "sharp"};
    const bat_mesh *const shapes[] = {&style->smooth, &style->sharp};
    report_table table = report_begin(job->call.json);
    report_head(&table,
                "A cage of %zu vertices, subdivided by networks that learned from a smooth and from a sharp shape; picture: "
                "%s\n\nteacher   vertices   validation 2       edges above 60 degrees\n",
                style->cage.vertex_count, picture);
    for (size_t i = 0; i < 2; i++)
        report_row(&table, "{teacher:-8} {vertices:9} {validation_error:14.6f} {100 sharp_edges:26.2f} %\n",
                   "teacher:s vertices:z validation_error:n sharp_edges:n", NAMES[i], shapes[i]->vertex_count,
                   style->reports[i].errors[BAT_MESH_TRAIN_LEVELS], style->sharp_edges[i]);
    return report_print(job->call.json, "", "picture:s rows:o", picture, table.rows);
}

int reproduce_mesh_style(const reproduce_job *job)
{
    bat_mesh_study_options options = options_of(job);
    output_file picture;
    bat_mesh_style style = {0};
    bat_mesh *shapes = NULL;
    int code = read_shapes(job, &shapes);
    if (code == EXIT_DONE)
    {
        bool given = job->shape_count > 0;
        options.progress = report_progress("training");
        bat_status status = bat_mesh_style_make(given ? &shapes[0] : NULL, given ? &shapes[1] : NULL, NULL, &options, &style,
                                                report_error());
        code = report_status(NULL, NULL, status);
    }
    if (code == EXIT_DONE)
        code = output_add(&job->call, job->folder, "style.png", &picture);
    if (code == EXIT_DONE)
        code = report_status(NULL, picture.path, bat_mesh_style_draw(picture.write_to, &style, 0, report_error()));
    if (code == EXIT_DONE)
        code = print_style(job, &style, picture.path);
    bat_mesh_style_free(&style);
    free_shapes(job, shapes);
    return code;
}
