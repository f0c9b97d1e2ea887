// References, sliding surfaces, sensors and contacts at the ends of what a number holds: a row each, see
// rows.hpp.
#include <doctest/doctest.h>

#include <vector>

#include "skinctl/skinctl.hpp"
#include "tests/extremes/rows.hpp"

using namespace skinctl;
using namespace skinctl::extremes;

namespace {

struct Tip : FrameTag {};

template <class T>
using P6 = JointPosition<6, T>;
template <class T>
using V6 = JointVelocity<6, T>;
template <class T>
using A6 = JointAcceleration<6, T>;
template <class T>
Rotation<T> turned(T s) {
  return exp_so3(Xyz<T>{T(0.3) * s, T(-1.2) * s, T(0.5) * s});
}
template <class T>
Results<T> of(const JointReference<6, T>& r) {
  return Results<T>(r.q_d, r.dq_d, r.ddq_d);
}
/// The errors of an orientation beside a target that turns at `x`.
template <class Error, class T>
Results<T> errors_of(T x) {
  const auto map = Error::map(turned(T(1)), Xyz<T>{x, T(0), T(0)}, Xyz<T>{});
  const auto e = Error::errors(turned(T(1)), Xyz<T>{x, T(0), T(0)},
                               RotationReference<T>{turned(T(0.5)), {x, T(0), T(0)}, {}}, Xyz<T>{});
  return Results<T>(e.e, e.de, map.omega(Xyz<T>{T(1), T(0), T(0)}));
}

}  // namespace

