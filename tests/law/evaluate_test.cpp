#include "skinctl/law/evaluate.hpp"

#include <doctest/doctest.h>

#include <cmath>
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
  static constexpr LawRole role = LawRole::tracking;
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
            Reason::bumpless_transfer};
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
  CHECK(e.status.has(Reason::bumpless_transfer));
}

namespace {
/// What a robot that stands or moves knows, gravity included.
struct Weighty {
  static constexpr std::size_t joints = 2;
  using scalar = double;
  JointTorque<2> weight{5.0, 7.0};
  JointVelocity<2> velocity{0.1, -0.2};
  const JointTorque<2>& gravity() const noexcept { return weight; }
  const JointVelocity<2>& dq() const noexcept { return velocity; }
};
struct Constant : StatelessLaw<Constant> {
  JointTorque<2> torque(const auto&) const noexcept { return {1.0, 2.0}; }
};
struct InParts : StatelessLaw<InParts> {
  static constexpr LawRole role = LawRole::tracking;
  TorqueParts<2> parts(const auto&) const noexcept { return {{1.0, 2.0}, {10.0, 20.0}}; }
};
struct Reports : Constant {
  Status status(const Memory&) const noexcept { return Reason::slowed; }
  bool settled(const Memory&, const Weighty&, double still) const noexcept { return still > 1; }
};
}  // namespace

TEST_CASE("torque_of: a law without memory, and a tracking law by its parts with gravity once") {
  CHECK(torque_of(Constant{}, {}, Weighty{}) == JointTorque<2>{1.0, 2.0});
  CHECK(torque_of(InParts{}, {}, Weighty{}) == JointTorque<2>{16.0, 29.0});
  const LawShare<double> share{0.5, 2.0};
  using detail::weighted_torque;
  CHECK(weighted_torque<GravityTerm::left_out>(InParts{}, {}, Weighty{}, share) ==
        JointTorque<2>{20.5, 41.0});
  CHECK(weighted_torque<GravityTerm::included>(InParts{}, {}, Weighty{}, share) ==
        JointTorque<2>{30.5, 55.0});
  CHECK(evaluate(InParts{}, {}, Weighty{}, 0.002).torque == JointTorque<2>{16.0, 29.0});
}

TEST_CASE("status_of, settled: what a law says, or nothing, and whether the robot stands") {
  CHECK_FALSE(status_of(Constant{}, {}).any());
  CHECK(status_of(Reports{}, {}).has(Reason::slowed));
  CHECK(evaluate(Reports{}, {}, Weighty{}, 0.002).status.has(Reason::slowed));
  CHECK(settled(Constant{}, {}, Weighty{}, 0.21));
  CHECK_FALSE(settled(Constant{}, {}, Weighty{}, 0.19));
  CHECK_FALSE(settled(Constant{}, {}, Weighty{{}, {0.0, std::nan("")}}, 0.21));
  CHECK_FALSE(settled(Reports{}, {}, Weighty{}, 0.21));
  CHECK(settled(Reports{}, {}, Weighty{}, 1.5));
}
