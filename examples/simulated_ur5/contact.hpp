// The world that touches the arm: fingers on springs and recorded presses, and what they do to skin and
// joints.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "examples/simulated_ur5/skin.hpp"

namespace simulated_ur5 {

/// A recorded force over time, both ascending from time 0; between rows linear, outside zero.
struct ForceProfile {
  std::vector<double> time;   ///< [s]
  std::vector<double> force;  ///< [N], >= 0

  double at(double t) const;
  double duration() const { return time.empty() ? 0 : time.back(); }
};

/// Reads CSV rows `time,force` (seconds, newton; a header line is allowed, `#` starts a comment), at most
/// 1000000 rows. Throws `skinctl::ConfigurationError` with the line when time does not ascend, or a number is
/// no number or negative.
ForceProfile read_profile(std::istream& in, const std::string& name);

/// One touch: a finger that comes along the inward normal of a cell or of a point on a link, presses and
/// leaves.
struct Touch {
  std::string name = "touch";
  double start = 0;  ///< when the finger begins to approach [s after the scenario's start]

  /// Where: a skin cell, or else a point with outward normal in the frame of `link` (0 to 5).
  std::optional<std::uint32_t> cell;
  std::size_t link = 2;
  Vec3 point, normal{0, 0, 1};

  double stiffness = 5000;      ///< finger and skin together [N/m]
  double damping = 20;          ///< [N s/m]; acts while pressed, never pulls
  double tremor = 0;            ///< amplitude of its tremor at 8 Hz, as a share of its force
  double gap = 0.05;            ///< distance at which the finger appears [m]
  double approach_speed = 0.1;  ///< [m/s]
  double travel = 0.02;         ///< how far beyond the surface the finger goes [m]
  double hold = 1;              ///< how long it stays there [s]
  double release_speed = 0.2;   ///< [m/s]
  double patch_radius = 0.012;  ///< standard deviation of the pressure over the surface [m]
  double reach = 0.03;  ///< a finger farther than this beside every cell of its link has slipped off [m]
  /// False: the line of motion is fixed in space when the finger appears. True: it follows the surface until
  /// contact.
  bool follow = false;

  /// True: somebody leads the finger while the world runs, by `ContactWorld::place` and `lead`; start,
  /// approach, travel and hold do not count.
  bool led = false;

  /// Not empty: the finger repeats this recording instead of approach, travel and hold.
  ForceProfile profile;
  double profile_scale = 1;
  /// True: the recorded force acts whatever the arm does. False: the finger moves as far as would produce the
  /// force on an arm that stands still (force / stiffness), so an arm that yields feels less.
  bool impose_force = false;

  /// Seconds from start to the finger's disappearance.
  double duration() const;
};
/// Throws `skinctl::ConfigurationError` for numbers outside their ranges.
void check(const Touch& touch);

/// What a touch did so far.
struct TouchResult {
  std::string name;
  std::uint32_t cell = 0;  ///< nearest cell at first contact, else 0
  std::size_t link = 0;
  bool began = false, ended = false;
  double first_contact = -1;  ///< [s after the scenario's start]
  double last_contact = -1;
  double peak_force = 0;       ///< [N]
  double peak_force_time = 0;  ///< [s after the scenario's start]
  double impulse = 0;          ///< integral of the force [N s]
  double peak_deflection = 0;  ///< farthest that the touched point was pushed inward since contact [m]
};

/// All touches of a scenario and the arm's surface.
class ContactWorld {
 public:
  /// Throws when a touch names a cell that does not exist.
  ContactWorld(std::vector<Touch> touches, const std::vector<SkinCell>& cells, double proximity_distance);

