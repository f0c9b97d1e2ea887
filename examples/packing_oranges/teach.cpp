#include "examples/packing_oranges/teach.hpp"

#include <cmath>
#include <memory>
#include <random>

#include "examples/packing_oranges/detector.hpp"
#include "examples/packing_oranges/tomm.hpp"
#include "examples/packing_oranges/world.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/semantics/features.hpp"
#include "skinctl/semantics/led_fingers.hpp"
#include "skinctl/tactile/touch_sum.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"

namespace packing {
namespace {
using namespace skinctl;
using Point = Xyz<double>;
using Pose = Transform<skinctl::World, Tool>;
using A = Arm<Ur5>;
constexpr std::size_t hand = 5;
constexpr double cycle = 0.008;
constexpr double middle = Ur5::flange + reach_of_gripper,
                 around = 0.05;    // of the hand, along the last axis; of its skin [m]
constexpr double off_axis = 0.04;  // of its cells [m]
/// The sides of the hand, and the way along each to its two cells.
constexpr Point sides[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr Point along[] = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
constexpr std::size_t cells_of_hand = 12;

/// Two cells on each side: a person who takes hold there pushes with any force, and turns with any moment. In the order of axes,
/// sides (+, -), cells (+, -).
std::vector<PlacedCell<hand>> hand_cells() {
  std::vector<PlacedCell<hand>> out;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double s : {1.0, -1.0})
      for (const double l : {1.0, -1.0}) {
        const Point n = s * sides[axis];
        const Rotation<double> R{along[axis], cross(n, along[axis]), n};
        out.push_back({static_cast<std::uint32_t>(out.size() + 1),
                       Transform<Link<hand>, Cell>(
                           R, around * n + (off_axis * l) * along[axis] + Point{0, 0, middle})});
      }
  return out;
}
/// What each of these cells feels of a force and a moment on the middle of the hand, in the link's axes.
std::array<double, cells_of_hand> felt(const Point& F, const Point& M) {
  std::array<double, cells_of_hand> out{};
  const double force[] = {F.x, F.y, F.z};
  const double moment[] = {M.z, M.x, M.y};  // the moment that the cells of each axis can make
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double* c = out.data() + 4 * axis;
    const double side = std::abs(force[axis]) / 2, couple = std::abs(moment[axis]) / (2 * off_axis);
    const std::size_t k = force[axis] > 0 ? 2 : 0;  // what pushes along an axis is felt on the other side
    c[k] += side, c[k + 1] += side;
    (moment[axis] > 0 ? c[0] : c[1]) += couple;
    (moment[axis] > 0 ? c[3] : c[2]) += couple;
  }
  return out;
}
/// The person takes hold above the sensor at the wrist: what the hand is pressed on pushes against the arm as the person does.
/// @param carries  what the sensor carries [kg].
auto led_scene(double carries) {
  const auto arm = by_position(A::Model{}, {.limits = limits_of<Ur5::Description>(15.0),
                                            .period = A::period,
                                            .delay = 8ms,
                                            .lag = 2ms,
                                            .virtual_damping = 8,
                                            .viscous_friction = {10.0, 10.0, 6.0, 2.0, 2.0, 1.0}});
  SkinSettings settings;
  settings.force = EventGate<>::dead_band(0.002);
  const Skin<A::Model, double, Patch<hand, cells_of_hand>> skin(
      Patch<hand, cells_of_hand>(hand_cells(), {.force = newtons_per_reading}), settings);
  return Cycle(
      arm,
      skin + wrist_sensor<hand>(A::Model{},
                                {.X_LS = Transform<Link<hand>, ForceSensor>::translation_xyz(0, 0, middle),
                                 .mass = carries,
                                 .gain = 0.4}),
      SkinJointControl{} + GravityControl{});
}
/// 0 to 1 with speed and acceleration 0 at the ends.
double quintic(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10 + u * (6 * u - 15));
}
double far(const Point& a, const Point& b) {
  return norm(Point(a - b));
}
double turned(const Rotation<double>& a, const Rotation<double>& b) {
  return norm(log_so3(a.transpose() * b));
}

