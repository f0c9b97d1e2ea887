// not sanitized: the fits of Eigen take this compiler minutes; least_squares_test holds a sample
#include "skinctl/calibration/excitation.hpp"

#include <doctest/doctest.h>

#include "bench/studies/worlds/ur5_excitation.hpp"
#include "skinctl/calibration/activation.hpp"
#include "skinctl/calibration/dynamics_excitation.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

// At rest at home at both ends; velocities and accelerations are derivatives; no jump.
void check_motion(const Excitation& motion) {
  for (const double t : {-1.0, 0.0, motion.duration(), motion.duration() + 1}) {
    const JointPoint p = motion.at(t);
    CHECK(p.q == motion.home());
    CHECK(p.dq.norm() == 0);
  }
  const double h = 1e-5;
  for (double t = 0.013; t < motion.duration(); t += 0.173) {
    const JointPoint a = motion.at(t - h), p = motion.at(t), b = motion.at(t + h);
    for (Eigen::Index j = 0; j < 6; ++j) {
      CHECK((b.q(j) - a.q(j)) / (2 * h) == doctest::Approx(p.dq(j)).epsilon(1e-6).scale(1));
      CHECK((b.dq(j) - a.dq(j)) / (2 * h) == doctest::Approx(p.ddq(j)).epsilon(1e-4).scale(20));
    }
  }
}

}  // namespace

TEST_CASE("Excitation of a skin: within every limit, each joint alone, then all, and announced") {
  const SkinExcitation motion(ur5_home, ur5_limits(), {}, ur5::Model{});
  check_motion(motion);
  CHECK(motion.largest_share(ur5_limits()) <= 0.9 + 1e-9);
  CHECK(motion.torque_share(ur5::Model{}, ur5_limits().torque) <= 0.9);
  REQUIRE(motion.announcements().size() == 7);
  for (int j = 0; j < 6; ++j) {
    const Announcement& a = motion.announcements()[std::size_t(j)];
    CHECK(a.joint == j);
    double moved = 0;
    for (double t = a.begin; t < a.end; t += 0.01) {
      const JointPoint p = motion.at(t);
      for (int i = 0; i < 6; ++i)
        if (i != j) CHECK(p.q(i) == ur5_home(i));
      moved = std::max(moved, std::abs(p.q(j) - ur5_home(j)));
    }
    CHECK(moved > 0.3);
  }
  CHECK(motion.announcements().back().joint == -1);
}

TEST_CASE("Excitation of a skin: recorded from its first instant on, each joint is seen to move alone") {
  for (const double begins : {0.0, -0.5}) {
    const SkinExcitation motion(ur5_home, ur5_limits(), {}, ur5::Model{});
    JointRecording joints;
    CellReadings cell;
    const auto rows = static_cast<Eigen::Index>((motion.duration() - begins) * 125);
    joints.q.resize(rows, 6), cell.y.resize(3, 2 * rows);
    for (Eigen::Index k = 0; k < 2 * rows; ++k) {
      const double t = begins + double(k) / 250;
      cell.time.push_back(t), cell.y.col(k) << 0, 0, 1;
      if (k % 2 == 0) joints.time.push_back(t), joints.q.row(k / 2) = motion.at(t).q.transpose();
    }
    const MeasuredMotion measured(joints);
    CHECK((measured.first() - motion.at(begins).q).norm() < 1e-4);
    const auto data = detail::fit::block_means({cell}, measured.start() + 0.2, measured.end() - 0.2, 0.04);
    const Activation found = find_activation(data, measured);
    CHECK((found.home - ur5_home).norm() < 1e-4);
    CHECK(found.moved_alone == std::vector<bool>(6, true));
  }
}

TEST_CASE("Excitation of a skin: a slow robot in a narrow place still moves within its limits") {
  ExcitationLimits narrow = ur5_limits();
  narrow.velocity.setConstant(0.3), narrow.acceleration.setConstant(1);
  for (Eigen::Index j = 0; j < 6; ++j)
    narrow.lower(j) = ur5_home(j) - 0.2, narrow.upper(j) = ur5_home(j) + 0.15;
  const SkinExcitation motion(ur5_home, narrow);
  check_motion(motion);
  CHECK(motion.largest_share(narrow) <= 0.9 + 1e-9);
  CHECK(motion.largest_share(narrow) > 0.5);
  narrow.lower(3) = ur5_home(3) - 0.05;
  CHECK_THROWS_AS(SkinExcitation(ur5_home, narrow), ConfigurationError);
  SkinExcitation::Settings brief;
  brief.duration = 5;
  CHECK_THROWS_AS(SkinExcitation(ur5_home, ur5_limits(), brief), ConfigurationError);
}

TEST_CASE("Excitation of masses: within every limit, and better than the first draw") {
  DynamicsExcitation::Settings s;
  s.tries = 1, s.periods = 1;
  const DynamicsExcitation first(ur5::Model{}, ur5_home, ur5_limits(), s);
  s.tries = 16;
  const DynamicsExcitation motion(ur5::Model{}, ur5_home, ur5_limits(), s);
  check_motion(motion);
  CHECK(motion.largest_share(ur5_limits()) <= 0.9 + 1e-3);
  CHECK(motion.torque_share(ur5::Model{}, ur5_limits().torque) <= 0.95);
  CHECK(motion.information() > first.information());
  s.range = 0.35;
  CHECK(DynamicsExcitation(ur5::Model{}, ur5_home, ur5_limits(), s).information() < motion.information());
  ExcitationLimits weak = ur5_limits();
  weak.torque.setConstant(0.1);
  CHECK_THROWS_AS(DynamicsExcitation(ur5::Model{}, ur5_home, weak, s), ConfigurationError);
}
