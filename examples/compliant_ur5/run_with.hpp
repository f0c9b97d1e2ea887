// One run of the main job by one interface and one sense; a file for each sense says which it has.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "examples/compliant_ur5/connection.hpp"
#include "examples/compliant_ur5/delay_judge.hpp"
#include "examples/compliant_ur5/felt.hpp"
#include "examples/compliant_ur5/following_judge.hpp"
#include "examples/compliant_ur5/job_driver.hpp"
#include "examples/compliant_ur5/kept_clear.hpp"
#include "examples/compliant_ur5/live.hpp"
#include "examples/compliant_ur5/recorder.hpp"
#include "examples/compliant_ur5/results.hpp"
#include "examples/compliant_ur5/run.hpp"
#include "examples/compliant_ur5/scene.hpp"
#include "examples/compliant_ur5/summary.hpp"
#include "skinctl/hardware/loop.hpp"
#include "skinctl/recording/recorded_run.hpp"
#include "skinctl/testing/allocation_guard.hpp"

namespace compliant_ur5 {
namespace running {

/// What was found of a sense without cells while it ran.
template <class Memory>
void add_facts(const SenseReader<Sense::wrist>& reader, const Memory& m, RunLog& log) {
  const auto size = [](const auto& x) { return std::hypot(x[0], x[1], x[2]); };
  log.result.push_back({"bias of the force at the start", text("%.1f N", size(reader.rest()))});
  log.result.push_back({"bias of the force found while running", text("%.1f N", size(m.watch.bias))});
}
template <class Memory>
void add_facts(const SenseReader<Sense::motors>&, const Memory& m, RunLog& log) {
  double most = 0;
  for (const double x : m.watch.bias) most = std::max(most, std::abs(x));
  log.result.push_back({"largest bias found while running", text("%.1f N m", most)});
}

/// Whether the arm does what it is told.
template <Interface I>
auto following_judge(const Settings& s) {
  if constexpr (I == Interface::torque) {
    return StandingJudge<6>(JointTorque<6>(s.torque.most_friction));
  } else {
    return FollowingJudge<6>(configuration<I>(s));
  }
}

template <Interface I, Sense S, bool Clear>
class Job {
  static constexpr bool by_torque = I == Interface::torque, by_skin = S == Sense::skin;
  static constexpr double touching = 1;            ///< least force of a touch, under which an end waits [N]
  static constexpr Nanoseconds most_touched = 2s;  ///< for so long, since the arm was found late
  static constexpr Nanoseconds braking = 500ms;    ///< from an end until the robot is told to stop
  using Scene = decltype(make_watched_scene<I, S, Clear>(std::declval<const Settings&>()));
  using Input = typename Scene::Input;
  using Output = typename Scene::Output;
  using Memory = typename Scene::Memory;

 public:
  /// Connects. Throws `skinctl::ConfigurationError` and `adapters::ConnectionError`.
  /// @param s  which lives longer; its delay has the network's in it.
  Job(const Settings& s, RunLog& log)
      : s_(s),
        log_(log),
        scene_(make_watched_scene<I, S, Clear>(s)),
        clear_(s),
        felt_mass_(felt_mass_of(s)),
        connection_(s, SenseReader<S>::ask, log),
        reader_(s, connection_.driver),
        robot_{connection_.driver, reader_, by_torque},
        observer_(by_skin ? observed_cells(skin_patches(s)) : std::vector<ObservedCell>{},
                  s.newtons_per_reading, s.rest_reading),
        live_(s, weight_ranges, connection_.simulation.get(), cells_of<by_skin>(scene_)),
        recording_(s, live_.consumers()),
        judge_(following_judge<I>(s)),
        delay_(1 / s.rate, std::max(s.network_delay, 0.0),
               by_torque ? s.torque.delay_margin : s.control.delay_margin,
               by_torque ? DelayJudge::by_torque : DelayJudge::beyond_time_out),
        progress_(s.quiet),
        cells_{connection_.receiver, connection_.driver} {
    if (felt_mass_) log.scenario.push_back({"felt mass, at least", text("%.1f kg", *felt_mass_)});
    log.entries.reserve(round());
    for (std::size_t i = 0; i < 6; ++i) {
      log.velocity_limit[i] = limit_.velocity()[i];
      log.acceleration_limit[i] = limit_.acceleration()[i];
    }
    if (s.hand && s.hand->palm_gain > 0 && s.hand->reading != nullptr) {
      cells_.palm = s.hand->reading;
      cells_.both.resize(16385);  // most of one poll, and one
    }
  }

