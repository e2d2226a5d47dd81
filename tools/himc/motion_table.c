/// motion_table.c: a list of arrays, each a field of himc_motion_row with its shape, unit and name.
///
/// In a CSV an array is a column for each item (hand, joint, segment) and component, named
/// item_what_component_unit; in a NumPy file it is one array, rows first, named group_unit. A
/// storage file of OpenSim has the CSV's columns. In a C3D places are points, all other columns
/// are analog channels, one sample a frame.
#define _POSIX_C_SOURCE 200809L // strtok_r
#include "motion_table.h"
#include "npz.h"

#include "capture/take.h"
#include "himc/body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef enum per { PER_ROW, PER_HAND, PER_JOINT, PER_SEGMENT } per;

typedef struct array {
    const char *group; ///< in `--columns`; arrays of a group follow each other
    const char *name;  ///< in a NumPy file
    per per;
    const char *what; ///< in a CSV, after the item's name
    int components;   ///< 1, 3 (x y z) or 4 (w x y z)
    const char *unit; ///< "" for none
    size_t offset;    ///< in himc_motion_row
    int decimals;     ///< in a CSV; 0: 12 significant digits
    bool usual;       ///< without --columns
    const char *is;
} array;

#define AT(field) offsetof(himc_motion_row, field)
#define WORK "since the rows began"

