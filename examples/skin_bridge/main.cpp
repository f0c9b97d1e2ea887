// skin_bridge: takes a skin from a ROS 1 topic or bag, from iCub's CAN, from serial lines of an AnySkin or a
// PapillArray, from XELA's server or from datagrams, and passes it on as datagrams or into a bag.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "examples/adapters/can/link.hpp"
#include "examples/adapters/ros1/subscriber.hpp"
#include "examples/adapters/skin/bag.hpp"
#include "examples/adapters/skin/icub_can.hpp"
#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/skin/ros1.hpp"
#include "examples/adapters/skin/sender.hpp"
#include "examples/skin_bridge/pads.hpp"
#include "examples/support/job.hpp"
#include "examples/support/output_file.hpp"
#include "examples/support/program.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/sensing/clock_offset.hpp"
#include "skinctl/sensing/unrest.hpp"

namespace {

using namespace adapters;
using namespace std::chrono_literals;
namespace job = examples::job;
using Clock = std::chrono::steady_clock;
using skinctl::CellSample;
using skinctl::Nanoseconds;

/// One period's samples, by this computer's clock.
using Sink = std::function<void(std::span<const CellSample>, Nanoseconds now)>;
Nanoseconds now() {
  return Clock::now().time_since_epoch();
}

using skin_bridge::Counters;

struct Options {
  std::string from, to, topic, key_file, address;
  double speed = 1, seconds = 0;
  std::uint32_t cell = 0;
  unsigned baud = 115200;
  bool bias = false;
  bool quiet = false, version_2 = false;
};

std::pair<std::string, std::uint16_t> host_and_port(const std::string& text, const char* option) {
  const auto colon = text.rfind(':');
  const std::string port = text.substr(colon == std::string::npos ? 0 : colon + 1);
  const bool digits =
      !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  const int number = digits ? std::stoi(port) : -1;
  if (number < 0 || number > 65535)
    skinctl::refuse(std::string(option) + " '" + text + "': expected HOST:PORT or PORT");
  return {colon == std::string::npos ? "127.0.0.1" : text.substr(0, colon),
          static_cast<std::uint16_t>(number)};
}

/// A message whenever its time has come; stamps of the cells move to this computer's clock with it. `lost`
/// where part of the bag could not be carried, `refused` where none of it is a skin's.
job::Exit from_bag(const std::string& file, const Options& o, const Sink& sink, Counters& count,
                   const std::function<bool()>& ended) {
  skin::BagReader bag(file);
  skin::BagMessage message;
  std::vector<CellSample> samples;
  std::optional<Nanoseconds> first;
  const auto start = now();
  while (bag.next(message)) {
    if (o.topic.empty() ? !message.type.ends_with("SkinCellDataArray") : message.topic != o.topic) continue;
    samples.clear();
    if (!skin::parse_ros1(message.bytes, samples)) {
      ++count.refused;
      continue;
    }
    if (!first) first = message.time;
    const auto since = std::chrono::duration_cast<Nanoseconds>((message.time - *first) / o.speed);
    while (now() - start < since) {
      if (ended()) return job::Exit::interrupted;
      std::this_thread::sleep_for(std::min<Nanoseconds>(since - (now() - start), 2ms));
    }
    if (ended()) return job::Exit::interrupted;
    const auto t = now();
    for (CellSample& s : samples) {  // as long before now as they were before their recording
      const auto age = message.time - s.time;
      s.time = age >= 0ns && age < 100ms ? t - age : t;
    }
    ++count.messages;
    count.samples += samples.size();
    sink(samples, t);
  }
  if (bag.cut_short())
    std::fprintf(stderr, "skin_bridge: %s ends within a record; what came before was read\n", file.c_str());
  if (count.messages == 0 && count.refused == 0) {
    std::fprintf(stderr, "skin_bridge: %s: no message %s\n", file.c_str(),
                 o.topic.empty() ? "of type SkinCellDataArray" : ("of topic " + o.topic).c_str());
    return job::Exit::refused;
  }
  if (count.refused > 0)
    std::fprintf(stderr, "skin_bridge: %s: %llu messages are none of a skin and were left out\n",
                 file.c_str(), static_cast<unsigned long long>(count.refused));
  return bag.cut_short() || count.refused > 0 ? job::Exit::lost : job::Exit::fine;
}

template <can::CanLink Link>
job::Exit from_can(Link link, const Sink& sink, Counters& count, const std::function<bool()>& ended) {
  std::vector<CellSample> samples;
  const skinctl::Unrest<> unrest(1.0 / 255);  // each frame is a measurement
  std::vector<skinctl::Unrest<>::Memory> cells(16 * skin::icub_taxels_of_a_board);
  while (!ended()) {
    samples.clear();
    const auto until = Clock::now() + 4ms;
    can::Frame frame;
    Read read = Read::nothing;
    while (samples.size() < 4096 && (read = link.read(frame, until)) == Read::some) {
      ++count.messages;
      const auto triangle = skin::parse_icub(frame.id, {frame.data.data(), frame.size});
      if (!triangle || frame.remote) {
        ++count.refused;
        continue;
      }
      for (std::size_t k = 0; k < triangle->count; ++k) {
        samples.push_back(triangle->sample(k, now()));
        auto& cell = cells.at(samples.back().cell);
        unrest.measure(cell, samples.back()), unrest.tell(cell, samples.back());
      }
    }
    count.samples += samples.size();
    sink(samples, now());
    if (read == Read::closed) return job::Exit::lost;
  }
  return job::Exit::interrupted;
}

job::Exit from_datagrams(const std::string& at, const Options& o, const Sink& sink, Counters& count,
                         const std::function<bool()>& ended) {
  const auto [host, port] = host_and_port(at, "--from udp:");
  skin::ReceiverConfig config;
  config.address = host;
  config.port = port;
  if (!o.key_file.empty()) config.key = skin::Key::read(o.key_file);
  config.version_2 = o.version_2;
  skin::Receiver receiver(config);
  std::printf("ready port=%u\n", unsigned{receiver.port()});
  std::fflush(stdout);
  while (!ended()) {
    const auto t = now();
    const auto samples = receiver.poll(t);
    count.samples += samples.size();
    count.messages = receiver.statistics().datagrams;
    const auto& s = receiver.statistics();
    count.refused = s.stray() + s.unasked + s.bad_samples + s.repeated;
    if (!samples.empty()) sink(samples, t);
    std::this_thread::sleep_for(4ms);
  }
  if (const std::string refused = skin::refusals(receiver.statistics()); !refused.empty())
    std::fprintf(stderr, "skin_bridge: refused: %s\n", refused.c_str());
  if (const std::string leaps = receiver.leaps(); !leaps.empty())
    std::fprintf(stderr, "skin_bridge: %s\n", leaps.c_str());
  return job::Exit::interrupted;
}

/// Messages of a topic as they come; each publisher's clock is followed. Silence stays silence: no
/// heartbeats.
job::Exit from_ros1(const std::string& at, const Options& o, const Sink& sink, Counters& count,
                    const std::function<bool()>& ended) {
  const auto [host, port] = host_and_port(at, "--from ros1:");
  ros1::Subscriber node({.master = host,
                         .port = port,
                         .topic = o.topic.empty() ? "/skin" : o.topic,
                         .type = skin::skin_message_type,
                         .md5 = skin::skin_message_md5,
                         .node = "",
                         .address = o.address});
  std::printf("ready node=%s\n", node.node().c_str());
  std::fflush(stdout);
  const skinctl::ClockOffset clock({.gather = 0ns});
  std::map<std::size_t, skinctl::ClockOffset::Memory> clocks;
  std::vector<CellSample> samples;
  std::string said;
  while (!ended()) {
    node.poll(Timeout(4), [&](std::size_t publisher, std::span<const std::uint8_t> message) {
      samples.clear();
      if (!skin::parse_ros1(message, samples)) {
        ++count.refused;
        return;
      }
      const auto t = now();
      auto& heard = clocks[publisher];
      if (!samples.empty()) {
        auto newest = samples[0].time;
        for (const CellSample& s : samples) newest = std::max(newest, s.time);
        static_cast<void>(clock.hear(heard, newest, t));
      }
      for (CellSample& s : samples)
        s.time =
            skinctl::ClockOffset::ready(heard) ? std::min(skinctl::ClockOffset::stamp(heard, s.time), t) : t;
      ++count.messages;
      count.samples += samples.size();
      sink(samples, t);
    });
    if (node.dismissed()) {
      std::fprintf(stderr, "skin_bridge: the ROS master told this node to go\n");
      return job::Exit::halted;
    }
    if (node.trouble() != said && !(said = node.trouble()).empty())
      std::fprintf(stderr, "skin_bridge: %s\n", said.c_str());
  }
  return job::Exit::interrupted;
}

job::Exit run(const Options& o) {
  for (const char* pad : {"any-skin:", "datagrams:", "papill-array:", "tf-luna:", "xela:", "xela-forces:"})
    if (o.from.starts_with(pad) && o.to.starts_with("bag:"))
      skinctl::refuse("--to '" + o.to + "': a bag holds hexagons; other kinds are passed on as datagrams");
  const job::StopSignals signals;
  job::Progress progress(o.quiet);
  const auto start = Clock::now();
  Counters count;
  bool over = false;
  const std::function<bool()> ended = [&] {
    const double t = std::chrono::duration<double>(Clock::now() - start).count();
    if (progress.due(t))
      progress.show("%8.1f s  %llu messages, %llu samples", t,
                    static_cast<unsigned long long>(count.messages),
                    static_cast<unsigned long long>(count.samples));
    over = o.seconds > 0 && t > o.seconds;
    return over || signals.asked();
  };
  const auto after = [](const std::string& text, const char* kind) {
    return text.starts_with(kind) ? std::optional(text.substr(std::string_view(kind).size())) : std::nullopt;
  };
  Sink sink;
  std::unique_ptr<skin::Sender> sender;
  bool asks = false;  // the receiver
  std::unique_ptr<skin::BagWriter> writer;
  if (const auto to = after(o.to, "udp:")) {
    const auto [host, port] = host_and_port(*to, "--to udp:");
    std::optional<skin::Key> key;
    if (!o.key_file.empty() && !o.from.starts_with("udp:")) key = skin::Key::read(o.key_file);
    asks = key.has_value();
    sender = std::make_unique<skin::Sender>(host, port, key);
    sink = [&](auto samples, Nanoseconds t) { sender->send(samples, t); };
  } else if (const auto file = after(o.to, "bag:")) {
    examples::refuse_own_input(*file, {after(o.from, "bag:").value_or(""), o.key_file});
    writer =
        std::make_unique<skin::BagWriter>(*file, o.topic.empty() ? "/skin" : o.topic, skin::skin_message_type,
                                          skin::skin_message_definition, skin::skin_message_md5);
    const auto real =
        std::chrono::system_clock::now().time_since_epoch() - std::chrono::duration_cast<Nanoseconds>(now());
    sink = [&writer, real, shifted = std::vector<CellSample>()](auto samples, Nanoseconds t) mutable {
      shifted.assign(samples.begin(), samples.end());
      for (CellSample& s : shifted) s.time += real;  // a bag counts from 1970
      writer->write(t + real, skin::ros1_message(shifted));
    };
  } else {
    skinctl::refuse("--to '" + o.to + "': expected udp:HOST:PORT or bag:FILE");
  }
  const auto pad = [&]() -> skin_bridge::Passing { return {*sender, count, ended}; };
  const auto line_of_pads = [&](const std::string& line) {
    if (!o.key_file.empty()) skinctl::refuse("--key: a pad at a serial line seals nothing, and is not asked");
    const auto [host, port] = host_and_port(*after(o.to, "udp:"), "--to udp:");
    auto socket = UdpSocket::to(host, port);
    return skin_bridge::from_datagram_line(line, o.baud, socket, count, ended);
  };
  const auto xela = [&](const std::string& at, bool forces) {
    const auto [host, port] =
        host_and_port(at.find(':') == std::string::npos ? at + ":5000" : at, "--from xela:");
    return skin_bridge::from_xela(host, port, forces, pad());
  };
  job::Exit exit = job::Exit::fine;
  if (const auto bag = after(o.from, "bag:"))
    exit = from_bag(*bag, o, sink, count, ended);
  else if (const auto can = after(o.from, "icub:"))
    exit = can->starts_with("/") ? from_can(can::SlcanLink::open(*can), sink, count, ended)
                                 : from_can(can::FrameSocket::open(*can), sink, count, ended);
  else if (const auto port = after(o.from, "udp:"))
    exit = from_datagrams(*port, o, sink, count, ended);
  else if (const auto master = after(o.from, "ros1:"))
    exit = from_ros1(*master, o, sink, count, ended);
  else if (const auto line = after(o.from, "any-skin:"))
    exit = skin_bridge::from_any_skin(*line, o.cell, pad());
  else if (const auto beam = after(o.from, "tf-luna:"))
    exit = skin_bridge::from_tf_luna(*beam, o.cell, pad());
  else if (const auto pads = after(o.from, "datagrams:"))
    exit = line_of_pads(*pads);
  else if (const auto controller = after(o.from, "papill-array:"))
    exit = skin_bridge::from_papill_array(*controller, o.bias, pad());
  else if (const auto counts = after(o.from, "xela:"))
    exit = xela(*counts, false);
  else if (const auto forces = after(o.from, "xela-forces:"))
    exit = xela(*forces, true);
  else
    skinctl::refuse("--from '" + o.from +
                    "': expected ros1:[HOST:]PORT, bag:FILE, icub:INTERFACE, icub:/dev/TTY, "
                    "any-skin:/dev/TTY, papill-array:/dev/TTY, tf-luna:/dev/TTY, datagrams:/dev/TTY, "
                    "xela:HOST[:PORT], xela-forces:HOST[:PORT] or udp:[HOST:]PORT");
  if (writer) writer->close();
  progress.clear();
  if (asks && sender->asked() == 0)
    std::fprintf(stderr,
                 "skin_bridge: no receiver with this key has asked: nothing that was sent is taken (%llu "
                 "datagrams came back)\n",
                 static_cast<unsigned long long>(sender->foreign()));
  std::printf("%llu messages, %llu samples, %llu refused\n", static_cast<unsigned long long>(count.messages),
              static_cast<unsigned long long>(count.samples), static_cast<unsigned long long>(count.refused));
  return over ? job::Exit::fine : exit;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Carries a skin from one language to another."};
  app.footer(job::exit_help());
  Options o;
  app.add_option(
         "--from", o.from,
         "ros1:[HOST:]PORT (a topic of ROS 1: its master, 11311), bag:FILE (ROS 1), icub:INTERFACE or "
         "icub:/dev/TTY (taxels on CAN, by an slcan adapter), any-skin:/dev/TTY (a pad of magnetometers), "
         "papill-array:/dev/TTY (a controller's pillars), tf-luna:/dev/TTY (a distance), datagrams:/dev/TTY "
         "(those of a pad of your own), "
         "xela:HOST[:PORT] or xela-forces:HOST[:PORT] (the "
         "maker's server, 5000: taxels by counts, or by forces where it tells them) or udp:[HOST:]PORT "
         "(datagrams)")
      ->required();
  app.add_option("--to", o.to, "udp:HOST:PORT (datagrams) or bag:FILE (ROS 1)")->required();
  app.add_option(
      "--topic", o.topic,
      "of ROS 1, default /skin; of a bag that is read, default every topic of type SkinCellDataArray");
  app.add_option("--address", o.address,
                 "of this computer for the nodes of ROS 1; default: the one on the way to the master");
  app.add_flag("--bias", o.bias, "of papill-array: takes a new zero, for which nothing may touch it for 2 s");
  app.add_option("--baud", o.baud, "of a line with datagrams [bits/s]")->capture_default_str();
  app.add_option("--cell", o.cell, "of any-skin and tf-luna: id of the sensor in its samples")
      ->capture_default_str();
  app.add_option("--key", o.key_file, "file with the key of sealed datagrams")->check(CLI::ExistingFile);
  app.add_flag("--version-2", o.version_2,
               "takes sealed datagrams of version 2 too, whose recordings cannot be told from the skin");
  app.add_option("--speed", o.speed, "of a bag, times real time")
      ->check(CLI::Range(0.01, 1000.0))
      ->capture_default_str();
  app.add_option("--seconds", o.seconds, "ends after so long; 0: at the end or a signal [s]")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("-q,--quiet", o.quiet, "no progress");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  try {
    return job::code(run(o));
  } catch (const ConnectionError& e) {
    std::fprintf(stderr, "skin_bridge: %s\n", e.what());
    return job::code(job::Exit::lost);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "skin_bridge: %s\n", e.what());
    return job::code(job::Exit::refused);
  }
}
