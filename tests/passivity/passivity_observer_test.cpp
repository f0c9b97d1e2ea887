#include "skinctl/passivity/passivity_observer.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

namespace {

Contacts<2, double, 1> push(double force) {
  Contacts<2, double, 1> c;
  c.count = force > 0 ? 1 : 0;
  c.list[0].link = 1;
  c.list[0].force = force;
  c.list[0].row[0] = 0.5;
  return c;
}
const auto nothing = [](auto&&) {};

}  // namespace

TEST_CASE("PassivityObserver: a spring's energy is booked exactly, out and back") {
  const PassivityObserver<> passivity_observer({.start = 1, .max = 2});
  auto m = passivity_observer.start<2>();
  const double k = 1000;
  passivity_observer.book(m, push(0), JointPosition<2>{0, 0}, 3.0, nothing);
  for (const double x : {0.01, 0.02, 0.03, 0.015, 0.03}) {
    passivity_observer.book(m, push(k * x), JointPosition<2>{2 * x, 7}, 3.0, nothing);
    CHECK(m.energy == doctest::Approx(1 - 0.5 * k * x * x).epsilon(1e-12));
  }
  passivity_observer.book(m, push(0), JointPosition<2>{0, 0}, 3.0, nothing);
  CHECK(m.energy == doctest::Approx(1).epsilon(1e-12));
  // A hand that pushes the robot back gives energy, up to the room.
  passivity_observer.book(m, push(10), JointPosition<2>{0, 0}, 3.0, nothing);
  passivity_observer.book(m, push(10), JointPosition<2>{-0.1, 0}, 3.0, nothing);
  CHECK(m.energy == doctest::Approx(1.5).epsilon(1e-12));
  passivity_observer.book(m, push(10), JointPosition<2>{-10, 0}, 3.0, nothing);
  CHECK(m.energy == 2);
}

TEST_CASE("PassivityObserver: moves into a contact only while it can pay") {
  const PassivityObserver<> passivity_observer({.start = 1, .max = 1, .stiffness = 1e4, .reserve = 0});
  auto m = passivity_observer.start<2>();
  const JointVelocity<2> in{1, 0}, out{-1, 0}, beside{0, 1};
  passivity_observer.book(m, push(0), JointPosition<2>{0, 0}, 0.0, nothing);
  CHECK(passivity_observer.allows(m, JointPosition<2>{9, 0}, in));  // not touched, no reach declared
  passivity_observer.book(m, push(20), JointPosition<2>{0, 0}, 0.0, nothing);
  // (20 + 5000 p) p = 1: p = 0.01228 m, 0.02457 rad.
  const double p = (-20 + std::sqrt(400 + 4 * 5000.0)) / 1e4;
  CHECK(passivity_observer.allows(m, JointPosition<2>{2 * p * 0.999, 0}, in));
  CHECK_FALSE(passivity_observer.allows(m, JointPosition<2>{2 * p * 1.001, 0}, in));
  CHECK(passivity_observer.allows(m, JointPosition<2>{2 * p * 1.001, 0}, out));
  CHECK(passivity_observer.allows(m, JointPosition<2>{2 * p * 1.001, 0}, beside));
  // What is under way counts, not only what would be sent now.
  passivity_observer.book(m, push(20), JointPosition<2>{0, 0}, 0.0,
                          [&](auto&& f) { f(JointPosition<2>{2 * p * 1.001, 0}), f(JointPosition<2>{}); });
  CHECK_FALSE(passivity_observer.allows(m, JointPosition<2>{0, 0}, in));
  CHECK(passivity_observer.allows(m, JointPosition<2>{0, 0}, out));
}

