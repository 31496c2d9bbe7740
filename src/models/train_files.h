#ifndef MODELS_TRAIN_FILES_H
#define MODELS_TRAIN_FILES_H

#include "batten/base.h"

/// @file
/// The files that a training leaves in its folder.

enum
{
    TRAIN_PATH_SIZE = 4096
};

typedef struct train_files
{
    char checkpoint[TRAIN_PATH_SIZE]; ///< checkpoint.safetensors
    char log[TRAIN_PATH_SIZE];        ///< log.csv
    char chart[TRAIN_PATH_SIZE];      ///< log.png
    char model[TRAIN_PATH_SIZE];      ///< model.safetensors
} train_files;

/// Make a folder and those that it lies in, where they are not there.
/// @return BAT_OK or BAT_FILE_ACCESS
bat_status train_files_folder(const char *folder, bat_error *error);
/// The names of the files in a folder that was made.
void train_files_name(const char *folder, train_files *files);

#endif
