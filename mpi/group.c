#include "group.h"

#include "counts.h"
#include "ranks.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum
{
    TAG = 20, ///< of the messages of a group
    /// A wait for a message asks so often without a pause; then it pauses, longer each time, so that other processes and
    /// threads have the processor.
    EAGER_TESTS = 2000,
    MIN_PAUSE = 5000, ///< nanoseconds
    MAX_PAUSE = 200000,
    PART = 1 << 30 ///< bytes of one broadcast
};

static bat_status broken(bat_error *error)
{
    return ranks_fail(error, BAT_FILE_ACCESS, "a message of MPI failed");
}

static bat_status check_size(size_t size, bat_error *error)
{
    return size <= INT_MAX ? BAT_OK : ranks_fail(error, BAT_TOO_LARGE, "a message exceeds 2 GiB; take more ranks");
}

/// Wait for a message under way.
static bat_status finish(MPI_Request *request, bat_error *error)
{
    int done = 0;
    long pause = MIN_PAUSE;
    double begin = MPI_Wtime();
    for (long tests = 0; !done; tests++)
    {
        if (MPI_Test(request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS)
            return broken(error);
        if (done || tests < EAGER_TESTS)
            continue;
        (void)nanosleep(&(struct timespec){.tv_nsec = pause}, NULL);
        pause = 2 * pause < MAX_PAUSE ? 2 * pause : MAX_PAUSE;
    }
    counts_wait(MPI_Wtime() - begin);
    return BAT_OK;
}

static bat_status send_bytes(void *context, size_t to, const void *bytes, size_t size, bat_error *error)
{
    (void)context;
    MPI_Request request;
    if (check_size(size, error) != BAT_OK)
        return BAT_TOO_LARGE;
    if (MPI_Isend(bytes, (int)size, MPI_BYTE, (int)to, TAG, MPI_COMM_WORLD, &request) != MPI_SUCCESS)
        return broken(error);
    return finish(&request, error);
}

static bat_status receive_bytes(void *context, size_t from, void *bytes, size_t size, bat_error *error)
{
    (void)context;
    MPI_Request request;
    if (check_size(size, error) != BAT_OK)
        return BAT_TOO_LARGE;
    if (MPI_Irecv(bytes, (int)size, MPI_BYTE, (int)from, TAG, MPI_COMM_WORLD, &request) != MPI_SUCCESS)
        return broken(error);
    return finish(&request, error);
}

static bat_status gather(void *context, const void *bytes, size_t size, size_t *sizes, void **all, bat_error *error)
{
    size_t count = (size_t)ranks_count(), total = 0;
    bool first = ranks_rank() == 0;
    unsigned long long mine = size, *each = ranks_allocate(count, sizeof *each);
    int *lengths = ranks_allocate(2 * count, sizeof *lengths), *places = lengths + count;
    MPI_Request request;
    (void)context;
    // Others wait already, so that a failure of one ends all.
    bat_error failure;
    ranks_need(NULL, check_size(size, &failure), &failure);
    (void)MPI_Igather(&mine, 1, MPI_UNSIGNED_LONG_LONG, each, 1, MPI_UNSIGNED_LONG_LONG, 0, MPI_COMM_WORLD, &request);
    bat_status status = finish(&request, error);
    for (size_t rank = 0; first && rank < count; rank++)
    {
        sizes[rank] = (size_t)each[rank];
        lengths[rank] = (int)each[rank];
        places[rank] = (int)total;
        total += sizes[rank];
    }
    if (total > INT_MAX)
        ranks_need(NULL, ranks_fail(&failure, BAT_TOO_LARGE, "rank 0 would receive more than 2 GiB at once"), &failure);
    char *received = first ? ranks_allocate(total + 1, 1) : NULL;
    if (status == BAT_OK)
    {
        (void)MPI_Igatherv(bytes, (int)size, MPI_BYTE, received, lengths, places, MPI_BYTE, 0, MPI_COMM_WORLD, &request);
        status = finish(&request, error);
    }
    *all = received;
    free(each);
    free(lengths);
    return status;
}

static bat_status broadcast(void *context, size_t root, void *bytes, size_t size, bat_error *error)
{
    bat_status status = BAT_OK;
    (void)context;
    for (size_t at = 0; at < size && status == BAT_OK; at += PART)
    {
        MPI_Request request;
        int part = (int)(size - at < PART ? size - at : PART);
        (void)MPI_Ibcast((char *)bytes + at, part, MPI_BYTE, (int)root, MPI_COMM_WORLD, &request);
        status = finish(&request, error);
    }
    return status;
}

const bat_group *ranks_group(void)
{
    static bat_group group = {.send = send_bytes, .receive = receive_bytes, .gather = gather, .broadcast = broadcast};
    group.rank = (size_t)ranks_rank();
    group.count = (size_t)ranks_count();
    return &group;
}
