#include "arguments.h"
#include "report.h"
#include "train_mesh.h"
#include "train_surface.h"
#include "verbs.h"

#include "batten/batten.h"
#include "batten/research/research.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const RECIPES[] = {"published", "batten", NULL};
static const char *const EMBEDDINGS[] = {"learned", "one-hot", "none", NULL};
static const char *const TERMS[] = {"consistency", "bending", "smoothness", NULL};
enum
{
    RECIPE_PUBLISHED,
    RECIPE_BATTEN
};
enum
{
    TERM_CONSISTENCY,
    TERM_BENDING,
    TERM_SMOOTHNESS
};

static const option_spec OPTIONS[] = {
    {"recipe", 0, "NAME",
     "published: the network, data, loss and stopping rules of Ugail and Howard (2026); batten: the scheme that comes with "
     "the library; default published"},
    {"seed", 0, "N", "of the weights to begin with and of all other chance; default 1"},
    {"epochs", 0, "E", "at most; the learning rate falls to 0 over as many; default 300"},
    {"out", 'o', "FOLDER", "where model, checkpoint, log and its picture go; default out/tension, for batten out/fairing"},
    {"resume", 0, NULL, "go on from the folder's checkpoint, if there is one"},
    {"threads", 0, "N", "default: all processors; the result does not depend on it"},
    {"embedding", 0, "KIND", "published: how the network learns of the space: learned (default), one-hot, none"},
    {"without", 0, "TERM", "published: leave a term out of the loss: consistency, bending, smoothness"},
    {"json", 0, NULL, "print one JSON object"},
    {NULL, 0, NULL, NULL},
};

static const verb_spec SPEC = {
    .usage = "batten train tension [--recipe published|batten] [--seed N] [--epochs E] [--out FOLDER] [--resume] [options]",
    .summary =
        "Train the learned curve scheme. Ctrl-C writes a checkpoint and stops; with --resume the same command goes on to "
        "the same result. `batten train mesh --help` tells of meshes, `batten train surface --help` of "
        "scattered points.",
    .options = OPTIONS,
    .min_positional = 1,
    .max_positional = 1,
};

static void leave_out(bat_tension_train_options *options, int term)
{
    if (term == TERM_CONSISTENCY)
        options->consistency = 0;
    if (term == TERM_BENDING)
        options->bending = 0;
    if (term == TERM_SMOOTHNESS)
        memset(options->smoothness, 0, sizeof options->smoothness);
}

/// False after a message.
static bool read_options(const arguments *given, bat_tension_train_options *options)
{
    long seed, epochs, threads;
    int recipe, embedding, without;
    if (!argument_word(given, "recipe", RECIPES, 0, &recipe) || !argument_whole(given, "seed", 0, 1000000000, 1, &seed) ||
        !argument_whole(given, "epochs", 1, 1000000, 300, &epochs) ||
        !argument_whole(given, "threads", 1, 1024, 0, &threads) ||
        !argument_word(given, "embedding", EMBEDDINGS, 0, &embedding) ||
        !argument_word(given, "without", TERMS, -1, &without))
        return false;
    *options = bat_tension_train_defaults();
    options->seed = (uint64_t)seed;
    options->epochs = (uint64_t)epochs;
    options->threads = (int)threads;
    options->embedding = (bat_tension_embedding)embedding;
    options->resume = argument_flag(given, "resume");
    options->folder = argument(given, "out") != NULL ? argument(given, "out") : "out/tension";
    leave_out(options, without);
    return true;
}

static const char *const SPACES[BAT_TENSION_SPACE_COUNT] = {"plane", "sphere", "disk"};

/// Table 1, the learned predictor.
static const bat_tension_score PUBLISHED[BAT_TENSION_SPACE_COUNT] = {
    {0.01636, 20.9, 0.237}, {0.04905, 13.8, 0.231}, {0.00435, 17403.9, 0.160}};

static int print_json(const bat_tension_train_options *options, const bat_tension_train_report *report)
{
    json_t *scores = json_array();
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        const bat_tension_score *ours = &report->scores[space], *published = &PUBLISHED[space];
        (void)json_array_append_new(scores, json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:o}", "space", SPACES[space],
                                                      "mean_nn", report_number(ours->mean_nn), "bending",
                                                      report_number(ours->bending), "g1", report_number(ours->g1),
                                                      "published_mean_nn", report_number(published->mean_nn),
                                                      "published_bending", report_number(published->bending), "published_g1",
                                                      report_number(published->g1)));
    }
    return report_json(json_pack("{s:s, s:I, s:I, s:I, s:b, s:o, s:o, s:s}", "recipe", "published", "seed",
                                 (json_int_t)options->seed, "epochs", (json_int_t)report->epochs, "best_epoch",
                                 (json_int_t)report->best_epoch, "stopped_early", (int)report->stopped, "mean_nn",
                                 report_number(report->mean_nn), "scores", scores, "folder", options->folder));
}

