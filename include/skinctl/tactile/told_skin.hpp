// SPDX-License-Identifier: BSD-3-Clause
// A skin that keeps what its cells tell: accelerations, temperatures.
#pragma once

#include "skinctl/tactile/kind_input.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The skin `S` with the newest amounts of the channels that are told, for a `Cycle` in place of `S`:
/// `ToldSkin(skin)`. They exert no force. Cells of the innermost skin only; samples that it refuses tell
/// nothing.
template <class S>
class ToldSkin : public WrappedTouch<ToldSkin<S>, S> {
  using Base = WrappedTouch<ToldSkin, S>;
  using Kind = typename S::kind;

 public:
  static constexpr std::size_t first_told =
      KindTable<Kind>::pushing;  ///< number of the first channel that is told
  static constexpr std::size_t channels = KindTable<Kind>::channels - first_told;
  static_assert(channels > 0, "this kind of sensor tells nothing");
  struct Memory : S::Memory {
    std::array<std::array<float, channels>, S::cells> told{};
    std::array<Nanoseconds, S::cells> told_at{};
  };

  SKINCTL_COLD explicit ToldSkin(const S& skin) : Base(skin) {}

  /// See `S::receive`; keeps the newest amounts of the channels that are told.
  template <class Given, class Means, class... Front>
  Status take(Memory& memory, const Given& in, Means* means, Front&&... front) const noexcept {
    const Status status = this->take_on(memory, in, means, std::forward<Front>(front)...);
    const S& skin = *this;
    for (const auto& sample : samples(in)) {
      const std::size_t i = skin.index(sample.cell);
      if (i >= skin.size() || check(sample).any() || sample.time > in.to || sample.time < memory.told_at[i])
        continue;
      memory.told_at[i] = sample.time;
      for (std::size_t k = 0; k < channels; ++k) memory.told[i][k] = amount<Kind>(sample, first_told + k);
    }
    return status;
  }
  /// The newest amount of channel `channel` of cell `i`; 0 before its first sample. Throws nothing: ask for a
  /// channel that is told, of a cell of this skin.
  [[nodiscard]] float told(const Memory& memory, std::size_t i, std::size_t channel) const noexcept {
    SKINCTL_EXPECTS(channel >= first_told && channel < first_told + channels, "a channel that is told");
    return memory.told[i][channel - first_told];
  }
  /// The stamp of the newest sample of cell `i`; 0 before the first one.
  [[nodiscard]] Nanoseconds told_at(const Memory& memory, std::size_t i) const noexcept {
    return memory.told_at[i];
  }

 private:
  template <class Given>
  [[nodiscard]] static auto samples(const Given& in) noexcept {
    if constexpr (std::is_same_v<Kind, Hexagon>) {
      return in.samples;
    } else {
      return static_cast<const KindInput<Kind>&>(in.sensed).taxels;
    }
  }
};

SKINCTL_END_NAMESPACE
