#include "skinctl/skinctl.hpp"

int main() {}
