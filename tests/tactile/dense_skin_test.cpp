#include "skinctl/tactile/dense_skin.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <memory>

#include "skinctl/model/ur5.hpp"
#include "skinctl/tactile/skin_torque.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random_skin.hpp"
#include "skinctl/testing/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// Sizes on both sides of every group size, two patches on one link, a link without skin.
auto some_patches(Random& rng) {
  return random_patches(rng, {}, std::index_sequence<0, 1, 2, 2, 4, 5>{},
                        std::index_sequence<1, 8, 33, 17, 16, 7>{});
}
template <class Policy, class Tuple>
struct DenseOf;
template <class Policy, class... P>
struct DenseOf<Policy, std::tuple<P...>> {
  using type = DenseSkin<ur5::Model, Policy, P...>;
};
template <class Policy>
using Dense = typename DenseOf<Policy, decltype(some_patches(std::declval<Random&>()))>::type;

template <class D, class Tuple>
D make(const Tuple& patches) {
  return std::apply([](const auto&... p) { return D(p...); }, patches);
}
/// `f(patch, integral_constant<K>)` for every patch.
template <class Tuple, class F>
void for_each_patch(const Tuple& patches, F&& f) {
  for_each_index<std::tuple_size_v<Tuple>>([&](auto k) { f(std::get<k.value>(patches), k); });
}

}  // namespace

TEST_CASE_TEMPLATE("DenseSkin: the torque is the sum over the cells' own Jacobians", Policy, DoubleSum,
                   FloatStoredSum, FloatSum) {
  using D = Dense<Policy>;
  using T = typename D::scalar;
  constexpr double unit = static_cast<double>(std::numeric_limits<typename D::Stored>::epsilon());
  Random rng = seeded(1);
  const auto patches = some_patches(rng);
  const D skin = make<D>(patches);
  const ur5::Model model;
  double worst = 0;
  for (int k = 0; k < 200; ++k) {
    const auto q = random_position<6, T>(rng);
    const auto poses = link_poses(model, q.template cast<Digits50>());
    const auto frame = std::make_unique<typename D::Frame>();
    JointTorque<6, Digits50> expected;
    Digits50 magnitude(0);
    for_each_patch(patches, [&](const auto& patch, auto number) {
      constexpr std::size_t I = std::remove_cvref_t<decltype(patch)>::link;
      for (std::size_t i = 0; i < patch.cells; ++i) {
        if (k % 2 == 1 && rng() % 4 != 0) continue;
        auto& newton = frame->template at<number.value>(i);
        newton = static_cast<typename D::Stored>(20 * std::abs(uniform<double>(rng)));
        const auto X_LC = patch.placed()[i].X_LC.template cast<Digits50>();
        const auto tau = torque_of_cell<I>(poses, model, X_LC, Digits50(newton));
        expected += tau;
        for (const Digits50& t : tau) magnitude += abs(t);
      }
    });
    const auto tau = skin_torque(model, q, skin.wrenches(*frame));
    for (std::size_t j = 0; j < 6; ++j)
      worst = std::max(worst, static_cast<double>(abs(Digits50(tau[j]) - expected[j]) / magnitude));
  }
  CHECK(worst <= 4 * unit);
  CHECK(worst <= (std::same_as<Policy, DoubleSum> ? 1e-12 : 1.0));
}

TEST_CASE_TEMPLATE("DenseSkin: cells do not mix, and what no cell says is zero", Policy, DoubleSum,
                   FloatStoredSum, FloatSum) {
  using D = Dense<Policy>;
  Random rng = seeded(2);
  const auto patches = some_patches(rng);
  const D skin = make<D>(patches);
  auto frame = std::make_unique<typename D::Frame>();
  CHECK(skin.wrenches(*frame) == typename D::Wrenches{});
  for_each_patch(patches, [&](const auto& patch, auto number) {
    constexpr std::size_t I = std::remove_cvref_t<decltype(patch)>::link;
    for (std::size_t i = 0; i < patch.cells; ++i) {
      frame->template at<number.value>(i) = 3;
      const auto wrenches = skin.wrenches(*frame);
      const auto F = wrenches.template wrench<I>();
      const auto u = 3.0 * unit_wrench(patch.placed()[i].X_LC);
      const double unit = static_cast<double>(std::numeric_limits<typename D::Stored>::epsilon());
      CHECK(norm(cast<double>(F.force) - u.force) <= 6 * unit);
      CHECK(norm(cast<double>(F.moment) - u.moment) <= 6 * unit);
      for_each_index<6>([&](auto j) {
        if constexpr (j.value != I && j.value != 3) {
          const auto none = wrenches.template wrench<j.value>();
          CHECK(dot(none.force, none.force) + dot(none.moment, none.moment) == 0);
        }
      });
      frame->template at<number.value>(i) = 0;
    }
  });
}

TEST_CASE("DenseSkin: a frame becomes torques without an allocation") {
  using D = Dense<DoubleSum>;
  Random rng = seeded(3);
  const D skin = make<D>(some_patches(rng));
  const auto frame = std::make_unique<D::Frame>();
  const auto q = random_position<6, double>(rng);
  frame->at<2>(5) = 7;
  const AllocationGuard guard;
  const auto tau = skin_torque(ur5::Model{}, q, skin.wrenches(*frame));
  const auto count = guard.count();
  CHECK(count == 0);
  CHECK(tau[0] != 0);
}
