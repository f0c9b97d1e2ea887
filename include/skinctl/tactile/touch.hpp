// SPDX-License-Identifier: BSD-3-Clause
// The protocol of a touch: what a scene asks of skins, sensors, their wrappers and sums, and what it assumes
// of the rest.
#pragma once

#include <limits>
#include <span>

#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/tactile/coverage.hpp"
#include "skinctl/tactile/detail/touch_rows.hpp"
#include "skinctl/tactile/touch_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The input of a scene that has no sensors but cells.
struct NoSensors {};

/// A source of touch: an immutable value whose changing data are kept outside. A skin, a sensor, a wrapper of
/// one, a sum.
///
/// Every touch has
/// - `Memory`: the data that change from cycle to cycle, trivially copyable;
/// - `Wrenches`: what laws read, a `LinkWrenches`, a `JointTouch`, or a sum of them: `scalar`, `links`,
///   `model_type`;
/// - `start(now)`: the memory with which it begins;
/// - `receive(memory, samples, from, to, parts, means)`: takes what arrived, and gives the mean touch over
///   each of `parts` equal parts of `(from, to]`. One that reads more than cells names it in `Sensed`, and
///   takes it and the newest good state of the robot behind the samples:
///   `receive(memory, samples, sensed, measured, from, to, ...)`;
/// - `wrenches(memory)`: the `Wrenches` that are held.
///
/// Optional members, with the default where a touch has none, and the rule of a sum `a + b`:
///
/// | member | meaning | default | of a sum |
/// |---|---|---|---|
/// | `Sensed` | what it adds to a cycle's input | nothing | both |
/// | `Touch`, `touch(memory)` | contacts, and what the controller's own push is, apart | all is contact | both |
/// | `pressed(memory, touch)` | the areas that are pressed | the contact part of `touch` | both |
/// | `contacts(memory)` | the contacts that skills wait for, each a `Found` | none are found | both |
/// | `coverage(memory)` | how much of it feels | no cells | together |
/// | `noticed(memory, i)` | least reading of a push on its `i`-th cell that somebody notices | infinite | b's behind a's |
/// | `max_proximity<Ix>(memory)` | bound of proximity on link `Ix` | 1: somebody may be there | greatest of those that tell |
/// | `index(id)`, `size()` | place of a cell; `size()`: not its own | no cells | b's behind a's |
/// | `each_cell(f, most)` | unit wrenches of cells, for checks of stability | none | both |
/// | `each_point(f)` | the same for a sensor | none | both |
/// | `gain_everywhere()` | newtons that laws see per newton anywhere | none | greater |
/// | `understands(other)` | whether it goes on with the memory of another one | true | and |
/// | `follow_robot(memory, model, state)` | told before `receive` how the robot stands: the virtual one, by torque the measured one | - | both |
/// | `beyond(found, q, contact)` | what of its own others do not feel | all | b beyond a |
template <class S>
concept TouchSource = detail::HasTouchTypes<S> && requires(const S& s, const typename S::Memory& m) {
  { s.wrenches(m) } -> std::convertible_to<typename S::Wrenches>;
};

/// The input of a touch in a cycle.
template <class Sensed, class State>
struct TouchGiven {
  std::span<const CellSample> samples;  ///< samples of cells
  const Sensed& sensed;                 ///< readings of other sensors
  const State& measured;                ///< newest good state of the robot
  Nanoseconds from, to;                 ///< interval `(from, to]`
  std::size_t parts;                    ///< number of equal parts of the interval, >= 1
};
template <class Sensed, class State>
TouchGiven(std::span<const CellSample>, const Sensed&, const State&, Nanoseconds, Nanoseconds, std::size_t)
    -> TouchGiven<Sensed, State>;

/// The members of a touch `S`, or their defaults: the library uses touches only through it.
template <class S>
struct TouchTable {
  using Memory = typename S::Memory;
  using Sensed = typename detail::SensedOf<S, NoSensors>::type;
  /// `S::Touch`, with contacts and the controller's own pushes separate, if there is one; else `S::Wrenches`.
  using Touch = typename detail::ApartOf<S>::type;
  static constexpr bool is_sensor = detail::HasSensed<S>;
  static constexpr bool tells_apart = detail::HasTouch<S>;
  static constexpr bool finds_contacts = detail::HasContacts<S>;
  static constexpr bool has_cells = detail::HasCells<S>;
  /// Whether the touch takes the `CellSample`s of a cycle's input: its cells are hexagons, or their kind is
  /// not stated.
  static constexpr bool takes_hexagons = detail::TakesHexagons<S>::value;
  static constexpr bool has_coverage = detail::HasCoverage<S>;
  static constexpr bool has_noticed = detail::HasNoticed<S>;
  static constexpr bool has_cell_list = detail::HasEachCell<S>;
  static constexpr bool has_points = detail::HasEachPoint<S>;
  static constexpr bool feels_everywhere = detail::HasGainEverywhere<S>;
  template <class T>
  static constexpr bool knows_pressed = detail::HasPressed<S, T>;
  template <std::size_t Ix>
  static constexpr bool tells_max_proximity = detail::TellsMaxProximity<S, Ix>;

