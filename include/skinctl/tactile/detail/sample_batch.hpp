// Samples side by side, a lane each: eight are checked, counted and gated at once.
#pragma once

#include <cstddef>
#include <utility>

#include "skinctl/tactile/detail/count_pair.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Samples side by side: as many as an AVX-512 register has times. 1: one by one, on other targets; four in AVX2 take as long.
#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__) && defined(__AVX512BW__) && \
    defined(__AVX512CD__)
inline constexpr std::size_t batch_lanes = 8;
#else
inline constexpr std::size_t batch_lanes = 1;
#endif

/// Registers of `W` samples, and what is computed in them. What fails a check has its sign bit set: many checks are one by `or`,
/// where each comparison would make a mask of its own.
template <std::size_t W>
struct SampleBatch;

#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__) && defined(__AVX512BW__) && \
    defined(__AVX512CD__)
template <>
struct SampleBatch<8> {
  using Long = LaneBits<double, 8>;
  using Word = LaneBits<float, 8>;
  using Double = LaneVector<double, 8>;
  using Float = LaneVector<float, 8>;
  using Signed = LaneVector<std::int32_t, 8>;
  using Halves = LaneVector<std::uint16_t, 16>;  ///< two a word, as in `CellCounts`
  using Two = LaneBits<double, 2>;
  using Four = LaneVector<float, 4>;
  using Set = std::uint8_t;  ///< of lanes, a bit each
  /// A row of two numbers in memory.
  typedef std::uint64_t TwoAt __attribute__((vector_size(16), aligned(8), may_alias));

  /// `f(0), f(1), ...` as lanes.
  template <class F>
  [[nodiscard]] static SKINCTL_INLINE Long lanes(const F& f) noexcept {
    return Long{f(0), f(1), f(2), f(3), f(4), f(5), f(6), f(7)};
  }

  /// Two numbers of each sample as lanes.
  struct Columns {
    Long first, second;
  };
  /// Of rows; `row(k)` gives that of sample `k`, loaded at once.
  template <class F>
  [[nodiscard]] static SKINCTL_INLINE Columns columns(const F& row) noexcept {
    const auto joined = [&](std::size_t k) SKINCTL_INLINE_LAMBDA {
      const Two a = row(k), b = row(k + 2), c = row(k + 4), d = row(k + 6);
      const auto ab = __builtin_shufflevector(a, b, 0, 1, 2, 3),
                 cd = __builtin_shufflevector(c, d, 0, 1, 2, 3);
      return __builtin_shufflevector(ab, cd, 0, 1, 2, 3, 4, 5, 6, 7);
    };
    const Long even = joined(0), odd = joined(1);
    return {lower(even, odd), upper(even, odd)};
  }
  /// Calls `store(k, row)` for each sample.
  template <class F>
  static SKINCTL_INLINE void each_row(const Columns& c, const F& store) noexcept {
    const Long even = lower(c.first, c.second), odd = upper(c.first, c.second);
    store(0, __builtin_shufflevector(even, even, 0, 1));
    store(1, __builtin_shufflevector(odd, odd, 0, 1));
    store(2, __builtin_shufflevector(even, even, 2, 3));
    store(3, __builtin_shufflevector(odd, odd, 2, 3));
    store(4, __builtin_shufflevector(even, even, 4, 5));
    store(5, __builtin_shufflevector(odd, odd, 4, 5));
    store(6, __builtin_shufflevector(even, even, 6, 7));
    store(7, __builtin_shufflevector(odd, odd, 6, 7));
  }

