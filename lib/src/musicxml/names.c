/// names.c: tables of words: instruments, dynamics, tempi, places, mallets, and of tunings.
///
/// A text is folded first: small letters, and a space for each - and each . and _ of an
/// instrument's name, so that "drum.bass-drum" of MusicXML's list of sounds and "Bass Drum" are
/// one. A word of a table counts where it begins a word of the text; the first row that does so is
/// an instrument, every row is an instruction, but of two that begin at one place the longer.
/// Tempi of words are those of metronomes' scales, rounded; no note depends on them where the file
/// has a number.
#include "musicxml/names.h"

#include "midi/part.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#define MOST_TEXT 256 // bytes of a text that are looked at

static const struct {
    const char *word;
    midi_choice choice;
    int key;
} instruments[] = {
    {"drum timbale", MIDI_DRUMS, 65}, {"high timbale", MIDI_DRUMS, 65},
    {"low timbale", MIDI_DRUMS, 66}, {"röhrenglocke", MIDI_ANY, 0}, {"tubular", MIDI_ANY, 0},
    {"schellen", MIDI_DRUMS, 54}, {"tambour de basque", MIDI_DRUMS, 54},
    {"tambourin", MIDI_DRUMS, 54}, {"tamburin", MIDI_DRUMS, 54}, {"tamburell", MIDI_DRUMS, 54},
    {"timp", MIDI_TIMPANI, 0}, {"pauk", MIDI_TIMPANI, 0}, {"kettle", MIDI_TIMPANI, 0},
    {"timbal", MIDI_TIMPANI, 0}, {"marimb", MIDI_MARIMBA, 0}, {"xyloph", MIDI_XYLOPHONE, 0},
    {"xylor", MIDI_XYLOPHONE, 0}, {"xilof", MIDI_XYLOPHONE, 0}, {"silof", MIDI_XYLOPHONE, 0},
    {"vibraph", MIDI_VIBRAPHONE, 0}, {"vibraf", MIDI_VIBRAPHONE, 0},
    {"glockensp", MIDI_GLOCKENSPIEL, 0}, {"jeu de timbres", MIDI_GLOCKENSPIEL, 0},
    {"campanelli", MIDI_GLOCKENSPIEL, 0}, {"orchestra bells", MIDI_GLOCKENSPIEL, 0},
    {"drum set", MIDI_DRUMS, MUSIC_NO_KEY}, {"drumset", MIDI_DRUMS, MUSIC_NO_KEY},
    {"drum kit", MIDI_DRUMS, MUSIC_NO_KEY}, {"drumkit", MIDI_DRUMS, MUSIC_NO_KEY},
    {"side stick", MIDI_DRUMS, 37}, {"cross stick", MIDI_DRUMS, 37}, {"rimshot", MIDI_DRUMS, 37},
    {"electric snare", MIDI_DRUMS, 40}, {"snare", MIDI_DRUMS, 38}, {"side drum", MIDI_DRUMS, 38},
    {"caisse claire", MIDI_DRUMS, 38}, {"kleine trommel", MIDI_DRUMS, 38},
    {"military drum", MIDI_DRUMS, 38}, {"militärtrommel", MIDI_DRUMS, 38},
    {"tambour", MIDI_DRUMS, 38}, {"tamburo", MIDI_DRUMS, 38}, {"rullante", MIDI_DRUMS, 38},
    {"cassa chiara", MIDI_DRUMS, 38}, {"kick", MIDI_DRUMS, 36},
    {"bass drum", MIDI_DRUMS, MIDI_BASS_DRUM}, {"grosse caisse", MIDI_DRUMS, MIDI_BASS_DRUM},
    {"große trommel", MIDI_DRUMS, MIDI_BASS_DRUM}, {"grosse trommel", MIDI_DRUMS, MIDI_BASS_DRUM},
    {"gran cassa", MIDI_DRUMS, MIDI_BASS_DRUM}, {"grancassa", MIDI_DRUMS, MIDI_BASS_DRUM},
    {"tam tam", MIDI_DRUMS, MIDI_TAM_TAM}, {"tamtam", MIDI_DRUMS, MIDI_TAM_TAM},
    {"gong", MIDI_DRUMS, MIDI_TAM_TAM}, {"open hi hat", MIDI_DRUMS, 46},
    {"hi hat open", MIDI_DRUMS, 46}, {"pedal hi hat", MIDI_DRUMS, 44},
    {"hi hat pedal", MIDI_DRUMS, 44}, {"hi hat", MIDI_DRUMS, 42}, {"hihat", MIDI_DRUMS, 42},
    {"charleston", MIDI_DRUMS, 42}, {"splash", MIDI_DRUMS, 55}, {"china", MIDI_DRUMS, 52},
    {"chinese", MIDI_DRUMS, 52}, {"ride bell", MIDI_DRUMS, 53}, {"ride", MIDI_DRUMS, 51},
    {"crash", MIDI_DRUMS, 49}, {"cymbal", MIDI_DRUMS, 49}, {"becken", MIDI_DRUMS, 49},
    {"piatt", MIDI_DRUMS, 49}, {"cinelli", MIDI_DRUMS, 49}, {"triang", MIDI_DRUMS, 81},
    {"low wood block", MIDI_DRUMS, 77}, {"wood block", MIDI_DRUMS, 76},
    {"woodblock", MIDI_DRUMS, 76}, {"holzblock", MIDI_DRUMS, 76}, {"bloc de bois", MIDI_DRUMS, 76},
    {"blocco di legno", MIDI_DRUMS, 76}, {"temple", MIDI_DRUMS, MIDI_TEMPLE_BLOCKS},
    {"tempelbl", MIDI_DRUMS, MIDI_TEMPLE_BLOCKS}, {"clave", MIDI_DRUMS, 75},
    {"cow bell", MIDI_DRUMS, 56}, {"cowbell", MIDI_DRUMS, 56}, {"kuhglocke", MIDI_DRUMS, 56},
    {"bells cowbell", MIDI_DRUMS, 56}, {"cencerro", MIDI_DRUMS, 56},
    {"campanacci", MIDI_DRUMS, 56}, {"cloche de vache", MIDI_DRUMS, 56},
    {"low agogo", MIDI_DRUMS, 68}, {"agogo", MIDI_DRUMS, 67}, {"low bongo", MIDI_DRUMS, 61},
    {"bongo", MIDI_DRUMS, 60}, {"mute high conga", MIDI_DRUMS, 62}, {"low conga", MIDI_DRUMS, 64},
    {"conga", MIDI_DRUMS, 63}, {"tumba", MIDI_DRUMS, 64}, {"low floor tom", MIDI_DRUMS, 41},
    {"floor tom", MIDI_DRUMS, 43}, {"standtom", MIDI_DRUMS, 43}, {"low mid tom", MIDI_DRUMS, 47},
    {"mid tom", MIDI_DRUMS, 47}, {"low tom", MIDI_DRUMS, 45}, {"high tom", MIDI_DRUMS, 50},
    {"tom", MIDI_DRUMS, 48}, {"castanet", MIDI_DRUMS, MIDI_NO_SOUND},
    {"kastagn", MIDI_DRUMS, MIDI_NO_SOUND}, {"maraca", MIDI_DRUMS, 70}, {"cabasa", MIDI_DRUMS, 69},
    {"guiro", MIDI_DRUMS, 73}, {"whip", MIDI_DRUMS, MIDI_NO_SOUND},
    {"peitsche", MIDI_DRUMS, MIDI_NO_SOUND}, {"fouet", MIDI_DRUMS, MIDI_NO_SOUND},
    {"frusta", MIDI_DRUMS, MIDI_NO_SOUND}, {"ratchet", MIDI_DRUMS, MIDI_NO_SOUND},
    {"drum", MIDI_DRUMS, MUSIC_NO_KEY}, {"schlagzeug", MIDI_DRUMS, MUSIC_NO_KEY},
    {"schlagwerk", MIDI_DRUMS, MUSIC_NO_KEY}, {"batteri", MIDI_DRUMS, MUSIC_NO_KEY},
    {"percuss", MIDI_DRUMS, MUSIC_NO_KEY}, {"perkuss", MIDI_DRUMS, MUSIC_NO_KEY},
    {"trommel", MIDI_DRUMS, 38},
};

