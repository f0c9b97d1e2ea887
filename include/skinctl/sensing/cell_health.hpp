// SPDX-License-Identifier: BSD-3-Clause
// The health of cells: faults found by rules in seconds, and masks that fade in and out.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "skinctl/sensing/cell_fault.hpp"
#include "skinctl/sensing/cell_health_settings.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/sensing/detail/frame_scan.hpp"
#include "skinctl/sensing/unrest.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// The last message of a cell with `Sensors` force sensors, and how often it has come.
template <std::size_t Sensors>
struct MessageRecord {
  std::array<std::uint16_t, Sensors + 1> last{};   ///< last reading of each sensor [steps]; hash of the whole
  std::array<std::uint16_t, Sensors + 1> equal{};  ///< times in a row that each number of `last` has come
  Stillness still;                                 ///< stillness of a cell that says its unrest
  CellFaults faults;                               ///< faults found, while the mask is held
  bool known = false;                              ///< whether a sample has come
  bool says = false;                               ///< whether the last sample said its unrest
  friend bool operator==(const MessageRecord&, const MessageRecord&) noexcept = default;
};
}  // namespace detail

/// Finds faulty cells of a skin with `Cells` cells. sigma is the standard deviation of the noise of the force
/// sensors' sum, with rounding.
///
/// | fault      | found when                                                                                  |
/// |------------|---------------------------------------------------------------------------------------------|
/// | stuck      | one force sensor sends n equal readings, n = 23 / -ln erf(1/(2 sqrt2 noise)): 1 in 1e10 by chance. At 0 only where its rest is above 4 noise + 1 step, at the top only without witness. Or `equal_messages` |
/// | saturated  | a force sensor at its top for `saturated_for`, without witness (else it is an overload)      |
/// | blinking   | jumps by max(12 sigma, 0.1 of the range) in 6 ms, no witness moving within 12 ms: more than 2.5, leaking over 1 s |
/// | noisy      | squared second differences over 0.2 s where the force turns, each capped at (16 sigma)^2: > 40 sigma^2, and uncapped > 1.5 times the squared first differences |
///
/// Cross-talk needs other cells: `detail/cross_talk.hpp`. A discharge is a matter of the rest level, a cell
/// that is not heard one of its age. Masks fade in over `fade_in`, and out over `fade_out` after `hold`
/// without finding.
///
/// A cell that says its unrest (`CellSample::unrest`) is stuck when it has none for
/// `Stillness::frozen_after` measurements, pressed or at rest, and else not, however often its readings
/// repeat. Of the others a sample is a measurement: a network that repeats old readings under new stamps
/// makes healthy cells look stuck.
///
/// Of another kind than the hexagon, the force sensors are the readings of its pressures, as shares of their
/// greatest value; its proximity is what it sees.
template <std::size_t Cells, SensorKind Kind = Hexagon>
class CellHealth {
  using Table = KindTable<Kind>;
  static constexpr std::size_t sensors = static_cast<std::size_t>(std::popcount(Table::pressed_readings));
  using Record = detail::MessageRecord<sensors>;

 public:
  static_assert(sensors > 0, "cells without a pressure have no faults that show");
  static constexpr std::size_t cells = Cells, rows = (Cells + 15) / 16;
  /// `Memory{}` has heard no cell, and masks none.
  struct Memory {
    std::array<detail::HealthRow, rows> row{};
    std::array<Record, rows * 16> record{};
    std::array<std::uint16_t, rows> suspect{};  ///< cells whose messages repeat
    std::array<std::uint16_t, rows> fresh{};    ///< cells with a sample since the last frame
    std::array<std::uint16_t, rows> at_top{};   ///< cells with a force sensor at its top
    std::array<std::uint16_t, rows> jumped{};   ///< cells whose force has jumped since life was looked for
    Nanoseconds time = Nanoseconds::min();      ///< end of the last frame
    friend bool operator==(const Memory& a, const Memory& b) noexcept {
      return a.time == b.time && a.record == b.record && a.suspect == b.suspect && a.fresh == b.fresh &&
             a.at_top == b.at_top && a.jumped == b.jumped &&
             std::equal(a.row.begin(), a.row.end(), b.row.begin(), [](const auto& x, const auto& y) {
               return std::bit_cast<std::array<std::uint32_t, sizeof(x) / 4>>(x) ==
                      std::bit_cast<std::array<std::uint32_t, sizeof(y) / 4>>(y);
             });
    }
  };
  /// The evidence of a cell's witnesses.
  struct Witness {
    bool moved = false;    ///< whether a witness has moved within about twice `witnessed_within`
    bool touched = false;  ///< whether a witness is touched, too
  };

