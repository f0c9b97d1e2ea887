#include "skinctl/io/ur_calibration.hpp"

#include <doctest/doctest.h>

#include <cstdio>
#include <filesystem>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/universal_robots.hpp"
#include "support/wrong_text.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/robot_table.hpp"

using namespace skinctl;
using testing::replaced;

namespace {

// As a controller writes it; the numbers are made up, of the size that real ones have.
const std::string good = R"(# Calibration of one arm
[identity]
serial = 20200000
[mounting]
delta_theta = [ -1.42e-07, 0.02, -0.05, 0.03, 1.22e-06, 4.74e-09] 
delta_a = [ 0.000105, 0.0008, 0.0011, -1.038e-05, 1.028e-05, 0]
delta_d = [ 0.000248, 3.5, -4.25, 0.75, -0.000155, -0.000962]   # metres
delta_alpha = [ -0.00036, 0.0002, 0.0015, 0.0003, -0.0002, 0]
joint_checksum = [ 0xb41b2338, 0xb42edc4e, 0xb41b2338, 0xb42edc4e, 0xb41b2338, 0xb42edc4e]
calibration_status = 2	# 0 == notInitialized / 1 == notLinearised / 2 == Linearised
[Hysteresis]
delta_a = not of this section
)";

std::string complaint(const std::string& text) {
  return testing::complaint_of([&] { return parse_ur_calibration(text, "arm.conf"); });
}

}  // namespace

TEST_CASE("UR calibration: the lists come out as they stand there, and load into the arm") {
  const DhDelta<6> delta = parse_ur_calibration(good);
  CHECK(delta.theta == std::array<double, 6>{-1.42e-07, 0.02, -0.05, 0.03, 1.22e-06, 4.74e-09});
  CHECK(delta.a[3] == -1.038e-05);
  CHECK(delta.d[2] == -4.25);
  CHECK(delta.alpha[0] == -0.00036);
  CHECK(parse_ur_calibration(replaced(good, "\n", "\r\n")).d == delta.d);

  // The flange where the products of the rows put it.
  const auto arm = calibrated_universal_robot<ur5e::Description>(delta);
  const auto end = calibrated_dh<6>(ur5e::Description::rows, delta, ur5e::Description::inertias).end;
  JointPosition<6> q{0.3, -1.2, 0.8, -0.4, 1.1, 2.0};
  Transform<Base, Flange> X;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& row = ur5e::Description::rows[i];
    X = X.rotated_z(q[i] + row.theta + delta.theta[i])
            .translated(row.a + delta.a[i], 0, row.d + delta.d[i])
            .rotated_x(std::atan2(row.alpha.sin, row.alpha.cos) + delta.alpha[i]);
  }
  const auto tip = link_poses(arm, q).get<5>();
  const auto flange = tip.origin() + tip.axes() * Xyz<double>{end.p[0], end.p[1], end.p[2]};
  CHECK(flange.x == doctest::Approx(X.origin().x).epsilon(1e-12));
  CHECK(flange.y == doctest::Approx(X.origin().y).epsilon(1e-12));
  CHECK(flange.z == doctest::Approx(X.origin().z).epsilon(1e-12));
}

