// A UR5 as it comes: random robots that are not as declared, and the hands and walls that touch them.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/random.hpp"
#include "skinctl/testing/undeclared_joints.hpp"
#include "tests/support/scene.hpp"

namespace skinctl::testing {

enum class AsItComesScene { untouched, held_goal, led, wall, blocked, count };
inline constexpr const char* as_it_comes_scenes[] = {"untouched", "held goal", "led by hand",
                                                     "tool on a wall", "blocked"};

/// One robot in one scene, from a seed.
struct AsItComes {
  static constexpr double guided = 11;  ///< until then the arm is led or moves to goals [s]

  AsItComesScene scene;
  Interface interface;
  Nanoseconds period;
  JointTruth<6> truth;
  double friction = 0;  ///< as a share of the largest torques
  double payload = 0;   ///< at the flange, of which the robot does not know [kg]
  JointPosition<6> pose, goal;
  JointPosition<6> touched_at;  ///< the pose in which the touched cells were chosen: twins have the same ones
  bool reports_held = false;    ///< its controller reports the position that it holds (`target_q` of a UR)
  double dead_band = 0.02;      ///< of the configuration [rad]
  double declared_lag = 0.008;  ///< of the configuration [s]
  std::uint64_t seed;
  std::size_t link;        ///< that is touched
  double hand, wall, way;  ///< stiffness [N/m] of both; amplitude of the hand [m]
  double pace, place;      ///< of the hand [s]; where on the link, 0 to 1
  double let_go = 13.5;    ///< held fast from 12 s until then, in the scene `blocked` [s]

  explicit AsItComes(std::uint64_t number) : seed(number) {
    Random random = seeded(number * 2654435761u + 1);
    const auto u = [&](double a, double b) { return uniform(random, a, b); };
    const auto log_u = [&](double a, double b) { return a * std::exp(u(0, std::log(b / a))); };
    const auto one_in = [&](unsigned n) { return random() % n == 0; };
    scene = static_cast<AsItComesScene>(number % 5);
    interface = one_in(3) ? Interface::velocity : Interface::position;
    period = one_in(3) ? 2ms : 8ms;
    truth.delay = 0.008;
    truth.lag = u(0, 0.05);
    if (one_in(2)) truth.lookahead = u(0, truth.lag), truth.lag -= truth.lookahead;
    if (!one_in(3)) {
      const double size = u(0, 0.1);
      for (double& gap : truth.gap) gap = size * u(-1, 1);
      truth.gap[random() % 6] = one_in(2) ? size : -size;
    }
    if (!one_in(3)) truth.stiffness = JointTruth<6>::all(log_u(500, 1e5));
    if (one_in(2)) truth.integral_time = log_u(0.2, 2);
    truth.inertia = {3, 3, 1.5, 0.3, 0.3, 0.3};
    truth.max_speed = 3.2;
    for (std::size_t i = 0; i < 6; ++i) truth.torque_limit[i] = ur5::Description::max_torque[i];
    if (!one_in(3)) friction = u(0, 0.2);
    const double breakaway = u(1, 1.25);
    for (std::size_t i = 0; i < 6; ++i) {
      truth.coulomb[i] = friction / breakaway * ur5::Description::max_torque[i];
      truth.stiction[i] = friction * ur5::Description::max_torque[i];
    }
    if (!one_in(3)) truth.resolution = log_u(1e-6, 1e-3);
    if (!one_in(3)) truth.noise = log_u(1e-6, 1e-4);
    if (one_in(2)) truth.delay_jitter = u(0, 0.004), truth.stamp_jitter = u(0, 0.001);
    if (one_in(2)) truth.skipped = u(0, 0.1);
    if (one_in(2)) payload = u(0, 5);
    for (std::size_t i = 0; i < 6; ++i) {
      pose[i] = home[i] + u(-0.3, 0.3);
      goal[i] = pose[i] + u(-0.5, 0.5);
    }
    touched_at = pose;
    link = scene == AsItComesScene::wall ? 3 + random() % 2 : 1 + random() % 4;
    hand = log_u(500, 3000);
    wall = log_u(2000, 10000);
    way = u(0.03, 0.1);
    pace = u(3, 6);
    place = u(0, 1);
  }
};

/// A cell of the skin: its id and its place on its link.
struct AsItComesCell {
  std::uint32_t id = 0;
  std::size_t link = 0;
  Xyz<double> p, n;
};

/// Poses of the true robot, for contacts and loads.
class TruePoses {
 public:
  explicit TruePoses(const std::array<double, 6>& q) : TruePoses(JointPosition<6>(q)) {}
  explicit TruePoses(const JointPosition<6>& q) : poses_(ur5::Model{}, q) {
    at<0>(), at<1>(), at<2>(), at<3>(), at<4>(), at<5>();
  }
  Xyz<double> point(std::size_t link, const Xyz<double>& p) const {
    return origin_[link] + direction(link, p);
  }
  Xyz<double> direction(std::size_t link, const Xyz<double>& d) const {
    return d.x * x_[link] + d.y * y_[link] + d.z * z_[link];
  }
  /// Joint torques of a force on a link.
  void add(std::size_t link, const Xyz<double>& p, const Xyz<double>& force,
           std::array<double, 6>& torque) const {
    for (std::size_t j = 0; j <= link; ++j) {
      const Xyz<double> m = cross(p - origin_[j], force);
      torque[j] += z_[j].x * m.x + z_[j].y * m.y + z_[j].z * m.z;
    }
  }

