#include "examples/adapters/rsi/rsi.hpp"

#include <numbers>

#include "skinctl/core/contract.hpp"

namespace adapters::rsi {
namespace {
constexpr double degree = std::numbers::pi / 180;
}

Rsi::Rsi(const Options& options) : options_(options) {
  const double period = skinctl::milliseconds(options.period);
  skinctl::require(period >= 1 && period <= 100, "period of RSI", period, "1 to 100 ms; 4 or 12 is usual");
  skinctl::require(options.max_correction > 0 && options.max_correction <= 360, "largest correction",
                   options.max_correction, "> 0, <= 360 deg");
  if (options.type.empty() || options.type.size() > 32 ||
      options.type.find_first_of("<>&\"'") != options.type.npos)
    skinctl::refuse("SENTYPE '" + options.type + "': 1 to 32 characters without <>&\"'");
  socket_ = UdpSocket::at(options.bind, options.port, options.from);
}

double Rsi::max_correction() const noexcept {
  return degree * options_.max_correction;
}

ClockFault Rsi::read(std::span<const std::uint8_t> bytes, ClockedState& state) noexcept {
  Rob rob;
  why_ = "";
  if (!parse({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, rob)) return ClockFault::nonsense;
  if (rob.axes != 6) {
    why_ = "AIPos has fewer than A1 to A6";
    return ClockFault::joints;
  }
  state = {.number = rob.ipoc, .late = rob.late};
  for (std::size_t i = 0; i < 6; ++i) {
    state.q[i] = degree * rob.actual[i];
    state.told[i] = rob.has_setpoint ? degree * rob.setpoint[i] : state.q[i];
  }
  if (rob.has_wrench) state.wrench = rob.wrench;
  if (!started_) {
    start_ = sum_ = state.told;
    late_ = rob.late;
    started_ = true;
  }
  if (options_.correction == Correction::relative && (!rob.has_late || rob.late > late_)) {
    why_ = rob.has_late ? "relative corrections add up, and one is missing: use #ABSOLUTE"
                        : "relative corrections need DEF_Delay in the XML, to see what is missing";
    return ClockFault::late;
  }
  return ClockFault::none;
}

std::size_t Rsi::answer(std::uint64_t number, const SixJoints& q, bool last,
                        std::span<std::uint8_t> out) noexcept {
  Sen sen{.ipoc = number, .stop = last};
  const SixJoints& from = options_.correction == Correction::relative ? sum_ : start_;
  for (std::size_t i = 0; i < 6; ++i) sen.correction[i] = (q[i] - from[i]) / degree;
  if (options_.correction == Correction::relative)  // as it is written, so that no rounding adds up
    for (std::size_t i = 0; i < 6; ++i) sum_[i] += degree * std::round(1e6 * sen.correction[i]) / 1e6;
  return print(sen, options_.type, {reinterpret_cast<char*>(out.data()), out.size()});
}

const char* Rsi::refuses(const SixJoints& q) const noexcept {
  for (std::size_t i = 0; i < 6; ++i)
    if (!(std::abs(q[i] - start_[i]) <= max_correction() * (1 + 1e-9)))
      return "a correction from the start pose beyond that of AXISCORR: state it, or begin nearer";
  return nullptr;
}

}  // namespace adapters::rsi
