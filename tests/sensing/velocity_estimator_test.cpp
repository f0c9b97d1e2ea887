// Promise: devices that report positions only get velocities whose lag and noise are as stated
// Tried: windows of 2 to 12 samples, lines and parabolas, 0.5 to 20 Hz: response to 1e-6 on time, to 3 %
// with stamps that jitter by 30 %; noise of encoder steps within 8 %; the recorded Allegro, stamps off by
// 3 ms: 12 ms found, 10.5 stated

#include "skinctl/sensing/velocity_estimator.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr double step = 333.3 / 65536 * M_PI / 180;  // of the Allegro's encoders

/// The last velocity after feeding `q(t)` at these stamps.
template <class Estimator, class Motion>
std::vector<double> velocities(const Estimator& estimator, const std::vector<Nanoseconds>& stamps,
                               const Motion& q) {
  typename Estimator::Memory memory;
  std::vector<double> out;
  for (const Nanoseconds t : stamps) {
    JointPosition<Estimator::joints> at;
    for (std::size_t i = 0; i < Estimator::joints; ++i) at[i] = q(seconds<double>(t));
    CHECK_FALSE(estimator.observe(memory, at, t).any());
    out.push_back(memory.state.dq[0]);
  }
  return out;
}
std::vector<Nanoseconds> jittered(std::size_t count, double jitter, double lost, unsigned seed) {
  Seeded random(seed);
  std::vector<Nanoseconds> stamps;
  for (std::size_t k = 0; stamps.size() < count; ++k)
    if (0.5 + 0.5 * random() >= lost)
      stamps.push_back(3ms * long(k) + nanoseconds(jitter * 0.003 * random()));
  return stamps;
}

/// Amplitude and phase of the fundamental of `y` at `w` [rad/s], against cos(w t).
std::complex<double> fundamental(const std::vector<Nanoseconds>& t, const std::vector<double>& y, double w,
                                 std::size_t from) {
  double cc = 0, cs = 0, ss = 0, yc = 0, ys = 0;
  for (std::size_t k = from; k < t.size(); ++k) {
    const double c = std::cos(w * seconds<double>(t[k])), s = std::sin(w * seconds<double>(t[k]));
    cc += c * c, cs += c * s, ss += s * s, yc += y[k] * c, ys += y[k] * s;
  }
  const double det = cc * ss - cs * cs;
  return {(yc * ss - ys * cs) / det, -(ys * cc - yc * cs) / det};
}

}  // namespace

TEST_CASE("VelocityEstimator: exact for a constant velocity, or acceleration, at irregular and lost stamps") {
  const auto stamps = jittered(400, 0.4, 0.2, 1);
  const VelocityEstimator<1, 6, 1> line;
  const auto constant = velocities(line, stamps, [](double t) { return 0.3 - 1.7 * t; });
  const VelocityEstimator<1, 6, 2> parabola;
  const auto rising = velocities(parabola, stamps, [](double t) { return 0.3 - 1.7 * t + 2.5 * t * t; });
  for (std::size_t k = 8; k < stamps.size(); ++k) {
    CHECK(std::abs(constant[k] + 1.7) <= 1e-9);
    CHECK(std::abs(rising[k] - (-1.7 + 5 * seconds<double>(stamps[k]))) <= 1e-8);
  }
}

TEST_CASE_TEMPLATE("VelocityEstimator: sinusoids show the stated response and lag", E,
                   VelocityEstimator<1, 2, 1>, VelocityEstimator<1, 5, 1>, VelocityEstimator<1, 12, 1>,
                   VelocityEstimator<1, 5, 2>, VelocityEstimator<1, 12, 2>) {
  const E estimator;
  const bool is_line = estimator.lag() > 0ns;
  for (const double hz : {0.5, 2.0, 8.0, 20.0}) {
    const double w = 2 * M_PI * hz;
    CAPTURE(hz);
    const auto seen = [&](double jitter) {
      const auto t = jittered(2000, jitter, 0, 5);
      return fundamental(t, velocities(estimator, t, [&](double x) { return std::sin(w * x) / w; }), w, 50);
    };
    const auto stated = estimator.response(hz);
    CHECK(std::abs(seen(0) - stated) <= 1e-6 * std::abs(stated));
    CHECK(std::abs(seen(0.3) - stated) <= 0.03 * std::abs(stated));
    // The lag is that of slow motions: up to a tenth of a period over the window.
    if (hz * 0.003 * double(E::window) <= 0.1) {
      const double delay = -std::arg(stated) / w;
      CHECK(std::abs(delay - seconds<double>(estimator.lag())) <=
            (is_line ? 0.02 : 0.05) * 0.0015 * double(E::window));
      CHECK(std::abs(std::abs(stated) - 1) <= (is_line ? 0.02 : 0.06));
    }
  }
}

