// How an arm uses a tool: it finds the thing, and goes the way that was shown, over it.
#pragma once

#include "examples/packing_oranges/worker.hpp"

namespace packing {

template <class R>
void Worker<R>::follow_thing() {
  const auto is_here = [&](const skinctl::Xyz<double>& p) { return is_its(p, mark()); };
  Believed::FoundThing found;
  if (s_.honest) {
    found = believed_.nearest_of(mark(), X_WH_.origin(), is_here);
  } else {
    const auto fits = [&](std::uint8_t k) {
      const auto& o = known_.objects[k];
      return o.known && o.kind == mark() && is_here(o.X_WO.origin());
    };
    const auto k = cheapest(fits, [&](std::uint8_t i) {
      return norm(skinctl::Xyz<double>(known_.objects[i].X_WO.origin() - X_WH_.origin()));
    });
    if (k != skinctl::no_object) found = {known_.objects[k].X_WO.origin(), known_.objects[k].time};
  }
  if (found.seen > skinctl::Nanoseconds(0) && now_ - found.seen <= goes_down_for) thing_ = found;
}

template <class R>
bool Worker<R>::has_seen_thing(skinctl::Nanoseconds within) const {
  const bool hides = does(skinctl::activity::Carry::rule) && Believed::hides(X_WH_.origin(), thing_.p);
  return hides || (thing_.seen > skinctl::Nanoseconds(0) && now_ - thing_.seen <= within);
}

template <class R>
void Worker<R>::stand_beside(std::uint8_t place) {
  const auto shown = seen_by(arm_, executor_.task().places[place].X_MH.origin());
  taken_beside_ = -dot(shown, fingers_along()) * fingers_along();
  beside_ = shown + taken_beside_;
}

template <class R>
void Worker<R>::begin_use(std::uint8_t place) {
  constexpr double near = 0.003;  // of a corner [m]
  const skinctl::TaughtWay& way = s_.ways[place];
  const auto& X_MH = executor_.task().places[place].X_MH;
  for (std::size_t k = 0; k < way.size; ++k)
    add(skill_of(&skinctl::activity::Use::rule), hand_at(place) + seen_by(arm_, X_MH.axes() * way.corners[k]),
        near);
}

}  // namespace packing
