// What the examples of laws and behaviours share: a UR5 with 260 cells in a simulated world.
#pragma once

#include <cmath>
#include <memory>

#include "examples/support/arm_sketch.hpp"
#include "examples/support/curves.hpp"
#include "skinctl/skinctl.hpp"

namespace examples {
using namespace skinctl;

inline const JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.0};
/// The flange, 0.1 m along the last axis.
inline const auto tool_on_flange = Transform<Link<5>, Tool>::translation_xyz(0, 0, 0.1);
inline constexpr double newtons_per_reading = 20;

/// Where a tool is when the joints are at `q`.
inline Transform<Base, Tool> tool_at(const JointPosition<6>& q) {
  const ur5::Model model;
  return Poses<ur5::Model, all_links(6)>(model, JointAngles<ur5::Model, double>(model, q)).get<5>() *
         tool_on_flange;
}
/// The arm, commanded by position every 8 ms, which it follows one cycle late. `parts`: what else watches
/// over energy and contacts.
template <class... Parts>
auto ur5_by_position(const Parts&... parts) {
  return by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4},
      parts...);
}
/// It without any, for laws that are built from its description.
inline const auto robot = ur5_by_position();

/// Its skin: 260 cells without noise.
inline auto skin() {
  SkinSettings settings;
  settings.force = EventGate<>::dead_band(0.002);
  return ur5_skin<260>({.force = newtons_per_reading}, settings);
}

/// The arm at work in a simulated world.
template <class Law, class Robot = decltype(ur5_by_position())>
class Arm {
 public:
  using Scene = decltype(Cycle(std::declval<const Robot&>(), skin(), std::declval<const Law&>()));
  using Goal = typename Scene::Goal;

  explicit Arm(const Law& law, const Robot& description = ur5_by_position())
      : scene_(description, skin(), law), memory_(std::make_unique<typename Scene::Memory>()) {
    measured_.q = under_way_ = home;
    scene_.start(*memory_, measured_);
  }
  /// The middle cell of a link.
  template <std::size_t Link>
  [[nodiscard]] static PlacedCell<Link> cell() {
    const auto patches = ur5::skin_patches<260>();
    const auto& patch = std::get<Link>(patches);
    return patch.placed()[patch.placed().size() / 2];
  }
  /// From now on a force of so many newtons on a cell.
  void push(std::uint32_t cell, double force) {
    const auto f = static_cast<float>(force / (3 * newtons_per_reading));
    sample_ = {.cell = cell, .force = {f, f, f}};
  }
  void ask(const Goal& goal) { input_.goal = goal; }
  /// A cycle.
  auto step() {
    measured_.time += 8ms;
    measured_.dq =
        JointVelocity<6>::generate([&](std::size_t i) { return (under_way_[i] - measured_.q[i]) / 0.008; });
    measured_.q = under_way_;
    input_.now = sample_.time = measured_.time;
    input_.measured = measured_;
    input_.samples = {&sample_, 1};
    const auto out = scene_.step(*memory_, input_);
    under_way_ = out.command.position;
    clear_requests(input_);
    if (seen_.size() * 40ms <= measured_.time) seen_.push_back(seen_now());
    return out;
  }
  [[nodiscard]] double time() const { return seconds<double>(measured_.time); }
  [[nodiscard]] const JointPosition<6>& q() const { return measured_.q; }
  [[nodiscard]] Transform<Base, Tool> tool() const { return tool_at(measured_.q); }
  [[nodiscard]] const typename Scene::Memory& memory() const { return *memory_; }
  [[nodiscard]] const Law& law() const { return scene_.law(); }
  /// How it stood and was pushed until now.
  [[nodiscard]] plotting::Head sketch() const { return examples::sketch(seen_); }

 private:
  [[nodiscard]] SeenPose seen_now() const {
    SeenPose out{.q = measured_.q, .pushed = sample_.force[0] > 0, .at = {}, .normal = {}};
    const LinkPoses X = ur5_poses(measured_.q);
    std::apply([&](const auto&... patch) { (place(patch, X, out), ...); }, ur5::skin_patches<260>());
    return out;
  }
  template <class Patch>
  void place(const Patch& patch, const LinkPoses& X, SeenPose& out) const {
    for (const auto& c : patch.placed())
      if (c.id == sample_.cell) {
        const LinkPose& link = X[Patch::link];
        out.at = in_base(link, c.X_LC.origin());
        out.normal = link.axes() * c.X_LC.axis_z();
      }
  }

  Scene scene_;
  std::unique_ptr<typename Scene::Memory> memory_;
  State<6> measured_;
  JointPosition<6> under_way_;
  CellSample sample_{.cell = 1};
  std::vector<SeenPose> seen_;
  typename Scene::Input input_;
};

}  // namespace examples
