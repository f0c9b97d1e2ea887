// One recorded contact at every rate: `rates [recording.csv]`, rows of time [s], force [N]. A UR5 by position
// commands, delay and lag 8 ms, pushed at the wrist as recorded; skin samples of 250 Hz taken linearly, the
// reference at 10 kHz. Beside it a resolver as the field has it: forward dynamics once a cycle with the
// newest sample, and 10 % of the velocity taken off every cycle.
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/resolver/closed_loop.hpp"

using namespace skinctl;
using namespace skinctl::test;

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

using Path = std::vector<std::array<double, 6>>;

/// When the cycles come, with a share of them left out.
template <class F>
void cycles(Nanoseconds period, double skipped, double time, F&& f) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (Nanoseconds now = period; now < nanoseconds(time); now += period)
    if (!(unit(rng) < skipped)) f(now);
}

/// The real joints every 20 ms.
struct Watch {
  Path path;
  Nanoseconds next = 20_ms;
  void until(Nanoseconds now, SimulatedJoints<6>& joints) {
    for (; next <= now; next += 20_ms) joints.advance(seconds<double>(next)), path.push_back(joints.q());
  }
};

template <class Integrator>
Path skinctl_path(const Recording& push, Nanoseconds period, double skipped) {
  ResolverConfiguration<6> c{
      .limits = limits_of<ur5::Description>(1000.0), .period = period, .delay = nanoseconds(delay)};
  c.lag = lag;
  c.shape.decay = decay;
  c.longest_interval = 10 * period;
  ClosedLoop<Interface::position, double, Integrator> loop(c, pose, delay, lag);
  Watch watch;
  cycles(period, skipped, push.end() + 1, [&](Nanoseconds now) {
    watch.until(now, loop.joints);
    loop.step(now, [&](double t) {
      std::array<double, 6> out{};
      for (std::size_t i = 0; i < 6; ++i) out[i] = lever[i] * push.integral(t);
      return out;
    });
  });
  return watch.path;
}

/// Forward dynamics once a cycle: the newest sample, the planned period, 10 % off the velocity.
Path per_cycle_path(const Recording& push, Nanoseconds period, double skipped) {
  SimulatedJoints<6> joints(SimulatedJoints<6>::Kind::position, delay, lag, pose);
  JointPosition<6> q(pose);
  JointVelocity<6> v;
  Watch watch;
  const double h = seconds<double>(period);
  cycles(period, skipped, push.end() + 1, [&](Nanoseconds now) {
    watch.until(now, joints);
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
    SimulatedJoints<6>::Row row;
    for (std::size_t i = 0; i < 6; ++i) row[i] = q[i];
    joints.command(t, row);
  });
  return watch.path;
}

double distance(const std::array<double, 6>& a, const std::array<double, 6>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
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

}  // namespace

int main(int argc, char** argv) {
  const Recording push = read(argc > 1 ? argv[1] : "examples/compliant_ur5/profiles/push.csv");
  const Recording skin = push.sampled(250);
  const Path reference = skinctl_path<CrankNicolson>(push, 100_us, 0);
  double travel = 0;
  for (const auto& q : reference) travel = std::max(travel, distance(q, pose));
  std::printf(
      "%.1f s, %.3f rad of travel\n\n| resolver | rate [Hz] | skipped | end off by | path off by |\n"
      "|---|---|---|---|---|\n",
      push.end(), travel);
  const auto row = [&](const char* name, Nanoseconds period, double skipped, const Path& path) {
    double worst = 0;
    const std::size_t n = std::min(path.size(), reference.size());
    for (std::size_t k = 0; k < n; ++k) worst = std::max(worst, distance(path[k], reference[k]));
    std::printf("| %s | %.0f | %.0f %% | %.2f %% | %.2f %% |\n", name, 1 / seconds<double>(period),
                100 * skipped, 100 * distance(path[n - 1], reference[n - 1]) / travel, 100 * worst / travel);
  };
  for (const Nanoseconds period : {8_ms, 4_ms, 2_ms, 1_ms})
    for (const double skipped : {0.0, 0.1}) {
      row("Crank-Nicolson", period, skipped, skinctl_path<CrankNicolson>(skin, period, skipped));
      row("implicit friction", period, skipped, skinctl_path<ImplicitFriction>(skin, period, skipped));
      row("semi-implicit Euler", period, skipped, skinctl_path<SemiImplicitEuler>(skin, period, skipped));
      row("damping per cycle", period, skipped, per_cycle_path(push, period, skipped));
    }
}
