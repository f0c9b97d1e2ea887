// What only the WebAssembly module has: a setting that is refused ends it, and the page is told why.
#include "skinctl/core/contract.hpp"

extern "C" {

__attribute__((import_module("page"), import_name("refused"))) void playground_refused(const char* why);

/// To be called first.
void playground_begin() {
  skinctl::set_error_handler([](const char* why) noexcept {
    playground_refused(why);
    __builtin_trap();
  });
}
}
