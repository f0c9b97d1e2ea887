// The part of a tape that one result depends on, ready to be evaluated.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "bench/studies/proofs/bound.hpp"
#include "bench/studies/proofs/lane_form.hpp"
#include "bench/studies/proofs/tape.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math::detail {

/// The operations of a tape on which one result depends, with its inputs first, then constants, then
/// operations in order. What does not depend on an input is a constant with an error, computed once.
class TapeSlice {
 protected:
  struct Step {
    TapeOp op;
    bool rounded;
    std::int32_t a, b;
  };
  struct Decision {
    std::int32_t a, b;
    bool less;
  };
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

  TapeSlice(const Tape& tape, std::int32_t node) {
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
    // Which inputs a value, or an adjoint, depends on at most.
    std::vector<std::vector<char>> reach(first_ + steps_.size(), std::vector<char>(inputs_.size(), 0));
    auto seen = reach;
    const auto join = [](std::vector<char>& to, const std::vector<char>& from) {
      for (std::size_t i = 0; i < to.size(); ++i) to[i] |= from[i];
    };
    for (std::size_t k = 0; k < inputs_.size(); ++k) reach[k][k] = 1;
    for (std::size_t k = 0; k < steps_.size(); ++k)
      for (const std::int32_t from : {steps_[k].a, steps_[k].b})
        if (from >= 0) join(reach[first_ + k], reach[at(from)]);
    for (std::size_t k = steps_.size(); k-- > 0;) {
      const Step& s = steps_[k];
      for (const std::int32_t to : {s.a, s.b}) {
        if (to < 0) continue;
        join(seen[at(to)], seen[first_ + k]);
        const std::int32_t factor = to == s.a ? s.b : s.a;
        if (s.op == TapeOp::multiply) join(seen[at(to)], reach[at(factor)]);
        if (s.op == TapeOp::exp) join(seen[at(to)], reach[first_ + k]);
      }
    }
    const auto listed = [](const std::vector<std::vector<char>>& sets) {
      std::vector<std::vector<std::uint16_t>> out;
      for (const auto& set : sets) {
        out.emplace_back();
        for (std::size_t i = 0; i < set.size(); ++i)
          if (set[i]) out.back().push_back(static_cast<std::uint16_t>(i));
      }
      return out;
    };
    reach_ = listed(reach), seen_ = listed(seen);
  }

  [[nodiscard]] static InputSet set(const std::vector<std::uint16_t>& of) noexcept {
    return {of.data(), of.size()};
  }

  std::vector<std::size_t> inputs_;
  std::vector<Fixed> constants_;
  std::vector<Step> steps_;
  std::vector<Decision> decisions_;
  std::vector<char> carries_;  // whether an error can come from there
  std::vector<std::vector<std::uint16_t>> reach_,
      seen_;                            // the inputs on which a value, or an adjoint, may depend
  std::size_t first_ = 0, result_ = 0;  // place of the first operation, and of the result
};

}  // namespace math::detail
SKINCTL_END_NAMESPACE
