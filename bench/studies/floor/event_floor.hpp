// The floor under an event of a skin: flat arrays, one kernel with all checks for the usual sample, and nothing
// for any other.
#pragma once

#include <cstring>
#include <span>
#include <vector>

#include "bench/studies/floor/floor.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/tactile/detail/cell_table.hpp"

namespace bench_floor {

/// Cells that are all heard; force and proximity apart in the sums, together in the means.
class EventFloor {
 public:
#if defined(__AVX512F__)
  static constexpr std::size_t width = 8;
#elif defined(__AVX__)
  static constexpr std::size_t width = 4;
#else
  static constexpr std::size_t width = 2;
#endif
  static constexpr std::size_t parts = 8 / width;
  typedef double Part __attribute__((vector_size(8 * width)));
  typedef float Four __attribute__((vector_size(16)));
  typedef float FourAnywhere __attribute__((vector_size(16), aligned(4), may_alias));
  typedef std::int32_t Ints __attribute__((vector_size(16)));

  struct alignas(64) Sums {
    Part force[parts] = {}, proximity[parts] = {}, mean[parts] = {};
  };
  struct alignas(16) Record {
    std::int64_t stamp = 0;
    std::uint32_t held = 0, unused = 0;
  };
  struct Key {
    std::uint32_t index = ~std::uint32_t(0), sums = 0;
  };

  /// Of `table`, ids below `ids`; times in ns, thresholds and gains on counts.
  EventFloor(const skinctl::detail::CellTable& table, std::uint32_t ids, std::size_t number,
             std::int64_t hold, std::int64_t ramp, std::int64_t reach, const std::int32_t (&threshold)[2],
             const double (&gain)[2])
      : units_(table.size()),
        keys_(ids + 1),
        records(table.size()),
        sums(number),
        hold_(hold),
        ramp_(ramp),
        latest_(reach - ramp),
        threshold_{threshold[0], threshold[1], 0, 0},
        gain_{gain[0], gain[1]} {
    for (std::uint32_t id = 0; id < ids; ++id)
      if (const auto key = table.key(id); key.index() < table.size())
        keys_[id] = {static_cast<std::uint32_t>(key.index()), static_cast<std::uint32_t>(key.sums())};
    for (std::size_t i = 0; i < table.size(); ++i) units_[i] = table[i];
  }

  /// Number of samples that were not usual, and not taken. The means are in `sums`, since the last call.
  std::size_t take(std::span<const skinctl::CellSample> samples, std::int64_t from,
                   std::int64_t to) noexcept {
    const double per_twice = 0.5 / static_cast<double>(to - from);
    for (Sums& s : sums)
      for (Part& m : s.mean) m = Part{};
    const std::uint32_t last = static_cast<std::uint32_t>(keys_.size() - 1);
    std::size_t refused = 0;
    for (const auto& sample : samples) {
      const Key key = keys_[sample.cell < last ? sample.cell : last];
      const auto* at = reinterpret_cast<const char*>(&sample) + offsetof(skinctl::CellSample, force);
      const Four x = *reinterpret_cast<const FourAnywhere*>(at),
                 y = *reinterpret_cast<const FourAnywhere*>(at + 16);
      const Ints good = (x >= 0.0f) & (x <= 1.0f) & (y - y == 0.0f);
      if (key.index >= records.size() || skinctl::detail::any_bit(~good)) [[unlikely]] {
        ++refused;
        continue;
      }
      Record& cell = records[key.index];
      const auto late = static_cast<std::uint64_t>(to - sample.time.count());
      const auto silence = static_cast<std::uint64_t>(to - cell.stamp);
      if (late > static_cast<std::uint64_t>(latest_) || silence <= late ||
          silence > static_cast<std::uint64_t>(hold_)) [[unlikely]] {
        ++refused;
        continue;
      }
      cell.stamp = sample.time.count();
      const Four sum =
          x + __builtin_shufflevector(x, x, 1, 1, 1, 1) + __builtin_shufflevector(x, x, 2, 2, 2, 2);
      const Four both =
          __builtin_shufflevector(sum, x, 0, 7, 0, 7) * Four{16384, 65536, 0, 0} + Four{0.5f, 0.5f, 0, 0};
      Ints raw = __builtin_convertvector(both, Ints);
      raw = raw - (raw >> 16);
      const Ints rest = raw - threshold_, passed = rest & (rest > 0);
      const std::uint32_t now = static_cast<std::uint32_t>(passed[0]) | static_cast<std::uint32_t>(passed[1])
                                                                            << 16;
      const std::uint32_t old = cell.held;
      if (now == old) continue;
      cell.held = now;
      const double force = passed[0] - static_cast<std::int32_t>(old & 0xFFFF);
      const double proximity = passed[1] - static_cast<std::int32_t>(old >> 16);
      const std::uint64_t turn = late + static_cast<std::uint64_t>(ramp_),
                          begun = turn < silence ? turn : silence;
      const double share = static_cast<double>(static_cast<std::int64_t>(late + begun)) * per_twice;
      const double mean = share * (gain_[0] * force + gain_[1] * proximity);
      Sums& s = sums[key.sums];
      for (std::size_t k = 0; k < parts; ++k) {
        const Part u = skinctl::detail::widened<double>(units_[key.index].row + k * width);
        s.force[k] += force * u;
        s.proximity[k] += proximity * u;
        s.mean[k] += mean * u;
      }
    }
    return refused;
  }

 private:
  std::vector<skinctl::detail::CellUnit> units_;
  std::vector<Key> keys_;

 public:
  std::vector<Record> records;
  std::vector<Sums> sums;

 private:
  std::int64_t hold_, ramp_, latest_;
  Ints threshold_;
  double gain_[2];
};

}  // namespace bench_floor
