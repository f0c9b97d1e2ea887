// SPDX-License-Identifier: BSD-3-Clause
// How the cells of a skin find their ids and their tree: by flood and echo, in epochs.
#pragma once

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "skinctl/skin_network/cell_message.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The memory of a cell: 60 bytes, whatever the skin.
struct CellMemory {
  static constexpr std::uint8_t nobody = 0xff;
  struct Span {
    std::uint16_t count = 0, fresh = 0, first_label = 0;
  };
  std::uint32_t epoch = 0;  ///< epoch of the tree that the cell belongs to; 0: none since it was switched on
  std::uint32_t changed = 0;  ///< one more than the last epoch whose end the cell passed on
  std::uint16_t hops = 0;
  std::uint16_t count = 0;  ///< cells of its subtree, itself included; 0: not all have answered
  std::uint16_t fresh = 0;  ///< cells of its subtree without an id
  std::uint16_t id = 0;     ///< id of the cell, kept over epochs
  std::uint16_t label = 0;
  std::array<Span, CellNet::ports> spans{};                ///< counts and labels of the children, by port
  std::array<std::uint16_t, CellNet::ports> neighbours{};  ///< neighbour at each port: id << 2 | its port
  std::uint16_t highest = 0;                               ///< largest id in its subtree
  std::uint8_t parent = nobody;
  std::uint8_t live = 0, waiting = 0, children = 0, named = 0;  ///< sets of ports, bit p: port p
  std::uint8_t reported = 0;
  std::array<std::uint8_t, 2> spare{};  ///< no padding: `check_word` is over all bytes
};

/// An event at a cell: a message at a port, or a port that went up or down.
struct CellEvent {
  enum class Kind : std::uint8_t { received, port_up, port_down };
  Kind kind = Kind::received;
  std::uint8_t port = 0;
  CellMessage message{};
};

/// The messages of a cell upon an event: at most two to each port.
class CellOutput {
 public:
  struct Item {
    std::uint8_t port;
    CellMessage message;
  };
  [[nodiscard]] const Item* begin() const noexcept { return items_.data(); }
  [[nodiscard]] const Item* end() const noexcept { return items_.data() + size_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  void to(std::uint8_t port, const CellMessage& m) noexcept {
    if (port < CellNet::ports && size_ < items_.size()) items_[size_++] = {port, m};
  }
  void to_all(std::uint8_t ports, const CellMessage& m) noexcept {
    for (std::uint8_t p = 0; p < CellNet::ports; ++p)
      if (ports >> p & 1) to(p, m);
  }

 private:
  std::array<Item, 16> items_{};
  std::size_t size_ = 0;
};

struct CellStep {
  CellMemory memory;
  CellOutput output;
};

namespace detail {

/// A cell in the course of one event.
struct CellAtWork {
  using Kind = CellMessage::Kind;
  CellMemory m;
  CellOutput out{};

  [[nodiscard]] static std::uint8_t bit(std::uint8_t port) noexcept { return std::uint8_t(1u << port); }
  static void remove(std::uint8_t& set, std::uint8_t port) noexcept { set &= std::uint8_t(~(1u << port)); }

