#include "examples/simulated_allegro/plant.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "examples/adapters/allegro/cells.hpp"
#include "examples/adapters/allegro/limits.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/kinematics/poses.hpp"

namespace simulated_allegro {
namespace {

using namespace skinctl;
using Model = CalibratedModel<skinctl::allegro::Tree, double>;
using Vector = Xyz<double>;

constexpr double longest_step = 2.5e-4;
constexpr double still = 0.01;         ///< below this speed friction is a damper [rad/s]
constexpr double stop_stiffness = 20;  ///< [N m/rad]
constexpr double stop_beyond = 0.05;   ///< of the range of motion [rad]
constexpr double pad = 0.010;          ///< radius of a cell's pad [m]

Vector plus(const Vector& a, double s, const Vector& b) {
  return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
double length(const Vector& a) {
  return std::sqrt(dot(a, a));
}

}  // namespace

/// What a substep needs of the library: the model of the hand with its tips and cells.
struct Plant::World {
  explicit World(Side side)
      : model(skinctl::allegro::hand(side)), cells(adapters::allegro::cell_poses(side)) {}
  Model model;
  std::array<adapters::allegro::CellPose, 16> cells;
};

Plant::Plant(const PlantConfig& config)
    : config_(config), world_(std::make_unique<World>(config.side)), q_(config.start) {
  const auto positive = [](double x, const char* what, double most) {
    require(x >= 0 && x <= most, what, x, ">= 0, and plausible");
  };
  require(config.rotor_inertia >= 1e-6 && config.rotor_inertia <= 1, "rotor inertia", config.rotor_inertia,
          "1e-6 to 1 kg m^2");
  positive(config.viscous, "viscous friction", 10);
  positive(config.coulomb, "Coulomb friction", 10);
  positive(config.delay, "delay", 1);
  require(config.newtons_of_full_scale > 0 && config.newtons_of_full_scale <= 1e4, "force of full scale",
          config.newtons_of_full_scale, "> 0, <= 1e4 N");
  if (config.ball) {
    require(config.ball->radius > 0 && config.ball->radius <= 1, "radius of the ball", config.ball->radius,
            "> 0, <= 1 m");
    require(config.ball->stiffness > 0 && config.ball->stiffness <= 1e5, "stiffness of the ball",
            config.ball->stiffness, "> 0, <= 1e5 N/m");
    if (config.side == Side::left) config_.ball->centre[1] *= -1;
  }
  for (const Touch& t : config.touches) {
    require(t.cell <= 15, "cell of a touch", static_cast<double>(t.cell), "0 to 15");
    require(t.duration > 0 && std::abs(t.force) <= 100, "force of a touch", t.force,
            "up to 100 N, for > 0 s");
  }
}
Plant::~Plant() = default;
Plant::Plant(Plant&&) noexcept = default;

void Plant::command(const Joints& torque) {
  under_way_.push_back({time_ + config_.delay, torque});
}

void Plant::advance(double t) {
  while (time_ < t) {
    double until = std::min(t, time_ + longest_step);
    if (!under_way_.empty()) {
      if (under_way_.front().time <= time_ + 1e-9) {
        torque_ = under_way_.front().torque;
        under_way_.pop_front();
        continue;
      }
      until = std::min(until, under_way_.front().time);
    }
    substep(until - time_);
    time_ = until;
  }
}

void Plant::substep(double h) {
  const Model& model = world_->model;
  const JointPosition<16> q(q_);
  const JointVelocity<16> dq(dq_);
  const JointAngles<Model, double> angles(model, q);
  const auto poses = link_poses(model, q);
  std::array<Transform<Base, SomeLink>, 16> links;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((links[I] = Transform<Base, SomeLink>(poses.template get<I>().axes(), poses.template get<I>().origin())),
     ...);
  }(std::make_index_sequence<16>{});

  JointTorque<16> external;
  Joints damping{};
  cell_force_ = ball_force_ = {};
  for (const Touch& t : config_.touches) {
    const double since = time_ - t.start, left = t.start + t.duration - time_;
    if (since > 0 && left > 0) cell_force_[t.cell] += t.force * std::min({1.0, since / 0.1, left / 0.1});
  }
  for (std::size_t k = 1; k < 16; ++k) {
    const auto last = static_cast<std::size_t>(adapters::allegro::cell_place(k).link);
    if (cell_force_[k] == 0 && !config_.ball) continue;
    const auto cell = links[last] * world_->cells[k];
    const Vector surface = cell.origin(), normal = cell.axis_z();
    Vector force{-cell_force_[k] * normal.x, -cell_force_[k] * normal.y, -cell_force_[k] * normal.z};
    if (config_.ball) {
      const Ball& ball = *config_.ball;
      const Vector middle = plus(surface, -pad, normal);
      const Vector away = plus(middle, -1, {ball.centre[0], ball.centre[1], ball.centre[2]});
      const double d = length(away), deep = pad + ball.radius - d;
      if (deep > 0 && d > 1e-6) {
        // The damper acts through the joints' implicit damping, below.
        const double f = ball.stiffness * deep;
        force = plus(force, f / d, away);
        ball_force_[k] = f;
        cell_force_[k] += std::max(0.0, -f / d * dot(away, normal));
        for (std::size_t i = last - last % 4; i <= last; ++i) {
          const double arm = dot(cross(links[i].axis_z(), plus(surface, -1, links[i].origin())), away) / d;
          damping[i] += ball.damping * arm * arm;
        }
      }
    }
    for (std::size_t i = last - last % 4; i <= last; ++i)
      external[i] += dot(cross(links[i].axis_z(), plus(surface, -1, links[i].origin())), force);
  }

  // Implicit in everything that damps, so that friction of any size holds a joint instead of shaking it.
  auto inertia = mass_matrix(model, angles);
  const auto bias = bias_torque(model, angles, dq);
  JointTorque<16> impulse;
  for (std::size_t i = 0; i < 16; ++i) {
    double d = damping[i] + config_.viscous + config_.coulomb / std::max(std::abs(dq_[i]), still);
    double tau = torque_[i] - bias[i] + external[i];
    const double beyond = std::max(0.0, q_[i] - adapters::allegro::upper[i] - stop_beyond) +
                          std::min(0.0, q_[i] - adapters::allegro::lower[i] + stop_beyond);
    if (beyond != 0) {
      tau -= stop_stiffness * beyond;
      d += 0.1;
    }
    impulse[i] = h * (tau - d * dq_[i]);
    inertia(i, i) = inertia(i, i) + config_.rotor_inertia + h * d;
  }
  const auto change = MassFactors<Model, double>::solved(inertia, impulse).acceleration;
  for (std::size_t i = 0; i < 16; ++i) {
    dq_[i] += change[i];
    q_[i] += h * dq_[i];
  }
}

}  // namespace simulated_allegro