  /// See `Skin::receive`; `front` are front ends.
  template <class Given, class Means, class... Front>
  static SKINCTL_INLINE Status receive(const S& source, Memory& m, const Given& in, Means* means,
                                       Front&&... front) noexcept {
    if constexpr (detail::HasSensed<S>) {
      return source.receive(m, in.samples, detail::part_of<Sensed>(in.sensed), in.measured, in.from, in.to,
                            in.parts, means, std::forward<Front>(front)...);
    } else {
      return source.receive(m, in.samples, in.from, in.to, in.parts, means, std::forward<Front>(front)...);
    }
  }
  template <class M, class State>
  static SKINCTL_INLINE void follow_robot(const S& source, Memory& m, const M& model,
                                          const State& state) noexcept {
    if constexpr (detail::HasFollowRobot<S, M, State>) source.follow_robot(m, model, state);
  }
  [[nodiscard]] static SKINCTL_INLINE Touch touch(const S& source, const Memory& m) noexcept {
    if constexpr (tells_apart) {
      return source.touch(m);
    } else {
      return source.wrenches(m);
    }
  }
  template <class T>
  [[nodiscard]] static SKINCTL_INLINE auto pressed(const S& source, const Memory& m,
                                                   const T& touch) noexcept {
    if constexpr (knows_pressed<T>) {
      return source.pressed(m, touch);
    } else {
      return contact_part(touch);
    }
  }
  [[nodiscard]] static SKINCTL_INLINE auto contacts(const S& source, const Memory& m) noexcept {
    if constexpr (finds_contacts) {
      return source.contacts(m);
    } else {
      return std::span<const detail::NothingFound>();
    }
  }
  [[nodiscard]] static SKINCTL_INLINE Coverage coverage(const S& source, const Memory& m) noexcept {
    if constexpr (detail::HasCoverage<S>) {
      return source.coverage(m);
    } else {
      return {};
    }
  }
  [[nodiscard]] static SKINCTL_INLINE double noticed(const S& source, const Memory& m,
                                                     std::size_t i) noexcept {
    if constexpr (has_noticed) {
      return source.noticed(m, i);
    } else {
      return std::numeric_limits<double>::infinity();
    }
  }
  template <std::size_t Ix, class W = typename S::Wrenches>
  [[nodiscard]] static SKINCTL_INLINE typename W::scalar max_proximity(const S& source,
                                                                       const Memory& m) noexcept {
    if constexpr (tells_max_proximity<Ix>) {
      return source.template max_proximity<Ix>(m);
    } else {
      return typename W::scalar(1);
    }
  }
  [[nodiscard]] static std::size_t size(const S& source) noexcept {
    if constexpr (has_cells) {
      return source.size();
    } else {
      return 0;
    }
  }
  [[nodiscard]] static std::size_t index(const S& source, std::uint32_t id) noexcept {
    if constexpr (has_cells) {
      return source.index(id);
    } else {
      return 0;
    }
  }
  /// Whether a cell whose samples are in a cycle's input has this id.
  [[nodiscard]] static bool has_hexagon(const S& source, std::uint32_t id) noexcept {
    if constexpr (!takes_hexagons) {
      return false;
    } else if constexpr (detail::HasHexagon<S>) {
      return source.has_hexagon(id);
    } else {
      return source.index(id) < source.size();
    }
  }
  template <class F>
  static void each_cell(const S& source, F&& f, std::size_t most) {
    if constexpr (has_cell_list) source.each_cell(f, most);
  }
  template <class F>
  static void each_point(const S& source, F&& f) {
    if constexpr (has_points) source.each_point(f);
  }
  /// Newtons that laws see per newton anywhere on the robot; 0 for a touch that does not feel everywhere.
  [[nodiscard]] static double gain_everywhere(const S& source) noexcept {
    if constexpr (feels_everywhere) {
      return source.gain_everywhere();
    } else {
      return 0;
    }
  }
  [[nodiscard]] static bool understands(const S& source, const S& other) noexcept {
    if constexpr (detail::HasUnderstands<S>) {
      return source.understands(other);
    } else {
      return true;
    }
  }
  /// The part of `found` that `contact`, felt by another source, does not explain; all without `S::beyond`.
  /// @param measured  newest good state of the robot.
  template <class Found, class State, class Contact>
  [[nodiscard]] static SKINCTL_INLINE Found beyond(const S& source, const Found& found, const State& measured,
                                                   const Contact& contact) noexcept {
    if constexpr (detail::HasBeyond<S, Found, State, Contact>) {
      return source.beyond(found, measured.q, contact);
    } else {
      return found;
    }
  }
};

