// Skins that speak other languages: ROS 1 messages and bags, iCub's CAN; and the sender of our own.
//
// Promise: skins of other makers are read, whatever the bytes
// Tried: ROS 1 messages and bags (plain, bzip2, LZ4, cut short), iCub's CAN, 20 000 damaged messages, 500
// damaged bags; what is written is read back. Also: `examples/skin_bridge/tests/`

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "examples/adapters/skin/bag.hpp"
#include "examples/adapters/skin/icub_can.hpp"
#include "examples/adapters/skin/receiver.hpp"
#include "examples/adapters/skin/ros1.hpp"
#include "examples/adapters/skin/sender.hpp"
#include "examples/adapters/socket.hpp"
#if SKINCTL_HAS_BZIP2
#include <bzlib.h>
#endif
#if SKINCTL_HAS_LZ4
#include <lz4frame.h>
#endif

using namespace adapters::skin;
using namespace std::chrono_literals;
using skinctl::CellSample;
using skinctl::Nanoseconds;
using Bytes = std::vector<std::uint8_t>;

namespace {

CellSample sample(std::uint32_t cell, std::int64_t time) {
  const float x = static_cast<float>(cell % 100);
  return {.time = Nanoseconds(time),
          .cell = cell,
          .force = {0.25f, 0.5f, x / 128},
          .proximity = x / 256,
          .acceleration = {0, -9.80665f, 1},
          .temperature = 31.5f};
}
void check_equal(const CellSample& a, const CellSample& b) {
  CHECK(a.time == b.time);
  CHECK(a.cell == b.cell);
  CHECK(a.force == b.force);
  CHECK(a.proximity == b.proximity);
  for (std::size_t k = 0; k < 3; ++k) CHECK(a.acceleration[k] == doctest::Approx(b.acceleration[k]));
  CHECK(a.temperature == b.temperature);
}
struct TemporaryFile {
  explicit TemporaryFile(const char* name)
      : path((std::filesystem::temp_directory_path() / (std::to_string(std::random_device{}()) + name))
                 .string()) {}
  ~TemporaryFile() { std::filesystem::remove(path); }
  void write(const std::string& text) const { std::ofstream(path, std::ios::binary) << text; }
  [[nodiscard]] std::string text() const {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::string path;
};
std::string little(std::uint32_t x) {
  return {static_cast<char>(x), static_cast<char>(x >> 8), static_cast<char>(x >> 16),
          static_cast<char>(x >> 24)};
}
std::string record(const std::vector<std::string>& fields, const std::string& data) {
  std::string header;
  for (const auto& f : fields) header += little(static_cast<std::uint32_t>(f.size())) + f;
  return little(static_cast<std::uint32_t>(header.size())) + header +
         little(static_cast<std::uint32_t>(data.size())) + data;
}
/// A bag with one message per chunk, in a chunk as it is given.
std::string bag_of(const std::string& compression, const std::string& chunk, std::size_t size) {
  return "#ROSBAG V2.0\n" + record({std::string("op=\x03", 4)}, std::string(100, ' ')) +
         record({std::string("op=\x05", 4), "compression=" + compression,
                 "size=" + little(static_cast<std::uint32_t>(size))},
                chunk);
}
std::string chunk_text(const std::string& message) {
  return record({std::string("op=\x07", 4), "conn=" + little(3), "topic=/skin"}, little(8) + "type=a/B") +
         record({std::string("op=\x02", 4), "conn=" + little(3), "time=" + little(12) + little(34)}, message);
}
void reads(const std::string& bag, const std::string& message) {
  const TemporaryFile file("reads.bag");
  file.write(bag);
  BagReader reader(file.path);
  BagMessage m;
  const bool found = reader.next(m);  // an exception is for the caller
  REQUIRE(found);
  CHECK(m.topic == "/skin");
  CHECK(m.type == "a/B");
  CHECK(m.time == 12s + 34ns);
  CHECK(std::string(m.bytes.begin(), m.bytes.end()) == message);
  CHECK_FALSE(reader.next(m));
  CHECK_FALSE(reader.cut_short());
}

}  // namespace

TEST_CASE("ROS 1: a message byte for byte, and back") {
  const Bytes one{1,    0,    0,    0,                                // one cell
                  7,    0,    0,    0,                                // cellId
                  0x15, 0xcd, 0x5b, 7, 0, 0, 0, 0,                    // ts = 123456789 ns
                  1,    0,    0,    0, 0, 0, 0, 0, 0, 0, 0xe0, 0x3f,  // prox 0.5
                  0,    0,    0,    0,                                // no force
                  1,    0,    0,    0, 0, 0, 0, 0, 0, 0, 0xf0, 0xbf,  // acc -1 g
                  0,    0,    0,    0};
  std::vector<CellSample> out;
  REQUIRE(parse_ros1(one, out));
  REQUIRE(out.size() == 1);
  CHECK(out[0].cell == 7);
  CHECK(out[0].time == 123456789ns);
  CHECK(out[0].proximity == 0.5f);
  CHECK(out[0].force == std::array<float, 3>{});
  CHECK(out[0].acceleration[0] == doctest::Approx(-9.80665));
  CHECK(out[0].temperature == 0);

  std::vector<CellSample> many;
  for (std::uint32_t i = 0; i < 260; ++i) many.push_back(sample(i, -5 + std::int64_t{i} * 4'000'000));
  out.clear();
  REQUIRE(parse_ros1(ros1_message(many), out));
  REQUIRE(out.size() == many.size());
  for (std::size_t i = 0; i < many.size(); ++i) check_equal(out[i], many[i]);
}

TEST_CASE("ROS 1: bytes that are no message add nothing") {
  const std::vector<CellSample> two{sample(1, 10), sample(2, 20)};
  const Bytes good = ros1_message(two);
  std::vector<CellSample> out{sample(9, 9)};
  for (std::size_t n = 0; n < good.size(); ++n) CHECK_FALSE(parse_ros1({good.data(), n}, out));
  Bytes longer = good;
  longer.push_back(0);
  CHECK_FALSE(parse_ros1(longer, out));
  Bytes lies = good;
  lies[3] = 0x7f;  // two thousand million cells
  CHECK_FALSE(parse_ros1(lies, out));
  lies = good;
  lies[19] = 0xff;  // and sensors
  CHECK_FALSE(parse_ros1(lies, out));
  CHECK_FALSE(parse_ros1(good, out, {.max_cells = 1}));
  CHECK(out.size() == 1);

  std::mt19937 rng(3);
  for (int k = 0; k < 20000; ++k) {
    Bytes bytes = good;
    for (std::size_t n = 1 + rng() % 4; n > 0; --n)
      bytes[rng() % bytes.size()] = static_cast<std::uint8_t>(rng());
    bytes.resize(rng() % 3 ? bytes.size() : rng() % bytes.size());
    out.clear();
    if (parse_ros1(bytes, out)) CHECK(out.size() <= 2);
  }
}

TEST_CASE("bags: what the writer writes the reader reads, chunk by chunk") {
  const TemporaryFile file("written.bag");
  std::vector<Bytes> messages;
  {
    BagWriter writer(file.path, "/skin", skin_message_type, skin_message_definition, skin_message_md5);
    for (std::uint32_t i = 0; i < 60; ++i) {
      std::vector<CellSample> samples;
      for (std::uint32_t c = 0; c < 260; ++c) samples.push_back(sample(c, std::int64_t{i} * 4'000'000));
      messages.push_back(ros1_message(samples));
      writer.write(1'700'000'000s + i * 4ms, messages.back());
    }
    writer.close();
  }
  BagReader reader(file.path);
  BagMessage m;
  std::size_t n = 0;
  while (reader.next(m)) {
    REQUIRE(n < messages.size());
    CHECK(m.topic == "/skin");
    CHECK(m.type == skin_message_type);
    CHECK(m.time == 1'700'000'000s + n * 4ms);
    CHECK(std::equal(m.bytes.begin(), m.bytes.end(), messages[n].begin(), messages[n].end()));
    ++n;
  }
  CHECK(n == messages.size());
  CHECK_FALSE(reader.cut_short());

  const std::string whole = file.text();
  file.write(whole.substr(0, whole.size() * 2 / 3));  // its recorder was killed
  BagReader cut(file.path);
  n = 0;
  while (cut.next(m)) ++n;
  CHECK(cut.cut_short());
  CHECK(n > 10);
  CHECK(n < messages.size());
}

TEST_CASE("bags: messages outside of chunks") {
  reads("#ROSBAG V2.0\n" + record({std::string("op=\x03", 4)}, std::string(100, ' ')) + chunk_text("message"),
        "message");
}

TEST_CASE("bags: compressed ones") {
  const std::string chunk = chunk_text(std::string(5000, 'm') + "essage");
  reads(bag_of("none", chunk, chunk.size()), std::string(5000, 'm') + "essage");
#if SKINCTL_HAS_BZIP2
  std::string packed(chunk.size() + 1000, '\0');
  auto n = static_cast<unsigned>(packed.size());
  REQUIRE(BZ2_bzBuffToBuffCompress(packed.data(), &n, const_cast<char*>(chunk.data()),
                                   static_cast<unsigned>(chunk.size()), 9, 0, 0) == BZ_OK);
  packed.resize(n);
  reads(bag_of("bz2", packed, chunk.size()), std::string(5000, 'm') + "essage");
  CHECK_THROWS_AS(reads(bag_of("bz2", packed, chunk.size() - 1), ""), BagError);
  CHECK_THROWS_AS(reads(bag_of("bz2", packed.substr(0, n / 2), chunk.size()), ""), BagError);
#else
  MESSAGE("skipped: no libbz2");
#endif
#if SKINCTL_HAS_LZ4
  std::string small(LZ4F_compressFrameBound(chunk.size(), nullptr), '\0');
  const std::size_t k = LZ4F_compressFrame(small.data(), small.size(), chunk.data(), chunk.size(), nullptr);
  REQUIRE(LZ4F_isError(k) == 0);
  small.resize(k);
  reads(bag_of("lz4", small, chunk.size()), std::string(5000, 'm') + "essage");
  CHECK_THROWS_AS(reads(bag_of("lz4", small, chunk.size() + 1), ""), BagError);
  CHECK_THROWS_AS(reads(bag_of("lz4", small.substr(0, k / 2), chunk.size()), ""), BagError);
#else
  MESSAGE("skipped: no liblz4");
#endif
  CHECK_THROWS_WITH_AS(reads(bag_of("zip", chunk, chunk.size()), ""),
                       doctest::Contains("known: none, bz2, lz4"), BagError);
}

TEST_CASE("bags: damaged ones are refused with the file's name, or read as far as they go") {
  const TemporaryFile file("damaged.bag");
  file.write("#ROSBAG V1.2\n");
  CHECK_THROWS_WITH_AS(BagReader{file.path}, doctest::Contains("is no bag of format 2.0"), BagError);
  CHECK_THROWS_AS(BagReader{file.path + "x"}, BagError);
  const std::string chunk = chunk_text("hello");
  const std::string good = bag_of("none", chunk, chunk.size());
  std::mt19937 rng(8);
  for (int k = 0; k < 500; ++k) {
    std::string text = good;
    for (std::size_t n = 1 + rng() % 3; n > 0; --n)
      text[13 + rng() % (text.size() - 13)] = static_cast<char>(rng() % 2 ? rng() : 0xff);
    if (rng() % 4 == 0) text.resize(13 + rng() % (text.size() - 13));
    file.write(text);
    BagReader reader(file.path);
    BagMessage m;
    try {
      for (int n = 0; n < 10 && reader.next(m); ++n) CHECK(m.bytes.size() < text.size());
    } catch (const BagError& e) {
      CHECK(std::string(e.what()).find(file.path) == 0);
    }
  }
}

TEST_CASE("iCub: frames of a triangle") {
  const std::array<std::uint8_t, 8> first{0x40, 255, 254, 200, 0, 255, 255, 128};
  const auto a = parse_icub(0x352, first);
  REQUIRE(a);
  CHECK(a->board == 5);
  CHECK(a->triangle == 2);
  CHECK(a->count == 7);
  CHECK(a->sample(0, 5ms).cell == 5 * 192 + 2 * 12);
  CHECK(a->sample(0, 5ms).force[0] == 0);
  CHECK(a->sample(3, 5ms).force[0] == 1);
  CHECK(a->sample(3, 5ms).time == 5ms);
  const std::array<std::uint8_t, 8> second{0xc0, 1, 2, 3, 4, 5, 9, 9};
  const auto b = parse_icub(0x352, second);
  REQUIRE(b);
  CHECK(b->count == 5);
  CHECK(b->sample(4, 0ns).cell == 5 * 192 + 2 * 12 + 11);
  CHECK(b->sample(4, 0ns).force[0] == doctest::Approx(250 / 255.0));
  CHECK(parse_icub(0x352, {second.data(), 6}));  // boards without flags
  CHECK_FALSE(parse_icub(0x352, {second.data(), 5}));
  CHECK_FALSE(parse_icub(0x352, {first.data(), 7}));
  CHECK_FALSE(parse_icub(0x352, {}));
  CHECK_FALSE(parse_icub(0x252, first));
  CHECK_FALSE(parse_icub(0x80000352, first));  // an error frame of the system
  CHECK_FALSE(parse_icub(0x352, std::array<std::uint8_t, 8>{0x41, 1, 2, 3, 4, 5, 6, 7}));
  for (const auto& frame : {*a, *b}) {
    const auto again = parse_icub(icub_identifier(frame), icub_data(frame));
    REQUIRE(again);
    CHECK(again->raw == frame.raw);
    CHECK(again->first == frame.first);
  }
}

TEST_CASE("sender: what it sends arrives, in datagrams of any number of samples") {
  Receiver receiver({.clock = {.gather = 0ns}, .real_time = false});
  Sender sender("127.0.0.1", receiver.port());
  CHECK_THROWS_AS(Sender("no address", 1), adapters::ConnectionError);
  std::vector<CellSample> samples;
  for (std::uint32_t i = 0; i < 100; ++i) samples.push_back(sample(i, 1'000'000'000 + i));
  CHECK(sender.send({}, 1s) == 1);  // the first one gives the offset of the clocks
  CHECK(receiver.poll(5s).empty());
  CHECK(sender.send(samples, 1001ms) == 4);
  const auto heard = receiver.poll(5001ms);
  REQUIRE(heard.size() == 100);
  for (std::size_t i = 0; i < 100; ++i) {
    CHECK(heard[i].cell == i);
    CHECK(heard[i].force == samples[i].force);
    CHECK(std::abs((heard[i].time - samples[i].time - 4s).count()) < 100'000);
  }
  CHECK(receiver.statistics().lost == 0);
  CHECK(receiver.statistics().datagrams == 5);
}
