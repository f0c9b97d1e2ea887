// Appended to the headers by no_exceptions.cmake: a wrong configuration calls the handler, with the number in
// the text.
#include <cstdio>
#include <cstdlib>
#include <cstring>

int main() {
  skinctl::set_error_handler([](const char* what) noexcept {
    std::puts(what);
    std::exit(std::strstr(what, "K_p = -1") != nullptr ? 0 : 1);
  });
  skinctl::require(false, "K_p", -1, "> 0 1/s");
  return 2;
}
