// SPDX-License-Identifier: BSD-3-Clause
// Row: one number per joint, computed in lanes.
#pragma once

#include <bit>
#include <cstdint>

#include "skinctl/core/detail/unrolled.hpp"
#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Division of `N` numbers into blocks of `width`. The last block holds `last` numbers; its other lanes are
/// undefined. Loads and stores touch each number once: a processor forwards a store to a load of the same
/// place and size, and stalls where blocks overlap.
template <std::size_t N, Real T>
struct RowShape {
  static constexpr bool wide = std::same_as<T, float> || std::same_as<T, double>;
  static constexpr std::size_t width = [] {
    if constexpr (wide) {
      return std::bit_floor(N) < native_lanes<T> ? std::bit_floor(N) : native_lanes<T>;
    } else {
      return std::size_t(1);
    }
  }();
  static constexpr std::size_t blocks = (N + width - 1) / width;
  static constexpr std::size_t last = N - (blocks - 1) * width;
  using Block = std::conditional_t<wide, Lane<T, width>, T>;
  using Mask = decltype(std::declval<Block>() < std::declval<Block>());

  /// Two floats as one word: GCC adds moves for a vector of two.
  typedef std::uint64_t Word __attribute__((may_alias, aligned(4)));
  typedef std::uint64_t Pair __attribute__((vector_size(16)));

  static constexpr std::size_t held(std::size_t block) noexcept { return block + 1 < blocks ? width : last; }

  /// Loads `Held` numbers from `from` on.
  template <std::size_t Held>
  static SKINCTL_INLINE Block load(const T* from) noexcept {
    if constexpr (!wide) {
      return *from;
    } else if constexpr (Held == width) {
      return Block::load(from);
    } else if constexpr (sizeof(T) * Held == 8 && sizeof(Block) == 16) {
      const Pair both = {*reinterpret_cast<const Word*>(from), 0};
      return Block(__builtin_bit_cast(typename Block::Vector, both));
    } else if constexpr (2 * Held == width && Held > 1) {
      const auto low = Lane<T, Held>::load(from).vector();
      return [&]<std::size_t... Ix>(std::index_sequence<Ix...>) SKINCTL_INLINE_LAMBDA {
        return Block(__builtin_shufflevector(low, low, (Ix < Held ? int(Ix) : -1)...));
      }(std::make_index_sequence<width>{});
    } else {
      return [&]<std::size_t... Ix>(std::index_sequence<Ix...>) SKINCTL_INLINE_LAMBDA {
        return Block(typename Block::Vector{(Ix < Held ? from[Ix < Held ? Ix : 0] : T(0))...});
      }(std::make_index_sequence<width>{});
    }
  }
  template <std::size_t Held>
  static SKINCTL_INLINE void store(const Block& block, T* to) noexcept {
    if constexpr (!wide) {
      *to = block;
    } else if constexpr (Held == width) {
      block.store(to);
    } else if constexpr (sizeof(T) * Held == 8 && sizeof(Block) == 16) {
      *reinterpret_cast<Word*>(to) = __builtin_bit_cast(Pair, block)[0];
    } else if constexpr (2 * Held == width && Held > 1) {
      Lane<T, Held>(half<T, width>(block.vector(), Lower{})).store(to);
    } else {
      unrolled<Held>([&](std::size_t i) SKINCTL_INLINE_LAMBDA { to[i] = block[i]; });
    }
  }
  /// Whether the mask holds for one of the first `Held` numbers.
  template <std::size_t Held>
  static SKINCTL_INLINE bool any_of(const Mask& mask) noexcept {
    if constexpr (!wide) {
      return mask;
    } else if constexpr (Held == width) {
      return any(mask);
    } else {
      return [&]<std::size_t... Ix>(std::index_sequence<Ix...>) SKINCTL_INLINE_LAMBDA {
        return any(mask & (Block(typename Block::Vector{T(Ix)...}) < Block(T(Held))));
      }(std::make_index_sequence<width>{});
    }
  }
  static SKINCTL_INLINE bool at(const Mask& mask, std::size_t lane) noexcept {
    if constexpr (wide) {
      return mask[lane];
    } else {
      return static_cast<void>(lane), mask;
    }
  }
};

/// The result of comparing rows, number by number.
template <std::size_t N, Real T>
class RowMask {
 public:
  using Shape = RowShape<N, T>;
  typename Shape::Mask block[Shape::blocks];

