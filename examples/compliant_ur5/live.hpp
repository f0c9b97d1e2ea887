// The main job seen while it runs: a page on this computer.
#pragma once

#include <cstdio>
#include <memory>

#include "examples/adapters/live/live_view.hpp"
#include "examples/compliant_ur5/recorder.hpp"
#include "examples/compliant_ur5/skin.hpp"
#include "examples/live_page/page.hpp"

namespace compliant_ur5 {

/// Serves the page if the settings ask for it; else it does nothing.
template <class Scene>
class LivePage {
 public:
  /// Throws `adapters::live::ServerError` where the port is taken.
  explicit LivePage(const Settings& s) {
    if (!s.live) return;
    adapters::live::ServerOptions options;
    options.port = s.live_port;
    options.allow_control = s.allow_control;
    options.name = "compliant_ur5";
    live_page::put_page(options);
    server_ = std::make_unique<adapters::live::FoxgloveServer>(std::move(options));
    std::vector<skinctl::CellPlace> places;
    std::vector<std::uint32_t> ids;
    std::size_t number = 0;
    for (const auto& patch : skin_patches(s)) {
      for (const auto& cell : patch.cells) {
        places.push_back({patch.link, number, cell.X_LC.origin(), cell.X_LC.axis_z()});
        ids.push_back(cell.id);
      }
      ++number;
    }
    contacts_ = std::make_unique<adapters::live::ContactPicture>(places, ids, s.newtons_per_reading, 0.5);
    view_ = std::make_unique<adapters::live::LiveView<Scene>>(*server_, requests_, run_description(s),
                                                              contacts_.get());
    server_->start();
    std::printf("live: %s%s\n", server_->url().c_str(), s.allow_control ? ", control allowed" : "");
    std::fflush(stdout);
  }
  /// For `JobRecorder`.
  [[nodiscard]] std::vector<skinctl::CycleConsumer<Scene>*> consumers() const {
    return view_ ? std::vector<skinctl::CycleConsumer<Scene>*>{view_.get()}
                 : std::vector<skinctl::CycleConsumer<Scene>*>{};
  }
  /// What somebody asked for since the last cycle.
  [[nodiscard]] skinctl::CycleRequest take() noexcept { return requests_.take(); }

 private:
  adapters::live::Requests requests_;
  std::unique_ptr<adapters::live::FoxgloveServer> server_;
  std::unique_ptr<adapters::live::ContactPicture> contacts_;
  std::unique_ptr<adapters::live::LiveView<Scene>> view_;
};

}  // namespace compliant_ur5
