#pragma once

#include "base/text_buffer.h"

/// @file
/// Base64 (RFC 4648, section 4).

/// Append bytes in base64, with padding.
void base64_append(text_buffer *text, const void *bytes, size_t size);

/// Append the bytes of base64 text, padded or not. False for other text. Out of memory: `bytes->failed` is set.
bool base64_decode(text_buffer *bytes, const char *text, size_t size);
