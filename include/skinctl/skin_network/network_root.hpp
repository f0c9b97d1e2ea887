// SPDX-License-Identifier: BSD-3-Clause
// The PC's side of the skin's network: it begins epochs, gives labels and ids, and collects the reports.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/skin_network/cell_message.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A cell as it reported itself.
struct CellNames {
  std::uint16_t id = 0, label = 0;
  struct Neighbour {
    std::uint16_t id = 0;  ///< id of the neighbour; 0: none
    std::uint8_t port = 0;
    friend bool operator==(const Neighbour&, const Neighbour&) = default;
  };
  std::array<Neighbour, CellNet::ports> neighbours{};
  friend bool operator==(const CellNames&, const CellNames&) = default;
};

/// The root of the tree, with the ports of the interface boxes. Feed it what arrives and the time; it gives
/// what to send.
class NetworkRoot {
 public:
  struct Send {
    std::size_t port;
    CellMessage message;
  };
  enum class State {
    no_port,    ///< no port is up
    exploring,  ///< echoes of some ports have not arrived yet
    reporting,  ///< ids are given, reports come in
    organised,  ///< every cell has reported
    too_many,   ///< more cells than ids: a cell lies, or the skin needs several PCs
    stalled  ///< nothing for `patience`: a cell does not answer although its link is up, or lies about its count
  };

  /// Throws `ConfigurationError` for no or more than 1024 ports.
  explicit NetworkRoot(std::size_t ports) : ports_(ports) {
    require(ports >= 1 && ports <= 1024, "network: ports of the boxes", double(ports), "1 to 1024");
  }

  [[nodiscard]] State state() const noexcept { return state_; }
  [[nodiscard]] std::uint32_t epoch() const noexcept { return epoch_; }
  [[nodiscard]] std::size_t cells() const noexcept { return cells_; }
  /// The reports of this epoch, in the order in which they came.
  [[nodiscard]] const std::vector<CellNames>& reports() const noexcept { return reports_; }
  /// The port towards the cell with a label; the number of ports if there is none.
  [[nodiscard]] std::size_t route(std::uint16_t label) const noexcept {
    for (std::size_t p = 0; p < ports_.size(); ++p)
      if (ports_[p].count > 0 && label >= ports_[p].first_label &&
          label - ports_[p].first_label < ports_[p].count)
        return p;
    return ports_.size();
  }

  void port_up(std::size_t port, Nanoseconds now) {
    if (port >= ports_.size()) return;
    ports_[port].up = true;
    begin_later(now);
  }
  void port_down(std::size_t port, Nanoseconds now, std::vector<Send>& out) {
    if (port >= ports_.size()) return;
    ports_[port] = {};
    begin_later(now);
    check(out);
  }
  void received(std::size_t port, const CellMessage& m, Nanoseconds now, std::vector<Send>& out) {
    if (port >= ports_.size() || m.epoch >= CellNet::last_epoch) return;
    using Kind = CellMessage::Kind;
    // A PC that has just started knows no epoch; later, one that is far ahead comes from a broken cell.
    if (epoch_ > 1 && m.epoch > epoch_ + CellNet::leap) {
      if (m.kind == Kind::changed) ports_[port].waiting = false, check(out);
      return;
    }
    if (m.kind == Kind::changed || m.epoch > epoch_) {
      if (m.epoch >= epoch_ || m.epoch == 0) begin_later(now);
      highest_epoch_ = std::max(highest_epoch_, m.epoch);
      return;
    }
    if (m.epoch != epoch_) return;
    heard_ = now;
    Port& p = ports_[port];
    switch (m.kind) {
      case Kind::explore:  // two boxes' ports reach each other through the skin
        p.waiting = false;
        return check(out);
      case Kind::echo:
        if (!p.waiting) return;
        p.waiting = false;
        p.count = m.a, p.fresh = m.b;
        highest_id_ = std::max(highest_id_, m.neighbours[0]);
        return check(out);
      case Kind::name:
      case Kind::assign:
      case Kind::changed:
        return;
      case Kind::report:
        return report(m, now);
    }
  }
  /// Longest time without a message of the present epoch; then it is `stalled`.
  static constexpr Nanoseconds patience = std::chrono::seconds(5);
  /// Begins the next epoch where one is due.
  void tick(Nanoseconds now, std::vector<Send>& out) {
    if ((state_ == State::exploring || state_ == State::reporting) && now - heard_ > patience)
      state_ = State::stalled;
    if (!due_ || now < *due_) return;
    due_.reset();
    heard_ = now;
    epoch_ = std::max(epoch_, highest_epoch_) + 1;
    highest_epoch_ = epoch_;
    reports_.clear();
    seen_.assign(std::size_t(CellNet::highest_id) + 1, false);
    highest_id_ = 0;
    cells_ = 0;
    twice_ = false;
    state_ = State::no_port;
    for (std::size_t p = 0; p < ports_.size(); ++p) {
      ports_[p].waiting = ports_[p].up;
      ports_[p].count = ports_[p].fresh = ports_[p].first_label = 0;
      if (!ports_[p].up) continue;
      state_ = State::exploring;
      out.push_back({p, {.kind = CellMessage::Kind::explore, .forget = forget_, .epoch = epoch_, .a = 1}});
    }
    forgot_ = forget_;
    forget_ = false;
  }
  /// The time at which `tick` begins the next epoch; none if none is due. A stall is found by any later
  /// `tick`.
  [[nodiscard]] std::optional<Nanoseconds> due() const noexcept { return due_; }
  /// Whether two cells have reported one id in this epoch. All ids are then given anew, once; if two do so
  /// again, one of them lies.
  [[nodiscard]] bool ids_twice() const noexcept { return twice_; }

