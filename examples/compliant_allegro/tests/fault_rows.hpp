// What goes wrong between the job and a hand, and how it must end.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "examples/compliant_allegro/run.hpp"

namespace compliant_allegro::faults {

using examples::job::Exit;
using simulated_allegro::Faults;

inline constexpr double at = 0.25;  ///< when it goes wrong [s]

struct Row {
  const char* name;
  bool udp;
  Faults faults;
  Exit expected;
  double most;              ///< from the fault until the torques are gone [s]; 0: it goes on
  const char* reason = "";  ///< in the job's words
  std::function<bool(const RunLog&)> shows = {};  ///< that the fault was there
  bool or_fine = false;                           ///< chance decides whether it ends
};

inline Faults share(double Faults::* what, double x) {
  Faults f;
  f.from = at;
  f.*what = x;
  return f;
}
inline Faults when(double Faults::* what) {
  Faults f;
  f.*what = at;
  return f;
}
inline Faults late(double seconds) {
  Faults f = when(&Faults::late_at);
  f.late_for = seconds;
  return f;
}

inline bool lost_some(const RunLog& log) {
  return log.incomplete > 0;
}

inline std::vector<Row> rows() {
  const char* gone = "no complete positions from the hand";
  return {
      {"nothing", false, {}, Exit::fine, 0},
      {"1 % of frames lost", false, share(&Faults::lose, 0.01), Exit::fine, 0, "", lost_some},
      {"5 % of frames lost", false, share(&Faults::lose, 0.05), Exit::fine, 0, "", lost_some},
      {"10 % of frames lost", false, share(&Faults::lose, 0.1), Exit::fine, 0, "", lost_some},
      {"20 % of frames lost", false, share(&Faults::lose, 0.2), Exit::fine, 0, "", lost_some},
      {"50 % of frames lost", false, share(&Faults::lose, 0.5), Exit::lost, 1, "", lost_some, true},
      {"80 % of frames lost", false, share(&Faults::lose, 0.8), Exit::lost, 0.4, gone, lost_some},
      {"half of the frames twice", false, share(&Faults::duplicate, 0.5), Exit::fine, 0, "",
       [](const RunLog& l) { return l.duplicates > 20; }},
      {"half of the sets in another order", false, share(&Faults::reorder, 0.5), Exit::fine, 0},
      {"10 % of frames cut", false, share(&Faults::truncate, 0.1), Exit::fine, 0, "", lost_some},
      {"30 ms late", false, late(0.03), Exit::fine, 0, "", [](const RunLog& l) { return l.silent > 2; }},
      {"1 s late", false, late(1), Exit::lost, 0.2, gone},
      {"silent hand", false, when(&Faults::silent_at), Exit::lost, 0.2, gone},
      {"link gone", false, when(&Faults::unplug_at), Exit::lost, -1, "the CAN link"},
      {"servo dropped", false, when(&Faults::servo_off_at), Exit::halted, 0.01, "switched its servo off"},
      {"too hot", false, when(&Faults::hot_at), Exit::halted, 0.4, "too hot"},
      {"UDP: 10 % lost", true, share(&Faults::lose, 0.1), Exit::fine, 0, "", lost_some},
      {"UDP: half of them twice", true, share(&Faults::duplicate, 0.5), Exit::fine, 0, "",
       [](const RunLog& l) { return l.duplicates > 20; }},
      {"UDP: a third in another order", true, share(&Faults::reorder, 0.3), Exit::fine, 0},
      {"UDP: 10 % cut", true, share(&Faults::truncate, 0.1), Exit::fine, 0, "", lost_some},
      {"UDP: a motor error", true, when(&Faults::motor_error_at), Exit::halted, 0.2, "motor"},
      {"UDP: another version", true, when(&Faults::other_version_at), Exit::lost, 0.3, gone},
      {"UDP: silent hand", true, when(&Faults::silent_at), Exit::lost, 0.3, gone},
  };
}

struct Ran {
  Exit exit{};
  RunLog log;
  std::string thrown;
};

inline Ran run_row(const Row& row) {
  Settings s;
  default_task(s);
  s.plant.touches.clear();
  s.quiet = true;
  s.generation = row.udp ? Generation::v5_sense : Generation::v4;
  s.simulate_udp = row.udp;
  s.speed = 1;
  s.duration = 1.2;
  s.faults = row.faults;
  Ran out;
  try {
    out.exit = run(s, false, out.log);
  } catch (const std::exception& e) {
    out.thrown = e.what();
  }
  return out;
}

inline bool has_torque(const RunLog& log) {
  for (const double x : log.last.torque)
    if (x != 0) return true;
  return false;
}
/// From the fault until the torques are gone [s].
inline double rest_of(const RunLog& log) {
  return (log.last.servo_off_time > 0 ? log.last.servo_off_time : log.last.time) - at;
}

}  // namespace compliant_allegro::faults
