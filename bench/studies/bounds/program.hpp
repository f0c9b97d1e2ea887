// A quantity of a robot as a program whose errors are searched and bounded.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "bench/studies/bounds/aimed_roundings.hpp"
#include "bench/studies/bounds/box_search.hpp"
#include "bench/studies/bounds/quantities.hpp"
#include "bench/studies/proofs/traced.hpp"

namespace skinctl::bounds {

/// A little more than pi.
inline constexpr double half_turn = 3.1416;

/// The states: joint by joint its angle and its rates, of which the velocities are split.
inline std::vector<Range> ranges_of(Quantity q, std::size_t joints, const Rates& rates) {
  std::vector<Range> out;
  for (std::size_t i = 0; i < joints; ++i) {
    out.push_back({{-half_turn, half_turn}, true});
    for (std::size_t k = 0; k < named(q).rates; ++k) {
      const double most = k == 1 ? rates.acceleration : rates.velocity;
      out.push_back({{-most, most}, k == 0, 0.06f});
    }
  }
  return out;
}

/// Quantity `Q` of a robot in `R`: traced over all states or near one, and its errors.
template <class Robot, Quantity Q, class R>
class Program {
  using Wide = std::conditional_t<std::is_same_v<R, float>, double, long double>;
  using Traced = math::Traced<R>;
  static constexpr std::size_t joints = decltype(Robot::template in<R>())::joints;
  static constexpr bool solves = Q == Quantity::forward_dynamics;

 public:
  Program(const std::vector<Range>& ranges, const Rates& rates) : ranges_(ranges), rates_(rates) {}

  /// The nodes of the results over all states.
  std::vector<std::int32_t> record(math::Tape& tape) const {
    std::vector<math::Enclosure> inputs;
    for (const Range& r : ranges_) inputs.push_back(r.whole);
    return traced(tape, inputs, [](const Traced* x) { return computed<Q>(Robot::template in<Traced>(), x); });
  }
  /// At a state: joint by joint its angle and its rates. Forward dynamics have the torques as inputs in place
  /// of the accelerations, and M times the acceleration as results.
  [[nodiscard]] ProgramNear<R> near(std::vector<R> x) const {
    constexpr double share = 1e-4;
    ProgramNear<R> out;
    std::vector<math::Enclosure> inputs;
    const auto input = [&](double reach) {
      const auto at = static_cast<double>(out.inputs[inputs.size()]);
      out.reach.push_back(reach);
      inputs.push_back({at - reach, at + reach});
    };
    // The recursion of M begins at the tips, the others at the base.
    const bool from_tips = solves || Q == Quantity::mass;
    if constexpr (solves) {
      // So that no acceleration leaves its range, by other torques or, in float, by its own error.
      for (std::size_t i = 2; i < x.size(); i += 3) x[i] *= R(0.9);
      out.inputs = with_torques(model(), x.data());
      JointPosition<joints, R> q;
      for (std::size_t i = 0; i < joints; ++i) q[i] = x[3 * i];
      const auto mass = mass_matrix(model(), q);
      for (std::size_t i = 0; i < joints; ++i) input(share * 2 * half_turn);
      for (std::size_t i = 0; i < joints; ++i) input(share * 2 * rates_.velocity);
      for (std::size_t i = 0; i < joints; ++i)
        input(share * rates_.acceleration * static_cast<double>(mass(i, i)));
      const auto nodes = traced(
          out.tape, inputs, [](const Traced* y) { return acceleration(Robot::template in<Traced>(), y); });
      out.results.resize(joints);
      for (std::size_t i = 0; i < joints; ++i)
        for (std::size_t j = 0; j < joints; ++j)
          out.results[i].emplace_back(nodes[j], static_cast<double>(mass(i, j)));
    } else {
      out.inputs = x;
      for (const Range& r : ranges_) input(share * r.whole.width());
      for (const auto node : traced(out.tape, inputs, [](const Traced* y) {
             return computed<Q>(Robot::template in<Traced>(), y);
           }))
        out.results.push_back({{node, 1.0}});
    }
    for (std::size_t i = 0; i < inputs.size(); ++i)
      out.order.push_back(from_tips && i < joints ? joints - 1 - i : i);
    return out;
  }
  /// Of each result at the inputs of `near`.
  [[nodiscard]] std::vector<double> errors(const std::vector<R>& x) const {
    static const auto wide = Robot::template in<Wide>();
    if constexpr (solves) {
      return unexplained_torque<R, Wide>(model(), wide, x.data(), rates_.acceleration);
    } else {
      const std::vector<Wide> more(x.begin(), x.end());
      const auto y = computed<Q>(model(), x.data());
      const auto z = computed<Q>(wide, more.data());
      std::vector<double> out;
      for (std::size_t i = 0; i < y.size(); ++i)
        out.push_back(static_cast<double>(static_cast<Wide>(y[i]) - z[i]));
      return out;
    }
  }

 private:
  static const auto& model() {
    static const auto model = Robot::template in<R>();
    return model;
  }
  template <class F>
  static std::vector<std::int32_t> traced(math::Tape& tape, const std::vector<math::Enclosure>& inputs,
                                          F&& f) {
    const math::Tape::Recording recording(tape);
    std::vector<Traced> x;
    for (const auto& range : inputs) x.push_back(Traced::input(range));
    std::vector<std::int32_t> nodes;
    for (const auto& y : f(x.data())) nodes.push_back(y.node());
    return nodes;
  }

  const std::vector<Range>& ranges_;
  const Rates& rates_;
};

}  // namespace skinctl::bounds
