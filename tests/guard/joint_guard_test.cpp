#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <bit>
#include <cmath>
#include <string>

#include "skinctl/guard/guard.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/guard_alone.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<GuardMemory<6, double>>);

namespace {

template <Interface I, class T>
struct Case {
  static constexpr Interface interface = I;
  using scalar = T;
};
#define MOTIONS                                                                                           \
  Case<Interface::position, double>, Case<Interface::position, float>, Case<Interface::velocity, double>, \
      Case<Interface::velocity, float>

template <class T>
RobotConfiguration<1, T> configuration() {
  typename JointLimits<1, T>::Values v;
  v.lower[0] = T(-2);
  v.upper[0] = T(2);
  v.velocity[0] = T(1);
  v.acceleration[0] = T(10);
  v.torque[0] = T(20);
  return {.limits = JointLimits<1, T>(v), .period = 10ms};
}
template <class T>
JointCommand<1, T> command(Nanoseconds time, double q, double u, double tau = 0) {
  JointCommand<1, T> c;
  c.time = time;
  c.position[0] = T(q);
  c.velocity[0] = T(u);
  c.torque[0] = T(tau);
  c.valid = true;
  return c;
}
template <class T>
State<1, T> at(Nanoseconds time, double q, double dq = 0) {
  State<1, T> s;
  s.time = time;
  s.q[0] = T(q);
  s.dq[0] = T(dq);
  return s;
}

// A guard whose robot has shown itself where it was started, in the midst of a motion.
template <class G>
typename G::Memory begun(const G& guard, const JointCommand<1, typename G::scalar>& command,
                         const State<1, typename G::scalar>& measured) {
  auto memory = guard.start(command, measured);
  memory.begun = true;
  return memory;
}
// A distance that no command reaches.
template <class T>
GuardSettings<1, T> any_lead() {
  GuardSettings<1, T> s;
  s.lead = JointPosition<1, T>::constant(T(100));
  return s;
}

// A guard under a steady motion at 0.5 rad/s that began at zero.
template <Interface I, class T>
struct Moving {
  GuardAlone<I, 1, T> guard{configuration<T>()};
  typename GuardAlone<I, 1, T>::Memory memory;
  State<1, T> good;  // as a resolver keeps it
  Nanoseconds now = 1s;
  double q = 0, u = 0.5;
  Moving() { memory = guard.start(command<T>(now, q, u), good = at<T>(now, q, u)); }
  // The command that goes on steadily, changed by `change`, with the state changed by `state`.
  template <class Change, class Measure>
  auto step(Change change, Measure measure) {
    now += 10ms;
    q += 0.01 * u;
    auto wish = command<T>(now, q, u);
    auto s = at<T>(now, q, u);
    change(wish);
    measure(s);
    const Status news = take_measurement(good, s, now, guard);
    auto out = guard.step(memory, wish, good, now);
    out.status |= news;
    return out;
  }
  auto step() {
    return step([](auto&) {}, [](auto&) {});
  }
};
const auto as_it_is = [](auto&) {};

template <class T>
void check_braked(const Guarded<1, T>& out, double u_before) {
  CHECK(out.altered);
  CHECK(out.command.valid);
  CHECK(double(out.command.velocity[0]) == doctest::Approx(std::max(u_before - 0.1, 0.0)).epsilon(1e-5));
  CHECK(double(out.command.acceleration[0]) >= -10.001);
}

}  // namespace

TEST_CASE("Guard: refuses configurations that cannot work, with the number and the range") {
  const auto refusal = [](auto&& change) -> std::string {
    auto c = configuration<double>();
    GuardSettings<1> settings;
    change(c, settings);
    return complaint_of([&] { const GuardAlone<Interface::position, 1> guard(c, settings); });
  };
  CHECK(refusal([](auto&, auto&) {}).empty());
  CHECK(refusal([](auto& c, auto&) { c.period = 0ns; }) == "skinctl: period = 0, allowed: 0.1 to 1000 ms");
  CHECK(refusal([](auto& c, auto&) { c.longest_interval = 1ms; }).find("longest interval = 1") !=
        std::string::npos);
  CHECK(refusal([](auto& c, auto&) { c.stale_after = 1ms; }).find("stale after = 1") != std::string::npos);
  CHECK(refusal([](auto&, auto& s) { s.lead = JointPosition<1>(); }).find("lead = 0") != std::string::npos);
  CHECK(refusal([](auto&, auto& s) { s.torque_rate = std::nan(""); }).find("torque rate = nan") !=
        std::string::npos);
}

