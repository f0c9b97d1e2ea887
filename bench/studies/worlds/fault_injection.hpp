// The faults of the table `faults`, each injected into running skills, and the conditions that hold in every
// run.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "skinctl/guard/faults.hpp"
#include "skinctl/limits/contact_limits.hpp"
#include "skinctl/resolver/resolver_of.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/skilled_arm.hpp"

namespace skinctl::testing {

/// A resolver whose commands can be corrupted on their way to the guard.
template <class R>
struct Spoilt : R {
  explicit Spoilt(const R& r) : R(r) {}
  enum class How { not_at_all, nan, infinity, none, leap, end };
  static inline How how = How::not_at_all;

  template <class L, class Touch, class Check, class Pressed, class Movers>
  auto step(typename R::Memory& m, const L& law, typename L::Memory& law_memory,
            const State<R::joints, typename R::scalar>& measured, const Interval& interval,
            std::span<const Touch> touches, const Check& check, const Pressed& pressed,
            std::span<const LawTouch<Touch>> changes, const Movers& movers) const noexcept {
    using T = typename R::scalar;
    auto out = R::step(m, law, law_memory, measured, interval, touches, check, pressed, changes, movers);
    auto& c = out.command;
    switch (how) {
      case How::nan:
        c.position[2] = c.velocity[2] = c.torque[2] = std::numeric_limits<T>::quiet_NaN();
        break;
      case How::infinity:
        c.position[1] = c.velocity[1] = c.torque[1] = -std::numeric_limits<T>::infinity();
        break;
      case How::none:
        c.valid = false;
        break;
      case How::leap:
        c.position[0] += T(0.5);
        if (R::interface == Interface::velocity) c.velocity[0] += T(0.5);
        c.torque[0] += T(1000);
        break;
      case How::end:
        c.position[3] = this->limits().upper()[3] + T(0.1);
        break;
      case How::not_at_all:
        break;
    }
    return out;
  }
};

/// Skills whose torque can be corrupted.
template <class Skills>
struct SpoiltSkills : Skills {
  explicit SpoiltSkills(const Skills& s) : Skills(s) {}
  static inline double torque_added = 0;

  template <class K>
  [[nodiscard]] auto evaluate(const typename Skills::Memory& memory, const K& known,
                              const typename K::scalar& dt) const noexcept {
    auto out = Skills::evaluate(memory, known, dt);
    for (auto& t : out.torque) t += static_cast<typename K::scalar>(torque_added);
    return out;
  }
};

template <Interface I>
using SmallResolver = ResolverBy<I, ur5::Model, double, SemiImplicitEuler>;  // fastest to compile

/// All skills of an arm; under sanitizers, where laws take long to compile, only the led arm.
inline auto faulty_skills(double dt) {
  if constexpr (sanitized) {
    return skill_set<behaviour::KinestheticJoint>(
        figure_7, {}, skill_controller<controller::Gravity>(GravityControl{}),
        skill_controller<controller::SkinJoint>(SkinJointControl{}));
  } else {
    return skilled_arm<double>(dt);
  }
}

/// A scene for fault injection: all skills of a UR5 with skin and contact limits. The numbers are the test's
/// own.
template <Interface I>
auto faulty_scene() {
  SceneSettings s;
  s.decay = skilled_decay;
  auto c = configuration_of<I, double>(s);
  c.dead_band =
      JointPosition<6>::constant(0.03);  // v_max times a period: the joints jump from sample to sample
  if (I == Interface::torque) c.set({});
  SkinSettings skin;
  skin.max_age = 10s;
  const Spoilt robot{SmallResolver<I>(ur5::Model{}, c)};
  const SpoiltSkills law{faulty_skills(seconds<double>(s.period))};
  const auto cells = ur5_skin<260>({.force = s.force_gain}, skin);
  LinkContact<2> contact{
      .region = {.force = 280, .blow = 300, .first = 10s, .stiffness = 1e5, .mass = 4, .power = 500},
      .reach = 0.5,
      .reaction_time = 20ms};
  contact.newton = 10;
  const Cycle scene(robot, cells, law);
  if constexpr (I == Interface::torque) {
    return scene.template without<MotionByTorque>().with(contact);
  } else {
    return scene.with(contact);
  }
}

/// The result of one run.
struct Injected {
  bool reported = false, reacted = true, came_back = true;
  int broken = 0;         ///< commands beyond a limit, not finite, or further than the step bound
  double worst_step = 0;  ///< in units of the largest change in a cycle
  Reaction seen = Reaction::none;
  std::string wrong;  ///< in words; empty: nothing

