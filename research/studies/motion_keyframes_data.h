#ifndef STUDIES_MOTION_KEYFRAMES_DATA_H
#define STUDIES_MOTION_KEYFRAMES_DATA_H

#include <stdbool.h>
#include <stddef.h>

enum
{
    KEYFRAME_FACT_COUNT = 36,
    KEYFRAME_PEERS = 3
};

/// What scipy's interpolants do on a motion of which every `step`th pose is kept: root mean squares of the errors.
typedef struct keyframe_facts
{
    const char *motion;
    bool noisy;
    size_t step, poses;
    double peers[KEYFRAME_PEERS][2]; ///< translation, and angle in degrees: spline, squad with Akima, Slerp with lines
} keyframe_facts;

/// Motion by motion, steps in increasing order.
extern const keyframe_facts KEYFRAME_FACTS[KEYFRAME_FACT_COUNT];

#endif
