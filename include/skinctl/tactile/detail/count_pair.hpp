// The counts of both readings of a cell side by side, in one register.
#pragma once

#include <bit>

#include "skinctl/sensing/cell_sample.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Counts of force and proximity, or their differences: both at once. On a target without registers for four
/// numbers the compiler takes them one by one.
class CountPair {
 public:
  static constexpr std::size_t lanes = 4;  ///< of which two are used
  typedef std::int32_t Row __attribute__((vector_size(4 * lanes)));

  CountPair() = default;
  SKINCTL_INLINE explicit CountPair(Row row) noexcept : row_(row) {}
  SKINCTL_INLINE explicit CountPair(CellCounts c) noexcept {
    const Shorts both = __builtin_bit_cast(Shorts, Row{std::bit_cast<std::int32_t>(c), 0, 0, 0});
    row_ = __builtin_bit_cast(Row, __builtin_shufflevector(both, Shorts{}, 0, 8, 1, 9, 2, 10, 3, 11));
  }
  /// The counts of a sample that is believable: `counts(sample)`.
  SKINCTL_INLINE explicit CountPair(const CellSample& s) noexcept {
    typedef float Anywhere __attribute__((vector_size(16), aligned(4), may_alias));
    typedef float Four __attribute__((vector_size(16)));
    const Four x =
        *reinterpret_cast<const Anywhere*>(reinterpret_cast<const char*>(&s) + offsetof(CellSample, force));
    const Four sum =
        x + __builtin_shufflevector(x, x, 1, 1, 1, 1) + __builtin_shufflevector(x, x, 2, 2, 2, 2);
    const Four both = __builtin_shufflevector(sum, x, 0, 7, 0, 7) * Four{16384.0f, 65536.0f, 0.0f, 0.0f} +
                      Four{0.5f, 0.5f, 0.0f, 0.0f};
    const Row n = __builtin_convertvector(both, Row);
    row_ = n - (n >> 16);  // 65536 becomes 65535
  }
  [[nodiscard]] SKINCTL_INLINE Row row() const noexcept { return row_; }
  [[nodiscard]] SKINCTL_INLINE std::int32_t force() const noexcept { return row_[0]; }
  [[nodiscard]] SKINCTL_INLINE std::int32_t proximity() const noexcept { return row_[1]; }
  /// Force (K = 0) or proximity (K = 1) as a scalar. Both are converted at once.
  template <std::size_t K, Real T>
  [[nodiscard]] SKINCTL_INLINE T as() const noexcept {
    if constexpr (std::is_same_v<T, double> || std::is_same_v<T, float>) {
      return __builtin_convertvector(row_, LaneVector<T, lanes>)[K];
    } else {
      return static_cast<T>(row_[K]);
    }
  }
  /// For counts from 0 to 65535.
  [[nodiscard]] SKINCTL_INLINE CellCounts counts_of() const noexcept {
    const Shorts words = __builtin_bit_cast(Shorts, row_);
    const auto packed = __builtin_shufflevector(words, words, 0, 2, 2, 2, 4, 5, 6, 7);
    return std::bit_cast<CellCounts>(__builtin_bit_cast(Row, packed)[0]);
  }
  /// Bit 0: force is above 0; bit 1: proximity.
  [[nodiscard]] SKINCTL_INLINE std::uint32_t positive() const noexcept {
    const auto above = row_ > 0;
#if defined(__SSE2__)
    typedef float Signs __attribute__((vector_size(16)));
    return static_cast<std::uint32_t>(__builtin_ia32_movmskps(__builtin_bit_cast(Signs, above)));
#else
    return (static_cast<std::uint32_t>(above[0]) & 1u) | (static_cast<std::uint32_t>(above[1]) & 2u);
#endif
  }
  friend SKINCTL_INLINE CountPair operator-(CountPair a, CountPair b) noexcept {
    return CountPair(a.row_ - b.row_);
  }

 private:
  typedef std::uint16_t Shorts __attribute__((vector_size(4 * lanes)));
  Row row_;
};

/// Thresholds of both readings in counts (`EventGate`): a reading above `opens` passes, while it is open one
/// above `opens - less`, and `subtract`, which is no more than that and one, is taken off.
struct GatePair {
  CountPair opens, less, subtract;

  /// What passes of `raw`, when `old` passed last. Without a branch: readings come as they like.
  [[nodiscard]] SKINCTL_INLINE CountPair pass(CountPair raw, CountPair old) const noexcept {
    // As rows: where `int32_t` is `long`, a comparison gives vectors of `int`, with which no `long` can be compared.
    using Row = std::remove_cvref_t<decltype(raw.row())>;
    const Row was_open = __builtin_bit_cast(Row, old.row() > 0);
    const Row above = opens.row() - (less.row() & was_open), rest = raw.row() - subtract.row();
    return CountPair(rest & __builtin_bit_cast(Row, raw.row() > above));
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
