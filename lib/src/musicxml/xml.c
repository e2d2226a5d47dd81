/// xml.c: the reader of XML: expat's events become a tree.
///
/// A document is read whole and thrown away whole, so its elements lie in blocks of memory. What
/// makes a small file large is refused: a declaration of an entity, and more elements or deeper
/// ones than a score has. An external DTD is never fetched: expat opens no file. Invariant: memory
/// is bounded by the limits below, whatever the bytes are.
#include "musicxml/xml.h"

#include <ctype.h>
#include <expat.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_ELEMENTS 4000000 // chosen: four times a long symphony
#define MOST_DEEP 64          // a note's deepest mark is the ninth
#define MOST_TEXT 1000        // of an element (bytes); chosen: a paragraph
#define BLOCK ((size_t)1 << 20)

typedef struct block {
    struct block *before;
    size_t used, size;
    _Alignas(16) char bytes[];
} block;

typedef struct reader {
    XML_Parser parser;
    block *last;
    const char *const *unused;
    xml_node *open[MOST_DEEP], *latest[MOST_DEEP]; ///< open elements, and the last child of each
    xml_node *root;
    int depth, skipped, elements;
    char text[MOST_TEXT]; ///< since the last tag
    size_t length;
    himc_error *error;
    bool failed;
} reader;

static void fail(reader *r, const char *what)
{
    if (!r->failed)
        himc_error_set(r->error, "line %d: %s", (int)XML_GetCurrentLineNumber(r->parser), what);
    r->failed = true;
    XML_StopParser(r->parser, XML_FALSE);
}

static void *take(reader *r, size_t size)
{
    size = (size + 15) & ~(size_t)15;
    if (!r->last || r->last->size - r->last->used < size) {
        size_t room = size > BLOCK ? size : BLOCK;
        block *made = malloc(sizeof *made + room);
        if (!made) {
            fail(r, "out of memory");
            return NULL;
        }
        *made = (block){r->last, 0, room};
        r->last = made;
    }
    void *at = r->last->bytes + r->last->used;
    r->last->used += size;
    return at;
}

static char *copy(reader *r, const char *text, size_t length)
{
    char *made = take(r, length + 1);
    if (made) {
        memcpy(made, text, length);
        made[length] = '\0';
    }
    return made;
}

static const char **copy_attributes(reader *r, const char **from)
{
    int count = 0;
    while (from[count])
        count++;
    const char **made = take(r, (size_t)(count + 1) * sizeof *made);
    for (int i = 0; made && i < count; i++)
        if (!(made[i] = copy(r, from[i], strlen(from[i]))))
            return NULL;
    if (made)
        made[count] = NULL;
    return made;
}

static void begin_element(void *user, const char *name, const char **attribute)
{
    reader *r = user;
    bool unused = r->skipped > 0;
    for (const char *const *u = r->depth > 0 ? r->unused : NULL; u && *u && !unused; u++)
        unused = strcmp(name, *u) == 0;
    r->length = 0;
    if (r->depth == MOST_DEEP || r->skipped > MOST_DEEP) {
        fail(r, "elements too deep for a score");
        return;
    }
    if (++r->elements > MOST_ELEMENTS) {
        fail(r, "more elements than a score has");
        return;
    }
    if (unused) {
        r->skipped++;
        return;
    }
    xml_node *node = take(r, sizeof *node), *parent = r->depth > 0 ? r->open[r->depth - 1] : NULL;
    char *own = copy(r, name, strlen(name));
    const char **attributes = node && own ? copy_attributes(r, attribute) : NULL;
    if (!attributes)
        return;
    *node = (xml_node){own, "", attributes, NULL, NULL, (int)XML_GetCurrentLineNumber(r->parser)};
    if (!parent)
        r->root = node;
    else if (!parent->child)
        parent->child = node;
    else
        r->latest[r->depth - 1]->next = node;
    if (parent)
        r->latest[r->depth - 1] = node;
    r->open[r->depth++] = node;
}

