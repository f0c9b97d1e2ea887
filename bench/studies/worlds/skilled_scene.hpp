// The skills as a whole scene: a UR5 by position with 260 cells of skin, which follows one cycle late.
#pragma once

#include <memory>

#include "tests/support/scene.hpp"
#include "tests/support/skilled_arm.hpp"

namespace skinctl::testing {

/// @param period  of the cycle, and the delay of the robot.
template <class T>
auto skilled_scene(Nanoseconds period, const SkillSettings& settings = {}) {
  SceneSettings s;
  s.period = s.delay = period;
  s.decay = skilled_decay;
  s.force_gain = 20;
  return make_scene<Interface::position, 260, T>(skilled_arm<T>(seconds<T>(period), settings), s);
}

// Not requires-expressions in a generic lambda: Clang 14 takes those for false.
template <class L>
inline constexpr bool has_integrals = requires(const typename L::Memory& memory) { memory.I1.sum; };
template <class T>
const JointControlSettings<6, T>& gains_of(const JointControlSettings<6, T>& s) {
  return s;
}
template <class T>
const JointControlSettings<6, T>& gains_of(const OperationalSettings<6, T>& s) {
  return s.tracking;
}

/// The scene in operation: random skills and goals, and intermittent touches of up to three cells.
template <class Scene>
class SkilledDay {
 public:
  using T = typename Scene::scalar;
  using Set = typename Scene::law_type;
  using Goal = typename Scene::Goal;

  SkilledDay(const Scene& scene, Nanoseconds period, std::uint64_t seed)
      : scene_(scene),
        period_(period),
        random_(seeded(seed)),
        memory_(std::make_unique<typename Scene::Memory>()) {
    measured_.q = home_position<T>();
    scene_.start(*memory_, measured_);
    under_way_ = measured_.q;
    input_.measured = measured_;
  }
  [[nodiscard]] const typename Scene::Memory& memory() const { return *memory_; }
  [[nodiscard]] const State<6, T>& measured() const { return measured_; }
  [[nodiscard]] Nanoseconds now() const { return measured_.time; }
  [[nodiscard]] Random& random() { return random_; }
  [[nodiscard]] const typename Scene::Input& input() const { return input_; }
  void ask(const Goal& goal) { input_.goal = goal; }
  void release_all() {
    for (auto& s : touch_) s.force = {};
    touching_ = false;
    changed_ = true;
  }
  /// Returns home with joint control.
  void go_home() {
    ask(Set::template start_skill<behaviour::ReachJointGoal>(JointGoal<6, T>{home_position<T>(), 5s}));
  }

  /// Random events: another skill with goals near the present pose, another goal, a touch, a release.
  void happen() {
    const auto once_in = [&](double s) {
      return static_cast<double>(random_() >> 11) * 0x1p-53 * s < seconds<double>(period_);
    };
    if (once_in(3)) ask(any_goal(Set::start_skill(static_cast<std::uint8_t>(random_() % Set::skills))));
    if (once_in(6)) ask(any_goal(Goal{}));
    if (once_in(6)) ask(Set::report(random_() % 4 == 0 ? opened() : closed()));
    if (once_in(2) && !touching_) {
      const auto f = static_cast<float>(uniform(random_, 0.0, 0.4));
      for (auto& s : touch_) {
        s.cell = static_cast<std::uint32_t>(1 + random_() % 260);
        s.force = {f, f, f};
      }
      touching_ = changed_ = true;
    }
    if (once_in(1)) release_all();
  }
  auto step() {
    measured_.time += period_;
    const auto before = measured_.q;
    measured_.q = under_way_;
    for (std::size_t i = 0; i < 6; ++i) measured_.dq[i] = (measured_.q[i] - before[i]) / seconds<T>(period_);
    input_.now = measured_.time;
    input_.measured = measured_;
    for (auto& s : touch_) s.time = measured_.time;
    input_.samples = changed_ ? std::span<const CellSample>(touch_) : std::span<const CellSample>();
    changed_ = false;
    const auto out = scene_.step(*memory_, input_);
    last_ = input_;
    input_.goal.reset();
    under_way_ = out.command.position;
    return out;
  }
  /// The input of the last cycle.
  [[nodiscard]] const typename Scene::Input& last() const { return last_; }
  /// The largest integral of a tracking law so far, as a share of its limit.
  [[nodiscard]] double integrals() const {
    double most = 0;
    const auto look = [&](const auto& law, const auto& memory) {
      using Law = std::remove_cvref_t<decltype(law)>;
      if constexpr (has_integrals<Law>) {
        const auto& s = gains_of(law.settings());
        const T* sums[] = {memory.I1.sum, memory.I2.sum};
        const T gains[] = {s.K_i1, s.K_i2};
        for (int k = 0; k < 2; ++k)
          for (std::size_t i = 0; i < 6; ++i)
            most = std::max(most,
                            static_cast<double>(gains[k] * detail::magnitude(sums[k][i]) / s.integral_speed));
      }
    };
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (look(std::get<I>(scene_.law().sum().laws()), Set::Blend::template memory<I>(memory_->law.blend)), ...);
    }(std::make_index_sequence<Set::controllers>{});
    return most;
  }

 private:
  Goal any_goal(Goal request) {
    JointGoal<6, T> goal{measured_.q, nanoseconds(uniform(random_, 0.5, 4.0))};
    for (std::size_t i = 0; i < 6; ++i)
      goal.q_g[i] = static_cast<T>(home[i]) + static_cast<T>(uniform(random_, -0.8, 0.8));
    const JointReference<6, T> target{goal.q_g, {}, {}};
    const auto X_BP =
        Poses<ur5::Model, all_links(6), T>(skilled_model, JointAngles<ur5::Model, T>(skilled_model, goal.q_g))
            .template get<5>() *
        skilled_tool<T>();
    return SkilledRun<Set, T>::with_known_goals(request, goal, target, PoseGoal<Tool, T>{X_BP, goal.duration},
                                                PoseReference<Tool, T>{X_BP, {}, {}},
                                                ForceGoal<T>{{T(0), T(0), T(-1)}, T(10)});
  }

  const Scene& scene_;
  Nanoseconds period_;
  Random random_;
  std::unique_ptr<typename Scene::Memory> memory_;
  State<6, T> measured_;
  JointPosition<6, T> under_way_;
  typename Scene::Input input_, last_;
  std::array<CellSample, 3> touch_{};
  bool changed_ = false, touching_ = false;
};

}  // namespace skinctl::testing
