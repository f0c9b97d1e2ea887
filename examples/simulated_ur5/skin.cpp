#include "examples/simulated_ur5/skin.hpp"

#include <algorithm>

#include "skinctl/core/contract.hpp"

namespace simulated_ur5 {
namespace {

constexpr std::size_t max_cells = 20000;
constexpr double standard_gravity = 9.80665;  // [m/s^2]

double step(double value, double size) {
  return std::round(value / size) * size;
}

}  // namespace

void complete(SkinCell& cell) {
  cell.normal = normalised(cell.normal);
  for (const Vec3 candidate : {cell.axis, Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}) {
    const Vec3 in_plane = candidate - dot(candidate, cell.normal) * cell.normal;
    if (norm(in_plane) < 0.1) continue;
    cell.axis = normalised(in_plane);
    return;
  }
}

void err_as_cheap_ones(SkinConfig& config) {
  config.accelerometers = AccelerometerFaults::cheap();
  config.acceleration_noise = 0.009 * standard_gravity;
  config.acceleration_delta = 0;
}

void check(const SkinConfig& c) {
  using skinctl::require;
  require(c.period >= plant_step && c.period % plant_step == 0 && c.period <= nanoseconds(1), "skin period",
          seconds(c.period), "0.5 ms to 1 s in steps of 0.5 ms");
  require(c.keep_alive >= c.period && c.keep_alive <= nanoseconds(60), "skin keep-alive",
          seconds(c.keep_alive), "the skin period to 60 s");
  require(c.newtons_per_reading > 0 && c.newtons_per_reading <= 1e6, "newtons per reading",
          c.newtons_per_reading, "> 0 to 1e6 N");
  require(c.rest_reading >= 0 && c.rest_reading < 1, "rest reading", c.rest_reading, "0 to below 1");
  require(c.proximity_distance > 0 && c.proximity_distance <= 1, "proximity distance", c.proximity_distance,
          "> 0 to 1 m");
  require(c.force_noise >= 0 && c.force_noise <= 1, "force noise", c.force_noise, "0 to 1");
  require(c.proximity_noise >= 0 && c.proximity_noise <= 1, "proximity noise", c.proximity_noise, "0 to 1");
  require(c.acceleration_noise >= 0 && c.acceleration_noise <= 100, "acceleration noise",
          c.acceleration_noise, "0 to 100 m/s^2");
  const AccelerometerFaults& a = c.accelerometers;
  for (const double x : {a.bias, a.scale, a.misalignment, a.cross_axis, a.vibration})
    require(x >= 0 && x <= 0.5, "an error of accelerometers", x, "0 to 0.5");
  require(c.force_delta >= 0, "force delta", c.force_delta, ">= 0");
  require(c.proximity_delta >= 0, "proximity delta", c.proximity_delta, ">= 0");
  require(c.acceleration_delta >= 0, "acceleration delta", c.acceleration_delta, ">= 0 m/s^2");
}

Skin::Skin(std::vector<SkinCell> cells, const SkinConfig& config, std::uint64_t seed)
    : cells_(std::move(cells)),
      config_(config),
      memory_(cells_.size()),
      faults_(config.faults, seed),
      random_(seed) {
  check(config_);
  skinctl::require(cells_.size() <= max_cells, "number of skin cells", static_cast<double>(cells_.size()),
                   "at most 20000");
  felt_.reserve(cells_.size());
  out_.reserve(cells_.size());
  for (std::size_t i = 0; i < cells_.size(); ++i) index_[cells_[i].id] = i;
  draw_accelerometers(seed);
}

void Skin::draw_accelerometers(std::uint64_t seed) {
  const AccelerometerFaults& f = config_.accelerometers;
  Random random(seed + 0x5eed);  // a sensor stays the same when the noise starts anew
  const auto three = [&](double size) {
    const double x = random.normal(), y = random.normal(), z = random.normal();
    return Vec3{size * x, size * y, size * z};
  };
  accelerometers_.resize(cells_.size());
  for (Accelerometer& a : accelerometers_) {
    const Vec3 turn = three(f.misalignment), scale = three(f.scale);
    const double gain[3] = {1 + scale.x, 1 + scale.y, 1 + scale.z};
    // Rows are the sensor's axes in the cell, to first order in the turn, each with a part of the others'.
    const Vec3 axes[3] = {{1, turn.z, -turn.y}, {-turn.z, 1, turn.x}, {turn.y, -turn.x, 1}};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 others =
          f.cross_axis * (random.normal() * axes[(k + 1) % 3] + random.normal() * axes[(k + 2) % 3]);
      a.matrix[k] = gain[k] * (axes[k] + others);
    }
    a.bias = three(standard_gravity * f.bias);
  }
  for (auto& link : shakes_)
    for (Shake& shake : link)
      shake = {6.283185307179586 * (8 + 7 * random.uniform()), 6.283185307179586 * random.uniform(),
               6.283185307179586 * random.uniform(),
               (standard_gravity * f.vibration / std::sqrt(3.0)) * normalised(three(1))};
}

