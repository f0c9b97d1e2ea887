// Promise: robots that decide in turn keep clear of what the other may fill until it stands
// Tried: two UR5 60 cm apart, 40 scenes with wishes of up to 2.5 rad/s, in every second one each hunts
// the other: nearest 20.7 mm of 20, without seeing 22 of 40 meet; no acceleration above the limit; both
// get back; an obstacle that comes at 0.3 m/s, or was heard of late, is kept that much further; without
// news, with too many or no numbers it brakes and stands; an arm whose base is held 0.03 rad beside its
// commands keeps 19.9 mm where it is (12.9 before). Also: study `crossings`
//
// Promise: at its margin, and up to 1 mm within it, an arm slides along what stands there, and comes no
// nearer
// Tried: a ball beside the last link of a UR5, 60 random poses and wishes that close: of 0.48 s of the
// way along it went 0.44 in the mean, 0.36 at worst

#include <doctest/doctest.h>

#include <algorithm>
#include <memory>

#include "skinctl/recording/cycle_bytes.hpp"
#include "skinctl/skinctl.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/governor_alone.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Arm = ur5::Model;
constexpr double dt = 0.008;

ClearanceAround<16> clearance() {
  ClearanceAround<16> c;
  for (std::size_t i = 0; i < 6; ++i)
    c.own.capsules.push_back({i, {ur5::tubes[i].from, ur5::tubes[i].to, ur5::tubes[i].radius}});
  c.own.margin = 0.02;
  c.own.reach = 1.2;
  c.exposed = {1, 2, 3, 4, 5};
  return c;
}
Transform<World, Base> base(int arm) {
  return arm == 0
             ? Transform<World, Base>()
             : Transform<World, Base>({{-1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}, {0.0, 0.0, 1.0}}, {0.6, 0.1, 0.0});
}
/// Points along the tubes of an arm, in the world: the judge shares no distance with what it judges.
struct Points {
  std::vector<std::pair<Xyz<double>, double>> at;

  Points(int arm, const JointPosition<6>& q) {
    const auto poses = link_poses(Arm{}, q);
    const auto one = [&](auto link) {
      constexpr std::size_t i = link.value;
      const auto X = base(arm) * poses.template get<i>();
      for (int n = 0; n <= 12; ++n) {
        const Xyz<double> p = ur5::tubes[i].from + n / 12.0 * (ur5::tubes[i].to - ur5::tubes[i].from);
        at.emplace_back(X.origin() + X.axes() * p, ur5::tubes[i].radius);
      }
    };
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (one(std::integral_constant<std::size_t, I + 1>{}), ...);
    }(std::make_index_sequence<5>{});
  }
  [[nodiscard]] double to(const Points& other) const {
    double least = 1e9;
    for (const auto& [p, r] : at)
      for (const auto& [o, s] : other.at) least = std::min(least, norm(Xyz<double>(p - o)) - r - s);
    return least;
  }
};

}  // namespace

/// Adds to `want` what brings arm `a` nearer to the other one, of the same size.
void hunt(JointVelocity<6>& want, std::size_t a, const std::array<JointCommand<6>, 2>& last) {
  const Points other(1 - static_cast<int>(a), last[1 - a].position);
  const double d = Points(static_cast<int>(a), last[a].position).to(other);
  JointVelocity<6> nearer;
  double most = 1e-9;
  for (std::size_t i = 0; i < 6; ++i) {
    auto q = last[a].position;
    q[i] += 1e-3;
    nearer[i] = d - Points(static_cast<int>(a), q).to(other);
    most = std::max(most, std::abs(nearer[i]));
  }
  for (std::size_t i = 0; i < 6; ++i) want[i] = 0.5 * want[i] + 2.5 / most * nearer[i];
}

