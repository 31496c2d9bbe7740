#include "counts.h"

#include <mpi.h>
#include <stdint.h>
#include <sys/resource.h>

static counts here;

void counts_wait(double seconds)
{
    here.waiting += seconds;
}

counts counts_now(void)
{
    struct rusage usage;
    counts now = here;
    if (getrusage(RUSAGE_SELF, &usage) == 0)
        now.memory = (double)usage.ru_maxrss * 1024;
    return now;
}

counts_summary counts_collect(void)
{
    counts now = counts_now();
    counts_summary summary = {0};
    double mine[4] = {now.bytes, now.messages, now.waiting, now.memory}, sums[4] = {0}, largest[4] = {0};
    (void)PMPI_Comm_size(MPI_COMM_WORLD, &summary.ranks);
    (void)PMPI_Allreduce(mine, sums, 4, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    (void)PMPI_Allreduce(mine, largest, 4, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    summary.sum = (counts){sums[0], sums[1], sums[2], sums[3]};
    summary.largest = (counts){largest[0], largest[1], largest[2], largest[3]};
    return summary;
}

void counts_print(const counts_summary *summary, FILE *stream)
{
    (void)fprintf(stream,
                  "%d ranks: %.0f bytes sent in %.0f messages, at most %.3g s waiting and %.0f MiB of memory in one rank\n",
                  summary->ranks, summary->sum.bytes, summary->sum.messages, summary->largest.waiting,
                  summary->largest.memory / 1048576);
}

json_t *counts_json(const counts_summary *summary)
{
    return json_pack("{s:i, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "ranks", summary->ranks, "bytes", summary->sum.bytes,
                     "messages", summary->sum.messages, "waiting", summary->sum.waiting, "memory", summary->sum.memory,
                     "largest_bytes", summary->largest.bytes, "largest_waiting", summary->largest.waiting, "largest_memory",
                     summary->largest.memory);
}

static int size_of(MPI_Comm comm)
{
    int size;
    (void)PMPI_Comm_size(comm, &size);
    return size;
}

static int rank_of(MPI_Comm comm)
{
    int rank;
    (void)PMPI_Comm_rank(comm, &rank);
    return rank;
}

static double bytes_of(double count, MPI_Datatype type)
{
    int size;
    (void)PMPI_Type_size(type, &size);
    return count * size;
}

static void add(double messages, double bytes)
{
    here.messages += messages;
    here.bytes += bytes;
}

static void add_to(int target, MPI_Comm comm, int count, MPI_Datatype type)
{
    if (target != MPI_PROC_NULL && target != rank_of(comm))
        add(1, bytes_of(count, type));
}

/// A call that waits for other ranks.
#define WAITED(call)                                                                                                        \
    double begin = PMPI_Wtime();                                                                                            \
    int result = call;                                                                                                      \
    here.waiting += PMPI_Wtime() - begin;                                                                                   \
    return result

// Messages.

int MPI_Send(const void *buffer, int count, MPI_Datatype type, int target, int tag, MPI_Comm comm)
{
    add_to(target, comm, count, type);
    WAITED(PMPI_Send(buffer, count, type, target, tag, comm));
}

int MPI_Isend(const void *buffer, int count, MPI_Datatype type, int target, int tag, MPI_Comm comm, MPI_Request *request)
{
    add_to(target, comm, count, type);
    return PMPI_Isend(buffer, count, type, target, tag, comm, request);
}

int MPI_Issend(const void *buffer, int count, MPI_Datatype type, int target, int tag, MPI_Comm comm, MPI_Request *request)
{
    add_to(target, comm, count, type);
    return PMPI_Issend(buffer, count, type, target, tag, comm, request);
}

/// Persistent sends are counted once, where they are made: PETSc starts each as often as it scatters a vector.
int MPI_Send_init(const void *buffer, int count, MPI_Datatype type, int target, int tag, MPI_Comm comm, MPI_Request *request)
{
    add_to(target, comm, count, type);
    return PMPI_Send_init(buffer, count, type, target, tag, comm, request);
}

int MPI_Recv(void *buffer, int count, MPI_Datatype type, int source, int tag, MPI_Comm comm, MPI_Status *status)
{
    WAITED(PMPI_Recv(buffer, count, type, source, tag, comm, status));
}

int MPI_Sendrecv(const void *out, int out_count, MPI_Datatype out_type, int target, int out_tag, void *in, int in_count,
                 MPI_Datatype in_type, int source, int in_tag, MPI_Comm comm, MPI_Status *status)
{
    add_to(target, comm, out_count, out_type);
    WAITED(PMPI_Sendrecv(out, out_count, out_type, target, out_tag, in, in_count, in_type, source, in_tag, comm, status));
}

int MPI_Wait(MPI_Request *request, MPI_Status *status)
{
    WAITED(PMPI_Wait(request, status));
}

int MPI_Waitall(int count, MPI_Request requests[], MPI_Status *statuses)
{
    WAITED(PMPI_Waitall(count, requests, statuses));
}

int MPI_Waitany(int count, MPI_Request requests[], int *index, MPI_Status *status)
{
    WAITED(PMPI_Waitany(count, requests, index, status));
}

int MPI_Probe(int source, int tag, MPI_Comm comm, MPI_Status *status)
{
    WAITED(PMPI_Probe(source, tag, comm, status));
}

int MPI_Barrier(MPI_Comm comm)
{
    WAITED(PMPI_Barrier(comm));
}

// Collective calls.

int MPI_Bcast(void *buffer, int count, MPI_Datatype type, int root, MPI_Comm comm)
{
    double others = size_of(comm) - 1;
    if (rank_of(comm) == root)
        add(others, others * bytes_of(count, type));
    WAITED(PMPI_Bcast(buffer, count, type, root, comm));
}

int MPI_Gather(const void *out, int out_count, MPI_Datatype out_type, void *in, int in_count, MPI_Datatype in_type, int root,
               MPI_Comm comm)
{
    add_to(root, comm, out_count, out_type);
    WAITED(PMPI_Gather(out, out_count, out_type, in, in_count, in_type, root, comm));
}

int MPI_Ibcast(void *buffer, int count, MPI_Datatype type, int root, MPI_Comm comm, MPI_Request *request)
{
    double others = size_of(comm) - 1;
    if (rank_of(comm) == root)
        add(others, others * bytes_of(count, type));
    return PMPI_Ibcast(buffer, count, type, root, comm, request);
}

int MPI_Igather(const void *out, int out_count, MPI_Datatype out_type, void *in, int in_count, MPI_Datatype in_type,
                int root, MPI_Comm comm, MPI_Request *request)
{
    add_to(root, comm, out_count, out_type);
    return PMPI_Igather(out, out_count, out_type, in, in_count, in_type, root, comm, request);
}

int MPI_Igatherv(const void *out, int out_count, MPI_Datatype out_type, void *in, const int in_counts[], const int places[],
                 MPI_Datatype in_type, int root, MPI_Comm comm, MPI_Request *request)
{
    add_to(root, comm, out_count, out_type);
    return PMPI_Igatherv(out, out_count, out_type, in, in_counts, places, in_type, root, comm, request);
}

int MPI_Gatherv(const void *out, int out_count, MPI_Datatype out_type, void *in, const int in_counts[], const int places[],
                MPI_Datatype in_type, int root, MPI_Comm comm)
{
    add_to(root, comm, out_count, out_type);
    WAITED(PMPI_Gatherv(out, out_count, out_type, in, in_counts, places, in_type, root, comm));
}

int MPI_Allgather(const void *out, int out_count, MPI_Datatype out_type, void *in, int in_count, MPI_Datatype in_type,
                  MPI_Comm comm)
{
    double others = size_of(comm) - 1;
    add(others, others * bytes_of(in_count, in_type));
    WAITED(PMPI_Allgather(out, out_count, out_type, in, in_count, in_type, comm));
}

int MPI_Allgatherv(const void *out, int out_count, MPI_Datatype out_type, void *in, const int in_counts[],
                   const int places[], MPI_Datatype in_type, MPI_Comm comm)
{
    double others = size_of(comm) - 1;
    add(others, others * bytes_of(in_counts[rank_of(comm)], in_type));
    WAITED(PMPI_Allgatherv(out, out_count, out_type, in, in_counts, places, in_type, comm));
}

int MPI_Scatterv(const void *out, const int out_counts[], const int places[], MPI_Datatype out_type, void *in, int in_count,
                 MPI_Datatype in_type, int root, MPI_Comm comm)
{
    if (rank_of(comm) == root)
        for (int rank = 0; rank < size_of(comm); rank++)
            add_to(rank, comm, out_counts[rank], out_type);
    WAITED(PMPI_Scatterv(out, out_counts, places, out_type, in, in_count, in_type, root, comm));
}

int MPI_Alltoall(const void *out, int out_count, MPI_Datatype out_type, void *in, int in_count, MPI_Datatype in_type,
                 MPI_Comm comm)
{
    double others = size_of(comm) - 1;
    add(others, others * bytes_of(in_count, in_type));
    WAITED(PMPI_Alltoall(out, out_count, out_type, in, in_count, in_type, comm));
}

int MPI_Alltoallv(const void *out, const int out_counts[], const int out_places[], MPI_Datatype out_type, void *in,
                  const int in_counts[], const int in_places[], MPI_Datatype in_type, MPI_Comm comm)
{
    for (int rank = 0; rank < size_of(comm); rank++)
        if (out_counts[rank] > 0)
            add_to(rank, comm, out_counts[rank], out_type);
    WAITED(PMPI_Alltoallv(out, out_counts, out_places, out_type, in, in_counts, in_places, in_type, comm));
}

static void add_reduction(int count, MPI_Datatype type, MPI_Comm comm)
{
    double size = size_of(comm);
    add(2 * (size - 1), 2 * (size - 1) / size * bytes_of(count, type));
}

int MPI_Reduce(const void *out, void *in, int count, MPI_Datatype type, MPI_Op operation, int root, MPI_Comm comm)
{
    add_to(root, comm, count, type);
    WAITED(PMPI_Reduce(out, in, count, type, operation, root, comm));
}

int MPI_Allreduce(const void *out, void *in, int count, MPI_Datatype type, MPI_Op operation, MPI_Comm comm)
{
    add_reduction(count, type, comm);
    WAITED(PMPI_Allreduce(out, in, count, type, operation, comm));
}

int MPI_Reduce_scatter_block(const void *out, void *in, int count, MPI_Datatype type, MPI_Op operation, MPI_Comm comm)
{
    add_reduction(count, type, comm);
    WAITED(PMPI_Reduce_scatter_block(out, in, count, type, operation, comm));
}

int MPI_Exscan(const void *out, void *in, int count, MPI_Datatype type, MPI_Op operation, MPI_Comm comm)
{
    if (rank_of(comm) + 1 < size_of(comm))
        add(1, bytes_of(count, type));
    WAITED(PMPI_Exscan(out, in, count, type, operation, comm));
}

int MPI_Scan(const void *out, void *in, int count, MPI_Datatype type, MPI_Op operation, MPI_Comm comm)
{
    if (rank_of(comm) + 1 < size_of(comm))
        add(1, bytes_of(count, type));
    WAITED(PMPI_Scan(out, in, count, type, operation, comm));
}
