#include "team.h"

#include "ranks.h"
#include "solver.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct fit_team
{
    bat_surface_team interface;
    petsc_solver *solver;
    char *path, *temporary; ///< of the state; null for none
    uint64_t label;
    size_t first, count, total; ///< rows
    size_t resumed;
};

static bat_status fail(bat_error *error, bat_status status, const char *text)
{
    if (error != NULL)
    {
        *error = (bat_error){.status = status, .index = BAT_NO_INDEX};
        (void)snprintf(error->text, sizeof error->text, "%s", text);
    }
    return status;
}

static bat_status gather(void *context, const void *bytes, size_t size, size_t *sizes, void **all, bat_error *error)
{
    const fit_team *team = context;
    size_t count = team->interface.count, total = 0;
    bool first = team->interface.rank == 0;
    unsigned long long mine = size;
    if (size > INT_MAX)
        return fail(error, BAT_TOO_LARGE, "a message exceeds 2 GiB; take more ranks");
    unsigned long long *each = ranks_allocate(count, sizeof *each);
    int *counts = ranks_allocate(2 * count, sizeof *counts), *places = counts + count;
    (void)MPI_Gather(&mine, 1, MPI_UNSIGNED_LONG_LONG, each, 1, MPI_UNSIGNED_LONG_LONG, 0, MPI_COMM_WORLD);
    for (size_t rank = 0; first && rank < count; rank++)
    {
        sizes[rank] = (size_t)each[rank];
        counts[rank] = (int)each[rank];
        places[rank] = (int)total;
        total += sizes[rank];
    }
    if (total > INT_MAX)
        ranks_need(NULL, fail(error, BAT_TOO_LARGE, "rank 0 would receive more than 2 GiB at once"), error);
    char *received = first ? ranks_allocate(total + 1, 1) : NULL;
    (void)MPI_Gatherv(bytes, (int)size, MPI_BYTE, received, counts, places, MPI_BYTE, 0, MPI_COMM_WORLD);
    *all = received;
    free(each);
    free(counts);
    return BAT_OK;
}

static bat_status broadcast(void *context, void *bytes, size_t size, bat_error *error)
{
    (void)context;
    (void)error;
    enum
    {
        PART = 1 << 30
    };
    for (size_t at = 0; at < size; at += PART)
        (void)MPI_Bcast((char *)bytes + at, (int)(size - at < PART ? size - at : PART), MPI_BYTE, 0, MPI_COMM_WORLD);
    return BAT_OK;
}

// The solver

static bat_status factor(void *context, size_t size, const int *first, const int *row, const double *values, bool *regular,
                         bat_error *error)
{
    return petsc_load()->factor(((const fit_team *)context)->solver, size, first, row, values, regular, error);
}

static bat_status solve(void *context, size_t columns, const double *right, double *solution, bat_error *error)
{
    return petsc_load()->solve(((const fit_team *)context)->solver, columns, right, solution, error);
}

static bat_status attend(void *context, bat_error *error)
{
    return petsc_load()->attend(((const fit_team *)context)->solver, error);
}

static bat_status release(void *context, bat_error *error)
{
    return petsc_load()->release(((const fit_team *)context)->solver, error);
}

// The state: a head, the library's bytes, then the columns of all points in their order.

static const char MAGIC[8] = "batfit1";

typedef struct state_file_head
{
    char magic[8];
    uint64_t label, total, size, columns;
} state_file_head;

