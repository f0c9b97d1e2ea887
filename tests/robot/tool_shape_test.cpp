#include "skinctl/robot/tool_shape.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "skinctl/resolver/detail/velocity_step.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using skinctl::testing::complaint_of;

namespace {

// A matrix of any size; the plainest there is, and quick to compile.
struct Matrix {
  std::size_t rows, columns;
  std::vector<double> data = std::vector<double>(rows * columns);

  double& operator()(std::size_t i, std::size_t j) { return data[i * columns + j]; }
  double operator()(std::size_t i, std::size_t j) const { return data[i * columns + j]; }
  static Matrix identity(std::size_t n) {
    Matrix m{n, n};
    for (std::size_t i = 0; i < n; ++i) m(i, i) = 1;
    return m;
  }
  Matrix transposed() const {
    Matrix m{columns, rows};
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < columns; ++j) m(j, i) = (*this)(i, j);
    return m;
  }
  double norm() const {
    double sum = 0;
    for (const double x : data) sum += x * x;
    return std::sqrt(sum);
  }
  // Gauss and Jordan, with pivots.
  Matrix inverse() const {
    Matrix a = *this, b = identity(rows);
    for (std::size_t k = 0; k < rows; ++k) {
      std::size_t best = k;
      for (std::size_t i = k; i < rows; ++i)
        if (std::abs(a(i, k)) > std::abs(a(best, k))) best = i;
      for (std::size_t j = 0; j < rows; ++j) std::swap(a(k, j), a(best, j)), std::swap(b(k, j), b(best, j));
      const double pivot = a(k, k);
      for (std::size_t j = 0; j < rows; ++j) a(k, j) /= pivot, b(k, j) /= pivot;
      for (std::size_t i = 0; i < rows; ++i) {
        const double f = i == k ? 0 : a(i, k);
        for (std::size_t j = 0; j < rows; ++j) a(i, j) -= f * a(k, j), b(i, j) -= f * b(k, j);
      }
    }
    return b;
  }
  // Whether Cholesky finds factors.
  bool positive() const {
    Matrix l{rows, rows};
    for (std::size_t j = 0; j < rows; ++j)
      for (std::size_t i = j; i < rows; ++i) {
        double sum = (*this)(i, j);
        for (std::size_t p = 0; p < j; ++p) sum -= l(i, p) * l(j, p);
        if (i == j && !(sum > 0)) return false;
        l(i, j) = i == j ? std::sqrt(sum) : sum / l(j, j);
      }
    return true;
  }
};
Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix m{a.rows, b.columns};
  for (std::size_t i = 0; i < m.rows; ++i)
    for (std::size_t j = 0; j < m.columns; ++j)
      for (std::size_t k = 0; k < a.columns; ++k) m(i, j) += a(i, k) * b(k, j);
  return m;
}
Matrix operator*(double s, Matrix a) {
  for (double& x : a.data) x *= s;
  return a;
}
Matrix operator-(Matrix a, const Matrix& b) {
  for (std::size_t i = 0; i < a.data.size(); ++i) a.data[i] -= b.data[i];
  return a;
}
template <std::size_t N>
Matrix matrix(const std::array<std::array<double, N>, N>& m) {
  Matrix out{N, N};
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) out(i, j) = m[i][j];
  return out;
}
Matrix matrix(const MassMatrix<6>& m) {
  return {6, 6, std::vector<double>(m.data, m.data + 36)};
}

using Shape6 = ToolShape<5>;
using Shape3 = ToolShape<5, 3>;
const Transform<Link<5>, Tool> flange{{}, {0, 0, 0.1}};

