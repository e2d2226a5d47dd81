/// pages.c: viewer/page and three.js (Debian's libjs-three) as bytes in the program.
///
/// The assembler's .incbin takes the files in: paths are relative to the repository's root, where
/// make runs; THREE_JS is the folder of three.module.js. The three.js licence (MIT) is in the
/// file's own head.
#include "pages.h"

#include <string.h>

#ifndef THREE_JS
#define THREE_JS "/usr/share/javascript/three"
#endif

#define FILE_IN(name, path)                                                       \
    __asm__(".section .rodata\n.global page_" #name "\n.global page_" #name       \
            "_end\n.balign 8\npage_" #name ":\n.incbin \"" path "\"\npage_" #name \
            "_end:\n.byte 0\n.previous\n");                                       \
    extern const char page_##name[], page_##name##_end[];

FILE_IN(index, "viewer/page/index.html")
FILE_IN(style, "viewer/page/style.css")
FILE_IN(icon, "viewer/page/icon.svg")
FILE_IN(main, "viewer/page/main.js")
FILE_IN(stream, "viewer/page/stream.js")
FILE_IN(performer, "viewer/page/performer.js")
FILE_IN(figure, "viewer/page/figure.js")
FILE_IN(color, "viewer/page/color.js")
FILE_IN(sculpt, "viewer/page/sculpt.js")
FILE_IN(skeleton, "viewer/page/skeleton.js")
FILE_IN(drum, "viewer/page/drum.js")
FILE_IN(modes, "viewer/page/modes.js")
FILE_IN(strike, "viewer/page/strike.js")
FILE_IN(stage, "viewer/page/stage.js")
FILE_IN(camera, "viewer/page/camera.js")
FILE_IN(motion, "viewer/page/motion.js")
FILE_IN(panel, "viewer/page/panel.js")
FILE_IN(record, "viewer/page/record.js")
FILE_IN(three, THREE_JS "/three.module.js")

#define SCRIPT(name)                                                       \
    {                                                                      \
        "/" #name ".js", "text/javascript", page_##name, page_##name##_end \
    }

static const page pages[] = {
    {"/", "text/html; charset=utf-8", page_index, page_index_end},
    {"/style.css", "text/css", page_style, page_style_end},
    {"/icon.svg", "image/svg+xml", page_icon, page_icon_end},
    SCRIPT(main),
    SCRIPT(stream),
    SCRIPT(performer),
    SCRIPT(figure),
    SCRIPT(sculpt),
    SCRIPT(color),
    SCRIPT(skeleton),
    SCRIPT(drum),
    SCRIPT(modes),
    SCRIPT(strike),
    SCRIPT(stage),
    SCRIPT(camera),
    SCRIPT(motion),
    SCRIPT(panel),
    SCRIPT(record),
    SCRIPT(three),
};

const page *pages_find(const char *path)
{
    for (size_t i = 0; i < sizeof pages / sizeof *pages; i++)
        if (strcmp(path, pages[i].path) == 0)
            return &pages[i];
    return NULL;
}
