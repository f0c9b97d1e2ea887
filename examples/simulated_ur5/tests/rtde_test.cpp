#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "examples/simulated_ur5/random.hpp"
#include "examples/simulated_ur5/rtde_session.hpp"
#include "examples/simulated_ur5/tests/raw.hpp"

using namespace simulated_ur5;
using raw::Bytes;

namespace {

ControllerConfig powered(Series series = Series::e_series) {
  ControllerConfig c;
  c.series = series;
  c.powered = true;
  c.arm.position_noise = c.arm.velocity_noise = 0;
  return c;
}

/// A controller with sessions, and packages cut out of what they answer, by hand.
struct Bench {
  explicit Bench(ControllerConfig config = powered()) : controller(std::move(config)) {}

  Controller controller;
  rtde::InputOwners owners;
  rtde::Quirks quirks;

  struct Client {
    explicit Client(Bench& b) : bench(b), session(b.controller, b.owners, b.quirks, 1) {}
    Bench& bench;
    rtde::Session session;
    bool stays = true;
    std::vector<raw::Package> say(const Bytes& request) {
      Bytes out;
      stays = session.receive(request, out);
      return cut(out);
    }
    raw::Package ask(const Bytes& request) {
      auto answers = say(request);
      REQUIRE(answers.size() == 1);
      return answers[0];
    }
    std::vector<raw::Package> cycle(bool late = false) {
      Bytes out;
      session.publish(out, late);
      return cut(out);
    }
    static std::vector<raw::Package> cut(const Bytes& out) {
      std::vector<raw::Package> packages;
      std::size_t at = 0;
      while (at < out.size()) {
        REQUIRE(out.size() - at >= 3);
        const std::size_t size = raw::take(out, at, 2);
        REQUIRE(size >= 3);
        REQUIRE(size <= out.size() - at);
        packages.push_back(
            {static_cast<char>(out[at + 2]), Bytes(out.begin() + static_cast<std::ptrdiff_t>(at + 3),
                                                   out.begin() + static_cast<std::ptrdiff_t>(at + size))});
        at += size;
      }
      return packages;
    }
    void version_2() { REQUIRE(ask(raw::version_request(2)).payload == Bytes{1}); }
  };
};

Bytes inputs_request(std::string_view names) {
  return raw::package('I', raw::bytes(names));
}

}  // namespace

TEST_CASE("RTDE: versions 1 and 2 are accepted, others are not") {
  Bench bench;
  Bench::Client client(bench);
  // 0x00 0x05 'V' 0x00 0x02 -> 0x00 0x04 'V' 0x01, byte by byte.
  Bytes out;
  CHECK(client.session.receive(Bytes{0x00, 0x05, 86, 0x00, 0x02}, out));
  CHECK(out == Bytes{0x00, 0x04, 86, 0x01});
  CHECK(client.ask(raw::version_request(3)).payload == Bytes{0});
  CHECK(client.ask(raw::version_request(0)).payload == Bytes{0});
  CHECK(client.session.version() == 2);
  CHECK(client.ask(raw::version_request(1)).payload == Bytes{1});
  CHECK(client.session.version() == 1);
}

TEST_CASE("RTDE: the stream is framed however it is cut") {
  Bytes all;
  for (const Bytes& b : {raw::version_request(2), raw::package('v'), raw::outputs_request(500, "timestamp"),
                         raw::package('S'), raw::package('P')})
    all.insert(all.end(), b.begin(), b.end());
  Bytes whole, single;
  {
    Bench bench;
    Bench::Client client(bench);
    CHECK(client.session.receive(all, whole));
  }
  {
    Bench bench;
    Bench::Client client(bench);
    for (const std::uint8_t b : all) CHECK(client.session.receive(Bytes{b}, single));
  }
  CHECK(whole == single);
  const auto packages = Bench::Client::cut(whole);
  REQUIRE(packages.size() == 5);
  CHECK(packages[0].type == 'V');
  CHECK(packages[1].type == 'v');
  CHECK(packages[2].type == 'O');
  CHECK(packages[3].type == 'S');
  CHECK(packages[4].type == 'P');
}

