#include "skinctl/passivity/energy_tank.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE_TEMPLATE("EnergyTank: the share costs what is left, all of it if that is enough", T, float,
                   double) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> exponent(-6, 3), sign(-1, 1);
  for (int k = 0; k < 10000; ++k) {
    const T w1 = T(std::copysign(std::pow(10, exponent(rng)), sign(rng))),
            w2 = T(std::pow(10, exponent(rng))), E = T(std::pow(10, exponent(rng)));
    const T share = affordable_share(w1, w2, E);
    CAPTURE(w1);
    CAPTURE(w2);
    CAPTURE(E);
    CHECK(share >= T(0));
    CHECK(share <= T(1));
    const T scale = std::abs(w1) + w2 + E;
    if (w1 + w2 <= E) {
      CHECK(share == T(1));
    } else {
      CHECK(std::abs(share * w1 + share * share * w2 - E) <=
            T(8) * std::numeric_limits<T>::epsilon() * scale);
    }
  }
}

TEST_CASE("EnergyTank: edges") {
  CHECK(affordable_share(1.0, 1.0, 0.0) == 0);
  CHECK(affordable_share(1.0, 0.0, -1.0) == 0);
  CHECK(affordable_share(-1.0, 0.5, 0.0) == 1);                     // it fills the tank
  CHECK(affordable_share(-1.0, 2.0, 0.0) == doctest::Approx(0.5));  // as far as it costs nothing
  CHECK(affordable_share(0.0, 4.0, 1.0) == doctest::Approx(0.5));
  CHECK(affordable_share(2.0, 0.0, 1.0) == doctest::Approx(0.5));
  CHECK(affordable_share(std::nan(""), 1.0, 1.0) == 0);
  CHECK(affordable_share(1.0, 1.0, std::nan("")) == 0);
  CHECK_THROWS_AS(EnergyTank<>({.start = -1}), ConfigurationError);
  CHECK_THROWS_AS(EnergyTank<>({.start = 2, .max = 1}), ConfigurationError);
  CHECK_THROWS_AS(EnergyTank<>({.port_gain = std::nan("")}), ConfigurationError);
}

namespace {

// One mass on a line, pushed by `active` and `port`, with friction `viscous`; the exact trapezoid of a held
// force.
struct Mass {
  double m = 2, viscous = 0, h = 1e-3, v = 0, x = 0;
  EnergyTank<> tank;
  EnergyTank<>::Memory<1> memory = tank.start<1>();

  double step(double port, double active) {
    MassMatrix<1> M;
    M(0, 0) = m;
    const auto after = [&](double f) {
      return JointVelocity<1>::constant((m * v + h * f - 0.5 * h * viscous * v) / (m + 0.5 * h * viscous));
    };
    const auto now = JointVelocity<1>::constant(v);
    tank.charge(memory, M, now);
    JointVelocity<1> v1 = after(port + active);
    const double share = tank.pay(memory, JointTorque<1>::constant(port), JointTorque<1>::constant(active),
                                  now, v1, h, [&] { return after(port); });
    const double dx = 0.5 * h * (v + v1[0]);
    VirtualDynamics<1> shape;
    shape.viscous[0] = viscous;
    tank.book(memory, JointPosition<1>::constant(dx), shape, h);
    v = v1[0];
    x += dx;
    return share;
  }
};

}  // namespace

TEST_CASE("EnergyTank: an active force turns the tank into motion, and nothing more") {
  Mass mass{.tank = EnergyTank<>({.start = 1, .max = 3})};
  bool faded = false;
  for (int k = 0; k < 5000; ++k) faded |= mass.step(0, 10) < 1;
  CHECK(faded);
  // All but a thousandth of the room, which is for surprises.
  CHECK(0.5 * mass.m * mass.v * mass.v == doctest::Approx(1 - 0.003).epsilon(1e-9));
  CHECK(mass.memory.energy == doctest::Approx(0.003).epsilon(1e-9));
  for (int k = 0; k < 5000; ++k) mass.step(0, -1);  // braking fills it
  CHECK(mass.memory.energy + 0.5 * mass.m * mass.v * mass.v == doctest::Approx(1).epsilon(1e-9));
}

