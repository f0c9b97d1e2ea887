// lost_again: a command that the network loses together with its repetition still arrives before the robot's
// program stops, which by torque waits for 40 ms; further losses cost the same wait each. A wire that is down
// for a while makes one wait. Exit code 77 where nobody may make namespaces, or the kernel does not let a
// socket choose when it sends again.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <vector>

#include "examples/adapters/socket.hpp"
#include "examples/fault_table/plain_stream.hpp"

namespace {

using namespace fault_table;
constexpr double patience = 0.04;  // of the robot's program by torque [s]
constexpr std::uint32_t every = 200, tries = 5;

/// The shortest of the waits that losses cause in a stream of commands, of which one in `every` is lost
/// `times` times: what else holds it up, as a busy computer, makes longer ones.
double waits(int times, int again) {
  NetworkLink link(1);
  const PlainStream commands{.bytes = 32, .rate = 500, .congestion = {}, .retransmission = again};
  std::uint32_t first = 0;
  std::map<std::uint32_t, int> lost;
  link.set_judge([&](const SeenPacket& p) {
    if (!p.tcp || !p.to_robot || p.length == 0) return false;
    if (first == 0) first = p.sequence;
    const auto message = (p.sequence - first) / static_cast<std::uint32_t>(commands.bytes);
    return message > 0 && message % every == 0 && message <= every * tries && lost[message]++ < times;
  });
  auto all = stalls(link, {}, commands, (every * tries + 500) / commands.rate);
  std::sort(all.begin(), all.end(), std::greater<>());
  return all.size() < tries ? 0 : all[tries - 1];
}

/// Of a stream of 2 s whose wire is down from 0.5 to 0.7 s: the longest wait.
double wait_of_break() {
  NetworkLink link(1);
  const auto all =
      stalls(link, {.down = true}, {.rate = 500, .congestion = {}, .retransmission = 4}, 2, {0.5, 0.7});
  return all.empty() ? 0 : *std::max_element(all.begin(), all.end());
}
/// Whether a stream is refused in words, not carried by other means.
bool refuses_unknown_control() {
  NetworkLink link(1);
  try {
    static_cast<void>(stalls(link, {}, {.congestion = "nobody's"}, 0.1));
  } catch (const adapters::ConnectionError& e) {
    return std::string(e.what()).find("nobody's") != std::string::npos;
  }
  return false;
}

}  // namespace

int main() {
  become_root_of_own_namespace();
  try {
    // Two losses: the first wait. Five: four waits, each of which would be twice as long as the one before.
    const double once = waits(2, 4), often = waits(5, 4), system = waits(2, 0);
    std::printf(
        "lost with one repetition: %.0f ms, with four: %.0f ms; as the system has it, with one: %.0f ms\n",
        1e3 * once, 1e3 * often, 1e3 * system);
    const double down = wait_of_break();
    std::printf("down for 200 ms: %.0f ms\n", 1e3 * down);
    return !(once > 0 && once < patience && often > 0 && often < 3 * patience && down >= 0.2 && down < 0.4 &&
             refuses_unknown_control());
  } catch (const std::exception& e) {
    std::printf("skipped: %s\n", e.what());
    return 77;
  }
}