static const array arrays[] = {
    {"targets", "targets", PER_HAND, "_target", 3, "m", AT(target), 8, true,
     "wanted place of the stick's tip"},
    {"tips", "tips", PER_HAND, "_tip", 3, "m", AT(tip), 8, true,
     "place of the stick's tip, the mallet's centre"},
    {"joints", "joints", PER_JOINT, "", 3, "rad", AT(joint), 8, true,
     "rotation vector of the child in the parent's frame"},
    {"forces", "forces", PER_HAND, "_force", 1, "n", AT(force), 4, true,
     "largest contact force since the last row"},
    {"elbows", "elbows", PER_HAND, "_elbow", 3, "m", AT(elbow), 8, true, "place of the elbow"},
    {"limits", "limits", PER_JOINT, "_limit", 1, "", AT(limit), 4, true,
     "joint limits: 0 centre, 1 bound, more beyond; 0 without limits"},
    {"quaternions", "quaternions", PER_JOINT, "_q", 4, "", AT(rotation), 0, false,
     "the same rotation as `joints`, as unit quaternion"},
    {"rates", "rates", PER_JOINT, "_rate", 3, "rad_s", AT(rate), 0, false,
     "angular velocity of the child less the parent's"},
    {"accelerations", "accelerations", PER_JOINT, "_acceleration", 3, "rad_s2", AT(acceleration), 0,
     false, "time derivative of `rates` under this row's forces"},
    {"torques", "torques", PER_JOINT, "_torque", 3, "n_m", AT(torque), 0, false,
     "on the child; its opposite acts on the parent"},
    {"powers", "powers", PER_JOINT, "_power", 1, "w", AT(power), 0, false, "torque times rate"},
    {"work", "work", PER_JOINT, "_work", 1, "j", AT(energy.joint), 0, false,
     "work of the torque " WORK},
    {"segments", "segments", PER_SEGMENT, "_position", 3, "m", AT(segment), 0, false,
     "origin, its joint to the parent"},
    {"segments", "orientations", PER_SEGMENT, "_q", 4, "", AT(orientation), 0, false,
     "orientation of the segment, unit quaternion"},
    {"centers", "centers", PER_SEGMENT, "_center", 3, "m", AT(center), 0, false,
     "centre of mass of the segment"},
    {"speeds", "target_velocities", PER_HAND, "_target_velocity", 3, "m_s", AT(target_velocity), 0,
     false, "velocity of the target"},
    {"speeds", "tip_velocities", PER_HAND, "_tip_velocity", 3, "m_s", AT(tip_velocity), 0, false,
     "velocity of the tip"},
    {"contact", "tip_forces", PER_HAND, "_tip_force", 3, "n", AT(tip_force), 0, false,
     "force of the head on the body's stick, mean of this row's physics step"},
    {"contact", "mallet_forces", PER_HAND, "_mallet_force", 3, "n", AT(mallet_force), 0, false,
     "and on the mallet's mass beyond the body's stick"},
    {"contact", "impulses", PER_HAND, "_impulse", 1, "n_s", AT(impulse), 0, false,
     "impulse of the head on the stick since the last row"},
    {"contact", "felt", PER_HAND, "_felt", 1, "j", AT(energy.felt), 0, false,
     "energy stored in the mallet's felt"},
    {"contact", "heads", PER_ROW, "heads", 1, "j", AT(energy.heads), 0, false,
     "energy of all heads in vibration"},
    {"contact", "lost", PER_ROW, "lost", 1, "j", AT(energy.lost), 0, false,
     "energy lost in heads and felt"},
    {"pushes", "pushes", PER_SEGMENT, "_push", 3, "n", AT(push), 0, false,
     "force of the command push"},
    {"pushes", "push_points", PER_SEGMENT, "_push_at", 3, "m", AT(push_at), 0, false,
     "where it acts; without a push the centre of mass"},
    {"errors", "tip_errors", PER_HAND, "_error", 3, "m", AT(tip_error), 0, false,
     "tip less target"},
    {"errors", "joint_errors", PER_JOINT, "_error", 1, "rad", AT(joint_error), 0, false,
     "angle to the joint's own target"},
    {"null-space", "null_space", PER_HAND, "_null_space", 1, "", AT(null_space), 0, false,
     "share of the arm's squared joint rates that moves no tip, 0 .. 1"},
    {"co-contraction", "co_contraction", PER_JOINT, "_co_contraction", 1, "", AT(co_contraction), 0,
     false, "torque of co-contraction over the strength; 0 with `strength off`"},
    {"root", "root_force", PER_ROW, "root_force", 3, "n", AT(root_force), 0, false,
     "force of the world on the pelvis, mean since the last row"},
    {"root", "root_moment", PER_ROW, "root_moment", 3, "n_m", AT(root_moment), 0, false,
     "and its moment about the midpoint of the hip joints"},
    {"root", "root_center", PER_ROW, "root_center", 3, "m", AT(root_center), 0, false,
     "centre of pressure on the seat's plane (standing: the floor); NaN without a force upwards"},
    {"root", "root_friction", PER_ROW, "root_friction", 1, "", AT(root_friction), 0, false,
     "friction needed: horizontal over vertical force; likewise"},
    {"root", "seat_force", PER_ROW, "seat_force", 3, "n", AT(seat_force), 0, false,
     "force of the stool, mean since the last row; 0 with `stance fixed`"},
    {"root", "foot_forces", PER_HAND, "_foot_force", 3, "n", AT(foot_force), 0, false,
     "force of the floor on the foot of that side; likewise"},
    {"energy", "kinetic", PER_ROW, "kinetic", 1, "j", AT(energy.kinetic), 0, false,
     "kinetic energy of the body"},
    {"energy", "potential", PER_ROW, "potential", 1, "j", AT(energy.potential), 0, false,
     "potential energy of the body over the floor"},
    {"energy", "contact_work", PER_HAND, "_contact_work", 1, "j", AT(energy.contact), 0, false,
     "work of the head on the body's stick " WORK},
    {"energy", "mallet", PER_HAND, "_mallet", 1, "j", AT(energy.mallet), 0, false,
     "work on the mallet's mass beyond it " WORK},
    {"energy", "push_work", PER_ROW, "push_work", 1, "j", AT(energy.push), 0, false,
     "work of the command push " WORK},
    {"energy", "support_work", PER_ROW, "support_work", 1, "j", AT(energy.support), 0, false,
     "work of seat and floor " WORK},
    {"energy", "placed", PER_ROW, "placed", 1, "j", AT(energy.placed), 0, false,
     "given to the body by putting it elsewhere " WORK},
    {"energy", "numerical", PER_ROW, "numerical", 1, "j", AT(energy.numerical), 0, false,
     "given to the body by the integrator " WORK},
};
#define ARRAYS (sizeof arrays / sizeof *arrays)

struct motion_table {
    FILE *stream;
    motion_table_format format;
    bool failed;
    bool has[ARRAYS];
    double *data; ///< row after row; unused for a CSV
    size_t rows, room, width;
};

static int items(const array *a)
{
    static const int count[] = {1, HIMC_HANDS, HIMC_JOINTS, HIMC_SEGMENTS};
    return count[a->per];
}

static const char *item_name(per p, int item)
{
    return p == PER_HAND      ? himc_hand_name((himc_hand)item)
           : p == PER_JOINT   ? himc_joint_name(item)
           : p == PER_SEGMENT ? himc_segment_name(item)
                              : "";
}

static size_t size_of(const array *a)
{
    return (size_t)(items(a) * a->components);
}

static const double *values(const array *a, const himc_motion_row *row)
{
    const void *field = (const char *)row + a->offset;
    return field;
}

