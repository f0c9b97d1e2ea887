// The simulated world: two arms with grippers, oranges, a box and bins, by MuJoCo. It knows nothing of what controls it.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "examples/packing_oranges/arm_body.hpp"
#include "examples/packing_oranges/gripper.hpp"
#include "examples/packing_oranges/layout.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/sensing/wrench_sample.hpp"

namespace packing {

/// Something besides oranges that hands may hold.
struct Thing {
  enum class Shape : unsigned char { none, ball, cylinder, box } shape = Shape::none;
  skinctl::Xyz<double> half{0, 0,
                            0};  ///< radius (x) and half length (z) of a cylinder, half sides of a box [m]
  double mass = 0.2;             ///< [kg]
  double stiffness = 6000;       ///< against a fingertip [N/m]
};

/// Numbers of the world.
struct WorldSettings {
  double bandwidth = 100;               ///< of every joint's servo, critically damped [rad/s]
  double force_noise = 0.1;             ///< deviation of the fingers' force sensors [N]
  double period = 0.008;                ///< between two commands [s]; the servo interpolates over it
  Thing thing{};                        ///< far away until it is put somewhere
  double friction = 0.8;                ///< of an orange
  bool trays_move = false;              ///< box and bins slide on the table when they are pushed
  std::size_t room = slots_if_emptied;  ///< for oranges of each arm, at most `slots`
  bool drives = false;                  ///< the robot drives between two tables, see `second_table`
  double slip = 0.012;       ///< deviation of a drive's way from what the wheels tell, along and across [m/m]
  double slip_turn = 0.008;  ///< the same of its turning [rad/m]
  bool loads_trays = false;  ///< a tray slides the harder the more oranges it holds
  bool kitchen = false;      ///< before each arm lies a bread and a tool, see tool.hpp; no oranges
  bool opens_gently = false;  ///< a gripper opens with its goal's force at most
  /// Grippers are only open or closed; wrists have force sensors, and the table is to an orange what a finger is.
  bool binary = false;
  double wrist_noise = 0.2;   ///< deviation of a wrist's force sensor [N]
  double wrist_bias = 3;      ///< largest of its readings without load [N], which ...
  double wrist_drift = 0.05;  ///< ... wander so far in a second [N]
  bool interpolate = true;    ///< false: commands are steps, as a servo without interpolation takes them
};

/// An orange as it is put on the table; or bread, or a tool.
struct Orange {
  double radius = 0.038;    ///< of bread and tools the half height [m]
  double stiffness = 6000;  ///< of each side, against a stiff finger [N/m]
  double yaw = 0;           ///< of a tool that lies there [rad]
};

/// What happened in the world, for judges that stand beside it.
struct ArmRecord {
  double force = 0;                   ///< of a finger that holds now, their mean, without noise [N]
  double worst_force = 0;             ///< the largest so far [N]
  double worst_grip = 0;              ///< the same while both fingers hold something [N]
  double square = 0;                  ///< sum of the squared acceleration of a fingertip [m^2/s^4], of ...
  std::uint64_t samples = 0;          ///< ... so many milliseconds since `clear_shake`
  std::uint64_t other_arm = 0;        ///< milliseconds in which it touched the other arm
  std::uint64_t walls = 0;            ///< ... a wall or the table
  std::uint64_t longest_at_wall = 0;  ///< ... a wall or the table without a break
  double wall_force = 0;              ///< largest force between it and a wall or the table [N]
  /// Largest force of a held orange on the table, its weight included; binary grippers only [N].
  double worst_press = 0;
  double worst_push = 0;       ///< largest force between it and trays that it moves, see `moves_trays` [N]
  std::uint64_t obstacle = 0;  ///< ... the obstacle
  /// Speed with which its own point moved into the other arm, and into the obstacle, when they began to touch last [m/s].
  double into_arm = 0, into_obstacle = 0;
};

class World {
 public:
  /// Throws std::runtime_error with MuJoCo's message.
  World(const std::array<ArmBody, arms>& bodies, const WorldSettings& settings, std::uint64_t seed);
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// A millisecond.
  void step();
  [[nodiscard]] skinctl::Nanoseconds now() const;

  /// What an arm's servos go for: reached one period from now, cubically, with this velocity.
  void command(std::size_t arm, const skinctl::JointPosition<6>& q, const skinctl::JointVelocity<6>& dq);
  void command(std::size_t arm, const skinctl::GripperCommand& goal);
  /// Torques of a hand's joints, from the next millisecond on.
  void command(std::size_t arm, const skinctl::JointTorque<16>& torque);
  /// From now on this force [N], and moment [N m], act on a point of a link, all in the link's frame. Zero: none does.
  void push(std::size_t arm, std::size_t link, const skinctl::Xyz<double>& at,
            const skinctl::Xyz<double>& force, const skinctl::Xyz<double>& moment = {0, 0, 0});
  /// From now on a person pushes a fingertip of a hand with this force [N, the World's axes].
  void push_finger(std::size_t arm, std::size_t finger, const skinctl::Xyz<double>& force);

