// A robot whose skin falls silent, in closed loop: by position, by velocity, by torque.
#include "skinctl/limits/skin_watch.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "skinctl/cycle/configurations.hpp"
#include "skinctl/limits/felt_places.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/testing/plant.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/simulated_joints.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::size_t cells = 260;
template <Interface I>
constexpr Nanoseconds period = I == Interface::torque ? Nanoseconds(2ms) : Nanoseconds(8ms);

template <Interface I>
auto plain_scene(double lambda = 10) {
  constexpr bool direct = I == Interface::torque;
  const SceneSettings s{
      .period = period<I>, .delay = direct ? Nanoseconds(0ns) : period<I>, .decay = direct ? 0.0 : 6.0};
  const auto robot = test_robot<I, double>(s);
  auto tracking = tracking_settings(robot);
  tracking.lambda = lambda;
  return Cycle(robot, ur5_skin<cells>({.force = 40}),
               SplineJoint<6>(tracking) + SkinJointControl{} + GravityControl{});
}

/// The ids of the cells of each patch.
std::vector<std::vector<std::uint32_t>> ids() {
  std::vector<std::vector<std::uint32_t>> out;
  const auto add = [&](const auto& patch) {
    out.emplace_back();
    for (const auto& c : patch.placed()) out.back().push_back(c.id);
  };
  std::apply([&](const auto&... patch) { (add(patch), ...); }, ur5::skin_patches<cells>());
  return out;
}

/// A scene, its robot, and its skin, each cell of which sends every 40 ms unless it is `silent`.
template <Interface I, class Scene>
class Run {
 public:
  explicit Run(const Scene& scene) : scene_(scene), memory_(std::make_unique<typename Scene::Memory>()) {
    state_.q = JointPosition<6>(home);
    scene_.start(*memory_, state_);
    goal = state_.q;
    goal[0] += 0.8, goal[1] -= 0.4, goal[3] += 0.5;
    largest_torque_ = ur5_test_limits().torque();
  }

  /// Runs until `end` [s]; keeps the fastest joint of the last stretch.
  void run_to(double end) {
    fastest = 0, status = {}, last_status = {};
    while (time() < end - 1e-9) step();
  }
  void step() {
    const Nanoseconds before = state_.time, now = before + period<I>;
    const auto q_before = state_.q;
    advance(now);
    for (std::size_t i = 0; i < 6; ++i)
      fastest = std::max(fastest, std::abs(state_.q[i] - q_before[i]) / seconds<double>(period<I>));
    typename Scene::Input input{};
    std::vector<CellSample> samples;
    for (std::size_t p = 0; p < patches.size(); ++p)
      for (const std::uint32_t id : patches[p]) {
        const Nanoseconds phase(std::int64_t(id % 40) * 1'000'000);
        const Nanoseconds sent = (now - phase) / 40'000'000 * 40'000'000 + phase;
        if (sent <= before || sent > now || silent_patch[p] || std::count(silent.begin(), silent.end(), id))
          continue;
        samples.push_back({.time = sent, .cell = id});
      }
    if (!speaks) samples.clear();
    input.now = now;
    input.measured = state_;
    input.samples = samples;
    input.request = request;
    request = CycleRequest::none;
    if constexpr (requires { input.configuration; }) input.configuration = configuration;
    if (!asked_ && time() > 0.2) {
      asked_ = true;
      input.goal = {goal, 2s};
    }
    const auto out = scene_.step(*memory_, input);
    REQUIRE(out.command.valid);
    status |= out.status;
    last_status = out.status;
    for (std::size_t i = 0; i < 6; ++i) {
      const double dt = seconds<double>(period<I>);
      if constexpr (I == Interface::torque) {
        const double most = 50 * largest_torque_[i] * dt * (1 + 1e-9);
        if (sent_any_) CHECK(std::abs(out.command.torque[i] - last_.torque[i]) <= most);
      } else {
        CHECK(std::abs(out.planned.velocity[i] - last_.velocity[i]) <= 15 * dt * (1 + 1e-9));
        const double moved = out.planned.position[i] - last_.position[i];
        if (sent_any_ && I == Interface::position)
          CHECK(std::abs(moved) <= ur5::Description::max_velocity * dt * (1 + 1e-9));
      }
    }
    last_ = out.planned;
    sent_any_ = true;
    send(out.planned);
  }
  [[nodiscard]] double time() const { return seconds<double>(state_.time); }
  [[nodiscard]] double moved() const {
    double most = 0;
    for (std::size_t i = 0; i < 6; ++i) most = std::max(most, std::abs(state_.q[i] - home[i]));
    return most;
  }
  [[nodiscard]] double away() const {
    double most = 0;
    for (std::size_t i = 0; i < 6; ++i) most = std::max(most, std::abs(state_.q[i] - goal[i]));
    return most;
  }

