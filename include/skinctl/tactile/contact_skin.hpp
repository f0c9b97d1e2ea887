// SPDX-License-Identifier: BSD-3-Clause
// A skin that knows its contacts.
#pragma once

#include <type_traits>

#include "skinctl/tactile/skin_contact.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The skin `S` with the contacts of its pressed cells, for a `Cycle` in place of `S`: `ContactSkin(skin)`.
/// Contact limits and passivity then see each of them, split by the direction of its pushes, and skills can
/// wait for them.
///
/// **Regions.** The force of a region is the sum of the pushes on its cells. If weight times force exceeds
/// the region's limit, the guard stops with `contact_force`.
///
/// @tparam Most  room for contacts; the weakest beyond it are counted in `left_out`, and still count for
///               wrenches, limits and regions.
template <class S, std::size_t Most = 16>
class ContactSkin : public WrappedTouch<ContactSkin<S, Most>, S> {
  using Base = WrappedTouch<ContactSkin, S>;

 public:
  using scalar = typename Base::scalar;
  using Found = SkinContact<scalar>;

  /// The skin's memory, the contacts, and the pressed areas. Trivially copyable.
  struct Memory : S::Memory {
    SkinContactMemory<S::cells, Most, scalar> contacts;
    typename S::Pressed areas;
  };

  /// Neighbours are those of `CellGraph(skin.places())`. Throws `ConfigurationError` for a region with a cell
  /// that the skin does not have.
  SKINCTL_COLD explicit ContactSkin(const S& skin, Regions regions = {})
      : ContactSkin(skin, CellGraph(skin.places()), std::move(regions)) {}
  /// Neighbours are those of `graph`. Throws `ConfigurationError` also if the graph has another number of
  /// cells, or joins cells of two links.
  SKINCTL_COLD ContactSkin(const S& skin, CellGraph graph, Regions regions = {})
      : Base(skin), finder_(skin.places(), std::move(graph)), regions_(std::move(regions)) {
    for (std::size_t k = 0; k < regions_.size(); ++k) {
      std::vector<std::size_t> indices;
      for (const std::uint32_t id : regions_[k].cells) {
        require(skin.index(id) < skin.size(), "ContactSkin: id of a region's cell", double(id),
                "a cell of the skin");
        indices.push_back(skin.index(id));
      }
      finder_.join_region(k, indices);
    }
  }

  [[nodiscard]] const Regions& regions() const noexcept { return regions_; }
  [[nodiscard]] const CellGraph& graph() const noexcept { return finder_.graph(); }

  /// See `S::receive`; then finds the contacts at `to`. An interval without length leaves them as they were.
  /// Reports `contact_force` if a region exceeds its limit.
  template <class Given, class Means, class... Front>
  Status take(Memory& memory, const Given& in, Means* means, Front&&... front) const noexcept {
    Status status = this->take_on(memory, in, means, std::forward<Front>(front)...);
    if (in.to > in.from) {
      memory.areas.clear();
      const S& skin = *this;
      const typename S::Memory& held = memory;
      finder_.find(
          memory.contacts, in.to,
          [&skin, &held](auto&& f) SKINCTL_INLINE_LAMBDA { skin.each_pressed(held, f); }, memory.areas);
    }
    for (std::size_t k = 0; k < regions_.size(); ++k)
      if (!(region_force(memory, k) <= scalar(regions_[k].force_limit))) status |= Reason::contact_force;
    return status;
  }

  /// The contacts, in no order. Valid until `memory` changes.
  [[nodiscard]] std::span<const Found> contacts(const Memory& memory) const noexcept {
    return memory.contacts.contacts();
  }
  /// Weight times the sum of the pushes on the cells of region `k` [N].
  [[nodiscard]] scalar region_force(const Memory& memory, std::size_t k) const noexcept {
    return scalar(regions_[k].weight) * memory.contacts.region_push[k];
  }
  /// Number of contacts beyond `Most`, which found no room.
  [[nodiscard]] std::size_t left_out(const Memory& memory) const noexcept { return memory.contacts.left_out; }
  /// The pressed areas of the contacts, each split by the direction of its pushes into at most four sides,
  /// within 60 degrees of each other.
  [[nodiscard]] const typename S::Pressed& pressed(const Memory& memory, const auto&...) const noexcept {
    return memory.areas;
  }

 private:
  ContactFinder<scalar> finder_;
  Regions regions_;
};
template <class S, class... Rest>
ContactSkin(const S&, const Rest&...) -> ContactSkin<S>;

SKINCTL_END_NAMESPACE
