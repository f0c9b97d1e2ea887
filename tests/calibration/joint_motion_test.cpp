#include "skinctl/calibration/joint_motion.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "skinctl/testing/random.hpp"

using namespace skinctl;

namespace {

// Two joints that sweep and wiggle as an excitation does.
JointPoint truth(double t) {
  JointPoint p{Eigen::VectorXd(2), Eigen::VectorXd(2), Eigen::VectorXd(2)};
  for (int j = 0; j < 2; ++j) {
    const double a = 0.4 + 0.2 * j, b = 9.4 + 6.3 * j;
    p.q(j) = std::sin(a * t) + std::sin(b * t) / b;
    p.dq(j) = a * std::cos(a * t) + std::cos(b * t);
    p.ddq(j) = -a * a * std::sin(a * t) - b * std::sin(b * t);
  }
  return p;
}
JointRecording recorded(double seconds, double noise, double rate = 125) {
  auto rng = testing::seeded(3);
  std::normal_distribution<double> normal;
  JointRecording out;
  const int n = int(seconds * rate);
  out.q.resize(n, 2);
  for (int k = 0; k < n; ++k) {
    out.time.push_back(k / rate);
    for (int j = 0; j < 2; ++j) out.q(k, j) = truth(k / rate).q(j) + noise * normal(rng);
  }
  return out;
}

}  // namespace

TEST_CASE(
    "Motion from encoders: acceleration to 0.03 rad/s^2, velocity to 1 mrad/s, from 125 Hz and 1e-5 rad") {
  const MeasuredMotion motion(recorded(20, 1e-5));
  double a = 0, v = 0, q = 0, n = 0;
  for (double t = motion.start(); t < motion.end(); t += 0.0037) {
    const JointPoint p = motion.at(t), is = truth(t);
    for (int j = 0; j < 2; ++j) {
      a += std::pow(p.ddq(j) - is.ddq(j), 2), v += std::pow(p.dq(j) - is.dq(j), 2),
          q += std::pow(p.q(j) - is.q(j), 2);
      n += 1;
    }
  }
  MESSAGE("rms: " << std::sqrt(a / n) << " rad/s^2, " << std::sqrt(v / n) << " rad/s, " << std::sqrt(q / n)
                  << " rad");
  CHECK(std::sqrt(a / n) < 0.03);
  CHECK(std::sqrt(v / n) < 1e-3);
  CHECK(std::sqrt(q / n) < 1e-5);
  CHECK(motion.noise()(0) == doctest::Approx(1e-5).epsilon(0.1));
  CHECK(motion.gaps().empty());
  // Velocity and acceleration are derivatives of the position.
  const double h = 1e-4, t = 7.03;
  CHECK((motion.at(t + h).q(1) - motion.at(t - h).q(1)) / (2 * h) ==
        doctest::Approx(motion.at(t).dq(1)).epsilon(1e-5));
  CHECK((motion.at(t + h).dq(1) - motion.at(t - h).dq(1)) / (2 * h) ==
        doctest::Approx(motion.at(t).ddq(1)).epsilon(1e-4));
}

TEST_CASE("Motion from encoders: a gap is reported, and stays finite") {
  JointRecording r = recorded(10, 0);
  JointRecording cut;
  cut.q.resize(r.q.rows(), 2);
  Eigen::Index n = 0;
  for (std::size_t k = 0; k < r.time.size(); ++k)
    if (r.time[k] < 4 || r.time[k] > 5)
      cut.time.push_back(r.time[k]), cut.q.row(n++) = r.q.row(Eigen::Index(k));
  cut.q.conservativeResize(n, 2);
  const MeasuredMotion motion(cut);
  REQUIRE(motion.gaps().size() == 1);
  CHECK(motion.gap_within(4.5, 4.6));
  CHECK(!motion.gap_within(6, 7));
  CHECK(motion.at(4.5).ddq.allFinite());
  CHECK(motion.at(std::nan("")).q.allFinite());
  CHECK(std::abs(motion.at(7).ddq(0) - truth(7).ddq(0)) < 0.01);
}

TEST_CASE("Motion from encoders: damaged recordings are refused") {
  JointRecording r = recorded(10, 0);
  CHECK_THROWS_AS(MeasuredMotion(recorded(0.2, 0)), ConfigurationError);
  CHECK_THROWS_AS(MeasuredMotion(r, 0.001), ConfigurationError);
  JointRecording late = r;
  late.time[5] = late.time[4];
  CHECK_THROWS_AS(MeasuredMotion{late}, ConfigurationError);
  JointRecording nan = r;
  nan.q(7, 1) = std::nan("");
  CHECK_THROWS_AS(MeasuredMotion{nan}, ConfigurationError);
  JointRecording rows = r;
  rows.time.pop_back();
  CHECK_THROWS_AS(MeasuredMotion{rows}, ConfigurationError);
}