TEST_CASE_TEMPLATE("extremes: references and surfaces", T, SKINCTL_EXTREME_SCALARS) {
  using enum Wrong;
  static const Row<T> rows[] = {
      {"JointSpline::at of its time", 0, safe, safe,
       [](T x) {
         return of<T>(JointSpline<6, T>{P6<T>::constant(T(1)), P6<T>::constant(T(2)), T(3)}.at(x));
       }},
      {"JointSpline::at of its goal", 1, shows, shows,
       [](T x) { return of<T>(JointSpline<6, T>{P6<T>{}, P6<T>::constant(x), T(3)}.at(T(1))); }},
      {"JointSpline::from a motion", 1, safe, safe,
       [](T x) {
         const JointReference<6, T> now{P6<T>{}, V6<T>::constant(x), A6<T>::constant(x)};
         return of<T>(JointSpline<6, T>{P6<T>{}, P6<T>::constant(T(1)), T(3)}.from(now).at(T(1)));
       }},
      {"PoseSpline::at", 0, safe, safe,
       [](T x) {
         const PoseSpline<Tip, T> spline({}, {turned(T(1)), {T(1), T(0), T(0)}}, T(3));
         const auto r = spline.at(x);
         return Results<T>(r.X_BP.origin(), r.V, r.A);
       }},
      {"PoseSpline::from a motion", 2, safe, safe,
       [](T x) {
         PoseReference<Tip, T> now;
         now.V.linear = {x, T(0), T(0)};
         const auto r = PoseSpline<Tip, T>({}, {turned(T(1)), {T(1), T(0), T(0)}}, T(3)).from(now).at(T(1));
         return Results<T>(r.X_BP.origin(), r.V, r.A);
       }},
      {"RotationSpline", 0, safe, safe,
       [](T x) {
         const auto r = RotationSpline<T>({}, turned(T(1)), T(3)).from({T(0.1), T(0), T(0)}, {}).at(x);
         return Results<T>(r.R, r.omega, r.domega);
       }},
      {"PlanClock::at", 1, shows, shows,
       [](T x) { return Results<T>(PlanClock<T>{}.changed(false, 100ms).at(std::abs(x), 100ms).t); }},
      {"Pursuit::braking_distance", 2, shows, shows,
       [](T x) { return Results<T>(Pursuit<3, T>::braking_distance({T(1), T(1), T(10)}, x)); }},
      {"limit_speed: the speed", 1, shows, shows,
       [](T x) {
         V6<T> v = V6<T>::constant(x);
         A6<T> a = A6<T>::constant(T(1));
         limit_speed(V6<T>::constant(T(2)), v, a);
         if (std::isfinite(x))
           for (const T each : v) CHECK(std::abs(each) <= T(2.001));
         return Results<T>(v, a);
       }},
      {"limit_speed: the acceleration", 1, shows, shows,
       [](T x) {
         V6<T> v = V6<T>::constant(T(3));
         A6<T> a = A6<T>::constant(x / T(1000));
         limit_speed(V6<T>::constant(T(2)), v, a);
         return Results<T>(v, a);
       }},
      {"Integrals", 1, safe, safe,
       [](T x) { return Results<T>(Integrals<6, T>{}.advanced(V6<T>::constant(x), T(0.008)).sum); }},
      {"SurfaceBias", 1, shows, shows,
       [](T x) {
         SurfaceBias<6, T> bias;
         bias.elapsed = 1ms, bias.decaying = V6<T>::constant(x), bias.dv = V6<T>::constant(x);
         const auto now = bias.advanced(T(0.008), 8ms, T(10)).at(T(0.001), T(10), T(0.1));
         return Results<T>(now.S_d, now.dS_d);
       }},
      {"sliding_surface, SurfaceGains", 1, shows, shows,
       [](T x) {
         SurfaceErrors<6, T> e{};
         e.e[0] = e.de[1] = x;
         SurfaceInputs<6, T> in{};
         in.K_p = {T(10), T(0)};
         const auto s = sliding_surface(SurfaceGains<T>(JointControlSettings<6, T>{}), in, e,
                                        [](const auto& dq_r) { return V6<T>(dq_r); });
         return Results<T>(s.dq_r, s.ddq_r, s.S_q);
       }},
      {"RotationVectorError", 1, shows, shows, [](T x) { return errors_of<RotationVectorError>(x); }},
      {"ZyzError", 1, shows, shows, [](T x) { return errors_of<ZyzError>(x); }},
      {"SingularEscape::advanced", 1, safe, safe,
       [](T x) {
         const auto next = SingularEscape<6, T>{}.advanced(V6<T>::constant(x), T(0.008));
         return Results<T>(next.v, next.a);
       }},
      {"SingularRest", 0, safe, safe,
       [](T x) {
         return Results<T>(
             SingularRest<6, T>{}.advanced(SingularRest<6, T>{}.reached(x, T(0)), P6<T>{}, T(0.008)).r);
       }},
      {"InertialDamping", 1, shows, shows,
       [](T x) { return Results<T>(InertialDamping<T>(T(30)).acceleration(0, V6<T>::constant(x))); }},
      {"CrankNicolson::weight", 2, shows, shows,
       [](T x) { return Results<T>(CrankNicolson::weight(T(std::abs(x)), T(1))); }},
      {"SemiImplicitEuler::weight", 0, safe, safe,
       [](T x) { return Results<T>(SemiImplicitEuler::weight(T(std::abs(x)), T(1))); }},
      {"DelayLag", 1, shows, shows,
       [](T x) {
         const DelayLag<6, T, 8> servo(8ms, T(0.03));
         auto m = servo.start(0ns, P6<T>{}, V6<T>{});
         servo.send(m, 1ms, P6<T>::constant(x), V6<T>{});
         return Results<T>(servo.due(m, 100ms));
       }},
      {"Spring", 1, safe, safe,
       [](T x) {
         RobotConfiguration<6, T> c{.limits = limits_of<ur5::Description, T>(T(15)), .period = 8ms};
         c.stiffness = JointTorque<6, T>::constant(T(500));
         const Spring<6, T, 8> servo(c);
         auto m = servo.start(0ns, P6<T>{}, V6<T>{});
         return Results<T>(servo.due(m, 100ms, JointTorque<6, T>::constant(x)));
       }},
  };
  check_rows(rows);
  for (const Nanoseconds t :
       {Nanoseconds::min(), Nanoseconds(-1), Nanoseconds(0), Nanoseconds(50ms), Nanoseconds::max()}) {
    const T up = Ramp<T>().up(t), down = Ramp<T>().down(t);
    CHECK((up >= T(0) && up <= T(1) && down >= T(0) && down <= T(1)));
  }
  CHECK(refused([] { static_cast<void>(Ramp<T>(0ns)); }));
}

