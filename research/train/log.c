#include "research/train/log.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "batten/research/chart_picture.h"
#include "io/common/file_text.h"
#include "io/common/number_text.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

enum
{
    COLUMN_EPOCH,
    COLUMN_STEP,
    COLUMN_RATE,
    COLUMN_LOSS,
    COLUMN_NORM,
    OWN_COLUMNS, ///< the metrics follow

    CHARTS = 5
};

static bat_status cannot(const char *what, const char *path, bat_error *error)
{
    return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot %s %s: %s", what, path, strerror(errno));
}

static bat_status append_row(train_log *log, const double *row, bat_error *error)
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
static bool is_header(const train_log *log, const text_line *line)
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
static bool read_row(const train_log *log, const text_line *line, double *row)
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

/// Read the rows up to a step; *size receives the bytes of the text that they and the header take. An incomplete last line
/// is ignored.
static bat_status read_rows(train_log *log, const file_text *text, uint64_t step, double *row, size_t *size,
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
            if (!(row[COLUMN_STEP] <= (double)step))
                return BAT_OK;
            bat_status status = append_row(log, row, error);
            if (status != BAT_OK)
                return status;
        }
        *size = (size_t)(line.next - text->data);
    }
    return BAT_OK;
}

/// Read the rows up to a step, *size bytes of the file, and truncate the file there.
static bat_status reopen(train_log *log, const char *path, uint64_t step, size_t *size, bat_error *error)
{
    file_text text;
    bat_status status = file_text_read(path, NULL, &text, error);
    if (status != BAT_OK)
        return error_prefix(error, status, "%s: ", path);
    double *row = calloc(log->columns, sizeof *row);
    status = row != NULL ? read_rows(log, &text, step, row, size, error) : error_memory(error, log->columns * sizeof *row);
    free(row);
    file_text_free(&text);
    status = error_prefix(error, status, "%s: ", path);
    if (status == BAT_OK && truncate(path, (off_t)*size) != 0)
        status = cannot("truncate", path, error);
    return status;
}

static bat_status write_header(const train_log *log, bat_error *error)
{
    for (size_t c = 0; c < log->columns; c++)
        (void)fprintf(log->stream, "%s%s", c > 0 ? "," : "", log->names[c]);
    (void)fputc('\n', log->stream);
    return fflush(log->stream) == 0 ? BAT_OK : cannot("write", log->path, error);
}

static bat_status open_file(train_log *log, uint64_t step, bat_error *error)
{
    size_t size = 0;
    bat_status status = BAT_OK;
    if (step > 0 && access(log->path, F_OK) == 0)
        status = reopen(log, log->path, step, &size, error);
    if (status != BAT_OK)
        return status;
    log->stream = fopen(log->path, size > 0 ? "a" : "w");
    if (log->stream == NULL)
        return cannot("open", log->path, error);
    return size == 0 ? write_header(log, error) : BAT_OK;
}

static bat_status write_row(const train_log *log, bat_error *error)
{
    for (size_t c = 0; c < log->columns; c++)
    {
        char text[NUMBER_TEXT_SIZE];
        size_t length = isfinite(log->row[c]) ? (size_t)(number_write(text, log->row[c]) - text) : 0;
        (void)fwrite(text, 1, length, log->stream);
        (void)fputc(c + 1 < log->columns ? ',' : '\n', log->stream);
    }
    return fflush(log->stream) == 0 ? BAT_OK : cannot("write", log->path, error);
}

// The picture

/// The finite numbers of a column over the epochs.
static size_t column_points(const train_log *log, size_t column, double *x, double *y)
{
    size_t count = 0;
    for (size_t r = 0; r < log->row_count; r++)
    {
        const double *row = log->rows + r * log->columns;
        if (!isfinite(row[column]))
            continue;
        x[count] = row[COLUMN_EPOCH];
        y[count] = row[column];
        count++;
    }
    return count;
}

/// A chart of a group of columns, without series when it has no numbers. A single column gives its name to the chart,
/// several stand in the legend in colours that no other chart has.
static bat_chart group_chart(const train_log *log, size_t begin, size_t end, bat_chart_series *series, double *numbers,
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
                                                          .mark = count > 1 ? BAT_CHART_MARK_LINE : BAT_CHART_MARK_POINTS,
                                                          .label = single ? NULL : log->names[column],
                                                          .colour = single ? 1 : ++*colours};
        for (size_t i = 0; i < count; i++)
            chart.log_y = chart.log_y && y[i] > 0;
    }
    return chart;
}