  [[nodiscard]] bool good() const { return reported && reacted && came_back && broken == 0; }
};

/// One scene, and its runs: each with a fault, the skill that it hits, and a seed for everything else.
template <Interface I>
class FaultInjection {
 public:
  using Scene = decltype(faulty_scene<I>());
  using Skills = typename Scene::law_type;
  static constexpr bool torque = I == Interface::torque;
  static constexpr std::size_t skills = Skills::skills;

  /// Faults from outside, or from a broken stage: the other reasons are limits and reports.
  static constexpr Status injectable = [] {
    Status all;
    for (const Reason r : {Reason::command_not_finite, Reason::step_limited,      Reason::outside_limits,
                           Reason::torque_limited,     Reason::torque_not_finite, Reason::state_not_finite,
                           Reason::state_out_of_range, Reason::state_stale,       Reason::time_backwards,
                           Reason::interval_empty,     Reason::interval_too_long, Reason::packets_lost,
                           Reason::budget_overrun,     Reason::sample_not_finite, Reason::sample_out_of_range,
                           Reason::sample_unknown,     Reason::sample_stale,      Reason::contact_slowed,
                           Reason::contact_force,      Reason::contact_power})
      all |= r;
    return all;
  }();
  /// Whether the fault can be injected at this interface.
  static bool possible(const Fault& f) {
    if (I != Interface::position && f.reason == Reason::outside_limits) return false;
    return injectable.has(f.reason);
  }
  [[nodiscard]] const char* name(std::size_t skill) const { return scene_.law().skill(skill).name; }

  /// Called after each cycle with its number, whether the fault is present, and the output.
  std::function<void(int, bool, const typename Scene::Output&)> watch;