static void end_element(void *user, const char *name)
{
    reader *r = user;
    (void)name;
    if (r->failed) // expat may end an empty element although it was stopped
        return;
    if (r->skipped > 0) {
        r->skipped--;
        return;
    }
    const char *text = r->text;
    size_t length = r->length;
    while (length > 0 && isspace((unsigned char)text[length - 1]))
        length--;
    while (length > 0 && isspace((unsigned char)*text)) {
        text++;
        length--;
    }
    xml_node *node = r->open[--r->depth];
    r->length = 0;
    if (length > 0 && !(node->text = copy(r, text, length)))
        node->text = "";
}

static void add_text(void *user, const char *text, int length)
{
    reader *r = user;
    size_t room = MOST_TEXT - r->length, count = (size_t)length < room ? (size_t)length : room;
    if (r->skipped == 0) {
        memcpy(r->text + r->length, text, count);
        r->length += count;
    }
}

static void refuse_entity(void *user, const char *name, int parameter, const char *value,
                          int length, const char *base, const char *system, const char *public,
                          const char *notation)
{
    (void)name, (void)parameter, (void)value, (void)length, (void)base;
    (void)system, (void)public, (void)notation;
    fail(user, "an entity is declared; no score needs one, and none is read");
}

bool himc_xml_read(xml_document *document, const void *bytes, size_t size,
                   const char *const *unused, himc_error *error)
{
    reader *r = calloc(1, sizeof *r);
    *document = (xml_document){0};
    if (!r || !(r->parser = XML_ParserCreate(NULL))) {
        free(r);
        return himc_error_set(error, "out of memory");
    }
    r->unused = unused;
    r->error = error;
    XML_SetUserData(r->parser, r);
    XML_SetElementHandler(r->parser, begin_element, end_element);
    XML_SetCharacterDataHandler(r->parser, add_text);
    XML_SetEntityDeclHandler(r->parser, refuse_entity);
    const char *at = bytes;
    bool good = true;
    // expat counts in int
    for (size_t count; good && (size > 0 || at == bytes); at += count, size -= count) {
        count = size < BLOCK ? size : BLOCK;
        good = XML_Parse(r->parser, at, (int)count, count == size) == XML_STATUS_OK && !r->failed;
        if (count == 0 || count == size)
            break;
    }
    if (!good && !r->failed)
        himc_error_set(error, "line %d: %s", (int)XML_GetCurrentLineNumber(r->parser),
                       XML_ErrorString(XML_GetErrorCode(r->parser)));
    XML_ParserFree(r->parser);
    *document = (xml_document){r->root, r->last};
    free(r);
    if (!good)
        himc_xml_free(document);
    return good;
}

void himc_xml_free(xml_document *document)
{
    for (block *b = document->memory, *before; b; b = before) {
        before = b->before;
        free(b);
    }
    *document = (xml_document){0};
}

bool himc_xml_is(const xml_node *node, const char *name)
{
    return node && strcmp(node->name, name) == 0;
}

const xml_node *himc_xml_child(const xml_node *node, const char *name)
{
    const xml_node *child = node ? node->child : NULL;
    while (child && !himc_xml_is(child, name))
        child = child->next;
    return child;
}

const xml_node *himc_xml_next(const xml_node *node)
{
    const char *name = node->name;
    do
        node = node->next;
    while (node && !himc_xml_is(node, name));
    return node;
}

const char *himc_xml_text(const xml_node *node, const char *name)
{
    const xml_node *child = himc_xml_child(node, name);
    return child ? child->text : "";
}

double himc_xml_number(const xml_node *node, const char *name, double otherwise)
{
    const char *text = himc_xml_text(node, name);
    char *end;
    double number = strtod(text, &end);
    return end != text && isfinite(number) ? number : otherwise;
}

int himc_xml_whole(const xml_node *node, const char *name, int otherwise)
{
    return (int)lround(fmin(fmax(himc_xml_number(node, name, otherwise), -1000), 1000));
}

const char *himc_xml_attribute(const xml_node *node, const char *name)
{
    for (const char *const *a = node ? node->attribute : NULL; a && a[0]; a += 2)
        if (strcmp(a[0], name) == 0)
            return a[1];
    return "";
}

bool himc_xml_has(const xml_node *node, const char *name, const char *value)
{
    return strcmp(himc_xml_attribute(node, name), value) == 0;
}
