#include "io/common/base64.h"

/// @file
/// Groups of 24 bits as four characters.

static const char DIGITS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

enum
{
    GROUP = 3,
    CHARACTERS = 4,
    BITS = 6,
    MASK = 63
};

void base64_append(text_buffer *text, const void *bytes, size_t size)
{
    const unsigned char *from = bytes;
    if (size > SIZE_MAX / 2)
        text->failed = true;
    char *out = text->failed ? NULL : text_reserve(text, (size / GROUP + 1) * CHARACTERS);
    if (out == NULL)
        return;
    for (size_t i = 0; i < size; i += GROUP)
    {
        size_t left = size - i < GROUP ? size - i : GROUP;
        unsigned bits = (unsigned)from[i] << 16 | (left > 1 ? (unsigned)from[i + 1] << 8 : 0) | (left > 2 ? from[i + 2] : 0);
        for (size_t k = 0; k < CHARACTERS; k++)
            *out++ = k <= left ? DIGITS[bits >> (BITS * (CHARACTERS - 1 - k)) & MASK] : '=';
    }
    text_advance(text, out);
}

/// The value of a character; above MASK for none.
static unsigned digit_of(char character)
{
    unsigned char c = (unsigned char)character;
    if (c >= 'A' && c <= 'Z')
        return c - (unsigned)'A';
    if (c >= 'a' && c <= 'z')
        return c - (unsigned)'a' + 26;
    if (c >= '0' && c <= '9')
        return c - (unsigned)'0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : MASK + 1;
}

bool base64_decode(text_buffer *bytes, const char *text, size_t size)
{
    if (size > 0 && size % CHARACTERS == 0)
        for (int k = 0; k < 2 && text[size - 1] == '='; k++)
            size--;
    if (size % CHARACTERS == 1)
        return false;
    char *out = text_reserve(bytes, size / CHARACTERS * GROUP + GROUP);
    if (out == NULL)
        return true;
    unsigned bits = 0, count = 0;
    for (size_t i = 0; i < size; i++)
    {
        unsigned digit = digit_of(text[i]);
        if (digit > MASK)
            return false;
        bits = (bits << BITS | digit) & 0xffffffU;
        count += BITS;
        if (count >= 8)
        {
            count -= 8;
            *out++ = (char)(bits >> count & 0xff);
        }
    }
    text_advance(bytes, out);
    return true;
}