TEST_CASE("VelocityEstimator: encoder steps make the stated noise") {
  const auto measure = [](const auto& estimator) {
    // A motion over thousands of steps: readings within a step are evenly distributed.
    const auto t = jittered(20000, 0, 0, 2);
    const auto q = [](double x) { return 0.37 * std::sin(1.1 * x) + 0.2 * x; };
    const auto smooth = velocities(estimator, t, q);
    const auto stepped = velocities(estimator, t, [&](double x) { return step * std::round(q(x) / step); });
    double square = 0, worst = 0;
    for (std::size_t k = 50; k < t.size(); ++k) {
      const double e = stepped[k] - smooth[k];
      square += e * e;
      worst = std::max(worst, std::abs(e));
    }
    CHECK(std::sqrt(square / double(t.size() - 50)) == doctest::Approx(estimator.noise()).epsilon(0.08));
    CHECK(worst <= estimator.worst_noise() * (1 + 1e-9));
  };
  measure(VelocityEstimator<1, 2, 1>({.step = step}));
  measure(VelocityEstimator<1, 5, 1>({.step = step}));
  measure(VelocityEstimator<1, 12, 1>({.step = step}));
  measure(VelocityEstimator<1, 5, 2>({.step = step}));
  measure(VelocityEstimator<1, 12, 2>({.step = step}));
  // The figures of the docstring.
  CHECK(VelocityEstimator<16, 5>({.step = step}).noise() == doctest::Approx(2.7e-3).epsilon(0.01));
  CHECK(VelocityEstimator<16, 2>({.step = step}).noise() == doctest::Approx(12e-3).epsilon(0.01));
  CHECK(VelocityEstimator<16, 5>().lag() == 6ms);
  CHECK(VelocityEstimator<16, 2>().lag() == 1500us);
  CHECK(VelocityEstimator<16, 40>().gain_of_noise() ==
        doctest::Approx(std::sqrt(12.0 / 64000) / 0.003).epsilon(0.01));
  CHECK(VelocityEstimator<16, 40, 2>().gain_of_noise() ==
        doctest::Approx(std::sqrt(192.0 / 64000) / 0.003).epsilon(0.05));
}

TEST_CASE("VelocityEstimator: nothing that arrives makes nonsense") {
  const VelocityEstimator<2, 5> estimator;
  VelocityEstimator<2, 5>::Memory memory;
  const JointPosition<2> at{1, 2};
  CHECK_FALSE(estimator.observe(memory, at, 3ms).any());
  CHECK(memory.state.dq[0] == 0);
  for (int k = 2; k <= 10; ++k)
    CHECK_FALSE(estimator.observe(memory, {1 + 0.003 * k, 2 - 0.006 * k}, 3ms * k).any());
  CHECK(memory.state.dq[0] == doctest::Approx(1));
  CHECK(memory.state.dq[1] == doctest::Approx(-2));
  const auto good = memory;
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300}) {
    CHECK(estimator.observe(memory, {bad, 0}, 33ms) == Status(Reason::state_not_finite));
    CHECK(memory == good);
  }
  CHECK_FALSE(estimator.observe(memory, {5, 5}, 30ms).any());  // repeated
  CHECK(memory == good);
  CHECK(estimator.observe(memory, {5, 5}, 27ms) == Status(Reason::time_backwards));
  CHECK(memory == good);
  // A gap, or a clock that was set back: anew, at rest.
  CHECK_FALSE(estimator.observe(memory, {3, 3}, 90ms).any());
  CHECK(memory.count == 1);
  CHECK(memory.state.dq[0] == 0);
  CHECK_FALSE(estimator.observe(memory, {3.003, 3}, 93ms).any());
  CHECK(memory.state.dq[0] == doctest::Approx(1));
  CHECK_FALSE(estimator.observe(memory, {3, 3}, 2ms).any());
  CHECK(memory.count == 1);
  // Two samples a nanosecond apart are no velocity.
  CHECK_FALSE(estimator.observe(memory, {3.0001, 3}, 2ms + 1ns).any());
  CHECK(memory.state.dq[0] == 0);
  // Any stamps: never NaN.
  Seeded random(4);
  VelocityEstimator<2, 5, 2> parabola;
  VelocityEstimator<2, 5, 2>::Memory any;
  Nanoseconds now = 0ns;
  double fastest = 0;
  for (int k = 0; k < 20000; ++k) {
    now += Nanoseconds(long(std::pow(10, 4 + 4 * random())));
    static_cast<void>(parabola.observe(any, {1e-4 * random(), 0}, now));
    fastest = std::max(fastest, std::abs(any.state.dq[0]));
    REQUIRE(std::isfinite(any.state.dq[0]));
  }
  CHECK(fastest < 200);  // stamps of 1 ns to 0.1 s apart: a parabola through 0.2 mrad, bounded
  CHECK_THROWS_AS((VelocityEstimator<1>({.period = 0ns})), ConfigurationError);
  CHECK_THROWS_AS((VelocityEstimator<1>({.max_gap = 1ms})), ConfigurationError);
  CHECK_THROWS_AS((VelocityEstimator<1>({.step = std::nan("")})), ConfigurationError);
}

