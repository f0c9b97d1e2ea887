// A UR5 by position on its real cycle, led by the hand of a simulated person who teaches goals.
#pragma once

#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robots/universal_robots.hpp"
#include "skinctl/semantics/demonstration.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/touched_arm.hpp"

namespace skinctl::testing {

/// What the person meant, and where the arm came to rest.
struct MeantGoal {
  Xyz<double> meant{0, 0, 0};
  Transform<World, Tool> rested{};
  Transform<World, Tool> switched{};  ///< pose when the switch was pressed
};
struct LedDemonstration {
  std::vector<LedSample<>> samples;
  std::vector<MeantGoal> goals;
};

namespace led {
inline constexpr auto led_period = 8ms;
inline constexpr double led_reach = 0.05;
inline std::vector<PlacedCell<5>> led_cells() {
  std::vector<PlacedCell<5>> out;
  std::uint32_t id = 1;
  for (const Xyz<double>& n : {Xyz<double>{1, 0, 0}, Xyz<double>{-1, 0, 0}, Xyz<double>{0, 1, 0},
                               Xyz<double>{0, -1, 0}, Xyz<double>{0, 0, 1}, Xyz<double>{0, 0, -1}})
    out.push_back(cell_at<5>(id++, {led_reach * n.x, led_reach * n.y, led_reach * n.z + 0.1}, n));
  return out;
}
inline auto led_scene() {
  const auto arm =
      by_position(ur5::Model{}, RobotConfiguration<6>{.limits = limits_of<ur5::Description>(15.0),
                                                      .period = led_period,
                                                      .delay = 8ms,
                                                      .lag = 12ms,
                                                      .virtual_damping = 8});
  return Cycle(arm, open_skin(Patch<5, 6>(led_cells(), open_gains)), SkinJointControl{} + GravityControl{});
}
}  // namespace led

/// The arm: skin around its tool, kinesthetic teaching (gives way to touch, holds gravity), 125 Hz, servos
/// with 8 ms of delay and 12 ms of lag. Its base is the world.
class LedArm {
 public:
  static constexpr auto period = led::led_period;

  explicit LedArm(std::uint64_t seed)
      : random_(seeded(seed)),
        scene_(led::led_scene()),
        arm_(scene_, led::led_cells(), pose(), 0.008, 0.012) {}

  /// Three goals, one after the other: led there with a stop on the way, held until the person is content,
  /// left alone, switched (a push of 4 to 10 N that moves the arm), led on.
  [[nodiscard]] LedDemonstration teach() {
    LedDemonstration out;
    const auto start = tool().origin();
    bool closed = false;
    Xyz<double> at = start;
    for (int k = 0; k < 3; ++k) {
      Xyz<double> goal;
      do {
        goal = start + Xyz<double>{in(-0.12, 0.12), in(-0.2, 0.2), in(-0.12, 0.1)};
      } while (norm(Xyz<double>(goal - at)) < 0.1);
      const Xyz<double> by_the_way = at + in(0.3, 0.7) * Xyz<double>(goal - at);
      const bool hesitates = in(0, 1) < 0.5;
      if (hesitates) {
        lead(out, by_the_way, in(0.8, 1.6), closed);
        lead(out, by_the_way, in(0.3, 0.8), closed);  // stands, held
      }
      lead(out, goal, in(1.0, 2.5), closed);
      for (int i = 0; i < 200 && norm(Xyz<double>(tool().origin() - goal)) > 0.004; ++i)
        lead(out, goal, 0.008, closed);
      lead(out, goal, in(0.1, 0.4), closed);
      // The hand lets go over 50 to 150 ms, and leaves the arm alone.
      const double going = in(0.05, 0.15), had = in(0.3, 1.0);
      const Xyz<double> last = force_;
      const double gripped = grip_;
      for (double t = 0; t < going; t += 0.008) {
        grip_ = gripped * (1 - t / going);
        step(out, (had * (1 - t / going)) * last, closed);
      }
      grip_ = 0;
      for (const double end = in(0.45, 1.2); wait_ < end; wait_ += 0.008) step(out, {0, 0, 0}, closed);
      wait_ = 0;
      MeantGoal meant{goal, tool(), {}};
      const double push = in(4, 10), lasts = in(0.12, 0.25), u = in(-1, 1), v = in(-1, 1);
      const Xyz<double> way = (1 / std::sqrt(1 + u * u + v * v)) * Xyz<double>{u, v, -1.0};
      for (double t = 0; t < lasts; t += 0.008) {
        if (t >= 0.5 * lasts && t < 0.5 * lasts + 0.008) {
          meant.switched = tool();
          closed = !closed;
        }
        step(out, (push * std::sin(3.14159 * t / lasts)) * way, closed);
      }
      for (const double end = in(0.1, 0.6); wait_ < end; wait_ += 0.008) step(out, {0, 0, 0}, closed);
      wait_ = 0;
      out.goals.push_back(meant);
      at = tool().origin();
    }
    return out;
  }

