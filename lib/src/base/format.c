/// format.c: a number is scaled by a power of ten to a whole number of as many digits as asked for;
/// these are its digits. In long double the scaled number is exact, or nearer than any rounding of
/// up to 9 digits can tell. A number is read the same way back: its digits are gathered in a whole
/// number, which is scaled once. Not strtod: it follows the program's locale, which may have
/// decimal commas, and reads hexadecimal, "inf" and "nan".
#include "base/format.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#define MOST_DIGITS 9 // after the point, or significant; 1e9 times 1e9 fits a uint64_t

typedef struct text {
    char *out;
    size_t used, size; ///< `size` counts the final 0
} text;

static void put(text *t, char c)
{
    if (t->used + 1 < t->size)
        t->out[t->used++] = c;
}

static void put_text(text *t, const char *s, int most)
{
    for (int i = 0; (most < 0 || i < most) && s[i]; i++)
        put(t, s[i]);
}

// at least `least` digits
static void put_whole(text *t, uint64_t n, int least)
{
    char digit[20];
    int count = 0;
    do
        digit[count++] = (char)('0' + n % 10);
    while ((n /= 10) > 0);
    while (count < least)
        digit[count++] = '0';
    while (count > 0)
        put(t, digit[--count]);
}

// x 10^n
static long double scaled(long double x, int n)
{
    long double power = 10;
    for (unsigned k = (unsigned)(n < 0 ? -n : n); k > 0; k /= 2, power *= power)
        if (k % 2)
            x = n < 0 ? x / power : x * power;
    return x;
}

// a whole number of 10^-decimals; `trim` drops zeros at its end
static void put_decimals(text *t, uint64_t n, int decimals, bool trim)
{
    for (; trim && decimals > 0 && n % 10 == 0; decimals--)
        n /= 10;
    uint64_t unit = (uint64_t)scaled(1, decimals);
    put_whole(t, n / unit, 1);
    if (decimals == 0)
        return;
    put(t, '.');
    put_whole(t, n % unit, decimals);
}

// x > 0 with so many significant digits, as %g
static void put_general(text *t, long double x, int digits)
{
    int exponent = (int)floorl(log10l(x));
    long double n = rintl(scaled(x, digits - 1 - exponent));
    if (n < scaled(1, digits - 1)) // the logarithm was a hair too large
        n = rintl(scaled(x, digits - 1 - --exponent));
    if (n >= scaled(1, digits))
        n = rintl(scaled(x, digits - 1 - ++exponent));
    if (exponent >= -4 && exponent < digits && exponent >= 0) {
        put_decimals(t, (uint64_t)n, digits - 1 - exponent, true);
    } else if (exponent >= -4 && exponent < 0) {
        uint64_t left = (uint64_t)n;
        int count = digits;
        for (; left % 10 == 0 && count > 1; count--)
            left /= 10;
        put_text(t, "0.", -1);
        put_text(t, "000", -exponent - 1);
        put_whole(t, left, count);
    } else {
        put_decimals(t, (uint64_t)n, digits - 1, true);
        put(t, 'e');
        put(t, exponent < 0 ? '-' : '+');
        put_whole(t, (uint64_t)(exponent < 0 ? -exponent : exponent), 2);
    }
}

static void put_number(text *t, double value, char kind, int digits)
{
    long double x = fabsl(value);
    digits = digits < 0 ? 6 : digits > MOST_DIGITS ? MOST_DIGITS : digits;
    if (signbit(value))
        put(t, '-');
    if (!isfinite(value))
        put_text(t, isnan(value) ? "nan" : "inf", -1);
    else if (kind == 'f' && x < scaled(1, MOST_DIGITS))
        put_decimals(t, (uint64_t)rintl(scaled(x, digits)), digits, false);
    else if (x > 0)
        put_general(t, x, kind == 'f' ? 6 : digits > 0 ? digits : 1);
    else
        put(t, '0');
}

size_t himc_format_list(char *out, size_t size, const char *format, va_list args)
{
    text t = {out, 0, size};
    while (*format) {
        if (*format != '%') {
            put(&t, *format++);
            continue;
        }
        int precision = -1;
        long whole;
        format++;
        if (format[0] == '.' && format[1] == '*') {
            precision = va_arg(args, int);
            format += 2;
        } else if (format[0] == '.') {
            precision = 0;
            for (format++; isdigit((unsigned char)*format); format++)
                precision = 10 * precision + (*format - '0');
        }
        char length = *format == 'l' || *format == 'z' ? *format++ : 0;
        char kind = *format ? *format++ : 0;
        switch (kind) {
        case 0: break; // a format that ends too early
        case 'c': put(&t, (char)va_arg(args, int)); break;
        case 's': put_text(&t, va_arg(args, const char *), precision); break;
        case 'd':
            whole = length == 'l' ? va_arg(args, long) : va_arg(args, int);
            if (whole < 0)
                put(&t, '-');
            put_whole(&t, whole < 0 ? 0 - (uint64_t)whole : (uint64_t)whole, 1);
            break;
        case 'u':
            put_whole(&t, length == 'z' ? va_arg(args, size_t) : va_arg(args, unsigned), 1);
            break;
        case 'g':
        case 'f': put_number(&t, va_arg(args, double), kind, precision); break;
        default: put(&t, kind); break; // %%
        }
    }
    out[t.used] = '\0';
    return t.used;
}

size_t himc_format(char *out, size_t size, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    size_t length = himc_format_list(out, size, format, args);
    va_end(args);
    return length;
}

// the digits from `s` to `end` into *m; *e counts those that no longer fit, and with `fraction`
// those behind the point. Returns where they end
static const char *take_digits(const char *s, const char *end, uint64_t *m, int *e, bool fraction)
{
    for (; s < end && *s >= '0' && *s <= '9'; s++) {
        if (*m < 1000000000000000000u) {
            *m = *m * 10 + (uint64_t)(*s - '0');
            *e -= fraction;
        } else if (*e < 100000) {
            *e += !fraction;
        }
    }
    return s;
}

bool himc_format_read(const char *word, size_t length, double *number)
{
    const char *s = word, *end = word + length, *begin;
    uint64_t m = 0, power = 0;
    int e = 0, none = 0;
    bool minus = length > 0 && *s == '-';
    s += length > 0 && (*s == '-' || *s == '+');
    begin = s;
    s = take_digits(s, end, &m, &e, false);
    size_t digits = (size_t)(s - begin);
    if (s < end && *s == '.') {
        begin = ++s;
        s = take_digits(s, end, &m, &e, true);
        digits += (size_t)(s - begin);
    }
    if (digits == 0)
        return false;
    if (s < end && (*s == 'e' || *s == 'E')) {
        bool down = ++s < end && *s == '-';
        s += s < end && (*s == '-' || *s == '+');
        begin = s;
        s = take_digits(s, end, &power, &none, false);
        if (s == begin)
            return false;
        int shift = power < 100000 ? (int)power : 100000;
        e += down ? -shift : shift;
    }
    if (s < end)
        return false;
    double value = m == 0 || e < -400 ? 0 : e > 400 ? INFINITY : (double)scaled((long double)m, e);
    *number = minus ? -value : value;
    return true;
}