  friend SKINCTL_INLINE RowMask operator&(const RowMask& a, const RowMask& b) noexcept {
    return made([&](std::size_t k) SKINCTL_INLINE_LAMBDA { return a.block[k] & b.block[k]; });
  }
  friend SKINCTL_INLINE RowMask operator|(const RowMask& a, const RowMask& b) noexcept {
    return made([&](std::size_t k) SKINCTL_INLINE_LAMBDA { return a.block[k] | b.block[k]; });
  }
  friend SKINCTL_INLINE RowMask operator!(const RowMask& a) noexcept {
    return made([&](std::size_t k) SKINCTL_INLINE_LAMBDA { return !a.block[k]; });
  }
  [[nodiscard]] friend SKINCTL_INLINE bool any(const RowMask& a) noexcept {
    if constexpr (Shape::blocks == 1) {
      return Shape::template any_of<Shape::last>(a.block[0]);
    } else {
      bool found = Shape::template any_of<Shape::last>(a.block[Shape::blocks - 1]);
      unrolled<Shape::blocks - 1>(
          [&](auto k) SKINCTL_INLINE_LAMBDA { found |= Shape::template any_of<Shape::width>(a.block[k]); });
      return found;
    }
  }
  [[nodiscard]] friend SKINCTL_INLINE bool all(const RowMask& a) noexcept { return !any(!a); }
  /// Bit i holds the result for number i, i < 64.
  [[nodiscard]] SKINCTL_INLINE std::uint64_t bits() const noexcept {
    std::uint64_t out = 0;
    for (std::size_t i = 0; i < N; ++i)
      out |= std::uint64_t(Shape::at(block[i / Shape::width], i % Shape::width)) << i;
    return out;
  }
  template <class F>
  static SKINCTL_INLINE RowMask made(F&& f) noexcept {
    RowMask mask;
    mask.fill(f, std::make_index_sequence<Shape::blocks>{});
    return mask;
  }

 private:
  template <class F, std::size_t... K>
  SKINCTL_INLINE void fill(F& f, std::index_sequence<K...>) noexcept {
    ((block[K] = f(std::integral_constant<std::size_t, K>{})), ...);
  }
};

/// `N` numbers, one per joint, without their kind: for loops over joints inside one function. Every operation
/// is that of the plain number, joint by joint; NaN and comparisons behave the same. Compilers turn a loop
/// with conditions into a branch or a flag per joint; a row takes one instruction for four joints.
template <std::size_t N, Real T>
class Row {
 public:
  using Shape = RowShape<N, T>;
  using Mask = RowMask<N, T>;
  typename Shape::Block block[Shape::blocks];

  Row() = default;
  /// A row with the same number everywhere.
  SKINCTL_INLINE Row(const T& x) noexcept {
    unrolled<Shape::blocks>([&](std::size_t k)
                                SKINCTL_INLINE_LAMBDA { block[k] = typename Shape::Block(x); });
  }
  SKINCTL_INLINE explicit Row(const T* from) noexcept {
    unrolled<Shape::blocks>([&](auto k) SKINCTL_INLINE_LAMBDA {
      block[k] = Shape::template load<Shape::held(k)>(from + k * Shape::width);
    });
  }
  template <class Kind>
  SKINCTL_INLINE Row(const JointVector<Kind, N, T>& from) noexcept : Row(from.data) {}

  template <class Kind>
  SKINCTL_INLINE void store(JointVector<Kind, N, T>& to) const noexcept {
    store(to.data);
  }
  SKINCTL_INLINE void store(T* to) const noexcept {
    unrolled<Shape::blocks>([&](auto k) SKINCTL_INLINE_LAMBDA {
      Shape::template store<Shape::held(k)>(block[k], to + k * Shape::width);
    });
  }
  template <class Kind>
  SKINCTL_INLINE explicit operator JointVector<Kind, N, T>() const noexcept {
    return JointVector<Kind, N, T>::written([&](T* to) SKINCTL_INLINE_LAMBDA { store(to); });
  }

  [[nodiscard]] SKINCTL_INLINE T operator[](std::size_t i) const noexcept {
    if constexpr (Shape::wide) {
      return block[i / Shape::width][i % Shape::width];
    } else {
      return block[i];
    }
  }

