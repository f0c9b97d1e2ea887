// An arm on a base that drives: it holds its hand up until the robot stands at the other table.
#pragma once

#include "examples/packing_oranges/worker.hpp"

namespace packing {

template <class R>
void Worker<R>::stands(const skinctl::BaseState<>& base, std::size_t table) {
  X_WR_ = base.X_WB;
  X_WB_ = A::base(arm_, X_WR_);
  table_ = table;
}

template <class R>
std::size_t Worker<R>::wants_to_drive() const {
  const bool ready = is_drive() && plan_.phase == Executor::Phase::run && !parts_.empty() &&
                     part_ == parts_.size() && report_.phase == skinctl::SkillPhase::running;
  return ready ? drives_to() : Carriage::nowhere;
}

template <class R>
skinctl::Xyz<double> Worker<R>::waiting_place() const {
  const Tray feed = feed_tray(arm_);
  return X_WR_.origin() + X_WR_.axes() * skinctl::Xyz<double>{feed.x, feed.y, s_.carry};
}

template <class R>
Trays Worker<R>::trays_before_it() const {
  const auto X_RW = X_WR_.inverse();
  Trays out = found_.at;
  for (Tray& tray : out) {
    const auto p = X_RW.origin() + X_RW.axes() * skinctl::Xyz<double>{tray.x, tray.y, 0};
    tray.x = p.x, tray.y = p.y;
  }
  return out;
}

}  // namespace packing
