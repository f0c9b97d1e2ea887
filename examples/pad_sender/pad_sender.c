#include "pad_sender.h"

#include <string.h>

enum { header = 28, largest_number = 65534, unsaid = 65535 };

static uint8_t* put(uint8_t* at, uint64_t number, unsigned bytes) {
  unsigned k;
  for (k = 0; k < bytes; ++k) *at++ = (uint8_t)(number >> (8 * k));
  return at;
}
static uint32_t bits_of(float number) {
  uint32_t bits;
  memcpy(&bits, &number, sizeof bits);
  return bits;
}
static uint32_t mix(uint32_t hash, uint8_t byte) { return (hash ^ byte) * 16777619u; }
static uint32_t mix_text(uint32_t hash, const char* text) {
  while (*text != 0) hash = mix(hash, (uint8_t)*text++);
  return mix(hash, 0xff);
}

uint32_t skin_pad_fingerprint(const char* kind, const skin_reading* readings, unsigned channels) {
  uint32_t hash = mix_text(2166136261u, kind);
  unsigned c, k;
  for (c = 0; c < channels; ++c) {
    hash = mix_text(hash, readings[c].name);
    for (k = 0; k < 32; k += 8) hash = mix(hash, (uint8_t)(bits_of(readings[c].min) >> k));
    for (k = 0; k < 32; k += 8) hash = mix(hash, (uint8_t)(bits_of(readings[c].max) >> k));
  }
  return hash;
}

int skin_pad_start(skin_pad* pad, const skin_pad_settings* settings) {
  unsigned c;
  if (settings->cells == 0 || settings->cells > SKIN_PAD_CELLS || settings->channels == 0 ||
      settings->channels > SKIN_PAD_CHANNELS || settings->channels > 32 || settings->full == 0 ||
      settings->keep_alive == 0 || settings->read == NULL)
    return 0;
  memset(pad, 0, sizeof *pad);
  pad->s = *settings;
  pad->kind = skin_pad_fingerprint(settings->kind, settings->readings, settings->channels);
  for (c = 0; c < settings->channels; ++c) {
    pad->scale[c] = (settings->readings[c].max - settings->readings[c].min) / (float)settings->full;
    pad->pressures = (uint8_t)(pad->pressures + ((settings->pressures >> c) & 1u));
  }
  return 1;
}

void skin_pad_measure(skin_pad* pad, int64_t now) {
  unsigned i, c;
  for (i = 0; i < pad->s.cells; ++i) {
    skin_pad_cell* cell = &pad->cell[i];
    for (c = 0; c < pad->s.channels; ++c) {
      uint16_t x = pad->s.read(pad->s.user, i, c);
      if (x > pad->s.full) x = pad->s.full;
      if (pad->started && ((pad->s.pressures >> c) & 1u)) {
        const int32_t change = (int32_t)x - (int32_t)cell->last[c];
        cell->squares += (uint64_t)((int64_t)change * change);
      }
      cell->last[c] = x;
      if ((x > cell->sent[c] ? x - cell->sent[c] : cell->sent[c] - x) >= pad->s.threshold) cell->due = 1;
    }
    if (cell->measured < largest_number) {
      ++cell->measured;
      cell->differences = (uint16_t)(cell->differences + pad->started);
    }
    if (!pad->started || cell->measured >= pad->s.keep_alive) cell->due = 1;
  }
  pad->started = 1;
  pad->measured_at = now;
}

int skin_pad_due(const skin_pad* pad) {
  unsigned i;
  for (i = 0; i < pad->s.cells; ++i)
    if (pad->cell[i].due) return 1;
  return 0;
}

/* Mean square of the changes of all pressures [1/256 count^2], rounded up. */
static uint16_t unrest(const skin_pad* pad, const skin_pad_cell* cell) {
  const uint32_t changes = (uint32_t)cell->differences * pad->pressures;
  uint64_t mean;
  if (changes == 0) return unsaid;
  mean = (256 * cell->squares + changes - 1) / changes;
  return (uint16_t)(mean > largest_number ? largest_number : mean);
}

size_t skin_pad_write(skin_pad* pad, int64_t now, uint8_t* buffer) {
  uint8_t* at = buffer + header;
  uint16_t count = 0;
  unsigned i, c;
  const unsigned room = (SKIN_PAD_LARGEST - 52) / (16 + 4u * pad->s.channels);
  for (i = 0; i < pad->s.cells && count < room; ++i) {
    skin_pad_cell* cell = &pad->cell[i];
    if (!cell->due) continue;
    at = put(at, pad->s.first_cell + i, 4);
    at = put(at, (uint64_t)pad->measured_at, 8);
    at = put(at, cell->measured, 2);
    at = put(at, unrest(pad, cell), 2);
    for (c = 0; c < pad->s.channels; ++c) {
      const skin_reading* r = &pad->s.readings[c];
      const uint16_t x = cell->last[c];
      at = put(at, bits_of(x == pad->s.full ? r->max : r->min + pad->scale[c] * (float)x), 4);
      cell->sent[c] = cell->last[c];
    }
    cell->squares = 0;
    cell->measured = cell->differences = cell->due = 0;
    ++count;
  }
  memcpy(buffer, "SKIN", 4);
  put(put(buffer + 4, 3, 2), count, 2);
  put(put(buffer + 8, pad->sequence++, 4), (uint64_t)now, 8);
  put(put(put(buffer + 20, 0, 2), pad->s.channels, 2), pad->kind, 4);
  return (size_t)(at - buffer);
}