  friend SKINCTL_INLINE Row operator+(const Row& a, const Row& b) noexcept {
    return made([&](std::size_t k) SKINCTL_INLINE_LAMBDA { return a.block[k] + b.block[k]; });
  }
  friend SKINCTL_INLINE Row operator-(const Row& a, const Row& b) noexcept {
    return made([&](std::size_t k) SKINCTL_INLINE_LAMBDA { return a.block[k] - b.block[k]; });
  }
  friend SKINCTL_INLINE Row operator*(const Row& a, const Row& b) noexcept {
    return made([&](std::size_t k) SKINCTL_INLINE_LAMBDA { return a.block[k] * b.block[k]; });
  }
  friend SKINCTL_INLINE Row operator/(const Row& a, const Row& b) noexcept {
    return made([&](std::size_t k) SKINCTL_INLINE_LAMBDA { return a.block[k] / b.block[k]; });
  }
  friend SKINCTL_INLINE Row operator-(const Row& a) noexcept {
    return made([&](std::size_t k) SKINCTL_INLINE_LAMBDA { return -a.block[k]; });
  }
  friend SKINCTL_INLINE Mask operator<(const Row& a, const Row& b) noexcept {
    return Mask::made([&](std::size_t k) SKINCTL_INLINE_LAMBDA { return a.block[k] < b.block[k]; });
  }
  friend SKINCTL_INLINE Mask operator<=(const Row& a, const Row& b) noexcept {
    return Mask::made([&](std::size_t k) SKINCTL_INLINE_LAMBDA { return a.block[k] <= b.block[k]; });
  }
  friend SKINCTL_INLINE Mask operator>(const Row& a, const Row& b) noexcept { return b < a; }
  friend SKINCTL_INLINE Mask operator>=(const Row& a, const Row& b) noexcept { return b <= a; }
  friend SKINCTL_INLINE Mask operator==(const Row& a, const Row& b) noexcept {
    return Mask::made([&](std::size_t k) SKINCTL_INLINE_LAMBDA { return a.block[k] == b.block[k]; });
  }
  friend SKINCTL_INLINE Mask operator!=(const Row& a, const Row& b) noexcept { return !(a == b); }

  /// `a` where the mask holds, else `b`.
  [[nodiscard]] friend SKINCTL_INLINE Row select(const Mask& mask, const Row& a, const Row& b) noexcept {
    return made([&](std::size_t k)
                    SKINCTL_INLINE_LAMBDA { return select(mask.block[k], a.block[k], b.block[k]); });
  }
  /// `b < a ? b : a`.
  [[nodiscard]] friend SKINCTL_INLINE Row smaller(const Row& a, const Row& b) noexcept {
    return select(b < a, b, a);
  }
  /// `x < low ? low : (x > high ? high : x)`, for `low <= high`: two instructions, which keep a NaN.
  [[nodiscard]] friend SKINCTL_INLINE Row clamp(const Row& x, const Row& low, const Row& high) noexcept {
    SKINCTL_EXPECTS(!any(high < low), "a clamp between ordered bounds");
    const Row below = select(high < x, high, x);
    return select(below < low, low, below);
  }
  [[nodiscard]] friend SKINCTL_INLINE Row magnitude(const Row& x) noexcept {
    if constexpr (Shape::wide) {
      return made([&](std::size_t k) SKINCTL_INLINE_LAMBDA { return abs(x.block[k]); });
    } else {
      return select(x < Row(T(0)), -x, x);
    }
  }

  /// The numbers `f(0)`, `f(1)`, ..., the index an integral constant, from registers: a load of numbers that
  /// were stored one by one waits for them.
  template <class F>
  static SKINCTL_INLINE Row of(F&& f) noexcept {
    return made([&](auto k) SKINCTL_INLINE_LAMBDA {
      const auto number = [&](auto i) SKINCTL_INLINE_LAMBDA -> T {
        if constexpr (i < N) {
          return f(i);
        } else {
          return T(0);
        }
      };
      if constexpr (Shape::wide) {
        return [&]<std::size_t... Ix>(std::index_sequence<Ix...>) SKINCTL_INLINE_LAMBDA {
          return typename Shape::Block(typename Shape::Block::Vector{
              number(std::integral_constant<std::size_t, k * Shape::width + Ix>{})...});
        }(std::make_index_sequence<Shape::width>{});
      } else {
        return number(k);
      }
    });
  }

  /// Calls `f(k)` for the index k of each block: for functions that write more than one row. Through
  /// references to rows GCC would copy whole rows, and such a load waits for the stores of the blocks.
  template <class F>
  static SKINCTL_INLINE void each_block(F&& f) noexcept {
    unrolled<Shape::blocks>(f);
  }

  /// The blocks `f(0)`, `f(1)`, ...
  template <class F>
  static SKINCTL_INLINE Row made(F&& f) noexcept {
    Row row;
    row.fill(f, std::make_index_sequence<Shape::blocks>{});
    return row;
  }

 private:
  template <class F, std::size_t... K>
  SKINCTL_INLINE void fill(F& f, std::index_sequence<K...>) noexcept {
    ((block[K] = f(std::integral_constant<std::size_t, K>{})), ...);
  }
};
template <class Kind, std::size_t N, Real T>
Row(const JointVector<Kind, N, T>&) -> Row<N, T>;

}  // namespace detail

/// A row is a scalar like a lane: compensated sums accept both.
template <std::size_t N, class T>
inline constexpr bool is_lane<detail::Row<N, T>> = true;
SKINCTL_END_NAMESPACE
