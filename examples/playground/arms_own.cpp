// The arms of a robot that a visitor brings: its skin, by position and velocity.
#include "examples/playground/chosen_arms.hpp"
#include "examples/playground/own_robot.hpp"

namespace playground {
namespace {

/// See `UrJob`.
template <skinctl::Interface I>
struct OwnJob {
  static constexpr skinctl::Interface interface = I;
  static constexpr job::Sense sense = job::Sense::skin;
  std::shared_ptr<const OwnRobot> robot;

  [[nodiscard]] auto configuration(const job::Settings& s, double heavier = 1) const {
    auto c = job::configuration<I>(s, heavier);
    c.limits = robot->limits(s.control);
    return c;
  }
  [[nodiscard]] OwnRobot::Skin skin(const job::Settings& s, double heavier = 1) const {
    return OwnRobot::Skin(robot->patches(s, heavier), job::skin_settings(s));
  }
  [[nodiscard]] auto arm(const job::Settings& s, double heavier) const {
    return skinctl::robot_by<I>(robot->model(), configuration(s, heavier), job::hardest_finger(s),
                                job::heaviest_hand(s));
  }
  [[nodiscard]] double heavier(const job::Settings& s) const {
    return job::heavier_for(s, skinctl::robot_by<I>(robot->model(), configuration(s)), skin(s));
  }
  [[nodiscard]] double felt_mass(const job::Settings& s) const {
    const double factor = heavier(s);
    return job::hardest_finger(s).min_felt_mass(arm(s, factor), skin(s, factor));
  }
  [[nodiscard]] auto scene(const job::Settings& s) const {
    using namespace skinctl;
    const double factor = heavier(s);
    const OwnRobot::Skin cells = skin(s, factor);
    const TrustedSkin touch(cells, job::trust_settings(s), FillIn(CellGraph(cells.places()), cells.places()));
    return job::scene_of(s, arm(s, factor), touch, factor)
        .with(SkinWatch{}, job::felt_places(s, configuration(s), cells.places()));
  }
  [[nodiscard]] auto cells(const job::Settings& s) const { return job::simulated_cells(robot->patches(s)); }
  [[nodiscard]] Kinematics kinematics() const {
    return [robot = robot](const Joints& q) { return robot->links(q); };
  }
  void limit(simulated_ur5::ArmConfig& arm) const { robot->limit(arm); }
  [[nodiscard]] OwnRobot::Tube tube(std::size_t i) const { return robot->tube(i); }
};

}  // namespace

std::unique_ptr<Arms> arms_of_own_robot(job::Settings s, const Choice& c, const Robot& numbers,
                                        const job::PerJoint* q) {
  using skinctl::Interface;
  const auto robot = std::make_shared<const OwnRobot>(numbers);
  s.task.clear();
  for (const Joints& place : robot->task()) s.task.push_back({.at = 0, .q = place, .duration = 0});
  const job::PerJoint begin = q != nullptr ? *q : s.task.back().q;
  return c.interface == 0 ? arms_by(OwnJob<Interface::position>{robot}, s, c, begin)
                          : arms_by(OwnJob<Interface::velocity>{robot}, s, c, begin);
}

}  // namespace playground
