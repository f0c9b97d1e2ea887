// SPDX-License-Identifier: BSD-3-Clause
// Unrest: what a cell says of its measurements, and when it has said that it is frozen.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "skinctl/core/contract.hpp"
#include "skinctl/sensing/cell_sample.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Fills in `measured` and `unrest` of the samples that a cell sends: the number of its measurements since
/// its last message, and the mean squared difference of successive raw readings of its pressures [1/256
/// step^2], rounded up: 0 only if none has changed. A sensor whose noise has the standard deviation sigma
/// [steps], rounding included, shows 512 sigma^2.
template <SensorKind Kind = Hexagon>
class Unrest {
  using Table = KindTable<Kind>;
  static constexpr std::size_t sensors = static_cast<std::size_t>(std::popcount(Table::pressed_readings));

 public:
  static constexpr std::uint16_t most = 65534;  ///< largest value of `measured` and `unrest`, below `unsaid`
  /// The memory of one cell; `Memory{}` has measured nothing.
  struct Memory {
    std::array<float, sensors> last{};  ///< raw readings [steps]
    float sum = 0;                      ///< sum of the squared differences [step^2]
    std::uint32_t measured = 0;         ///< measurements since the last message
    std::uint32_t differences = 0;      ///< measurements among `measured` that have a predecessor
    bool any = false;
  };

  /// @param step  step of the readings, as a share of their greatest value. Throws `ConfigurationError`
  ///              unless it is in [1/60000, 0.1].
  explicit Unrest(double step = 1.0 / 1024) : per_step_(static_cast<float>(1 / step)) {
    require(step >= 1.0 / 60000 && step <= 0.1, "Unrest: step", step, "1/60000 to 0.1");
  }

  /// Takes a measurement, sent or not.
  void measure(Memory& m, const SampleOf<Kind>& s) const noexcept {
    const auto& x = detail::readings_of(s);
    std::size_t k = 0;
    for (std::size_t r = 0; r < Table::readings; ++r) {
      if (((Table::pressed_readings >> r) & 1u) == 0) continue;
      const float steps = x[r] * static_cast<float>(1 / Kind::readings[r].max) * per_step_;
      const float change = steps - m.last[k];
      if (m.any) m.sum += change * change;
      m.last[k++] = steps;
    }
    m.differences += m.any ? 1u : 0u, ++m.measured, m.any = true;
  }
  /// Writes `measured` and `unrest` into a sample that is sent, and begins anew.
  void tell(Memory& m, SampleOf<Kind>& s) const noexcept {
    s.measured = static_cast<std::uint16_t>(std::min<std::uint32_t>(m.measured, most));
    const float mean = 256 * m.sum / static_cast<float>(sensors * std::max(m.differences, 1u));
    s.unrest = m.differences == 0 ? unsaid
               : mean < most      ? static_cast<std::uint16_t>(std::ceil(mean))
                                  : most;  // NaN as well
    m.sum = 0, m.measured = m.differences = 0;
  }

 private:
  float per_step_;
};

/// The number of measurements in a row that a cell has said to be without unrest.
struct Stillness {
  static constexpr double min_sigma = double(0.3f);  ///< largest noise of sensors that may stand [steps]
  std::uint16_t measurements = 0;

  /// Whether a sample says its `measured` and `unrest`.
  template <class Sample>
  [[nodiscard]] static constexpr bool said(const Sample& s) noexcept {
    return s.measured != unsaid && s.unrest != unsaid;
  }
  /// Takes the next sample of the cell; one that does not say leaves it as it was.
  template <class Sample>
  constexpr void take(const Sample& s) noexcept {
    if (!said(s)) return;
    const std::uint32_t sum = std::uint32_t(measurements) + s.measured;
    measurements = s.unrest != 0 ? 0 : static_cast<std::uint16_t>(std::min(sum, 65534u));
  }
  friend constexpr bool operator==(const Stillness&, const Stillness&) noexcept = default;
  /// Number of measurements without unrest that shows a frozen cell, by chance 1 in 1e10: a healthy one of
  /// `sensors` pressures, whose noise has the standard deviation `sigma` [steps] before rounding and is three
  /// quarters of that at least, repeats itself so often at most. 65535, never, for a sigma of 0.3 and less:
  /// such a sensor may stand still.
  [[nodiscard]] static std::uint16_t frozen_after(double sigma, std::size_t sensors) {
    if (!(sigma > min_sigma)) return 65535;
    const double same = std::erf(1 / (2 * std::sqrt(2.0) * 0.75 * sigma));
    return static_cast<std::uint16_t>(std::min(std::ceil(23 / -std::log(same) / double(sensors)), 65534.0));
  }
};

SKINCTL_END_NAMESPACE
