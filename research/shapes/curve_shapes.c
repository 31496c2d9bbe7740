/// @file
/// Control polygons of everyday objects (bat_curve_shape_at), as tables of coordinates.

#include "batten/research/curve_shapes.h"

#include "base/error.h"
#include "base/memory.h"
#include "space/builtin.h"

#include <string.h>

#define POINTS(array) .points = (array), .count = sizeof(array) / sizeof((array)[0])
#define OUTLINES(array) .outlines = (array), .outline_count = sizeof(array) / sizeof((array)[0])

static const double JAR_BODY[][2] = {
    {0.24, 0},     {0.44, 0},     {0.47, 0.09},  {0.36, 0.17},  {0.45, 0.34},  {0.74, 0.64}, {0.88, 1.04},  {0.79, 1.42},
    {0.5, 1.68},   {0.29, 1.82},  {0.25, 1.99},  {0.31, 2.13},  {0.46, 2.18},  {0.48, 2.28}, {0.26, 2.31},  {-0.26, 2.31},
    {-0.48, 2.28}, {-0.46, 2.18}, {-0.31, 2.13}, {-0.25, 1.99}, {-0.29, 1.82}, {-0.5, 1.68}, {-0.79, 1.42}, {-0.88, 1.04},
    {-0.74, 0.64}, {-0.45, 0.34}, {-0.36, 0.17}, {-0.47, 0.09}, {-0.44, 0},    {-0.24, 0},
};
static const double JAR_BAND[][2] = {
    {-0.74, 0.975}, {-0.592, 1.145}, {-0.444, 0.975}, {-0.296, 1.145}, {-0.148, 0.975}, {0, 1.145},
    {0.148, 0.975}, {0.296, 1.145},  {0.444, 0.975},  {0.592, 1.145},  {0.74, 0.975},
};
static const bat_shape_outline JAR_OUTLINES[] = {
    {POINTS(JAR_BODY), .closed = true},
    {POINTS(JAR_BAND), .closed = false},
};

static const double MANGO_FRUIT[][2] = {
    {0.4, 1.36},   {0.24, 1.43},  {-0.06, 1.5},  {-0.36, 1.46},  {-0.68, 1.28}, {-0.91, 0.99},
    {-1, 0.65},    {-0.95, 0.33}, {-0.78, 0.04}, {-0.55, -0.18}, {-0.3, -0.32}, {-0.08, -0.32},
    {0.06, -0.18}, {0.09, 0.04},  {0.18, 0.3},   {0.36, 0.56},   {0.48, 0.86},  {0.5, 1.12},
};
static const double MANGO_STEM[][2] = {
    {0.32, 1.395},
    {0.33, 1.53},
    {0.39, 1.67},
    {0.5, 1.8},
};
static const double MANGO_LEAF[][2] = {
    {0.26, 1.62},  {0.2, 1.8},    {0, 1.94},     {-0.28, 2},    {-0.56, 1.95}, {-0.8, 1.83},
    {-0.86, 1.77}, {-0.76, 1.73}, {-0.48, 1.64}, {-0.18, 1.55}, {0.1, 1.54},
};
static const double MANGO_RIB[][2] = {
    {0.36, 1.6}, {0.2, 1.67}, {-0.06, 1.76}, {-0.34, 1.79}, {-0.58, 1.785},
};
static const bat_shape_outline MANGO_OUTLINES[] = {
    {POINTS(MANGO_FRUIT), .closed = true},
    {POINTS(MANGO_STEM), .closed = false},
    {POINTS(MANGO_LEAF), .closed = true},
    {POINTS(MANGO_RIB), .closed = false},
};

static const double PI_LETTER[][2] = {
    {1.02, 1.5},   {0.55, 1.5},    {0.05, 1.5},    {-0.42, 1.49},  {-0.76, 1.38}, {-0.98, 1.1},  {-0.94, 0.97},
    {-0.82, 0.98}, {-0.7, 1.13},   {-0.56, 1.2},   {-0.45, 1.17},  {-0.39, 1.04}, {-0.4, 0.78},  {-0.48, 0.44},
    {-0.64, 0.12}, {-0.66, -0.03}, {-0.54, -0.11}, {-0.41, -0.03}, {-0.29, 0.3},  {-0.22, 0.72}, {-0.2, 1.06},
    {-0.12, 1.2},  {0.08, 1.21},   {0.24, 1.2},    {0.29, 1.04},   {0.27, 0.7},   {0.27, 0.34},  {0.34, 0.06},
    {0.49, -0.08}, {0.69, -0.08},  {0.88, 0.06},   {0.97, 0.25},   {0.9, 0.33},   {0.82, 0.25},  {0.71, 0.14},
    {0.6, 0.15},   {0.54, 0.28},   {0.52, 0.54},   {0.53, 0.86},   {0.56, 1.09},  {0.66, 1.2},   {0.86, 1.21},
    {1.03, 1.21},  {1.12, 1.28},   {1.13, 1.42},
};
static const bat_shape_outline PI_OUTLINES[] = {
    {POINTS(PI_LETTER), .closed = true},
};

