#include "chart.h"

#include "ranks.h"
#include "rows.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    BROADCAST = 1 << 30 ///< bytes at once
};

void shared_chart_free(shared_chart *shared)
{
    bat_surface_chart_free(shared->chart);
    bat_cloud_free(&shared->cloud);
    *shared = (shared_chart){0};
}

/// Every rank receives the bytes of rank 0.
static void broadcast(void *bytes, size_t size)
{
    for (size_t at = 0; at < size; at += BROADCAST)
        (void)MPI_Bcast((char *)bytes + at, (int)(size - at < BROADCAST ? size - at : BROADCAST), MPI_BYTE, 0,
                        MPI_COMM_WORLD);
}

/// Every rank receives the bytes of rank 0, which may be of any number.
/// @return them, from malloc(); of rank 0 those given
static void *share(void *bytes, size_t *size)
{
    uint64_t numbers = *size;
    broadcast(&numbers, sizeof numbers);
    *size = (size_t)numbers;
    if (ranks_rank() != 0)
        bytes = ranks_allocate(*size, 1);
    broadcast(bytes, *size);
    return bytes;
}

/// Every rank receives a failure of rank 0.
static bat_status share_status(bat_status status, bat_error *error)
{
    bat_error sent = status == BAT_OK ? (bat_error){0} : *error;
    sent.status = status;
    broadcast(&sent, sizeof sent);
    if (sent.status != BAT_OK)
        *error = sent;
    return sent.status;
}

/// Rank 0 receives rows of all ranks, in their order.
static void *collect(const void *rows, size_t row_bytes, size_t count, size_t *received)
{
    size_t *counts = ranks_allocate((size_t)ranks_count(), sizeof *counts);
    counts[0] = count;
    void *all = rows_exchange(rows, row_bytes, counts, received);
    free(counts);
    return all;
}

// The sample

static bool is_sampled(const shared_chart *shared, const double place[3])
{
    return shared->limit == UINT64_MAX || place_hash(place) < shared->limit;
}

/// Loop points first, in their order, then the others by number.
static int compare_sampled(const void *a, const void *b)
{
    const point_row *p = a, *q = b;
    double at = p->at[3] > 0 ? p->at[3] : 1e18, other = q->at[3] > 0 ? q->at[3] : 1e18;
    if (at != other)
        return at < other ? -1 : 1;
    return (p->number > q->number) - (p->number < q->number);
}

/// The cloud of sorted rows; u of those on the boundary is above 0.
static void make_cloud(point_row *rows, size_t count, bat_cloud *cloud)
{
    qsort(rows, count, sizeof *rows, compare_sampled);
    bat_cloud_free(cloud);
    *cloud = (bat_cloud){
        .points = ranks_allocate(count, 3 * sizeof(double)), .order = ranks_allocate(count, sizeof(size_t)), .count = count};
    for (size_t i = 0; i < count; i++)
    {
        memcpy(cloud->points + 3 * i, rows[i].at, 3 * sizeof(double));
        cloud->order[i] = (size_t)rows[i].number;
        cloud->boundary_count += rows[i].at[3] > 0;
    }
}

void shared_chart_sample(const file_part *part, size_t total, size_t wanted, shared_chart *shared)
{
    // The largest numbers of 64 bits are not doubles.
    double share = (double)wanted / (double)total;
    *shared =
        (shared_chart){.limit = total <= wanted ? UINT64_MAX : (uint64_t)(share * 0x1p64), .found = part->boundary == 0};
    size_t count = 0, received;
    for (size_t i = 0; i < part->count; i++)
        count += part->rows[i].at[3] > 0 || is_sampled(shared, part->rows[i].at);
    point_row *rows = ranks_allocate(count, sizeof *rows);
    for (size_t i = 0, made = 0; i < part->count; i++)
        if (part->rows[i].at[3] > 0 || is_sampled(shared, part->rows[i].at))
            rows[made++] = part->rows[i];
    point_row *all = collect(rows, sizeof *rows, count, &received);
    free(rows);
    if (ranks_rank() == 0)
        make_cloud(all, received, &shared->cloud);
    free(all);
}

// The loop of a sample, moved outwards

/// The outermost point at a point of the loop.
typedef struct outer_row
{
    double outward;
    point_row row;
} outer_row;

/// The outermost points of this rank.
static outer_row *find_outer(const file_part *part, const double *frames, size_t loop)
{
    double *points = ranks_allocate(part->count, 3 * sizeof *points), *outwards = ranks_allocate(loop, sizeof *outwards);
    size_t *outer = ranks_allocate(loop, sizeof *outer);
    outer_row *found = ranks_allocate(loop, sizeof *found);
    bat_error error;
    for (size_t i = 0; i < part->count; i++)
        memcpy(points + 3 * i, part->rows[i].at, 3 * sizeof *points);
    ranks_need(NULL, bat_surface_loop_outermost(frames, loop, points, part->count, outwards, outer, &error), &error);
    for (size_t k = 0; k < loop; k++)
        if (outwards[k] > 0)
            found[k] = (outer_row){outwards[k], part->rows[outer[k]]};
    free(points);
    free(outwards);
    free(outer);
    return found;
}

