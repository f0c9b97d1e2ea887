#include "examples/packing_oranges/kitchen.hpp"

#include <algorithm>

namespace packing {
namespace {
using skinctl::Xyz;
using Place = Xyz<double>;

constexpr double spacing = 0.005;  // of the points of a way [m]

/// The place of the first step of a kind with this role.
const skinctl::TaughtPlace& place_of(const Plan& plan, const skinctl::ActivityRule& does,
                                     skinctl::ObjectClass role) {
  std::size_t k = 0;
  while (k + 1 < plan.size && (plan.steps[k].does != &does || plan.steps[k].role != role)) ++k;
  return plan.places[plan.steps[k].place];
}
/// Points every 5 mm along a way, about a place.
std::vector<Place> points(const skinctl::TaughtWay& way, const skinctl::TaughtPlace& at) {
  std::vector<Place> out;
  for (std::size_t k = 0; k + 1 < way.size; ++k) {
    const Place from = way.corners[k], to = way.corners[k + 1];
    const int count = std::max(1, static_cast<int>(std::lround(norm(Place(to - from)) / spacing)));
    for (int i = 0; i < count; ++i)
      out.push_back(at.X_MH.origin() + at.X_MH.axes() * Place(from + (double(i) / count) * Place(to - from)));
  }
  return out;
}
}  // namespace

std::vector<std::size_t> followed(const std::vector<Place>& taught, const std::vector<Place>& went,
                                  double within) {
  const std::size_t n = taught.size(), m = went.size();
  std::vector<int> best((n + 1) * (m + 1), 0);
  const auto at = [&](std::size_t i, std::size_t j) -> int& { return best[i * (m + 1) + j]; };
  const auto near = [&](std::size_t i, std::size_t j) { return norm(Place(taught[i] - went[j])) <= within; };
  for (std::size_t i = n; i-- > 0;)
    for (std::size_t j = m; j-- > 0;)
      at(i, j) = std::max({at(i + 1, j), at(i, j + 1), near(i, j) ? at(i + 1, j) + 1 : 0});
  std::vector<std::size_t> out;
  for (std::size_t i = 0, j = 0; i < n && j < m;) {
    if (near(i, j) && at(i, j) == at(i + 1, j) + 1)
      out.push_back(j), ++i;
    else if (at(i, j) == at(i, j + 1))
      ++j;
    else
      ++i;
  }
  return out;
}

ToolLesson tool_lesson(const Plan& plan, const skinctl::TaughtWays& ways, double stands) {
  using namespace skinctl::activity;
  ToolLesson out;
  const auto tool_in_hand = place_of(plan, Take::rule, tool_class).X_MH.origin();
  const auto thing_in_hand = place_of(plan, Take::rule, orange_class).X_MH.origin();
  out.tool_place = place_of(plan, Put::rule, tool_class).X_MH.origin() - tool_in_hand - Place{stands, 0, 0};
  out.thing_place = place_of(plan, Put::rule, orange_class).X_MH.origin() - thing_in_hand;
  const auto turned = skinctl::exp_so3(Place{0, 0, tool_yaw});
  for (std::size_t k = 0; k < plan.size; ++k) {
    if (plan.steps[k].does != &Use::rule) continue;
    for (const Place& p : points(ways[plan.steps[k].place], plan.places[plan.steps[k].place]))
      out.tip.push_back(p - tool_in_hand + turned * tool_tip);
  }
  return out;
}

void Kitchen::lay(World& world) {
  for (std::size_t arm = 0; arm < arms; ++arm) {
    constexpr double off = 0.03, turned = 0.09;  // as people lay it down: 30 mm and 5 degrees
    const Tray feed = feed_tray(0);
    const Place tool = lesson_.tool_place + Place{between(-off, off), between(-off, off), 0};
    const Place bread{feed.x + between(-0.1, 0.1), feed.y + between(-off, off), 0};
    const double yaw = tool_yaw + (arm == 0 ? 0 : M_PI) + between(-turned, turned);
    tools_[arm] = seen_by(arm, {tool.x, tool.y, 0});
    yaws_[arm] = yaw;
    world.put(bread_of(arm), seen_by(arm, bread), {bread_half, bread_stiffness});
    lay_tool(world, arm);
  }
}

void Kitchen::lay_tool(World& world, std::size_t arm) {
  world.put(tool_of(arm), tools_[arm], {handle_half.z, handle_stiffness, yaws_[arm]});
}

void Kitchen::bring(World& world, std::size_t arm) {
  constexpr double away = 0.06;  // from where it lay: further than it is put back [m]
  const Place off = world.orange(tool_of(arm)) - tools_[arm];
  if (std::hypot(off.x, off.y) > away && world.now() - world.touched(tool_of(arm)) > 1s) lay_tool(world, arm);
}

void Kitchen::step(World& world) {
  for (std::size_t arm = 0; arm < arms; ++arm) {
    constexpr double lifted = 0.03;  // of its middle over where it lies [m]
    if (world.orange(tool_of(arm)).z < handle_half.z + lifted) continue;
    tip_[arm].push_back(seen_by(arm, world.point(tool_of(arm), tool_tip) - world.orange(bread_of(arm))));
    if (move_ > 0 && moved_[arm] == 0) move(world, arm);
  }
}

void Kitchen::move(World& world, std::size_t arm) {
  constexpr double near = 0.2;  // a hand that is nearer is about to use its tool there [m]
  const Place bread = world.orange(bread_of(arm));
  for (std::size_t a = 0; a < arms; ++a)
    if (norm(Place(world.hand(a) - bread)) < near) return;
  const Tray feed = feed_tray(arm);
  const double way = bread.x > feed.x ? -move_ : move_;
  world.put(bread_of(arm), {bread.x + way, bread.y, 0}, {bread_half, bread_stiffness});
  ++moved_[arm];
}

ToolOutcome Kitchen::judge(const World& world, std::size_t arm) const {
  ToolOutcome out;
  const auto beside = [](const Place& p) { return std::hypot(p.x, p.y); };
  out.tool_off = beside(seen_by(arm, world.orange(tool_of(arm))) - lesson_.tool_place);
  const Tray plate = world.tray(1 + arm);
  out.thing_off =
      beside(seen_by(arm, world.orange(bread_of(arm)) - Place{plate.x, plate.y, 0}) - lesson_.thing_place);
  const auto &taught = lesson_.tip, &went = tip_[arm];
  const auto passed = followed(taught, went, ToolOutcome::tip_within);
  out.moved = moved_[arm];
  out.taught_height = 1e9;
  for (const Place& p : taught) out.taught_height = std::min(out.taught_height, p.z);
  if (passed.empty()) return out;
  out.height = 1e9;
  out.share = static_cast<double>(passed.size()) / static_cast<double>(taught.size());
  std::vector<double> strayed;
  for (std::size_t j = passed.front(); j <= passed.back(); ++j) {
    double nearest = 1e9;
    for (const Place& p : taught) nearest = std::min(nearest, norm(Place(went[j] - p)));
    strayed.push_back(nearest);
    out.height = std::min(out.height, went[j].z);
  }
  const auto most =
      strayed.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(strayed.size() - 1));
  std::nth_element(strayed.begin(), most, strayed.end());
  out.strayed = *most;
  return out;
}

}  // namespace packing
