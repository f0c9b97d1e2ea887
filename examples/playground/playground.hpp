// The playground's core: an arm that gives way beside the same arm that does not, both simulated, and a
// finger that is led. Flat structs of numbers, so that a page reads them from the memory of a WebAssembly
// module as they stand.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>

#include "examples/compliant_ur5/settings.hpp"

namespace playground {

/// What the arm feels touch by.
enum class Feeling : unsigned char { nothing, skin, wrist, motors };

/// What a visitor chooses; it counts from the next `start` on. Numbers only: `double` holds all of them
/// exactly.
struct Choice {
  double feeling = 1;       ///< `Feeling`
  double interface = 0;     ///< `skinctl::Interface`; torque: with the skin only
  double felt_mass = 0;     ///< of the lightest place [kg]; less than is stable means as light as is stable
  double damping = 6;       ///< of the virtual arm, in proportion to its mass [1/s]
  double delay = 8;         ///< of the arm, and as declared [ms]
  double declared_lag = 8;  ///< of the drives, as the controller believes [ms]
  double real_lag = 8;      ///< of the drives, as they are [ms]
};

/// The finger; it counts from the next cycle on.
struct Finger {
  double stiffness = 3000;  ///< with the skin's cover [N/m]
  double travel = 60;       ///< beyond the surface [mm]
  double aside[3] = {};     ///< how far it was dragged from its line, in the base's frame [m]
};

/// A robot that a visitor brings, as a page read it from a URDF: six joints that turn, the bodies that they
/// move.
struct Robot {
  static constexpr std::size_t joints = 6, max_bodies = 64;
  /// Where a frame is in another one: its axes x, y, z, its origin [m].
  struct Place {
    double axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, origin[3] = {};
  };
  struct Joint {
    Place place;  ///< in the frame of the joint before, or of the base, at position 0; z is its axis
    double lower = 0, upper = 0;  ///< [rad]; equal: it turns without end
    double velocity = 0;          ///< its limit [rad/s]; 0: not known
    double torque = 0;            ///< its limit [N m]; 0: not known
  };
  struct Body {
    double joint = 0;        ///< that moves it, from 0
    Place place;             ///< of its inertia's frame, whose origin is its centre of mass, in the joint's
    double mass = 0;         ///< [kg]
    double inertia[6] = {};  ///< xx, yy, zz, xy, xz, yz [kg m^2]
  };
  double given = 0;   ///< 1: this robot; 0: the UR5 of the main job
  double bodies = 0;  ///< how many of `body` count
  Joint joint[joints];
  Body body[max_bodies];
  double tip[3] = {};  ///< the end of the last link in the frame of the last joint [m]
};
static_assert(std::is_trivially_copyable_v<Robot> && sizeof(Robot) % sizeof(double) == 0);

/// What is to be seen after a cycle. Poses: columns x, y, z, origin, in the base's frame.
struct View {
  double time = 0, period = 0;              ///< [s]
  double force = 0, rigid_force = 0;        ///< on the finger [N]
  double peak = 0, rigid_peak = 0;          ///< of this touch or the last one [N]
  double gave_way = 0, rigid_gave_way = 0;  ///< farthest way of the touched point along the finger [mm]
  double away = 0;                          ///< farthest joint from its task [rad]
  double place = 0, places = 0;           ///< of the task: the one that the arm goes to, from 1, and how many
  double resting = 0;                     ///< 1: its plan is at a place
  double touching = 0;                    ///< 1: the finger is there
  double ended = 0;                       ///< 1: the arm was stopped, and holds
  double felt_mass = 0, lightest = 0;     ///< of the lightest place, and the least stable one [kg]; torque: 0
  double cells = 0, usable = 0;           ///< of the skin; usable: those that count
  double tip[3] = {}, direction[3] = {};  ///< of the finger: its end, and where it came from
  double q[6] = {}, target[6] = {}, rigid_q[6] = {};  ///< joints, their task, the rigid arm's [rad]
  double links[6][12] = {}, rigid_links[6][12] = {};
  double reading[512] = {};  ///< of each cell, in the order of `Arms::cells` [N]
  double mask[512] = {};     ///< 1: the cell does not count
};

/// The numbers of the main job's scenario files, which a page has in place of the files.
struct Scenario {
  compliant_ur5::ControlSettings control;
  compliant_ur5::TorqueControl torque;
  compliant_ur5::WristControl wrist;
  compliant_ur5::MotorControl motors;
  double newtons_per_reading = 20, rest_reading = 0.004, force_delta = 2.0 / 1024;
  std::array<compliant_ur5::PerJoint, 2> places{};  ///< of the task [rad]
};
static_assert(std::is_trivially_copyable_v<Scenario> && sizeof(Scenario) % sizeof(double) == 0);

/// Reads them: those of the skin from one file, wrist and motors from the other.
Scenario read_scenarios(const std::string& with_skin, const std::string& without_skin);

/// Both arms, by one interface and one sense.
class Arms {
 public:
  static constexpr std::size_t dead = 10, stuck = 2;  ///< cells, of `hurt`

  virtual ~Arms() = default;
  /// One cycle of both; it allocates nothing.
  virtual void cycle(View& view) noexcept = 0;
  /// The finger comes to a place of `link` (its frame); the rigid arm begins where this one is, so that the
  /// press is the same. It allocates nothing.
  virtual void press(std::size_t link, const double* point, const double* normal) noexcept = 0;
  virtual void release() noexcept = 0;
  /// Of the cells nearest to the last place `dead` fall silent, and the next `stuck` stick; or all are whole.
  virtual void hurt(bool on) = 0;
  /// What the terminal of the main job would say: why it stopped, or what limits it now.
  virtual const char* words() noexcept = 0;
  /// Of each cell: link, place, outward normal in the link's frame [m].
  [[nodiscard]] virtual std::array<double, 7> cell(std::size_t i) const = 0;
  /// Of the tube of link `i`: radius and ends in the link's frame [m]; radius 0: it has none.
  [[nodiscard]] virtual std::array<double, 7> tube(std::size_t i) const = 0;

  Finger finger;
};

/// Both arms stand at `q` [rad]. Throws `skinctl::ConfigurationError` for numbers out of range, and for what
/// does not exist.
std::unique_ptr<Arms> make_arms(const Scenario& scenario, const Choice& choice,
                                const compliant_ur5::PerJoint& q);
/// The same of a robot that somebody brought, by its skin, by position and velocity; without `q` where its
/// task begins.
std::unique_ptr<Arms> make_arms(const Scenario& scenario, const Choice& choice, const Robot& robot,
                                const compliant_ur5::PerJoint* q = nullptr);

// A file for each sense.
std::unique_ptr<Arms> arms_by_skin(const compliant_ur5::Settings& s, const Choice& c,
                                   const compliant_ur5::PerJoint& q);
std::unique_ptr<Arms> arms_by_wrist(const compliant_ur5::Settings& s, const Choice& c,
                                    const compliant_ur5::PerJoint& q);
std::unique_ptr<Arms> arms_by_motors(const compliant_ur5::Settings& s, const Choice& c,
                                     const compliant_ur5::PerJoint& q);
std::unique_ptr<Arms> arms_of_own_robot(compliant_ur5::Settings s, const Choice& c, const Robot& robot,
                                        const compliant_ur5::PerJoint* q);

}  // namespace playground