TEST_CASE("RTDE: every output has the type of the guide, and a package of their sizes") {
  const std::pair<const char*, const char*> expected[] = {{"timestamp", "DOUBLE"},
                                                          {"target_q", "VECTOR6D"},
                                                          {"target_qd", "VECTOR6D"},
                                                          {"target_qdd", "VECTOR6D"},
                                                          {"target_current", "VECTOR6D"},
                                                          {"target_moment", "VECTOR6D"},
                                                          {"actual_q", "VECTOR6D"},
                                                          {"actual_qd", "VECTOR6D"},
                                                          {"actual_current", "VECTOR6D"},
                                                          {"joint_control_output", "VECTOR6D"},
                                                          {"actual_TCP_pose", "VECTOR6D"},
                                                          {"actual_TCP_speed", "VECTOR6D"},
                                                          {"actual_TCP_force", "VECTOR6D"},
                                                          {"target_TCP_pose", "VECTOR6D"},
                                                          {"target_TCP_speed", "VECTOR6D"},
                                                          {"actual_digital_input_bits", "UINT64"},
                                                          {"joint_temperatures", "VECTOR6D"},
                                                          {"actual_execution_time", "DOUBLE"},
                                                          {"robot_mode", "INT32"},
                                                          {"joint_mode", "VECTOR6INT32"},
                                                          {"safety_mode", "INT32"},
                                                          {"actual_tool_accelerometer", "VECTOR3D"},
                                                          {"speed_scaling", "DOUBLE"},
                                                          {"target_speed_fraction", "DOUBLE"},
                                                          {"actual_momentum", "DOUBLE"},
                                                          {"actual_main_voltage", "DOUBLE"},
                                                          {"actual_robot_voltage", "DOUBLE"},
                                                          {"actual_robot_current", "DOUBLE"},
                                                          {"actual_joint_voltage", "VECTOR6D"},
                                                          {"actual_digital_output_bits", "UINT64"},
                                                          {"runtime_state", "UINT32"},
                                                          {"elbow_position", "VECTOR3D"},
                                                          {"elbow_velocity", "VECTOR3D"},
                                                          {"robot_status_bits", "UINT32"},
                                                          {"safety_status_bits", "UINT32"},
                                                          {"analog_io_types", "UINT32"},
                                                          {"standard_analog_input0", "DOUBLE"},
                                                          {"standard_analog_output1", "DOUBLE"},
                                                          {"io_current", "DOUBLE"},
                                                          {"euromap67_input_bits", "UINT32"},
                                                          {"tool_mode", "UINT32"},
                                                          {"tool_output_voltage", "INT32"},
                                                          {"tool_temperature", "DOUBLE"},
                                                          {"tcp_force_scalar", "DOUBLE"},
                                                          {"output_bit_registers0_to_31", "UINT32"},
                                                          {"output_bit_register_64", "BOOL"},
                                                          {"output_int_register_0", "INT32"},
                                                          {"output_int_register_47", "INT32"},
                                                          {"output_double_register_23", "DOUBLE"},
                                                          {"input_int_register_5", "INT32"},
                                                          {"input_double_register_47", "DOUBLE"},
                                                          {"input_bit_register_127", "BOOL"}};
  Bench bench;
  std::size_t total = 0;
  for (const auto& row : expected) {
    const std::string name = row.first, type = row.second;
    CAPTURE(name);
    Bench::Client client(bench);
    client.version_2();
    const raw::Package reply = client.ask(raw::outputs_request(500, name));
    CHECK(reply.payload.at(0) == 1);
    CHECK(reply.text(1) == type);
    CHECK(client.ask(raw::package('S')).payload == Bytes{1});
    const auto data = client.cycle();
    REQUIRE(data.size() == 1);
    const std::string& t = type;
    const std::size_t size = t == "BOOL"                              ? 1
                             : t == "DOUBLE" || t == "UINT64"         ? 8
                             : t == "VECTOR6D"                        ? 48
                             : t == "VECTOR3D" || t == "VECTOR6INT32" ? 24
                                                                      : 4;
    CHECK(data[0].payload.size() == 1 + size);
    total += size;
  }
  // All at once, in order.
  std::string names;
  for (const auto& row : expected) names += std::string(row.first) + ",";
  Bench::Client client(bench);
  client.version_2();
  CHECK(client.ask(raw::outputs_request(500, names)).payload.at(0) == 1);
  client.ask(raw::package('S'));
  CHECK(client.cycle().at(0).payload.size() == 1 + total);
}

