#include "examples/compliant_ur5/clear.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5_skin.hpp"

namespace compliant_ur5 {

using namespace skinctl;

namespace {

constexpr float same_reading = 0.01f;      ///< twice the step in which cells send it; a hand trembles by more
constexpr double way_of_same = 0.03;       ///< of a cell, from which on the same reading is none [m]
constexpr Nanoseconds time_of_same = 10s;  ///< likewise
constexpr std::size_t most_samples = 16385;  ///< of one cycle: as many as the receiver hands out, and a palm

/// The links' numbers among the capsules are theirs on the robot; then come the base, the table, and a tool.
constexpr std::size_t base = 6, table = 7, tool = 8;

/// The same for cells that look at them: a tube's round ends are within it, or they hide its neighbours'
/// cells.
std::vector<LinkCapsule> in_view(const Settings& s) {
  auto all = clearance(s).own.capsules;
  for (std::size_t i = 0; i < 6; ++i) {
    const ur5::Tube& t = ur5::tubes[i];
    const Xyz<double> way = t.to - t.from;
    const double ends = std::min(t.radius / norm(way), 0.5);
    all[i].shape = {t.from + ends * way, t.to - ends * way, t.radius};
  }
  return all;
}

}  // namespace

double distance_of(const ClearSettings& s, double reading) noexcept {
  return reading < 1 ? s.proximity_distance * std::sqrt(1 / std::max(reading, 1e-6) - 1) : 0;
}
double reading_of(const ClearSettings& s, double distance) noexcept {
  const double x = std::max(distance, 0.0) / s.proximity_distance;
  return 1 / (1 + x * x);
}

UrClearance clearance(const Settings& s) {
  require(s.clear.table >= -10 && s.clear.table <= 1, "clear.table", s.clear.table, "-10 to 1 m");
  require(s.clear.tool_length >= 0 && s.clear.tool_length <= 1, "clear.tool_length", s.clear.tool_length,
          "0 to 1 m");
  require(s.clear.approach >= 0 && s.clear.approach <= 2, "clear.approach", s.clear.approach, "0 to 2 m/s");
  UrClearance c;
  auto& all = c.own.capsules;
  for (std::size_t i = 0; i < 6; ++i) {
    const ur5::Tube& t = ur5::tubes[i];
    Capsule<> shape{t.from, t.to, t.radius};
    if (i == 3 || i == 4)
      shape.to.z -= 0.03;  // the half sphere of its end takes that of the next link's housing
    all.push_back({i, shape});
    c.exposed.push_back(i);
  }
  // The table is a ball, which touches its plane where the arm ends, and is 5 mm higher at the base.
  constexpr double large = 100, reach = 1;  // [m]
  const double top = s.clear.table + reach * reach / (2 * large);
  all.push_back({LinkCapsule::fixed, {{0, 0, 0}, {0, 0, 0.03}, 0.075}});
  all.push_back({LinkCapsule::fixed, {{0, 0, top - large}, {0, 0, top - large}, large}});
  const auto meet = [&](std::initializer_list<std::size_t> parts, std::size_t with) {
    for (const std::size_t part : parts) c.own.pairs.push_back({part, with});
  };
  // Neighbours, and pairs that no position of the joints brings together, are left out.
  meet({2, 3, 5}, 0), meet({3, 4, 5}, 1), meet({5}, 2);
  meet({2, 3, 4, 5}, base), meet({1, 2, 3, 4, 5}, table);
  c.own.margin = s.clear.margin;
  c.own.reach = reach;
  if (s.clear.tool_length > 0) {
    constexpr double flange = ur5::Description::d6;
    const double r = s.clear.tool_radius;
    all.push_back(
        {5, {{0, 0, flange + r}, {0, 0, std::max(flange + s.clear.tool_length - r, flange + r)}, r}});
    meet({0, 1, 2, base, table}, tool);
    c.exposed.push_back(tool);
    c.own.reach += s.clear.tool_length;
  }
  return c;
}

double OwnDistance::operator()(const JointPosition<6>& q) const noexcept {
  double d[Clearances<ur5::Model>::max_pairs];
  clearances_.distances(q, d);
  return *std::min_element(d, d + clearances_.size());
}

Sight::Sight(const Settings& s)
    : s_(s.clear),
      range_(distance_of(s.clear, sees_from)),
      skin_(skin_patches(s), {}),
      view_({}, skin_.places(), in_view(s), {.range = range_, .error = sight_error}),
      sightings_({}, skin_.places(),
                 {.range = range_, .error = sight_error, .approach = s.clear.approach, .min_reading = 1e-3}),
      places_(skin_.places()),
      still_(places_.size()),
      own_(places_.size()),
      samples_(most_samples) {}

bool Sight::is_dull(Still& still, const CellSample& sample, const Xyz<double>& place) noexcept {
  if (std::abs(sample.proximity - still.reading) > same_reading)
    still = {sample.proximity, sample.time, place, false};
  else if (sample.time - still.since > time_of_same || norm(Xyz<double>(place - still.place)) > way_of_same)
    still.is_dull = true;
  return still.is_dull;
}

std::span<const CellSample> Sight::foreign(const JointPosition<6>& q,
                                           std::span<const CellSample> samples) noexcept {
  if (samples.size() > samples_.size()) return samples;
  bool sees = false;
  for (const CellSample& s : samples) {
    const bool this_one = s.proximity >= static_cast<float>(sees_from);
    const std::size_t i = this_one ? still_.size() : skin_.index(s.cell);
    if (i < still_.size()) still_[i] = {};
    sees = sees || this_one;
  }
  if (!sees) return samples;
  view_.look(q, own_);
  std::array<Transform<Base, SomeLink>, 6> pose;
  const auto poses = link_poses(ur5::Model{}, q);
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((pose[I] = poses.template get<I>().template renamed<Base, SomeLink>()), ...);
  }(std::make_index_sequence<6>());
  std::copy(samples.begin(), samples.end(), samples_.begin());
  for (std::size_t k = 0; k < samples.size(); ++k) {
    CellSample& sample = samples_[k];
    const std::size_t i = skin_.index(sample.cell);
    if (i >= own_.size() || !(sample.proximity >= static_cast<float>(sees_from))) continue;
    const auto& X = pose[places_[i].link];
    const bool dull = is_dull(still_[i], sample, X.origin() + X.axes() * places_[i].place);
    const double own = reading_of(s_, range_ * (1 - own_[i] / 65535.0));
    const double above =
        own_[i] == 0 ? 1 : (static_cast<double>(sample.proximity) - own) / view_.view().fade_band;
    if (dull || above < 1) sample.proximity *= dull ? 0.0f : static_cast<float>(std::max(above, 0.0));
  }
  return {samples_.data(), samples.size()};
}

}  // namespace compliant_ur5
