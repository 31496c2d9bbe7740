#pragma once

#include "batten/shell.h"
#include "batten/spline.h"
#include "batten/surface_file.h"
#include "io/common/block_writer.h"
#include "io/common/file_text.h"

/// @file
/// Readers and writers of surface formats. Surfaces and options for writers have passed surface_check(). Readers leave
/// `surface` untouched on failure.

typedef bat_status surface_writer(const bat_spline_surface *surface, const bat_surface_write_options *options,
                                  text_sink *sink, bat_error *error);
surface_writer surface_xml_write, surface_json_write, surface_step_write, surface_iges_write, surface_vtk_write,
    surface_obj_write;

/// Write a surface as STEP of a simple shape, where it fits; see bat_surface_write_shape().
bat_status surface_shape_write(const bat_spline_surface *surface, const bat_surface_primitive *shape,
                               const bat_surface_write_options *options, text_sink *sink, size_t edges[3], double *area,
                               bat_error *error);
/// Write a shell as STEP: a solid of each closed part, a surface model of each open one.
bat_status shell_step_write(const bat_shell *shell, const bat_surface_write_options *options, text_sink *sink,
                            bat_error *error);

bat_status surface_xml_read(const file_text *text, bat_spline_surface *surface, bat_error *error);
bat_status surface_json_read(const file_text *text, bat_spline_surface *surface, bat_error *error);

/// Read a text in the format of its content.
bat_status surface_read_text(const file_text *text, bat_spline_surface *surface, bat_error *error);

/// Check that a surface can be written in a format with these options.
bat_status surface_check(const bat_spline_surface *surface, bat_surface_format format,
                         const bat_surface_write_options *options, bat_error *error);

/// Write a surface in a format other than BAT_SURFACE_FORMAT_AUTO.
bat_status surface_write_text(const bat_spline_surface *surface, bat_surface_format format,
                              const bat_surface_write_options *options, text_sink *sink, bat_error *error);

// Hierarchical spline spaces from the contents of files.

/// A box of cells of one level, which the space refines to that level or further.
typedef struct surface_box
{
    uint64_t level;
    uint64_t low[2], high[2];
    size_t line;
} surface_box;

/// The number of cells of a level in one direction: 64 bits hold all below BAT_HIERARCHICAL_MAX_LEVELS of 2^32 spans.
static inline uint64_t surface_level_cells(const bat_hierarchical_options *options, uint64_t level, int direction)
{
    return (uint64_t)options->spans[direction] << level;
}

/// Make the space in which each cell has the highest level of the boxes that contain it, or 0. Boxes may overlap. A box may
/// divide cells of the previous level if other boxes fill these cells.
/// @param line      of the coefficients, for errors
/// @param functions the number of coefficients in the file; much larger spaces are refused before memory is allocated
/// @return BAT_OK; BAT_BAD_FILE with the line of an empty box or one outside its grid, or for a wrong number of functions;
/// BAT_UNSUPPORTED for regions that divide cells of the previous level; BAT_TOO_LARGE; BAT_NO_MEMORY
bat_status surface_space_make(const bat_hierarchical_options *options, const surface_box *boxes, size_t count, size_t line,
                              size_t functions, bat_hierarchical_space **space, bat_error *error);
