// SPDX-License-Identifier: BSD-3-Clause
// Contacts of a skin for a picture: what files and streams show of them.
#pragma once

#include <memory>
#include <unordered_map>
#include <vector>

#include "skinctl/io/contact_cloud.hpp"
#include "skinctl/recording/run_description.hpp"
#include "skinctl/tactile/cell_graph.hpp"
#include "skinctl/tactile/skin_contact.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The contacts of a skin for a picture, from the newest samples of its cells: clusters of cells pushed by
/// more than a threshold. For the thread beside the loop.
class ContactPicture {
 public:
  static constexpr std::size_t max_cells = 8192, most = 64;

  /// @param skin     cells on the links whose places `find` is told.
  /// @param newtons  force at which a cell's readings add up to 1 [N].
  /// Throws `ConfigurationError` for more than 8192 cells, or another number of ids.
  ContactPicture(const PressedCells& skin, double newtons)
      : finder_(skin.places, CellGraph(checked(skin).places)),
        newtons_(newtons),
        threshold_(skin.threshold),
        push_(skin.places.size()),
        rest_(skin.places.size(), 1e9),
        memory_(std::make_unique<Memory>()) {
    for (std::size_t i = 0; i < skin.ids.size(); ++i) index_[skin.ids[i]] = i;
  }
  void take(const CellSample& s) noexcept {
    const auto found = index_.find(s.cell);
    if (found == index_.end()) return;
    const double n = newtons_ * (double(s.force[0]) + double(s.force[1]) + double(s.force[2]));
    double& rest = rest_[found->second];
    if (n < rest) rest = n;
    push_[found->second] = n - rest;
  }
  /// The contacts in the base, with the links at `links`; at most 64.
  [[nodiscard]] std::span<const ContactPoint> find(Nanoseconds now, const std::vector<LinkPlace>& links) {
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
  using Memory = SkinContactMemory<max_cells, most>;
  /// Before its neighbours are looked for, which takes long for too many cells.
  static const PressedCells& checked(const PressedCells& skin) {
    const std::size_t cells = skin.places.size();
    require(cells <= max_cells, "ContactPicture: cells", double(cells), "at most 8192");
    require(skin.ids.size() == cells, "ContactPicture: ids", double(skin.ids.size()), "one for each cell");
    return skin;
  }
  ContactFinder<> finder_;
  double newtons_, threshold_;
  std::vector<double> push_, rest_;
  std::unordered_map<std::uint32_t, std::size_t> index_;
  std::unique_ptr<Memory> memory_;
  std::vector<ContactPoint> found_;
};

SKINCTL_END_NAMESPACE
