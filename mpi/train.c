#include "verb.h"

#include "counts.h"
#include "group.h"
#include "ranks.h"
#include "verbs.h"

#include <stdio.h>
#include <unistd.h>

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
    interrupt_catch();
    int silence = ranks_silence();
    int code = train_in_group(argc, argv, ranks_group(), own_processors());
    ranks_speak(silence);
    if (code != EXIT_DONE)
        return code;
    counts_summary summary = counts_collect();
    if (ranks_rank() == 0)
        counts_print(&summary, stderr);
    return EXIT_DONE;
}
