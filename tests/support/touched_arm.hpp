// A scene of a UR5 with a few cells on its links, in a world that pushes on them, cell by cell.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "skinctl/cycle/cycle.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin.hpp"
#include "tests/support/simulated_joints.hpp"

namespace skinctl::testing {

/// A cell at `p` with the outward normal `z`, of unit length, in the axes of its link.
inline constexpr double newtons_per_unit = 40, proximity_newtons = 30;
template <std::size_t I>
PlacedCell<I> cell_at(std::uint32_t id, const Xyz<double>& p, const Xyz<double>& z) {
  const Xyz<double> other = std::abs(z.x) < 0.9 ? Xyz<double>{1, 0, 0} : Xyz<double>{0, 1, 0};
  Xyz<double> x = other - dot(other, z) * z;
  x = (1 / std::sqrt(dot(x, x))) * x;
  const Xyz<double> y = cross(z, x);
  return {id, Transform<Link<I>, Cell>({x, y, z}, p)};
}
/// A skin that lets every reading pass, 40 N per unit of force, 30 N at a proximity of 1; ids 1, 2, ...
template <class... Patches>
auto open_skin(const Patches&... patches) {
  SkinSettings settings;
  settings.force = EventGate<>();
  settings.proximity = EventGate<>();
  return Skin<ur5::Model, double, Patches...>(patches..., settings);
}
inline constexpr CellGains open_gains{.force = newtons_per_unit, .proximity = proximity_newtons};

/// What the world does to a cell: a push [N] >= 0, a proximity reading in [0, 1].
struct CellTouch {
  double force = 0, proximity = 0;
};
/// A cell's place and motion, along its outward normal at the start of the test, in the base's axes.
struct CellAt {
  double time;
  double out;    ///< how far it has come out along that normal [m]
  double speed;  ///< [m/s]
};

/// The arm of a `Cycle` by position, its simulated joints, and its cells, all of them on link `I`. The world
/// touches cell k by `world(k, where)`; each cell sends once a cycle.
template <std::size_t I, class Scene>
class TouchedArm {
 public:
  TouchedArm(const Scene& scene, const std::vector<PlacedCell<I>>& cells, const std::array<double, 6>& q,
             double delay, double lag, double newtons = newtons_per_unit)
      : scene_(scene),
        newtons_(newtons),
        cells_(cells),
        joints_(SimulatedJoints<6>::Kind::position, delay, lag, q),
        memory_(std::make_unique<typename Scene::Memory>()),
        last_(cells.size()),
        start_(where()),
        force(cells.size()),
        given(cells.size()) {
    scene_.start(*memory_, measured());
    last_ = start_;
  }

  template <class World>
  auto step(Nanoseconds period, World&& world) {
    now_ += period;
    const double t = seconds<double>(now_), dt = seconds<double>(period);
    joints_.advance(t);
    const auto here = where();
    std::vector<CellSample> samples;
    double sum = 0;
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      const Xyz<double> n = start_[k].z, way = here[k].p - last_[k].p;
      const CellTouch touch = world(k, CellAt{t, dot(n, here[k].p - start_[k].p), dot(n, way) / dt});
      given[k] += 0.5 * dot(force[k] * last_[k].z + touch.force * here[k].z, way);
      force[k] = touch.force;
      sum += given[k];
      CellSample s;
      s.cell = cells_[k].id;
      s.time = now_;
      for (float& f : s.force) f = static_cast<float>(std::min(1.0, touch.force / (3 * newtons_)));
      s.proximity = static_cast<float>(touch.proximity);
      samples.push_back(s);
    }
    extracted = std::max(extracted, sum);
    last_ = here;
    typename Scene::Input input{};
    input.now = now_;
    input.measured = measured();
    input.samples = samples;
    const auto out = scene_.step(*memory_, input);
    status |= out.status;
    std::array<double, 6> q{};
    for (std::size_t i = 0; i < 6; ++i) q[i] = out.command.position[i];
    joints_.command(t, q);
    return out;
  }

  [[nodiscard]] const auto& q() const { return joints_.q(); }
  [[nodiscard]] const auto& memory() const { return *memory_; }
  [[nodiscard]] double time() const { return seconds<double>(now_); }

 private:
  struct Place {
    Xyz<double> p, z;
  };
  State<6> measured() const {
    State<6> s;
    s.time = now_;
    s.q = JointPosition<6>(joints_.q());
    s.dq = JointVelocity<6>(joints_.dq());
    return s;
  }
  std::vector<Place> where() const {
    const ur5::Model model;
    const JointPosition<6> q(joints_.q());
    const auto X = Poses<ur5::Model, all_links(6), double>(model, JointAngles<ur5::Model, double>(model, q))
                       .template get<I>();
    std::vector<Place> out;
    for (const auto& c : cells_) {
      const auto X_BC = X * c.X_LC;
      out.push_back({X_BC.origin(), X_BC.axis_z()});
    }
    return out;
  }

  Scene scene_;
  double newtons_;
  std::vector<PlacedCell<I>> cells_;
  SimulatedJoints<6> joints_;
  std::unique_ptr<typename Scene::Memory> memory_;
  Nanoseconds now_{};
  std::vector<Place> last_, start_;

 public:
  std::vector<double> force;  ///< on each cell [N]
  std::vector<double> given;  ///< energy given by the arm to what touches each cell [J]
  double extracted = 0;       ///< the most that all of them had at any time [J]
  Status status;
};

}  // namespace skinctl::testing