/// Whether the input of a scene has readings beside those of cells, by the `Sensed` of its touch: wrenches,
/// torques of motors, weights of patches.
template <class Sensed>
concept SensesWrenches = requires(const Sensed& sensed) { sensed.wrenches; };
template <class Sensed>
concept SensesMotors = requires(const Sensed& sensed) { sensed.motor_torque; };
template <class Sensed>
concept SensesWeights = requires(const Sensed& sensed) { sensed.patch_weights; };

namespace detail {
/// Base that gives `Own`, which has `take(memory, given, means, front...)`, both forms of `receive`.
template <class Own>
struct TakesTouch {
  /// See `Skin::receive`.
  template <class Memory, class Means, class... Front>
  SKINCTL_INLINE Status receive(Memory& memory, std::span<const CellSample> samples, Nanoseconds from,
                                Nanoseconds to, std::size_t parts, Means* means,
                                Front&&... front) const noexcept {
    static_assert(!HasSensed<Own>, "this touch reads more than cells: receive(memory, samples, sensed, ...)");
    constexpr NoSensors none{};
    return static_cast<const Own&>(*this).take(memory, TouchGiven{samples, none, none, from, to, parts},
                                               means, std::forward<Front>(front)...);
  }
  /// See `Skin::receive`; with the readings of other sensors, and the newest good state of the robot.
  template <class Memory, std::size_t N, class T, class Means, class Self = Own, class... Front>
  SKINCTL_INLINE Status receive(Memory& memory, std::span<const CellSample> samples,
                                const typename SensedOf<Self, NoSensors>::type& sensed,
                                const State<N, T>& measured, Nanoseconds from, Nanoseconds to,
                                std::size_t parts, Means* means, Front&&... front) const noexcept {
    return static_cast<const Own&>(*this).take(memory, TouchGiven{samples, sensed, measured, from, to, parts},
                                               means, std::forward<Front>(front)...);
  }
};
}  // namespace detail

/// Base of a touch that is made of another one, `S`: it inherits all members of `S`, and `Own` hides those
/// that it changes. `Own` has a `Memory` that derives from that of `S`, and `take`, which hands on what it
/// receives by `take_on`.
///
///     struct Filtered : WrappedTouch<Filtered, MySkin> {
///       struct Memory : MySkin::Memory { double filtered; };
///       Status take(Memory& m, const auto& given, auto* means, auto&&... front) const noexcept;
///     };
///
/// @tparam Adds  what `Own` adds to a cycle's input.
template <class Own, TouchSource S, class... Adds>
class WrappedTouch : public detail::WithSensed<S, NoSensors, Adds...>, public detail::TakesTouch<Own> {
 public:
  using scalar = typename S::Wrenches::scalar;
  using detail::TakesTouch<Own>::receive;

  /// The memory with which it begins at `now`: that of the wrapped touch; what `Own` has added is as in
  /// `Memory{}`.
  [[nodiscard]] auto start(Nanoseconds now) const noexcept {
    typename Own::Memory memory{};
    static_cast<typename S::Memory&>(memory) = wrapped().start(now);
    return memory;
  }
  /// See `Skin::recomputed`: what `Own` has added stays.
  template <class Memory>
  [[nodiscard]] Memory recomputed(const Memory& given) const noexcept
    requires detail::HasRecomputed<S>
  {
    Memory memory = given;
    static_cast<typename S::Memory&>(memory) = wrapped().recomputed(memory);
    return memory;
  }
  [[nodiscard]] const S& wrapped() const noexcept { return *this; }

 protected:
  explicit WrappedTouch(const S& s) : detail::WithSensed<S, NoSensors, Adds...>(s) {}
  /// Hands on what was given to the wrapped touch.
  template <class Given, class Means, class... Front>
  SKINCTL_INLINE Status take_on(typename S::Memory& memory, const Given& given, Means* means,
                                Front&&... front) const noexcept {
    return TouchTable<S>::receive(wrapped(), memory, given, means, std::forward<Front>(front)...);
  }
};

SKINCTL_END_NAMESPACE
