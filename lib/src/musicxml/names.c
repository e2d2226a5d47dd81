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
#include "musicxml/phrases.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define MOST_TEXT 256 // bytes of a text that are looked at

// words of a row stand between |; = before them: beside it a name has numbers and fillers alone

static const struct {
    const char *words;
    midi_choice choice;
    int key;
} instruments[] = {
    // what begins as another one comes first
    {"drum timbale|high timbale", MIDI_DRUMS, 65},
    {"low timbale", MIDI_DRUMS, 66},
    {"wind chime|bar chime|mark tree|bell tree|hand chime|anvil|amboss|enclume|incudine|yunque|"
     "sleigh|crotal|antique cymb|cymbales ant|finger cymb|cymbal finger|cymbales dig|zimbeln|"
     "thunder|donnerbl|brake|log drum|cajon|cajón|rute$|castan|castag|castañ|kastagn|nacchere|"
     "lion|löwengebr|waldteufel|rahmentrommel|holztrommel|gong drum|gongtrommel|cymbalom",
     MIDI_DRUMS, MIDI_NO_SOUND},
    {"röhrenglocke|tubular|glocken$|chimes", MIDI_TUBULAR_BELL, 0},
    {"schellentr|schellenr|schellenk|tambour de basque|tamburo basco|tambourin|tamburin|tamburell|"
     "pandereta",
     MIDI_DRUMS, 54},
    {"tenor drum|tenortrommel|rührtrommel|wirbeltrommel|rolltrommel|caisse roulante|cassa rullante|"
     "tamburo rullante",
     MIDI_DRUMS, 45},
    {"timp|pauk|kettle|timbal", MIDI_TIMPANI, 0},
    {"marimb|mar$|mba$", MIDI_MARIMBA, 0},
    {"xyl|xil$|xilof|silof", MIDI_XYLOPHONE, 0},
    {"vibraph|vibraf|vib$|vibes", MIDI_VIBRAPHONE, 0},
    {"glockensp|glsp|glock$|jeu de timbres|campanelli|orchestra bells", MIDI_GLOCKENSPIEL, 0},
    {"drum set|drumset|drum kit|drumkit", MIDI_DRUMS, MUSIC_NO_KEY},
    {"side stick|cross stick|crossstick", MIDI_DRUMS, 37},
    {"electric snare|rimshot|rim shot", MIDI_DRUMS, 40},
    {"snare|side drum|caisse claire|kleine trommel|kl trommel|kl tr$|military drum|"
     "militärtrommel|field drum|parade drum|tambour militaire|tamburo militare|basler trommel|"
     "rullante|cassa chiara|s d$",
     MIDI_DRUMS, 38},
    {"kick|acoustic bass drum|bass drum 1", MIDI_DRUMS, 36},
    {"bass drum|grosse caisse|große trommel|grosse trommel|gr trommel|gr tr$|gran cassa|grancassa|"
     "gr c$|b d$",
     MIDI_DRUMS, MIDI_BASS_DRUM},
    {"tam tam|tamtam|gong", MIDI_DRUMS, MIDI_TAM_TAM},
    {"open hi hat|hi hat open|hi hat (open|hi hat half|half open hi hat", MIDI_DRUMS, 46},
    {"pedal hi hat|hi hat pedal|hi hat (pedal|foot hi hat|hi hat foot|hi hat (foot", MIDI_DRUMS,
     44},
    {"hi hat|hihat|charleston", MIDI_DRUMS, 42},
    {"splash", MIDI_DRUMS, 55},
    {"china$|china cym|china type|china beck|chinabeck|chinese cym", MIDI_DRUMS, 52},
    {"ride bell", MIDI_DRUMS, 53},
    {"ride", MIDI_DRUMS, 51},
    {"crash|cym|bck$|becken|piatt|cinelli", MIDI_DRUMS, 49},
    {"triang|trgl|tri$", MIDI_DRUMS, 81},
    {"low wood block", MIDI_DRUMS, 77},
    {"wood block|woodblock|holzblock|bloc de bois|blocco di legno", MIDI_DRUMS, 76},
    {"second temple block", MIDI_DRUMS, MIDI_LOW_TEMPLE_BLOCK + 1},
    {"third temple block", MIDI_DRUMS, MIDI_LOW_TEMPLE_BLOCK + 2},
    {"fourth temple block", MIDI_DRUMS, MIDI_LOW_TEMPLE_BLOCK + 3},
    {"temple bl|templebl|tempelbl|blocs chinois", MIDI_DRUMS, MIDI_TEMPLE_BLOCKS},
    {"clave$|claves", MIDI_DRUMS, 75},
    {"cow bell|cowbell|kuhglocke|bells cowbell|cencerro|campanacci|cloche de vache", MIDI_DRUMS,
     56},
    {"cloches de v|cloches de t", MIDI_DRUMS, 56},
    {"campane|cloches|chim$|tub bell|tub b$|t bells", MIDI_TUBULAR_BELL, 0},
    {"glk$", MIDI_GLOCKENSPIEL, 0},
    {"g c$|b dr$|bs dr$", MIDI_DRUMS, MIDI_BASS_DRUM},
    {"sn dr$|sn d$|sn$", MIDI_DRUMS, 38},
    {"tamb$", MIDI_DRUMS, 54},
    {"hängebeck|hängendes beck", MIDI_DRUMS, 49},
    {"low agogo", MIDI_DRUMS, 68},
    {"agogo", MIDI_DRUMS, 67},
    {"low bongo", MIDI_DRUMS, 61},
    {"bongo", MIDI_DRUMS, 60},
    {"mute high conga", MIDI_DRUMS, 62},
    {"low conga", MIDI_DRUMS, 64},
    {"conga", MIDI_DRUMS, 63},
    {"tumba", MIDI_DRUMS, 64},
    {"low floor tom", MIDI_DRUMS, 41},
    {"floor tom|standtom", MIDI_DRUMS, 43},
    {"low mid tom|mid tom", MIDI_DRUMS, 47},
    {"low tom", MIDI_DRUMS, 45},
    {"high tom", MIDI_DRUMS, 50},
    {"tom", MIDI_DRUMS, 48},
    {"maraca|rumba|rassel", MIDI_DRUMS, 70},
    {"cabasa", MIDI_DRUMS, 69},
    {"guiro", MIDI_DRUMS, 73},
    {"whip|slapstick|slap stick|peitsche|klappholz|fouet|frusta|látigo|latigo|ratchet|ratsche|"
     "crécelle|raganella|carraca",
     MIDI_DRUMS, MIDI_NO_SOUND},
    {"schlagwerk|percuss|perkuss|perc$", MIDI_DRUMS, MUSIC_ANY_KEY},
    {"schlagzeug|batteri", MIDI_DRUMS, MUSIC_NO_KEY},
    {"=drum", MIDI_DRUMS, MUSIC_NO_KEY},
    {"=trommel|tambour$|tamburo$", MIDI_DRUMS, 38},
};

