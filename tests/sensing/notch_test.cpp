#include "skinctl/sensing/notch.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <type_traits>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(std::is_trivially_copyable_v<Notch<>::Memory>);

namespace {
constexpr double turn = 6.283185307179586;
/// What is left of a tone of 1 [rms over that of the tone], sampled at 1 kHz with distances that deviate by `jitter`.
template <class T>
double left(double frequency, double jitter, bool* regular = nullptr) {
  const Notch<T> notch({.frequency = 50, .width = 5, .rate = 1000});
  typename Notch<T>::Memory m;
  auto random = seeded(3);
  double t = 0, sum = 0;
  int n = 0, steady = 0;
  for (int k = 0; k < 8000; ++k) {
    // Uniform, with this rms deviation.
    t += 1e-3 * (1 + jitter * std::sqrt(3.0) * uniform(random, -1.0, 1.0));
    static_cast<void>(notch.sample(m, nanoseconds(t), static_cast<T>(std::sin(turn * frequency * t))));
    if (k < 2000) continue;
    sum += double(m.output) * double(m.output);
    ++n, steady += notch.regular(m);
  }
  if (regular != nullptr) *regular = 2 * steady > n;
  return std::sqrt(2 * sum / n);
}
}  // namespace

TEST_CASE_TEMPLATE("Notch: the closed form of its response", T, float, double) {
  // |H| of the biquad, from its poles and zeros.
  const auto response = [](double f) {
    const double w = turn * f / 1000, w0 = turn * 50 / 1000, a = std::tan(turn * 5 / 2000);
    const double zero = std::cos(w) - std::cos(w0);
    return std::abs(zero) / std::sqrt(zero * zero + a * a * std::sin(w) * std::sin(w));
  };
  const double tolerance = std::is_same_v<T, float> ? 2e-4 : 2e-5;
  CHECK(left<T>(50, 0) <= 20 * tolerance);
  for (const double f : {1.0, 20.0, 45.0, 47.5, 52.5, 100.0, 400.0})
    CHECK(left<T>(f, 0) == doctest::Approx(response(f)).epsilon(1e-3));
  CHECK(response(47.44) == doctest::Approx(std::sqrt(0.5)).epsilon(0.02));
}

TEST_CASE("Notch: what jitter leaves of the tone, and that it steps aside before it harms") {
  bool regular = false;
  CHECK(left<double>(50, 0.02, &regular) < 0.05);
  CHECK(regular);
  const double most = left<double>(50, 0.09, &regular);
  MESSAGE("9 % jitter leaves ", 20 * std::log10(most), " dB");
  CHECK(regular);
  CHECK(most < 0.3);
  // Beyond, the tone passes as it is: no worse than without a notch.
  const double beyond = left<double>(50, 0.3, &regular);
  CHECK_FALSE(regular);
  CHECK(beyond == doctest::Approx(1).epsilon(0.02));
  CHECK(left<double>(5, 0.3, &regular) == doctest::Approx(1).epsilon(0.01));
}

TEST_CASE("Notch: events pass to the bit, without ringing; steady samples bring it back without a step") {
  const Notch<> notch({.frequency = 50, .width = 5, .rate = 250});
  Notch<>::Memory m;
  auto random = seeded(4);
  Nanoseconds t{};
  for (int k = 0; k < 300; ++k) {
    t += 4ms * (1 + static_cast<int>(random() % 25));
    const double x = uniform(random, 0.0, 1.0);
    static_cast<void>(notch.sample(m, t, x));
    if (k > 60) CHECK(m.output == x);
  }
  CHECK_FALSE(notch.regular(m));
  double last = m.output, step = 0;
  for (int k = 0; k < 1000; ++k) {
    t += 4ms;
    const double x = last + (0.5 - last) * 0;  // constant
    static_cast<void>(notch.sample(m, t, x));
    step = std::max(step, std::abs(m.output - x));
  }
  CHECK(notch.regular(m));
  CHECK(m.weight == 1);
  CHECK(step < 1e-12);
}

TEST_CASE("Notch: extremes, and what it refuses") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Notch<> notch({});
  Notch<>::Memory m;
  CHECK(notch.sample(m, 0ns, nan) == Status(Reason::sample_not_finite));
  CHECK_FALSE(notch.sample(m, Nanoseconds::min(), 1.0).any());
  CHECK_FALSE(notch.sample(m, Nanoseconds::max(), 2.0).any());
  CHECK(m.output == 2);
  CHECK(notch.sample(m, 0ns, 3.0) == Status(Reason::time_backwards));
  CHECK_THROWS_AS(Notch<>({.jitter = 0.11}), ConfigurationError);
  CHECK_THROWS_AS(Notch<>({.jitter = nan}), ConfigurationError);
  CHECK_THROWS_AS(Notch<>({.rate = 0}), ConfigurationError);
  CHECK_THROWS_AS(Notch<>({.frequency = 460}), ConfigurationError);
  CHECK_THROWS_AS(Notch<>({.width = 60}), ConfigurationError);
}
