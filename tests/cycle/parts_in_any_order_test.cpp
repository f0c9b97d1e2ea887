// by night: hundreds of scenes; scene_parts_test.cpp and group_parts_test.cpp have some of them
// Cycle::with: parts of a scene in one call or in several, in any order, are the same scene.
//
// Promise: parts given to `with` in several calls and any order are those of one call
// Tried: all pairs by position, velocity, torque and in groups: same type and numbers; all parts at once:
// same commands bit for bit; a part twice does not compile

#include <doctest/doctest.h>

#include <cstring>
#include <memory>
#include <vector>

#include "skinctl/skinctl.hpp"
#include "tests/support/grouped_scene.hpp"
#include "tests/support/ur5_clearance.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
constexpr BodyRegion region{.force = 80, .blow = 120, .first = 100ms, .stiffness = 2e4, .mass = 4};

/// All kinds of parts of a robot of `N` joints; `Jerk`: whether it commands motion.
template <bool Jerk, std::size_t N, class Around, std::size_t... Links>
auto parts_of(const Around& around, std::index_sequence<Links...>) {
  constexpr std::size_t last = N - 1;
  auto places = cell_places(ur5::skin_patches<260>());
  std::erase_if(places, [](const CellPlace& p) { return p.link >= N; });
  const auto common = std::tuple(
      GuardSettings<N>{.torque_rate = 7, .consent = Reason::state_stale},
      MaxToolSpeed<last>{.speed = 0.2, .reach = 1.3}, SkinWatch{.settle = 70ms},
      FeltPlaces<260>{.places = places, .force = 40, .newtons = 20},
      LinkContact<Links>{.region = region, .reach = 0.1 * double(Links), .reaction_time = 20ms}..., around);
  if constexpr (Jerk) {
    return std::tuple_cat(common, std::tuple(MaxJerk{JointJerk<N>::constant(600)}));
  } else {
    return common;
  }
}

/// The numbers by which a scene shows its parts.
template <class Scene>
std::vector<double> numbers(const Scene& scene) {
  const auto& settings = scene.guard().settings();
  std::vector<double> out{settings.torque_rate, double(settings.consent.bits())};
  const auto& g = scene.governor();
  using G = std::remove_cvref_t<decltype(g)>;
  if constexpr (G::smooth) out.push_back(g.mover().jerk()[0]);
  if constexpr (G::smooth) out.push_back(double(std::remove_cvref_t<decltype(scene.guard())>::smooth));
  if constexpr (G::template has<ToolSpeedLimit>) out.push_back(g.template get<ToolSpeedLimit>().limit());
  if constexpr (G::template has<SkinWatch>)
    out.push_back(g.template get<SkinWatch>().settings().settle == 70ms ? 70.0 : 0.0);
  if constexpr (G::template has<FeltPlacesLimit>)
    out.push_back(g.template get<FeltPlacesLimit>().settings().force);
  if constexpr (G::template has<Clearance>) out.push_back(double(g.template get<Clearance>().around));
  if constexpr (G::template has<LinkContacts>) out.push_back(double(G::links));
  return out;
}

template <class A, class B>
void same(const A& a, const B& b) {
  CHECK(std::is_same_v<A, B>);
  CHECK(numbers(a) == numbers(b));
}

/// For each pair of parts.
template <class Scene, class... Parts>
int compare_pairs(const Scene& plain, const std::tuple<Parts...>& parts) {
  int pairs = 0;
  const auto compare = [&](const auto& a, const auto& b) {
    const auto both = plain.with(a, b);
    CHECK(numbers(both).size() >= 3);
    same(plain.with(a).with(b), both);
    same(plain.with(b).with(a), both);
    same(plain.with(b, a), both);
    same(plain.with(a).with(), plain.with(a));
    ++pairs;
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (
        [&](auto i) {
          (
              [&](auto j) {
                if constexpr (j.value < i.value) compare(std::get<j.value>(parts), std::get<i.value>(parts));
              }(std::integral_constant<std::size_t, I>{}),
              ...);
        }(std::integral_constant<std::size_t, I>{}),
        ...);
  }(std::index_sequence_for<Parts...>{});
  return pairs;
}

template <class Scene, class... Parts>
auto one_by_one(const Scene& scene, const Parts&... parts) {
  if constexpr (sizeof...(Parts) == 0) {
    return scene;
  } else {
    return [&](const auto& first, const auto&... rest) {
      return one_by_one(scene.with(first), rest...);
    }(parts...);
  }
}
template <class Scene, class Tuple, std::size_t... I>
auto backwards(const Scene& scene, const Tuple& parts, std::index_sequence<I...>) {
  return one_by_one(scene, std::get<sizeof...(I) - 1 - I>(parts)...);
}