TEST_CASE("ClearanceAround: two arms that see what the other one may fill never meet, and get apart again") {
  const auto limits = limits_of<ur5::Description>(15.0);
  const ClearanceLimits<Arm, double, 16> clear(Arm{}, limits, clearance());
  const auto governor = governor_alone<Interface::position, Arm>(limits, clear);
  double least = 1e9, blind = 1e9, step = 0, apart = 1e9, volumes = 1e9;
  int limited = 0, scenes = 0, met = 0;
  auto rng = seeded(11);
  while (scenes < (sanitized ? 4 : by_day ? 12 : 40)) {
    std::array<JointPosition<6>, 2> start;
    for (auto& q : start)
      for (auto& x : q) x = uniform(rng, -3.0, 3.0);
    if (Points(0, start[0]).to(Points(1, start[1])) < 0.1) continue;
    ++scenes;
    for (const bool sees : {true, false}) {
      std::array<std::remove_cvref_t<decltype(governor)>::Memory, 2> memory{};
      std::array<JointCommand<6>, 2> last, before;
      for (std::size_t a = 0; a < 2; ++a)
        last[a].valid = true, last[a].position = start[a], before[a] = last[a];
      auto random = seeded(static_cast<std::uint64_t>(scenes));
      std::array<JointVelocity<6>, 2> want;
      bool together = false;
      const auto cycle = [&](int n) {
        for (std::size_t a = 0; a < 2; ++a) {
          const std::size_t b = 1 - a;
          // The robot is a command behind what it was told.
          const State<6> mine{.time = n * 8ms, .q = before[a].position, .dq = before[a].velocity},
              theirs{.time = n * 8ms, .q = before[b].position, .dq = before[b].velocity};
          Surroundings<16> near;
          near.time = n * 8ms;
          if (sees) {
            Surroundings<12, World> filled;
            filled.add(base(static_cast<int>(b)), clear.occupied(last[b], theirs));
            near.add(base(static_cast<int>(a)).inverse(), filled);
          }
          JointCommand<6> wish = last[a];
          for (std::size_t i = 0; i < 6; ++i) {
            wish.velocity[i] =
                last[a].velocity[i] + std::clamp(want[a][i] - last[a].velocity[i], -15 * dt, 15 * dt);
            wish.position[i] = last[a].position[i] + 0.5 * dt * (last[a].velocity[i] + wish.velocity[i]);
          }
          const AllocationGuard guard;
          governor.see(memory[a], AroundRobot<Surroundings<16>>{near}, mine.q, n * 8ms);
          const auto out = governor.step(memory[a], last[a], wish, mine, NoTouch{}, NoTouch{}, dt);
          const auto allocated = guard.count();
          REQUIRE(allocated == 0);
          for (std::size_t i = 0; i < 6; ++i)
            step = std::max(step, std::abs(out.command.velocity[i] - last[a].velocity[i]) / dt);
          limited += out.status.has(Reason::clearance_kept);
          before[a] = last[a];
          last[a] = out.altered ? out.command : wish;
        }
        // Neither where they are told to be nor where they are: the one at its place, the other at its
        // command.
        const Points told[] = {{0, last[0].position}, {1, last[1].position}},
                     is[] = {{0, before[0].position}, {1, before[1].position}};
        const double d =
            std::min({told[0].to(told[1]), is[0].to(is[1]), is[0].to(told[1]), told[0].to(is[1])});
        (sees ? least : blind) = std::min(sees ? least : blind, d);
        together = together || d < 0;
        if (sees) {
          const auto filled = [&](std::size_t a) {
            Surroundings<12, World> out;
            out.add(base(static_cast<int>(a)),
                    clear.occupied(last[a], {.q = before[a].position, .dq = before[a].velocity}));
            return out;
          };
          const auto one = filled(0), two = filled(1);
          for (std::size_t i = 0; i < one.count; ++i)
            for (std::size_t j = 0; j < two.count; ++j)
              volumes = std::min(volumes, distance(one.obstacles[i].shape, two.obstacles[j].shape).distance);
        }
        return d;
      };
      int n = 0;
      double d = 0;
      for (; n < 200; ++n) {
        if (n % 25 == 0)
          for (std::size_t a = 0; a < 2; ++a) {
            for (auto& v : want[a]) v = uniform(random, -2.5, 2.5);
            if (scenes % 2 == 0) hunt(want[a], a, last);
          }
        d = cycle(n);
      }
      met += !sees && together;
      if (!sees) continue;
      // Back to where they came from: whatever leads away passes.
      double end = d;
      for (; n < 500; ++n) {
        for (std::size_t a = 0; a < 2; ++a)
          for (std::size_t i = 0; i < 6; ++i)
            want[a][i] = std::clamp(2 * (start[a][i] - last[a].position[i]), -1.0, 1.0);
        end = cycle(n);
      }
      apart = std::min(apart, end);
    }
  }
  MESSAGE("least distance " << 1e3 * least << " mm, without seeing " << 1e3 * blind << " mm (" << met
                            << " of " << scenes << " meet), limited in " << limited << " cycles, at last "
                            << 1e3 * apart << " mm; what both may fill " << 1e3 * volumes << " mm apart");
  CHECK(met >= scenes / 8);
  CHECK(limited > 20);
  CHECK(least >= 0.02);
  CHECK(volumes >= 0.005);  // a quarter of the margin
  CHECK(step <= 15 * 1.0001);
}

