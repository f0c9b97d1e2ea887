#include "skinctl/io/ros_messages.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "examples/support/sha256.hpp"
#include "skinctl/io/contact_cloud.hpp"
#include "tests/support/type_description.hpp"

using namespace skinctl;

namespace {

template <class M>
std::string hex(const M& message) {
  std::vector<unsigned char> bytes(4096);
  CdrWriter w(bytes);
  ros::encode(w, message);
  REQUIRE(w.fits());
  std::string out;
  for (const unsigned char b : w.bytes())
    out += "0123456789abcdef"[b >> 4], out += "0123456789abcdef"[b & 15];
  return out;
}

}  // namespace

TEST_CASE("SHA-256: the digests of FIPS 180-4's examples") {
  CHECK(examples::sha256("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(examples::sha256("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(examples::sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  CHECK(examples::sha256(std::string(1'000'000 / 10, 'a')) ==
        examples::sha256(std::string(50'000, 'a') + std::string(50'000, 'a')));
}

TEST_CASE("MessageType: the hash of each type is that of its definition") {
  for (const MessageType* t : {&ros::String::type(), &ros::JointState::type(), &ros::Transforms::type(),
                               &ros::PointCloud::type(), &ros::Matrix::type()}) {
    CAPTURE(t->name);
    CHECK(t->hash == testing::hash_of_message(t->name, t->schema));
  }
  CHECK(ros::PointCloud::type().dds_name() == "sensor_msgs::msg::dds_::PointCloud2_");
}

TEST_CASE("hash_of_message: that of a type which skinctl does not send is the one that ROS 2 publishes") {
  CHECK(testing::hash_of_message("sensor_msgs/msg/RegionOfInterest",
                                 "uint32 x_offset # a comment\n\nuint32 y_offset\nuint32 height\n"
                                 "uint32 width\nbool do_rectify\n") ==
        "RIHS01_ad16bcba5f9131dcdba6fbded19f726f5440e3c513b4fb586dd3027eeed8abb1");
  for (const char* schema :
       {"Missing x\n", "float64\n", "float64[a] x\n", "string<= x\n", "float64[99999999999] x\n"})
    CHECK_THROWS_AS(static_cast<void>(testing::hash_of_message("p/msg/T", schema)), ConfigurationError);
}

TEST_CASE("JointState: the bytes that other encoders write") {
  const std::vector<std::string> a = {"a"};
  const double position[] = {1}, velocity[] = {2}, effort[] = {3};
  CHECK(hex(ros::JointState{1500ms, "", a, position, velocity, effort}) ==
        "00010000"
        "010000000065cd1d"
        "0100000000000000"
        "010000000200000061000000"
        "01000000000000000000f03f"
        "0100000000000000"
        "0000000000000040"
        "0100000000000000"
        "0000000000000840");
  // Written by Python's rosbags: stamp 1 s 2 ns, no velocity, no effort.
  const std::vector<std::string> names = {"j1", "j2"};
  const double two[] = {0.5, -1};
  CHECK(hex(ros::JointState{1s + 2ns, "base", names, two, {}, {}}) ==
        "00010000010000000200000005000000626173650000000002000000030000006a310000030000006a32000002000000"
        "00000000000000000000e03f000000000000f0bf0000000000000000");
  CHECK(hex(ros::String{"hello"}) == "000100000600000068656c6c6f00");
  CHECK(hex(ros::String{""}) == "000100000100000000");
}

TEST_CASE("Time: seconds are rounded down, so that nanoseconds are never negative") {
  std::vector<unsigned char> bytes(64);
  CdrWriter w(bytes);
  ros::encode(w, Nanoseconds(-1));
  CdrReader r(w.bytes());
  CHECK(r.get<std::int32_t>() == -1);
  CHECK(r.get<std::uint32_t>() == 999'999'999);
}

TEST_CASE("Messages: the sizes of the six joints, seven frames and three laws of a UR5") {
  const std::vector<std::string> joints = {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                           "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};
  const std::vector<double> six(6), eighteen(18);
  CHECK(hex(ros::JointState{0ns, "", joints, six, six, six}).size() == 2 * 316);
  const auto shares = hex(ros::Matrix{{"a,b,c", "joint"}, 3, 6, eighteen});
  CHECK(shares.size() == 2 * (4 + 4 + 12 + 8 + 12 + 8 + 4 + 4 + 4 + 18 * 8));
  ros::StampedTransform t{1s, "base_link", "tool0", {1, 2, 3}, {}};
  t.R = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};  // a quarter turn about z
  std::vector<unsigned char> bytes(256);
  CdrWriter w(bytes);
  ros::encode(w, ros::Transforms{std::span(&t, 1)});
  CdrReader r(w.bytes());
  CHECK(r.count(1) == 1);
  CHECK(r.get<std::int32_t>() == 1);
  CHECK(r.get<std::uint32_t>() == 0);
  CHECK(r.text() == "base_link");
  CHECK(r.text() == "tool0");
  const double half = std::sqrt(0.5);
  for (const double x : {1.0, 2.0, 3.0, 0.0, 0.0, half, half}) CHECK(r.get<double>() == doctest::Approx(x));
  CHECK(r.fits());
  CHECK(r.left() == 0);
}

TEST_CASE("Contacts: a point has 32 bytes, its fields are where the message says") {
  const std::vector<ContactPoint> contacts = {{{1, 2, 3}, {4, 5, 6}, 7, 8}, {}};
  std::vector<unsigned char> bytes(1024);
  CdrWriter w(bytes);
  ros::encode(w, contact_cloud(2s, "base_link", contacts));
  CdrReader r(w.bytes());
  static_cast<void>(r.get<std::uint64_t>());
  CHECK(r.text() == "base_link");
  CHECK(r.get<std::uint32_t>() == 1);
  CHECK(r.get<std::uint32_t>() == 2);
  REQUIRE(r.count(13) == 8);
  std::vector<std::uint32_t> offsets;
  for (int k = 0; k < 8; ++k) {
    static_cast<void>(r.text());
    offsets.push_back(r.get<std::uint32_t>());
    CHECK(r.get<std::uint8_t>() == (k == 7 ? 6 : 7));
    CHECK(r.get<std::uint32_t>() == 1);
  }
  CHECK_FALSE(r.get<bool>());
  CHECK(r.get<std::uint32_t>() == 32);
  CHECK(r.get<std::uint32_t>() == 64);
  REQUIRE(r.count(1) == 64);
  const auto data = r.take(64);
  for (std::uint32_t k = 0; k < 7; ++k) {
    float x = 0;
    std::memcpy(&x, data.data() + offsets[k], 4);
    CHECK(x == float(k + 1));
  }
  CHECK(data[offsets[7]] == 8);
  CHECK(r.get<bool>());
  CHECK(r.fits());
}
