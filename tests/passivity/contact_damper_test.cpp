#include "skinctl/passivity/contact_damper.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

using namespace skinctl;

namespace {

struct Seen {
  double highest = 0, last = 0, largest_step = 0;
  double first = -1;  ///< when damping began [s]
};

// A push as a function of time, for `time` seconds at 125 Hz.
Seen watch(const ContactDamper<>& damper, double time, const std::function<double(double)>& push,
           double speed = 0, double dt = 0.008) {
  auto m = damper.start<3>();
  Seen out;
  double before = 0;
  for (double t = dt; t < time; t += dt) {
    Contacts<3, double, 1> c;
    c.list[0].link = 1;
    c.list[0].force = std::max(0.0, push(t));
    c.list[0].row[2] = 0.3;
    c.count = c.list[0].force > 0 ? 1 : 0;
    const bool added = damper.observe(m, c, JointVelocity<3>{0, 0, speed}, dt);
    const double b = m.damping.coefficient[0];
    CHECK(b >= 0);
    CHECK(m.damping.count <= 1);
    CHECK(added == (b > (c.count > 0 ? damper.settings().always : 0)));
    if (added && out.first < 0) out.first = t;
    out.highest = std::max(out.highest, b);
    out.largest_step = std::max(out.largest_step, std::abs(b - before));
    before = out.last = b;
  }
  return out;
}

double swinging(double t, double hertz, double mean, double amplitude) {
  return mean + amplitude * std::sin(2 * M_PI * hertz * t);
}

}  // namespace

TEST_CASE("ContactDamper: a contact that rings is damped within two periods and a half, and bounded") {
  const ContactDamper<> damper({.max = 100});
  for (const double hertz : {2.5, 5.0, 12.0})
    for (const double mean : {5.0, 40.0, 0.0}) {
      if (mean == 0 && hertz < 4) continue;  // it bounces: half of the time it is not touched
      CAPTURE(hertz);
      CAPTURE(mean);
      const auto seen = watch(damper, 20, [&](double t) { return swinging(t, hertz, mean, 12); });
      CHECK(seen.first > 0);
      CHECK(seen.first < 2.5 / hertz + 0.05);
      CHECK(seen.highest > 90);
      CHECK(seen.highest <= 100);
      CHECK(seen.largest_step < 30);
    }
}

TEST_CASE("ContactDamper: slow pushes, single blows, what dies out, and noise are left alone") {
  const ContactDamper<> damper({.max = 100});
  const auto calm = [&](const std::function<double(double)>& push) {
    return watch(damper, 20, push).highest == 0;
  };
  CHECK(calm([](double) { return 0.0; }));
  CHECK(calm([](double t) { return 60 * std::min(t, 1.0); }));
  for (const double hertz : {0.1, 0.5, 1.0, 1.8})
    CHECK(calm([&](double t) { return swinging(t, hertz, 30, 30); }));
  CHECK(calm([](double t) { return t > 1 && t < 1.05 ? 80.0 : 0.0; }));
  CHECK(calm([](double t) { return 30 + 20 * std::exp(-10 * t) * std::cos(2 * M_PI * 4 * t); }));
  CHECK(calm([](double t) { return 30 + 1.2 * std::sin(1e4 * t); }));  // two quanta
  CHECK(calm([](double t) { return 1000 + 40 * std::sin(30 * t); }));  // a few per cent
}

TEST_CASE("ContactDamper: a little slower is a little less damping: nothing hangs by a hair") {
  // A finger that drives on: the push overshoots and swings once more. Then it is held.
  const ContactDamper<> damper({.max = 100});
  const auto highest = [&](double half_period, double rise) {
    const double level[] = {0, 9, 9 - 5.5, 9 - 5.5 + rise, 6};
    const auto push = [&](double t) {
      const auto k = static_cast<std::size_t>(t / half_period);
      if (k >= 4) return level[4];
      const double part = 0.5 - 0.5 * std::cos(M_PI * (t / half_period - double(k)));
      return level[k] + part * (level[k + 1] - level[k]);
    };
    return watch(damper, 2, push, 0, 0.001).highest;
  };
  for (int ms = 150; ms < 280; ++ms) {
    CAPTURE(ms);
    CHECK(std::abs(highest(1e-3 * ms, 6.1) - highest(1e-3 * (ms + 1), 6.1)) < 0.8);  // 6.2 by a hard limit
  }
  CHECK(highest(0.15, 6.1) > 6);
  CHECK(highest(0.26, 6.1) == 0);
}

