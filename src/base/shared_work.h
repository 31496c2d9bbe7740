#pragma once

#include "batten/base.h"

/// Numbered pieces of work that threads share: progress, cancelling, and the failure with the lowest number, which is the
/// one that a single thread would have met first, so that messages do not depend on the number of threads.
typedef struct shared_work
{
    bat_progress progress;
    size_t total, done; ///< pieces
    size_t failed;      ///< the first piece that failed; SIZE_MAX while none has
    bat_status status;
    bat_error error;
    bool cancelled;
} shared_work;

shared_work shared_work_make(size_t total, bat_progress progress);

/// Whether a piece is still wanted: not when the caller has cancelled, nor when a piece before it has failed.
bool shared_work_wants(const shared_work *work, size_t piece);

/// Say that a piece is done, and how it ended: `error` is read where it failed. The calling thread reports progress.
void shared_work_finish(shared_work *work, size_t piece, bat_status status, const bat_error *error);

/// Report progress again within a long piece, so that the caller can cancel. Only the calling thread does.
void shared_work_poll(shared_work *work);

/// How all ended, once the threads have joined: BAT_OK, the first failure, or BAT_CANCELLED. Reports the end.
bat_status shared_work_end(const shared_work *work, bat_error *error);
