// SPDX-License-Identifier: BSD-3-Clause
// What `template class Apart<Scene>;` compiles: for the one file that holds the scene's code.
#pragma once

#include "skinctl/cycle/apart.hpp"

SKINCTL_BEGIN_NAMESPACE

template <class Scene>
Apart<Scene>::Apart(Scene scene) : scene_(std::move(scene)) {}

template <class Scene>
auto Apart<Scene>::start(const State<joints, scalar>& measured) const noexcept -> Memory {
  return scene_.start(measured);
}
template <class Scene>
void Apart<Scene>::start(Memory& m, const State<joints, scalar>& measured) const noexcept {
  scene_.start(m, measured);
}
template <class Scene>
void Apart<Scene>::start(Memory& m, const State<joints, scalar>& measured,
                         const JointPosition<joints, scalar>& told) const noexcept
  requires detail::StartsTold<Scene>
{
  if constexpr (detail::StartsWith<
                    Scene, State<joints, scalar>,
                    JointPosition<joints, scalar>>)  // Clang 14 instantiates what is constrained away, too
    scene_.start(m, measured, told);
}

template <class Scene>
auto Apart<Scene>::operator()(const Memory& memory, const Input& input) const noexcept
    -> std::pair<Output, Memory> {
  std::pair<Output, Memory> result{Output{}, memory};
  result.first = step(result.second, input);
  return result;
}
template <class Scene>
auto Apart<Scene>::step(Memory& m, const Input& input) const noexcept -> Output {
  Stopwatch unseen;
  return step(m, input, unseen);
}
template <class Scene>
auto Apart<Scene>::step(Memory& m, const Input& input, Stopwatch& watch) const noexcept -> Output {
  return scene_.step(m, input, watch);
}
template <class Scene>
void Apart<Scene>::warm(Memory& scratch, const Memory& memory, const Input& input, Nanoseconds after,
                        Stopwatch& watch) const noexcept {
  scene_.warm(scratch, memory, input, after, watch);
}

SKINCTL_END_NAMESPACE
