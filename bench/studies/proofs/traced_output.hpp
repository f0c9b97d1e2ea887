// The rounding error of one result of a traced program, over boxes of its inputs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "bench/studies/proofs/error_sum.hpp"
#include "bench/studies/proofs/tape_slice.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// The part of a tape that one result depends on, and the bound of that result's error:
///
///     |computed - exact| <= sum_k |adjoint_k| delta_k,
///
/// where delta_k is the largest error of operation k alone (half a unit in the last place of its result, the
/// error of a kernel, of a constant), and adjoint_k the derivative of the result after it. By the mean value
/// theorem this holds with enclosures of values and adjoints over the box that contain everything between the
/// exact and the rounded computation, so no term of higher order is left out. Several boxes at once, in
/// lanes.
class TracedOutput : private detail::TapeSlice {
 public:
  using L = Lane<double, native_lanes<double>>;
  static constexpr std::size_t lanes = L::lanes;
  /// The bounds of a program in float and of the same program in double.
  struct Errors {
    L in_float, in_double;
  };

  /// @param node  `Traced<R>::node()` of the result. For both scalars, their programs must be the same: see
  ///              `same_program`.
  TracedOutput(const Tape& tape, std::int32_t node) : TapeSlice(tape, node) {
    values_.resize(first_ + steps_.size());
    adjoints_.resize(values_.size());
    units_.resize(values_.size()), in_double_.resize(values_.size());
    const std::size_t symbols = inputs_.size();
    slopes_.assign((2 * values_.size() + 1) * symbols, L(0.0));
    for (std::size_t k = 0; k < values_.size(); ++k) {
      values_[k].slope = &slopes_[2 * k * symbols];
      adjoints_[k].slope = &slopes_[(2 * k + 1) * symbols];
    }
    product_.slope = &slopes_[2 * values_.size() * symbols];
  }

  TracedOutput(TracedOutput&&) = default;
  TracedOutput& operator=(TracedOutput&&) = default;

  /// Which inputs of the tape the result depends on, in order: the box has one enclosure for each.
  [[nodiscard]] const std::vector<std::size_t>& inputs() const noexcept { return inputs_; }
  [[nodiscard]] std::size_t operations() const noexcept { return steps_.size(); }
  /// An upper limit of the result itself, in the boxes of the last evaluation.
  [[nodiscard]] L highest() const noexcept { return values_[result_].range.high; }

