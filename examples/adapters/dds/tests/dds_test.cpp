// Fast DDS with our bytes against Cyclone DDS with code that its own compiler made from the IDL. All on
// 127.0.0.1.
//
// Promise: a skin, joint states and latched texts go over DDS as ROS 2 has them
// Tried: Cyclone DDS with code of its own compiler reads and writes 1260 cells, field by field; an arm
// gives way to what another process sends. Also: `examples/adapters/dds/tests`, `examples/dds_skin`

#include <dds/dds.h>
#include <doctest/doctest.h>

#include <cstring>
#include <thread>

#include "examples/adapters/dds/dds_view.hpp"
#include "examples/adapters/dds/tests/cyclone_participant.hpp"
#include "ros.h"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/io/ros_messages.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;
using namespace adapters::dds;

namespace {

constexpr std::uint32_t domain = 77;

dds_entity_t peer() {
  static const dds_entity_t made = adapters::dds::testing::cyclone_participant(domain);
  return made;
}
dds_qos_t* delivery(Delivery d) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, d == Delivery::sensor ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE,
                       DDS_SECS(1));
  dds_qset_durability(qos, d == Delivery::latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
  return qos;
}
dds_entity_t topic_of(const dds_topic_descriptor_t& type, const char* name) {
  const auto topic = dds_create_topic(peer(), &type, name, nullptr, nullptr);
  REQUIRE(topic > 0);
  return topic;
}
template <class F>
bool within(double seconds_long, F&& f) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds_long);
  while (!f()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}
template <class Sample>
bool take(dds_entity_t reader, Sample& sample) {
  void* at = &sample;
  dds_sample_info_t info;
  return dds_take(reader, &at, &info, 1, 1) == 1 && info.valid_data;
}
Participant ours() {
  return Participant({.domain = domain, .interface = "127.0.0.1", .name = "test"});
}

}  // namespace

TEST_CASE("DDS: 1260 cells reach Cyclone whole, field by field, with the type's name and hash") {
  constexpr std::uint32_t cells = 1260;
  std::vector<SkinCloud::Cell> homes;
  for (std::uint32_t i = 0; i < cells; ++i) homes.push_back({i + 1, i / 210, {0.001f * float(i), 0.5f, -1}});
  SkinCloud cloud(homes);
  Participant participant = ours();
  RawWriter writer(participant, "/skin/cells", SkinCloud::type(), Delivery::sensor, skin_cloud_size(cells));
  dds_qos_t* qos = delivery(Delivery::sensor);
  const auto reader = dds_create_reader(
      peer(), topic_of(sensor_msgs_msg_dds__PointCloud2__desc, "rt/skin/cells"), qos, nullptr);
  dds_delete_qos(qos);
  REQUIRE(reader > 0);
  REQUIRE(within(10, [&] { return writer.readers() == 1; }));

  dds_instance_handle_t match = 0;
  REQUIRE(within(10, [&] { return dds_get_matched_publications(reader, &match, 1) == 1; }));
  dds_builtintopic_endpoint_t* found = dds_get_matched_publication_data(reader, match);
  REQUIRE(found != nullptr);
  CHECK(std::string(found->type_name) == "sensor_msgs::msg::dds_::PointCloud2_");
  void* text = nullptr;
  std::size_t size = 0;
  CHECK(dds_qget_userdata(found->qos, &text, &size));
  CHECK(std::string(static_cast<char*>(text), size) == "typehash=" + SkinCloud::type().hash + ";");
  dds_free(text);
  dds_builtintopic_free_endpoint(found);

  int arrived = 0;
  for (int k = 1; k <= 50; ++k) {
    const std::uint32_t id = 1 + std::uint32_t(k) * 25u % cells;
    CHECK(cloud.set({k * 4ms - 1ms, id, {0.25f, 0.125f, 0}, 0.5f, {1, 2, 3}, 30}));
    REQUIRE(writer.write(cloud.encode(k * 4ms)));
    sensor_msgs_msg_dds__PointCloud2_ got{};
    if (!within(0.5, [&] { return take(reader, got); })) continue;
    ++arrived;
    CHECK(got.header_.stamp_.sec_ == 0);
    CHECK(got.header_.stamp_.nanosec_ == std::uint32_t(k) * 4'000'000u);
    CHECK(std::string(got.header_.frame_id_) == "base_link");
    CHECK(got.width_ == cells);
    REQUIRE(got.fields_._length == 17);
    CHECK(std::string(got.fields_._buffer[13].name_) == "ay");
    CHECK(got.fields_._buffer[13].offset_ == 52);
    CHECK(got.point_step_ == 64);
    REQUIRE(got.data_._length == cells * 64);
    SkinPoint p;
    std::memcpy(&p, got.data_._buffer + 64 * (id - 1), sizeof p);
    CHECK(p.cell == id);
    CHECK(p.age == 1'000'000);
    CHECK(p.forces == std::array{0.25f, 0.125f, 0.0f});
    CHECK(got.is_dense_);
    dds_sample_free(&got, &sensor_msgs_msg_dds__PointCloud2__desc, DDS_FREE_CONTENTS);
  }
  CHECK(arrived >= 45);
  CHECK_FALSE(writer.write(std::vector<unsigned char>(skin_cloud_size(cells) + 1)));
  dds_delete(reader);
}