Shape6::Settings whole() {
  return {.X_LT = flange,
          .mass = Shape6::diagonal({6, 8, 5, 0.3, 0.4, 0.25}),
          .damping = Shape6::diagonal({60, 20, 40, 2, 3, 1})};
}
Shape3::Settings translation() {
  Shape3::Settings s{
      .X_LT = flange, .mass = Shape3::diagonal({6, 8, 5}), .damping = Shape3::diagonal({60, 20, 40})};
  s.mass[0][1] = s.mass[1][0] = 1;
  return s;
}
Matrix jacobian_at(const JointPosition<6>& q, std::size_t rows = 6) {
  Matrix J{rows, 6};
  const auto of_flange = jacobian<5>(Poses<ur5::Model, all_links(6), double>(ur5::Model{}, q), flange);
  of_flange.for_each([&](auto i, const auto& c) {
    const double column[6] = {c.linear.x, c.linear.y, c.linear.z, c.angular.x, c.angular.y, c.angular.z};
    for (std::size_t k = 0; k < rows; ++k) J(k, i.value) = column[k];
  });
  return J;
}

}  // namespace

TEST_CASE("ToolShape: refuses what is no mass and no friction") {
  const auto refused = [](auto&& change) {
    auto s = translation();
    change(s);
    return complaint_of([&] { const Shape3 shape(s); });
  };
  CHECK(refused([](auto&) {}).empty());
  CHECK(refused([](auto& s) { s.damping = {}; }).empty());
  CHECK(refused([](auto& s) { s.mass[1][1] = 0; }).find("positive definite") != std::string::npos);
  CHECK(refused([](auto& s) { s.mass[1][0] = 2; }).find("symmetric") != std::string::npos);
  CHECK(refused([](auto& s) { s.mass[0][1] = s.mass[1][0] = 50; }).find("positive definite") !=
        std::string::npos);
  CHECK(refused([](auto& s) { s.damping[2][2] = -1; }).find("semi-definite") != std::string::npos);
  CHECK(refused([](auto& s) { s.damping[2][2] = std::nan(""); }).find("damping") != std::string::npos);
  CHECK(refused([](auto& s) { s.rest_decay = -1; }).find("decay") != std::string::npos);
  CHECK(refused([](auto& s) { s.min_mass_ratio = 0; }).find("0.01 to 0.3") != std::string::npos);
}

TEST_CASE_TEMPLATE("ToolShape: the tool has the configured mass and friction, the rest is the joints' own",
                   Shape, Shape6, Shape3) {
  const Shape shape([] {
    if constexpr (Shape::rows == 6) {
      return whole();
    } else {
      return translation();
    }
  }());
  const Matrix Lambda = matrix(shape.settings().mass), D = matrix(shape.settings().damping);
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> angle(-3, 3);
  int compared = 0;
  bool reached = false;
  for (int k = 0; k < 1000; ++k) {
    JointPosition<6> q;
    for (double& x : q) x = angle(rng);
    if (k % 4 == 0) q[2] = 1e-4 * double(k % 3), q[4] = 0;  // stretched out, wrist straight
    const auto terms = shape.at(ur5::Model{}, q);
    const Matrix M = matrix(terms.mass), M0 = matrix(mass_matrix(ur5::Model{}, q)),
                 B = matrix(terms.friction);
    CHECK((M - 0.15 * M0).positive());
    reached = reached || !(M - 0.2 * M0).positive();
    CHECK((B - -1e-9 * Matrix::identity(6)).positive());
    const Matrix J = jacobian_at(q, Shape::rows), back = J.transposed(), mobile = M0.inverse() * back;
    const Matrix mobility = J * mobile;
    if (!(mobility - 0.225 * Lambda.inverse()).positive()) continue;  // lighter than 0.225 of what it is
    ++compared;
    const Matrix felt = (J * M.inverse() * back).inverse();
    CHECK((felt - Lambda).norm() < 0.05 * Lambda.norm());
    // In steady motion under F: the tool at D^-1 F.
    if constexpr (Shape::rows == 6) CHECK(((J * B.inverse() * back).inverse() - D).norm() < 0.1 * D.norm());
    // What does not move the tool has the joints' inertia.
    const Matrix P = Matrix::identity(6) - mobile * mobility.inverse() * J;
    CHECK((P.transposed() * (M - M0) * P).norm() < 0.03 * M0.norm());
  }
  CHECK(compared > 50);
  CHECK(reached);
}