  /// @param noise  noise of each cell, or one for all. Throws `ConfigurationError` for a number out of its
  ///               range.
  SKINCTL_COLD explicit CellHealth(const CellHealthSettings& settings = {},
                                   std::span<const SensorNoise> noise = std::span(&usual_noise, 1))
      : s_(settings), limits_(rows), cell_(rows * 16) {
    settings.check();
    require(noise.size() == 1 || noise.size() == Cells, "CellHealth: noises", double(noise.size()),
            "one for all, or one a cell");
    for (std::size_t i = 0; i < Cells; ++i) {
      const SensorNoise& n = noise[noise.size() == 1 ? 0 : i];
      require(n.force >= 0 && n.force <= 1000, "SensorNoise: force", double(n.force), "0 to 1000 steps");
      require(n.proximity >= 0 && n.proximity <= 1000, "SensorNoise: proximity", double(n.proximity),
              "0 to 1000 steps");
      require(n.rest >= 0 && double(n.rest) * s_.step < 1, "SensorNoise: rest", double(n.rest),
              ">= 0 steps, < range");
      const double sigma = std::sqrt(double(sensors) * (double(n.force) * double(n.force) + 1.0 / 12));
      auto& limits = limits_[i / 16];
      limits.per_sigma[i % 16] =
          static_cast<float>(1 / std::sqrt(sigma * sigma + double(sensors) * s_.delta * s_.delta));
      limits.jump[i % 16] = static_cast<float>(std::max(12 * sigma, 0.1 / s_.step));
      limits.moves[i % 16] = static_cast<float>(12 * sigma + double(sensors) * s_.delta);
      limits.proximity[i % 16] =
          static_cast<float>(6 * s_.step * std::sqrt(double(n.proximity) * double(n.proximity) + 1.0 / 12));
      const double p = std::erf(1 / (2 * std::sqrt(2.0) * std::max(double(n.force), 0.05)));
      const double needed = p < 1 && !n.repeats ? std::ceil(23 / -std::log(p)) : 1e9;
      cell_[i] = {static_cast<float>(sigma), static_cast<std::uint16_t>(needed < 60000 ? needed : 65535),
                  n.repeats ? std::uint16_t(65535) : Stillness::frozen_after(double(n.force), sensors),
                  double(n.rest) > 4 * double(n.force) + 1};
    }
    max_messages_ = s_.equal_messages > 0 ? s_.equal_messages : 65535;
    per_step_ = static_cast<float>(1 / s_.step),
    top_ = static_cast<std::uint16_t>(std::ceil(s_.top / s_.step - 1e-9));
  }
  [[nodiscard]] const CellHealthSettings& settings() const noexcept { return s_; }
  /// Standard deviation of the sum of cell `i`'s forces, with rounding [steps].
  [[nodiscard]] float sigma(std::size_t i) const noexcept { return cell_[i].sigma; }

