#include "curve.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    /// Of degrees in GeoJSON.
    MAX_DECIMALS = 12,
};

/// The scheme whose angles a network gives.
static const char LEARNED[] = "learned";

static const option_spec CURVE_OPTIONS[] = {
    {"scheme", "NAME", METHOD, COMMON,
     "how to refine, see `batten list schemes`; default: learned on the plane, sphere and disk, in R^n four-point; for "
     "times of rotations, motions and tensors spline, for velocities alone hermite, else log-exp-4",
     NAME(curve_job, scheme, bat_curve_scheme_family)},
    {"levels", "K", METHOD, COMMON,
     "how often; every level doubles the number of edges; default 5, but for geographic files and drawings a stop, so that "
     "pieces are within a fiftieth of the median edge. With a stop: the maximum number of levels of an edge; default 20",
     WHOLE(curve_job, refine.levels, 0, CURVE_MAX_LEVELS)},
    {"max-edge", "L", METHOD, COMMON,
     "a stop, edge by edge: the fewest levels for which no piece is longer than L (metres on the sphere, the Earth's)",
     POSITIVE(curve_job, refine.max_edge)},
    {"tolerance", "E", METHOD, COMMON,
     "a stop, edge by edge: the fewest levels for which the limit curve is within E of the pieces (metres on the sphere)",
     POSITIVE(curve_job, refine.tolerance)},
    {"fairness", "F", METHOD, 0, "learned: from 0, nearest to the data, to 1, smoothest; default 0.25",
     NUMBER(curve_job, fairness)},
    {"model", "FILE", METHOD, IS_READ, "learned: a trained network of your own, a safetensors file",
     TEXT(curve_job, model_file)},
    {"corner-angle", "A", METHOD, 0,
     "keep vertices with an exterior angle above A degrees as corners, and edges between corners straight; auto: right "
     "angles where they are meant, and ends of straight runs, which is the default for geographic files and drawings; "
     "180: none; a CSV column 'corner' (0 or 1) names corners, too",
     NO_FIELD},
    {"smooth", "D", METHOD, 0,
     "smooth the points first; ends and corners stay. Waves of length D keep half of their height (metres on the sphere); "
     "auto: by the noise, which is estimated, and without the stairs of pixels",
     NO_FIELD},
    {"ends", "RULE", METHOD, 0, "how open curves end: {}; default reflect",
     CHOICE(curve_job, refine.ends, bat_curve_end_rule_family)},
    {"simple", "WHICH", METHOD, 0,
     "which curves may not cross themselves: {}; default rings, those that are closed (plane, sphere, disk)",
     CHOICE(curve_job, refine.simple, bat_curve_simple_family)},
    {"topology", "HOW", METHOD, 0,
     "shared: borders that curves share stay shared, and nothing crosses; separate: every curve by itself, and GeoJSON "
     "sequences of any size go through memory part by part; default: features, which is shared where IN has features",
     CHOICE(curve_job, map.topology, bat_curve_map_topology_family)},
    {"edges", "HOW", METHOD, 0,
     "which edges of a map on the sphere are straight in longitude and latitude: {}; default auto, those longer than a "
     "degree along parallels and meridians",
     CHOICE(curve_job, map.edges, bat_curve_map_edges_family)},
    {"join", "HOW", METHOD, 0,
     "whether lines of a map go on smoothly where two ends and no third line meet: {}; default auto, they do",
     CHOICE(curve_job, map.join, bat_curve_map_join_family)},
    {"simplify", "D", METHOD, 0,
     "drop points of a map first, where the edges in their place are within D (metres on the sphere)",
     POSITIVE(curve_job, map.simplify)},
    {"snap-tolerance", "D", METHOD, 0, "join points of a map nearer than D to each other (metres on the sphere)",
     POSITIVE(curve_job, map.snap_tolerance)},
    {"keep-area", NULL, METHOD, 0, "keep the areas of rings", FLAG(curve_job, map.keep_area)},
    {"snap", NULL, METHOD, 0, "move the points of a linear scheme onto its limit curve", FLAG(curve_job, refine.snap)},
    {"best-tension", NULL, METHOD, 0, "angle-based: search the tension that brings the result nearest to the truth",
     FLAG(curve_job, best_tension)},
    {"layer", "NAME", INPUT, 0, "the layer of a GeoPackage or another file with several", TEXT(curve_job, read.layer)},
    {"on", "sphere", INPUT, 0, "refine projected coordinates on the sphere, and write them in their own system", NO_FIELD},
    {"crs", "NAME", RESULT, 0, "the coordinate reference system of plane coordinates in GeoJSON, as EPSG:25833",
     TEXT(curve_job, write.crs)},
    END_OF_OPTIONS,
};

