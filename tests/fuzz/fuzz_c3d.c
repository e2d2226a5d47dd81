/// fuzz_c3d.c: takes from arbitrary bytes as C3D.
///
/// Blind damage rarely leaves a C3D readable: a wrong word early in it ends everything. So most
/// mutations here know the format: words of the header, the parameters' names, types, sizes,
/// links and values, in the file's own processor order, and samples. A file too short to be one is
/// replaced by a new, good one, so the corpus needs no seeds.
#include "c3d_files.h"
#include "take.h"

#define LEAST (512 * 5) // a file of c3d_files.h without frames (bytes)
#define MOST_RECORDS 64

typedef struct file {
    uint8_t *data;
    size_t size, most;
    uint32_t state;
    maker order; // its processor alone
} file;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_format("fuzz.c3d", data, size);
}

static uint32_t below(file *f, uint32_t n)
{
    f->state = f->state * 1664525u + 1013904223u; // Knuth's generator, as in Numerical Recipes
    return (f->state >> 8) % n;
}

static int some_word(file *f)
{
    static const int words[] = {0, 1, 2, 3, 4, 5, 6, 8, 16, 255, 256, 1000, 32767, 32768, 65535};
    return below(f, 3) ? words[below(f, sizeof words / sizeof words[0])] : (int)below(f, 65536);
}

static double some_real(file *f)
{
    static const double reals[] = {0,   1,    -1,   0.1,  -0.1, 50,    250,   1000,
                                   1e5, 1e-9, 1e30, -1e9, NAN,  1e-38, 65535, 0.5};
    return reals[below(f, sizeof reals / sizeof reals[0])];
}

static void new_file(file *f)
{
    maker m = maker_default((c3d_processor)(C3D_INTEL + (int)below(f, 3)), below(f, 2));
    m.points = 1 + (int)below(f, 4);
    m.frames = 1 + (int)below(f, 8);
    m.analog = (int)below(f, 3);
    m.events = below(f, 2) ? 2 : 0;
    m.header_events = (int)below(f, 2);
    m.long_frames = below(f, 4) == 0;
    m.mass = below(f, 4) ? 0 : 70;
    m.height = 1800;
    make(&m);
    if (m.size <= f->most) {
        memcpy(f->data, m.bytes, m.size);
        f->size = m.size;
    }
    free(m.bytes);
}

// where the parameters' records begin, as far as their links lead
static int find_records(const file *f, size_t record[MOST_RECORDS])
{
    size_t at = f->data[0] >= 2 ? (size_t)(f->data[0] - 1) * 512 + 4 : 516;
    int count = 0;
    while (count < MOST_RECORDS && at + 8 < f->size && f->data[at] != 0) {
        size_t name = (size_t)abs((int8_t)f->data[at]), link = at + 2 + name;
        record[count++] = at;
        if (link + 8 > f->size)
            return count - 1;
        bool high_first = f->order.processor == C3D_MIPS;
        size_t low = f->data[link + high_first], high = f->data[link + !high_first];
        if (low + 256 * high == 0)
            break;
        at = link + low + 256 * high;
    }
    return count;
}

// a record gets another name; its link counts from itself and stays right
static void rename_record(file *f, size_t at)
{
    static const char *const names[] = {"POINT",
                                        "USED",
                                        "FRAMES",
                                        "RATE",
                                        "SCALE",
                                        "UNITS",
                                        "LABELS",
                                        "LABELS2",
                                        "X_SCREEN",
                                        "Y_SCREEN",
                                        "TRIAL",
                                        "EVENT",
                                        "TIMES",
                                        "ANALOG",
                                        "HEIGHT",
                                        "BODYMASS",
                                        "CONTEXTS",
                                        "MASS",
                                        "SUBJECTS",
                                        "DATA_START",
                                        "ACTUAL_END_FIELD",
                                        "ACTUAL_START_FIELD"};
    const char *name = names[below(f, sizeof names / sizeof names[0])];
    size_t old = (size_t)abs((int8_t)f->data[at]), new = strlen(name);
    if (f->size + new > f->most || at + 2 + old > f->size)
        return;
    memmove(f->data + at + 2 + new, f->data + at + 2 + old, f->size - (at + 2 + old));
    memcpy(f->data + at + 2, name, new);
    f->size += new - old;
    f->data[at] = (uint8_t) new;
}

static void change_record(file *f, size_t at)
{
    uint8_t *link = f->data + at + 2 + abs((int8_t)f->data[at]), *type = link + 2;
    static const int8_t types[] = {-1, 1, 2, 4, 0, 3, -4, 127};
    switch (below(f, 7)) {
    case 0: rename_record(f, at); break;
    case 1: f->data[at + 1] = (uint8_t)((int)below(f, 9) - 4); break; // of which group
    case 2: put_word(&f->order, link, below(f, 2) ? (int)below(f, 40) : some_word(f)); break;
    case 3: *type = (uint8_t)types[below(f, sizeof types)]; break;
    case 4: type[1] = (uint8_t)(below(f, 2) ? below(f, 4) : below(f, 256)); break;
    case 5: type[2] = (uint8_t)(below(f, 2) ? below(f, 8) : below(f, 256)); break;
    default:
        if (*type == 4 && type + 6 <= f->data + f->size)
            write_real(f->order.processor, some_real(f), type + 2);
        else
            put_word(&f->order, type + 2 + below(f, 2), some_word(f));
    }
}

static void change_header(file *f)
{
    switch (below(f, 6)) {
    case 0: f->data[below(f, 2)] = (uint8_t)below(f, 8); break; // the parameters' block, the mark
    case 1: f->data[515] = (uint8_t)(C3D_INTEL - 1 + (int)below(f, 5)); break; // the processor
    case 2: write_real(f->order.processor, some_real(f), f->data + 12); break; // the scale
    case 3: write_real(f->order.processor, some_real(f), f->data + 20); break; // the rate
    case 4: put_word(&f->order, f->data + 298 + 2 * below(f, 100), some_word(f)); break; // events
    default: put_word(&f->order, f->data + 2 * below(f, 10), some_word(f));
    }
}

static void change_sample(file *f)
{
    if (f->size < LEAST + 8)
        return;
    uint8_t *at = f->data + LEAST + 2 * below(f, (uint32_t)(f->size - LEAST - 4) / 2);
    if (below(f, 2))
        write_real(f->order.processor, some_real(f), at);
    else
        put_word(&f->order, at, some_word(f));
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed)
{
    size_t record[MOST_RECORDS];
    file f = {data, size, most, seed, {0}};
    if (size < LEAST || below(&f, 50) == 0) {
        new_file(&f);
        return f.size;
    }
    int processor = data[515];
    f.order.processor =
        processor >= C3D_INTEL && processor <= C3D_MIPS ? (c3d_processor)processor : C3D_INTEL;
    int count = find_records(&f, record);
    switch (below(&f, 8)) {
    case 0: return LLVMFuzzerMutate(data, size, most);
    case 1: change_header(&f); break;
    case 2: change_sample(&f); break;
    case 3: f.size -= below(&f, (uint32_t)size / 8); break; // the end is lost
    default:
        if (count > 0)
            change_record(&f, record[below(&f, (uint32_t)count)]);
    }
    return f.size;
}
