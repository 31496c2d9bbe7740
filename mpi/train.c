#include "train.h"

#include "counts.h"
#include "interrupt.h"
#include "ranks.h"
#include "verbs.h"

#include <stdio.h>
#include <time.h>
#include <unistd.h>

enum
{
    TAG = 20,
    /// A wait for a message asks so often without a pause; then it pauses, longer each time, so that other processes and
    /// threads have the processor.
    EAGER_TESTS = 2000,
    MIN_PAUSE = 5000, ///< nanoseconds
    MAX_PAUSE = 200000
};

static bat_status broken(bat_error *error)
{
    if (error != NULL)
        *error = (bat_error){.status = BAT_FILE_ACCESS, .index = BAT_NO_INDEX, .text = "a message of MPI failed"};
    return BAT_FILE_ACCESS;
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
    if (MPI_Isend(bytes, (int)size, MPI_BYTE, (int)to, TAG, MPI_COMM_WORLD, &request) != MPI_SUCCESS)
        return broken(error);
    return finish(&request, error);
}

static bat_status receive_bytes(void *context, size_t from, void *bytes, size_t size, bat_error *error)
{
    (void)context;
    MPI_Request request;
    if (MPI_Irecv(bytes, (int)size, MPI_BYTE, (int)from, TAG, MPI_COMM_WORLD, &request) != MPI_SUCCESS)
        return broken(error);
    return finish(&request, error);
}

/// An equal share of this machine's processors.
static int own_processors(void)
{
    MPI_Comm machine;
    int ranks = 1;
    if (MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine) == MPI_SUCCESS)
    {
        (void)MPI_Comm_size(machine, &ranks);
        (void)MPI_Comm_free(&machine);
    }
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    return processors > ranks ? (int)(processors / ranks) : 1;
}

int verb_train_together(int argc, char **argv)
{
    bat_group group = {
        .rank = (size_t)ranks_rank(), .count = (size_t)ranks_count(), .send = send_bytes, .receive = receive_bytes};
    interrupt_catch();
    int silence = ranks_silence();
    int code = train_in_group(argc, argv, &group, own_processors());
    ranks_speak(silence);
    if (code != EXIT_DONE)
        return code;
    counts_summary summary = counts_collect();
    if (group.rank == 0)
        counts_print(&summary, stderr);
    return EXIT_DONE;
}