/// Of motions, in place of those of curves.
static const option_spec MOTION_SCHEMES[] = {
    {"scheme", "NAME", METHOD, COMMON,
     "spline, in time (default where IN has times), or a scheme for points with tangents, see `batten list schemes`",
     NAME(curve_job, scheme, bat_motion_scheme_family)},
    {"levels", "K", METHOD, COMMON, "spline: 2^K parts of each interval; other schemes: how often to refine; default 5",
     WHOLE(curve_job, refine.levels, 0, CURVE_MAX_LEVELS)},
    END_OF_OPTIONS,
};

const option_spec CURVE_READ_OPTIONS[] = {
    {"space", "NAME", INPUT, COMMON, "{}, see `batten list spaces`; default: what the file implies",
     NAME(bat_curve_read_options, space, bat_space_family)},
    {"columns", "LIST", INPUT, 0,
     "CSV: the columns of the coordinates, names or numbers from 1, as x,y or lon,lat; default: by names",
     TEXT(bat_curve_read_options, columns)},
    {"group", "COLUMN", INPUT, 0,
     "CSV: rows with one value in this column make one curve; default: blank lines separate curves",
     TEXT(bat_curve_read_options, group)},
    {"closed", NULL, INPUT, COMMON, "take every curve as closed", CONSTANT(bat_curve_read_options, closed, 1)},
    {"open", NULL, INPUT, COMMON, "take every curve as open", CONSTANT(bat_curve_read_options, closed, 0)},
    {"project", NULL, INPUT, 0, "move points that are off their space onto it", FLAG(bat_curve_read_options, project)},
    END_OF_OPTIONS,
};

/// Options of reading and writing that `batten curve` and `batten motion` have.
static const option_spec FILE_OPTIONS[] = {
    {"from", "FORMAT", INPUT, 0, "the format of IN, see `batten list formats`; default: by the file's ending and content",
     CHOICE(curve_job, read.format, bat_curve_format_family)},
    {"strict", NULL, INPUT, 0,
     "refuse repeated points, and of motions repeated times and other columns, instead of dropping them, and curves that "
     "cross themselves",
     FLAG(curve_job, read.strict)},
    {"euler", "ORDER", INPUT, 0, "CSV: the order and unit of roll, pitch and yaw, as zyx,degrees or xyz,radians",
     TEXT(curve_job, read.euler)},
    {"time-unit", "UNIT", INPUT, 0, "of the times of a motion: seconds, milliseconds, ...; default: by names, else by size",
     CHOICE(curve_job, read.time_unit, bat_time_unit_family)},
    {"key-times", "FILE", INPUT, IS_READ, "KITTI: the times of the poses, a number a line; default: 0, 1, 2, ...",
     TEXT(curve_job, read.key_times)},
    {"translation-weight", "W", INPUT, 0, "rigid: how many radians a unit of length counts as much as; default 1",
     POSITIVE(curve_job, read.translation_weight)},
    {"to", "FORMAT", RESULT, 0, "the format of OUT; default: by its ending",
     CHOICE(curve_job, write.format, bat_curve_format_family)},
    {"precision", "N", RESULT, 0, "decimals of degrees in GeoJSON; default 10",
     WHOLE(curve_job, write.precision, 0, MAX_DECIMALS)},
    END_OF_OPTIONS,
};

