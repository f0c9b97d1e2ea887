// Faults between the main job and a UR5: by position, velocity and torque, in real time.
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <thread>
#include <utility>

#include "examples/compliant_ur5/tests/disturbed.hpp"
#include "examples/fault_table/row.hpp"

namespace fault_table {
namespace {

using compliant_ur5::Disturbed;
using simulated_ur5::FaultyWire;
using skinctl::Interface;
namespace change = simulated_ur5::change;
using Cable = FaultyWire::Cable;
using Act = std::function<void(Disturbed&)>;

struct Fault {
  std::string name;
  Act begin;
  int exit;
  double rest;  ///< at most [ms]; 0: the job goes on to its end
  Act mend{};
  bool by_hand = false;  ///< only a person at the panel can put it right
  bool dead = false;     ///< the simulation has ended, and nobody sees how the arm comes to rest
  double share = 1;      ///< of the usual number of cycles
  /// By torque the robot waits 40 ms for a command: a busy computer that gets half of the states may be too
  /// late once.
  bool may_be_late = false;
};

Row suffer(const Fault& f, Interface by) {
  Disturbed run(by, f.begin, f.share);
  constexpr const char* names[] = {"UR5 by position", "UR5 by velocity", "UR5 by torque"};
  Row row{.device = names[static_cast<int>(by)], .fault = f.name, .reaction = run.words};
  row.exit = run.exit;
  if (run.exit != 0) row.rest_ms = run.rest;
  if (run.exit == 0) {
    row.recovery = "-";
  } else if (f.by_hand) {
    row.recovery = "at the panel";
  } else {
    row.recovery = run.starts_again(f.mend) ? "start again" : "none";
  }
  row.expected = (run.exit == f.exit || (f.may_be_late && by == Interface::torque && run.exit == 5)) &&
                 (run.rest >= 0 || f.dead) && (f.rest <= 0 || run.rest <= f.rest) && row.recovery != "none";
  row.otherwise = text("exit %d, rest within %.0f ms, and start again", f.exit, f.rest);
  return row;
}
void slider(Disturbed& r, double share) {
  r.beside.robot->call([share](auto& c) {
    c.inputs().speed_slider_mask = 1;
    c.inputs().speed_slider_fraction = share;
    c.inputs_written({.slider = true});
  });
}
std::vector<Fault> faults() {
  const auto rtde = [](auto what) { return [what](Disturbed& r) { r.rtde.set(what); }; };
  std::vector<Fault> out{
      {"cable cut",
       [](Disturbed& r) {
         r.rtde.set(Cable::cut);
         r.reverse.set(Cable::cut);
       },
       1, 1200},
      {"half open: its states are lost", rtde(Cable::to_robot), 1, 1200},
      {"half open: commands are lost", [](Disturbed& r) { r.reverse.set(Cable::to_robot); }, 5, 1000},
      {"connection reset", rtde(Cable::reset), 1, 1000},
      {"controller killed and restarted", [](Disturbed& r) { r.beside.robot->stop(); }, 1, 1000,
       [](Disturbed& r) { r.restart_controller(); }, false, true},
      {"protective stop",
       [](Disturbed& r) { r.beside.robot->call([](auto& c) { c.protective_stop("a test"); }); }, 5, 500,
       [](Disturbed& r) {
         std::this_thread::sleep_for(std::chrono::milliseconds(5200));  // sooner it is not released
         r.s.unlock = true;
       }},
      {"emergency stop",
       [](Disturbed& r) { r.beside.robot->call([](auto& c) { c.emergency_stop(); }); },
       5,
       500,
       {},
       true},
      {"paused at the panel", [](Disturbed& r) { r.beside.robot->call([](auto& c) { c.pause(); }); }, 5,
       1000},
      {"speed slider to 0", [](Disturbed& r) { slider(r, 0); }, 5, 1100, [](Disturbed& r) { slider(r, 1); }},
      {"bursts of four states",
       [](Disturbed& r) {
         r.rtde.set([held = std::vector<simulated_ur5::Bytes>{}](simulated_ur5::Bytes b,
                                                                 const simulated_ur5::RtdeLayout&) mutable {
           held.push_back(std::move(b));
           return held.size() == 4 ? std::exchange(held, {}) : std::vector<simulated_ur5::Bytes>{};
         });
       },
       0,
       0,
       {},
       false,
       false,
       0.5},
      {"byte by byte", [](Disturbed& r) { r.rtde.set_pieces(1, 0); }, 0, 0},
      {"every state twice", rtde(change::repeated()), 0, 0},
      {"states out of order", rtde(change::reordered()), 0, 0},
      {"states cut short", rtde(change::truncated(9)), 1, 1200},
      {"garbled states", rtde(change::garbled()), 1, 1200},
      {"its clock goes back 5 s", rtde(change::clock_back(5)), 7, 1200},
      {"its clock stands", rtde(change::frozen_clock()), 7, 1200},
  };
  for (const double share : {0.01, 0.05, 0.2, 0.5})
    out.push_back({text("%.0f %% of the states lost", 100 * share), rtde(change::lost(share)), 0, 0});
  out.back().may_be_late = true;
  return out;
}

/// A controller that does not speak version 2 of RTDE.
Row other_version() {
  namespace ip = boost::asio::ip;
  Row row{.device = "UR5", .fault = "another version of the protocol"};
  boost::asio::io_context io;
  ip::tcp::acceptor acceptor(io, {ip::address_v4::loopback(), 0});
  std::thread controller([&] {
    boost::system::error_code error;
    ip::tcp::socket socket(io);
    acceptor.accept(socket, error);
    std::array<std::uint8_t, 64> asked{};
    socket.read_some(boost::asio::buffer(asked), error);
    const std::array<std::uint8_t, 4> refused{0, 4, 86, 0};
    socket.write_some(boost::asio::buffer(refused), error);
    socket.read_some(boost::asio::buffer(asked), error);  // until it hangs up
  });
  auto s = compliant_ur5::settings();
  s.robot = "127.0.0.1";
  s.rtde_port = acceptor.local_endpoint().port();
  compliant_ur5::RunLog log;
  try {
    row.exit = static_cast<int>(run(s, false, log));
  } catch (const std::exception& e) {
    row.exit = 1;
    row.reaction = e.what();
  }
  controller.join();
  row.rest_ms = 0;
  row.recovery = "another controller";
  row.expected = row.exit == 1 && row.reaction.find("version") != std::string::npos;
  row.otherwise = "exit 1, refused before anything moves, with words";
  return row;
}

}  // namespace

Cases ur_cases() {
  Cases out;
  out.push_back({"UR5", other_version});
  for (const Fault& f : faults())
    for (const Interface by : {Interface::position, Interface::velocity, Interface::torque})
      out.push_back({"UR5", [f, by] { return suffer(f, by); }});
  return out;
}

}  // namespace fault_table
