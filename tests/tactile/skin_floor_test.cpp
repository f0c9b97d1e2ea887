// by night: floors of the benchmarks
// What the benchmarks compare with computes the same torque.
#include "bench/tactile/skin_floor.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "bench/tactile/kdl_skin.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin_torque.hpp"
#include "tests/support/random_skin.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE_TEMPLATE("Floor of skin torque: the backward pass by hand is skinctl's", T, float, double) {
  Random rng = seeded(1);
  for (int k = 0; k < 200; ++k) {
    const auto q = random_position<6, T>(rng);
    LinkWrenches<ur5::Model, 0b111111, T> wrenches;
    for (auto& row : wrenches.data)
      for (T& x : row) x = T(10) * uniform<T>(rng);
    T sin[6], cos[6];
    for (std::size_t i = 0; i < 6; ++i) sin[i] = std::sin(q[i]), cos[i] = std::cos(q[i]);
    JointTorque<6, T> by_hand;
    bench_floor::ur5_backward(sin, cos, wrenches.data, by_hand.data);
    const auto [error, size] = compare(skin_torque(ur5::Model{}, q, wrenches), by_hand);
    CHECK(error <= 50 * static_cast<double>(epsilon<T>()) * size);
  }
}

TEST_CASE_TEMPLATE("Floor of skin torque: the sum by hand is a sum", T, float, double) {
  constexpr std::size_t W = native_lanes<T>, pairs = 5;
  Random rng = seeded(2);
  bench_floor::Line<T> units(12 * W * pairs), readings(2 * W * pairs);
  T expected[6] = {};
  for (std::size_t i = 0; i < 2 * W * pairs; ++i) readings.data()[i] = T(int(rng() % 9));
  for (std::size_t i = 0; i < 12 * W * pairs; ++i) {
    units.data()[i] = T(int(rng() % 17) - 8);
    const std::size_t block = i / (6 * W), r = i / W % 6, lane = i % W;
    expected[r] += units.data()[i] * readings.data()[block * W + lane];
  }
  T w[6];
  bench_floor::weigh(units.data(), readings.data(), pairs, w);
  for (std::size_t r = 0; r < 6; ++r) CHECK(w[r] == expected[r]);
}

TEST_CASE("KDL as a peer: per cell and per link it is skinctl's torque") {
  Random rng = seeded(3);
  std::vector<bench::KdlCell> cells;
  std::vector<double> newton;
  LinkWrenches<ur5::Model, 0b111111> wrenches;
  for_each_index<6>([&](auto i) {
    const auto patch = random_patch<i.value, 7>(rng, 1);
    for (const auto& cell : patch.placed()) {
      const auto u = unit_wrench(cell.X_LC);
      const auto p = cell.X_LC.origin();
      newton.push_back(5 + 5 * uniform<double>(rng));
      cells.push_back({int(i.value),
                       {p.x, p.y, p.z},
                       {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z}});
      wrenches.set<i.value>(wrenches.wrench<i.value>() + newton.back() * u);
    }
  });
  bench::KdlSkin kdl(oracle::ur5(), cells);
  for (int k = 0; k < 20; ++k) {
    const auto q = random_position<6, double>(rng);
    const auto tau = skin_torque(ur5::Model{}, q, wrenches);
    JointTorque<6> per_cell, per_link;
    kdl.per_cell(q.data, newton.data(), per_cell.data);
    kdl.per_link(q.data, newton.data(), per_link.data);
    CHECK(compare(tau, per_cell).first <= 1e-12 * compare(tau, per_cell).second);
    CHECK(compare(tau, per_link).first <= 1e-12 * compare(tau, per_link).second);
  }
}
