/// npz.c: a ZIP file (PKWARE's APPNOTE 6.3.3: local headers, central directory, its end), each of
/// whose files is an array in NumPy's format 1.0: magic, length of a header, the header (a Python
/// dictionary, padded to 64 bytes), the data. Not compressed, so NumPy may map the data into
/// memory, and no library is needed. All times are 1980-01-01: equal data give equal files.
#include "npz.h"

#include <stdlib.h>
#include <string.h>

#define EARLIEST 0x00210000u // of the times in a ZIP file
#define LOCAL 30             // bytes of a local header ...
#define CENTRAL 46           // ... of an entry of the directory ...
#define END 22               // ... and of its end

static uint8_t *put(uint8_t *p, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++)
        *p++ = (uint8_t)(value >> 8 * i);
    return p;
}

// ZIP's checksum: CRC-32 of ITU-T V.42
static uint32_t crc_of(uint32_t crc, const uint8_t *bytes, size_t size)
{
    static uint32_t table[256];
    for (uint32_t i = 0; !table[255] && i < 256; i++) {
        table[i] = i;
        for (int bit = 0; bit < 8; bit++)
            table[i] = table[i] >> 1 ^ (table[i] & 1 ? 0xedb88320u : 0);
    }
    crc = ~crc;
    for (size_t i = 0; i < size; i++)
        crc = table[(crc ^ bytes[i]) & 255] ^ crc >> 8;
    return ~crc;
}

static void write_bytes(npz *file, const void *bytes, size_t size)
{
    fwrite(bytes, 1, size, file->stream);
    file->at += size;
}

// the header of an array; returns its size
static size_t array_header(char out[256], int width, const size_t *shape, int dimensions)
{
    char sizes[96] = "";
    for (int i = 0; i < dimensions; i++)
        snprintf(sizes + strlen(sizes), sizeof sizes - strlen(sizes), "%zu,", shape[i]);
    memset(out, ' ', 256);
    memcpy(out, "\x93NUMPY\x01\x00", 8);
    int used = snprintf(out + 10, 200, "{'descr': '%s%d', 'fortran_order': False, 'shape': (%s), }",
                        width ? "|S" : "<f", width ? width : 8, sizes);
    out[10 + used] = ' ';
    size_t size = ((size_t)used + 11 + 63) / 64 * 64;
    out[size - 1] = '\n';
    put((uint8_t *)out + 8, size - 10, 2);
    return size;
}

// what a local header and an entry of the directory have in common: from the version needed on
static uint8_t *put_common(uint8_t *p, uint32_t crc, uint32_t size, size_t name)
{
    p = put(p, 20, 2); // version 2.0
    p = put(p, 0, 4);  // no flags, stored
    p = put(p, EARLIEST, 4);
    p = put(p, crc, 4);
    p = put(p, size, 4);
    p = put(p, size, 4);
    p = put(p, name, 2);
    return put(p, 0, 2); // no extra field
}

void npz_add(npz *file, const char *name, const void *data, int width, const size_t *shape,
             int dimensions)
{
    char header[256];
    uint8_t local[LOCAL];
    size_t head = array_header(header, width, shape, dimensions), bytes = width ? (size_t)width : 8;
    for (int i = 0; i < dimensions; i++)
        bytes *= shape[i];
    file->too_large = file->too_large || file->count == NPZ_ARRAYS ||
                      file->at + bytes + sizeof header + CENTRAL * NPZ_ARRAYS > UINT32_MAX;
    if (file->too_large)
        return;
    int i = file->count++;
    snprintf(file->array[i].name, sizeof file->array[i].name, "%s.npy", name);
    file->array[i].at = (uint32_t)file->at;
    file->array[i].size = (uint32_t)(head + bytes);
    file->array[i].crc = crc_of(crc_of(0, (uint8_t *)header, head), data, bytes);
    put_common(put(local, 0x04034b50u, 4), file->array[i].crc, file->array[i].size,
               strlen(file->array[i].name));
    write_bytes(file, local, sizeof local);
    write_bytes(file, file->array[i].name, strlen(file->array[i].name));
    write_bytes(file, header, head);
    write_bytes(file, data, bytes);
}

bool npz_end(npz *file, himc_error *error)
{
    uint8_t entry[CENTRAL] = {0}, end[END] = {0};
    uint64_t begin = file->at;
    if (file->too_large)
        return himc_error_set(error, "the .npz would be too large, expected 4 GiB");
    for (int i = 0; i < file->count; i++) {
        size_t name = strlen(file->array[i].name);
        put_common(put(put(entry, 0x02014b50u, 4), 20, 2), file->array[i].crc, file->array[i].size,
                   name);
        put(entry + 42, file->array[i].at, 4);
        write_bytes(file, entry, sizeof entry);
        write_bytes(file, file->array[i].name, name);
    }
    uint8_t *p = put(put(end, 0x06054b50u, 4), 0, 4);
    p = put(put(p, (uint64_t)file->count, 2), (uint64_t)file->count, 2);
    put(put(p, file->at - begin, 4), begin, 4);
    write_bytes(file, end, sizeof end);
    return true;
}