TEST_CASE("PassivityObserver: what a push grows by meanwhile, the reserve, an impact to come") {
  PassivityObserver<>::Settings s{.start = 1, .max = 1, .stiffness = 1e4, .reserve = 0};
  const JointVelocity<2> in{1, 0};
  const JointPosition<2> ahead{0.02, 0};  // 0.01 m: (F + 50) 0.01
  const auto allowed = [&](double before, double now, double cycles) {
    const PassivityObserver<> passivity_observer(s);
    auto m = passivity_observer.start<2>();
    passivity_observer.book(m, push(before), JointPosition<2>{}, cycles, nothing);
    passivity_observer.book(m, push(now), JointPosition<2>{}, cycles, nothing);
    return passivity_observer.allows(m, ahead, in);
  };
  CHECK(allowed(20, 30, 1));
  CHECK(allowed(20, 30, 1.9));
  CHECK_FALSE(allowed(20, 30, 2.1));
  s.reserve = 0.25;
  CHECK_FALSE(allowed(30, 30, 1));
  CHECK(allowed(20, 20, 1));
  s.reserve = 0;
  s.reach[0] = 0.8;  // 1/2 k (0.8 * 0.02)^2 = 1.28 J
  CHECK_FALSE(allowed(0, 0, 1));
  s.reach[0] = 0.7;
  CHECK(allowed(0, 0, 1));
  s.reach[0] = -1;
  CHECK_THROWS_AS(PassivityObserver<>{s}, ConfigurationError);
  CHECK_THROWS_AS(PassivityObserver<>({.stiffness = 0}), ConfigurationError);
  CHECK_THROWS_AS(PassivityObserver<>({.start = 2, .max = 1}), ConfigurationError);
  CHECK_THROWS_AS(PassivityObserver<>({.reserve = 1}), ConfigurationError);
}

TEST_CASE(
    "PassivityObserver: what leads out of a contact is paid for by the push, then by half of the rest") {
  PassivityObserver<>::Settings s{.start = 0, .max = 1, .stiffness = 1e4, .reserve = 0};
  s.reach[0] = s.reach[1] = 0.5;
  const PassivityObserver<> observer(s);
  auto m = observer.start<2>();
  const JointVelocity<2> out{-1, 0}, beside{0, 1};
  // 20 N along 0.5 m/rad: 1/2 k (0.5 dq)^2 <= 20 * 0.5 dq up to dq = 8 mrad.
  observer.book(m, push(20), JointPosition<2>{0, 0}, 0.0, nothing);
  CHECK(observer.allows(m, JointPosition<2>{-0.00799, 0}, out));
  CHECK_FALSE(observer.allows(m, JointPosition<2>{-0.00801, 0}, out));
  CHECK_FALSE(observer.allows(m, JointPosition<2>{0, 1e-6}, beside));
  CHECK_FALSE(observer.allows(m, JointPosition<2>{1e-6, 0}, JointVelocity<2>{1, 0}));
  // What it took on the way pays for more, half of it without the push.
  observer.book(m, push(20), JointPosition<2>{-0.01, 0}, 0.0, nothing);
  CHECK(m.energy == doctest::Approx(0.1));
  observer.book(m, push(0), JointPosition<2>{-0.01, 0}, 0.0, nothing);
  const double p = std::sqrt(2 * 0.1 / 1e4);
  CHECK(observer.allows(m, JointPosition<2>{0, 1.999 * p}, beside));
  CHECK_FALSE(observer.allows(m, JointPosition<2>{0, 2.001 * p}, beside));
  s.start = 1, s.reserve = 0.1;
  const PassivityObserver<> reserved(s);
  m.energy = 0.15;  // less than twice the reserve: half of it
  CHECK(reserved.allows(m, JointPosition<2>{0, 1.999 * std::sqrt(0.15 / 1e4)}, beside));
  CHECK_FALSE(reserved.allows(m, JointPosition<2>{0, 2.001 * std::sqrt(0.15 / 1e4)}, beside));
  m.energy = -1;  // a sixteenth of the reserve, to creep
  CHECK(reserved.allows(m, JointPosition<2>{0, 1.999 * std::sqrt(2 * 0.1 / 16 / 1e4)}, beside));
  CHECK_FALSE(reserved.allows(m, JointPosition<2>{0, 2.001 * std::sqrt(2 * 0.1 / 16 / 1e4)}, beside));
}

TEST_CASE("PassivityObserver: outward keeps what leads out of the contact, or beside it") {
  const PassivityObserver<> observer;
  auto m = observer.start<2>();
  observer.book(m, push(20), JointPosition<2>{0, 0}, 0.0, nothing);
  const auto beside = observer.outward(m, JointVelocity<2>{1, 2});
  CHECK(beside[0] <= 0);
  CHECK(beside[0] > -0.01);
  CHECK(beside[1] == 2);
  CHECK(observer.outward(m, JointVelocity<2>{-1, 2}) == JointVelocity<2>{-1, 2});
}
