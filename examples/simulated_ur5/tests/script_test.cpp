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
  CHECK(p.error.empty());
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

TEST_CASE("Script: constants, several sockets, retries and watchdogs of drivers in use") {
  const Program p = only(
      "def driver():\n"
      "  HOST = \"192.168.56.1\"\n"
      "  PORT = 50000 + 1\n"
      "  MULT_jointstate = 2000000.0\n"
      "  STOPJ_ACCELERATION = 3.5\n"
      "  N = 8\n"
      "  rtde_set_watchdog(\"input_int_register_0\", 5, \"stop\")\n"
      "  def connect_socket_with_retry(host, port, name, max_attempts=5, dt=0.2):\n"
      "    return socket_open(host, port, name)\n"
      "  end\n"
      "  ok = connect_socket_with_retry(HOST, 50003, \"trajectory_socket\")\n"
      "  if not connect_socket_with_retry(HOST, PORT, \"reverse_socket\"):\n"
      "    popup(\"no\", title='x', blocking=True)\n"
      "  end\n"
      "  raw = socket_read_binary_integer(21, \"trajectory_socket\")\n"
      "  servoj(q, t=get_steptime(), gain=600, lookahead_time=0.05)\n"
      "  speedj(qd, 2*10, get_steptime())\n"
      "  p = socket_read_binary_integer(N, \"reverse_socket\", read_timeout)\n"
      "  stopj(STOPJ_ACCELERATION)\n"
      "end\n");
  CHECK(p.error.empty());
  REQUIRE(p.sockets.size() == 2);
  CHECK(p.sockets[0].port == 50003);
  CHECK(p.reverse == 1);
  CHECK(p.sockets[1].host == "192.168.56.1");
  CHECK(p.sockets[1].port == 50001);
  CHECK(p.servo_gain == 600);
  CHECK(p.servo_lookahead == 0.05);
  CHECK(p.speed_acceleration == 20);
  CHECK(p.stop_deceleration == 3.5);
  CHECK(p.multiplier == 2e6);
  REQUIRE(p.watchdog);
  CHECK(p.watchdog->variable == "input_int_register_0");
  CHECK(p.watchdog->min_frequency == 5);
  CHECK(p.watchdog->stops);
}

TEST_CASE("Script: what cannot run says why") {
  CHECK(
      only(
          "def f():\n socket_open(\"127.0.0.1\", 5, \"a\")\n x = socket_read_binary_integer(6, \"a\")\nend\n")
          .error.find("8") != std::string::npos);
  CHECK(only("def f():\n socket_open(host, port)\n x = socket_read_binary_integer(8)\nend\n")
            .error.find("constants") != std::string::npos);
  CHECK(only("def f():\n while True:\n  stopj(1)\n end\nend\n").error.find("loops") != std::string::npos);
  CHECK(only("def f():\n socket_open(\"127.0.0.1\", 70000, \"a\")\n x = socket_read_binary_integer(8, "
             "\"a\")\nend\n")
            .error.size() > 0);
  // A socket whose name is left out is socket_0.
  const Program p =
      only("def f():\n socket_open(\"127.0.0.1\", 5)\n x = socket_read_binary_integer(8)\nend\n");
  CHECK(p.error.empty());
  CHECK(p.sockets.at(0).name == "socket_0");
}

TEST_CASE("Script: straight-line statements") {
  using Kind = Statement::Kind;
  const Program p = only(
      "def f():\n"
      "  home = [0, -d2r(90), -1.5, -pi_half, 1.5, 0]\n"
      "  movej([0.1, -1.5, 1e-1, -.5, 2*0.5, -(1+1)], a=1.2, v=0.9)\n"
      "  set_standard_digital_out(3, True)\n"
      "  set_tool_digital_out(1, False)\n"
      "  set_configurable_digital_out(0, True)\n"
      "  set_standard_digital_out(9, True)\n"
      "  sleep(0.5)\n"
      "  write_output_integer_register(4, -7)\n"
      "  textmsg(\"a # b\", 3)\n"
      "  movej(home)\n"
      "  frobnicate(1)\n"
      "  stopj(2)\n"
      "  halt\n"
      "end\n");
  CHECK(p.error.empty());
  CHECK_FALSE(p.streams());
  REQUIRE(p.statements.size() == 8);
  CHECK(p.statements[0].kind == Kind::move);
  CHECK(p.statements[0].joints == Joints{0.1, -1.5, 0.1, -0.5, 1, -2});
  CHECK(p.statements[0].acceleration == 1.2);
  CHECK(p.statements[0].velocity == 0.9);
  CHECK(p.statements[1].index == 3);
  CHECK(p.statements[1].flag);
  CHECK(p.statements[2].index == 17);
  CHECK_FALSE(p.statements[2].flag);
  CHECK(p.statements[3].index == 8);
  CHECK(p.statements[4].number == 0.5);
  CHECK(p.statements[5].number == -7);
  CHECK(p.statements[6].text == "a # b3.000000");
  CHECK(p.statements[7].kind == Kind::stop);
  // Digital output 9, the movej with an unknown constant, and frobnicate were skipped.
  REQUIRE(p.warnings.size() == 3);
  CHECK(p.warnings[2].find("frobnicate") != std::string::npos);
  CHECK(only("sec s():\n set_standard_digital_out(0, True)\nend\n").secondary);
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
    CHECK(p.statements.size() <= 10000);
    CHECK(p.warnings.size() <= 20);
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