motion_table_format motion_table_format_of(const char *path)
{
    const char *dot = path ? strrchr(path, '.') : NULL;
    return !dot                                                   ? MOTION_TABLE_CSV
           : !strcasecmp(dot, ".npz")                             ? MOTION_TABLE_NUMPY
           : !strcasecmp(dot, ".c3d")                             ? MOTION_TABLE_C3D
           : !strcasecmp(dot, ".sto") || !strcasecmp(dot, ".mot") ? MOTION_TABLE_STORAGE
                                                                  : MOTION_TABLE_CSV;
}

// the groups of a list; false if one is unknown
static bool choose(motion_table *t, const char *columns, himc_error *error)
{
    char words[1024], *rest = NULL;
    if (columns && (size_t)snprintf(words, sizeof words, "%s", columns) >= sizeof words)
        return himc_error_set(error, "--columns: more than %zu characters", sizeof words - 1);
    for (size_t i = 0; !columns && i < ARRAYS; i++)
        t->has[i] = arrays[i].usual;
    bool any = !columns;
    for (char *word = columns ? strtok_r(words, ",", &rest) : NULL; word;
         word = strtok_r(NULL, ",", &rest)) {
        bool known = false, all = !strcmp(word, "all"), usual = !strcmp(word, "usual");
        for (size_t i = 0; i < ARRAYS; i++)
            if (all || (usual && arrays[i].usual) || !strcmp(word, arrays[i].group))
                t->has[i] = known = true;
        if (!known)
            return himc_error_set(error,
                                  "--columns: \"%s\", expected all, usual or groups of "
                                  "`himc render --columns help`",
                                  word);
        any = true;
    }
    return any || himc_error_set(error, "--columns: no group (himc render --columns help)");
}

// of a column without its unit
static void column_name(const array *a, int item, int k, char out[48])
{
    const char *part = a->components == 4 ? &"wxyz"[k] : a->components == 3 ? &"xyz"[k] : "";
    snprintf(out, 48, "%s%s%s%.1s", item_name(a->per, item), a->what, a->components == 3 ? "_" : "",
             part);
}

static void write_header(const motion_table *t, const char *time, char between)
{
    char name[48];
    fputs(time, t->stream);
    for (size_t i = 0; i < ARRAYS; i++)
        for (int item = 0; t->has[i] && item < items(&arrays[i]); item++)
            for (int k = 0; k < arrays[i].components; k++) {
                column_name(&arrays[i], item, k, name);
                fprintf(t->stream, "%c%s%s%s", between, name, arrays[i].unit[0] ? "_" : "",
                        arrays[i].unit);
            }
    fputc('\n', t->stream);
}

static bool is_place(const array *a)
{
    return a->components == 3 && !strcmp(a->unit, "m");
}

// points or analog channels of an array in a C3D
static int labels(const array *a)
{
    return items(a) * (is_place(a) ? 1 : a->components);
}

// count[0]: the channels of a C3D, count[1]: its points
static bool check_labels(const motion_table *t, int count[2], himc_error *error)
{
    count[0] = count[1] = 0;
    for (size_t i = 0; i < ARRAYS; i++)
        count[is_place(&arrays[i])] += t->has[i] ? labels(&arrays[i]) : 0;
    if (!count[1])
        return himc_error_set(error, "--columns: no places, expected in a .c3d some of targets,"
                                     "tips,elbows,segments,centers,pushes,errors");
    return count[0] <= HIMC_C3D_LABELS ||
           himc_error_set(error, "--columns: %d values beside places, expected up to %d in a .c3d",
                          count[0], HIMC_C3D_LABELS);
}

motion_table *motion_table_new(FILE *stream, motion_table_format format, const char *columns,
                               himc_error *error)
{
    motion_table *t = calloc(1, sizeof *t);
    if (!t) {
        himc_error_set(error, "out of memory");
        return NULL;
    }
    t->stream = stream;
    t->format = format;
    int count[2];
    if (!choose(t, columns, error) ||
        (format == MOTION_TABLE_C3D && !check_labels(t, count, error))) {
        free(t);
        return NULL;
    }
    t->width = 1;
    for (size_t i = 0; i < ARRAYS; i++)
        t->width += t->has[i] ? size_of(&arrays[i]) : 0;
    if (format == MOTION_TABLE_CSV)
        write_header(t, "time_s", ',');
    return t;
}

static void print_row(const motion_table *t, const himc_motion_row *row)
{
    fprintf(t->stream, "%.6f", row->time);
    for (size_t i = 0; i < ARRAYS; i++)
        for (size_t k = 0; t->has[i] && k < size_of(&arrays[i]); k++) {
            double value = values(&arrays[i], row)[k];
            if (arrays[i].decimals)
                fprintf(t->stream, ",%.*f", arrays[i].decimals, value);
            else
                fprintf(t->stream, ",%.12g", value);
        }
    fputc('\n', t->stream);
}

