// Readers that others wrote, or that were written from the specifications alone, agree on every field of a
// file.
//
// Promise: readers that others wrote agree on every field, CRC, index and hash
// Tried: 420 messages of seven topics: Python from the specifications alone, @mcap/core with
// rosmsg2-serialization. Also: `examples/skinctl_record/tests`

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "examples/skinctl_record/csv.hpp"
#include "examples/support/own_input.hpp"
#include "skinctl/io/contact_cloud.hpp"
#include "skinctl/io/skin_cloud.hpp"
#include "skinctl/recording/mcap_file.hpp"
#include "tests/support/comma_locale.hpp"

using namespace skinctl;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

struct Ran {
  int exit = -1;
  std::string out;
};
Ran run(const std::string& command) {
  Ran ran;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  REQUIRE(pipe != nullptr);
  char block[65536];
  for (std::size_t n; (n = std::fread(block, 1, sizeof block, pipe)) > 0;) ran.out.append(block, n);
  ran.exit = WEXITSTATUS(::pclose(pipe));
  return ran;
}

json stamp(Nanoseconds t) {
  return {{"sec", t.count() / 1'000'000'000}, {"nanosec", t.count() % 1'000'000'000}};
}
json header(Nanoseconds t, const char* frame) {
  return {{"stamp", stamp(t)}, {"frame_id", frame}};
}
template <class Fields>
json fields_of(const Fields& fields) {
  json out = json::array();
  for (const auto& f : fields)
    out.push_back({{"name", f.name}, {"offset", f.offset}, {"datatype", int(f.number)}, {"count", 1}});
  return out;
}
template <class V>
void put(json& data, V value) {
  unsigned char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  for (const auto b : bytes) data.push_back(b);
}