static const option_spec PICTURE_OPTIONS[] = {
    {"picture", "FILE", PICTURE, COMMON | IS_DRAWN,
     "draw to FILE: .svg, .png or .pdf; of a motion in time its path or poses, and speeds over time, but its shape with "
     "--truth, --panel, --projection, --comb and --axes",
     NO_FIELD},
    {"truth", "FILE", PICTURE, IS_READ, "curves to compare with and to draw, as many as given", TEXT(curve_job, truth)},
    {"panel", "K,K,…", PICTURE, 0, "draw these levels side by side", NO_FIELD},
    {"projection", "NAME", PICTURE, 0, "draw the sphere as {}; default auto, by what the curves cover",
     CHOICE(curve_job, draw.projection, bat_curve_projection_family)},
    {"comb", NULL, PICTURE, 0, "draw the curvature comb", FLAG(curve_job, draw.comb)},
    {"axes", NULL, PICTURE, 0, "draw axes with numbers (flat spaces)", FLAG(curve_job, draw.axes)},
    {"title", "TEXT", PICTURE, 0, "write a title above the picture", TEXT(curve_job, draw.title)},
    END_OF_OPTIONS,
};

/// Of motions, which `batten curve` has, too.
static const option_spec MOTION_OPTIONS[] = {
    {"rate", "R", METHOD, COMMON, "of motions: R points a unit of time, in place of --levels",
     POSITIVE(curve_job, motion.rate)},
    {"times", "FILE", METHOD, COMMON | IS_READ,
     "of motions: the points at these increasing times, a number a line, in place of --levels", TEXT(curve_job, times_file)},
    {"period", "P", METHOD, 0,
     "of closed motions: the time from a point to itself; default: until a last point that repeats the first, else one mean "
     "step more",
     POSITIVE(curve_job, motion.period)},
    {"velocities", NULL, METHOD, 0, "of motions: write velocities even if IN has none", FLAG(curve_job, motion.velocities)},
    {"tangents", "HOW", METHOD, 0,
     "of motions: how velocities are found where IN has none: resting (default), smooth or limited, see docs/motion.md, or "
     "estimates of order 2 or 4",
     NO_FIELD},
    END_OF_OPTIONS,
};

/// Of `batten motion` alone.
static const option_spec MOTION_VERB_OPTIONS[] = {
    {"ends", "RULE", METHOD, COMMON, "spline: {}; default auto; clamped ends are at rest",
     CHOICE(curve_job, motion.spline.ends, bat_motion_ends_family)},
    {"sigma", "S[,T]", METHOD, 0,
     "spline: smooth keyframes with noise S, the root mean square distance from the truth; of poses T in radians; auto "
     "finds "
     "both",
     NO_FIELD},
    {"gyro", "FILE", METHOD, IS_READ,
     "spline: rates of a gyroscope between the keyframes, a table of times and rates about x, y and z (rad/s), then "
     "accelerations",
     TEXT(curve_job, gyro_file)},
    {"uncertainty", NULL, METHOD, 0, "with --sigma or --gyro: write velocities and the standard deviations of the motion",
     FLAG(curve_job, motion.uncertainty)},
    {"outliers", "RULE", METHOD, 0, "with --sigma: {}; default kept; those of huber count less, those of tukey do not count",
     CHOICE(curve_job, motion.spline.outliers, bat_motion_outliers_family)},
    {"max-speed", "V[,W]", METHOD, 0,
     "spline: new times, the fastest ones along the path within a speed of V; of poses W in radians a unit of time; 0: no "
     "limit",
     NO_FIELD},
    {"max-acceleration", "A[,B]", METHOD, 0, "spline: the same within an acceleration; open motions begin and end at rest",
     NO_FIELD},
    {"wrap", "TURN", METHOD, 0, "numbers are angles with this full turn, as 360, and go the shorter way",
     POSITIVE(curve_job, motion.wrap)},
    {"extrapolate", NULL, METHOD, 0, "spline: go on before the first and after the last keyframe, with constant velocity",
     FLAG(curve_job, motion.spline.extrapolate)},
    {"poses", "N", PICTURE, 0, "frames or poses in the picture; default: by the motion", WHOLE(curve_job, poses, 1, 1000)},
    {"units", "L,T", PICTURE, 0, "units of length and time in the picture, as m,s; default: by the file", NO_FIELD},
    END_OF_OPTIONS,
};