  Outcome run(const std::atomic<bool>& stop) {
    if constexpr (S == Sense::wrist) {
      try {
        tare<I>(robot_, s_.rate);
      } catch (const ConfigurationError& e) {
        return not_tared(e.what(), log_);
      }
    }
    const LoopReport<Scene> report = loop(stop);
    progress_.clear();
    const RunFigures figures = figures_of(report);
    tell(report);
    tell_figures(s_, figures, connection_.driver, log_);
    tell_sense();
    clear_.report(log_);
    recording_.finish(log_);
    print(s_, log_);
    if constexpr (by_skin) {
      if (found_.ending == Ending::finished && report.ended == LoopEnd::finished && !heard(*memory_))
        found_ = {Ending::skin_unheard, "the arm did not move"};
    }
    const Outcome outcome = tell_end(s_, found_, figures, connection_.driver, log_);
    live_.end(log_.words);
    return outcome;
  }

 private:
  /// Of a run without an end the report shows the first round of the task [cycles].
  [[nodiscard]] std::uint64_t round() const noexcept {
    return s_.cycles != 0 ? s_.cycles : static_cast<std::uint64_t>(s_.duration * s_.rate);
  }
  /// Since the first cycle [s].
  [[nodiscard]] double time_of(const Input& input) const noexcept {
    return seconds<double>(input.now - first_);
  }
  /// All patches of the skin have been heard.
  [[nodiscard]] bool heard(const Memory& m) const noexcept
    requires by_skin
  {
    return scene_.governor().template memory<SkinWatch>(m.governor).heard;
  }

  static std::optional<double> felt_mass_of(const Settings& s) {
    if constexpr (by_torque) {
      return {};
    } else {
      return felt_mass<I, S>(s);
    }
  }

  LoopReport<Scene> loop(const std::atomic<bool>& stop) {
    LoopOptions options;
    options.cycles = s_.until_stopped ? 0 : round();
    options.period = nanoseconds(1 / s_.rate);
    options.stop = &stop;
    const auto run = [&](auto& source) {
      return run_loop(
          scene_, *memory_, robot_, source, options,
          [this](Input& input, const Memory& m) { return before(input, m); },
          [this](const Input& input, const Output& out, const Stopwatch&) { after(input, out); }, recording_);
    };
    if constexpr (by_skin) {
      return run(cells_);
    } else {
      NoSkin none;
      return run(none);
    }
  }

  /// What the cycle is asked for: to stop, goals and weights. False ends the run.
  bool before(Input& input, const Memory& m) {
    if (first_ == 0ns) first_ = input.now;
    const double t = time_of(input);
    clear_.look(scene_, m, input);
    input.request = live_.take();
    if (found_.ending != Ending::finished) {
      if (input.now - braking_since_ > braking) return false;
    } else if (found_ = why_it_ends(t, input, m); found_.ending != Ending::finished) {
      input.request = CycleRequest::stop;
      braking_since_ = input.now;
    }
    ask_for_goal(t, input);
    ask_for_weights(input);
    return true;
  }