/// A $ at the end: the whole word, not its beginning.
static const struct {
    const char *word;
    music_meaning meaning;
    double value;
} instructions[] = {
    {"l.v", MUSIC_RING, 1}, {"let ring", MUSIC_RING, 1}, {"laissez vibrer", MUSIC_RING, 1},
    {"laisser vibrer", MUSIC_RING, 1}, {"lasciar vibrare", MUSIC_RING, 1},
    {"lasciare vibrare", MUSIC_RING, 1}, {"klingen lassen", MUSIC_RING, 1},
    {"sempre secco", MUSIC_RING_ALWAYS, -1}, {"immer trocken", MUSIC_RING_ALWAYS, -1},
    {"toujours sec", MUSIC_RING_ALWAYS, -1}, {"secco", MUSIC_RING, -1}, {"damp", MUSIC_RING, -1},
    {"dämpf", MUSIC_RING, -1}, {"étouff", MUSIC_RING, -1}, {"etouff", MUSIC_RING, -1},
    {"soffoc", MUSIC_RING, -1}, {"trocken", MUSIC_RING, -1}, {"sec$", MUSIC_RING, -1},
    {"dry$", MUSIC_RING, -1}, {"in der mitte", MUSIC_SPOT, HIMC_SPOT_CENTER},
    {"mitte", MUSIC_SPOT, HIMC_SPOT_CENTER}, {"au centre", MUSIC_SPOT, HIMC_SPOT_CENTER},
    {"al centro", MUSIC_SPOT, HIMC_SPOT_CENTER}, {"nel centro", MUSIC_SPOT, HIMC_SPOT_CENTER},
    {"au milieu", MUSIC_SPOT, HIMC_SPOT_CENTER}, {"center", MUSIC_SPOT, HIMC_SPOT_CENTER},
    {"centre", MUSIC_SPOT, HIMC_SPOT_CENTER}, {"middle of", MUSIC_SPOT, HIMC_SPOT_CENTER},
    {"near rim", MUSIC_SPOT, HIMC_SPOT_RIM}, {"near the rim", MUSIC_SPOT, HIMC_SPOT_RIM},
    {"near edge", MUSIC_SPOT, HIMC_SPOT_RIM}, {"near the edge", MUSIC_SPOT, HIMC_SPOT_RIM},
    {"at the edge", MUSIC_SPOT, HIMC_SPOT_RIM}, {"am rand", MUSIC_SPOT, HIMC_SPOT_RIM},
    {"nahe am rand", MUSIC_SPOT, HIMC_SPOT_RIM}, {"au bord", MUSIC_SPOT, HIMC_SPOT_RIM},
    {"près du bord", MUSIC_SPOT, HIMC_SPOT_RIM}, {"vicino al bordo", MUSIC_SPOT, HIMC_SPOT_RIM},
    {"al bordo", MUSIC_SPOT, HIMC_SPOT_RIM}, {"sul bordo", MUSIC_SPOT, HIMC_SPOT_RIM},
    {"normal", MUSIC_SPOT, HIMC_SPOT_NORMAL}, {"ord.", MUSIC_SPOT, HIMC_SPOT_NORMAL},
    {"ordinario", MUSIC_SPOT, HIMC_SPOT_NORMAL}, {"gewöhnlich", MUSIC_SPOT, HIMC_SPOT_NORMAL},
    {"normale stelle", MUSIC_SPOT, HIMC_SPOT_NORMAL}, {"naturale", MUSIC_SPOT, HIMC_SPOT_NORMAL},
    {"wood$", MUSIC_MALLET, 3}, {"holz", MUSIC_MALLET, 3}, {"bois$", MUSIC_MALLET, 3},
    {"legno", MUSIC_MALLET, 3}, {"hard stick", MUSIC_MALLET, 2}, {"hard mallet", MUSIC_MALLET, 2},
    {"harte", MUSIC_MALLET, 2}, {"dures", MUSIC_MALLET, 2}, {"bacchette dure", MUSIC_MALLET, 2},
    {"medium stick", MUSIC_MALLET, 1}, {"medium mallet", MUSIC_MALLET, 1},
    {"felt", MUSIC_MALLET, 1}, {"filz", MUSIC_MALLET, 1}, {"feutre", MUSIC_MALLET, 1},
    {"feltro", MUSIC_MALLET, 1}, {"soft stick", MUSIC_MALLET, 0}, {"soft mallet", MUSIC_MALLET, 0},
    {"sponge", MUSIC_MALLET, 0}, {"schwamm", MUSIC_MALLET, 0}, {"weiche", MUSIC_MALLET, 0},
    {"éponge", MUSIC_MALLET, 0}, {"spugna", MUSIC_MALLET, 0}, {"molle", MUSIC_MALLET, 0},
    {"morbid", MUSIC_MALLET, 0}, {"doux", MUSIC_MALLET, 0}, {"senza sord", MUSIC_MUFFLE, 0},
    {"sans sourd", MUSIC_MUFFLE, 0}, {"ohne dämpfer", MUSIC_MUFFLE, 0},
    {"scoperto", MUSIC_MUFFLE, 0}, {"scoperti", MUSIC_MUFFLE, 0}, {"unmuffled", MUSIC_MUFFLE, 0},
    {"mute off", MUSIC_MUFFLE, 0}, {"découvert", MUSIC_MUFFLE, 0}, {"con sord", MUSIC_MUFFLE, 1},
    {"avec sourd", MUSIC_MUFFLE, 1}, {"mit dämpfer", MUSIC_MUFFLE, 1},
    {"coperto", MUSIC_MUFFLE, 1}, {"coperti", MUSIC_MUFFLE, 1}, {"muffled", MUSIC_MUFFLE, 1},
    {"gedeckt", MUSIC_MUFFLE, 1}, {"bedeckt", MUSIC_MUFFLE, 1}, {"couvert", MUSIC_MUFFLE, 1},
    {"voilé", MUSIC_MUFFLE, 1}, {"unmeasured", MUSIC_MEASURED, 0},
    {"misurato", MUSIC_MEASURED, 1}, {"measured", MUSIC_MEASURED, 1},
    {"mesuré", MUSIC_MEASURED, 1}, {"gemessen", MUSIC_MEASURED, 1},
    {"poco a poco cresc", MUSIC_GROWING, 1}, {"cresc", MUSIC_GROWING, 1},
    {"decresc", MUSIC_GROWING, -1}, {"dim.", MUSIC_GROWING, -1}, {"dimin", MUSIC_GROWING, -1},
    {"morendo", MUSIC_GROWING, -1}, {"tempo primo", MUSIC_TEMPO_BACK, 1},
    {"tempo i$", MUSIC_TEMPO_BACK, 1}, {"tempo 1$", MUSIC_TEMPO_BACK, 1},
    {"a tempo", MUSIC_TEMPO_BACK, 0}, {"im tempo", MUSIC_TEMPO_BACK, 0},
    {"au mouvement", MUSIC_TEMPO_BACK, 0}, {"au mouvt", MUSIC_TEMPO_BACK, 0},
    {"rit.", MUSIC_TEMPO_RAMP, 0.75}, {"riten", MUSIC_TEMPO_RAMP, 0.8},
    {"ritard", MUSIC_TEMPO_RAMP, 0.75}, {"rall", MUSIC_TEMPO_RAMP, 0.75},
    {"allarg", MUSIC_TEMPO_RAMP, 0.8}, {"cédez", MUSIC_TEMPO_RAMP, 0.85},
    {"ralent", MUSIC_TEMPO_RAMP, 0.75}, {"verbreitern", MUSIC_TEMPO_RAMP, 0.8},
    {"langsamer", MUSIC_TEMPO_RAMP, 0.8}, {"accel", MUSIC_TEMPO_RAMP, 1.25},
    {"stringendo", MUSIC_TEMPO_RAMP, 1.25}, {"schneller werden", MUSIC_TEMPO_RAMP, 1.25},
    {"pressez", MUSIC_TEMPO_RAMP, 1.2}, {"prestissimo", MUSIC_TEMPO_WORD, 200},
    {"presto", MUSIC_TEMPO_WORD, 184}, {"vivacissimo", MUSIC_TEMPO_WORD, 176},
    {"vivace", MUSIC_TEMPO_WORD, 160}, {"vivo$", MUSIC_TEMPO_WORD, 160},
    {"allegrissimo", MUSIC_TEMPO_WORD, 172}, {"allegretto", MUSIC_TEMPO_WORD, 112},
    {"allegro moderato", MUSIC_TEMPO_WORD, 116}, {"allegro", MUSIC_TEMPO_WORD, 132},
    {"moderato", MUSIC_TEMPO_WORD, 108}, {"andantino", MUSIC_TEMPO_WORD, 84},
    {"andante", MUSIC_TEMPO_WORD, 78}, {"adagietto", MUSIC_TEMPO_WORD, 72},
    {"adagio", MUSIC_TEMPO_WORD, 66}, {"larghetto", MUSIC_TEMPO_WORD, 63},
    {"largo", MUSIC_TEMPO_WORD, 50}, {"lento$", MUSIC_TEMPO_WORD, 52},
    {"grave", MUSIC_TEMPO_WORD, 40}, {"sehr langsam", MUSIC_TEMPO_WORD, 46},
    {"langsam", MUSIC_TEMPO_WORD, 54}, {"mäßig", MUSIC_TEMPO_WORD, 96},
    {"mässig", MUSIC_TEMPO_WORD, 96}, {"sehr schnell", MUSIC_TEMPO_WORD, 176},
    {"schnell", MUSIC_TEMPO_WORD, 152}, {"lebhaft", MUSIC_TEMPO_WORD, 144},
    {"bewegt", MUSIC_TEMPO_WORD, 116}, {"très lent", MUSIC_TEMPO_WORD, 46},
    {"lent$", MUSIC_TEMPO_WORD, 54}, {"modéré", MUSIC_TEMPO_WORD, 100},
    {"très vif", MUSIC_TEMPO_WORD, 176}, {"vif$", MUSIC_TEMPO_WORD, 152},
    {"rapide", MUSIC_TEMPO_WORD, 152}, {"d.c.", MUSIC_DA_CAPO, 0}, {"da capo", MUSIC_DA_CAPO, 0},
    {"d.s.", MUSIC_DAL_SEGNO, 0}, {"dal segno", MUSIC_DAL_SEGNO, 0}, {"to coda", MUSIC_TO_CODA, 0},
    {"alla coda", MUSIC_TO_CODA, 0},
};