  /// What a cell reads, of each sample.
  struct Readings {
    Float force[3], proximity;
  };
  [[nodiscard]] static SKINCTL_INLINE Readings readings(const CellSample* samples) noexcept {
    const auto row = [&](std::size_t k) SKINCTL_INLINE_LAMBDA {
      const Four a = numbers<4>(samples[k]), b = numbers<4>(samples[k + 4]);
      return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
    };
    const Float a = row(0), b = row(1), c = row(2), d = row(3);
    const Float ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13),
                cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13),
                ab_after = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15),
                cd_after = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
    return {{__builtin_shufflevector(ab, cd, 0, 1, 8, 9, 4, 5, 12, 13),
             __builtin_shufflevector(ab, cd, 2, 3, 10, 11, 6, 7, 14, 15),
             __builtin_shufflevector(ab_after, cd_after, 0, 1, 8, 9, 4, 5, 12, 13)},
            __builtin_shufflevector(ab_after, cd_after, 2, 3, 10, 11, 6, 7, 14, 15)};
  }
  /// A sign bit is set unless all samples are `believable`; also if a reading is -0, which is.
  [[nodiscard]] static SKINCTL_INLINE Word unbelievable(const CellSample* samples,
                                                        const Readings& r) noexcept {
    SKINCTL_CONTRACT
    Float none{};  // NaN as soon as a number is not finite
    for (std::size_t k = 0; k < 8; ++k) none = none + numbers<8>(samples[k]) * 0.0f;
    // As an integer a number in [0, 1] is at most that of 1; negative ones and NaN are above.
    const auto higher = [](Word a, Word b) SKINCTL_INLINE_LAMBDA { return a > b ? a : b; };
    const Word highest =
        higher(higher(bits(r.force[0]), bits(r.force[1])), higher(bits(r.force[2]), bits(r.proximity)));
    constexpr std::uint32_t one = 0x3F800000;
    return (bits(none) << 1) | highest | (one - highest);
  }
  /// `CountPair` of each believable sample.
  [[nodiscard]] static SKINCTL_INLINE Word counts(const Readings& r) noexcept {
    SKINCTL_CONTRACT
    const Float force = (r.force[0] + r.force[1] + r.force[2]) * 16384.0f + 0.5f,
                proximity = r.proximity * 65536.0f + 0.5f;
    const auto f = __builtin_bit_cast(Word, __builtin_convertvector(force, Signed)),
               p = __builtin_bit_cast(Word, __builtin_convertvector(proximity, Signed));
    const Word full = Word{} + 65535u;
    return f | (p < full ? p : full) << 16;
  }
  /// `GatePair` for each.
  class Gates {
   public:
    SKINCTL_INLINE explicit Gates(const GatePair& g) noexcept
        : opens_(spread(g.opens)), less_(spread(g.less)), subtract_(spread(g.subtract)) {}
    [[nodiscard]] SKINCTL_INLINE Word pass(Word raw_counts, Word old_counts) const noexcept {
      const auto raw = __builtin_bit_cast(Halves, raw_counts), old = __builtin_bit_cast(Halves, old_counts);
      const Halves above = opens_ - (less_ & __builtin_bit_cast(Halves, old != 0));
      return __builtin_bit_cast(Word, (raw - subtract_) & __builtin_bit_cast(Halves, raw > above));
    }

   private:
    static SKINCTL_INLINE Halves spread(CountPair c) noexcept {
      return __builtin_bit_cast(Halves, Word{} + std::bit_cast<std::uint32_t>(c.counts_of()));
    }
    Halves opens_, less_, subtract_;
  };
  /// A sign bit is set if two lanes are equal.
  [[nodiscard]] static SKINCTL_INLINE Word repeated(Word x) noexcept {
#if defined(__clang__)
    const auto same = __builtin_ia32_vpconflictsi_256(__builtin_bit_cast(Signed, x));
#else
    const auto same =
        __builtin_ia32_vpconflictsi_256_mask(__builtin_bit_cast(Signed, x), Signed{}, Set(0xFF));
#endif
    return -__builtin_bit_cast(Word, same);
  }
  [[nodiscard]] static SKINCTL_INLINE bool any_sign(Word x) noexcept {
    return __builtin_ia32_movmskps256(__builtin_bit_cast(Float, x)) != 0;
  }
  [[nodiscard]] static SKINCTL_INLINE bool any_sign(Long x) noexcept {
    using Wide = LaneVector<long long, 8>;
    return __builtin_ia32_cmpq512_mask(__builtin_bit_cast(Wide, x), Wide{}, 1, Set(0xFF)) != 0;
  }

  /// Where two differ.
  [[nodiscard]] static SKINCTL_INLINE Set differ(Word a, Word b) noexcept {
    return __builtin_ia32_cmpd256_mask(__builtin_bit_cast(Signed, a), __builtin_bit_cast(Signed, b), 4,
                                       Set(0xFF));
  }
  /// Where force (K = 0) or proximity (K = 1) is 0 in one of both only.
  template <std::size_t K>
  [[nodiscard]] static SKINCTL_INLINE Set crosses(Word a, Word b) noexcept {
    const auto crossing =
        __builtin_bit_cast(Word, (__builtin_bit_cast(Halves, a) == 0) ^ (__builtin_bit_cast(Halves, b) == 0));
    return differ(K == 0 ? crossing << 16 : crossing >> 16, Word{});
  }
  /// Appends to `list` the lanes of `x` in a set, and returns how many. Writes eight numbers.
  [[nodiscard]] static SKINCTL_INLINE std::size_t append(std::uint32_t* list, Word x, Set set) noexcept {
    const auto packed = __builtin_ia32_compresssi256_mask(__builtin_bit_cast(Signed, x), Signed{}, set);
    store(reinterpret_cast<float*>(list), __builtin_bit_cast(Float, packed));
    return static_cast<std::size_t>(__builtin_popcount(set));
  }
  [[nodiscard]] static SKINCTL_INLINE Long load(const std::uint64_t* from) noexcept {
    typedef std::uint64_t Anywhere __attribute__((vector_size(64), aligned(8), may_alias));
    return *reinterpret_cast<const Anywhere*>(from);
  }
  template <class T>
  static SKINCTL_INLINE void store(T* to, LaneVector<T, 8> x) noexcept {
    *reinterpret_cast<typename LaneTypes<T, 8>::Anywhere*>(to) = x;
  }

  /// The lower halves.
  [[nodiscard]] static SKINCTL_INLINE Word narrow(Long x) noexcept {
    return __builtin_convertvector(x, Word);
  }
  [[nodiscard]] static SKINCTL_INLINE Long wide(Word x) noexcept {
#if defined(__clang__)
    return __builtin_convertvector(x, Long);
#else  // GCC converts by halves, and puts them together
    using Wide = LaneVector<long long, 8>;
    return __builtin_bit_cast(
        Long, __builtin_ia32_pmovzxdq512_mask(__builtin_bit_cast(Signed, x), Wide{}, Set(0xFF)));
#endif
  }
  /// Numbers below 2^52.
  template <class T>
  [[nodiscard]] static SKINCTL_INLINE LaneVector<T, 8> real(Long x) noexcept {
    const Double y = __builtin_bit_cast(Double, x | 0x4330000000000000u) - 0x1p52;
    if constexpr (std::is_same_v<T, double>) {
      return y;
    } else {
      return __builtin_convertvector(y, Float);
    }
  }
  [[nodiscard]] static SKINCTL_INLINE Double real(Word x) noexcept {
    const auto n = __builtin_bit_cast(Signed, x);
#if defined(__clang__)
    return __builtin_convertvector(n, Double);
#else
    return __builtin_ia32_cvtdq2pd512_mask(n, Double{}, Set(0xFF));
#endif
  }

 private:
  [[nodiscard]] static SKINCTL_INLINE Word bits(Float x) noexcept { return __builtin_bit_cast(Word, x); }
  /// The first numbers of a sample, from its forces on.
  template <std::size_t N>
  [[nodiscard]] static SKINCTL_INLINE LaneVector<float, N> numbers(const CellSample& s) noexcept {
    using Anywhere = typename LaneTypes<float, N>::Anywhere;
    return *reinterpret_cast<const Anywhere*>(reinterpret_cast<const char*>(&s) +
                                              offsetof(CellSample, force));
  }
  [[nodiscard]] static SKINCTL_INLINE Long lower(Long a, Long b) noexcept {
    return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
  }
  [[nodiscard]] static SKINCTL_INLINE Long upper(Long a, Long b) noexcept {
    return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
  }
};
#endif

}  // namespace detail
SKINCTL_END_NAMESPACE
