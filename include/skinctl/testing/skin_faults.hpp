// SPDX-License-Identifier: BSD-3-Clause
// Faulty cells: the faults of a skin, injected into any stream of samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "skinctl/sensing/cell_fault.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// One fault of one cell, from `from` until `until` by the stamps of its samples.
struct FaultyCell {
  std::uint32_t cell = 0;  ///< id of the cell
  CellFault fault = CellFault::stuck;
  Nanoseconds from{0}, until = Nanoseconds::max();
  /// | fault      | level                                                                       | default |
  /// |------------|-----------------------------------------------------------------------------|---------|
  /// | stuck      | the three force readings; negative: those of its last sample before `from`  | 0.9     |
  /// | saturated  | lowest force reading; it varies between this and 1                          | 0.985   |
  /// | blinking   | force readings while it is away from what it feels                          | 0.9     |
  /// | noisy      | standard deviation that is added to each force reading                      | 0.05    |
  /// | cross-talk | share of the force readings of `source` that is added to each of its own    | 0.5     |
  /// | discharge  | what is added to each force reading at `from`; it decays over `period`      | 0.02    |
  /// | unheard    | share of the samples that are lost; the others come `period` late           | 1       |
  /// | quiet      | mean of the force readings, each with the noise of a sound sensor, 0.7 steps | 0.9     |
  double level = -2;
  std::uint32_t source = 0;  ///< id of the cell that cross-talk copies
  /// Mean time between two jumps of a blinking cell (default 80 ms), time constant of a discharge (30 s),
  /// delay of a late sample (400 ms). 0: that default.
  Nanoseconds period{0};
  /// All that the cell sends is faulty, not its forces alone: a stuck cell repeats all eight numbers, a
  /// noisy, blinking or saturated one does to its proximity what it does to its forces.
  bool whole = false;

  /// The level, or its default.
  [[nodiscard]] double size() const noexcept {
    constexpr std::array<double, cell_faults> usual = {0.9, 0.985, 0.9, 0.05, 0.5, 0.02, 1.0, 0.9};
    return level > -2 ? level : usual[static_cast<std::size_t>(fault)];
  }
  [[nodiscard]] Nanoseconds time() const noexcept {
    if (period > 0ns) return period;
    return fault == CellFault::blinking ? 80ms : fault == CellFault::discharge ? Nanoseconds(30s) : 400ms;
  }
};

/// Injects faults into a stream of samples, cycle by cycle. Readings stay multiples of the sensor's step and
/// within 0 to 1: the faults that `check` cannot see.
class SkinFaults {
 public:
  /// @param step  step of the sensors' readings (LSB); force readings are multiples of it in [0, 1].
  explicit SkinFaults(std::vector<FaultyCell> faults, std::uint64_t seed = 1, double step = 1.0 / 1024)
      : faults_(std::move(faults)), state_(faults_.size()), random_(seeded(seed)), step_(step) {
    for (std::size_t k = 0; k < faults_.size(); ++k) {
      of_cell_[faults_[k].cell].push_back(k);
      if (faults_[k].fault == CellFault::cross_talk) sources_[faults_[k].source] = {};
    }
  }

  /// Faults like `like` for a `share`, 0 to 1, of the cells `ids`, drawn at random. Cross-talk copies a cell
  /// at random.
  [[nodiscard]] static std::vector<FaultyCell> of_share(double share, std::vector<std::uint32_t> ids,
                                                        const FaultyCell& like, std::uint64_t seed = 1) {
    Random random = seeded(seed);
    const std::vector<std::uint32_t> all = ids;
    std::vector<FaultyCell> out;
    const auto wanted = static_cast<std::size_t>(std::lround(share * static_cast<double>(ids.size())));
    for (std::size_t k = 0; k < wanted; ++k) {
      std::swap(ids[k], ids[k + random() % (ids.size() - k)]);
      FaultyCell one = like;
      one.cell = ids[k];
      do one.source = all[random() % all.size()];
      while (all.size() > 1 && one.source == one.cell);
      out.push_back(one);
    }
    return out;
  }

  [[nodiscard]] const std::vector<FaultyCell>& faults() const noexcept { return faults_; }
  /// Whether the cell `id` has a fault at `time`.
  [[nodiscard]] bool faulty(std::uint32_t id, Nanoseconds time) const {
    const auto found = of_cell_.find(id);
    return found != of_cell_.end() &&
           std::any_of(found->second.begin(), found->second.end(),
                       [&](std::size_t k) { return faults_[k].from <= time && time < faults_[k].until; });
  }

