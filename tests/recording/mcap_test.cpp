// Promise: a file survives its writer: every message of every whole chunk reads, and `recover` ends it
// Tried: 1000 cuts, SIGKILL, a full disk, a byte that changed, 20 000 damaged files. Also:
// `examples/fuzz`

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <csignal>
#include <filesystem>
#include <random>

#include "skinctl/io/ros_messages.hpp"
#include "skinctl/recording/mcap_file.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;
using Bytes = std::vector<unsigned char>;

namespace {

/// A sink in memory, which can refuse.
struct Memory {
  Bytes bytes;
  bool refuses = false;
  bool write(std::span<const unsigned char> b) {
    if (!refuses) bytes.insert(bytes.end(), b.begin(), b.end());
    return !refuses;
  }
};
struct Sent {
  std::string topic;
  Nanoseconds time;
  Bytes bytes;
  friend bool operator==(const Sent&, const Sent&) = default;
};
/// What a writer is given: `n` messages on three topics, 2 ms apart, of 0 to 400 bytes.
template <class Writer>
std::vector<Sent> write_messages(Writer& writer, int n) {
  std::mt19937 random(4);
  CHECK(writer.metadata("facts", {{"a", "1"}, {"b", "two"}}));
  const std::array channels = {std::pair("/a", writer.channel("/a", ros::JointState::type())),
                               std::pair("/b", writer.channel("/b", ros::String::type())),
                               std::pair("/c", writer.channel("/c", "x-own"))};
  std::vector<Sent> sent;
  for (int k = 0; k < n; ++k) {
    const auto& [topic, channel] = channels[random() % 3];
    Bytes bytes(random() % 400);
    for (auto& b : bytes) b = static_cast<unsigned char>(random());
    writer.write(channel, k * 2ms, bytes);
    sent.push_back({topic, k * 2ms, bytes});
  }
  return sent;
}
std::vector<Sent> read_messages(std::span<const unsigned char> file, McapContents* contents = nullptr) {
  std::vector<Sent> out;
  const auto found = read_mcap(file, [&](const McapMessage& m) {
    out.push_back({m.channel.topic, m.time, {m.bytes.begin(), m.bytes.end()}});
  });
  if (contents != nullptr) *contents = found;
  return out;
}
bool begins_with(const std::vector<Sent>& whole, const std::vector<Sent>& part) {
  return part.size() <= whole.size() && std::equal(part.begin(), part.end(), whole.begin());
}
/// Ends of the chunks in a file, by its records alone.
std::vector<std::pair<std::size_t, std::size_t>> chunk_ends(const Bytes& file) {
  std::vector<std::pair<std::size_t, std::size_t>> out;  // end, messages up to there
  std::size_t messages = 0;
  for (std::size_t at = 8; at + 9 <= file.size() - 8;) {
    std::uint64_t length = 0;
    std::memcpy(&length, &file[at + 1], 8);
    if (file[at] == 6) {
      for (std::size_t in = at + 9 + 40; in < at + 9 + length;) {
        std::uint64_t inner = 0;
        std::memcpy(&inner, &file[in + 1], 8);
        messages += file[in] == 5;
        in += 9 + inner;
      }
      out.emplace_back(at + 9 + length, messages);
    }
    at += 9 + length;
  }
  return out;
}
Bytes contents_of(const std::string& path) {
  const MappedFile file(path);
  return {file.bytes().begin(), file.bytes().end()};
}
void put_file(const std::string& path, std::span<const unsigned char> bytes) {
  FileSink sink(path);
  REQUIRE(sink.write(bytes));
}
std::string path_of(const char* name) {
  return (std::filesystem::temp_directory_path() / (std::string("skinctl_mcap_") + name + ".mcap")).string();
}

}  // namespace

TEST_CASE("CRC-32: the check value of the standard, in pieces of any length") {
  const Bytes digits = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  CHECK(detail::crc32(digits) == 0xcbf43926u);
  for (std::size_t k = 0; k <= digits.size(); ++k) {
    const auto whole = std::span<const unsigned char>(digits);
    CHECK(detail::crc32(whole.subspan(k), detail::crc32(whole.first(k))) == 0xcbf43926u);
  }
}

