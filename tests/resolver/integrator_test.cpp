// runs long: motions in small steps
#include "skinctl/resolver/integrator.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <random>

#include "skinctl/resolver/detail/velocity_step.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using skinctl::testing::Digits50;
namespace {

using Vector = Eigen::Matrix<double, 6, 1>;
using Matrix = Eigen::Matrix<double, 6, 6>;

Matrix mass(const Vector& q) {
  const auto m = mass_matrix(ur5::Model{}, JointPosition<6>(q));
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(m.data);
}

// The definition, by a fourth-order method and a general solver.
struct Reference {
  VirtualDynamics<6> shape;
  Vector torque;  // besides what holds gravity

  Vector acceleration(const Vector& q, const Vector& v) const {
    Matrix m = mass(q);
    m += Vector(Eigen::Map<const Vector>(shape.inertia.data)).asDiagonal();
    const auto c = coriolis_torque(ur5::Model{}, JointAngles<ur5::Model, double>({}, JointPosition<6>(q)),
                                   JointVelocity<6>(v));
    const Vector friction =
        Eigen::Map<const Vector>(shape.viscous.data).cwiseProduct(v) + shape.damping * (m * v);
    return m.partialPivLu().solve(torque - Eigen::Map<const Vector>(c.data) - friction);
  }
  void run(Vector& q, Vector& v, double time, int steps) const {
    const double h = time / steps;
    for (int k = 0; k < steps; ++k) {
      const Vector a1 = acceleration(q, v), v2 = v + h / 2 * a1;
      const Vector a2 = acceleration(q + h / 2 * v, v2), v3 = v + h / 2 * a2;
      const Vector a3 = acceleration(q + h / 2 * v2, v3), v4 = v + h * a3;
      const Vector a4 = acceleration(q + h * v3, v4);
      q += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
      v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
  }
};

template <class Policy, class T>
void run(const VirtualDynamics<6, T>& shape, const JointTorque<6, T>& push, JointPosition<6, T>& q,
         JointVelocity<6, T>& v, double time, int steps) {
  const T h = T(time / steps);
  JointAcceleration<6, T> last;
  const NoTouch none;
  for (int k = 0; k < steps; ++k) {
    const State<6, T> state{0ns, q, v};
    const Quantities<ur5::Model, Policy::needs | Needs{.gravity = true}, T> known(ur5::Model{}, state, h,
                                                                                  none);
    // Gravity that a law holds is held where the integrator takes it: at the start of the sub-step.
    const JointTorque<6, T> tau = push + known.gravity();
    const auto next = detail::step_velocity<Policy>(known, shape, false, tau, last);
    REQUIRE_FALSE(next.singular);
    for (std::size_t i = 0; i < 6; ++i) last[i] = (next.velocity[i] - v[i]) / h;
    for (std::size_t i = 0; i < 6; ++i) q[i] = q[i] + T(0.5) * h * (v[i] + next.velocity[i]);
    v = next.velocity;
  }
}

template <class Policy>
double error(int steps) {
  VirtualDynamics<6> shape;
  shape.viscous = {10, 8, 5, 1, 0.5, 0.2};
  shape.inertia = {0.1, 0.1, 0.1, 0.05, 0.05, 0.02};
  shape.damping = 1.5;
  const JointTorque<6> push{20, -15, 10, 2, 1, 0.3};
  Reference reference{shape, Vector(Eigen::Map<const Vector>(push.data))};
  const Vector q0(0.1, -1.2, 1.1, -0.7, 0.4, 0.2), v0(0.5, 1, -1, 2, -2, 1);
  Vector q = q0, v = v0;
  reference.run(q, v, 1.0, 4000);
  JointPosition<6> q1(q0);
  JointVelocity<6> v1(v0);
  run<Policy>(shape, push, q1, v1, 1.0, steps);
  return (Eigen::Map<const Vector>(q1.data) - q).norm() + (Eigen::Map<const Vector>(v1.data) - v).norm();
}

// A joint that turns 0.5 kg m^2 about a vertical axis.
struct Turntable {
  static constexpr std::size_t joints = 1;
  static constexpr auto parents = chain_parents<1>();
  static constexpr auto kinds = all_of_kind<1>(JointKind::revolute);
  static constexpr double gravity[3] = {0, 0, -9.81};
  static constexpr std::array<LinkParameters<double>, 1> links = {
      make_link({}, {1.0, {0, 0, 0}, 0.4, 0.4, 0.5})};
};
using Table = StaticModel<Turntable>;

template <class Policy, class T>
detail::VelocityStep<1, T> turn(const VirtualDynamics<1, T>& shape, bool coulomb, T tau, T v, T h) {
  const State<1, T> state{0ns, {}, JointVelocity<1, T>::constant(v)};
  const NoTouch none;
  const Quantities<Table, Policy::needs, T> known(Table{}, state, h, none);
  return detail::step_velocity<Policy>(known, shape, coulomb, JointTorque<1, T>::constant(tau),
                                       JointAcceleration<1, T>{});
}

template <std::size_t N, class T>
MassMatrix<N, T> random_mass(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd a(N, N);
  for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = normal(rng);
  const Eigen::MatrixXd m = a * a.transpose() + 0.05 * Eigen::MatrixXd::Identity(N, N);
  MassMatrix<N, T> out;
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) out(i, j) = T(m(Eigen::Index(i), Eigen::Index(j)));
  return out;
}

}  // namespace

