// runs long: random scenes of each interface
#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <bit>
#include <cmath>
#include <type_traits>

#include "skinctl/guard/guard.hpp"
#include "skinctl/resolver/resolver_of.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/closed_loop.hpp"
#include "tests/support/guard_alone.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<ResolverBy<Interface::position, ur5::Model>::Memory>);
static_assert(std::is_trivially_copyable_v<ResolverBy<Interface::velocity, ur5::Model, float>::Memory>);
static_assert(std::is_trivially_copyable_v<JointCommand<6, float>>);

namespace {

template <Interface I, class T>
struct Case {
  static constexpr Interface interface = I;
  using scalar = T;
};
// By day the sanitizers have two of them, what users compile has the others.
#if defined(SKINCTL_GATE) && SKINCTL_SANITIZED
#define INTERFACES_AND_SCALARS Case<Interface::position, float>, Case<Interface::velocity, double>
#elif defined(SKINCTL_GATE)
#define INTERFACES_AND_SCALARS Case<Interface::position, double>, Case<Interface::velocity, float>
#else
#define INTERFACES_AND_SCALARS                                                                            \
  Case<Interface::position, double>, Case<Interface::position, float>, Case<Interface::velocity, double>, \
      Case<Interface::velocity, float>
#endif

constexpr std::array<double, 6> pose{0.1, -1.5, 1.2, -1, -1.5, 0.3};

template <class T>
RobotConfiguration<6, T> configuration(Nanoseconds period = 8ms) {
  RobotConfiguration<6, T> c{.limits = limits_of<ur5::Description, T>(T(40)),
                             .period = period,
                             .delay = 8ms,
                             .lag = 8ms,
                             .virtual_damping = T(0)};
  c.viscous_friction = {T(20), T(20), T(10), T(2), T(1), T(0.5)};
  return c;
}

template <class T>
State<6, T> at(const std::array<double, 6>& q, Nanoseconds time = {}) {
  State<6, T> s;
  s.time = time;
  for (std::size_t i = 0; i < 6; ++i) s.q[i] = T(q[i]);
  return s;
}

template <class T>
using Pushes = std::array<Pushed<6, T>, max_substeps>;
template <class T>
Pushes<T> pushing(const JointTorque<6, T>& torque) {
  Pushes<T> p;
  p.fill({torque});
  return p;
}

template <class R, class T>
auto step(const R& robot, typename R::Memory& m, Yield::Memory& law_memory, const State<6, T>& measured,
          Nanoseconds now, const Pushes<T>& pushes) {
  return robot.step(m, Yield{}, law_memory, measured, robot.interval(m, now),
                    std::span<const Pushed<6, T>>(pushes));
}

template <class T>
bool all_finite(const JointCommand<6, T>& c) {
  bool ok = true;
  for (std::size_t i = 0; i < 6; ++i)
    ok = ok && std::isfinite(c.position[i]) && std::isfinite(c.velocity[i]) &&
         std::isfinite(c.acceleration[i]) && std::isfinite(c.torque[i]);
  return ok;
}

// What may be said of any two commands in a row, by other formulas than the guard's.
template <Interface I, class T>
void check_limits(const JointLimits<6, T>& limits, const JointCommand<6, T>& before,
                  const JointCommand<6, T>& now, double dt) {
  const double eps = std::numeric_limits<T>::epsilon();
  REQUIRE(all_finite(now));
  for (std::size_t i = 0; i < 6; ++i) {
    const double a = double(limits.acceleration()[i]), v = double(limits.velocity()[i]);
    const double u0 = double(before.velocity[i]), u1 = double(now.velocity[i]);
    REQUIRE(std::abs(u1) <= v * (1 + eps));
    REQUIRE(std::abs(u1 - u0) <= a * dt * (1 + 1e3 * eps) + 8 * eps * v);
    REQUIRE(std::abs(double(now.acceleration[i])) <= a * (1 + 1e3 * eps) + 16 * eps * v / dt);
    REQUIRE(std::abs(double(now.torque[i])) <= double(limits.torque()[i]));
    if (I == Interface::position) {
      const double moved = double(now.position[i]) - double(before.position[i]);
      REQUIRE(std::abs(moved) <= v * dt + 8 * eps * (1 + std::abs(double(now.position[i]))));
      const bool was_inside =
          before.position[i] >= limits.lower()[i] && before.position[i] <= limits.upper()[i];
      if (was_inside) {
        REQUIRE(now.position[i] <= limits.upper()[i]);
        REQUIRE(now.position[i] >= limits.lower()[i]);
      }
    }
  }
}

}  // namespace

