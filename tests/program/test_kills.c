#define _GNU_SOURCE // PTRACE_GET_SYSCALL_INFO, mkdtemp()

// The program is killed 60 times, with BATTEN_LONG_TESTS 540 times: at the system calls that put files in their places, and
// at random times. Every output is then whole, old or new; no hidden file is left of new outputs, and the next run removes
// those of replaced ones.

#include "base/atomic_file.h"
#include "folder_helpers.h"

#include "batten/base.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>

enum
{
    AIMED = 20,     ///< kills at system calls, of new outputs and of replaced ones
    BLIND = 10,     ///< kills at random times, of both
    LONG = 9,       ///< times as many with BATTEN_LONG_TESTS
    TEXT_SIZE = 64, ///< bytes at the begin of an output that are compared
    OUTPUT_COUNT = 2
};

static const char *const OUTPUTS[OUTPUT_COUNT] = {"out.csv", "out.svg"};
static const char OLD[] = "old";
static const long NEVER = -1;

/// Whether a system call of the main thread changes what a folder holds, or waits for the disk.
static bool is_aim(uint64_t number)
{
    static const long CALLS[] = {SYS_fsync,  SYS_linkat, SYS_unlinkat, SYS_renameat2,
#ifdef SYS_rename
                                 SYS_rename, SYS_link,   SYS_unlink,
#endif
                                 SYS_fchmod};
    for (size_t i = 0; i < sizeof CALLS / sizeof *CALLS; i++)
        if (number == (uint64_t)CALLS[i])
            return true;
    return false;
}

static pid_t start(bool traced)
{
    pid_t process = fork();
    if (process != 0)
        return process;
    int nothing = open("/dev/null", O_WRONLY);
    bool ready = nothing >= 0 && dup2(nothing, STDOUT_FILENO) >= 0 && dup2(nothing, STDERR_FILENO) >= 0 &&
                 setenv("ASAN_OPTIONS", "detect_leaks=0", 1) == 0 && (!traced || ptrace(PTRACE_TRACEME, 0, NULL, NULL) == 0);
    if (ready)
        (void)execl(BATTEN_PROGRAM, "batten", "curve", "in.csv", "-o", OUTPUTS[0], "--picture", OUTPUTS[1], "--threads", "1",
                    (char *)NULL);
    _exit(127);
}

/// Run the program under a trace and kill it at the `kill_at`th stop of a system call that is_aim() tells, before or after
/// it; NEVER: not at all.
/// @return how many such stops there were; -1 where processes cannot be traced
static long run_traced(long kill_at)
{
    long stops = 0;
    int status = 0;
    uint64_t number = 0;
    pid_t process = start(true);
    assert_true(process > 0 && waitpid(process, &status, 0) == process);
    if (!WIFSTOPPED(status) || ptrace(PTRACE_SETOPTIONS, process, NULL, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL) != 0)
        return -1;
    while (ptrace(PTRACE_SYSCALL, process, NULL, NULL) == 0 && waitpid(process, &status, 0) == process && WIFSTOPPED(status))
    {
        struct __ptrace_syscall_info info;
        if (WSTOPSIG(status) != (SIGTRAP | 0x80))
            continue;
        if (ptrace(PTRACE_GET_SYSCALL_INFO, process, sizeof info, &info) <= 0)
            return -1;
        if (info.op == PTRACE_SYSCALL_INFO_ENTRY)
            number = info.entry.nr;
        if (is_aim(number) && stops++ == kill_at)
        {
            (void)kill(process, SIGKILL);
            (void)waitpid(process, NULL, 0);
            break;
        }
    }
    return stops;
}

static void run_blind(double seconds)
{
    pid_t process = start(false);
    assert_true(process > 0);
    (void)nanosleep(&(struct timespec){.tv_nsec = (long)(seconds * 1e9)}, NULL);
    (void)kill(process, SIGKILL);
    assert_int_equal(waitpid(process, NULL, 0), process);
}

static void read_begin(const char *path, char text[TEXT_SIZE])
{
    memset(text, 0, TEXT_SIZE);
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return;
    text[fread(text, 1, TEXT_SIZE - 1, file)] = '\0';
    (void)fclose(file);
}