class Person {
 public:
  Person(std::uint64_t seed, bool by_hand, bool onto = false, double floor = 0)
      : random_(seed),
        world_(bodies(by_hand), {.floor = floor, .wrists = onto}, seed + 1),
        scene_(led_scene(onto ? mass_of_hand() : 0)),
        memory_(std::make_unique<Memory>()),
        detector_({}, seed + 2),
        objects_([] {
          std::array<ObjectClass, Objects::capacity> kinds{};
          kinds.fill(orange_class);
          kinds[box] = box_class;
          return kinds;
        }()),
        known_(objects_.start()),
        onto_(onto) {
    world_.step();
    scene_.start(*memory_, world_.joints(0));
    static_cast<void>(objects_.detect(known_, {.object = box, .sigma = 1e-4, .time = world_.now()}));
    last_ = place();
    R_ = last_.axes();
    if (by_hand) hand_ = std::make_unique<Hand>(around_a_ball(), world_.fingers(0));
  }

  /// The place in the box, with a gripper that is closed.
  std::optional<Lesson> teach() {
    Lesson lesson;
    closed_ = true;
    lesson.meant = {in(-0.08, -0.02), in(-0.05, 0.05), in(0.045, 0.06)};
    lead({lesson.meant.x, lesson.meant.y, 0.2}, in(1.5, 2.5));
    lead_until(lesson.meant, in(1.0, 2.0));
    leave_alone(1.5);
    lesson.rested = place().origin();
    for (double t = 0; t < 0.2; t += cycle) {
      closed_ = t < 0.1;
      step({0, 0, -6 * std::sin(M_PI * t / 0.2)}, {0, 0, 0});  // on the switch: it moves the arm
    }
    wait(0.4);
    lesson.lasted = seconds<double>(world_.now());
    bool any = false;
    for (const auto& t : reader_.finish(known_.objects)) {
      if (t.activity == Activity::put && t.object == box) lesson.taught = t.X_OH.origin(), any = true;
      lesson.released = lesson.released || t.activity == Activity::release;
    }
    return any ? std::optional(lesson) : std::nullopt;
  }

  /// Why the last lesson was refused.
  [[nodiscard]] const std::string& why() const { return why_; }
  /// All of it, with arm and fingers.
  std::optional<HandLesson> teach_with_hand() {
    const Point feed = feed_place(0, 1);
    world_.put(0, {feed.x + in(-0.05, 0.05), feed.y + in(-0.01, 0.01), 0}, {in(0.036, 0.040), 6000});
    wanders_ = 0.002, trembles_ = 0.3;
    wait(0.6);
    // How this person takes it: beside its middle, turned, each finger a little elsewhere than the hand's maker would.
    const Point beside{in(-0.004, 0.004), in(-0.004, 0.004), in(-0.003, 0.003)};
    mean_to_turn(in(-0.25, 0.25));
    const Grasp usual = around_a_ball();
    std::array<Point, 4> way{};
    for (std::size_t f = 0; f < 4; ++f) {
      const Point w = usual.away[f] + Point{in(-0.1, 0.1), in(-0.1, 0.1), in(-0.1, 0.1)};
      way[f] = (1 / std::max(norm(w), 0.1)) * w;
    }
    const auto stand = [&](double distance) {
      std::array<Point, 4> tips{};
      for (std::size_t f = 0; f < 4; ++f) tips[f] = usual.centre + distance * way[f];
      return tips;
    };

    lead_fingers(stand(in(0.062, 0.066)), 1.5, 4);
    lead_until(at(world_.orange(0) + beside, 0.16), in(2.0, 3.0));
    let_fingers_go();
    lead_until(world_.orange(0) + beside, in(1.2, 2.0));
    leave_alone(1.0);
    const auto rested = beside_orange();
    lead_fingers(stand(0.025), in(0.8, 1.5), in(2.0, 3.0));
    wait(in(1.8, 2.4));
    let_fingers_go();
    wait(0.6);
    const auto tips = skeleton(world_.fingers(0).q);

    const Point drop{in(-0.08, -0.02), in(-0.08, 0.0), in(0.05, 0.065)};
    lead(at(place().origin(), 0.2), in(0.8, 1.2));
    mean_to_turn(in(-0.25, 0.25));
    lead(at(drop, 0.2), in(2.0, 3.0));
    free_ = wrist_;  // the person sets it to 0, with the orange in the hand
    weighed_ = true;
    if (onto_)
      press_down(drop);
    else
      lead_until(drop, in(1.0, 2.0));
    leave_alone(1.0);
    weighed_ = false;
    const Pose stood = place();
    lead_fingers(stand(in(0.060, 0.066)), in(0.5, 1.0), 6);
    wait(in(1.4, 2.0));
    let_fingers_go();
    wait(0.5);
    lead(at(drop, 0.2), 1.0);
    leave_alone(0.4);
    return learned(rested, beside, tips, stand(norm(Point(tips[0][4] - usual.centre))), stood, drop);
  }