  /// The arm is pushed now and then. The fault begins while `skill` runs, or during the change to it, or
  /// `skill` is requested during the fault; at a random instant, for a random time.
  Injected run(const Fault& f, std::uint8_t skill, std::uint64_t seed) {
    oracle::Random random(seed);
    Injected sum;
    const Reaction documented = torque ? f.torque : f.motion;
    const Reaction reaction = f.finder == FaultFinder::skin ? Reaction::refuse : documented;
    const bool latches = f.way_back == WayBack::on_request;
    const int from = 20 + random.index(60), lasts = f.reason == Reason::state_stale ? 60
                                                    : f.reason == Reason::contact_slowed
                                                        ? 40
                                                        : 6 + random.index(20);
    const int over = from + lasts, resumed = over + 25, end = over + 90;
    const int asked = random.index(4) == 0   ? from + random.index(lasts)
                      : random.index(2) == 0 ? from - random.index(12)
                                             : 1;
    const auto before = static_cast<std::uint8_t>(asked == 1 ? skill : random.index(int(skills)));
    auto& how = Spoilt<SmallResolver<I>>::how;
    using How = typename std::remove_reference_t<decltype(how)>;
    auto q = home_position();
    for (auto& x : q) x += random.uniform(-0.2, 0.2);
    Plant plant(q, s_);
    scene_.start(*memory_, plant.state());
    auto last = scene_.guard().last(memory_->guard);
    State<6> last_good = plant.state();
    Fits fits;
    bool reported = false, awaited = false, calm = false;
    JointTorque<6> skin_torque{};
    Nanoseconds now{};
    const double pushes = random.uniform(0.02, 0.1);
    const int pause = 10 + random.index(20);
    constexpr auto& cells = ur5::skin_cells<260>;
    const auto cell = static_cast<std::uint32_t>(1 + cells[0] + cells[1]) +
                      static_cast<std::uint32_t>(random.index(static_cast<int>(cells[2])));
    for (int k = 0; k < end; ++k) {
      const bool faulty = k >= from && k < over;
      now += s_.period;
      const State<6> state = plant.run_to(now);
      typename Scene::Input input;
      input.now = now;
      input.measured = state;
      input.measured.time = now;
      const bool pushed = (k / pause) % 2 == 0 && f.reason != Reason::contact_slowed;
      const auto f3 = static_cast<float>(pushed ? pushes : 0);
      CellSample sample{.time = now - 1ms, .cell = cell, .force = {f3, f3, f3}};
      input.samples = std::span(&sample, 1);
      if (k == 0 || k + 1 == asked) ask(input, Skills::report(closed()));  // as force control needs it
      if (k == 1) ask(input, request(before, state.q, random));
      if (k == asked) ask(input, request(skill, state.q, random));
      how = How::not_at_all;
      Skills::torque_added = 0;
      auto twin_input = input;
      if (faulty) inject(f.reason, input, sample, k - from, now, random, skin_torque);
      if (k == resumed) input.request = CycleRequest::resume;
      const bool twin = faulty && is_left_out(f);
      if (twin) {
        *twin_ = *memory_;
        if (f.finder == FaultFinder::skin) {
          twin_input.samples = {};
        } else {
          twin_input.measured = last_good;
        }
      }
      const auto out = scene_.step(*memory_, input);
      if (watch) watch(k, faulty, out);
      how = How::not_at_all;
      Skills::torque_added = 0;
      if (twin) fits.left_out &= same(scene_.step(*twin_, twin_input).planned, out.planned);
      if (!faulty) last_good = input.measured;
      skin_torque = {};
      for (std::size_t i = 0; i < Skills::Fusion::terms; ++i)
        if (Skills::Fusion::roles[i] == LawRole::reactive) skin_torque += out.shares[i];
      if (input.now > last.time) check_limits(last, out.planned, input.now, sum);

      const bool here = out.status.has(f.reason);
      // A blocked virtual robot ignores its laws, and a robot slowed by contact limits does not leap.
      const bool deaf = (f.finder == FaultFinder::resolver && out.status.has(Reason::blocked)) ||
                        (f.motion == Reaction::brake && out.status.has(Reason::contact_slowed));
      reported |= (here || deaf) && faulty;
      const bool waits = out.status.has(Reason::consent_awaited);
      // The resolver reports `state_stale` earlier, and brakes in its own way.
      if (here && faulty && (f.reason != Reason::state_stale || k - from > 27))
        fits.look(*this, last, out.planned, input.now, k - from, input.measured);
      if (k > over && k < resumed)
        fits.stop &= waits && at_rest(out.planned, k > over + 23, k - from, input.measured);
      if (!latches) awaited |= waits;
      if (k > resumed + 1) sum.came_back &= !waits;
      calm |= k > resumed && (!out.status.has(f.reason) || f.reason == Reason::sample_stale);
      last = out.planned;
      plant.command(now, out.planned);
    }
    const auto& law = memory_->law;
    const std::uint8_t next = scene_.law().skill(skill).next;
    const bool there = law.skill == skill || law.skill == next || (law.waits && law.waiting.skill == skill);
    sum.reported = reported;
    sum.reacted = fits.fits(reaction) && !awaited;
    sum.came_back &= there && calm;
    sum.seen = fits.fits(reaction) ? documented : fits.other();
    const auto say = [&](bool good, const char* what) {
      if (!good) sum.wrong += sum.wrong.empty() ? what : std::string(", ") + what;
    };
    say(reported, "not reported");
    say(fits.fits(reaction), "reacted otherwise");
    say(!awaited, "asked for consent");
    say(sum.came_back, there ? "did not come back" : "lost its skill");
    say(sum.broken == 0, "a command beyond its limits");
    return sum;
  }

