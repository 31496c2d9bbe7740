#pragma once

#include "verb.h"

#include "batten/curve_file.h"
#include "batten/curve_map.h"
#include "batten/curve_picture.h"
#include "batten/curve_scheme.h"
#include "batten/motion.h"

enum
{
    /// The maximum number of levels that --panel draws side by side.
    CURVE_MAX_PANELS = 12,
    CURVE_MAX_LEVELS = 60,
};

/// The curves of a set in a few numbers.
typedef struct curve_totals
{
    size_t points;  ///< of all
    double length;  ///< of all
    double bending; ///< mean over the curves
    double g1;      ///< greatest of all
} curve_totals;

/// What is reported.
typedef struct curve_findings
{
    size_t curves;                    ///< so many have been measured, in parts
    bat_curve_map_refine_report done; ///< of the refinement
    curve_totals before, after;
    size_t edges, straight; ///< given edges, and those that stayed straight
    bool compared;
    double mean_nn, hausdorff;       ///< when compared with the truth: means over the curves
    bat_curve_projection projection; ///< of the picture, if it shows the sphere
    bat_curve_write_report written;
    bat_motion_report moved; ///< what was done to a motion
} curve_findings;

/// The job of `batten curve` and `batten motion`.
typedef struct curve_job
{
    verb_call call;
    const char *truth; ///< null for none
    bat_curve_read_options read;
    bat_curve_write_options write;
    bat_curve_refine_options refine;
    bat_curve_map_refine_options map; ///< but for `refine`
    const char *unit;                 ///< of lengths: " m" on the sphere, else empty
    double fairness;                  ///< of the scheme "learned"
    const char *model_file;           ///< of the scheme "learned"; null for the network that the library comes with
    bat_curve_model *model;           ///< what it holds
    bool is_motion;                   ///< points with tangents: `motion` in place of `refine`
    bool is_verb;                     ///< the verb is `batten motion`
    const char *hint;                 ///< why `batten curve` treats the file as a motion; null when it does not
    bat_motion_curves_options motion;
    const char *times_file; ///< of a motion; null for none
    double *times;          ///< what it holds
    const char *gyro_file;  ///< of a motion; null for none
    bat_motion_gyro gyro;   ///< what it holds
    const char *scheme;     ///< its name; when the user gave none, null until the space is known
    bat_curve_picture_options draw;
    size_t poses;                    ///< in pictures of motions; 0: by the motion
    char units[2][32];               ///< of lengths and times in pictures of motions; empty: by the file
    size_t panels[CURVE_MAX_PANELS]; ///< the levels drawn side by side
    size_t panel_count;              ///< 0: one panel, of refine.levels
    char best_name[80];              ///< of the scheme that --best-tension finds
    bool best_tension;
    bool is_streamed;                   ///< the curves go through memory part by part
    bat_space space;                    ///< of a streamed job
    bat_curve_set coarse, truths, fine; ///< of a streamed job, `fine` has a number of curves and no curves
    curve_findings findings;
} curve_job;

/// Options of reading, for a bat_curve_read_options: those of all files of curves, and those of poses.
extern const option_spec CURVE_READ_OPTIONS[];

/// Whether edges are refined up to a length or a tolerance, and not by a number of levels.
static inline bool curve_stops(const curve_job *job)
{
    return job->refine.max_edge > 0 || job->refine.tolerance > 0 || job->refine.relative_tolerance > 0;
}

/// Whether a scheme takes its angles from a tension.
static inline bool curve_has_tension(const bat_curve_scheme *scheme)
{
    return scheme->kind == BAT_CURVE_SCHEME_KIND_ANGLE && scheme->rule == NULL;
}

/// Give layers the polygons of a set's curves.
void curve_layers_group(const bat_curve_set *set, bat_curve_picture_layer *layers);

// What the verbs call, see verb_calls.

int curve_make(void *of);
int curve_write(void *of, const char *path);
int curve_report(void *of);
void curve_end(void *of);
