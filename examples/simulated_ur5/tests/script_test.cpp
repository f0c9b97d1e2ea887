#include "examples/simulated_ur5/script.hpp"

#include <doctest/doctest.h>

#include <sstream>
#include <string>

#include "examples/simulated_ur5/random.hpp"
#include "examples/simulated_ur5/tests/raw.hpp"

using namespace simulated_ur5;

namespace {

std::vector<std::string> programs_of(std::string_view text, std::size_t chunk = 1000000) {
  ScriptReader reader;
  std::vector<std::string> programs;
  for (std::size_t i = 0; i < text.size(); i += chunk) {
    const auto b = raw::bytes(text.substr(i, chunk));
    REQUIRE(reader.feed(b, programs));
  }
  return programs;
}

}  // namespace

TEST_CASE("Script: programs are cut at their end, however the text arrives") {
  const std::string text =
      raw::stream_program(50001) +
      "stopj(2.0)\n\n  # nothing\nsec out():\n  set_standard_digital_out(1, True)\nend\n";
  for (const std::size_t chunk : {std::size_t{1}, std::size_t{7}, std::size_t{100000}}) {
    const auto programs = programs_of(text, chunk);
    REQUIRE(programs.size() == 3);
    CHECK(programs[0] == raw::stream_program(50001));
    CHECK(programs[1] == "stopj(2.0)\n");
    CHECK(programs[2].find("sec out") != std::string::npos);
  }
  CHECK(programs_of("def f():\n  x = 1\n").empty());
  CHECK(programs_of("stopj(2.0)").empty());
  CHECK(programs_of("end\nend\nstopj(1)\n").size() == 3);
}

TEST_CASE("Script: hostile text is read to its end, in bounded time and memory") {
  // Deep nesting, endless calls, strings and lines without end.
  for (const std::string& piece :
       {std::string("f("), std::string("[["), std::string("((((((((("), std::string("-"), std::string("\""),
        std::string("def "), std::string("a=b=c=("), std::string("1e"),
        std::string("socket_open(\"1\",1,\"a\")"), std::string("if while if def f():\n")}) {
    CAPTURE(piece);
    std::string text;
    while (text.size() < 200000) text += piece;
    text += "\n";
    CHECK_NOTHROW(programs_of(text, 1000));
  }
  Random random(11);
  std::vector<std::string> words;
  for (
      std::istringstream in(
          R"(def end sec f ( ) [ ] , = 1 - "x" " socket_open reverse_socket servoj True 8 movej . e9 # thread while : \)");
      in;)
    in >> words.emplace_back();
  words.insert(words.end(), {"\n", "\x01", "\xff", " "});
  for (int n = 0; n < 3000; ++n) {
    std::string text;
    const int length = static_cast<int>(random.uniform() * 200);
    for (int i = 0; i < length; ++i) text += words[random.bits() % words.size()];
    ScriptReader reader;
    std::vector<std::string> programs;
    CHECK(reader.feed(raw::bytes(text), programs));
  }
  for (int n = 0; n < 300; ++n) {
    raw::Bytes noise(static_cast<std::size_t>(random.uniform() * 5000));
    for (auto& b : noise) b = static_cast<std::uint8_t>(random.bits());
    ScriptReader reader;
    std::vector<std::string> programs;
    reader.feed(noise, programs);
  }
  // A program without end is refused at 256 KiB.
  ScriptReader reader;
  std::vector<std::string> programs;
  const raw::Bytes chunk(1000, 'x');
  bool open = true;
  std::size_t taken = 0;
  while (open && taken < 1'000'000) {
    open = reader.feed(chunk, programs);
    taken += chunk.size();
  }
  CHECK_FALSE(open);
  CHECK(taken <= ScriptReader::longest_program + 1000);
}
