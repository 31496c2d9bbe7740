#ifndef CLI_CURVE_H
#define CLI_CURVE_H

#include "arguments.h"

#include "batten/curve_file.h"
#include "batten/curve_picture.h"
#include "batten/curve_scheme.h"
#include "batten/motion.h"

enum
{
    /// Levels that --panel draws side by side at most.
    CURVE_MOST_PANELS = 12,
};

/// What the command line of `batten curve` asks for.
typedef struct curve_job
{
    const char *input;
    const char *output, *picture, *truth; ///< null where not wanted
    bat_curve_read_options read;
    bat_curve_write_options write;
    bat_curve_refine_options refine;
    double fairness;        ///< of the scheme "learned"
    const char *model_file; ///< of the scheme "learned"; null for the network that the library comes with
    bat_curve_model *model; ///< what it holds
    bool hermite;           ///< the scheme takes tangents: `motion` in place of `refine`
    bat_motion_options motion;
    double translation_weight; ///< of the space rigid; 0: as it is
    const char *scheme;        ///< its name; when the user gave none, null until the space is known
    bat_curve_picture_options draw;
    size_t panels[CURVE_MOST_PANELS]; ///< the levels drawn side by side
    size_t panel_count;               ///< 0: one panel, of refine.levels
    char best_name[80];               ///< of the scheme that --best-tension finds
    bool best_tension, json, quiet;
} curve_job;

/// Refine a set by `levels` levels into another that keeps the file's attributes. Returns the program's exit code, as the
/// following do.
int curve_refine(const curve_job *job, const bat_curve_set *coarse, size_t levels, bat_curve_set *fine);

/// The options of Hermite schemes, once the others are read. False after a message.
bool curve_hermite_read(const arguments *given, curve_job *job);
/// curve_refine() by a Hermite scheme.
int curve_hermite_refine(const curve_job *job, const bat_curve_set *keyframes, size_t levels, bat_curve_set *fine);
/// Whether a Hermite scheme is the one to begin with: rotations, motions and tensors that come with times or velocities.
bool curve_hermite_suits(const bat_curve_set *keyframes);
/// Report that refining failed with curve `failed` of a set.
int curve_failure(const curve_job *job, const bat_curve_set *set, size_t failed, const bat_error *error);

/// Draw the picture; `truth` may be null.
int curve_draw(const curve_job *job, const bat_curve_set *coarse, const bat_curve_set *truth, const bat_curve_set *fine);

/// Print what came out; `truth` may be null, else it has as many curves as `fine`.
int curve_report(const curve_job *job, const bat_curve_set *coarse, const bat_curve_set *truth, const bat_curve_set *fine);

#endif
