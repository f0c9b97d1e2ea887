// A table on which a tool is used: what lies there, and a judge who measures where it ends and where the
// tool's tip went.
#pragma once

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "examples/packing_oranges/plan.hpp"
#include "examples/packing_oranges/tool.hpp"
#include "examples/packing_oranges/world.hpp"

namespace packing {

/// What a task teaches of a table with a tool; all from the side of an arm, as the first one sees it, in
/// metres.
struct ToolLesson {
  skinctl::Xyz<double> tool_place{0, 0, 0};  ///< where the tool's middle is put back
  skinctl::Xyz<double> thing_place{0, 0,
                                   0};  ///< where the thing's middle is put, from the middle of the plate
  std::vector<skinctl::Xyz<double>>
      tip;  ///< way of the tool's tip in use, from the thing's middle, every 5 mm
};
/// @param stands  from the middle of the table to an arm's base [m].
[[nodiscard]] ToolLesson tool_lesson(const Plan& plan, const skinctl::TaughtWays& ways, double stands);

/// For each point of `taught` that `went` passes within a distance [m], in the order of both, as many as can
/// be: the number of the point of `went`.
[[nodiscard]] std::vector<std::size_t> followed(const std::vector<skinctl::Xyz<double>>& taught,
                                                const std::vector<skinctl::Xyz<double>>& went, double within);

/// What an arm has done on such a table.
struct ToolOutcome {
  double tool_off = 0, thing_off = 0;  ///< in the end, from where it was taught [m]
  double share = 0;  ///< of the taught way of the tip that it went, in its order, within `tip_within`
  double height = 0, taught_height = 0;  ///< least of the tip over the thing's middle, while it was used [m]
  double strayed = 0;  ///< the tip, while it went that way, from the nearest place of it, 95 % quantile [m]
  int moved = 0;       ///< how often a person moved the thing
  [[nodiscard]] int lost() const { return (tool_off > lost_from) + (thing_off > lost_from); }
  static constexpr double lost_from = 0.06;   ///< further from its place a thing is lost [m]
  static constexpr double tip_within = 0.01;  ///< [m]
};

class Kitchen {
 public:
  Kitchen(const ToolLesson& lesson, double move_thing, std::uint64_t seed)
      : lesson_(lesson), move_(move_thing), random_(seed) {}
  /// Lays tools and bread on the table, at other places than in the lesson.
  void lay(World& world);
  /// Every few milliseconds.
  void step(World& world);
  /// A person who is asked lays a tool that lies elsewhere back to where it lay.
  void bring(World& world, std::size_t arm);
  [[nodiscard]] ToolOutcome judge(const World& world, std::size_t arm) const;
  /// Stiffness of what an arm takes [N/m].
  static constexpr double bread_stiffness = 3000, handle_stiffness = 6000;

 private:
  [[nodiscard]] double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  /// A person lays the bread elsewhere, once, while the arm has the tool and no hand is near.
  void move(World& world, std::size_t arm);
  void lay_tool(World& world, std::size_t arm);

  ToolLesson lesson_;
  double move_;
  std::mt19937_64 random_;
  std::array<std::vector<skinctl::Xyz<double>>, arms>
      tip_;  ///< from the thing's middle, while the tool is lifted
  std::array<int, arms> moved_{};
  std::array<skinctl::Xyz<double>, arms> tools_{};  ///< where they lay at first, ...
  std::array<double, arms> yaws_{};                 ///< ... and how they were turned [rad]
};

}  // namespace packing
