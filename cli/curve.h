#ifndef CLI_CURVE_H
#define CLI_CURVE_H

#include "outputs.h"

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

/// The command line of `batten curve` or `batten motion`.
typedef struct curve_job
{
    const arguments *given;
    const char *input;
    const char *output, *picture, *truth; ///< null where not wanted
    outputs files;
    bat_curve_read_options read;
    bat_curve_write_options write;
    bat_curve_refine_options refine;
    bat_curve_map_options map; ///< but for `refine`
    const char *unit;          ///< of lengths: " m" on the sphere, else empty
    double fairness;           ///< of the scheme "learned"
    const char *model_file;    ///< of the scheme "learned"; null for the network that the library comes with
    bat_curve_model *model;    ///< what it holds
    bool is_motion;            ///< points with tangents: `motion` in place of `refine`
    bool is_verb;              ///< the verb is `batten motion`
    const char *hint;          ///< why `batten curve` treats the file as a motion; null when it does not
    bat_motion_options motion;
    const char *times_file; ///< of a motion; null for none
    double *times;          ///< what it holds
    const char *scheme;     ///< its name; when the user gave none, null until the space is known
    bat_curve_picture_options draw;
    bat_motion_report *moved;        ///< receives what was done to a motion; null for none
    char units[2][32];               ///< of lengths and times in pictures of motions; empty: by the file
    size_t panels[CURVE_MAX_PANELS]; ///< the levels drawn side by side
    size_t panel_count;              ///< 0: one panel, of refine.levels
    char best_name[80];              ///< of the scheme that --best-tension finds
    bool best_tension, json, quiet;
} curve_job;

/// Refine a set by `levels` levels, or up to the stops of the job, into another that keeps the file's attributes. `report`
/// receives what was done, zeros for motions; it may be null. Returns the program's exit code, as the following do.
int curve_refine(const curve_job *job, const bat_curve_set *coarse, size_t levels, bat_curve_set *fine,
                 bat_curve_map_report *report);
/// Whether edges are refined up to a length or a tolerance, and not by a number of levels.
bool curve_stops(const curve_job *job);

/// Read the options that both verbs have, and run the job. Returns the program's exit code.
int curve_run(const arguments *given, curve_job *job);

/// Read the options of motions, once the others are read. False after a message.
bool motion_read(const arguments *given, curve_job *job);
/// The name of the scheme that a motion gets when the user names none.
const char *motion_scheme(const curve_job *job, const bat_curve_set *keyframes);
/// Read the file of times. Returns the program's exit code, after a message where it is not EXIT_DONE.
int motion_read_times(curve_job *job, const bat_curve_set *keyframes);
/// Draw the picture of a motion in time. Returns the program's exit code.
int motion_draw(const curve_job *job, const bat_curve_set *keyframes);
/// Whether the picture is that of a motion in time, and not of its shape.
bool motion_is_drawn(const curve_job *job);
/// curve_refine() of a motion.
int motion_refine(const curve_job *job, const bat_curve_set *keyframes, size_t levels, bat_curve_set *fine);
/// Report that refining failed with curve `failed` of a set.
int curve_failure(const curve_job *job, const bat_curve_set *set, size_t failed, const bat_error *error);

/// Draw the picture to job->files; `truth` may be null. `projection` receives that of the sphere, else
/// BAT_CURVE_PROJECTION_AUTO.
int curve_draw(const curve_job *job, const bat_curve_set *coarse, const bat_curve_set *truth, const bat_curve_set *fine,
               bat_curve_projection *projection);

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
    size_t curves;             ///< so many have been measured, in parts
    bat_curve_map_report done; ///< of curve_refine()
    curve_totals before, after;
    bool compared;
    double mean_nn, hausdorff;       ///< when compared with the truth: means over the curves
    bat_curve_projection projection; ///< of the picture, if it shows the sphere
    bat_curve_write_report written;
} curve_findings;

/// Measure the result, all but findings->done; `truth` may be null, else it has as many curves as `fine`.
int curve_measure(const curve_job *job, const bat_curve_set *coarse, const bat_curve_set *truth, const bat_curve_set *fine,
                  curve_findings *findings);
/// curve_measure() of a part of the curves, after others; `findings` is all zero before the first part.
int curve_measure_part(const curve_job *job, const bat_curve_set *coarse, const bat_curve_set *fine,
                       curve_findings *findings);
/// Print the report.
int curve_report(const curve_job *job, const bat_curve_set *fine, const curve_findings *findings);

#endif
