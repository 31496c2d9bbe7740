#include "batten/cloud_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/memory.h"
#include "io/common/block_writer.h"
#include "io/common/file_text.h"
#include "io/common/number_text.h"
#include "io/surface/cloud_formats.h"

#include <math.h>
#include <stdlib.h>

/// @file
/// Files of parameters (u, v), one row for each point of the cloud's input.

/// The number of points in the input, as far as the cloud has it: points dropped after the last one do not count.
static size_t input_count(const bat_cloud *cloud)
{
    size_t count = cloud->order == NULL ? cloud->count : 0;
    for (size_t i = 0; i < cloud->count && cloud->order != NULL; i++)
        count = cloud->order[i] >= count ? cloud->order[i] + 1 : count;
    return count;
}

static size_t place_of(const bat_cloud *cloud, size_t point)
{
    return cloud->order == NULL ? point : cloud->order[point];
}

static void append_row(text_buffer *text, const double *row)
{
    if (isnan(row[0]))
    {
        text_append_string(text, "nan nan\n");
        return;
    }
    text_append_number(text, row[0], ' ');
    text_append_number(text, row[1], '\n');
}

bat_status bat_cloud_parameters_write(const char *path, const bat_cloud *cloud, const double *parameters, bat_error *error)
{
    size_t count = input_count(cloud);
    double *rows = memory_array(count, 2 * sizeof *rows);
    if (rows == NULL)
        return error_memory(error, count * 2 * sizeof *rows);
    for (size_t k = 0; k < 2 * count; k++)
        rows[k] = NAN;
    for (size_t i = 0; i < cloud->count; i++)
        memcpy(rows + 2 * place_of(cloud, i), parameters + 2 * i, 2 * sizeof *rows);
    text_buffer text = {0};
    for (size_t i = 0; i < count; i++)
        append_row(&text, rows + 2 * i);
    free(rows);
    atomic_file file;
    bat_status status = atomic_file_begin(path, &file, error);
    if (status == BAT_OK)
    {
        text_sink sink = {.stream = file.stream};
        status = atomic_file_end(&file, sink_write(&sink, &text, error), error);
    }
    text_free(&text);
    return status;
}

/// Rows "u v" in the order of a file; NaN for a dropped point.
typedef struct row_listing
{
    double *rows;
    size_t count, capacity;
} row_listing;

static bat_status read_row(word_scan *scan, size_t index, double *row, bat_error *error)
{
    static const char *const NAMES[] = {"u", "v"};
    for (size_t k = 0; k < 2; k++)
    {
        if (scan_line_done(scan))
            return error_set(error, BAT_BAD_FILE, index, scan->line, "row %zu has no %s", index, NAMES[k]);
        if (scan_word(scan, "nan"))
            row[k] = NAN;
        else if (!scan_number(scan, &row[k]))
            return scan_number_fault(scan, index, NAMES[k], error);
        else if (row[k] < 0 || row[k] > 1)
            return error_set(error, BAT_BAD_FILE, index, scan->line, "%s of row %zu is %g, not from 0 to 1", NAMES[k], index,
                             row[k]);
    }
    if (!scan_line_done(scan))
        return error_set(error, BAT_BAD_FILE, index, scan->line, "row %zu has more than u and v", index);
    return BAT_OK;
}

static bat_status read_rows(const file_text *text, row_listing *listing, bat_error *error)
{
    word_scan scan = word_scan_start(text->data, text->size);
    while (scan_next_content(&scan))
    {
        if (!ARRAY_GROW(listing->rows, listing->capacity, 2 * (listing->count + 1)))
            return error_memory(error, listing->capacity * sizeof(double));
        bat_status status = read_row(&scan, listing->count, listing->rows + 2 * listing->count, error);
        if (status != BAT_OK)
            return status;
        listing->count++;
    }
    return BAT_OK;
}

static bat_status spread_rows(const row_listing *listing, const bat_cloud *cloud, double *parameters, bat_error *error)
{
    if (listing->rows == NULL || listing->count != input_count(cloud))
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "%zu rows of parameters for %zu points", listing->count,
                         input_count(cloud));
    for (size_t i = 0; i < cloud->count; i++)
    {
        const double *row = listing->rows + 2 * place_of(cloud, i);
        if (isnan(row[0]) || isnan(row[1]))
            return error_set(error, BAT_BAD_FILE, place_of(cloud, i), 0, "row %zu has no parameters", place_of(cloud, i));
        memcpy(parameters + 2 * i, row, 2 * sizeof *row);
    }
    return BAT_OK;
}

bat_status bat_cloud_parameters_read(const char *path, const bat_cloud *cloud, double **parameters, bat_error *error)
{
    file_text text;
    bat_status status = file_text_read(path, NULL, &text, error);
    if (status != BAT_OK)
        return status;
    row_listing listing = {0};
    double *read = memory_array(cloud->count, 2 * sizeof *read);
    if (read == NULL)
        status = error_memory(error, cloud->count * 2 * sizeof *read);
    if (status == BAT_OK)
        status = read_rows(&text, &listing, error);
    if (status == BAT_OK)
        status = spread_rows(&listing, cloud, read, error);
    if (status == BAT_OK)
        *parameters = read;
    else
        free(read);
    free(listing.rows);
    file_text_free(&text);
    return status;
}
