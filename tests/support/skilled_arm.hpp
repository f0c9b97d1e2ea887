// A UR5 with all skills of its controllers, under random requests and touches.
#pragma once

#include <array>
#include <cmath>

#include "skinctl/control/force_control.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/joint_control.hpp"
#include "skinctl/control/operational_control.hpp"
#include "skinctl/control/skin_cartesian_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/control/spline_operational.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/skills/library.hpp"
#include "skinctl/testing/plant.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/scene.hpp"

namespace skinctl::testing {

// A trait, not a requires-expression in a generic lambda: Clang 14 takes those for false.
template <class Request, class G>
inline constexpr bool has_taker = requires(Request& r) { r.goals.template of<G>().goal; };

inline const ur5::Model skilled_model;
template <class T>
using ArmTouch = LinkWrenches<ur5::Model, 0b110110, T>;

/// Friction of the arm that carries the torque: B = decay M [1/s].
inline constexpr double skilled_decay = 6;

template <class T>
JointControlSettings<6, T> skilled_settings(const T& dt) {
  JointControlSettings<6, T> s;
  s.dt = nanoseconds(dt);
  s.lambda = T(0.2) / dt > T(60) ? T(60) : T(T(0.2) / dt);
  s.K_c = T(8);
  s.tb = 4s;
  s.virtual_dynamics.damping = T(skilled_decay);
  return s;
}

template <class T>
auto skilled_tool() {
  return Transform<Link<5>, Tool, T>::translation_xyz(T(0), T(0), T(0.1));
}
/// All controllers of Fig. 7 and section 6; under sanitizers a few, as all of them take a minute to compile.
template <class T = double>
auto skilled_arm(const T& dt, const SkillSettings& settings = {}) {
  const auto s = skilled_settings(dt);
  const auto library = boost::hana::union_(figure_7, section_6);
  const auto gravity = skill_controller<controller::Gravity>(GravityControl{});
  const auto skin = skill_controller<controller::SkinJoint>(SkinJointControl{});
  const auto spline = skill_controller<controller::SplineJoint>(SplineJoint<6, T>(s));
  const auto joint = skill_controller<controller::Joint>(JointControl<6, T>(s));
  if constexpr (sanitized) {
    return skill_set<behaviour::KinestheticJoint>(library, settings, gravity, skin, spline);
  } else {
    const OperationalSettings<6, T> o{.tracking = s};
    const OperationalSpace<6, 5, Tool, T> space(skilled_tool<T>(), o);
    return skill_set<behaviour::KinestheticJoint>(
        library, settings, gravity, skin, spline, joint,
        skill_controller<controller::SkinCartesian>(SkinCartesianControl<5, Tool, T>(skilled_tool<T>())),
        skill_controller<controller::Operational>(OperationalControl<6, 5, Tool, T>(space, o)),
        skill_controller<controller::SplineOperational>(SplineOperational<6, 5, Tool, T>(space, o)),
        skill_controller<controller::Force>(ForceControl<6, 5, Tool, T>(skilled_tool<T>(), {.pose = o})));
  }
}

/// The environment of the arm: intermittent touches, and goals, all from one seed.
template <class Set, class T>
class SkilledRun {
 public:
  using KnownTo = Quantities<ur5::Model, Set::needs, T, ArmTouch<T>>;
  using Goal = typename Set::Goal;

