/// browser.h: a browser of the Chromium family without a window, told what to do over a pipe.
#ifndef BROWSER_H
#define BROWSER_H

#include "himc/base.h"

#define BROWSER_HOME 256 ///< of a folder's name, with its final 0; chosen

/// A browser with one page. Opaque.
typedef struct browser browser;

/// Starts the browser that HIMC_BROWSER names, else the first that is found, with a page of that
/// size (pixels). NULL with the reason.
browser *browser_open(int width, int height, himc_error *error);
/// Its folder, for files that go with it, however this program ends.
const char *browser_home(const browser *b);
/// Loads a page. False with the reason.
bool browser_go(browser *b, const char *url, himc_error *error);
/// The text that JavaScript answers, also by a promise; valid until the next call. NULL with the
/// reason, as that the script failed.
const char *browser_run(browser *b, const char *script, himc_error *error);
/// Ends the browser and removes what it kept. NULL is allowed.
void browser_close(browser *b);

#endif