TEST_CASE("ContactDamper: a robot that bounces is damped, however long it flies; one that is tapped is not") {
  const ContactDamper<> damper({.max = 100});
  const auto bouncing = [](double t) {
    return 30 * std::sin(2 * M_PI * 5 * std::fmod(t, 0.8)) * (std::fmod(t, 0.8) < 0.1);
  };
  CHECK(watch(damper, 10, bouncing, 0.2).highest > 20);
  CHECK(watch(damper, 10, bouncing, 0.2).first < 2.5);
  CHECK(watch(damper, 10, bouncing, -0.2).highest == 0);
  CHECK(watch(damper, 10, bouncing, 0).highest == 0);
}

TEST_CASE("ContactDamper: what has rung stays damped while the contact lasts, and fades after it") {
  const ContactDamper<> damper({.max = 100, .calm = 500ms});
  const auto then = [&](double push, double after) {
    return watch(damper, 3 + after, [&](double t) { return t < 3 ? swinging(t, 6, 20, 15) : push; }).last;
  };
  CHECK(then(20, 0.1) > 70);
  CHECK(then(20, 2.0) > 40);
  CHECK(then(0, 1.0) < 20);
  CHECK(then(0, 8.0) == 0);
  CHECK(then(20, 80.0) > 70);
}

TEST_CASE("ContactDamper: the declared damping is there while the contact lasts") {
  const ContactDamper<> damper({.always = 30});
  const auto seen = watch(damper, 2, [](double t) { return t > 1 && t < 1.5 ? 20.0 : 0.0; });
  CHECK(seen.highest == 30);
  CHECK(seen.last == 0);
}

TEST_CASE("ContactDamper: refuses nonsense") {
  CHECK_THROWS_AS(ContactDamper<>({.max = -1}), ConfigurationError);
  CHECK_THROWS_AS(ContactDamper<>({.always = std::nan("")}), ConfigurationError);
  CHECK_THROWS_AS(ContactDamper<>({.swing = 0}), ConfigurationError);
  CHECK_THROWS_AS(ContactDamper<>({.slowest = 0s}), ConfigurationError);
  CHECK_THROWS_AS(ContactDamper<>({.calm = 0s}), ConfigurationError);
}

TEST_CASE("ContactDamper: contacts of one link are told apart by side and place, and keep their damping") {
  const ContactDamper<> damper({.max = 100, .always = 10});
  auto m = damper.start<3>();
  // One rings, one is calm, on opposite sides; they come in turns and in either order.
  const auto contact = [](double force, double side, double place) {
    Contact<3> c;
    c.link = 1;
    c.force = force;
    c.row[0] = side;
    c.place = {place, 0, 0};
    c.normal = {0, 0, side};
    return c;
  };
  double ringing = 0, calm = 0;
  for (int k = 1; k < 400; ++k) {
    Contacts<3, double, 2> c;
    c.count = 2;
    c.list[k % 2] = contact(swinging(0.008 * k, 5, 40, 12), 1, 0.001 * (k % 7));
    c.list[1 - k % 2] = contact(20, -1, 0.002 * (k % 5));
    damper.observe(m, c, JointVelocity<3>{}, 0.008);
    CHECK(m.damping.count == 2);
    for (std::size_t i = 0; i < 2; ++i) (m.damping.row[i][0] > 0 ? ringing : calm) = m.damping.coefficient[i];
  }
  CHECK(ringing > 90);
  CHECK(calm == 10);
  // Ended contacts calm down and make room; however many come, there is room.
  for (int k = 0; k < 4000; ++k) damper.observe(m, Contacts<3, double, 2>{}, JointVelocity<3>{}, 0.008);
  CHECK(m.damping.count == 0);
  CHECK_FALSE(m.damping.any);
  for (int k = 0; k < 100; ++k) {
    Contacts<3, double, 9> many;
    many.count = 9;
    for (std::size_t i = 0; i < 9; ++i) {
      many.list[i] = contact(5, (k + int(i)) % 2 == 0 ? 1 : -1, 0.1 * double(i));
      many.list[i].link = (std::size_t(k) + i) % 3;
    }
    damper.observe(m, many, JointVelocity<3>{}, 0.008);
    double damped = 0;
    for (std::size_t i = 0; i < m.damping.count; ++i) damped += m.damping.coefficient[i] >= 10;
    CHECK(damped == 9);
  }
}