TEST_CASE(
    "EnergyTank: a touch moves the robot whatever is in the tank, friction takes, and the room is bounded") {
  Mass free{.viscous = 5, .tank = EnergyTank<>({.start = 0, .max = 0.2})};
  for (int k = 0; k < 5000; ++k) CHECK(free.step(8, 0) == 1);
  CHECK(free.v == doctest::Approx(8 / 5.0).epsilon(1e-3));
  CHECK(free.memory.energy == doctest::Approx(0).epsilon(1e-9));
  // A force that works against the motion: what exceeds the room is lost.
  for (int k = 0; k < 5000; ++k) free.step(8, -3);
  CHECK(free.memory.energy == doctest::Approx(0.2));
}

TEST_CASE("EnergyTank: kinetic energy without a reason is charged") {
  Mass mass{.tank = EnergyTank<>({.start = 1, .max = 3})};
  mass.step(1, 0);
  mass.v += 0.4;
  mass.step(0, 0);
  const double v = 1e-3 / 2 + 0.4, old = 1e-3 / 2;
  CHECK(mass.memory.energy == doctest::Approx(1 - 0.5 * 2 * (v * v - old * old)).epsilon(1e-12));
  mass.v = 0;  // and none is credited
  mass.step(0, 0);
  CHECK(mass.memory.energy < 1);
}

// M dv = port - (damping M + viscous) v of two coupled joints, by the trapezoid: its kinetic energy changes
// by the work of the port less that of the friction, to rounding.
TEST_CASE(
    "EnergyTank: friction by mass is in the ledger: it costs nothing, and hides no gain that it would "
    "explain") {
  const double h = 1e-3;
  VirtualDynamics<2> shape;
  shape.damping = 3;
  shape.viscous = {0.5, 2.0};
  MassMatrix<2> M;
  M(0, 0) = 2, M(0, 1) = M(1, 0) = -0.9, M(1, 1) = 0.5;
  const auto after = [&](const JointVelocity<2>& v, const JointTorque<2>& port) {
    // (M + h/2 D) v1 = (M - h/2 D) v + h port, D = damping M + viscous
    const auto with = [&](int sign, std::size_t i, std::size_t j) {
      return M(i, j) + sign * 0.5 * h * (shape.damping * M(i, j) + (i == j ? shape.viscous[i] : 0.0));
    };
    double b[2];
    for (std::size_t i = 0; i < 2; ++i) b[i] = with(-1, i, 0) * v[0] + with(-1, i, 1) * v[1] + h * port[i];
    const double det = with(1, 0, 0) * with(1, 1, 1) - with(1, 0, 1) * with(1, 1, 0);
    return JointVelocity<2>{(with(1, 1, 1) * b[0] - with(1, 0, 1) * b[1]) / det,
                            (with(1, 0, 0) * b[1] - with(1, 1, 0) * b[0]) / det};
  };
  const auto kinetic = [&](const JointVelocity<2>& v) {
    return 0.5 * (M(0, 0) * v[0] * v[0] + 2 * M(0, 1) * v[0] * v[1] + M(1, 1) * v[1] * v[1]);
  };
  for (const JointVelocity<2>& begins : {JointVelocity<2>{1.5, -1.0}, {-1.0, -2.0}, {0.0, 0.0}}) {
    CAPTURE(begins[0]);
    const EnergyTank<> tank({.start = 1, .max = 3});
    auto memory = tank.start<2>();
    JointVelocity<2> v = begins;
    const auto step = [&](const JointTorque<2>& port) {
      tank.charge(memory, M, v);
      JointVelocity<2> v1 = after(v, port);
      const JointPosition<2> dq{0.5 * h * (v[0] + v1[0]), 0.5 * h * (v[1] + v1[1])};
      CHECK(tank.pay(memory, port, JointTorque<2>{}, v, v1, h, [&] { return v1; }) == 1);
      tank.book(memory, dq, shape, h);
      v = v1;
    };
    for (int k = 0; k < 300; ++k) step({k < 150 ? 4.0 : -1.0, k < 100 ? -3.0 : 1.0});
    CHECK(memory.energy == doctest::Approx(1).epsilon(1e-12));  // pushed and braked: nobody pays
    // A step of velocity that gives less than the friction takes is charged whole.
    v = {0.4, 0.3};
    step({});
    const double paid = memory.energy;
    v = {0.4, 0.3};
    const double before = kinetic(after(v, {}));
    CHECK(before < kinetic(v));
    step({});
    CHECK(paid - memory.energy == doctest::Approx(kinetic({0.4, 0.3}) - before).epsilon(1e-9));
  }
}

