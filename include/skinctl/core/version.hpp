// SPDX-License-Identifier: BSD-3-Clause
// The version of skinctl, for the preprocessor and as text. A test compares it with the build's.
#pragma once

#define SKINCTL_VERSION_MAJOR 0
#define SKINCTL_VERSION_MINOR 1
#define SKINCTL_VERSION_PATCH 0

#define SKINCTL_VERSION_TEXT_OF(number) #number
#define SKINCTL_VERSION_JOIN(major, minor, patch) \
  SKINCTL_VERSION_TEXT_OF(major) "." SKINCTL_VERSION_TEXT_OF(minor) "." SKINCTL_VERSION_TEXT_OF(patch)
/// The version as text, "0.1.0".
#define SKINCTL_VERSION \
  SKINCTL_VERSION_JOIN(SKINCTL_VERSION_MAJOR, SKINCTL_VERSION_MINOR, SKINCTL_VERSION_PATCH)
