// UR5 with 260 cells: what is measured beside what is offered.
#include "bench/studies/trade/abridged.hpp"
#include "bench/studies/trade/scenes.hpp"

namespace trade {
namespace {

using Arm = ur5::Model;

template <class Law, class M = Arm, class... Parts>
auto with(const Parts&... parts) {
  return [=](const Choices& c) { return pressed_ur5<double, M, Law>(c, parts...); };
}

}  // namespace

std::vector<Point> study_points() {
  std::vector<Point> points;
  const auto add = [&](const char* policy, const char* value, const Choices& choices, const auto& make) {
    points.push_back(
        {.scene = "UR5, 260 cells", .policy = policy, .value = value, .choices = choices, .make = make});
  };
  using Skin = SkinJointControl;
  const Choices usual{.event = 0};
  add("integrator", "semi-implicit Euler, 2 ms", usual, with<Skin>(SemiImplicitEuler{}));
  add("model", "mass matrix once a cycle", usual, with<Skin, Abridged<Arm, Abridgement::mass_once, 4>>());
  add("model", "mass matrix every 20 sub-steps", usual,
      with<Skin, Abridged<Arm, Abridgement::mass_once, 20>>());
  add("model", "without Coriolis", usual, with<Skin, Abridged<Arm, Abridgement::no_coriolis>>());
  add("model", "diagonal inertia", usual, with<Skin, Abridged<Arm, Abridgement::diagonal>>());
  add("model", "Jacobian of the skin once a cycle", usual, with<SkinOnceACycle>());
  add("readings", "16 bits", {.event = 0, .bits = 16}, with<Skin>());
  add("readings", "10 bits", {.event = 0, .bits = 10}, with<Skin>());
  add("readings", "8 bits", {.event = 0, .bits = 8}, with<Skin>());
  add("unit wrenches", "float: 6e-8", {.event = 0, .gain = 1 + 6e-8}, with<Skin>());
  add("unit wrenches", "16 bits: 1.5e-5", {.event = 0, .gain = 1 + 1.53e-5}, with<Skin>());
  return points;
}

}  // namespace trade