static const char fillers[] = "drum|group|set$|kit$|part|player|spieler|solo|jazz|rock|pop$|funk|"
                              "latin|studio|acoustic|electr|standard|multi|concert|orchest|pad|"
                              "machine|e$|v$|i$|ii$|iii$|iv$|and$|und$|et$";

// what programs call the instruments of their samplers
static const char programs[] =
    "smartmusic|aria$|midi|general|gm$|instrument|standard|player|"
    "channel|unnamed|part$|track|sibelius|kontakt|garritan|hs$|noteperf|muse|"
    "vst|stave|staff";

/// Of one sort from high to low, by the key of a name that does not say which; `low`: the index of
/// a name that says low.
static const struct {
    int key, count, low, keys[5];
} sorts[] = {
    {48, 5, 2, {50, 48, 45, 43, 41}},
    {76, 3, 2, {76, MIDI_MIDDLE_BLOCK, 77}},
    {MIDI_TEMPLE_BLOCKS,
     5,
     4,
     {MIDI_LOW_TEMPLE_BLOCK + 4, MIDI_LOW_TEMPLE_BLOCK + 3, MIDI_LOW_TEMPLE_BLOCK + 2,
      MIDI_LOW_TEMPLE_BLOCK + 1, MIDI_LOW_TEMPLE_BLOCK}},
    {56, 3, 2, {MIDI_HIGH_COWBELL, 56, MIDI_LOW_COWBELL}},
    {60, 2, 1, {60, 61}},
    {63, 2, 1, {63, 64}},
    {65, 2, 1, {65, 66}},
    {67, 2, 1, {67, 68}},
};

