#include "examples/compliant_ur5/recorder.hpp"

#include <nlohmann/json.hpp>

#include "examples/compliant_ur5/skin.hpp"
#include "examples/support/sha256.hpp"
#include "skinctl/io/detail/read_text.hpp"
#include "skinctl/io/skin_export.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/urdf_writer.hpp"
#include "skinctl/robots/ur5_links.hpp"
#include "skinctl/robots/ur5_skin.hpp"

namespace compliant_ur5 {

using namespace skinctl;

namespace {

UrdfDress::Limit limits_of_joint(const Settings& s, std::size_t i) {
  using D = ur5::Description;
  return {D::lower[i], D::upper[i], s.control.velocity_limit, D::max_torque[i]};
}

}  // namespace

RunDescription run_description(const Settings& s) {
  RunDescription run;
  run.joints = {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};
  run.laws = {"spline joint", "skin joint", "gravity"};
  run.frames = frames_of<ur5::Ros2Links>();
  run.places = places_of(ur5::Model{});
  UrdfDress dress{.name = "ur5", .joints = run.joints};
  for (std::size_t i = 0; i < 6; ++i) {
    dress.links.push_back("joint_" + std::to_string(i + 1) +
                          "_body");  // the maker's names are those of its frames
    dress.limits.push_back(limits_of_joint(s, i));
    dress.capsules.push_back({i, {ur5::tubes[i].from, ur5::tubes[i].to, ur5::tubes[i].radius}});
  }
  dress.named_links.assign(ur5::Ros2Links::named_links.begin(), ur5::Ros2Links::named_links.end());
  run.urdf = urdf_text(ur5::Model{}, dress);
  run.newtons = static_cast<float>(s.newtons_per_reading);
  if (s.sense == Sense::skin) add_cells(run, skin_patches(s));
  std::array<CellGains, 6> gains;
  for (std::size_t i = 0; i < 6; ++i)
    gains[i] = {.force = s.control.force_gain[i], .proximity = proximity_gain(s, i)};
  run.layout =
      s.skin.empty() ? skin_file_text(ur5_skin_file<cells>(gains)) : skinctl::detail::read_text(s.skin);
  return run;
}

RunIdentity run_identity(const Settings& s) {
  const auto& c = s.control;
  nlohmann::ordered_json all = {{"robot", "UR5"},
                                {"interface", s.interface == Interface::position   ? "position"
                                              : s.interface == Interface::velocity ? "velocity"
                                                                                   : "torque"},
                                {"rate", s.rate},
                                {"rigid", s.rigid},
                                {"trust all cells", s.trust_all_cells},
                                {"newtons per reading", s.newtons_per_reading},
                                {"rest reading", s.rest_reading},
                                {"force delta", s.force_delta},
                                {"lambda", c.lambda},
                                {"K_c", c.K_c},
                                {"K_i1", c.K_i1},
                                {"K_i2", c.K_i2},
                                {"decay", c.decay},
                                {"viscous", c.viscous},
                                {"force gain", c.force_gain},
                                {"stiffest wall", c.stiffest_wall},
                                {"stiffest hand", c.stiffest_hand},
                                {"heaviest hand", c.heaviest_hand},
                                {"force threshold", c.force_threshold},
                                {"force limit", c.force_limit},
                                {"stopping", c.stopping},
                                {"max velocity", c.max_velocity},
                                {"velocity limit", c.velocity_limit},
                                {"acceleration limit", c.acceleration_limit},
                                {"delay", c.delay},
                                {"lag", c.lag},
                                {"preset", s.preset}};
  if (s.interface == Interface::torque) {
    const auto& t = s.torque;
    all["torque"] = {{"lambda", t.lambda},
                     {"K_c", t.K_c},
                     {"viscous", t.viscous},
                     {"motor inertia", t.motor_inertia},
                     {"viscous scale", t.viscous_scale},
                     {"Coulomb scale", t.coulomb_scale},
                     {"learning", t.learning},
                     {"most friction", t.most_friction},
                     {"dead zone", t.dead_zone},
                     {"patience", t.patience}};
  }
  if (s.keep_clear) {
    const auto& k = s.clear;
    all["clear"] = {{"margin", k.margin},
                    {"table", k.table},
                    {"tool", {k.tool_length, k.tool_radius}},
                    {"approach", k.approach},
                    {"proximity share", k.proximity_share},
                    {"proximity distance", k.proximity_distance}};
  }
  if (s.sense != Sense::skin) all["virtual inertia"] = c.virtual_inertia;
  if (s.sense == Sense::wrist) {
    const auto& w = s.wrist;
    all["wrist"] = {
        {"gain", w.gain},   {"threshold", w.threshold},       {"moment threshold", w.moment_threshold},
        {"noise", w.noise}, {"moment noise", w.moment_noise}, {"reach", w.reach}};
  }
  if (s.sense == Sense::motors) {
    const auto& m = s.motors;
    all["motors"] = {{"gain", m.gain},
                     {"rate", m.rate},
                     {"threshold", m.threshold},
                     {"noise", m.noise},
                     {"rotors", m.rotor_inertia},
                     {"damping", m.damping},
                     {"stiffest", m.stiffest},
                     {"viscous", m.viscous},
                     {"coulomb", m.coulomb}};
  }
  if (s.hand)
    all["hand"] = {{"mass", s.hand->mass}, {"centre", s.hand->centre}, {"palm gain", s.hand->palm_gain}};
  if (!s.skin.empty()) all["skin"] = examples::sha256(skinctl::detail::read_text(s.skin));
  return {all.dump()};
}

}  // namespace compliant_ur5