  Found why_it_ends(double t, const Input& input, const Memory& m) {
    Found found = of_sense(t, input, m);
    if (found.ending == Ending::finished) found = of_following();
    if (robot_.heard == Heard::state) delay_.cycle(t, 1 / s_.rate, connection_.driver.round_trip());
    if (found.ending == Ending::finished && delay_.late())
      found = {Ending::distant,
               text("%.0f ms", 1e3 * delay_.trip()) + text(", at the start %.0f ms", 1e3 * delay_.usual())};
    const bool late = found.ending == Ending::late || found.ending == Ending::distant;
    return late && gives_way_longer(input.now) ? Found{} : found;
  }
  /// The scene stops by itself where too little of the skin reports; the job ends then, and says why. What
  /// others send to the skin's port is dropped, and so is what the skin itself garbles: then it is silent.
  Found of_sense(double t, const Input& input, const Memory& m) const {
    if constexpr (by_skin) {
      if (!heard(m) && t > s_.control.skin_patience) return {Ending::skin_unheard, cells_in_words(m)};
      if (!last_status_.has(Reason::skin_stopped)) return {};
      const bool silent = connection_.receiver.silent_for(input.now) > 100ms;
      return {silent ? Ending::skin_silent : Ending::skin_deaf, cells_in_words(m)};
    } else {
      return reader_.silent_for() > 0.1 ? Found{Ending::sense_silent, {}} : Found{};
    }
  }
  [[nodiscard]] std::string cells_in_words(const Memory& m) const {
    const auto& receiver = connection_.receiver;
    const std::string refused = adapters::skin::refusals(receiver.statistics()), frozen = receiver.frozen(),
                      leaps = receiver.leaps();
    return in_words(scene_.skin(), m.skin) + (frozen.empty() ? "" : "; " + frozen) +
           (leaps.empty() ? "" : "; " + leaps) + (refused.empty() ? "" : "; datagrams refused: " + refused);
  }
  Found of_following() const {
    if (const auto joint = judge_.stuck_joint(); joint != 0)
      return {Ending::stuck, "joint " + std::to_string(joint) + slowed()};
    if (judge_.late()) return {Ending::late, text("by %.0f ms", 1e3 * judge_.following().lag) + slowed()};
    return {};
  }
  [[nodiscard]] std::string slowed() const {
    const double slider = connection_.driver.report().slider;
    if (!(slider < 0.99)) return {};
    return text("; the speed slider stands at %.0f %%: move it to 100 %%", 100 * slider);
  }
  /// A stop is stiff: while something touches the arm, it gives way a little longer, though it does so late.
  bool gives_way_longer(Nanoseconds now) {
    if (late_since_ == 0ns) late_since_ = now;
    return observer_.force() > touching && now - late_since_ < most_touched;
  }

  void ask_for_goal(double t, Input& input) {
    if (s_.until_stopped && connection_.simulation && next_goal_ == s_.task.size() &&
        t - round_began_ >= s_.duration)
      next_goal_ = 0, round_began_ = t;
    if (next_goal_ == s_.task.size() || t - round_began_ < s_.task[next_goal_].at) return;
    const auto& goal = s_.task[next_goal_++];
    input.goal =
        typename Scene::Goal{.goal = JointGoal<6>{JointPosition<6>(goal.q), nanoseconds(goal.duration)}};
  }
  void ask_for_weights(Input& input) {
    weights_.fill(1);
    if (!live_.take(weights_)) return;
    if (!input.goal) input.goal.emplace();
    input.goal->weights.emplace().of = weights_;
  }