TEST_CASE("Mcap: what is written is read, chunks close at their size and at their time") {
  Memory memory;
  McapWriter writer(memory, {.chunk_size = 4096, .chunk_time = 100ms});
  const auto sent = write_messages(writer, 2000);
  CHECK(writer.finish());
  CHECK(writer.lost() == 0);
  CHECK(writer.written() == 2000);
  McapContents contents;
  CHECK(read_messages(memory.bytes, &contents) == sent);
  CHECK(contents.whole);
  CHECK(contents.damaged == 0);
  CHECK(contents.profile == "ros2");
  CHECK(contents.metadata.at("facts") == std::map<std::string, std::string>{{"a", "1"}, {"b", "two"}});
  CHECK(contents.summary.messages() == 2000);
  REQUIRE(contents.summary.channels.size() == 3);
  CHECK(contents.summary.schemas.size() == 2);
  for (const auto& chunk : contents.summary.chunks) {
    CHECK(chunk.size < 4096 + 500 + 2000);  // the message that fills it, the schemas
    CHECK(chunk.last - chunk.first < 100'000'000);
  }
  CHECK(contents.summary.chunks.size() > 40);

  SUBCASE("slow messages: a chunk a second") {
    Memory slow;
    McapWriter by_time(slow);
    const auto channel = by_time.channel("/a", "x");
    for (int k = 0; k < 100; ++k) CHECK(by_time.write(channel, k * 250ms, Bytes{1}));
    CHECK(by_time.finish());
    read_messages(slow.bytes, &contents);
    CHECK(contents.summary.chunks.size() == 25);
  }
}

TEST_CASE(
    "Mcap: of 1000 cuts every message of every whole chunk reads, and recover makes a whole file of it") {
  Memory memory;
  McapWriter writer(memory, {.chunk_size = 3000});
  const auto sent = write_messages(writer, 600);
  REQUIRE(writer.finish());
  const auto ends = chunk_ends(memory.bytes);
  REQUIRE(ends.size() > 30);
  std::mt19937 random(7);
  const auto path = path_of("cut");
  const int cuts = testing::sanitized ? 100 : 1000;
  for (int k = 0; k < cuts; ++k) {
    const std::size_t cut = k < 20 ? static_cast<std::size_t>(k) : random() % memory.bytes.size();
    const std::span<const unsigned char> part(memory.bytes.data(), cut);
    std::size_t expected = 0;
    for (const auto& [end, messages] : ends)
      if (end <= cut) expected = messages;
    McapContents contents;
    const auto read = read_messages(part, &contents);
    REQUIRE(read.size() == expected);
    REQUIRE(begins_with(sent, read));
    CHECK_FALSE(contents.whole);
    if (k % 5 != 0) continue;
    put_file(path, part);
    if (cut < 8) {
      CHECK_THROWS_AS(static_cast<void>(recover(path)), ConfigurationError);
      continue;
    }
    const auto done = recover(path);
    CHECK(done.messages == expected);
    const auto mended = contents_of(path);
    McapContents after;
    REQUIRE(read_messages(mended, &after) == read);
    CHECK(after.whole);
    // The indexes that the recovered file has are those that a whole one has.
    for (const auto& chunk : after.summary.chunks)
      for (const auto& [id, place] : chunk.index_offsets) CHECK(mended.at(place) == 7);
    CHECK(recover(path).was_whole);
    CHECK(contents_of(path) == mended);
  }
  std::filesystem::remove(path);
}

TEST_CASE("Mcap: a byte that changed in a chunk loses that chunk, and no other") {
  Memory memory;
  McapWriter writer(memory, {.chunk_size = 3000});
  const auto sent = write_messages(writer, 300);
  REQUIRE(writer.finish());
  const auto ends = chunk_ends(memory.bytes);
  Bytes damaged = memory.bytes;
  damaged[ends[3].first - 20] ^= 1;
  McapContents contents;
  auto expected = sent;
  expected.erase(expected.begin() + static_cast<std::ptrdiff_t>(ends[2].second),
                 expected.begin() + static_cast<std::ptrdiff_t>(ends[3].second));
  CHECK(read_messages(damaged, &contents) == expected);
  CHECK(contents.damaged == 1);
}

