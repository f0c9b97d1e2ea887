#include "examples/adapters/fri/fri.hpp"

#include "skinctl/core/contract.hpp"

namespace adapters::fri {
namespace {

constexpr std::int64_t begun_anew = 50;  // cycles by which a counter goes back when its session is a new one

/// What a session that does not command is waiting for.
const char* waits_for(Session session) noexcept {
  switch (session) {
    case Session::idle:
      return "the session is IDLE: does the Java program wait in FRISession.await?";
    case Session::monitoring_wait:
      return "the session stays in MONITORING_WAIT: its quality is too low, see the network";
    case Session::monitoring_ready:
      return "the session stays in MONITORING_READY: the Java program has no FRIJointOverlay in motion";
    default:
      return "the session stays in COMMANDING_WAIT: has the Java program's motion begun?";
  }
}
const char* name(Control control) noexcept {
  return control == Control::position              ? "its control mode is position"
         : control == Control::joint_impedance     ? "its control mode is joint impedance"
         : control == Control::cartesian_impedance ? "its control mode is Cartesian impedance"
                                                   : "its control mode is none that takes joints";
}
const char* name(Overlay overlay) noexcept {
  return overlay == Overlay::position ? "its client command mode is POSITION"
         : overlay == Overlay::torque ? "its client command mode is TORQUE"
         : overlay == Overlay::wrench ? "its client command mode is WRENCH, which takes no joints"
                                      : "its client command mode is none that takes joints";
}

}  // namespace

Fri::Fri(const Options& options) : options_(options) {
  const double period = skinctl::milliseconds(options.period);
  skinctl::require(period >= 1 && period <= 100, "period of FRI", period, "1 to 100 ms");
  if (options.control != Control::joint_impedance && options.control != Control::position)
    skinctl::refuse("FRI: only joint impedance and position take joints");
  if (options.overlay != Overlay::torque && options.overlay != Overlay::position)
    skinctl::refuse("FRI: only the client command modes POSITION and TORQUE take joints");
  if (options.overlay == Overlay::torque) {
    skinctl::require(period <= 2, "period of FRI by TORQUE", period, "<= 2 ms");
    if (options.control != Control::joint_impedance)
      skinctl::refuse("FRI: TORQUE needs JointImpedanceControlMode");
  }
  socket_ = UdpSocket::at(options.bind, options.port, options.from);
}

/// What a message says against going on.
ClockFault Fri::judge(const Monitoring& m) noexcept {
  const auto ms = static_cast<double>(m.period) * m.multiplier;
  if (m.axes != joints) return why_ = "an iiwa has seven", ClockFault::joints;
  if (m.safety != 0) return why_ = "its safety state is not normal: see its panel", ClockFault::stopped;
  if (m.period != 0 && ms != skinctl::milliseconds(options_.period))
    return why_ = "its send period times its receive multiplier is another period", ClockFault::declared;
  const bool good = m.quality >= Quality::good;
  if (commanded_ && m.session != Session::commanding)
    return why_ = good ? "the session fell back from COMMANDING_ACTIVE: the Java program's motion has ended, "
                         "or failed"
                       : "the session fell back from COMMANDING_ACTIVE: its quality is below GOOD",
           ClockFault::stopped;
  if (m.session < Session::commanding_wait) return ClockFault::none;
  if (m.control != options_.control) return why_ = name(m.control), ClockFault::declared;
  if (m.overlay != options_.overlay) return why_ = name(m.overlay), ClockFault::declared;
  if (m.session == Session::commanding && !good)
    return why_ = "its quality is below GOOD while it commands", ClockFault::stopped;
  return ClockFault::none;
}

/// Whether an answer is due to this message, and the number of its cycle.
bool Fri::due(const Monitoring& m, std::int64_t& cycle) noexcept {
  const std::int64_t each = m.multiplier;
  const auto cycle_of = [&] {
    const auto since = static_cast<std::int64_t>(static_cast<std::int32_t>(m.header.number - first_));
    return (since >= 0 ? since : since - each + 1) / each;
  };
  if (cycle_ < 0 || (!commanded_ && cycle_of() < cycle_ - begun_anew)) first_ = m.header.number, cycle_ = -1;
  cycle = cycle_of();
  if (cycle == cycle_) return m.header.number == heard_;  // twice; or between two that are due
  if (cycle > cycle_) cycle_ = cycle, heard_ = m.header.number;
  return true;
}

ClockFault Fri::read(std::span<const std::uint8_t> bytes, ClockedStateOf<joints>& state) noexcept {
  constexpr std::int64_t offset = std::int64_t{1} << 40;  // cycles have no sign
  Monitoring m;
  why_ = "";
  if (!parse(bytes, m)) return ClockFault::nonsense;
  if (const ClockFault fault = judge(m); fault != ClockFault::none) return fault;
  std::int64_t cycle = 0;
  const bool answers = due(m, cycle);
  commanded_ = commanded_ || m.session == Session::commanding;
  state = {.number = static_cast<std::uint64_t>(cycle + offset),
           .q = m.measured,
           .told = m.commanded ? *m.commanded : m.interpolated.value_or(m.measured),
           .takes = answers && commanded_,
           .external = m.external_torque};
  if (commanded_) return ClockFault::none;
  why_ = waits_for(m.session);
  if (m.session == Session::idle || !answers) return ClockFault::none;
  std::array<std::uint8_t, longest> out;
  const bool follows = m.session == Session::commanding_wait && m.interpolated;
  const auto size = answer(state.number, follows ? *m.interpolated : state.told, false, out);
  if (size > 0)
    static_cast<void>(socket_.send({out.data(), size}));  // what is broken shows when it hears nothing
  return ClockFault::none;
}

std::size_t Fri::answer(std::uint64_t, const SevenJoints& q, bool, std::span<std::uint8_t> out) noexcept {
  Command c{.axes = joints, .position = q, .torque = {}};
  c.header.number = sent_++;
  c.header.reflected = heard_;
  if (options_.overlay == Overlay::torque) c.torque = torque_;
  return print(c, out);
}

}  // namespace adapters::fri
