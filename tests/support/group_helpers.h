#ifndef TESTS_SUPPORT_GROUP_HELPERS_H
#define TESTS_SUPPORT_GROUP_HELPERS_H

// A group of processes on this machine: children of the test, joined by sockets. The test itself must not have used threads
// of OpenMP before, which children do not inherit.

#include "check.h"

#include "batten/base.h"
#include "batten/research/distributed.h"

#include <signal.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum
{
    MAX_RANKS = 16
};

/// Memory, all zero, that the children share with the test.
static inline void *group_memory(size_t size)
{
    char path[] = "/tmp/batten-group-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0 && unlink(path) == 0 && ftruncate(file, (off_t)size) == 0);
    void *memory = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    assert_true(memory != MAP_FAILED);
    (void)close(file);
    return memory;
}

typedef struct group_links
{
    int ends[MAX_RANKS][MAX_RANKS]; ///< [i][j]: where rank i reads and writes what it exchanges with rank j
    size_t rank;
} group_links;

static inline bat_status group_fails(bat_error *error)
{
    if (error != NULL)
        *error = (bat_error){.status = BAT_FILE_ACCESS, .index = BAT_NO_INDEX, .text = "a process of the group is gone"};
    return BAT_FILE_ACCESS;
}

static inline bat_status group_send(void *context, size_t to, const void *bytes, size_t size, bat_error *error)
{
    const group_links *links = context;
    const char *at = bytes;
    while (size > 0)
    {
        ssize_t written = send(links->ends[links->rank][to], at, size, MSG_NOSIGNAL);
        if (written <= 0)
            return group_fails(error);
        at += written;
        size -= (size_t)written;
    }
    return BAT_OK;
}

static inline bat_status group_receive(void *context, size_t from, void *bytes, size_t size, bat_error *error)
{
    const group_links *links = context;
    char *at = bytes;
    while (size > 0)
    {
        ssize_t got = read(links->ends[links->rank][from], at, size);
        if (got <= 0)
            return group_fails(error);
        at += got;
        size -= (size_t)got;
    }
    return BAT_OK;
}

/// Join every two of a group's processes.
static inline void group_join(size_t count, int ends[MAX_RANKS][MAX_RANKS])
{
    assert_true(count <= MAX_RANKS);
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count; j++)
        {
            int pair[2];
            assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, pair), 0);
            ends[i][j] = pair[0];
            ends[j][i] = pair[1];
        }
}

static inline void group_part(size_t count, int ends[MAX_RANKS][MAX_RANKS])
{
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            if (i != j)
                (void)close(ends[i][j]);
}

/// What a process of a group does; no assertions here. Returns its status.
typedef bat_status group_member(const bat_group *group, void *context, bat_error *error);

/// How the processes of a group ended.
typedef struct group_results
{
    bat_status status[MAX_RANKS];
    bat_error error[MAX_RANKS];
} group_results;

/// Run a function in `count` processes at once; wait for all. A process alone gets no group.
static inline const group_results *group_run(size_t count, group_member *member, void *context)
{
    static group_results *results;
    group_links links = {0};
    pid_t children[MAX_RANKS];
    if (results == NULL)
        results = group_memory(sizeof *results);
    group_join(count, links.ends);
    (void)fflush(NULL);
    for (size_t rank = 0; rank < count; rank++)
    {
        children[rank] = fork();
        assert_true(children[rank] >= 0);
        if (children[rank] > 0)
            continue;
        bat_group group = {.rank = rank, .count = count, .context = &links, .send = group_send, .receive = group_receive};
        links.rank = rank;
        for (size_t i = 0; i < count; i++)
            for (size_t j = 0; j < count; j++)
                if (i != rank && i != j)
                    (void)close(links.ends[i][j]);
        results->status[rank] = member(count > 1 ? &group : NULL, context, &results->error[rank]);
        _exit(0);
    }
    group_part(count, links.ends);
    for (size_t rank = 0; rank < count; rank++)
    {
        int code;
        assert_int_equal(waitpid(children[rank], &code, 0), children[rank]);
        assert_true(WIFEXITED(code) && WEXITSTATUS(code) == 0);
    }
    return results;
}

/// group_run() of which every process must succeed.
static inline void group_succeeds(size_t count, group_member *member, void *context)
{
    const group_results *results = group_run(count, member, context);
    for (size_t rank = 0; rank < count; rank++)
        if (results->status[rank] != BAT_OK)
            fail_msg("rank %zu of %zu: %s", rank, count, results->error[rank].text);
}

#endif