 private:
  template <std::size_t I>
  void at() {
    const auto X = poses_.template get<I>();
    x_[I] = X.axis_x(), y_[I] = X.axis_y(), z_[I] = X.axis_z(), origin_[I] = X.origin();
  }
  Poses<ur5::Model, 0b111111> poses_;
  std::array<Xyz<double>, 6> x_, y_, z_, origin_;
};

/// Two cells on opposite sides of a link: one along whose normal the arm can move, and its opposite.
/// @param pick  among those, 0 to 1.
template <std::size_t Cells>
std::array<AsItComesCell, 2> opposite_cells(const TruePoses& poses, std::size_t link, double pick) {
  std::vector<AsItComesCell> cells;
  const auto patches = ur5::skin_patches<Cells>();
  std::apply(
      [&](const auto&... patch) {
        const auto take = [&](const auto& from) {
          if (std::remove_cvref_t<decltype(from)>::link != link) return;
          for (const auto& cell : from.any())
            cells.push_back({cell.id, link, cell.X_LC.origin(), cell.X_LC.axis_z()});
        };
        (take(patch), ...);
      },
      patches);
  // The shorter the lever, the heavier the arm.
  std::vector<std::pair<double, std::size_t>> levers;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    std::array<double, 6> row{};
    poses.add(link, poses.point(link, cells[k].p), poses.direction(link, cells[k].n), row);
    double square = 0;
    for (const double r : row) square += r * r;
    levers.push_back({-square, k});
  }
  std::sort(levers.begin(), levers.end());
  const AsItComesCell first = cells[levers[static_cast<std::size_t>(pick * double(cells.size()) / 3)].second];
  AsItComesCell second;
  double best = 1e9;
  for (const AsItComesCell& cell : cells) {
    const Xyz<double> d = cell.p - first.p;
    const double along = dot(d, first.n), off = 100 * (dot(d, d) - along * along) + 1 + dot(cell.n, first.n);
    if (off < best) best = off, second = cell;
  }
  return {first, second};
}

/// The forces of a case's hand and wall at its two cells.
class AsItComesWorld {
 public:
  static constexpr double begins = 1, faster = AsItComes::guided, leaves = 14, ends = 17;
  static constexpr std::size_t cells_of_skin = 260;
  static constexpr double newtons = 20;  ///< of the sum of a cell's three readings

  AsItComesWorld(const AsItComes& c, const std::array<double, 6>& q)
      : c_(c), cells_(opposite_cells<cells_of_skin>(TruePoses(c.touched_at), c.link, c.place)) {
    take_hold(TruePoses(q));
  }
  /// Hand and wall are where the cells are now.
  void take_hold(const TruePoses& poses) {
    u_ = -poses.direction(c_.link, cells_[0].n);
    for (std::size_t k = 0; k < 2; ++k) place_[k] = poses.point(c_.link, cells_[k].p);
  }
  [[nodiscard]] const AsItComesCell& cell(std::size_t k) const { return cells_[k]; }
  /// On both cells [N] at time `t` [s]; the first is pushed along u, the second against it.
  [[nodiscard]] std::array<double, 2> forces(const TruePoses& poses, double t) const {
    if (c_.scene == AsItComesScene::untouched || t < begins || t > leaves) return {};
    const double in_first = dot(place_[0] - poses.point(c_.link, cells_[0].p), u_),
                 in_second = dot(poses.point(c_.link, cells_[1].p) - place_[1], u_);
    // From a cell that turns away it slips.
    const double grip = std::max(0.0, -dot(poses.direction(c_.link, cells_[0].n), u_));
    const auto push = [&](double k, double depth) { return k * std::max(0.0, depth) * grip; };
    if (c_.scene == AsItComesScene::held_goal) {  // a finger, 0.06 m/s
      const double s = std::min(0.06 * (t - faster) - 0.06, 0.04);
      return {t < faster || t > leaves - 0.5 ? 0 : push(c_.hand, in_first + s), 0};
    }
    const double pi = 3.14159265358979, slow = (faster - begins) / c_.pace;
    const double turns = t < faster ? (t - begins) / c_.pace : slow + 1.5 * (t - faster) / c_.pace;
    double s = 0.5 * c_.way * (1 - std::cos(2 * pi * turns)), wall = 0;
    if (c_.scene == AsItComesScene::wall && t > faster) {
      const double from = 0.5 * c_.way * (1 - std::cos(2 * pi * slow)), to = c_.way + 0.03;
      s = from + std::min(1.0, (t - faster) / 1.5) * (to - from);
      wall = push(c_.wall, in_second - c_.way - 0.01);
    }
    const double loose = 0.003, fade = std::min(1.0, 4 * (leaves - t));  // the hand holds it loosely
    return {fade * push(c_.hand, in_first + s - loose), fade * push(c_.hand, in_second - s - loose) + wall};
  }
  [[nodiscard]] std::array<double, 6> torque(const TruePoses& poses,
                                             const std::array<double, 2>& forces) const {
    std::array<double, 6> tau{};
    for (std::size_t k = 0; k < 2; ++k)
      if (forces[k] > 0)
        poses.add(c_.link, poses.point(c_.link, cells_[k].p), (k == 0 ? forces[k] : -forces[k]) * u_, tau);
    if (c_.payload > 0)
      poses.add(5, poses.point(5, {0, 0, ur5::Description::flange[2]}), {0, 0, -9.81 * c_.payload}, tau);
    return tau;
  }

 private:
  const AsItComes& c_;
  std::array<AsItComesCell, 2> cells_;
  Xyz<double> u_, place_[2];
};

}  // namespace skinctl::testing