Vec3 Skin::shaking(std::size_t link, Nanoseconds t) const {
  Vec3 sum{0, 0, 0};
  for (const Shake& s : shakes_[link])
    sum =
        sum + std::sin(s.rate * seconds(t) + 3 * std::sin(0.6 * seconds(t) + s.sway) + s.phase) * s.direction;
  return sum;
}

void Skin::restart(std::uint64_t seed) {
  random_ = Random(seed);
  faults_ = skinctl::testing::SkinFaults(config_.faults, seed);
  ticks_ = 0;
  for (Memory& m : memory_) {
    const bool dead = m.dead;
    m = Memory{};
    m.dead = dead;
  }
}

void Skin::set_dead(std::uint32_t cell, bool dead) {
  for (std::size_t i = 0; i < cells_.size(); ++i)
    if (cells_[i].id == cell) memory_[i].dead = dead;
}

void Skin::feel(Nanoseconds t, const Links& links, const SkinStimulus& stimulus) {
  felt_.clear();
  const double h = seconds(config_.period);
  const bool shaken = config_.accelerometers.vibration > 0;
  std::array<Vec3, 6> shakes{};
  for (std::size_t l = 0; shaken && l < shakes.size(); ++l) shakes[l] = shaking(l, t);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const SkinCell& cell = cells_[i];
    Memory& m = memory_[i];
    const Pose& pose = links.link[cell.link];
    SkinSample s;
    s.cell = cell.id;
    s.time = std::chrono::nanoseconds(t);

    const double share =
        i < stimulus.force.size() ? stimulus.force[i] / (3 * config_.newtons_per_reading) : 0;
    for (float& f : s.force) {
      const double reading = config_.rest_reading + share + config_.force_noise * random_.noise();
      f = static_cast<float>(std::clamp(step(reading, 1.0 / 1024), 0.0, 1.0));
    }
    const double proximity = (i < stimulus.proximity.size() ? stimulus.proximity[i] : 0) +
                             config_.proximity_noise * random_.noise();
    s.proximity = static_cast<float>(std::clamp(step(proximity, 1.0 / 65536), 0.0, 1.0));

    const Vec3 here = pose.point(cell.position);
    Vec3 acceleration{0, 0, 9.81};
    if (ticks_ >= 2) acceleration = acceleration + (1 / (h * h)) * (here - 2 * m.before + m.before_that);
    m.before_that = m.before;
    m.before = here;
    const Vec3 in_link = pose.rotate_back(acceleration) + shakes[cell.link];
    const Vec3 along{dot(cell.axis, in_link), dot(cross(cell.normal, cell.axis), in_link),
                     dot(cell.normal, in_link)};
    const Accelerometer& own = accelerometers_[i];
    const double bias[3] = {own.bias.x, own.bias.y, own.bias.z};
    for (std::size_t a = 0; a < 3; ++a) {
      const double reading =
          dot(own.matrix[a], along) + bias[a] + config_.acceleration_noise * random_.noise();
      s.acceleration[a] = static_cast<float>(std::clamp(step(reading, 9.80665 / 256), -157.0, 157.0));
    }
    s.temperature = static_cast<float>(step(config_.temperature, 0.5));
    felt_.push_back(s);
  }
}

const std::vector<SkinSample>& Skin::sample(Nanoseconds t, const Links& links, const SkinStimulus& stimulus) {
  feel(t, links, stimulus);
  if (!config_.faults.empty()) faults_.apply(felt_, std::chrono::nanoseconds(t));
  out_.clear();
  const std::int64_t rotation = std::max<std::int64_t>(1, config_.keep_alive / config_.period);
  for (SkinSample& s : felt_) {
    const std::size_t i = index_.find(s.cell)->second;
    Memory& m = memory_[i];
    bool due = !m.ever_sent || t - m.sent_at >= config_.keep_alive;
    // Cells take turns, so that keep-alives do not come all at once.
    if (static_cast<std::int64_t>(i) % rotation == ticks_ % rotation) due = true;
    unrest_.measure(m.unrest, s);
    const float pressed =
        (s.force[0] + s.force[1] + s.force[2]) / 3 - static_cast<float>(config_.rest_reading);
    if (pressed >= static_cast<float>(config_.force_delta)) due = true;
    for (std::size_t a = 0; a < 3; ++a) {
      if (std::abs(s.force[a] - m.sent.force[a]) >= static_cast<float>(config_.force_delta)) due = true;
      if (std::abs(s.acceleration[a] - m.sent.acceleration[a]) >=
          static_cast<float>(config_.acceleration_delta))
        due = true;
    }
    if (std::abs(s.proximity - m.sent.proximity) >= static_cast<float>(config_.proximity_delta)) due = true;
    if (!due || m.dead) continue;
    unrest_.tell(m.unrest, s);
    m.sent = s;
    m.sent_at = t;
    m.ever_sent = true;
    s.time += std::chrono::nanoseconds(config_.clock_offset);
    out_.push_back(s);
  }
  ++ticks_;
  return out_;
}

}  // namespace simulated_ur5