TEST_CASE_TEMPLATE("Guard: what is good passes to the bit", C, MOTIONS) {
  using T = typename C::scalar;
  Moving<C::interface, T> m;
  for (int k = 0; k < 100; ++k) {
    auto asked = command<T>(0ns, 0, 0);
    const auto out = m.step([&](auto& wish) { asked = wish; }, as_it_is);
    CHECK_FALSE(out.altered);
    CHECK_FALSE(out.status.any());
    CHECK(out.command.position == asked.position);
    CHECK(out.command.velocity == asked.velocity);
    CHECK(out.command.time == m.now);
  }
}

TEST_CASE_TEMPLATE("Guard: each fault brakes with the acceleration limit, with its reason", C, MOTIONS) {
  constexpr Interface I = C::interface;
  using T = typename C::scalar;
  const T nan = std::numeric_limits<T>::quiet_NaN(), inf = std::numeric_limits<T>::infinity();
  const auto fault = [](auto change, Reason reason) {
    Moving<I, T> m;
    m.step();
    const auto before = m.memory.command;
    const auto out = m.step(change, as_it_is);
    CHECK(out.status.has(reason));
    check_braked(out, 0.5);
    if (I == Interface::position)
      CHECK(double(out.command.position[0] - before.position[0]) == doctest::Approx(0.0045).epsilon(1e-3));
  };
  for (const T bad : {nan, inf, T(-inf)}) {
    fault([&](auto& c) { c.position[0] = bad; }, Reason::command_not_finite);
    fault([&](auto& c) { c.velocity[0] = bad; }, Reason::command_not_finite);
    fault([&](auto& c) { c.acceleration[0] = bad; }, Reason::command_not_finite);
    fault([&](auto& c) { c.torque[0] = bad; }, Reason::command_not_finite);
  }
  fault([](auto& c) { c.valid = false; }, Reason::command_not_finite);
  fault([](auto& c) { c.velocity[0] = T(1.2); }, Reason::step_limited);
  fault([](auto& c) { c.velocity[0] = T(0.65); }, Reason::step_limited);
  fault([](auto& c) { c.velocity[0] = T(-0.5); }, Reason::step_limited);
  if (I == Interface::position) {
    fault([](auto& c) { c.position[0] += T(0.001); }, Reason::step_limited);
    fault([](auto& c) { c.position[0] -= T(0.001); }, Reason::step_limited);
    fault([](auto& c) { c.position[0] = T(1.9); }, Reason::step_limited);
  }
}

TEST_CASE_TEMPLATE("Guard: a command that is not renewed brakes", C, MOTIONS) {
  using T = typename C::scalar;
  Moving<C::interface, T> m;
  m.step();
  const auto old = m.memory.command;
  double u = 0.5;
  for (int k = 0; k < 20; ++k) {
    const auto out = m.step([&](auto& wish) { wish = old; }, as_it_is);
    check_braked(out, u);
    u = std::max(u - 0.1, 0.0);
  }
  CHECK(m.memory.command.velocity[0] == T(0));
}

TEST_CASE_TEMPLATE("Guard: a silent robot brakes the command, news let it go on", C, MOTIONS) {
  using T = typename C::scalar;
  Moving<C::interface, T> m;
  m.guard = GuardAlone<C::interface, 1, T>(configuration<T>(), any_lead<T>());
  const auto last = m.good;
  for (int k = 1; k <= 5; ++k) CHECK_FALSE(m.step(as_it_is, [&](auto& s) { s = last; }).altered);
  auto out = m.step(as_it_is, [&](auto& s) { s = last; });
  CHECK(out.status.has(Reason::state_stale));
  check_braked(out, 0.5);
  for (int k = 0; k < 20; ++k) out = m.step(as_it_is, [&](auto& s) { s = last; });
  CHECK(out.command.velocity[0] == T(0));
  // The one who asks goes on from what was let out.
  m.q = double(out.command.position[0]) - 0.01 * 0.05;
  m.u = 0.05;
  out = m.step([&](auto& c) { c.position[0] = T(double(m.memory.command.position[0]) + 0.5 * 0.01 * 0.05); },
               as_it_is);
  CHECK_FALSE(out.altered);
  CHECK_FALSE(out.status.any());
}

TEST_CASE_TEMPLATE("Guard: states that are not finite or from before count as silence", C, MOTIONS) {
  using T = typename C::scalar;
  for (const bool before : {false, true}) {
    Moving<C::interface, T> m;
    Status seen;
    bool stale = false;
    for (int k = 0; k < 30; ++k) {
      const auto out = m.step(as_it_is, [&](auto& s) {
        if (before)
          s.time = 999ms;
        else
          s.q[0] = std::numeric_limits<T>::quiet_NaN();
      });
      seen |= out.status;
      stale = out.altered;
    }
    CHECK(seen.has(Reason::state_stale));
    CHECK(seen.has(Reason::state_not_finite) == !before);
    CHECK(stale);
  }
}

