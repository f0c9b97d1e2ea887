#include "examples/compliant_ur5/run_with.hpp"

namespace compliant_ur5 {
namespace {

void refuse_without_skin(const Settings& s) {
  if (s.sense == Sense::skin) return;
  if (s.interface == skinctl::Interface::torque)
    skinctl::refuse("--interface torque feels by the skin: without one use position or velocity");
  if (s.keep_clear) skinctl::refuse("--clear sees by the skin: leave --sense out");
}

}  // namespace

Outcome run(const Settings& settings, const std::atomic<bool>& stop, RunLog& log) {
  using namespace running;
  refuse_without_skin(settings);
  if (settings.sense == Sense::wrist) return run_by<Sense::wrist>(settings, stop, log);
  if (settings.sense == Sense::motors) return run_by<Sense::motors>(settings, stop, log);
  return settings.keep_clear ? run_by_skin<true>(settings, stop, log)
                             : run_by_skin<false>(settings, stop, log);
}

Outcome replay(const Settings& settings) {
  using namespace running;
  refuse_without_skin(settings);
  if (settings.sense == Sense::wrist) return replay_by<Sense::wrist>(settings);
  if (settings.sense == Sense::motors) return replay_by<Sense::motors>(settings);
  return settings.keep_clear ? replay_by_skin<true>(settings) : replay_by_skin<false>(settings);
}

}  // namespace compliant_ur5