  /// Whether cell `i` has spoken since the last frame: then the frame is to be scanned before its next
  /// sample.
  [[nodiscard]] static bool spoke(const Memory& m, std::size_t i) noexcept {
    return ((m.fresh[i / 16] >> (i % 16)) & 1u) != 0;
  }
  /// Takes a sample of cell `i` < Cells that passed `check`.
  SKINCTL_INLINE void take(Memory& m, std::size_t i, const CellSample& s) const noexcept {
    take(m, i, s, (s.force[0] + s.force[1] + s.force[2]) * per_step_, s.proximity);
  }
  /// Takes a sample of a cell of any kind, with the sum of its pressures [steps] and its proximity, 0 to 1.
  SKINCTL_INLINE void take(Memory& m, std::size_t i, const SampleOf<Kind>& s, float force,
                           float proximity) const noexcept {
    Record& r = m.record[i];
    detail::HealthRow& row = m.row[i / 16];
    const std::size_t k = i % 16;
    const auto& x = detail::readings_of(s);
    std::uint64_t hash = 0;
    for (const float number : x)
      hash = ((hash ^ (hash >> 32)) + std::bit_cast<std::uint32_t>(number)) * 0xD6E8FEB86659FD93u;
    std::uint32_t suspect = 0, top = 0;
    r.says = Stillness::said(s);
    const auto note = [&](std::size_t c, std::uint32_t steps, std::uint32_t most) SKINCTL_INLINE_LAMBDA {
      const auto n = static_cast<std::uint16_t>(steps);
      const std::uint32_t equal = n != r.last[c] ? 1u : r.equal[c] < 65534 ? r.equal[c] + 1u : 65534u;
      r.last[c] = n, r.equal[c] = static_cast<std::uint16_t>(equal);
      suspect |= equal >= most && !r.says ? 1u : 0u;
    };
    std::size_t sensor = 0;
    for (std::size_t c = 0; c < Table::readings; ++c) {
      if (((Table::pressed_readings >> c) & 1u) == 0) continue;
      const float share = x[c] * static_cast<float>(1 / Kind::readings[c].max);
      note(sensor, static_cast<std::uint32_t>(share > 0 ? share * per_step_ + 0.5f : 0.0f), cell_[i].equal);
      top |= r.last[sensor++] >= top_ ? 1u : 0u;
    }
    note(sensors, static_cast<std::uint32_t>(hash >> 48), max_messages_);
    r.still.take(s);
    const bool frozen = r.still.measurements >= cell_[i].frozen;
    const bool repeats = r.says ? frozen : s_.equal_messages > 0 && r.equal[sensors] >= 3;
    suspect |= frozen ? 1u : 0u;
    const std::size_t b = i / 16;
    const auto set = [k](std::uint16_t& bits, std::uint32_t value) {
      bits = static_cast<std::uint16_t>((bits & ~(1u << k)) | (value << k));
    };
    set(m.suspect[b], suspect), set(m.at_top[b], top), set(m.fresh[b], 1);
    row.force[k] = force, row.proximity[k] = proximity;
    // A message that repeats sees nothing, and the first one after a silence has no predecessor.
    if (repeats) row.seen[k] = 0;
    if (!r.known || row.gap[k] > 0.5f) {
      row.last[k] = force, row.last_proximity[k] = proximity, row.change[k] = 0, row.gap[k] = 0;
    }
    r.known = true;
  }

