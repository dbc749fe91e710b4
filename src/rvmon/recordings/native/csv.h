/* CSV text to columns: rows are split, and cells read exactly, as rvmon.recordings.csv_rows reads them.

   The text is cut where it has to be: a call ends with the text, where some room is used up, or at a
   row that is for Python, which says what is wrong with it. A cell that is no plain value is put down
   as odd, and is for Python, too; its row stays. */
#ifndef RVMON_CSV_H
#define RVMON_CSV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* What cells of a column are. Stamps of a unit with so many digits behind the point are CSV_STAMP and
   these digits: 9 of seconds, 0 of ticks. */
enum { CSV_BOOL, CSV_INT, CSV_REAL, CSV_LABEL, CSV_DATE, CSV_STAMP };

/* What a cell says: as in rvmon.recordings.batch; CSV_ODD is for Python to read. */
enum { CSV_UNKNOWN = 1, CSV_YES = 2, CSV_ODD = 3, CSV_NO_UPDATE = 255 };

typedef enum { CSV_ALL, CSV_FULL, CSV_ROW } csv_end;

typedef union {
    double real;
    int64_t whole;
} csv_number;

/* A number that is no exact whole times or through an exact power of ten; NaN: none. */
typedef double (*csv_slow)(void *taken, const char *text);

typedef struct {
    const char *text;
    int64_t size;
    bool is_last;         /* no text follows */
    int64_t longest;      /* bytes of a cell; a longer one is for Python */
    const int32_t *slots; /* of each place in a row: its column, or -1 */
    int32_t width;
    const int32_t *kinds; /* of each column; the first is the stamp */
    int32_t columns;
    const char *absent;   /* the text that stands for no update; NULL: none */
    int64_t absent_size;
    csv_slow slow;
    void *taken; /* what it is given */

    int64_t room; /* for rows */
    csv_number *numbers; /* of each column, `room` of them; of labels places in `labels` */
    uint8_t *says;       /* likewise */
    int64_t *lines;      /* of each row the line that it ends on, from 1 at the text's begin */
    int64_t *odd;        /* row, column, start and end of each odd cell */
    int64_t odd_room;
    int64_t *labels;     /* column, start and end of each; ~end: a quote in it is doubled */
    int64_t label_room;
    int32_t *table; /* finds labels: twice as many as there is room for, all 0 at first */

    int64_t at; /* the first byte that is not read yet; of CSV_ROW where the row begins, */
    int64_t end; /* and ends */
    int64_t rows;
    int64_t line;
    int64_t odd_count;
    int64_t label_count;
} csv_reader;

/* Read rows until it ends; `at`, `rows`, `line` and counts are 0 at first. */
csv_end csv_read(csv_reader *r);

/* A cell that is trimmed and not empty, as a value of its kind: what it says. */
int csv_value(const csv_reader *r, int32_t kind, const char *from, const char *to, csv_number *made);

/* Write text with another separator, and on request with commas for points, as plain CSV of the same
 * size; false if a line needs a closer look: a quote, a comma that stays, or a row without a value. */
bool csv_as_plain(const char *text, int64_t size, char separator, bool has_commas, char *made);

/* From here on it is the reader's own. */

typedef struct {
    const char *from;
    const char *to;
    bool is_doubled; /* a quote in it is */
} csv_cell;

/* Read the plain rows that follow, some at a time, up to the end of a line; gives how many, 0: the
 * next one is none, or there is no room for it. */
int64_t csv_plain(csv_reader *r, const char *lines_end);

/* Put down what a cell of the next row says; false: there is no more room. */
bool csv_take(csv_reader *r, int32_t column, csv_cell c);

/* Behind the quote that ends a cell whose text begins here; NULL: there is none in this text. */
const char *csv_quoted(const csv_reader *r, const char *at, csv_cell *c, int64_t *line);

/* Of a function in a loop over cells, which compilers would call, as it is long. */
#if defined(__GNUC__)
#define CSV_INNERMOST static inline __attribute__((always_inline))
#else
#define CSV_INNERMOST static inline
#endif

static inline bool is_digit(char c)
{
    return (c >= '0') && (c <= '9');
}

/* What all digits are above. */
static inline bool csv_ends_cell(char c)
{
    return ((uint8_t)c <= ',') && ((c == ',') || (c == '\n') || (c == '\r'));
}

static inline bool csv_is_absent(const csv_reader *r, csv_cell c)
{
    return (r->absent != NULL) && (c.to - c.from == r->absent_size)
           && (memcmp(c.from, r->absent, (size_t)r->absent_size) == 0);
}

/* Eight bytes, the first of which is the lowest. */
static inline uint64_t csv_word(const char *at)
{
#if defined(__BYTE_ORDER__) && (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)
    uint64_t word;
    (void)memcpy(&word, at, sizeof word);
    return word;
#else
    uint64_t word = 0;
    int32_t i;
    for (i = 0; i < 8; i++) {
        word |= (uint64_t)(uint8_t)at[i] << (8 * i);
    }
    return word;
#endif
}

/* The lowest bit that is set; one is. */
static inline int32_t csv_lowest(uint64_t bits)
{
#if defined(__GNUC__)
    return (int32_t)__builtin_ctzll(bits);
#else
    int32_t i = 0;
    while (((bits >> i) & 1u) == 0) {
        i++;
    }
    return i;
#endif
}

/* The first byte from here on that is not above a character; `to`: there is none. */
static inline const char *csv_up_to(const char *at, const char *to, char most)
{
    const uint64_t above = 0x0101010101010101u * ((uint64_t)most + 1);
    while (to - at >= 8) {
        const uint64_t word = csv_word(at);
        /* Behind the first byte one may be marked that is above; before it none is. */
        const uint64_t marks = (word - above) & ~word & 0x8080808080808080u;
        if (marks != 0) {
            return at + csv_lowest(marks) / 8;
        }
        at += 8;
    }
    while ((at < to) && ((uint8_t)*at > (uint8_t)most)) {
        at++;
    }
    return at;
}

#endif