static bool read_panels(curve_job *job)
{
    const char *at = argument(job->call.given, "panel");
    while (at != NULL && *at != '\0')
    {
        char *end;
        errno = 0;
        long level = strtol(at, &end, 10);
        if (end == at || (*end != '\0' && *end != ',') || errno != 0 || level < 0 || level > CURVE_MAX_LEVELS ||
            job->panel_count == CURVE_MAX_PANELS)
            return argument_refused(job->call.given, "panel", "up to %d levels from 0 to %d, as in 0,1,2,5",
                                    CURVE_MAX_PANELS, CURVE_MAX_LEVELS);
        job->panels[job->panel_count++] = (size_t)level;
        at = end + (*end == ',');
    }
    return true;
}

/// Options that would have no effect without another.
static bool check_needs(const curve_job *job)
{
    static const char *const OF_PICTURES[] = {"panel", "projection", "comb", "axes", "title", NULL};
    static const char *const OF_OUTPUTS[] = {"to", "precision", "crs", NULL};
    const arguments *given = job->call.given;
    const char *drawn = argument_first(given, OF_PICTURES), *written = argument_first(given, OF_OUTPUTS);
    bool unseen = drawn != NULL && job->call.picture == NULL;
    bool shown = job->call.picture != NULL || job->best_tension || !job->call.quiet;
    const usage_rule rules[] = {
        {unseen, "--%s needs --picture FILE"},
        {written != NULL && job->call.output == NULL, "--%s needs -o OUT"},
        {job->best_tension && job->truth == NULL, "--best-tension needs --truth FILE"},
        {job->truth != NULL && !shown, "--truth needs a report (-o FILE without --quiet), --picture or --best-tension"},
    };
    return usage_obeys(given, rules, sizeof rules / sizeof *rules, unseen ? drawn : written, NULL);
}

static bool check_exclusions(const curve_job *job)
{
    const arguments *given = job->call.given;
    if (argument(given, "closed") != NULL && argument(given, "open") != NULL)
        return usage_refused(given, "--closed and --open exclude each other");
    if (job->map.topology == BAT_CURVE_MAP_TOPOLOGY_SEPARATE &&
        (job->map.keep_area || job->map.snap_tolerance > 0 || job->map.simplify > 0))
        return usage_refused(given, "--topology separate does not go with --keep-area, --simplify and --snap-tolerance");
    if (job->read.on_sphere && strcmp(argument(given, "on"), "sphere") != 0)
        return argument_refused(given, "on", "sphere");
    if (job->best_tension && job->scheme != NULL && (job->model_file != NULL || !curve_has_tension(&job->refine.scheme)))
        return usage_refused(given, "--best-tension goes with angle-based schemes, not '%s'", job->scheme);
    return true;
}

static bool read_scheme(curve_job *job)
{
    const arguments *given = job->call.given;
    if (job->is_motion)
        return true;
    bool learned = job->scheme != NULL && strcmp(job->scheme, LEARNED) == 0;
    bool chooses_network = job->model_file != NULL || argument(given, "fairness") != NULL;
    if (chooses_network && job->scheme != NULL && !learned)
        return usage_refused(given, "--%s goes with --scheme learned, not '%s'",
                             job->model_file != NULL ? "model" : "fairness", job->scheme);
    bat_curve_scheme learned_scheme = bat_curve_scheme_learned(job->fairness);
    if (!usage_accepts(given, bat_curve_scheme_check(&learned_scheme, report_error())))
        return false;
    if (chooses_network || learned)
    {
        job->scheme = LEARNED;
        job->refine.scheme = learned_scheme;
        return true;
    }
    return job->scheme == NULL ||
           usage_accepts(given, bat_curve_scheme_by_name(job->scheme, &job->refine.scheme, report_error()));
}

/// The number of an option, 0 where it is not given, NaN for "auto" and for what is no number.
static double number_or_auto(const arguments *given, const char *name)
{
    const char *text = argument(given, name);
    char *end;
    double number = text != NULL ? strtod(text, &end) : 0;
    return text == NULL || (end != text && *end == '\0') ? number : NAN;
}

static bool is_auto(const arguments *given, const char *name)
{
    const char *text = argument(given, name);
    return text != NULL && strcmp(text, "auto") == 0;
}

