// A recording in a browser.
#pragma once

#include <cstdint>
#include <string>

namespace skinctl_record {

/// Serves the live page with the recording `path` on 127.0.0.1 until a signal ends it; its address is
/// printed. Exit code 0.
/// @param port  0: any.
int view(const std::string& path, std::uint16_t port);

}  // namespace skinctl_record
