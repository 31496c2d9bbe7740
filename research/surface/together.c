/// @file
/// Fits that several processes make together: what they exchange beside messages, the sums and the scores of cells, and the
/// states between rounds. Each process completes the cells of which it has all points. It sends the sums of blocks for the
/// others, which the first process adds up.

#include "batten/research/distributed.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "base/progress.h"
#include "base/threads.h"
#include "research/surface/group.h"
#include "research/surface/regions.h"
#include "surface/fit/loop.h"
#include "surface/spline/hierarchical_space.h"

#include <stdlib.h>
#include <string.h>

_Static_assert(BAT_SURFACE_FIT_BLOCK == FIT_BLOCK, "the sums have the same blocks");

// Sums over the points of cells.

/// The same with the lower triangle alone.
static size_t packed_of(const gather_context *gather, size_t side)
{
    return side * (side + 1) / 2 + side * gather->columns;
}

/// What goes before the numbers of a cell.
typedef struct sent_head
{
    uint32_t cell;
    uint32_t blocks; ///< sums of so many blocks; 0: the complete contribution
} sent_head;

_Static_assert(sizeof(sent_head) == sizeof(double), "a head takes the place of a number");

static bool is_complete(const fit_points *points, size_t cell)
{
    return points->first[cell + 1] - points->first[cell] == fit_points_of_cell(points, cell);
}

static uint32_t blocks_of(const fit_points *points, size_t cell)
{
    uint32_t blocks = 0;
    for (size_t begin = points->first[cell], end = points->first[cell + 1]; begin < end; blocks++)
        begin = fit_points_block_end(points, begin, end);
    return blocks;
}

/// Append the lower triangle of the matrix and the right-hand sides.
static double *pack(const gather_context *gather, size_t side, double *numbers, double *to)
{
    for (size_t i = 0; i < side; i++, to += i)
        memcpy(to, numbers + i * side, (i + 1) * sizeof *to);
    memcpy(to, numbers + side * side, side * gather->columns * sizeof *to);
    return to + side * gather->columns;
}

static const double *add_packed(const gather_context *gather, size_t side, const double *from, double *numbers)
{
    for (size_t i = 0; i < side; i++, from += i)
        for (size_t j = 0; j <= i; j++)
            numbers[i * side + j] += from[j];
    double *right = numbers + side * side;
    for (size_t k = 0; k < side * gather->columns; k++)
        right[k] += from[k];
    return from + side * gather->columns;
}

static void send_cell(const gather_context *gather, size_t cell, double *scratch)
{
    const fit_points *points = gather->points;
    cell_sums sums = gather_sums_of(gather, cell);
    size_t begin = points->first[cell], end = points->first[cell + 1], active = sums.cell->active;
    bool complete = is_complete(points, cell);
    sent_head head = {(uint32_t)cell, complete ? 0 : blocks_of(points, cell)};
    double *to = gather->sent + gather->first[cell];
    if (begin == end)
        return;
    memcpy(to++, &head, sizeof head);
    if (complete)
    {
        double *contribution = scratch, *rest = contribution + gather_numbers_of(gather, active);
        gather_fill_cell(gather, cell, rest, contribution, contribution + active * active);
        (void)pack(gather, active, contribution, to);
        return;
    }
    while (begin < end)
    {
        size_t next = fit_points_block_end(points, begin, end);
        gather_fill_block(gather, &sums, begin, next, scratch + gather_numbers_of(gather, sums.side), scratch);
        to = pack(gather, sums.side, scratch, to);
        begin = next;
    }
}