TEST_CASE("ClearanceAround: an arm stops before what comes closer, lets it pass, and is blind without news") {
  const auto limits = limits_of<ur5::Description>(15.0);
  const ClearanceLimits<Arm, double, 16> clear(Arm{}, limits, clearance());
  using Seen = ClearanceLimits<Arm, double, 16>::Memory;
  const JointPosition<6> q{0.0, -1.2, 1.4, -0.2, 0.3, 0.0};
  const auto room = limits.room(q);
  const JointVelocity<6> still{}, up{0.0, -0.8, 0.0, 0.0, 0.0, 0.0};
  const auto elbow_at = [](const JointPosition<6>& x) {
    const auto X = link_poses(Arm{}, x).get<2>();
    return Xyz<double>(X.origin() + X.axes() * ur5::tubes[2].from);
  };
  const Xyz<double> elbow = elbow_at(q), way = elbow_at(integrate(q, up, 1e-4)) - elbow;
  const Xyz<double> ahead = (1 / norm(way)) * way;
  const auto seen = [&](double off, double approach, Nanoseconds stamp, std::uint32_t count = 1) {
    Seen m{};
    Surroundings<16> near;
    near.time = stamp;
    const Xyz<double> p = elbow + off * ahead;
    near.add({{p, p, 0.05}, approach});
    near.count = count;
    clear.see(m, near, q, 1s);
    return m;
  };
  const auto any = [](const auto&) { return true; };
  const auto goes = [&](const Seen& m, const JointVelocity<6>& u) {
    return !clear.within(m, q, room, still, u, dt, any).limited;
  };
  CHECK(goes(seen(1.0, 0.3, 1s), up));
  CHECK_FALSE(goes(seen(0.13, 0.3, 1s), up));
  CHECK(goes(seen(0.13, 0.3, 1s), -1.0 * up));
  // Nearer by what it moves by itself, and by what is not known of it.
  double stands = 0.1, comes = 0.1;
  while (!goes(seen(stands, 0.0, 1s), up)) stands += 1e-3;
  while (!goes(seen(comes, 0.3, 1s), up)) comes += 1e-3;
  CHECK(comes > stands + 0.3 * (0.02 + dt));
  CHECK(comes < stands + 0.3 * (0.02 + 0.2));
  double old = 0.1;
  while (!goes(seen(old, 0.3, 1s - 50ms), up)) old += 1e-3;
  CHECK(old == doctest::Approx(comes + 0.3 * 0.05).epsilon(0.02));
  // Too old, from the future, too many, no numbers: it stands, and brakes from where it was.
  CHECK_FALSE(goes(seen(1.0, 0.3, 1s - 101ms), up));
  CHECK_FALSE(goes(seen(1.0, 0.3, 1s + 101ms), up));
  CHECK_FALSE(goes(seen(1.0, 0.3, 1s, 17), up));
  CHECK_FALSE(goes(seen(std::nan(""), 0.3, 1s), up));
  CHECK_FALSE(goes(seen(1.0, -0.1, 1s), up));
  CHECK_FALSE(goes(Seen{}, up));
  const auto braked = clear.within(Seen{}, q, room, up, up, dt, any);
  CHECK(braked.limited);
  CHECK(std::abs(braked.velocity[1] - (up[1] + 15 * dt)) < 1e-6);
}

