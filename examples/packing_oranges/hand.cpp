#include "examples/packing_oranges/hand.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <variant>

#include "examples/adapters/allegro/cells.hpp"
#include "examples/adapters/allegro/limits.hpp"
#include "skinctl/control/grasp_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/model/mounted.hpp"

namespace packing {
namespace {
using namespace skinctl;
constexpr std::size_t N = hand_joints;
constexpr auto side = allegro::Side::right;
using Fingers = CalibratedModel<allegro::Tree, double>;
using Point = Xyz<double>;

/// The middle of a fingertip in its last link, where the maker's description has its frame.
Point tip_in_link(std::size_t finger) {
  const auto canonical = canonical_links<Chain<4>>(allegro::finger_links(finger, side));
  const double s = std::sin(-canonical.turn[3]), c = std::cos(-canonical.turn[3]);
  const Rotation<double> about_z{{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
  const auto R_LU = about_z * adapters::allegro::makers_turn(4 * finger + 3, side).transpose();
  return turn_back(R_LU.transpose(), Point{0, 0, finger < 3 ? 0.0267 : 0.0423});
}
std::array<Point, 4> tips_in_links() {
  return {tip_in_link(0), tip_in_link(1), tip_in_link(2), tip_in_link(3)};
}

struct Axis {
  Point at{0, 0, 0}, along{0, 0, 1};
};
/// The joints' axes and the fingertips, in the hand's frame.
struct Stance {
  std::array<Axis, N> axis;
  std::array<Point, 4> tip;
};
Stance stance(const Fingers& model, const std::array<Point, 4>& tips, const JointPosition<N>& q) {
  Stance out;
  const auto poses = link_poses(model, q);
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    const auto one = [&](const auto& X, std::size_t i) {
      out.axis[i] = {X.origin(), X.axis_z()};
      const Point& p = tips[i / 4];
      if (i % 4 == 3) out.tip[i / 4] = X.origin() + p.x * X.axis_x() + p.y * X.axis_y() + p.z * X.axis_z();
    };
    (one(poses.template get<I>(), I), ...);
  }(std::make_index_sequence<N>());
  return out;
}

/// Moves the joints of a finger until its tip is at `target`; how far it stays away [m].
double reach(const Fingers& model, std::size_t finger, const Point& target, JointPosition<N>& q) {
  const auto tips = tips_in_links();
  double far = 1;
  for (int round = 0; round < 80 && far > 1e-6; ++round) {
    const Stance s = stance(model, tips, q);
    const Point off = target - s.tip[finger];
    far = norm(off);
    Point column[4];
    double A[6] = {}, x[3];
    for (std::size_t j = 0; j < 4; ++j) {
      const Axis& a = s.axis[4 * finger + j];
      const Point J = column[j] = cross(a.along, Point(s.tip[finger] - a.at));
      A[0] += J.x * J.x, A[1] += J.x * J.y, A[2] += J.x * J.z;
      A[3] += J.y * J.y, A[4] += J.y * J.z, A[5] += J.z * J.z;
    }
    constexpr double damped = 1e-6;
    const double M[9] = {A[0] + damped, A[1], A[2], A[1], A[3] + damped, A[4], A[2], A[4], A[5] + damped};
    const double b[3] = {off.x, off.y, off.z};
    math::Ldlt<3, double>(M).solve(b, x);
    for (std::size_t j = 0; j < 4; ++j) {
      const std::size_t i = 4 * finger + j;
      const double step = column[j].x * x[0] + column[j].y * x[1] + column[j].z * x[2];
      constexpr double room = 0.03;  // to the ends of the joints
      q[i] = std::clamp(q[i] + std::clamp(step, -0.3, 0.3), adapters::allegro::lower[i] + room,
                        adapters::allegro::upper[i] - room);
    }
  }
  return far;
}

/// Postures along the closing of a grasp, from the smallest to the largest.
struct Line {
  static constexpr std::size_t count = 12;
  std::array<double, count>
      size{};  ///< as `GraspControl` measures it [m]; of a hand that wraps: how far it is open, 0 to 1
  std::array<JointPosition<N>, count> q{};

  [[nodiscard]] JointPosition<N> at(double s) const noexcept {
    std::size_t k = 0;
    while (k + 2 < count && s > size[k + 1]) ++k;
    const double x = (s - size[k]) / (size[k + 1] - size[k]), u = !(x > 0) ? 0 : x < 1 ? x : 1;
    return JointPosition<N>::generate([&](std::size_t i) { return (1 - u) * q[k][i] + u * q[k + 1][i]; });
  }
};
/// The point as far from each of the three fingertips that take part, between them.
Point middle_of(const std::array<Point, 4>& tip, const std::array<double, 4>& takes_part) {
  std::array<Point, 4> of{};
  std::size_t count = 0;
  for (std::size_t f = 0; f < 4; ++f)
    if (takes_part[f] > 0) of[count++] = tip[f];
  const Point u = of[1] - of[0], v = of[2] - of[0], w = cross(u, v);
  return of[0] +
         (1 / (2 * dot(w, w))) * Point(dot(v, v) * Point(cross(w, u)) + dot(u, u) * Point(cross(v, w)));
}
/// The mean distance of the fingertips that take part from their middle.
double size_of(const std::array<Point, 4>& tip, const std::array<double, 4>& takes_part) {
  double fingers = 0, out = 0;
  Point middle{0, 0, 0};
  for (std::size_t f = 0; f < 4; ++f) fingers += takes_part[f], middle = middle + takes_part[f] * tip[f];
  for (std::size_t f = 0; f < 4; ++f)
    out += takes_part[f] / fingers * norm(Point(tip[f] - (1 / fingers) * middle));
  return out;
}
Line line_of(const Fingers& model, const Grasp& g) {
  Line out;
  if (g.wraps) {
    for (std::size_t k = 0; k < Line::count; ++k) {
      const double u = out.size[k] = static_cast<double>(k) / (Line::count - 1);
      for (std::size_t i = 0; i < N; ++i) out.q[k][i] = (1 - u) * g.curled[i] + u * g.posture[i];
    }
    return out;
  }
  const auto tips = tips_in_links();
  JointPosition<N> q(g.posture);
  for (std::size_t k = Line::count; k-- > 0;) {
    const double far = g.least + (g.most - g.least) * static_cast<double>(k) / (Line::count - 1);
    for (std::size_t f = 0; f < 4; ++f) {
      if (!(g.takes_part[f] > 0)) continue;
      const double off = reach(model, f, g.centre + (far * g.away[f] + g.beside[f]), q);
      require(off < 5e-4, "Hand: a fingertip stays away from its place in the grasp", off, "< 0.0005 m");
    }
    out.q[k] = q;
    out.size[k] = size_of(stance(model, tips, q).tip, g.takes_part);
    require(k + 1 == Line::count || out.size[k] < out.size[k + 1], "Hand: size of a grasp that closes",
            out.size[k], "less from posture to posture");
  }
  return out;
}

/// The fingers with gravity along any axis.
struct Leaning : Fingers {
  Point down;
  Leaning(const Fingers& model, const Point& g) : Fingers(model), down(g) {}
  template <Scalar U>
  SKINCTL_INLINE constexpr Xyz<double> gravity() const noexcept {
    return down;
  }
};

/// What the springs of the fingers do.
enum class Springs : unsigned char {
  shape,  ///< hold the fingers to the grasp's postures
  yield,  ///< give way: each finger goes on until it touches
  keep    ///< hold the fingers to each other as they are
};

/// A force that closes the fingers, and gravity.
struct HandGoal {
  double internal = 0;  ///< [N]
  double curl = 0;      ///< of a hand that wraps, 0 to 1
  Springs springs = Springs::shape;
  Point gravity{9.81, 0, 0};  ///< in the hand's frame [m/s^2]
};

/// The internal force of the grasp; springs that hold the fingers to the posture which belongs to their present closing,
/// so that they hold the object's place and leave its size to the force; and the fingers' weight, however the arm
/// holds the hand.
template <class I>
class HandLaw : public Composable {
 public:
  using Internal = I;
  using Goal = HandGoal;
  using scalar = double;
  static constexpr std::size_t joints = N;
  static constexpr Needs needs = Internal::needs;
  static constexpr LawRole role = LawRole::reactive;
  static constexpr std::size_t gravity_laws = 1;  // it holds the fingers' weight
  struct Memory {
    typename Internal::Memory internal;
    Point gravity{9.81, 0, 0};
    JointPosition<N> off;  ///< of the springs' rest from the grasp's posture [rad]
    Springs springs = Springs::shape;
    double curl = 0;
  };
  /// A finger of a hand that wraps stops at what it touches: its springs pull with this at most [N m].
  static constexpr double curling = 0.1;
  static constexpr double stiffness = 3, damping = 0.045;  // of the joints [N m/rad], [N m s/rad]
  static constexpr double yielding = 0.1;                  // time constant of springs that yield [s]

  HandLaw(const Fingers& model, const Grasp& g, const Internal& internal)
      : model_(model), line_(line_of(model, g)), internal_(internal), wraps_(g.wraps) {}

  template <class K>
  [[nodiscard]] Memory start(const K& known) const noexcept {
    return {internal_.start(known), {9.81, 0, 0}, {}, Springs::shape, 0};
  }
  template <class K>
  [[nodiscard]] Received<Memory> receive(const Memory& m, const K& known, const Goal& goal) const noexcept {
    const auto out = internal_.receive(m.internal, known, GraspGoal<double>{goal.internal});
    const double g = dot(goal.gravity, goal.gravity);
    return {{out.memory, g < 400 ? goal.gravity : m.gravity, m.off, goal.springs, goal.curl}, out.status};
  }
  template <class K>
  [[nodiscard]] JointTorque<N> torque(const Memory& m, const K& known) const noexcept {
    JointTorque<N> tau = internal_.torque(m.internal, known);
    tau += gravity_torque(Leaning(model_, m.gravity), known.q());
    const auto q_d = line_.at(wraps_ ? 1 - m.curl : internal_.shape(known).size);
    const double most = wraps_ ? curling : 1e3;
    for (std::size_t i = 0; i < N; ++i)
      tau[i] +=
          std::clamp(stiffness * (q_d[i] + m.off[i] - known.q()[i]), -most, most) - damping * known.dq()[i];
    return tau;
  }
  template <class K>
  [[nodiscard]] Memory advance(const Memory& m, const K& known, double dt, Opposition o) const noexcept {
    Memory next = m;
    next.internal = internal_.advance(m.internal, known, dt, o);
    if (wraps_ || m.springs == Springs::keep) return next;
    const double part = dt / (dt + yielding);
    const auto q_d = line_.at(internal_.shape(known).size);
    for (std::size_t i = 0; i < N; ++i) {
      const double to = m.springs == Springs::yield ? known.q()[i] - q_d[i] : 0;
      next.off[i] += part * (to - m.off[i]);
    }
    return next;
  }
  [[nodiscard]] const Line& line() const noexcept { return line_; }

 private:
  Fingers model_;
  Line line_;
  Internal internal_;
  bool wraps_;
};

constexpr GraspSettings<double> pressing{.damping = 2, .max_rate = 1000, .max_force = 12};
using OfTips = GraspControl<N, double, 3, 7, 11, 15>;
/// Of the phalanges: three of each finger, two of the thumb.
using OfPhalanges = GraspControl<N, double, 1, 2, 3, 5, 6, 7, 9, 10, 11, 14, 15>;
/// Their middles, and the fingertips.
std::array<Point, OfPhalanges::fingers> middles(const Fingers& model) {
  const auto poses = link_poses(model, JointPosition<N>{});
  const auto tips = tips_in_links();
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    const auto one = [&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
      if constexpr (K % 4 == 3)
        return tips[K / 4];
      else
        return Point(0.5 * (poses.template get<K>().inverse() * poses.template get<K + 1>()).origin());
    };
    return std::array{one(std::integral_constant<std::size_t, I>())...};
  }(std::index_sequence<1, 2, 3, 5, 6, 7, 9, 10, 11, 14, 15>());
}

template <class Internal>
auto make_cycle(const Grasp& grasp, const Internal& internal) {
  const auto model = allegro::hand(side);
  const Rotation<double> palm_down{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}};
  const auto scale = adapters::allegro::TorqueScale::of(adapters::allegro::Generation::v4, 0.7,
                                                        adapters::allegro::Gears::plain);
  // The joints' own friction, which no maker states, is left alone.
  const auto robot = by_torque(Mounted<Fingers>(model, palm_down),
                               {.limits = adapters::allegro::limits(scale),
                                .period = Hand::period,
                                .delay = 1ms,
                                .virtual_inertia = JointTorque<N>::constant(2e-4)},
                               FrictionUncompensated{});
  return Cycle(robot, HandLaw<Internal>(model, grasp, internal));
}
template <class Internal>
using SceneOf = decltype(make_cycle(Grasp{}, std::declval<Internal>()));

/// What is asked of a gripper, as a force that closes the fingers.
class Firmware {
 public:
  static constexpr double stiff = 300;   // of the closing while nothing is held [N/m]
  static constexpr double gain = 8;      // of the force that is regulated [1/s]
  static constexpr double rise = 6;      // of that force while an object is squeezed [N/s], at ...
  static constexpr double slow = 0.015;  // ... this speed [m/s]
  static constexpr double touched = 0.3, lost = 0.12;  // [N]
  static constexpr double filter = 0.006, steady = 0.03;