/// --corner-angle and --smooth.
static bool read_corners(curve_job *job)
{
    const arguments *given = job->call.given;
    bat_curve_refine_options *refine = &job->refine;
    double angle = number_or_auto(given, "corner-angle"), smooth = refine->smooth = number_or_auto(given, "smooth");
    refine->find_corners = is_auto(given, "corner-angle");
    refine->corner_angle = refine->find_corners ? 0 : angle * DEGREE;
    if (!refine->find_corners && argument(given, "corner-angle") != NULL && !(angle > 0 && angle <= 180))
        return argument_refused(given, "corner-angle", "auto, or above 0 and at most 180");
    return is_auto(given, "smooth") || (smooth >= 0 && isfinite(smooth)) ||
           argument_refused(given, "smooth", "a length from 0 on, or auto");
}

/// Check the corner angle and the stops. With a stop, --levels is the cap.
static bool check_stops(curve_job *job)
{
    const arguments *given = job->call.given;
    bat_curve_refine_options *refine = &job->refine;
    bool stops = curve_stops(job);
    if (!read_corners(job))
        return false;
    if (stops && argument(given, "levels") != NULL)
        refine->max_levels = refine->levels;
    if (!usage_accepts(given, bat_options_check(&bat_curve_refine_fields, refine, report_error())))
        return false;
    if (stops && job->panel_count > 0)
        return usage_refused(given, "--panel draws levels, and does not go with --max-edge and --tolerance");
    if ((stops || refine->corner_angle > 0 || refine->find_corners || refine->smooth != 0) && job->best_tension)
        return usage_refused(given, "--best-tension does not go with --max-edge, --tolerance, --corner-angle and --smooth");
    return true;
}

// Motions

/// Options of `batten curve` that only motions take, and those that they do not take.
static const char *const FOR_MOTIONS[] = {"rate", "times", "period", "velocities", "tangents", NULL};
static const char *const FOR_CURVES[] = {"fairness",     "model",  "snap", "best-tension", "tolerance", "max-edge",
                                         "corner-angle", "smooth", NULL};

/// Those of splines: of `batten motion`, and of `batten curve`.
static const char *const FOR_SPLINES[] = {"times",    "ends",      "extrapolate",      "sigma", "gyro", "uncertainty",
                                          "outliers", "max-speed", "max-acceleration", NULL};
static const char *const FOR_SAMPLES[] = {"times", NULL};

static bool is_motion_scheme(const char *scheme)
{
    static const char *const families[] = {"hermite", "spline"};
    for (size_t i = 0; i < sizeof families / sizeof *families; i++)
    {
        size_t length = strlen(families[i]);
        if (strncmp(scheme, families[i], length) == 0 && strchr(":-", scheme[length]) != NULL)
            return true;
    }
    return false;
}

/// --tangents: a shape of splines, or the order of estimates.
static bool read_tangents(const arguments *given, curve_job *job)
{
    const char *how = argument(given, "tangents");
    bat_motion_curves_options *motion = &job->motion;
    const bat_choice *shape;
    if (how == NULL)
        return true;
    if (bat_choice_find(&bat_motion_shape_family, how, &shape, NULL) == BAT_OK)
    {
        motion->spline.shape = (bat_motion_shape)shape->value;
        return true;
    }
    if (strcmp(how, "2") != 0 && strcmp(how, "4") != 0)
        return argument_refused(given, "tangents", "resting, smooth, limited, 2 or 4");
    motion->tangent_order = (size_t)(how[0] - '0');
    return true;
}

/// One number, or two: of lengths, and of angles of poses.
static bool read_pair(const arguments *given, const char *name, double *of_lengths, double *of_angles)
{
    const char *text = argument(given, name);
    char *end;
    if (text == NULL)
        return true;
    *of_lengths = strtod(text, &end);
    bool good = end != text && *of_lengths >= 0 && isfinite(*of_lengths);
    if (good && *end == ',')
    {
        const char *second = end + 1;
        *of_angles = strtod(second, &end);
        good = end != second && *of_angles >= 0 && isfinite(*of_angles);
    }
    return (good && *end == '\0') || argument_refused(given, name, "a number from 0 on, or two as in 0.01,0.002%s",
                                                      strcmp(name, "sigma") == 0 ? ", or auto" : "");
}

