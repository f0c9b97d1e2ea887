// Promise: a robot with two arms drives between two tables: it looks again at each, and packs what lies on
// one into a box on the other
// Tried: 12 oranges by two UR5 and two UR10e, wheels that slip by 1 % and 8 mrad a metre, pushes on both arms
// every 6 s: all right, no wall touched; with hands too. 200 drives by themselves, with a share of slip of
// their own: where it stands it is within 4 deviations of where it takes itself to be, wheels alone are off
// by ten times as much
//
// Promise: a base that drives halts while somebody touches the robot, and goes on from where it stands
// Tried: touches of 0.5 s at every phase of a drive, also one after the other: it stands within v^2 / 2a and
// the delays, never drives back, and ends at the other table

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "examples/packing_oranges/carriage.hpp"
#include "examples/packing_oranges/process.hpp"
#include "examples/packing_oranges/run.hpp"

using namespace packing;
using namespace std::chrono_literals;

namespace {

/// A base that goes where its wheels go but for a share of each way, and marks that its camera sees.
class Plant {
 public:
  Plant(double slip, double slip_turn, std::uint64_t seed) : slip_(slip), turn_(slip_turn), random_(seed) {
    told_.time = 0ns;
  }
  void slips_anew() {
    x_ = slip_ * normal_(random_), y_ = slip_ * normal_(random_), yaw_ = turn_ * normal_(random_);
  }
  /// A period with a lag of 33 ms, in milliseconds.
  void advance(const skinctl::JointVelocity<3>& v) {
    for (int ms = 0; ms < 8; ++ms) {
      told_.time += 1ms;
      for (std::size_t i = 0; i < 3; ++i) told_.dq[i] += (v[i] - told_.dq[i]) / 33;
      const double by = at.yaw - told_.q[2], c = std::cos(by), s = std::sin(by);
      const double speed = std::hypot(told_.dq[0], told_.dq[1]);
      at.x += 1e-3 * (c * told_.dq[0] - s * told_.dq[1] + x_ * speed);
      at.y += 1e-3 * (s * told_.dq[0] + c * told_.dq[1] + y_ * speed);
      at.yaw += 1e-3 * (told_.dq[2] + yaw_ * speed);
      for (std::size_t i = 0; i < 3; ++i) told_.q[i] += 1e-3 * told_.dq[i];
    }
  }
  [[nodiscard]] const skinctl::State<3>& wheels() const { return told_; }
  /// Marks within 1.05 m, as the robot, which takes itself to stand there, has them in the World.
  [[nodiscard]] std::vector<skinctl::ClassDetection<>> picture(const skinctl::BaseState<>& base) {
    std::vector<skinctl::ClassDetection<>> out;
    const auto X = at.pose().inverse();
    for (const auto& mark : table_marks) {
      if (std::hypot(mark.x - at.x, mark.y - at.y) > 1.05) continue;
      const auto noisy = [&](double x) { return x + 0.005 * normal_(random_); };
      const auto p = X.origin() + X.axes() * mark;
      out.push_back(
          in_world(base, skinctl::DetectionFromBase<>{{noisy(p.x), noisy(p.y), 0}, 0.005, mark_class}));
    }
    return out;
  }
  [[nodiscard]] double speed() const { return std::hypot(told_.dq[0], told_.dq[1]); }
  Standing at;

