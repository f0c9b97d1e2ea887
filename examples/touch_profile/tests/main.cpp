// Runs the tests; without the recordings, those that need them end with 77, which ctest shows as skipped.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>

#include "examples/touch_profile/tests/dataset.hpp"

int main(int argc, char** argv) {
  doctest::Context context(argc, argv);
  const int failed = context.run();
  if (failed == 0 && dataset_missed()) {
    std::fprintf(stderr,
                 "SKIPPED: the environment variable SKINCTL_DATA_DIR names no folder with "
                 "icub_grasp_tactile/iCubGraspDataset; no recording was converted\n");
    return 77;
  }
  return failed;
}
