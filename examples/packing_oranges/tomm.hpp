// The robot: two arms that face each other, as on TUM's TOMM, each with a gripper and skin on its forearm. Which arm it
// is made of is a type: its model, its shape, how far from the box it stands.
#pragma once

#include <vector>

#include "examples/packing_oranges/arm_body.hpp"
#include "examples/packing_oranges/arm_skin.hpp"
#include "examples/packing_oranges/gripper.hpp"
#include "examples/packing_oranges/hand_room.hpp"
#include "examples/packing_oranges/obstacle.hpp"
#include "examples/packing_oranges/process.hpp"
#include "skinctl/semantics/skill_map.hpp"
#include "skinctl/skinctl.hpp"

namespace packing {

/// A UR5 and where it stands.
struct Ur5 {
  using Model = skinctl::ur5::Model;
  using Description = skinctl::ur5::Description;
  static constexpr const char* name = "UR5";
  static constexpr double flange = Description::d6;
  static constexpr double stands = 0.6;  ///< from the middle of the box [m]
  static constexpr double reach = 1.3;   ///< of the hand, from any joint axis [m], at most
  static constexpr HandRoom room{stands, Description::d1, -(Description::a2 + Description::a3),
                                 Description::d4, Description::d5 + Description::d6};
  /// Cells on the upper arm, both inner wrists, the last link with the hand, and those of the forearm that only see.
  static constexpr std::size_t cells[] = {63, 18, 18, 74, 77};
  /// The tubes that skin covers; the half spheres at the ends of a capsule take 30 mm of the wrists.
  static constexpr auto shapes = [] {
    std::array<skinctl::Capsule<>, 6> out{};
    for (std::size_t i = 0; i < 6; ++i) {
      const skinctl::ur5::Tube& t = skinctl::ur5::tubes[i];
      out[i] = {t.from, t.to, t.radius};
      if (i == 3 || i == 4) out[i].to.z -= 0.03;
    }
    return out;
  }();
};

namespace behaviour {
struct Rest {
  static constexpr const char* name = "rest";
};
struct Grasp {
  static constexpr const char* name = "grasp";
};
struct LetGo {
  static constexpr const char* name = "let_go";
};
/// What is seen and not known is given way to by the whole arm: every joint moves as `Retreat` plans anew each cycle.
struct GiveWay {
  static constexpr const char* name = "give_way";
};
/// Back to the joints from where it gave way.
struct Return {
  static constexpr const char* name = "return";
};
/// `Squeezing` of a gripper that is only open or closed: it closes, then the wrist presses, as the paper has it.
struct ClosingToPress {
  static constexpr const char* name = "closing_to_press";
};
using skinctl::behaviour::ForceCartesian;
using skinctl::behaviour::Putting;
using skinctl::behaviour::Reaching;
using skinctl::behaviour::Squeezing;
}  // namespace behaviour

/// The skills: all hold or move the hand along splines and give way to touch; what differs is when they are finished,
/// and what the gripper does.
inline constexpr auto skills_of_tomm = [] {
  using namespace skinctl;
  constexpr auto law = recipe(load<controller::Gravity>(), load<controller::SkinJoint>(),
                              load<controller::SplineOperational>());
  constexpr SkillConditions there{.finish = SkillFinish::settled, .hold = 16ms};
  constexpr SkillConditions gripped{.finish = SkillFinish::gripped, .hold = 24ms};
  constexpr SkillConditions opened{.finish = SkillFinish::opened, .hold = 16ms};
  return boost::hana::make_map(
      skill<behaviour::Rest>(law), skill<behaviour::Reaching>(law.when(there)),
      skill<behaviour::Putting>(law.when(there)),
      skill<behaviour::Grasp>(law.gripping({0, 0.8, 0.08}).when(gripped)),
      skill<behaviour::Squeezing>(law.gripping({0, 6.8, 0.015}).when(gripped)),
      skill<behaviour::ClosingToPress>(
          law.gripping({0, 6.8, 0.08}).when(gripped).then<behaviour::ForceCartesian>()),
      skill<behaviour::ForceCartesian>(
          recipe(load<controller::Gravity>(), load<controller::SkinJoint>(), load<controller::Force>())
              .when({.finish = SkillFinish::elapsed, .hold = 1500ms})),
      skill<behaviour::LetGo>(law.gripping({0.11, 5, 0.15}).when(opened)),
      skill<behaviour::GiveWay>(
          recipe(load<controller::Gravity>(), load<controller::SkinJoint>(), load<controller::Velocity>())),
      skill<behaviour::Return>(
          recipe(load<controller::Gravity>(), load<controller::SkinJoint>(), load<controller::SplineJoint>())
              .when(there)));
}();

/// What each activity of the plan is for this robot.
template <class Squeezes>
inline constexpr auto done_by_tomm = boost::hana::make_map(
    skinctl::done_by<skinctl::activity::Look, behaviour::Rest>(),
    skinctl::done_by<skinctl::activity::ReachAbove, behaviour::Reaching>(),
    skinctl::done_by<skinctl::activity::Reach, behaviour::Reaching>(),
    skinctl::done_by<skinctl::activity::Take, behaviour::Grasp>(),
    skinctl::done_by<skinctl::activity::Squeeze, Squeezes>(),
    skinctl::done_by<SetDown, behaviour::ForceCartesian>(), skinctl::done_by<Lift, behaviour::Putting>(),
    skinctl::done_by<skinctl::activity::Carry, behaviour::Putting>(),
    skinctl::done_by<skinctl::activity::Use, behaviour::Putting>(),
    skinctl::done_by<skinctl::activity::Find, behaviour::Rest>(),
    skinctl::done_by<FindRoom, behaviour::Rest>(),
    skinctl::done_by<skinctl::activity::Put, behaviour::Putting>(),
    skinctl::done_by<skinctl::activity::Release, behaviour::LetGo>(),
    skinctl::done_by<GoBack, behaviour::Reaching>(), skinctl::done_by<DriveToOranges, behaviour::Reaching>(),
    skinctl::done_by<DriveToBox, behaviour::Putting>(),
    skinctl::done_by<skinctl::activity::Reverse, behaviour::Putting>());

inline constexpr auto tomm = done_by_tomm<behaviour::Squeezing>;
/// The same where its grippers are only open or closed.
inline constexpr auto tomm_binary = done_by_tomm<behaviour::ClosingToPress>;

inline constexpr double newtons_per_reading = 20;
inline constexpr std::size_t forearm = 2, forearm_cells = 40;

/// What an arm keeps clear of: the other arm's links and hand, and what its skin sees.
inline constexpr std::size_t near_most = 16;

/// One arm of the robot.
template <class R>
struct Arm {
  using Model = typename R::Model;
  static constexpr skinctl::Nanoseconds period = 8ms, delay = 8ms, lag = 2ms;