static int compare_by_number(const void *a, const void *b)
{
    const point_row *p = a, *q = b;
    return (p->number > q->number) - (p->number < q->number);
}

/// Replace points of the loop of rank 0 by the outermost ones of all ranks.
/// @param all rows of the loop, rank after rank
static void replace_loop(const outer_row *all, bat_cloud *cloud)
{
    size_t loop = cloud->boundary_count, count = 0, kept = 0;
    point_row *rows = ranks_allocate(cloud->count + loop, sizeof *rows);
    for (size_t k = 0; k < loop; k++)
    {
        const outer_row *best = NULL;
        for (size_t rank = 0; rank < (size_t)ranks_count(); rank++)
        {
            const outer_row *other = &all[rank * loop + k];
            if (other->outward > (best != NULL ? best->outward : 0))
                best = other;
        }
        if (best == NULL)
            continue;
        rows[count] = best->row;
        rows[count++].at[3] = (double)k + 1;
    }
    size_t replacing = count;
    for (size_t i = 0; i < cloud->count; i++)
    {
        point_row row = {.number = cloud->order[i]};
        memcpy(row.at, cloud->points + 3 * i, 3 * sizeof *row.at);
        rows[count++] = row;
    }
    // A point of the loop that is not replaced stays in it.
    char *replaced = ranks_allocate(loop, 1);
    for (size_t k = 0; k < replacing; k++)
        replaced[(size_t)rows[k].at[3] - 1] = 1;
    for (size_t k = 0; k < loop; k++)
        rows[replacing + k].at[3] = replaced[k] ? 0 : (double)k + 1;
    free(replaced);
    // A point that is in the sample already is there twice: first as one of the loop.
    qsort(rows, count, sizeof *rows, compare_by_number);
    for (size_t i = 0; i < count; i++)
    {
        bool repeats = kept > 0 && rows[kept - 1].number == rows[i].number;
        if (repeats && rows[i].at[3] > rows[kept - 1].at[3])
            rows[kept - 1] = rows[i];
        else if (!repeats)
            rows[kept++] = rows[i];
    }
    make_cloud(rows, kept, cloud);
    free(rows);
}

/// Move the loop of rank 0 outwards.
static bat_status move_loop(const file_part *part, shared_chart *shared, bat_error *error)
{
    size_t size = 0;
    double *frames = NULL;
    bat_status status = BAT_OK;
    if (ranks_rank() == 0)
    {
        size = shared->cloud.boundary_count * BAT_SURFACE_LOOP_FRAME * sizeof *frames;
        frames = ranks_allocate(size, 1);
        status = bat_surface_loop_frames(&shared->cloud, frames, error);
    }
    status = share_status(status, error);
    if (status == BAT_OK)
    {
        frames = share(frames, &size);
        size_t loop = size / (BAT_SURFACE_LOOP_FRAME * sizeof *frames), received;
        outer_row *found = find_outer(part, frames, loop), *all = collect(found, sizeof *found, loop, &received);
        free(found);
        if (ranks_rank() == 0)
            replace_loop(all, &shared->cloud);
        free(all);
    }
    free(frames);
    return status;
}

bat_status shared_chart_find(const file_part *part, const bat_surface_reconstruct_options *options, bool again,
                             shared_chart *shared, bat_error *error)
{
    bool first = ranks_rank() == 0;
    bat_status status = BAT_OK;
    double begin = MPI_Wtime();
    if (first && shared->found)
        status = bat_surface_chart_boundary(&shared->cloud, again, options->fit.progress, error);
    status = share_status(status, error);
    if (status == BAT_OK && shared->found && shared->limit != UINT64_MAX)
        status = move_loop(part, shared, error);
    shared->seconds = MPI_Wtime() - begin;
    void *bytes = NULL;
    size_t size = 0;
    if (status == BAT_OK && first)
        status = bat_surface_chart_find(&shared->cloud, options, &shared->chart, error);
    if (status == BAT_OK && first)
        status = bat_surface_chart_pack(shared->chart, &bytes, &size, error);
    status = share_status(status, error);
    if (status == BAT_OK)
        bytes = share(bytes, &size);
    if (status == BAT_OK && !first)
        ranks_need(NULL, bat_surface_chart_unpack(bytes, size, &shared->chart, error), error);
    free(bytes);
    return status;
}

// Distribution

