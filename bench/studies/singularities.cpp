// A tool is led straight through the singularities of a UR5: `singularities [sweeps] [rate] [seed]
// [plot.svg]`, 1000 at 500 Hz.
//
// A sweep: from a random pose near a singular one (wrist, elbow, shoulder in turn) in a straight line and one
// turn through it and as far again beyond, at up to 0.25 m/s and 1 rad/s; then named ones: tool straight down
// and up, ZYZ angles through theta = 0 and pi. A plant with exactly the model's parameters. Printed per kind:
//   fastest   of any joint [rad/s], limit 3.0      deviation  of the tool from its line, worst and mean [m]
//   arrived   within 1 mm and 5 mrad               edge       not arrived: the line leaves the workspace
//   slow      the tool went at less than a tenth of what was asked for longer than 1 s, what is asked out of
//             the workspace left aside (`Reachable`): while the arm turns round, or because it sticks
//   late      neither arrived nor at the edge 4 s after the end of the spline, but on its way
//   stuck     neither, and slow at the end of these 4 s
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "examples/support/svg_plot.hpp"
#include "skinctl/control/spline_operational.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/plant.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Pose = Transform<Base, Flange>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
const ur5::Model model;
const NoTouch none;
const auto X_LF = Transform<Link<5>, Flange>::translation_xyz(0, 0, ur5::Description::d6);

Pose pose(const JointPosition<6>& q) {
  return link_poses(model, q).get<5>() * X_LF;
}
/// Horizontal distance of the wrist's centre from the first axis, along the arm.
double reach(double q1, double q2, double q3) {
  using D = ur5::Description;
  return D::a2 * std::cos(q1) + D::a3 * std::cos(q1 + q2) + D::d5 * std::sin(q1 + q2 + q3);
}
/// Puts the wrist's centre above the first axis; false if this arm cannot.
bool over_the_shoulder(JointPosition<6>& q) {
  for (double a = -3; a < 0; a += 0.05) {
    if (reach(a, q[2], q[3]) * reach(a + 0.05, q[2], q[3]) > 0) continue;
    double low = a, high = a + 0.05;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (reach(low, q[2], q[3]) * reach(middle, q[2], q[3]) <= 0 ? high : low) = middle;
    }
    q[1] = low;
    return true;
  }
  return false;
}

/// The displacement from one pose to another.
Vector6 between(const Pose& a, const Pose& b) {
  const auto p = b.origin() - a.origin();
  const auto phi = log_so3(b.axes() * a.axes().transpose());
  Vector6 d;
  d << p.x, p.y, p.z, phi.x, phi.y, phi.z;
  return d;
}
/// The posture from which the tool is nearest to `goal`, found from `q` by steps of at most 0.05 rad.
JointPosition<6> nearest(JointPosition<6> q, const Pose& goal, int steps) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  double damping = 1e-3;
  Vector6 left = between(pose(q), goal);
  for (int k = 0; k < steps && left.norm() > 1e-5; ++k) {
    const Matrix6 J = as_eigen(jacobian<5>(link_poses(model, q), X_LF));
    Vector6 dq = (J.transpose() * J + damping * Matrix6::Identity()).ldlt().solve(J.transpose() * left);
    dq *= std::min(1.0, 0.05 / (dq.norm() + 1e-12));
    JointPosition<6> next = q;
    for (std::size_t i = 0; i < 6; ++i) next[i] += dq[static_cast<int>(i)];
    const Vector6 then = between(pose(next), goal);
    const bool nearer = then.norm() < left.norm();
    if (nearer) q = next, left = then;
    damping = nearer ? std::max(1e-9, 0.3 * damping) : 4 * damping;
  }
  return q;
}
/// What of a velocity can be reached at q: the tool is asked 2 mm and 2 mrad further along it, and goes to
/// the nearest pose that the arm can take there. It may turn round before that as far as its tool stays
/// within these 2 mm: by random walks of its postures. By Eigen, with no number of the law.
Vector6 reachable(const JointPosition<6>& at, const Vector6& asked) {
  const double way = 0.002, size = asked.norm();
  const auto X = pose(at);
  const Vector6 step = way / size * asked;
  const Pose goal{exp_so3(Xyz<double>{step[3], step[4], step[5]}) * X.axes(),
                  X.origin() + Xyz<double>{step[0], step[1], step[2]}};
  Seeded random(17);
  Vector6 best = Vector6::Zero();
  double least = way;
  for (int walk = 0; walk < 8 && least > 0.02 * way; ++walk) {
    JointPosition<6> q = at;
    const auto heading = random.vector<JointVelocity<6>>(0.1);
    for (int k = 0; walk > 0 && k < 40; ++k) {
      const auto next = nearest(integrate(q, heading, 1.0), X, 6);
      if (between(pose(next), X).norm() > way) break;
      q = next;
    }
    q = nearest(q, goal, 60);
    const double left = between(pose(q), goal).norm();
    if (left < least) least = left, best = between(X, pose(q));
  }
  return size / way * best;
}

