// SPDX-License-Identifier: BSD-3-Clause
// A watch over a sensor of few numbers: whether its push has life, and what it reads at rest.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "skinctl/core/status.hpp"
#include "skinctl/sensing/detail/cell_life.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Tells a hand from a bias, by the rule of `LifeSettings`, for a sensor that feels one push as few numbers
/// (a wrench, joint torques) and has no neighbours. The push lives if `detail::CellLife` finds life in one of
/// its sizes (magnitudes, such as |force|), in means of 8 ms over windows of 8 to 96 ms, or, for a slow hand,
/// in the change over 0.48 s of means of 80 ms, over windows of 80 to 960 ms: a bias creeps along a line, a
/// hand does not. Sizes do not change with the axes in which a constant wrench is read: neither the sensor's
/// bias nor a wrongly declared payload lives while the arm turns.
///
/// - **Without life** it counts with the share `1 - s/way`, s the distance by which the arm has given way to
///   it [m], up to `force` and less its damping. After 0.9 `way`, or `calm` of pushing, it is *quiet* and
///   counts nothing (`push_without_life`), until it lives.
/// - **Tare while running.** After 0.5 s at rest, the reading of a quiet push becomes the reading of rest.
///   Readings below the gates are followed at rest by at most `creep`: slower than a hand comes.
///
/// @tparam N      number of readings.
/// @tparam Sizes  number of sizes of the push that are looked at for life, 1 to 16.
template <std::size_t N, std::size_t Sizes>
class PushWatch {
  using Life = detail::CellLife<Sizes>;
  static_assert(Sizes >= 1 && Sizes <= 16, "one row of sizes");

 public:
  static constexpr double min_push = 1e-9;  ///< smallest push for which displacement is counted [N]
  static constexpr std::uint32_t span = 6;  ///< 80 ms means over which a change is taken: 0.48 s
  using Values = std::array<double, N>;
  /// `Memory{}`: nothing has been read.
  struct Memory {
    typename Life::Memory fast{}, slow{};
    std::array<double, Sizes> fast_sum{}, slow_sum{};
    Values value_sum{};
    Values bias{};  ///< reading of rest, beyond the one declared
    std::uint32_t fast_count = 0, slow_count = 0;
    std::array<std::array<double, Sizes>, span + 1> past{};  ///< the last means of 80 ms
    std::uint32_t slot = 0;                                  ///< index of the newest mean in `past`
    std::uint32_t pushing = 0;                               ///< number of 80 ms means since the push began
    std::uint16_t pressed = 0;                               ///< bit k: the gate of size k is open
    bool alive = false, quiet = false;
    std::uint32_t tares = 0;  ///< number of quiet pushes that became the reading of rest
    double way = 0;           ///< distance by which the arm has given way to the push without life [m]
    double speed = 0;         ///< speed of the arm along the push [m/s]
    double lifeless = 0;      ///< time of pushing without life [s]
    double unpressed = 0;     ///< time without a push [s]
    double rested = 0;        ///< time for which the arm has stood still [s]
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };

  /// @param noise  per size (such as |force|), standard deviation of its mean over 8 ms, in its unit; a 0:
  ///               nothing is watched.
  /// @param creep  per reading, greatest rate at which its value at rest is followed while no size opens its
  ///               gate [its unit per s].
  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD PushWatch(const LifeSettings& life, const std::array<double, Sizes>& noise,
                         const Values& creep)
      : fast_(life), slow_(slower(life)), creep_(creep) {
    for (std::size_t k = 0; k < Sizes; ++k) {
      require(noise[k] >= 0 && noise[k] <= 1e6, "PushWatch: noise", noise[k], ">= 0, <= 1e6");
      watches_ = watches_ && noise[k] > 0;
      per_sigma_[k] = noise[k] > 0 ? 1 / noise[k] : 0;
    }
    for (const double c : creep)
      require(c >= 0 && c <= 1e6, "PushWatch: creep", c, ">= 0, <= 1e6 per second");
  }
  [[nodiscard]] bool watches() const noexcept { return watches_; }
  [[nodiscard]] const LifeSettings& life() const noexcept { return fast_.settings(); }