// Everything random: pushes, noise, jitter, jumps of the robot, faults. The guard must find nothing to alter.
TEST_CASE_TEMPLATE("Resolver: no limit is ever crossed, and the guard has nothing to add", C,
                   INTERFACES_AND_SCALARS) {
  constexpr Interface I = C::interface;
  using T = typename C::scalar;
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  int at_end = 0, at_speed = 0;
  long cycles = 0, altered = 0;
  for (int scene = 0; scene < (sanitized ? (by_day ? 10 : 30) : 50); ++scene) {
    auto c = configuration<T>(scene % 2 == 0 ? 8ms : 2ms);
    const T a = T(std::pow(10, 1.5 + 0.7 * unit(rng)));
    c.limits = limits_of<ur5::Description, T>(a);
    if (scene % 5 == 0) c.coulomb_friction = JointTorque<6, T>::constant(T(1));
    if (scene % 7 == 0) c.viscous_friction = {};
    ClosedLoop<I, T> loop(c, pose, 0.008 + 0.004 * unit(rng), 0.008);
    const GuardAlone<I, 6, T> guard(c);
    auto guarded = guard.start(loop.memory.command(), loop.measure(0ns));
    loop.noise = 1e-4;
    std::array<double, 6> push{}, impulse{};
    double since = 0;
    Nanoseconds now{};
    auto before = loop.memory.command();
    Nanoseconds carried{};
    for (int k = 0; k < 2500; ++k, ++cycles) {
      const Nanoseconds dt = std::max<Nanoseconds>(
          1us, nanoseconds(seconds<double>(c.period) * (1 + 0.9 * unit(rng)) * (k % 50 == 0 ? 2.5 : 1)));
      if (k % 100 == 0) {
        for (std::size_t i = 0; i < 6; ++i) {
          impulse[i] += push[i] * (seconds<double>(now) - since);
          push[i] = (i < 3 ? 100 : 15) * unit(rng) * (unit(rng) > 0 ? 1 : 0.1);
        }
        since = seconds<double>(now);
      }
      now += dt;
      if (k % 400 == 399) loop.joints.displace(std::size_t(k) % 6, 0.2 * unit(rng));
      loop.joints.hold_fast(1, k % 1000 > 900);
      const auto out = loop.step(now, [&](double t) {
        std::array<double, 6> s{};
        for (std::size_t i = 0; i < 6; ++i) s[i] = impulse[i] + push[i] * (t - since);
        return s;
      });
      // The servo gives a period at most, and what cycles that came too soon left of it.
      const Nanoseconds all = std::min(dt, 5 * c.period) + carried,
                        given = std::min(all, Nanoseconds(c.period));
      carried = std::min(all - given, Nanoseconds(c.period));
      const double credit = seconds<double>(given);
      CAPTURE(scene);
      CAPTURE(k);
      check_limits<I, T>(c.limits, before, out.command, credit);
      before = out.command;
      const auto let = guard.step(guarded, out.command, loop.memory.measured(), now);
      altered += let.altered ? 1 : 0;
      if (let.altered) {
        loop.robot.sent(loop.memory, let.command);
        before = let.command;
      }
      // A robot that takes velocities keeps its position limits too, as long as it does what is declared.
      for (std::size_t i = 0; i < 6; ++i) {
        at_end += std::abs(double(out.command.position[i])) > 6.2 ? 1 : 0;
        at_speed += std::abs(out.command.velocity[i]) > T(3.1) ? 1 : 0;
      }
    }
  }
  CHECK(at_end > 100);
  CHECK(at_speed > 100);
  MESSAGE(cycles, " cycles, altered by the guard: ", altered);
  CHECK(altered <= cycles / 1000);
}

