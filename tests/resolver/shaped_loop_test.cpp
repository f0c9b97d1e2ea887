// runs long: hands and arms in contact
// by night: by day passivity/ and tactile/wrist_sensor_test.cpp have the shape in scenes, robot/ its numbers
// A resolver whose virtual robot is shaped at the tool, against simulated joints.
#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <complex>
#include <random>

#include "skinctl/passivity/contact_stability.hpp"
#include "skinctl/robot/tool_shape.hpp"
#include "tests/support/closed_loop.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Shape = ToolShape<5>;
using Robot = ResolverBy<Interface::position, ur5::Model, double, CrankNicolson, 128, Passivity<>, Shape>;

Shape::Settings settings() {
  return {.X_LT = {{}, {0, 0, 0.1}},
          .mass = Shape::diagonal({6, 8, 5, 0.3, 0.4, 0.25}),
          .damping = Shape::diagonal({60, 20, 40, 2, 3, 1})};
}
RobotConfiguration<6> configuration(Nanoseconds period) {
  return {.limits = limits_of<ur5::Description>(200.0),
          .period = period,
          .delay = 8ms,
          .lag = 8ms,
          .virtual_damping = 0};
}
// Rows of the tool's Jacobian.
struct Rows {
  double of[6][6];
  explicit Rows(const JointPosition<6>& q) {
    const auto terms = Shape(settings()).at(ur5::Model{}, q);
    for (std::size_t k = 0; k < 6; ++k)
      for (std::size_t i = 0; i < 6; ++i) of[k][i] = terms.J[k][i];
  }
};

// `push(t)` is the anti-derivative of the joint torque.
struct Loop {
  Robot robot;
  SimulatedJoints<6> joints;
  Robot::Memory memory;
  Yield law{};
  Yield::Memory law_memory{};
  Nanoseconds period, now{};

  Loop(const Shape& shape, Nanoseconds p, const JointPosition<6>& q)
      : robot(ur5::Model{}, configuration(p), Passivity<>(), shape),
        joints(SimulatedJoints<6>::Kind::position, 0.008, 0.008, array(q)),
        memory(robot.start({0ns, q, {}})),
        period(p) {}
  static std::array<double, 6> array(const JointPosition<6>& q) {
    std::array<double, 6> a;
    for (std::size_t i = 0; i < 6; ++i) a[i] = q[i];
    return a;
  }
  JointPosition<6> q() const { return JointPosition<6>(joints.q()); }

  auto step(const Impulse& impulse) {
    now += period;
    joints.advance(seconds<double>(now));
    const auto interval = robot.interval(memory, now);
    Pushed<6, double> pushes[max_substeps];
    for (unsigned j = 0; j < interval.substeps; ++j) {
      const double a = seconds<double>(interval.at(j)), b = seconds<double>(interval.at(j + 1));
      const auto from = impulse(a), to = impulse(b);
      for (std::size_t i = 0; i < 6; ++i) pushes[j].torque[i] = (to[i] - from[i]) / (b - a);
    }
    const auto out = robot.step(memory, law, law_memory, {now, q(), JointVelocity<6>(joints.dq())}, interval,
                                std::span<const Pushed<6, double>>(pushes, interval.substeps));
    joints.command(seconds<double>(now), array(out.command.position));
    return out;
  }
};

}  // namespace

TEST_CASE(
    "Resolver shaped at the tool: pushed in any direction the real tool has the configured admittance, at "
    "any rate") {
  const Shape shape(settings());
  const JointPosition<6> q0{0.1, -1.2, 1.4, -1.0, 1.2, 0.3};
  const Rows J(q0);
  for (const Nanoseconds period : {8ms, 2ms})
    for (std::size_t way = 0; way < 6; ++way) {
      Loop loop(shape, period, q0);
      const double w = 0.05 / loop.robot.total_delay(), cycle = 2 * M_PI / w, dt = seconds<double>(period);
      const double amplitude = way < 3 ? 0.5 : 0.03;
      // A cosine that grows over four cycles.
      const auto grown = [&](double t) {
        const double k = w / 8;
        return 0.5 * std::sin(w * t) / w -
               0.25 * (std::sin((w + k) * t) / (w + k) + std::sin((w - k) * t) / (w - k));
      };
      const Impulse push = [&](double t) {
        const double ramp = 4 * cycle;
        const double f = t < ramp ? grown(t) : grown(ramp) + (std::sin(w * t) - std::sin(w * ramp)) / w;
        std::array<double, 6> out{};
        for (std::size_t i = 0; i < 6; ++i) out[i] = amplitude * f * J.of[way][i];
        return out;
      };
      const auto begin = std::lround(8 * cycle / dt), end = begin + std::lround(2 * cycle / dt);
      std::complex<double> sum = 0;
      auto last = loop.q();
      Status status;
      for (long n = 1; n <= end; ++n) {
        status |= loop.step(push).status;
        const auto q = loop.q();
        if (n > begin) {
          double dx = 0;
          for (std::size_t i = 0; i < 6; ++i) dx += J.of[way][i] * (q[i] - last[i]);
          sum += dx * std::exp(std::complex<double>(0, -w * (double(n) - 0.5) * dt));
        }
        last = q;
      }
      const double over = double(end - begin) * dt * std::sin(0.5 * w * dt) / (0.5 * w * dt);
      const std::complex<double> got = 2.0 * sum / over;
      const auto want =
          amplitude / std::complex<double>(settings().damping[way][way], w * settings().mass[way][way]);
      CAPTURE(way);
      CAPTURE(period);
      CHECK(status == Status{});
      CHECK(std::abs(got - want) < 0.05 * std::abs(want));
    }
}

