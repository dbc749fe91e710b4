/* Conversion of another dialect of CSV to plain CSV, byte by byte. */
#include "csv.h"

/* The comma in a cell that is a number with a decimal comma; NULL if it is no such number. */
static const char *decimal_comma(const char *from, const char *to)
{
    const char *at = from;
    const char *comma;
    const char *digits;
    at += ((at < to) && ((*at == '+') || (*at == '-'))) ? 1 : 0;
    while ((at < to) && is_digit(*at)) {
        at++;
    }
    comma = at;
    if ((at == to) || (*at != ',')) {
        return NULL;
    }
    digits = ++at;
    while ((at < to) && is_digit(*at)) {
        at++;
    }
    if ((at > digits) && (at < to) && ((*at == 'e') || (*at == 'E'))) {
        at++;
        at += ((at < to) && ((*at == '+') || (*at == '-'))) ? 1 : 0;
        digits = at;
        while ((at < to) && is_digit(*at)) {
            at++;
        }
    }
    return ((at == to) && (at > digits)) ? comma : NULL;
}

bool csv_as_plain(const char *text, int64_t size, char separator, bool has_commas, char *made)
{
    const char *const end = text + size;
    const char *at = text;
    bool is_filled = false;    /* the line has a cell that is not blank */
    bool is_separated = false; /* the line has several cells */
    for (;;) {
        const char *const from = at;
        const char *comma = NULL;
        for (; (at < end) && (*at != separator) && (*at != '\n') && (*at != '\r'); at++) {
            if (*at == '"') {
                return false;
            }
            comma = ((comma == NULL) && (*at == ',')) ? at : comma;
            is_filled = is_filled || (((uint8_t)*at > ' ') && ((uint8_t)*at < 0x80));
        }
        (void)memcpy(made + (from - text), from, (size_t)(at - from));
        if (comma != NULL) {
            comma = has_commas ? decimal_comma(from, at) : NULL;
            if (comma == NULL) {
                return false;
            }
            made[comma - text] = '.';
        }
        if ((at < end) && (*at == separator)) {
            made[at - text] = ',';
            is_separated = true;
            at++;
            continue;
        }
        if (is_separated && !is_filled) {
            return false;
        }
        if (at == end) {
            return true;
        }
        made[at - text] = *at;
        at++;
        is_filled = false;
        is_separated = false;
    }
}
