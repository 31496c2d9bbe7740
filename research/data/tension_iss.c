/// @file
/// The ground track of the International Space Station over one orbit: Ugail and Howard (2026), section 8, eq. (24) and
/// (25), with its control polygon.

#include "batten/research/curve_data.h"

#include "base/error.h"
#include "base/memory.h"
#include "research/data/control_polygon.h"
#include "space/builtin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
static const double INCLINATION_DEGREES = 51.64;
static const double PERIOD_MINUTES = 92.68;
static const double NODE_LONGITUDE_DEGREES = -155;
/// Length of the sidereal day.
static const double DAY_MINUTES = 23 * 60 + 56.067;

enum
{
    TRACK = BAT_ISS_TRACK_POINTS,
    ARC = 40,
    ORBIT = TRACK - ARC,
    CONTROL = BAT_ISS_CONTROL_POINTS,
    DIM = 3
};

/// The subsatellite point at fraction `turn` of the orbit (eq. 24 and 25).
static void ground_point(double turn, double *point)
{
    double inclination = INCLINATION_DEGREES * PI / 180, anomaly = 2 * PI * turn;
    double earth_rotation = 2 * PI * turn * PERIOD_MINUTES / DAY_MINUTES;
    double node = NODE_LONGITUDE_DEGREES * PI / 180;
    double latitude = asin(sin(inclination) * sin(anomaly));
    double longitude = atan2(cos(inclination) * sin(anomaly), cos(anomaly)) - earth_rotation + node;
    point[0] = cos(latitude) * cos(longitude);
    point[1] = cos(latitude) * sin(longitude);
    point[2] = sin(latitude);
}

static bat_status make_track(const bat_space *sphere, double *track)
{
    for (size_t i = 0; i < ORBIT; i++)
        ground_point((double)i / ORBIT, track + i * DIM);
    const double *end = track + (size_t)(ORBIT - 1) * DIM;
    memcpy(track + (size_t)ORBIT * DIM, end, DIM * sizeof *track);
    bat_status status = BAT_OK;
    for (size_t i = 1; i < ARC && status == BAT_OK; i++)
        status = bat_space_geodesic(sphere, end, track, (double)i / ARC, track + (ORBIT + i) * DIM);
    return status;
}

bat_status bat_tension_iss_track(const bat_space *sphere, bat_curve *truth, bat_curve *control, bat_error *error)
{
    if (!space_is_sphere(sphere))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the ground track needs the sphere of dimension 2");
    double *track = memory_array(TRACK * DIM, sizeof *track);
    double *polygon = memory_array(CONTROL * DIM, sizeof *polygon);
    bat_status status = BAT_OK;
    if (track == NULL || polygon == NULL)
        status = error_memory(error, (TRACK + CONTROL) * DIM * sizeof *track);
    else if ((status = make_track(sphere, track)) != BAT_OK)
        (void)error_set(error, status, BAT_NO_INDEX, 0, "the ground track cannot be closed");
    if (status != BAT_OK)
    {
        free(track);
        free(polygon);
        return status;
    }
    double lengths[TRACK + 1];
    size_t samples[CONTROL];
    arc_samples(track, TRACK, DIM, false, lengths, CONTROL, samples);
    for (size_t k = 0; k < CONTROL; k++)
        memcpy(polygon + k * DIM, track + samples[k] * DIM, DIM * sizeof *polygon);
    *truth = (bat_curve){.space = sphere, .points = track, .count = TRACK, .closed = true};
    *control = (bat_curve){.space = sphere, .points = polygon, .count = CONTROL, .closed = true};
    return BAT_OK;
}
