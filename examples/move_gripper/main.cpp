// move_gripper: opens or closes a gripper and says what it holds. Without an address a simulated one stands
// in.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <thread>

#include "examples/adapters/gripper/lacquey.hpp"
#include "examples/adapters/gripper/onrobot.hpp"
#include "examples/adapters/gripper/robotiq.hpp"
#include "examples/simulated_gripper/server.hpp"
#include "examples/support/job.hpp"
#include "examples/support/program.hpp"
#include "skinctl/core/contract.hpp"

namespace {

using namespace std::chrono_literals;
using namespace adapters::gripper;
namespace job = examples::job;
using skinctl::GripperError;
using skinctl::GripperState;

struct Wish {
  bool open = false, close = false;
  std::optional<double> opening, force, speed;
  double time = 10;
  bool quiet = false;
};

skinctl::GripperGoal goal_of(const Wish& wish, const skinctl::GripperRange& range) {
  const double force = wish.force.value_or(range.min_force);
  skinctl::GripperGoal goal = wish.open ? open_goal(range) : close_goal(range, force);
  if (wish.opening) goal.opening = *wish.opening;
  goal.force = force;
  goal.speed = wish.speed.value_or(range.max_speed);
  return goal;
}

template <skinctl::GripperDriver G>
job::Exit run(G& gripper, const Wish& wish) {
  const job::StopSignals signals;
  job::Progress progress(wish.quiet, 0.1);
  const auto range = gripper.range();
  std::printf("opens to %.1f mm, %.0f to %.0f N, %.0f to %.0f mm/s\n", 1000 * range.opening, range.min_force,
              range.max_force, 1000 * range.min_speed, 1000 * range.max_speed);
  const auto start = std::chrono::steady_clock::now();
  const auto deadline =
      start + std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(wish.time));
  const bool moves = wish.open || wish.close || wish.opening;
  if (moves && !gripper.move(goal_of(wish, range))) return job::Exit::lost;
  GripperState state;
  for (auto now = start;; now = std::chrono::steady_clock::now()) {
    state = gripper.poll(now - start);
    if (progress.due(std::chrono::duration<double>(now - start).count()))
      progress.show("%5.1f mm%s%s", 1000 * state.opening, state.moving ? ", moving" : "",
                    state.holding ? ", holding" : "");
    if (signals.asked()) {
      gripper.stop();
      gripper.poll(now - start);
      return job::Exit::interrupted;
    }
    if (state.error != GripperError::none && state.error != GripperError::silent) break;
    if (state.heard && !state.moving) break;
    if (!moves && !state.measured) break;  // a gripper that says nothing has nothing to be waited for
    if (now > deadline) {
      gripper.stop();
      gripper.poll(now - start);
      progress.clear();
      std::fprintf(stderr, "move_gripper: still moving after %.1f s: stopped\n", wish.time);
      return job::Exit::not_following;
    }
    std::this_thread::sleep_for(2ms);
  }
  progress.clear();
  if (state.error != GripperError::none) {
    std::fprintf(stderr, "move_gripper: %s (%u)\n", skinctl::describe(state.error), unsigned{state.code});
    return state.error == GripperError::lost ? job::Exit::lost : job::Exit::halted;
  }
  std::printf("%.1f mm open%s", 1000 * state.opening, state.measured ? "" : " by the time it took");
  if (state.holding) std::printf(", holds an object with %.1f N", state.force);
  std::printf("\n");
  return job::Exit::fine;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Opens or closes a gripper and says what it holds. Without --host a simulated one stands in."};
  app.footer(job::exit_help());
  std::string kind = "robotiq", host;
  std::uint16_t port = 0;
  Wish wish;
  bool no_activation = false, simulate = false;
  double object = 0.05, stiffness = std::numeric_limits<double>::infinity();
  app.add_option("kind", kind,
                 "robotiq (2F-85), onrobot (RG2) or lacquey (TUM's, through the robot's program)")
      ->check(CLI::IsMember({"robotiq", "onrobot", "lacquey"}))
      ->capture_default_str();
  auto* at = app.add_option("--host", host,
                            "address of the gripper's controller; for lacquey that of this computer");
  app.add_option("--port", port, "instead of 63352, 502 or 50003");
  app.add_flag("--simulate", simulate, "a simulated gripper (the default)")->excludes(at);
  app.add_option("--object", object, "simulated: width of what is between the fingers; 0: nothing [m]")
      ->capture_default_str();
  app.add_option("--stiffness", stiffness, "simulated: of the object [N/m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  auto* goal = app.add_option_group("goal", "without one: says where it stands");
  goal->add_flag("--open", wish.open, "all the way");
  goal->add_flag("--close", wish.close, "until an object is held");
  goal->add_option("--opening", wish.opening, "[m]");
  goal->require_option(0, 1);
  app.add_option("--force", wish.force, "[N]; the least that it can, if left out");
  app.add_option("--grip-speed", wish.speed, "[m/s]");
  app.add_flag("--no-activation", no_activation,
               "refuse a Robotiq that is not active: activation moves its fingers");
  app.add_option("--time", wish.time, "stopped if it still moves after so long [s]")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str();
  app.add_flag("-q,--quiet", wish.quiet, "no progress");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  try {
    std::unique_ptr<simulated_gripper::Server> simulated;
    simulated_gripper::ServerConfig config{.object = {object, stiffness}};
    const bool real = !host.empty();
    const auto reach = [&](simulated_gripper::Kind which, std::uint16_t usual) {
      if (real) return port != 0 ? port : usual;
      config.kind = which;
      simulated = std::make_unique<simulated_gripper::Server>(config);
      return simulated->port();
    };
    job::Exit exit = job::Exit::fine;
    if (kind == "robotiq") {
      RobotiqConfig c;
      c.activate = !no_activation;
      c.port = reach(simulated_gripper::Kind::robotiq, c.port);
      if (real) c.host = host;
      Robotiq gripper(c);
      gripper.connect();
      exit = run(gripper, wish);
    } else if (kind == "onrobot") {
      OnRobotConfig c;
      c.port = reach(simulated_gripper::Kind::onrobot, c.port);
      if (real) c.host = host;
      OnRobot gripper(c);
      gripper.connect();
      exit = run(gripper, wish);
    } else {
      LacqueyServer line(real ? host : "127.0.0.1",
                         real ? (port != 0 ? port : std::uint16_t{50003}) : std::uint16_t{0});
      config.port = line.port();
      reach(simulated_gripper::Kind::lacquey, 0);
      line.accept(adapters::Timeout(10000));
      BinaryGripper gripper(line, {});
      exit = run(gripper, wish);
    }
    if (simulated && exit == job::Exit::fine) {
      const auto seen = simulated->seen();
      std::printf("(simulated: %.1f mm, %.1f N)\n", 1000 * seen.opening, seen.force);
    }
    return job::code(exit);
  } catch (const adapters::ConnectionError& e) {
    std::fprintf(stderr, "move_gripper: %s\n", e.what());
    return job::code(job::Exit::lost);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "move_gripper: %s\n", e.what());
    return job::code(job::Exit::refused);
  }
}
