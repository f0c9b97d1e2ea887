// How well a joint law tracks on a UR5: the time base against its closed form, wrong inertial parameters and
// a cycle of delay against computed torque with PD and PID. `tracking [FOLDER]`, a few seconds; with a folder
// also two pictures of the tables: time_base.svg, parameters.svg.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "examples/support/svg_plot.hpp"
#include "skinctl/control/joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/plant.hpp"
#include "skinctl/tracking/adaptation.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
using Plant = CalibratedModel<ur5::Description>;
using K = Quantities<Arm, Needs{}>;
const Arm model;
const NoTouch none;
const JointPosition<6> home{0.3, -1.2, 1.4, -1.8, -1.4, 0.3};

/// The arm with all masses and moments of inertia `factor` times what the model says.
Plant wrong(double factor) {
  const auto right = calibrated_from<ur5::Description, double>();
  Plant::Links links{};
  for (std::size_t i = 0; i < 6; ++i) {
    links[i] = right.link(i);
    for (const auto p : {LinkParameter::mass, LinkParameter::s_xx, LinkParameter::s_yy, LinkParameter::s_zz,
                         LinkParameter::s_xy, LinkParameter::s_xz, LinkParameter::s_yz})
      links[i][p] *= factor;
  }
  return Plant(links);
}

/// Pictures go here, if anywhere.
std::string folder;
void draw(const char* name, const char* title, const std::vector<plotting::Plot>& plots) {
  if (!folder.empty() && !plotting::write_svg(folder + "/" + name, plotting::svg_figure(title, plots)))
    std::exit(1);
}
plotting::Plot axes(const char* title, const char* x_name, const char* y_name) {
  plotting::Plot plot;
  plot.title = title, plot.x_name = x_name, plot.y_name = y_name;
  return plot;
}

/// e(tb) / e(0) of the first joint's error, weight 1, from rest.
void time_base() {
  std::printf("error at tb over the closed form, x0 = 0.9 dq_max tb / 1.886 (at most 2 rad)\n%8s", "tb [s]");
  for (const double rate : {125.0, 500.0, 1000.0}) std::printf("%10g Hz", rate);
  std::printf("\n");
  auto plot = axes("Distance of the error at tb from its closed form", "tb [s]", "log10 of [%]");
  for (const char* rate : {"125 Hz", "500 Hz", "1000 Hz"}) plot.series.push_back({rate, {}, {}});
  plot.limits = {{0, "1 %"}};
  for (const double tb : {0.25, 0.5, 1.0, 2.0, 5.0, 10.0}) {
    std::printf("%8g", tb);
    for (const double rate : {125.0, 500.0, 1000.0}) {
      const double dt = 1 / rate, x0 = std::min(2.0, 0.9 * tb / 1.886);
      JointControlSettings<6> s{.dt = nanoseconds(dt), .K_i1 = 0, .K_i2 = 0, .tb = nanoseconds(tb)};
      const double peak = GainSchedule<double>(s.K_c, s.base, s.settle).largest(tb);
      s.lambda = 0.49 / dt - peak;
      if (s.lambda < 5) {
        std::printf("%13s", "refused");
        continue;
      }
      s.lambda = std::min(s.lambda, 0.25 / dt);
      const JointControl<6> law(s);
      State<6> x{0ns, home, {}};
      auto memory = law.start(K(model, x, dt, none));
      auto goal = home;
      goal[0] += x0;
      memory = law.receive(memory, K(model, x, dt, none), {goal, {}, {}}).memory;
      memory.bias.elapsed = clock_end;  // S(t0) = 0: no bumpless transfer
      for (int i = 0; i < static_cast<int>(std::lround(tb * rate)); ++i) {
        const auto out = evaluate(law, memory, K(model, x, dt, none), dt);
        memory = out.memory;
        x = simulate(model, x, out.torque, dt, 2);
      }
      const TimeBase<double> base;
      const double t_p = base.peak_time(), delta = 0.01, eps = 0.05;
      const double closed = std::pow((quintic(t_p).rest + delta) / (1 + delta), 1 + eps) *
                            std::exp(-base.peak_gain() * (1 - t_p));
      const double ratio = (goal[0] - x.q[0]) / x0 / closed;
      std::printf("%13.4f", ratio);
      auto& series = plot.series[rate < 200 ? 0 : rate < 700 ? 1 : 2];
      series.x.push_back(tb), series.y.push_back(std::log10(100 * std::abs(ratio - 1)));
    }
    std::printf("\n");
  }
  draw("time_base.svg", "The time base against its closed form", {plot});
}

