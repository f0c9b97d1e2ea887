// Every number of a part's settings: NaN, an infinity or one beyond any range is refused, with the number;
// the least allowed ones build.
//
// Promise: a number of a part's settings that is NaN, infinite or beyond any range is refused, with the
// number; the least allowed ones build
// Tried: 38 classes, each of their numbers and durations alone

#include <doctest/doctest.h>

#include "skinctl/fusion/contact_gate.hpp"
#include "skinctl/fusion/opposition.hpp"
#include "skinctl/guard/budget.hpp"
#include "skinctl/guard/packet_watch.hpp"
#include "skinctl/limits/body_region.hpp"
#include "skinctl/passivity/energy_tank.hpp"
#include "skinctl/passivity/passivity_observer.hpp"
#include "skinctl/sensing/cell_health.hpp"
#include "skinctl/sensing/clock_offset.hpp"
#include "skinctl/sensing/event_gate.hpp"
#include "skinctl/sensing/joint_history.hpp"
#include "skinctl/sensing/life_settings.hpp"
#include "skinctl/sensing/low_pass.hpp"
#include "skinctl/sensing/noise.hpp"
#include "skinctl/sensing/rest_level.hpp"
#include "skinctl/sensing/send_on_delta.hpp"
#include "skinctl/sensing/velocity_estimator.hpp"
#include "skinctl/skills/one_gripper.hpp"
#include "skinctl/tactile/slip.hpp"
#include "skinctl/tactile/squeeze.hpp"
#include "skinctl/trajectory/gain_schedule.hpp"
#include "skinctl/trajectory/pursuit.hpp"
#include "skinctl/trajectory/time_base.hpp"
#include "tests/extremes/rows.hpp"
#include "tests/support/by_day.hpp"

using namespace skinctl;
using namespace skinctl::extremes;

namespace {

/// Refusals of a class that takes its `Settings`.
template <class Part, class... Field>
void check_part(const char* name, Field... field) {
  using Settings = typename Part::Settings;
  check_refusals(name, Settings{}, [](const Settings& s) { static_cast<void>(Part(s)); }, field...);
}
template <class T>
struct Pair {
  T a, b;
};

}  // namespace

TEST_CASE_TEMPLATE("extremes: settings of filters, tanks and time bases", T, SKINCTL_EXTREME_SCALARS) {
  using Tank = typename EnergyTank<T>::Settings;
  check_part<EnergyTank<T>>("EnergyTank", &Tank::start, &Tank::max, &Tank::port_gain);
  using Port = typename PassivityObserver<T>::Settings;
  check_part<PassivityObserver<T>>("PassivityObserver", &Port::start, &Port::max, &Port::stiffness,
                                   &Port::reserve, &Port::newtons);
  using Grip = typename Squeeze<T>::Settings;
  check_part<Squeeze<T>>("Squeeze", &Grip::from, &Grip::to, &Grip::finger_stiffness, &Grip::swing,
                         &Grip::min_span);
  using Slide = typename Slip<T>::Settings;
  check_part<Slip<T>>("Slip", &Slide::friction, &Slide::max_friction, &Slide::probe, &Slide::reserve,
                      &Slide::noise, &Slide::drop, &Slide::max_drop, &Slide::filter, &Slide::fall,
                      &Slide::min_normal);
  using Estimator = VelocityEstimator<6, 8, 2, T>;
  check_part<Estimator>("VelocityEstimator", &Estimator::Settings::period, &Estimator::Settings::max_gap,
                        &Estimator::Settings::step);
  check_refusals(
      "TimeBase", Pair<T>{T(0.05), T(0.01)},
      [](const Pair<T>& s) {
        const TimeBase<T> base(s.a, s.b);
        for (const T r : {T(-1), T(0), T(0.5), T(0.999999), T(1), T(2)}) {
          CHECK(std::isfinite(base.gain(r).K));
          CHECK(std::isfinite(base.gain(r).dK));
          CHECK(base.remaining(r) >= T(0));
        }
        CHECK(std::isfinite(base.peak_gain()));
      },
      &Pair<T>::a, &Pair<T>::b);
  check_refusals(
      "GainSchedule", Pair<T>{T(10), T(0.5)},
      [](const Pair<T>& s) {
        const GainSchedule<T> schedule(s.a, TimeBase<T>(), s.b);
        for (const T t : {T(-1), T(0), T(0.5), T(1), T(1.0000001), T(1e30)}) {
          CHECK(std::isfinite(schedule.at(t, T(1)).K));
          CHECK(std::isfinite(schedule.at(t, T(1)).dK));
          CHECK(std::isfinite(schedule.rising(t, T(0.1)).K));
        }
      },
      &Pair<T>::a, &Pair<T>::b);
  using Limits = PursuitLimits<T>;
  check_refusals(
      "PursuitLimits", Limits{T(1), T(1), T(10)}, [](const Limits& l) { check(l); }, &Limits::velocity,
      &Limits::acceleration, &Limits::jerk);
  for (const T wrong : {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity(), T(-1)}) {
    CHECK(refused([&] { static_cast<void>(EventGate<T>(wrong, T(1), T(1))); }));
    CHECK(refused([&] { static_cast<void>(EventGate<T>(T(2), wrong, T(1))); }));
    CHECK(refused([&] { static_cast<void>(EventGate<T>(T(2), T(1), wrong)); }));
  }
}

