#include "examples/adapters/egm/egm.hpp"

#include <numbers>

#include "skinctl/core/contract.hpp"

namespace adapters::egm {
namespace {
constexpr double degree = std::numbers::pi / 180;
}

Egm::Egm(const Options& options) : options_(options) {
  const double period = skinctl::milliseconds(options.period);
  skinctl::require(period >= 4 && period <= 100, "period of EGM", period, "4 to 100 ms, as of \\SampleRate");
  socket_ = UdpSocket::at(options.bind, options.port, options.from);
}

ClockFault Egm::read(std::span<const std::uint8_t> bytes, ClockedState& state) noexcept {
  RobotMessage m;
  why_ = "";
  if (!parse(bytes, m)) return ClockFault::nonsense;
  if (m.joints != 6) {
    why_ = "its feedback has fewer or more than six axes";
    return ClockFault::joints;
  }
  if (m.motors == Motors::off)
    why_ = "its motors are off";
  else if (m.guided == Guided::error)
    why_ = "EGM is in error: see the event log";
  else if (m.rapid == Rapid::stopped)
    why_ = "its RAPID program has stopped";
  else if (guided_ && m.guided == Guided::stopped)
    why_ = "EGMRunJoint has ended: state a long \\CondTime";
  if (*why_ != 0) return ClockFault::stopped;
  guided_ = guided_ || m.guided != Guided::stopped;
  state = {.number = m.number, .takes = m.guided != Guided::stopped};
  for (std::size_t i = 0; i < 6; ++i) {
    state.q[i] = degree * m.feedback[i];
    state.told[i] = m.has_planned ? degree * m.planned[i] : state.q[i];
  }
  if (m.has_force) state.wrench = m.force;
  return ClockFault::none;
}

std::size_t Egm::answer(std::uint64_t number, const SixJoints& q, bool,
                        std::span<std::uint8_t> out) noexcept {
  const auto ms = static_cast<std::uint64_t>(skinctl::milliseconds(options_.period));
  SensorMessage m{
      .number = sent_++, .time = static_cast<std::uint32_t>(number * ms), .joints = 6, .planned = {}};
  for (std::size_t i = 0; i < 6; ++i) m.planned[i] = q[i] / degree;
  return print(m, out);
}

}  // namespace adapters::egm
