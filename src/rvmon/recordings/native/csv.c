/* Text to rows of cells. */
#include "numbers.h"

typedef struct {
    const char *from;
    const char *to;
    bool is_doubled; /* a quote in it is */
} cell;

/* As Python strips text; what is no ASCII is for Python. */
static bool is_space(char c)
{
    return (c == ' ') || ((c >= '\t') && (c <= '\r')) || ((c >= 28) && (c <= 31));
}

static cell trimmed(cell c)
{
    while ((c.from < c.to) && is_space(*c.from)) {
        c.from++;
    }
    while ((c.from < c.to) && is_space(c.to[-1])) {
        c.to--;
    }
    return c;
}

/* Where a label is noted, which is new or not; -1: there is no more room. */
static int64_t place_of(csv_reader *r, int32_t column, cell c)
{
    const int64_t start = c.from - r->text;
    const int64_t end = c.is_doubled ? ~(int64_t)(c.to - r->text) : c.to - r->text;
    const size_t size = (size_t)(c.to - c.from);
    uint32_t hash = 2166136261u ^ (uint32_t)column;
    uint32_t slot;
    size_t i;
    for (i = 0; i < size; i++) {
        hash = (hash ^ (uint8_t)c.from[i]) * 16777619u;
    }
    for (slot = hash % (2 * (uint32_t)r->label_room);; slot = (slot + 1) % (2 * (uint32_t)r->label_room)) {
        const int32_t found = r->table[slot] - 1;
        const int64_t *own = &r->labels[3 * (int64_t)found];
        if (found < 0) {
            break;
        }
        if ((own[0] == column) && ((own[2] < 0) == c.is_doubled)
            && ((size_t)(((own[2] < 0) ? ~own[2] : own[2]) - own[1]) == size)
            && (memcmp(r->text + own[1], c.from, size) == 0)) {
            return found;
        }
    }
    if (r->label_count == r->label_room) {
        return -1;
    }
    r->labels[3 * r->label_count] = column;
    r->labels[3 * r->label_count + 1] = start;
    r->labels[3 * r->label_count + 2] = end;
    r->label_count++;
    r->table[slot] = (int32_t)r->label_count;
    return r->label_count - 1;
}

static bool is_absent(const csv_reader *r, cell c)
{
    return (r->absent != NULL) && (c.to - c.from == r->absent_size)
           && (memcmp(c.from, r->absent, (size_t)r->absent_size) == 0);
}

/* Put down what a cell says; false: there is no more room. */
static bool take_cell(csv_reader *r, int32_t column, cell c)
{
    const int64_t place = (int64_t)column * r->room + r->rows;
    const int32_t kind = r->kinds[column];
    csv_number *made = &r->numbers[place];
    int says;
    c = trimmed(c);
    made->whole = 0;
    if ((kind < CSV_DATE) && ((c.from == c.to) || is_absent(r, c))) {
        says = CSV_NO_UPDATE;
    } else if (kind == CSV_LABEL) {
        says = CSV_YES;
        made->whole = place_of(r, column, c);
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

/* Behind the end of a line that begins here. */
static const char *behind(const char *at, const char *end)
{
    return ((*at == '\r') && (at + 1 < end) && (at[1] == '\n')) ? at + 2 : at + 1;
}

/* Whether more text might change what ends here. */
static bool is_open(const csv_reader *r, const char *at)
{
    const char *end = r->text + r->size;
    return !r->is_last && ((at == end) || ((*at == '\r') && (at + 1 == end)));
}

/* Behind the quote that ends a cell whose text begins here; NULL: there is none in this text. */
static const char *quoted(const csv_reader *r, const char *at, cell *c, int64_t *line)
{
    const char *end = r->text + r->size;
    c->from = at;
    while (at < end) {
        if (*at == '"') {
            if ((at + 1 == end) || (at[1] != '"')) {
                c->to = at;
                return at + 1;
            }
            c->is_doubled = true;
            at += 2;
        } else if ((*at == '\n') || (*at == '\r')) {
            at = behind(at, end);
            (*line)++;
        } else {
            at++;
        }
    }
    return NULL;
}

typedef enum { ROW_READ, ROW_BLANK, ROW_OPEN, ROW_ODD, ROW_NO_ROOM } row_end;

/* One row from `at` on; `*next` is behind it, but of one that is open. */
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
        *next = (blank == end) ? end : behind(blank, end);
        *line += 1;
        return is_open(r, blank) ? ROW_OPEN : ROW_BLANK;
    }
    for (;; at++) {
        const int32_t column = (place < r->width) ? r->slots[place] : -1;
        cell c = {at, at, false};
        if ((at < end) && (*at == '"')) {
            at = quoted(r, at + 1, &c, line);
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
            while ((at < end) && !csv_ends_cell(*at)) {
                at++;
            }
            c.to = at;
        }
        if (is_open(r, at)) {
            return ROW_OPEN;
        }
        is_odd = is_odd || (place >= r->width) || (c.to - c.from > r->longest);
        if (!is_odd && has_room && (column >= 0)) {
            has_room = take_cell(r, column, c);
        }
        place += (place < r->width) ? 1 : 0;
        if ((at == end) || (*at != ',')) {
            break;
        }
    }
    *next = (at == end) ? end : behind(at, end);
    *line += 1;
    if (is_odd || (place < r->width)) {
        return ROW_ODD;
    }
    return has_room ? ROW_READ : ROW_NO_ROOM;
}

