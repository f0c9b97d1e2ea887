// expect: ReasonsAreAskedByHas
// lines: 6
// A status holds several reasons: equal to one it is only where there is no other.
#include "skinctl/core/status.hpp"

bool is_blocked(skinctl::Status status) {
#ifdef SKINCTL_RIGHT
  return status.has(skinctl::Reason::blocked) || status == skinctl::Status(skinctl::Reason::blocked);
#else
  return status == skinctl::Reason::blocked;
#endif
}
