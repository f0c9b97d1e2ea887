// SPDX-License-Identifier: BSD-3-Clause
// One end of a link between two cells: stop and wait, and signs of life.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "skinctl/core/contract.hpp"
#include "skinctl/skin_network/cell_message.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The numbers of tries and missed beacons before an end takes the link for cut.
struct LinkSettings {
  int tries = 12;  ///< tries of one message, 2 to 200
  int missed = 3;  ///< beacons missed in a row, 2 to 200

  /// The settings for links that lose the share `loss` of their frames, 0 to 0.5: so many tries and beacons
  /// that a healthy link is taken for cut about once in 1e9 messages or beacons. Three beacons are right up
  /// to 0.1 % only: at 10 % a skin of 10 000 cells would otherwise see 10 000 cuts a second.
  [[nodiscard]] static LinkSettings for_loss(double loss) {
    require(loss >= 0 && loss <= 0.5, "link: share of lost frames", loss, "0 to 0.5");
    const auto count = [](double miss, double least) {
      return int(std::ceil(std::max(least, -20.7 / std::log(std::clamp(miss, 1e-3, 0.9)))));
    };
    return {count(1 - (1 - loss) * (1 - loss), 12), count(loss, 3)};
  }
};

/// One end of a link, and its memory. Each call takes an event and gives what to send and what became of the
/// port. Ends that disagree whether their link is up would lose messages: each time that an end goes down it
/// takes a new session number, the other end sees that and goes down as well, and both are up again when each
/// has heard the other's present number.
class LinkEnd {
 public:
  enum class Port : std::uint8_t { same, went_up, went_down, restarted };
  struct Result {
    Port port = Port::same;  ///< change of the link; `restarted`: down and up again
    std::optional<LinkFrame> send{};
    std::optional<CellMessage> received{};
    bool free = false;  ///< whether a further message may be sent
  };

  [[nodiscard]] bool up() const noexcept { return up_; }
  [[nodiscard]] bool free() const noexcept { return up_ && !waiting_; }

  /// Sends a message; only where `free()`.
  [[nodiscard]] LinkFrame send(const CellMessage& message) noexcept {
    out_ = frame(LinkFrame::Kind::data);
    out_.message = message;
    out_.number = next_;
    waiting_ = true;
    tries_ = 1;
    return out_;
  }

  /// Takes the event that no receipt came in time: repeats the message, or goes down after the last try.
  [[nodiscard]] Result timeout(const LinkSettings& s) noexcept {
    Result r;
    if (!waiting_) return r;
    if (tries_ >= s.tries) {
      go_down(r);
      r.send = frame(LinkFrame::Kind::beacon);
      return r;
    }
    ++tries_;
    r.send = out_;
    return r;
  }

  /// Sends a sign of life; to be called once each 4 ms. Goes down when too many of the other end were missed.
  [[nodiscard]] Result beat(const LinkSettings& s) noexcept {
    Result r;
    missed_ = std::uint8_t(std::min(255, missed_ + 1));
    if (missed_ > s.missed) {
      if (up_) go_down(r);
      peer_ = 0;
    }
    r.send = frame(LinkFrame::Kind::beacon);
    return r;
  }

  /// Takes a frame from the other end.
  /// @param room  whether a report could be kept: one that could not is sent again.
  [[nodiscard]] Result receive(const LinkFrame& f, bool room) noexcept {
    Result r;
    if (f.session == 0) return r;
    missed_ = 0;
    if (f.session != peer_) {
      const bool was_up = up_;
      if (up_) go_down(r);
      peer_ = f.session;
      if (was_up) r.send = frame(LinkFrame::Kind::beacon);
    }
    if (f.peer != session_) return r;  // it means an earlier life of this end
    if (!up_) {
      up_ = true;
      next_ = expected_ = waiting_ = false;
      r.port = r.port == Port::went_down ? Port::restarted : Port::went_up;
      r.free = true;
      r.send = frame(LinkFrame::Kind::beacon);
    }
    switch (f.kind) {
      case LinkFrame::Kind::beacon:
        break;
      case LinkFrame::Kind::data: {
        const bool fresh = f.number == expected_;
        if (fresh && f.message.kind == CellMessage::Kind::report && !room) {
          r.send = frame(LinkFrame::Kind::busy);
          r.send->number = f.number;
          break;
        }
        if (fresh) {
          expected_ = !expected_;
          r.received = f.message;
        }
        r.send = frame(LinkFrame::Kind::receipt);
        r.send->number = f.number;
        break;
      }
      case LinkFrame::Kind::receipt:
        if (waiting_ && f.number == out_.number) waiting_ = false, next_ = !next_, r.free = true;
        break;
      case LinkFrame::Kind::busy:
        if (waiting_ && f.number == out_.number) tries_ = 1;
        break;
    }
    return r;
  }

 private:
  [[nodiscard]] LinkFrame frame(LinkFrame::Kind kind) const noexcept {
    LinkFrame f;
    f.kind = kind;
    f.session = session_;
    f.peer = peer_;
    return f;
  }
  void go_down(Result& r) noexcept {
    up_ = waiting_ = false;
    session_ = session_ == 255 ? std::uint8_t(1) : std::uint8_t(session_ + 1);
    r.port = Port::went_down;
  }

  LinkFrame out_{};
  std::uint8_t session_ = 1, peer_ = 0, missed_ = 0;
  int tries_ = 0;
  bool up_ = false, waiting_ = false, next_ = false, expected_ = false;
};

SKINCTL_END_NAMESPACE
