// Faults between a skin and its receiver, in simulated time: datagrams through a real socket, clocks that are
// counted.
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <random>

#include "examples/adapters/skin/datagram.hpp"
#include "examples/adapters/skin/receiver.hpp"
#include "examples/fault_table/row.hpp"
#include "examples/support/job.hpp"

namespace fault_table {
namespace {

using namespace std::chrono_literals;
using examples::job::Exit;
using skinctl::Nanoseconds;
namespace ip = boost::asio::ip;
using Datagrams = std::vector<std::vector<std::uint8_t>>;

constexpr std::size_t cells = 20;
constexpr Nanoseconds period = 4ms, begins = 1s, ends = 2500ms, over = 4s;

/// What leaves the wire instead of the datagram of this cycle. `k` counts cycles of the fault.
using Change = std::function<Datagrams(std::vector<std::uint8_t> datagram, int k, std::mt19937& random)>;
/// What happens to the sender: its clock and its numbers, from the fault on.
struct Sender {
  Nanoseconds clock{};
  bool numbers_anew = false;
};
struct Fault {
  std::string name;
  Change change;
  Sender sender{};
  Exit exit = Exit::fine;
  double least = 1, most = 1;  ///< share of the samples sent that count during the fault
  int strangers = 0;           ///< datagrams of somebody else for each of ours
  bool lasts = false;          ///< what has changed stays
};

Row suffer(const Fault& fault) {
  adapters::skin::Receiver receiver({.real_time = false});
  boost::asio::io_context io;
  const ip::udp::endpoint to(ip::address_v4::loopback(), receiver.port());
  ip::udp::socket socket(io, ip::udp::v4()), stranger(io, ip::udp::v4());
  std::mt19937 random(1);
  std::uint32_t sequence = 100;
  std::uint64_t sent = 0, counted = 0, withheld = 0, lost_before = 0, lost = 0;
  Nanoseconds silent{}, back{-1};
  bool held_back = false;
  for (Nanoseconds now = 10s; now < 10s + over; now += period) {
    const Nanoseconds t = now - 10s;
    const bool wrong = t >= begins && t < ends;
    const int k = static_cast<int>((t - begins) / period);
    if (k == 0) {
      lost_before = receiver.statistics().lost;
      if (fault.sender.numbers_anew) sequence = 0;
    }
    // The sender's clock is not the robot's.
    const Nanoseconds its = now + 3s + ((wrong || (fault.lasts && t >= begins)) ? fault.sender.clock : 0ns);
    std::array<skinctl::CellSample, cells> samples{};
    for (std::size_t c = 0; c < cells; ++c)
      samples[c] = {.time = its, .cell = static_cast<std::uint32_t>(c + 1), .force = {0.1f, 0.1f, 0.1f}};
    std::array<std::uint8_t, adapters::skin::largest> room{};
    const std::size_t size = adapters::skin::write(room, sequence++, its, std::span(std::as_const(samples)));
    const std::vector<std::uint8_t> bytes(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(size));
    const Datagrams all = wrong && fault.change ? fault.change(bytes, k, random) : Datagrams{bytes};
    if (wrong) sent += cells, withheld += all.empty();
    for (const auto& d : all) socket.send_to(boost::asio::buffer(d), to);
    for (int n = 0; wrong && n < fault.strangers; ++n) stranger.send_to(boost::asio::buffer(bytes), to);
    const auto heard = receiver.poll(now);
    if (wrong) counted += heard.size();
    if (t >= begins && !heard.empty() && t >= ends && back < 0ns) back = t - ends;
    if (t >= begins) silent = std::max(silent, receiver.silent_for(now));
    held_back = held_back || (t >= begins && heard.empty());
  }
  lost = receiver.statistics().lost - lost_before;
  const double share = static_cast<double>(counted) / static_cast<double>(sent);
  Row row{.device = "skin datagrams", .fault = fault.name};
  const bool blind = silent > 100ms;
  row.exit = examples::job::code(blind ? Exit::blind : Exit::fine);
  const auto& s = receiver.statistics();
  row.reaction = text("%.1f %% of the samples count", 100 * share);
  if (lost > 0) row.reaction += text("; %llu datagrams missed", static_cast<unsigned long long>(lost));
  if (s.stray() > 0) row.reaction += text("; %llu refused", static_cast<unsigned long long>(s.stray()));
  if (s.late > 0)
    row.reaction += text("; %llu repeated or overtaken", static_cast<unsigned long long>(s.late));
  if (blind) row.rest_ms = 100;
  row.recovery = !held_back
                     ? "-"
                     : (back < 0ns ? "none" : text("by itself, after %.0f ms", skinctl::milliseconds(back)));
  row.expected = blind == (fault.exit == Exit::blind) && share >= fault.least && share <= fault.most &&
                 row.recovery != "none";
  row.otherwise =
      text("exit %d, %.0f to %.0f %%", examples::job::code(fault.exit), 100 * fault.least, 100 * fault.most);
  return row;
}

Change lose(double share) {
  return [share](auto bytes, int, std::mt19937& random) {
    return std::uniform_real_distribution<>(0, 1)(random) < share ? Datagrams{} : Datagrams{bytes};
  };
}

std::vector<Fault> faults() {
  using Bytes = std::vector<std::uint8_t>;
  std::vector<Fault> out;
  for (const double share : {0.01, 0.05, 0.2, 0.5})
    out.push_back({.name = text("%.0f %% lost", 100 * share),
                   .change = lose(share),
                   .least = 1 - share - 0.06,
                   .most = 1 - share + 0.06});
  out.push_back({.name = "cable cut, or a killed sender",
                 .change = lose(1),
                 .exit = Exit::blind,
                 .least = 0,
                 .most = 0});
  out.push_back({.name = "every datagram twice",
                 .change = [](Bytes b, int, std::mt19937&) { return Datagrams{b, b}; }});
  out.push_back({.name = "every third before the one in front of it",
                 .change =
                     [held = Bytes{}](Bytes b, int k, std::mt19937&) mutable {
                       if (k % 3 == 1) {
                         held = std::move(b);
                         return Datagrams{};
                       }
                       if (held.empty()) return Datagrams{b};
                       return Datagrams{b, std::exchange(held, {})};
                     },
                 .least = 0.6});
  out.push_back({.name = "bursts: 60 ms held back, then all at once",
                 .change =
                     [held = Datagrams{}](Bytes b, int k, std::mt19937&) mutable {
                       held.push_back(std::move(b));
                       return k % 15 == 14 ? std::exchange(held, {}) : Datagrams{};
                     },
                 .least = 0.9});
  out.push_back({.name = "half of them cut short",
                 .change =
                     [](Bytes b, int k, std::mt19937&) {
                       if (k % 2 == 0) b.resize(b.size() - 5);
                       return Datagrams{b};
                     },
                 .least = 0.45,
                 .most = 0.55});
  out.push_back({.name = "another version of the protocol",
                 .change =
                     [](Bytes b, int, std::mt19937&) {
                       b[4] = 9;
                       return Datagrams{b};
                     },
                 .exit = Exit::blind,
                 .least = 0,
                 .most = 0});
  out.push_back({.name = "garbled",
                 .change =
                     [](Bytes b, int, std::mt19937& random) {
                       for (auto& x : b) x = static_cast<std::uint8_t>(random());
                       return Datagrams{b};
                     },
                 .exit = Exit::blind,
                 .least = 0,
                 .most = 0});
  out.push_back({.name = "sender restarted: its numbers and its clock begin anew",
                 .change = {},
                 .sender = {.clock = -9s, .numbers_anew = true},
                 .exit = Exit::blind,
                 .least = 0.5,
                 .lasts = true});
  out.push_back({.name = "its clock goes back by 5 s and stays there",
                 .change = {},
                 .sender = {.clock = -5s},
                 .least = 0.5,
                 .lasts = true});
  out.push_back({.name = "ten datagrams of a stranger for each of its own", .change = {}, .strangers = 10});
  return out;
}

}  // namespace

Cases skin_cases() {
  Cases out;
  for (const Fault& f : faults()) out.push_back({"skin", [f] { return suffer(f); }});
  return out;
}

}  // namespace fault_table
