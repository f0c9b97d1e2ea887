// What the touches of a run did to the hand.
#pragma once

#include "examples/compliant_allegro/run.hpp"

namespace compliant_allegro {

/// Fills `log.touches` from its entries. From `closes` until 1 s after `opens` the hand presses by itself.
void find_touches(const Settings& settings, Side side, double closes, double opens, RunLog& log);

}  // namespace compliant_allegro