  /// The second one stands on the other side, turned by half a circle.
  static skinctl::Transform<skinctl::World, skinctl::Base> base(std::size_t arm) {
    using Pose = skinctl::Transform<skinctl::World, skinctl::Base>;
    return arm == 0 ? Pose({{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}, {-R::stands, 0, 0})
                    : Pose({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {R::stands, 0, 0});
  }
  static skinctl::Transform<skinctl::Link<5>, skinctl::Tool> tool() {
    return skinctl::Transform<skinctl::Link<5>, skinctl::Tool>::translation_xyz(0, 0,
                                                                                R::flange + reach_of_gripper);
  }
  /// The same on a robot that stands at `X_WR`.
  static skinctl::Transform<skinctl::World, skinctl::Base> base(
      std::size_t arm, const skinctl::Transform<skinctl::World, skinctl::Base>& X_WR) {
    return X_WR.renamed<skinctl::World, skinctl::Root>() * base(arm).renamed<skinctl::Root, skinctl::Base>();
  }
  /// The hand points down, on its own side of the box.
  static skinctl::JointPosition<6> home() { return {-0.5, -1.75, 1.9, -1.72, -1.57, -0.5}; }
  static ArmBody body(std::size_t arm) { return arm_body(Model{}, R::shapes, R::flange, base(arm), home()); }

  static auto robot() {
    using namespace skinctl;
    return by_position(Model{}, {.limits = limits_of<typename R::Description>(15.0),
                                 .period = period,
                                 .delay = delay,
                                 .lag = lag,
                                 .virtual_damping = 10});
  }
  /// The links' shapes, and the hand with what it holds: what must not meet the other arm.
  static skinctl::ClearanceAround<near_most> clearance() {
    skinctl::ClearanceAround<near_most> c;
    for (std::size_t i = 0; i < 6; ++i) c.own.capsules.push_back({i, R::shapes[i]});
    c.own.capsules.push_back({5, around_hand});
    c.own.margin = 0.02;
    c.own.reach = R::reach;
    c.exposed = {0, 1, 2, 3, 4, 5, 6};
    return c;
  }
  /// The same, and what an arm that gives way keeps clear of by itself: its own links, the table, the walls of the trays.
  static skinctl::ClearanceAround<near_most> clearance_at_work(std::size_t arm = 0,
                                                               const Trays& trays = first_trays) {
    using namespace skinctl;
    auto c = clearance();
    auto& own = c.own.capsules;
    const auto add = [&](std::size_t link, const Capsule<>& shape) {
      own.push_back({link, shape});
      return own.size() - 1;
    };
    const auto meet = [&](std::initializer_list<std::size_t> parts, std::size_t with) {
      for (const std::size_t part : parts) c.own.pairs.push_back({part, with});
    };
    const auto ground = [&](double z) {
      return add(LinkCapsule::fixed, {{0, 0, z - 100}, {0, 0, z - 100}, 100});
    };
    meet({2, 4, 5, 6}, 0), meet({4, 5, 6}, 1);
    // Only the hand goes down between the walls, with its fingers as far apart as they go.
    constexpr double palm = R::flange + 0.03, tips = R::flange + reach_of_gripper;
    meet({2, 3, 4, 5}, ground(box_tray.wall));
    const auto finger = [&](double y, double more, double radius) {
      return add(5, {{0, y, palm}, {0, y, tips + more}, radius});
    };
    const std::size_t left = finger(0.05, 0.01, 0.015), right = finger(-0.05, 0.01, 0.015);
    meet({finger(0.06, 0, 0.004), finger(-0.06, 0, 0.004)}, ground(0.004));
    const std::size_t held =
        add(5, {{0, 0, tips}, {0, 0, tips}, 0.042});  // an orange hangs lower than the fingers
    const auto X_BW = base(arm).inverse();
    const auto edge = [&](const Tray& t, double x0, double y0, double x1, double y1) {
      constexpr double half = 0.004;  // of the wall
      const auto at = [&](double x, double y) {
        return X_BW.origin() + X_BW.axes() * Xyz<double>{t.x + x * (t.half_x + half),
                                                         t.y + y * (t.half_y + half), t.wall - half};
      };
      meet({left, right, held}, add(LinkCapsule::fixed, {at(x0, y0), at(x1, y1), half}));
    };
    for (const Tray& t : trays)
      edge(t, -1, -1, 1, -1), edge(t, 1, -1, 1, 1), edge(t, 1, 1, -1, 1), edge(t, -1, 1, -1, -1);
    return c;
  }
  /// The same for an arm that holds nothing and goes nowhere between walls: its hand is one capsule, and its forearm and
  /// first wrist stay above the walls of all trays.
  static skinctl::ClearanceAround<near_most> clearance_empty_handed() {
    using namespace skinctl;
    auto c = clearance();
    for (const double z : {0.0, box_tray.wall})  // the table, and all that is on it
      c.own.capsules.push_back({LinkCapsule::fixed, {{0, 0, z - 100}, {0, 0, z - 100}, 100}});
    c.own.pairs = {{0, 2}, {0, 4}, {0, 5}, {0, 6}, {1, 4}, {1, 5}, {1, 6},
                   {1, 7}, {2, 8}, {3, 8}, {4, 7}, {5, 7}, {6, 7}};
    const auto wall = [&](const Tray& t, double x0, double y0, double x1, double y1) {
      const auto X_BW = base(0).inverse();  // the other arm has its trays at the same places
      const auto at = [&](double x, double y) {
        return X_BW.origin() + X_BW.axes() * Xyz<double>{t.x + x * t.half_x, t.y + y * t.half_y, t.wall / 2};
      };
      for (const std::size_t part : {4u, 5u, 6u}) c.own.pairs.push_back({part, c.own.capsules.size()});
      c.own.capsules.push_back({LinkCapsule::fixed, {at(x0, y0), at(x1, y1), t.wall / 2}});
    };
    for (const Tray& t : {box_tray, bin_tray(0), bin_tray(1)})
      wall(t, -1, -1, 1, -1), wall(t, 1, -1, 1, 1), wall(t, 1, 1, -1, 1), wall(t, -1, 1, -1, -1);
    return c;
  }
  /// Where the links are in the world; and their shapes, and the hand's.
  using LinkPlaces = std::array<skinctl::Transform<skinctl::World, skinctl::Tool>, 6>;
  static LinkPlaces link_places(std::size_t arm, const skinctl::JointPosition<6>& q) {
    LinkPlaces out;
    const auto poses = skinctl::link_poses(Model{}, q);
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((out[I] = (base(arm) * poses.template get<I>()).template renamed<skinctl::World, skinctl::Tool>()),
       ...);
    }(std::make_index_sequence<6>());
    return out;
  }
  static std::vector<skinctl::Capsule<>> shapes_at(const LinkPlaces& links) {
    std::vector<skinctl::Capsule<>> out;
    for (std::size_t k = 0; k < 7; ++k) {
      const auto& X = links[k < 6 ? k : 5];
      const skinctl::Capsule<> s = k < 6 ? R::shapes[k] : around_hand;
      out.push_back({X.origin() + X.axes() * s.from, X.origin() + X.axes() * s.to, s.radius});
    }
    return out;
  }
  /// Links and palm, where they are in the world.
  static std::vector<skinctl::Capsule<>> parts(std::size_t arm, const skinctl::JointPosition<6>& q) {
    std::vector<skinctl::Capsule<>> out;
    const auto poses = skinctl::link_poses(Model{}, q);
    const auto put = [&](const auto& X_BL, const skinctl::Capsule<>& s) {
      const auto X = base(arm) * X_BL;
      out.push_back({X.origin() + X.axes() * s.from, X.origin() + X.axes() * s.to, s.radius});
    };
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (put(poses.template get<I>(), R::shapes[I]), ...);
    }(std::make_index_sequence<6>());
    put(poses.template get<5>(), {{0, -0.03, R::flange + 0.03}, {0, 0.03, R::flange + 0.03}, 0.03});
    return out;
  }
  static std::array<skinctl::Capsule<>, 2> fingers(std::size_t arm, const skinctl::JointPosition<6>& q,
                                                   double opening) {
    std::array<skinctl::Capsule<>, 2> out;
    const auto X = base(arm) * hand(q);
    for (std::size_t f = 0; f < 2; ++f) {
      const double y = (f == 0 ? 0.5 : -0.5) * opening + (f == 0 ? 0.006 : -0.006);
      out[f] = {X.origin() + X.axes() * skinctl::Xyz<double>{0, y, -0.12},
                X.origin() + X.axes() * skinctl::Xyz<double>{0, y, 0.015}, 0.008};
    }
    return out;
  }
  static std::vector<skinctl::PlacedCell<forearm>> cells() {
    using namespace skinctl;
    const Capsule<>& s = R::shapes[forearm];
    const Xyz<double> middle = 0.5 * (s.from + s.to);
    return cover(
        Transform<Link<forearm>, Surface>({{0.0, 1.0, 0.0}, {0.0, 0.0, -1.0}, {-1.0, 0.0, 0.0}}, middle),
        CylinderSurface{s.radius, norm(Xyz<double>(s.to - s.from))}, forearm_cells, 1);
  }
  /// The palm and what it holds, as a capsule of the last link.
  static constexpr skinctl::Capsule<> around_hand{
      {0, 0, R::flange + 0.03}, {0, 0, R::flange + reach_of_gripper}, 0.08};
  /// Cells of the forearm feel what touches them; all see what is near. Ids count from 1 in the order of the patches:
  /// those that feel come first.
  static auto skin() {
    using namespace skinctl;
    SkinSettings settings;
    settings.force = EventGate<>::dead_band(0.02);
    const CellGains gains{.force = newtons_per_reading, .proximity = 0};
    constexpr auto& c = R::cells;
    const auto first = [](std::size_t before) { return static_cast<std::uint32_t>(before + 1); };
    constexpr std::size_t inner = c[0] + forearm_cells, outer = inner + c[1], last = outer + c[2],
                          more = last + c[3];
    using Cells = Skin<Model, double, Patch<forearm, forearm_cells>, Patch<1, c[0]>, Patch<3, c[1]>,
                       Patch<4, c[2]>, Patch<5, c[3]>, Patch<forearm, c[4]>>;
    const Cells all(
        Patch<forearm, forearm_cells>(cells(), gains),
        Patch<1, c[0]>(cells_around<1>({R::shapes[1]}, first(forearm_cells)), gains),
        Patch<3, c[1]>(cells_around<3>({R::shapes[3]}, first(inner)), gains),
        Patch<4, c[2]>(cells_around<4>({R::shapes[4]}, first(outer)), gains),
        Patch<5, c[3]>(cells_around<5>({R::shapes[5], around_hand}, first(last)), gains),
        Patch<forearm, c[4]>(cells_around<forearm>({R::shapes[forearm]}, first(more), 1.2), gains), settings);
    return ArmSkin<Cells>(all, forearm_cells);
  }
  /// Share of the wrist's force that the arm yields to while it presses: with all of it the virtual arm, a few kg on an
  /// orange of 6 kN/m, swings with 1.5 N at some 35 rad/s.
  static constexpr double yields_to_press = 0.1;
  /// The skin, and the wrist's force sensor, which is read while the wrist presses.
  static auto touch() {
    return skin() + skinctl::wrist_sensor<5>(
                        Model{}, {.X_LS = tool().template renamed<skinctl::Link<5>, skinctl::ForceSensor>(),
                                  .gain = yields_to_press});
  }
  /// No place of the forearm leads faster than a body of 3 kN/m that it meets allows, with at most 65 N, by the least
  /// force that is noticed there: as the main job, with its numbers.
  static skinctl::FeltPlaces<forearm_cells> felt_places() {
    return {.places = skin().felt(forearm_cells),
            .force = 65,
            .stiffness = 3e3,
            .deceleration = 3,
            .reaction_time = 2 * period + delay + lag,
            .newtons = 3 * newtons_per_reading};
  }
  /// The cycle of an arm among trays that stand there.
  static auto scene(std::size_t number = 0, const Trays& trays = first_trays) {
    using namespace skinctl;
    const auto arm = robot();
    const auto clear = clearance_at_work(number, trays);
    auto o = operational_settings(arm);
    o.tracking.lambda = 40;
    o.tracking.K_c = 6;  // an arm that was pushed aside comes back at 6 times the way in a second
    o.tracking.max_velocity = JointVelocity<6>::constant(2.0);
    o.max_linear_velocity = 1.0;
    o.max_angular_velocity = 3.0;
    ForceSettings<6>
        force;  // 0.0025 m/(s N) is stable up to 10 kN/m; no integrals: nothing is held with a force
    force.pose = o;
    force.K_i1 = force.K_i2 = 0;
    force.K_p = 0.0025 / yields_to_press;
    force.max_velocity = 0.004;
    force.max_travel = 0.02;
    return Cycle(
               arm, touch(),
               // What comes near is given way to at once, also by an arm that pulled hard at something that held it.
               skill_set<behaviour::Rest>(
                   skills_of_tomm, {.bumpless_transfer = 40ms, .max_rate = 5000}, OneGripper(gripper_range),
                   skill_controller<controller::Gravity>(GravityControl{}),
                   skill_controller<controller::SkinJoint>(SkinJointControl{}),
                   skill_controller<controller::Velocity>(VelocityControl<6>{}),
                   skill_controller<controller::Force>(ForceControl<6, 5>(tool(), force)),
                   skill_controller<controller::SplineJoint>(SplineJoint(arm)),
                   skill_controller<controller::SplineOperational>(SplineOperational(tool(), o))))
        .with(clear, felt_places());
  }
  using Scene = decltype(scene());
  using Set = typename Scene::law_type;
  static constexpr auto skills = skinctl::skill_map<Set>(tomm, all_that_is_done);
  static constexpr auto binary_skills = skinctl::skill_map<Set>(tomm_binary, press_oranges);

  static skinctl::Transform<skinctl::Base, skinctl::Tool> hand(const skinctl::JointPosition<6>& q) {
    return skinctl::link_poses(Model{}, q).template get<5>() * tool();
  }
};

}  // namespace packing