  /// Passes on that `epoch` has ended, which floods the skin: each cell does so once.
  void flood(std::uint32_t epoch, std::uint8_t ports) noexcept {
    if (epoch < m.epoch || epoch >= CellNet::last_epoch || epoch < m.changed) return;
    m.changed = epoch + 1;
    out.to_all(ports, {.kind = Kind::changed, .epoch = epoch});
  }
  void check() noexcept {
    if (m.waiting != 0 || m.count != 0 || m.parent >= CellNet::ports || m.epoch == 0) return;
    unsigned count = 1, fresh = m.id == 0;
    m.highest = std::max(m.highest, m.id);
    for (std::uint8_t p = 0; p < CellNet::ports; ++p)
      if (m.children >> p & 1) count += m.spans[p].count, fresh += m.spans[p].fresh;
    // More than 16 bits hold: a cell below lies, or the skin is too large. The PC sees it.
    m.count = std::uint16_t(std::min(count, 0xffffu));
    m.fresh = std::uint16_t(std::min(fresh, 0xffffu));
    out.to(m.parent,
           {.kind = Kind::echo, .epoch = m.epoch, .a = m.count, .b = m.fresh, .neighbours = {m.highest}});
  }
  void explore(std::uint8_t p, const CellMessage& e) noexcept {
    if (e.epoch < m.epoch) {
      out.to(p, {.kind = Kind::changed, .epoch = m.epoch});
    } else if (e.epoch == m.epoch) {
      remove(m.waiting, p);
      check();
    } else if (e.epoch < CellNet::last_epoch) {
      CellMemory fresh;
      fresh.epoch = e.epoch;
      fresh.live = std::uint8_t(m.live | bit(p));
      fresh.id = e.forget ? std::uint16_t(0) : m.id;
      fresh.parent = p;
      fresh.hops = e.a;
      fresh.waiting = std::uint8_t(fresh.live & ~bit(p));
      m = fresh;
      CellMessage on = e;
      on.a = std::uint16_t(e.a + 1);
      out.to_all(m.waiting, on);
      check();
    }
  }
  void assign(std::uint8_t p, const CellMessage& a) noexcept {
    if (p != m.parent || m.label != 0 || m.count == 0 || a.a == 0) return;
    unsigned label = a.a, first = a.b;
    m.label = a.a;
    if (m.id == 0 && first <= CellNet::highest_id) m.id = std::uint16_t(first++);
    ++label;
    for (std::uint8_t c = 0; c < CellNet::ports; ++c) {
      if (!(m.children >> c & 1)) continue;
      m.spans[c].first_label = std::uint16_t(label);
      out.to(c, {.kind = Kind::assign,
                 .epoch = m.epoch,
                 .a = std::uint16_t(label),
                 .b = std::uint16_t(std::min(first, 0xffffu))});
      label += m.spans[c].count, first += m.spans[c].fresh;
    }
    for (std::uint8_t c = 0; c < CellNet::ports; ++c)
      if (m.live >> c & 1) out.to(c, {.kind = Kind::name, .epoch = m.epoch, .a = m.id, .b = c});
    report();
  }
  void report() noexcept {
    if (m.label == 0 || (m.live & ~m.named) != 0 || m.reported != 0 || m.parent == CellMemory::nobody) return;
    m.reported = 1;
    out.to(m.parent,
           {.kind = Kind::report, .epoch = m.epoch, .a = m.id, .b = m.label, .neighbours = m.neighbours});
  }
  void received(std::uint8_t p, const CellMessage& x) noexcept {
    if (x.kind == Kind::explore) return explore(p, x);
    if (x.kind == Kind::changed) {
      // A neighbour that knows no epoch was switched on, or has lost its memory.
      const std::uint32_t ended = x.epoch == 0 ? m.epoch : x.epoch;
      if (x.epoch > m.epoch && x.epoch - m.epoch > CellNet::leap && m.epoch > 0) {
        remove(m.waiting, p);  // it will never join: the others do not wait for it
        return check();
      }
      return flood(ended, std::uint8_t(m.live & ~bit(p)));
    }
    if (x.epoch > m.epoch) return flood(x.epoch, m.live);  // this cell has missed an epoch
    if (x.epoch < m.epoch) return;
    switch (x.kind) {
      case Kind::echo:
        if (!(m.waiting >> p & 1)) return;
        remove(m.waiting, p);
        m.children |= bit(p);
        m.spans[p] = {x.a, x.b, 0};
        m.highest = std::max(m.highest, x.neighbours[0]);
        return check();
      case Kind::assign:
        return assign(p, x);
      case Kind::name:
        m.neighbours[p] = std::uint16_t((x.a & 0x3fffu) << 2 | (x.b & 3u));
        m.named |= bit(p);
        return report();
      case Kind::report:
        if (m.parent != CellMemory::nobody && p != m.parent) out.to(m.parent, x);
        return;
      case Kind::explore:
      case Kind::changed:
        return;
    }
  }
  void port_down(std::uint8_t p) noexcept {
    remove(m.live, p), remove(m.waiting, p), remove(m.children, p), remove(m.named, p);
    m.neighbours[p] = 0;
    if (m.parent == p) m.parent = CellMemory::nobody;
    flood(m.epoch, m.live);
    check();
    report();
  }
  void port_up(std::uint8_t p) noexcept {
    m.live |= bit(p);
    flood(m.epoch, m.live);
  }
};

}  // namespace detail

/// The behaviour of a cell: a pure function, with nothing unbounded in it, for a firmware of any kind. A port
/// beyond the fourth and a message that makes no sense change nothing.
///
/// - The flood (`explore`) of a new epoch makes a tree of shortest times; the echo counts what is below each
///   port; `assign` comes down with labels and ids from these counts; neighbours tell each other their names,
///   and each cell reports its own to the PC. 4 links + cells - 1 messages, three times the depth, then the
///   reports.
/// - Whatever ends or joins, anywhere, floods `changed`: the PC begins the next epoch, and that is the whole
///   repair.
[[nodiscard]] inline CellStep step(const CellMemory& memory, const CellEvent& event) noexcept {
  detail::CellAtWork cell{memory};
  if (event.port < CellNet::ports) {
    if (event.kind == CellEvent::Kind::received)
      cell.received(event.port, event.message);
    else if (event.kind == CellEvent::Kind::port_up)
      cell.port_up(event.port);
    else
      cell.port_down(event.port);
  }
  return {cell.m, cell.out};
}

/// Whether the cell would keep this report for its parent, so that it needs room for it. One of another
/// epoch, or in a cell that has lost its parent, is accepted and dropped: refused, it would hold up its link,
/// and with it the next epoch.
[[nodiscard]] inline bool keeps(const CellMemory& m, const CellMessage& report) noexcept {
  return report.epoch == m.epoch && m.parent < CellNet::ports;
}

/// The port on which a message to the cell with this label leaves; `nobody` for the cell's own label, or if
/// no port leads there.
[[nodiscard]] inline std::uint8_t route(const CellMemory& m, std::uint16_t label) noexcept {
  if (label == m.label || m.label == 0) return CellMemory::nobody;
  for (std::uint8_t p = 0; p < CellNet::ports; ++p)
    if ((m.children >> p & 1) && label >= m.spans[p].first_label &&
        label - m.spans[p].first_label < m.spans[p].count)
      return p;
  return m.parent;
}

/// Checksum of all of a cell's memory, kept beside it. A cell whose memory does not agree with it any more
/// starts as if it were switched on, with the ports that are up, and sends `changed(0)` on them.
[[nodiscard]] inline std::uint32_t check_word(const CellMemory& m) noexcept {
  static_assert(std::is_trivially_copyable_v<CellMemory> &&
                std::has_unique_object_representations_v<CellMemory>);
  std::array<std::uint8_t, sizeof(CellMemory)> bytes;
  std::memcpy(bytes.data(), &m, sizeof m);
  return detail::crc32_of_frame(bytes);
}

/// The first step of a cell that has lost its memory: `live` are the ports that are up, a bit each.
[[nodiscard]] inline CellStep restarted(std::uint8_t live) noexcept {
  CellStep s;
  s.memory.live = live & 0x0f;
  s.output.to_all(s.memory.live, {.kind = CellMessage::Kind::changed});
  return s;
}

SKINCTL_END_NAMESPACE