  /// @param most  size of the open grasp [m].
  explicit Firmware(double most) : most_(most), wanted_(most) {}

  /// @param force, least  mean force of the fingertips that take part, and the least of them.
  double step(const GripperCommand& c, double size, double force, double least, Nanoseconds now, double dt) {
    if (c.count != 0 && c.count != count_) {
      count_ = c.count;
      goal_ = limited(c.goal, hand_range);
      right_for_ = 0;
      closes_ = goal_.opening < opening_of(size) - 1e-3;
      if (!closes_) holds_ = false, wanted_ = size;
    }
    force_ += dt / (filter + dt) * (force - force_);
    const double target = std::min(goal_.opening / 2 + tip_radius, most_);
    least_ += dt / (filter + dt) * (least - least_);
    if (!holds_ && closes_ && force_ > touched && least_ > lost) holds_ = true;
    if (holds_ && force_ < lost) holds_ = false, wanted_ = size;
    if (!holds_)
      springs_ =
          closes_ && (springs_ == Springs::yield || force_ > 0.5 * lost) ? Springs::yield : Springs::shape;
    if (holds_) {
      const double most = rise * goal_.speed / slow;
      internal_ += std::clamp(gain * (goal_.force - force_), -most, most) * dt;
      internal_ = std::clamp(internal_, 0.0, 2 * hand_range.max_force);
      const bool right = least_ > lost && std::abs(force_ - goal_.force) < 0.1 + 0.08 * goal_.force;
      right_for_ = right ? right_for_ + dt : 0;
      if (right_for_ >= steady) springs_ = Springs::keep;
    } else {
      const double way = goal_.speed / 2 * dt;
      wanted_ += std::clamp(target - wanted_, -way, way);
      wanted_ = std::clamp(wanted_, size - 0.012, size + 0.012);
      internal_ = std::clamp(stiff * (size - wanted_), -3.0, 3.0);
      right_for_ = 0;
    }
    const bool moving = count_ > 0 && std::abs(target - size) > 1.5e-3;
    const bool held = right_for_ >= steady;
    state_ = {now, opening_of(size), force, true, moving && !held, held, true, GripperError::none, 0};
    return internal_;
  }
  /// The same while a person leads the fingers.
  /// @param second  force of the fingertip that touches second most [N].
  double led(double size, double force, double second, Nanoseconds now, double dt) {
    force_ += dt / (filter + dt) * (force - force_);
    second_ += dt / (filter + dt) * (second - second_);
    const bool touches = second_ > (holds_ ? lost : led_touched);
    if (!touches) pressed_ = 0;
    apart_for_ = touches ? 0 : apart_for_ + dt;
    if (!holds_ && touches) {
      pressed_ = std::max(pressed_, force_);
      held_for_ += dt;
      if (held_for_ > press) holds_ = true, internal_ = std::clamp(pressed_, led_least, hand_range.max_force);
    } else if (!holds_ || apart_for_ > steady) {
      holds_ = false;
      held_for_ = internal_ = 0;
    }
    springs_ = holds_ ? Springs::keep : Springs::yield;
    state_ = {now, opening_of(size), force, true, false, holds_, true, GripperError::none, 0};
    return internal_;
  }
  [[nodiscard]] const GripperState& state() const { return state_; }
  [[nodiscard]] Springs springs() const { return springs_; }
  [[nodiscard]] static double opening_of(double size) { return 2 * (size - tip_radius); }

