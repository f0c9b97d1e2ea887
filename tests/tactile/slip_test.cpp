// Slip from shear beside normal force, against simulated blocks on bristles, which know when they slide.
#include "skinctl/tactile/slip.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/random_frames.hpp"
#include "tests/support/rubbed_block.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace slip_of_blocks {
namespace {

/// What the cells of a fingertip read: it looks along z of its link's axes turned somewhere.
template <class T>
struct Fingertip {
  Xyz<T> inward, across;
  double noise;
  std::normal_distribution<double> normal{};

  explicit Fingertip(double sigma, Random& rng) : noise(sigma) {
    const auto R = random_rotation<double>(rng);
    inward = cast<T>(R.z), across = cast<T>(R.x);
  }
  Xyz<T> reads(double f_n, double f_t, Random& rng) {
    const auto n = [&] { return T(noise * normal(rng)); };
    return T(f_n) * inward + T(f_t) * across + Xyz<T>{n(), n(), n()};
  }
};

enum class Why { filled, loosened };
struct Found {
  int slid = 0, missed = 0, early = 0;
  double latest = 0;    ///< after it slides at 10 mm/s [s]
  double way = 0;       ///< that it has slid by then [m]
  double friction = 0;  ///< largest error of what was learnt, as a share
};

/// Blocks that are carried for a second, and then filled by 1 N/s or let loose by 1 N/s.
template <class T>
Found carry(Why why, double mu, double share, double noise, double rate) {
  Found out;
  const double dt = 1 / rate;
  for (unsigned run = 1; run <= (sanitized ? 2 : 10); ++run) {
    Random rng = seeded(run);
    Fingertip<T> tip(noise, rng);
    RubbedBlock block{.bristle = {.mu = mu, .share = share}};
    const Slip<T> slip({.friction = T(mu), .max_friction = T(2), .probe = T(0.05), .noise = T(noise)});
    typename Slip<T>::Memory m;
    const double weight = 0.5 * mu * 5, later = 1 + 0.003 * run;
    double slides = -1, found = -1, from = 0, friction = 0;
    for (double t = 0; t < 6 && !(slides > 0 && t > slides + 0.3); t += dt) {
      const double u = std::max(0.0, t - later);
      const double load = weight * std::min(1.0, t / 0.3) + (why == Why::filled ? u : 0);
      const double f_n = 5 - (why == Why::loosened ? u : 0);
      block.advance(dt, load, f_n);
      if (slides < 0 && t > 0.35 && block.sliding() > 0.01) slides = t, from = block.slid();
      const auto said = slip.take(m, T(dt), tip.reads(f_n, block.friction, rng), tip.inward);
      if (said.slipping && found < 0) {
        found = t;
        out.way = std::max(out.way, slides < 0 ? 0 : block.slid() - from);
      }
      if (said.slipping) friction = double(slip.friction(m));
    }
    REQUIRE(slides > 0);
    ++out.slid;
    if (found < 0) {
      ++out.missed;
    } else if (found < slides - 0.02) {
      ++out.early;
    } else {
      out.latest = std::max(out.latest, found - slides);
      out.friction = std::max(out.friction, std::abs(friction / (mu * share) - 1));
    }
  }
  return out;
}

}  // namespace