TEST_CASE("RTDE: the values are those of the robot") {
  Bench bench;
  Bench::Client client(bench);
  client.version_2();
  client.ask(raw::outputs_request(500,
                                  "timestamp,actual_q,robot_mode,safety_mode,runtime_state,robot_status_bits,"
                                  "safety_status_bits,actual_TCP_pose"));
  client.ask(raw::package('S'));
  for (int i = 0; i < 7; ++i) bench.controller.step();
  const Bytes p = client.cycle().at(0).payload;
  CHECK(raw::take_double(p, 1) == doctest::Approx(0.014));
  CHECK(raw::take_double(p, 9) == 0);
  CHECK(raw::take_double(p, 17) == doctest::Approx(-pi / 2));
  CHECK(raw::take(p, 57, 4) == 7);
  CHECK(raw::take(p, 61, 4) == 1);
  CHECK(raw::take(p, 65, 4) == 1);
  CHECK(raw::take(p, 69, 4) == 1);
  CHECK(raw::take(p, 73, 4) == 1);
  const Links links = forward_kinematics(ArmConfig{}.home);
  CHECK(raw::take_double(p, 77) == doctest::Approx(links.flange.origin.x));
  CHECK(raw::take_double(p, 93) == doctest::Approx(links.flange.origin.z));
}

TEST_CASE("RTDE: unknown names are NOT_FOUND and make the recipe invalid; a trailing comma is harmless") {
  Bench bench;
  Bench::Client client(bench);
  client.version_2();
  raw::Package reply = client.ask(raw::outputs_request(500, "timestamp,actual_joy,actual_q"));
  CHECK(reply.payload.at(0) == 0);
  CHECK(reply.text(1) == "DOUBLE,NOT_FOUND,VECTOR6D");
  auto answers = client.say(raw::package('S'));
  CHECK(answers.back().type == 'S');
  CHECK(answers.back().payload == Bytes{0});
  CHECK(client.cycle().empty());
  for (const char* wrong :
       {"output_int_register_48", "output_int_register_07", "output_int_register_", "", ",timestamp",
        "timestamp ", "Timestamp", "output_bit_register_128", "output_int_register_-1"})
    CHECK(client.say(raw::outputs_request(500, wrong)).back().payload.at(0) == 0);
  reply = client.ask(raw::outputs_request(500, "timestamp,actual_q,"));
  CHECK(reply.payload.at(0) == 1);
  CHECK(reply.text(1) == "DOUBLE,VECTOR6D");

  reply = client.ask(inputs_request("speed_slider_mask,nonsense"));
  CHECK(reply.payload.at(0) == 0);
  CHECK(reply.text(1) == "UINT32,NOT_FOUND");
  CHECK(client.ask(inputs_request("input_bit_register_63")).text(1) == "NOT_FOUND");
  CHECK(client.ask(inputs_request("input_bit_register_64")).text(1) == "BOOL");
}

