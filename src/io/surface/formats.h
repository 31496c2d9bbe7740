#ifndef IO_SURFACE_FORMATS_H
#define IO_SURFACE_FORMATS_H

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

#endif
