// 06 A straight line: a tool moves and turns to a pose in which the wrist is singular, and rests there.
//
//   reach    Spline Operational Control, eqs. (15)-(22), of the tool on link 5
//   X_BG     goal pose of the tool
//   slowed   near the singularity the joints reach their speed limit, and the tool waits for them
#include <cmath>

#include "skinctl/control/spline_operational.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/law/evaluate.hpp"
#include "skinctl/robots/ur5.hpp"
#include "support/curves.hpp"

using namespace skinctl;

int main(int argc, char** argv) {
  const ur5::Model robot;
  const double h = 0.002;
  OperationalSettings<6> settings{.tracking = {.dt = nanoseconds(h), .tb = 0s}};
  settings.tracking.max_velocity = JointVelocity<6>::constant(2.5);
  const auto X_LT = Transform<Link<5>, Tool>::translation_xyz(0, 0, 0.15);
  const SplineOperational<6, 5> reach(X_LT, settings);
  using Known = Quantities<ur5::Model, SplineOperational<6, 5>::needs>;
  const NoTouch touch;

  // The goal is a singular pose: with q4 = 0 the wrist is stretched and J has no inverse.
  State<6> state{0ns, {0.5, -1.4, 1.2, -1.7, 0.4, 0.1}, {}};
  const auto X_BG = link_poses(robot, JointPosition<6>{0.3, -1.2, 1.4, -1.8, 0.0, 0.3}).get<5>() * X_LT;
  auto memory = reach.start(Known(robot, state, h, touch));
  memory = reach.receive(memory, Known(robot, state, h, touch), {X_BG, 2s}).memory;

  examples::Curve way{"distance to the goal [mm]"}, wrist{"joint 4 [rad]"}, speed{"fastest joint [rad/s]"};
  int slowed = 0;
  for (int k = 0; k <= 2000; ++k) {
    const Known known(robot, state, h, touch);
    const auto d = (known.pose<5>() * X_LT).origin() - X_BG.origin();
    double fastest = 0;
    for (const double v : state.dq) fastest = std::fmax(fastest, std::abs(v));
    way.add(h * k, 1e3 * std::sqrt(dot(d, d)));
    wrist.add(h * k, state.q[4]);
    speed.add(h * k, fastest);

    const auto now = evaluate(reach, memory, known, h);
    slowed += now.status.has(Reason::slowed);
    const auto ddq = forward_dynamics(robot, state.q, state.dq, now.torque).acceleration;
    state.dq = integrate(state.dq, ddq, h);
    state.q = integrate(state.q, state.dq, h);
    memory = now.memory;
  }
  std::printf("%.2f mm from the goal, slowed down for %.2f s\n", way.y.back(), h * slowed);
  return examples::draw(argc, argv, "06_straight_line.svg",
                        "Straight to a pose in which the wrist is singular", {way, wrist, speed}) ||
         way.y.back() > 2;
}
