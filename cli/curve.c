#include "verbs.h"

#include "arguments.h"
#include "report.h"

#include "batten/batten.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    MOST_LEVELS = 60,
    MOST_THREADS = 1024,
    /// Levels that --panel draws side by side at most.
    MOST_PANELS = 12,
    /// Curves of a file drawn with a label and a colour each; more share one.
    MOST_LABELLED = 7,
};

static const option_spec OPTIONS[] = {
    {"output", 'o', "OUT", "write the refined curves to OUT (- for standard output)"},
    {"scheme", 0, "NAME", "how to refine, see `batten list schemes`; default: angle-4, in R^n four-point"},
    {"levels", 0, "K", "how often; every level doubles the number of edges; default 5"},
    {"space", 0, "NAME", "plane, euclidean, sphere or disk; default: what the file implies"},
    {"closed", 0, NULL, "take every curve as closed"},
    {"open", 0, NULL, "take every curve as open"},
    {"ends", 0, "RULE", "how open curves end: reflect (default), extrapolate, free"},
    {"snap", 0, NULL, "move the points of a linear scheme onto its limit curve"},
    {"project", 0, NULL, "move points that are off their space onto it"},
    {"picture", 0, "FILE", "draw to FILE: .svg, .png or .pdf"},
    {"truth", 0, "FILE", "a curve to compare with and to draw"},
    {"best-tension", 0, NULL, "angle-based: search the tension that brings the result nearest to the truth"},
    {"panel", 0, "K,K,…", "draw these levels side by side"},
    {"projection", 0, "NAME", "draw the sphere as globe (default), map or both"},
    {"comb", 0, NULL, "draw the curvature comb"},
    {"from", 0, "FORMAT", "csv, geojson or obj; default: by the file's ending"},
    {"to", 0, "FORMAT", "the same for OUT"},
    {"precision", 0, "N", "decimals of degrees in GeoJSON; default 10"},
    {"threads", 0, "N", "default: all"},
    {"json", 0, NULL, "print the report as one JSON object"},
    {"quiet", 0, NULL, "print no report"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten curve IN [-o OUT] [--scheme NAME] [--levels K] [--picture FILE] [options]",
    .summary =
        "Refine the curves of a file (CSV, GeoJSON, OBJ; - for standard input). Without -o and --picture the result goes "
        "to\nstandard output in the format of the input.",
    .options = OPTIONS,
    .least_positional = 1,
    .most_positional = 1,
};

/// What the command line says.
typedef struct job
{
    const char *input, *output, *picture, *truth;
    bat_read_options read;
    bat_write_options write;
    bat_refine_options refine;
    const char *scheme; ///< null until the space is known when the user gave none
    bat_picture_options draw;
    size_t panels[MOST_PANELS];
    size_t panel_count;
    bool best_tension, json, quiet;
} job;

static bool read_panels(const arguments *given, job *j)
{
    const char *at = argument(given, "panel");
    while (at != NULL && *at != '\0')
    {
        char *end;
        errno = 0;
        long level = strtol(at, &end, 10);
        if (end == at || (*end != '\0' && *end != ',') || errno != 0 || level < 0 || level > MOST_LEVELS ||
            j->panel_count == MOST_PANELS)
        {
            (void)usage_error(given, "--panel takes up to %d levels from 0 to %d, as in 0,1,2,5", MOST_PANELS, MOST_LEVELS);
            return false;
        }
        j->panels[j->panel_count++] = (size_t)level;
        at = end + (*end == ',');
    }
    return true;
}

static bool read_format(const arguments *given, const char *option, bat_file_format *format)
{
    bat_error error;
    const char *name = argument(given, option);
    if (name == NULL || bat_file_format_by_name(name, format, &error) == BAT_OK)
        return true;
    (void)usage_error(given, "%s", error.text);
    return false;
}

static bool read_choices(const arguments *given, job *j)
{
    static const char *const END_RULES[] = {"reflect", "extrapolate", "free", NULL};
    static const char *const PROJECTIONS[] = {"globe", "map", "both", NULL};
    int ends, projection;
    if (!argument_word(given, "ends", END_RULES, BAT_END_REFLECT, &ends) ||
        !argument_word(given, "projection", PROJECTIONS, BAT_PROJECTION_GLOBE, &projection))
        return false;
    j->refine.ends = (bat_end_rule)ends;
    j->draw.projection = (bat_projection)projection;
    if (argument_flag(given, "closed") && argument_flag(given, "open"))
    {
        (void)usage_error(given, "--closed and --open exclude each other");
        return false;
    }
    j->read.closed = argument_flag(given, "closed") ? 1 : argument_flag(given, "open") ? 0 : -1;
    return read_format(given, "from", &j->read.format) && read_format(given, "to", &j->write.format);
}

static bool read_job(const arguments *given, job *j)
{
    *j = (job){
        .input = given->positional[0],
        .output = argument(given, "output"),
        .picture = argument(given, "picture"),
        .truth = argument(given, "truth"),
        .read = bat_read_defaults(),
        .write = bat_write_defaults(),
        .refine = bat_refine_defaults(),
        .scheme = argument(given, "scheme"),
        .draw = bat_picture_defaults(),
        .best_tension = argument_flag(given, "best-tension"),
        .json = argument_flag(given, "json"),
        .quiet = argument_flag(given, "quiet"),
    };
    long levels, threads, precision;
    if (!argument_whole(given, "levels", 0, MOST_LEVELS, (long)j->refine.levels, &levels) ||
        !argument_whole(given, "threads", 1, MOST_THREADS, 0, &threads) ||
        !argument_whole(given, "precision", 0, 12, j->write.precision, &precision) || !read_choices(given, j) ||
        !read_panels(given, j))
        return false;
    j->refine.levels = (size_t)levels;
    j->refine.threads = j->read.threads = j->write.threads = (int)threads;
    j->refine.snap = argument_flag(given, "snap");
    j->write.precision = (int)precision;
    j->read.space = argument(given, "space");
    j->read.project = argument_flag(given, "project");
    j->draw.comb = argument_flag(given, "comb");
    if (j->best_tension && j->truth == NULL)
    {
        (void)usage_error(given, "--best-tension needs --truth FILE");
        return false;
    }
    if (j->output == NULL && j->picture == NULL)
        j->output = "-";
    bool to_standard_output = j->output != NULL && strcmp(j->output, "-") == 0;
    if (to_standard_output && j->json)
    {
        (void)usage_error(given, "--json needs -o FILE or --picture FILE: the curves themselves go to standard output");
        return false;
    }
    j->quiet = j->quiet || to_standard_output;
    bat_error error;
    if (j->scheme != NULL && bat_scheme_by_name(j->scheme, &j->refine.scheme, &error) != BAT_OK)
    {
        (void)usage_error(given, "%s", error.text);
        return false;
    }
    return true;
}

/// Refine a set into another that keeps the file's attributes.
static int refine_set(const job *j, const bat_curve_set *coarse, size_t levels, bat_curve_set *fine)
{
    bat_error error;
    bat_refine_options how = j->refine;
    how.levels = levels;
    how.progress = report_progress("refining");
    bat_curve *curves = calloc(coarse->count, sizeof *curves);
    if (curves == NULL)
    {
        (void)fputs("batten: out of memory\n", stderr);
        return EXIT_BAD_INPUT;
    }
    size_t failed = 0;
    bat_status status = bat_curves_refine(coarse->curves, coarse->count, &how, curves, &failed, &error);
    report_progress_end();
    if (status == BAT_OK)
    {
        status = bat_curve_set_like(coarse, curves, fine, &error);
        if (status == BAT_OK)
            return EXIT_DONE;
        for (size_t i = 0; i < coarse->count; i++)
            bat_curve_free(&curves[i]);
    }
    else if (error.index != BAT_NO_INDEX && failed < coarse->count)
    {
        error.line = bat_curve_set_line(coarse, failed, error.index);
        if (coarse->count > 1)
        {
            char text[BAT_ERROR_TEXT_SIZE];
            (void)snprintf(text, sizeof text, "curve %zu: %.200s", failed, error.text);
            memcpy(error.text, text, sizeof text);
        }
    }
    free(curves);
    return report_failure(j->input, &error);
}

/// The layers of one panel: the control polygons, the truth when there is one, the refined curves.
static size_t make_layers(const job *j, const bat_curve_set *coarse, const bat_curve_set *truth, const bat_curve_set *fine,
                          size_t levels, bat_picture_layer *layers)
{
    size_t count = 0;
    for (size_t i = 0; i < coarse->count; i++)
        layers[count++] =
            (bat_picture_layer){.curve = &coarse->curves[i], .role = BAT_LAYER_CONTROL, .label = i == 0 ? "given" : NULL};
    for (size_t i = 0; truth != NULL && i < truth->count; i++)
        layers[count++] =
            (bat_picture_layer){.curve = &truth->curves[i], .role = BAT_LAYER_TRUTH, .label = i == 0 ? "truth" : NULL};
    for (size_t i = 0; levels > 0 && i < fine->count; i++)
        layers[count++] = (bat_picture_layer){.curve = &fine->curves[i],
                                              .role = BAT_LAYER_CURVE,
                                              .label = i == 0 ? j->scheme : NULL,
                                              .colour = fine->count > MOST_LABELLED ? 1 : 0};
    return count;
}

/// What one picture is made of.
typedef struct panel_set
{
    bat_curve_set fine[MOST_PANELS];
    bat_picture_layer *layers[MOST_PANELS];
    char titles[MOST_PANELS][24];
    bat_picture_panel panels[MOST_PANELS];
} panel_set;

static int draw(const job *j, const bat_curve_set *coarse, const bat_curve_set *truth, const bat_curve_set *fine)
{
    panel_set *set = calloc(1, sizeof *set);
    size_t count = j->panel_count > 0 ? j->panel_count : 1;
    size_t most_layers = 2 * coarse->count + (truth != NULL ? truth->count : 0);
    int code = EXIT_DONE;
    bat_error error = {.text = "out of memory"};
    for (size_t p = 0; p < count && set != NULL && code == EXIT_DONE; p++)
    {
        size_t levels = j->panel_count > 0 ? j->panels[p] : j->refine.levels;
        const bat_curve_set *shown = fine;
        if (j->panel_count > 0 && levels > 0 && levels != j->refine.levels)
        {
            code = refine_set(j, coarse, levels, &set->fine[p]);
            shown = &set->fine[p];
        }
        set->layers[p] = calloc(most_layers, sizeof *set->layers[p]);
        if (code != EXIT_DONE || set->layers[p] == NULL)
            break;
        (void)snprintf(set->titles[p], sizeof set->titles[p], "level %zu", levels);
        set->panels[p] = (bat_picture_panel){.layers = set->layers[p], .title = j->panel_count > 0 ? set->titles[p] : NULL};
        set->panels[p].layer_count = make_layers(j, coarse, truth, shown, levels, set->layers[p]);
    }
    if (code == EXIT_DONE && (set == NULL || set->layers[count - 1] == NULL ||
                              bat_picture_write(j->picture, set->panels, count, &j->draw, &error)))
        code = report_failure(j->picture, &error);
    for (size_t p = 0; set != NULL && p < count; p++)
    {
        free(set->layers[p]);
        bat_curve_set_free(&set->fine[p]);
    }
    free(set);
    return code;
}

/// Sums over the curves of a set; means are over curves.
typedef struct totals
{
    size_t points;
    double length, bending, g1;
} totals;

static bat_status total(const bat_curve_set *set, int threads, totals *sum, bat_error *error)
{
    bat_measure_options options = bat_measure_defaults();
    options.threads = threads;
    bat_fairness *fairness = calloc(set->count, sizeof *fairness);
    *sum = (totals){0};
    bat_status status =
        fairness == NULL ? BAT_NO_MEMORY : bat_curves_fairness(set->curves, set->count, &options, fairness, NULL, error);
    for (size_t i = 0; i < set->count && status == BAT_OK; i++)
    {
        sum->points += set->curves[i].count;
        sum->length += fairness[i].length;
        sum->bending += fairness[i].bending / (double)set->count;
        sum->g1 = fairness[i].g1 > sum->g1 ? fairness[i].g1 : sum->g1;
    }
    free(fairness);
    return status;
}

static json_t *totals_json(const totals *t)
{
    return json_pack("{s:I, s:f, s:f, s:f}", "points", (json_int_t)t->points, "length", t->length, "bending", t->bending,
                     "g1", t->g1);
}

static void print_totals(const char *name, const totals *t)
{
    (void)printf("%-8s %10zu %12.6g %14.6g %16.6g\n", name, t->points, t->length, t->bending, t->g1);
}

/// "on the sphere", "in R^3".
static const char *place_of(const bat_space *space, char *text, size_t size)
{
    if (strcmp(space->name, "euclidean") == 0)
        (void)snprintf(text, size, "in R^%zu", space->dimension);
    else
        (void)snprintf(text, size, "%s the %s", strcmp(space->name, "sphere") == 0 ? "on" : "in", space->name);
    return text;
}

static int report(const job *j, const bat_curve_set *coarse, const bat_curve_set *truth, const bat_curve_set *fine)
{
    totals before, after;
    bat_curve_distance distance;
    bool compared = truth != NULL && fine->count == 1 && truth->count == 1;
    bat_error error = {.text = "out of memory"};
    if (total(coarse, j->read.threads, &before, &error) != BAT_OK || total(fine, j->read.threads, &after, &error) != BAT_OK)
        return report_failure(j->input, &error);
    if (compared && bat_curve_compare(&fine->curves[0], &truth->curves[0], NULL, &distance, &error) != BAT_OK)
        return report_failure(j->truth, &error);
    if (!j->json)
    {
        char place[32];
        (void)printf("%zu curve%s %s, scheme %s, %zu levels\n", fine->count, fine->count == 1 ? "" : "s",
                     place_of(fine->space, place, sizeof place), j->scheme, j->refine.levels);
        (void)printf("%-8s %10s %12s %14s %16s\n", "", "points", "length", "bending", "largest angle");
        print_totals("given", &before);
        print_totals("refined", &after);
        if (compared)
            (void)printf("distance to the truth: mean %.6g, Hausdorff %.6g\n", distance.mean_nn, distance.hausdorff);
        return EXIT_DONE;
    }
    json_t *object = json_pack("{s:s, s:s, s:I, s:I, s:o, s:o}", "space", fine->space->name, "scheme", j->scheme, "levels",
                               (json_int_t)j->refine.levels, "curves", (json_int_t)fine->count, "given",
                               totals_json(&before), "refined", totals_json(&after));
    if (compared)
        (void)json_object_set_new(object, "distance",
                                  json_pack("{s:f, s:f}", "mean_nn", distance.mean_nn, "hausdorff", distance.hausdorff));
    return report_json(object);
}

/// Replace the tension of the scheme by the best for this truth; `name` receives the scheme's new name.
static int choose_tension(job *j, const bat_curve_set *coarse, const bat_curve_set *truth, char *name, size_t size)
{
    bat_scheme *scheme = &j->refine.scheme;
    bat_error error = {.text = "--best-tension needs an angle-based scheme, and as many true curves as given ones"};
    if (scheme->kind != BAT_SCHEME_ANGLE || coarse->count != truth->count)
        return report_failure(j->input, &error);
    bat_status status = bat_tension_search(coarse->curves, truth->curves, coarse->count, scheme->sign, j->refine.levels,
                                           j->refine.threads, report_progress("searching"), &scheme->tension, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(j->input, &error);
    (void)snprintf(name, size, "angle:mu=%.3f%s", scheme->tension, scheme->sign == BAT_ANGLE_PRINTED ? ",sign=printed" : "");
    j->scheme = name;
    return EXIT_DONE;
}

static int run(const job *j, const bat_curve_set *coarse, const bat_curve_set *truth)
{
    bat_curve_set fine = {0};
    bat_error error;
    int code = refine_set(j, coarse, j->refine.levels, &fine);
    if (code == EXIT_DONE && j->picture != NULL)
        code = draw(j, coarse, truth, &fine);
    if (code == EXIT_DONE && report_interrupted())
        code = report_failure(NULL, &(bat_error){.text = "stopped"});
    if (code == EXIT_DONE && j->output != NULL && bat_curves_write(j->output, &fine, &j->write, &error) != BAT_OK)
        code = report_failure(j->output, &error);
    if (code == EXIT_DONE && !j->quiet)
        code = report(j, coarse, truth, &fine);
    bat_curve_set_free(&fine);
    return code;
}

int verb_curve(int argc, char **argv)
{
    arguments given;
    job j;
    int code;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    if (!read_job(&given, &j))
        return EXIT_BAD_USAGE;
    bat_curve_set coarse = {0}, truth = {0};
    bat_error error;
    code = EXIT_DONE;
    if (bat_curves_read(j.input, &j.read, &coarse, &error) != BAT_OK)
        return report_failure(j.input, &error);
    if (j.scheme == NULL)
    {
        j.scheme = bat_scheme_name_for_space(coarse.space);
        j.refine.scheme = bat_scheme_for_space(coarse.space);
    }
    bat_read_options read_truth = j.read;
    read_truth.format = BAT_FORMAT_AUTO;
    if (j.truth != NULL && bat_curves_read(j.truth, &read_truth, &truth, &error) != BAT_OK)
        code = report_failure(j.truth, &error);
    char name[48];
    if (code == EXIT_DONE && j.best_tension)
        code = choose_tension(&j, &coarse, &truth, name, sizeof name);
    if (code == EXIT_DONE)
        code = run(&j, &coarse, j.truth != NULL ? &truth : NULL);
    bat_curve_set_free(&coarse);
    bat_curve_set_free(&truth);
    return code;
}