struct Row {
  const char* name;
  int sweeps = 0, arrived = 0, edge = 0, slow = 0, late = 0, stuck = 0;
  double fastest = 0, worst = 0, sum = 0;
  std::vector<double> deviations{}, waits{};  ///< of every sweep [mm], [s]

  void print() const {
    std::printf("%-22s %6d %8.2f %9.3f %9.3f %8d %6d %6d %6d %6d\n", name, sweeps, fastest, worst,
                sum / std::max(1, sweeps), arrived, edge, slow, late, stuck);
  }
};

template <class Orientation>
void sweep(Row& row, const JointPosition<6>& from, const Pose& goal, double rate) {
  using Space = OperationalSpace<6, 5, Flange, double, TaskSpace::pose, Orientation>;
  using L = SplineOperational<6, 5, Flange, double, TaskSpace::pose, Orientation>;
  using K = Quantities<ur5::Model, L::needs>;
  const double dt = 1 / rate;
  OperationalSettings<6> s{.tracking = {.dt = nanoseconds(dt), .tb = 0s}};
  s.tracking.max_velocity = JointVelocity<6>::constant(3);
  s.max_linear_velocity = 0.25;
  s.max_angular_velocity = 1;
  const L law(Space(X_LF, s), s);
  State<6> x{0ns, from, {}};
  auto memory = law.start(K(model, x, dt, none));
  memory = law.receive(memory, K(model, x, dt, none), {goal, 0ns}).memory;
  const double tf = Space::shortest_time(pose(from), {goal, 0ns}, s);
  double deviation = 0, left = 0, turned = 0, below = 0, longest = 0;
  bool outward = false, was_slow = false;
  Vector6 inside = Vector6::Zero();
  for (int i = 0; i < static_cast<int>((tf + 4) * rate); ++i) {
    const K known(model, x, dt, none);
    const auto site = law.space().site(known);
    const auto target = memory.plan.at(0, s);
    const auto d = site.X_BP.origin() - target.X_BP.origin();
    const auto phi = log_so3(site.X_BP.axes() * target.X_BP.axes().transpose());
    left = std::sqrt(dot(d, d)), turned = std::sqrt(dot(phi, phi));
    deviation = std::max(deviation, left);
    const auto now = law.now(memory, known);
    Vector6 asked;
    for (int j = 0; j < 6; ++j) asked[j] = now.dx_r[static_cast<std::size_t>(j)];
    if constexpr (std::same_as<Orientation, ZyzError>) asked.tail<3>().setZero();  // no omega
    Vector6 V = as_eigen(site.V);
    if constexpr (std::same_as<Orientation, ZyzError>) V.tail<3>().setZero();
    const auto too_slow = [&](const Vector6& v) {
      return v.norm() > 0.02 && V.dot(v) < 0.1 * v.squaredNorm();
    };
    bool slow = too_slow(asked);
    outward = slow && outward;
    if (slow) {
      if (i % 10 == 0 || !was_slow) inside = reachable(x.q, asked) / asked.norm();
      const Vector6 kept = asked.norm() * inside;
      outward = (asked - kept).norm() > 0.05 * asked.norm();
      slow = too_slow(kept);
    }
    was_slow = too_slow(asked);
    below = slow ? below + dt : 0;
    longest = std::max(longest, below);
    const auto out = evaluate(law, memory, known, dt);
    memory = out.memory;
    x = simulate(model, x, out.torque, dt, 1);
    for (const double v : x.dq) row.fastest = std::max(row.fastest, std::abs(v));
  }
  const bool arrived = left < 1e-3 && turned < 5e-3;
  ++row.sweeps;
  row.arrived += arrived;
  row.edge += !arrived && outward;
  row.late += !arrived && !outward && !(below > 1);
  row.stuck += !arrived && !outward && below > 1;
  row.slow += longest > 1;
  row.deviations.push_back(1000 * deviation);
  row.waits.push_back(longest);
  row.worst = std::max(row.worst, deviation);
  row.sum += deviation;
}
/// From the pose of `from` through that of `through`, `beyond` times as far.
Pose through(const JointPosition<6>& from, const JointPosition<6>& by, double beyond) {
  const auto X0 = pose(from), X1 = pose(by);
  return {exp_so3(Xyz<double>(beyond * log_so3(X1.axes() * X0.axes().transpose()))) * X0.axes(),
          X0.origin() + beyond * (X1.origin() - X0.origin())};
}
/// Every sweep of a row, sorted: how many of them stay below.
plotting::Series sorted(const Row& row, std::vector<double> y) {
  std::sort(y.begin(), y.end());
  std::vector<double> x;
  for (std::size_t i = 0; i < y.size(); ++i)
    x.push_back(100 * static_cast<double>(i + 1) / static_cast<double>(y.size()));
  return {row.name, x, y};
}
void draw(const char* path, const Row (&rows)[3]) {
  plotting::Plot wait, deviation;
  wait.title = "Longest time below a tenth of the asked speed";
  wait.y_name = "[s]", wait.x_name = deviation.x_name = "sweeps [%]";
  wait.limits = {{1.0, "1 s"}};
  deviation.title = "Largest deviation of the tool from its line";
  deviation.y_name = "[mm]";
  for (const auto& row : rows) {
    wait.series.push_back(sorted(row, row.waits));
    deviation.series.push_back(sorted(row, row.deviations));
  }
  if (!plotting::write_svg(
          path, plotting::svg_figure("Straight through the singularities of a UR5", {wait, deviation})))
    std::exit(1);
}
}  // namespace

