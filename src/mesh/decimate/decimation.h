#ifndef MESH_DECIMATE_DECIMATION_H
#define MESH_DECIMATE_DECIMATION_H

#include "batten/mesh_decimate.h"
#include "mesh/decimate/tolerance.h"

/// @file
/// One run of collapses, to a number of vertices or faces, or as far as a bound on the distance allows.

/// Where a run ends: at either number.
typedef struct decimation_target
{
    size_t vertices, faces;
} decimation_target;

/// Collapse edges until the target is reached or no further collapse passes the checks.
/// @param options checked; the targets among them are not read
/// @param bound   null, or the tolerance of a fresh run
/// @return as bat_mesh_decimate()
bat_status decimation_run(const bat_mesh *fine, const bat_mesh_decimate_options *options, const decimation_target *target,
                          tolerance *bound, bat_mesh *coarse, bat_mesh_map **map, bat_error *error);

#endif