namespace {
/// A file as `McapWriter` writes it, with its chunks taken apart into records of the file.
Bytes without_chunks(const Bytes& file, bool ended = true) {
  Bytes out(file.begin(), file.begin() + 8);
  for (std::size_t at = 8; at + 9 <= file.size() - 8;) {
    std::uint64_t length = 0;
    std::memcpy(&length, &file[at + 1], 8);
    const auto begin = file.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end = begin + 9 + static_cast<std::ptrdiff_t>(length);
    if (file[at] == 6) {
      out.insert(out.end(), begin + 9 + 40, end);
    } else if (file[at] == 1 || file[at] == 12) {
      out.insert(out.end(), begin, end);
    }
    at += 9 + length;
  }
  const Bytes end = detail::mcap::Summary{}.close(out.size());
  if (ended) out.insert(out.end(), end.begin(), end.end());
  return out;
}
}  // namespace

TEST_CASE("Mcap: messages outside of chunks are read, counted and recovered") {
  Memory memory;
  McapWriter writer(memory, {.chunk_size = 3000});
  const auto sent = write_messages(writer, 300);
  REQUIRE(writer.finish());
  McapContents contents;
  CHECK(read_messages(without_chunks(memory.bytes), &contents) == sent);
  CHECK(contents.whole);
  CHECK(contents.left_out().empty());
  CHECK(contents.summary.messages() == 300);
  CHECK(contents.summary.times() == std::pair(std::uint64_t(0), std::uint64_t(299 * 2'000'000)));

  const std::string path = path_of("loose");
  Bytes cut = without_chunks(memory.bytes, false);
  cut.resize(cut.size() * 2 / 3);
  put_file(path, cut);
  const auto done = recover(path);
  CHECK(done.messages > 150);
  CHECK(done.left_out.empty());
  const auto kept = read_messages(contents_of(path), &contents);
  CHECK(contents.whole);
  CHECK(kept.size() == done.messages);
  CHECK(begins_with(sent, kept));
  std::filesystem::remove(path);
}

TEST_CASE(
    "Mcap: a chunk without a CRC is read; compressed ones are called what they are, and never touched") {
  Memory memory;
  McapWriter writer(memory, {.chunk_size = 3000});
  const auto sent = write_messages(writer, 100);
  REQUIRE(writer.finish());
  const auto ends = chunk_ends(memory.bytes);
  std::size_t last = 8;
  std::uint64_t length = 0;
  for (std::size_t at = 8; at < ends.back().first; at += 9 + length) {
    std::memcpy(&length, &memory.bytes[at + 1], 8);
    if (memory.bytes[at] == 6) last = at;
  }
  Bytes plain = memory.bytes;
  std::memset(&plain[last + 9 + 24], 0, 4);
  McapContents contents;
  CHECK(read_messages(plain, &contents) == sent);
  CHECK(contents.left_out().empty());

  Bytes packed = plain;  // the name is put in; what follows it is compressed for all a reader knows
  const char name[] = {4, 0, 0, 0, 'z', 's', 't', 'd'};
  packed.insert(packed.begin() + static_cast<std::ptrdiff_t>(last + 9 + 28 + 4), name + 4, name + 8);
  packed[last + 9 + 28] = 4;
  std::memcpy(&length, &packed[last + 1], 8);
  length += 4;
  std::memcpy(&packed[last + 1], &length, 8);
  const auto rest = read_messages(packed, &contents);
  CHECK(rest.size() == ends[ends.size() - 2].second);
  CHECK(contents.damaged == 0);
  CHECK(contents.left_out().starts_with("1 chunks are compressed (zstd)"));
  const std::string path = path_of("packed");
  packed.resize(packed.size() - 20);
  put_file(path, packed);
  CHECK_THROWS_AS(static_cast<void>(recover(path)), ConfigurationError);
  CHECK(contents_of(path) == packed);
  std::filesystem::remove(path);
}