/// A point of the loop.
typedef struct loop_place
{
    uint64_t number; ///< of file_part_sort()
    uint64_t place;  ///< in the loop
} loop_place;

static int compare_loop(const void *a, const void *b)
{
    const loop_place *p = a, *q = b;
    return (p->number > q->number) - (p->number < q->number);
}

/// The loop by the numbers of its points, on all ranks.
static loop_place *share_loop(const shared_chart *shared, size_t loop)
{
    loop_place *places = ranks_allocate(loop, sizeof *places);
    for (size_t k = 0; k < loop && ranks_rank() == 0; k++)
        places[k] = (loop_place){shared->cloud.order[k], k};
    broadcast(places, loop * sizeof *places);
    qsort(places, loop, sizeof *places, compare_loop);
    return places;
}

/// Give the rows parameters.
static void locate(const shared_chart *shared, file_part *part)
{
    enum
    {
        AT_ONCE = 1 << 16
    };
    double *points = ranks_allocate(AT_ONCE, 3 * sizeof *points), *parameters = ranks_allocate(AT_ONCE, 2 * sizeof *points);
    bat_error error;
    for (size_t begin = 0; begin < part->count; begin += AT_ONCE)
    {
        size_t count = part->count - begin < AT_ONCE ? part->count - begin : AT_ONCE;
        for (size_t i = 0; i < count; i++)
            memcpy(points + 3 * i, part->rows[begin + i].at, 3 * sizeof *points);
        ranks_need(NULL, bat_surface_chart_locate(shared->chart, points, count, parameters, &error), &error);
        for (size_t i = 0; i < count; i++)
            memcpy(part->rows[begin + i].at + 3, parameters + 2 * i, 2 * sizeof *parameters);
    }
    free(points);
    free(parameters);
}

/// Number the rows as bat_surface_reconstruct() does: the loop first. Points of the loop get its parameters.
static void number_rows(const shared_chart *shared, file_part *part)
{
    const double *points, *parameters;
    size_t loop = bat_surface_chart_loop(shared->chart, &points, &parameters, NULL), before = 0;
    loop_place *places = share_loop(shared, loop);
    for (size_t i = 0; i < part->count; i++)
    {
        point_row *row = &part->rows[i];
        while (before < loop && places[before].number < row->number)
            before++;
        if (before < loop && places[before].number == row->number)
        {
            row->number = places[before].place;
            memcpy(row->at + 3, parameters + 2 * row->number, 2 * sizeof *row->at);
        }
        else
            row->number += loop - before;
    }
    part->boundary = loop;
    free(places);
}

/// Add the samples of border curves to the rows of rank 0.
static void add_samples(const bat_surface_border *border, size_t total, file_part *part)
{
    const double *points, *parameters;
    size_t samples = bat_surface_border_samples(border, &points, &parameters);
    if (ranks_rank() != 0 || samples == 0)
        return;
    part->rows = ranks_grow(part->rows, part->count + samples, sizeof *part->rows);
    for (size_t s = 0; s < samples; s++)
    {
        point_row *row = &part->rows[part->count++];
        *row = (point_row){.number = total + s};
        memcpy(row->at, points + 3 * s, 3 * sizeof *row->at);
        memcpy(row->at + 3, parameters + 2 * s, 2 * sizeof *row->at);
    }
}

bat_status shared_chart_distribute(const shared_chart *shared, file_part *part, const bat_surface_fit_options *options,
                                   size_t relief, fit_input *input, bat_surface_border **border, size_t *functions,
                                   bat_error *error)
{
    const double *points, *parameters;
    unsigned long long mine = part->count, total = 0;
    (void)MPI_Allreduce(&mine, &total, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, MPI_COMM_WORLD);
    locate(shared, part);
    number_rows(shared, part);
    bat_surface_fit_data loop = {.dimension = 3};
    loop.boundary_count = loop.count = bat_surface_chart_loop(shared->chart, &points, &parameters, functions);
    loop.points = points;
    loop.parameters = ranks_allocate(loop.count, 2 * sizeof(double));
    memcpy(loop.parameters, parameters, loop.count * 2 * sizeof(double));
    bat_status status = bat_surface_border_make(&loop, options, border, error);
    free(loop.parameters);
    // All ranks make the same.
    if (status != BAT_OK)
        return status;
    add_samples(*border, (size_t)total, part);
    fit_input_distribute(part, bat_surface_border_samples(*border, &points, &parameters), relief, input);
    return BAT_OK;
}

// The verdict

/// What rank 0 receives of a point of the sample.
typedef struct judged_row
{
    uint64_t number;
    double parameter[2], distance;
} judged_row;

static int compare_judged(const void *a, const void *b)
{
    const judged_row *p = a, *q = b;
    return (p->number > q->number) - (p->number < q->number);
}

