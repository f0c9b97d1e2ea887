// SPDX-License-Identifier: BSD-3-Clause
// The mark of a scene, by which it knows its memories.
#pragma once

#include <bit>
#include <cstdint>

#include "skinctl/core/time.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Calls `f(name, value, unit)` for each number of a robot that a memory depends on: a scene whose robot
/// differs in one of them cannot go on with it. Gains, payload and tool are none of these.
template <class Robot, class F>
SKINCTL_COLD void each_fact_of_memory(const Robot& robot, F&& f) {
  const auto tell = [&](const char* name, const auto& value, const char* unit) {
    f(name, static_cast<double>(value), unit);
  };
  tell("period", milliseconds(robot.period()), "ms");
  tell("longest interval", milliseconds(robot.longest_interval()), "ms");
  Robot::each([&](auto k) {
    tell("delay", milliseconds(robot.template parameters<k.value>().delay), "ms");
    tell("lag", robot.template parameters<k.value>().lag, "s");
  });
  tell("delay", milliseconds(robot.driven_delay()), "ms");
  tell("lag", milliseconds(robot.driven_lag()), "ms");
  for (const auto& c : robot.shape().coulomb) tell("Coulomb friction", c, "N m");
  const auto& limits = robot.limits();
  for (std::size_t i = 0; i < Robot::joints; ++i) {
    tell("lower position limit", limits.lower()[i], "rad");
    tell("upper position limit", limits.upper()[i], "rad");
    tell("velocity limit", limits.velocity()[i], "rad/s");
    tell("acceleration limit", limits.acceleration()[i], "rad/s^2");
    tell("torque limit", limits.torque()[i], "N m");
  }
}

/// The mark of a scene: a digest of the numbers that a memory depends on, of gravity in the base, and of the
/// ids and places of cells. Never 0, that of a memory which no scene has started.
template <class Robot, class Skin>
[[nodiscard]] SKINCTL_COLD std::uint64_t scene_mark(const Robot& robot, const Skin& skin) {
  std::uint64_t mark = 0xcbf29ce484222325;  // FNV-1a, a number at a time
  const auto add = [&mark](double x) {
    mark = (mark ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x100000001b3;  // one zero
    mark ^= mark >> 32;  // a double's exponent is in its upper bits, which a product hands on to none below
  };
  each_fact_of_memory(robot, [&](const char*, double value, const char*) { add(value); });
  using T = typename Robot::scalar;
  const auto g = robot.model().template gravity<T>();
  for (const double x :
       {static_cast<double>(T(g.x)), static_cast<double>(T(g.y)), static_cast<double>(T(g.z))})
    add(x);
  const std::size_t cells = TouchTable<Skin>::size(skin);
  std::size_t found = 0;
  for (std::uint32_t id = 0; found < cells && id < (1u << 20); ++id) {  // a skin has no greater ones
    const std::size_t i = TouchTable<Skin>::index(skin, id);
    if (i >= cells) continue;
    ++found;
    add(static_cast<double>(id) + static_cast<double>(i) * 0x1p20);
  }
  TouchTable<Skin>::each_cell(
      skin,
      [&](std::size_t link, const auto& force, const auto& moment, double) {
        add(static_cast<double>(link));
        for (const auto* v : {&force, &moment})
          for (const double x : {double(v->x), double(v->y), double(v->z)}) add(x);
      },
      Robot::joints);
  return mark | 1u;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