int main(int count, char** arguments) {
  const int sweeps = count > 1 ? std::atoi(arguments[1]) : 1000;
  const double rate = count > 2 ? std::atof(arguments[2]) : 500;
  Seeded rng(count > 3 ? static_cast<unsigned>(std::atoi(arguments[3])) : 5);
  Row rows[3] = {{"wrist"}, {"elbow"}, {"shoulder"}};
  for (int k = 0; k < sweeps; ++k) {
    JointPosition<6> q{rng.between(-3, 3), rng.between(-2.5, -0.5), rng.between(0.5, 2.3),
                       rng.between(-2, 1), rng.between(0.5, 2.5),   rng.between(-3, 3)};
    if (k % 3 == 0) q[4] = 0;
    if (k % 3 == 1) q[2] = 0;
    if (k % 3 == 2 && !over_the_shoulder(q)) continue;
    auto from = q;
    for (double& a : from) a += rng.between(-0.35, 0.35);
    sweep<RotationVectorError>(rows[k % 3], from, through(from, q, 1.6), rate);
  }
  std::printf("%-22s %6s %8s %9s %9s %8s %6s %6s %6s %6s\n", "", "sweeps", "fastest", "deviation", "mean",
              "arrived", "edge", "slow", "late", "stuck");
  for (const auto& row : rows) row.print();

  // Tool straight down, straight up, and through both: ZYZ theta = pi and 0.
  const JointPosition<6> down{0, -1.4, 1.9, -2.0708, -1.5708, 0}, up{0, -1.4, 1.9, 1.0708, -1.5708, 0};
  Row named[4] = {{"tool down, SO(3)"}, {"tool down, ZYZ"}, {"tool up, SO(3)"}, {"tool up, ZYZ"}};
  for (int k = 0; k < 20; ++k) {
    for (int which = 0; which < 2; ++which) {
      const auto& home = which == 0 ? down : up;
      auto from = home;
      for (double& a : from) a += 0.25 * rng();
      Pose goal = through(from, home, 2.0);
      if (k % 2 == 0) {  // straight down (up) all the way
        from = home;
        goal = {pose(home).axes(), pose(home).origin() + Xyz<double>{0.1 * rng(), 0.15 * rng(), 0.1 * rng()}};
      }
      sweep<RotationVectorError>(named[2 * which], from, goal, rate);
      sweep<ZyzError>(named[2 * which + 1], from, goal, rate);
    }
  }
  for (const auto& row : named) row.print();
  if (count > 4) draw(arguments[4], rows);
}