static bool is_judged(const shared_chart *shared, const fit_input *input, size_t row)
{
    uint64_t number = input->numbers[row];
    if (number >= input->total - input->samples)
        return false;
    return number < input->boundary_count || is_sampled(shared, input->points + 3 * row);
}

/// Judge the rows of the sample, on rank 0.
static bat_status judge(const shared_chart *shared, judged_row *rows, size_t count, bat_surface_result *result,
                        bat_error *error)
{
    double *parameters = ranks_allocate(count, 2 * sizeof *parameters),
           *distances = ranks_allocate(count, sizeof *distances);
    qsort(rows, count, sizeof *rows, compare_judged);
    for (size_t i = 0; i < count; i++)
    {
        memcpy(parameters + 2 * i, rows[i].parameter, 2 * sizeof *parameters);
        distances[i] = rows[i].distance;
    }
    bat_error wrong = {.status = BAT_INVALID_ARGUMENT, .index = BAT_NO_INDEX, .text = "the sample has lost points"};
    ranks_need(NULL, count == shared->cloud.count ? BAT_OK : BAT_INVALID_ARGUMENT, &wrong);
    bat_surface_result judged = {0};
    bat_status status =
        bat_surface_chart_finish(shared->chart, &result->surface, &result->report, parameters, distances, &judged, error);
    if (status == BAT_OK)
        *result = judged;
    free(parameters);
    free(distances);
    return status;
}

bat_status shared_chart_finish(const shared_chart *shared, const fit_input *input, bat_surface_result *result,
                               bat_error *error)
{
    size_t count = 0, received;
    bat_status status = BAT_OK;
    for (size_t row = 0; row < input->count; row++)
        count += is_judged(shared, input, row);
    judged_row *rows = ranks_allocate(count, sizeof *rows);
    for (size_t row = 0, made = 0; row < input->count; row++)
        if (is_judged(shared, input, row))
            rows[made++] = (judged_row){input->numbers[row],
                                        {input->parameters[2 * row], input->parameters[2 * row + 1]},
                                        result->report.distances[row]};
    judged_row *all = collect(rows, sizeof *rows, count, &received);
    free(rows);
    if (ranks_rank() == 0)
        status = judge(shared, all, received, result, error);
    free(all);
    return share_status(status, error);
}

// The report

/// The number by file_part_sort() of point `number` of the fit.
/// @param loop the numbers of the points of the loop, ascending
static uint64_t sorted_number(const loop_place *loop, size_t count, const bat_cloud *cloud, size_t number)
{
    if (number < count)
        return cloud->order[number];
    uint64_t sorted = number - count;
    for (size_t k = 0; k < count && loop[k].number <= sorted; k++)
        sorted++;
    return sorted;
}

void shared_chart_describe(const shared_chart *shared, const file_part *part, bat_surface_result *result, bat_cloud *cloud)
{
    enum
    {
        CORNERS = 4
    };
    size_t loop = shared->cloud.boundary_count, rounds = result->report.count, count = CORNERS + rounds;
    uint64_t asked = count;
    broadcast(&asked, sizeof asked);
    count = (size_t)asked;
    uint64_t *numbers = ranks_allocate(2 * count, sizeof *numbers), *found = numbers + count;
    if (ranks_rank() == 0)
    {
        loop_place *places = ranks_allocate(loop, sizeof *places);
        for (size_t k = 0; k < loop; k++)
            places[k] = (loop_place){shared->cloud.order[k], k};
        qsort(places, loop, sizeof *places, compare_loop);
        for (size_t k = 0; k < CORNERS; k++)
            numbers[k] = sorted_number(places, loop, &shared->cloud, shared->cloud.corners[k]);
        for (size_t k = 0; k < rounds; k++)
            numbers[CORNERS + k] = sorted_number(places, loop, &shared->cloud, result->report.rounds[k].worst);
        free(places);
    }
    broadcast(numbers, count * sizeof *numbers);
    for (size_t k = 0; k < count; k++)
        if (numbers[k] - part->origin_first < part->origin_count)
            numbers[k] = part->origins[numbers[k] - part->origin_first];
        else
            numbers[k] = 0;
    (void)MPI_Reduce(numbers, found, (int)count, MPI_UINT64_T, MPI_MAX, 0, MPI_COMM_WORLD);
    *cloud = (bat_cloud){.boundary_count = loop, .has_corners = shared->cloud.has_corners};
    for (size_t k = 0; k < CORNERS && ranks_rank() == 0; k++)
        cloud->corners[k] = (size_t)found[k];
    for (size_t k = 0; k < rounds && ranks_rank() == 0; k++)
        result->report.rounds[k].worst = (size_t)found[CORNERS + k];
    free(numbers);
}
