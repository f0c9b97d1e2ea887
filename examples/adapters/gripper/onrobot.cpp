#include "examples/adapters/gripper/onrobot.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include "skinctl/core/contract.hpp"

namespace adapters::gripper {

using skinctl::GripperError;
using skinctl::Nanoseconds;

OnRobot::OnRobot(const OnRobotConfig& config) : config_(config), dialogue_(config.patience) {
  skinctl::require(config.range.opening > 0 && config.range.opening <= 6.5, "the opening of an RG gripper",
                   config.range.opening, "above 0, at most 6.5 m");
  skinctl::require(config.range.max_force > 0 && config.range.max_force <= 6500,
                   "the greatest force of an RG gripper", config.range.max_force, "above 0, at most 6500 N");
}

bool OnRobot::tell(const modbus::Bytes& bytes) noexcept {
  const bool sent = stream_.write(bytes.span(), Timeout(20));
  if (sent) dialogue_.asked();
  return sent;
}

void OnRobot::connect() {
  stream_.connect(config_.host, config_.port, "the gripper", config_.connect_timeout);
  filled_ = 0;
  state_ = {};
  dialogue_ = Dialogue(config_.patience);
  connected_ = true;
  pending_ = halt_ = busy_ = false;
  acknowledged_ = seen_busy_ = true;
  const auto start = std::chrono::steady_clock::now();
  while (!state_.heard) {
    const auto waited = std::chrono::steady_clock::now() - start;
    poll(waited);
    if (!connected_ || waited > config_.connect_timeout) {
      stream_.close();
      connected_ = false;
      throw ConnectionError("the gripper at " + config_.host + ":" + std::to_string(config_.port) +
                            " does not answer Modbus");
    }
    if (!state_.heard) std::this_thread::sleep_for(Timeout(2));
  }
  dialogue_.change_clock();  // the next one is the caller's
}

bool OnRobot::move(const skinctl::GripperGoal& goal) noexcept {
  if (!connected_ || !finite(goal)) return false;
  goal_ = limited(goal, config_.range);
  pending_ = true;
  acknowledged_ = seen_busy_ = false;
  state_.moving = true;
  state_.holding = false;
  state_.force = 0;
  halt_ = halt_ || busy_;  // a gripper that moves ignores the next goal
  return true;
}

void OnRobot::stop() noexcept {
  pending_ = false;
  halt_ = connected_;
}

void OnRobot::ask() noexcept {
  ++transaction_;
  told_halt_ = halt_;
  told_ = !halt_ && pending_ && !busy_;
  if (halt_) {
    const std::uint16_t word[] = {rg::halt};
    if (tell(modbus::write_request(transaction_, rg::unit, rg::target_force + 2, word))) halt_ = false;
  } else if (told_) {
    const std::uint16_t words[] = {static_cast<std::uint16_t>(std::lround(10 * goal_.force)),
                                   static_cast<std::uint16_t>(std::lround(1e4 * goal_.opening)), rg::grip};
    if (tell(modbus::write_request(transaction_, rg::unit, rg::target_force, words))) pending_ = false;
  } else {
    tell(modbus::read_request(transaction_, rg::unit, rg::width, 2));
  }
}

void OnRobot::hear(const modbus::Frame& frame, Nanoseconds now) noexcept {
  if (frame.transaction != transaction_ || frame.unit != rg::unit || !dialogue_.waiting()) {
    ++nonsense_;
    return;
  }
  std::array<std::uint16_t, 2> read{};
  if (frame.function & 0x80) {  // refused: the compute box has no such register, or is not ready
    state_.code = frame.data.empty() ? 0xff : frame.data[0];
    state_.error = GripperError::fault;
  } else if (frame.function == modbus::write_registers) {
    if (!pending_) acknowledged_ = true;
    if (told_) busy_ = true;  // until its status says otherwise
    since_ = now;
  } else if (modbus::registers_of(frame, read)) {
    const std::uint16_t status = read[1];
    state_.time = now;
    state_.heard = state_.measured = true;
    state_.opening = 1e-4 * read[0];
    state_.code = 0;
    state_.error = (status & rg::safety) ? GripperError::stopped : GripperError::none;
    if (state_.error == GripperError::stopped) state_.code = status;
    busy_ = status & rg::busy;
    if (acknowledged_) {  // before that, it speaks of the goal before
      const bool busy = status & rg::busy;
      seen_busy_ = seen_busy_ || busy || now - since_ > config_.begins_within;
      state_.moving = busy || !seen_busy_;
      state_.holding = !state_.moving && (status & rg::gripping);
      state_.force = state_.holding ? goal_.force : 0;
    }
  } else {
    ++nonsense_;
    return;
  }
  dialogue_.heard();
}

void OnRobot::listen(Nanoseconds now) noexcept {
  for (int k = 0; k < 16; ++k) {
    modbus::Frame frame;
    std::size_t size = 0;
    switch (modbus::find_frame({buffer_.data(), filled_}, frame, size)) {
      case modbus::Found::frame:
        hear(frame, now);
        std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(size),
                  buffer_.begin() + static_cast<std::ptrdiff_t>(filled_), buffer_.begin());
        filled_ -= size;
        continue;
      case modbus::Found::nonsense:
        ++nonsense_;
        stream_.close();
        return;
      case modbus::Found::more:
        break;
    }
    std::size_t n = 0;
    const Read read = stream_.read_some(std::span(buffer_).subspan(filled_), n, Timeout(0));
    if (read == Read::closed) stream_.close();
    if (read != Read::some) return;
    filled_ += n;
  }
}

skinctl::GripperState OnRobot::poll(Nanoseconds now) noexcept {
  if (connected_) {
    dialogue_.at(now);
    listen(now);
    if (dialogue_.overdue()) {  // a goal or a stop that was not acknowledged may not have been heard
      dialogue_.give_up_waiting();
      if (told_halt_)
        halt_ = !pending_;
      else if (told_)
        pending_ = true;
    }
    if (!dialogue_.waiting()) ask();
    if (!stream_.is_open() || dialogue_.error() == GripperError::lost) {
      stream_.close();
      connected_ = false;
    }
  }
  skinctl::GripperState out = state_;
  if (!connected_)
    out.error = GripperError::lost;
  else if (out.error == GripperError::none)
    out.error = dialogue_.error();
  return out;
}

}  // namespace adapters::gripper
