#ifndef CLI_SURFACE_INPUT_H
#define CLI_SURFACE_INPUT_H

#include "arguments.h"

#include "batten/batten.h"

/// @file
/// What `batten surface` is told about the cloud, and reads.

/// Options about the cloud.
typedef struct surface_input
{
    const char *path;
    bat_cloud_read_options read;
    size_t corners[4]; ///< points of the input
    bool has_corners;
} surface_input;

/// False after a message.
bool surface_input_arguments(const arguments *given, surface_input *input);

/// Read the cloud, and its boundary and corners as far as they are given. Returns the program's exit code.
int surface_input_read(const surface_input *input, bat_cloud *cloud);

/// Whether a file holds a spline surface, by its name: there is nothing to fit then.
bool surface_input_is_surface(const char *path);

#endif