TEST_CASE_TEMPLATE("Slip: a block that slides is found, and its friction learnt", T, float, double) {
  Found worst;
  int runs = 0;
  const auto count = [&](const Found& f) {
    runs += f.slid, worst.missed += f.missed, worst.early += f.early;
    worst.latest = std::max(worst.latest, f.latest), worst.way = std::max(worst.way, f.way);
    worst.friction = std::max(worst.friction, f.friction);
  };
  for (const double rate : {1000.0, 250.0})
    for (const double mu : {0.3, 0.6})
      for (const double share : {0.7, 0.8}) {
        // A drop of 0.07 N at 250 Hz is half of the time not told from noise of 0.02 N.
        if (rate < 1000 && mu < 0.5 && share > 0.75) continue;
        CAPTURE(rate);
        CAPTURE(mu);
        CAPTURE(share);
        count(carry<T>(Why::filled, mu, share, 0.02, rate));
        count(carry<T>(Why::loosened, mu, share, 0.02, rate));
      }
  for (const double noise : {0.05, 0.1}) count(carry<T>(Why::filled, 0.6, 0.7, noise, 1000));
  MESSAGE(runs << " slides: " << worst.missed << " missed, " << worst.early << " before; at most "
               << 1e3 * worst.latest << " ms and " << 1e3 * worst.way << " mm late; friction within "
               << 100 * worst.friction << " %");
  CHECK(worst.missed == 0);
  CHECK(worst.early == 0);
  CHECK(worst.latest < 0.05);
  CHECK(worst.way < 0.0015);
  CHECK(worst.friction < 0.1);
}

TEST_CASE_TEMPLATE("Slip: what is carried and shaken does not slip", T, float, double) {
  const double length = sanitized ? 20 : 600;
  int alarms = 0, runs = 0;
  double last = 0;
  for (const double noise : {0.02, 0.1})
    for (const double shaken : {0.0, 0.1, 0.3, 1.0, 3.0}) {
      Random rng = seeded(9);
      Fingertip<T> tip(noise, rng);
      double phase[6], hertz[6];
      for (int i = 0; i < 6; ++i) phase[i] = uniform(rng, 0.0, 6.28), hertz[i] = uniform(rng, 2.0, 30.0);
      const Slip<T> slip({.friction = T(0.5), .noise = T(noise)});
      typename Slip<T>::Memory m;
      bool was = false;
      for (double t = 0; t < length; t += 0.002) {
        double a = 0;
        for (int i = 0; i < 6; ++i) a += std::sin(6.283185307 * hertz[i] * t + phase[i]);
        const double load = 0.25 * std::min(1.0, t / 0.3) * (9.81 + shaken * std::sqrt(2.0 / 6) * a);
        const bool is = slip.take(m, T(0.002), tip.reads(7, load, rng), tip.inward).slipping;
        if (is && !was) ++alarms, last = std::max(last, t);
        was = is;
      }
      ++runs;
    }
  const double hours = runs * length / 3600;
  MESSAGE(alarms << " false alarms in " << hours << " h shaken by up to 3 m/s^2, the last after " << last
                 << " s");
  CHECK(alarms <= 2 * runs);  // while it is lifted and the unrest is not yet known
  CHECK(last < 0.5);
}

TEST_CASE("Slip: a pull that ends and a thing that is put down are no slips, and the demand leads the grip") {
  Random rng = seeded(3);
  Fingertip<double> tip(0.05, rng);
  const Slip<> slip({.probe = 0.05});
  Slip<>::Memory m;
  const auto hold = [&](double seconds, double from, double to, double f_n) {
    int slips = 0;
    for (double t = 0; t < seconds; t += 0.001)
      slips +=
          slip.take(m, 0.001, tip.reads(f_n, from + (to - from) * t / seconds, rng), tip.inward).slipping;
    return slips;
  };
  CHECK(hold(1, 0, 1, 10) == 0);
  const double quiet = slip.result(m).hold;
  CHECK(hold(0.1, 1, 3, 10) == 0);
  CHECK(slip.result(m).hold > 2.5 * quiet);  // at once, before anything slides
  CHECK(slip.result(m).margin < 0);
  hold(0.5, 3, 3, 10);
  const double before = slip.friction(m);
  hold(0.06, 3, 0.2, 10);  // released within 60 ms: at most doubted for a moment
  CHECK(hold(1, 0.2, 0.2, 10) == 0);
  CHECK(slip.friction(m) == doctest::Approx(before).epsilon(0.02));
  CHECK(slip.result(m).hold == doctest::Approx(1.4 * 0.2 / before).epsilon(0.3));
  // Let go of, it begins anew.
  hold(0.2, 0, 0, 0);
  CHECK(slip.result(m).hold == 0);
  CHECK(slip.friction(m) == slip.settings().friction);
}