 private:
  double slip_, turn_, x_ = 0, y_ = 0, yaw_ = 0;
  skinctl::State<3> told_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

/// Drives to a table; `touched(t)`: whether somebody touches the robot then [s]. Whether it gets there.
bool drive(Carriage& base, Plant& plant, std::size_t table, const auto& touched, const auto& each) {
  base.go(table);
  plant.slips_anew();
  const auto begun = plant.wheels().time;
  for (int k = 0; k < 60 * 125 && base.table() != table; ++k) {
    const auto now = plant.wheels().time;
    if (k % 4 == 0) {
      const auto state = base.state();
      base.see(state, plant.picture(state));
    }
    plant.advance(base.step(now, plant.wheels(), touched(skinctl::seconds<double>(now - begun))));
    each(skinctl::seconds<double>(now - begun));
  }
  return base.table() == table;
}

RunSettings between_tables(std::uint64_t seed) {
  RunSettings s;
  s.supply.oranges = 12;
  s.seed = seed;
  s.touch_every = 6;
  s.work.plan = process_between_tables;
  return s;
}
}  // namespace

TEST_CASE("packing_oranges --two-tables: what lies on one table is packed into a box on the other one") {
  for (const auto& run : {run_ur5, run_ur10e})
    for (const bool hands : {false, true}) {
      RunSettings s = between_tables(hands ? 21 : 20);
      s.hand = {hands, hands};
      const Outcome o = run(s, {}, {});
      CAPTURE(o.robot);
      CHECK(o.over);
      CHECK(o.right() == 12);
      CHECK(o.lost() == 0);
      CHECK(o.drives >= 4);
      CHECK(o.halts >= 1);
      CHECK(std::hypot(o.wheels_off.x, o.wheels_off.y) > 0.005);
      CHECK(o.stood_off < 0.008);
      CHECK(o.worst_force() < 12);
      for (const ArmOutcome& arm : o.arm) {
        CHECK(arm.longest_at_wall < 500);
        CHECK(arm.other_arm == 0);
      }
    }
}

TEST_CASE("packing_oranges --two-tables: where it stands is known by marks, and how well") {
  Plant plant(0.012, 0.008, 5);
  Carriage base(plant.wheels());
  double worst = 0, wheels = 0;
  for (int n = 0; n < 200; ++n) {
    const std::size_t table = 1 - static_cast<std::size_t>(n) % 2;
    REQUIRE(drive(base, plant, table, [](double) { return false; }, [](double) {}));
    const auto p = base.state().X_WB.origin();
    const double off = std::hypot(p.x - plant.at.x, p.y - plant.at.y);
    worst = std::max(worst, off / (std::sqrt(2.0) * base.state().sigma));
    wheels += std::hypot(plant.at.x - plant.wheels().q[0], plant.at.y - plant.wheels().q[1]) / 200;
    CHECK(std::abs(plant.at.y - (table == 1 ? second_table : 0.0)) < 0.05);
  }
  MESSAGE("worst ", worst, " deviations; wheels off by ", wheels, " m in the mean");
  CHECK(worst < 4);
  CHECK(wheels > 0.05);
  CHECK(base.corrections() > 20);
}

TEST_CASE("packing_oranges --two-tables: a base halts while somebody touches the robot, and goes on") {
  for (double when = 0.1; when < 4; when += 0.3) {
    CAPTURE(when);
    Plant plant(0, 0, 1);
    Carriage base(plant.wheels());
    double y_at = -1, furthest = 0, back = 0, speed_at = 0, stood = 0;
    const auto touched = [&](double t) {
      return (t > when && t < when + 0.5) || (t > when + 1.6 && t < when + 2.1);
    };
    const bool there = drive(base, plant, 1, touched, [&](double t) {
      const double y = plant.at.y;
      furthest = std::max(furthest, y), back = std::max(back, furthest - y);
      if (t > when && y_at < 0) y_at = y, speed_at = plant.speed();
      if (t > when && t < when + 0.75 + 0.3) stood = y;
    });
    CHECK(there);
    CHECK(stood - y_at < speed_at * speed_at / 2 + 0.07 * speed_at + 0.01);
    CHECK(back < 0.004);
    CHECK(furthest < second_table + 0.01);
  }
}

TEST_CASE("packing_oranges --two-tables: a process that forgets to drive is refused") {
  const auto fault = [](Process process) {
    Plan whole;
    return join(process, whole).fault;
  };
  CHECK_FALSE(fault(sort_drive_pack_drive).any());
  Process stays = sort_drive_pack_drive;
  stays.tasks[0] = sort_oranges;
  CHECK(fault(stays).error == skinctl::TaskError::a_step_lacks_a_fact_that_it_needs);
  CHECK(fault(stays).facts == at_box);
}