TEST_CASE(
    "Resolver shaped at the tool: next to a singularity pushes move the arm without a step, and it comes to "
    "rest") {
  const Shape shape(settings());
  std::mt19937_64 rng(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 8; ++k) {
    const JointPosition<6> q0{0.1, -1.2, 0.02 * unit(rng), 0.4, k % 2 == 0 ? 0.0 : -1.5, 0.2};
    Loop loop(shape, 4ms, q0);
    const Rows J(q0);
    std::array<double, 6> tau{};
    for (std::size_t way = 0; way < 3; ++way) {
      const double force = 40 * unit(rng);
      for (std::size_t i = 0; i < 6; ++i) tau[i] += force * J.of[way][i];
    }
    const Impulse push = [&](double t) {
      std::array<double, 6> out{};
      for (std::size_t i = 0; i < 6; ++i) out[i] = tau[i] * std::clamp(t - 0.1, 0.0, 0.5);
      return out;
    };
    JointVelocity<6> before{};
    double fastest = 0;
    bool finite = true, steady = true, regular = true;
    while (loop.now < 6s) {
      const auto out = loop.step(push);
      for (std::size_t i = 0; i < 6; ++i) {
        finite = finite && std::isfinite(out.command.position[i]);
        steady = steady && std::abs(out.command.velocity[i] - before[i]) <= 200 * 0.004 * (1 + 1e-9);
        fastest = std::max(fastest, std::abs(out.command.velocity[i]));
      }
      regular = regular && !out.status.has(Reason::singular);
      before = out.command.velocity;
    }
    CAPTURE(k);
    CHECK(finite);
    CHECK(steady);
    CHECK(regular);
    CHECK(fastest > 0.05);
    for (const double v : before) CHECK(std::abs(v) < 1e-3);
  }
}

TEST_CASE("Resolver shaped at the tool: the stiffest contact is known for it too") {
  // Friction alone: the virtual robot integrates the force, the real one follows by delay and lag.
  auto s = settings();
  s.mass = Shape::diagonal({0.5, 0.5, 0.5, 0.02, 0.02, 0.02});
  s.damping = Shape::diagonal({4000, 4000, 4000, 100, 100, 100});
  s.min_mass_ratio = 0.01;
  const Shape shape(s);
  auto c = configuration(8ms);
  c.force_lead = 0ns;
  const JointPosition<6> q{0.1, -1.2, 1.4, -1.0, 1.2, 0.3};
  const ContactStability<ur5::Model, double, Shape> stability(ur5::Model{}, c, {.stiffness = 1e4}, shape);
  const Rows J(q);
  const double k = stability.stiffest(q, J.of[2]);
  // Cycle by cycle: a command arrives a period later, when the cycle has just measured.
  const auto grows = [](double stiffness) {
    const double decay = std::exp(-1.0), per_force = 0.5 * 0.008 / 4000;
    double q2 = 1, q1 = 1, x = 1, force = 0;  // the command of two cycles ago and of the last one
    double early = 0, late = 0;
    for (int n = 0; n < 4000 && std::abs(x) < 1e100; ++n) {
      x = decay * x + (1 - decay) * q2;
      const double next = q1 - per_force * (stiffness * x + force);
      force = stiffness * x;
      q2 = q1, q1 = next;
      if (n >= 1000 && n < 2000) early = std::max(early, std::abs(x));
      if (n >= 3000) late = std::max(late, std::abs(x));
    }
    return std::abs(x) >= 1e100 || late > early;
  };
  double low = 1e4, high = 1e7;
  for (int n = 0; n < 40; ++n) (grows(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
  CHECK(k == doctest::Approx(low).epsilon(0.01));
}