TEST_CASE("ToolShape: nothing jumps on the way through a singularity") {
  const Shape3 shape(translation());
  Matrix last{6, 6};
  double largest = 0;
  constexpr int most = skinctl::testing::sanitized ? 2000 : 20000;  // the elbow is straight in the middle
  for (int k = -most; k <= most; ++k) {
    const JointPosition<6> q{0.1, -1.2, 2e-5 * k, 0.4, -1.5, 0.2};  // elbow bent, straight, bent
    const Matrix M = matrix(shape.at(ur5::Model{}, q).mass);
    if (k > -most) largest = std::max(largest, (M - last).norm() / last.norm());
    last = M;
  }
  CHECK(largest < 2e-3);  // for 2e-5 rad
}

TEST_CASE("ToolShape: a free tool of one mass flies straight on, without friction") {
  Shape6::Settings s{.X_LT = flange, .mass = Shape6::diagonal({5, 5, 5, 0.3, 0.3, 0.3})};
  s.rest_decay = 0;
  const Shape6 shape(s);
  const ur5::Model model;
  JointPosition<6> q{0.1, -1.2, 1.4, -1.0, 1.2, 0.3};
  const Matrix twist{6, 1, {0.3, -0.2, 0.15, 0.3, 0.2, -0.4}}, v0 = jacobian_at(q).inverse() * twist;
  JointVelocity<6> v;
  for (std::size_t i = 0; i < 6; ++i) v[i] = v0(i, 0);
  JointAcceleration<6> last;
  const NoTouch none;
  const auto place = [&] {
    return (Poses<ur5::Model, all_links(6), double>(model, q).get<5>() * flange).origin();
  };
  const Xyz<double> from = place();
  const double h = 0.001;
  for (int k = 0; k < 500; ++k) {
    const State<6> state{0ns, q, v};
    const Quantities<ur5::Model, CrankNicolson::needs | Needs{.gravity = true}> known(model, state, h, none);
    const auto next = detail::step_velocity<CrankNicolson>(known, VirtualDynamics<6>{}, false,
                                                           known.gravity(), last, shape);
    REQUIRE_FALSE(next.singular);
    for (std::size_t i = 0; i < 6; ++i) last[i] = (next.velocity[i] - v[i]) / h;
    for (std::size_t i = 0; i < 6; ++i) q[i] += 0.5 * h * (v[i] + next.velocity[i]);
    v = next.velocity;
  }
  const Xyz<double> moved = place() - from;
  CHECK(moved.x == doctest::Approx(0.15).epsilon(0.01));
  CHECK(moved.y == doctest::Approx(-0.10).epsilon(0.01));
  CHECK(moved.z == doctest::Approx(0.075).epsilon(0.01));
  const Matrix after = jacobian_at(q) * Matrix{6, 1, std::vector<double>(v.begin(), v.end())};
  CHECK((after - twist).norm() < 0.01 * twist.norm());
}

TEST_CASE_TEMPLATE("real_of_inverse: has the eigenvalues that it should, in float too", T, float, double) {
  // r = Q diag(rho) Q' with a rotation Q of two axes at a time.
  const T rho[3] = {T(0), T(0.02), T(40)}, a = T(0.02);
  T r[3][3] = {}, want[3][3] = {}, z[3][3];
  const T Q[3][3] = {{T(0.36), T(0.48), T(-0.8)}, {T(-0.8), T(0.6), T(0)}, {T(0.48), T(0.64), T(0.6)}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) {
        r[i][j] += Q[i][k] * rho[k] * Q[j][k];
        want[i][j] += Q[i][k] * rho[k] / (rho[k] * rho[k] + a * a) * Q[j][k];
      }
  detail::real_of_inverse(r, a, z);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      CHECK(std::abs(double(z[i][j] - want[i][j])) < 1e5 * double(std::numeric_limits<T>::epsilon()));
}
