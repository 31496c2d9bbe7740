#ifndef RESEARCH_TRAIN_LOG_H
#define RESEARCH_TRAIN_LOG_H

#include "batten/base.h"

#include <stdio.h>

/// @file
/// A table of numbers that grows by a row an epoch, as a CSV file and as a picture.

/// The first two columns are the epoch and the step at its end. A number that is missing is NaN here and empty there.
typedef struct learn_log
{
    FILE *stream; ///< null when there is no file
    const char *const *names;
    size_t columns;
    double *rows;
    size_t row_count, capacity; ///< capacity in numbers
} learn_log;

enum
{
    LEARN_LOG_EPOCH,
    LEARN_LOG_STEP
};

/// Begin a table. What the file held is kept up to the last row whose step is not beyond `step`, and cut off there; with a
/// step of 0 it is begun anew.
/// @param path null for a table in memory alone
/// @param names kept, not copied
/// @return BAT_OK, BAT_FILE_ACCESS, BAT_NO_MEMORY, or BAT_BAD_FILE when an existing file has other columns or no numbers
bat_status learn_log_open(const char *path, const char *const *names, size_t columns, uint64_t step, learn_log *log,
                          bat_error *error);
void learn_log_close(learn_log *log);
/// Add a row and see to it that it reaches the file.
/// @return BAT_OK, BAT_FILE_ACCESS or BAT_NO_MEMORY
bat_status learn_log_add(learn_log *log, const double *row, bat_error *error);
/// Draw columns over the epochs: a chart for each group of columns, the groups given by the first column of each and
/// `ends[groups - 1]` behind the last. A group all of whose numbers are positive has a logarithmic axis. Groups without
/// numbers are left out; without any nothing is drawn.
/// @return BAT_OK, or as bat_chart_write()
bat_status learn_log_draw(const learn_log *log, const char *path, const size_t *begins, const size_t *ends, size_t groups,
                          bat_error *error);

#endif
