/// xml.h: an XML document as a tree of elements.
#ifndef HIMC_MUSICXML_XML_H
#define HIMC_MUSICXML_XML_H

#include "himc/base.h"

/// An element. All of it belongs to its document.
typedef struct xml_node {
    const char *name;
    const char *text;             ///< without white space around it; "" if there is none
    const char *const *attribute; ///< name, value, name, value, NULL
    struct xml_node *child, *next;
    int line; ///< in the file, from 1
} xml_node;

typedef struct xml_document {
    const xml_node *root;
    void *memory; ///< owned
} xml_document;

/// Reads a document. Elements named in `unused` (NULL after the last) are left out with all that is
/// in them. False with one line if the bytes are not well-formed, declare an entity, or hold more
/// elements than any score has. Free with himc_xml_free.
bool himc_xml_read(xml_document *document, const void *bytes, size_t size,
                   const char *const *unused, himc_error *error);
void himc_xml_free(xml_document *document);

/// The first child of that name; NULL if there is none, or no node.
const xml_node *himc_xml_child(const xml_node *node, const char *name);
/// The next sibling of the same name, or NULL.
const xml_node *himc_xml_next(const xml_node *node);
/// The child's text, "" if there is none.
const char *himc_xml_text(const xml_node *node, const char *name);
/// The child's text as a number; `otherwise` if it is none.
double himc_xml_number(const xml_node *node, const char *name, double otherwise);
/// The same, whole, within -1000 .. 1000, which no score reaches.
int himc_xml_whole(const xml_node *node, const char *name, int otherwise);
/// "" if there is none.
const char *himc_xml_attribute(const xml_node *node, const char *name);
bool himc_xml_is(const xml_node *node, const char *name);
/// True if the attribute has that value.
bool himc_xml_has(const xml_node *node, const char *name, const char *value);

#endif