 private:
  /// Joints that follow positions and velocities stiffly, one cycle late; for torques, a free arm with
  /// friction.
  class Plant {
   public:
    Plant(const JointPosition<6>& q, const SceneSettings& s) : s_(s), joints_(q, s.delay, s.lag), goal_(q) {
      state_.q = q;
    }
    [[nodiscard]] const State<6>& state() const { return state_; }
    const State<6>& run_to(Nanoseconds now) {
      if (torque) {
        if (now <= state_.time) return state_;
        const double h = sent_.valid ? seconds<double>(s_.period) : 0;
        const auto given = forward_dynamics(ur5::Model{}, state_.q, state_.dq, sent_.torque);
        for (std::size_t i = 0; i < 6; ++i)
          state_.dq[i] += h * (given.acceleration[i] - skilled_decay * state_.dq[i]);
        state_.q = integrate(state_.q, state_.dq, h);
        for (std::size_t i = 0; i < 6; ++i) {
          state_.dq[i] = std::clamp(state_.dq[i], -limits_.velocity()[i], limits_.velocity()[i]);
          state_.q[i] = std::clamp(state_.q[i], limits_.lower()[i], limits_.upper()[i]);
        }
      } else {
        state_.q = joints_.run_to(now).q;
        state_.dq = sent_.velocity;  // those of the joints' small steps are all spikes
      }
      state_.time = now;
      return state_;
    }
    void command(Nanoseconds now, const JointCommand<6>& c) {
      sent_ = c;
      if (I == Interface::position) joints_.command(now, c.position);
      // Velocities are held for a period; then the robot's own watchdog stops it.
      for (Nanoseconds t{}; I == Interface::velocity && now > until_ && t < s_.period; t += 1ms)
        joints_.command(now + t, goal_ = integrate(goal_, c.velocity, 0.001));
      until_ = now;
    }

   private:
    SceneSettings s_;
    StiffJoints<> joints_;
    JointPosition<6> goal_;
    State<6> state_;
    JointCommand<6> sent_;
    Nanoseconds until_{};
    JointLimits<6> limits_ = ur5_test_limits<double>();
  };

  /// Reactions that the commands of a run are consistent with.
  struct Fits {
    bool hold = true, brake = true, fade = true, stop = true, left_out = true;

    void look(const FaultInjection& of, const JointCommand<6>& last, const JointCommand<6>& c,
              Nanoseconds now, int k, const State<6>& state) {
      hold &= c.position == last.position && c.torque == last.torque;
      brake &= torque || of.brakes(last, c, now);
      fade &= !torque || k < 5 || of.near_fallback(c, k, state);
    }
    [[nodiscard]] bool fits(Reaction r) const {
      switch (r) {
        case Reaction::refuse:
          return left_out;
        case Reaction::hold:
          return hold;
        case Reaction::brake:
          return brake;
        case Reaction::fade:
          return fade;
        case Reaction::stop:
          return stop && (torque ? fade : brake);
        default:
          return true;
      }
    }
    [[nodiscard]] Reaction other() const {
      for (const Reaction r : {Reaction::stop, Reaction::hold, Reaction::brake, Reaction::fade})
        if (fits(r)) return r;
      return Reaction::limit;
    }
  };