TEST_CASE("Integrators: converge to the definition with their order") {
  const auto order = [](double coarse, double fine) { return std::log2(coarse / fine); };
  CHECK(order(error<CrankNicolson>(500), error<CrankNicolson>(1000)) > 1.85);
  CHECK(order(error<SemiImplicitEuler>(500), error<SemiImplicitEuler>(1000)) ==
        doctest::Approx(1).epsilon(0.1));
  CHECK(error<CrankNicolson>(500) < 2e-4);
  CHECK(error<CrankNicolson>(125) < 4e-3);
  CHECK(error<CrankNicolson>(500) < 0.02 * error<SemiImplicitEuler>(500));
}

TEST_CASE("CrankNicolson: without friction and pushes the kinetic energy stays") {
  const VirtualDynamics<6> none;
  JointPosition<6> q{0.1, -1.2, 1.1, -0.7, 0.4, 0.2};
  JointVelocity<6> v{0.5, 1, -1, 2, -2, 1};
  const auto energy = [&] {
    const Vector u = Eigen::Map<const Vector>(v.data);
    return 0.5 * u.dot(mass(Eigen::Map<const Vector>(q.data)) * u);
  };
  const double before = energy();
  run<CrankNicolson>(none, JointTorque<6>{}, q, v, 10.0, 5000);
  CHECK(energy() == doctest::Approx(before).epsilon(1e-3));
}

TEST_CASE_TEMPLATE("Integrators: constant torque against viscous friction is the closed form", P,
                   CrankNicolson, SemiImplicitEuler) {
  const double m = 0.5, tau = 3, h = 0.002;
  for (const double b : {0.0, 0.3, 2.0}) {
    for (const double decay : {0.0, 3.0}) {
      VirtualDynamics<1> shape;
      shape.viscous[0] = b;
      shape.damping = decay;
      const double rate = b / m + decay;
      double v = 0;
      for (int k = 0; k < 500; ++k) v = turn<P>(shape, false, tau, v, h).velocity[0];
      const double want = rate > 0 ? tau / m / rate * (1 - std::exp(-rate)) : tau / m;
      CHECK(v == doctest::Approx(want).epsilon(std::is_same_v<P, CrankNicolson> ? 1e-6 : 0.01));
    }
  }
}

TEST_CASE_TEMPLATE("Integrators: stiff friction never rings", P, CrankNicolson, SemiImplicitEuler) {
  for (const double z : {0.1, 0.9, 1.0, 1.5, 2.0, 3.0, 10.0, 1e3, 1e6}) {
    VirtualDynamics<1> shape;
    shape.viscous[0] = z * 0.5 / 0.002;
    double v = 1;
    for (int k = 0; k < 20; ++k) {
      const double next = turn<P>(shape, false, 0.0, v, 0.002).velocity[0];
      CAPTURE(z);
      CHECK(next >= 0);
      CHECK(next < v + 1e-300);
      if constexpr (std::is_same_v<P, CrankNicolson>) {
        if (z < 5 && k == 0) CHECK(std::abs(next - std::exp(-z)) < 0.03);
      }
      v = next;
    }
    // and settles where torque and friction balance
    for (int k = 0; k < 400; ++k) v = turn<P>(shape, false, 2.0, v, 0.002).velocity[0];
    CHECK(v == doctest::Approx(2.0 / shape.viscous[0]).epsilon(1e-6));
  }
}

