// A point of the trade study: one scene with one set of choices, what it costs and how far it is off.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "skinctl/core/time.hpp"
#include "skinctl/core/triple.hpp"

namespace trade {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// What happened in a world, cycle by cycle.
struct Course {
  std::vector<skinctl::Xyz<double>> tool;  ///< of the real robot, in the base's axes [m]
  std::vector<double> force;               ///< by which it is pressed [N]
  double energy = 0;                       ///< that the world gave to the robot [J]
  double peak = 0;                         ///< largest force [N]
  std::size_t samples = 0;                 ///< that the skin sent
};

/// How far one course is off another.
struct Distance {
  double mm = unknown;  ///< the tool, at worst
  double N = unknown;   ///< the contact force, at worst
  double J = unknown;   ///< the energy
};
[[nodiscard]] inline Distance distance(const Course& a, const Course& b) {
  Distance d{0, 0, std::abs(a.energy - b.energy)};
  for (std::size_t k = 0; k < a.tool.size(); ++k) {
    const auto way = a.tool[k] - b.tool[k];
    const double mm = 1e3 * std::sqrt(dot(way, way)), N = std::abs(a.force[k] - b.force[k]);
    d.mm = mm > d.mm || !(mm == mm) ? mm : d.mm;
    d.N = N > d.N || !(N == N) ? N : d.N;
  }
  return d;
}

/// The choices that are numbers; those that are types are the point's own.
struct Choices {
  skinctl::Nanoseconds substep = std::chrono::milliseconds(2);
  double event = 0.1;  ///< [N]
  skinctl::Nanoseconds patience = skinctl::Nanoseconds::max();
  double bits = 0;  ///< readings are rounded to so many bits before they are sent; 0: as they are
  double gain = 1;  ///< of all readings: a relative error of the skin's wrenches
};

/// A scene and its choices, ready to run.
struct Runner {
  virtual ~Runner() = default;
  /// In the world with forces that are given, and in the one with a stiff finger.
  virtual Course given() = 0;
  virtual Course stiff() = 0;
  /// The first world's cycles again, from its record.
  virtual void cycles(std::size_t count) = 0;
  virtual double hot() = 0;                             ///< median time of a cycle right after another [us]
  virtual double cold() = 0;                            ///< with code and data flushed from the caches [us]
  [[nodiscard]] virtual std::size_t bytes() const = 0;  ///< of configuration and memory
  [[nodiscard]] virtual std::size_t count() const = 0;  ///< cycles of the record
};

struct Point {
  std::string scene, policy, value;
  Choices choices;
  std::function<std::unique_ptr<Runner>(const Choices&)> make;
  std::string preset = {};
};

/// What was found; a row of the CSV.
struct Row {
  std::string scene, policy, value, preset;
  double hot = unknown, cold = unknown, instructions = unknown, code = unknown, bytes = unknown,
         samples = unknown;
  double mm = unknown, mm_stiff = unknown, N = unknown, J = unknown;
  std::string verdict = {}, evidence = "measured", command = {};
};

[[nodiscard]] std::vector<Point> arm_points();    ///< UR5, bare and with 260 cells
[[nodiscard]] std::vector<Point> study_points();  ///< UR5 with 260 cells: what is measured and not offered
[[nodiscard]] std::vector<Point> hand_points();   ///< UR5 with Allegro and 1260 cells, Allegro alone

}  // namespace trade