static const char *const degrees[] = {
    "high|hi$|small|klein|hoch|hohe|hell|aigu|haut|petit|acut|piccol",
    "mid|medium|mittel|mittler|moyen|médium|medio|media",
    "low|lo$|large|big|groß|gross|tief|grave|bas$|basse$|grand|grosse|grosso|basso|bassa"};

/// A $ at the end: the whole word, not its beginning.
static const struct {
    const char *words;
    music_meaning meaning;
    double value;
} instructions[] = {
    {"l.v|let ring|laissez vibrer|laisser vibrer|lasciar vibrare|lasciare vibrare|"
     "klingen lassen",
     MUSIC_RING, 1},
    {"sempre l.v|l.v. sempre|laissez toujours vibrer|lasciar sempre vibrare|immer klingen lassen",
     MUSIC_RING_ALWAYS, 1},
    {"sempre secco|immer trocken|toujours sec", MUSIC_RING_ALWAYS, -1},
    {"secco|damp|dämpf|étouff|etouff|soffoc|trocken|sec$|dry$|choke|abstopp|stoppato", MUSIC_RING,
     -1},
    {"in der mitte|mitte|au centre|al centro|nel centro|au milieu|center|centre|"
     "middle of",
     MUSIC_SPOT, HIMC_SPOT_CENTER},
    {"bell$|on bell|on the bell|bell of|kuppe|auf der kuppe|sur le dôme|sulla cupola|cupola",
     MUSIC_SPOT, HIMC_SPOT_CENTER},
    {"near rim|near the rim|near edge|near the edge|at the edge|am rand|nahe am rand|"
     "au bord|près du bord|vicino al bordo|al bordo|sul bordo",
     MUSIC_SPOT, HIMC_SPOT_RIM},
    {"normal|ord.|ordinario|gewöhnlich|normale stelle|naturale|on head|on the head|auf dem fell|"
     "sur la peau|sulla pelle",
     MUSIC_SPOT, HIMC_SPOT_NORMAL},
    {"rim shot|rimshot|r.s.", MUSIC_SPOT_HERE, HIMC_SPOT_RIMSHOT},
    {"rim shots|rimshots", MUSIC_SPOT, HIMC_SPOT_RIMSHOT},
    {"cross stick|side stick|rim$|on rim|on the rim|auf dem rand|sur le cercle|sul cerchio",
     MUSIC_SPOT, HIMC_SPOT_CROSSSTICK},
    {"shell|on shell|on the shell|zarge|auf der zarge|sur le fût|sul fusto", MUSIC_SPOT,
     HIMC_SPOT_SHELL},
    {"stick click|click sticks", MUSIC_SPOT_HERE, HIMC_SPOT_CLICK},
    {"wood$|holz|bois$|legno", MUSIC_MALLET, 3},
    {"hard stick|hard mallet|harte|dures|bacchette dure", MUSIC_MALLET, 2},
    {"medium stick|medium mallet|felt|filz|feutre|feltro", MUSIC_MALLET, 1},
    {"soft stick|soft mallet|sponge|schwamm|weiche|éponge|spugna|molle|morbid|doux", MUSIC_MALLET,
     0},
    {"senza sord|sans sourd|ohne dämpfer|scoperto|scoperti|unmuffled|mute off|"
     "découvert",
     MUSIC_MUFFLE, 0},
    {"con sord|avec sourd|mit dämpfer|coperto|coperti|muffled|gedeckt|bedeckt|"
     "couvert|voilé",
     MUSIC_MUFFLE, 1},
    {"snares off|snare off|wires off|without snares|senza cord|ohne saiten|ohne schnarr|"
     "sans timbre",
     MUSIC_WIRES, 0},
    {"snares on|snare on|wires on|with snares|con cord|colle cord|mit saiten|mit schnarr|"
     "avec timbre",
     MUSIC_WIRES, 1},
    {"unmeasured", MUSIC_MEASURED, 0},
    {"misurato|measured|mesuré|gemessen", MUSIC_MEASURED, 1},
    {"poco a poco cresc|cresc|sempre più f$|sempre piu f$", MUSIC_GROWING, 1},
    {"decresc|dim.|dimin|sempre più p$|sempre piu p$", MUSIC_GROWING, -1},
    {"al niente|a niente|morendo|smorz|perdendo", MUSIC_GROWING, -7},
    {"dal niente|niente$", MUSIC_DYNAMIC, 0},
    {"più f$|piu f$|più forte|piu forte|meno p$|meno piano", MUSIC_LOUDER, 1},
    {"più p$|piu p$|più piano|piu piano|meno f$|meno forte", MUSIC_LOUDER, -1},
    {"poco più f$|poco piu f$|poco meno p$", MUSIC_LOUDER, 0.5},
    {"poco più p$|poco piu p$|poco meno f$", MUSIC_LOUDER, -0.5},
    {"poco f$|poco forte", MUSIC_DYNAMIC, 4.5 / 7},
    {"poco p$|poco piano", MUSIC_DYNAMIC, 2.5 / 7},
    {"tempo primo|tempo i$|tempo 1$", MUSIC_TEMPO_BACK, 1},
    {"a tempo|im tempo|au mouvement|au mouvt", MUSIC_TEMPO_BACK, 0},
    {"rit.|ritard|rall|ralent", MUSIC_TEMPO_RAMP, 0.75},
    {"poco rit|poco rall|poco allarg|un peu retenu", MUSIC_TEMPO_RAMP, 0.88},
    {"molto rit|molto rall|molto allarg", MUSIC_TEMPO_RAMP, 0.6},
    {"poco accel|poco string", MUSIC_TEMPO_RAMP, 1.12},
    {"molto accel|molto string", MUSIC_TEMPO_RAMP, 1.4},
    {"riten|allarg|verbreitern|langsamer", MUSIC_TEMPO_RAMP, 0.8},
    {"cédez", MUSIC_TEMPO_RAMP, 0.85},
    {"accel|stringendo|schneller werden", MUSIC_TEMPO_RAMP, 1.25},
    {"pressez", MUSIC_TEMPO_RAMP, 1.2},
    {"più mosso|più presto|più allegro|più vivo|più animato|piu mosso|piu presto|"
     "piu allegro|piu vivo|piu animato|plus vite|plus vif|plus animé|schneller$|bewegter|"
     "lebhafter|faster",
     MUSIC_TEMPO_SHARE, 1.15},
    {"poco più mosso|poco piu mosso|poco più animato|poco più presto|un peu plus vite|"
     "un peu plus vif|un peu plus animé|etwas schneller|etwas bewegter|a little faster",
     MUSIC_TEMPO_SHARE, 1.08},
    {"meno mosso|meno presto|meno allegro|meno vivo|più lento|più tranquillo|più largo|"
     "piu lento|piu tranquillo|piu largo|moins vite|moins vif|plus lent|ruhiger|slower",
     MUSIC_TEMPO_SHARE, 0.85},
    {"poco meno mosso|poco meno presto|poco meno allegro|poco più lento|poco più tranquillo|"
     "un peu moins vite|un peu plus lent|etwas ruhiger|a little slower",
     MUSIC_TEMPO_SHARE, 0.92},
    {"molto più mosso|assai più mosso", MUSIC_TEMPO_SHARE, 1.3},
    {"molto meno mosso|assai meno mosso", MUSIC_TEMPO_SHARE, 0.7},
    {"istesso tempo|stesso tempo|même mouvement|dasselbe tempo", MUSIC_TEMPO_SHARE, 1},
    {"doppio movimento|doppio più mosso|doppelt so schnell|deux fois plus vite", MUSIC_TEMPO_SHARE,
     2},
    {"doppio più lento|doppelt so langsam|deux fois plus lent", MUSIC_TEMPO_SHARE, 0.5},
    {"swing$|swung|shuffle$|swing feel|swingend|ternär$|ternaire$", MUSIC_SWING, 2.0 / 3},
    {"swing 16|swung 16|16th swing|16ths swing|16th shuffle", MUSIC_SWING, 1 + 2.0 / 3},
    {"straight$|straight 8|straight eighth|straight 16|straight feel|no swing|even 8|even eighth|"
     "even 16|gerade$|binär$|binaire$",
     MUSIC_SWING, 0.5},
    {"prestissimo", MUSIC_TEMPO_WORD, 200},
    {"presto", MUSIC_TEMPO_WORD, 184},
    {"vivacissimo|sehr schnell|très vif", MUSIC_TEMPO_WORD, 176},
    {"vivace|vivo$", MUSIC_TEMPO_WORD, 160},
    {"allegrissimo", MUSIC_TEMPO_WORD, 172},
    {"allegretto", MUSIC_TEMPO_WORD, 112},
    {"allegro moderato|bewegt", MUSIC_TEMPO_WORD, 116},
    {"allegro", MUSIC_TEMPO_WORD, 132},
    {"moderato", MUSIC_TEMPO_WORD, 108},
    {"andantino", MUSIC_TEMPO_WORD, 84},
    {"andante", MUSIC_TEMPO_WORD, 78},
    {"adagietto", MUSIC_TEMPO_WORD, 72},
    {"adagio", MUSIC_TEMPO_WORD, 66},
    {"larghetto", MUSIC_TEMPO_WORD, 63},
    {"largo", MUSIC_TEMPO_WORD, 50},
    {"lento$", MUSIC_TEMPO_WORD, 52},
    {"grave", MUSIC_TEMPO_WORD, 40},
    {"sehr langsam|très lent", MUSIC_TEMPO_WORD, 46},
    {"langsam|lent$", MUSIC_TEMPO_WORD, 54},
    {"mäßig|mässig", MUSIC_TEMPO_WORD, 96},
    {"schnell|vif$|rapide", MUSIC_TEMPO_WORD, 152},
    {"lebhaft", MUSIC_TEMPO_WORD, 144},
    {"modéré", MUSIC_TEMPO_WORD, 100},
    {"d.c.|da capo", MUSIC_DA_CAPO, 0},
    {"d.s.|dal segno", MUSIC_DAL_SEGNO, 0},
    {"to coda|alla coda", MUSIC_TO_CODA, 0},
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
        if (name && c == ' ' && (length == 0 || out[length - 1] == ' '))
            continue;
        out[length++] = (char)(c < 0x80 ? tolower(c) : c);
    }
    out[length] = '\0';
}

