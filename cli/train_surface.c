#include "train_surface.h"
#include "arguments.h"
#include "report.h"

#include "batten/research/surface_train.h"

#include <stdio.h>
#include <stdlib.h>

static const char *const RECIPES[] = {"published", "batten", NULL};
enum
{
    RECIPE_PUBLISHED,
    RECIPE_BATTEN
};

static const option_spec OPTIONS[] = {
    {"recipe", 0, "NAME",
     "published: the network, clouds and loss of Giannelli et al., \"BIDGCN\" (2023); the default. batten: that of the "
     "weights "
     "we ship"},
    {"uninformed", 0, NULL, "published: boundary points are as interior ones, their parameters are not told (section 6.1)"},
    {"seed", 0, "N", "of the weights to begin with and of all clouds; default 1"},
    {"epochs", 0, "E", "default 100; batten: 60"},
    {"steps", 0, "N", "of an epoch; default 1000; batten: 500"},
    {"batch", 0, "N", "clouds of a step, which as many threads share; default 1; batten: 32"},
    {"points", 0, "A-B", "inside of a cloud: from A to B, evenly drawn in the logarithm; default 1000; batten: 50-2000"},
    {"degree", 0, "A-B", "bidegree of a cloud, evenly drawn; default 2; batten: 2-5"},
    {"noise", 0, "D", "standard deviations are drawn from 0 to D; default 0; batten: 0.05"},
    {"rate", 0, "R", "the highest learning rate; default 0.1; with --adam and for batten 0.001"},
    {"adam", 0, NULL,
     "AdamW, and the rate falls to 0 along half a wave; else gradient descent, and the rate is halved where the error of "
     "clouds "
     "kept aside no longer falls"},
    {"out", 'o', "FOLDER", "where model, checkpoint, log and its picture go; default out/surface"},
    {"resume", 0, NULL, "go on from the folder's checkpoint, if there is one"},
    {"threads", 0, "N", "default: all processors; the result does not depend on it"},
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten train surface [--recipe published|batten] [--epochs E] [--out FOLDER] [--resume] [options]",
    .summary = "Train learned parameters of scattered points on random Bézier clouds, made on the fly. Ctrl-C writes a "
               "checkpoint and "
               "stops; with --resume the same command goes on to the same result.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = 1,
};

/// "A-B", or "A" for both; what they are stays when the option was not given. False after a message.
static bool read_range(const arguments *given, const char *name, long most, long *low, long *high)
{
    const char *text = argument(given, name);
    if (text == NULL)
        return true;
    char *end;
    *low = *high = strtol(text, &end, 10);
    if (*end == '-')
        *high = strtol(end + 1, &end, 10);
    if (end == text || *end != '\0' || *low < 1 || *high < *low || *high > most)
    {
        (void)usage_error(given, "--%s is a number, or two like 2-5, of 1 to %ld, not '%s'", name, most, text);
        return false;
    }
    return true;
}

/// False after a message.
static bool read_clouds(const arguments *given, bat_surface_train_options *options)
{
    long points[2] = {(long)options->least_points, (long)options->most_points};
    long degrees[2] = {options->least_degree, options->most_degree};
    if (!read_range(given, "points", 100000, &points[0], &points[1]) ||
        !read_range(given, "degree", 15, &degrees[0], &degrees[1]) ||
        !argument_number(given, "noise", options->noise, &options->noise))
        return false;
    options->least_points = (size_t)points[0];
    options->most_points = (size_t)points[1];
    options->least_degree = (int)degrees[0];
    options->most_degree = (int)degrees[1];
    return true;
}

/// False after a message.
static bool read_options(const arguments *given, int *recipe, bat_surface_train_options *options)
{
    long seed, epochs, steps, batch, threads;
    if (!argument_word(given, "recipe", RECIPES, RECIPE_PUBLISHED, recipe))
        return false;
    *options = *recipe == RECIPE_BATTEN ? bat_surface_train_batten() : bat_surface_train_defaults();
    if (*recipe == RECIPE_PUBLISHED && argument_flag(given, "adam"))
        options->rate = 1e-3;
    if (!argument_whole(given, "seed", 0, 1000000000, 1, &seed) ||
        !argument_whole(given, "epochs", 1, 1000000, (long)options->epochs, &epochs) ||
        !argument_whole(given, "steps", 1, 1000000, (long)options->steps, &steps) ||
        !argument_whole(given, "batch", 1, 1000, (long)options->batch, &batch) ||
        !argument_whole(given, "threads", 1, 1024, 0, &threads) || !read_clouds(given, options) ||
        !argument_number(given, "rate", options->rate, &options->rate))
        return false;
    if (argument_flag(given, "uninformed") && *recipe == RECIPE_BATTEN)
    {
        (void)usage_error(given, "only the published recipe has --uninformed");
        return false;
    }
    options->seed = (uint64_t)seed;
    options->epochs = (uint64_t)epochs;
    options->steps = (size_t)steps;
    options->batch = (size_t)batch;
    options->threads = (int)threads;
    options->adam |= argument_flag(given, "adam");
    options->uninformed = argument_flag(given, "uninformed");
    options->resume = argument_flag(given, "resume");
    options->folder = argument(given, "out") != NULL ? argument(given, "out") : "out/surface";
    return true;
}

static int print_json(const char *recipe, const bat_surface_train_options *options, const bat_surface_train_report *report)
{
    return report_json(json_pack(
        "{s:s, s:b, s:I, s:I, s:I, s:o, s:o, s:s}", "recipe", recipe, "uninformed", (int)options->uninformed, "seed",
        (json_int_t)options->seed, "epochs", (json_int_t)report->epochs, "best_epoch", (json_int_t)report->best_epoch,
        "loss", report_number(report->loss), "error", report_number(report->error), "folder", options->folder));
}

static int print_text(const bat_surface_train_options *options, const bat_surface_train_report *report)
{
    (void)printf(
        "%llu epochs; the best weights are those after epoch %llu. Clouds kept aside, fitted with their bidegree: mean "
        "squared error %.4g, in units of the longest side\n\n%s/model.safetensors\n",
        (unsigned long long)report->epochs, (unsigned long long)report->best_epoch, report->error, options->folder);
    return EXIT_DONE;
}

int train_surface(int argc, char **argv)
{
    arguments given;
    bat_surface_train_options options;
    bat_surface_train_report report;
    bat_error error;
    int code, recipe;
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    if (!read_options(&given, &recipe, &options))
        return EXIT_BAD_USAGE;
    options.progress = report_progress("training");
    bat_status status = bat_surface_train(&options, &report, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    return argument_flag(&given, "json") ? print_json(RECIPES[recipe], &options, &report) : print_text(&options, &report);
}