TEST_CASE(
    "EnergyTank: behind a torque interface the work of what was held is booked, port and gravity apart") {
  const EnergyTank<> tank({.start = 2, .max = 3, .port_gain = 0.5});
  auto m = tank.hold<1>();
  const auto Q = [](double x) { return JointPosition<1>::constant(x); };
  const auto V = [](double x) { return JointVelocity<1>::constant(x); };
  const auto Tau = [](double x) { return JointTorque<1>::constant(x); };
  tank.book(m, Q(1.0), Tau(0), Tau(0), 0.1, 0);  // nothing was sent yet
  CHECK(m.energy == 2);
  // Sent: 7 = port 0.5 * 4, gravity 3, friction -1, active 3. Port and gravity change while it is held.
  tank.sent(m, Tau(7.0), Tau(4.0), Tau(4.0), Tau(3.0));
  CHECK(m.active[0] == 3);
  tank.book(m, Q(0.1), Tau(4.0), Tau(3.0), 0.1, 0);
  CHECK(m.energy == doctest::Approx(2 - 0.3));  // friction is no gain
  tank.book(m, Q(-0.1), Tau(4.0), Tau(3.0), 0.1, 0);
  CHECK(m.energy == doctest::Approx(2 - 0.1));  // but what it gives is charged
  // 4 of held torque had no right to be there: 1 braked, 3 gave.
  tank.book(m, Q(0.1), Tau(-4.0), Tau(1.0), 0.1, 0);
  CHECK(m.energy == doctest::Approx(1.9 - 0.3 - 0.2));
  tank.sent(m, Tau(3.5));  // the guard has sent something else
  CHECK(m.active[0] == -0.5);
  for (int k = 0; k < 50; ++k) tank.book(m, Q(1.0), Tau(4.0), Tau(3.0), 0.1, 0);
  CHECK(m.energy == 3);
  // Mass 2, 0.1 s: from 1 rad/s all of 10 N m leads to 1.5 and costs 1.25 J.
  const auto move = [&](const JointTorque<1>& tau) { return V(1 + 0.1 * tau[0] / 2); };
  const auto share = [&] {
    auto active = Tau(10.0);
    return tank.pay(m, Tau(0), active, V(1), 0.1, 0, move);
  };
  const double reserve = 1e-3 * 3;
  m.energy = reserve + 1.25 * (1 + 1e-12);
  CHECK(share() == 1);
  m.energy = reserve + 0.5;  // a + a^2/4 = 1/2
  CHECK(share() == doctest::Approx(2 * (std::sqrt(1.5) - 1)));
  m.energy = reserve;
  CHECK(share() == 0);
  m.energy = -0.1;
  CHECK(share() == 0);
}

TEST_CASE(
    "EnergyTank: behind a delay the torque that acts is charged, and what is under way has to be payable") {
  const EnergyTank<> tank({.start = 5, .max = 5, .port_gain = 0});
  auto m = tank.hold<1>();
  const auto Q = [](double x) { return JointPosition<1>::constant(x); };
  const auto Tau = [](double x) { return JointTorque<1>::constant(x); };
  constexpr double h = 0.01, delay = 0.04;
  // A motion at 1 rad/s; cycle k is sent k N m, of which the first acts four cycles later.
  double drawn = 0;
  for (int k = 1; k <= 40; ++k) {
    tank.sent(m, Tau(k), Tau(0), Tau(0), Tau(0));
    tank.book(m, Q(h), Tau(0), Tau(0), h, delay);
    if (k > 4) drawn += h * (k - 4);
    CHECK(m.energy == doctest::Approx(std::min(5.0, 5 - drawn)).epsilon(1e-9));
  }
  // Of an infinitely heavy joint that is sent 10 N m from now on 10 (h + delay) J are drawn before an answer
  // is seen.
  auto paid = tank.hold<1>();
  const auto share = [&](double energy) {
    paid.energy = 0.005 + energy;
    auto active = Tau(10);
    return tank.pay(paid, Tau(0), active, JointVelocity<1>::constant(1.0), h, delay,
                    [](const JointTorque<1>&) { return JointVelocity<1>::constant(1.0); });
  };
  CHECK(share(0.5001) == 1);
  CHECK(share(0.25) == doctest::Approx(0.5));
  CHECK(paid.foresight.ahead[0] == doctest::Approx(h));
}

