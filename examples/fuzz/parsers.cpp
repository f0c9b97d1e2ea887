#include "examples/fuzz/parsers.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "examples/adapters/allegro/datagrams.hpp"
#include "examples/adapters/allegro/frames.hpp"
#include "examples/adapters/can/link.hpp"
#include "examples/adapters/fri/messages.hpp"
#include "examples/adapters/gripper/lines.hpp"
#include "examples/adapters/gripper/modbus.hpp"
#include "examples/adapters/gripper/robotiq.hpp"
#include "examples/adapters/ros1/tcpros.hpp"
#include "examples/adapters/ros1/xml_rpc.hpp"
#include "examples/adapters/skin/any_skin.hpp"
#include "examples/adapters/skin/datagram.hpp"
#include "examples/adapters/skin/icub_can.hpp"
#include "examples/adapters/skin/lights.hpp"
#include "examples/adapters/skin/papill_array.hpp"
#include "examples/adapters/skin/ros1.hpp"
#include "examples/adapters/skin/serial_datagrams.hpp"
#include "examples/adapters/skin/tf_luna.hpp"
#include "examples/adapters/skin/xela.hpp"
#include "examples/adapters/ur5/rtde.hpp"
#include "examples/simulated_gripper/device.hpp"
#include "examples/simulated_ur5/controller.hpp"
#include "examples/simulated_ur5/dashboard.hpp"
#include "examples/simulated_ur5/primary_commands.hpp"
#include "examples/simulated_ur5/rtde_session.hpp"
#include "examples/simulated_ur5/urscript/code.hpp"
#include "examples/skinctl_record/csv.hpp"
#include "skinctl/io/skin_cloud_reader.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/skin_xml.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/recording/mcap_reader.hpp"