 private:
  struct Port {
    bool up = false, waiting = false;
    std::uint16_t count = 0, fresh = 0, first_label = 0;
  };
  void begin_later(Nanoseconds now) {
    if (!due_) due_ = now + std::chrono::milliseconds(5);  // what ends together is seen together
  }
  void check(std::vector<Send>& out) {
    if (state_ != State::exploring) return;
    std::size_t cells = 0, fresh = 0;
    for (const Port& p : ports_) {
      if (p.up && p.waiting) return;
      cells += p.count, fresh += p.fresh;
    }
    cells_ = cells;
    if (cells > CellNet::highest_id) {
      state_ = State::too_many;
      return;
    }
    // Ids that have been given stay; where the free ones above them are too few, all are given anew.
    if (highest_id_ + fresh > CellNet::highest_id) {
      forget_ = true;
      due_ = Nanoseconds(0);
      return;
    }
    unsigned label = 1, first = highest_id_ + 1u;
    for (std::size_t k = 0; k < ports_.size(); ++k) {
      Port& p = ports_[k];
      // Its neighbour at this port is nobody; also for a cell that was reached from another port first.
      if (p.up) out.push_back({k, {.kind = CellMessage::Kind::name, .epoch = epoch_}});
      if (p.count == 0) continue;
      p.first_label = std::uint16_t(label);
      out.push_back({k,
                     {.kind = CellMessage::Kind::assign,
                      .epoch = epoch_,
                      .a = std::uint16_t(label),
                      .b = std::uint16_t(first)}});
      label += p.count, first += p.fresh;
    }
    state_ = cells > 0 ? State::reporting : State::organised;
  }
  void report(const CellMessage& m, Nanoseconds now) {
    if (state_ != State::reporting || reports_.size() >= cells_) return;
    CellNames names{m.a, m.b, {}};
    for (std::size_t k = 0; k < names.neighbours.size(); ++k)
      names.neighbours[k] = {std::uint16_t(m.neighbours[k] >> 2), std::uint8_t(m.neighbours[k] & 3)};
    if (m.a > 0 && m.a <= CellNet::highest_id) {
      if (seen_[m.a]) {
        twice_ = true;
        // Skins of two PCs that were joined: one epoch in which all ids are given anew. Not two: it would
        // never end.
        if (!forgot_) forget_ = true, begin_later(now);
      }
      seen_[m.a] = true;
    }
    reports_.push_back(names);
    if (reports_.size() == cells_) state_ = State::organised;
  }

  std::vector<Port> ports_;
  std::vector<CellNames> reports_;
  std::vector<bool> seen_;
  std::optional<Nanoseconds> due_;
  Nanoseconds heard_{0};
  std::size_t cells_ = 0;
  std::uint32_t epoch_ = 0, highest_epoch_ = 0;
  std::uint16_t highest_id_ = 0;
  State state_ = State::no_port;
  bool forget_ = false, forgot_ = false, twice_ = false;
};

SKINCTL_END_NAMESPACE