  void after(const Input& input, const Output& out) {
    const double t = time_of(input);
    const auto& reached = Scene::law_type::template memory<0>(memory_->law);
    const auto target = std::get<0>(scene_.law().sum().laws()).reference(reached).q_d;
    observe_touch(t, input, target);
    const double passed = last_time_ == 0ns ? 0 : seconds<double>(input.now - last_time_);
    judge_.cycle(t, passed, memory_->robot, out.status, observer_.force(), target);
    last_status_ = out.status;
    clear_.note(input.measured.q, out.status);
    if constexpr (by_skin) {
      if (!heard_ && heard(*memory_)) heard_ = true, log_.began = t;
      live_.look(scene_, *memory_);
    }
    LogEntry entry = entry_of(t, input, out, target);
    if constexpr (by_torque) {
      for (std::size_t i = 0; i < 6; ++i) entry.shares[2][i] = static_cast<float>(reached.friction[i]);
    }
    if (log_.entries.size() < log_.entries.capacity()) log_.entries.push_back(entry);
    if (progress_.due(t))
      progress_.show("%5.0f s  force %5.1f N  deflection %6.3f rad  touches %zu", t, observer_.force(),
                     entry.deflection, observer_.touches().size());
  }
  void observe_touch(double t, const Input& input, const JointPosition<6>& target) {
    if constexpr (by_skin) {
      observer_.cycle(t, input.samples, input.measured.q, target);
    } else {
      observe(observer_, t, reader_, memory_->skin, input.measured.q, target);
      if (memory_->skin.watch.tares > tares_) tares_ = memory_->skin.watch.tares, tared_at_ = t;
    }
  }
  /// The cycle for the plots; its largest values are kept.
  LogEntry entry_of(double t, const Input& input, const Output& out, const JointPosition<6>& target) {
    const JointVelocity<6>& velocity = by_torque ? input.measured.dq : out.planned.velocity;
    const double dt = last_time_ == 0ns ? 0 : seconds<double>(out.command.time - last_time_);
    LogEntry entry;
    entry.time = t;
    entry.force = observer_.force();
    entry.status = out.status.bits();
    for (std::size_t i = 0; i < 6; ++i) {
      entry.q[i] = static_cast<float>(input.measured.q[i]);
      entry.target[i] = static_cast<float>(target[i]);
      entry.velocity[i] = static_cast<float>(velocity[i]);
      entry.deflection = std::max(entry.deflection, std::abs(input.measured.q[i] - target[i]));
      for (std::size_t k = 0; k < out.shares.size(); ++k)
        entry.shares[k][i] = static_cast<float>(out.shares[k][i]);
      largest_.velocity = std::max(largest_.velocity, std::abs(velocity[i]) / limit_.velocity()[i]);
      if constexpr (by_torque) {
        largest_.torque = std::max(largest_.torque, std::abs(out.command.torque[i]) / limit_.torque()[i]);
      } else if (dt > 0) {
        const double a = (velocity[i] - last_velocity_[i]) / dt;
        entry.acceleration[i] = static_cast<float>(a);
        largest_.acceleration = std::max(largest_.acceleration, std::abs(a) / limit_.acceleration()[i]);
      }
    }
    last_velocity_ = velocity;
    last_time_ = out.command.time;
    return entry;
  }

  /// Times and parts of a cycle.
  void tell(const LoopReport<Scene>& report) {
    fill_times(report, log_);
    log_.cycle.period = 1 / s_.rate;
    log_.cycle.substeps =
        static_cast<unsigned>(std::lround(1 / (s_.rate * scene_.resolver().planned_step())));
    if (report.cycles == 0) return;
    log_.cycle.repeated = 1001;
    log_.cycle.repeated_median = repeated_median(scene_, report, log_.cycle.repeated);
  }
  RunFigures figures_of(const LoopReport<Scene>& report) {
    RunFigures f{.ended = report.ended,
                 .cycles = report.cycles,
                 .samples = report.samples,
                 .missed = report.missed,
                 .silent = report.silent,
                 .allocations = testing::unexpected_real_time_allocations(),
                 .largest = largest_,
                 .lag = {},
                 .load = seconds<double>(report.load.max()),
                 // The robot comes to rest by its own program; the simulation knows what its fingers felt.
                 .behind = tell_touches(observer_, connection_, S != Sense::motors, log_)};
    if (judge_.following().lag_deviation < judge_.uncertain) f.lag = judge_.following().lag;
    return f;
  }
  void tell_sense() {
    if constexpr (by_skin) {
      log_.felt = felt(scene_, *memory_);
      tell_skin(connection_.receiver, in_words(scene_.skin(), memory_->skin), log_);
    } else {
      add_facts(reader_, memory_->skin, log_);
      log_.result.push_back(
          {"pushes without life, taken for rest",
           std::to_string(tares_) + (tares_ > 0 ? text(", the last at %.1f s", tared_at_) : "")});
    }
  }

  inline static const std::vector<adapters::live::WeightRange> weight_ranges = {
      {1, WeightLimits::least_task, WeightLimits::most}, {1, WeightLimits::least_skin, WeightLimits::most}};

  const Settings& s_;
  RunLog& log_;
  const Scene scene_;
  KeptClear<Clear> clear_;
  const std::optional<double> felt_mass_;  ///< by position or velocity [kg]
  Connection connection_;                  ///< after what takes time: its robot waits for commands
  SenseReader<S> reader_;
  JobDriver<S> robot_;
  TouchObserver observer_;
  const std::unique_ptr<Memory> memory_ = std::make_unique<Memory>();
  LivePage<Scene> live_;
  JobRecorder<Scene> recording_;
  const JointLimits<6> limit_ = limits(s_);
  decltype(following_judge<I>(std::declval<const Settings&>())) judge_;
  DelayJudge delay_;
  examples::job::Progress progress_;
  SkinOnRobotClock cells_;
  std::array<double, Scene::law_type::terms> weights_{};