struct Errors {
  double rms = 0, largest = 0;
};
/// Six joints go to and fro along quintics of 1.5 s, 8 s in all, the last half counts. `torque(x, t,
/// target)`.
template <class Torque>
Errors follow(const Plant& plant, double dt, int delay, Torque torque) {
  State<6> x{0ns, home, {}};
  std::vector<JointTorque<6>> pending(static_cast<std::size_t>(delay), gravity_torque(model, home));
  Errors e;
  int n = 0;
  const int steps = static_cast<int>(std::lround(9 / dt));
  for (int i = 0; i < steps; ++i) {
    const double t = i * dt;
    const int leg = static_cast<int>(t / 1.5);
    JointSpline<6> spline{home, home, 1.5};
    for (std::size_t j = 0; j < 6; ++j)
      (leg % 2 == 0 ? spline.q_g : spline.q_i)[j] += j % 2 == 0 ? 0.5 : -0.4;
    const auto target = spline.at(t - 1.5 * leg);
    if (i > steps / 2)
      for (std::size_t j = 0; j < 6; ++j) {
        const double d = x.q[j] - target.q_d[j];
        e.rms += d * d, ++n;
        e.largest = std::max(e.largest, std::abs(d));
      }
    pending.push_back(torque(x, target));
    x = simulate(plant, x, pending.front(), dt, 2);
    pending.erase(pending.begin());
  }
  e.rms = std::sqrt(e.rms / n);
  return e;
}
template <class L>
Errors with_law(const Plant& plant, double dt, int delay, const L& law) {
  State<6> x0{0ns, home, {}};
  auto memory = law.start(K(model, x0, dt, none));
  return follow(plant, dt, delay, [&](const State<6>& x, const JointReference<6>& target) {
    const K known(model, x, dt, none);
    memory = L::with_target(memory, target);
    const auto tau = law.torque(memory, known);
    memory = law.advance(memory, known, dt, Opposition::none);
    return tau;
  });
}

void parameters() {
  std::printf(
      "\nlargest tracking error [mrad], all masses and moments wrong by ..., 500 Hz, lambda 60, K_c 10;\n"
      "PD, PID: computed torque with the poles of the law without and with its integrals\n"
      "%-10s %-6s %12s %12s %12s %12s %12s\n",
      "wrong by", "delay", "PD", "PID", "no integral", "law", "adaptive");
  const double dt = 0.002;
  JointControlSettings<6> s{.dt = nanoseconds(dt), .lambda = 60, .tb = 0s};
  auto bare = s;
  bare.K_i1 = bare.K_i2 = 0;
  std::vector<plotting::Plot> plots{
      axes("No delay", "masses and inertias wrong by [%]", "largest error [mrad]"),
      axes("One cycle of delay", "masses and inertias wrong by [%]", "largest error [mrad]")};
  for (auto& plot : plots)
    for (const char* name :
         {"computed-torque PD", "computed-torque PID", "law without integral", "law", "adaptive law"})
      plot.series.push_back({name, {}, {}});
  for (const double part : {0.0, 0.01, 0.1, 0.3})
    for (const int delay : {0, 1}) {
      const auto plant = wrong(1 + part);
      // (s + 60)(s + 10)(s + K_i): the integrals of the law together are one of K_i1 + mu K_i2 about S = 0.
      const auto computed = [&](double K_i) {
        JointPosition<6> sum;
        return follow(plant, dt, delay, [&, sum](const State<6>& x, const JointReference<6>& target) mutable {
          JointAcceleration<6> a;
          for (std::size_t j = 0; j < 6; ++j) {
            const double e = x.q[j] - target.q_d[j], de = x.dq[j] - target.dq_d[j];
            a[j] = target.ddq_d[j] - (60 + 10 + K_i) * de - (60 * 10 + K_i * (60 + 10)) * e -
                   60 * 10 * K_i * sum[j];
            sum[j] += dt * e;
          }
          return mass_matrix(model, x.q) * a + bias_torque(model, JointAngles<Arm, double>(model, x.q), x.dq);
        });
      };
      const auto pd = computed(0), pid = computed(s.K_i1 + s.mu * s.K_i2);
      const auto plain = with_law(plant, dt, delay, JointControl<6>(bare));
      const auto law = with_law(plant, dt, delay, JointControl<6>(s));
      const auto adaptive = with_law(
          plant, dt, delay, Adaptive<JointControl<6>>(JointControl<6>(s), {10, deviations(model, 0.5)}));
      std::printf("%8g %% %-6d %12.4f %12.4f %12.4f %12.4f %12.4f\n", 100 * part, delay, 1e3 * pd.largest,
                  1e3 * pid.largest, 1e3 * plain.largest, 1e3 * law.largest, 1e3 * adaptive.largest);
      std::size_t k = 0;
      for (const auto& e : {pd, pid, plain, law, adaptive}) {
        auto& series = plots[static_cast<std::size_t>(delay)].series[k++];
        series.x.push_back(100 * part), series.y.push_back(1e3 * e.largest);
      }
    }
  draw("parameters.svg", "Tracking with wrong parameters", plots);
}
}  // namespace

int main(int count, char** arguments) {
  if (count > 1) folder = arguments[1];
  time_base();
  parameters();
}
