// The Allegro hand as its benchmarks run it: four fingers side by side in lanes.
#pragma once

#include <array>
#include <utility>

#include "skinctl/robots/allegro.hpp"

namespace skinctl::bench {

/// Four fingers in as many registers as the target needs: one of four doubles with AVX, two of two without.
template <class T>
class Fingers {
 public:
  static constexpr std::size_t lanes = native_lanes<T> >= 4 ? 4 : native_lanes<T>;
  static constexpr std::size_t groups = 4 / lanes;
  using Model = decltype(allegro::right_fingers<lanes, T>(0));

  /// `f(model, first)` for the fingers from `first` on, an array of the results, each made in its place.
  template <class F>
  SKINCTL_INLINE auto each(F f) const {
    return [&]<std::size_t... G>(std::index_sequence<G...>) SKINCTL_INLINE_LAMBDA {
      return std::array<decltype(f(models_[0], 0)), groups>{f(models_[G], G * lanes)...};
    }(std::make_index_sequence<groups>{});
  }
  /// The same for results that are numbers of the joints, written back to the joints of the hand.
  template <class F>
  SKINCTL_INLINE auto joints(F f) const {
    auto results = each(f);
    JointVector<typename decltype(results)::value_type::kind, 16, T> out;
    for (std::size_t g = 0; g < groups; ++g) allegro::from_lanes(results[g], out, g * lanes);
    return out;
  }
  /// Numbers of the joints for the fingers from `first` on.
  template <class V>
  static SKINCTL_INLINE auto of(const V& v, std::size_t first) {
    return allegro::to_lanes<lanes>(v, first);
  }

 private:
  std::array<Model, groups> models_ = []<std::size_t... G>(std::index_sequence<G...>) {
    return std::array<Model, groups>{allegro::right_fingers<lanes, T>(G * lanes)...};
  }(std::make_index_sequence<groups>{});
};

}  // namespace skinctl::bench
