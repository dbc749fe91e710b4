/* Reader of CSV text as columns: cells get exactly the values that rvmon.recordings.csv_rows reads.

   A call ends with the text, when some room is used up, or at an odd row. Python reads odd rows, or
   reports what is wrong with them. A cell that is no plain value is noted as odd; its row is kept,
   and Python reads the cell. */
#ifndef RVMON_CSV_H
#define RVMON_CSV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Kinds of columns. In CSV_ANY, whose kind is not known yet, cells are labels, and one number stands
   for all numbers of its sort. Stamps have CSV_STAMP plus the decimal places from their unit to a
   tick: 9 for seconds, 0 for ticks. */
enum { CSV_BOOL, CSV_INT, CSV_REAL, CSV_LABEL, CSV_ANY, CSV_DATE, CSV_STAMP };
#define CSV_PLACES 9 /* the most decimal places of a stamp */

/* Sorts of cells of CSV_ANY: 0, 1, another whole number of up to 18 digits, another number; CSV_TEXT
   is everything else. */
typedef enum { CSV_TEXT, CSV_ZERO, CSV_ONE, CSV_WHOLE, CSV_NUMBER } csv_sort;
#define CSV_SORTS 5

/* Entries of cells, as in rvmon.recordings.batch; Python reads cells that are CSV_ODD. */
enum { CSV_UNKNOWN = 1, CSV_YES = 2, CSV_ODD = 3, CSV_NO_UPDATE = 255 };

typedef enum { CSV_ALL, CSV_FULL, CSV_ROW } csv_end;

typedef union {
    double real;
    int64_t whole;
} csv_number;

/* Reads a number that needs more than one operation on exact doubles; NaN: the text is none. */
typedef double (*csv_slow)(void *taken, const char *text);

typedef struct {
    const char *text;
    int64_t size;
    bool is_last;         /* no text follows */
    int64_t longest;      /* bytes; Python reads longer cells */
    const int32_t *slots; /* by place of a cell in its row: the column, or -1 */
    int32_t width;        /* cells of a row */
    const int32_t *kinds; /* by column; column 0 is the stamp */
    int32_t columns;
    const char *absent;   /* the text that means "no update"; NULL: none, as with CSV_ANY */
    int64_t absent_size;
    csv_slow slow;
    void *taken; /* argument of `slow` */

    int64_t room; /* rows */
    csv_number *numbers; /* `room` for each column; for labels, indices into `labels` */
    uint8_t *says;       /* entries, laid out like `numbers` */
    int64_t *lines;      /* by row, the line on which it ends, counted from 1 */
    int64_t *odd;        /* row, column, start and end of each odd cell */
    int64_t odd_room;
    int64_t *labels;     /* column, start, end and sort of each; ~end: quotes in it are doubled */
    int64_t label_room;
    int32_t *table; /* hash table of label indices plus 1; 2 * label_room, all 0 at first */

    int64_t at; /* the first byte that is not read yet; after CSV_ROW, the start of the odd row */
    int64_t end; /* after CSV_ROW, the end of the odd row */
    int64_t rows;
    int64_t line;
    int64_t odd_count;
    int64_t label_count;
} csv_reader;

/* Read as many rows as possible from `at` on; `rows`, `line` and the counts must be 0 at first. */
csv_end csv_read(csv_reader *r);

/* Convert a trimmed cell that is not empty to a value of its kind; returns its entry. */
int csv_value(const csv_reader *r, int32_t kind, const char *from, const char *to, csv_number *made);

/* Convert text with another separator, and maybe decimal commas, to plain CSV of the same size;
 * false if Python must convert it: it has a quote, a comma in a cell, or a row without a value. */
bool csv_as_plain(const char *text, int64_t size, char separator, bool has_commas, char *made);

/* Internals of the reader follow. */

typedef struct {
    const char *from;
    const char *to;
    bool is_doubled; /* quotes in it are doubled */
} csv_cell;

/* Read the next plain rows, several at once, but not beyond `lines_end`; returns their number, 0 if
 * the next row is not plain or there is no room for it. */
int64_t csv_plain(csv_reader *r, const char *lines_end);

/* Store a cell of the next row; false if there is no room for an odd cell or a label. */
bool csv_take(csv_reader *r, int32_t column, csv_cell c);

/* The index of a label in `labels`, where it is added if it is new; -1: there is no room. */
int64_t csv_label(csv_reader *r, int32_t column, csv_sort sort, csv_cell c);

/* The sort of a trimmed cell. */
csv_sort csv_sort_of(const char *from, const char *to);

/* Find the end of a quoted cell whose text starts at `at`, and count the lines in it; returns the
 * place after the closing quote, NULL if the text has none. */
const char *csv_quoted(const csv_reader *r, const char *at, csv_cell *c, int64_t *line);

/* For functions in loops over cells, which compilers would not inline as they are long. */
#if defined(__GNUC__)
#define CSV_INNERMOST static inline __attribute__((always_inline))
#else
#define CSV_INNERMOST static inline
#endif

static inline bool is_digit(char c)
{
    return (c >= '0') && (c <= '9');
}

/* The first comparison decides for digits, the most frequent characters. */
static inline bool csv_ends_cell(char c)
{
    return ((uint8_t)c <= ',') && ((c == ',') || (c == '\n') || (c == '\r'));
}

static inline bool csv_is_absent(const csv_reader *r, csv_cell c)
{
    return (r->absent != NULL) && (c.to - c.from == r->absent_size)
           && (memcmp(c.from, r->absent, (size_t)r->absent_size) == 0);
}

/* Load eight bytes, the first one as the lowest. */
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

/* The number of the lowest set bit; `bits` is not 0. */
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

/* Find the first byte that is not above `most`; `to` if there is none. */
static inline const char *csv_up_to(const char *at, const char *to, char most)
{
    const uint64_t above = 0x0101010101010101u * ((uint64_t)most + 1);
    while (to - at >= 8) {
        const uint64_t word = csv_word(at);
        /* The lowest mark is right; above it, a borrow may mark a byte that is above `most`. */
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
