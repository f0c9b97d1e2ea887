#include "examples/compliant_arm/run.hpp"

#include <cstdio>

#include "examples/adapters/clocked_driver.hpp"
#include "examples/compliant_arm/scene.hpp"
#include "skinctl/hardware/loop.hpp"
#include "skinctl/hardware/scheduling.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/kinematics/poses.hpp"

namespace compliant_arm {
namespace {

using namespace skinctl;
using adapters::ClockedDriver;
using examples::job::Exit;

Xyz<double> flange(const Model& model, const JointPosition<6>& q) {
  return link_poses(model, q).get<5>().origin();
}
double distance(const Xyz<double>& a, const Xyz<double>& b) {
  const Xyz<double> d = a - b;
  return std::sqrt(dot(d, d));
}

/// What may be commanded: a share of what URDF, the user and the robot allow; of RSI around where the arm stands.
Limits limits_of_run(const Settings& s, const Urdf& urdf, const std::array<adapters::SixJoints, 3>* robot,
                     const adapters::SixJoints& at, double max_correction) {
  const auto file = limits_of<6>(urdf, s.acceleration);
  JointLimits<6>::Values v;
  Limits out{file, {}};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto within = [&](std::size_t k, double x) {
      return robot != nullptr ? std::min(x, s.speed_share * (*robot)[k][i]) : x;
    };
    v.lower[i] = std::max(file.lower()[i], at[i] - max_correction);
    v.upper[i] = std::min(file.upper()[i], at[i] + max_correction);
    v.velocity[i] = within(0, s.speed_share * file.velocity()[i]);
    v.acceleration[i] = within(1, s.acceleration);
    out.jerk[i] = within(2, s.jerk);
    v.torque[i] = file.torque()[i];
  }
  out.joints = JointLimits<6>(v);
  return out;
}

/// How far pushes move the flange, as its own joints say.
class Watch {
 public:
  Watch(const Model& model, double threshold) : model_(model), threshold_(threshold) {}
  void cycle(double t, const JointPosition<6>& q, const adapters::ClockedState& state, RunLog& log) {
    const auto p = flange(model_, q);
    double force = 0;
    if (state.wrench)
      for (std::size_t i = 0; i < 3; ++i) force = std::hypot(force, (*state.wrench)[i]);
    const bool pushed = force > threshold_;
    if (pushed && t > until_ + 2) {
      from_ = p;
      log.pushes.push_back({.start = t});
    }
    if (log.pushes.empty()) return;
    PushSummary& now = log.pushes.back();
    if (pushed) until_ = t;
    if (t > until_ + 2) return;
    now.force = std::max(now.force, force);
    now.left = distance(p, from_);
    now.moved = std::max(now.moved, now.left);
  }

 private:
  const Model& model_;
  double threshold_, until_ = -1e9;
  Xyz<double> from_{};
};

/// Velocity, acceleration and jerk of the commands.
class Steps {
 public:
  void cycle(const JointPosition<6>& q, double dt, const Limits& limits, RunLog& log) {
    if (++count_ > 3)
      for (std::size_t i = 0; i < 6; ++i) {
        const double v = q[i] - q_[0][i], v1 = q_[0][i] - q_[1][i], v2 = q_[1][i] - q_[2][i];
        log.peak[0] = std::max(log.peak[0], std::abs(v) / dt / limits.joints.velocity()[i]);
        log.peak[1] = std::max(log.peak[1], std::abs(v - v1) / (dt * dt) / limits.joints.acceleration()[i]);
        log.peak[2] = std::max(log.peak[2], std::abs(v - 2 * v1 + v2) / (dt * dt * dt) / limits.jerk[i]);
      }
    q_ = {q, q_[0], q_[1]};
  }
  void gap() { count_ = 0; }