static const double CAR_BODY[][2] = {
    {-1.56, -0.03}, {-1.36, -0.06}, {-1.32, 0.12}, {-1.21, 0.33}, {-0.95, 0.42}, {-0.69, 0.33}, {-0.58, 0.12},
    {-0.54, -0.06}, {0, -0.08},     {0.54, -0.06}, {0.58, 0.12},  {0.69, 0.33},  {0.95, 0.42},  {1.21, 0.33},
    {1.32, 0.12},   {1.36, -0.06},  {1.6, -0.04},  {1.7, 0.08},   {1.68, 0.3},   {1.54, 0.48},  {1.18, 0.57},
    {0.72, 0.65},   {0.36, 0.98},   {0.1, 1.13},   {-0.36, 1.16}, {-0.8, 1.05},  {-1.14, 0.76}, {-1.5, 0.68},
    {-1.66, 0.58},  {-1.68, 0.3},   {-1.66, 0.06},
};
static const double CAR_FRONT_WINDOW[][2] = {
    {-0.08, 0.69}, {0.28, 0.68}, {0.54, 0.68}, {0.28, 0.93}, {0.08, 1.03}, {-0.08, 1.05},
};
static const double CAR_REAR_WINDOW[][2] = {
    {-0.19, 0.69}, {-0.19, 1.05}, {-0.42, 1.05}, {-0.72, 0.96}, {-1.02, 0.7}, {-0.6, 0.69},
};
static const double CAR_REAR_WHEEL[][2] = {
    {-0.682, 0.111},  {-0.839, 0.268},  {-1.061, 0.268},  {-1.218, 0.111},
    {-1.218, -0.111}, {-1.061, -0.268}, {-0.839, -0.268}, {-0.682, -0.111},
};
static const double CAR_FRONT_WHEEL[][2] = {
    {1.218, 0.111},  {1.061, 0.268},  {0.839, 0.268},  {0.682, 0.111},
    {0.682, -0.111}, {0.839, -0.268}, {1.061, -0.268}, {1.218, -0.111},
};
static const bat_shape_outline CAR_OUTLINES[] = {
    {POINTS(CAR_BODY), .closed = true},        {POINTS(CAR_FRONT_WINDOW), .closed = true},
    {POINTS(CAR_REAR_WINDOW), .closed = true}, {POINTS(CAR_REAR_WHEEL), .closed = true},
    {POINTS(CAR_FRONT_WHEEL), .closed = true},
};

static const double RABBIT_BODY[][2] = {
    {-0.6, 0},     {-0.2, -0.02}, {0.2, -0.02},  {0.33, 0.04}, {0.3, 0.14},   {0.4, 0.24},  {0.46, 0.1},   {0.52, -0.02},
    {0.76, -0.02}, {0.86, 0.05},  {0.79, 0.15},  {0.66, 0.22}, {0.62, 0.44},  {0.66, 0.7},  {0.68, 0.92},  {0.86, 0.97},
    {1.03, 1.04},  {1.1, 1.16},   {1.02, 1.28},  {0.92, 1.42}, {0.76, 1.54},  {0.78, 1.78}, {0.76, 2.06},  {0.67, 2.25},
    {0.56, 2.25},  {0.5, 2.06},   {0.51, 1.8},   {0.5, 1.58},  {0.4, 1.8},    {0.26, 2.02}, {0.1, 2.12},   {0.03, 2.04},
    {0.12, 1.82},  {0.26, 1.6},   {0.34, 1.4},   {0.32, 1.2},  {0.14, 1.08},  {-0.2, 1.02}, {-0.54, 0.84}, {-0.76, 0.56},
    {-0.83, 0.4},  {-0.94, 0.5},  {-1.09, 0.46}, {-1.15, 0.3}, {-1.06, 0.15}, {-0.9, 0.1},  {-0.78, 0.04},
};
static const double RABBIT_HAUNCH[][2] = {
    {0.22, 0.18}, {0.28, 0.42}, {0.14, 0.66}, {-0.14, 0.71}, {-0.36, 0.56},
};
static const double RABBIT_EYE[][2] = {
    {0.882, 1.27}, {0.82, 1.315}, {0.758, 1.27}, {0.782, 1.197}, {0.858, 1.197},
};
static const bat_shape_outline RABBIT_OUTLINES[] = {
    {POINTS(RABBIT_BODY), .closed = true},
    {POINTS(RABBIT_HAUNCH), .closed = false},
    {POINTS(RABBIT_EYE), .closed = true},
};

