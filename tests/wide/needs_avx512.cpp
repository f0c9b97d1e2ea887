// The main of test programs that are compiled for AVX-512: doctest's, in a file without these instructions. A processor without
// them is told before anything else runs, the registration of the tests included; ctest calls this a skipped test.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>

namespace {

__attribute__((constructor(101))) void check_processor() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512cd"))
    return;
  std::fputs("skinctl: SKIPPED, this processor has no AVX-512: samples side by side are not tested here\n",
             stderr);
  std::_Exit(77);
}

}  // namespace
