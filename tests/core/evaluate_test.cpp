#include "skinctl/core/evaluate.hpp"

#include <doctest/doctest.h>

#include <type_traits>

using namespace skinctl;

namespace {
/// As much of `Quantities` as the laws below ask for.
struct Knowledge {
  static constexpr std::size_t joints = 2;
  using scalar = double;
  double x = 0;
};

/// Counts its evaluations, and gives the count.
struct Counter {
  struct Memory {
    int count;
  };
  static constexpr Needs needs{};
  static constexpr Role role = Role::tracking;
  Memory start(const Knowledge&) const noexcept { return {0}; }
  JointTorque<2> torque(const Memory& m, const Knowledge& k) const noexcept { return {double(m.count), k.x}; }
  Memory advance(const Memory& m, const Knowledge&, double dt, Opposition o) const noexcept {
    return {m.count + (o == Opposition::none && dt > 0 ? 1 : 100)};
  }
};
static_assert(Law<Counter, Knowledge> && terms_of<Counter> == 1);

/// The same with an evaluation of its own, in two terms.
struct Pair : Counter {
  static constexpr std::size_t terms = 2;
  Evaluation<2, double, Memory, 2> evaluate(const Memory& m, const Knowledge& k, double) const noexcept {
    return {torque(m, k),
            {m.count + 10},
            {JointTorque<2>{double(m.count), 0.0}, JointTorque<2>{0.0, k.x}},
            Reason::hand_over};
  }
};
static_assert(terms_of<Pair> == 2);
static_assert(std::is_trivially_copyable_v<Evaluation<2, double, Counter::Memory, 1>>);
}  // namespace

TEST_CASE("evaluate: a plain law gives its torque as its only share, and its memory advanced") {
  const Counter law;
  const auto e = evaluate(law, Counter::Memory{4}, Knowledge{1.5}, 0.002);
  CHECK(e.torque == JointTorque<2>{4.0, 1.5});
  CHECK(e.shares[0] == e.torque);
  CHECK(e.memory.count == 5);
  CHECK_FALSE(e.status.any());
}

TEST_CASE("evaluate: a law's own evaluation is preferred") {
  const Pair law;
  const auto e = evaluate(law, Counter::Memory{4}, Knowledge{1.5}, 0.002);
  CHECK(e.memory.count == 14);
  CHECK(e.shares[0] + e.shares[1] == e.torque);
  CHECK(e.status.has(Reason::hand_over));
}
