// What a robot that gives way can be, behind a delay: the least mass and friction with which it rests on a
// wall and between hands. To be read before a robot and a skin are bought; `StiffestContact` checks a whole
// scene.
#include <CLI/CLI.hpp>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "examples/support/program.hpp"
#include "examples/support/svg_plot.hpp"
#include "skinctl/passivity/detail/contact_modes.hpp"

namespace {

using namespace skinctl;

/// The way of a robot's answer; a mass moves along one contact.
struct Loop {
  double delay, lag, period, skin_delay;  ///< [ms]
  double margin = 2;                      ///< gain margin on a wall

  [[nodiscard]] RobotConfiguration<1> robot(double lead) const {
    const JointLimits<1> any({.lower = JointPosition<1>::constant(-1),
                              .upper = JointPosition<1>::constant(1),
                              .velocity = JointVelocity<1>::constant(1),
                              .acceleration = JointAcceleration<1>::constant(1),
                              .torque = JointTorque<1>::constant(1)});
    RobotConfiguration<1> c{.limits = any,
                            .period = nanoseconds(1e-3 * period),
                            .delay = nanoseconds(1e-3 * delay),
                            .lag = nanoseconds(1e-3 * lag)};
    c.force_lead = nanoseconds(lead * seconds<double>(c.delay + c.lag + 3 * c.period / 2));
    return c;
  }
  /// How many times too stiff a contact of `k` [N/m] is for a mass [kg] and a friction [N s/m]; before a body
  /// [kg], of which two grip; 0: a wall.
  [[nodiscard]] double lack(double mass, double friction, double k, double body, double lead) const {
    const detail::ContactPath<double> path(robot(lead), nanoseconds(1e-3 * skin_delay));
    MassMatrix<1> M, B;
    M(0, 0) = mass, B(0, 0) = friction;
    const detail::ContactModes<1, double> modes(M, B);
    const double one[1] = {1}, other[1] = {-1};
    double a[1], b[1];
    modes.row(one, a), modes.row(other, b);
    return lack_of(detail::ContactLoops<1, double>{modes, path, a, 1, body > 0 ? b : nullptr, 1}, k, body,
                   body > 0 ? 0.1 : 0.0, body > 0 ? 1.0 : margin);
  }
};

/// The smallest number in 1e-2 to 1e6 for which `lack(x) <= 1`, to 1 %; infinite if there is none.
template <class Lack>
double smallest(const Lack& lack) {
  double low = 1e-2, high = low;
  while (lack(high) > 1)
    if (low = high, high *= 1.5; high > 1e6) return std::numeric_limits<double>::infinity();
  while (high > 1.01 * low) {
    const double middle = std::sqrt(low * high);
    (lack(middle) > 1 ? low : high) = middle;
  }
  return high;
}

void print_table(const Loop& loop, const std::vector<double>& skins, double body, double friction) {
  const auto T = seconds<double>(loop.robot(0).delay + loop.robot(0).lag) + 1.5e-3 * loop.period;
  std::printf(
      "delay %.3g ms, lag %.3g ms, period %.3g ms, skin %.3g ms: %.3g ms in all\n"
      "least mass with %.3g N s/m of friction, on a wall and between two hands of %.3g kg; least friction of "
      "a light "
      "robot\nin brackets the effort of a hand at 0.26 m/s^2, or at 0.125 m/s\n\n"
      "| skin and cover [kN/m] | wall, force lead T | wall, 2 T | hands, T | wall, no lead | friction alone, "
      "no lead |\n"
      "|---|---|---|---|---|---|\n",
      loop.delay, loop.lag, loop.period, loop.skin_delay, 1e3 * T + loop.skin_delay, friction, body);
  const auto kilograms = [](double m) {
    if (std::isinf(m)) return std::string("none rests");
    char text[64];
    std::snprintf(text, sizeof text, "%.3g kg (%.2g N)", m, 0.26 * m);
    return std::string(text);
  };
  for (const double k : skins) {
    const auto mass = [&](double of, double lead) {
      return kilograms(smallest([&](double m) { return loop.lack(m, friction, 1e3 * k, of, lead); }));
    };
    const double b = smallest([&](double x) { return loop.lack(1, x, 1e3 * k, 0, 0); });
    std::printf("| %.3g | %s | %s | %s | %s | %.3g N s/m (%.2g N) |\n", k, mass(0, 1).c_str(),
                mass(0, 2).c_str(), mass(body, 1).c_str(), mass(0, 0).c_str(), b, 0.125 * b);
  }
}

/// The least mass over the delay, one line for each stiffness of the skin.
std::string picture(Loop loop, const std::vector<double>& skins, double body, double friction) {
  std::vector<plotting::Plot> plots(2);
  plots[0].title = "Least mass that rests on a wall, force lead T";
  plots[1].title = "Least mass that rests between two hands, force lead T";
  for (int i = 0; i < 2; ++i) {
    auto& plot = plots[static_cast<std::size_t>(i)];
    plot.x_name = "delay and lag [ms]";
    plot.y_name = "mass [kg]";
    for (const double k : skins) {
      char name[32];
      std::snprintf(name, sizeof name, "%.3g kN/m", k);
      plotting::Series line{.name = name, .x = {}, .y = {}};
      for (double both = 2; both <= 60; both += 2) {
        const double share = loop.delay + loop.lag > 0 ? loop.delay / (loop.delay + loop.lag) : 1;
        Loop other = loop;
        other.delay = share * both, other.lag = (1 - share) * both;
        const double m =
            smallest([&](double x) { return other.lack(x, friction, 1e3 * k, i == 0 ? 0 : body, 1); });
        line.x.push_back(both);
        line.y.push_back(m <= 200 ? m : std::numeric_limits<double>::quiet_NaN());
      }
      plot.series.push_back(line);
    }
  }
  return plotting::svg_figure("What a robot that gives way weighs at least", plots);
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"Says how heavy, or how slow, a robot that gives way has to be felt behind a delay."};
  Loop loop{8, 8, 8, 4};
  std::vector<double> skins{1, 3, 10, 30};
  double body = 5, friction = 30;
  std::string plot;
  const CLI::Range ms(0.0, 1000.0);
  app.add_option("--delay", loop.delay, "Dead time of the robot [ms]")->check(ms)->capture_default_str();
  app.add_option("--lag", loop.lag, "Time constant of its drives [ms]")->check(ms)->capture_default_str();
  app.add_option("--period", loop.period, "Of its commands [ms]")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  app.add_option("--skin-delay", loop.skin_delay, "Age of a reading when it is used [ms]")
      ->check(ms)
      ->capture_default_str();
  app.add_option("--skin", skins, "Stiffness of the skin's cover and of what it touches [kN/m]")
      ->check(CLI::Range(0.01, 1e4))
      ->capture_default_str();
  app.add_option("--body", body, "Mass of a hand that grips it [kg]")
      ->check(CLI::Range(0.01, 1e4))
      ->capture_default_str();
  app.add_option("--friction", friction, "That a hand feels [N s/m]")
      ->check(CLI::Range(0.1, 1e5))
      ->capture_default_str();
  app.add_option("--plot", plot, "SVG of the least mass over the delay");
  app.footer("Exit codes: 0 said, 1 the picture cannot be written, 2 an option is wrong");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  print_table(loop, skins, body, friction);
  return plot.empty() || plotting::write_svg(plot, picture(loop, skins, body, friction)) ? 0 : 1;
} catch (const std::exception& e) {
  std::fprintf(stderr, "contact_limits: %s\n", e.what());
  return 1;
}
