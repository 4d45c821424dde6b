/* Lays the structs of packets.h over bytes and back, for test_packets_h.py: one command per line of input.
 *
 *   layout                     prints "struct field offset size" of everything
 *   crc HEX                    prints the CRC-16 of the bytes
 *   read STRUCT HEX            prints "field hex" of every field, little endian as in memory
 *   write STRUCT field=HEX...  prints the bytes of a struct whose fields were assigned
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "packets.h"

struct field {
    const char *structure, *name;
    size_t offset, size, whole;
};

#define FIELD(s, f) {#s, #f, offsetof(struct kt_##s, f), sizeof(((struct kt_##s *)0)->f), sizeof(struct kt_##s)}
#define HEAD(s)                                                                                                   \
    FIELD(s, head.magic), FIELD(s, head.version_type), FIELD(s, head.number), FIELD(s, head.sequence),             \
        FIELD(s, head.clock), FIELD(s, head.flags)

static const struct field fields[] = {
    HEAD(sample), FIELD(sample, orientation), FIELD(sample, gyro), FIELD(sample, accel), FIELD(sample, battery),
    HEAD(integral), FIELD(integral, angle), FIELD(integral, samples), FIELD(integral, temperature),
    FIELD(integral, zero), FIELD(integral, battery),
    HEAD(info), FIELD(info, orientation), FIELD(info, firmware), FIELD(info, battery_mv), FIELD(info, temperature),
    FIELD(info, calibration_crc), FIELD(info, serial), FIELD(info, battery),
    HEAD(device), FIELD(device, orientation), FIELD(device, hardware), FIELD(device, who_am_i),
    FIELD(device, gyro_range), FIELD(device, accel_range), FIELD(device, bandwidth), FIELD(device, internal_rate),
    FIELD(device, serial), FIELD(device, battery),
    HEAD(coefficients), FIELD(coefficients, index), FIELD(coefficients, value), FIELD(coefficients, calibration_crc),
    FIELD(coefficients, zero), FIELD(coefficients, battery),
    FIELD(sync, magic), FIELD(sync, version_type), FIELD(sync, suit), FIELD(sync, sequence), FIELD(sync, clock_us),
    FIELD(sync, frame_counter), FIELD(sync, frame_length), FIELD(sync, slots), FIELD(sync, command),
    FIELD(sync, target), FIELD(sync, value), FIELD(sync, nonce), FIELD(sync, command_serial),
    FIELD(frame_hello, kind), FIELD(frame_hello, version), FIELD(frame_hello, hardware), FIELD(frame_hello, firmware),
    FIELD(frame_hello, serial),
    FIELD(frame_packet, kind), FIELD(frame_packet, clock_us), FIELD(frame_packet, address), FIELD(frame_packet, loss),
    FIELD(frame_packet, channel), FIELD(frame_packet, payload),
    FIELD(frame_status, kind), FIELD(frame_status, clock_us), FIELD(frame_status, received),
    FIELD(frame_status, crc_errors), FIELD(frame_status, dropped), FIELD(frame_status, slots),
    FIELD(frame_mode, kind), FIELD(frame_mode, mode),
    FIELD(frame_channel, kind), FIELD(frame_channel, channel),
    FIELD(frame_command, kind), FIELD(frame_command, serial), FIELD(frame_command, address_rest),
    FIELD(frame_command, command), FIELD(frame_command, value), FIELD(frame_command, nonce),
};

#define COUNT (sizeof fields / sizeof fields[0])

static size_t from_hex(const char *text, uint8_t *bytes)
{
    size_t size = 0;
    unsigned value;
    while (size < 128 && sscanf(text + 2 * size, "%2x", &value) == 1)
        bytes[size++] = (uint8_t)value;
    return size;
}

static void print_hex(const uint8_t *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        printf("%02x", bytes[i]);
}

static void write_struct(char *words)
{
    uint8_t bytes[128] = {0}, value[128];
    size_t whole = 0;
    const char *structure = strtok(words, " \n");
    for (char *word = strtok(NULL, " \n"); word; word = strtok(NULL, " \n")) {
        char *equals = strchr(word, '=');
        *equals = 0;
        for (size_t i = 0; i < COUNT; i++) {
            if (strcmp(fields[i].structure, structure) || strcmp(fields[i].name, word))
                continue;
            if (from_hex(equals + 1, value) != fields[i].size)
                exit(2);
            memcpy(bytes + fields[i].offset, value, fields[i].size);
            whole = fields[i].whole;
        }
    }
    print_hex(bytes, whole);
    printf("\n");
}

static void read_struct(char *words)
{
    uint8_t bytes[128];
    const char *structure = strtok(words, " \n");
    size_t size = from_hex(strtok(NULL, " \n"), bytes);
    for (size_t i = 0; i < COUNT; i++) {
        if (strcmp(fields[i].structure, structure))
            continue;
        if (size != fields[i].whole)
            exit(3);
        printf("%s ", fields[i].name);
        print_hex(bytes + fields[i].offset, fields[i].size);
        printf(" ");
    }
    printf("\n");
}

int main(void)
{
    static char line[4096];
    uint8_t bytes[128];
    while (fgets(line, sizeof line, stdin)) {
        if (!strncmp(line, "layout", 6)) {
            for (size_t i = 0; i < COUNT; i++)
                printf("%s %s %zu %zu %zu ", fields[i].structure, fields[i].name, fields[i].offset, fields[i].size,
                       fields[i].whole);
            printf("\n");
        } else if (!strncmp(line, "constants", 9)) {
            printf("%d %d %d %d %d %d %d %d %u\n", KT_VERSION, KT_MAGIC, KT_PAYLOAD_SIZE, KT_ADVERT_SIZE,
                   KT_CLOCK_TICK_US, KT_CLOCK_BITS, KT_FRAME_US, KT_MOST_TAGS, KT_ALL_TAGS);
        } else if (!strncmp(line, "crc ", 4)) {
            printf("%u\n", kt_crc16(bytes, from_hex(line + 4, bytes)));
        } else if (!strncmp(line, "write ", 6)) {
            write_struct(line + 6);
        } else if (!strncmp(line, "read ", 5)) {
            read_struct(line + 5);
        }
        fflush(stdout);
    }
    return 0;
}
