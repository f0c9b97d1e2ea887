// The main job from end to end: streamed and recorded at once, while a client stops it, lets it go on and
// changes the weights of its laws. The file replays to the bit, and readers that share nothing with the
// library find the streamed numbers in it.
//
// Promise: a run that is streamed, recorded, stopped, resumed and weighed at once replays to the bit, and
// others hear and read the same numbers
// Tried: the main job, 500 cycles: a client written byte by byte, Foxglove's own (@foxglove/ws-protocol),
// then Python and @mcap/core on the file, every joint state and torque share that was streamed
//
// Promise: a killed job leaves a file that replays as far as it goes
// Tried: the main job, SIGKILL once 1.5 MB are written; after `recover` the same cycles
//
// Promise: a full disk costs the file, not the run
// Tried: the main job onto /dev/full: it ends well and says what the disk refused. Also:
// `recording/mcap_test.cpp`

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "examples/live_page/tests/byte_client.hpp"

using live_page::call_of;
using live_page::Client;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

/// A program that runs beside the test.
struct Running {
  explicit Running(const std::string& command) : pipe(::popen((command + " 2>&1").c_str(), "r")) {
    REQUIRE(pipe != nullptr);
  }
  ~Running() {
    if (pipe != nullptr) ::pclose(pipe);
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  /// The rest of the next line that begins so; empty at its end.
  std::string line(const std::string& begin) {
    char part[4096];
    while (std::fgets(part, sizeof part, pipe) != nullptr) {
      text += part;
      if (std::string(part).starts_with(begin)) return std::string(part).substr(begin.size());
    }
    return {};
  }
  int end() {
    line("\n\n");
    const int status = ::pclose(std::exchange(pipe, nullptr));
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::FILE* pipe;
  std::string text;
};

/// The time of a streamed message.
std::int64_t time_of(const std::string& message) {
  std::int64_t t = 0;
  std::memcpy(&t, message.data() + 5, sizeof t);
  return t;
}

/// Doubles of a CDR sequence in a message.
std::vector<double> doubles_at(const std::string& message, std::size_t at, std::size_t n) {
  std::vector<double> out(n);
  REQUIRE(at + 8 * n <= message.size());
  std::memcpy(out.data(), message.data() + at, 8 * n);
  return out;
}

struct Streamed {
  std::map<std::int64_t, std::vector<double>> joints;  ///< positions, velocities, torques by time
  std::map<std::int64_t, std::vector<double>> shares;
  std::int64_t counts_again = 0;  ///< the time at which the skin was given its weight back
};

/// Watches and meddles until the job ends.
Streamed watched(std::uint16_t port) {
  Client client(port);
  const std::string host = "127.0.0.1:" + std::to_string(port);
  REQUIRE(client.send(Client::get("/", host, Client::upgrade("foxglove.sdk.v1"))));
  REQUIRE(client.reply().find("101") != std::string::npos);
  const json info = client.text("serverInfo");
  CHECK(info["metadata"]["range of weight of spline joint"] == "[0.1,1.0]");
  CHECK_FALSE(info["metadata"].contains("range of weight of gravity"));
  const json offered = client.text("advertise");
  std::map<std::string, int> channels;
  for (const json& c : offered["channels"]) channels[c["topic"]] = c["id"];
  std::map<std::string, std::uint32_t> services;
  const json callable = client.text("advertiseServices");
  for (const json& s : callable["services"]) services[s["name"]] = s["id"];
  json subscriptions = json::array();
  for (const char* topic : {"/joint_states", "/skinctl/torque_shares", "/skinctl/status", "/skin/contacts"})
    subscriptions.push_back({{"id", channels.at(topic)}, {"channelId", channels.at(topic)}});
  REQUIRE(client.say({{"op", "subscribe"}, {"subscriptions", subscriptions}}));
  const auto weigh = [&](const char* law, double weight) {
    REQUIRE(client.say({{"op", "setParameters"},
                        {"parameters", {{{"name", std::string("weight of ") + law}, {"value", weight}}}},
                        {"id", law}}));
  };

  Streamed out;
  std::int64_t first = 0;
  int done = 0, refused = 0, answered = 0, told = 0, stopping = 0, contacts = 0;
  std::string ended;
  while (const auto f = client.next(std::chrono::milliseconds(2000))) {
    if (f->op == 8) break;
    if (f->op == 1) {
      const json m = json::parse(f->payload);
      if (m["op"] == "status" && m.value("id", "") == "ended") {
        ended = m["message"];
      } else if (m["op"] == "status") {
        ++refused;
        CHECK(m["message"].get<std::string>().find("0.05") != std::string::npos);
      }
      told += m["op"] == "parameterValues" && m.contains("id");
      continue;
    }
    if (f->op != 2) continue;
    const std::string& message = f->payload;
    if (message[0] == 3) {
      ++answered;
      CHECK(message[20] == 1);
      continue;
    }
    const std::int64_t time = time_of(message);
    const auto channel = static_cast<std::uint8_t>(message[1]);
    if (channel == channels["/skinctl/status"]) stopping += message.find("\"stopping\"") != std::string::npos;
    if (channel == channels["/skin/contacts"]) ++contacts;
    if (channel == channels["/skinctl/torque_shares"])
      out.shares[time] = doubles_at(message, message.size() - 8 * 18, 18);
    if (channel != channels["/joint_states"]) continue;
    // Three sequences of six doubles, each behind its length and aligned, end the message.
    std::vector<double> all;
    for (const std::size_t k : {2u, 1u, 0u})
      for (const double x : doubles_at(message, message.size() - 48 - 56 * k, 6)) all.push_back(x);
    out.joints[time] = all;
    if (first == 0) first = time;
    const double t = 1e-9 * double(time - first);
    // Less firmness, no skin, a stop, and after the touch has begun the skin again.
    if (done == 0 && t > 0.2) {
      ++done;
      weigh("spline joint", 0.5), weigh("skin joint", 0), weigh("spline joint", 0.05);
    }
    if (done == 1 && t > 0.6) {
      ++done;
      REQUIRE(client.frame(2, call_of(services.at("/skinctl/stop"), 1)));
    }
    if (done == 2 && t > 1.2) {
      ++done;
      REQUIRE(client.frame(2, call_of(services.at("/skinctl/resume"), 2)));
    }
    if (done == 3 && t > 2.3) {
      ++done;
      out.counts_again = time;
      weigh("skin joint", 1);
    }
  }
  CHECK(done == 4);
  CHECK(refused == 1);
  CHECK_FALSE(ended.empty());
  CHECK(answered == 2);
  CHECK(told == 4);
  CHECK(stopping > 2);
  CHECK(contacts > 50);
  CHECK(out.joints.size() > 400);
  return out;
}

/// What a reader that prints a line of JSON for each message has found.
void check_reader(const std::string& command, const Streamed& streamed) {
  Running reader(command);
  std::size_t joints = 0, shares = 0, different = 0, contacts = 0;
  double without = 0, with = 0;
  char* room = nullptr;
  std::size_t size = 0;
  while (::getline(&room, &size, reader.pipe) > 0) {
    const json line = json::parse(room, nullptr, false);
    REQUIRE_MESSAGE(!line.is_discarded(), room);
    if (!line.contains("topic")) continue;
    const std::string topic = line["topic"];
    const std::int64_t time = line["time"];
    const json& m = line.contains("message") ? line["message"] : json();
    if (topic == "/skin/contacts") contacts += m["width"].get<int>() > 0;
    if (topic == "/joint_states" && streamed.joints.contains(time)) {
      std::vector<double> all = m["position"];
      for (const char* more : {"velocity", "effort"})
        for (const double x : m[more]) all.push_back(x);
      ++joints, different += all != streamed.joints.at(time);
    }
    if (topic != "/skinctl/torque_shares") continue;
    const std::vector<double> all = m["data"];
    REQUIRE(all.size() == 18);
    if (streamed.shares.contains(time)) ++shares, different += all != streamed.shares.at(time);
    double& most = time <= streamed.counts_again ? without : with;
    for (std::size_t i = 6; i < 12; ++i) most = std::max(most, std::abs(all[i]));
  }
  std::free(room);
  CHECK(reader.end() == 0);
  CHECK(joints == streamed.joints.size());
  CHECK(shares == streamed.shares.size());
  CHECK(different == 0);
  CHECK(contacts > 3);
  CHECK(without == 0);  // the touch is there, and has no weight
  CHECK(with > 1);
}

const std::string job = MAIN_JOB, quiet = " --no-compare --report '' --quiet --record ";
std::string path_of(const char* name) {
  return (fs::temp_directory_path() / ("skinctl_" + std::to_string(::getpid()) + name)).string();
}

/// What Foxglove's own client heard of the same run.
void check_foxglove(Running& client, const Streamed& streamed) {
  std::size_t joints = 0, different = 0, contacts = 0, cells = 0, parameters = 0, answers = 0;
  char* room = nullptr;
  std::size_t size = 0;
  while (::getline(&room, &size, client.pipe) > 0) {
    const json line = json::parse(room, nullptr, false);
    REQUIRE_MESSAGE(!line.is_discarded(), room);
    parameters += line.contains("parameters") && line["parameters"].size() == 2;
    answers += line.contains("service") && line["callId"] == 7 && line["answer"]["success"] == true;
    if (!line.contains("topic")) continue;
    const std::string topic = line["topic"];
    contacts += topic == "/skin/contacts";
    cells += topic == "/skin/cells" && line["message"]["width"] == 260 &&
             line["message"]["data"].size() == 260 * 64;
    const std::int64_t time = line["time"];
    if (topic != "/joint_states" || !streamed.joints.contains(time)) continue;
    std::vector<double> all = line["message"]["position"];
    for (const char* more : {"velocity", "effort"})
      for (const double x : line["message"][more]) all.push_back(x);
    ++joints, different += all != streamed.joints.at(time);
  }
  std::free(room);
  CHECK(client.end() == 0);
  CHECK(parameters == 1);
  CHECK(answers == 1);
  CHECK(joints > 200);
  CHECK(different == 0);
  CHECK(contacts > 30);
  CHECK(cells > 30);
}

}  // namespace

TEST_CASE("main job: killed while it records, its file replays as far as it goes, and is given an end") {
  const std::string path = path_of("_killed.mcap");
  // As soon as there is something to keep, however slow the machine is.
  Running killed(job + " --speed 1" + quiet + path + " & pid=$!; for k in $(seq 600); do " +
                 "[ \"$(stat -c %s " + path +
                 " 2>/dev/null || echo 0)\" -gt 1500000 ] && break; sleep 0.05; done; "
                 "kill -KILL $pid; wait $pid");
  CHECK(killed.end() != 0);
  Running replay("timeout 40 " + job + " --replay " + path);
  CHECK(replay.line(path).find("was cut") != std::string::npos);
  const std::string said = replay.line("replayed ");
  CHECK(std::atoi(said.c_str()) > 50);
  CHECK(said.find("every command is the same to the bit") != std::string::npos);
  CHECK(replay.end() == 0);
  Running recover(std::string(RECORD_PROGRAM) + " recover " + path);
  CHECK(recover.end() == 0);
  Running again("timeout 40 " + job + " --replay " + path);
  CHECK(again.line("replayed ") == said);
  CHECK(again.text.find("was cut") == std::string::npos);
  fs::remove(path);
}

TEST_CASE("main job: a disk that is full costs the file, not the run") {
  Running run("timeout 40 " + job + " --cycles 300" + quiet + "/dev/full");
  CHECK(run.line("/dev/full is not whole: 0 cycles found no room").find("refused by the disk") !=
        std::string::npos);
  CHECK(run.end() == 0);
}

TEST_SUITE_BEGIN("real time");

TEST_CASE(
    "main job: what was streamed and recorded at once replays to the bit, and others read the streamed "
    "numbers") {
  const std::string path = path_of("_streamed.mcap");
  Running run("timeout 40 " + job +
              " --live --live-port 0 --allow-control --no-compare --report '' --cycles 500 --record " + path);
  const std::string at = run.line("live: http://127.0.0.1:");
  REQUIRE_MESSAGE(!at.empty(), run.text);
  const char* given = std::getenv("SKINCTL_NODE_MODULES");
  const std::string folder = given != nullptr ? given : RECORD_MODULES, readers = RECORD_READERS;
  const bool node = std::system("node --version >/dev/null 2>&1") == 0 &&
                    fs::exists(folder + "/node_modules/@foxglove/ws-protocol");
  if (!node)
    std::fprintf(stderr, "SKIPPED: no node, or no readers in %s (examples/skinctl_record fetches them)\n",
                 folder.c_str());
  std::optional<Running> foxglove;
  if (node)
    foxglove.emplace("timeout 40 node " + readers + "/foxglove.mjs " + folder +
                     " ws://127.0.0.1:" + std::to_string(std::atoi(at.c_str())));
  const Streamed streamed = watched(static_cast<std::uint16_t>(std::atoi(at.c_str())));
  const int ended = run.end();
  REQUIRE_MESSAGE(ended == 0, run.text);

  Running replay("timeout 40 " + job + " --replay " + path);
  CHECK(replay.line("replayed 500 cycles: ") == "every command is the same to the bit\n");
  CHECK(replay.end() == 0);

  if (std::system("python3 --version >/dev/null 2>&1") == 0) {
    check_reader("python3 " + readers + "/read.py " + path, streamed);
  } else {
    std::fprintf(stderr, "SKIPPED: no python3\n");
  }
  if (node) {
    check_reader("node " + readers + "/read.mjs " + folder + " " + path, streamed);
    check_foxglove(*foxglove, streamed);
  }
  fs::remove(path);
}

TEST_SUITE_END();
