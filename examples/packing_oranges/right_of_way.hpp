// Which of two arms goes aside when each is in the other's way.
#pragma once

#include "skinctl/core/time.hpp"

namespace packing {

/// An arm that is kept from its way by the other one for longer than its patience goes aside for a while, then tries
/// again. Whoever goes first has more patience, so that one of them moves, and the other one only if that did not help.
class RightOfWay {
 public:
  static constexpr skinctl::Nanoseconds aside{1'500'000'000};

  void goes_first(bool first) {
    patience_ = first ? skinctl::Nanoseconds(1'600'000'000) : skinctl::Nanoseconds(400'000'000);
  }
  /// A cycle: whether the clearances limit the arm, and its hand stands.
  void step(skinctl::Nanoseconds now, bool kept, bool stands) {
    now_ = now;
    if ((!kept || !stands) && free_since_ < now) free_since_ = now;
  }
  /// How long it has been kept.
  [[nodiscard]] skinctl::Nanoseconds waited() const { return now_ - free_since_; }
  [[nodiscard]] bool is_aside() const { return now_ < until_; }
  [[nodiscard]] bool should_go() const { return !is_aside() && now_ - free_since_ > patience_; }
  void go() {
    until_ = free_since_ = now_ + aside;
    ++times_;
  }
  [[nodiscard]] int times() const { return times_; }

 private:
  skinctl::Nanoseconds now_{}, free_since_{}, until_{}, patience_{400'000'000};
  int times_ = 0;
};

}  // namespace packing
