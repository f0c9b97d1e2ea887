// SPDX-License-Identifier: BSD-3-Clause
// What a wrist sensor is told.
#pragma once

#include "skinctl/frames/transform.hpp"
#include "skinctl/frames/wrench.hpp"
#include "skinctl/sensing/event_gate.hpp"
#include "skinctl/sensing/life_settings.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The frame of a force-torque sensor: forces along its axes, moments about its origin.
struct ForceSensor : FrameTag {};

/// Place, tool, thresholds and times of a force-torque sensor on link `Ix`.
template <std::size_t Ix>
struct WristSensorSettings {
  Transform<Link<Ix>, ForceSensor> X_LS = {};  ///< pose of the sensor on the link
  double mass = 0;                 ///< mass that the sensor carries [kg]; 0 if the sensor takes it off itself
  Xyz<double> centre = {0, 0, 0};  ///< centre of that mass, along the sensor's axes [m]
  double reach = 0.2;  ///< reach of the tool from the sensor's origin [m], for checks of stability
  /// Reading without load and without weight: see `WristSensor::tared`.
  Wrench<ForceSensor> bias = {};
  EventGate<> force = EventGate<>(3.0, 2.0, 2.0);   ///< gate of |force| [N]
  EventGate<> moment = EventGate<>(0.3, 0.2, 0.2);  ///< gate of |moment| about the sensor's origin [N m]
  double gain = 1;                                  ///< newtons that the laws see per newton measured, > 0
  /// Largest component of force and moment that the sensor measures [N], [N m].
  double max_force = 1000, max_moment = 100;
  /// Standard deviation of the mean of 8 ms of a component of force [N], and of moment [N m]: with both
  /// known, a bias does not lead the arm (`PushWatch`); 0: unknown, and nothing watches.
  double noise = 0, moment_noise = 0;
  double creep =
      0.02;  ///< greatest rate at which the force at rest is followed [N/s]; of the moment, by `reach`
  LifeSettings life = {};       ///< pushes without life; its `mass`: that of the arm as felt at the tool
  Nanoseconds max_age = 50ms;   ///< age of the last sample from which the sensor does not push
  Nanoseconds fade = 25ms;      ///< last part of `max_age`, in which the wrench goes linearly to 0
  Nanoseconds ramp = 20ms;      ///< longest time before a sample in which its change happened
  Nanoseconds catch_up = 20ms;  ///< time before an interval up to which missing impulse is made up
  Nanoseconds max_ahead = 2ms;  ///< largest time by which a stamp may be later than the interval
};

SKINCTL_END_NAMESPACE
