#ifndef TESTS_SUPPORT_TRAIN_HELPERS_H
#define TESTS_SUPPORT_TRAIN_HELPERS_H

// Folders with the files of trainings, and checks that all trainings share.

#include "check.h"

#include "batten/research/train.h"

#include <unistd.h>

static const char *const TRAIN_FILES[] = {"model.safetensors", "checkpoint.safetensors", "log.csv", "log.png"};

/// Three folders in one of the test's own. They exist once a training has made them.
typedef struct train_folders
{
    char root[40], a[60], b[60], c[60];
} train_folders;

static inline const char *path_in(const char *folder, const char *name, char path[200])
{
    (void)snprintf(path, 200, "%s/%s", folder, name);
    return path;
}

static inline void remove_files(const char *folder)
{
    char path[200];
    for (size_t i = 0; i < sizeof TRAIN_FILES / sizeof *TRAIN_FILES; i++)
        (void)unlink(path_in(folder, TRAIN_FILES[i], path));
    (void)rmdir(folder);
}

static inline int make_folders(void **state)
{
    static train_folders folders;
    (void)snprintf(folders.root, sizeof folders.root, "/tmp/batten-train-XXXXXX");
    if (mkdtemp(folders.root) == NULL)
        return -1;
    (void)snprintf(folders.a, sizeof folders.a, "%s/a", folders.root);
    (void)snprintf(folders.b, sizeof folders.b, "%s/b", folders.root);
    (void)snprintf(folders.c, sizeof folders.c, "%s/c", folders.root);
    *state = &folders;
    return 0;
}

static inline int remove_folders(void **state)
{
    const train_folders *folders = *state;
    remove_files(folders->a);
    remove_files(folders->b);
    remove_files(folders->c);
    return rmdir(folders->root);
}

/// The bytes of a file with a 0 behind them; release them with free().
static inline char *read_file(const char *folder, const char *name, size_t *size)
{
    enum
    {
        MAX_SIZE = 1 << 25
    };
    char path[200];
    FILE *stream = fopen(path_in(folder, name, path), "rb");
    assert_non_null(stream);
    char *bytes = malloc(MAX_SIZE);
    assert_non_null(bytes);
    *size = fread(bytes, 1, MAX_SIZE - 1, stream);
    assert_true(*size > 0 && *size < MAX_SIZE - 1);
    bytes[*size] = 0;
    (void)fclose(stream);
    return bytes;
}

static inline bool same_file(const char *folder, const char *other, const char *name)
{
    size_t size, other_size;
    char *bytes = read_file(folder, name, &size), *other_bytes = read_file(other, name, &other_size);
    bool same = size == other_size && memcmp(bytes, other_bytes, size) == 0;
    free(bytes);
    free(other_bytes);
    return same;
}

/// Progress that stops a training before step `steps`, counted from 0.
typedef struct stopping
{
    size_t steps, asked;
} stopping;

static inline bool stop_at(void *context, double fraction)
{
    stopping *s = context;
    assert_true(fraction >= 0 && fraction < 1);
    return s->asked++ < s->steps;
}

/// Check that a call refused an option with a text that names it and its range.
#define check_refused(call, field, range)                                                                                   \
    do                                                                                                                      \
    {                                                                                                                       \
        bat_error error_;                                                                                                   \
        bat_error *refusal = &error_;                                                                                       \
        check_status((call), BAT_INVALID_ARGUMENT);                                                                         \
        if (strstr(error_.text, (field)) != error_.text || strstr(error_.text, (range)) == NULL)                            \
            fail_msg("the text does not name %s and %s: %s", (field), (range), error_.text);                                \
    } while (0)

/// Starts a training with these options of all trainings and the defaults otherwise.
typedef bat_status train_with(const bat_train_options *run, bat_error *error);

/// Every option of all trainings out of its range.
static inline void check_common_options(train_with *train)
{
    bat_train_options run = {.seed = 1, .epochs = 1};
    run.epochs = 0;
    check_refused(train(&run, refusal), "epochs is 0", "1 to 1000000000");
    run.epochs = UINT64_MAX;
    check_refused(train(&run, refusal), "epochs", "1 to 1000000000");
    run.epochs = 1;
    run.threads = -1;
    check_refused(train(&run, refusal), "threads is -1", "0 to 1024");
    run.threads = 1025;
    check_refused(train(&run, refusal), "threads", "0 to 1024");
    run.threads = 1;
    bat_error error;
    run.folder = "/dev/null/at/all";
    check_status(train(&run, &error), BAT_FILE_ACCESS);
    assert_non_null(strstr(error.text, "/dev/null"));
    run.folder = "";
    check_status(train(&run, &error), BAT_FILE_ACCESS);
    // Without files, and before the first step.
    stopping stop = {0};
    run.folder = NULL;
    run.progress = (bat_progress){stop_at, &stop};
    check_status(train(&run, &error), BAT_CANCELLED);
}

#endif
