#include "models/train_files.h"

#include "base/error.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

bat_status train_files_folder(const char *folder, bat_error *error)
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

void train_files_name(const char *folder, train_files *files)
{
    (void)snprintf(files->checkpoint, TRAIN_PATH_SIZE, "%s/checkpoint.safetensors", folder);
    (void)snprintf(files->log, TRAIN_PATH_SIZE, "%s/log.csv", folder);
    (void)snprintf(files->chart, TRAIN_PATH_SIZE, "%s/log.png", folder);
    (void)snprintf(files->model, TRAIN_PATH_SIZE, "%s/model.safetensors", folder);
}