/// --sigma, --max-speed and --max-acceleration.
static bool read_pairs(const arguments *given, curve_job *job)
{
    bat_motion_spline_options *spline = &job->motion.spline;
    bool automatic = is_auto(given, "sigma");
    if (automatic)
        spline->sigma = BAT_MOTION_SIGMA_AUTO;
    return (automatic || read_pair(given, "sigma", &spline->sigma, &spline->angle_sigma)) &&
           read_pair(given, "max-speed", &spline->max_speed, &spline->max_angular_speed) &&
           read_pair(given, "max-acceleration", &spline->max_acceleration, &spline->max_angular_acceleration);
}

static bool read_units(const arguments *given, curve_job *job)
{
    const char *units = argument(given, "units"), *comma = units != NULL ? strchr(units, ',') : NULL;
    if (units == NULL)
        return true;
    if (comma == NULL || strlen(comma + 1) >= sizeof job->units[1] || comma - units >= (ptrdiff_t)sizeof job->units[0])
        return argument_refused(given, "units", "a unit of length and one of time, as in m,s");
    (void)snprintf(job->units[0], sizeof job->units[0], "%.*s", (int)(comma - units), units);
    (void)snprintf(job->units[1], sizeof job->units[1], "%s", comma + 1);
    return true;
}

static bool check_options(const arguments *given, const curve_job *job)
{
    const char *for_motions = argument_first(given, FOR_MOTIONS);
    const char *for_curves = argument_first(given, FOR_CURVES);
    const char *scheme = job->scheme != NULL ? job->scheme : "spline";
    const bat_motion_curves_options *motion = &job->motion;
    bool named = argument(given, "tangents") != NULL && motion->tangent_order == 0; // which only splines have
    const char *for_splines = named ? "tangents" : argument_first(given, job->is_verb ? FOR_SPLINES : FOR_SAMPLES);
    bool sampled = motion->rate > 0 || job->times_file != NULL, hermite = motion->method == BAT_MOTION_METHOD_HERMITE;
    if (for_curves == NULL && !job->is_verb && argument(given, "ends") != NULL)
        for_curves = "ends";
    if (!job->is_motion && for_motions != NULL)
        return usage_refused(given, "--%s goes with --scheme spline or hermite, not '%s'", for_motions, job->scheme);
    if (job->is_motion && for_curves != NULL)
        return usage_refused(given, "--%s does not go with --scheme %s", for_curves, scheme);
    if (motion->rate > 0 && job->times_file != NULL)
        return usage_refused(given, "--rate and --times exclude each other");
    if (sampled && (argument(given, "levels") != NULL || argument(given, "panel") != NULL))
        return usage_refused(given, "--%s and --levels exclude each other", motion->rate > 0 ? "rate" : "times");
    if (hermite && for_splines != NULL)
        return usage_refused(given, "--%s%s goes with --scheme spline, not '%s'", for_splines,
                             strcmp(for_splines, "tangents") == 0 ? " by name" : "", scheme);
    if (motion->rate > 0 && hermite && motion->scheme.order != 1)
        return usage_refused(given, "--rate goes with --scheme spline or hermite, not '%s'", scheme);
    return true;
}

/// Read the options of motions, once the others are read. False after a message.
static bool read_motion(curve_job *job)
{
    const arguments *given = job->call.given;
    job->motion.scheme.threads = job->motion.spline.threads = job->refine.threads;
    if (job->scheme != NULL)
        job->is_motion = is_motion_scheme(job->scheme);
    else if (argument_first(given, FOR_MOTIONS) != NULL)
        job->is_motion = true;
    if (job->is_verb && !job->is_motion)
        return usage_refused(given, "'%s' is no scheme for points with tangents; `batten list schemes` names them",
                             job->scheme);
    if (job->is_motion && job->scheme != NULL &&
        !usage_accepts(given, bat_motion_scheme_by_name(job->scheme, &job->motion, report_error())))
        return false;
    if (job->is_motion && !job->is_verb)
        job->hint = "is treated as a motion";
    return read_tangents(given, job) && read_pairs(given, job) && read_units(given, job) &&
           usage_accepts(given, bat_options_check(&bat_motion_curves_fields, &job->motion, report_error())) &&
           check_options(given, job);
}

// The verbs

