// One run of the main job by one interface and one sense; a file for each sense says which it has.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

#include "examples/adapters/allegro/palm.hpp"
#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/ur5/driver.hpp"
#include "examples/adapters/ur5/round_trip.hpp"
#include "examples/compliant_ur5/delay_judge.hpp"
#include "examples/compliant_ur5/endings.hpp"
#include "examples/compliant_ur5/following_judge.hpp"
#include "examples/compliant_ur5/live.hpp"
#include "examples/compliant_ur5/recorder.hpp"
#include "examples/compliant_ur5/run.hpp"
#include "examples/compliant_ur5/scene.hpp"
#include "examples/compliant_ur5/sense_reader.hpp"
#include "examples/compliant_ur5/simulation.hpp"
#include "examples/compliant_ur5/summary.hpp"
#include "examples/compliant_ur5/touch_observer.hpp"
#include "examples/support/text.hpp"
#include "skinctl/hardware/loop.hpp"
#include "skinctl/hardware/scheduling.hpp"
#include "skinctl/recording/recorded_run.hpp"
#include "skinctl/testing/allocation_guard.hpp"

namespace compliant_ur5 {
namespace running {

using namespace skinctl;

/// How many cells report, in words.
inline std::string in_words(const Coverage& c) {
  return std::to_string(c.usable) + " of " + std::to_string(c.cells);
}
/// The same with what is missing, link by link: "forearm: 25 of 67 cells do not count, 5 places feel nothing
/// (cells 165, ...)".
template <class Skin>
std::string in_words(const Skin& skin, const typename Skin::Memory& memory) {
  constexpr std::size_t most_named = 5;
  std::string out = in_words(skin.coverage(memory)) + " cells report";
  for (std::size_t link = 0; link < 6; ++link) {
    std::size_t cells = 0, missing = 0, blind = 0;
    std::string named;
    for (std::size_t i = 0; i < skin.table().size(); ++i) {
      if (skin.table()[i].link != link) continue;
      ++cells, missing += skin.faults(memory, i).has(CellFault::unheard) || skin.mask(memory, i) > 0.5f;
      if (skin.noticed(memory, i) < std::numeric_limits<double>::infinity()) continue;
      if (++blind <= most_named) named += (blind > 1 ? ", " : "") + std::to_string(skin.table()[i].id);
    }
    if (missing == 0 && blind == 0) continue;
    out += "; " + std::string(link_names[link]) + ": ";
    if (missing > 0)
      out += std::to_string(missing) + " of " + std::to_string(cells) + " cells do not count" +
             (blind > 0 ? ", " : "");
    if (blind > 0)
      out += std::to_string(blind) + (blind > 1 ? " places feel" : " place feels") + " nothing (cells " +
             named + (blind > most_named ? ", ...)" : ")");
  }
  return out;
}

/// How well each place feels, and how fast it may lead.
template <class Scene>
std::vector<FeltPlace> felt(const Scene& scene, const typename Scene::Memory& memory) {
  const auto& limit = scene.governor().template get<FeltPlacesLimit>();
  const auto& places = limit.settings().places;
  std::vector<FeltPlace> out;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto& [link, patch, at, n] = places[i];
    const double noticed = limit.settings().newtons * scene.skin().noticed(memory.skin, i);
    out.push_back({scene.skin().table()[i].id,
                   link,
                   {at.x, at.y, at.z},
                   {n.x, n.y, n.z},
                   noticed,
                   limit.speed(noticed)});
  }
  return out;
}

/// The ids of the scene's cells, in the order of its skin; none where the arm feels by other senses.
template <bool BySkin, class Scene>
std::vector<std::uint32_t> cells_of(const Scene& scene) {
  std::vector<std::uint32_t> out;
  if constexpr (BySkin)
    for (std::size_t i = 0; i < scene.skin().table().size(); ++i) out.push_back(scene.skin().table()[i].id);
  return out;
}

/// The receiver as a source of samples on the robot's clock. Of the cycles that a silent robot owes, which
/// run at once, only the last asks for any: the others are of a time before the samples that have come. So is
/// the cycle of a state that is late.
struct SkinOnRobotClock {
  static constexpr Nanoseconds behind = 5ms;  ///< so far the cycle's time may lag
  adapters::skin::Receiver& receiver;
  const adapters::ur5::Driver& driver;
  adapters::allegro::Palm* palm = nullptr;
  std::vector<CellSample> both{};  ///< room for the receiver's and the palm's