// capital letters of ASCII and of Latin-1 in UTF-8
static void fold(char out[MOST_TEXT], const char *text, bool name)
{
    size_t length = 0;
    bool high = false;
    for (; *text && length < MOST_TEXT - 1; text++) {
        unsigned char c = (unsigned char)*text;
        if (high && c >= 0x80 && c <= 0x9e)
            c += 0x20;
        else if (c == '-' || isspace(c) || (name && (c == '.' || c == '_')))
            c = ' ';
        high = (unsigned char)*text == 0xc3;
        out[length++] = (char)(c < 0x80 ? tolower(c) : c);
    }
    out[length] = '\0';
}

static bool begins_word(const char *text, const char *at)
{
    unsigned char before = at > text ? (unsigned char)at[-1] : ' ';
    return !isalnum(before) && before < 0x80;
}

midi_choice himc_music_instrument(const char *name, int *key)
{
    char text[MOST_TEXT];
    fold(text, name, true);
    for (size_t i = 0; i < sizeof instruments / sizeof *instruments; i++)
        for (const char *at = text; (at = strstr(at, instruments[i].word)); at++)
            if (begins_word(text, at)) {
                *key = instruments[i].key;
                return instruments[i].choice;
            }
    *key = MUSIC_NO_KEY;
    return MIDI_ANY;
}

