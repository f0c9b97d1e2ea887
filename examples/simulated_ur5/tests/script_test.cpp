#include "examples/simulated_ur5/script.hpp"

#include <doctest/doctest.h>

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

Program only(const std::string& text) {
  return recognise(text, 0.008);
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

TEST_CASE("Script: a stream's address, port, parameters and mode of reading are found") {
  const Program p = only(raw::stream_program(50001));
  CHECK(p.name == "stream");
  REQUIRE(p.streams());
  REQUIRE(p.sockets.size() == 1);
  CHECK(p.sockets[0].host == "127.0.0.1");
  CHECK(p.sockets[0].port == 50001);
  CHECK(p.sockets[0].name == "reverse_socket");
  CHECK(p.servo_lookahead == 0.03);
  CHECK(p.servo_gain == 2000);
  CHECK(p.speed_acceleration == 40);
  CHECK(p.stop_deceleration == 4);
  CHECK(p.multiplier == 1e6);
}

TEST_CASE("Script: constants and watchdogs of a stream; what does more is none") {
  const std::string text =
      "def driver():\n"
      "  HOST = \"192.168.56.1\"\n"
      "  PORT = 50000 + 1\n"
      "  MULT_jointstate = 2000000.0\n"
      "  STOPJ_ACCELERATION = 3.5\n"
      "  N = 8\n"
      "  rtde_set_watchdog(\"input_int_register_0\", 5, \"stop\")\n"
      "  socket_open(HOST, PORT)\n"
      "  servoj(q, t=get_steptime(), gain=600, lookahead_time=0.05)\n"
      "  speedj(qd, 2*10, get_steptime())\n"
      "  p = socket_read_binary_integer(N)\n"
      "  stopj(STOPJ_ACCELERATION)\n"
      "end\n";
  const Program p = only(text);
  REQUIRE(p.sockets.size() == 1);
  CHECK(p.sockets[0].host == "192.168.56.1");
  CHECK(p.sockets[0].port == 50001);
  CHECK(p.sockets[0].name == "socket_0");  // a name that is left out
  CHECK(p.servo_gain == 600);
  CHECK(p.servo_lookahead == 0.05);
  CHECK(p.speed_acceleration == 20);
  CHECK(p.stop_deceleration == 3.5);
  CHECK(p.multiplier == 2e6);
  REQUIRE(p.watchdog);
  CHECK(p.watchdog->variable == "input_int_register_0");
  CHECK(p.watchdog->min_frequency == 5);
  CHECK(p.watchdog->stops);
  // A second socket, another size of message, an address that is computed, torques, no socket: interpreted.
  for (const auto& [from, to] :
       {std::pair{"  N = 8\n", "  socket_open(HOST, 7, \"b\")\n  N = 8\n"},
        std::pair{"  N = 8\n", "  N = 6\n"}, std::pair{"  N = 8\n", "  N = 8\n  direct_torque(q)\n"},
        std::pair{"socket_open(HOST, PORT)", "socket_open(host(), PORT)"},
        std::pair{"socket_open(HOST, PORT)", "socket_open(HOST, 70000)"},
        std::pair{"  N = 8\n", "  N = 8\n  direct_torque(q)\n"},
        std::pair{"  socket_open(HOST, PORT)\n", ""}}) {
    std::string other = text;
    other.replace(other.find(from), std::string(from).size(), to);
    CAPTURE(other);
    CHECK_FALSE(only(other).streams());
  }
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
    const Program p = only(text);
    CHECK(p.sockets.size() <= 8);
  }
  Random random(11);
  const std::string_view words[] = {"def",
                                    "end",
                                    "sec",
                                    "f",
                                    "(",
                                    ")",
                                    "[",
                                    "]",
                                    ",",
                                    "\n",
                                    "=",
                                    "1",
                                    "-",
                                    "\"x\"",
                                    "\"",
                                    "socket_open",
                                    "socket_read_binary_integer",
                                    "reverse_socket",
                                    "servoj",
                                    "True",
                                    "8",
                                    "movej",
                                    ".",
                                    "e9",
                                    "#",
                                    "thread",
                                    "while",
                                    ":",
                                    "\\",
                                    "\x01",
                                    "\xff",
                                    " "};
  for (int n = 0; n < 3000; ++n) {
    std::string text;
    const int length = static_cast<int>(random.uniform() * 200);
    for (int i = 0; i < length; ++i) text += words[random.bits() % std::size(words)];
    const Program p = only(text);
    CHECK(p.sockets.size() <= 8);
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
    for (const std::string& p : programs) only(p);
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
