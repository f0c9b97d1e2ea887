// SPDX-License-Identifier: BSD-3-Clause
// The plain numbers of states, commands, samples and goals, one by one.
#pragma once

#include <cstdint>

#include "skinctl/clearance/surroundings.hpp"
#include "skinctl/core/command.hpp"
#include "skinctl/core/gripper.hpp"
#include "skinctl/cycle/input.hpp"
#include "skinctl/frames/transform.hpp"
#include "skinctl/sensing/wrench_sample.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Calls `f(number)` for each plain number of a value. For goals of your own laws, and for what laws and
/// limits of your own add to the input, overload `each_number(value, f)` in their namespace.
template <class K, std::size_t N, class T, class F>
void each_number(JointVector<K, N, T>& v, F&& f) {
  for (T& x : v) f(x);
}
template <std::size_t N, class T, class F>
void each_number(State<N, T>& s, F&& f) {
  each_number(s.time, f);
  each_number(s.q, f);
  each_number(s.dq, f);
}
template <std::size_t N, class T, class F>
void each_number(JointCommand<N, T>& c, F&& f) {
  each_number(c.time, f);
  each_number(c.position, f);
  each_number(c.velocity, f);
  each_number(c.acceleration, f);
  each_number(c.torque, f);
  f(c.valid);
}
template <class F>
void each_number(CellSample& s, F&& f) {
  each_number(s.time, f);
  f(s.cell);
  for (float& x : s.force) f(x);
  f(s.proximity);
  for (float& x : s.acceleration) f(x);
  f(s.temperature), f(s.measured), f(s.unrest);
}
template <SensorKind Kind, class F>
void each_number(SensorSample<Kind>& s, F&& f) {
  each_number(s.time, f);
  f(s.cell);
  for (float& x : s.readings) f(x);
  f(s.measured), f(s.unrest);
}
template <class F>
void each_number(WrenchSample& s, F&& f) {
  each_number(s.time, f);
  for (double& x : s.force) f(x);
  for (double& x : s.moment) f(x);
}
template <class F>
void each_number(GripperState& s, F&& f) {
  each_number(s.time, f);
  auto error = static_cast<std::uint8_t>(s.error);
  f(s.opening), f(s.force), f(s.heard), f(s.moving), f(s.holding), f(s.measured), f(error), f(s.code);
  s.error = static_cast<GripperError>(error);
}
template <std::size_t Most, Frame A, class T, class F>
void each_number(Surroundings<Most, A, T>& s, F&& f) {
  each_number(s.time, f);
  f(s.count);
  for (auto& o : s.obstacles) {
    for (Xyz<T>* v : {&o.shape.from, &o.shape.to}) f(v->x), f(v->y), f(v->z);
    f(o.shape.radius), f(o.approach);
  }
}
template <class Near, class F>
void each_number(AroundRobot<Near>& input, F&& f) {
  each_number(input.around, f);
}
template <class F>
void each_number(NoGoal&, F&&) {}
template <class T, class F>
void each_number(Xyz<T>& v, F&& f) {
  f(v.x), f(v.y), f(v.z);
}
template <Frame A, Frame B, class T, class F>
void each_number(Transform<A, B, T>& X, F&& f) {
  auto R = X.axes();
  auto p = X.origin();
  for (Xyz<T>* v : {&R.x, &R.y, &R.z, &p}) each_number(*v, f);
  X = Transform<A, B, T>::trusted(R, p);
}

SKINCTL_END_NAMESPACE