/// Write or read the columns of this rank. All ranks take part.
/// @return whether it went well on all ranks
static bool move_columns(const fit_team *team, MPI_File file, MPI_Offset at, const bat_surface_fit_column *columns,
                         size_t column_count, bool writes)
{
    enum
    {
        ROWS = 1 << 24 ///< at once
    };
    int good = 1, all = 0;
    for (size_t k = 0; k < column_count; k++)
    {
        size_t width = columns[k].width;
        // A rank has one part of a column, so that collective calls, which take 32 MiB of each rank, would gain nothing.
        for (size_t from = 0; from < team->count; from += ROWS)
        {
            size_t left = team->count - from, rows = left < ROWS ? left : ROWS;
            MPI_Offset place = at + (MPI_Offset)((team->first + from) * width * sizeof(double));
            double *values = columns[k].values + from * width;
            MPI_Status status;
            int moved = 0;
            int result = writes ? MPI_File_write_at(file, place, values, (int)(rows * width), MPI_DOUBLE, &status)
                                : MPI_File_read_at(file, place, values, (int)(rows * width), MPI_DOUBLE, &status);
            if (result == MPI_SUCCESS)
                (void)MPI_Get_count(&status, MPI_DOUBLE, &moved);
            good = good && result == MPI_SUCCESS && moved == (int)(rows * width);
        }
        at += (MPI_Offset)(team->total * width * sizeof(double));
    }
    (void)MPI_Allreduce(&good, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    return all != 0;
}

static bat_status save(void *context, const void *head, size_t size, const bat_surface_fit_column *columns,
                       size_t column_count, bat_error *error)
{
    const fit_team *team = context;
    MPI_File file;
    state_file_head own = {.label = team->label, .total = team->total, .size = size, .columns = column_count};
    memcpy(own.magic, MAGIC, sizeof own.magic);
    if (MPI_File_open(MPI_COMM_WORLD, team->temporary, MPI_MODE_CREATE | MPI_MODE_WRONLY, MPI_INFO_NULL, &file) !=
        MPI_SUCCESS)
        return fail(error, BAT_FILE_ACCESS, "cannot write the checkpoint");
    size_t values = 0;
    for (size_t k = 0; k < column_count; k++)
        values += team->total * columns[k].width;
    int good = MPI_File_set_size(file, (MPI_Offset)(sizeof own + size + values * sizeof(double))) == MPI_SUCCESS, all = 0;
    if (team->interface.rank == 0)
        good = good && MPI_File_write_at(file, 0, &own, (int)sizeof own, MPI_BYTE, MPI_STATUS_IGNORE) == MPI_SUCCESS &&
               MPI_File_write_at(file, (MPI_Offset)sizeof own, head, (int)size, MPI_BYTE, MPI_STATUS_IGNORE) == MPI_SUCCESS;
    good = move_columns(team, file, (MPI_Offset)(sizeof own + size), columns, column_count, true) && good;
    good = MPI_File_sync(file) == MPI_SUCCESS && good;
    good = MPI_File_close(&file) == MPI_SUCCESS && good;
    (void)MPI_Allreduce(&good, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    // The old state stays until the new one is complete.
    if (all != 0 && team->interface.rank == 0)
        all = rename(team->temporary, team->path) == 0;
    (void)MPI_Bcast(&all, 1, MPI_INT, 0, MPI_COMM_WORLD);
    return all != 0 ? BAT_OK : fail(error, BAT_FILE_ACCESS, "cannot write the checkpoint");
}

static bat_status load(void *context, void **head, size_t *size, const bat_surface_fit_column *columns, size_t column_count,
                       bat_error *error)
{
    fit_team *team = context;
    MPI_File file;
    state_file_head own = {0};
    int exists = 0;
    *head = NULL;
    if (team->interface.rank == 0)
        exists = access(team->path, F_OK) == 0;
    (void)MPI_Bcast(&exists, 1, MPI_INT, 0, MPI_COMM_WORLD);
    if (exists == 0)
        return BAT_OK;
    if (MPI_File_open(MPI_COMM_WORLD, team->path, MPI_MODE_RDONLY, MPI_INFO_NULL, &file) != MPI_SUCCESS)
        return fail(error, BAT_FILE_ACCESS, "cannot read the checkpoint");
    (void)MPI_File_read_at_all(file, 0, &own, (int)sizeof own, MPI_BYTE, MPI_STATUS_IGNORE);
    size_t values = 0;
    for (size_t k = 0; k < column_count; k++)
        values += team->total * columns[k].width;
    MPI_Offset bytes = 0;
    (void)MPI_File_get_size(file, &bytes);
    bool fits = memcmp(own.magic, MAGIC, sizeof own.magic) == 0 && own.label == team->label && own.total == team->total &&
                own.columns == column_count && own.size < INT_MAX &&
                (uint64_t)bytes == sizeof own + own.size + values * sizeof(double);
    bool good = fits;
    if (fits)
    {
        *head = ranks_allocate(own.size + 1, 1);
        good = MPI_File_read_at_all(file, (MPI_Offset)sizeof own, *head, (int)own.size, MPI_BYTE, MPI_STATUS_IGNORE) ==
               MPI_SUCCESS;
        good = move_columns(team, file, (MPI_Offset)(sizeof own + own.size), columns, column_count, false) && good;
        uint64_t rounds = 0;
        if (own.size >= sizeof rounds)
            memcpy(&rounds, *head, sizeof rounds);
        team->resumed = (size_t)rounds;
        *size = own.size;
    }
    (void)MPI_File_close(&file);
    if (good)
        return BAT_OK;
    free(*head);
    *head = NULL;
    return fail(error, BAT_BAD_FILE,
                fits ? "cannot read the checkpoint"
                     : "the checkpoint is that of another input or of other options; remove it, or name another");
}

static char *join(const char *path, const char *ending)
{
    size_t size = strlen(path) + strlen(ending) + 1;
    char *joined = ranks_allocate(size, 1);
    (void)snprintf(joined, size, "%s%s", path, ending);
    return joined;
}

fit_team *fit_team_make(team_solver solver, const char *state, uint64_t label)
{
    fit_team *team = ranks_allocate(1, sizeof *team);
    team->label = label;
    team->interface = (bat_surface_team){.context = team,
                                         .rank = (size_t)ranks_rank(),
                                         .count = (size_t)ranks_count(),
                                         .gather = gather,
                                         .broadcast = broadcast};
    if (solver != TEAM_SOLVER_CHOLESKY)
    {
        team->solver = petsc_load()->make(solver == TEAM_SOLVER_ITERATIVE);
        team->interface.factor = factor;
        team->interface.solve = solve;
        team->interface.attend = attend;
        team->interface.release = release;
    }
    if (state != NULL)
    {
        team->path = join(state, "");
        team->temporary = join(state, ".new");
        team->interface.save = save;
        team->interface.load = load;
    }
    return team;
}

void fit_team_free(fit_team *team)
{
    if (team == NULL)
        return;
    if (team->solver != NULL)
        petsc_load()->free(team->solver);
    free(team->path);
    free(team->temporary);
    free(team);
}

const bat_surface_team *fit_team_interface(const fit_team *team)
{
    return &team->interface;
}

void fit_team_set_rows(fit_team *team, size_t first, size_t count, size_t total)
{
    team->first = first;
    team->count = count;
    team->total = total;
}

size_t fit_team_resumed(const fit_team *team)
{
    return team->resumed;
}

void fit_team_forget(const char *state)
{
    char *temporary = join(state, ".new");
    (void)remove(state);
    (void)remove(temporary);
    free(temporary);
}
