#include "examples/adapters/gripper/robotiq.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "skinctl/core/contract.hpp"

namespace adapters::gripper {
namespace {

constexpr std::array<const char*, 4> asked{"PRE", "OBJ", "POS", "FLT"};

int scaled(double x, double from, double to) noexcept {
  return to > from ? static_cast<int>(std::lround(255 * (x - from) / (to - from))) : 255;
}

}  // namespace

std::optional<RobotiqAnswer> parse_robotiq(std::string_view line) noexcept {
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  RobotiqAnswer out;
  if (line == "ack") {
    out.acknowledged = true;
    return out;
  }
  const auto space = line.find(' ');
  if (space != 3) return std::nullopt;
  for (const char c : line.substr(0, space))
    if (c < 'A' || c > 'Z') return std::nullopt;
  out.variable = line.substr(0, space);
  const char* const end = line.data() + line.size();
  const auto [at, error] = std::from_chars(line.data() + space + 1, end, out.value);
  if (error != std::errc() || at != end || out.value < 0 || out.value > 255) return std::nullopt;
  return out;
}

Robotiq::Robotiq(const RobotiqConfig& config) : config_(config), dialogue_(config.patience) {
  skinctl::require(config.range.opening > 0, "the opening of a Robotiq", config.range.opening, "above 0 [m]");
  skinctl::require(config.count_open >= 0 && config.count_open < config.count_closed,
                   "the count of open fingers", config.count_open,
                   "at least 0 and less than that of closed ones");
  skinctl::require(config.count_closed <= 255, "the count of closed fingers", config.count_closed,
                   "at most 255");
}

Robotiq::Counts Robotiq::counts(const skinctl::GripperGoal& goal) const noexcept {
  const auto& r = config_.range;
  const double share = 1 - goal.opening / r.opening;
  return {
      config_.count_open + static_cast<int>(std::lround(share * (config_.count_closed - config_.count_open))),
      scaled(goal.speed, r.min_speed, r.max_speed), scaled(goal.force, r.min_force, r.max_force)};
}

bool Robotiq::tell(std::string_view line) noexcept {
  return stream_.write({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, Timeout(20));
}

bool Robotiq::next_line(std::string_view& line, Timeout timeout) noexcept {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (!lines_.next(line)) {
    const auto left = std::chrono::ceil<Timeout>(deadline - std::chrono::steady_clock::now());
    std::size_t n = 0;
    const Read read = stream_.read_some(lines_.room(), n, std::max(left, Timeout(0)));
    if (read == Read::closed) stream_.close();
    if (read != Read::some) return false;
    lines_.wrote(n);
  }
  return true;
}

template <class Is>
RobotiqAnswer Robotiq::expect(const std::string& question, const Is& is) {
  const auto deadline = std::chrono::steady_clock::now() + config_.connect_timeout;
  if (tell(question + "\n"))
    for (std::string_view line;
         next_line(line, std::chrono::ceil<Timeout>(deadline - std::chrono::steady_clock::now()));)
      if (const auto answer = parse_robotiq(line); answer && is(*answer)) return *answer;
  throw ConnectionError("the gripper does not answer " + question);
}
int Robotiq::get(const char* variable) {
  return expect(std::string("GET ") + variable,
                [&](const RobotiqAnswer& a) { return a.variable == variable; })
      .value;
}
void Robotiq::set(const std::string& what) {
  expect("SET " + what, [](const RobotiqAnswer& a) { return a.acknowledged; });
}

void Robotiq::connect() {
  stream_.connect(config_.host, config_.port, "the gripper", config_.connect_timeout);
  lines_.clear();
  const auto until = [&](int status) {
    const auto deadline = std::chrono::steady_clock::now() + config_.activate_timeout;
    while (get("STA") != status)
      if (std::chrono::steady_clock::now() > deadline)
        throw ConnectionError("the gripper does not become active: look at its lamp and its power");
  };
  if (get("STA") != 3) {
    if (!config_.activate)
      throw ConnectionError("the gripper is not active, and nobody asked to activate it");
    set("ACT 0");
    set("ATR 0");
    until(0);
    set("ACT 1");
    until(3);
  }
  state_ = {};
  dialogue_ = Dialogue(config_.patience);
  connected_ = true;
  pending_ = halt_ = halted_ = false;
  taken_ = true;  // where it stands is where it shall be
  wanted_.position = get("PRE");
}

bool Robotiq::move(const skinctl::GripperGoal& goal) noexcept {
  if (!connected_ || !finite(goal)) return false;
  goal_ = limited(goal, config_.range);
  wanted_ = counts(goal_);
  pending_ = true;
  taken_ = false;
  state_.moving = true;
  state_.holding = false;
  state_.force = 0;
  return true;
}

void Robotiq::stop() noexcept {
  pending_ = false;
  halt_ = connected_;
}

void Robotiq::ask() noexcept {
  std::array<char, 64> line;
  int n = 0;
  if (halt_) {
    n = std::snprintf(line.data(), line.size(), "SET GTO 0\n");
  } else if (pending_) {
    n = std::snprintf(line.data(), line.size(), "SET GTO 1 SPE %d FOR %d POS %d\n", wanted_.speed,
                      wanted_.force, wanted_.position);
  } else {
    n = std::snprintf(line.data(), line.size(), "GET %s\n", asked[turn_]);
  }
  if (tell({line.data(), static_cast<std::size_t>(n)})) {
    dialogue_.asked();
    told_ = halt_ || pending_;
    if (halt_)
      halt_ = false, halted_ = true, state_.moving = false;
    else if (pending_)
      pending_ = halted_ = false, turn_ = 0;
  }
}

void Robotiq::hear(std::string_view line, skinctl::Nanoseconds now) noexcept {
  const auto answer = parse_robotiq(line);
  const bool expected =
      answer && dialogue_.waiting() && (told_ ? answer->acknowledged : answer->variable == asked[turn_]);
  if (!expected) {
    ++nonsense_;
    return;
  }
  dialogue_.heard();
  if (told_ || pending_) return;  // it speaks of the goal before
  switch (turn_) {
    case 0:
      taken_ = taken_ || answer->value == wanted_.position;
      break;
    case 1:
      object_ = answer->value;
      break;
    case 2: {
      const double share = static_cast<double>(answer->value - config_.count_open) /
                           (config_.count_closed - config_.count_open);
      state_.opening = config_.range.opening * (1 - std::min(std::max(share, 0.0), 1.0));
      state_.measured = state_.heard = true;
      state_.time = now;
      if (taken_ || halted_) {  // OBJ is from before POS: where it rests now is where it came to rest
        state_.moving = object_ == 0 && !halted_;
        state_.holding = object_ == 1 || object_ == 2;
        state_.force = state_.holding ? goal_.force : 0;
      }
      break;
    }
    default:
      state_.code = static_cast<std::uint16_t>(answer->value);
      break;
  }
  turn_ = (turn_ + 1) % asked.size();
}

skinctl::GripperState Robotiq::poll(skinctl::Nanoseconds now) noexcept {
  if (connected_) {
    dialogue_.at(now);
    std::string_view line;
    for (int k = 0; k < 16 && next_line(line, Timeout(0)); ++k) hear(line, now);
    if (dialogue_.overdue()) {  // a goal or a stop that was not acknowledged may not have been heard
      dialogue_.give_up_waiting();
      lines_.clear();  // half an answer would spoil the next one
      if (told_ && !pending_) (halted_ ? halt_ : pending_) = true;
    }
    if (!dialogue_.waiting()) ask();
    if (!stream_.is_open() || dialogue_.error() == skinctl::GripperError::lost) {
      stream_.close();
      connected_ = false;
    }
  }
  skinctl::GripperState out = state_;
  out.error = !connected_        ? skinctl::GripperError::lost
              : state_.code != 0 ? skinctl::GripperError::fault
                                 : dialogue_.error();
  return out;
}

}  // namespace adapters::gripper
