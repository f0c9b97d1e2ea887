#include "examples/simulated_ur5/scenario.hpp"

#include <filesystem>
#include <fstream>

#include "examples/support/toml_table.hpp"
#include "skinctl/core/contract.hpp"

namespace simulated_ur5 {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_file = 64u << 20;

std::ifstream open(const std::string& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) skinctl::refuse(file + ": no such file");
  if (fs::file_size(file, error) > largest_file) skinctl::refuse(file + ": larger than 64 MiB");
  std::ifstream in(file);
  if (!in) skinctl::refuse(file + ": cannot be read");
  return in;
}

using Table = examples::TomlTable;

bool vector(Table& t, const char* key, Vec3& value) {
  std::array<double, 3> v{};
  if (!t.numbers(key, v)) return false;
  value = {v[0], v[1], v[2]};
  return true;
}

void read_robot(Table t, Config& config) {
  ControllerConfig& c = config.controller;
  std::string series;
  if (t.text("series", series)) {
    if (series != "cb3" && series != "e-series") t.refuse_at("series", "\"cb3\" or \"e-series\"");
    c.series = series == "cb3" ? Series::cb3 : Series::e_series;
  }
  t.number("delay", c.arm.delay);
  t.number("lag", c.arm.lag);
  t.numbers("stiffness", c.arm.stiffness, true);
  t.number("integral_time", c.arm.integral_time);
  t.number("unknown_payload", c.arm.unknown_payload);
  t.number("position_noise", c.arm.position_noise);
  t.number("velocity_noise", c.arm.velocity_noise);
  t.number("step_tolerance", c.arm.step_tolerance);
  t.number("protective_deceleration", c.arm.protective_deceleration);
  t.numbers("velocity_limit", c.arm.velocity_limit, true);
  t.numbers("acceleration_limit", c.arm.acceleration_limit, true);
  t.numbers("home", c.arm.home);
  t.number("protective_force", c.protective_force);
  t.flag("powered", c.powered);
  t.number("power_on_time", c.power_on_time);
  t.number("brake_release_time", c.brake_release_time);
  t.number("unlock_time", c.unlock_time);
  t.whole("seed", c.seed, 9223372036854775807);
  t.finish();
}

void read_force_sensor(Table t, ForceSensorConfig& c) {
  t.number("force_noise", c.force_noise);
  t.number("moment_noise", c.moment_noise);
  vector(t, "force_bias", c.force_bias);
  vector(t, "moment_bias", c.moment_bias);
  vector(t, "force_creep", c.force_creep);
  vector(t, "moment_creep", c.moment_creep);
  vector(t, "force_per_kelvin", c.force_per_kelvin);
  t.number("bias_from", c.bias_from);
  t.finish();
}

void read_motors(Table t, ArmConfig& c) {
  t.numbers("viscous", c.drives.viscous, true);
  t.numbers("coulomb", c.drives.coulomb, true);
  t.numbers("torque_noise", c.torque_noise, true);
  t.numbers("torque_bias", c.torque_bias, true);
  t.numbers("torque_creep", c.torque_creep, true);
  t.number("warming", c.warming);
  t.number("warming_time", c.warming_time);
  t.number("friction_per_kelvin", c.friction_per_kelvin);
  t.finish();
}

void read_skin(Table t, const fs::path& folder, Config& config) {
  SkinConfig& s = config.controller.skin;
  std::string cells;
  if (t.text("cells", cells)) config.controller.cells = read_skin_cells((folder / cells).string());
  t.number("newtons_per_reading", s.newtons_per_reading);
  t.number("rest_reading", s.rest_reading);
  t.number("force_noise", s.force_noise);
  t.number("proximity_noise", s.proximity_noise);
  t.number("acceleration_noise", s.acceleration_noise);
  t.number("proximity_distance", s.proximity_distance);
  t.number("temperature", s.temperature);
  t.number("force_delta", s.force_delta);
  t.number("proximity_delta", s.proximity_delta);
  t.number("acceleration_delta", s.acceleration_delta);
  double keep_alive = seconds(s.keep_alive);
  t.number("keep_alive", keep_alive);
  if (!(keep_alive >= 0 && keep_alive <= 1e6)) t.refuse_at("keep_alive", "0 to 1e6 s");
  s.keep_alive = nanoseconds(keep_alive);
  t.finish();
}