TEST_CASE("Mcap: any bytes are refused or read, never beyond their end") {
  Memory memory;
  McapWriter writer(memory, {.chunk_size = 600});
  write_messages(writer, 12);
  REQUIRE(writer.finish());
  std::mt19937 random(8);
  for (int k = 0; k < (testing::sanitized ? 2'000 : 20'000); ++k) {
    Bytes bytes = memory.bytes;
    for (auto n = 1 + random() % 4; n > 0; --n)
      bytes[8 + random() % (bytes.size() - 8)] =
          static_cast<unsigned char>(random() % 3 == 0 ? 255 : random());
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    McapContents contents;
    CHECK(read_messages(bytes, &contents).size() <= 12);
  }
}

TEST_CASE("McapWriter: what a sink refuses is counted, and everything after it can be read without it") {
  for (const int from : {0, 100, 250}) {
    Memory memory;
    memory.refuses = from == 0;
    McapWriter writer(memory, {.chunk_size = 2000});
    const auto a = writer.channel("/a", ros::String::type());
    std::vector<Sent> sent;
    for (int k = 0; k < 500; ++k) {
      memory.refuses = k >= from && k < from + 100;
      writer.write(a, k * 1ms, Bytes(100, static_cast<unsigned char>(k)));
    }
    CHECK(writer.finish());
    McapContents contents;
    const auto read = read_messages(memory.bytes, &contents);
    CHECK(contents.whole);
    CHECK(contents.damaged == 0);
    CHECK(read.size() + writer.lost() == 500);
    CHECK(writer.lost() >= 90);
    CHECK(writer.lost() <= 115);
  }
}

TEST_CASE("FileSink: on a full disk the file ends with a whole chunk, and messages are counted") {
  // The disk: a file that may not grow beyond 40 kB, in a process of its own.
  const auto path = path_of("full");
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{40'000, 40'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    FileSink sink(path);
    McapWriter writer(sink, {.chunk_size = 3000});
    const auto a = writer.channel("/a", ros::String::type());
    for (int k = 0; k < 1000; ++k) writer.write(a, k * 1ms, Bytes(100, static_cast<unsigned char>(k)));
    const bool refused = !writer.finish() && sink.refused() > 0;
    ::_exit(refused && writer.written() + writer.lost() == 1000 && writer.lost() > 600 ? 0 : 1);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  McapContents contents;
  const auto read = read_messages(contents_of(path), &contents);
  CHECK(read.size() > 250);
  CHECK(contents.data_end == std::filesystem::file_size(path));  // nothing half
  CHECK(recover(path).messages == read.size());
  CHECK(read_messages(contents_of(path)).size() == read.size());
  if (std::filesystem::exists("/dev/full")) {
    FileSink full("/dev/full");
    McapWriter writer(full);
    const auto a = writer.channel("/a", "x");
    CHECK(writer.write(a, 0ns, Bytes{1}));
    CHECK_FALSE(writer.finish());
    CHECK(writer.lost() == 1);
  }
  CHECK_THROWS_AS(FileSink("/nowhere/at/all"), ConfigurationError);
  std::filesystem::remove(path);
}

TEST_CASE("FileSink: after SIGKILL every chunk that was written reads, and recover ends the file") {
  const auto path = path_of("killed");
  for (const int wait_ms : {3, 20}) {
    std::filesystem::remove(path);
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      FileSink sink(path);
      McapWriter writer(sink, {.chunk_size = 20'000});
      const auto a = writer.channel("/a", ros::String::type());
      for (int k = 0;; ++k) writer.write(a, k * 1ms, Bytes(100, static_cast<unsigned char>(k)));
    }
    while (!std::filesystem::exists(path) || std::filesystem::file_size(path) < 100'000) ::usleep(500);
    ::usleep(static_cast<unsigned>(wait_ms) * 1000);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    McapContents contents;
    const auto read = read_messages(contents_of(path), &contents);
    CHECK(contents.damaged == 0);
    CHECK(std::filesystem::file_size(path) - contents.data_end < 30'000);  // all but the last chunk
    for (std::size_t k = 0; k < read.size(); ++k)
      REQUIRE(read[k].bytes == Bytes(100, static_cast<unsigned char>(k)));
    CHECK(recover(path).messages == read.size());
    McapContents after;
    CHECK(read_messages(contents_of(path), &after).size() == read.size());
    CHECK(after.whole);
  }
  std::filesystem::remove(path);
}
