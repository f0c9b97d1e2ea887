// A task that was taught somewhere else, as a plan for these arms.
#pragma once

#include <string>

#include "examples/packing_oranges/hand_room.hpp"
#include "examples/packing_oranges/plan.hpp"
#include "examples/teach/task_file.hpp"

namespace packing {

/// The plan of a task, for arms with this room for their hands. Things count by their names: orange, box, bin.
/// After each release the hand goes back over the oranges, because the box is shared.
///
/// Throws `std::runtime_error`, with the step, for what a task asks and this world cannot do: other things,
/// activities without a skill, places out of reach or beside box and bins, an orange that is taken beside its
/// middle.
[[nodiscard]] Plan plan_of(const teach::NamedTask& task, const HandRoom& room);

/// The activities of these arms besides the library's, for task files.
[[nodiscard]] teach::Activities activities_here();

/// The plan of a process of tasks that repeats, from their files in their order. Things count by their names:
/// also "full box", and the "shelf" where an arm puts one. Where one of the tasks puts full boxes away, all
/// find a box that has room.
///
/// Throws as `plan_of`, and for tasks that do not follow each other, with the task and its step.
[[nodiscard]] Plan plan_of_process(std::span<const std::string> files, const HandRoom& room);

}  // namespace packing
