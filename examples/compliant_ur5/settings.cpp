#include "examples/compliant_ur5/settings.hpp"

#include <toml++/toml.h>

#include <set>

#include "skinctl/core/contract.hpp"

namespace compliant_ur5 {
namespace {

[[noreturn]] void refuse(const std::string& file, const toml::node& node, const std::string& what) {
  throw skinctl::ConfigurationError(file + ":" + std::to_string(node.source().begin.line) + ": " + what);
}

/// Takes numbers out of a table and complains about what nobody took.
class Table {
 public:
  Table(const std::string& file, const toml::table& table) : file_(file), table_(table) {}

  void number(const char* key, double& value) {
    known_.insert(key);
    const toml::node* node = table_.get(key);
    if (node == nullptr) return;
    const auto x = node->value<double>();
    if (!x) refuse(file_, *node, std::string(key) + " is a number");
    value = *x;
  }
  void six(const char* key, PerJoint& value) {
    known_.insert(key);
    const toml::node* node = table_.get(key);
    const toml::array* list = node != nullptr ? node->as_array() : nullptr;
    if (list == nullptr || list->size() != 6)
      refuse(file_, node != nullptr ? *node : table_, std::string(key) + " is six numbers");
    for (std::size_t i = 0; i < 6; ++i) {
      const auto x = (*list)[i].value<double>();
      if (!x) refuse(file_, *node, std::string(key) + " is six numbers");
      value[i] = *x;
    }
  }
  void one_or_six(const char* key, PerJoint& value) {
    const toml::node* node = table_.get(key);
    if (node != nullptr && node->is_array()) return six(key, value);
    double x = value[0];
    number(key, x);
    if (node != nullptr) value = same(x);
  }
  void done() const {
    for (const auto& [key, node] : table_)
      if (!known_.contains(std::string(key.str())))
        refuse(file_, node, "unknown key '" + std::string(key.str()) + "'");
  }

 private:
  const std::string& file_;
  const toml::table& table_;
  std::set<std::string> known_;
};

}  // namespace

void read_scenario(const std::string& file, Settings& settings) {
  toml::table root;
  try {
    root = toml::parse_file(file);
  } catch (const toml::parse_error& e) {
    throw skinctl::ConfigurationError(file + ":" + std::to_string(e.source().begin.line) + ": " +
                                      std::string(e.description()));
  }
  if (const auto* run = root["run"].as_table()) {
    Table t(file, *run);
    t.number("duration", settings.duration);
    t.done();
  }
  if (const auto* control = root["control"].as_table()) {
    Table t(file, *control);
    auto& c = settings.control;
    t.number("lambda", c.lambda);
    t.number("K_c", c.K_c);
    t.number("K_i1", c.K_i1);
    t.number("stiffest_contact", c.stiffest_contact);
    t.number("K_i2", c.K_i2);
    t.number("decay", c.decay);
    t.one_or_six("viscous", c.viscous);
    t.one_or_six("force_gain", c.force_gain);
    t.number("proximity_gain", c.proximity_gain);
    t.number("force_threshold", c.force_threshold);
    t.number("max_velocity", c.max_velocity);
    t.number("skin_enough", c.skin_enough);
    t.number("skin_reach", c.skin_reach);
    t.number("skin_patience", c.skin_patience);
    t.number("velocity_limit", c.velocity_limit);
    t.number("acceleration_limit", c.acceleration_limit);
    t.number("delay", c.delay);
    t.number("lag", c.lag);
    t.done();
  }
  if (const auto* torque = root["torque"].as_table()) {
    Table t(file, *torque);
    auto& c = settings.torque;
    t.number("lambda", c.lambda);
    t.number("K_c", c.K_c);
    t.one_or_six("viscous", c.viscous);
    t.one_or_six("motor_inertia", c.motor_inertia);
    t.one_or_six("viscous_scale", c.viscous_scale);
    t.one_or_six("coulomb_scale", c.coulomb_scale);
    t.number("learning", c.learning);
    t.one_or_six("most_friction", c.most_friction);
    t.number("dead_zone", c.dead_zone);
    t.number("damping", c.damping);
    t.number("patience", c.patience);
    t.done();
  }
  if (const auto* skin =
          root["skin"].as_table()) {  // the simulation reads the same table and checks its keys
    settings.newtons_per_reading = (*skin)["newtons_per_reading"].value_or(settings.newtons_per_reading);
    settings.rest_reading = (*skin)["rest_reading"].value_or(settings.rest_reading);
    settings.force_delta = (*skin)["force_delta"].value_or(settings.force_delta);
  }
  if (const auto* goals = root["goal"].as_array()) {
    for (const auto& node : *goals) {
      const auto* goal = node.as_table();
      if (goal == nullptr) refuse(file, node, "[[goal]] is a table");
      Goal g;
      Table t(file, *goal);
      t.number("at", g.at);
      t.six("q", g.q);
      t.number("duration", g.duration);
      t.done();
      settings.task.push_back(g);
    }
  }
  skinctl::require(settings.duration > 0 && settings.duration <= 86400, "run.duration", settings.duration,
                   "> 0, <= 86400 s");
  skinctl::require(settings.control.skin_patience >= 0.5 && settings.control.skin_patience <= 3600,
                   "control.skin_patience", settings.control.skin_patience, "0.5 to 3600 s");
  skinctl::require(settings.torque.patience >= 0.004 && settings.torque.patience <= 2, "torque.patience",
                   settings.torque.patience, "0.004 to 2 s");
  skinctl::require(settings.newtons_per_reading > 0, "skin.newtons_per_reading", settings.newtons_per_reading,
                   "> 0 N");
}

}  // namespace compliant_ur5
