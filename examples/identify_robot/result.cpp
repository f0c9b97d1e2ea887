#include "examples/identify_robot/result.hpp"

#include <utility>

#include "examples/support/text.hpp"
#include "skinctl/calibration/robot_response.hpp"
#include "skinctl/robots/ur5.hpp"

namespace identify_robot {
using examples::text;
namespace {

using skinctl::Estimate;

std::string value(const Estimate& e, double unit, const char* name) {
  if (!e.known()) return "not known";
  return text("%.2f +- %.2f %s", e.value / unit, e.deviation / unit, name);
}

}  // namespace

Response identify(const Log& log) {
  return skinctl::identify_response(skinctl::ur5::Model{}, log);
}

std::string why_unusable(const Response& found) {
  constexpr double longest_period = 0.1,
                   fastest = 4 * 3.1416;      // [s], [rad/s]: a UR turns at most by half of that
  constexpr double largest_deviation = 5e-3;  // [s]: more of delay than a governor's margins hold at 125 Hz
  if (!(found.period > 1e-4 && found.period <= longest_period))
    return text("measurements come every %.4g s, allowed: 0.0001 to %g; are their times in seconds?",
                found.period, longest_period);
  for (std::size_t i = 0; i < 6; ++i)
    if (found.joint[i].speed > fastest)
      return text("joint %zu moves at %.4g rad/s, allowed: at most %.3g; are its angles in radians?", i,
                  found.joint[i].speed, fastest);
  if (!found.total_delay.known()) return "the commands hardly move the robot: nothing is known of its delay";
  const std::pair<const char*, Estimate> all[] = {
      {"delay", found.delay}, {"lag", found.lag}, {"delay and lag", found.total_delay}};
  for (const auto& [name, e] : all)
    if (!(e.deviation <= largest_deviation))
      return text(
          "%s: known to %.3g ms only, allowed: %g ms; does the log hold the commands that the robot got, on "
          "the clock of its measurements?",
          name, e.deviation / 1e-3, largest_deviation / 1e-3);
  return {};
}

std::string in_words(const Response& found) {
  std::string out;
  out += "delay            " + value(found.delay, 1e-3, "ms") + "\n";
  out += "lag              " + value(found.lag, 1e-3, "ms") + "\n";
  out += "both             " + value(found.total_delay, 1e-3, "ms") + "\n";
  out += text("measurements     every %.3f ms, jitter %.3f ms, %.1f %% skipped\n\n", 1e3 * found.period,
              1e3 * found.jitter, 100 * found.skipped);
  out +=
      "joint  gap [mrad]         stiffness [N m/rad]  hysteresis [mrad]  noise [mrad]  step [mrad]  speed "
      "[rad/s]\n";
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& j = found.joint[i];
    std::string stiffness = "not known";
    if (j.compliance.known())
      stiffness = j.compliance.value > 2 * j.compliance.deviation
                      ? text("%.0f", 1 / j.compliance.value)
                      : text("> %.0f", 1 / (std::abs(j.compliance.value) + 2 * j.compliance.deviation));
    const std::string hysteresis =
        j.hysteresis.known() ? text("%.3f +- %.3f", 1e3 * j.hysteresis.value, 1e3 * j.hysteresis.deviation)
                             : "not known";
    out += text("%5zu  %8.3f +- %-6.3f  %-19s  %-17s  %12.4f  %11.4f  %13.2f\n", i, 1e3 * j.gap.value,
                1e3 * j.gap.deviation, stiffness.c_str(), hysteresis.c_str(), 1e3 * j.noise,
                1e3 * j.resolution, j.speed);
  }
  out += "\n";
  double gap = 0;
  for (const auto& j : found.joint)
    if (std::abs(j.gap.value) > 2 * j.gap.deviation) gap = std::max(gap, std::abs(j.gap.value));
  if (gap > 0.02)
    out += text(
        "A joint stands %.0f mrad beside its commands: look for a servo that droops, or an encoder with an "
        "offset. Beyond the dead band a scene asks for consent.\n",
        1e3 * gap);
  if (found.skipped > 0.05)
    out += "More than one measurement in twenty does not come: look at the connection.\n";
  return out;
}

std::string as_toml(const Response& found) {
  std::string out = "# What examples/identify_robot found. Seconds, radians, newton metres.\n[control]\n";
  if (found.total_delay.known()) {
    out += text("delay = %.6f\nlag = %.6f\n", found.delay.value, found.lag.value);
  }
  out += "\n[robot_found]\n";
  const auto number = [&](const char* name, const Estimate& e) {
    if (e.known()) out += text("%s = %.9g\n%s_deviation = %.9g\n", name, e.value, name, e.deviation);
  };
  number("delay", found.delay);
  number("lag", found.lag);
  number("delay_and_lag", found.total_delay);
  out += text("period = %.9g\njitter = %.9g\nskipped = %.9g\n", found.period, found.jitter, found.skipped);
  const auto row = [&](const char* name, auto&& of) {
    out += std::string(name) + " = [";
    for (std::size_t i = 0; i < 6; ++i) {
      const double x = of(found.joint[i]);
      out += (i == 0 ? "" : ", ") + (std::isfinite(x) ? text("%.9g", x) : std::string("inf"));
    }
    out += "]\n";
  };
  using Joint = Response::Joint;
  row("gap", [](const Joint& j) { return j.gap.value; });
  row("gap_deviation", [](const Joint& j) { return j.gap.deviation; });
  row("compliance", [](const Joint& j) { return j.compliance.value; });
  row("compliance_deviation", [](const Joint& j) { return j.compliance.deviation; });
  row("hysteresis", [](const Joint& j) { return j.hysteresis.value; });
  row("hysteresis_deviation", [](const Joint& j) { return j.hysteresis.deviation; });
  row("noise", [](const Joint& j) { return j.noise; });
  row("resolution", [](const Joint& j) { return j.resolution; });
  row("speed", [](const Joint& j) { return j.speed; });
  return out;
}

}  // namespace identify_robot
