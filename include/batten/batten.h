#ifndef BATTEN_H
#define BATTEN_H

/// @file
/// Everything batten offers.

#include "batten/analysis.h"
#include "batten/base.h"
#include "batten/curve.h"
#include "batten/decimate.h"
#include "batten/fairing_train.h"
#include "batten/file.h"
#include "batten/hermite.h"
#include "batten/hermite_study.h"
#include "batten/manifold.h"
#include "batten/measure.h"
#include "batten/mesh.h"
#include "batten/mesh_file.h"
#include "batten/mesh_measure.h"
#include "batten/mesh_model.h"
#include "batten/mesh_picture.h"
#include "batten/mesh_refine.h"
#include "batten/mesh_repair.h"
#include "batten/mesh_shapes.h"
#include "batten/mesh_study.h"
#include "batten/mesh_train.h"
#include "batten/motion.h"
#include "batten/picture.h"
#include "batten/scheme.h"
#include "batten/shapes.h"
#include "batten/space.h"
#include "batten/tension_ablation.h"
#include "batten/tension_data.h"
#include "batten/tension_mechanism.h"
#include "batten/tension_model.h"
#include "batten/tension_noise.h"
#include "batten/tension_table.h"
#include "batten/tension_train.h"

#endif
