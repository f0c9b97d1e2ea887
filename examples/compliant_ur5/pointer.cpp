#include "examples/compliant_ur5/pointer.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace compliant_ur5 {
namespace {

using adapters::live::Answer;
using nlohmann::json;
using simulated_ur5::Vec3;

/// A number from `low` to `high`, or nothing.
std::optional<double> number(const json& m, const char* name, double low, double high) {
  const auto found = m.find(name);
  if (found == m.end() || !found->is_number()) return {};
  const double x = found->get<double>();
  return x >= low && x <= high ? std::optional(x) : std::nullopt;
}
/// Three numbers, none beyond `most`.
std::optional<Vec3> three(const json& m, const char* name, double most) {
  const auto found = m.find(name);
  if (found == m.end() || !found->is_array() || found->size() != 3) return {};
  Vec3 out;
  double* const to[] = {&out.x, &out.y, &out.z};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(*found)[i].is_number() || !(std::abs((*found)[i].get<double>()) <= most)) return {};
    *to[i] = (*found)[i].get<double>();
  }
  return out;
}

}  // namespace

adapters::live::Inlet Pointer::inlet() {
  return {topic, [this](std::string_view m) { return take(m); }, [this] { lift(); }};
}

adapters::live::Answer Pointer::take(std::string_view message) {
  const json m = json::parse(message.begin(), message.end(), nullptr, false);
  if (!m.is_object()) return {};
  const auto press = number(m, "press", 0, 1e15);
  if (!press) return {};
  if (*press == 0) return lift(), Answer{true, {}};
  const auto stiffness = number(m, "stiffness", 10, 1e5), travel = number(m, "travel", 0, 0.2);
  const auto point = three(m, "point", 2), normal = three(m, "normal", 2), aside = three(m, "aside", 0.5);
  const auto link = m.find("link");
  if (!stiffness || !travel || !point || !normal || !aside || link == m.end() || !link->is_string() ||
      !(norm(*normal) > 0.5))
    return {};
  const auto frame = std::find_if(frames_.begin(), frames_.end(), [&](const auto& f) {
    return f.name == link->template get_ref<const std::string&>();
  });
  if (frame == frames_.end()) return {};
  const skinctl::Xyz<double> p = frame->in_link.R * skinctl::Xyz<double>{point->x, point->y, point->z},
                             n = frame->in_link.R * skinctl::Xyz<double>{normal->x, normal->y, normal->z};
  const auto& at = frame->in_link.p;
  const bool another = *press != press_;
  press_ = *press;
  double force = 0;
  robot_.call([&](simulated_ur5::Controller& c) {
    force = c.finger_force();
    if (another || !c.finger_presses())
      c.press(frame->link, {p.x + at.x, p.y + at.y, p.z + at.z}, {n.x, n.y, n.z});
    c.lead_finger({*stiffness, *travel, *aside});
  });
  char words[32];
  *std::to_chars(words, words + sizeof words - 1, force, std::chars_format::fixed, 1).ptr = '\0';
  return {true, words};
}

void Pointer::lift() {
  press_ = 0;
  robot_.call([](simulated_ur5::Controller& c) { c.release_finger(); });
}

}  // namespace compliant_ur5
