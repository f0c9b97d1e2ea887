// Places that feel badly meet nobody fast.
#include "skinctl/limits/felt_places.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "skinctl/limits/governor.hpp"
#include "skinctl/tactile/trusted_skin.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/simulated_joints.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::size_t cells = 260;
constexpr double infinite = std::numeric_limits<double>::infinity();
using Limit = PlaceSpeed<ur5::Model, cells>;
using Settings = FeltPlaces<cells>;

const std::vector<CellPlace>& places() {
  static const auto all = cell_places(ur5::skin_patches<cells>());
  return all;
}
Settings settings() {
  return {.places = places(), .stiffness = 3e3, .newtons = 20};
}
std::string refusal(const Settings& s) {
  return complaint_of([&] { static_cast<void>(Limit(ur5::Model{}, s)); });
}

/// A touch of which each cell notices what it is told.
struct Felt {
  std::vector<double> reading = std::vector<double>(cells, 0.1);
  bool pushed = false;
  [[nodiscard]] double noticed(std::size_t i) const noexcept { return reading[i]; }
  [[nodiscard]] bool touched() const noexcept { return pushed; }
};

/// Where places are, link by link, by the poses alone.
std::vector<Xyz<double>> positions(const JointPosition<6>& q, std::vector<Xyz<double>>* normals = nullptr) {
  const auto poses = link_poses(ur5::Model{}, q);
  std::vector<Xyz<double>> out;
  const auto on = [&](const auto& X, const CellPlace& c) {
    const auto a = X.axes();
    out.push_back(X.origin() + c.place.x * a.x + c.place.y * a.y + c.place.z * a.z);
    if (normals != nullptr) normals->push_back(c.normal.x * a.x + c.normal.y * a.y + c.normal.z * a.z);
  };
  for (const CellPlace& c : places())
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((c.link == I ? on(poses.template get<I>(), c) : void()), ...);
    }(std::make_index_sequence<6>{});
  return out;
}
/// The speed of each place along its normal, by differences.
std::vector<double> speeds(const JointPosition<6>& q, const JointVelocity<6>& u) {
  constexpr double h = 1e-6;
  std::vector<Xyz<double>> normals;
  const auto at = positions(q, &normals);
  const auto a = positions(integrate(q, u, -h)), b = positions(integrate(q, u, h));
  std::vector<double> out;
  for (std::size_t i = 0; i < at.size(); ++i) out.push_back(dot(normals[i], b[i] - a[i]) / (2 * h));
  return out;
}
Going<6, double, true, false> going(const JointPosition<6>& q, const State<6>& measured) {
  return {q, {}, {}, measured, 0.008, 0.008, 0, true};
}

}  // namespace

TEST_CASE("FeltPlaces: at its speed a place presses a body up to the force, and no more") {
  for (const double stiffness : {300.0, 3e3, 25e3, 1e6})
    for (const Nanoseconds reaction_time : {0ms, 10ms, 40ms, 100ms})
      for (const double noticed : {0.0, 2.0, 28.0, 64.0}) {
        Settings s = settings();
        s.stiffness = stiffness, s.reaction_time = reaction_time;
        const Limit limit(ur5::Model{}, s);
        // Its flight, step by step: pressed up to `noticed`, on for the reaction, then braked.
        const double v = limit.speed(noticed), dt = 1e-6;
        double way = noticed / stiffness + v * seconds<double>(reaction_time), u = v;
        for (; u > 0; u -= s.deceleration * dt) way += u * dt;
        CAPTURE(stiffness);
        CAPTURE(noticed);
        CHECK(stiffness * way == doctest::Approx(s.force).epsilon(2e-3 + 1e-5 * stiffness * v / s.force));
      }
  const Limit limit(ur5::Model{}, settings());
  CHECK(limit.speed(65) == 0);
  CHECK(limit.speed(infinite) == 0);
  CHECK(limit.speed(std::nan("")) == 0);
  Settings undeclared = settings();
  undeclared.stiffness = 0, undeclared.speed = 0.3;
  CHECK(Limit(ur5::Model{}, undeclared).speed(0) == doctest::Approx(0.3));
  CHECK(Limit(ur5::Model{}, undeclared).speed(32.5) == doctest::Approx(0.15));
  CHECK(Limit(ur5::Model{}, undeclared).speed(66) == 0);
}

TEST_CASE("FeltPlaces: no place is faster than it may be, by differences of poses, and one is as fast") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-3, 3), rate(-1, 1);
  const Limit limit(ur5::Model{}, settings());
  int slowed = 0, stood = 0;
  for (int run = 0; run < 300; ++run) {
    Felt felt;
    for (double& reading : felt.reading)
      if (random() % 40 == 0) reading = random() % 2 == 0 ? 1.4 : infinite;
    Limit::Memory m;
    for (std::size_t k = 0; k < Limit::turns; ++k) CHECK(limit.look(m, felt, 0.008) == Status());
    JointPosition<6> q;
    JointVelocity<6> u;
    for (std::size_t i = 0; i < 6; ++i) q[i] = angle(random), u[i] = rate(random);
    const State<6> measured;
    const auto given = limit.share(m, going(q, measured), felt, u);
    const auto along = speeds(q, u);
    double worst = 0;
    for (std::size_t i = 0; i < along.size(); ++i) {
      const double most = std::max(limit.speed(20 * felt.reading[i]), Limit::still);
      CHECK(given.scale * along[i] <= most + 1e-6);
      worst = std::max(worst, given.scale * along[i] / most);
    }
    if (given.scale < 1) CHECK(worst > 1 - 1e-4);
    CHECK(given.status.has(Reason::skin_slowed) == (given.scale < 1));
    slowed += given.scale < 1, stood += given.scale < 1e-2;
  }
  CHECK(slowed > 100);
  CHECK(stood > 20);
}