/// Whether the file is a sequence that can go through memory part by part: nothing else needs it as a whole.
static bool is_streamed(const curve_job *job)
{
    bat_curve_format from = job->read.format;
    const bat_choice *row = NULL;
    (void)bat_choice_of_path(&bat_curve_format_family, job->call.input, false, &row, NULL);
    if (from == BAT_CURVE_FORMAT_AUTO && row != NULL)
        from = (bat_curve_format)row->value;
    return job->map.topology == BAT_CURVE_MAP_TOPOLOGY_SEPARATE && !job->is_motion && job->call.output != NULL &&
           job->call.picture == NULL && job->truth == NULL &&
           (from == BAT_CURVE_FORMAT_GEOJSON_LINES || from == BAT_CURVE_FORMAT_GEOJSON_SEQUENCE);
}

static void begin(void *to)
{
    curve_job *job = to;
    job->read = bat_curve_read_defaults();
    job->write = bat_curve_write_defaults();
    job->refine = bat_curve_refine_defaults();
    job->map = bat_curve_map_refine_defaults();
    job->motion = bat_motion_curves_defaults();
    job->draw = bat_curve_picture_defaults();
    job->fairness = 0.25;
}

static void begin_motion(void *to)
{
    curve_job *job = to;
    begin(job);
    job->is_verb = job->is_motion = true;
    job->read.motion = true;
}

static bool check(void *of)
{
    curve_job *job = of;
    const arguments *given = job->call.given;
    const bat_choice *format;
    job->refine.threads = job->read.threads = job->write.threads = job->call.threads;
    job->read.on_sphere = argument(given, "on") != NULL;
    if (job->call.output != NULL && job->write.format == BAT_CURVE_FORMAT_AUTO &&
        !usage_accepts(given, bat_choice_of_path(&bat_curve_format_family, job->call.output, true, &format, report_error())))
        return false;
    if (!read_panels(job) || !check_stops(job) || !read_motion(job) || !read_scheme(job) || !check_exclusions(job) ||
        !check_needs(job))
        return false;
    job->is_streamed = is_streamed(job);
    return true;
}

const verb VERB_CURVE = {
    .name = "curve",
    .arguments = "IN... [-o OUT] [--scheme NAME] [--levels K] [--picture FILE] [options]",
    .summary = "refine the curves of a file, to a file and a picture",
    .about =
        "Refine the curves of a file (see `batten list formats`; - for standard input). Without -o, --picture and --json "
        "the result goes to standard output in the format of the input.",
    .example = "batten curve coast.geojson --tolerance 500 -o smooth.geojson --picture smooth.svg",
    .options = {{CURVE_OPTIONS, 0},
                {CURVE_READ_OPTIONS, offsetof(curve_job, read)},
                {FILE_OPTIONS, 0},
                {MOTION_OPTIONS, 0},
                {PICTURE_OPTIONS, 0}},
    .prints_result = true,
    .formats = &bat_curve_format_family,
    .job_size = sizeof(curve_job),
    .calls = {begin, check, curve_make, curve_write, curve_report, curve_end},
};

const verb VERB_MOTION = {
    .name = "motion",
    .arguments = "IN... [-o OUT] [--rate R|--times FILE|--levels K] [--picture FILE] [options]",
    .summary = "make a smooth motion of keyframes: points, rotations, poses or tensors in time",
    .about =
        "Make a smooth motion through the keyframes of a file (CSV, TUM; - for standard input): points, rotations, poses "
        "or tensors, with times and velocities where the file has them. docs/motion.md explains the schemes and "
        "docs/formats.md the columns. Without -o, --picture and --json the result goes to standard output in the format "
        "of the input.",
    .example = "batten motion keyframes.tum --rate 30 -o frames.tum --picture frames.svg",
    .options = {{MOTION_OPTIONS, 0},
                {MOTION_SCHEMES, 0},
                {MOTION_VERB_OPTIONS, 0},
                {CURVE_READ_OPTIONS, offsetof(curve_job, read)},
                {FILE_OPTIONS, 0},
                {PICTURE_OPTIONS, 0}},
    .prints_result = true,
    .formats = &bat_curve_format_family,
    .job_size = sizeof(curve_job),
    .calls = {begin_motion, check, curve_make, curve_write, curve_report, curve_end},
};
