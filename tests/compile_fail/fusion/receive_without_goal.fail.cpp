// expect: this law receives goals, but does not name their type
#include "tests/compile_fail/sound.hpp"

struct Push : SoundLaw {
#ifdef SKINCTL_RIGHT
  using Goal = double;
#endif
  Received<Memory> receive(const Memory& memory, const auto&, double) const noexcept { return {memory, {}}; }
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
