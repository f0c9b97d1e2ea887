// Faults between a program and a gripper: the simulated ones misbehave, and a wire is cut.
#include <chrono>
#include <memory>
#include <thread>

#include "examples/adapters/gripper/lacquey.hpp"
#include "examples/adapters/gripper/onrobot.hpp"
#include "examples/adapters/gripper/robotiq.hpp"
#include "examples/fault_table/row.hpp"
#include "examples/simulated_gripper/server.hpp"
#include "examples/simulated_ur5/faults.hpp"
#include "examples/support/job.hpp"

namespace fault_table {
namespace {

using namespace std::chrono_literals;
using namespace adapters::gripper;
using examples::job::Exit;
using simulated_gripper::Kind;
using simulated_gripper::Server;
using simulated_ur5::FaultyWire;
using skinctl::GripperError;
using skinctl::GripperState;
using Clock = std::chrono::steady_clock;

constexpr double fast = 10;  ///< times real time: a motion takes 60 ms

double ms_since(Clock::time_point t) {
  return std::chrono::duration<double, std::milli>(Clock::now() - t).count();
}
template <class G, class Done>
GripperState poll(G& gripper, Done&& done, std::chrono::milliseconds most) {
  const auto start = Clock::now();
  for (;;) {
    const auto now = Clock::now();
    const GripperState state = gripper.poll(now.time_since_epoch());
    if (done(state) || now - start > most) return state;
    std::this_thread::sleep_for(2ms);
  }
}
const char* in_words(GripperError e) {
  return e == GripperError::none ? "none" : skinctl::describe(e);
}
/// As `move_gripper` ends.
Exit exit_of(const GripperState& s) {
  if (s.error == GripperError::none || s.error == GripperError::silent)
    return s.moving ? Exit::not_following : Exit::fine;
  return s.error == GripperError::lost ? Exit::lost : Exit::halted;
}

/// A simulated gripper behind a wire.
struct Bench {
  explicit Bench(Kind kind)
      : config{.kind = kind, .speed = fast, .active = true},
        server(std::make_unique<Server>(config)),
        wire(server->port(), false) {}
  simulated_gripper::ServerConfig config;
  std::unique_ptr<Server> server;
  FaultyWire wire;
};

template <class G>
G made(std::uint16_t port) {
  if constexpr (std::is_same_v<G, Robotiq>) {
    RobotiqConfig c;
    c.port = port;
    return Robotiq(c);
  } else {
    OnRobotConfig c;
    c.port = port;
    c.begins_within = 40ms;
    return OnRobot(c);
  }
}

struct Fault {
  std::string name;
  std::function<void(Bench&)> begin, end;
  Exit exit;
  const char* back = "";  ///< how it must come back; empty: it was never away
};

/// The gripper is told to close on nothing while the fault begins, and the fault ends 2.6 s later: is it
/// noticed, and does it come back?
template <class G>
Row suffer(Kind kind, const char* device, const Fault& fault) {
  Bench bench(kind);
  G gripper = made<G>(bench.wire.port());
  gripper.connect();
  const auto range = gripper.range();
  const auto at_rest = [](const GripperState& s) {
    return s.heard && !s.moving && s.error == GripperError::none;
  };
  gripper.move(open_goal(range));
  poll(gripper, at_rest, 3000ms);
  fault.begin(bench);
  const auto from = Clock::now();
  gripper.move(close_goal(range, range.min_force));
  const GripperState s = poll(
      gripper,
      [&](const GripperState& x) {
        return at_rest(x) || (x.error != GripperError::none && x.error != GripperError::silent);
      },
      8000ms);
  Row row{.device = device, .fault = fault.name};
  const double took = ms_since(from);
  const Exit exit = exit_of(s);
  row.exit = examples::job::code(exit);
  if (exit == Exit::fine) {
    row.reaction = text("closes, in %.0f ms", took);
    row.expected = s.opening < 0.02 * range.opening;
  } else {
    row.reaction = in_words(s.error);
    row.rest_ms = took;
    row.expected = gripper.move({}) == (exit != Exit::lost);
  }
  row.expected = row.expected && exit == fault.exit;
  row.otherwise = text("exit %d, %s", examples::job::code(fault.exit), fault.back);
  fault.end(bench);
  if (exit == Exit::fine) {
    row.recovery = "-";
    return row;
  }
  // By itself?
  const GripperState again =
      exit == Exit::lost
          ? s
          : poll(gripper, [](const GripperState& x) { return x.error == GripperError::none; }, 1500ms);
  if (again.error == GripperError::none) {
    row.recovery = "by itself";
  } else {
    try {
      gripper.connect();
      gripper.move(close_goal(range, range.min_force));
      row.recovery = at_rest(poll(gripper, at_rest, 3000ms)) ? "connect()" : "none";
    } catch (const adapters::ConnectionError&) {
      row.recovery = "none";
    }
  }
  row.expected = row.expected && row.recovery == fault.back;
  return row;
}

std::vector<Fault> faults() {
  using Cable = FaultyWire::Cable;
  const auto wire = [](Cable c) { return [c](Bench& b) { b.wire.set(c); }; };
  const auto set = [](auto member, auto value) {
    return [=](Bench& b) { b.server->misbehave().*member = value; };
  };
  using M = simulated_gripper::Misbehaviour;
  const auto whole = wire(Cable::whole);
  const auto flag = [&](const char* name, std::atomic<bool> M::* m, Exit exit, const char* back) {
    return Fault{name, set(m, true), set(m, false), exit, back};
  };
  std::vector<Fault> out{
      {"cable cut", wire(Cable::cut), whole, Exit::lost, "connect()"},
      {"half open: its answers are lost", wire(Cable::to_robot), whole, Exit::lost, "connect()"},
      {"half open: it does not hear", wire(Cable::from_robot), whole, Exit::lost, "connect()"},
      {"connection reset", wire(Cable::reset), whole, Exit::lost, "connect()"},
      flag("killed peer", &M::hang_up, Exit::lost, "connect()"),
      {"controller restarted",
       [](Bench& b) {
         b.server.reset();
         b.server = std::make_unique<Server>(b.config);
         b.wire.set_target(b.server->port());
       },
       [](Bench&) {}, Exit::lost, "connect()"},
      {"byte by byte", [](Bench& b) { b.wire.set_pieces(1, 0); }, [](Bench& b) { b.wire.set_pieces(0, 0); },
       Exit::fine},
      {"bursts: every answer 60 ms late", set(&M::late_ms, 60), set(&M::late_ms, 0), Exit::fine},
      flag("every answer twice", &M::twice, Exit::fine, ""),
      flag("answers cut short", &M::cut_short, Exit::lost, "connect()"),
      flag("garbled answers", &M::garbage, Exit::lost, "connect()"),
      flag("another version of the protocol", &M::other_version, Exit::lost, "connect()"),
      {"a fault of its own, cleared later", [](Bench& b) { b.server->fault(4); },
       [](Bench& b) { b.server->fault(0); }, Exit::halted, "by itself"},
  };
  for (const double share : {0.01, 0.05, 0.2, 0.5})
    out.push_back({text("%.0f %% of requests lost", 100 * share), set(&M::lose, share), set(&M::lose, 0.0),
                   Exit::fine});
  return out;
}

/// A Lacquey says nothing back: what can be known is whether its program on the robot is there.
Row lacquey(const char* name, bool killed) {
  Row row{.device = "Lacquey (TUM)", .fault = name};
  LacqueyServer line("127.0.0.1", 0);
  const auto config = [&] {
    return simulated_gripper::ServerConfig{.kind = Kind::lacquey, .port = line.port(), .speed = fast};
  };
  auto robot = std::make_unique<Server>(config());
  line.accept(adapters::Timeout(2000));
  BinaryGripper gripper(line, {.travel = 100ms});
  gripper.move(close_goal(gripper.range(), 20));
  poll(gripper, [](const GripperState& s) { return s.heard && !s.moving; }, 1000ms);
  if (killed) robot.reset();
  const auto from = Clock::now();
  const GripperState s =
      poll(gripper, [](const GripperState& x) { return x.error != GripperError::none; }, 1000ms);
  row.exit = examples::job::code(exit_of(s));
  row.rest_ms = ms_since(from);
  row.reaction = in_words(s.error);
  robot = std::make_unique<Server>(config());
  line.accept(adapters::Timeout(2000));
  gripper.move(open_goal(gripper.range()));
  const auto back = poll(gripper, [](const GripperState& x) { return x.heard && !x.moving; }, 1000ms);
  row.recovery = back.error == GripperError::none ? "accept()" : "none";
  row.expected = s.error == GripperError::lost && back.error == GripperError::none;
  return row;
}

}  // namespace

Cases gripper_cases() {
  Cases out;
  for (const Fault& f : faults())
    out.push_back({"Robotiq", [f] { return suffer<Robotiq>(Kind::robotiq, "Robotiq", f); }});
  for (const Fault& f : faults())
    out.push_back({"OnRobot", [f] { return suffer<OnRobot>(Kind::onrobot, "OnRobot", f); }});
  out.push_back({"Lacquey", [] { return lacquey("killed peer, and a new one", true); }});
  return out;
}

}  // namespace fault_table
