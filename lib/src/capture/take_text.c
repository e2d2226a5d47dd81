/// take_text.c: text takes, read line by line from bytes that may be anything, and written.
///
/// Invariant: no function reads outside [at, at + length).
#include "capture/take_text.h"

#include <math.h>

himc_text himc_text_open(const char *bytes, size_t size)
{
    // a byte order mark is not part of the first line
    size_t skip =
        size >= 3 && bytes[0] == '\xEF' && bytes[1] == '\xBB' && bytes[2] == '\xBF' ? 3 : 0;
    return (himc_text){bytes + skip, bytes + size, 0};
}

bool himc_text_line(himc_text *text, himc_span *line)
{
    if (text->at >= text->end)
        return false;
    const char *start = text->at;
    while (text->at < text->end && *text->at != '\n' && *text->at != '\r')
        text->at++;
    *line = (himc_span){start, (size_t)(text->at - start)};
    if (text->at < text->end) {
        char end = *text->at++;
        if (end == '\r' && text->at < text->end && *text->at == '\n')
            text->at++;
    }
    text->line++;
    return true;
}

bool himc_text_filled_line(himc_text *text, himc_span *line)
{
    while (himc_text_line(text, line))
        if (himc_span_trim(*line).length > 0)
            return true;
    return false;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

himc_span himc_span_trim(himc_span span)
{
    while (span.length > 0 && is_blank(span.at[0])) {
        span.at++;
        span.length--;
    }
    while (span.length > 0 && is_blank(span.at[span.length - 1]))
        span.length--;
    return span;
}

bool himc_span_word(himc_span *rest, himc_span *word)
{
    himc_span left = himc_span_trim(*rest);
    size_t length = 0;
    while (length < left.length && !is_blank(left.at[length]))
        length++;
    *word = (himc_span){left.at, length};
    *rest = (himc_span){left.at + length, left.length - length};
    return length > 0;
}

himc_span himc_span_cell(himc_span *rest, char separator)
{
    if (!rest->at)
        return (himc_span){"", 0};
    size_t length = 0;
    while (length < rest->length && rest->at[length] != separator)
        length++;
    himc_span cell = {rest->at, length};
    bool last = length == rest->length;
    *rest =
        last ? (himc_span){NULL, 0} : (himc_span){cell.at + length + 1, rest->length - length - 1};
    return himc_span_trim(cell);
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

bool himc_span_is(himc_span span, const char *word)
{
    size_t i = 0;
    for (; i < span.length && word[i]; i++)
        if (lower(span.at[i]) != lower(word[i]))
            return false;
    return i == span.length && !word[i];
}

const char *himc_span_text(himc_span span, char text[44])
{
    size_t length = span.length < 40 ? span.length : 40;
    for (size_t i = 0; i < length; i++)
        text[i] = span.at[i] >= ' ' && span.at[i] <= '~' ? span.at[i] : '?';
    for (size_t i = 0; span.length > 40 && i < 3; i++)
        text[length++] = '.';
    text[length] = 0;
    return text;
}

bool himc_span_integer(himc_span s, long low, long high, long *value)
{
    double v;
    if (!himc_span_number(s, &v) || v != floor(v) || v < (double)low || v > (double)high)
        return false;
    *value = (long)v;
    return true;
}

void himc_text_put_number(FILE *file, double value, int digits)
{
    char text[64];
    snprintf(text, sizeof text, "%.*f", digits, value);
    for (char *c = text; *c; c++)
        if (*c == ',')
            *c = '.';
    fputs(text, file);
}

void himc_text_put_vec3(FILE *file, himc_vec3 x, int digits, char separator)
{
    double value[3] = {x.x, x.y, x.z};
    for (int axis = 0; axis < 3; axis++) {
        fputc(separator, file);
        himc_text_put_number(file, value[axis], digits);
    }
}