static bool begins_word(const char *text, const char *at)
{
    unsigned char before = at > text ? (unsigned char)at[-1] : ' ';
    return !isalnum(before) && before < 0x80;
}

// the length of the longest of a row's words that begins at `at`, 0: none
static size_t begins_with(const char *at, const char *words)
{
    size_t longest = 0;
    for (const char *word = words + (words[0] == '='); *word; word += *word == '|') {
        size_t all = strcspn(word, "|"), length = all - (word[all - 1] == '$');
        // the text may end before the word does
        if (length > longest && strncmp(at, word, length) == 0 &&
            !(length < all && isalpha((unsigned char)at[length])))
            longest = length;
        word += all;
    }
    return longest;
}

// true if all other words of a text are numbers and fillers
static bool is_alone(const char *text, const char *at)
{
    for (const char *w = text; *w; w += strspn(w, " ")) {
        bool word = isalpha((unsigned char)*w) || (unsigned char)*w >= 0x80;
        bool known = !word || w == at || begins_with(w, fillers) > 0;
        for (int d = 0; d < 3; d++)
            known |= begins_with(w, degrees[d]) > 0;
        if (!known)
            return false;
        w += strcspn(w, " ");
    }
    return true;
}

int himc_music_of_sort(int key, int index, int count)
{
    for (size_t i = 0; i < sizeof sorts / sizeof *sorts; i++)
        if (sorts[i].key == key && count > 1) {
            double step = count > sorts[i].count ? (sorts[i].count - 1.0) / (count - 1) : 1;
            return sorts[i].keys[(int)lround(step * index)];
        }
    return key;
}

