// The faults of the table `faults`, each put into running scenes, and what must hold whatever is put in.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "skinctl/resolver/torque_resolver.hpp"
#include "skinctl/safety/faults.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/scene.hpp"

namespace skinctl::test {

/// A resolver whose commands can be spoilt on their way to the guard.
template <class R>
struct Spoilt : R {
  explicit Spoilt(const R& r) : R(r) {}
  enum class How { not_at_all, nan, infinity, none, leap, end };
  static inline How how = How::not_at_all;

  template <class L, class Touch>
  auto step(typename R::Memory& m, const L& law, typename L::Memory& law_memory,
            const State<R::joints, typename R::scalar>& measured, const Interval& interval,
            std::span<const Touch> touches) const noexcept {
    using T = typename R::scalar;
    auto out = R::step(m, law, law_memory, measured, interval, touches);
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

/// A law that gives what it is told to.
struct Spoiler : Composable {
  static inline double torque_given = 0;
  struct Memory {};
  static constexpr Needs needs{};
  static constexpr Role role = Role::reactive;
  static constexpr const char* name = "spoiler";
  template <class K>
  [[nodiscard]] Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  [[nodiscard]] auto torque(const Memory&, const K&) const noexcept {
    return JointTorque<K::joints, typename K::scalar>::constant(typename K::scalar(torque_given));
  }
  template <class K>
  [[nodiscard]] Memory advance(const Memory& m, const K&, typename K::scalar, Opposition) const noexcept {
    return m;
  }
};

template <Interface I>
using Robot = Resolver<I, ur5::Model, double, SemiImplicitEuler>;  // the least to compile

/// A scene that faults are put into: skin on a UR5, contact limits if it moves. Numbers of the test.
template <Interface I>
auto faulty_scene() {
  const SceneSettings s;
  const auto limits = ur5_test_limits<double>();
  auto c = resolver_configuration<I, double>(s);
  if (I == Interface::torque) c.shape = {};
  GuardConfiguration<6> g{.limits = limits, .period = s.period};
  SkinSettings skin;
  skin.max_age = 10_s;
  const Spoilt robot{Robot<I>(ur5::Model{}, c)};
  const auto law = SkinJointControl{} + GravityControl{} + Spoiler{};
  const auto cells = ur5_skin<260>({.force = s.force_gain}, skin);
  if constexpr (I == Interface::torque) {
    return Cycle(robot, law, cells, Guard<I, 6>(g));
  } else {
    LinkContact<2> contact{
        .region = {.force = 500, .blow = 510, .first = 10, .stiffness = 1e5, .mass = 4, .power = 1000},
        .reach = 0.5,
        .reaction = 0.02};
    contact.newton = 10;
    return Cycle(robot, law, cells, Guard<I, 6>(g),
                 make_governor(limits, contact_limits(ur5::Model{}, contact)));
  }
}

/// How the runs of one fault went.
struct Injected {
  int runs = 0, reported = 0, reacted = 0, came_back = 0;
  int broken = 0;         ///< commands beyond a limit, not finite, or further than the step bound
  double worst_step = 0;  ///< in units of what a cycle may change
  std::string first_bad;  ///< what went wrong first, in words
};

/// One scene, and runs of it.
template <Interface I>
class FaultInjection {
 public:
  using Scene = decltype(faulty_scene<I>());
  static constexpr bool torque = I == Interface::torque;

  /// Whether the fault can be put in at this interface.
  static bool possible(const Fault& f) {
    if (torque && f.torque == Reaction::none) return false;
    if (I == Interface::velocity && f.reason == Reason::outside_limits) return false;
    return true;
  }

  /// One run: a pushed arm, the fault from a random instant on for a random time, and what comes after.
  void run(const Fault& f, oracle::Random& random, Injected& sum) {
    ++sum.runs;
    const Reaction reaction = torque ? f.torque : f.motion;
    const bool latches = f.way_back == WayBack::on_request;
    const int from = 20 + random.index(60), lasts = f.reason == Reason::state_stale ? 60
                                                    : f.reason == Reason::contact_slowed
                                                        ? 40
                                                        : 6 + random.index(20);
    const int over = from + lasts, resumed = over + 25, end = over + 90;
    auto& how = Spoilt<Robot<I>>::how;
    using How = typename std::remove_reference_t<decltype(how)>;
    auto q = home_position();
    for (auto& x : q) x += random.uniform(-0.2, 0.2);
    StiffJoints<> robot(q, s_.delay, s_.lag);
    scene_.start(*memory_, robot.state());
    auto last = memory_->guard.command;
    bool reported = false, reacted = true, back = true, awaited = false;
    JointTorque<6> skin_torque{};
    Nanoseconds now = 0;
    const double pushes = random.uniform(0.02, 0.1);
    constexpr auto& cells = ur5::skin_cells<260>;
    const auto cell = static_cast<std::uint32_t>(1 + cells[0] + cells[1]) +
                      static_cast<std::uint32_t>(random.index(static_cast<int>(cells[2])));
    for (int k = 0; k < end; ++k) {
      const bool faulty = k >= from && k < over;
      now += s_.period;
      const State<6> state = torque ? robot.state() : robot.run_to(now);
      typename Scene::Input input;
      input.now = now;
      input.measured = state;
      input.measured.time = now;
      if (!torque) input.measured.dq = last.velocity;  // those of the joints' small steps are all spikes
      const bool pushed = (k / 25) % 2 == 0 && f.reason != Reason::contact_slowed;
      const auto f3 = static_cast<float>(pushed ? pushes : 0);
      CellSample sample{.time = now - 1_ms, .cell = cell, .force = {f3, f3, f3}};
      input.samples = std::span(&sample, 1);
      how = How::not_at_all;
      Spoiler::torque_given = 0;
      if (faulty) inject(f.reason, input, sample, k - from, now, random, skin_torque);
      if (k == resumed) input.request = Request::resume;
      const auto out = scene_.step(*memory_, input);
      how = How::not_at_all;
      Spoiler::torque_given = 0;
      skin_torque = out.shares[0];
      if (input.now > last.time) check_limits(last, out.command, input.now, sum);

      const bool here = out.status.has(f.reason);
      // A blocked virtual robot does not listen to its laws.
      const bool deaf = f.finder == Finder::resolver && out.status.has(Reason::blocked);
      reported |= (here || deaf) && faulty;
      const bool waits = out.status.has(Reason::consent_awaited);
      // The resolver says `state_stale` earlier, and brakes its own way.
      if (here && faulty && f.finder != Finder::skin && (f.reason != Reason::state_stale || k - from > 27))
        reacted &= reacts(reaction, last, out.command, input.now, k - from, state);
      if (latches && k > over && k < resumed) reacted &= waits && at_rest(out.command, k > over + 23, state);
      if (!latches) awaited |= waits;
      if (k > resumed + 1) back &= !waits;
      if (k == end - 1) back &= !out.status.has(f.reason) || f.reason == Reason::sample_stale;
      last = out.command;
      robot.command(now, out.command.position);
    }
    sum.reported += reported;
    sum.reacted += reported && reacted && !awaited;
    sum.came_back += back;
    if ((!reported || !reacted || awaited || !back) && sum.first_bad.empty())
      sum.first_bad = std::string(reported ? "" : "not reported ") + (reacted ? "" : "reacted otherwise ") +
                      (awaited ? "asked for consent " : "") + (back ? "" : "did not come back");
  }

 private:
  void inject(Reason reason, typename Scene::Input& input, CellSample& sample, int k, Nanoseconds& now,
              oracle::Random& random, const JointTorque<6>& skin_torque) {
    auto& how = Spoilt<Robot<I>>::how;
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
        Spoiler::torque_given = 1e6;
        break;
      case Reason::torque_not_finite:
        Spoiler::torque_given = k % 2 == 0 ? double(nan) : double(inf);
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
        input.now -= 1_s * (1 + random.index(1000));
        break;
      case Reason::interval_empty:
        now -= s_.period;
        input.now = input.measured.time = now;
        break;
      case Reason::interval_too_long:
        now += 100_ms + 1_ms * random.index(5000);
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
        sample.time -= 11_s;
        break;
      case Reason::contact_slowed:
        Spoiler::torque_given = 150;  // the arm gets fast
        break;
      case Reason::contact_force:
        hard(0.9f);
        break;
      case Reason::contact_power: {
        hard(0.4f);
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

  /// Limits, steps, numbers.
  void check_limits(const JointCommand<6>& last, const JointCommand<6>& c, Nanoseconds now, Injected& sum) {
    const double dt = std::min(1e-9 * static_cast<double>(now - last.time), 5 * 0.008);
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

  /// Whether the command is what the table says.
  bool reacts(Reaction reaction, const JointCommand<6>& last, const JointCommand<6>& c, Nanoseconds now,
              int k, const State<6>& state) const {
    if (reaction == Reaction::hold) return c.position == last.position && c.torque == last.torque;
    if (torque) {
      if ((reaction != Reaction::fade && reaction != Reaction::stop) || k < 5) return true;
      return near_fallback(c, state);
    }
    if (reaction != Reaction::brake && reaction != Reaction::stop) return true;
    const double dt = now > last.time ? std::min(1e-9 * static_cast<double>(now - last.time), 0.04) : 0.008;
    for (std::size_t i = 0; i < 6; ++i) {
      const double rest = std::max(0.0, std::abs(last.velocity[i]) - limits_.acceleration()[i] * dt);
      if (std::abs(c.velocity[i]) > rest * (1 + 1e-9) + 1e-12) return false;
    }
    return true;
  }
  bool at_rest(const JointCommand<6>& c, bool by_now, const State<6>& state) const {
    if (torque) return near_fallback(c, state);
    double fastest = 0;
    for (const double u : c.velocity) fastest = std::max(fastest, std::abs(u));
    return !by_now || fastest == 0;
  }
  static bool near_fallback(const JointCommand<6>& c, const State<6>& state) {
    const auto g = gravity_torque(ur5::Model{}, state.q);
    for (std::size_t i = 0; i < 6; ++i)
      if (std::abs(c.torque[i] - g[i]) > 1e-9) return false;
    return true;
  }

  SceneSettings s_;
  JointLimits<6> limits_ = ur5_test_limits<double>();
  Scene scene_ = faulty_scene<I>();
  std::unique_ptr<typename Scene::Memory> memory_ = std::make_unique<typename Scene::Memory>();
};

}  // namespace skinctl::test
