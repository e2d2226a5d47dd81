/// pages.c: viewer/page and three.js (Debian's libjs-three) as bytes in the program.
///
/// The assembler's .incbin takes the files in: paths are relative to the repository's root, where
/// make runs; THREE_JS is the folder of three.module.js, MADE the folder of the files that make
/// generates. The licence of three.js (MIT) is in index.html, hence in each page of `himc share`.
#include "pages.h"

#include <string.h>

#ifndef THREE_JS
#define THREE_JS "/usr/share/javascript/three"
#endif

#define SCRIPT(FILE, name) \
    FILE(name, "/" #name ".js", "text/javascript", "viewer/page/" #name ".js")

/// All files: name in the program, path and type for the browser, where it comes from.
#define FILES(FILE)                                                        \
    FILE(index, "/", "text/html; charset=utf-8", "viewer/page/index.html") \
    FILE(style, "/style.css", "text/css", "viewer/page/style.css")         \
    FILE(icon, "/icon.svg", "image/svg+xml", "viewer/page/icon.svg")       \
    SCRIPT(FILE, main)                                                     \
    SCRIPT(FILE, boot)                                                     \
    SCRIPT(FILE, stream)                                                   \
    SCRIPT(FILE, clock)                                                    \
    SCRIPT(FILE, performer)                                                \
    SCRIPT(FILE, body)                                                     \
    SCRIPT(FILE, figure)                                                   \
    SCRIPT(FILE, sculpt)                                                   \
    SCRIPT(FILE, solids)                                                   \
    SCRIPT(FILE, color)                                                    \
    SCRIPT(FILE, drum)                                                     \
    SCRIPT(FILE, modes)                                                    \
    SCRIPT(FILE, strike)                                                   \
    SCRIPT(FILE, support)                                                  \
    SCRIPT(FILE, stage)                                                    \
    SCRIPT(FILE, sketch)                                                   \
    SCRIPT(FILE, camera)                                                   \
    SCRIPT(FILE, rows)                                                     \
    SCRIPT(FILE, scene)                                                    \
    SCRIPT(FILE, playback)                                                 \
    SCRIPT(FILE, sound)                                                    \
    SCRIPT(FILE, worklet)                                                  \
    SCRIPT(FILE, worker)                                                   \
    SCRIPT(FILE, studio)                                                   \
    SCRIPT(FILE, channel)                                                  \
    SCRIPT(FILE, workshop)                                                 \
    SCRIPT(FILE, spectrum)                                                 \
    SCRIPT(FILE, piece)                                                    \
    SCRIPT(FILE, edit)                                                     \
    SCRIPT(FILE, when)                                                     \
    SCRIPT(FILE, timeline)                                                 \
    SCRIPT(FILE, panel)                                                    \
    SCRIPT(FILE, record)                                                   \
    SCRIPT(FILE, film)                                                     \
    SCRIPT(FILE, webm)                                                     \
    SCRIPT(FILE, gltf)                                                     \
    FILE(push, "/push.js", "text/javascript", "viewer/page/push.js")       \
    FILE(export, "/export.js", "text/javascript", "viewer/page/export.js") \
    FILE(skeleton, "/skeleton.js", "text/javascript", MADE "/skeleton.js") \
    FILE(three, "/three.js", "text/javascript", THREE_JS "/three.module.js")

#ifdef __APPLE__
#define SECTION ".section __TEXT,__const"
#define SYMBOL(name) "_page_" #name
#else
#define SECTION ".section .rodata"
#define SYMBOL(name) "page_" #name
#endif
#define EMBED(name, path, type, file)                                                             \
    __asm__(SECTION "\n.globl " SYMBOL(name) "\n.globl " SYMBOL(name) "_end\n.balign 8\n" SYMBOL( \
        name) ":\n.incbin \"" file "\"\n" SYMBOL(name) "_end:\n.byte 0\n.previous\n");            \
    extern const char page_##name[], page_##name##_end[];
FILES(EMBED)

#define ROW(name, path, type, file) {path, type, page_##name, page_##name##_end},
static const page pages[] = {FILES(ROW)};

const page *pages_at(int index)
{
    return (size_t)index < sizeof pages / sizeof *pages ? &pages[index] : NULL;
}

const page *pages_find(const char *path)
{
    for (size_t i = 0; i < sizeof pages / sizeof *pages; i++)
        if (strcmp(path, pages[i].path) == 0)
            return &pages[i];
    return NULL;
}
