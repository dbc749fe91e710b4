/* Entry point of the fuzzer: five bytes that describe columns, then CSV text.
 *
 * The text is read in three ways: with ample room; with as little room as Python provides; and with
 * each row at the start of its own block, where the fast path is not taken. All must give the same
 * result. Then the text is converted as another dialect; converting the result must not change it. */
#include "csv.h"

#include <stdlib.h>

#define COLUMNS_MOST 6
#define LABELS_OF_COLUMN 5 /* as csv_batch.py reserves */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

typedef struct {
    int32_t kinds[COLUMNS_MOST];
    int32_t slots[COLUMNS_MOST];
    int32_t columns;
    const char *absent;
    int64_t longest;
    bool is_last;
} layout;

typedef enum { AMPLE, SHORT, ALONE } way;

/* decimal_at has accepted the text, so strtod reads all of it. */
static double slow(void *taken, const char *text)
{
    (void)taken;
    return strtod(text, NULL);
}

static void *block(size_t size)
{
    void *made = calloc(1, size); /* exactly this size, so that accesses beyond it are detected */
    if (made == NULL) {
        exit(2);
    }
    return made;
}

static layout layout_of(const uint8_t *data)
{
    static const int32_t stamps[] = {CSV_DATE, CSV_STAMP, CSV_STAMP + 3, CSV_STAMP + 6, CSV_STAMP + 9};
    layout made;
    int32_t i;
    (void)memset(&made, 0, sizeof made);
    made.columns = 1 + data[0] % COLUMNS_MOST;
    for (i = 0; i < made.columns; i++) {
        made.kinds[i] = (data[1] >= 200) ? CSV_ANY : (data[1] + i * data[2]) % CSV_ANY;
        made.slots[i] = (((data[3] >> i) & 1) != 0) ? -1 : (i + data[0] / COLUMNS_MOST) % made.columns;
    }
    made.kinds[0] = stamps[data[4] % 5];
    made.absent = ((data[1] < 200) && ((data[4] & 32) != 0)) ? "-1" : NULL;
    made.longest = ((data[4] & 64) != 0) ? 12 : 1 << 17;
    made.is_last = (data[4] & 128) == 0;
    return made;
}

static uint64_t mixed(uint64_t sum, int64_t what)
{
    return (sum ^ (uint64_t)what) * UINT64_C(0x100000001b3);
}

/* Mix the text of a cell; `end` as in csv.h. */
static uint64_t mixed_cell(uint64_t sum, const char *text, int64_t start, int64_t end)
{
    const int64_t behind = (end < 0) ? ~end : end;
    uint64_t made = mixed(sum, (end < 0) ? 1 : 0);
    int64_t i;
    for (i = start; i < behind; i++) {
        made = mixed(made, text[i]);
    }
    return made;
}

/* Mix the rows that a call has read; `before`: the number of lines before its text. */
static uint64_t mixed_rows(uint64_t sum, const csv_reader *r, int64_t before)
{
    uint64_t made = sum;
    int64_t odd = 0;
    int64_t row;
    int32_t i;
    for (row = 0; row < r->rows; row++) {
        made = mixed(made, before + r->lines[row]);
        for (i = 0; i < r->columns; i++) {
            const int64_t place = i * r->room + row;
            const bool is_label = (r->kinds[i] == CSV_LABEL) || (r->kinds[i] == CSV_ANY);
            made = mixed(made, r->says[place]);
            if ((r->says[place] == CSV_YES) && is_label) {
                const int64_t *label = &r->labels[4 * r->numbers[place].whole];
                made = mixed(made, label[3]);
                made = (label[3] == CSV_TEXT) ? mixed_cell(made, r->text, label[1], label[2]) : made;
            } else if (r->says[place] == CSV_YES) {
                made = mixed(made, r->numbers[place].whole);
            } else {
                /* It has no value. */
            }
        }
        for (i = 0; (i < r->columns) && (odd < r->odd_count) && (r->odd[4 * odd] == row); i++) {
            made = mixed(made, r->odd[4 * odd + 1]);
            made = mixed_cell(made, r->text, r->odd[4 * odd + 2], r->odd[4 * odd + 3]);
            odd++;
        }
    }
    return made;
}

/* Read the text in several calls, as csv_batch.py does, skipping odd rows; returns a checksum. */
static uint64_t told(const layout *l, const char *bytes, int64_t size, way how)
{
    const int64_t cells = size + COLUMNS_MOST + 1;
    uint64_t sum = 1;
    int64_t start = 0;
    int64_t line = 0;
    csv_end ended = CSV_FULL;
    while (ended != CSV_ALL) {
        const int64_t skipped = (how == ALONE) ? start : 0;
        char *text = block((size_t)(size - skipped));
        csv_reader r;
        (void)memset(&r, 0, sizeof r);
        (void)memcpy(text, bytes + skipped, (size_t)(size - skipped));
        r.text = text;
        r.size = size - skipped;
        r.at = start - skipped;
        r.is_last = l->is_last;
        r.longest = l->longest;
        r.slots = l->slots;
        r.width = l->columns;
        r.kinds = l->kinds;
        r.columns = l->columns;
        r.absent = l->absent;
        r.absent_size = 2;
        r.slow = slow;
        r.room = (how == AMPLE) ? cells : ((how == SHORT) ? 3 : 1);
        r.odd_room = (how == AMPLE) ? cells : l->columns;
        r.label_room = (how == AMPLE) ? cells : (int64_t)LABELS_OF_COLUMN * l->columns;
        r.numbers = block((size_t)(r.room * r.columns) * sizeof *r.numbers);
        r.says = block((size_t)(r.room * r.columns));
        r.lines = block((size_t)r.room * sizeof *r.lines);
        r.odd = block((size_t)(4 * r.odd_room) * sizeof *r.odd);
        r.labels = block((size_t)(4 * r.label_room) * sizeof *r.labels);
        r.table = block((size_t)(2 * r.label_room) * sizeof *r.table);
        ended = csv_read(&r);
        sum = mixed_rows(sum, &r, line);
        if ((ended == CSV_FULL) && ((how == AMPLE) || (r.rows == 0))) {
            abort(); /* there is always room for one row */
        }
        line += r.line;
        start = skipped + ((ended == CSV_ROW) ? r.end : r.at);
        sum = (ended == CSV_ROW) ? mixed(mixed(sum, skipped + r.at), start) : sum;
        free(text);
        free(r.numbers);
        free(r.says);
        free(r.lines);
        free(r.odd);
        free(r.labels);
        free(r.table);
    }
    return mixed(mixed(sum, start), line);
}

static void convert(const char *text, int64_t size, char separator, bool has_commas)
{
    char *once = block((size_t)size);
    char *twice = block((size_t)size);
    if (csv_as_plain(text, size, separator, has_commas, once)
        && (!csv_as_plain(once, size, ',', false, twice) || (memcmp(once, twice, (size_t)size) != 0))) {
        abort();
    }
    free(once);
    free(twice);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *text = (const char *)data + 5;
    layout l;
    uint64_t sum;
    if (size <= 5) {
        return 0;
    }
    l = layout_of(data);
    sum = told(&l, text, (int64_t)size - 5, AMPLE);
    if ((told(&l, text, (int64_t)size - 5, SHORT) != sum)
        || (told(&l, text, (int64_t)size - 5, ALONE) != sum)) {
        abort();
    }
    convert(text, (int64_t)size - 5, (data[4] % 2 == 0) ? ';' : '\t', (data[4] & 16) != 0);
    return 0;
}