TEST_CASE("RTDE: the outputs of later guides have their types, and what a program sets comes out") {
  Bench bench;
  Bench::Client client(bench);
  client.version_2();
  raw::Package reply = client.ask(raw::outputs_request(
      500,
      "actual_current_as_torque,joint_position_deviation_ratio,collision_detection_ratio,time_scale_source,"
      "tool_output_mode,tool_digital_output0_mode,tool_digital_output1_mode,ft_raw_wrench,"
      "wrench_calc_from_currents,payload_inertia,target_gravity,target_base_acceleration,target_base_wrench,"
      "control_step,actual_robot_energy_consumed,actual_robot_braking_energy_dissipated,encoder0_raw,"
      "encoder1_raw"));
  CHECK(reply.payload.at(0) == 1);
  CHECK(
      reply.text(1) ==
      "VECTOR6D,DOUBLE,DOUBLE,INT32,UINT8,UINT8,UINT8,VECTOR6D,VECTOR6D,VECTOR6D,VECTOR3D,VECTOR6D,VECTOR6D,"
      "UINT64,DOUBLE,DOUBLE,INT32,INT32");
  CHECK(bench.controller
            .run("sec set():\n  set_payload(2, [0.1, 0.2, 0.3], [1, 2, 3, 4, 5, 6])\n"
                 "  set_tcp(p[0, 0, 0.2, 0, 0, 0])\n  set_tool_voltage(24)\nend\n")
            .empty());
  client.ask(raw::outputs_request(
      500, "payload,payload_cog,payload_inertia,tcp_offset,tool_output_voltage,control_step"));
  client.say(raw::package('S'));
  bench.controller.step();
  const Bytes data = client.cycle().at(0).payload;
  CHECK(raw::take_double(data, 1) == 2);
  CHECK(raw::take_double(data, 9 + 16) == 0.3);
  CHECK(raw::take_double(data, 33 + 40) == 6);
  CHECK(raw::take_double(data, 81 + 16) == 0.2);
  CHECK(raw::take(data, 129, 4) == 24);
  CHECK(raw::take(data, 133, 8) == 1);
}

TEST_CASE("RTDE: an input belongs to one client until it leaves") {
  Bench bench;
  Bench::Client first(bench);
  first.version_2();
  raw::Package reply =
      first.ask(inputs_request("speed_slider_mask,speed_slider_fraction,input_int_register_0"));
  CHECK(reply.payload.at(0) == 1);
  CHECK(reply.text(1) == "UINT32,DOUBLE,INT32");
  CHECK(first.ask(inputs_request("tool_digital_output_mask,tool_digital_output")).payload.at(0) == 2);
  {
    Bench::Client second(bench);
    second.version_2();
    reply = second.ask(inputs_request("input_int_register_1,input_int_register_0,nonsense"));
    CHECK(reply.payload.at(0) == 0);
    CHECK(reply.text(1) == "INT32,IN_USE,NOT_FOUND");
    // The refused recipe took nothing.
    CHECK(second.ask(inputs_request("input_int_register_1")).payload.at(0) == 1);
    CHECK(first.ask(inputs_request("input_int_register_1")).text(1) == "IN_USE");
  }
  CHECK(first.ask(inputs_request("input_int_register_1")).payload.at(0) == 3);
}

TEST_CASE("RTDE: inputs act, hold, and are checked") {
  Bench bench;
  Bench::Client client(bench);
  client.version_2();
  REQUIRE(
      client
          .ask(inputs_request("standard_digital_output_mask,standard_digital_output,tool_digital_output_mask,"
                              "tool_digital_output,speed_slider_mask,speed_slider_fraction,"
                              "input_double_register_24,input_int_register_7"))
          .payload.at(0) == 1);
  const auto data = [](std::uint8_t mask, std::uint8_t value, double fraction, double reg,
                       std::int32_t number) {
    Bytes b{1, mask, value, 3, 2};
    raw::put(b, 1, 4);
    raw::put_double(b, fraction);
    raw::put_double(b, reg);
    raw::put(b, static_cast<std::uint32_t>(number), 4);
    return raw::package('U', b);
  };
  CHECK(client.say(data(0x0f, 0x35, 0.5, 2.25, -9)).empty());
  bench.controller.step();
  const RobotState& s = bench.controller.state();
  CHECK(s.digital_outputs == (0x05u | 2u << 16));
  CHECK(s.target_speed_fraction == 0.5);
  CHECK(s.inputs.registers.doubles[24] == 2.25);
  CHECK(s.inputs.registers.integers[7] == -9);
  client.say(data(0xf0, 0xff, std::nan(""), 1, 1));
  bench.controller.step();
  CHECK(s.digital_outputs == (0xf5u | 2u << 16));
  CHECK(s.target_speed_fraction == 0.5);
  // Wrong sizes and unknown recipes are told, and change nothing.
  for (const Bytes& wrong : {raw::package('U'), raw::package('U', {1}), raw::package('U', {2, 0}),
                             raw::package('U', {0}), raw::package('U', Bytes(40, 1))}) {
    const auto answers = client.say(wrong);
    REQUIRE(answers.size() == 1);
    CHECK(answers[0].type == 'M');
    CHECK(client.stays);
  }
  CHECK(s.inputs.registers.integers[7] == 1);
}