// which of a sort a folded name says: "high", "Tom 2", "mittlerer"; else the key
static int find_degree(const char *text, const char *behind, int key)
{
    static const char *const roman[] = {"", "i", "ii", "iii", "iv", "v"};
    size_t s = 0;
    while (s < sizeof sorts / sizeof *sorts && sorts[s].key != key)
        s++;
    if (s == sizeof sorts / sizeof *sorts)
        return key;
    for (const char *at = text; *at; at++)
        for (int d = 0; d < 3 && begins_word(text, at); d++)
            if (begins_with(at, degrees[d]) > 0)
                return sorts[s].keys[d * sorts[s].low / 2];
    for (const char *at = behind; *at && *at != '('; at++) {
        size_t length = strcspn(at, " (");
        if (at[-1] != ' ')
            continue;
        int number = length == 1 && *at >= '1' && *at <= '9' ? *at - '0' : 0;
        for (int i = 1; i <= 5; i++)
            if (strlen(roman[i]) == length && strncmp(at, roman[i], length) == 0)
                number = i;
        if (number > 0)
            return sorts[s].keys[number < sorts[s].count ? number - 1 : sorts[s].count - 1];
    }
    return key;
}

midi_choice himc_music_instrument(const char *name, int *key)
{
    char text[MOST_TEXT];
    size_t length;
    fold(text, name, true);
    const char pitched[] = "pitched percussion ", *begin = text;
    begin += strncmp(text, pitched, sizeof pitched - 1) == 0 ? sizeof pitched - 1 : 0;
    for (size_t i = 0; i < sizeof instruments / sizeof *instruments; i++)
        for (const char *at = begin; *at; at++)
            if (begins_word(text, at) && (length = begins_with(at, instruments[i].words)) > 0 &&
                (instruments[i].words[0] != '=' || is_alone(text, at))) {
                *key = find_degree(text, at + length, instruments[i].key);
                return instruments[i].choice;
            }
    *key = MUSIC_NO_KEY;
    return MIDI_ANY;
}

