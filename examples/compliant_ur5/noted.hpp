// What the cycles of a run reported, from the gravest reaction on.
#pragma once

#include <algorithm>
#include <vector>

#include "examples/compliant_ur5/run_log.hpp"
#include "skinctl/guard/faults.hpp"

namespace compliant_ur5 {

/// A reason that cycles reported.
struct Noted {
  skinctl::Reason reason{};
  skinctl::Reaction reaction{};
  double first = 0;        ///< time of the first cycle [s]
  std::size_t cycles = 0;  ///< number of cycles
};

/// The reasons of the cycles from `log.began` on, the gravest reactions first, then as they came.
[[nodiscard]] inline std::vector<Noted> noted(const RunLog& log) {
  std::vector<Noted> out;
  for (const LogEntry& e : log.entries) {
    if (e.time < log.began) continue;
    skinctl::Status::from_bits(e.status).for_each([&](skinctl::Reason r) {
      const auto same = std::find_if(out.begin(), out.end(), [&](const Noted& n) { return n.reason == r; });
      if (same != out.end()) {
        ++same->cycles;
        return;
      }
      const auto& fault = skinctl::faults[static_cast<std::size_t>(r)];
      out.push_back({r, std::max(fault.motion, fault.torque), e.time, 1});
    });
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Noted& a, const Noted& b) { return a.reaction > b.reaction; });
  return out;
}

/// Whether cycles from `log.began` on reported `reason`.
[[nodiscard]] inline bool has_noted(const RunLog& log, skinctl::Reason reason) {
  const auto all = noted(log);
  return std::any_of(all.begin(), all.end(), [&](const Noted& n) { return n.reason == reason; });
}

/// The number of cycles before `log.began`.
[[nodiscard]] inline std::size_t cycles_of_start(const RunLog& log) {
  return static_cast<std::size_t>(std::count_if(log.entries.begin(), log.entries.end(),
                                                [&](const LogEntry& e) { return e.time < log.began; }));
}

}  // namespace compliant_ur5