  /// Moves the fingers to time `t` [s after the scenario's start] and presses them on the arm; `h` is the
  /// step.
  void advance(double t, double h, const Links& links);
  /// Puts the led finger of touch `i` in front of a place of `link` (its frame), before a new touch; `cell`
  /// is an index, or `no_cell`: a plane. Touches by the clock end with it: who leads a finger is alone with
  /// the arm. It allocates nothing.
  void place(std::size_t i, std::size_t link, Vec3 point, Vec3 normal, std::size_t cell);
  /// How far it is beyond the surface at which it was placed, along the inward normal, and beside its line
  /// (base's frame) [m].
  void lead(std::size_t i, double way, Vec3 aside);
  /// Takes it away until it is placed again.
  void lift(std::size_t i);
  void set_stiffness(std::size_t i, double stiffness);  ///< [N/m], as `Touch::stiffness`
  static constexpr std::size_t no_cell = static_cast<std::size_t>(-1);

  /// Back to before the first touch.
  void restart();

  const Joints& load() const { return load_; }  ///< torque on the joints [N m]
  Vec3 force() const { return force_; }         ///< on the arm, base's frame [N]
  /// Of this the part on link 5, which a sensor in the flange feels.
  Vec3 tool_force() const { return tool_force_; }
  Vec3 tool_moment_about(Vec3 point) const { return tool_moment_ - cross(point, tool_force_); }  ///< [N m]
  Vec3 moment_about(Vec3 point) const { return moment_ - cross(point, force_); }                 ///< [N m]
  double largest_force() const { return largest_; }  ///< of a single finger [N]
  /// On finger `i` at the last step [N].
  double force_on(std::size_t i) const { return fingers_[i].force; }
  const SkinStimulus& stimulus() const { return stimulus_; }
  const std::vector<TouchResult>& results() const { return results_; }
  /// The end of a finger and the direction that it came from, in the base's frame, as of the last step.
  std::pair<Vec3, Vec3> finger(std::size_t i) const { return {fingers_[i].tip, fingers_[i].direction}; }
  /// The touch that presses, or -1.
  int active() const { return active_; }

 private:
  struct Finger {
    bool placed = false;
    bool frozen = false;  ///< the line of motion no longer follows the surface
    Vec3 anchor;          ///< surface point when the line was fixed, base's frame
    Vec3 direction;       ///< outward normal then
    Vec3 tip;             ///< its end, base's frame
    double depth = 0;     ///< compression at the step before [m]
    double force = 0;     ///< at the step before [N]
    double way = 0;       ///< distance travelled inward at the step before [m]
    bool led = false;     ///< somebody leads it now
    double led_way = 0;   ///< see `lead` [m]
    Vec3 aside;           ///< likewise
    bool pressed = false;
    Vec3 contact_anchor;  ///< touched point at first contact, base's frame
    Vec3 contact_in_link;
    Vec3 contact_direction;
  };
  struct Surface {
    Vec3 point, normal{0, 0, 1};  ///< where the finger's line meets it; base's frame
    double depth = -1;            ///< of the finger's end below it, along the line [m]
    double hold = 0;              ///< 1; 0: slipped off
  };
  Vec3 target_point(const Touch& touch, const Links& links, Vec3& normal) const;
  Surface surface_at(const Touch& touch, const Links& links, Vec3 tip, Vec3 outward) const;
  double travelled(const Touch& touch, double since) const;
  void press(std::size_t i, double t, double h, const Links& links);
  void spread(const Touch& touch, const Links& links, Vec3 point, double force);
  void approach(const Touch& touch, const Links& links, Vec3 tip);

  std::vector<Touch> touches_;
  std::vector<SkinCell> cells_;
  std::vector<std::size_t> target_cell_;              ///< index per touch, or npos
  std::vector<std::vector<std::size_t>> near_cells_;  ///< per touch: cells of its link that face alike
  double proximity_distance_;
  std::vector<Finger> fingers_;
  std::vector<TouchResult> results_;
  SkinStimulus stimulus_;
  std::vector<double> weights_;
  Joints load_{};
  Vec3 force_{}, moment_{}, tool_force_{}, tool_moment_{};
  double largest_ = 0;
  int active_ = -1;
  bool quiet_ = true;
};

}  // namespace simulated_ur5