TEST_CASE("RTDE: a stream starts once, pauses, and starts again") {
  Bench bench;
  Bench::Client client(bench);
  client.version_2();
  client.ask(raw::outputs_request(500, "timestamp"));
  CHECK(client.cycle().empty());
  CHECK(client.ask(raw::package('S')).payload == Bytes{1});
  CHECK(client.ask(raw::package('S')).payload == Bytes{1});
  for (int i = 0; i < 10; ++i) CHECK(client.cycle().size() == 1);
  CHECK(client.ask(raw::package('P')).payload == Bytes{1});
  CHECK(client.cycle().empty());
  CHECK(client.ask(raw::package('P')).payload == Bytes{1});
  CHECK(client.ask(raw::package('S')).payload == Bytes{1});
  for (int i = 0; i < 10; ++i) CHECK(client.cycle().size() == 1);
  // A second start moves nothing: every fourth cycle stays every fourth.
  {
    Bench::Client slow(bench);
    slow.version_2();
    slow.ask(raw::outputs_request(125, "timestamp"));
    slow.ask(raw::package('S'));
    std::size_t n = 0;
    for (int i = 0; i < 400; ++i) {
      n += slow.cycle().size();
      if (i % 3 == 0) CHECK(slow.ask(raw::package('S')).payload == Bytes{1});
    }
    CHECK(n == 100);
  }
  // A recipe does not change under way.
  const auto answers = client.say(raw::outputs_request(500, "actual_q"));
  CHECK(answers.front().type == 'M');
  CHECK(answers.back().payload.at(0) == 0);
  CHECK(client.cycle().at(0).payload.size() == 9);
}

TEST_CASE("RTDE: the rate divides the controller's") {
  const auto packages = [](Series series, double frequency) {
    Bench bench(powered(series));
    Bench::Client client(bench);
    client.version_2();
    client.ask(raw::outputs_request(frequency, "timestamp"));
    client.ask(raw::package('S'));
    std::size_t n = 0;
    for (int i = 0; i < 500; ++i) n += client.cycle().size();
    return n;
  };
  CHECK(packages(Series::e_series, 500) == 500);
  CHECK(packages(Series::e_series, 125) == 125);
  CHECK(packages(Series::e_series, 200) == 250);  // floor(500/200) = 2
  CHECK(packages(Series::e_series, 1) == 1);
  CHECK(packages(Series::e_series, 10000) == 500);
  CHECK(packages(Series::cb3, 125) == 500);
  CHECK(packages(Series::cb3, 60) == 250);
  Bench bench;
  Bench::Client client(bench);
  client.version_2();
  for (const double wrong : {0.0, -1.0, std::nan("")})
    CHECK(client.say(raw::outputs_request(wrong, "timestamp")).back().payload.at(0) == 0);
}

TEST_CASE("RTDE: quirks of real controllers can be switched on") {
  Bench bench;
  bench.quirks.data_before_start_reply = true;
  bench.quirks.skipped_outputs = 0.3;
  Bench::Client client(bench);
  client.version_2();
  client.ask(raw::outputs_request(500, "timestamp"));
  const auto answers = client.say(raw::package('S'));
  REQUIRE(answers.size() == 2);
  CHECK(answers[0].type == 'U');
  CHECK(answers[1].type == 'S');
  std::size_t n = 0;
  for (int i = 0; i < 2000; ++i) n += client.cycle().size();
  CHECK(n > 1250);
  CHECK(n < 1550);
  CHECK(client.cycle(true).empty());
}

TEST_CASE("RTDE: version 1 has no frequency, no output recipe id, and shorter texts") {
  Bench bench;
  Bench::Client client(bench);
  const raw::Package reply = client.ask(raw::package('O', raw::bytes("timestamp,robot_mode")));
  CHECK(reply.text() == "DOUBLE,INT32");
  client.ask(raw::package('S'));
  CHECK(client.cycle().at(0).payload.size() == 12);
  const auto text = client.say(raw::package('U', {9}));
  REQUIRE(text.size() == 1);
  CHECK(text[0].payload.at(0) == 1);
}