 private:
  std::array<JointPosition<6>, 3> q_{};
  int count_ = 0;
};

struct NoCells {
  std::span<const CellSample> poll() noexcept { return {}; }
};

template <class Driver>
Exit run_on(Driver& driver, const Settings& s, const Urdf& urdf, const std::atomic<bool>& stop, RunLog& log) {
  driver.connect();
  if (!driver.newest().wrench) {
    driver.stop();
    log.reason = "the controller's states hold no forces: see the page for what they need";
    return Exit::blind;
  }
  const auto period = driver.protocol().period();
  const Model model = calibrated_from<Chain<6>>(urdf);
  const Limits limits = [&] {
    if constexpr (requires { driver.protocol().max_correction(); })
      return limits_of_run(s, urdf, nullptr, driver.newest().told, 0.95 * driver.protocol().max_correction());
    else if constexpr (requires { driver.protocol().limits(); })
      return limits_of_run(s, urdf, &driver.protocol().limits(), driver.newest().told, 1e9);
    else
      return limits_of_run(s, urdf, nullptr, driver.newest().told, 1e9);
  }();
  double factor = 1;
  const auto scene = driver.hold_while([&] {
    factor = heavier(model, s, limits, period);
    return make_scene(model, s, limits, period, factor);
  });
  using Scene = std::remove_cvref_t<decltype(scene)>;
  log.felt_mass = felt_mass(model, s, limits, period, factor);
  const auto memory = std::make_unique<typename Scene::Memory>();
  if (!s.quiet) std::printf("connected; the tool is felt as %.0f kg at least\n", log.felt_mass);

  Watch watch(model, s.threshold);
  Steps steps;
  examples::job::Progress progress(s.quiet);
  Nanoseconds first{}, sent_at{};
  const JointPosition<6> home(driver.newest().told);
  const auto before = [&](typename Scene::Input& input, typename Scene::Memory&) {
    if (first == 0ns) {
      first = input.now;
      input.goal = {home, 1s};
    }
    return seconds<double>(input.now - first) < s.duration;
  };
  const auto after = [&](const typename Scene::Input& input, const typename Scene::Output& out,
                         const Stopwatch&) {
    const double t = seconds<double>(input.now - first);
    watch.cycle(t, input.measured.q, driver.newest(), log);
    // A cycle that is no period after the one before: its command is for another time, or for the same.
    if (input.now - sent_at != period || driver.silent() > 0) steps.gap();
    sent_at = input.now;
    steps.cycle(out.command.position, seconds<double>(period), limits, log);
    if (progress.due(t))
      progress.show("%5.1f s  %zu pushes  %llu late, %llu lost", t, log.pushes.size(),
                    static_cast<unsigned long long>(driver.counts().late),
                    static_cast<unsigned long long>(driver.counts().lost));
  };
  LoopOptions loop;
  loop.period = period;
  loop.stop = &stop;
  NoCells no_cells;
  const auto report = run_loop(scene, *memory, driver, no_cells, loop, before, after);
  progress.clear();
  log.counts = driver.counts();
  log.fault = driver.fault();
  log.cycles = report.cycles;
  log.silent = report.silent;
  const auto us = [](Nanoseconds t) { return 1e3 * milliseconds(t); };
  log.cycle_us = us(report.whole.percentile(0.5));
  log.cycle_max_us = us(report.whole.max());
  log.load_max_us = us(report.load.max());

  if (report.ended == LoopEnd::interrupted) return log.reason = "interrupted", Exit::interrupted;
  if (report.ended == LoopEnd::displaced)
    return log.reason = "the arm stands too far from where it was told to be", Exit::not_following;
  if (report.ended != LoopEnd::finished) return log.reason = driver.error(), row(log.fault).exit;
  if (driver.fault() != adapters::ClockFault::none)  // while it was brought to rest
    return log.reason = driver.error(), row(log.fault).exit;
  const bool kept = log.peak[0] <= 1.001 && log.peak[1] <= 1.001 && log.peak[2] <= 1.01;
  if (!kept) return log.reason = "a command beyond its limits", Exit::broken;
  return Exit::fine;
}

}  // namespace

void simulate_by_default(Settings& s) {
  s.simulation.pushes = {{1, 1, {0, 0, 40}}, {4.5, 1, {30, 0, 0}}};
  if (s.robot == Robot::egm) {
    s.simulation.delay = 0.05;
    s.simulation.lag = 0.05;
    s.delay = 0.05 + 2 * 0.004;
    s.lag = 0.05;
  }
  if (s.robot == Robot::stream_motion) {
    s.stream_motion_controller.version = 4;
    s.simulation.delay = 0.04;
    s.simulation.lag = 0.05;
    s.delay = 0.04 + 2 * 0.008;
    s.lag = 0.05;
  }
}

Exit run(const Settings& s, const std::atomic<bool>& stop, RunLog& log) {
  const Urdf urdf = read_urdf(s.urdf);
  const bool paced = !s.simulate || s.simulation.speed > 0;
  const adapters::ClockOptions options{.give_up = adapters::Timeout(paced ? 150 : 4000), .real_time = paced};
  if (paced) {
    const auto granted = request_real_time();
    if (!s.quiet) std::printf("%s", granted.report.c_str());
  }
  std::unique_ptr<simulated_arm::Controller> peer;
  Exit end = Exit::fine;
  const auto with = [&](auto& driver) { end = run_on(driver, s, urdf, stop, log); };
  if (s.robot == Robot::rsi) {
    auto rsi = s.rsi;
    if (s.simulate) rsi.bind = "127.0.0.1", rsi.port = 0;
    adapters::rsi::Rsi protocol(rsi);
    if (s.simulate)
      peer = rsi_controller(s.simulation, s.rsi_controller, "127.0.0.1", protocol.socket().port());
    ClockedDriver driver(std::move(protocol), options);
    with(driver);
  } else if (s.robot == Robot::egm) {
    auto egm = s.egm;
    if (s.simulate) egm.bind = "127.0.0.1", egm.port = 0;
    adapters::egm::Egm protocol(egm);
    if (s.simulate)
      peer = egm_controller(s.simulation, s.egm_controller, "127.0.0.1", protocol.socket().port());
    ClockedDriver driver(std::move(protocol), options);
    with(driver);
  } else {
    auto stream = s.stream_motion;
    if (s.simulate) {
      peer = stream_motion_controller(s.simulation, s.stream_motion_controller, "127.0.0.1", 0);
      stream.host = "127.0.0.1", stream.port = peer->port();
    }
    ClockedDriver driver(adapters::stream_motion::StreamMotion(stream), options);
    with(driver);
  }
  if (peer) {
    peer->stop();
    log.last = peer->snapshot();
    if (!s.quiet && end != Exit::fine && !log.last.ended.empty())
      std::printf("the simulated controller: %s\n", log.last.ended.c_str());
  }
  return end;
}

}  // namespace compliant_arm
