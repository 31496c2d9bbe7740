#ifndef BATTEN_H
#define BATTEN_H

/// @file
/// Everything that the library batten offers, but for parts that were left out when it was built (see batten/config.h). The
/// library batten-research has headers of its own below batten/research.

#include "batten/config.h"

// Foundations
#include "batten/base.h"
#include "batten/space.h"

// Curves
#include "batten/curve.h"
#include "batten/curve_map.h"
#include "batten/curve_measure.h"
#include "batten/curve_scheme.h"
#include "batten/curve_set.h"

// Motions
#include "batten/motion.h"
#include "batten/motion_hermite.h"
#include "batten/motion_spline.h"

// Meshes
#include "batten/mesh.h"
#include "batten/mesh_decimate.h"
#include "batten/mesh_measure.h"
#include "batten/mesh_refine.h"
#include "batten/mesh_transfer.h"

// Scans and spline surfaces
#if BAT_HAS_SURFACES
#include "batten/cloud.h"
#include "batten/cloud_parameterize.h"
#include "batten/shell.h"
#include "batten/spline.h"
#include "batten/surface.h"
#include "batten/surface_fit.h"
#endif

// Files
#if BAT_HAS_FILES
#include "batten/curve_file.h"
#include "batten/mesh_file.h"
#if BAT_HAS_SURFACES
#include "batten/cloud_file.h"
#include "batten/surface_file.h"
#endif
#endif

// Pictures
#if BAT_HAS_PICTURES
#include "batten/curve_picture.h"
#include "batten/mesh_picture.h"
#if BAT_HAS_SURFACES
#include "batten/surface_picture.h"
#endif
#endif

#endif
