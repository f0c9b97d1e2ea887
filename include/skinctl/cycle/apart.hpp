// SPDX-License-Identifier: BSD-3-Clause
// A scene that is compiled once, in a file of its own.
#pragma once

#include <utility>

#include "skinctl/core/joint.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/cycle/detail/starts_with.hpp"
#include "skinctl/cycle/stopwatch.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {
/// A scene that may start beside where its robot was told to be.
template <class C>
concept StartsTold =
    StartsWith<C, State<C::joints, typename C::scalar>, JointPosition<C::joints, typename C::scalar>>;
}  // namespace detail

/// A scene (`Cycle`, `Configurations`) whose code stands in one file, so that a change in the program around
/// it does not compile it again. It commands the same to the bit, and goes wherever the scene goes:
/// `run_loop`, `Recording`, `replay`, `CycleThread`, `McapRecorder`.
///
///     // scene.hpp: the scene's type
///     using Scene = decltype(Cycle(describe_arm(), make_skin(), SkinJointControl{} + GravityControl{}));
///     extern template class skinctl::Apart<Scene>;
///     skinctl::Apart<Scene> make_scene();
///
///     // scene.cpp: its numbers and its code, the only file that includes cycle/apart_definitions.hpp
///     template class skinctl::Apart<Scene>;
///     skinctl::Apart<Scene> make_scene() { return Apart(Cycle(describe_arm(), make_skin(), ...)); }
///
///     // main.cpp
///     const auto cycle = make_scene();
///     run_loop(cycle, *memory, robot, skin, options, before, after);
///
/// A linker that misses `Apart<...>::step` misses the line `template class`. All files of a program need the
/// same flags of the compiler. There is one code, with a `Stopwatch`: also a step that asks for no times
/// reads the clock (four times, some 80 ns), and no other type of stopwatch can be given.
template <class Scene>
class Apart {
 public:
  static constexpr std::size_t joints = Scene::joints;
  using scalar = typename Scene::scalar;
  using law_type = typename Scene::law_type;
  using Goal = typename Scene::Goal;
  using Sensed = typename Scene::Sensed;
  using Added = typename Scene::Added;
  using Memory = typename Scene::Memory;
  using Input = typename Scene::Input;
  using Output = typename Scene::Output;

  explicit Apart(Scene scene);

  /// The scene itself, to read its parts: what is called there is compiled where it is called.
  [[nodiscard]] const Scene& scene() const noexcept { return scene_; }

  /// The memory with which the scene takes over: see `Cycle::start`.
  [[nodiscard]] Memory start(const State<joints, scalar>& measured) const noexcept;
  void start(Memory& m, const State<joints, scalar>& measured) const noexcept;
  void start(Memory& m, const State<joints, scalar>& measured,
             const JointPosition<joints, scalar>& told) const noexcept
    requires detail::StartsTold<Scene>;

  /// One cycle as a function: see `Cycle::operator()`.
  [[nodiscard]] std::pair<Output, Memory> operator()(const Memory& memory, const Input& input) const noexcept;
  /// One cycle in place: see `Cycle::step`.
  Output step(Memory& m, const Input& input) const noexcept;
  Output step(Memory& m, const Input& input, Stopwatch& watch) const noexcept;
  /// Brings the next step into the caches: see `Cycle::warm`.
  void warm(Memory& scratch, const Memory& memory, const Input& input, Nanoseconds after,
            Stopwatch& watch) const noexcept;

 private:
  Scene scene_;
};

SKINCTL_END_NAMESPACE
