// Promise: a scene pays for what it asks for, and for nothing else
// Tried: operations counted

#include "skinctl/dynamics/quantities.hpp"

#include <doctest/doctest.h>

#include "tests/support/counted.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using M = ur5::Model;
// The sanitizers take a minute to compile the factors.
constexpr Needs everything{.poses = 0b111111,
                           .jacobians = link_bit<5>,
                           .gravity = true,
                           .mass = true,
                           .mass_factors = !SKINCTL_SANITIZED,
                           .coriolis = true,
                           .middle = true};
}  // namespace

static_assert(complete<M>({.jacobians = link_bit<3>}).poses == 0b001111,
              "a Jacobian needs the poses on the way");
static_assert(complete<M>({.gravity = true}).angles && complete<M>({.coriolis = true}).angles);
static_assert(complete<M>({.mass_factors = true}).mass);
static_assert(!complete<M>({}).angles, "a scene that needs nothing computes nothing");
static_assert((Needs{.poses = 1} | Needs{.poses = 4, .mass = true}) == Needs{.poses = 5, .mass = true});
static_assert(complete<M>(everything).cover({.mass = true}) && !Needs{}.cover({.mass = true}));
static_assert(links_for<M>({.mass = true}) == 0b111111);
static_assert(links_for<M>({.poses = link_bit<1>}) == 0b000011,
              "joints behind the last asked link are not touched");
static_assert(sizeof(Quantities<M, Needs{}>) <= 5 * sizeof(void*), "nothing asked for, nothing stored");

TEST_CASE("quantities: each is what its own function gives") {
  const M model;
  oracle::Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Motion<6> at(random);
    const State<6> state{0ns, at.q, at.dq};
    const NoTouch touch;
    const Quantities<M, everything> known(model, state, 0.008, touch);
    CHECK(known.q() == at.q);
    CHECK(known.dt() == 0.008);
    CHECK(known.gravity() == gravity_torque(model, at.q));
    CHECK(known.pose<4>() == link_poses(model, at.q).get<4>());
    CHECK(known.mass()(2, 3) == mass_matrix(model, at.q)(2, 3));
    CHECK(known.coriolis() == coriolis_torque(model, known.angles(), at.dq));
#if !SKINCTL_SANITIZED
    const MassFactors<M> factors(mass_matrix(model, at.q));
    CHECK(known.mass_factors().solve(known.gravity()) == factors.solve(known.gravity()));
#endif
    CHECK(gravity_torque(model, known.middle()) == gravity_torque(model, integrate(at.q, at.dq, 0.004)));
    const auto X_LT = Transform<Link<5>, Tool, double>::translation_xyz(0.1, -0.2, 0.3);
    const auto J = jacobian<5>(link_poses(model, at.q), X_LT);
    CHECK(as_eigen(known.jacobian<5>(X_LT)) == as_eigen(J));
    CHECK(as_eigen(known.jacobian<5>()) == as_eigen(jacobian<5>(link_poses(model, at.q))));
  }
}

namespace {
/// Operations that a scene with these needs takes for one state of a UR5.
template <Needs Asked>
std::size_t operations() {
  const M model;
  State<6, Counted> state;
  for (std::size_t i = 0; i < 6; ++i) state.q[i] = 0.1 * static_cast<double>(i + 1);
  const NoTouch touch;
  Counted::operations = 0;
  const Quantities<M, Asked, Counted> known(model, state, Counted(0.008), touch);
  static_cast<void>(known);
  return Counted::operations;
}
}  // namespace

TEST_CASE("quantities: a scene pays for what it asks for, and for nothing else") {
  constexpr Needs first_links{.poses = 0b000111};
  constexpr Needs gravity{.gravity = true};
  const auto nothing = operations<Needs{}>(), near = operations<first_links>(),
             weight = operations<gravity>(), both = operations<first_links | gravity>(),
             links = operations<Needs{.poses = 0b111111}>(), all = operations<everything>();
  MESSAGE("operations: nothing " << nothing << ", links 1 to 3 " << near << ", G " << weight << ", both "
                                 << both << ", all links " << links << ", everything " << all);
  CHECK(nothing == 0);
  CHECK(near > 0);
  CHECK(2 * near < links);
  CHECK(weight > 0);
  CHECK(both <= near + weight);  // the sines and cosines are shared
  CHECK(4 * both < all);
#if !SKINCTL_SANITIZED
  // M costs less than M with its factors.
  CHECK(operations<Needs{.mass = true}>() < operations<Needs{.mass_factors = true}>());
#endif
}