void read_touch(Table t, const fs::path& folder, std::size_t number, std::vector<Touch>& touches) {
  Touch touch;
  touch.name = "touch " + std::to_string(number);
  t.text("name", touch.name);
  t.number("start", touch.start);
  std::uint64_t cell = 0xffffffffffu, link = touch.link;
  t.whole("cell", cell, 4294967295);
  t.whole("link", link, 5);
  const bool point = vector(t, "point", touch.point), normal = vector(t, "normal", touch.normal);
  touch.link = static_cast<std::size_t>(link);
  if (cell <= 4294967295u) {
    if (point || normal) t.refuse_at("cell", "given without point and normal");
    touch.cell = static_cast<std::uint32_t>(cell);
  } else if (!point || !normal) {
    t.refuse_at("cell", "given, or else link, point and normal");
  }
  t.number("stiffness", touch.stiffness);
  t.number("damping", touch.damping);
  t.number("tremor", touch.tremor);
  t.number("gap", touch.gap);
  t.number("approach_speed", touch.approach_speed);
  t.number("travel", touch.travel);
  t.number("hold", touch.hold);
  t.number("release_speed", touch.release_speed);
  t.number("patch_radius", touch.patch_radius);
  t.number("reach", touch.reach);
  t.flag("follow", touch.follow);
  std::string profile;
  if (t.text("profile", profile)) touch.profile = read_profile_file((folder / profile).string());
  t.number("profile_scale", touch.profile_scale);
  t.flag("impose_force", touch.impose_force);
  std::uint64_t repeat = 1;
  double period = touch.duration() + 1;
  t.whole("repeat", repeat, 10000);
  t.number("period", period);
  t.finish();
  check(touch);
  if (!(period >= 0 && period <= 1e6)) t.refuse_at("period", "0 to 1e6 s");
  const std::string name = touch.name;
  const double start = touch.start;
  for (std::uint64_t i = 0; i < repeat; ++i) {
    touch.start = start + static_cast<double>(i) * period;
    if (repeat > 1) touch.name = name + " #" + std::to_string(i + 1);
    touches.push_back(touch);
    if (touches.size() > 10000) t.refuse_at("repeat", "so that there are at most 10000 touches");
  }
}

}  // namespace

ForceProfile read_profile_file(const std::string& file) {
  auto in = open(file);
  return read_profile(in, file);
}

void read_scenario(const std::string& file, Config& config) {
  static_cast<void>(open(file));
  const toml::table root = examples::read_toml(file);
  const fs::path folder = fs::path(file).parent_path();
  if (const toml::node* robot = root.get("robot")) {
    if (!robot->is_table()) skinctl::refuse(file + ": robot must be a table");
    read_robot(Table(file, "robot", *robot->as_table()), config);
  }
  if (const toml::node* sensor = root.get("force_sensor")) {
    if (!sensor->is_table()) skinctl::refuse(file + ": force_sensor must be a table");
    read_force_sensor(Table(file, "force_sensor", *sensor->as_table()), config.controller.force_sensor);
  }
  if (const toml::node* motors = root.get("motors")) {
    if (!motors->is_table()) skinctl::refuse(file + ": motors must be a table");
    read_motors(Table(file, "motors", *motors->as_table()), config.controller.arm);
  }
  if (const toml::node* skin = root.get("skin")) {
    if (!skin->is_table()) skinctl::refuse(file + ": skin must be a table");
    read_skin(Table(file, "skin", *skin->as_table()), folder, config);
  }
  if (const toml::node* touch = root.get("touch")) {
    const toml::array* list = touch->as_array();
    if (!list) skinctl::refuse(file + ": touch must be an array of tables, [[touch]]");
    std::size_t number = 0;
    for (const toml::node& item : *list) {
      if (!item.is_table()) skinctl::refuse(file + ": touch must be an array of tables, [[touch]]");
      read_touch(Table(file, "touch", *item.as_table()), folder, ++number, config.controller.touches);
    }
  }
}

}  // namespace simulated_ur5