  /// Takes one reading of the sensor, less its bias, and the sizes of its push before the gates.
  /// @param pressed  bit k: the gate of size k is open.
  void take(Memory& m, const Values& value, const std::array<double, Sizes>& size,
            std::uint16_t pressed) const noexcept {
    if (!watches_) return;
    for (std::size_t k = 0; k < Sizes; ++k) m.fast_sum[k] += size[k] * per_sigma_[k];
    for (std::size_t i = 0; i < N; ++i) m.value_sum[i] += value[i];
    m.pressed = pressed;
    ++m.fast_count, ++m.slow_count;
  }

  /// Evaluates the means that are complete at `now`; call once a cycle. Returns `push_without_life` while a
  /// push is quiet, and when its reading becomes the reading of rest.
  Status settle(Memory& m, Nanoseconds now) const noexcept {
    if (!watches_ || m.fast_count == 0 || !Life::is_due(m.fast, now)) return of(m);
    const double dt = tick(fast_, m.fast, now, m.fast_sum, m.fast_count, limits, m.pressed);
    for (std::size_t k = 0; k < Sizes; ++k) m.slow_sum[k] += m.fast_sum[k];
    m.fast_sum = {}, m.fast_count = 0;
    const std::uint32_t tares = m.tares;
    const bool slow_due =
        m.slow.at == Nanoseconds::min() || now < m.slow.at || now - m.slow.at >= slow_period;
    const std::uint32_t count = m.slow_count;
    double slow_dt = 0;
    if (slow_due) {
      change(m);
      slow_dt = tick(slow_, m.slow, now, m.slow_sum, 1, slow_limits,
                     m.pushing > span ? m.pressed : std::uint16_t(0));
    }
    judge(m, dt);
    if (slow_due) {
      for (double& x : m.value_sum) x /= count;
      follow(m, slow_dt);
      m.slow_sum = {}, m.value_sum = {}, m.slow_count = 0;
    }
    return m.tares != tares ? Status{Reason::push_without_life} : of(m);
  }

  /// Takes the arm's motion of `dt` [s], by `way` [m] along the push; `at_rest`: no joint turns.
  void move(Memory& m, double way, double dt, bool at_rest) const noexcept {
    m.rested = at_rest ? m.rested + dt : 0;
    m.speed = dt > 0 ? way / dt : 0;
    if (m.pressed != 0 && !m.alive && way > 0) m.way += way;
  }

  /// Takes the robot's motion from `before`, which becomes `now`, by `way()` [m] along the push.
  template <class State, class Way>
  void follow_robot(Memory& m, State& before, const State& now, const Way& way) const noexcept {
    if (!watches_) return;
    const double dt = seconds<double>(now.time - before.time);
    if (dt > 0 && dt <= longest) {
      bool rests = true;
      for (const auto& speed : now.dq) rests = rests && std::abs(static_cast<double>(speed)) < resting;
      move(m, way(), dt, rests);
    }
    before = now;
  }

  /// The share of a push of `force` [N] that counts, 0 to 1.
  [[nodiscard]] double share(const Memory& m, double force) const noexcept {
    if (!watches_ || m.alive) return 1;
    if (m.quiet) return 0;
    const LifeSettings& s = life();
    const double cap = force > s.force ? s.force / force : 1, left = 1 - m.way / s.way;
    const double counted = force < s.force ? force : s.force;
    const double braked =
        1 - 2 * std::sqrt(s.mass / (s.way * (counted > 1e-3 ? counted : 1e-3))) * (m.speed > 0 ? m.speed : 0);
    return left > 0 && braked > 0 ? cap * left * braked : 0;
  }

 private:
  static constexpr double still = 0.5;      ///< time at rest before a tare [s]
  static constexpr double resting = 0.005;  ///< speed of a joint below which it rests [rad/s]
  static constexpr double longest = 1;      ///< longest time between states over which motion is counted [s]
  static constexpr double slow_down = 10;   ///< times that the slow windows are longer than the fast ones
  static constexpr Nanoseconds slow_period = 79ms;  ///< 80 ms, less than the stamps of a cycle may jitter
  static constexpr double found = 0.9;              ///< share of `way` from which on a push is quiet

