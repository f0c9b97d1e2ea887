#include "examples/compliant_allegro/touches.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "examples/adapters/allegro/cells.hpp"
#include "skinctl/kinematics/poses.hpp"

namespace compliant_allegro {
namespace {

using namespace skinctl;
using namespace adapters::allegro;
using HandModel = CalibratedModel<skinctl::allegro::Tree, double>;

/// Where cell `k` is, and its normal, in the frame of the hand.
struct CellAt {
  Xyz<double> p, normal;
};
class CellFinder {
 public:
  explicit CellFinder(Side side) : model_(skinctl::allegro::hand(side)), cells_(cell_poses(side)) {}
  [[nodiscard]] CellAt find(std::size_t k, const std::array<float, 16>& joints) const {
    JointPosition<16> q;
    for (std::size_t i = 0; i < 16; ++i) q[i] = static_cast<double>(joints[i]);
    const auto poses = link_poses(model_, q);
    CellAt out{cells_[k].origin(), cells_[k].axis_z()};
    const int link = cell_place(k).link;
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((static_cast<int>(I) == link ? void(out = in(poses.template get<I>(), k)) : void()), ...);
    }(std::make_index_sequence<16>{});
    return out;
  }

 private:
  template <class X>
  CellAt in(const X& X_BL, std::size_t k) const {
    const auto X_BC = Transform<Base, SomeLink>(X_BL.axes(), X_BL.origin()) * cells_[k];
    return {X_BC.origin(), X_BC.axis_z()};
  }
  HandModel model_;
  std::array<CellPose, 16> cells_;
};

/// Touches that the cells felt, apart from the time when the hand presses by itself; without cells those of
/// the simulation.
std::vector<TouchSummary> touches_of(const Settings& s, const RunLog& log, double closes, double opens) {
  std::vector<TouchSummary> out;
  const auto on = [&](const LogEntry& e, std::size_t k) {
    if (e.time > closes && e.time < opens + 1) return false;
    if (s.generation == Generation::v5_sense) return e.cell[k] > 0.05F;
    for (const auto& t : s.plant.touches)
      if (t.cell == k && s.can.empty() && e.time > t.start && e.time < t.start + t.duration) return true;
    return false;
  };
  for (std::size_t k = 1; k < 16; ++k) {
    bool was = false;
    for (const LogEntry& e : log.entries) {
      const bool is = on(e, k);
      if (is && !was) out.push_back({.start = e.time, .end = e.time, .cell = k});
      if (is) out.back().end = e.time, out.back().reading = std::max(out.back().reading, double(e.cell[k]));
      was = is;
    }
  }
  std::erase_if(out, [](const TouchSummary& t) { return t.end - t.start < 0.05; });
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.start < b.start; });
  return out;
}

void measure(TouchSummary& t, const CellFinder& finder, const RunLog& log) {
  const LogEntry* before = nullptr;
  CellAt rest{};
  for (const LogEntry& e : log.entries) {
    if (e.time <= t.start) {
      before = &e;
      continue;
    }
    if (before == nullptr || e.time > t.end + 1) break;
    if (before->time <= t.start && rest.p == Xyz<double>{}) rest = finder.find(t.cell, before->q);
    const auto now = finder.find(t.cell, e.q).p;
    const Xyz<double> d{now.x - rest.p.x, now.y - rest.p.y, now.z - rest.p.z};
    const double away = -dot(d, rest.normal);
    if (e.time <= t.end) t.moved = std::max(t.moved, away);
    if (t.after < 0 && away > 1e-3) t.after = e.time - t.start;
    t.return_error = std::sqrt(dot(d, d));
  }
}

}  // namespace

void find_touches(const Settings& s, Side side, double closes, double opens, RunLog& log) {
  const CellFinder finder(side);
  log.touches = touches_of(s, log, closes, opens);
  for (TouchSummary& t : log.touches) measure(t, finder, log);
}

}  // namespace compliant_allegro
