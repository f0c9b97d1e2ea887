#include "examples/packing_oranges/teach.hpp"

#include <cmath>
#include <memory>
#include <random>

#include "examples/packing_oranges/tomm.hpp"
#include "examples/packing_oranges/world.hpp"
#include "skinctl/fusion/expression.hpp"

namespace packing {
namespace {
using namespace skinctl;

using A = Arm<Ur5>;
constexpr std::size_t hand = 5;
constexpr double middle = Ur5::flange + reach_of_gripper,
                 around = 0.05;  // of the hand, along the last axis; of its skin [m]

/// Six cells, one on each side.
std::vector<PlacedCell<hand>> hand_cells() {
  std::vector<PlacedCell<hand>> out;
  const Rotation<double> turned[] = {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}},
                                     {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                     {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}}};
  std::uint32_t id = 1;
  for (const auto& R : turned)
    out.push_back({id++, Transform<Link<hand>, Cell>(R, around * R.z + Xyz<double>{0, 0, middle})});
  return out;
}
auto led_scene() {
  const auto arm = by_position(A::Model{}, {.limits = limits_of<Ur5::Description>(15.0),
                                            .period = A::period,
                                            .delay = 8ms,
                                            .lag = 2ms,
                                            .virtual_damping = 8,
                                            .viscous_friction = {10.0, 10.0, 6.0, 2.0, 2.0, 1.0}});
  SkinSettings settings;
  settings.force = EventGate<>::dead_band(0.002);
  return Cycle(arm,
               Skin<A::Model, double, Patch<hand, 6>>(
                   Patch<hand, 6>(hand_cells(), {.force = newtons_per_reading}), settings),
               SkinJointControl{} + GravityControl{});
}

class Person {
 public:
  explicit Person(std::uint64_t seed)
      : random_(seed),
        world_({A::body(0), A::body(1)}, {}, seed + 1),
        scene_(led_scene()),
        memory_(std::make_unique<Memory>()),
        box_(1) {
    world_.step();
    scene_.start(*memory_, world_.joints(0));
    box_[0].known = true;
    last_ = place().origin();
  }
  std::optional<Lesson> teach() {
    Lesson lesson;
    lesson.meant = {in(-0.08, -0.02), in(-0.05, 0.05), in(0.045, 0.06)};
    lead({lesson.meant.x, lesson.meant.y, 0.2}, in(1.5, 2.5));
    lead(lesson.meant, in(1.0, 2.0));
    for (int i = 0; i < 1000 && norm(Xyz<double>(place().origin() - lesson.meant)) > 0.004; ++i)
      lead(lesson.meant, 0.008);
    lead(lesson.meant, 0.4);
    const Xyz<double> last = force_;
    grip_ = 0;
    for (double t = 0; t < 0.1; t += 0.008) step((1 - t / 0.1) * last);  // the hand lets go
    for (double t = 0; t < 1.5; t += 0.008) step({0, 0, 0});
    lesson.rested = place().origin();
    for (double t = 0; t < 0.2; t += 0.008) {
      closed_ = t < 0.1;
      step({0, 0, -6 * std::sin(M_PI * t / 0.2)});  // on the switch: it moves the arm
    }
    for (double t = 0; t < 0.4; t += 0.008) step({0, 0, 0});
    lesson.lasted = seconds<double>(world_.now());
    bool any = false;
    for (const auto& t : reader_.finish(box_)) {
      if (t.activity == Activity::put && t.object == 0) lesson.taught = t.X_OH.origin(), any = true;
      lesson.released = lesson.released || t.activity == Activity::release;
    }
    return any ? std::optional(lesson) : std::nullopt;
  }

 private:
  using Scene = decltype(led_scene());
  using Memory = Scene::Memory;
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  [[nodiscard]] Transform<skinctl::World, Tool> place() const {
    return A::base(0) * A::hand(world_.joints(0).q);
  }

  /// The person's arm: a spring with a damper to a target that moves to `goal`, at most 40 N.
  void lead(const Xyz<double>& goal, double time) {
    const Xyz<double> from = place().origin();
    for (double t = 0; t < time; t += 0.008) {
      const double u = std::min(1.0, (t + 0.008) / time), s = u * u * u * (10 + u * (6 * u - 15));
      const Xyz<double> p = place().origin(), target = from + s * Xyz<double>(goal - from);
      v_ = v_ + 0.6 * Xyz<double>(125.0 * Xyz<double>(p - last_) - v_);
      Xyz<double> F = 150.0 * Xyz<double>(target - p) - 25.0 * v_;
      const double size = norm(F);
      if (size > 40) F = (40 / size) * F;
      step(force_ + 0.6 * Xyz<double>(F - force_));
    }
  }
  /// A cycle with a force of the person on the hand, along the world's axes.
  void step(const Xyz<double>& F) {
    force_ = F;
    const auto X = place();
    last_ = X.origin();
    const auto X_BL = link_poses(A::Model{}, world_.joints(0).q).get<5>();
    const Xyz<double> f = turn_back((A::base(0) * X_BL).axes(), F);
    world_.push(0, hand, {0, 0, middle}, f);
    const double parts[3] = {f.x, f.y, f.z};
    std::array<CellSample, 6> samples{};
    double touch = 0;
    for (std::size_t k = 0; k < 6; ++k) {
      const double side =
          k % 2 == 0 ? -parts[k / 2] : parts[k / 2];  // a cell feels what pushes on it from outside
      const double newton = std::max(0.0, side) + (k < 2 ? grip_ : 0) + std::abs(noise_(random_));
      touch += newton;
      const auto reading = static_cast<float>(std::min(newton / (3 * newtons_per_reading), 1.0));
      samples[k] = {.time = world_.now(),
                    .cell = static_cast<std::uint32_t>(k + 1),
                    .force = {reading, reading, reading}};
    }
    Scene::Input input;
    input.now = world_.now();
    input.measured = world_.joints(0);
    input.samples = samples;
    const auto out = scene_.step(*memory_, input);
    if (out.command.valid) world_.command(0, out.command.position, out.command.velocity);
    reader_.take({world_.now(), X, touch, closed_ ? 4.0 : 0.0, closed_, Activity::unknown}, box_);
    for (int i = 0; i < 8; ++i) world_.step();
  }

  std::mt19937_64 random_;
  std::normal_distribution<double> noise_{0, 0.02};
  packing::World world_;
  Scene scene_;
  std::unique_ptr<Memory> memory_;
  std::vector<Object<>> box_;  ///< the only object: its frame is the world's
  DemonstrationReader<> reader_{{.near_object = 0.2}};
  Xyz<double> force_{0, 0, 0}, v_{0, 0, 0}, last_{0, 0, 0};
  double grip_ = 2;  ///< two sides of the hand are held with this [N]
  bool closed_ = true;
};
}  // namespace

std::optional<Lesson> teach(std::uint64_t seed) {
  return Person(seed * 7919 + 11).teach();
}

}  // namespace packing
