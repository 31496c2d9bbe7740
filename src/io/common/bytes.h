#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/// @file
/// Numbers of binary formats, the lowest byte first or, in big-endian files, last.

/// The whole number of `size` <= 8 bytes.
static inline uint64_t bytes_whole(const void *from, size_t size, bool big_endian)
{
    const unsigned char *bytes = from;
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++)
        bits |= (uint64_t)bytes[i] << 8 * (big_endian ? size - 1 - i : i);
    return bits;
}

/// The whole number of 4 bytes, the lowest first.
static inline uint32_t bytes_u32(const void *from)
{
    return (uint32_t)bytes_whole(from, 4, false);
}

/// The floating-point number of 4 or 8 bytes.
static inline double bytes_real(const void *from, size_t size, bool big_endian)
{
    const uint64_t bits = bytes_whole(from, size, big_endian);
    const uint32_t low = (uint32_t)bits;
    float narrow;
    double wide;
    memcpy(&narrow, &low, sizeof narrow);
    memcpy(&wide, &bits, sizeof wide);
    return size == sizeof narrow ? (double)narrow : wide;
}

/// Store the `size` lowest bytes of a whole number. Returns their end.
static inline char *bytes_put(char *out, uint64_t bits, size_t size, bool big_endian)
{
    for (size_t i = 0; i < size; i++)
        *out++ = (char)(bits >> 8 * (big_endian ? size - 1 - i : i) & 0xff);
    return out;
}

/// Store a number in single precision, the lowest byte first. Returns its end.
static inline char *bytes_put_float(char *out, double value)
{
    float single = (float)value;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    return bytes_put(out, bits, sizeof bits, false);
}
