#ifndef BATTEN_H
#define BATTEN_H

/// @file
/// Everything that the library batten offers. The library batten-research has headers of its own below batten/research.

// Foundations
#include "batten/base.h"
#include "batten/space.h"

// Curves
#include "batten/curve.h"
#include "batten/curve_analysis.h"
#include "batten/curve_file.h"
#include "batten/curve_measure.h"
#include "batten/curve_picture.h"
#include "batten/curve_scheme.h"

// Motions
#include "batten/motion.h"
#include "batten/motion_hermite.h"

// Meshes
#include "batten/mesh.h"
#include "batten/mesh_decimate.h"
#include "batten/mesh_file.h"
#include "batten/mesh_measure.h"
#include "batten/mesh_picture.h"
#include "batten/mesh_refine.h"

// Scans and spline surfaces
#include "batten/cloud.h"
#include "batten/cloud_file.h"
#include "batten/cloud_parameterize.h"
#include "batten/spline.h"
#include "batten/spline_hierarchical.h"
#include "batten/surface.h"
#include "batten/surface_file.h"
#include "batten/surface_fit.h"
#include "batten/surface_picture.h"

#endif