TEST_CASE("RTDE: nonsense is answered with a text and the end") {
  const auto ends = [](const Bytes& b, const char* why) {
    Bench bench;
    Bench::Client client(bench);
    client.version_2();
    const auto answers = client.say(b);
    CHECK_FALSE(client.stays);
    REQUIRE(answers.size() == 1);
    REQUIRE(answers[0].type == 'M');
    // uint8 length, text, uint8 length, source, uint8 level
    const auto& p = answers[0].payload;
    const std::size_t length = p.at(0);
    const std::string text(p.begin() + 1, p.begin() + 1 + static_cast<std::ptrdiff_t>(length));
    CHECK(text.find(why) != std::string::npos);
    const std::size_t source = p.at(1 + length);
    CHECK(p.size() == length + source + 3);
    CHECK(p.back() == 0);
  };
  ends(Bytes{0, 2, 'V'}, "size");
  ends(Bytes{0, 0, 0}, "size");
  ends(Bytes{0xff, 0xff, 'O'}, "size");
  ends(raw::package('X'), "unknown");
  ends(raw::package('V', {1}), "payload");
  ends(raw::package('S', {1}), "payload");
  ends(raw::bytes("GET / HTTP/1.1\r\n\r\n"), "size");
  // Name lists beyond 2048 bytes are refused, but not the end.
  Bench bench;
  Bench::Client client(bench);
  client.version_2();
  std::string names;
  while (names.size() <= 2048) names += "actual_q,";
  auto answers = client.say(raw::outputs_request(500, names));
  CHECK(client.stays);
  CHECK(answers.front().type == 'M');
  CHECK(answers.back().payload == Bytes{0});
  answers = client.say(inputs_request(names));
  CHECK(answers.back().payload == Bytes{0});
  names.resize(2043);
  names += "imeX,";
  CHECK(client.say(raw::outputs_request(500, names)).back().payload.size() > 1);
}

TEST_CASE("RTDE: random bytes and random packages never break a session") {
  Random random(21);
  const char types[] = {'V', 'v', 'O', 'I', 'S', 'P', 'U', 'M', 'U', 'U'};
  const std::string_view names[] = {"timestamp",
                                    "actual_q",
                                    "speed_slider_fraction",
                                    "input_int_register_3",
                                    ",",
                                    "input_double_register_",
                                    "7",
                                    "external_force_torque",
                                    "standard_digital_output"};
  for (int n = 0; n < 2000; ++n) {
    Bench bench;
    Bench::Client a(bench), b(bench);
    for (int i = 0; i < 30 && a.stays; ++i) {
      Bytes payload;
      const double kind = random.uniform();
      const char type = types[random.bits() % std::size(types)];
      const bool fixed_size = type == 'V' || type == 'v' || type == 'S' || type == 'P';
      if (kind < (fixed_size ? 0.01 : 0.4)) {
        payload.resize(static_cast<std::size_t>(random.uniform() * 60));
        for (auto& x : payload) x = static_cast<std::uint8_t>(random.bits());
      } else if (kind < 0.8 && !fixed_size) {
        if (type == 'O') raw::put_double(payload, random.uniform() * 600 - 20);
        const int words = static_cast<int>(random.uniform() * 12);
        for (int k = 0; k < words; ++k)
          for (const char c : names[random.bits() % std::size(names)])
            payload.push_back(static_cast<std::uint8_t>(c));
      } else if (type == 'V') {
        raw::put(payload, random.bits() % 4, 2);
      }
      Bytes request = raw::package(type, payload);
      if (random.uniform() < 0.1)
        request[random.bits() % request.size()] ^= static_cast<std::uint8_t>(random.bits());
      a.say(request);
      b.say(request);
      a.cycle();
      b.cycle();
      bench.controller.step();
    }
    for (const double x : bench.controller.state().actual_q) CHECK(std::isfinite(x));
  }
}
