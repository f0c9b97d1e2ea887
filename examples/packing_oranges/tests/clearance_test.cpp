// What an arm at work keeps clear of by itself, without a world around it.
//
// Promise: wherever an arm that packs is led, it meets neither table nor walls of the trays
// Tried: 30 ways of a hand at 0.6 m/s to below the table or to a wall: fingers, forearm and wrists of
// hulls overlap by less than 1 mm, nor an orange in the hand with walls; without its clearance all 30
// meet, also where it is told of the table or of the walls only
//
// Promise: a hand low among oranges gives way to a ball without pushing its neighbours off; open fingers
// come down beside what lies near an orange
// Tried: 60 ways of a ball over the feed: the fingers' middle stays 0.1 m from the neighbours in 59 at
// least (unaware of them in 54 at most), the ball meets no more arms; a neighbour 75 mm away turns the
// hand, one 150 mm away does not
//
// Promise: no place of a forearm leads faster than what is felt there allows: an arm with dead cells is slower there
// Tried: a dead cell among healthy ones: its place leads with 60 to 95 % of the others' speed, which its neighbours
// allow; with dead neighbours it does not lead; of 300 motions those that it leads are slowed, their reverse is not

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "examples/packing_oranges/finger_room.hpp"
#include "examples/packing_oranges/giving_way.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace packing;

namespace {
using A = Arm<Ur5>;
using Model = A::Model;
using Limits = ClearanceLimits<Model, double, near_most>;
constexpr double dt = 0.008;

/// Of a point in the world from the trays' walls, boxes of 8 mm on the table; and from both.
Trays standing_trays = first_trays;
double from_walls(const Xyz<double>& p) {
  double least = 1e9;
  constexpr double half = 0.004;
  const auto box = [&](double x, double y, double half_x, double half_y, double wall) {
    const double dx = std::max(0.0, std::abs(p.x - x) - half_x),
                 dy = std::max(0.0, std::abs(p.y - y) - half_y), dz = std::max(0.0, p.z - wall);
    least = std::min(least, std::hypot(dx, dy, dz));
  };
  for (const Tray& t : standing_trays)
    for (const double side : {-1.0, 1.0}) {
      box(t.x + side * (t.half_x + half), t.y, half, t.half_y + 2 * half, t.wall);
      box(t.x, t.y + side * (t.half_y + half), t.half_x + 2 * half, half, t.wall);
    }
  return least;
}
double from_table(const Xyz<double>& p) {
  return std::min(p.z, from_walls(p));
}
/// The same of the fingers, 110 mm apart, of the forearm and wrists, and of an orange in the hand from walls:
/// points along them, less their radii.
double from_table(const JointPosition<6>& q) {
  double least = 1e9;
  const auto along = [&](const Capsule<>& c) {
    for (int n = 0; n <= 20; ++n)
      least = std::min(least, from_table(Xyz<double>(c.from + n / 20.0 * (c.to - c.from))) - c.radius);
  };
  for (const Capsule<>& c : A::fingers(0, q, gripper_range.opening)) along(c);
  least = std::min(least, from_walls((A::base(0) * A::hand(q)).origin()) - 0.04);
  const auto parts = A::parts(0, q);
  for (std::size_t k = 2; k < parts.size(); ++k) along(parts[k]);
  return least;
}
/// A hand that is led to somewhere below the table at 0.6 m/s, turning as it likes: the least distance on its way.
double lead_down(const Limits& limits, const JointLimits<6>& joints, const Xyz<double>& to) {
  JointPosition<6> q = A::home();
  JointVelocity<6> u;
  typename Limits::Memory seen;
  double least = 1e9;
  for (int n = 0; n < 200; ++n) {
    const auto p = (A::base(0) * A::hand(q)).origin();
    const Xyz<double> way = to - p;
    const auto v_B = turn_back(A::base(0).axes(), Xyz<double>(0.6 / std::max(0.05, norm(way)) * way));
    Eigen::Matrix<double, 3, 6> J;
    jacobian<5>(link_poses(Model{}, q), A::tool()).for_each([&](auto j, const auto& c) {
      J.col(static_cast<Eigen::Index>(j.value)) << c.linear.x, c.linear.y, c.linear.z;
    });
    const Eigen::Matrix3d square = J * J.transpose() + 0.01 * Eigen::Matrix3d::Identity();
    const Eigen::Matrix<double, 6, 1> wish =
        J.transpose() * square.ldlt().solve(Eigen::Vector3d(v_B.x, v_B.y, v_B.z));
    JointVelocity<6> want;
    for (std::size_t i = 0; i < 6; ++i)
      want[i] = std::clamp(wish[static_cast<Eigen::Index>(i)], u[i] - 15 * dt, u[i] + 15 * dt);
    limits.see(seen, {}, q, 0ns);
    const auto next =
        limits.within(seen, q, joints.room(q), u, want, dt, [](const auto&) { return true; }).velocity;
    q = integrate(q, u + next, 0.5 * dt);
    u = next;
    least = std::min(least, from_table(q));
  }
  return least;
}
}  // namespace

