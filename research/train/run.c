#include "research/train/run.h"

#include "base/error.h"
#include "base/hash.h"
#include "learn/safetensors.h"
#include "research/learn/parameters.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

enum
{
    PATH_SIZE = 4096
};

/// The paths of a training's files; all empty without a folder.
typedef struct run_files
{
    char checkpoint[PATH_SIZE], log[PATH_SIZE], picture[PATH_SIZE], model[PATH_SIZE];
} run_files;

const char *bat_recipe_name(bat_recipe recipe)
{
    return recipe == BAT_RECIPE_PUBLISHED ? "published" : recipe == BAT_RECIPE_BATTEN ? "batten" : NULL;
}

// Options

static bool in_range(const train_range *r)
{
    bool high = r->above ? r->value > r->min : r->value >= r->min;
    return high && isfinite(r->value) && (r->below ? r->value < r->max : r->value <= r->max);
}

bat_status train_check_ranges(const train_range *ranges, size_t count, bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        const train_range *r = &ranges[i];
        if (in_range(r))
            continue;
        if (isinf(r->max))
            return error_option(error, r->field, "is %.15g, but must be finite and %s %.15g", r->value,
                                r->above ? "above" : "at least", r->min);
        return error_option(error, r->field, "is %.15g, but must be %s%.15g %s %.15g", r->value, r->above ? "above " : "",
                            r->min, r->below ? "to below" : "to", r->max);
    }
    return BAT_OK;
}

static bat_status check_options(const bat_train_options *options, bat_recipe recipe, bat_error *error)
{
    const train_range ranges[] = {
        {"recipe", (double)recipe, 0, TRAIN_RECIPES - 1, false, false},
        {"epochs", (double)options->epochs, 1, BAT_TRAIN_MAX_EPOCHS, false, false},
        {"threads", options->threads, 0, BAT_TRAIN_MAX_THREADS, false, false},
        {"slots", (double)options->slots, 0, BAT_TRAIN_MAX_SLOTS, false, false},
    };
    return train_check_ranges(ranges, sizeof ranges / sizeof *ranges, error);
}

bat_status train_begin(train_context *context, const char *path, bat_error *error)
{
    learn_parameters *weights = &context->parameters;
    safetensors content;
    bat_status status = safetensors_read(path, &content, error);
    if (status != BAT_OK)
        return error_prefix(error, status, "%s: ", path);
    status = error_prefix(error, learn_parameters_extract(weights, &content, "", weights->values, error), "%s: ", path);
    safetensors_free(&content);
    context->begun_with = hash_bytes(HASH_BEGIN, weights->values, weights->total * sizeof *weights->values);
    return status;
}

void train_describe_begin(const train_context *context, char text[TRAIN_TEXT_SIZE])
{
    size_t length = strlen(text);
    if (context->begun_with != 0)
        (void)snprintf(text + length, TRAIN_TEXT_SIZE - length, ", begun with weights %016llx",
                       (unsigned long long)context->begun_with);
}

void train_shuffle(size_t *order, size_t count, bat_random *random)
{
    for (size_t i = 0; i < count; i++)
    {
        size_t j = (size_t)(bat_random_uniform(random) * (double)(i + 1));
        order[i] = order[j];
        order[j] = i;
    }
}

void train_own_samples(const bat_train_options *options, const size_t *order, size_t count, size_t batch, bool *own)
{
    group_items pieces = learn_own_pieces(options->group, options->slots, batch);
    for (size_t i = 0; i < count; i++)
        own[order[i]] = i % batch >= pieces.begin && i % batch < pieces.end;
}

/// Forwards the wish to stop. The share done is that of the whole training, which has not begun.
static bool report_begin(void *context, double fraction)
{
    (void)fraction;
    const bat_progress *progress = context;
    return progress->report(progress->context, 0);
}

bat_progress train_progress_before(bat_progress *given)
{
    return given->report != NULL ? (bat_progress){report_begin, given} : (bat_progress){0};
}

// Files

/// Make a folder and its parents where they are missing.
static bat_status make_folder(const char *folder, bat_error *error)
{
    char part[PATH_SIZE];
    size_t length = strlen(folder);
    if (length == 0 || length > PATH_SIZE / 2)
        return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "the name of the folder is empty or too long");
    memcpy(part, folder, length + 1);
    for (size_t i = 1; i <= length; i++)
    {
        if (part[i] != '/' && part[i] != '\0')
            continue;
        part[i] = '\0';
        if (mkdir(part, 0777) != 0 && errno != EEXIST)
            return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot make the folder %s: %s", part,
                             strerror(errno));
        part[i] = folder[i];
    }
    return BAT_OK;
}

static bat_status make_files(const char *folder, run_files *files, bat_error *error)
{
    *files = (run_files){0};
    if (folder == NULL)
        return BAT_OK;
    bat_status status = make_folder(folder, error);
    if (status != BAT_OK)
        return status;
    (void)snprintf(files->checkpoint, PATH_SIZE, "%s/checkpoint.safetensors", folder);
    (void)snprintf(files->log, PATH_SIZE, "%s/log.csv", folder);
    (void)snprintf(files->picture, PATH_SIZE, "%s/log.png", folder);
    (void)snprintf(files->model, PATH_SIZE, "%s/model.safetensors", folder);
    return BAT_OK;
}

