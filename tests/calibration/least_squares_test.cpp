#include "skinctl/calibration/least_squares.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "skinctl/calibration/accelerometer.hpp"
#include "skinctl/calibration/nees.hpp"
#include "skinctl/calibration/sparse_inverse.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/derivatives.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

Eigen::Vector3d some(Random& rng, double size) {
  return size * Eigen::Vector3d(uniform<double>(rng), uniform<double>(rng), uniform<double>(rng));
}

// A rotation and a sensor from readings in known directions; `chain` of them, each tied to the next.
struct Sensors {
  struct One {
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    AccelerometerErrors errors;
  };
  using State = std::vector<One>;
  std::vector<Eigen::Vector3d> force;
  std::vector<std::vector<Eigen::Vector3d>> readings;
  Loss loss{};

  int unknowns() const { return 12 * int(readings.size()); }
  State plus(const State& x, const Eigen::VectorXd& d) const {
    State out = x;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Eigen::Matrix<double, 12, 1> e = d.segment<12>(12 * int(i));
      out[i].R = x[i].R * turn(e.head<3>());
      out[i].errors.bias += e.segment<3>(3);
      out[i].errors.scale += e.segment<3>(6);
      out[i].errors.misalignment += e.tail<3>();
    }
    return out;
  }
  template <class Sum>
  void terms(const State& x, Sum& sum) const {
    const AccelerometerPrior prior;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const int at = 12 * int(i);
      for (std::size_t k = 0; k < force.size(); ++k) {
        const auto y = reading_and_derivatives(x[i].R, x[i].errors, force[k]);
        Eigen::Matrix<double, 3, 12> J;
        J << y.by_turn, Eigen::Matrix3d::Identity(), Eigen::Matrix3d(y.by_scale.asDiagonal()),
            y.by_misalignment;
        J /= 0.0025;
        sum.add(loss, Eigen::Vector3d((y.y - readings[i][k]) / 0.0025), {{at, J}});
      }
      Eigen::Matrix<double, 9, 9> P = Eigen::Matrix<double, 9, 9>::Zero();
      P.diagonal() << Eigen::Vector3d::Constant(1 / prior.bias), Eigen::Vector3d::Constant(1 / prior.scale),
          Eigen::Vector3d::Constant(1 / prior.misalignment);
      Eigen::Matrix<double, 9, 1> e;
      e << x[i].errors.bias, x[i].errors.scale, x[i].errors.misalignment;
      sum.add({}, (P * e).eval(), {{at + 3, P}});
      if (i == 0) continue;
      const Eigen::Matrix3d tie = Eigen::Matrix3d::Identity() / 0.01;
      sum.add({}, (tie * (x[i].errors.bias - x[i - 1].errors.bias)).eval(),
              {{at + 3, tie}, {at - 9, (-tie).eval()}});
    }
  }
};

Sensors::State truth_of(Random& rng, std::size_t cells) {
  Sensors::State x(cells);
  for (auto& one : x) {
    one.R = turn(some(rng, 3));
    one.errors = {some(rng, 0.04), some(rng, 0.02), some(rng, 0.01)};
  }
  return x;
}

Sensors readings_of(Random& rng, const Sensors::State& x, double noise) {
  Sensors p;
  for (int k = 0; k < 8; ++k) p.force.push_back(some(rng, 1).normalized());
  for (const auto& one : x) {
    auto& y = p.readings.emplace_back();
    for (const auto& f : p.force) y.push_back(reading(one.R, one.errors, f) + some(rng, noise));
  }
  return p;
}

}  // namespace

TEST_CASE("Accelerometer: derivatives are those of the reading; an ideal one reads the force in its axes") {
  auto rng = seeded(1);
  for (int trial = 0; trial < 5; ++trial) {
    const auto x = truth_of(rng, 2);
    auto p = readings_of(rng, x, 0.01);
    CHECK(worst_derivative(p, x) < 1e-7);
  }
  const Eigen::Matrix3d R = turn({0.3, -2, 1});
  CHECK((reading(R, {}, {0, 0, 1}) - R.transpose().col(2)).norm() < 1e-15);
}

