// ur5_torque_study: a simulated UR5 by direct torque, with the friction that its controller leaves over: how
// near to its target it rests, and what targets in steps do to it. In step with the simulation, some ten
// seconds.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "examples/adapters/tests/under_torque.hpp"
#include "examples/support/job.hpp"
#include "examples/support/program.hpp"

using namespace under_torque;

int main(int argc, char** argv) {
  namespace job = examples::job;
  CLI::App app{
      "Rests and follows by direct torque on a simulated UR5 with dry friction, with and without learning "
      "it."};
  app.footer(job::exit_help());
  bool simulate = false;
  app.add_flag("--simulate", simulate, "a simulated UR5 (there is no other)");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  std::printf(
      "| compensated by the controller | learning | farthest joint at rest [deg] | moves there by [deg] "
      "|\n|---|---|---|---|\n");
  bool fine = true;
  for (const double scale : {0.0, 0.5, 0.8})
    for (const bool learns : {false, true}) {
      const Rest r = rest(learns, scale);
      std::printf("| %.0f %% of dry friction | %s | %.3f | %.4f |%s\n", 100 * scale, learns ? "yes" : "no",
                  r.error / degree, r.hunting / degree, r.lost.c_str());
      fine = fine && r.lost.empty() && (!learns || r.error < 0.1 * degree);
    }
  std::printf(
      "\n| 50 positions a second | reference's jerk [rad/s^3] | torque from cycle to cycle [N m] | error, "
      "rms [deg] |\n|---|---|---|---|\n");
  const auto print = [&](const char* name, const Following& f) {
    std::printf("| %s | %.0f | %.2f | %.2f |%s\n", name, f.jerk, f.torque_step, f.error / degree,
                f.lost.c_str());
    fine = fine && f.lost.empty();
  };
  print("as they come (JointControl)", follow_steps<JointControl<6>>(0.8));
  print("ReactiveJoint", follow_steps<ReactiveJoint<6>>(0.8));
  return fine ? 0 : 1;
}
