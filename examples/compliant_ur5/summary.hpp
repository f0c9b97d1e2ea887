// What a run prints, and its times.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "examples/compliant_ur5/run_log.hpp"
#include "examples/compliant_ur5/settings.hpp"
#include "skinctl/hardware/loop.hpp"

namespace compliant_ur5 {

/// A number in words: `format` is printf's.
std::string text(const char* format, double value);

/// The touches, times and results, unless the run is quiet.
void print(const Settings& settings, const RunLog& log);

template <class C>
void fill_times(const skinctl::LoopReport<C>& report, RunLog& log) {
  const auto add = [&](const char* stage, const skinctl::Histogram& h) {
    const auto us = [&](skinctl::Nanoseconds t) { return 1e3 * skinctl::milliseconds(t); };
    log.times.push_back(
        {stage, us(h.percentile(0.5)), us(h.percentile(0.99)), us(h.percentile(0.999)), us(h.max())});
  };
  for (std::size_t i = 0; i < skinctl::stage_count; ++i)
    add(skinctl::name(static_cast<skinctl::CycleStage>(i)), report.stages[i]);
  add("whole cycle", report.whole);
}

/// The median time of the run's slowest cycle [us] when it is run again and again, with nothing in between.
template <class C>
double repeated_median(const C& cycle, const skinctl::LoopReport<C>& report, unsigned times) {
  const auto memory = std::make_unique<typename C::Memory>();
  std::vector<double> us;
  us.reserve(times);
  for (unsigned k = 0; k < times; ++k) {
    *memory = report.worst->memory;
    skinctl::Stopwatch watch;
    static_cast<void>(cycle.step(*memory, report.worst->input, watch));
    us.push_back(1e3 * skinctl::milliseconds(watch.total()));
  }
  std::nth_element(us.begin(), us.begin() + times / 2, us.end());
  return us[times / 2];
}

}  // namespace compliant_ur5
