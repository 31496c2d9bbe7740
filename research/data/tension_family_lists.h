#ifndef RESEARCH_DATA_TENSION_FAMILY_LISTS_H
#define RESEARCH_DATA_TENSION_FAMILY_LISTS_H

#include "batten/base.h"

/// @file
/// What tension_family.h is put together from: the families of each space.

/// A family by name. `draw` writes `count` points of a random member.
typedef struct tension_family
{
    const char *name;
    void (*draw)(bat_random *random, size_t count, double *points);
} tension_family;

typedef struct tension_family_list
{
    const tension_family *families;
    size_t count;
} tension_family_list;

/// Curves of any centre and size.
tension_family_list plane_families(bool unseen);
/// Curves of points that have unit length to 1e-12, not yet turned.
tension_family_list sphere_families(bool unseen);
tension_family_list disk_families(bool unseen);

#endif
