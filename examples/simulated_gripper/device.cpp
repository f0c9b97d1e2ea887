#include "examples/simulated_gripper/device.hpp"

#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include "examples/adapters/gripper/lacquey.hpp"
#include "examples/adapters/gripper/onrobot.hpp"

namespace simulated_gripper {
namespace {

constexpr double tick = 0.001;
constexpr std::size_t most_ticks = 20000;

/// In steps of a millisecond, however long nobody asked.
void move(Fingers& fingers, double& now, double to) {
  for (std::size_t k = 0; k < most_ticks && to - now > tick; ++k, now += tick) fingers.step(tick);
  if (to > now) {
    fingers.step(to - now);
    now = to;
  }
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> out;
  while (!line.empty() && out.size() < 32) {
    const auto end = line.find_first_of(" \t\r");
    if (end != 0) out.push_back(line.substr(0, end));
    line.remove_prefix(end == std::string_view::npos ? line.size() : end + 1);
  }
  return out;
}

}  // namespace

void RobotiqDevice::advance(double now) {
  if (!std::exchange(started_, true)) now_ = now;
  move(fingers_, now_, now);
  int& status = variables_["STA"];
  if (variables_["ACT"] == 0)
    status = 0;
  else if (status != 3)
    status = now_ >= active_at_ ? 3 : 1;
}

std::string RobotiqDevice::answer(std::string_view line, double now) {
  advance(now);
  const auto words = words_of(line);
  if (words.size() == 2 && words[0] == "GET") {
    const auto found = variables_.find(words[1]);
    if (found == variables_.end()) return "?\n";
    int value = found->second;
    if (words[1] == "POS") value = static_cast<int>(std::lround(255 * (1 - fingers_.opening() / opening)));
    if (words[1] == "OBJ") value = fingers_.moving() ? 0 : fingers_.holding() ? 2 : 3;
    return found->first + " " + std::to_string(value) + "\n";
  }
  if (words.size() >= 3 && words.size() % 2 == 1 && words[0] == "SET") {
    for (std::size_t k = 1; k < words.size(); k += 2) {
      const auto found = variables_.find(words[k]);
      int value = -1;
      const auto [at, error] =
          std::from_chars(words[k + 1].data(), words[k + 1].data() + words[k + 1].size(), value);
      if (found == variables_.end() || words[k] == "STA" || words[k] == "OBJ" || words[k] == "FLT" ||
          words[k] == "PRE" || error != std::errc() || at != words[k + 1].data() + words[k + 1].size() ||
          value < 0 || value > 255)
        return "?\n";
      if (words[k] == "ACT" && value == 1 && found->second == 0) active_at_ = now_ + activation;
      found->second = value;
    }
    if (variables_["STA"] == 3 && variables_["GTO"] == 1) {
      variables_["PRE"] = variables_["POS"];
      fingers_.go(opening * (1 - variables_["POS"] / 255.0), 20 + 215 * variables_["FOR"] / 255.0,
                  0.02 + 0.13 * variables_["SPE"] / 255.0);
    } else {
      fingers_.halt();
    }
    return "ack";  // without a line end, as the device sends it
  }
  return "?\n";
}

void OnRobotDevice::advance(double now) {
  if (!std::exchange(started_, true)) now_ = now;
  move(fingers_, now_, now);
}

int OnRobotDevice::value_at(std::uint16_t at) const {
  namespace rg = adapters::gripper::rg;
  const int width = static_cast<int>(std::lround(1e4 * fingers_.opening()));
  switch (at) {
    case rg::target_force:
      return force_;
    case rg::target_force + 1:
      return width_;
    case rg::fingertip:
      return static_cast<std::uint16_t>(offset_);
    case rg::width:
      return width;
    case rg::tip_width:
      return static_cast<std::uint16_t>(width - 2 * offset_);
    case rg::status:
      return (fingers_.moving() ? rg::busy : 0) | (fingers_.holding() ? rg::gripping : 0) | safety_;
    default:
      return -1;
  }
}

void OnRobotDevice::write(std::uint16_t at, std::uint16_t value) {
  namespace rg = adapters::gripper::rg;
  if (at == rg::target_force) force_ = value;
  if (at == rg::target_force + 1) width_ = value;
  if (at != rg::target_force + 2) return;
  if (value == rg::halt) fingers_.halt();
  if ((value != rg::grip && value != rg::grip_tips) || safety_ != 0 || fingers_.moving()) return;
  fingers_.go(1e-4 * (width_ + (value == rg::grip_tips ? 2 * offset_ : 0)), 0.1 * force_, speed);
}

adapters::gripper::modbus::Bytes OnRobotDevice::answer(const adapters::gripper::modbus::Frame& frame,
                                                       double now) {
  namespace modbus = adapters::gripper::modbus;
  namespace rg = adapters::gripper::rg;
  constexpr std::uint8_t no_function = 1, no_address = 2, bad_value = 3;
  advance(now);
  const auto refuse = [&](std::uint8_t why) {
    modbus::Bytes out(frame.transaction, frame.unit, static_cast<std::uint8_t>(frame.function | 0x80));
    return out.u8(why);
  };
  if (frame.unit != rg::unit) return refuse(0x0b);
  if (frame.function == modbus::read_registers) {
    if (frame.data.size() != 4) return refuse(bad_value);
    const std::uint16_t first = modbus::u16_at(frame.data, 0), count = modbus::u16_at(frame.data, 2);
    if (count == 0 || count > modbus::most_registers) return refuse(bad_value);
    modbus::Bytes out(frame.transaction, frame.unit, frame.function);
    out.u8(static_cast<std::uint8_t>(2 * count));
    for (std::uint32_t k = first; k < first + std::uint32_t{count}; ++k) {
      const int value = k > 0xffff ? -1 : value_at(static_cast<std::uint16_t>(k));
      if (value < 0) return refuse(no_address);
      out.u16(static_cast<std::uint16_t>(value));
    }
    return out;
  }
  if (frame.function == modbus::write_registers) {
    if (frame.data.size() < 5) return refuse(bad_value);
    const std::uint16_t first = modbus::u16_at(frame.data, 0), count = modbus::u16_at(frame.data, 2);
    if (count == 0 || frame.data[4] != 2 * count || frame.data.size() != 5u + 2u * count)
      return refuse(bad_value);
    if (first + count > 3) return refuse(no_address);
    for (std::uint16_t k = 0; k < count; ++k)
      write(static_cast<std::uint16_t>(first + k), modbus::u16_at(frame.data, 5 + 2u * k));
    modbus::Bytes out(frame.transaction, frame.unit, frame.function);
    return out.u16(first).u16(count);
  }
  if (frame.function == modbus::write_register) {
    if (frame.data.size() != 4) return refuse(bad_value);
    const std::uint16_t at = modbus::u16_at(frame.data, 0), value = modbus::u16_at(frame.data, 2);
    if (at > rg::target_force + 2) return refuse(no_address);
    write(at, value);
    modbus::Bytes out(frame.transaction, frame.unit, frame.function);
    return out.u16(at).u16(value);
  }
  return refuse(no_function);
}

void LacqueyDevice::hear(std::int32_t word, double now) {
  using adapters::gripper::LacqueyWord;
  if (!std::exchange(started_, true)) now_ = now;
  move(fingers_, now_, now);
  if (now < deaf_until_) return;
  const auto said = static_cast<LacqueyWord>(word);
  if (said == LacqueyWord::activate || said == LacqueyWord::free) active_ = said == LacqueyWord::activate;
  if (!active_ || (said != LacqueyWord::open && said != LacqueyWord::close)) return;
  fingers_.go(said == LacqueyWord::open ? opening : 0, force, speed);
  deaf_until_ = now + busy;
}

}  // namespace simulated_gripper
