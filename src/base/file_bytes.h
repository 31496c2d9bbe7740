#pragma once

#include "base/text_buffer.h"

/// A pipe with more bytes than this is refused, since it may never end.
#define FILE_MAX_BYTES (1ULL << 32)

/// Append the bytes of a file to a buffer, which is empty after a failure; "-" is standard input. Devices other than
/// terminals are refused, since they may have no end. So are more than `max` bytes from anything but a regular file.
/// @return BAT_OK, BAT_FILE_ACCESS or BAT_NO_MEMORY
bat_status file_bytes_read(const char *path, unsigned long long max, text_buffer *buffer, bat_error *error);
