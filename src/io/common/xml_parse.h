#pragma once

#include "io/common/file_text.h"

#include <expat.h>

/// @file
/// Parsing of XML by expat: errors with lines, and no document types, whose entities can make a huge text of a small file.

/// The first member of what handlers receive.
typedef struct xml_parse
{
    XML_Parser parser;
    const char *prefix;       ///< of what the parser reports
    const char *doctype;      ///< the error for a document type …
    bat_status doctype_fault; ///< … and its status
    bat_status status;        ///< handlers do nothing after a failure
    bat_error *error;
} xml_parse;

static inline size_t xml_line(const xml_parse *xml)
{
    return (size_t)XML_GetCurrentLineNumber(xml->parser);
}

/// Stop parsing. Returns false, as handlers that fail do.
static inline bool xml_stop(xml_parse *xml, bat_status status)
{
    xml->status = xml->status == BAT_OK ? status : xml->status;
    (void)XML_StopParser(xml->parser, XML_FALSE);
    return false;
}

/// Fail at the parser's line: false.
#define XML_FAIL(xml, status, ...) xml_stop(xml, error_set((xml)->error, status, BAT_NO_INDEX, xml_line(xml), __VA_ARGS__))

/// The value of an attribute; null for none.
static inline const char *xml_attribute(const XML_Char **attributes, const char *name)
{
    for (; attributes[0] != NULL; attributes += 2)
        if (strcmp(attributes[0], name) == 0)
            return attributes[1];
    return NULL;
}

static inline void XMLCALL xml_on_doctype(void *context, const XML_Char *name, const XML_Char *system,
                                          const XML_Char *public_name, int internal)
{
    (void)name, (void)system, (void)public_name, (void)internal;
    xml_parse *xml = context;
    XML_FAIL(xml, xml->doctype_fault, "%s", xml->doctype);
}

/// Make the parser; release it with XML_ParserFree().
/// @param separator between the namespace and the name of an element; null: names are as in the file
static inline bat_status xml_begin(xml_parse *xml, const char *separator, XML_StartElementHandler begin,
                                   XML_EndElementHandler end)
{
    xml->parser = separator != NULL ? XML_ParserCreateNS(NULL, *separator) : XML_ParserCreate(NULL);
    if (xml->parser == NULL)
        return error_memory(xml->error, sizeof *xml);
    XML_SetUserData(xml->parser, xml);
    XML_SetElementHandler(xml->parser, begin, end);
    XML_SetStartDoctypeDeclHandler(xml->parser, xml_on_doctype);
    return BAT_OK;
}

/// Parse a piece, whose size fits an int.
static inline bat_status xml_piece(xml_parse *xml, const char *bytes, size_t size, bool last)
{
    if (XML_Parse(xml->parser, bytes, (int)size, last) == XML_STATUS_OK || xml->status != BAT_OK)
        return xml->status;
    enum XML_Error fault = XML_GetErrorCode(xml->parser);
    return xml->status = fault == XML_ERROR_NO_MEMORY
                             ? error_memory(xml->error, size)
                             : ERROR_FILE(xml->error, xml_line(xml), "%s%s", xml->prefix, XML_ErrorString(fault));
}

/// Parse a whole text, and release the parser.
static inline bat_status xml_text(xml_parse *xml, const file_text *text)
{
    static const size_t PIECE = 1 << 20;
    bool last = false;
    for (size_t at = 0; xml->status == BAT_OK && !last; at += PIECE)
    {
        size_t size = text->size - at > PIECE ? PIECE : text->size - at;
        last = at + size == text->size;
        (void)xml_piece(xml, text->data + at, size, last);
    }
    XML_ParserFree(xml->parser);
    return xml->status;
}
