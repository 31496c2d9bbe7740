#include "ranks.h"

#include "report.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

int ranks_rank(void)
{
    int rank;
    (void)MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    return rank;
}

int ranks_count(void)
{
    int count;
    (void)MPI_Comm_size(MPI_COMM_WORLD, &count);
    return count;
}

int ranks_silence(void)
{
    if (ranks_rank() == 0)
        return -1;
    int errors = dup(STDERR_FILENO), silence = open("/dev/null", O_WRONLY);
    (void)dup2(silence, STDERR_FILENO);
    (void)close(silence);
    return errors;
}

void ranks_speak(int silence)
{
    if (silence < 0)
        return;
    (void)dup2(silence, STDERR_FILENO);
    (void)close(silence);
}

bool ranks_read_arguments(const struct verb *what, int argc, char **argv, arguments *given, int *exit_code)
{
    int silence = ranks_silence();
    bool goes_on = arguments_read(what, argc, argv, given, exit_code);
    ranks_speak(silence);
    return goes_on;
}

bat_status ranks_agree_on(bat_status status, bat_error *error)
{
    int rank = status != BAT_OK ? ranks_rank() : ranks_count(), lowest = rank;
    (void)MPI_Allreduce(&rank, &lowest, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    if (lowest == ranks_count())
        return BAT_OK;
    if (status != BAT_OK)
        error->status = status;
    (void)MPI_Bcast(error, (int)sizeof *error, MPI_BYTE, lowest, MPI_COMM_WORLD);
    return error->status;
}

bool ranks_agree(const char *file, bat_status status, const bat_error *error)
{
    bat_error failure = status != BAT_OK ? *error : (bat_error){0};
    if (ranks_agree_on(status, &failure) == BAT_OK)
        return true;
    if (ranks_rank() == 0)
        (void)report_failure(file, &failure);
    return false;
}

bat_status ranks_fail(bat_error *error, bat_status status, const char *text)
{
    if (error != NULL)
    {
        *error = (bat_error){.status = status, .index = BAT_NO_INDEX};
        (void)snprintf(error->text, sizeof error->text, "%s", text);
    }
    return status;
}

void ranks_need(const char *file, bat_status status, const bat_error *error)
{
    if (status == BAT_OK)
        return;
    (void)report_failure(file, error);
    (void)fflush(NULL);
    (void)MPI_Abort(MPI_COMM_WORLD, EXIT_BAD_INPUT);
    exit(EXIT_BAD_INPUT);
}

void *ranks_allocate(size_t count, size_t size)
{
    bat_error error = {.status = BAT_NO_MEMORY, .index = BAT_NO_INDEX};
    void *array = calloc(count > 0 ? count : 1, size);
    if (array == NULL)
    {
        (void)snprintf(error.text, sizeof error.text, "rank %d is out of memory (%zu times %zu bytes)", ranks_rank(), count,
                       size);
        ranks_need(NULL, BAT_NO_MEMORY, &error);
    }
    return array;
}

void *ranks_grow(void *array, size_t count, size_t size)
{
    bat_error error = {.status = BAT_NO_MEMORY, .index = BAT_NO_INDEX};
    void *grown = realloc(array, count * size);
    if (grown == NULL)
    {
        (void)snprintf(error.text, sizeof error.text, "rank %d is out of memory (%zu times %zu bytes)", ranks_rank(), count,
                       size);
        ranks_need(NULL, BAT_NO_MEMORY, &error);
    }
    return grown;
}