TEST_CASE("ClearanceAround: at its margin, and a little within it, an arm slides along what stands there") {
  const auto limits = limits_of<ur5::Description>(15.0);
  const ClearanceLimits<Arm, double, 16> clear(Arm{}, limits, clearance());
  using Seen = ClearanceLimits<Arm, double, 16>::Memory;
  auto rng = seeded(5);
  double worst = 1e9, sum = 0, nearer = 0;
  int scenes = 0;
  while (scenes < (sanitized ? 10 : 60)) {
    JointPosition<6> q;
    for (auto& x : q) x = uniform(rng, -2.0, 2.0);
    // A ball beside the last link, from 1 mm within its margin to 0.2 mm outside.
    const auto X = link_poses(Arm{}, q).get<5>();
    const Xyz<double> axis = ur5::tubes[5].to - ur5::tubes[5].from;
    const Xyz<double> some{uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0), uniform(rng, -1.0, 1.0)},
        side = cross(axis, some);
    const double inside = uniform(rng, -0.2e-3, 1e-3);
    const Xyz<double> at = ur5::tubes[5].from + uniform(rng, 0.0, 1.0) * axis +
                           ((0.0201 + 0.05 + ur5::tubes[5].radius - inside) / norm(side)) * side;
    Seen seen{};
    Surroundings<16> near;
    near.time = 1s;
    const Xyz<double> p = X.origin() + X.axes() * at;
    near.add({{p, p, 0.05}, 0.0});
    clear.see(seen, near, q, 1s);
    const auto here = clear.at(seen, q);
    if (here.nearest() < 0.0201 - 1.001e-3) continue;  // another link is nearer
    JointVelocity<6> want;
    for (auto& v : want) v = uniform(rng, -1.0, 1.0);
    const auto along = here.slid(want, dt);
    double closing = 0, all = 0;
    for (std::size_t i = 0; i < 6; ++i)
      closing += (want[i] - along[i]) * (want[i] - along[i]), all += want[i] * want[i];
    if (closing < 0.02 * all || closing > 0.5 * all) continue;
    ++scenes;
    JointPosition<6> now = q;
    JointVelocity<6> u;
    for (int n = 0; n < 60; ++n) {
      JointVelocity<6> next;
      for (std::size_t i = 0; i < 6; ++i) next[i] = u[i] + std::clamp(want[i] - u[i], -15 * dt, 15 * dt);
      clear.see(seen, near, now, 1s);
      const auto kept =
          clear.within(seen, now, limits.room(now), u, next, dt, [](const auto&) { return true; });
      now = integrate(now, u + kept.velocity, 0.5 * dt), u = kept.velocity;
      nearer = std::max(nearer, std::min(0.0201, here.nearest()) - clear.at(seen, now).nearest());
    }
    double way = 0, square = 0;
    for (std::size_t i = 0; i < 6; ++i) way += along[i] * (now[i] - q[i]), square += along[i] * along[i];
    worst = std::min(worst, way / square), sum += way / square;
  }
  MESSAGE(scenes << " scenes of 0.48 s: of the way along it went what takes " << sum / scenes
                 << " s in the mean, at worst " << worst << " s; nearer by " << 1e6 * nearer << " um");
  CHECK(worst > 0.345);  // from one velocity to another at the rate of the weakest joint, not beyond it
  CHECK(nearer < 1e-7);
}

TEST_CASE("ClearanceAround: what cannot be is refused") {
  const auto limits = limits_of<ur5::Description>(15.0);
  const auto refuses = [&](auto change) {
    auto c = clearance();
    change(c);
    CHECK_THROWS_AS((ClearanceLimits<Arm, double, 16>(Arm{}, limits, c)), ConfigurationError);
  };
  refuses([](auto& c) { c.exposed = {6}; });
  refuses([](auto& c) { c.exposed.assign(13, 1); });
  refuses([](auto& c) {
    c.own.capsules.push_back({LinkCapsule::fixed, {}});
    c.exposed = {6};
  });
  refuses([](auto& c) { c.late = -1ns; });
  refuses([](auto& c) { c.max_age = 0ns; });
}

