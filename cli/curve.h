#ifndef CLI_CURVE_H
#define CLI_CURVE_H

#include "batten/file.h"
#include "batten/picture.h"
#include "batten/tension_model.h"

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
    bat_read_options read;
    bat_write_options write;
    bat_refine_options refine;
    double fairness;          ///< of the scheme "learned"
    const char *model_file;   ///< of the scheme "learned"; null for the network that the library comes with
    bat_tension_model *model; ///< what it holds
    const char *scheme;       ///< its name; when the user gave none, null until the space is known
    bat_picture_options draw;
    size_t panels[CURVE_MOST_PANELS]; ///< the levels drawn side by side
    size_t panel_count;               ///< 0: one panel, of refine.levels
    char best_name[80];               ///< of the scheme that --best-tension finds
    bool best_tension, json, quiet;
} curve_job;

/// Refine a set by `levels` levels into another that keeps the file's attributes. Returns the program's exit code, as the
/// following do.
int curve_refine(const curve_job *job, const bat_curve_set *coarse, size_t levels, bat_curve_set *fine);

/// Draw the picture; `truth` may be null.
int curve_draw(const curve_job *job, const bat_curve_set *coarse, const bat_curve_set *truth, const bat_curve_set *fine);

/// Print what came out; `truth` may be null, else it has as many curves as `fine`.
int curve_report(const curve_job *job, const bat_curve_set *coarse, const bat_curve_set *truth, const bat_curve_set *fine);

#endif