 private:
  using Scene = decltype(led_scene(0));
  using Memory = Scene::Memory;
  static constexpr std::uint8_t box = arms * slots;
  using Objects = ObjectWorld<box + 1>;

  static std::array<ArmBody, arms> bodies(bool by_hand) {
    std::array<ArmBody, arms> out{A::body(0), A::body(1)};
    if (by_hand) out[0].hand = hand_body(around_a_ball(), out[0].flange, reach_of_gripper);
    return out;
  }
  static double mass_of_hand() {
    const HandBody body = hand_body(around_a_ball(), Ur5::flange, reach_of_gripper);
    double out = body.palm.mass;
    for (const LinkBody& l : body.links) out += l.mass;
    return out;
  }
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  [[nodiscard]] Pose place() const { return A::base(0) * A::hand(world_.joints(0).q); }
  [[nodiscard]] static Point at(const Point& p, double z) { return {p.x, p.y, z}; }
  [[nodiscard]] Transform<ObjectFrame, Tool> beside_orange() const {
    const Pose X = place();
    return {X.axes(), Point(X.origin() - world_.orange(0))};
  }
  /// The hand points down, turned by this about the vertical from how it stood at first.
  void mean_to_turn(double angle) {
    const Point x = last_.axis_x();
    const double size = std::hypot(x.x, x.y);
    const Point across{x.x / size, x.y / size, 0}, down{0, 0, -1};
    if (!means_) facing_ = {across, cross(down, across), down}, means_ = true;
    R_ = exp_so3(Point{0, 0, angle}) * facing_;
  }

  /// What the recordings say, and how far it is from the truth.
  std::optional<HandLesson> learned(const Transform<ObjectFrame, Tool>& rested, const Point& meant,
                                    const std::array<std::array<Point, 5>, 4>& tips,
                                    const std::array<Point, 4>& meant_tips, const Pose& stood,
                                    const Point& drop) {
    HandLesson out;
    out.lasted = seconds<double>(world_.now());
    bool takes = false, puts = false;
    for (const auto& t : reader_.finish(known_.objects)) {
      if (t.activity == Activity::reach && t.role == orange_class && !takes)
        out.shown.X_OH = t.X_OH, takes = true;
      if (t.activity == Activity::put && t.role == box_class) {
        out.shown.X_WH = t.X_WH, puts = true;
        out.shown.until_touched = t.until_touched;
        out.shown.way = t.way, out.shown.pressed = t.pressed;
      }
    }
    const auto fingers = fingers_.finish();
    if (fingers.size() != 2 || fingers[0].activity != Activity::take) {
      why_ = fingers.empty()       ? "the fingers took nothing"
             : fingers.size() == 1 ? "the fingers took, and did not let go"
                                   : "the fingers took and let go more than once";
      return std::nullopt;
    }
    if (!takes || !puts) {
      why_ = takes ? "no goal in the box" : "no goal around the orange";
      return std::nullopt;
    }
    try {
      out.shown.grasp = grasp_shown(fingers[0].before, fingers[0].q, fingers[0].force);
      static_cast<void>(Hand(out.shown.grasp, world_.fingers(0)));  // throws where they cannot follow
    } catch (const ConfigurationError& error) {
      why_ = error.what();
      return std::nullopt;
    }
    const Grasp& g = out.shown.grasp;
    double sum = 0, count = 0, square = 0;
    for (std::size_t f = 0; f < 4; ++f) {
      if (!(g.takes_part[f] > 0)) continue;
      sum += fingers[0].force[f], count += 1;
      const double off = far(tips[f][4], meant_tips[f]);
      square += off * off;
    }
    out.shown.hold = sum / count;
    out.shown.opening = opening_of(g, fingers[1].q);
    out.fingers = std::sqrt(square / count);
    out.take = far(out.shown.X_OH.origin(), rested.origin());
    out.take_turned = turned(out.shown.X_OH.axes(), rested.axes());
    out.take_meant = far(out.shown.X_OH.origin(), meant);
    out.put = far(out.shown.X_WH.origin(), stood.origin());
    out.put_turned = turned(out.shown.X_WH.axes(), stood.axes());
    out.put_meant = far(out.shown.X_WH.origin(), drop);
    return out;
  }

