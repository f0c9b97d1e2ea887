// What the skin of a run feels with, in words and numbers.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "examples/compliant_ur5/run_log.hpp"
#include "skinctl/limits/felt_places.hpp"
#include "skinctl/tactile/trusted_skin.hpp"

namespace compliant_ur5::running {

using namespace skinctl;

/// How many cells report, in words.
inline std::string in_words(const Coverage& c) {
  return std::to_string(c.usable) + " of " + std::to_string(c.cells);
}
/// The same with what is missing, link by link: "forearm: 25 of 67 cells do not count, 5 places feel nothing
/// (cells 165, ...)".
template <class Skin>
std::string in_words(const Skin& skin, const typename Skin::Memory& memory) {
  constexpr std::size_t most_named = 5;
  std::string out = in_words(skin.coverage(memory)) + " cells report";
  for (std::size_t link = 0; link < 6; ++link) {
    std::size_t cells = 0, missing = 0, blind = 0;
    std::string named;
    for (std::size_t i = 0; i < skin.table().size(); ++i) {
      if (skin.table()[i].link != link) continue;
      ++cells, missing += skin.faults(memory, i).has(CellFault::unheard) || skin.mask(memory, i) > 0.5f;
      if (skin.noticed(memory, i) < std::numeric_limits<double>::infinity()) continue;
      if (++blind <= most_named) named += (blind > 1 ? ", " : "") + std::to_string(skin.table()[i].id);
    }
    if (missing == 0 && blind == 0) continue;
    out += "; " + std::string(link_names[link]) + ": ";
    if (missing > 0)
      out += std::to_string(missing) + " of " + std::to_string(cells) + " cells do not count" +
             (blind > 0 ? ", " : "");
    if (blind > 0)
      out += std::to_string(blind) + (blind > 1 ? " places feel" : " place feels") + " nothing (cells " +
             named + (blind > most_named ? ", ...)" : ")");
  }
  return out;
}

/// How well each place feels, and how fast it may lead.
template <class Scene>
std::vector<FeltPlace> felt(const Scene& scene, const typename Scene::Memory& memory) {
  const auto& limit = scene.governor().template get<FeltPlacesLimit>();
  const auto& places = limit.settings().places;
  std::vector<FeltPlace> out;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto& [link, patch, at, n] = places[i];
    const double noticed = limit.settings().newtons * scene.skin().noticed(memory.skin, i);
    out.push_back({scene.skin().table()[i].id,
                   link,
                   {at.x, at.y, at.z},
                   {n.x, n.y, n.z},
                   noticed,
                   limit.speed(noticed)});
  }
  return out;
}

/// The ids of the scene's cells, in the order of its skin; none where the arm feels by other senses.
template <bool BySkin, class Scene>
std::vector<std::uint32_t> cells_of(const Scene& scene) {
  std::vector<std::uint32_t> out;
  if constexpr (BySkin)
    for (std::size_t i = 0; i < scene.skin().table().size(); ++i) out.push_back(scene.skin().table()[i].id);
  return out;
}

}  // namespace compliant_ur5::running