  SkilledRun(const Set& set, const T& dt, std::uint64_t seed) : set_(set), dt_(dt), random_(seeded(seed)) {
    for (T& q : state_.q) q = static_cast<T>(uniform(random_, -2.5, 2.5));
    for (T& v : state_.dq) v = static_cast<T>(uniform(random_, -0.5, 0.5));
    memory_ = set_.start(known());
  }
  [[nodiscard]] KnownTo known() const { return KnownTo(skilled_model, state_, dt_, touch_); }
  [[nodiscard]] const State<6, T>& state() const { return state_; }
  [[nodiscard]] const typename Set::Memory& memory() const { return memory_; }
  [[nodiscard]] bool changing() const { return memory_.phase == SkillPhase::loading; }
  [[nodiscard]] Random& random() { return random_; }
  Status ask(const Goal& goal) {
    const auto answer = set_.receive(memory_, known(), goal);
    memory_ = answer.memory;
    return answer.status;
  }
  /// A skill with a goal for every controller that takes one.
  Goal any_request(std::uint8_t skill) { return with_any_goals(Set::start_skill(skill)); }
  /// Other goals for the active skill.
  Goal any_goals() { return with_any_goals(Set::goal()); }
  Goal with_any_goals(const Goal& request) {
    JointGoal<6, T> goal{state_.q, nanoseconds(uniform(random_, 0.5, 4.0))};
    for (T& q : goal.q_g) q += static_cast<T>(uniform(random_, -0.5, 0.5));
    JointReference<6, T> target{goal.q_g, {}, {}};
    for (T& v : target.dq_d) v = static_cast<T>(uniform(random_, -0.3, 0.3));
    const auto away = [&](double by) { return static_cast<T>(uniform(random_, -by, by)); };
    const T turn = away(0.5), x = away(0.1), y = away(0.1), z = away(0.1);
    const auto X = tool().translated(x, y, z).rotated_x(turn);
    const PoseGoal<Tool, T> pose{X, goal.duration};
    PoseReference<Tool, T> moving{X, {}, {}};
    moving.V.linear = {away(0.1), away(0.1), away(0.1)};
    const ForceGoal<T> force{{away(1), away(1), away(1)}, static_cast<T>(uniform(random_, 0.0, 20.0))};
    return with_known_goals(request, goal, target, pose, moving, force);
  }
  /// Those of the goals that controllers of the set accept.
  template <class... G>
  static Goal with_known_goals(Goal request, const G&... goals) {
    const auto one = [&](const auto& goal) {
      using X = std::remove_cvref_t<decltype(goal)>;
      if constexpr (has_taker<Goal, X>) {
        request.goals.template of<X>().has = true;
        request.goals.template of<X>().goal = goal;
      }
    };
    (one(goals), ...);
    return request;
  }
  [[nodiscard]] Transform<Base, Tool, T> tool() const {
    return Poses<ur5::Model, all_links(6), T>(skilled_model,
                                              JointAngles<ur5::Model, T>(skilled_model, state_.q))
               .template get<5>() *
           skilled_tool<T>();
  }
  /// A touch of up to `force` anywhere on a link; it rises and falls within a tenth of a second.
  void touch(double force) {
    const double u = uniform(random_, -1.0, 1.0), v = uniform(random_, -1.0, 1.0),
                 w = uniform(random_, -1.0, 1.0);
    const double size = force * uniform(random_, 0.25, 1.0) / std::sqrt(u * u + v * v + w * w + 1e-9);
    wanted_ = {};
    const auto at = [&] { return static_cast<T>(uniform(random_, -0.15, 0.15)); };
    const Xyz<T> f{T(size * u), T(size * v), T(size * w)};
    const Xyz<T> moment = cross(Xyz<T>{at(), at(), at()}, f);
    if (random_() % 2 == 0)
      wanted_.template set<2>({f, moment});
    else
      wanted_.template set<4>({f, moment});
    rise_ = T(0);
    lasts_ = true;
  }
  void release() { lasts_ = false; }
  void hold_touch(bool hold) { held_ = hold; }
  [[nodiscard]] JointTorque<6, T> torque() const { return set_.torque(memory_, known()); }
  /// One cycle.
  auto step() {
    const auto e = evaluate(set_, memory_, known(), dt_);
    memory_ = e.memory;
    auto tau = e.torque;
    const auto mass = mass_matrix(skilled_model, state_.q);
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j) tau[i] -= T(skilled_decay) * mass(i, j) * state_.dq[j];
    state_ = simulate(skilled_model, state_, tau, dt_, 1);
    for (T& v : state_.dq) v = v > T(2) ? T(2) : v < T(-2) ? T(-2) : v;  // as a resolver's limits do
    if (!held_) {
      rise_ += (lasts_ ? dt_ : -dt_) * T(10);
      rise_ = rise_ < T(0) ? T(0) : rise_ > T(1) ? T(1) : rise_;
      touch_ = quintic(rise_).a1 * wanted_;
    }
    return e;
  }

 private:
  const Set& set_;
  T dt_;
  Random random_;
  State<6, T> state_;
  ArmTouch<T> touch_, wanted_;
  T rise_ = T(0);
  bool lasts_ = false, held_ = false;
  typename Set::Memory memory_;
};

/// One change of skill, from the seed alone.
struct Bump {
  double jump = 0;     ///< step of the torque at the request, beyond that without it [N m]
  double kink = 0;     ///< change of the torque's rate by it, where that was within its bound [N m/s]
  double rate = 0;     ///< largest rate of the torque by the change, without the touch's [N m/s]
  double before = 0;   ///< the same shortly before the request
  double carried = 0;  ///< largest difference from the laws' torque [N m]
  double time = 0;     ///< until the transfer has ended [s]
  bool finite = true;

  void widen(const Bump& b) {
    jump = std::max(jump, b.jump);
    kink = std::max(kink, b.kink);
    rate = std::max(rate, b.rate);
    before = std::max(before, b.before);
    carried = std::max(carried, b.carried);
    time = std::max(time, b.time);
    finite = finite && b.finite;
  }
  [[nodiscard]] bool within(const Bump& bounds) const {
    return finite && jump <= bounds.jump && kink <= bounds.kink && rate <= bounds.rate && time <= bounds.time;
  }
};

