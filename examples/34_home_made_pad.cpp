// 34 A home-made pad: an arm such as an FR3 gives way where eight force sensors on its flange are pressed.
//
//   count   of a 12-bit converter behind a sensor that tells 20 N at most; at rest about 30, and noisy
//   pad     what runs on the microcontroller (pad_sender): measures every 4 ms, writes datagrams
//   F       what the cells make of it behind a dead band of 0.2 N [N]
//   tau     J' F and friction, beside the torque of the robot's own controller, which holds gravity
//   drawn   the finger's force and what is felt of it, the way of the pressed place along it,
//           cells in a datagram
#include <cstdio>
#include <memory>
#include <random>

#include "arm7.hpp"
#include "examples/adapters/skin/datagram.hpp"
#include "examples/pad_sender/pad_sender.h"
#include "examples/support/curves.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/tactile/skin.hpp"

using namespace skinctl;
using namespace examples;
namespace wire = adapters::skin;

namespace {

constexpr std::size_t cells = 8;
constexpr double newtons = 20, pitch = 0.015;

/// Says what a cell reads and what that pushes. The microcontroller says the same in C.
struct ForceSensor8 {
  static constexpr std::string_view name = "my-pad-1";
  static constexpr std::array readings{Reading{"force", 0, 1}};
  static constexpr std::array channels{Channel{"force", ChannelUse::contact, 0b1, 1}};
};

/// Two rows of four on the side of the flange: they look along x of hand_link, the rows run along y.
Transform<Link<6>, Cell> place_of(std::size_t cell) {
  const Rotation<double> looks_along_x{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}};
  const auto row = static_cast<double>(cell / 4), column = static_cast<double>(cell % 4);
  return arm7::X_LN<"hand_link"> * Transform<NamedFrame<"hand_link">, Cell>(
                                       looks_along_x, {0.05, (column - 1.5) * pitch, 0.02 + row * pitch});
}

auto make_scene() {
  std::vector<PlacedCell<6>> placed;
  for (std::size_t i = 0; i < cells; ++i) placed.push_back({static_cast<std::uint32_t>(i), place_of(i)});
  ChannelSettings<ForceSensor8> settings;
  settings.gate[0] = EventGate<>::dead_band(0.2 / newtons);
  const Skin<arm7::Model, double, Patch<6, cells, ForceSensor8>> skin(
      Patch<6, cells, ForceSensor8>(placed, {{newtons}}), settings);
  const auto arm = by_torque(arm7::Model{},
                             {.limits = limits_of<arm7::Description>(/*acceleration*/ 10.0),
                              .period = 1ms,
                              .delay = 2ms,
                              .viscous_friction = JointTorque<7>{25, 25, 25, 25, 5, 5, 5}},
                             RobotHoldsGravity{}, RobotCompensatesFriction{});
  return Cycle(arm, skin, SkinJointControl{});
}

/// The sensors and their converter.
struct Pad {
  std::array<double, cells> force{};
  std::mt19937 random;

  static std::uint16_t read(void* self, unsigned cell, unsigned) {
    Pad& pad = *static_cast<Pad*>(self);
    const double count = 30 + 4095 / newtons * pad.force[cell] + double(pad.random() % 7);
    return static_cast<std::uint16_t>(count < 4095 ? count : 4095);
  }
  /// A fingertip of 1 cm presses with `F` newtons between cells; each takes its share.
  void press(double F, double row, double column) {
    double sum = 0;
    for (std::size_t i = 0; i < cells; ++i) {
      const double dr = double(i / 4) - row, dc = double(i % 4) - column;
      sum += force[i] = std::exp(-2 * (dr * dr + dc * dc));
    }
    for (double& f : force) f *= F / sum;
  }
};

}  // namespace

