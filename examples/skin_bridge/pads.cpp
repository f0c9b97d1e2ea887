#include "examples/skin_bridge/pads.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "examples/adapters/serial.hpp"
#include "examples/adapters/skin/any_skin.hpp"
#include "examples/adapters/skin/papill_array.hpp"
#include "examples/adapters/skin/serial_datagrams.hpp"
#include "examples/adapters/skin/tf_luna.hpp"
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

/// A device's clock, followed.
class DeviceClock {
 public:
  /// When it was `sent`, by this computer's clock, which shows `t`.
  Nanoseconds stamp(Nanoseconds sent, Nanoseconds t) {
    static_cast<void>(clock_.hear(heard_, sent, t));
    return skinctl::ClockOffset::ready(heard_) ? std::min(skinctl::ClockOffset::stamp(heard_, sent), t) : t;
  }

 private:
  skinctl::ClockOffset clock_{{.gather = 0ns}};
  skinctl::ClockOffset::Memory heard_;
};

template <XelaKind Kind>
Exit pass_xela(XelaClient& client, const Passing& p) {
  XelaSamples<Kind> samples;
  DeviceClock clock;
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
    const bool told = message->time > 0;
    const auto time = told ? clock.stamp(Nanoseconds(static_cast<std::int64_t>(1e9 * message->time)), t) : t;
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

/// Passes on what a serial line tells; `count` takes over its counts.
template <class Kind, class Line, class Count>
Exit from_line(Line& line, const std::string& device, const Passing& p, const Count& count) {
  Exit exit = Exit::interrupted;
  while (!p.ended()) {
    const auto samples = line.poll(Clock::now() + 4ms, now);
    count();
    p.count.samples += samples.size();
    if (!samples.empty()) p.to.send<Kind>(samples, now());
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

}  // namespace

Exit from_any_skin(const std::string& device, std::uint32_t cell, const Passing& p) {
  AnySkinLine line(device, cell);
  return from_line<AnySkin>(line, device, p, [&] {
    p.count.messages = line.counts().packets;
    p.count.refused = line.counts().breaks;
  });
}

Exit from_tf_luna(const std::string& device, std::uint32_t cell, const Passing& p) {
  TfLunaLine line(device, cell);
  const Exit exit = from_line<TfLuna>(line, device, p, [&] {
    p.count.messages = line.counts().frames;
    p.count.refused = line.blinded();
  });
  if (line.blinded() > 0)
    std::fprintf(stderr, "skin_bridge: %s: blinded in %llu frames\n", device.c_str(), number(line.blinded()));
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

Exit from_papill_array(const std::string& device, bool bias, const Passing& p) {
  PapillArrayLine line(device, 500, bias);
  PapillArraySamples samples;
  DeviceClock clock;
  Exit exit = Exit::interrupted;
  while (!p.ended()) {
    const PapillArrayPacket* packet = line.next(Clock::now() + 4ms);
    p.count.messages = line.counts().packets;
    if (packet == nullptr) {
      if (!line.closed()) continue;
      std::fprintf(stderr, "skin_bridge: %s: the line has ended\n", device.c_str());
      exit = Exit::lost;
      break;
    }
    const auto t = now();
    constexpr std::uint64_t far = std::uint64_t(1) << 50;  // 35 years
    const Nanoseconds sent(static_cast<std::int64_t>(1000 * (packet->microseconds % far)));
    const auto some = samples.of(*packet, clock.stamp(sent, t));
    p.count.samples += some.size();
    if (!some.empty()) p.to.send<PapillArray>(some, t);
  }
  if (line.counts().dropped > 0)
    std::fprintf(stderr, "skin_bridge: %s: %llu bytes belonged to no packet\n", device.c_str(),
                 number(line.counts().dropped));
  return exit;
}

Exit from_datagram_line(const std::string& device, unsigned speed, adapters::UdpSocket& to, Counters& count,
                        const std::function<bool()>& ended) {
  const auto line = adapters::open_serial(device, speed);
  SerialDatagrams found;
  std::array<std::uint8_t, 4096> bytes;
  Exit exit = Exit::interrupted;
  while (!ended()) {
    std::size_t n = 0;
    if (adapters::read_some(line, bytes, n, Clock::now() + 4ms) == adapters::Read::closed) {
      std::fprintf(stderr, "skin_bridge: %s: the line has ended\n", device.c_str());
      exit = Exit::lost;
      break;
    }
    found.take(std::span(bytes).first(n), [&](std::span<const std::uint8_t> whole) {
      Datagram datagram;
      if (parse(whole, datagram)) count.samples += datagram.count();
      ++count.messages;
      static_cast<void>(to.send(whole));
    });
  }
  if (found.counts().dropped > 0)
    std::fprintf(stderr, "skin_bridge: %s: %llu bytes belonged to no datagram\n", device.c_str(),
                 number(found.counts().dropped));
  return exit;
}

}  // namespace skin_bridge