TEST_CASE_TEMPLATE("Guard: a clock that goes back brakes, one that stands repeats", C, MOTIONS) {
  using T = typename C::scalar;
  Moving<C::interface, T> m;
  m.step();
  const auto last = m.memory.command;
  auto out = m.guard.step(m.memory, last, at<T>(m.now, m.q), m.now);
  CHECK(out.status == Status(Reason::interval_empty));
  CHECK_FALSE(out.altered);
  CHECK(out.command.position == last.position);
  for (const Nanoseconds wrong : {m.now - 1ns, Nanoseconds(0), Nanoseconds::min(), Nanoseconds::max()}) {
    auto memory = m.memory;
    out = m.guard.step(memory, command<T>(wrong, m.q, m.u), at<T>(wrong, m.q), wrong);
    CHECK(out.status.has(Reason::time_backwards));
    check_braked(out, 0.5);
    CHECK(memory.time == m.now);
  }
}

TEST_CASE_TEMPLATE("Guard: a long pause gives no credit for a long step", C, MOTIONS) {
  using T = typename C::scalar;
  Moving<C::interface, T> m;
  m.now += 10s;
  const auto out = m.step(
      [](auto& c) {
        c.position[0] += T(0.5);
        c.velocity[0] = T(-1);
      },
      as_it_is);
  CHECK(out.status.has(Reason::interval_too_long));
  CHECK(out.status.has(Reason::step_limited));
  CHECK(out.altered);
}

TEST_CASE_TEMPLATE("Guard: too fast to stop before the end brakes", T, float, double) {
  // 0.5 rad/s needs 0.0125 rad at 10 rad/s^2.
  for (const double room : {0.02, 0.012}) {
    GuardAlone<Interface::position, 1, T> guard(configuration<T>(), any_lead<T>());
    auto memory = begun(guard, command<T>(0ns, 1.995 - room, 0.5), at<T>(0ns, 1.995 - room));
    const auto out = guard.step(memory, command<T>(10ms, 2 - room, 0.5), at<T>(10ms, 1.99 - room), 10ms);
    CHECK(out.altered == (room < 0.0125));
    CHECK(out.status.has(Reason::outside_limits) == (room < 0.0125));
    CHECK(out.command.position[0] <= T(2));
  }
}

TEST_CASE_TEMPLATE("Guard: beyond an end only inward motion passes", C, MOTIONS) {
  constexpr Interface I = C::interface;
  using T = typename C::scalar;
  for (const double side : {-1.0, 1.0})
    for (const double way : {-1.0, 1.0})
      for (const double u : {0.04, 0.0}) {
        if (I == Interface::velocity && u == 0) continue;
        CAPTURE(side);
        CAPTURE(way);
        CAPTURE(u);
        GuardAlone<I, 1, T> guard(configuration<T>());
        auto memory = guard.start(command<T>(0ns, side * 2.1, 0), at<T>(0ns, side * 2.1));
        const auto wish = command<T>(10ms, side * (2.1 + way * 0.0002), side * way * u);
        const auto out = guard.step(memory, wish, at<T>(10ms, side * 2.1), 10ms);
        CHECK(out.altered == (way > 0));
        CHECK(out.status.has(Reason::outside_limits) == (way > 0));
      }
}

TEST_CASE_TEMPLATE("Guard: no command is faster than its limit, and one that is only gets slower", C,
                   MOTIONS) {
  constexpr Interface I = C::interface;
  using T = typename C::scalar;
  for (const double side : {-1.0, 1.0})
    for (const auto& speeds : {std::pair{0.95, 1.0}, {0.95, 1.01}, {1.0, 1.05}, {1.2, 1.15}, {1.2, 1.25}}) {
      const double u0 = speeds.first, u = speeds.second;
      CAPTURE(side);
      CAPTURE(u0);
      CAPTURE(u);
      GuardAlone<I, 1, T> guard(configuration<T>(), any_lead<T>());
      auto memory = begun(guard, command<T>(0ns, 0, side * u0), at<T>(0ns, 0, side * u0));
      const double q = side * 0.005 * (u0 + u);
      const auto out = guard.step(memory, command<T>(10ms, q, side * u), at<T>(10ms, 0, side * u0), 10ms);
      CHECK(out.altered == (u > 1 && u > u0));
      CHECK(out.status.has(Reason::step_limited) == (u > 1 && u > u0));
    }
}

