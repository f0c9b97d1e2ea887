// SPDX-License-Identifier: BSD-3-Clause
// A skin whose patches count as much as the scene says in each cycle: forces and proximities apart.
#pragma once

#include <array>

#include "skinctl/core/contract.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Weights of the patches on `Count` links, in the order of the links: 1: a patch counts as it is, 0: it does
/// not.
template <std::size_t Count>
struct PatchWeights {
  std::array<float, Count> force = uniform(1), proximity = uniform(1);

  [[nodiscard]] static constexpr std::array<float, Count> uniform(float w) noexcept {
    std::array<float, Count> all{};
    for (float& x : all) x = w;
    return all;
  }
  template <class F>
  friend void each_number(PatchWeights& w, F&& f) {
    for (float& x : w.force) f(x);
    for (float& x : w.proximity) f(x);
  }
};

/// The addition of a `WeightedSkin` to the input of a cycle.
template <std::size_t Count>
struct WeightInput {
  PatchWeights<Count> patch_weights;
};

/// The skin `S`, for a `Cycle` in place of `S`, with a weight of force and one of proximity for each link
/// with skin:
///
///     input.sensed.patch_weights.proximity[skin.slot(5)] = 0;   // the hand nears what it shall grasp
///
/// Weights are inputs: they belong to a skill or an instant, and are recorded and replayed. They lie in [0,
/// 1]; others are cut off, and one that is not finite leaves the last (`sample_not_finite`). A weight moves
/// to its new value in `ramp` at the earliest, so a change is no step.
///
/// Laws, and an energy tank, see the weighted touch. What is pressed stays pressed: contacts, limits of
/// contact and skills that wait for a contact read the cells themselves.
template <class S>
class WeightedSkin : public WrappedTouch<WeightedSkin<S>, S, WeightInput<S::Wrenches::count>> {
  using Base = WrappedTouch<WeightedSkin, S, WeightInput<S::Wrenches::count>>;

 public:
  using scalar = typename Base::scalar;
  using Wrenches = typename S::Wrenches;
  using Touch = TouchWrenches<Wrenches>;
  static constexpr std::size_t count = Wrenches::count;
  struct Memory : S::Memory {
    PatchWeights<count> weights;
  };

  /// Throws `ConfigurationError` unless `ramp` is in [1 ms, 100 s].
  SKINCTL_COLD explicit WeightedSkin(const S& skin, Nanoseconds ramp = 100ms)
      : Base(skin), rate_(1 / seconds<double>(ramp)) {
    require(ramp >= 1ms && ramp <= 100s, "WeightedSkin: ramp", milliseconds(ramp), "1 to 1e5 ms");
  }
  /// The index of link `i` in `PatchWeights::force` and `proximity`.
  [[nodiscard]] static constexpr std::size_t slot(std::size_t i) noexcept { return Wrenches::slot(i); }

  /// See `S::receive`. In each part of the interval a weight has the value of the part's middle.
  template <class Given, class Means, class... Front>
  Status take(Memory& memory, const Given& in, Means* means, Front&&... front) const noexcept {
    Touch apart[max_parts];
    SKINCTL_EXPECTS(in.parts <= max_parts, "an interval has at most 16 parts");
    TouchGiven given = in;
    if (given.parts > max_parts) given.parts = max_parts;
    const std::size_t parts = given.parts;
    const auto& sensed = in.sensed;
    Status status = this->take_on(memory, given, apart, std::forward<Front>(front)...);
    const PatchWeights<count> before = memory.weights;
    const auto most = static_cast<float>(in.to > in.from ? rate_ * seconds<double>(in.to - in.from) : 0.0);
    for (std::size_t k = 0; k < count; ++k) {
      status |= move(memory.weights.force[k], sensed.patch_weights.force[k], most);
      status |= move(memory.weights.proximity[k], sensed.patch_weights.proximity[k], most);
    }
    for (std::size_t j = 0; j < parts; ++j) {
      const float u = (static_cast<float>(j) + 0.5f) / static_cast<float>(parts);
      PatchWeights<count> now;
      for (std::size_t k = 0; k < count; ++k) {
        now.force[k] = before.force[k] + u * (memory.weights.force[k] - before.force[k]);
        now.proximity[k] = before.proximity[k] + u * (memory.weights.proximity[k] - before.proximity[k]);
      }
      const Touch touch = weighed(apart[j], now);
      if constexpr (std::is_same_v<Means, Touch>) {
        means[j] = touch;
      } else {
        means[j] = touch.total();
      }
    }
    return status;
  }
  [[nodiscard]] Wrenches wrenches(const Memory& memory) const noexcept { return touch(memory).total(); }
  [[nodiscard]] Touch touch(const Memory& memory) const noexcept {
    return weighed(S::touch(memory), memory.weights);
  }

 private:
  static constexpr std::size_t max_parts = 16;  ///< maximum number of parts of an interval

  static Status move(float& weight, float asked, float most) noexcept {
    if (!(asked - asked == 0)) return Reason::sample_not_finite;
    const float goal = asked < 0 ? 0 : asked > 1 ? 1 : asked, off = goal - weight;
    weight = off > most ? weight + most : off < -most ? weight - most : goal;
    return {};
  }
  [[nodiscard]] static Touch weighed(Touch t, const PatchWeights<count>& w) noexcept {
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t r = 0; r < 6; ++r) {
        t.force.data[k][r] = static_cast<scalar>(w.force[k]) * t.force.data[k][r];
        t.proximity.data[k][r] = static_cast<scalar>(w.proximity[k]) * t.proximity.data[k][r];
      }
    return t;
  }
  double rate_;  ///< rate of change of a weight [1/s]
};

SKINCTL_END_NAMESPACE
