// How an arm looks for what it takes next: what is its to take, where its fingers have room.
#pragma once

#include "examples/packing_oranges/worker.hpp"

namespace packing {

template <class R>
FingerRoom Worker<R>::room_beside(std::uint8_t orange) const {
  std::array<skinctl::Xyz<double>, Objects::capacity> others;
  std::size_t count = 0;
  for (std::uint8_t k = 0; k < Objects::capacity; ++k) {
    const auto& o = known_.objects[k];
    if (k != orange && o.known && now_ - o.time < 1s) others[count++] = o.X_WO.origin();
  }
  const double turn = s_.turns ? believed_.turn() : 0;
  FingerRoom out =
      finger_room(known_.objects[orange].X_WO.origin() + beside_, turned(turn),
                  std::span(others).first(count), s_.turns && !believed_.doubts_camera(), s_.finger_ways);
  out.turn = std::remainder(turn + out.turn, M_PI);  // its fingers are alike
  return out;
}

/// The object that fits and costs least; `no_object`: none fits.
[[nodiscard]] inline std::uint8_t cheapest(const auto& fits, const auto& cost) {
  std::uint8_t best = skinctl::no_object;
  double least = 1e9;
  for (std::uint8_t k = 0; k < Believed::Objects::capacity; ++k) {
    if (!fits(k)) continue;
    if (const double c = cost(k); c < least) best = k, least = c;
  }
  return best;
}

template <class R>
bool Worker<R>::is_its(const skinctl::Xyz<double>& p, skinctl::ObjectClass kind) const {
  if (kind == tool_class) return side(arm_) * p.y < 0 && R::room.reaches(seen_by(arm_, {p.x, p.y, s_.above}));
  if (feed_tray(arm_).holds(p)) return true;
  return other_is_out_ && feed_tray(1 - arm_).holds(p) && R::room.reaches(seen_by(arm_, {p.x, p.y, 0.035}));
}

template <class R>
void Worker<R>::look() {
  // A person was asked while it held an orange: that one first goes back to where it came from.
  if (features_.in_hand && in_vain_ <= 2 * s_.in_vain) return end(false);
  if (gives_up()) return answer_ = false, end(true);
  if (is_about_box()) {
    constexpr auto settled = 350ms;  // what the hand hid in the box is seen then
    if (now_ - looks_since_ >= settled) answer_ = sees_full_box(), end(true);
    return;
  }
  const bool sees = now_ - last_picture_ < 300ms;
  if (!sees) looks_since_ = now_;
  if (believed_.waits_for_set_down(now_)) return;
  const auto fits = [&](std::uint8_t k) {
    const auto& o = known_.objects[k];
    const auto p = o.X_WO.origin();
    return sees && o.known && o.kind == now_at().role && now_ - o.time <= 500ms && o.sigma <= 0.003 &&
           o.misses == 0 && p.z <= 0.07 && is_its(p, o.kind);
  };
  // The nearest one with room for its fingers; while there is none, where there is most: fingers that come
  // down beside a ghost push away what lies there, and is taken first.
  const auto has_room = [&](std::uint8_t k) { return room_beside(k).room >= FingerRoom::enough; };
  const auto choose = [&](const auto& fit, const auto& cost) {
    return s_.honest ? believed_.choose(fit, cost) : cheapest(fit, cost);
  };
  const auto far = [&](std::uint8_t k) {
    return norm(skinctl::Xyz<double>(known_.objects[k].X_WO.origin() - X_WH_.origin()));
  };
  std::uint8_t chosen = choose([&](std::uint8_t k) { return fits(k) && has_room(k); }, far);
  if (chosen == skinctl::no_object)
    chosen = choose(fits, [&](std::uint8_t k) { return -room_beside(k).room; });
  if (chosen != skinctl::no_object) {
    object_ = chosen;
    const FingerRoom room = room_beside(chosen);
    turned_ = room.turn;
    believed_.has_room(room.room >= FingerRoom::enough && !uses_tool_);
    return end(true);
  }
  if (now_ - looks_since_ < 1500ms) return;
  answer_ = false;
  end(true);
}

}  // namespace packing
