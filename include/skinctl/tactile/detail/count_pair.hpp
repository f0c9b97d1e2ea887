// The counts of both readings of a cell side by side, in one register.
#pragma once

#include <bit>

#include "skinctl/sensing/cell_sample.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Counts of both readings as wide numbers, which may be weighed, and their differences.
class WideCounts {
 public:
  static constexpr std::size_t lanes = 4;  ///< of which two are used
  typedef std::int32_t Row __attribute__((vector_size(4 * lanes)));

  WideCounts() = default;
  SKINCTL_INLINE explicit WideCounts(Row row) noexcept : row_(row) {}
  [[nodiscard]] SKINCTL_INLINE Row row() const noexcept { return row_; }
  [[nodiscard]] SKINCTL_INLINE std::int32_t force() const noexcept { return row_[0]; }
  [[nodiscard]] SKINCTL_INLINE std::int32_t proximity() const noexcept { return row_[1]; }
  /// Force (K = 0) or proximity (K = 1) as a scalar. Both are converted at once.
  template <std::size_t K, Real T>
  [[nodiscard]] SKINCTL_INLINE T as() const noexcept {
#if defined(__SSE2__) && !defined(__clang__)  // GCC converts them one by one
    if constexpr (std::is_same_v<T, double>) return __builtin_ia32_cvtdq2pd(row_)[K];
#endif
    if constexpr (std::is_same_v<T, double>) {
      return __builtin_convertvector(__builtin_shufflevector(row_, row_, 0, 1), LaneVector<T, 2>)[K];
    } else if constexpr (std::is_same_v<T, float>) {
      return __builtin_convertvector(row_, LaneVector<T, lanes>)[K];
    } else {
      return static_cast<T>(row_[K]);
    }
  }
  friend SKINCTL_INLINE WideCounts operator-(WideCounts a, WideCounts b) noexcept {
    return WideCounts(a.row_ - b.row_);
  }

 private:
  Row row_;
};

/// Counts of force and proximity side by side, both at once. On a target without registers for them the compiler takes them
/// one by one.
class CountPair {
#if defined(__SSE2__) || (defined(__ARM_NEON) && defined(__aarch64__))
  static constexpr std::size_t lanes = 8;  // a register, of which two are used
#else
  static constexpr std::size_t lanes = 2;
#endif
  typedef std::int32_t Words __attribute__((vector_size(2 * lanes)));

 public:
  typedef std::uint16_t Row __attribute__((vector_size(2 * lanes)));

  CountPair() = default;
  SKINCTL_INLINE explicit CountPair(Row row) noexcept : row_(row) {}
  SKINCTL_INLINE explicit CountPair(CellCounts c) noexcept
      : row_(__builtin_bit_cast(Row, Words{std::bit_cast<std::int32_t>(c)})) {}
  /// The counts of a sample that is believable: `counts(sample)`.
  SKINCTL_INLINE explicit CountPair(const CellSample& s) noexcept {
#if defined(__SSE4_1__)
    typedef float Four __attribute__((vector_size(16)));
    const Four both = Four{s.force[0] + s.force[1] + s.force[2], s.proximity, 0.0f, 0.0f} *
                          Four{16384.0f, 65536.0f, 0.0f, 0.0f} +
                      Four{0.5f, 0.5f, 0.0f, 0.0f};
    const WideCounts::Row n = __builtin_convertvector(both, WideCounts::Row);
    row_ = __builtin_bit_cast(Row, __builtin_ia32_packusdw128(n, n));  // 65536 becomes 65535
#else
    *this = CountPair(counts(s));
#endif
  }
  [[nodiscard]] SKINCTL_INLINE Row row() const noexcept { return row_; }
  [[nodiscard]] SKINCTL_INLINE CellCounts counts_of() const noexcept {
    return std::bit_cast<CellCounts>(__builtin_bit_cast(Words, row_)[0]);
  }
  [[nodiscard]] SKINCTL_INLINE WideCounts wide() const noexcept {
#if defined(__SSE2__) || (defined(__ARM_NEON) && defined(__aarch64__))
    return WideCounts(
        __builtin_bit_cast(WideCounts::Row, __builtin_shufflevector(row_, Row{}, 0, 8, 1, 9, 2, 10, 3, 11)));
#else
    return WideCounts(WideCounts::Row{row_[0], row_[1], 0, 0});
#endif
  }
  /// Whether force and proximity are 0 where those of `other` are, and not elsewhere.
  [[nodiscard]] SKINCTL_INLINE bool open_as(CountPair other) const noexcept {
    return __builtin_bit_cast(Words, (row_ == 0) ^ (other.row_ == 0))[0] == 0;
  }

 private:
  Row row_;
};

/// Thresholds of both readings in counts (`EventGate`): a reading above `opens` passes, while it is open one
/// above `opens - less`, and `subtract`, which is no more than that and one, is taken off.
struct GatePair {
  CountPair opens, less, subtract;

  /// What passes of `raw`, when `old` passed last. Without a branch: readings come as they like.
  [[nodiscard]] SKINCTL_INLINE CountPair pass(CountPair raw, CountPair old) const noexcept {
    using Row = CountPair::Row;
    const Row was_open = __builtin_bit_cast(Row, old.row() != 0);
    const Row above = opens.row() - (less.row() & was_open), rest = raw.row() - subtract.row();
    return CountPair(rest & __builtin_bit_cast(Row, raw.row() > above));
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
