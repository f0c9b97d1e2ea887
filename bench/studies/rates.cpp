// One recorded contact at every rate: `rates [recording.csv]`, rows of time [s], force [N]. A UR5 by position
// commands, delay and lag 8 ms, pushed at the wrist as recorded; skin samples of 250 Hz taken linearly, the
// reference at 10 kHz. Beside it a resolver as the field has it: forward dynamics once a cycle with the
// newest sample, and 10 % of the velocity taken off every cycle.
//
// A path is compared twice. Commands, each with the reference's at the same instant: what the resolver
// computes. The real joints, at all times: they hold a position until the next one comes, so that half a
// period of rate invariance is lost between them, and a whole one more in the place of a cycle that did not
// come (2.4 rad/s times 8 ms: 0.8 % of the travel here), whoever computes the commands.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>

#include "tests/support/closed_loop.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::array<double, 6> pose{0.1, -1.5, 1.2, -1, -1.5, 0.3};
constexpr double lever[6] = {0.5, 0.4, 0.3, 0.01, 0.003, 0};  ///< of the push [m]
constexpr double delay = 0.008, lag = 0.008;
/// 10 % a cycle at 500 Hz, as a rate [1/s].
const double decay = -500 * std::log(0.9);

/// A force over time, linear between samples, and its integral.
class Recording {
 public:
  Recording(const std::vector<double>& time, const std::vector<double>& force) : time_(time), force_(force) {
    sum_.push_back(0);
    for (std::size_t i = 1; i < time_.size(); ++i)
      sum_.push_back(sum_.back() + 0.5 * (force_[i] + force_[i - 1]) * (time_[i] - time_[i - 1]));
  }
  double force(double t) const { return value(t, false); }
  double integral(double t) const { return value(t, true); }
  double end() const { return time_.back(); }
  /// As a skin of `rate` sends it.
  Recording sampled(double rate) const {
    std::vector<double> t, f;
    for (double x = 0; x <= end() + 1 / rate; x += 1 / rate) t.push_back(x), f.push_back(force(x));
    return {t, f};
  }

 private:
  double value(double t, bool integral) const {
    if (t <= time_.front()) return 0;
    if (t >= time_.back()) return integral ? sum_.back() : 0;
    const auto i = static_cast<std::size_t>(std::upper_bound(time_.begin(), time_.end(), t) - time_.begin());
    const double part = (t - time_[i - 1]) / (time_[i] - time_[i - 1]);
    const double f = force_[i - 1] + part * (force_[i] - force_[i - 1]);
    return integral ? sum_[i - 1] + 0.5 * (force_[i - 1] + f) * (t - time_[i - 1]) : f;
  }
  std::vector<double> time_, force_, sum_;
};

using Joints = std::array<double, 6>;

double distance(const Joints& a, const Joints& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

/// What disturbs the cycles.
struct Cycles {
  const char* name;
  double skipped = 0;  ///< share of them that do not come: nothing is read, nothing is sent
  double jitter = 0;   ///< width of the window in which one comes, in periods
};

/// When the cycles come.
template <class F>
void cycles(Nanoseconds period, const Cycles& c, double time, F&& f) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (Nanoseconds planned = period; planned < nanoseconds(time); planned += period) {
    const bool skips = unit(rng) < c.skipped;
    const double off = c.jitter * (unit(rng) - 0.5);
    if (!skips) f(planned + nanoseconds(off * seconds<double>(period)));
  }
}

/// What was commanded when, and where the real joints were every 2 ms.
struct Path {
  std::vector<Nanoseconds> time;
  std::vector<Joints> command, joints;

  void until(Nanoseconds now, SimulatedJoints<6>& robot) {
    for (; next_ <= now; next_ += 2ms) robot.advance(seconds<double>(next_)), joints.push_back(robot.q());
  }
  void sent(Nanoseconds now, const Joints& q) { time.push_back(now), command.push_back(q); }
  /// The command in force between two instants, for a reference whose cycles lie close.
  [[nodiscard]] Joints at(Nanoseconds t) const {
    const auto after = std::upper_bound(time.begin(), time.end(), t);
    if (after == time.end()) return command.back();
    if (after == time.begin()) return command.front();
    const auto k = static_cast<std::size_t>(after - time.begin());
    const double part = seconds<double>(t - time[k - 1]) / seconds<double>(time[k] - time[k - 1]);
    Joints q;
    for (std::size_t i = 0; i < 6; ++i) q[i] = command[k - 1][i] + part * (command[k][i] - command[k - 1][i]);
    return q;
  }

 private:
  Nanoseconds next_ = 2ms;
};