TEST_CASE_TEMPLATE("Resolver: a robot that takes velocities stays within its position limits", T,
                   SKINCTL_SCALARS) {
  std::mt19937_64 rng(12);
  std::uniform_real_distribution<double> unit(-1, 1);
  double closest = 1e9;
  for (int scene = 0; scene < 30; ++scene) {
    auto c = configuration<T>(8ms);
    ClosedLoop<Interface::velocity, T> loop(c, pose, 0.008, 0.008);
    Nanoseconds now{};
    const double push = (scene % 2 == 0 ? 1 : -1) * 60;
    for (int k = 0; k < 1500; ++k) {
      now += nanoseconds(0.008 * (1 + 0.9 * unit(rng))) * (k % 20 == 0 ? 2 : 1);
      loop.step(now, [&](double t) { return std::array<double, 6>{push * t, 0, -push / 2 * t, 0, 0, 0}; });
      for (std::size_t i : {0u, 2u}) {
        const double room = std::min(double(c.limits.upper()[i]) - loop.joints.q()[i],
                                     loop.joints.q()[i] - double(c.limits.lower()[i]));
        closest = std::min(closest, room);
        REQUIRE(room >= -1e-5);
      }
    }
  }
  CHECK(closest < 0.02);
}

TEST_CASE_TEMPLATE("Resolver: NaN and infinity in the state are refused, the last good one stands", C,
                   INTERFACES_AND_SCALARS) {
  using T = typename C::scalar;
  const auto c = configuration<T>();
  const ResolverBy<C::interface, ur5::Model, T> robot(ur5::Model{}, c);
  for (const T bad : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity(),
                      -std::numeric_limits<T>::infinity(), T(1e30)}) {
    auto m = robot.start(at<T>(pose));
    Yield::Memory law;
    auto s = at<T>(pose, 8ms);
    s.q[2] = bad;
    auto before = m.command();
    auto out = step(robot, m, law, s, 8ms, pushing<T>({}));
    CHECK(out.status == Status(Reason::state_not_finite));
    check_limits<C::interface, T>(c.limits, before, out.command, 0.008);
    s = at<T>(pose, 16ms);
    s.dq[2] = bad;
    before = m.command();
    out = step(robot, m, law, s, 16ms, pushing<T>({}));
    CHECK(out.status == Status(Reason::state_not_finite));
    check_limits<C::interface, T>(c.limits, before, out.command, 0.008);
    out = step(robot, m, law, at<T>(pose, 24ms), 24ms, pushing<T>({}));
    CHECK_FALSE(out.status.any());
    // started with it: nothing may be sent
    auto never = robot.start(s);
    CHECK_FALSE(never.started);
    out = step(robot, never, law, at<T>(pose, 16ms), 24ms, pushing<T>({}));
    CHECK_FALSE(out.command.valid);
  }
}

TEST_CASE_TEMPLATE("Resolver: a torque that is not finite brakes, and the law's memory stands", C,
                   INTERFACES_AND_SCALARS) {
  using T = typename C::scalar;
  const auto c = configuration<T>();
  for (const T bad : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity()}) {
    ClosedLoop<C::interface, T> loop(c, pose, 0.008, 0.008);
    Nanoseconds now{};
    while (now < 400ms) loop.step(now += 8ms, [](double t) { return std::array<double, 6>{3 * t}; });
    auto& m = loop.memory;
    const T speed = m.group().v[0];
    const auto evaluations = loop.law_memory.evaluations;
    CHECK(speed > T(0.01));
    const auto before = m.command();
    now += 8ms;
    loop.joints.advance(seconds<double>(now));
    const auto out = step(loop.robot, m, loop.law_memory, loop.measure(now), now,
                          pushing<T>({T(3), bad, T(0), T(0), T(0), T(0)}));
    CHECK(out.status.has(Reason::torque_not_finite));
    CHECK(loop.law_memory.evaluations == evaluations);
    CHECK(m.group().v[0] < speed);
    check_limits<C::interface, T>(c.limits, before, out.command, 0.008);
  }
}

