// expect: needs C\+\+20. Compile with -std=c\+\+20
#include "skinctl/skinctl.hpp"  // compiled with -std=c++17

int main() {}
