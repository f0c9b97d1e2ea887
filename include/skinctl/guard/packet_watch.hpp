// SPDX-License-Identifier: BSD-3-Clause
// Watches for lost packets of a robot that numbers them.
#pragma once

#include <bit>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The memory of a packet watch. Trivially copyable.
struct PacketMemory {
  bool started = false;
  std::uint32_t last = 0;     ///< number of the newest packet
  std::uint64_t missing = 0;  ///< a bit for each of the last 64 packets; 1: it did not arrive
  std::uint64_t lost = 0;     ///< number of all lost packets
};

/// Counts the gaps in the numbers of packets: `packets_lost` while more than `max_missing` of the last 64 are
/// missing. The guard then brakes, and goes on by itself once enough have arrived again. Numbers wrap at
/// 2^32; one that is not newer than the last (a copy, a late packet) changes nothing: its state is refused by
/// its stamp.
class PacketWatch {
 public:
  using Memory = PacketMemory;

  /// Throws `ConfigurationError` for `max_missing` above 63.
  explicit PacketWatch(unsigned max_missing = 4) : max_missing_(max_missing) {
    require(max_missing <= 63, "PacketWatch: max_missing", max_missing, "0 to 63 of 64 packets");
  }

  /// The status after a packet with the number `number` has arrived.
  [[nodiscard]] Status step(Memory& m, std::uint32_t number) const noexcept {
    const std::uint32_t ahead = number - m.last;
    if (!m.started) {
      m.started = true;
      m.last = number;
    } else if (ahead != 0 && ahead < (std::uint32_t(1) << 31)) {
      const std::uint32_t gap = ahead - 1;
      m.lost += gap;
      m.last = number;
      if (gap >= 63) {
        m.missing = ~std::uint64_t(1);
      } else {
        m.missing = ((m.missing << gap) | ((std::uint64_t(1) << gap) - 1)) << 1;
      }
    }
    return unsigned(std::popcount(m.missing)) > max_missing_ ? Status(Reason::packets_lost) : Status{};
  }

 private:
  unsigned max_missing_;
};

SKINCTL_END_NAMESPACE