  /// Ends a frame at `until`. `witness(i) -> Witness` is asked for the few cells that are worth a look.
  /// Without `judges` it keeps its statistics, and finds nothing. The skin has `count` cells, up to `Cells`.
  template <class Ask>
  void scan(Memory& m, Nanoseconds until, const Ask& witness, bool judges = true,
            std::size_t count = Cells) const noexcept {
    const bool begun = m.time != Nanoseconds::min() && until > m.time;
    const Nanoseconds dt = !begun ? 0ns : until - m.time < 1s ? until - m.time : Nanoseconds(1s);
    m.time = until;
    detail::HealthStep k;
    k.dt = seconds<float>(dt), k.leak = std::exp(-k.dt), k.saturated = seconds<float>(s_.saturated_for);
    // What a cell that sends changes has not sent has not moved.
    if (s_.delta > 0) k.per_gap = 0;
    k.follows = std::max(k.follows, 3 * k.dt);  // of slow sensors, too
    k.rise = k.dt / seconds<float>(s_.fade_in), k.fall = k.dt / seconds<float>(s_.fade_out);
    for (std::size_t b = 0; 16 * b < count; ++b) {
      const detail::HealthBits bits = detail::frame_scan(m.row[b], limits_[b], k, m.fresh[b], m.at_top[b]);
      m.fresh[b] = 0;
      m.jumped[b] = static_cast<std::uint16_t>(m.jumped[b] | bits.jumped);
      if (!judges) continue;
      for (std::uint32_t look = bits.look | m.suspect[b]; look != 0; look &= look - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(look));
        if (16 * b + lane < count)
          judge(m, 16 * b + lane, ((bits.jumped >> lane) & 1u) != 0, ((bits.expired >> lane) & 1u) != 0,
                witness);
      }
    }
  }
  /// Holds the mask of cell `i` for a fault that was found elsewhere.
  void hold(Memory& m, std::size_t i, CellFault fault) const noexcept {
    detail::HealthRow& row = m.row[i / 16];
    const float time = seconds<float>(fault == CellFault::blinking ? s_.hold_blinking : s_.hold);
    row.hold[i % 16] = row.hold[i % 16] > time ? row.hold[i % 16] : time;
    m.record[i].faults |= fault;
  }

  /// Limits of the cells of row `b`.
  [[nodiscard]] const detail::HealthLimitsRow& limits(std::size_t b) const noexcept { return limits_[b]; }

  /// The mask of cell `i`: 0: it counts; 1: it does not.
  [[nodiscard]] static float mask(const Memory& m, std::size_t i) noexcept {
    return m.row[i / 16].mask[i % 16];
  }
  /// The faults of cell `i`, found within the time that its mask is held.
  [[nodiscard]] static CellFaults faults(const Memory& m, std::size_t i) noexcept {
    return m.record[i].faults;
  }

 private:
  static constexpr SensorNoise usual_noise{};
  struct Constants {
    float sigma = 1;               ///< noise of the summed forces [steps]
    std::uint16_t equal = 65535;   ///< equal readings in a row that show a stuck sensor
    std::uint16_t frozen = 65535;  ///< measurements without unrest that show a stuck cell
    bool rests_above_zero = false;
  };

  template <class Ask>
  SKINCTL_NOINLINE void judge(Memory& m, std::size_t i, bool jumped, bool expired,
                              const Ask& ask) const noexcept {
    detail::HealthRow& row = m.row[i / 16];
    Record& r = m.record[i];
    const std::size_t k = i % 16;
    const Witness witness = ask(i);
    // A jump is judged when its witnesses have had their time, or when the next one comes.
    if ((expired || (jumped && row.pending[k] > 0)) && !witness.moved) row.jumps[k] += 1;
    if (jumped) row.pending[k] = seconds<float>(s_.witnessed_within);
    CellFaults found;
    for (std::size_t c = 0; c < sensors; ++c) {
      const bool zero = r.last[c] == 0, top = r.last[c] >= top_;
      const bool stands = r.says ? r.still.measurements >= cell_[i].frozen : r.equal[c] >= cell_[i].equal;
      if (stands && (!zero || cell_[i].rests_above_zero) && !(top && witness.touched))
        found |= CellFault::stuck;
    }
    if (!r.says && r.equal[sensors] >= max_messages_) found |= CellFault::stuck;
    if (row.top[k] >= seconds<float>(s_.saturated_for) && !witness.touched) found |= CellFault::saturated;
    if (row.capped[k] > 40 && row.second[k] > 1.5f * row.first[k]) found |= CellFault::noisy;
    if (row.jumps[k] > 2.5f) found |= CellFault::blinking;
    if (row.hold[k] == 0) r.faults = {};
    for (const CellFault f : {CellFault::stuck, CellFault::saturated, CellFault::blinking, CellFault::noisy})
      if (found.has(f)) hold(m, i, f);
  }

  CellHealthSettings s_;
  std::vector<detail::HealthLimitsRow> limits_;
  std::vector<Constants> cell_;
  float per_step_ = 1024;
  std::uint16_t top_ = 1004;
  std::uint32_t max_messages_ = 65535;  ///< equal messages in a row that show a dead cell; 65535: never
};

SKINCTL_END_NAMESPACE