  /// Whether the run with the fault must equal one without the refused input to the bit.
  static bool is_left_out(const Fault& f) {
    if (f.finder == FaultFinder::skin)
      return true;  // also a sample that is too old: its cell fades in its own time
    return f.finder == FaultFinder::guard && (torque ? f.torque : f.motion) == Reaction::refuse;
  }
  static bool same(const JointCommand<6>& a, const JointCommand<6>& b) {
    return a.position == b.position && a.velocity == b.velocity && a.torque == b.torque;
  }
  static void ask(typename Scene::Input& input, const typename Scene::Goal& goal) { input.goal = goal; }
  /// A skill with goals for all controllers, near the arm's initial pose.
  typename Scene::Goal request(std::uint8_t skill, const JointPosition<6>& q, oracle::Random& random) const {
    JointGoal<6> goal{q, nanoseconds(random.uniform(1, 4))};
    for (auto& x : goal.q_g) x += random.uniform(-0.4, 0.4);
    const auto X_BP =
        Poses<ur5::Model, all_links(6)>(skilled_model, goal.q_g).template get<5>() * skilled_tool<double>();
    return SkilledRun<Skills, double>::with_known_goals(
        Skills::start_skill(skill), goal, JointReference<6>{goal.q_g, {}, {}},
        PoseGoal<Tool>{X_BP, goal.duration}, PoseReference<Tool>{X_BP, {}, {}},
        ForceGoal<double>{{0, 0, -1}, 10});
  }

  void inject(Reason reason, typename Scene::Input& input, CellSample& sample, int k, Nanoseconds& now,
              oracle::Random& random, const JointTorque<6>& skin_torque) {
    auto& how = Spoilt<SmallResolver<I>>::how;
    using How = typename std::remove_reference_t<decltype(how)>;
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    const auto joint = static_cast<std::size_t>(random.index(6));
    const auto hard = [&](float x) { sample.force = {x, x, x}; };
    switch (reason) {
      case Reason::command_not_finite:
        how = k % 3 == 0 ? How::nan : k % 3 == 1 ? How::infinity : How::none;
        break;
      case Reason::step_limited:
        how = How::leap;
        break;
      case Reason::outside_limits:
        how = How::end;
        break;
      case Reason::torque_limited:
        Skills::torque_added = 1e6;
        break;
      case Reason::torque_not_finite:
        Skills::torque_added = k % 2 == 0 ? double(nan) : double(inf);
        break;
      case Reason::state_not_finite:
        (k % 2 == 0 ? input.measured.q[joint] : input.measured.dq[joint]) =
            k % 4 < 2 ? double(nan) : double(inf);
        break;
      case Reason::state_out_of_range:
        if (k % 2 == 0)
          input.measured.q[joint] = random.uniform(8, 5000);
        else
          input.measured.dq[joint] = -random.uniform(50, 5000);
        break;
      case Reason::state_stale:
        input.measured.time -= (k + 1) * s_.period;
        break;
      case Reason::time_backwards:
        input.now -= 1s * (1 + random.index(1000));
        break;
      case Reason::interval_empty:
        now -= s_.period;
        input.now = input.measured.time = now;
        break;
      case Reason::interval_too_long:
        now += 100ms + 1ms * random.index(5000);
        input.now = input.measured.time = sample.time = now;
        break;
      case Reason::packets_lost:
      case Reason::budget_overrun:
        input.observed = reason;
        break;
      case Reason::sample_not_finite:
        (k % 2 == 0 ? sample.force[1] : sample.temperature) = nan;
        break;
      case Reason::sample_out_of_range:
        (k % 2 == 0 ? sample.force[0] : sample.proximity) = k % 4 < 2 ? 1.5f : -0.1f;
        break;
      case Reason::sample_unknown:
        sample.cell = 100000;
        break;
      case Reason::sample_stale:
        sample.time -= 11s;
        break;
      case Reason::contact_slowed:
        Skills::torque_added = 150;  // the arm gets fast
        break;
      case Reason::contact_force:
        hard(0.9f);
        break;
      case Reason::contact_power: {
        hard(0.2f);
        double n = 0;
        for (const double x : skin_torque) n += x * x;
        if (n > 0)
          for (std::size_t i = 0; i < 6; ++i) input.measured.dq[i] = -20 * skin_torque[i] / std::sqrt(n);
        break;
      }
      default:
        break;
    }
  }

