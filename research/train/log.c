#include "research/train/log.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "batten/curve_picture.h"
#include "io/common/file_text.h"
#include "io/common/number_text.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

static bat_status cannot(const char *what, const char *path, bat_error *error)
{
    return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot %s %s: %s", what, path, strerror(errno));
}

static bat_status keep_row(learn_log *log, const double *row, bat_error *error)
{
    void *rows = log->rows;
    size_t used = log->row_count * log->columns;
    if (!array_grow(&rows, &log->capacity, used + log->columns, sizeof *log->rows))
        return error_memory(error, (used + log->columns) * sizeof *log->rows);
    log->rows = rows;
    memcpy(log->rows + used, row, log->columns * sizeof *row);
    log->row_count++;
    return BAT_OK;
}

/// The columns' names, separated by commas.
static bool is_header(const learn_log *log, const text_line *line)
{
    const char *at = line->begin;
    for (size_t c = 0; c < log->columns; c++)
    {
        size_t length = strlen(log->names[c]);
        bool last = c + 1 == log->columns;
        if ((size_t)(line->end - at) < length + (last ? 0 : 1) || memcmp(at, log->names[c], length) != 0)
            return false;
        at += length;
        if (!last && *at++ != ',')
            return false;
    }
    return at == line->end;
}

/// A number for each column, or none where a cell is empty.
static bool read_row(const learn_log *log, const text_line *line, double *row)
{
    const char *at = line->begin;
    for (size_t c = 0; c < log->columns; c++)
    {
        const char *comma = memchr(at, ',', (size_t)(line->end - at));
        bool last = c + 1 == log->columns;
        if (last != (comma == NULL))
            return false;
        const char *end = last ? line->end : comma;
        row[c] = NAN;
        if (end > at && number_read(at, end, &row[c]) != NULL)
            return false;
        at = last ? end : end + 1;
    }
    return true;
}

/// Take over the rows up to a step; *size is how many bytes of the text they and the header are. A last line that was not
/// written to its end is not taken.
static bat_status read_rows(learn_log *log, const file_text *text, uint64_t step, double *row, size_t *size,
                            bat_error *error)
{
    text_line line = text_line_start(text);
    *size = 0;
    while (text_line_next(text, &line))
    {
        bool whole = line.next > text->data && line.next[-1] == '\n';
        if (line.number == 1 && !is_header(log, &line))
            return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 1, "line 1: the log has other columns than this training");
        if (!whole)
            return BAT_OK;
        if (line.number > 1)
        {
            if (!read_row(log, &line, row))
                return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, line.number, "line %zu: not a row of %zu numbers",
                                 line.number, log->columns);
            if (!(row[LEARN_LOG_STEP] <= (double)step))
                return BAT_OK;
            bat_status status = keep_row(log, row, error);
            if (status != BAT_OK)
                return status;
        }
        *size = (size_t)(line.next - text->data);
    }
    return BAT_OK;
}

/// Read what is kept of a file, *size bytes, and cut off the rest.
static bat_status reopen(learn_log *log, const char *path, uint64_t step, size_t *size, bat_error *error)
{
    file_text text;
    bat_status status = file_text_read(path, &text, error);
    if (status != BAT_OK)
        return status;
    double *row = calloc(log->columns, sizeof *row);
    status = row != NULL ? read_rows(log, &text, step, row, size, error) : error_memory(error, log->columns * sizeof *row);
    free(row);
    file_text_free(&text);
    if (status == BAT_OK && truncate(path, (off_t)*size) != 0)
        status = cannot("shorten", path, error);
    return status;
}

static bat_status write_header(learn_log *log, const char *path, bat_error *error)
{
    for (size_t c = 0; c < log->columns; c++)
        (void)fprintf(log->stream, "%s%s", c > 0 ? "," : "", log->names[c]);
    (void)fputc('\n', log->stream);
    return fflush(log->stream) == 0 ? BAT_OK : cannot("write", path, error);
}

