// expect: (convert|convertible).*bool
// lines: 11
// A program that asks for any reason, and for one: both are named.
#include "skinctl/core/status.hpp"

bool is_blocked(skinctl::Status status) {
#ifdef SKINCTL_RIGHT
  if (status.any()) return true;
  return status.has(skinctl::Reason::blocked);
#else
  if (status) return true;
  return status == skinctl::Reason::blocked;
#endif
}