  /// Of what one means and where the own hand is: it wanders slowly, and trembles at 9 Hz [m].
  Point astray() {
    constexpr double slowly = 0.4;  // [s]
    const double keep = std::exp(-cycle / slowly), now = wanders_ * std::sqrt(1 - keep * keep);
    wander_ = keep * wander_ + now * Point{normal_(random_), normal_(random_), normal_(random_)};
    return wander_;
  }
  /// The person's arm: a spring with a damper to a target that moves to `goal`, at most 40 N; and 4 N m about it.
  void lead(const Point& goal, double time) {
    const Pose from = place();
    const Point turn = log_so3(from.axes().transpose() * R_);
    for (double t = 0; t < time; t += cycle) {
      const double s = quintic((t + cycle) / time);
      pull(from.origin() + s * Point(goal - from.origin()), from.axes() * exp_so3(Point(s * turn)));
    }
  }
  /// A cycle of that towards a target.
  void pull(const Point& to, const Rotation<double>& facing) {
    const Pose X = place();
    const Point target = to + astray();
    v_ = v_ + 0.6 * Point((1 / cycle) * Point(X.origin() - last_.origin()) - v_);
    w_ = w_ +
         0.6 * Point((1 / cycle) * Point(last_.axes() * log_so3(last_.axes().transpose() * X.axes())) - w_);
    Point F = 150.0 * Point(target - X.origin()) - 25.0 * v_;
    if (wanders_ > 0) {
      const double phase = 2 * M_PI * 9 * seconds<double>(world_.now());
      F = F + trembles_ * Point{std::sin(phase), std::sin(phase + 2), std::sin(phase + 4)};
    }
    Point M = 20.0 * Point(X.axes() * log_so3(X.axes().transpose() * facing)) - 0.5 * w_;
    if (norm(F) > 40) F = (40 / norm(F)) * F;
    if (norm(M) > 4) M = (4 / norm(M)) * M;
    grip_ = 2;
    step(force_ + 0.6 * Point(F - force_), moment_ + 0.6 * Point(M - moment_));
  }
  /// ... until it is there to within the person's patience.
  void lead_until(const Point& goal, double time) {
    lead(goal, time);
    for (int i = 0; i < 1000 && far(place().origin(), goal) > 0.004; ++i) lead(goal, cycle);
    lead(goal, 0.4);
  }
  /// Down until it presses with what the person means.
  void press_down(const Point& above) {
    const double force = in(5, 9);
    lead(at(above, 0.12), in(1.0, 1.5));
    double low = 0.12;
    for (double held = 0; held < 0.6 && low > -0.2;) {
      const double up = wrist_.z - free_.z;
      if (up < force) low = std::max(low - 0.03 * cycle, place().origin().z - 0.015);
      held = up > 0.7 * force ? held + cycle : 0;
      pull(at(above, low), R_);
    }
  }
  void leave_alone(double time) {
    const Point F = force_, M = moment_;
    grip_ = 0;
    for (double t = 0; t < 0.1; t += cycle) step((1 - t / 0.1) * F, (1 - t / 0.1) * M);
    wait(time);
  }
  void wait(double time) {
    for (double t = 0; t < time; t += cycle) step({0, 0, 0}, {0, 0, 0});
  }
  /// From now on the fingertips are led there, in the hand's frame, with at most so much force on each.
  void lead_fingers(const std::array<Point, 4>& to, double time, double most) {
    const auto bones = skeleton(world_.fingers(0).q);
    for (std::size_t f = 0; f < 4; ++f) finger_[f] = {bones[f][4], to[f]};
    fingers_begin_ = seconds<double>(world_.now()), fingers_time_ = time, fingers_most_ = most;
  }
  void let_fingers_go() { fingers_most_ = 0; }
  void push_fingers() {
    const auto bones = skeleton(world_.fingers(0).q);
    const Rotation<double> R = world_.palm(0).axes();
    const double s = quintic((seconds<double>(world_.now()) - fingers_begin_) / fingers_time_);
    for (std::size_t f = 0; f < 4; ++f) {
      Point F{0, 0, 0};
      if (fingers_most_ > 0 && around_a_ball().takes_part[f] > 0) {
        const Point target = finger_[f].from + s * Point(finger_[f].to - finger_[f].from);
        F = 300.0 * Point(target - bones[f][4]);
        if (norm(F) > fingers_most_) F = (fingers_most_ / norm(F)) * F;
      }
      world_.push_finger(0, f, R * F);
    }
  }