bool himc_music_dynamic(const char *name, music_meaning *meaning, double *value)
{
    static const char *const steps[] = {"ppp", "pp", "p", "mp", "mf", "f", "ff", "fff"};
    static const struct {
        const char *name;
        music_meaning meaning;
        int step; // of 7
    } others[] = {{"fp", MUSIC_FORTEPIANO, 2},   {"sfp", MUSIC_FORTEPIANO, 2},
                  {"sfpp", MUSIC_FORTEPIANO, 1}, {"pf", MUSIC_DYNAMIC, 4},
                  {"n", MUSIC_DYNAMIC, 0},       {"sf", MUSIC_ATTACK, 0},
                  {"sfz", MUSIC_ATTACK, 0},      {"sffz", MUSIC_ATTACK, 0},
                  {"fz", MUSIC_ATTACK, 0},       {"rf", MUSIC_ATTACK, 0},
                  {"rfz", MUSIC_ATTACK, 0},      {"sfzp", MUSIC_FORTEPIANO, 2}};
    *meaning = MUSIC_DYNAMIC;
    size_t length = strlen(name);
    if (length > 3 && length <= 6 && strspn(name, name[0] == 'p' ? "p" : "f") == length) {
        *value = name[0] == 'f';
        return true;
    }
    for (int i = 0; i < 8; i++)
        if (strcmp(name, steps[i]) == 0) {
            *value = i / 7.0;
            return true;
        }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(name, others[i].name) == 0) {
            *meaning = others[i].meaning;
            *value = others[i].step / 7.0;
            return true;
        }
    return false;
}