static bat_status draw_charts(const train_log *log, bat_chart *charts, bat_chart_series *series, double *numbers,
                              bat_error *error)
{
    size_t metrics_end = OWN_COLUMNS + log->own.metric_count, validation_end = metrics_end + log->own.validation_count;
    const size_t begins[CHARTS] = {COLUMN_LOSS, COLUMN_NORM, COLUMN_RATE, OWN_COLUMNS, metrics_end};
    const size_t ends[CHARTS] = {COLUMN_NORM, OWN_COLUMNS, COLUMN_LOSS, metrics_end, validation_end};
    size_t count = 0;
    int colours = 0;
    for (size_t g = 0; g < CHARTS; g++)
    {
        charts[count] = group_chart(log, begins[g], ends[g], series + begins[g], numbers, &colours);
        count += charts[count].series_count > 0;
    }
    bat_curve_picture_options options = bat_curve_picture_defaults();
    options.columns = 3;
    bat_status status = count > 0 ? bat_chart_write(log->picture, charts, count, &options, error) : BAT_OK;
    return error_prefix(error, status, "%s: ", log->picture);
}

static bat_status draw(const train_log *log, bat_error *error)
{
    if (log->picture == NULL)
        return BAT_OK;
    size_t number_count = 2 * log->columns * log->row_count;
    double *numbers = malloc((number_count + 1) * sizeof *numbers);
    bat_chart_series *series = malloc((log->columns + 1) * sizeof *series);
    bat_chart charts[CHARTS];
    bat_status status = numbers != NULL && series != NULL ? draw_charts(log, charts, series, numbers, error)
                                                          : error_memory(error, number_count * sizeof *numbers);
    free(series);
    free(numbers);
    return status;
}

// The observer

static bat_status begin(void *context, uint64_t step, bat_error *error)
{
    train_log *log = context;
    bat_status status = log->path != NULL ? open_file(log, step, error) : BAT_OK;
    return status == BAT_OK ? draw(log, error) : status;
}

static bat_status add_epoch(void *context, const learn_epoch *epoch, bat_error *error)
{
    train_log *log = context;
    size_t metrics_end = OWN_COLUMNS + log->own.metric_count;
    log->row[COLUMN_EPOCH] = (double)epoch->epoch;
    log->row[COLUMN_STEP] = (double)epoch->step;
    log->row[COLUMN_RATE] = epoch->rate;
    log->row[COLUMN_LOSS] = epoch->loss;
    log->row[COLUMN_NORM] = epoch->gradient_norm;
    memcpy(log->row + OWN_COLUMNS, epoch->metrics, log->own.metric_count * sizeof *log->row);
    memcpy(log->row + metrics_end, epoch->validation, log->own.validation_count * sizeof *log->row);
    log->row[log->columns - 1] = epoch->seconds;
    bat_status status = append_row(log, log->row, error);
    return status == BAT_OK && log->stream != NULL ? write_row(log, error) : status;
}

static bat_status draw_checkpoint(void *context, bat_error *error)
{
    return draw(context, error);
}

learn_observer train_log_observer(train_log *log)
{
    return (learn_observer){.context = log, .begin = begin, .epoch = add_epoch, .checkpoint = draw_checkpoint};
}

// All of it

static void name_columns(train_log *log)
{
    static const char *const own[OWN_COLUMNS] = {"epoch", "step", "rate", "loss", "gradient_norm"};
    size_t count = 0;
    for (size_t i = 0; i < OWN_COLUMNS; i++)
        log->names[count++] = own[i];
    for (size_t i = 0; i < log->own.metric_count; i++)
        log->names[count++] = log->own.metrics[i];
    for (size_t i = 0; i < log->own.validation_count; i++)
        log->names[count++] = log->own.validation[i];
    log->names[count] = "seconds";
}

bat_status train_log_make(const char *path, const char *picture, train_log_columns columns, train_log *log, bat_error *error)
{
    *log = (train_log){.path = path, .picture = picture, .own = columns};
    log->columns = OWN_COLUMNS + columns.metric_count + columns.validation_count + 1;
    log->names = calloc(log->columns, sizeof *log->names);
    log->row = calloc(log->columns, sizeof *log->row);
    if (log->names != NULL && log->row != NULL)
    {
        name_columns(log);
        return BAT_OK;
    }
    train_log_free(log);
    return error_memory(error, log->columns * (sizeof *log->names + sizeof *log->row));
}

void train_log_free(train_log *log)
{
    if (log->stream != NULL)
        (void)fclose(log->stream);
    free(log->names);
    free(log->row);
    free(log->rows);
    *log = (train_log){0};
}
