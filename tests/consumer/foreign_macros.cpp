// Headers that define short names come first: <complex.h>, <termios.h>, and Xlib.h as it does.
#include <complex.h>
#include <termios.h>
#ifndef I
#define I _Complex_I
#endif
#define Status int
#define Bool int
#define True 1
#define Success 0
#define None 0L
#undef M_PI

#include "skinctl/semantics/skill_map.hpp"
#include "skinctl/skinctl.hpp"

// As the other headers of X take it.
Status XStatus() {
  return Success;
}
int main() {
  const skinctl::Status none;
  return none.any() ? 1 : XStatus();
}
