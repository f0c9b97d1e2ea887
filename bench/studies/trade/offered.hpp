// The points that every scene has: the reference, what is offered, and the presets.
#pragma once

#include "bench/studies/trade/point.hpp"
#include "skinctl/robot/preset.hpp"

namespace trade {

inline std::string in_words(skinctl::Nanoseconds t) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g ms", skinctl::milliseconds(t));
  return text;
}
inline std::string in_words(double newtons) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f N", newtons);
  return text;
}

/// @param in_double, in_float  make a scene's runner in that scalar
template <class D, class F>
std::vector<Point> offered(const std::string& scene, const D& in_double, const F& in_float, bool has_skin) {
  using namespace skinctl;
  using preset::Balanced, preset::Fast;
  std::vector<Point> points;
  const auto impatient = Nanoseconds::max();
  const auto add = [&](const char* policy, const std::string& value, Nanoseconds step, double newtons,
                       Nanoseconds patience, const auto& make, const char* preset = "") {
    points.push_back({.scene = scene,
                      .policy = policy,
                      .value = value,
                      .choices = {.substep = step, .event = newtons, .patience = patience},
                      .make = make,
                      .preset = preset});
  };
  const double every = 0;  // a sample at every change
  add("reference", "double, 0.5 ms, every change", 500us, every, impatient, in_double);
  for (const Nanoseconds step :
       {Nanoseconds(500us), Nanoseconds(1ms), Nanoseconds(2ms), Nanoseconds(4ms), Nanoseconds(8ms)})
    add("sub-step", in_words(step), step, every, impatient, in_double);
  add("scalar", "float", 2ms, every, impatient, in_float);
  if (has_skin) {
    for (const double newtons : {0.1, 0.5, 2.0})
      add("events", in_words(newtons), 2ms, newtons, impatient, in_double);
    for (const double newtons : {0.5, 2.0})
      add("events", in_words(newtons) + ", patience 8 ms", 2ms, newtons, 8ms, in_double);
  }
  add("combination", "float, 4 ms" + std::string(has_skin ? ", 0.1 N" : ""), 4ms, 0.1, impatient, in_float);
  if (has_skin) {
    add("combination", "double, 8 ms, 0.1 N", 8ms, 0.1, impatient, in_double);
    add("combination", "float, 8 ms, 0.5 N", 8ms, 0.5, impatient, in_float);
    add("combination", "float, 8 ms, 0.5 N, patience 8 ms", 8ms, 0.5, 8ms, in_float);
  }
  add("combination", "float, 8 ms" + std::string(has_skin ? ", 0.1 N" : ""), Fast::substep, Fast::event,
      Fast::patience, in_float, Fast::name);
  add("combination", "double, 2 ms" + std::string(has_skin ? ", 0.1 N" : ""), Balanced::substep,
      Balanced::event, Balanced::patience, in_double, Balanced::name);
  return points;
}

}  // namespace trade