TEST_CASE(
    "packing_oranges: wherever it is led, an arm at work meets neither table nor walls; without its "
    "clearance it does") {
  const auto joints = A::robot().limits();
  const Limits at_work(Model{}, joints, A::clearance_at_work()), without(Model{}, joints, A::clearance());
  auto rng = testing::seeded(3);
  double least = 1e9;
  int met = 0, walls = 0;
  constexpr int ways = 30;
  for (int n = 0; n < ways; ++n) {
    // Every second one to the walls of a tray.
    const Tray& t = n % 4 == 1 ? box_tray : bin_tray(0);
    const double a = testing::uniform(rng, -M_PI, M_PI), r = testing::uniform(rng, 0.35, 0.7);
    const Xyz<double> to =
        n % 2 == 0 ? Xyz<double>{-Ur5::stands + r * std::cos(a), r * std::sin(a), -0.3}
                   : Xyz<double>{t.x + t.half_x, t.y + testing::uniform(rng, -1.0, 1.0) * t.half_y, 0};
    const double d = lead_down(at_work, joints, to);
    CAPTURE(n);
    CAPTURE(to.x);
    CAPTURE(to.y);
    CHECK(d > -0.001);  // a fingertip's round end, where the hand is tilted over the table
    least = std::min(least, d);
    const bool meets = lead_down(without, joints, to) < 0;
    met += meets, walls += meets && n % 2 == 1;
  }
  MESSAGE("nearest " << least << " m; without " << met << " of " << ways << " ways meet something, " << walls
                     << " at walls");
  CHECK(met > ways / 2);
  CHECK(walls > ways / 4);
}

TEST_CASE(
    "packing_oranges: an arm keeps clear of the walls of a box that was moved; of where they were it does "
    "not") {
  const auto joints = A::robot().limits();
  standing_trays[0].x = -0.08, standing_trays[0].y = 0.06;
  const Limits knows(Model{}, joints, A::clearance_at_work(0, standing_trays)),
      believes(Model{}, joints, A::clearance_at_work());
  auto rng = testing::seeded(9);
  int met = 0;
  constexpr int ways = 20;
  for (int n = 0; n < ways; ++n) {
    const Tray& t = standing_trays[0];
    const Xyz<double> to{t.x + t.half_x, t.y + testing::uniform(rng, -1.0, 1.0) * t.half_y, 0};
    CAPTURE(n);
    CHECK(lead_down(knows, joints, to) > -0.001);
    met += lead_down(believes, joints, to) < -0.001;
  }
  standing_trays = first_trays;
  CHECK(met > ways / 4);
}

