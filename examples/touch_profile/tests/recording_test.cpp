#include "examples/touch_profile/recording.hpp"

#include <doctest/doctest.h>

#include <random>
#include <sstream>

#include "skinctl/core/contract.hpp"

using namespace touch_profile;

namespace {

std::string slice(double reading = 243.5) {
  std::ostringstream out;
  out << "20.7 81 15.3 0.54 40.3 66.6 -36.2 55.5 2.0 \n14.0 15.0 11.0 14.0 11.0\n";
  for (std::size_t f = 0; f < fingers.size(); ++f)
    for (std::size_t i = 0; i < taxels_per_finger; ++i)
      out << reading - static_cast<double>(f) << (i + 1 < taxels_per_finger ? " " : "\n");
  return out.str();
}

Recording read(const std::string& text) {
  std::istringstream in(text);
  return read_recording(in, "grasp");
}

void refused(const std::string& text, const std::string& because) {
  CAPTURE(text);
  try {
    read(text);
    FAIL("accepted");
  } catch (const skinctl::ConfigurationError& e) {
    CHECK_MESSAGE(std::string(e.what()).find(because) != std::string::npos, e.what());
  }
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

}  // namespace

TEST_CASE("Recording: fingers and taxels in the order of the file, with any line end") {
  for (const bool dos : {false, true}) {
    std::string text = "-10000\n" + slice() + slice(200);
    if (dos)
      for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2)
        text.insert(at, 1, '\r');
    const Recording r = read(text);
    REQUIRE(r.slices.size() == 2);
    CHECK(r.slices[0].joints[6] == -36.2);
    CHECK(r.slices[0].strongest[1] == 15);
    for (std::size_t i = 0; i < taxel_count; ++i)
      CHECK(r.slices[1].taxels[i] == 200 - static_cast<double>(i / 12));
  }
  CHECK(read("-10000\n" + slice() + "\n \n").slices.size() == 1);
  const std::string text = "-10000\n" + slice();
  CHECK(read(text.substr(0, text.size() - 1)).slices.size() == 1);  // no line end at the end
}

TEST_CASE("Recording: what is wrong is said with its line") {
  const std::string good = "-10000\n" + slice();
  refused("", "empty");
  refused("\n" + good, "grasp:1: 0 numbers instead of 1");
  refused("-1000\n" + slice(), "outside -10000 to -10000");
  refused("-10000\n", "no time slice");
  refused("-10000 7\n" + slice(), "more than 1 numbers");
  refused(replaced(good, "14.0 15.0", "14.0"), "grasp:3: 4 numbers instead of 5");
  refused(replaced(good, "14.0 15.0", "14.0 15.0 3"), "grasp:3: more than 5 numbers");
  refused(replaced(good, "243.5 ", "255.5 "), "grasp:4: 255.5 is outside 0 to 255 (taxels of thumb)");
  refused(replaced(good, "242.5 ", "-1 "), "grasp:5: -1 is outside");
  refused(replaced(good, "81 ", "nan "), "grasp:2: no number");
  refused(replaced(good, "81 ", "81x "), "grasp:2: no number");
  refused(replaced(good, "81 ", "1e999 "), "grasp:2: no number");
  refused(replaced(good, "81 ", std::string("8\0 ", 3)), "grasp:2: no number");
  refused(good + "\n" + slice(), "an empty line between slices");
  refused("-10000\n" + std::string(5000, '1'), "longer than 4096");
  CHECK_THROWS_AS(read_recording_file("no/such/file.txt"), skinctl::ConfigurationError);
  CHECK_THROWS_AS(read_recording_file("/"), skinctl::ConfigurationError);
}

TEST_CASE("Recording: a file cut anywhere but behind a slice is refused, garbage never read beyond its end") {
  const std::string good = "-10000\n" + slice() + slice(180);
  const std::size_t one = std::string("-10000\n" + slice()).size();
  for (std::size_t length = 0; length < good.size() - 4; ++length) {
    // Cutting the last number of a line still leaves a number.
    const bool whole =
        length == one || length == one - 1 || (length < one && length >= one - 5 && good[length - 1] != ' ');
    CAPTURE(length);
    bool accepted = true;
    try {
      read(good.substr(0, length));
    } catch (const skinctl::ConfigurationError&) {
      accepted = false;
    }
    CHECK(accepted == whole);
  }
  std::mt19937 random(7);
  for (int round = 0; round < 3000; ++round) {
    std::string text = good;
    for (int i = 0; i < 1 + round % 5; ++i) text[random() % text.size()] = static_cast<char>(random() % 256);
    try {
      for (const Slice& s : read(text).slices)
        for (const double taxel : s.taxels) CHECK((taxel >= 0 && taxel <= 255));
    } catch (const skinctl::ConfigurationError& e) {
      CHECK(std::string(e.what()).rfind("grasp:", 0) == 0);
    }
  }
}