/// Writes a file, and what is in it: in words of its own, not by the encoders.
json write_file(const std::string& path) {
  json expected = json::array();
  FileSink sink(path);
  McapWriter writer(sink, {.chunk_size = 20'000, .chunk_time = 100ms});
  const auto joints = writer.channel("/joint_states", ros::JointState::type());
  const auto tf = writer.channel("/tf", ros::Transforms::type());
  const auto cells = writer.channel("/skin/cells", SkinCloud::type());
  const auto contacts = writer.channel("/skin/contacts", ros::PointCloud::type());
  const auto shares = writer.channel("/skinctl/torque_shares", ros::Matrix::type());
  const auto status = writer.channel("/skinctl/status", ros::String::type());
  const auto own = writer.channel("/skinctl/cycle", "x-skinctl-cycle");
  CHECK(writer.metadata("skinctl", {{"scene", "a \"scene\""}}));

  std::mt19937 random(11);
  const auto any = [&] { return std::ldexp(double(random()), -20) - 2048; };
  const auto anyf = [&] { return float(random() % 65536) / 65536; };
  std::vector<SkinCloud::Cell> homes;
  for (std::uint32_t i = 0; i < 12; ++i) homes.push_back({7 * i, i / 4, {anyf(), anyf(), anyf()}});
  SkinCloud cloud(homes, {.newtons = 2});
  std::vector<CellSample> last(12);
  std::vector<bool> heard(12);
  std::vector<unsigned char> bytes(65536);
  const auto send = [&](McapChannel channel, const char* topic, Nanoseconds t, int k, const auto& message,
                        const json& content) {
    CdrWriter w(bytes);
    ros::encode(w, message);
    REQUIRE(w.fits());
    CHECK(writer.write(channel, t, w.bytes()));
    expected.push_back({{"topic", topic}, {"time", t.count()}, {"sequence", k}, {"message", content}});
  };
  for (int k = 0; k < 60; ++k) {
    const Nanoseconds t = 1'700'000'000s + k * 8'000'001ns;
    const std::vector<std::string> names = {"a", "joint_b", "ä"};
    const std::vector<double> q = {any(), any(), any()}, dq = {any(), -0.0, 1e-300}, tau(k % 2 == 0 ? 3 : 0);
    send(joints, "/joint_states", t, k, ros::JointState{t, "", names, q, dq, tau},
         {{"header", header(t, "")}, {"name", names}, {"position", q}, {"velocity", dq}, {"effort", tau}});

    const std::vector<double> all = {any(), any(), any(), any(), any(), any()};
    send(shares, "/skinctl/torque_shares", t, k, ros::Matrix{{"skin,reach", "joint"}, 2, 3, all},
         {{"layout",
           {{"dim",
             {{{"label", "skin,reach"}, {"size", 2}, {"stride", 6}},
              {{"label", "joint"}, {"size", 3}, {"stride", 3}}}},
            {"data_offset", 0}}},
          {"data", all}});

    // A turn whose quaternion is (0.5, 0.5, 0.5, 0.5), and none.
    const Xyz<double> p{any(), any(), any()};
    const ros::StampedTransform two[2] = {{t, "base_link", "tool0", p, {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}},
                                          {t, "tool0", "tip", {0, 0, 0}, {}}};
    const auto one = [&](const char* parent, const char* child, const Xyz<double>& at, double xyz, double w) {
      return json{{"header", header(t, parent)},
                  {"child_frame_id", child},
                  {"transform",
                   {{"translation", {{"x", at.x}, {"y", at.y}, {"z", at.z}}},
                    {"rotation", {{"x", xyz}, {"y", xyz}, {"z", xyz}, {"w", w}}}}}};
    };
    send(tf, "/tf", t, k, ros::Transforms{std::span(two).first(std::size_t(k % 3))},
         {{"transforms", k % 3 == 0   ? json::array()
                         : k % 3 == 1 ? json::array({one("base_link", "tool0", p, 0.5, 0.5)})
                                      : json{one("base_link", "tool0", p, 0.5, 0.5),
                                             one("tool0", "tip", {0, 0, 0}, 0, 1)}}});

    const std::vector<ContactPoint> touched(std::size_t(k % 4),
                                            ContactPoint{{1, 2, 3}, {anyf(), 5, 6}, 0.25f, 4});
    json points = json::array();
    for (const auto& c : touched) {
      for (const float x :
           {c.position[0], c.position[1], c.position[2], c.force[0], c.force[1], c.force[2], c.area})
        put(points, x);
      put(points, c.link);
    }
    const auto cloud_of = [&](const char* frame, const json& fields, std::size_t step, std::size_t n,
                              const json& data) {
      return json{{"header", header(t, frame)}, {"height", 1},           {"width", n},
                  {"fields", fields},           {"is_bigendian", false}, {"point_step", step},
                  {"row_step", step * n},       {"data", data},          {"is_dense", true}};
    };
    send(contacts, "/skin/contacts", t, k, contact_cloud(t, "base_link", touched),
         cloud_of("base_link", fields_of(ContactPoint::fields), 32, touched.size(), points));

    send(status, "/skinctl/status", t, k, ros::String{"{\"cycle\":" + std::to_string(k) + "}"},
         {{"data", "{\"cycle\":" + std::to_string(k) + "}"}});

    for (int n = 0; n < 3; ++n) {
      const std::size_t i = random() % 12;
      heard[i] = true;
      last[i] = {t - Nanoseconds(random() % 5'000'000),
                 homes[i].id,
                 {anyf(), anyf(), anyf()},
                 anyf(),
                 {anyf(), anyf(), anyf()},
                 30 + anyf()};
      CHECK(cloud.set(last[i]));
    }
    json data = json::array();
    for (std::size_t i = 0; i < 12; ++i) {
      const auto& s = last[i];
      const auto age = heard[i] ? (t - s.time).count() : 2'147'483'647;
      for (const float x : {homes[i].position[0], homes[i].position[1], homes[i].position[2],
                            2 * (s.force[0] + s.force[1] + s.force[2]), s.proximity, s.temperature})
        put(data, x);
      put(data, homes[i].id);
      put(data, std::uint32_t(age > 100'000'000 ? 1 : 0));
      for (const float x : s.force) put(data, x);
      put(data, std::int32_t(age));
      for (const float x : s.acceleration) put(data, x);
      put(data, unsaid), put(data, unsaid);
    }
    CHECK(writer.write(cells, t, cloud.encode(t)));
    expected.push_back({{"topic", "/skin/cells"},
                        {"time", t.count()},
                        {"sequence", k},
                        {"message", cloud_of("base_link", fields_of(SkinPoint::fields), 64, 12, data)}});
    const unsigned char three[3] = {1, 2, static_cast<unsigned char>(k)};
    char hex[8];
    std::snprintf(hex, sizeof hex, "0102%02x", unsigned(k));
    CHECK(writer.write(own, t, three));
    expected.push_back({{"topic", "/skinctl/cycle"}, {"time", t.count()}, {"sequence", k}, {"hex", hex}});
  }
  CHECK(writer.finish());
  std::sort(expected.begin(), expected.end(), [](const json& a, const json& b) {
    return std::tuple(a["time"].get<std::int64_t>(), a["topic"].get<std::string>()) <
           std::tuple(b["time"].get<std::int64_t>(), b["topic"].get<std::string>());
  });
  return expected;
}

/// What a reader printed, line by line, against what was written. Types are left to `types`.
void check_lines(const std::string& out, const json& expected, json* types = nullptr) {
  std::istringstream lines(out);
  std::size_t k = 0, different = 0;
  for (std::string line; std::getline(lines, line);) {
    const json got = json::parse(line, nullptr, false);
    REQUIRE_MESSAGE(!got.is_discarded(), line);
    if (got.contains("type")) {
      if (types != nullptr) types->push_back(got);
      continue;
    }
    REQUIRE(k < expected.size());
    if (got != expected[k] && ++different < 3)
      FAIL_CHECK("read\n", got.dump(), "\nwritten\n", expected[k].dump());
    ++k;
  }
  CHECK(k == expected.size());
  CHECK(different == 0);
}
std::string path_of(const char* name) {
  return (fs::temp_directory_path() / (std::string("skinctl_record_") + name)).string();
}

/// The folder with the libraries of others, as they are or fetched once; nothing of this is part of a build.
/// Empty: none.
std::string node_modules() {
  const char* given = std::getenv("SKINCTL_NODE_MODULES");
  const std::string folder = given != nullptr ? given : RECORD_MODULES;
  if (run("node --version").exit != 0) {
    std::fprintf(stderr, "SKIPPED: no node\n");
    return {};
  }
  if (!fs::exists(folder + "/node_modules/@foxglove/ws-protocol")) {
    fs::create_directories(folder);
    const auto fetched = run("cd " + folder +
                             " && timeout 90 npm install --no-save --no-audit --no-fund --ignore-scripts "
                             "@mcap/core@2.2.2 @foxglove/rosmsg@5.0.5 @foxglove/rosmsg2-serialization@3.1.0 "
                             "@foxglove/ws-protocol@0.8.0 ws@8.23.0");
    if (fetched.exit != 0) {
      std::fprintf(
          stderr,
          "SKIPPED: npm cannot fetch the readers (SKINCTL_NODE_MODULES may name a folder with them)\n");
      return {};
    }
  }
  return folder;
}

}  // namespace

TEST_CASE("readers: Python, from the specifications alone, by the index: every field, CRC and hash") {
  if (run("python3 --version").exit != 0) {
    std::fprintf(stderr, "SKIPPED: no python3\n");
    return;
  }
  const auto path = path_of("python.mcap");
  const json expected = write_file(path);
  const auto read = run(std::string("python3 ") + RECORD_READERS + "/read.py " + path);
  REQUIRE_MESSAGE(read.exit == 0, read.out);
  json types = json::array();
  check_lines(read.out, expected, &types);
  CHECK(types.size() == 5);

  SUBCASE("and of a file that was cut and recovered") {
    fs::resize_file(path, fs::file_size(path) * 2 / 3);
    CHECK(run(std::string("python3 ") + RECORD_READERS + "/read.py " + path).exit != 0);
    const auto done = run(std::string(RECORD_PROGRAM) + " recover " + path);
    CHECK(done.exit == 0);
    const auto again = run(std::string("python3 ") + RECORD_READERS + "/read.py " + path);
    REQUIRE_MESSAGE(again.exit == 0, again.out);
    const auto lines = std::size_t(std::count(again.out.begin(), again.out.end(), '\n')) - 5;
    CHECK(lines > expected.size() / 2);
    // By time, so that of the last cycle's topics some are missing: compare the cycles before it.
    json first = json::array();
    for (std::size_t k = 0; k < (lines / 7 - 1) * 7; ++k) first.push_back(expected[k]);
    std::string begin;
    std::istringstream in(again.out);
    for (std::string line; first.size() + 5 > std::size_t(std::count(begin.begin(), begin.end(), '\n')) &&
                           std::getline(in, line);)
      begin += line + '\n';
    check_lines(begin, first);
  }
  fs::remove(path);
}

TEST_CASE("readers: @mcap/core and rosmsg2-serialization, by the index: every field") {
  const std::string folder = node_modules();
  if (folder.empty()) return;
  const auto path = path_of("node.mcap");
  const json expected = write_file(path);
  const auto read = run(std::string("node ") + RECORD_READERS + "/read.mjs " + folder + " " + path);
  REQUIRE_MESSAGE(read.exit == 0, read.out);
  check_lines(read.out, expected);
  fs::remove(path);
}

TEST_CASE(
    "readers: what @mcap/core writes outside of chunks is read, and what it compresses is said to be left "
    "out") {
  const std::string folder = node_modules();
  if (folder.empty()) return;
  const auto path = path_of("foreign.mcap");
  const std::string program = RECORD_PROGRAM, write = std::string("node ") + RECORD_READERS + "/write.mjs ";
  auto made = run(write + folder + " " + path + " plain");
  REQUIRE_MESSAGE(made.exit == 0, made.out);
  auto told = run(program + " info " + path);
  CHECK_MESSAGE(told.exit == 0, told.out);
  CHECK(told.out.find("100 messages") != std::string::npos);
  CHECK(told.out.find("0.990 s") != std::string::npos);
  told = run(program + " csv " + path + " /words");
  CHECK(told.exit == 0);
  CHECK(told.out.find("0.990000000,\"word 99\"") != std::string::npos);

  made = run(write + folder + " " + path + " deflate");
  REQUIRE_MESSAGE(made.exit == 0, made.out);
  for (const char* command : {" info ", " csv "}) {
    told = run(program + command + path + (std::string(command) == " csv " ? " /words" : ""));
    CHECK(told.exit != 0);
    CHECK_MESSAGE(told.out.find("chunks are compressed (deflate)") != std::string::npos, told.out);
  }
  fs::remove(path);
}

TEST_CASE("skinctl_record: a table is not written onto its recording") {
  const auto path = path_of("own.mcap");
  static_cast<void>(write_file(path));
  std::ifstream in(path, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(in), {}};
  examples::check_own_input_is_kept(RECORD_PROGRAM, "csv IN /joint_states --output OUT", content, 2);
  fs::remove(path);
}

TEST_CASE("skinctl_record: info, recover and csv of a file, and words for what is none") {
  const auto path = path_of("program.mcap");
  const json expected = write_file(path);
  const std::string program = RECORD_PROGRAM;
  auto told = run(program + " info " + path);
  CHECK(told.exit == 0);
  CHECK(told.out.find("420 messages") != std::string::npos);
  CHECK(told.out.find("scene: a \"scene\"") != std::string::npos);
  CHECK(told.out.find("60  /skin/cells") != std::string::npos);
  CHECK(told.out.find("sensor_msgs/msg/PointCloud2") != std::string::npos);
  CHECK(run(program + " recover " + path).out.find("whole, not touched") != std::string::npos);

  const auto table = [&](const char* topic) {
    const MappedFile file(path);
    std::ostringstream out;
    const auto [lines, left_out] = skinctl_record::write_csv(file.bytes(), topic, out);
    CHECK(left_out.empty());
    return std::pair(lines, out.str());
  };
  const auto [cells, text] = table("/skin/cells");
  CHECK(cells == 60 * 12);
  CHECK(text.starts_with(
      "time,stamp,x,y,z,force,proximity,temperature,cell,status,force1,force2,force3,age,ax,ay,az,"
      "measured,unrest\n"));
  const auto [joints, states] = table("/joint_states");
  CHECK(joints == 60);
  {
    const skinctl::testing::CommaLocale comma;
    CHECK((table("/joint_states").second == states));
    CHECK((table("/skin/cells").second == text));
  }
  std::istringstream lines(states);
  std::string head, first;
  std::getline(lines, head), std::getline(lines, first);
  CHECK(head ==
        "time,stamp,a.position,joint_b.position,ä.position,a.velocity,joint_b.velocity,ä.velocity,a.effort,"
        "joint_b.effort,ä.effort");
  const auto q = expected[0]["message"]["position"];
  std::vector<double> values;
  std::istringstream in(first);
  for (std::string cell; std::getline(in, cell, ',');) values.push_back(std::stod(cell));
  REQUIRE(values.size() == 11);
  for (std::size_t i = 0; i < 3; ++i) CHECK(values[2 + i] == q[i].get<double>());
  CHECK(table("/tf").first == 60);
  CHECK(table("/skin/contacts").first == 90);
  CHECK(table("/skinctl/torque_shares").first == 60);
  CHECK(table("/skinctl/status").second.find("\"{\"\"cycle\"\":0}\"") != std::string::npos);
  CHECK_THROWS_WITH_AS(table("/none"), doctest::Contains("there are /joint_states, "), ConfigurationError);
  CHECK_THROWS_WITH_AS(table("/skinctl/cycle"), doctest::Contains("x-skinctl-cycle"), ConfigurationError);

  fs::resize_file(path, fs::file_size(path) / 2);
  told = run(program + " info " + path);
  CHECK(told.exit == 1);
  CHECK(told.out.find("the file was cut") != std::string::npos);
  std::ofstream(path) << "nothing";
  CHECK(run(program + " info " + path).exit == 2);
  CHECK(run(program + " recover " + path).exit == 2);
  CHECK(run(program + " info /nowhere").out.find("No such file") != std::string::npos);
  fs::remove(path);
}

TEST_CASE("view: the page and the whole recording are served, and Ctrl-C ends it with 0") {
  if (run("python3 --version").exit != 0) {
    std::fprintf(stderr, "SKIPPED: no python3\n");
    return;
  }
  const auto path = path_of("viewed.mcap");
  static_cast<void>(write_file(path));
  const auto script = path_of("view.py");
  std::ofstream(script) << R"py(
import re, signal, subprocess, sys, urllib.request
program = subprocess.Popen([sys.argv[1], 'view', sys.argv[2]], stdout=subprocess.PIPE, text=True)
page = re.search(r'(http://127\.0\.0\.1:\d+/)\?file=recording\.mcap', program.stdout.readline()).group(1)
get = lambda name: urllib.request.urlopen(page + name, timeout=10).read()
assert get('recording.mcap') == open(sys.argv[2], 'rb').read()
assert b'app.js' in get('') and b'"stop"' in get('reasons.js')
program.send_signal(signal.SIGINT)
sys.exit(program.wait(10))
)py";
  const auto viewed = run("python3 " + script + " " + RECORD_PROGRAM + " " + path);
  CHECK_MESSAGE(viewed.exit == 0, viewed.out);
  CHECK(run(std::string(RECORD_PROGRAM) + " view " + path + ".missing").exit == 2);
}
