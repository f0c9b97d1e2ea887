// One row of the fault table: what goes wrong between a program and a device, and what came of it.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace fault_table {

struct Row {
  std::string device, fault;
  std::string reaction{};  ///< as it was seen
  double rest_ms = -1;  ///< from the fault until nothing moves, or nothing counts, any more; -1: it goes on
  std::string recovery{};
  int exit = 0;             ///< that a program ends with
  bool expected = true;     ///< whether it is as it should be
  std::string otherwise{};  ///< what should have been
};
using Rows = std::vector<Row>;

/// A case that has yet to run.
struct Case {
  std::string device;
  std::function<Row()> run;
};
using Cases = std::vector<Case>;

Cases ur_cases();
Cases allegro_cases();
Cases gripper_cases();
Cases skin_cases();

std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace fault_table