 private:
  static constexpr double led_touched = 0.5, led_least = 1;  // [N]
  static constexpr double press = 0.3;  // so long a person presses before the fingers hold by themselves [s]

  GripperGoal goal_{hand_range.opening, 1, 0.05};
  GripperState state_{};
  double most_, wanted_, force_ = 0, least_ = 0, internal_ = 0, right_for_ = 0;
  double second_ = 0, pressed_ = 0, held_for_ = 0, apart_for_ = 0;  // while it is led
  std::uint32_t count_ = 0;
  bool closes_ = false, holds_ = false;
  Springs springs_ = Springs::shape;
};
/// The same for a hand that wraps: it curls, then the force rises to what was asked for; when the fingers rest, it holds.
class WrapFirmware {
 public:
  static constexpr double curls = 1, rise = 4;         // [1/s], [N/s]
  static constexpr double still = 0.05, steady = 0.2;  // [rad/s], [s]

  HandGoal step(const GripperCommand& c, const State<N>& measured, double dt) {
    if (c.count != 0 && c.count != count_) {
      count_ = c.count;
      goal_ = c.goal;
    }
    const bool closes = count_ > 0 && goal_.opening < hand_range.opening / 2;
    double fastest = 0;
    for (std::size_t i = 0; i < N; ++i) fastest = std::max(fastest, std::abs(measured.dq[i]));
    rests_for_ = fastest < still ? rests_for_ + dt : 0;
    const bool rests = rests_for_ > steady;
    curl_ = std::clamp(curl_ + (closes ? curls : -curls) * dt, 0.0, 1.0);
    pressing_ = closes && curl_ == 1;
    const double to = pressing_ ? goal_.force : 0;
    internal_ += std::clamp(to - internal_, -rise * dt, rise * dt);
    const bool holds = pressing_ && internal_ == to && (rests || state_.holding);
    state_ = {measured.time, 0, internal_, true, closes && !holds, holds, true, GripperError::none, 0};
    return {.internal = internal_, .curl = curl_};
  }
  [[nodiscard]] const GripperState& state() const { return state_; }