/// Bounds of a bump. The rate is that configured for the skills, to 3 %: the effect of the skin's changing
/// weights is predicted for a constant touch, and touches grow by up to 2 N m in a cycle.
inline const Bump bump_bounds{.jump = 0.25, .kink = 300, .rate = SkillSettings{}.max_rate * 1.03, .time = 4};

/// @param look  called with the time since the request, the evaluation and the run, in every cycle.
template <class T, class Set, class Look>
Bump bump(const Set& set, std::uint8_t from, std::uint8_t to, std::uint64_t seed, const T& dt, Look&& look) {
  SkilledRun<Set, T> run(set, dt, seed * 10007 + from * 101u + to);
  auto& random = run.random();
  const auto cycles = [&](double s) { return static_cast<int>(s / static_cast<double>(dt)); };
  const auto once_in = [&](double s) { return random() % static_cast<std::uint64_t>(cycles(s)) == 0; };
  run.ask(Set::report(closed()));  // as force control needs it
  run.ask(run.any_request(from));
  if (random() % 4 != 0) run.touch(40);
  const int first = cycles(uniform(random, 0.0, 0.6));
  for (int k = 0; k < first; ++k) {
    run.step();
    if (once_in(0.5)) run.release();
  }
  Bump out;
  const auto skin = [](const auto& e) {
    JointTorque<6, T> tau;
    for (std::size_t i = 0; i < Set::controllers; ++i)
      if (Set::Fusion::roles[i] == LawRole::reactive) tau += e.shares[i];
    return tau;
  };
  auto memory = run.memory();  // of the last cycle
  JointTorque<6, T> own;       // torque without the skin's, in it
  double time = -cycles(0.1) * static_cast<double>(dt);
  // with the present touch
  const auto last = [&] { return own + skin(evaluate(set, memory, run.known(), dt)); };
  const auto follow = [&](double* fastest, bool all) {
    const auto before = last();
    const auto weighed = before - own;
    // A change that keeps a tracking law moves only the skin's weights: the torque of that law does not
    // count.
    const bool whole = all || Set::Blend::swaps(run.memory().blend);
    memory = run.memory();
    const auto e = run.step();
    const auto felt = skin(e);
    const auto moved = whole ? e.torque - before : felt - weighed;
    if (fastest) *fastest = std::max(*fastest, largest(moved) / static_cast<double>(dt));
    const double carried = largest(e.shares[Set::controllers]);
    out.carried = std::max(out.carried, carried);
    for (const T& v : e.torque) out.finite = out.finite && v - v == T(0);
    look(time, e, run);
    time += static_cast<double>(dt);
    own = e.torque - felt;
    return run.changing() || run.memory().waits || carried > 0;
  };
  for (int k = 0; k < cycles(0.1); ++k) follow(k > 0 ? &out.before : nullptr, true);
  out.carried = 0;
  const auto before = last(), otherwise = run.torque();
  auto other = run;
  run.ask(Set::report(closed()));
  run.ask(run.any_request(to));
  const auto now = run.torque();
  for (std::size_t i = 0; i < 6; ++i)
    out.jump = std::max(out.jump, static_cast<double>(detail::magnitude(T(now[i] - before[i])) -
                                                      detail::magnitude(T(otherwise[i] - before[i]))));
  bool goes_on = follow(&out.rate, false);
  other.step();
  const auto after = other.torque();
  if (std::max(largest(otherwise - before), largest(after - otherwise)) <=
      bump_bounds.rate * static_cast<double>(dt))
    out.kink = largest(run.torque() - after) / static_cast<double>(dt);
  // Some are interrupted: by other goals, by a third skill, by a touch that comes or goes.
  const auto interruption = random() % 6;
  run.hold_touch(interruption > 2);
  while (goes_on && time < 2 * bump_bounds.time) {
    if (time < 0.5 && once_in(0.2)) {
      if (interruption == 0) run.ask(run.any_goals());
      if (interruption == 1) run.ask(run.any_request(static_cast<std::uint8_t>(random() % Set::skills)));
      if (interruption == 2) random() % 2 == 0 ? run.release() : run.touch(40);
    }
    goes_on = follow(&out.rate, false);
  }
  out.time = time;
  return out;
}
template <class T, class Set>
Bump bump(const Set& set, std::uint8_t from, std::uint8_t to, std::uint64_t seed, const T& dt) {
  return bump<T>(set, from, to, seed, dt, [](double, const auto&, const auto&) {});
}

}  // namespace skinctl::testing