TEST_CASE("UR calibration: a bad file gives one clear error that names the line") {
  CHECK(complaint("") == "skinctl: arm.conf: no delta_theta in [mounting]");
  CHECK(complaint(replaced(good, "[mounting]", "[mount")) ==
        "skinctl: arm.conf:4: a section without its closing bracket");
  CHECK(complaint(replaced(good, "[mounting]", "[other]")) ==
        "skinctl: arm.conf: no delta_theta in [mounting]");
  CHECK(complaint(replaced(good, "delta_d", "delta_e")) == "skinctl: arm.conf: no delta_d in [mounting]");
  CHECK(complaint(replaced(good, "delta_d", "delta_a")) ==
        "skinctl: arm.conf:7: a second delta_a, the first is in line 6");
  CHECK(complaint(replaced(good, "0.0008, ", "")) == "skinctl: arm.conf:6: delta_a has not six numbers");
  CHECK(complaint(replaced(good, "0.0008, ", "0.1, 0.2, ")) ==
        "skinctl: arm.conf:6: delta_a has not six numbers");
  CHECK(complaint(replaced(good, "0.0008", "0.0.8")) == "skinctl: arm.conf:6: delta_a: number 2 is none");
  CHECK(complaint(replaced(good, "0.0008", "")) == "skinctl: arm.conf:6: delta_a: number 2 is none");
  CHECK(complaint(replaced(good, "0.0008", "nan")) ==
        "skinctl: arm.conf:6: delta_a: number 2 lies outside of +-1 m");
  CHECK(complaint(replaced(good, "0.0008", "1e999")) == "skinctl: arm.conf:6: delta_a: number 2 is none");
  CHECK(complaint(replaced(good, "0.0015", "0.2")) ==
        "skinctl: arm.conf:8: delta_alpha: number 3 lies outside of +-0.1 rad");
  CHECK(complaint(replaced(good, "= [ -0.00036", "= ( -0.00036")) ==
        "skinctl: arm.conf:8: delta_alpha is no list in brackets");
  CHECK(complaint(replaced(good, "calibration_status = 2", "calibration_status = 1")) ==
        "skinctl: arm.conf:10: calibration_status is not 2: this robot's calibration is not in use");
  CHECK(complaint(replaced(good, "joint_checksum =", "joint_checksum")) ==
        "skinctl: arm.conf:9: no \"key = value\"");
  CHECK(complaint(std::string((std::size_t(1) << 20) + 1, '#')) ==
        "skinctl: arm.conf: 1048577 bytes, allowed: 1 MiB");
}

TEST_CASE("UR calibration: files") {
  CHECK_THROWS_AS(static_cast<void>(read_ur_calibration("/no/such/calibration.conf")), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(read_ur_calibration(std::filesystem::temp_directory_path().string())),
                  ConfigurationError);
  std::string path = (std::filesystem::temp_directory_path() / "skinctl-calibration-XXXXXX").string();
  const int file = mkstemp(path.data());
  REQUIRE(file >= 0);
  std::FILE* out = fdopen(file, "w");
  std::fputs(good.c_str(), out);
  std::fclose(out);
  CHECK(read_ur_calibration(path).d == parse_ur_calibration(good).d);
  std::filesystem::remove(path);
}

TEST_CASE(
    "UR calibration: whatever the bytes, finite numbers within the ranges or a complaint with the source") {
  oracle::Random random(1);
  int refused = 0;
  const int rounds = SKINCTL_MANY_DIGITS ? 20000 : 2000;
  for (int k = 0; k < rounds; ++k) {
    std::string text = good;
    if (k % 2 == 0) text.resize(random.bits() % text.size());
    for (int changes = random.index(4); changes >= 0 && !text.empty(); --changes) {
      const std::size_t at = random.bits() % text.size();
      switch (random.index(4)) {
        case 0:
          text[at] = static_cast<char>(random.bits());
          break;
        case 1:
          text.erase(at, 1 + random.bits() % 8);
          break;
        case 2:
          text.insert(at, 1, "[]=,#-+.e\n\0 9"[random.bits() % 13]);
          break;
        default:
          text.insert(at, text.substr(random.bits() % text.size(), random.bits() % 40));
      }
    }
    try {
      const DhDelta<6> delta = parse_ur_calibration(text, "arm.conf");
      for (std::size_t i = 0; i < 6; ++i) {
        CHECK(std::abs(delta.theta[i]) <= 6.3);
        CHECK(std::abs(delta.a[i]) <= 1);
        CHECK(std::abs(delta.d[i]) <= 1e4);
        CHECK(std::abs(delta.alpha[i]) <= 0.1);
      }
    } catch (const ConfigurationError& e) {
      ++refused;
      CHECK(std::string(e.what()).rfind("skinctl: arm.conf:", 0) == 0);
    }
  }
  CHECK(refused > rounds / 4);
  CHECK(refused < rounds);
}
