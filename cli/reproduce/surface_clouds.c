#include "reproduce.h"

#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int out_of_memory(void)
{
    return report_failure(NULL, &(bat_error){.text = "out of memory"});
}

static bat_surface_study_options study_options(const reproduce_job *job)
{
    bat_surface_study_options options = bat_surface_study_defaults();
    options.seed = job->seed;
    if (job->clouds > 0)
        options.clouds = job->clouds;
    return options;
}

static json_t *score_json(const bat_surface_case *what, const char *method, const bat_surface_score *score)
{
    return json_pack("{s:I, s:f, s:i, s:s, s:o, s:o, s:o, s:I}", "points", (json_int_t)what->points, "noise", what->noise,
                     "degree", what->degree, "method", method, "mse", report_number(score->mse), "excess",
                     report_number(score->excess), "seconds", report_number(score->seconds), "succeeded",
                     (json_int_t)score->succeeded);
}

/// The methods of the figures, followed by additional ones.
static const bat_surface_method METHODS[] = {
    {"uniform", BAT_SURFACE_PARAMETERS_UNIFORM, true, NULL, false},
    {"inverse-distance", BAT_SURFACE_PARAMETERS_INVERSE_DISTANCE, true, NULL, false},
    {"shape-preserving", BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING, true, NULL, false},
    {"learned", BAT_SURFACE_PARAMETERS_LEARNED, false, NULL, false},
    {"uniform-own", BAT_SURFACE_PARAMETERS_UNIFORM, false, NULL, false},
    {"inverse-distance-own", BAT_SURFACE_PARAMETERS_INVERSE_DISTANCE, false, NULL, false},
    {"shape-preserving-own", BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING, false, NULL, false},
    {"stretch-minimizing", BAT_SURFACE_PARAMETERS_STRETCH_MINIMIZING, false, NULL, false},
};
enum
{
    METHOD_COUNT = sizeof METHODS / sizeof METHODS[0],
    SHAPE_PRESERVING = 2, ///< index in METHODS
    LEARNED = 3
};

/// State of the table.
typedef struct table
{
    const reproduce_job *job;
    bat_surface_study_options options;
    bat_surface_method methods[METHOD_COUNT];
    json_t *rows; ///< null for text output
} table;

static void print_head(const table *t, double degree, double noise)
{
    (void)printf("\nbidegree (%g, %g), noise %g: means over those of %zu clouds that could be parameterized\n\n"
                 "%6s %-22s %11s %11s %9s %11s %9s\n",
                 degree, degree, noise, t->options.clouds, "points", "method", "mse", "excess", "(ratio)", "milliseconds",
                 "succeeded");
}

/// The ratio is meaningful only if both excesses are positive: parameters that fit the noise leave smaller errors than the
/// true ones.
static void print_score(const bat_surface_score *score, const bat_surface_score *reference)
{
    char ratio[16] = "";
    if (score->excess > 0 && reference->excess > 0)
        (void)snprintf(ratio, sizeof ratio, "(%7.3f)", score->excess / reference->excess);
    if (score->succeeded == 0)
        (void)printf(" %11s %11s %9s %12s", "-", "-", "", "-");
    else
        (void)printf(" %11.4g %11.4g %9s %12.3f", score->mse, score->excess, ratio, 1e3 * score->seconds);
}

static void print_case(const table *t, const bat_surface_case *what, const bat_surface_score *scores)
{
    for (size_t m = 0; m < METHOD_COUNT; m++)
    {
        (void)printf("%6zu %-22s", what->points, t->methods[m].name);
        print_score(&scores[m], &scores[SHAPE_PRESERVING]);
        (void)printf(" %9zu\n", scores[m].succeeded);
    }
    (void)fflush(stdout);
}

static int run_case(const table *t, const bat_surface_case *what)
{
    char label[80];
    bat_error error;
    bat_surface_score scores[METHOD_COUNT];
    bat_surface_study_options options = t->options;
    (void)snprintf(label, sizeof label, "%zu points, noise %g, bidegree %d", what->points, what->noise, what->degree);
    options.progress = report_progress(label);
    bat_status status = bat_surface_study_clouds(what, t->methods, METHOD_COUNT, &options, scores, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    for (size_t m = 0; m < METHOD_COUNT && t->rows != NULL; m++)
        if (json_array_append_new(t->rows, score_json(what, t->methods[m].name, &scores[m])) != 0)
            return out_of_memory();
    if (t->rows == NULL)
        print_case(t, what, scores);
    return EXIT_DONE;
}

static int run_cases(const table *t)
{
    static const number_list POINTS = {{50, 100, 200, 500, 1000, 2000, 5000}, 7}, NOISES = {{0, 0.005, 0.01, 0.05}, 4},
                             DEGREES = {{2, 3, 4, 5}, 4};
    const number_list *points = t->job->points.count > 0 ? &t->job->points : &POINTS;
    const number_list *noises = t->job->noises.count > 0 ? &t->job->noises : &NOISES;
    const number_list *degrees = t->job->degrees.count > 0 ? &t->job->degrees : &DEGREES;
    int code = EXIT_DONE;
    for (size_t d = 0; d < degrees->count; d++)
        for (size_t n = 0; n < noises->count; n++)
        {
            if (t->rows == NULL)
                print_head(t, degrees->numbers[d], noises->numbers[n]);
            for (size_t p = 0; p < points->count && code == EXIT_DONE; p++)
                code = run_case(
                    t, &(bat_surface_case){(size_t)points->numbers[p], noises->numbers[n], (int)degrees->numbers[d]});
        }
    return code;
}

static void print_claims(void)
{
    (void)printf(
        "\nErrors are in the unit box of each cloud; excess is less those with the true parameters, negative where "
        "parameters "
        "follow\nthe noise; the ratio is to the excess of the published shape-preserving parameters; times are of one "
        "thread.\n\n"
        "What Giannelli et al. (2023) say, in figures without numbers:\n"
        "  figure 5, no noise      learned about as good as shape-preserving, both much better than the others; two orders\n"
        "                          of magnitude faster than shape-preserving\n"
        "  figure 5, noise         learned much better than all others\n"
        "  figures 6 and 7         noise 0.05: learned always succeeds, the others often fail on few points\n"
        "  figures 8 and 9         higher degrees: about the same without noise, learned better with noise 0.01\n");
}

int reproduce_surface_clouds(const reproduce_job *job)
{
    table t = {.job = job, .options = study_options(job)};
    bat_surface_model *model = NULL;
    bat_error error;
    bat_status status = bat_surface_model_read_published(job->model, &model, &error);
    if (status != BAT_OK)
        return report_failure(job->model, &error);
    memcpy(t.methods, METHODS, sizeof METHODS);
    t.methods[LEARNED].model = model;
    if (job->call.json)
        t.rows = json_array();
    int code = job->call.json && t.rows == NULL ? out_of_memory() : run_cases(&t);
    if (code == EXIT_DONE && job->call.json)
        code = report_json(json_pack("{s:I, s:I, s:O}", "clouds", (json_int_t)t.options.clouds, "seed",
                                     (json_int_t)t.options.seed, "rows", t.rows));
    else if (code == EXIT_DONE)
        print_claims();
    json_decref(t.rows);
    bat_surface_model_free(model);
    return code;
}
