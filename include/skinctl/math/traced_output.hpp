// The rounding error of one result of a traced program, over boxes of its inputs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "skinctl/math/bound.hpp"
#include "skinctl/math/detail/lane_form.hpp"
#include "skinctl/math/tape.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// Whether two recordings hold the same operations on the same numbers: then one bounds the errors of both.
[[nodiscard]] inline bool same_program(const Tape& a, const Tape& b) {
  const auto &x = a.nodes(), &y = b.nodes();
  if (x.size() != y.size() || a.decisions().size() != b.decisions().size()) return false;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (x[i].op != y[i].op || x[i].a != y[i].a || x[i].b != y[i].b || x[i].number != y[i].number ||
        (x[i].op != TapeOp::constant && x[i].rounded != y[i].rounded))
      return false;
  for (std::size_t i = 0; i < a.decisions().size(); ++i) {
    const auto &d = a.decisions()[i], &e = b.decisions()[i];
    if (d.a != e.a || d.b != e.b || d.less != e.less) return false;
  }
  return true;
}

/// The part of a tape that one result depends on, and the bound of that result's error:
///
///     |computed - exact| <= sum_k |adjoint_k| delta_k,
///
/// where delta_k is the largest error of operation k alone (half a unit in the last place of its result, the
/// error of a kernel, of a constant), and adjoint_k the derivative of the result after it. By the mean value theorem
/// this holds with enclosures of values and adjoints over the box that contain everything between the exact and
/// the rounded computation, so no term of higher order is left out. Several boxes at once, in lanes.
class TracedOutput {
 public:
  using L = Lane<double, native_lanes<double>>;
  static constexpr std::size_t lanes = L::lanes;
  /// The bounds of a program in float and of the same program in double.
  struct Errors {
    L in_float, in_double;
  };

