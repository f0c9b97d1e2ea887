// The bridge as a user runs it: a bag becomes datagrams, datagrams become a bag.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "examples/adapters/skin/bag.hpp"
#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/skin/ros1.hpp"
#include "examples/adapters/skin/sender.hpp"
#include "examples/adapters/tests/ros1_peer.hpp"
#include "examples/support/own_input.hpp"

using namespace std::chrono_literals;
using namespace adapters::skin;
using skinctl::CellSample;
using skinctl::Nanoseconds;

namespace {

struct Program {
  explicit Program(const std::string& arguments)
      : pipe(::popen(
            (std::string("timeout 30 ") + SKIN_BRIDGE_PROGRAM + " -q " + arguments + " 2>&1").c_str(), "r")) {
    REQUIRE(pipe);
  }
  std::string line() {
    std::array<char, 256> chunk{};
    return std::fgets(chunk.data(), chunk.size(), pipe) ? chunk.data() : "";
  }
  int end() { return WEXITSTATUS(::pclose(pipe)); }
  std::FILE* pipe;
};
std::string temporary(const char* name) {
  return (std::filesystem::temp_directory_path() / ("skinctl_bridge_" + std::to_string(::getpid()) + name))
      .string();
}
std::vector<CellSample> touch(int k, Nanoseconds time) {
  std::vector<CellSample> out(40);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].cell = static_cast<std::uint32_t>(i);
    out[i].time = time - 2ms;
    out[i].force[0] = static_cast<float>(k) / 64;
  }
  return out;
}
Nanoseconds now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

}  // namespace

TEST_CASE("skin_bridge: a bag of a touch arrives as datagrams, at its pace") {
  const std::string file = temporary("in.bag");
  {
    BagWriter writer(file, "/arm/skin", skin_message_type, skin_message_definition, skin_message_md5);
    for (int k = 0; k < 30; ++k) writer.write(1000s + k * 10ms, ros1_message(touch(k, 1000s + k * 10ms)));
  }
  Receiver receiver({.clock = {.gather = 0ns}});
  Program bridge("--from bag:" + file + " --to udp:127.0.0.1:" + std::to_string(receiver.port()) +
                 " --speed 2");
  std::size_t heard = 0;
  float last = 0;
  Nanoseconds begin{}, end{};
  for (const auto start = now(); now() - start < 10s && heard < 30 * 40;) {
    for (const CellSample& s : receiver.poll(now())) {
      CHECK(s.force[0] >= last);
      last = s.force[0];
      ++heard;
      end = now();
      if (heard == 1) begin = end;
    }
    std::this_thread::sleep_for(1ms);
  }
  CHECK(bridge.line() == "30 messages, 1200 samples, 0 refused\n");
  CHECK(bridge.end() == 0);
  CHECK(heard == 30 * 40);
  CHECK(last == 29.0f / 64);
  CHECK(end - begin > 100ms);  // 0.29 s of bag at twice its pace
  CHECK(receiver.statistics().lost == 0);
  CHECK(receiver.statistics().bad_samples == 0);
  std::filesystem::remove(file);
}

