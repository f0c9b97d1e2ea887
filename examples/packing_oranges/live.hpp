// A run that is watched while it goes on: a page on this computer shows both arms, the oranges and the plan.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "examples/packing_oranges/scenery.hpp"
#include "skinctl/cycle/input.hpp"

namespace packing {

/// Serves the page and what it shows, in a thread of its own. Whoever sees the page may stop the robot, and let it go on
/// where that is allowed.
class LivePage {
 public:
  /// @param port  0: any. Throws adapters::live::ServerError where it is taken.
  LivePage(std::uint16_t port, bool allow_control);
  ~LivePage();
  LivePage(const LivePage&) = delete;
  LivePage& operator=(const LivePage&) = delete;

  [[nodiscard]] std::string url() const;
  void show(const Scenery& s);
  /// What somebody asked for since the last call.
  [[nodiscard]] skinctl::CycleRequest take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace packing
