#include "train.h"

#include "counts.h"
#include "interrupt.h"
#include "ranks.h"
#include "verbs.h"

#include <stdio.h>
#include <unistd.h>

enum
{
    TAG = 20
};

static bat_status broken(bat_error *error)
{
    if (error != NULL)
        *error = (bat_error){.status = BAT_FILE_ACCESS, .index = BAT_NO_INDEX, .text = "a message of MPI failed"};
    return BAT_FILE_ACCESS;
}

static bat_status send_bytes(void *context, size_t to, const void *bytes, size_t size, bat_error *error)
{
    (void)context;
    return MPI_Send(bytes, (int)size, MPI_BYTE, (int)to, TAG, MPI_COMM_WORLD) == MPI_SUCCESS ? BAT_OK : broken(error);
}

static bat_status receive_bytes(void *context, size_t from, void *bytes, size_t size, bat_error *error)
{
    (void)context;
    return MPI_Recv(bytes, (int)size, MPI_BYTE, (int)from, TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE) == MPI_SUCCESS
               ? BAT_OK
               : broken(error);
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
