/* The fast path for plain rows, the usual ones: each ends with LF or CRLF, and no quoted cell spans
   lines.

   Rows are read in stretches. First the ends of all cells are found, then each column of numbers is
   read in one loop, and the cells left over are read row by row. */
#include "numbers.h"

/* Room of a stretch for offsets: a row takes one for its start and one for the end of each cell. */
#define PLACES 8192

/* The most bytes of a stretch. */
#define STRETCH 32768

/* `short_of` loads up to 16 bytes before the end of a number: the text must have as many. */
#define BEFORE 16

typedef struct {
    const char *text; /* the start of the first row */
    int64_t rows;
    int32_t places[PLACES]; /* by row: the offset before its first cell, then its cells' ends */
    bool is_left[PLACES / 2]; /* by row (of two places at least): some cells are left over */
    bool some_are_left;
} stretch;

/* Bit i is set if byte i is not above a comma. The product gathers the marks in its highest byte. */
static inline uint64_t marks_of(const char *at)
{
    const uint64_t high = 0x8080808080808080u;
    const uint64_t word = csv_word(at);
    const uint64_t above = ((word | high) - 0x2D2D2D2D2D2D2D2Du) | word;
    return ((~above & high) >> 7) * 0x0102040810204080u >> 56;
}

/* The same for 64 bytes. */
static inline uint64_t marks_in(const char *at)
{
    return marks_of(at) | marks_of(at + 8) << 8 | marks_of(at + 16) << 16 | marks_of(at + 24) << 24
           | marks_of(at + 32) << 32 | marks_of(at + 40) << 40 | marks_of(at + 48) << 48
           | marks_of(at + 56) << 56;
}

/* Find the plain rows in `size` bytes, at most `most`; returns the end of the last one. */
static int32_t split(const csv_reader *r, int32_t size, int64_t most, stretch *s)
{
    const char *const text = s->text;
    const int32_t width = r->width;
    int32_t at = 0;
    int32_t end = 0; /* of the rows found */
    int32_t *next = s->places; /* the latest offset */
    const int32_t *last = next + width; /* the place of the end of the row's last cell */
    *next = -1;
    while (at < size) {
        const int32_t begin = at;
        uint64_t marks;
        if (size - at >= 64) {
            marks = marks_in(text + at);
        } else {
            char rest[64];
            (void)memset(rest, 'x', sizeof rest); /* which is above a comma, so not marked */
            (void)memcpy(rest, text + at, (size_t)(size - at));
            marks = marks_in(rest);
        }
        at += 64;
        for (; marks != 0; marks &= marks - 1) {
            const int32_t place = begin + csv_lowest(marks);
            const char found = text[place];
            if (found == ',') {
                next++;
                if (next == last) {
                    return end;
                }
                *next = place;
            } else if (found == '\n') {
                if ((next + 1 < last) || ((width == 1) && ((uint8_t)text[end] <= ' '))) {
                    return end;
                }
                next[1] = place - ((text[place - 1] == '\r') ? 1 : 0);
                next += 2;
                last += width + 1;
                end = place + 1;
                s->rows++;
                if (s->rows == most) {
                    return end;
                }
                *next = place;
            } else if (found == '\r') {
                if (text[place + 1] != '\n') {
                    return end;
                }
            } else if ((found == '"') && (place == *next + 1)) {
                csv_cell c = {text, text, false};
                int64_t lines = 0;
                const char *after = csv_quoted(r, text + place + 1, &c, &lines);
                if ((after == NULL) || (lines > 0) || !csv_ends_cell(*after)
                    || (after - text >= size)) {
                    return end;
                }
                at = (int32_t)(after - text); /* marks inside of the quotes do not count */
                break;
            }
        }
    }
    return end;
}

/* A column of a stretch: where its cells are, and where their values are stored. */
typedef struct {
    int32_t kind;
    csv_number *numbers;
    uint8_t *says;
    const int32_t *ends; /* the offset before its cell in the first row; the next one is its end */
    int64_t stride;      /* from a row to the next in `ends` */
} column;

static inline csv_cell cell_at(const stretch *s, const int32_t *ends)
{
    const csv_cell made = {s->text + ends[0] + 1, s->text + ends[1], false};
    return made;
}

static void leave(const column *c, stretch *s, int64_t row)
{
    c->says[row] = 0;
    s->is_left[row] = true;
    s->some_are_left = true;
}

/* Read a cell that is no short number: another form of number, or an empty cell. Any other cell is
 * left over, with the entry 0. */
static void read_other(const csv_reader *r, const column *c, stretch *s, int64_t row)
{
    const csv_cell found = cell_at(s, &c->ends[row * c->stride]);
    csv_number *made = &c->numbers[row];
    decimal d;
    int says = CSV_ODD;
    if ((found.from == found.to) && (c->kind < CSV_STAMP)) {
        made->whole = 0;
        says = CSV_NO_UPDATE;
    } else if (!csv_is_absent(r, found)
               && (decimal_at(found.from, r->text + r->size, &d) == found.to)) {
        says = number_of(r, c->kind, &d, found.from, found.to, made);
    }
    c->says[row] = (uint8_t)says;
    if (says == CSV_ODD) {
        leave(c, s, row);
    }
}

static void read_reals(const csv_reader *r, const column *c, stretch *s)
{
    const int32_t *ends = c->ends;
    const int64_t rows = s->rows;
    int64_t row;
    for (row = 0; row < rows; row++, ends += c->stride) {
        const csv_cell found = cell_at(s, ends);
        short_decimal d;
        if (short_of(found.from, found.to, &d) && (d.mantissa <= EXACT)) {
            const double real = (double)(int64_t)d.mantissa / POWERS[d.decimals];
            c->numbers[row].real = d.is_negative ? -real : real;
        } else {
            read_other(r, c, s, row);
        }
    }
}