TEST_CASE("VelocityEstimator: an Allegro hand moves as estimated, the stated lag ago") {
  const char* data = std::getenv("SKINCTL_DATA_DIR");
  if (data == nullptr) {
    MESSAGE("skipped: SKINCTL_DATA_DIR is not set");
    return;
  }
  std::ifstream file(std::string(data) + "/allegro_joint_log/jointstates.csv");
  REQUIRE(file.good());
  std::string line;
  std::getline(file, line);
  std::vector<double> t;
  std::vector<JointPosition<16>> q;
  while (std::getline(file, line)) {
    std::istringstream row(line);
    std::string field;
    std::getline(row, field, ',');
    t.push_back(std::stod(field));
    q.emplace_back();
    for (std::size_t i = 0; i < 16 && std::getline(row, field, ','); ++i) q.back()[i] = std::stod(field);
  }
  REQUIRE(t.size() == 2697);
  const VelocityEstimator<16, 8> estimator({.step = step});
  VelocityEstimator<16, 8>::Memory memory;
  std::vector<JointVelocity<16>> estimated;
  for (std::size_t k = 0; k < t.size(); ++k) {
    CHECK_FALSE(estimator.observe(memory, q[k], nanoseconds(t[k])).any());
    estimated.push_back(memory.state.dq);
  }
  // Of the line through 25 samples around a time, before and after it: what a program sees later.
  const auto later = [&](std::size_t i, double time) {
    const auto at = static_cast<std::size_t>(std::lower_bound(t.begin(), t.end(), time) - t.begin());
    double n = 0, st = 0, sq = 0, stt = 0, stq = 0;
    for (std::size_t k = at - 12; k <= at + 12; ++k) {
      const double x = t[k] - time;
      n += 1, st += x, sq += q[k][i], stt += x * x, stq += x * q[k][i];
    }
    return (n * stq - st * sq) / (n * stt - st * st);
  };
  // All joints that move, faster than 0.3 rad/s in the root of the mean square; the stamps jitter by 3 ms.
  double best = 0, least = 1e9, unshifted = 0;
  for (double lag = 0; lag <= 0.025; lag += 0.0005) {
    double square = 0;
    for (const std::size_t i : {1u, 5u, 6u, 9u, 10u, 11u})
      for (std::size_t k = 40; k + 40 < t.size(); ++k)
        square += std::pow(estimated[k][i] - later(i, t[k] - lag), 2);
    if (lag == 0) unshifted = square;
    if (square < least) least = square, best = lag;
  }
  CAPTURE(best);
  CHECK(std::abs(best - seconds<double>(estimator.lag())) <= 0.003);
  CHECK(least < 0.9 * unshifted);
  // Fingers at rest: far calmer than the difference of two positions, as `noise` says.
  const VelocityEstimator<16, 2> difference({.step = step});
  VelocityEstimator<16, 2>::Memory two;
  double calm = 0, rough = 0;
  for (std::size_t k = 0; k < t.size(); ++k) {
    static_cast<void>(difference.observe(two, q[k], nanoseconds(t[k])));
    for (std::size_t i = 12; i < 16; ++i)
      calm += std::pow(estimated[k][i], 2), rough += std::pow(two.state.dq[i], 2);
  }
  CAPTURE(std::sqrt(calm / rough));
  CHECK(calm < 0.2 * 0.2 * rough);
}
