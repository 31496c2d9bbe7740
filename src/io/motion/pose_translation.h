#ifndef IO_MOTION_POSE_TRANSLATION_H
#define IO_MOTION_POSE_TRANSLATION_H

#include "base/error.h"
#include "base/text_buffer.h"
#include "batten/curve_file.h"
#include "io/common/file_text.h"
#include "io/motion/pose_names.h"
#include "io/motion/pose_times.h"

/// @file
/// The translation of a text of poses, line by line, and its parts: rows without names, matrices, tables with names.

enum
{
    POSE_NOTES = 6,
    POSE_NOTE_SIZE = 240,
    TUM_NUMBERS = 8,
    KITTI_NUMBERS = 12,
    EUROC_NUMBERS = 17
};

/// Matrices in files: the largest distance of an entry from the nearest rotation.
#define POSE_MATRIX_TOLERANCE 1e-3

/// The work on a text.
typedef struct pose_translation
{
    const file_text *source;
    const bat_curve_read_options *options;
    text_buffer text;
    bat_curve_format reader; ///< of the translated text; BAT_CURVE_FORMAT_AUTO where the text is none of poses
    bat_curve_format format; ///< that the set is of
    bool as_it_is;           ///< the source needs no translation
    char notes[POSE_NOTES][POSE_NOTE_SIZE];
    size_t note_count;
    pose_clock clock;
    // Of tables:
    size_t columns[ROLES]; ///< BAT_NO_INDEX where there is none
    column_unit time_unit, angle_unit;
    char separator;
    size_t width; ///< columns of the header
    char order[4];
} pose_translation;

/// Keep a sentence for the report.
void pose_note(pose_translation *work, const char *format, ...) __attribute__((format(printf, 2, 3)));
/// BAT_BAD_FILE with a line.
bat_status pose_fail(bat_error *error, size_t line, const char *text);
/// Read a row of exactly `count` numbers. False where it is none.
bool pose_read_numbers(const file_text *source, const text_line *line, size_t count, double *numbers, char *separator);
/// Write a row of the TUM format.
void pose_write_tum(pose_translation *work, const char *time, const double *place, const double *quaternion);

/// The nearest rotation of the 3x4 matrix of a row, and the largest distance of an entry from it. Infinite where there is
/// none.
double pose_matrix_deviation(const double *row, double *quaternion);
/// Rows of matrices.
bat_status pose_translate_kitti(pose_translation *work, bat_error *error);

/// What the names of a header tell.
typedef struct pose_header
{
    size_t others;              ///< columns without a role
    char other[POSE_NAME_SIZE]; ///< the first of them
    bool foreign;               ///< a name is not one that the CSV reader knows
    bool globe;                 ///< there are longitudes or latitudes
    bool euroc;                 ///< names of EuRoC
    size_t twice;               ///< a second column of a role, or BAT_NO_INDEX
    column_unit angles[3];
} pose_header;

/// Find the header of a table. A line that begins with '#' is one where it has separators and names of poses.
bool pose_find_header(pose_translation *work, text_line *head, pose_header *names, csv_field *time);
/// Whether a table needs to be translated. Poses whose names the CSV reader knows do not, unless their times are none in
/// seconds.
bool pose_wants_table(const pose_translation *work, const pose_header *names, csv_field time, bool *by_size);
bat_status pose_translate_table(pose_translation *work, const text_line *head, const pose_header *names, bool by_size,
                                bat_error *error);

#endif
