#include "report.h"

#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

static volatile sig_atomic_t pending, mode;
static const bat_outputs *_Atomic files;
static pthread_t main_thread;
static bool on_terminal; ///< standard error is one
static volatile sig_atomic_t late;

/// End the program. Everything here may be called from a signal handler.
static void stop(void)
{
    static const char stopped[] = "batten: stopped\n", over[] = "batten: the time of --max-seconds is over\n";
    static const char erase[] = "\r\033[K";
    const char *text = late ? over : stopped;
    size_t size = late ? sizeof over : sizeof stopped;
    if (files != NULL)
        bat_outputs_remove(files);
    if ((on_terminal && write(STDERR_FILENO, erase, sizeof erase - 1) < 0) || write(STDERR_FILENO, text, size - 1) < 0)
        _exit(EXIT_BAD_INPUT);
    _exit(EXIT_BAD_INPUT);
}

static void on_signal(int signal_number)
{
    // The files under way belong to the main thread.
    if (!pthread_equal(pthread_self(), main_thread))
    {
        (void)pthread_kill(main_thread, signal_number);
        return;
    }
    late = late || signal_number == SIGALRM;
    if (mode == INTERRUPT_AT_ONCE || (late && mode != INTERRUPT_NEVER) || (mode == INTERRUPT_COOPERATIVE && pending))
        stop();
    pending = 1;
}

void interrupt_catch(void)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGALRM};
    main_thread = pthread_self();
    on_terminal = isatty(STDERR_FILENO) != 0;
    struct sigaction action = {.sa_handler = on_signal};
    action.sa_flags = SA_RESTART;
    (void)sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
    {
        struct sigaction before;
        if (sigaction(signals[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            (void)sigaction(signals[i], &action, NULL);
    }
}

void interrupt_limit(double seconds, double megabytes)
{
    static const double MILLION = 1e6;
    double whole = floor(fmin(seconds, 1e9));
    struct itimerval timer = {.it_value = {.tv_sec = (time_t)whole, .tv_usec = (suseconds_t)((seconds - whole) * MILLION)}};
    struct rlimit limit;
    if (seconds > 0)
        (void)setitimer(ITIMER_REAL, &timer, NULL);
    if (!(megabytes > 0) || getrlimit(RLIMIT_AS, &limit) != 0)
        return;
    double bytes = fmin(megabytes * MILLION, 1e18);
    if (limit.rlim_cur == RLIM_INFINITY || bytes < (double)limit.rlim_cur)
        limit.rlim_cur = (rlim_t)bytes;
    (void)setrlimit(RLIMIT_AS, &limit);
}

bool interrupt_memory_is_limited(void)
{
    struct rlimit space, data;
    return (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY) ||
           (getrlimit(RLIMIT_DATA, &data) == 0 && data.rlim_cur != RLIM_INFINITY);
}

void interrupt_files(const bat_outputs *new_files)
{
    files = new_files;
}

void interrupt_use(interrupt_mode new_mode)
{
    // What came while it could not be obeyed came too late.
    if (mode == INTERRUPT_NEVER)
        pending = 0;
    mode = (sig_atomic_t)new_mode;
    if (new_mode == INTERRUPT_AT_ONCE && pending)
        stop();
}

bool interrupt_pending(void)
{
    return pending != 0;
}