template <class Integrator>
Path skinctl_path(const Recording& push, Nanoseconds period, const Cycles& how) {
  RobotConfiguration<6> c{
      .limits = limits_of<ur5::Description>(1000.0), .period = period, .delay = nanoseconds(delay)};
  c.lag = nanoseconds(lag);
  c.virtual_damping = decay;
  c.longest_interval = 10 * period;
  ClosedLoop<Interface::position, double, Integrator> loop(c, pose, delay, lag);
  Path path;
  cycles(period, how, push.end() + 1, [&](Nanoseconds now) {
    path.until(now, loop.joints);
    const auto out = loop.step(now, [&](double t) {
      Joints moment{};
      for (std::size_t i = 0; i < 6; ++i) moment[i] = lever[i] * push.integral(t);
      return moment;
    });
    Joints q;
    for (std::size_t i = 0; i < 6; ++i) q[i] = out.command.position[i];
    path.sent(now, q);
  });
  return path;
}

/// Forward dynamics once a cycle: the newest sample, the planned period, 10 % off the velocity.
Path per_cycle_path(const Recording& push, Nanoseconds period, const Cycles& how) {
  SimulatedJoints<6> joints(SimulatedJoints<6>::Kind::position, delay, lag, pose);
  JointPosition<6> q(pose);
  JointVelocity<6> v;
  Path path;
  const double h = seconds<double>(period);
  cycles(period, how, push.end() + 1, [&](Nanoseconds now) {
    path.until(now, joints);
    const double t = seconds<double>(now);
    joints.advance(t);
    JointTorque<6> tau =
        -1.0 * coriolis_torque(ur5::Model{}, JointAngles<ur5::Model, double>(ur5::Model{}, q), v);
    for (std::size_t i = 0; i < 6; ++i) tau[i] += lever[i] * push.force(t);
    const auto m = mass_matrix(ur5::Model{}, q);
    const math::Ldlt<6> factors(m.data);
    JointAcceleration<6> a;
    factors.solve(tau.data, a.data);
    for (std::size_t i = 0; i < 6; ++i) {
      v[i] = 0.9 * (v[i] + h * a[i]);
      q[i] += h * v[i];
    }
    Joints row;
    for (std::size_t i = 0; i < 6; ++i) row[i] = q[i];
    joints.command(t, row);
    path.sent(now, row);
  });
  return path;
}

Recording read(const std::string& file) {
  std::ifstream in(file);
  std::vector<double> time, force;
  for (std::string line; std::getline(in, line);) {
    double t = 0, f = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf", &t, &f) == 2) time.push_back(t), force.push_back(f);
  }
  if (time.size() < 2) throw ConfigurationError(file + ": no rows of time,force");
  return {time, force};
}

/// How far a path is from the reference, as shares of the travel.
struct Errors {
  double end = 0, command = 0, joints = 0;

  Errors(const Path& path, const Path& reference, double travel) {
    for (std::size_t k = 0; k < path.command.size(); ++k)
      command = std::max(command, distance(path.command[k], reference.at(path.time[k])) / travel);
    const std::size_t n = std::min(path.joints.size(), reference.joints.size());
    for (std::size_t k = 0; k < n; ++k)
      joints = std::max(joints, distance(path.joints[k], reference.joints[k]) / travel);
    end = distance(path.joints[n - 1], reference.joints[n - 1]) / travel;
  }
};

}  // namespace

int main(int argc, char** argv) {
  const Recording push = read(argc > 1 ? argv[1] : "examples/compliant_ur5/profiles/push.csv");
  const Recording skin = push.sampled(250);
  const Path reference = skinctl_path<CrankNicolson>(push, 100us, {"none"});
  double travel = 0, fastest = 0;
  for (std::size_t k = 0; k < reference.command.size(); ++k) {
    travel = std::max(travel, distance(reference.command[k], pose));
    if (k > 0) fastest = std::max(fastest, distance(reference.command[k], reference.command[k - 1]) / 1e-4);
  }
  std::printf(
      "%.1f s, %.3f rad of travel, up to %.2f rad/s\n\n"
      "| resolver | rate [Hz] | cycles | end off by | commands off by | joints off by "
      "|\n|---|---|---|---|---|---|\n",
      push.end(), travel, fastest);
  const auto row = [&](const char* name, Nanoseconds period, const Cycles& how, const Path& path) {
    const Errors e(path, reference, travel);
    std::printf("| %s | %.0f | %s | %.2f %% | %.2f %% | %.2f %% |\n", name, 1 / seconds<double>(period),
                how.name, 100 * e.end, 100 * e.command, 100 * e.joints);
  };
  for (const Nanoseconds period : {8ms, 4ms, 2ms, 1ms})
    for (const Cycles& how : {Cycles{"as planned"}, Cycles{"10 % skipped", 0.1},
                              Cycles{"+-40 % jitter", 0, 0.8}, Cycles{"both", 0.1, 0.8}}) {
      row("Crank-Nicolson", period, how, skinctl_path<CrankNicolson>(skin, period, how));
      row("semi-implicit Euler", period, how, skinctl_path<SemiImplicitEuler>(skin, period, how));
      row("damping per cycle", period, how, per_cycle_path(push, period, how));
    }
}
