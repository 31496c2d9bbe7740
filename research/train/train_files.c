#include "research/train/train_files.h"

#include "base/error.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/// Make a folder and those that it lies in.
static bat_status make_folder(const char *folder, bat_error *error)
{
    char part[TRAIN_PATH_SIZE];
    size_t length = strlen(folder);
    if (length == 0 || length > TRAIN_PATH_SIZE / 2)
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

bat_status train_files_make(const char *folder, train_files *files, bat_error *error)
{
    *files = (train_files){0};
    if (folder == NULL)
        return BAT_OK;
    bat_status status = make_folder(folder, error);
    if (status != BAT_OK)
        return status;
    (void)snprintf(files->checkpoint, TRAIN_PATH_SIZE, "%s/checkpoint.safetensors", folder);
    (void)snprintf(files->log, TRAIN_PATH_SIZE, "%s/log.csv", folder);
    (void)snprintf(files->chart, TRAIN_PATH_SIZE, "%s/log.png", folder);
    (void)snprintf(files->model, TRAIN_PATH_SIZE, "%s/model.safetensors", folder);
    return BAT_OK;
}

void train_files_use(const train_files *files, learn_options *options)
{
    if (files->checkpoint[0] == '\0')
        return;
    options->checkpoint = files->checkpoint;
    options->log = files->log;
    options->chart = files->chart;
}