  /// @param node  `Traced<R>::node()` of the result. For both scalars, their programs must be the same: see
  ///              `same_program`.
  TracedOutput(const Tape& tape, std::int32_t node) {
    const auto& nodes = tape.nodes();
    const auto n = nodes.size();
    std::vector<char> needed(n, 0), varies(n, 0);
    const auto need = [&](std::int32_t i) { needed[static_cast<std::size_t>(i)] = 1; };
    need(node);
    for (const auto& d : tape.decisions()) need(d.a), need(d.b);
    for (std::size_t i = n; i-- > 0;) {
      if (!needed[i]) continue;
      if (nodes[i].a >= 0) need(nodes[i].a);
      if (nodes[i].b >= 0) need(nodes[i].b);
    }
    std::vector<Fixed> fixed(n);
    std::vector<std::int32_t> place(n, -1);
    for (std::size_t k = 0; k < tape.inputs().size(); ++k) {
      const auto i = static_cast<std::size_t>(tape.inputs()[k]);
      if (!needed[i]) continue;
      varies[i] = 1;
      place[i] = static_cast<std::int32_t>(inputs_.size());
      inputs_.push_back(k);
    }
    // What does not depend on an input is a number with an error, computed once.
    const auto at = [&](std::int32_t i) { return static_cast<std::size_t>(i); };
    for (std::size_t i = 0; i < n; ++i) {
      const auto& node_i = nodes[i];
      if (!needed[i] || node_i.op == TapeOp::input) continue;
      varies[i] = (node_i.a >= 0 && varies[at(node_i.a)]) || (node_i.b >= 0 && varies[at(node_i.b)]);
      if (!varies[i]) fixed[i] = folded(node_i, fixed);
    }
    const auto leaf = [&](std::int32_t i) {
      const auto k = at(i);
      if (varies[k] || place[k] >= 0) return;
      place[k] = static_cast<std::int32_t>(inputs_.size() + constants_.size());
      constants_.push_back(fixed[k]);
    };
    if (!varies[at(node)]) leaf(node);
    for (std::size_t i = 0; i < n; ++i) {
      if (!needed[i] || !varies[i] || nodes[i].op == TapeOp::input) continue;
      if (nodes[i].a >= 0) leaf(nodes[i].a);
      if (nodes[i].b >= 0) leaf(nodes[i].b);
    }
    for (const auto& d : tape.decisions()) leaf(d.a), leaf(d.b);
    first_ = inputs_.size() + constants_.size();
    carries_.assign(first_, 0);
    for (std::size_t k = 0; k < constants_.size(); ++k)
      carries_[inputs_.size() + k] =
          constants_[k].in_float.error() > 0 || constants_[k].in_double.error() > 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (!needed[i] || !varies[i] || nodes[i].op == TapeOp::input) continue;
      const auto operand = [&](std::int32_t k) { return k < 0 ? -1 : place[at(k)]; };
      place[i] = static_cast<std::int32_t>(first_ + steps_.size());
      steps_.push_back({nodes[i].op, nodes[i].rounded, operand(nodes[i].a), operand(nodes[i].b)});
      const auto carried = [&](std::int32_t k) { return k >= 0 && carries_[at(k)] != 0; };
      carries_.push_back(nodes[i].rounded || carried(steps_.back().a) || carried(steps_.back().b));
    }
    for (const auto& d : tape.decisions()) decisions_.push_back({place[at(d.a)], place[at(d.b)], d.less});
    result_ = at(place[at(node)]);
    values_.resize(first_ + steps_.size());
    adjoints_.resize(values_.size());
    units_.resize(values_.size()), in_double_.resize(values_.size());
    // Which inputs a value, or an adjoint, depends on at most: the first so many.
    reach_.assign(values_.size(), 0), seen_.assign(values_.size(), 0);
    for (std::size_t k = 0; k < inputs_.size(); ++k) reach_[k] = k + 1;
    const auto reach_of = [&](std::int32_t i) { return i < 0 ? 0 : reach_[at(i)]; };
    for (std::size_t k = 0; k < steps_.size(); ++k)
      reach_[first_ + k] = std::max(reach_of(steps_[k].a), reach_of(steps_[k].b));
    for (std::size_t k = steps_.size(); k-- > 0;) {
      const Step& s = steps_[k];
      const bool linear = s.op == TapeOp::add || s.op == TapeOp::subtract || s.op == TapeOp::negate;
      for (const std::int32_t to : {s.a, s.b}) {
        if (to < 0) continue;
        std::size_t& seen = seen_[at(to)];
        seen = std::max(seen, seen_[first_ + k]);
        if (!linear) seen = std::max(seen, s.op == TapeOp::multiply ? reach_of(to == s.a ? s.b : s.a) : 0);
        if (s.op == TapeOp::exp) seen = std::max(seen, reach_[first_ + k]);
      }
    }
    const std::size_t symbols = inputs_.size();
    slopes_.assign((2 * values_.size() + 2) * symbols, L(0.0));
    for (std::size_t k = 0; k < values_.size(); ++k) {
      values_[k].slope = &slopes_[2 * k * symbols];
      adjoints_[k].slope = &slopes_[(2 * k + 1) * symbols];
    }
    product_.slope = &slopes_[2 * values_.size() * symbols];
    sum_.slope = product_.slope + symbols;
  }

  TracedOutput(TracedOutput&&) = default;
  TracedOutput& operator=(TracedOutput&&) = default;

  /// Which inputs of the tape the result depends on, in order: the box has one enclosure for each.
  [[nodiscard]] const std::vector<std::size_t>& inputs() const noexcept { return inputs_; }
  [[nodiscard]] std::size_t operations() const noexcept { return steps_.size(); }
  /// An upper limit of the result itself, in the boxes of the last evaluation.
  [[nodiscard]] L highest() const noexcept { return values_[result_].range.high; }

  /// The bound of the error of `lanes` boxes; infinite where there is none, or where a decision of the program
  /// may come out differently.
  ///
  /// @param box  `lanes` enclosures per input, `inputs().size()` rows: lower ends, then upper ends.
  [[nodiscard]] Errors operator()(const L* lows, const L* highs) noexcept {
    const std::size_t n = inputs_.size();
    for (std::size_t k = 0; k < n; ++k) {
      auto& x = values_[k];
      x.set({lows[k], highs[k]}, n);
      x.slope[k] = x.rest;
      x.rest = L(0.0);
    }
    for (std::size_t k = 0; k < constants_.size(); ++k) {
      const Enclosure c = constants_[k].in_float.computed(), d = constants_[k].in_double.computed();
      values_[n + k].set({L(std::fmin(c.low, d.low)), L(std::fmax(c.high, d.high))}, 0);
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
    adjoints_[result_].set({L(1.0), L(1.0)}, 0);
    reached_[result_] = 1;
    for (ErrorSum* sum : {&units_sum_, &float_sum_, &double_sum_}) sum->clear(n);
    for (std::size_t k = steps_.size(); k-- > 0;) {
      const std::size_t i = first_ + k;
      if (!carries_[i] || !reached_[i]) continue;
      const auto& a = adjoints_[i];
      if (steps_[k].rounded) {
        if (is_kernel(steps_[k].op)) {
          float_sum_.add(a, units_[i], seen_[i]);
          double_sum_.add(a, in_double_[i], seen_[i]);
        } else {
          units_sum_.add(a, units_[i], seen_[i]);
        }
      }
      backward(k);
      endless = endless + abs(a.range.low) + abs(a.range.high) + abs(a.centre) + a.radius;
    }
    for (std::size_t k = n; k < first_; ++k) {
      if (!reached_[k]) continue;
      const auto& a = adjoints_[k];
      float_sum_.add(a, L(constants_[k - n].in_float.error()), seen_[k]);
      double_sum_.add(a, L(constants_[k - n].in_double.error()), seen_[k]);
      endless = endless + abs(a.range.low) + abs(a.range.high) + abs(a.centre) + a.radius;
    }
    const auto bounded = endless < L(1e250);
    const auto total = [&](const ErrorSum& others, double u) {
      return select(bounded, largest(units_sum_, u, others, n), L(std::numeric_limits<double>::infinity()));
    };
    return {total(float_sum_, unit<float>), total(double_sum_, unit<double>)};
  }

 private:
  using E = detail::LaneEnclosure<L>;
  using F = detail::LaneForm<L>;
  struct Step {
    TapeOp op;
    bool rounded;
    std::int32_t a, b;
  };
  /// `sum_k |adjoint_k| delta_k`: term by term, and as a form over the inputs, because the terms are not all largest
  /// at the same place of the box. Where an adjoint changes its sign, a chord is above its magnitude.
  struct ErrorSum {
    L plain, centre, rest;
    std::vector<L> slope;

    void clear(std::size_t n) {
      plain = centre = rest = L(0.0);
      slope.assign(n, L(0.0));
    }
    void add(const detail::LaneForm<L>& a, const L& delta, std::size_t n) noexcept {
      const L zero(0.0), one(1.0), low = a.range.low, high = a.range.high;
      plain = plain + delta * a.largest();
      const auto positive = low >= zero, negative = high <= zero;
      const L sign = select(positive, one, select(negative, -one, (high + low) / (high - low)));
      const L above = select(positive | negative, zero, high * (one - sign) * L(1 + 0x1p-48));
      centre = centre + delta * (sign * a.centre + above);
      rest = rest + delta * abs(sign) * a.rest;
      const L by = delta * sign;
      for (std::size_t i = 0; i < n; ++i) slope[i] = slope[i] + by * a.slope[i];
    }
  };
  /// The largest of `u` times the one sum plus the other, in the box.
  static L largest(const ErrorSum& a, double u, const ErrorSum& b, std::size_t n) noexcept {
    const L plain = L(u) * a.plain + b.plain;
    L form = L(u) * (a.centre + a.rest) + (b.centre + b.rest);
    for (std::size_t i = 0; i < n; ++i) form = form + abs(L(u) * a.slope[i] + b.slope[i]);
    // The sums' own rounding is relative to their terms' magnitudes.
    return min(plain * L(1 + 0x1p-40), form + plain * L(0x1p-38) + (L(u) * a.rest + b.rest) * L(0x1p-38));
  }
  template <class R>
  static constexpr double unit = 0.5 * static_cast<double>(std::numeric_limits<R>::epsilon());
  /// What an underflow may lose, in units of the scalar's rounding; the float is the larger.
  static constexpr double eta = static_cast<double>(std::numeric_limits<float>::min()) / unit<double>;
  [[nodiscard]] static constexpr bool is_kernel(TapeOp op) noexcept {
    return op == TapeOp::sin || op == TapeOp::cos || op == TapeOp::tanh;
  }
  /// `turning_error` in lanes.
  [[nodiscard]] static L turning(const double (&error)[detail::turning_steps], const E& v) noexcept {
    const L zero(0.0), high = v.largest();
    const L low = select((v.low <= zero) & (v.high >= zero), zero, min(abs(v.low), abs(v.high)));
    L most(0.0);
    for (std::size_t i = 0; i < detail::turning_steps; ++i) {
      const auto meets =
          (low <= L(detail::turning_ends[i + 1] + 0.0005)) & (high >= L(detail::turning_ends[i] - 0.0005));
      most = max(most, select(meets, L(error[i]), zero));
    }
    return most;
  }
  struct Fixed {
    Bound<float> in_float;
    Bound<double> in_double;
  };
  [[nodiscard]] static Fixed folded(const Tape::Node& n, const std::vector<Fixed>& of) {
    std::vector<Bound<float>> f;
    std::vector<Bound<double>> d;
    for (const std::int32_t i : {n.a, n.b}) {
      const auto k = static_cast<std::size_t>(i < 0 ? 0 : i);
      f.push_back(of[k].in_float), d.push_back(of[k].in_double);
    }
    return {folded_in<float>(n, f), folded_in<double>(n, d)};
  }
  template <class R>
  [[nodiscard]] static Bound<R> folded_in(const Tape::Node& n, const std::vector<Bound<R>>& of) {
    const auto a = [&]() -> const Bound<R>& { return of[0]; };
    const auto b = [&]() -> const Bound<R>& { return of[1]; };
    switch (n.op) {
      case TapeOp::constant:
        return Bound<R>(n.number);
      case TapeOp::add:
        return a() + b();
      case TapeOp::subtract:
        return a() - b();
      case TapeOp::multiply:
        return a() * b();
      case TapeOp::divide:
        return a() / b();
      case TapeOp::negate:
        return -a();
      case TapeOp::sqrt:
        return sqrt(a());
      case TapeOp::sin:
        return sin(a());
      case TapeOp::cos:
        return cos(a());
      case TapeOp::tanh:
        return tanh(a());
      case TapeOp::exp:
        return exp(a());
      case TapeOp::abs:
        return abs(a());
      default:
        return Bound<R>(Enclosure::everything(), std::numeric_limits<double>::infinity());
    }
  }
  /// Each lane by the enclosure of one number.
  template <class F>
  static E each(const E& a, F&& f) noexcept {
    double low[lanes], high[lanes];
    a.low.store(low), a.high.store(high);
    for (std::size_t i = 0; i < lanes; ++i) {
      const Enclosure y = f(Enclosure(low[i], high[i]));
      low[i] = y.low, high[i] = y.high;
    }
    return {L::load(low), L::load(high)};
  }
  static SKINCTL_INLINE L power_of_two_below(const L& x) noexcept {
    using Word = typename skinctl::detail::LaneTypes<double, 1>::Word;
    return skinctl::detail::to_lane<double, lanes>(skinctl::detail::to_bits<double, lanes>(x.vector()) &
                                                   Word(0x7ff0000000000000));
  }
  [[nodiscard]] const F& operand(std::int32_t i) const noexcept {
    return values_[static_cast<std::size_t>(i)];
  }

  void forward(std::size_t k) noexcept {
    const Step& s = steps_[k];
    const std::size_t n = reach_[first_ + k];
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
        v.set(each(a.range, [](const Enclosure& x) { return tanh(x); }), n);
        break;
      case TapeOp::sqrt:
        v.set(each(a.range, [](const Enclosure& x) { return sqrt(x); }), n);
        break;
      case TapeOp::exp:
        v.set(each(a.range, [](const Enclosure& x) { return exp(x); }), n);
        break;
      case TapeOp::abs:
        v.set(each(a.range, [](const Enclosure& x) { return abs(x); }), n);
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
      units_[first_ + k] = turns ? turning(In::turning, v.range) : L(In::tanh);
      in_double_[first_ + k] = turns ? turning(Id::turning, v.range) : L(Id::tanh);
      v.widen(units_[first_ + k]);
    } else {
      L& units = units_[first_ + k];
      units = power_of_two_below(v.largest()) + L(eta);
      if (s.op == TapeOp::exp) units = L(3.0) * units;
      v.widen(L(unit<float>) * units);
    }
  }
  static void negative(const F& a, F& y, std::size_t n) noexcept {
    y.range = -a.range;
    y.centre = -a.centre, y.rest = a.rest, y.radius = a.radius;
    for (std::size_t i = 0; i < n; ++i) y.slope[i] = -a.slope[i];
  }
  /// Adds `x`, times 1 or -1, to the adjoint of an operand.
  void give(std::int32_t to, const F& x, double sign = 1) noexcept {
    const auto i = static_cast<std::size_t>(to);
    if (!carries_[i]) return;
    F& adjoint = adjoints_[i];
    const std::size_t n = seen_[i];
    if (reached_[i]) {
      add(adjoint, sign, x, sum_, n);
    } else if (sign > 0) {
      sum_.range = x.range;
      sum_.centre = x.centre, sum_.rest = x.rest, sum_.radius = x.radius;
      for (std::size_t j = 0; j < n; ++j) sum_.slope[j] = x.slope[j];
    } else {
      negative(x, sum_, n);
    }
    reached_[i] = 1;
    adjoint.range = sum_.range;
    adjoint.centre = sum_.centre, adjoint.rest = sum_.rest, adjoint.radius = sum_.radius;
    for (std::size_t j = 0; j < n; ++j) adjoint.slope[j] = sum_.slope[j];
  }
  /// Adds `x` times a value.
  void give_times(std::int32_t to, const F& x, const F& factor, double sign = 1) noexcept {
    if (!carried(to)) return;
    multiply(x, factor, product_, seen_[static_cast<std::size_t>(to)]);
    give(to, product_, sign);
  }
  void give_times(std::int32_t to, const F& x, const E& factor, double sign = 1) noexcept {
    if (!carried(to)) return;
    multiply(x, factor, product_, seen_[static_cast<std::size_t>(to)]);
    give(to, product_, sign);
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
          give_times(s.a, x, each(operand(s.a).range, [](const Enclosure& a) {
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

  struct Decision {
    std::int32_t a, b;
    bool less;
  };
  std::vector<std::size_t> inputs_;
  std::vector<Fixed> constants_;
  std::vector<Step> steps_;
  std::vector<Decision> decisions_;
  std::vector<char> carries_;  // whether an error can come from there
  std::vector<F> values_, adjoints_;
  ErrorSum units_sum_, float_sum_, double_sum_;
  std::vector<L> units_, in_double_;  // an operation's own error: in units, or of a kernel
  std::vector<L> slopes_;
  std::vector<std::size_t> reach_, seen_;
  std::vector<char> reached_;  // whether an adjoint is written
  F product_, sum_;
  std::size_t first_ = 0, result_ = 0;
};

}  // namespace math
SKINCTL_END_NAMESPACE