/// The commands of a robot that a skin pushes, bit by bit.
template <class Scene>
std::vector<unsigned char> commands(const Scene& scene, const State<6>& from) {
  const auto memory = std::make_unique<typename Scene::Memory>();
  scene.start(*memory, from);
  std::vector<unsigned char> out;
  State<6> now = from;
  for (int k = 1; k <= 200; ++k) {
    typename Scene::Input input;
    input.now = now.time = k * 8ms;
    input.measured = now;
    input.around.time = input.now;
    std::vector<CellSample> samples;
    for (std::uint32_t cell = 1; cell <= 260; ++cell) {
      const float force = cell == 100 && k > 50 && k < 120 ? 0.4f : 0.f;
      samples.push_back({.time = input.now, .cell = cell, .force = {force, force, force}});
    }
    input.samples = samples;
    const auto result = scene.step(*memory, input);
    for (std::size_t i = 0; i < 6; ++i)
      for (const double x :
           {result.planned.position[i], result.planned.velocity[i], result.planned.torque[i]}) {
        unsigned char bytes[sizeof x];
        std::memcpy(bytes, &x, sizeof x);
        out.insert(out.end(), bytes, bytes + sizeof x);
      }
    if (result.planned.valid) now.q = result.planned.position, now.dq = result.planned.velocity;
  }
  return out;
}

template <class Robot>
auto scene_of(const Robot& arm) {
  return Cycle(arm, ur5_skin<260>({.force = 20}), SplineJoint<6>(arm) + SkinJointControl{});
}
template <bool Jerk>
auto ur5_parts() {
  return parts_of<Jerk, 6>(ur5_clearance<4>(), std::index_sequence<2, 4>{});
}
const RobotConfiguration<6> stated{
    .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4};
const State<6> home{0ns, {0.0, -1.2, 1.4, -1.8, -1.57, 0.3}, {}};

template <class Plain, class Parts>
void check_all(const Plain& plain, const Parts& parts) {
  constexpr auto each = std::make_index_sequence<std::tuple_size_v<Parts>>{};
  const auto whole = std::apply([&](const auto&... p) { return plain.with(p...); }, parts);
  const auto forwards = std::apply([&](const auto&... p) { return one_by_one(plain, p...); }, parts);
  const auto reverse = backwards(plain, parts, each);
  same(forwards, whole);
  same(reverse, whole);
  const auto given = commands(whole, home);
  CHECK(commands(forwards, home) == given);
  CHECK(commands(reverse, home) == given);
}
}  // namespace

TEST_CASE("Cycle::with: parts in several calls are those of one call, by position, with equal commands") {
  const auto plain = scene_of(by_position(ur5::Model{}, stated));
  CHECK(compare_pairs(plain, ur5_parts<true>()) == 28);
  check_all(plain, ur5_parts<true>());
}

TEST_CASE("Cycle::with: parts in several calls are those of one call, by velocity") {
  const auto plain = scene_of(by_velocity(ur5::Model{}, stated));
  CHECK(compare_pairs(plain, ur5_parts<true>()) == 28);
}

TEST_CASE("Cycle::with: parts in several calls are those of one call, by torque, with equal commands") {
  const auto plain = scene_of(by_torque(
      ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 8ms}, FrictionUncompensated{}));
  CHECK(compare_pairs(plain, ur5_parts<false>()) == 21);
  check_all(plain, ur5_parts<false>());
}

TEST_CASE("Cycle::with: parts in several calls are those of one call, in groups of joints") {
  const std::vector<PlacedCell<2>> cells{{1, {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}, {0.05, 0, 0}}}};
  const Skin<Model3, double, Patch<2, 1>> skin{Patch<2, 1>(cells, {.force = 100})};
  Clearance post;
  post.margin = 0.01, post.reach = 0.9;
  post.capsules = {{2, {{0, 0, 0}, {0.1, 0, 0}, 0.01}},
                   {LinkCapsule::fixed, {{0.2, 0.3, -1}, {0.2, 0.3, 2}, 0.05}}};
  post.pairs = {{0, 1}};
  const Cycle plain(robot(), skin, Pull{{5, 3, 0.1}, {}, {}});
  CHECK(compare_pairs(plain, parts_of<true, 3>(post, std::index_sequence<2>{})) == 21);
}