bat_status learn_log_open(const char *path, const char *const *names, size_t columns, uint64_t step, learn_log *log,
                          bat_error *error)
{
    *log = (learn_log){.names = names, .columns = columns};
    if (path == NULL)
        return BAT_OK;
    size_t kept = 0;
    bat_status status = BAT_OK;
    if (step > 0 && access(path, F_OK) == 0)
        status = reopen(log, path, step, &kept, error);
    if (status == BAT_OK)
    {
        log->stream = fopen(path, kept > 0 ? "a" : "w");
        if (log->stream == NULL)
            status = cannot("open", path, error);
        else if (kept == 0)
            status = write_header(log, path, error);
    }
    if (status != BAT_OK)
        learn_log_close(log);
    return status;
}

void learn_log_close(learn_log *log)
{
    if (log->stream != NULL)
        (void)fclose(log->stream);
    free(log->rows);
    *log = (learn_log){0};
}

bat_status learn_log_add(learn_log *log, const double *row, bat_error *error)
{
    bat_status status = keep_row(log, row, error);
    if (status != BAT_OK || log->stream == NULL)
        return status;
    for (size_t c = 0; c < log->columns; c++)
    {
        char text[NUMBER_TEXT_SIZE];
        size_t length = isfinite(row[c]) ? (size_t)(number_write(text, row[c]) - text) : 0;
        (void)fwrite(text, 1, length, log->stream);
        (void)fputc(c + 1 < log->columns ? ',' : '\n', log->stream);
    }
    return fflush(log->stream) == 0 ? BAT_OK : cannot("write", "the log", error);
}

/// The finite numbers of a column over the epochs.
static size_t column_points(const learn_log *log, size_t column, double *x, double *y)
{
    size_t count = 0;
    for (size_t r = 0; r < log->row_count; r++)
    {
        const double *row = log->rows + r * log->columns;
        if (!isfinite(row[column]))
            continue;
        x[count] = row[LEARN_LOG_EPOCH];
        y[count] = row[column];
        count++;
    }
    return count;
}

/// A chart of a group of columns, without series when it has no numbers. A single column gives its name to the chart,
/// several stand in the legend in colours that no other chart has.
static bat_chart group_chart(const learn_log *log, size_t begin, size_t end, bat_chart_series *series, double *numbers,
                             int *colours)
{
    bool single = end - begin == 1;
    bat_chart chart = bat_chart_defaults();
    chart.series = series;
    chart.x_label = "epoch";
    chart.title = single ? log->names[begin] : NULL;
    chart.log_y = true;
    for (size_t column = begin; column < end; column++)
    {
        double *x = numbers + 2 * column * log->row_count, *y = x + log->row_count;
        size_t count = column_points(log, column, x, y);
        if (count == 0)
            continue;
        series[chart.series_count++] = (bat_chart_series){.x = x,
                                                          .y = y,
                                                          .count = count,
                                                          .mark = count > 1 ? BAT_CHART_LINE : BAT_CHART_POINTS,
                                                          .label = single ? NULL : log->names[column],
                                                          .colour = single ? 1 : ++*colours};
        for (size_t i = 0; i < count; i++)
            chart.log_y = chart.log_y && y[i] > 0;
    }
    return chart;
}

bat_status learn_log_draw(const learn_log *log, const char *path, const size_t *begins, const size_t *ends, size_t groups,
                          bat_error *error)
{
    size_t numbers_size = 2 * log->columns * log->row_count;
    double *numbers = malloc((numbers_size + 1) * sizeof *numbers);
    bat_chart_series *series = malloc((log->columns + 1) * sizeof *series);
    bat_chart *charts = malloc((groups + 1) * sizeof *charts);
    bat_status status = BAT_OK;
    if (numbers != NULL && series != NULL && charts != NULL)
    {
        size_t count = 0;
        int colours = 0;
        for (size_t g = 0; g < groups; g++)
        {
            charts[count] = group_chart(log, begins[g], ends[g], series + begins[g], numbers, &colours);
            count += charts[count].series_count > 0;
        }
        bat_curve_picture_options options = bat_curve_picture_defaults();
        options.columns = 3;
        if (count > 0)
            status = bat_chart_write(path, charts, count, &options, error);
    }
    else
        status = error_memory(error, numbers_size * sizeof *numbers);
    free(charts);
    free(series);
    free(numbers);
    return status;
}
