// SPDX-License-Identifier: BSD-3-Clause
// What cells of a skin tell each other, and the bytes of it on a link.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The limits of a network of cells. A cell has four ports, an id of 14 bits (0: none yet; 16383 addresses
/// all) and a label, its place in a depth-first order of the tree.
struct CellNet {
  static constexpr int ports = 4;
  static constexpr std::uint16_t highest_id = 16382;
  /// Bound of the epochs of healthy cells, which at one each 5 ms reach it after 124 days.
  static constexpr std::uint32_t last_epoch = 0x7fffffff;
  /// Largest lead of a neighbour's epoch, a day of epochs without pause; one further ahead is broken.
  static constexpr std::uint32_t leap = 1u << 24;
};

/// A message between neighbours, or between the PC and the cell at its port.
struct CellMessage {
  enum class Kind : std::uint8_t {
    explore,  ///< invites to the tree of `epoch`: a = hops of the receiver, forget = it drops its id
    echo,     ///< of the sender's subtree: a = cells, b = cells without an id, neighbours[0] = highest id
    changed,  ///< the network is no longer that of `epoch`
    assign,   ///< a = label of the receiver, b = first id that it may give
    name,     ///< of the sender: a = id, b = its port on this link
    report    ///< of a cell to the PC: a = id, b = label, neighbours = (id << 2 | port) or 0
  };
  static constexpr int kinds = 6;
  Kind kind = Kind::changed;
  bool forget = false;
  std::uint32_t epoch = 0;
  std::uint16_t a = 0, b = 0;
  std::array<std::uint16_t, CellNet::ports> neighbours{};

  friend bool operator==(const CellMessage&, const CellMessage&) = default;
};

/// A frame on a link: a message with its number, its receipt, or a sign of life.
struct LinkFrame {
  enum class Kind : std::uint8_t { beacon, data, receipt, busy };
  Kind kind = Kind::beacon;
  bool number = false;
  std::uint8_t session = 0;  ///< session of the sender: another one each time that its port was down
  std::uint8_t peer = 0;     ///< session of the other end that the sender last heard; 0: none
  CellMessage message{};

  friend bool operator==(const LinkFrame&, const LinkFrame&) = default;
};

namespace detail {
/// CRC-32 (IEEE 802.3), by a table of 16 words: cells have little memory.
[[nodiscard]] constexpr std::uint32_t crc32_of_frame(std::span<const std::uint8_t> bytes) noexcept {
  constexpr auto table = [] {
    std::array<std::uint32_t, 16> t{};
    for (std::uint32_t n = 0; n < 16; ++n) {
      t[n] = n;
      for (int k = 0; k < 4; ++k) t[n] = (t[n] & 1) != 0 ? t[n] >> 1 ^ 0xedb88320u : t[n] >> 1;
    }
    return t;
  }();
  std::uint32_t crc = 0xffffffff;
  for (const std::uint8_t b : bytes) {
    crc ^= b;
    crc = crc >> 4 ^ table[crc & 15];
    crc = crc >> 4 ^ table[crc & 15];
  }
  return ~crc;
}
}  // namespace detail

/// A frame on the wire: 24 bytes, little-endian, the last four a CRC-32.
using FrameBytes = std::array<std::uint8_t, 24>;

[[nodiscard]] constexpr FrameBytes encode(const LinkFrame& f) noexcept {
  FrameBytes out{};
  out[0] = std::uint8_t(unsigned(f.kind) | unsigned(f.number) << 2 | unsigned(f.message.kind) << 3 |
                        unsigned(f.message.forget) << 6);
  out[1] = f.session;
  out[2] = f.peer;
  std::size_t at = 4;
  const auto put = [&](std::uint32_t x, int bytes) {
    for (int k = 0; k < bytes; ++k) out[at++] = std::uint8_t(x >> 8 * k);
  };
  put(f.message.epoch, 4);
  put(f.message.a, 2), put(f.message.b, 2);
  for (const std::uint16_t n : f.message.neighbours) put(n, 2);
  put(detail::crc32_of_frame(std::span(out).first<20>()), 4);
  return out;
}

/// The frame, or none where length, CRC or a field is wrong.
[[nodiscard]] constexpr std::optional<LinkFrame> decode(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() != FrameBytes{}.size()) return {};
  std::size_t at = 4;
  const auto take = [&](int count) {
    std::uint32_t x = 0;
    for (int k = 0; k < count; ++k) x |= std::uint32_t(bytes[at++]) << 8 * k;
    return x;
  };
  LinkFrame f;
  const unsigned kind = bytes[0] >> 3 & 7u;
  if (bytes[0] > 0x7f || bytes[3] != 0 || kind >= unsigned(CellMessage::kinds)) return {};
  f.kind = LinkFrame::Kind(bytes[0] & 3u);
  f.number = (bytes[0] & 4u) != 0;
  f.message.kind = CellMessage::Kind(kind);
  f.message.forget = (bytes[0] & 0x40u) != 0;
  f.session = bytes[1];
  f.peer = bytes[2];
  f.message.epoch = take(4);
  f.message.a = std::uint16_t(take(2)), f.message.b = std::uint16_t(take(2));
  for (std::uint16_t& n : f.message.neighbours) n = std::uint16_t(take(2));
  if (take(4) != detail::crc32_of_frame(bytes.first<20>())) return {};
  return f;
}

SKINCTL_END_NAMESPACE
