#include "io/mesh/mesh_ply.h"

#include <math.h>

#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
static const bool machine_is_big_endian = true;
#else
static const bool machine_is_big_endian = false;
#endif

/// The bytes of a number as one integer.
static uint64_t gather(const char *bytes, size_t size, bool big_endian)
{
    bool swap = big_endian != machine_is_big_endian;
    uint16_t two;
    uint32_t four;
    uint64_t eight;
    switch (size)
    {
    case sizeof two:
        memcpy(&two, bytes, sizeof two);
        return swap ? __builtin_bswap16(two) : two;
    case sizeof four:
        memcpy(&four, bytes, sizeof four);
        return swap ? __builtin_bswap32(four) : four;
    case sizeof eight:
        memcpy(&eight, bytes, sizeof eight);
        return swap ? __builtin_bswap64(eight) : eight;
    default:
        return (unsigned char)*bytes;
    }
}

static double float_of(uint64_t bits)
{
    uint32_t low = (uint32_t)bits;
    float value;
    memcpy(&value, &low, sizeof value);
    return value;
}

static double double_of(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static double number_of(ply_type type, uint64_t bits)
{
    switch (type)
    {
    case PLY_INT8:
        return (int8_t)bits;
    case PLY_INT16:
        return (int16_t)bits;
    case PLY_INT32:
        return (int32_t)bits;
    case PLY_FLOAT32:
        return float_of(bits);
    case PLY_FLOAT64:
        return double_of(bits);
    default:
        return (double)bits;
    }
}

/// Whether a number that was read as text is one of its type.
static bool fits_type(ply_type type, double value)
{
    static const double least[] = {INT8_MIN, 0, INT16_MIN, 0, INT32_MIN, 0};
    static const double most[] = {INT8_MAX, UINT8_MAX, INT16_MAX, UINT16_MAX, INT32_MAX, UINT32_MAX};
    return type >= PLY_FLOAT32 || (value == floor(value) && value >= least[type] && value <= most[type]);
}

static bool read_word(ply_source *source, ply_type type, double *value)
{
    mesh_scan scan = source->scan;
    if (!scan_number(&scan, value) || !fits_type(type, *value))
        return false;
    source->scan = scan;
    return true;
}

bool ply_number(ply_source *source, ply_type type, double *value)
{
    if (source->encoding == PLY_TEXT)
        return read_word(source, type, value);
    size_t size = ply_type_size(type);
    if ((size_t)(source->scan.end - source->scan.at) < size)
        return false;
    double number = number_of(type, gather(source->scan.at, size, source->encoding == PLY_BIG_ENDIAN));
    if (!isfinite(number))
        return false;
    *value = number;
    source->scan.at += size;
    return true;
}

bool ply_skip(ply_source *source, ply_type type, size_t count)
{
    size_t left = (size_t)(source->scan.end - source->scan.at);
    if (source->encoding != PLY_TEXT)
    {
        bool enough = count <= left / ply_type_size(type);
        source->scan.at += enough ? count * ply_type_size(type) : 0;
        return enough;
    }
    double ignored;
    for (size_t i = 0; i < count; i++)
        if (!read_word(source, type, &ignored))
            return false;
    return true;
}