TEST_CASE_TEMPLATE("Guard: a position is where some motion within the acceleration leads", T, float, double) {
  // 10 rad/s^2 and 10 ms: 0.25 mrad aside of a steady motion, nothing aside of the fastest change of speed.
  for (const double side : {-1.0, 1.0})
    for (const auto& wished : {std::pair{0.5, 2.4e-4}, {0.5, 2.6e-4}, {0.6, 0.0}, {0.6, 1e-4}, {0.4, 1e-4}}) {
      const double u = wished.first, aside = wished.second;
      CAPTURE(side);
      CAPTURE(u);
      CAPTURE(aside);
      GuardAlone<Interface::position, 1, T> guard(configuration<T>());
      auto memory = guard.start(command<T>(0ns, 0, 0.5), at<T>(0ns, 0, 0.5));
      const auto wish = command<T>(10ms, 0.005 * (0.5 + u) + side * aside, u);
      const auto out = guard.step(memory, wish, at<T>(10ms, 0, 0.5), 10ms);
      const double most = u == 0.5 ? 2.5e-4 : 1e-6;
      CHECK(out.altered == (aside > most));
      CHECK(out.status.has(Reason::step_limited) == (aside > most));
    }
}

TEST_CASE_TEMPLATE("Guard: who cannot stop before an end any more may brake as hard as the limit allows", C,
                   MOTIONS) {
  constexpr Interface I = C::interface;
  using T = typename C::scalar;
  for (const double side : {-1.0, 1.0})
    for (const double u : {0.4, 0.42}) {
      CAPTURE(side);
      CAPTURE(u);
      GuardAlone<I, 1, T> guard(configuration<T>());
      auto memory =
          begun(guard, command<T>(0ns, side * 1.99, side * 0.5), at<T>(0ns, side * 1.99, side * 0.5));
      const auto wish = command<T>(10ms, side * (1.99 + 0.005 * (0.5 + u)), side * u);
      const auto out = guard.step(memory, wish, at<T>(10ms, side * 1.995, side * 0.5), 10ms);
      CHECK(out.altered == (u > 0.41));
      CHECK(out.status.has(Reason::outside_limits) == (u > 0.41));
    }
}

TEST_CASE_TEMPLATE("Guard: a robot by velocity that still leaves an end makes room for a velocity towards it",
                   T, float, double) {
  for (const double side : {-1.0, 1.0})
    for (const double dq : {-0.5, 0.0, 0.5}) {
      CAPTURE(side);
      CAPTURE(dq);
      GuardAlone<Interface::velocity, 1, T> guard(configuration<T>());
      // 0.35 rad/s need 6.1 mrad of the 5 that are left.
      auto memory = begun(guard, command<T>(0ns, 0, side * 0.3), at<T>(0ns, side * 1.995));
      const auto out =
          guard.step(memory, command<T>(10ms, 0, side * 0.35), at<T>(10ms, side * 1.995, side * dq), 10ms);
      CHECK(out.altered == (dq >= 0));
      CHECK(out.status.has(Reason::outside_limits) == (dq >= 0));
    }
}

TEST_CASE_TEMPLATE("Guard: a position that brakes in a late cycle goes no further than in a period", T, float,
                   double) {
  GuardAlone<Interface::position, 1, T> guard(configuration<T>());
  auto memory = guard.start(command<T>(0ns, 0, 0.5), at<T>(0ns, 0, 0.5));
  auto missing = command<T>(40ms, 0, 0);
  missing.valid = false;
  const auto out = guard.step(memory, missing, at<T>(40ms, 0, 0.5), 40ms);
  CHECK(out.status.has(Reason::command_not_finite));
  CHECK(out.command.position[0] > T(0));
  CHECK(out.command.position[0] <= T(0.5 * 0.01));
}

TEST_CASE_TEMPLATE("Guard: a position far from the robot does not go further", T, float, double) {
  auto c = configuration<T>();
  c.delay = 20ms, c.lag = 10ms;
  GuardSettings<1, T> s;
  s.lead = JointPosition<1, T>::constant(T(0.15));
  // By default B0 + A d (tau + d/2) + V (T + t_u), and v_max^2/(2 a).
  for (const auto& a_case : {std::pair{GuardAlone<Interface::position, 1, T>(c, s), 0.15},
                             {GuardAlone<Interface::position, 1, T>(c), 0.02 + 0.0075 + 0.09 + 0.05}})
    for (const double side : {-1.0, 1.0}) {
      const auto& guard = a_case.first;
      const double most = a_case.second;
      CAPTURE(side);
      CAPTURE(most);
      auto memory = begun(guard, command<T>(0ns, 0, side * 0.5), at<T>(0ns, 0));
      Nanoseconds now{};
      double q = 0;
      Guarded<1, T> out;
      for (int k = 0; k < 100; ++k) {  // the robot does not move
        q += side * 0.005;
        now += 10ms;
        out = guard.step(memory, command<T>(now, q, side * 0.5), at<T>(now, 0), now);
        REQUIRE(T(side) * out.command.position[0] <= T(most) * T(1.0001));
      }
      CHECK(T(side) * out.command.position[0] > T(0.7 * most));
      CHECK(out.altered);
      CHECK(out.command.velocity[0] == T(0));
    }
}

