/* Splitting of text into rows of cells. */
#include "csv.h"

#include <string.h>

/* The ASCII characters that Python's `strip` removes; Python strips all others. */
static bool is_space(char c)
{
    return (c == ' ') || ((c >= '\t') && (c <= '\r')) || ((c >= 28) && (c <= 31));
}

static csv_cell trimmed(csv_cell c)
{
    while ((c.from < c.to) && is_space(*c.from)) {
        c.from++;
    }
    while ((c.from < c.to) && is_space(c.to[-1])) {
        c.to--;
    }
    return c;
}

int64_t csv_label(csv_reader *r, int32_t column, csv_sort sort, csv_cell c)
{
    const int64_t start = c.from - r->text;
    const int64_t end = c.is_doubled ? ~(int64_t)(c.to - r->text) : c.to - r->text;
    const size_t size = (sort == CSV_TEXT) ? (size_t)(c.to - c.from) : 0; /* that matters */
    uint32_t hash = (2166136261u ^ (uint32_t)column) + (uint32_t)sort;
    uint32_t slot;
    size_t i;
    for (i = 0; i < size; i++) {
        hash = (hash ^ (uint8_t)c.from[i]) * 16777619u;
    }
    for (slot = hash % (2 * (uint32_t)r->label_room);; slot = (slot + 1) % (2 * (uint32_t)r->label_room)) {
        const int32_t found = r->table[slot] - 1;
        const int64_t *own;
        if (found < 0) {
            break;
        }
        own = &r->labels[4 * (int64_t)found];
        if ((own[0] == column) && (own[3] == (int64_t)sort)
            && ((sort != CSV_TEXT)
                || (((own[2] < 0) == c.is_doubled)
                    && ((size_t)(((own[2] < 0) ? ~own[2] : own[2]) - own[1]) == size)
                    && (memcmp(r->text + own[1], c.from, size) == 0)))) {
            return found;
        }
    }
    if (r->label_count == r->label_room) {
        return -1;
    }
    r->labels[4 * r->label_count] = column;
    r->labels[4 * r->label_count + 1] = start;
    r->labels[4 * r->label_count + 2] = end;
    r->labels[4 * r->label_count + 3] = (int64_t)sort;
    r->label_count++;
    r->table[slot] = (int32_t)r->label_count;
    return r->label_count - 1;
}

bool csv_take(csv_reader *r, int32_t column, csv_cell c)
{
    const int64_t place = (int64_t)column * r->room + r->rows;
    const int32_t kind = r->kinds[column];
    csv_number *made = &r->numbers[place];
    int says;
    c = trimmed(c);
    made->whole = 0;
    if ((kind < CSV_DATE) && ((c.from == c.to) || csv_is_absent(r, c))) {
        says = CSV_NO_UPDATE;
    } else if ((kind == CSV_LABEL) || (kind == CSV_ANY)) {
        const bool is_text = (kind == CSV_LABEL) || c.is_doubled;
        says = CSV_YES;
        made->whole = csv_label(r, column, is_text ? CSV_TEXT : csv_sort_of(c.from, c.to), c);
        if (made->whole < 0) {
            return false;
        }
    } else {
        says = ((c.from == c.to) || c.is_doubled) ? CSV_ODD
                                                  : csv_value(r, kind, c.from, c.to, made);
    }
    r->says[place] = (uint8_t)says;
    if (says == CSV_ODD) {
        int64_t *odd = &r->odd[4 * r->odd_count];
        if (r->odd_count == r->odd_room) {
            return false;
        }
        odd[0] = r->rows;
        odd[1] = column;
        odd[2] = c.from - r->text;
        odd[3] = c.is_doubled ? ~(int64_t)(c.to - r->text) : c.to - r->text;
        r->odd_count++;
    }
    return true;
}

/* The place after an end of line, which starts at `at`. */
static const char *after_line_end(const char *at, const char *end)
{
    return ((*at == '\r') && (at + 1 < end) && (at[1] == '\n')) ? at + 2 : at + 1;
}

/* Whether the text after this one might change the cell or line that ends at `at`. */
static bool is_open(const csv_reader *r, const char *at)
{
    const char *end = r->text + r->size;
    return !r->is_last && ((at == end) || ((*at == '\r') && (at + 1 == end)));
}

