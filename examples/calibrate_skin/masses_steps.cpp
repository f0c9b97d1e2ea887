// Torques and masses.
#include <algorithm>

#include "examples/calibrate_skin/json_values.hpp"
#include "examples/calibrate_skin/masses.hpp"
#include "examples/calibrate_skin/step_functions.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "examples/support/text.hpp"

namespace calibrate_skin {

using namespace skinctl;
using examples::text;

Json torques_step(const World& world, const Options& options) {
  if (!read_json(options.folder / "lines.json").at("complete").get<bool>())
    return {{"time", Json::array()}, {"said", "not all axes are known: nothing moved"}};
  const PlannedMotion planned = masses_motion();
  ask(options, planned.announcements);
  Arm arm(options.arm, world.robot());
  static_cast<void>(arm.go(options.arm.robot.home));
  const Ride ride = arm.follow(planned.path, planned.duration);
  return {{"time", ride.measured.time},
          {"joints", rows_of(ride.measured.q)},
          {"torques", rows_of(ride.torque)},
          {"said", text("%zu readings of six currents, %.0f s", ride.measured.time.size(),
                        ride.measured.time.back())}};
}

Json masses_step(const World& world, const Options& options) {
  const auto axes = axes_of<6>(read_json(options.folder / "lines.json"));
  const Json recording = read_json(options.folder / "torques.json");
  if (!axes.model) return {{"unobservable", Json::array()}, {"said", "not all axes are known: no masses"}};
  JointRecording joints{recording.at("time").get<std::vector<double>>(),
                        matrix_of_rows(recording.at("joints"))};
  const FoundMasses found = fit_masses(*axes.model, joints, matrix_of_rows(recording.at("torques")));
  if (!found.converged) throw std::runtime_error("the fit of masses did not end at its minimum");
  const auto [least, most] = std::minmax_element(found.predicted.begin(), found.predicted.end());
  Json out = {
      {"bodies", found.masses.bodies},
      {"viscous", found.masses.viscous},
      {"coulomb", found.masses.coulomb},
      {"rotor", found.masses.rotor},
      {"presliding", found.presliding},
      {"noise", found.noise},
      {"lateness", found.lateness},
      {"base", {{"values", found.values}, {"deviations", found.deviations}, {"of", 60}}},
      {"predicted", found.predicted},
      {"predicted_by_maker", found.predicted_by_maker},
      {"unobservable",
       {{{"what",
          text("%d of 60 numbers of the bodies: they take part in no torque, and are what a body that "
               "has the others may have",
               60 - found.base)},
         {"deviation", Json()},
         {"unit", ""},
         {"remedy", ""}},
        {{"what", "scale of all masses and of friction: torque per ampere is taken from elsewhere"},
         {"deviation", Json()},
         {"unit", ""},
         {"remedy", "a known mass at the flange, in another recording"}}}}};
  std::string said = text(
      "%d base parameters and friction of six joints; currents come %.1f ms late; torques that the fit has "
      "not seen: R^2 %.3f to %.3f",
      found.base, 1e3 * found.lateness, *least, *most);
  if (options.arm.host.empty()) {
    ask(options,
        {"another simulated robot follows a motion of 10 s by torque, with what was found and with the "
         "maker's bodies"});
    const FoundModel model = with_bodies(*axes.model, found.masses);
    RobotMasses no_rotors = found.masses;  // the maker gives none
    no_rotors.rotor = {};
    const double by_found = following_error(world.robot(), &model, found.masses),
                 by_maker = following_error(world.robot(), nullptr, no_rotors),
                 with_rotors = following_error(world.robot(), nullptr, found.masses);
    out["following"] = {{"found", by_found}, {"maker", by_maker}, {"maker_with_rotors", with_rotors}};
    said += text(
        "; by torque the arm follows to %.1f mrad, with the maker's bodies to %.1f, and with the rotors that "
        "were "
        "found to %.1f",
        1e3 * by_found, 1e3 * by_maker, 1e3 * with_rotors);
  }
  out["said"] = said;
  return out;
}

}  // namespace calibrate_skin