bool himc_music_names(const char *name)
{
    char text[MOST_TEXT];
    fold(text, name, true);
    return text[0] && begins_with(text, programs) == 0;
}

// true where a word says which of a sort, or in what a cymbal hangs
static bool is_beside(const char *at)
{
    bool is = begins_with(at, "sus|sosp|concert|orchest") > 0;
    for (int d = 0; d < 3; d++)
        is |= begins_with(at, degrees[d]) > 0;
    return is;
}

size_t himc_music_named(const char *words, size_t *begin)
{
    static const char *const with[] = {" with ", " w/", " mit ", " con ", " avec "};
    *begin = strspn(words, " ([{");
    size_t length = strcspn(words + *begin, "([{)]}");
    for (size_t i = 0; i < sizeof with / sizeof *with; i++) {
        const char *at = strstr(words + *begin, with[i]);
        if (at && (size_t)(at - words) < *begin + length)
            length = (size_t)(at - words) - *begin;
    }
    return length;
}

static size_t begins_with_name(const char *at)
{
    size_t length = 0;
    for (size_t i = 0; i < sizeof instruments / sizeof *instruments && length == 0; i++)
        length = begins_with(at, instruments[i].words);
    return length;
}

midi_choice himc_music_change(const char *words, int *key, bool *bare)
{
    static const char tells[] =
        "to |take |takes |change to |changes to |switch to |muta in |mutano in |"
        "cambia in |prende |prendere |prend |prenez |change pour |changez pour |"
        "nimmt |nimm |wechselt zu |wechsel zu |wechselt auf ",
                      articles[] =
                          "the |a |an |il |la |le |lo |i |gli |les |die |das |den |zur |zum ",
                      tails[] = "drum|block|bell|tom|tam|cymb|becken|trommel|susp|sosp|caisse|set",
                      sticks[] = "stick|mallet|schläg|schleg|baguette|bacchett|brush|besen";
    char text[MOST_TEXT];
    fold(text, words, true);
    size_t begin, end = himc_music_named(text, &begin), length = 0;
    bool which = text[begin + end] && is_beside(text + begin + end + 1); // "Tom (high)"
    if (!which)
        text[begin + end] = '\0';
    const char *named = text + begin;
    size_t told = begins_with(named, tells);
    char *taken = strstr(text, " nehmen");
    if (taken)
        *taken = '\0';
    const char *at = named + told;
    at += begins_with(at, articles);
    midi_choice choice = himc_music_instrument(at, key);
    *bare = told == 0 && !taken;
    for (const char *w = named; *w; w++)
        if (begins_with(w, sticks) > 0)
            return MIDI_ANY;
    if (!*bare)
        return choice;
    while ((length = begins_with_name(at)) == 0 && is_beside(at)) { // "high wood block"
        at += strcspn(at, " ");
        at += strspn(at, " ");
    }
    for (at += length + strcspn(at + length, " "); *at; at += strcspn(at, " ")) {
        at += strspn(at, " (");
        if (*at && begins_with(at, tails) == 0 && !is_beside(at) &&
            strspn(at, "0123456789iv() ") != strlen(at))
            return MIDI_ANY;
    }
    return length > 0 && *key != MUSIC_NO_KEY && *key != MUSIC_ANY_KEY ? choice : MIDI_ANY;
}

static const char *const drums[] = {"low timpano", "second timpano", "third timpano",
                                    "high timpano"};