namespace fuzz {
namespace {

using Bytes = std::span<const std::uint8_t>;

std::string_view text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
/// A parser of files: it throws `ConfigurationError` for what it refuses, and nothing else.
template <class F>
void allow_refusal(F&& f) {
  try {
    static_cast<void>(f());
  } catch (const skinctl::ConfigurationError&) {
  }
}
/// In pieces of 1 to 16 bytes, as a stream may bring them.
template <class F>
void in_pieces(Bytes bytes, F&& take) {
  for (std::size_t n = 1; !bytes.empty();) {
    n = 1 + (5 * n + bytes[0]) % 16;
    const auto piece = bytes.first(std::min(n, bytes.size()));
    if (!take(piece)) return;
    bytes = bytes.subspan(piece.size());
  }
}

void rtde_answers(Bytes bytes) {
  adapters::ur5::Framer framer;
  in_pieces(bytes, [&](Bytes piece) {
    const auto room = framer.room();
    std::copy_n(piece.begin(), std::min(piece.size(), room.size()), room.begin());
    framer.received(std::min(piece.size(), room.size()));
    while (const auto package = framer.next()) {
      adapters::ur5::Report report;
      static_cast<void>(report.decode(package->payload));
    }
    return !framer.broken();
  });
}
void rtde_requests(Bytes bytes) {
  simulated_ur5::Controller controller{simulated_ur5::ControllerConfig{}};
  simulated_ur5::rtde::InputOwners owners;
  simulated_ur5::rtde::Session session(controller, owners, {}, 1);
  std::vector<std::uint8_t> out;
  in_pieces(bytes, [&](Bytes piece) { return session.receive(piece, out); });
  session.publish(out, false);
}
void dashboard(Bytes bytes) {
  simulated_ur5::Controller controller{simulated_ur5::ControllerConfig{}};
  const simulated_ur5::ProgramLibrary programs;
  simulated_ur5::PanelState panel;
  simulated_ur5::DashboardSession session(controller, programs, panel);
  std::string out;
  in_pieces(bytes, [&](Bytes piece) { return session.receive(piece, out); });
}
void primary_commands(Bytes bytes) {
  simulated_ur5::Controller controller{simulated_ur5::ControllerConfig{}};
  simulated_ur5::primary::obey(text(bytes), controller);
}
void urscript(Bytes bytes) {
  simulated_ur5::urscript::Code code;
  static_cast<void>(simulated_ur5::urscript::compile(text(bytes), {}, code));
}
void skin_datagram(Bytes bytes) {
  adapters::skin::SerialDatagrams line;
  in_pieces(bytes, [&](Bytes piece) {
    line.take(piece, [](Bytes) {});
    return true;
  });
  adapters::skin::Datagram d;
  if (!adapters::skin::parse(bytes, d) || !d.is<skinctl::Hexagon>()) return;
  for (std::size_t i = 0; i < d.count(); ++i)
    static_cast<void>(
        adapters::skin::plausible(d.sample<skinctl::Hexagon>(i), d, std::chrono::milliseconds(100)));
}
void ros1(Bytes bytes) {
  std::vector<skinctl::CellSample> samples;
  adapters::skin::parse_ros1(bytes, samples);
}
void any_skin(Bytes bytes) {
  adapters::skin::AnySkinParser parser;
  in_pieces(bytes, [&](Bytes piece) {
    parser.take(piece, [](const adapters::skin::AnySkinPacket&) {});
    return true;
  });
}
void tf_luna(Bytes bytes) {
  adapters::skin::TfLunaParser parser;
  in_pieces(bytes, [&](Bytes piece) {
    parser.take(piece, [](const adapters::skin::TfLunaFrame& frame) { static_cast<void>(frame.readings()); });
    return true;
  });
}
void skin_lights(Bytes bytes) {
  adapters::skin::Picture picture;
  if (adapters::skin::parse_picture(bytes, nullptr, picture)) static_cast<void>(picture.on(picture.first));
  static_cast<void>(adapters::skin::parse_shown(bytes, nullptr));
}
void papill_array(Bytes bytes) {
  adapters::skin::PapillArrayParser parser;
  adapters::skin::PapillArrayPacket packet;
  for (const std::uint8_t byte : bytes) parser.take(byte);
  static_cast<void>(adapters::skin::parse_papill_array(bytes, packet));
}
void xela(Bytes bytes) {
  adapters::skin::XelaMessage message;
  if (adapters::skin::parse_xela(text(bytes), message) != adapters::skin::XelaText::message) return;
  adapters::skin::XelaSamples<adapters::skin::XelaCounts> counts;
  adapters::skin::XelaSamples<adapters::skin::XelaForces> forces;
  static_cast<void>(counts.of(message, {}));
  static_cast<void>(forces.of(message, {}));
}
void icub(Bytes bytes) {
  if (bytes.size() < 2) return;
  const auto frame =
      adapters::skin::parse_icub(static_cast<std::uint32_t>(bytes[0] << 8 | bytes[1]), bytes.subspan(2));
  if (!frame) return;
  for (std::size_t k = 0; k < frame->count; ++k) static_cast<void>(frame->sample(k, {}));
}
void allegro_can(Bytes bytes) {
  adapters::can::SlcanCodec codec;
  for (const std::uint8_t c : bytes)
    if (const auto frame = codec.take(static_cast<char>(c)))
      for (const auto g : {adapters::allegro::Generation::v4, adapters::allegro::Generation::v5,
                           adapters::allegro::Generation::v5_sense})
        static_cast<void>(adapters::allegro::decode(*frame, g));
}
void allegro_udp(Bytes bytes) {
  const auto d = adapters::allegro::parse(bytes);
  if (!d) return;
  static_cast<void>(adapters::allegro::telemetry(*d));
  static_cast<void>(adapters::allegro::hello_answer(*d));
  static_cast<void>(adapters::allegro::serial_answer(*d));
  static_cast<void>(adapters::allegro::fault_mask(*d));
  static_cast<void>(adapters::allegro::motor_error(*d));
}
void modbus(Bytes bytes) {
  simulated_gripper::OnRobotDevice device;
  adapters::gripper::modbus::Frame frame;
  std::size_t size = 0;
  double now = 0;
  while (adapters::gripper::modbus::find_frame(bytes, frame, size) ==
         adapters::gripper::modbus::Found::frame) {
    static_cast<void>(device.answer(frame, now += 0.01));
    std::array<std::uint16_t, 2> registers{};
    static_cast<void>(adapters::gripper::modbus::registers_of(frame, registers));
    bytes = bytes.subspan(size);
  }
}
void robotiq(Bytes bytes) {
  simulated_gripper::RobotiqDevice device(true);
  adapters::gripper::Lines lines("ack");
  double now = 0;
  in_pieces(bytes, [&](Bytes piece) {
    const auto room = lines.room();
    std::copy_n(piece.begin(), std::min(piece.size(), room.size()), room.begin());
    lines.wrote(std::min(piece.size(), room.size()));
    for (std::string_view line; lines.next(line);) {
      static_cast<void>(adapters::gripper::parse_robotiq(line));
      static_cast<void>(device.answer(line, now += 0.01));
    }
    return true;
  });
}
void skin_file(Bytes bytes) {
  allow_refusal([&] { return skinctl::parse_skin_file(text(bytes)); });
}
void skin_xml(Bytes bytes) {
  allow_refusal([&] { return skinctl::parse_skin_xml(text(bytes), "patch"); });
}
void urdf(Bytes bytes) {
  allow_refusal([&] { return skinctl::parse_urdf(text(bytes)); });
}
/// Files of others: every topic of them as a table.
void mcap(Bytes bytes) {
  std::vector<std::string> topics;
  const auto contents = skinctl::read_mcap(bytes, [](const skinctl::McapMessage&) {});
  for (const auto& channel : contents.summary.channels) topics.push_back(channel.topic);
  if (topics.size() > 8) topics.resize(8);
  for (const std::string& topic : topics)
    allow_refusal([&] {
      std::ostringstream table;
      return skinctl_record::write_csv(bytes, topic, table).lines;
    });
}
/// Several messages, each with its length before it.
void skin_cloud(Bytes bytes) {
  skinctl::SkinCloudReader reader(16);
  while (bytes.size() >= 2) {
    const std::size_t n = std::min<std::size_t>(bytes[0] + 256u * bytes[1], bytes.size() - 2);
    static_cast<void>(reader.read(bytes.subspan(2, n)));
    bytes = bytes.subspan(2 + n);
  }
}

/// What a node of ROS 1 says by HTTP: a request or an answer, or the XML alone.
void ros1_calls(Bytes bytes) {
  using adapters::ros1::HttpMessage;
  for (const auto kind : {HttpMessage::Kind::request, HttpMessage::Kind::answer}) {
    HttpMessage message(kind);
    auto state = HttpMessage::State::unfinished;
    in_pieces(bytes, [&](Bytes piece) {
      state = message.take(piece);
      return state == HttpMessage::State::unfinished;
    });
    if (state == HttpMessage::State::unfinished) state = message.closed();
    if (state == HttpMessage::State::whole) static_cast<void>(adapters::ros1::parse_call(message.body()));
  }
  if (const auto call = adapters::ros1::parse_call(text(bytes)))
    for (const auto& value : call->parameters) static_cast<void>(adapters::ros1::parse_uri(value.text));
  static_cast<void>(adapters::ros1::parse_answer(text(bytes)));
}
/// A stream of ROS 1: the header of a connection, and messages.
void ros1_stream(Bytes bytes) {
  adapters::ros1::Blocks blocks(4096);
  bool greeted = false;
  std::vector<skinctl::CellSample> samples;
  in_pieces(bytes, [&](Bytes piece) {
    blocks.add(piece);
    while (const auto block = blocks.next()) {
      if (greeted)
        adapters::skin::parse_ros1(*block, samples);
      else
        greeted = adapters::ros1::parse_fields(*block).has_value();
      samples.clear();
    }
    blocks.drop();
    return !blocks.broken();
  });
}

/// What was read is written, and read again: it is the same.
template <class Message>
void fri_message(Bytes bytes) {
  Message read, again;
  if (!parse(bytes, read)) return;
  std::array<std::uint8_t, adapters::fri::longest> out;
  const auto size = print(read, out);
  const bool same = size > 0 && parse({out.data(), size}, again) && again.header.number == read.header.number;
  if (read.axes == adapters::fri::joints && !same) std::abort();
}
void fri(Bytes bytes) {
  fri_message<adapters::fri::Monitoring>(bytes);
  fri_message<adapters::fri::Command>(bytes);
}

constexpr std::array all{Parser{"rtde_answers", rtde_answers},
                         Parser{"rtde_requests", rtde_requests},
                         Parser{"dashboard", dashboard},
                         Parser{"primary_commands", primary_commands},
                         Parser{"urscript", urscript},
                         Parser{"skin_datagram", skin_datagram},
                         Parser{"ros1", ros1},
                         Parser{"icub", icub},
                         Parser{"any_skin", any_skin},
                         Parser{"tf_luna", tf_luna},
                         Parser{"skin_lights", skin_lights},
                         Parser{"papill_array", papill_array},
                         Parser{"xela", xela},
                         Parser{"allegro_can", allegro_can},
                         Parser{"allegro_udp", allegro_udp},
                         Parser{"modbus", modbus},
                         Parser{"robotiq", robotiq},
                         Parser{"skin_file", skin_file},
                         Parser{"skin_xml", skin_xml},
                         Parser{"urdf", urdf},
                         Parser{"mcap", mcap},
                         Parser{"skin_cloud", skin_cloud},
                         Parser{"ros1_calls", ros1_calls},
                         Parser{"ros1_stream", ros1_stream},
                         Parser{"fri", fri}};

}  // namespace

std::span<const Parser> parsers() {
  return all;
}
void feed(Bytes input) {
  if (!input.empty()) all[input[0] % all.size()].feed(input.subspan(1));
}

}  // namespace fuzz