static void keep_row(motion_table *t, const himc_motion_row *row)
{
    if (t->rows == t->room) {
        size_t room = t->room ? 2 * t->room : 1024;
        double *data = t->failed ? NULL : realloc(t->data, room * t->width * sizeof *data);
        if (!data) {
            t->failed = true;
            return;
        }
        t->data = data;
        t->room = room;
    }
    double *to = t->data + t->rows++ * t->width;
    *to++ = row->time;
    for (size_t i = 0; i < ARRAYS; i++)
        if (t->has[i]) {
            memcpy(to, values(&arrays[i], row), size_of(&arrays[i]) * sizeof *to);
            to += size_of(&arrays[i]);
        }
}

void motion_table_row(motion_table *t, const himc_motion_row *row)
{
    if (t->format == MOTION_TABLE_CSV)
        print_row(t, row);
    else
        keep_row(t, row);
}

// `width` columns from `from` on, gathered into `out`, as an array with that shape in each row
static void add_columns(const motion_table *t, npz *file, const array *a, size_t from, double *out)
{
    size_t width = a ? size_of(a) : 1, shape[NPZ_DIMENSIONS] = {t->rows};
    int dimensions = 1;
    char name[48] = "time_s";
    for (size_t row = 0; row < t->rows; row++)
        memcpy(out + row * width, t->data + row * t->width + from, width * sizeof *out);
    if (a && a->per != PER_ROW)
        shape[dimensions++] = (size_t)items(a);
    if (a && a->components > 1)
        shape[dimensions++] = (size_t)a->components;
    if (a)
        snprintf(name, sizeof name, "%s%s%s", a->name, a->unit[0] ? "_" : "", a->unit);
    npz_add(file, name, out, 0, shape, dimensions);
}

#define NAME_WIDTH 24 // of the names of hands, joints and segments in a NumPy file

static void add_names(npz *file, const char *name, per p, size_t count)
{
    char texts[HIMC_SEGMENTS][NAME_WIDTH] = {{0}};
    for (size_t i = 0; i < count; i++)
        snprintf(texts[i], NAME_WIDTH, "%s", item_name(p, (int)i));
    npz_add(file, name, texts, NAME_WIDTH, &count, 1);
}

// OpenSim's header says how many rows and columns follow
static bool write_storage(const motion_table *t, himc_error *error)
{
    if (t->failed)
        return himc_error_set(error, "out of memory for the rows of a storage file");
    fprintf(t->stream, "himc motion\nversion=1\nnRows=%zu\nnColumns=%zu\ninDegrees=no\nendheader\n",
            t->rows, t->width);
    write_header(t, "time", '\t');
    for (size_t i = 0; i < t->rows * t->width; i++) {
        double value = t->data[i];
        if (isnan(value))
            fputs("NaN", t->stream); // printf may give it a sign
        else
            fprintf(t->stream, "%.12g", value);
        fputc((i + 1) % t->width ? '\t' : '\n', t->stream);
    }
    return true;
}

// "m/s" for "m_s"
static void unit_text(const char *unit, char out[24])
{
    static const char *const known[][2] = {
        {"n_m", "N m"}, {"n_s", "N s"}, {"m_s", "m/s"}, {"rad_s", "rad/s"}, {"rad_s2", "rad/s^2"},
        {"n", "N"},     {"w", "W"},     {"j", "J"},     {"", "1"}};
    snprintf(out, 24, "%s", unit);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (!strcmp(unit, known[i][0]))
            snprintf(out, 24, "%s", known[i][1]);
}

// an array's columns of all rows, from column `from` on, as points or as channels; `next` is the
// number of points or channels before
static void add_to_take(const motion_table *t, himc_take *take, const array *a, size_t from,
                        int next)
{
    char name[48], unit[24];
    unit_text(a->unit, unit);
    for (int i = 0; i < (int)size_of(a); i++) {
        column_name(a, i / a->components, i % a->components, name);
        if (!is_place(a))
            snprintf(take->analog_names[next + i], TAKE_NAME, "%s (%.8s)", name, unit);
        else if (i % 3 == 0) // without "_x"
            himc_take_set_name(take, next + i / 3, name, strlen(name) - 2);
    }
    for (size_t row = 0; row < t->rows; row++) {
        const double *value = t->data + row * t->width + from;
        if (is_place(a))
            memcpy(himc_take_at(take, (int)row, next), value, size_of(a) * sizeof *value);
        else
            memcpy(take->analog + row * (size_t)take->analog_channels + next, value,
                   size_of(a) * sizeof *value);
    }
}

