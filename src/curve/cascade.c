#include "curve/plan.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/shared_work.h"
#include "base/threads.h"

#include <string.h>

enum
{
    /// Numbers in a chunk of the last level: with the levels before it, it fits the second-level cache.
    CHUNK_NUMBERS = 32768,
    /// Numbers written past the caches at a time: they stay in the first-level cache until then.
    PIECE_NUMBERS = 2048,
    /// A chunk is at least this many times the support of the mask, so that what chunks compute twice stays small.
    CHUNK_SUPPORTS = 16,
    /// Results larger than this many numbers are written past the caches.
    STREAM_NUMBERS = 1 << 20,
};

/// The smallest range of whole pairs (2 j, 2 j + 1) around a range.
static index_range whole_pairs(index_range range)
{
    return (index_range){range.begin - (range.begin & 1), range.end + (range.end & 1)};
}

/// What the level before must give for whole pairs of a range.
static index_range range_before(const refine_kernel *kernel, index_range range)
{
    index_range pairs = whole_pairs(range);
    return (index_range){floor_half(pairs.begin - kernel->last + 1), floor_half(pairs.end - 1 - kernel->first) + 1};
}

static index_range with_snap(const bat_mask_stencil *snap, index_range range)
{
    if (snap->count == 0)
        return range;
    return (index_range){range.begin + snap->first, range.end + snap->first + (ptrdiff_t)snap->count - 1};
}

index_range cascade_support(const cascade *task)
{
    index_range range = with_snap(&task->snap, task->result);
    for (size_t level = 0; level < task->levels; level++)
        range = range_before(&task->kernel, range);
    return range;
}

/// One thread's two buffers, used in turn.
typedef struct scratch
{
    double *rows[2];
    void *kernel; ///< what the kernel needs
    bool stream;  ///< write results past the caches
    bool ready;   ///< there was memory
} scratch;

static size_t support_of(const cascade *task)
{
    return (size_t)(task->kernel.last - task->kernel.first) + task->snap.count;
}

static scratch scratch_make(const cascade *task, size_t chunk)
{
    size_t rows = chunk + 4 * support_of(task) + 16, total = (size_t)(task->result.end - task->result.begin);
    scratch s = {.stream = total * task->kernel.dim > STREAM_NUMBERS};
    for (int i = 0; i < 2; i++)
        s.rows[i] = memory_array(rows * task->kernel.dim, sizeof(double));
    s.kernel = memory_array(task->kernel.scratch_size, 1);
    s.ready = s.rows[0] != NULL && s.rows[1] != NULL && s.kernel != NULL;
    return s;
}

static void scratch_free(scratch *s)
{
    free(s->rows[0]);
    free(s->rows[1]);
    free(s->kernel);
}

/// The last level of a large result, piece by piece from the first-level cache past all caches.
static bat_status run_streaming(const refine_kernel *kernel, const double *points, size_t pairs, double *piece, double *fine,
                                void *own, size_t *failed)
{
    size_t dim = kernel->dim;
    size_t most = PIECE_NUMBERS / (2 * dim) > 0 ? PIECE_NUMBERS / (2 * dim) : 1;
    for (size_t done = 0; done < pairs; done += most)
    {
        size_t count = pairs - done < most ? pairs - done : most;
        bat_status status = kernel->run(kernel, points + done * dim, count, piece, own, failed);
        if (status != BAT_OK)
        {
            *failed += done;
            return status;
        }
        memory_stream(fine + 2 * done * dim, piece, 2 * count * dim);
    }
    memory_stream_end();
    return BAT_OK;
}

