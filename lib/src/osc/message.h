/// message.h: one message of OSC 1.0 as bytes: an address, its type tags, its atoms, each filled up
/// to four bytes. Allocates nothing.
#ifndef HIMC_OSC_MESSAGE_H
#define HIMC_OSC_MESSAGE_H

#include "himc/command.h"

#define OSC_MESSAGE_ATOMS 256  // chosen: more than a status or a head has
#define OSC_MESSAGE_BYTES 4096 // of its atoms; chosen: a line of text is 512

/// A message being written. One that grows beyond its room is empty (size 0) in the end.
typedef struct osc_message {
    const char *path; ///< borrowed
    int count;
    size_t used; ///< (bytes)
    bool full;
    char types[OSC_MESSAGE_ATOMS];
    unsigned char atoms[OSC_MESSAGE_BYTES];
} osc_message;

void himc_osc_message_begin(osc_message *message, const char *path);
void himc_osc_message_text(osc_message *message, const char *text);
void himc_osc_message_int(osc_message *message, int32_t value);
void himc_osc_message_float(osc_message *message, float value);
/// Bytes of any kind (a blob).
void himc_osc_message_bytes(osc_message *message, const unsigned char *bytes, size_t size);
/// Bytes that himc_osc_message_write needs; 0 if the message outgrew its room.
size_t himc_osc_message_size(const osc_message *message);
void himc_osc_message_write(const osc_message *message, unsigned char *out);

void himc_osc_put32(unsigned char *at, uint32_t value); ///< highest byte first
uint32_t himc_osc_get32(const char *at);

/// Reads a whole message; its path is where `data` begins. The first `most` atoms are given; their
/// texts lie in `data`. `plain` says that all of these are numbers or words. False if the bytes are
/// no message: a string without an end, filled up with other than zeros, an unknown type, an atom
/// that ends too late, bytes left.
bool himc_osc_message_read(const char *data, size_t size, himc_atom *atom, int most, int *count,
                           bool *plain);

#endif
