// A learnt task for people and for other programs: as text, as SVG, as a tree of BehaviorTree.CPP.
#pragma once

#include "examples/teach/task_file.hpp"

namespace teach {

/// The task as sentences that a person reads back: what is taken, squeezed, used and put where, until when,
/// and by which border.
[[nodiscard]] std::string to_text(const NamedTask& task);
/// The steps as a drawing: loops lead back at the left, branches stand side by side.
[[nodiscard]] std::string to_svg(const NamedTask& task);
/// XML of BehaviorTree.CPP 4: activities are actions with the ports role, mark, x, y, z, rx, ry, rz; look and
/// squeeze are conditions.
[[nodiscard]] std::string to_xml(const NamedTask& task);

}  // namespace teach