TEST_CASE("Least squares: dense, sparse and a fit from 40 degrees away find the same") {
  auto rng = seeded(2);
  const auto x = truth_of(rng, 6);
  const auto p = readings_of(rng, x, 1e-3);
  Sensors::State start(6);
  for (std::size_t i = 0; i < 6; ++i) start[i].R = x[i].R * turn(some(rng, 0.6));
  const auto dense = least_squares(p, start);
  const auto sparse = least_squares<SparseNormal>(p, start);
  REQUIRE(dense.converged());
  REQUIRE(sparse.converged());
  CHECK(dense.cost < dense.first_cost);
  CHECK(std::abs(dense.cost - sparse.cost) < 1e-6);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK((dense.state[i].R - sparse.state[i].R).norm() < 1e-5);
    CHECK(turn_vector(dense.state[i].R.transpose() * x[i].R).norm() < 0.03);
  }
  // The inverse on the pattern of the factor is the whole inverse there.
  const SparseNormal::Matrix H = sparse.normal.information();
  Eigen::MatrixXd symmetric = H;
  for (int i = 0; i < 72; ++i)
    for (int j = 0; j < i; ++j) symmetric(j, i) = symmetric(i, j);
  const Eigen::MatrixXd whole = detail::Cholesky(symmetric).inverse();
  const SparseInverse part(H);
  REQUIRE(part.valid());
  double worst = 0;
  for (int i = 0; i < 72; ++i)
    for (int j = i / 12 * 12; j < i / 12 * 12 + 12; ++j)
      worst = std::max(worst, std::abs(part(i, j) - whole(i, j)) / std::sqrt(whole(i, i) * whole(j, j)));
  CHECK(worst < 1e-8);
  CHECK(std::isnan(part(0, 24)));  // turns of cells that share no term
}

TEST_CASE(
    "Least squares: directions of which the data say nothing are named, and the rest is as without them") {
  auto rng = seeded(3);
  const auto x = truth_of(rng, 1);
  auto p = readings_of(rng, x, 1e-3);
  for (auto& f : p.force) f = {0, 0, 1};  // turning about it changes nothing
  for (auto& y : p.readings[0]) y = reading(x[0].R, x[0].errors, {0, 0, 1});
  const auto fit = least_squares(p, x);
  Eigen::VectorXd scale(12);
  scale << 1, 1, 1, Eigen::VectorXd::Constant(9, 0.04);
  const auto seen = fit.normal.observed(scale, 3);
  REQUIRE(seen.unseen.cols() == 1);
  const Eigen::Vector3d up = x[0].R.transpose().col(2);
  CHECK(std::abs(std::abs(seen.unseen.col(0).head<3>().normalized().dot(up)) - 1) < 1e-3);
  CHECK(seen.deviation(0) > 1e3);
}

TEST_CASE(
    "Least squares: of a robust loss a third of wrong readings moves the result by a tenth of what they move "
    "squares by") {
  auto rng = seeded(4);
  const auto x = truth_of(rng, 1);
  auto p = readings_of(rng, x, 1e-3);
  for (std::size_t k = 0; k < 12; ++k) {
    p.force.push_back(some(rng, 1).normalized());
    p.readings[0].push_back(reading(x[0].R, x[0].errors, p.force.back()) + some(rng, 1e-3));
  }
  for (std::size_t k = 0; k < 20; k += 3) p.readings[0][k] = some(rng, 1);
  const auto off = [&](const Sensors::State& found) {
    return (reading(found[0].R, found[0].errors, {0, 0, 1}) - reading(x[0].R, x[0].errors, {0, 0, 1})).norm();
  };
  const auto square = least_squares(p, x);
  p.loss = {Loss::Kind::cauchy, 2};
  const auto cauchy = least_squares(p, x);
  p.loss = {Loss::Kind::huber, 2};
  const auto huber = least_squares(p, x);
  CHECK(cauchy.converged());
  CHECK(huber.converged());
  CHECK(off(cauchy.state) < 0.005);
  CHECK(off(cauchy.state) < 0.1 * off(square.state));
  CHECK(off(huber.state) < 0.3 * off(square.state));
}

TEST_CASE("Least squares: what is not finite, and settings out of range, are said") {
  auto rng = seeded(5);
  const auto x = truth_of(rng, 1);
  auto p = readings_of(rng, x, 1e-3);
  p.readings[0][3].x() = std::numeric_limits<double>::quiet_NaN();
  const auto fit = least_squares(p, x);
  CHECK(fit.end == FitEnd::not_finite);
  CHECK(name(fit.end) == "not finite");
  CHECK_THROWS_WITH_AS((void)least_squares(p, x, {.steps = 0}),
                       "skinctl: fit: steps = 0, allowed: 1 to 10000", ConfigurationError);
  CHECK(std::isnan(nees(Eigen::Vector2d(1, 1), Eigen::Matrix2d(Eigen::Vector2d(1, -1).asDiagonal()))));
  CHECK(nees(Eigen::Vector2d(2, 1), Eigen::Matrix2d(Eigen::Vector2d(4, 1).asDiagonal())) ==
        doctest::Approx(2));
}