/* Read integers, or stamps that have `places` decimal places from their unit to a tick. */
static void read_wholes(const csv_reader *r, const column *c, int32_t places, stretch *s)
{
    const int32_t *ends = c->ends;
    const int64_t rows = s->rows;
    int64_t row;
    for (row = 0; row < rows; row++, ends += c->stride) {
        const csv_cell found = cell_at(s, ends);
        short_decimal d;
        if (short_of(found.from, found.to, &d) && (d.decimals <= places)
            && (found.to[-1] != '.') /* nanoseconds must be digits alone */
            && (d.mantissa <= MOST_TICKS[places - d.decimals])) {
            const int64_t whole = (int64_t)(d.mantissa * WHOLE_POWERS[places - d.decimals]);
            c->numbers[row].whole = d.is_negative ? -whole : whole;
        } else {
            read_other(r, c, s, row);
        }
    }
}

static void read_bools(const csv_reader *r, const column *c, stretch *s)
{
    const int32_t *ends = c->ends;
    const int64_t rows = s->rows;
    int64_t row;
    for (row = 0; row < rows; row++, ends += c->stride) {
        const csv_cell found = cell_at(s, ends);
        if ((found.to - found.from == 1) && ((*found.from == '0') || (*found.from == '1'))) {
            c->numbers[row].whole = *found.from - '0';
        } else {
            read_other(r, c, s, row);
        }
    }
}

/* Read cells of CSV_ANY; texts are left over. */
static void read_sorts(csv_reader *r, const column *c, int32_t slot, stretch *s)
{
    int64_t labels[CSV_SORTS] = {-1, -1, -1, -1, -1};
    int64_t row;
    for (row = 0; row < s->rows; row++) {
        const csv_cell found = cell_at(s, &c->ends[row * c->stride]);
        const csv_sort sort = csv_sort_of(found.from, found.to);
        if ((sort != CSV_TEXT) && (labels[sort] < 0)) {
            labels[sort] = csv_label(r, slot, sort, found);
        }
        c->numbers[row].whole = labels[sort];
        if (labels[sort] < 0) {
            leave(c, s, row);
        }
    }
}

static void read_column(csv_reader *r, const column *c, int32_t slot, stretch *s)
{
    int64_t row;
    if ((c->kind == CSV_LABEL) || (c->kind == CSV_DATE)) {
        (void)memset(c->says, 0, (size_t)s->rows);
        (void)memset(s->is_left, true, (size_t)s->rows * sizeof *s->is_left);
        s->some_are_left = true;
        return;
    }
    (void)memset(c->says, CSV_YES, (size_t)s->rows);
    if (r->absent != NULL) {
        for (row = 0; row < s->rows; row++) {
            read_other(r, c, s, row);
        }
        return;
    }
    switch (c->kind) {
    case CSV_BOOL: read_bools(r, c, s); break;
    case CSV_INT: read_wholes(r, c, 0, s); break;
    case CSV_REAL: read_reals(r, c, s); break;
    case CSV_ANY: read_sorts(r, c, slot, s); break;
    default: read_wholes(r, c, c->kind - CSV_STAMP, s); break;
    }
}

/* Store the cells of the next row that are left over; false if there is no room. */
static bool take_left(csv_reader *r, const stretch *s, int64_t row)
{
    const int32_t *ends = &s->places[row * (r->width + 1)];
    int32_t place;
    for (place = 0; place < r->width; place++) {
        const int32_t slot = r->slots[place];
        if ((slot >= 0) && (r->says[slot * r->room + r->rows] == 0)) {
            csv_cell c = {s->text + ends[place] + 1, s->text + ends[place + 1], false};
            int64_t lines = 0;
            if ((c.from < c.to) && (*c.from == '"')) {
                (void)csv_quoted(r, c.from + 1, &c, &lines);
            }
            if (!csv_take(r, slot, c)) {
                return false;
            }
        }
    }
    return true;
}

int64_t csv_plain(csv_reader *r, const char *lines_end)
{
    stretch s;
    int64_t most = PLACES / ((int64_t)r->width + 1);
    int64_t size = (r->longest < STRETCH) ? r->longest : STRETCH; /* no cell can be too long */
    int32_t end;
    int32_t place;
    int64_t row;
    s.text = r->text + r->at;
    s.rows = 0;
    most = (most < r->room - r->rows) ? most : r->room - r->rows;
    size = (size < lines_end - s.text) ? size : lines_end - s.text;
    if ((size <= 0) || (most == 0) || (r->at < BEFORE)) {
        return 0;
    }
    end = split(r, (int32_t)size, most, &s);
    (void)memset(s.is_left, 0, (size_t)s.rows * sizeof *s.is_left);
    s.some_are_left = false;
    for (place = 0; place < r->width; place++) {
        const int32_t slot = r->slots[place];
        const int64_t put = slot * r->room + r->rows;
        if (slot >= 0) {
            const column c = {r->kinds[slot], &r->numbers[put], &r->says[put], &s.places[place],
                              (int64_t)r->width + 1};
            read_column(r, &c, slot, &s);
        }
    }
    for (row = 0; row < s.rows; row++) {
        const int64_t odd_count = r->odd_count;
        if (s.some_are_left && s.is_left[row] && !take_left(r, &s, row)) {
            r->odd_count = odd_count;
            r->at += s.places[row * (r->width + 1)] + 1;
            return row;
        }
        r->line++;
        r->lines[r->rows] = r->line;
        r->rows++;
    }
    r->at += end;
    return s.rows;
}