TEST_CASE_TEMPLATE("Resolver: without news of the robot it brakes and holds, and goes on when news come", C,
                   INTERFACES_AND_SCALARS) {
  using T = typename C::scalar;
  auto c = configuration<T>();
  ClosedLoop<C::interface, T> loop(c, pose, 0.008, 0.008);
  const Impulse impulse = [](double t) { return std::array<double, 6>{8 * t, 0, 0, 0, 0, 0}; };
  Nanoseconds now{};
  while (now < 500ms) loop.step(now += 8ms, impulse);
  CHECK(loop.memory.group().v[0] > T(0.2));
  auto& m = loop.memory;
  const State<6, T> old = loop.measure(now);
  const Nanoseconds silent = now;
  auto before = m.command();
  bool stale = false;
  const auto advanced = [&] { return loop.law_memory.evaluations; };
  auto evaluations = advanced();
  while (now < silent + 800ms) {
    now += 8ms;
    const auto out =
        step(loop.robot, m, loop.law_memory, old, now, pushing<T>({T(8), T(0), T(0), T(0), T(0), T(0)}));
    check_limits<C::interface, T>(c.limits, before, out.command, 0.008);
    before = out.command;
    const bool now_stale = out.status.has(Reason::state_stale);
    CHECK(now_stale == (now - silent > nanoseconds(5 * 0.024)));
    if (!stale && now_stale) evaluations = advanced();
    stale = now_stale;
  }
  CHECK(stale);
  CHECK(advanced() == evaluations);
  for (const T v : m.command().velocity) CHECK(std::abs(v) < T(1e-5));
  auto s = old;
  s.time = now += 8ms;
  const auto out = step(loop.robot, m, loop.law_memory, s, now, pushing<T>({}));
  CHECK_FALSE(out.status.has(Reason::state_stale));
  check_limits<C::interface, T>(c.limits, before, out.command, 0.008);
}

TEST_CASE_TEMPLATE("Resolver: a stop brakes and holds, a resume goes on without a jump", C,
                   INTERFACES_AND_SCALARS) {
  using T = typename C::scalar;
  auto c = configuration<T>();
  ClosedLoop<C::interface, T> loop(c, pose, 0.008, 0.008);
  const Impulse impulse = [](double t) { return std::array<double, 6>{8 * t, -9 * t, 0, 0, 0, 0.1 * t}; };
  Nanoseconds now{};
  auto before = loop.memory.command();
  const auto run = [&](Nanoseconds until) {
    Status seen;
    while (now < until) {
      now += 8ms;
      const auto out = loop.step(now, impulse);
      check_limits<C::interface, T>(c.limits, before, out.command, 0.008);
      before = out.command;
      seen |= out.status;
    }
    return seen;
  };
  run(500ms);
  loop.robot.stop(loop.memory);
  CHECK(run(1s).has(Reason::stopping));
  const auto evaluations = loop.law_memory.evaluations;
  const auto rest = loop.memory.command().position;
  CHECK(run(2s).has(Reason::stopping));
  CHECK(loop.law_memory.evaluations == evaluations);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(std::abs(loop.memory.command().velocity[i]) < T(1e-5));
    CHECK(std::abs(double(loop.memory.command().position[i] - rest[i])) < 1e-5);
  }
  loop.robot.resume(loop.memory);
  CHECK_FALSE(run(2500ms).has(Reason::stopping));
  CHECK(loop.memory.group().v[0] > T(0.2));
}