  std::span<const CellSample> poll() noexcept {
    const auto now = driver.clock_now();
    if (now - driver.clock() > behind) return {};
    const auto received = receiver.poll(now);
    if (palm == nullptr) return received;
    const std::size_t n = std::min(received.size(), both.size() - 1);
    std::copy_n(received.begin(), n, both.begin());
    const auto felt = palm->take(palm_cell, now);
    if (felt) both[n] = *felt;
    return {both.data(), n + (felt ? 1 : 0)};
  }
};

/// The driver, which sends no torque for a state that nobody knows: it would accelerate. The robot's program
/// brakes and holds.
template <Sense S>
struct JobDriver {
  adapters::ur5::Driver& driver;
  SenseReader<S>& reader;
  bool by_torque = false;
  Heard heard = Heard::state;

  Heard wait(State<6>& state) noexcept { return heard = driver.wait(state); }
  JointPosition<6> told() noexcept { return driver.told(); }
  bool send(const auto& command) noexcept {
    if (by_torque && heard == Heard::silent) return driver.hold();
    return driver.send(command);
  }
  auto wrenches() noexcept
    requires(S == Sense::wrist)
  {
    return reader.read(driver);
  }
  auto motor_torque() noexcept
    requires(S == Sense::motors)
  {
    return reader.read(driver);
  }
  void stop() noexcept { driver.stop(); }
};

/// Takes what the wrist sensor reads in 0.5 s, while the arm is told to stay, for its zero. Throws
/// `skinctl::ConfigurationError` where the readings do not rest; a robot that is lost is found by the loop.
template <Interface I>
void tare(JobDriver<Sense::wrist>& robot, double rate) {
  std::vector<WrenchSample> samples;
  State<6> state;
  for (int k = 0; k < static_cast<int>(0.5 * rate); ++k) {
    if (robot.wait(state) == Heard::lost) return;
    for (const WrenchSample& s : robot.wrenches()) samples.push_back(s);
    bool sent = false;
    if constexpr (I == Interface::position) {
      PositionCommand<6> stay;
      stay.position = robot.told();
      sent = robot.send(stay);
    } else {
      sent = robot.send(VelocityCommand<6>());
    }
    if (!sent) return;
  }
  robot.reader.tare(samples, state.q);
}

/// What an arm that keeps clear looks at before each cycle, and how clear it kept; else nothing.
template <bool Clear>
class KeptClear {
 public:
  explicit KeptClear(const Settings&) {}
  template <class... Any>
  void look(const Any&...) noexcept {}
  template <class... Any>
  void note(const Any&...) noexcept {}
  void report(const RunLog&) const noexcept {}
};
template <>
class KeptClear<true> {
 public:
  explicit KeptClear(const Settings& s) : sight_(s), distance_(s), margin_(s.clear.margin) {}

  template <class Scene>
  void look(const Scene& scene, const typename Scene::Memory& m, typename Scene::Input& input) noexcept {
    input.samples = sight_.foreign(input.measured.q, input.samples);
    input.around = sight_.around(input.measured.q, [&](std::size_t i) {
      return scene.skin().held(m.skin, i).proximity * CellCounts::proximity_unit;
    });
    input.around.time = input.now;
    most_seen_ = std::max(most_seen_, input.around.count);
  }
  void note(const JointPosition<6>& q, Status status) noexcept {
    nearest_ = std::min(nearest_, distance_(q));
    cycles_ += status.has(Reason::clearance_kept);
  }
  void report(RunLog& log) const {
    log.result.push_back({"least distance of links, base and table",
                          examples::text("%.0f mm, declared %.0f mm", 1000 * nearest_, 1000 * margin_)});
    log.result.push_back({"cycles in which it kept clear", std::to_string(cycles_)});
    log.result.push_back({"things seen at once", std::to_string(most_seen_)});
  }