static bat_status fill_sent(gather_context *gather, size_t scratch_size, int threads, bat_error *error)
{
    const fit_points *points = gather->points;
    size_t cells = points->cells;
    gather->first = memory_array(cells + 1, sizeof *gather->first);
    if (gather->first == NULL)
        return error_memory(error, (cells + 1) * sizeof *gather->first);
    gather->first[0] = 0;
    for (size_t c = 0; c < cells; c++)
    {
        size_t size = 0;
        cell_sums sums = gather_sums_of(gather, c);
        if (points->first[c] < points->first[c + 1])
            size = 1 + (is_complete(points, c) ? packed_of(gather, sums.cell->active)
                                               : blocks_of(points, c) * packed_of(gather, sums.side));
        gather->first[c + 1] = gather->first[c] + size;
    }
    gather->sent = memory_array(gather->first[cells] + 1, sizeof *gather->sent);
    if (gather->sent == NULL)
        return error_memory(error, gather->first[cells] * sizeof *gather->sent);
    double operations = (double)points->count * 300;
    bool allocated = true;
#pragma omp parallel num_threads(threads_worth(threads, (cells + 15) / 16, operations)) reduction(&& : allocated)
    {
        double *scratch = memory_array(scratch_size, sizeof *scratch);
        allocated = scratch != NULL;
#pragma omp for schedule(dynamic, 16)
        for (size_t c = 0; c < cells; c++)
            if (scratch != NULL)
                send_cell(gather, c, scratch);
        free(scratch);
    }
    return allocated ? BAT_OK : error_memory(error, scratch_size * sizeof(double));
}

/// What the first process has received of one rank and not yet read.
typedef struct received_part
{
    const double *at, *end;
} received_part;

/// The contribution of a cell from what all ranks have sent.
static void receive_cell(const gather_context *gather, size_t cell, received_part *parts, double *scratch, double *numbers)
{
    cell_sums sums = gather_sums_of(gather, cell);
    size_t active = sums.cell->active, size = gather_numbers_of(gather, sums.side);
    memset(scratch, 0, size * sizeof *scratch);
    memset(numbers, 0, gather_numbers_of(gather, active) * sizeof *numbers);
    bool summed = false;
    for (size_t rank = 0; rank < team_count(gather->points->team); rank++)
    {
        received_part *part = &parts[rank];
        sent_head head;
        if (part->at == part->end)
            continue;
        memcpy(&head, part->at, sizeof head);
        if (head.cell != cell)
            continue;
        part->at++;
        if (head.blocks == 0)
            part->at = add_packed(gather, active, part->at, numbers);
        for (uint32_t k = 0; k < head.blocks; k++)
            part->at = add_packed(gather, sums.side, part->at, scratch);
        summed = summed || head.blocks > 0;
    }
    if (summed)
        gather_finish_cell(gather, &sums, scratch, scratch + size, numbers, numbers + active * active);
}

static bat_status collect_cells(const void *context, size_t begin, size_t end, const size_t *place, double *numbers,
                                bat_error *error)
{
    const gather_context *gather = context;
    const fit_team *team = gather->points->team;
    size_t *sizes = NULL, side = gather_max_side(gather), offset = 0;
    char *all = NULL;
    bat_status status = team_gather(team, gather->sent + gather->first[begin],
                                    (gather->first[end] - gather->first[begin]) * sizeof(double), &sizes, &all, error);
    if (status == BAT_OK && team_is_first(team))
    {
        received_part *parts = memory_array(team_count(team), sizeof *parts);
        double *scratch = memory_array(gather_numbers_of(gather, side) + gather_scratch_of(gather), sizeof *scratch);
        if (parts == NULL || scratch == NULL)
            status = error_memory(error, gather_numbers_of(gather, side) * sizeof *scratch);
        for (size_t rank = 0; status == BAT_OK && rank < team_count(team); offset += sizes[rank++])
            parts[rank] = (received_part){(const double *)(const void *)(all + offset),
                                          (const double *)(const void *)(all + offset + sizes[rank])};
        for (size_t c = begin; status == BAT_OK && c < end; c++)
            receive_cell(gather, c, parts, scratch, numbers + place[c - begin]);
        free(parts);
        free(scratch);
    }
    free(sizes);
    free(all);
    return status;
}

// Scores of cells.

/// Statistics of a cell that a process sends: of all its points, or of one block.
typedef struct sent_points
{
    cell_points points;
    size_t cell;
} sent_points;

