#include "verb.h"

const verb *const VERBS[] = {&VERB_CURVE,     &VERB_MOTION,      &VERB_DECIMATE,   &VERB_MESH,
                             &VERB_SURFACE,   &VERB_MEASURE,     &VERB_SHAPE,      &VERB_ANALYZE,
                             &VERB_REPRODUCE, &VERB_TRAIN_CURVE, &VERB_TRAIN_MESH, &VERB_TRAIN_SURFACE,
                             &VERB_LIST,      &VERB_COMPLETION,  &VERB_MANUAL,     NULL};