TEST_CASE(
    "Slip: while it slides the grip is asked for more, until it sticks; what sticks is loosened slowly") {
  const Slip<> slip({.probe = 0.05});
  Slip<>::Memory m;
  for (int k = 0; k < 1000; ++k) slip.take(m, 0.001, {2, 0, 5}, {0, 0, 1});
  const double grown = slip.friction(m);
  CHECK(grown == doctest::Approx(0.25 * std::exp(0.05)).epsilon(1e-3));
  for (int k = 0; k < 60; ++k) slip.take(m, 0.001, {2 - 0.01 * k, 0, 5}, {0, 0, 1});  // slides
  auto said = slip.result(m);
  CHECK(said.slipping);
  CHECK(said.hold > 1.3 * 5);
  for (int k = 0; k < 100; ++k) said = slip.take(m, 0.001, {1.4, 0, 5 + 0.05 * k}, {0, 0, 1});
  // The grip has tightened to 10 N, and it sticks: the friction is that of the slide.
  CHECK(slip.friction(m) == doctest::Approx(grown).epsilon(0.2));
  CHECK(said.margin > 0.4);
}

TEST_CASE_TEMPLATE("Slip: any number leaves finite, bounded answers, and allocates nothing", T, float,
                   double) {
  Random rng = seeded(8);
  const T nan = std::numeric_limits<T>::quiet_NaN(), huge = std::numeric_limits<T>::max();
  const T some[] = {T(0),
                    T(-0.0),
                    T(1e-30),
                    T(1e-8),
                    T(1),
                    T(-1),
                    T(1e6),
                    T(1e18),
                    huge,
                    -huge,
                    std::numeric_limits<T>::infinity(),
                    nan,
                    std::numeric_limits<T>::denorm_min()};
  const auto any = [&] { return some[rng() % std::size(some)]; };
  const Slip<T> slip;
  typename Slip<T>::Memory m;
  const AllocationGuard guard;
  bool sound = true;
  for (int k = 0; k < 200000; ++k) {
    if (k % 1000 == 0) m = {};
    const bool tame = rng() % 2 == 0;
    const Xyz<T> force = tame ? Xyz<T>{any(), T(1), T(5)} : Xyz<T>{any(), any(), any()};
    const auto said = slip.take(m, tame ? T(0.001) : any(), force,
                                tame ? Xyz<T>{T(0), T(0), T(1)} : Xyz<T>{any(), any(), any()});
    sound = sound && std::isfinite(said.demand) && std::isfinite(said.margin) && std::isfinite(said.hold) &&
            said.hold >= T(0) && said.demand >= T(0) && slip.friction(m) > T(0) && m.peak >= m.shear;
  }
  CHECK(guard.count() == 0);
  CHECK(sound);
  // What is not finite changes nothing.
  m = {};
  slip.take(m, T(0.001), {T(1), T(0), T(5)}, {T(0), T(0), T(1)});
  const T demand = slip.result(m).demand;
  slip.take(m, nan, {T(1), T(0), T(5)}, {T(0), T(0), T(1)});
  slip.take(m, T(0.001), {nan, T(0), T(5)}, {T(0), T(0), T(1)});
  slip.take(m, T(0.001), {T(1), T(0), T(5)}, {T(0), T(0), nan});
  CHECK(slip.result(m).demand == demand);
}

TEST_CASE("Slip: settings out of their ranges are refused") {
  CHECK_THROWS_AS(Slip<>({.friction = 0}), ConfigurationError);
  CHECK_THROWS_AS(Slip<>({.friction = 0.9}), ConfigurationError);  // above max_friction
  CHECK_THROWS_AS(Slip<>({.reserve = 1}), ConfigurationError);
  CHECK_THROWS_AS(Slip<>({.noise = 0}), ConfigurationError);
  CHECK_THROWS_AS(Slip<>({.filter = 0}), ConfigurationError);
  CHECK_THROWS_AS(Slip<>({.min_normal = 0}), ConfigurationError);
}

}  // namespace slip_of_blocks