  /// Health limits of readings in units of the noise of a mean of 8 ms; `steadier`: factor by which theirs is
  /// less.
  static constexpr detail::HealthLimitsRow limits_of(float steadier) noexcept {
    detail::HealthLimitsRow out{};
    for (float& x : out.per_sigma) x = steadier;
    for (float& x : out.moves) x = 12 / steadier;
    return out;
  }
  static constexpr detail::HealthLimitsRow limits = limits_of(1), slow_limits = limits_of(2);

  static LifeSettings slower(LifeSettings life) {
    life.check();
    life.held = life.held < 1s ? nanoseconds(slow_down * seconds<double>(life.held)) : Nanoseconds(10s);
    return life;
  }
  [[nodiscard]] static Status of(const Memory& m) noexcept {
    return m.quiet ? Status{Reason::push_without_life} : Status{};
  }
  /// The part of the cells' health that `CellLife` reads.
  struct Readings {
    struct Line {
      detail::HealthRow::Row force{};
    };
    std::array<Line, 1> row{};
    typename Life::Bits jumped{}, at_top{};
  };
  static double tick(const Life& life, typename Life::Memory& m, Nanoseconds now,
                     const std::array<double, Sizes>& sum, std::uint32_t count,
                     const detail::HealthLimitsRow& by, std::uint16_t pressed) noexcept {
    Readings readings;
    for (std::size_t k = 0; k < Sizes; ++k) readings.row[0].force[k] = static_cast<float>(sum[k] / count);
    const bool begun = m.at != Nanoseconds::min() && now > m.at;
    const double dt = begun ? seconds<double>(now - m.at) : 0;
    life.tick(
        m, now, readings, [&](std::size_t) -> const detail::HealthLimitsRow& { return by; },
        typename Life::Bits{pressed}, [](std::size_t) { return std::span<const std::size_t>(); });
    return dt < 1 ? dt : 1;
  }
  /// Replaces the sums of the last 80 ms by the change of their means over `span` means.
  void change(Memory& m) const noexcept {
    m.slot = (m.slot + 1) % (span + 1);
    auto& newest = m.past[m.slot];
    for (std::size_t k = 0; k < Sizes; ++k) newest[k] = m.slow_sum[k] / m.slow_count;
    const auto& before = m.past[(m.slot + 1) % (span + 1)];
    for (std::size_t k = 0; k < Sizes; ++k) m.slow_sum[k] = newest[k] - before[k];
    m.pushing = m.pressed == 0 ? 0 : m.pushing + (m.pushing <= span ? 1 : 0);
  }
  void judge(Memory& m, double dt) const noexcept {
    m.alive = (m.fast.lives[0] | (m.slow.lives[0] & m.pressed)) != 0;
    if (m.pressed == 0) {
      m.unpressed += dt, m.lifeless = 0;
      if (m.unpressed >= seconds<double>(life().calm)) m.way = 0, m.quiet = false;
      return;
    }
    m.unpressed = 0;
    m.lifeless = m.alive ? 0 : m.lifeless + dt;
    if (m.alive) m.way = 0, m.quiet = false;
    if (m.way > found * life().way || m.lifeless >= seconds<double>(life().calm)) m.quiet = true;
  }
  /// Follows the reading of rest; the mean of the last 80 ms is in `value_sum`.
  void follow(Memory& m, double dt) const noexcept {
    if (m.alive || m.rested < still) return;
    if (m.quiet && m.pressed != 0) {
      for (std::size_t i = 0; i < N; ++i) m.bias[i] += m.value_sum[i];
      m.quiet = false, m.way = m.lifeless = 0, ++m.tares;
    } else if (m.pressed == 0) {
      for (std::size_t i = 0; i < N; ++i) {
        const double most = creep_[i] * dt, x = m.value_sum[i];
        m.bias[i] += x > most ? most : x < -most ? -most : x;
      }
    }
  }

  Life fast_, slow_;
  std::array<double, Sizes> per_sigma_{};
  Values creep_;
  bool watches_ = true;
};

SKINCTL_END_NAMESPACE
