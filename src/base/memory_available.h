#ifndef BASE_MEMORY_AVAILABLE_H
#define BASE_MEMORY_AVAILABLE_H

#include <stddef.h>

/// The bytes of memory that the machine has to spare, or that the control group of the process leaves; 0 where the system
/// does not tell.
size_t memory_available(void);

#endif