int himc_music_drum(const char *name)
{
    for (int i = 0; i < 4; i++)
        if (strcmp(name, drums[i]) == 0)
            return i + 1;
    return 0;
}

const char *himc_music_notehead(himc_spot spot)
{
    static const char *const heads[HIMC_SPOT_XY + 1] = {"",        "",         "",         "x",
                                                        "slashed", "circle-x", "triangle", ""};
    return heads[spot];
}

static bool find_dynamic(const char *name, music_meaning *meaning, double *value)
{
    static const struct {
        const char *name;
        music_meaning meaning;
        int step; // of 7
    } others[] = {
        {"fp", MUSIC_FORTEPIANO, 2}, {"sfp", MUSIC_FORTEPIANO, 2}, {"sfpp", MUSIC_FORTEPIANO, 1},
        {"pf", MUSIC_DYNAMIC, 4},    {"n", MUSIC_DYNAMIC, 0},      {"sf", MUSIC_ATTACK, 0},
        {"sfz", MUSIC_ATTACK, 0},    {"sffz", MUSIC_ATTACK, 0},    {"fz", MUSIC_ATTACK, 0},
        {"rf", MUSIC_ATTACK, 0},     {"rfz", MUSIC_ATTACK, 0},     {"sfzp", MUSIC_FORTEPIANO, 2}};
    *meaning = MUSIC_DYNAMIC;
    size_t length = strlen(name);
    if (length > 3 && length <= 6 && strspn(name, name[0] == 'p' ? "p" : "f") == length) {
        *value = name[0] == 'f';
        return true;
    }
    for (int i = 0; i < 8; i++)
        if (strcmp(name, himc_dynamic_words[i]) == 0) {
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

bool himc_music_dynamic(const char *name, music_meaning *meaning, double *value)
{
    static const char *const beside[] = {"sub",       "sub.",  "subito", "sempre",    "molto",
                                         "possibile", "dolce", "espr.",  "espressivo"};
    bool found = false;
    for (const char *at = name + strspn(name, " "); *at; at += strspn(at, " ")) {
        char word[16] = "";
        size_t length = strcspn(at, " "), i = 0;
        memcpy(word, at, length < sizeof word ? length : 0);
        while (i < sizeof beside / sizeof *beside && strcmp(word, beside[i]) != 0)
            i++;
        if (i == sizeof beside / sizeof *beside) {
            if (found || !find_dynamic(word, meaning, value))
                return false;
            found = true;
        }
        at += length;
    }
    return found;
}

/// A pitch in words at `*at`, which moves behind it: "F", "b flat", "F#", German "fis" and "es",
/// French and Italian "fa", "si bémol". Its class (0 C .. 11), with an octave its MIDI key (24 ..
/// 95, "C3" is 48), or -1. `german`: B is B flat, and H is B.
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
    } signs[] = {{"isis", 2},   {"is", 1},        {"es", -1},    {"#", 1},  {"♯", 1},
                 {"♭", -1},     {" flat", -1},    {" sharp", 1}, {"b", -1}, {" bémol", -1},
                 {" dièse", 1}, {" bemolle", -1}, {" moll", 0}};
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
    int octave = *p >= '1' && *p <= '6' ? *p - '0' : -1;
    *at = p + strspn(p, "0123456789");
    return octave > 0 && *at == p + 1 ? pitch + 12 * (octave + 1) : pitch;
}

// a text whose arrows and dashes between spaces are words
static void read_arrows(char out[MOST_TEXT], const char *words)
{
    static const char *const arrows[] = {"→", "->", "–", "—", " - "};
    size_t length = 0;
    for (; *words && length < MOST_TEXT - 5; words++) {
        size_t i = 0;
        while (i < 5 && strncmp(words, arrows[i], strlen(arrows[i])) != 0)
            i++;
        if (i < 5) {
            memcpy(out + length, " to ", 4);
            length += 4;
            words += strlen(arrows[i]) - 1;
        } else {
            out[length++] = *words;
        }
    }
    out[length] = '\0';
}

