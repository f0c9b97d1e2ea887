// Contacts of a skin for a live view.
#pragma once

#include <memory>
#include <unordered_map>
#include <vector>

#include "skinctl/io/contact_cloud.hpp"
#include "skinctl/io/run_description.hpp"
#include "skinctl/tactile/cell_graph.hpp"
#include "skinctl/tactile/skin_contact.hpp"

namespace adapters::live {

/// The contacts of a skin for a picture, from the newest samples of its cells: clusters of cells pushed by more than a
/// threshold. For the thread beside the loop.
class ContactPicture {
 public:
  static constexpr std::size_t most_cells = 8192, most = 64;

  /// @param cells, ids  on the links whose places `find` is told, in any order.
  /// @param newtons    of a sum of readings of 1.
  /// @param threshold  of a cell's force above its lowest reading so far [N].
  /// Throws `ConfigurationError` for more than 8192 cells, or another number of ids.
  ContactPicture(const std::vector<skinctl::CellPlace>& cells, const std::vector<std::uint32_t>& ids,
                 double newtons, double threshold)
      : finder_(cells, skinctl::CellGraph(cells)),
        newtons_(newtons),
        threshold_(threshold),
        push_(cells.size()),
        rest_(cells.size(), 1e9),
        memory_(std::make_unique<Memory>()) {
    skinctl::require(cells.size() <= most_cells, "ContactPicture: cells", double(cells.size()),
                     "at most 8192");
    skinctl::require(ids.size() == cells.size(), "ContactPicture: ids", double(ids.size()),
                     "one for each cell");
    for (std::size_t i = 0; i < ids.size(); ++i) index_[ids[i]] = i;
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
