#include "examples/adapters/ur5/rtde_client.hpp"

namespace adapters::ur5 {
namespace {

using Clock = std::chrono::steady_clock;

/// The part of a list before its first comma, which it loses.
std::string_view take_word(std::string_view& list) {
  const auto comma = list.find(',');
  const std::string_view word = list.substr(0, comma);
  list.remove_prefix(comma == std::string_view::npos ? list.size() : comma + 1);
  return word;
}
/// The outputs that a controller does not offer as it was asked, by name.
std::string missing(std::string_view names, std::string_view types, std::string_view offered) {
  std::string out;
  while (!names.empty()) {
    const std::string_view name = take_word(names), type = take_word(types), got = take_word(offered);
    if (type == got) continue;
    out += (out.empty() ? "" : ", ") + std::string(name);
    if (got != "NOT_FOUND") out += got.empty() ? " (no type)" : " (as " + std::string(got) + ")";
  }
  return out;
}

}  // namespace

void RtdeClient::connect(const std::string& host, std::uint16_t port, Timeout timeout) {
  framer_ = {};
  said_.clear();
  timeout_ = timeout;
  stream_.connect(host, port, "the robot's RTDE", timeout);
  PackageWriter version(package::version);
  version.u16(2);
  if (PayloadReader in(ask(version, package::version, "version").payload); in.u8() != 1)
    throw ConnectionError("the robot does not speak RTDE version 2");
  PackageWriter controller(package::controller);
  PayloadReader numbers(ask(controller, package::controller, "controller version").payload);
  version_ = {numbers.u32(), numbers.u32(), numbers.u32(), numbers.u32()};
  if (!numbers.ok()) throw ConnectionError("the robot's RTDE tells no version of its controller");
}

std::uint8_t RtdeClient::outputs(double rate, const std::string& names, const std::string& types) {
  PackageWriter question(package::outputs);
  question.f64(rate);
  question.text(names);
  PayloadReader in(ask(question, package::outputs, "outputs").payload);
  const std::uint8_t id = in.u8();
  const std::string offered = in.rest();
  if (id == 0 || offered != types)
    throw ConnectionError("the robot's controller " + version_.text() + " does not offer the outputs " +
                          missing(names, types, offered));
  return id;
}

std::uint8_t RtdeClient::inputs(const std::string& names) {
  PackageWriter question(package::inputs);
  question.text(names);
  PayloadReader in(ask(question, package::inputs, "inputs").payload);
  const std::uint8_t id = in.u8();
  const std::string types = in.rest();
  if (id == 0 || types.find("IN_USE") != std::string::npos || types.find("NOT_FOUND") != std::string::npos)
    throw ConnectionError("the robot does not give the inputs " + names + ": " + types);
  return id;
}

void RtdeClient::start() {
  PackageWriter question(package::start);
  if (PayloadReader in(ask(question, package::start, "start").payload); in.u8() != 1)
    throw ConnectionError("the robot refuses to send data");
}

Package RtdeClient::ask(PackageWriter& question, std::uint8_t type, const char* what) {
  if (!stream_.write(question.finish(), timeout_)) throw ConnectionError("the robot's RTDE hung up");
  const auto deadline = Clock::now() + timeout_;
  Package p{};
  RtdeEnd end = RtdeEnd::none;
  // Data may overtake an answer; others are not ours.
  while ((end = read(p, left_until(deadline))) == RtdeEnd::none && Clock::now() < deadline) {
    if (p.type == type) return p;
    if (p.type == package::message) hear(p.payload);
  }
  const char* why = end == RtdeEnd::closed     ? ": it closed the connection"
                    : end == RtdeEnd::nonsense ? ": nonsense, a package of impossible size"
                                               : "";
  throw ConnectionError(std::string("the robot's RTDE gave no answer to ") + what + why);
}

RtdeEnd RtdeClient::read(Package& p, Timeout timeout) noexcept {
  const auto deadline = Clock::now() + timeout;
  for (;;) {
    if (const auto whole = framer_.next()) {
      p = *whole;
      return RtdeEnd::none;
    }
    if (framer_.broken()) return RtdeEnd::nonsense;
    std::size_t count = 0;
    const Read got = stream_.read_some(framer_.room(), count, left_until(deadline));
    if (got == Read::closed) return RtdeEnd::closed;
    if (got == Read::nothing) return RtdeEnd::time_over;
    framer_.received(count);
  }
}

void RtdeClient::hear(std::span<const std::uint8_t> payload) {
  PayloadReader in(payload);
  const std::string text = in.text(in.u8());
  if (!in.ok()) return;
  said_.clear();
  for (const char c : text)
    if (c >= ' ' && c <= '~') said_ += c;  // nothing that a terminal obeys
}

}  // namespace adapters::ur5
