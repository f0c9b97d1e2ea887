// The files of the live page, as a server serves them.
#pragma once

#include "examples/adapters/live/foxglove_server.hpp"

namespace live_page {

/// Adds the pages "/" and "/place.html", their scripts, and three.js from where the distribution puts it.
void put_page(adapters::live::ServerOptions& options);

}  // namespace live_page