TEST_CASE_TEMPLATE("Resolver: time that goes back or stands still changes nothing", C,
                   INTERFACES_AND_SCALARS) {
  using T = typename C::scalar;
  auto c = configuration<T>();
  ClosedLoop<C::interface, T> loop(c, pose, 0.008, 0.008);
  const Impulse impulse = [](double t) { return std::array<double, 6>{8 * t, 0, 0, 0, 0, 0}; };
  Nanoseconds now{};
  while (now < 500ms) loop.step(now += 8ms, impulse);
  const auto command = loop.memory.command();
  for (const Nanoseconds wrong : {now, now - 1ns, 0ns, Nanoseconds::min(), Nanoseconds::max()}) {
    auto m = loop.memory;
    Yield::Memory law;
    const auto out = step(loop.robot, m, law, at<T>(pose, wrong), wrong, pushing<T>({}));
    CHECK(out.status == Status(wrong == now ? Reason::interval_empty : Reason::time_backwards));
    CHECK(out.command.position == command.position);
    CHECK(out.command.velocity == command.velocity);
    CHECK(law.evaluations == 0);
  }
  // A state from before the last one is refused, one from the future counts as of now.
  auto m = loop.memory;
  Yield::Memory law;
  CHECK(step(loop.robot, m, law, at<T>(pose, 8ms), now + 8ms, pushing<T>({}))
            .status.has(Reason::time_backwards));
  auto s = loop.measure(now);
  s.time = now + 3600s;
  m = loop.memory;
  CHECK_FALSE(step(loop.robot, m, law, s, now + 8ms, pushing<T>({})).status.has(Reason::time_backwards));
  CHECK(m.measured().time == now + 8ms);
}

TEST_CASE_TEMPLATE("Resolver: a robot that starts beyond a limit is only moved inward", C,
                   INTERFACES_AND_SCALARS) {
  using T = typename C::scalar;
  auto c = configuration<T>();
  auto beyond = pose;
  beyond[2] = 3.3;
  for (const double push : {20.0, -20.0}) {
    ClosedLoop<C::interface, T> loop(c, beyond, 0.008, 0.008);
    const Impulse impulse = [push](double t) { return std::array<double, 6>{0, 0, push * t, 0, 0, 0}; };
    double last = beyond[2];
    Status seen;
    for (Nanoseconds now = 8ms; now < 2s; now += 8ms) {
      seen |= loop.step(now, impulse).status;
      const double q = C::interface == Interface::position ? double(loop.memory.command().position[2])
                                                           : loop.joints.q()[2];
      if (last > double(c.limits.upper()[2])) CHECK(q <= last + 1e-6);
      last = q;
    }
    CHECK(seen.has(Reason::outside_limits));
    if (push < 0) CHECK(last < double(c.limits.upper()[2]));
  }
}

TEST_CASE_TEMPLATE("Resolver: goes on from what the guard let out", C, INTERFACES_AND_SCALARS) {
  using T = typename C::scalar;
  auto c = configuration<T>();
  ClosedLoop<C::interface, T> loop(c, pose, 0.008, 0.008);
  const Impulse impulse = [](double t) { return std::array<double, 6>{8 * t, 0, 0, 0, 0, 0}; };
  Nanoseconds now{};
  while (now < 500ms) loop.step(now += 8ms, impulse);
  auto instead = loop.memory.command();
  instead.velocity[0] = T(0.05);
  instead.position[0] -= T(0.001);
  loop.robot.sent(loop.memory, instead);
  const auto out = loop.step(now += 8ms, impulse);
  CHECK(double(out.command.velocity[0]) == doctest::Approx(0.05).epsilon(0.5));
  if (C::interface == Interface::position)
    CHECK(double(out.command.position[0] - instead.position[0]) == doctest::Approx(0.0005).epsilon(0.5));
}

TEST_CASE_TEMPLATE("Resolver: nothing creeps in half an hour of rest", C, Case<Interface::position, float>,
                   Case<Interface::velocity, float>, Case<Interface::position, double>) {
  using T = typename C::scalar;
  auto c = configuration<T>(2ms);
  const ResolverBy<C::interface, ur5::Model, T> robot(ur5::Model{}, c);
  auto m = robot.start(at<T>(pose));
  Yield::Memory law;
  Nanoseconds now{};
  for (int k = 0; k < (sanitized ? 100'000 : 1'000'000); ++k) {
    now += 2ms;
    auto s = m.measured();
    s.time = now;
    step(robot, m, law, s, now, pushing<T>({}));
  }
  for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(double(m.command().position[i]) - pose[i]) < 1e-6);
}

