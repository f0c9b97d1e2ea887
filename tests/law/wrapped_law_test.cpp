#include <doctest/doctest.h>

#include "skinctl/skinctl.hpp"
#include "skinctl/trajectory/detail/carrying_law.hpp"

using namespace skinctl;

namespace {
/// What a robot of two joints knows.
struct Known {
  static constexpr std::size_t joints = 2;
  using scalar = double;
  JointTorque<2> weight{5.0, 7.0};
  JointVelocity<2> velocity{0.1, -0.2};
  const JointTorque<2>& gravity() const noexcept { return weight; }
  const JointVelocity<2>& dq() const noexcept { return velocity; }
  double dt() const noexcept { return 0.002; }
};
struct Terms {
  int asked = 0;
};
struct Place {
  double where = 0;
};

/// A law with nothing that is optional.
template <int Number = 0>
struct Bare : Composable {
  struct Memory {
    double time = -1;
  };
  static constexpr Needs needs{};
  static constexpr LawRole role = LawRole::tracking;
  template <class K>
  Memory start(const K&) const noexcept {
    return {0};
  }
  template <class K>
  TorqueParts<2> parts(const Memory& m, const K&) const noexcept {
    return {{1.0, m.time}, {10.0, 20.0}};
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double dt, Opposition) const noexcept {
    return {m.time + dt};
  }
};
/// A law with all that is optional.
struct Full : Composable {
  struct Memory {
    double time = 0, goal = 0;
  };
  using scalar = double;
  using Goal = Place;
  static constexpr std::size_t joints = 2;
  static constexpr Needs needs{};
  static constexpr LawRole role = LawRole::tracking;
  static constexpr const char* name = "full";
  static constexpr bool presses = true, compensates_friction = true, starts_blank = true;
  Terms* terms_seen = nullptr;

  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  double now(const Memory& m, const K&) const noexcept {
    return m.time + 1;
  }
  template <GravityTerm G = GravityTerm::included, class K>
  JointTorque<2> torque(const Memory&, const K& known, const LawShare<double>& share,
                        double now) const noexcept {
    JointTorque<2> tau{share.feedback * now, share.feed_forward * 10};
    if (G == GravityTerm::included) tau += share.feed_forward * known.gravity();
    return tau;
  }
  template <GravityTerm G = GravityTerm::included, class K>
  JointTorque<2> torque(const Memory& m, const K& known, const LawShare<double>& share = {}) const noexcept {
    return torque<G>(m, known, share, now(m, known));
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double dt, Opposition, double now) const noexcept {
    return {now - 1 + dt, m.goal};
  }
  template <class K>
  Memory advance(const Memory& m, const K& known, double dt, Opposition o) const noexcept {
    return advance(m, known, dt, o, now(m, known));
  }
  template <class K>
  Received<Memory> receive(const Memory& m, const K&, const Goal& goal) const noexcept {
    return {{m.time, goal.where}, Reason::goal_stretched};
  }
  template <class K>
  Received<Memory> follow(const Memory& m, const K&, const Goal& goal) const noexcept {
    return {{m.time, goal.where + 100}, {}};
  }
  struct Distance {
    double position, orientation, joint;
  };
  template <class K>
  Distance distance(const K&, const Goal& goal) const noexcept {
    return {goal.where, 0, 0};
  }
  Status status(const Memory&) const noexcept { return Reason::slowed; }
  template <class K>
  bool settled(const Memory& m, const K&, double still) const noexcept {
    return m.time < still;
  }
  void check_for(const Terms&) const { ++terms_seen->asked; }
};
/// A wrapper that changes nothing but its memory.
template <class L>
struct Passing : WrappedLaw<Passing<L>, L> {
  struct Memory : L::Memory {
    int count = 0;
  };
  explicit Passing(const L& law) : WrappedLaw<Passing, L>(law) {}
  void moved_on(Memory& next, const auto&...) const noexcept { ++next.count; }
};
/// One that halves the torque of feedback and feed-forward.
template <class L>
struct Halved : WrappedLaw<Halved<L>, L> {
  struct Memory : L::Memory {};
  explicit Halved(const L& law) : WrappedLaw<Halved, L>(law) {}
  template <GravityTerm>
  JointTorque<2> changed(const JointTorque<2>& tau, const auto&...) const noexcept {
    return 0.5 * tau;
  }
};

/// Which rows of the table a law has.
template <class L, class K = Known>
constexpr unsigned rows() {
  using Table = LawTable<L>;
  constexpr bool found[] = {detail::HasStatus<L>,
                            detail::HasSettled<L, K>,
                            detail::Receives<L, K, Place>,
                            detail::HasDistance<L, K, Place>,
                            Table::presses,
                            Table::joints == 2,
                            Table::compensates_friction,
                            detail::ChecksTerms<L, Terms>,
                            Table::starts_blank};
  unsigned bits = 0;
  for (unsigned k = 0; k < std::size(found); ++k) bits |= found[k] ? 1u << k : 0u;
  return bits;
}
constexpr unsigned all_rows = (1u << 9) - 1, distance_row = 8, presses_row = 16;
template <class L>
constexpr bool in_order = detail::fault_in_members<L>() == detail::LawFault::none;

using Carrying = detail::CarryingLaw<2, Full, double>;
using Opened = Gated<TouchGate::touched, Full>;
using Over = NullSpace<1, Full, Bare<>>;
using Behind = NullSpace<1, Bare<>, Full>;
using Two = Fused<Sum::normalised, Full, Bare<>>;

static_assert(rows<Bare<>>() == 0 && rows<Full>() == all_rows);
static_assert(rows<Passing<Bare<>>>() == 0 && rows<Passing<Full>>() == all_rows);
static_assert(rows<Passing<Passing<Full>>>() == all_rows && rows<Halved<Full>>() == all_rows);
static_assert(rows<Carrying>() == all_rows && rows<Opened>() == all_rows);
static_assert(rows<Passing<Opened>>() == all_rows && LawTable<Passing<Opened>>::is_gated);
// Of two laws, what both have to have both have.
constexpr unsigned starts_blank_row = 1u << 8;
static_assert(rows<Over>() == (all_rows & ~starts_blank_row) && rows<NullSpace<1, Full, Full>>() == all_rows);
static_assert(rows<Behind>() == (all_rows & ~starts_blank_row));
// Of a sum each law presses by itself, and distances are asked of laws.
constexpr unsigned of_sum = all_rows & ~(distance_row | presses_row);
static_assert(rows<Two>() == (of_sum & ~starts_blank_row) && rows<Fused<Sum::normalised, Full>>() == of_sum);
static_assert(rows<Blended<Two>>() == (of_sum & ~starts_blank_row));
static_assert(in_order<Bare<>> && in_order<Full> && in_order<Passing<Bare<>>> && in_order<Passing<Full>>);
static_assert(in_order<Carrying> && in_order<Opened> && in_order<Over> && in_order<Two> &&
              in_order<Blended<Two>> && in_order<Passing<Two>>);
static_assert(Law<Passing<Full>, Known> && TrackingLaw<Passing<Full>, Known> &&
              GoalLaw<Passing<Full>, Known> && TrackingLaw<Halved<Bare<>>, Known> &&
              !GoalLaw<Halved<Bare<>>, Known> && Law<Passing<Two>, Known>);
// The shares of a wrapped sum are its own.
static_assert(terms_of<Passing<Two>> == 2 && LawTable<Passing<Two>>::gravity_laws == 0);
static_assert(terms_of<detail::CarryingLaw<2, Two, double>> == 3);
static_assert(LawTable<detail::CarryingLaw<2, Blended<Two>, double>>::is_complete_sum);

const Full full;
const Known known;
}  // namespace

