#ifndef FUZZ_PROMISE_H
#define FUZZ_PROMISE_H

#include <stdlib.h>

/// Stop at a broken promise, so that the fuzzer keeps the input.
#define PROMISE(condition)                                                                                                  \
    do                                                                                                                      \
    {                                                                                                                       \
        if (!(condition))                                                                                                   \
            abort();                                                                                                        \
    } while (0)

#endif