  /// Replaces `samples`, those of one cycle in the order of their stamps, by the samples that arrive until
  /// `now`.
  void apply(std::vector<CellSample>& samples, Nanoseconds now) {
    arrived_.clear();
    for (const CellSample& sample : samples) {
      if (const auto source = sources_.find(sample.cell); source != sources_.end()) source->second = sample;
      CellSample s = sample;
      const auto found = of_cell_.find(s.cell);
      bool comes = true;
      if (found != of_cell_.end())
        for (const std::size_t k : found->second) comes = spoil(k, s) && comes;
      if (comes) arrived_.push_back(s);
    }
    const auto due =
        std::stable_partition(late_.begin(), late_.end(), [&](const Late& l) { return l.at > now; });
    for (auto l = due; l != late_.end(); ++l) arrived_.push_back(l->sample);
    late_.erase(due, late_.end());
    samples = arrived_;
  }

 private:
  struct State {
    CellSample last{};  ///< the last one before the fault
    bool begun = false, away = false;
    Nanoseconds next{};
  };
  struct Late {
    Nanoseconds at;
    CellSample sample;
  };

  [[nodiscard]] float whole(double x) const {
    const double n = std::round(std::clamp(x, 0.0, 1.0) / step_) * step_;
    return static_cast<float>(std::min(n, 1.0));
  }
  [[nodiscard]] double gauss() {
    double sum = 0;
    for (int i = 0; i < 12; ++i) sum += uniform<double>(random_, 0.0, 1.0);
    return sum - 6;
  }

  /// Makes the sample that of the faulty cell; false if it does not come now.
  bool spoil(std::size_t k, CellSample& s) {
    const FaultyCell& f = faults_[k];
    State& state = state_[k];
    if (s.time < f.from || s.time >= f.until) {
      if (!state.begun) state.last = s;
      return true;
    }
    const bool first = !state.begun;
    state.begun = true;
    const double level = f.size();
    const auto each = [&](auto&& f_of_x) {
      for (float& x : s.force) x = whole(f_of_x(double(x)));
      if (f.whole) s.proximity = whole(f_of_x(double(s.proximity)));
    };
    switch (f.fault) {
      case CellFault::stuck:
        if (f.whole) {
          const Nanoseconds time = s.time;
          if (first && state.last.cell != f.cell) state.last = s;
          if (first && level >= 0) state.last.force.fill(whole(level));
          s = state.last, s.time = time;
        } else if (level >= 0) {
          each([&](double) { return level; });
        } else {
          if (first && state.last.cell != f.cell) state.last = s;
          s.force = state.last.force;
        }
        break;
      case CellFault::saturated:
        each([&](double) { return uniform<double>(random_, level, 1.0); });
        break;
      case CellFault::blinking:
        if (first) state.next = s.time;
        while (s.time >= state.next) {
          state.away = !state.away;
          const double pause = -std::log(uniform<double>(random_, 1e-6, 1.0)) * seconds<double>(f.time());
          state.next += nanoseconds(std::max(pause, 1e-3));
        }
        if (state.away) each([&](double) { return level; });
        break;
      case CellFault::noisy:
        each([&](double x) { return x + level * gauss(); });
        break;
      case CellFault::cross_talk: {
        const CellSample& source = sources_.find(f.source)->second;
        for (std::size_t c = 0; c < 3; ++c)
          s.force[c] = whole(double(s.force[c]) + level * double(source.force[c]));
        break;
      }
      case CellFault::discharge: {
        const double left = level * std::exp(-seconds<double>(s.time - f.from) / seconds<double>(f.time()));
        each([&](double x) { return x + left; });
        break;
      }
      case CellFault::quiet:
        each([&](double) { return level + 0.7 * step_ * gauss(); });
        break;
      case CellFault::unheard:
        if (uniform<double>(random_, 0.0, 1.0) >= level) late_.push_back({s.time + f.time(), s});
        return false;
    }
    return true;
  }

  std::vector<FaultyCell> faults_;
  std::vector<State> state_;
  std::map<std::uint32_t, std::vector<std::size_t>> of_cell_;
  std::map<std::uint32_t, CellSample> sources_;
  std::vector<Late> late_;
  std::vector<CellSample> arrived_;
  Random random_;
  double step_;
};

}  // namespace skinctl::testing