/// Scores of all cells on the first process, from the statistics of all.
static bat_status receive_scores(const bat_hierarchical_space *space, const fit_team *team, const size_t *sizes,
                                 const char *all, const fit_marking *marking, double *scores, size_t cells, bat_error *error)
{
    cell_points *sums = memory_array(cells, sizeof *sums);
    size_t bytes = 0;
    if (sums == NULL)
        return error_memory(error, cells * sizeof *sums);
    for (size_t c = 0; c < cells; c++)
        sums[c] = CELL_NO_POINTS;
    for (size_t rank = 0; rank < team_count(team); rank++)
        bytes += sizes[rank];
    for (size_t at = 0; at < bytes; at += sizeof(sent_points))
    {
        sent_points sent;
        memcpy(&sent, all + at, sizeof sent);
        cell_points_add(&sums[sent.cell], &sent.points);
    }
    for (size_t c = 0; c < cells; c++)
        scores[c] = cell_score(space, &sums[c], c, marking);
    free(sums);
    return BAT_OK;
}

static bat_status score_together(const bat_hierarchical_space *space, const fit_points *points, const fit_marking *marking,
                                 double *scores, bat_error *error)
{
    const fit_team *team = points->team;
    size_t count = 0, *sizes = NULL, room = 1;
    for (size_t c = 0; c < points->cells; c++)
        for (size_t begin = points->first[c], end = points->first[c + 1]; begin < end; room++)
            begin = fit_points_block_end(points, begin, end);
    sent_points *sent = memory_array(room, sizeof *sent);
    if (sent == NULL)
        return error_memory(error, room * sizeof *sent);
    for (size_t c = 0; c < points->cells; c++)
    {
        size_t begin = points->first[c], end = points->first[c + 1];
        if (begin < end && end - begin == fit_points_of_cell(points, c))
        {
            sent[count++] = (sent_points){cell_points_of(points, c), c};
            begin = end;
        }
        while (begin < end)
        {
            size_t next = fit_points_block_end(points, begin, end);
            sent[count++] = (sent_points){cell_points_of_places(points, begin, next), c};
            begin = next;
        }
    }
    char *all;
    bat_status status = team_gather(team, sent, count * sizeof *sent, &sizes, &all, error);
    free(sent);
    if (status == BAT_OK && team_is_first(team))
        status = receive_scores(space, team, sizes, all, marking, scores, points->cells, error);
    free(sizes);
    free(all);
    return status == BAT_OK ? team_broadcast(team, scores, points->cells * sizeof *scores, error) : status;
}

// Border curves.

bat_status bat_surface_border_make(const bat_surface_fit_data *data, const bat_surface_fit_options *options,
                                   bat_surface_border **border, bat_error *error)
{
    const bat_surface_fit_options defaults = bat_surface_fit_defaults();
    bat_status status = bat_options_check(&bat_surface_fit_fields, options, error);
    bat_surface_fit_data loop = *data;
    loop.count = data->boundary_count;
    if (status == BAT_OK)
        status = fit_points_check(NULL, &loop, NULL, error);
    if (status != BAT_OK)
        return status;
    fit_border *made = calloc(1, sizeof *made);
    if (made == NULL)
        return error_memory(error, sizeof *made);
    status = fit_border_make(data, options != NULL ? options : &defaults, made, error);
    if (status == BAT_OK)
        *border = made;
    else
        free(made);
    return status;
}

void bat_surface_border_free(bat_surface_border *border)
{
    if (border != NULL)
        fit_border_free(border);
    free(border);
}

size_t bat_surface_border_samples(const bat_surface_border *border, const double **points, const double **parameters)
{
    *points = border->points;
    *parameters = border->at;
    return border->samples;
}

// The state of an adaptive fit between two rounds, which the caller keeps.

/// The feet, the targets, the offsets of the sides, and whether there was an update.
static size_t state_numbers(const fit_border *border)
{
    return border->samples > 0 ? border->samples * (2 + border->dimension) + FIT_BORDER_SIDES + 1 : 0;
}

static size_t border_state_size(const fit_border *border)
{
    return state_numbers(border) * sizeof(double);
}