static int print_text(const bat_tension_train_options *options, const bat_tension_train_report *report)
{
    (void)printf("%llu epochs%s; the best weights are those after epoch %llu, with a mean-NN of %.5f over the spaces\n"
                 "(published: 0.02325 after epoch 200). Validation curves, five learned levels; in brackets the published "
                 "figures:\n\n",
                 (unsigned long long)report->epochs, report->stopped ? ", stopped early" : "",
                 (unsigned long long)report->best_epoch, report->mean_nn);
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        const bat_tension_score *ours = &report->scores[space], *published = &PUBLISHED[space];
        (void)printf("%-7s mean-NN %.5f (%.5f)   bending %8.4g (%8.4g)   G1 %.3f (%.3f)\n", SPACES[space], ours->mean_nn,
                     published->mean_nn, ours->bending, published->bending, ours->g1, published->g1);
    }
    (void)printf("\n%s/model.safetensors\n", options->folder);
    return EXIT_DONE;
}

static int train_published(const arguments *given)
{
    bat_tension_train_options options;
    bat_tension_train_report report;
    bat_error error;
    if (!read_options(given, &options))
        return EXIT_BAD_USAGE;
    options.progress = report_progress("training");
    bat_status status = bat_tension_train(&options, &report, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    return argument_flag(given, "json") ? print_json(&options, &report) : print_text(&options, &report);
}

// The library's own recipe

static const double FAIRNESS[BAT_FAIRING_CHECKS] = {0, 0.5, 1};

/// False after a message.
static bool read_fairing_options(const arguments *given, bat_learned_train_options *options)
{
    long seed, epochs, threads;
    *options = bat_learned_train_defaults();
    if (argument(given, "embedding") != NULL || argument(given, "without") != NULL)
    {
        (void)usage_error(given, "only the published recipe has --embedding and --without");
        return false;
    }
    if (!argument_whole(given, "seed", 0, 1000000000, 1, &seed) ||
        !argument_whole(given, "epochs", 1, 1000000, (long)options->epochs, &epochs) ||
        !argument_whole(given, "threads", 1, 1024, 0, &threads))
        return false;
    options->seed = (uint64_t)seed;
    options->epochs = (uint64_t)epochs;
    options->threads = (int)threads;
    options->resume = argument_flag(given, "resume");
    options->folder = argument(given, "out") != NULL ? argument(given, "out") : "out/fairing";
    return true;
}

static int print_fairing_json(const bat_learned_train_options *options, const bat_learned_train_report *report)
{
    json_t *scores = json_array();
    for (int i = 0; i < BAT_FAIRING_CHECKS; i++)
        for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        {
            const bat_learned_score *score = &report->scores[i][space];
            (void)json_array_append_new(scores, json_pack("{s:f, s:s, s:o, s:o, s:o}", "fairness", FAIRNESS[i], "space",
                                                          SPACES[space], "mean_nn", report_number(score->mean_nn), "bending",
                                                          report_number(score->bending), "g1", report_number(score->g1)));
        }
    return report_json(json_pack("{s:s, s:I, s:I, s:o, s:o, s:s}", "recipe", "batten", "seed", (json_int_t)options->seed,
                                 "epochs", (json_int_t)report->epochs, "loss", report_number(report->loss), "scores", scores,
                                 "folder", options->folder));
}

static int print_fairing_text(const bat_learned_train_options *options, const bat_learned_train_report *report)
{
    (void)printf("%llu epochs. Curves kept aside, drawn from the trained families, five levels:\n\n",
                 (unsigned long long)report->epochs);
    for (int i = 0; i < BAT_FAIRING_CHECKS; i++)
        for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        {
            const bat_learned_score *score = &report->scores[i][space];
            (void)printf("fairness %.1f %-7s mean-NN %.5f   bending %8.4g   G1 %.3f\n", FAIRNESS[i], SPACES[space],
                         score->mean_nn, score->bending, score->g1);
        }
    (void)printf("\n%s/model.safetensors\n", options->folder);
    return EXIT_DONE;
}

static int train_batten(const arguments *given)
{
    bat_learned_train_options options;
    bat_learned_train_report report;
    bat_error error;
    if (!read_fairing_options(given, &options))
        return EXIT_BAD_USAGE;
    options.progress = report_progress("training");
    bat_status status = bat_learned_train(&options, &report, &error);
    report_progress_end();
    if (status != BAT_OK)
        return report_failure(NULL, &error);
    return argument_flag(given, "json") ? print_fairing_json(&options, &report) : print_fairing_text(&options, &report);
}

int verb_train(int argc, char **argv)
{
    arguments given;
    int code, recipe;
    if (argc > 1 && strcmp(argv[1], "mesh") == 0)
        return train_mesh(argc, argv);
    if (argc > 1 && strcmp(argv[1], "surface") == 0)
        return train_surface(argc, argv);
    if (!arguments_read(&SPEC, argc, argv, &given, &code))
        return code;
    if (strcmp(given.positional[0], "tension") != 0)
        return usage_error(&given, "there is no model '%s' to train; there are tension, mesh and surface",
                           given.positional[0]);
    if (!argument_word(&given, "recipe", RECIPES, RECIPE_PUBLISHED, &recipe))
        return EXIT_BAD_USAGE;
    return recipe == RECIPE_BATTEN ? train_batten(&given) : train_published(&given);
}
