// What a hand at the flange is to the arm that carries it: a weight, and a palm that feels.
#pragma once

#include "examples/adapters/allegro/cells.hpp"
#include "examples/compliant_ur5/settings.hpp"
#include "skinctl/kinematics/centre_of_mass.hpp"
#include "skinctl/robots/ur5_allegro.hpp"

namespace arm_and_hand {

/// The hand of `side` in the posture `q`; its fingers' centre of mass moves by centimetres when they close.
/// @param palm_gain  [N] of the arm's law per unit of the palm's reading; 0: a hand without tactile cells.
inline compliant_ur5::CarriedHand carried(skinctl::allegro::Side side, const std::array<double, 16>& q,
                                          double palm_gain, adapters::allegro::Palm* reading) {
  using namespace skinctl;
  const auto fingers = centre_of_mass(allegro::hand(side), JointPosition<16>(q));
  const auto& palm = allegro::palm;
  const Xyz<double> f = fingers.p;
  compliant_ur5::CarriedHand out;
  out.mass = fingers.mass + palm.mass;
  const double places[3] = {f.x, f.y, f.z};
  for (std::size_t i = 0; i < 3; ++i)  // from the hand's frame to the flange's
    out.centre[i] = (fingers.mass * places[i] + palm.mass * palm.c[i]) / out.mass +
                    ur5_allegro::on_flange.p[i] - ur5::Description::flange[i];
  const auto cell = adapters::allegro::cell_poses(side)[0];
  const auto p = cell.origin();
  const Xyz<double> axes[3] = {cell.axis_x(), cell.axis_y(), cell.axis_z()};
  out.palm_gain = palm_gain;
  out.palm = {p.x + ur5_allegro::on_flange.p[0], p.y + ur5_allegro::on_flange.p[1],
              p.z + ur5_allegro::on_flange.p[2]};
  for (std::size_t i = 0; i < 3; ++i) {
    out.palm_axes[3 * i] = axes[i].x;
    out.palm_axes[3 * i + 1] = axes[i].y;
    out.palm_axes[3 * i + 2] = axes[i].z;
  }
  out.reading = reading;
  return out;
}

}  // namespace arm_and_hand
