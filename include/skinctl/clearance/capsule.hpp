// SPDX-License-Identifier: BSD-3-Clause
// Capsules around links and known objects, and their distances.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/triple.hpp"

SKINCTL_BEGIN_NAMESPACE

/// All points within `radius` of the segment from `from` to `to` [m].
template <Real T = double>
struct Capsule {
  Xyz<T> from{T(0), T(0), T(0)}, to{T(0), T(0), T(0)};
  T radius = T(0);
};

/// A capsule fixed to a link, along its axes from its origin; with `link` = `fixed`, one that stands still,
/// along the base's axes: a table, a fixture.
struct LinkCapsule {
  static constexpr std::size_t fixed = ~std::size_t(0);
  std::size_t link = fixed;
  Capsule<> shape;

  SKINCTL_COLD void check(std::size_t links) const {
    const double sum = shape.from.x + shape.from.y + shape.from.z + shape.to.x + shape.to.y + shape.to.z;
    require(link == fixed || link < links, "LinkCapsule: link", double(link), "one of the model");
    require(sum - sum == 0, "LinkCapsule: place", sum, "finite m");
    require(shape.radius >= 0 && shape.radius <= 100, "LinkCapsule: radius", shape.radius, "0 to 100 m");
  }
};

/// The distance of two capsules' surfaces, negative where they overlap, and the points of their segments that
/// are nearest to each other.
template <Real T>
struct CapsuleDistance {
  T distance;
  Xyz<T> a, b;
};
/// The distance of two capsules, and the nearest points of their segments, also for segments that are points
/// or parallel, to within 8 units in the last place of the largest coordinate, for lengths whose fourth power
/// is a number. NaN in gives a distance that is not `> x` for any x.
template <Real T>
[[nodiscard]] SKINCTL_INLINE CapsuleDistance<T> distance(const Capsule<T>& a, const Capsule<T>& b) noexcept {
  using std::sqrt;
  const auto clamped = [](const T& x) SKINCTL_INLINE_LAMBDA { return x < T(0) ? T(0) : x > T(1) ? T(1) : x; };
  const Xyz<T> u = a.to - a.from, v = b.to - b.from, w = a.from - b.from;
  const T uu = dot(u, u), vv = dot(v, v);
  // As cross products: where the segments are nearly parallel, differences of squares keep no digit.
  const Xyz<T> n = cross(u, v);
  const T eps = std::numeric_limits<T>::epsilon();
  const T wide = dot(n, n), least = T(16) * eps * eps * uu * vv;
  T s = wide > least ? clamped(T(dot(n, cross(v, w)) / wide)) : T(0);
  const Xyz<T> from_b = w + s * u;
  T t = vv > T(0) ? T(dot(from_b, v) / vv) : T(0);
  if (!(t >= T(0) && t <= T(1)) || !(vv > T(0))) {
    t = clamped(t);
    s = uu > T(0) ? clamped(T(dot(t * v - w, u) / uu)) : T(0);
  }
  const Xyz<T> p = a.from + s * u, q = b.from + t * v, way = p - q;
  return {sqrt(dot(way, way)) - a.radius - b.radius, p, q};
}
/// The distance of a point from a capsule's surface [m], < 0 inside.
template <Real T>
[[nodiscard]] SKINCTL_INLINE T distance(const Xyz<T>& point, const Capsule<T>& c) noexcept {
  using std::sqrt;
  const Xyz<T> u = c.to - c.from, w = point - c.from;
  const T uu = dot(u, u), along = dot(u, w);
  const T t = !(uu > T(0)) || !(along > T(0)) ? T(0) : along < uu ? T(along / uu) : T(1);
  const Xyz<T> way = w - t * u;
  return sqrt(dot(way, way)) - c.radius;
}

SKINCTL_END_NAMESPACE