  /// What the wheels go for from now on: velocities along x and y of where they started, and about z.
  void drive(const skinctl::JointVelocity<3>& velocity);
  /// What the wheels tell: x, y and yaw, from where they started. They slip, see `WorldSettings::slip`.
  [[nodiscard]] skinctl::State<3> wheels() const;
  /// Where the robot really stands: both arms stand on it.
  [[nodiscard]] Standing robot() const;

  /// What presses on the forearm of an arm besides the person, since this was called last: where, and with
  /// which mean force, in the link's frame [N].
  struct Contact {
    skinctl::Xyz<double> at{0, 0, 0}, force{0, 0, 0};
  };
  [[nodiscard]] std::vector<Contact> take_contacts(std::size_t arm, std::size_t link);

  /// Something in the way: it is there from now on, whatever it meets. A radius of 0: it is gone.
  void put_obstacle(const skinctl::Capsule<>& shape);

  /// Box and bins as they stood at first.
  [[nodiscard]] const Trays& first() const;
  /// A box or bin, by its number in `first_trays`, where it really is.
  [[nodiscard]] Tray tray(std::size_t k) const;
  [[nodiscard]] skinctl::Xyz<double> tray_velocity(std::size_t k) const;
  /// From now on a person pulls at it with this force [N].
  void pull_tray(std::size_t k, const skinctl::Xyz<double>& force);
  /// A person puts it there.
  void put_tray(std::size_t k, const skinctl::Xyz<double>& p);
  /// Whether what an arm touches of trays is meant from now on: it counts as a push, and not as walls.
  void moves_trays(std::size_t arm, bool on);

  [[nodiscard]] skinctl::State<6> joints(std::size_t arm) const;
  [[nodiscard]] skinctl::GripperState gripper(std::size_t arm) const;
  /// What the force sensor of a binary gripper's wrist reads, along the flange's axes; its moment is left out.
  [[nodiscard]] skinctl::WrenchSample wrist(std::size_t arm) const;
  /// The joints of a hand: angles to the steps of its encoders (333.3 degrees in 65 536).
  [[nodiscard]] skinctl::State<16> fingers(std::size_t arm) const;
  /// What its fingertips feel: index, middle, ring, thumb [N].
  [[nodiscard]] const std::array<double, 4>& tips(std::size_t arm) const;
  /// The same without noise.
  [[nodiscard]] const std::array<double, 4>& true_tips(std::size_t arm) const;
  /// The point between the fingers, where it really is.
  [[nodiscard]] skinctl::Xyz<double> hand(std::size_t arm) const;
  [[nodiscard]] const ArmRecord& record(std::size_t arm) const;
  void clear_shake(std::size_t arm);

  /// The thing is there, and a person holds it; or lets go of it.
  void put_thing(const skinctl::Transform<skinctl::World, skinctl::Tool>& X);
  void let_go_of_thing();
  /// From now on this force [N, the World's axes] pulls at its middle.
  void pull_thing(const skinctl::Xyz<double>& force);
  /// The forces with which the phalanges of a hand press on things, and its palm [N].
  struct Phalanges {
    std::array<double, 16> links{};
    double palm = 0;
  };
  [[nodiscard]] const Phalanges& phalanges(std::size_t arm) const;
  [[nodiscard]] skinctl::Transform<skinctl::World, skinctl::Tool> thing() const;
  /// The palm of a hand, or of a gripper.
  [[nodiscard]] skinctl::Transform<skinctl::World, skinctl::Tool> palm(std::size_t arm) const;

  /// Oranges are numbered from 0 to `arms * slots - 1`, the first `room` of each arm's `slots` are used. One
  /// lies at `p` from now on, at rest.
  void put(std::size_t slot, const skinctl::Xyz<double>& p, const Orange& orange);
  /// It is taken out of the world.
  void take_out(std::size_t slot);
  [[nodiscard]] bool there(std::size_t slot) const;
  [[nodiscard]] bool has_tool(std::size_t slot) const;
  [[nodiscard]] std::size_t room() const;
  [[nodiscard]] skinctl::Xyz<double> orange(std::size_t slot) const;
  /// Where a point of it is, that is given from its middle, in its axes.
  [[nodiscard]] skinctl::Xyz<double> point(std::size_t slot, const skinctl::Xyz<double>& of_it) const;
  [[nodiscard]] skinctl::Xyz<double> orange_velocity(std::size_t slot) const;
  /// When fingers touched it last; never: a negative time.
  [[nodiscard]] skinctl::Nanoseconds touched(std::size_t slot) const;
  /// It is wet from now on, and fingers find no hold; or dry again.
  void make_slippery(std::size_t slot, bool wet = true);

 private:
  struct Bodies;
  std::unique_ptr<Bodies> b_;
};

}  // namespace packing
