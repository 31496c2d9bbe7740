#ifndef RESEARCH_STUDIES_CHART_LABELS_H
#define RESEARCH_STUDIES_CHART_LABELS_H

#include "research/analysis/chart.h"

/// Draw texts beside the points of a series, where they cover least.
/// @param texts one for each point; null for none
/// @return BAT_OK or BAT_NO_MEMORY
bat_status chart_labels_draw(cairo_t *cairo, const plot_axes *axes, const bat_chart_series *series, const char *const *texts,
                             bat_error *error);

#endif
