#ifndef RESEARCH_TRAIN_LOG_H
#define RESEARCH_TRAIN_LOG_H

#include "research/learn/train.h"

#include <stdio.h>

/// @file
/// The log of a training: a row per epoch, as a CSV file and as a picture. The columns are the epoch, the steps done at its
/// end, the learning rate, the mean loss, the mean norm of the gradient, the metrics, the validation metrics and the
/// seconds. A missing number is NaN in memory and an empty cell in the file.

/// The names of the columns that a training adds; no commas.
typedef struct train_log_columns
{
    const char *const *metrics;
    size_t metric_count;
    const char *const *validation;
    size_t validation_count;
} train_log_columns;

typedef struct train_log
{
    const char *path, *picture; ///< null for none; not copied
    train_log_columns own;
    const char **names; ///< of all columns
    size_t columns;
    FILE *stream; ///< null without a file, and before the observer's begin()
    double *rows, *row;
    size_t row_count, capacity; ///< capacity in numbers
} train_log;

/// @param path,picture null for none; must outlive the log, as the names must
/// @return BAT_OK or BAT_NO_MEMORY
bat_status train_log_make(const char *path, const char *picture, train_log_columns columns, train_log *log,
                          bat_error *error);
void train_log_free(train_log *log);

/// The functions by which learn_train() fills the log. When a training resumes, the file keeps its rows up to the steps
/// done; what follows is cut off. The picture is drawn when a training resumes, and with every checkpoint. It has a chart
/// for each of loss, gradient norm, learning rate, metrics and validation metrics. A chart without a number that is not
/// positive has a logarithmic axis; without any row nothing is drawn.
///
/// The functions return BAT_OK, BAT_FILE_ACCESS, BAT_NO_MEMORY, BAT_BAD_FILE for a file with other columns or without
/// numbers, and what bat_chart_write() returns. Errors name the file.
learn_observer train_log_observer(train_log *log);

#endif