static const double HAND_OUTLINE[][2] = {
    {-0.34, -0.92},  {0.3, -0.92},    {0.34, -0.62},   {0.44, -0.3},     {0.5, 0.02},     {0.535, 0.234},  {0.674, 0.496},
    {0.77, 0.707},   {0.772, 0.78},   {0.687, 0.825},  {0.628, 0.782},   {0.507, 0.585},  {0.367, 0.323},  {0.315, 0.34},
    {0.319, 0.462},  {0.391, 0.833},  {0.433, 1.125},  {0.413, 1.214},   {0.307, 1.235},  {0.256, 1.159},  {0.185, 0.874},
    {0.113, 0.502},  {0.03, 0.547},   {0.008, 0.961},  {-0.023, 1.282},  {-0.064, 1.372}, {-0.172, 1.366}, {-0.203, 1.272},
    {-0.201, 0.95},  {-0.18, 0.536},  {-0.254, 0.489}, {-0.361, 0.842},  {-0.46, 1.112},  {-0.518, 1.18},  {-0.621, 1.148},
    {-0.632, 1.059}, {-0.562, 0.781}, {-0.454, 0.428}, {-0.47, 0.2},     {-0.52, 0.04},   {-0.684, 0.146}, {-0.88, 0.269},
    {-0.955, 0.28},  {-1.02, 0.194},  {-0.989, 0.126}, {-0.816, -0.029}, {-0.52, -0.34},  {-0.4, -0.62},
};
static const bat_shape_outline HAND_OUTLINES[] = {
    {POINTS(HAND_OUTLINE), .closed = true},
};

static const double U_LETTER[][2] = {
    {0.22, -0.59},   {0.41, -0.5},   {0.56, -0.35},  {0.66, -0.16},  {0.7, 0.06},    {0.71, 0.3},    {0.71, 0.55},
    {0.71, 0.8},     {0.71, 1.02},   {0.68, 1.15},   {0.575, 1.19},  {0.42, 1.19},   {0.315, 1.15},  {0.285, 1.02},
    {0.285, 0.8},    {0.285, 0.55},  {0.285, 0.3},   {0.275, 0.08},  {0.22, -0.09},  {0.125, -0.19}, {0, -0.22},
    {-0.125, -0.19}, {-0.22, -0.09}, {-0.275, 0.08}, {-0.285, 0.3},  {-0.285, 0.55}, {-0.285, 0.8},  {-0.285, 1.02},
    {-0.315, 1.15},  {-0.42, 1.19},  {-0.575, 1.19}, {-0.68, 1.15},  {-0.71, 1.02},  {-0.71, 0.8},   {-0.71, 0.55},
    {-0.71, 0.3},    {-0.7, 0.06},   {-0.66, -0.16}, {-0.56, -0.35}, {-0.41, -0.5},  {-0.22, -0.59}, {0, -0.62},
};
static const bat_shape_outline U_OUTLINES[] = {
    {POINTS(U_LETTER), .closed = true},
};