/// Write the weights with notes: the text that describes the training, the seed, the epochs done, and, where the best
/// weights are taken, their epoch, counted from 1, and their validation.
static bat_status write_model(const char *path, const train_recipe *recipe, const train_context *context, const char *text,
                              const learn_report *made, bat_error *error)
{
    char seed[32], epochs[32], best_epoch[32], best[32];
    (void)snprintf(seed, sizeof seed, "%llu", (unsigned long long)context->options->seed);
    (void)snprintf(epochs, sizeof epochs, "%llu", (unsigned long long)made->epochs);
    (void)snprintf(best_epoch, sizeof best_epoch, "%llu", (unsigned long long)made->best_epoch + 1);
    (void)snprintf(best, sizeof best, "%.6g", made->best);
    const safetensors_note notes[] = {
        {"recipe", text}, {"seed", seed}, {"epochs", epochs}, {"best_epoch", best_epoch}, {recipe->best_note, best}};
    bat_status status = learn_parameters_write(&context->parameters, path, notes, recipe->best_note != NULL ? 5 : 3, error);
    return error_prefix(error, status, "%s: ", path);
}

// The training

/// The recipe's text, with the number of slots where one was given.
static void describe(const train_recipe *recipe, const train_context *context, char text[TRAIN_TEXT_SIZE])
{
    recipe->describe(context, text);
    size_t length = strlen(text);
    if (context->options->slots > 0)
        (void)snprintf(text + length, TRAIN_TEXT_SIZE - length, ", %zu slots", context->options->slots);
}

static learn_job job_of(const train_recipe *recipe, void *context)
{
    return (learn_job){
        .context = context,
        .parameters = &((train_context *)context)->parameters,
        .metric_count = recipe->columns.metric_count,
        .validation_count = recipe->columns.validation_count,
        .prepare_epoch = recipe->prepare_epoch,
        .piece_loss = recipe->piece_loss,
        .validate = recipe->validate,
    };
}

static learn_options learning_of(const train_recipe *recipe, const bat_train_options *given, const run_files *files,
                                 const char *text)
{
    learn_options options = learn_options_defaults();
    options.epochs = given->epochs;
    options.optimizer = recipe->optimizer;
    options.schedule = recipe->schedule;
    options.schedule.epochs = given->epochs;
    options.plateau = recipe->plateau;
    options.clip = recipe->clip;
    options.seed = given->seed;
    options.threads = given->threads;
    options.slots = given->slots;
    options.group = given->group;
    options.validate_every = recipe->validate_every;
    options.keep_last = recipe->best_note == NULL;
    options.name = text;
    options.checkpoint = given->folder != NULL ? files->checkpoint : NULL;
    options.checkpoint_every = recipe->checkpoint_every;
    options.resume = given->resume;
    options.progress = given->progress;
    return options;
}

static bat_status run_logged(const train_recipe *recipe, void *context, const run_files *files, const char *text,
                             learn_report *made, bat_error *error)
{
    const bat_train_options *given = ((train_context *)context)->options;
    bool logged = given->folder != NULL && group_rank(given->group) == 0;
    learn_job job = job_of(recipe, context);
    learn_options options = learning_of(recipe, given, files, text);
    train_log log;
    recipe->configure(context, &job, &options);
    bat_status status =
        train_log_make(logged ? files->log : NULL, logged ? files->picture : NULL, recipe->columns, &log, error);
    options.observer = train_log_observer(&log);
    status = bat_group_agree(given->group, status, error);
    if (status == BAT_OK)
        status = learn_train(&job, &options, made, error);
    train_log_free(&log);
    return status;
}

bat_status train_run(const train_recipe *const recipes[TRAIN_RECIPES], bat_recipe which, void *context,
                     bat_train_report *report, bat_error *error)
{
    const bat_train_options *options = ((train_context *)context)->options;
    run_files files;
    learn_report made;
    char text[TRAIN_TEXT_SIZE];
    bat_status status = check_options(options, which, error);
    if (status != BAT_OK)
        return status;
    const train_recipe *recipe = recipes[which];
    bool leads = group_rank(options->group) == 0;
    status = recipe->check(context, error);
    if (status == BAT_OK)
        status = make_files(leads ? options->folder : NULL, &files, error);
    if (status == BAT_OK)
        status = recipe->make(context, error);
    status = bat_group_agree(options->group, status, error);
    if (status == BAT_OK)
    {
        describe(recipe, context, text);
        status = run_logged(recipe, context, &files, text, &made, error);
    }
    if (status == BAT_OK && leads && options->folder != NULL)
        status = write_model(files.model, recipe, context, text, &made, error);
    status = bat_group_agree(options->group, status, error);
    if (status == BAT_OK && report != NULL)
        *report = (bat_train_report){.epochs = made.epochs,
                                     .best_epoch = made.best_epoch + 1,
                                     .stopped = made.stopped,
                                     .loss = made.loss,
                                     .best = made.best};
    return status;
}
