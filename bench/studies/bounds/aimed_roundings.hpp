// Inputs whose roundings add up: chosen one input at a time, for the signs of the errors that it decides.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

#include "bench/studies/proofs/tape.hpp"
#include "skinctl/math/sincos.hpp"
#include "skinctl/math/tanh.hpp"

namespace skinctl::bounds {

/// A sum over results of a tape: node and weight.
using WeightedResults = std::vector<std::pair<std::int32_t, double>>;

/// A program near a state: recorded there, with the inputs that it has in `R`.
template <class R>
struct ProgramNear {
  math::Tape tape;
  std::vector<WeightedResults> results;  ///< whose errors are searched
  std::vector<R> inputs;
  std::vector<std::size_t> order;  ///< of the inputs: those first that early operations need
  std::vector<double> reach;       ///< how far an input may be from that of the state
};

/// Near a state the error of a result is `sum_k adjoint_k delta_k`: the adjoints hardly change, and each
/// delta_k, the rounding of operation k, comes as it likes with the last digits of the inputs on which the
/// operation depends. So inputs are taken in the order in which the program needs them (a beam search): of
/// many numbers for the first one those stay for which the operations that it alone decides add up to most,
/// of many for the second one likewise, and so on. By trial of all inputs at once the largest of n sums grows
/// with the root of the number of operations times log n; so it does for each input's share.
///
/// The tape is replayed in `R`, operation by operation: as the program runs without fused products
/// (`skinctl::exact`).
template <class R>
class AimedRoundings {
 public:
  explicit AimedRoundings(const ProgramNear<R>& program)
      : program_(program), turns_(program.order.size() + 1) {
    const auto& nodes = program.tape.nodes();
    const auto& order = program.order;
    std::vector<std::size_t> turn(nodes.size(),
                                  0);  // 0: a constant; k + 1: known with the k-th input of the order
    for (std::size_t k = 0; k < order.size(); ++k) turn[at(program.tape.inputs()[order[k]])] = k + 1;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      for (const std::int32_t from : {nodes[i].a, nodes[i].b})
        if (from >= 0) turn[i] = std::max(turn[i], turn[at(from)]);
      turns_[turn[i]].nodes.push_back(i);
    }
    for (std::size_t t = 0; t < turns_.size(); ++t) {
      auto& before = turns_[t].before;
      if (t > 0) turns_[t].input = order[t - 1];
      for (const std::size_t i : turns_[t].nodes)
        for (const std::int32_t from : {nodes[i].a, nodes[i].b})
          if (from >= 0 && turn[at(from)] < t) before.push_back(at(from));
      std::sort(before.begin(), before.end());
      before.erase(std::unique(before.begin(), before.end()), before.end());
    }
  }

  /// Inputs within reach whose error of result number `result` is large in the direction of `sign`.
  template <class Random>
  [[nodiscard]] std::vector<R> largest(std::size_t result, double sign, Random& random) const {
    const auto& x = program_.inputs;
    const auto& reach = program_.reach;
    std::vector<double> adjoints = derivatives(program_.results[result]);
    for (double& a : adjoints) a *= sign;
    std::uniform_real_distribution<double> around(-1, 1);
    std::vector<Row> values(program_.tape.nodes().size());
    std::vector<Choice> beam(1), next;
    beam[0] = {0, x, std::vector<R>(values.size())};
    std::vector<Candidate> candidates;
    for (const Turn& turn : turns_) {
      const bool constants = &turn == turns_.data();
      const std::size_t kept = constants ? 1 : widest, tried = constants ? 1 : kept * trials / beam.size();
      candidates.clear();
      for (const Choice& choice : beam)
        for (std::size_t k = 0; k < tried; k += lanes) {
          Row input{};
          if (!constants)
            for (R& y : input)
              y = static_cast<R>(static_cast<double>(x[turn.input]) + reach[turn.input] * around(random));
          const auto sums = replay(turn, choice, input, adjoints, values);
          for (std::size_t w = 0; w < lanes; ++w)
            candidates.push_back({choice.sum + sums[w], &choice, input[w]});
        }
      const auto left = static_cast<std::ptrdiff_t>(std::min(kept, candidates.size()));
      std::partial_sort(candidates.begin(), candidates.begin() + left, candidates.end(),
                        [](const Candidate& a, const Candidate& b) { return a.sum > b.sum; });
      next.clear();
      for (auto best = candidates.begin(); best != candidates.begin() + left; ++best) {
        next.push_back(*best->before);
        next.back().sum = best->sum;
        if (!constants) next.back().x[turn.input] = best->input;
        Row input;
        input.fill(best->input);
        replay(turn, *best->before, input, adjoints, values);
        for (const std::size_t i : turn.nodes) next.back().values[i] = values[i][0];
      }
      beam.swap(next);
    }
    return beam[0].x;
  }

 private:
  /// How many choices of the inputs so far stay, and how many numbers of the next one are tried with each.
  static constexpr std::size_t widest = 64, trials = 256, lanes = 16;
  using Row = std::array<R, lanes>;
  /// What one more input decides.
  struct Turn {
    std::size_t input = 0;
    std::vector<std::size_t> nodes, before;  ///< operations, and their operands from earlier turns
  };
  struct Choice {
    double sum = 0;
    std::vector<R> x, values;
  };
  struct Candidate {
    double sum;
    const Choice* before;
    R input;
  };
  static std::size_t at(std::int32_t i) noexcept { return static_cast<std::size_t>(i); }

