/// What newer C libraries have and that of manylinux_2_28 has not, for archives of the system that a wheel's module is
/// linked with. No header declares them here as theirs do: there some are macros, or inline.

#include <dlfcn.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/random.h>

struct stat;
int __xstat(int version, const char *path, struct stat *status);
int __lxstat(int version, const char *path, struct stat *status);
int __fxstat(int version, int file, struct stat *status);
int __fxstatat(int version, int folder, const char *path, struct stat *status, int flags);

#ifdef __x86_64__
#define STAT_VERSION 1
#else
#define STAT_VERSION 0
#endif

int stat(const char *path, struct stat *status)
{
    return __xstat(STAT_VERSION, path, status);
}

int lstat(const char *path, struct stat *status)
{
    return __lxstat(STAT_VERSION, path, status);
}

int fstat(int file, struct stat *status)
{
    return __fxstat(STAT_VERSION, file, status);
}

int fstatat(int folder, const char *path, struct stat *status, int flags)
{
    return __fxstatat(STAT_VERSION, folder, path, status, flags);
}

void arc4random_buf(void *buffer, size_t size)
{
    enum
    {
        AT_ONCE = 256,
    };
    for (char *to = buffer; size > 0;)
    {
        ssize_t got = getrandom(to, size < AT_ONCE ? size : AT_ONCE, 0);
        if (got < 0)
            abort();
        to += got;
        size -= (size_t)got;
    }
}

/// Archives that are not position-independent reach variables of their own module alone: copies of the C library's.
void *stdin, *stdout, *stderr;

__attribute__((constructor(101))) static void copy_streams(void)
{
    stdin = *(void **)dlsym(RTLD_DEFAULT, "stdin");
    stdout = *(void **)dlsym(RTLD_DEFAULT, "stdout");
    stderr = *(void **)dlsym(RTLD_DEFAULT, "stderr");
}
