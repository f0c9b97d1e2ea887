// Unit wrenches of the cells on one link, in a memory layout for fast sums over all of them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "skinctl/core/lane.hpp"
#include "skinctl/tactile/patch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The number types in which a dense sum stores unit wrenches and readings, and in which it adds them: a
/// choice between memory and accuracy. A cell takes seven stored numbers; from about 600 cells on reading
/// them dominates the time.
template <Real Stored, Real Summed, class Unit = Stored>
struct SumPolicy {
  using stored = Stored;  ///< of readings
  using unit = Unit;      ///< of unit wrenches
  using summed = Summed;
};
/// 56 bytes a cell; error about 1e-16 of the sum of magnitudes.
using DoubleSum = SumPolicy<double, double>;
/// 28 bytes a cell; unit wrenches and readings are rounded to float (6e-8 each), the sum is in double.
using FloatStoredSum = SumPolicy<float, double>;
/// 28 bytes a cell and half the arithmetic; the rounding of the sum adds about 1e-7.
using FloatSum = SumPolicy<float, float>;
/// 16 bytes a cell: unit wrenches in 16 bits, in steps of 1/32767 of 1 and of the patch's largest moment, so
/// each of their numbers is off by at most 1.53e-5 of it; readings and sum in float.
using ShortStoredSum = SumPolicy<float, float, std::int16_t>;

/// The unit wrenches `-[z ; p x z]` of the cells of one patch in the layout `[block][6][W]`: a block holds
/// `W` cells, one per lane of the register in which they are summed. The last blocks are padded with zeros.
template <class Policy = DoubleSum>
class UnitWrenches {
 public:
  using Stored = typename Policy::stored;
  using Unit = typename Policy::unit;
  using Summed = typename Policy::summed;
  static constexpr std::size_t lanes = native_lanes<Summed>;
  /// Readings are processed in groups of this many, two blocks at a time; their arrays are padded with zeros
  /// to a multiple of it.
  static constexpr std::size_t group = 2 * lanes;
  static constexpr std::size_t padded(std::size_t cells) noexcept {
    return (cells + group - 1) / group * group;
  }

  template <std::size_t I, std::size_t N>
  explicit UnitWrenches(const Patch<I, N>& patch) : UnitWrenches(patch.any()) {}
  /// The same for any number of cells that is known at run time.
  SKINCTL_COLD explicit UnitWrenches(const std::vector<detail::AnyCell>& cells)
      : groups_(padded(cells.size()) / group) {
    if constexpr (in_steps) {
      double reach = 0;
      for (const detail::AnyCell& cell : cells) {
        const auto m = unit_wrench(cell.X_LC).moment;
        for (const double x : {m.x, m.y, m.z}) reach = std::abs(x) > reach ? std::abs(x) : reach;
      }
      force_step_ = Summed(1.0 / most_steps);
      moment_step_ = Summed(reach / most_steps);
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto u = unit_wrench(cells[i].X_LC);
      const double row[6] = {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z};
      for (std::size_t r = 0; r < 6; ++r)
        groups_[i / group].block[i / lanes % 2][r][i % lanes] =
            stored(row[r], r < 3 ? force_step_ : moment_step_);
    }
  }
  /// Bytes of the unit wrenches [B].
  [[nodiscard]] std::size_t bytes() const noexcept { return groups_.size() * sizeof(Group); }

  /// `wrench = sum of unit wrench times reading`, force first. `readings` holds `padded(cells)` numbers,
  /// zeros from `cells` on.
  SKINCTL_INLINE void weigh(const Stored* readings, Summed* wrench) const noexcept {
    Six even, odd;
    const Group* const end = groups_.data() + groups_.size();
    for (const Group* g = groups_.data(); g != end; ++g, readings += group) {
      even.add(g->block[0], load(readings));
      odd.add(g->block[1], load(readings + lanes));
    }
    wrench[0] = sum(even.fx + odd.fx);
    wrench[1] = sum(even.fy + odd.fy);
    wrench[2] = sum(even.fz + odd.fz);
    wrench[3] = sum(even.nx + odd.nx);
    wrench[4] = sum(even.ny + odd.ny);
    wrench[5] = sum(even.nz + odd.nz);
    if constexpr (in_steps) {
      for (std::size_t r = 0; r < 6; ++r) wrench[r] = wrench[r] * (r < 3 ? force_step_ : moment_step_);
    }
  }

 private:
  using L = Lane<Summed, lanes>;
  static constexpr bool in_steps = std::is_integral_v<Unit>;
  static constexpr double most_steps = 32767;
  static Unit stored(double x, Summed step) noexcept {
    if constexpr (in_steps) {
      const double n = step > Summed(0) ? std::round(x / static_cast<double>(step)) : 0;
      return static_cast<Unit>(n > most_steps ? most_steps : n < -most_steps ? -most_steps : n);
    } else {
      return static_cast<void>(step), static_cast<Unit>(x);
    }
  }
  static constexpr std::size_t alignment() noexcept {
    constexpr std::size_t bytes = 12 * lanes * sizeof(Unit), power = bytes & (~bytes + 1);
    return power < 64 ? power : 64;
  }
  struct alignas(alignment()) Group {
    Unit block[2][6][lanes] = {};
  };
  /// Named members, not an array: GCC keeps an array of accumulators in memory around the loop.
  struct Six {
    L fx{0}, fy{0}, fz{0}, nx{0}, ny{0}, nz{0};

    SKINCTL_INLINE void add(const Unit (&u)[6][lanes], const L& s) noexcept {
      fx = fx + load(u[0]) * s;
      fy = fy + load(u[1]) * s;
      fz = fz + load(u[2]) * s;
      nx = nx + load(u[3]) * s;
      ny = ny + load(u[4]) * s;
      nz = nz + load(u[5]) * s;
    }
  };

  /// Number by number where it converts: the only form that both compilers turn into one instruction. For
  /// steps it is that of vectors.
  template <class From>
  SKINCTL_INLINE static L load(const From* from) noexcept {
    if constexpr (std::same_as<From, Summed>) {
      return L::load(from);
    } else if constexpr (lanes == 1) {
      return L(static_cast<Summed>(*from));
    } else if constexpr (std::is_integral_v<From>) {
      typedef From Row __attribute__((vector_size(lanes * sizeof(From)), aligned(alignof(From)), may_alias));
      typedef std::int32_t Wide __attribute__((vector_size(lanes * sizeof(std::int32_t))));
      return L(__builtin_convertvector(__builtin_convertvector(*reinterpret_cast<const Row*>(from), Wide),
                                       typename L::Vector));
    } else {
      return [&]<std::size_t... I>(std::index_sequence<I...>) SKINCTL_INLINE_LAMBDA {
        return L(typename L::Vector{static_cast<Summed>(from[I])...});
      }(std::make_index_sequence<lanes>{});
    }
  }
  Summed force_step_{1}, moment_step_{1};
  std::vector<Group> groups_;
};

SKINCTL_END_NAMESPACE
