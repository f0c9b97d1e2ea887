// What a run leaves behind: plain data for the printed lines, the JSON summary and the report.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace compliant_ur5 {

/// One cycle, for the plots.
struct LogEntry {
  double time = 0;                      ///< since the first cycle [s]
  double force = 0;                     ///< largest force on a cell's neighbourhood that the skin reports [N]
  double deflection = 0;                ///< farthest joint from where its task wants it [rad]
  std::array<float, 6> q{};             ///< measured [rad]
  std::array<float, 6> target{};        ///< of the task [rad]
  std::array<float, 6> velocity{};      ///< commanded [rad/s]
  std::array<float, 6> acceleration{};  ///< commanded [rad/s^2]
  std::array<std::array<float, 6>, 3> shares{};  ///< torque of each law [N m], see `RunLog::laws`
  std::uint64_t status = 0;                      ///< bits of `skinctl::Status`
};

/// One touch, as seen by skin and joints.
struct TouchSummary {
  double start = 0, end = 0;  ///< [s]
  int link = 0;               ///< 0 to 5
  std::uint32_t cell = 0;     ///< that felt most
  double peak_force = 0;      ///< [N], by the skin
  double deflection = 0;  ///< farthest that the touched point moved away [m]; negative: towards the finger
  double give_way = -1;   ///< from first contact until it had moved 1 mm away [s]; -1: it never did
  double return_error =
      0;  ///< distance of the touched point from its task before the next touch, or at the end [m]
  double true_peak_force = -1;  ///< of the simulated finger [N]; -1: a real one
  /// Where that cell is, in its link's frame [m]; NaN: unknown.
  std::array<double, 3> place{std::nan(""), std::nan(""), std::nan("")};
};

/// Times of one stage of the cycle [us].
struct StageTimes {
  std::string stage;
  double median = 0, p99 = 0, p999 = 0, max = 0;
};

/// A labelled number or word of the report's tables.
struct Fact {
  std::string name, value;
};

/// What a cycle consists of, to compare its time with that of one evaluation.
struct CycleParts {
  double period = 0;      ///< [s]
  unsigned substeps = 0;  ///< of the virtual robot in a cycle that comes as planned; 0: unknown
  unsigned repeated = 0;  ///< how often the slowest cycle was run again after the run, nothing in between
  double repeated_median = 0;  ///< of these [us]
};

inline constexpr std::array<const char*, 6> link_names = {"shoulder", "upper arm", "forearm",
                                                          "wrist 1",  "wrist 2",   "wrist 3"};

/// A place of the skin, and how well it felt at the end.
struct FeltPlace {
  std::uint32_t cell = 0;
  std::size_t link = 0;
  std::array<double, 3> place{}, normal{};  ///< along the link's axes [m]
  double noticed = 0;                       ///< least force on its middle that is noticed [N]; infinite: none
  double speed = 0;                         ///< with which it may lead [m/s]
};

struct RunLog {
  std::string title;                  ///< what ran: robot, interface, rate
  std::string ending, words;          ///< why it ended: name of its row in endings.hpp, and in words
  std::array<std::string, 3> laws{};  ///< names of the shares
  std::vector<Fact> scenario;         ///< stiffness, speed, travel, delay ...
  std::vector<Fact> result;           ///< cycles, missed deadlines, allocations, limits ...
  std::vector<LogEntry> entries;
  double began = 0;  ///< end of the start: first reading of the sensor [s]
  std::vector<TouchSummary> touches;
  std::vector<FeltPlace> felt;
  std::vector<StageTimes> times;
  CycleParts cycle;
  std::array<double, 6> velocity_limit{}, acceleration_limit{};
  double peak_force = 0;         ///< over all touches [N]
  double rigid_peak_force = -1;  ///< the same scenario without giving way [N]; -1: not run
};

}  // namespace compliant_ur5