TEST_CASE(
    "packing_oranges: however its joints are driven, no link of an empty-handed arm meets table or walls") {
  const auto joints = A::robot().limits();
  const Limits limits(Model{}, joints, A::clearance_empty_handed());
  auto rng = testing::seeded(5);
  const auto nearest = [](const JointPosition<6>& q) {
    const auto parts = A::parts(0, q);
    std::array<double, 7> out;
    for (std::size_t k = 1; k < parts.size(); ++k) {
      out[k] = 1e9;
      for (int n = 0; n <= 20; ++n) {
        const Capsule<>& c = parts[k];
        out[k] = std::min(out[k], from_table(Xyz<double>(c.from + n / 20.0 * (c.to - c.from))) - c.radius);
      }
    }
    return out;
  };
  std::array<double, 7> least;
  least.fill(1e9);
  for (int scene = 0; scene < 40; ++scene) {
    JointPosition<6> q = A::home();
    JointVelocity<6> u, drive, wander;
    typename Limits::Memory seen;
    const std::size_t hunts =
        1 + static_cast<std::size_t>(scene) % 5;  // the link that goes for what is nearest
    for (int n = 0; n < 250; ++n) {
      if (n % 50 == 0)
        for (auto& v : wander) v = testing::uniform(rng, -0.5, 0.5);
      if (n % 5 == 0) {
        const double d = nearest(q)[hunts];
        double most = 1e-9;
        for (std::size_t i = 0; i < 6; ++i) {
          auto moved = q;
          moved[i] += 1e-4;
          drive[i] = d - nearest(moved)[hunts];
          most = std::max(most, std::abs(drive[i]));
        }
        for (std::size_t i = 0; i < 6; ++i) drive[i] = drive[i] / most + wander[i];
      }
      JointVelocity<6> want;
      for (std::size_t i = 0; i < 6; ++i) want[i] = std::clamp(drive[i], u[i] - 15 * dt, u[i] + 15 * dt);
      limits.see(seen, {}, q, 0ns);
      const auto next =
          limits.within(seen, q, joints.room(q), u, want, dt, [](const auto&) { return true; }).velocity;
      q = integrate(q, u + next, 0.5 * dt), u = next;
      const auto now = nearest(q);
      for (std::size_t k = 1; k < now.size(); ++k) least[k] = std::min(least[k], now[k]);
    }
  }
  for (std::size_t k = 1; k < least.size(); ++k) {
    CAPTURE(k);
    MESSAGE("link " << k << ": " << 1e3 * least[k] << " mm");
    CHECK(least[k] > 0);
  }
}