TEST_CASE("WrappedLaw: each member gives what that of its law gives") {
  const Passing<Full> law(full);
  auto m = law.start(known);
  CHECK(m.count == 0);
  CHECK(status_of(law, m).has(Reason::slowed));
  CHECK(settled(law, m, known, 0.5));
  m = law.advance(m, known, 1.0, Opposition::none);
  CHECK(m.time == 1);
  CHECK(m.count == 1);
  CHECK_FALSE(settled(law, m, known, 0.5));
  const auto received = law.receive(m, known, {3});
  CHECK(received.memory.goal == 3);
  CHECK(received.memory.count == 1);
  CHECK(received.status.has(Reason::goal_stretched));
  CHECK(follow_or_receive(law, m, known, Place{3}).memory.goal == 103);
  CHECK(law.distance(known, {4}).position == 4);
  CHECK(describe(law) == "full");
  Terms terms;
  LawTable<Passing<Full>>::check_for(Passing<Full>(Full{{}, &terms}), terms);
  CHECK(terms.asked == 1);

  const LawShare<double> share{0.5, 2.0};
  using detail::torque_with;
  using detail::weighted_torque;
  for (const double at : {1.0, 2.5}) {
    m.time = at;
    CHECK(torque_of(law, m, known) == torque_of(full, m, known));
    CHECK(weighted_torque<GravityTerm::left_out>(law, m, known, share) ==
          weighted_torque<GravityTerm::left_out>(full, m, known, share));
    CHECK(torque_with<GravityTerm::included>(law, m, known, share, detail::now_of(law, m, known)) ==
          torque_with<GravityTerm::included>(full, m, known, share, detail::now_of(full, m, known)));
    const auto e = evaluate(law, m, known, 0.25);
    const auto own = evaluate(full, m, known, 0.25);
    CHECK(e.torque == own.torque);
    CHECK(e.shares[0] == own.shares[0]);
    CHECK(e.memory.time == own.memory.time);
    CHECK(e.memory.count == 2);
    CHECK(e.status.bits() == own.status.bits());
  }
}

