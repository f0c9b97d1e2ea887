// What the floors share: inlining, and sines of angles that are already in registers.
#pragma once

#include <cstddef>

#include "skinctl/math/sincos.hpp"

#define BENCH_FLOOR_INLINE [[gnu::always_inline]] inline

namespace bench_floor {

/// Sines and cosines of W angles, without passing them through an array in memory (a vector load that follows
/// scalar stores waits for them: 15 ns).
template <std::size_t W, class... Q>
BENCH_FLOOR_INLINE void sincos_of(double* s, double* c, Q... q) {
  using L = skinctl::Lane<double, W>;
  const auto y = skinctl::math::sincos(L(typename L::Vector{q...}));
  y.sin.store(s);
  y.cos.store(c);
}

/// Four of them, in as many registers as the target needs.
BENCH_FLOOR_INLINE void sincos4(double* s, double* c, double q0, double q1, double q2, double q3) {
  if constexpr (skinctl::native_lanes<double> >= 4) {
    sincos_of<4>(s, c, q0, q1, q2, q3);
  } else {
    sincos_of<2>(s, c, q0, q1);
    sincos_of<2>(s + 2, c + 2, q2, q3);
  }
}

/// Six of them, without stores that overlap.
BENCH_FLOOR_INLINE void sincos6(double* s, double* c, double q0, double q1, double q2, double q3, double q4,
                                double q5) {
  sincos4(s, c, q0, q1, q2, q3);
  sincos_of<2>(s + 4, c + 4, q4, q5);
}

}  // namespace bench_floor