TEST_CASE("FeltPlaces: a place that was not judged yet feels nothing; one that is dead frees the way back") {
  const Limit limit(ur5::Model{}, settings());
  const JointPosition<6> q(home);
  auto u = JointVelocity<6>();
  u[0] = 0.3;
  const State<6> measured;
  Limit::Memory m;
  Felt felt;
  CHECK(limit.share(m, going(q, measured), felt, u).scale < 2e-3);
  for (std::size_t k = 0; k < Limit::turns; ++k) limit.look(m, felt, 0.008);
  CHECK(limit.share(m, going(q, measured), felt, u).scale == 1);
  const auto along = speeds(q, u);
  const auto first = std::size_t(std::max_element(along.begin(), along.end()) - along.begin());
  felt.reading[first] = infinite;
  for (std::size_t k = 0; k < Limit::turns; ++k) limit.look(m, felt, 0.008);
  CHECK(limit.share(m, going(q, measured), felt, u).scale < 2e-3);
  // Who is pushed gives way, wherever it leads, as fast as with a healthy skin.
  felt.pushed = true;
  limit.look(m, felt, 0.008);
  CHECK(limit.share(m, going(q, measured), felt, u).scale == 1);
  felt.pushed = false;
  limit.look(m, felt, 0.008);
  CHECK(limit.share(m, going(q, measured), felt, u).scale < 2e-3);
  u[0] = -0.3;
  CHECK(limit.share(m, going(q, measured), felt, u).scale == 1);
}

TEST_CASE("FeltPlaces: the motors notice by their lever, a wrist sensor what is behind it") {
  Settings s = settings();
  s.motors = {12, 12, 8, 4, 4, 4};
  const Limit with(ur5::Model{}, s), without(ur5::Model{}, settings());
  const JointPosition<6> q(home);
  const State<6> measured;
  Felt felt;
  felt.reading.assign(cells, infinite);
  Limit::Memory m;
  for (std::size_t k = 0; k < Limit::turns; ++k) with.look(m, felt, 0.008);
  std::array<std::vector<double>, 6> lever;  // by virtual work: the torque of a newton
  for (std::size_t k = 0; k < 6; ++k) {
    JointVelocity<6> one;
    one[k] = 1;
    lever[k] = speeds(q, one);
  }
  for (std::size_t j = 0; j < 6; ++j) {
    JointVelocity<6> u;
    u[j] = 0.5;
    double expected = 1;
    for (std::size_t i = 0; i < cells; ++i) {
      double noticed = infinite;
      for (std::size_t k = 0; k < 6; ++k)
        if (std::abs(lever[k][i]) > 1e-9) noticed = std::min(noticed, s.motors[k] / std::abs(lever[k][i]));
      const double along = 0.5 * lever[j][i];
      if (along > Limit::still)
        expected = std::min(expected, std::max(with.speed(noticed), Limit::still) / along);
    }
    CAPTURE(j);
    const double share = with.share(m, going(q, measured), felt, u).scale;
    CHECK(share == doctest::Approx(expected).epsilon(1e-4));
    CHECK(without.share(m, going(q, measured), felt, u).scale <= share);
  }
  Settings wrist = settings();
  wrist.wrist = 3;
  const Limit behind(ur5::Model{}, wrist);
  for (std::size_t i = 0; i < cells; ++i)
    CHECK(behind.noticed(felt, i) == (places()[i].link >= 3 ? 5.0 : infinite));
}

TEST_CASE("FeltPlaces: numbers out of range are refused with the range") {
  CHECK(refusal(settings()).empty());
  const auto with = [](auto&& change) {
    Settings s = settings();
    change(s);
    return refusal(s);
  };
  CHECK(with([](Settings& s) { s.places.clear(); }).find("places = 0") != std::string::npos);
  CHECK(with([](Settings& s) { s.places[3].link = 6; }).find("link of a place = 6") != std::string::npos);
  CHECK(with([](Settings& s) { s.force = 0; }).find("force = 0, allowed: 1 to") != std::string::npos);
  CHECK(with([](Settings& s) { s.stiffness = 0.5; }).find("stiffness = 0.5") != std::string::npos);
  CHECK(with([](Settings& s) { s.deceleration = 0; }).find("deceleration = 0") != std::string::npos);
  CHECK(with([](Settings& s) { s.reaction_time = 2s; }).find("reaction_time = 2") != std::string::npos);
  CHECK(with([](Settings& s) { s.newtons = std::nan(""); }).find("newtons") != std::string::npos);
  CHECK(with([](Settings& s) { s.newtons = 0; }).find("newtons = 0") != std::string::npos);
  CHECK(with([](Settings& s) { s.wrist = 6; }).find("wrist = 6") != std::string::npos);
  CHECK(with([](Settings& s) { s.motors = {1, 2}; }).find("motors = 2") != std::string::npos);
  CHECK(with([](Settings& s) { s.motors = {1, 2, 3, 4, 5, 0}; }).find("motors = 0") != std::string::npos);
}