  std::vector<std::vector<std::uint32_t>> patches = ids();
  std::vector<bool> silent_patch = std::vector<bool>(patches.size());
  std::vector<std::uint32_t> silent;
  bool speaks = true;
  CycleRequest request = CycleRequest::none;
  std::uint32_t configuration = 0;
  JointPosition<6> goal;
  double fastest = 0;
  Status status, last_status;

 private:
  void advance(Nanoseconds now) {
    if constexpr (I == Interface::torque) {
      if (sent_any_) {
        const Nanoseconds from = state_.time;
        state_ = simulate(ur5::Model{}, state_, last_.torque, seconds<double>(now - from), 1);
      }
    } else {
      joints_.advance(seconds<double>(now));
      for (std::size_t i = 0; i < 6; ++i) state_.q[i] = joints_.q()[i], state_.dq[i] = joints_.dq()[i];
    }
    state_.time = now;
  }
  void send(const JointCommand<6>& command) {
    std::array<double, 6> row{};
    for (std::size_t i = 0; i < 6; ++i)
      row[i] = I == Interface::position ? command.position[i] : command.velocity[i];
    joints_.command(time(), row);
  }

  Scene scene_;
  std::unique_ptr<typename Scene::Memory> memory_;
  State<6> state_;
  SimulatedJoints<6> joints_{
      I == Interface::velocity ? SimulatedJoints<6>::Kind::velocity : SimulatedJoints<6>::Kind::position,
      seconds<double>(period<I>), 0.004, home};
  JointCommand<6> last_;
  JointTorque<6> largest_torque_;
  bool asked_ = false, sent_any_ = false;
};
template <Interface I, class Scene>
Run<I, Scene> run_of(const Scene& scene) {
  return Run<I, Scene>(scene);
}

template <Interface I>
void never_speaks() {
  auto blind = run_of<I>(plain_scene<I>());
  blind.speaks = false;
  blind.run_to(3);
  CHECK(blind.moved() > 0.5);  // a scene that does not watch takes a blind skin for an untouched one
  auto run = run_of<I>(plain_scene<I>().with(SkinWatch{}));
  run.speaks = false;
  run.run_to(3);
  CHECK(run.moved() < 1e-6);
  CHECK((run.status & (Status(Reason::skin_unheard) | Reason::skin_held | Reason::skin_stopped)) ==
        (Status(Reason::skin_unheard) | Reason::skin_held));
  CHECK_FALSE(run.status.has(Reason::stopping));
  // A resume does not help; a stop of the user's stays one.
  run.request = CycleRequest::resume;
  run.run_to(3.2);
  CHECK(run.moved() < 1e-6);
  run.request = CycleRequest::stop;
  run.run_to(3.3);
  run.speaks = true;
  run.run_to(4.5);
  CHECK(run.moved() < 1e-6);
  CHECK(run.last_status.has(Reason::stopping));
  CHECK_FALSE(run.last_status.has(Reason::skin_held));
  run.request = CycleRequest::resume;
  run.run_to(5);
  CHECK(run.moved() > 0.01);
  auto free = run_of<I>(plain_scene<I>());
  free.run_to(4);
  run.run_to(9);
  CHECK(run.away() < 0.002);
  CHECK(run.fastest <= 1.02 * free.fastest);  // nothing is caught up
}

template <Interface I>
void falls_silent_and_comes_back() {
  auto run = run_of<I>(plain_scene<I>().with(SkinWatch{}));
  run.run_to(1.4);
  CHECK(run.fastest > 0.3);
  CHECK_FALSE(run.last_status.has(Reason::skin_held));
  // Link by link, the first is enough: within max_age, 250 ms, and the time to brake.
  run.silent_patch[0] = true;
  run.run_to(1.4 + 0.25 + 0.15);
  CHECK(run.status.has(Reason::skin_blind));
  CHECK(run.status.has(Reason::skin_stopped));
  run.run_to(2.0);
  CHECK(run.fastest < (I == Interface::torque ? 0.02 : 1e-3));
  for (std::size_t p = 1; p < run.patches.size(); ++p) {
    run.silent_patch[p] = true;
    run.run_to(2.0 + 0.1 * static_cast<double>(p));
  }
  const double stood = run.moved();
  run.request = CycleRequest::resume;  // while it is still blind
  run.run_to(3);
  CHECK(std::abs(run.moved() - stood) < 1e-3);
  std::fill(run.silent_patch.begin(), run.silent_patch.end(), false);
  run.run_to(5);
  CHECK(std::abs(run.moved() - stood) < 2e-3);
  CHECK(run.last_status.has(Reason::consent_awaited));
  CHECK_FALSE(run.last_status.has(Reason::skin_stopped));
  run.request = CycleRequest::resume;
  run.run_to(9);
  CHECK(run.away() < 0.002);
  CHECK_FALSE(run.last_status.has(Reason::consent_awaited));
}