TEST_CASE_TEMPLATE("Guard: without a good first command nothing leaves", C, MOTIONS) {
  using T = typename C::scalar;
  const GuardAlone<C::interface, 1, T> guard(configuration<T>());
  const T nan = std::numeric_limits<T>::quiet_NaN();
  auto invalid = command<T>(0ns, 0, 0);
  invalid.valid = false;
  for (auto memory :
       {guard.start(invalid, at<T>(0ns, 0)), guard.start(command<T>(0ns, nan, 0), at<T>(0ns, 0)),
        guard.start(command<T>(0ns, 0, 0), at<T>(0ns, nan)),
        typename GuardAlone<C::interface, 1, T>::Memory{}}) {
    const auto out = guard.step(memory, command<T>(10ms, 0, 0), at<T>(10ms, 0), 10ms);
    CHECK_FALSE(out.command.valid);
  }
}

TEST_CASE_TEMPLATE("Guard: nothing leaves before a good state shows the robot where it was started", C,
                   MOTIONS, Case<Interface::torque, double>) {
  using T = typename C::scalar;
  const GuardAlone<C::interface, 1, T> guard(configuration<T>(), {.consent = Reason::state_out_of_range});
  // T is 10 ms: a robot at full speed is 80.5 mrad behind, of a start beyond an end 20 mrad count; speeds may
  // differ by 0.1 + 0.067 rad/s.
  struct Start {
    double q, dq, seen_q, seen_dq;
    bool good;
  };
  for (const auto& s : {Start{0, 0, 0.080, 0, true},
                        {0, 0, -0.082, 0, false},
                        {0, 0, 1.8, 0, false},
                        {1.99, 0, 2.01, 0, true},
                        {2.01, 0, 2.005, 0, true},
                        {2.01, 0, 1.98, 0, false},
                        {2.5, 0, 2.5, 0, true},
                        {9, 0, 9, 0, false},
                        {0, 0.5, 0.005, 0.5, true},
                        {0, 0.5, 0.005, 0.35, true},
                        {0, 0.5, 0.005, 0.3, false},
                        {0, 0, 0, 0.2, false},
                        {0, 11, 0, 11, false}}) {
    CAPTURE(s.q);
    CAPTURE(s.dq);
    CAPTURE(s.seen_q);
    CAPTURE(s.seen_dq);
    auto memory = guard.start(command<T>(1s, s.q, s.dq), at<T>(1s, s.q, s.dq));
    Nanoseconds now = 1s;
    const bool known_wrong = guard.refuses_start(memory);
    const auto step = [&](Status found) {
      now += 10ms;
      auto out = guard.step(memory, command<T>(now, s.q + 0.005 * s.dq, s.dq),
                            at<T>(found.any() ? 1s : now, s.seen_q, s.seen_dq), now, {}, found);
      CHECK(out.command.valid == (s.good && !found.any()));
      if (!out.command.valid) CHECK(out.altered);
      return out.status;
    };
    for (const Reason r : {Reason::state_not_finite, Reason::state_out_of_range, Reason::time_backwards}) {
      const Status status = step(r);
      CHECK(status.has(Reason::start_refused) == known_wrong);
      CHECK(status.has(Reason::consent_awaited) == (r != Reason::state_not_finite));  // it is not forgotten
    }
    CHECK(guard.waits(memory));
    guard.acknowledge(memory);
    CHECK(step({}).has(Reason::start_refused) == !s.good);
    CHECK(guard.refuses_start(memory) == !s.good);
    guard.acknowledge(memory);
    CHECK(step({}).has(Reason::start_refused) == !s.good);  // an acknowledgement is no start
  }
}

TEST_CASE_TEMPLATE("Guard: torques are cut to the limit and to the rate", T, float, double) {
  const auto c = configuration<T>();
  const GuardAlone<Interface::torque, 1, T> guard(c, {.torque_rate = T(10)});  // 2 N m a cycle
  auto memory = guard.start(command<T>(0ns, 0, 0, 0), at<T>(0ns, 0));
  auto out = guard.step(memory, command<T>(10ms, 0, 0, 1.5), at<T>(10ms, 0), 10ms);
  CHECK_FALSE(out.altered);
  CHECK(out.command.torque[0] == T(1.5));
  auto elsewhere = memory;
  out = guard.step(elsewhere, command<T>(20ms, 0, 0, -10), at<T>(20ms, 0), 20ms);
  CHECK(out.altered);
  CHECK(out.status == Status(Reason::step_limited));
  CHECK(double(out.command.torque[0]) == doctest::Approx(-0.5));
  out = guard.step(memory, command<T>(20ms, 0, 0, 100), at<T>(20ms, 0), 20ms);
  CHECK(out.altered);
  CHECK(out.status.has(Reason::torque_limited));
  CHECK(out.status.has(Reason::step_limited));
  CHECK(double(out.command.torque[0]) == doctest::Approx(3.5));
  for (Nanoseconds now = 30ms; now < 200ms; now += 10ms)
    out = guard.step(memory, command<T>(now, 0, 0, 100), at<T>(now, 0), now);
  CHECK(out.command.torque[0] == T(20));
}

