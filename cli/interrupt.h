#ifndef CLI_INTERRUPT_H
#define CLI_INTERRUPT_H

#include "batten/base.h"

/// @file
/// What SIGINT (Ctrl-C), SIGTERM and SIGHUP do: they end the program with one line and exit code 1, and no temporary file
/// stays.

/// Catch the signals that the program was not started to ignore. Called once, from the main thread.
void interrupt_catch(void);

/// The files under way, whose temporary files are removed when a signal ends the program; null for none.
void interrupt_files(const bat_outputs *files);

/// How a signal is taken.
typedef enum interrupt_mode
{
    INTERRUPT_AT_ONCE,     ///< it ends the program
    INTERRUPT_COOPERATIVE, ///< the first one makes interrupt_pending() true; a second one ends the program
    INTERRUPT_NEVER        ///< it is forgotten
} interrupt_mode;

/// Choose how signals are taken. INTERRUPT_AT_ONCE ends the program when one is pending.
void interrupt_use(interrupt_mode mode);

/// Whether a signal has come.
bool interrupt_pending(void);

#endif