static void save_border(const fit_border *border, char *bytes)
{
    double moved = border->moved ? 1 : 0;
    size_t feet = 2 * border->samples * sizeof moved, targets = border->samples * border->dimension * sizeof moved;
    if (border->samples == 0)
        return;
    memcpy(bytes, &moved, sizeof moved);
    bytes += sizeof moved;
    for (int s = 0; s < FIT_BORDER_SIDES; s++, bytes += sizeof moved)
        memcpy(bytes, &border->sides[s].offset, sizeof moved);
    memcpy(bytes, border->foot, feet);
    memcpy(bytes + feet, border->target, targets);
}

static void load_border(fit_border *border, const char *bytes, fit_points *points)
{
    double moved;
    size_t feet = 2 * border->samples * sizeof moved, targets = border->samples * border->dimension * sizeof moved;
    if (border->samples == 0)
        return;
    memcpy(&moved, bytes, sizeof moved);
    bytes += sizeof moved;
    for (int s = 0; s < FIT_BORDER_SIDES; s++, bytes += sizeof moved)
        memcpy(&border->sides[s].offset, bytes, sizeof moved);
    memcpy(border->foot, bytes, feet);
    memcpy(border->target, bytes + feet, targets);
    border->moved = moved > 0;
    if (border->moved)
        fit_border_move(border, points);
}

/// What begins the bytes of a state; rounds and boxes follow.
typedef struct state_head
{
    uint64_t rounds, boxes, best_boxes, best_round, outliers;
    double lambda, best_expected, best_left, best_held_rms, best_held_largest, best_lambda, seconds;
    uint64_t full, corrects, has_best;
} state_head;

static size_t state_columns(const fit_loop *loop, bat_surface_fit_column columns[4])
{
    columns[0] = (bat_surface_fit_column){loop->points.parameter, 2};
    columns[1] = (bat_surface_fit_column){loop->points.weight, 1};
    columns[2] = (bat_surface_fit_column){loop->best.parameter, 2};
    columns[3] = (bat_surface_fit_column){loop->best.distance, 1};
    return loop->held != NULL ? 4 : 2;
}

static bat_status save_state(const fit_team *team, const fit_loop *loop, bat_error *error)
{
    const bat_surface_fit_backend *backend = team->backend;
    bat_surface_fit_column columns[4];
    bat_spline_box *boxes = NULL, *best_boxes = NULL;
    size_t count = 0, best_count = 0;
    bat_status status = hierarchical_space_regions(loop->space, &boxes, &count, error);
    if (status == BAT_OK && loop->best.space != NULL)
        status = hierarchical_space_regions(loop->best.space, &best_boxes, &best_count, error);
    size_t rounds = loop->count * sizeof *loop->rounds, size = sizeof(state_head) + rounds;
    size += (count + best_count) * sizeof *boxes + border_state_size(&loop->border);
    char *bytes = status == BAT_OK ? memory_array(size, 1) : NULL;
    if (status == BAT_OK && bytes == NULL)
        status = error_memory(error, size);
    if (status == BAT_OK)
    {
        state_head head = {.rounds = loop->count,
                           .boxes = count,
                           .best_boxes = best_count,
                           .best_round = loop->best.round,
                           .outliers = loop->outliers,
                           .lambda = loop->lambda,
                           .best_expected = loop->best.expected,
                           .best_left = loop->best.left,
                           .best_held_rms = loop->best.held_rms,
                           .best_held_largest = loop->best.held_largest,
                           .best_lambda = loop->best.lambda,
                           .seconds = clock_seconds() - loop->begin,
                           .full = loop->full,
                           .corrects = loop->corrects,
                           .has_best = loop->best.space != NULL};
        memcpy(bytes, &head, sizeof head);
        memcpy(bytes + sizeof head, loop->rounds, rounds);
        if (count > 0)
            memcpy(bytes + sizeof head + rounds, boxes, count * sizeof *boxes);
        if (best_count > 0)
            memcpy(bytes + sizeof head + rounds + count * sizeof *boxes, best_boxes, best_count * sizeof *boxes);
        save_border(&loop->border, bytes + size - border_state_size(&loop->border));
        status = backend->save(backend->context, bytes, size, columns, state_columns(loop, columns), error);
    }
    free(bytes);
    free(boxes);
    free(best_boxes);
    return status;
}

