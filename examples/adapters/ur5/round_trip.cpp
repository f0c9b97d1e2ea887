#include "examples/adapters/ur5/round_trip.hpp"

#include <algorithm>
#include <vector>

#include "examples/adapters/ur5/rtde_client.hpp"

namespace adapters::ur5 {

RoundTrip measure_round_trip(const std::string& host, std::uint16_t rtde_port, double rate, int echoes,
                             Timeout timeout) {
  using Steady = std::chrono::steady_clock;
  RtdeClient rtde;
  rtde.connect(host, rtde_port, timeout);
  const std::uint8_t in = rtde.inputs("input_int_register_24");
  const std::uint8_t out = rtde.outputs(rate, "timestamp,input_int_register_24", "DOUBLE,INT32");
  rtde.start();
  std::vector<skinctl::Nanoseconds> times, stamps;
  const auto deadline = Steady::now() + timeout;
  auto sent = Steady::now();
  double sent_stamp = 0;
  std::int32_t number = 0;
  Package p{};
  while (static_cast<int>(times.size()) < echoes) {
    if (Steady::now() > deadline || rtde.read(p, Timeout(500)) != RtdeEnd::none)
      throw ConnectionError("the robot did not echo a number within " + std::to_string(timeout.count()) +
                            " ms");
    if (p.type != package::data || p.payload.size() != 13 || p.payload[0] != out) continue;
    PayloadReader reader(p.payload.subspan(1));
    const double stamp = reader.f64();
    const std::int32_t shown = reader.i32();
    if (number != 0) {
      if (shown != number) continue;
      times.push_back(Steady::now() - sent);
      stamps.push_back(skinctl::nanoseconds(stamp - sent_stamp));
    } else if (shown != 0) {
      number = shown & 0xffff;  // of an earlier client
    }
    number = (number & 0xffff) + 1;
    PackageWriter write(package::data);
    write.u8(in);
    write.i32(number);
    sent = Steady::now();
    sent_stamp = stamp;
    if (!rtde.write(write.finish(), Timeout(100))) throw ConnectionError("the robot's RTDE hung up");
  }
  const auto half = static_cast<std::ptrdiff_t>(times.size() / 2);
  RoundTrip trip;
  trip.echoes = echoes;
  trip.longest = *std::max_element(times.begin(), times.end());
  trip.controller_longest = *std::max_element(stamps.begin(), stamps.end());
  std::nth_element(times.begin(), times.begin() + half, times.end());
  std::nth_element(stamps.begin(), stamps.begin() + half, stamps.end());
  trip.median = times[static_cast<std::size_t>(half)];
  trip.controller_median = stamps[static_cast<std::size_t>(half)];
  return trip;
}

}  // namespace adapters::ur5
