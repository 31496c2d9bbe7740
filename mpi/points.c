#include "points.h"

#include "ranks.h"
#include "rows.h"

#include "batten/research/surface_chart.h"
#include "batten/surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void file_part_free(file_part *part)
{
    free(part->rows);
    free(part->origins);
    *part = (file_part){0};
}

void fit_input_free(fit_input *input)
{
    free(input->points);
    free(input->parameters);
    free(input->numbers);
    *input = (fit_input){0};
}

static void set_error(bat_error *error, bat_status status, size_t index, const char *format, size_t number)
{
    *error = (bat_error){.status = status, .index = index};
    // NOLINTNEXTLINE(clang-diagnostic-format-nonliteral): one of the formats of this file
    (void)snprintf(error->text, sizeof error->text, format, number);
}

static size_t sum_over_ranks(size_t number)
{
    unsigned long long mine = number, sum = 0;
    (void)MPI_Allreduce(&mine, &sum, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, MPI_COMM_WORLD);
    return (size_t)sum;
}

static size_t sum_before(size_t number)
{
    unsigned long long mine = number, sum = 0;
    (void)MPI_Exscan(&mine, &sum, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, MPI_COMM_WORLD);
    return ranks_rank() == 0 ? 0 : (size_t)sum;
}

/// The numbers of all ranks.
static size_t *gather_all(size_t number)
{
    size_t *all = ranks_allocate((size_t)ranks_count(), sizeof *all);
    unsigned long long mine = number;
    _Static_assert(sizeof *all == sizeof mine, "sizes have 64 bits");
    (void)MPI_Allgather(&mine, 1, MPI_UNSIGNED_LONG_LONG, all, 1, MPI_UNSIGNED_LONG_LONG, MPI_COMM_WORLD);
    return all;
}

// Parameters of a second file

/// Send the lines "u v" of this rank to the ranks that have the points of these lines.
static bool join_parameters(const char *path, file_part *part)
{
    rows_text text = {.columns = 2, .needed = 2};
    bat_error error = {0};
    if (!rows_read_text(path, &text))
        return false;
    bat_status status = BAT_OK;
    size_t lines = sum_over_ranks(text.count), points = sum_over_ranks(part->count);
    if (lines != points)
    {
        set_error(&error, BAT_BAD_FILE, BAT_NO_INDEX, "has not as many lines as there are points (%zu)", points);
        status = BAT_BAD_FILE;
    }
    if (!ranks_agree(path, status, &error))
    {
        free(text.values);
        return false;
    }
    size_t ranks = (size_t)ranks_count(), first = sum_before(text.count), *counts = ranks_allocate(ranks, sizeof *counts);
    size_t *each = gather_all(part->count), begin = 0, received;
    for (size_t rank = 0; rank < ranks; rank++)
    {
        size_t end = begin + each[rank], low = begin > first ? begin : first;
        size_t high = end < first + text.count ? end : first + text.count;
        counts[rank] = high > low ? high - low : 0;
        begin = end;
    }
    double *parameters = rows_exchange(text.values, 2 * sizeof(double), counts, &received);
    for (size_t i = 0; i < part->count; i++)
        memcpy(part->rows[i].at + 3, parameters + 2 * i, 2 * sizeof(double));
    free(parameters);
    free(counts);
    free(each);
    free(text.values);
    return true;
}

// Points that repeat others