static const double MUG_BODY[][2] = {
    {-0.38, 0},     {-0.19, -0.02}, {0, -0.025},    {0.19, -0.02},  {0.38, 0},      {0.49, 0.06},  {0.535, 0.17},
    {0.56, 0.27},   {0.62, 0.33},   {0.73, 0.34},   {0.86, 0.4},    {0.97, 0.53},   {1.02, 0.7},   {0.98, 0.87},
    {0.87, 1},      {0.74, 1.06},   {0.63, 1.08},   {0.58, 1.15},   {0.58, 1.26},   {0.555, 1.36}, {0.46, 1.4},
    {0.31, 1.4},    {0.155, 1.4},   {0, 1.4},       {-0.155, 1.4},  {-0.31, 1.4},   {-0.46, 1.4},  {-0.555, 1.36},
    {-0.58, 1.26},  {-0.578, 1.1},  {-0.573, 0.93}, {-0.566, 0.76}, {-0.558, 0.59}, {-0.55, 0.43}, {-0.543, 0.29},
    {-0.535, 0.17}, {-0.49, 0.06},
};
static const double MUG_HANDLE[][2] = {
    {0.635, 0.58}, {0.66, 0.49}, {0.74, 0.475}, {0.82, 0.53},  {0.875, 0.62}, {0.89, 0.72},
    {0.85, 0.83},  {0.77, 0.91}, {0.68, 0.93},  {0.635, 0.85}, {0.625, 0.71},
};
static const double MUG_LEFT_STEAM[][2] = {
    {-0.22, 1.56}, {-0.285, 1.655}, {-0.285, 1.75}, {-0.22, 1.845}, {-0.155, 1.94}, {-0.155, 2.035}, {-0.22, 2.13},
};
static const double MUG_RIGHT_STEAM[][2] = {
    {0.18, 1.56}, {0.115, 1.655}, {0.115, 1.75}, {0.18, 1.845}, {0.245, 1.94}, {0.245, 2.035}, {0.18, 2.13},
};
static const bat_shape_outline MUG_OUTLINES[] = {
    {POINTS(MUG_BODY), .closed = true},
    {POINTS(MUG_HANDLE), .closed = true},
    {POINTS(MUG_LEFT_STEAM), .closed = false},
    {POINTS(MUG_RIGHT_STEAM), .closed = false},
};

/// Corner cutting has two free ratios, which the study does not print. These cut deeper than Chaikin's 1/4 and 3/4; they are
/// symmetric, so that open curves reach their ends.
#define CORNER_CUTTING "corner-cutting:r=0.3,s=0.7"

static const bat_curve_shape SHAPES[] = {
    {"jar", "a vase with a wavy band", OUTLINES(JAR_OUTLINES), .figures = {{"3.2", "chaikin"}}, .figure_count = 1},
    {"mango", "a fruit with its stem and a leaf", OUTLINES(MANGO_OUTLINES), .figures = {{"3.3", "chaikin"}},
     .figure_count = 1},
    {"pi", "the Greek letter", OUTLINES(PI_OUTLINES),
     .figures = {{"3.4", "chaikin"}, {"4.4", CORNER_CUTTING}, {"5.4", "four-point"}}, .figure_count = 3},
    {"car", "a saloon from the side", OUTLINES(CAR_OUTLINES), .figures = {{"3.5", "chaikin"}}, .figure_count = 1},
    {"rabbit", "sitting, from the side", OUTLINES(RABBIT_OUTLINES), .figures = {{"4.2", CORNER_CUTTING}}, .figure_count = 1},
    {"hand", "five fingers spread", OUTLINES(HAND_OUTLINES), .figures = {{"4.3", CORNER_CUTTING}}, .figure_count = 1},
    {"U", "the capital letter", OUTLINES(U_OUTLINES), .figures = {{"5.2", "four-point"}}, .figure_count = 1},
    {"mug", "with its handle, steaming", OUTLINES(MUG_OUTLINES), .figures = {{"5.3", "four-point"}}, .figure_count = 1},
};

enum
{
    SHAPE_COUNT = sizeof SHAPES / sizeof SHAPES[0]
};

size_t bat_curve_shape_count(void)
{
    return SHAPE_COUNT;
}

const bat_curve_shape *bat_curve_shape_at(size_t index)
{
    return index < SHAPE_COUNT ? &SHAPES[index] : NULL;
}

bat_status bat_curve_shape_curve(const bat_curve_shape *shape, size_t outline, const bat_space *plane, bat_curve *curve,
                                 bat_error *error)
{
    if (outline >= shape->outline_count)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the %s has %zu outlines, not %zu", shape->name,
                         shape->outline_count, outline + 1);
    if (!space_is_plane(plane))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the outlines lie in the plane, not in the space %s",
                         plane->name);
    const bat_shape_outline *from = &shape->outlines[outline];
    double *points = memory_array(from->count, sizeof from->points[0]);
    if (points == NULL)
        return error_memory(error, from->count * sizeof from->points[0]);
    memcpy(points, from->points, from->count * sizeof from->points[0]);
    *curve = (bat_curve){.space = plane, .points = points, .count = from->count, .closed = from->closed};
    return BAT_OK;
}
