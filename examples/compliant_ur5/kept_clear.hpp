// How clear a run keeps of table, base and what its cells see.
#pragma once

#include <algorithm>
#include <limits>

#include "examples/compliant_ur5/clear.hpp"
#include "examples/compliant_ur5/run_log.hpp"
#include "examples/support/text.hpp"
#include "skinctl/core/status.hpp"

namespace compliant_ur5::running {

using namespace skinctl;

/// What an arm that keeps clear looks at before each cycle, and how clear it kept; else nothing.
template <bool Clear>
class KeptClear {
 public:
  explicit KeptClear(const Settings&) {}
  template <class... Any>
  void look(const Any&...) noexcept {}
  template <class... Any>
  void note(const Any&...) noexcept {}
  void report(const RunLog&) const noexcept {}
};
template <>
class KeptClear<true> {
 public:
  explicit KeptClear(const Settings& s) : sight_(s), distance_(s), margin_(s.clear.margin) {}

  template <class Scene>
  void look(const Scene& scene, const typename Scene::Memory& m, typename Scene::Input& input) noexcept {
    input.samples = sight_.foreign(input.measured.q, input.samples);
    input.around = sight_.around(input.measured.q, [&](std::size_t i) {
      return scene.skin().held(m.skin, i).proximity * CellCounts::proximity_unit;
    });
    input.around.time = input.now;
    most_seen_ = std::max(most_seen_, input.around.count);
  }
  void note(const JointPosition<6>& q, Status status) noexcept {
    nearest_ = std::min(nearest_, distance_(q));
    cycles_ += status.has(Reason::clearance_kept);
  }
  void report(RunLog& log) const {
    log.result.push_back({"least distance of links, base and table",
                          examples::text("%.0f mm, declared %.0f mm", 1000 * nearest_, 1000 * margin_)});
    log.result.push_back({"cycles in which it kept clear", std::to_string(cycles_)});
    log.result.push_back({"things seen at once", std::to_string(most_seen_)});
  }

 private:
  Sight sight_;
  OwnDistance distance_;
  double margin_, nearest_ = std::numeric_limits<double>::infinity();
  std::uint32_t most_seen_ = 0;
  std::uint64_t cycles_ = 0;
};

}  // namespace compliant_ur5::running