TEST_CASE("WrappedLaw: a changed torque is changed in every form, alone and in a sum") {
  const Halved<Full> law(full);
  const Halved<Bare<>> bare(Bare<>{});
  const auto m = law.start(known);
  const LawShare<double> share{0.5, 2.0};
  using detail::weighted_torque;
  CHECK(torque_of(law, m, known) == 0.5 * torque_of(full, m, known));
  CHECK(evaluate(law, m, known, 0.1).torque == 0.5 * torque_of(full, m, known));
  CHECK(torque_of(bare, bare.start(known), known) == 0.5 * torque_of(Bare<>{}, {0}, known));
  for (const auto& tau : {weighted_torque<GravityTerm::left_out>(law, m, known, share),
                          detail::torque_with<GravityTerm::left_out>(law, m, known, share, 1.0)})
    CHECK(tau == 0.5 * weighted_torque<GravityTerm::left_out>(full, m, known, share));
  const auto sum = law + bare;
  const auto own = full + Bare<>{};
  CHECK(evaluate(sum, sum.start(known), known, 0.1).torque ==
        0.5 * evaluate(own, own.start(known), known, 0.1).torque);
}

TEST_CASE("WrappedLaw: of a sum it gives all shares") {
  const auto sum = full + Bare<>{};
  const Passing<std::remove_const_t<decltype(sum)>> law(sum);
  const auto m = law.start(known);
  const auto e = evaluate(law, m, known, 0.5);
  const auto own = evaluate(sum, m, known, 0.5);
  CHECK(e.torque == own.torque);
  CHECK(e.shares == own.shares);
  CHECK(e.status.has(Reason::slowed));
  CHECK(e.memory.count == 1);
  CHECK(detail::memory_of<0>(e.memory.laws).time == 0.5);
  CHECK(follow_or_receive(law, m, known, Place{1}).memory.count == 0);
}

TEST_CASE("Sums, blends and task priority: what their laws say is said") {
  const auto sum = full + Bare<>{};
  CHECK(status_of(sum, sum.start(known)).has(Reason::slowed));
  const auto blend = blended(sum);
  CHECK(status_of(blend, blend.start(known)).has(Reason::slowed));
  const Over over(full, Bare<>{});
  const Behind behind(Bare<>{}, full);
  CHECK(status_of(over, over.start(known)).has(Reason::slowed));
  CHECK(over.distance(known, Place{4}).position == 4);
  CHECK(behind.distance(known, Place{4}).position == 4);
  CHECK(over.receive(over.start(known), known, Place{3}).memory.first.goal == 103);
  CHECK(behind.receive(behind.start(known), known, Place{3}).memory.second.goal == 103);
  Terms terms;
  const Full asks{{}, &terms};
  (asks + Bare<>{}).check_for(terms);
  blended(asks + Bare<>{}).check_for(terms);
  Over(asks, Bare<>{}).check_for(terms);
  Behind(Bare<>{}, asks).check_for(terms);
  CHECK(terms.asked == 4);
}
