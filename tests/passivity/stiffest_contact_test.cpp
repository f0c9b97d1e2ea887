#include "skinctl/passivity/stiffest_contact.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <random>
#include <string>

#include "bench/studies/worlds/spring_wall.hpp"
#include "bench/studies/worlds/wall_contact.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

RobotConfiguration<6> configuration(Nanoseconds period, Nanoseconds delay, Nanoseconds lag, double decay) {
  RobotConfiguration<6> c{
      .limits = limits_of<ur5::Description>(1000.0), .period = period, .delay = delay, .lag = lag};
  c.virtual_damping = decay;
  c.viscous_friction = {20, 20, 10, 2, 1, 0.5};
  c.dead_band = JointPosition<6>::constant(0.02);
  return c;
}
const JointPosition<6> pose{0.1, -1.5, 1.2, -1, -1.5, 0.3};

/// The loops of `rows` at `pose` under `c`, as `StiffestContact` sees them.
struct Loops {
  ContactStability<ur5::Model> stability;
  detail::ContactModes<6, double> modes;
  detail::ContactPath<double> path;

  explicit Loops(const RobotConfiguration<6>& c, const JointPosition<6>& q = pose)
      : stability(ur5::Model{}, c, {.stiffness = 1e4}),
        modes(stability.felt(q).inertia, stability.felt(q).friction),
        path(c, 0ns) {}
  double stiffest(const double (&a)[6], double b) const {
    double mode[6];
    modes.row(a, mode);
    return detail::stiffest_contacts<6, double>(modes, path, mode, 1, nullptr, 1, b);
  }
  double stiffest(const double (&a)[6], const double (&c)[6], double b) const {
    double one[6], two[6];
    modes.row(a, one);
    modes.row(c, two);
    return detail::stiffest_contacts<6, double>(modes, path, one, 1, two, 1, b);
  }
};

/// Cells all around the forearm and the last wrist.
auto cells() {
  std::vector<PlacedCell<2>> arm;
  std::vector<PlacedCell<5>> wrist;
  std::uint32_t id = 1;
  for (const double x : {-0.35, -0.2, -0.05})
    for (const double side : {-1.0, 1.0}) {
      arm.push_back(cell_at<2>(id++, {x, 0.05 * side, 0}, {0, side, 0}));
      arm.push_back(cell_at<2>(id++, {x, 0, 0.05 * side}, {0, 0, side}));
    }
  for (const double side : {-1.0, 1.0}) {
    wrist.push_back(cell_at<5>(id++, {0.04 * side, 0, -0.02}, {side, 0, 0}));
    wrist.push_back(cell_at<5>(id++, {0, 0.04 * side, -0.02}, {0, side, 0}));
  }
  return std::pair(arm, wrist);
}
auto skin() {
  const auto [arm, wrist] = cells();
  return open_skin(Patch<2, 12>(arm, open_gains), Patch<5, 4>(wrist, open_gains));
}
template <class... Parts>
auto robot(const Parts&... parts) {
  return by_position(ur5::Model{}, configuration(8ms, 8ms, 8ms, 4), parts...);
}
const auto law = SkinJointControl{} + GravityControl{};

}  // namespace

TEST_CASE("ContactModes: the compliance is that of the full matrices, by elimination") {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int k = 0; k < 20; ++k) {
    JointPosition<6> q;
    for (double& x : q) x = 3 * u(rng);
    const auto c = configuration(8ms, 20ms, 8ms, 3);
    const Loops loops(c, q);
    double row[6], mode[6];
    for (double& r : row) r = u(rng);
    loops.modes.row(row, mode);
    for (const double w : {0.1, 3.0, 50.0, 700.0}) {
      const auto want = loops.stability.response(loops.stability.felt(q), row, 0, w);
      const auto got = loops.path.at(w) * loops.modes.compliance(mode, mode, w);
      CHECK(std::abs(got - want) < 1e-9 * std::abs(want));
    }
    for (const double b : {0.0, 300.0})
      CHECK(loops.stiffest(row, b) == doctest::Approx(loops.stability.stiffest(q, row, b)).epsilon(2e-3));
  }
}