TEST_CASE(
    "EnergyTank: a joint that went further than predicted costs that twice from then on, until it fades") {
  const EnergyTank<> tank({.start = 3, .max = 3, .port_gain = 0});
  auto m = tank.hold<1>();
  const auto Q = [](double x) { return JointPosition<1>::constant(x); };
  const auto V = [](double x) { return JointVelocity<1>::constant(x); };
  const auto Tau = [](double x) { return JointTorque<1>::constant(x); };
  // Infinitely heavy: at 1 rad/s 0.1 s lead 0.1 rad further.
  const auto pay = [&](double v, double tau, double energy) {
    m.energy = 0.003 + energy;
    auto active = Tau(tau);
    const double share =
        tank.pay(m, Tau(0), active, V(v), 0.1, 0, [&](const JointTorque<1>&) { return V(v); });
    tank.sent(m, Tau(tau), Tau(0), Tau(0), Tau(0));
    return share;
  };
  CHECK(pay(1, 10, 1.0001) == 1);
  tank.book(m, Q(0.05), Tau(0), Tau(0), 0.1, 0);  // less is no surprise
  CHECK(pay(1, 10, 1.0001) == 1);
  tank.book(m, Q(0.12), Tau(0), Tau(0), 0.1, 0);  // 0.02 rad more: 10 (0.1 + 2 * 0.02) J
  CHECK(pay(1, 10, 0.7) == doctest::Approx(0.5));
  CHECK(pay(1, 10, 1.4001) == 1);
  // A torque that brakes is free if it fills the tank in spite of such a surprise.
  CHECK(pay(-1, 10, -1) == 1);
  CHECK(pay(-0.39, 10, -1) == 0);
  for (int k = 0; k < 3000; ++k) {
    tank.book(m, Q(-0.039), Tau(0), Tau(0), 0.1, 0);
    pay(-0.39, 10, -1);
  }
  CHECK(pay(-0.39, 10, -1) == 1);
  // What the guard sends instead was not predicted.
  tank.sent(m, Tau(1.0));
  tank.book(m, Q(5.0), Tau(0), Tau(0), 0.1, 0);
  CHECK(pay(1, 10, 1.01) == 1);
}

TEST_CASE(
    "EnergyTank: a joint that drives gets the share that is paid for, one that brakes keeps its torque") {
  const EnergyTank<> tank({.start = 1, .max = 1, .port_gain = 0});
  auto m = tank.hold<2>();
  // Mass 1; joint 0 is driven by 4 N m at 1 rad/s, joint 1 braked by 2 at -1 rad/s.
  constexpr double h = 0.1;
  const JointVelocity<2> v{1, -1};
  const auto move = [&](const JointTorque<2>& tau) {
    return JointVelocity<2>{v[0] + h * tau[0], v[1] + h * tau[1]};
  };
  JointTorque<2> active{4, 2};
  m.energy = 1e-3 - 0.1;  // a debt that the brake is about to pay
  const double share = tank.pay(m, JointTorque<2>{}, active, v, h, 0, move);
  CHECK(share > 0);
  CHECK(share < 1);
  CHECK(active[1] == 2);
  CHECK(active[0] == doctest::Approx(4 * share));
  const auto v1 = move(active);
  const double work = 0.5 * h * (active[0] * (v[0] + v1[0]) + active[1] * (v[1] + v1[1]));
  CHECK(m.energy - work == doctest::Approx(1e-3).epsilon(1e-9));  // nothing is left but the reserve
  JointTorque<2> more{4, 2};
  m.energy = 1e-3 - 1;  // more than it pays
  CHECK(tank.pay(m, JointTorque<2>{}, more, v, h, 0, move) == 0);
  CHECK(more[0] == 0);
  CHECK(more[1] == 2);
}
