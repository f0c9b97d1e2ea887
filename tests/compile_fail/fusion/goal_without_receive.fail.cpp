// expect: this law has a Goal, but lacks receive
#include "tests/compile_fail/sound.hpp"

struct Push : SoundLaw {
  using Goal = double;
#ifdef SKINCTL_RIGHT
  Received<Memory> receive(const Memory& memory, const auto&, double) const noexcept { return {memory, {}}; }
#endif
};

int main() {
  static_cast<void>(Push{} + GravityControl{});
}
