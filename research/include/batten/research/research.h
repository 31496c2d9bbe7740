#ifndef BATTEN_RESEARCH_RESEARCH_H
#define BATTEN_RESEARCH_RESEARCH_H

/// @file
/// Everything that the library batten-research offers.

#include "batten/research/chart_picture.h"
#include "batten/research/curve_analysis.h"
#include "batten/research/curve_data.h"
#include "batten/research/curve_shapes.h"
#include "batten/research/curve_study.h"
#include "batten/research/curve_train.h"
#include "batten/research/distributed.h"
#include "batten/research/harm_study.h"
#include "batten/research/map_shapes.h"
#include "batten/research/mask_sweep.h"
#include "batten/research/mesh_shapes.h"
#include "batten/research/mesh_study.h"
#include "batten/research/mesh_train.h"
#include "batten/research/motion_study.h"
#include "batten/research/networks.h"
#include "batten/research/surface_chart.h"
#include "batten/research/surface_shapes.h"
#include "batten/research/surface_study.h"
#include "batten/research/surface_train.h"
#include "batten/research/train.h"

#endif
