// Where a touch without a skin comes from: the reports of the robot.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "examples/adapters/ur5/driver.hpp"
#include "examples/compliant_ur5/senses.hpp"
#include "examples/compliant_ur5/touch_observer.hpp"
#include "skinctl/kinematics/poses.hpp"

namespace compliant_ur5 {

/// Reads a sense from the robot's reports.
template <Sense S>
class SenseReader;

/// Nothing: a skin has a receiver of its own.
template <>
class SenseReader<Sense::skin> {
 public:
  SenseReader(const Settings&, const adapters::ur5::Driver&) {}
  static void ask(adapters::ur5::DriverConfig&) {}
};

/// The controller tells the wrench at the tool's point along the axes of the base, what the world does to the
/// tool, less the weight of the payload that it was told. Here it is taken about the middle of the flange.
template <>
class SenseReader<Sense::wrist> {
 public:
  static void ask(adapters::ur5::DriverConfig& config) { config.tool = true; }
  /// Throws `adapters::ConnectionError` for a robot without such a sensor, or whose base has other axes than
  /// the model.
  SenseReader(const Settings& s, const adapters::ur5::Driver& driver) : sensor_(wrist_touch(s)) {
    if (driver.controller().major < 5)
      throw adapters::ConnectionError(
          "a CB3 has no sensor in its wrist: its actual_TCP_force is reckoned by its currents; try --sense "
          "motors");
    const auto r = tool_from_flange(driver.report());
    if (const double far = std::sqrt(dot(r, r)); !(far < farthest_tool))
      throw adapters::ConnectionError("the controller has the tool's point " + std::to_string(far) +
                                      " m from the flange of the model: are base and robot those of a UR5?");
  }
  /// The sample of the newest report, if it is a new one.
  std::span<const skinctl::WrenchSample> read(const adapters::ur5::Driver& driver) noexcept {
    const adapters::ur5::Report& r = driver.report();
    if (!(r.timestamp > last_)) return {};
    last_ = r.timestamp;
    if (good_ < 0) good_ = last_;
    using namespace skinctl;
    const JointPosition<6> q(r.q);
    const Xyz<double> force{r.wrench[0], r.wrench[1], r.wrench[2]};
    const Xyz<double> moment =
        Xyz<double>{r.wrench[3], r.wrench[4], r.wrench[5]} + cross(tool_from_flange(r), force);
    sample_ =
        sensor_.from_base_axes(driver.clock(), {force.x, force.y, force.z, moment.x, moment.y, moment.z}, q);
    for (std::size_t i = 0; i < 3; ++i) sample_.force[i] -= rest_[i], sample_.moment[i] -= rest_[3 + i];
    const bool valid =
        !skinctl::check(sample_, sensor_.settings().max_force, sensor_.settings().max_moment).any();
    if (valid) good_ = last_;
    return {&sample_, 1};
  }
  /// What it reads in `samples` at rest at `q` becomes its zero. Throws `skinctl::ConfigurationError` if
  /// somebody touches.
  void tare(std::span<const skinctl::WrenchSample> samples, const skinctl::JointPosition<6>& q) {
    const auto bias = sensor_.tared(samples, q).settings().bias;
    rest_ = {bias.force.x, bias.force.y, bias.force.z, bias.moment.x, bias.moment.y, bias.moment.z};
  }
  [[nodiscard]] const std::array<double, 6>& rest() const noexcept { return rest_; }
  /// How long no report has held numbers [s].
  [[nodiscard]] double silent_for() const noexcept { return last_ - good_; }
  [[nodiscard]] const skinctl::WrenchSample& newest() const noexcept { return sample_; }

 private:
  static constexpr double farthest_tool = 0.6;  ///< [m]; with the base turned round it is the arm's reach
  /// From the middle of the flange to the tool's point, along the axes of the base [m].
  static skinctl::Xyz<double> tool_from_flange(const adapters::ur5::Report& r) noexcept {
    using namespace skinctl;
    const auto X = link_poses(ur5::Model{}, JointPosition<6>(r.q)).get<5>() * flange();
    return Xyz<double>{r.tool[0], r.tool[1], r.tool[2]} - X.origin();
  }
  UrWrist sensor_;
  skinctl::WrenchSample sample_;
  std::array<double, 6> rest_{};
  double last_ = -1, good_ = -1;  ///< by the controller's clock [s]
};

template <>
class SenseReader<Sense::motors> {
 public:
  SenseReader(const Settings& s, const adapters::ur5::Driver&) : per_ampere_(s.motors.torque_constant) {}
  static void ask(adapters::ur5::DriverConfig& config) { config.motors = adapters::ur5::MotorOutput::torque; }
  /// At the joints [N m].
  skinctl::JointTorque<6> read(const adapters::ur5::Driver& driver) noexcept {
    const adapters::ur5::Report& r = driver.report();
    skinctl::JointTorque<6> out;
    bool valid = true;
    for (std::size_t i = 0; i < 6; ++i) {
      out[i] = r.motors[i] * (driver.motors_in_newton_metres() ? 1 : per_ampere_[i]);
      valid = valid && std::abs(out[i]) < 1e4;
    }
    last_ = r.timestamp;
    if (valid || good_ < 0) good_ = last_;
    return out;
  }
  [[nodiscard]] double silent_for() const noexcept { return last_ - good_; }

 private:
  PerJoint per_ampere_;
  double last_ = -1, good_ = -1;
};

/// Tells the observer what a wrist sensor feels: about the middle of the flange.
template <class Reader>
void observe(TouchObserver& observer, double t, const Reader& reader, const UrWrist::Memory& m,
             const skinctl::JointPosition<6>& q, const skinctl::JointPosition<6>& target) {
  using namespace skinctl;
  const auto& s = reader.newest();
  const Xyz<double> force = Xyz<double>{s.force[0], s.force[1], s.force[2]} - UrWrist::bias(m).force;
  const double size = std::sqrt(dot(force, force));
  const bool touched = m.force_gate_open && !m.watch.quiet && size > 0;
  ObservedCell felt{.link = 5, .position = flange().origin()};
  if (touched) felt.normal = (-1 / size) * force;
  observer.cycle(t, touched ? size : 0, felt, q, target);
}
/// What motors feel, nobody knows where: as if the flange were pushed in the direction in which the torque
/// moves it.
template <class Reader>
void observe(TouchObserver& observer, double t, const Reader&, const UrMotors::Memory& m,
             const skinctl::JointPosition<6>& q, const skinctl::JointPosition<6>& target) {
  using namespace skinctl;
  JointTouch<ur5::Model> touch;
  for (std::size_t i = 0; i < 6; ++i)
    if (((m.open >> i) & 1u) != 0 && !m.watch.quiet)
      touch.torque[i] = m.observer.residual[i] - m.watch.bias[i];
  ObservedCell felt{.link = 5, .position = flange().origin()};
  double force = 0;
  for (const auto& c : contacts_of(ur5::Model{}, q, touch)) {
    force = c.force;
    JointPosition<6> ahead = q;
    for (std::size_t i = 0; i < 6; ++i) ahead[i] += 1e-6 * touch.torque[i];
    const Xyz<double> way = TouchObserver::point(ahead, felt) - TouchObserver::point(q, felt);
    const double far = std::sqrt(dot(way, way));
    if (far > 0) felt.normal = TouchObserver::in_link(q, felt.link, (-1 / far) * way);
  }
  observer.cycle(t, force, felt, q, target);
}

}  // namespace compliant_ur5
