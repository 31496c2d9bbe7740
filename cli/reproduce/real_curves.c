#include "reproduce.h"

#include "report.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double DEGREES = 57.295779513082320877;

enum
{
    /// Rows of a given model.
    MAX_METHODS = 3
};

/// The rows of a given model: three where it has a fairness, else one.
static size_t model_methods(const bat_curve_model *model, bat_tension_method methods[MAX_METHODS])
{
    static const char *const NAMES[MAX_METHODS] = {"given:fairness=0", "given:fairness=0.5", "given:fairness=1"};
    bat_curve_scheme scheme = bat_curve_scheme_of_model(model);
    if (!bat_curve_model_has_fairness(model))
    {
        methods[0] = (bat_tension_method){.name = "given", .scheme = scheme};
        return 1;
    }
    for (size_t i = 0; i < MAX_METHODS; i++)
    {
        scheme.fairness = 0.5 * (double)i;
        methods[i] = (bat_tension_method){.name = NAMES[i], .fairness = scheme.fairness, .scheme = scheme};
    }
    return MAX_METHODS;
}

static int print_json(const bat_real_curves_row *rows, size_t count, size_t levels)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
    {
        const bat_real_curves_row *row = &rows[i];
        (void)json_array_append_new(array, json_pack("{s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:I, s:I}", "space",
                                                     row->space, "family", row->family, "sampling", row->sampling, "scheme",
                                                     row->method, "distance", report_number(row->distance), "relative",
                                                     report_number(row->relative), "largest", report_number(row->largest),
                                                     "turn", report_number(row->turn * DEGREES), "crossed",
                                                     (json_int_t)row->crossed, "curves", (json_int_t)row->curves));
    }
    return report_json(json_pack("{s:I, s:o}", "levels", (json_int_t)levels, "rows", array));
}

static int print_text(const bat_real_curves_row *rows, size_t count, size_t levels)
{
    (void)printf(
        "Curves refined by %zu levels against the curves that their points were sampled from.\n"
        "relative: mean distance over that of the control polygon; distance and largest distance in control edges;\n"
        "turn: median of the largest turning angles, degrees; crossed: curves that cross themselves though their\n"
        "polygon does not.\n",
        levels);
    for (size_t i = 0; i < count; i++)
    {
        const bat_real_curves_row *row = &rows[i];
        if (strcmp(row->method, "polygon") == 0)
            (void)printf("\n%s, %s, %s: %zu curves\n%-35s %9s %9s %9s %7s %8s\n", row->space, row->family, row->sampling,
                         row->curves, "scheme", "relative", "distance", "largest", "turn", "crossed");
        (void)printf("%-35s %9.3f %9.5f %9.4f %7.2f %8zu\n", row->method, row->relative, row->distance, row->largest,
                     row->turn * DEGREES, row->crossed);
    }
    return EXIT_DONE;
}

int reproduce_real_curves(const reproduce_job *job)
{
    bat_tension_method methods[MAX_METHODS];
    bat_curve_model *model = NULL;
    bat_real_curves_row *rows;
    size_t count;
    bat_error error;
    if (job->model != NULL && reproduce_model(job, &model) != EXIT_DONE)
        return EXIT_BAD_INPUT;
    bat_real_curves_options options = bat_real_curves_defaults();
    options.methods = methods;
    options.method_count = model != NULL ? model_methods(model, methods) : 0;
    options.progress = report_progress("measuring curves");
    bat_status status = bat_real_curves(job->data, &options, &rows, &count, &error);
    report_progress_end();
    bat_curve_model_free(model);
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    int code = job->call.json ? print_json(rows, count, options.levels) : print_text(rows, count, options.levels);
    free(rows);
    return code;
}
