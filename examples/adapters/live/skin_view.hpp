// A skin file as a live view needs it: cells on numbered links, and the contacts among them.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "skinctl/io/contact_cloud.hpp"
#include "skinctl/io/run_description.hpp"
#include "skinctl/io/skin_contents.hpp"
#include "skinctl/tactile/cell_graph.hpp"
#include "skinctl/tactile/skin_contact.hpp"

namespace adapters::live {

/// Where the cells of a file are, on links that are numbered by their names in `links`. Cells on other links are left
/// out.
struct PlacedCells {
  std::vector<skinctl::SkinCloud::Cell> cells;
  std::vector<skinctl::CellPlace> places;

  PlacedCells(const skinctl::SkinFile& file, const std::vector<std::string>& links) {
    using namespace skinctl;
    for (std::size_t link = 0; link < links.size(); ++link)
      for (std::size_t p = 0; p < file.patches.size(); ++p) {
        const SkinFile::Patch& patch = file.patches[p];
        if (patch.link != links[link]) continue;
        const Rotation<double> R = patch.X_LinkRoot.rotation();
        for (const SkinFile::Cell& cell : patch.cells) {
          const Xyz<double> at = patch.X_LinkRoot.p + R * cell.X_RootCell.p;
          const Xyz<double> normal = R * cell.X_RootCell.rotation().z;
          const auto f = [](double x) { return static_cast<float>(x); };
          cells.push_back({cell.id, static_cast<std::uint32_t>(link), {f(at.x), f(at.y), f(at.z)}});
          places.push_back({link, p, at, normal});
        }
      }
  }
};

/// The contacts of a skin for a picture, from the newest samples of its cells: clusters of cells pushed by more than a
/// threshold. For the thread beside the loop.
class ContactPicture {
 public:
  static constexpr std::size_t most_cells = 8192, most = 64;

  /// @param newtons    of a sum of readings of 1.
  /// @param threshold  of a cell's force above its lowest reading so far [N].
  /// Throws `ConfigurationError` for more than 8192 cells.
  ContactPicture(const PlacedCells& skin, double newtons, double threshold)
      : finder_(skin.places, skinctl::CellGraph(skin.places)),
        newtons_(newtons),
        threshold_(threshold),
        push_(skin.cells.size()),
        rest_(skin.cells.size(), 1e9),
        memory_(std::make_unique<Memory>()) {
    skinctl::require(skin.cells.size() <= most_cells, "ContactPicture: cells", double(skin.cells.size()),
                     "at most 8192");
    for (std::size_t i = 0; i < skin.cells.size(); ++i) index_[skin.cells[i].id] = i;
  }
  void take(const skinctl::CellSample& s) noexcept {
    const auto found = index_.find(s.cell);
    if (found == index_.end()) return;
    const double n = newtons_ * (double(s.force[0]) + double(s.force[1]) + double(s.force[2]));
    double& rest = rest_[found->second];
    if (n < rest) rest = n;
    push_[found->second] = n - rest;
  }
  /// The contacts where the links are at `links`, in the base; at most 64.
  [[nodiscard]] std::span<const skinctl::ContactPoint> find(skinctl::Nanoseconds now,
                                                            const std::vector<skinctl::LinkPlace>& links) {
    using namespace skinctl;
    struct {
      void add(const PressedArea<double>&) noexcept {}
    } areas;
    finder_.find(
        *memory_, now,
        [&](auto&& f) {
          for (std::size_t i = 0; i < push_.size(); ++i)
            if (push_[i] > threshold_) f(i, push_[i]);
        },
        areas);
    found_.clear();
    for (const auto& c : memory_->contacts()) {
      if (c.link >= links.size()) continue;
      const LinkPlace& X = links[c.link];
      const Xyz<double> p = X.p + X.R * c.place, F = X.R * c.force;
      const auto f = [](double x) { return static_cast<float>(x); };
      found_.push_back({{f(p.x), f(p.y), f(p.z)},
                        {f(F.x), f(F.y), f(F.z)},
                        f(c.area),
                        static_cast<std::uint32_t>(c.link)});
    }
    return found_;
  }

 private:
  using Memory = skinctl::SkinContactMemory<most_cells, most>;
  skinctl::ContactFinder<> finder_;
  double newtons_, threshold_;
  std::vector<double> push_, rest_;
  std::unordered_map<std::uint32_t, std::size_t> index_;
  std::unique_ptr<Memory> memory_;
  std::vector<skinctl::ContactPoint> found_;
};

}  // namespace adapters::live
