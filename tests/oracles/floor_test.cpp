// by night: floors of the benchmarks
#include <doctest/doctest.h>

#include "bench/studies/floor/hand_floor.hpp"
#include "bench/studies/floor/ur5_floor.hpp"
#include "skinctl/dynamics/regressor.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/oracles/agreement.hpp"

using namespace oracle;

namespace {

/// Rounding of some hundred operations, relative to the largest entry of the result.
constexpr double rounding = 1e-14;

/// Twelve numbers a link: axes, then origin.
std::vector<Digits50> columns(const Definition::Pose& X) {
  std::vector<Digits50> x;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t r = 0; r < 3; ++r) x.push_back(X.R[3 * r + c]);
  x.insert(x.end(), X.p.begin(), X.p.end());
  return x;
}

}  // namespace

TEST_CASE("Floor: UR5 agrees with the definition in 50 digits") {
  namespace floor = bench_floor::ur5;
  const Definition definition(ur5());
  const Definition::Vec3 flange{0, 0, Digits50(ur5_flange[2])};
  const std::vector<double> K_d{7, 6, 5, 4, 3, 2};
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u})
    for (const State& s : states(seed, 6)) {
      CAPTURE(seed);
      CAPTURE(s.name);
      const auto q = widened(s.q), dq = widened(s.dq), ddq = widened(s.ddq), dq_r = widened(s.dq_r);
      std::vector<double> tau(6), M(36), X(72), J(36), X_again(72), J_again(36), tau_again(6);

      floor::floor_inverse_dynamics(s.q.data(), s.dq.data(), s.ddq.data(), tau.data());
      CHECK(difference(tau, definition.inverse_dynamics(q, dq, ddq)) < rounding);
      floor::floor_gravity(s.q.data(), tau.data());
      CHECK(difference(tau, definition.gravity(q)) < rounding);
      floor::floor_mass_matrix(s.q.data(), M.data());
      CHECK(difference(M, definition.mass_matrix(q)) < rounding);
      floor::floor_yr_theta(s.q.data(), s.dq.data(), s.dq_r.data(), s.ddq.data(), tau.data());
      CHECK(difference(tau, definition.yr_theta(q, dq, dq_r, ddq)) < rounding);

      floor::floor_fk_jacobian(s.q.data(), X.data(), J.data());
      const auto poses = definition.poses(q);
      for (std::size_t i = 0; i < 6; ++i)
        CHECK(difference(std::vector<double>(&X[12 * i], &X[12 * i] + 12), columns(poses[i])) < rounding);
      const auto J_exact = definition.jacobian(5, flange, q);
      std::vector<Digits50> J_columns;
      for (std::size_t c = 0; c < 6; ++c)
        for (std::size_t r = 0; r < 6; ++r) J_columns.push_back(J_exact[6 * r + c]);
      CHECK(difference(J, J_columns) < rounding);

      floor::floor_fk(s.q.data(), X_again.data());
      CHECK(difference(X_again, X) < rounding);
      floor::floor_fk_jacobian_yr_theta_kd(s.q.data(), s.dq.data(), s.dq_r.data(), s.ddq.data(), K_d.data(),
                                           X_again.data(), J_again.data(), tau_again.data());
      CHECK(difference(X_again, X) < rounding);
      CHECK(difference(J_again, J) < rounding);
      for (std::size_t i = 0; i < 6; ++i) tau[i] -= K_d[i] * (s.dq[i] - s.dq_r[i]);
      CHECK(difference(tau_again, tau) < rounding);

      if (s.name == "fast") continue;
      floor::floor_forward_dynamics(s.q.data(), s.dq.data(), s.ddq.data(), tau.data());
      CHECK(difference(tau, definition.forward_dynamics(q, dq, ddq)) < 1e-12);
    }
}

TEST_CASE("Floor: the UR5 with its inertial parameters as numbers is the UR5") {
  const auto theta = skinctl::inertial_parameters<double>(skinctl::ur5::Model{});
  for (const State& s : states(9, 6)) {
    CAPTURE(s.name);
    std::vector<double> tau(6), fixed(6);
    bench_floor::ur5::floor_regressor_product(s.q.data(), s.dq.data(), s.dq_r.data(), s.ddq.data(),
                                              theta.data, tau.data());
    bench_floor::ur5::floor_yr_theta(s.q.data(), s.dq.data(), s.dq_r.data(), s.ddq.data(), fixed.data());
    CHECK(difference(tau, fixed) < rounding);
  }
}

TEST_CASE("Floor: the hand agrees with the definition in 50 digits") {
  namespace floor = bench_floor::allegro;
  const Robot robot = without_fixed(allegro_right());
  const Definition definition(robot);
  const auto finger = [](const auto& x, std::size_t f) {
    return std::vector<Digits50>(x.begin() + static_cast<std::ptrdiff_t>(4 * f),
                                 x.begin() + static_cast<std::ptrdiff_t>(4 * f + 4));
  };
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u})
    for (const State& s : states(seed, 16)) {
      CAPTURE(seed);
      CAPTURE(s.name);
      const auto q = widened(s.q), dq = widened(s.dq), ddq = widened(s.ddq);
      std::vector<double> tau(16), G(16), M(40), X(192), acceleration(16);
      floor::floor_inverse_dynamics(s.q.data(), s.dq.data(), s.ddq.data(), tau.data());
      floor::floor_gravity(s.q.data(), G.data());
      floor::floor_mass_matrix(s.q.data(), M.data());
      floor::floor_forward_dynamics(s.q.data(), s.dq.data(), s.ddq.data(), acceleration.data());
      floor::floor_fk(s.q.data(), X.data());
      const auto tau_exact = definition.inverse_dynamics(q, dq, ddq), M_exact = definition.mass_matrix(q);
      const auto G_exact = definition.gravity(q), a_exact = definition.forward_dynamics(q, dq, ddq);
      const auto poses = definition.poses(q);
      for (std::size_t f = 0; f < 4; ++f) {
        CAPTURE(f);
        CHECK(difference(finger(tau, f), finger(tau_exact, f)) < rounding);
        CHECK(difference(finger(G, f), finger(G_exact, f)) < rounding);
        if (s.name != "fast") CHECK(difference(finger(acceleration, f), finger(a_exact, f)) < 1e-12);
        std::vector<double> entries;
        std::vector<Digits50> exact_entries;
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t j = 0; j <= i; ++j) {
            entries.push_back(M[4 * entries.size() + f]);
            exact_entries.push_back(M_exact[(4 * f + i) * 16 + 4 * f + j]);
          }
        CHECK(difference(entries, exact_entries) < rounding);
        for (std::size_t j = 0; j < 4; ++j) {
          const auto turn = floor::detail::quarter(floor::quarter_turns[f][j]);
          Definition::Pose pose = poses[4 * f + j];
          Definition::Mat3 exact_turn;
          std::copy(turn.begin(), turn.end(), exact_turn.begin());
          pose.R = table_detail::product(pose.R, exact_turn);
          std::vector<double> numbers;
          for (std::size_t i = 0; i < 12; ++i) numbers.push_back(X[4 * (12 * j + i) + f]);
          CHECK(difference(numbers, columns(pose)) < rounding);
        }
      }
    }
}
