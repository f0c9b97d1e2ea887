// What the main job keeps clear of, with `--clear`: its own links, the table, and what its cells see.
#pragma once

#include <span>
#include <vector>

#include "examples/compliant_ur5/settings.hpp"
#include "examples/compliant_ur5/skin.hpp"
#include "skinctl/clearance/clearances.hpp"
#include "skinctl/clearance/own_view.hpp"
#include "skinctl/clearance/sightings.hpp"
#include "skinctl/core/state.hpp"

namespace compliant_ur5 {

inline constexpr std::size_t max_seen = 8;   ///< things that cells see at once: the nearest ones count
inline constexpr double sees_from = 0.05;    ///< smallest reading of proximity that counts
inline constexpr double sight_error = 0.01;  ///< of a distance that a cell sees, and of the links' shapes [m]
using UrClearance = skinctl::ClearanceAround<max_seen>;

/// The distance of what a cell reads as `reading`, its sensor's light falling with the square; 0 at 1 or more
/// [m].
[[nodiscard]] double distance_of(const ClearSettings& s, double reading) noexcept;
/// The reading of what is at `distance` [m], in (0, 1].
[[nodiscard]] double reading_of(const ClearSettings& s, double distance) noexcept;
/// The links, the base, the table and a tool, and which of them stay clear of each other: all that can meet.
/// Links and tool are exposed to what cells see. Throws `skinctl::ConfigurationError` for numbers out of
/// range.
[[nodiscard]] UrClearance clearance(const Settings& settings);

/// The least distance of these surfaces at a position [m].
class OwnDistance {
 public:
  explicit OwnDistance(const Settings& settings) : clearances_({}, clearance(settings).own) {}
  [[nodiscard]] double operator()(const skinctl::JointPosition<6>& q) const noexcept;

 private:
  skinctl::Clearances<skinctl::ur5::Model> clearances_;
};

/// Looks with the cells: what they read of the arm itself, its base and the table is taken out of their
/// samples, and the rest are things around the arm. A reading that stays the same for 10 s, or while its cell
/// goes 30 mm, is none: dirt, or a sensor that is stuck. It counts again once it changes, as that of a thing
/// that the arm nears. Allocates where it is made only.
class Sight {
 public:
  using Around = skinctl::Surroundings<max_seen>;

  explicit Sight(const Settings& settings);

  /// The samples without what the cells may read of the arm at `q`; valid until the next call.
  [[nodiscard]] std::span<const skinctl::CellSample> foreign(
      const skinctl::JointPosition<6>& q, std::span<const skinctl::CellSample> samples) noexcept;
  /// What is around an arm at `q`; `held`: of each cell, as the scene's skin holds it behind its gate.
  template <class Held>
  [[nodiscard]] Around around(const skinctl::JointPosition<6>& q, const Held& held) const noexcept {
    Around out;
    sightings_.look(
        q,
        [&](std::size_t i) {
          const double above = held(i);
          return above > 0 ? 1 - distance_of(s_, above + sees_from) / range_ : 0.0;
        },
        out);
    return out;
  }
  [[nodiscard]] double range() const noexcept { return range_; }  ///< of a cell [m]

 private:
  ClearSettings s_;
  double range_;
  UrSkin skin_;
  skinctl::OwnView<skinctl::ur5::Model> view_;
  skinctl::Sightings<skinctl::ur5::Model> sightings_;
  /// What a cell reads, and when and where it was when it last read anything else.
  struct Still {
    float reading = 0;
    skinctl::Nanoseconds since{};
    skinctl::Xyz<double> place{0, 0, 0};
    bool is_dull = false;  ///< it has gone too far since, or for too long
  };
  [[nodiscard]] static bool is_dull(Still& still, const skinctl::CellSample& sample,
                                    const skinctl::Xyz<double>& place) noexcept;

  std::vector<skinctl::CellPlace> places_;
  std::vector<Still> still_;
  std::vector<std::uint16_t> own_;
  std::vector<skinctl::CellSample> samples_;
};

}  // namespace compliant_ur5
