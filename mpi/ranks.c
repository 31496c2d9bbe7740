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

bool ranks_read_arguments(const verb_spec *spec, int argc, char **argv, arguments *given, int *exit_code)
{
    if (ranks_rank() == 0)
        return arguments_read(spec, argc, argv, given, exit_code);
    int errors = dup(STDERR_FILENO), silence = open("/dev/null", O_WRONLY);
    (void)dup2(silence, STDERR_FILENO);
    bool goes_on = arguments_read(spec, argc, argv, given, exit_code);
    (void)dup2(errors, STDERR_FILENO);
    (void)close(errors);
    (void)close(silence);
    return goes_on;
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

void ranks_need_memory(const void *pointer, size_t bytes)
{
    bat_error error = {.status = BAT_NO_MEMORY};
    if (pointer != NULL || bytes == 0)
        return;
    (void)snprintf(error.text, sizeof error.text, "rank %d is out of memory (%zu bytes)", ranks_rank(), bytes);
    ranks_need(NULL, BAT_NO_MEMORY, &error);
}