static off_t size_of(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 ? about.st_size : -1;
}

static size_t count_hidden(bool and_age)
{
    size_t count = 0;
    DIR *folder = opendir(".");
    for (struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder))
        if (atomic_is_hidden(entry->d_name))
        {
            const struct timespec long_ago[2] = {{.tv_sec = time(NULL) - 7200}, {.tv_sec = time(NULL) - 7200}};
            assert_true(!and_age || utimensat(AT_FDCWD, entry->d_name, long_ago, 0) == 0);
            count++;
        }
    (void)closedir(folder);
    return count;
}

/// The results that a run gives which is not killed.
typedef struct whole
{
    char text[OUTPUT_COUNT][TEXT_SIZE];
    off_t size[OUTPUT_COUNT];
    double seconds;
} whole;

static void prepare_outputs(bool replaced)
{
    for (size_t i = 0; i < OUTPUT_COUNT; i++)
    {
        (void)unlink(OUTPUTS[i]);
        if (replaced)
            put(OUTPUTS[i], OLD);
    }
}

static void check_outputs(const whole *expected, bool replaced, size_t hidden_before)
{
    for (size_t i = 0; i < OUTPUT_COUNT; i++)
    {
        char text[TEXT_SIZE];
        read_begin(OUTPUTS[i], text);
        bool is_new = size_of(OUTPUTS[i]) == expected->size[i] && strcmp(text, expected->text[i]) == 0;
        bool is_old = replaced ? strcmp(text, OLD) == 0 : size_of(OUTPUTS[i]) < 0;
        assert_true(is_new || is_old);
    }
    if (!replaced)
        assert_int_equal(count_hidden(false), hidden_before);
}

static void nothing_is_lost_or_left(void **state)
{
    (void)state;
    static const char *const GIVEN = "0,0\n1,0\n1,1\n0.5,2\n";
    whole expected;
    bat_random random = bat_random_seed(1);
    const long times = getenv("BATTEN_LONG_TESTS") != NULL ? LONG : 1;
    put("in.csv", GIVEN);
    int nameless = atomic_open_nameless("out.csv", 0600);
    prepare_outputs(false);
    struct timespec begin, end;
    (void)clock_gettime(CLOCK_MONOTONIC, &begin);
    int status;
    assert_int_equal(waitpid(start(false), &status, 0) > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0, 1);
    (void)clock_gettime(CLOCK_MONOTONIC, &end);
    expected.seconds = (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
    for (size_t i = 0; i < OUTPUT_COUNT; i++)
    {
        read_begin(OUTPUTS[i], expected.text[i]);
        expected.size[i] = size_of(OUTPUTS[i]);
        assert_true(expected.size[i] > 0);
    }
    if (nameless < 0)
        skip();
    (void)close(nameless);
    for (int replaced = 0; replaced < 2; replaced++)
    {
        prepare_outputs(replaced);
        long stops = run_traced(NEVER);
        for (long k = 0; k < times * AIMED && stops > 0; k++)
        {
            prepare_outputs(replaced);
            size_t before = count_hidden(false);
            (void)run_traced(k * stops / (times * AIMED));
            check_outputs(&expected, replaced, before);
        }
        for (long k = 0; k < times * BLIND; k++)
        {
            prepare_outputs(replaced);
            size_t before = count_hidden(false);
            run_blind(bat_random_uniform(&random) * expected.seconds);
            check_outputs(&expected, replaced, before);
        }
    }
    // A file of a process that is there stays, and so does one that may be of another machine.
    char *own = atomic_hidden_name("out.csv", 0, -1);
    put(own, "own");
    (void)count_hidden(true);
    put(".batten-999999999-1-1-0.out.csv", "fresh");
    put(".batten-notes.txt", "of the user");
    assert_int_equal(waitpid(start(false), &status, 0) > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0, 1);
    assert_int_equal(count_hidden(false), 3);
    free(own);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(nothing_is_lost_or_left, enter_folder, leave_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
