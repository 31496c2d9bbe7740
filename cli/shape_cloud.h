#ifndef CLI_SHAPE_CLOUD_H
#define CLI_SHAPE_CLOUD_H

#include "batten/base.h"

/// A cloud that `batten shape` makes.
typedef struct shape_cloud_job
{
    const char *kind, *output, *picture; ///< the last two may be null
    size_t points;
    uint64_t seed;
    bool json, quiet;
} shape_cloud_job;

/// Whether a kind of shape is a cloud.
bool shape_cloud_is_kind(const char *name);
/// The name and a line about kind `index`, from 0 on; false past the last.
bool shape_cloud_row(size_t index, const char **name, const char **summary);

/// Make it, write it and draw it. Returns the program's exit code.
int shape_cloud_make(const shape_cloud_job *job);

#endif