/// A pitch in words at `*at`, which moves behind it: "F", "b flat", "F#", German "fis" and "es",
/// French and Italian "fa", "si bémol". Its class (0 C .. 11), or -1. `german`: B is B flat, and H
/// is B.
static int read_pitch(const char **at, bool german)
{
    static const struct {
        const char *name;
        int pitch;
    } whole[] = {{"sol", 7}, {"do", 0}, {"ut", 0},  {"re", 2}, {"ré", 2}, {"mi", 4},
                 {"fa", 5},  {"la", 9}, {"si", 11}, {"as", 8}, {"es", 3}};
    static const int natural[] = {9, 11, 0, 2, 4, 5, 7, 11}; // a .. h
    static const struct {
        const char *name;
        int shift;
    } signs[] = {{"isis", 2}, {"is", 1},       {"es", -1},    {"#", 1},
                 {"♯", 1},    {"♭", -1},       {" flat", -1}, {" sharp", 1},
                 {"b", -1},   {" bémol", -1},  {" dièse", 1}, {" bemolle", -1},
                 {" moll", 0}};
    int pitch = -1;
    const char *p = *at;
    for (size_t i = 0; i < sizeof whole / sizeof *whole && pitch < 0; i++) {
        size_t length = strlen(whole[i].name);
        if (strncmp(p, whole[i].name, length) == 0 && !isalpha((unsigned char)p[length])) {
            pitch = whole[i].pitch;
            p += length;
        }
    }
    if (pitch < 0 && *p >= 'a' && *p <= 'h') {
        pitch = german && *p == 'b' ? 10 : natural[*p - 'a'];
        p++;
    }
    for (size_t i = 0; i < sizeof signs / sizeof *signs && pitch >= 0; i++)
        if (strncmp(p, signs[i].name, strlen(signs[i].name)) == 0) {
            pitch = (pitch + signs[i].shift + 12) % 12;
            p += strlen(signs[i].name);
            break;
        }
    if (pitch < 0 || isalpha((unsigned char)*p) || (unsigned char)*p >= 0x80)
        return -1;
    *at = p + strspn(p, "0123456789");
    return pitch;
}