  /// The bound of the error of `lanes` boxes; infinite where there is none, or where a decision of the
  /// program may come out differently.
  ///
  /// @param lows, highs  ends of `lanes` enclosures for each input, in `inputs().size()` rows.
  [[nodiscard]] Errors operator()(const L* lows, const L* highs) noexcept {
    const std::size_t n = inputs_.size();
    for (std::size_t k = 0; k < n; ++k) {
      auto& x = values_[k];
      x.set({lows[k], highs[k]}, set(reach_[k]));
      x.slope[k] = x.rest;
      x.rest = L(0.0);
    }
    for (std::size_t k = 0; k < constants_.size(); ++k) {
      const Enclosure c = constants_[k].in_float.computed(), d = constants_[k].in_double.computed();
      values_[n + k].set({L(std::fmin(c.low, d.low)), L(std::fmax(c.high, d.high))}, {});
    }
    L endless(0.0);  // infinite or NaN once a value has no bound
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      forward(k);
      const auto& v = values_[first_ + k];
      endless = endless + abs(v.range.low) + abs(v.range.high) + abs(v.centre) + v.radius;
    }
    for (const auto& d : decisions_) {
      const auto &a = values_[static_cast<std::size_t>(d.a)].range,
                 &b = values_[static_cast<std::size_t>(d.b)].range;
      const auto holds = d.less ? a.high < b.low : a.low >= b.high;
      endless = select(holds, endless, L(std::numeric_limits<double>::infinity()));
    }
    reached_.assign(adjoints_.size(), 0);
    adjoints_[result_].set({L(1.0), L(1.0)}, {});
    reached_[result_] = 1;
    for (Sum* sum : {&units_sum_, &float_sum_, &double_sum_}) sum->clear(n);
    for (std::size_t k = steps_.size(); k-- > 0;) {
      const std::size_t i = first_ + k;
      if (!carries_[i] || !reached_[i]) continue;
      const auto& a = adjoints_[i];
      if (steps_[k].rounded) {
        if (is_kernel(steps_[k].op)) {
          float_sum_.add(a, units_[i], set(seen_[i]));
          double_sum_.add(a, in_double_[i], set(seen_[i]));
        } else {
          units_sum_.add(a, units_[i], set(seen_[i]));
        }
      }
      backward(k);
      endless = endless + abs(a.range.low) + abs(a.range.high) + abs(a.centre) + a.radius;
    }
    for (std::size_t k = n; k < first_; ++k) {
      if (!reached_[k]) continue;
      const auto& a = adjoints_[k];
      float_sum_.add(a, L(constants_[k - n].in_float.error()), set(seen_[k]));
      double_sum_.add(a, L(constants_[k - n].in_double.error()), set(seen_[k]));
      endless = endless + abs(a.range.low) + abs(a.range.high) + abs(a.centre) + a.radius;
    }
    const auto bounded = endless < L(1e250);
    const auto total = [&](const Sum& others, double u) {
      return select(bounded, detail::largest(units_sum_, u, others, n),
                    L(std::numeric_limits<double>::infinity()));
    };
    return {total(float_sum_, unit<float>), total(double_sum_, unit<double>)};
  }

 private:
  using E = detail::LaneEnclosure<L>;
  using F = detail::LaneForm<L>;
  using Sum = detail::ErrorSum<L>;
  template <class R>
  static constexpr double unit = 0.5 * static_cast<double>(std::numeric_limits<R>::epsilon());
  /// What an underflow may lose, in units of the scalar's rounding; the float is the larger.
  static constexpr double eta = static_cast<double>(std::numeric_limits<float>::min()) / unit<double>;
  [[nodiscard]] static constexpr bool is_kernel(TapeOp op) noexcept {
    return op == TapeOp::sin || op == TapeOp::cos || op == TapeOp::tanh;
  }
  [[nodiscard]] const F& operand(std::int32_t i) const noexcept {
    return values_[static_cast<std::size_t>(i)];
  }

  void forward(std::size_t k) noexcept {
    const Step& s = steps_[k];
    const detail::InputSet n = set(reach_[first_ + k]);
    F& v = values_[first_ + k];
    const F& a = operand(s.a);
    switch (s.op) {
      case TapeOp::add:
        add(a, 1, operand(s.b), v, n);
        break;
      case TapeOp::subtract:
        add(a, -1, operand(s.b), v, n);
        break;
      case TapeOp::multiply:
        multiply(a, operand(s.b), v, n);
        break;
      case TapeOp::divide:
        v.set(a.range / operand(s.b).range, n);
        break;
      case TapeOp::negate:
        negative(a, v, n);
        break;
      case TapeOp::sin:
      case TapeOp::cos: {
        const bool sine = s.op == TapeOp::sin;
        if (static_cast<std::size_t>(s.a) < inputs_.size()) {
          sine_or_cosine(a, sine, static_cast<std::size_t>(s.a), v, n);
        } else {
          E x, y;
          detail::sincos(a.range, x, y);
          v.set(sine ? x : y, n);
        }
        break;
      }
      case TapeOp::tanh:
        v.set(detail::each_lane(a.range, [](const Enclosure& x) { return tanh(x); }), n);
        break;
      case TapeOp::sqrt:
        v.set(detail::each_lane(a.range, [](const Enclosure& x) { return sqrt(x); }), n);
        break;
      case TapeOp::exp:
        v.set(detail::each_lane(a.range, [](const Enclosure& x) { return exp(x); }), n);
        break;
      case TapeOp::abs:
        v.set(detail::each_lane(a.range, [](const Enclosure& x) { return abs(x); }), n);
        break;
      default:
        break;
    }
    if (!s.rounded) return;
    // The enclosures have room for the program in float; that in double lies within.
    if (is_kernel(s.op)) {
      const bool turns = s.op != TapeOp::tanh;
      using In = detail::kernel_error<float>;
      using Id = detail::kernel_error<double>;
      units_[first_ + k] = turns ? detail::turning(In::turning, v.range) : L(In::tanh);
      in_double_[first_ + k] = turns ? detail::turning(Id::turning, v.range) : L(Id::tanh);
      v.widen(units_[first_ + k]);
    } else {
      L& units = units_[first_ + k];
      units = detail::power_of_two_below(v.largest()) + L(eta);
      if (s.op == TapeOp::exp) units = L(3.0) * units;
      v.widen(L(unit<float>) * units);
    }
  }
  static void negative(const F& a, F& y, detail::InputSet n) noexcept {
    y.range = -a.range;
    y.centre = -a.centre, y.rest = a.rest, y.radius = a.radius;
    for (const std::size_t i : n) y.slope[i] = -a.slope[i];
  }
  /// Adds `x`, times 1 or -1, to the adjoint of an operand.
  void give(std::int32_t to, const F& x, double sign = 1) noexcept {
    const auto i = static_cast<std::size_t>(to);
    if (!carries_[i]) return;
    F& adjoint = adjoints_[i];
    const detail::InputSet n = set(seen_[i]);
    if (reached_[i]) {
      add(adjoint, sign, x, adjoint, n);
      return;
    }
    reached_[i] = 1;
    if (sign < 0) return negative(x, adjoint, n);
    adjoint.range = x.range;
    adjoint.centre = x.centre, adjoint.rest = x.rest, adjoint.radius = x.radius;
    for (const std::size_t j : n) adjoint.slope[j] = x.slope[j];
  }
  /// Adds `x` times a value, a form or an enclosure.
  template <class Factor>
  void give_times(std::int32_t to, const F& x, const Factor& factor, double sign = 1) noexcept {
    if (!carried(to)) return;
    const auto i = static_cast<std::size_t>(to);
    const detail::InputSet n = set(seen_[i]);
    if (reached_[i]) {
      multiply(x, factor, product_, n);
      add(adjoints_[i], sign, product_, adjoints_[i], n);
    } else {
      multiply(x, factor, adjoints_[i], n);
      if (sign < 0) negative(adjoints_[i], adjoints_[i], n);
      reached_[i] = 1;
    }
  }
  [[nodiscard]] bool carried(std::int32_t i) const noexcept {
    return i >= 0 && carries_[static_cast<std::size_t>(i)] != 0;
  }
  void backward(std::size_t k) noexcept {
    const Step& s = steps_[k];
    const F& x = adjoints_[first_ + k];
    const F& v = values_[first_ + k];
    switch (s.op) {
      case TapeOp::add:
        give(s.a, x), give(s.b, x);
        break;
      case TapeOp::subtract:
        give(s.a, x), give(s.b, x, -1);
        break;
      case TapeOp::multiply:
        give_times(s.a, x, operand(s.b)), give_times(s.b, x, operand(s.a));
        break;
      case TapeOp::divide: {
        const E one{L(1.0), L(1.0)};
        const E inverse = one / operand(s.b).range;
        give_times(s.a, x, inverse), give_times(s.b, x, inverse * v.range, -1);
        break;
      }
      case TapeOp::negate:
        give(s.a, x, -1);
        break;
      case TapeOp::sqrt:
        give_times(s.a, x, E{L(0.5), L(0.5)} / v.range);
        break;
      case TapeOp::sin:
      case TapeOp::cos:
        if (carried(s.a)) {
          E sine, cosine;
          detail::sincos(operand(s.a).range, sine, cosine);
          give_times(s.a, x, s.op == TapeOp::sin ? cosine : -sine);
        }
        break;
      case TapeOp::tanh:
        if (carried(s.a))  // the derivative falls with the distance to zero
          give_times(s.a, x, detail::each_lane(operand(s.a).range, [](const Enclosure& a) {
                       const Enclosure y = Enclosure(1) - square(tanh(abs(a)));
                       return Enclosure(std::fmax(y.low, 0.0), y.high);
                     }));
        break;
      case TapeOp::exp:
        give_times(s.a, x, v);
        break;
      case TapeOp::abs:
        if (carried(s.a)) {
          const L zero(0.0), one(1.0);
          const E& a = operand(s.a).range;
          give_times(s.a, x, E{select(a.low >= zero, one, -one), select(a.high <= zero, -one, one)});
        }
        break;
      default:
        break;
    }
  }

  std::vector<F> values_, adjoints_;
  Sum units_sum_, float_sum_, double_sum_;
  std::vector<L> units_, in_double_;  // an operation's own error: in units, or of a kernel
  std::vector<L> slopes_;
  std::vector<char> reached_;  // whether an adjoint is written
  F product_;
};

}  // namespace math
SKINCTL_END_NAMESPACE
