/* Kinetag wire protocol v1: layouts and constants. PROTOCOL.md says what they mean.
 *
 * C99, little endian, no padding. Include it in firmware of tags and receivers; the studio's own codec
 * (studio/acquisition/dialects) is held against it by tests/conformance.
 */
#ifndef KT_PACKETS_H
#define KT_PACKETS_H

#include <stddef.h>
#include <stdint.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the wire is little endian, and so must be the machine that lays these structs over it"
#endif

#define KT_PACKED __attribute__((packed))
#define KT_ASSERT(name, condition) typedef char kt_assert_##name[(condition) ? 1 : -1]

/* --- Constants ------------------------------------------------------------------------------------ */

#define KT_VERSION 1
#define KT_MAGIC 0x6D
#define KT_COMPANY 0xFFFF /* for tests only: shared by everybody's prototypes */
#define KT_AD_LENGTH 0x1E
#define KT_AD_MANUFACTURER 0xFF
#define KT_PAYLOAD_SIZE 27
#define KT_ADVERT_SIZE 31
#define KT_HEAD(type) ((uint8_t)(KT_VERSION << 4 | (type)))

enum kt_type {
    KT_SAMPLE = 1,
    KT_INTEGRAL = 3,
    KT_INFO = 4,
    KT_DEVICE = 5,
    KT_COEFFICIENTS = 6,
    KT_SYNC = 15
};

enum kt_flag {
    KT_CALIBRATED = 1,
    KT_AT_REST = 2,
    KT_OFFSET_OK = 4,
    KT_CLIPPED = 8,
    KT_IMU_ERROR = 16,
    KT_LOW_BATTERY = 32,
    KT_TIME_SYNCED = 64,
    KT_BUTTON = 128
};

enum kt_command {
    KT_NO_COMMAND = 0,
    KT_ASSIGN_NUMBER = 1,
    KT_MEASURE_OFFSET = 2,
    KT_START_INTEGRALS = 3,
    KT_STREAM = 4,
    KT_SET_COEFFICIENT = 5,
    KT_SAVE = 6,
    KT_BLINK = 7,
    KT_LEAVE_SLOTS = 8,
    KT_REPORT_COEFFICIENTS = 9
};

#define KT_CLOCK_TICK_US 64
#define KT_CLOCK_BITS 24
#define KT_FRAME_US 20000 /* unless SYNC says otherwise */
#define KT_FRAME_UNIT_US 100
#define KT_GYRO_RANGE 2000 /* deg/s at 32768 */
#define KT_ACCEL_RANGE 16  /* g at 32768 */
#define KT_INTEGRAL_UNITS 1024 /* per degree */
#define KT_TEMPERATURE_UNITS 100 /* per degree Celsius */
#define KT_BATTERY_FULL 200
#define KT_BATTERY_UNKNOWN 255
#define KT_MOST_TAGS 15
#define KT_EVERY_SUIT 255
#define KT_ALL_TAGS 0xFFFFFFFFu
#define KT_INFO_EVERY 50 /* frames; at frame counter = 3 * number (mod 50) */

/* --- Tag to air: 27 bytes behind 1E FF FF FF ------------------------------------------------------ */

struct KT_PACKED kt_head {
    uint8_t magic;
    uint8_t version_type;
    uint8_t number;
    uint8_t sequence;
    uint8_t clock[3];
    uint8_t flags;
};

struct KT_PACKED kt_sample {
    struct kt_head head;
    uint8_t orientation[6];
    int16_t gyro[3];
    int16_t accel[3];
    uint8_t battery;
};

struct KT_PACKED kt_integral {
    struct kt_head head;
    int32_t angle[3];
    uint8_t samples[3];
    int16_t temperature;
    uint8_t zero;
    uint8_t battery;
};

struct KT_PACKED kt_info {
    struct kt_head head;
    uint8_t orientation[6];
    uint16_t firmware;
    uint16_t battery_mv;
    int16_t temperature;
    uint16_t calibration_crc;
    uint32_t serial;
    uint8_t battery;
};

struct KT_PACKED kt_device {
    struct kt_head head;
    uint8_t orientation[6];
    uint8_t hardware;
    uint8_t who_am_i;
    uint16_t gyro_range;
    uint8_t accel_range;
    uint8_t bandwidth;
    uint16_t internal_rate;
    uint32_t serial;
    uint8_t battery;
};

struct KT_PACKED kt_coefficients {
    struct kt_head head;
    uint8_t index;
    float value[3];
    uint16_t calibration_crc;
    uint8_t zero[3];
    uint8_t battery;
};

