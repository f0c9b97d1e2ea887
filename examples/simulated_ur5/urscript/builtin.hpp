// Functions that the controller gives to programs: what one sees of the robot, and the tables of all.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "examples/simulated_ur5/arm.hpp"
#include "examples/simulated_ur5/notice.hpp"
#include "examples/simulated_ur5/state.hpp"
#include "examples/simulated_ur5/urscript/sockets.hpp"
#include "examples/simulated_ur5/urscript/value.hpp"
#include "examples/simulated_ur5/version.hpp"

namespace simulated_ur5::urscript {

/// `rtde_set_watchdog(variable, min_frequency, action)`.
struct Watchdog {
  std::string variable;
  double min_frequency = 10;
  bool stops = false;  ///< else pauses
};

/// Where the motion under way goes, and for movel and movec from where.
struct Line {
  Joints start{}, end{};
  std::optional<Pose6> goal{};  ///< of the last motion to a point
};

/// The robot as a program finds it in one cycle.
struct Robot {
  Arm& arm;
  RobotState& state;
  Sockets& sockets;
  std::optional<Watchdog>& watchdog;
  Line& line;
  Nanoseconds now, cycle;
  Version version;
  const std::function<void(const Notice&)>& tell;
  const std::function<void(const std::string&, std::int32_t code)>& protective_stop;
};

enum class Outcome {
  done,
  again,   ///< call it once more in the next cycle, with the same arguments
  failed,  ///< the program ends with `error`
  ended    ///< the program ends in peace
};

/// One call under way.
struct Call {
  std::string_view name;
  Robot& robot;
  std::span<const Value> arguments;  ///< by parameter; empty values were not given
  bool first;                        ///< false: it said `again`
  Nanoseconds& since;                ///< when it was called first
  int& stage;                        ///< 0 at first, then the function's own
  Value result{};
  std::string error{};

  const Value& operator[](std::size_t i) const {
    static const Value none;
    return i < arguments.size() ? arguments[i] : none;
  }
  double number(std::size_t i, double otherwise) const { return (*this)[i].number().value_or(otherwise); }
  /// The first argument as a place among `count`; none if it lies outside.
  std::optional<std::size_t> index(std::size_t count) const {
    const double i = number(0, -1);
    if (!(i >= 0 && i < static_cast<double>(count))) return std::nullopt;
    return static_cast<std::size_t>(i);
  }
  std::string text(std::size_t i, std::string otherwise = {}) const {
    const auto* s = (*this)[i].as<std::string>();
    return s ? *s : otherwise;
  }
  Outcome give(Value v) {
    result = std::move(v);
    return Outcome::done;
  }
  Outcome fail(std::string why) {
    error = std::move(why);
    return Outcome::failed;
  }
  /// Done when `seconds` have passed since the first call, a cycle at least.
  Outcome after(double seconds) const {
    const Nanoseconds wait = std::max(robot.cycle, seconds < 1e6 ? nanoseconds(seconds) : nanoseconds(1e6));
    return robot.now - since + robot.cycle / 2 > wait ? Outcome::done : Outcome::again;
  }
};

struct Builtin {
  std::string_view name;
  std::string_view parameters;  ///< names, blank between
  Outcome (*act)(Call&);
  bool moves = false;       ///< moves or waits: not for secondary programs
  bool any_number = false;  ///< takes arguments beside those that it names
  Version since{};
};

/// Null: there is none in this version of the controller.
const Builtin* find_builtin(std::string_view name, const Version& version);
std::vector<std::string> parameters_of(const Builtin& builtin);

// The tables, by what their functions are about.
std::span<const Builtin> arithmetic_functions();
std::span<const Builtin> text_functions();
std::span<const Builtin> pose_functions();
std::span<const Builtin> socket_functions();
std::span<const Builtin> state_functions();
std::span<const Builtin> setting_functions();
std::span<const Builtin> motion_functions();
std::span<const Builtin> unsimulated_functions();

}  // namespace simulated_ur5::urscript
