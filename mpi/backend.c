#include "backend.h"

#include "ranks.h"
#include "solver.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct fit_backend
{
    bat_surface_fit_backend interface;
    petsc_solver *solver;
    char *path, *temporary; ///< of the state; null for none
    uint64_t label;
    size_t first, count, total; ///< rows
    size_t resumed;
};

// The solver

static bat_status factor(void *context, size_t size, const int *first, const int *row, const double *values, bool *regular,
                         bat_error *error)
{
    return petsc_load()->factor(((const fit_backend *)context)->solver, size, first, row, values, regular, error);
}

static bat_status solve(void *context, size_t columns, const double *right, double *solution, bat_error *error)
{
    return petsc_load()->solve(((const fit_backend *)context)->solver, columns, right, solution, error);
}

static bat_status attend(void *context, bat_error *error)
{
    return petsc_load()->attend(((const fit_backend *)context)->solver, error);
}

static bat_status release(void *context, bat_error *error)
{
    return petsc_load()->release(((const fit_backend *)context)->solver, error);
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
static bool move_columns(const fit_backend *backend, MPI_File file, MPI_Offset at, const bat_surface_fit_column *columns,
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
        for (size_t from = 0; from < backend->count; from += ROWS)
        {
            size_t left = backend->count - from, rows = left < ROWS ? left : ROWS;
            MPI_Offset place = at + (MPI_Offset)((backend->first + from) * width * sizeof(double));
            double *values = columns[k].values + from * width;
            MPI_Status status;
            int moved = 0;
            int result = writes ? MPI_File_write_at(file, place, values, (int)(rows * width), MPI_DOUBLE, &status)
                                : MPI_File_read_at(file, place, values, (int)(rows * width), MPI_DOUBLE, &status);
            if (result == MPI_SUCCESS)
                (void)MPI_Get_count(&status, MPI_DOUBLE, &moved);
            good = good && result == MPI_SUCCESS && moved == (int)(rows * width);
        }
        at += (MPI_Offset)(backend->total * width * sizeof(double));
    }
    (void)MPI_Allreduce(&good, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    return all != 0;
}

static bat_status save(void *context, const void *head, size_t size, const bat_surface_fit_column *columns,
                       size_t column_count, bat_error *error)
{
    const fit_backend *backend = context;
    MPI_File file;
    state_file_head own = {.label = backend->label, .total = backend->total, .size = size, .columns = column_count};
    memcpy(own.magic, MAGIC, sizeof own.magic);
    if (MPI_File_open(MPI_COMM_WORLD, backend->temporary, MPI_MODE_CREATE | MPI_MODE_WRONLY, MPI_INFO_NULL, &file) !=
        MPI_SUCCESS)
        return ranks_fail(error, BAT_FILE_ACCESS, "cannot write the checkpoint");
    size_t values = 0;
    for (size_t k = 0; k < column_count; k++)
        values += backend->total * columns[k].width;
    int good = MPI_File_set_size(file, (MPI_Offset)(sizeof own + size + values * sizeof(double))) == MPI_SUCCESS, all = 0;
    if (ranks_rank() == 0)
        good = good && MPI_File_write_at(file, 0, &own, (int)sizeof own, MPI_BYTE, MPI_STATUS_IGNORE) == MPI_SUCCESS &&
               MPI_File_write_at(file, (MPI_Offset)sizeof own, head, (int)size, MPI_BYTE, MPI_STATUS_IGNORE) == MPI_SUCCESS;
    good = move_columns(backend, file, (MPI_Offset)(sizeof own + size), columns, column_count, true) && good;
    good = MPI_File_sync(file) == MPI_SUCCESS && good;
    good = MPI_File_close(&file) == MPI_SUCCESS && good;
    (void)MPI_Allreduce(&good, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    // The old state stays until the new one is complete.
    if (all != 0 && ranks_rank() == 0)
        all = rename(backend->temporary, backend->path) == 0;
    (void)MPI_Bcast(&all, 1, MPI_INT, 0, MPI_COMM_WORLD);
    return all != 0 ? BAT_OK : ranks_fail(error, BAT_FILE_ACCESS, "cannot write the checkpoint");
}

static bat_status load(void *context, void **head, size_t *size, const bat_surface_fit_column *columns, size_t column_count,
                       bat_error *error)
{
    fit_backend *backend = context;
    MPI_File file;
    state_file_head own = {0};
    int exists = 0;
    *head = NULL;
    if (ranks_rank() == 0)
        exists = access(backend->path, F_OK) == 0;
    (void)MPI_Bcast(&exists, 1, MPI_INT, 0, MPI_COMM_WORLD);
    if (exists == 0)
        return BAT_OK;
    if (MPI_File_open(MPI_COMM_WORLD, backend->path, MPI_MODE_RDONLY, MPI_INFO_NULL, &file) != MPI_SUCCESS)
        return ranks_fail(error, BAT_FILE_ACCESS, "cannot read the checkpoint");
    (void)MPI_File_read_at_all(file, 0, &own, (int)sizeof own, MPI_BYTE, MPI_STATUS_IGNORE);
    size_t values = 0;
    for (size_t k = 0; k < column_count; k++)
        values += backend->total * columns[k].width;
    MPI_Offset bytes = 0;
    (void)MPI_File_get_size(file, &bytes);
    bool fits = memcmp(own.magic, MAGIC, sizeof own.magic) == 0 && own.label == backend->label &&
                own.total == backend->total && own.columns == column_count && own.size < INT_MAX &&
                (uint64_t)bytes == sizeof own + own.size + values * sizeof(double);
    bool good = fits;
    if (fits)
    {
        *head = ranks_allocate(own.size + 1, 1);
        good = MPI_File_read_at_all(file, (MPI_Offset)sizeof own, *head, (int)own.size, MPI_BYTE, MPI_STATUS_IGNORE) ==
               MPI_SUCCESS;
        good = move_columns(backend, file, (MPI_Offset)(sizeof own + own.size), columns, column_count, false) && good;
        uint64_t rounds = 0;
        if (own.size >= sizeof rounds)
            memcpy(&rounds, *head, sizeof rounds);
        backend->resumed = (size_t)rounds;
        *size = own.size;
    }
    (void)MPI_File_close(&file);
    if (good)
        return BAT_OK;
    free(*head);
    *head = NULL;
    return ranks_fail(error, BAT_BAD_FILE,
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

fit_backend *fit_backend_make(fit_solver_kind solver, const char *state, uint64_t label)
{
    fit_backend *backend = ranks_allocate(1, sizeof *backend);
    backend->label = label;
    backend->interface = (bat_surface_fit_backend){.context = backend};
    if (solver != FIT_SOLVER_CHOLESKY)
    {
        backend->solver = petsc_load()->make(solver == FIT_SOLVER_ITERATIVE);
        backend->interface.factor = factor;
        backend->interface.solve = solve;
        backend->interface.attend = attend;
        backend->interface.release = release;
    }
    if (state != NULL)
    {
        backend->path = join(state, "");
        backend->temporary = join(state, ".new");
        backend->interface.save = save;
        backend->interface.load = load;
    }
    return backend;
}

void fit_backend_free(fit_backend *backend)
{
    if (backend == NULL)
        return;
    if (backend->solver != NULL)
        petsc_load()->free(backend->solver);
    free(backend->path);
    free(backend->temporary);
    free(backend);
}

const bat_surface_fit_backend *fit_backend_interface(const fit_backend *backend)
{
    return &backend->interface;
}

void fit_backend_set_rows(fit_backend *backend, size_t first, size_t count, size_t total)
{
    backend->first = first;
    backend->count = count;
    backend->total = total;
}

size_t fit_backend_resumed(const fit_backend *backend)
{
    return backend->resumed;
}

void fit_backend_forget(const char *state)
{
    char *temporary = join(state, ".new");
    (void)remove(state);
    (void)remove(temporary);
    free(temporary);
}
