// SPDX-License-Identifier: BSD-3-Clause
// What is near a robot now and may move: other robots, people, things that its skin sees.
#pragma once

#include <array>
#include <cstdint>

#include "skinctl/clearance/capsule.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/frames/transform.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A capsule along the axes of the frame `F`, from its origin, that something fills or may fill.
template <Frame F, Real T = double>
struct Obstacle {
  Capsule<T> shape;
  /// Largest speed at which the nearest of its points may come closer to anything [m/s], >= 0. 0: it stays
  /// within `shape`.
  T approach = T(0);

  /// This obstacle along the axes of `A`.
  template <Frame A>
  [[nodiscard]] friend Obstacle<A, T> operator*(const Transform<A, F, T>& X_AF, const Obstacle& o) noexcept {
    return {{X_AF.origin() + X_AF.axes() * o.shape.from, X_AF.origin() + X_AF.axes() * o.shape.to,
             o.shape.radius},
            o.approach};
  }
  // clang-format off
  template <Frame A, Frame B>
    requires(!std::is_same_v<B, F>)
  friend void operator*(const Transform<A, B, T>&, const Obstacle&) = delete;  // the obstacle is in another frame: X_AB * obstacle of B
  // clang-format on
};

/// Largest number of a robot's capsules that stay clear of obstacles, and that it tells others.
inline constexpr std::size_t max_exposed_capsules = 12;

/// At most `Most` obstacles at an instant: those that a robot sees (`Input::around` of a scene with a
/// `ClearanceAround`, in `Base`), or the space that it tells others it may fill (`occupied`), moved to the
/// `World` that they share.
template <std::size_t Most, Frame F = Base, Real T = double>
struct Surroundings {
  static constexpr std::size_t capacity = Most;
  Nanoseconds time{};       ///< instant for which the obstacles hold
  std::uint32_t count = 0;  ///< number of obstacles; above `Most` some are unknown: nothing may come nearer
  std::array<Obstacle<F, T>, Most> obstacles{};

  /// Adds an obstacle; without room it is only counted.
  void add(const Obstacle<F, T>& o) noexcept {
    if (count < Most) obstacles[count] = o;
    ++count;
  }
  /// Adds all of `others`, which are in the frame `G`.
  template <std::size_t Others, Frame G>
  void add(const Transform<F, G, T>& X_FG, const Surroundings<Others, G, T>& others) noexcept {
    for (std::size_t i = 0; i < others.count && i < Others; ++i) add(X_FG * others.obstacles[i]);
    if (others.count > Others) count += static_cast<std::uint32_t>(Most) + 1;
  }
};

/// Stand-in for `Surroundings`, for a robot without limits that read them.
struct NoSurroundings {
  static constexpr std::size_t capacity = 0;
};

/// The addition of a `ClearanceAround` to the input of a cycle.
template <class Near>
struct AroundRobot {
  Near around{};  ///< obstacles near the robot
};

SKINCTL_END_NAMESPACE