TEST_CASE("skin_bridge: datagrams become a bag") {
  const std::string file = temporary("out.bag");
  Program bridge("--from udp:0 --to bag:" + file + " --topic /arm/skin --seconds 0.8");
  const std::string ready = bridge.line();
  REQUIRE(ready.starts_with("ready port="));
  Sender sender("127.0.0.1", static_cast<std::uint16_t>(std::stoi(ready.substr(11))));
  for (int k = 0; k < 60; ++k) {  // the receiver first listens for a tenth of a second
    sender.send(touch(k, now()), now());
    std::this_thread::sleep_for(5ms);
  }
  CHECK(bridge.line().find("0 refused") != std::string::npos);
  CHECK(bridge.end() == 0);
  BagReader bag(file);
  BagMessage m;
  std::vector<CellSample> samples;
  while (bag.next(m)) {
    CHECK(m.topic == "/arm/skin");
    CHECK(m.time > 1'500'000'000s);  // counted from 1970
    REQUIRE(parse_ros1(m.bytes, samples));
    CHECK(std::abs((samples.back().time - m.time).count()) < 100'000'000);
  }
  CHECK_FALSE(bag.cut_short());
  CHECK(samples.size() > 500);
  CHECK(samples.back().force[0] == 59.0f / 64);
  std::filesystem::remove(file);
}

#if SKINCTL_HAS_SODIUM
TEST_CASE(
    "skin_bridge: sealed, from bag to datagrams and from datagrams to a bag; one that nobody asks says so") {
  const std::string file = temporary("sealed.bag"), key = temporary("key"), out = temporary("sealed_out.bag");
  std::ofstream(key) << std::string(64, 'a');
  std::filesystem::permissions(key, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  {
    BagWriter writer(file, "/skin", skin_message_type, skin_message_definition, skin_message_md5);
    for (int k = 0; k < 100; ++k) writer.write(1000s + k * 5ms, ros1_message(touch(k / 4, 1000s + k * 5ms)));
  }
  Program to("--from udp:0 --to bag:" + out + " --seconds 2 --key " + key);
  const std::string ready = to.line();
  REQUIRE(ready.starts_with("ready port="));
  Program from("--from bag:" + file + " --key " + key +
               " --to udp:127.0.0.1:" + std::to_string(std::stoi(ready.substr(11))));
  CHECK(from.line() == "100 messages, 4000 samples, 0 refused\n");
  CHECK(from.end() == 0);
  CHECK(to.line().find("of a sender that had heard no question yet") != std::string::npos);
  const std::string sum = to.line();
  CHECK_MESSAGE(sum.find(" 0 refused") != std::string::npos, sum);
  CHECK(to.end() == 0);
  BagReader bag(out);
  BagMessage m;
  std::vector<CellSample> samples;
  while (bag.next(m)) REQUIRE(parse_ros1(m.bytes, samples));
  CHECK(samples.size() > 2500);  // the clock is followed after a tenth of a second
  Program unheard("--from bag:" + file + " --key " + key + " --to udp:127.0.0.1:9 --speed 10");
  CHECK(unheard.line().find("no receiver with this key has asked") != std::string::npos);
  unheard.end();
  for (const auto& each : {file, key, out}) std::filesystem::remove(each);
}
#endif

TEST_CASE("skin_bridge: iCub's taxels come through an adapter at a serial line") {
  const int adapter = ::posix_openpt(O_RDWR | O_NOCTTY);
  REQUIRE(adapter >= 0);
  REQUIRE(::grantpt(adapter) == 0);
  REQUIRE(::unlockpt(adapter) == 0);
  const std::string line = ::ptsname(adapter);
  Receiver receiver({.clock = {.gather = 0ns}});
  Program bridge("--from icub:" + line + " --to udp:127.0.0.1:" + std::to_string(receiver.port()) +
                 " --seconds 0.6");
  const std::string frames = "t35284000FFFFFFFFFFFF\rt3528C0FFFFFFFF7F0000\rt1238C0FFFFFFFF7F0000\r";
  std::array<bool, 12> heard{};
  for (const auto start = now(); now() - start < 600ms;) {
    std::this_thread::sleep_for(20ms);
    CHECK(::write(adapter, frames.data(), frames.size()) == static_cast<ssize_t>(frames.size()));
    for (const CellSample& s : receiver.poll(now())) {
      REQUIRE(s.cell / 12 == 5 * 16 + 2);
      heard[s.cell % 12] = true;
      CHECK(s.force[0] == (s.cell % 12 == 0 ? 1.0f : s.cell % 12 == 11 ? 128.0f / 255 : 0.0f));
    }
  }
  for (const bool h : heard) CHECK(h);
  bridge.line();
  CHECK(bridge.end() == 0);
  ::close(adapter);
}

TEST_SUITE_BEGIN("real time");

TEST_CASE("skin_bridge: a topic of ROS 1 arrives as datagrams, on this computer's clock") {
  ros1_peer::Peer peer("/arm/skin");
  Receiver receiver({.clock = {.gather = 0ns}});
  Program bridge("--from ros1:" + std::to_string(peer.master_port()) +
                 " --topic /arm/skin --to udp:127.0.0.1:" + std::to_string(receiver.port()) + " --seconds 2");
  CHECK(bridge.line().starts_with("ready node=/skinctl_"));
  for (const auto start = now(); now() - start < 1s && peer.streams() == 0;) std::this_thread::sleep_for(1ms);
  REQUIRE(peer.streams() == 1);
  std::size_t heard = 0;
  float last = 0;
  for (int k = 0; k < 30; ++k) {
    peer.publish(ros1_message(touch(k, 1000s + k * 10ms)));  // a clock that began at another time
    std::this_thread::sleep_for(10ms);
    for (const CellSample& s : receiver.poll(now())) {
      CHECK(s.force[0] >= last);
      CHECK(now() - s.time < 200ms);
      last = s.force[0];
      ++heard;
    }
  }
  peer.publish({1, 2, 3});
  CHECK(bridge.line() == "30 messages, 1200 samples, 1 refused\n");
  CHECK(bridge.end() == 0);
  CHECK(heard == 30 * 40);
  CHECK(last == 29.0f / 64);
  CHECK(peer.calls() == "registerSubscriber requestTopic unregisterSubscriber ");
}

TEST_CASE("skin_bridge: ROS's own master and publisher are heard, message by message") {
  const std::string definition = temporary("definition"), file = temporary("ros.bag");
  std::ofstream(definition) << skin_message_definition;
  std::FILE* peer = ::popen((std::string("timeout 60 " ROSPY_PYTHON " " ROSPY_PUBLISHER " ") +
                             skin_message_md5 + " < " + definition + " 2>&1")
                                .c_str(),
                            "r");
  REQUIRE(peer);
  std::array<char, 256> chunk{};
  const std::string ready = std::fgets(chunk.data(), chunk.size(), peer) ? chunk.data() : "";
  if (ready.starts_with("ready port=")) {
    Program bridge("--from ros1:" + std::to_string(std::stoi(ready.substr(11))) + " --to bag:" + file +
                   " --seconds 5");
    bridge.line();
    const std::string said = std::fgets(chunk.data(), chunk.size(), peer) ? chunk.data() : "";
    CHECK(said == "published 100, connections 1\n");
    std::string result;
    for (std::string line = bridge.line(); !line.empty(); line = bridge.line()) result = line;
    CHECK(result == "100 messages, 4000 samples, 0 refused\n");
    CHECK(bridge.end() == 0);
    CHECK(WEXITSTATUS(::pclose(peer)) == 0);
    BagReader bag(file);
    BagMessage m;
    std::vector<CellSample> samples;
    for (float k = 0; bag.next(m); ++k) {
      samples.clear();
      REQUIRE(parse_ros1(m.bytes, samples));
      REQUIRE(samples.size() == 40);
      CHECK(samples[39].cell == 39);
      CHECK(samples[39].force[0] == k / 512);
      CHECK(samples[39].acceleration[2] == doctest::Approx(9.80665));
      CHECK(samples[39].proximity == 0.5f);
    }
  } else {
    CHECK_MESSAGE(WEXITSTATUS(::pclose(peer)) == 77, ready);
    MESSAGE("SKIPPED: no rospy (Debian: python3-rospy python3-rosmaster): ", ready);
  }
  std::filesystem::remove(definition);
  std::filesystem::remove(file);
}

TEST_SUITE_END();

TEST_CASE("skin_bridge: a bag is not written onto itself, nor onto the key") {
  const std::string file = temporary("whole.bag");
  {
    BagWriter bag(file, "/skin", skin_message_type, skin_message_definition, skin_message_md5);
    for (int k = 0; k < 50; ++k) bag.write(now() + k * 1ms, ros1_message(touch(k, now())));
    bag.close();
  }
  std::ifstream in(file, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(in), {}};
  REQUIRE(content.size() > 50'000);
  examples::check_own_input_is_kept(SKIN_BRIDGE_PROGRAM, "-q --from bag:IN --to bag:OUT", content, 2);
  examples::check_own_input_is_kept(SKIN_BRIDGE_PROGRAM, "-q --from udp:0 --key IN --to bag:OUT",
                                    std::string(64, 'a') + "\n", 2);
  std::filesystem::remove(file);
}

TEST_CASE("skin_bridge: a bag of which a part is left out does not end as carried") {
  const std::string file = temporary("part.bag"), to = temporary("carried.bag");
  const auto carried = [&](const std::string& more, int exit, const char* words) {
    Program bridge("-q --from bag:" + file + " --to bag:" + to + more);
    std::string said;
    for (std::string line = bridge.line(); !line.empty(); line = bridge.line()) said += line;
    CHECK(bridge.end() == exit);
    CHECK_MESSAGE(said.find(words) != std::string::npos, said);
  };
  {
    BagWriter bag(file, "/skin", skin_message_type, skin_message_definition, skin_message_md5);
    bag.write(now(), ros1_message(touch(1, now())));
    bag.write(now(), ros1_message(touch(2, now())));
    bag.close();
  }
  carried("", 0, "2 messages");
  carried(" --topic /other", 2, "no message of topic /other");
  {
    BagWriter bag(file, "/skin", skin_message_type, skin_message_definition, skin_message_md5);
    bag.write(now(), ros1_message(touch(1, now())));
    const std::vector<std::uint8_t> nonsense{1, 2, 3};
    bag.write(now(), nonsense);
    bag.close();
  }
  carried("", 1, "1 messages are none of a skin");
  for (const auto& name : {file, to}) std::filesystem::remove(name);
}

TEST_CASE("skin_bridge: what cannot be has words and an exit code") {
  for (const auto& [arguments, exit, words] :
       {std::tuple{"--from bag:/nowhere --to udp:1", 2, "is no bag"},
        {"--from magic:1 --to udp:1", 2, "expected ros1:[HOST:]PORT, bag:FILE"},
        {"--from udp:0 --to tcp:1", 2, "expected udp:"},
        {"--from ros1:1 --to udp:1", 1, "cannot reach the ROS master"},
        {"--from ros1:11311 --topic skin --to udp:1", 2, "ROS 1: topic 'skin'"},
        {"--from udp:0 --to udp:99999", 2, "expected HOST:PORT"},
        {"--from any-skin:/nowhere --to udp:1", 1, "serial line '/nowhere'"},
        {"--from papill-array:/dev/null --to udp:1", 1, "serial line '/dev/null': it is none"},
        {"--from datagrams:/dev/null --to udp:1", 1, "serial line '/dev/null': it is none"},
        {"--from datagrams:/nowhere --to udp:1 --baud 57600", 1, "no speed of 57600"},
        {"--from any-skin:/dev/null --to bag:/nowhere", 2, "a bag holds hexagons"},
        {"--from xela:127.0.0.1:9 --to udp:1", 1, "XELA's server at 127.0.0.1:9: connect: "},
        {"--from xela-forces:127.0.0.1:x --to udp:1", 2, "expected HOST:PORT"},
        {"--from icub:nocan0 --to udp:1", 1, "CAN"},
        {"--from icub:/nowhere --to udp:1", 1, "/nowhere"}}) {
    Program bridge(arguments);
    const std::string said = bridge.line();
    CHECK_MESSAGE(said.find(words) != std::string::npos, said);
    CHECK(bridge.end() == exit);
  }
}
