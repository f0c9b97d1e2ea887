#include "examples/packing_oranges/carriage.hpp"

#include <algorithm>
#include <cmath>

namespace packing {
namespace {
using namespace skinctl;

struct WheelTree {
  static constexpr std::size_t joints = 3;
  static constexpr auto parents = chain_parents<3>();
  static constexpr std::array<JointKind, 3> kinds = {JointKind::prismatic, JointKind::prismatic,
                                                     JointKind::revolute};
};
/// Along x, along y, about the vertical.
CalibratedModel<WheelTree> wheel_model() {
  const Rotation<double> next_axis{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  std::array<PlacedLink, 3> links;
  for (PlacedLink& link : links) link.R = next_axis;
  links[2].inertia = {240, {0, 0, 0}, 30, 60, 80};
  return CalibratedModel<WheelTree>(canonical_links<WheelTree>(links).links);
}
auto wheel_scene() {
  const double inf = std::numeric_limits<double>::infinity();
  const auto robot = by_velocity(wheel_model(), {.limits = JointLimits<3>({.lower = {-20, -20, -inf},
                                                                           .upper = {20, 20, inf},
                                                                           .velocity = {1, 1, 0.6},
                                                                           .acceleration = {1, 1, 1},
                                                                           .torque = {600, 600, 200}}),
                                                 .period = Carriage::period,
                                                 .delay = 8ms,
                                                 .lag = 35ms,
                                                 .virtual_damping = 2});
  return Cycle(robot, SplineJoint(robot));
}
double turn_between(double from, double to) {
  return std::remainder(to - from, 2 * M_PI);
}
}  // namespace

void Whereabouts::roll(const skinctl::State<3>& wheels) {
  const Standing now{wheels.q[0], wheels.q[1], wheels.q[2]};
  const Standing was = told_.value_or(now);
  told_ = now;
  const double dx = now.x - was.x, dy = now.y - was.y, dyaw = now.yaw - was.yaw;
  const double turn = at_.yaw - was.yaw, c = std::cos(turn), s = std::sin(turn);
  const double x = c * dx - s * dy, y = s * dx + c * dy;
  at_.x += x, at_.y += y, at_.yaw += dyaw;
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F(0, 2) = -y, F(1, 2) = x;
  const double way = std::hypot(dx, dy), more = way * (2 * way_ + way);
  way_ += way;
  P_ = F * P_ * F.transpose();
  P_.diagonal() += more * Eigen::Vector3d(slip * slip, slip * slip, slip_turn * slip_turn);
}

void Whereabouts::see(const Transform<World, Base>& X_WB, std::span<const ClassDetection<>> things) {
  for (const auto& thing : things) {
    if (thing.kind != mark_class) continue;
    const auto X = X_WB.inverse();
    const Xyz<double> seen = X.origin() + X.axes() * thing.p_W;  // in Base
    const auto X_now = at_.pose();
    const Xyz<double> there = X_now.origin() + X_now.axes() * seen;
    for (const Xyz<double>& mark : table_marks) {
      if (std::hypot(there.x - mark.x, there.y - mark.y) > is_mark) continue;
      const double c = std::cos(at_.yaw), s = std::sin(at_.yaw), x = mark.x - at_.x, y = mark.y - at_.y;
      Eigen::Matrix<double, 2, 3> H;
      H << -c, -s, -s * x + c * y, s, -c, -c * x - s * y;
      const Eigen::Vector2d off(seen.x - (c * x + s * y), seen.y - (-s * x + c * y));
      const Eigen::Matrix2d S =
          H * P_ * H.transpose() + thing.sigma * thing.sigma * Eigen::Matrix2d::Identity();
      const Eigen::Matrix2d S_inv = S.inverse();
      if (off.dot(S_inv * off) > max_deviations * max_deviations) break;
      const Eigen::Matrix<double, 3, 2> K = P_ * H.transpose() * S_inv;
      const Eigen::Vector3d by = K * off;
      at_.x += by[0], at_.y += by[1], at_.yaw += by[2];
      P_ = (Eigen::Matrix3d::Identity() - K * H) * P_;
      P_ = (0.5 * (P_ + P_.transpose())).eval();
      break;
    }
  }
}

struct Carriage::Driving {
  using Scene = decltype(wheel_scene());
  const Scene scene = wheel_scene();
  Scene::Memory memory;
  Scene::Input input;
};

Carriage::Carriage(const State<3>& wheels) : driving_(std::make_unique<Driving>()), wheels_(wheels) {
  driving_->scene.start(driving_->memory, wheels);
  where_.roll(wheels);
  tell(wheels.time, wheels, {});
}
Carriage::~Carriage() = default;

void Carriage::go(std::size_t table) {
  if (table == goal_) return;
  goal_ = table;
  ++drives_;
  phase_ = Phase::drives;
  send();
}

/// The place in the coordinates of the wheels, which have slipped.
void Carriage::send() {
  const Standing to = place(goal_), at = where_.at();
  const double turn = wheels_.q[2] - at.yaw, c = std::cos(turn), s = std::sin(turn);
  const double x = to.x - at.x, y = to.y - at.y, turns = turn_between(at.yaw, to.yaw), way = std::hypot(x, y);
  const double time =
      std::max({0.5, 1.875 * way / pace, 1.875 * std::abs(turns) / turning, std::sqrt(5.78 * way / swing)});
  driving_->input.goal = JointGoal<3>{
      {wheels_.q[0] + c * x - s * y, wheels_.q[1] + s * x + c * y, wheels_.q[2] + turns}, nanoseconds(time)};
  moved_ = now_;
}

void Carriage::see(const BaseState<>& taken_at, std::span<const ClassDetection<>> things) {
  if (phase_ == Phase::drives || taken_at.time < moved_ + settles) return;
  if (phase_ == Phase::stands) return;
  where_.see(taken_at.X_WB, things);
  if (where_.sigma() > sure || where_.sigma_turn() > sure_turn) return;
  where_.stops();
  const Standing to = place(goal_), at = where_.at();
  if (std::hypot(to.x - at.x, to.y - at.y) < near && std::abs(turn_between(at.yaw, to.yaw)) < near_turn) {
    phase_ = Phase::stands;
    return;
  }
  ++corrections_;
  phase_ = Phase::drives;
  send();
}

JointVelocity<3> Carriage::step(Nanoseconds now, const State<3>& wheels, bool touched) {
  constexpr double still = 0.002;  // [m/s], [rad/s]
  now_ = now;
  wheels_ = wheels;
  where_.roll(wheels);
  auto& input = driving_->input;
  if (touched) touched_ = now;
  const bool lets_go = now - touched_ >= untouched;
  if (phase_ == Phase::drives && !halted_ && !lets_go) {
    input.request = CycleRequest::stop;
    halted_ = true;
    ++halts_;
  }
  if (halted_ && lets_go) {
    input.request = CycleRequest::resume;
    halted_ = false;
  }
  input.now = now;
  input.measured = wheels;
  const auto out = driving_->scene.step(driving_->memory, input);
  clear_requests(input);
  const double speed = std::hypot(out.command.velocity[0], out.command.velocity[1]);
  if (speed > still || std::abs(out.command.velocity[2]) > still || halted_) moved_ = now;
  if (phase_ == Phase::drives && !halted_ && now - moved_ > settles) phase_ = Phase::looks;
  tell(now, wheels, out.planned.acceleration);
  return out.command.velocity;
}

void Carriage::tell(Nanoseconds now, const State<3>& wheels, const JointAcceleration<3>& planned) {
  state_.time = now;
  state_.X_WB = where_.at().pose();
  const double c = std::cos(wheels.q[2]), s = std::sin(wheels.q[2]);
  const auto along = [&](double x, double y) { return Xyz<double>{c * x + s * y, c * y - s * x, 0}; };
  state_.V_WB_B.linear = along(wheels.dq[0], wheels.dq[1]);
  state_.V_WB_B.angular = {0, 0, wheels.dq[2]};
  state_.A_WB_B.linear = along(planned[0], planned[1]);
  state_.A_WB_B.angular = {0, 0, planned[2]};
  state_.sigma = where_.sigma();
  state_.sigma_turn = where_.sigma_turn();
}

}  // namespace packing