TEST_CASE_TEMPLATE("extremes: cells, contacts and their evidence", T, SKINCTL_EXTREME_SCALARS) {
  using enum Wrong;
  using Wrenches = LinkWrenches<ur5::Model, 0b100000, T>;
  using W = Wrench<Link<5>, Link<5>, Link<5>, T>;
  static const Row<T> rows[] = {
      {"proximity_evidence", 0, safe, safe, [](T x) { return Results<T>(proximity_evidence(x)); }},
      {"median_evidence", 0, safe, safe,
       [](T x) { return Results<T>(median_evidence(x, T(5)), median_evidence(T(5), x)); }},
      {"take_measurement", 0, safe, safe,
       [](T x) {
         State<6, T> good{}, other{};
         other.q[2] = x;
         const Status status = take_measurement(good, other, 8ms);
         CHECK((status.any() || good.q[2] == x));
         return Results<T>(good.q);
       }},
      {"corrected", 0, safe, shows, [](T x) { return Results<T>(corrected(x < 0 ? -x : x, RestCell<T>{})); }},
      {"is_unexplained", 0, safe, safe,
       [](T x) {
         RestCell<T> cell{};
         cell.frozen = x, cell.below = x, cell.evidence = x;
         return Results<T>(is_unexplained(cell) ? T(1) : T(0));
       }},
      {"RestLevel::take", 0, safe, safe,
       [](T x) {
         const RestLevel levels;
         auto m = levels.start(T(3));
         levels.take(m, x, 4ms, T(0), RestLevels{});
         levels.take(m, T(5), 4ms, x, RestLevels{});
         return Results<T>(m.cell.above, m.cell.whole, m.cell.fraction);
       }},
      {"EventGate::pass", 0, safe, shows,
       [](T x) { return Results<T>(EventGate<T>::dead_band(T(1)).pass(x < 0 ? -x : x, false)); }},
      {"EventGate::hysteresis", 0, safe, shows,
       [](T x) { return Results<T>(EventGate<T>::hysteresis(T(2), T(1)).pass(x < 0 ? -x : x, true)); }},
      {"total_of, contact_part, LinkWrenches::set", 0, shows, shows,
       [](T x) {
         Wrenches w;
         w.template set<5>(W{{x, T(0), T(0)}, {T(0), x, T(0)}});
         TouchWrenches<Wrenches> touch;
         touch.force = w;
         return Results<T>(total_of(touch).template wrench<5>(), contact_part(touch).template wrench<5>());
       }},
      {"skin_torque of wrenches", 1, shows, shows,
       [](T x) {
         Wrenches w;
         w.template set<5>(W{{x, T(0), T(0)}, {T(0), x, T(0)}});
         return Results<T>(skin_torque(ur5::Model{}, P6<T>{}, w));
       }},
      {"contacts_of a torque, JointTouch", 0, safe, safe,
       [](T x) {
         JointTouch<ur5::Model, T> touch;
         touch.torque[2] = x;
         const auto contacts = contacts_of(ur5::Model{}, P6<T>{}, touch);
         CHECK(contacts.count <= 1);
         return Results<T>(skin_torque(ur5::Model{}, 0, touch)[0],
                           contacts.count == 0 ? T(0) : contacts.list[0].row[2]);
       }},
      {"Contact::along", 1, shows, shows,
       [](T x) {
         Contact<6, T> c;
         c.row[2] = T(0.5);
         return Results<T>(c.along(V6<T>::constant(x)));
       }},
      {"PressedArea::add", 1, shows, shows,
       [](T x) {
         PressedArea<T> area;
         area.add({T(1), T(0), T(0)}, {T(0), T(0), T(1)}, {}, T(2));
         area.add({T(0), T(1), T(0)}, {T(0), T(0), T(1)}, {}, std::abs(x));
         static_cast<void>(area.same_side({T(0), T(0), T(1)}));
         return Results<T>(area.force, area.pushed, area.place);
       }},
      {"CellMasses::fastest", 1, safe, shows,
       [](T x) {
         const CellPlace cell{.link = 5, .normal = {0, 0, 1}};
         return Results<T>(CellMasses<T>(std::span(&cell, 1), 5).fastest({T(0), T(0), std::abs(x)}, {}));
       }},
  };
  check_rows(rows);
}