// "muta in F", "change F to G", "C muta D", "G nach A umstimmen", "changez sol en la", "gliss. C to
// D"; without such a verb it is no more than pitches: "F to G"
static int read_tunings(const char *text, int most, double *value)
{
    static const char *const tells[] = {"muta", "mutano", "change", "umstimmen", "stimmen",
                                        "tune", "retune", "cambia", "nach",      "gliss"};
    static const char *const joins[] = {"to", "in", "en", "nach", "auf", "muta"};
    bool told = false, pure = true;
    for (size_t i = 0; i < sizeof tells / sizeof *tells; i++) {
        const char *at = strstr(text, tells[i]);
        told |= at && begins_word(text, at);
    }
    bool german = strstr(text, "stimm") || strstr(text, "nach ");
    int from = 12, drum = 0, count = 0;
    bool joined = false;
    for (const char *at = text; (told || pure) && *at && count < most;) {
        at += strspn(at, " ,;:()");
        const char *word = at;
        int pitch = read_pitch(&at, german);
        pure &= pitch < 0 || (from == 12 ? !joined : joined);
        if (pitch >= 0 && (joined || from != 12)) {
            value[count++] = 100 * (from + 128 * drum) + pitch;
            from = 12;
            joined = false;
        } else if (pitch >= 0) {
            from = pitch;
        }
        if (pitch >= 0)
            continue;
        size_t length = strcspn(at, " ,;:()");
        for (size_t i = 0; i < 4; i++)
            drum =
                strncmp(at, drums[i], length) == 0 && drums[i][length] == ' ' ? (int)i + 1 : drum;
        bool join = false, before = from != 12 || word[0] != 'm'; // "muta F in G" begins with none
        for (size_t i = 0; i < sizeof joins / sizeof *joins && before; i++)
            join |= strlen(joins[i]) == length && strncmp(word, joins[i], length) == 0;
        joined |= join;
        pure &= join || length == 0;
        at += length;
    }
    return told || (pure && from == 12) ? count : 0;
}

// a dynamic before other words: "p cresc.", "pp leggiero"; of one letter, which may be a pitch,
// `known` words, or one of three letters
static bool begins_dynamic(const char *words, bool known, music_meaning *meaning, double *value)
{
    char name[8] = "";
    words += strspn(words, " ");
    size_t length = strcspn(words, " ,;\n"), longest = 0;
    memcpy(name, words, length < sizeof name ? length : 0);
    for (const char *at = words + length; *at; at += strspn(at, " ,;-(\n")) {
        size_t letters = strcspn(at, " ,;-(\n");
        longest = letters > longest ? letters : longest;
        at += letters;
    }
    return (length > 1 || known || longest > 2) && find_dynamic(name, meaning, value);
}

int himc_music_words(const char *words, int most, music_meaning *meaning, double *value)
{
    char text[MOST_TEXT], arrows[MOST_TEXT];
    int count = 0, way;
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
    if ((way = himc_music_syllables(text)) != 0) {
        meaning[0] = MUSIC_GROWING;
        value[0] = way;
        return 1;
    }
    read_arrows(arrows, words);
    fold(arrows, arrows, false);
    count = read_tunings(arrows, most, value);
    const bool tunes = count > 0;
    for (int i = 0; i < count; i++)
        meaning[i] = strstr(text, "gliss") ? MUSIC_GLISS : MUSIC_TUNING;
    count += !tunes && himc_music_metronome(text, &meaning[0], &value[0]);
    const size_t rows = sizeof instructions / sizeof *instructions;
    for (const char *at = text; *at && count < most;) {
        size_t longest = 0, found = rows;
        for (size_t i = 0; i < rows && begins_word(text, at); i++) {
            size_t length = begins_with(at, instructions[i].words);
            found = length > longest ? i : found;
            longest = length > longest ? length : longest;
        }
        if (found < rows) {
            const char *behind = at + longest + strspn(at + longest, " ");
            int key = read_pitch(&behind, false);
            meaning[count] = instructions[found].meaning;
            value[count] = instructions[found].value;
            if (meaning[count] == MUSIC_RING && value[count] < 0 && key >= 24)
                value[count] = -key; // "damp C3"
            count++;
        }
        at += longest > 0 ? longest : 1;
    }
    music_meaning dynamic;
    double level;
    if (!tunes && count < most && begins_dynamic(words, count > 0, &dynamic, &level)) {
        memmove(meaning + 1, meaning, (size_t)count * sizeof *meaning);
        memmove(value + 1, value, (size_t)count * sizeof *value);
        meaning[0] = dynamic;
        value[0] = level;
        count++;
    }
    return count;
}