static bat_status read_state(fit_loop *loop, const char *bytes, size_t size, bat_error *error)
{
    state_head head = {0};
    if (size >= sizeof head)
        memcpy(&head, bytes, sizeof head);
    size_t rounds = head.rounds * sizeof *loop->rounds, boxes = (head.boxes + head.best_boxes) * sizeof(bat_spline_box);
    if (head.rounds > (size_t)loop->options->iterations || (head.has_best != 0 && loop->held == NULL) ||
        size != sizeof head + rounds + boxes + border_state_size(&loop->border))
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "the state is not one of this fit");
    bat_spline_box *copy = memory_array(boxes, 1);
    if (copy == NULL)
        return error_memory(error, boxes);
    memcpy(loop->rounds, bytes + sizeof head, rounds);
    memcpy(copy, bytes + sizeof head + rounds, boxes);
    bat_hierarchical_space *space = NULL;
    bat_status status = hierarchical_space_of_regions(&loop->options->space, copy, head.boxes, &space, error);
    if (status == BAT_OK && head.has_best != 0)
        status = hierarchical_space_of_regions(&loop->options->space, copy + head.boxes, head.best_boxes, &loop->best.space,
                                               error);
    free(copy);
    if (status != BAT_OK)
    {
        bat_hierarchical_space_free(space);
        return status;
    }
    bat_hierarchical_space_free(loop->space);
    loop->space = space;
    loop->count = head.rounds;
    loop->outliers = head.outliers;
    loop->lambda = head.lambda;
    loop->full = head.full != 0;
    loop->corrects = head.corrects != 0;
    loop->best.round = head.best_round;
    loop->best.expected = head.best_expected;
    loop->best.left = head.best_left;
    loop->best.held_rms = head.best_held_rms;
    loop->best.held_largest = head.best_held_largest;
    loop->best.lambda = head.best_lambda;
    loop->begin = clock_seconds() - head.seconds;
    load_border(&loop->border, bytes + sizeof head + rounds + boxes, &loop->points);
    return BAT_OK;
}

static bat_status load_state(const fit_team *team, fit_loop *loop, bat_error *error)
{
    const bat_surface_fit_backend *backend = team->backend;
    bat_surface_fit_column columns[4];
    void *bytes = NULL;
    size_t size = 0;
    bat_status status = backend->load(backend->context, &bytes, &size, columns, state_columns(loop, columns), error);
    if (status == BAT_OK && bytes != NULL)
        status = read_state(loop, bytes, size, error);
    free(bytes);
    return status;
}

uint32_t bat_surface_fit_order(const double parameter[2])
{
    return fit_points_place(parameter);
}

bat_status bat_surface_fit_together(const bat_group *group, const bat_surface_fit_backend *backend,
                                    bat_surface_fit_data *data, const uint32_t *numbers,
                                    const bat_surface_fit_options *options, bat_spline_surface *surface,
                                    bat_surface_fit_report *report, bat_error *error)
{
    const bat_surface_fit_backend none = {0};
    backend = backend != NULL ? backend : &none;
    const fit_team team = {.group = group,
                           .rank = group_rank(group),
                           .count = group_count(group),
                           .broadcast = group_broadcast,
                           .agree = bat_group_agree,
                           .agree_with_first = group_agree_with_first,
                           .gather = group_gather,
                           .sum_counts = group_sum_counts,
                           .sum_before = group_sum_before,
                           .largest = group_largest,
                           .solver = {backend->context, backend->factor, backend->solve, backend->attend, backend->release},
                           .begin_cells = fill_sent,
                           .collect_cells = collect_cells,
                           .score_cells = score_together,
                           .save = backend->save != NULL ? save_state : NULL,
                           .load = backend->load != NULL ? load_state : NULL,
                           .backend = backend};
    return fit_all(&team, data, numbers, options, surface, report, error);
}