 private:
  GripperGoal goal_{hand_range.opening, 1, 0.05};
  GripperState state_{};
  double internal_ = 0, curl_ = 0, rests_for_ = 0;
  std::uint32_t count_ = 0;
  bool pressing_ = false;
};

/// A cycle with its memory.
template <class Internal>
struct Running {
  using Scene = SceneOf<Internal>;
  Scene cycle;
  std::unique_ptr<typename Scene::Memory> memory = std::make_unique<typename Scene::Memory>();

  Running(const Grasp& grasp, const Internal& internal, const State<N>& measured)
      : cycle(make_cycle(grasp, internal)) {
    cycle.start(*memory, measured);
  }
  auto step(const State<N>& measured, const HandGoal& goal) {
    typename Scene::Input input;
    input.now = measured.time;
    input.measured = measured;
    input.goal = goal;
    return cycle.step(*memory, input);
  }
};
}  // namespace

Grasp around_a_ball() {
  const double c = 0.5, s = std::sqrt(0.75);
  Grasp g;
  g.name = "thumb and two fingers";
  g.takes_part = {1, 0, 1, 1};
  g.centre = {0.053, 0, 0.04};
  g.away = {Point{0, s, c}, Point{0, 0, 0}, Point{0, -s, c}, Point{0, 0, -1}};
  g.posture = {-0.1, -0.08, 1.2, 1.2, 0, -0.17, -0.15, -0.2, 0.1, -0.08, 1.2, 1.2, 1.15, 0.6, 1.0, 1.2};
  return g;
}