TEST_CASE(
    "DDS: a skin that Cyclone encodes anew is read, sample by sample; one with other fields is refused") {
  SkinCloud cloud({{7, 0, {}}, {9, 0, {}}});
  Participant participant = ours();
  RawReader reader(participant, "/skin/again", SkinCloud::type(), Delivery::sensor, skin_cloud_size(2));
  dds_qos_t* qos = delivery(Delivery::sensor);
  const auto writer = dds_create_writer(
      peer(), topic_of(sensor_msgs_msg_dds__PointCloud2__desc, "rt/skin/again"), qos, nullptr);
  dds_delete_qos(qos);
  REQUIRE(writer > 0);
  REQUIRE(within(10, [&] { return reader.writers() == 1; }));
  REQUIRE(within(10, [&] {
    dds_instance_handle_t match = 0;
    return dds_get_matched_subscriptions(writer, &match, 1) == 1;
  }));
  // Cyclone's own structures, filled by hand.
  std::vector<sensor_msgs_msg_dds__PointField_> fields;
  std::vector<std::string> names;
  for (const auto& f : SkinPoint::fields) names.emplace_back(f.name);
  for (std::size_t i = 0; i < names.size(); ++i)
    fields.push_back({names[i].data(), SkinPoint::fields[i].offset,
                      static_cast<std::uint8_t>(SkinPoint::fields[i].number), 1});
  std::vector<SkinPoint> points(2);
  points[0].cell = 7, points[1].cell = 9;
  points[0].age = points[1].age = 2'000'000;
  points[1].forces = {0.5f, 0.25f, 0.125f};
  std::string frame = "base_link";
  sensor_msgs_msg_dds__PointCloud2_ message{};
  message.header_.frame_id_ = frame.data();
  message.height_ = 1, message.width_ = 2;
  message.fields_._buffer = fields.data();
  message.fields_._length = message.fields_._maximum = 15;
  message.point_step_ = 64, message.row_step_ = 128;
  message.data_._buffer = reinterpret_cast<std::uint8_t*>(points.data());
  message.data_._length = message.data_._maximum = 128;
  message.is_dense_ = true;
  SkinCloudReader read(2);
  int arrived = 0;
  for (int k = 1; k <= 20; ++k) {
    message.header_.stamp_ = {5, std::uint32_t(k) * 1'000'000u};
    REQUIRE(dds_write(writer, &message) == DDS_RETCODE_OK);
    if (!reader.wait(std::chrono::milliseconds(500))) continue;
    const auto bytes = reader.take();
    if (!bytes) continue;
    ++arrived;
    const auto samples = read.read(*bytes);
    REQUIRE(samples.size() == 2);
    CHECK(samples[1].cell == 9);
    CHECK(samples[1].time == 5s + k * 1ms - 2ms);
    CHECK(samples[1].force == points[1].forces);
  }
  CHECK(arrived >= 18);
  CHECK(read.refused() == 0);
  fields[3].offset_ = 13;
  REQUIRE(dds_write(writer, &message) == DDS_RETCODE_OK);
  if (reader.wait(std::chrono::milliseconds(500))) {
    CHECK(read.read(*reader.take()).empty());
    CHECK(read.refused() == 1);
  }
  dds_delete(writer);
}