 private:
  Sight sight_;
  OwnDistance distance_;
  double margin_, nearest_ = std::numeric_limits<double>::infinity();
  std::uint32_t most_seen_ = 0;
  std::uint64_t cycles_ = 0;
};

struct Largest {
  double step_velocity = 0, step_acceleration = 0, torque = 0;  ///< in units of their limits
};

inline constexpr const char* in_words(Interface i) {
  return i == Interface::position ? "position" : (i == Interface::velocity ? "velocity" : "torque");
}

/// Nothing has moved.
inline Outcome not_tared(const char* why, RunLog& log) {
  const EndingRow& end = row(Ending::not_tared);
  log.ending = end.name;
  log.words = std::string(end.words) + ": " + why;
  std::fprintf(stderr, "\nstopped: %s (exit code %d: %s)\n", log.words.c_str(), examples::job::code(end.exit),
               examples::job::words(end.exit));
  return end.exit;
}

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

/// What the way to the robot and back takes beyond one cycle, which the declared delay has in it [s].
inline double network_delay(const Settings& s, RunLog& log) {
  if (!s.robot || s.network_delay >= 0) return std::max(s.network_delay, 0.0);
  const auto trip = adapters::ur5::measure_round_trip(*s.robot, s.rtde_port, s.rate, 25);
  const double beyond = std::max(0.0, seconds<double>(trip.controller_median) - 1 / s.rate);
  log.scenario.push_back(
      {"round trip to the controller, median", text("%.2f ms", milliseconds(trip.median))});
  log.scenario.push_back({"beyond one cycle, declared as delay", text("%.1f ms", 1000 * beyond)});
  return beyond;
}

/// Words where this computer did not keep the pace, which then is the cause of what ended the run; else
/// empty. So much is two periods, or the 20 ms after which a UR's program counts a command as missing.
/// @param behind  farthest that the simulated robot was behind the clock [s of its time]; 0 for a real one.
/// @param load    longest time from a state to its command, likewise.
inline std::string too_slow(double behind, double load, double period) {
  const double most = std::max(2 * period, 0.02);
  if (std::max(behind, load) <= most) return {};
  return "; this computer is too slow, or busy with something else: " +
         (behind > load ? text("the simulated robot fell behind the clock by %.0f ms", 1000 * behind)
                        : text("a cycle took %.0f ms", 1000 * load));
}

template <Interface I, Sense S, bool Clear = false>
Outcome run_with(const Settings& given, const std::atomic<bool>& stop, RunLog& log) {
  Settings s = given;
  constexpr bool by_torque = I == Interface::torque;
  s.network_delay = network_delay(s, log);
  s.control.delay += s.network_delay;
  constexpr bool by_skin = S == Sense::skin;
  const auto scene = make_watched_scene<I, S, Clear>(s);
  using Scene = std::remove_cvref_t<decltype(scene)>;
  KeptClear<Clear> clear(s);
  const Nanoseconds period = nanoseconds(1 / s.rate);

  std::optional<adapters::skin::Key> key;
  if (!s.skin_key.empty()) key = adapters::skin::Key::read(s.skin_key);
  adapters::skin::Receiver receiver({.address = s.skin_address,
                                     .port = s.skin_port,
                                     .sender = s.skin_sender,
                                     .key = key,
                                     .noise = force_noise,
                                     .real_time = s.robot || s.speed == 1});
  std::unique_ptr<simulated_ur5::SimulatedUr5> simulation;
  adapters::ur5::DriverConfig config;
  config.rate = s.rate;
  config.interface = I;
  config.rtde_port = s.rtde_port;
  config.script_port = s.script_port;
  config.dashboard_port = s.dashboard_port;
  config.rest_port = s.rest_port;
  config.reverse_port = s.reverse_port;
  config.told_port = s.told_port;
  config.unlock = s.unlock;
  config.echo = true;
  config.give_up = adapters::Timeout(static_cast<int>(std::lround(1000 * s.control.state_patience)));
  if constexpr (by_torque) {
    config.silence = adapters::Timeout(20);  // before the robot's patience
    config.torque.viscous = s.torque.viscous_scale;
    config.torque.coulomb = s.torque.coulomb_scale;
    config.robot_patience = adapters::Timeout(static_cast<int>(std::lround(1000 * s.torque.patience)));
  }
  SenseReader<S>::ask(config);
  config.real_time = s.robot || s.speed == 1;
  if (s.robot) {
    config.host = *s.robot;
  } else {
    simulation = start_simulation(s, receiver.port(), key, log);
    const auto ports = simulation->ports();
    config.rtde_port = ports.rtde;
    config.script_port = ports.secondary;
    config.dashboard_port = ports.dashboard;
    if (s.speed == 0) config.silence = config.give_up = std::chrono::milliseconds(3000);
  }
  if constexpr (!by_torque)
    log.scenario.push_back({"felt mass, at least", text("%.1f kg", felt_mass<I, S>(s))});
  adapters::ur5::Driver driver(config);
  driver.connect();
  if (s.hand && !driver.set_payload(s.hand->mass, s.hand->centre))
    throw adapters::ConnectionError("the robot does not take the payload");
  if (!s.quiet) {
    std::printf("connected to %s, controller %s, %.0f Hz, %s\n",
                s.robot ? s.robot->c_str() : "the simulated UR5", driver.controller().text().c_str(), s.rate,
                in_words(I));
    if (s.speed != 0 || s.robot) std::printf("%s", request_real_time().report.c_str());
  }

  SenseReader<S> reader(s);
  JobDriver<S> robot{driver, reader, by_torque};
  if constexpr (!by_skin) reader.check(driver);
  TouchObserver observer(by_skin ? observed_cells(skin_patches(s)) : std::vector<ObservedCell>{},
                         s.newtons_per_reading, s.rest_reading);
  // Of a run without an end the report shows the first round of the task.
  const std::uint64_t round = s.cycles != 0 ? s.cycles : static_cast<std::uint64_t>(s.duration * s.rate);
  log.entries.reserve(round);
  const auto memory = std::make_unique<typename Scene::Memory>();
  using Weight = WeightLimits;
  LivePage<Scene> live(s, {{1, Weight::least_task, Weight::most}, {1, Weight::least_skin, Weight::most}},
                       simulation.get(), cells_of<by_skin>(scene));
  JobRecorder<Scene> recording(s, live.consumers());

  const auto limit = limits(s);
  Ending ending = Ending::finished;
  std::string detail;  // of the ending
  auto judge = [&] {
    if constexpr (by_torque) {
      return StandingJudge<6>(JointTorque<6>(s.torque.most_friction));
    } else {
      return FollowingJudge<6>(configuration<I>(s));
    }
  }();
  DelayJudge delay(1 / s.rate, std::max(s.network_delay, 0.0),
                   by_torque ? s.torque.delay_margin : s.control.delay_margin,
                   by_torque ? DelayJudge::by_torque : DelayJudge::beyond_time_out);
  constexpr double touching = 1;            // [N]
  constexpr Nanoseconds most_touched = 2s;  // since the arm was found late
  Nanoseconds first{}, braking_since{}, late_since{};
  std::size_t next_goal = 0;
  double round_began = 0;  // [s]
  Largest largest;
  JointVelocity<6> last_velocity;
  Nanoseconds last_time{};
  Status last_status;
  std::uint32_t tares = 0;  // while running
  double tared_at = 0;      // the last of them [s]
  bool heard = false;       // all patches of the skin

  examples::job::Progress progress(s.quiet);
  SkinOnRobotClock cells{receiver, driver};
  if (s.hand && s.hand->palm_gain > 0 && s.hand->reading != nullptr) {
    cells.palm = s.hand->reading;
    cells.both.resize(16385);  // most of one poll, and one
  }
  std::array<double, Scene::law_type::terms> weights;
  const auto before = [&](typename Scene::Input& input, typename Scene::Memory& m) {
    if (first == 0ns) first = input.now;
    const double t = seconds<double>(input.now - first);
    clear.look(scene, m, input);
    input.request = live.take();
    // The scene stops by itself where too little of the skin reports; the job ends then, and says why. What
    // others send to the skin's port is dropped, and so is what the skin itself garbles: then it is silent.
    if (ending == Ending::finished) {
      const auto slowed = [&]() -> std::string {
        const double slider = driver.report().slider;
        if (!(slider < 0.99)) return {};
        return text("; the speed slider stands at %.0f %%: move it to 100 %%", 100 * slider);
      };
      if constexpr (by_skin) {
        const auto cells_in_words = [&] {
          const std::string refused = adapters::skin::refusals(receiver.statistics()),
                            frozen = receiver.frozen(), leaps = receiver.leaps();
          return in_words(scene.skin(), m.skin) + (frozen.empty() ? "" : "; " + frozen) +
                 (leaps.empty() ? "" : "; " + leaps) +
                 (refused.empty() ? "" : "; datagrams refused: " + refused);
        };
        if (!scene.governor().template memory<SkinWatch>(m.governor).heard && t > s.control.skin_patience) {
          ending = Ending::skin_unheard;
          detail = cells_in_words();
        } else if (last_status.has(Reason::skin_stopped)) {
          ending = receiver.silent_for(input.now) > 100ms ? Ending::skin_silent : Ending::skin_deaf;
          detail = cells_in_words();
        }
      } else if (reader.silent_for() > 0.1) {
        ending = Ending::sense_silent;
      }
      if (const auto joint = judge.stuck_joint(); ending == Ending::finished && joint != 0) {
        ending = Ending::stuck;
        detail = "joint " + std::to_string(joint) + slowed();
      } else if (ending == Ending::finished && judge.late()) {
        ending = Ending::late;
        detail = text("by %.0f ms", 1e3 * judge.following().lag) + slowed();
      }
      if (robot.heard == Heard::state) delay.cycle(t, 1 / s.rate, driver.round_trip());
      if (ending == Ending::finished && delay.late()) {
        ending = Ending::distant;
        detail = text("%.0f ms", 1e3 * delay.trip()) + text(", at the start %.0f ms", 1e3 * delay.usual());
      }
      // A stop is stiff: while something touches the arm, it gives way a little longer, though it does so
      // late.
      if (ending == Ending::late || ending == Ending::distant) {
        if (late_since == 0ns) late_since = input.now;
        if (observer.force() > touching && input.now - late_since < most_touched) {
          ending = Ending::finished;
          detail.clear();
        }
      }
      if (ending != Ending::finished) {
        input.request = CycleRequest::stop;
        braking_since = input.now;
      }
    } else if (input.now - braking_since > 500ms) {
      return false;
    }
    if (s.until_stopped && simulation && next_goal == s.task.size() && t - round_began >= s.duration)
      next_goal = 0, round_began = t;
    if (next_goal < s.task.size() && t - round_began >= s.task[next_goal].at) {
      input.goal = typename Scene::Goal{.goal = JointGoal<6>{JointPosition<6>(s.task[next_goal].q),
                                                             nanoseconds(s.task[next_goal].duration)}};
      ++next_goal;
    }
    weights.fill(1);
    if (live.take(weights)) {
      if (!input.goal) input.goal.emplace();
      input.goal->weights.emplace().of = weights;
    }
    return true;
  };
  const auto after = [&](const typename Scene::Input& input, const typename Scene::Output& out,
                         const Stopwatch&) {
    const double t = seconds<double>(input.now - first);
    const auto& reach = std::get<0>(scene.law().sum().laws());
    const auto& reached = Scene::law_type::template memory<0>(memory->law);
    const auto target = reach.reference(reached).q_d;
    if constexpr (by_skin) {
      observer.cycle(t, input.samples, input.measured.q, target);
    } else {
      observe(observer, t, reader, memory->skin, input.measured.q, target);
      if (memory->skin.watch.tares > tares) tares = memory->skin.watch.tares, tared_at = t;
    }
    const double passed = last_time == 0ns ? 0 : seconds<double>(input.now - last_time);
    judge.cycle(t, passed, memory->robot, out.status, observer.force(), target);
    last_status = out.status;
    clear.note(input.measured.q, out.status);
    if constexpr (by_skin) {
      if (!heard && scene.governor().template memory<SkinWatch>(memory->governor).heard)
        heard = true, log.began = t;
      live.look(scene, *memory);
    }
    LogEntry entry;
    entry.time = t;
    entry.force = observer.force();
    const double dt = last_time == 0ns ? 0 : seconds<double>(out.command.time - last_time);
    for (std::size_t i = 0; i < 6; ++i) {
      entry.q[i] = static_cast<float>(input.measured.q[i]);
      entry.target[i] = static_cast<float>(target[i]);
      entry.velocity[i] = static_cast<float>(out.planned.velocity[i]);
      entry.deflection = std::max(entry.deflection, std::abs(input.measured.q[i] - target[i]));
      for (std::size_t k = 0; k < out.shares.size(); ++k)
        entry.shares[k][i] = static_cast<float>(out.shares[k][i]);
      if constexpr (by_torque) {
        entry.shares[2][i] = static_cast<float>(reached.friction[i]);
        largest.torque = std::max(largest.torque, std::abs(out.command.torque[i]) / limit.torque()[i]);
        entry.velocity[i] = static_cast<float>(input.measured.dq[i]);
        largest.step_velocity =
            std::max(largest.step_velocity, std::abs(input.measured.dq[i]) / limit.velocity()[i]);
        continue;  // no motion is commanded
      }
      largest.step_velocity =
          std::max(largest.step_velocity, std::abs(out.planned.velocity[i]) / limit.velocity()[i]);
      if (dt > 0) {
        const double a = (out.planned.velocity[i] - last_velocity[i]) / dt;
        entry.acceleration[i] = static_cast<float>(a);
        largest.step_acceleration =
            std::max(largest.step_acceleration, std::abs(a) / limit.acceleration()[i]);
      }
    }
    entry.status = out.status.bits();
    last_velocity = out.planned.velocity;
    last_time = out.command.time;
    if (log.entries.size() < log.entries.capacity()) log.entries.push_back(entry);
    if (progress.due(t))
      progress.show("%5.0f s  force %5.1f N  deflection %6.3f rad  touches %zu", t, observer.force(),
                    entry.deflection, observer.touches().size());
  };

  if constexpr (S == Sense::wrist) {
    try {
      tare<I>(robot, s.rate);
    } catch (const ConfigurationError& e) {
      return not_tared(e.what(), log);
    }
  }
  LoopOptions options;
  options.cycles = s.until_stopped ? 0 : round;
  options.period = period;
  options.stop = &stop;
  NoSkin no_cells;
  auto& source = [&]() -> auto& {
    if constexpr (by_skin) {
      return cells;
    } else {
      return no_cells;
    }
  }();
  const auto report = run_loop(scene, *memory, robot, source, options, before, after, recording);
  progress.clear();

  // The robot comes to rest by its own program; the simulation knows what its fingers felt.
  log.touches = observer.touches();
  if constexpr (S == Sense::motors)  // where it was is not known
    for (TouchSummary& t : log.touches) t.link = -1, t.place.fill(std::nan(""));
  double behind = 0;
  log.peak_force = 0;
  for (const auto& t : log.touches) log.peak_force = std::max(log.peak_force, t.peak_force);
  if (simulation) {
    const auto world = simulation->snapshot();
    behind = world.behind;
    auto results = world.touches;
    std::erase_if(results, [](const auto& r) { return r.first_contact < 0; });  // it gave way before
    std::sort(results.begin(), results.end(),
              [](const auto& a, const auto& b) { return a.first_contact < b.first_contact; });
    if (results.size() == log.touches.size())
      for (std::size_t i = 0; i < results.size(); ++i) log.touches[i].true_peak_force = results[i].peak_force;
    log.peak_force = 0;
    for (const auto& r : results) log.peak_force = std::max(log.peak_force, r.peak_force);
    simulation->stop();
  }
  fill_times(report, log);
  const auto allocations = testing::unexpected_real_time_allocations();
  log.cycle.period = 1 / s.rate;
  log.cycle.substeps = static_cast<unsigned>(std::lround(1 / (s.rate * scene.resolver().planned_step())));
  if (report.cycles > 0) {
    log.cycle.repeated = 1001;
    log.cycle.repeated_median = repeated_median(scene, report, log.cycle.repeated);
  }
  const bool real_time = s.robot || s.speed == 1;
  const std::string refused = adapters::skin::refusals(receiver.statistics()), frozen = receiver.frozen(),
                    leaps = receiver.leaps();
  log.title = std::string(s.rigid ? "Rigid" : "Compliant") + " UR5, " + (s.robot ? *s.robot : "simulated") +
              ", " + text("%.0f Hz, ", s.rate) + in_words(I) + " interface" +
              (by_skin ? "" : ", by its " + std::string(compliant_ur5::in_words(S)));
  log.laws = {"spline joint", "skin joint", by_torque ? "of these learnt friction" : "gravity"};
  for (std::size_t i = 0; i < 6; ++i) {
    log.velocity_limit[i] = limit.velocity()[i];
    log.acceleration_limit[i] = limit.acceleration()[i];
  }
  log.result = {
      {"cycles", std::to_string(report.cycles)},
      {"samples from the skin", std::to_string(report.samples)},
      {"missed deadlines", real_time ? std::to_string(report.missed) + " of " + std::to_string(report.cycles)
                                     : "not at real-time pace"},
      {"allocations in the loop", std::to_string(allocations)},
      by_torque ? Fact{"largest torque", text("%.1f %% of its limit", 100 * largest.torque)}
                : Fact{"fastest command", text("%.1f %% of its limit", 100 * largest.step_velocity)},
      by_torque ? Fact{"fastest joint", text("%.1f %% of its limit", 100 * largest.step_velocity)}
                : Fact{"largest command step", text("%.1f %% of its limit", 100 * largest.step_acceleration)},
      {"lag beyond the declared one", judge.following().lag_deviation < judge.uncertain
                                          ? text("%.1f ms", 1e3 * judge.following().lag)
                                          : "not known"},
      {"states repeated or out of order", std::to_string(driver.stood())},
      {"cycles without a new state", std::to_string(report.silent)},
      {"peak contact force", text("%.1f N", log.peak_force)},
  };
  if constexpr (by_skin) {
    log.felt = felt(scene, *memory);
    log.result.push_back({"cells that report", in_words(scene.skin(), memory->skin)});
    log.result.push_back({"skin datagrams lost", std::to_string(receiver.statistics().lost)});
    log.result.push_back({"stray skin datagrams", std::to_string(receiver.statistics().stray())});
    log.result.push_back({"skin datagrams refused", refused.empty() ? "none" : refused});
    log.result.push_back({"leaps of the skin's clock", leaps.empty() ? "none" : leaps});
    log.result.push_back({"frozen cells", frozen.empty() ? "none" : frozen});
  } else {
    add_facts(reader, memory->skin, log);
    log.result.push_back({"pushes without life, taken for rest",
                          std::to_string(tares) + (tares > 0 ? text(", the last at %.1f s", tared_at) : "")});
  }
  clear.report(log);
  recording.finish(log);
  print(s, log);

  if (report.ended == LoopEnd::displaced) ending = Ending::displaced;
  if (report.ended == LoopEnd::interrupted) ending = Ending::interrupted;
  if constexpr (by_skin) {
    if (ending == Ending::finished && report.ended == LoopEnd::finished &&
        !scene.governor().template memory<SkinWatch>(memory->governor).heard) {
      ending = Ending::skin_unheard;
      detail = "the arm did not move";
    }
  }
  const double slack = 1 + 1e-9;
  const bool kept = allocations == 0 && largest.torque <= slack &&
                    (by_torque || (largest.step_velocity <= slack && largest.step_acceleration <= slack));
  if (ending == Ending::finished && report.ended == LoopEnd::finished && !kept) ending = Ending::broken;
  Outcome outcome = row(ending).exit;
  if (report.ended == LoopEnd::lost || report.ended == LoopEnd::no_state) {
    log.ending = adapters::ur5::row(driver.fault()).name;
    log.words = driver.error();
    outcome = adapters::ur5::row(driver.fault()).exit;
  } else {
    log.ending = row(ending).name;
    log.words = row(ending).words + (detail.empty() ? "" : ": " + detail);
  }
  const double pace = s.robot ? 1 : s.speed;
  if (outcome != Outcome::fine && outcome != Outcome::interrupted && outcome != Outcome::broken && pace > 0)
    log.words += too_slow(pace * behind, pace * seconds<double>(report.load.max()), 1 / s.rate);
  live.end(log.words);
  if (outcome != Outcome::fine)
    std::fprintf(stderr, "\n%s: %s (exit code %d: %s)\n", ending == Ending::broken ? "failed" : "stopped",
                 log.words.c_str(), examples::job::code(outcome), examples::job::words(outcome));
  return outcome;
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