HandBody hand_body(const Grasp& grasp, double flange, double reach) {
  const Fingers model = allegro::hand(side);
  HandBody out;
  const auto poses = link_poses(model, JointPosition<N>{});
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    const auto one = [&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
      LinkBody& l = out.links[K];
      const auto in_parent = [&](const auto& X) { l.p = X.origin(), l.x = X.axis_x(), l.y = X.axis_y(); };
      if constexpr (K % 4 == 0)
        in_parent(poses.template get<K>());
      else
        in_parent(poses.template get<K - 1>().inverse() * poses.template get<K>());
      mass_of(l, numbers_of<K, double>(model));
    };
    (one(std::integral_constant<std::size_t, I>()), ...);
  }(std::make_index_sequence<N>());
  out.tips = tips_in_links();
  out.takes_part = grasp.takes_part;
  out.lower = adapters::allegro::lower;
  out.upper = adapters::allegro::upper;
  const auto open = line_of(model, grasp).q.back();
  for (std::size_t i = 0; i < N; ++i) out.start[i] = open[i];
  const Point x{0, 0, 1}, y{0, -1, 0}, z{1, 0, 0};
  out.palm.x = x, out.palm.y = y;
  const Point& p = grasp.centre;
  out.palm.p = Point{0, 0, flange + reach} - (p.x * x + p.y * y + p.z * z);
  out.palm.mass = allegro::palm.mass;
  out.palm.com = {allegro::palm.c[0], allegro::palm.c[1], allegro::palm.c[2]};
  out.palm.inertia = {allegro::palm.xx, allegro::palm.yy, allegro::palm.zz, 0, 0, 0};
  out.grasps = p;
  return out;
}