const char *csv_quoted(const csv_reader *r, const char *at, csv_cell *c, int64_t *line)
{
    const char *end = r->text + r->size;
    c->from = at;
    for (;;) {
        at = csv_up_to(at, end, '"');
        if (at == end) {
            return NULL;
        }
        if (*at == '"') {
            if ((at + 1 == end) || (at[1] != '"')) {
                c->to = at;
                return at + 1;
            }
            c->is_doubled = true;
            at += 2;
        } else if ((*at == '\n') || (*at == '\r')) {
            at = after_line_end(at, end);
            (*line)++;
        } else {
            at++;
        }
    }
}

typedef enum { ROW_READ, ROW_BLANK, ROW_OPEN, ROW_ODD, ROW_NO_ROOM } row_end;

/* Read the row at `at`; sets `*next` after it and counts its lines, unless ROW_OPEN is returned. */
static row_end read_row(csv_reader *r, const char *at, const char **next, int64_t *line)
{
    const char *end = r->text + r->size;
    bool is_odd = false;
    bool has_room = true;
    int32_t place = 0;
    const char *blank = at;
    while ((blank < end) && is_space(*blank) && (*blank != '\n') && (*blank != '\r')) {
        blank++;
    }
    if ((blank == end) || (*blank == '\n') || (*blank == '\r')) {
        *next = (blank == end) ? end : after_line_end(blank, end);
        *line += 1;
        return is_open(r, blank) ? ROW_OPEN : ROW_BLANK;
    }
    for (;; at++) {
        const int32_t column = (place < r->width) ? r->slots[place] : -1;
        csv_cell c = {at, at, false};
        if ((at < end) && (*at == '"')) {
            at = csv_quoted(r, at + 1, &c, line);
            if ((at == NULL) || (at == end)) {
                if (!r->is_last) {
                    return ROW_OPEN;
                }
                is_odd = is_odd || (at == NULL);
                at = end;
            } else if ((*at != ',') && (*at != '\n') && (*at != '\r')) {
                is_odd = true;
                while ((at < end) && (*at != '\n') && (*at != '\r')) {
                    at++;
                }
            }
        } else {
            while (((at = csv_up_to(at, end, ',')) < end) && !csv_ends_cell(*at)) {
                at++;
            }
            c.to = at;
        }
        if (is_open(r, at)) {
            return ROW_OPEN;
        }
        is_odd = is_odd || (place >= r->width) || (c.to - c.from > r->longest);
        if (!is_odd && has_room && (column >= 0)) {
            has_room = csv_take(r, column, c);
        }
        place += (place < r->width) ? 1 : 0;
        if ((at == end) || (*at != ',')) {
            break;
        }
    }
    *next = (at == end) ? end : after_line_end(at, end);
    *line += 1;
    if (is_odd || (place < r->width)) {
        return ROW_ODD;
    }
    return has_room ? ROW_READ : ROW_NO_ROOM;
}

/* The end of the last whole line of the text. */
static const char *end_of_lines(const csv_reader *r)
{
    const char *at = r->text + r->size;
    while ((at > r->text) && (at[-1] != '\n')) {
        at--;
    }
    return at;
}

csv_end csv_read(csv_reader *r)
{
    const char *lines_end = end_of_lines(r);
    while (r->at < r->size) {
        const char *next = NULL;
        const int64_t odd_count = r->odd_count;
        int64_t line = r->line;
        row_end ended;
        if (r->rows == r->room) {
            return CSV_FULL;
        }
        /* The fast path first; the row at which it stops is read by itself. */
        if (csv_plain(r, lines_end) > 0) {
            continue;
        }
        ended = read_row(r, r->text + r->at, &next, &line);
        if (ended != ROW_READ) {
            r->odd_count = odd_count; /* forget the odd cells of a row that is not kept */
        }
        switch (ended) {
        case ROW_OPEN: return CSV_ALL;
        case ROW_NO_ROOM: return CSV_FULL;
        case ROW_ODD: r->end = next - r->text; return CSV_ROW;
        case ROW_READ: r->lines[r->rows] = line; r->rows++; break;
        default: break;
        }
        r->line = line;
        r->at = next - r->text;
    }
    return CSV_ALL;
}
