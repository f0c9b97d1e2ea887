// by night: floors of the benchmarks
// What the benchmarks compare with computes the same torque.
#include "bench/tactile/skin_floor.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "bench/studies/floor/event_floor.hpp"
#include "bench/tactile/kdl_skin.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_skin.hpp"
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

TEST_CASE("Floor of an event: the sums by hand are the skin's to the bit, and its means to rounding") {
  const auto patches = ur5::skin_patches<260>();
  const auto skin = ur5_skin<260>({10, 3});
  detail::CellTable table(260);
  std::size_t number = 0;
  std::apply([&](const auto&... p) { (table.add(p.any().data(), p.any().size(), number++, p.link), ...); },
             patches);
  const double gain[2] = {10 * CellCounts::force_unit, 3 * CellCounts::proximity_unit};
  const std::int32_t threshold[2] = {1311, 3277};
  bench_floor::EventFloor floor(table, 261, 6, Nanoseconds(200ms).count(), Nanoseconds(6ms).count(),
                                Nanoseconds(22ms).count(), threshold, gain);
  auto memory = skin.start(0ns);
  Random rng = seeded(4);
  Nanoseconds now = 100ms;
  const auto batch = [&](Nanoseconds earlier) {
    std::vector<CellSample> samples(260);
    for (std::uint32_t i = 0; i < 260; ++i) {
      samples[i].cell = i + 1;
      samples[i].time = now - earlier - Nanoseconds(rng() % 900000u);
      for (float& f : samples[i].force) f = float(rng() % 1025) / 1024;
      samples[i].proximity = float(rng() % 65537) / 65536;
    }
    return samples;
  };
  decltype(skin)::Wrenches mean;
  const auto first = batch(1ms);  // until then the skin has not heard its cells
  skin.receive(memory, first, now - 2ms, now, 1, &mean);
  floor.take(first, (now - 2ms).count(), now.count());
  for (int k = 0; k < 50; ++k) {
    const auto before = skin.wrenches(memory);
    now += 2ms;
    const auto samples = batch(1ms);
    skin.receive(memory, samples, now - 2ms, now, 1, &mean);
    CHECK(floor.take(samples, (now - 2ms).count(), now.count()) == 0);
    for (std::size_t l = 0; l < 6; ++l)
      for (std::size_t r = 0; r < 6; ++r) {
        const auto& s = floor.sums[l];
        constexpr std::size_t w = bench_floor::EventFloor::width;
        CHECK(s.force[r / w][r % w] == memory.sums[l].force[r]);
        CHECK(s.proximity[r / w][r % w] == memory.sums[l].proximity[r]);
        CHECK(std::abs(before.data[l][r] + s.mean[r / w][r % w] - mean.data[l][r]) <=
              1e-12 * (1 + std::abs(mean.data[l][r])));
      }
  }
}
