#ifndef TESTS_SUPPORT_MESH_HELPERS_H
#define TESTS_SUPPORT_MESH_HELPERS_H

#include "check.h"
#include "mesh_makers.h"

#endif