namespace {
/// The joints at which a hand points down there, from home on.
JointPosition<6> standing(const Xyz<double>& p_W) {
  JointPosition<6> q = A::home();
  const auto X_BW = A::base(0).inverse();
  const auto facing = A::hand(q).axes();
  const Xyz<double> goal = X_BW.origin() + X_BW.axes() * p_W;
  for (int n = 0; n < 200; ++n) {
    const auto X = A::hand(q);
    const Xyz<double> off = goal - X.origin(), turn = X.axes() * log_so3(X.axes().transpose() * facing);
    Eigen::Matrix<double, 6, 6> J;
    jacobian<5>(link_poses(Model{}, q), A::tool()).for_each([&](auto j, const auto& c) {
      J.col(static_cast<Eigen::Index>(j.value)) << c.linear.x, c.linear.y, c.linear.z, c.angular.x,
          c.angular.y, c.angular.z;
    });
    Eigen::Matrix<double, 6, 1> e;
    e << off.x, off.y, off.z, turn.x, turn.y, turn.z;
    const Eigen::Matrix<double, 6, 6> square =
        J * J.transpose() + 1e-4 * Eigen::Matrix<double, 6, 6>::Identity();
    const Eigen::Matrix<double, 6, 1> dq = 0.5 * (J.transpose() * square.ldlt().solve(e));
    for (std::size_t i = 0; i < 6; ++i) q[i] += dq[static_cast<Eigen::Index>(i)];
  }
  return q;
}
struct Passed {
  double oranges = 1e9;  ///< least distance of the fingers' middle from an orange's, while it is as low
  double ball = 1e9;     ///< of the ball from the arm
};
/// A hand low at a place of the feed gives way to a ball that comes from somewhere above, until that has passed.
Passed passes(std::size_t at, const Xyz<double>& from, const Xyz<double>& v, bool knows) {
  const GivingWay<Ur5> plan(0, 0.2);
  auto place = feed_place(0, at);
  place.z = 0.038;
  std::vector<Xyz<double>> lying;
  for (std::size_t k = 0; k < feed_places; ++k)
    if (k != at) lying.push_back(feed_place(0, k) + Xyz<double>{0, 0, 0.038});
  JointPosition<6> q = standing(place);
  JointVelocity<6> u;
  Passed out;
  const auto X_BW = A::base(0).inverse();
  for (int n = 0; n < 300; ++n) {
    const Xyz<double> p = from + n * dt * v;
    const Capsule<> ball{p, p, 0.045};
    double near = 1e9;
    for (const Capsule<>& c : A::shapes_at(A::link_places(0, q)))
      near = std::min(near, distance(c, ball).distance);
    out.ball = std::min(out.ball, near);
    const auto hand = (A::base(0) * A::hand(q)).origin();
    if (hand.z < 0.1)
      for (const auto& o : lying) out.oranges = std::min(out.oranges, std::hypot(hand.x - o.x, hand.y - o.y));
    Surroundings<near_most> seen;
    if (near < sight_range) seen.add(X_BW * Obstacle<skinctl::World>{ball, 0.3});
    const auto want =
        near < sight_range
            ? plan(q, seen, knows ? std::span<const Xyz<double>>(lying) : std::span<const Xyz<double>>())
            : JointVelocity<6>{};
    JointVelocity<6> next;
    for (std::size_t i = 0; i < 6; ++i) next[i] = std::clamp(want[i], u[i] - 15 * dt, u[i] + 15 * dt);
    q = integrate(q, u + next, 0.5 * dt);
    u = next;
  }
  return out;
}
}  // namespace

TEST_CASE("packing_oranges: a hand low among oranges gives way without pushing them off; unaware it does") {
  auto rng = testing::seeded(5);
  int pushed = 0, unaware = 0, met = 0, met_unaware = 0, tried = 0;
  while (tried < 60) {
    const double a = testing::uniform(rng, -M_PI, M_PI);
    const Xyz<double> v{0.3 * std::cos(a), 0.3 * std::sin(a), testing::uniform(rng, -0.04, 0.04)};
    const Xyz<double> over{testing::uniform(rng, -0.5, -0.1), testing::uniform(rng, -0.4, 0.0),
                           testing::uniform(rng, 0.35, 0.55)};
    const auto at = static_cast<std::size_t>(tried) % feed_places;
    const Xyz<double> from = over - 1.5 * v;
    const auto knows = passes(at, from, v, true), unknown = passes(at, from, v, false);
    ++tried;
    pushed += knows.oranges < 0.1, unaware += unknown.oranges < 0.1;
    met += knows.ball < 0, met_unaware += unknown.ball < 0;
  }
  MESSAGE("pushed off in " << pushed << " of " << tried << ", unaware in " << unaware << "; met by the ball "
                           << met << ", unaware " << met_unaware);
  CHECK(pushed <= tried / 30);
  CHECK(unaware >= tried / 10);
  CHECK(met <= met_unaware);
}