TEST_CASE_TEMPLATE("Coulomb friction: sticks below, slides above, stops for good", T, float, double) {
  VirtualDynamics<1, T> shape;
  shape.coulomb[0] = T(2);
  const T h = T(0.002);
  for (const T tau : {T(0), T(1.9), T(-1.9)})
    CHECK(turn<CrankNicolson>(shape, true, tau, T(0), h).velocity[0] == T(0));
  CHECK(double(turn<CrankNicolson>(shape, true, T(3), T(0), h).velocity[0]) == doctest::Approx(0.002 / 0.5));
  CHECK(double(turn<CrankNicolson>(shape, true, T(-3), T(0), h).velocity[0]) ==
        doctest::Approx(-0.002 / 0.5));
  T v = T(0.0999);
  int steps = 0;
  for (; v != T(0) && steps < 100; ++steps) {
    v = turn<CrankNicolson>(shape, true, T(0), v, h).velocity[0];
    CHECK(v >= T(0));
  }
  CHECK(steps == 13);  // 0.0999 = 12.5 * 2 * 0.002 / 0.5
  for (int k = 0; k < 10; ++k) CHECK(turn<CrankNicolson>(shape, true, T(1.99), T(0), h).velocity[0] == T(0));
}

TEST_CASE_TEMPLATE("Coulomb friction: coupled joints satisfy the inclusion", T, float, double) {
  std::mt19937_64 rng(4);
  std::normal_distribution<double> normal;
  int stuck = 0, sliding = 0;
  for (int k = 0; k < 3000; ++k) {
    const auto m = random_mass<6, T>(rng);
    JointTorque<6, T> c, impulse;
    JointVelocity<6, T> v, u;
    for (std::size_t i = 0; i < 6; ++i) {
      c[i] = T(std::abs(normal(rng)));
      impulse[i] = T(normal(rng));
      v[i] = T(0.3 * normal(rng));
    }
    const math::Ldlt<6, T> factors(m.data);
    REQUIRE(factors.positive_definite());
    factors.solve(impulse.data, u.data);
    u += v;
    detail::stick_or_slip(m, c, impulse, v, u);
    double worst = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      double s = -double(impulse[i]);
      for (std::size_t j = 0; j < 6; ++j) s += double(m(i, j)) * (double(u[j]) - double(v[j]));
      // s = -c S
      if (u[i] == T(0)) {
        ++stuck;
        worst = std::max(worst, std::abs(s) - double(c[i]));
      } else {
        ++sliding;
        worst = std::max(worst, std::abs(s + (u[i] > T(0) ? 1 : -1) * double(c[i])));
      }
    }
    CHECK(worst < 2e3 * double(std::numeric_limits<T>::epsilon()));
  }
  CHECK(stuck > 1000);
  CHECK(sliding > 1000);
}

TEST_CASE("Integrators: run in multiprecision, and double agrees with it") {
  VirtualDynamics<6> shape;
  shape.viscous = {10, 8, 5, 1, 0.5, 0.2};
  shape.damping = 1;
  VirtualDynamics<6, Digits50> exact_shape{shape.viscous.cast<Digits50>(), {}, {}, Digits50(1)};
  JointPosition<6> q{0.1, -1.2, 1.1, -0.7, 0.4, 0.2};
  JointVelocity<6> v{0.5, 1, -1, 2, -2, 1};
  auto q_exact = q.cast<Digits50>();
  auto v_exact = v.cast<Digits50>();
  const JointTorque<6> push{20, -15, 10, 0.2, 0.1, 0.03};
  run<CrankNicolson>(shape, push, q, v, 0.0625, 32);
  run<CrankNicolson>(exact_shape, push.cast<Digits50>(), q_exact, v_exact, 0.0625, 32);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(std::abs(static_cast<double>(q_exact[i] - Digits50(q[i]))) < 1e-13);
    CHECK(std::abs(static_cast<double>(v_exact[i] - Digits50(v[i]))) < 1e-11);
  }
}
