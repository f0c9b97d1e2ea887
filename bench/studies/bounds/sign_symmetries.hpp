// Symmetries of a traced program that change nothing but signs: a part of its states is bounded for all of
// them.
#pragma once

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "bench/studies/bounds/box_search.hpp"
#include "bench/studies/proofs/tape.hpp"

namespace skinctl::bounds {

/// The changes of signs that leave the bound of a result as it is, and a part of the states that stands for
/// all of them.
///
/// Half a turn of a joint changes the signs of its sine and its cosine, a mirrored angle that of one of them.
/// Where changes of the inputs change nothing but the signs of a program's values, the bound of its error is
/// the same after as before: it depends on magnitudes. The sign of a product changes with those of its
/// factors, and the operands of a sum must change theirs together: linear equations over the field of two
/// elements. Each independent solution halves the states.
class SignSymmetries {
 public:
  /// @param node    the result.
  /// @param ranges  of the inputs: angles a turn around zero, others as far to either side of it. Those are
  ///                halved first that a search of boxes splits most.
  SignSymmetries(const math::Tape& tape, std::int32_t node, const std::vector<Range>& ranges)
      : inputs_(ranges.size()) {
    const auto& nodes = tape.nodes();
    std::vector<char> needed(nodes.size(), 0), plain(nodes.size(), 0);
    needed[at(node)] = 1;
    for (const auto& d : tape.decisions()) needed[at(d.a)] = needed[at(d.b)] = 1;
    for (std::size_t i = nodes.size(); i-- > 0;)
      for (const std::int32_t from : {nodes[i].a, nodes[i].b})
        if (needed[i] && from >= 0) {
          needed[at(from)] = 1;
          plain[at(from)] |= nodes[i].op != math::TapeOp::sin && nodes[i].op != math::TapeOp::cos;
        }
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < ranges.size(); ++k)
      if (needed[at(tape.inputs()[k])]) order.push_back(k);
    const auto split = [&](std::size_t k) { return ranges[k].split ? ranges[k].weight : 0; };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return split(a) > split(b); });
    std::vector<Value> values(nodes.size());
    for (const std::size_t k : order) {
      const std::size_t i = at(tape.inputs()[k]);
      inputs_[k] = {bits_, plain[i] ? 1u : 2u};
      values[i].angle = !plain[i];
      if (bits_ + inputs_[k].count > most_bits)
        throw std::length_error("SignSymmetries: more than 128 signs of inputs");
      values[i].sign.set(bits_);
      bits_ += inputs_[k].count;
    }
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (needed[i] && nodes[i].op != math::TapeOp::input) values[i] = changed(nodes[i], values);
    for (const auto& d : tape.decisions()) unchanged(values[at(d.a)].sign), unchanged(values[at(d.b)].sign);
  }

  /// How many independent ones there are.
  [[nodiscard]] std::size_t count() const noexcept { return bits_ - equations_.size(); }

  /// A part of the states that holds, for each state, one with the same bound.
  [[nodiscard]] std::vector<Range> reduced(std::vector<Range> ranges) const {
    constexpr double quarter_turn = 1.5708;  // and a little more
    for (std::size_t k = 0; k < ranges.size(); ++k) {
      const auto& [first, count] = inputs_[k];
      math::Enclosure& x = ranges[k].whole;
      if (count == 2 && chosen(first + 1)) x = {-quarter_turn, quarter_turn};
      if (count > 0 && chosen(first)) x.low = 0;
    }
    return ranges;
  }
  /// The state of that part which has the same bound as `x`.
  [[nodiscard]] std::vector<double> image(std::vector<double> x) const {
    constexpr double half = 3.141592653589793;
    Bits flips;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const auto& [first, count] = inputs_[k];
      if (count > 0 && chosen(first)) flips[first] = (count == 2 ? std::sin(x[k]) : x[k]) < 0;
      if (count == 2 && chosen(first + 1)) flips[first + 1] = std::cos(x[k]) < 0;
    }
    const Bits free = flips;
    for (const Equation& e : equations_) flips[e.unknown] = (e.row & free).count() % 2 == 1;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const auto& [first, count] = inputs_[k];
      const bool sign = count > 0 && flips[first], cosine = count == 2 && flips[first + 1];
      if (sign != cosine) x[k] = -x[k];
      if (cosine) x[k] += x[k] > 0 ? -half : half;
    }
    return x;
  }

 private:
  static constexpr std::size_t most_bits = 128;
  using Bits = std::bitset<most_bits>;
  /// How the sign of a value follows from what is changed.
  struct Value {
    Bits sign;
    bool zero = false, angle = false;
  };
  struct Input {
    std::size_t first = 0, count = 0;  ///< an angle has two: of its sine and its cosine
  };
  static std::size_t at(std::int32_t i) noexcept { return static_cast<std::size_t>(i); }

  Value changed(const math::Tape::Node& n, const std::vector<Value>& of) {
    using enum math::TapeOp;
    if (n.op == constant) return {{}, n.number == 0, false};
    const Value& a = of[at(n.a)];
    const Value& b = of[at(n.b < 0 ? n.a : n.b)];
    switch (n.op) {
      case add:
      case subtract:
        if (a.zero) return b;
        if (!b.zero) unchanged(a.sign ^ b.sign);
        return a;
      case multiply:
      case divide:
        return {a.sign ^ b.sign, a.zero || b.zero, false};
      case sin:
        return {a.sign, false, false};
      case cos:
        return {a.angle ? a.sign << 1 : Bits(), false, false};
      case negate:
      case tanh:
        return a;
      case abs:
        return {};
      default:
        unchanged(a.sign);
        return {};
    }
  }
  /// One more equation, whose last unknown is eliminated from the others.
  void unchanged(Bits row) {
    for (const Equation& e : equations_)
      if (row[e.unknown]) row ^= e.row;
    if (row.none()) return;
    std::size_t last = most_bits - 1;
    while (!row[last]) --last;
    for (Equation& e : equations_)
      if (e.row[last]) e.row ^= row;
    equations_.push_back({row, last});
  }
  /// Whether this sign may be chosen: those of the other unknowns follow.
  [[nodiscard]] bool chosen(std::size_t bit) const noexcept {
    for (const Equation& e : equations_)
      if (e.unknown == bit) return false;
    return true;
  }

  struct Equation {
    Bits row;
    std::size_t unknown;
  };
  std::vector<Input> inputs_;
  std::vector<Equation> equations_;
  std::size_t bits_ = 0;
};

}  // namespace skinctl::bounds