  /// A cycle with a force and a moment of the person on the hand, along the World's axes.
  void step(const Point& F, const Point& M) {
    force_ = F, moment_ = M;
    const Pose X = place();
    last_ = X;
    const auto R_WL = (A::base(0) * link_poses(A::Model{}, world_.joints(0).q).get<5>()).axes();
    const Point f = turn_back(R_WL, F), m = turn_back(R_WL, M);
    world_.push(0, hand, {0, 0, middle}, f, m);
    auto newtons = felt(f, m);
    std::array<CellSample, cells_of_hand> samples{};
    double touch = 0;
    for (std::size_t k = 0; k < cells_of_hand; ++k) {
      newtons[k] += (k < 4 ? grip_ / 2 : 0) + std::abs(0.02 * normal_(random_));
      touch += newtons[k];
      const auto reading = static_cast<float>(std::min(newtons[k] / (3 * newtons_per_reading), 1.0));
      samples[k] = {.time = world_.now(),
                    .cell = static_cast<std::uint32_t>(k + 1),
                    .force = {reading, reading, reading}};
    }
    Scene::Input input;
    input.now = world_.now();
    input.measured = world_.joints(0);
    input.samples = samples;
    // As the sensor's own low pass has it, of 30 ms: without one, the inertia of the hand makes the arm hum.
    wrist_ = wrist_ + cycle / (cycle + 0.03) * Point(world_.wrist(0) - wrist_);
    const Point w = turn_back(R_WL, wrist_);
    const WrenchSample pulled{.time = world_.now(), .force = {w.x, w.y, w.z}, .moment = {0, 0, 0}};
    input.sensed.wrenches = {&pulled, 1};
    const auto out = scene_.step(*memory_, input);
    if (out.planned.valid) world_.command(0, out.planned.position, out.planned.velocity);
    record(X, touch);
    if (hand_) push_fingers();
    for (int i = 0; i < 8; ++i, ++tick_) {
      if (hand_ && tick_ % 3 == 0) hold(X);
      world_.step();
    }
  }
  void hold(const Pose& X) {
    Hand::Input in;
    in.measured = world_.fingers(0);
    in.tips = world_.tips(0);
    in.gravity = gravity_in_hand(X);
    in.led = true;
    world_.command(0, hand_->step(in));
  }
  void record(const Pose& X, double touch) {
    const auto now = world_.now();
    detector_.step(world_, false);
    Picture picture;
    while (detector_.take(now, picture))
      for (const auto& d : picture.seen) static_cast<void>(objects_.detect(known_, d));
    const std::uint8_t held = known_.held;
    double force = closed_ ? 4.0 : 0.0;
    if (hand_) {
      const auto& tips = world_.tips(0);
      fingers_.take({now, world_.fingers(0).q, tips});
      closed_ = fingers_.closed();
      force = (tips[0] + tips[1] + tips[2] + tips[3]) / 3;
      static_cast<void>(extractor_.step(featured_, objects_, known_, {now, X, 0.0002, force}));
    }
    const double pressed = weighed_ ? std::max(0.0, wrist_.z - free_.z) : 0;
    reader_.take({now, X, touch, force, closed_, Activity::unknown, pressed}, known_.objects, held);
  }

  struct LedFinger {
    Point from{0, 0, 0}, to{0, 0, 0};
  };
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  packing::World world_;
  Scene scene_;
  std::unique_ptr<Memory> memory_;
  std::unique_ptr<Hand> hand_;
  Detector detector_;
  Objects objects_;
  Objects::Memory known_;
  FeatureExtractor<> extractor_;
  FeatureExtractor<>::Memory featured_{};
  DemonstrationReader<> reader_{{.near_object = 0.2}};
  LedFingersReader<hand_joints, 4> fingers_;
  std::array<LedFinger, 4> finger_{};
  double fingers_begin_ = 0, fingers_time_ = 1, fingers_most_ = 0;
  Point force_{0, 0, 0}, moment_{0, 0, 0}, v_{0, 0, 0}, w_{0, 0, 0}, wander_{0, 0, 0};
  Pose last_;
  Rotation<double> R_, facing_;  ///< how the person means the hand to stand, and how it stood at first
  double wanders_ = 0, trembles_ = 0;
  Point wrist_{0, 0, 0},
      free_{0, 0, 0};  ///< what the wrist's sensor says, and said while the hand touches nothing else
  bool onto_, weighed_ = false;
  std::string why_;
  double grip_ = 2;  ///< two sides of the hand are held with this [N]
  std::uint64_t tick_ = 0;
  bool closed_ = false, means_ = false;
};
}  // namespace

std::optional<Lesson> teach_place(std::uint64_t seed) {
  return Person(seed * 7919 + 11, false).teach();
}
std::optional<HandLesson> teach_with_hand(std::uint64_t seed, bool onto, double floor, std::string* why) {
  Person person(seed * 7919 + 13, true, onto, floor);
  const auto out = person.teach_with_hand();
  if (why != nullptr) *why = person.why();
  return out;
}

}  // namespace packing