TEST_CASE("Two contacts: in one direction they bear half as much; without friction nothing rests") {
  const Loops loops(configuration(8ms, 20ms, 8ms, 3));
  const double row[6] = {0.3, 0.5, 0.4, 0.15, 0.1, 0};
  CHECK(loops.stiffest(row, row, 0) == doctest::Approx(0.5 * loops.stiffest(row, 0)).epsilon(2e-3));
  double frictionless[6] = {};
  frictionless[0] = 1;
  auto free = configuration(8ms, 20ms, 8ms, 0);
  free.viscous_friction = {};
  CHECK(Loops(free).stiffest(frictionless, 0) == 0);
  CHECK(Loops(free).stiffest(frictionless, row, 0) == 0);
}

// The simulated robot knows nothing of frequencies.
TEST_CASE("Two contacts: a resolver on two springs becomes unstable where the eigenvalues say") {
  const double rows[2][6] = {{0.3, 0.5, 0.4, 0.15, 0.1, 0}, {0.5, 0.1, 0.3, -0.1, 0.05, 0}};
  for (const auto& c : {configuration(8ms, 8ms, 8ms, 3), configuration(2ms, 20ms, 0ns, 3)}) {
    CAPTURE(c.period);
    const Loops loops(c);
    const double k = loops.stiffest(rows[0], rows[1], 0);
    CHECK(k < 0.9 * std::min(loops.stiffest(rows[0], 0), loops.stiffest(rows[1], 0)));
    CHECK(swings_out(c, pose, rows, 0.85 * k));
    CHECK_FALSE(swings_out(c, pose, rows, 1.2 * k));
    const double damping = 150, k_damped = loops.stiffest(rows[0], rows[1], damping);
    CHECK(k_damped > 1.5 * k);
    CHECK(swings_out(c, pose, rows, 0.8 * k_damped, damping));
    CHECK_FALSE(swings_out(c, pose, rows, 1.3 * k_damped, damping));
  }
}

TEST_CASE(
    "StiffestContact: refuses a scene that would ring, with the number, and makes the damper it needs") {
  const StiffestContact soft{.stiffness = 100, .newtons = newtons_per_unit},
      hard{.stiffness = 3e4, .newtons = newtons_per_unit};
  CHECK(soft.damping(robot(), skin()) == 0);
  static_cast<void>(Cycle(robot(soft), skin(), law));
  const double needed = hard.damping(robot(), skin());
  CHECK(needed > 0.5 * contact_damping(3e4, 0.02));
  CHECK(needed < 2 * contact_damping(3e4, 0.02));
  const auto refusal = [&](const auto& arm) -> std::string {
    try {
      static_cast<void>(Cycle(arm, skin(), law));
    } catch (const ConfigurationError& e) {
      return e.what();
    }
    return "";
  };
  char number[32];
  std::snprintf(number, sizeof number, ">= %.4g N s/m", needed);
  CHECK(refusal(robot(hard)).find(number) != std::string::npos);
  CHECK(refusal(robot(hard, ContactDamper<>({.always = 0.9 * needed}))).find("contact damping, always = ") !=
        std::string::npos);
  CHECK(refusal(robot(hard, ContactDamper<>({.max = 1.01 * needed}))).find(number) != std::string::npos);
  CHECK(refusal(robot(hard, hard.damper(robot(), skin()))).empty());
  auto patient = hard;
  patient.may_ring = true;
  CHECK(refusal(robot(patient, ContactDamper<>({.max = 1.01 * needed}))).empty());
  // A stronger law needs more, one cell of it is enough; numbers out of their range are refused.
  auto strong = hard;
  strong.newtons = 0.5 * newtons_per_unit;
  CHECK(strong.damping(robot(), skin()) == doctest::Approx(2 * needed).epsilon(0.15));
  CHECK(refusal(robot(StiffestContact{})).find("stiffness = 0") != std::string::npos);
  CHECK(refusal(robot(StiffestContact{.stiffness = std::nan("")})).find("stiffness = ") != std::string::npos);
  CHECK(refusal(robot(StiffestContact{.stiffness = HUGE_VAL})).find("stiffness = ") != std::string::npos);
  CHECK(refusal(robot(StiffestContact{.stiffness = 1, .margin_of_two = 0.5})).find("margin of two") !=
        std::string::npos);
  CHECK(refusal(robot(StiffestContact{.stiffness = 1, .poses = 0})).find("poses") != std::string::npos);
  // Without cells to look at: points all over each link.
  CHECK(hard.damping(robot(), NoSkin{}) > 0.5 * needed);
}

