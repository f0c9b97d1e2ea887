// SPDX-License-Identifier: BSD-3-Clause
// What the cells of a skin send while it is touched, with the noise of their sensors.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/tactile/cell_graph.hpp"
#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// Normally distributed numbers, the same on every machine, with all of their tails.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : random_(seeded(seed)) {}
  double operator()() {
    if (has_other_) return has_other_ = false, other_;
    const double size = std::sqrt(-2 * std::log(uniform<double>(random_, 1e-300, 1.0)));
    const double angle = uniform<double>(random_, 0.0, 6.283185307179586);
    has_other_ = true, other_ = size * std::sin(angle);
    return size * std::cos(angle);
  }
  /// A uniform random number from `low` to `high`.
  double between(double low, double high) { return uniform<double>(random_, low, high); }
  Random& bits() { return random_; }

 private:
  Random random_;
  double other_ = 0;
  bool has_other_ = false;
};

/// A round body that touches a link for a while: Hertz's pressure `sqrt(1 - (d/radius)^2)` about its centre.
struct SkinTouch {
  std::size_t link = 0;
  /// Position and velocity of the centre at `from`, along the link's axes [m], [m/s].
  Xyz<double> place{0.0, 0.0, 0.0}, velocity{0.0, 0.0, 0.0};
  double radius = 0.03;          ///< radius of the pressed circle [m]
  double reading = 0.3;          ///< reading of each force sensor at the centre, 0 to 1
  Nanoseconds from{0}, until{};  ///< beginning and end of the touch
  Nanoseconds rise = 80ms;       ///< duration of the rise, and of the fall
  double tremor = 0.05;          ///< share of the force that trembles at about 8 Hz
  double pulse = 50;             ///< angular frequency of the tremor [rad/s]
  bool seen = true;              ///< infrared light sees it, from 0.3 s before it touches until 0.3 s after
};

struct SkinSignalSettings {
  Nanoseconds period = 4ms;          ///< period of the samples of a cell; cells differ in phase
  double step = 1.0 / 1024;          ///< step of the readings (LSB)
  double noise = 0.7;                ///< standard deviation of each force sensor and of the proximity [steps]
  double rest = 0.02;                ///< rest level of a force sensor, 0 to 1
  double acceleration_noise = 0.05;  ///< standard deviation of an acceleration [m/s^2]
  double acceleration_step = 0.01;
};

/// The samples of all cells of a skin, with ids from 1 on in the order of `cells`.
class SkinSignals {
 public:
  explicit SkinSignals(std::vector<CellPlace> cells, const SkinSignalSettings& settings = {},
                       std::uint64_t seed = 1)
      : cells_(std::move(cells)), s_(settings), normal_(seed) {
    for (std::size_t i = 0; i < cells_.size(); ++i)
      next_.push_back(Nanoseconds(
          static_cast<std::int64_t>(normal_.between(0.0, 1.0) * static_cast<double>(s_.period.count()))));
  }
  std::vector<SkinTouch> touches;

  [[nodiscard]] const SkinSignalSettings& settings() const noexcept { return s_; }
  [[nodiscard]] std::span<const CellPlace> cells() const noexcept { return cells_; }

  /// The mean reading, 0 to 1, of a force sensor of cell `i` above its rest level at `t`, without noise.
  [[nodiscard]] double force(std::size_t i, Nanoseconds t) const {
    double sum = 0;
    for (const SkinTouch& touch : touches) {
      if (touch.link != cells_[i].link || t < touch.from || t > touch.until) continue;
      const double part = 1 - far(touch, i, t, touch.radius);
      if (part <= 0) continue;
      const double since = seconds<double>(t - touch.from), left = seconds<double>(touch.until - t);
      const double on = ramp(std::min(since, left) / seconds<double>(touch.rise));
      sum += touch.reading * on * std::sqrt(part) *
             (1 + touch.tremor * std::sin(touch.pulse * since) * std::sin(7 * since + 1));
    }
    return std::min(sum, 1 - s_.rest);
  }
  /// The proximity reading of cell `i` at `t`, 0 to 1, without noise.
  [[nodiscard]] double proximity(std::size_t i, Nanoseconds t) const {
    double most = 0.01;
    for (const SkinTouch& touch : touches) {
      if (!touch.seen || touch.link != cells_[i].link) continue;
      const Nanoseconds outside = t < touch.from ? touch.from - t : t > touch.until ? t - touch.until : 0ns;
      if (outside > 300ms) continue;
      const double gap = seconds<double>(outside) / 0.3;
      most = std::max(most, (1 - gap) * (1 - gap) * std::exp(-far(touch, i, t, touch.radius + 0.03)));
    }
    return std::min(most, 1.0);
  }
  /// Sets `out` to all samples stamped since the last call and until `to`, in the order of their stamps.
  void samples(Nanoseconds to, std::vector<CellSample>& out) {
    out.clear();
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      for (; next_[i] <= to; next_[i] += s_.period) {
        CellSample s;
        s.cell = static_cast<std::uint32_t>(i + 1);
        s.time = next_[i];
        const double f = touches.empty() ? 0 : force(i, s.time),
                     p = touches.empty() ? 0.01 : proximity(i, s.time);
        for (float& x : s.force) x = reading(s_.rest + f);
        s.proximity = reading(p);
        const double g[3] = {0.3, -0.4, 9.8};
        for (std::size_t a = 0; a < 3; ++a)
          s.acceleration[a] = static_cast<float>(
              s_.acceleration_step *
              std::round((g[a] + s_.acceleration_noise * normal_()) / s_.acceleration_step));
        s.temperature = 27.5f;
        out.push_back(s);
      }
    }
    std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  }

 private:
  /// The squared distance from the centre, in units of `radius`.
  [[nodiscard]] double far(const SkinTouch& touch, std::size_t i, Nanoseconds t, double radius) const {
    const Nanoseconds moving = std::clamp(t, touch.from, touch.until) - touch.from;
    const Xyz<double> way = cells_[i].place - touch.place - seconds<double>(moving) * touch.velocity;
    return dot(way, way) / (radius * radius);
  }
  [[nodiscard]] static double ramp(double u) {
    const double x = std::clamp(u, 0.0, 1.0);
    return x * x * (3 - 2 * x);
  }
  [[nodiscard]] float reading(double x) {
    const double steps = std::round(x / s_.step + s_.noise * normal_());
    return static_cast<float>(std::clamp(steps * s_.step, 0.0, 1.0));
  }

  std::vector<CellPlace> cells_;
  SkinSignalSettings s_;
  std::vector<Nanoseconds> next_;
  Normal normal_;
};

}  // namespace skinctl::testing