std::array<std::array<Point, 5>, 4> skeleton(const JointPosition<N>& q) {
  const Stance s = stance(allegro::hand(side), tips_in_links(), q);
  std::array<std::array<Point, 5>, 4> out{};
  for (std::size_t i = 0; i < N; ++i) out[i / 4][i % 4] = s.axis[i].at;
  for (std::size_t f = 0; f < 4; ++f) out[f][4] = s.tip[f];
  return out;
}

struct Hand::Parts {
  Grasp grasp;
  Fingers model = allegro::hand(side);
  std::array<Point, 4> tips = tips_in_links();
  std::variant<Running<OfTips>, Running<OfPhalanges>> running;
  Firmware firmware;
  WrapFirmware wrap;
  Status status;
  Nanoseconds last{};
  Point between{0, 0, 0};

  using Either = decltype(running);
  Parts(const Grasp& g, const State<N>& measured)
      : grasp(g),
        running(g.wraps ? Either(std::in_place_index<1>, g, OfPhalanges(middles(model), pressing), measured)
                        : Either(std::in_place_index<0>, g, OfTips(tips, pressing, g.takes_part), measured)),
        firmware(line_of(model, g).size.back()),
        last(measured.time) {}
};

Hand::Hand(const Grasp& grasp, const State<N>& measured) : parts_(std::make_unique<Parts>(grasp, measured)) {}
Hand::~Hand() = default;
Hand::Hand(Hand&&) noexcept = default;

JointTorque<N> Hand::step(const Input& in) {
  Parts& p = *parts_;
  const double dt = seconds<double>(in.measured.time - p.last);
  p.last = in.measured.time;
  HandGoal goal{.gravity = in.gravity};
  if (p.grasp.wraps) {
    goal = p.wrap.step(in.command, in.measured, dt);
    goal.gravity = in.gravity;
  } else {
    double force = 0, fingers = 0, least = 1e3;
    auto touch = in.tips;
    std::nth_element(touch.begin(), touch.begin() + 1, touch.end(), std::greater<>());
    for (std::size_t f = 0; f < 4; ++f) {
      const double w = p.grasp.takes_part[f];
      force += w * in.tips[f], fingers += w;
      if (w > 0) least = std::min(least, in.tips[f]);
    }
    const auto tip = stance(p.model, p.tips, in.measured.q).tip;
    const double size = size_of(tip, p.grasp.takes_part);
    goal.internal = in.led ? p.firmware.led(size, force / fingers, touch[1], in.measured.time, dt)
                           : p.firmware.step(in.command, size, force / fingers, least, in.measured.time, dt);
    goal.springs = p.firmware.springs();
    p.between =
        p.firmware.state().holding ? middle_of(tip, p.grasp.takes_part) - p.grasp.centre : Point{0, 0, 0};
  }
  return std::visit(
      [&](auto& r) {
        const auto out = r.step(in.measured, goal);
        p.status = out.status;
        return out.command.valid ? out.command.torque : JointTorque<N>{};
      },
      p.running);
}
const GripperState& Hand::state() const {
  return parts_->grasp.wraps ? parts_->wrap.state() : parts_->firmware.state();
}
Xyz<double> Hand::between() const {
  return in_tool(parts_->between);
}
Status Hand::status() const {
  return parts_->status;
}

}  // namespace packing
