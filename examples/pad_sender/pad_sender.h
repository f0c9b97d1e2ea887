/* A pad of your own as a skin: C99 for a microcontroller, without allocation or operating system. It
 * reads the channels of each cell, keeps what the protocol asks of a sender, and writes datagrams of
 * version 3 (../adapters/skin/PROTOCOL.md) into a buffer that your UDP or serial line sends. At the other
 * end of a serial line `skin_bridge --from datagrams:/dev/ttyACM0 --to udp:127.0.0.1:50100` makes UDP of it.
 *
 *     static skin_pad pad;
 *     skin_pad_start(&pad, &settings);
 *     each sampling period: skin_pad_measure(&pad, now);
 *                           do send(buffer, skin_pad_write(&pad, now, buffer)); while (skin_pad_due(&pad));
 */
#ifndef SKINCTL_PAD_SENDER_H
#define SKINCTL_PAD_SENDER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifndef SKIN_PAD_CELLS
#define SKIN_PAD_CELLS 32 /* room for so many cells, 32 bytes each with four channels */
#endif
#ifndef SKIN_PAD_CHANNELS
#define SKIN_PAD_CHANNELS 4 /* room for so many channels of a cell, at most 32 */
#endif
#define SKIN_PAD_LARGEST 1472 /* bytes of the longest datagram: what a buffer has room for */

/* A reading of a cell as its kind states it, in the receiver's C++ as here: `Reading{"pressure", 0, 1}`. */
typedef struct {
  const char* name;
  float min, max;
} skin_reading;

typedef struct {
  const char* kind;             /* name of the kind of sensor */
  const skin_reading* readings; /* of each channel */
  uint8_t cells, channels;
  uint32_t first_cell; /* id of cell 0; the others count on from it */
  uint32_t pressures;  /* bit c: channel c is a pressure, whose unrest is told */
  uint16_t full;       /* count that `max` stands for; 0 stands for `min` */
  uint16_t threshold;  /* a cell is sent when a channel is so many counts from what was sent, or more */
  uint16_t keep_alive; /* measurements after which a cell is sent in any case; of 100 ms, say */
  uint16_t (*read)(void* user, unsigned cell, unsigned channel); /* a count of your converter, 0 to `full` */
  void* user;
} skin_pad_settings;

typedef struct {
  uint16_t last[SKIN_PAD_CHANNELS], sent[SKIN_PAD_CHANNELS]; /* counts: measured last, sent last */
  uint64_t squares;                                          /* of the changes since it was sent */
  uint16_t measured, differences;                            /* since it was sent */
  uint8_t due;
} skin_pad_cell;

typedef struct {
  skin_pad_settings s;
  uint32_t kind, sequence;
  int64_t measured_at;
  float scale[SKIN_PAD_CHANNELS]; /* (max - min) / full */
  uint8_t started, pressures;
  skin_pad_cell cell[SKIN_PAD_CELLS];
} skin_pad;

/* The number that tells kinds apart, `KindTable::fingerprint` of the receiver. */
uint32_t skin_pad_fingerprint(const char* kind, const skin_reading* readings, unsigned channels);

/* 0 for settings that cannot work (no cells or channels, or more than there is room for; no `read`; `full` or
 * `keep_alive` 0), else 1. The settings' texts and readings have to live on. */
int skin_pad_start(skin_pad* pad, const skin_pad_settings* settings);

/* Reads all channels of all cells. `now` [ns] is a clock of yours, from any start, that never runs back. */
void skin_pad_measure(skin_pad* pad, int64_t now);

/* Whether cells wait to be sent. */
int skin_pad_due(const skin_pad* pad);

/* Writes a datagram with cells that are due, as many as fit; with none it is a heartbeat, which says that
 * the pad lives. Returns its bytes. `buffer` has room for SKIN_PAD_LARGEST. */
size_t skin_pad_write(skin_pad* pad, int64_t now, uint8_t* buffer);

#ifdef __cplusplus
}
#endif
#endif
