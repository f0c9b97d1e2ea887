// The regressor and its products, and energies, beside inverse dynamics with fixed parameters. KDL, whose
// bodies are numbers at run time, has the product with parameters in one inverse dynamics, and the regressor
// in one for each of 60 bodies that span the parameters (with dq_r = dq).
#include <memory>
#include <vector>

#include "bench/studies/floor/ur5_floor.hpp"
#include "bench/support/rows.hpp"
#include "skinctl/dynamics/energy.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/regressor.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/kdl_oracle.hpp"

using namespace skinctl;

namespace {

template <class T>
void rows() {
  const std::string end = std::string("/ur5/skinctl/") + bench::scalar_name<T>;
  const ur5::Model model;
  const auto theta = inertial_parameters<T>(model);
  bench::row<6, T>("dynamics/yr-theta-fixed" + end,
                   [model](const auto& s) { return yr_theta(model, s.q, s.dq, s.dq_r, s.ddq); });
  bench::row<6, T>("dynamics/regressor-product" + end, [model, theta](const auto& s) {
    return regressor_product(model, s.q, s.dq, s.dq_r, s.ddq, theta);
  });
  bench::row<6, T>("dynamics/regressor-transposed-product" + end, [model](const auto& s) {
    return regressor_transposed_product(model, s.q, s.dq, s.dq_r, s.ddq, s.dq);
  });
  bench::row<6, T>("dynamics/regressor" + end,
                   [model](const auto& s) { return regressor(model, s.q, s.dq, s.dq_r, s.ddq); });
  bench::row<6, T>("dynamics/kinetic-energy" + end,
                   [model](const auto& s) { return kinetic_energy(model, s.q, s.dq); });
}

void floor_rows() {
  const auto theta = inertial_parameters<double>(ur5::Model{});
  bench::row<6>("dynamics/regressor-product/ur5/floor/double", [theta](const auto& s) {
    bench::Numbers<6> tau;
    bench_floor::ur5::floor_regressor_product(s.q.data, s.dq.data, s.dq_r.data, s.ddq.data, theta.data,
                                              tau.data);
    return tau;
  });
}

#if SKINCTL_HAS_KDL
/// The arm with only one body on it, a mass or an inertia: ten of these for each link.
oracle::Robot with_one_body(std::size_t k) {
  oracle::Robot arm = oracle::ur5();
  for (auto& b : arm.bodies) b.mass = 0, b.inertia = {};
  auto& body = arm.bodies[k / 10];
  const std::size_t p = k % 10;
  if (p < 4) {
    body.mass = 1;
    body.com = {p == 1 ? 1. : 0., p == 2 ? 1. : 0., p == 3 ? 1. : 0.};
  } else {
    constexpr std::size_t row[6] = {0, 1, 2, 0, 0, 1}, column[6] = {0, 1, 2, 1, 2, 2};
    body.inertia[3 * row[p - 4] + column[p - 4]] = body.inertia[3 * column[p - 4] + row[p - 4]] = 1;
  }
  return arm;
}

void peer_rows() {
  const auto arm = std::make_shared<oracle::KdlOracle>(oracle::ur5());
  bench::row<6>("dynamics/regressor-product/ur5/kdl/double", [arm](const auto& s) {
    bench::Numbers<6> tau;
    arm->inverse_dynamics(s.q.data, s.dq.data, s.ddq.data, tau.data);
    return tau;
  });
  const auto bodies = std::make_shared<std::vector<oracle::KdlOracle>>();
  for (std::size_t k = 0; k < 60; ++k) bodies->emplace_back(with_one_body(k));
  bench::row<6>("dynamics/regressor/ur5/kdl/double", [bodies](const auto& s) {
    bench::Numbers<360> Y;
    for (std::size_t k = 0; k < 60; ++k)
      (*bodies)[k].inverse_dynamics(s.q.data, s.dq.data, s.ddq.data, Y.data + 6 * k);
    return Y;
  });
  bench::row<6>("dynamics/regressor-transposed-product/ur5/kdl/double", [bodies](const auto& s) {
    bench::Numbers<60> powers;
    for (std::size_t k = 0; k < 60; ++k) {
      double tau[6];
      (*bodies)[k].inverse_dynamics(s.q.data, s.dq.data, s.ddq.data, tau);
      powers.data[k] = 0;
      for (std::size_t i = 0; i < 6; ++i) powers.data[k] += tau[i] * s.dq[i];
    }
    return powers;
  });
}
#else
void peer_rows() {}
#endif

const bool registered = (rows<double>(), rows<float>(), floor_rows(), peer_rows(), true);

}  // namespace
