/* A pad of 64 cells with two pressures and a temperature: prints each measurement, and each datagram that it
 * writes. The same program for this machine and for a Cortex-M. */
#include <stdio.h>

#include "../pad_sender.h"

enum { cells = 64, channels = 3, periods = 200, step = 4000000 };

static uint32_t random_bits = 1;
static unsigned period;

/* Noise on a press that comes and goes; cell 5 is dead, cell 6 at the end of its range. */
static uint16_t read_adc(void* user, unsigned cell, unsigned channel) {
  unsigned x = 30 + 7 * cell + channel;
  (void)user;
  random_bits = 1664525u * random_bits + 1013904223u;
  if (cell == 5) return 100;
  if (cell == 6) return 65535;
  if (channel == 2) return (uint16_t)(2000 + (period / 64));
  if (period > 50 && period < 120 && cell < 20) x += (period - 50) * 20;
  return (uint16_t)(x + (random_bits >> 30));
}

int main(void) {
  static const skin_reading readings[channels] = {{"left", 0, 1}, {"right", 0, 1}, {"temperature", -40, 120}};
  static skin_pad pad;
  static uint8_t buffer[SKIN_PAD_LARGEST];
  skin_pad_settings settings = {"home-made", readings, cells, channels, 500, 3, 4095, 8, 25, read_adc, NULL};
  int64_t now = 5;
  unsigned i, c;
  skin_pad_settings wrong = settings;
  wrong.cells = SKIN_PAD_CELLS + 1;
  if (skin_pad_start(&pad, &wrong)) return 1;
  wrong = settings, wrong.full = 0;
  if (skin_pad_start(&pad, &wrong)) return 1;
  if (!skin_pad_start(&pad, &settings)) return 1;
  for (period = 0; period < periods; ++period) {
    now += step;
    skin_pad_measure(&pad, now);
    for (i = 0; i < cells; ++i) {
      printf("m %u", i);
      for (c = 0; c < channels; ++c) printf(" %u", pad.cell[i].last[c]);
      printf("\n");
    }
    do {
      const size_t size = skin_pad_write(&pad, now + 1000, buffer);
      size_t k;
      printf("d ");
      for (k = 0; k < size; ++k) printf("%02x", buffer[k]);
      printf("\n");
    } while (skin_pad_due(&pad));
  }
  return 0;
}