  Found found_;
  Nanoseconds first_{}, braking_since_{}, late_since_{};  ///< by the robot's clock; 0: not yet
  std::size_t next_goal_ = 0;                             ///< of the task
  double round_began_ = 0;                                ///< of the task [s]
  std::uint32_t tares_ = 0;                               ///< while running
  double tared_at_ = 0;                                   ///< the last of them [s]
  bool heard_ = false;                                    ///< all patches of the skin
  Status last_status_;
  Largest largest_;
  JointVelocity<6> last_velocity_;
  Nanoseconds last_time_{};  ///< of the last command
};

template <Interface I, Sense S, bool Clear = false>
Outcome run_with(const Settings& given, const std::atomic<bool>& stop, RunLog& log) {
  Settings s = given;
  s.network_delay = network_delay(s, log);
  s.control.delay += s.network_delay;
  return Job<I, S, Clear>(s, log).run(stop);
}

template <Interface I, Sense S, bool Clear = false>
Outcome replay_with(const Settings& given) {
  Settings s = given;
  s.control.delay += std::max(s.network_delay, 0.0);
  const auto scene = make_watched_scene<I, S, Clear>(s);
  const auto result = skinctl::replay(s.replay, scene, run_identity(s));
  if (!result.whole) std::printf("%s was cut: its last second may be missing\n", s.replay.c_str());
  if (result.missing_cycles > 0)
    std::printf("%llu cycles found no room when it was recorded: replayed up to the first of them\n",
                static_cast<unsigned long long>(result.missing_cycles));
  std::printf("replayed %llu cycles: ", static_cast<unsigned long long>(result.cycles));
  std::printf("%s\n", in_words(result).c_str());
  return result.different == 0 ? Outcome::fine : Outcome::broken;
}

/// By its skin.
template <bool Clear>
Outcome run_by_skin(const Settings& settings, const std::atomic<bool>& stop, RunLog& log) {
  switch (settings.interface) {
    case Interface::position:
      return run_with<Interface::position, Sense::skin, Clear>(settings, stop, log);
    case Interface::velocity:
      return run_with<Interface::velocity, Sense::skin, Clear>(settings, stop, log);
    default:
      return run_with<Interface::torque, Sense::skin, Clear>(settings, stop, log);
  }
}
template <bool Clear>
Outcome replay_by_skin(const Settings& settings) {
  switch (settings.interface) {
    case Interface::position:
      return replay_with<Interface::position, Sense::skin, Clear>(settings);
    case Interface::velocity:
      return replay_with<Interface::velocity, Sense::skin, Clear>(settings);
    default:
      return replay_with<Interface::torque, Sense::skin, Clear>(settings);
  }
}
// In a file of its own.
extern template Outcome run_by_skin<true>(const Settings&, const std::atomic<bool>&, RunLog&);
extern template Outcome replay_by_skin<true>(const Settings&);

}  // namespace running

/// By a sense without cells, whose file has it: by position or velocity.
template <Sense S>
Outcome run_by(const Settings& settings, const std::atomic<bool>& stop, RunLog& log) {
  using namespace running;
  return settings.interface == Interface::position ? run_with<Interface::position, S>(settings, stop, log)
                                                   : run_with<Interface::velocity, S>(settings, stop, log);
}
template <Sense S>
Outcome replay_by(const Settings& settings) {
  using namespace running;
  return settings.interface == Interface::position ? replay_with<Interface::position, S>(settings)
                                                   : replay_with<Interface::velocity, S>(settings);
}
extern template Outcome run_by<Sense::wrist>(const Settings&, const std::atomic<bool>&, RunLog&);
extern template Outcome run_by<Sense::motors>(const Settings&, const std::atomic<bool>&, RunLog&);
extern template Outcome replay_by<Sense::wrist>(const Settings&);
extern template Outcome replay_by<Sense::motors>(const Settings&);

}  // namespace compliant_ur5
