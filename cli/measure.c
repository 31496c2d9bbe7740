#include "verbs.h"

#include "arguments.h"
#include "report.h"

#include "batten/batten.h"

#include <stdio.h>
#include <stdlib.h>

static const option_spec OPTIONS[] = {
    {"geodesic", 0, NULL, "geodesic distances; default: straight ones between coordinates, as published"},
    {"to-segments", 0, NULL, "distances to the other curve's edges instead of its points"},
    {"space", 0, "NAME", "plane, euclidean, sphere or disk; default: what the files imply"},
    {"closed", 0, NULL, "take every curve as closed"},
    {"open", 0, NULL, "take every curve as open"},
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten measure A [B] [options]",
    .summary =
        "How fair the curves of A are (bending energy, largest exterior angle), and how far they are from those of B:\n"
        "nearest-neighbour and Hausdorff distances, curve i of A with curve i of B. Files of several curves give the\n"
        "mean and the median over the curves.",
    .options = OPTIONS,
    .least_positional = 1,
    .most_positional = 2,
};

/// The numbers measured for every curve; each gets a row in the report.
enum
{
    MEAN_NN,
    MEAN_NN_BACK,
    MEAN_SYMMETRIC,
    HAUSDORFF,
    BENDING,
    G1,
    MEASURES
};

static const struct
{
    const char *key, *name;
} NAMES[MEASURES] = {
    {"mean_nn", "mean nearest neighbour, A to B"},
    {"mean_nn_back", "mean nearest neighbour, B to A"},
    {"mean_symmetric", "mean nearest neighbour, both ways"},
    {"hausdorff", "Hausdorff distance"},
    {"bending", "bending energy of A"},
    {"g1", "largest exterior angle of A"},
};

static int measure_curve(const char *const *paths, const bat_curve *a, const bat_curve *b,
                         const bat_measure_options *options, double *const *values, size_t at)
{
    bat_error error;
    bat_fairness fairness;
    if (bat_curve_fairness(a, options, &fairness, &error) != BAT_OK)
        return report_failure(paths[0], &error);
    values[BENDING][at] = fairness.bending;
    values[G1][at] = fairness.g1;
    if (b == NULL)
        return EXIT_DONE;
    bat_curve_distance distance;
    if (bat_curve_compare(a, b, options, &distance, &error) != BAT_OK)
        return report_failure(paths[1], &error);
    values[MEAN_NN][at] = distance.mean_nn;
    values[MEAN_NN_BACK][at] = distance.mean_nn_back;
    values[MEAN_SYMMETRIC][at] = distance.mean_symmetric;
    values[HAUSDORFF][at] = distance.hausdorff;
    return EXIT_DONE;
}

static int report(double *const *values, size_t count, bool compared, bool as_json)
{
    json_t *object = json_pack("{s:I}", "curves", (json_int_t)count);
    if (!as_json && count > 1)
        (void)printf("%-36s %14s %14s\n", "", "mean", "median");
    for (int m = compared ? 0 : BENDING; m < MEASURES; m++)
    {
        bat_summary summary;
        bat_error error;
        if (bat_summarize(values[m], count, &summary, &error) != BAT_OK)
        {
            json_decref(object);
            return report_failure(NULL, &error);
        }
        if (as_json)
            (void)json_object_set_new(object, NAMES[m].key,
                                      json_pack("{s:f, s:f}", "mean", summary.mean, "median", summary.median));
        else if (count == 1)
            (void)printf("%-36s %14.8g\n", NAMES[m].name, summary.mean);
        else
            (void)printf("%-36s %14.8g %14.8g\n", NAMES[m].name, summary.mean, summary.median);
    }
    if (as_json)
        return report_json(object);
    json_decref(object);
    return EXIT_DONE;
}

static int measure_sets(const char *const *paths, const bat_curve_set *a, const bat_curve_set *b,
                        const bat_measure_options *options, bool as_json)
{
    if (b != NULL && a->count != b->count)
    {
        bat_error error;
        (void)snprintf(error.text, sizeof error.text, "%zu curves cannot be compared with the %zu of %s", b->count, a->count,
                       paths[0]);
        error.line = 0;
        return report_failure(paths[1], &error);
    }
    double *numbers = calloc(MEASURES * a->count, sizeof *numbers), *values[MEASURES];
    if (numbers == NULL)
        return report_failure(NULL, &(bat_error){.text = "out of memory"});
    for (size_t m = 0; m < MEASURES; m++)
        values[m] = numbers + m * a->count;
    int code = EXIT_DONE;
    for (size_t i = 0; i < a->count && code == EXIT_DONE; i++)
        code = measure_curve(paths, &a->curves[i], b != NULL ? &b->curves[i] : NULL, options, values, i);
    if (code == EXIT_DONE)
        code = report(values, a->count, b != NULL, as_json);
    free(numbers);
    return code;
}

int verb_measure(int argc, char **argv)
{
    arguments given;
    int code;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    if (argument_flag(&given, "closed") && argument_flag(&given, "open"))
        return usage_error(&given, "--closed and --open exclude each other");
    bat_read_options read = bat_read_defaults();
    read.space = argument(&given, "space");
    read.closed = argument_flag(&given, "closed") ? 1 : argument_flag(&given, "open") ? 0 : -1;
    bat_measure_options options = bat_measure_defaults();
    options.geodesic = argument_flag(&given, "geodesic");
    options.to_segments = argument_flag(&given, "to-segments");
    bool two = given.positional_count == 2;
    bat_curve_set a = {0}, b = {0};
    bat_error error;
    if (bat_curves_read(given.positional[0], &read, &a, &error) != BAT_OK)
        code = report_failure(given.positional[0], &error);
    else if (two && bat_curves_read(given.positional[1], &read, &b, &error) != BAT_OK)
        code = report_failure(given.positional[1], &error);
    else
        code = measure_sets(given.positional, &a, two ? &b : NULL, &options, argument_flag(&given, "json"));
    bat_curve_set_free(&a);
    bat_curve_set_free(&b);
    return code;
}