int main(int argc, char** argv) {
  const auto scene = make_scene();
  using Scene = std::remove_const_t<decltype(scene)>;
  const auto memory = std::make_unique<Scene::Memory>();
  const arm7::Model model;
  State<7> real;
  real.q = {0.0, -0.4, 0.0, -2.0, 0.0, 1.7, 0.0};
  scene.start(*memory, real);

  Pad sensors;
  const skin_reading reading{"force", 0, 1};
  const skin_pad_settings settings{"my-pad-1", &reading, cells, 1, 0, 1, 4095, 8, 25, Pad::read, &sensors};
  skin_pad pad;
  if (skin_pad_start(&pad, &settings) == 0) return 1;

  const auto middle = [&](std::size_t a, std::size_t b) {
    const Xyz<double> p = 0.5 * (place_of(a).origin() + place_of(b).origin());
    return Transform<Link<6>, Cell>(place_of(a).axes(), p);
  };
  Curve finger{"finger"}, felt{"felt"}, way{"way along the finger [mm]"}, sent{"cells in a datagram"};
  std::vector<SensorSample<ForceSensor8>> samples;
  double gone[2] = {}, off = 0, drift = 0, speed = 0;
  std::size_t bytes = 0, datagrams = 0;
  Status said;
  for (int k = 1; k <= 6000; ++k) {
    real.time += 1ms;
    const double t = 0.001 * k;
    // For a second each: between cells 1 and 2, then harder on 7, at the corner.
    const int press = t > 1 && t < 2 ? 0 : t > 3.5 && t < 4.5 ? 1 : -1;
    const double since = std::fmod(t - (press == 0 ? 1.0 : 3.5), 1.0),
                 rise = std::min(1.0, std::min(since, 1 - since) / 0.1);
    const double F = press < 0 ? 0 : (press == 0 ? 6 : 9) * rise;
    const auto X_LC = t < 3 ? middle(1, 2) : place_of(7);
    sensors.press(F, t < 3 ? 0 : 1, t < 3 ? 1.5 : 3);

    samples.clear();
    if (k % 4 == 0) {
      std::array<std::uint8_t, wire::largest> buffer;
      skin_pad_measure(&pad, real.time.count());
      do {  // a wire lies between these two lines
        const std::size_t size = skin_pad_write(&pad, real.time.count(), buffer.data());
        wire::Datagram datagram;
        if (!wire::parse(std::span(buffer).first(size), datagram) || !datagram.is<ForceSensor8>()) return 1;
        for (std::size_t i = 0; i < datagram.count(); ++i)
          samples.push_back(datagram.sample<ForceSensor8>(i));
        sent.add(t, double(datagram.count()));
        bytes += size, ++datagrams;
      } while (skin_pad_due(&pad) != 0);
    }
    Scene::Input input;
    input.now = real.time;
    input.measured = real;
    input.sensed.taxels = samples;
    const auto out = scene.step(*memory, input);
    if (k > 4) said |= out.status;  // before the pad's first datagram the skin is silent

    // The arm: its own controller adds what holds it, and the finger pushes.
    const auto poses = link_poses(model, real.q);
    const auto place = poses.get<6>() * X_LC;
    const auto push =
        transpose(jacobian<6>(poses, X_LC)) * Wrench<Cell, Cell, Base>{-F * place.axis_z(), {0, 0, 0}};
    const auto tau = out.command.torque + gravity_torque(model, real.q) + push;
    const auto ddq = forward_dynamics(model, real.q, real.dq, tau).acceleration;
    const auto before = place.origin();
    for (std::size_t i = 0; i < 7; ++i) real.dq[i] += 0.001 * ddq[i];
    real.q = integrate(real.q, real.dq, 0.001);
    const Xyz<double> moved = (link_poses(model, real.q).get<6>() * X_LC).origin() - before;
    const double step = -dot(moved, place.axis_z());
    if (t < 1) drift = std::max(drift, norm(moved) / 0.001);
    gone[t < 3 ? 0 : 1] += step;

    const auto w = scene.skin().wrenches(memory->skin);
    const double f =
        std::sqrt(w.data[0][0] * w.data[0][0] + w.data[0][1] * w.data[0][1] + w.data[0][2] * w.data[0][2]);
    if (press >= 0 && since > 0.12 && since < 0.88) off = std::max(off, std::abs(f - F) / F);
    finger.add(t, F), felt.add(t, f), way.add(t, 1e3 * (gone[0] + gone[1]));
    if (k % 250 == 0)
      std::printf("%5.2f s  finger %3.0f N  felt %4.1f N  %6.1f mm\n", t, F, f, 1e3 * (gone[0] + gone[1]));
  }
  for (const double v : real.dq) speed = std::max(speed, std::abs(v));
  std::printf(
      "untouched: %.0e m/s; pressed: felt within %.0f %%, gave way by %.0f and %.0f mm; at rest: %.0e "
      "rad/s\n",
      drift, 100 * off, 1e3 * gone[0], 1e3 * gone[1], speed);
  std::printf("the pad sent %zu datagrams, %.0f bytes each on average\n", datagrams,
              double(bytes) / double(datagrams));
  said.for_each([](Reason reason) { std::printf("  %s\n", describe(reason)); });
  return draw(argc, argv, "34_home_made_pad.svg",
              "A home-made pad: an arm such as an FR3 gives way where its sensors are pressed",
              {Panel("force [N]", {finger, felt}), Panel(way), Panel(sent)},
              while_above_zero(finger, "pressed")) ||
         gone[0] < 0.01 || gone[1] < 0.01 || off > 0.1 || drift > 1e-6 || speed > 0.02;
}