/* Put down the number that a cell begins with, and is; gives its end. NULL: it is something else. */
static inline const char *take_number(csv_reader *r, int32_t column, const char *from)
{
    const int64_t place = (int64_t)column * r->room + r->rows;
    const int32_t kind = r->kinds[column];
    const char *end = r->text + r->size;
    decimal d;
    cell c = {from, NULL, false};
    if ((kind == CSV_LABEL) || (kind == CSV_DATE)) {
        return NULL;
    }
    c.to = decimal_at(from, end, &d);
    if ((c.to == NULL) || (c.to == end) || !csv_ends_cell(*c.to) || is_absent(r, c)
        || (number_of(r, kind, &d, from, c.to, &r->numbers[place]) != CSV_YES)) {
        return NULL;
    }
    r->says[place] = CSV_YES;
    return c.to;
}

/* Behind a cell before the last end of a line; NULL: it takes several lines, or has an odd end. */
static inline const char *plain_cell(const csv_reader *r, const char *at, cell *c)
{
    int64_t lines = 0;
    if (*at == '"') {
        at = quoted(r, at + 1, c, &lines);
        return ((at == NULL) || (lines > 0) || !csv_ends_cell(*at)) ? NULL : at;
    }
    while (!csv_ends_cell(*at)) {
        at++;
    }
    c->to = at;
    return at;
}

/* Put down a row before the last end of a line, which needs no look at where the text ends; gives
 * what is behind it. NULL: it is blank, or for `read_row`. */
static const char *read_plain(csv_reader *r, const char *at)
{
    int32_t place;
    if (is_space(*at)) {
        return NULL;
    }
    for (place = 0; place < r->width; place++) {
        const int32_t column = r->slots[place];
        cell c = {at, (column >= 0) ? take_number(r, column, at) : NULL, false};
        const bool is_number = c.to != NULL;
        at = is_number ? c.to : plain_cell(r, at, &c);
        if ((at == NULL) || (c.to - c.from > r->longest)
            || (!is_number && (column >= 0) && !take_cell(r, column, c))) {
            return NULL;
        }
        if (place + 1 < r->width) {
            if (*at != ',') {
                return NULL;
            }
            at++;
        }
    }
    if ((*at == '\r') && (at[1] == '\n')) {
        at++;
    }
    return (*at == '\n') ? at + 1 : NULL;
}

/* Behind the last line of the text that ends. */
static const char *behind_lines(const csv_reader *r)
{
    const char *at = r->text + r->size;
    while ((at > r->text) && (at[-1] != '\n')) {
        at--;
    }
    return at;
}

csv_end csv_read(csv_reader *r)
{
    const char *lines_end = behind_lines(r);
    while (r->at < r->size) {
        const char *next = NULL;
        const int64_t odd_count = r->odd_count;
        int64_t line = r->line;
        row_end ended;
        if (r->rows == r->room) {
            return CSV_FULL;
        }
        if (r->text + r->at < lines_end) {
            next = read_plain(r, r->text + r->at);
            if (next != NULL) {
                r->line++;
                r->lines[r->rows] = r->line;
                r->rows++;
                r->at = next - r->text;
                continue;
            }
            r->odd_count = odd_count;
        }
        ended = read_row(r, r->text + r->at, &next, &line);
        if (ended != ROW_READ) {
            r->odd_count = odd_count;
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
