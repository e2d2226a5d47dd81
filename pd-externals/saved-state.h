/* saved-state.h: the state of [himc~] and [membrane~] in the patch, after `-save` or `save 1`.

Behind the object's own line the patch has one message to it, as [text define -k] does it:

    #A state WORD ... \; WORD ... \;

with the lines of `dump`. The object that was made last is bound to #A, so opening, pasting and undo
send the message to the new object. All words are symbols, as Pd writes six digits of a number. The
patch may be opened under another $0, or in another folder: an argument of the object with a dollar
is written as in its box, and a path into the patch's folder begins with "./". */
#ifndef SAVED_STATE_H
#define SAVED_STATE_H

#include "himc/command.h"
#include "m_pd.h"

#include "g_canvas.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What is being saved, and where to. */
typedef struct t_saving {
    const t_object *s_object;
    t_canvas *s_canvas; /* it stands in */
    t_binbuf *s_to;
} t_saving;

/* Whoever was bound to #A has had all that was for it. */
static inline void saved_bind(t_pd *object)
{
    gensym("#A")->s_thing = NULL;
    pd_bind(object, gensym("#A"));
}

static inline void saved_unbind(t_pd *object)
{
    if (gensym("#A")->s_thing == object)
        pd_unbind(object, gensym("#A"));
}

/* The object's line, as Pd itself writes it. */
static inline void saved_object(const t_saving *s)
{
    const t_object *object = s->s_object;
    binbuf_addv(s->s_to, "ssii", &s__X, gensym("obj"), (int)object->te_xpix, (int)object->te_ypix);
    binbuf_addbinbuf(s->s_to, object->te_binbuf);
    if (object->te_width)
        binbuf_addv(s->s_to, ",si", gensym("f"), (int)object->te_width);
    binbuf_addsemi(s->s_to);
}

/* The argument with a dollar whose value is `word`, as it stands in the box; else the word. */
static inline t_symbol *saved_as_written(const t_saving *s, t_symbol *word)
{
    const t_atom *argument = binbuf_getvec(s->s_object->te_binbuf);
    for (int i = binbuf_getnatom(s->s_object->te_binbuf); i > 0; i--, argument++) {
        char text[MAXPDSTRING];
        if (argument->a_type != A_DOLLSYM && argument->a_type != A_DOLLAR)
            continue;
        if (argument->a_type == A_DOLLAR)
            snprintf(text, sizeof text, "$%d", argument->a_w.w_index);
        else
            snprintf(text, sizeof text, "%s", argument->a_w.w_symbol->s_name);
        if (canvas_realizedollar(s->s_canvas, gensym(text)) == word)
            return gensym(text);
    }
    return word;
}

static inline void saved_word(const t_saving *s, const char *word)
{
    const char *folder = canvas_getdir(s->s_canvas)->s_name;
    size_t length = strlen(folder);
    char text[HIMC_PATH_SIZE + 8];
    t_atom atom;
    if (strncmp(word, folder, length) == 0 && word[length] == '/')
        snprintf(text, sizeof text, ".%s", word + length);
    else
        snprintf(text, sizeof text, "%s", saved_as_written(s, gensym(word))->s_name);
    SETSYMBOL(&atom, gensym(text));
    binbuf_add(s->s_to, 1, &atom);
}

/* A line of `dump`: words between spaces, `\` quotes a character. */
static inline void saved_line(void *saving, const char *line)
{
    const t_saving *s = saving;
    while (*line) {
        char word[HIMC_PATH_SIZE + 8];
        size_t length = 0;
        for (; *line && *line != ' '; line++) {
            line += *line == '\\' && line[1];
            if (length < sizeof word - 1)
                word[length++] = *line;
        }
        word[length] = '\0';
        saved_word(s, word);
        line += *line == ' ';
    }
    binbuf_addv(s->s_to, "s", gensym(";"));
}

/* A saved word as it is meant here. */
static inline void saved_meaning(char out[2 * MAXPDSTRING], const t_atom *atom, t_canvas *canvas)
{
    if (atom->a_type != A_SYMBOL) {
        snprintf(out, 2 * MAXPDSTRING, "%.9g", atom_getfloat(atom));
        return;
    }
    const char *word = canvas_realizedollar(canvas, atom->a_w.w_symbol)->s_name;
    bool inside = strncmp(word, "./", 2) == 0;
    snprintf(out, 2 * MAXPDSTRING, "%s%s", inside ? canvas_getdir(canvas)->s_name : "",
             word + inside);
}

/* Writes a word with its special characters quoted, if there is somewhere to; returns its size. */
static inline size_t saved_quote(char *to, const char *word)
{
    size_t size = 0;
    for (bool quote; *word; size += quote + 1u, word++) {
        quote = strchr(" \t\n;,\\", *word) != NULL;
        if (to)
            snprintf(to + size, 3, "%s%c", quote ? "\\" : "", *word);
    }
    return size;
}

/* Writes the message's words as lines with a `;` each, if there is somewhere to; returns their
size. */
static inline size_t saved_lines(char *to, t_canvas *canvas, int argc, const t_atom *argv)
{
    size_t size = 0;
    for (const t_atom *atom = argv; atom < argv + argc; atom++) {
        char word[2 * MAXPDSTRING];
        saved_meaning(word, atom, canvas);
        bool end = strcmp(word, ";") == 0;
        if (to && end)
            to[size] = ';';
        size += end ? 1 : saved_quote(to ? to + size : NULL, word);
        if (to)
            to[size] = ' ';
        size++;
    }
    return size;
}

/* The message as text, to be freed; NULL without memory. */
static inline char *saved_text(t_canvas *canvas, int argc, const t_atom *argv)
{
    size_t size = saved_lines(NULL, canvas, argc, argv);
    char *text = malloc(size + 1);
    if (text)
        text[saved_lines(text, canvas, argc, argv)] = '\0';
    return text;
}

/* The message `save SWITCH`. */
static inline bool saved_switch(bool *on, int argc, const t_atom *argv, himc_error *error)
{
    t_float value = argc > 0 && argv->a_type == A_FLOAT ? argv->a_w.w_float : -1;
    char text[80] = "";
    if (argc > 0)
        atom_string(argv + (argc > 1), text, sizeof text);
    if (argc == 0)
        return himc_error_set(error, "save: SWITCH missing, expected save SWITCH");
    if (argc > 1)
        return himc_error_set(error, "save: %s is one atom too many, expected save SWITCH", text);
    if (value != 0 && value != 1)
        return himc_error_set(error, "save: SWITCH: %s, expected 0 .. 1, whole", text);
    *on = value == 1;
    return true;
}

#endif