  /// Of a result after each node.
  [[nodiscard]] std::vector<double> derivatives(const WeightedResults& result) const {
    const auto& nodes = program_.tape.nodes();
    std::vector<double> v(nodes.size()), adjoints(nodes.size(), 0);
    for (std::size_t i = 0, input = 0; i < nodes.size(); ++i) {
      const auto& n = nodes[i];
      if (n.op == math::TapeOp::input)
        v[i] = static_cast<double>(program_.inputs[input++]);
      else if (n.op == math::TapeOp::constant)
        v[i] = n.number;
      else
        v[i] = value(n.op, v[at(n.a)], n.b < 0 ? 0 : v[at(n.b)]);
    }
    for (const auto& [node, weight] : result) adjoints[at(node)] += weight;
    for (std::size_t i = nodes.size(); i-- > 0;) {
      const auto& n = nodes[i];
      if (n.a < 0 || adjoints[i] == 0) continue;
      const auto [by_a, by_b] = slopes(n.op, v[at(n.a)], n.b < 0 ? 0 : v[at(n.b)], v[i]);
      adjoints[at(n.a)] += adjoints[i] * by_a;
      if (n.b >= 0) adjoints[at(n.b)] += adjoints[i] * by_b;
    }
    return adjoints;
  }
  template <class T>
  static T value(math::TapeOp op, T a, T b) {
    using enum math::TapeOp;
    switch (op) {
      case add:
        return a + b;
      case subtract:
        return a - b;
      case multiply:
        return a * b;
      case divide:
        return a / b;
      case negate:
        return -a;
      case sqrt:
        return std::sqrt(a);
      case sin:
        return math::sincos(a).sin;
      case cos:
        return math::sincos(a).cos;
      case tanh:
        return math::tanh(a);
      case exp:
        return std::exp(a);
      case abs:
        return std::abs(a);
      default:
        return a;
    }
  }
  /// Derivatives of `y = op(a, b)` after a and b.
  static std::pair<double, double> slopes(math::TapeOp op, double a, double b, double y) {
    using enum math::TapeOp;
    switch (op) {
      case add:
        return {1, 1};
      case subtract:
        return {1, -1};
      case multiply:
        return {b, a};
      case divide:
        return {1 / b, -y / b};
      case negate:
        return {-1, 0};
      case sqrt:
        return {0.5 / y, 0};
      case sin:
        return {std::cos(a), 0};
      case cos:
        return {-std::sin(a), 0};
      case tanh:
        return {1 - y * y, 0};
      case exp:
        return {y, 0};
      case abs:
        return {a < 0 ? -1 : 1, 0};
      default:
        return {0, 0};
    }
  }
  /// `y - op(a, b)` of a rounded y.
  static double rounding(math::TapeOp op, R a, R b, R y) {
    using enum math::TapeOp;
    const double u = static_cast<double>(a), w = static_cast<double>(b), v = static_cast<double>(y);
    switch (op) {
      case add:
        if constexpr (std::is_same_v<R, float>) {
          return v - (u + w);
        } else {
          const double part = v - u;  // Knuth: exact
          return (v - part - u) - (w - part);
        }
      case subtract:
        return rounding(add, a, -b, y);
      case multiply:
        return std::fma(-u, w, v);
      case divide:
        return std::fma(v, w, -u) / w;
      case sqrt:
        return std::fma(v, v, -u) / (2 * v);
      case sin:
        return static_cast<double>(v - std::sin(static_cast<long double>(a)));
      case cos:
        return static_cast<double>(v - std::cos(static_cast<long double>(a)));
      default:
        return 0;
    }
  }
  /// The operations of a turn after `before`, for several numbers of its input: values, and the sums of
  /// errors.
  std::array<double, lanes> replay(const Turn& turn, const Choice& before, const Row& input,
                                   const std::vector<double>& adjoints, std::vector<Row>& values) const {
    std::array<double, lanes> sums{};
    for (const std::size_t i : turn.before) values[i].fill(before.values[i]);
    for (const std::size_t i : turn.nodes) {
      const auto& n = program_.tape.nodes()[i];
      Row& y = values[i];
      if (n.op == math::TapeOp::input) {
        y = input;
        continue;
      }
      if (n.op == math::TapeOp::constant) {
        y.fill(static_cast<R>(n.number));
        for (double& s : sums) s += adjoints[i] * (static_cast<double>(y[0]) - n.number);
        continue;
      }
      const Row &a = values[at(n.a)], &b = values[at(n.b < 0 ? n.a : n.b)];
      const auto each = [&](auto op) {
        for (std::size_t w = 0; w < lanes; ++w) {
          y[w] = value(op, a[w], b[w]);
          sums[w] += adjoints[i] * rounding(op, a[w], b[w], y[w]);
        }
      };
      using enum math::TapeOp;
      switch (n.op) {  // the frequent ones as constants: the loop runs in vectors
        case add:
          each(std::integral_constant<math::TapeOp, add>{});
          break;
        case subtract:
          each(std::integral_constant<math::TapeOp, subtract>{});
          break;
        case multiply:
          each(std::integral_constant<math::TapeOp, multiply>{});
          break;
        default:
          each(n.op);
      }
    }
    return sums;
  }

  const ProgramNear<R>& program_;
  std::vector<Turn> turns_;
};

}  // namespace skinctl::bounds
