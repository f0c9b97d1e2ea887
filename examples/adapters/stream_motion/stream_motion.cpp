#include "examples/adapters/stream_motion/stream_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "skinctl/core/contract.hpp"

namespace adapters::stream_motion {
namespace {
using Clock = std::chrono::steady_clock;
constexpr double degree = std::numbers::pi / 180;
constexpr std::uint32_t newest_version = 4;
}  // namespace

StreamMotion::StreamMotion(const Options& options)
    : options_(options), socket_(UdpSocket::to(options.host, options.port)) {}

template <class Packet>
bool StreamMotion::send(const Packet& packet) noexcept {
  std::array<std::uint8_t, max_bytes> bytes{};
  return socket_.send({bytes.data(), print(packet, bytes)});
}

template <class Question, class Answer, class Fits>
void StreamMotion::ask(const Question& question, Answer& answer, const char* name, can::Deadline deadline,
                       Fits&& fits) {
  std::array<std::uint8_t, max_bytes> bytes{};
  for (int tries = 0; tries < 3 && Clock::now() < deadline; ++tries) {
    if (!send(question)) throw ConnectionError("cannot send to " + place());
    const auto until = std::min(deadline, Clock::now() + options_.answer);
    std::size_t size = 0;
    while (Clock::now() < until && socket_.receive(bytes, size, until) == Read::some)
      if (parse({bytes.data(), size}, answer) && fits(answer)) return;
  }
  throw ConnectionError("the controller at " + place() + " does not say its " + name +
                        ": has it stream motion (J519), and does STREAM_MOTN run?");
}

void StreamMotion::open(can::Deadline deadline) {
  ready_ = started_ = ended_ = false;
  why_ = "";
  Capability capability;
  ask(Capability{}, capability, "capability", deadline, [](const Capability& c) { return c.id == 1; });
  version_ = std::min(capability.available, newest_version);
  if (version_ < 3)
    throw ConnectionError("the controller speaks version " + std::to_string(capability.available) +
                          " of stream motion: 3 or later is needed");
  skinctl::require(capability.sampling >= 1 && capability.sampling <= 100,
                   "sampling period of the controller", capability.sampling, "1 to 100 ms");
  period_ = skinctl::Nanoseconds(std::int64_t{1'000'000} * capability.sampling);
  for (std::uint32_t axis = 1; axis <= 6; ++axis)
    for (std::uint32_t kind = 0; kind < 3; ++kind) {
      Limits limits;
      LimitsQuestion question{.axis = axis, .kind = kind};
      question.header.version = version_;
      ask(question, limits, "limits", deadline,
          [&](const Limits& l) { return l.axis == axis && l.kind == kind; });
      double least = 1e9;
      for (std::size_t k = 0; k < 20; ++k)
        for (const float x : {limits.empty[k], limits.loaded[k]})
          least = x > 0 ? std::min<double>(least, x) : least;
      if (!(least < 1e9))
        throw ConnectionError("the controller states no limits of axis " + std::to_string(axis) +
                              ": has the robot fewer than six?");
      limits_[kind][axis - 1] = degree * least;
    }
  if (!send(Header{type::start, version_})) throw ConnectionError("cannot send to " + place());
  started_ = true;
}

ClockFault StreamMotion::read(std::span<const std::uint8_t> bytes, ClockedState& state) noexcept {
  Status s;
  why_ = "";
  if (!parse(bytes, s) || !started_) return ClockFault::nonsense;
  state = {.number = s.sequence};
  for (std::size_t i = 0; i < 6; ++i) {
    state.q[i] = degree * double(s.joints[i]);
    if (!(std::abs(s.joints[i]) <= 1e4f)) return ClockFault::nonsense;
  }
  state.told = state.q;
  if (!ready_)
    for (std::size_t i = 0; i < 3; ++i)
      other_axes_[i] = std::isfinite(s.joints[6 + i]) ? double(s.joints[6 + i]) : 0;
  state.takes = (s.status & Status::ready) != 0;
  if ((s.robot & Status::emergency_stop) != 0)
    why_ = "emergency stop";
  else if ((s.robot & Status::error) != 0)
    why_ = "the controller reports an error, perhaps a limit of jerk: see its panel";
  else if (s.contact_stop >= 2)
    why_ = "contact stop";
  else if (ready_ && !state.takes && !ended_)
    why_ = "the controller no longer takes commands: its program ended, or they came late";
  if (*why_ != 0) return ClockFault::stopped;
  ready_ = ready_ || state.takes;
  if (s.header.type == type::status_4 && (s.sensor == 1 || s.sensor == 2)) {
    SixJoints& w = state.wrench.emplace();
    for (std::size_t i = 0; i < 6; ++i) w[i] = double(s.force[i]);
  }
  return ClockFault::none;
}

std::size_t StreamMotion::answer(std::uint64_t number, const SixJoints& q, bool last,
                                 std::span<std::uint8_t> out) noexcept {
  Command c{.sequence = static_cast<std::uint32_t>(number), .last = last ? std::uint8_t(1) : std::uint8_t(0)};
  c.header.version = version_;
  for (std::size_t i = 0; i < 6; ++i) c.joints[i] = q[i] / degree;
  std::copy(other_axes_.begin(), other_axes_.end(), c.joints.begin() + 6);
  ended_ = ended_ || last;
  return print(c, out);
}

const char* StreamMotion::refuses(const SixJoints& q) const noexcept {
  for (const double x : q)
    if (!(std::abs(x) <= 100)) return "a joint beyond 100 rad, or no number";
  return nullptr;
}

void StreamMotion::close(can::Deadline deadline) noexcept {
  if (!std::exchange(started_, false)) return;
  std::array<std::uint8_t, max_bytes> bytes{};
  std::size_t size = 0;
  bool rests = !ended_;
  while (!rests && Clock::now() < deadline && socket_.receive(bytes, size, deadline) == Read::some) {
    Status s;
    rests = parse({bytes.data(), size}, s) && (s.status & (Status::ready | Status::moving)) == 0;
  }
  static_cast<void>(send(Header{type::stop, version_}));
}

}  // namespace adapters::stream_motion
