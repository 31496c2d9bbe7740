#include "reproduce.h"

#include "report.h"
#include "terminal.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    NAME_SIZE = 256,
    PATH_SIZE = 4096,
    MIN_VERTICES = 1000, ///< of shapes worth decimating
    MAX_METHODS = 4
};

/// The reference method of the ratios.
static const size_t BUTTERFLY = 1;

// Table 2 as printed

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
enum
{
    PUBLISHED_COUNT = sizeof PUBLISHED / sizeof PUBLISHED[0]
};

// The shapes

/// The name of a file without folders and extension.
static void shape_name(const char *path, char name[NAME_SIZE])
{
    const char *slash = strrchr(path, '/');
    (void)snprintf(name, NAME_SIZE, "%s", slash != NULL ? slash + 1 : path);
    char *dot = strrchr(name, '.');
    if (dot != NULL && dot != name)
        *dot = '\0';
}

int reproduce_read_shape(const char *path, bat_mesh *mesh)
{
    bat_error error;
    bool repaired;
    bat_mesh_repair_report report;
    if (bat_mesh_study_read(path, mesh, &repaired, &report, &error) != BAT_OK)
        return report_failure(path, &error);
    if (repaired)
        (void)fprintf(stderr,
                      "batten: %s: repaired: %zu faces dropped, %zu turned over, %zu edges cut, %zu vertices split\n", path,
                      report.degenerate_faces + report.duplicate_faces, report.flipped_faces,
                      report.nonmanifold_edges + report.unorientable_edges, report.split_vertices);
    return EXIT_DONE;
}

// The table

/// State of a table.
typedef struct table
{
    const reproduce_job *job;
    bat_mesh_study_options options;
    bat_mesh_method methods[MAX_METHODS];
    size_t method_count;
    json_t *rows, *left_out;       ///< null where text is printed
    double ratios[2][MAX_METHODS]; ///< sums of the ratios to butterfly: Hausdorff, mean
    size_t measured;
} table;

static double figure_of(const bat_mesh_score *score, size_t which)
{
    return which == 0 ? score->hausdorff : score->mean;
}

static void print_head(const table *t)
{
    (void)printf("Shapes decimated to about %zu vertices and subdivided twice: distances from the original in %% of its "
                 "diagonal, and\nin brackets divided by those of the butterfly.\n\n%-16s %8s %6s",
                 t->options.vertices, "shape", "vertices", "coarse");
    for (size_t which = 0; which < 2; which++)
        for (size_t i = 0; i < t->method_count; i++)
        {
            char head[NAME_SIZE];
            (void)snprintf(head, sizeof head, "%s %s", which == 0 ? "H" : "mean", t->methods[i].name);
            (void)printf(" %15s", head);
        }
    (void)printf("\n");
}

static void print_row(const table *t, const char *name, const bat_mesh *shape, const bat_mesh *coarse,
                      const bat_mesh_score *scores)
{
    (void)printf("%-16s %8zu %6zu", name, shape->vertex_count, coarse->vertex_count);
    for (size_t which = 0; which < 2; which++)
        for (size_t i = 0; i < t->method_count; i++)
            (void)printf(" %8.4f (%4.2f)", 100 * figure_of(&scores[i], which) / scores[i].diagonal,
                         figure_of(&scores[i], which) / figure_of(&scores[BUTTERFLY], which));
    (void)printf("\n");
    (void)fflush(stdout);
}

static int add_rows(const table *t, const char *name, const bat_mesh *shape, const bat_mesh *coarse,
                    const bat_mesh_score *scores)
{
    for (size_t i = 0; i < t->method_count; i++)
    {
        json_t *row =
            json_pack("{s:s, s:s, s:o, s:o, s:o, s:I, s:I, s:I}", "shape", name, "scheme", t->methods[i].name, "hausdorff",
                      report_number(scores[i].hausdorff), "mean_distance", report_number(scores[i].mean), "diagonal",
                      report_number(scores[i].diagonal), "vertices", (json_int_t)shape->vertex_count, "coarse_vertices",
                      (json_int_t)coarse->vertex_count, "fallback", (json_int_t)scores[i].fallback);
        if (row == NULL || json_array_append_new(t->rows, row) != 0)
            return report_failure(NULL, &(bat_error){.text = "out of memory"});
    }
    return EXIT_DONE;
}

/// Draw a shape: coarse, butterfly and learned subdivision, original.
static int draw(const table *t, const char *name, const bat_mesh *shape, const bat_mesh *coarse, const bat_mesh *fine,
                const bat_mesh_score *scores)
{
    char file[PATH_SIZE];
    reproduce_picture picture;
    bat_error error;
    if ((size_t)snprintf(file, sizeof file, "%s.png", name) >= sizeof file)
        return report_failure(NULL, &(bat_error){.text = "the shape's name is too long"});
    int code = reproduce_picture_add(t->job, file, &picture);
    if (code != EXIT_DONE)
        return code;
    if (bat_mesh_study_draw(picture.write_to, name, shape, coarse, t->methods + BUTTERFLY, fine + BUTTERFLY,
                            scores + BUTTERFLY, t->method_count - BUTTERFLY, 0, &error) != BAT_OK)
        return report_failure(picture.path, &error);
    return EXIT_DONE;
}