static uint64_t mix(uint64_t z)
{
    // The finalizer of splitmix64: Steele, Lea and Flood (2014).
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static uint64_t hash_of(const double *numbers, size_t count)
{
    uint64_t hash = UINT64_C(0x9e3779b97f4a7c15);
    for (size_t k = 0; k < count; k++)
    {
        double number = numbers[k] + 0.0; // -0 is 0
        uint64_t bits;
        memcpy(&bits, &number, sizeof bits);
        hash = mix(hash ^ bits) + UINT64_C(0x9e3779b97f4a7c15);
    }
    return hash;
}

/// A place in space, sent to the rank that compares it with its equals.
typedef struct place_row
{
    double at[3];
    uint64_t number;
} place_row;

/// Find rows whose place an earlier row has. Rows are in the order of their numbers.
/// @param repeated receives their numbers, ascending
/// @return their number
static size_t find_repeated(const place_row *rows, size_t count, uint64_t *repeated)
{
    size_t size = 16, found = 0;
    while (size < 2 * count)
        size *= 2;
    uint32_t *table = ranks_allocate(size, sizeof *table);
    for (size_t i = 0; i < count; i++)
    {
        size_t place = mix(hash_of(rows[i].at, 3)) & (size - 1);
        const double *at = rows[i].at;
        while (table[place] != 0)
        {
            const double *other = rows[table[place] - 1].at;
            if (other[0] == at[0] && other[1] == at[1] && other[2] == at[2])
                break;
            place = (place + 1) & (size - 1);
        }
        if (table[place] != 0)
            repeated[found++] = rows[i].number;
        else
            table[place] = (uint32_t)i + 1;
    }
    free(table);
    return found;
}

/// Rows of this rank, by the rank that compares them.
static place_row *send_places(const file_part *part, size_t *received)
{
    size_t ranks = (size_t)ranks_count(), *counts = ranks_allocate(2 * ranks + 1, sizeof *counts), *places = counts + ranks;
    place_row *rows = ranks_allocate(part->count, sizeof *rows);
    for (size_t i = 0; i < part->count; i++)
        counts[hash_of(part->rows[i].at, 3) % ranks]++;
    for (size_t rank = 0; rank < ranks; rank++)
        places[rank + 1] = places[rank] + counts[rank];
    for (size_t i = 0; i < part->count; i++)
    {
        const point_row *row = &part->rows[i];
        rows[places[hash_of(row->at, 3) % ranks]++] = (place_row){{row->at[0], row->at[1], row->at[2]}, row->number};
    }
    place_row *there = rows_exchange(rows, sizeof *rows, counts, received);
    free(rows);
    free(counts);
    return there;
}

/// Leave out points that repeat earlier ones, and number the others anew.
static bool drop_repeated(const char *path, bool strict, file_part *part)
{
    size_t count, ranks = (size_t)ranks_count(), back, kept = 0, *counts = ranks_allocate(ranks, sizeof *counts);
    place_row *rows = send_places(part, &count);
    uint64_t *repeated = ranks_allocate(count, sizeof *repeated);
    size_t *each = gather_all(part->count), begin = 0, at = 0;
    size_t found = find_repeated(rows, count, repeated);
    free(rows);
    for (size_t rank = 0; rank < ranks; rank++)
    {
        begin += each[rank];
        for (; at < found && repeated[at] < begin; at++)
            counts[rank]++;
    }
    uint64_t *mine = rows_exchange(repeated, sizeof *repeated, counts, &back);
    free(repeated);
    free(counts);
    free(each);
    bat_error error = {0};
    if (strict && back > 0)
        set_error(&error, BAT_INVALID_POINT, (size_t)mine[0], "point %zu repeats another", (size_t)mine[0]);
    if (!ranks_agree(path, error.status, &error))
    {
        free(mine);
        return false;
    }
    size_t first = sum_before(part->count), on_boundary = 0;
    char *dropped = ranks_allocate(part->count + 1, 1);
    for (size_t k = 0; k < back; k++)
    {
        dropped[mine[k] - first] = 1;
        on_boundary += mine[k] < part->boundary;
    }
    for (size_t i = 0; i < part->count; i++)
        if (!dropped[i])
            part->rows[kept++] = part->rows[i];
    free(dropped);
    free(mine);
    part->count = kept;
    part->duplicates = sum_over_ranks(back);
    part->boundary -= sum_over_ranks(on_boundary);
    first = sum_before(kept);
    for (size_t i = 0; i < kept; i++)
        part->rows[i].number = first + i;
    return true;
}

// Checks

static bool is_end(double parameter)
{
    return parameter == 0 || parameter == 1;
}

/// Check the numbers of all points; boundary points off the sides make all points free, as in bat_surface_reconstruct().
static bool check_points(const char *path, file_part *part)
{
    bat_error error = {0};
    int on_sides = 1, all = 1;
    for (size_t i = 0; i < part->count && error.status == BAT_OK; i++)
    {
        const point_row *row = &part->rows[i];
        if (!isfinite(row->at[0]) || !isfinite(row->at[1]) || !isfinite(row->at[2]))
            set_error(&error, BAT_INVALID_POINT, (size_t)row->number, "point %zu has a coordinate that is not finite",
                      (size_t)row->number);
        else if (!(row->at[3] >= 0 && row->at[3] <= 1 && row->at[4] >= 0 && row->at[4] <= 1))
            set_error(&error, BAT_INVALID_POINT, (size_t)row->number,
                      "the parameter of point %zu is outside the unit square", (size_t)row->number);
        if (row->number < part->boundary && !is_end(row->at[3]) && !is_end(row->at[4]))
            on_sides = 0;
    }
    size_t total = sum_over_ranks(part->count);
    if (error.status == BAT_OK && total < 4)
        set_error(&error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX,
                  "a surface patch needs at least four points, the cloud has %zu", total);
    if (error.status == BAT_OK && total >= UINT32_MAX)
        set_error(&error, BAT_TOO_LARGE, BAT_NO_INDEX, "%zu points are more than a fit can process", total);
    (void)MPI_Allreduce(&on_sides, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    part->boundary = all != 0 ? part->boundary : 0;
    return ranks_agree(path, error.status, &error);
}

// Distribution along the curve

static int compare_keys(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/// The place of a row among others.
typedef uint32_t row_key(const void *context, const point_row *row);

static uint32_t curve_key(const void *context, const point_row *row)
{
    (void)context;
    return bat_surface_fit_order(row->at + 3);
}

/// A row of one key with others.
typedef struct numbered_row
{
    uint64_t number, key;
} numbered_row;

static int compare_numbered(const void *a, const void *b)
{
    const numbered_row *p = a, *q = b;
    return (p->number > q->number) - (p->number < q->number);
}

/// Sort rows of one key by their numbers.
static void sort_equal(const point_row *rows, uint64_t *keys, size_t count)
{
    numbered_row *order = ranks_allocate(count, sizeof *order);
    for (size_t i = 0; i < count; i++)
        order[i] = (numbered_row){rows[keys[i] & UINT32_MAX].number, keys[i]};
    qsort(order, count, sizeof *order, compare_numbered);
    for (size_t i = 0; i < count; i++)
        keys[i] = order[i].key;
    free(order);
}

/// The keys of rows, with the index of the row in the lower bits: ascending, rows of one key by number.
static uint64_t *sort_rows(const point_row *rows, size_t count, row_key *key, const void *context)
{
    uint64_t *keys = ranks_allocate(count, sizeof *keys);
    for (size_t i = 0; i < count; i++)
        keys[i] = (uint64_t)key(context, &rows[i]) << 32 | i;
    qsort(keys, count, sizeof *keys, compare_keys);
    for (size_t begin = 0, end; begin < count; begin = end)
    {
        for (end = begin + 1; end < count && keys[end] >> 32 == keys[begin] >> 32;)
            end++;
        if (end > begin + 1)
            sort_equal(rows, keys + begin, end - begin);
    }
    return keys;
}

/// The number of rows before a place: a key, and the number of a point.
static size_t rows_before(const point_row *rows, const uint64_t *keys, size_t count, uint64_t place)
{
    size_t low = 0, high = count;
    while (low < high)
    {
        size_t middle = (low + high) / 2;
        uint64_t here = keys[middle] >> 32 << 32 | rows[keys[middle] & UINT32_MAX].number;
        if (here < place)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/// The number of blocks of ranks up to this one. Rank 0 has fewer by `relief`.
static size_t blocks_until(size_t rank, size_t blocks, size_t relief)
{
    enum
    {
        MIN_RANKS = 4 ///< for a relief
    };
    size_t ranks = (size_t)ranks_count();
    if (ranks < MIN_RANKS)
        return blocks * (rank + 1) / ranks;
    size_t share = (blocks + relief) / ranks, first = share > relief ? share - relief : 0;
    return first + (blocks - first) * rank / (ranks - 1);
}

/// Divide the rows so that each rank gets whole blocks, about the same number. Bisects all limits at once.
/// @param relief     blocks
/// @param whole_keys rows of one key go to one rank, so that blocks may be parted
/// @param counts     receives the number of rows of this rank that go to each
static void divide_rows(const point_row *rows, const uint64_t *keys, size_t count, size_t total, size_t relief,
                        bool whole_keys, size_t *counts)
{
    size_t ranks = (size_t)ranks_count(), blocks = (total + BAT_SURFACE_FIT_BLOCK - 1) / BAT_SURFACE_FIT_BLOCK;
    uint64_t *low = ranks_allocate(4 * ranks, sizeof *low), *high = low + ranks, *mine = high + ranks, *all = mine + ranks;
    for (size_t rank = 0; rank < ranks; rank++)
        high[rank] = UINT64_MAX;
    // The least place before which there are as many points as lower ranks get.
    for (int step = 0; step < 64; step++)
    {
        for (size_t rank = 0; rank < ranks; rank++)
            mine[rank] = rows_before(rows, keys, count, low[rank] + (high[rank] - low[rank]) / 2);
        (void)MPI_Allreduce(mine, all, (int)ranks, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
        for (size_t rank = 0; rank < ranks; rank++)
        {
            uint64_t middle = low[rank] + (high[rank] - low[rank]) / 2;
            size_t wanted = blocks_until(rank, blocks, relief) * BAT_SURFACE_FIT_BLOCK;
            if (low[rank] == high[rank])
                continue;
            if (all[rank] < (wanted < total ? wanted : total))
                low[rank] = middle + 1;
            else
                high[rank] = middle;
        }
    }
    size_t before = 0;
    for (size_t rank = 0; rank < ranks; rank++)
    {
        uint64_t limit = whole_keys ? low[rank] >> 32 << 32 : low[rank];
        size_t end = rank + 1 < ranks ? rows_before(rows, keys, count, limit) : count;
        counts[rank] = end - before;
        before = end;
    }
    free(low);
}

/// Send all points to their ranks. Empties the part.
static point_row *send_points(file_part *part, row_key *key, const void *context, bool whole_keys, size_t relief,
                              size_t *received)
{
    size_t ranks = (size_t)ranks_count(), *counts = ranks_allocate(ranks, sizeof *counts);
    size_t total = sum_over_ranks(part->count);
    uint64_t *keys = sort_rows(part->rows, part->count, key, context);
    point_row *sorted = ranks_allocate(part->count, sizeof *sorted);
    divide_rows(part->rows, keys, part->count, total, relief / BAT_SURFACE_FIT_BLOCK, whole_keys, counts);
    for (size_t i = 0; i < part->count; i++)
        sorted[i] = part->rows[keys[i] & UINT32_MAX];
    free(keys);
    free(part->rows);
    part->rows = NULL;
    point_row *rows = rows_exchange(sorted, sizeof *sorted, counts, received);
    free(sorted);
    free(counts);
    return rows;
}

void fit_input_distribute(file_part *part, size_t samples, size_t relief, fit_input *input)
{
    *input = (fit_input){.samples = samples};
    input->total = sum_over_ranks(part->count);
    input->boundary_count = part->boundary;
    input->duplicates = part->duplicates;
    point_row *rows = send_points(part, curve_key, NULL, false, relief, &input->count);
    uint64_t *keys = sort_rows(rows, input->count, curve_key, NULL), label = 0;
    size_t count = input->count;
    input->points = ranks_allocate(count * 3, sizeof(double));
    input->parameters = ranks_allocate(count * 2, sizeof(double));
    input->numbers = ranks_allocate(count, sizeof(uint32_t));
    for (size_t i = 0; i < count; i++)
    {
        const point_row *row = &rows[keys[i] & UINT32_MAX];
        memcpy(input->points + 3 * i, row->at, 3 * sizeof(double));
        memcpy(input->parameters + 2 * i, row->at + 3, 2 * sizeof(double));
        input->numbers[i] = (uint32_t)row->number;
        label += mix(hash_of(row->at, 5) ^ mix(row->number));
    }
    free(keys);
    free(rows);
    (void)MPI_Allreduce(&label, &input->label, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
    input->label += input->boundary_count;
    input->first = sum_before(count);
}

// Points without parameters

/// More than there are points.
static const double NUMBERS = 0x1p32;

uint64_t place_hash(const double place[3])
{
    return mix(hash_of(place, 3));
}

/// What the order of points depends on.
typedef struct cloud_frame
{
    double centre[3];
    double farthest; ///< by bat_surface_chart_order()
} cloud_frame;

static cloud_frame find_frame(const file_part *part)
{
    cloud_frame frame;
    double ends[6], all[6], farthest = 0;
    for (int k = 0; k < 6; k++)
        ends[k] = -INFINITY;
    for (size_t i = 0; i < part->count; i++)
        for (int k = 0; k < 3; k++)
        {
            ends[k] = fmax(ends[k], part->rows[i].at[k]);
            ends[3 + k] = fmax(ends[3 + k], -part->rows[i].at[k]);
        }
    (void)MPI_Allreduce(ends, all, 6, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    for (int k = 0; k < 3; k++)
        frame.centre[k] = -all[3 + k] * 0.5 + all[k] * 0.5;
    for (size_t i = 0; i < part->count; i++)
        farthest = fmax(farthest, bat_surface_chart_order(part->rows[i].at, frame.centre));
    (void)MPI_Allreduce(&farthest, &frame.farthest, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    return frame;
}

static uint32_t distance_key(const void *context, const point_row *row)
{
    const cloud_frame *frame = context;
    double distance = bat_surface_chart_order(row->at, frame->centre);
    return frame->farthest > 0 ? (uint32_t)(distance / frame->farthest * (double)UINT32_MAX) : 0;
}

/// By v, the distance, and then by coordinates.
static int compare_rows(const void *a, const void *b)
{
    static const int KEYS[] = {4, 0, 1, 2};
    const point_row *p = a, *q = b;
    for (int k = 0; k < 4; k++)
        if (p->at[KEYS[k]] != q->at[KEYS[k]])
            return p->at[KEYS[k]] < q->at[KEYS[k]] ? -1 : 1;
    return 0;
}

void file_part_sort(file_part *part)
{
    cloud_frame frame = find_frame(part);
    for (size_t i = 0; i < part->count; i++)
    {
        point_row *row = &part->rows[i];
        row->at[3] = row->number < part->boundary ? (double)row->number + 1 : 0;
        row->number = (uint64_t)(row->at[4] * NUMBERS);
        row->at[4] = bat_surface_chart_order(row->at, frame.centre);
    }
    size_t received;
    point_row *rows = send_points(part, distance_key, &frame, true, 0, &received);
    qsort(rows, received, sizeof *rows, compare_rows);
    part->rows = rows;
    part->count = received;
    size_t first = sum_before(received);
    part->origins = ranks_allocate(received, sizeof *part->origins);
    part->origin_first = first;
    part->origin_count = received;
    for (size_t i = 0; i < received; i++)
    {
        part->origins[i] = (uint32_t)rows[i].number;
        rows[i].number = first + i;
    }
}

/// Read the columns of a file.
/// @param needed 3, or 5 for points with parameters
static bool read_rows(const char *path, bat_cloud_format format, size_t needed, size_t boundary, file_part *part)
{
    rows_text text = {.columns = 5, .needed = needed};
    *part = (file_part){0};
    const bat_choice *row = NULL;
    if (format == BAT_CLOUD_FORMAT_AUTO && bat_choice_of_path(&bat_cloud_format_family, path, false, &row, NULL) == BAT_OK)
        format = row != NULL ? (bat_cloud_format)row->value : format;
    if (!(format == BAT_CLOUD_FORMAT_PLY ? rows_read_ply(path, &text) : rows_read_text(path, &text)))
        return false;
    part->count = text.count;
    part->boundary = boundary > 0 ? boundary : text.boundary;
    part->rows = ranks_allocate(part->count, sizeof *part->rows);
    size_t first = sum_before(part->count);
    for (size_t i = 0; i < part->count; i++)
    {
        memcpy(part->rows[i].at, text.values + i * text.columns, sizeof part->rows[i].at);
        part->rows[i].number = first + i;
    }
    free(text.values);
    return true;
}

bool file_part_read(const char *path, bat_cloud_format format, size_t boundary, bool strict, file_part *part)
{
    if (!read_rows(path, format, 3, boundary, part))
        return false;
    // v keeps the number in the file, as a fraction; u = 0 is a side of the square, so that the check keeps the boundary.
    for (size_t i = 0; i < part->count; i++)
    {
        part->rows[i].at[3] = 0;
        part->rows[i].at[4] = fmin((double)part->rows[i].number / NUMBERS, 1);
    }
    bool good = drop_repeated(path, strict, part) && check_points(path, part);
    if (!good)
        file_part_free(part);
    return good;
}

bool fit_input_read(const char *path, const char *parameters, bat_cloud_format format, size_t boundary, bool strict,
                    size_t relief, fit_input *input)
{
    file_part part;
    *input = (fit_input){0};
    if (!read_rows(path, format, parameters == NULL ? 5 : 3, boundary, &part))
        return false;
    bool good = (parameters == NULL || join_parameters(parameters, &part)) && drop_repeated(path, strict, &part) &&
                check_points(path, &part);
    if (good)
        fit_input_distribute(&part, 0, relief, input);
    file_part_free(&part);
    return good;
}
