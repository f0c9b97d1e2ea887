// Puts the positions of four fingers together that belong to the same instant.
#pragma once

#include "examples/adapters/allegro/frames.hpp"
#include "skinctl/core/time.hpp"

namespace adapters::allegro {

/// The hand sends the positions of its fingers in four frames, one behind the other, every period. A set is
/// complete when all four have come.
///
/// - The same frame with the same numbers again: a duplicate, or a hand at rest; nothing changes.
/// - The same finger with other numbers, or a frame later than half a period after the set's first: a frame
///   was lost. The set begins anew.
/// - Whatever the order of frames and losses, a complete set mixes instants at most half a period apart.
class PositionSet {
 public:
  enum class Added : std::uint8_t { part, complete, duplicate };

  explicit PositionSet(skinctl::Nanoseconds period) noexcept : window_(period / 2) {}

  /// @param at  when the frame came.
  Added add(const Positions& p, skinctl::Nanoseconds at) noexcept {
    const std::size_t f = p.finger & 3u;
    const unsigned bit = 1u << f;
    if (have_ != 0 && have_ != 15) {
      const bool late = at - stamp_ > window_;
      if (!late && (have_ & bit) != 0 && p.count == part(f)) {
        ++duplicates_;
        return Added::duplicate;
      }
      if (late || (have_ & bit) != 0) {
        ++incomplete_;
        have_ = 0;
      }
    } else if (have_ == 15) {
      if (at - stamp_ <= window_ && p.count == part(f)) {
        ++duplicates_;
        return Added::duplicate;
      }
      have_ = 0;
    }
    if (have_ == 0) stamp_ = at;
    have_ |= bit;
    for (std::size_t i = 0; i < 4; ++i) count_[4 * f + i] = p.count[i];
    return have_ == 15 ? Added::complete : Added::part;
  }
  /// Drops what has come of a set.
  void drop() noexcept {
    if (have_ != 0 && have_ != 15) ++incomplete_;
    have_ = 0;
  }

  /// The positions, after `complete` [steps].
  [[nodiscard]] const std::array<std::int16_t, 16>& count() const noexcept { return count_; }
  /// When the set's first frame came.
  [[nodiscard]] skinctl::Nanoseconds stamp() const noexcept { return stamp_; }
  [[nodiscard]] std::uint64_t incomplete() const noexcept { return incomplete_; }
  [[nodiscard]] std::uint64_t duplicates() const noexcept { return duplicates_; }

 private:
  [[nodiscard]] std::array<std::int16_t, 4> part(std::size_t f) const noexcept {
    return {count_[4 * f], count_[4 * f + 1], count_[4 * f + 2], count_[4 * f + 3]};
  }
  skinctl::Nanoseconds window_, stamp_{};
  unsigned have_ = 0;
  std::array<std::int16_t, 16> count_{};
  std::uint64_t incomplete_ = 0, duplicates_ = 0;
};

}  // namespace adapters::allegro