static bool write_c3d(const motion_table *t, himc_error *error)
{
    int count[2];
    if (!check_labels(t, count, error))
        return false;
    if (!t->failed && t->rows < 2)
        return himc_error_set(error, "--motion: %zu rows, expected 2 in a .c3d", t->rows);
    himc_take *take = t->failed ? NULL : calloc(1, sizeof *take);
    if (!take)
        return himc_error_set(error, "out of memory for the rows of a .c3d");
    snprintf(take->file, sizeof take->file, "--motion");
    double rate = (double)(t->rows - 1) / (t->data[(t->rows - 1) * t->width] - t->data[0]);
    bool good = himc_take_allocate(take, rate, (int)t->rows, count[1], false, error);
    take->analog_rate = rate;
    take->analog_channels = count[0];
    take->analog_samples = (int)t->rows;
    take->analog_names = calloc((size_t)count[0] + 1, sizeof *take->analog_names);
    take->analog = calloc(t->rows * (size_t)count[0] + 1, sizeof *take->analog);
    good = good && ((take->analog_names && take->analog) || himc_error_set(error, "out of memory"));
    count[0] = count[1] = 0;
    for (size_t i = 0, from = 1; i < ARRAYS && good; i++) {
        const array *a = &arrays[i];
        if (!t->has[i])
            continue;
        add_to_take(t, take, a, from, count[is_place(a)]);
        count[is_place(a)] += labels(a);
        from += size_of(a);
    }
    good = good && himc_c3d_write(t->stream, take, error);
    himc_take_free(take);
    return good;
}

bool motion_table_end(motion_table *t, himc_error *error)
{
    if (t->format == MOTION_TABLE_CSV)
        return true;
    if (t->format == MOTION_TABLE_C3D)
        return write_c3d(t, error);
    if (t->format == MOTION_TABLE_STORAGE)
        return write_storage(t, error);
    size_t widest = 1, from = 1;
    for (size_t i = 0; i < ARRAYS; i++)
        widest = t->has[i] && size_of(&arrays[i]) > widest ? size_of(&arrays[i]) : widest;
    double *out = t->failed ? NULL : malloc((t->rows + 1) * widest * sizeof *out);
    if (!out)
        return himc_error_set(error, "out of memory for the rows of an .npz");
    npz file = {.stream = t->stream};
    add_names(&file, "hands", PER_HAND, HIMC_HANDS);
    add_names(&file, "joint_names", PER_JOINT, HIMC_JOINTS);
    add_names(&file, "segment_names", PER_SEGMENT, HIMC_SEGMENTS);
    add_columns(t, &file, NULL, 0, out);
    for (size_t i = 0; i < ARRAYS; i++)
        if (t->has[i]) {
            add_columns(t, &file, &arrays[i], from, out);
            from += size_of(&arrays[i]);
        }
    free(out);
    return npz_end(&file, error);
}

void motion_table_free(motion_table *t)
{
    if (t)
        free(t->data);
    free(t);
}

void motion_table_help(FILE *stream, bool markdown)
{
    static const char *const each[] = {"", "each hand's", "each joint's", "each segment's"};
    static const char *const shape[] = {"", "2, ", "19, ", "20, "};
    const char *last = "";
    fputs(markdown ? "| group | in an .npz | shape of a row | in a CSV | |\n|---|---|---|---|---|\n"
                   : "groups for --columns; a * is in the usual table\n",
          stream);
    for (size_t i = 0; i < ARRAYS; i++) {
        const array *a = &arrays[i];
        char unit[24], first[24];
        unit_text(a->unit, unit);
        snprintf(first, sizeof first, "%s%s", strcmp(a->group, last) ? a->group : "",
                 a->usual && strcmp(a->group, last) ? "*" : "");
        if (markdown)
            fprintf(stream, "| `%s`%s | `%s%s%s` | (%s%d) | `%s%s%s%s%s` | %s |\n", a->group,
                    a->usual ? " \\*" : "", a->name, a->unit[0] ? "_" : "", a->unit, shape[a->per],
                    a->components, a->per == PER_ROW ? "" : "ITEM", a->what,
                    a->components == 4   ? "w"
                    : a->components == 3 ? "_x"
                                         : "",
                    a->unit[0] ? "_" : "", a->unit, a->is);
        else
            fprintf(stream, "  %-15s %s %s (%s)\n", first, each[a->per], a->is, unit);
        last = a->group;
    }
}