TEST_CASE("DDS: joint states are reliable, a latched text reaches a reader that comes later") {
  Participant participant = ours();
  RawWriter text(participant, "/robot_description", ros::String::type(), Delivery::latched, 1 << 20);
  std::vector<unsigned char> bytes(1 << 20);
  CdrWriter w(bytes);
  const std::string urdf(200'000, 'u');
  ros::encode(w, ros::String{urdf});
  REQUIRE(text.write(w.bytes()));
  dds_qos_t* qos = delivery(Delivery::latched);
  const auto late = dds_create_reader(
      peer(), topic_of(std_msgs_msg_dds__String__desc, "rt/robot_description"), qos, nullptr);
  dds_delete_qos(qos);
  std_msgs_msg_dds__String_ got{};
  REQUIRE(within(10, [&] { return take(late, got); }));
  CHECK(urdf == got.data_);
  dds_sample_free(&got, &std_msgs_msg_dds__String__desc, DDS_FREE_CONTENTS);

  RawWriter joints(participant, "/joint_states", ros::JointState::type(), Delivery::state, 4096);
  qos = delivery(Delivery::state);
  const auto reader = dds_create_reader(
      peer(), topic_of(sensor_msgs_msg_dds__JointState__desc, "rt/joint_states"), qos, nullptr);
  dds_delete_qos(qos);
  REQUIRE(within(10, [&] { return joints.readers() == 1; }));
  const std::vector<std::string> names = {"a", "b"};
  for (int k = 1; k <= 50; ++k) {
    const double q[] = {0.5 * k, -1.0 * k};
    CdrWriter j(bytes);
    ros::encode(j, ros::JointState{k * 1ms, "", names, q, {}, q});
    REQUIRE(joints.write(j.bytes()));
    sensor_msgs_msg_dds__JointState_ state{};
    REQUIRE(within(2, [&] { return take(reader, state); }));
    CHECK(state.header_.stamp_.nanosec_ == std::uint32_t(k) * 1'000'000u);
    REQUIRE(state.name_._length == 2);
    CHECK(std::string(state.name_._buffer[1]) == "b");
    REQUIRE(state.position_._length == 2);
    CHECK(state.position_._buffer[1] == -1.0 * k);
    CHECK(state.velocity_._length == 0);
    CHECK(state.effort_._buffer[0] == 0.5 * k);
    dds_sample_free(&state, &sensor_msgs_msg_dds__JointState__desc, DDS_FREE_CONTENTS);
  }
  dds_delete(late);
  dds_delete(reader);
}

TEST_CASE(
    "DDS: a run is published: joint states of every cycle, cells where samples came, the robot for late "
    "readers") {
  using Scene = decltype(Cycle(by_position(ur5::Model{}, std::declval<const RobotConfiguration<6>&>()),
                               GravityControl{}));
  RunDescription run;
  run.joints = {"a", "b", "c", "d", "e", "f"};
  run.urdf = "<robot/>";
  run.layout = std::string(200'000, 'l');  // of the same type as the robot, and longer
  run.places = places_of(ur5::Model{});
  run.cells = {{7, 2, {}}, {9, 2, {0, 0, 0.1f}}};
  Participant here = ours(), there = ours();
  DdsView<Scene> view(here, run);
  RawReader joints(there, "/joint_states", ros::JointState::type(), Delivery::state, 16384);
  RawReader cells(there, "/skin/cells", SkinCloud::type(), Delivery::sensor, skin_cloud_size(2));
  REQUIRE(within(10, [&] { return joints.writers() == 1 && cells.writers() == 1; }));
  view.start({}, {});
  CycleRecord<Scene> record;
  // A reader that sees a writer may not be seen by it yet: what is published then is lost.
  REQUIRE(within(10, [&] {
    view.cycle(record);
    return joints.wait(std::chrono::milliseconds(500)) && joints.take();
  }));
  SkinCloudReader read(2);
  int positions = 0, frames = 0;
  for (int k = 1; k <= 20; ++k) {
    const CellSample sample{.time = k * 8ms, .cell = 9, .force = {0.5f, 0, 0}};
    record.input.now = record.input.measured.time = k * 8ms;
    record.input.measured.q[0] = 0.25 * k;
    record.input.samples = {&sample, k % 2 == 0 ? std::size_t(1) : std::size_t(0)};
    view.cycle(record);
    if (joints.wait(std::chrono::milliseconds(500))) {
      const auto bytes = joints.take();
      REQUIRE(bytes);
      double q = 0;  // six positions, velocities and torques end the message, each behind its number
      std::memcpy(&q, bytes->data() + bytes->size() - 48 - 2 * 56, sizeof q);
      positions += q == 0.25 * k;
    }
    if (k % 2 == 1) continue;
    if (!cells.wait(std::chrono::milliseconds(500))) continue;
    const auto samples = read.read(*cells.take());
    REQUIRE(samples.size() == 1);  // the other one was never heard
    frames += samples[0].cell == 9 && samples[0].force[0] == 0.5f && samples[0].time == k * 8ms;
  }
  CHECK(positions == 20);
  CHECK(frames >= 9);
  CHECK(view.frames() == 10);
  CHECK(view.refused() == 0);
  RawReader late(there, "/robot_description", ros::String::type(), Delivery::latched, 1024);
  REQUIRE(late.wait(std::chrono::seconds(10)));
  CHECK(std::string(reinterpret_cast<const char*>(late.take()->data()) + 8) == "<robot/>");
  RawReader layout(there, "/skin/layout", ros::String::type(), Delivery::latched, 1 << 20);
  REQUIRE(layout.wait(std::chrono::seconds(10)));
  const auto whole = layout.take();
  REQUIRE(whole);
  CHECK(std::string(reinterpret_cast<const char*>(whole->data()) + 8) == run.layout);
  // A reader takes nothing that is longer than it was told.
  RawReader narrow(there, "/skin/layout", ros::String::type(), Delivery::latched, 1000);
  narrow.wait(std::chrono::seconds(2));
  CHECK_FALSE(narrow.take());
}

TEST_CASE("DDS: what cannot be is refused with words") {
  CHECK_THROWS_AS(Participant({.domain = 233}), ConfigurationError);
  CHECK_THROWS_WITH_AS(Participant({.interface = "localhost"}), doctest::Contains("an IPv4 address"),
                       ConfigurationError);
}