TEST_CASE_TEMPLATE("Guard: a torque that cannot be trusted ramps to the fallback", T, float, double) {
  const auto c = configuration<T>();
  const GuardAlone<Interface::torque, 1, T> guard(c, {.torque_rate = T(10)});
  const T nan = std::numeric_limits<T>::quiet_NaN();
  const auto fallback = JointTorque<1, T>::constant(T(7));
  auto memory = guard.start(command<T>(0ns, 0, 0, 10), at<T>(0ns, 0));
  auto out = guard.step(memory, command<T>(10ms, 0, 0, nan), at<T>(10ms, 0), 10ms, fallback);
  CHECK(out.status.has(Reason::command_not_finite));
  CHECK(double(out.command.torque[0]) == doctest::Approx(8));
  out = guard.step(memory, command<T>(20ms, 0, 0, nan), at<T>(20ms, 0), 20ms, fallback);
  CHECK(double(out.command.torque[0]) == doctest::Approx(7));
  // a silent robot
  for (Nanoseconds now = 30ms; now < 1s; now += 10ms)
    out = guard.step(memory, command<T>(now, 0, 0, 12), at<T>(20ms, 0), now, fallback);
  CHECK(out.status.has(Reason::state_stale));
  CHECK(out.command.torque[0] == T(7));
  // no fallback either
  out = guard.step(memory, command<T>(1s, 0, 0, nan), at<T>(1s, 0), 1s, JointTorque<1, T>::constant(nan));
  CHECK(double(out.command.torque[0]) == doctest::Approx(5));
}

namespace {
template <class T>
T from_bits(std::uint64_t bits) {
  if constexpr (std::is_same_v<T, float>) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  } else {
    return std::bit_cast<double>(bits);
  }
}
}  // namespace

TEST_CASE_TEMPLATE("Guard: whatever comes in, what goes out is finite, within limits, and never steps", C,
                   MOTIONS, Case<Interface::torque, double>, Case<Interface::torque, float>) {
  constexpr Interface I = C::interface;
  using T = typename C::scalar;
  const double eps = std::numeric_limits<T>::epsilon();
  const GuardAlone<I, 1, T> guard(configuration<T>());
  const bool ok = rc::check([&] {
    State<1, T> known = at<T>(0ns, 0);
    auto memory = begun(guard, command<T>(0ns, 0, 0), known);
    const int cycles = *rc::gen::inRange(1, 100);
    for (int k = 0; k < cycles; ++k) {
      const auto bits = [] { return *rc::gen::arbitrary<std::uint64_t>(); };
      const auto number = [&](double good) {
        const auto kind = *rc::gen::inRange(0, 12);
        const double part = *rc::gen::inRange(-1000, 1001) * 1e-3;
        return kind == 0 ? from_bits<T>(bits()) : T(kind == 1 ? part * 1e3 : good + part * 1e-3);
      };
      const auto before = memory.command;
      const Nanoseconds last = memory.time, next = last + 10ms;
      const Nanoseconds now =
          *rc::gen::inRange(0, 20) == 0 && last < 1000s ? static_cast<Nanoseconds>(bits()) : next;
      JointCommand<1, T> wish;
      wish.time = *rc::gen::inRange(0, 20) == 0 ? static_cast<Nanoseconds>(bits()) : now;
      wish.position[0] = number(double(before.position[0]) + 0.01 * double(before.velocity[0]));
      wish.velocity[0] = number(double(before.velocity[0]));
      wish.acceleration[0] = number(0);
      wish.torque[0] = number(double(before.torque[0]));
      wish.valid = *rc::gen::inRange(0, 20) != 0;
      State<1, T> s;
      s.time = *rc::gen::inRange(0, 20) == 0 ? static_cast<Nanoseconds>(bits()) : now;
      s.q[0] = number(double(before.position[0]));
      s.dq[0] = number(0);
      if (now > memory.time && detail::is_plausible(now)) {
        const Status news = take_measurement(known, s, now, guard);
        RC_ASSERT(guard.believes(known) && known.time <= now);
        RC_ASSERT(news.any() || known.q == s.q);
      }
      const auto out = guard.step(memory, wish, known, now, JointTorque<1, T>::constant(number(0)));
      const auto& c = out.command;
      RC_ASSERT(c.valid);
      RC_ASSERT(std::isfinite(c.position[0]) && std::isfinite(c.velocity[0]) &&
                std::isfinite(c.acceleration[0]) && std::isfinite(c.torque[0]));
      // at most five periods of credit
      const double dt =
          now > last && now - last < 50ms ? seconds<double>(now - last) : (now > last ? 0.05 : 0.01);
      if (I == Interface::torque) {
        RC_ASSERT(std::abs(double(c.torque[0])) <= 20);
        RC_ASSERT(std::abs(double(c.torque[0]) - double(before.torque[0])) <=
                  1000 * dt * (1 + 8 * eps) + 1e-5);
      } else {
        RC_ASSERT(std::abs(double(c.velocity[0])) <= 1 + 2000 * eps);
        RC_ASSERT(std::abs(double(c.velocity[0]) - double(before.velocity[0])) <=
                  10 * dt * (1 + 2000 * eps) + 8 * eps);
      }
      if (I == Interface::position) {
        RC_ASSERT(std::abs(double(c.position[0]) - double(before.position[0])) <=
                  dt * (1 + 2000 * eps) + 1e-6);
        RC_ASSERT(std::abs(double(c.position[0])) <= 2 + 100 * eps);
      }
    }
  });
  CHECK(ok);
}

