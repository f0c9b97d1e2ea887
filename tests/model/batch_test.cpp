#include <doctest/doctest.h>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::size_t count = 11;            // no multiple of any number of lanes
constexpr bool whole = SKINCTL_MANY_DIGITS;  // the sanitizers take minutes to compile M and its factors

/// Everything in lanes against one robot at a time; the worst difference in units of the last place of the
/// largest number. `one(k)` is robot k.
template <class T, class B, class F>
double worst(const B& batch, F one) {
  constexpr std::size_t N = std::remove_cvref_t<decltype(one(0))>::joints;
  oracle::Random random(1);
  std::vector<JointPosition<N, T>> q(count);
  std::vector<JointVelocity<N, T>> dq(count);
  std::vector<JointAcceleration<N, T>> ddq(count), ddq_out(count);
  std::vector<JointTorque<N, T>> tau(count), G(count);
  std::vector<MassMatrix<N, T>> mass(count);
  std::vector<Transform<Base, Link<N - 1>, T>> tip(count);
  for (std::size_t k = 0; k < count; ++k) {
    const testing::Motion<N, T> at(random);
    q[k] = at.q, dq[k] = at.dq, ddq[k] = at.ddq;
  }
  q[4][1] = std::numeric_limits<T>::quiet_NaN();
  const AllocationGuard guard;
  batch.for_each_group([&](const auto& model, const auto& group) {
    const auto Q = group.read(q);
    const auto V = group.read(dq);
    const auto torque = inverse_dynamics(model, Q, V, group.read(ddq));
    group.write(torque, tau);
    group.write(gravity_torque(model, Q), G);
    if constexpr (whole) {
      group.write(mass_matrix(model, Q), mass);
      group.write(forward_dynamics(model, Q, V, torque).acceleration, ddq_out);
    }
    group.write(link_poses<link_bit<N - 1>>(model, Q).template get<N - 1>(), tip);
  });
  CHECK(guard.count() == 0);
  double most = 0;
  const auto note = [&](const auto& mine, const auto& other) {
    double error = 0, scale = 0;
    for (std::size_t i = 0; i < std::size(mine.data); ++i) {
      const double e = std::abs(static_cast<double>(mine.data[i]) - static_cast<double>(other.data[i]));
      if (!(e <= error)) error = e;
      scale = std::max(scale, std::abs(static_cast<double>(other.data[i])));
    }
    const double ulps = error / scale / static_cast<double>(std::numeric_limits<T>::epsilon());
    most = ulps <= most ? most : ulps;
  };
  for (std::size_t k = 0; k < count; ++k) {
    if (k == 4) {
      CHECK(tau[k][1] != tau[k][1]);
      continue;
    }
    const auto& model = one(k);
    note(tau[k], inverse_dynamics(model, q[k], dq[k], ddq[k]));
    note(G[k], gravity_torque(model, q[k]));
    if constexpr (whole) {
      note(mass[k], mass_matrix(model, q[k]));
      const auto error = relative_error(ddq_out[k], ddq[k], N);
      CHECK(error <= 1e5 * static_cast<double>(std::numeric_limits<T>::epsilon()));
    }
    const auto X = link_poses<link_bit<N - 1>>(model, q[k]).template get<N - 1>();
    const auto d = X.origin() - tip[k].origin();
    CHECK(std::abs(dot(d, d)) <=
          T(64) * std::numeric_limits<T>::epsilon() * std::numeric_limits<T>::epsilon());
    const auto z = X.axis_z() - tip[k].axis_z();
    CHECK(dot(z, z) <= T(64) * std::numeric_limits<T>::epsilon() * std::numeric_limits<T>::epsilon());
  }
  return most;
}

}  // namespace

static_assert(RobotModel<SideBySide<ur5::Calibrated<>, double, native_lanes<double>>>);

TEST_CASE("batch: robots that are alike, in lanes as one at a time, float and double") {
  const ur5::Model arm;
  CHECK(worst<double>(ModelBatch<ur5::Model>(arm, count), [&](std::size_t) { return arm; }) <= 16);
#if SKINCTL_MANY_DIGITS
  CHECK(worst<float>(ModelBatch<ur5::Model, float>(arm, count), [&](std::size_t) { return arm; }) <= 16);
#endif
}

#if SKINCTL_MANY_DIGITS
TEST_CASE("batch: every robot with its own calibration and its own mounting") {
  std::vector<ur5::Calibrated<>> arms;
  oracle::Random random(7);
  for (std::size_t k = 0; k < count; ++k) {
    ur5::Calibrated<>::Links links;
    for (std::size_t i = 0; i < 6; ++i) {
      links[i] = ur5::Description::links[i];
      links[i][LinkParameter::p_x] += random.uniform(-0.01, 0.01);
      links[i][LinkParameter::mass] += random.uniform(0, 1);
    }
    arms.emplace_back(links, Xyz<double>{random.uniform(-5, 5), 1, -9});
  }
  const ModelBatch batch(std::span<const ur5::Calibrated<>>{arms});
  CHECK(batch.size() == count);
  CHECK(worst<double>(batch, [&](std::size_t k) { return arms[k]; }) <= 16);
}
#endif

TEST_CASE("batch: what the type of a model knows stays a type") {
  const auto carrying = attach<5>(ur5::Model{}, allegro::right_fingers<1>(0));
  using Both = std::remove_cvref_t<decltype(carrying)>;
  if constexpr (native_lanes<double> > 1) {
    using InLanes = ModelBatch<Both>::GroupModel;
    static_assert(
        is_zero<decltype(std::declval<InLanes>()
                             .number<1, LinkParameter::cos_alpha, Lane<double, native_lanes<double>>>())>);
    static_assert(
        std::is_same_v<decltype(std::declval<InLanes>().gravity<InLanes::scalar>().x), TypedConstant<0>>);
  }
  const ModelBatch batch(carrying, 3);
  std::vector<JointTorque<10>> G(3);
  std::vector<JointPosition<10>> q(3);
  q[1] = JointPosition<10>::constant(0.3);
  batch.for_each_group(
      [&](const auto& model, const auto& group) { group.write(gravity_torque(model, group.read(q)), G); });
  for (std::size_t k = 0; k < 3; ++k)
    CHECK(relative_error(G[k], gravity_torque(carrying, q[k]), 10) <= 1e-14);
}

TEST_CASE("batch: none at all") {
  int calls = 0;
  ModelBatch<ur5::Model>(ur5::Model{}, 0).for_each_group([&](const auto&, const auto&) { ++calls; });
  ModelBatch<ur5::Model>(std::span<const ur5::Model>{}).for_each_group([&](const auto&, const auto&) {
    ++calls;
  });
  CHECK(calls == 0);
}