/// One chunk of the result, from level 0 through all levels. On failure *fault is the edge of level 0 at fault.
static bat_status run_chunk(const cascade *task, const double *root, index_range chunk, scratch *s, double *fine,
                            ptrdiff_t *fault)
{
    const refine_kernel *kernel = &task->kernel;
    size_t dim = kernel->dim;
    index_range ranges[CASCADE_MOST_LEVELS + 1];
    ranges[task->levels] = with_snap(&task->snap, chunk);
    for (size_t level = task->levels; level > 0; level--)
        ranges[level - 1] = range_before(kernel, ranges[level]);

    const double *points = root; // row 0 is point `origin` of the level
    ptrdiff_t origin = 0;
    for (size_t level = 1; level <= task->levels; level++)
    {
        index_range pairs = whole_pairs(ranges[level]);
        bool last = level == task->levels && task->snap.count == 0;
        bool in_place = last && pairs.begin == chunk.begin && pairs.end == chunk.end;
        double *rows = in_place ? fine : s->rows[level & 1];
        ptrdiff_t first_pair = floor_half(pairs.begin);
        size_t count = (size_t)(pairs.end - pairs.begin) / 2, failed = 0;
        const double *from = points + (first_pair - origin) * (ptrdiff_t)dim;
        bat_status status = in_place && s->stream
                                ? run_streaming(kernel, from, count, s->rows[level & 1], rows, s->kernel, &failed)
                                : kernel->run(kernel, from, count, rows, s->kernel, &failed);
        if (status != BAT_OK)
        {
            *fault = (first_pair + (ptrdiff_t)failed) >> (level - 1);
            return status;
        }
        if (in_place)
            return BAT_OK;
        points = rows;
        origin = pairs.begin;
    }

    size_t count = (size_t)(chunk.end - chunk.begin);
    if (task->snap.count > 0)
    {
        const double *from = points + (chunk.begin + task->snap.first - origin) * (ptrdiff_t)dim;
        double *rows = s->rows[(task->levels + 1) & 1];
        memset(rows, 0, count * dim * sizeof *rows);
        for (size_t k = 0; k < task->snap.count; k++)
            for (size_t i = 0; i < count * dim; i++)
                rows[i] += task->snap.weights[k] * from[i + k * dim];
        points = rows;
        origin = chunk.begin;
    }
    memcpy(fine, points + (chunk.begin - origin) * (ptrdiff_t)dim, count * dim * sizeof *fine);
    return BAT_OK;
}

/// The point of level 0 that begins an edge, also where the edge lies beyond an end.
static size_t point_at_fault(const cascade *task, ptrdiff_t edge)
{
    ptrdiff_t count = (ptrdiff_t)task->count;
    if (task->closed)
        return (size_t)((edge % count + count) % count);
    return edge < 0 ? 0 : edge >= count ? task->count - 1 : (size_t)edge;
}

/// Chunk i of the result, unless there was no memory for the scratch.
static void run_numbered(const cascade *task, const double *root, double *fine, ptrdiff_t chunk, size_t i, scratch *s,
                         shared_work *work)
{
    if (!shared_work_wants(work, i))
        return;
    bat_error error;
    size_t dim = task->kernel.dim;
    bat_status status = s->ready ? BAT_OK : error_memory(&error, (size_t)chunk * dim * sizeof(double));
    index_range range = {task->result.begin + (ptrdiff_t)i * chunk, task->result.begin + (ptrdiff_t)(i + 1) * chunk};
    range.end = range.end > task->result.end ? task->result.end : range.end;
    ptrdiff_t fault = 0;
    if (s->ready)
        status = run_chunk(task, root, range, s, fine + i * (size_t)chunk * dim, &fault);
    if (s->ready && status != BAT_OK)
    {
        size_t point = point_at_fault(task, fault) >> task->base;
        (void)error_point(&error, status, point, "there is no new point after point", " (%s)", bat_status_name(status));
    }
    shared_work_finish(work, i, status, &error);
}

bat_status cascade_run(const cascade *task, const double *root, double *fine, bat_error *error)
{
    ptrdiff_t total = task->result.end - task->result.begin;
    size_t rows = task->kernel.chunk > 0 ? task->kernel.chunk : CHUNK_NUMBERS / task->kernel.dim;
    size_t least = CHUNK_SUPPORTS * support_of(task);
    rows = rows < least ? least : rows;
    ptrdiff_t chunk = (ptrdiff_t)(rows + (rows & 1));
    chunk = chunk > total ? total + (total & 1) : chunk;
    shared_work work = shared_work_make(total == 0 ? 0 : (size_t)((total + chunk - 1) / chunk), task->progress);
    int threads = threads_for(task->threads, work.total);
    if (threads == 1)
    {
        scratch s = scratch_make(task, (size_t)chunk);
        for (size_t i = 0; i < work.total; i++)
            run_numbered(task, root, fine, chunk, i, &s, &work);
        scratch_free(&s);
    }
    else
    {
#pragma omp parallel num_threads(threads)
        {
            scratch s = scratch_make(task, (size_t)chunk);
#pragma omp for schedule(dynamic)
            for (size_t i = 0; i < work.total; i++)
                run_numbered(task, root, fine, chunk, i, &s, &work);
            scratch_free(&s);
        }
    }
    return shared_work_end(&work, error);
}