template <Interface I>
void leads_with_dead_cells(const auto&... beside) {
  const auto plain = plain_scene<I>().with(beside...);
  auto run = run_of<I>(
      plain.with(FeltPlaces<cells>{.places = plain.skin().places(), .stiffness = 3e3, .newtons = 20}));
  run.run_to(1.2);
  CHECK(run.fastest > 0.15);
  for (const auto& patch : run.patches) run.silent.insert(run.silent.end(), patch.begin(), patch.end());
  run.run_to(1.2 + 0.25 + 0.4);
  CHECK(run.last_status.has(Reason::skin_slowed));
  run.run_to(3);
  CHECK(run.fastest <= 2e-3);
  CHECK(run.away() > 0.1);
  run.silent.clear();
  run.run_to(9);
  CHECK_FALSE(run.last_status.has(Reason::skin_slowed));
  CHECK(run.away() < 0.002);
}

/// Places behind the last cell of the touch feel nothing.
void more_places_than_cells() {
  constexpr auto I = Interface::position;
  const auto plain = plain_scene<I>();
  FeltPlaces<2 * cells> felt{.places = plain.skin().places(), .stiffness = 3e3, .newtons = 20};
  const auto once = felt.places;
  felt.places.insert(felt.places.end(), once.begin(), once.end());
  auto run = run_of<I>(plain.with(felt));
  run.run_to(2);
  CHECK(run.moved() < 2e-3);
}

template <Interface I>
void changes_while_held() {
  const Configurations scene(plain_scene<I>().with(SkinWatch{}), plain_scene<I>(8).with(SkinWatch{}));
  auto run = run_of<I>(scene);
  run.speaks = false;
  run.run_to(0.5);
  run.configuration = 1;
  run.run_to(1);
  CHECK(run.moved() < 1e-6);
  CHECK(run.status.has(Reason::skin_held));
  run.speaks = true;
  run.run_to(6);
  CHECK_FALSE(run.last_status.has(Reason::configuration_refused));
  CHECK(run.away() < 0.005);
}

}  // namespace

TEST_CASE("SkinWatch: another configuration while it holds: no step, and it goes on with it") {
  SUBCASE("by position") {
    changes_while_held<Interface::position>();
  }
  SUBCASE("by torque") {
    changes_while_held<Interface::torque>();
  }
}
TEST_CASE("SkinWatch: a robot whose skin never speaks does not move before it is heard") {
  SUBCASE("by position") {
    never_speaks<Interface::position>();
  }
  SUBCASE("by velocity") {
    never_speaks<Interface::velocity>();
  }
  SUBCASE("by torque") {
    never_speaks<Interface::torque>();
  }
}
TEST_CASE("SkinWatch: a skin that falls silent link by link stops the robot; it goes on with consent") {
  SUBCASE("by position") {
    falls_silent_and_comes_back<Interface::position>();
  }
  SUBCASE("by velocity") {
    falls_silent_and_comes_back<Interface::velocity>();
  }
  SUBCASE("by torque") {
    falls_silent_and_comes_back<Interface::torque>();
  }
}
TEST_CASE("FeltPlaces: with places that feel nothing it does not go on, and does when they do") {
  SUBCASE("by position") {
    leads_with_dead_cells<Interface::position>();
  }
  SUBCASE("by velocity") {
    leads_with_dead_cells<Interface::velocity>();
  }
  SUBCASE("by torque") {
    leads_with_dead_cells<Interface::torque>();
  }
  SUBCASE("more places than cells") {
    more_places_than_cells();
  }
  SUBCASE("by position, beside a limit of jerk") {
    leads_with_dead_cells<Interface::position>(MaxJerk{JointJerk<6>::constant(300)});
  }
}

TEST_CASE("SkinWatch: what only reports changes no bit of a motion; a scene without it holds nothing of it") {
  constexpr auto I = Interface::position;
  const auto plain = plain_scene<I>();
  const auto watched = plain.with(SkinWatch{.unheard = SkinReaction::report, .blind = SkinReaction::report});
  auto a = run_of<I>(plain);
  auto b = run_of<I>(watched);
  a.silent = b.silent = {a.patches[1][0]};
  for (int k = 0; k < 300; ++k) {
    if (k == 100) a.speaks = b.speaks = false;
    a.step(), b.step();
    REQUIRE(a.moved() == b.moved());
  }
  CHECK(b.status.has(Reason::skin_unheard));
  CHECK(b.status.has(Reason::skin_incomplete));
  CHECK(b.status.has(Reason::skin_blind));
  static_assert(!std::remove_cvref_t<decltype(plain.governor())>::acts);
}
