// The main job seen while it runs: a page on this computer.
#pragma once

#include <cstdio>
#include <memory>
#include <optional>

#include "examples/adapters/live/live_view.hpp"
#include "examples/compliant_ur5/pointer.hpp"
#include "examples/compliant_ur5/recorder.hpp"
#include "examples/live_page/page.hpp"
#include "skinctl/limits/felt_places.hpp"

namespace compliant_ur5 {

/// Serves the page if the settings ask for it; else it does nothing.
template <class Scene>
class LivePage {
 public:
  /// Throws `adapters::live::ServerError` where the port is taken.
  /// @param simulated  the robot that the page's pointer presses, which lives longer; null: a real one.
  /// @param ids  of the skin's cells in its order; none: the arm has none.
  LivePage(const Settings& s, const std::vector<adapters::live::WeightRange>& weights,
           simulated_ur5::SimulatedUr5* simulated, std::vector<std::uint32_t> ids) {
    if (!s.live) return;
    adapters::live::ServerOptions options;
    options.port = s.live_port;
    options.allow_control = s.allow_control;
    options.name = "compliant_ur5";
    live_page::put_page(options);
    server_ = std::make_unique<adapters::live::FoxgloveServer>(std::move(options));
    const auto run = run_description(s);
    if (!ids.empty()) felt_.emplace(std::move(ids));
    view_ = std::make_unique<adapters::live::LiveView<Scene>>(*server_, requests_, run, weights,
                                                              felt_ ? &*felt_ : nullptr);
    if (simulated != nullptr) server_->add(pointer_.emplace(*simulated, run.frames).inlet());
    server_->start();
    std::printf("live: %s%s\n", server_->url().c_str(), s.allow_control ? ", control allowed" : "");
    std::fflush(stdout);
  }
  /// After a cycle: the next places of the skin are judged for the page's map. Waits for nobody.
  void look(const Scene& scene, const typename Scene::Memory& memory) noexcept
    requires requires { scene.governor().template get<skinctl::FeltPlacesLimit>(); }
  {
    if (!felt_) return;
    const auto& limit = scene.governor().template get<skinctl::FeltPlacesLimit>();
    felt_->look([&](std::size_t i) {
      const double noticed = limit.settings().newtons * scene.skin().noticed(memory.skin, i);
      return std::pair(noticed, limit.speed(noticed));
    });
  }
  /// The job has ended: pages are told why.
  void end(const std::string& words) {
    if (server_) server_->stop(words);
  }
  /// For `JobRecorder`.
  [[nodiscard]] std::vector<skinctl::CycleConsumer<Scene>*> consumers() const {
    return view_ ? std::vector<skinctl::CycleConsumer<Scene>*>{view_.get()}
                 : std::vector<skinctl::CycleConsumer<Scene>*>{};
  }
  /// What somebody asked for since the last cycle.
  [[nodiscard]] skinctl::CycleRequest take() noexcept { return requests_.take(); }
  /// Writes the weights that somebody asked for since the last cycle; false: nobody did.
  template <std::size_t Laws>
  [[nodiscard]] bool take(std::array<double, Laws>& weights) noexcept {
    return requests_.take(weights);
  }

 private:
  adapters::live::Requests requests_;
  std::optional<Pointer> pointer_;
  std::optional<adapters::live::FeltMap> felt_;
  std::unique_ptr<adapters::live::FoxgloveServer> server_;
  std::unique_ptr<adapters::live::LiveView<Scene>> view_;
};

}  // namespace compliant_ur5