  /// Checks limits, steps, and that all numbers are finite.
  void check_limits(const JointCommand<6>& last, const JointCommand<6>& c, Nanoseconds now, Injected& sum) {
    const double dt = std::min(seconds<double>(now - last.time), 5 * 0.008);
    bool good = c.valid;
    double step = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      const auto finite = [](double x) { return x - x == 0; };
      good &=
          finite(c.position[i]) && finite(c.velocity[i]) && finite(c.acceleration[i]) && finite(c.torque[i]);
      if (torque) {
        good &= std::abs(c.torque[i]) <= limits_.torque()[i];
        step = std::max(step, std::abs(c.torque[i] - last.torque[i]) / (50 * limits_.torque()[i] * dt));
        continue;
      }
      const double u = c.velocity[i], a = limits_.acceleration()[i], v = limits_.velocity()[i];
      good &= std::abs(u) <= v * (1 + 1e-9);
      if (I == Interface::position)
        good &= c.position[i] >= limits_.lower()[i] && c.position[i] <= limits_.upper()[i];
      step = std::max(step, std::abs(u - last.velocity[i]) / (a * dt));
      if (I == Interface::position)
        step = std::max(step, std::abs(c.position[i] - last.position[i]) / (v * dt));
    }
    good &= step <= 1 + 1e-9;
    sum.worst_step = std::max(sum.worst_step, step);
    sum.broken += !good;
  }

  /// Whether every joint brakes with the acceleration limit.
  [[nodiscard]] bool brakes(const JointCommand<6>& last, const JointCommand<6>& c, Nanoseconds now) const {
    const double dt = now > last.time ? std::min(seconds<double>(now - last.time), 0.04) : 0.008;
    for (std::size_t i = 0; i < 6; ++i) {
      const double rest = std::max(0.0, std::abs(last.velocity[i]) - limits_.acceleration()[i] * dt);
      if (std::abs(c.velocity[i]) > rest * (1 + 1e-9) + 1e-12) return false;
    }
    return true;
  }
  [[nodiscard]] bool at_rest(const JointCommand<6>& c, bool by_now, int since, const State<6>& state) const {
    if (torque) return near_fallback(c, since, state);
    double fastest = 0;
    for (const double u : c.velocity) fastest = std::max(fastest, std::abs(u));
    return !by_now || fastest == 0;
  }
  /// Whether the torque is gravity compensation, with or without the damping of a robot that stops; of one that
  /// stopped 15 loop delays ago, with what holds it, a fifth of each limit at most.
  /// @param since  cycles since the fault began.
  [[nodiscard]] bool near_fallback(const JointCommand<6>& c, int since, const State<6>& state) const {
    const auto g = gravity_torque(ur5::Model{}, state.q);
    const auto mass = mass_matrix(ur5::Model{}, state.q);
    const double late = seconds<double>(s_.delay + s_.lag + 3 * s_.period / 2), time = late / 0.3;
    bool held = since * seconds<double>(s_.period) > 15 * late;
    auto damped = g;
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j) damped[i] -= mass(i, j) * state.dq[j] / time;
    damped = limits_.within(damped, state.dq);
    double off = 0, off_damped = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      off = std::max(off, std::abs(c.torque[i] - g[i]));
      const double by = std::abs(c.torque[i] - damped[i]);
      off_damped = std::max(off_damped, by);
      held = held && by <= 0.2 * limits_.torque()[i] * (1 + 1e-9);
    }
    return off <= 1e-9 || off_damped <= 1e-9 || held;
  }

  SceneSettings s_;
  JointLimits<6> limits_ = ur5_test_limits<double>();
  Scene scene_ = faulty_scene<I>();
  std::unique_ptr<typename Scene::Memory> memory_ = std::make_unique<typename Scene::Memory>(),
                                          twin_ = std::make_unique<typename Scene::Memory>();
};

}  // namespace skinctl::testing