TEST_CASE("extremes: what is set up once, of cells and their noise") {
  using enum Wrong;
  static const Row<double> rows[] = {
      {"unit_wrench", 1, shows, shows,
       [](double x) { return Results<double>(unit_wrench(Transform<Link<5>, Cell>({}, {x, x, 0}))); }},
      {"Histogram::percentile", 0, safe, safe,
       [](double x) {
         Histogram h, other;
         h.record(Nanoseconds::min()), h.record(Nanoseconds::max()), other.record(5ms);
         h.merge(other);
         CHECK(h.percentile(x) <= h.max());
         return Results<double>(seconds<double>(h.percentile(x)), h.mean());
       }},
      {"cell_noise: a reading", 0, safe, safe,
       [](double x) {
         NoiseReading readings[] = {{0ns, 0.01, 0}, {4ms, x, 0}, {8ms, 0.01, 0}, {12ms, 0.011, 0}};
         const auto n = cell_noise(readings, {.rest = 0.01, .margin = 0.1});
         return Results<double>(n.rest, n.margin, n.sigma);
       }},
      {"cell_noise: a proximity", 0, safe, safe,
       [](double x) {
         NoiseReading readings[] = {{0ns, 0.01, 0}, {4ms, 0.012, x}, {8ms, 0.01, 0}, {12ms, 0.011, 0}};
         const auto n = cell_noise(readings, {.rest = 0.01, .margin = 0.1});
         if (!(x <= 0.05)) CHECK(n.finding == NoiseFinding::near);
         return Results<double>(n.rest, n.margin, n.sigma);
       }},
      {"patch_pitches", 0, shows, shows,
       [](double x) {
         const CellPlace cells[] = {{.link = 0, .place = {x, 0, 0}}, {.link = 0, .place = {0, 0, 0}}};
         const double pitch = patch_pitches(cells)[0];
         return Results<double>(std::abs(x) > 1e150 ? x : pitch);  // a cell so far away has no neighbour
       }},
  };
  check_rows(rows);

  RestRow row{};
  for (float& above : row.above) above = std::nanf("");
  const std::vector<RestRow> silent(8, row);
  CHECK_FALSE(std::isinf(patch_median(silent.data(), 0, 100)));
  CHECK_FALSE(is_unexplained(RestLevel::cell(silent[0], 0)));

  for (const Nanoseconds substep : {Nanoseconds::min(), -1ns, 0ns, 1ns, Nanoseconds::max()})
    for (const Nanoseconds period : {0ns, 1ns, Nanoseconds(8ms), Nanoseconds::max()}) {
      const Nanoseconds planned = planned_substep(period, substep);
      CHECK((planned >= 0ns && planned <= period));
    }
  for (const double wrong : {0.0, -1.0, std::nan(""), 1e-300})
    CHECK(refused([&] { static_cast<void>(EventGate<double>(2, 1, 0.5).counted(wrong)); }));

  VelocityEstimator<6> estimator;
  auto m = VelocityEstimator<6>::Memory{};
  for (const double x : {0.0, 1e-320, 1e308, std::nan(""), HUGE_VAL})
    for (const Nanoseconds stamp :
         {Nanoseconds::min(), Nanoseconds(0), Nanoseconds(3ms), Nanoseconds::max()}) {
      const Status status = estimator.observe(m, JointPosition<6>::constant(x), stamp);
      for (std::size_t i = 0; i < 6; ++i) CHECK(std::isfinite(m.state.q[i]));
      if (!std::isfinite(x)) CHECK(status.any());
    }
  // What a sample's check lets pass is counted within 16 bits; what it refuses is counted nowhere.
  TwoInARow::Memory last{};
  for (const float x : {0.0f, 1e-45f, 1.0f, 1.0000001f, -1e-45f, 1e38f, std::nanf(""), HUGE_VALF}) {
    const CellSample s{.force = {x, x, x}, .proximity = x};
    const bool good = x >= 0 && x <= 1;
    CHECK(check(s).any() != good);
    if (!good) continue;
    CHECK((counts(s).force <= 3 * 16384 && TwoInARow::take(last, counts(s)).force <= counts(s).force));
  }
  struct Felt {
    std::uint32_t regions = 1;
    double pushed = 0;
    Nanoseconds began{};
  };
  for (const double force : {0.0, std::nan(""), HUGE_VAL}) {
    const TouchCondition condition{.force = force};
    const Felt felt[] = {{.pushed = std::nan("")}};
    CHECK_FALSE(condition.holds(felt, 1s));
  }
  PressedAreas<ur5::Model, 0b100000, float> areas;
  const float unit[6] = {0, 0, 1, 0, 0, 0};
  for (const float push : {1e-45f, 1.0f, 1e38f, HUGE_VALF, std::nanf("")})
    for (int k = 0; k < 10; ++k) areas.add(5, {0.1f * static_cast<float>(k), push, 0}, unit, push);
  CHECK((areas.size() >= 1 && areas.size() <= 4));

  const Patch<5, 2> two({PlacedCell<5>{}, PlacedCell<5>{1, {}}}, {1, 0});
  CHECK(two.placed().size() == 2);
  CHECK(std::isnan(PatchWeights<2>::uniform(std::nanf(""))[1]));  // an input's, which the skin refuses

  for (const double wrong : {std::nan(""), HUGE_VAL, 0.0, -1.0}) {
    CHECK(refused([&] { static_cast<void>(full_cover(CylinderSurface{wrong, 0.3})); }));
    CHECK(refused([&] { static_cast<void>(full_cover(CapsuleSurface{wrong, 0.3})); }));
    CHECK(refused([&] { static_cast<void>(full_cover(CapsuleSurface{0.05, 0.3}, {wrong})); }));
    CHECK(refused([&] { static_cast<void>(largest_cell(CapsuleSurface{0.1, wrong}, 6)); }));
    CHECK(refused([&] { static_cast<void>(lone_forces(ur5::Model{}, JointTorque<6>{}, {}, wrong)); }));
    CHECK(refused([&] { NoiseCalibration({}, {.step = wrong}); }));
  }

  for (const double wrong : {std::nan(""), HUGE_VAL}) {
    CHECK(refused([&] { static_cast<void>(ur5::skin_patches<6>({wrong, 0})); }));
    CHECK(refused([&] { (Mounted<ur5::Model>(ur5::Model{}, {}, wrong)); }));
    CHECK(refused([&] {
      static_cast<void>(
          Attached<BareBase, -1, ur5::Model>(attach<-1>(BareBase{}, ur5::Model{}, Stand{{}, {0, wrong, 0}})));
    }));  // Attached
    const CellPlace cell{.link = 5, .normal = {0, 0, 1}};
    for (double CellView::* member :
         {&CellView::range, &CellView::half_angle, &CellView::error, &CellView::fade_band}) {
      CellView view;
      view.*member = wrong;
      CHECK(refused([&] { (OwnView<ur5::Model>(ur5::Model{}, std::span(&cell, 1), {}, view)); }));
    }
  }
  for (const double wrong : {std::nan(""), -1.0, 1e9}) {
    CHECK(refused([&] { Regions(std::vector<Region>{{"palm", {0}, wrong}}); }));
    CHECK(refused(
        [&] { static_cast<void>(Patch<5, 1>({PlacedCell<5>{}}, {wrong == 1e9 ? HUGE_VAL : wrong, 0})); }));
  }
}