 private:
  double in(double low, double high) { return uniform(random_, low, high); }
  static std::array<double, 6> pose() { return {0.2, -1.5, 1.7, -1.8, -1.57, 0.3}; }
  using Scene = decltype(led::led_scene());

  [[nodiscard]] Transform<World, Tool> tool() const {
    const ur5::Model model;
    const JointPosition<6> q(arm_.q());
    return (Poses<ur5::Model, all_links(6), double>(model, JointAngles<ur5::Model, double>(model, q))
                .get<5>() *
            Transform<Link<5>, Tool>::translation_xyz(0, 0, 0.1))
        .renamed<World, Tool>();
  }
  /// The person's arm: a spring with a damper to a target that moves to `goal`, at most 40 N.
  void lead(LedDemonstration& out, const Xyz<double>& goal, double time, bool closed) {
    const Xyz<double> from = tool().origin();
    for (double t = 0; t < time; t += 0.008) {
      const double u = std::min(1.0, (t + 0.008) / time), s = u * u * u * (10 + u * (6 * u - 15));
      const Xyz<double> p = tool().origin(), target = from + s * Xyz<double>(goal - from);
      const Xyz<double> v = (1 / 0.008) * Xyz<double>(p - last_);
      v_ = v_ + 0.6 * Xyz<double>(v - v_);
      Xyz<double> F = 150.0 * Xyz<double>(target - p) - 25.0 * v_;
      const double size = norm(F);
      if (size > 40) F = (40 / size) * F;
      grip_ = std::min(grip_ + 0.3, hold_);
      step(out, force_ + 0.6 * Xyz<double>(F - force_), closed);
    }
  }
  /// One cycle with a force of the hand on the tool, along the world's axes.
  void step(LedDemonstration& out, const Xyz<double>& F, bool closed) {
    const auto X = tool();
    last_ = X.origin();
    force_ = F;
    const Xyz<double> f = turn_back(X.axes(), F);
    std::array<double, 6> push{};
    const double parts[3] = {f.x, f.y, f.z};
    for (std::size_t i = 0; i < 3; ++i) push[parts[i] > 0 ? 2 * i + 1 : 2 * i] = std::abs(parts[i]);
    push[0] += grip_, push[1] += grip_;
    double touch = 0.05 * uniform(random_, -1.0, 1.0);
    for (const double x : push) touch += x;
    arm_.step(period, [&](std::size_t k, const auto&) { return CellTouch{push[k], 0}; });
    auto measured = tool();
    const auto off = [&] { return 0.00005 * uniform(random_, -1.0, 1.0); };
    measured = measured.translated(off(), off(), off());
    out.samples.push_back(
        {nanoseconds(arm_.time()), measured, touch, closed ? 4.0 : 0.0, closed, Activity::unknown});
  }

  Random random_;
  Scene scene_;
  TouchedArm<5, Scene> arm_;
  Xyz<double> force_{0, 0, 0}, v_{0, 0, 0}, last_ = tool().origin();
  double wait_ = 0, grip_ = 0;
  double hold_ = uniform(random_, 1.5, 5.0);  ///< both sides of the tool are held with this [N]
};

}  // namespace skinctl::testing
