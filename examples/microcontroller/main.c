/* The monitor of base.rv on a Cortex-M4, without an operating system, a heap, or printf.
 *
 * Rows of a recording stand for what the sensors of a robot say; what is decided goes to the
 * debugger (semihosting), as it would to a serial line.
 */
#include "base.h"
#include "rows.h" /* const struct { int64_t t; base_sample sample; } rows[]; const char *names[] */

#define SYSTICK ((volatile uint32_t *)0xE000E010) /* control, reload, value */

static base_monitor monitor;
static base_attempt attempts[16];

static void host(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

static void say(const char *text) { host(0x04 /* SYS_WRITE0 */, text); }

static void say_number(int64_t number)
{
    char digits[24];
    char *first = digits + sizeof digits;
    uint64_t rest = number < 0 ? -(uint64_t)number : (uint64_t)number;
    *--first = '\0';
    do {
        *--first = (char)('0' + rest % 10);
    } while (rest /= 10);
    if (number < 0) {
        *--first = '-';
    }
    say(first);
}

static void on_record(void *user, const base_record *record)
{
    static const char *const verdicts[] = {"F", "P", "I", "NT"};
    (void)user;
    say(names[record->requirement]);
    say(record->in_doubt ? "?" : "#");
    say_number(record->number);
    say(" ");
    say(verdicts[record->verdict]);
    say(" ");
    say_number(record->triggered);
    say(" ");
    say_number(record->decided);
    say("\n");
}

void reset(void)
{
    const int32_t count = sizeof rows / sizeof *rows;
    uint32_t ticks = 0, most = 0;
    SYSTICK[1] = 0xFFFFFF;
    base_init(&monitor, attempts, sizeof attempts / sizeof *attempts, on_record, NULL);
    for (int32_t row = 0; row < count; row++) {
        SYSTICK[2] = 0; /* any value begins again */
        SYSTICK[0] = 5; /* the clock of the processor, no interrupt */
        base_step(&monitor, rows[row].t, &rows[row].sample);
        const uint32_t took = 0xFFFFFF - SYSTICK[2];
        ticks += took;
        most = took > most ? took : most;
    }
    base_finish(&monitor, INT64_MIN);
    say(base_overflowed(&monitor) ? "overflowed\n" : "");
    say_number(ticks);
    say(" ");
    say_number(most);
    say("\n");
    host(0x18 /* SYS_EXIT */, (const void *)0x20026 /* the application has ended */);
}

extern char stack_top[];
__attribute__((section(".vectors"), used)) static void *const vectors[] = {stack_top, (void *)reset};