TEST_CASE("extremes: settings of cells, clocks and packets") {
  check_refusals(
      "ContactDetector", ContactSettings{},
      [](const ContactSettings& s) { static_cast<void>(ContactDetector(s)); }, &ContactSettings::on,
      &ContactSettings::off, &ContactSettings::release_after);
  check_refusals(
      "OppositionDetector", OppositionSettings{},
      [](const OppositionSettings& s) { static_cast<void>(OppositionDetector(s)); }, &OppositionSettings::on,
      &OppositionSettings::off, &OppositionSettings::release_after);
  using Health = CellHealthSettings;
  check_refusals(
      "CellHealth", Health{}, [](const Health& s) { static_cast<void>(CellHealth<4>(s)); }, &Health::step,
      &Health::delta, &Health::top, &Health::saturated_for, &Health::fade_in, &Health::fade_out,
      &Health::hold, &Health::hold_blinking, &Health::witnessed_within);
  check_refusals(
      "LifeSettings", LifeSettings{}, [](const LifeSettings& s) { s.check(); }, &LifeSettings::way,
      &LifeSettings::force, &LifeSettings::mass, &LifeSettings::rim_force, &LifeSettings::held,
      &LifeSettings::calm);
  check_refusals(
      "SensorNoise", SensorNoise{},
      [](const SensorNoise& n) { static_cast<void>(CellHealth<4>({}, std::span(&n, 1))); },
      &SensorNoise::force, &SensorNoise::proximity, &SensorNoise::rest);
  using Rest = RestSettings;
  check_refusals(
      "RestLevel", Rest{}, [](const Rest& s) { static_cast<void>(RestLevel(s)); }, &Rest::smooth,
      &Rest::follow, &Rest::fall, &Rest::low_for, &Rest::quiet_for, &Rest::fast_within, &Rest::release,
      &Rest::weigh, &Rest::ramp, &Rest::max_gap);
  check_refusals(
      "NoiseSettings", NoiseSettings{}, [](const NoiseSettings& s) { s.check(); }, &NoiseSettings::step,
      &NoiseSettings::near);
  using Clock = ClockOffset::Settings;
  check_part<ClockOffset>("ClockOffset", &Clock::gather, &Clock::ahead, &Clock::overtaken, &Clock::late);
  struct Times {
    Nanoseconds a = 8ms, b = 6ms;
  };
  check_refusals(
      "LowPass", Times{}, [](const Times& t) { static_cast<void>(LowPass<double>(t.a, t.b)); }, &Times::a,
      &Times::b);
  check_refusals(
      "JointHistory", Times{}, [](const Times& t) { static_cast<void>(JointHistory<6>(t.a)); }, &Times::a);
  using Deltas = SendOnDelta::Deltas;
  check_refusals(
      "SendOnDelta", Deltas{}, [](const Deltas& d) { static_cast<void>(SendOnDelta(d)); }, &Deltas::force,
      &Deltas::proximity, &Deltas::acceleration, &Deltas::temperature, &Deltas::fine);
  check_refusals(
      "TimeBudget", BudgetSettings{.cycle = 8ms},
      [](const BudgetSettings& s) { static_cast<void>(TimeBudget(s)); }, &BudgetSettings::cycle);
  CHECK(refused([] { static_cast<void>(PacketWatch(64)); }));
  const GripperRange range{0.08, 5, 50, 0.01, 0.1};
  check_refusals(
      "OneGripper", range, [](const GripperRange& r) { static_cast<void>(OneGripper(r)); },
      &GripperRange::opening, &GripperRange::min_force, &GripperRange::max_force, &GripperRange::min_speed,
      &GripperRange::max_speed);
  const BodyRegion region{.force = 140, .blow = 280, .first = 500ms, .stiffness = 25000, .mass = 40};
  check_refusals(
      "BodyRegion", region, [](const BodyRegion& r) { r.check(); }, &BodyRegion::force, &BodyRegion::first,
      &BodyRegion::stiffness);
  const Separation apart{.body_speed = 1.6, .reaction_time = 100ms, .deceleration = 2, .margin = 0.1};
  check_refusals(
      "Separation", apart, [](const Separation& s) { s.check(); }, &Separation::body_speed,
      &Separation::reaction_time, &Separation::deceleration, &Separation::margin);
}
