// SPDX-License-Identifier: BSD-3-Clause
// Pressed areas: cells of one link that are pressed from about the same side, close together.
#pragma once

#include "skinctl/tactile/link_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Pressed cells of one link as one push. Along the link's axes, about the link's origin.
template <Real T = double>
struct PressedArea {
  std::size_t link = 0;
  T pushed = T(0);                     ///< sum of the cells' pushes [N]; at least |force|
  Xyz<T> force = {T(0), T(0), T(0)};   ///< force on the link [N], along the link's axes
  Xyz<T> moment = {T(0), T(0), T(0)};  ///< moment about the link's origin [N m], along the link's axes
  Xyz<T> place = {T(0), T(0), T(0)};   ///< centre of pressure, from the link's origin along its axes [m]

  /// Adds a push of `push` > 0 [N] at `p` along `n`, with the moment `m` per newton.
  SKINCTL_INLINE void add(const Xyz<T>& p, const Xyz<T>& n, const Xyz<T>& m, const T& push) noexcept {
    pushed = pushed + push;
    force = force + push * n;
    moment = moment + push * m;
    place = place + (push / pushed) * (p - place);
  }
  /// Adds another area of the same link.
  SKINCTL_INLINE void add(const PressedArea& b) noexcept {
    pushed = pushed + b.pushed;
    force = force + b.force;
    moment = moment + b.moment;
    if (pushed > T(0)) place = place + (b.pushed / pushed) * (b.place - place);
  }
  /// Whether a push along `n`, of unit length, is within 60 degrees of this area's force.
  [[nodiscard]] SKINCTL_INLINE bool same_side(const Xyz<T>& n) const noexcept { return same_side(force, n); }
  /// Whether a push along `n`, of unit length, is within 60 degrees of `force`.
  [[nodiscard]] static SKINCTL_INLINE bool same_side(const Xyz<T>& force, const Xyz<T>& n) noexcept {
    const T along = dot(n, force);
    return (along > T(0)) & (along * along >= T(0.25) * dot(force, force));
  }
};

/// The pressed areas of a robot whose links `Skinned` have skin: at most four a link, and at most six beyond
/// the first of each link.
///
/// A cell belongs to the nearest area of its link whose push is within 60 degrees of its own and whose centre
/// of pressure is within `patch_size`; otherwise it begins a new one, or joins the most similar one if there
/// is no room. The areas' wrenches add up to that of all cells on the link.
template <Topology M, LinkMask Skinned, Real T = double>
class PressedAreas {
 public:
  using model_type = M;
  using scalar = T;
  static constexpr LinkMask links = Skinned;
  static constexpr std::size_t max_per_link = 4, max_extra = 6;
  static constexpr std::size_t most = [] {
    const auto skinned = static_cast<std::size_t>(std::popcount(Skinned));
    const std::size_t full = skinned == 0 ? 1 : max_per_link * skinned;
    return skinned + max_extra < full ? skinned + max_extra : full;
  }();
  static constexpr double patch_size = 0.1;  ///< largest distance of a cell from its area's centre [m]

  [[nodiscard]] const PressedArea<T>* begin() const noexcept { return list_; }
  [[nodiscard]] const PressedArea<T>* end() const noexcept { return list_ + count_; }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] const PressedArea<T>& operator[](std::size_t k) const noexcept { return list_[k]; }

  /// Removes all areas.
  SKINCTL_INLINE void clear() noexcept { count_ = extra_ = 0; }

  /// Adds a cell of `link` at `p` that is pushed with `push` > 0 [N]; `unit` is its unit wrench, force first.
  /// The next cells change the area: read it when all have been added.
  template <class Number>
  SKINCTL_NOINLINE void add(std::size_t link, const Xyz<T>& p, const Number (&unit)[6],
                            const T& push) noexcept {
    const Xyz<T> n{T(unit[0]), T(unit[1]), T(unit[2])}, m{T(unit[3]), T(unit[4]), T(unit[5])};
    PressedArea<T>*like = nullptr, *similar = nullptr;
    T nearest(0), least(0);
    std::size_t of_link = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      PressedArea<T>& a = list_[k];
      if (a.link != link) continue;
      ++of_link;
      const Xyz<T> way = p - a.place;
      const T far = dot(way, way) * T(1 / (patch_size * patch_size)), along = dot(n, a.force);
      const T size = dot(a.force, a.force);
      const bool same_side = along > T(0) && along * along >= T(0.25) * size;
      if (same_side && far <= T(1) && (like == nullptr || far < nearest)) like = &a, nearest = far;
      const T unlike = far + (same_side ? T(0) : (along > T(0) ? T(100) : T(10000)));
      if (similar == nullptr || unlike < least) similar = &a, least = unlike;
    }
    if (like == nullptr && of_link > 0) {
      if (of_link >= max_per_link || extra_ >= max_extra) {
        like = similar;
      } else {
        ++extra_;
      }
    }
    if (like == nullptr) {
      like = &list_[count_++];
      *like = {.link = link};
    }
    like->add(p, n, m, push);
  }
  /// Adds a whole area: as one of its own if there is room, else to the most similar one of its link.
  SKINCTL_NOINLINE void add(const PressedArea<T>& area) noexcept {
    PressedArea<T>* similar = nullptr;
    T best(0);
    std::size_t of_link = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      PressedArea<T>& a = list_[k];
      if (a.link != area.link) continue;
      ++of_link;
      const Xyz<T> way = area.place - a.place;
      const bool same = a.pushed > T(0) && a.same_side(T(T(1) / area.pushed) * area.force);
      const T unlike = dot(way, way) * T(1 / (patch_size * patch_size)) + (same ? T(0) : T(10000));
      if (similar == nullptr || unlike < best) similar = &a, best = unlike;
    }
    if (of_link > 0 && (of_link >= max_per_link || extra_ >= max_extra)) return similar->add(area);
    if (of_link > 0) ++extra_;
    list_[count_++] = area;
  }

 private:
  PressedArea<T> list_[most];
  std::size_t count_ = 0, extra_ = 0;
};

SKINCTL_END_NAMESPACE
