/* channels.h: signals of several channels, which Pd has from 0.54 on. An older Pd would not load an
object that calls their function by name: it is looked up. */
#ifndef CHANNELS_H
#define CHANNELS_H

#ifndef _WIN32
#define _GNU_SOURCE /* RTLD_DEFAULT */
#include <dlfcn.h>
#endif
#include "m_pd.h"

#define CLASS_OF_CHANNELS 0x10 /* CLASS_MULTICHANNEL */

/* signal_setmultiout: the number of channels of an outlet, from a dsp method before its samples. */
typedef void t_set_channels(t_signal **signal, int channels);

#ifdef _WIN32
__declspec(dllimport) void *__stdcall GetModuleHandleA(const char *name);
__declspec(dllimport) void *__stdcall GetProcAddress(void *module, const char *name);
#endif

static inline t_set_channels *pd_find_function(const char *name)
{
#ifdef _WIN32
    void *pd = GetModuleHandleA(sizeof(t_float) == 8 ? "pd64.dll" : "pd.dll");
    return pd ? (t_set_channels *)GetProcAddress(pd, name) : NULL;
#else
    return (t_set_channels *)dlsym(RTLD_DEFAULT, name);
#endif
}

#endif
