#include "examples/skin_bridge/pads.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "examples/adapters/skin/any_skin.hpp"
#include "examples/adapters/skin/xela.hpp"
#include "skinctl/sensing/clock_offset.hpp"

namespace skin_bridge {
namespace {

using namespace std::chrono_literals;
using namespace adapters::skin;
using examples::job::Exit;
using skinctl::Nanoseconds;
using Clock = std::chrono::steady_clock;

Nanoseconds now() {
  return Clock::now().time_since_epoch();
}
unsigned long long number(std::uint64_t n) {
  return n;
}

template <XelaKind Kind>
Exit pass_xela(XelaClient& client, const Passing& p) {
  XelaSamples<Kind> samples;
  const skinctl::ClockOffset clock({.gather = 0ns});
  skinctl::ClockOffset::Memory heard;
  bool empty = false;
  while (!p.ended()) {
    const XelaMessage* message = client.next(Clock::now() + 4ms);
    const auto& c = client.counts();
    p.count.messages = c.messages;
    p.count.refused = c.nonsense + c.late + c.refused;
    if (message == nullptr) {
      if (!client.closed()) continue;
      std::fprintf(stderr, "skin_bridge: XELA's server has gone\n");
      return Exit::lost;
    }
    const auto t = now();
    auto time = t;
    if (message->time > 0) {
      const Nanoseconds sent(static_cast<std::int64_t>(1e9 * message->time));
      static_cast<void>(clock.hear(heard, sent, t));
      if (skinctl::ClockOffset::ready(heard)) time = std::min(skinctl::ClockOffset::stamp(heard, sent), t);
    }
    const auto some = samples.of(*message, time);
    if (some.empty() && !message->modules.empty() && !empty) {
      std::fprintf(stderr, "skin_bridge: no module tells forces: `xela:` passes their counts on\n");
      empty = true;
    }
    p.count.samples += some.size();
    if (!some.empty()) p.to.send<Kind>(some, t);
  }
  return Exit::interrupted;
}

}  // namespace

Exit from_any_skin(const std::string& device, std::uint32_t cell, const Passing& p) {
  AnySkinLine line(device, cell);
  Exit exit = Exit::interrupted;
  while (!p.ended()) {
    const auto samples = line.poll(Clock::now() + 4ms, now);
    p.count.messages = line.counts().packets;
    p.count.refused = line.counts().breaks;
    p.count.samples += samples.size();
    if (!samples.empty()) p.to.send<AnySkin>(samples, now());
    if (!line.closed()) continue;
    std::fprintf(stderr, "skin_bridge: %s: the line has ended\n", device.c_str());
    exit = Exit::lost;
    break;
  }
  if (line.counts().dropped > 0)
    std::fprintf(stderr, "skin_bridge: %s: %llu bytes belonged to no packet\n", device.c_str(),
                 number(line.counts().dropped));
  return exit;
}

Exit from_xela(const std::string& host, std::uint16_t port, bool forces, const Passing& p) {
  XelaClient client(host, port);
  const Exit exit = forces ? pass_xela<XelaForces>(client, p) : pass_xela<XelaCounts>(client, p);
  if (client.counts().lost > 0)
    std::fprintf(stderr, "skin_bridge: %llu messages of XELA's server were lost\n",
                 number(client.counts().lost));
  return exit;
}

}  // namespace skin_bridge