struct KT_PACKED kt_sync {
    uint8_t magic;
    uint8_t version_type;
    uint8_t suit;
    uint8_t sequence;
    uint32_t clock_us;
    uint32_t frame_counter;
    uint8_t frame_length;
    uint8_t slots;
    uint8_t command;
    uint32_t target;
    uint8_t value[5];
    uint16_t nonce;
    uint8_t command_serial;
};

/* --- Receiver and computer: COBS(kind, body, CRC-16) 00 ------------------------------------------- */

enum kt_kind {
    KT_FRAME_MODE = 0x01,
    KT_FRAME_CHANNEL = 0x02,
    KT_FRAME_COMMAND = 0x03,
    KT_FRAME_HELLO = 0x20,
    KT_FRAME_PACKET = 0x21,
    KT_FRAME_STATUS = 0x22
};

enum kt_slot { KT_SLOT_SILENT = 0, KT_SLOT_HEARD = 1, KT_SLOT_COLLIDING = 2 };

struct KT_PACKED kt_frame_hello {
    uint8_t kind;
    uint8_t version;
    uint8_t hardware;
    uint16_t firmware;
    uint32_t serial;
};

struct KT_PACKED kt_frame_packet {
    uint8_t kind;
    uint32_t clock_us;
    uint8_t address[6];
    uint8_t loss; /* minus RSSI, dB */
    uint8_t channel;
    uint8_t payload[KT_PAYLOAD_SIZE];
};

struct KT_PACKED kt_frame_status {
    uint8_t kind;
    uint32_t clock_us;
    uint32_t received;
    uint32_t crc_errors;
    uint32_t dropped;
    uint8_t slots[KT_MOST_TAGS];
};

struct KT_PACKED kt_frame_mode {
    uint8_t kind;
    uint8_t mode;
};

struct KT_PACKED kt_frame_channel {
    uint8_t kind;
    uint8_t channel;
};

struct KT_PACKED kt_frame_command {
    uint8_t kind;
    uint32_t serial;
    uint8_t address_rest[2];
    uint8_t command;
    uint8_t value[5];
    uint16_t nonce;
};

/* --- What the compiler must agree to -------------------------------------------------------------- */

KT_ASSERT(head, sizeof(struct kt_head) == 8);
KT_ASSERT(sample, sizeof(struct kt_sample) == KT_PAYLOAD_SIZE);
KT_ASSERT(integral, sizeof(struct kt_integral) == KT_PAYLOAD_SIZE);
KT_ASSERT(info, sizeof(struct kt_info) == KT_PAYLOAD_SIZE);
KT_ASSERT(device, sizeof(struct kt_device) == KT_PAYLOAD_SIZE);
KT_ASSERT(coefficients, sizeof(struct kt_coefficients) == KT_PAYLOAD_SIZE);
KT_ASSERT(sync, sizeof(struct kt_sync) == KT_PAYLOAD_SIZE);
KT_ASSERT(float32, sizeof(float) == 4);
KT_ASSERT(sample_gyro, offsetof(struct kt_sample, gyro) == 14);
KT_ASSERT(sample_accel, offsetof(struct kt_sample, accel) == 20);
KT_ASSERT(sample_battery, offsetof(struct kt_sample, battery) == 26);
KT_ASSERT(integral_samples, offsetof(struct kt_integral, samples) == 20);
KT_ASSERT(integral_temperature, offsetof(struct kt_integral, temperature) == 23);
KT_ASSERT(info_serial, offsetof(struct kt_info, serial) == 22);
KT_ASSERT(device_serial, offsetof(struct kt_device, serial) == 22);
KT_ASSERT(coefficients_crc, offsetof(struct kt_coefficients, calibration_crc) == 21);
KT_ASSERT(sync_target, offsetof(struct kt_sync, target) == 15);
KT_ASSERT(sync_nonce, offsetof(struct kt_sync, nonce) == 24);
KT_ASSERT(frame_hello, sizeof(struct kt_frame_hello) == 9);
KT_ASSERT(frame_packet, sizeof(struct kt_frame_packet) == 40);
KT_ASSERT(frame_status, sizeof(struct kt_frame_status) == 32);
KT_ASSERT(frame_command, sizeof(struct kt_frame_command) == 15);

/* CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF, no reflection; "123456789" gives 0x29B1. */
static inline uint16_t kt_crc16(const uint8_t *data, size_t size)
{
    uint16_t crc = 0xFFFF;
    for (size_t i = 0; i < size; i++) {
        crc = (uint16_t)(crc ^ (uint16_t)(data[i] << 8));
        for (int bit = 0; bit < 8; bit++)
            crc = (uint16_t)((crc & 0x8000) ? (crc << 1) ^ 0x1021 : crc << 1);
    }
    return crc;
}

#endif
