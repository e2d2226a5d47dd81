/// take_text.c: text takes, read line by line from bytes that may be anything, and written.
///
/// Numbers: up to 19 significant digits are gathered in a 64-bit integer m and the decimal exponent
/// e in an int; the value m 10^e is formed in long double by powers of ten, which is within one
/// unit in the last place of a double. Not strtod: it obeys the program's locale (Pd's plug-in
/// hosts may set one with decimal commas), and reads hexadecimal, "inf" and "nan". Invariant: no
/// function reads outside [at, at + length).
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

static bool is_digit(himc_span s, size_t i)
{
    return i < s.length && s.at[i] >= '0' && s.at[i] <= '9';
}

// reads digits from `i` on into *m; *e counts those that no longer fit. Returns their end
static size_t take_digits(himc_span s, size_t i, uint64_t *m, int *e, int step)
{
    for (; is_digit(s, i); i++) {
        if (*m < 1000000000000000000u) {
            *m = *m * 10 + (uint64_t)(s.at[i] - '0');
            *e -= step;
        } else if (*e < 100000) {
            *e += 1 - step;
        }
    }
    return i;
}

static double scaled(uint64_t m, int e)
{
    if (m == 0 || e < -400)
        return 0;
    if (e > 400)
        return INFINITY;
    long double value = (long double)m, power = 10;
    for (unsigned n = e < 0 ? (unsigned)-e : (unsigned)e; n; n >>= 1, power *= power)
        if (n & 1)
            value = e < 0 ? value / power : value * power;
    return (double)value;
}

bool himc_span_number(himc_span s, double *value)
{
    size_t i = s.length > 0 && (s.at[0] == '-' || s.at[0] == '+') ? 1 : 0;
    bool minus = i == 1 && s.at[0] == '-';
    uint64_t m = 0;
    int e = 0;
    size_t start = i, digits = 0;
    i = take_digits(s, i, &m, &e, 0);
    digits = i - start;
    if (i < s.length && s.at[i] == '.') {
        start = ++i;
        i = take_digits(s, i, &m, &e, 1);
        digits += i - start;
    }
    if (digits == 0)
        return false;
    if (i < s.length && lower(s.at[i]) == 'e') {
        i++;
        bool down = i < s.length && s.at[i] == '-';
        if (i < s.length && (s.at[i] == '-' || s.at[i] == '+'))
            i++;
        if (!is_digit(s, i))
            return false;
        int exponent = 0;
        for (; is_digit(s, i); i++)
            exponent = exponent < 100000 ? exponent * 10 + (s.at[i] - '0') : exponent;
        e += down ? -exponent : exponent;
    }
    if (i < s.length)
        return false;
    *value = minus ? -scaled(m, e) : scaled(m, e);
    return true;
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
