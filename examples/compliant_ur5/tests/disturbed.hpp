// A run of the main job that is disturbed while the arm moves: when the arm rests, how the job ends, and
// whether it can be started again.
#pragma once

#include <functional>

#include "examples/compliant_ur5/tests/beside.hpp"
#include "examples/simulated_ur5/faults.hpp"

namespace compliant_ur5 {

inline double fastest(const simulated_ur5::Snapshot& now) {
  double speed = 0;
  for (const double v : now.true_dq) speed = std::max(speed, std::abs(v));
  return speed;
}
inline Settings settings_by(skinctl::Interface interface) {
  Settings s = settings();
  s.interface = interface;
  if (interface == skinctl::Interface::torque) s.rate = 500;
  return s;
}

struct Disturbed {
  Settings s;
  std::unique_ptr<Beside> beside_;
  Beside& beside;
  simulated_ur5::FaultyWire rtde{s.rtde_port, true};
  simulated_ur5::FaultyWire reverse{s.reverse_port = free_tcp_port(), false};  // here the robot is the client
  RunLog log;
  bool begun =
      false;  ///< whether the arm moved before it was disturbed: a busy machine starves the simulated skin
  int exit = -1;
  double rest = -1;  ///< from the disturbance until the arm stands [ms]; -1: it did not
  double took = 0;   ///< from the disturbance until the job has ended [ms]
  double went = 0;   ///< farthest joint, from the disturbance until rest [rad]
  std::string words;

  /// @param share  of the usual number of cycles: where few states come, cycles take longer.
  Disturbed(skinctl::Interface interface, const std::function<void(Disturbed&)>& disturb, double share = 1)
      : s(settings_by(interface)), beside_(std::make_unique<Beside>(s)), beside(*beside_) {
    using Clock = std::chrono::steady_clock;
    const auto ms = [](Clock::duration t) { return std::chrono::duration<double, std::milli>(t).count(); };
    s.rtde_port = rtde.port();
    s.told_port = reverse.port();
    s.cycles = static_cast<std::uint64_t>(2.64 * share * s.rate);
    s.task = {{.at = 0.1, .q = {0.7, -1.0, 1.2, -1.7, -1.57, 0.3}, .duration = 2}};
    std::atomic<bool> stop = false, over = false;
    std::thread job([&] {
      try {
        exit = static_cast<int>(run(s, stop, log));
      } catch (const std::exception& e) {
        exit = 1;
        words = e.what();
      }
      over = true;
    });
    const auto started = Clock::now();
    while (fastest(beside.robot->snapshot()) < 0.2 && !over &&
           Clock::now() - started < std::chrono::seconds(6))
      std::this_thread::sleep_for(std::chrono::milliseconds(4));
    begun = !over;
    const auto from = Clock::now();
    const auto where = beside.robot->snapshot().true_q;
    disturb(*this);
    auto stood_since = Clock::now();
    bool stands = false;
    while (Clock::now() - from < std::chrono::milliseconds(5500)) {
      const auto now = beside.robot->snapshot();
      if (fastest(now) > 1e-6) {
        stands = false;
      } else if (!stands) {
        stands = true;
        stood_since = Clock::now();
      }
      if (!stands || rest < 0)
        for (std::size_t i = 0; i < 6; ++i) went = std::max(went, std::abs(now.true_q[i] - where[i]));
      rest = stands ? ms(stood_since - from) : -1;
      if (over && took == 0) took = ms(Clock::now() - from);
      if (over && stands && Clock::now() - stood_since > std::chrono::milliseconds(150)) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(4));
    }
    stop = true;
    job.join();
    if (words.empty()) words = log.words;
  }

  /// Once the cables are whole and `mend` has put the robot right: whether the job starts again and ends
  /// well.
  bool starts_again(const std::function<void(Disturbed&)>& mend = {}) {
    using Cable = simulated_ur5::FaultyWire::Cable;
    for (auto* wire : {&rtde, &reverse}) {
      wire->set(Cable::whole);
      wire->set(simulated_ur5::Change{});
      wire->set_pieces(0, 0);
    }
    if (mend) mend(*this);
    s.cycles = static_cast<std::uint64_t>(0.5 * s.rate);
    s.task.clear();
    RunLog again;
    try {
      return run(s, false, again) == Outcome::fine;
    } catch (const std::exception&) {
      return false;
    }
  }
  /// Another controller in place of the one that was stopped.
  void restart_controller() {
    Settings fresh = s;
    beside_ = std::make_unique<Beside>(fresh);
    rtde.set_target(fresh.rtde_port);
    fresh.rtde_port = rtde.port();
    s = fresh;
  }
};

}  // namespace compliant_ur5