static int measure_shape(table *t, const char *path, const char *name, const bat_mesh *shape)
{
    bat_mesh coarse, fine[MAX_METHODS];
    bat_mesh_score scores[MAX_METHODS];
    bat_error error;
    t->options.progress = report_progress(name);
    bat_status status = bat_mesh_study_shape(shape, t->methods, t->method_count, &t->options, &coarse, fine, scores, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(path, &error);
    for (size_t which = 0; which < 2; which++)
        for (size_t i = 0; i < t->method_count; i++)
            t->ratios[which][i] += figure_of(&scores[i], which) / figure_of(&scores[BUTTERFLY], which);
    if (t->measured++ == 0 && !t->job->call.json)
        print_head(t);
    int code = EXIT_DONE;
    if (t->job->call.json)
        code = add_rows(t, name, shape, &coarse, scores);
    else
        print_row(t, name, shape, &coarse, scores);
    if (code == EXIT_DONE && t->job->folder != NULL)
        code = draw(t, name, shape, &coarse, fine, scores);
    bat_mesh_free(&coarse);
    for (size_t i = 0; i < t->method_count; i++)
        bat_mesh_free(&fine[i]);
    return code;
}

static int read_and_measure(table *t, const char *path)
{
    char name[NAME_SIZE];
    bat_mesh shape = {0};
    shape_name(path, name);
    int code = reproduce_read_shape(path, &shape);
    if (code == EXIT_DONE && shape.vertex_count < MIN_VERTICES)
    {
        terminal_print(stderr, "batten: %s: left out: %zu vertices, %d are the least\n", path, shape.vertex_count,
                       MIN_VERTICES);
        if (t->job->call.json && json_array_append_new(t->left_out, json_string(name)) != 0)
            code = report_failure(NULL, &(bat_error){.text = "out of memory"});
    }
    else if (code == EXIT_DONE)
        code = measure_shape(t, path, name, &shape);
    bat_mesh_free(&shape);
    return code;
}

/// Print the mean ratios to butterfly, computed and published.
static void print_ratios(const table *t)
{
    double published[2][3] = {{0}};
    (void)printf("%-32s", "mean ratio to butterfly");
    for (size_t which = 0; which < 2; which++)
        for (size_t i = 0; i < t->method_count; i++)
            (void)printf(" %15.3f", t->ratios[which][i] / (double)t->measured);
    (void)printf(
        "\n\nTable 2 of Liu et al. (2020), trained on one category (other shapes; its units), with the same ratios:\n\n"
        "%-16s %15s %15s %15s %15s %15s %15s\n",
        "shape", "H loop", "H butterfly", "H neural", "mean loop", "mean butterfly", "mean neural");
    for (size_t s = 0; s < PUBLISHED_COUNT; s++)
    {
        (void)printf("%-16s", PUBLISHED[s].shape);
        for (size_t which = 0; which < 2; which++)
            for (size_t i = 0; i < 3; i++)
            {
                double ratio = PUBLISHED[s].figures[which][i] / PUBLISHED[s].figures[which][BUTTERFLY];
                published[which][i] += ratio / PUBLISHED_COUNT;
                (void)printf(" %8.2f (%4.2f)", PUBLISHED[s].figures[which][i], ratio);
            }
        (void)printf("\n");
    }
    (void)printf("%-16s", "mean ratio");
    for (size_t which = 0; which < 2; which++)
        for (size_t i = 0; i < 3; i++)
            (void)printf(" %15.3f", published[which][i]);
    (void)printf("\n");
}

static int print_table(table *t, const char *const *paths, size_t count)
{
    int code = EXIT_DONE;
    for (size_t i = 0; i < count && code == EXIT_DONE; i++)
        code = read_and_measure(t, paths[i]);
    if (code == EXIT_DONE && t->measured == 0)
        code = report_failure(NULL, &(bat_error){.text = "no shape is left to measure"});
    if (code == EXIT_DONE && t->job->call.json)
        return report_json(json_pack("{s:O, s:O}", "rows", t->rows, "left_out", t->left_out));
    if (code == EXIT_DONE)
        print_ratios(t);
    return code;
}

/// Add a learned subdivision: from a file, or the built-in one for a null path.
static int add_learned(table *t, const char *name, const char *path, bat_mesh_model **model)
{
    bat_error error;
    bat_status status = bat_mesh_model_read_published(path, model, &error);
    if (status != BAT_OK)
        return report_failure(path, &error);
    t->methods[t->method_count++] = (bat_mesh_method){name, BAT_MESH_SCHEME_LEARNED, bat_mesh_model_rule(*model)};
    return EXIT_DONE;
}

int reproduce_mesh_table2(const reproduce_job *job)
{
    table t = {.job = job,
               .options = bat_mesh_study_defaults(),
               .methods = {{"loop", BAT_MESH_SCHEME_LOOP, NULL}, {"butterfly", BAT_MESH_SCHEME_BUTTERFLY, NULL}},
               .method_count = 2};
    char **listed = NULL;
    size_t count = 0;
    bat_error error;
    bat_mesh_model *learned = NULL, *given = NULL;
    if (job->vertices > 0)
        t.options.vertices = job->vertices;
    int code = add_learned(&t, "learned", NULL, &learned);
    if (code == EXIT_DONE && job->model != NULL)
        code = add_learned(&t, "given", job->model, &given);
    if (code == EXIT_DONE && job->data != NULL && bat_mesh_study_list(job->data, &listed, &count, &error) != BAT_OK)
        code = report_failure(NULL, &error);
    if (code == EXIT_DONE && job->call.json && ((t.rows = json_array()) == NULL || (t.left_out = json_array()) == NULL))
        code = report_failure(NULL, &(bat_error){.text = "out of memory"});
    if (code == EXIT_DONE)
        code = listed != NULL ? print_table(&t, (const char *const *)listed, count)
                              : print_table(&t, job->shapes, job->shape_count);
    json_decref(t.rows);
    json_decref(t.left_out);
    for (size_t i = 0; i < count; i++)
        free(listed[i]);
    free(listed);
    bat_mesh_model_free(learned);
    bat_mesh_model_free(given);
    return code;
}