TEST_CASE(
    "packing_oranges: a place whose cell is dead leads slower, as its neighbours notice; a blind one does "
    "not") {
  const auto skin = A::skin();
  using Cells = std::remove_const_t<decltype(skin)>;
  struct Seen {
    const Cells& skin;
    const typename Cells::Memory& memory;
    [[nodiscard]] double noticed(std::size_t i) const noexcept { return skin.noticed(memory, i); }
    [[nodiscard]] static bool touched() noexcept { return false; }
  };
  struct Going {
    JointPosition<6> q;
  };
  using Limit = PlaceSpeed<Model, forearm_cells>;
  const Limit limit(Model{}, A::felt_places());
  const auto judged = [&](const std::vector<std::size_t>& dead) {
    auto memory = skin.start(0ns);
    std::vector<CellSample> samples;
    for (std::size_t i = 0; i < forearm_cells; ++i)
      if (std::find(dead.begin(), dead.end(), i) == dead.end())
        samples.push_back({.time = 8ms, .cell = static_cast<std::uint32_t>(i + 1)});
    typename Cells::Wrenches mean;
    static_cast<void>(skin.receive(memory, samples, 0ns, 8ms, 1, &mean));
    Limit::Memory m;
    for (std::size_t n = 0; n < Limit::turns; ++n) limit.look(m, Seen{skin, memory}, dt);
    return m;
  };
  constexpr std::size_t cell = forearm_cells - 1;
  const auto near = skin.graph().neighbours(cell);
  REQUIRE(near.size() >= 3);
  std::vector<std::size_t> patch(near.begin(), near.end());
  patch.push_back(cell);
  const auto healthy = judged({}), one = judged({cell}), blind = judged(patch);
  const double usual = healthy.speed[0];
  MESSAGE("a place leads with " << usual << " m/s at most, with a dead cell " << one.speed[cell]);
  CHECK(usual > 0.2);
  for (std::size_t i = 0; i < forearm_cells; ++i) {
    CHECK(healthy.speed[i] == doctest::Approx(usual));
    if (i != cell) CHECK(one.speed[i] == doctest::Approx(usual));
  }
  CHECK(one.speed[cell] > 0.6 * usual);
  CHECK(one.speed[cell] < 0.95 * usual);
  CHECK(blind.speed[cell] == 0);
  auto rng = testing::seeded(5);
  int slower = 0, stopped = 0;
  const Going going{A::home()};
  for (int n = 0; n < 300; ++n) {
    JointVelocity<6> u;
    for (std::size_t i = 0; i < 6; ++i) u[i] = testing::uniform(rng, -2.0, 2.0);
    const double s = limit.share(healthy, going, 0, u).scale, s1 = limit.share(one, going, 0, u).scale,
                 s0 = limit.share(blind, going, 0, u).scale;
    CHECK(s1 <= s);
    CHECK(s0 <= s1);
    const bool leads = s1 < s;
    slower += leads, stopped += s0 < 0.01;
    const double back = limit.share(one, going, 0, -1.0 * u).scale;
    if (leads) CHECK(back == limit.share(healthy, going, 0, -1.0 * u).scale);
  }
  CHECK(slower > 3);
  CHECK(stopped > 100);
}

TEST_CASE("finger_room: open fingers come down beside what lies near an orange, turned if need be") {
  const Rotation<double> down{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  const Xyz<double> p{0.1, 0.4, 0.04}, beside{0.1, 0.475, 0.04}, far{0.1, 0.55, 0.04},
      across{0.175, 0.4, 0.04};
  const auto among = [&](std::vector<Xyz<double>> others, bool turns = true) {
    return finger_room(p, down, others, turns);
  };
  CHECK(among({}).turn == 0);
  CHECK(among({far, across}).turn == 0);
  CHECK(among({far, across}).room > FingerRoom::enough);
  CHECK(among({beside}).turn != 0);
  CHECK(among({beside}).room > FingerRoom::enough);
  CHECK(among({beside}, false).turn == 0);
  CHECK(among({beside}, false).room < 0.03);
  // Three fingers have none where two of a gripper stand beside: it lies in the way of the third.
  const std::array<Xyz<double>, 3> three{{{0.5, 0.87, 0}, {0.5, -0.87, 0}, {-1, 0, 0}}};
  const std::vector<Xyz<double>> behind{{0.025, 0.4, 0.04}};
  CHECK(finger_room(p, down, behind).room > FingerRoom::enough);
  CHECK(finger_room(p, down, behind, false, three).room < 0.03);
  CHECK(finger_room(p, down, std::vector{across}, false, three).room > FingerRoom::enough);
  // Shut in: where there is most.
  CHECK(among({beside, across}).room > 0.03);
  CHECK(among({beside, across}).room < FingerRoom::enough);
}
