#include "examples/compliant_ur5/settings.hpp"

#include "examples/support/toml_table.hpp"
#include "skinctl/core/contract.hpp"

namespace compliant_ur5 {
using Table = examples::TomlTable;

void read_scenario(const std::string& file, Settings& settings) {
  const toml::table root = examples::read_toml(file);
  if (const auto* run = root["run"].as_table()) {
    Table t(file, "run", *run);
    t.number("duration", settings.duration);
    t.finish();
  }
  if (const auto* control = root["control"].as_table()) {
    Table t(file, "control", *control);
    auto& c = settings.control;
    t.number("lambda", c.lambda);
    t.number("K_c", c.K_c);
    t.number("K_i1", c.K_i1);
    t.number("stiffest_wall", c.stiffest_wall);
    t.number("stiffest_hand", c.stiffest_hand);
    t.number("heaviest_hand", c.heaviest_hand);
    t.number("K_i2", c.K_i2);
    t.number("decay", c.decay);
    t.numbers("viscous", c.viscous, true);
    t.numbers("force_gain", c.force_gain, true);
    t.number("force_threshold", c.force_threshold);
    t.numbers("virtual_inertia", c.virtual_inertia, true);
    t.number("max_velocity", c.max_velocity);
    t.number("force_limit", c.force_limit);
    t.number("stopping", c.stopping);
    t.number("skin_patience", c.skin_patience);
    t.number("velocity_limit", c.velocity_limit);
    t.number("acceleration_limit", c.acceleration_limit);
    t.number("delay", c.delay);
    t.number("lag", c.lag);
    t.number("delay_margin", c.delay_margin);
    t.number("state_patience", c.state_patience);
    t.finish();
  }
  if (const auto* torque = root["torque"].as_table()) {
    Table t(file, "torque", *torque);
    auto& c = settings.torque;
    t.number("lambda", c.lambda);
    t.number("K_c", c.K_c);
    t.numbers("viscous", c.viscous, true);
    t.numbers("motor_inertia", c.motor_inertia, true);
    t.numbers("viscous_scale", c.viscous_scale, true);
    t.numbers("coulomb_scale", c.coulomb_scale, true);
    t.number("learning", c.learning);
    t.numbers("most_friction", c.most_friction, true);
    t.number("dead_zone", c.dead_zone);
    t.number("patience", c.patience);
    t.number("delay_margin", c.delay_margin);
    t.finish();
  }
  if (const auto* wrist = root["wrist_control"].as_table()) {
    Table t(file, "wrist_control", *wrist);
    auto& c = settings.wrist;
    t.number("gain", c.gain);
    t.number("threshold", c.threshold);
    t.number("moment_threshold", c.moment_threshold);
    t.number("noise", c.noise);
    t.number("moment_noise", c.moment_noise);
    t.number("reach", c.reach);
    t.finish();
  }
  if (const auto* motors = root["motor_control"].as_table()) {
    Table t(file, "motor_control", *motors);
    auto& c = settings.motors;
    t.number("gain", c.gain);
    t.number("rate", c.rate);
    t.numbers("damping", c.damping, true);
    t.number("stiffest", c.stiffest);
    t.numbers("threshold", c.threshold, true);
    t.numbers("noise", c.noise, true);
    t.numbers("rotor_inertia", c.rotor_inertia, true);
    t.numbers("viscous", c.viscous, true);
    t.numbers("coulomb", c.coulomb, true);
    t.numbers("torque_constant", c.torque_constant, true);
    t.finish();
  }
  if (const auto* clear = root["clear"].as_table()) {
    Table t(file, "clear", *clear);
    auto& c = settings.clear;
    t.number("margin", c.margin);
    t.number("table", c.table);
    t.number("tool_length", c.tool_length);
    t.number("tool_radius", c.tool_radius);
    t.number("approach", c.approach);
    t.number("proximity_share", c.proximity_share);
    t.finish();
  }
  if (const auto* skin =
          root["skin"].as_table()) {  // the simulation reads the same table and checks its keys
    settings.newtons_per_reading = (*skin)["newtons_per_reading"].value_or(settings.newtons_per_reading);
    settings.rest_reading = (*skin)["rest_reading"].value_or(settings.rest_reading);
    settings.force_delta = (*skin)["force_delta"].value_or(settings.force_delta);
    settings.clear.proximity_distance =
        (*skin)["proximity_distance"].value_or(settings.clear.proximity_distance);
  }
  if (const auto* goals = root["goal"].as_array()) {
    for (const auto& node : *goals) {
      const auto* goal = node.as_table();
      if (goal == nullptr) skinctl::refuse(file + ": goal must be an array of tables, [[goal]]");
      Goal g;
      Table t(file, "goal", *goal);
      t.number("at", g.at);
      if (!t.numbers("q", g.q)) t.refuse_at("q", "6 numbers");
      t.number("duration", g.duration);
      t.finish();
      settings.task.push_back(g);
    }
  }
  skinctl::require(settings.duration > 0 && settings.duration <= 86400, "run.duration", settings.duration,
                   "> 0, <= 86400 s");
  skinctl::require(settings.control.skin_patience >= 0.5 && settings.control.skin_patience <= 3600,
                   "control.skin_patience", settings.control.skin_patience, "0.5 to 3600 s");
  for (const double margin : {settings.control.delay_margin, settings.torque.delay_margin})
    skinctl::require(margin >= 0.001 && margin <= 1, "delay_margin", margin, "0.001 to 1 s");
  skinctl::require(settings.control.state_patience >= 0.1 && settings.control.state_patience <= 2,
                   "control.state_patience", settings.control.state_patience, "0.1 to 2 s");
  skinctl::require(settings.torque.patience >= 0.004 && settings.torque.patience <= 2, "torque.patience",
                   settings.torque.patience, "0.004 to 2 s");
  skinctl::require(settings.newtons_per_reading > 0, "skin.newtons_per_reading", settings.newtons_per_reading,
                   "> 0 N");
  skinctl::require(settings.clear.proximity_distance > 0 && settings.clear.proximity_distance <= 1,
                   "skin.proximity_distance", settings.clear.proximity_distance, "> 0, <= 1 m");
}

}  // namespace compliant_ur5
