/// line.c: what names, files and packets bring into a line must not reach further than the line.
///
/// A terminal obeys control characters, also those from 0x80 to 0x9f, which are two bytes in UTF-8
/// and one in older encodings; a newline begins a line that nobody has written. So only the
/// characters of well-formed UTF-8 (Unicode 15.0, table 3-7) pass, and of these no control
/// character (category Cc), no separator of lines or paragraphs (U+2028, U+2029), and no mark that
/// turns the direction of the text (U+202A .. U+202E, U+2066 .. U+2069). The memory and time are
/// those of the line.
#include "base/line.h"
#include "base/format.h"

#include <stdint.h>
#include <string.h>

// bytes of the character at `s`, and its number; 0 if it is not UTF-8
static size_t decode(const unsigned char *s, uint32_t *code)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000}; // each in its shortest form only
    size_t n = s[0] < 0x80 ? 1 : s[0] >> 5 == 6 ? 2 : s[0] >> 4 == 14 ? 3 : s[0] >> 3 == 30 ? 4 : 0;
    *code = n < 2 ? s[0] : s[0] & 0x7Fu >> n;
    for (size_t i = 1; i < n; i++) {
        if (s[i] >> 6 != 2) // also the final 0
            return 0;
        *code = *code << 6 | (s[i] & 0x3Fu);
    }
    bool surrogate = *code >= 0xD800 && *code <= 0xDFFF;
    return *code < least[n] || *code > 0x10FFFF || surrogate ? 0 : n;
}

size_t himc_line_character(const char *text)
{
    uint32_t code;
    return decode((const unsigned char *)text, &code);
}

static bool is_plain(uint32_t code)
{
    return code >= 0x20 && !(code >= 0x7F && code <= 0x9F) && !(code >= 0x2028 && code <= 0x202E) &&
           !(code >= 0x2066 && code <= 0x2069);
}

bool himc_line_is_clean(const char *text)
{
    while (*text) {
        uint32_t code;
        size_t n = decode((const unsigned char *)text, &code);
        if (n == 0 || !is_plain(code))
            return false;
        text += n;
    }
    return true;
}

void himc_line_clean(char *line)
{
    char *out = line;
    for (const char *in = line; *in;) {
        uint32_t code;
        size_t n = decode((const unsigned char *)in, &code);
        if (n > 0 && is_plain(code)) {
            memmove(out, in, n);
            out += n;
        } else {
            *out++ = '?';
        }
        in += n > 0 ? n : 1;
    }
    *out = '\0';
}

void himc_line_print(char *out, size_t size, const char *format, va_list args)
{
    himc_format_list(out, size, format, args);
    himc_line_clean(out);
}

void himc_tell(const himc_line_sink *to, const char *format, ...)
{
    char text[256];
    va_list args;
    va_start(args, format);
    himc_line_print(text, sizeof text, format, args);
    va_end(args);
    to->line(to->user, text);
}