TEST_CASE("Guard: a cycle allocates nothing") {
  Moving<Interface::position, double> m;
  const testing::AllocationGuard guard;
  for (int k = 0; k < 100; ++k) m.step();
  const auto count = guard.count();
  CHECK(count == 0);
}

TEST_CASE_TEMPLATE("Guard: acts on what other stages found, and waits for consent where it should", C,
                   MOTIONS) {
  using T = typename C::scalar;
  const auto c = configuration<T>();
  const GuardAlone<C::interface, 1, T> guard(
      c, {.brakes_on = Reason::sample_stale, .consent = Reason::packets_lost});
  const auto after = [&](Status found, bool acknowledged) {
    auto memory = guard.start(command<T>(0ns, 0, 0), at<T>(0ns, 0));
    Nanoseconds now{};
    const auto pass = [&](Status what) {
      now += 10ms;
      return guard.step(memory, command<T>(now, 0, 0), at<T>(now, 0), now, {}, what);
    };
    CHECK_FALSE(pass({}).altered);
    const auto during = pass(found);
    CHECK(during.altered);
    if (acknowledged) guard.acknowledge(memory);
    return pass({});
  };
  CHECK_FALSE(after(Reason::sample_stale, false).altered);  // over, so it goes on
  for (const Reason r :
       {Reason::packets_lost, Reason::contact_force, Reason::contact_power, Reason::budget_overrun}) {
    const auto waits = after(r, false);
    CHECK(waits.altered);
    CHECK(waits.status.has(Reason::consent_awaited));
    const auto goes_on = after(r, true);
    CHECK_FALSE(goes_on.altered);
    CHECK_FALSE(goes_on.status.any());
  }
  // Consent does not help while the fault is still there.
  auto memory = guard.start(command<T>(0ns, 0, 0), at<T>(0ns, 0));
  guard.acknowledge(memory);
  CHECK(guard.step(memory, command<T>(10ms, 0, 0), at<T>(10ms, 0), 10ms, {}, Reason::contact_force).altered);
  CHECK(guard.waits(memory));
}

TEST_CASE_TEMPLATE("Guard: what it found by itself waits for consent, too, where a user asks for that", C,
                   MOTIONS) {
  using T = typename C::scalar;
  for (const Reason r : {Reason::interval_too_long, Reason::state_stale, Reason::command_not_finite}) {
    const GuardAlone<C::interface, 1, T> guard(configuration<T>(), {.consent = r});
    auto memory = begun(guard, command<T>(0ns, 0, 0), at<T>(0ns, 0));
    Nanoseconds now = r == Reason::interval_too_long ? 100ms : 10ms;
    auto wish = command<T>(now, 0, 0);
    wish.valid = r != Reason::command_not_finite;
    const auto found = guard.step(memory, wish, at<T>(r == Reason::state_stale ? now - 300ms : now, 0), now);
    CHECK(found.altered);
    CHECK(found.status.has(r));
    CHECK(found.status.has(Reason::consent_awaited));
    for (const bool agreed : {false, true}) {
      if (agreed) guard.acknowledge(memory);
      now += 10ms;
      const auto out = guard.step(memory, command<T>(now, 0, 0), at<T>(now, 0), now);
      CHECK(out.altered == !agreed);
      CHECK(out.status.has(Reason::consent_awaited) == !agreed);
    }
  }
}