// "muta in F", "change F to G", "C muta D", "G nach A umstimmen", "changez sol en la"
static int read_tunings(const char *text, int most, double *value)
{
    static const char *const tells[] = {"muta", "mutano", "change", "umstimmen", "stimmen",
                                        "tune", "retune", "cambia", "nach"};
    static const char *const joins[] = {"to", "in", "en", "nach", "auf", "muta", "->", "→"};
    bool told = false;
    for (size_t i = 0; i < sizeof tells / sizeof *tells; i++) {
        const char *at = strstr(text, tells[i]);
        told |= at && begins_word(text, at);
    }
    bool german = strstr(text, "stimm") || strstr(text, "nach ");
    int from = 12, count = 0;
    bool joined = false;
    for (const char *at = text; told && *at && count < most;) {
        at += strspn(at, " ,;:()");
        const char *word = at;
        int pitch = read_pitch(&at, german);
        if (pitch >= 0 && (joined || from < 12)) {
            value[count++] = 100 * from + pitch;
            from = 12;
            joined = false;
        } else if (pitch >= 0) {
            from = pitch;
        }
        if (pitch >= 0)
            continue;
        size_t length = strcspn(at, " ,;:()");
        for (size_t i = 0; i < sizeof joins / sizeof *joins; i++)
            joined |= strlen(joins[i]) == length && strncmp(word, joins[i], length) == 0;
        at += length;
    }
    return count;
}

int himc_music_words(const char *words, int most, music_meaning *meaning, double *value)
{
    char text[MOST_TEXT];
    int count = 0;
    fold(text, words, false);
    if (strcmp(text, "r") == 0 || strcmp(text, "l") == 0) {
        meaning[0] = MUSIC_HAND;
        value[0] = text[0] == 'r' ? HIMC_RIGHT : HIMC_LEFT;
        return 1;
    }
    if (himc_music_dynamic(text, &meaning[0], &value[0]))
        return 1;
    if (strcmp(text, "fine") == 0) {
        meaning[0] = MUSIC_FINE;
        return 1;
    }
    count = read_tunings(text, most, value);
    for (int i = 0; i < count; i++)
        meaning[i] = MUSIC_TUNING;
    const size_t rows = sizeof instructions / sizeof *instructions;
    for (const char *at = text; *at && count < most;) {
        size_t longest = 0, found = rows;
        for (size_t i = 0; i < rows && begins_word(text, at); i++) {
            size_t length = strcspn(instructions[i].word, "$");
            bool whole = instructions[i].word[length] == '$';
            if (length > longest && strncmp(at, instructions[i].word, length) == 0 &&
                !(whole && isalpha((unsigned char)at[length]))) {
                longest = length;
                found = i;
            }
        }
        if (found < rows) {
            meaning[count] = instructions[found].meaning;
            value[count++] = instructions[found].value;
        }
        at += longest > 0 ? longest : 1;
    }
    return count;
}
