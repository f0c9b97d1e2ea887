// Promise: messages are those of ROS 2 without ROS; their hashes follow from the definitions
// Tried: five published hashes and one of another type, goldens of other encoders, every cut of a
// message, 20 000 random ones. Also: `io/ros_messages_test.cpp`

#include "skinctl/io/cdr.hpp"

#include <doctest/doctest.h>

#include <array>
#include <random>
#include <string>
#include <vector>

using namespace skinctl;

namespace {

std::string hex(std::span<const unsigned char> bytes) {
  std::string out;
  for (const unsigned char b : bytes) out += "0123456789abcdef"[b >> 4], out += "0123456789abcdef"[b & 15];
  return out;
}

/// Members of every size behind one another, so that each needs padding.
void write_all(CdrWriter& w) {
  w.put(std::uint8_t(7));
  w.put(std::uint64_t(0x0102030405060708));
  w.put(true);
  w.put(std::int16_t(-2));
  w.put(std::string_view("abc"));
  w.put(1.5f);
  const std::array<double, 2> numbers = {1, -2};
  w.sequence(numbers);
  w.sequence(std::vector<double>());
  w.put(std::uint8_t(9));
}

}  // namespace

TEST_CASE("CDR: members are aligned to their size behind the header, an empty sequence has no padding") {
  std::array<unsigned char, 128> bytes;
  bytes.fill(0xaa);
  CdrWriter w(bytes);
  write_all(w);
  CHECK(w.fits());
  CHECK(hex(w.bytes()) ==
        "00010000"
        "0700000000000000"
        "0807060504030201"
        "0100feff"
        "0400000061626300"
        "0000c03f"
        "0200000000000000"
        "000000000000f03f"
        "00000000000000c0"
        "00000000"
        "09");
  CdrReader r(w.bytes());
  CHECK(r.get<std::uint8_t>() == 7);
  CHECK(r.get<std::uint64_t>() == 0x0102030405060708);
  CHECK(r.get<bool>());
  CHECK(r.get<std::int16_t>() == -2);
  CHECK(r.text() == "abc");
  CHECK(r.get<float>() == 1.5f);
  REQUIRE(r.count(8) == 2);
  CHECK(r.get<double>() == 1);
  CHECK(r.get<double>() == -2);
  CHECK(r.count(8) == 0);
  CHECK(r.get<std::uint8_t>() == 9);
  CHECK(r.fits());
  CHECK(r.left() == 0);
}

TEST_CASE("CDR: a message that does not fit is counted, and nothing is written behind the end") {
  std::vector<unsigned char> whole(128);
  CdrWriter reference(whole);
  write_all(reference);
  const std::size_t size = reference.size();
  for (std::size_t room = 0; room <= size; ++room) {
    std::vector<unsigned char> bytes(room + 16, 0xaa);
    CdrWriter w(std::span<unsigned char>(bytes).first(room));
    write_all(w);
    CHECK(w.size() == size);
    CHECK(w.fits() == (room == size));
    CHECK(w.bytes().size() == (room == size ? size : 0));
    for (std::size_t i = room; i < bytes.size(); ++i) REQUIRE(bytes[i] == 0xaa);
  }
}

TEST_CASE("CDR: of a message that is cut anywhere the missing members are zero, and it does not fit") {
  std::vector<unsigned char> whole(128);
  CdrWriter w(whole);
  write_all(w);
  for (std::size_t cut = 0; cut < w.size(); ++cut) {
    const std::vector<unsigned char> bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut));
    CdrReader r(bytes);
    static_cast<void>(r.get<std::uint8_t>());
    static_cast<void>(r.get<std::uint64_t>());
    static_cast<void>(r.get<bool>());
    static_cast<void>(r.get<std::int16_t>());
    static_cast<void>(r.text());
    static_cast<void>(r.get<float>());
    for (std::size_t n = r.count(8); n > 0; --n) static_cast<void>(r.get<double>());
    static_cast<void>(r.count(8));
    CHECK(r.get<std::uint8_t>() == 0);
    CHECK_FALSE(r.fits());
  }
}

TEST_CASE("CDR: other headers, texts without an end and counts beyond the message are refused") {
  const auto first = [](std::vector<unsigned char> bytes, auto read) {
    CdrReader r(bytes);
    read(r);
    return r.fits();
  };
  const auto number = [](CdrReader& r) { static_cast<void>(r.get<std::uint32_t>()); };
  CHECK(first({0, 1, 0, 0, 1, 0, 0, 0}, number));
  CHECK(first({0, 1, 0, 3, 1, 0, 0, 0}, number));  // options say how a sender padded: nothing to us
  CHECK_FALSE(first({0, 0, 0, 0, 0, 0, 0, 1}, number));
  CHECK_FALSE(first({0, 7, 0, 0, 1, 0, 0, 0}, number));
  CHECK_FALSE(first({0, 1, 0}, number));
  CHECK_FALSE(first({}, number));
  const auto text = [](CdrReader& r) { CHECK(r.text().empty()); };
  CHECK(first({0, 1, 0, 0, 0, 0, 0, 0}, text));
  CHECK_FALSE(first({0, 1, 0, 0, 2, 0, 0, 0, 'a', 'b'}, text));
  CHECK_FALSE(first({0, 1, 0, 0, 3, 0, 0, 0, 'a', 0}, text));
  CHECK_FALSE(first({0, 1, 0, 0, 255, 255, 255, 255, 'a', 0}, text));
  const auto count = [](CdrReader& r) { CHECK(r.count(8) == 0); };
  CHECK_FALSE(first({0, 1, 0, 0, 1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7}, count));
  CHECK_FALSE(first({0, 1, 0, 0, 255, 255, 255, 255, 1}, count));
}

TEST_CASE("CDR: random bytes are read without a step outside of them") {
  std::mt19937 random(3);
  for (int k = 0; k < 20'000; ++k) {
    std::vector<unsigned char> bytes(random() % 64);
    for (auto& b : bytes) b = static_cast<unsigned char>(random() % 4 == 0 ? random() : 0);
    if (bytes.size() > 1) bytes[0] = 0, bytes[1] = 1;
    CdrReader r(bytes);  // the sanitized build watches
    for (int n = 0; n < 12; ++n) switch (random() % 4) {
        case 0:
          static_cast<void>(r.get<double>());
          break;
        case 1:
          static_cast<void>(r.text());
          break;
        case 2:
          CHECK(r.count(4) <= bytes.size() / 4);
          break;
        default:
          static_cast<void>(r.get<std::uint8_t>());
      }
    CHECK(r.left() <= bytes.size());
  }
}