TEST_CASE_TEMPLATE("Resolver: slow motion is not lost to rounding", T, SKINCTL_SCALARS) {
  // 1e-6 rad/s at 500 Hz: a step is 1/60 of float's resolution at 1 rad.
  auto c = configuration<T>(2ms);
  const ResolverBy<Interface::position, ur5::Model, T> robot(ur5::Model{}, c);
  auto m = robot.start(at<T>({1, -1.5, 1.2, -1, -1.5, 0.3}));
  m.group().v[0] = m.group().rate[0] = T(1e-6);
  Yield::Memory law;
  Nanoseconds now{};
  const T hold = T(1e-6) * c.viscous_friction[0];
  const int cycles = rounds(500'000);
  for (int k = 0; k < cycles; ++k) {
    now += 2ms;
    auto s = m.measured();
    s.time = now;
    s.q = m.group().q.value;
    step(robot, m, law, s, now, pushing<T>({hold, T(0), T(0), T(0), T(0), T(0)}));
  }
  CHECK(double(m.group().q.value[0]) + double(m.group().q.rest[0]) ==
        doctest::Approx(1 + 2e-9 * cycles).epsilon(2e-5));
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

// Arbitrary bits in every field of the input, in between good cycles.
TEST_CASE_TEMPLATE("Resolver: whatever comes in, what goes out is finite and within limits", C,
                   INTERFACES_AND_SCALARS) {
  using T = typename C::scalar;
  auto c = configuration<T>();
  const bool ok = rc::check([&] {
    ClosedLoop<C::interface, T> loop(c, pose, 0.008, 0.008);
    const GuardAlone<C::interface, 6, T> guard(c);
    auto guarded = guard.start(loop.memory.command(), loop.measure(0ns));
    auto before = loop.memory.command();
    Nanoseconds now{};
    const int cycles = *rc::gen::inRange(1, 40);
    for (int k = 0; k < cycles; ++k) {
      State<6, T> s;
      Pushes<T> pushes;
      const auto kind = *rc::gen::inRange(0, 4);
      const auto word = [&] { return *rc::gen::arbitrary<std::uint64_t>(); };
      const Nanoseconds good = now + 8ms;
      Nanoseconds at_time = good;
      s = loop.measure(good);
      if (kind == 1) at_time = Nanoseconds(static_cast<std::int64_t>(word()));
      if (kind == 2) {
        s.time = Nanoseconds(static_cast<std::int64_t>(word()));
        for (auto& q : s.q) q = from_bits<T>(word());
        for (auto& dq : s.dq) dq = from_bits<T>(word());
      }
      if (kind == 3)
        for (auto& p : pushes)
          for (auto& tau : p.torque) tau = from_bits<T>(word());
      const auto interval = loop.robot.interval(loop.memory, at_time);
      const auto out = loop.robot.step(loop.memory, loop.law, loop.law_memory, s, interval,
                                       std::span<const Pushed<6, T>>(pushes), guard);
      if (interval.substeps > 0) {
        const double credit = seconds<double>(interval.to - interval.from);
        check_limits<C::interface, T>(c.limits, before, out.command, credit);
        now = interval.to;
      }
      RC_ASSERT(all_finite(out.command));
      before = out.command;
      const auto let = guard.step(guarded, out.command, loop.memory.measured(), at_time);
      RC_ASSERT(all_finite(let.command));
      for (std::size_t i = 0; i < 6; ++i)
        RC_ASSERT(std::abs(let.command.velocity[i]) <= c.limits.velocity()[i] * T(1.0001));
      if (let.altered) {
        loop.robot.sent(loop.memory, let.command);
        if (let.command.valid) before = let.command;  // a refused start lets nothing out
      }
      if (std::abs(now.count()) > (std::int64_t(1) << 60))
        break;  // a clock that jumped there does not come back
    }
  });
  CHECK(ok);
}
