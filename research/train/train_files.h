#ifndef RESEARCH_TRAIN_TRAIN_FILES_H
#define RESEARCH_TRAIN_TRAIN_FILES_H

#include "research/train/train.h"

/// @file
/// The files that a training leaves in its folder.

enum
{
    TRAIN_PATH_SIZE = 4096
};

/// Names; all empty where nothing is kept.
typedef struct train_files
{
    char checkpoint[TRAIN_PATH_SIZE]; ///< checkpoint.safetensors
    char log[TRAIN_PATH_SIZE];        ///< log.csv
    char chart[TRAIN_PATH_SIZE];      ///< log.png
    char model[TRAIN_PATH_SIZE];      ///< model.safetensors
} train_files;

/// Make a folder and those that it lies in, where they are not there, and name the files. All names are empty for a null
/// folder.
/// @return BAT_OK or BAT_FILE_ACCESS
bat_status train_files_make(const char *folder, train_files *files, bat_error *error);
/// Let a training keep its checkpoint, log and chart there, if there is a folder. `files` must stay as long as the options.
void train_files_use(const train_files *files, learn_options *options);

#endif