TEST_CASE("StiffestContact: at poses and cells that it has not seen the margin is 1.8, 1.4 for two") {
  const StiffestContact hard{.stiffness = 1e4, .newtons = newtons_per_unit};
  const auto sensed = skin();
  const double b = hard.damping(robot(), sensed);
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> u(-M_PI, M_PI);
  double least = 1e9, least_of_two = 1e9;
  for (int k = 0; k < 40; ++k) {
    JointPosition<6> q;
    for (double& x : q) x = u(rng);
    const Loops loops(configuration(8ms, 8ms, 8ms, 4), q);
    std::vector<std::array<double, 6>> rows;
    sensed.each_cell([&](std::size_t link, const Xyz<double>& f, const Xyz<double>& m, double) {
      LinkWrenches<ur5::Model, all_links(6)> w;
      w.data[link][0] = f.x, w.data[link][1] = f.y, w.data[link][2] = f.z;
      w.data[link][3] = m.x, w.data[link][4] = m.y, w.data[link][5] = m.z;
      const auto tau = skin_torque(ur5::Model{}, q, w);
      std::array<double, 6> row;
      for (std::size_t i = 0; i < 6; ++i) row[i] = -tau[i];
      rows.push_back(row);
    });
    const auto at = [&](std::size_t i, double(&row)[6]) { std::copy_n(rows[i].begin(), 6, row); };
    for (std::size_t i = 0; i < rows.size(); ++i) {
      double one[6], two[6];
      at(i, one);
      least = std::min(least, loops.stability.stiffest(q, one, b) / 1e4);
      at((i + 5) % rows.size(), two);
      least_of_two = std::min(least_of_two, loops.stiffest(one, two, b) / 1e4);
    }
  }
  CHECK(least > 1.8);
  CHECK(least_of_two > 1.4);
}

// A part of bench/studies/springs.cpp.
TEST_CASE("StiffestContact: an arm that is led into a spring rests there with the same force at any rate") {
  constexpr double push = 20;
  const auto sensed = forearm_skin();
  for (const double stiffness : {3e2, 3e4})
    for (const Nanoseconds period : {8ms, 1ms}) {
      CAPTURE(stiffness);
      CAPTURE(period);
      const auto c = yielding_arm(period);
      const StiffestContact stiffest{.stiffness = stiffness, .newtons = newtons_per_unit};
      const auto damper = stiffest.damper(by_position(ur5::Model{}, c), sensed);
      const auto kept = led_into_a_spring(Cycle(by_position(ur5::Model{}, c, damper, stiffest), sensed, law),
                                          c, stiffness, push, 3);
      CHECK(kept.calm(push));
      CHECK(kept.rest == doctest::Approx(push).epsilon(0.05));
      CHECK(kept.peak < 1.3 * push);
      if (stiffness > 1e4)
        CHECK_FALSE(led_into_a_spring(Cycle(by_position(ur5::Model{}, c), sensed, law), c, stiffness, push, 3)
                        .calm(push));
    }
}
