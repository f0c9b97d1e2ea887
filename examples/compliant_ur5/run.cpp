#include "examples/compliant_ur5/run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>

#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/ur5/driver.hpp"
#include "examples/compliant_ur5/scene.hpp"
#include "examples/compliant_ur5/touch_observer.hpp"
#include "examples/simulated_ur5/scenario.hpp"
#include "examples/simulated_ur5/skin_faults.hpp"
#include "skinctl/cycle/recording.hpp"
#include "skinctl/hardware/loop.hpp"
#include "skinctl/hardware/scheduling.hpp"
#include "skinctl/testing/allocation_guard.hpp"

namespace compliant_ur5 {
namespace {

using namespace skinctl;

std::string text(const char* format, double value) {
  char out[64];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

/// The newest session of the skin that earlier runs heard, beside its key: a recording of it is refused.
std::string session_file(const std::string& key) {
  return key + ".session";
}
std::uint64_t read_session(const std::string& key) {
  std::ifstream in(session_file(key));
  std::uint64_t session = 0;
  if (in && !(in >> session)) refuse("skinctl: " + session_file(key) + ": no whole number");
  return session;
}
void write_session(const std::string& key, std::uint64_t session) {
  std::ofstream out(session_file(key));
  out << session << '\n' << std::flush;
  if (!out) std::fprintf(stderr, "compliant_ur5: cannot write %s\n", session_file(key).c_str());
}

/// The simulated robot of a scenario, started and waiting.
std::unique_ptr<simulated_ur5::SimulatedUr5> start_simulation(const Settings& s, std::uint16_t skin_port,
                                                              const std::optional<adapters::skin::Key>& key,
                                                              RunLog& log) {
  simulated_ur5::Config config;
  simulated_ur5::read_scenario(s.scenario, config);
  config.controller.series = s.rate > 125 ? simulated_ur5::Series::e_series : simulated_ur5::Series::cb3;
  config.controller.cells = simulated_cells(skin_patches(s));
  if (!s.skin_faults.empty())
    config.controller.skin.faults = simulated_ur5::read_skin_faults(s.skin_faults, config.controller.cells);
  config.controller.powered = true;
  config.ports = {0, 0, 0, 0, 0};
  config.speed = s.speed;
  config.skin_host = s.skin_address;
  if (boost::asio::ip::make_address(s.skin_address).is_unspecified()) config.skin_host = "127.0.0.1";
  config.skin_port = skin_port;
  if (key) {
    const std::uint64_t session = adapters::skin::session_now();
    config.seal = [key = *key, session](std::span<std::uint8_t> bytes, std::size_t size) {
      return adapters::skin::seal(bytes, size, session, key);
    };
  }
  if (!s.touch_profile.empty()) {
    // One recorded press on the forearm, and again on the upper arm.
    const auto profile = simulated_ur5::read_profile_file(s.touch_profile);
    std::vector<simulated_ur5::Touch> touches;
    double start = 2;
    for (const std::uint32_t cell : {145u, 250u}) {
      simulated_ur5::Touch touch;
      if (!config.controller.touches.empty()) touch = config.controller.touches.front();
      touch.name = s.touch_profile;
      touch.cell = std::min<std::uint32_t>(cell, cells - 20);
      touch.start = start;
      touch.profile = profile;
      touches.push_back(touch);
      start += touch.duration() + 6;
    }
    config.controller.touches = std::move(touches);
  }
  simulated_ur5::check(config);
  double stiffness = 0, travel = 1e9, speed = 0;
  for (const auto& t : config.controller.touches) {
    stiffness = std::max(stiffness, t.stiffness);
    travel = std::min(travel, t.travel);
    speed = std::max(speed, t.approach_speed);
  }
  const auto& arm = config.controller.arm;
  log.scenario = {{"touches of the whole scenario", std::to_string(config.controller.touches.size())},
                  {"stiffness of finger and skin", text("%.0f N/m", stiffness)},
                  {"approach speed", text("%.3f m/s", speed)},
                  {"travel beyond the surface", text("%.1f mm", 1000 * travel)},
                  {"robot's delay", text("%.1f ms", 1000 * arm.delay)},
                  {"robot's lag", text("%.1f ms", 1000 * arm.lag)}};
  if (s.interface == Interface::position)
    log.scenario.push_back({"lookahead of servoj", text("%.1f ms", 1000 * adapters::ur5::servoj_lookahead)});
  auto robot = std::make_unique<simulated_ur5::SimulatedUr5>(std::move(config));
  robot->start();
  return robot;
}

/// How many cells report, in words.
std::string in_words(const Coverage& c) {
  return std::to_string(c.usable) + " of " + std::to_string(c.cells);
}

/// The receiver as a source of samples on the robot's clock.
struct SkinOnRobotClock {
  adapters::skin::Receiver& receiver;
  const adapters::ur5::Driver& driver;
  std::span<const CellSample> poll() noexcept { return receiver.poll(driver.clock()); }
};

/// The driver, which remembers how the scene was started: a recording begins there.
struct RecordedDriver {
  adapters::ur5::Driver& driver;
  State<6> measured{};
  JointPosition<6> began_told{};
  State<6> began{};

  Heard wait(State<6>& state) noexcept {
    const Heard heard = driver.wait(state);
    measured = state;
    return heard;
  }
  JointPosition<6> told() noexcept {
    began = measured;
    return began_told = driver.told();
  }
  bool send(const JointCommand<6>& command) noexcept { return driver.send(command); }
  void stop() noexcept { driver.stop(); }
};

struct Largest {
  double step_velocity = 0, step_acceleration = 0;  ///< in units of their limits
};

template <class C>
void fill_times(const LoopReport<C>& report, RunLog& log) {
  const auto add = [&](const char* stage, const Histogram& h) {
    const auto us = [&](Nanoseconds t) { return 1e3 * milliseconds(t); };
    log.times.push_back(
        {stage, us(h.percentile(0.5)), us(h.percentile(0.99)), us(h.percentile(0.999)), us(h.max())});
  };
  for (std::size_t i = 0; i < stage_count; ++i) add(name(static_cast<CycleStage>(i)), report.stages[i]);
  add("whole cycle", report.whole);
}

/// The median time of the run's slowest cycle [us] when it is run again and again, with nothing in between.
template <class C>
double repeated_median(const C& cycle, const LoopReport<C>& report, unsigned times) {
  const auto memory = std::make_unique<typename C::Memory>();
  std::vector<double> us;
  us.reserve(times);
  for (unsigned k = 0; k < times; ++k) {
    *memory = report.worst->memory;
    Stopwatch watch;
    static_cast<void>(cycle.step(*memory, report.worst->input, watch));
    us.push_back(1e3 * milliseconds(watch.total()));
  }
  std::nth_element(us.begin(), us.begin() + times / 2, us.end());
  return us[times / 2];
}

void print(const Settings& s, const RunLog& log) {
  if (s.quiet) return;
  std::printf("\r%78s\r", "");
  for (const Fact& f : log.scenario) std::printf("  %-34s %s\n", f.name.c_str(), f.value.c_str());
  std::printf("\n  touch   at [s]  link  cell  peak [N]  gave way [mm]  after [ms]  return error [mm]\n");
  int k = 0;
  for (const TouchSummary& t : log.touches) {
    char after[16] = "never";
    if (t.give_way >= 0) std::snprintf(after, sizeof after, "%.0f", 1000 * t.give_way);
    std::printf("  %5d %8.2f %5d %5u %9.1f %14.1f %11s %18.2f\n", ++k, t.start, t.link, t.cell,
                t.true_peak_force >= 0 ? t.true_peak_force : t.peak_force, 1000 * t.deflection, after,
                1000 * t.return_error);
  }
  std::printf("\n  time of a cycle [us]     median      p99    p99.9      max\n");
  for (const StageTimes& t : log.times)
    std::printf("  %-20s %10.2f %8.2f %8.2f %8.2f\n", t.stage.c_str(), t.median, t.p99, t.p999, t.max);
  std::printf("\n");
  for (const Fact& f : log.result) std::printf("  %-34s %s\n", f.name.c_str(), f.value.c_str());
}

template <Interface I>
Outcome run_with(const Settings& s, const std::atomic<bool>& stop, RunLog& log) {
  const auto scene = make_watched_scene<I>(s);
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const Nanoseconds period = nanoseconds(1 / s.rate);

  std::optional<adapters::skin::Key> key;
  if (!s.skin_key.empty()) key = adapters::skin::Key::read(s.skin_key);
  const std::uint64_t last_session = key ? read_session(s.skin_key) : 0;
  adapters::skin::Receiver receiver({.address = s.skin_address,
                                     .port = s.skin_port,
                                     .sender = s.skin_sender,
                                     .key = key,
                                     .after_session = last_session});
  std::unique_ptr<simulated_ur5::SimulatedUr5> simulation;
  adapters::ur5::DriverConfig config;
  config.rate = s.rate;
  config.interface = I;
  config.rtde_port = s.rtde_port;
  config.script_port = s.script_port;
  config.dashboard_port = s.dashboard_port;
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
  adapters::ur5::Driver driver(config);
  driver.connect();
  if (!s.quiet) {
    std::printf("connected to %s, controller %s, %.0f Hz, %s\n",
                s.robot ? s.robot->c_str() : "the simulated UR5", driver.controller().c_str(), s.rate,
                I == Interface::position ? "position" : "velocity");
    if (s.speed != 0 || s.robot) std::printf("%s", request_real_time().report.c_str());
  }

  TouchObserver observer(observed_cells(skin_patches(s)), s.newtons_per_reading, s.rest_reading);
  const std::uint64_t planned = s.cycles != 0 ? s.cycles : static_cast<std::uint64_t>(s.duration * s.rate);
  log.entries.reserve(planned);
  const auto memory = std::make_unique<typename Scene::Memory>();
  Recording<Scene> recording(s.record.empty() ? 4096 : planned * 2048 + (std::size_t(64) << 20));

  const auto limit = limits(s);
  std::string reason;
  bool blind = false;  // the reason is that the skin does not feel
  Nanoseconds first{}, braking_since{};
  std::size_t next_goal = 0;
  Largest largest;
  JointVelocity<6> last_velocity;
  Nanoseconds last_time{};
  Status all, last_status;
  bool recording_started = false;

  SkinOnRobotClock skin{receiver, driver};
  RecordedDriver robot{driver};
  const auto before = [&](typename Scene::Input& input, typename Scene::Memory& m) {
    if (first == 0ns) first = input.now;
    const double t = seconds<double>(input.now - first);
    if (!recording_started && !s.record.empty()) {
      // The scene was started at the state before this one: that is what a replay starts from.
      if constexpr (I == Interface::position) {
        recording.start(robot.began, robot.began_told);
      } else {
        recording.start(m.robot.measured);
      }
      recording_started = true;
    }
    // The scene stops by itself where too little of the skin reports; the job ends then, and says why.
    // What others send to the skin's port is dropped, and so is what the skin itself garbles: then it is silent.
    if (reason.empty()) {
      const auto cells_in_words = [&] { return in_words(scene.skin().coverage(m.skin)) + " cells report"; };
      if (!m.governor.watch.heard && t > s.control.skin_patience) {
        reason = "the skin was never heard: " + cells_in_words();
        blind = true;
      } else if (last_status.has(Reason::skin_stopped)) {
        reason = (receiver.silent_for(input.now) > 100ms ? "the skin has fallen silent: "
                                                         : "the skin is blind, though its sender lives: ") +
                 cells_in_words();
        blind = true;
      }
      if (!reason.empty()) {
        input.request = CycleRequest::stop;
        braking_since = input.now;
      }
    } else if (input.now - braking_since > 500ms) {
      return false;
    }
    if (next_goal < s.task.size() && t >= s.task[next_goal].at) {
      input.has_goal = true;
      input.goal.q_g = JointPosition<6>(s.task[next_goal].q);
      input.goal.duration = nanoseconds(s.task[next_goal].duration);
      ++next_goal;
    }
    return true;
  };
  const auto after = [&](const typename Scene::Input& input, const typename Scene::Output& out,
                         const Stopwatch&) {
    const double t = seconds<double>(input.now - first);
    const auto& reach = std::get<0>(scene.law().laws());
    const auto target = reach.reference(Scene::law_type::template memory<0>(memory->law)).q_d;
    observer.cycle(t, input.samples, input.measured.q, target);
    all |= out.status;
    last_status = out.status;
    LogEntry entry;
    entry.time = t;
    entry.force = observer.force();
    const double dt = last_time == 0ns ? 0 : seconds<double>(out.command.time - last_time);
    for (std::size_t i = 0; i < 6; ++i) {
      entry.q[i] = static_cast<float>(input.measured.q[i]);
      entry.target[i] = static_cast<float>(target[i]);
      entry.velocity[i] = static_cast<float>(out.command.velocity[i]);
      entry.deflection = std::max(entry.deflection, std::abs(input.measured.q[i] - target[i]));
      for (std::size_t k = 0; k < 3; ++k) entry.shares[k][i] = static_cast<float>(out.shares[k][i]);
      largest.step_velocity =
          std::max(largest.step_velocity, std::abs(out.command.velocity[i]) / limit.velocity()[i]);
      if (dt > 0) {
        const double a = (out.command.velocity[i] - last_velocity[i]) / dt;
        entry.acceleration[i] = static_cast<float>(a);
        largest.step_acceleration =
            std::max(largest.step_acceleration, std::abs(a) / limit.acceleration()[i]);
      }
    }
    entry.status = out.status.bits();
    last_velocity = out.command.velocity;
    last_time = out.command.time;
    if (log.entries.size() < log.entries.capacity()) log.entries.push_back(entry);
    if (!s.record.empty()) recording.add(input, out.command);
    if (!s.quiet && log.entries.size() % static_cast<std::size_t>(s.rate) == 0) {
      std::printf("\r%5.0f s  force %5.1f N  deflection %6.3f rad  touches %zu ", t, observer.force(),
                  entry.deflection, observer.touches().size());
      std::fflush(stdout);
    }
  };

  LoopOptions options;
  options.cycles = planned;
  options.period = period;
  options.stop = &stop;
  const auto report = run_loop(scene, *memory, robot, skin, options, before, after);

  if (key && receiver.session() > last_session) write_session(s.skin_key, receiver.session());
  // The robot comes to rest by its own program; the simulation knows what its fingers felt.
  log.touches = observer.touches();
  log.peak_force = 0;
  for (const auto& t : log.touches) log.peak_force = std::max(log.peak_force, t.peak_force);
  if (simulation) {
    auto results = simulation->snapshot().touches;
    std::erase_if(results, [](const auto& r) { return !r.began; });
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
  log.title = std::string(s.rigid ? "Rigid" : "Compliant") + " UR5, " + (s.robot ? *s.robot : "simulated") +
              ", " + text("%.0f Hz, ", s.rate) + (I == Interface::position ? "position" : "velocity") +
              " interface";
  log.laws = {"spline joint", "skin joint", "gravity"};
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
      {"fastest command", text("%.1f %% of its limit", 100 * largest.step_velocity)},
      {"largest command step", text("%.1f %% of its limit", 100 * largest.step_acceleration)},
      {"cells that report", in_words(scene.skin().coverage(memory->skin))},
      {"skin datagrams lost", std::to_string(receiver.statistics().lost)},
      {"stray skin datagrams", std::to_string(receiver.statistics().stray())},
      {"peak contact force", text("%.1f N", log.peak_force)},
  };
  std::string noted;
  all.for_each([&](Reason r) { noted += (noted.empty() ? "" : "; ") + std::string(describe(r)); });
  log.result.push_back({"noted", noted.empty() ? "nothing" : noted});
  print(s, log);
  if (!s.record.empty()) recording.save(s.record);

  if (report.ended == LoopEnd::displaced) reason = "the arm stands too far from where it was told to be";
  if (report.ended == LoopEnd::lost || report.ended == LoopEnd::no_state) reason = driver.error();
  if (!reason.empty()) {
    std::fprintf(stderr, "\nstopped: %s; the robot was told to stop\n", reason.c_str());
    return blind ? Outcome::blind : Outcome::lost;
  }
  if (report.ended == LoopEnd::interrupted) return Outcome::interrupted;
  if (report.cycles > 0 && !memory->governor.watch.heard) {
    std::fprintf(stderr, "\nthe skin was never heard: the arm did not move\n");
    return Outcome::blind;
  }
  const double slack = 1 + 1e-9;
  if (allocations != 0 || largest.step_velocity > slack || largest.step_acceleration > slack) {
    std::fprintf(stderr, "\na promise was broken: see the figures above\n");
    return Outcome::broken;
  }
  return Outcome::fine;
}

template <Interface I>
Outcome replay_with(const Settings& s) {
  const auto scene = make_watched_scene<I>(s);
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const auto result = skinctl::replay(scene, Recording<Scene>::load(s.replay));
  std::printf("replayed %llu cycles: ", static_cast<unsigned long long>(result.cycles));
  if (result.different == 0) {
    std::printf("every command is the same to the bit\n");
    return Outcome::fine;
  }
  std::printf("%llu commands differ, the first in cycle %llu\n",
              static_cast<unsigned long long>(result.different),
              static_cast<unsigned long long>(result.first_different));
  return Outcome::broken;
}

}  // namespace

Outcome run(const Settings& settings, const std::atomic<bool>& stop, RunLog& log) {
  return settings.interface == Interface::position ? run_with<Interface::position>(settings, stop, log)
                                                   : run_with<Interface::velocity>(settings, stop, log);
}

Outcome replay(const Settings& settings) {
  return settings.interface == Interface::position ? replay_with<Interface::position>(settings)
                                                   : replay_with<Interface::velocity>(settings);
}

}  // namespace compliant_ur5
