#include "examples/compliant_arm/run.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstdio>

#include "examples/adapters/clocked_driver.hpp"
#include "examples/compliant_arm/identify.hpp"
#include "examples/compliant_arm/scene.hpp"
#include "skinctl/hardware/loop.hpp"
#include "skinctl/hardware/scheduling.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/kinematics/poses.hpp"

namespace compliant_arm {
namespace {

using namespace skinctl;
using adapters::ClockedDriver;
using examples::job::Exit;

template <std::size_t N>
Xyz<double> flange(const Model<N>& model, const JointPosition<N>& q) {
  return link_poses(model, q).template get<N - 1>().origin();
}
/// The force of a push [N]: that of the wrist's sensor, or the one at the flange that fits the joints'
/// torques best.
template <std::size_t N>
double force_of(const Model<N>& model, const JointPosition<N>& q, const adapters::ClockedStateOf<N>& state) {
  if (state.wrench) return std::hypot((*state.wrench)[0], (*state.wrench)[1], (*state.wrench)[2]);
  if (!state.external) return 0;
  // A direction in which no joint moves the flange has no force.
  constexpr double least = 1e-4;  // [m^2], of the squared levers of the joints
  Eigen::Matrix3d JJ = least * Eigen::Matrix3d::Identity();
  Eigen::Vector3d Jtau = Eigen::Vector3d::Zero();
  jacobian<N - 1>(link_poses(model, q)).for_each([&](auto i, const auto& column) {
    const Eigen::Vector3d x(column.linear.x, column.linear.y, column.linear.z);
    JJ += x * x.transpose();
    Jtau += (*state.external)[i.value] * x;
  });
  return JJ.llt().solve(Jtau).norm();
}
double distance(const Xyz<double>& a, const Xyz<double>& b) {
  const Xyz<double> d = a - b;
  return std::sqrt(dot(d, d));
}

/// What may be commanded: a share of what URDF, the user and the robot allow; of RSI around where the arm
/// stands.
template <std::size_t N>
Limits<N> limits_of_run(const Settings& s, const Urdf& urdf,
                        const std::array<std::array<double, N>, 3>* robot, const std::array<double, N>& at,
                        double max_correction) {
  const auto file = limits_of<N>(urdf, s.acceleration);
  typename JointLimits<N>::Values v;
  Limits<N> out{file, {}, JointPosition<N>(at)};
  for (std::size_t i = 0; i < N; ++i) {
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
  out.joints = JointLimits<N>(v);
  return out;
}

/// How far pushes move the flange, as its own joints say.
template <std::size_t N>
class Watch {
 public:
  Watch(const Model<N>& model, const Settings& s)
      : model_(model), threshold_(s.threshold), torque_threshold_(s.torque_threshold) {}
  void cycle(double t, const JointPosition<N>& q, const adapters::ClockedStateOf<N>& state, RunLog& log) {
    const auto p = flange(model_, q);
    const double force = force_of(model_, q, state);
    const bool pushed = is_pushed(force, state);
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
  /// As a hand that the scene answers.
  bool is_pushed(double force, const adapters::ClockedStateOf<N>& state) const {
    if (!state.external) return force > threshold_;
    return std::any_of(state.external->begin(), state.external->end(),
                       [&](double x) { return std::abs(x) > torque_threshold_; });
  }
  const Model<N>& model_;
  double threshold_, torque_threshold_, until_ = -1e9;
  Xyz<double> from_{};
};

/// Velocity, acceleration and jerk of the commands.
template <std::size_t N>
class Steps {
 public:
  void cycle(const JointPosition<N>& q, double dt, const Limits<N>& limits, RunLog& log) {
    if (++count_ > 3)
      for (std::size_t i = 0; i < N; ++i) {
        const double v = q[i] - q_[0][i], v1 = q_[0][i] - q_[1][i], v2 = q_[1][i] - q_[2][i];
        log.peak[0] = std::max(log.peak[0], std::abs(v) / dt / limits.joints.velocity()[i]);
        log.peak[1] = std::max(log.peak[1], std::abs(v - v1) / (dt * dt) / limits.joints.acceleration()[i]);
        log.peak[2] = std::max(log.peak[2], std::abs(v - 2 * v1 + v2) / (dt * dt * dt) / limits.jerk[i]);
      }
    q_ = {q, q_[0], q_[1]};
  }
  void gap() { count_ = 0; }

 private:
  std::array<JointPosition<N>, 3> q_{};
  int count_ = 0;
};

struct NoCells {
  std::span<const CellSample> poll() noexcept { return {}; }
};

template <class Kind, class Driver>
Exit run_on(Driver& driver, const Settings& s, const Urdf& urdf, const std::atomic<bool>& stop, RunLog& log) {
  constexpr std::size_t N = Driver::joints;
  driver.connect();
  if (!driver.newest().wrench && !driver.newest().external) {
    driver.stop();
    log.reason = "the controller's states hold no forces: see the page for what they need";
    return Exit::blind;
  }
  const auto period = driver.protocol().period();
  const Kind kind{period};
  const Model<N> model = calibrated_from<Chain<N>>(urdf);
  if (s.identify) {
    if (!s.quiet)
      std::printf("the arm moves by 0.1 rad for 15 s%s\n",
                  driver.newest().external ? "; then push it slowly at its flange, for 5 s" : "");
    log.found = identify_on(driver, model, s, driver.newest().external ? 5 : 0, stop);
    driver.stop();
    log.counts = driver.counts(), log.fault = driver.fault();
    if (stop) return log.reason = "interrupted", Exit::interrupted;
    if (log.fault != adapters::ClockFault::none) return log.reason = driver.error(), row(log.fault).exit;
    if (!log.found.known) return log.reason = "the commands hardly move the arm", Exit::not_following;
    return Exit::fine;
  }
  const Limits<N> limits = [&] {
    if constexpr (requires { driver.protocol().max_correction(); })
      return limits_of_run<N>(s, urdf, nullptr, driver.newest().told,
                              0.95 * driver.protocol().max_correction());
    else if constexpr (requires { driver.protocol().limits(); })
      return limits_of_run<N>(s, urdf, &driver.protocol().limits(), driver.newest().told, 1e9);
    else
      return limits_of_run<N>(s, urdf, nullptr, driver.newest().told, 1e9);
  }();
  double factor = 1;
  const auto scene = driver.hold_while([&] {
    factor = heavier(kind, model, s, limits);
    return make_scene(kind, model, s, limits, factor);
  });
  using Scene = std::remove_cvref_t<decltype(scene)>;
  log.felt_mass = felt_mass(kind, model, s, limits, factor);
  const auto memory = std::make_unique<typename Scene::Memory>();
  if (!s.quiet) std::printf("connected; the tool is felt as %.0f kg at least\n", log.felt_mass);

  Watch<N> watch(model, s);
  Steps<N> steps;
  examples::job::Progress progress(s.quiet);
  Nanoseconds first{}, sent_at{};
  const JointPosition<N> home(driver.newest().told);
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
    if constexpr (requires { out.command.torque; })
      for (std::size_t i = 0; i < N; ++i)
        log.bent = std::max(log.bent, std::abs(input.measured.q[i] - out.command.position[i]));
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
  if (s.robot == Robot::fri) {
    s.delay =
        s.fri_controller.arm.delay + 1.5 * 1e-3 * s.fri_controller.send_period * s.fri_controller.multiplier;
    s.lag = 0;
  }
  if (s.robot == Robot::franka) {
    s.delay = s.franka_controller.arm.delay + 1.5e-3;
    s.lag = 0;
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
  const Urdf urdf = read_urdf(!s.urdf.empty()            ? s.urdf
                              : s.robot == Robot::fri    ? SIMULATED_ARM_IIWA
                              : s.robot == Robot::franka ? SIMULATED_ARM_FR3
                                                         : COMPLIANT_ARM_URDF);
  const bool paced = !s.simulate || s.simulation.speed > 0;
  const adapters::ClockOptions options{.give_up = adapters::Timeout(paced ? 150 : 4000), .real_time = paced};
  if (paced) {
    const auto granted = request_real_time();
    if (!s.quiet) std::printf("%s", granted.report.c_str());
  }
  std::unique_ptr<simulated_arm::Controller> peer;
  Exit end = Exit::fine;
  const auto with = [&](auto& driver) { end = run_on<Stiff>(driver, s, urdf, stop, log); };
  const auto ended = [&](auto& controller) {
    controller->stop();
    log.last = controller->snapshot();
    if (!s.quiet && end != Exit::fine && !log.last.ended.empty())
      std::printf("the simulated controller: %s\n", log.last.ended.c_str());
  };
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
  } else if (s.robot == Robot::franka) {
    auto franka = s.franka;
    franka.stiffness = s.stiffness;
    std::unique_ptr<simulated_arm::SpringController> arm;
    if (s.simulate) {
      arm = franka_controller(calibrated_from<Chain<7>>(urdf), s.simulation, s.franka_controller, 0);
      franka.host = "127.0.0.1", franka.port = arm->port();
    }
    ClockedDriver driver(adapters::franka::Franka(franka), options);
    end = run_on<Springs>(driver, s, urdf, stop, log);
    if (arm) ended(arm);
  } else if (s.robot == Robot::fri) {
    auto fri = s.fri;
    if (s.simulate) fri.bind = "127.0.0.1", fri.port = 0;
    adapters::fri::Fri protocol(fri);
    std::unique_ptr<simulated_arm::SpringController> arm;
    if (s.simulate)
      arm = fri_controller(calibrated_from<Chain<7>>(urdf), s.simulation, s.fri_controller, "127.0.0.1",
                           protocol.socket().port());
    ClockedDriver driver(std::move(protocol), options);
    end = run_on<Springs>(driver, s, urdf, stop, log);
    if (arm) ended(arm);
  } else {
    auto stream = s.stream_motion;
    if (s.simulate) {
      peer = stream_motion_controller(s.simulation, s.stream_motion_controller, "127.0.0.1", 0);
      stream.host = "127.0.0.1", stream.port = peer->port();
    }
    ClockedDriver driver(adapters::stream_motion::StreamMotion(stream), options);
    with(driver);
  }
  if (peer) ended(peer);
  return end;
}

}  // namespace compliant_arm
