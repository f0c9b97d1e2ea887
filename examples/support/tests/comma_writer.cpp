// A writer that a locale with commas spoils, by which examples/locale shows that it would find one.
#include <cstdio>
#include <fstream>
#include <string_view>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  if (std::string_view(argv[2]) == "stream") {
    std::ofstream(argv[1]) << 0.5;
  } else if (std::FILE* const out = std::fopen(argv[1], "w")) {
    std::fprintf(out, "%g", 0.5);
    std::fclose(out);
  }
}