TEST_CASE_TEMPLATE("Guard: a state that this robot cannot have is no news of it", T, float, double) {
  const GuardAlone<Interface::position, 1, T> guard(configuration<T>());
  CHECK(guard.believes(at<T>(0ns, 2.9, 9)));
  for (const auto& [q, dq] :
       {std::pair{3.1, 0.0}, {-3.1, 0.0}, {0.0, 10.1}, {0.0, -10.1}, {std::nan(""), 0.0}})
    CHECK_FALSE(guard.believes(at<T>(0ns, q, dq)));
  State<1, T> good = at<T>(0ns, 0);
  auto memory = guard.start(command<T>(0ns, 0, 0), good);
  CHECK(take_measurement(good, at<T>(10ms, 3.1), 10ms, guard) == Status(Reason::state_out_of_range));
  const auto out = guard.step(memory, command<T>(10ms, 0, 0), good, 10ms);
  CHECK_FALSE(out.altered);
  CHECK(good.q == at<T>(0ns, 0).q);
}

TEST_CASE_TEMPLATE("Guard: with limits of jerk it brakes within them, whenever it has to", C,
                   Case<Interface::position, double>, Case<Interface::velocity, float>) {
  constexpr Interface I = C::interface;
  using T = typename C::scalar;
  const auto c = configuration<T>();
  const double J = 80, A = 10, V = 1, dt = 0.01;
  const JerkLimits<1, T> smooth(c.limits, JointJerk<1, T>::constant(T(J)));
  const GuardAlone<I, 1, T, JerkLimits<1, T>> guard(c, any_lead<T>(), smooth);
  auto random = [state = std::uint64_t(7)]() mutable {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  auto m = guard.start(command<T>(0ns, 0, 0), at<T>(0ns, 0));
  // Somebody who keeps the limits asks for one speed and another; now and then its command is lost for a
  // while.
  double target = 0, hardest = 0;
  int lost = 0, braked = 0, rested = 0, exceeded = 0;
  for (int k = 1; k < 20000; ++k) {
    const auto last = m.command;
    if (random() < 0.05) target = 2.4 * random() - 1.2;
    if (lost == 0 && random() < 0.02) lost = 1 + static_cast<int>(60 * random());
    auto room = c.limits.room(last.position);
    if (I == Interface::velocity) room.above[0] -= T(0.1), room.below[0] -= T(0.1);
    const auto motion =
        smooth.move(room, last.velocity, last.acceleration, JointVelocity<1, T>::constant(T(target)), T(dt));
    const Nanoseconds now = k * 10ms;
    auto wish =
        command<T>(now, double(last.position[0] + motion.displacement[0]), double(motion.velocity[0]));
    wish.acceleration = motion.acceleration;
    if (lost > 0) --lost, wish.valid = false;
    const auto out = guard.step(m, wish, at<T>(now, double(last.position[0]), double(last.velocity[0])), now);
    const double q = double(out.command.position[0]), u = double(out.command.velocity[0]),
                 a = double(out.command.acceleration[0]);
    if (wish.valid) CHECK_FALSE(out.altered);
    exceeded += out.status.has(Reason::jerk_exceeded);
    hardest = std::max(hardest, std::abs(a - double(last.acceleration[0])) / dt);
    CHECK(std::abs(a) <= A * (1 + 1e-5));
    CHECK(std::abs(u) <= V * (1 + 1e-5));
    CHECK(std::abs(q) <= 2 * (1 + 1e-6));
    // The velocity is the integral of an acceleration that keeps the jerk.
    CHECK(std::abs(u - double(last.velocity[0]) - 0.5 * (a + double(last.acceleration[0])) * dt) <=
          0.25 * J * dt * dt * (1 + 1e-4));
    rested += !wish.valid && u == 0 && a == 0 && last.velocity[0] != T(0);
    braked += !wish.valid;
  }
  CHECK(braked > 1000);
  CHECK(rested > 100);
  CHECK(exceeded == 0);
  CHECK(hardest <= J * (1 + 1e-3));
  CHECK(hardest > 0.99 * J);
}

TEST_CASE("Guard: what cannot be braked within the jerk is braked harder, and said so") {
  const auto c = configuration<double>();
  const GuardAlone<Interface::position, 1, double, JerkLimits<1>> guard(
      c, any_lead<double>(), JerkLimits<1>(c.limits, JointJerk<1>::constant(30)));
  // 0.9 rad/s at 0.05 rad before the end: 10 rad/s^2 stop it in 0.04 rad, 30 rad/s^3 do not.
  auto m = begun(guard, command<double>(0ns, 1.95, 0.9), at<double>(0ns, 1.95));
  Status seen;
  double farthest = 0;
  for (int k = 1; k < 60; ++k) {
    const auto last = m.command;
    const auto out = guard.step(m, {}, at<double>(k * 10ms, double(last.position[0])), k * 10ms);
    seen |= out.status;
    farthest = std::max(farthest, out.command.position[0]);
    CHECK(std::abs(out.command.velocity[0] - last.velocity[0]) <= 0.1 * (1 + 1e-9));
  }
  CHECK(seen.has(Reason::jerk_exceeded));
  CHECK(farthest <= 2);
  CHECK(m.command.velocity[0] == 0);
}
