// A finger that somebody leads while the world runs: it comes, presses, is dragged aside and leaves, at the
// speeds of a hand.
#pragma once

#include <algorithm>
#include <vector>

#include "examples/simulated_ur5/contact.hpp"

namespace simulated_ur5 {

/// The finger of a world's touch that is `led`.
class LedFinger {
 public:
  static constexpr double gap = 0.02;      ///< to the surface when it appears; it goes at twice as much [m]
  static constexpr double approach = 0.1;  ///< speed inward: a hand that means to touch [m/s]
  static constexpr double retreat = 0.4;   ///< speed outward [m/s]
  static constexpr double drag = 0.3;      ///< speed aside, at most [m/s]

  /// What somebody wants of it.
  struct Wish {
    double stiffness = 3000;  ///< of finger and skin together [N/m]
    double travel = 0.06;     ///< beyond the surface [m]
    Vec3 aside;               ///< how far it is dragged from its line, in the base's frame [m]
  };

  static Touch touch() {
    Touch t;
    t.led = true;
    t.gap = gap;
    t.tremor = 0.02;
    return t;
  }
  /// The nearest cell that faces alike, within 30 mm of a place of `link`: farther away there is no skin.
  static std::size_t cell_at(const std::vector<SkinCell>& cells, std::size_t link, Vec3 point,
                             Vec3 normal) noexcept {
    double least = 0.03;
    std::size_t nearest = ContactWorld::no_cell;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double far = norm(cells[i].position - point);
      if (cells[i].link == link && dot(cells[i].normal, normal) > 0.3 && far < least)
        least = far, nearest = i;
    }
    return nearest;
  }

  /// It comes to a place of `link` (its frame), along the normal.
  void press(ContactWorld& world, std::size_t i, std::size_t link, Vec3 point, Vec3 normal,
             std::size_t cell) noexcept {
    world.place(i, link, point, normal, cell);
    present_ = pressing_ = true;
    way_ = -gap, aside_ = {};
  }
  void release() noexcept { pressing_ = false; }
  [[nodiscard]] bool present() const noexcept { return present_; }
  [[nodiscard]] bool pressing() const noexcept { return pressing_; }

  /// `h` seconds later.
  void step(ContactWorld& world, std::size_t i, const Wish& wish, double h) noexcept {
    if (!present_) return world.lift(i);
    world.set_stiffness(i, wish.stiffness);
    const double goal = pressing_ ? wish.travel : -2 * gap;
    way_ += std::clamp(goal - way_, -retreat * h, approach * h);
    if (!pressing_ && way_ <= goal) present_ = false;
    const Vec3 off = wish.aside - aside_;
    const double far = norm(off);
    if (far > 0) aside_ = aside_ + std::min(1.0, drag * h / far) * off;
    world.lead(i, way_, aside_);
  }

 private:
  bool present_ = false, pressing_ = false;
  double way_ = 0;  ///< beyond the surface [m]
  Vec3 aside_;      ///< [m]
};

}  // namespace simulated_ur5