TEST_CASE("Cycle: an arm whose base is held beside its commands keeps its clearances where it really is") {
  using Law = SplineJoint<6>;
  const auto arm = by_position(Arm{}, {.limits = limits_of<ur5::Description>(15.0),
                                       .period = 8ms,
                                       .delay = 8ms,
                                       .lag = 2ms,
                                       .virtual_damping = 10});
  const auto scene = Cycle(arm, Law(arm)).with(clearance());
  using Scene = std::remove_cv_t<decltype(scene)>;
  const JointPosition<6> start{0.0, -1.5, 1.4, -0.2, 0.3, 0.0};
  auto beside = start, low = start, passes = start;
  beside[0] += 0.03, low[0] += 0.03;
  low[1] += 0.6, passes[1] += 0.3;
  // A ball that the arm would pass as it is told, and comes within 8 mm as it is held.
  const auto& tube = ur5::tubes[5];
  const auto tip = [&](const JointPosition<6>& q) {
    const auto X = link_poses(Arm{}, q).get<5>();
    return Xyz<double>(X.origin() + X.axes() * tube.to);
  };
  const Xyz<double> away = tip(beside) - tip(start);
  const Xyz<double> ball = tip(passes) + (-(0.008 + tube.radius + 0.05) / norm(away)) * away;
  const auto nearest = [&](const JointPosition<6>& q) {
    double least = 1e9;
    for (const auto& [p, r] : Points(0, q).at)
      least = std::min(least, norm(Xyz<double>(p - ball)) - r - 0.05);
    return least;
  };
  for (const bool held : {false, true}) {
    auto memory = std::make_unique<Scene::Memory>();
    State<6> at{.time = 0ns, .q = start, .dq = {}};
    scene.start(*memory, at);
    Scene::Input input;
    double least = 1e9, told = 1e9;
    JointCommand<6> last;
    last.position = start;
    for (int n = 1; n < 500; ++n) {
      at.time = n * 8ms, at.q = last.position, at.dq = last.velocity;
      if (held) at.q[0] = start[0], at.dq[0] = 0;
      input.now = at.time, input.measured = at;
      input.around.count = 0, input.around.time = at.time;
      input.around.add({{ball, ball, 0.05}, 0.0});
      input.goal.reset();
      if (n == 10) input.goal = {beside, 800ms};
      if (n == 150) input.goal = {low, 1500ms};
      const auto out = scene.step(*memory, input);
      if (out.planned.valid) last = out.planned;
      auto real = last.position;
      if (held) real[0] = start[0];
      told = std::min(told, nearest(last.position)), least = std::min(least, nearest(real));
    }
    MESSAGE((held ? "held" : "free") << ": nearest " << 1e3 * least << " mm, by its commands " << 1e3 * told
                                     << " mm; the shoulder came " << last.position[1] - start[1]
                                     << " rad of 0.6");
    CHECK(least >= 0.018);  // a tenth of the margin is left to what does not follow exactly
  }
}

TEST_CASE("Cycle: what is around comes with its input, is recorded, and holds an arm that hears nothing") {
  const auto arm =
      by_position(Arm{}, {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .virtual_damping = 4});
  const auto scene = Cycle(arm, GravityControl{}).with(clearance());
  using Scene = std::remove_cv_t<decltype(scene)>;
  static_assert(Scene::governed && !decltype(Cycle(arm, GravityControl{}))::governed);
  State<6> at{.time = 1s, .q = {0.0, -1.2, 1.4, -0.2, 0.3, 0.0}, .dq = {}};
  auto memory = std::make_unique<Scene::Memory>();
  scene.start(*memory, at);
  Scene::Input input;
  input.now = at.time = 1s + 8ms;
  input.measured = at;
  CHECK(scene.governor().memory<Clearance>(memory->governor).blind);
  static_cast<void>(scene.step(*memory, input));
  CHECK(scene.governor().memory<Clearance>(memory->governor).blind);
  input.now = input.measured.time = input.around.time = 1s + 16ms;
  input.around.add({{{2.0, 0.0, 0.0}, {2.0, 0.0, 1.0}, 0.1}, 0.3});
  static_cast<void>(scene.step(*memory, input));
  CHECK_FALSE(scene.governor().memory<Clearance>(memory->governor).blind);
  // Where it stands: each tube, and no more than it is.
  const auto filled = occupied(scene, *memory, base(1));
  REQUIRE(filled.count == 5);
  CHECK(filled.obstacles[1].shape.radius == doctest::Approx(ur5::tubes[2].radius));
  const auto elbow = base(1) * link_poses(Arm{}, at.q).get<2>();
  CHECK(norm(Xyz<double>(filled.obstacles[1].shape.from -
                         (elbow.origin() + elbow.axes() * ur5::tubes[2].from))) < 1e-9);

  using Bytes = CycleBytes<Scene>;
  detail::ByteWriter out(Bytes::max_size(input));
  Bytes::write(out, input, {});
  detail::ByteReader in(out.bytes());
  Scene::Input read;
  Bytes::Samples samples;
  Bytes::Command command;
  Bytes::read(in, read, samples, command);
  CHECK_FALSE(in.short_of_bytes());
  CHECK(in.left() == 0);
  CHECK(read.around.time == input.around.time);
  CHECK(read.around.count == 1);
  CHECK(read.around.obstacles[0].shape.radius == 0.1);
  CHECK(read.around.obstacles[0].approach == 0.3);
}
